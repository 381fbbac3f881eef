"""Solver targets, those of plug-ins included, and the validation of a solid or fit for one."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from functools import update_wrapper
from inspect import signature
from types import MappingProxyType
from typing import Any, Protocol

from dashpot.base.arrays import MAX_SI_MAGNITUDE, MIN_SI_MAGNITUDE
from dashpot.base.errors import DataError, ExportError, Status
from dashpot.base.plain_text import paragraph
from dashpot.datamodel.checks import temperature_tested
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.specimen import Specimen
from dashpot.export.deck import Deck, DeckText, Exportable, NonlinearFit
from dashpot.export.unit_systems import NO_UNITS, unit_system
from dashpot.solids.maxwell import Solid

# Validation of a solid or fit: what must be known, and what is refused.


PROBLEMS = MappingProxyType(
    {
        "temperature": "the test temperature is not stated",
        "length": "the contact length is not stated: nobody can scale the stiffness to another",
        "not_identified": "the data do not determine every parameter",
        "prony_sum": "the relative moduli sum to 1: nothing would carry a static load",
    }
)
"""Reasons to refuse a deck; each can be overridden by name and then leaves a mark."""

_REMEDIES = {
    "temperature": "give --temperature 23degC (Python: Specimen(temperature=...), K)",
    "length": "give --length 100mm (Python: Specimen(length=...), m)",
    "not_identified": "fit fewer arms, or test for longer and faster",
    "prony_sum": "export the arms, or fit with k_inf > 0",
}


NOMINAL = 10.0
"""Hz: of the stiffness for modes beside a table of the valid band, or the end of that band."""


class Target(Protocol):
    """Solver target: writes the deck of a solid by :func:`open_deck`."""

    def __call__(
        self,
        solid: Exportable,
        *,
        units: str | None = None,
        specimen: Specimen | None = None,
        allow: Collection[str] = (),
        form: str = "",
        **solver_options: Any,
    ) -> DeckText:
        """Return the deck; `solver_options` are the solver's own options."""
        ...


def get_option_name(argument: str) -> str:
    """Return how an argument of a target is typed."""
    return f"--{'band' if argument == 'frequency_range' else argument.replace('_', '-')}"


def target(
    *forms: str, line: tuple[str, ...] = (), **requirements: tuple[str, ...]
) -> Callable[[Callable[..., DeckText]], Target]:
    """Decorator that registers a function which writes the cards of a deck as a target of its name.

    The target takes the solid and the arguments of :func:`open_deck` in place of the deck. Its
    first form is the default; of a seal line, the first of those that hold a `line`. `requirements`
    has the forms that read an argument which others would leave unread.
    """

    def enter(cards: Callable[..., DeckText]) -> Target:
        name, (_, *solver_parameters) = cards.__name__, signature(cards).parameters.values()

        def write(
            solid: Exportable,
            *,
            units: str | None = None,
            specimen: Specimen | None = None,
            allow: Collection[str] = (),
            form: str = "",
            **parameters: Any,
        ) -> DeckText:
            form = form or (forms if parameters.get("line") is None else line)[0]
            if parameters.get("line") is not None and form not in line:
                raise ExportError(
                    f"{name} decks hold a seal line in the form {' or '.join(line)}; found the "
                    f"form {form}: add --form {line[0]} (Python: form='{line[0]}')"
                )
            for argument, reading_forms in requirements.items():
                if (
                    parameters.get(argument) is not None
                    and form in forms
                    and form not in reading_forms
                ):
                    option = get_option_name(argument)
                    raise ExportError(
                        f"{name} decks of the form {form} read no {option}: leave it out, or add "
                        f"--form {reading_forms[0]} (Python: {argument}, form='{reading_forms[0]}')"
                    )
            deck = open_deck(solid, name, form, forms, units=units, specimen=specimen, allow=allow)
            band = deck.default_band
            if (
                band
                and form in requirements.get("frequency_range", ())
                and not parameters.get("frequency_range")
            ):
                parameters["frequency_range"] = band
                if "nominal" in requirements and parameters.get("nominal") is None:
                    parameters["nominal"] = min(NOMINAL, band[1])
            return cards(deck, **parameters)

        request = signature(write)
        common = list(request.parameters.values())[:-1]
        parameters = [*common, *solver_parameters]
        update_wrapper(write, cards).__signature__ = request.replace(parameters=parameters)  # type: ignore[attr-defined]
        write.only = requirements  # type: ignore[attr-defined]
        return write

    return enter


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

    A solid without a fit is written with "not stated" for its origin. A fit must know its
    temperature and contact length, and every parameter must be identified.

    Parameters
    ----------
    solid : Solid or Fit or NonlinearFit
    target, form : str
        ``"prony"`` is a material card of relative moduli; every other form is of a part.
    forms : sequence of str
        Forms of the target.
    units : str
        ``"SI"``, ``"mm-t-s"``, ``"mm-kg-ms"`` or ``"in-lbf-s"``.
    specimen : Specimen, optional
        Replaces the specimen of the fit; if the fit has a temperature, the deck is for that of this
        specimen.
    allow : collection of str
        Names from :data:`PROBLEMS` to overlook; ``"all"`` overlooks every one. Each one that
        applies adds an OVERRIDE line to the header.

    Raises
    ------
    ExportError
        If the form or the unit system is missing or unknown, the form is linear and the fit has
        friction, or a problem is not allowed.
    """
    if form not in forms:
        raise ExportError(f"{target} has no form '{form}'; expected one of {', '.join(forms)}")
    system = unit_system(units)
    if isinstance(solid, Fit):
        solid = _apply_temperature(solid, specimen)
    if isinstance(solid, Solid):
        deck = Deck(solid, system, specimen or Specimen(), form)
    else:
        deck = Deck(solid.solid, system, specimen or solid.specimen, form, solid)
    deck.nonlinear_elements.refuse_unsupported(target, form)
    unknown = sorted(set(allow) - set(PROBLEMS) - {"all"})
    if unknown:
        raise ExportError(
            f"'{unknown[0]}' is nothing that could be allowed; known: {', '.join(PROBLEMS)}, all"
        )
    _refuse_impossible(deck)
    fit = deck.linear_fit
    missing = []
    if form != "prony" and fit and fit.unit != "N/m":
        card = "write a material card: --form prony (Python: form='prony')"
        missing.append(
            f"the fit is of a material, in {fit.unit}, and springs and dashpots are in N/m; "
            f"{card if 'prony' in forms else f'{target} has no material card'}"
        )
    problems = {name: (message, _REMEDIES[name]) for name, message in _problems(deck).items()}
    return replace(
        deck, overrides=list_allowed_problems(problems, allow, "deck", units=units, missing=missing)
    )


def _apply_temperature(fit: Fit, specimen: Specimen | None) -> Fit:
    """Return the fit at the requested temperature; unchanged if the fit has no temperature."""
    temperature = None if specimen is None else specimen.temperature
    if temperature is None or (fit.temperatures is None and fit.specimen.temperature is None):
        return fit
    try:
        shifted_fit = fit.at_temperature(temperature)
    except DataError as error:
        raise ExportError(
            f"{error}; if the temperature of the test was noted wrong, fit it again with "
            "--temperature (Python: Specimen(temperature=...))"
        ) from None
    if fit.temperatures is None:
        return shifted_fit
    check = temperature_tested(fit.temperatures, temperature)
    # the fit's own checks are counted, as its text counts them
    checks = (*shifted_fit.checks, *((check,) if check.failed else ()))
    return replace(shifted_fit, evidence=replace(shifted_fit.evidence, checks=checks))


def list_allowed_problems(
    problems: Mapping[str, tuple[str, str]],
    allow: Collection[str],
    subject: str,
    *,
    units: str | None,
    missing: Sequence[str] = (),
) -> tuple[str, ...]:
    """Return the problems that were allowed, each with its remedy.

    Raises
    ------
    ExportError
        If anything is not allowed, no unit system was chosen, or more is `missing`, each in a
        sentence: all at once.
    """
    refused_problems = {
        name: texts for name, texts in problems.items() if not {name, "all"} & set(allow)
    }
    requested = [*([NO_UNITS] if units is None else []), *missing]
    if refused_problems:
        text = "; ".join(
            f"{message} ({remedy})"
            for message, remedy in (problems[name] for name in refused_problems)
        )
        names = ", ".join(f"'{name}'" for name in refused_problems)
        requested += [
            text,
            (
                f"To write the {subject} all the same, with a mark in its header, allow {names}: "
                "--allow NAME for each, or --allow all"
            ),
        ]
    if requested:
        raise ExportError(
            ". ".join(
                [requested[0], paragraph(*requested[1:])[:-1]] if requested[1:] else requested
            )
        )
    return tuple(message for message, _ in problems.values())


def _refuse_impossible(deck: Deck) -> None:
    """Raise an error that no option can allow: there is no valid number to write."""
    model = deck.model
    if model.k_0 == 0 and model.b == 0 and not deck.nonlinear_elements.parts:
        raise ExportError("the model has neither stiffness nor damping; there is nothing to write")
    _refuse_extreme(deck)
    if deck.form == "prony" and model.b > 0:
        raise ExportError(
            f"b = {model.b:g} N s/m: a Prony series cannot hold a parallel dashpot; "
            "export the arms, or fit without b"
        )


def _refuse_extreme(deck: Deck) -> None:
    """Raise where a number has more digits before or behind its point than a deck holds."""
    model = deck.model
    for name, value in (
        ("k_inf", model.k_inf),
        ("b", model.b),
        *((f"k_{j}", k) for j, k in enumerate(model.k, start=1)),
        *((f"tau_{j}", tau) for j, tau in enumerate(model.tau, start=1)),
        *(
            (name, abs(var))
            for part in deck.nonlinear_elements.parts
            for name, var in vars(part).items()
        ),
    ):
        if value != 0 and not MIN_SI_MAGNITUDE <= value <= MAX_SI_MAGNITUDE:
            raise ExportError(
                f"{name} = {value:.4g} in SI units; a deck holds 0 or numbers from "
                f"{MIN_SI_MAGNITUDE:g} to "
                f"{MAX_SI_MAGNITUDE:g}"
            )


def _problems(deck: Deck) -> dict[str, str]:
    entries = {}
    if deck.fit:
        # a material has no contact length
        part = deck.linear_fit is None or deck.linear_fit.unit == "N/m"
        for name in ("temperature", "length") if part else ("temperature",):
            if getattr(deck.specimen, name) is None:
                entries[name] = PROBLEMS[name]
        caution = _format_caution(deck.fit)
        if caution:
            text = PROBLEMS["not_identified"]
            entries["not_identified"] = text if text in caution else f"{text}: {caution}"
    if deck.form == "prony" and sum(round(g, 10) for g, _ in deck.prony) >= 1:
        entries["prony_sum"] = f"{PROBLEMS['prony_sum']} (k_inf = {deck.model.k_inf:.4g})"
    return entries


def _format_caution(fit: Fit | NonlinearFit) -> str | None:
    """Return why parameters of a fit are not identified; None if its verdict is "use".

    With that verdict it may be exported: an arm that the data do not determine still adds up to
    limits that hold. k_inf is no question here; its upper limit is in the header.
    """
    if fit.checks and fit.verdict.use == "use":
        return None
    if not isinstance(fit, Fit) or _dense(fit):
        # the parts are judged together, by what they leave unexplained
        return fit.verdict.message if fit.verdict.use == "do not use" else None
    if fit.status not in (Status.CONVERGED, Status.FEWER_ARMS):
        return str(fit.status.value)
    # what a rig adds to all arms alike is no reason to fit fewer: errors and limits hold it
    model, error = fit.model, replace(fit, estimate=fit.estimate.noise_only).standard_error
    if not model.k_inf > 0:
        return "k_inf = 0, so the relaxation had not ended when the test did"
    # a stiffness is known to three standard errors, a relaxation time to two
    pairs = []
    for j, (k, tau) in enumerate(zip(model.k, model.tau, strict=True)):
        pairs.append((f"arm {j + 1} has k", k, error["k"][j], 3, fit.unit))
        pairs.append((f"arm {j + 1} has tau", tau, error["tau"][j], 2, "s"))
    for name, value, se, times, unit in pairs:
        if not times * se < value:
            return f"{name} = {value:.4g} +- {se:.2g} {unit}"
    return None


def _dense(fit: Fit) -> bool:
    """Return whether the arms are a dense spectrum, whose arms have no errors of their own."""
    return any(check.name == "few_arms_sufficient" and check.failed for check in fit.checks)
