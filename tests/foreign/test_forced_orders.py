"""A number of arms that is asked for: doubted below the truth, kept where it is enough."""

from __future__ import annotations

import pytest
from kit.foreign.curves import Curve
from kit.foreign.forced_orders import KINDS, ForcedOrder, generate_forced_orders

import dashpot as dp
from dashpot.extensions.curves.creep.fit import fit_creep
from dashpot.extensions.curves.dynamic.fit import fit_dynamic
from dashpot.extensions.curves.modulus.fit import fit_modulus


def fit_order(forced_order: ForcedOrder, arms: int) -> dp.Fit:
    """The fit of a test by so many arms."""
    test = forced_order.test
    if not isinstance(test, Curve):
        record = dp.RelaxationTest(test.time, test.displacement, test.force, units="SI")
        return dp.fit(record, arms=arms)
    if test.kind == "curve":
        return fit_modulus(test.at, test.values, arms=arms)
    if test.kind == "creep":
        compliance = dp.CreepCompliance(test.at, test.values, unit="1/Pa", units="SI")
        return fit_creep(compliance, arms=arms)
    return fit_dynamic(dp.DynamicTest(test.at, *test.values, unit="Pa", units="SI"), arms=arms)


def list_failed_checks(fit: dp.Fit) -> set[str]:
    return {check.name for check in fit.checks if check.failed}


@pytest.mark.parametrize("kind", KINDS)
def test_fewer_arms_than_the_truth_are_no_use_and_as_many_are(kind: str) -> None:
    for forced_order in generate_forced_orders(kind, 3, seed=5):
        for arms in range(1, forced_order.arms):
            fit = fit_order(forced_order, arms)
            assert fit.verdict.use != "use", (forced_order.arms, arms)
            assert "arms_enough" in list_failed_checks(fit)
        enough = fit_order(forced_order, forced_order.arms)
        assert enough.verdict.use == "use", enough.verdict
        assert "arms_enough" not in list_failed_checks(enough)


def test_the_check_says_what_either_number_leaves_and_which_to_take() -> None:
    item = next(generate_forced_orders("ramp and hold", 1, seed=6))
    check = next(check for check in fit_order(item, 1).checks if check.name == "arms_enough")
    assert check.message.startswith("1 arm leaves ")
    assert "2 arms leave " in check.message
    assert check.remedy is not None
    assert check.remedy.words == "Use 2 arms."


def test_a_misfit_that_leaves_few_independent_samples_is_no_noise() -> None:
    """Of one arm for two without any noise the residuals are equal to a handful of samples."""
    test = dp.simulate("relaxation", hold="40s", noise_free=True)
    fit = dp.fit(test, arms=1)
    assert {"arms_enough", "samples_independent"} <= list_failed_checks(fit)
    assert fit.verdict.use != "use"
