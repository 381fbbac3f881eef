r"""One solid, its shifts, and tests at several temperatures: least squares over all at once.

Everything that is shared is unknown together: k_inf, every ln k and ln tau, ln a_T and ln b_T of
every further temperature, and how much further slow arms shift than fast ones,

.. math:: \ln a_T(\tau) = \ln a_T \bigl[1 + g\,(\log_{10} \tau - \log_{10} 0.5\,\mathrm{s})\bigr]

With :math:`q'_j = \partial q / \partial \ln \tau` of the column of an arm, the derivative by
:math:`\ln a_T` is :math:`b_T \sum_j k_j q'_j`. Steps are those of Levenberg and Marquardt.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.engine.blocks.block import Block
from dashpot.engine.inference.covariance import white
from dashpot.records.temperature import decades, shifted_log_tau
from dashpot.solids.maxwell import GeneralizedMaxwell

Vertical: TypeAlias = Literal["free", "T/T_r", "1"]

# longest steps of ln k, ln tau, ln a, ln b and g
_LONGEST = {"k": 2.0, "tau": 1.0, "a": 0.5, "b": 0.3, "g": 0.1}
# an arm smaller than this part of the stiffness is none
_NOTHING = 1e-9
_STEPS, _DAMPING = 80, (1e-3, 1e9)
# a relative fall of chi-square that is none
_STATIONARY = 1e-10


@dataclass(frozen=True, eq=False)
class Point:
    """One solid at the reference, and where every temperature lies.

    Attributes
    ----------
    k_inf : float
        N/m.
    log_k, log_tau : array, shape (N,)
    log_a, log_b : array, shape (T,)
        Of every temperature; 0 at the reference.
    slope : float
        g, per decade.
    chi_square : float
    """

    k_inf: float
    log_k: FloatArray
    log_tau: FloatArray
    log_a: FloatArray
    log_b: FloatArray
    slope: float = 0.0
    chi_square: float = np.inf

    @property
    def order(self) -> int:
        """Number of arms."""
        return len(self.log_tau)

    @property
    def solid(self) -> GeneralizedMaxwell:
        """At the reference."""
        order = np.argsort(self.log_tau)
        return GeneralizedMaxwell(
            self.k_inf, tuple(np.exp(self.log_k[order])), tuple(np.exp(self.log_tau[order]))
        )

    def moved_log_tau(self, i: int) -> FloatArray:
        """Ln of the relaxation times at temperature i."""
        return shifted_log_tau(self.log_tau, float(self.log_a[i]), self.slope)

    def solid_at(self, i: int) -> GeneralizedMaxwell:
        """At temperature i."""
        order, b = np.argsort(self.log_tau), float(np.exp(self.log_b[i]))
        return GeneralizedMaxwell(
            b * self.k_inf,
            tuple(b * np.exp(self.log_k[order])),
            tuple(np.exp(self.moved_log_tau(i)[order])),
        )


class Part(NamedTuple):
    """One test at a point: what it leaves, and the derivatives of the model by what is shared."""

    residual: FloatArray
    by: FloatArray


@dataclass(frozen=True, eq=False)
class Joint:
    """Tests at several temperatures.

    Attributes
    ----------
    blocks : sequence of Block
        Rows of unit noise, one fixed column, k_inf.
    at : array, shape (n,)
        Which temperature each is of.
    temperatures : array, shape (T,)
        K, rising.
    reference : int
        Which of them has no shift.
    vertical : str
        ``"free"``, or what ln b_T is held to.
    slope_sd : float
        What is known of g.
    """

    blocks: Sequence[Block]
    at: IndexArray
    temperatures: FloatArray
    reference: int
    vertical: Vertical
    slope_sd: float

    @property
    def further(self) -> IndexArray:
        """The temperatures whose shifts are sought."""
        every = np.arange(len(self.temperatures))
        return np.asarray(every[every != self.reference])

    @property
    def held_log_b(self) -> FloatArray:
        """Ln b_T where it is held, and where it starts."""
        if self.vertical == "1":
            return np.zeros(len(self.temperatures))
        return np.asarray(np.log(self.temperatures / self.temperatures[self.reference]))

    def names(self, order: int) -> tuple[str, ...]:
        """What is shared, in the order of the derivatives."""
        arms, further = range(1, order + 1), self.further
        return (
            "k_inf",
            *(f"k_{j}" for j in arms),
            *(f"ln_tau_{j}" for j in arms),
            *(f"ln_a_{i}" for i in further),
            *((f"ln_b_{i}" for i in further) if self.vertical == "free" else ()),
            # one arm cannot shift apart
            *(("slope",) if order > 1 else ()),
        )

    def shift_rows(self, names: Sequence[str]) -> FloatArray:
        """What picks log10 a_T and ln b_T of every temperature out of the parameters named."""
        count = len(self.temperatures)
        turn = np.zeros((2 * count, len(names)))
        for i in self.further:
            turn[i, names.index(f"ln_a_{i}")] = 1 / np.log(10.0)
            if f"ln_b_{i}" in names:
                turn[count + i, names.index(f"ln_b_{i}")] = 1.0
        return turn

    def part(self, block: Block, i: int, point: Point) -> Part:
        """One test of temperature i, in the rows of a block whose fixed column k_inf is first."""
        names, n = self.names(point.order), point.order
        found = block.evaluate(point.moved_log_tau(i))
        k, b = np.exp(point.log_k), float(np.exp(point.log_b[i]))
        spring = found.fixed[:, list(block.fixed_names).index("k_inf")]
        slopes, far = b * found.d_arms * k, decades(point.log_tau)
        by = np.zeros((len(found.target), len(names)))
        by[:, 0] = b * spring
        by[:, 1 : 1 + n] = b * found.arms * k
        stretched = 1 + point.log_a[i] * point.slope / np.log(10.0)
        by[:, 1 + n : 1 + 2 * n] = slopes * stretched
        force = by[:, 0] * point.k_inf + by[:, 1 : 1 + n].sum(axis=1)
        if i != self.reference:
            by[:, names.index(f"ln_a_{i}")] = slopes @ (1 + point.slope * far)
            if self.vertical == "free":
                by[:, names.index(f"ln_b_{i}")] = force
        if n > 1:
            by[:, -1] = slopes @ (point.log_a[i] * far)
        return Part(found.target - force, by)

    def descend(self, point: Point) -> Point:
        """Return the nearest optimum."""
        longest = self._longest(point.order)
        residual, by = self._all(point)
        point = replace(point, chi_square=self._floor + float(residual @ residual))
        damping = _DAMPING[0]
        for _ in range(_STEPS):
            size = np.linalg.norm(by, axis=0)
            size[size == 0] = 1.0
            scaled = by / size
            gram, moment = scaled.T @ scaled, scaled.T @ residual
            while damping < _DAMPING[1]:
                damped = gram + damping * np.eye(len(gram))
                step = np.linalg.solve(damped, moment) / size
                part = float(np.min(longest / np.maximum(np.abs(step), 1e-300), initial=1.0))
                tried = self._stepped(point, min(part, 1.0) * step)
                left, slopes = self._all(tried)
                chi_square = self._floor + float(left @ left)
                if chi_square < point.chi_square:
                    break
                damping *= 8.0
            else:
                break
            fall = point.chi_square - chi_square
            point, residual, by = replace(tried, chi_square=chi_square), left, slopes
            damping = max(damping / 10.0, 1e-12)
            if fall < _STATIONARY * max(chi_square, 1.0):
                break
        return point

    def errors(self, point: Point) -> FloatArray:
        """Standard errors of what is shared, k relative, under white noise of unit variance."""
        return np.sqrt(np.diag(self.covariance(point)))

    def covariance(self, point: Point) -> FloatArray:
        """Covariance of what is shared, k relative, under white noise of unit variance."""
        return white(self._all(point)[1], 1.0)

    def _all(self, point: Point) -> tuple[FloatArray, FloatArray]:
        """Residual and derivatives of every test, and what is known of g."""
        parts = [self.part(b, int(i), point) for b, i in zip(self.blocks, self.at, strict=True)]
        residual = np.concatenate([part.residual for part in parts])
        by = np.concatenate([part.by for part in parts])
        if point.order > 1:
            known = np.zeros((1, by.shape[1]))
            known[0, -1] = 1 / self.slope_sd
            residual = np.append(residual, -point.slope / self.slope_sd)
            by = np.concatenate((by, known))
        return residual, by

    @property
    def _floor(self) -> float:
        return float(sum(block.floor for block in self.blocks))

    def _longest(self, order: int) -> FloatArray:
        names = self.names(order)
        kinds = {"k_": "k", "ln_tau": "tau", "ln_a": "a", "ln_b": "b", "slope": "g"}
        found = []
        for name in names:
            kind = next((kinds[start] for start in kinds if name.startswith(start)), "")
            found.append(np.inf if name == "k_inf" else _LONGEST[kind])
        return np.array(found)

    def _stepped(self, point: Point, step: FloatArray) -> Point:
        n, names = point.order, self.names(point.order)
        log_a, log_b = point.log_a.copy(), point.log_b.copy()
        for i in self.further:
            log_a[i] += step[names.index(f"ln_a_{i}")]
            if self.vertical == "free":
                log_b[i] += step[names.index(f"ln_b_{i}")]
        total = point.k_inf + float(np.exp(point.log_k).sum())
        low, high = self._reach(point)
        return replace(
            point,
            k_inf=max(point.k_inf + float(step[0]), 0.0),
            log_k=np.maximum(point.log_k + step[1 : 1 + n], np.log(_NOTHING * total)),
            log_tau=np.clip(point.log_tau + step[1 + n : 1 + 2 * n], low, high),
            log_a=log_a,
            log_b=log_b,
            slope=point.slope + (float(step[-1]) if n > 1 else 0.0),
        )

    def _reach(self, point: Point) -> tuple[float, float]:
        """The window of ln tau that one of the tests shows."""
        each = [
            (block.bounds[0] - point.log_a[i], block.bounds[1] - point.log_a[i])
            for block, i in zip(self.blocks, self.at, strict=True)
        ]
        return min(low for low, _ in each), max(high for _, high in each)


def alive(point: Point) -> BoolArray:
    """Which arms are there."""
    total = point.k_inf + float(np.exp(point.log_k).sum())
    return np.asarray(np.exp(point.log_k) > 10 * _NOTHING * total)
