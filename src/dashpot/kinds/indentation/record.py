"""Dynamic indentation: a body of known mass hits a surface, and its motion is recorded."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from dashpot.base.arrays import ByValue, FloatArray, hold_measured, median
from dashpot.base.checks import Check
from dashpot.base.demands import positive
from dashpot.base.errors import DataError
from dashpot.base.facts import Fact, Numbered
from dashpot.base.offered import Described
from dashpot.base.options import option
from dashpot.base.plausible import SIZES
from dashpot.base.provenance import Source, of_file
from dashpot.base.units import GRAVITY, si_fields
from dashpot.kinds.indentation.contact_law import ContactLaw

Motion: TypeAlias = Literal["acceleration", "velocity", "displacement", "force"]
UNITS: dict[str, str] = {
    "acceleration": "m/s^2", "velocity": "m/s", "displacement": "m", "force": "N",
}  # fmt: skip


@dataclass(frozen=True)
class Indenter:
    """The body that hits; each number may be given with its unit, ``"5g"``.

    Attributes
    ----------
    mass : float or None
        kg; all that moves with the indenter.
    radius : float or None
        Of its spherical tip, m.
    drop_height : float or None
        From rest to the surface, m: it falls, and gravity pulls on.
    impact_velocity : float or None
        Of approach, m/s, where something else measured it.
    """

    mass: float | None = option(None, "Of all that moves with the indenter, e.g. 5g.", unit="mass")
    radius: float | None = option(None, "Of its spherical tip, e.g. 2.5mm.", unit="length")
    drop_height: float | None = option(
        None, "From rest to the surface, e.g. 50mm: it falls.", unit="length"
    )
    impact_velocity: float | None = option(
        None, "Of approach, measured apart, e.g. 1m/s.", unit="velocity"
    )

    def __post_init__(self) -> None:
        si_fields(self)
        positive(**vars(self), expected="a number > 0 in SI units", optional=True)
        SIZES["mass"].refuse(self.mass or 0.0)
        SIZES["radius"].refuse(self.radius or 0.0)

    @property
    def pull(self) -> float:
        """Acceleration besides the contact's, m/s^2: gravity for a fall."""
        return GRAVITY if self.drop_height is not None else 0.0

    @property
    def stated_velocity(self) -> float | None:
        """Of approach as it was said, or as a free fall from that height has it, m/s."""
        if self.impact_velocity is not None or self.drop_height is None:
            return self.impact_velocity
        return math.sqrt(2 * GRAVITY * self.drop_height)


@dataclass(frozen=True, eq=False, repr=False)
class IndentationTest(ByValue, Described):
    """The motion of an indenter through one contact or several, in SI units.

    Attributes
    ----------
    time : array, shape (n,)
        s, evenly spaced.
    signal : array, shape (n,)
        In the unit of `of`; its sign as recorded.
    of : str
        ``"acceleration"``, ``"velocity"``, ``"displacement"`` or ``"force"``.
    indenter : Indenter
    force : array, shape (n,), or None
        Recorded beside a motion, N.
    source : Source or None

    Raises
    ------
    DataError
        If the arrays differ in length, hold fewer than 16 samples, are not finite, or sampling is
        not even.
    """

    time: FloatArray
    signal: FloatArray
    of: Motion
    indenter: Indenter
    force: FloatArray | None = None
    source: Source | None = None

    def __post_init__(self) -> None:
        hold_measured(self, "time", "signal", "force", minimum=16)
        if self.of not in UNITS:
            raise DataError(f"of = '{self.of}'; expected one of {', '.join(UNITS)}")
        steps = np.diff(self.time)
        worst = int(np.argmax(np.abs(steps - self.step)))
        if abs(steps[worst] - self.step) > 0.2 * self.step:
            raise DataError(
                f"a contact needs even sampling, but the step after t = {self.time[worst]:.9g} s "
                f"is {steps[worst]:.6g} s where {self.step:.6g} s is usual; cut the record there"
            )

    @property
    def step(self) -> float:
        """Between two samples, s."""
        return median(np.diff(self.time))

    @property
    def described(self) -> tuple[str, ...]:
        """Which record it is, and what was recorded."""
        return (
            of_file(self.source, len(self.time)),
            (
                f"{self.of} of an indenter at {1 / self.step:.6g} Hz, to "
                f"{np.abs(self.signal).max():.4g} {UNITS[self.of]}"
            ),
        )


@dataclass(frozen=True, eq=False, repr=False)
class IndentationFit(ByValue, Described, Numbered):
    """What one contact says of a surface.

    Attributes
    ----------
    law : str
        ``"kelvin-voigt"``, ``"hertz"``, ``"hertz-kelvin-voigt"`` or ``"hertz-maxwell"``.
    contact : ContactLaw
    found : tuple of Fact
        The law's parameters, then what follows: modulus, restitution, and what the body did.
    orders : tuple of (str, float)
        BIC of each law that was tried; the smallest is best.
    indenter : Indenter
    of : str
        What was recorded.
    time, measured, modelled : array, shape (n,)
        s from the touch; the record about the contact, its sign that of a push from the surface,
        offset and drift taken off; and the law's.
    noise : float
        Rms of what is left in flight, in the record's unit.
    residual : float
        Rms of what is left in contact, over the largest of the record.
    touch, duration : float
        Time of the first touch in the record, and length of the contact, s.
    checks : tuple of Check
    source : Source or None
    """

    law: str
    contact: ContactLaw
    found: tuple[Fact, ...]
    orders: tuple[tuple[str, float], ...]
    indenter: Indenter
    of: str
    time: FloatArray
    measured: FloatArray
    modelled: FloatArray
    noise: float
    residual: float
    touch: float
    duration: float
    checks: tuple[Check, ...] = ()
    source: Source | None = None

    @property
    def described(self) -> tuple[str, ...]:
        """The verdict, the law and its numbers."""
        judged = self.verdict
        return (
            f"{judged.use}: {judged.says}",
            f"law: {self.law}",
            *(one.says for one in self.found),
        )
