"""Lines of all sweeps as one table: groups of compression, amplitude and frequency."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray
from dashpot.base.errors import DataError
from dashpot.base.units import convert_to_unit
from dashpot.extensions.preload_map.preload_sweep import PreloadSweep

SAME_COMPRESSION, SAME_AMPLITUDE, SAME_TONE = 0.01, 0.06, 0.01
"""Relative differences below which a machine meant the same value."""
_STEP_SHARE = 0.4
"""Part of the least step of a sweep within which frequencies of two sweeps are the same."""
_EQUALITY_TOLERANCE = 1e-6
MIN_FREQUENCIES = 3
"""Frequencies of a sweep, at least: its shape is compared."""


class StiffnessLines(NamedTuple):
    r"""All lines, their logarithm and their groups.

    Attributes
    ----------
    frequency, weight : array, shape (n,)
    magnitude, angle : array, shape (n,)
        :math:`\ln|K^*|`, K in N/m, and the loss angle, rad.
    compressions, amplitudes : array
        Levels, m, rising; one amplitude of nan where none is known.
    distinct_frequencies : array
        Frequencies of all sweeps, Hz, rising; those within the tolerance are one.
    compression, amplitude, frequency_index, sweep : int array, shape (n,)
        Indices of the levels of each line, and of its sweep.
    """

    frequency: FloatArray
    weight: FloatArray
    magnitude: FloatArray
    angle: FloatArray
    compressions: FloatArray
    amplitudes: FloatArray
    distinct_frequencies: FloatArray
    compression: IndexArray
    amplitude: IndexArray
    frequency_index: IndexArray
    sweep: IndexArray

    @property
    def shares_tones(self) -> bool:
        """Whether most lines are at a frequency that another sweep has as well."""
        sweeps = [
            len(set(self.sweep[self.frequency_index == i].tolist()))
            for i in range(len(self.distinct_frequencies))
        ]
        return bool(np.mean(np.array(sweeps)[self.frequency_index] > 1) > _MIN_SHARED_BAND)

    @property
    def centred_frequency(self) -> FloatArray:
        """Logarithm of the frequency, from -1 to 1."""
        u = np.log(self.frequency)
        middle, half_range = (u.max() + u.min()) / 2, (u.max() - u.min()) / 2
        return np.asarray((u - middle) / half_range)


_MIN_SHARED_BAND = 0.7
_LEAST = 1e-300


def collect_lines(sweeps: Sequence[PreloadSweep]) -> StiffnessLines:
    """Return the lines of sweeps of one part, in groups.

    Raises
    ------
    DataError
        If there are fewer than two compressions, a sweep is too short or a copy, or only some
        sweeps state their amplitude.
    """
    if len(sweeps) < 2:
        raise DataError(
            f"found {len(sweeps)} sweep; a map needs sweeps at two compressions or more"
        )
    sweeps_by_content: dict[tuple[object, bytes], PreloadSweep] = {}
    for sweep in sweeps:
        first = sweeps_by_content.setdefault((sweep.amplitude, sweep.value.tobytes()), sweep)
        compression_text = f"at {convert_to_unit(float(sweep.compression), 'mm'):g} mm"
        if first is not sweep:
            raise DataError(
                f"the sweep of {sweep.name} {compression_text} has the very numbers of another, of "
                f"{first.name}: a copy is no second measurement. Leave one out"
            )
        if len(set(sweep.frequency.tolist())) < MIN_FREQUENCIES:
            raise DataError(
                f"{sweep.name} has too few frequencies {compression_text}; expected "
                f"{MIN_FREQUENCIES} or "
                "more in every sweep"
            )
    unknown = [sweep.name for sweep in sweeps if sweep.amplitude is None]
    if 0 < len(unknown) < len(sweeps):
        raise DataError(
            f"no amplitude is known of {unknown[0]}, but of other sweeps: state it of each "
            f"(--amplitude {unknown[0]}:0.1mm), or of none"
        )
    counts = [len(sweep.frequency) for sweep in sweeps]
    sweep_index = np.repeat(np.arange(len(sweeps)), counts)
    sweep_compressions = np.array([float(sweep.compression) for sweep in sweeps])
    compressions, compression = group_levels(sweep_compressions, SAME_COMPRESSION)
    if len(compressions) < 2:
        raise DataError(
            f"every sweep is at {convert_to_unit(float(compressions[0]), 'mm'):.4g} mm; a map "
            "needs two compressions or more. For one, use dashpot fit"
        )
    sweep_amplitudes = np.array(
        [np.nan if s.amplitude is None else float(s.amplitude) for s in sweeps]
    )
    amplitudes, amplitude = (
        (np.array([np.nan]), np.zeros(len(sweeps), dtype=int))
        if unknown
        else group_levels(sweep_amplitudes, SAME_AMPLITUDE)
    )
    frequency = np.concatenate([sweep.frequency for sweep in sweeps])
    value = np.concatenate([sweep.value for sweep in sweeps])
    weight = np.concatenate([np.asarray(sweep.weight, dtype=float) for sweep in sweeps])
    closest = min(_get_least_step(sweep.frequency) for sweep in sweeps)
    tones, tone = group_levels(frequency, min(SAME_TONE, _STEP_SHARE * closest))
    return StiffnessLines(
        frequency,
        weight / float(np.sqrt(np.mean(weight**2))),
        np.log(np.abs(value)),
        np.angle(value),
        compressions,
        amplitudes,
        tones,
        compression[sweep_index],
        amplitude[sweep_index],
        tone,
        sweep_index,
    )


def _get_least_step(frequency: FloatArray) -> float:
    """Return the least step between two frequencies of a sweep in ln f."""
    steps = np.diff(np.log(np.sort(frequency)))
    return float(np.min(steps[steps > _EQUALITY_TOLERANCE], initial=np.inf))


def group_levels(values: FloatArray, tolerance: float) -> tuple[FloatArray, IndexArray]:
    """Return the levels of values, rising, and which of them each value is of.

    Neighbours whose logarithms differ by less than `tolerance` are of one level; values that are
    not above zero, too.
    """
    order = np.argsort(values, kind="stable")
    logs = np.log(np.maximum(values[order], _LEAST))
    steps = np.concatenate(([0], np.cumsum(np.diff(logs) > tolerance)))
    group = np.empty(len(values), dtype=int)
    group[order] = steps
    levels = np.array([float(values[group == i].mean()) for i in range(int(steps[-1]) + 1)])
    return levels, group
