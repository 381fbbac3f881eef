"""One file to one row: what was found, or the sentence why not."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import dashpot as dp
from dashpot.base.checks import Check
from dashpot.base.errors import DashpotError, ReadError
from dashpot.io.columns.kinds import WANTED_BY
from dashpot.io.source import open_raw
from dashpot.lots.choices import BatchChoices
from dashpot.lots.entries import Entry
from dashpot.preparation.motion import loading_in
from dashpot.records.fit import Fit
from dashpot.records.relaxation import RampHold
from dashpot.records.specimen import Specimen
from dashpot.workflow.resting import at_rest

TEXTS = (
    "file", "sha256", "lot", "seal", "repeat", "kind", "outcome", "verdict", "reason",
    "failed_checks", "status", "method", "version",
)  # fmt: skip
"""The columns of words; `outcome` is ``fitted``, ``refused``, ``other`` or ``died``."""
COUNTS = ("bytes", "samples", "arms")
NUMBERS = (
    "temperature_K", "mass_kg", "depth_m", "ramp_s", "hold_s", "force_noise_N", "k_0_N_per_m",
    "k_end_N_per_m", "k_end_low_N_per_m", "k_end_high_N_per_m", "k_inf_N_per_m",
    "k_inf_se_N_per_m", "k_inf_low_N_per_m", "k_inf_high_N_per_m", "rms_N", "frequency_Hz",
    "damping_ratio",
)  # fmt: skip


def arm_columns(arms: int) -> tuple[str, ...]:
    """The columns of the arms, and of their standard errors."""
    return tuple(
        f"{name}_{j}{unit}"
        for j in range(1, arms + 1)
        for name, unit in (
            ("k", "_N_per_m"), ("k", "_se_N_per_m"), ("tau", "_s"), ("tau", "_se_s")
        )
    )  # fmt: skip


def empty(entry: Entry, sha256: str, arms: int) -> dict[str, Any]:
    """Return the row of a file of which nothing is known yet."""
    numbers = dict.fromkeys((*COUNTS, *NUMBERS, *arm_columns(arms)))
    told = {name: getattr(entry, name) for name in ("file", "lot", "seal", "repeat")}
    return (
        dict.fromkeys(TEXTS, "")
        | numbers
        | told
        | {
            "sha256": sha256,
            "temperature_K": entry.temperature,
            "mass_kg": entry.mass,
            "version": dp.__version__,
        }
    )


def row(entry: Entry, sha256: str, choices: BatchChoices) -> dict[str, Any]:
    """Return the row of one file; whatever is wrong with the file is said in it.

    Parameters
    ----------
    entry : Entry
    sha256 : str
        What the contents hashed to when the batch began.
    choices : BatchChoices
    """
    found = empty(entry, sha256, choices.columns)
    if entry.mass is None:
        found["mass_kg"] = choices.mass
    try:
        raw = open_raw(entry.file)
        found["bytes"] = raw.size
        if raw.sha256 != sha256:
            raise ReadError(f"{entry.file} changed while the batch ran; run it again")
        found |= _fitted(entry, choices, found)
    except DashpotError as error:
        found |= {"outcome": "refused", "reason": str(error)}
    except Exception as error:  # noqa: BLE001 -- one file's fault is one row
        found |= {
            "outcome": "refused",
            "reason": f"a fault of dashpot's own: {type(error).__name__}; dashpot fit says more",
        }
    return {name: _finite(value) for name, value in found.items()}


def _fitted(entry: Entry, choices: BatchChoices, found: Mapping[str, Any]) -> dict[str, Any]:
    kind = "relaxation"
    try:
        test = dp.read_relaxation(
            entry.file, options=choices.reading, specimen=Specimen(temperature=entry.temperature)
        )
        loading = loading_in(test.time, test.displacement, test.force)
        kind = loading if loading in WANTED_BY else kind
    except ReadError:
        kind = dp.inspect_file(entry.file, options=choices.reading).kind
        if kind not in WANTED_BY or kind == "relaxation":
            raise
    if kind != "relaxation":
        what, use = WANTED_BY[kind]
        return {"kind": kind, "outcome": "other", "reason": f"it is {what}: {use}"}
    record = dp.prepare(test, cycle=choices.reading.cycle)
    fit = dp.fit(record, arms=choices.arms, method=choices.method, intervals=not choices.quick)
    numbers = _of_record(record) | _of_fit(fit, record)
    if not choices.quick:
        numbers |= _judged(fit)
    try:
        return numbers | _under_mass(fit, found["mass_kg"], choices.seals)
    except DashpotError as error:
        said = (numbers.get("reason", ""), f"under the mass: {error}")
        return numbers | {"reason": "; ".join(filter(None, said))}


def _of_record(record: RampHold) -> dict[str, Any]:
    return {
        "kind": "relaxation",
        "samples": len(record.time),
        "temperature_K": record.specimen.temperature,
        "depth_m": record.depth,
        "ramp_s": record.ramp_time,
        "hold_s": record.hold_time,
        "force_noise_N": record.force_noise,
    }


def _of_fit(fit: Fit, record: RampHold) -> dict[str, Any]:
    model = fit.model
    found: dict[str, Any] = {
        "outcome": "fitted",
        "status": fit.status.name.lower(),
        "method": fit.method,
        "arms": model.arms,
        "k_inf_N_per_m": model.k_inf,
        "k_0_N_per_m": model.k_0,
        "k_end_N_per_m": float(model.relaxation(record.hold_time)),
        "rms_N": fit.residual.rms,
    }
    for j, (k, tau) in enumerate(zip(model.k, model.tau, strict=True), start=1):
        found |= {f"k_{j}_N_per_m": k, f"tau_{j}_s": tau}
    return found


def _judged(fit: Fit) -> dict[str, Any]:
    """Errors, intervals, checks and verdict."""
    low, high = fit.intervals()["k_inf"]
    error, verdict = fit.standard_error, fit.verdict
    found: dict[str, Any] = {
        "verdict": verdict.use,
        "reason": "" if verdict.use == "use" else verdict.says,
        "failed_checks": " ".join(_failed(fit.checks)),
        "k_inf_se_N_per_m": error["k_inf"],
        "k_inf_low_N_per_m": low,
        "k_inf_high_N_per_m": high,
    }
    if fit.left_open is not None:
        low, high = fit.left_open["k_end"]
        found |= {"k_end_low_N_per_m": low, "k_end_high_N_per_m": high}
    for j, (k, tau) in enumerate(zip(error["k"], error["tau"], strict=True), start=1):
        found |= {f"k_{j}_se_N_per_m": k, f"tau_{j}_se_s": tau}
    return found


def _failed(checks: tuple[Check, ...]) -> list[str]:
    return list(dict.fromkeys(one.name for one in checks if one.failed and one.grade != "note"))


def _under_mass(fit: Fit, mass: float | None, seals: float) -> dict[str, Any]:
    """The mode of the mass at rest on the seals, as ``dashpot predict`` has it."""
    if mass is None:
        return {}
    rests = at_rest(fit, mass=mass, seals=seals).tangent
    return {"frequency_Hz": rests.frequency, "damping_ratio": rests.damping_ratio}


def _finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
