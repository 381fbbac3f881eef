r"""One likelihood for relaxation tests, a hammer test, and what is known of the rig.

With r the weighted residuals of each test and a prior on each nuisance, the fit minimises

.. math::

    \chi^2 = \sum_\mathrm{tests} |W(F - F(\theta))|^2
           + \sum_\mathrm{lines} \frac{|A - A(\theta, m, g, d)|^2}{\sigma^2}
           + \frac{\ln^2(m/m_0)}{\sigma_m^2} + \frac{\ln^2 g}{\sigma_g^2} + \frac{d^2}{\sigma_d^2}
           + \dots

over :math:`\theta = (\ln k_\infty, \ln k_j, \ln\tau_j[, \ln b])`. Equalities, such as a measured
static stiffness, enter as priors too narrow to bend. Source: J. Zhang and C. M. Richards, MSSP 21
(2007), for the constraints; the joint likelihood is standard.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.fitting.identification.frf_data import FRFData
from dashpot.fitting.relaxation_data import RelaxationData
from dashpot.records.fit import Fit
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.systems.prediction import ringing_pole

# one unit of the delay parameter, s: of the order of what channels differ by
DELAY_UNIT = 1e-4
# an equality is a prior of this relative width
EXACT = 1e-6
# arms that lose this many powers of e are gone
FADED = 1e-9


@dataclass(frozen=True)
class Prior:
    """A quantity known before the fit: its value and standard deviation, 0 for exactly."""

    value: float
    sd: float = 0.0


@dataclass(frozen=True)
class NuisancePriors:
    """What is known of the rig: mass, gain of acceleration over force, and its delay.

    Attributes
    ----------
    mass : Known or None
        kg; None if nothing is known.
    gain_sd : float
        Relative; 0 if the gain is exactly one.
    delay_sd : float
        s; 0 if there is no delay.
    """

    mass: Prior | None
    gain_sd: float
    delay_sd: float


@dataclass(frozen=True)
class Constraints:
    """Equalities, or near equalities, that the solid must obey besides the tests.

    Attributes
    ----------
    static_stiffness : Known or None
        k_inf of one seal, N/m.
    natural_frequency : Known or None
        |p| / 2 pi of the mass on the seals, Hz.
    damping_ratio : Known or None
        -Re p / |p|.
    before : Fit or None
        An earlier fit of one seal whose covariance is a prior on its parameters.
    """

    static_stiffness: Prior | None = None
    natural_frequency: Prior | None = None
    damping_ratio: Prior | None = None
    before: Fit | None = None


@dataclass(frozen=True)
class Parameters:
    """A point of the parameter space, in physical terms."""

    model: GeneralizedMaxwell
    mass: float
    gain: float
    delay: float


class Problem:
    """The residuals of one number of arms, as a function of a flat parameter vector.

    The vector holds ln k_inf, ln k_j, ln tau_j, ln b if there is a dashpot, then those of ln m,
    ln g and d / 0.1 ms that are not known exactly.
    """

    def __init__(
        self,
        relaxations: tuple[RelaxationData, ...],
        frf_data: FRFData,
        priors: NuisancePriors,
        constraints: Constraints,
        *,
        arms: int,
        dashpot: bool,
        scale: float = 1.0,
    ) -> None:
        self.relaxations, self.frf_data, self.priors, self.constraints = (
            relaxations,
            frf_data,
            priors,
            constraints,
        )
        self.arms, self.dashpot = arms, dashpot
        # the standard deviation of the lines is multiplied by this
        self.scale = scale
        names = ["ln_k_inf"]
        names += [f"ln_k_{j}" for j in range(1, arms + 1)]
        names += [f"ln_tau_{j}" for j in range(1, arms + 1)]
        names += ["ln_b"] if dashpot else []
        names += [] if priors.mass is not None and priors.mass.sd == 0 else ["ln_mass"]
        names += ["ln_gain"] if priors.gain_sd > 0 else []
        names += ["delay"] if priors.delay_sd > 0 else []
        self.names = tuple(names)
        self.at = {name: i for i, name in enumerate(names)}

    # -- parameters ---------------------------------------------------------------------------

    def pack(self, point: Parameters) -> FloatArray:
        """The vector of a point."""
        model = point.model
        values = [np.log(max(model.k_inf, FADED * max(model.k_0, 1e-300)))]
        values += list(np.log(model.k)) + list(np.log(model.tau))
        values += [np.log(max(model.b, 1e-300))] if self.dashpot else []
        values += [np.log(point.mass)] if "ln_mass" in self.at else []
        values += [np.log(point.gain)] if "ln_gain" in self.at else []
        values += [point.delay / DELAY_UNIT] if "delay" in self.at else []
        return np.array(values, dtype=float)

    def unpack(self, theta: FloatArray) -> Parameters:
        """The point of a vector."""
        N = self.arms
        fixed = 1.0 if self.priors.mass is None else self.priors.mass.value
        return Parameters(
            model=GeneralizedMaxwell(
                float(np.exp(theta[0])),
                tuple(np.exp(theta[1 : 1 + N])),
                tuple(np.exp(theta[1 + N : 1 + 2 * N])),
                float(np.exp(theta[self.at["ln_b"]])) if self.dashpot else 0.0,
            ),
            mass=float(np.exp(theta[self.at["ln_mass"]])) if "ln_mass" in self.at else fixed,
            gain=float(np.exp(theta[self.at["ln_gain"]])) if "ln_gain" in self.at else 1.0,
            delay=float(theta[self.at["delay"]]) * DELAY_UNIT if "delay" in self.at else 0.0,
        )

    # -- residuals ----------------------------------------------------------------------------

    def residual(self, theta: FloatArray) -> FloatArray:
        """All weighted residuals, tests first, shape (n,)."""
        parts = [self._relaxation_rows(relaxation, theta)[0] for relaxation in self.relaxations]
        return np.concatenate([*parts, self.frf_residual(theta), self.prior_residual(theta)])

    def jacobian(self, theta: FloatArray) -> FloatArray:
        """Derivative of `residual` by the vector, shape (n, p)."""
        parts = [self._relaxation_rows(relaxation, theta)[1] for relaxation in self.relaxations]

        def rest(at: FloatArray) -> FloatArray:
            return np.concatenate((self.frf_residual(at), self.prior_residual(at)))

        return np.concatenate([*parts, _differences(rest, theta)])

    def relaxation_chi2(self, theta: FloatArray) -> list[float]:
        """Chi-square of each relaxation test, its floor included."""
        return [
            float(np.sum(self._relaxation_rows(relaxation, theta)[0] ** 2)) + relaxation.floor
            for relaxation in self.relaxations
        ]

    def _relaxation_rows(
        self, relaxation: RelaxationData, theta: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        N = self.arms
        k_inf, k = np.exp(theta[0]), np.exp(theta[1 : 1 + N])
        rows = relaxation.rows(theta[1 + N : 1 + 2 * N])
        model = k_inf * rows.spring + rows.arms @ k
        jacobian = np.zeros((len(model), len(theta)))
        jacobian[:, 0] = k_inf * rows.spring
        jacobian[:, 1 : 1 + N] = rows.arms * k
        jacobian[:, 1 + N : 1 + 2 * N] = rows.slopes * k
        if self.dashpot:
            part = np.exp(theta[self.at["ln_b"]]) * rows.dashpot
            model = model + part
            jacobian[:, self.at["ln_b"]] = part
        return model - rows.target, jacobian

    def frf_residual(self, theta: FloatArray) -> FloatArray:
        """Those of the lines, real then imaginary."""
        p = self.unpack(theta)
        return (
            self.frf_data.misfit(self.frf_data.predict(p.model, p.mass, p.gain, p.delay))
            / self.scale
        )

    def prior_residual(self, theta: FloatArray) -> FloatArray:
        """Those of everything known beforehand."""
        p, priors, constraints = self.unpack(theta), self.priors, self.constraints
        rows = []
        if priors.mass is not None and priors.mass.sd > 0:
            rows.append(np.log(p.mass / priors.mass.value) * priors.mass.value / priors.mass.sd)
        if priors.gain_sd > 0:
            rows.append(np.log(p.gain) / priors.gain_sd)
        if priors.delay_sd > 0:
            rows.append(p.delay / priors.delay_sd)
        if constraints.static_stiffness is not None:
            rows.append(_off(p.model.k_inf, constraints.static_stiffness))
        if constraints.natural_frequency is not None or constraints.damping_ratio is not None:
            pole = ringing_pole(self.frf_data.seals * p.model, p.mass)
            if constraints.natural_frequency is not None:
                rows.append(_off(abs(pole) / (2 * np.pi), constraints.natural_frequency))
            if constraints.damping_ratio is not None:
                rows.append(_off(-pole.real / abs(pole), constraints.damping_ratio))
        before = [] if constraints.before is None else [_before(constraints.before, p.model)]
        return np.concatenate([np.array(rows, dtype=float), *before])


def _off(value: float, known: Prior) -> float:
    return (value - known.value) / max(known.sd, EXACT * abs(known.value))


def _before(fit: Fit, model: GeneralizedMaxwell) -> FloatArray:
    """How far a solid's slowest arms are from an earlier fit's, in its standard deviations."""
    N = fit.model.arms
    own = {"k_inf": (model.k_inf, fit.model.k_inf)}
    # faster arms than the earlier fit has are new: it says nothing about them
    for j, (k, tau, k0, tau0) in enumerate(
        zip(model.k[-N:], model.tau[-N:], fit.model.k, fit.model.tau, strict=True), start=1
    ):
        own[f"k_{j}"] = (k, k0)
        own[f"ln_tau_{j}"] = (np.log(tau), np.log(tau0))
    rows = [i for i, name in enumerate(fit.parameters) if name in own]
    covariance = fit.covariance[np.ix_(rows, rows)]
    known = np.isfinite(np.diag(covariance)) & (np.diag(covariance) > 0)
    pick = [rows[i] for i in np.flatnonzero(known)]
    difference = np.array([np.subtract(*own[fit.parameters[i]]) for i in pick])
    root = np.linalg.cholesky(covariance[np.ix_(known, known)])
    return np.asarray(np.linalg.solve(root, difference))


def _differences(function: Callable[[FloatArray], FloatArray], theta: FloatArray) -> FloatArray:
    """Forward differences; every parameter is a logarithm or of order one."""
    step = 1e-6
    start = function(theta)
    columns = []
    for i in range(len(theta)):
        move = np.zeros(len(theta))
        move[i] = step
        columns.append((function(theta + move) - start) / step)
    return np.array(columns).T
