"""What the modulus of a rod can be trusted with, as criteria."""

from __future__ import annotations

import numpy as np

from dashpot.base.checks import Finding, criterion

PLANE = 0.05


ROD_LINES = 8
NO_SOLID = 10.0


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
    "chi square / degrees of freedom", "<=", 1.5,
    "own rods: 1.42 at most of 360 whose lines are of one solid", otherwise="stop beyond 10",
)  # fmt: skip
def lines_of_one_solid(misfit: float | None) -> Finding:
    """One passive solid explains the lines, within their scatter and the errors that they share."""
    if misfit is None:
        return Finding("too few lines, or none with a known scatter, to ask for one solid")
    return Finding(
        f"one passive solid leaves {np.sqrt(misfit):.3g} times the scatter of the lines",
        misfit,
        ". Another mode, such as rocking, moves with the rod. Hold the mass straight, or leave "
        "those lines out (--band)",
        grade="stop" if misfit > NO_SOLID else "limit",
    )


@criterion(
    "departure of T at rest / standard deviation",
    "<=",
    3.0,
    "our choice: chance, once in 400; what was found is taken out",
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
