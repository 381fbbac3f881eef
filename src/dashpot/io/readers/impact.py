"""From one file or several to an impact test."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError, ReadError
from dashpot.io.columns.roles import Assigned, accelerations, list_columns
from dashpot.io.columns.vocabulary import Role
from dashpot.io.options import ReadOptions
from dashpot.io.readers import channels
from dashpot.io.readers.channels import Channel
from dashpot.io.source import Raw, about, open_raw
from dashpot.io.table import Loaded, Table
from dashpot.records.impact import ImpactTest


def read_impact(
    paths: str | Path | Sequence[str | Path], *, options: ReadOptions | None = None
) -> ImpactTest:
    """Return the impact test in one file or several, in SI units; ``-`` is stdin.

    Segments of a file, jumps of its clock, and further files each start a new continuous
    record (`starts`).

    Raises
    ------
    ReadError
        If a file cannot be read or leaves open which column is what or in which unit, or if the
        files do not hold the same channels.
    """
    options = options or ReadOptions()
    listed = [paths] if isinstance(paths, str | Path) else list(paths)
    if not listed:
        raise ReadError("no impact file given")
    tests = [_one(open_raw(path), options) for path in listed]
    if len(tests) == 1:
        return tests[0]
    names = tests[0].channels
    for test, path in zip(tests, listed, strict=True):
        if test.channels != names:
            raise ReadError(
                f"{path}: accelerations are {', '.join(test.channels)}, but {listed[0]} has "
                f"{', '.join(names)}; give files of one set-up"
            )
    offsets = np.cumsum([0, *(len(test.time) for test in tests[:-1])])
    return ImpactTest(
        time=np.concatenate([test.time for test in tests]),
        force=np.concatenate([test.force for test in tests]),
        acceleration=np.concatenate([test.acceleration for test in tests], axis=1),
        starts=tuple(
            int(offset + start)
            for offset, test in zip(offsets, tests, strict=True)
            for start in test.starts
        ),
        channels=names,
        source=tuple(source for test in tests for source in test.source),
    )


def _one(raw: Raw, options: ReadOptions) -> ImpactTest:
    table = channels.test_table(raw, options)
    chosen = _channels(raw, table, options)
    loaded = channels.load(table, [c.index for c in chosen], options, raw.name)
    channels.enough(loaded, raw.name)
    _whole(loaded, raw.name)
    columns = [channels.si(loaded.values[:, j], c.unit) for j, c in enumerate(chosen)]
    notes = [*table.notes, *channels.rivals(table, chosen[:-1], options), *loaded.notes]
    starts = loaded.starts
    if options.rate is None:
        time, *signals = columns
        starts, said = _starts(time, loaded)
        notes += said
    else:
        time, signals = np.arange(len(loaded.values)) / options.rate, columns
        notes.append(f"time counted from the rows at {options.rate:g} Hz, as given")
    found = [c for c in chosen if c.role == "acceleration"]
    names = tuple(
        table.columns[c.index].name or f"acceleration {k + 1}" for k, c in enumerate(found)
    )
    try:
        return ImpactTest(
            time, signals[0], np.array(signals[1:]), starts, names,
            source=(channels.source(raw, table, chosen, notes),),
        )  # fmt: skip
    except DataError as error:
        advice = "; if the rows are evenly sampled, give the rate, for example --rate 2048Hz"
        more = advice if "even sampling" in str(error) and options.rate is None else ""
        raise ReadError(f"{raw.name}: {error}{more}") from None


def _channels(raw: Raw, table: Table, options: ReadOptions) -> list[Channel]:
    """Time unless a rate is given, the hammer, and every acceleration."""
    wanted: list[Role] = ["force"] if options.rate is not None else ["time", "force"]
    chosen = channels.choose(raw, table, wanted, options)
    with about(raw):
        found = accelerations(table, [c.index for c in chosen], options)
    if not found:
        raise ReadError(
            f"{raw.name}: no column is recognised as acceleration; the columns are "
            f"{list_columns(table.columns)}; name each by its name or number with --acceleration"
        )
    says = "named by --acceleration" if options.acceleration else ""
    more = [Assigned("acceleration", i, says) for i in found]
    return chosen + channels.with_units(raw, table, more, options)


def _whole(loaded: Loaded, file: str) -> None:
    holes = np.flatnonzero(~np.isfinite(loaded.values).all(axis=1))
    if holes.size:
        raise ReadError(
            f"{file}: {loaded.where(int(holes[0]))} lacks a number ({holes.size} such "
            f"row{'s' * (holes.size > 1)}); an impact record needs every sample: cut the record "
            "there or export it again"
        )


def _starts(time: FloatArray, loaded: Loaded) -> tuple[tuple[int, ...], list[str]]:
    """First samples of the records: the segments, and wherever an even clock jumps."""
    steps = np.diff(time)
    step = float(np.median(steps))
    if step <= 0:
        return loaded.starts, []
    jumps = [int(i) + 1 for i in np.flatnonzero(np.abs(steps - step) > 0.5 * step)]
    new = [jump for jump in jumps if jump not in loaded.starts]
    if len(new) > 0.1 * len(time):  # an uneven clock, which the record itself refuses
        return loaded.starts, []

    notes = [f"the clock jumps at {loaded.where(b)}: a new record starts there" for b in new[:3]]
    return tuple(sorted({*loaded.starts, *new})), notes
