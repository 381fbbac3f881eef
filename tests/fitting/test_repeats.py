"""Several tests: copies are refused, lots are distinguished, repeats are pooled."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from kit.shell import ran
from kit.trials import Bench, Seal, record, relaxation_test

import dashpot as dp
from dashpot.base.provenance import Source
from dashpot.fitting.checks.relaxation import same_specimen
from dashpot.fitting.input_tests import end_stiffnesses, noise_correlation, refuse_copies
from dashpot.fitting.relaxation import fit as fit_tests
from dashpot.preprocessing.prepare import prepare

PAPER = Seal.of_arms(196.5, (117.5, 17.8), (0.5021, 16.416))
BENCH = Bench(hold=15.0, drift=0.2e-3)


def press_seal(seal: Seal = PAPER, bench: Bench = BENCH, seed: int = 0) -> dp.RelaxationTest:
    return relaxation_test(record(seal, bench, seed=seed))


def resample_test(test: dp.RelaxationTest, rate: float, start: float = 0.0) -> dp.RelaxationTest:
    time = np.arange(test.time[0] + start, test.time[-1], 1 / rate)
    x, force = (np.interp(time, test.time, y) for y in (test.displacement, test.force))
    return dp.RelaxationTest(time=time, displacement=x, force=force, units="SI")


@pytest.fixture(scope="module")
def ramp_hold() -> dp.RampHold:
    return prepare(press_seal())


def test_fit_tests_refuses_a_duplicate_record(ramp_hold):
    with pytest.raises(dp.FitError, match="tests 1 and 3 are one record, sample for sample"):
        fit_tests([ramp_hold, prepare(press_seal(seed=1)), ramp_hold], arms=2)


def test_refuse_copies_refuses_a_duplicate_file_but_accepts_two_segments(ramp_hold):
    named = replace(ramp_hold, source=Source("a.csv", "abc"))
    other = replace(prepare(press_seal(seed=1)), source=named.source)
    with pytest.raises(dp.FitError, match=r"the same part of a\.csv"):
        refuse_copies([named, other])
    later = replace(
        other,
        time=other.time + 100, onset=other.onset + 100,
        ramp_end=other.ramp_end + 100, hold_end=other.hold_end + 100,
    )  # fmt: skip
    refuse_copies([named, later])


@pytest.mark.parametrize(("rate", "start"), [(1000, 0.37e-3), (500, 0), (1400, 0.2e-3), (250, 0)])
def test_a_resampled_copy_scatters_alike(ramp_hold, rate, start):
    copy = prepare(resample_test(press_seal(), rate, start))
    assert noise_correlation(ramp_hold, copy) > 0.45
    with pytest.raises(dp.FitError, match="one record, resampled"):
        refuse_copies([ramp_hold, copy])


@pytest.mark.parametrize("hum", [0.0, 5e-3, 30e-3])
def test_two_tests_do_not_scatter_alike_whatever_the_hum(hum):
    bench = replace(BENCH, hum=hum)
    tests = [prepare(press_seal(bench=bench, seed=seed)) for seed in range(6)]
    for i, a in enumerate(tests):
        for b in tests[:i]:
            assert abs(noise_correlation(a, b)) < 0.2


def test_noise_as_slow_as_the_hold_is_no_copy():
    bench = replace(BENCH, noise_time=0.5)
    first, second = (prepare(press_seal(bench=bench, seed=seed)) for seed in (0, 1))
    assert abs(noise_correlation(first, second)) < 0.3


def test_repeats_on_one_seal_pass_with_load_cell_drift():
    tests = [prepare(press_seal(seed=seed), machine=dp.Machine(drift=0.2e-3)) for seed in range(4)]
    assert same_specimen(end_stiffnesses(tests)).passed


@pytest.mark.parametrize("baseline", [1.5, 0.0])
def test_fit_tests_reports_two_lots_separately(baseline):
    bench = replace(BENCH, baseline=baseline)
    stiff = press_seal(PAPER.scaled(1.5), bench, seed=1)
    fit = fit_tests([prepare(press_seal(bench=bench)), prepare(stiff)], arms=2)
    check = next(check for check in fit.checks if check.name == "same_specimen")
    assert check.failed
    assert check.grade == "stop"
    assert "differ by +50 % at one depth" in check.message
    assert fit.verdict.use == "do not use"


def test_several_depths_and_temperatures_are_not_lots():
    shallow = prepare(press_seal(bench=replace(BENCH, depth=4e-3), seed=1))
    deep = prepare(press_seal(PAPER.scaled(1.5)))
    assert same_specimen(end_stiffnesses([shallow, deep])).passed is None
    cold, warm = (
        replace(prepare(press_seal(seal, seed=seed)), specimen=dp.Specimen(temperature=kelvin))
        for seed, (seal, kelvin) in enumerate([(PAPER.scaled(1.5), 253.0), (PAPER, 296.0)])
    )
    assert same_specimen(end_stiffnesses([cold, warm])).passed is None


def test_specimens_in_one_fit_are_answered_with_the_whole_batch_line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = []
    for i, scale in enumerate((1.0, 1.1, 0.9)):
        test = press_seal(PAPER.scaled(scale), seed=i)
        columns = (test.time, 1e3 * test.displacement, test.force)
        rows = "\n".join(map("{:.4f},{:.5f},{:.6f}".format, *columns))
        names.append(f"seal {i}.csv")
        (tmp_path / names[-1]).write_text(f"time [s],displacement [mm],force [N]\n{rows}\n")
    result = ran("fit", *names)
    verdict = " ".join(result.stdout.split())
    assert re.match(r"Do not use: tests \d and \d are not of one seal\.", verdict), result.stdout
    assert "next: dashpot batch 'seal 0.csv' 'seal 1.csv' 'seal 2.csv' -o lot" in result.stderr, (
        result.stderr
    )
