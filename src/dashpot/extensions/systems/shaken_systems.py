"""Response of a mass on seals, and of a multibody system, to a given base spectrum."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from dashpot.datamodel.bounds import FRFBounds
from dashpot.datamodel.random_response import RandomResponse
from dashpot.extensions.systems.base_response import random_base, random_limits, random_response
from dashpot.extensions.systems.multibody import Point, System, Vector
from dashpot.extensions.systems.read_psd import read_psd
from dashpot.workflow.frf_prediction import MountedMass, ShakenMass


def shake_mass(
    mounted_mass: MountedMass, psd: str, compute_bounds: Callable[..., FRFBounds] | None
) -> ShakenMass:
    """Return the response of a mass on seals to a random base, with its upper limit.

    Parameters
    ----------
    mounted_mass : MountedMass
    psd : str
        A file, or a word such as ``"0.01g^2/Hz"``.
    compute_bounds : callable or None
        What bounds the FRF by the relaxation tests.
    """
    base = read_psd(psd)
    f, mass, coupled = (
        base.frequency,
        mounted_mass.mass_on_seals.mass,
        mounted_mass.mass_on_seals.coupled,
    )
    options: dict[str, Any] = {"psd": base.density, "frequency": f, "coupled": coupled}
    response, limits = random_base(mounted_mass.solid, mass=mass, **options), None
    if compute_bounds is not None:
        limits = random_limits(
            mounted_mass.solid,
            lambda at, kind: compute_bounds(frequency=at, kind=kind).unmeasured,
            mass=mass,
            **options,
        )
    if f is None:
        return ShakenMass(response, "white noise", None, limits)
    return ShakenMass(response, base.source[0].file, (float(f[0]), float(f[-1])), limits)


def shake_system(
    psd: str, *, base: str, along: Vector
) -> Callable[[System, Point], RandomResponse]:
    """Return a function for the response of a place to ground motion along a direction.

    Parameters
    ----------
    psd : str
        A file, or a word such as ``"0.01g^2/Hz"``.
    base : str
        The ground.
    along : (float, float, float)
    """
    noise = read_psd(psd)

    def respond(system: System, position: Point) -> RandomResponse:
        return random_response(
            system,
            response=position,
            psd=noise.density,
            frequency=noise.frequency,
            base=base,
            along=along,
        )

    return respond
