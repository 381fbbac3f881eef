"""Recognition of the kind of a file, and which columns can be read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from kit.kinds import bench, csv, files, hammer, late, ramp_and_hold, response

from dashpot.base.errors import ReadError
from dashpot.datamodel.frf import Kind
from dashpot.extensions.curves.creep.read import read_creep
from dashpot.extensions.curves.dynamic.read import read_dynamic
from dashpot.extensions.materials.cld.read import read_cld
from dashpot.extensions.materials.csr.read import read_csr
from dashpot.extensions.materials.drop.read import read_drop_test
from dashpot.extensions.materials.hyperelastic.datamodel import StressStrainTest
from dashpot.extensions.materials.hyperelastic.read import read_stress_strain
from dashpot.extensions.materials.indentation.read import read_indentation
from dashpot.reading.columns.file_kinds import KINDS_OF_FILE
from dashpot.reading.columns.kind_detection import (
    MASTER_CURVE_DECADES,
    SINGLE_FREQUENCY_DECADES,
    detect_table_kind,
    parse_file_kind,
)
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.detect_kind import suggest_relaxation_options
from dashpot.reading.readers.frf import read_frf
from dashpot.reading.readers.impact import read_impact
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.reading.table import Column, FileTable, make_loader
from dashpot.workflow.inspections import inspect_files

FILES = files()


def read_tension(path: Path) -> StressStrainTest:
    return read_stress_strain(path, "uniaxial")


READERS = {
    read_relaxation: {"relaxation", "cld", "cyclic"},
    read_cld: {"relaxation", "cld", "cyclic"},
    read_impact: {"impact"},
    read_frf: {"frf", "transmissibility"},
    read_dynamic: {"dma", "master-curve"},
    read_creep: {"creep", "relaxation", "cld", "cyclic"},
    read_indentation: {"indentation"},
    read_tension: {"stress-strain"},
    read_csr: {"csr"},
    read_drop_test: {"drop"},
}


def write_kind(folder: Path, name: str) -> Path:
    path = folder / name
    path.write_text(FILES[name][0], encoding="utf-8")
    return path


@pytest.mark.parametrize("name", FILES)
def test_each_kind_is_named(tmp_path: Path, name: str) -> None:
    kind = FILES[name][1]
    (result,) = inspect_files([write_kind(tmp_path, name)]).files
    assert result.kind == kind
    assert result.use == KINDS_OF_FILE[kind].usage
    assert not result.questions


def test_every_kind_has_a_file() -> None:
    shown = {kind for _, kind in FILES.values()}
    assert shown == set(KINDS_OF_FILE) - {"plug-in", "blank"}, (
        "add a file of it to tests/kit/kinds.py"
    )


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("read", READERS)
def test_a_reader_takes_its_kind_and_says_of_others_what_they_are(
    tmp_path: Path, read, name: str
) -> None:
    kind = FILES[name][1]
    path = write_kind(tmp_path, name)
    by_numbers = name == "creep.csv" and read in {read_relaxation, read_cld}  # prepare() shows it
    if name == "unclocked.csv" and read in {read_relaxation, read_creep}:
        with pytest.raises(ReadError, match="--rate"):
            read(path)
        return
    if kind in READERS[read] or by_numbers:
        read(path)
        return
    with pytest.raises(ReadError) as caught:
        read(path)
    seen = "relaxation" if name in {"creep.csv", "triangle.csv", "fatigue.csv"} else kind
    what, command, *_ = KINDS_OF_FILE[seen]
    message = str(caught.value)
    assert message.startswith(f"{name}: this is {what} (")
    assert message.endswith(command.replace("COLUMN", '"Relaxation modulus"'))


def test_who_names_the_columns_knows_what_the_file_is(tmp_path: Path) -> None:
    path = tmp_path / "both.csv"
    path.write_text(hammer("force [N],c [mm],acceleration [m/s^2]"))
    with pytest.raises(ReadError, match="this is a hammer test"):
        read_relaxation(path)
    test = read_relaxation(path, options=ReadOptions(displacement="c", units={"c": "mm"}))
    assert len(test.time) == 6000


@pytest.mark.parametrize(
    ("decades", "kind"),
    [(SINGLE_FREQUENCY_DECADES - 1e-6, "single-frequency"),
     (SINGLE_FREQUENCY_DECADES + 1e-6, "dma"),
     (MASTER_CURVE_DECADES - 1e-6, "dma"), (MASTER_CURVE_DECADES + 1e-6, "master-curve")],
)  # fmt: skip
def test_kind_of_sweep_depends_on_its_decades(decades: float, kind: str) -> None:
    frequency = 10 ** np.linspace(0, decades, 9)
    columns = tuple(Column(name, "MPa") for name in ("storage", "loss"))
    values = np.column_stack([frequency, frequency, frequency])
    table = FileTable("", (Column("frequency", "Hz"), *columns), make_loader(values))
    assert detect_table_kind(table, ReadOptions())[0] == kind


@pytest.mark.parametrize("suffix", [".mat", ".h5", "7.3.h5"])
def test_a_complex_response_of_a_binary_file_is_an_frf(tmp_path: Path, suffix: str) -> None:
    lines, value = response()
    coherence = np.linspace(0.5, 1, len(lines))
    path = tmp_path / f"a{suffix}"
    if suffix == ".mat":
        from scipy.io import savemat

        content = {"f": lines, "H": value, "coh": coherence, "psd": abs(value)}
        savemat(path, content)
    else:
        h5py = pytest.importorskip("h5py")
        pair = np.empty(len(lines), dtype=[("real", float), ("imag", float)])
        pair["real"], pair["imag"] = value.real, value.imag
        with h5py.File(path, "w") as file:
            file["f"], file["coh"] = lines, coherence
            file["H"] = pair if suffix.startswith("7.3") else value
    with pytest.raises(ReadError, match=r'--units "real=\(m/s\^2\)/N".*--units "frequency=Hz"'):
        read_frf(path)
    units = {"frequency": "Hz", "real": "(m/s^2)/N"}
    frf = read_frf(path, options=ReadOptions(units=units))
    assert frf.quantity is Kind.ACCELERANCE
    np.testing.assert_allclose(frf.value, value)
    np.testing.assert_allclose(frf.coherence, coherence)


def test_read_frf_asks_which_of_two_responses(tmp_path: Path) -> None:
    lines, value = response()
    path = tmp_path / "a.csv"
    head = "f [Hz],H1 real [g/N],H1 imag [g/N],H2 real [g/N],H2 imag [g/N],coh 1,coh 2"
    half = value / 2
    columns = (value.real, value.imag, half.real, half.imag, 0 * lines + 1, 0 * lines + 0.9)
    path.write_text(csv(head, lines, *columns))
    with pytest.raises(
        ReadError, match=r"--column real=.*--column imaginary=.*--column coherence="
    ):
        read_frf(path)
    named = {"real": "H2 real", "imaginary": "H2 imag"}
    with pytest.raises(ReadError, match="'coh 1' and 'coh 2' could each be the coherence"):
        read_frf(path, options=ReadOptions(**named))
    frf = read_frf(path, options=ReadOptions(**named, coherence="7"))
    np.testing.assert_allclose(frf.value, half * 9.80665, rtol=1e-6)
    assert frf.coherence is not None
    assert frf.coherence[0] == pytest.approx(0.9)


def test_a_record_without_its_ramp_says_so(tmp_path: Path) -> None:
    path = tmp_path / "late.csv"
    for settling, begins in ((0.0, "after its ramp"), (1e-5, "within its ramp, or after it")):
        path.write_text(late(settling))
        (result,) = inspect_files([path]).files
        assert f"the record begins {begins}" in result.refusal
        assert "start recording a second before the ramp" in result.refusal.lower()


@pytest.mark.parametrize(
    ("head", "requested", "likelier", "meant"),
    [
        ("time [s],x [m],force [N]", r"travel is 8 m", "displacement=mm", ""),
        ("time [s],x [mm],force [MN]", r"force is 2\.\d+ MN", "force=kN", ""),
        ("time [ms],x [mm],force [N]", r"lasts 20 ms", "time=s", "time=ms"),
    ],
)
def test_read_asks_about_an_implausible_size(
    tmp_path: Path, head: str, requested: str, likelier: str, meant: str
) -> None:
    path = tmp_path / "seal.csv"
    path.write_text(bench(ramp_and_hold(), head=head))
    with pytest.raises(ReadError, match=rf"{requested}.*--units {likelier}"):
        read_relaxation(path)
    for unit in filter(None, (likelier, meant)):  # 8 m no one means, whatever is said
        role, _, word = unit.partition("=")
        test = read_relaxation(path, options=ReadOptions(units={role: word}))
        assert len(test.time) == 500
    with pytest.raises(ReadError, match=requested):
        read_relaxation(path, options=ReadOptions(units={"stress": "MPa"}))


@pytest.mark.parametrize("unit", ["nN", "pN", "mN"])
@pytest.mark.parametrize("length", ["um", "nm"])
def test_small_sizes_are_no_question(tmp_path: Path, unit: str, length: str) -> None:
    path = tmp_path / "cell.csv"
    path.write_text(bench(ramp_and_hold(), head=f"time [s],x [{length}],force [{unit}]"))
    assert len(read_relaxation(path).time) == 500


def test_inspect_asks_for_all_that_a_hammer_file_leaves_open(tmp_path: Path) -> None:
    path = tmp_path / "ch.csv"
    path.write_text(hammer("ch1,ch2,ch3"))
    with pytest.raises(ReadError) as caught:
        read_impact(path)
    message = str(caught.value)
    requested = '--column acceleration="ch2" --column acceleration="ch3" --column hammer="ch1"'
    assert requested in message
    named = ReadOptions(hammer="2", acceleration=("ch2", "ch3"))
    with pytest.raises(ReadError, match=r'"hammer=N,acceleration=m/s\^2"'):
        read_impact(path, options=named)
    assert inspect_file(path, options=named).kind == "impact"


@pytest.mark.parametrize(
    "head",
    ["T=25;CTg=14.65;\nw\tG'\tG\"\nrad/s\tPa\tPa\n", "Omega [rad/s]\tE' [Pa]\tE'' [Pa]\n"],
)
def test_moduli_with_primes_are_a_sweep(tmp_path: Path, head: str) -> None:
    rows = [(0.1, 10.0, 1.0), (1.0, 12.0, 2.0), (10.0, 15.0, 1.5)]
    path = tmp_path / "PI.osc"
    table = "".join("\t".join(map(str, row)) + "\n" for row in rows)
    path.write_text(head + table)
    test = read_dynamic(path)
    np.testing.assert_allclose(test.omega, [0.1, 1.0, 10.0])
    np.testing.assert_allclose(test.loss, [1.0, 2.0, 1.5])
    path.write_text(head.replace("rad/s\tPa\tPa\n", "").replace(" [rad/s]", "") + table)
    with pytest.raises(ReadError, match="frequency=rad/s"):
        read_dynamic(path)


def test_a_sweep_without_names_is_read_by_numbers(tmp_path: Path) -> None:
    path = tmp_path / "sweep.txt"
    path.write_text("1\t10\t1\n2\t11\t1.1\n4\t12\t1.2\n")
    units = {"frequency": "Hz", "storage": "MPa", "loss": "MPa"}
    named = ReadOptions(frequency="1", storage="2", loss="3", units=units)
    assert read_dynamic(path, options=named).storage[2] == pytest.approx(12e6)
    tangent = ReadOptions(frequency="1", storage="2", loss_factor="3", units=units)
    assert read_dynamic(path, options=tangent).loss[2] == pytest.approx(12e6 * 1.2)


def test_inspect_file_explains_a_sweep_with_frequency_in_its_header(
    tmp_path: Path,
) -> None:
    path = tmp_path / "sweep.csv"
    rows = "".join(f"{0.01 * 2**i:.5g},{5 / (1 + i)},{0.6 / (1 + i)},.12\n" for i in range(9))
    head = "Frequency: 10 Hz\n\nstrain [%],storage [MPa],loss [MPa],Tan(delta)\n"
    path.write_text(head + rows)
    inspection = inspect_file(path)
    assert inspection.kind == "not-a-test"
    assert "no frequency. Write a column 'frequency [Hz]'" in inspection.reason
    assert [column.name for column in inspection.columns][-1] == "Tan(delta)"
    # and no column of another unit is proposed for a ramp
    assert suggest_relaxation_options(path) == ""
    rows = "".join(f"10,{line}\n" for line in rows.splitlines())
    path.write_text(head.replace("strain", "frequency [Hz],strain") + rows)
    assert inspect_file(path).kind == "strain-sweep"


def test_old_name_of_a_kind_is_accepted_and_not_shown():
    assert parse_file_kind("slam") == parse_file_kind("drop")
    assert "slam" not in KINDS_OF_FILE
