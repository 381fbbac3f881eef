"""From a solid or a fit to a deck that says what it is, or a refusal with its reasons."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType
from typing import TypeAlias

from dashpot.base.arrays import LEAST, MOST
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import DataError, ExportError
from dashpot.base.version import byline
from dashpot.export.checks import rows_informed
from dashpot.export.frequency_tables import Damping, Table, tabulate
from dashpot.export.notation import UNIT_SYSTEMS, UnitSystem, one_line, text
from dashpot.export.shift import law_lines
from dashpot.fitting.temperature.checks import temperature_tested
from dashpot.records.fit import Fit, Status
from dashpot.records.specimen import Specimen
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

Exportable: TypeAlias = Solid | Fit
"""What can be exported: a bare solid, or a fit that brings its pedigree along."""

NOT_VERIFIED = "not solver-verified: no solver of this kind runs in dashpot's tests"

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
    "temperature": "give --temperature 23degC (Python: Specimen(temperature=...), K)",
    "length": "give --length 100mm (Python: Specimen(length=...), m)",
    "not_identified": "fit fewer arms, or test for longer and faster",
    "prony_sum": "export the arms, or fit with k_inf > 0",
}


_MOVES = ("parallel", "compression", "temperature")
"""Steps that made another solid of the fitted one."""


class DeckText(str):
    """The text of a deck, which knows what its header says.

    Attributes
    ----------
    verdict : Verdict or None
        Of the fit behind it, over the rows written; None for a bare solid.
    checks : tuple of Check
        Those of the fit, and whether it informs the rows.
    overrides : tuple of str
        What was wrong and written all the same.
    """

    verdict: Verdict | None
    checks: tuple[Check, ...]
    overrides: tuple[str, ...]


@dataclass(frozen=True)
class Deck:
    """A solid ready to be written, with everything its header must say.

    Attributes
    ----------
    solid : Solid
        SI.
    units : UnitSystem
    specimen : Specimen
    fit : Fit or None
        Where the solid comes from; None for a bare one.
    overrides : tuple of str
        What was wrong and written all the same, one sentence each.
    """

    solid: Solid
    units: UnitSystem
    specimen: Specimen
    fit: Fit | None = None
    overrides: tuple[str, ...] = ()

    # -- the solid in deck units ----------------------------------------------------------------

    @cached_property
    def model(self) -> GeneralizedMaxwell:
        """The arms that stand for the solid, SI."""
        return self.solid.maxwell

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
    def prony(self) -> list[tuple[float, float]]:
        """Each arm's g_j = k_j / k_0 and tau_j, deck units."""
        return [
            (k / self.model.k_0, tau / self.units.time)
            for k, tau in zip(self.model.k, self.model.tau, strict=True)
        ]

    def shear(self, modulus: float | None, target: str) -> tuple[float, list[tuple[float, float]]]:
        """G_inf, and G_j = G_0 k_j / k_0 and beta_j = 1 / tau_j of each arm, deck units.

        Raises
        ------
        ExportError
            If the instantaneous modulus G_0, Pa, is not given: a part's stiffness tells none.
        """
        if modulus is None or not modulus > 0:
            raise ExportError(
                f"a {target} material needs the instantaneous shear modulus of the rubber, which "
                f"the stiffness of a part does not tell (found modulus = {modulus!r}); give "
                "--modulus 1MPa, the true one (Python: modulus=, Pa)"
            )
        G_0 = self.units.stress(modulus)
        terms = [(g * G_0, 1 / tau) for g, tau in self.prony]
        return G_0 * self.model.k_inf / self.model.k_0, terms

    def table(
        self,
        frequency_range: tuple[float, float],
        tolerance: float,
        *,
        share: float = 1.0,
        damping: Damping = "loss_factor",
        printed: Callable[[float], str] = text,
    ) -> Table:
        """The table of a `share` of the solid in SI, with the digits that will be printed."""
        return tabulate(
            self.solid * share,
            frequency_range=frequency_range,
            tolerance=tolerance,
            damping=damping,
            edges=self.band or (),
            rounded=lambda value: float(printed(value)),
        )

    # -- what it says of itself -----------------------------------------------------------------

    @property
    def band(self) -> tuple[float, float] | None:
        """The frequencies that the test informs, Hz; None for a bare solid."""
        return self.fit.band if self.fit else None

    def extrapolated(self, frequency: float) -> bool:
        """True if the test says nothing of this frequency, Hz; False where no band is known."""
        return self.band is not None and not self.band[0] <= frequency <= self.band[1]

    def written(
        self,
        comment: str,
        title: str,
        body: Sequence[str],
        *,
        verified: str = NOT_VERIFIED,
        remarks: Sequence[str] = (),
        table: Table | None = None,
    ) -> DeckText:
        """The text of the deck: its header behind the target's comment sign, then its cards.

        What a `table` is follows the remarks, and which of its rows the test says nothing of.
        """
        informed = self._informed(table)
        found = self._verdict(informed)
        header = [
            byline(title),
            *(() if found is None else (f"{found.use.upper()}: {found.says}",)),
            *self._described(),
            verified,
            *remarks,
            *(() if table is None else (table.sentence,)),
            *(f"EXTRAPOLATED: {check.says}" for check in informed if check.failed),
        ]
        lines = [*(f"{comment} {one_line(line)}" for line in header), *body, ""]
        made = DeckText("\n".join(lines))
        made.verdict, made.overrides = found, self.overrides
        made.checks = (*(self.fit.checks if self.fit else ()), *informed)
        return made

    def _informed(self, table: Table | None) -> tuple[Check, ...]:
        """Whether the test informs every row of the table, if a test and a table there are."""
        if table is None or self.band is None:
            return ()
        f = table.frequency.tolist()
        outside = [each for each in f if self.extrapolated(each)]
        return (rows_informed(len(outside), len(f), *((outside or f)[i] for i in (0, -1))),)

    def _verdict(self, informed: tuple[Check, ...]) -> Verdict | None:
        if self.fit is None:
            return None
        return verdict((*self.fit.checks, *informed), sound=self.fit.verdict.says)

    def _described(self) -> list[str]:
        units, specimen = self.units, self.specimen
        length, mass, time, force, stress = units.words
        stiffness, damping = units.stiffness_word, units.damping_word
        kelvin, metres = specimen.temperature, specimen.length
        words = f"{length}, {mass}, {time}, {force}, {stress}"
        parallel = f", b = {text(self.b)} {damping}" if self.b > 0 else ""
        described = [
            f"UNITS: {units.name}: {words}; frequency in {units.frequency_word}",
            f"model: k_inf = {text(self.k_inf)} {stiffness}{parallel}",
        ]
        for j, (k, tau, b) in enumerate(self.arms, start=1):
            centre = 1 / (2 * math.pi * self.model.tau[j - 1])
            outside = f" [{centre:.4g} Hz lies outside the identified band]"
            described.append(
                f"  arm {j}: k = {text(k)} {stiffness}, tau = {text(tau)} {time}, "
                f"b = {text(b)} {damping}{outside * self.extrapolated(centre)}"
            )
        if self.model is not self.solid:
            described.append(
                f"  the arms stand for a {type(self.solid).__name__}, of which any table is"
            )
        return [
            *described,
            "temperature: "
            + ("not stated" if kelvin is None else f"{kelvin:.6g} K ({kelvin - 273.15:.4g} degC)"),
            "contact length: "
            + ("not stated" if metres is None else f"{metres / units.length:.6g} {length}"),
            *(law_lines(self.fit.temperatures) if self.fit and self.fit.temperatures else ()),
            *self._elastic_law(),
            *self._pedigree(),
            *(f"OVERRIDE: {sentence}" for sentence in self.overrides),
            *(
                f"CHECK FAILED: {check.says}"
                for check in (self.fit.checks if self.fit else ())
                if check.failed
            ),
        ]

    def _elastic_law(self) -> list[str]:
        """What the stiffnesses are where the elastic law is not straight."""
        law = self.fit.elastic_law if self.fit else None
        if law is None or law.kind == "linear":
            return []
        tangents = zip(law.knots, law.tangent(law.knots), strict=True)
        listed = ", ".join(
            f"{self.units.stiffness(float(k)):.4g} {self.units.stiffness_word} at "
            f"{x / self.units.length:.4g} {self.units.words[0]}"
            for x, k in tangents
        )
        meaning = (
            "  the stiffnesses above are the secant at the deepest; small vibration about a "
            "compression feels the tangent there (dashpot export --compression)"
        )
        return [f"elastic law: not straight; its tangent k_inf is {listed}", meaning]

    def _pedigree(self) -> list[str]:
        """The fit, its files, and the band that the test informs."""
        steps = () if self.fit is None else self.fit.steps
        scaled = [step.says for step in steps if step.name in _MOVES]
        lines = []
        if self.fit is None or not self.fit.source:
            lines.append("source: a model in memory; no file is known to stand behind it")
            lines += scaled
        else:
            lines.append(f"fit: {', '.join([self.fit.identity, *scaled])}")
            lines += [f"source: {each.file} sha256 {each.sha256}" for each in self.fit.source]
            if any(each.simulated for each in self.fit.source):
                lines.append("SIMULATED: the test behind this deck was made by a virtual rig")
        if self.band is None:
            return [*lines, "identified band: not stated; nothing marks what is extrapolated"]
        band = f"identified band: {self.band[0]:.4g} to {self.band[1]:.4g} Hz"
        return [*lines, f"{band}; whatever lies outside is EXTRAPOLATED from the fitted arms"]


def open_deck(
    solid: Exportable,
    target: str,
    form: str,
    forms: Sequence[str],
    *,
    units: str | None,
    specimen: Specimen | None = None,
    allow: Collection[str] = (),
) -> Deck:
    """Return the deck of a solid or a fit, or refuse it.

    A bare solid is written with "not stated" wherever its pedigree is unknown: it has nothing
    that could be missing. A fit must know its temperature and contact length, and every
    parameter must be identified.

    Parameters
    ----------
    solid : Solid or Fit
    target, form : str
        ``"prony"`` is a material card of relative moduli; every other form is of a part.
    forms : sequence of str
        Those that the target knows.
    units : str
        ``"SI"``, ``"mm-t-s"`` or ``"mm-kg-ms"``.
    specimen : Specimen, optional
        Replaces what the fit knows of its specimen; its temperature, where the fit knows one,
        is that which the deck is asked for.
    allow : collection of str
        Names from :data:`PROBLEMS` to overlook; ``"all"`` overlooks every one. Each one that
        applies leaves an OVERRIDE line in the header.

    Raises
    ------
    ExportError
        If the form or the unit system is missing or unknown, or a problem is not allowed.
    """
    if form not in forms:
        raise ExportError(f"{target} has no form '{form}'; expected one of {', '.join(forms)}")
    if units is None or units not in UNIT_SYSTEMS:
        found = "no unit system is given" if units is None else f"'{units}' is no unit system"
        raise ExportError(f"{found}; add --units, one of {', '.join(UNIT_SYSTEMS)}")
    if isinstance(solid, Fit):
        solid = _at(solid, specimen)
        deck = Deck(solid.solid, UNIT_SYSTEMS[units], specimen or solid.specimen, solid)
    else:
        deck = Deck(solid, UNIT_SYSTEMS[units], specimen or Specimen())
    return replace(deck, overrides=_overlooked(deck, allow, prony=form == "prony"))


def _at(fit: Fit, specimen: Specimen | None) -> Fit:
    """The fit at the temperature asked for; one that nobody noted is only said now."""
    asked = None if specimen is None else specimen.temperature
    if asked is None or (fit.temperatures is None and fit.specimen.temperature is None):
        return fit
    try:
        moved = fit.at_temperature(asked)
    except DataError as error:
        raise ExportError(
            f"{error}; if the temperature of the test was noted wrong, fit it again with "
            "--temperature (Python: Specimen(temperature=...))"
        ) from None
    if fit.temperatures is None:
        return moved
    checks = (*moved.checks, temperature_tested(fit.temperatures, asked))
    return replace(moved, evidence=replace(moved.evidence, checks=checks))


def _overlooked(deck: Deck, allow: Collection[str], *, prony: bool) -> tuple[str, ...]:
    """What is wrong with a deck and allowed; raises where anything is not."""
    unknown = sorted(set(allow) - set(PROBLEMS) - {"all"})
    if unknown:
        raise ExportError(
            f"'{unknown[0]}' is nothing that could be allowed; known: {', '.join(PROBLEMS)}, all"
        )
    _refuse_impossible(deck, prony=prony)
    problems = _problems(deck, prony=prony)
    refused = {name: says for name, says in problems.items() if not {name, "all"} & set(allow)}
    if refused:
        found = "; ".join(f"{says} ({_REMEDIES[name]})" for name, says in refused.items())
        names = ", ".join(f"'{name}'" for name in refused)
        raise ExportError(
            f"{found}. To write the deck all the same, with a mark in its header, allow {names}: "
            "--allow NAME for each, or --force for all"
        )
    return tuple(problems.values())


def _refuse_impossible(deck: Deck, *, prony: bool) -> None:
    """Raise where nothing can be overlooked: there is no right number to write."""
    model = deck.model
    if model.k_0 == 0 and model.b == 0:
        raise ExportError("the solid has neither stiffness nor damping; there is nothing to write")
    for name, value in (
        ("k_inf", model.k_inf),
        ("b", model.b),
        *((f"k_{j}", k) for j, k in enumerate(model.k, start=1)),
        *((f"tau_{j}", tau) for j, tau in enumerate(model.tau, start=1)),
    ):
        if value != 0 and not LEAST <= value <= MOST:
            raise ExportError(
                f"{name} = {value:.4g} in SI units; a deck holds 0 or numbers from {LEAST:g} to "
                f"{MOST:g}"
            )
    if deck.fit and deck.fit.unit != "N/m" and not prony:
        raise ExportError(
            f"the fit is of a material, in {deck.fit.unit}, and springs and dashpots are in N/m; "
            "write a material card: --form prony (Python: form='prony')"
        )
    if prony and model.b > 0:
        raise ExportError(
            f"b = {model.b:g} N s/m: a Prony series cannot hold a parallel dashpot; "
            "export the arms, or fit without b"
        )


def _problems(deck: Deck, *, prony: bool) -> dict[str, str]:
    found = {}
    if deck.fit:
        # a material has no contact length
        for name in ("temperature", "length") if deck.fit.unit == "N/m" else ("temperature",):
            if getattr(deck.specimen, name) is None:
                found[name] = PROBLEMS[name]
        doubt = _doubt(deck.fit)
        if doubt:
            found["not_identified"] = f"{PROBLEMS['not_identified']}: {doubt}"
    if prony and sum(round(g, 10) for g, _ in deck.prony) >= 1:
        found["prony_sum"] = f"{PROBLEMS['prony_sum']} (k_inf = {deck.model.k_inf:.4g})"
    return found


def _doubt(fit: Fit) -> str | None:
    """Why not every parameter of a fit is identified, or None."""
    if fit.status not in (Status.CONVERGED, Status.FEWER_ARMS):
        return str(fit.status.value)
    model, error = fit.model, fit.standard_error
    if not model.k_inf > 0:
        return "k_inf = 0, so the relaxation had not ended when the test did"
    # a stiffness is known to three standard errors, a relaxation time to two
    known = [("k_inf", model.k_inf, error["k_inf"], 3, fit.unit)]
    for j, (k, tau) in enumerate(zip(model.k, model.tau, strict=True)):
        known.append((f"arm {j + 1} has k", k, error["k"][j], 3, fit.unit))
        known.append((f"arm {j + 1} has tau", tau, error["tau"][j], 2, "s"))
    for name, value, se, times, unit in known:
        if not times * se < value:
            return f"{name} = {value:.4g} +- {se:.2g} {unit}"
    return None
