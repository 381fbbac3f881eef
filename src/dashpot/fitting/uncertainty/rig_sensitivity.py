r"""By how much the parameters of a fit follow what its rig may have added unseen.

A fit is of the quiet rig, what is claimed of it of the doubtful one. A force c that no column of
the fit has, such as that of a crosshead that settles, moves its parameters by

.. math:: \delta\theta = (J'J)^{-1} J' c

with J the rows of the records and of what was known of offset, drift and delay. With c the column
of one doubt times its standard deviation, :math:`\delta\theta\,\delta\theta'` is what it adds to
their covariance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.nuisance_priors import delay_prior, kind_of
from dashpot.fitting.relaxation_data import RelaxationData
from dashpot.numerics.inference.covariance import directions
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid


class _TestColumns(NamedTuple):
    """One test in rows of unit noise, a column each.

    Derivatives by the solid's parameters and by the test's own coefficients, what was known of
    these beforehand, and what the rig may add.
    """

    solid: FloatArray
    private: FloatArray
    known: FloatArray
    unseen: FloatArray


def compute_rig_sensitivity(
    relaxations: Sequence[RelaxationData], solid: Solid, *, separate: bool = False
) -> FloatArray:
    """Return what each doubt of each test adds to the parameters of a solid fitted to them.

    Parameters
    ----------
    relaxations : sequence of RelaxationData
        With what their rigs may add (`RelaxationData.unseen`), and as the solid was fitted.
    solid : Solid
        Its parameters are k_inf, every k, every ln tau, or those of a fractional solid; N/m and s.
    separate : bool
        Each test has stiffnesses of its own, one test's below another's, and the relaxation times
        are those of all.

    Returns
    -------
    array, shape (p, d)
        One standard deviation a column; all are independent.
    """
    all_columns = [_rows(data, solid) for data in relaxations]
    whole = all_columns[0].solid.shape[1]
    stiff = 1 + solid.maxwell.arms if separate else 0
    value = whole + stiff * (len(all_columns) - 1)
    shared = np.arange(value - whole + stiff, value)
    width = value + sum(column.private.shape[1] for column in all_columns)
    jacobians, first = [], value
    for i, item in enumerate(all_columns):
        rows, here = len(item.solid), slice(first, first + item.private.shape[1])
        J = np.zeros((rows + len(item.known), width))
        J[:rows, np.r_[i * stiff : (i + 1) * stiff, shared]] = item.solid
        J[:rows, here], J[rows:, here] = item.private, item.known
        jacobians.append(J)
        first = here.stop
    information = directions(jacobians)
    moves = [
        information.turn @ (columns.matrix[: len(column.unseen)].T @ column.unseen)
        for column, columns in zip(all_columns, information.columns, strict=True)
    ]
    return np.hstack(moves)[:value]


def _rows(data: RelaxationData, solid: Solid) -> _TestColumns:
    model, adds = solid.maxwell, data.unseen
    values = np.zeros(0) if adds is None else adds.log_tau
    # arms of a fractional solid lie beyond what a record shows, too: there they are all alike
    base, arms = np.unique(
        np.clip(np.log(model.tau), *np.log(data.block.window)), return_inverse=True
    )
    # coordinates may change from call to call: all that is compared is of one
    evaluation = data.block.evaluate(np.concatenate((base, values)))
    kinds = [kind_of(name) for name in data.block.fixed_names]
    spring = kinds.index("k_inf")
    columns = np.column_stack(
        (
            evaluation.fixed[:, spring],
            evaluation.arms[:, arms],
            evaluation.d_arms[:, arms] * model.k,
        )
    )
    if isinstance(solid, FractionalZener):
        columns = columns @ solid.arm_gradient()
    private = [i for i in range(len(kinds)) if i != spring]
    quiet = replace(data.terms, known={**data.terms.known, "drift": data.drift})
    rows = quiet.rows(data.block, 1 / data.weight)
    matrix = np.zeros((rows.samples, len(kinds)))
    matrix[:, [data.block.fixed_names.index(name) for name in rows.fixed_names]] = rows.evaluate(
        np.zeros(0)
    ).fixed
    unmeasured = np.zeros((len(columns), 0))
    if adds is not None:
        unmeasured = adds.columns(evaluation.fixed, evaluation.arms[:, len(base) :])
    if "drift" in kinds:
        # of the drift itself, what the fit holds to be less than it may be
        more = data.terms.known["drift"].beyond(data.drift)
        drift = replace(data.terms, known={"drift": more})
        unmeasured = np.hstack(
            (unmeasured, drift.doubts(evaluation.fixed, data.block.fixed_names)[0])
        )
    return _TestColumns(
        data.weight * columns,
        data.weight * evaluation.fixed[:, private],
        data.weight * matrix[:, private],
        data.weight * unmeasured,
    )


def compute_clock_sensitivity(tests: Sequence[RampHold], model: GeneralizedMaxwell) -> FloatArray:
    r"""Return what late forces add to the parameters of a solid fitted to holds, shape (p, 1).

    A hold that begins :math:`\delta` late has arms of :math:`k\,e^{\delta/\tau}`. The end of a ramp
    is as late as the clocks are apart, and as the encoder's step leaves it.
    """
    late = [
        np.hypot(
            delay_prior(test).sd, test.encoder_step / np.sqrt(12) * test.ramp_time / test.depth
        )
        for test in tests
    ]
    k, tau = np.asarray(model.k), np.asarray(model.tau)
    change = np.concatenate(([0.0], k / tau, np.zeros(len(k))))
    return np.asarray(np.sqrt(np.mean(np.square(late)) / len(tests)) * change)[:, None]
