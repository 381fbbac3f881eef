"""Tables whose columns could be misunderstood: units, factors, two for one role, blocks."""

# ruff: noqa: E501 - a file of a lab stands on one line

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from kit.crafted.row import (
    ACCELERANCE,
    AMPLITUDES,
    CLOCK,
    COLD,
    COMPLIANCE,
    CREEP,
    CREPT,
    DECAY,
    DEFLECTION,
    HIT,
    HITS,
    ISOTHERMS,
    LINES,
    LOSS,
    LOST,
    MODULUS,
    OVER_BASE,
    OVER_FORCE,
    PRESSED,
    PULLED,
    RAMP,
    RUNG,
    SOFT,
    STORAGE,
    STRAIN,
    SWEEP,
    TANGENT,
    TENSION,
    TICKS,
    TRANSMISSIBILITY,
    F,
    Row,
    Truth,
    table,
)
from kit.look_alikes import truth

TIME, DISPLACEMENT, FORCE = truth()
WARM = 20 + 0.01 * np.arange(len(TIME))
COUNT = np.arange(len(TIME)) % 7.0
FIVE = (TIME, WARM, DISPLACEMENT, FORCE, COUNT)
NAMES = "Time;Temp;Position;Load;Count"
BOTH = np.concatenate([F, F])
TWICE = np.concatenate([COLD * STORAGE, STORAGE]), np.concatenate([COLD * LOSS, LOSS])
DEGREES = np.concatenate([0 * F, 0 * F + 23])


def bench(head: str, *columns: np.ndarray) -> bytes:
    """A bench's file of the columns, with its five decimals."""
    return table(head, *(columns or (TIME, DISPLACEMENT, FORCE)), form="%.5f").encode()


def _units() -> list[Row]:
    """A row of units with a cell too many or too few."""
    names = ("Time", "Position", "Load")
    return [
        Row("a unit too many at the end", bench(f"{NAMES}\ns;degC;mm;N;1;bar", *FIVE), "noted", ("6 cells for 5 columns", "from the left")),
        Row("a unit too few at the end", bench(f"{NAMES}\ns;degC;mm;N", *FIVE), "noted", ("4 cells for 5 columns",)),
        Row("two units too few at the end", bench("Time;Position;Load;Temp;Count\ns;mm;N", TIME, DISPLACEMENT, FORCE, WARM, COUNT), "noted", ("3 cells for 5 columns",)),
        Row("bracketed units, one too many", bench(f"{NAMES}\n(s);(degC);(mm);(N);(1);(bar)", *FIVE), "noted", ("6 cells",)),
        Row(
            "a unit too few inside", bench(f"{NAMES}\ns;mm;N;1", *FIVE), "asked",
            ("has no unit", '--units "time=s,displacement=mm,force=N"'),
            answer={"units": {"time": "s", "displacement": "mm", "force": "N"}},
        ),
        Row(
            "a unit too many inside", bench(f"{NAMES}\ns;degC;bar;mm;N;1", *FIVE), "asked",
            ("has no unit",), answer={"units": {"time": "s", "displacement": "mm", "force": "N"}},
        ),
        Row("a unit too many under decimal commas", table("Zeit;Weg;Kraft\ns;mm;N;°C", TIME, DISPLACEMENT, FORCE, comma=True).encode(), "noted", ("4 cells for 3 columns",)),
        Row("a unit too few between tabs", table("\t".join(names) + "\tTemp\ns\tmm\tN", TIME, DISPLACEMENT, FORCE, WARM, sign="\t").encode(), "noted", ("3 cells for 4 columns",)),
        Row("a unit too many of a sweep", table("f;E';E''\nHz;MPa;MPa;%", F, STORAGE / 1e6, LOSS / 1e6).encode(), "noted", ("4 cells for 3 columns",), SWEEP),
        Row("a unit too few of a sweep", table("f;E';E'';tan d\nHz;MPa;MPa", F, STORAGE / 1e6, LOSS / 1e6, TANGENT).encode(), "noted", ("3 cells for 4 columns",), SWEEP),
    ]  # fmt: skip


def _factors() -> list[Row]:
    """A factor in the header, which may multiply the numbers or have multiplied them."""

    def load(word: str, times: float) -> bytes:
        return table(f"Time [s];Position [mm];{word}", TIME, DISPLACEMENT, times * FORCE).encode()

    milli = {"units": {"force": "mN"}}
    rows = [
        Row(
            f"a factor: {word}",
            load(word, 1e3),
            "asked",
            ("a factor", '"force=mN"', '"force=kN"'),
            answer=milli,
        )
        for word in (
            "Load [N] x 1000",
            "Load x 1000 [N]",
            "Load [N] *1000",
            "Load (1000 N)",
            "Load [N x 10^3]",
            "Load [x1000 N]",
        )
    ]
    return [
        *rows,
        Row("a factor: Load [10 mN]", load("Load [10 mN]", 100.0), "asked", ("a factor", '"force=cN"'), answer={"units": {"force": "10mN"}}),
        Row("a factor: Load [1E-3 N]", load("Load [1E-3 N]", 1e3), "asked", ("a factor", '"force=mN"'), answer=milli),
    ]  # fmt: skip


def _twice() -> list[Row]:
    """Two columns for one role."""
    indices = np.where(np.arange(len(TIME)) < 30, 1.0, 1.2)
    shifted = TIME * 1.1
    both = (BOTH, TWICE[0] / 1e6, TWICE[1] / 1e6)
    sweep = (F, STORAGE / 1e6, LOSS / 1e6)
    polar = (LINES, np.abs(OVER_FORCE), np.degrees(np.angle(OVER_FORCE)))
    coherent = 0 * LINES + 0.99
    line = "frequency [Hz];magnitude [1/kg];phase [deg]"
    return [
        Row("temperature set and sample, isotherms", table("f [Hz];E' [MPa];E'' [MPa];Temp set [°C];Temp sample [°C]", *both, DEGREES, DEGREES + 0.2).encode(), "noted", ("'Temp set [°C]' could be too",), ISOTHERMS),
        Row(
            "two temperatures of equal names, isotherms", table("f [Hz];E' [MPa];E'' [MPa];Temp 1 [°C];Temp 2 [°C]", *both, DEGREES[::-1], DEGREES).encode(),
            "asked", ("could each be the temperature", "--column temperature="), ISOTHERMS, answer={"temperature": "Temp 2"},
        ),
        Row("two temperatures of a bench", bench("Time [s];Position [mm];Load [N];Temp 1 [°C];Temp 2 [°C]", TIME, DISPLACEMENT, FORCE, WARM, WARM + 2 * indices), "noted", ("no temperature is taken", "could each be")),
        Row("temperature set and sample of a bench", bench("Time [s];Position [mm];Load [N];Set temp [°C];Temp [°C]", TIME, DISPLACEMENT, FORCE, 0 * WARM + 25, WARM), "noted", ("'Set temp [°C]' could be too",)),
        Row(
            "two temperatures of a modulus", table("time [s];E(t) [MPa];Temp A [°C];Temp B [°C]", DECAY, 2 + DECAY**-0.1, 0 * DECAY + 20, DECAY / 100).encode(),
            "asked", ("could each be the temperature",), MODULUS, answer={"temperature": "Temp A"},
        ),
        Row("two clocks of a bench", bench("Time A [s];Time B [s];Position [mm];Load [N]", TIME, shifted, DISPLACEMENT, FORCE), "asked", ("could each be the time",), answer={"time": "Time A"}),
        Row("two clocks of a hammer", table("Time A [s];Time B [s];hammer [N];acceleration [m/s^2]", TICKS, 1.1 * TICKS, HIT, RUNG).encode(), "asked", ("could each be the time",), HITS, answer={"time": "1"}),
        Row("two clocks of a deflection", table("Time A [s];Time B [s];Position [mm];Load [N]", np.arange(119.0), 2 * np.arange(119.0), PRESSED, 0.2 * PRESSED).encode(), "asked", ("could each be the time",), DEFLECTION, answer={"time": "2"}),
        Row("a compliance called J", table("t [s];J [1/MPa]", CLOCK[1:], CREPT[1:]).encode(), truth=COMPLIANCE),
        Row("two clocks of creep", table("Time A [s];Time B [s];Strain [%];Stress [Pa]", CLOCK, 2 * CLOCK, CREPT, 1e5 + 0 * CLOCK).encode(), "asked", ("could each be the time",), CREEP, answer={"time": "1"}),
        Row("two clocks of a tension test", table("Time A [s];Time B [s];Strain [%];Stress [MPa]", PULLED, 2 * PULLED, 100 * PULLED, PULLED**0.8).encode(), "asked", ("could each be the time",), TENSION, answer={"time": "1"}),
        Row("two stresses of a tension test", table("Strain [%];Stress 1 [MPa];Stress 2 [MPa]", 100 * PULLED, PULLED**0.8, PULLED).encode(), "asked", ("could each be the stress",), TENSION, answer={"stress": "Stress 1"}),
        Row("two coherences", table(f"{line};coherence 1;coherence 2", *polar, coherent, coherent / 2).encode(), "asked", ("could each be the coherence",), ACCELERANCE, answer={"coherence": "4"}),
        Row("two standard deviations of an FRF", table(f"{line};sd;sd", *polar, coherent, coherent / 2).encode(), "noted", ("columns 4 and 5 are called sd; none is taken",), ACCELERANCE),
        Row("one standard deviation of an FRF", table(f"{line};sd", *polar, coherent / 10).encode(), truth=ACCELERANCE),
        Row("two loss factors", table("f [Hz];E' [MPa];tan delta 1;tan delta 2", F, STORAGE / 1e6, TANGENT, 2 * TANGENT).encode(), "asked", ("could each be the loss factor",), SWEEP, answer={"loss_factor": "3"}),
        Row("two storage moduli", table("f [Hz];E' 1 [MPa];E' 2 [MPa];E'' [MPa]", F, STORAGE / 1e6, STORAGE / 2e6, LOSS / 1e6).encode(), "asked", ("could each be the storage",), SWEEP, answer={"storage": "2"}),
        Row("frequency in hertz and in radians", table("f [Hz];omega [rad/s];E' [MPa];E'' [MPa]", F, 2 * np.pi * F, *sweep[1:], form="%.10g").encode(), truth=SWEEP),
        Row("a loss factor that is ten times E''/E'", table("f [Hz];E' [MPa];E'' [MPa];tan delta", *sweep, 10 * TANGENT).encode(), "asked", ("10 times loss over storage", "--column loss-factor="), SWEEP, answer={"loss": "E''"}),
        Row("a loss modulus that is a tenth of what tan delta says", table("f [Hz];E' [MPa];E'' [MPa];tan delta", F, STORAGE / 1e6, LOSS / 1e7, TANGENT).encode(), "asked", ("10 times loss over storage",), SWEEP, answer={"loss_factor": "tan delta"}),
        Row("a loss factor that is a fifth too large", table("f [Hz];E' [MPa];E'' [MPa];tan delta", *sweep, 1.2 * TANGENT).encode(), "noted", ("1.2 times loss over storage", "the loss was taken"), SWEEP),
        Row("a loss factor in per cent", table("f [Hz];E' [MPa];E'' [MPa];tan delta [%]", *sweep, 100 * TANGENT).encode(), truth=SWEEP),
        Row("two strain amplitudes", table("Frequency [Hz];Strain A [%];Strain B [%];E' [MPa];E'' [MPa]", 10 + 0 * STRAIN, 100 * STRAIN, 50 * STRAIN, SOFT / 1e6, LOST / 1e6).encode(), "asked", ("could each be the strain",), AMPLITUDES, answer={"strain": "Strain A"}),
    ]  # fmt: skip


def _once() -> list[Row]:
    """What is written once for each block."""

    def blocks(lead: int, every: int = len(F)) -> bytes:
        rows = []
        for i, (f, a, b, warm) in enumerate(zip(BOTH, *TWICE, DEGREES, strict=True)):
            cells = [f"{f:.8g}", f"{a / 1e6:.8g}", f"{b / 1e6:.8g}"]
            cells.insert(lead, f"{warm:g}" if i % every == 0 else "")
            rows.append(";".join(cells))
        heads = ["f [Hz]", "E' [MPa]", "E'' [MPa]"]
        heads.insert(lead, "Temp [°C]")
        return ("\n".join([";".join(heads), *rows]) + "\n").encode()

    message = ("the temperature stands in 2 of 26 rows", "holds for the rows below it")
    long = "".join(
        f"{23 if i == 0 else ''};{f:.8g};{a:.8g};{b:.8g}\n"
        for i, (f, a, b) in enumerate(
            zip(np.geomspace(0.1, 100, 400), np.full(400, 5.0), np.full(400, 1.0), strict=True)
        )
    )
    return [
        Row("a temperature once for each block, first", blocks(0), "noted", message, ISOTHERMS),
        Row("a temperature once for each block, last", blocks(3), "noted", message, ISOTHERMS),
        Row("a temperature in every row but one", (b"Temp [\xc2\xb0C];f [Hz];E' [MPa];E'' [MPa]\n" + table("", 23 + 0 * F, F, STORAGE / 1e6, LOSS / 1e6)[1:].encode() + b";50;1;1\n"), "noted", ("1 rows lack a number",), SWEEP),
        Row("a temperature once above four hundred rows", ("Temp [°C];f [Hz];E' [MPa];E'' [MPa]\n" + long).encode(), "noted", ("stands in 1 of 400 rows",), _long()),
    ]  # fmt: skip


def _long() -> Truth:
    def holds(test: Any, row: Row) -> None:
        assert len(test.frequency) == 400
        np.testing.assert_allclose(test.temperature, 296.15)

    return replace(SWEEP, holds=holds)


def _shaken() -> list[Row]:
    """Two amplitudes with two phases."""
    base, angle = 1 + 0.2 * np.sin(LINES), 0.3 * np.cos(LINES)
    mass = base * np.exp(1j * angle) * OVER_BASE
    push = base * np.exp(1j * angle)
    pulled = push * OVER_FORCE

    def pairs(head: str, *values: np.ndarray, order: tuple[int, ...] = (0, 1, 2, 3)) -> bytes:
        columns = [part for v in values for part in (np.abs(v), np.degrees(np.angle(v)))]
        return table(head, LINES, *(columns[i] for i in order), form="%.9g").encode()

    named = "frequency [Hz];base amplitude [g];base phase [deg];mass amplitude [g];mass phase [deg]"
    return [
        Row("two amplitudes with two phases, base and mass", pairs(named, push, mass), truth=TRANSMISSIBILITY),
        Row("two amplitudes, then two phases", pairs("frequency [Hz];table [m/s^2];mass [m/s^2];phase table [deg];phase mass [deg]", push, mass, order=(0, 2, 1, 3)), truth=TRANSMISSIBILITY),
        Row("mass before base", pairs("f [Hz];Mass [g];Mass phase [deg];Base [g];Base phase [deg]", mass, push), truth=TRANSMISSIBILITY),
        Row("phases in the other order than the amplitudes", pairs("f [Hz];base [g];mass [g];phase mass [deg];phase base [deg]", push, mass, order=(0, 2, 3, 1)), truth=TRANSMISSIBILITY),
        Row("force and acceleration, each with its phase", pairs("f [Hz];Force [N];Force phase [deg];Acceleration [m/s^2];Acceleration phase [deg]", push, pulled), truth=ACCELERANCE),
        Row("amplitudes of force and acceleration", pairs("f [Hz];Force amplitude [N];Force phase [deg];Acceleration amplitude [m/s^2];Acceleration phase [deg]", push, pulled), truth=ACCELERANCE),
        Row(
            "two amplitudes that say not which is the base", pairs("f [Hz];acc 1 [g];phase 1 [deg];acc 2 [g];phase 2 [deg]", push, mass),
            "asked", ("which of them is the base", '--column base-acceleration="acc 1"'), TRANSMISSIBILITY, answer={"base_acceleration": "acc 1"},
        ),
        Row("a displacement over an acceleration", pairs("f [Hz];base acceleration [m/s^2];base phase [deg];mass displacement [mm];mass phase [deg]", push, -1e3 * mass / (2 * np.pi * LINES) ** 2), truth=TRANSMISSIBILITY),
    ]  # fmt: skip


def _sizes() -> list[Row]:
    """Sizes that no test has under the unit that the file states; those that some have are read."""

    def encode_tension_table(
        strain: str, times: float = 1.0, stress: str = "MPa", by: float = 1.0
    ) -> bytes:
        head = f"Strain [{strain}];Stress [{stress}]"
        return table(head, times * PULLED, by * PULLED**0.8).encode()

    pressed = 4e4 / np.max(FORCE)
    slow = np.concatenate([TIME[:5], TIME[5:] * 350])
    return [
        Row("a strain of 0 to 1.5 under per cent", encode_tension_table("%"), "asked", ("--units strain=1",), TENSION, answer={"units": {"strain": "1"}}),
        Row("a strain in per cent", encode_tension_table("%", 100.0), truth=TENSION),
        Row("a stress in pascals under gigapascals", encode_tension_table("1", 1.0, "GPa", 1e6), "asked", ("--units stress=MPa",), TENSION, answer={"units": {"stress": "Pa"}}),
        Row("millimetres under metres", bench("Time [s];Position [m];Load [N]"), "asked", ("--units displacement=mm",), RAMP, answer={"units": {"displacement": "mm"}}, by_size=True),
        Row("kilonewtons under newtons", table("Time [s];Position [mm];Load [N]", TIME, DISPLACEMENT, FORCE / 1e3).encode(), "asked", ("--units force=kN",), RAMP, answer={"units": {"force": "kN"}}, by_size=True, coarse=1e-6),
        Row("seconds under milliseconds", bench("Time [ms];Position [mm];Load [N]"), "asked", ("--units time=s",), RAMP, answer={"units": {"time": "s"}}, by_size=True),
        Row("a press of 40 kN", table("Time [s];Position [mm];Load [kN]", TIME, DISPLACEMENT, pressed * FORCE / 1e3).encode(), "noted", ("The force spans 40 kN",), _make_truth(force=pressed * FORCE)),
        Row("a ramp of 315 s", table("Time [s];Position [mm];Load [N]", slow, DISPLACEMENT, FORCE).encode(), "noted", ("sampled at 0.0286 Hz",), _make_truth(time=slow)),
        Row("a stroke of 401 mm", table("Time [s];Position [mm];Load [N]", 20 * TIME, 401 / 8 * DISPLACEMENT, FORCE).encode(), "noted", ("The displacement spans 401 mm",), _make_truth(displacement=0.401 / 8 * DISPLACEMENT)),
    ]  # fmt: skip


def _make_truth(**columns: np.ndarray) -> Truth:
    """A ramp and hold of another size."""

    def holds(test: Any, row: Row) -> None:
        for name, values in columns.items():
            np.testing.assert_allclose(getattr(test, name), values, rtol=1e-5, atol=1e-9)

    return replace(RAMP, holds=holds)


def _wide() -> list[Row]:
    """Thousands of columns."""
    more = range(3, 1200)
    head = "Time [s];Position [mm];Load [N];" + ";".join(f"gauge {i} [V]" for i in more)
    rest = ";".join(f"{i % 97}.500000000000000000000000000" for i in more)
    rows = (
        f"{t:.5f};{x:.5f};{f:.5f};{rest}" for t, x, f in zip(TIME, DISPLACEMENT, FORCE, strict=True)
    )
    return [Row("lines of forty thousand characters", "\n".join([head, *rows, ""]).encode())]


COLUMNS = [*_units(), *_factors(), *_twice(), *_once(), *_shaken(), *_sizes(), *_wide()]
