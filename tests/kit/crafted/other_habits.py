"""The same ten makers by the habits of other labs, and workbooks and HDF5 files that labs make.

From the makers' manuals and from files that labs publish: older programs, other languages, other units.
"""

# ruff: noqa: E501 - a file of a lab stands on one line

from __future__ import annotations

import io
import tempfile
from pathlib import Path

import h5py
import numpy as np
import openpyxl
from nptdms import ChannelObject, TdmsWriter

from kit.crafted.row import (
    CLOCK,
    COLD,
    COMPLIANCE,
    CREPT,
    DECAY,
    ISOTHERMS,
    LOSS,
    MODULUS,
    PULLED,
    STORAGE,
    SWEEP,
    TANGENT,
    TENSION,
    WARMTH,
    F,
    Row,
    table,
)
from kit.look_alikes import truth

TIME, DISPLACEMENT, FORCE = truth()
COMPLEX = np.hypot(STORAGE, LOSS)


def _proteus_bending() -> bytes:
    """Netzsch DMA 303: a frequency that is written once in its unit, phase in place of loss."""
    head = (
        "#EXPORTTYPE:DATA ALL\n#FORMAT:NETZSCH5\n#DECIMAL:POINT\n#SEPARATOR:COMMA\n#INSTRUMENT:NETZSCH DMA 303\n"
        "#SAMPLE:EPDM\n#SEGMENT:S2/2\n\n##Time/min,Temp./°C,f/Hz,|E*|/MPa,delta/°,DAmplitude/um,FDyn/N"
    )
    columns = (
        F / 60,
        23 + 0 * F,
        F,
        COMPLEX / 1e6,
        np.degrees(np.arctan2(LOSS, STORAGE)),
        5 + 0 * F,
        0.3 + 0 * F,
    )
    return table(head, *columns, sign=",", form="%.9g").encode("cp1252")


def _universal_analysis() -> bytes:
    """TA Universal Analysis: the names stand as signals of the head, and no row has them."""
    signals = (
        "Time (min)",
        "Temperature (°C)",
        "Frequency (Hz)",
        "Storage Modulus (MPa)",
        "Loss Modulus (MPa)",
        "Tan Delta",
    )
    head = "CLOSED\t1.1\nLanguage\tENG\nRun\t4\nInstrument\t2980 DMA V1.7B\nKind\tDMA\nNsig\t6\n"
    head += (
        "\n".join(f"Sig{i}\t{name}" for i, name in enumerate(signals, 1))
        + "\nOrgFile\tseal.004\nStartOfData"
    )
    return table(
        head, F / 60, 23 + 0 * F, F, STORAGE / 1e6, LOSS / 1e6, TANGENT, sign="\t", form="%.9g"
    ).encode("utf-16")


def _rheoplus() -> bytes:
    """Anton Paar Rheoplus: a relaxation, points numbered, units in brackets below, no interval."""
    head = (
        "Data Series Information\nName:\tEPDM 70 1\nNumber of Intervals:\t1\nApplication:\tRHEOPLUS/32 V3.61\n\n"
        "Interval:\t1\nNumber of Data Points:\t40\nTime Setting:\t40 Meas. Pts.\n\n"
        "Meas. Pts.\tTime\tStrain\tShear Stress\tRelaxation Modulus\tStatus\n\t[s]\t[%]\t[Pa]\t[MPa]\t[]"
    )
    curve = 2 + DECAY**-0.1
    return table(
        head, np.array([f"{i + 1}" for i in range(len(DECAY))]), DECAY, 0.1 + 0 * DECAY, 1e3 * curve, curve,
        np.array(["M-"] * len(DECAY)), sign="\t", end="\r\n",
    ).encode("cp1252")  # fmt: skip


def _rspace_creep() -> bytes:
    """Malvern Kinexus: a compliance over the time of the action, decimal commas, names of the action."""
    head = "Action Name;Time (action)(s);Time (sequence)(s);Temperature(°C);Shear stress(Pa);Compliance (shear)(1/Pa)"
    part = slice(1, None)
    values = (
        np.array(["Creep"] * (len(CLOCK) - 1)),
        CLOCK[part],
        CLOCK[part] + 300,
        23 + 0 * CLOCK[part],
        1e5 + 0 * CLOCK[part],
        1e-6 * CREPT[part],
    )
    return table(head, *values, comma=True, form="%.9g").encode("utf-8-sig")


def _metravib() -> bytes:
    """Metravib MULTITEST: French, isotherms below each other, modulus in N/m2."""
    names = "Fréquence\tTempérature\tModule E'\tModule E''\tTan δ\tDéplacement dyn.\tForce dyn."
    units = "Hz\t°C\tN/m²\tN/m²\t-\tm\tN"
    text = "Essai : Balayage température / fréquence\r\nEchantillon : joint EPDM\r\nH = 12,5 mm\r\n\r\n"
    text += names + "\r\n" + units + "\r\n"
    for warm, factor in zip(WARMTH, (COLD, 1.0), strict=True):
        for f, a, b in zip(F, factor * STORAGE, factor * LOSS, strict=True):
            cells = (f"{v:.8g}" for v in (f, warm, a, b, b / a, 5e-6, 0.4))
            text += "\t".join(cells).replace(".", ",") + "\r\n"
    return text.encode("cp1252", "replace")


def _eplexor_german() -> bytes:
    """Gabo Eplexor 9: German words, moduli in GPa, the frequency last."""
    head = (
        "EPLEXOR 500 N\nProbe;EPDM\n\n"
        "Nr.;Temperatur;Speichermodul;Verlustmodul;tan delta;stat. Dehnung;dyn. Dehnung;Frequenz\n;°C;GPa;GPa;;%;%;Hz"
    )
    numbers = np.array([f"{i + 1}" for i in range(len(F))])
    return table(
        head,
        numbers,
        23 + 0 * F,
        STORAGE / 1e9,
        LOSS / 1e9,
        TANGENT,
        5 + 0 * F,
        0.1 + 0 * F,
        F,
        comma=True,
        form="%.9g",
    ).encode("cp1252")


def _testxpert_kilonewtons() -> bytes:
    """Zwick testXpert III: force in kN and travel in um, times with a thousandth in its unit row."""
    head = '"Prüfzeit";"Standardweg";"Standardkraft";"Kraftabschaltschwelle"\n"ms";"µm";"kN";"%"'
    return table(
        head, 1e3 * TIME, 1e3 * DISPLACEMENT, FORCE / 1e3, 80 + 0 * TIME, comma=True, form="%.9g"
    ).encode("cp1252")


def _bluehill_tension() -> bytes:
    """Instron Bluehill 2: units in brackets of a row of their own, tension by strain and stress."""
    head = (
        '"Sample Height","","25.0","mm"\n"Rate 1","","100.0","mm/min"\n\n'
        '"Extension","Load","Tensile strain","Tensile stress"\n"(mm)","(N)","(%)","(MPa)"'
    )
    return table(
        head, 25 * PULLED, 12 * PULLED**0.8, 100 * PULLED, PULLED**0.8, sign=",", quote=True
    ).encode()


def _mts_mpt() -> bytes:
    """MTS Station Manager: a line of the program first, a header of its own, kN and mm, count first."""
    head = (
        "MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A\n\nData Acquisition: Timed\t\t\tTime:\t0.1\tSec\n"
        "Station Name: Seal.cfg\nTest File Name: ramp.tst\n"
        "Axial Count\tTime\tAxial Displacement\tAxial Force\nsegments\tSec\tmm\tkN"
    )
    return table(
        head, np.arange(float(len(TIME))), TIME, DISPLACEMENT, FORCE / 1e3, sign="\t", form="%.9g"
    ).encode()


def _trapezium_lite() -> bytes:
    """Shimadzu Trapezium Lite X: a name over every pair, units quoted with blanks, minutes."""
    head = '"Method","seal hold.xmas"\n"Name","1 _ 1","1 _ 1","1 _ 1"\n"","Time","Force","Stroke"\n"","min","mN"," mm "'
    return table(
        head,
        np.array([""] * len(TIME)),
        TIME / 60,
        1e3 * FORCE,
        DISPLACEMENT,
        sign=",",
        form="%.9g",
    ).encode()


def _encode_workbook(sheet_of: openpyxl.Workbook) -> bytes:
    content = io.BytesIO()
    sheet_of.save(content)
    return content.getvalue()


def _merged_heads() -> bytes:
    """A name over two merged columns, the names below it, and a row of units."""
    made = openpyxl.Workbook()
    sheet = made.active
    assert sheet is not None
    sheet.append(["Customer", "seals", None])
    sheet.append([])
    sheet.append(["Clock", "Channels", None])
    sheet.merge_cells("B3:C3")
    sheet.append(["Time", "Displacement", "Force"])
    sheet.append(["s", "mm", "N"])
    for row in zip(TIME.tolist(), DISPLACEMENT.tolist(), FORCE.tolist(), strict=True):
        sheet.append(list(row))
    return _encode_workbook(made)


def _merged_down() -> bytes:
    """Names merged over two rows, of which the second has units only where they are no SI units."""
    made = openpyxl.Workbook()
    sheet = made.active
    assert sheet is not None
    sheet.title = "Messung"
    sheet.append(["Zeit [s]", "Weg", "Kraft"])
    sheet.append([None, "[cm]", "[mN]"])
    sheet.merge_cells("A1:A2")
    for row in zip(
        TIME.tolist(), (DISPLACEMENT / 10).tolist(), (1e3 * FORCE).tolist(), strict=True
    ):
        sheet.append(list(row))
    sheet.append(["Mittelwert", None, float(FORCE.mean())])
    return _encode_workbook(made)


def _hdf5(names: tuple[str, str, str], word: str, units: tuple[str, str, str]) -> bytes:
    """Channels of a group, each with its unit in an attribute."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "made.h5"
        with h5py.File(path, "w", track_order=True) as file:
            run = file.create_group("Run 1")
            run.attrs["operator"] = "A"
            for name, unit, values in zip(
                names, units, (TIME, DISPLACEMENT / 1e3, FORCE / 1e3), strict=True
            ):
                run.create_dataset(name, data=values).attrs[word] = unit
        return path.read_bytes()


def _hdf5_table(*, fields: bool) -> bytes:
    """A table whose units stand in a list, by fields or by columns with a list of names."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "made.h5"
        with h5py.File(path, "w") as file:
            if fields:
                rows = np.zeros(len(TIME), [("time", "f8"), ("position", "f8"), ("load", "f8")])
                rows["time"], rows["position"], rows["load"] = TIME, DISPLACEMENT / 10, FORCE / 1e3
                file.create_dataset("run", data=rows).attrs["units"] = ["s", "cm", "kN"]
            else:
                made = file.create_dataset(
                    "data", data=np.column_stack((TIME, DISPLACEMENT, FORCE / 1e3))
                )
                made.attrs["names"] = ["Time", "Displacement", "Force"]
                made.attrs["units"] = ["s", "mm", "kN"]
        return path.read_bytes()


def _tdms(along: dict[str, object]) -> bytes:
    """Waveforms over what their properties say."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "made.tdms"
        with TdmsWriter(str(path)) as file:
            item = (("Weg", 1e3 * DISPLACEMENT, "µm"), ("Kraft", FORCE / 1e3, "kN"))
            file.write_segment(
                [
                    ChannelObject("Run", name, values, {"unit_string": unit, **along})
                    for name, values, unit in item
                ]
            )
        return path.read_bytes()


OTHER_HABITS = [
    Row("Proteus: a modulus and its phase", _proteus_bending(), truth=SWEEP),
    Row("Universal Analysis: signals of the head", _universal_analysis(), truth=SWEEP),
    Row("Rheoplus: a relaxation", _rheoplus(), truth=MODULUS),
    Row("rSpace: a creep as compliance", _rspace_creep(), truth=COMPLIANCE),
    Row("MULTITEST: French isotherms", _metravib(), truth=ISOTHERMS),
    Row("Eplexor: German, in GPa", _eplexor_german(), truth=SWEEP),
    Row("testXpert: milliseconds, micrometres and kilonewtons", _testxpert_kilonewtons()),
    Row("Bluehill 2: a tension test", _bluehill_tension(), truth=TENSION),
    Row("Station Manager: its program in the first line", _mts_mpt()),
    Row("Trapezium Lite: minutes and millinewtons", _trapezium_lite()),
    Row("a workbook with a name over two columns", _merged_heads()),
    Row("a workbook with names over two rows", _merged_down(), "noted", ("Mittelwert",)),
    Row(
        "HDF5 with units in attributes",
        _hdf5(("time", "position", "load"), "units", ("s", "m", "kN")),
    ),
    Row("HDF5 with unit strings", _hdf5(("Zeit", "Weg", "Kraft"), "unit_string", ("s", "m", "kN"))),
    Row("HDF5: fields, and their units in a list", _hdf5_table(fields=True)),
    Row("HDF5: names and units in two lists", _hdf5_table(fields=False)),
    Row(
        "TDMS: waveforms over milliseconds", _tdms({"wf_increment": 100.0, "wf_xunit_string": "ms"})
    ),
    Row(
        "TDMS: waveforms over frequency",
        _tdms({"wf_increment": 0.1, "wf_xunit_string": "Hz"}),
        "refused",
        ("looks like time",),
    ),
]
"""A maker or a lab, and what it saves."""
