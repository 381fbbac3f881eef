"""How well a solid and its shifts are known: every sample, every column, the noise as it is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.engine.inference.covariance import Noise, noise_of, sandwich
from dashpot.fitting.assembly import nuisances
from dashpot.fitting.temperature.joint import JointTests, Part, ShiftedSolid
from dashpot.fitting.temperature.reduced import Own
from dashpot.fitting.uncertainty.encoder import Encoder, Kernel, encoder_rows
from dashpot.fitting.uncertainty.estimate import Known, rounding
from dashpot.records.estimate import Nuisance, Residual, parameter_names


@dataclass(frozen=True, eq=False)
class Knowledge(Known):
    """All that was fitted together, the noises in units of the spread that each test weighs by.

    Attributes
    ----------
    joint : JointTests
    point : ShiftedSolid
        Relaxation times ascending.
    own : array
        Coefficients of the columns of each test, ``"offset@0"``; in `names` they stand behind what
        is shared, stiffnesses in N/m.
    """

    joint: JointTests
    point: ShiftedSolid
    own: FloatArray

    @property
    def of_solid(self) -> FloatArray:
        """Covariance of the solid's parameters."""
        rows = [self.names.index(name) for name in parameter_names(self.point.order)]
        return np.asarray(self.covariance[np.ix_(rows, rows)])

    @property
    def shift_covariance(self) -> FloatArray:
        """Of log10 a_T of every temperature, then of ln b_T; zero where nothing was sought."""
        turn = self.joint.shift_rows(self.names)
        return np.asarray(turn @ self.covariance @ turn.T)

    @property
    def cross(self) -> FloatArray:
        """Of the solid's parameters and the slope, with the shifts and the slope."""
        solid = [self.names.index(name) for name in parameter_names(self.point.order)]
        every = np.eye(len(self.names))
        slope = every[[self.names.index("slope")]] if "slope" in self.names else 0 * every[:1]
        rows = np.concatenate((every[solid], slope))
        columns = np.concatenate((self.joint.shift_rows(self.names), slope))
        return np.asarray(rows @ self.covariance @ columns.T)

    @property
    def nuisances(self) -> tuple[Nuisance, ...]:
        """The columns of each test, and how arms shift apart."""
        own = self.names[len(self.names) - len(self.own) :]
        return of_tests(own, self.own, self.point, self.standard_error)

    @property
    def residual(self) -> Residual:
        """Of every sample."""
        return self.statistics([noise.samples for noise in self.noises])


def of_tests(
    names: Sequence[str], own: FloatArray, point: ShiftedSolid, error: Callable[[str], float]
) -> tuple[Nuisance, ...]:
    """Return the columns of each test, ``"offset@0"``, and how arms shift apart, in words."""
    values = dict(zip(names, own.tolist(), strict=True))
    found = nuisances(names, values.__getitem__, error)
    if point.order < 2:
        return found
    return (*found, Nuisance("shift slope", point.slope, error("slope"), "1/decade"))


class Left(NamedTuple):
    """What a point leaves of one test, N, the coefficients of the test's own columns fitted.

    Attributes
    ----------
    left : array, shape (n,)
    own : array
    part : Part
    columns : array, shape (n, q)
        Of the test's own.
    """

    left: FloatArray
    own: FloatArray
    part: Part
    columns: FloatArray


def left_of(joint: JointTests, test: Own, i: int, point: ShiftedSolid) -> Left:
    """Return what a point leaves of every sample of test i."""
    weight, exact = 1 / test.spread, test.block.exact
    part = joint.part(exact, int(joint.at[i]), point)
    columns = exact.evaluate(np.zeros(0), False).fixed[:, test.own_columns]
    rows, target = test.prior_rows
    own = np.linalg.lstsq(
        np.concatenate((weight * columns, rows)),
        np.concatenate((weight * part.residual, target)),
        rcond=None,
    )[0]
    return Left(part.residual - columns @ own, own, part, columns)


def own_names(tests: Sequence[Own]) -> tuple[str, ...]:
    """Return the columns of each test, ``"offset@0"``."""
    return tuple(f"{kind}@{i}" for i, test in enumerate(tests) for kind in test.kinds)


class _Test(NamedTuple):
    """One test at a point, weighted by its noise, with every parameter's derivative.

    Attributes
    ----------
    left : array, shape (n,)
        Residual, N.
    own : array
        Coefficients of its own columns.
    jacobian : array, shape (n, p)
    before : array, shape (m, p)
        What was known of those coefficients.
    noise : Noise
    further : callable
        What errors of its encoder make of columns of the Jacobian.
    """

    left: FloatArray
    own: FloatArray
    jacobian: FloatArray
    before: FloatArray
    noise: Noise
    further: Callable[[FloatArray], FloatArray]


def known(joint: JointTests, tests: Sequence[Own], point: ShiftedSolid) -> Knowledge:
    """Return what all samples say of a point, the columns of every test fitted beside it."""
    shared = joint.names(point.order)
    names = (*shared, *own_names(tests))
    parts = [_of(joint, test, i, point, names) for i, test in enumerate(tests)]
    before = np.concatenate([part.before for part in parts])
    if "slope" in names:
        about = np.zeros((1, len(names)))
        about[0, names.index("slope")] = 1 / joint.slope_sd
        before = np.concatenate((before, about))
    covariance = sandwich(
        [*(part.jacobian for part in parts), before],
        [*(part.noise for part in parts), Noise(len(before), np.ones(1), 1.0, 2.0)],
        further=[part.further for part in parts],
    )
    return Knowledge(
        names,
        covariance,
        tuple(part.left for part in parts),
        tuple(part.noise for part in parts),
        joint,
        point,
        np.concatenate([part.own for part in parts]),
    )


def _of(joint: JointTests, test: Own, i: int, point: ShiftedSolid, names: tuple[str, ...]) -> _Test:
    at, weight, shared = int(joint.at[i]), 1 / test.spread, len(joint.names(point.order))
    left, own, part, columns = left_of(joint, test, i, point)
    rows = test.prior_rows[0]
    here = [names.index(f"{kind}@{i}") for kind in test.kinds]
    jacobian, before = np.zeros((len(left), len(names))), np.zeros((len(rows), len(names)))
    jacobian[:, :shared], jacobian[:, here] = weight * part.by, weight * columns
    before[:, here] = rows
    least = weight * rounding(float(np.abs(test.record.force).max()))
    solid = point.solid_at(at)
    encoder, kernel = (
        Encoder.of(test.record),
        Kernel(solid.k_inf, np.asarray(solid.k), np.asarray(solid.tau)),
    )
    return _Test(
        left,
        own,
        jacobian,
        before,
        noise_of(weight * left, jacobian, rounding=least),
        lambda columns: weight * encoder_rows(columns, encoder, kernel),
    )
