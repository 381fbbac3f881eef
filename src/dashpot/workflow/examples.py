"""Example files to learn on: simulated, stamped as such, the same every time.

The virtual rig and hammer write them when asked. A package that carried them would carry megabytes
of numbers that the code makes in a second, and they would be those of an older version.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.base.units import GRAVITY, in_unit, written
from dashpot.base.version import byline
from dashpot.io.write import write_impact, write_relaxation
from dashpot.kinds.indentation.collision import collide
from dashpot.kinds.indentation.contact_law import ViscousContact, sphere_stiffness
from dashpot.kinds.rod.prepare import rod_transmissibility
from dashpot.simulation.impact import Hammer, simulate_impact
from dashpot.simulation.plate import free_plate
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig import Climate, Rig
from dashpot.simulation.truth import stamp
from dashpot.solids.friction import Iwan
from dashpot.solids.hyperelastic import Hyperelastic, Mode
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.part import Disc
from dashpot.solids.table_1 import BROAD
from dashpot.solids.temperature import WLF
from dashpot.vibration.systems.bodies import Mount, point_mass
from dashpot.vibration.systems.level import response_at_level
from dashpot.vibration.systems.system import System

MASS = 0.1148
"""Of the block under the hammer, kg: 114.8 g on two seals."""

_RIG = replace(Rig(), rate=200.0)
# a seal that is a quarter stiffer at 8 mm than at first contact
_STIFFENING = replace(Rig(), rate=250.0, bias=0.02, stiffening=4000.0)
# arms a decade apart are told by thousandths of the force: a finer encoder, a faster record
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

    def made() -> str:
        found = simulate_relaxation(
            BROAD, depth=depth, hold_time=hold, rig=rig, seed=seed, climate=climate
        )
        return write_relaxation(found.test, comments=stamp(found.truth)[:1])

    return made


def _clipped() -> str:
    """A load cell whose range ends at three quarters of the force."""
    found = simulate_relaxation(BROAD, rig=_RIG, seed=7)
    most = 0.75 * float(found.test.force.max())
    spoilt = replace(found.test, force=np.minimum(found.test.force, most))
    return write_relaxation(
        spoilt, comments=(*stamp(found.truth)[:1], "spoilt: the load cell clips")
    )


def _hammer() -> str:
    found = simulate_impact(BROAD, mass=MASS, seals=2, hits=5, rig=_HAMMER, seed=1)
    return write_impact(found.test, comments=stamp(found.truth)[:1])


def _sweep() -> str:
    """Storage and loss of one seal as a dynamic testing machine writes them, 0.5 % noisy."""
    frequency = np.geomspace(0.01, 100.0, 41)
    stiffness = BROAD.complex_stiffness(2 * np.pi * frequency)
    storage, loss = (in_unit(part, "N/mm") for part in (stiffness.real, stiffness.imag))
    noise = 1 + 0.005 * np.random.default_rng(1).standard_normal((2, len(frequency)))
    rows = zip(frequency, storage * noise[0], loss * noise[1], strict=True)
    head = "frequency [Hz],storage stiffness [N/mm],loss stiffness [N/mm]"
    lines = [f"# {byline('simulated dynamic test')}", "# simulated", head]
    return "\n".join([*lines, *(",".join(f"{value:.6g}" for value in row) for row in rows), ""])


def _curve() -> str:
    """A relaxation modulus of rubber over time, MPa, 0.2 % noisy."""
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
        value = solid.complex_stiffness(2 * np.pi * frequency)
        value = value + 0.005 * np.abs(value) * (draw(12) + 1j * draw(12))
        rows += [
            f"{f:.6g},{v.real:.6g},{v.imag:.6g},{celsius + 0.05 * draw():.2f}"
            for f, v in zip(frequency, value, strict=True)
        ]
    head = "frequency [Hz],storage modulus [MPa],loss modulus [MPa],temperature [degC]"
    return "\n".join([f"# {byline('simulated dynamic test')}", "# simulated", head, *rows, ""])


def _pushed(path: FloatArray, met: BoolArray, step: float) -> FloatArray:
    """The force of a path with memory, N: a seal that would pull is left, and recovers."""
    k, tau = np.asarray(BROAD.k), np.asarray(BROAD.tau)
    decay = np.exp(-step / tau)
    mean = k * (1 - decay) * tau / step
    arms, here, force = np.zeros(len(k)), 0.0, np.zeros(len(path))
    for i, wanted in enumerate(path.tolist()):
        before, here, passed = here, wanted, decay * arms
        force[i] = BROAD.k_inf * here + (passed + mean * (here - before)).sum()
        if force[i] <= 0 or not met[i]:
            force[i] = 0.0
            here = (mean.sum() * before - passed.sum()) / (BROAD.k_inf + mean.sum())
        arms = passed + mean * (here - before)
    return force


def _pressed(stiffness: float, seed: int, *, speed: float = 50e-3 / 60) -> Callable[[], str]:
    """A piece of a stiffening seal, pressed 8 mm and released four times, softer each time."""

    def made() -> str:
        depth, gap, cycles = 8e-3, 1e-3, 4
        stroke = (depth + gap) / speed
        turns = np.arange(2 * cycles + 1) * stroke + 2.0
        knots = np.concatenate(([0.0], turns, [turns[-1] + 2.0]))
        places = np.array([-gap, *([-gap, depth] * cycles), -gap, -gap])
        time = np.linspace(0.0, knots[-1], 1601)
        plate = np.interp(time, knots, places)
        x = np.maximum(plate, 0.0)
        number = np.searchsorted(turns[2::2], time)
        softer = 1 + 0.1 * np.exp(-2.0 * number)  # the seal of the relaxation test is conditioned
        path = softer * (0.7 * x + 0.3 * x**3 / depth**2)
        force = stiffness * _pushed(path, plate > 0, float(time[1]))
        noise = 4e-3 * np.random.default_rng(seed).standard_normal(len(time))
        lines = zip(time, in_unit(plate, "mm"), force + 0.03 + noise, strict=True)
        head = [f"# {byline('simulated compression load deflection test')}", "# simulated"]
        rows = (",".join(f"{value:.6g}" for value in row) for row in lines)
        return "\n".join([*head, "time [s],displacement [mm],force [N]", *rows, ""])

    return made


def _hit() -> str:
    """A steel ball of 5 g on rubber, its acceleration at 100 kHz, 0.5 % noisy, with an offset."""
    law = ViscousContact(sphere_stiffness(4e6, 5e-3), 1e-4)
    one = collide(law, mass=5e-3, velocity=1.0, pull=GRAVITY)
    time = np.arange(600) * 1e-5
    felt = np.interp(time - 2e-3, one.time, one.force / one.mass, left=0.0, right=0.0)
    felt += 3.0 + 0.005 * felt.max() * np.random.default_rng(1).standard_normal(len(time))
    rows = (f"{t:.5f},{a:.5g}" for t, a in zip(time, -felt, strict=True))
    head = [f"# {byline('simulated indentation')}", "# simulated", "# indenter of 5 g, radius 5 mm"]
    return "\n".join([*head, "time [s],acceleration [m/s^2]", *rows, ""])


def _rod() -> str:
    """T of a rubber cylinder, 20 mm by 20 mm and 6.283 g, under 31.4 g; 0.5 % noisy."""
    part, density = Disc(20e-3, 20e-3), 1000.0
    frequency = np.arange(20.0, 600.0, 1.0)
    omega = 2 * np.pi * frequency
    rubber = GeneralizedMaxwell(0.8e6, (0.15e6, 0.15e6, 0.4e6), (1e-2, 1e-3, 1e-4))
    bonded = part.factor() * part.height / part.area
    T = rod_transmissibility(
        frequency, bonded * rubber.complex_stiffness(omega), length=part.height, density=density,
        mass_ratio=31.4e-3 / (density * part.area * part.height),
    )  # fmt: skip
    draw = np.random.default_rng(1).standard_normal
    T = T * (1 + 0.005 * (draw(len(T)) + 1j * draw(len(T))))
    rows = zip(frequency, np.abs(T), np.degrees(np.angle(T)), np.full(len(T), 0.9999), strict=True)
    head = "frequency [Hz],transmissibility magnitude [g/g],phase [deg],coherence"
    lines = [f"# {byline('simulated transmissibility')}", "# simulated", head]
    return "\n".join([*lines, *(",".join(f"{one:.6g}" for one in row) for row in rows), ""])


_RUBBER = Hyperelastic("mooney-rivlin", (0.15e6, 0.05e6))


def _stretched(mode: Mode, most: float, seed: int) -> Callable[[], str]:
    """Stress over strain of a rubber that follows Mooney and Rivlin, 0.5 % noisy."""

    def made() -> str:
        x = np.linspace(1.0, most, 80)
        stress = in_unit(_RUBBER.nominal(mode, x), "MPa")
        stress += 0.005 * stress.max() * np.random.default_rng(seed).standard_normal(len(x))
        rows = (f"{100 * (a - 1):.5g},{b:.5g}" for a, b in zip(x, stress, strict=True))
        head = [f"# {byline(f'simulated {mode} test')}", "# simulated"]
        return "\n".join([*head, "strain [%],nominal stress [MPa]", *rows, ""])

    return made


_RUBBING = Iwan(120.0, 0.06)
"""Friction beside a seal, N/m and N: it softens with amplitude."""


def _loops() -> str:
    """Six cycles at each of nine amplitudes, 5 Hz, about a compression of 4 mm."""
    rate, cycles, hz = 250, 6, 5.0
    sizes = np.geomspace(5e-5, 3e-3, 9)
    time = np.arange(int(len(sizes) * cycles / hz * rate)) / rate
    size = sizes[np.minimum((time * hz / cycles).astype(int), len(sizes) - 1)]
    x = size * np.sin(2 * np.pi * hz * time)
    noise = 3e-4 * np.random.default_rng(1).standard_normal(len(time))
    force = (BROAD + _RUBBING).path_force(time, x) + 1.2 + noise
    rows = (
        f"{t:.6g},{d:.6g},{f:.6g}"
        for t, d, f in zip(time, in_unit(x + 4e-3, "mm"), force, strict=True)
    )
    head = [f"# {byline('simulated loops')}", "# simulated", "time [s],displacement [mm],force [N]"]
    return "\n".join([*head, *rows, ""])


def _at_level(level: float, seed: int) -> Callable[[], str]:
    """The FRF of the block on two seals that rub, under a force of that amplitude, 0.5 % noisy."""

    def made() -> str:
        mount = Mount(2 * BROAD, ("block", "ground"), friction=2 * _RUBBING)
        found = response_at_level(
            System((point_mass("block", MASS),), (mount,)), response="block.z", force="block.z",
            level=level, frequency=np.linspace(8, 20, 97),
        ).frf()  # fmt: skip
        draw = np.random.default_rng(seed).standard_normal
        value = found.value * (1 + 0.005 * (draw(97) + 1j * draw(97)))
        rows = zip(found.frequency, value.real, value.imag, strict=True)
        head = "frequency [Hz],real [(m/s^2)/N],imaginary [(m/s^2)/N]"
        lines = [f"# {byline('simulated shaker test')}", "# simulated", head]
        return "\n".join([*lines, *(",".join(f"{one:.6g}" for one in row) for row in rows), ""])

    return made


def _line() -> str:
    """A quarter of a door: x, y, z, mm."""
    angle = np.linspace(0.0, np.pi / 2, 13)
    rows = (f"{400 * np.cos(a):.3f},{400 * np.sin(a):.3f},0" for a in angle)
    return "\n".join([f"# {byline('simulated seal line')}", "x,y,z", *rows, ""])


_HINGES, _LATCH, _MIRROR = ((0.0, 0.3, 0.0), (0.0, 0.9, 0.0)), (1.1, 0.6, 0.0), (0.15, 1.05, 0.0)


def _around() -> tuple[FloatArray, FloatArray]:
    """A seal line 20 mm within a door, its corners round, m; and its gap, 12.5 to 15 mm."""
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
    place, gap = _around()
    rows = (
        ",".join(f"{in_unit(v, 'mm'):.3f}" for v in (*p, g))
        for p, g in zip(place, gap, strict=True)
    )
    head = [f"# {byline('simulated seal line')}", "# simulated", "x [mm],y [mm],z [mm],gap [mm]"]
    return "\n".join([*head, *rows, ""])


def _door_modes() -> str:
    """Of a plate of 25 kg whose first elastic mode lies at 64 Hz, as a row a point and mode."""
    place = np.concatenate((_around()[0][:-1], (*_HINGES, _LATCH, _MIRROR)))
    modes = free_plate(place, width=1.1, height=1.2, mass=25.0, rigidity=3e4, elastic=24)
    rows = (
        ",".join(f"{v:.7g}" for v in (r + 1, f, *in_unit(place[p], "mm"), modes.shapes[r, p, 2]))
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


CAPTIONS: Mapping[str, str] = MappingProxyType(
    {
        "seal_8mm.csv": "a seal pressed 8 mm in 1 s and held 40 s",
        "hammer.csv": f"a block of {written(MASS, 'g', 'g')} on two such seals, struck five times",
        "depth_4mm.csv": "a seal that stiffens as it is pressed, to 4 mm",
        "depth_6mm.csv": "the same to 6 mm",
        "depth_8mm.csv": "the same to 8 mm: dashpot fit --depth-law takes the three",
        "at_23degC.csv": "another seal at 23 degC",
        "at_10degC.csv": "the same at 10 degC",
        "at_0degC.csv": "the same at 0 degC: dashpot fit takes the three together",
        "short_hold.csv": "a hold of 3 s, too short for the slow arms",
        "clipped.csv": "a load cell that clips: a test not to be used",
        "sweep.csv": "storage and loss over frequency, as a dynamic testing machine writes them",
        "sweeps.csv": "such sweeps of a rubber at nine temperatures, for a master curve",
        "curve.csv": 'a relaxation modulus over time, for dashpot fit --modulus "E(t)"',
        "cld_1.csv": "100 mm of a seal pressed 8 mm and released four times at 50 mm/min",
        "cld_2.csv": "a second piece of it",
        "cld_3.csv": "a third: dashpot cld takes the three",
        "cld_slow.csv": "the first piece at 5 mm/min",
        "cld_fast.csv": "and at 500 mm/min: dashpot cld takes the three speeds",
        "hit.csv": "a ball of 5 g, radius 5 mm, dropped 51 mm on rubber, for dashpot indent",
        "rod.csv": "the transmissibility of a rubber cylinder to a mass on it, for dashpot rod",
        "tension.csv": "a rubber pulled to twice its length, for dashpot hyperelastic",
        "biaxial.csv": "the same pulled both ways: dashpot hyperelastic takes the two",
        "loops.csv": "a seal that rubs, moved to and fro at nine amplitudes, for dashpot level",
        "shaker_20mN.csv": "the block on two such seals, on a shaker of 0.02 N",
        "shaker_500mN.csv": "the same at 0.5 N: dashpot level takes the two",
        "line.csv": "x, y, z of a seal along a quarter of a door, for dashpot export --line",
        "door.toml": "a door with hinges, latch, seal and modes, for dashpot door",
        "door_line.csv": "its seal line: x, y, z and the gap that the seal fills",
        "door_modes.csv": "its modes, as it moves when nothing holds it",
    }
)
"""What every example file is."""

FIRST = ("seal_8mm.csv", "hammer.csv")
"""The two files of the first seal."""

EXAMPLES: Mapping[str, Callable[[], str]] = MappingProxyType(
    {
        "seal_8mm.csv": _seal(1),
        "hammer.csv": _hammer,
        "depth_4mm.csv": _seal(3, depth=4e-3, rig=_STIFFENING),
        "depth_6mm.csv": _seal(2, depth=6e-3, rig=_STIFFENING),
        "depth_8mm.csv": _seal(1, depth=8e-3, rig=_STIFFENING),
        "at_23degC.csv": _seal(5, rig=_FINE, celsius=23.0),
        "at_10degC.csv": _seal(6, rig=_FINE, celsius=10.0),
        "at_0degC.csv": _seal(7, rig=_FINE, celsius=0.0),
        "short_hold.csv": _seal(4, hold=3.0),
        "clipped.csv": _clipped,
        "sweep.csv": _sweep,
        "sweeps.csv": _sweeps,
        "curve.csv": _curve,
        "cld_1.csv": _pressed(1.0, 1),
        "cld_2.csv": _pressed(1.04, 2),
        "cld_3.csv": _pressed(0.97, 3),
        "cld_slow.csv": _pressed(1.0, 4, speed=5e-3 / 60),
        "cld_fast.csv": _pressed(1.0, 5, speed=500e-3 / 60),
        "hit.csv": _hit,
        "rod.csv": _rod,
        "tension.csv": _stretched("uniaxial", 2.0, 1),
        "biaxial.csv": _stretched("equibiaxial", 1.6, 2),
        "loops.csv": _loops,
        "shaker_20mN.csv": _at_level(0.02, 1),
        "shaker_500mN.csv": _at_level(0.5, 2),
        "line.csv": _line,
        "door.toml": _door,
        "door_line.csv": _door_line,
        "door_modes.csv": _door_modes,
    }
)
"""Every example file and what writes it."""
