"""What FRFs at several levels say of a solid and its friction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import BoolArray, ByValue, ComplexArray, FloatArray
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.offered import Described
from dashpot.base.provenance import Source
from dashpot.solids.friction import Jenkins
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.rate_independent import InParallel


@dataclass(frozen=True, eq=False, repr=False)
class LevelFit(ByValue, Described):
    """Arms and sliders of one seal that follow its FRFs at several levels.

    Attributes
    ----------
    solid : GeneralizedMaxwell
        What does not depend on the level; its single arms mean little beyond the band.
    sliders : tuple of Jenkins
        The friction beside it: a spectrum over yield displacements; none where it is not seen.
    amplitudes : (float, float)
        Range of displacement amplitudes of the seal that the lines cover, m.
    band : (float, float)
        Hz.
    residual : float
        Rms of what is left of F/X, relative, over every line.
    linear_residual : float
        As `residual`, of arms alone.
    draws : tuple of (GeneralizedMaxwell, tuple of Jenkins)
        The same fit of records that chance might have given: what is known of anything that
        follows from the solid and its sliders.
    mass : float
        On all seals, kg.
    seals : float
    levels : tuple of float
        Amplitude of the force at each FRF, N; over a base that moves, of its acceleration, m/s^2.
    checks : tuple of Check
    source : tuple of Source
    """

    solid: GeneralizedMaxwell
    sliders: tuple[Jenkins, ...]
    amplitudes: tuple[float, float]
    band: tuple[float, float]
    residual: float
    linear_residual: float
    draws: tuple[tuple[GeneralizedMaxwell, tuple[Jenkins, ...]], ...]
    mass: float
    seals: float = 1.0
    levels: tuple[float, ...] = ()
    checks: tuple[Check, ...] = ()
    source: tuple[Source, ...] = ()

    @property
    def verdict(self) -> Verdict:
        """What to make of it."""
        return verdict(self.checks)

    def stiffness(self, omega: npt.ArrayLike, amplitude: npt.ArrayLike) -> ComplexArray:
        """Complex stiffness of one seal, N/m, at rad/s and amplitudes, m."""
        return InParallel((self.solid, *self.sliders)).equivalent(omega, amplitude)

    def interval(
        self, follows: Callable[[GeneralizedMaxwell, tuple[Jenkins, ...]], npt.ArrayLike]
    ) -> FloatArray:
        """95 % interval of what follows from the solid and its sliders (basic bootstrap).

        The fit leans to the side on which its draws lean: they are reflected about it. Shape
        (2,) of a number, (2, n) of several.
        """
        here = np.asarray(follows(self.solid, self.sliders))
        drawn = np.array([np.asarray(follows(*draw), dtype=float) for draw in self.draws])
        return np.asarray(2 * here - np.quantile(drawn, [0.975, 0.025], axis=0))

    def covers(self, amplitude: npt.ArrayLike) -> BoolArray:
        """Whether amplitudes, m, lie in the range that the lines inform."""
        low, high = self.amplitudes
        X = np.asarray(amplitude)
        return np.asarray((low <= X) & (high >= X))

    @property
    def described(self) -> tuple[str, ...]:
        """The verdict, and what moves with amplitude by how much."""
        low, high = self.amplitudes
        judged = self.verdict
        middle = np.pi * (self.band[0] + self.band[1])
        ends = self.stiffness(middle, [low, high])
        factor = ends.imag / ends.real
        return (
            f"{judged.use}: {judged.says}",
            (
                f"one seal, {1e3 * low:.3g} to {1e3 * high:.3g} mm at {middle / 2 / np.pi:.4g} Hz: "
                f"stiffness {1e-3 * ends[0].real:.4g} to {1e-3 * ends[1].real:.4g} N/mm, "
                f"loss factor {factor[0]:.3g} to {factor[1]:.3g}"
            ),
            (
                f"{self.solid.arms} arms and {len(self.sliders)} sliders leave "
                f"{100 * self.residual:.2g} % of F/X; arms alone {100 * self.linear_residual:.2g} %"
            ),
            *(check.says for check in self.checks if check.failed),
        )
