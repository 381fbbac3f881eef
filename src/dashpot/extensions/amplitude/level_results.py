"""Results of FRFs at several amplitudes: the solid and its friction."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple, NoReturn, TypeAlias, overload

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, field, replace
from dashpot.base.arrays import BoolArray, ComplexArray, EqualByValue, FloatArray
from dashpot.base.checks import Check, HasChecks
from dashpot.base.errors import ExportError, ReadError
from dashpot.base.number_format import format_count
from dashpot.base.provenance import Source, Step
from dashpot.base.reported_values import ReportedValue
from dashpot.base.result_mixins import HasSummary, Series
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import Quantity, convert_to_unit, format_quantity
from dashpot.datamodel.specimen import Specimen
from dashpot.solids.jenkins import Jenkins
from dashpot.solids.maxwell import GeneralizedMaxwell, angular
from dashpot.solids.nonlinear_springs import Cubic
from dashpot.solids.rate_independent import InParallel, RateIndependent

Elements: TypeAlias = tuple[RateIndependent, ...]
"""Elements in parallel with a solid: sliders and a cubic spring."""
Parts: TypeAlias = tuple[GeneralizedMaxwell, Elements]
"""A solid, and its parallel elements."""


@dataclass(frozen=True)
class PeakAtLevel:
    """Resonance of a mass at a requested level.

    Attributes
    ----------
    level : float
        Amplitude of the force, N.
    frequency, receptance : float
        Frequency and receptance of the largest motion, Hz, and that motion over the force, m/N.
    frequency_interval, receptance_interval : (float, float)
        95 %.
    amplitude : float
        Amplitude of the seal's displacement there, m.
    """

    level: float
    frequency: float
    receptance: float
    frequency_interval: tuple[float, float]
    receptance_interval: tuple[float, float]
    amplitude: float

    @property
    def facts(self) -> tuple[ReportedValue, ReportedValue]:
        """Frequency of the largest motion, and its height per force."""
        level_text = f"at {self.level:.4g} N"
        return (
            ReportedValue(f"peak {level_text}", self.frequency, *self.frequency_interval, "Hz"),
            ReportedValue(
                f"motion {level_text}", self.receptance, *self.receptance_interval, "m/N"
            ),
        )


class CubicSpringEstimate(NamedTuple):
    """Cubic spring, N/m^3, with its 95 % interval."""

    k3: float
    interval: tuple[float, float]


@dataclass(frozen=True, eq=False, repr=False)
class LevelFit(EqualByValue, HasSummary, HasChecks, Serialisable):
    """Arms, sliders and cubic spring of one seal, fitted to its FRFs at several amplitudes.

    Attributes
    ----------
    solid : GeneralizedMaxwell
        Part that does not depend on the level; its single arms mean little beyond the band.
    rate_independent : tuple of Jenkins or Cubic
        Elements in parallel: friction, as a spectrum over yield displacements, and a stiffening or
        softening spring; empty if none was detected.
    amplitudes : (float, float)
        Range of displacement amplitudes of the seal that the lines cover, m.
    band : (float, float)
        Hz.
    residual : float
        Relative rms residual of F/X over all lines.
    linear_residual : float
        As `residual`, of arms alone.
    draws : tuple of (GeneralizedMaxwell, tuple of Jenkins or Cubic)
        Fits to simulated repetitions of the records: they give the uncertainty of every quantity
        that follows from the solid and its parallel elements. None if read from a file.
    mass : float
        On all seals, kg.
    seals : float
    levels : tuple of float
        Amplitude of the force at each FRF, N; over a base that moves, of its acceleration, m/s^2.
    checks : tuple of Check
    source : tuple of Source
    orders : tuple of (str, float)
        2 ln L of each explanation that was tried, over arms alone.
    specimen : Specimen
    steps : tuple of Step
        Later steps.
    peaks : tuple of PeakAtLevel
        The levels that were requested.
    """

    schema = "dashpot/levels@2"
    _keys = (
        "amplitudes",
        "verdict",
        "checks",
        "residual",
        "mass",
        "seals",
        Key("band_hz", "band"),
        "linear_residual",
        Key("model", "solid"),
        "sliders",
        "cubic",
        Key("orders", "two_ln_l"),
        "levels",
        "source",
        "peaks",
    )

    solid: GeneralizedMaxwell
    rate_independent: Elements
    amplitudes: tuple[float, float]
    band: tuple[float, float]
    residual: float
    linear_residual: float
    draws: tuple[Parts, ...]
    mass: float
    seals: float = 1.0
    levels: tuple[float, ...] = ()
    checks: tuple[Check, ...] = ()
    source: tuple[Source, ...] = ()
    orders: tuple[tuple[str, float], ...] = ()
    specimen: Specimen = field(default_factory=Specimen)
    steps: tuple[Step, ...] = ()
    peaks: tuple[PeakAtLevel, ...] = ()

    @property
    def _table_columns(self) -> Series:
        """Columns of the elements in parallel: spring, arms, sliders and a cubic spring."""
        no, solid = math.nan, self.solid
        arms = zip(solid.k, solid.tau, strict=True)
        rows = [
            ("k_inf", solid.k_inf, no, no, no),
            *((f"arm {j}", k, tau, no, no) for j, (k, tau) in enumerate(arms, 1)),
            *(
                (f"slider {j}", slider.k, no, slider.yields_at, no)
                for j, slider in enumerate(self.sliders, 1)
            ),
            *[("cubic", no, no, no, self.k3)] * bool(self.k3),
        ]
        units = {"element": "", "k": "N/m", "tau": "s", "yields_at": "m", "k3": "N/m^3"}
        pairs = zip(units.items(), zip(*rows, strict=True), strict=True)
        return {name: (list(values), unit) for (name, unit), values in pairs}

    @property
    def _has_digest(self) -> bool:
        """Whether its document shows that it was edited."""
        return True

    @property
    def sliders(self) -> tuple[Jenkins, ...]:
        """The friction in parallel to the solid."""
        return tuple(element for element in self.rate_independent if isinstance(element, Jenkins))

    @property
    def k3(self) -> float:
        """Coefficient of the cubic spring parallel to the solid, N/m^3; 0 without one."""
        return _k3(self.solid, self.rate_independent)

    @property
    def k3_interval(self) -> tuple[float, float]:
        """95 %, N/m^3."""
        low, high = self.interval(_k3).tolist()
        return low, high

    @property
    def cubic(self) -> CubicSpringEstimate | None:
        """The cubic spring, where there is one."""
        return CubicSpringEstimate(self.k3, self.k3_interval) if self.k3 else None

    @property
    def two_ln_l(self) -> dict[str, float]:
        """`orders` by their names."""
        return dict(self.orders)

    @overload
    def stiffness(
        self, *, amplitude: npt.ArrayLike, frequency: Quantity | npt.ArrayLike
    ) -> ComplexArray: ...
    @overload
    def stiffness(self, *, amplitude: npt.ArrayLike, omega: npt.ArrayLike) -> ComplexArray: ...
    def stiffness(
        self, *positional: object, amplitude: Any = None, frequency: Any = None, omega: Any = None
    ) -> ComplexArray:
        """Return complex stiffness of one seal, N/m, at amplitudes, m, and Hz or rad/s."""
        angular_frequency = angular(*positional, frequency=frequency, omega=omega)
        return InParallel((self.solid, *self.rate_independent)).equivalent(
            angular_frequency, amplitude
        )

    def interval(
        self, function: Callable[[GeneralizedMaxwell, Elements], npt.ArrayLike]
    ) -> FloatArray:
        """95 % interval of a quantity of the solid and its parallel parts (basic bootstrap).

        The fit leans to the side on which its draws lean: they are reflected about it. Shape
        (2,) of a number, (2, n) of several; not known, NaN, without draws.
        """
        best_values = np.asarray(function(self.solid, self.rate_independent))
        if not self.draws:
            return np.full((2, *best_values.shape), np.nan)
        drawn_values = np.array([np.asarray(function(*draw), dtype=float) for draw in self.draws])
        return np.asarray(2 * best_values - np.quantile(drawn_values, [0.975, 0.025], axis=0))

    @property
    def _identity(self) -> str:
        """The FRFs that it was fitted to, by which a solver input names it."""
        levels = ", ".join(f"{level:.4g}" for level in self.levels)
        return (
            f"FRFs of a mass of {self.mass:.6g} kg at the amplitudes {levels} (N, or m/s^2 of a "
            f"base), which leaves {100 * self.residual:.2g} % of F/X"
        )

    def at_compression(self, compression: float) -> NoReturn:  # noqa: ARG002
        """Refuse a compression other than that of the tests.

        Raises
        ------
        ExportError
        """
        raise ExportError("FRFs at amplitudes are of one compression; leave out --compression")

    def in_parallel(self, count: float) -> LevelFit:
        """Return the fit of several seals in parallel; a fraction is a shorter specimen."""

        def scale_parts(solid: GeneralizedMaxwell, elements: Elements) -> Parts:
            return solid * count, tuple(element * count for element in elements)

        solid, frictions = scale_parts(self.solid, self.rate_independent)
        length = None if self.specimen.length is None else count * self.specimen.length
        step = Step("parallel", (("count", f"{count:g}"),), f"{count:g} such seals in parallel")
        return replace(
            self,
            solid=solid,
            rate_independent=frictions,
            draws=tuple(scale_parts(*draw) for draw in self.draws),
            seals=self.seals / count,
            specimen=replace(self.specimen, length=length),
            steps=(*self.steps, step),
        )

    def covers(self, amplitude: npt.ArrayLike) -> BoolArray:
        """Return whether amplitudes, m, lie in the range that the lines inform."""
        low, high = self.amplitudes
        X = np.asarray(amplitude)
        return np.asarray((low <= X) & (high >= X))

    @property
    def _headline(self) -> str:
        """Change of the stiffness with amplitude, and the range of the lines."""
        low, high = self.amplitudes
        end_stiffnesses = self.stiffness(
            amplitude=[low, high], omega=np.pi * (self.band[0] + self.band[1])
        ).real
        verb = "falls" if end_stiffnesses[1] < end_stiffnesses[0] else "rises"
        return (
            f"from {convert_to_unit(low, 'mm'):.3g} to {format_quantity(high, 'mm', '.3g')} the "
            "stiffness of one "
            f"seal {verb} by {100 * abs(end_stiffnesses[1] / end_stiffnesses[0] - 1):.2g} %, from "
            f"{convert_to_unit(end_stiffnesses[0], 'N/mm'):.4g} to "
            f"{format_quantity(end_stiffnesses[1], 'N/mm')}"
        )

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """The verdict, and the changes with amplitude."""
        low, high = self.amplitudes
        middle = np.pi * (self.band[0] + self.band[1])
        end_stiffnesses = self.stiffness(omega=middle, amplitude=[low, high])
        factor = end_stiffnesses.imag / end_stiffnesses.real
        return (
            str(self.verdict),
            (
                f"one seal, {convert_to_unit(low, 'mm'):.3g} to "
                f"{format_quantity(high, 'mm', '.3g')} at "
                f"{middle / 2 / np.pi:.4g} Hz: stiffness "
                f"{convert_to_unit(end_stiffnesses[0].real, 'N/mm'):.4g} to "
                f"{format_quantity(end_stiffnesses[1].real, 'N/mm')}, loss factor {factor[0]:.3g} "
                f"to {factor[1]:.3g}"
            ),
            (
                f"model: {format_count(self.solid.arms, 'Maxwell arm')} and "
                f"{format_count(len(self.sliders), 'friction slider')}; residual "
                f"{100 * self.residual:.2g} % ({100 * self.linear_residual:.2g} % without sliders)"
            ),
            (
                "A mass wrong by 1 % makes the stiffness wrong by 1 %. The resonance of this mass "
                "stays right; that of another mass moves by 0.5 %."
            ),
            *self._stiffening,
            *(check.message_with_remedy for check in self.checks if check.failed),
        )

    @property
    def _stiffening(self) -> tuple[str, ...]:
        if not self.k3:
            return ()
        low, high = self.k3_interval
        verb = "stiffens" if self.k3 > 0 else "softens"
        share = 0.75 * self.k3 * self.amplitudes[1] ** 2
        return (
            (
                f"it {verb} as a cubic spring, k3 = {self.k3:.3g} N/m^3 ({low:.3g} to {high:.3g}): "
                f"{format_quantity(share, 'N/mm', '+.3g')} at the largest amplitude"
            ),
        )


def complete_document(entries: dict[str, Any]) -> dict[str, Any]:
    """Return the fields of a fit from its document, without the draws of chance.

    Raises
    ------
    ReadError
        If the document is of another fit over amplitude.
    """
    if "model" not in entries:
        content = "a law of stiffness and loss" if "law" in entries else "hits of different height"
        raise ReadError(
            f"the {LevelFit.schema} document holds {content}, which has no force along a path: "
            "arms and sliders are what 'dashpot fit' fits to FRFs of one mass at several amplitudes"
        )
    cubic = entries["cubic"]
    parallel = [*entries["sliders"], *([] if cubic is None else [{"k3": cubic["k3"]}])]
    return entries | {
        "rate_independent": parallel,
        "draws": [],
        "orders": list(entries["orders"].items()),
    }


def _k3(_: GeneralizedMaxwell, elements: Elements) -> float:
    return sum(element.k3 for element in elements if isinstance(element, Cubic))
