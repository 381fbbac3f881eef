"""The relaxation test as data to be explained, freed of its tare and drift."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.engine.blocks import Block, DesignBlock, Evaluation
from dashpot.engine.correlation import CorrelationBlock, correlation_block
from dashpot.engine.recorded import recorded_block
from dashpot.identification.motion import between_counts
from dashpot.relaxation.checks import encoder_step
from dashpot.relaxation.design import Design, compressed
from dashpot.relaxation.fit import Fit, Residual
from dashpot.relaxation.records import RampHold

# a dashpot is an arm far faster than anything in the window
DASHPOT = 1e-3
SOLID = ("k_inf", "b")


class Rows(NamedTuple):
    """A relaxation test at some relaxation times, each row worth one sample of unit noise.

    Target, the columns of k_inf and of b, of the arms, and their derivatives by ln tau. The
    coordinates may differ from call to call, so rows of two calls must not be mixed.
    """

    target: FloatArray
    spring: FloatArray
    dashpot: FloatArray
    arms: FloatArray
    slopes: FloatArray


@dataclass(frozen=True, eq=False)
class Bench:
    r"""One relaxation test, weighted by its noise.

    Attributes
    ----------
    block : Block
        Fixed columns other than those of the solid are private to the test.
    weight : float
        :math:`1/(\sigma\sqrt\kappa)`, 1/N: kappa correlated samples say the same thing.
    kappa : float
    doubt : dict of str to float
        Standard deviation of the coefficient of those private columns that are not free.
    """

    block: Block
    weight: float
    kappa: float
    doubt: Mapping[str, float]

    @property
    def floor(self) -> float:
        """Weighted sum of squares that no model can remove."""
        return self.weight**2 * self.block.floor

    @property
    def samples(self) -> float:
        """Effective number of samples."""
        return self.block.samples / self.kappa

    def rows(self, log_tau: FloatArray, *, slopes: bool = True) -> Rows:
        r"""Everything that depends on the solid.

        Tare and drift of the force are linear and private to the test: they are projected out.
        Private columns C that are known to within a standard deviation add :math:`C C'` to the
        covariance of the noise, which is whitened.
        """
        block = self.block
        kinds = [name.partition("@")[0] for name in block.fixed_names]
        shortest = np.log(DASHPOT * block.window[0])
        found = block.evaluate(np.append(log_tau, shortest), slopes)
        free = [kind not in SOLID and kind not in self.doubt for kind in kinds]
        private = np.linalg.qr(found.fixed[:, free])[0]
        doubtful = [kind in self.doubt for kind in kinds]
        sizes = [self.doubt[kind] for kind in kinds if kind in self.doubt]
        noise = self.weight * _freed(found.fixed[:, doubtful], private) * sizes
        axes, stretch, _ = np.linalg.svd(noise, full_matrices=False)
        shrink = 1 - 1 / np.sqrt(1 + stretch**2)

        def white(columns: FloatArray) -> FloatArray:
            columns = self.weight * _freed(columns, private)
            along = axes.T @ columns
            return np.asarray(
                columns - axes @ (shrink.reshape(-1, *[1] * (along.ndim - 1)) * along)
            )

        fast = found.arms[:, -1] / np.exp(shortest)
        return Rows(
            target=white(found.target),
            spring=white(found.fixed[:, kinds.index("k_inf")]),
            dashpot=white(found.fixed[:, kinds.index("b")] if "b" in kinds else fast),
            arms=white(found.arms[:, :-1]),
            slopes=white(found.d_arms[:, :-1]),
        )


def _freed(columns: FloatArray, private: FloatArray) -> FloatArray:
    return np.asarray(columns - private @ (private.T @ columns))


def bench_of(test: RampHold, fit: Fit, *, noise: Residual | None = None) -> Bench:
    r"""Weigh a test by the residual of its fit, and doubt its depth by the encoder's step.

    Both the zero at contact and the reading of the hold are uniform within a step q, a standard
    deviation of :math:`q/\sqrt{12}`. A depth wrong by that much leaves a step of force at the end
    of the ramp, which looks like an arm faster than the ramp.

    Parameters
    ----------
    test : RampHold
    fit : Fit
        The solid whose response to a step stands for the doubt; its method is kept.
    noise : Residual, optional
        Of this test alone, where the fit is of several.
    """
    noise = fit.residual if noise is None else noise
    weight = 1 / (noise.rms * np.sqrt(noise.kappa))
    if fit.method == "hold":
        return Bench(compressed((test,), Design("hold"))[0], weight, noise.kappa, {})
    used = slice(0, test.hold.stop)
    time, x = test.time[used] - test.time[0], test.displacement[used]
    step = encoder_step(test)
    if step > 0:
        x = between_counts(time, x)
    block = recorded_block(time, x - x[0], test.force[used], offset="offset", drift="drift")
    if step == 0:
        return Bench(block, weight, noise.kappa, {})
    columns = {
        name: fit.model.force(time, 1.0 * (test.time[used] >= at))
        for name, at in (("contact", test.onset), ("depth", test.ramp_end))
    }
    doubt = dict.fromkeys(columns, float(step / np.sqrt(12)))
    return Bench(_widened(block, time, x - x[0], columns), weight, noise.kappa, doubt)


def _widened(
    block: Block, time: FloatArray, x: FloatArray, columns: Mapping[str, FloatArray]
) -> Block:
    """The block of a recorded motion with more fixed columns."""
    exact = block.exact
    if not isinstance(exact, DesignBlock):
        return block
    wide = replace(
        exact,
        fixed=np.column_stack((exact.fixed, *columns.values())),
        fixed_names=(*exact.fixed_names, *columns),
    )
    if isinstance(block, CorrelationBlock):
        return correlation_block(wide, time, x, start=0, stop=len(time))
    return wide


@dataclass(frozen=True, eq=False)
class WeightedBlock:
    """A block whose rows are multiplied by a weight, so that blocks of unlike units stack."""

    block: Block
    weight: float

    @property
    def floor(self) -> float:
        """Weighted."""
        return self.weight**2 * self.block.floor

    @property
    def grain(self) -> float:
        """Weighted."""
        return self.weight**2 * self.block.grain

    @property
    def turning(self) -> bool:
        """As the block's."""
        return self.block.turning

    @property
    def exact(self) -> WeightedBlock:
        """Every weighted sample as a row."""
        return WeightedBlock(self.block.exact, self.weight)

    @property
    def samples(self) -> int:
        """As the block's."""
        return self.block.samples

    @property
    def fixed_names(self) -> tuple[str, ...]:
        """As the block's."""
        return self.block.fixed_names

    @property
    def arm_group(self) -> str:
        """As the block's."""
        return self.block.arm_group

    @property
    def window(self) -> tuple[float, float]:
        """As the block's."""
        return self.block.window

    def evaluate(self, log_tau: FloatArray, derivative: bool = True) -> Evaluation:
        """The block's rows times the weight."""
        found = self.block.evaluate(log_tau, derivative)
        return Evaluation(*(self.weight * part for part in found))
