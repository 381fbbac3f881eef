"""From files at several temperatures to a fit, its picture and its document."""

import json

import numpy as np
import pytest
from kit.shell import ran, run_json
from kit.sweeps import REFERENCE, TEMPERATURES, moduli, modulus, sweeps, wlf

import dashpot as dp
from dashpot.datamodel.fit import get_temperature_law
from dashpot.extensions.curves.dynamic.fit import fit_dynamic
from dashpot.extensions.curves.dynamic.read import read_dynamic
from dashpot.extensions.curves.modulus.fit import fit_modulus
from dashpot.extensions.curves.modulus.read import read_modulus
from dashpot.reading.read_options import ReadOptions
from dashpot.workflow.json_archive import from_json, to_json

ZENER = dp.GeneralizedMaxwell(1e6, (4e6,), (0.1,))


def shell(*words, code=0):
    result = ran(*words)
    assert result.exit_code == code, result.output
    return result.stdout if code == 0 else " ".join(result.stderr.split())


def write_isotherms(path, test):
    """A file as a machine exports it: one block of rows for each temperature."""
    if isinstance(test, dp.DynamicTest):
        head = "frequency [Hz],storage modulus [MPa],loss modulus [MPa],temperature [degC]"
        columns = (test.frequency, test.storage / 1e6, test.loss / 1e6)
    else:
        head = "time [s],E(t) [MPa],temperature [degC]"
        columns = (test.time, test.modulus / 1e6)
    rows = np.column_stack((*columns, test.temperature - 273.15))
    np.savetxt(path, rows, delimiter=",", header=head, comments="", fmt="%.9g")
    return path


@pytest.fixture(scope="module")
def dynamic_fit():
    return fit_dynamic(sweeps())


def test_a_fit_of_several_temperatures_is_that_of_their_reference(dynamic_fit):
    omega = 2 * np.pi * np.geomspace(0.01, 1e4, 30)
    true = modulus(omega / (2 * np.pi), REFERENCE)
    stiffness = dynamic_fit.model.complex_stiffness(omega=omega)
    assert np.abs(stiffness / true - 1).max() < 0.02
    assert dynamic_fit.specimen.temperature == pytest.approx(REFERENCE)
    assert get_temperature_law(dynamic_fit).kind == "wlf"
    assert len(dynamic_fit.temperatures.shifts) == 9
    assert [step.name for step in dynamic_fit.provenance.steps] == ["superpose", "fit_dynamic"]


def test_it_foretells_a_temperature_that_was_not_tested(dynamic_fit):
    kelvin = 298.15
    frequency = np.geomspace(0.1, 10, 9)
    stiffness = dynamic_fit.at(kelvin).complex_stiffness(omega=2 * np.pi * frequency)
    assert np.abs(stiffness / modulus(frequency, kelvin) - 1).max() < 0.02
    assert dynamic_fit.at_temperature(kelvin).specimen.temperature == kelvin


def test_it_comes_back_from_its_document(dynamic_fit):
    back = from_json(to_json(dynamic_fit))
    assert back.temperatures == dynamic_fit.temperatures
    assert back.model == dynamic_fit.model


def test_few_arms_stay_where_they_follow_as_closely():
    frequency = np.geomspace(0.05, 5, 12)
    draw = np.random.default_rng(2).standard_normal((2, 36))
    value = np.concatenate(
        [
            ZENER.shift_to_temperature(a).complex_stiffness(omega=2 * np.pi * frequency)
            for a in (6.0, 1.0, 0.2)
        ]
    )
    value = value + 0.005 * np.abs(value) * (draw[0] + 1j * draw[1])
    data = dp.DynamicTest(
        np.tile(frequency, 3),
        value.real,
        value.imag,
        np.repeat([273.15, 293.15, 313.15], 12),
        units="SI",
    )
    fit = fit_dynamic(data)
    assert fit.model.arms == 1
    assert fit.model.tau[0] == pytest.approx(0.1, rel=0.02)
    assert fit.temperatures.shifts[0].log10_a_t == pytest.approx(np.log10(6), abs=0.02)
    assert fit.verdict.use == "use"
    single = fit_dynamic(data, arms=1, temperature=293.15)
    assert single.model.tau[0] == pytest.approx(fit.model.tau[0], rel=0.02)
    assert single.temperatures is None


def test_moduli_of_several_temperatures_are_fitted_alike():
    fit = fit_modulus(moduli())
    assert get_temperature_law(fit).kind == "wlf"
    time = np.geomspace(1e-3, 1e4, 20)
    true = fit_modulus(dp.solids.superpose(moduli(noise=0.0))).model.relaxation(time)
    np.testing.assert_allclose(fit.model.relaxation(time), true, rtol=0.03)


def test_the_shell_makes_the_master_curve_of_a_file(tmp_path):
    file = write_isotherms(tmp_path / "sweeps.csv", sweeps())
    picture, document = tmp_path / "master.svg", tmp_path / "fit.json"
    process = shell("fit", file, "--reference", "20degC", "--plot", picture, "-o", document)
    assert "20 degC, of 9 temperatures; b_T = T/T_r" in process
    assert "WLF: C1 8.1" in process
    assert "-10 degC" in process
    assert "van Gurp-Palmen" in picture.read_text()
    temperature = json.loads(document.read_text())["temperature"]
    assert temperature["reference"] == pytest.approx(293.15)
    assert temperature["law"]["kind"] == "wlf"
    cold = temperature["shifts"][0]
    assert cold["log10_a_t"] == pytest.approx(wlf(TEMPERATURES[0]), abs=0.1)
    assert cold["b_t"] == pytest.approx(253.15 / 293.15)


def test_the_shell_takes_moduli_files_and_tables_of_shifts(tmp_path):
    whole = moduli()
    files = []
    for kelvin in TEMPERATURES[2:]:
        part = whole.select_temperature(kelvin)
        file = tmp_path / f"{kelvin:.0f}.csv"
        rows = np.column_stack((part.time, part.modulus / 1e6))
        head = f"temperature: {kelvin - 273.15:.0f} degC\ntime [s],E(t) [MPa]"
        np.savetxt(file, rows, delimiter=",", header=head, comments="", fmt="%.9g")
        files.append(file)
    table = tmp_path / "shifts.csv"
    lines = [f"{t - 273.15:g},{wlf(t) * np.log(10)}" for t in TEMPERATURES]
    table.write_text("\n".join(["T [degC],ln aT", *lines]))
    document = run_json("fit", *files, "--column", "modulus=E(t)", "--shifts", table)
    log10_a_ts = [shift["log10_a_t"] for shift in document["temperature"]["shifts"]]
    np.testing.assert_allclose(log10_a_ts, wlf(TEMPERATURES[2:]), atol=1e-6)


def blocks(path, test, names, columns, message):
    """One block for each temperature, said in a line over it."""
    lines = ["# a machine"]
    for kelvin in np.unique(test.temperature):
        rows = np.column_stack([column[test.temperature == kelvin] for column in columns])
        lines += ["", message.format(kelvin - 273.15), names]
        lines += ["\t".join(f"{value:.9g}" for value in row) for row in rows]
    path.write_text("\n".join(lines) + "\n")
    return path


@pytest.mark.parametrize("message", ["Temperature: {:g} °C", "# Temperature [degC]; {:g}"])
def test_blocks_that_say_their_temperature_are_as_a_column_of_it(tmp_path, message):
    data = sweeps()
    columns = (data.frequency, data.storage / 1e6, data.loss / 1e6)
    file = blocks(tmp_path / "a.txt", data, "Frequency [Hz]\tE' [MPa]\tE'' [MPa]", columns, message)
    test = read_dynamic(file)
    np.testing.assert_allclose(test.temperature, data.temperature)
    curves = moduli()
    columns = (curves.time, curves.modulus / 1e6)
    file = blocks(tmp_path / "b.txt", curves, "time [s]\tE(t) [MPa]", columns, message)
    test = read_modulus(file, options=ReadOptions(modulus="E(t)"))
    np.testing.assert_allclose(test.temperature, curves.temperature)


def test_read_dynamic_carries_a_block_temperature_forward(tmp_path):
    file = tmp_path / "a.txt"
    head, rows = "Frequency [Hz]\tE' [MPa]\tE'' [MPa]", "1\t10\t2\n2\t11\t2\n"
    texts = (f"Temperature: {t} degC\n{head}\n{rows}\n{head}\n{rows}\n" for t in (0, 20))
    file.write_text("".join(texts))
    assert set(read_dynamic(file).temperature[:4]) == {273.15}
    assert set(read_dynamic(file).temperature[4:]) == {293.15}
    file.write_text(f"Temperature: 5 degC\n{head}\n{rows}\n{head}\n{rows}")
    assert read_dynamic(file).temperature is None
    assert read_dynamic(file).specimen.temperature == 278.15


@pytest.mark.parametrize(
    ("head", "of"),
    [
        ("T [degC],log_aT", lambda a: a),
        ("T [C],log10(a_T)", lambda a: a),
        ("temperature [degC],a_T", lambda a: 10**a),
        ("Temperature [degC],shift factor", lambda a: 10**a),
        ("T [degC],ln a_T", lambda a: a * np.log(10)),
    ],
)
def test_tables_of_shifts_speak_of_a_t_in_many_ways(tmp_path, head, of):
    table = tmp_path / "shifts.csv"
    table.write_text("\n".join([head, *(f"{t},{of(a):.12g}" for t, a in ((60, -2.0), (0, 1.5)))]))
    shifts = dp.files.read_shifts(table)
    assert [shift.temperature for shift in shifts] == pytest.approx([273.15, 333.15])
    assert [shift.log10_a_t for shift in shifts] == pytest.approx([1.5, -2.0])


def test_a_table_of_shifts_comes_back(tmp_path):
    file, table = write_isotherms(tmp_path / "sweeps.csv", sweeps()), tmp_path / "shifts.csv"
    document = run_json("fit", file, "--save-shifts", table)
    log10_a_ts = [shift["log10_a_t"] for shift in document["temperature"]["shifts"]]
    back = dp.files.read_shifts(table)
    assert [shift.log10_a_t for shift in back] == log10_a_ts
    assert back[0].se == pytest.approx(0.055, abs=0.02)
    assert back[0].b_t == pytest.approx(253.15 / 293.15)
    again = run_json("fit", file, "--shifts", table)["temperature"]
    assert [shift["b_t"] for shift in again["shifts"]] == pytest.approx([item.b_t for item in back])
    assert "leave out --save-shifts" in shell(
        "fit", file, "--at-temperature", "20degC", "--arms", "1", "--save-shifts", table, code=2
    )


def test_a_table_that_is_none_is_refused(tmp_path):
    table = tmp_path / "shifts.csv"
    table.write_text("T [degC],a_T\n0,-1.5\n20,0\n")
    with pytest.raises(dp.ReadError, match="is the column its logarithm"):
        dp.files.read_shifts(table)
    table.write_text("T [degC],log aT\n20,1.5\n20,0\n")
    with pytest.raises(dp.ReadError, match="twice"):
        dp.files.read_shifts(table)
    table.write_text("T [degC],force [N]\n20,1.5\n30,0\n")
    with pytest.raises(dp.ReadError, match="no column is named a_T"):
        dp.files.read_shifts(table)


def test_fit_does_not_shift_a_column_of_one_temperature(tmp_path):
    file = write_isotherms(tmp_path / "one.csv", moduli(temperatures=[REFERENCE]))
    assert "reference" not in shell("fit", file, "--column", "modulus=E(t)", "--arms", "1")
