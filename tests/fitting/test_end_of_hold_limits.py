"""What a relaxation test knows of its end, and what it leaves open."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from kit.fits import a_fit

from dashpot.datamodel.bounds import EndOfHold
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.prepare import prepare
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import BROAD, PAPER
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.workflow.json_archive import from_json, to_document, to_json


def with_slow_arm(tau: float) -> GeneralizedMaxwell:
    """The paper's seal, 20 N/m of its k_inf an arm that a hold hardly sees."""
    return GeneralizedMaxwell(176.5, (*PAPER.k, 20.0), (*PAPER.tau, tau))


def press_seal(solid: GeneralizedMaxwell, *, hold: float = 40.0, seed: int = 0) -> RampHold:
    # a drift of a third of what is taken for possible where nothing is known of it
    rig = replace(Rig(), drift=2e-3 * 1.5 / hold)
    return prepare(simulate_relaxation(solid, seed=seed, hold_time=hold, rig=rig).test)


@pytest.mark.parametrize(("tau", "hold"), [(60.0, 40.0), (300.0, 40.0), (300.0, 120.0)])
@pytest.mark.parametrize("method", ["full", "hold"])
def test_limits_contain_an_arm_slower_than_the_hold(tau: float, hold: float, method: str) -> None:
    """The fit's own k_inf misses the truth; what is left open holds it."""
    solid, test = with_slow_arm(tau), press_seal(with_slow_arm(tau), hold=hold)
    result = fit(test, method=method)
    assert result.model.k_inf > 1.005 * solid.k_inf
    stiffness_limits, T = result.stiffness_limits, test.hold_time
    assert stiffness_limits is not None
    assert stiffness_limits["k_inf"][0] == 0.0 < solid.k_inf < stiffness_limits["k_inf"][1]
    for (low, high), at in ((stiffness_limits["k_end"], T), (stiffness_limits["k_3end"], 3 * T)):
        assert low < solid.relaxation(at) < high
    assert np.ptp(stiffness_limits["k_3end"]) > np.ptp(stiffness_limits["k_end"])
    check = next(check for check in result.checks if check.name == "hold_long_enough")
    assert check.failed


def test_a_hold_that_is_long_enough_passes() -> None:
    result = fit(press_seal(PAPER, hold=120.0))
    assert next(c for c in result.checks if c.name == "hold_long_enough").passed


def test_stated_drift_narrows_the_end_of_the_hold() -> None:
    """A free drift is what hides the end: the data sheet's narrows it."""
    test = press_seal(PAPER)
    rigid = {"compliance": 0.0, "creep": 0.0, "rest": 1e5}
    free = fit(replace(test, machine=Machine(**rigid))).stiffness_limits
    stiffness_limits = fit(replace(test, machine=Machine(drift=1e-5, **rigid))).stiffness_limits
    assert free is not None
    assert stiffness_limits is not None
    assert np.ptp(stiffness_limits["k_end"]) < 0.7 * np.ptp(free["k_end"])
    assert np.ptp(stiffness_limits["k_3end"]) < 0.7 * np.ptp(free["k_3end"])


def test_no_weight_of_the_best_at_k_inf_is_no_limit_of_zero() -> None:
    """A power law flows on: the best spectrum has no spring, yet one may be there."""
    tau = np.geomspace(1e-3, 1e4, 40)
    solid = GeneralizedMaxwell(0.0, tuple(30 * tau**-0.15), tuple(tau))
    stiffness_limits = fit(press_seal(solid)).stiffness_limits
    assert stiffness_limits is not None
    assert stiffness_limits["k_inf"][1] > 0.3 * stiffness_limits["k_end"][1]
    assert stiffness_limits["k_end"][0] < solid.relaxation(40.0) < stiffness_limits["k_end"][1]


def test_several_tests_share_what_they_know() -> None:
    item, two = (press_seal(BROAD, seed=seed) for seed in (1, 2))
    stiffness_limits, both = fit(item).stiffness_limits, fit([item, two]).stiffness_limits
    assert stiffness_limits is not None
    assert both is not None
    assert np.ptp(both["k_end"]) < np.ptp(stiffness_limits["k_end"])
    assert both["k_end"][0] < BROAD.relaxation(40.0) < both["k_end"][1]


def test_several_depths_leave_open_what_the_deepest_feels() -> None:
    """The stiffness of a nonlinear law is the secant at the largest compression."""
    rig = replace(Rig(), rate=250.0, bias=0.02, stiffening=4000.0)
    tests = [
        prepare(simulate_relaxation(BROAD, depth=depth, rig=rig, seed=seed).test)
        for depth, seed in ((4e-3, 3), (6e-3, 2), (8e-3, 1))
    ]
    result = fit(tests)
    assert result.elastic_law is not None
    assert result.elastic_law.kind == "piecewise"
    stiffness_limits, truth = result.stiffness_limits, (1 + 4000.0 * 8e-3**2) * BROAD
    assert stiffness_limits is not None
    T = result.evidence.end_of_hold.end_time  # type: ignore[union-attr]
    for name, t in (("k_end", T), ("k_3end", 3 * T)):
        for solid in (truth, result.model):
            assert stiffness_limits[name][0] < solid.relaxation(t) < stiffness_limits[name][1]  # type: ignore[literal-required]
    assert np.ptp(stiffness_limits["k_end"]) < 0.04 * stiffness_limits["k_end"][1]


def test_end_of_hold_round_trips_through_json(broad_fit: Fit) -> None:
    again = from_json(to_json(broad_fit))
    assert again.evidence.end_of_hold == broad_fit.evidence.end_of_hold
    retained = to_document(broad_fit)["end_of_hold_limits"]
    assert retained["k_inf"] == list(broad_fit.stiffness_limits["k_inf"])
    assert set(retained) == {
        "k_inf", "k_end", "k_at_3_end", "end_time", "slope_limit", "if_machine_named",
        "k_at_10_end", "test_kind",
    }  # fmt: skip
    pair = broad_fit.in_parallel(2)
    assert pair.stiffness_limits["k_end"][1] == 2 * broad_fit.stiffness_limits["k_end"][1]


@pytest.mark.parametrize("kind", ["hold", "curve", "creep"])
@pytest.mark.parametrize("shift", [-0.3, -0.02, 0.0, 0.02, 0.3])
def test_limits_that_are_widened_lie_on_both_sides_of_the_fit(kind: str, shift: float) -> None:
    """One of 37 creep tests had k_inf as the upper limit of itself."""
    solid = GeneralizedMaxwell(200.0, (50.0,), (5.0,))
    near = EndOfHold(40.0, (190.0, 210.0), (190.0, 210.0), (0.0, 210.0), k_10end=(190.0, 210.0),
                     test_kind=kind)  # fmt: skip
    limits = {
        name: tuple((1 + shift) * value for value in getattr(near, name))
        for name in ("k_end", "k_3end", "k_10end", "k_inf")
    }
    end = replace(near, **limits).widen_to_contain(solid)
    for name, times in (("k_end", 1), ("k_3end", 3), ("k_10end", 10)):
        low, high = getattr(end, name)
        assert low < end.compute_stiffness(solid, times) < high
        assert low <= limits[name][0]
        assert high >= limits[name][1]
    assert end.k_inf[1] > solid.k_inf
    # again it changes nothing
    assert end.widen_to_contain(solid) == end


def test_end_of_hold_states_determined_and_undetermined_stiffness() -> None:
    end = EndOfHold(40.0, (181.9, 196.9), (153.0, 195.0), (0.0, 195.0), 4.0)
    assert end.format_with_remedy("N/m") == (
        "the stiffness after the hold. At 40.0 s it is 0.1819 to 0.1969 N/mm. It may fall further, "
        "to at most 0.1950 N/mm. Hold longer."
    )
    assert (
        replace(end, if_machine_named=0.2)
        .format_with_remedy("N/m")
        .endswith(
            "0.1950 N/mm. Record a baseline of 10 s, and give the drift, compliance and creep of "
            "the machine and the rest time of the seal before the test: k(40.0 s) is then known "
            "to about 0.8 % instead of 4.0 %."
        )
    )


def test_a_verdict_is_no_surer_of_the_stiffness_than_the_limits_at_the_end_of_the_hold() -> None:
    result = a_fit(PAPER, band=(0.004, 0.32))
    exact = replace(result.estimate, covariance=1e-12 * np.eye(len(result.estimate.parameters)))
    k = float(result.model.relaxation(40.0))
    end = EndOfHold(40.0, (0.95 * k, 1.05 * k), (0.9 * k, k), (0.0, k), 0.1 * k)
    message = replace(result, estimate=exact, evidence=replace(result.evidence, end_of_hold=end))
    assert message._error_in_band[0] == pytest.approx(0.05)
    assert "the stiffness is known to ±5 %" in message.verdict.message
