"""Example files, simulated reproducibly and marked as such.

The virtual rig and hammer write them when asked. A package that carried them would carry megabytes
of numbers that the code makes in a second, and they would be those of an older version.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from types import MappingProxyType

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.base.version import byline
from dashpot.reading.write import write_impact, write_relaxation
from dashpot.registry import KINDS, Example, load_object
from dashpot.simulation.free_plate import free_plate
from dashpot.simulation.ground_truth import stamp
from dashpot.simulation.impact import Hammer, simulate_impact
from dashpot.simulation.motion import simulate_relaxation
from dashpot.simulation.rig import Climate, Rig
from dashpot.solids.demo_seals import BROAD, BROAD_MASS
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.shift_laws import WLF

MASS = round(BROAD_MASS, 4)
"""Of the block under the hammer, kg: 114.8 g on two seals."""

_RIG = replace(Rig(), rate=200.0)
# a seal that is a quarter stiffer at 8 mm than at first contact
_STIFFENING = replace(Rig(), rate=250.0, bias=0.02, stiffening=4000.0)
# arms a decade apart differ by thousandths of the force: a finer encoder, a faster record
_FINE = replace(Rig(), rate=500.0, encoder=2e-6)
_HAMMER = replace(Hammer(), rate=512.0, record=6.0)


def _seal(
    seed: int,
    *,
    depth: float = 8e-3,
    hold: float = 40.0,
    rig: Rig = _RIG,
    celsius: float | None = None,
) -> Callable[[], str]:
    climate = None if celsius is None else Climate(celsius + 273.15)

    def simulate_test_file() -> str:
        relaxation = simulate_relaxation(
            BROAD, depth=depth, hold_time=hold, rig=rig, seed=seed, climate=climate
        )
        return write_relaxation(relaxation.test, comments=stamp(relaxation.truth)[:1])

    return simulate_test_file


def _simulate_clipped_test() -> str:
    """Return a load cell whose range ends at three quarters of the force."""
    relaxation = simulate_relaxation(BROAD, rig=_RIG, seed=7)
    most = 0.75 * float(relaxation.test.force.max())
    spoilt = replace(relaxation.test, force=np.minimum(relaxation.test.force, most))
    return write_relaxation(
        spoilt, comments=(*stamp(relaxation.truth)[:1], "spoilt: the load cell clips")
    )


def _hammer() -> str:
    impact = simulate_impact(BROAD, mass=MASS, seals=2, hits=5, rig=_HAMMER, seed=1)
    return write_impact(impact.test, comments=stamp(impact.truth)[:1])


def _sweep() -> str:
    """Return storage and loss of one seal as a dynamic testing machine writes them, 0.5 % noisy."""
    frequency = np.geomspace(0.01, 100.0, 41)
    stiffness = BROAD.complex_stiffness(omega=2 * np.pi * frequency)
    storage, loss = (convert_to_unit(part, "N/mm") for part in (stiffness.real, stiffness.imag))
    noise = 1 + 0.005 * np.random.default_rng(1).standard_normal((2, len(frequency)))
    rows = zip(frequency, storage * noise[0], loss * noise[1], strict=True)
    head = "frequency [Hz],storage stiffness [N/mm],loss stiffness [N/mm]"
    lines = [f"# {byline('simulated dynamic test')}", "# simulated", head]
    return "\n".join([*lines, *(",".join(f"{value:.6g}" for value in row) for row in rows), ""])


def _curve() -> str:
    """Return a relaxation modulus of rubber over time, MPa, 0.2 % noisy."""
    time = np.geomspace(1e-3, 100.0, 61)
    modulus = BROAD.relaxation(time) * 1e-2
    noise = 1 + 0.002 * np.random.default_rng(1).standard_normal(len(time))
    rows = (f"{t:.6g},{e:.6g}" for t, e in zip(time, modulus * noise, strict=True))
    head = [f"# {byline('simulated relaxation modulus')}", "# simulated", "time [s],E(t) [MPa]"]
    return "\n".join([*head, *rows, ""])


def _sweeps() -> str:
    """Sweeps of a filled rubber at nine temperatures, 0.5 % noisy, MPa."""
    tau = np.logspace(-9, 3, 37)
    share = np.exp(-0.5 * ((np.log10(tau) + 4) / 2.2) ** 2)
    rubber = GeneralizedMaxwell(4.0, tuple(1500 * share / share.sum()), tuple(tau))
    law, draw = WLF(7.0, 120.0, 296.15), np.random.default_rng(3).standard_normal
    frequency = np.geomspace(0.1, 20.0, 12)
    rows = []
    for celsius in range(-25, 56, 10):
        kelvin = celsius + 273.15
        solid = rubber.shifted(float(law.a_t(kelvin)), kelvin / law.reference)
        value = solid.complex_stiffness(omega=2 * np.pi * frequency)
        value = value + 0.005 * np.abs(value) * (draw(12) + 1j * draw(12))
        rows += [
            f"{f:.6g},{v.real:.6g},{v.imag:.6g},{celsius + 0.05 * draw():.2f}"
            for f, v in zip(frequency, value, strict=True)
        ]
    head = "frequency [Hz],storage modulus [MPa],loss modulus [MPa],temperature [degC]"
    return "\n".join([f"# {byline('simulated dynamic test')}", "# simulated", head, *rows, ""])


def _line() -> str:
    """Return a quarter of a door: x, y, z, mm."""
    angle = np.linspace(0.0, np.pi / 2, 13)
    rows = (f"{400 * np.cos(a):.3f},{400 * np.sin(a):.3f},0" for a in angle)
    return "\n".join([f"# {byline('simulated seal line')}", "x,y,z", *rows, ""])


_HINGES, _LATCH, _MIRROR = ((0.0, 0.3, 0.0), (0.0, 0.9, 0.0)), (1.1, 0.6, 0.0), (0.15, 1.05, 0.0)


def _make_seal_line() -> tuple[FloatArray, FloatArray]:
    """Return a seal line 20 mm within a door, its corners round, m; and its gap, 12.5 to 15 mm."""
    radius, low, high = 0.1, np.array([0.02, 0.02]), np.array([1.08, 1.18])
    points: list[FloatArray] = []
    for corner, start in ((0, -180), (1, -90), (2, 0), (3, 90)):
        middle = np.where([corner in {1, 2}, corner in {2, 3}], high - radius, low + radius)
        angle = np.radians(start + np.linspace(0, 90, 7))
        arc = middle + radius * np.stack((np.cos(angle), np.sin(angle)), axis=1)
        straight = np.linspace(points[-1], arc[0], 8)[1:-1] if points else np.empty((0, 2))
        points += [*straight, *arc]
    points += [*np.linspace(points[-1], points[0], 8)[1:]]
    place = np.column_stack((points, np.zeros(len(points))))
    gap = 13.75e-3 + 1.25e-3 * np.sin(2 * np.pi * np.arange(len(place)) / (len(place) - 1))
    return place, gap


def _door_line() -> str:
    place, gap = _make_seal_line()
    rows = (
        ",".join(f"{convert_to_unit(v, 'mm'):.3f}" for v in (*p, g))
        for p, g in zip(place, gap, strict=True)
    )
    head = [f"# {byline('simulated seal line')}", "# simulated", "x [mm],y [mm],z [mm],gap [mm]"]
    return "\n".join([*head, *rows, ""])


def _door_modes() -> str:
    """Of a plate of 25 kg whose first elastic mode lies at 64 Hz, as a row a point and mode."""
    place = np.concatenate((_make_seal_line()[0][:-1], (*_HINGES, _LATCH, _MIRROR)))
    modes = free_plate(place, width=1.1, height=1.2, mass=25.0, rigidity=3e4, elastic=24)
    rows = (
        ",".join(
            f"{v:.7g}" for v in (r + 1, f, *convert_to_unit(place[p], "mm"), modes.shapes[r, p, 2])
        )
        for r, f in enumerate(modes.frequency)
        for p in range(len(place))
    )
    head = [f"# {byline('simulated modes')}", "# simulated, shapes of a modal mass of 1 kg"]
    return "\n".join([*head, "mode,frequency [Hz],x [mm],y [mm],z [mm],uz", *rows, ""])


def _door() -> str:
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
length = "100mm"            # of the piece that was tested
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
"""


_BENCH = {
    "seal_8mm.csv": Example("relaxation", "a seal pressed 8 mm in 1 s and held 40 s", _seal(1)),
    "hammer.csv": Example(
        "impact",
        f"a block of {format_quantity(MASS, 'g', 'g')} on two such seals, struck five times",
        _hammer,
    ),
    "depth_4mm.csv": Example(
        "relaxation",
        "a seal that stiffens as it is pressed, to 4 mm",
        _seal(3, depth=4e-3, rig=_STIFFENING),
    ),
    "depth_6mm.csv": Example(
        "relaxation", "the same to 6 mm", _seal(2, depth=6e-3, rig=_STIFFENING)
    ),
    "depth_8mm.csv": Example(
        "relaxation",
        "the same to 8 mm: dashpot fit --elastic by-depth takes the three",
        _seal(1, depth=8e-3, rig=_STIFFENING),
    ),
    "at_23degC.csv": Example(
        "relaxation", "another seal at 23 degC", _seal(5, rig=_FINE, celsius=23.0)
    ),
    "at_10degC.csv": Example(
        "relaxation", "the same at 10 degC", _seal(6, rig=_FINE, celsius=10.0)
    ),
    "at_0degC.csv": Example(
        "relaxation",
        "the same at 0 degC: dashpot fit takes the three together",
        _seal(7, rig=_FINE, celsius=0.0),
    ),
    "short_hold.csv": Example(
        "relaxation", "a hold of 3 s, too short for the slow arms", _seal(4, hold=3.0)
    ),
    "clipped.csv": Example(
        "relaxation", "a load cell that clips: a test not to be used", _simulate_clipped_test
    ),
    "sweep.csv": Example(
        "dma", "storage and loss over frequency, as a dynamic testing machine writes them", _sweep
    ),
    "sweeps.csv": Example(
        "dma", "such sweeps of a rubber at nine temperatures, for a master curve", _sweeps
    ),
    "curve.csv": Example("modulus", "a relaxation modulus over time", _curve),
}
_DOOR = {
    "line.csv": Example(
        "seal-line", "x, y, z of a seal along a quarter of a door, for dashpot export --line", _line
    ),
    "door.toml": Example(
        "door", "a door with hinges, latch, seal and modes, for dashpot predict", _door
    ),
    "door_line.csv": Example(
        "seal-line", "its seal line: x, y, z and the gap that the seal fills", _door_line
    ),
    "door_modes.csv": Example(
        "free-modes", "its modes, as it moves when nothing holds it", _door_modes
    ),
}
FILES: Mapping[str, Example] = MappingProxyType({
    **_BENCH,
    **{
        name: item
        for kind in KINDS.values()
        if kind.examples
        for name, item in load_object(kind.examples).items()
    },
    **_DOOR,
})  # fmt: skip
"""All example files: of bench and hammer tests, of the kinds of extensions, of a door."""

CAPTIONS: Mapping[str, str] = MappingProxyType({name: file.caption for name, file in FILES.items()})
"""What every example file is."""

FIRST = ("seal_8mm.csv", "hammer.csv")
"""The two files of the first seal."""

EXAMPLES: Mapping[str, Callable[[], str]] = MappingProxyType(
    {name: cache(file.write) for name, file in FILES.items()}
)
"""Every example file and what writes it: once, as it is the same every time."""
