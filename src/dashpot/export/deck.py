"""What every deck starts from: the solid, its unit system, its pedigree, what it may not hide."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TypeAlias

from dashpot._version import __version__
from dashpot.errors import ExportError
from dashpot.provenance import Source
from dashpot.relaxation.fit import Fit, Status
from dashpot.relaxation.records import Specimen
from dashpot.solids.maxwell import GeneralizedMaxwell

Solid: TypeAlias = GeneralizedMaxwell | Fit
"""What can be exported: a bare model, or a fit that brings its pedigree along."""

NOT_VERIFIED = "not solver-verified: no solver of this kind runs in dashpot's tests"


@dataclass(frozen=True)
class UnitSystem:
    """A consistent unit system: the SI size of one unit of each base quantity.

    Attributes
    ----------
    name : str
        ``"SI"``, ``"mm-t-s"`` or ``"mm-kg-ms"``.
    length, mass, time : float
        Size of the unit in m, kg, s.
    words : tuple of str
        Names of the units of length, mass, time, force and stress.
    """

    name: str
    length: float
    mass: float
    time: float
    words: tuple[str, str, str, str, str]

    @property
    def force(self) -> float:
        """Size of the unit of force, N."""
        return self.mass * self.length / self.time**2

    def stiffness(self, si: float) -> float:
        """N/m in this system."""
        return si * self.length / self.force

    def damping(self, si: float) -> float:
        """N s/m in this system."""
        return si * self.length / (self.force * self.time)

    def stress(self, si: float) -> float:
        """Pa in this system."""
        return si * self.length**2 / self.force

    def density(self, si: float) -> float:
        """kg/m^3 in this system."""
        return si * self.length**3 / self.mass

    def frequency(self, si: float) -> float:
        """Hz in cycles per unit of time: solvers count frequency in their own unit of time."""
        return si * self.time

    @property
    def frequency_word(self) -> str:
        """Name of the unit of frequency."""
        return "Hz" if self.time == 1 else "kHz"

    @property
    def stiffness_word(self) -> str:
        """Name of the unit of stiffness."""
        return f"{self.words[3]}/{self.words[0]}"

    @property
    def damping_word(self) -> str:
        """Name of the unit of damping."""
        return f"{self.words[3]} {self.words[2]}/{self.words[0]}"


UNIT_SYSTEMS = MappingProxyType(
    {
        "SI": UnitSystem("SI", 1.0, 1.0, 1.0, ("m", "kg", "s", "N", "Pa")),
        "mm-t-s": UnitSystem("mm-t-s", 1e-3, 1e3, 1.0, ("mm", "t", "s", "N", "MPa")),
        "mm-kg-ms": UnitSystem("mm-kg-ms", 1e-3, 1.0, 1e-3, ("mm", "kg", "ms", "kN", "GPa")),
    }
)
"""The unit systems a deck can be written in."""

PROBLEMS = MappingProxyType(
    {
        "temperature": "the test temperature is not stated",
        "length": "the contact length is not stated: nobody can scale the stiffness to another",
        "not_identified": "the data do not determine every parameter",
        "prony_sum": "the relative moduli sum to 1: nothing would carry a static load",
    }
)
"""What a deck is refused for; each can be overridden by name and then leaves a mark."""

_REMEDIES = {
    "temperature": "give specimen=Specimen(temperature=...) in K, or --temperature 23degC",
    "length": "give specimen=Specimen(length=...) in m, or --length 100mm",
    "not_identified": "fit fewer arms, or test for longer and faster",
    "prony_sum": "export the arms, or fit with k_inf > 0",
}


@dataclass(frozen=True)
class Deck:
    """A solid ready to be written, with everything its header must say.

    Attributes
    ----------
    model : GeneralizedMaxwell
        SI.
    units : UnitSystem
    specimen : Specimen
    band : (float, float) or None
        The frequencies that the test informs, Hz; None for a bare model.
    source : tuple of Source
    overrides : tuple of str
        What was wrong and written all the same, one sentence each.
    doubts : tuple of str
        What the failed checks of the fit say.
    """

    model: GeneralizedMaxwell
    units: UnitSystem
    specimen: Specimen = field(default_factory=Specimen)
    band: tuple[float, float] | None = None
    source: tuple[Source, ...] = ()
    overrides: tuple[str, ...] = ()
    doubts: tuple[str, ...] = ()

    # -- the solid in deck units ----------------------------------------------------------------

    @property
    def k_inf(self) -> float:
        """Equilibrium stiffness, deck units."""
        return self.units.stiffness(self.model.k_inf)

    @property
    def b(self) -> float:
        """Parallel dashpot, deck units."""
        return self.units.damping(self.model.b)

    @property
    def arms(self) -> tuple[tuple[float, float, float], ...]:
        """Each arm's k, tau, b = k tau, deck units."""
        return tuple(
            (self.units.stiffness(k), tau / self.units.time, self.units.damping(b))
            for k, tau, b in zip(self.model.k, self.model.tau, self.model.arm_b, strict=True)
        )

    @property
    def relative_moduli(self) -> tuple[float, ...]:
        """g_j = k_j / k_0."""
        return tuple(k / self.model.k_0 for k in self.model.k)

    # -- what it says of itself -----------------------------------------------------------------

    def header(
        self, comment: str, title: str, *, verified: str = NOT_VERIFIED, remarks: Sequence[str] = ()
    ) -> list[str]:
        """The comment lines that open a deck, each behind the target's comment sign."""
        units = self.units
        length, mass, time, force, stress = units.words
        lines = [
            f"dashpot {__version__}: {title}",
            (
                f"UNITS: {units.name}: {length}, {mass}, {time}, {force}, {stress}; frequency in "
                f"{units.frequency_word}"
            ),
            f"model: k_inf = {text(self.k_inf)} {units.stiffness_word}"
            + (f", b = {text(self.b)} {units.damping_word}" if self.b > 0 else ""),
            *(
                f"  arm {j}: k = {text(k)} {units.stiffness_word}, tau = {text(tau)} {time}, "
                f"b = {text(b)} {units.damping_word}{self._seen(j - 1)}"
                for j, (k, tau, b) in enumerate(self.arms, start=1)
            ),
            f"temperature: {self._temperature()}",
            f"contact length: {self._length()}",
            *self._sources(),
            self._band(),
            *(f"OVERRIDE: {sentence}" for sentence in self.overrides),
            *(f"CHECK FAILED: {sentence}" for sentence in self.doubts),
            verified,
            *remarks,
        ]
        return [f"{comment} {one_line(line)}" for line in lines]

    def extrapolated(self, frequency: float) -> bool:
        """True if the test says nothing of this frequency, Hz; False where no band is known."""
        return self.band is not None and not self.band[0] <= frequency <= self.band[1]

    def _seen(self, j: int) -> str:
        centre = 1 / (2 * math.pi * self.model.tau[j])
        return (
            f" [{centre:.4g} Hz lies outside the identified band]"
            if self.extrapolated(centre)
            else ""
        )

    def _temperature(self) -> str:
        kelvin = self.specimen.temperature
        return "not stated" if kelvin is None else f"{kelvin:.6g} K ({kelvin - 273.15:.4g} degC)"

    def _length(self) -> str:
        metres = self.specimen.length
        if metres is None:
            return "not stated"
        return f"{metres / self.units.length:.6g} {self.units.words[0]}"

    def _sources(self) -> list[str]:
        if not self.source:
            return ["source: a model in memory; no file is known to stand behind it"]
        lines = [f"source: {each.file} sha256 {each.sha256}" for each in self.source]
        if any(each.simulated for each in self.source):
            lines.append("SIMULATED: the test behind this deck was made by a virtual rig")
        return lines

    def _band(self) -> str:
        if self.band is None:
            return "identified band: not stated; nothing marks what is extrapolated"
        low, high = self.band
        return (
            f"identified band: {low:.4g} to {high:.4g} Hz; whatever lies outside is EXTRAPOLATED "
            "from the fitted arms"
        )


def open_deck(
    solid: Solid,
    *,
    units: str | None,
    specimen: Specimen | None = None,
    allow: Collection[str] = (),
    prony: bool = False,
) -> Deck:
    """Return the deck of a model or a fit, or refuse it.

    A bare model is written with "not stated" wherever its pedigree is unknown: it has nothing
    that could be missing. A fit must know its temperature and contact length, and every
    parameter must be identified.

    Parameters
    ----------
    solid : GeneralizedMaxwell or Fit
    units : str
        ``"SI"``, ``"mm-t-s"`` or ``"mm-kg-ms"``.
    specimen : Specimen, optional
        Replaces what the fit knows of its specimen.
    allow : collection of str
        Names from :data:`PROBLEMS` to overlook; ``"all"`` overlooks every one. Each one that
        applies leaves an OVERRIDE line in the header.
    prony : bool
        True for a material card of relative moduli.

    Raises
    ------
    ExportError
        If the unit system is missing or unknown, or a problem is not allowed.
    """
    if units is None or units not in UNIT_SYSTEMS:
        found = "no unit system is given" if units is None else f"'{units}' is no unit system"
        raise ExportError(f"{found}; add units= one of {', '.join(UNIT_SYSTEMS)}")
    unknown = sorted(set(allow) - set(PROBLEMS) - {"all"})
    if unknown:
        raise ExportError(
            f"'{unknown[0]}' is nothing that could be allowed; known: {', '.join(PROBLEMS)}, all"
        )
    fit = solid if isinstance(solid, Fit) else None
    model = solid.model if isinstance(solid, Fit) else solid
    described = specimen or (fit.specimen if fit else Specimen())
    if model.k_0 == 0 and model.b == 0:
        raise ExportError("the solid has neither stiffness nor damping; there is nothing to write")
    if prony and model.b > 0:
        raise ExportError(
            f"b = {model.b:g} N s/m: a Prony series cannot hold a parallel dashpot; "
            "export the arms, or fit without b"
        )
    problems = _problems(fit, model, described, prony=prony)
    refused = {name: says for name, says in problems.items() if not {name, "all"} & set(allow)}
    if refused:
        found = "; ".join(f"{says} ({_REMEDIES[name]})" for name, says in refused.items())
        names = ", ".join(f"'{name}'" for name in refused)
        raise ExportError(
            f"{found}. To write the deck all the same, with a mark in its header, allow {names} "
            "(command line: --force)"
        )
    return Deck(
        model=model,
        units=UNIT_SYSTEMS[units],
        specimen=described,
        band=fit.band if fit else None,
        source=fit.source if fit else (),
        overrides=tuple(problems.values()),
        doubts=tuple(check.says for check in fit.checks if not check.passed) if fit else (),
    )


def choose_form(form: str, forms: Sequence[str], target: str) -> str:
    """Return `form` if the target knows it, else say which it knows."""
    if form not in forms:
        raise ExportError(f"{target} has no form '{form}'; expected one of {', '.join(forms)}")
    return form


def text(value: float) -> str:
    """A number as decks print it: ten digits and always a point, without which it is an integer.

    >>> text(2e-05), text(196.5), text(3.0)
    ('2.e-05', '196.5', '3.')
    """
    mantissa, exponent, power = f"{value:.10g}".partition("e")
    return mantissa + ("" if "." in mantissa else ".") + exponent + power


def packed(value: float, width: int) -> str:
    """A number in at most `width` columns, with as many digits as they hold, always a point.

    >>> packed(0.50212766, 10), packed(3.68393e-05, 10), packed(-120.0, 8)
    ('0.50212766', '3.68393E-5', '-120.')
    """
    if value == 0:
        return "0."
    for digits in range(min(17, width), 0, -1):
        rounded = f"{value:.{digits - 1}E}"
        mantissa, _, power = rounded.partition("E")
        plain = f"{value:.{max(digits - 1 - int(power), 0)}f}" if abs(int(power)) < 17 else ""
        for candidate in (
            _pointed(plain),
            re.sub(r"^(-?)0(?=\.)", r"\1", _pointed(plain)),
            f"{_pointed(mantissa)}E{int(power)}",
        ):
            if candidate and len(candidate) <= width and float(candidate) == float(rounded):
                return candidate
    raise ExportError(f"{value!r} does not fit into {width} columns")


def _pointed(number: str) -> str:
    """Trailing zeros gone, a decimal point there."""
    if not number:
        return ""
    return number.rstrip("0") if "." in number else number + "."


def one_line(line: str) -> str:
    """Printable ASCII: a file name can hold anything, a solver reads no more."""
    return "".join(sign if " " <= sign <= "~" else "?" for sign in line)


def _problems(
    fit: Fit | None, model: GeneralizedMaxwell, specimen: Specimen, *, prony: bool
) -> dict[str, str]:
    found: dict[str, str] = {}
    if fit:
        for name in ("temperature", "length"):
            if getattr(specimen, name) is None:
                found[name] = PROBLEMS[name]
        doubt = _doubt(fit)
        if doubt:
            found["not_identified"] = f"{PROBLEMS['not_identified']}: {doubt}"
    if prony and sum(round(k / model.k_0, 10) for k in model.k) >= 1:
        found["prony_sum"] = f"{PROBLEMS['prony_sum']} (k_inf = {model.k_inf:.4g} N/m)"
    return found


def _doubt(fit: Fit) -> str | None:
    """Why not every parameter of a fit is identified, or None."""
    if fit.status not in (Status.CONVERGED, Status.FEWER_ARMS):
        return str(fit.status.value)
    errors = fit.standard_error
    if not fit.model.k_inf > 0:
        return "k_inf = 0, so the relaxation had not ended when the test did"
    if not 3 * errors["k_inf"] < fit.model.k_inf:
        return f"k_inf = {fit.model.k_inf:.4g} +- {errors['k_inf']:.2g} N/m"
    for j, (k, tau) in enumerate(zip(fit.model.k, fit.model.tau, strict=True)):
        if not 3 * errors["k"][j] < k:
            return f"arm {j + 1} has k = {k:.4g} +- {errors['k'][j]:.2g} N/m"
        if not 2 * errors["tau"][j] < tau:
            return f"arm {j + 1} has tau = {tau:.4g} +- {errors['tau'][j]:.2g} s"
    return None
