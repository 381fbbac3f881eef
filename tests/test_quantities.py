"""Where a function takes a number in SI it takes a quantity with its unit, and means the same."""

from __future__ import annotations

import pytest
from kit import handmade

import dashpot as dp
from dashpot.base.units import convert_to_si, si_range
from dashpot.export import TARGETS
from dashpot.fitting.identification.identify import identify
from dashpot.planning.assumed_seal import AssumedSeal
from dashpot.planning.plan import plan
from dashpot.planning.plan_options import HammerPlan
from dashpot.planning.planned_ramp_hold import Bench
from dashpot.preprocessing.prepare import prepare
from dashpot.reading.read_options import ReadOptions
from dashpot.solids.demo_seals import BROAD_MASS, PAPER
from dashpot.vibration.comparison.compare import compare
from dashpot.vibration.modal.dynamic_stiffness import dynamic_stiffness


def test_a_number_is_in_si_and_a_text_has_its_unit():
    assert convert_to_si("104g", "mass") == convert_to_si(0.104, "mass") == 0.104
    assert convert_to_si(None, "mass") is None
    assert si_range(("5Hz", 40.0), "frequency") == si_range("5:40Hz", "frequency") == (5.0, 40.0)
    assert si_range(None, "frequency") is None


SOLID = PAPER.complex_stiffness
CALLS = {
    "predict": lambda m, x, f: dp.systems.predict_frf(handmade.two_arms(), mass=m, compression=x),
    "compare": lambda m, x, f: compare(
        handmade.study().prediction,
        handmade.make_measured_frf(),
        fit=handmade.two_arms(),
        mass=m,
        band=f,
    ),
    "identify": lambda m, x, f: (
        identify(handmade.make_measured_frf(), mass=m, seals=2, arms=1, band=f).model
    ),
    "stiffness": lambda m, x, f: dynamic_stiffness(handmade.make_measured_frf(), m, band=f).storage[
        0
    ],
    "model_at": lambda m, x, f: handmade.two_arms().model_at(x),
    "body": lambda m, x, f: (
        dp.systems.point_mass("block", m),
        dp.systems.planar_body("block", m, 1e-4),
    ),
    "specimen": lambda m, x, f: dp.Specimen(length=x),
    "deck": lambda m, x, f: TARGETS["calculix"](PAPER, units="SI", mass=m, frequency_range=f),
    "table": lambda m, x, f: TARGETS["csv"](PAPER, units="SI", frequency_range=f),
}


@pytest.mark.parametrize("name", CALLS)
def test_quantities_and_numbers_give_the_same(name):
    call = CALLS[name]
    assert call(f"{BROAD_MASS} kg", "2.6mm", "6:30Hz") == call(BROAD_MASS, 2.6e-3, (6.0, 30.0))


def test_a_plan_in_the_words_of_the_bench():
    words = plan(
        Bench(depth="8mm", ramp_time="1s", noise="5mN", machine=dp.Machine(sync="0.5ms")),
        at="12.71Hz",
        seal=AssumedSeal(arm=("0.05N/mm", "12ms"), temperature="23degC"),
        hammer=HammerPlan(mass="104g", record="8s"),
    )
    numbers = plan(
        Bench(8e-3, 1.0, noise=5e-3, machine=dp.Machine(sync=5e-4)),
        at=12.71,
        seal=AssumedSeal(arm=(50.0, 0.012), temperature=296.15),
        hammer=HammerPlan(0.104, record=8.0),
    )
    assert str(words) == str(numbers)
    assert words.arm == pytest.approx(numbers.arm, rel=1e-12)


def test_a_bench_and_a_machine_in_their_words():
    assert dp.Machine(sync="0.5ms", drift="0.2mN/s", force_filter="10Hz") == dp.Machine(
        sync=5e-4, drift=2e-4, force_filter=10.0
    )
    assert dp.Specimen(temperature="23degC").temperature == pytest.approx(296.15)
    assert ReadOptions(rate="1kHz").rate == 1000.0
    made = dp.simulation.simulate_relaxation(PAPER, depth="8mm", ramp_time="1s", hold_time="2s")
    assert made.truth.depth == 8e-3
    test = made.test
    assert prepare(test, contact="0.1mm").depth == prepare(test, contact=1e-4).depth


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: dp.systems.predict_frf(PAPER, mass="104"), "has no unit"),
        (lambda: dp.systems.predict_frf(PAPER, mass="104mm"), "is a unit of length"),
        (lambda: Bench(depth="8s"), "of time"),
        (
            lambda: compare(handmade.make_measured_frf(), handmade.make_measured_frf(), band="5Hz"),
            "low:high",
        ),
        (lambda: dp.Specimen(length="long"), "length|number"),
    ],
)
def test_a_wrong_quantity_is_refused_in_words(call, message):
    with pytest.raises(dp.DataError, match=message):
        call()
