"""Preparation of recorded hysteresis loops as an amplitude sweep, by first harmonics."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, FloatArray, median
from dashpot.base.errors import DataError
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.extensions.amplitude.datamodel import AmplitudeSweep, LoopRecord
from dashpot.extensions.amplitude.harmonic_motion import estimate_scatter, find_cycle_starts

_MIN_SAMPLES_PER_CYCLE = 12
"""Samples of a cycle."""
_STEADY_CHANGE = 0.05
"""Change of amplitude from a cycle to the next, relatively, in which a loop is closed."""
_ONE_TONE = 1.05
"""Ratio up to which frequencies of cycles count as equal."""
_MAX_TILT = 1e-3
"""Relative slope of a clipped force by drift."""
_ELASTIC = "a law of stress over strain is fitted with --kind stress-strain"


@dataclass(frozen=True, eq=False)
class HysteresisLoop:
    """Closed hysteresis loop: one steady cycle about its mean.

    Attributes
    ----------
    frequency : float
        Hz.
    amplitude : float
        Amplitude of the first harmonic of the displacement, m, or of the strain of a material.
    stiffness : complex
        First harmonic of the force over that of the displacement, N/m; Pa of a material.
    sd : float
        Standard deviation of either part of that, from the scatter between neighbouring samples,
        N/m or Pa.
    displacement, force : array, shape (n,)
        As recorded, less their mean and drift, m and N; strain and stress of a material.
    sign_reversed : bool
        The force counts down where the displacement counts up, and its sign was reversed.
    """

    frequency: float
    amplitude: float
    stiffness: complex
    sd: float
    displacement: FloatArray
    force: FloatArray
    sign_reversed: bool = False


def compute_sweep(test: LoopRecord, machine: Machine | None = None) -> AmplitudeSweep:
    r"""Return stiffness and loss, N/m or Pa, of every steady cycle of a harmonic motion.

    As :func:`find_steady_cycles` finds them, :math:`K^* = F_1 / X_1`. Of the `machine` the `sync`
    is heeded.

    Raises
    ------
    DataError
        If there are fewer than two cycles, or too few samples in them.
    """
    machine = machine or Machine()
    machine.refuse_unused("sync", subject="recorded loops")
    cycles = find_steady_cycles(test)
    K = np.array([cycle.stiffness for cycle in cycles])
    unit, amplitude_unit, force_name = (
        ("N/m", "m", "force") if isinstance(test, RelaxationTest) else ("Pa", "strain", "stress")
    )
    source = test.source
    if source is not None and cycles[0].sign_reversed:
        note = f"the {force_name} falls where the motion rises; its sign was reversed"
        source = replace(source, notes=(*source.notes, note))
    return AmplitudeSweep(
        np.array([cycle.frequency for cycle in cycles]),
        np.array([cycle.amplitude for cycle in cycles]),
        K.real,
        K.imag,
        unit,
        amplitude_unit,
        test.specimen,
        source,
        np.array([cycle.sd for cycle in cycles]),
        machine.delay_sd(median(np.diff(test.time))),
        units="SI",
    )


def find_steady_cycles(test: LoopRecord) -> tuple[HysteresisLoop, ...]:
    r"""Return every cycle of a harmonic motion whose loop has closed.

    Cycles are cut where the displacement, less its drift, rises through its middle. Over each,
    force and displacement, less their drift from the mean of the cycle before, are fitted by a
    constant and :math:`e^{j\omega t}`; of neighbouring frequencies omega is the median. A cycle
    counts where its amplitude is that of the one before within 5 %: the loop has closed.

    Raises
    ------
    DataError
        If there are fewer than two cycles, or too few samples in them.
    """
    part = isinstance(test, RelaxationTest)
    if isinstance(test, RelaxationTest):
        motion, force = test.displacement, test.force
    else:
        motion, force = test.strain, test.stress
    t, signals = test.time, np.array([motion, force])
    starts = find_cycle_starts(t, motion)
    if len(starts) < 3:
        raise DataError(
            f"{max(len(starts) - 1, 0)} cycles of {'displacement' if part else 'strain'} found; "
            "loops need two or more at each amplitude; "
            + ("a ramp and a hold, or a creep test, is for dashpot fit" if part else _ELASTIC)
        )
    tones, means = _find_tones(1 / np.diff(starts)), _average_cycles(t, signals, starts)
    loops, last = [], np.nan
    for i, (begin, end) in enumerate(pairwise(starts.tolist())):
        in_cycle = (t >= begin) & (t < end)
        if np.count_nonzero(in_cycle) < _MIN_SAMPLES_PER_CYCLE:
            raise DataError(
                f"{np.count_nonzero(in_cycle)} samples in a cycle of {end - begin:.3g} s; loops "
                f"need {_MIN_SAMPLES_PER_CYCLE} or more; export more samples, or move slower"
            )
        time_from_middle = t[in_cycle] - (begin + end) / 2
        # what is higher than the first harmonic leaks into a slope fitted to one cycle
        drift = (means[:, i] - means[:, max(i - 1, 0)])[:, None] / (end - begin) * time_from_middle
        x, F = signals[:, in_cycle] - means[:, i, None] - drift
        X1, F1 = _compute_harmonics(time_from_middle, np.array((x, F)), 2 * np.pi * tones[i])
        size = float(abs(X1))
        if abs(size / last - 1) <= _STEADY_CHANGE:
            K = complex(F1 / X1)
            sd = estimate_scatter(F - K.real * x) * np.sqrt(2 / len(x)) / size
            loops.append(HysteresisLoop(float(tones[i]), size, K, sd, x, F))
        last = size
    if not loops:
        raise DataError(
            "no two cycles that follow each other have one amplitude: hold each for some cycles"
            + ("" if part else f"; {_ELASTIC}")
        )
    if median(np.array([loop.stiffness.real for loop in loops])) < 0:
        loops = [
            replace(loop, stiffness=-loop.stiffness, force=-loop.force, sign_reversed=True)
            for loop in loops
        ]
    return tuple(loops)


def find_flat_part(loops: Sequence[HysteresisLoop]) -> float:
    r"""Return the part of a cycle for which the force is at its largest or smallest value.

    Of the loops at least half as large as the largest it is the longest stretch within six standard
    deviations of the noise, less that of the crest of a sine, :math:`\sqrt{2\delta/A}/\pi`.
    """
    sizes = [float(np.ptp(loop.force)) for loop in loops]
    longest = 0.0
    for loop, size in zip(loops, sizes, strict=True):
        if size < max(sizes) / 2:
            continue
        # a drift that was taken off tilts what was flat
        tolerance = 6 * estimate_scatter(loop.force) + _MAX_TILT * size
        crest = float(np.sqrt(4 * tolerance / size) / np.pi)
        for values in (loop.force, -loop.force):
            edges = np.flatnonzero(
                np.diff(np.pad((values >= values.max() - tolerance).astype(int), 1))
            )
            longest_share = float((edges[1::2] - edges[::2]).max()) / len(values)
            longest = max(longest, longest_share - crest)
    return longest


def _find_tones(frequency: FloatArray) -> FloatArray:
    """Return the nominal frequency of each cycle: neighbours share their median.

    Cycles of a frequency sweep have their own: most are far from the median.
    """
    order = np.argsort(frequency)
    indices = np.flatnonzero(np.diff(np.log(frequency[order])) > np.log(_ONE_TONE))
    values = np.empty_like(frequency)
    for part in np.split(order, indices + 1):
        median_value = median(frequency[part])
        is_near_tone = np.abs(np.log(frequency[part] / median_value)) < np.log(_ONE_TONE) / 2
        is_wide = frequency[part].max() > _ONE_TONE**2 * frequency[part].min()
        # between two amplitudes a cycle may be shorter or longer
        is_sweep = is_wide and np.mean(is_near_tone) <= 0.5
        values[part] = frequency[part] if is_sweep else median_value
    return values


def _average_cycles(t: FloatArray, signals: FloatArray, starts: FloatArray) -> FloatArray:
    """Return mean of each signal over each cycle, shape (signals, cycles)."""
    steps = np.diff(t) * (signals[:, 1:] + signals[:, :-1]) / 2
    total = np.pad(np.cumsum(steps, axis=1), ((0, 0), (1, 0)))
    cumulative = np.array([np.interp(starts, t, item) for item in total])
    return np.asarray(np.diff(cumulative) / np.diff(starts))


def _compute_harmonics(t: FloatArray, signals: FloatArray, omega: float) -> ComplexArray:
    """First harmonics over one period, beside a constant."""
    A = np.column_stack((np.ones_like(t), np.cos(omega * t), -np.sin(omega * t)))
    result = np.linalg.lstsq(A, signals.T, rcond=None)[0]
    return np.asarray(result[1] + 1j * result[2])
