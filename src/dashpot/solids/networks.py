r"""Networks of springs and dashpots, reduced to their canonical Maxwell solid.

Every passive network of springs and dashpots is a generalized Maxwell solid: stiffnesses add
in parallel, compliances add in series, and partial fractions bring both back to one form.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.errors import DataError
from dashpot.solids.interconversion import (
    CreepSpectrum,
    creep_spectrum,
    merge_twins,
    relaxation_spectrum,
)
from dashpot.solids.maxwell import GeneralizedMaxwell


def spring(k: float) -> GeneralizedMaxwell:
    """Return a spring of stiffness k > 0, N/m."""
    return GeneralizedMaxwell(_positive("k", k))


def dashpot(b: float) -> GeneralizedMaxwell:
    """Return a viscous damper b > 0, N s/m."""
    return GeneralizedMaxwell(0.0, b=_positive("b", b))


def maxwell(k: float, *, tau: float | None = None, b: float | None = None) -> GeneralizedMaxwell:
    r"""Return a spring and a dashpot in series: K = k s tau / (1 + s tau), with tau or b = k tau.

    ::

        o--[ k ]--( b )--o
    """
    return GeneralizedMaxwell(0.0, (_positive("k", k),), (_relaxation_time(k, tau, b),))


def kelvin_voigt(k: float, b: float) -> GeneralizedMaxwell:
    """Return a spring and a dashpot in parallel: K = k + b s. Also called Voigt."""
    return GeneralizedMaxwell(_positive("k", k), b=_positive("b", b))


def zener(
    k_inf: float, k: float, *, tau: float | None = None, b: float | None = None
) -> GeneralizedMaxwell:
    """Return the standard linear solid: a spring k_inf beside one Maxwell arm."""
    return spring(k_inf) + maxwell(k, tau=tau, b=b)


def maxwell_voigt(k: float, b: float, *, arm_k: float, arm_b: float) -> GeneralizedMaxwell:
    """Return a Kelvin-Voigt element (k, b) beside a Maxwell arm (arm_k, arm_b).

    The model of Zhang and Richards (2006) for rubber isolators, and, in rotary units, of
    Gaillard and Singh (2000) for clutch hubs.
    """
    return kelvin_voigt(k, b) + maxwell(arm_k, b=arm_b)


def kelvin_chain(
    k_g: float | None, *, k: Sequence[float], tau: Sequence[float], b: float | None = None
) -> GeneralizedMaxwell:
    r"""Kelvin-Voigt elements in series with a spring and a dashpot.

    .. math:: D(t) = \frac{1}{k_g} + \sum_i \frac{1 - e^{-t/\tau_i}}{k_i} + \frac{t}{b}

    Parameters
    ----------
    k_g : float or None
        Stiffness of the spring in series, N/m; None leaves it out.
    k, tau : sequence of float
        Stiffness, N/m, and retardation time, s, of each Kelvin-Voigt element.
    b : float or None
        Dashpot in series, N s/m; None leaves it out.
    """
    if len(k) != len(tau):
        raise DataError(f"every Kelvin element needs a k and a tau: {len(k)} k and {len(tau)} tau")
    return from_creep(
        CreepSpectrum(
            glass=0.0 if k_g is None else 1 / _positive("k_g", k_g),
            d=tuple(1 / _positive("k", value) for value in k),
            lam=tuple(_positive("tau", value) for value in tau),
            flow=0.0 if b is None else 1 / _positive("b", b),
        )
    )


def from_creep(creep: CreepSpectrum) -> GeneralizedMaxwell:
    """Return the solid of a given creep compliance, exactly."""
    return GeneralizedMaxwell(*relaxation_spectrum(creep))


def creep_of(solid: GeneralizedMaxwell) -> CreepSpectrum:
    """Return the creep spectrum of a solid, exactly."""
    return creep_spectrum(solid.k_inf, solid.k, solid.tau, solid.b)


def parallel(*solids: GeneralizedMaxwell) -> GeneralizedMaxwell:
    """Solids in parallel: the same displacement, forces add.

    As ``a + b``, and relaxation times that only rounding parts become one arm.
    """
    if not solids:
        raise DataError("parallel() needs at least one solid")
    total = sum(solids[1:], solids[0])
    rates = 1 / np.array(total.tau, dtype=float)
    rates, k = merge_twins(rates, np.array(total.k, dtype=float))
    return GeneralizedMaxwell(total.k_inf, tuple(k.tolist()), tuple((1 / rates).tolist()), total.b)


def series(*solids: GeneralizedMaxwell) -> GeneralizedMaxwell:
    r"""Solids end to end: the same force, displacements add.

    .. math:: \frac{1}{K(s)} = \sum_i \frac{1}{K_i(s)}

    Compliances are added as creep spectra, whose partial fractions are all positive, and the sum
    is turned back: the result is passive by construction, whatever the parts.

    Raises
    ------
    DataError
        If a part has neither stiffness nor viscosity: it transmits no force.
    """
    if not solids:
        raise DataError("series() needs at least one solid")
    if len(solids) == 1:
        return solids[0]
    creep_solids = [creep_of(solid) for solid in solids]
    return from_creep(
        CreepSpectrum(
            glass=sum(creep_solid.glass for creep_solid in creep_solids),
            d=tuple(d for creep_solid in creep_solids for d in creep_solid.d),
            lam=tuple(lam for creep_solid in creep_solids for lam in creep_solid.lam),
            flow=sum(creep_solid.flow for creep_solid in creep_solids),
        )
    )


def _relaxation_time(k: float, tau: float | None, b: float | None) -> float:
    if (tau is None) == (b is None):
        raise DataError(f"a Maxwell arm needs either tau or b, found tau = {tau!r} and b = {b!r}")
    return _positive("tau", tau) if tau is not None else _positive("b", b) / k


def _positive(name: str, value: float | None) -> float:
    if value is None or not (np.isfinite(value) and value > 0):
        raise DataError(f"{name} = {value!r}; expected a finite number > 0 in SI units")
    return float(value)
