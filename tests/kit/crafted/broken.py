"""Files that lack what a test needs, or hold what is none; and the word of the refusal."""

# ruff: noqa: E501 - a file of a lab stands on one line

from __future__ import annotations

import numpy as np

from kit.crafted.row import Row
from kit.look_alikes import ROWS, table, truth

TIME, DISPLACEMENT, FORCE = truth()
HEAD = "Time (s);Displacement (mm);Force (N)\n"
UNITS = {"units": {"time": "s", "displacement": "mm", "force": "N"}}


def lines(**changed: str) -> bytes:
    """The truth with some rows, by number, replaced."""
    rows = table(";").splitlines()
    for key, row in changed.items():
        rows[int(key[1:])] = row
    return (HEAD + "\n".join(rows) + "\n").encode()


def _holes() -> list[Row]:
    words = ("", "NaN", "OVER", "----", "n/a", "#NV", "LOST", "inf", "1.#QNAN", "9.91E+37")
    thinned = [
        row.rsplit(";", 1)[0] + ";" if i % 3 else row
        for i, row in enumerate(table(";").splitlines())
    ]
    return [
        *(Row(f"a hole before the ramp: {word!r}", lines(_2=f"0.20000;0.00000;{word}"), "noted", ("line 4 (force)",), without=(2,)) for word in words),
        *(Row(f"a hole in the ramp: {word!r}", lines(_10=f"1.00000;4.0;{word}"), "refused", ("line 12 lacks force", "ramp")) for word in words[:3]),
        Row("columns at different rates", (HEAD + "\n".join(thinned) + "\n").encode(), "refused", ("40 of 60 rows lack a number",)),
        Row("a row with more numbers", lines(_30="3.0;8;1.7;4.4"), "refused", ("line 32 has 4 cells where the table has 3",)),
        Row("a word where the first number of a row is", lines(_50="5.0*;8.00000;1.60000"), "noted", ("2 segments joined",), without=(50,)),
        Row("words where two numbers of three are", lines(_50="5.0;see;below"), "refused", ("line 52 has the 3 cells of the table, but 'see' in column 2",)),
        Row("a repeated time stamp", lines(_20="1.90000;8.0;1.7"), "noted", ("1 repeated time stamp left out, first at line 22",), without=(20,)),
    ]  # fmt: skip


def _hardly_files() -> list[Row]:
    return [
        Row("no bytes", b"", "refused", ("is empty (0 bytes)",)),
        Row("blank lines alone", b"\n\n  \n", "refused", ("nothing but blank lines",)),
        Row("a header alone", HEAD.encode(), "refused", ("no numbers under the header",)),
        Row("one row of numbers", HEAD.encode() + b"0;0;0\n", "refused", ("only one row of numbers", "at least 8")),
        Row("a letter", b"Dear Sir,\nplease find no data here.\n", "refused", ("no numbers under the header",)),
        Row("bytes of no text", b"\x00\x01\x02\x03" * 400, "refused", ("not a text file",)),
        Row("a picture", b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR" + b"\x00\x10" * 200, "refused", ("not a text file",)),
    ]  # fmt: skip


def _list_other_kinds() -> list[Row]:
    """Records of another kind, and summaries of one row for each cycle."""
    five = table(";", columns=(*truth(), *truth()[1:]))
    peaks = (
        "Total Cycles;Max Load (N);Min Load (N);Max Position (mm);Min Position (mm)",
        "Zyklen;Kraft Maximum (N);Kraft Minimum (N);Weg Maximum (mm);Weg Minimum (mm)",
        "Time (s);Peak Force (N);Valley Force (N);Peak Displacement (mm);Mean Force (N)",
    )
    others = {
        "Shear Rate;Viscosity;Shear Stress\n1/s;Pa.s;Pa": "is not a test: it is a flow curve",
        "Time (s);Relaxation Modulus (Pa);Temperature (°C)": "this is a relaxation modulus over time",
        "Time (s);Strain (%);Stress (MPa)": "this is stress over strain of a material",
    }
    return [
        *(Row(f"one row for each cycle: {head[:20]}", f"{head}\n{five}".encode(), "refused", ("is not a test: it is a summary with one row per cycle",)) for head in peaks),
        *(Row(f"another record: {head[:20]}", f"{head}\n{table(';')}".encode(), "refused", (message,)) for head, message in others.items()),
    ]  # fmt: skip


def _open() -> list[Row]:
    """What a file of a bench leaves open."""
    two = table(";", columns=(TIME, DISPLACEMENT, DISPLACEMENT + 1, FORCE))
    three = table(";", columns=(TIME, DISPLACEMENT, 0.1 * FORCE, 0.2 * FORCE, FORCE))
    head = ";".join(("Time [s]", "Weg [mm]", "Kraft [N]") * 2)
    both = table(";", columns=(TIME, DISPLACEMENT, FORCE, TIME + 1, DISPLACEMENT + 1, 2 * FORCE))
    swapped = table(";", columns=(TIME, FORCE, DISPLACEMENT))
    volts = table(";", columns=(TIME, DISPLACEMENT, FORCE / 2))
    coarse = table(";", columns=(np.floor(TIME), DISPLACEMENT, FORCE))
    named = {"time": "1", "displacement": "2", "force": "3", **UNITS}
    return [
        Row("a displacement without a unit", f"Time (s);Displacement;Force (N)\n{table(';')}".encode(), "asked", ("'Displacement' (displacement) has no unit", '--units "displacement=mm"'), answer={"units": {"displacement": "mm"}}),
        Row("a unit that nobody knows", f"Time (s);Displacement (parsec);Force (N)\n{table(';')}".encode(), "asked", ("'parsec' is not a known unit", '--units "displacement=mm"'), answer={"units": {"displacement": "mm"}}),
        Row("a force in grams", f"Time (s);Displacement (mm);Force (g)\n{table(';')}".encode(), "asked", ("labelled 'g'", '--units "force=N"', '"force=gf"', "22.5mV/N"), answer={"units": {"force": "N"}}),
        Row("a force in volts", f"Time (s);Displacement (mm);Force (V)\n{volts}".encode(), "asked", ("labelled 'V'", "a unit of voltage"), answer={"units": {"force": "500mV/N"}}, coarse=1e-5),
        Row("no header", table(",").encode(), "asked", ('--column time="1"', '--column displacement="2"', "--rate 1000Hz"), answer=named),
        Row("two displacements", f"Zeit [s];Traversenweg absolut [mm];Standardweg [mm];Kraft [N]\n{two}".encode(), "asked", ("'Traversenweg absolut [mm]' and 'Standardweg [mm]' could each be",), answer={"displacement": "Traversenweg absolut"}),
        Row("two specimens side by side", f"{head}\n{both}".encode(), "asked", ("2 sets of columns could each be the test (1 columns 1, 2 and 3; 2 columns 4, 5 and 6)", "--file-part segment=1"), answer={"segment": 1}),
        Row("three forces", f"t [s];z [mm];Fx [N];Fy [N];Fz [N]\n{three}".encode(), "asked", ("'Fx [N]', 'Fy [N]' and 'Fz [N]' could each be the force",), answer={"force": "Fz"}),
        Row("a displacement that relaxes under a force that is held", (HEAD + swapped).encode(), "refused", ("look swapped", "--column displacement=", "--column force=")),
        Row("a clock of whole seconds", (HEAD + coarse).encode(), "refused", ("time stamps repeat", "--rate 10Hz")),
        Row("a clock that begins again", (HEAD + 2 * table(";")).encode(), "asked", ("time falls from 5.9 s to 0 s", f"line {ROWS + 2}", "--file-part segment=1"), answer={"segment": 2}),
        Row("no clock", f"Kraft_N;Position_mm\n{table(';', columns=(FORCE, DISPLACEMENT), decimal=',')}".encode(), "refused", ("looks like time", "--rate 1000Hz")),
    ]  # fmt: skip


BROKEN = [*_holes(), *_hardly_files(), *_list_other_kinds(), *_open()]
