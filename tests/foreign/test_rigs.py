"""Each rig does to a record what its name says, and no more."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from kit.foreign import rigs
from kit.foreign.catalogue import NOISES, RATES, protocol_of, relaxation_records, verdict_records
from kit.foreign.rigs import RIGS, Protocol, Rig, press_seal, read
from kit.foreign.truths import TABLE_1, TRUTHS, Seal, draw_truth

SEAL, SENT = Seal(TABLE_1), Protocol(hold=12.0, rate=250.0)
DRY = Rig(noise=0.0, count=0.0, bias=0.0, encoder=0.0)
RANDOM = np.random.default_rng(0)


def apply_step(step, **words):
    """What one step does to the ideal record, and that record."""
    before = press_seal(SEAL, SENT)
    return step(before, np.random.default_rng(1), **words), before


def test_nothing_of_it_imports_dashpot():
    code = (
        "import sys; from kit.foreign import catalogue, kinds;"
        "print([name for name in sys.modules if name.partition('.')[0] == 'dashpot'])"
    )
    tests = Path(__file__).resolve().parents[1]
    shown = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=tests
    )
    assert shown.stdout.strip() == "[]"


def test_there_are_forty_rigs():
    assert len(RIGS) == 40


@pytest.mark.parametrize("name", RIGS)
def test_a_rig_keeps_its_truth_and_repeats_to_the_byte(name):
    record, again, other = (read(SEAL, SENT, RIGS[name], seed=s, name=name) for s in (1, 1, 2))
    assert record.text() == again.text() != other.text()
    assert len(record.time) == len(record.force) == len(record.pure) == len(record.compression)
    assert np.all(np.isfinite(record.force))
    assert np.all(np.diff(record.time) > 0)
    assert record.seal.solid is TABLE_1
    assert record.k(3) == pytest.approx(
        float(TABLE_1.relaxation(36.0)) + record.seal.friction / record.seal.depth
    )
    assert record.done[-1][0] == "quantise_record"


def test_foreign_record_is_the_truth_plus_noise():
    record = read(SEAL, replace(SENT, hold=40.0), seed=3)
    error = record.force - record.pure - 0.05
    assert np.std(error) == pytest.approx(np.hypot(2e-3, 1 / 1280 / 12**0.5), rel=0.03)
    assert abs(np.mean(error)) < 1e-4
    assert np.max(np.abs(record.displacement - record.compression)) <= 0.5e-6 * (1 + 1e-9)
    assert record.text().startswith("time [s],displacement [mm],force [N]\n0.0,0.0,")


def test_a_ramp_is_where_it_is_sent():
    clock, x = SENT.plate()
    v = np.diff(x) / clock[1]
    assert x[clock <= 1.0].max() == 0.0
    assert np.all(x[clock >= 2.0 - 1e-12] == 8e-3)
    assert v.max() == pytest.approx(8e-3 / 0.9, rel=1e-9)
    _, straight = replace(SENT, rounding=0.0).plate()
    np.testing.assert_allclose(straight, 8e-3 * np.clip(clock - 1, 0, 1), atol=1e-17)
    _, steps = replace(SENT, setpoints=0.02, rounding=0.0).plate()
    assert len(np.unique(steps)) == 51
    _, swung = replace(SENT, servo=(4.0, 0.5), rounding=0.0, ramp=1e-3).plate()
    assert swung.max() == pytest.approx(8e-3 * (1 + np.exp(-np.pi * 0.5 / 0.75**0.5)), rel=1e-3)
    assert swung[-1] == pytest.approx(8e-3)


def test_a_machine_that_gives_is_a_spring_in_series():
    record, before = apply_step(rigs.gives, compliance=50e-6)
    np.testing.assert_allclose(
        record.compression + 50e-6 * record.pure, before.displacement, atol=2e-15
    )
    np.testing.assert_array_equal(record.displacement, before.displacement)
    with pytest.raises(ValueError, match="too large"):
        apply_step(rigs.gives, compliance=1.0)


def test_foreign_crosshead_creep_is_recorded_or_not():
    for seen in (False, True):
        record, before = apply_step(rigs.creeps, by=20e-6, seen=seen)
        crept = 20e-6 * np.log(13.0)
        assert record.compression[-1] - before.compression[-1] == pytest.approx(crept)
        assert record.displacement[-1] - before.displacement[-1] == pytest.approx(crept * seen)
        force = record.seal.force(record.compression, record.step)
        np.testing.assert_array_equal(record.force, force)


def test_a_seal_that_warms_relaxes_by_its_reduced_time():
    item, before = apply_step(rigs.warms, decades=0.12)
    np.testing.assert_allclose(apply_step(rigs.warms, decades=1e-9)[0].pure, before.pure, atol=1e-9)
    # arm by arm: dq/dt = dx/dt - q a(t)/tau, its decay exact in each step
    rate = 0.12 * np.log(10) / before.time[-1]
    reduced = np.expm1(rate * before.time) / rate
    force = TABLE_1.k_inf * before.compression
    for k, tau in zip(TABLE_1.k, TABLE_1.tau, strict=True):
        z, q = np.diff(reduced) / tau, np.zeros_like(reduced)
        for i, dx in enumerate(np.diff(before.compression)):
            q[i + 1] = q[i] * np.exp(-z[i]) - dx * np.expm1(-z[i]) / z[i]
        force = force + k * q
    np.testing.assert_allclose(item.pure, force, atol=1e-6 * force.max())


def test_a_chain_lags_and_filters_by_its_response():
    late, before = apply_step(rigs.late, by=5.25e-3)
    expected = np.interp(before.time - 5.25e-3, before.time, before.force)
    np.testing.assert_array_equal(late.force, expected)
    t = before.time
    for kind, order, gain in [
        ("butter", 1, 0.5**0.5),
        ("butter", 2, 0.5**0.5),
        ("bessel", 4, None),
    ]:
        wave = replace(before, force=1 + np.sin(2 * np.pi * 20 * t))
        passed = rigs.low_pass(wave, RANDOM, cut=20.0, order=order, kind=kind).force
        late = passed[t > 8] - 1
        hypot = np.hypot(
            *(2 * np.mean(late * f(2 * np.pi * 20 * t[t > 8])) for f in (np.sin, np.cos))
        )
        assert hypot == pytest.approx(gain or 0.5**0.5, rel=1e-3)
        # one from the start on, and at last
        assert passed[0] == pytest.approx(1.0)
        still = rigs.low_pass(before, RANDOM, cut=20.0, order=order, kind=kind).force
        assert still[-1] == pytest.approx(before.force[-1], rel=1e-4)


def test_noise_has_its_size_and_memory():
    long = read(SEAL, replace(SENT, hold=300.0), DRY)
    slow = rigs.noisy(long, np.random.default_rng(4), sd=5e-3, tau=0.5).force - long.force
    assert np.std(slow) == pytest.approx(5e-3, rel=0.1)
    assert np.corrcoef(slow[125:], slow[:-125])[0, 1] == pytest.approx(np.exp(-1), abs=0.1)
    white = rigs.noisy(long, np.random.default_rng(4), sd=5e-3).force - long.force
    assert abs(np.corrcoef(white[1:], white[:-1])[0, 1]) < 0.02
    walks = [
        rigs.wanders(long, np.random.default_rng(seed), by=5e-3).force[60 * 250]
        - long.force[60 * 250]
        for seed in range(200)
    ]
    assert np.std(walks) == pytest.approx(5e-3, rel=0.15)


def test_hum_drift_and_wave_have_their_sizes():
    def compute_added_force(step, **words):
        record, before = apply_step(step, **words)
        return before.time, record.force - before.force

    t, hum = compute_added_force(rigs.hums, size=5e-3, hertz=50.0, overtones=2)
    for n, size in [(1, 5e-3), (3, 5e-3 / 3), (5, 5e-3 / 9)]:
        turn = np.exp(2j * np.pi * 50 * n * t[:-1])
        assert abs(2 * np.mean(hum[:-1] * turn)) == pytest.approx(size, rel=1e-6)
    t, drift = compute_added_force(rigs.drifts, rate=5e-4)
    np.testing.assert_allclose(drift, 5e-4 * t, atol=1e-15)
    t, wave = compute_added_force(rigs.waves, size=20e-3, period=6.0)
    assert np.ptp(wave) == pytest.approx(40e-3, rel=1e-5)


def test_readings_come_in_steps_and_rows_are_lost():
    record = read(SEAL, SENT, RIGS["force quantum 10 mN"])
    np.testing.assert_allclose(record.force / 10e-3, np.round(record.force / 10e-3), atol=1e-9)
    record = read(SEAL, SENT, RIGS["encoder 60 um"])
    np.testing.assert_allclose(
        record.displacement / 60e-6, np.round(record.displacement / 60e-6), atol=1e-9
    )
    lost = read(SEAL, SENT, RIGS["dropped rows and jitter"])
    assert len(lost.time) == pytest.approx(0.9 * 250 * 14, rel=0.03)
    assert np.ptp(np.diff(lost.time)) > 4e-3
    # jittered rows are true: of the press's own clock
    true = np.interp(lost.time, *SENT.plate())
    np.testing.assert_allclose(lost.compression, true, atol=1e-12)
    thin = read(SEAL, SENT, RIGS["log-thinned"])
    assert 150 < len(thin.time) < 450
    leap = read(SEAL, SENT, RIGS["clock jump"])
    assert np.sort(np.diff(leap.time))[-2:] == pytest.approx([4e-3, 1e5], rel=1e-3)


def test_where_contact_is():
    gap = read(SEAL, SENT, replace(DRY, protocol={"gap": 0.5e-3}))
    assert gap.displacement.max() == pytest.approx(8.5e-3)
    touch = gap.displacement <= 0.5e-3
    assert np.max(np.abs(gap.pure[touch])) < 1e-15
    assert gap.compression.max() == pytest.approx(8e-3)
    none = read(SEAL, SENT, RIGS["no baseline"])
    assert none.time[0] == pytest.approx(1.0)
    assert none.pure[0] == pytest.approx(0, abs=1e-15)
    assert none.pure[1] > 1e-6


def test_foreign_friction_is_a_share_of_the_equilibrium_force():
    record, plain = (read(SEAL, SENT, replace(DRY, friction=f)) for f in (0.03, 0.0))
    assert record.pure[-1] - plain.pure[-1] == pytest.approx(0.03 * 196.5 * 8e-3)
    assert record.k(np.inf) == pytest.approx(1.03 * 196.5)


def test_a_laws_force_at_rest_is_its_secants():
    for name in ("law +8 %", "law +48 %", "law cubic", "law softens 20 %"):
        bent = read(SEAL, replace(SENT, depth=6e-3), replace(DRY, seal=RIGS[name].seal))
        slow = Seal(draw_truth("1 arm", 0), 6e-3, **RIGS[name].seal)
        assert bent.seal.depth == 6e-3
        assert slow.elastic(6e-3) == pytest.approx(6e-3)


def test_the_catalogue_is_named_and_spread():
    records = list(relaxation_records(48))
    assert len({record.name for record in records}) == 48
    assert {record.protocol.rate for record in records} == set(RATES)
    assert {next(n for n in NOISES if f"| {n} |" in record.name) for record in records} == set(
        NOISES
    )
    assert all(0.05 <= record.protocol.ramp <= 5 for record in records)
    assert all(
        10 <= record.protocol.hold <= 300 and len(record.time) < 180_000 for record in records
    )
    (again,) = list(relaxation_records(1))
    assert again.text() == records[0].text()


def test_every_truth_meets_every_rig():
    names = [record.name for record in verdict_records(TRUTHS[:2], ["none", "drift .2 mN/s"])]
    assert names == [
        f"{truth} | {rig}" for truth in ("Table 1", "broad") for rig in ("none", "drift .2 mN/s")
    ]
    sent = [protocol_of(truth) for truth in TRUTHS]
    assert all(10 <= item.hold <= 80.5 and 0.3 <= item.ramp <= 2.02 for item in sent)
    assert len({(item.depth, item.ramp) for item in sent}) == 42


def test_foreign_rig_accepts_a_custom_step():
    twice = Rig(reading=(partial(rigs.drifts, rate=1e-3), partial(rigs.drifts, rate=-1e-3)))
    record = read(SEAL, SENT, replace(twice, noise=0.0, count=0.0, bias=0.0))
    np.testing.assert_allclose(record.force, record.pure, atol=1e-15)
    assert [name for name, _ in record.done] == [
        "sample_record", "noisy", "drifts", "drifts", "quantise_record"
    ]  # fmt: skip
