"""A small file that costs much is refused before it does."""

from __future__ import annotations

import json
import os
import struct
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from kit.bombs import BOMBS
from kit.instruments import sheet, xls
from kit.look_alikes import truth

from dashpot.base.errors import ReadError
from dashpot.extensions.formats.workbook_sheets import sheets
from dashpot.reading.raw_file import open_raw
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.readers.relaxation import read_relaxation

PROBE = """
import json, resource, sys
from dashpot.reading.readers.inspect import inspect_file
try:
    inspect_file(sys.argv[1])
    says = ""
except Exception as error:
    says = f"{type(error).__name__}: {error}"
status = open("/proc/self/status").read()
own = int(status.split("VmHWM:")[1].split()[0])
child = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
print(json.dumps([says, own, child]))
"""


@pytest.mark.parametrize("build", BOMBS, ids=lambda build: build.__name__)
def test_a_bomb_costs_a_gibibyte_and_half_a_minute_at_most(
    tmp_path: Path, build: Callable[[Path], None]
) -> None:
    path = tmp_path / "bomb"
    build(path)
    assert path.stat().st_size < 1 << 26
    done = subprocess.run(
        [sys.executable, "-c", PROBE, path], capture_output=True, text=True, check=True, timeout=40,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )  # fmt: skip
    message, individual, child = json.loads(done.stdout)
    assert max(individual, child) < 1 << 20
    expected = BOMBS[build]
    assert message.startswith("ReadError: bomb: ") if expected else not message
    # readers of other versions find it out later
    assert any(word in message for word in expected.split(" | "))


@pytest.mark.parametrize("excess", [0, 1])
def test_a_sheet_is_refused_where_its_blank_cells_are_too_many(tmp_path: Path, excess: int) -> None:
    place = tmp_path / "far.xls"
    xls(place, sheet(), more=number(20_000, 0))
    could_be_filled = place.stat().st_size // 4
    width = (2**16 + could_be_filled) // 20_001 + 1
    row = (2**16 + could_be_filled) // width - 1 + excess
    xls(place, sheet(), more=number(row, width - 1))
    if not excess:
        rows = sheets(open_raw(place), ReadOptions())["One"].decode().split("\n")
        assert rows[len(sheet()) : row] == [""] * (row - len(sheet()))
        assert rows[row] == "\t" * (width - 1) + "7"
        return
    with pytest.raises(ReadError, match=f"'One' reaches to row {row + 1} and column {width}, and"):
        sheets(open_raw(place), ReadOptions())


def number(row: int, column: int) -> bytes:
    return struct.pack("<HHHHHd", 0x203, 14, row, column, 0, 7.0)


# data of other files


@pytest.fixture
def external_file(tmp_path: Path) -> Path:
    path = tmp_path / "b.h5"
    with h5py.File(path, "w") as file:
        file["force_N"] = truth()[2]
    truth()[2].tofile(tmp_path / "raw")
    return path


def add_link(file: h5py.File, kind: str, other: Path) -> None:
    if kind == "link":
        file["force_N"] = h5py.ExternalLink(other.name, "/force_N")
    elif kind == "group":
        file["run"] = h5py.ExternalLink(other.name, "/")
    elif kind == "storage":
        size = truth()[2].nbytes
        place = [(str(other.parent / "raw"), 0, size)]
        file.create_dataset("force_N", (size // 8,), "f8", external=place)
    else:
        layout = h5py.VirtualLayout((len(truth()[2]),), "f8")
        layout[:] = h5py.VirtualSource(str(other), "force_N", layout.shape)
        file.create_virtual_dataset("force_N", layout)


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        ("link", "'force_N' is a link into 'b.h5': it is data of another file"),
        ("group", "'run' is a link into 'b.h5'"),
        ("storage", r"'force_N' is a virtual or external dataset: .* this file's hash does not"),
        ("virtual", r"'force_N' is a virtual or external dataset: .* save both as one"),
    ],
)
def test_data_of_another_file_is_refused(
    tmp_path: Path, external_file: Path, kind: str, message: str
) -> None:
    path = tmp_path / "a.h5"
    time, displacement, _ = truth()
    with h5py.File(path, "w") as file:
        file["time_s"], file["displacement_mm"] = time, displacement
        add_link(file, kind, external_file)
    with pytest.raises(ReadError, match=message):
        read_relaxation(path)
    if kind == "group":
        with pytest.raises(ReadError, match=message):
            read_relaxation(path, options=ReadOptions(sheet="run"))


def test_a_unit_in_another_file_is_not_looked_up(tmp_path: Path, external_file: Path) -> None:
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["force/data"] = truth()[2]
        file["force/unit"] = h5py.ExternalLink(external_file.name, "/force_N")
    with pytest.raises(ReadError, match=r"'unit' is a link into 'b\.h5'"):
        inspect_file(tmp_path / "a.h5")


def test_hdf5_data_linked_twice_is_read_once(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        for name, values in zip(("time_s", "displacement_mm", "force_N"), truth(), strict=True):
            file[f"run/{name}"] = values
        file["again"] = file["run"]
        file["soft"] = h5py.SoftLink("/run")
        file["nowhere"] = h5py.SoftLink("/none")
        file["run/self"] = file
    for group in (None, "run", "again/self/run"):
        inspection = inspect_file(path, options=ReadOptions(sheet=group))
        assert len(inspection.columns) == 3
    np.testing.assert_allclose(read_relaxation(path).force, truth()[2])
    for group in ("soft", "nowhere", "none/run", "run/time_s/more"):
        with pytest.raises(ReadError, match=f"--file-part sheet={group}: there is no such group"):
            inspect_file(path, options=ReadOptions(sheet=group))


def test_what_was_never_written_is_not_read_as_zeros(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        for name, values in zip(("time_s", "displacement_mm"), truth(), strict=False):
            file[name] = values
        file.create_dataset("force_N", (len(truth()[0]),), "f8")
    inspection = inspect_file(path)
    assert any("'force_N' was never written and was passed over" in w for w in inspection.warnings)
    assert len(inspection.columns) == 2


def test_a_count_of_channels_is_not_their_names(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file.create_dataset("data", data=np.column_stack(truth())).attrs["channels"] = 3
    assert len(inspect_file(path).columns) == 3
