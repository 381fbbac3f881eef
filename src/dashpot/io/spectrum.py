"""From a file to an FRF or a dynamic (DMA) test."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from dashpot import units
from dashpot._arrays import ComplexArray, FloatArray
from dashpot.errors import DataError, ReadError
from dashpot.io import channels
from dashpot.io.formats import read_table
from dashpot.io.kinds import kind_of
from dashpot.io.opening import Raw, about, open_raw
from dashpot.io.options import ReadOptions
from dashpot.io.roles import Assigned, assign, list_columns, unit_for
from dashpot.io.table import Question, Table
from dashpot.io.vocabulary import Role
from dashpot.provenance import Source
from dashpot.relaxation.dynamic import DynamicTest
from dashpot.relaxation.records import Specimen
from dashpot.vibration.frf import FRF, Kind

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
    table = read_table(raw, options)
    if table.doubts:
        raise ReadError(f"{raw.name}: {table.doubts[0].says}")
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
    kind, factor = _kind(raw, table, index["real"] if cartesian else index["magnitude"])
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


def _kind(raw: Raw, table: Table, index: int | None) -> tuple[Kind, float]:
    """Kind of the FRF and the factor to SI, from the unit, held against a ``kind:`` comment."""
    for line in table.header:
        match = re.match(r"\W*kind\s*:\s*(\w+)", line)
        if match and match[1] in set(Kind):
            stated: Kind | None = Kind(match[1])
            break
    else:
        stated = None
    column = table.columns[index or 0]
    ratio = _ratio(column.unit or "")
    if ratio is None:
        raise ReadError(
            f"{raw.name}: '{column.name}' has the unit '{column.unit or ''}', which tells no FRF; "
            "expected motion per force such as (m/s^2)/N, g/N, m/N, or force per motion such as "
            f"N/m; write it into the header as '{column.name} [(m/s^2)/N]'"
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
    return np.asarray(column["magnitude"] * np.exp(1j * column["phase"] * angle.factor))


def _hertz(raw: Raw, table: Table, index: int, options: ReadOptions) -> float:
    try:
        return unit_for(table.columns[index], index + 1, "frequency", options).factor
    except ReadError as error:
        raise ReadError(f"{raw.name}: {error}") from None


def read_dynamic(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> DynamicTest:
    """Return the dynamic (DMA) test in a file, in SI units.

    Raises
    ------
    ReadError
        If frequency, storage or loss is not found, or has no unit.
    """
    options = options or ReadOptions()
    raw = open_raw(path)
    table = read_table(raw, options)
    if table.doubts:
        raise ReadError(f"{raw.name}: {table.doubts[0].says}")
    roles: tuple[Role, ...] = ("frequency", "storage", "loss")
    with about(raw):
        found = {role: assign(table, role, options) for role in roles}
    asked = [answer.says for answer in found.values() if isinstance(answer, Question)]
    if asked:
        kind, reason = kind_of(table, options)
        hint = f" (it is not a DMA test: {reason})" if kind not in {"dma", "unclear"} else ""
        raise ReadError(f"{raw.name}: " + "; ".join(asked) + hint)
    with about(raw):
        found["temperature"] = assign(table, "temperature", options)
    chosen = {role: answer for role, answer in found.items() if isinstance(answer, Assigned)}
    values, says, scale = {}, [], {}
    loaded = channels.load(table, [one.index for one in chosen.values()], options, raw.name)
    whole = np.isfinite(loaded.values).all(axis=1)
    for j, (role, one) in enumerate(chosen.items()):
        column = table.columns[one.index]
        try:
            unit = unit_for(column, one.index + 1, role, options)
        except ReadError as error:
            raise ReadError(f"{raw.name}: {error}") from None
        values[role] = loaded.values[whole, j] * unit.factor + unit.offset
        scale[role] = unit.dimension
        says.append(f"{role}: {column.label(one.index + 1)} [{unit.word}]")
    if scale["storage"] != scale["loss"]:
        raise ReadError(
            f"{raw.name}: storage is a {scale['storage']} and loss a {scale['loss']}; "
            "expected both in one kind of unit, such as MPa or N/mm"
        )
    notes = [*table.notes, *loaded.notes]
    if not whole.all():
        row = int(np.flatnonzero(~whole)[0])
        notes.append(
            f"{int((~whole).sum())} rows lack a number and were left out, first {loaded.where(row)}"
        )
    source = Source(raw.name, raw.sha256, table.format, tuple(says), tuple(notes), table.simulated)
    try:
        return DynamicTest(
            values["frequency"], values["storage"], values["loss"], values.get("temperature"),
            "N/m" if scale["storage"] == "stiffness" else "Pa", specimen or Specimen(), source,
        )  # fmt: skip
    except DataError as error:
        raise ReadError(f"{raw.name}: {error}") from None
