"""From a file to an FRF."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from dashpot.base import units
from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import DataError, ReadError
from dashpot.base.provenance import Source
from dashpot.io.columns.roles import Assigned, assign, list_columns, unit_for
from dashpot.io.columns.vocabulary import Role
from dashpot.io.options import ReadOptions
from dashpot.io.readers import channels
from dashpot.io.source import Raw, about, open_raw
from dashpot.io.table import Table
from dashpot.records.frf import FRF, Kind

_KINDS: dict[tuple[str, str], Kind] = {
    ("length", "force"): Kind.RECEPTANCE,
    ("velocity", "force"): Kind.MOBILITY,
    ("acceleration", "force"): Kind.ACCELERANCE,
    ("force", "length"): Kind.DYNAMIC_STIFFNESS,
}


def read_frf(path: str | Path, *, options: ReadOptions | None = None) -> FRF:
    """Return the FRF in a UFF file, or in a text file as `write_frf` writes it.

    A text file of another origin needs frequency with real and imaginary part, or with
    magnitude and phase, and a unit such as ``(m/s^2)/N`` that tells the kind.

    Raises
    ------
    ReadError
        If there is no FRF in the file, or its kind or unit is left open.
    """
    options = options or ReadOptions()
    raw = open_raw(path)
    table = channels.sure_table(raw, options)
    with about(raw):
        index = {role: _maybe(table, role, options) for role in _FRF_ROLES}
    cartesian = index["real"] is not None and index["imaginary"] is not None
    polar = index["magnitude"] is not None and index["phase"] is not None
    if index["frequency"] is None or not (cartesian or polar):
        raise ReadError(
            f"{raw.name}: no frequency response found; expected columns such as 'frequency [Hz], "
            f"real [(m/s^2)/N], imaginary [(m/s^2)/N]' (or magnitude and phase); the columns are "
            f"{list_columns(table.columns)}"
        )
    said = _comments(table.header)
    loaded = channels.load(table, range(len(table.columns)), ReadOptions(), raw.name)
    column = {role: loaded.values[:, i] for role, i in index.items() if i is not None}
    role: Role = "real" if cartesian else "magnitude"
    kind, factor = _kind(raw, table, role, index[role], options)
    value: ComplexArray = np.asarray(
        column["real"] + 1j * column["imaginary"]
        if cartesian
        else _polar(raw, table, index, column)
    )
    frequency = column["frequency"] * _hertz(raw, table, index["frequency"], options)
    sd = next((i for i, c in enumerate(table.columns) if c.name.casefold() == "sd"), None)
    source = Source(
        raw.name, raw.sha256, table.format, tuple(c.name for c in table.columns),
        (*table.notes, *loaded.notes), table.simulated,
    )  # fmt: skip
    try:
        return FRF(
            frequency, value * factor, kind,
            coherence=column.get("coherence"),
            sd=None if sd is None else loaded.values[:, sd] * factor,
            shift=said.get("shift", 0.0), record=said.get("record"),
            averages=int(said.get("averages", 0)), source=(source,),
        )  # fmt: skip
    except DataError as error:
        raise ReadError(f"{raw.name}: {error}") from None


_FRF_ROLES: tuple[Role, ...] = ("frequency", "real", "imaginary", "magnitude", "phase", "coherence")


def _maybe(table: Table, role: Role, options: ReadOptions) -> int | None:
    answer = assign(table, role, options)
    return answer.index if isinstance(answer, Assigned) else None


def _comments(header: tuple[str, ...]) -> dict[str, float]:
    """Numbers such as ``# shift [1/s]: 0.5`` by their name."""
    found = {}
    for line in header:
        match = re.match(
            r"\W*(shift|record|averages)\s*(?:\[[^\]]*\])?\s*:\s*([-+.\deE]+)\s*$", line
        )
        if match:
            try:
                found[match[1]] = float(match[2])
            except ValueError:
                continue
    return found


def _kind(
    raw: Raw, table: Table, role: Role, index: int | None, options: ReadOptions
) -> tuple[Kind, float]:
    """Kind of the FRF and the factor to SI, from the unit, held against a ``kind:`` comment."""
    for line in table.header:
        match = re.match(r"\W*kind\s*:\s*(\w+)", line)
        if match and match[1] in set(Kind):
            stated: Kind | None = Kind(match[1])
            break
    else:
        stated = None
    column = table.columns[index or 0]
    word = options.unit_of(role, column.name) or column.unit or ""
    ratio = _ratio(word)
    if ratio is None:
        raise ReadError(
            f"{raw.name}: '{column.name}' has the unit '{word}', which tells no FRF; "
            "expected motion per force such as (m/s^2)/N, g/N, m/N, or force per motion such as "
            f'N/m; add --units "{role}=(m/s^2)/N", or write it into the header'
        )
    kind, factor = ratio
    if stated is not None and stated is not kind:
        raise ReadError(
            f"{raw.name}: the comment says {stated.value}, but the unit '{column.unit}' is that of "
            f"{kind.value}; correct one of them"
        )
    return kind, factor


def _ratio(word: str) -> tuple[Kind, float] | None:
    """Kind and SI factor of a unit such as ``(m/s^2)/N`` or ``1/kg``."""
    text = word.replace(" s)", "*s)").strip()
    if text == "1/kg":
        return Kind.ACCELERANCE, 1.0
    if text in {"m/(N*s)", "m/(N·s)"}:
        return Kind.MOBILITY, 1.0
    swapped = re.fullmatch(r"\(?1/(\w+)\)?\s*[*·]\s*(.+)", text)  # (1/N)*(m/s^2)
    top, slash, bottom = (swapped[2], "/", swapped[1]) if swapped else text.rpartition("/")
    for (upper, lower), kind in _KINDS.items():
        a = units.find(top.strip("() "), upper)  # type: ignore[arg-type]
        b = units.find(bottom.strip("() "), lower)  # type: ignore[arg-type]
        if slash and a is not None and b is not None:
            return kind, a.factor / b.factor
    return None


def _polar(
    raw: Raw, table: Table, index: dict[Role, int | None], column: dict[Role, FloatArray]
) -> ComplexArray:
    unit = table.columns[index["phase"] or 0].unit
    angle = units.find(unit or "", "angle")
    if angle is None:
        raise ReadError(
            f"{raw.name}: the phase has no unit; write 'phase [deg]' or 'phase [rad]' in the header"
        )
    magnitude = column["magnitude"]
    if (table.columns[index["magnitude"] or 0].unit or "").casefold().startswith("db"):
        magnitude = 10 ** (magnitude / 20)  # dB re 1 of the unit given by --units
    return np.asarray(magnitude * np.exp(1j * column["phase"] * angle.factor))


def _hertz(raw: Raw, table: Table, index: int, options: ReadOptions) -> float:
    try:
        return unit_for(table.columns[index], index + 1, "frequency", options).factor
    except ReadError as error:
        raise ReadError(f"{raw.name}: {error}") from None
