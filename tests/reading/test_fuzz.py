"""Whatever the bytes: a record or a refusal, and soon; the same mutants every time.

``just fuzz`` tries more of them, and others each time.
"""

from __future__ import annotations

import json

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from kit import guided
from kit.crafted.dialects import DIALECTS
from kit.fuzzing import Fuzzer
from kit.instruments import write_format_examples
from kit.mutants import draw_damaged_bytes, draw_damaged_json, draw_damaged_zip, texts, tries

pytestmark = [pytest.mark.fuzz, pytest.mark.usefixtures("mutants")]


FORMATS = (
    "arrow", "hdf5", "hdf5 links", "lvm", "lvm clocks", "mat", "mat 4", "mat packed", "mdf",
    "mdf 3", "mdf unsorted", "ods", "parquet", "tdms", "uff", "uff frf", "wav", "xls", "xlsx",
)  # fmt: skip
TRIOS = {"Properties": {"Name": "a"}, "Results": [
    {"columns": [{"name": "Time", "unit": "s"}, {"name": "Gap"}], "values": [[1, 2], [2, 3], [3]]},
]}  # fmt: skip


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    format_examples = write_format_examples(tmp_path_factory.mktemp("good"))
    assert set(format_examples) == set(FORMATS)
    return format_examples


@tries(100)
@given(content=st.binary(max_size=400))
@example(b"\xff\xfe")
@example(b"\xff\xfe\x00")
@example(b"\n    -1\n    58\n")
@example(b"{" * 5000)
@example(b"TDSm")
@example(b"1e+308")
@example(b'"\n0.0,0.0')
@example(b"0.0,0.0,0.0\n" + b"0.0,0.0,1\n" * 7)
@example(b"LabVIEW Measurement\n***End_of_Header***\n***End_of_Header***\nX_Value\n")
def test_any_bytes(fuzzer: Fuzzer, content: bytes) -> None:
    fuzzer.survives("read_all", content)


@tries(400)
@given(content=texts())
@example(b"0.0,time,NaN" + b"\n0.0,0.0,0.0" * 8)
def test_any_text(fuzzer: Fuzzer, content: bytes) -> None:
    fuzzer.survives("read_all", content)


@tries(400)
@given(content=st.sampled_from(DIALECTS).flatmap(lambda item: draw_damaged_bytes(item.content)))
def test_wounded_text(fuzzer: Fuzzer, content: bytes) -> None:
    fuzzer.survives("read_all", content)


def test_readers_survive_the_saved_fuzz_corpus(fuzzer: Fuzzer) -> None:
    record = guided.read(guided.CORPUS)
    assert record
    for item in record:
        fuzzer.survives(guided.task_of(item), item[1:])


@pytest.mark.parametrize("name", FORMATS)
def test_wounded_instruments(fuzzer: Fuzzer, good: dict[str, bytes], name: str) -> None:
    @tries(300)
    @given(content=draw_damaged_bytes(good[name]))
    def mutants(content: bytes) -> None:
        fuzzer.survives("read_all", content)

    mutants()


@pytest.mark.parametrize("name", ["xlsx", "ods"])
def test_workbooks_of_wounded_parts(fuzzer: Fuzzer, good: dict[str, bytes], name: str) -> None:
    @tries(300)
    @given(content=draw_damaged_zip(good[name]))
    def mutants(content: bytes) -> None:
        fuzzer.survives("read_all", content)

    mutants()


@tries(300)
@given(content=draw_damaged_json(TRIOS) | draw_damaged_bytes(json.dumps(TRIOS).encode()))
def test_any_trios(fuzzer: Fuzzer, content: bytes) -> None:
    fuzzer.survives("read_all", content)


@tries(100)
@given(content=st.text(max_size=300))
def test_any_calibration(fuzzer: Fuzzer, content: str) -> None:
    text = f"<FTSensor><Calibration>{content}</Calibration></FTSensor>"
    fuzzer.survives("calibrate", text.encode(errors="replace"))


@pytest.mark.parametrize(
    "content",
    [
        b"1" * 300_000,
        b"," * 300_000,
        b"a " * 300_000,
        b'"' * 300_000,
        b"(" * 300_000,
        b"#" * 30_000 + b"\n" * 30_000,
        b"-1\n" * 30_000,
        b"1,2\n,\n" * 10_000,
        ("time [s];" * 1_500 + "\n" + "1;" * 1_500 + "\n").encode(),
        ("time [s];" * 800 + "\n" + "1;" * 800 + "\n").encode() * 3,
    ],
    ids=[
        "digits",
        "commas",
        "words",
        "quotes",
        "brackets",
        "blank",
        "lone",
        "holes",
        "wider",
        "wide",
    ],
)
def test_long_and_strange(fuzzer: Fuzzer, content: bytes) -> None:
    fuzzer.survives("read_all", content)
