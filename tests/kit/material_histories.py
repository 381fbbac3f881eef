"""Files of strain and stress over time of kinds that labs write, with what each must be read as.

The strains and stresses are those of a spring of 3 MPa beside arms of 1.2 MPa (1 s) and 0.8 MPa (15 s),
by an exact integration for straight lines between samples.
"""

# ruff: noqa: E501 - a file of a lab stands on one line

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import polars as pl
import xlsxwriter
from nptdms import ChannelObject, GroupObject, TdmsWriter
from scipy.io import savemat

from kit.mdf_files import Channel, Group, mdf3, mdf4

E_INF, ARMS = 3.0, ((1.2, 1.0), (0.8, 15.0))
HEAD = ("Time [s]", "Strain [%]", "Stress [MPa]")
Arrays = tuple[np.ndarray, np.ndarray, np.ndarray]


def integrate_stress(t: np.ndarray, strain: np.ndarray) -> np.ndarray:
    """MPa, of a specimen at rest before the first sample."""
    stress = E_INF * strain
    for modulus, tau in ARMS:
        arm = np.zeros_like(strain)
        for i in range(1, len(t)):
            h = t[i] - t[i - 1]
            decay = np.exp(-h / tau)
            rise = (strain[i] - strain[i - 1]) * tau / h * (1 - decay)
            arm[i] = decay * arm[i - 1] + modulus * rise
        stress = stress + arm
    return stress


def integrate_strain(t: np.ndarray, stress: np.ndarray) -> np.ndarray:
    """Strain under a stress, MPa: the inverse of :func:`integrate_stress`."""
    moduli, taus = (np.array(values) for values in zip(*ARMS, strict=True))
    strain, arms = np.zeros_like(stress), np.zeros(len(ARMS))
    for i in range(1, len(t)):
        h = t[i] - t[i - 1]
        decay = np.exp(-h / taus)
        gain = moduli * taus / h * (1 - decay)
        strain[i] = (stress[i] - (arms * decay).sum() + gain.sum() * strain[i - 1]) / (
            E_INF + gain.sum()
        )
        arms = arms * decay + gain * (strain[i] - strain[i - 1])
    return strain


def _noise(count: int, sd: float) -> np.ndarray:
    return np.random.default_rng(count).normal(0, sd, count)


def relaxation(*corners: tuple[float, float], stop: float = 60.0, step: float = 0.1) -> Arrays:
    """Return a record whose strain is straight between corners."""
    t = np.round(np.arange(0, stop, step), 6)
    strain = np.interp(t, *zip(*corners, strict=True))
    return t, strain, integrate_stress(t, strain) + _noise(len(t), 8e-4)


def creep(*corners: tuple[float, float], stop: float = 60.0) -> Arrays:
    """Return a record whose stress is straight between corners."""
    t = np.round(np.arange(0, stop, 0.1), 6)
    stress = np.interp(t, *zip(*corners, strict=True))
    strain = integrate_strain(t, stress) + _noise(len(t), 2e-5)
    return t, strain, stress + _noise(len(t) + 1, 2e-5)[1:]


def loops(tones: tuple[float, ...], amplitudes: tuple[float, ...], mean: float = 0.1) -> Arrays:
    """Return eight harmonic cycles at each frequency and amplitude."""
    t, strain, begun = np.empty(0), np.empty(0), 0.0
    for tone in tones:
        for amplitude in amplitudes:
            here = np.arange(8 * 50) / (50 * tone)
            t = np.append(t, begun + here)
            strain = np.append(strain, amplitude * np.sin(2 * np.pi * tone * here))
            begun = float(t[-1]) + 1 / (50 * tone)
    stress = E_INF * mean + integrate_stress(t, strain) + _noise(len(t), 4e-4)
    return t, mean + strain, stress


RAMP = relaxation((0, 0), (5, 0), (7, 0.1), (99, 0.1))
STEPS = relaxation(
    (0, 0), (5, 0), (6, 0.04), (30, 0.04), (31, 0.08), (60, 0.08), (61, 0.12), (99, 0.12), stop=90
)
STAIRS = relaxation(
    (0, 0), (5, 0), (6, 0.1), (30, 0.1), (31, 0.05), (60, 0.05), (61, 0.1), (99, 0.1), stop=90
)
RECOVERY = relaxation((0, 0), (5, 0), (7, 0.1), (60, 0.1), (62, 0.02), (99, 0.02), stop=90)
CONDITIONED = relaxation(
    (0, 0), (5, 0), (6, 0.1), (7, 0), (8, 0.1), (9, 0), (20, 0), (21, 0.1), (99, 0.1), stop=90
)
CREEP = creep((0, 0), (5, 0), (6, 0.4), (99, 0.4))
CREEP_RECOVERY = creep((0, 0), (5, 0), (6, 0.4), (40, 0.4), (41, 0), (99, 0), stop=60)
CREEP_STEPS = creep((0, 0), (5, 0), (6, 0.1), (30, 0.1), (31, 0.2), (99, 0.2), stop=90)
LOOPS = loops((1.0,), (0.01, 0.03, 0.1))
TONES = loops((0.2, 1.0, 5.0), (0.02,))
DESCENDING = loops((2.0,), (0.1, 0.03, 0.01), mean=0.0)


@dataclass(frozen=True)
class History:
    """A file, the arrays that it holds, and what must come of it.

    Attributes
    ----------
    kind : str
        What it is recognised as.
    asked : str
        What its question says; empty where it is read as it is.
    answer : mapping
        Fields of the reading options with which it is read right; none of what is refused.
    sign : int
        Of the stress as stored.
    """

    name: str
    write: Callable[[Path], Path]
    kind: str
    truth: Arrays
    question: str = ""
    answer: Mapping[str, Any] = field(default_factory=dict)
    sign: tuple[int, int] = (1, 1)


def _text(head: tuple[str, ...], *columns: np.ndarray, above: str = "", comma: bool = False) -> Any:
    def write(folder: Path) -> Path:
        rows = "\n".join(";".join(f"{v:.10g}" for v in row) for row in zip(*columns, strict=True))
        path = folder / "record.csv"
        path.write_text(
            above + ";".join(head) + "\n" + (rows.replace(".", ",") if comma else rows) + "\n",
            "utf-8",
        )
        return path

    return write


def _workbook(*sheets: tuple[tuple[str, ...], tuple[str, ...], Arrays], form: str = "") -> Any:
    def write(folder: Path) -> Path:
        path = folder / "record.xlsx"
        book = xlsxwriter.Workbook(str(path))
        cells = book.add_format({"num_format": form} if form else {})
        for number, (head, units, columns) in enumerate(sheets):
            sheet = book.add_worksheet(f"S{number + 1}")
            sheet.write_row(0, 0, head)
            sheet.write_row(1, 0, units)
            for i, row in enumerate(zip(*columns, strict=True), 1 + bool(units)):
                sheet.write_number(i, 0, float(row[0]), cells)
                sheet.write_row(i, 1, [float(value) for value in row[1:]])
        book.close()
        return path

    return write


def _parquet(**columns: np.ndarray) -> Any:
    def write(folder: Path) -> Path:
        pl.DataFrame(columns).write_parquet(folder / "record.parquet")
        return folder / "record.parquet"

    return write


def _mat(**columns: Any) -> Any:
    def write(folder: Path) -> Path:
        savemat(folder / "record.mat", columns)
        return folder / "record.mat"

    return write


def _hdf5(**columns: tuple[np.ndarray, dict[str, Any]]) -> Any:
    def write(folder: Path) -> Path:
        with h5py.File(folder / "record.h5", "w") as file:
            for name, (values, attributes) in columns.items():
                file[name.replace("__", "/")] = values
                file[name.replace("__", "/")].attrs.update(attributes)
        return folder / "record.h5"

    return write


def _tdms(*channels: tuple[str, np.ndarray, str], step: float) -> Any:
    def write(folder: Path) -> Path:
        with TdmsWriter(str(folder / "record.tdms")) as file:
            file.write_segment(
                [
                    GroupObject("rec"),
                    *(
                        ChannelObject(
                            "rec", name, values, {"unit_string": unit, "wf_increment": step}
                        )
                        for name, values, unit in channels
                    ),
                ]
            )
        return folder / "record.tdms"

    return write


def _mdf(arrays: Arrays, version: int) -> Any:
    def write(folder: Path) -> Path:
        t, strain, stress = arrays
        clock = Channel("time", t, "s", kind=1 if version == 3 else 2, sync=int(version == 4))
        channels = [clock, Channel("Strain", 100 * strain, "%"), Channel("Stress", stress, "MPa")]
        content = mdf3(channels) if version == 3 else mdf4([Group(channels)], how="DZ")
        path = folder / ("record.mdf" if version == 3 else "record.mf4")
        path.write_bytes(content)
        return path

    return write


def _columns(arrays: Arrays, strain: float = 100.0, stress: float = 1.0) -> Arrays:
    return arrays[0], strain * arrays[1], stress * arrays[2]


def _format_table(arrays: Arrays, strain: float = 100.0, stress: float = 1.0) -> Any:
    return _text(HEAD, *_columns(arrays, strain, stress))


def _containers(name: str, kind: str, arrays: Arrays) -> list[History]:
    """One record in every container."""
    t, e, s = arrays
    step = float(t[1] - t[0])
    even = bool(np.ptp(np.diff(t)) < 1e-6)
    si = {"time": (t, {"units": "s"}), "strain": (e, {"units": "1"})}
    made = [
        ("text", _format_table(arrays)),
        ("text in German", _text(("Zeit [s]", "Dehnung [%]", "Spannung [N/mm²]"), t, 100 * e, s, comma=True)),
        ("workbook", _workbook((("Time", "Strain", "Stress"), ("s", "%", "kPa"), _columns(arrays, stress=1e3)))),
        ("Parquet", _parquet(time_s=t, strain_pct=100 * e, stress_MPa=s)),
        ("MAT", _mat(time_s=t, strain_percent=100 * e, stress_kPa=1e3 * s)),
        ("HDF5", _hdf5(**si, stress=(1e6 * s, {"units": "Pa"}))),
        ("HDF5 with a scale", _hdf5(**si, stress=((1e5 * s).round().astype("i4"), {"units": "MPa", "scale_factor": 1e-5}))),
        ("MDF 4", _mdf(arrays, 4)),
        ("MDF 3", _mdf(arrays, 3)),
    ]  # fmt: skip
    if even:
        made.append(("TDMS", _tdms(("Strain", 100 * e, "%"), ("Stress", s, "MPa"), step=step)))
    return [History(f"{name}, {form}", write, kind, arrays) for form, write in made]


_T, _E, _S = RAMP
_LT, _LE, _LS = LOOPS
HISTORIES: tuple[History, ...] = (
    *_containers("relaxation", "modulus", RAMP),
    *_containers("creep", "creep", CREEP),
    *_containers("loops", "cyclic", LOOPS),
    History("three holds", _format_table(STEPS), "modulus", STEPS),
    History("holds up and down", _format_table(STAIRS), "modulus", STAIRS),
    History("hold and recovery", _format_table(RECOVERY), "modulus", RECOVERY),
    History("cycles, a rest and a hold", _format_table(CONDITIONED), "modulus", CONDITIONED),
    History("creep and recovery", _format_table(CREEP_RECOVERY), "creep", CREEP_RECOVERY),
    History("creep in steps", _format_table(CREEP_STEPS), "creep", CREEP_STEPS),
    History("loops at three frequencies", _format_table(TONES), "cyclic", TONES),
    History("loops from large to small", _format_table(DESCENDING), "cyclic", DESCENDING),
    History("pressed, both below zero", _format_table(RAMP, -100, -1), "modulus", RAMP, sign=(-1, -1)),
    History("pressed, one below zero", _format_table(LOOPS, -100), "cyclic", LOOPS, sign=(-1, 1)),
    History("Greek names", _text(("t [s]", "ε [-]", "σ [MPa]"), _T, _E, _S), "modulus", RAMP),
    History("shear", _text(("t [s]", "γ [%]", "τ [kPa]"), _T, 100 * _E, 1e3 * _S), "modulus", RAMP),
    History("loops with Greek names", _text(("t [s]", "ε [-]", "σ [MPa]"), _LT, _LE, _LS), "cyclic", LOOPS),
    History("stress first", _text(("Stress [MPa]", "Time [s]", "Strain [%]"), _S, _T, 100 * _E), "modulus", RAMP),
    History("microstrain and pascal", _text(("t [s]", "strain [µm/m]", "stress [Pa]"), _T, 1e6 * _E, 1e6 * _S), "modulus", RAMP),
    History("minutes and psi", _text(("Time (min)", "Strain (in/in)", "Stress (psi)"), _T / 60, _E, _S * 145.037738), "modulus", RAMP),
    History("hours and bar", _text(("time/h", "strain/%", "stress/bar"), _T / 3600, 100 * _E, 10 * _S), "modulus", RAMP),
    History("a stop-watch in a workbook", _workbook((("Time", "Strain [%]", "Stress [MPa]"), (), (_T / 86400, 100 * _E, _S)), form="[h]:mm:ss.000"), "modulus", RAMP),
    History("a fraction under %", _format_table(RAMP, 1), "modulus", RAMP, "--units strain=1", {"units": {"strain": "1"}}),
    History("per cent under mm/mm", _text(("Time [s]", "Strain [mm/mm]", "Stress [MPa]"), *_columns(RAMP)), "modulus", RAMP, "--units strain=%", {"units": {"strain": "%"}}),
    History("kilopascal under MPa", _format_table(RAMP, stress=1e3), "modulus", RAMP, "--units stress=MPa", {"units": {"stress": "kPa"}}),
    History("loops in kilopascal under MPa", _format_table(LOOPS, stress=1e3), "cyclic", LOOPS, "--units stress=MPa", {"units": {"stress": "kPa"}}),
    History("creep in kilopascal under MPa", _format_table(CREEP, stress=1e3), "creep", CREEP, "--units stress=MPa", {"units": {"stress": "kPa"}}),
    History("no units", _text(("Time", "Strain", "Stress"), *_columns(RAMP)), "", RAMP, "has no unit", {"units": {"time": "s", "strain": "%", "stress": "MPa"}}),
    History("a hold without a clock", _text(HEAD[1:], 100 * _E, _S), "modulus", RAMP, "--rate", {"rate": 10.0}),
    History("loops without a clock", _text(HEAD[1:], 100 * _LE, _LS), "cyclic", LOOPS, "--rate", {"rate": 50.0}),
    History("a rate in the header", _text(HEAD[1:], 100 * _E, _S, above="Sampling rate: 10 Hz\n"), "modulus", RAMP, "--rate 10Hz", {"rate": 10.0}),
    History("a gain in HDF5", _hdf5(time=(_T, {"units": "s"}), strain=(_E, {"units": "1"}), stress=(10 * _S, {"units": "MPa", "gain": 10.0})), "", RAMP, "gain = 10", {"units": {"stress": "0.1MPa"}}),
    History("two strains", _text((*HEAD[:2], "Strain 2 [%]", HEAD[2]), _T, 100 * _E, 130 * _E, _S), "", RAMP, "could each be the strain", {"strain": "Strain"}),
    History("two stresses", _text((*HEAD[:2], "Engineering stress [MPa]", "True stress [MPa]"), _T, 100 * _E, _S, _S * (1 + _E)), "", RAMP, "could each be the stress", {"stress": "Engineering stress"}),
    History("two specimens", _text(("Specimen", *HEAD), np.repeat([1.0, 2.0], len(_T)), np.tile(_T, 2), np.tile(100 * _E, 2), np.append(_S, 2 * _S)), "", RAMP, "holds 2 specimens", {"segment": 1}),
    History("two sheets", _workbook((HEAD, (), _columns(RAMP)), (HEAD, (), _columns(RAMP, stress=2))), "", RAMP, "sheets 'S1', 'S2'", {"sheet": "S1"}),
    History("two groups in HDF5", _hdf5(**{f"{group}__{name}": (factor * values if name == "stress" else values, {"units": unit}) for group, factor in (("A", 1.0), ("B", 2.0)) for name, values, unit in (("time", _T, "s"), ("strain", _E, "1"), ("stress", _S, "MPa"))}), "", RAMP, "2 sets of columns", {"segment": 1}),
    History("specimens by a letter", _text(("Time [s]", "A Strain [%]", "A Stress [MPa]", "B Strain [%]", "B Stress [MPa]"), _T, 100 * _E, _S, 100 * _E, 2 * _S), "", RAMP, "2 sets of columns", {"segment": 1}),
)  # fmt: skip
