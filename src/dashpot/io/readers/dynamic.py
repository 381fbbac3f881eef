"""From a file to a dynamic (DMA) test."""

from __future__ import annotations

from pathlib import Path

from dashpot.base.errors import DataError, ReadError
from dashpot.io.columns.kinds import kind_of
from dashpot.io.columns.roles import Assigned, assign
from dashpot.io.columns.vocabulary import Role
from dashpot.io.options import ReadOptions
from dashpot.io.readers import channels
from dashpot.io.source import Raw, about, open_raw
from dashpot.io.table import Question, Table
from dashpot.records.dynamic import DynamicTest
from dashpot.records.specimen import Specimen

_ROLES: tuple[Role, ...] = ("frequency", "storage", "loss")


def read_dynamic(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> DynamicTest:
    """Return the dynamic (DMA) test in a file, in SI units.

    Storage and loss are moduli or stiffnesses; where there is no loss, it is storage times the
    loss factor (tan delta). Rows that lack a number are left out with a note.

    Raises
    ------
    ReadError
        If frequency, storage or loss is not found, or has no unit.
    """
    options = options or ReadOptions()
    raw = open_raw(path)
    table = channels.sure_table(raw, options)
    with about(raw):
        wanted, ratio = _columns(raw, table, options)
    chosen = channels.with_units(raw, table, wanted, options)
    indexes = [c.index for c in chosen] + ([] if ratio is None else [ratio])
    loaded = channels.load(table, indexes, options, raw.name)
    rows, gaps = channels.whole_rows(loaded)
    values = {c.role: channels.si(rows[:, j].copy(), c.unit) for j, c in enumerate(chosen)}
    kinds = {c.role: c.unit.dimension for c in chosen}
    notes = [*table.notes, *gaps]
    if ratio is not None:
        percent = table.columns[ratio].unit == "%"
        values["loss"] = values["storage"] * rows[:, -1] / (100 if percent else 1)
        notes.append(f"loss is storage times '{table.columns[ratio].name}'")
    elif kinds["storage"] != kinds["loss"]:
        raise ReadError(
            f"{raw.name}: storage is a {kinds['storage']} and loss a {kinds['loss']}; "
            "expected both in one kind of unit, such as MPa or N/mm"
        )
    try:
        return DynamicTest(
            values["frequency"],
            values["storage"],
            values["loss"],
            values.get("temperature"),
            "N/m" if kinds["storage"] == "stiffness" else "Pa",
            specimen or Specimen(),
            channels.source(raw, table, chosen, notes),
        )
    except DataError as error:
        raise ReadError(f"{raw.name}: {error}") from None


def _columns(raw: Raw, table: Table, options: ReadOptions) -> tuple[list[Assigned], int | None]:
    """The columns by role, and that of the loss factor if there is no loss."""
    found = {role: assign(table, role, options) for role in _ROLES}
    ratio = None
    if isinstance(found["loss"], Question):
        answer = assign(table, "loss_factor", options)
        if isinstance(answer, Assigned):
            ratio = answer.index
            del found["loss"]
    asked = [answer.says for answer in found.values() if isinstance(answer, Question)]
    if asked:
        kind, reason = kind_of(table, options)
        hint = f" (it is not a DMA test: {reason})" if kind not in {"dma", "unclear"} else ""
        raise ReadError(f"{raw.name}: " + "; ".join(asked) + hint)
    found["temperature"] = assign(table, "temperature", options)
    return [answer for answer in found.values() if isinstance(answer, Assigned)], ratio
