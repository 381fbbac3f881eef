"""The relaxation test as data to be explained, freed of its tare and drift."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.engine.blocks import Block, Evaluation

# a dashpot is an arm far faster than anything in the window
DASHPOT = 1e-3


@dataclass(frozen=True, eq=False)
class Bench:
    r"""One relaxation test, each row worth one effective sample of unit noise.

    Tare and drift of the force are linear and private to the test, so they are projected out of
    everything once: what is left depends on :math:`k_\infty, k_j, \tau_j, b` alone.

    Attributes
    ----------
    block : Block
    weight : float
        :math:`1/(\sigma\sqrt\kappa)`, 1/N: kappa correlated samples say the same thing.
    private : array, shape (n, q)
        Orthonormal basis of the tare and drift columns.
    target, spring : array, shape (n,)
        Weighted and projected: data, and the column of k_inf.
    dashpot : array, shape (n,)
        That of b.
    floor : float
        Weighted sum of squares that no model can remove.
    samples : float
        Effective number of samples.
    """

    block: Block
    weight: float
    private: FloatArray
    target: FloatArray
    spring: FloatArray
    dashpot: FloatArray
    floor: float
    samples: float

    def arms(self, log_tau: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Columns of the arms and their derivative by ln tau, shape (n, N) each."""
        found = self.block.evaluate(log_tau)
        return self._free(found.arms), self._free(found.d_arms)

    def _free(self, columns: FloatArray) -> FloatArray:
        return _free(self.weight * columns, self.private)


def bench_of(block: Block, *, sd: float, kappa: float) -> Bench:
    """Weigh a block by its noise, and free it of what is private to it."""
    weight = 1 / (sd * np.sqrt(kappa))
    shortest = np.log(DASHPOT * block.window[0])
    found = block.evaluate(np.array([shortest]), False)
    names = [name.partition("@")[0] for name in block.fixed_names]
    own = np.array([kind not in {"k_inf", "b"} for kind in names], dtype=bool)
    private = (
        np.linalg.qr(found.fixed[:, own])[0] if own.any() else np.zeros((len(found.target), 0))
    )
    spring = found.fixed[:, names.index("k_inf")]
    dashpot = (
        found.fixed[:, names.index("b")] if "b" in names else found.arms[:, 0] / np.exp(shortest)
    )
    return Bench(
        block=block,
        weight=weight,
        private=private,
        target=_free(weight * found.target, private),
        spring=_free(weight * spring, private),
        dashpot=_free(weight * dashpot, private),
        floor=weight**2 * block.floor,
        samples=block.samples / kappa,
    )


def _free(columns: FloatArray, private: FloatArray) -> FloatArray:
    return np.asarray(columns - private @ (private.T @ columns))


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

    @property
    def grain(self) -> float:
        """Weighted."""
        return self.weight**2 * self.block.grain

    def evaluate(self, log_tau: FloatArray, derivative: bool = True) -> Evaluation:
        """The block's rows times the weight."""
        found = self.block.evaluate(log_tau, derivative)
        return Evaluation(*(self.weight * part for part in found))
