"""dashpot fit over amplitude: sweeps, loops and FRFs of several levels, as labs hold them."""

from __future__ import annotations

import json

import numpy as np
import pytest
from kit import shell
from kit.kinds import save_table

import dashpot as dp
from dashpot.extensions.amplitude.fit_files import level_files
from dashpot.extensions.amplitude.page import format_residual_note, list_level_values
from dashpot.extensions.systems.multibody import Mount, System, point_mass
from dashpot.reading.readers.impact import read_impact
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.write import write_frf
from dashpot.solids.networks import spring
from dashpot.vibration.impact.frf_estimation import estimate_frf

pytestmark = pytest.mark.once

SEAL = dp.GeneralizedMaxwell(393.0, (235.0, 35.6), (0.502, 0.012))
SLIDER = dp.solids.friction.Jenkins(100.0, 0.05)


def ran(*words, code=0):
    done = shell.did("fit", *words, "--json", code=code)
    return json.loads(done.stdout) if code == 0 else done.output


def payne(X):
    return (spring(2.0) + dp.solids.friction.Kraus(3.0, 0.004)).equivalent(1.0, X)


@pytest.mark.parametrize(
    ("header", "scale"),
    [
        ("Frequency [Hz],Strain [%],Storage modulus [MPa],Loss modulus [MPa]", (100, 1)),
        ("f (Hz),Displacement (mm),K' (N/mm),K'' (N/mm)", (1e3, 1e-3)),
    ],
)
def test_a_sweep_is_read_as_a_sweep_of_amplitude(tmp_path, header, scale):
    X = np.geomspace(1e-4, 0.05, 16) * (1 if "Strain" in header else 1e-1)
    K = 1e3 * payne(X * (1 if "Strain" in header else 10)) * scale[1]
    path = save_table(
        tmp_path / "sweep.csv", header, np.full(16, 10.0), X * scale[0], K.real, K.imag
    )
    assert inspect_file(path).kind == "strain-sweep"
    result = ran(path)
    half = 0.004 * (1 if "Strain" in header else 1e-1)
    assert result["half_way"] == pytest.approx(half, rel=1e-3)
    assert result["amplitude_unit"] == ("strain" if "Strain" in header else "m")
    assert result["law"] == ("factor" if "Strain" in header else "additive")
    # and never as one of frequency
    assert "recognised sweep.csv: an amplitude sweep" in shell.ran("fit", path).stderr


GRID = np.geomspace(1e-4, 0.05, 12)


def write_crossed_sweep(
    path, header, *, order=slice(None), jitter=0.0, warm=lambda n, X: 20 + 0 * X, scale=100
):
    """Three frequencies by twelve strains: frequency, amplitude, MPa, degC."""
    hz, X = (item.ravel() for item in np.meshgrid([1.0, 10.0, 100.0], GRID, indexing="ij"))
    K = 1e3 * hz**0.06 * payne(X)
    T = warm(np.repeat([0, 1, 2], len(GRID)), X)
    hz = hz * (1 + jitter * np.random.default_rng(2).normal(size=len(X)))
    return save_table(
        path, header, *(c[order] for c in (hz, scale * X, K.real / 1e3, K.imag / 1e3, T))
    )


@pytest.mark.parametrize(
    ("column", "over"),
    [
        ("Strain p-p [%]", 2.0),
        ("Dynamic strain pk-pk [%]", 2.0),
        ("Double Strain Amplitude [%]", 2.0),
        ("DSA strain [%]", 2.0),
        ("Dehnung Spitze-Spitze [%]", 2.0),
        ("Strain rms [%]", 0.5**0.5),
        ("Strain 0-p [%]", 1.0),
        ("Single strain amplitude [%]", 1.0),
    ],
)
def test_what_is_over_the_whole_cycle_is_turned_into_the_amplitude(tmp_path, column, over):
    K, name = 1e3 * payne(GRID), tmp_path / "sweep.csv"
    header = f"Frequency [Hz],Static strain [%],{column},E' [MPa],E'' [MPa]"
    save_table(name, header, 10 + 0 * GRID, 5 + 0 * GRID, 100 * over * GRID, K.real, K.imag)
    assert ran(name)["half_way"] == pytest.approx(0.004, rel=1e-3)
    stdout = shell.ran("fit", name).stdout
    assert ("it is the amplitude" in stdout) is (over != 1.0)


def test_fit_asks_which_of_two_strain_columns(tmp_path):
    name = tmp_path / "two.csv"
    header = "Frequency [Hz],Strain 1 [%],Strain 2 [%],E' [MPa],E'' [MPa]"
    save_table(name, header, 10 + 0 * GRID, 100 * GRID, 80 * GRID, 2 - GRID, 1 + 0 * GRID)
    stderr = " ".join(shell.ran("fit", name).stderr.split())
    assert "could each be the strain; say which" in stderr
    assert ran(name, "--column", "strain=Strain 2")["amplitudes"][1] == pytest.approx(
        0.8 * GRID[-1]
    )


MODULI = "E' [MPa],E'' [MPa],Temperature [degC]"


@pytest.mark.parametrize(
    ("amplitude", "words"),
    [
        ("Strain [%]", {}),
        ("Strain [%]", {"order": np.random.default_rng(1).permutation(36)}),
        ("Strain [%]", {"jitter": 0.003}),
        ("Strain [%]", {"warm": lambda n, X: 20 + 200 * X}),
        ("Amplitude [um]", {"scale": 1e4}),
    ],
)
def test_strains_at_several_frequencies_are_no_sweep_of_frequency(tmp_path, amplitude, words):
    path = write_crossed_sweep(
        tmp_path / "grid.csv", f"Frequency [Hz],{amplitude},{MODULI}", **words
    )
    assert inspect_file(path).kind == "strain-sweep"
    result = ran(path)
    assert [mode["frequency_hz"] for mode in result["linear"]] == pytest.approx(
        [1, 10, 100], rel=0.01
    )
    assert result["half_way"] == pytest.approx(0.004 if "Strain" in amplitude else 4e-5, rel=0.02)
    assert "each frequency recurs" in shell.ran("inspect", path).stdout


def test_frequency_sweep_with_varying_amplitude_remains_a_frequency_sweep(tmp_path):
    """A drive at its limit moves a cold rubber less; that is no sweep of amplitude."""
    hz, T = (item.ravel() for item in np.meshgrid(np.geomspace(1, 50, 8), [-40.0, 0.0, 40.0]))
    path = tmp_path / "warming.csv"
    header = f"Frequency [Hz],Strain [%],{MODULI}"
    K = 1e6 * np.exp(-T / 20)
    save_table(path, header, hz, 0.1 * np.exp(T / 20) * hz**0.01, K, 0.1 * K, T)
    assert inspect_file(path).kind == "dma"


def test_a_sensor_between_mass_and_base_tells_the_same_levels(tmp_path):
    system = System(
        (point_mass("mass", 0.104),), (Mount(SEAL, ("mass", "ground"), friction=SLIDER),)
    )
    hz, base = np.linspace(8, 20, 61), (0.1, 1.0)
    words = ["--mass", "104g", *(f"--amplitude={item}m/s^2" for item in base)]
    for motion, less in (("absolute", 0), ("relative", 1)):
        for element in base:
            level_response = dp.systems.response_at_level(
                system, response="mass.z", base="ground.z", frequency=hz,
                level=element / (2 * np.pi * hz) ** 2,
            )  # fmt: skip
            value = level_response.motion / level_response.level - less
            header = "frequency [Hz],real [m/m],imaginary [m/m]"
            save_table(tmp_path / f"{motion}_{element}.csv", header, hz, value.real, value.imag)
    files = {m: [tmp_path / f"{m}_{item}.csv" for item in base] for m in ("absolute", "relative")}
    result = ran(*files["absolute"], *words)
    same = ran(*files["relative"], *words, "--relative")
    assert same["amplitudes"] == pytest.approx(result["amplitudes"], rel=1e-9)
    assert same["verdict"]["verdict_grade"] == result["verdict"]["verdict_grade"] == "use"
    assert ran(*files["relative"], *words)["verdict"]["verdict_grade"] == "do not use"
    columns = 10 + 0 * GRID, 100 * GRID, 2 - GRID, 1 + 0 * GRID, 20 + 0 * GRID
    sweep = save_table(tmp_path / "sweep.csv", f"Frequency [Hz],Strain [%],{MODULI}", *columns)
    assert "--relative is for" in ran(sweep, "--relative", code=2)


@pytest.mark.parametrize(
    "named", [(), ("--column", "storage=3"), ("--column", "storage=3", "--column", "loss=4")]
)
@pytest.mark.parametrize("tones", [(10.0,), (1.0, 10.0, 100.0)])
def test_a_grid_of_strains_is_no_sweep_of_frequency_whoever_names_its_columns(
    tmp_path, named, tones
):
    path = tmp_path / "grid.csv"
    hz, strain = (item.ravel() for item in np.meshgrid(tones, GRID))
    K = payne(strain) * hz**0.05
    save_table(
        path, "f [Hz],Dehnung [%],Speicher [MPa],Verlust [MPa]", hz, 100 * strain, K.real, K.imag
    )
    assert inspect_file(path).kind == "strain-sweep"
    assert ran(path, *named)["law"] in {"factor", "additive"}


def test_the_same_strains_at_several_temperatures_are_refused(tmp_path):
    path = write_crossed_sweep(
        tmp_path / "warm.csv",
        f"Frequency [Hz],Strain [%],{MODULI}",
        warm=lambda n, X: 20 + 15 * (np.arange(len(X)) % 12 % 2),
    )
    assert ran(path)["law"] == "factor"  # each strain at one temperature: as warm as it got
    rows = path.read_text().splitlines()
    again = [",".join((*row.split(",")[:4], "60")) for row in rows[1:]]
    path.write_text("\n".join(rows + again) + "\n")
    stderr = shell.ran("fit", path).stderr
    assert "the same amplitudes at temperatures from 20 to 60 degC" in " ".join(stderr.split())


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("Stiffness", "only 'Stiffness' could be storage or loss, and it is not both"),
        ("Dynamic stiffness", "'Dynamic stiffness' is the size |K*|, and no column is its loss"),
    ],
)
def test_strain_sweep_refuses_one_column_for_storage_and_loss(tmp_path, name, message):
    header = f"Frequency [Hz],Strain [%],{name} [N/mm],Coherence"
    path = save_table(
        tmp_path / "one.csv", header, 10 + 0 * GRID, 100 * GRID, 100 - GRID, 1 + 0 * GRID
    )
    result = shell.ran("fit", path, "--kind", "strain-sweep")
    assert result.exit_code == 2
    assert message in " ".join(result.stderr.split())


@pytest.mark.parametrize(("noise", "drift"), [(0.0, 0.0), (2e-6, 0.0), (2e-6, 4e-4)])
def test_recorded_loops_tell_the_same(tmp_path, noise, drift):
    """Harmonic cycles at nine amplitudes, marched through a slider and arms; m, and m/s."""
    rate, hz, per = 1000, 5.0, 6
    sizes = np.geomspace(1e-4, 6e-3, 9)
    t = np.arange(int(len(sizes) * per / hz * rate)) / rate
    X = sizes[np.minimum((t * hz / per).astype(int), len(sizes) - 1)]
    x = X * np.sin(2 * np.pi * hz * t)
    x[0] = 0.0
    force = (SEAL + SLIDER).path_force(t, x)
    x += drift * t + noise * np.random.default_rng(3).normal(size=len(t))
    path = save_table(
        tmp_path / "loops.csv", "time [s],displacement [mm],force [N]", t, 1e3 * x, force
    )
    result = ran(path, "--plot", tmp_path / "loops.svg")
    assert "fitted loop" in (tmp_path / "loops.svg").read_text()
    assert result["unit"] == "N/m"
    assert [round(mode["frequency_hz"], 2) for mode in result["linear"]] == [hz]
    low, high = result["amplitudes"]
    assert (low, high) == pytest.approx((sizes[0], sizes[-1]), rel=0.02)
    stuck, free = (
        float((SEAL + SLIDER).equivalent(2 * np.pi * hz, item).real) for item in (1e-5, 6e-3)
    )
    assert result["linear"][0]["storage"] == pytest.approx(stuck, rel=0.05)
    assert result["lost"] == pytest.approx(stuck - free, rel=0.2)
    # the law is one that its BICs prefer: one that no seal has is not among them
    assert result["orders"][result["law"]] <= min(result["orders"].values()) + 2.0


def test_fit_reports_the_effect_of_channel_delay_on_loops(tmp_path):
    """A spring; its force comes a sample, 1 ms, before the displacement is seen."""
    rate, hz, per = 1000, 5.0, 6
    sizes = np.geomspace(1e-4, 6e-3, 9)
    t = np.arange(int(len(sizes) * per / hz * rate)) / rate
    x = sizes[np.minimum((t * hz / per).astype(int), len(sizes) - 1)] * np.sin(2 * np.pi * hz * t)
    late = np.concatenate([[0.0], x[:-1]])
    columns = (t, 1e3 * late, 400.0 * x)
    path = save_table(tmp_path / "loops.csv", "time [s],displacement [mm],force [N]", *columns)
    result = ran(path)
    linear = result["linear"][0]
    assert linear["loss"] / linear["storage"] == pytest.approx(
        1e-3 * result["loss_factor_per_lag"], rel=0.02
    )
    printed = shell.ran("fit", path).stdout
    assert "A delay of 1 ms between the channels would add 0.031 to the loss factor" in printed


def frfs(folder, levels, friction=SLIDER):
    system = System((point_mass("m", 0.104),), (Mount(SEAL, ("m", "ground"), friction=friction),))
    f, paths = np.linspace(8, 20, 61), []
    for i, level in enumerate(levels):
        frf = dp.systems.response_at_level(
            system, response="m.z", force="m.z", level=level, frequency=f
        ).frf()
        rng = np.random.default_rng(i)
        H = frf.value * (1 + 0.005 * (rng.normal(size=61) + 1j * rng.normal(size=61)))
        paths.append(folder / f"frf{i}.csv")
        write_frf(dp.FRF(f, H, frf.quantity, sd=0.005 * np.abs(H), units="SI"), paths[-1])
    return paths, system


def test_frfs_of_three_levels_foretell_a_fourth(tmp_path):
    levels = (0.005, 0.05, 0.5)
    paths, system = frfs(tmp_path, levels)
    words = [w for level in levels for w in ("--amplitude", f"{level}N")]
    result = ran(
        *paths,
        *words,
        "--mass",
        "104g",
        "--resonance-amplitude",
        "0.15N",
        "--resonance-amplitude",
        "5N",
    )
    true = dp.systems.response_at_level(
        system, response="m.z", force="m.z", level=0.15, frequency=np.linspace(10, 18, 1601)
    )
    top = int(true.amplitude.argmax())
    requested, excess = result["peaks"]
    assert requested["frequency"] == pytest.approx(float(true.frequency[top]), rel=0.002)
    assert requested["receptance"] == pytest.approx(true.amplitude[top] / 0.15, rel=0.03)
    low, high = requested["receptance_interval"]
    assert low < true.amplitude[top] / 0.15 < high
    covered = [c["passed"] for c in result["checks"] if c["name"] == "amplitude_in_tested_range"]
    assert covered == [True, False]
    assert excess["amplitude"] > result["amplitudes"][1]
    assert result["verdict"]["verdict_grade"] == "use with care"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["frf0.csv", "--mass", "104g", "--resonance-amplitude", "1N"], "0 amplitudes and a mass"),
        (["frf0.csv", "--amplitude", "0.1N"], "1 amplitudes and no mass"),
        (["frf0.csv", "--amplitude", "0.1mm", "--mass", "104g"], "force"),
        (["sweep.csv", "--mass", "104g"], "--mass is for"),
        (["sweep.csv", "--seals", "2"], "--seals is for"),
        (
            ["frf0.csv", "--amplitude", "1N", "--mass", "1kg", "--model", "factor"],
            "FRFs take no law",
        ),
        (["sweep.csv", "sweep.csv"], "one amplitude sweep at a time"),
        (["flat.csv"], "never changes"),
        (["bare.csv"], "no column of strain or displacement"),
    ],
)
def test_fit_refuses_impossible_amplitude_data(tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    frfs(tmp_path, (0.05,))
    X = np.geomspace(1e-3, 5, 12)
    tones, K = np.full(12, 10.0), payne(X / 100)
    header = "frequency [Hz],strain [%],storage [MPa],loss [MPa]"
    save_table("sweep.csv", header, tones, X, K.real, K.imag)
    save_table("flat.csv", header, tones, np.ones(12), K.real, K.imag)
    save_table("bare.csv", "frequency [Hz],storage [MPa],loss [MPa]", tones, K.real, K.imag)
    assert message in ran(*words, code=2)


def write_hits(path, heights):
    """Hits of these heights, N, on a linear seal, one after the other, with noise."""
    w, zeta, dt, every = 2 * np.pi * 12.7, 0.03, 1 / 2560, 5
    x, v, rows = np.zeros(len(heights)), np.zeros(len(heights)), []
    for t in np.arange(-0.2, 3.0, dt):
        force = np.asarray(heights) * max(np.sin(np.pi * t / 0.012), 0.0) * (0 <= t < 0.012)
        a = force / 0.1 - 2 * zeta * w * v - w**2 * x
        rows.append((force, a))
        v = v + a * dt
        x = x + v * dt
    count = len(rows) // every * every
    rng = np.random.default_rng(2)
    force, a = (
        np.array(rows)[:count].reshape(-1, every, 2, len(heights)).mean(axis=1).transpose(1, 2, 0)
    )
    force, a = force.ravel(), a.ravel() + 0.01 * rng.normal(size=force.size)
    time = every * dt * np.arange(len(force))
    header = "time [s],hammer [N],acceleration 1 [m/s^2]"
    force += 0.002 * rng.normal(size=len(a))
    return save_table(path, header, time, force, a)


def test_hits_of_different_height_say_for_which_level_they_speak(tmp_path):
    """Six hits of 1 to 8 in height: no trend, and how small a one was sought."""
    path = write_hits(tmp_path / "hits.csv", np.geomspace(0.5, 4.0, 6))
    result = ran(
        path,
        "--resonance-amplitude",
        "0.05N",
        "--resonance-amplitude",
        "2N",
        "--plot",
        tmp_path / "hits.svg",
    )
    assert "damping ratio, %" in (tmp_path / "hits.svg").read_text()
    stiffness = result["per_doubling"]["stiffness"]
    assert (
        abs(stiffness["change"]) < 4 * stiffness["se"] < stiffness["detectable_change"] * 2 < 0.01
    )
    low, high = result["amplitudes"]
    requested, far = result["peaks"]
    assert low < requested["amplitude"] < high < far["amplitude"]
    assert requested["frequency"] == pytest.approx(12.7, rel=0.002)
    # the steady motion of a mass on a spring at its resonance
    assert requested["receptance"] == pytest.approx(
        1 / (2 * 0.1 * 0.03 * (2 * np.pi * 12.7) ** 2), rel=0.1
    )
    assert [c["passed"] for c in result["checks"] if c["name"] == "amplitude_in_tested_range"] == [
        True,
        False,
    ]
    assert result["verdict"]["verdict_grade"] == "use with care"
    belongs = ran(path, "--seals", "2", "--resonance-amplitude", "1N", code=2)
    assert "--seals belongs to FRFs" in belongs
    read = level_files([path], at=[0.05])
    assert [number.name for number in list_level_values(read)][:2] == [
        "stiffness per doubling",
        "damping per doubling",
    ]
    assert "Four of five such tests find" in format_residual_note(read)


def test_fit_compares_stated_levels_with_the_hits(tmp_path):
    """The soft hits are a twentieth of the hard ones, which would hide them in one record."""
    soft = write_hits(tmp_path / "soft.csv", [0.1, 0.11, 0.12])
    hard = write_hits(tmp_path / "hard.csv", [2.0, 2.2, 2.4])

    plain = ran(soft, hard, "--resonance-amplitude", "0.02N")
    assert len(plain["hits"]) == 6
    result = ran(soft, hard, "--amplitude", "0.11N", "--amplitude", "2N", "--mass", "100g")
    assert result["per_doubling"] == plain["per_doubling"]
    passed = {check["name"]: check["passed"] for check in result["checks"]}
    assert passed["levels_as_stated"]
    assert passed["high_frequency_mass_agrees"]
    assert result["verdict"]["verdict_grade"] == plain["verdict"]["verdict_grade"] == "use"
    odd = ran(soft, hard, "--amplitude", "2N", "--amplitude", "0.11N", "--mass", "130g")
    assert odd["verdict"]["failed_checks"] == ["levels_as_stated", "high_frequency_mass_agrees"]
    message = next(
        check["message"] for check in odd["checks"] if check["name"] == "levels_as_stated"
    )
    assert "The amplitudes belong to each other's files." in message
    assert "2 hammer files and 1 amplitudes" in ran(soft, hard, "--amplitude", "2N", code=2)
    nothing = ran(soft, hard, "--amplitude", "2N", "--amplitude", "0N", code=2)
    assert "expected a peak force > 0" in nothing


def test_an_frf_of_hits_is_of_no_level(tmp_path):
    hits = write_hits(tmp_path / "hits.csv", [1.0, 1.1, 1.2])
    paths, _ = frfs(tmp_path, (0.05, 0.5))
    of_hits = tmp_path / "of_hits.csv"
    write_frf(estimate_frf(read_impact(hits), band="8:20Hz"), of_hits)
    result = ran(paths[0], of_hits, "--amplitude", "0.05N", "--amplitude", "1N", "--mass", "104g")
    assert result["verdict"]["failed_checks"][0] == "levels_controlled"
    message = next(
        check["message"] for check in result["checks"] if check["name"] == "levels_controlled"
    )
    assert "of_hits.csv: an FRF of hits has no single amplitude" in message
    assert "not fitted together" in " ".join(ran(paths[0], hits, "--mass", "1kg", code=2).split())
