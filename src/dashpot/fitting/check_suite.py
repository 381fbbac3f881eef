"""The questions that every fit of relaxation tests is asked, whatever its elastic law."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, Remedy, select_gravest_check
from dashpot.base.choices import Method
from dashpot.datamodel.bounds import EndOfHold
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.checks.relaxation import (
    arms_where_force_relaxes,
    fast_arm_visible,
    force_followed,
    hold_long_enough,
    k_inf_known,
    k_inf_positive,
    record_window,
    residuals_steady,
    same_specimen,
    step_bias,
)
from dashpot.fitting.checks.solid import (
    arms_distinct,
    arms_supported,
    residuals_random,
    tau_inside_window,
)
from dashpot.fitting.nuisance_priors import ROUNDING
from dashpot.fitting.replicates import end_stiffnesses
from dashpot.preprocessing.checks import check_records
from dashpot.solids.maxwell import GeneralizedMaxwell


class Residuals(NamedTuple):
    """What a fit leaves of each record.

    Attributes
    ----------
    every : sequence of array
        One per record, N.
    rms : float
        Over all records, N.
    kappa : float
        Samples per independent residual.
    """

    every: Sequence[FloatArray]
    rms: float
    kappa: float


def run_relaxation_checks(
    records: Sequence[RampHold],
    model: GeneralizedMaxwell,
    error: FloatArray,
    residuals: Residuals,
    end: EndOfHold | None,
    *,
    method: Method = "full",
    needed: bool = False,
    in_arms: bool = True,
) -> list[Check]:
    """Return the checks of the records and of the solid fitted to them.

    Parameters
    ----------
    records : sequence of RampHold
    model : GeneralizedMaxwell
    error : array, shape (p,)
        Standard errors of k_inf, every k, every ln tau.
    residuals : Residuals
    end : EndOfHold or None
    method : "full" or "hold"
    needed : bool
        Fewer arms are rejected.
    in_arms : bool
        The solid was fitted by its arms: each is asked for.
    """
    window = RelaxationWindow(
        record_window(records), "the record", (" (two samples)", " (the hold)")
    )
    answers = [
        *check_records(records, method=method, solids=[model] * len(records)),
        hold_long_enough(end),
        *run_solid_checks(
            records, model, error, residuals, window, end=end, needed=needed, in_arms=in_arms
        ),
    ]
    if len(records) > 1:
        answers.append(same_specimen(end_stiffnesses(records)))
    return answers


class RelaxationWindow(NamedTuple):
    """The relaxation times that some records show: s, of what, and what stands at the two ends."""

    span: tuple[float, float]
    of: str
    ends: tuple[str, str] = ("", "")


def run_solid_checks(
    records: Sequence[RampHold],
    model: GeneralizedMaxwell,
    error: FloatArray,
    residuals: Residuals,
    window: RelaxationWindow,
    *,
    solids: Sequence[GeneralizedMaxwell] = (),
    end: EndOfHold | None = None,
    needed: bool = False,
    in_arms: bool = True,
) -> list[Check]:
    """Return the checks of a solid, as :func:`run_relaxation_checks`, at each temperature.

    Of several temperatures no arm is fast or slow by itself.
    """
    peak = max(float(abs(record.force).max()) for record in records)
    pairs = zip(solids or [model] * len(records), records, strict=True)
    return [
        *(_check_arms(model, error, window, needed=needed) if in_arms else ()),
        k_inf_positive(model, float(error[0]), end),
        k_inf_known(model, float(error[0]), records, end),
        select_gravest_check(arms_where_force_relaxes(solid, record) for solid, record in pairs),
        select_gravest_check(map(force_followed, records, residuals.every)),
        residuals_random(
            residuals.kappa, residuals.rms, max(record.force_noise for record in records)
        ),
        *(_check_fast_arms(records, model, error) if in_arms and not solids else ()),
        residuals_steady(residuals.every, rounding=ROUNDING * peak, peak=peak),
    ]


def _check_arms(
    model: GeneralizedMaxwell, error: FloatArray, window: RelaxationWindow, *, needed: bool
) -> tuple[Check, ...]:
    return (
        arms_distinct(model),
        arms_supported(model, error, needed=needed),
        tau_inside_window(
            model,
            window.span,
            window.of,
            ends=window.ends,
            within=True,
            remedy=Remedy("Use fewer arms, hold longer, or sample faster.", "arms"),
        ),
    )


def _check_fast_arms(
    records: Sequence[RampHold], model: GeneralizedMaxwell, error: FloatArray
) -> tuple[Check, ...]:
    return (
        step_bias(model, records),
        fast_arm_visible(model, records, error=_compute_fastest_error(model, error)),
    )


def _compute_fastest_error(model: GeneralizedMaxwell, error: FloatArray) -> float:
    """Return the relative standard error of the fastest arm's k."""
    return float(error[1] / model.k[0]) if model.arms else float("inf")
