"""Motion of a mass relative to its base, or by another derivative than that of the base."""

import json
from dataclasses import replace

import numpy as np
import pytest
from kit.shell import ran, run_json

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.datamodel.frf import Kind
from dashpot.datamodel.vibration_tests import ShakenTest
from dashpot.extensions.modes.base_transmissibility import estimate_transmissibility
from dashpot.extensions.modes.shaken_base import read_shaken
from dashpot.fitting.identification.frf_data import select_frf_data
from dashpot.fitting.identification.identify import identify
from dashpot.fitting.prediction_bounds import PredictedFRF
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.frf import read_frf
from dashpot.reading.write import write_frf
from dashpot.solids.demo_seals import BROAD, BROAD_MASS, PAPER, PAPER_MASS
from dashpot.vibration.mass_on_seals import MassOnSeals
from dashpot.vibration.modal.dynamic_stiffness import dynamic_stiffness

pytestmark = pytest.mark.once

RELATIVE = "relative_transmissibility"
MASS = ["--mass", f"{1e3 * PAPER_MASS}g", "--seals", "2"]
SIZES = {"mm": (0, 1e-3), "m": (0, 1.0), "mm/s": (1, 1e-3), "m/s^2": (2, 1.0), "g": (2, 9.80665)}


def over_base(f, kind=RELATIVE):
    return dp.systems.predict_frf(2 * PAPER, mass=PAPER_MASS, frequency=f, kind=kind)


def write_export(path, frf, over, under, *, header=None):
    """As a lab writes it: each motion by its own derivative, in its own unit."""
    (up, a), (down, b) = SIZES[over], SIZES[under]
    value = frf.value * frf.s ** (up - down) * b / a
    unit = header or f"({over})/({under})"
    rows = np.column_stack((frf.frequency, np.abs(value), np.degrees(np.angle(value))))
    named = f"frequency [Hz],magnitude [{unit}],phase [deg]"
    np.savetxt(path, rows, delimiter=",", comments="", header=named)
    return path


@pytest.mark.parametrize("over", SIZES)
@pytest.mark.parametrize("under", ["mm", "mm/s", "g"])
@pytest.mark.parametrize("kind", ["transmissibility", RELATIVE])
def test_a_motion_over_a_motion_of_any_derivative(tmp_path, over, under, kind):
    transmissibility = over_base(np.arange(2.0, 40.0, 1.0), kind)
    read = read_frf(write_export(tmp_path / "t.csv", transmissibility, over, under))
    assert read.value == pytest.approx(transmissibility.value, rel=1e-12)
    assert read.quantity == "transmissibility"  # whose motion it is a unit does not show


F = np.arange(5.0, 40.0, 1.0)


@pytest.mark.parametrize(
    ("head", "scale", "units"),
    [
        ("Frequency [Hz],Magnitude [dB re 1 g/g],Phase [deg]", None, {}),
        ("Frequency [Hz],Magnitude [dB (g/g)],Phase [deg]", None, {}),
        ("Frequency [Hz],Transmissibility,Phase [deg]", None, {"magnitude": "dB"}),
        ("Frequency [Hz],Magnitude,Phase [deg]", None, {"magnitude": "dB re g/g"}),
        ("Frequency [Hz],Transmissibility [%],Phase [deg]", 100.0, {}),
        ("Frequency [Hz],a2/a1 [g/g],Phase [deg]", 1.0, {}),
        ("Frequency [Hz],Amplitude [m/s²/m/s²],Phase [Grad]", 1.0, {}),
        ("Frequency [Hz],Amplitude [(mm/s^2)/m/s^2],arg [deg]", 1e3, {}),
    ],
)
def test_a_transmissibility_as_other_labs_write_it(tmp_path, head, scale, units):
    transmissibility, path = over_base(F, "transmissibility"), tmp_path / "t.csv"
    size = np.abs(transmissibility.value)
    shown = 20 * np.log10(size) if scale is None else scale * size
    rows = np.column_stack((F, shown, np.degrees(np.angle(transmissibility.value))))
    np.savetxt(path, rows, delimiter=",", comments="", header=head)
    read = read_frf(path, options=ReadOptions(units=units))
    assert read.value == pytest.approx(transmissibility.value, rel=1e-9)
    assert read.quantity == "transmissibility"


def test_a_name_says_that_it_is_relative(tmp_path):
    path, transmissibility = tmp_path / "t.csv", over_base(F)
    head = "Frequency [Hz],Relative transmissibility Re [-],Im [-]"
    rows = np.column_stack((F, transmissibility.value.real, transmissibility.value.imag))
    np.savetxt(path, rows, delimiter=",", comments="", header=head)
    assert read_frf(path).quantity == RELATIVE


@pytest.mark.parametrize(
    ("head", "message"),
    [
        ("Frequency [Hz],Transmissibility [-]", "a magnitude and no phase"),
        ("Frequency [Hz],Phase [deg]", "a phase and no magnitude"),
        ("Frequency [Hz],Transmissibility,Phase [deg]", '--units "magnitude=dB re g/g"'),
    ],
)
def test_fit_reports_missing_data_of_a_transmissibility(tmp_path, head, message):
    path = tmp_path / "t.csv"
    columns = (F, -np.linspace(1, 40, len(F)), np.linspace(-10, -170, len(F)))
    rows = np.column_stack(columns[: head.count(",") + 1])
    np.savetxt(path, rows, delimiter=",", comments="", header=head)
    refused = ran("fit", path, *MASS)
    assert refused.exit_code == 2
    assert message in " ".join(refused.output.split())


def test_square_seconds_are_a_displacement_over_an_acceleration(tmp_path):
    transmissibility = over_base(np.arange(2.0, 40.0, 1.0))
    read = read_frf(write_export(tmp_path / "t.csv", transmissibility, "m", "m/s^2", header="s^2"))
    assert read.value == pytest.approx(transmissibility.value, rel=1e-12)


def test_it_is_the_accelerance_times_the_mass_and_no_other_knows_its_coherence():
    f = np.arange(5.0, 30.0, 0.5)
    expected = replace(over_base(f), coherence=np.linspace(0.9, 0.99, len(f)), averages=8)
    forced = expected.to("accelerance", mass=PAPER_MASS)
    assert forced.random_sd == pytest.approx(expected.random_sd / PAPER_MASS, rel=1e-12)
    absolute = expected.to("transmissibility")
    assert absolute.value == pytest.approx(1 + expected.value, rel=1e-12)
    assert absolute.random_sd == pytest.approx(expected.random_sd, rel=1e-12)
    assert expected.to("transmissibility").to(RELATIVE).value == pytest.approx(
        expected.value, rel=1e-9
    )


def test_a_degree_of_a_relative_sensor_hurts_above_the_resonance_and_not_below():
    """|dK/K| = |e| / |T - 1| of an absolute sensor, |e| / |T| of a relative one."""
    f = np.array([5.0, 8.0, 10.0, 12.7, 15.0, 20.0, 50.0])
    share = []
    for kind in (RELATIVE, "transmissibility"):
        result = dynamic_stiffness(over_base(f, kind), PAPER_MASS)
        K = result.storage + 1j * result.loss
        share.append(np.pi / 180 * np.abs(result.by_phase / K)[[0, -1]])
    assert share[0] == pytest.approx([0.015, 0.25], rel=0.05)
    assert share[1] == pytest.approx([0.095, 0.0163], rel=0.05)


def test_lines_without_scatter_count_by_what_was_measured():
    f = np.arange(6.0, 30.0, 0.5)
    for kind in (RELATIVE, "transmissibility"):
        measured = over_base(f, kind)
        data = select_frf_data(measured, seals=2, band=None, mass=PAPER_MASS)
        near = measured.band(data.lines.frequency[0], data.lines.frequency[-1])
        assert data.sd * PAPER_MASS == pytest.approx(np.abs(near.value), rel=1e-9)


def test_a_solid_is_identified_whatever_the_gain_and_delay_of_the_sensor():
    gain, delay = 1.012, -1e-4
    f, rng = np.arange(6.0, 30.0, 0.2), np.random.default_rng(1)
    frf = dp.systems.predict_frf(2 * BROAD, mass=BROAD_MASS, frequency=f, kind=RELATIVE)
    sd = 0.003 * np.abs(frf.value) / np.sqrt(2)
    noise = sd * (rng.normal(size=len(f)) + 1j * rng.normal(size=len(f)))
    seen = gain * np.exp(-frf.s * delay) * frf.value
    fit = identify(replace(frf, value=seen + noise, sd=sd), mass=BROAD_MASS, seals=2, arms=2)
    w = 2 * np.pi * np.array([9.0, 12.71, 18.0])
    assert fit.model.storage(omega=w) == pytest.approx(BROAD.storage(omega=w), rel=0.01)
    values = {item.name: item for item in fit.estimate.nuisance}
    assert values["gain"].value == pytest.approx(gain, abs=3e-3)
    assert values["delay"].value == pytest.approx(delay, abs=2e-5)


@pytest.mark.parametrize("coupled", [0.0, 3e-3])
def test_its_limits_are_those_of_the_accelerance_times_the_mass(coupled):
    w = 2 * np.pi * np.array([5.0, 12.0, 20.0])
    K = PAPER.complex_stiffness(omega=w)
    magnitude = PredictedFRF(
        MassOnSeals(PAPER_MASS, 2.0, coupled=coupled), Kind(RELATIVE)
    ).magnitude(K, w)
    other = PredictedFRF(MassOnSeals(PAPER_MASS, 2.0), Kind.ACCELERANCE).magnitude(K, w)
    assert magnitude == pytest.approx((PAPER_MASS + coupled) * other, rel=1e-12)


RATE = 256.0


@pytest.fixture(scope="module")
def relative_record():
    """The base's acceleration and the displacement of the mass relative to it, m."""
    rng, n = np.random.default_rng(0), int(60 * RATE)
    f = np.fft.rfftfreq(2 * n, 1 / RATE)
    lines = np.fft.rfft(rng.normal(size=2 * n)) * ((f > 1) & (f < 80))
    w = 2 * np.pi * np.maximum(f, 1e-9)
    K = (2 * BROAD).complex_stiffness(omega=w)
    stretch = -BROAD_MASS / (K - BROAD_MASS * w**2)
    base, gap = np.fft.irfft(lines)[n:], np.fft.irfft(lines * stretch)[n:]
    gap += 3e-3 * gap.std() * rng.normal(size=n)
    return ShakenTest(RATE, base, gap, order=0, relative=True)


def write_test(path, test, *, sign=1, more=""):
    t = np.arange(len(test.base)) / RATE
    rows = np.column_stack((t, test.base / 9.80665, sign * 1e3 * test.mass, 0.1 * test.base))
    header = "time [s],table [g],laser [mm],drive [V]"
    np.savetxt(path, rows, delimiter=",", comments="", header=header)
    return path


def test_relative_displacement_is_accepted_with_base_acceleration(relative_record, tmp_path):
    frf = estimate_transmissibility(relative_record, segment=8.0)
    near = (frf.frequency > 5) & (frf.frequency < 30)
    T = dp.systems.predict_frf(
        2 * BROAD, mass=BROAD_MASS, frequency=frf.frequency[near], kind="transmissibility"
    )
    assert frf.quantity == RELATIVE
    assert np.median(np.abs((1 + frf.value[near]) / T.value - 1)) < 0.01
    path = write_test(tmp_path / "laser.csv", relative_record)
    read = read_shaken([path], ReadOptions(base_acceleration="table"))
    assert read.order == 0
    assert read.mass == pytest.approx(relative_record.mass, abs=1e-12)


def test_transmissibility_omits_lines_of_noise(relative_record):
    """The base moves to 80 Hz; beyond, noise over noise times the square of the frequency is a
    peak."""
    rng, n = np.random.default_rng(3), len(relative_record.base)
    noisy = relative_record.base + 2e-3 * relative_record.base.std() * rng.normal(size=n)
    frf = estimate_transmissibility(replace(relative_record, base=noisy))
    assert frf.frequency[-1] < 85
    assert frf.frequency[np.abs(frf.value).argmax()] == pytest.approx(12.6, abs=0.4)
    separate = replace(relative_record, mass=rng.normal(size=n))
    with pytest.raises(DataError, match="does not answer the base"):
        estimate_transmissibility(separate)


def test_the_mass_is_the_motion_that_is_named(relative_record, tmp_path):
    path, t = tmp_path / "both.csv", np.arange(len(relative_record.base)) / RATE
    rows = np.column_stack(
        (t, relative_record.base, relative_record.mass, relative_record.base[::-1])
    )
    np.savetxt(
        path, rows, delimiter=",", comments="", header="t [s],table [m/s^2],gap [m],block [m/s^2]"
    )
    words = [path, "--column", "base-acceleration=table", "--relative", *MASS]
    named = run_json("fit", *words, "--column", "displacement=gap", "--arms", 1)
    assert "relative motion" not in str(named["verdict"])
    read = read_shaken([path], ReadOptions(base_acceleration="table"))
    assert read.order == 2


def test_the_command_line_takes_it(relative_record, tmp_path):
    path, out = write_test(tmp_path / "laser.csv", relative_record), tmp_path / "r.csv"
    mass = ["--mass", f"{1e3 * BROAD_MASS}g"]
    words = ["--column", "base-acceleration=table", "--relative", *mass]
    assert "displacement  the only column" in ran("inspect", path, *words[:2]).output
    done = ran("fit", path, *words, "-o", out)
    assert done.exit_code == 0, done.output
    assert done.stdout.startswith("Use with care: ")
    document = run_json("fit", out, *mass, "--seals", 2, "--arms", 2)
    near = np.interp(
        [9.0, 18.0], document["direct"]["frequency_hz"], document["direct"]["stiffness"]
    )
    assert near == pytest.approx(BROAD.storage(omega=2 * np.pi * np.array([9.0, 18.0])), rel=0.03)
    turned = write_test(tmp_path / "turned.csv", relative_record, sign=-1)
    text = " ".join(ran("fit", turned, *words).stdout.split())
    assert text.startswith("Do not use: ")
    assert "the relative motion has the opposite sign" in text


@pytest.mark.parametrize(
    ("over", "header", "motion", "message"),
    [
        ("mm", "(mm/s)/(m/s^2)", "relative", "a quarter turn off"),
        ("mm", "mm/(m/s^2)", "relative", "Use with care: "),
        ("mm", "(mm/s)/(m/s^2)", "absolute", "is not that of a mass over its base"),
        ("mm", "m/(m/s^2)", "relative", "times that of a mass on a spring"),
        ("mm", "mm/(m/s^2)", "absolute", "(see line 1) (--relative) mass_over_base"),
        ("mm", "", "relative", "no unit"),
    ],
)
def test_what_a_file_of_a_relative_motion_gets_wrong(tmp_path, over, header, motion, message):
    path = tmp_path / "t.csv"
    write_export(path, over_base(np.arange(3.0, 30.0, 0.1)), over, "m/s^2", header=header or "x")
    path.write_text(path.read_text().replace(" [x]", ""))
    fit = tmp_path / "fit.json"
    arms = [{"k": k, "tau": t} for k, t in zip(PAPER.k, PAPER.tau, strict=True)]
    model = {"k_inf": PAPER.k_inf, "arms": arms}
    fit.write_text(json.dumps({"schema": "dashpot/fit@2", "model": model}))
    over_what = ["--relative"] if motion == "relative" else []
    heard = ran("fit", path, *MASS, *over_what, "--arms", 1)
    assert message in " ".join(heard.output.split())
    if message == "Use with care: ":
        compared = run_json("compare", fit, path, *MASS, *over_what)
        assert compared["frac"] > 0.99
        there = run_json("predict", fit, *MASS, "--base", *over_what)
        assert there["kind"] == RELATIVE
        assert there["limits"]["kind"] == RELATIVE


def test_fit_reports_an_absolute_motion_stated_as_relative(tmp_path):
    path = tmp_path / "t.csv"
    write_frf(over_base(np.arange(3.0, 30.0, 0.1), "transmissibility"), path)
    heard = " ".join(ran("fit", path, *MASS, "--relative").output.split())
    assert "the motion looks absolute" in heard
    forced = tmp_path / "forced.csv"
    write_frf(over_base(np.arange(3.0, 30.0, 0.5), "accelerance"), forced)
    assert "leave out" in ran("fit", forced, *MASS, "--relative").output
