"""The dense spectrum of a sweep that no small number of arms follows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dashpot.checks import Check
from dashpot.relaxation.dynamic import DynamicTest
from dashpot.relaxation.fit import Fit, Residual, Status
from dashpot.relaxation.spectrum import dynamic_master_curve, relative_scale
from dashpot.solids.maxwell import GeneralizedMaxwell

# curves missed by more than this are not followed, and a dense spectrum must miss far less
_FOLLOWED, _MUCH_BETTER = 0.05, 0.5


def dense_where_few_fail(few: Fit, data: DynamicTest) -> Fit:
    """Return the fit, or the dense spectrum where no small number of arms follows the curves."""
    missed = _relative_rms(few.model, data)
    if missed < _FOLLOWED:
        return few
    dense = dynamic_master_curve(data)
    if dense.rms > _MUCH_BETTER * missed:
        return few
    says = (
        f"no number of arms up to {max(order.arms for order in few.orders)} follows the curves: "
        f"{few.model.arms} leave {100 * missed:.2g} % rms. This is the dense spectrum on an even "
        f"grid, {dense.model.arms} arms that leave {100 * dense.rms:.2g} %: a table for a solver, "
        "whose single arms mean nothing"
    )
    values = 2 * len(data.frequency)
    return replace(
        few,
        model=dense.model,
        status=Status.NOT_IDENTIFIED,
        residual=Residual(values, values * dense.rms**2, dense.rms),
        parameters=(),
        covariance=np.zeros((0, 0)),
        dof=float("inf"),
        certificate=None,
        profiles=(),
        checks=(*few.checks, Check("few_arms_suffice", False, says, missed, _FOLLOWED)),
    )


def _relative_rms(model: GeneralizedMaxwell, data: DynamicTest) -> float:
    """Return the root mean square relative error of storage and loss together."""
    K = model.complex_stiffness(2 * np.pi * data.frequency)
    storage, loss = relative_scale(data)
    errors = np.concatenate(((K.real - data.storage) / storage, (K.imag - data.loss) / loss))
    return float(np.sqrt(np.mean(errors**2)))
