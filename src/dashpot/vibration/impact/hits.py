"""Hammer hits: detected, cut into blocks, freed of residual ringing, judged."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base import dataclass, field, replace
from dashpot.base.arrays import ComplexArray, FloatArray, sample_count
from dashpot.base.errors import DataError
from dashpot.base.value_ranges import require_nonnegative
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.vibration.modal.peaks import find_run

# Detection of hits, blocks, and removal of residual ringing.


TRIGGER_SHARE = 0.1  # of the largest force of the test: smaller pulses are not hits
MIN_HIT_DISTANCE = 0.5  # s: pulses closer than this are one hit, perhaps a double one
PRETRIGGER_SHARE = 0.1  # s, where that much is recorded
GUARD_SAMPLES = 2  # samples before the onset that may already feel the pulse
HISTORY_LENGTH = 1.0  # s before a hit that are kept to show how the block still moves
MIN_EXPLAINED_SHARE = 0.5  # of the motion before a hit must be free decay to be taken off
RATE_TOLERANCE = 1e-3  # between tests, relative; time stamps are often printed with few digits


@dataclass(frozen=True, eq=False)
class HitBlock:
    """Block of a hit: a hammer pulse, its response, and a short rest before.

    Attributes
    ----------
    name : str
        ``"1"``, ``"2"``... through all tests.
    time : float
        When the pulse begins, s on the clock of its record.
    rate : float
        Hz.
    onset : int
        First sample of the pulse in the block: as many samples lie before it.
    force : array, shape (n,)
        N, pushing is positive, its mean before the onset taken off.
    acceleration : array, shape (channels, n)
        m/s^2, the mean before the onset taken off.
    noise : array, shape (1 + channels,)
        Standard deviation of force and accelerations before the onset, slow motion excluded.
    ringing : array, shape (channels,)
        Their standard deviation before the onset, slow motion included.
    offset : array, shape (1 + channels,)
        The means taken off.
    missing : int
        Samples that the recording lacks at the end of the block (filled with zeros).
    turned : bool
        True if the hammer was recorded negative.
    past : array, shape (channels, m)
        Accelerations in the last second before the onset, as far as recorded after an earlier hit.
    calmed : bool
        True if what still rang from an earlier hit has been taken off.
    since_start : float
        When the pulse begins, s from the start of its continuous record; nan where other hits
        are in it, too.
    """

    name: str
    time: float
    rate: float
    onset: int
    force: FloatArray
    acceleration: FloatArray
    noise: FloatArray
    ringing: FloatArray
    offset: FloatArray
    missing: int = 0
    turned: bool = False
    past: FloatArray = field(default_factory=lambda: np.empty((0, 0)))
    calmed: bool = False
    since_start: float = float("nan")

    @property
    def length(self) -> float:
        """Length of the block, s."""
        return len(self.force) / self.rate

    @property
    def peak(self) -> float:
        """Largest force, N."""
        return float(self.force[self.peak_at])

    @property
    def peak_at(self) -> int:
        """Sample of the largest force."""
        return int(np.argmax(self.force))

    def pulse(self, level: float = 0.1) -> slice:
        """Return the samples around the peak that stay above `level` times the peak."""
        return find_run(self.force > level * self.peak, self.peak_at)

    def width(self, level: float) -> float:
        """Pulse width at `level` times the peak, s, its ends found by straight lines."""
        pulse_samples = self.pulse(level)
        pulse_ends = pulse_samples.start, pulse_samples.stop - 1
        return compute_width(self.force, level * self.peak, pulse_ends) / self.rate

    def moments(self) -> tuple[float, float]:
        """Return the mean time of the pulse from the start of the block, and its rms width, s."""
        pulse_samples = self.pulse(0.05)
        weights = self.force[pulse_samples] / self.force[pulse_samples].sum()
        time = np.arange(pulse_samples.start, pulse_samples.stop) / self.rate
        mean_time = float(time @ weights)
        return mean_time, float(np.sqrt((time - mean_time) ** 2 @ weights))


def compute_width(values: FloatArray, level: float, pulse_ends: tuple[int, int]) -> float:
    """Samples between the crossings of a level just outside two samples, by straight lines."""
    first, last = pulse_ends
    width = float(last - first)
    if first > 0:
        width += (values[first] - level) / (values[first] - values[first - 1])
    if last < len(values) - 1:
        width += (values[last] - level) / (values[last] - values[last + 1])
    return float(width)


@dataclass(frozen=True)
class _PulseOnset:
    """Start of a pulse in its continuous record, and those of its neighbours."""

    test: ImpactTest
    sign: float
    record: slice
    onset: int
    previous: int | None
    next: int | None


def cut_hits(
    tests: Sequence[ImpactTest], *, record: float | None = None, pretrigger: float | None = None
) -> tuple[HitBlock, ...]:
    """Cut every hit of the tests into a block of one common length.

    Parameters
    ----------
    tests : sequence of ImpactTest
        Tests: of one sampling rate and one set of accelerometers.
    record : float, optional
        Length of a block, s, what lies before the hit included; the FRF's lines are 1/record
        apart. By default as long as every hit allows that is not followed hastily by another.
    pretrigger : float, optional
        How much of the block lies before the hit, s. By default 0.1 s where recorded.

    Raises
    ------
    DataError
        If there is no hit, a channel never moves, the tests do not belong together, or the times
        cannot be.
    """
    _belong_together(tests)
    for name, row in (
        (n, r) for test in tests for n, r in zip(test.channels, test.acceleration, strict=True)
    ):
        if np.ptp(row) == 0:
            raise DataError(
                f"{name} is {row[0]:.6g} m/s^2 throughout: no accelerometer was read; leave that "
                "column out, or look at its cable and range and hit again"
            )
    rate = tests[0].rate
    onsets = [hit for test in tests for hit in _find_onsets(test)]
    pretrigger_samples = _choose_pretrigger(onsets, rate, pretrigger)
    length = _choose_length(onsets, rate, pretrigger_samples, record)
    return tuple(
        _cut_hit(hit, str(i), pretrigger_samples, length) for i, hit in enumerate(onsets, start=1)
    )


def _belong_together(tests: Sequence[ImpactTest]) -> None:
    if not tests:
        raise DataError("no hammer test given; expected at least one")
    first = tests[0]
    for test in tests[1:]:
        if abs(test.rate - first.rate) > RATE_TOLERANCE * first.rate:
            raise DataError(
                f"tests sampled at {first.rate:.6g} and {test.rate:.6g} Hz cannot be averaged; "
                "analyse them apart"
            )
        if test.channels != first.channels:
            raise DataError(
                f"tests with accelerometers {first.channels} and {test.channels} cannot be "
                "averaged; name the columns alike"
            )


def _find_onsets(test: ImpactTest) -> list[_PulseOnset]:
    """Find where the pulses begin in each continuous record of a test."""
    records = test.records()
    centred_forces = [test.force[r] - np.median(test.force[r]) for r in records]
    loudest = max(centred_forces, key=lambda f: float(np.abs(f).max()))
    sign = 1.0 if loudest.max() >= -loudest.min() else -1.0
    peak = float((sign * loudest).max())
    pulse_onsets: list[_PulseOnset] = []
    for record, force in zip(records, centred_forces, strict=True):
        noise = 1.4826 * float(np.median(np.abs(force)))
        triggered_indices = np.flatnonzero(sign * force > max(TRIGGER_SHARE * peak, 8 * noise))
        if peak <= 0 or not triggered_indices.size:
            continue
        firsts = triggered_indices[
            np.concatenate(([True], np.diff(triggered_indices) > MIN_HIT_DISTANCE * test.rate))
        ]
        onsets = [_find_onset(sign * force, int(i), noise) for i in firsts]
        neighbours = zip([None, *onsets], onsets, [*onsets[1:], None], strict=False)
        pulse_onsets += [
            _PulseOnset(test, sign, record, onset, last, next_onset)
            for last, onset, next_onset in neighbours
        ]
    if not pulse_onsets:
        raise DataError(
            f"no hammer hit found: the force stays within {float(np.ptp(loudest)):.3g} N, without "
            "a pulse that stands out of its noise; check that the hammer column is the right one"
        )
    return pulse_onsets


def _find_onset(force: FloatArray, crossing: int, noise: float) -> int:
    """Walk back from the trigger to where the pulse leaves its base line."""
    highest_force = float(force[crossing : crossing + 5].max())
    base = max(0.01 * highest_force, 3 * noise)
    indices_below = np.flatnonzero(force[:crossing] <= base)
    return int(indices_below[-1]) + 1 if indices_below.size else 0


def _choose_pretrigger(onsets: Sequence[_PulseOnset], rate: float, pretrigger: float | None) -> int:
    if pretrigger is not None:
        require_nonnegative(pretrigger=pretrigger, unit=" s", expected="a time >= 0")
        return round(pretrigger * rate)
    max_pretrigger = round(PRETRIGGER_SHARE * rate)
    # a hit without anything before it is judged later; it must not shorten the others
    return min(
        [max_pretrigger, *(hit.onset for hit in onsets if hit.onset >= min(8, max_pretrigger))]
    )


def _choose_length(
    onsets: Sequence[_PulseOnset], rate: float, samples_before: int, record: float | None
) -> int:
    if record is not None:
        length = sample_count(record, rate) if np.isfinite(record) else 0
        if length < samples_before + 8:
            raise DataError(
                f"record = {record!r} s; expected more than the {samples_before / rate:.3g} s "
                "before the hit"
            )
        return length
    space = []
    for hit in onsets:
        end_sample = (
            hit.record.stop - hit.record.start if hit.next is None else hit.next - samples_before
        )
        space.append(end_sample - hit.onset + min(samples_before, hit.onset))
    usual_spacing = float(np.median(space))
    return max(samples_before + 8, min(r for r in space if r >= 0.5 * usual_spacing))


def _cut_hit(hit: _PulseOnset, name: str, samples_before: int, length: int) -> HitBlock:
    test, record_length = hit.test, hit.record.stop - hit.record.start
    onset = min(samples_before, hit.onset)
    start = hit.record.start + hit.onset - onset
    stop = min(start + length, hit.record.start + record_length)
    rows = np.vstack((hit.sign * test.force[start:stop], test.acceleration[:, start:stop]))
    quiet_rows = rows[:, : max(onset - GUARD_SAMPLES, 0)]
    offset, quiet_sd, noise = np.zeros((3, len(rows)))
    if quiet_rows.shape[1] >= 4:
        offset, quiet_sd = quiet_rows.mean(axis=1), quiet_rows.std(axis=1)
        rows = rows - offset[:, None]
    if quiet_rows.shape[1] >= 5:
        # differences of neighbours see noise, not the slow ringing of an earlier hit
        noise = np.diff(quiet_rows, axis=1).std(axis=1) / np.sqrt(2)
    missing_samples = length - (stop - start)
    rows = np.pad(rows, ((0, 0), (0, missing_samples)))
    return HitBlock(
        name=name,
        time=float(test.time[hit.record.start + hit.onset]),
        rate=test.rate,
        onset=onset,
        force=rows[0],
        acceleration=rows[1:],
        noise=noise,
        ringing=quiet_sd[1:],
        offset=offset,
        missing=missing_samples,
        turned=hit.sign < 0,
        past=_get_earlier_motion(hit) - offset[1:, None],
        since_start=hit.onset / test.rate
        if hit.previous is None and hit.next is None
        else float("nan"),
    )


def _get_earlier_motion(hit: _PulseOnset) -> FloatArray:
    """Accelerations before a hit, well after the one before."""
    rate, record = hit.test.rate, hit.record
    history_start = 0 if hit.previous is None else (hit.previous + hit.onset) // 2
    first = max(hit.onset - round(HISTORY_LENGTH * rate), history_start)
    return hit.test.acceleration[
        :, record.start + first : record.start + max(hit.onset - GUARD_SAMPLES, first)
    ]


def remove_ringing(hit: HitBlock, poles: Sequence[complex]) -> HitBlock:
    r"""Take off :math:`\sum_i \mathrm{Re}\,c_i e^{p_i t} + c_0`, fitted to what precedes the hit.

    A block that has not come to rest moves on as if nothing had struck it, and answers the hit on
    top of that. With the poles known, up to a second of record before the hit shows how.
    The hit is returned as it is if that explains less than half of the motion.
    """
    ringing = hit.past
    if ringing.shape[1] < 4 * (2 * len(poles) + 1) or not poles:
        return hit
    time_before = (np.arange(ringing.shape[1]) - ringing.shape[1] - GUARD_SAMPLES) / hit.rate
    basis = _make_decays(time_before, np.array(poles))
    c, *_ = np.linalg.lstsq(basis, ringing.T, rcond=1e-10)
    residual = ringing.T - basis @ c
    if residual.var() > (1 - MIN_EXPLAINED_SHARE) * ringing.var():
        return hit
    time_since_onset = (np.arange(len(hit.force)) - hit.onset) / hit.rate
    return replace(
        hit,
        acceleration=hit.acceleration - (_make_decays(time_since_onset, np.array(poles)) @ c).T,
        calmed=True,
    )


def _make_decays(t: FloatArray, poles: ComplexArray) -> FloatArray:
    waves = np.exp(np.outer(t, poles))
    return np.column_stack((waves.real, waves.imag, np.ones_like(t)))
