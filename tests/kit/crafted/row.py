"""One row of the table of crafted files, and the truths that such files hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np

from dashpot.datamodel.frf import Kind
from dashpot.extensions.amplitude.read import read_amplitude
from dashpot.extensions.curves.creep.read import read_creep
from dashpot.extensions.curves.dynamic.read import read_dynamic
from dashpot.extensions.curves.modulus.read import read_modulus
from dashpot.extensions.materials.cld.read import read_cld
from dashpot.extensions.materials.hyperelastic.read import read_stress_strain
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.frf import read_frf
from dashpot.reading.readers.impact import read_impact
from dashpot.reading.readers.relaxation import read_relaxation
from kit.look_alikes import truth

Outcome: TypeAlias = Literal["right", "noted", "asked", "refused"]


@dataclass(frozen=True)
class Truth:
    """What a file holds: the kind that is seen, who reads it, and what must have been read."""

    kind: str
    read: Callable[..., Any]
    holds: Callable[[Any, Row], None]


@dataclass(frozen=True)
class Row:
    """A file, and what must come of it.

    Attributes
    ----------
    outcome : str
        ``"right"``: its truth is read. ``"noted"``: so, and the notes say these words. ``"asked"``:
        it is refused with these words, and its truth is read with the answer. ``"refused"``: with
        these words.
    without : tuple of int
        Rows of the truth that are left out.
    answer : dict
        The options with which a file that is asked about is read right.
    coarse : float
        How far the force, N, may be from the truth, for the digits printed.
    extra : int
        Rows at the end that are no truth, which the note is about.
    slow : float
        How much longer the record lasts.
    by_size : bool
        The question is about a size, which the reader asks and no inspection.
    """

    name: str
    content: bytes
    outcome: Outcome = "right"
    message: tuple[str, ...] = ()
    truth: Truth = field(default_factory=lambda: RAMP)
    without: tuple[int, ...] = ()
    answer: dict[str, Any] = field(default_factory=dict)
    coarse: float = 1e-9
    extra: int = 0
    slow: float = 1.0
    by_size: bool = False

    def read(self, path: Path, **options: Any) -> Any:
        """The record in the file."""
        return self.truth.read(path, options=ReadOptions(**options))


def _ramp(test: Any, row: Row) -> None:
    stop = len(test.time) - row.extra
    keep = np.setdiff1d(np.arange(len(truth()[0])), row.without)
    time, displacement, force = (values[keep] for values in truth())
    np.testing.assert_allclose(test.time[:stop] - test.time[0], row.slow * time, atol=1e-6)
    np.testing.assert_allclose(test.displacement[:stop], displacement * 1e-3, atol=1e-9)
    np.testing.assert_allclose(test.force[:stop], force, atol=row.coarse)


RAMP = Truth("relaxation", read_relaxation, _ramp)
"""The look-alikes' ramp and hold."""

F = np.round(np.geomspace(0.1, 100, 13), 6)
STORAGE, LOSS = 6e6 * F**0.1, 8e5 * F**0.12
TANGENT = LOSS / STORAGE
STRAIN = np.geomspace(1e-4, 5e-2, 12)
SOFT, LOST = 6e6 / (1 + (STRAIN / 0.01)), 5e5 + 0 * STRAIN
WARMTH = (0.0, 23.0)
"""degC; of the colder sweep the moduli are twice as large."""
COLD = 2.0


def _sweep(test: Any, row: Row) -> None:
    np.testing.assert_allclose(test.frequency, F, rtol=1e-5)
    np.testing.assert_allclose(test.storage, STORAGE, rtol=1e-5)
    np.testing.assert_allclose(test.loss, LOSS, rtol=1e-5)


SWEEP = Truth("dma", read_dynamic, _sweep)
"""Thirteen frequencies of one modulus."""


def _isotherms(test: Any, row: Row) -> None:
    assert test.temperature is not None
    for degree, factor in zip(WARMTH, (COLD, 1.0), strict=True):
        at = np.abs(test.temperature - 273.15 - degree) < 1.0
        np.testing.assert_allclose(test.frequency[at], F, rtol=1e-5)
        np.testing.assert_allclose(test.storage[at], factor * STORAGE, rtol=1e-5)
        np.testing.assert_allclose(test.loss[at], factor * LOSS, rtol=1e-5)


ISOTHERMS = Truth("dma", read_dynamic, _isotherms)
"""Two such sweeps, at 0 and at 23 degC."""


def _amplitudes(test: Any, row: Row) -> None:
    np.testing.assert_allclose(test.amplitude, STRAIN, rtol=1e-5)
    np.testing.assert_allclose(test.storage, SOFT, rtol=1e-5)
    np.testing.assert_allclose(test.loss, LOST, rtol=1e-5)


AMPLITUDES = Truth("strain-sweep", read_amplitude, _amplitudes)
"""A modulus that falls with the strain."""

LINES = np.arange(4.0, 40.0, 0.5)
OVER_BASE = (1 + 0.06j * LINES / 12.7) / (1 + 0.06j * LINES / 12.7 - (LINES / 12.7) ** 2)
OVER_FORCE = -((2 * np.pi * LINES) ** 2) / (640 - 0.104 * (2 * np.pi * LINES) ** 2 + 40j)


def _lines(kind: Kind, value: np.ndarray) -> Callable[[Any, Row], None]:
    def holds(frf: Any, row: Row) -> None:
        assert frf.quantity is kind
        np.testing.assert_allclose(frf.frequency, LINES, rtol=1e-5)
        np.testing.assert_allclose(frf.value, value, rtol=1e-5)

    return holds


ACCELERANCE = Truth("frf", read_frf, _lines(Kind.ACCELERANCE, OVER_FORCE))
"""A block on a seal, per newton."""
TRANSMISSIBILITY = Truth("transmissibility", read_frf, _lines(Kind.TRANSMISSIBILITY, OVER_BASE))
"""The block over a base that is shaken."""

DECAY = np.geomspace(0.01, 1e3, 40)


def _curve(curve: Any, row: Row) -> None:
    np.testing.assert_allclose(curve.time, DECAY, rtol=1e-5)
    np.testing.assert_allclose(curve.modulus, 1e6 * (2 + DECAY**-0.1), rtol=1e-5)


MODULUS = Truth("modulus", read_modulus, _curve)

CLOCK = np.arange(0.0, 60.0, 0.2)
CREPT = 0.4 + 0.2 * (1 - np.exp(-CLOCK / 9))


def _crept(test: Any, row: Row) -> None:
    np.testing.assert_allclose(test.time, CLOCK, atol=1e-6)
    np.testing.assert_allclose(test.displacement, 1e-2 * CREPT, atol=1e-7)
    np.testing.assert_allclose(test.force, 1e5, rtol=1e-5)


CREEP = Truth("creep", read_creep, _crept)
"""A strain, %, that goes on under 0.1 MPa."""


def _check_compliance(curve: Any, row: Row) -> None:
    np.testing.assert_allclose(curve.time, CLOCK[1:], atol=1e-6)
    np.testing.assert_allclose(curve.compliance, 1e-6 * CREPT[1:], rtol=1e-5)


COMPLIANCE = Truth("creep", read_creep, _check_compliance)
"""A compliance, 1/MPa, over time."""

PULLED = np.linspace(0.0, 1.5, 40)


def read_tension(path: Path, *, options: ReadOptions) -> Any:
    return read_stress_strain(path, "uniaxial", options=options)


def _check_stress(test: Any, row: Row) -> None:
    np.testing.assert_allclose(test.stretch, 1 + PULLED, rtol=1e-5)
    np.testing.assert_allclose(test.stress, 1e6 * PULLED**0.8, rtol=1e-5)


TENSION = Truth("stress-strain", read_tension, _check_stress)
"""A strip drawn to two and a half times its length."""

PRESSED = np.concatenate([np.linspace(0, 8, 60), np.linspace(8, 0, 60)[1:]])


def _check_force(test: Any, row: Row) -> None:
    np.testing.assert_allclose(test.displacement, 1e-3 * PRESSED, atol=1e-7)
    np.testing.assert_allclose(test.force, 0.2 * PRESSED, atol=1e-5)


DEFLECTION = Truth("cld", read_cld, _check_force)

TICKS = np.arange(2048) / 1024
HIT = np.where(np.abs(TICKS - 0.1) < 0.004, 20 * np.cos(np.pi * (TICKS - 0.1) / 0.008), 0.0)
RUNG = np.where(TICKS > 0.1, 30 * np.exp(-3 * (TICKS - 0.1)) * np.sin(80 * (TICKS - 0.1)), 0.0)


def _hit(test: Any, row: Row) -> None:
    np.testing.assert_allclose(test.force, HIT, atol=1e-5)
    np.testing.assert_allclose(test.acceleration, [RUNG], atol=1e-5)


HITS = Truth("impact", read_impact, _hit)
"""A hammer and what rings on."""


def table(
    head: str, *columns: np.ndarray, sign: str = ";", form: str = "%.8g", comma: bool = False,
    quote: bool = False, end: str = "\n", lead: str = "",
) -> str:  # fmt: skip
    """A file of columns under a head."""
    rows = []
    for values in zip(*columns, strict=True):
        cells = [v if isinstance(v, str) else form % v for v in values]
        cells = [c.replace(".", ",") for c in cells] if comma else cells
        cells = [f'"{c}"' for c in cells] if quote else cells
        rows.append(lead + sign.join(cells))
    return end.join([*head.split("\n"), *rows]) + end
