"""Speed of the car at which the seal of a door lifts, station by station."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.reported_values import INTERVAL_LEVELS, NORMAL
from dashpot.base.serialisation import Key, Serialisable
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.seal_line import SealSection
from dashpot.extensions.systems.door.leak_setup import LeakSetup, LeakState
from dashpot.solids.elastic import ElasticLaw

DRAWS = 2000
SEED = 1997
_MIN_SHARE = 0.02
"""Smallest drawn value, as a fraction of the mean."""


class Interval(NamedTuple):
    """Value with its 95 % limits."""

    value: float
    low: float
    high: float


class SectionState(NamedTuple):
    """Seal in one state: section of one metre, density of the air, and retained force."""

    state: LeakState
    section: SealSection
    density: float
    retained: Interval


@dataclass(frozen=True, eq=False)
class StateLeak(Serialisable):
    """Leak speeds of all stations in one state.

    Attributes
    ----------
    name : str
    force : array, shape (n,)
        Contact force of one metre, N/m.
    pressure : array, shape (n,)
        Pressure difference that lifts the seal, Pa.
    speed : array, shape (n,)
        Speed of the car at that pressure, m/s.
    limits : array, shape (2, n)
        95 % of the speed, m/s.
    density : float
        Density of the air, kg/m^3.
    retained : float
        Fraction of the force after aging.
    """

    _keys = (
        "name",
        "force",
        "pressure",
        "speed",
        "limits",
        "density",
        "retained",
        Key("first_station", "weakest"),
        Key("leak_speed", "least"),
    )

    name: str
    force: FloatArray
    pressure: FloatArray
    speed: FloatArray
    limits: FloatArray
    density: float
    retained: float

    @property
    def weakest(self) -> int:
        """The station that lifts first."""
        return int(self.speed.argmin())

    @property
    def least(self) -> Interval:
        """Speed at which the first station lifts, with its 95 % limits, m/s."""
        i = self.weakest
        low, high = self.limits[:, i].tolist()
        return Interval(float(self.speed[i]), low, high)


def compute_contact_force(
    section: SealSection, compression: FloatArray, gap: float, time: float
) -> FloatArray:
    r"""Return the force of one metre that relaxed at a compression x, after the gap widens by g.

    .. math::

        F'(t) = \left[F_e(x - g) - g\,F_e'(x) \sum_j \frac{k_j}{k_\infty} e^{-t/\tau_j}\right]_+

    The arms, which the sudden step pulls back, have not relaxed at the time t; of t = inf it is
    the elastic law alone.

    Parameters
    ----------
    section : SealSection
    compression : array
        Compression at which it relaxed, m.
    gap : float
        g, m.
    time : float
        t, s.
    """
    force = section.force(compression - gap)
    if gap > 0 and np.isfinite(time):
        solid = section.solid.maxwell
        unrelaxed = (np.array(solid.k) * np.exp(-time / np.array(solid.tau))).sum()
        force = force - gap * section.factor(compression) * unrelaxed
    return np.asarray(np.maximum(force, 0.0))


def compute_leak_speed(
    force: FloatArray,
    *,
    lip: float | FloatArray,
    density: float,
    pressure_coefficient: float | FloatArray,
) -> FloatArray:
    r"""Return the speed at which the pressure lifts a seal, m/s; the arguments broadcast.

    .. math:: \Delta p\,w = F', \qquad \Delta p = C_p\,\tfrac12\rho V^2, \qquad
        V = \sqrt{\frac{2 F'}{w\,\rho\,C_p}}

    Parameters
    ----------
    force : array
        Contact force of one metre, N/m.
    lip : float or array
        w, on which the pressure acts, m.
    density : float
        kg/m^3.
    pressure_coefficient : float or array
    """
    return np.asarray(np.sqrt(2 * force / (density * (lip * pressure_coefficient))))


def find_leak(
    case: SectionState,
    setup: LeakSetup,
    *,
    fit: Fit,
    compression: FloatArray,
    factor: FloatArray,
) -> StateLeak:
    """Return the leak speeds of stations in one state, with limits from seeded draws.

    The draws hold the relaxed stiffness as the test limits it at three times its hold, the shape
    of the elastic law, gap, force of seals, lip, pressure coefficient and aging. All
    are common to the line.

    Parameters
    ----------
    case : SectionState
    setup : LeakSetup
    fit : Fit
        Fit of the seal, at the temperature of the state.
    compression, factor : array, shape (n,)
        Compression and factor of the stations, m, and the factor of their joints.
    """
    state, section = case.state, case.section
    retained_fraction = case.retained.value
    force = (
        factor
        * retained_fraction
        * compute_contact_force(section, compression, state.gap, state.time)
    )
    speed = compute_leak_speed(
        force,
        lip=setup.lip,
        density=case.density,
        pressure_coefficient=setup.pressure_coefficient,
    )
    random = np.random.default_rng(SEED)
    z = random.standard_normal((7, DRAWS))
    drawn_gaps = setup.gap_sd * z[0]
    drawn_stiffness = _draw_split_normal(compute_relaxed_stiffness(fit), z[1])
    drawn_stiffness = drawn_stiffness * np.maximum(1 + setup.force_sd * z[2], _MIN_SHARE)
    drawn_lips = np.maximum(setup.lip + setup.lip_sd * z[3], _MIN_SHARE * setup.lip)
    drawn_coefficients = np.maximum(
        setup.pressure_coefficient + setup.pressure_coefficient_sd * z[4],
        _MIN_SHARE * setup.pressure_coefficient,
    )
    drawn_retention = np.clip(_draw_split_normal(case.retained, z[5]), 0.0, 1.0)
    laws = _draw_laws(section, z[6])
    drawn_compression = compression - drawn_gaps[:, None]
    if laws is None:
        drawn_force = compute_contact_force(section, drawn_compression, state.gap, state.time)
    else:
        drawn_force = np.array([
            compute_contact_force(law, values, state.gap, state.time)
            for law, values in zip(laws, drawn_compression, strict=True)
        ])  # fmt: skip
    drawn_force = factor * drawn_force * (drawn_stiffness * drawn_retention)[:, None]
    speeds = compute_leak_speed(
        drawn_force,
        lip=drawn_lips[:, None],
        density=case.density,
        pressure_coefficient=drawn_coefficients[:, None],
    )
    low, high = np.quantile(speeds, INTERVAL_LEVELS, axis=0)
    limits = np.array([np.minimum(low, speed), np.maximum(high, speed)])
    return StateLeak(
        state.name, force, force / setup.lip, speed, limits, case.density, retained_fraction
    )


def compute_relaxed_stiffness(fit: Fit) -> Interval:
    """Return the relaxed stiffness over that of the fit: 1, with limits at three times its hold.

    A test bounds what is left after a long time from above alone. After three times its hold it
    bounds both ends; of a fit that has no such limits they are of its standard error.
    """
    k_inf = fit.model.k_inf
    end = fit.evidence.end_of_hold
    if end is not None and k_inf > 0 and np.isfinite(end.k_3end).all():
        low, high = (stiffness_limit / k_inf for stiffness_limit in end.k_3end)
        return Interval(1.0, min(low, 1.0), max(high, 1.0))
    names = fit.estimate.parameters
    if "k_inf" not in names or not k_inf > 0:
        return Interval(1.0, 1.0, 1.0)
    k_inf_index = names.index("k_inf")
    half_width = NORMAL * float(np.sqrt(max(fit.covariance[k_inf_index, k_inf_index], 0.0))) / k_inf
    return Interval(1.0, max(1 - half_width, 0.0), 1 + half_width)


def _draw_split_normal(interval: Interval, z: FloatArray) -> FloatArray:
    """Return draws of a size with each half of its 95 % interval as wide as stated; none below 0.

    Parameters
    ----------
    interval : Interval
    z : array
        Standard normal draws.
    """
    value, low, high = interval
    half_width = np.where(z < 0, value - low, high - value)
    return np.maximum(value + z / NORMAL * half_width, 0.0)


def _draw_laws(section: SealSection, z: FloatArray) -> list[SealSection] | None:
    """Return sections with elastic laws drawn from their errors; None for a linear law."""
    law = section.law
    if law is None or not law.ratio_se or law.kind == "linear":
        return None
    laws_drawn = []
    signs = np.cos(np.pi * np.arange(len(law.knots)) / max(len(law.knots) - 1, 1))
    for item in z:
        ratio = np.maximum(np.array(law.ratio) + item * signs * np.array(law.ratio_se), 0.0)
        mean = float(np.trapezoid(ratio, law.knots)) / law.knots[-1]
        drawn_law = ElasticLaw(law.knots, tuple((ratio / mean).tolist()), law.stiffness)
        laws_drawn.append(replace(section, law=drawn_law))
    return laws_drawn
