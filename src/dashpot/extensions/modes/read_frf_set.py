"""Reader of the FRFs of several points."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path

from dashpot.base.errors import DataError, ReadError
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.structure import FRFSet
from dashpot.reading.columns.file_kinds import FileKind
from dashpot.reading.columns.kind_detection import find_amplitude_phase_pairs
from dashpot.reading.columns.role_assignment import score
from dashpot.reading.columns.vocabulary import Role
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import OpenedFile
from dashpot.reading.readers.frf import PAIRS, build_frf, determine_frf_columns, read_frf
from dashpot.reading.table import SEGMENT, Column

_NAMED = 1.5
"""Smallest score of a column whose name gives its role."""


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
        Reading options of the files; with a segment, or a column of a role, it is one FRF of
        each.

    Raises
    ------
    ReadError
        If a file has no FRF, the kind or unit of an FRF is unknown, or an FRF is given twice.
    DataError
        If they are not on the same lines.
    """
    paths = [path] if isinstance(path, str | Path) else list(path)
    _refuse_twice(paths)
    names: list[str] = []
    frfs: list[FRF] = []
    for name in paths:
        stem = Path(name).stem
        for point, frf in _read_points(name, options):
            frfs.append(frf)
            names.append(point if len(paths) == 1 else f"{stem} {point}".strip())
    if len(set(names)) < len(names) or not all(names):
        names = [str(i + 1) for i in range(len(frfs))]
    try:
        return FRFSet(tuple(frfs), tuple(names))
    except DataError as error:
        raise DataError(f"{', '.join(Path(path).name for path in paths[:4])}: {error}") from None


def _refuse_twice(paths: Sequence[str | Path]) -> None:
    resolved_paths = [Path(path).resolve() for path in paths]
    repeated_names = [
        resolved_path.name
        for i, resolved_path in enumerate(resolved_paths)
        if resolved_path in resolved_paths[:i]
    ]
    if repeated_names:
        raise ReadError(f"{repeated_names[0]} is given twice; expected each point once")


def _read_points(path: str | Path, options: ReadOptions | None) -> Iterator[tuple[str, FRF]]:
    """Each FRF of a file with the name of its point, which is empty of a single one."""
    with channels.open_file(path, options, refuse_questions=False) as file:
        groups = _group_columns(file)
        if len(groups) > 1:
            other = [question for question in file.table.questions if question.option != SEGMENT]
            if other:
                raise ReadError(other[0].message)
            # an option that names columns or a part has left one group
            kinds: list[FileKind] = ["frf", "transmissibility"]
            channels.refuse_other_kinds(
                file, kinds, "an FRF is", stated_columns=["real", "magnitude"]
            )
            for name, columns in groups:
                yield name, _build_subset_frf(file, columns)
            return
    yield "", read_frf(path, options=options)


def _group_columns(file: OpenedFile) -> list[tuple[str, dict[int, str]]]:
    """The columns of each FRF by index, named as those of a single one; and its point's name."""
    options, columns = file.options, file.table.columns
    if options.segment or any(getattr(options, role) for role in chain(*PAIRS)):
        return []
    if find_amplitude_phase_pairs(file.table, options):
        return []  # a motion and what moves it are of one
    role_columns = _find_role_columns(columns, options)
    for pair in PAIRS:
        if len(role_columns["frequency"]) == 1 and 2 <= len(role_columns[pair[0]]) == len(
            role_columns[pair[1]]
        ):
            return _group_repeated_pairs(columns, role_columns, pair)
    return []


def _group_repeated_pairs(
    columns: Sequence[Column], indices_by_name: Mapping[str, list[int]], pair: tuple[Role, Role]
) -> list[tuple[str, dict[int, str]]]:
    """Return the groups of a repeated pair of parts."""
    first = indices_by_name[pair[0]]
    # what does not stand there once for each is of none
    roles = [
        role for role in (*pair, "coherence", "sd") if len(indices_by_name[role]) == len(first)
    ]
    names = [_get_point_name(columns[i], pair[0]) or str(n) for n, i in enumerate(first, start=1)]
    pairs = zip(*(indices_by_name[role] for role in roles), strict=True)
    roles_by_column = [dict(zip(indexes, roles, strict=True)) for indexes in pairs]
    ticks = {indices_by_name["frequency"][0]: "frequency"}
    return [(name, ticks | group) for name, group in zip(names, roles_by_column, strict=True)]


def _find_role_columns(columns: Sequence[Column], options: ReadOptions) -> dict[str, list[int]]:
    """Return the columns that name each role, and those of standard deviations."""
    entries: dict[str, list[int]] = {
        role: [i for i, c in enumerate(columns) if score(c, role, options) >= _NAMED]
        for role in ("frequency", "coherence", *chain(*PAIRS))
    }
    sd = [i for i, c in enumerate(columns) if c.name.casefold().startswith("sd ")]
    return entries | {"sd": sd}


def _get_point_name(column: Column, role: Role) -> str:
    """Return the point of a column: the part of its name that is not its role."""
    words = column.name.split()
    point_words = [w for w in words if score(Column(w), role, ReadOptions()) < _NAMED]
    return " ".join(point_words) if len(point_words) < len(words) else ""


def select_first_point(file: OpenedFile) -> OpenedFile:
    """Return a file of several points as one of its first point, any other unchanged."""
    groups = _group_columns(file)
    return _select_columns(file, groups[0][1]) if len(groups) > 1 else file


def _build_subset_frf(file: OpenedFile, role_by_column: dict[int, str]) -> FRF:
    """Return the FRF in some of a table's columns, as if there were no others."""
    opened_file = _select_columns(file, role_by_column)
    return build_frf(opened_file, determine_frf_columns(opened_file))


def _select_columns(file: OpenedFile, role_by_column: dict[int, str]) -> OpenedFile:
    """Return a file reduced to some of its columns, named by their roles."""
    indexes = list(role_by_column)
    columns = [replace(file.table.columns[i], name=role_by_column[i]) for i in indexes]
    table = replace(
        file.table, columns=tuple(columns), questions=(),
        load=lambda requested: file.table.load([indexes[i] for i in requested]),
    )  # fmt: skip
    return replace(file, table=table)
