"""What a second look says of the modes of measured FRFs."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from statistics import NormalDist

import numpy as np

from dashpot.base.checks import Finding, criterion
from dashpot.base.units import in_unit, written
from dashpot.records.frf_set import ModeShape
from dashpot.vibration.modal.stabilisation import Stabilisation

STABLE = 5
MISSED = 4.0
SURE = 0.99
OVERLAP, CLOSE = 0.2, 0.05
PLANE, ROD_LINES = 0.05, 8


@criterion("orders", ">=", STABLE, "measured: what only follows noise is stable at fewer")
def modes_stable(modes: Sequence[ModeShape], chart: Stabilisation) -> Finding:
    """Every mode stands in the stabilisation chart, which knows nothing of how it was found."""
    counts = [(chart.orders_with(one.mode), one.mode.frequency) for one in modes]
    fewest = min(counts)[0]
    doubtful = ", ".join(f"{hz:.4g} Hz ({count})" for count, hz in counts if count < STABLE)
    of = f"of {chart.highest} orders of the stabilisation chart"
    return Finding(
        f"every mode is stable at {fewest} or more {of}",
        fewest,
        instead=f"stable at few {of}: {doubtful}; such a mode may be noise, or stand too close to "
        "another for the chart to part them: hold it against other points, or record longer",
    )


@criterion(
    "squared misfit over its variance", "<=", MISSED, "our choice: twice the scatter; 1 is chance"
)
def modes_explain_lines(modes: Sequence[ModeShape], *, known: bool) -> Finding:
    """The modes follow the lines about them as closely as the lines are known."""
    if not known:
        return Finding(
            "the lines come without their scatter, so whether the modes explain them is not told"
        )
    worst = max(modes, key=lambda one: one.misfit)
    return Finding(
        f"about {worst.mode.frequency:.4g} Hz the lines miss the modes by {worst.misfit:.2g} times "
        "their variance",
        worst.misfit,
        ", and the errors are widened by as much: another mode close by or beyond the band, points "
        "that were not measured at once, or a structure that is not linear",
    )


@criterion("least overlap of two close shapes", ">=", OVERLAP, "our choice; 1 is the same points")
def points_share_modes(modes: Sequence[ModeShape]) -> Finding:
    """Modes close together move the same points, as those of one structure do."""
    close = [
        (_overlap(one, other), one.mode.frequency, other.mode.frequency)
        for one, other in combinations(modes, 2)
        if abs(one.mode.frequency / other.mode.frequency - 1) < CLOSE
    ]
    if not close:
        return Finding("no two modes are so close that they could be one, measured at two states")
    least, one_hz, other_hz = min(close)
    pair = f"the modes at {one_hz:.4g} and {other_hz:.4g} Hz"
    return Finding(
        f"{pair} move the same points",
        least,
        instead=f"{pair} hardly share a point: one mode that was measured at two states looks so, "
        "as where an accelerometer loads the structure or the seals warm up between points; "
        "measure the points at once",
    )


def _overlap(one: ModeShape, other: ModeShape) -> float:
    """What two shapes share of their points, whatever the signs."""
    a, b = np.abs(one.residues), np.abs(other.residues)
    return float(a @ b / np.sqrt((a @ a) * (b @ b)))


@criterion("distance, standard errors", "<=", source="chance exceeds it once in a hundred")
def one_solid(distance: float, masses: Sequence[float], worst: tuple[float, str]) -> Finding:
    """One linear solid has the poles that were measured under all of the masses."""
    listed = ", ".join(f"{in_unit(mass, 'g'):.4g}" for mass in masses)
    kilogram, by = worst
    return Finding(
        f"one linear solid has the poles under {listed} g",
        distance,
        instead=f"no linear solid has the poles under {listed} g; the closest misses that under "
        f"{written(kilogram, 'g')} by {by}: the seals are compressed more by a larger mass, or "
        "move farther under one of them, a mass is not what was weighed, or the temperature "
        "changed",
        limit=_by_chance(2 * len(masses)),
    )


def _by_chance(count: int) -> float:
    """What the root of so many squared standard errors exceeds once in a hundred tests."""
    z, share = NormalDist().inv_cdf(SURE), 2 / (9 * count)
    return float((count * (1 - share + z * share**0.5) ** 3) ** 0.5)  # Wilson and Hilferty 1931


@criterion("usable lines", ">=", ROD_LINES, "our choice", otherwise="stop where there is none")
def rod_usable(lines: int, band: tuple[float, float]) -> Finding:
    """Lines enough about the resonance know storage and loss factor to 10 %."""
    if not lines:
        return Finding(
            "at no line storage and loss factor are known to 10 %: a degree of phase or a per cent "
            "of gain hides them; take a heavier mass, calibrate the sensors against each other on "
            "the bare base, or average longer",
            0,
            grade="stop",
        )
    return Finding(
        f"storage and loss factor are known to 10 % at {lines} lines, {band[0]:.4g} to "
        f"{band[1]:.4g} Hz",
        lines,
        ": too few to show whether one material explains them; measure more lines, or another mode "
        "is within the resonance",
    )


@criterion("mass / rod", "<=", 100.0, "our choice: tests of rods have .5 to 50 (Kulik et al. 2009)")
def mass_beside_rod(ratio: float) -> Finding:
    """The mass is one that such a rod carries; no line shows modulus and mass too large alike."""
    return Finding(
        f"the mass is {ratio:.3g} times that of the rod",
        ratio,
        ": more than such tests have; is its unit right? The modulus is proportional to it",
    )


@criterion(
    "departure of T at rest / standard deviation", "<=", 3.0, "our choice: chance, once in 400"
)
def sensors_agree(gain: float | None, phase: float, *, known: tuple[float, float]) -> Finding:
    """Far below the resonance both sensors read one motion, within the errors that were said."""
    if gain is None:
        return Finding("no lines below half the usable band show what the sensors read at rest")
    return Finding(
        f"far below the resonance the mass moves {100 * gain:+.2g} % and {np.degrees(phase):+.2g} "
        "degrees off what the modulus has it",
        float(max(abs(gain) / known[0], abs(phase) / known[1])),
        ": the sensors differ by more than was said (--gain-error, --phase-error); calibrate them "
        "on the bare base, or say how far they are off",
    )


@criterion(
    "(k r / 2)^2, r the polar radius of gyration", "<=", PLANE,
    "A. E. H. Love, Treatise (1927) sec. 278: what the bulging's inertia takes off the modulus",
)  # fmt: skip
def waves_plane(bulging: float | None, frequency: float) -> Finding:
    """The waves are long against the section, so that it moves as one."""
    if bulging is None:
        return Finding("no line is usable, so the waves at its end are not judged")
    return Finding(
        f"at {frequency:.4g} Hz the rod's bulging takes {100 * bulging:.2g} % off the modulus",
        bulging,
        ": the wave is no longer plane; use lower frequencies (--band), or a thinner rod",
    )
