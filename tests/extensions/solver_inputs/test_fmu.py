"""FMPy accepts our FMU, and its answers are those of the solid."""

from __future__ import annotations

import io
import re
import shutil
import sys
import zipfile
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from kit.fits import a_fit
from kit.fmus import driven, integrate, simulate, table, write_fmu
from scipy.linalg import expm
from scipy.signal import StateSpace, lsim

from dashpot.base.errors import ExportError
from dashpot.base.version import is_ours
from dashpot.cli import main
from dashpot.datamodel.specimen import Specimen
from dashpot.export import TARGETS
from dashpot.extensions.solver_inputs import fmi
from dashpot.extensions.solver_inputs.fmi.binaries import PLATFORMS
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.mass_on_seals import predict_frf

FORMS = ("fmi2", "fmi3")
MASS = 0.05202
every_form = pytest.mark.parametrize("form", FORMS)
needs_fmpy = pytest.mark.skipif(
    find_spec("fmpy") is None or shutil.which("cc") is None,
    reason="FMPy or a C compiler is missing: pip install dashpot[solvers]",
)


@pytest.fixture
def sources_only(monkeypatch):
    """As on a machine without the compiler of the package index."""
    for module in ("archive", "binaries"):
        monkeypatch.setattr(
            f"dashpot.extensions.solver_inputs.fmi.{module}.find_platforms", lambda form: ()
        )


@pytest.fixture
def build(tmp_path, sources_only):
    """Write an FMU with a binary of this machine's own compiler, and return its path."""

    def write(solid, form, **arguments) -> str:
        return write_fmu(solid, form, tmp_path, **arguments)

    return write


# -- the mount -------------------------------------------------------------------------------------


@needs_fmpy
@every_form
@pytest.mark.parametrize("step", [0.25, 0.01])
def test_ramp_and_hold_is_equation_5(paper_seal, form, step, build):
    time = step * np.arange(round(10 / step) + 1)
    motion = driven(time, np.minimum(time, 1.0) * 8e-3)
    path = build(paper_seal, form)
    record = simulate(path, input=motion, stop_time=10.0, output_interval=step)
    exact = paper_seal.ramp_hold_force(record["time"], depth=8e-3, ramp_time=1.0)
    error = np.abs(record["F"] - exact).max() / exact.max()
    print(f"{form}, step {step:g} s: largest error {error:.1e}")
    assert error < 1e-9


@needs_fmpy
@every_form
def test_model_exchange_follows_the_same_ramp(paper_seal, form, build):
    """Integrated here: CVode of FMPy holds the inputs over an interval of its output."""
    solid = paper_seal + GeneralizedMaxwell(0.0, b=3.0)
    path, t = build(solid, form), np.linspace(0.0, 3.0, 61)
    pressed = integrate(path, form, t[:21], lambda time: (8e-3 * time, 8e-3), ("x", "v"))
    states = pressed.pop("states")
    held = integrate(path, form, t[20:], lambda time: (8e-3, 0.0), ("x", "v"), start=states[-1])
    exact = solid.ramp_hold_force(t, depth=8e-3, ramp_time=1.0)
    result = np.concatenate([pressed["F"][1:-1], held["F"][1:]])
    expected = np.concatenate([exact[1:20], exact[21:]])
    error = np.abs(result - expected).max() / exact.max()
    print(f"{form}: largest error {error:.1e}")
    assert error < 1e-6


@needs_fmpy
@every_form
def test_model_exchange_in_fmpy_relaxes(paper_seal, form, build):
    """A displacement that is there from the first: every arm is new, and then lets go."""
    record = simulate(
        build(paper_seal, form), "ModelExchange", start_values={"x": 8e-3}, stop_time=10.0,
        output_interval=0.1, relative_tolerance=1e-10,
    )  # fmt: skip
    exact = 8e-3 * paper_seal.relaxation(record["time"])
    assert record["F"] == pytest.approx(exact, rel=1e-6)


FACTOR = {1e-3: 0.999469, 5e-3: 0.986784, 10e-3: 0.947971}
"""Amplitude of a sine of 12.71 Hz that is sampled so and joined by straight lines."""


@needs_fmpy
@every_form
@pytest.mark.parametrize("step", list(FACTOR))
def test_a_sine_by_straight_lines_has_the_amplitude_of_them_and_no_lag(
    paper_seal, form, step, build
):
    """The fundamental of the force over that of the sine: the factor times the stiffness."""
    omega, fine = 2 * np.pi * 12.71, 20
    # whole periods and whole steps: 1271 periods are 100 s; ten are near enough for a fit
    coarse = step * np.arange(-1, round(40 / step) + 1)
    time = np.arange(0, 4.0, step / fine)
    value = np.interp(time, coarse, np.sin(omega * coarse))
    record = simulate(
        build(paper_seal, form), input=driven(time, value), stop_time=time[-1],
        output_interval=step / fine, output=["F"],
    )  # fmt: skip
    t, F = record["time"], record["F"]
    settled = t > 1.0
    arms = [np.exp(-t / tau) for tau in paper_seal.tau]
    wave = np.column_stack([np.sin(omega * t), np.cos(omega * t), *arms])
    (storage, loss, *_), *_ = np.linalg.lstsq(wave[settled], F[settled], rcond=None)
    K = complex(paper_seal.complex_stiffness(omega=omega))
    factor = abs(storage + 1j * loss) / abs(K)
    lag = loss / storage - K.imag / K.real
    print(f"{form}, {1e3 * step:g} ms: factor {factor:.6f} ({FACTOR[step]}), false loss {lag:+.1e}")
    assert factor == pytest.approx(FACTOR[step], abs=2e-6 + 2e-4 * (step > 1e-3))
    assert abs(lag) < 2e-4


@needs_fmpy
@every_form
def test_the_displacement_of_the_end_needs_no_velocity(paper_seal, form, build):
    """A loop that sets what the mount has reached when the step ends, as one writes by hand."""
    step = 0.02
    reached = np.minimum(step * np.arange(501), 1.0) * 8e-3
    # FMPy sets what its table holds for the beginning of a step: here the end of it
    ahead = table(step * np.arange(500), x=reached[1:])
    record = simulate(
        build(paper_seal, form), input=np.insert(ahead, 0, (-step, 0.0)), stop_time=9.0,
        start_time=-step, output_interval=step,
    )  # fmt: skip
    # the first step, before anything moves, is a step of rest
    t = record["time"] + step
    exact = paper_seal.ramp_hold_force(t - step, depth=8e-3, ramp_time=1.0)
    assert np.abs(record["F"][1:] - exact[1:]).max() / exact.max() < 1e-9


@needs_fmpy
def test_input_derivatives_are_the_velocity(paper_seal, build):
    """Set in a loop of our own: FMPy gives the slope of the piece that has just ended."""
    import fmpy
    from fmpy.fmi2 import FMU2Slave

    path = build(paper_seal, "fmi2")
    folder, read = fmpy.extract(path), fmpy.read_model_description(path)
    where = {variable.name: variable.valueReference for variable in read.modelVariables}
    unit = FMU2Slave(
        guid=read.guid, unzipDirectory=folder, modelIdentifier="mount", instanceName="one"
    )
    unit.instantiate()
    unit.setupExperiment(startTime=0.0)
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    step, force, state = 0.1, [], None
    for i in range(40):
        t = i * step
        unit.setReal([where["x"]], [8e-3 * min(t, 1.0)])
        unit.setRealInputDerivatives([where["x"]], [1], [8e-3 * (i < 10)])
        unit.doStep(t, step)
        force += unit.getReal([where["F"]])
        if i == 19:
            state = unit.serializeFMUstate(unit.getFMUstate())
    exact = paper_seal.ramp_hold_force(step * np.arange(1, 41), depth=8e-3, ramp_time=1.0)
    assert np.array(force) == pytest.approx(exact, rel=1e-9)
    # and back to a state that was kept
    unit.setFMUstate(unit.deSerializeFMUstate(state))
    unit.setReal([where["x"]], [8e-3])
    unit.doStep(2.0, step)
    assert unit.getReal([where["F"]]) == pytest.approx([exact[20]], rel=1e-9)
    unit.terminate()
    unit.freeInstance()
    shutil.rmtree(folder)


@needs_fmpy
@every_form
@pytest.mark.parametrize("arms", [0, 1, 45])
def test_any_number_of_arms(form, arms, build):
    tau = tuple(np.geomspace(1e-4, 1e4, arms).tolist())
    solid = GeneralizedMaxwell(100.0, (20.0,) * arms, tau, b=0.5)
    time = np.array([0.0, 0.5, 1.0, 2.5, 5.0])
    motion = driven(time, np.minimum(time, 1.0) * 1e-3)
    record = simulate(build(solid, form), input=motion, stop_time=5.0, output_interval=0.5)
    assert not validate(build(solid, form))
    t = record["time"]
    exact = solid.ramp_hold_force(t, depth=1e-3, ramp_time=1.0)
    inside = (t > 0) & (t != 1.0)  # the dashpot feels the velocity of the step that ends there
    assert record["F"][inside] == pytest.approx(exact[inside], rel=1e-9)


# -- the mass --------------------------------------------------------------------------------------


def pulse(time):
    return np.interp(time, [0.0, 5e-3, 10e-3, 1e9], [0.0, 2.0, 0.0, 0.0])


@needs_fmpy
@every_form
@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_a_struck_mass_moves_as_the_equations_do(paper_seal, form, kind, build):
    """Against scipy's exact solution for a force of straight lines."""
    solid = paper_seal + GeneralizedMaxwell(0.0, b=0.3)
    step = 1e-3
    t = step * np.arange(501)
    path = build(solid, form, mass=MASS)
    if kind == "CoSimulation":
        force = driven(t, pulse(t), ("F", "F_rate"))
        record = simulate(path, input=force, stop_time=0.5, output_interval=step)
    else:
        record = integrate(path, form, t, lambda time: (pulse(time), 0.0), ("F", "F_rate"))
    k, tau = np.array(solid.k), np.array(solid.tau)
    A = np.zeros((4, 4))
    A[0, 1] = 1.0
    A[1] = np.array([-solid.k_0, -solid.b, *k]) / MASS
    A[2:, 0], A[2:, 2:] = 1 / tau, -np.diag(1 / tau)
    B = np.array([[0.0], [1 / MASS], [0.0], [0.0]])
    C = np.vstack([np.eye(4)[:2], A[1]])
    D = np.array([[0.0], [0.0], [1 / MASS]])
    _, (x, v, a), _ = map(np.transpose, lsim(StateSpace(A, B, C, D), pulse(t), t))
    for name, exact in (("x", x), ("v", v), ("a", a)):
        error = np.abs(record[name][: len(t)] - exact).max() / np.abs(exact).max()
        print(f"{form} {kind} {name}: largest error {error:.1e}")
        assert error < (1e-9 if kind == "CoSimulation" else 1e-7)


@needs_fmpy
@every_form
def test_a_shaken_mass_has_the_receptance_of_the_model(paper_seal, form, build):
    f, step = 12.71, 1e-3
    omega = 2 * np.pi * f
    t = step * np.arange(30001)
    record = simulate(
        build(paper_seal, form, mass=MASS), input=driven(t, np.sin(omega * t), ("F", "F_rate")),
        stop_time=30.0, output_interval=step, output=["x"],
    )  # fmt: skip
    late = t > 26.0
    creep = np.ones(late.sum())
    wave = np.column_stack([np.sin(omega * t[late]), np.cos(omega * t[late]), creep, t[late]])
    (real, imaginary, *_), *_ = np.linalg.lstsq(wave, record["x"][late], rcond=None)
    (exact,) = predict_frf(paper_seal, mass=MASS, frequency=[f], kind="receptance").value
    ratio = (real + 1j * imaginary) / exact
    print(f"{form}: |ratio| {abs(ratio):.6f} ({FACTOR[1e-3]}), phase {np.angle(ratio):+.1e} rad")
    assert abs(ratio) == pytest.approx(FACTOR[1e-3], abs=1e-4)
    assert abs(np.angle(ratio)) < 1e-4


@needs_fmpy
@every_form
@pytest.mark.parametrize("step", [1e-3, 0.1, 2.0])
def test_a_mass_on_arms_of_any_speed_comes_to_rest(form, step, build):
    """Against the exponential of the matrix of the arms that a mass can feel; the others damp."""
    tau = np.geomspace(1e-17, 10.0, 18)
    solid = GeneralizedMaxwell(2e4, (300.0,) * len(tau), tuple(tau.tolist()))
    slow = tau > 1e-9
    damping, k, tau = 300.0 * tau[~slow].sum(), 300.0, tau[slow]
    count, force = len(tau), 10.0
    # displacement, velocity, one displacement a dashpot, and 1 for the constant force
    matrix = np.zeros((count + 3, count + 3))
    matrix[0, 1] = 1.0
    matrix[1] = [-(2e4 + k * count), -damping, *[k] * count, force]
    matrix[1] /= MASS
    matrix[2:-1, 0], matrix[2:-1, 2:-1] = 1 / tau, -np.diag(1 / tau)
    end = max(4.0, 20 * step)
    t = np.arange(0.0, end + step / 2, step)
    record = simulate(
        build(solid, form, mass=MASS), stop_time=end, output_interval=step, output=["x"],
        input=driven(t, np.full(len(t), force), ("F", "F_rate")), start_values={"F": force},
    )  # fmt: skip
    each, state = expm(step * matrix), np.append(np.zeros(count + 2), 1.0)
    exact = [0.0]
    for _ in t[1:]:
        state = each @ state
        exact.append(state[0])
    assert np.abs(record["x"] - exact).max() < 1e-6 * max(exact)


@needs_fmpy
def test_a_derivative_of_the_input_stands_for_the_rate(paper_seal, build):
    import fmpy
    from fmpy.fmi2 import FMU2Slave

    path = build(paper_seal, "fmi2")
    folder, read = fmpy.extract(path), fmpy.read_model_description(path)
    where = {variable.name: variable.valueReference for variable in read.modelVariables}
    unit = FMU2Slave(
        guid=read.guid, unzipDirectory=folder, modelIdentifier="mount", instanceName="one"
    )
    unit.instantiate()
    unit.setupExperiment(startTime=0.0)
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    unit.setReal([where["x"], where["v"]], [0.0, 8e-3])
    unit.setRealInputDerivatives([where["x"]], [1], [8e-3])
    unit.doStep(0.0, 0.5)
    (force,) = unit.getReal([where["F"]])
    (exact,) = paper_seal.ramp_hold_force(np.array([0.5]), depth=8e-3, ramp_time=1.0)
    assert force == pytest.approx(exact, rel=1e-9)
    # and a state of another FMU of as many arms is refused
    other = build(GeneralizedMaxwell(7.0, paper_seal.k, paper_seal.tau), "fmi2")
    state = unit.serializeFMUstate(unit.getFMUstate())
    unit.terminate()
    unit.freeInstance()
    shutil.rmtree(folder)
    folder, read = fmpy.extract(other), fmpy.read_model_description(other)
    unit = FMU2Slave(
        guid=read.guid, unzipDirectory=folder, modelIdentifier="mount", instanceName="two"
    )
    unit.instantiate()
    with pytest.raises(Exception, match="status 3"):
        unit.deSerializeFMUstate(state)
    unit.freeInstance()
    shutil.rmtree(folder)


def test_no_parameter_starts_below_its_minimum(sources_only):
    tau = (8.423697820250522e-17, 1.23456789012345e-7)
    unit = TARGETS["fmu"](GeneralizedMaxwell(1.0, (1.0, 1.0), tau), units="SI", form="fmi2")
    described = [
        variable for variable in unit.description.variables if variable.minimum is not None
    ]
    assert described
    assert all(item.minimum <= item.start for item in described)


# -- what the archive says of itself ---------------------------------------------------------------


def validate(path):
    from fmpy.validation import validate_fmu

    return validate_fmu(path)


@needs_fmpy
@every_form
@pytest.mark.parametrize("system", ["SI", "mm-t-s"])
@pytest.mark.parametrize("mass", [None, MASS])
def test_the_validator_of_fmpy_finds_nothing(paper_seal, form, system, mass, build):
    fit = a_fit(paper_seal, specimen=Specimen(length=0.1, temperature=296.15))
    path = build(fit, form, units=system, **({} if mass is None else {"mass": mass}))
    assert validate(path) == []


@needs_fmpy
@every_form
def test_parameters_have_units_limits_and_intervals(paper_seal, form, build):
    import fmpy

    fit = a_fit(paper_seal, specimen=Specimen(length=0.1, temperature=296.15))
    path = build(fit, form, units="mm-t-s")
    read = fmpy.read_model_description(path)
    expected = {variable.name: variable for variable in read.modelVariables}
    assert float(expected["k_inf"].start) == pytest.approx(0.1965)
    assert expected["k_inf"].unit == "N/mm"
    assert float(expected["k_inf"].min) == 0
    assert float(expected["tau[2]"].min) > 0
    low, high = (1e-3 * end for end in fit.intervals()["k"][0])
    assert f"95 % interval {low:.6g} to {high:.6g} N/mm" in expected["k[1]"].description
    (unit,) = [item for item in read.unitDefinitions if item.name == "N/mm"]
    assert unit.baseUnit.factor == pytest.approx(1e3)
    assert (unit.baseUnit.kg, unit.baseUnit.s) == (1, -2)

    t = np.array([0.0, 1.0, 2.0])
    values = {"input": driven(t, [0, 8, 8]), "stop_time": 2.0, "output_interval": 1.0}
    usual = simulate(path, **values)["F"]
    assert usual[1] == pytest.approx(paper_seal.ramp_hold_force(1.0, depth=8e-3, ramp_time=1.0))
    twice = {name: 2 * float(expected[name].start) for name in ("k_inf", "k[1]", "k[2]")}
    assert simulate(path, start_values=twice, **values)["F"] == pytest.approx(2 * usual)
    with pytest.raises(Exception, match=r"fmi[23]Set"):
        simulate(path, start_values={"tau[1]": 0.0}, **values)
    with pytest.raises(Exception, match=r"fmi[23]Set"):
        simulate(path, start_values={"k_inf": float("nan")}, **values)


@every_form
def test_the_archive_repeats_and_without_a_compiler_says_so(paper_seal, form, sources_only):
    item, other = (TARGETS["fmu"](paper_seal, units="SI", form=form) for _ in range(2))
    assert item.file_content == other.file_content
    assert is_ours(item.file_content[:4096])
    # the line to type is that of this installation, and no part of the archive
    assert f"sources only, no binaries (the compiler comes with: {sys.executable}" in item.summary
    with zipfile.ZipFile(io.BytesIO(item.file_content)) as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        assert not [name for name in archive.namelist() if name.startswith("binaries")]
        page = archive.read("documentation/index.html").decode()
        assert "sources only" in page
        assert sys.executable not in page
        described = archive.read("modelDescription.xml").decode()
    (token,) = re.findall(r'(?:guid|instantiationToken)="({.*?})"', described)
    assert f'#define TOKEN "{token}"' in item
    stiffer = TARGETS["fmu"](1.001 * paper_seal, units="SI", form=form)
    assert token not in stiffer


@pytest.mark.parametrize("name", ["seal\\", "seal??/", "seal*/ #error"])
def test_a_file_name_cannot_reach_the_code(paper_seal, name, build):
    from dashpot.base.provenance import Source

    fit = a_fit(
        paper_seal, specimen=Specimen(length=0.1, temperature=296.15),
        source=(Source(file=name, sha256="0" * 64),),
    )  # fmt: skip
    header = [line for line in TARGETS["fmu"](fit, units="SI").splitlines() if line[:2] == "//"]
    assert not [line for line in header if line.endswith(("\\", "??/"))]
    if shutil.which("cc"):
        assert build(fit, "fmi2")


def test_the_command_writes_the_archive_and_prints_none(paper_seal, tmp_path, sources_only):
    import dashpot as dp

    solid, path = str(tmp_path / "solid.json"), tmp_path / "solid.fmu"
    dp.save(paper_seal, solid)
    words = ["export", solid, "--to", "fmu", "--unit-system", "SI"]
    run = CliRunner().invoke(main, [*words, "-o", str(path)])
    assert run.exit_code == 0, run.output
    # a long path of the archive moves where the line is broken
    output = " ".join(run.output.split())
    assert "FMI 2.0, Model Exchange and Co-Simulation; sources only" in output
    assert zipfile.is_zipfile(path)
    dp.export(paper_seal, tmp_path / "same.fmu", to="fmu", unit_system="SI")
    assert (tmp_path / "same.fmu").read_bytes() == path.read_bytes()
    printed = CliRunner().invoke(main, words)
    assert printed.exit_code
    assert "an archive, which is not printed" in printed.output


def test_what_is_refused(paper_seal):
    with pytest.raises(ExportError, match="FMI counts time in s, mm-kg-ms in ms"):
        TARGETS["fmu"](paper_seal, units="mm-kg-ms")
    with pytest.raises(ExportError, match=r"mass = 0\.0 kg"):
        TARGETS["fmu"](paper_seal, units="SI", mass=0.0)


# -- the compiler of the package index -------------------------------------------------------------

FIRST_BYTES = {"so": b"\x7fELF", "dll": b"MZ", "dylib": b"\xcf\xfa\xed\xfe"}


@pytest.mark.slow
@pytest.mark.skipif(find_spec("ziglang") is None, reason="no compiler: pip install dashpot[fmu]")
@every_form
def test_binaries_for_every_platform(paper_seal, form, tmp_path, monkeypatch):
    """Every function of the standard is exported, and a compiler without a cache repeats them."""
    made = []
    for name in ("one", "two"):
        monkeypatch.setenv("ZIG_GLOBAL_CACHE_DIR", str(tmp_path / name))
        monkeypatch.setenv("ZIG_LOCAL_CACHE_DIR", str(tmp_path / name))
        made.append(TARGETS["fmu"](paper_seal, units="SI", form=form).file_content)
    assert made[0] == made[1]
    source = Path(fmi.__file__).with_name("sources").joinpath(f"{form}.c").read_text()
    wanted = {f"{form}DoStep", f"{form}Instantiate"[: 15 if form == "fmi2" else 4], "GetVersion"}
    assert all(word in source for word in wanted)
    with zipfile.ZipFile(io.BytesIO(made[0])) as archive:
        for platform, (_, suffix) in PLATFORMS[form].items():
            binary = archive.read(f"binaries/{platform}/mount.{suffix}")
            assert binary.startswith(FIRST_BYTES[suffix])
            assert all(word.encode() in binary for word in wanted)
            assert str(tmp_path).encode() not in binary
    if find_spec("fmpy"):
        path = tmp_path / "unit.fmu"
        path.write_bytes(made[0])
        time = np.array([0.0, 1.0, 2.0])
        record = simulate(
            str(path), input=driven(time, [0, 8e-3, 8e-3]), stop_time=2.0, output_interval=1.0
        )
        exact = paper_seal.ramp_hold_force(record["time"], depth=8e-3, ramp_time=1.0)
        assert record["F"] == pytest.approx(exact, rel=1e-9)
