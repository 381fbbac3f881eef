r"""Masing's rules, and the Jenkins element: a spring and a Coulomb slider in series.

Source: P. Gaillard and R. Singh, Applied Acoustics 60 (2000) 37. A rotary element is the same value
in N m, N m/rad and rad.
"""

from __future__ import annotations

from abc import abstractmethod

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.solids.rate_independent import RateIndependent, amplitudes, require_positive_parameters

_Path = tuple[tuple[float, float], ...]


class Masing(RateIndependent):
    r"""An element that follows Masing's rules: a branch is its first loading, twice as large.

    .. math:: F(x) = F_r \pm 2\, g(|x - x_r| / 2)

    from the last turning point (x_r, F_r), with the first loading (backbone) g; a branch that
    closes a loop continues as if that loop had not occurred.
    """

    @abstractmethod
    def backbone(self, x: npt.ArrayLike) -> FloatArray:
        """Force, N, of the first loading, at x >= 0, m."""

    def unloading(self, x: FloatArray, amplitude: FloatArray) -> FloatArray:
        """Force, N, from the tip of the loop downwards."""
        return np.asarray(self.backbone(amplitude) - 2 * self.backbone((amplitude - x) / 2))

    def start(self) -> _Path:
        """Return the state at rest, where the first loading begins."""
        return ((0.0, 0.0), (0.0, 0.0))

    def step(self, state: _Path, x: float) -> tuple[float, _Path]:
        """Force, N, and the turning points that are not forgotten, the present place last."""
        *turns, position = state
        distance = x - position[0]
        if distance == 0:
            return position[1], state
        if _is_opposite(distance, position[0] - turns[-1][0]):
            turns.append(position)
        while len(turns) > 2 and not _is_opposite(x - turns[-2][0], distance):
            del turns[-2:]
        if len(turns) == 2 and abs(x) >= abs(turns[1][0]) and _is_opposite(x, turns[1][0]):
            del turns[1]  # past the mirror of its end the first loading goes on
        x_r, f_r = turns[-1]
        scale_factor = 1 if len(turns) == 1 else 2
        force_rise = scale_factor * float(self.backbone(abs(x - x_r) / scale_factor))
        force = f_r + float(np.copysign(force_rise, x - x_r))
        return force, (*turns, (x, force))


def _is_opposite(first: float, second: float) -> bool:
    """Whether two motions go opposite ways; their product may be too small to have a sign."""
    return first < 0 < second or second < 0 < first


@dataclass(frozen=True)
class Jenkins(Masing):
    r"""A spring and a Coulomb slider in series: elastic up to its yield displacement, then slips.

    .. math:: N = k \left[\frac{\theta - \tfrac12 \sin 2\theta}{\pi}
        + j \frac4\pi \frac{x_y}{X}\left(1 - \frac{x_y}{X}\right)\right], \quad
        \cos\theta = 1 - \frac{2 x_y}{X}, \quad x_y = \frac{F_c}{k}

    and N = k while X does not exceed x_y.

    Attributes
    ----------
    k : float
        N/m, > 0 (N m/rad for a rotary element, whose amplitudes are in rad).
    slip : float
        Force F_c at which it slips, N, > 0.
    """

    k: float
    slip: float

    def __post_init__(self) -> None:
        require_positive_parameters(self, "k", "slip")

    @property
    def yields_at(self) -> float:
        """Yield displacement x_y = F_c / k, m."""
        return self.slip / self.k

    def backbone(self, x: npt.ArrayLike) -> FloatArray:
        """Force, N, of the first loading."""
        return np.minimum(self.k * np.asarray(x), self.slip)

    def stiffness(self, amplitude: npt.ArrayLike) -> ComplexArray:
        """Equivalent stiffness, N/m, in closed form."""
        return self.k * jenkins_reduction(amplitudes(amplitude), self.yields_at)

    def __mul__(self, count: float) -> Jenkins:
        """`count` in parallel."""
        return replace(self, k=count * self.k, slip=count * self.slip)


def jenkins_reduction(amplitude: npt.ArrayLike, yields_at: npt.ArrayLike) -> ComplexArray:
    """Equivalent stiffness of a Jenkins element over its k; broadcasts over both, m."""
    r = np.minimum(np.divide(yields_at, amplitude), 1.0)
    theta = np.arccos(1 - 2 * r)
    return np.asarray((theta - np.sin(2 * theta) / 2) / np.pi + 4j / np.pi * r * (1 - r))
