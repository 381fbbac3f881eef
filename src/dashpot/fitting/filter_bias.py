"""What a filter did to the parameters of a relaxation test."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dashpot.base.checks import Check
from dashpot.base.choices import Method
from dashpot.base.errors import DashpotError, FitError
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.checks import relaxation as checks
from dashpot.fitting.design_matrix import NUISANCE, FitSetup, compress_tests, eq5_obstacle, solid_of
from dashpot.fitting.fit_data import data_of
from dashpot.fitting.pipeline import FitOptions, select_order
from dashpot.numerics.exponential_fit.variable_projection import solve
from dashpot.preprocessing.filters import Filter, filter_of, filter_record
from dashpot.solids.maxwell import GeneralizedMaxwell


def filter_bias(test: RampHold) -> Check:
    """What its filter did to each parameter, predicted on the noise-free answer of the seal.

    The solid is fitted to the unfiltered record; its exact answer to the recorded motion is
    fitted again, before and behind the filter, by eq. 5 and by the full history.

    Parameters
    ----------
    test : RampHold
        Filtered, with the record before the filter in ``unfiltered``.
    """
    raw, by = test.unfiltered, filter_of(test)
    if raw is None or by is None:
        return checks.filter_bias(None)
    try:
        model = _select_supported_solid(raw)
        clean = replace(
            raw,
            force=model.force(raw.time, raw.displacement),
            machine=Machine(),
            given=None,
            checks=(),
        )
        changes = {
            "hold": _changes(clean, by, model.arms, "hold"),
            "full": _changes(clean, by, model.arms, "full"),
        }
    except DashpotError as error:
        return checks.filter_bias(by, str(error))
    return checks.filter_bias(by, changes, min(model.tau, default=np.inf))


def _select_supported_solid(record: RampHold) -> GeneralizedMaxwell:
    """Return the solid with as many arms as the record supports."""
    return select_order(data_of([record], FitSetup("full")), FitOptions()).model


def _changes(clean: RampHold, by: Filter, arms: int, method: Method) -> dict[str, float]:
    """Relative change of each parameter that the filter makes; -1 where an arm is lost."""
    behind = filter_record(clean, by)
    if method == "hold":
        # eq. 5 takes the ramp from its corners, which were found before the filter
        behind = replace(behind, displacement=clean.displacement)
    before, after = (_solve_parameters(record, arms, method) for record in (clean, behind))
    return {
        name: after[name] / value - 1 if name in after else -1.0
        for name, value in before.items()
        if value > 0
    }


def _solve_parameters(record: RampHold, arms: int, method: Method) -> dict[str, float]:
    """Return every parameter of the solid with so many arms by its name."""
    obstacle = eq5_obstacle(record) if method == "hold" else None
    if obstacle is not None:
        raise FitError(obstacle)
    model = solid_of(
        solve(
            compress_tests([record], FitSetup(method, NUISANCE if method == "full" else ())), arms
        )
    )
    named = {"k_inf": model.k_inf}
    for j, (k, tau) in enumerate(zip(model.k, model.tau, strict=True), start=1):
        named |= {f"k_{j}": k, f"tau_{j}": tau}
    return named
