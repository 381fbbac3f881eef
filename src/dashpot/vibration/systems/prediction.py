"""A mass on a viscoelastic solid: the predicted FRF."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import samples
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.records.frf import FRF, Kind
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.checks import seal_mass_negligible


def predict_frf(
    model: GeneralizedMaxwell,
    *,
    mass: float,
    frequency: npt.ArrayLike,
    kind: Kind | str = Kind.ACCELERANCE,
    shift: float = 0.0,
) -> FRF:
    r"""FRF of a rigid mass on a solid that is fixed to ground (paper eqs. 6 and 7).

    .. math:: \frac{X}{F}(s) = \frac{1}{m s^2 + K(s)}, \qquad T(j\omega) = \frac{-\omega^2 X}{F}

    Eq. (7) prints a magnitude with a factor :math:`-\omega^2`; the sign belongs to the complex
    accelerance, which is what is returned, phase included.

    Parameters
    ----------
    model : GeneralizedMaxwell
        All the seals together: two equal seals are ``2 * model``.
    mass : float
        kg.
    frequency : array_like, shape (n,)
        Hz.
    kind : Kind or str
    shift : float
        Decay of an exponential window, 1/s: evaluates at :math:`s = j\omega + a`.

    Raises
    ------
    DataError
        If the mass or a frequency cannot be, or the response is infinite at a line.
    """
    if not (np.isfinite(mass) and mass > 0):
        raise DataError(f"mass = {mass!r} kg; expected a number > 0")
    f = samples("frequency", frequency)
    s = 2j * np.pi * f + shift
    with np.errstate(divide="ignore", invalid="ignore"):
        receptance = 1 / (mass * s**2 + model.stiffness_at(s))
    if not np.isfinite(receptance).all():
        i = int(np.flatnonzero(~np.isfinite(receptance))[0])
        raise DataError(
            f"the response at {f[i]:g} Hz is infinite: the solid has no stiffness there"
        )
    kind = Kind(kind)
    value = {
        Kind.RECEPTANCE: lambda: receptance,
        Kind.MOBILITY: lambda: s * receptance,
        Kind.ACCELERANCE: lambda: s**2 * receptance,
        Kind.DYNAMIC_STIFFNESS: lambda: 1 / receptance,
    }[kind]()
    return FRF(frequency=f, value=value, kind=kind, shift=shift)


def moving_mass(block: float, *, seal: float, seals: float = 1.0) -> tuple[float, Check]:
    r"""Mass that moves when a block rests on seals that have a mass of their own.

    .. math:: m = m_{\mathrm{block}} + n\,m_{\mathrm{seal}} / 3

    A third of a spring's mass moves with its free end (Rayleigh), as long as no wave runs within
    the seal. The paper neglects it.

    Parameters
    ----------
    block, seal : float
        Mass of the block and of the compressed part of one seal, kg.
    seals : float
        How many carry the block.

    Returns
    -------
    mass : float
        kg.
    check : Check
        ``seal_mass_negligible``: whether all seals weigh less than 2 % of the block.
    """
    for name, value, least in (("block", block, "> 0"), ("seal", seal, ">= 0")):
        if not (np.isfinite(value) and (value > 0 or (value == 0 and name == "seal"))):
            raise DataError(f"{name} mass = {value!r} kg; expected a number {least}")
    return block + seals * seal / 3, seal_mass_negligible(seals * seal / block)
