"""Two accelerometers on a shaker, as recorded, to a transmissibility."""

import json
from dataclasses import replace

import numpy as np
import pytest
from kit.shell import ran, run_json

from dashpot.base.errors import DashpotError, DataError
from dashpot.datamodel.vibration_tests import ShakenTest
from dashpot.extensions.modes.base_transmissibility import estimate_transmissibility
from dashpot.extensions.modes.checks import channels_not_clipped
from dashpot.extensions.modes.shaken_base import read_shaken
from dashpot.reading.read_options import ReadOptions
from dashpot.solids.demo_seals import BROAD, BROAD_MASS
from dashpot.workflow.measured_frf import modes_of_hits

pytestmark = pytest.mark.once

RATE, SOLID = 256.0, 2 * BROAD


def truth(f):
    w = 2 * np.pi * np.maximum(f, 1e-9)
    K = SOLID.complex_stiffness(omega=w)
    return K / (K - BROAD_MASS * w**2)


def shaken(seconds=120.0, *, noise=(0.0, 0.0), seed=0, gain=1.0, offset=0.0):
    """Chance motion from 1 to 80 Hz, through the mass by transforms of twice the record."""
    rng, n = np.random.default_rng(seed), int(seconds * RATE)
    f = np.fft.rfftfreq(2 * n, 1 / RATE)
    lines = np.fft.rfft(rng.normal(size=2 * n)) * ((f > 1) & (f < 80))
    base, mass = np.fft.irfft(lines), np.fft.irfft(lines * truth(f))
    base, mass = base[n:], mass[n:]
    slow = offset * np.linspace(-1, 1, n) * base.std()
    e = rng.normal(size=(2, n)) * base.std()
    return ShakenTest(RATE, base + noise[0] * e[0] + slow, gain * mass + noise[1] * e[1] + slow)


def select_band_with_truth(frf, low=5.0, high=40.0):
    near = (frf.frequency > low) & (frf.frequency < high)
    return frf.only(near), truth(frf.frequency[near])


@pytest.mark.parametrize("estimator", ["H1", "H2", "Hv"])
def test_it_comes_back_within_its_scatter(estimator):
    frf, T = select_band_with_truth(
        estimate_transmissibility(shaken(noise=(3e-3, 3e-3)), estimator=estimator)
    )
    assert np.median(np.abs(frf.value / T - 1)) < 0.01
    off = np.abs(frf.value - T) / np.sqrt(2) / frf.random_sd
    assert np.sqrt(np.mean(off**2)) == pytest.approx(1.0, abs=0.25)
    assert frf.coherence[(frf.frequency > 6) & (frf.frequency < 25)].min() > 0.9


def test_transmissibility_estimator_suits_its_noisy_channel():
    for noise, right, other in (((0.0, 0.5), "H1", "H2"), ((0.5, 0.0), "H2", "H1")):
        test = shaken(noise=noise, seconds=240.0)
        sizes = {}
        for name in (right, other):
            frf, T = select_band_with_truth(
                estimate_transmissibility(test, estimator=name, segment=6), 17.0, 30.0
            )
            sizes[name] = np.mean(np.abs(frf.value / T))
        assert sizes[right] == pytest.approx(1.0, abs=0.06)
        assert abs(sizes[other] - 1) > 0.1


def test_a_drifting_offset_leaks_into_no_line():
    quantity, T = select_band_with_truth(estimate_transmissibility(shaken(offset=5.0)))
    assert np.median(np.abs(quantity.value / T - 1)) < 0.01


def test_short_segments_flatten_the_peak_and_the_coherence_shows_it():
    test = shaken(seconds=400.0)
    highs, least = [], []
    for seconds in (2.0, 16.0):
        frf, _ = select_band_with_truth(estimate_transmissibility(test, segment=seconds))
        highs.append(np.abs(frf.value).max() / np.abs(truth(np.linspace(12, 13, 999))).max())
        least.append(frf.coherence.min())
    assert highs[0] < 0.85
    assert highs[1] == pytest.approx(1.0, abs=0.04)
    assert least[0] < 0.9 < least[1]


def test_transmissibility_does_not_join_separate_records():
    item, other = shaken(60.0, seed=1), shaken(60.0, seed=2)
    both = ShakenTest(
        RATE,
        np.concatenate((item.base, other.base)),
        np.concatenate((item.mass, other.mass)),
        (0, len(item.base)),
    )
    frf, T = select_band_with_truth(estimate_transmissibility(both, segment=10))
    assert np.median(np.abs(frf.value / T - 1)) < 0.01
    single = estimate_transmissibility(item, segment=10)
    assert frf.averages in (2 * single.averages, 2 * single.averages + 1)


def test_what_cannot_be_averaged_is_refused():
    with pytest.raises(DataError, match="Hs needs the quiet before a hit"):
        estimate_transmissibility(shaken(10.0), estimator="Hs")
    with pytest.raises(DataError, match=r"1 segments of 8 s in the record; expected 3"):
        estimate_transmissibility(shaken(10.0), segment=8)
    still = ShakenTest(RATE, np.zeros(4096), np.zeros(4096))
    with pytest.raises(DataError, match="the base does not move"):
        estimate_transmissibility(still)


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """A table in g, the mass in m/s^2, beside a third channel."""
    result, test = tmp_path_factory.mktemp("shaker") / "shaker.csv", shaken(noise=(2e-3, 2e-3))
    t = np.arange(len(test.base)) / RATE
    rows = np.column_stack((t, test.base / 9.80665, test.mass))
    np.savetxt(result, rows, delimiter=",", comments="", header="time [s],table [g],block [m/s^2]")
    return result


def test_the_file_is_read_like_a_hammers(path, tmp_path):
    mass = ["--mass", f"{1e3 * BROAD_MASS}g"]
    base = ["--column", "base-acceleration=table"]
    text = " ".join(ran("inspect", path).output.split())
    assert "--column base-acceleration=" in text
    answered = ran("inspect", path, *base).output
    assert "said to be that of the base" in answered
    assert "ASK" not in answered
    out = tmp_path / "t.csv"
    done = ran("fit", path, *base, "--estimator", "Hv", "-o", out)
    assert done.exit_code == 0, done.output
    assert "Use: " in done.output
    assert "hits" not in done.output
    assert ": transmissibility (" in ran("inspect", out).output
    document = run_json("fit", path, *base, *mass, "--seals", 2)
    near = np.interp(
        [9.0, 18.0], document["direct"]["frequency_hz"], document["direct"]["stiffness"]
    )
    assert near == pytest.approx(BROAD.storage(omega=2 * np.pi * np.array([9.0, 18.0])), rel=0.02)
    names = {check["name"] for check in document["checks"]}
    assert {"mass_over_base", "coherence", "segments_resolve"} <= names


def test_fit_reports_swapped_channels_first(path):
    mass = ["--mass", f"{1e3 * BROAD_MASS}g"]
    stdout = ran("fit", path, "--column", "base-acceleration=block", *mass).stdout
    assert stdout.startswith("Do not use: below 12.")
    assert "the base over the mass" in " ".join(stdout.split())


def test_clipping_check_detects_a_clipped_channel_and_accepts_a_sine():
    """Clipped at 2.5 standard deviations the loss is 15 % off, at coherence 0.98."""
    intact = shaken()
    assert not channels_not_clipped(intact).failed
    cut = 2.5 * intact.mass.std()
    clipped = replace(intact, mass=np.clip(intact.mass, -cut, cut))
    assert channels_not_clipped(clipped).failed
    turn = 2 * np.pi * (np.arange(5120) + 0.5) / 64
    assert not channels_not_clipped(ShakenTest(RATE, np.sin(turn), np.cos(turn))).failed


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["compare", "fit.json"], "give the mass (--mass)"),
        (["fit", "--window", "exponential"], "--window: of hits"),
        (["fit", "--reject", "2"], "--reject: of hits"),
    ],
)
def test_what_a_shaken_base_has_no_use_for(path, tmp_path, words, message):
    fit = tmp_path / "fit.json"
    fit.write_text(json.dumps({"schema": "dashpot/fit@2", "model": {"k_inf": 393.0, "arms": []}}))
    words = [fit if word == "fit.json" else word for word in words]
    refused = ran(*words, path, "--column", "base-acceleration=table")
    assert refused.exit_code == 2
    assert message in " ".join(refused.output.split())


def test_read_shaken_asks_about_ambiguous_columns(tmp_path):
    three = tmp_path / "three.csv"
    header = "time [s],a [g],b [g],c [g]"
    rows = np.column_stack((np.arange(64) / 64, np.random.default_rng(0).normal(size=(64, 3))))
    np.savetxt(three, rows, delimiter=",", comments="", header=header)
    with pytest.raises(DashpotError, match="2 motions beside that of the base"):
        read_shaken([three], ReadOptions(base_acceleration="a"))
    shaken_test = read_shaken([three], ReadOptions(base_acceleration="a", acceleration=("c",)))
    assert shaken_test.mass == pytest.approx(9.80665 * rows[:, 3])
    with pytest.raises(DashpotError, match="there is no such column"):
        read_shaken([three], ReadOptions(base_acceleration="d"))
    with pytest.raises(DashpotError, match="0 motions beside that of the base"):
        read_shaken([three], ReadOptions(base_acceleration="a", acceleration=("a",)))
    rows[:, 3] = rows[:, 1]
    np.savetxt(three, rows, delimiter=",", comments="", header=header)
    with pytest.raises(DashpotError, match="hold the same numbers"):
        read_shaken([three], ReadOptions(base_acceleration="a", acceleration=("c",)))


def test_modes_of_a_shaker_test_need_no_mass():
    """Frequency and damping do not depend on the mass, and where nothing rings it is no use."""
    test = shaken(400.0, noise=(3e-3, 3e-3))
    (bare, reason), (weighed, _) = modes_of_hits(test), modes_of_hits(test, mass=BROAD_MASS)
    assert not reason
    assert len(bare) == len(weighed) >= 1
    assert bare[0].frequency == pytest.approx(weighed[0].frequency)
    assert bare[0].damping_ratio == pytest.approx(weighed[0].damping_ratio)
    assert bare[0].frequency == pytest.approx(12.7, rel=0.01)
    rng = np.random.default_rng(0)
    stiff = rng.normal(size=int(100 * RATE))
    nothing, _ = modes_of_hits(ShakenTest(RATE, stiff, stiff + 1e-3 * rng.normal(size=len(stiff))))
    assert not len(nothing)
    assert nothing.verdict.use != "use"
