"""From a file to a relaxation modulus over time."""

from __future__ import annotations

from pathlib import Path

from dashpot.base.errors import DataError, ReadError
from dashpot.io.columns.roles import Assigned, assign
from dashpot.io.columns.vocabulary import Role
from dashpot.io.options import ReadOptions
from dashpot.io.readers import channels
from dashpot.io.source import about, open_raw
from dashpot.io.table import Question
from dashpot.records.modulus import RelaxationModulus
from dashpot.records.specimen import Specimen

_ROLES: tuple[Role, ...] = ("time", "modulus")


def read_modulus(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> RelaxationModulus:
    """Return the relaxation modulus E(t) in a file, in SI units.

    Rows that lack a number are left out with a note.

    Raises
    ------
    ReadError
        If time or modulus is not found or has no unit, or time does not increase.
    """
    options = options or ReadOptions()
    raw = open_raw(path)
    table = channels.sure_table(raw, options)
    with about(raw):
        found = [assign(table, role, options) for role in _ROLES]
    asked = [answer.says for answer in found if isinstance(answer, Question)]
    if asked:
        raise ReadError(f"{raw.name}: " + "; ".join(asked))
    wanted = [answer for answer in found if isinstance(answer, Assigned)]
    chosen = channels.with_units(raw, table, wanted, options)
    loaded = channels.load(table, [c.index for c in chosen], options, raw.name)
    rows, notes = channels.whole_rows(loaded)
    time, modulus = (channels.si(rows[:, j].copy(), c.unit) for j, c in enumerate(chosen))
    try:
        return RelaxationModulus(
            time,
            modulus,
            "N/m" if chosen[1].unit.dimension == "stiffness" else "Pa",
            specimen or Specimen(),
            channels.source(raw, table, chosen, (*table.notes, *notes)),
        )
    except DataError as error:
        raise ReadError(f"{raw.name}: {error}") from None
