"""Reader of hammer tests from one file or several."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from dashpot.base.arrays import FloatArray, median
from dashpot.base.checks import Check
from dashpot.base.errors import DataError, ReadError
from dashpot.datamodel.vibration_tests import ImpactTest, same_rate
from dashpot.reading.columns.role_assignment import (
    RoleAssignment,
    acceleration_question,
    accelerations,
    format_column,
)
from dashpot.reading.columns.vocabulary import Role
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels, cleaning, size_checks
from dashpot.reading.readers.channels import Channel, OpenedFile
from dashpot.reading.readers.header_metadata import window_rate
from dashpot.reading.table import LoadedColumns

HITS = "hits, a hammer force and an acceleration, are"
_RINGS_ON = 5.0
"""How much longer than its hammer what is struck is in motion, at least."""
_PULSES = 0.02
"""Part of a record that a hammer's pulses hardly fill."""
_PEAKS: dict[Role, tuple[Callable[[float, str], Check], ...]] = {
    "hammer": (size_checks.impact_force_measurable, size_checks.hammer_not_heavy),
    "acceleration": (size_checks.acceleration_not_large,),
}


def read_impact(
    paths: str | Path | Sequence[str | Path], *, options: ReadOptions | None = None
) -> ImpactTest:
    """Return the hammer test in one file or several, in SI units; ``-`` is stdin.

    Segments of a file, jumps of its clock, and further files each start a new continuous
    record (`starts`).

    Raises
    ------
    ReadError
        If a file cannot be read or leaves open which column is what or in which unit, or if the
        files do not hold the same channels.
    """
    return hits_in(paths, options or ReadOptions(), HITS)


def hits_in(
    paths: str | Path | Sequence[str | Path], options: ReadOptions, want: str
) -> ImpactTest:
    """Return the hammer test in files, refusing any other with what the command wants."""
    tests = read_impacts(paths, options=options, want=want)
    return tests[0] if len(tests) == 1 else _join_tests(tests)


def read_impacts(
    paths: str | Path | Sequence[str | Path],
    *,
    options: ReadOptions | None = None,
    want: str = HITS,
) -> list[ImpactTest]:
    """Return the hammer test in each of several files of one set-up, as `read_impact` reads them.

    What is a hit is then judged by the hardest of its own file.
    """
    options = options or ReadOptions()
    listed = [paths] if isinstance(paths, str | Path) else list(paths)
    if not listed:
        raise ReadError("no impact file given")
    if options.cycle is not None:
        raise ReadError(
            f"{listed[0]}: cycle {options.cycle} is asked for, but a hammer file holds hits, no "
            "loadings; leave the cycle out"
        )
    tests = [_read_test(path, options, want) for path in listed]
    _refuse_copies(tests, listed)
    names = tests[0].channels
    for test, path in zip(tests, listed, strict=True):
        if test.channels != names:
            raise ReadError(
                f"{path}: accelerations are {', '.join(test.channels)}, but {listed[0]} has "
                f"{', '.join(names)}; give files of one set-up"
            )
        if not same_rate(tests[0].rate, test.rate, min(len(test.time), len(tests[0].time))):
            raise ReadError(
                f"{path} is sampled at {test.rate:.6g} Hz, but {listed[0]} at "
                f"{tests[0].rate:.6g} Hz; give files of one rate together"
            )
    return tests


def _refuse_copies(tests: Sequence[ImpactTest], listed: Sequence[str | Path]) -> None:
    """One file given twice is not twice as many hits."""
    hashes = [tuple(source.sha256 for source in test.source) for test in tests]
    for i, one in enumerate(hashes):
        if one in hashes[:i]:
            raise ReadError(
                f"{listed[i]} holds the same bytes as {listed[hashes.index(one)]}: its hits would "
                "count twice; give each file once"
            )


def _join_tests(tests: Sequence[ImpactTest]) -> ImpactTest:
    """Tests of one set-up, one after the other."""
    return ImpactTest(
        time=np.concatenate([test.time for test in tests]),
        force=np.concatenate([test.force for test in tests]),
        acceleration=np.concatenate([test.acceleration for test in tests], axis=1),
        starts=joined_starts([(len(test.time), test.starts) for test in tests]),
        channels=tests[0].channels,
        source=tuple(source for test in tests for source in test.source),
        window_rate=_joined_rate(tests),
        units="SI",
    )


def _joined_rate(tests: Sequence[ImpactTest]) -> float | None:
    """Return the window of tests of one set-up.

    Raises
    ------
    ReadError
        If their files state different ones.
    """
    rates = [test.window_rate for test in tests if test.window_rate is not None]
    values = [rate for rate in rates if not math.isnan(rate)]
    if values and max(values) > 1.01 * min(values):
        raise ReadError(
            f"the files state exponential windows of different decay, {min(values):.4g} and "
            f"{max(values):.4g} 1/s; average them apart"
        )
    return values[0] if values else rates[0] if rates else None


def _longest_record(time: FloatArray, starts: Sequence[int]) -> float:
    """Length of the longest continuous record, s."""
    ends = [*starts[1:], len(time)]
    return max(float(time[end - 1] - time[start]) for start, end in zip(starts, ends, strict=True))


def joined_starts(tests: Sequence[tuple[int, tuple[int, ...]]]) -> tuple[int, ...]:
    """Return the first samples of the records of joined tests, of the length and starts of each."""
    begins = np.cumsum([0, *(length for length, _ in tests[:-1])]).tolist()
    pairs = zip(begins, tests, strict=True)
    return tuple(begin + start for begin, (_, starts) in pairs for start in starts)


def _read_test(path: str | Path, options: ReadOptions, want: str) -> ImpactTest:
    with channels.open_file(path, options) as file:
        channels.refuse_summary(file)
        channels.expect(file, ["impact"], want, stated_columns=["acceleration", "hammer"])
        chosen, rate = _channels(file), file.options.rate
        loaded, columns = loaded_whole(file, chosen)
        notes = [*file.table.notes, *channels.rivals(file, chosen[:-1]), *loaded.notes]
        if rate is None:
            time, *signals = columns
            starts, remarks = starts_of(time, loaded)
        else:
            time, signals = np.arange(len(loaded.values)) / rate, columns
            starts = loaded.starts
            remarks = [f"time counted from the rows at {rate:g} Hz, as given"]
        notes += remarks
        decay, windowed, sentences = window_rate(
            file.table.header, file.options, _longest_record(time, starts)
        )
        notes += sentences
        source = channels.source(file, [c.message for c in chosen], notes)
        try:
            test = ImpactTest(
                time, signals[0], np.array(signals[1:]), starts, _names(file, chosen),
                source=(source,), window_rate=math.nan if windowed and decay is None else decay,
                units="SI",
            )  # fmt: skip
        except DataError as error:
            advice = "; if the rows are evenly sampled, give the rate, for example --rate 2048Hz"
            more = advice if "even sampling" in str(error) and rate is None else ""
            raise ReadError(f"{error}{more}") from None
        refuse_same(file, chosen, signals)
        _refuse_swapped(file, chosen, signals)
        _refuse_sizes(file, chosen, time, signals)
        return test


def _names(file: OpenedFile, chosen: Sequence[Channel]) -> tuple[str, ...]:
    """Return what the accelerations are called."""
    names = [file.table.columns[c.index].name for c in chosen if c.role == "acceleration"]
    return tuple(name or f"acceleration {k}" for k, name in enumerate(names, start=1))


def _channels(file: OpenedFile) -> list[Channel]:
    """Return time unless a rate is given, the hammer, and every acceleration."""
    shown = accelerations(file.table, (), file.options)
    questions = [] if shown else [acceleration_question(file.table)]
    chosen = channels.chosen(file, channels.add_time_role(file, "hammer"), besides=questions)
    indices = accelerations(file.table, [c.index for c in chosen], file.options)
    if not indices:
        raise ReadError(acceleration_question(file.table).message)
    message = "named by --column acceleration" if file.options.acceleration else ""
    responses = [RoleAssignment("acceleration", i, message) for i in indices]
    return channels.with_units(file, [*chosen, *responses])


def _refuse_sizes(
    file: OpenedFile,
    chosen: Sequence[Channel],
    time: FloatArray,
    signals: Sequence[FloatArray],
) -> None:
    """Ask for the units again that make a size no hammer test has."""
    of_signals = chosen[-len(signals) :]
    requested: list[tuple[Channel, list[Check]]] = []
    for channel in chosen[: -len(signals)]:
        step = median(np.diff(time))
        rates = (size_checks.hammer_sampled, size_checks.hammer_not_oversampled) if step > 0 else ()
        requested.append((channel, [ask(1 / step, channel.unit.word) for ask in rates]))
    for item, signal in zip(of_signals, signals, strict=True):
        peak = float(np.abs(signal - median(signal)).max())
        requested.append((item, [ask(peak, item.unit.word) for ask in _PEAKS[item.role] if peak]))
    channels.refuse_sizes(file, requested)


def refuse_same(file: OpenedFile, chosen: Sequence[Channel], signals: Sequence[FloatArray]) -> None:
    """Refuse one channel exported twice: two do not measure the same to the last digit."""
    named = [
        format_column(file.table.columns, channel.index) for channel in chosen[-len(signals) :]
    ]
    for j, signal in enumerate(signals):
        for i in range(j):
            if np.ptp(signal) > 0 and np.array_equal(signals[i], signal):
                raise ReadError(
                    f"{named[i]} and {named[j]} hold the same numbers: one channel stands there "
                    "twice; name the columns with --column hammer=NAME and --column "
                    "acceleration=NAME"
                )


def _refuse_swapped(
    file: OpenedFile, chosen: Sequence[Channel], signals: Sequence[FloatArray]
) -> None:
    """Propose the swap where the 'hammer' rings and an 'acceleration' is short pulses."""
    if file.options.hammer or file.options.force:
        return
    of_hammer, *others = zip(
        chosen[-len(signals) :], map(cleaning.compute_active_fraction, signals), strict=True
    )
    pulses = [other for other in others if other[1] * _RINGS_ON < of_hammer[1] and other[1] > 0]
    if of_hammer[1] < _PULSES or len(pulses) != 1:
        return
    hammer = pulses[0][0].index
    swapped = {hammer: of_hammer[0].index}
    raise ReadError(
        "hammer and acceleration look swapped: the column read as hammer rings on while the one "
        f"read as acceleration ({format_column(file.table.columns, hammer)}) is short pulses; if "
        "so, add "
        + channels.format_role_options(
            file,
            [
                ("hammer", hammer),
                *(
                    ("acceleration", swapped.get(channel.index, channel.index))
                    for channel, _ in others
                ),
            ],
        )
    )


def loaded_whole(
    file: OpenedFile, chosen: Sequence[Channel]
) -> tuple[LoadedColumns, list[FloatArray]]:
    """Return the rows of some channels, and each in SI units; refuse one where a sample lacks."""
    channels.refuse_other_rate(file)
    loaded = channels.load_test(file, chosen)
    if file.options.rate is None:
        loaded = cleaning.without_padding(loaded)
    holes = np.flatnonzero(~np.isfinite(loaded.values).all(axis=1))
    if holes.size:
        raise ReadError(
            f"{loaded.format_row_position(int(holes[0]))} lacks a number ({holes.size} such "
            f"row{'s' * (holes.size > 1)}); an impact record needs every sample: cut the record "
            "there or export it again"
        )
    return loaded, [channels.si(loaded.values[:, j], c.unit) for j, c in enumerate(chosen)]


def starts_of(time: FloatArray, loaded: LoadedColumns) -> tuple[tuple[int, ...], list[str]]:
    """First samples of the records: the segments, and wherever an even clock jumps."""
    steps = np.diff(time)
    step = float(np.median(steps)) if steps.size else 0.0
    if step <= 0:
        return loaded.starts, []
    jumps = [int(i) + 1 for i in np.flatnonzero(np.abs(steps - step) > 0.5 * step)]
    new = [jump for jump in jumps if jump not in loaded.starts]
    if len(new) > 0.1 * len(time):  # an uneven clock, which the record itself refuses
        return loaded.starts, []

    notes = [
        f"the clock jumps at {loaded.format_row_position(b)}: a new record starts there"
        for b in new[:3]
    ]
    return tuple(sorted({*loaded.starts, *new})), notes
