r"""Fractional Zener solid: four parameters for a broad, smooth spectrum.

.. math:: K(s) = k_\infty + (k_0 - k_\infty) \frac{(s\tau)^\alpha}{1 + (s\tau)^\alpha}
    = \frac{k_\infty + k_0 (s\tau)^\alpha}{1 + (s\tau)^\alpha}

Its relaxation is a Mittag-Leffler function, and that an exact sum of positive arms,

.. math:: E_\alpha\bigl(-(t/\tau)^\alpha\bigr) = \int w(u)\, e^{-t/(\tau e^u)}\,du, \qquad
    w(u) = \frac{\sin\alpha\pi}{2\pi\,(\cosh\alpha u + \cos\alpha\pi)}

(K. S. Cole and R. H. Cole, *J. Chem. Phys.* 9, 1941). The trapezoidal rule of step h is off by

.. math:: \epsilon \approx e^{-D/h}, \qquad
    D = \min\Bigl(\pi^2,\; 2\pi^2\,\frac{1-\alpha}{\alpha}\Bigr)

since the integrand is analytic as far as the nearer of the kernel's edge, :math:`|\Im u| = \pi/2`,
and of the pole of w, :math:`|\Im u| = \pi (1-\alpha)/\alpha`. Towards alpha = 1 the spectrum draws
together to a single arm, and even steps as fine as its peak are a waste: Gauss nodes on panels that
double away from it then do with fewer.
"""

from __future__ import annotations

from math import cos, exp, gamma, isfinite, log, pi, sin
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import (
    ComplexArray,
    FloatArray,
    convert_numbers_to_si,
    require_increasing,
    require_same_length,
    to_complex,
    validate_samples,
)
from dashpot.base.errors import DataError
from dashpot.base.serialisation import Serialisable
from dashpot.base.value_ranges import require_positive
from dashpot.solids.maxwell import GeneralizedMaxwell, Parallel, Solid

#: tolerances of the arms that approximate a solid, by default and for the response in time
TOLERANCE, EXACT_TOLERANCE = 1e-4, 1e-11
# the error of the trapezoidal rule, over the law's exponential, at most
_ERROR_FACTOR = 10.0
# part of the weight beyond which no arm is distinguished from the last
_MIN_WEIGHT = 1e-16
# widest panel of ln tau, and what a further Gauss node gains on each
_PANEL_WIDTH, _GAIN_PER_NODE = 1.5, 4.2


class Weights(NamedTuple):
    r"""Weights of arms :math:`\tau e^u`, which sum to one, and their derivatives.

    Attributes
    ----------
    value : array, shape (n,)
    by_log_tau, by_alpha : array, shape (n,)
        Derivatives at constant relaxation times of the arms.
    """

    value: FloatArray
    by_log_tau: FloatArray
    by_alpha: FloatArray


def compute_spectrum_density(u: FloatArray, alpha: float) -> Weights:
    """Return w(u), its derivative by ln tau, which is that by -u, and by alpha."""
    s, c = sin(alpha * pi), cos(alpha * pi)
    e = np.exp(-alpha * np.abs(u))
    denominator = 1 + 2 * c * e + e * e
    value = s / pi * e / denominator
    weight = (1 - e * e) / denominator
    by_alpha = pi * c / s - np.abs(u) * weight + 2 * pi * s * e / denominator
    return Weights(value, alpha * np.sign(u) * weight * value, by_alpha * value)


def compute_arm_weights(u: FloatArray, alpha: float) -> Weights:
    r"""Return the weights of arms at even distances :math:`u = \ln(\tau_j/\tau)`.

    What lies beyond the first and the last is theirs.
    """
    h = float(u[1] - u[0])
    density = compute_spectrum_density(u, alpha)
    weights = Weights(*(h * component for component in density))
    for end in (0, -1):
        for component in weights:
            component[end] /= 2
    return _add_tail_weights(weights, u, density.value[[0, -1]], alpha)


def _add_tail_weights(
    weights: Weights, u: FloatArray, density: FloatArray, alpha: float
) -> Weights:
    """Add what lies beyond the first and the last arm to them."""
    for end, sign in ((0, -1.0), (-1, 1.0)):
        tail_weight, slope = _integrate_tail(sign * float(u[end]), alpha)
        weights.value[end] += tail_weight
        weights.by_log_tau[end] += sign * float(density[end])
        weights.by_alpha[end] += slope
    return weights


def _make_even_arms(max_distance: float, alpha: float, step: float) -> tuple[FloatArray, Weights]:
    """Arms at even distances, as far as they weigh anything."""
    count = int(np.ceil(max_distance / step))
    u = step * np.arange(-count, count + 1.0)
    return u, compute_arm_weights(u, alpha)


def _build_graded_arms(max_distance: float, alpha: float, nodes: int) -> tuple[FloatArray, Weights]:
    """Arms at Gauss nodes of panels, as narrow at the peak of w as it is."""
    edges = [0.0, pi * (1 - alpha) / alpha]
    while edges[-1] < max_distance:
        edges.append(edges[-1] + min(edges[-1], _PANEL_WIDTH))
    right_edges = np.array(edges[1:])
    cuts = np.concatenate((-right_edges[::-1], [0.0], right_edges))
    x, weight = np.polynomial.legendre.leggauss(nodes)
    half_widths = np.diff(cuts)[:, None] / 2
    u = (cuts[:-1, None] + half_widths * (1 + x)).ravel()
    scale = (half_widths * weight).ravel()
    weights = Weights(*(scale * component for component in compute_spectrum_density(u, alpha)))
    end_densities = compute_spectrum_density(cuts[[0, -1]], alpha).value
    return u, _add_tail_weights(weights, cuts[[0, -1]], end_densities, alpha)


def _select_arms(
    u: FloatArray, weights: Weights, low: float, high: float
) -> tuple[FloatArray, Weights]:
    """The arms between two ends, the first and the last with the weight of all beyond them."""
    inside_indices = np.flatnonzero((u >= low) & (u <= high))
    first, last = (
        (inside_indices[0], inside_indices[-1])
        if inside_indices.size
        else [int(np.argmin(np.abs(u - low)))] * 2
    )
    kept_indices = [0, *range(first + 1, last + 1)]
    return u[first : last + 1], Weights(
        *(np.add.reduceat(component[:], kept_indices)[: last + 1 - first] for component in weights)
    )


def _integrate_tail(u: float, alpha: float) -> tuple[float, float]:
    r"""Return :math:`\int_u^\infty w` and its derivative by alpha."""
    s, c = sin(alpha * pi), cos(alpha * pi)
    # of the other side, where the exponential could not be written
    e = exp(-alpha * abs(u))
    tail_weight = float(np.arctan2(e * s, 1 + e * c)) / (alpha * pi)
    rotated_part = (-abs(u) * e * s + pi * e * c + pi * e * e) / (1 + 2 * c * e + e * e)
    slope = -tail_weight / alpha + rotated_part / (alpha * pi)
    return (tail_weight, slope) if u >= 0 else (1 - tail_weight, -slope)


@dataclass(frozen=True)
class FractionalZener(Solid, Serialisable):
    r"""Spring in parallel with a spring and a springpot in series, and a dashpot, if given.

    .. math:: K(s) = \frac{k_\infty + k_0 (s\tau)^\alpha}{1 + (s\tau)^\alpha} + b s, \qquad
        k(t) = k_\infty + (k_0 - k_\infty)\, E_\alpha\bigl(-(t/\tau)^\alpha\bigr)

    As of every solid here, `k_inf` is the equilibrium stiffness and `k_0` the instantaneous one.
    The two may be given in either order, since one alone is passive: other books call the
    long-time stiffness k_0 and the glassy one k_inf, after the frequency. With an equilibrium
    stiffness of zero it is a fractional Maxwell solid; with alpha = 1, a Zener solid.

    Attributes
    ----------
    k_0, k_inf : float
        Stiffness at once and at rest, N/m: the larger and the smaller of the two given.
    tau : float
        Relaxation time, s, > 0.
    alpha : float
        Slope of the springpot, 0 < alpha <= 1.
    b : float
        Parallel dashpot, N s/m, >= 0.

    Source: R. L. Bagley and P. J. Torvik, *AIAA J.* 21 (1983); S. W. Park,
    *Int. J. Solids Struct.* 38 (2001).

    >>> seal = FractionalZener(200.0, 500.0, tau=0.05, alpha=0.5)
    >>> round(seal.loss_factor(frequency="12.71Hz"), 6)
    np.float64(0.133066)
    """

    schema = "dashpot/fractional@1"

    k_0: float
    k_inf: float
    tau: float
    alpha: float
    b: float = 0.0

    def __post_init__(self) -> None:
        stiffnesses = sorted((float(self.k_inf), float(self.k_0)))
        for name, value in zip(("k_inf", "k_0", "b"), (*stiffnesses, float(self.b)), strict=True):
            if not (isfinite(value) and value >= 0):
                raise DataError(f"{name} = {value!r}; a passive solid needs {name} >= 0 and finite")
        require_positive(tau=self.tau, unit=" s", expected="a relaxation time > 0")
        if not 0 < self.alpha <= 1:
            raise DataError(
                f"alpha = {self.alpha!r}; expected 0 < alpha <= 1, from a spring to a dashpot"
            )
        for name, value in zip(("k_inf", "k_0"), stiffnesses, strict=True):
            object.__setattr__(self, name, value)
        for name in ("tau", "alpha", "b"):
            object.__setattr__(self, name, float(getattr(self, name)))

    # -- algebra ------------------------------------------------------------------------------

    def __add__(self, other: object) -> Solid:
        """Return both in parallel: springs and dashpots merge, other solids remain in parallel."""
        if not isinstance(other, Solid):
            return NotImplemented
        is_spring = isinstance(other, GeneralizedMaxwell) and not other.arms
        has_same_spectrum = isinstance(other, FractionalZener) and (other.tau, other.alpha) == (
            self.tau,
            self.alpha,
        )
        if not (is_spring or has_same_spectrum):
            return Parallel((self, other))
        b: float = other.b  # type: ignore[attr-defined]  # both kinds have one
        return replace(self, k_0=self.k_0 + other.k_0, k_inf=self.k_inf + other.k_inf, b=self.b + b)

    __radd__ = __add__

    def __mul__(self, count: float) -> FractionalZener:
        """`count` equal solids in parallel; a fraction is a shorter piece of seal."""
        if not isinstance(count, int | float | np.number):
            return NotImplemented
        if not (np.isfinite(count) and count > 0):
            raise DataError(f"cannot take {count!r} solids in parallel; expected a number > 0")
        return replace(self, k_0=count * self.k_0, k_inf=count * self.k_inf, b=count * self.b)

    __rmul__ = __mul__

    # -- frequency ----------------------------------------------------------------------------

    def stiffness_at(self, s: npt.ArrayLike) -> ComplexArray:
        r"""Stiffness on the Laplace plane, N/m, `s` in 1/s, by the principal value of the power."""
        s = to_complex(s)
        power = (s * self.tau) ** self.alpha
        # of the glassy side, where the power is too large to be a number
        return np.asarray(self.k_0 - (self.k_0 - self.k_inf) / (1 + power) + self.b * s)

    # -- arms ---------------------------------------------------------------------------------

    @property
    def maxwell(self) -> GeneralizedMaxwell:
        """Arms that approximate the solid at every frequency, to 1e-4 of k_0 - k_inf."""
        return self.arms()

    def arms(
        self, tolerance: float = TOLERANCE, band: tuple[float, float] | None = None
    ) -> GeneralizedMaxwell:
        r"""Return positive arms that approximate the solid; their number is ``.arms``.

        Parameters
        ----------
        tolerance : float
            Largest error of K* and of k(t), as a part of k_0 - k_inf.
        band : (float, float), optional
            Frequencies of this accuracy, Hz; all of them by default. In time it is :math:`t =
            1/(2\pi f)`.

        The arms are even in ln tau, as dense as tolerance and alpha ask. Those that are faster
        or slower than the band can show are one arm each, so that k_inf and k_0 are kept.

        Raises
        ------
        DataError
            If the tolerance is not between 0 and 1, or the band is none.
        """
        u, weights = self._spectrum(tolerance, band)
        k, tau = (self.k_0 - self.k_inf) * weights.value, self.tau * np.exp(u)
        is_positive = k > 0
        return GeneralizedMaxwell(
            self.k_inf, tuple(k[is_positive]), tuple(tau[is_positive]), self.b
        )

    def arm_gradient(self) -> FloatArray:
        """Derivative of k_inf, every k and every ln tau of the arms by k_inf, k_0, ln tau, alpha.

        Of the arms of `maxwell`, each at a distance of the solid's tau that stays; shape
        (1 + 2 N, 4).
        """
        _, weights = self._spectrum(TOLERANCE, None)
        is_positive = (self.k_0 - self.k_inf) * weights.value > 0
        n = int(is_positive.sum())
        gradient = np.zeros((1 + 2 * n, 4))
        gradient[0, 0] = 1.0
        gradient[1 : 1 + n, 0] = -weights.value[is_positive]
        gradient[1 : 1 + n, 1] = weights.value[is_positive]
        gradient[1 : 1 + n, 3] = (self.k_0 - self.k_inf) * weights.by_alpha[is_positive]
        gradient[1 + n :, 2] = 1.0
        return gradient

    def _spectrum(
        self, tolerance: float, band: tuple[float, float] | None
    ) -> tuple[FloatArray, Weights]:
        """Distances of the arms in ln tau, and their weights."""
        if not 0 < tolerance < 1:
            raise DataError(f"tolerance = {tolerance!r}; expected a part of 1, such as 1e-4")
        if self.alpha == 1.0:
            weights = np.ones(1)
            return np.zeros(1), Weights(weights, 0 * weights, 0 * weights)
        strip = pi**2 * min(1.0, 2 * (1 - self.alpha) / self.alpha)
        step = strip / log(_ERROR_FACTOR / tolerance)
        nodes = int(np.ceil(log(_ERROR_FACTOR / tolerance) / (2 * log(_GAIN_PER_NODE))))
        # the share beyond is sin(a pi)/(a pi) e^{-a u}; tau must be a number all the same
        max_distance = min(log(1 / max(0.1 * tolerance, _MIN_WEIGHT)) / self.alpha, 300.0)
        low, high = -max_distance, max_distance
        if band is not None:
            first, last = band
            if not 0 < first <= last < np.inf:
                raise DataError(f"band = {band!r} Hz; expected two frequencies > 0, in order")
            # a faster arm is a dashpot, a slower one a spring
            margin = log(10 / tolerance)
            low = max(low, -log(2 * pi * last * self.tau) - margin)
            high = min(high, -log(2 * pi * first * self.tau) + margin)
        if step < _PANEL_WIDTH / nodes:
            all_arms = _build_graded_arms(max_distance, self.alpha, nodes)
        else:
            all_arms = _make_even_arms(max_distance, self.alpha, step)
        return _select_arms(*all_arms, low, high)

    # -- time ---------------------------------------------------------------------------------

    def relaxation(self, t: npt.ArrayLike) -> FloatArray:
        r"""Relaxation stiffness :math:`k_\infty + (k_0-k_\infty) E_\alpha(-(t/\tau)^\alpha)`, N/m.

        The parallel dashpot's impulse at t = 0 is not in it.
        """
        t = convert_numbers_to_si("t", t, "time")
        return self._select_time_arms(t).relaxation(t)

    def creep(self, t: npt.ArrayLike) -> FloatArray:
        r"""Creep compliance, m/N, for t > 0 in s: the displacement under a unit step of force.

        .. math:: D(t) = \frac{1}{k_\infty} - \Bigl(\frac{1}{k_\infty} - \frac{1}{k_0}\Bigr)
            E_\alpha\bigl(-(t/\lambda)^\alpha\bigr), \qquad
            \lambda = \tau (k_0/k_\infty)^{1/\alpha}

        and :math:`\bigl(1 + (t/\tau)^\alpha/\Gamma(1+\alpha)\bigr)/k_0` without equilibrium
        stiffness. With a parallel dashpot it is that of the arms.
        """
        t = convert_numbers_to_si("t", t, "time")
        if self.b > 0:
            return self._select_time_arms(t).creep(t)
        if self.k_0 == 0:
            raise DataError("a solid without stiffness creeps without end")
        if self.k_inf == 0:
            return np.asarray((1 + (t / self.tau) ** self.alpha / gamma(1 + self.alpha)) / self.k_0)
        slow_tau = self.tau * (self.k_0 / self.k_inf) ** (1 / self.alpha)
        compliance_part = FractionalZener(1 / self.k_inf - 1 / self.k_0, 0.0, slow_tau, self.alpha)
        return np.asarray(1 / self.k_inf - compliance_part.relaxation(t))

    def ramp_hold_force(self, t: npt.ArrayLike, *, depth: float, ramp_time: float) -> FloatArray:
        """Force, N, under a ramp of `ramp_time` s to `depth` m that is then held."""
        t = convert_numbers_to_si("t", t, "time")
        return self._select_time_arms(t).ramp_hold_force(t, depth=depth, ramp_time=ramp_time)

    def force(self, t: npt.ArrayLike, displacement: npt.ArrayLike) -> FloatArray:
        """Force, N, under a displacement history, m, that is straight between its samples."""
        time = require_increasing("t", validate_samples("t", t))
        x = validate_samples("displacement", displacement)
        require_same_length(t=time, displacement=x)
        if len(time) < 2:
            return self.maxwell.force(time, x)
        span, step = float(time[-1] - time[0]), float(np.diff(time).min())
        return self._select_arms_between(step, span).force(time, x)

    def _select_time_arms(self, t: FloatArray) -> GeneralizedMaxwell:
        """Arms for an answer in time that is exact to rounding."""
        requested = t[np.isfinite(t) & (t > 0)]
        if not requested.size:
            return self.maxwell
        return self._select_arms_between(float(requested.min()), float(requested.max()))

    def _select_arms_between(self, first: float, last: float) -> GeneralizedMaxwell:
        return self.arms(EXACT_TOLERANCE, (1 / (2 * pi * last), 1 / (2 * pi * first)))
