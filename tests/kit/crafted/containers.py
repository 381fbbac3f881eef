"""Records in containers by the habits of other labs: names, units, marks, clocks and layouts."""

# ruff: noqa: E501 - a file of a lab stands on one line

from __future__ import annotations

import datetime as dt
import io
import re
import zipfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import h5py
import numpy as np
import openpyxl
import polars as pl
from nptdms import ChannelObject, GroupObject, RootObject, TdmsWriter
from scipy.io import savemat

from kit.crafted.row import LOSS, STORAGE, SWEEP, TANGENT, F, Row
from kit.instruments import ods, ods_rows
from kit.look_alikes import truth
from kit.mdf_files import Channel, Group, mdf4

TIME, DISPLACEMENT, FORCE = truth()
STEP = 0.1
LATE = 2
"""A row before the ramp, where a sample may be missing."""
Columns = Mapping[str, np.ndarray]


def tdms(
    channels: Sequence[tuple[str, np.ndarray, dict[str, Any]]], *, group: str = "Data",
    root: dict[str, Any] | None = None, of_group: dict[str, Any] | None = None,
) -> bytes:  # fmt: skip
    """TDMS of one group: name, values and properties of each channel."""
    out = io.BytesIO()
    with TdmsWriter(out) as writer:
        parts = [ChannelObject(group, name, values, stated) for name, values, stated in channels]
        writer.write_segment([RootObject(root or {}), GroupObject(group, of_group or {}), *parts])
    return out.getvalue()


def waves(
    names: tuple[str, str],
    units: tuple[str, str],
    factors: tuple[float, float] = (1.0, 1.0),
    **more: Any,
) -> list[tuple[str, np.ndarray, dict[str, Any]]]:
    """Displacement and force as waveforms."""
    return [
        (name, values * factor, {"wf_increment": STEP, "wf_start_offset": 0.0, "wf_samples": len(TIME), "unit_string": unit, **more})
        for name, values, factor, unit in zip(names, (DISPLACEMENT, FORCE), factors, units, strict=True)
    ]  # fmt: skip


def hdf5(fill: Callable[[h5py.File], None]) -> bytes:
    out = io.BytesIO()
    with h5py.File(out, "w", track_order=True) as file:
        fill(file)
    return out.getvalue()


def datasets(
    columns: Mapping[str, tuple[np.ndarray, dict[str, Any]]],
    where: str = "",
    of_all: dict[str, Any] | None = None,
) -> bytes:
    """HDF5 of one dataset for each channel, with its attributes."""

    def fill(file: h5py.File) -> None:
        group = file.require_group(where) if where else file
        group.attrs.update(of_all or {})
        for name, (values, stated) in columns.items():
            group.create_dataset(name, data=values).attrs.update(stated)

    return hdf5(fill)


def mat(variables: Mapping[str, Any], **how: Any) -> bytes:
    out = io.BytesIO()
    savemat(out, dict(variables), **how)
    return out.getvalue()


def sheet(
    rows: Sequence[Sequence[Any]],
    *,
    before: Callable[[Any], None] | None = None,
    name: str = "Data",
) -> bytes:
    book = openpyxl.Workbook()
    page = book.active
    page.title = name
    for row in rows:
        page.append(list(row))
    if before:
        before(book)
    out = io.BytesIO()
    book.save(out)
    return out.getvalue()


def rows_of(*columns: np.ndarray) -> list[list[Any]]:
    return [list(map(float, row)) for row in zip(*columns, strict=True)]


def patch_workbook(
    workbook: bytes, pattern: bytes, by: Callable[[re.Match[bytes]], bytes]
) -> bytes:
    """A workbook whose sheet's XML was changed: results of formulas, errors."""
    out = io.BytesIO()
    with (
        zipfile.ZipFile(io.BytesIO(workbook)) as old,
        zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as new,
    ):
        for part in old.namelist():
            text = old.read(part)
            new.writestr(part, re.sub(pattern, by, text) if part.endswith("sheet1.xml") else text)
    return out.getvalue()


def frame(columns: Mapping[str, Any], form: str = "parquet", **how: Any) -> bytes:
    out = io.BytesIO()
    getattr(pl.DataFrame(dict(columns)), f"write_{form}")(out, **how)
    return out.getvalue()


def opendocument(rows: list[list[object]]) -> bytes:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "test.ods"
        ods(path, ods_rows(rows))
        return path.read_bytes()


def mdf(*channels: Channel, **how: Any) -> bytes:
    clock = Channel("time", TIME, "s", kind=2, sync=1)
    return mdf4([Group([clock, *channels])], **how)


def lvm(
    head: Sequence[str],
    names: str,
    rows: Sequence[str],
    *,
    sign: str = "\t",
    comma: bool = False,
    top: Sequence[str] = (),
) -> bytes:
    """LabVIEW Measurement of one segment."""
    lines = [
        "LabVIEW Measurement", sign.join(("Writer_Version", "0.92")), sign.join(("Reader_Version", "1")),
        sign.join(("Separator", "Comma" if sign == "," else "Tab")), *([] if sign == "," else [f"Decimal_Separator\t{',' if comma else '.'}"]),
        *top, "***End_of_Header***", "", *head, "***End_of_Header***", names, *rows,
    ]  # fmt: skip
    return ("\r\n".join(lines) + "\r\n").encode("cp1252")


def insert_mark(values: np.ndarray, mark: float) -> np.ndarray:
    values = values.copy()
    values[LATE] = mark
    return values


def formulas(retained: float | None) -> bytes:
    """A force that is a formula of a voltage, with the results that the file keeps, or none."""
    body = [
        [t, x, f"=D{i}*10", f / 10]
        for i, (t, x, f) in enumerate(rows_of(TIME, DISPLACEMENT, FORCE), start=2)
    ]
    made = sheet([["Time [s]", "Displacement [mm]", "Force [N]", "Signal [V]"], *body])
    if retained is None:
        return made
    return patch_workbook(
        made, rb'(<c r="C(\d+)"[^>]*><f>[^<]*</f>)<v\s*/?>(?:</v>)?',
        lambda m: m[1] + f"<v>{retained * float(FORCE[int(m[2]) - 2])!r}</v>".encode(),
    )  # fmt: skip


def errors(word: str) -> bytes:
    """Two cells before the ramp that hold an error."""
    made = sheet(
        [["Time [s]", "Displacement [mm]", "Force [N]"], *rows_of(TIME, DISPLACEMENT, FORCE)]
    )
    return patch_workbook(
        made,
        rb'<c r="(C(?:4|5))"[^>]*><v>[^<]*</v></c>',
        lambda m: b'<c r="' + m[1] + b'" t="e"><v>' + word.encode() + b"</v></c>",
    )


NUL = {"unit_string": ""}
_T = {
    "time": (TIME, {"units": "s"}),
    "displacement": (DISPLACEMENT, {"units": "mm"}),
    "force": (FORCE, {"units": "N"}),
}
_PLAIN = ["Time [s]", "Displacement [mm]", "Force [N]"]
_START = dt.datetime(2026, 3, 4, 13, 59, 58)
_N = len(TIME)

CONTAINERS: list[Row] = [
    # TDMS
    Row("TDMS: German names, kN and µm", tdms(waves(("Weg", "Kraft"), ("µm", "kN"), (1e3, 1e-3)))),
    Row("TDMS: units in brackets of the names, none stated", tdms(waves(("Traverse [mm]", "Kraftaufnehmer [N]"), ("", "")))),
    Row("TDMS: a clock of its own beside waveforms without one", tdms([("Zeit", TIME, {"unit_string": "s"}), ("Weg", DISPLACEMENT, {"unit_string": "mm"}), ("Kraft", FORCE, {"unit_string": "N"})])),
    Row("TDMS: milliseconds as the clock", tdms([("t_ms", 1e3 * TIME, {"unit_string": "ms"}), ("s", DISPLACEMENT, {"unit_string": "mm"}), ("F", FORCE, {"unit_string": "N"})])),
    Row("TDMS: single precision", tdms([(n, v.astype(np.float32), p) for n, v, p in waves(("Displacement", "Force"), ("mm", "N"))]), coarse=1e-6),
    Row("TDMS: a comment channel of text beside", tdms([*waves(("Displacement", "Force"), ("mm", "N")), ("Remark", ["ok"] * _N, {})]), "right"),
    Row("TDMS: a cRIO writes its units as description", tdms(waves(("Displacement", "Force"), ("", ""), description="N")), "asked", ("unit",), answer={"units": {"displacement": "mm", "force": "N"}}),
    Row("TDMS: a gain of the amplifier", tdms(waves(("Displacement", "Force"), ("mm", "N"), gain=10.0)), "asked", ("gain",), answer={"units": {"displacement": "mm", "force": "N"}}),
    # HDF5
    Row("HDF5: pandas fixed-like blocks with names", hdf5(lambda f: f.create_dataset("values", data=np.column_stack([TIME, DISPLACEMENT, FORCE])).attrs.update({"columns": ["time [s]", "displacement [mm]", "force [N]"]}))),
    Row("HDF5: a compound of a logger", hdf5(lambda f: f.create_dataset("log", data=np.array(list(zip(TIME, DISPLACEMENT, FORCE, strict=True)), dtype=[("time_s", "f8"), ("displacement_mm", "f8"), ("force_N", "f8")])))),
    Row("HDF5: nested deep, units as bytes", datasets({k: (v, {"units": np.bytes_(a["units"])}) for k, (v, a) in _T.items()}, "run/1/raw")),
    Row("HDF5: NeXus, a unit in capital letters", datasets({"time": (TIME, {"units": "S"}), "displacement": (DISPLACEMENT, {"units": "MM"}), "force": (FORCE, {"units": "N"})}, "entry/data"), "right"),
    Row("HDF5: netCDF seconds since an instant", datasets({"time": (TIME, {"units": "seconds since 2026-03-04 10:00:00"}), **{k: _T[k] for k in ("displacement", "force")}})),
    Row("HDF5: integers packed by the CF conventions", datasets({"time": _T["time"], "displacement": _T["displacement"], "force": (np.round(FORCE * 1e5).astype("i4"), {"units": "N", "scale_factor": 1e-5})}), "noted", ("scale_factor",)),
    Row("HDF5: a fill value before the ramp", datasets({**_T, "force": (insert_mark(FORCE, -9999.0), {"units": "N", "_FillValue": -9999.0})}), "noted", ("fill value",), without=(LATE,)),
    Row("HDF5: a valid range passed over by one sample", datasets({**_T, "force": (insert_mark(FORCE, 740.0), {"units": "N", "valid_range": [-5.0, 50.0]})}), "noted", ("valid range",), without=(LATE,)),
    Row("HDF5: a sensitivity as an attribute", datasets({**_T, "force": (FORCE, {"units": "N", "sensitivity": 2.5})}), "asked", ("sensitivity",), answer={"units": {"force": "N"}}),
    Row("HDF5: a calibration written as a formula", datasets({**_T, "force": (FORCE, {"units": "N", "calibration": "F = 10 * U"})}), "asked", ("F = 10 * U",), answer={"units": {"force": "N"}}),
    Row("HDF5: a mask of valid rows", datasets({**_T, "force_valid": (np.arange(_N) != LATE, {})}), "noted", ("'force_valid' marks 1 of",)),
    Row("Parquet: a column of overloads", frame({"time [s]": TIME, "displacement [mm]": DISPLACEMENT, "force [N]": FORCE, "overload": np.arange(_N) == LATE}), "noted", ("'overload' marks 1 of",)),
    Row("CSV: a column of valid rows", ("time [s];displacement [mm];force [N];valid\n" + "".join(f"{t:.6g};{x:.8g};{f:.8g};{int(i != LATE)}\n" for i, (t, x, f) in enumerate(rows_of(TIME, DISPLACEMENT, FORCE)))).encode(), "noted", ("'valid' marks 1 of",), coarse=1e-5),
    Row("CSV: a column of which all rows are valid", ("time [s];displacement [mm];force [N];valid\n" + "".join(f"{t:.6g};{x:.8g};{f:.8g};1\n" for t, x, f in rows_of(TIME, DISPLACEMENT, FORCE))).encode(), coarse=1e-5),
    Row("HDF5: row vectors", datasets({k: (v[None, :], a) for k, (v, a) in _T.items()})),
    Row("HDF5: a group of settings beside", hdf5(lambda f: [f.create_dataset(f"data/{k}", data=v).attrs.update(a) for k, (v, a) in _T.items()] + [f.create_dataset("settings/pid", data=np.arange(3.0)), f.create_dataset("settings/limit", data=12.0)])),
    # MAT
    Row("MAT: version 4", mat({"time_s": TIME, "displacement_mm": DISPLACEMENT, "force_N": FORCE}, format="4")),
    Row("MAT: units behind underscores", mat({"time_s": TIME, "displacement_mm": DISPLACEMENT, "force_N": FORCE})),
    Row("MAT: a struct of a test with fields", mat({"test": {"time": {"data": TIME, "units": "s"}, "displacement": {"data": DISPLACEMENT, "units": "mm"}, "force": {"data": FORCE, "units": "N"}}})),
    Row("MAT: fill value and valid range", mat({"time": {"data": TIME, "units": "s"}, "displacement": {"data": DISPLACEMENT, "units": "mm"}, "force": {"data": insert_mark(FORCE, -999.0), "units": "N", "FillValue": -999.0, "valid_range": [-5.0, 50.0]}}), "noted", ("as fill values",), without=(LATE,)),
    Row("MAT: a valid range alone", mat({"time": {"data": TIME, "units": "s"}, "displacement": {"data": DISPLACEMENT, "units": "mm"}, "force": {"data": insert_mark(FORCE, 740.0), "units": "N", "valid_range": [-5.0, 50.0]}}), "noted", ("outside the valid range",), without=(LATE,)),
    Row("MAT: compressed, row vectors", mat({"time_s": TIME[None], "displacement_mm": DISPLACEMENT[None], "force_N": FORCE[None]}, do_compression=True)),
    Row("MAT: short names without units", mat({"t": TIME, "x": DISPLACEMENT, "F": FORCE}), "asked", ("unit",), answer={"units": {"time": "s", "displacement": "mm", "force": "N"}}),
    Row("MAT: a calibration factor beside the channel", mat({"time_s": TIME, "displacement_mm": DISPLACEMENT, "force_N": FORCE, "force_N_gain": 2.0}), "asked", ("gain",), answer={"units": {"force": "N"}}),
    Row("MAT: one matrix and its names as text", mat({"data": np.column_stack([TIME, DISPLACEMENT, FORCE]), "names": np.array(["time", "displacement", "force"], dtype=object)}), "asked", ("data 1",), answer={"time": "data 1", "displacement": "data 2", "force": "data 3", "units": {"time": "s", "displacement": "mm", "force": "N"}}),
    # workbooks
    Row("XLSX: a title, a blank row, two rows of head", sheet([["Relaxation of a door seal"], [], ["Time", "Displacement", "Force"], ["s", "mm", "N"], *rows_of(TIME, DISPLACEMENT, FORCE)])),
    Row("XLSX: the table begins at D7", sheet([[]] * 6 + [[None] * 3 + r for r in (_PLAIN, *rows_of(TIME, DISPLACEMENT, FORCE))])),
    Row("XLSX: a summary to the right of the table", sheet([[*_PLAIN, None, "Fmax"], [*rows_of(TIME, DISPLACEMENT, FORCE)[0], None, float(FORCE.max())], *rows_of(TIME, DISPLACEMENT, FORCE)[1:]])),
    Row("XLSX: formulas with their results", formulas(1.0)),
    Row("XLSX: formulas with results of another factor", formulas(1.3), "noted", ("stored result does not",), coarse=1.0),
    Row("XLSX: formulas that were never calculated", formulas(None), "refused", ("formulas", "without a result")),
    Row("XLSX: #REF! in two cells", errors("#REF!"), "noted", ("2 cells hold the error #REF!",), without=(2, 3)),
    Row("XLSX: #DIV/0! in two cells", errors("#DIV/0!"), "noted", ("#DIV/0!",), without=(2, 3)),
    Row("XLSX: clock as dates with milliseconds", sheet([["Time", *_PLAIN[1:]], *[[_START + dt.timedelta(milliseconds=round(1e3 * t)), x, f] for t, x, f in rows_of(TIME, DISPLACEMENT, FORCE)]])),
    Row("XLSX: numbers stored as text", sheet([_PLAIN, *[[f"{c:.6g}" for c in row] for row in rows_of(TIME, DISPLACEMENT, FORCE)]]), coarse=1e-5),
    Row("XLSX: newtons with the unit in the cells", sheet([["Time [s]", "Displacement [mm]", "Force"], *[[t, x, f"{f:.6g} N"] for t, x, f in rows_of(TIME, DISPLACEMENT, FORCE)]]), "refused", ("N",)),
    Row("ODS: a plain table", opendocument([list(_PLAIN), *rows_of(TIME, DISPLACEMENT, FORCE)])),
    Row("ODS: errors as text before the ramp", opendocument([list(_PLAIN), *[[t, x, "#DIV/0!" if i == LATE else f] for i, (t, x, f) in enumerate(rows_of(TIME, DISPLACEMENT, FORCE))]]), "noted", ("lack",), without=(LATE,)),
    Row("XLSX: a sweep with its ratio", sheet([["f [Hz]", "E' [MPa]", "tan d [-]"], *rows_of(F, STORAGE / 1e6, TANGENT)]), truth=SWEEP),
    # Parquet, Arrow
    Row("Parquet: units behind the names", frame({"time_s": TIME, "displacement_mm": DISPLACEMENT, "force_N": FORCE})),
    Row("Parquet: a clock of instants", frame({"timestamp": [_START + dt.timedelta(milliseconds=round(1e3 * t)) for t in TIME], "displacement [mm]": DISPLACEMENT, "force [N]": FORCE})),
    Row("Parquet: integers of micrometres", frame({"time [s]": TIME, "displacement [µm]": np.round(1e3 * DISPLACEMENT).astype(int), "force [N]": FORCE})),
    Row("Parquet: null before the ramp", frame({"time [s]": TIME, "displacement [mm]": DISPLACEMENT, "force [N]": [None if i == LATE else float(f) for i, f in enumerate(FORCE)]}), "noted", ("lack",), without=(LATE,)),
    Row("Parquet: a categorical of one specimen", frame({"specimen": pl.Series(["A"] * _N, dtype=pl.Categorical), "time [s]": TIME, "displacement [mm]": DISPLACEMENT, "force [N]": FORCE})),
    Row("Arrow: a file with durations", frame({"time": [dt.timedelta(milliseconds=round(1e3 * t)) for t in TIME], "displacement [mm]": DISPLACEMENT, "force [N]": FORCE}, "ipc")),
    Row("Arrow: a stream", frame({"time [s]": TIME, "displacement [mm]": DISPLACEMENT, "force [N]": FORCE}, "ipc_stream")),
    Row("Parquet: no units", frame({"time": TIME, "displacement": DISPLACEMENT, "force": FORCE}), "asked", ("unit",), answer={"units": {"time": "s", "displacement": "mm", "force": "N"}}),
    Row("Parquet: a sweep by size and angle", frame({"frequency [Hz]": F, "|E*| [MPa]": np.hypot(STORAGE, LOSS) / 1e6, "delta [deg]": np.degrees(np.arctan2(LOSS, STORAGE))}), truth=SWEEP),
    # MDF
    Row("MDF 4: German names and a linear conversion", mdf(Channel("Weg", np.round(1e3 * DISPLACEMENT).astype("i4"), "mm", dtype="<i4", conversion=(1, (0.0, 1e-3), ())), Channel("Kraft", FORCE, "N"))),
    Row("MDF 4: µm and daN", mdf(Channel("Displacement", 1e3 * DISPLACEMENT, "µm"), Channel("Force", FORCE / 10, "daN"))),
    Row("MDF 4: an invalid sample before the ramp", mdf(Channel("Displacement", DISPLACEMENT, "mm"), Channel("Force", insert_mark(FORCE, 40.0), "N", invalid=(np.arange(_N) == LATE).astype("u1"), flags=2)), "noted", ("lack",), without=(LATE,)),
    Row("MDF 4: no units", mdf(Channel("Displacement", DISPLACEMENT), Channel("Force", FORCE)), "asked", ("unit",), answer={"units": {"displacement": "mm", "force": "N"}}),
    Row("MDF 4: single precision, lower case", mdf(Channel("displacement", DISPLACEMENT, "mm", dtype="<f4"), Channel("force", FORCE, "N", dtype="<f4")), coarse=1e-6),
    # LVM
    Row("LVM: commas as separators", lvm(["Channels,2", f"Samples,{_N},{_N}", "Y_Unit_Label,mm,N", "X0,0,0", "Delta_X,0.1,0.1"], "X_Value,Displacement,Force,Comment", [f"{t:.6f},{x:.6f},{f:.6f}" for t, x, f in rows_of(TIME, DISPLACEMENT, FORCE)], sign=","), coarse=1e-5),
    Row("LVM: decimal commas", lvm(["Channels\t2", f"Samples\t{_N}\t{_N}", "Y_Unit_Label\tmm\tN", "X0\t0,0\t0,0", "Delta_X\t0,1\t0,1"], "X_Value\tWeg\tKraft\tComment", [f"{t:.6f}\t{x:.6f}\t{f:.6f}".replace(".", ",") for t, x, f in rows_of(TIME, DISPLACEMENT, FORCE)], comma=True), coarse=1e-5),
    Row("LVM: a remark in a row", lvm(["Channels\t2", f"Samples\t{_N}\t{_N}", "Y_Unit_Label\tmm\tN", "X0\t0\t0", "Delta_X\t0.1\t0.1"], "X_Value\tDisplacement\tForce\tComment", [f"{t:.6f}\t{x:.6f}\t{f:.6f}{chr(9) + 'pause' if i == 30 else ''}" for i, (t, x, f) in enumerate(rows_of(TIME, DISPLACEMENT, FORCE))]), coarse=1e-5),
    Row("LVM: no units", lvm(["Channels\t2", f"Samples\t{_N}\t{_N}", "X0\t0\t0", "Delta_X\t0.1\t0.1"], "X_Value\tDisplacement\tForce\tComment", [f"{t:.6f}\t{x:.6f}\t{f:.6f}" for t, x, f in rows_of(TIME, DISPLACEMENT, FORCE)]), "asked", ("unit",), answer={"units": {"displacement": "mm", "force": "N"}}, coarse=1e-5),
]  # fmt: skip
