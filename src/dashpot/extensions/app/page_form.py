"""Form of the page: the declared options of a job with their choices and defaults."""

from __future__ import annotations

import json
from dataclasses import Field
from html import escape
from typing import Any

from dashpot.base.option_fields import (
    AmplitudeLawOption,
    FormField,
    get_choice_values,
    is_path_field,
    iterate_option_fields,
)
from dashpot.registry import KINDS, load_object
from dashpot.workflow.job import Job

LABELS = {
    "full": "ramp and hold", "hold": "hold", "nonlinear": "curved", "maxwell": "Maxwell",
}  # fmt: skip
"""Labels on the page for the values of options."""


def get_form(kind: str) -> tuple[FormField, ...]:
    """Return the form for the files of a kind of test; empty if it has none."""
    row = KINDS.get(kind)
    return load_object(f"{row.app_form}:FORM_FIELDS") if row is not None and row.app_form else ()


def fill_form(page: str) -> str:
    """Return the page with the options of a job, and the defaults as data."""
    for name in ("method", "law", "family"):
        field = _get_field(Job, name)
        page = page.replace(f"<!-- {name} -->", _render_buttons(field))
        page = page.replace(f"<!-- {name} says -->", escape(field.metadata["help"]))
    law_options = "".join(
        f"<option>{word}</option>" for word in get_choice_values(AmplitudeLawOption)
    )
    page = page.replace("<!-- amplitude-law -->", law_options)
    return page.replace("<!-- defaults -->", json.dumps(get_job_defaults()))


def get_job_defaults() -> dict[str, Any]:
    """Return the default fields of a job, without its parts and files."""
    return {
        field.name: "" if field.default is None else field.default
        for field in iterate_option_fields(Job)
        if not is_path_field(field)
    }


def _get_field(cls: type, name: str) -> Field[Any]:
    return next(field for field in iterate_option_fields(cls) if field.name == name)


def _render_buttons(field: Field[Any]) -> str:
    return "".join(
        f'<button data-{field.name}="{word}" aria-pressed="{str(word == field.default).lower()}">'
        f"{LABELS.get(word, word)}</button>"
        for word in field.metadata["choices"]
    )
