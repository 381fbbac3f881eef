"""A row of a piece that was pressed and released, or of a surface that an indenter hit."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import dashpot as dp
from dashpot.base.checks import Check, Verdict
from dashpot.base.errors import DashpotError
from dashpot.kinds.indentation.record import Indenter
from dashpot.lots.choices import BatchChoices
from dashpot.lots.entries import Entry
from dashpot.records.specimen import Specimen


def pressed(
    kind: str, entry: Entry, choices: BatchChoices, mass: float | None
) -> dict[str, Any] | None:
    """Return the row of such a record, refused or not; None of other kinds, or without a mass."""
    if kind != "cld" and (kind != "indentation" or mass is None):
        return None
    try:
        if kind == "cld":
            return of_cld(entry, choices)
        return of_indentation(entry, choices, Indenter(mass=mass, radius=choices.radius))
    except DashpotError as error:
        return {"kind": kind, "outcome": "refused", "reason": str(error)}


def of_cld(entry: Entry, choices: BatchChoices) -> dict[str, Any]:
    """Return the figures of a load deflection record: of the first compression that was asked for.

    Raises
    ------
    ReadError, DataError
        If it cannot be read, or was not pressed so far.
    """
    piece = Specimen(temperature=entry.temperature, length=choices.length)
    test = dp.read_cld(entry.file, options=choices.bench, specimen=piece)
    at = choices.compression[0] if choices.compression else None
    found = dp.cld(test, at=at, cycle=choices.reading.cycle)
    nominal, cycle = found.nominal, found.cycle
    several = len(found.cycles) > 1
    return {
        "kind": "cld",
        "outcome": "fitted",
        "sha256": "" if found.source is None else found.source.sha256,
        "samples": len(found.force),
        "temperature_K": found.specimen.temperature,
        "depth_m": cycle.depth,
        "force_noise_N": found.noise,
        "cld_at_m": nominal.compression,
        "cld_force_N": nominal.loading,
        "cld_force_se_N": nominal.loading_se,
        "cld_per_100mm_N": None if found.specimen.length is None else found.per * nominal.loading,
        "cld_slope_N_per_m": nominal.slope,
        "cld_hysteresis": cycle.hysteresis,
        "cld_softening": found.softening if several else None,
        "cld_set_m": found.set,
        **_judged(found.verdict, found.checks),
    }


def of_indentation(entry: Entry, choices: BatchChoices, ball: Indenter) -> dict[str, Any]:
    """Return what an indenter's hit says of the surface.

    Raises
    ------
    ReadError, DataError, FitError
        If it cannot be read, or no law follows it.
    """
    test = dp.read_indentation(entry.file, indenter=ball, options=choices.bench)
    fit = dp.fit_indentation(test)
    found: dict[str, Any] = {
        "kind": "indentation",
        "outcome": "fitted",
        "sha256": "" if fit.source is None else fit.source.sha256,
        "samples": len(test.time),
        "method": fit.law,
        "contact_s": fit.duration,
        "indent_depth_m": fit["depth"].value,
        "restitution": fit["restitution"].value,
        **_judged(fit.verdict, fit.checks),
    }
    if ball.radius is not None:
        modulus = fit["modulus"]
        ends = {"": modulus.value, "_low": modulus.low, "_high": modulus.high}
        found |= {f"indent_modulus{end}_Pa": value for end, value in ends.items()}
    return found


def _judged(verdict: Verdict, checks: Iterable[Check]) -> dict[str, Any]:
    return {
        "verdict": verdict.use,
        "reason": "" if verdict.use == "use" else verdict.says,
        "failed_checks": " ".join(failed_names(checks)),
    }


def failed_names(checks: Iterable[Check]) -> list[str]:
    """Return the names of the checks that limit the use, each once."""
    return list(dict.fromkeys(one.name for one in checks if one.failed and one.grade != "note"))
