"""Result of a single kind of test on the page: verdict, lights, figure, table, checks.

The registry row of the kind has its form and its fit; the result is shown as on the page of the
kind in `dashpot.report`.
"""

from __future__ import annotations

import json
import shlex
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from dashpot.base import dataclass
from dashpot.base.errors import DataError
from dashpot.base.option_fields import FormData, FormField
from dashpot.base.progress import send_progress
from dashpot.datamodel.fit import Fit
from dashpot.extensions.app import result_cache, view_models, wire_format
from dashpot.extensions.app.bench_tests import DEFAULT_SIZE, MAX_CACHED
from dashpot.extensions.app.command_lines import format_options
from dashpot.extensions.app.figure_cards import draw_cards, make_figure_cards
from dashpot.extensions.app.limits_panel import judge_limits
from dashpot.extensions.app.page_form import get_form
from dashpot.extensions.app.request_parsing import (
    build_part,
    get_list,
    get_panel_sizes,
    require_mapping,
)
from dashpot.extensions.app.upload_store import find_file
from dashpot.reading.read_options import ReadOptions
from dashpot.registry import KINDS, find_handler, load_object, require_handler
from dashpot.report.page_frame import VERDICT_COLOURS
from dashpot.report.result_page import KindPage, format_json, kind_page
from dashpot.workflow.job import Job


@dataclass(frozen=True)
class KindRequest:
    """Request of the page on files of a single kind of test."""

    kind: str
    files: tuple[str, ...]
    form_data: FormData
    options: ReadOptions
    behind: str = ""


def read_form(asks: tuple[FormField, ...], fields: Mapping[str, str]) -> FormData:
    """Return the typed fields of the form, without empty ones."""
    fields_by_name = {form_field.name: form_field for form_field in asks}
    typed_values = ((name, fields_by_name[name.split(" ")[0]].read(text)) for name,
    text in fields.items()
            if name.split(" ")[0] in fields_by_name)  # fmt: skip
    return FormData(asks, tuple(sorted((name, text) for name, text in typed_values if text)))


def list_form_options(form_data: FormData, file_count: int) -> list[str]:
    """Return the command-line words of the filled fields of a form, for that number of files."""
    options: list[str] = []
    for form_field in form_data.fields:
        names = (
            [f"{form_field.name} {i}" for i in range(file_count)]
            if form_field.per_file
            else [form_field.name]
        )
        for name in names:
            text = form_data.get_text(name) or next(iter(form_field.choices), "")
            for word in form_field.words(text):
                options += [form_field.flag, word]
    return options


def _parse_request(request: Mapping[str, Any], folder: Path) -> KindRequest:
    files = tuple(str(find_file(folder, item)) for item in get_list(request, "files"))
    if not files:
        raise DataError("no file of this kind is open: open one first")
    kind, typed_fields = str(request.get("kind", "")), {}
    for name, text in require_mapping(request.get("form_values", {}), "form_values").items():
        if not isinstance(text, str):
            raise DataError(f"{name} = {text!r}; expected a text")
        typed_fields[str(name)] = text
    kind_of_test, test_identity = KINDS.get(kind), request.get("test")
    return KindRequest(
        kind, files[:1] if kind_of_test is not None and kind_of_test.takes_one_file else files,
        read_form(get_form(kind), typed_fields),
        build_part(ReadOptions, request.get("options", {}), "options"),
        str(find_file(folder, test_identity)) if test_identity else "",
    )  # fmt: skip


@lru_cache(MAX_CACHED)
def _fit_with_page(request: KindRequest) -> tuple[Any, KindPage]:
    """Return the result of files of such a kind, and its panels on the page."""
    send_progress(f"fitting {', '.join(Path(path).name for path in request.files)}")
    if find_handler("predict open files", request.kind) is not None:
        result = _predict_files(request)
        return result, kind_page(result)
    row = KINDS.get(request.kind)
    if row is None or not (row.app_form or row.fits):
        raise DataError(f"'{request.kind}' is no kind of test that is fitted by itself")
    if row.app_form:
        result = load_object(f"{row.app_form}:fit_form_files")(
            request.files, request.form_data, request.options
        )
    else:
        result = load_object(row.fit)(request.files, options=request.options)
    return result, kind_page(result)


def _predict_files(request: KindRequest) -> Any:
    """Return the prediction of such files with the fit of the open relaxation test."""
    path = Path(request.files[0])
    folder = path.parent.parent / f"{request.kind}s" / path.parent.name

    def fit_test() -> Fit:
        choices = result_cache.select_fit_choices(Job(request.behind))
        fit: Fit = result_cache.fit_job(choices, True, None)
        return fit

    predict = require_handler("predict open files", request.kind)
    return predict(request.files, folder, fit_test if request.behind else None)


def fit_kind(request: Mapping[str, Any], folder: Path) -> bytes:
    """Return the result of such files: verdict, lights, figures, numbers, checks and command."""
    kind_request = _parse_request(request, folder)
    result, page = _fit_with_page(kind_request)
    verdict = result.verdict
    width = get_panel_sizes(request).get("bench", DEFAULT_SIZE)[0]
    list_cards = find_handler("figure cards", result)
    return wire_format.encode_message(
        {
            "verdict": view_models.render_verdict(verdict, page.indicators),
            "colour": VERDICT_COLOURS[verdict.use],
            "answers": view_models.render_groups(page.groups, page.table_title, page.note),
            "solid": "",
            "arms": "",
            "checks": view_models.render_checks(result.checks),
            "figures": make_figure_cards(page.picture, width)
            if list_cards is None
            else draw_cards(list_cards(result), width),
            "facts": [list(names) for names in page.summary_line],
            "simulated": any(source.simulated for source in page.sources),
            **judge_limits(request, folder, result).add_to(_format_command(kind_request)),
        }
    )


def download_kind(request: Mapping[str, Any], folder: Path) -> bytes:
    """Return the saved file of a result, or its JSON as printed by ``--json``."""
    result, page = _fit_with_page(_parse_request(request, folder))
    save_file = find_handler("app file", result)
    if save_file is not None:
        name, kind, text = save_file(result)
        return wire_format.encode_message({"name": name, "kind": kind, "text": text})
    text = format_json(result) if hasattr(result, "to_dict") else json.dumps(result)
    text = judge_limits(request, folder, result).render_document(text)
    return wire_format.encode_message(
        {"name": f"{page.name}.json", "kind": "application/json", "text": text}
    )


def _format_command(request: KindRequest) -> str:
    """Return the command that gives the same."""
    names = [Path(path).name for path in request.files]
    if find_handler("predict open files", request.kind) is not None:
        return shlex.join(["dashpot", "predict", names[0]])
    options = [*list_form_options(request.form_data, len(names)), *format_options(request.options)]
    return shlex.join(["dashpot", "fit", *names, *options])
