"""Files of compression stress relaxation: headings and faults."""

from __future__ import annotations

import numpy as np
import pytest
from kit.foreign.aging import Rubber, lot

from dashpot.base.errors import ReadError
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.materials.csr.fit_files import csr_files
from dashpot.extensions.materials.csr.read import read_csr
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.detect_kind import recognise

LOT = lot(Rubber(), noise=0.0)


def write_text(folder, text, name="ovens.csv"):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def rows(head, *columns, mark=","):
    cells = zip(*columns, strict=True)
    return "\n".join([head, *(mark.join(map(str, row)) for row in cells), ""])


SHORT = {"hours": ["0.5", "24", "500"], "force": ["40", "38", "31"]}


@pytest.mark.parametrize(
    ("head", "of"),
    [
        ("time [h],force [N]", 3600.0),
        ("hours,force (N)", 3600.0),
        ("days,F [N]", 86400.0),
        ("Zeit [h],Kraft [N]", 3600.0),
        ("time [h],F/F0 [%]", 3600.0),
        ("elapsed [d],retained force [1]", 86400.0),
    ],
)
def test_read_csr_recognises_clock_and_force_headings(tmp_path, head, of):
    text = "# temperature: 125 degC\n" + rows(head, SHORT["hours"], SHORT["force"])
    path = write_text(tmp_path, text)
    assert recognise(path).kind == "csr"
    test = read_csr(path)
    assert test.time == pytest.approx(of * np.array([0.5, 24, 500]))
    assert test.force == pytest.approx([40, 38, 31])
    assert test.temperature == pytest.approx([398.15] * 3)
    assert test.specimen_number.tolist() == [1, 1, 1]


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("time [s],force [N]\n0,1\n1,2\n2,3\n", "unclear"),
        ("# ISO 3384-1\ntime [min],force [N]\n30,40\n60,39\n600,38\n", "csr"),
        ("time [h],displacement [mm],force [N]\n0,0,0\n1,1,1\n2,1,1\n3,1,1\n", "relaxation"),
        (
            "time [h],force [N],strain [%],stress [MPa]\n1,1,1,1\n2,2,2,2\n3,3,3,3\n",
            "stress-strain",
        ),
        ("time [h],force [N],frequency [Hz]\n1,1,1\n2,1,2\n3,1,3\n", "unclear"),
        ("time [h],temperature [degC]\n0,20\n1,21\n2,22\n", "unclear"),
    ],
)
def test_recognise_rejects_tables_that_are_no_csr(tmp_path, text, kind):
    assert recognise(write_text(tmp_path, text)).kind == kind


def test_a_file_comes_back_as_it_was_written(tmp_path):
    test = read_csr(write_text(tmp_path, LOT.text()))
    assert test.time == pytest.approx(3600 * LOT.hours)
    assert test.force == pytest.approx(LOT.force)
    assert test.specimen_number.tolist() == LOT.specimen_number.tolist()


@pytest.mark.parametrize("mark", [",", ";", "\t"])
def test_pieces_and_methods_are_words(tmp_path, mark):
    names = ["left", "left", "left", "right", "right", "right"]
    head = mark.join(["time [h]", "force [N]", "temperature [degC]", "piece", "method"])
    text = rows(head, SHORT["hours"] * 2, SHORT["force"] * 2, [125] * 6, names, ["A"] * 6,
                mark=mark)  # fmt: skip
    test = read_csr(write_text(tmp_path, text))
    assert test.specimen_number.tolist() == [1, 1, 1, 2, 2, 2]
    assert test.method == "A"


def test_a_piece_begins_where_the_clock_does(tmp_path):
    text = rows("time [h],force [N],temperature [degC]", SHORT["hours"] * 2, SHORT["force"] * 2,
                [125] * 6)  # fmt: skip
    assert read_csr(write_text(tmp_path, text)).specimen_number.tolist() == [1, 1, 1, 2, 2, 2]


def test_a_file_for_each_oven(tmp_path):
    paths = []
    for oven in (100.0, 125.0, 150.0):
        individual = oven == LOT.celsius
        text = rows(
            "time [h],force [N],piece",
            LOT.hours[individual],
            LOT.force[individual],
            LOT.specimen_number[individual],
        )
        paths.append(write_text(tmp_path, text, f"{oven:.0f}.csv"))
    with pytest.raises(ReadError, match="the file says no temperature of its oven"):
        csr_files(paths)
    with pytest.raises(ReadError, match="--temperature was given 2 times for 3 files"):
        csr_files(paths, temperatures=[373.15, 398.15])
    result = csr_files(paths, temperatures=[373.15, 398.15, 423.15])
    assert [oven.temperature for oven in result.ovens] == pytest.approx([373.15, 398.15, 423.15])
    assert [oven.specimens for oven in result.ovens] == [3, 3, 3]
    assert len(result.sources) == 3


@pytest.mark.parametrize("kelvin", [398.15, 398.6])
def test_read_csr_accepts_the_temperature_of_the_file_repeated(tmp_path, kelvin):
    text = rows("time [h],force [N],temperature [degC]", *SHORT.values(), [125] * 3)
    test = read_csr(write_text(tmp_path, text), specimen=Specimen(temperature=kelvin))
    assert test.temperature == pytest.approx([398.15] * 3)


@pytest.mark.parametrize(
    "text",
    [
        rows("time [h],force [N],temperature [degC]", *SHORT.values(), [125] * 3),
        "# temperature: 125 degC\n" + rows("time [h],force [N]", *SHORT.values()),
    ],
)
def test_another_temperature_than_that_of_the_file_is_refused(tmp_path, text):
    path = write_text(tmp_path, text)
    with pytest.raises(ReadError, match=r"125 degC.*--temperature.*Leave out --temperature"):
        read_csr(path, specimen=Specimen(temperature=398.66))


@pytest.mark.parametrize(("largest", "fine"), [("1.51", True), ("1.5", False)])
def test_read_csr_asks_about_fractions_labelled_per_cent(tmp_path, largest, fine):
    text = "# 125 degC\n" + rows("time [h],F/F0 [%],temperature [degC]", SHORT["hours"],
                                 [largest, "0.9", "0.7"], [125] * 3)  # fmt: skip
    path = write_text(tmp_path, text)
    if fine:
        assert read_csr(path).force[0] == 1.51
        return
    with pytest.raises(ReadError, match=r"'F/F0' is said to be in %.*as of a fraction"):
        read_csr(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            rows("time [h],force [N],temperature [degC],method", *SHORT.values(), [125] * 3, "ABA"),
            "Fit each method by itself",
        ),
        (
            rows("time [h],force [N],temperature [degC]", ["0", "24", "500"], SHORT["force"],
                 [125] * 3),
            "a time is 0; expected numbers above 0",
        ),
        (
            rows("time [h],force [N],temperature [degC]", ["0.1", "24", "500"], SHORT["force"],
                 [125] * 3),
            "first read 6 min after its compression",
        ),
        (
            rows("time [h],force,temperature [degC]", *SHORT.values(), [125] * 3),
            "'force' .*has no unit; add --units",
        ),
    ],
)  # fmt: skip
def test_read_csr_states_a_fault_in_one_sentence(tmp_path, text, message):
    with pytest.raises(ReadError, match=message) as caught:
        csr_files([write_text(tmp_path, text)])
    assert "\n" not in str(caught.value)


def test_methods_of_two_files_are_not_mixed(tmp_path):
    head = "time [h],force [N],temperature [degC]"
    paths = [
        write_text(
            tmp_path, f"# method {item}\n" + rows(head, *SHORT.values(), [125] * 3), f"{item}.csv"
        )
        for item in "AB"
    ]
    assert [read_csr(path).method for path in paths] == ["A", "B"]
    with pytest.raises(ReadError, match="Fit each method by itself"):
        csr_files(paths)


def test_columns_are_named_where_they_say_nothing(tmp_path):
    path = write_text(tmp_path, rows("a,b,c", *SHORT.values(), [125] * 3))
    named = ReadOptions(
        time="a", force="b", temperature="c", kind="csr",
        units={"time": "h", "force": "N", "temperature": "degC"},
    )  # fmt: skip
    assert read_csr(path, options=named).temperature == pytest.approx([398.15] * 3)


def test_a_clock_that_stands_begins_another_piece(tmp_path):
    text = "# temperature: 125 degC\n" + rows(
        "time [h],force [N]", ["0.5", "24", "500", "500", "700", "900"], range(40, 34, -1)
    )
    assert read_csr(write_text(tmp_path, text)).specimen_number.tolist() == [1, 1, 1, 2, 2, 2]
