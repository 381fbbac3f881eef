"""Criteria on the modulus of a rod."""

from __future__ import annotations

import numpy as np

from dashpot.base.checks import Finding, Remedy, criterion

PLANE = 0.05


ROD_LINES = 8
NO_SOLID = 10.0


@criterion("usable lines", ">=", ROD_LINES, "our choice", other_grade="stop where there is none")
def modulus_determined_near_resonance(lines: int, band: tuple[float, float]) -> Finding:
    """Enough lines near the resonance give storage and loss factor to 10 %."""
    if not lines:
        return Finding(
            "Storage and loss factor are known to 10 % at no line. A degree of phase or a per cent "
            "of gain hides them",
            0,
            remedy="Use a heavier mass, calibrate the sensors on the bare base, or average longer.",
            grade="stop",
        )
    return Finding(
        f"Storage and loss factor are known to 10 % at {lines} lines from {band[0]:.4g} to "
        f"{band[1]:.4g} Hz; at least {ROD_LINES} are needed",
        lines,
        "So few cannot show whether one material explains them. Another mode may be near",
        "Measure more lines.",
    )


@criterion("mass / rod", "<=", 100.0, "our choice: tests of rods have .5 to 50 (Kulik et al. 2009)")
def mass_ratio_suitable(ratio: float) -> Finding:
    """The mass is plausible for such a rod; the lines alone cannot show an error in it."""
    return Finding(
        f"The mass is {ratio:.3g} times that of the rod",
        ratio,
        "Such tests have less, and the modulus is proportional to it",
        Remedy("Check the mass and its unit.", "mass"),
    )


@criterion(
    "chi square / degrees of freedom", "<=", 1.5,
    "simulation: at most 1.42 in 360 rods of one material", other_grade="stop beyond 10",
)  # fmt: skip
def single_solid_explains_lines(misfit: float | None) -> Finding:
    """One passive model fits the lines within their scatter and their common errors."""
    if misfit is None:
        return Finding("The lines are too few, or their scatter is not known, to test one model")
    return Finding(
        f"One passive model misses the lines by {np.sqrt(misfit):.3g} times their scatter",
        misfit,
        "Another mode, such as rocking, moves the mass",
        Remedy("Hold the mass straight, or leave those lines out.", "band"),
        grade="stop" if misfit > NO_SOLID else "limit",
    )


@criterion(
    "deviation of T at rest / standard deviation",
    "<=",
    3.0,
    "our choice: chance, once in 400; the deviation is corrected",
)
def sensors_agree(gain: float | None, phase: float, *, values: tuple[float, float]) -> Finding:
    """Far below the resonance both sensors read the same motion within their errors."""
    if gain is None:
        return Finding("No lines lie far below the resonance, so the sensors are not compared")
    return Finding(
        f"Far below the resonance the sensors differ by {100 * gain:+.2g} % and "
        f"{np.degrees(phase):+.2g} degrees from the modulus",
        float(max(abs(gain) / values[0], abs(phase) / values[1])),
        "That is more than the errors that were given",
        Remedy("Calibrate them on the bare base, or give their errors.", "gain-error"),
    )


@criterion(
    "(k r / 2)^2, r the polar radius of gyration", "<=", PLANE,
    "A. E. H. Love, Treatise (1927) sec. 278: error by lateral inertia",
)  # fmt: skip
def waves_plane(bulging: float | None, frequency: float) -> Finding:
    """The waves are long relative to the section, so that it moves as one."""
    if bulging is None:
        return Finding("No line is usable, so the waves are not checked")
    return Finding(
        f"At {frequency:.4g} Hz the bulging of the rod lowers the modulus by {100 * bulging:.2g} %",
        bulging,
        "The wave is no longer plane",
        Remedy("Use lower frequencies, or a thinner rod.", "band"),
    )
