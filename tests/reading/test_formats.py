"""Instruments' own formats, from synthetic look-alikes."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import h5py
import numpy as np
import pytest
from kit.instruments import (
    lvm,
    ods,
    ods_rows,
    sheet,
    tdms,
    uff,
    workbook,
    write_format_examples,
    xls,
)
from kit.look_alikes import ROWS, table, truth
from scipy.io import savemat

from dashpot.base.errors import ReadError
from dashpot.extensions import formats as binary
from dashpot.extensions.curves.dynamic.read import read_dynamic
from dashpot.reading import formats
from dashpot.reading.formats import get_format_name
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.impact import read_impact
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.registry import FORMATS


def same(test) -> None:
    time, displacement, force = truth()
    np.testing.assert_allclose(test.time, time, atol=1e-9)
    np.testing.assert_allclose(test.displacement, displacement * 1e-3, atol=1e-12)
    np.testing.assert_allclose(test.force, force, atol=1e-9)


# LVM


@pytest.mark.parametrize("decimal", [".", ","])
@pytest.mark.parametrize("x_columns", ["No", "One", "Multi"])
@pytest.mark.parametrize("segments", [1, 3])
@pytest.mark.parametrize("comment", ["", "OK"])
def test_lvm(tmp_path: Path, decimal: str, x_columns: str, segments: int, comment: str) -> None:
    path = tmp_path / "hits.lvm"
    units = "N\t\tm/s^2" if x_columns == "Multi" else "N\tm/s^2"
    content = lvm(
        decimal=decimal, x_columns=x_columns, segments=segments, units=units, comment=comment
    )
    path.write_text(content)
    test = read_impact(path)
    assert test.starts == tuple(20 * k for k in range(segments))
    assert test.channels == ("Response",)
    np.testing.assert_allclose(test.time[:20], 1e-3 * np.arange(20), atol=1e-12)
    np.testing.assert_array_equal(test.force[-20:], np.arange(20) + 100 * (segments - 1))
    np.testing.assert_array_equal(test.acceleration[0, :20], -np.arange(20.0))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["hits.lvm"]


def test_lvm_reads_records_stacked_under_a_header(tmp_path: Path) -> None:
    path = tmp_path / "hits.lvm"
    path.write_text(lvm(samples=10, rows=30))
    test = read_impact(path)
    assert test.starts == (0, 10, 20)
    np.testing.assert_allclose(test.time[10:20], 1e-3 * np.arange(10))
    assert any("3 records of 10 samples" in note for note in test.source[0].notes)


@pytest.mark.parametrize(
    ("name", "other", "words"),
    [("N\tm/s^2", "kN\tm/s^2", "units: N, m/s"), ("Hammer\tR", "R\tHammer", "names of channels")],
)
def test_lvm_segments_that_differ_are_refused(
    tmp_path: Path, name: str, other: str, words: str
) -> None:
    path = tmp_path / "hits.lvm"
    text = lvm(segments=2).replace("Response", "R")
    at = text.rindex(name)
    path.write_text(text[:at] + other + text[at + len(name) :])
    with pytest.raises(ReadError, match=words):
        read_impact(path)


def test_lvm_with_a_wrong_label_asks_for_the_unit(tmp_path: Path) -> None:
    path = tmp_path / "hits.lvm"
    path.write_text(lvm(units="g\tm/s^2"))
    with pytest.raises(ReadError) as caught:
        read_impact(path)
    for word in ("column 'Hammer' is labelled 'g'", "acceleration", '--units "hammer=N"', "mV/N"):
        assert word in str(caught.value)
    test = read_impact(path, options=ReadOptions(units={"force": "N"}))
    np.testing.assert_array_equal(test.force, np.arange(20.0))
    test = read_impact(path, options=ReadOptions(units={"force": "2mV/N"}))
    np.testing.assert_allclose(test.force, np.arange(20.0) / 2e-3)


def test_lvm_says_when_its_step_has_few_digits(tmp_path: Path) -> None:
    path = tmp_path / "hits.lvm"
    path.write_text(lvm(step="0.000977"))
    assert any("--rate 1024Hz" in note for note in read_impact(path).source[0].notes)
    test = read_impact(path, options=ReadOptions(rate=1024.0))
    assert test.rate == pytest.approx(1024.0)


def test_a_cut_lvm_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "hits.lvm"
    path.write_text(lvm()[:260])
    with pytest.raises(ReadError, match="without two"):
        read_impact(path)


# TDMS


def test_tdms_groups_are_records(tmp_path: Path) -> None:
    tdms(tmp_path / "a.tdms", hits=3)
    test = read_impact(tmp_path / "a.tdms")
    assert test.starts == (0, 50, 100)
    np.testing.assert_allclose(test.time[:50], 1e-3 * np.arange(50))
    item = read_impact(tmp_path / "a.tdms", options=ReadOptions(sheet="Hit 2"))
    assert item.starts == (0,)


@pytest.mark.parametrize("late", [5e-3, 2.5e-3])
def test_tdms_start_offsets_are_applied(tmp_path: Path, late: float) -> None:
    tdms(tmp_path / "a.tdms", offsets=(0.0, late))
    test = read_impact(tmp_path / "a.tdms")
    # both channels are the time itself, so that they agree only if they are aligned
    np.testing.assert_allclose(test.force, -test.acceleration[0], atol=1e-9)
    np.testing.assert_allclose(test.force, test.time * 1e3, atol=1e-9)
    assert any("'Hammer' starts" in note for note in test.source[0].notes)


def test_tdms_channels_that_begin_together_keep_every_sample(tmp_path: Path) -> None:
    """However far from zero their clock begins: a step is lost in the digits of a late start."""
    tdms(tmp_path / "late.tdms", (2e8 + 0.3, 2e8 + 0.3))
    test = read_impact(tmp_path / "late.tdms")
    assert len(test.force) == 50


@pytest.mark.parametrize("of", ["channel", "group", "file"])
def test_tdms_scaling_is_applied(tmp_path: Path, of: str) -> None:
    from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter

    time, displacement, force = truth()
    scale = {
        "NI_Number_Of_Scales": 1, "NI_Scale[0]_Scale_Type": "Linear",
        "NI_Scale[0]_Linear_Slope": 0.001, "NI_Scale[0]_Linear_Y_Intercept": 0.0,
        "NI_Scale[0]_Linear_Input_Source": 0xFFFFFFFF, "NI_Scaling_Status": "unscaled",
    }  # fmt: skip
    columns = {("Time", "s"): time, ("Position", "mm"): displacement, ("Load", "N"): force}
    channels = []
    for (name, unit), values in columns.items():
        individual = scale if (of, name) == ("channel", "Load") else {}
        scaled = individual or of != "channel"  # what a group or a file says is of all its channels
        raw = np.round(values * 1e3).astype(np.int32) if scaled else values
        channels.append(ChannelObject("g", name, raw, {"unit_string": unit, **individual}))
    whole = RootObject(scale if of == "file" else {})
    with TdmsWriter(str(tmp_path / "a.tdms")) as writer:
        writer.write_segment([whole, GroupObject("g", scale if of == "group" else {}), *channels])
    test = read_relaxation(tmp_path / "a.tdms")
    np.testing.assert_allclose(test.force, force, atol=6e-4)


# MAT and HDF5
def test_mat_vectors(tmp_path: Path) -> None:
    time, displacement, force = truth()
    savemat(tmp_path / "a.mat", {"time_s": time, "displacement_mm": displacement, "force_N": force})
    same(read_relaxation(tmp_path / "a.mat"))


def test_mat_structs_with_units(tmp_path: Path) -> None:
    time, displacement, force = truth()
    channels = {
        name: {"data": values, "unit": unit}
        for name, values, unit in (
            ("time", time, "s"),
            ("Weg", displacement, "mm"),
            ("Kraft", force, "N"),
        )
    }
    savemat(tmp_path / "a.mat", {"test": channels, "operator": "nobody"})
    same(read_relaxation(tmp_path / "a.mat"))


def test_mat_with_a_rate_asks_for_it(tmp_path: Path) -> None:
    _, displacement, force = truth()
    savemat(tmp_path / "a.mat", {"displacement_mm": displacement, "force_N": force, "fs": 10.0})
    with pytest.raises(
        ReadError, match=r"the file says fs = 10; if that is right, add --rate 10Hz"
    ):
        read_relaxation(tmp_path / "a.mat")
    same(read_relaxation(tmp_path / "a.mat", options=ReadOptions(rate=10.0)))


def test_hdf5_attributes(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name, values, unit in zip(
            ("time", "displacement", "force"), truth(), ("s", "mm", "N"), strict=True
        ):
            file.create_dataset(f"run/{name}", data=values).attrs["unit"] = unit
    same(read_relaxation(tmp_path / "a.h5"))
    same(read_relaxation(tmp_path / "a.h5", options=ReadOptions(sheet="run")))
    with pytest.raises(
        ReadError, match="--file-part sheet=walk: there is no such group; there are run"
    ):
        read_relaxation(tmp_path / "a.h5", options=ReadOptions(sheet="walk"))


def test_hdf5_matrix_and_named_fields(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "a.h5", "w") as file:
        matrix = file.create_dataset("data", data=np.column_stack(truth()))
        matrix.attrs["columns"] = ["time [s]", "displacement [mm]", "force [N]"]
    # a matrix with column names keeps the units in the names
    same(read_relaxation(tmp_path / "a.h5"))
    with h5py.File(tmp_path / "b.h5", "w") as file:
        kind = [("time_s", float), ("displacement_mm", float), ("force_N", float)]
        file["rows"] = np.array(list(zip(*truth(), strict=True)), dtype=kind)
    same(read_relaxation(tmp_path / "b.h5"))


def test_mat_7_3(tmp_path: Path) -> None:
    path = tmp_path / "a.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in zip(("time_s", "displacement_mm", "force_N"), truth(), strict=True):
            file.create_dataset(name, data=values[None, :]).attrs["MATLAB_class"] = np.bytes_(
                "double"
            )
        word = file.create_dataset("note", data=np.array([[72], [105]], dtype=np.uint16))
        word.attrs["MATLAB_class"] = np.bytes_("char")
    with path.open("r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(128))
    same(read_relaxation(path))
    assert inspect_file(path).format == "MAT 7.3"


# workbooks


def test_workbook(tmp_path: Path) -> None:
    path = tmp_path / "a.xlsx"
    workbook(path, {"Info": [["Operator", "nobody"]], "Data": sheet()})
    same(read_relaxation(path))
    assert inspect_file(path).format == "workbook"


def test_workbooks_of_other_makes(tmp_path: Path) -> None:
    xls(tmp_path / "a.xls", sheet())
    ods(tmp_path / "a.ods", ods_rows(sheet()))
    for name in ("a.xls", "a.ods"):
        same(read_relaxation(tmp_path / name))


def test_workbook_asks_which_of_two_sheets(tmp_path: Path) -> None:
    path = tmp_path / "a.xlsx"
    workbook(path, {"One": sheet(), "Two": sheet()})
    with pytest.raises(ReadError, match="sheets 'One', 'Two' could each be the test"):
        read_relaxation(path)
    same(read_relaxation(path, options=ReadOptions(sheet="Two")))
    with pytest.raises(ReadError, match="the sheets are 'One', 'Two'"):
        read_relaxation(path, options=ReadOptions(sheet="Three"))


def test_a_broken_workbook_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.xlsx"
    workbook(path, {"One": sheet()})
    path.write_bytes(path.read_bytes()[:-300])
    with pytest.raises(ReadError, match="broken or unknown variety of workbook"):
        read_relaxation(path)


# rheometers and microscopes
def test_trios_json(tmp_path: Path) -> None:
    columns = [{"name": n, "unit": u} for n, u in (("Time", "s"), ("Gap", "mm"), ("Force", "N"))]
    values = [list(map(float, row)) for row in zip(*truth(), strict=True)]
    document = {
        "Experiment": {"Results": [{"DataSet": [{"Data": {"columns": columns, "values": values}}]}]}
    }
    path = tmp_path / "a.json"
    path.write_text(json.dumps(document))
    same(read_relaxation(path))
    values[30][2] = 10**309  # JSON's integers have no end
    path.write_text(json.dumps(document))
    with pytest.raises(ReadError, match="row 31 lacks force"):
        read_relaxation(path)
    path.write_text('{"schema": "dashpot/fit@2"}')
    with pytest.raises(ReadError, match="JSON, but no TRIOS data found"):
        read_relaxation(path)


def test_trios_text_steps_are_segments(tmp_path: Path) -> None:
    names = "Time\tAxial displacement\tAxial force\ns\tmm\tN\n"
    path = tmp_path / "a.txt"
    rows = table("\t").splitlines(keepends=True)
    half = "".join(rows[:30]), "".join(rows[30:])
    path.write_text(
        f"Filename\ta.tri\nGap\t50 um\n\n[step]\nRamp\n{names}{half[0]}\n"
        f"[step]\nHold\n{names}{half[1]}"
    )
    same(read_relaxation(path))
    assert len(inspect_file(path).segments) == 2


def test_anton_paar_text(tmp_path: Path) -> None:
    text = (
        "Project:\tP\nTest:\tRelaxation\n\nInterval and data points:\t1\t60\n"
        "Interval data:\tPoint No.\tTime\tDisplacement\tNormal Force\n"
        "\t\t[s]\t[mm]\t[N]\n\t\t\t\t\n"
    )
    rows = "".join(
        f"\t{i + 1}\t{row}\n" for i, row in enumerate(table("\t", decimal=",").splitlines())
    )
    path = tmp_path / "a.txt"
    path.write_bytes((text + rows).encode("utf-16"))
    same(read_relaxation(path))


def test_jpk_text(tmp_path: Path) -> None:
    def head(index: int, name: str) -> str:
        return (
            f"# TEXT EXPORT\n# index: 0\n#\n# segmentIndex: {index}\n# segment: {name}\n"
            "# columns: tipSampleSeparation vDeflection seriesTime\n"
            '# fancyNames: "Tip-Sample Separation" "Vertical Deflection" "Series Time"\n'
            "# springConstant: 56.3\n# calibrationSlots: nominal force elapsed\n"
            "# units: mm N s\n#\n"
        )

    time, displacement, force = truth()
    rows = table(" ", columns=(displacement, force, time)).splitlines(keepends=True)
    path = tmp_path / "a.txt"
    path.write_text(
        head(0, "extend") + "".join(rows[:20]) + "\n" + head(1, "pause") + "".join(rows[20:])
    )
    same(read_relaxation(path))
    assert [s.name for s in inspect_file(path).segments] == ["extend", "pause"]
    assert len(read_relaxation(path, options=ReadOptions(segment=2)).time) == ROWS - 20


def test_dma_export(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    rows = "".join(f"{f};{10 + f};{f / 10};{1.5}\n" for f in (0.1, 1.0, 10.0, 100.0))
    path.write_text("f;E';E'';T\nHz;MPa;MPa;°C\n" + rows)
    test = read_dynamic(path)
    np.testing.assert_allclose(test.storage, [10.1e6, 11e6, 20e6, 110e6])
    np.testing.assert_allclose(test.loss_factor, test.loss / test.storage)
    np.testing.assert_allclose(test.temperature, 274.65)
    path.write_text(
        "Frequency (Hz);Storage stiffness (N/mm);Loss stiffness (N/mm)\n1;2;3\n2;3;4\n3;4;5\n"
    )
    assert read_dynamic(path).unit == "N/m"
    path.write_text("Time (s);Force (N)\n" + table(";", columns=truth()[:2]))
    with pytest.raises(ReadError, match="looks like frequency"):
        read_dynamic(path)


def test_a_missing_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tdms(tmp_path / "a.tdms")
    monkeypatch.setitem(sys.modules, "nptdms", None)
    with pytest.raises(ReadError, match="npTDMS; install it with: "):
        read_impact(tmp_path / "a.tdms")


def test_each_accelerometer_has_its_sensitivity(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(
        "Time (s),Hammer (mV),Accel 1 (mV),Accel 2 (mV)\n"
        + table(",", columns=(truth()[0], *(np.arange(float(ROWS)),) * 3))
    )
    assert inspect_file(path).kind == "impact"
    with pytest.raises(ReadError, match=r"'Hammer' is labelled 'mV', a unit of voltage"):
        read_impact(path)
    with pytest.raises(ReadError, match=r"'Accel 1' .*; column 'Accel 2' .*acceleration=100mV/g"):
        read_impact(path, options=ReadOptions(units={"force": "2mV/N"}))
    units = {"time": "s", "force": "2mV/N", "Accel 1": "100mV/g", "accel 2": "10mV/(m/s^2)"}
    test = read_impact(path, options=ReadOptions(units=units))
    np.testing.assert_allclose(test.force, np.arange(ROWS) / 2)
    np.testing.assert_allclose(test.acceleration[0], np.arange(ROWS) / 100 * 9.80665)
    np.testing.assert_allclose(test.acceleration[1], np.arange(ROWS) / 10)
    shouted = read_impact(path, options=ReadOptions(units=units | {"force": "2MV/N"}))
    np.testing.assert_array_equal(shouted.force, test.force)


def test_text_loads_no_heavy_library(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("time [s],displacement [mm],force [N]\n" + table(","))
    code = (
        "import sys; from dashpot.reading.readers.relaxation import read_relaxation; "
        "from dashpot.reading.readers.inspect import inspect_file; "
        f"read_relaxation({str(path)!r}); inspect_file({str(path)!r}); "
        "print([m for m in ('scipy', 'matplotlib', 'h5py', 'pyuff', 'nptdms', 'jinja2', "
        "'subprocess', 'dashpot.reading.sandbox') "
        "if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_lvm_without_a_step_takes_the_rate(tmp_path: Path) -> None:
    path = tmp_path / "hits.lvm"
    path.write_text("".join(row for row in lvm().splitlines(True) if "Delta_X" not in row))
    with pytest.raises(ReadError, match="no column of time and no Delta_X; give the rate"):
        read_impact(path)
    assert [q.option for q in inspect_file(path).questions] == ["--rate RATE"]
    assert read_impact(path, options=ReadOptions(rate=1000.0)).rate == pytest.approx(1000.0)


# UFF


@pytest.mark.parametrize(
    ("labels", "length", "factor"),
    [
        (("N", "m/s^2"), None, 1.0),
        (("N", "g"), None, 9.80665),
        (("NONE", "NONE"), 1.0, 1.0),
        (("NONE", "NONE"), 1000.0, 1e-3),  # dataset 164 says millimetres
    ],
)
def test_uff_units(
    tmp_path: Path, labels: tuple[str, str], length: float | None, factor: float
) -> None:
    uff(tmp_path / "a.uff", labels=labels, length=length)
    test = read_impact(tmp_path / "a.uff")
    np.testing.assert_allclose(test.acceleration[0], 2 * factor * np.arange(30.0))
    np.testing.assert_allclose(test.force, np.arange(30.0))
    assert test.channels == ("response",)


def test_uff_without_units_asks(tmp_path: Path) -> None:
    uff(tmp_path / "a.uff", labels=("NONE", "NONE"), length=None)
    with pytest.raises(ReadError, match=r"'hammer' \(hammer\) has no unit"):
        read_impact(tmp_path / "a.uff")


def test_dma_by_other_names(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    omega = 2 * np.pi * np.array([0.1, 1.0, 10.0])
    rows = "".join(f"{w!r},{10.0},{0.2}\n" for w in omega.tolist())
    path.write_text("Angular frequency (rad/s),E' (MPa),tan delta\n" + rows)
    test = read_dynamic(path)
    np.testing.assert_allclose(test.frequency, [0.1, 1.0, 10.0])
    np.testing.assert_allclose(test.loss, 2e6)
    assert not inspect_file(path).questions
    path.write_text("Frequency (Hz),Storage modulus (MPa),Loss modulus (N/mm)\n" + rows)
    with pytest.raises(ReadError, match="storage is a stress and loss a stiffness"):
        read_dynamic(path)


def test_what_unpacks_to_too_much_is_passed_over(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("bomb", shape=(1 << 34,), chunks=(1 << 20,), dtype="f8")
        for name, values in zip(("time_s", "displacement_mm", "force_N"), truth(), strict=True):
            file[name] = values
    test = read_relaxation(path)
    same(test)
    assert any("'bomb' with 17179869184 values was passed over" in n for n in test.source.notes)
    path = tmp_path / "a.xlsx"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("xl/workbook.xml", "<a/>")
        file.filelist[0].file_size = 1 << 32
    with pytest.raises(ReadError, match=r"unpacks to 4.3 GB"):
        read_relaxation(path)


def test_every_format_is_recognised_by_its_bytes(tmp_path: Path) -> None:
    """Of a file of each: one whose mark is never met would be read as text."""
    made = write_format_examples(tmp_path) | {
        "trios": b'[{"Results": []}]',
        "text": b"t [s],F [N]\n0,1\n1,2\n",
        "unfinished": b"UnFinMF 4.10    ",
    }
    others = [*FORMATS["wav"].marks, *FORMATS["arrow"].marks]
    made |= {f"mark {i}": mark + bytes(9) for i, mark in enumerate(others)}
    made |= {f"unread {i}": mark + bytes(9) for i, mark in enumerate(FORMATS["unread"].marks)}
    ofs = {get_format_name(RawFile(name, None, content)) for name, content in made.items()}
    modules = {
        path.stem
        for folder in (Path(formats.__file__), Path(binary.__file__))
        for path in folder.parent.glob("*.py")
        if re.search(r"^def read\(", path.read_text("utf-8"), re.MULTILINE)
    }
    assert ofs == modules, "add a file to `write_format_examples` of tests/kit/instruments"
    heads = [content[:40].removeprefix(b"\xef\xbb\xbf") for content in made.values()]
    rest = {mark for mark, _ in formats._MAGIC if not any(head.startswith(mark) for head in heads)}
    assert rest == {b"MATLAB 7.3 MAT-file"}  # an HDF5 file under another head
