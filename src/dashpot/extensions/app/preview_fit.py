"""Fit of a time range from that of the one before, while a handle is dragged."""

from __future__ import annotations

import numpy as np

from dashpot.base.option_fields import Method
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.data_blocks import build_fit_data, fit_all_orders
from dashpot.fitting.fit_options import FitOptions
from dashpot.fitting.nonlinear_ramp.linearity import DelayedMotion, HoldBlocks
from dashpot.fitting.relaxation import build_point_fit, build_setup


def refit_nearby(test: RampHold, fit: Fit) -> Fit:
    """Return the optimum of a test from the fit of another time range of it, as a preview.

    The descent starts at the relaxation times of `fit`, with its number of arms and its linear law.

    Parameters
    ----------
    test : RampHold
    fit : Fit
        Fit of the same test, by arms, with a linear law.

    Raises
    ------
    FitError
        If the test has fewer samples than such a fit has parameters.
    """
    log_tau = np.log(fit.model.tau)
    arms = len(log_tau)
    method: Method = "hold" if fit.method == "hold" else "full"
    setup = build_setup([test], FitOptions(arms, method, max_arms=arms))
    motion = DelayedMotion(HoldBlocks([test]), build_fit_data([test], setup, log_tau), (0.0,))
    initial_fit = fit_all_orders(motion.data, arms, only_max_arms=True, log_tau_start=log_tau)
    return build_point_fit(motion, initial_fit.solutions[: arms + 1][-1], setup, arms)
