"""Files that hold several specimens, by how labs part them: each is asked about, and read alone."""

# ruff: noqa: E501 - a file of a lab stands on one line

from __future__ import annotations

import io
import tempfile
from pathlib import Path

import h5py
import numpy as np
import openpyxl
import polars as pl
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat

from kit.crafted.row import LOSS, STORAGE, SWEEP, F, Row, table
from kit.look_alikes import truth

TIME, DISPLACEMENT, FORCE = truth()
TWICE = (1.3, 1.0)
"""By how much the force of the first specimen and that of the second exceed the truth."""
HEAD = "Time [s];Displacement [mm];Force [N]"
SECOND = {"segment": 2}


def _format_labelled_table(
    first: str, second: str, head: str, *, on: float = 0.0, last: bool = False
) -> str:
    """Rows of two specimens under one head, a column of labels first or last."""
    rows = []
    for label, factor, start in zip((first, second), TWICE, (0.0, on), strict=True):
        for a, b, c in zip(TIME + start, DISPLACEMENT, factor * FORCE, strict=True):
            cells = [f"{a:.8g}", f"{b:.8g}", f"{c:.9g}"]
            rows.append(";".join([*cells, label] if last else [label, *cells]))
    return "\n".join([head, *rows]) + "\n"


def _sparse() -> str:
    """A label in the first row of each specimen alone."""
    lines = _format_labelled_table(
        "P1", "P2", "Prüfkörper;Zeit [s];Weg [mm];Kraft [N]"
    ).splitlines()
    seen: set[str] = set()
    for i, line in enumerate(lines[1:], start=1):
        label, _, rest = line.partition(";")
        lines[i] = line if label not in seen else f";{rest}"
        seen.add(label)
    return "\n".join(lines) + "\n"


def _format_interleaved_table() -> str:
    """The readings of two specimens in turn, as a logger of several stations writes them."""
    rows = ["Time [s];Sample No.;Displacement [mm];Force [N]"]
    for a, b, c in zip(TIME, DISPLACEMENT, FORCE, strict=True):
        rows += [f"{a:.8g};{n};{b:.8g};{factor * c:.9g}" for n, factor in enumerate(TWICE, 1)]
    return "\n".join(rows) + "\n"


def _blocks(between: str, first: str = "") -> str:
    """Two tables below each other."""
    text = [
        first + table(HEAD, TIME, DISPLACEMENT, factor * FORCE, form="%.9g") for factor in TWICE
    ]
    return between.join(text)


def _write_adjacent(head: str, *, clocks: bool) -> str:
    columns = [TIME]
    for i, factor in enumerate(TWICE):
        columns += [TIME] * (clocks and i > 0) + [DISPLACEMENT, factor * FORCE]
    return table(head, *columns, form="%.9g")


def _sheets() -> bytes:
    book = openpyxl.Workbook()
    book.active.title = "Summary"
    book.active.append(["Seal", "Fmax [N]"])
    for name, factor in zip(("Seal A", "Seal B"), TWICE, strict=True):
        sheet = book.create_sheet(name)
        sheet.append(["Time [s]", "Displacement [mm]", "Force [N]"])
        for row in zip(TIME, DISPLACEMENT, factor * FORCE, strict=True):
            sheet.append([float(value) for value in row])
    out = io.BytesIO()
    book.save(out)
    return out.getvalue()


def _labelled_sheet() -> bytes:
    book = openpyxl.Workbook()
    book.active.append(["Specimen", "Time [s]", "Displacement [mm]", "Force [N]"])
    for label, factor in zip(("EPDM 1", "EPDM 2"), TWICE, strict=True):
        for row in zip(TIME, DISPLACEMENT, factor * FORCE, strict=True):
            book.active.append([label, *map(float, row)])
    out = io.BytesIO()
    book.save(out)
    return out.getvalue()


def _groups() -> bytes:
    """TDMS, one group for each specimen."""
    out = io.BytesIO()
    with TdmsWriter(out) as writer:
        for name, factor in zip(("Seal 1", "Seal 2"), TWICE, strict=True):
            writer.write_segment([
                ChannelObject(name, key, values, {"unit_string": unit})
                for key, values, unit in (("Time", TIME, "s"), ("Displacement", DISPLACEMENT, "mm"), ("Force", factor * FORCE, "N"))
            ])  # fmt: skip
    return out.getvalue()


def _hdf5() -> bytes:
    out = io.BytesIO()
    with h5py.File(out, "w") as file:
        for name, factor in zip(("seal_1", "seal_2"), TWICE, strict=True):
            for key, values, unit in (
                ("time", TIME, "s"),
                ("displacement", DISPLACEMENT, "mm"),
                ("force", factor * FORCE, "N"),
            ):
                file.create_dataset(f"{name}/{key}", data=values).attrs["units"] = unit
    return out.getvalue()


def _structs() -> bytes:
    out = io.BytesIO()
    savemat(out, {
        name: {"time_s": TIME, "displacement_mm": DISPLACEMENT, "force_N": factor * FORCE}
        for name, factor in zip(("seal_1", "seal_2"), TWICE, strict=True)
    })  # fmt: skip
    return out.getvalue()


def _parquet() -> bytes:
    frame = pl.DataFrame({
        "specimen": ["A"] * len(TIME) + ["B"] * len(TIME),
        "time [s]": np.tile(TIME, 2),
        "displacement [mm]": np.tile(DISPLACEMENT, 2),
        "force [N]": np.concatenate([factor * FORCE for factor in TWICE]),
    })  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "seals.parquet"
        frame.write_parquet(path)
        return path.read_bytes()


def _sweeps() -> str:
    """A rheometer's export of two procedures, which are no repeats at other temperatures."""
    rows = ["Sample;Frequency [Hz];Storage modulus [MPa];Loss modulus [MPa]"]
    for name, factor in zip(("mix 1", "mix 2"), TWICE, strict=True):
        rows += [
            f"{name};{a:.8g};{factor * b / 1e6:.9g};{factor * c / 1e6:.9g}"
            for a, b, c in zip(F, STORAGE, LOSS, strict=True)
        ]
    return "\n".join(rows) + "\n"


_BY_COLUMN = ("holds 2 specimens by its column", "--file-part segment=1")
_ANEW = ("several specimens, or repeats", "--file-part segment=1")
_SETS = ("2 sets of columns could each be the test", "--file-part segment=1")
SPECIMENS = [
    Row("specimens: a column of numbers", _format_labelled_table("1", "2", "Specimen;Time [s];Displacement [mm];Force [N]").encode(), "asked", _BY_COLUMN, answer=SECOND),
    Row("specimens: a last column of names", _format_labelled_table("EPDM-A", "EPDM-B", f"{HEAD};Sample ID", last=True).encode(), "asked", (*_BY_COLUMN, "1 EPDM-A, 2 EPDM-B"), answer=SECOND),
    Row("specimens: a clock that goes on from one to the next", _format_labelled_table("1", "2", "Specimen No.;Time [s];Displacement [mm];Force [N]", on=100.0).encode(), "asked", _BY_COLUMN, answer=SECOND),
    Row("specimens: a label in the first row of each", _sparse().encode(), "asked", (*_BY_COLUMN, "1 P1, 2 P2"), answer=SECOND),
    Row("specimens: in turn", _format_interleaved_table().encode(), "asked", _BY_COLUMN, answer=SECOND),
    Row("specimens: blocks under their names", ("Specimen 1\n" + _blocks("\nSpecimen 2\n")).encode(), "asked", (*_ANEW, "1 Specimen 1, 2 Specimen 2"), answer=SECOND),
    Row("specimens: blocks with a blank line between", _blocks("\n").replace(f"\n\n{HEAD}", "\n").encode(), "asked", _ANEW, answer=SECOND),
    Row("specimens: blocks under the same head", _blocks("\n\n").encode(), "asked", _ANEW, answer=SECOND),
    Row("specimens: side by side on one clock", _write_adjacent("Time [s];Displacement 1 [mm];Force 1 [N];Displacement 2 [mm];Force 2 [N]", clocks=False).encode(), "asked", _SETS, answer=SECOND),
    Row("specimens: side by side with their clocks", _write_adjacent("t_1 [s];x_1 [mm];F_1 [N];t_2 [s];x_2 [mm];F_2 [N]", clocks=True).encode(), "asked", _SETS, answer=SECOND),
    Row("specimens: side by side under their names", _write_adjacent("Seal A;;;Seal B;;\nTime [s];Displacement [mm];Force [N];Time [s];Displacement [mm];Force [N]", clocks=True).encode(), "asked", _SETS, answer=SECOND),
    Row("specimens: sheets of a workbook", _sheets(), "asked", ("sheets 'Seal A', 'Seal B' could each be the test", 'sheet="Seal A"'), answer={"sheet": "Seal B"}),
    Row("specimens: a column of a workbook", _labelled_sheet(), "asked", (*_BY_COLUMN, "1 EPDM 1, 2 EPDM 2"), answer=SECOND),
    Row("specimens: groups of TDMS", _groups(), "asked", (*_ANEW, "1 Seal 1, 2 Seal 2"), answer=SECOND),
    Row("specimens: groups of HDF5", _hdf5(), "asked", _SETS, answer=SECOND),
    Row("specimens: structs of MAT", _structs(), "asked", _SETS, answer=SECOND),
    Row("specimens: a column of Parquet", _parquet(), "asked", (*_BY_COLUMN, "1 A, 2 B"), answer=SECOND),
    Row("specimens: sweeps of two mixes", _sweeps().encode(), "asked", _BY_COLUMN, SWEEP, answer=SECOND),
]  # fmt: skip
SPECIMENS += [
    Row("two load cells of which one is a copy of the other in its first half", table(f"{HEAD};Force B [N]", TIME, DISPLACEMENT, FORCE, np.where(np.arange(len(TIME)) < 30, FORCE, 1.4 * FORCE), form="%.9g").encode(), "asked", ("'Force B [N]' could each be the force",), answer={"force": "Force"}),
]  # fmt: skip
