"""Hysteresis loops in strain and stress: moduli of a solid by a closed form of its own."""

from __future__ import annotations

import json

import numpy as np
import pytest

import dashpot as dp
from dashpot.base.errors import FitError, ReadError
from dashpot.cli import main
from dashpot.extensions.amplitude.datamodel import StressStrainLoops
from dashpot.extensions.amplitude.fit_files import level_files
from dashpot.extensions.amplitude.preprocess import compute_sweep, find_steady_cycles
from dashpot.extensions.amplitude.read import read_loops
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.inspect import inspect_file

E_INF, ARMS = 3.0, ((1.2, 1.0), (0.8, 0.1))
"""MPa; MPa and s."""


def modulus(frequency: float) -> complex:
    """MPa."""
    s = 2j * np.pi * frequency
    return E_INF + sum(m * s * tau / (1 + s * tau) for m, tau in ARMS)


MEAN, PER_CYCLE = 0.1, 80


def loops(tones=(1.0,), amplitudes=(0.01, 0.03, 0.1), *, cycles=8):
    """Time, strain and stress, MPa, of harmonic cycles after a long rest at the mean strain."""
    blocks, begun = [], 0.0
    for tone in tones:
        for amplitude in amplitudes:
            t = np.arange(cycles * PER_CYCLE) / (PER_CYCLE * tone)
            blocks.append((begun + t, amplitude * np.sin(2 * np.pi * tone * t)))
            begun = float(blocks[-1][0][-1]) + 1 / (PER_CYCLE * tone)
    time, strain = (np.concatenate(group) for group in zip(*blocks, strict=True))
    stress = E_INF * strain
    for m, tau in ARMS:  # exact for straight lines between samples
        arm = np.zeros_like(strain)
        for i in range(1, len(time)):
            h = time[i] - time[i - 1]
            decay = np.exp(-h / tau)
            arm[i] = decay * arm[i - 1] + m * (strain[i] - strain[i - 1]) * tau / h * (1 - decay)
        stress = stress + arm
    scatter = np.random.default_rng(0).normal(0, 4e-4, len(time))
    return time, MEAN + strain, E_INF * MEAN + stress + scatter


def write_record(path, columns, head="Time [s];Strain [%];Stress [MPa]", strain=100.0, stress=1.0):
    t, e, s = columns
    rows = zip(t, strain * e, stress * s, strict=True)
    path.write_text("\n".join([head, *(f"{t:.8g};{e:.9g};{s:.9g}" for t, e, s in rows)]) + "\n")
    return path


@pytest.mark.parametrize(
    ("head", "strain", "stress"),
    [
        ("Time [s];Strain [%];Stress [MPa]", 100.0, 1.0),
        ("Zeit [s];Dehnung [mm/mm];Spannung [kPa]", 1.0, 1e3),
        ("time (s);compressive strain (%);compressive stress (N/mm²)", -100.0, -1.0),
    ],
)
def test_fit_of_loops_in_strain_and_stress_gives_moduli(tmp_path, head, strain, stress) -> None:
    path = write_record(tmp_path / "loops.csv", loops((0.3, 1.0, 3.0)), head, strain, stress)
    assert inspect_file(path).kind == "cyclic"
    levels = level_files([path], options=ReadOptions())
    fit = levels.fit
    assert (fit.unit, fit.amplitude_unit) == ("Pa", "strain")
    np.testing.assert_allclose(fit.amplitudes, (0.01, 0.1), rtol=2e-3)
    for line, tone in zip(fit.lines, (0.3, 1.0, 3.0), strict=True):
        true = 1e6 * modulus(tone)
        assert line.frequency_hz == pytest.approx(tone, rel=1e-3)
        assert line.storage == pytest.approx(true.real, rel=5e-3)
        assert line.loss == pytest.approx(true.imag, abs=5e-3 * true.real)


def test_read_of_loops_in_strain_and_stress_gives_a_sweep_in_pascal(tmp_path) -> None:
    sweep = dp.read(write_record(tmp_path / "loops.csv", loops()))
    assert (sweep.unit, sweep.amplitude_unit) == ("Pa", "strain")
    np.testing.assert_allclose(sweep.storage, 1e6 * modulus(1.0).real, rtol=0.01)
    assert dp.fit(sweep).unit == "Pa"


def test_loops_of_a_specimen_are_in_newtons_per_millimetre(tmp_path) -> None:
    """Of 20 mm by 50 mm²: k = E A / L."""
    path = write_record(tmp_path / "loops.csv", loops())
    units = {"displacement": "0.2mm", "force": "50N"}
    options = ReadOptions(displacement="Strain", force="Stress", units=units)
    part, material = (level_files([path], options=item).fit for item in (options, ReadOptions()))
    assert part.unit == "N/m"
    ratio = 50e-6 / 20e-3
    assert part.lines[0].storage == pytest.approx(ratio * material.lines[0].storage, rel=1e-6)
    assert part.lines[0].loss == pytest.approx(ratio * material.lines[0].loss, rel=1e-5)


def test_loops_at_one_amplitude_have_no_law_of_amplitude(tmp_path) -> None:
    """Else a softening by hundreds of times the modulus is as good as none."""
    path = write_record(tmp_path / "loops.csv", loops((0.1, 0.3, 1.0, 3.0), (0.05,)))
    levels = level_files([path])
    assert levels.fit.law == "none"
    assert [check.name for check in levels.checks if check.failed] == ["amplitudes_spread"]
    for line in levels.fit.lines:
        assert line.storage == pytest.approx(1e6 * modulus(line.frequency_hz).real, rel=0.01)


def triangle(t):
    return 0.1 * np.abs((t / 5) % 2 - 1)


@pytest.mark.parametrize(
    "motion",
    [
        triangle,
        lambda t: 0.1 * np.clip(t / 2, 0, 1),
        lambda t: 0.1 * np.clip(t / 2, 0, 1) * (t < 30),
        lambda t: 0.1 * (t % 20 < 10) * np.minimum(t % 20, 1),
    ],
)
def test_other_motions_are_no_loops(tmp_path, motion) -> None:
    t = np.arange(0, 60, 0.05)
    strain = motion(t) + np.random.default_rng(1).normal(0, 1e-5, len(t))
    path = write_record(tmp_path / "other.csv", (t, strain, 3 * strain))
    assert inspect_file(path).kind != "cyclic"


def test_too_few_loops_are_refused_with_the_other_kind(tmp_path) -> None:
    path = write_record(tmp_path / "loops.csv", loops(amplitudes=(0.05,), cycles=3))
    with pytest.raises(ReadError, match=r"two or more.*--kind stress-strain"):
        level_files([path])
    assert dp.read(path, kind="stress-strain", test="uniaxial").mode == "uniaxial"


@pytest.mark.parametrize("samples", [8, 8.3, 10])
def test_loops_of_few_samples_a_cycle_ask_for_more(tmp_path, samples) -> None:
    """They are no curve of stress over strain."""
    t = np.arange(0, 40, 1 / samples)
    strain = 0.05 * np.sin(2 * np.pi * t)
    stress = 5 * np.array([strain, 0.05 * np.cos(2 * np.pi * t)]).sum(axis=0)
    strain = strain + np.random.default_rng(4).normal(0, 1e-4, len(t))
    path = write_record(tmp_path / "loops.csv", (t, strain, stress))
    assert inspect_file(path).kind == "cyclic"
    with pytest.raises(ReadError, match="samples in a cycle"):
        level_files([path])


@pytest.mark.parametrize("samples", [7, 8, 10])
def test_triangles_of_few_samples_a_cycle_are_no_loops(tmp_path, samples) -> None:
    t = np.arange(0, 40, 1 / samples) + 0.013
    strain = 0.05 * (2 * np.abs(2 * (t % 1) - 1) - 1)
    path = write_record(tmp_path / "triangles.csv", (t, strain, 3 * strain))
    assert inspect_file(path).kind != "cyclic"


def test_cycles_between_two_amplitudes_do_not_move_the_frequency(tmp_path) -> None:
    """They are shorter or longer than the others."""
    per_cycle, sizes = 16, (0.01, 0.02, 0.04, 0.08)
    t = np.arange(10 * per_cycle * len(sizes)) / per_cycle
    wave = 2 * np.pi * t + 0.3
    strain = np.repeat(sizes, 10 * per_cycle) * np.sin(wave)
    stress = 5 * np.repeat(sizes, 10 * per_cycle) * np.sin(wave + 0.2)
    path = write_record(tmp_path / "loops.csv", (t, strain, stress))
    (line,) = level_files([path]).fit.lines
    assert line.frequency_hz == pytest.approx(1.0, rel=1e-3)
    assert line.storage == pytest.approx(5e6 * np.cos(0.2), rel=5e-3)


def test_loops_are_drawn_in_strain_and_stress(tmp_path) -> None:
    path = write_record(tmp_path / "loops.csv", loops())
    for name in ("loops.svg", "loops.html", "loops.json"):
        option = "--plot" if name.endswith("svg") else "-o"
        with pytest.raises(SystemExit) as ended:
            main(["fit", str(path), option, str(tmp_path / name)])
        assert ended.value.code in {0, None}
    drawn = (tmp_path / "loops.svg").read_text()
    assert "MPa" in drawn
    assert "N/mm" not in drawn
    assert "storage E" in drawn
    document = json.loads((tmp_path / "loops.json").read_text())
    assert (document["unit"], document["amplitude_unit"]) == ("Pa", "strain")


def test_steady_cycles_of_strain_are_those_of_a_unit_specimen() -> None:
    t, e, s = loops()
    record = StressStrainLoops(t, e, 1e6 * s, units="SI")
    part = dp.RelaxationTest(t, 1e-3 * e, 1e-6 * 1e6 * s, units="SI")
    material, other = compute_sweep(record), compute_sweep(part)
    np.testing.assert_allclose(material.value, 1e3 * other.value, rtol=1e-9)
    assert len(find_steady_cycles(record)) == len(material.amplitude)


def test_read_loops_takes_a_stated_unit_of_strain(tmp_path) -> None:
    path = write_record(tmp_path / "loops.csv", loops(), "Time [s];Strain;Stress [MPa]", 1.0)
    options = ReadOptions(kind="cyclic", units={"strain": "1"})
    assert isinstance(read_loops(path, options=options), StressStrainLoops)


@pytest.mark.parametrize(("strain", "stress"), [(1.0, -1.0), (-1.0, 1.0)])
def test_loops_whose_stress_counts_the_other_way_dissipate(tmp_path, strain, stress) -> None:
    path = write_record(tmp_path / "loops.csv", loops(), strain=100 * strain, stress=stress)
    fit = level_files([path]).fit
    assert fit.lines[0].storage == pytest.approx(1e6 * modulus(1.0).real, rel=5e-3)
    assert fit.lines[0].loss == pytest.approx(1e6 * modulus(1.0).imag, rel=0.05)
    assert "stress falls where the motion rises" in " ".join(fit.source.notes)


@pytest.mark.parametrize("noise", [0.0, 1e-5, 1e-3])
def test_clipped_loops_are_not_used(tmp_path, noise) -> None:
    t, e, s = loops()
    cut = np.minimum(s, 0.5) + np.random.default_rng(2).normal(0, noise, len(s))
    for stress, failed in ((cut, True), (s, False)):
        path = write_record(tmp_path / "loops.csv", (t, e, stress))
        levels = level_files([path])
        names = {check.name for check in levels.checks if check.failed}
        assert ("loops_not_clipped" in names) is failed
        assert (levels.verdict.use == "do not use") is failed


def test_loops_after_a_ramp_and_a_rest_are_loops(tmp_path) -> None:
    t, e, s = loops()
    before = np.arange(0, 15, 0.02)
    ramp = MEAN * np.clip((before - 2) / 2, 0, 1)
    record = (np.append(before, 15 + t), np.append(ramp, e), np.append(E_INF * ramp, s))
    path = write_record(tmp_path / "loops.csv", record)
    assert inspect_file(path).kind == "cyclic"
    (line,) = level_files([path]).fit.lines
    assert line.storage == pytest.approx(1e6 * modulus(1.0).real, rel=5e-3)


def test_a_sweep_of_the_frequency_is_refused(tmp_path) -> None:
    """Its cycles have each a frequency of its own."""
    t = np.arange(0, 40, 0.005)
    strain = MEAN + 0.03 * np.sin(2 * np.pi * (0.2 * t + 0.06 * t**2))
    path = write_record(tmp_path / "sweep.csv", (t, strain, 5 * strain))
    with pytest.raises(FitError, match="effects of frequency and of amplitude"):
        level_files([path])


@pytest.mark.parametrize(
    ("head", "strain", "stress", "requested"),
    [
        ("Time [s];Strain [%];Stress [MPa]", 1.0, 1.0, "strain=1"),
        ("Time [s];Strain [mm/mm];Stress [MPa]", 100.0, 1.0, "strain=%"),
        ("Time [s];Strain [%];Stress [MPa]", 100.0, 1e3, "stress=MPa"),
        ("Time [s];Strain [%];Stress [kPa]", 100.0, 1.0, "stress=kPa"),
    ],
)
def test_loops_of_no_rubber_raise_a_question(tmp_path, head, strain, stress, requested) -> None:
    path = write_record(tmp_path / "loops.csv", loops(), head, strain, stress)
    with pytest.raises(ReadError, match=requested):
        level_files([path])


def test_loops_without_a_clock_need_their_rate(tmp_path) -> None:
    _, e, s = loops()
    rows = "\n".join(
        f"{100 * strain:.9g};{stress:.9g}" for strain, stress in zip(e, s, strict=True)
    )
    (tmp_path / "loops.csv").write_text(f"Strain [%];Stress [MPa]\n{rows}\n")
    with pytest.raises(ReadError, match="--rate"):
        level_files([tmp_path / "loops.csv"])
    (line,) = level_files([tmp_path / "loops.csv"], options=ReadOptions(rate=80.0)).fit.lines
    assert line.frequency_hz == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize(
    "sizes", [(0.01, 0.02, 0.04), (0.04, 0.02, 0.01), (0.08, 0.02, 0.005)], ids=str
)
def test_noisy_loops_of_displacement_and_force_are_no_relaxation(tmp_path, sizes):
    """Turns of small cycles beside large ones look held; a specimen of 20 mm and 50 mm2."""
    time, strain, stress = loops(amplitudes=sizes)
    strain = strain + np.random.default_rng(2).normal(0, 0.001 * max(sizes), len(strain))
    native = write_record(
        tmp_path / "n.csv", (time, strain, stress), "Time [s];Travel [mm];Force [N]",
        20.0, 50.0,
    )  # fmt: skip
    assert inspect_file(native).kind == "cyclic"
    (line,) = level_files([native]).fit.lines
    true = modulus(1.0) * 50 / 20 * 1e3
    assert line.storage == pytest.approx(true.real, rel=0.01)
    assert line.loss == pytest.approx(true.imag, abs=0.01 * true.real)


def test_harmonic_conditioning_before_a_hold_is_a_relaxation(tmp_path):
    time = np.arange(0, 120, 0.02)
    wave = 5 - 5 * np.cos(np.pi * time)
    x = np.where(time < 60, wave, np.minimum(10, 5 * (time - 60)))
    x = x + np.random.default_rng(3).normal(0, 0.01, len(x))
    force = x * (2 + 0.2 * np.exp(-np.maximum(time - 62, 0) / 5))
    path = write_record(
        tmp_path / "p.csv", (time, x, force), "Time [s];Travel [mm];Force [N]", 1.0, 1.0
    )
    assert inspect_file(path).kind == "relaxation"
