"""Elastic law of a seal, and agreement with a compression curve."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import (
    FloatArray,
    require_increasing,
    require_same_length,
    to_float,
    validate_samples,
)
from dashpot.base.errors import DataError
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import format_quantity

# Elastic law: equilibrium force against compression.
#
# .. math:: k_\mathrm{sec}(x) = F_e(x)/x, \qquad k_\mathrm{tan}(x) = F_e'(x)
#
# A hold at one depth gives one secant stiffness; vibration about a preload feels the tangent.


# Largest relative deviations of tangent and path from the secant of a weakly nonlinear law.
GENTLE_TOLERANCE, STRAIGHT_TOLERANCE = 0.10, 0.025
# and even, if its path leaves it by no more than this part of its tangent's, and this more
EVENNESS_TOLERANCE, PATH_TOLERANCE = 0.30, 0.004


@dataclass(frozen=True)
class ElasticLaw(Serialisable):
    r"""Elastic law: relaxed force against compression, its tangent linear between knots.

    .. math:: F_e(x) = k \int_0^x t(u)\,du, \qquad \frac1h \int_0^h t(u)\,du = 1

    with h the deepest knot: k is the secant stiffness there. Below the first and above the last
    knot the tangent is constant. A solid whose arms all answer :math:`F_e(x(t))` (Fung) vibrates
    about a compression x with :math:`t(x)` times its stiffnesses.

    Attributes
    ----------
    knots : tuple of float
        Compressions, m, rising from 0; the last is the depth tested. One of 0 and one at the
        depth is the linear law.
    ratio : tuple of float
        :math:`t` at the knots, >= 0.
    stiffness : float
        Relaxed secant stiffness k at the last knot, N/m.
    ratio_se : tuple of float
        Standard error of :math:`t` at the knots; empty if not known.
    """

    _keys = ("kind", "knots", Key("tangent", "tangents"), "ratio", "ratio_se", "stiffness")

    knots: tuple[float, ...]
    ratio: tuple[float, ...]
    stiffness: float
    ratio_se: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        knots = require_increasing("knots", validate_samples("knots", self.knots, minimum=2))
        ratio = validate_samples("ratio", self.ratio)
        require_same_length(knots=knots, ratio=ratio)
        if self.ratio_se:
            require_same_length(knots=knots, ratio_se=validate_samples("ratio_se", self.ratio_se))
        mean = float(np.trapezoid(ratio, knots)) / knots[-1]
        if knots[0] != 0 or (ratio < 0).any() or abs(mean - 1) > 1e-6:
            raise DataError(
                f"an elastic law begins at 0 m and its ratio is >= 0 with a mean of 1; found a "
                f"first knot of {knots[0]:g} m, a least ratio of {ratio.min():g}, a mean of "
                f"{mean:.7g}"
            )

    @classmethod
    def linear(cls, stiffness: float, depth: float) -> ElasticLaw:
        """Return the law of a spring, N/m, tested to a depth, m."""
        return cls((0.0, float(depth)), (1.0, 1.0), float(stiffness))

    @property
    def kind(self) -> str:
        """``"linear"`` or ``"piecewise"``."""
        return "linear" if all(value == 1.0 for value in self.ratio) else "piecewise"

    @property
    def depth(self) -> float:
        """The deepest compression tested, m."""
        return self.knots[-1]

    def force(self, x: npt.ArrayLike) -> FloatArray:
        """Relaxed force, N, at compressions x, m."""
        return self.stiffness * self.path(x)

    def path(self, x: npt.ArrayLike) -> FloatArray:
        """The compression of a linear seal with the same force, m: the force over `stiffness`."""
        x = to_float(x)
        knots, ratio, bends, force_at_knots = self._intervals
        clipped = np.minimum(np.maximum(x, 0.0), knots[-1])
        i = knots[1:-1].searchsorted(clipped, side="right")
        step = clipped - knots[i]
        force_inside = force_at_knots[i] + step * (ratio[i] + bends[i] * step)
        extension = np.where(x < 0.0, ratio[0], ratio[-1]) * (x - clipped)
        return np.asarray(force_inside + extension)

    @cached_property
    def _intervals(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Knots and t there, half the slope of t from each to the next, and the path at each."""
        knots, ratio = np.asarray(self.knots), np.asarray(self.ratio)
        widths = np.diff(knots)
        force_at_knots = np.concatenate(([0.0], np.cumsum(widths * (ratio[1:] + ratio[:-1]) / 2)))
        return knots, ratio, 0.5 * np.diff(ratio) / widths, force_at_knots

    def secant(self, x: npt.ArrayLike) -> FloatArray:
        """Secant stiffness F_e/x, N/m; at x = 0 its limit."""
        x = to_float(x)
        safe = np.where(x == 0, 1.0, x)
        return np.where(x == 0, self.tangent(0.0), self.force(x) / safe)

    def tangent(self, x: npt.ArrayLike) -> FloatArray:
        """Tangent stiffness dF_e/dx, N/m."""
        return self.stiffness * self.factor(x)

    @property
    def tangents(self) -> FloatArray:
        """Tangent stiffness at the knots, N/m."""
        return self.tangent(self.knots)

    def factor(self, x: npt.ArrayLike) -> FloatArray:
        """Tangent stiffness over `stiffness`: what small vibration about x does to every arm."""
        return np.asarray(np.interp(to_float(x), self.knots, self.ratio))

    @property
    def is_gentle(self) -> bool:
        r"""Whether it bends little and evenly: its tangent at the depth is the secant within 10 %.

        A quadratic law with the tangent 1 + a at its depth departs from its secant by a/4 at most;
        friction and a toe depart by more of their tangent.
        """
        u = np.linspace(0.0, 1.0, 41)
        force_at_depth = float(self.path(self.depth))
        largest_deviation = float(np.max(np.abs(self.path(u * self.depth) / force_at_depth - u)))
        deviation = abs(float(self.factor(self.depth)) - 1)
        return deviation <= GENTLE_TOLERANCE and largest_deviation <= min(
            STRAIGHT_TOLERANCE, EVENNESS_TOLERANCE * deviation + PATH_TOLERANCE
        )

    def factor_se(self, x: npt.ArrayLike) -> FloatArray:
        """Standard error of `factor`, at most: errors of neighbouring knots taken as one; or 0."""
        x = to_float(x)
        return np.asarray(np.interp(x, self.knots, self.ratio_se or np.zeros(len(self.knots))))

    def compression(self, force: float) -> float:
        r"""Return compression under a relaxed force, N: the x of :math:`F_e(x) = F`.

        Raises
        ------
        DataError
            If no compression carries the force.
        """
        target = force / self.stiffness if self.stiffness > 0 else np.inf
        max_force, last_slope = float(self.path(self.depth)), self.ratio[-1]
        if not 0 <= target < np.inf or (target > max_force and last_slope <= 0):
            raise DataError(
                f"no compression carries {force:.4g} N: at {format_quantity(self.depth, 'mm')} the "
                f"relaxed force is {self.stiffness * max_force:.4g} N, its tangent "
                f"{self.stiffness * last_slope:.4g} N/m"
            )
        if target > max_force:
            return self.depth + (target - max_force) / last_slope
        force_at_knots = self.path(self.knots)
        i = max(int(np.searchsorted(force_at_knots, target)) - 1, 0)
        remaining_force, first_slope = target - float(force_at_knots[i]), self.ratio[i]
        curvature = 2 * (self.ratio[i + 1] - first_slope) / (self.knots[i + 1] - self.knots[i])
        # the smaller root of slope * step + bend / 4 * step**2 = force, without cancellation
        root = first_slope + float(np.sqrt(max(first_slope**2 + curvature * remaining_force, 0.0)))
        return self.knots[i] + (2 * remaining_force / root if root > 0 else 0.0)

    def rests(self, force: float) -> tuple[float, ...]:
        """Every compression under a relaxed force, N; one, for the law rises. See `compression`."""
        return (self.compression(force),)

    def __mul__(self, count: float) -> ElasticLaw:
        """Return the law of `count` seals in parallel."""
        return replace(self, stiffness=count * self.stiffness)

    __rmul__ = __mul__


# Plausible compression of a seal.


MAX_EXTRAPOLATION = 3.0
"""Times the depth tested, at most."""


def require_plausible_compression(
    compression: float,
    law: ElasticLaw | None,
    height: float | None,
    *,
    carried: float | None = None,
) -> None:
    """Refuse an impossible compression, m: more than its height, or far from any test.

    Parameters
    ----------
    compression : float
        m; infinite if no compression carries the weight, which is allowed here.
    law : ElasticLaw, optional
        Elastic law of the seal, with the depth that was tested.
    height : float, optional
        Height of the seal, m.
    carried : float, optional
        The mass, kg, that presses each seal; None where the compression was given.

    Raises
    ------
    DataError
    """
    if not math.isfinite(compression):
        return
    if height is not None and compression >= height:
        name = f"it is {format_quantity(height, 'mm')} high"
    elif law is not None and compression > MAX_EXTRAPOLATION * law.depth:
        name = f"it was tested to {format_quantity(law.depth, 'mm', '.3g')}"
    else:
        return
    subject, requested = "the compression given presses", "check its unit"
    if carried is not None:
        subject = f"a mass of {carried:.4g} kg on each presses"
        requested = "check the mass and its unit (is it g?), and the number of seals"
    raise DataError(
        f"{subject} the seal by {format_quantity(compression, 'mm')}, but {name}: {requested}"
    )
