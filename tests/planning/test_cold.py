"""The planned test repeated in the cold: the table computed apart, its slopes, its advice."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from kit.plans import make_bench_plan

from dashpot.base.errors import DataError
from dashpot.datamodel.machine import Machine
from dashpot.extensions.curves.temperatures.planned_repeats import build_planned_rows, plan_repeat
from dashpot.planning.plan import Plan
from dashpot.planning.planned_ramp_hold import Bench, PlannedRows, Repeat
from dashpot.solids.demo_seals import BROAD, HIDDEN, SHIFT
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.shift_laws import Arrhenius

AMBIENT = SHIFT.reference
AT = 12.71


def loss_factor_sd(solid: GeneralizedMaxwell, rows: np.ndarray) -> float:
    """Relative, at 12.71 Hz, by the inverse of the information and slopes by differences."""
    p = np.array([solid.k_inf, *solid.k, *np.log(solid.tau)])
    n = solid.arms

    def loss_factor(q: np.ndarray) -> float:
        model = GeneralizedMaxwell(q[0], tuple(q[1 : 1 + n]), tuple(np.exp(q[1 + n :])))
        return float(model.loss_factor(omega=2 * np.pi * AT))

    slope = np.zeros(rows.shape[1])
    for i in range(len(p)):
        step = np.zeros(len(p))
        step[i] = 1e-6 * max(1.0, abs(p[i]))
        slope[i] = (loss_factor(p + step) - loss_factor(p - step)) / (2 * step[i])
    half = np.linalg.lstsq(rows.T / np.linalg.norm(rows, axis=0)[:, None],
                           slope / np.linalg.norm(rows, axis=0), rcond=1e-13)[0]  # fmt: skip
    return float(np.linalg.norm(half)) / loss_factor(p)


def make_bench(method: str = "full", machine: Machine | None = None) -> Bench:
    return Bench(8e-3, 1.0, 40.0, 1000.0, 5e-3, method, 1.0, machine)


def places(*celsius: float, b_t: float | None = None) -> list[Repeat]:
    repeats = [plan_repeat(value + 273.15, AMBIENT, SHIFT) for value in celsius]
    return repeats if b_t is None else [Repeat(e.temperature, e.a_t, b_t) for e in repeats]


@pytest.mark.parametrize(
    ("cold", "hold", "full"),
    [((), 1.07, 0.38), ((10,), 0.078, 0.026), ((0,), 0.0062, 0.0024), ((-10,), 0.0008, 0.0006)],
)
def test_planned_cold_test_reproduces_the_reference_table(cold, hold, full):
    """By the force alone, b_T free about 1, every arm shifting alike; two digits at most."""
    for method, expected in (("hold", hold), ("full", full)):
        rows = build_planned_rows(
            HIDDEN, make_bench(method), places(*cold, b_t=1.0), slope_sd=0.0
        ).rows
        assert loss_factor_sd(HIDDEN, rows) == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize(("cold", "expected"), [((), 0.57), ((10,), 0.050), ((0,), 0.0047)])
def test_with_offset_drift_and_a_delay_in_each_record(cold, expected):
    class Half(Bench):
        def prior_sd(self, model: GeneralizedMaxwell) -> np.ndarray:
            return np.array([*super().prior_sd(model)[:2], 0.5e-3])

        def rows(
            self, model: GeneralizedMaxwell, *, has_several_tests: bool = False
        ) -> PlannedRows:
            return super().rows(model)  # of a seal that keeps its temperature

    bench = Half(8e-3, 1.0, 40.0, 1000.0, 5e-3, "full", 1.0, Machine())
    rows = build_planned_rows(HIDDEN, bench, places(*cold, b_t=1.0), slope_sd=0.0).rows
    assert loss_factor_sd(HIDDEN, rows) == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize(
    ("solid", "celsius", "slope_sd", "expected"),
    [
        (HIDDEN, (0,), 0.0, 0.0051), (HIDDEN, (10,), 0.0, 0.055), (BROAD, (0,), 0.0, 0.0124),
        (BROAD, (10, 0), 0.0, 0.0120), (HIDDEN, (0,), 0.03, 0.0061),
    ],
)  # fmt: skip
def test_the_errors_that_joint_fits_of_another_program_gave(solid, celsius, slope_sd, expected):
    """b_T = T/T_r; offset known to 0.22 mN, no drift, delay to 1 ms."""

    class StatedBench(Bench):
        def prior_sd(self, model: GeneralizedMaxwell) -> np.ndarray:
            return np.array([5e-3 / np.sqrt(500), 1e-9, 1e-3])

        def rows(
            self, model: GeneralizedMaxwell, *, has_several_tests: bool = False
        ) -> PlannedRows:
            return super().rows(model)  # of a seal that keeps its temperature

    bench = StatedBench(8e-3, 1.0, 40.0, 1000.0, 5e-3, "full", 0.5, Machine())
    rows = build_planned_rows(solid, bench, places(*celsius), slope_sd).rows
    assert loss_factor_sd(solid, rows) == pytest.approx(expected, rel=0.04)


def test_the_sensitivities_are_slopes_of_both_forces():
    """By differences of two records, each with its offset, drift and delay, in every unknown."""
    there = Repeat(273.15, 7.0, 0.9)
    machine = Machine(sync=1e-3, drift=1e-3)
    bench = Bench(8e-3, 0.5, 5.0, 40.0, 1e-3, "full", 2.0, machine)
    rows = build_planned_rows(HIDDEN, bench, [there], slope_sd=0.03).rows
    t, n = bench.time(), HIDDEN.arms
    p = np.array([HIDDEN.k_inf, *HIDDEN.k, *np.log(HIDDEN.tau), *np.zeros(4),
                  np.log(there.a_t), np.log(there.b_t), *np.zeros(5)])  # fmt: skip

    def force(solid: GeneralizedMaxwell, offset: float, drift: float) -> np.ndarray:
        answer = solid.ramp_hold_force(t, depth=8e-3, ramp_time=0.5)
        return answer + offset + drift * (t + 0.5 * bench.baseline)

    def records(q: np.ndarray) -> np.ndarray:
        tau, (a, b), g = np.exp(q[1 + n : 1 + 2 * n]), np.exp(q[11:13]), q[-1]
        warm = GeneralizedMaxwell(q[0], tuple(q[1 : 1 + n]), tuple(tau))
        variant = tau * a ** (1 + g * np.log10(tau / 0.5))
        cold = GeneralizedMaxwell(b * q[0], tuple(b * q[1 : 1 + n]), tuple(variant))
        return np.concatenate((force(warm, *q[7:9]), force(cold, *q[13:15])))

    # delays and a seal that warms have tests of their own
    keep = [i for i in range(len(p)) if i not in {9, 10, 15, 16}]
    columns = []
    for i in keep:
        step = np.zeros(len(p))
        step[i] = 1e-5 * max(1.0, abs(p[i]))
        columns.append((records(p + step) - records(p - step)) / (2 * step[i]))
    J = np.array(columns).T / bench.noise
    shift = HIDDEN.shift_to_temperature(there.a_t, there.b_t)
    stated = np.zeros((7, len(p)))
    stated[:3, 7:10] = np.diag(1 / bench.prior_sd(HIDDEN))
    stated[3:6, 13:16] = np.diag(1 / bench.prior_sd(shift))
    stated[6, 17] = 1 / 0.03
    expected = J.T @ J + (stated.T @ stated)[np.ix_(keep, keep)]
    information = (rows.T @ rows)[np.ix_(keep, keep)]
    scale = np.sqrt(np.diag(expected))
    np.testing.assert_allclose(
        information / np.outer(scale, scale), expected / np.outer(scale, scale), atol=2e-6
    )


def test_unknown_shift_slope_widens_the_error():
    rows = [build_planned_rows(HIDDEN, make_bench(), places(0), sd).rows for sd in (0.0, 0.03, 0.3)]
    expected, usual_doubt, unknown = (loss_factor_sd(HIDDEN, row) for row in rows)
    assert expected < usual_doubt < unknown


def make_plan(**changes: object) -> Plan:
    return make_bench_plan(**({"at": AT, "model": HIDDEN} | changes))


def test_the_plan_puts_the_cold_test_into_its_table():
    plan = make_plan(cold="0degC")
    assert plan.expected.repeated == (273.15,)
    assert [place.temperature for place in plan.repeats] == [273.15]
    shown = [(e.method, e.repeated) for e in plan.alternatives]
    assert shown[:3] == [("full", ()), ("hold", (273.15,)), ("hold", ())]
    single = make_plan().expected.loss_factor_sd
    assert plan.alternatives[0].loss_factor_sd == single
    # what the rig may do without a trace, in the cold and at room temperature, is as much as the
    # noise again
    rows = build_planned_rows(HIDDEN, make_bench(machine=Machine()), places(0)).rows
    assert plan.expected.loss_factor_sd > 1.5 * loss_factor_sd(HIDDEN, rows)
    quiet = make_plan(cold="0degC", force_alone=True).expected.loss_factor_sd
    bare = loss_factor_sd(HIDDEN, build_planned_rows(HIDDEN, make_bench(), places(0)).rows)
    assert quiet == pytest.approx(bare, rel=1e-4)
    assert plan.advice[0] == (
        "Repeat it at 0 degC and fit all together. The loss factor at 12.71 Hz is then known to "
        "±1.77 % instead of ±82.8 %, if all arms shift alike."
    )
    assert plan.advice[1] == (
        "Test at a third temperature, such as 10 degC, too. Two temperatures cannot show arms "
        "that shift apart."
    )
    assert str(plan).splitlines()[2].endswith("1.77 %  and at 0 degC")
    assert plan.band == pytest.approx((1 / (80 * np.pi), SHIFT.a_t(273.15) / np.pi))


def test_three_temperatures_are_advised_no_further():
    plan = make_plan(cold=(273.15, "10degC"))
    assert plan.advice[0].startswith("Repeat it at 0 and 10 degC and fit all together")
    assert not any("third" in line for line in plan.advice)
    shown = [(e.method, e.repeated) for e in plan.alternatives]
    assert shown[1:3] == [("full", (273.15,)), ("full", (283.15,))]
    assert plan.expected.loss_factor_sd < plan.alternatives[1].loss_factor_sd


def test_plan_recommends_a_cold_test():
    plan = make_plan()
    alternative = plan.alternatives[-2]
    assert alternative.repeated == (273.15,)
    assert "epeat it at 0 degC (±1.77 %)" in plan.advice[0]
    assert make_plan(model=BROAD, ramp_time=0.01).advice[0].startswith("Record each hit")


@pytest.mark.parametrize(("celsius", "choices"), [(10.01, True), (9.99, False), (-5.0, False)])
def test_plan_recommends_a_refrigerator_only_for_a_warm_room(celsius, choices):
    plan = make_plan(temperature=celsius + 273.15)
    assert any(e.repeated for e in plan.alternatives) == choices
    glassy = make_plan(law=type(SHIFT).universal(glass=263.16, reference=AMBIENT))
    assert not any(e.repeated for e in glassy.alternatives)


@pytest.mark.parametrize(
    ("cold", "message"),
    [
        (
            "60degC",
            "hardly improves the loss factor at 12.71 Hz: ±82.2 % instead of ±82.8 %. Test in",
        ),
        ("27.2degC", "A repeat at 27.2 degC hardly improves"),
        ("26.4degC", "Repeat it at 26.4 degC and fit all together"),
    ],
)
def test_a_repeat_that_is_worth_nothing_is_not_advised(cold, message):
    words = make_plan(cold=cold).advice
    assert message in words[0]
    assert any("third" in line for line in words) == words[0].startswith("Repeat it")
    assert ("Test in the cold instead" in words[0]) == words[0].startswith("A repeat")


def test_a_hot_test_shows_the_slow_arms():
    """Something slower than the hold is known better where it is faster."""
    slow = HIDDEN + GeneralizedMaxwell(0.0, (20.0,), (300.0,))
    warm = make_plan(model=slow, at=0.001, cold="60degC")
    assert warm.expected.loss_factor_sd < 0.3 * warm.alternatives[0].loss_factor_sd
    assert warm.band[0] < 1 / (80 * np.pi)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"cold": "23degC"}, "expected another temperature"),
        ({"cold": 296.15 + 0.4999}, "expected another temperature"),
        ({"cold": "-45.01degC"}, "nearer than 10 K to the glass transition"),
        ({"cold": float("nan")}, "cold = nan"),
        ({"cold": (273.15, -4.0)}, "cold = -4.0"),
        ({"temperature": 0.0}, "temperature = 0.0"),
        ({"cold": (273.15, 283.15, 273.15)}, "0 degC and at 0 degC, which is one temperature"),
        ({"cold": (273.15, 273.65)}, "which is one temperature"),
    ],
)
def test_what_cannot_be_is_refused(changes, words):
    with pytest.raises(DataError, match=words):
        make_plan(**changes)


def test_just_what_can_be_is_not():
    assert len(make_plan(cold=(273.15, 273.6501)).repeats) == 2
    for kelvin, law in itertools.product(
        (296.15 + 0.5001, 228.15), (SHIFT, Arrhenius(6e4, AMBIENT))
    ):
        assert plan_repeat(kelvin, AMBIENT, law).temperature == kelvin
    # the solid is that at room temperature, wherever the law's reference lies
    there = plan_repeat(273.15, 283.15, SHIFT)
    assert there.a_t == pytest.approx(float(SHIFT.a_t(273.15) / SHIFT.a_t(283.15)))
    assert there.b_t == 273.15 / 283.15
