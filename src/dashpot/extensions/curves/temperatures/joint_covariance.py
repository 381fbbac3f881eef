"""Covariance of a solid and its shifts under the noise of all records."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.datamodel.parameter_estimate import Nuisance, Residual, parameter_names
from dashpot.extensions.curves.temperatures.joint_problem import (
    JointTests,
    ShiftedSolid,
    TestContribution,
)
from dashpot.extensions.curves.temperatures.marginalised_data import SingleTemperatureTest
from dashpot.fitting.fit_construction import list_nuisances
from dashpot.fitting.parameter_errors import (
    Encoder,
    Kernel,
    ParameterCovariance,
    encoder_rows,
    rounding_rms,
)
from dashpot.numerics.inference.correlated_noise import (
    Noise,
    estimate_noise,
    make_directions,
    sandwich,
)
from dashpot.solids.maxwell import GeneralizedMaxwell


@dataclass(frozen=True, eq=False)
class JointCovariance(ParameterCovariance):
    """Covariance of all fitted parameters, with noises in units of each test's weight.

    Attributes
    ----------
    joint : JointTests
    point : ShiftedSolid
        Relaxation times ascending.
    nuisance_values : array
        Coefficients of the columns of each test, ``"offset@0"``; in `names` they stand behind what
        is shared, stiffnesses in N/m.
    rig_changes : array, shape (p, d)
        What each doubt of each rig adds to everything that was fitted.
    """

    joint: JointTests
    point: ShiftedSolid
    nuisance_values: FloatArray
    rig_changes: FloatArray

    @property
    def solid_covariance(self) -> FloatArray:
        """Covariance of the solid's parameters, for the noise."""
        return np.asarray(self.covariance[np.ix_(self._solid, self._solid)])

    @property
    def solid_rig_sensitivity(self) -> FloatArray:
        """Sensitivity of the solid's parameters to the uncertainties of the rigs, shape (p, d)."""
        return self.rig_changes[self._solid]

    @property
    def _solid(self) -> list[int]:
        return [self.names.index(name) for name in parameter_names(self.point.order)]

    @property
    def shift_covariance(self) -> FloatArray:
        """Covariance of log10 a_T of every temperature, then of ln b_T; zero if not fitted."""
        selection_rows = self.joint.shift_rows(self.names)
        return np.asarray(selection_rows @ self.covariance @ selection_rows.T)

    @property
    def cross(self) -> FloatArray:
        """Cross-covariance of the solid's parameters and slope with the shifts and slope."""
        solid = [self.names.index(name) for name in parameter_names(self.point.order)]
        identity = np.eye(len(self.names))
        slope = identity[[self.names.index("slope")]] if "slope" in self.names else 0 * identity[:1]
        rows = np.concatenate((identity[solid], slope))
        columns = np.concatenate((self.joint.shift_rows(self.names), slope))
        return np.asarray(rows @ self.covariance @ columns.T)

    @property
    def nuisances(self) -> tuple[Nuisance, ...]:
        """The columns of each test, and how arms shift apart."""
        names = self.names[len(self.names) - len(self.nuisance_values) :]
        return build_test_nuisances(names, self.nuisance_values, self.point, self.standard_error)

    @property
    def residual(self) -> Residual:
        """Residual of every sample."""
        return self.statistics([noise.samples for noise in self.noises])


def build_test_nuisances(
    names: Sequence[str], base: FloatArray, point: ShiftedSolid, error: Callable[[str], float]
) -> tuple[Nuisance, ...]:
    """Return the columns of each test, ``"offset@0"``, and how arms shift apart, in words."""
    values = dict(zip(names, base.tolist(), strict=True))
    terms = list_nuisances(names, values.__getitem__, error)
    if point.order < 2:
        return terms
    return (*terms, Nuisance("shift slope", point.slope, error("slope"), "1/decade"))


class TestResidual(NamedTuple):
    """Residual of one test, N, with the coefficients of its own columns fitted.

    Attributes
    ----------
    residual : array, shape (n,)
    nuisance_values : array
    part : TestContribution
    columns : array, shape (n, q)
        Columns of the test's own.
    """

    residual: FloatArray
    nuisance_values: FloatArray
    part: TestContribution
    columns: FloatArray


def compute_test_residual(
    joint: JointTests, test: SingleTemperatureTest, i: int, point: ShiftedSolid
) -> TestResidual:
    """Return the residual of every sample of test i at a point."""
    weight, exact = 1 / test.spread, test.block.exact
    part = joint.part(exact, int(joint.at[i]), point)
    columns = exact.evaluate(np.zeros(0), False).fixed[:, test.nuisance_columns]
    rows, target = test.prior_rows
    values = np.linalg.lstsq(
        np.concatenate((weight * columns, rows)),
        np.concatenate((weight * part.residual, target)),
        rcond=None,
    )[0]
    return TestResidual(part.residual - columns @ values, values, part, columns)


def list_column_names(tests: Sequence[SingleTemperatureTest]) -> tuple[str, ...]:
    """Return the columns of each test, ``"offset@0"``."""
    return tuple(f"{kind}@{i}" for i, test in enumerate(tests) for kind in test.kinds)


def compute_joint_covariance(
    joint: JointTests, tests: Sequence[SingleTemperatureTest], point: ShiftedSolid
) -> JointCovariance:
    """Return the covariance of a point by all samples, nuisances of every test included."""
    shared = joint.names(point.order)
    names = (*shared, *list_column_names(tests))
    residuals = [compute_test_residual(joint, test, i, point) for i, test in enumerate(tests)]
    jacobians, earlier_rows, noises, residual_parts, unmeasured = [], [], [], [], []
    for i, (test, residual) in enumerate(zip(tests, residuals, strict=True)):
        weight, rows = 1 / test.spread, test.prior_rows[0]
        column_indices = [names.index(f"{kind}@{i}") for kind in test.kinds]
        jacobian, values = (
            np.zeros((len(residual.residual), len(names))),
            np.zeros((len(rows), len(names))),
        )
        jacobian[:, : len(shared)] = weight * residual.part.by
        jacobian[:, column_indices], values[:, column_indices] = weight * residual.columns, rows
        rounding_level = weight * rounding_rms(float(np.abs(test.record.force).max()))
        jacobians.append(jacobian)
        earlier_rows.append(values)
        noises.append(estimate_noise(weight * residual.residual, jacobian, rounding=rounding_level))
        solid = point.solid_at(int(joint.at[i]))
        residual_parts.append(partial(_encoder_rows, test, solid))
        unmeasured.append(weight * test.unmeasured_effects(solid))
    if "slope" in names:
        earlier_rows.append(np.eye(len(names))[[names.index("slope")]] / joint.slope_sd)
    prior_sds = np.concatenate(earlier_rows)
    information = make_directions([*jacobians, prior_sds])
    covariance = sandwich(
        information,
        [*noises, Noise(len(prior_sds), np.ones(1), 1.0, 2.0)],
        other_columns=residual_parts,
    )
    changes = [
        information.parameter_directions @ (columns.matrix.T @ row)
        for columns, row in zip(information.columns, unmeasured, strict=False)
    ]
    arrays, base = (
        tuple(test_residual.residual for test_residual in residuals),
        np.concatenate([test_residual.nuisance_values for test_residual in residuals]),
    )
    return JointCovariance(
        names, covariance, arrays, tuple(noises), joint, point, base, np.hstack(changes)
    )


def _encoder_rows(
    test: SingleTemperatureTest, solid: GeneralizedMaxwell, columns: FloatArray
) -> FloatArray:
    """Return what errors of a test's encoder make of columns of its Jacobian."""
    kernel = Kernel(solid.k_inf, np.asarray(solid.k), np.asarray(solid.tau))
    return encoder_rows(columns, Encoder.from_record(test.record), kernel) / test.spread
