"""Modes of an FRF file: the truth within their errors, and what the lines do not determine."""

from dataclasses import replace

import numpy as np
import pytest
from kit.shell import ran, run_json

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.base.number_format import round_to_error
from dashpot.datamodel.frf import FRF, Mode
from dashpot.datamodel.structure import FRFSet
from dashpot.extensions.formats.write_uff import frf_uff
from dashpot.extensions.modes.checks import STABLE, modes_within_band
from dashpot.extensions.modes.mass_series_files import modes_by_mass
from dashpot.extensions.modes.measured_modes import modes_files
from dashpot.extensions.modes.mode_shapes import phase_collinearity, phase_deviation
from dashpot.extensions.modes.read_frf_set import read_frfs
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.frf import read_frf
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.write import write_frf
from dashpot.workflow.measured_frf import format_modes_headline

# undamped natural frequency, Hz, damping ratio, mass, kg: two bodies seen at one point
TRUE = ((12.7, 0.02, 0.1), (31.0, 0.04, 0.15))
F = np.arange(1.0, 80.0, 0.05)


def simulate_accelerance(noise=0.01, seed=0):
    """Accelerance of viscously damped modes with scatter, from its closed form alone."""
    s = 2j * np.pi * F
    value = np.zeros(len(F), dtype=complex)
    for frequency, ratio, mass in TRUE:
        w = 2 * np.pi * frequency
        value += s**2 / (mass * (s**2 + 2 * ratio * w * s + w**2))
    sd, rng = noise * np.abs(value), np.random.default_rng(seed)
    value = value + sd * (rng.normal(size=len(F)) + 1j * rng.normal(size=len(F)))
    return FRF(F, value, sd=sd, coherence=np.full(len(F), 0.99), averages=5, units="SI")


def save_frf(folder, frf, name="frf.csv"):
    path = folder / name
    path.write_bytes(frf_uff(frf) if name.endswith(".uff") else write_frf(frf).encode())
    return path


def modes_of(*paths, **choices):
    return modes_files(paths, **choices)[0]


def fit_modes(path, *words):
    paths = path if isinstance(path, list) else [path]
    return run_json("fit", *paths, *words)


def test_a_transmissibility_has_the_poles_of_any_mass(tmp_path):
    per_force = simulate_accelerance()
    kinds = "transmissibility", "relative_transmissibility"
    over = [per_force.to(kind, mass=0.104) for kind in kinds]
    paths = [save_frf(tmp_path, frf, f"{i}.csv") for i, frf in enumerate((per_force, *over))]
    by_force, *by_base = [modes_of(path, band=(5.0, 50.0)) for path in paths]
    for result in by_base:
        assert result.frf.quantity.over_base
        for mode, other in zip(result.modes, by_force.modes, strict=True):
            assert mode.frequency_hz == pytest.approx(other.frequency_hz, rel=1e-6)
            assert mode.damping_ratio == pytest.approx(other.damping_ratio, rel=1e-4)
            # of 1 kg, where 104 g were on the base
            assert mode.modal_mass == pytest.approx(other.modal_mass / 0.104, rel=1e-4)
    text = ran("compare", str(paths[0]), str(paths[1]), "--band", "5:50Hz").output
    assert "those of 1 kg" not in text
    assert "those of 1 kg on the base" in ran("fit", str(paths[1]), "--band", "5:50Hz").output


def test_who_says_that_the_motion_is_relative_is_heard(tmp_path):
    over = simulate_accelerance().to("relative_transmissibility", mass=0.104)
    unsaid = replace(over, quantity="transmissibility")
    words = ("--band", "5:50Hz")
    modes = fit_modes(save_frf(tmp_path, over), *words)["modes"]
    message = fit_modes(save_frf(tmp_path, unsaid, "unsaid.csv"), *words, "--relative")["modes"]
    assert [mode["frequency_hz"] for mode in message] == [mode["frequency_hz"] for mode in modes]


def test_modes_of_masses_on_a_base_agree_with_one_model(tmp_path):
    paths = []
    for mass in (0.1, 0.2):
        s = 2j * np.pi * F
        k = 640 + 4.0 * s
        over = FRF(F[1:], (k / (k + mass * s**2))[1:], "transmissibility", units="SI")
        paths.append(save_frf(tmp_path, over, f"{mass}.csv"))
    picture = tmp_path / "a.svg"
    words = ("--mass", "100g", "--mass", "200g", "--band", "4:30Hz", "--plot", str(picture))
    assert ran("fit", *map(str, paths), *words).exit_code == 0
    assert picture.exists()
    modes = modes_by_mass(paths, [0.1, 0.2], band=(4.0, 30.0))
    # k + b p at the poles, whose real part is -b / 2 m
    np.testing.assert_allclose([k.real for k in modes.joint_modes.stiffness], [560, 600], rtol=1e-4)


def test_frf_set_refuses_mixed_kinds():
    frf = simulate_accelerance()
    with pytest.raises(DataError, match="of '2' is transmissibility, that of '1' accelerance; exp"):
        FRFSet((frf, frf.to("transmissibility", mass=0.1)))


@pytest.mark.parametrize("kind", ["accelerance", "mobility", "receptance", "dynamic_stiffness"])
def test_modes_of_a_file_of_any_kind_are_the_true_ones(tmp_path, kind):
    result = fit_modes(save_frf(tmp_path, simulate_accelerance().to(kind)), "--band", "5:50Hz")
    assert result["schema"] == "dashpot/modes@2"
    assert result["band"] == [5.0, 50.0]
    assert len(result["modes"]) == len(TRUE)
    modes = sorted(result["modes"], key=lambda mode: mode["frequency_hz"])
    for mode, (frequency, ratio, mass) in zip(modes, TRUE, strict=True):
        assert abs(mode["frequency_hz"] - frequency) < 4 * mode["frequency_se_hz"] < 0.02
        assert abs(mode["damping_ratio"] - ratio) < 4 * mode["damping_ratio_se"] < 0.002
        residue = complex(mode["residue_real"], mode["residue_imag"])
        damped = 2 * np.pi * frequency * np.sqrt(1 - ratio**2)
        assert abs(residue - 1 / (2j * mass * damped)) < 4 * mode["residue_se"]
        assert mode["modal_mass"] == pytest.approx(mass, rel=0.01)
    assert all(check["passed"] for check in result["checks"])


def test_the_errors_are_those_of_many_tests():
    draws = [simulate_accelerance(seed=i).modes(band=(5, 50)) for i in range(12)]
    for pick in (0, 1):
        true = TRUE[pick]
        near = [next(m for m in d if abs(m.frequency - true[0]) < 2) for d in draws]
        z = [(m.frequency - true[0]) / m.frequency_se for m in near]
        z += [(m.damping_ratio - true[1]) / m.damping_ratio_se for m in near]
        assert 0.6 < np.sqrt(np.mean(np.square(z))) < 1.5


def test_a_uff_and_a_csv_tell_the_same_modes(tmp_path):
    frf = replace(simulate_accelerance(), sd=None)
    modes, other = (modes_of(save_frf(tmp_path, frf, name)) for name in ("a.csv", "a.uff"))
    for mine, its in zip(modes.modes, other.modes, strict=True):
        assert its.frequency_hz == pytest.approx(mine.frequency_hz, rel=1e-6)
        assert its.damping_ratio == pytest.approx(mine.damping_ratio, rel=1e-4)


def test_measured_modes_report_missing_file_information(tmp_path):
    bare = modes_of(
        save_frf(tmp_path, replace(simulate_accelerance(), sd=None, coherence=None, averages=0))
    )
    assert "line_errors_stated" in {check.name for check in bare.frf.checks if check.failed}
    doubtful = replace(simulate_accelerance(), coherence=np.full(len(F), 0.89))
    failed = {c.name for c in modes_of(save_frf(tmp_path, doubtful)).frf.checks if c.failed}
    assert failed == {"coherence"}
    other_sign = replace(simulate_accelerance(), value=simulate_accelerance().value.conj())
    failed = {c.name for c in modes_of(save_frf(tmp_path, other_sign)).frf.checks if c.failed}
    assert "frf_dissipates" in failed or "resonance" in failed
    result = ran("fit", save_frf(tmp_path, other_sign))
    assert result.stdout.startswith("Do not use:")


def test_measured_modes_without_a_resonance_report_none(tmp_path):
    frf = simulate_accelerance(noise=0.02)
    modes = fit_modes(save_frf(tmp_path, frf), "--band", "50:79Hz")
    assert modes["modes"] == []
    assert [c["name"] for c in modes["checks"] if c["passed"] is False] == ["resonance"]


def test_modes_check_reports_a_mode_outside_the_band():
    mode = dp.systems.predict_frf(
        dp.GeneralizedMaxwell(400.0, (30.0,), (0.01,)), mass=0.1, frequency=F
    )
    (mode,) = mode.modes()
    assert modes_within_band((mode,), (mode.frequency, 40.0)).passed
    finding = modes_within_band((mode,), (mode.frequency * 1.001, 40.0))
    assert finding.failed
    assert f"{mode.frequency:.4g} Hz" in finding.message


# -- several points -------------------------------------------------------------------------------

# undamped natural frequency, Hz, damping ratio, mass, kg, shape: two modes 2 % apart
G = np.arange(4.0, 80.0, 0.1)
CLOSE = ((20.0, 0.04, 0.1, (1, 0.8, 0.5, -0.2)), (20.4, 0.04, 0.15, (1, -0.5, 0.3, 0.9)))


def points(modes=CLOSE, noise=0.02, seed=0):
    """FRFs at every point of a structure that is struck at the first, from its closed form."""
    s, rng, frfs = 2j * np.pi * G, np.random.default_rng(seed), []
    for i in range(len(modes[0][3])):
        value = np.zeros(len(G), dtype=complex)
        for frequency, ratio, mass, shape in modes:
            w = 2 * np.pi * frequency
            p = w * complex(-ratio, np.sqrt(1 - ratio**2))
            r = shape[i] / (2j * mass * p.imag)
            value += s**2 * (r / (s - p) + np.conj(r) / (s - np.conj(p)))
        sd = noise * np.abs(value)
        value = value + sd * (rng.normal(size=len(G)) + 1j * rng.normal(size=len(G)))
        frfs.append(FRF(G, value, sd=sd, units="SI"))
    return frfs


def as_text(folder, frfs, name="points.csv"):
    head, columns = ["frequency [Hz]"], [G]
    for point, frf in zip("abcd", frfs, strict=True):
        head += [f"{part} {point} [1/kg]" for part in ("real", "imaginary", "sd")]
        columns += [frf.value.real, frf.value.imag, frf.sd]
    path = folder / name
    np.savetxt(path, np.transpose(columns), delimiter=",", header=",".join(head), comments="")
    return path


def as_uff(folder, frfs):
    import pyuff

    path = folder / "points.uff"
    path.write_bytes(frf_uff(frfs[0]))
    item = pyuff.UFF(str(path)).read_sets(2)
    sets = [
        {**item, "data": frf.value, "rsp_node": i + 1, "rsp_dir": (-1) ** i * 3}
        for i, frf in enumerate(frfs)
    ]
    pyuff.UFF(str(path)).write_sets(sets, mode="overwrite")
    return path


def test_modes_of_close_poles_are_separated_by_their_shapes(tmp_path):
    result = fit_modes(as_text(tmp_path, points()), "--band", "5:79Hz")
    assert result["points"] == ["a", "b", "c", "d"]
    modes = sorted(result["modes"], key=lambda mode: mode["frequency_hz"])
    for mode, (frequency, ratio, _, shape) in zip(modes, CLOSE, strict=True):
        assert abs(mode["frequency_hz"] - frequency) < 4 * mode["frequency_se_hz"] < 0.06
        assert abs(mode["damping_ratio"] - ratio) < 4 * mode["damping_ratio_se"] < 0.004
        for part, true in zip(mode["shape"], shape, strict=True):
            assert abs(complex(part["real"], part["imag"]) - true) < 0.15
        assert mode["phase_collinearity"] > 0.98
        assert mode["phase_deviation_deg"] < 5
        assert mode["orders"] >= 5
    mac = np.array(result["mac"])
    assert mac.diagonal() == pytest.approx(1)
    true = np.array([shape for *_, shape in CLOSE], dtype=complex).T
    assert mac[0, 1] == pytest.approx(dp.systems.mac(true, true)[0, 1], abs=0.1)
    # one point alone cannot: it shows one mode between the two
    (single,) = modes_of(save_frf(tmp_path, points()[0]), band=(5, 79)).modes
    assert 20.0 < single.frequency_hz < 20.4


@pytest.mark.once
def test_columns_files_and_a_uff_tell_the_same(tmp_path):
    frfs = [replace(frf, sd=None) for frf in points(noise=0.002)]
    files = [save_frf(tmp_path, frf, f"p{i}.csv") for i, frf in enumerate(frfs)]
    text = as_text(tmp_path, [replace(frf, sd=np.ones(len(G))) for frf in frfs])
    every = read_frfs(files), read_frfs(text), read_frfs(as_uff(tmp_path, frfs))
    assert [item.points for item in every] == [
        ("p0", "p1", "p2", "p3"),
        ("a", "b", "c", "d"),
        ("1+Z/1+Z", "2+Z/1+Z", "3+Z/1+Z", "4+Z/1+Z"),
    ]
    # accelerometers 2 and 4 stand against the axis in the UFF, whose values are then turned
    for element, against in zip(every, (1, 1, -1), strict=True):
        for mine, its, sign in zip(element.frfs, frfs, (1, against, 1, against), strict=True):
            np.testing.assert_allclose(mine.value, sign * its.value, rtol=1e-5)
    with pytest.raises(dp.ReadError, match=r"4 FRFs in the file: .*; choose one, for example"):
        read_frf(tmp_path / "points.uff")


def test_points_on_other_lines_are_refused(tmp_path):
    item, other = points()[:2]
    files = [
        save_frf(tmp_path, item, "a.csv"),
        save_frf(tmp_path, other.band(4.95, 40.05), "b.csv"),
    ]
    with pytest.raises(dp.DataError, match="'b' has 351 lines from 5 to 40 Hz, 'a' 760 from 4"):
        modes_of(*files)


def chain(damper):
    """FRFs of three masses in a row, the first struck, and its poles and residues: by eigenvalues.

    A damper between two of them alone is not proportional: their shapes are complex.
    """
    mass, stretch = np.diag([0.3, 0.2, 0.25]), np.array([[1, 0, 0], [-1, 1, 0], [0, -1, 1]])
    k, c = (stretch.T @ np.diag(x) @ stretch for x in ([2e3, 3e3, 2.5e3], [0.3, damper, 0.1]))
    inverse = np.linalg.inv(mass)
    state = np.block([[np.zeros((3, 3)), np.eye(3)], [-inverse @ k, -inverse @ c]])
    poles, vectors = np.linalg.eig(state)
    started = np.linalg.solve(vectors, np.append(np.zeros(3), inverse[:, 0]))
    up = poles.imag > 0
    poles, residues = poles[up], (vectors[:3] * started)[:, up]
    s = 2j * np.pi * G[:, None]
    value = [
        (s**2 * (r / (s - poles) + r.conj() / (s - poles.conj()))).sum(axis=1) for r in residues
    ]
    return (
        dp.FRFSet([FRF(G, value, sd=1e-3 * np.abs(value), units="SI") for value in value]),
        poles,
        residues,
    )


@pytest.mark.once
@pytest.mark.parametrize("damper", [0.1, 4.0])
def test_a_lone_damper_makes_shapes_complex(damper):
    measured, poles, residues = chain(damper)
    modes = measured.modes(band=(4, 60))
    assert len(modes) == 3
    for mode in modes:
        i = int(np.argmin(np.abs(poles - mode.mode.pole)))
        assert abs(mode.mode.pole / poles[i] - 1) < 1e-4
        assert phase_collinearity(mode.residues) == pytest.approx(
            phase_collinearity(residues[:, i]), abs=1e-3
        )
        assert phase_deviation(mode.residues) == pytest.approx(
            phase_deviation(residues[:, i]), abs=2e-3
        )
    least = min(phase_collinearity(item.residues) for item in modes)
    assert least > 0.999 if damper < 1 else least < 0.98


@pytest.mark.once
def test_modes_in_a_band_ignore_modes_outside():
    measured, poles, _ = chain(4.0)
    first, second, third = np.sort(np.abs(poles)) / (2 * np.pi)
    for band in ((4.0, 1.06 * second), (4.0, 0.97 * third), (1.05 * first, 60.0)):
        modes = measured.modes(band=band)
        assert len(modes) == 2
        for mode in modes:
            true = poles[np.argmin(np.abs(poles - mode.mode.pole))]
            assert band[0] < abs(true) / (2 * np.pi) < band[1]
            off = mode.mode.frequency - abs(true) / (2 * np.pi)
            assert abs(off) < 4 * mode.mode.frequency_se < 1e-2 * mode.mode.frequency
            off = mode.mode.damping_ratio + true.real / abs(true)
            assert abs(off) < 4 * mode.mode.damping_ratio_se


def test_collinear_and_circular_shapes_are_the_two_ends():
    straight = np.array([1.0, -0.5, 0.3, -0.9]) * np.exp(0.7j)
    assert phase_collinearity(straight) == pytest.approx(1)
    assert phase_deviation(straight) == pytest.approx(0, abs=1e-9)
    circle = np.exp(2j * np.pi * np.arange(8) / 8)
    assert phase_collinearity(circle) == pytest.approx(0, abs=1e-9)
    # evenly spread over a quarter turn to either side: 45 degrees on average
    assert phase_deviation(circle) == pytest.approx(np.pi / 4)


@pytest.mark.once
def test_compare_pairs_modes_of_two_tests_of_the_same_points(tmp_path):
    first, second = (as_text(tmp_path, points(seed=i), f"{i}.csv") for i in (0, 1))
    document = run_json("compare", first, second, "--band", "5:79Hz")
    assert [entry["other"] for entry in document["matched_modes"]] == [1, 2]
    assert min(entry["mac"] for entry in document["matched_modes"]) > 0.98
    result = ran("compare", first, save_frf(tmp_path, points()[0]))
    assert result.exit_code == 2
    assert "4 points are held against 1" in result.output


@pytest.mark.once
def test_the_chart_is_drawn(tmp_path):
    figure = tmp_path / "chart.svg"
    words = ("--band", "5:79Hz", "--plot", figure)
    assert ran("fit", as_text(tmp_path, points()), *words).exit_code == 0
    assert "stable in frequency, damping and shape" in figure.read_text()


def test_points_measured_at_two_states_are_not_two_modes(tmp_path):
    frfs = [points([(hz, 0.01, 0.1, (1,))], noise=0.01)[0] for hz in (20.0, 19.8)]
    modes = modes_of(*(save_frf(tmp_path, frf, f"{i}.csv") for i, frf in enumerate(frfs)))
    assert "points_share_modes" in {check.name for check in modes.frf.checks if check.failed}
    modes = modes_of(as_text(tmp_path, points()), band=(5, 79))
    assert not [check.name for check in modes.frf.checks if check.failed]


@pytest.mark.once
def test_modes_ignore_hum_on_a_single_line(tmp_path):
    frf = simulate_accelerance()
    value = frf.value.copy()
    value[np.argmin(np.abs(F - 45))] *= 6
    file = save_frf(tmp_path, replace(frf, value=value))
    result = sorted(mode.frequency_hz for mode in modes_of(file, band=(5, 70)).modes)
    assert result == pytest.approx([true[0] for true in TRUE], rel=1e-3)
    with pytest.raises(dp.ReadError, match=r"^frf\.csv is given twice"):
        modes_of(file, file)


# -- the stabilisation chart ----------------------------------------------------------------------


@pytest.mark.once
@pytest.mark.parametrize("ratio", [0.005, 0.3])
@pytest.mark.parametrize("count", [1, 4])
def test_light_and_heavy_modes_stand_at_most_orders_and_nothing_else_does(ratio, count):
    modes = [(20.0, ratio, 0.1, CLOSE[0][3][:count]), (47.0, ratio, 0.15, CLOSE[1][3][:count])]
    measured = dp.FRFSet(points(modes, noise=0.02))
    chart = dp.systems.stabilisation(measured, band=(5, 79))
    result = measured.modes(band=(5, 79))
    assert len(result) == 2
    assert min(chart.orders_with(item.mode) for item in result) > 15
    reach = 0.04 if ratio < 0.1 else 0.2
    near = [np.abs(chart.frequency / hz - 1) < reach for hz, *_ in modes]
    assert np.count_nonzero(chart.stable & ~near[0] & ~near[1]) < STABLE


def test_modes_of_noise_are_empty():
    rng = np.random.default_rng(0)
    for _ in range(5):
        value = rng.normal(size=(2, len(G))) + 1j * rng.normal(size=(2, len(G)))
        measured = dp.FRFSet([FRF(G, item, sd=np.ones(len(G)), units="SI") for item in value])
        assert measured.modes(band=(5, 79)) == ()


@pytest.mark.once
def test_the_errors_of_several_points_are_those_of_many_tests():
    z, two = [], [(*rest, shape[:2]) for *rest, shape in CLOSE]
    for seed in range(6):
        modes = dp.FRFSet(points(two, seed=seed)).modes(band=(12, 34))
        for mode, (hz, ratio, *_) in zip(
            sorted(modes, key=lambda item: item.mode.frequency), two, strict=True
        ):
            z += [
                (mode.mode.frequency - hz) / mode.mode.frequency_se,
                (mode.mode.damping_ratio - ratio) / mode.mode.damping_ratio_se,
            ]
    assert 0.6 < np.sqrt(np.mean(np.square(z))) < 1.5


# -- several masses -------------------------------------------------------------------------------


def on_seals(folder, mass, stiffer=1.0):
    """A mass on two seals with arms of 0.5 s to 3 ms, from the stiffness alone; 1 % scatter."""
    s, rng = 2j * np.pi * F, np.random.default_rng(round(1e3 * mass))
    arms = ((60, 0.5), (40, 0.08), (40, 0.016), (40, 0.0032))
    stiffness = 400 + sum(k * s * tau / (1 + s * tau) for k, tau in arms)
    value = s**2 / (mass * s**2 + stiffer * stiffness)
    sd = 0.01 * np.abs(value)
    value = value + sd * (rng.normal(size=len(F)) + 1j * rng.normal(size=len(F)))
    return save_frf(folder, FRF(F, value, sd=sd, units="SI"), f"{mass}.csv")


@pytest.mark.once
def test_modes_by_mass_check_one_model_for_all_masses(tmp_path):
    masses = (0.104, 0.25, 0.6)
    files = [on_seals(tmp_path, mass) for mass in masses]
    modes = modes_by_mass(files, masses, seals=2)
    assert modes.checks[0].name == "single_solid_explains_masses"
    assert modes.checks[0].passed
    for mode, k in zip(modes.joint_modes.modes, modes.joint_modes.stiffness, strict=True):
        s = mode.pole
        arms = ((60, 0.5), (40, 0.08), (40, 0.016), (40, 0.0032))
        true = (400 + sum(k * s * tau / (1 + s * tau) for k, tau in arms)) / 2
        assert k.real == pytest.approx(true.real, rel=1e-3)
        assert k.imag == pytest.approx(true.imag, rel=2e-2)
    figure = tmp_path / "masses.svg"
    words = [word for mass in masses for word in ("--mass", f"{1e3 * mass:g}g")]
    words = ["fit", *files, *words, "--seals", "2"]
    assert ran(*words, "--plot", figure).exit_code == 0
    drawn = figure.read_text()
    assert all(
        f"{round_to_error(hz, digits=4)} Hz" in drawn
        for hz in (m.frequency for m in modes.joint_modes.modes)
    )
    # one seal 3 % stiffer under the middle mass is no arm's doing
    on_seals(tmp_path, 0.25, stiffer=1.03)
    result = ran(*words)
    assert result.exit_code == 0, result.output
    assert "no linear model has the poles under 104, 250, 600 g" in " ".join(result.output.split())
    assert "The closest misses 250 g" in modes_by_mass(files, masses, seals=2).checks[0].message


@pytest.mark.once
@pytest.mark.parametrize(("band", "silent"), [((1, 7.5), "104 g"), ((9, 40), "250 g")])
def test_a_mass_under_which_nothing_rings_is_named(tmp_path, band, silent):
    masses = (0.104, 0.25)
    files = [on_seals(tmp_path, mass) for mass in masses]
    with pytest.raises(dp.DataError, match=f"nothing rings under the mass of {silent}"):
        modes_by_mass(files, masses, seals=2, band=band)


@pytest.mark.once
def test_masses_and_files_go_together(tmp_path):
    file = str(on_seals(tmp_path, 0.25))
    result = ran("fit", file, "--mass", "250g", "--mass", "104g")
    assert result.exit_code == 2
    assert "--mass was given 2 times for one file. Give the mass of each" in result.output
    again = tmp_path / "again.csv"
    again.write_bytes((tmp_path / "0.25.csv").read_bytes())
    for other, names in ((file, "0.25.csv"), (str(again), "0.25.csv and again.csv")):
        with pytest.raises(dp.DataError, match=f"^{names}: the same FRF is given under 104 and"):
            modes_by_mass([file, other], (0.104, 0.25))


@pytest.mark.parametrize(
    ("count", "message"),
    [
        (0, "0 modes were found"),
        (1, "damping ratio 3.00 ± 0.10 %"),
        (3, ", the first of three modes"),
    ],
)
def test_modes_headline_states_the_number_of_modes(count, message):
    modes = [Mode(12.7 + i, 0.03, 0j, 0.01, 0.001, 0.0, "fitted") for i in range(count)]
    modes_headline = format_modes_headline(modes)
    assert modes_headline.endswith(message), modes_headline
    assert ("12.7" in modes_headline) == bool(count)


def test_inspect_asks_of_several_points_what_their_fit_asks(tmp_path):
    lines = np.arange(6.4, 25.0, 0.2)
    value = 1 / (1 - (lines / 12.7) ** 2 + 0.04j * lines / 12.7)
    columns = [
        lines,
        *(part for size in (1.0, 0.8) for part in (size * value.real, size * value.imag)),
    ]
    rows = ["Frequency,real1,imag1,real2,imag2"]
    rows += [",".join(f"{cell:.9g}" for cell in row) for row in zip(*columns, strict=True)]
    path = tmp_path / "points.csv"
    path.write_text("\n".join(rows) + "\n")
    (question,) = inspect_file(path).questions
    assert "no unit" in question.message
    assert "could each be" not in question.message
    units = {"real": "(m/s^2)/N", "frequency": "Hz"}
    assert not inspect_file(path, options=ReadOptions(units=units)).questions
    assert len(read_frfs(path, options=ReadOptions(units=units)).frfs) == 2
