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
"""Smallest ratio of the duration of a response to that of its hammer."""
_MAX_PULSE_SHARE = 0.02
"""Largest fraction of a record that hammer pulses fill."""
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
        If a file cannot be read or does not determine its columns and units, or if the
        files do not hold the same channels.
    """
    return read_joined_impacts(paths, options or ReadOptions(), HITS)


def read_joined_impacts(
    paths: str | Path | Sequence[str | Path], options: ReadOptions, wanted_kind: str
) -> ImpactTest:
    """Return the hammer test in files; refuse other files, naming the expected kind."""
    tests = read_impacts(paths, options=options, wanted_kind=wanted_kind)
    return tests[0] if len(tests) == 1 else _join_tests(tests)


def read_impacts(
    paths: str | Path | Sequence[str | Path],
    *,
    options: ReadOptions | None = None,
    wanted_kind: str = HITS,
) -> list[ImpactTest]:
    """Return the hammer test in each of several files of one set-up, as `read_impact` reads them.

    Hits are then detected relative to the hardest hit of each file.
    """
    options = options or ReadOptions()
    path_list = [paths] if isinstance(paths, str | Path) else list(paths)
    if not path_list:
        raise ReadError("no impact file given")
    if options.cycle is not None:
        raise ReadError(
            f"{path_list[0]}: cycle {options.cycle} is asked for, but a hammer file holds hits, no "
            "loadings; leave the cycle out"
        )
    tests = [_read_test(path, options, wanted_kind) for path in path_list]
    _refuse_copies(tests, path_list)
    names = tests[0].channels
    for test, path in zip(tests, path_list, strict=True):
        if test.channels != names:
            raise ReadError(
                f"{path}: accelerations are {', '.join(test.channels)}, but {path_list[0]} has "
                f"{', '.join(names)}; give files of one set-up"
            )
        if not same_rate(tests[0].rate, test.rate, min(len(test.time), len(tests[0].time))):
            raise ReadError(
                f"{path} is sampled at {test.rate:.6g} Hz, but {path_list[0]} at "
                f"{tests[0].rate:.6g} Hz; give files of one rate together"
            )
    return tests


def _refuse_copies(tests: Sequence[ImpactTest], path_list: Sequence[str | Path]) -> None:
    """Refuse a file given twice."""
    hashes = [tuple(source.sha256 for source in test.source) for test in tests]
    for i, file_hash in enumerate(hashes):
        if file_hash in hashes[:i]:
            raise ReadError(
                f"{path_list[i]} holds the same bytes as {path_list[hashes.index(file_hash)]}: its "
                "hits would count twice; give each file once"
            )


def _join_tests(tests: Sequence[ImpactTest]) -> ImpactTest:
    """Tests of one set-up, one after the other."""
    return ImpactTest(
        time=np.concatenate([test.time for test in tests]),
        force=np.concatenate([test.force for test in tests]),
        acceleration=np.concatenate([test.acceleration for test in tests], axis=1),
        starts=join_record_starts([(len(test.time), test.starts) for test in tests]),
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
    stops = [*starts[1:], len(time)]
    return max(float(time[end - 1] - time[start]) for start, end in zip(starts, stops, strict=True))


def join_record_starts(tests: Sequence[tuple[int, tuple[int, ...]]]) -> tuple[int, ...]:
    """Return the first samples of the records of joined tests, of the length and starts of each."""
    record_starts = np.cumsum([0, *(length for length, _ in tests[:-1])]).tolist()
    pairs = zip(record_starts, tests, strict=True)
    return tuple(record_start + start for record_start, (_, starts) in pairs for start in starts)


def _read_test(path: str | Path, options: ReadOptions, wanted_kind: str) -> ImpactTest:
    with channels.open_file(path, options) as file:
        channels.refuse_summary(file)
        channels.refuse_other_kinds(
            file, ["impact"], wanted_kind, stated_columns=["acceleration", "hammer"]
        )
        channels_chosen, rate = _channels(file), file.options.rate
        loaded_columns, columns = load_complete_columns(file, channels_chosen)
        notes = [
            *file.table.notes,
            *channels.describe_alternatives(file, channels_chosen[:-1]),
            *loaded_columns.notes,
        ]
        if rate is None:
            time, *signals = columns
            starts, remarks = find_record_starts(time, loaded_columns)
        else:
            time, signals = np.arange(len(loaded_columns.values)) / rate, columns
            starts = loaded_columns.starts
            remarks = [f"time counted from the rows at {rate:g} Hz, as given"]
        notes += remarks
        decay, windowed, sentences = window_rate(
            file.table.header, file.options, _longest_record(time, starts)
        )
        notes += sentences
        source = channels.make_source(file, [c.message for c in channels_chosen], notes)
        try:
            test = ImpactTest(
                time, signals[0], np.array(signals[1:]), starts, _names(file, channels_chosen),
                source=(source,), window_rate=math.nan if windowed and decay is None else decay,
                units="SI",
            )  # fmt: skip
        except DataError as error:
            advice = "; if the rows are evenly sampled, give the rate, for example --rate 2048Hz"
            hint = advice if "even sampling" in str(error) and rate is None else ""
            raise ReadError(f"{error}{hint}") from None
        refuse_same(file, channels_chosen, signals)
        _refuse_swapped(file, channels_chosen, signals)
        _refuse_sizes(file, channels_chosen, time, signals)
        return test


def _names(file: OpenedFile, channels_chosen: Sequence[Channel]) -> tuple[str, ...]:
    """Return the names of the accelerations."""
    names = [file.table.columns[c.index].name for c in channels_chosen if c.role == "acceleration"]
    return tuple(name or f"acceleration {k}" for k, name in enumerate(names, start=1))


def _channels(file: OpenedFile) -> list[Channel]:
    """Return time unless a rate is given, the hammer, and every acceleration."""
    acceleration_columns = accelerations(file.table, (), file.options)
    questions = [] if acceleration_columns else [acceleration_question(file.table)]
    channels_chosen = channels.select_columns(
        file, channels.add_time_role(file, "hammer"), other_questions=questions
    )
    indices = accelerations(file.table, [c.index for c in channels_chosen], file.options)
    if not indices:
        raise ReadError(acceleration_question(file.table).message)
    message = "named by --column acceleration" if file.options.acceleration else ""
    responses = [RoleAssignment("acceleration", i, message) for i in indices]
    return channels.add_units(file, [*channels_chosen, *responses])


def _refuse_sizes(
    file: OpenedFile,
    channels_chosen: Sequence[Channel],
    time: FloatArray,
    signals: Sequence[FloatArray],
) -> None:
    """Ask for the units of signals with magnitudes impossible for a hammer test."""
    of_signals = channels_chosen[-len(signals) :]
    requested: list[tuple[Channel, list[Check]]] = []
    for channel in channels_chosen[: -len(signals)]:
        step = median(np.diff(time))
        rates = (size_checks.hammer_sampled, size_checks.hammer_not_oversampled) if step > 0 else ()
        requested.append((channel, [ask(1 / step, channel.unit.word) for ask in rates]))
    for item, signal in zip(of_signals, signals, strict=True):
        peak = float(np.abs(signal - median(signal)).max())
        requested.append((item, [ask(peak, item.unit.word) for ask in _PEAKS[item.role] if peak]))
    channels.refuse_sizes(file, requested)


def refuse_same(
    file: OpenedFile, channels_chosen: Sequence[Channel], signals: Sequence[FloatArray]
) -> None:
    """Refuse one channel exported twice: two do not measure the same to the last digit."""
    column_names = [
        format_column(file.table.columns, channel.index)
        for channel in channels_chosen[-len(signals) :]
    ]
    for j, signal in enumerate(signals):
        for i in range(j):
            if np.ptp(signal) > 0 and np.array_equal(signals[i], signal):
                raise ReadError(
                    f"{column_names[i]} and {column_names[j]} hold the same numbers: one channel "
                    "stands there twice; name the columns with --column hammer=NAME and --column "
                    "acceleration=NAME"
                )


def _refuse_swapped(
    file: OpenedFile, channels_chosen: Sequence[Channel], signals: Sequence[FloatArray]
) -> None:
    """Propose the swap where the 'hammer' rings and an 'acceleration' is short pulses."""
    if file.options.hammer or file.options.force:
        return
    of_hammer, *other_fractions = zip(
        channels_chosen[-len(signals) :],
        map(cleaning.compute_active_fraction, signals),
        strict=True,
    )
    pulses = [
        other for other in other_fractions if other[1] * _RINGS_ON < of_hammer[1] and other[1] > 0
    ]
    if of_hammer[1] < _MAX_PULSE_SHARE or len(pulses) != 1:
        return
    hammer = pulses[0][0].index
    swapped_columns = {hammer: of_hammer[0].index}
    raise ReadError(
        "hammer and acceleration look swapped: the column read as hammer rings on while the one "
        f"read as acceleration ({format_column(file.table.columns, hammer)}) is short pulses; if "
        "so, add "
        + channels.format_role_options(
            file,
            [
                ("hammer", hammer),
                *(
                    ("acceleration", swapped_columns.get(channel.index, channel.index))
                    for channel, _ in other_fractions
                ),
            ],
        )
    )


def load_complete_columns(
    file: OpenedFile, channels_chosen: Sequence[Channel]
) -> tuple[LoadedColumns, list[FloatArray]]:
    """Return the rows of some channels, and each in SI units; refuse missing samples."""
    channels.refuse_other_rate(file)
    loaded_columns = channels.load_test(file, channels_chosen)
    if file.options.rate is None:
        loaded_columns = cleaning.remove_padding(loaded_columns)
    holes = np.flatnonzero(~np.isfinite(loaded_columns.values).all(axis=1))
    if holes.size:
        raise ReadError(
            f"{loaded_columns.format_row_position(int(holes[0]))} lacks a number ({holes.size} "
            f"such row{'s' * (holes.size > 1)}); an impact record needs every sample: cut the "
            "record there or export it again"
        )
    return loaded_columns, [
        channels.scale_to_si(loaded_columns.values[:, j], c.unit)
        for j, c in enumerate(channels_chosen)
    ]


def find_record_starts(
    time: FloatArray, loaded_columns: LoadedColumns
) -> tuple[tuple[int, ...], list[str]]:
    """First samples of the records: the segments, and wherever an even clock jumps."""
    steps = np.diff(time)
    step = float(np.median(steps)) if steps.size else 0.0
    if step <= 0:
        return loaded_columns.starts, []
    jump_indices = [int(i) + 1 for i in np.flatnonzero(np.abs(steps - step) > 0.5 * step)]
    new = [jump for jump in jump_indices if jump not in loaded_columns.starts]
    if len(new) > 0.1 * len(time):  # an uneven clock, which the record itself refuses
        return loaded_columns.starts, []

    notes = [
        f"the clock jumps at {loaded_columns.format_row_position(b)}: a new record starts there"
        for b in new[:3]
    ]
    return tuple(sorted({*loaded_columns.starts, *new})), notes
