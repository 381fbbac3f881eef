"""A door and the line of its seal, simulated."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.units import convert_to_unit
from dashpot.base.version import byline
from dashpot.extensions.systems.door.free_plate import free_plate
from dashpot.registry import Example


def _write_line() -> str:
    """A quarter of a door: x, y, z, mm."""
    angle = np.linspace(0.0, np.pi / 2, 13)
    rows = (f"{400 * np.cos(a):.3f},{400 * np.sin(a):.3f},0" for a in angle)
    return "\n".join([f"# {byline('simulated seal line')}", "x,y,z", *rows, ""])


_HINGES, _LATCH, _MIRROR = ((0.0, 0.3, 0.0), (0.0, 0.9, 0.0)), (1.1, 0.6, 0.0), (0.15, 1.05, 0.0)


def _make_seal_line() -> tuple[FloatArray, FloatArray]:
    """A seal line 20 mm within a door, its corners round, m; and its gap, 12.5 to 15 mm."""
    radius, low, high = 0.1, np.array([0.02, 0.02]), np.array([1.08, 1.18])
    points: list[FloatArray] = []
    for corner, start in ((0, -180), (1, -90), (2, 0), (3, 90)):
        middle = np.where([corner in {1, 2}, corner in {2, 3}], high - radius, low + radius)
        angle = np.radians(start + np.linspace(0, 90, 7))
        arc = middle + radius * np.stack((np.cos(angle), np.sin(angle)), axis=1)
        straight_points = np.linspace(points[-1], arc[0], 8)[1:-1] if points else np.empty((0, 2))
        points += [*straight_points, *arc]
    points += [*np.linspace(points[-1], points[0], 8)[1:]]
    positions = np.column_stack((points, np.zeros(len(points))))
    gap = 13.75e-3 + 1.25e-3 * np.sin(2 * np.pi * np.arange(len(positions)) / (len(positions) - 1))
    return positions, gap


def _write_door_line() -> str:
    positions, gap = _make_seal_line()
    rows = (
        ",".join(f"{convert_to_unit(v, 'mm'):.3f}" for v in (*p, g))
        for p, g in zip(positions, gap, strict=True)
    )
    header = [f"# {byline('simulated seal line')}", "# simulated", "x [mm],y [mm],z [mm],gap [mm]"]
    return "\n".join([*header, *rows, ""])


def _make_door_modes() -> str:
    """Return the modes of a plate of 25 kg whose first elastic mode lies at 64 Hz."""
    positions = np.concatenate((_make_seal_line()[0][:-1], (*_HINGES, _LATCH, _MIRROR)))
    modes = free_plate(positions, width=1.1, height=1.2, mass=25.0, rigidity=3e4, elastic=24)
    rows = (
        ",".join(
            f"{v:.7g}"
            for v in (r + 1, f, *convert_to_unit(positions[p], "mm"), modes.shapes[r, p, 2])
        )
        for r, f in enumerate(modes.frequency)
        for p in range(len(positions))
    )
    header = [f"# {byline('simulated modes')}", "# simulated, shapes of a modal mass of 1 kg"]
    return "\n".join([*header, "mode,frequency [Hz],x [mm],y [mm],z [mm],uz", *rows, ""])


def _write_door() -> str:
    return f"""\
# {byline("simulated door")}
# dashpot fit seal_8mm.csv -o fit.json writes the fit of its seal

[door]
mass = "25kg"
width = "1.1m"              # along x, and
height = "1.2m"             # along y: inertia of an even plate; or inertia = "3, 2.5, 5.5 kg*m^2"
centre = "550, 600, 0 mm"   # of gravity

[[hinge]]
name = "lower hinge"
at = "0, 300, 0 mm"
stiffness = "5kN/mm"        # along x, y and z alike; or "5, 8, 5 kN/mm"
damping = "300N*s/m"

[[hinge]]
name = "upper hinge"
at = "0, 900, 0 mm"
stiffness = "5kN/mm"
damping = "300N*s/m"

[latch]
at = "1100, 600, 0 mm"
stiffness = "1kN/mm"
damping = "100N*s/m"

[seal]
fit = "fit.json"
length = "100mm"            # of the tested specimen
points = "door_line.csv"    # x, y, z and the gap there
height = "20mm"             # of the free seal
normal = [0, 0, -1]         # the way in which the door presses it
pitch = "25mm"

[[seal.joint]]
name = "splice"
at = "2.1m"
length = "40mm"
factor = 1.6

[modes]
file = "door_modes.csv"
damping = 0.005

[[point]]
name = "mirror"
at = "150, 1050, 0 mm"

[base]
psd = "0.001g^2/Hz"

[closing]                   # what meets the door as it closes
start = "20deg"             # where the door has its speed, at its edge
friction = "1N*m"           # of the hinges
gravity = [0, -1, -0.01]    # the hinge axis leans by .6 degrees, and helps

[closing.check]
angle = "4, 10, 15, 25 deg"
moment = "0, 2, 0, 0 N*m"

[closing.latch]
travel = "0, 6, 12 mm"      # left to fully latched
force = "120, 40, 0 N"

[closing.vents]             # holes in the bulb
width = "8mm"               # over which it is pressed
hollow = "14mm"             # its height
hole = "5mm"
spacing = "50mm"

[closing.between]           # the air between this seal and a second one
width = "15mm"
depth = "12mm"
leak = "2mm"

[closing.cabin]
volume = "2.8m^3"
opening = "600cm^2"         # exhaust vents and leaks

[closing.variation]
gap = "1.5mm"               # three standard deviations, all along alike
force = "15%"
limit = "0.75m/s"

[leak]                      # pressure of the wind on the seal
lip = "10mm"                # on which it acts
lip_sd = "0.5mm"
pressure_coefficient = 1.0  # of the dynamic pressure
pressure_coefficient_sd = 0.1
gap_sd = "0.3mm"
limit = "120km/h"

[[leak.state]]
name = "gap 2 mm wider"
gap = "2mm"

[[leak.state]]
name = "gap 2 mm wider, suddenly"
gap = "2mm"
time = "0.1s"               # since the gap widened

[[leak.state]]
name = "aged"
retained = "60%"            # of the force; or aging, aging_time, aging_temperature
retained_sd = "5%"
"""


EXAMPLES: Mapping[str, Example] = MappingProxyType(
    {
        "line.csv": Example(
            "seal-line",
            "x, y, z of a seal along a quarter of a door, for dashpot export --line",
            _write_line,
        ),
        "door.toml": Example(
            "door", "a door with hinges, latch, seal and modes, for dashpot predict", _write_door
        ),
        "door_line.csv": Example(
            "seal-line", "its seal line: x, y, z and the gap that the seal fills", _write_door_line
        ),
        "door_modes.csv": Example(
            "free-modes", "its modes, as it moves when nothing holds it", _make_door_modes
        ),
    }
)
