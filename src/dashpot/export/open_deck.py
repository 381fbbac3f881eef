"""From a model or a fit to a deck, or a refusal with its reasons."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from types import MappingProxyType
from typing import TypeAlias

from dashpot.base.errors import ExportError
from dashpot.export.deck import Deck
from dashpot.export.unit_systems import UNIT_SYSTEMS
from dashpot.records.fit import Fit, Status
from dashpot.records.specimen import Specimen
from dashpot.solids.maxwell import GeneralizedMaxwell

Solid: TypeAlias = GeneralizedMaxwell | Fit
"""What can be exported: a bare model, or a fit that brings its pedigree along."""

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
    if fit and fit.unit != "N/m" and not prony:
        raise ExportError(
            f"the fit is of a material, in {fit.unit}, and springs and dashpots are in N/m; "
            "write a material card (form='prony'; command line: --form prony)"
        )
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
        identity=_identity(fit) if fit else "",
    )


def _identity(fit: Fit) -> str:
    """Return the fit's name, and that of the fit it was scaled from."""
    from_one = [step.says for step in fit.steps if step.name == "parallel"]
    return ", ".join([fit.identity, *from_one])


def choose_form(form: str, forms: Sequence[str], target: str) -> str:
    """Return `form` if the target knows it, else say which it knows."""
    if form not in forms:
        raise ExportError(f"{target} has no form '{form}'; expected one of {', '.join(forms)}")
    return form


def _problems(
    fit: Fit | None, model: GeneralizedMaxwell, specimen: Specimen, *, prony: bool
) -> dict[str, str]:
    found: dict[str, str] = {}
    if fit:
        # a material has no contact length
        for name in ("temperature", "length") if fit.unit == "N/m" else ("temperature",):
            if getattr(specimen, name) is None:
                found[name] = PROBLEMS[name]
        doubt = _doubt(fit)
        if doubt:
            found["not_identified"] = f"{PROBLEMS['not_identified']}: {doubt}"
    if prony and sum(round(k / model.k_0, 10) for k in model.k) >= 1:
        found["prony_sum"] = f"{PROBLEMS['prony_sum']} (k_inf = {model.k_inf:.4g})"
    return found


def _doubt(fit: Fit) -> str | None:
    """Why not every parameter of a fit is identified, or None."""
    if fit.status not in (Status.CONVERGED, Status.FEWER_ARMS):
        return str(fit.status.value)
    errors = fit.standard_error
    if not fit.model.k_inf > 0:
        return "k_inf = 0, so the relaxation had not ended when the test did"
    if not 3 * errors["k_inf"] < fit.model.k_inf:
        return f"k_inf = {fit.model.k_inf:.4g} +- {errors['k_inf']:.2g} {fit.unit}"
    for j, (k, tau) in enumerate(zip(fit.model.k, fit.model.tau, strict=True)):
        if not 3 * errors["k"][j] < k:
            return f"arm {j + 1} has k = {k:.4g} +- {errors['k'][j]:.2g} {fit.unit}"
        if not 2 * errors["tau"][j] < tau:
            return f"arm {j + 1} has tau = {tau:.4g} +- {errors['tau'][j]:.2g} s"
    return None
