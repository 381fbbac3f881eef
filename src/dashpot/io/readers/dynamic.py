"""From a file to a dynamic (DMA) test."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dashpot.base.errors import ReadError
from dashpot.io.columns.kinds import kind_of
from dashpot.io.columns.roles import Assigned, assign
from dashpot.io.columns.vocabulary import Role
from dashpot.io.options import ReadOptions
from dashpot.io.readers import channels
from dashpot.io.readers.channels import Opened
from dashpot.io.readers.stated import stated_specimen, temperatures_of_segments
from dashpot.io.table import Question
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
    with channels.opened(path, options) as file:
        return dynamic_in(file, specimen or Specimen())


def dynamic_in(file: Opened, specimen: Specimen) -> DynamicTest:
    """Return the dynamic test in an opened file."""
    channels.expect(file, ["dma", "master-curve"], "a sweep of frequency is", named=["storage"])
    wanted, ratio = sweep_columns(file)
    chosen = channels.with_units(file, wanted)
    indexes = [c.index for c in chosen] + ([] if ratio is None else [ratio])
    loaded = channels.load(file.table, indexes, file.options.segment)
    rows, gaps = channels.whole_rows(loaded)
    values = {c.role: channels.si(rows[:, j].copy(), c.unit) for j, c in enumerate(chosen)}
    kinds = {c.role: c.unit.dimension for c in chosen}
    notes = [*file.table.notes, *gaps]
    if ratio is not None:
        factor = file.table.columns[ratio]
        values["loss"] = values["storage"] * rows[:, -1] / (100 if factor.unit == "%" else 1)
        notes.append(f"loss is storage times '{factor.name}'")
    elif kinds["storage"] != kinds["loss"]:
        raise ReadError(
            f"storage is a {kinds['storage']} and loss a {kinds['loss']}; "
            "expected both in one kind of unit, such as MPa or N/mm"
        )
    if "temperature" not in values:
        warm = temperatures_of_segments(file, loaded)
        if warm is not None:
            values["temperature"] = warm[np.isfinite(loaded.values).all(axis=1)]
            notes.append(f"{len(set(warm.tolist()))} temperatures, from the lines over each block")
    if "temperature" not in values:
        specimen, said = stated_specimen(file, specimen)
        notes += said
    return DynamicTest(
        values["frequency"],
        values["storage"],
        values["loss"],
        values.get("temperature"),
        "N/m" if kinds["storage"] == "stiffness" else "Pa",
        specimen,
        channels.source(file, [c.says for c in chosen], notes),
    )


def sweep_columns(file: Opened) -> tuple[list[Assigned], int | None]:
    """The columns by role, and that of the loss factor if there is no loss."""
    table, options = file.table, file.options
    found = {role: assign(table, role, options) for role in _ROLES}
    ratio = None
    if isinstance(found["loss"], Question):
        answer = assign(table, "loss_factor", options)
        if isinstance(answer, Assigned):
            ratio = answer.index
            del found["loss"]
    hint = ""
    if any(isinstance(answer, Question) for answer in found.values()):
        kind, reason = kind_of(table, options)
        hint = "" if kind in {"dma", "unclear"} else f" (it is not a DMA test: {reason})"
    columns = channels.answered(file, list(found.values()), hint)
    both = [one.index for one in columns if one.role in {"storage", "loss"}]
    if len(both) != len(set(both)):
        name = table.columns[both[0]].name
        raise ReadError(
            f"only '{name}' could be storage or loss, and it is not both; expected a column of "
            "each, or of storage and loss factor: of a magnitude and an angle write magnitude * "
            "cos(angle) and magnitude * sin(angle) to the file, or name the columns (--storage, "
            "--loss, --loss-factor)"
        )
    temperature = assign(table, "temperature", options)
    return columns + ([temperature] if isinstance(temperature, Assigned) else []), ratio
