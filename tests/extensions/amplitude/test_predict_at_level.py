"""dashpot predict --amplitude: a material and its strain sweep to the resonance of a mass."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from kit.shell import ran
from scipy.optimize import brentq

import dashpot as dp
from dashpot.extensions.amplitude.amplitude_response import ReferencePoint, SweptPart
from dashpot.extensions.amplitude.datamodel import AmplitudeSweep
from dashpot.extensions.amplitude.fit import fit_amplitude
from dashpot.solids.part_geometry import bonded_cylinder

pytestmark = pytest.mark.once

# two discs, 20 mm by 12 mm, under 0.4 kg
HEIGHT, MASS, PARTS = 0.012, 0.4, 2
FACTOR = PARTS * np.pi / 4 * 0.02**2 / HEIGHT * bonded_cylinder(20 / 48)
SHARE, HALF, POWER = 0.35, 0.4e-2, 0.55
LOW, HIGH = 0.5, 5.0


def modulus(f):
    s = 2j * np.pi * np.asarray(f)
    return 3e6 + sum(k * s * t / (1 + s * t) for k, t in ((6e5, 0.05), (9e5, 2e-3), (1.5e6, 1e-4)))


def payne(strain):
    u = (np.asarray(strain) / HALF) ** POWER
    return 1 - SHARE + SHARE / (1 + u**2) + 2j * SHARE * POWER / np.pi * u / (1 + u**2)


def solve_relative_motion(f, level, factor=1.0, base=True):
    """Relative motion of the mass, m, at a level: the quasi-linear balance, by bisection."""
    omega, force = 2 * np.pi * f, MASS * level if base else level

    def off(ln_X):
        X = np.exp(ln_X)
        K = FACTOR * modulus(f) * payne(factor * X / HEIGHT)
        return np.log(abs(K - MASS * omega**2) * X / force)

    return float(np.exp(brentq(off, np.log(1e-12), np.log(1.0))))


def peak(level, factor=1.0, base=True):
    """Frequency and height of the largest transmissibility or accelerance."""
    lines = np.linspace(60, 160, 801)
    height = []
    for f in lines:
        X = solve_relative_motion(f, level, factor, base)
        K = FACTOR * modulus(f) * payne(factor * X / HEIGHT)
        accelerance = (2 * np.pi * f) ** 2 * X / level
        height.append(abs(K / (K - MASS * (2 * np.pi * f) ** 2)) if base else accelerance)
    top = int(np.argmax(height))
    return lines[top], height[top]


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """The files of a DMA: a fit of the sweep of frequency, and a sweep of strain."""
    folder, rng = tmp_path_factory.mktemp("dma"), np.random.default_rng(0)

    def noisy(value):
        return value * (1 + 1e-3 * rng.standard_normal(len(value)))

    f, strain = np.geomspace(0.1, 500, 60), np.geomspace(1e-4, 0.1, 24)
    swept = modulus(10.0) * payne(strain)
    for name, header, columns in (
        ("dma.csv", "Frequency [Hz],E' [MPa],E'' [MPa]", (f, modulus(f))),
        ("strain.csv", "Frequency [Hz],Strain [%],E' [MPa],E'' [MPa]", (100 * strain, swept)),
    ):
        parts = [noisy(columns[1].real) / 1e6, noisy(columns[1].imag) / 1e6]
        first = [columns[0]] if name == "dma.csv" else [10 + 0 * strain, columns[0]]
        rows = np.column_stack([*first, *parts])
        np.savetxt(folder / name, rows, delimiter=",", header=header, comments="")
    made = ran("fit", folder / "dma.csv", "-o", folder / "m.json")
    assert made.exit_code == 0, made.output
    return folder


def predict(place, *words):
    requested = ("predict", place / "m.json", "--mass", "400g", "--seals", "2", "--json")
    return ran(*requested, "--band", "60:160Hz", "--points", "101", *words)


def run_predict(place, *words):
    prediction = predict(place, "--sweep", str(place / "strain.csv"), *words)
    assert prediction.exit_code == 0, prediction.output
    return json.loads(prediction.stdout)


DISC = ("--shape", "disc:20mm,12mm")
BASE = ("--base", "--amplitude", f"{LOW}m/s^2", "--amplitude", f"{HIGH}m/s^2")


def test_a_shaken_base_at_ten_times_the_level(place):
    low, high = run_predict(place, *DISC, *BASE, "--strain-factor", "1")["levels"]
    for entry, level in ((low, LOW), (high, HIGH)):
        hz, height = peak(level)
        assert entry["peak"]["frequency_hz"] == pytest.approx(hz, rel=3e-3)
        assert entry["peak"]["value"] == pytest.approx(height, rel=0.02)
        assert entry["strain"] == pytest.approx(entry["amplitude"] / HEIGHT)
        assert entry["amplitude"] == pytest.approx(solve_relative_motion(hz, level), rel=0.03)
    change = high["peak"]["frequency_hz"] / low["peak"]["frequency_hz"]
    assert change == pytest.approx(peak(HIGH)[0] / peak(LOW)[0], rel=2e-3)
    assert change < 0.93


def test_text_states_the_change_of_the_peak_from_first_to_last(place):
    words = ("predict", place / "m.json", "--mass", "400g", "--seals", "2", "--band", "60:160Hz",
             "--points", "101", "--sweep", place / "strain.csv", *DISC, *BASE)  # fmt: skip
    done = ran(*words, "--strain-factor", "1")
    assert done.exit_code == 0, done.output
    (stated,) = re.findall(r"the peak moves by ([-+][.\d]+) % from first to last", done.output)
    expected = 100 * (peak(HIGH)[0] / peak(LOW)[0] - 1)
    assert float(stated) == pytest.approx(expected, abs=0.3)
    assert expected < -7


def test_what_the_strain_measure_leaves_open_holds_either(place):
    """A part in shear beside a sweep in tension is strained by X/h over the root of three."""
    (entry,) = run_predict(place, *DISC, "--amplitude", "1N")["levels"]
    low, high = entry["frequency_between_hz"]
    for factor in (1.0, 1 / np.sqrt(3)):
        hz, height = peak(1.0, factor, base=False)
        assert low * (1 - 3e-3) < hz < high * (1 + 3e-3)
        expected = run_predict(place, *DISC, "--amplitude", "1N", "--strain-factor", str(factor))
        (same,) = expected["levels"]
        assert same["peak"]["frequency_hz"] == pytest.approx(hz, rel=3e-3)
        assert same["peak"]["value"] == pytest.approx(height, rel=0.02)
    assert high / low > 1.01


def test_predict_uses_a_resonance_measured_at_another_level(place):
    """One peak, measured where the rubber had softened, gives that of another level."""
    measured = ("--resonance", f"{peak(HIGH)[0]:.5g}Hz", "--resonance-mass", "400g")
    message = run_predict(
        place, *measured, "--resonance-amplitude", f"{HIGH}m/s^2", "--height", "12mm", *BASE,
        "--strain-factor", "1",
    )  # fmt: skip
    for entry, level in zip(message["levels"], (LOW, HIGH), strict=True):
        assert entry["peak"]["frequency_hz"] == pytest.approx(peak(level)[0], rel=3e-3)


def test_a_modulus_measured_at_a_strain_is_taken_back_to_none(place, tmp_path):
    softened = tmp_path / "soft"
    softened.mkdir()
    (softened / "strain.csv").write_bytes((place / "strain.csv").read_bytes())
    f = np.geomspace(0.1, 500, 60)
    E = modulus(f) * payne(2e-3)  # with the loss of its friction, as an instrument finds it
    rows = np.column_stack([f, E.real / 1e6, E.imag / 1e6])
    header = "Frequency [Hz],E' [MPa],E'' [MPa]"
    np.savetxt(softened / "dma.csv", rows, delimiter=",", header=header, comments="")
    assert ran("fit", softened / "dma.csv", "-o", softened / "m.json").exit_code == 0
    result = {}
    part = "--height", "12mm", "--resonance", f"{peak(1e-6)[0]}Hz", "--resonance-mass", "400g"
    for fitted_at in ((), ("--reference-strain", "0.2%")):
        message = run_predict(softened, *part, *BASE, "--strain-factor", "1", *fitted_at)
        result[bool(fitted_at)] = message["levels"][1]["peak"]
    hz, height = peak(HIGH)
    assert result[True]["frequency_hz"] == pytest.approx(hz, rel=0.02)
    assert result[True]["value"] == pytest.approx(height, rel=0.15)
    assert result[False]["value"] < 0.9 * result[True]["value"]


@pytest.mark.parametrize(("letter", "factor"), [("E", 3**-0.5), ("G", 3**0.5)])
def test_predict_states_that_a_shear_sweep_may_not_apply(place, tmp_path, letter, factor):
    (tmp_path / "m.json").write_bytes((place / "m.json").read_bytes())
    text = (place / "strain.csv").read_text().replace("E'", f"{letter}'")
    (tmp_path / "strain.csv").write_text(text)
    message = run_predict(tmp_path, *DISC, *BASE)
    assert message["sweep"]["strain_factors"] == pytest.approx([1.0, factor])


@pytest.mark.parametrize("since", [0.0, 2e-3])
@pytest.mark.parametrize("law", ["factor", "additive", "additive+cubic"])
def test_element_parallel_to_a_solid_is_the_change_since_its_amplitude(law, since):
    X = np.geomspace(1e-4, 0.1, 24)
    E = 4e6 * payne(X) + (0.75 * 2e9 * X**2 if "cubic" in law else 0)
    sweep = dp.AmplitudeSweep(10 + 0 * X, X, E.real, E.imag, "Pa", "strain", units="SI")
    amplitude_fit = fit_amplitude(sweep, law=law)
    start = 4e6 * (payne(since) if since else 1.0)
    solid = dp.GeneralizedMaxwell(start.real, (1e-9,), (1.0,))
    change = amplitude_fit.build_dependence(solid * 1e-3, 1e-3, stretch=0.02, since=since)
    assert change is not None
    if law == "factor":
        expected = start.real * (payne(X) / payne(since or 1e-12) - 1)
    else:
        expected = E - start - (0.75 * 2e9 * since**2 if "cubic" in law else 0)
    assert change.equivalent(1.0, 0.02 * X) == pytest.approx(1e-3 * expected, abs=1e-3 * 4e4)


@pytest.mark.parametrize(("level", "passes"), [("2m/s^2", True), ("200m/s^2", False)])
def test_predict_states_first_that_a_level_is_outside_the_sweep(place, level, passes):
    message = run_predict(place, *DISC, "--base", "--amplitude", level)
    assert ("amplitude_in_tested_range" in str(message["verdict"])) is not passes
    assert message["verdict"]["message"].startswith("At 200 m/s^2") is not passes


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--amplitude", "1N", *DISC), "the elastic law of this fit is linear"),
        (("--sweep", "strain.csv"), "give both, or neither"),
        (("--sweep", "strain.csv", "--amplitude", "1N", "--resonance", "90Hz", "--resonance-mass",
          "400g"), "--height 20mm"),
        (("--sweep", "strain.csv", "--amplitude", "1m/s^2", *DISC), "expected a unit of force"),
        (("--sweep", "strain.csv", "--amplitude", "0N", *DISC), "amplitude > 0"),
        (("--sweep", "strain.csv", "--amplitude", "1N", "--resonance-amplitude", "1N", *DISC),
         "add that"),
        (("--sweep", "dma.csv", "--amplitude", "1N", *DISC), "amplitude sweep is expected"),
        (("--sweep", "frf.csv", "--amplitude", "1N", *DISC), "is of a mass (frf)"),
        (("--sweep", "strain.csv", *BASE, *DISC, "-o", "out.csv"), "ask one --amplitude"),
        (("--sweep", "part.csv", "--amplitude", "1N", *DISC), "both of the material"),
        (("--sweep", "long.csv", "--amplitude", "1N", *DISC), "does not give the strain"),
    ],
)  # fmt: skip
def test_what_tells_no_level_is_refused(place, monkeypatch, words, message):
    monkeypatch.chdir(place)
    X = np.geomspace(1e-3, 1, 12)
    (place / "frf.csv").write_text(
        "frequency [Hz],real [(m/s^2)/N],imaginary [(m/s^2)/N]\n"
        + "".join(f"{10 + i},{0.1 * i},{0.2 * i}\n" for i in range(20))
    )
    for name, unit in (("part.csv", "N/mm"), ("long.csv", "MPa")):
        rows = "".join(f"10,{x},{20 - 5 * x},{2 + x}\n" for x in X)
        header = f"Frequency [Hz],Displacement [mm],Storage [{unit}],Loss [{unit}]\n"
        (place / name).write_text(header + rows)
    prediction = predict(place, *words)
    assert prediction.exit_code == 2
    assert message in " ".join(prediction.stderr.split())


def test_predict_writes_and_plots_one_level(place, tmp_path):
    words = ("--sweep", str(place / "strain.csv"), *DISC, "--base", "--amplitude", "5m/s^2")
    prediction = predict(
        place, *words, "-o", str(tmp_path / "frf.csv"), "--plot", str(tmp_path / "frf.svg")
    )
    assert prediction.exit_code == 0, prediction.output
    rows = np.genfromtxt(tmp_path / "frf.csv", delimiter=",", comments="#", skip_header=1)
    rows = rows[np.isfinite(rows).all(axis=1)]
    top = rows[np.hypot(rows[:, 1], rows[:, 2]).argmax()]
    assert top[0] == pytest.approx(peak(HIGH)[0], abs=1.0)
    assert "at 5 m/s^2" in (tmp_path / "frf.svg").read_text()


def test_limits_at_a_level_count_what_the_law_leaves(place, tmp_path):
    """Loss and storage of the sweep off by so much about the strain in use: the limits are as wide.

    s_K: .02 of a stiffness, r' there and where the part was measured, half of the level's change.
    """
    strain = np.geomspace(1e-4, 0.1, 24)
    swept = modulus(10.0) * payne(strain)
    wave = 0.05 * np.cos(np.pi * np.arange(24))  # a law cannot follow it
    for off in (0.0, 1.0):
        E = swept.real * (1 + 0.2 * off * wave) + 1j * swept.imag * (1 + 2 * off * wave)
        record = AmplitudeSweep(np.full(24, 10.0), strain, E.real, E.imag, units="SI")
        law = fit_amplitude(record, law="factor")
        part = SweptPart((law,), (1.0,), HEIGHT, 0.0, None, record)
        f, T = part.compute_relative_errors(2e-3, 100.0, ReferencePoint(None, 0.0))
        change = 0.5 * abs(np.log(payne(2e-3).real / payne(1e-7).real))
        sd = 0.2 * 0.05 * off
        assert f == pytest.approx(np.sqrt(0.02**2 + 2 * sd**2 + change**2), rel=0.08)
        loss = 2 * 0.05 * off
        assert pytest.approx(2 * np.sqrt(loss**2 + 0.1**2 + 0.05**2), rel=0.1) == T
        far, _ = part.compute_relative_errors(2e-3, 100.0, ReferencePoint(200.0, 0.0))
        assert far**2 - f**2 == pytest.approx((0.05 * np.log(2)) ** 2)


def test_limits_at_a_level_hold_the_truth(place):
    for entry, level in zip(run_predict(place, *DISC, *BASE)["levels"], (LOW, HIGH), strict=True):
        hz, height = peak(level)
        low, high = entry["frequency_between_hz"]
        assert low < hz < high
        assert 0.01 < high / low - 1 < 0.25
        least, most = entry["value_between"]
        assert least < height < most
        assert 0.1 < most / least - 1 < 1.0
