"""Many relaxation tests over each other: force per depth after the ramp, and a table of numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dashpot.base.errors import DashpotError, DataError
from dashpot.base.number_format import duration, format_count, percent, round_to_error
from dashpot.base.progress import send_progress
from dashpot.base.units import convert_to_unit
from dashpot.datamodel.fit import Fit, list_model_values
from dashpot.datamodel.relaxation import RampHold
from dashpot.extensions.app import result_cache, view_models, wire_format
from dashpot.extensions.app.command_lines import format_job_command, format_options
from dashpot.extensions.app.request_parsing import (
    build_job,
    get_list,
    get_panel_sizes,
    require_text,
)
from dashpot.plot.picture import Line, Mark, Panel, Pen, Scale
from dashpot.plot.plotted_data import compute_padded_limits, downsample_to_means
from dashpot.plot.relaxation import TIME_AFTER_RAMP_LABEL
from dashpot.plot.style import sequential
from dashpot.report.page_frame import VERDICT_COLOURS
from dashpot.workflow.job import Job

MAX_TESTS = 60
"""Largest number of overlaid tests."""
MAX_NAMES = 6
"""Largest number of names in the key; other names are only in the table."""


class OverlaidTest(NamedTuple):
    """Test with its fit; an error if there is none."""

    name: str
    file: str
    job: Job
    fit: Fit | None
    prepared: RampHold | None
    error: str = ""

    @property
    def stiffness(self) -> float:
        """Stiffness at the end of its hold, N/mm; nan without a fit."""
        if self.fit is None or self.prepared is None:
            return float("nan")
        return convert_to_unit(float(self.fit.solid.relaxation(self.prepared.hold_time)), "N/mm")


class OverlaidRow(NamedTuple):
    """Row of the table of tests."""

    name: str
    file: str
    depth: str
    end: str
    value: str
    low: str
    high: str
    difference: str
    mark: str
    verdict: str


def overlay_tests(request: Mapping[str, Any], folder: Path) -> bytes:
    """Return the figure and the table of all tests that are open, each fitted alone."""
    jobs = get_list(request, "jobs")
    if not 0 < len(jobs) <= MAX_TESTS:
        raise DataError(f"{format_count(len(jobs), 'test')}; expected 1 to {MAX_TESTS}")
    tests = [_fit_test(options, folder) for options in jobs]
    fitted_tests = [test for test in tests if test.fit is not None]
    median = (
        float(np.median([test.stiffness for test in fitted_tests]))
        if fitted_tests
        else float("nan")
    )
    sizes = get_panel_sizes(request)
    return wire_format.encode_message(
        {
            "verdict": view_models.render_template(
                "overlaid", message=_format_message(tests, median)
            ),
            "colour": "open",
            "panels": {"seals-hold": _render_hold_panel(fitted_tests, sizes)}
            if fitted_tests
            else {},
            "table": view_models.render_template(
                "overlaid_table", rows=[_make_row(test, median) for test in tests]
            ),
            "simulated": any(
                source.simulated for test in fitted_tests if test.fit for source in test.fit.source
            ),
            "command": "\n".join(format_job_command("fit", test.job) for test in tests),
        }
    )


def _fit_test(options: Any, folder: Path) -> OverlaidTest:
    job = result_cache.select_fit_choices(build_job(options, folder))
    file, name = require_text(options, "relaxation"), Path(job.relaxation).name
    selection = format_options(job.reading, "sheet", "segment")[1::2]
    name = f"{name} [{','.join(selection)}]" if selection else name
    send_progress(f"fitting {name}")
    try:
        fit = result_cache.fit_job(job, True, None)
        ramp_hold = result_cache.select_shown_test(job, fit)[1]
    except DashpotError as error:
        return OverlaidTest(name, file, job, None, None, str(error))
    return OverlaidTest(name, file, job, fit, ramp_hold)


def _format_message(tests: Sequence[OverlaidTest], median: float) -> str:
    fitted_tests = [test for test in tests if test.fit is not None]
    if not fitted_tests:
        return "None of the tests could be fitted: the table says why."
    values = [test.stiffness for test in fitted_tests]
    farthest_test = max(fitted_tests, key=lambda test: abs(test.stiffness - median))
    difference = percent(farthest_test.stiffness / median - 1)
    text = (
        f"Stiffness at the end of the hold: {round_to_error(min(values), digits=4)} to "
        f"{round_to_error(max(values), digits=4)} N/mm, median {round_to_error(median, digits=4)} "
        f"N/mm. Farthest from it: {farthest_test.name}, {difference}."
    )
    missing = len(tests) - len(fitted_tests)
    return f"{text} {format_count(missing, 'test')} not fitted." if missing else text


def _render_hold_panel(tests: Sequence[OverlaidTest], sizes: view_models.Sizes) -> str:
    """Return force over depth of every test against time since the end of its ramp."""
    tests_by_stiffness = sorted(tests, key=lambda test: test.stiffness)
    colours = dict(
        zip(
            (test.file for test in tests_by_stiffness),
            sequential(len(tests_by_stiffness)),
            strict=True,
        )
    )
    marks: list[Mark] = []
    for test in tests:
        if test.prepared is None:
            continue
        # a first sample may follow the end of the ramp by any part of a step: no axis for that
        step = float(np.median(np.diff(test.prepared.time)))
        is_held = test.prepared.time > test.prepared.ramp_end + step / 2
        time_since_ramp = test.prepared.time[is_held] - test.prepared.ramp_end
        stiffness = convert_to_unit(test.prepared.force[is_held] / test.prepared.depth, "N/mm")
        x, y = downsample_to_means(time_since_ramp, stiffness, log=True)
        marks.append(Line(x, y, Pen(colours[test.file], 1.8), test.name))
    curves = [mark for mark in marks if isinstance(mark, Line)]
    time_span = min(mark.x[0] for mark in curves), max(mark.x[-1] for mark in curves)
    panel = Panel(
        Scale(TIME_AFTER_RAMP_LABEL, (float(time_span[0]), float(time_span[1])), log=True),
        Scale("force over depth, N/mm", compute_padded_limits(*(mark.y for mark in curves))),
        tuple(marks),
    )
    note = (
        ""
        if len(tests) <= MAX_NAMES
        else f"{len(tests)} tests, coloured from the softest to the stiffest"
    )
    title = "Force over depth, N/mm"
    return view_models.render_panels("seals-hold", panel, sizes, title=title, note=note)


def _make_row(test: OverlaidTest, median: float) -> OverlaidRow:
    if test.fit is None or test.prepared is None:
        return OverlaidRow(test.name, test.file, "", "", "", "", "", "", "bad", test.error)
    facts = {fact.name: fact for fact in list_model_values(test.fit)}
    fact = facts.get("k_end", facts.get("k_inf"))
    value, low, high = ("", "", "") if fact is None else fact.cell_texts
    return OverlaidRow(
        test.name, test.file, round_to_error(convert_to_unit(test.prepared.depth, "mm"), digits=3),
        duration(test.prepared.hold_time), value, low, high,
        percent(test.stiffness / median - 1), VERDICT_COLOURS[test.fit.verdict.use],
        test.fit.verdict.use,
    )  # fmt: skip
