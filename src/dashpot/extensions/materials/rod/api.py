"""Public Python functions for a rod under a mass."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from dashpot.api.fit import Arms, frf_of, shape_words
from dashpot.base.errors import FitError
from dashpot.base.option_fields import FamilyOption
from dashpot.base.units import Quantity, Range, convert_to_si, si_range
from dashpot.datamodel.fit import Fit
from dashpot.extensions.materials.options import RodChoices
from dashpot.solids.part_geometry import Block, Disc
from dashpot.workflow.job import HammerChoices


def fit_rod(
    records: list[Any],
    *,
    mass: Quantity,
    density: Quantity | None = None,
    shape: str | Disc | Block | None = None,
    arms: Arms = "auto",
    model: FamilyOption = "maxwell",
    band: Range | None = None,
    lubricated: bool = False,
    mass_sd: Quantity | None = None,
    poisson: float | None = None,
    hammer: HammerChoices | None = None,
) -> Fit:
    """Fit a viscoelastic model to a rod under a mass."""
    from dashpot.extensions.materials.rod.fit_files import rod_under

    if density is None or shape is None:
        raise FitError(
            "a rod's density and shape turn motion into a modulus. Give both: density=1100, "
            'shape="disc:20mm,20mm"'
        )
    kilograms, hertz = convert_to_si(mass, "mass"), si_range(band, "frequency")
    if poisson is None and not isinstance(shape, str):
        value = {field.name: field.default for field in fields(shape)}.get("poisson")
        poisson = None if getattr(shape, "poisson", value) == value else shape.poisson
    rod = rod_under(
        frf_of(records, mass=kilograms, band=hertz, hammer=hammer),
        mass=kilograms,
        density=float(density),
        rod=RodChoices(**shape_words(shape), lubricated=lubricated),
        arms=arms,
        family=model,
        band=hertz,
        mass_sd=convert_to_si(mass_sd, "mass"),
        poisson=poisson,
    )
    if rod.fit is None:
        raise FitError(rod.reason)
    return rod.fit
