"""Between which limits the stiffness of a solid is known."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TypedDict

import numpy as np

from dashpot.base.arrays import ByValue, FloatArray, Frozen, frozen, increasing, samples
from dashpot.base.documents import Documented
from dashpot.base.errors import DataError
from dashpot.base.facts import Fact
from dashpot.base.numbers import duration, interval, rounded
from dashpot.base.units import in_unit
from dashpot.records.frf import Kind
from dashpot.solids.maxwell import Solid

# naming the machine is worth a sentence if it leaves less than this part of the width
WORTH_NAMING = 0.8
#: a spectrum stands at 95 % if it leaves no more than that above the best, in squared noises
STANDS = 5.0


def naming(time: float, now: float, then: float) -> str:
    """Say what naming the machine gives; nothing where it is not worth a sentence.

    Parameters
    ----------
    time : float
        T, s.
    now, then : float
        95 % half widths of k(T), over its value; nan where it is not known.
    """
    if not then < WORTH_NAMING * now:
        return ""
    return (
        "Record a baseline of 10 s, and give the drift, compliance and creep of the machine: "
        f"k({duration(time)}) is then known to about {rounded(100 * then, digits=1)} % instead of "
        f"{rounded(100 * now, digits=2)} %."
    )


@dataclass(frozen=True)
class EndOfHold(Documented):
    r"""What a relaxation test knows of the stiffness when it ends, and what it leaves open.

    Limits over every non-negative spectrum that the test does not reject, of the relaxation
    function :math:`k(t) = k_\infty + \sum_j k_j e^{-t/\tau_j}`, N/m.

    Attributes
    ----------
    time : float
        T, the time that the seal was held, s; the longest of several tests.
    k_end, k_3end : (float, float)
        k(T) and k(3 T).
    k_inf : (float, float)
        Where it ends. An arm slower than the hold is a spring to the test, so the lower limit is 0.
    falling : float
        The steepest :math:`-dk/d\ln t` at T, N/m.
    beyond : float
        How far the fit's own k(T) lay outside its limits before they were widened to hold it, in
        their width; no document holds it.
    named : float
        Part of the width of k(T) that would be left if the drift, the compliance and the creep of
        the machine were named; nan where they are, or it was not asked.
    """

    keys = ("k_inf", "k_end", "k_3end", "time", "falling", "named")

    time: float
    k_end: tuple[float, float]
    k_3end: tuple[float, float]
    k_inf: tuple[float, float]
    falling: float
    beyond: float = field(default=0.0, repr=False, compare=False)
    named: float = field(default=math.nan, compare=False)

    @property
    def says(self) -> str:
        """What is known at the end of the hold, what is not, and what would tell more."""
        low, high = (in_unit(end, "N/mm") for end in self.k_end)
        most = rounded(in_unit(self.k_inf[1], "N/mm"), (high - low) / 4)
        return (
            f"the stiffness after the hold. At {rounded(self.time)} s it is {interval(low, high)} "
            f"N/mm; it may fall further, and ends at {most} N/mm or below. {self.remedy}"
        )

    @property
    def remedy(self) -> str:
        """What would tell more of it, and how much."""
        return self.naming or "Hold longer."

    @property
    def naming(self) -> str:
        """What naming the machine would give, in a sentence; nothing where that is little."""
        low, high = self.k_end
        if not low + high > 0:
            return ""
        half = (high - low) / (high + low)
        return naming(self.time, half, self.named * half)

    def fact(self, solid: Solid, unit: str) -> Fact:
        """The stiffness of a solid at the end of the hold, between these limits."""
        words = f"k({duration(self.time)})"
        return Fact("k_end", float(solid.relaxation(self.time)), *self.k_end, unit, words=words)

    def __mul__(self, count: float) -> EndOfHold:
        """So many parts side by side."""

        def scaled(ends: tuple[float, float]) -> tuple[float, float]:
            return count * ends[0], count * ends[1]

        return EndOfHold(
            self.time,
            scaled(self.k_end),
            scaled(self.k_3end),
            scaled(self.k_inf),
            count * self.falling,
            self.beyond,
            self.named,
        )


class LeftOpen(TypedDict):
    """Limits of stiffnesses, N/m, over every spectrum that the tests do not reject."""

    k_inf: tuple[float, float]
    k_end: tuple[float, float]
    k_3end: tuple[float, float]


@dataclass(frozen=True, eq=False)
class StiffnessBounds(ByValue):
    """Lower and upper limits of the dynamic stiffness against frequency.

    Attributes
    ----------
    frequency : array, shape (n,)
        Hz, increasing.
    storage, loss : array, shape (2, n)
        Lowest and highest storage and loss stiffness at each frequency, N/m.
    loss_factor : array, shape (2, n)
        Lowest and highest loss factor, dimensionless.
    says : str
        What the limits hold for, in one sentence.
    """

    frequency: FloatArray
    storage: FloatArray
    loss: FloatArray
    loss_factor: FloatArray
    says: str = ""

    def __post_init__(self) -> None:
        frequency = increasing("frequency", samples("frequency", self.frequency))
        object.__setattr__(self, "frequency", frequency)
        for name in ("storage", "loss", "loss_factor"):
            limits = np.asarray(getattr(self, name), dtype=float)
            if limits.shape != (2, len(frequency)):
                raise DataError(
                    f"{name} has shape {limits.shape}; expected (2, {len(frequency)}): "
                    "a lower and an upper limit at each frequency"
                )
            if not (limits[0] <= limits[1]).all():
                raise DataError(f"the lower limit of {name} lies above its upper limit")
            object.__setattr__(self, name, frozen(limits))


@dataclass(frozen=True, eq=False)
class FRFBounds(Frozen):
    """Between which limits the response of a mass on a seal is predicted.

    Attributes
    ----------
    frequency : array, shape (n,)
        Hz.
    magnitude : array, shape (n,)
        Of the predicted accelerance, 1/kg, or transmissibility.
    parameter : array, shape (2, n)
        Lowest and highest magnitude that the standard errors of the fit allow.
    unseen : array, shape (2, n)
        Lowest and highest magnitude over all non-negative spectra that the relaxation tests
        do not reject; infinite, unlimited, where one of them resonates there without loss.
    says : str
    peak_frequency : (float, float) or None
        Where one of them may resonate, Hz; an upper end of infinity if nothing limits it. None if
        it was not sought or not found.
    peak_height : (float, float) or None
        Between which limits the largest magnitude lies; the upper one may be infinite.
    kind : Kind
        Accelerance or transmissibility.
    """

    frequency: FloatArray
    magnitude: FloatArray
    parameter: FloatArray
    unseen: FloatArray
    says: str = ""
    peak_frequency: tuple[float, float] | None = None
    peak_height: tuple[float, float] | None = None
    kind: Kind = Kind.ACCELERANCE

    @property
    def peak_says(self) -> str:
        """Where and how high the test allows the peak to be, in words."""
        if self.peak_frequency is None:
            return "No model that the relaxation test allows has a resonance."
        low, high = self.peak_frequency
        most = "Hz and above" if math.isinf(high) else f"to {rounded(high, digits=3)} Hz"
        where = f"The relaxation test alone limits the resonance to {rounded(low, digits=3)} {most}"
        if self.peak_height is None:
            return f"{where}."
        low, high = self.peak_height
        unit = " 1/kg" if self.kind is Kind.ACCELERANCE else " m/m"
        most = f"{unit} and above" if math.isinf(high) else f" to {rounded(high)}{unit}"
        return f"{where}, and the peak to {rounded(low)}{most}."
