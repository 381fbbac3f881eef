"""Criteria on the modes of measured FRFs."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from statistics import NormalDist

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.datamodel.frf import FRF, Mode
from dashpot.datamodel.structure import ModeShape
from dashpot.datamodel.vibration_tests import ShakenTest
from dashpot.extensions.modes.stabilisation import Stabilisation

STABLE = 5
MISSED = 4.0
SURE = 0.99
OVERLAP, CLOSE = 0.2, 0.05


@criterion("orders", ">=", STABLE, "measured: modes of noise are stable at fewer")
def modes_stable(modes: Sequence[ModeShape], chart: Stabilisation) -> Finding:
    """Every mode is stable in the stabilisation chart, which is computed separately."""
    counts = [(chart.orders_with(mode.mode), mode.mode.frequency) for mode in modes]
    fewest_modes = min(counts)[0]
    doubtful_text = ", ".join(f"{hz:.4g} Hz ({count})" for count, hz in counts if count < STABLE)
    order_text = f"of {chart.highest} orders of the stabilisation chart"
    return Finding(
        f"Every mode is stable at {fewest_modes} or more {order_text}",
        fewest_modes,
        failure=f"Modes are stable at few {order_text}: {doubtful_text}",
        reason="They may be noise, or too close to another mode",
        remedy="Compare them with other points, or record longer.",
    )


@criterion(
    "squared misfit over its variance", "<=", MISSED, "our choice: twice the scatter; 1 is chance"
)
def modes_explain_lines(modes: Sequence[ModeShape], *, is_known: bool) -> Finding:
    """The modes fit the lines around them to within the errors of the lines."""
    if not is_known:
        return Finding(
            "The lines come without their scatter, so the fit of the modes is not checked"
        )
    worst = max(modes, key=lambda shape: shape.misfit)
    return Finding(
        f"About {worst.mode.frequency:.4g} Hz the lines miss the modes by {worst.misfit:.2g} times "
        "their variance",
        worst.misfit,
        "Another mode, points measured at other times, or nonlinearity may cause this. The errors "
        "are widened by as much",
        Remedy("Widen the band, or measure all points at once.", "band"),
    )


@criterion("least overlap of two close shapes", ">=", OVERLAP, "our choice; 1 is the same points")
def points_share_modes(modes: Sequence[ModeShape]) -> Finding:
    """Modes at close frequencies move the same points, as those of one structure do."""
    similar_pairs = [
        (_overlap(first, second), first.mode.frequency, second.mode.frequency)
        for first, second in combinations(modes, 2)
        if abs(first.mode.frequency / second.mode.frequency - 1) < CLOSE
    ]
    if not similar_pairs:
        return Finding("No two modes are so close that they could be one, measured at two states")
    smallest_distance, one_hz, other_hz = min(similar_pairs)
    pair = f"The modes at {one_hz:.4g} and {other_hz:.4g} Hz"
    return Finding(
        f"{pair} move the same points",
        smallest_distance,
        failure=f"{pair} hardly share a point",
        reason="One mode measured at two states looks so: an accelerometer adds mass, or the "
        "seals warm up",
        remedy="Measure the points at once.",
    )


def _overlap(first: ModeShape, second: ModeShape) -> float:
    """Return the similarity of two shapes at their common points, whatever the signs."""
    a, b = np.abs(first.residues), np.abs(second.residues)
    return float(a @ b / np.sqrt((a @ a) * (b @ b)))


@criterion("distance, standard errors", "<=", source="chance exceeds it once in a hundred")
def single_solid_explains_masses(
    distance: float, masses: Sequence[float], worst: tuple[float, str]
) -> Finding:
    """One linear model has the poles that were measured under all of the masses."""
    masses_text = ", ".join(f"{convert_to_unit(mass, 'g'):.4g}" for mass in masses)
    kilogram, deviation = worst
    return Finding(
        f"One linear model has the poles under {masses_text} g",
        distance,
        failure=f"No linear model has the poles under {masses_text} g. The closest misses "
        f"{format_quantity(kilogram, 'g')} by {deviation}",
        reason="A larger mass compresses the seals more, or a mass or the temperature is wrong",
        remedy="Weigh the masses, and compress the seals alike.",
        limit=_chi_quantile(2 * len(masses)),
    )


def _chi_quantile(count: int) -> float:
    """Return the 99 % quantile of the root of a sum of squared standard errors."""
    z, ratio = NormalDist().inv_cdf(SURE), 2 / (9 * count)
    return float((count * (1 - ratio + z * ratio**0.5) ** 3) ** 0.5)  # Wilson and Hilferty 1931


@criterion("modes outside", "<=", 0.0, "a pole outside the lines represents modes that lie there")
def modes_within_band(modes: Sequence[Mode], band: tuple[float, float]) -> Finding:
    """The modes lie within the measured band."""
    is_outside = [m.frequency for m in modes if not band[0] <= m.frequency <= band[1]]
    frequencies_text = ", ".join(f"{frequency:.4g}" for frequency in is_outside)
    return Finding(
        f"Every mode lies between {band[0]:.4g} and {band[1]:.4g} Hz",
        float(len(is_outside)),
        failure=f"The mode at {frequencies_text} Hz lies outside the lines between {band[0]:.4g} "
        f"and {band[1]:.4g} Hz",
        reason="It stands for what lies beyond them",
        remedy=Remedy("Widen the band.", "band"),
    )


@criterion(
    "runs of 3 samples at an end of the range", "<=", 1.0, "by definition; chance", grade="stop"
)
def channels_not_clipped(test: ShakenTest) -> Finding:
    """No channel of a shaken base is clipped."""
    runs = {
        name: _count_clipped_runs(signal)
        for name, signal in (("base", test.base), ("mass", test.mass))
    }
    worst = max(runs, key=lambda name: runs[name])
    return Finding(
        "Neither channel stays at the end of its range",
        runs[worst],
        failure=f"The acceleration of the {worst} is clipped {runs[worst]} times, so the damping "
        "is wrong",
        remedy="Use a larger range, or shake less.",
    )


@criterion(
    "lines in the half-power band", ">=", 6.0, "measured: the peak reads 3 % low there, 7 % at 4"
)
def segments_resolve(frf: FRF, main: Mode | None) -> Finding:
    """The segments of a shaken base are long enough to resolve the resonance."""
    if main is None:
        return Finding("No resonance was found, so the resolution is not checked")
    spacing = float(np.median(np.diff(frf.frequency)))
    lines = main.bandwidth / spacing
    return Finding(
        f"The half-power band has {lines:.2g} lines; at least 6 are needed. The frequency "
        f"resolution is {spacing:.3g} Hz",
        lines,
        "The peak is flattened",
        Remedy(
            f"Use segments of {8 / main.bandwidth:.2g} s, and record eight times as long.",
            "hit-length",
            f"{8 / main.bandwidth:.2g}s",
        ),
    )


def _count_clipped_runs(signal: FloatArray) -> int:
    """Return how often three samples in a row are at the maximum, or at the minimum."""
    count = 0
    for end in (signal.max(), signal.min()):
        is_clipped = np.convolve(signal == end, np.ones(3), "valid") == 3
        count += int(np.count_nonzero(is_clipped & ~np.append(False, is_clipped[:-1])))
    return count
