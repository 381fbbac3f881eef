"""Layouts of labs that are no fault of the file: labels, padding, names parted otherwise."""

# ruff: noqa: E501 - a file of a lab stands on one line

from __future__ import annotations

import numpy as np

from kit.crafted.row import (
    AMPLITUDES,
    COLD,
    ISOTHERMS,
    LOSS,
    LOST,
    SOFT,
    STORAGE,
    STRAIN,
    SWEEP,
    WARMTH,
    F,
    Row,
)
from kit.crafted.treacherous import join_rows, three

_PADDING = {
    "a row of zeros": [["0"] * 3],
    "five rows of zeros": [["0.0"] * 3] * 5,
    "rows of -1": [["-1"] * 3] * 2,
    "rows of NaN": [["NaN"] * 3] * 5,
    "the last row again": [three()[-1]] * 5,
    "rows of zero time": [["0", "8", "1.6"]] * 2,
}
_OVER = {
    "names and units parted by blanks over tabs": ("Time Displacement Force\ns mm N", "\t"),
    "names without a blank over tabs": ("Time(s) Displacement(mm) Force(N)", "\t"),
    "names with underscores over tabs": ("Time_s Displacement_mm Force_N", "\t"),
    "names with brackets over tabs": ("Time (s) Displacement (mm) Force (N)", "\t"),
    "tabs over blanks": ("Time [s]\tDisplacement [mm]\tForce [N]", " "),
    "many blanks over two": ("Total Time (s)   Axial Position (mm)    Axial Force (N)", "  "),
    "a comma after each name": ("time(s), displacement(mm), force(N),", " "),
    "a comma after each name over tabs": ("time(s),\tdisplacement(mm),\tforce(N)", "\t"),
}


def rows(form: str, *columns: np.ndarray) -> str:
    return "".join(form % row + "\n" for row in zip(*columns, strict=True))


_FREQUENCY = {
    "a header of steps, and a last column without a unit": (
        "Procedure name\tfrequency sweep\n[step]\nFrequency sweep - 1\n"
        "Step time\tTemperature\tOscillation frequency\tStorage modulus\tLoss modulus\tTan(delta)\n"
        "min\t°C\tHz\tMPa\tMPa\t\n"
        + rows("0.1\t23.0\t%.9g\t%.9g\t%.9g\t%.9g", F, STORAGE / 1e6, LOSS / 1e6, LOSS / STORAGE)
    ),
    "names with units behind a stroke, decimal commas": (
        "#IDENTITY;seal\n##Temp./°C;f/Hz;E'/MPa;E''/MPa;tan d\n"
        + rows("23.0;%.9g;%.9g;%.9g;%.9g", F, STORAGE / 1e6, LOSS / 1e6, LOSS / STORAGE).replace(
            ".", ","
        )
    ),
    "amplitudes of displacement and force, stiffness and phase": (
        "Results Table 1\n,Frequency,Displacement Amplitude,Force Amplitude,Dynamic Stiffness,Phase"
        "\n,(Hz),(mm),(N),(MPa),(°)\n"
        + rows(
            "1,%.9g,0.1,60,%.9g,%.9g",
            F, np.hypot(STORAGE, LOSS) / 1e6, np.degrees(np.arctan2(LOSS, STORAGE)),
        )
    ).replace("Dynamic Stiffness", "Complex Modulus"),
    "times, and a modulus of any mode": (
        "Index\tts\tt\tFreq\tDispl. Ampl.\tForce Ampl.\tM'\tM''\n"
        "[]\t[s]\t[s]\t[Hz]\t[µm]\t[N]\t[MPa]\t[MPa]\n"
        + rows("1\t%.9g\t2\t%.9g\t10\t3\t%.9g\t%.9g", F, F, STORAGE / 1e6, LOSS / 1e6)
    ),
}  # fmt: skip

_AMPLITUDE = {
    "a percent sign first among the units": (
        "[step]\nAmplitude sweep - 1\n"
        "Oscillation strain\tFrequency\tStorage modulus\tLoss modulus\tTan(delta)\n"
        "%\tHz\tPa\tPa\t\n"
        + rows("%.9g\t10\t%.9g\t%.9g\t%.9g", 100 * STRAIN, SOFT, LOST, LOST / SOFT)
    ),
    "static beside dynamic strain": (
        "Probe: EPDM\n\n"
        "f [Hz]\tstat. Dehnung [%]\tdyn. Dehnung [%]\t|E*| [MPa]\tE' [MPa]\tE'' [MPa]\n"
        + rows(
            "10\t5\t%.9g\t%.9g\t%.9g\t%.9g",
            100 * STRAIN, np.hypot(SOFT, LOST) / 1e6, SOFT / 1e6, LOST / 1e6,
        )
    ),
}  # fmt: skip


def _labels() -> str:
    cells = (
        ["Hold", "1-Compress" if i < 15 else "1-Hold", row[0], "20.1", *row[1:]]
        for i, row in enumerate(three())
    )
    return join_rows([*cells], "SetName,Cycle,Time_S,Size_mm,Displacement_mm,Force_N", ",")


def _blocks() -> str:
    """Blocks under titles that say their temperatures."""
    return "".join(
        f"Frequency sweep at {warm:g} °C\nf [Hz];E' [MPa];E'' [MPa]\n"
        + rows("%.9g;%.9g;%.9g", F, factor * STORAGE / 1e6, factor * LOSS / 1e6)
        + "\n"
        for warm, factor in zip(WARMTH, (COLD, 1.0), strict=True)
    )


_COMMENT = "%\tfrequency [Hz]\tE' [MPa]\tE'' [MPa]\n" + rows(
    "%.9g\t%.9g\t%.9g", F, STORAGE / 1e6, LOSS / 1e6
)

LAYOUTS = [
    Row("two columns of labels", _labels().encode(), "noted", ("column 'Cycle' begins with '1-Compress' and ends with '1-Hold'",)),
    *(
        Row(f"padding: {name}", join_rows([*three(), *more]).encode(), "noted", (f"left out: {len(more)}, from line 62",))
        for name, more in _PADDING.items()
    ),
    *(Row(name, join_rows(three(), head, sign).encode()) for name, (head, sign) in _OVER.items()),
    *(Row(name, text.encode(), truth=SWEEP) for name, text in _FREQUENCY.items()),
    *(Row(name, text.encode(), truth=AMPLITUDES) for name, text in _AMPLITUDE.items()),
    Row("blocks under titles have their own temperature", _blocks().encode(), truth=ISOTHERMS),
    Row("a comment before a tab is no unit", _COMMENT.encode(), truth=SWEEP),
]  # fmt: skip
