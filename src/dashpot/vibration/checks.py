"""Criteria on a body on seals, and on the stiffness from an FRF."""

from __future__ import annotations

from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.units import format_quantity

CAUSAL_LIMIT = 0.5
MAX_EXTRAPOLATION = 3.0
# above this part of the block's mass the seals' own inertia shifts the peak by a third of a percent


@criterion("seals / test mass", "<=", 0.02, "2 % move the peak by 0.33 %")
def seal_mass_negligible(part: float) -> Finding:
    """The mass of the seals is negligible relative to the test mass."""
    return Finding(
        f"The seals weigh {100 * part:.2g} % of the test mass",
        part,
        "A third of that counts as moving mass. The rest, and waves within the seal, are not "
        "modelled",
        "Use a heavier test mass.",
    )


@criterion("mass, kg", ">=", 1e-3, "our choice: an accelerometer alone weighs more")
def mass_of_a_block(mass: float) -> Finding:
    """The mass is plausible for a hammer test."""
    return Finding(
        f"The mass is {format_quantity(mass, 'g')}",
        mass,
        "An accelerometer alone weighs more",
        Remedy("Check the unit of the mass: kg or g.", "mass"),
    )


@criterion(
    "compression / tested depth", "<=", 1.0, "the depth of the test", other_grade="stop beyond 3"
)
def compression_tested(compression: float, depth: float | None) -> Finding:
    """The seals are compressed no further than in their test."""
    message = f"The seals are pressed by {format_quantity(compression, 'mm')}"
    if depth is None:
        return Finding(f"{message}. The depth of their test is not known")
    part = compression / depth
    return Finding(
        f"{message}, within the {format_quantity(depth, 'mm', '.3g')} tested",
        part,
        failure=f"{message}, {part:.3g} times the {format_quantity(depth, 'mm', '.3g')} tested",
        remedy=Remedy("Check the mass and its unit, or test as deep.", "mass"),
        grade="stop" if part > MAX_EXTRAPOLATION else "limit",
    )


@criterion("loss factor by slope", source="within 50 % or 2 sd (rule: Booij, Thoone 1982)")
def stiffness_causal(implied: float, measured: float, *, error: float, peak: float) -> Finding:
    """Stiffness and loss are causally related, as far as the errors can show."""
    agrees = abs(implied - measured) <= max(CAUSAL_LIMIT * measured, 2 * error) and measured > 0
    return Finding(
        f"At {peak:.4g} Hz the loss factor is {measured:.3g}. The slope of the stiffness gives "
        f"{implied:.3g} ± {error:.2g} (local Kramers-Kronig rule)",
        implied,
        "Mass, gain or phase of the channels is wrong, or another mode is near",
        "Check the mass, and the calibration of both channels.",
        limit=measured,
        always_fails=not agrees,
    )
