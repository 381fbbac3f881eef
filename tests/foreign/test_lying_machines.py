"""Blank tests of machines that are not what they seem: none is silently used."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from kit.foreign.lying_machines import (
    Channels,
    TrueMachine,
    bump_force,
    change_machine,
    draw_machine,
    make_empty_record,
    make_spring_record,
    make_stop_record,
    relax_force,
    rub_force,
    step_force,
    turn_signs,
)

from dashpot.extensions.blank_tests.datamodel import BlankTest, MachineFit
from dashpot.extensions.blank_tests.fit import fit_blank_tests

SPRING = 1000.0
SEEDS = (0, 1)
Change = Callable[[Channels], Channels]
FAULTS: dict[str, tuple[str, Change]] = {
    "stop relaxes": ("stop", lambda record: relax_force(record, 0.03, 8.0)),
    "spring relaxes": ("spring", lambda record: relax_force(record, 0.01, 8.0)),
    "stop rubs": ("stop", lambda record: rub_force(record, 0.03)),
    "spring rubs": ("spring", lambda record: rub_force(record, 0.005)),
    "zero jumps under the spring": ("spring", lambda record: step_force(record, 0.02, 20.0)),
    "leant on beside the spring": ("spring", lambda record: bump_force(record, 0.05, 15.0, 2.0)),
    "leant on in the empty run": ("empty", lambda record: bump_force(record, 0.02, 25.0, 3.0)),
    "zero jumps in the empty run": ("empty", lambda record: step_force(record, 0.03, 30.0)),
}


def measure(machine: TrueMachine, seed: int, spring: float = SPRING) -> dict[str, Channels]:
    return {
        "stop": make_stop_record(machine, seed),
        "spring": make_spring_record(machine, seed, spring),
        "empty": make_empty_record(machine, seed),
    }


def fit(records: dict[str, Channels]) -> MachineFit:
    tests = [BlankTest(*record, units="SI") for record in records.values()]
    return fit_blank_tests(tests, spring_stiffness=SPRING)


@pytest.mark.parametrize("seed", SEEDS)
def test_honest_machine_is_used_and_measured(seed: int) -> None:
    machine = draw_machine(seed)
    result = fit(measure(machine, seed))
    assert result.verdict.use == "use"
    assert result["gain"].value == pytest.approx(machine.gain, abs=0.002)
    assert result["compliance"].value == pytest.approx(machine.compliance, rel=0.03)
    assert result["delay"].value == pytest.approx(machine.delay, abs=0.2e-3)


@pytest.mark.parametrize("fault", FAULTS)
def test_faulty_blank_test_is_not_used(fault: str) -> None:
    role, change = FAULTS[fault]
    for seed in SEEDS:
        records = measure(draw_machine(seed), seed)
        records[role] = change(records[role])
        assert fit(records).verdict.use != "use", seed


def test_machine_that_gives_more_under_a_small_force_is_not_used() -> None:
    machine = change_machine(draw_machine(1), toe=0.5)
    assert fit(measure(machine, 1)).verdict.use != "use"


def test_spring_that_is_off_by_more_than_a_class_of_cells_is_not_used() -> None:
    """Below that a wrong spring and a wrong cell are one; the gain has the error of the spring."""
    machine = change_machine(draw_machine(1), gain=1.0)
    assert "gain_plausible" in fit(measure(machine, 1, 0.95 * SPRING)).verdict.reasons
    result = fit(measure(machine, 1, 1.01 * SPRING))
    assert result.verdict.use == "use"
    assert result["gain"].value == pytest.approx(1.01, abs=0.002)


@pytest.mark.parametrize(("displacement", "force"), [(-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)])
def test_signs_of_the_channels_do_not_matter(displacement: float, force: float) -> None:
    records = measure(draw_machine(0), 0)
    plain = fit(records)
    turned = fit(
        {role: turn_signs(record, displacement, force) for role, record in records.items()}
    )
    for name in ("compliance", "creep", "gain", "delay"):
        assert turned[name].value == pytest.approx(plain[name].value, rel=1e-6, abs=1e-9)
    assert turned.verdict.use == "use"
