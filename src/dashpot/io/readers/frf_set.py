"""From files to the FRFs of several points."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from dashpot.base.errors import DataError, ReadError
from dashpot.io.columns.roles import score
from dashpot.io.columns.vocabulary import Role
from dashpot.io.formats.uff import SEGMENT
from dashpot.io.options import ReadOptions
from dashpot.io.readers import channels
from dashpot.io.readers.channels import Opened
from dashpot.io.readers.frf import built, read_frf, settled
from dashpot.io.table import Column
from dashpot.records.frf import FRF
from dashpot.records.frf_set import FRFSet

_PAIRS: tuple[tuple[Role, Role], ...] = (("real", "imaginary"), ("magnitude", "phase"))
_NAMED = 1.5
"""Least score of a column whose name says its role."""


def read_frfs(
    path: str | Path | Sequence[str | Path], *, options: ReadOptions | None = None
) -> FRFSet:
    """Return the FRFs of several points: of files with one each, or of files with several.

    A UFF file holds a dataset 58 for each point, a text file a pair of columns: ``frequency [Hz],
    real 1 [1/kg], imaginary 1 [1/kg], real 2 [1/kg], ...``, or magnitudes and phases.

    Parameters
    ----------
    path : path or sequence of path
    options : ReadOptions, optional
        What the user said of the files; with a segment, or a column of a role, it is one FRF of
        each.

    Raises
    ------
    ReadError
        If there is no FRF in a file, its kind or unit is left open, or it is given twice.
    DataError
        If they are not on the same lines.
    """
    paths = [path] if isinstance(path, str | Path) else list(path)
    places = [Path(one).resolve() for one in paths]
    twice = [one.name for i, one in enumerate(places) if one in places[:i]]
    if twice:
        raise ReadError(f"{twice[0]} is given twice; expected each point once")
    names: list[str] = []
    frfs: list[FRF] = []
    for one in paths:
        stem = Path(one).stem
        for point, frf in _points_in(one, options or ReadOptions()):
            frfs.append(frf)
            names.append(point if len(paths) == 1 else f"{stem} {point}".strip())
    if len(set(names)) < len(names) or not all(names):
        names = [str(i + 1) for i in range(len(frfs))]
    try:
        return FRFSet(tuple(frfs), tuple(names))
    except DataError as error:
        raise DataError(f"{', '.join(Path(one).name for one in paths[:4])}: {error}") from None


def _points_in(path: str | Path, options: ReadOptions) -> Iterator[tuple[str, FRF]]:
    """Each FRF of a file with the name of its point, which is empty of a single one."""
    with channels.opened(path, options, sure=False) as file:
        groups = _groups(file)
        if len(groups) > 1:
            other = [one for one in file.table.doubts if one.option != SEGMENT]
            if other:
                raise ReadError(other[0].says)
            # an option that names columns or a part has left one group
            channels.expect(file, ["frf"], "an FRF is", named=["real", "magnitude"])
            for name, columns in groups:
                yield name, _one_of(file, columns)
            return
    yield "", read_frf(path, options=options)


def _groups(file: Opened) -> list[tuple[str, dict[int, str]]]:
    """The columns of each FRF by index, named as those of a single one; and its point's name."""
    options, columns = file.options, file.table.columns
    if options.segment or any(getattr(options, role) for pair in _PAIRS for role in pair):
        return []

    def of(role: Role) -> list[int]:
        return [i for i, c in enumerate(columns) if score(c, role, options) >= _NAMED]

    ticks = of("frequency")
    for pair in _PAIRS:
        first, second = (of(role) for role in pair)
        if len(ticks) != 1 or len(first) < 2 or len(first) != len(second):
            continue
        coherent = of("coherence")
        scatter = [i for i, c in enumerate(columns) if c.name.casefold().startswith("sd ")]
        found = []
        for i, (one, other) in enumerate(zip(first, second, strict=True)):
            chosen: dict[int, str] = {ticks[0]: "frequency", one: pair[0], other: pair[1]}
            if len(coherent) == len(first):
                chosen[coherent[i]] = "coherence"
            if len(scatter) == len(first):
                chosen[scatter[i]] = "sd"
            found.append((_point(columns[one], pair[0]) or str(i + 1), chosen))
        return found
    return []


def _point(column: Column, role: Role) -> str:
    """What a column's name says besides its role: its point."""
    words = column.name.split()
    kept = [w for w in words if score(Column(w), role, ReadOptions()) < _NAMED]
    return " ".join(kept) if len(kept) < len(words) else ""


def _one_of(file: Opened, chosen: dict[int, str]) -> FRF:
    """The FRF in some of a table's columns, as if there were no others."""
    indexes = list(chosen)
    own = [replace(file.table.columns[i], name=chosen[i]) for i in indexes]
    table = replace(
        file.table, columns=tuple(own), doubts=(),
        load=lambda asked: file.table.load([indexes[i] for i in asked]),
    )  # fmt: skip
    one = replace(file, table=table)
    return built(one, settled(one))
