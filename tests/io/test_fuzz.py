"""Whatever the bytes: a record or a ReadError, and soon."""

from __future__ import annotations

import contextlib
import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from kit.look_alikes import DIALECTS

from dashpot.base.errors import ReadError
from dashpot.io.formats import ati
from dashpot.io.options import ReadOptions
from dashpot.io.readers.dynamic import read_dynamic
from dashpot.io.readers.frf import read_frf
from dashpot.io.readers.impact import read_impact
from dashpot.io.readers.inspect import inspect_file
from dashpot.io.readers.modulus import read_modulus
from dashpot.io.readers.relaxation import read_relaxation

READERS = (inspect_file, read_relaxation, read_impact, read_frf, read_dynamic, read_modulus)
NAMED = ReadOptions(
    time="1", displacement="2", force="3", acceleration=("2",), frequency="1", storage="2",
    loss="3", modulus="2",
    units={
        "time": "s", "displacement": "mm", "force": "N", "acceleration": "g", "frequency": "Hz",
        "storage": "Pa", "loss": "Pa", "modulus": "Pa",
    },
)  # fmt: skip
QUICK = settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
LONG = settings(QUICK, max_examples=3000)


def survives(path: Path, content: bytes) -> None:
    """Every reader gives a value or a ReadError within seconds."""
    path.write_bytes(content)
    start = time.process_time()
    for reader in READERS:
        for options in (ReadOptions(), NAMED):
            with contextlib.suppress(ReadError):
                reader(path, options=options)
    assert time.process_time() - start < 10.0


CELL = st.one_of(
    st.floats().map(repr),
    st.integers(-(10**6), 10**6).map(str),
    st.sampled_from([
        "", "NaN", "OVER", "1,234", "1.234,5", "-", '"', '"1,5"', "1_0", "0x1", "1e999", "=1", "٣",
        "12:30:01", "2024-01-02", "s", "[N]", "time", "Kraft", "#", "\x00",
    ]),
    st.text(max_size=4),
)  # fmt: skip
LINES = st.lists(st.lists(CELL, max_size=5), max_size=40)


@st.composite
def texts(draw: st.DrawFn) -> bytes:
    """Tables with faults, in some delimiter, line end and encoding."""
    sign = draw(st.sampled_from([",", ";", "\t", " ", "|", ", ", ":"]))
    end = draw(st.sampled_from(["\n", "\r\n", "\r", "\r\r\n"]))
    lines = [sign.join(cells) for cells in draw(LINES)]
    if draw(st.booleans()):
        steady = sign.join(draw(st.lists(CELL, min_size=3, max_size=4)))
        lines += [steady] * draw(st.integers(1, 30))
    code = draw(st.sampled_from(["utf-8", "utf-16", "cp1252", "gb18030", "utf-32"]))
    return end.join(lines).encode(code, "replace")


@st.composite
def wounded(draw: st.DrawFn, files: list[bytes]) -> bytes:
    """A good file with bytes changed, cut out or doubled."""
    content = bytearray(draw(st.sampled_from(files)))
    for _ in range(draw(st.integers(1, 6))):
        at = draw(st.integers(0, max(0, len(content) - 1)))
        kind = draw(st.sampled_from(["set", "cut", "double", "end", "flip"]))
        length = draw(st.integers(1, 64))
        if kind == "set":
            content[at : at + 1] = draw(st.binary(min_size=1, max_size=4))
        elif kind == "cut":
            del content[at : at + length]
        elif kind == "double":
            content[at:at] = content[at : at + length]
        elif kind == "flip" and content:
            content[at] ^= 1 << (length % 8)
        else:
            del content[at:]
        if not content:
            break
    return bytes(content)


def instruments(folder: Path) -> list[bytes]:
    """One small file of each binary format."""
    import h5py
    from kit.instruments import frf, lvm, sheet, tdms, workbook
    from scipy.io import savemat

    from dashpot.io.write import write_frf_uff

    tdms(folder / "a.tdms", hits=2)
    write_frf_uff(frf(n=10), folder / "a.uff")
    workbook(folder / "a.xlsx", {"One": sheet()[:12]})
    savemat(folder / "a.mat", {"time_s": np.arange(9.0), "force_N": np.arange(9.0)})
    with h5py.File(folder / "a.h5", "w") as file:
        file["time_s"] = np.arange(9.0)
    (folder / "a.lvm").write_text(lvm(segments=2))
    (folder / "a.json").write_text(
        '{"Results": [{"columns": [{"name": "Time", "unit": "s"}], "values": [[1], [2], [3]]}]}'
    )
    return [path.read_bytes() for path in sorted(folder.iterdir())]


@QUICK
@given(st.binary(max_size=400))
@example(b"\xff\xfe")
@example(b"\xff\xfe\x00")
@example(b"\n    -1\n    58\n")
@example(b"{" * 5000)
@example(b"TDSm")
@example(b"LabVIEW Measurement\n***End_of_Header***\n***End_of_Header***\nX_Value\n")
def test_any_bytes(tmp_path: Path, content: bytes) -> None:
    survives(tmp_path / "fuzz", content)


@QUICK
@given(texts())
def test_any_text(tmp_path: Path, content: bytes) -> None:
    survives(tmp_path / "fuzz.csv", content)


@QUICK
@given(wounded([dialect.content for dialect in DIALECTS]))
def test_wounded_text(tmp_path: Path, content: bytes) -> None:
    survives(tmp_path / "fuzz.csv", content)


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> list[bytes]:
    return instruments(tmp_path_factory.mktemp("good"))


@QUICK
@given(data=st.data())
def test_wounded_instruments(tmp_path: Path, good: list[bytes], data: st.DataObject) -> None:
    survives(tmp_path / "fuzz", data.draw(wounded(good)))


@QUICK
@given(st.text(max_size=300))
def test_any_calibration(tmp_path: Path, content: str) -> None:
    path = tmp_path / "a.cal"
    path.write_text(f"<FTSensor><Calibration>{content}</Calibration></FTSensor>", encoding="utf-8")
    with pytest.raises(ReadError):
        ati.read_calibration(path)


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
        ("time [s];" * 20_000 + "\n" + "1;" * 20_000 + "\n").encode(),
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
def test_long_and_strange(tmp_path: Path, content: bytes) -> None:
    survives(tmp_path / "fuzz.csv", content)


@pytest.mark.slow
@LONG
@given(data=st.data())
def test_long_fuzz(tmp_path: Path, good: list[bytes], data: st.DataObject) -> None:
    files = [*good, *(dialect.content for dialect in DIALECTS)]
    survives(tmp_path / "fuzz", data.draw(st.one_of(wounded(files), texts())))
