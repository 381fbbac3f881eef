"""Payne softening: the share of stiffness that a rubber loses with amplitude."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray
from dashpot.base.errors import DataError
from dashpot.extensions.amplitude.friction import Kraus
from dashpot.solids.maxwell import Solid
from dashpot.solids.rate_independent import AmplitudeDependent, require_positive_parameters


@dataclass(frozen=True)
class Softening(AmplitudeDependent):
    r"""Change of a solid with amplitude, as a parallel element: :math:`K^*(\omega)[\phi(X) - 1]`.

    .. math:: \phi = 1 - d\left[1 - \frac{1}{1 + u^{2m}}\right]
        + j\,\frac{d\,m}{\pi}\,\frac{2 u^m}{1 + u^{2m}}, \quad u = \frac{X}{X_c}

    Kraus's law as a factor on a linear solid, its loss tied to its softening (broad friction). Of a
    solid that was itself measured at an amplitude X_0, friction and all,
    :math:`K^*(\omega)[\phi(X)/\phi(X_0) - 1]`.

    Attributes
    ----------
    solid : Solid
        The solid in parallel, valid at vanishing amplitude.
    share : float
        d, the part of the stiffness that large amplitudes lose, 0 < d <= 1.
    half_way : float
        X_c, m, > 0.
    exponent : float
        m, 0 < m < 1.
    since : float
        X_0, m; 0 where the solid is valid at vanishing amplitude.
    """

    solid: Solid
    share: float
    half_way: float
    exponent: float = 0.5
    since: float = 0.0

    def __post_init__(self) -> None:
        require_positive_parameters(self, "share", "half_way", "exponent")
        if self.share > 1 or self.exponent >= 1:
            raise DataError(
                f"Softening: share = {self.share:g}, m = {self.exponent:g}; expected a share of at "
                "most 1 and an exponent below 1"
            )

    def equivalent(self, omega: npt.ArrayLike, amplitude: npt.ArrayLike) -> ComplexArray:
        """Change of the complex stiffness, N/m: its real part is below 0."""
        law = self.share, self.half_way, self.exponent
        factor = softening_factor(self.since, *law) if self.since else 1.0
        return np.asarray(
            self.solid.complex_stiffness(omega=omega)
            * (softening_factor(amplitude, *law) / factor - 1)
        )

    def start(self) -> Any:
        """Refused: a law of amplitudes has no path.

        Raises
        ------
        DataError
        """
        raise DataError(
            "a softening gives stiffness and loss at an amplitude and has no force along a path; "
            "add Jenkins elements to the model instead"
        )

    def advance(self, state: Any, dt: float, x: float) -> tuple[float, Any]:  # noqa: ARG002
        """Refused, as :meth:`start`."""
        return self.start()  # type: ignore[no-any-return]  # it raises

    def __mul__(self, count: float) -> Softening:
        """`count` in parallel."""
        return replace(self, solid=self.solid * count)


def softening_factor(
    amplitude: npt.ArrayLike, share: float, half_way: float, exponent: float = 0.5
) -> ComplexArray:
    """Return complex stiffness over that of a vanishing amplitude: phi of :class:`Softening`."""
    return np.asarray(1 - share * (1 - Kraus(1.0, half_way, exponent).stiffness(amplitude)))
