r"""Friction elements: Coulomb, Jenkins, Iwan, Berg, and Kraus's law of the Payne effect.

Sources: P. Gaillard and R. Singh, Applied Acoustics 60 (2000) 37 (Coulomb, Jenkins); W. D. Iwan,
J. Appl. Mech. 33 (1966) 893; M. Berg, Vehicle System Dynamics 30 (1998) 197; G. Kraus, J. Appl.
Polym. Sci. Symp. 39 (1984) 75. A rotary element is the same value in N m, N m/rad and rad.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.solids.jenkins import Jenkins, Masing, jenkins_reduction
from dashpot.solids.rate_independent import (
    AmplitudeDependent,
    InParallel,
    RateIndependent,
    amplitudes,
    require_positive_parameters,
)

__all__ = ["Berg", "Coulomb", "Iwan", "Jenkins", "Kraus", "RelativeToAmplitude", "jenkins_like"]

_ZERO_AMPLITUDE = 1e-30
"""m."""


@dataclass(frozen=True)
class Coulomb(RateIndependent):
    r"""Dry slider: :math:`N = 4j F_c / (\pi X)`.

    Attributes
    ----------
    slip : float
        F_c, N, > 0.
    """

    slip: float

    def __post_init__(self) -> None:
        require_positive_parameters(self, "slip")

    def unloading(self, x: FloatArray, amplitude: FloatArray) -> FloatArray:
        """Return the slider's force against the motion, N."""
        return np.full(np.broadcast(x, amplitude).shape, -self.slip)

    def stiffness(self, amplitude: npt.ArrayLike) -> ComplexArray:
        """Equivalent stiffness, N/m, in closed form."""
        return np.asarray(4j * self.slip / (np.pi * amplitudes(amplitude)))

    def start(self) -> tuple[float, float]:
        """Return displacement and force."""
        return (0.0, 0.0)

    def step(self, state: tuple[float, float], x: float) -> tuple[float, tuple[float, float]]:
        """Force, N; constant without motion."""
        force = state[1] if x == state[0] else float(np.copysign(self.slip, x - state[0]))
        return force, (x, force)

    def __mul__(self, count: float) -> Coulomb:
        """`count` in parallel."""
        return Coulomb(count * self.slip)


@dataclass(frozen=True)
class Iwan(Masing):
    r"""Jenkins elements of uniformly distributed yield displacements up to 2 F_u / k.

    .. math:: g(x) = k x - \frac{k^2 x^2}{4 F_u}, \quad x \le \frac{2 F_u}{k}; \qquad
        N = k\left(1 - \frac{k X}{4 F_u}\right) + j \frac{k^2 X}{3 \pi F_u}

    Attributes
    ----------
    k : float
        Stiffness before anything slips, N/m, > 0.
    slip : float
        Force F_u at which all slip, N, > 0.
    """

    k: float
    slip: float

    def __post_init__(self) -> None:
        require_positive_parameters(self, "k", "slip")

    def backbone(self, x: npt.ArrayLike) -> FloatArray:
        """Force, N, of the first loading."""
        x = np.minimum(x, 2 * self.slip / self.k)
        return np.asarray(self.k * x - (self.k * x) ** 2 / (4 * self.slip))

    def stiffness(self, amplitude: npt.ArrayLike) -> ComplexArray:
        """Equivalent stiffness, N/m, in closed form, also beyond 2 F_u / k."""
        largest_yield_ratio = (
            2 * self.slip / self.k / amplitudes(amplitude)
        )  # the largest yield over X
        r = np.minimum(largest_yield_ratio, 1.0)
        theta = np.arccos(1 - 2 * r)
        slip_part = (np.sin(theta) - theta * np.cos(theta) - np.sin(theta) ** 3 / 3) / (2 * np.pi)
        loss = 4 / np.pi * (r**2 / 2 - r**3 / 3)
        return np.asarray(
            self.k / largest_yield_ratio * (slip_part + (largest_yield_ratio - r) + 1j * loss)
        )

    def __mul__(self, count: float) -> Iwan:
        """`count` in parallel."""
        return replace(self, k=count * self.k, slip=count * self.slip)


@dataclass(frozen=True)
class Berg(RateIndependent):
    r"""Berg's smooth friction: from each turning point towards the limit force.

    .. math:: F = F_r + \frac{x - x_r}{x_2 (1 - \mu) + (x - x_r)} (F_{max} - F_r), \quad
        \mu = F_r / F_{max} \quad (x \text{ rising})

    Attributes
    ----------
    limit : float
        Largest friction force F_max, N, > 0.
    half_way : float
        x_2, m, > 0: where half of F_max is reached from rest.
    """

    limit: float
    half_way: float

    def __post_init__(self) -> None:
        require_positive_parameters(self, "limit", "half_way")

    def _compute_force_from(self, turning_point: Any, distance: Any, direction: Any) -> Any:
        """Return the force at `distance` >= 0 from a turning point, in `direction` +1 or -1."""
        mu = direction * turning_point / self.limit
        return turning_point + distance / (self.half_way * (1 - mu) + distance) * (
            direction * self.limit - turning_point
        )

    def unloading(self, x: FloatArray, amplitude: FloatArray) -> FloatArray:
        """Force, N, on the branch of the steady loop, whose tip force is in closed form."""
        X, h = np.asarray(amplitude), self.half_way
        tip = self.limit / (2 * h) * (np.sqrt(h**2 + X**2 + 6 * h * X) - h - X)
        return np.asarray(self._compute_force_from(tip, X - x, -1))

    def start(self) -> tuple[float, float, float, float]:
        """Last turning point (m, N), then the present place (m, N)."""
        return (0.0, 0.0, 0.0, 0.0)

    def step(
        self, state: tuple[float, float, float, float], x: float
    ) -> tuple[float, tuple[float, float, float, float]]:
        """Force, N; only the last turning point is remembered."""
        x_r, f_r, position, force = state
        if x == position:
            return force, state
        up = 1 if x > position else -1
        if up * (position - x_r) < 0:
            x_r, f_r = position, force
        force = float(self._compute_force_from(f_r, abs(x - x_r), up))
        return force, (x_r, f_r, x, force)

    def __mul__(self, count: float) -> Berg:
        """`count` in parallel."""
        return replace(self, limit=count * self.limit)


@dataclass(frozen=True)
class Kraus(RateIndependent):
    r"""Kraus's law of the Payne effect, as a strain sweep shows it.

    .. math:: N = \frac{k}{1 + u^{2m}} + j k'' \frac{2 u^m}{1 + u^{2m}}, \quad u = X / X_c

    Attributes
    ----------
    k : float
        Stiffness that is lost with amplitude, N/m, > 0.
    half_way : float
        X_c, m, > 0: where half of it is lost and the loss is largest.
    exponent : float
        m, 0 < m < 1.
    loss : float or None
        k'', N/m, >= 0; None ties it to the rest by the rule of broad friction, k'' = m k / pi.
    """

    k: float
    half_way: float
    exponent: float = 0.5
    loss: float | None = None

    def __post_init__(self) -> None:
        require_positive_parameters(self, "k", "half_way", "exponent")
        if self.exponent >= 1 or (self.loss is not None and not 0 <= self.loss < np.inf):
            raise DataError(
                f"Kraus's law with m = {self.exponent:g}, loss = {self.loss}; expected 0 < m < 1 "
                "and a finite loss >= 0, or None"
            )

    @property
    def greatest_loss(self) -> float:
        """k'', N/m, given or tied."""
        return self.exponent * self.k / np.pi if self.loss is None else self.loss

    def stiffness(self, amplitude: npt.ArrayLike) -> ComplexArray:
        """Equivalent stiffness, N/m."""
        u = (amplitudes(amplitude) / self.half_way) ** self.exponent
        return np.asarray((self.k + 2j * self.greatest_loss * u) / (1 + u**2))

    def unloading(self, x: FloatArray, amplitude: FloatArray) -> FloatArray:
        """Return the ellipse of the equivalent stiffness, N: the law knows no other loop."""
        N = self.stiffness(amplitude)
        velocity = np.sqrt(np.maximum(np.asarray(amplitude) ** 2 - np.asarray(x) ** 2, 0.0))
        return np.asarray(N.real * x - N.imag * velocity)

    def start(self) -> Any:
        """Refused: a law of amplitudes has no path.

        Raises
        ------
        DataError
        """
        raise DataError(
            "Kraus's law gives stiffness and loss at an amplitude and has no force along a path; "
            "take Jenkins elements that lose as much stiffness: friction.jenkins_like"
        )

    def step(self, state: Any, x: float) -> tuple[float, Any]:  # noqa: ARG002
        """Refused, as :meth:`start`."""
        return self.start()  # type: ignore[no-any-return]  # it raises

    def __mul__(self, count: float) -> Kraus:
        """`count` in parallel."""
        loss = None if self.loss is None else count * self.loss
        return replace(self, k=count * self.k, loss=loss)


def jenkins_like(
    element: RateIndependent, *, largest_amplitude: float, per_decade: int = 10
) -> InParallel:
    """Jenkins elements that lose stiffness with amplitude as another element does.

    Their loss follows from what they lose (broad friction), not from the element's own.

    Parameters
    ----------
    element : RateIndependent
        Its storage must fall with amplitude, as friction's does.
    largest_amplitude : float
        Largest amplitude they are for, m; they cover three decades below it.
    per_decade : int
        Yield displacements in a decade.
    """
    from scipy.optimize import nnls  # costs an import that few need

    grid = np.geomspace(largest_amplitude / 1e3, largest_amplitude, 3 * per_decade + 1)
    # what slips beyond the largest amplitude is a spring there
    yield_displacements = np.append(grid, 1e3 * largest_amplitude)
    share = jenkins_reduction(grid[:, None], yield_displacements).real
    k, _ = nnls(share, element.stiffness(grid).real)
    return InParallel(
        tuple(
            Jenkins(float(value), float(value * yield_displacement))
            for value, yield_displacement in zip(k, yield_displacements, strict=True)
            if value > 1e-9 * k.sum()
        )
    )


@dataclass(frozen=True)
class RelativeToAmplitude(AmplitudeDependent):
    r"""Change of an element since an amplitude: :math:`N(X) - N(X_0)`.

    Beside a solid that was measured at X_0 with the element in it, it gives the solid and the
    element at X.
    """

    element: AmplitudeDependent
    amplitude: float

    def equivalent(self, omega: npt.ArrayLike, amplitude: npt.ArrayLike) -> ComplexArray:
        """Change of the equivalent stiffness, N/m."""
        values = self.element.equivalent(omega, max(self.amplitude, _ZERO_AMPLITUDE))
        return self.element.equivalent(omega, amplitude) - values

    def start(self) -> Any:
        """Refused: a change of stiffness has no path.

        Raises
        ------
        DataError
        """
        raise DataError("a change since an amplitude has no force along a path; take the element")

    def advance(self, state: Any, dt: float, x: float) -> tuple[float, Any]:  # noqa: ARG002
        """Refused, as :meth:`start`."""
        return self.start()  # type: ignore[no-any-return]  # it raises

    def __mul__(self, count: float) -> RelativeToAmplitude:
        """`count` in parallel."""
        return replace(self, element=self.element * count)
