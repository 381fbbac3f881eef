"""Output of a result: figure, notebook view and files."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import singledispatch
from html import escape
from pathlib import Path
from typing import Any

from dashpot import plot
from dashpot.base.errors import ExportError
from dashpot.base.option_fields import FigureFormat, get_choice_values
from dashpot.base.serialisation import Serialisable
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.plot import Picture
from dashpot.reading.readers.inspect import Inspection
from dashpot.reading.write import write_frf, write_impact, write_relaxation
from dashpot.registry import figure_of
from dashpot.vibration.comparison.comparison_result import Comparison
from dashpot.workflow.frf_comparison import FRFComparison
from dashpot.workflow.frf_prediction import Prediction
from dashpot.workflow.identification import IdentificationResult
from dashpot.workflow.measured_frf import Modes
from dashpot.workflow.outputs import Outputs
from dashpot.workflow.study import Study

# Writing of a record or result by the suffix of the file.


_TABLES: dict[type, Callable[..., str]] = {
    FRF: write_frf,
    ImpactTest: write_impact,
    RelaxationTest: write_relaxation,
}
"""Writers of tables that every tool here reads back."""


def save(result: Any, path: str | Path, *, overwrite: bool = False) -> Path:
    """Write a record or a result, and return its path.

    ``.json``: its document, which ``dashpot.read`` takes back where it has a schema; ``.png``,
    ``.svg``, ``.pdf``: its figure; ``.html``: its page; ``.csv``: its numbers.

    Raises
    ------
    ExportError
        If it has none of the kind that the name asks for, or the file cannot be written, or exists
        and is not dashpot's; `overwrite` replaces that.
    """
    file_path = Path(path)
    outputs = Outputs(replace=overwrite, makes_records=isinstance(result, tuple(_TABLES)))
    suffix = file_path.suffix.lower().lstrip(".")
    writers = {"json": _write_document, "html": _write_page, "csv": _write_table}
    if suffix in get_choice_values(FigureFormat):
        from dashpot.plot.figure_files import save as save_picture

        outputs.check_writable([file_path])
        save_picture(_picture(result), file_path)
    elif suffix in writers:
        outputs.write(file_path, writers[suffix](result, file_path.name))
    else:
        suffixes = ", ".join(
            f".{writer}" for writer in (*writers, *get_choice_values(FigureFormat))
        )
        raise ExportError(f"{file_path.name}: a result is written as {suffixes}. Name the file so")
    return file_path


def _picture(result: Any) -> Any:
    if not hasattr(result, "plot"):
        raise ExportError(f"a {type(result).__name__} has no figure. Write it as .json")
    return result.plot()


def _write_document(document: Any, name: str) -> str:
    if not isinstance(document, Serialisable):
        raise ExportError(f"{name}: a {type(document).__name__} has no document")
    return json.dumps(document.to_dict(), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _write_page(item: Any, name: str) -> str:
    from dashpot.report import has_page, html

    if not has_page(item):
        raise ExportError(
            f"{name}: a {type(item).__name__} has no page of its own. Write it as .json, or make a "
            'report: dp.report(test, hits).save("report.html")'
        )
    return html(item)


def _write_table(result: Any, name: str) -> str:
    if hasattr(result, "csv"):
        return str(result.csv())
    frf = getattr(result, "frf", None)
    result = frf if isinstance(frf, FRF) else result
    for kind, write in _TABLES.items():
        if isinstance(result, kind):
            return str(write(result))
    raise ExportError(
        f"{name}: a {type(result).__name__} has no table. Write it as .json "
        "(Python: its numbers are .to_pandas())"
    )


# Figure of a result, and its view in a notebook.


@singledispatch
def picture(result: object) -> Picture:
    """Return the figure of a result; that of a kind of test, or a door, is named in the
    registry.
    """
    draw = figure_of(result)
    if draw is None:
        raise TypeError(f"a {type(result).__name__} has no figure")
    figure: Picture = draw(result)
    return figure


picture.register(Fit, plot.stiffness)
picture.register(Comparison, plot.comparison)
picture.register(Study, plot.hero)


@picture.register
def _(result: IdentificationResult) -> Picture:
    return plot.stiffness(result.fit)


@picture.register
def _(result: Modes) -> Picture:
    return plot.frf(result.frf, labels=("measured",), stamp=plot.stamp(result.frf.source))


@picture.register
def _(result: FRFComparison) -> Picture:
    return plot.comparison(result.comparison, band=result.limits, interval=result.interval)


@picture.register
def _(result: Inspection) -> Picture:
    names = [f"{column.name or column.number} [{column.unit or '?'}]" for column in result.columns]
    roles = [column.role for column in result.columns]
    stamp_text = f"{result.file}{', SIMULATED' * result.simulated}"
    return plot.columns(names, roles, result.course, stamp=stamp_text)


def draw_prediction(
    prediction: Prediction,
    *levels: FRF,
    labels: Sequence[str] = ("predicted",),
    **figure_options: Any,
) -> Picture:
    """Return the picture of a prediction, and of FRFs at levels."""
    fit, rig = prediction.fit, {"mass": prediction.mass, "seals": prediction.seals}
    return plot.frf(
        prediction.frf,
        *levels,
        labels=labels,
        band=prediction.limits,
        interval=prediction.interval,
        valid_band=fit.band,
        stamp=plot.stamp(fit.source, fit.specimen, **rig),
        **figure_options,
    )


def html(result: object) -> str:
    """Return a result's text above its figure, as a piece of an HTML page."""
    words = repr(result)
    # pictures on one page must not share their ids
    name = "n" + hashlib.sha256(words.encode()).hexdigest()[:12]
    drawing = plot.to_svg(replace(picture(result), name=name))
    return f"<div><pre>{escape(words)}</pre>{drawing}</div>"
