"""What mounts that weigh something, and a sensor between both ends, do to a transmissibility."""

from __future__ import annotations

from dataclasses import replace

from dashpot.base.errors import DataError
from dashpot.base.provenance import Step
from dashpot.datamodel.frf import FRF, Kind


def compute_coupled_mass(seal: float | None, seals: float) -> float:
    r"""Mass of the mounts that couples the mass to its base, kg: a sixth of theirs.

    The consistent mass matrix of a rod, of mass :math:`m_r`, is :math:`m_r/6\,(2\;1;\,1\;2)`: a
    third moves with either end, and a sixth between them.
    """
    return 0.0 if seal is None else seals * seal / 6


def on_heavy_mounts(frf: FRF, *, mass: float, coupled: float) -> FRF:
    r"""The transmissibility to a mass, as mounts that weigh something make of it.

    .. math:: K + \omega^2\mu = T\,(K - \omega^2 M), \qquad T - 1 = (T_0 - 1)\,(1 + \mu / M)

    with T_0 that of mounts without mass under the moving mass M, and :math:`\mu` the mass that
    couples it to the base (:func:`compute_coupled_mass`). Good to the second resonance of the
    mounts: within 0.2 % of K up to twice the natural frequency where they weigh a tenth of the
    mass.

    Parameters
    ----------
    frf : FRF
        A transmissibility, or a relative one.
    mass, coupled : float
        M, a third of the mounts included, and :math:`\mu`, kg.
    """
    return _scale_relative_motion(frf, 1 + coupled / mass)


def on_light_mounts(frf: FRF, *, mass: float, coupled: float) -> FRF:
    """A measured transmissibility as mounts without mass would show it: the other way round."""
    if coupled == 0:
        return frf
    step = Step("on_light_mounts", (("mass", f"{mass!r} kg"), ("coupled", f"{coupled!r} kg")))
    motion = _scale_relative_motion(frf, 1 / (1 + coupled / mass))
    return replace(motion, steps=(*frf.steps, step))


def _scale_relative_motion(frf: FRF, factor: float) -> FRF:
    """The motion relative to the base, so many times, as the kind that it was."""
    if not frf.quantity.over_base:
        raise DataError(f"the FRF is a {frf.quantity}; expected a transmissibility")
    relative = frf.to(Kind.RELATIVE_TRANSMISSIBILITY)
    sd = None if relative.sd is None else factor * relative.sd
    return replace(relative, value=factor * relative.value, sd=sd).to(frf.quantity)


def as_relative(frf: FRF) -> FRF:
    """The same numbers, of a sensor on both ends: mass less base, over the base."""
    step = Step("as_relative", (), "the motion of the mass was measured relative to the base")
    return replace(frf, quantity=Kind.RELATIVE_TRANSMISSIBILITY, steps=(*frf.steps, step))
