"""Material cards of a hyperelastic law: Abaqus, CalculiX, Ansys and LS-DYNA."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

from dashpot.base.errors import ExportError
from dashpot.base.units import Quantity, convert_to_si, format_quantity
from dashpot.base.version import byline
from dashpot.export import refuse_unused_options
from dashpot.export.deck import NOT_VERIFIED, DeckText
from dashpot.export.deck_validation import list_allowed_problems
from dashpot.export.unit_systems import (
    UnitSystem,
    convert_to_printable_ascii,
    format_fields,
    format_tbdata,
    text,
    unit_system,
)
from dashpot.extensions.materials.hyperelastic.datamodel import HyperelasticFit
from dashpot.extensions.materials.hyperelastic.strain_energy import POWERS, Hyperelastic

VERIFIED = (
    "verified: CalculiX (ccx) runs such a card in dashpot's tests; one element has the stress of "
    "the law within 1e-3"
)
_MAX_TERMS = 6
"""Largest number of viscoelastic terms in *MAT_077."""
_NO_SWELLING = 1e-6
"""In place of beta = 0, by which *MAT_HILL_FOAM divides."""


class _Card(NamedTuple):
    """A law in the units of a deck.

    Attributes
    ----------
    fit : HyperelasticFit
    units : UnitSystem
    constants : tuple of float
    bulk : float
        0 for a foam, whose Poisson's ratio determines it.
    density : float or None
        SI.
    """

    fit: HyperelasticFit
    units: UnitSystem
    constants: tuple[float, ...]
    bulk: float
    density: float | None

    @property
    def pairs(self) -> list[tuple[float, float]]:
        """Each mu with its alpha."""
        return list(zip(self.constants, self.fit.law.exponents, strict=True))

    @property
    def prony(self) -> list[tuple[float, float]]:
        """Each g_j over the instantaneous modulus, and tau_j."""
        relaxation = self.fit.relaxation
        if relaxation is None:
            return []
        terms = zip(relaxation.k, relaxation.tau, strict=True)
        return [(k / relaxation.k_0, tau / self.units.time) for k, tau in terms]

    @property
    def ratio(self) -> float:
        """Instantaneous over relaxed modulus."""
        return 1.0 if self.fit.relaxation is None else self.fit.relaxation.k_0


def _list_missing_data(
    law: Hyperelastic, target: str, bulk: float | None, density: float | None
) -> Iterator[str]:
    """Data of a card that neither tests nor options state."""
    if law.kind != "hyperfoam" and law.bulk is None and bulk is None:
        yield (
            "the change of volume was not tested, and no solver takes a rubber without; add "
            "--bulk-modulus, 2000MPa is usual for solid rubber"
        )
    if target == "lsdyna" and not (isinstance(density, int | float) and density > 0):
        yield "an LS-DYNA material needs --density, such as 1200 (kg/m^3)"


def hyperelastic_card(
    target: str,
    fit: HyperelasticFit,
    *,
    units: str | None = None,
    bulk_modulus: Quantity | None = None,
    density: float | None = None,
    temperature: float | None = None,
    allow: Collection[str] = (),
) -> DeckText:
    r"""Return the material card of a hyperelastic law, with relaxation where the solver has it.

    Parameters
    ----------
    target : str
        ``"abaqus"``, ``"calculix"``, ``"ansys"`` or ``"lsdyna"``.
    fit : HyperelasticFit
    units : str
    bulk_modulus : float, optional
        Bulk modulus of a rubber whose volume was not tested, Pa.
    density : float, optional
        kg/m^3; LS-DYNA wants it.
    temperature : float, optional
        Temperature of the tests, K, where the fit does not know it.
    allow : collection of str
        ``"temperature"``, ``"not_identified"`` (a failed check that forbids the use of the law),
        ``"all"``.

    Raises
    ------
    ExportError
        If a needed value is not stated, or a check forbids the use of the law.
    """
    if target not in TARGETS:
        raise ExportError(
            f"{target} takes no hyperelastic law here; expected one of {', '.join(TARGETS)}"
        )
    system, law = unit_system(units), fit.law
    kelvin = fit.temperature if temperature is None else temperature
    stated_modulus = convert_to_si(bulk_modulus, "stress")
    missing = [*_list_missing_data(law, target, stated_modulus, density)]
    overrides = list_allowed_problems(
        _list_problems(fit, kelvin), allow, "card", units=units, missing=missing
    )
    bulk, measured = _get_bulk_modulus(law, stated_modulus)
    card = _Card(
        fit, system, tuple(system.stress(c) for c in law.constants), system.stress(bulk), density
    )
    body, remarks = TARGETS[target](card)
    comment = {"ansys": "!", "lsdyna": "$"}.get(target, "**")
    header = [
        byline(f"{law.kind} material for {_NAMES[target]}"),
        f"{fit.verdict.use.upper()}: {fit.verdict.message}",
        *_format_header_lines(card, kelvin, measured),
        *map("OVERRIDE: {}".format, overrides),
        *(f"CHECK FAILED: {check.message}" for check in fit.checks if check.failed),
        {"calculix": VERIFIED}.get(target, NOT_VERIFIED),
        *remarks,
    ]
    deck_text = DeckText(
        "\n".join(
            [*(f"{comment} {convert_to_printable_ascii(line)}" for line in header), *body, ""]
        )
    )
    deck_text.verdict, deck_text.checks, deck_text.overrides = fit.verdict, fit.checks, overrides
    return deck_text


def export_law(
    target: str,
    fit: HyperelasticFit,
    *,
    seals: float,
    compression: float | None,
    temperature: float | None,
    **choices: Any,
) -> DeckText:
    """Return the material card of a hyperelastic law with the options of `dashpot export`."""
    refuse_unused_options(target, hyperelastic_card, choices, outside=False)
    if seals != 1 or compression is not None:
        raise ExportError("a material card takes no --seals and no --compression")
    return hyperelastic_card(target, fit, temperature=temperature, **choices)


def _get_bulk_modulus(law: Hyperelastic, stated_modulus: float | None) -> tuple[float, str]:
    """Return the bulk modulus, Pa, and how it is known; 0 of a foam."""
    if law.kind == "hyperfoam":
        if stated_modulus is not None:
            raise ExportError("a foam's Poisson's ratio says its bulk modulus; no --bulk-modulus")
        return 0.0, f"by Poisson's ratio {text(law.poisson)}"
    if stated_modulus is not None:
        return stated_modulus, "stated, not measured"
    assert law.bulk is not None  # noqa: S101  # asked for where it is missing
    return law.bulk, "measured"


def _list_problems(fit: HyperelasticFit, kelvin: float | None) -> dict[str, tuple[str, str]]:
    """Return the warnings of a card, each with its remedy."""
    problems = {}
    if kelvin is None:
        problems["temperature"] = (
            "the test temperature is not stated", "give --temperature 23degC"
        )  # fmt: skip
    if fit.verdict.use == "do not use":
        problems["not_identified"] = fit.verdict.message, "see dashpot fit"
    return problems


def _format_header_lines(card: _Card, kelvin: float | None, measured: str) -> list[str]:
    law, units, fit = card.fit.law, card.units, card.fit
    stress = units.words[4]
    temperature_text = (
        "not stated" if kelvin is None else f"{kelvin:.6g} K ({format_quantity(kelvin, 'degC')})"
    )
    spans = ", ".join(
        f"{curve.mode} {curve.stretch.min():.4g} to {curve.stretch.max():.4g}"
        for curve in fit.curves
    )
    bulk = "" if law.kind == "hyperfoam" else f"{text(card.bulk)} {stress}, "
    lines = [
        f"UNITS: {units.name}: {', '.join(units.words)}",
        f"shear modulus at rest {text(units.stress(law.shear_modulus))} {stress}",
        f"bulk modulus {bulk}{measured}",
        f"temperature: {temperature_text}",
        f"stretches measured: {spans}",
        f"not stable (Drucker) from stretch: {_find_stability_limits(fit)}",
        *(f"source: {source.file} sha256 {source.sha256}" for source in fit.sources),
    ]
    if any(source.simulated for source in fit.sources):
        lines.append("SIMULATED: a test behind this card was made by a program")
    if fit.relaxation is None:
        return [*lines, "relaxation: none was removed; the curves as tested are taken as elastic"]
    return [
        *lines,
        "relaxation: removed from the true stress; the law is that at rest",
    ]


def _find_stability_limits(fit: HyperelasticFit) -> str:
    """Return the stretches from which the law is not stable, in each mode."""
    limit_texts = [
        f"{mode} {limit:.4g}"
        for mode, stretch_limits in fit.stable
        for limit in stretch_limits
        if limit is not None
    ]
    return ", ".join(limit_texts) or "nowhere from 0.1 to 10"


_NAMES = {
    "abaqus": "Abaqus", "calculix": "CalculiX", "ansys": "Ansys Mechanical APDL",
    "lsdyna": "LS-DYNA",
}  # fmt: skip
Body = tuple[list[str], Sequence[str]]


def _format_keyword(card: _Card, *, moduli: str) -> list[str]:
    """*HYPERELASTIC or *HYPERFOAM, which Abaqus and CalculiX read alike."""
    law = card.fit.law
    if law.kind in POWERS:
        name = {"neo-hooke": "NEO HOOKE", "mooney-rivlin": "MOONEY-RIVLIN", "yeoh": "YEOH"}[
            law.kind
        ]
        values = [*card.constants, 2 / card.bulk, *[0.0] * (2 * (law.kind == "yeoh"))]
        return [f"*HYPERELASTIC, {name}{moduli}", *_format_rows(values)]
    count = len(law.exponents)
    constants = [value for pair in card.pairs for value in pair]
    if law.kind == "ogden":
        return [
            f"*HYPERELASTIC, OGDEN, N={count}{moduli}",
            *_format_rows([*constants, 2 / card.bulk, *[0.0] * (count - 1)]),
        ]
    return [f"*HYPERFOAM, N={count}{moduli}", *_format_rows([*constants, *[law.poisson] * count])]


def _format_rows(values: Sequence[float]) -> list[str]:
    return [", ".join(map(text, values[i : i + 8])) for i in range(0, len(values), 8)]


def _write_abaqus(card: _Card) -> Body:
    foam = card.fit.law.kind == "hyperfoam"
    prony = card.prony
    body = [
        "*MATERIAL, NAME=RUBBER",
        *_format_keyword(card, moduli=", MODULI=LONG TERM" * bool(prony)),
    ]
    if prony:
        bulk = [g if foam else 0.0 for g, _ in prony]
        body += ["*VISCOELASTIC, TIME=PRONY"]
        body += [
            f"{text(g)}, {text(k)}, {text(tau)}" for (g, tau), k in zip(prony, bulk, strict=True)
        ]
    return body, [
        "D1 = 2 / K; a rubber wants hybrid elements (C3D8H)",
        "the bulk ratios are those of shear for a foam, and 0 for a rubber"
        if prony
        else "no relaxation",
    ]


def _write_calculix(card: _Card) -> Body:
    message = ["D1 = 2 / K"]
    if card.prony:
        message.append("CalculiX has no relaxation for these laws: the law is that at rest")
    return ["*MATERIAL, NAME=RUBBER", *_format_keyword(card, moduli="")], message


_OTHER_MU = "mu here is 2 mu / alpha of Abaqus: W = mu / alpha (...), G = sum mu alpha / 2"


def _write_ansys_invariants(card: _Card) -> tuple[str, list[float], list[str]]:
    """Return name and constants of a law of the invariants, and notes."""
    kind, ratio = card.fit.law.kind, card.ratio
    incompressible = 2 / (ratio * card.bulk)
    values = [ratio * c for c in card.constants]
    if kind == "neo-hooke":
        message = ["the first constant is the shear modulus, 2 C10"]
        return ",NEO", [2 * values[0], incompressible], message
    if kind == "yeoh":
        return "3,YEOH", [*values, incompressible, 0.0, 0.0], []
    return "2,MOONEY", [*values, incompressible], []


def _write_ansys_powers(card: _Card) -> tuple[str, list[float], list[str]]:
    """Return the same of a law of the stretches."""
    law, ratio = card.fit.law, card.ratio
    count = len(law.exponents)
    values = [v for mu, a in card.pairs for v in (2 * ratio * mu / a, a)]
    if law.kind == "ogden":
        volume = [2 / (ratio * card.bulk), *[0.0] * (count - 1)]
        return f"{count},OGDEN", values + volume, [_OTHER_MU]
    volume = [law.poisson / (1 - 2 * law.poisson)] * count
    return f"{count},FOAM", values + volume, [_OTHER_MU]


def _write_ansys(card: _Card) -> Body:
    law = card.fit.law
    name, values, sentences = (
        _write_ansys_invariants if law.kind in POWERS else _write_ansys_powers
    )(card)
    message = ["d = 2 / K", *sentences]
    body = [f"TB,HYPER,1,1,{name}", *format_tbdata(values)]
    if card.prony:
        body += [
            f"TB,PRONY,1,1,{len(card.prony)},SHEAR",
            *format_tbdata([v for p in card.prony for v in p]),
        ]
        times = f"{card.ratio:.6g} times those at rest"
        message.append(f"the constants are the instantaneous ones, {times}")
        if law.kind == "hyperfoam":
            message.append(
                "repeat TB,PRONY with BULK: a foam keeps its Poisson's ratio as it relaxes"
            )
    return body, message


def _write_lsdyna(card: _Card) -> Body:
    law, units = card.fit.law, card.units
    density = units.density(card.density or 0.0)
    G = units.stress(law.shear_modulus)
    shear = [(card.ratio * g * G, 1 / tau) for g, tau in card.prony]
    if len(shear) > _MAX_TERMS:
        raise ExportError(f"*MAT_077 takes {_MAX_TERMS} terms of relaxation, found {len(shear)}")
    if law.kind == "hyperfoam":
        return _write_hill_foam(card, density)
    K = card.bulk
    poisson = (3 * K - 2 * G) / (6 * K + 2 * G)
    head = format_fields(1, density, poisson, 0, 0, 0.0, 0.0, 0.0)
    message = [f"PR is that of K and G: (3 K - 2 G) / (6 K + 2 G) = {poisson:.6g}"]
    if law.kind in POWERS:
        entries = dict(zip(law.constant_names, card.constants, strict=True))
        order = ("C10", "C01", "C11", "C20", "C02", "C30")
        constants = (entries.get(name, 0.0) for name in order)
        body = ["*MAT_HYPERELASTIC_RUBBER", head, format_fields(*constants, 0.0)]
    else:
        body = ["*MAT_OGDEN_RUBBER", head, *_list_eight_terms(card)]
        message.append(_OTHER_MU)
    if shear:
        message.append(
            "G_j is that of small strain: LS-DYNA adds the relaxation linearly to the law at rest"
        )
    return ["*KEYWORD", *body, *(format_fields(*pair) for pair in shear), "*END"], message


def _write_hill_foam(card: _Card, density: float) -> Body:
    law = card.fit.law
    beta = law.poisson / (1 - 2 * law.poisson)
    bulk = card.units.stress(law.bulk_modulus or 0.0)
    message = [
        "C = 2 mu / alpha, b = alpha, n = nu / (1 - 2 nu); K serves contact",
        *([f"n = {_NO_SWELLING:g} stands for 0, by which it would divide"] * (beta == 0)),
        *(["no relaxation: *MAT_177 takes none"] * bool(card.prony)),
    ]
    return [
        "*KEYWORD",
        "*MAT_HILL_FOAM",
        format_fields(1, density, bulk, beta or _NO_SWELLING, 0.0, 0, 0, 0),
        *_list_eight_terms(card),
        format_fields(0.0, 0.0),
        "*END",
    ], message


def _list_eight_terms(card: _Card) -> list[str]:
    """2 mu / alpha of each term, then each alpha; 0 where there are fewer than eight."""
    terms = card.pairs + [(0.0, 0.0)] * (8 - len(card.pairs))
    return [
        format_fields(*(2 * mu / a if a else 0.0 for mu, a in terms)),
        format_fields(*(a for _, a in terms)),
    ]


TARGETS: Mapping[str, Callable[[_Card], Body]] = MappingProxyType(
    {
        "abaqus": _write_abaqus,
        "calculix": _write_calculix,
        "ansys": _write_ansys,
        "lsdyna": _write_lsdyna,
    }
)
"""The solvers that take a hyperelastic law."""
