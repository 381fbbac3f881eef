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


def rig_sensitivity(
    relaxations: Sequence[RelaxationData], solid: Solid, *, apart: bool = False
) -> FloatArray:
    """Return what each doubt of each test adds to the parameters of a solid fitted to them.

    Parameters
    ----------
    relaxations : sequence of RelaxationData
        With what their rigs may add (`RelaxationData.unseen`), and as the solid was fitted.
    solid : Solid
        Its parameters are k_inf, every k, every ln tau, or those of a fractional solid; N/m and s.
    apart : bool
        Each test has stiffnesses of its own, one test's below another's, and the relaxation times
        are those of all.

    Returns
    -------
    array, shape (p, d)
        One standard deviation a column; all are independent.
    """
    each = [_rows(data, solid) for data in relaxations]
    whole = each[0].solid.shape[1]
    stiff = 1 + solid.maxwell.arms if apart else 0
    own = whole + stiff * (len(each) - 1)
    shared = np.arange(own - whole + stiff, own)
    width = own + sum(one.private.shape[1] for one in each)
    jacobians, first = [], own
    for i, one in enumerate(each):
        rows, here = len(one.solid), slice(first, first + one.private.shape[1])
        J = np.zeros((rows + len(one.known), width))
        J[:rows, np.r_[i * stiff : (i + 1) * stiff, shared]] = one.solid
        J[:rows, here], J[rows:, here] = one.private, one.known
        jacobians.append(J)
        first = here.stop
    known = directions(jacobians)
    moves = [
        known.turn @ (columns.matrix[: len(one.unseen)].T @ one.unseen)
        for one, columns in zip(each, known.columns, strict=True)
    ]
    return np.hstack(moves)[:own]


def _rows(data: RelaxationData, solid: Solid) -> _TestColumns:
    model, adds = solid.maxwell, data.unseen
    further = np.zeros(0) if adds is None else adds.log_tau
    # arms of a fractional solid lie beyond what a record shows, too: there they are all alike
    own, arms = np.unique(
        np.clip(np.log(model.tau), *np.log(data.block.window)), return_inverse=True
    )
    # coordinates may change from call to call: all that is compared is of one
    found = data.block.evaluate(np.concatenate((own, further)))
    kinds = [kind_of(name) for name in data.block.fixed_names]
    spring = kinds.index("k_inf")
    columns = np.column_stack(
        (found.fixed[:, spring], found.arms[:, arms], found.d_arms[:, arms] * model.k)
    )
    if isinstance(solid, FractionalZener):
        columns = columns @ solid.arm_gradient()
    private = [i for i in range(len(kinds)) if i != spring]
    quiet = replace(data.terms, known={**data.terms.known, "drift": data.drift})
    rows = quiet.rows(data.block, 1 / data.weight)
    known = np.zeros((rows.samples, len(kinds)))
    known[:, [data.block.fixed_names.index(name) for name in rows.fixed_names]] = rows.evaluate(
        np.zeros(0)
    ).fixed
    unseen = np.zeros((len(columns), 0))
    if adds is not None:
        unseen = adds.columns(found.fixed, found.arms[:, len(own) :])
    if "drift" in kinds:
        # of the drift itself, what the fit holds to be less than it may be
        more = data.terms.known["drift"].beyond(data.drift)
        drift = replace(data.terms, known={"drift": more})
        unseen = np.hstack((unseen, drift.doubts(found.fixed, data.block.fixed_names)[0]))
    return _TestColumns(
        data.weight * columns,
        data.weight * found.fixed[:, private],
        data.weight * known[:, private],
        data.weight * unseen,
    )


def clock_sensitivity(tests: Sequence[RampHold], model: GeneralizedMaxwell) -> FloatArray:
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
