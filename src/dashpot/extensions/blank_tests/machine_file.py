"""Machine file: results of blank tests as TOML, written and read."""

from __future__ import annotations

import datetime as dt
import json
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

from dashpot.base.errors import DataError, ReadError
from dashpot.base.number_format import format_count
from dashpot.base.option_fields import iterate_option_fields
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import Dimension, convert_to_unit
from dashpot.base.version import __version__, byline
from dashpot.datamodel.machine import DEFAULT_UNCERTAINTIES, Machine, MachineCalibration
from dashpot.extensions.blank_tests.datamodel import MachineFit
from dashpot.reading.toml import Section, read_tables

_DIMENSIONS: Mapping[str, Dimension] = {
    "delay": "time",
    "compliance_error": "compliance",
    "settling": "length",
}
_RATIOS = ("gain", "gain_error")
_VERDICTS = ("use", "use with care", "do not use")
_FILE_UNITS = {
    "sync": "ms", "delay": "ms", "drift": "mN/s", "compliance": "um/N", "compliance_error": "um/N",
    "creep": "um", "settling": "um",
}  # fmt: skip
"""Units of the values in a machine file."""
_ORIGIN = (
    "date", "dashpot", "verdict", "files", "roles", "sha256", "spring_stiffness", "spring_error",
    "intervals",
)  # fmt: skip


def render_machine_file(fit: MachineFit, *, date: str = "") -> str:
    """Return the TOML of a machine file.

    Parameters
    ----------
    fit : MachineFit
    date : str
        Date of the blank tests, year-month-day; by default today.
    """
    machine = fit.machine
    calibration = machine.calibration or MachineCalibration()
    entries = {field.name: getattr(machine, field.name) for field in iterate_option_fields(machine)}
    entries |= {name: getattr(calibration, name) for name in (*_DIMENSIONS, *_RATIOS)}
    lines = [f"# {byline('machine file, from blank tests')}", "", "[machine]"]
    lines += [
        f"{name.replace('_', '-')} = {_render_value(name, value)}"
        for name, value in entries.items()
        if value is not None
    ]
    origin: dict[str, Any] = {
        "date": date or dt.datetime.now(dt.UTC).date().isoformat(),
        "dashpot": __version__,
        "verdict": fit.verdict.use,
        "files": [record.file for record in fit.records],
        "roles": [record.role for record in fit.records],
        "sha256": [source.sha256 for source in fit.sources],
    }
    if fit.spring_stiffness is not None:
        origin["spring-stiffness"] = f"{convert_to_unit(fit.spring_stiffness, 'N/mm'):.6g} N/mm"
        origin["spring-error"] = f"{convert_to_unit(fit.spring_error or 0.0, '%'):.4g} %"
    lines += ["", "[blank]", *(f"{name} = {json.dumps(value)}" for name, value in origin.items())]
    lines += ["", "[blank.intervals]", *map(_render_interval, fit.reported_values)]
    return "\n".join([*lines, ""])


def _render_value(name: str, value: float) -> str:
    if name in _RATIOS:
        return f"{value:.8g}"
    return json.dumps(f"{convert_to_unit(value, _FILE_UNITS[name]):.7g} {_FILE_UNITS[name]}")


def _render_interval(value: ReportedValue) -> str:
    """Return a fitted number with its 95 % interval as a line of TOML."""
    cells = value.cells
    text = " ".join(f"{cells.value} ({cells.interval}) {cells.unit}".split())
    return f"{value.name.replace('_', '-')} = {json.dumps(text.replace(' ()', ''))}"


def read_machine_file(path: str | Path, **_: Any) -> Machine:
    """Return the machine of a machine file.

    Raises
    ------
    ReadError
        If it is no machine file, or a number of it cannot be used.
    """
    raw, tables = read_tables(path)
    file_name = raw.name
    if "machine" not in tables:
        raise ReadError(
            f"{file_name}: the table [machine] is missing. Write the file from blank tests: "
            "dashpot fit stop.csv spring.csv empty.csv --kind blank -o rig.toml"
        )
    for name in tables:
        if name not in {"machine", "blank"}:
            raise ReadError(f"{file_name}: [{name}] is unknown; known are [machine] and [blank]")
    options = {field.name: field for field in iterate_option_fields(Machine())}
    names = (*options, *_DIMENSIONS, *_RATIOS)
    section = _open_section(f"{file_name}, [machine]", tables["machine"], names)
    values: dict[str, Any] = {
        name: section.quantity(name, field.metadata["unit"]) for name, field in options.items()
    }
    calibration: dict[str, Any] = {
        name: section.quantity(name, dimension) for name, dimension in _DIMENSIONS.items()
    }
    calibration |= {name: section.number(name) for name in _RATIOS}
    calibration = {name: value for name, value in calibration.items() if value is not None}
    _refuse_gain(file_name, calibration)
    if calibration:
        _complete_errors(file_name, values["compliance"], calibration)
    source = _describe_origin(
        file_name, _open_section(f"{file_name}, [blank]", tables.get("blank", {}), _ORIGIN)
    )
    if calibration:
        values["calibration"] = MachineCalibration(**calibration, source=source)
    try:
        return Machine(**values)
    except DataError as error:
        raise ReadError(f"{file_name}: {error}") from None


class MachineFields(Mapping[str, Any]):
    """Fields of a machine that ``--machine FILE`` states; they are read when one is requested."""

    def __init__(self, path: str) -> None:
        self.path = path

    @cached_property
    def fields(self) -> dict[str, Any]:
        """Fields that are stated, SI."""
        machine = read_machine_file(self.path)
        names = [field.name for field in iterate_option_fields(machine)]
        fields = {name: getattr(machine, name) for name in (*names, "calibration")}
        return {name: value for name, value in fields.items() if value is not None}

    def __getitem__(self, name: str) -> Any:
        return self.fields[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.fields)

    def __len__(self) -> int:
        return len(self.fields)


def _open_section(file_name: str, entries: Any, names: tuple[str, ...]) -> Section:
    """Return a table with underscores for the dashes in its keys."""
    if isinstance(entries, Mapping):
        for name in entries:
            if "_" in name and name.replace("_", "-") in entries:
                raise ReadError(f"{file_name}: {name} and {name.replace('_', '-')} are one key")
        entries = {name.replace("-", "_"): value for name, value in entries.items()}
    return Section(file_name, entries, names)


def _refuse_gain(file_name: str, calibration: Mapping[str, float]) -> None:
    gain = calibration.get("gain", 1.0)
    if not 0.1 < gain < 10:
        raise ReadError(f"{file_name}: gain = {gain:.4g}; expected 0.1 to 10, such as 1.002")
    for name in ("gain_error", "compliance_error"):
        if calibration.get(name, 0.0) < 0:
            raise ReadError(
                f"{file_name}: {name.replace('_', '-')} = {calibration[name]:.4g}; expected a "
                "number >= 0"
            )


def _complete_errors(
    file_name: str, compliance: float | None, calibration: dict[str, float]
) -> None:
    """Add the default error of a compliance without one; refuse an error without its value.

    A correction without an error would count as exact.
    """
    if calibration.get("gain", 1.0) != 1 and "gain_error" not in calibration:
        raise ReadError(
            f"{file_name}: gain = {calibration['gain']:.6g} without its standard error, which "
            "would make it exact. Add gain-error, such as 0.002"
        )
    given_errors = [name for name in ("gain_error", "compliance_error") if calibration.get(name)]
    if compliance is None and given_errors:
        raise ReadError(
            f"{file_name}: {given_errors[0].replace('_', '-')} has no effect without compliance. "
            "Add compliance, 0um/N if the displacement is measured at the seal"
        )
    if compliance is not None and "compliance_error" not in calibration:
        calibration["compliance_error"] = DEFAULT_UNCERTAINTIES["give, named"].size * compliance


def _describe_origin(file_name: str, origin: Section) -> str:
    """Return the name of a machine file with the date, age and verdict of its tests.

    Raises
    ------
    ReadError
        If its date is invalid or in the future, or its verdict is unknown or "do not use".
    """
    text = f"machine file {file_name}"
    date_text = origin.entries.get("date")
    if isinstance(date_text, dt.date):  # TOML has dates, too
        date: str | None = date_text.isoformat()[:10]
    else:
        date = origin.word("date")
    if date is not None:
        try:
            day = dt.date.fromisoformat(date)
        except ValueError:
            raise ReadError(
                f"{file_name}: date = {date!r}; expected year-month-day, such as 2026-11-21"
            ) from None
        age = (dt.datetime.now(dt.UTC).date() - day).days
        if age < -1:  # a day may differ between zones
            raise ReadError(
                f"{file_name}: date = {date!r} lies {format_count(-age, 'day')} ahead; expected "
                "that of the blank tests"
            )
        text += f", measured {date} ({format_count(age, 'day') + ' ago' if age > 0 else 'today'})"
    verdict = origin.word("verdict")
    if verdict not in {None, *_VERDICTS}:
        raise ReadError(
            f"{file_name}: verdict = {verdict!r}; expected {', '.join(map(repr, _VERDICTS))}"
        )
    if verdict == "do not use":
        raise ReadError(
            f"{file_name}: the verdict of its blank tests is 'do not use'. Repeat them, and write "
            "the file anew"
        )
    return text if verdict in {None, "use"} else f"{text}, verdict of its tests: {verdict}"
