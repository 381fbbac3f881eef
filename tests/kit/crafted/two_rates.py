"""Records whose channels were sampled at two rates, of which one is twice the other."""

from __future__ import annotations

import numpy as np

from kit.crafted.row import Row
from kit.look_alikes import truth

TIME, DISPLACEMENT, FORCE = truth()
STEP = float(TIME[1] - TIME[0])
FINE_TIME = np.linspace(TIME[0], TIME[-1], 2 * len(TIME) - 1)
FINE_FORCE = np.interp(FINE_TIME, TIME, FORCE)
_NOTES = ("sampled at different steps", "common instants of 'Displacement'")


def _lvm(columns: str, *, samples: bool = True) -> bytes:
    """LabVIEW Measurement: "No", "One" or "Multi" columns of time."""
    count, fine = len(TIME), len(FINE_TIME)
    twice = columns == "Multi"
    sign = "\t\t" if twice else "\t"
    pairs = [
        ("Channels", "2"),
        ("Samples", f"{fine}{sign}{count}"),
        ("Y_Unit_Label", f"N{sign}mm"),
        ("X_Dimension", f"Time{sign}Time"),
        ("X0", f"{TIME[0]!r}{sign}{TIME[0]!r}".replace("np.float64(", "").replace(")", "")),
        ("Delta_X", f"{STEP / 2:.17g}{sign}{STEP:.17g}"),
    ]
    names = {
        "No": "X_Value\tForce\tDisplacement\tComment",
        "One": "X_Value\tForce\tDisplacement\tComment",
        "Multi": "X_Value\tForce\tX_Value\tDisplacement\tComment",
    }
    lines = [
        "LabVIEW Measurement", "Writer_Version\t2", "Reader_Version\t2", "Separator\tTab",
        "Decimal_Separator\t.", "Multi_Headings\tNo", f"X_Columns\t{columns}",
        "***End_of_Header***", "", *(f"{key}\t{value}" for key, value in pairs),
        "***End_of_Header***", names[columns],
    ]  # fmt: skip
    for i, (t, f) in enumerate(zip(FINE_TIME, FINE_FORCE, strict=True)):
        displacement = f"{DISPLACEMENT[i]:.9g}" if i < count else ""
        clock = f"{TIME[i]:.9g}" if i < count else ""
        lines.append({
            "No": f"\t{f:.12g}\t{displacement}",
            "One": f"{t:.9g}\t{f:.12g}\t{displacement}",
            "Multi": f"{t:.9g}\t{f:.12g}\t{clock}\t{displacement}",
        }[columns])  # fmt: skip
    return ("\n".join(lines) + "\n").encode()


def _uff(*, even: bool = True) -> bytes:
    """Two time records of set 58, each with its own abscissa, by the layout of the standard."""
    pairs = (("Force", FINE_TIME, FINE_FORCE, "N"), ("Displacement", TIME, DISPLACEMENT, "mm"))
    return "".join(_set_58(*pair, even=even) for pair in pairs).encode()


def _set_58(name: str, time: np.ndarray, values: np.ndarray, unit: str, *, even: bool) -> str:
    """A real, double record over time: records 1 to 12, and six or three numbers to a line."""
    head = [
        "    -1", "    58", name, "NONE", "NONE", "NONE", "NONE",
        f"{1:5d}{0:10d}{0:5d}{0:10d} {name:10s}{1:10d}{3:4d} {'NONE':10s}{0:10d}{0:4d}",
        f"{4:10d}{len(time):10d}{int(even):10d}{time[0]:13.5e}{time[1] - time[0]:13.5e}{0.0:13.5e}",
        f"{17:10d}{0:5d}{0:5d}{0:5d} {'Time':20s} {'s':20s}",
        f"{8:10d}{0:5d}{0:5d}{0:5d} {name:20s} {unit:20s}",
        f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':20s} {'NONE':20s}",
        f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':20s} {'NONE':20s}",
    ]  # fmt: skip
    if even:
        cells = [f"{value:20.11e}" for value in values]
        rows = ["".join(cells[i : i + 4]) for i in range(0, len(cells), 4)]
    else:  # an abscissa in single, an ordinate in double precision: two pairs to a line
        cells = [f"{t:13.5e}{value:20.11e}" for t, value in zip(time, values, strict=True)]
        rows = ["".join(cells[i : i + 2]) for i in range(0, len(cells), 2)]
    return "\n".join([*head, *rows, "    -1"]) + "\n"


TWO_RATES = [
    Row("two rates: LVM without a column of time", _lvm("No"), "noted", _NOTES, coarse=1e-6),
    Row("two rates: LVM with a column of time each", _lvm("Multi"), "noted", _NOTES, coarse=1e-6),
    Row("two rates: LVM with one column of time", _lvm("One"), "noted", _NOTES, coarse=1e-6),
    Row("two rates: UFF 58", _uff(), "noted", _NOTES, coarse=1e-6),
    Row("two rates: UFF 58, each instant written", _uff(even=False), "noted", _NOTES, coarse=1e-6),
]  # fmt: skip
