"""Limits of a solid's stiffness over frequency, and its relative errors in the valid band."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal, TypeAlias, TypedDict

import numpy as np

from dashpot.base import dataclass, field, replace
from dashpot.base.arrays import (
    EqualByValue,
    FloatArray,
    FrozenArrays,
    make_readonly_copy,
    require_increasing,
    validate_samples,
)
from dashpot.base.errors import DataError
from dashpot.base.number_format import duration, interval, round_to_error
from dashpot.base.reported_values import ReportedValue
from dashpot.base.serialisation import EVERY_FIELD, Key, Serialisable
from dashpot.base.units import convert_to_unit, get_display_unit
from dashpot.datamodel.frf import Kind
from dashpot.solids.maxwell import Solid

# Limits of the stiffness of a solid.


# Ratio of the widths of the limits, with over without a stated machine, below which a remark
# advises to state it.
MAX_NAMED_WIDTH_RATIO = 0.8
#: a spectrum stands at 95 % if it leaves no more than that above the best, in squared noises
MAX_DEVIANCE = 5.0


def naming(time: float, now: float, then: float) -> str:
    """Return the gain by naming the machine, as a sentence; empty where it is small.

    Parameters
    ----------
    time : float
        T, s.
    now, then : float
        95 % half widths of k(T), over its value; nan where it is not known.
    """
    if not then < MAX_NAMED_WIDTH_RATIO * now:
        return ""
    return (
        "Record a baseline of 10 s, and give the drift, compliance and creep of the machine and "
        "the rest time of the seal before the test: "
        f"k({duration(time)}) is then known to about {round_to_error(100 * then, digits=1)} % "
        f"instead of {round_to_error(100 * now, digits=2)} %."
    )


# Kind of test, and what would extend it.
Ended: TypeAlias = Literal["hold", "curve", "sweep", "creep", "frf"]
_MORE_DATA: Mapping[str, str] = MappingProxyType({
    "hold": "Hold longer.",
    "curve": "Measure longer.",
    "sweep": "Sweep to lower frequencies, or fit a relaxation test beside it.",
    "creep": "Hold the load longer.",
    "frf": "Fit a relaxation test beside it.",
})  # fmt: skip
_UNKNOWN = (math.nan, math.nan)


@dataclass(frozen=True)
class EndOfHold(Serialisable):
    r"""Stiffness at the end of a test, with its limits.

    Limits over every non-negative spectrum that the test does not reject, N/m, or Pa of a material.
    Of a hold or a curve they are of the relaxation function
    :math:`k(t) = k_\infty + \sum_j k_j e^{-t/\tau_j}`; of a sweep or an FRF of the storage
    :math:`K'(1/t)`, of creep of force over displacement 1/J(t) after a step of force.

    Attributes
    ----------
    end_time : float
        T, the time that the seal was held, s; the longest of several tests. Of a sweep or an FRF
        1/omega of its lowest line.
    k_end, k_3end : (float, float)
        k(T) and k(3 T).
    k_inf : (float, float)
        Limits of k_inf. An arm slower than the hold is a spring to the test, so the lower limit is
        0.
    slope_limit : float
        The steepest :math:`-dk/d\ln t` at T; nan but of a hold.
    distance_outside : float
        Distance of the fit's own k(T) from its limits before they were widened to contain it, in
        units of their width; not saved.
    if_machine_named : float
        Part of the width of k(T) that would be left if the drift, the compliance and the creep of
        the machine were named; nan where they are, or it was not asked.
    k_10end : (float, float)
        k(10 T); nan of a hold, whose drift hides it.
    test_kind : str
        ``"hold"``, ``"curve"``, ``"sweep"``, ``"creep"`` or, of a hammer alone, ``"frf"``.
    """

    _keys = (
        "k_inf",
        "k_end",
        Key("k_at_3_end", "k_3end"),
        "end_time",
        "slope_limit",
        "if_machine_named",
        Key("k_at_10_end", "k_10end"),
        "test_kind",
    )

    end_time: float
    k_end: tuple[float, float]
    k_3end: tuple[float, float]
    k_inf: tuple[float, float]
    slope_limit: float = field(default=math.nan, compare=False)
    distance_outside: float = field(default=0.0, repr=False, compare=False)
    if_machine_named: float = field(default=math.nan, compare=False)
    k_10end: tuple[float, float] = field(default=_UNKNOWN, compare=False)
    test_kind: Ended = "hold"

    def compute_stiffness(self, solid: Solid, times: float = 1.0) -> float:
        """Return the stiffness of a solid that the limits bound, at `times` T."""
        t = times * self.end_time
        if self.is_frequency:
            return float(solid.complex_stiffness(omega=1 / t).real)
        if self.test_kind == "creep":
            return 1 / float(solid.creep(t))
        return float(solid.relaxation(t))

    def widen_to_contain(self, solid: Solid) -> EndOfHold:
        """Return the limits, widened to contain the values of a fit."""
        (low, high), stiffness = self.k_end, self.compute_stiffness(solid)
        overshoot = max(low - stiffness, stiffness - high, 0.0)
        return replace(
            self,
            k_end=_widen_to_contain(self.k_end, stiffness),
            k_3end=_widen_to_contain(self.k_3end, self.compute_stiffness(solid, 3)),
            k_10end=_widen_to_contain(self.k_10end, self.compute_stiffness(solid, 10)),
            k_inf=(0.0, _widen_to_contain(self.k_inf, solid.k_inf)[1]),
            distance_outside=max(self.distance_outside, overshoot / max(high - low, 1e-300)),
        )

    @property
    def is_frequency(self) -> bool:
        """Whether it is the lowest frequency that the test ends at, and not a time."""
        return self.test_kind in {"sweep", "frf"}

    def widen(self, part: float) -> EndOfHold:
        """Return the limits, each moved outwards by a part of itself."""

        def wider(limits: tuple[float, float]) -> tuple[float, float]:
            low, high = limits
            return max(low * (1 - part), 0.0), high * (1 + part)

        return replace(
            self,
            k_end=wider(self.k_end),
            k_3end=wider(self.k_3end),
            k_10end=_UNKNOWN if math.isnan(self.k_10end[0]) else wider(self.k_10end),
            k_inf=wider(self.k_inf),
        )

    @property
    def levels(self) -> float:
        """Lowest k(10 T) over highest k(T): 1 of a plateau that is known."""
        return self.k_10end[0] / max(self.k_end[1], 1e-300)

    def format_with_remedy(self, unit: str) -> str:
        """Return the limits at the end of the test and a remedy, as text; `unit` of stiffness."""
        subject = self._subject(unit)
        when_text = {
            "hold": "after the hold", "sweep": "below the sweep", "frf": "below the band",
        }.get(self.test_kind, "later on")  # fmt: skip
        return f"{subject} {when_text}. {self._limits(unit, 'it')}. {self.remedy}"

    def format_limits(self, unit: str) -> str:
        """Return the limits at the end of the test, in two sentences."""
        return self._limits(unit, self._subject(unit))

    def _limits(self, unit: str, subject: str) -> str:
        display_unit = get_display_unit(unit)
        low, high = (convert_to_unit(end, display_unit) for end in self.k_end)
        text, width = "", high - low
        if not math.isnan(self.k_10end[0]):
            later_limits = [convert_to_unit(end, display_unit) for end in self.k_10end]
            text = f", at {self._format_end(10)} {interval(*later_limits)} {display_unit}"
            width = later_limits[1] - later_limits[0]
        upper_text = round_to_error(convert_to_unit(self.k_inf[1], display_unit), width / 2)
        return (
            f"At {self._format_end(1)} {subject} is {interval(low, high)} {display_unit}{text}. It "
            f"may fall further, to at most {upper_text} {display_unit}"
        )

    def _format_end(self, times: float) -> str:
        """Return `times` T, or its frequency, as text."""
        t = times * self.end_time
        return (
            f"{round_to_error(1 / (2 * math.pi * t))} Hz"
            if self.is_frequency
            else f"{round_to_error(t)} s"
        )

    def _subject(self, unit: str) -> str:
        of_material = unit == "Pa"
        if self.is_frequency:
            return "the storage" if self.test_kind == "sweep" else "the storage stiffness"
        if self.test_kind == "creep":
            return "stress over strain" if of_material else "force over displacement"
        return "the modulus" if of_material else "the stiffness"

    @property
    def remedy(self) -> str:
        """Remedy that would narrow the limits, and by how much."""
        return self.naming or _MORE_DATA[self.test_kind]

    @property
    def naming(self) -> str:
        """Gain by naming the machine, as a sentence; empty where it is small."""
        low, high = self.k_end
        if not low + high > 0:
            return ""
        relative_half_width = (high - low) / (high + low)
        return naming(
            self.end_time, relative_half_width, self.if_machine_named * relative_half_width
        )

    def fact(self, solid: Solid, unit: str) -> ReportedValue:
        """Return the stiffness of a solid at the end of the test, between these limits."""
        condition = self._format_end(1) if self.is_frequency else duration(self.end_time)
        symbol = "K'" if self.is_frequency else {"creep": "1/J"}.get(self.test_kind, "k")
        return ReportedValue(
            "k_end",
            self.compute_stiffness(solid),
            *self.k_end,
            unit,
            words=f"{symbol}({condition})",
        )

    def __mul__(self, count: float) -> EndOfHold:
        """Return the limits of `count` parts in parallel."""

        def scale_ends(pair: tuple[float, float]) -> tuple[float, float]:
            return count * pair[0], count * pair[1]

        return replace(
            self,
            k_end=scale_ends(self.k_end),
            k_3end=scale_ends(self.k_3end),
            k_10end=scale_ends(self.k_10end),
            k_inf=scale_ends(self.k_inf),
            slope_limit=count * self.slope_limit,
        )


def _widen_to_contain(limits: tuple[float, float], value: float) -> tuple[float, float]:
    """Return limits widened to contain a value that lies beyond one, by as much again."""
    low, high = limits
    return limits if math.isnan(low) else (min(low, 2 * value - low), max(high, 2 * value - high))


class StiffnessLimits(TypedDict):
    """Limits of stiffnesses, N/m, over every spectrum that the tests do not reject."""

    k_inf: tuple[float, float]
    k_end: tuple[float, float]
    k_3end: tuple[float, float]


@dataclass(frozen=True, eq=False)
class StiffnessBounds(EqualByValue, Serialisable):
    """Lower and upper limits of the dynamic stiffness against frequency.

    Attributes
    ----------
    frequency : array, shape (n,)
        Hz, increasing.
    storage, loss : array, shape (2, n)
        Lowest and highest storage and loss stiffness at each frequency, N/m.
    loss_factor : array, shape (2, n)
        Lowest and highest loss factor, dimensionless.
    message : str
        Conditions of the limits, in one sentence.
    """

    _keys = (EVERY_FIELD, "message")

    frequency: FloatArray
    storage: FloatArray
    loss: FloatArray
    loss_factor: FloatArray
    message: str = ""

    def __post_init__(self) -> None:
        frequency = require_increasing("frequency", validate_samples("frequency", self.frequency))
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
            object.__setattr__(self, name, make_readonly_copy(limits))


@dataclass(frozen=True, eq=False)
class FRFBounds(FrozenArrays, Serialisable):
    """Limits of the predicted response of a mass on a seal.

    Attributes
    ----------
    frequency : array, shape (n,)
        Hz.
    magnitude : array, shape (n,)
        Limits of the magnitude of the predicted accelerance, 1/kg, or transmissibility.
    parameter : array, shape (2, n)
        Lowest and highest magnitude that the standard errors of the fit allow.
    unmeasured : array, shape (2, n)
        Lowest and highest magnitude over all non-negative spectra that the relaxation tests
        do not reject; infinite, unlimited, where one of them resonates there without loss.
    message : str
    peak_frequency : (float, float) or None
        Where one of them may resonate, Hz; an upper end of infinity if nothing limits it. None if
        it was not sought or not found.
    peak_height : (float, float) or None
        Between which limits the largest magnitude lies; the upper one may be infinite.
    kind : Kind
        Accelerance or transmissibility.
    """

    _keys = (EVERY_FIELD, "unmeasured", "message")

    frequency: FloatArray
    magnitude: FloatArray
    parameter: FloatArray
    unmeasured: FloatArray
    message: str = ""
    peak_frequency: tuple[float, float] | None = None
    peak_height: tuple[float, float] | None = None
    kind: Kind = Kind.ACCELERANCE

    @property
    def peak_text(self) -> str:
        """Limits of frequency and height of the peak, as text."""
        if self.peak_frequency is None:
            return "No model that the relaxation test allows has a resonance."
        low, high = self.peak_frequency
        end_text = "Hz and above" if math.isinf(high) else f"to {round_to_error(high, digits=3)} Hz"
        sentence = (
            "The relaxation test alone limits the resonance of a linear seal to "
            f"{round_to_error(low, digits=3)} {end_text}"
        )
        if self.peak_height is None:
            return f"{sentence}."
        low, high = self.peak_height
        unit = " 1/kg" if self.kind is Kind.ACCELERANCE else " m/m"
        end_text = f"{unit} and above" if math.isinf(high) else f" to {round_to_error(high)}{unit}"
        return f"{sentence}, and the peak to {round_to_error(low)}{end_text}."


# Errors of stiffness and loss factor at some frequencies.


#: relative error above which a loss factor counts as not determined
MAX_LOSS_FACTOR_ERROR = 0.3


@dataclass(frozen=True)
class BandError(Serialisable):
    r"""Relative 95 % errors of stiffness and loss factor at lines of the valid band.

    Of :math:`|K^*|` and :math:`\eta = K''/K'`, over every non-negative spectrum that the test does
    not reject, about the solid that was fitted: with limits :math:`v_l \le v \le v_u`,

    .. math:: e = \max(v_u/v,\; v/v_l) - 1

    so that the true value lies within e of the fitted one, relative to either.

    Attributes
    ----------
    frequency : tuple of float
        Hz, increasing.
    stiffness, loss_factor : tuple of float
        One a line; infinite where nothing limits it.
    misfit : (float, float)
        The largest relative errors of stiffness and of loss factor at the record's own lines in the
        band; 0 of a record without one.
    """

    _keys = ("frequency", "stiffness", "loss_factor", "misfit")

    frequency: tuple[float, ...]
    stiffness: tuple[float, ...]
    loss_factor: tuple[float, ...]
    misfit: tuple[float, float] = (0.0, 0.0)

    @property
    def max_errors(self) -> tuple[float, float]:
        """Largest error of stiffness and of loss factor, neither below what the lines show."""
        stiffness, loss_factor = self.misfit
        return max(*self.stiffness, stiffness), max(*self.loss_factor, loss_factor)

    def shift_to_temperature(self, a_t: float) -> BandError:
        """Return the errors at another temperature, whose relaxation times are `a_t` as long."""
        return replace(self, frequency=tuple(line / a_t for line in self.frequency))
