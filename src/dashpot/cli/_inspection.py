"""An inspection as a document and as text, with what preparation sees in a test."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from dashpot.base.errors import DashpotError
from dashpot.cli._shell import failed
from dashpot.cli._text import table

if TYPE_CHECKING:
    from dashpot.base.checks import Check
    from dashpot.io.inspection import Inspection
    from dashpot.io.options import ReadOptions
    from dashpot.records.relaxation import RampHold


def prepared(found: Inspection, path: str, options: ReadOptions) -> RampHold | str | None:
    """Return the prepared test, the sentence why it cannot be prepared, or None if it is none."""
    from dashpot.io.read import read_relaxation
    from dashpot.preparation.prepare import prepare

    if found.kind != "relaxation" or found.questions:
        return None
    try:
        return prepare(read_relaxation(path, options=options))
    except DashpotError as error:
        return str(error)


def document(found: Inspection, test: RampHold | str | None) -> dict[str, Any]:
    """Return an inspection as plain values; a prepared test adds its segments and checks."""
    whole = asdict(found)
    if isinstance(test, str):
        whole["preparation"] = {"error": test}
    elif test is not None:
        whole["preparation"] = {
            "onset": test.onset,
            "ramp_end": test.ramp_end,
            "hold_end": test.hold_end,
            "ramp_time": test.ramp_time,
            "hold_time": test.hold_time,
            "depth": test.depth,
            "preload": test.preload,
            "force_noise": test.force_noise,
            "displacement_noise": test.displacement_noise,
            "steps": [asdict(step) for step in test.steps],
            "checks": [asdict(check) for check in test.checks],
        }
    return whole


def checks(test: RampHold | str | None) -> tuple[Check, ...]:
    """Return what preparation noticed."""
    return () if test is None or isinstance(test, str) else test.checks


def text(found: Inspection, test: RampHold | str | None) -> str:
    """Return an inspection for people."""
    how = ", ".join(
        part
        for part in (
            found.format,
            found.encoding,
            f"delimiter {_shown(found.delimiter)}" if found.delimiter else "",
            f"decimal {found.decimal!r}" if found.decimal else "",
        )
        if part
    )
    lines = [f"{found.file}: {found.kind} ({found.reason})", f"  format    {how}"]
    if found.simulated:
        lines.append("  SIMULATED: made by the virtual rig or hammer, not measured")
    lines.append(f"  sampling  {_sampling(found)}")
    if len(found.header):
        lines.append(f"  header    {len(found.header)} lines above the table")
    rows = [["  #", "column", "unit", "role", "because"]]
    rows += [
        [
            f"  {column.number}",
            column.name or "(no name)",
            column.unit or "?",
            column.role or "-",
            column.reason,
        ]
        for column in found.columns
    ]
    lines += table(rows, left=True)
    for segment in found.segments:
        lines.append(f"  segment   {segment.name}: {segment.rows} rows")
    lines += [f"  note      {warning}" for warning in found.warnings]
    lines += [f"  ASK       {question.says}" for question in found.questions]
    lines += _segments(test)
    return "\n".join(lines)


def _segments(test: RampHold | str | None) -> list[str]:
    if test is None:
        return []
    if isinstance(test, str):
        return [f"  ! cannot be prepared: {test}"]
    return [
        (
            f"  ramp      {test.onset:.4g} to {test.ramp_end:.4g} s ({test.ramp_time:.4g} s), "
            f"{test.depth * 1e3:.4g} mm"
        ),
        f"  hold      to {test.hold_end:.5g} s ({test.hold_time:.4g} s)",
        (
            f"  noise     force {test.force_noise * 1e3:.3g} mN, "
            f"displacement {test.displacement_noise * 1e6:.3g} um"
        ),
        *failed(test.checks),
    ]


def _sampling(found: Inspection) -> str:
    if found.rate is None:
        return f"{found.rows} rows, no clock"
    even = "even" if found.even else "uneven"
    duration = "" if found.duration is None else f" over {found.duration:.5g} s"
    return f"{found.rows} rows, {found.rate:.6g} Hz, {even}{duration}"


def _shown(mark: str) -> str:
    return {"\t": "tab", " ": "space"}.get(mark, repr(mark))
