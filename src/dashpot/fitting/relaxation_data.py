"""The relaxation test as data to be explained, freed of its tare and drift."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.engine.blocks.block import Block, DesignBlock, Evaluation
from dashpot.engine.blocks.correlation import CorrelationBlock, correlation_block
from dashpot.engine.blocks.interpolated import reduced
from dashpot.engine.blocks.recorded import recorded_block
from dashpot.fitting.design import Design, compressed
from dashpot.preparation.denoising import APART, true_motion
from dashpot.records.estimate import Residual
from dashpot.records.fit import Fit
from dashpot.records.relaxation import RampHold

# a dashpot is an arm far faster than anything in the window
DASHPOT = 1e-3
# relaxation times of a record on an uneven clock: from this, s, to this many of its windows
SHORTEST, LONGEST = 1e-6, 10.0
SOLID = ("k_inf", "b")
STRETCHES = 50


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
class RelaxationData:
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


def relaxation_data(test: RampHold, fit: Fit, *, noise: Residual | None = None) -> RelaxationData:
    r"""Weigh a test by the residual of its fit, and doubt its motion by what the encoder leaves.

    Both the zero at contact and the reading of the hold are uniform within a count q, a standard
    deviation of :math:`q/\sqrt{12}`; where the motion bends, what is left of the encoder's noise
    moves the force for some hundredths of the ramp. Either looks like an arm faster than the ramp.

    Parameters
    ----------
    test : RampHold
    fit : Fit
        The solid whose response to a small motion stands for the doubt; its method is kept.
    noise : Residual, optional
        Of this test alone, where the fit is of several.
    """
    noise = fit.residual if noise is None else noise
    weight = 1 / (noise.rms * np.sqrt(noise.kappa))
    if fit.method == "hold":
        return RelaxationData(compressed((test,), Design("hold"))[0], weight, noise.kappa, {})
    x, left = true_motion(test)
    clock = test.time[: len(x)]
    if isinstance(compressed((test,), Design("full"))[0], CorrelationBlock):
        clock = np.linspace(clock[0], clock[-1], len(clock))  # even, but for its last digits
    time = clock - clock[0]
    block = recorded_block(time, x - x[0], test.force[: len(x)], offset="offset", drift="drift")
    motions: dict[str, BoolArray] = {}
    doubt: dict[str, float] = {}
    step = test.encoder_step
    if step > 0:
        motions |= {name: clock >= at for name, at in _readings(test)}
        doubt |= dict.fromkeys(motions, float(step / np.sqrt(12)))
    if left.any():
        bends = {f"bend@{i}": inside for i, inside in enumerate(_bends(test, clock))}
        motions |= bends
        doubt["bend"] = APART * float(
            np.sqrt(np.mean(left[np.any([*bends.values()], axis=0)] ** 2))
        )
    if not motions:
        return RelaxationData(block, weight, noise.kappa, {})
    columns = {name: fit.model.force(time, 1.0 * motion) for name, motion in motions.items()}
    return RelaxationData(_widened(block, time, x - x[0], columns), weight, noise.kappa, doubt)


def _readings(test: RampHold) -> tuple[tuple[str, float], ...]:
    return ("contact", test.onset), ("depth", test.ramp_end)


def _bends(test: RampHold, time: FloatArray) -> list[BoolArray]:
    """The stretches, of a fiftieth of the ramp each, where the motion starts and where it ends."""
    width = test.ramp_time / STRETCHES
    starts = [test.onset + i * width for i in range(-2, 6)]
    starts += [test.ramp_end + i * width for i in range(-4, 8)]
    found = [(time >= start) & (time < start + width) for start in starts]
    return [inside for inside in found if inside.any()]


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
    low, high = exact.window
    return reduced(wide, shortest=min(DASHPOT * low, SHORTEST), longest=LONGEST * high)


@dataclass(frozen=True, eq=False)
class WeightedBlock:
    """A bench as the engine takes it: rows of unit noise, the doubtful columns left out.

    Attributes
    ----------
    relaxation : Bench
    index : int
        Tells the private columns of several benches apart.
    """

    relaxation: RelaxationData
    index: int

    @property
    def floor(self) -> float:
        """Weighted."""
        return self.relaxation.floor

    @property
    def rounding_floor(self) -> float:
        """Weighted."""
        return self.relaxation.weight**2 * self.relaxation.block.rounding_floor

    @property
    def energy(self) -> float:
        """Weighted."""
        return self.relaxation.weight**2 * self.relaxation.block.energy

    @property
    def sampling(self) -> None:
        """Not known: the weight is the record's own."""

    @property
    def rotated_basis(self) -> bool:
        """As the block's."""
        return self.relaxation.block.rotated_basis

    @property
    def samples(self) -> int:
        """As the block's."""
        return self.relaxation.block.samples

    @property
    def fixed_names(self) -> tuple[str, ...]:
        """Those of the solid as they are, private ones with the index."""
        return tuple(name if name in SOLID else f"{name}@{self.index}" for name in self._kept)

    @property
    def arm_group(self) -> str:
        """As the block's."""
        return self.relaxation.block.arm_group

    @property
    def exact(self) -> Block:
        """Every weighted sample as a row."""
        return WeightedBlock(
            replace(self.relaxation, block=self.relaxation.block.exact), self.index
        )

    @property
    def window(self) -> tuple[float, float]:
        """As the block's."""
        return self.relaxation.block.window

    def evaluate(self, log_tau: FloatArray, derivative: bool = True) -> Evaluation:
        """The block's rows times the weight."""
        found = self.relaxation.block.evaluate(log_tau, derivative)
        kept = [name in self._kept for name in self.relaxation.block.fixed_names]
        found = found._replace(fixed=found.fixed[:, kept])
        return Evaluation(*(self.relaxation.weight * part for part in found))

    @property
    def _kept(self) -> tuple[str, ...]:
        names = self.relaxation.block.fixed_names
        return tuple(name for name in names if name.partition("@")[0] not in self.relaxation.doubt)
