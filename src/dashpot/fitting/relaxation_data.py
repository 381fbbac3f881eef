"""The relaxation test as data to be explained, freed of its tare and drift."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.engine.blocks.block import Block, Evaluation
from dashpot.engine.blocks.correlation import correlation_block
from dashpot.engine.blocks.kernels import reduced_block
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
    certain : Block
        The test without the columns in doubt.
    """

    block: Block
    weight: float
    kappa: float
    doubt: Mapping[str, float]
    certain: Block

    @property
    def floor(self) -> float:
        """Weighted sum of squares that no model can remove."""
        return self.weight**2 * self.block.floor

    @property
    def samples(self) -> float:
        """Effective number of samples."""
        return self.block.samples / self.kappa

    def weighted(self, index: int) -> Block:
        """The certain block in rows of unit noise; `index` tells private columns of tests apart."""
        names = (n if n in SOLID else f"{n}@{index}" for n in self.certain.fixed_names)
        return self.certain.weighted(self.weight, tuple(names))

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
        held = compressed((test,), Design("hold"))[0]
        return RelaxationData(held, weight, noise.kappa, {}, held)
    x, left = true_motion(test)
    clock = test.time[: len(x)]
    if compressed((test,), Design("full"))[0].rotated_basis:
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
        return RelaxationData(block, weight, noise.kappa, {}, block)
    columns = {name: fit.model.force(time, 1.0 * motion) for name, motion in motions.items()}
    wide = _widened(block, time, x - x[0], columns)
    return RelaxationData(wide, weight, noise.kappa, doubt, block)


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
    exact, more = block.exact, np.column_stack(list(columns.values()))

    def rows(log_tau: FloatArray, derivative: bool) -> Evaluation:
        found = exact.evaluate(log_tau, derivative)
        return found._replace(fixed=np.concatenate((found.fixed, more), axis=1))

    wide = replace(exact, rows=rows, fixed_names=(*exact.fixed_names, *columns))
    if block.rotated_basis:
        return correlation_block(wide, time, x, start=0, stop=len(time))
    low, high = exact.window
    return reduced_block(wide, reach=(min(DASHPOT * low, SHORTEST), LONGEST * high))
