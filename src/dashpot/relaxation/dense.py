"""The dense spectrum of curves that no small number of arms follows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.checks import Check
from dashpot.relaxation.fit import Fit, Residual, Status
from dashpot.relaxation.spectrum import MasterCurve

# curves missed by more than this are not followed, and a dense spectrum must miss far less
_FOLLOWED, _MUCH_BETTER = 0.05, 0.5


def dense_where_few_fail(few: Fit, error: FloatArray, spectrum: Callable[[], MasterCurve]) -> Fit:
    """Return the fit, or the dense spectrum where no small number of arms follows the curves.

    Parameters
    ----------
    few : Fit
    error : array, shape (n,)
        Its relative errors on every value of the curves.
    spectrum : callable
        Fits the dense spectrum.
    """
    missed = float(np.sqrt(np.mean(error * error)))
    if missed < _FOLLOWED:
        return few
    dense = spectrum()
    if dense.rms > _MUCH_BETTER * missed:
        return few
    says = (
        f"no number of arms up to {max(order.arms for order in few.orders)} follows the curves: "
        f"{few.model.arms} leave {100 * missed:.2g} % rms. This is the dense spectrum on an even "
        f"grid, {dense.model.arms} arms that leave {100 * dense.rms:.2g} %: a table for a solver, "
        "whose single arms mean nothing"
    )
    values = len(error)
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
