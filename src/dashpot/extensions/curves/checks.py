"""Criteria on curves of storage, loss and modulus, and on fits to them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dashpot.base.arrays import FloatArray, distinct, median
from dashpot.base.checks import Check, Finding, Remedy, criterion
from dashpot.base.errors import Status
from dashpot.base.units import format_quantity
from dashpot.base.value_ranges import format_quantity_short
from dashpot.fitting.checks.relaxation import MAX_END_SLOPE
from dashpot.fitting.checks.solid import ROUNDING, format_amount
from dashpot.signals.noise import estimate_robust_scatter
from dashpot.solids.maxwell import GeneralizedMaxwell

if TYPE_CHECKING:
    from dashpot.datamodel.bounds import EndOfHold
    from dashpot.extensions.curves.datamodel.dynamic import DynamicTest


MAX_INCONSISTENT = 0.05
# largest rms error of a fit to the curves
MAX_MISFIT = 0.05
# largest residual of a joint model, over that of the fits alone
MAX_JOINT_RATIO = 1.3
# ratio of scatters above which the tests are of different solids
CONTRADICTION_RATIO = 3.0
# chance of a scatter as small as the least that is allowed: 2.5 standard deviations
MIN_CHANCE = 0.0062
# a plateau is known if no spectrum falls below this part of it within ten times the curve
MIN_PLATEAU_RATIO = 0.8
# largest decline at the end of a curve, relative to its total decline
MAX_END_SHARE = 0.2
# default compliance of an instrument with its load cell, m/N
USUAL_COMPLIANCE = 3e-7
# relative error of the storage that is not reported; twice as much for the loss
UNSTATED_ERROR = 0.01
# standard deviations by which a value scatters at most
MAX_SCATTER_SD = 3.0
# plateau ratio required of creep, which may hide a slow flow
MIN_CREEP_PLATEAU_RATIO = 0.65


# -- Magnitudes of strain and stress --------------------------------------------------------------


@criterion(
    "greatest strain", ">=", 0.005, "our choice: a fraction read as % is a hundred times too small",
    grade="stop",
)  # fmt: skip
def strain_not_small(strain: float, unit: str) -> Finding:
    """The strain is as large as in tests of rubber."""
    return _ask_unit_of_strain(strain, unit, "1" if unit == "%" else "")


@criterion(
    "greatest strain", "<=", 3.0, "our choice: a strain in % with another unit is that large",
    grade="stop",
)  # fmt: skip
def strain_not_large(strain: float, unit: str) -> Finding:
    """The strain is no larger than in relaxation or cyclic tests."""
    return _ask_unit_of_strain(strain, unit, "" if unit == "%" else "%")


def _ask_unit_of_strain(strain: float, unit: str, likely_unit: str) -> Finding:
    message = f"The strain reaches {format_quantity(strain, '%', '.3g')}"
    may_be = f". The unit may be {likely_unit}" if likely_unit else ""
    words = (
        f"Give {likely_unit} as the unit of the strain"
        if likely_unit
        else "Give the unit of the strain"
    )
    return Finding(
        message,
        strain,
        failure=f"{message}, in {unit} as the file has it{may_be}.",
        remedy=Remedy(f"{words}, or confirm {unit}.", "units", f"strain={likely_unit or unit}"),
    )


@criterion(
    "greatest stress over strain, 3 MPa", "x/", 300.0,
    "our choice: from a gel of 10 kPa to 900 MPa; rubber has 1 to 100 MPa", grade="stop",
)  # fmt: skip
def modulus_of_a_rubber(modulus: float, unit: str) -> Finding:
    """Stress over strain is a modulus that rubber, foam or gel has."""
    message = f"Stress over strain is {format_quantity_short(modulus, 'Pa')}"
    return Finding(
        message,
        modulus / 3e6,
        failure=f"{message}, with the stress in {unit} as the file has it.",
        remedy=Remedy(
            f"Give the unit of the stress, or confirm {unit}.", "units", f"stress={unit}"
        ),
    )


# -- Curves ---------------------------------------------------------------------------------------


@criterion("smooth misfit", "<=", MAX_INCONSISTENT, "our choice; or 2.5 sd of what chance shows")
def kramers_kronig(misfit: tuple[FloatArray, FloatArray] | None) -> Finding:
    r"""Storage and loss are those of one passive linear model (Kramers-Kronig).

    Every passive relaxing solid is a positive sum of arms, whose storage and loss obey the
    Kramers-Kronig relations one by one. `misfit` is what the nearest of them all misses
    (:func:`~dashpot.extensions.curves.relaxation_spectrum.compute_passive_misfit`); what it misses
    without scatter, the root of the residuals' product with their neighbours, is what the relations
    forbid, unless white residuals of that size would show as much by chance.
    """
    if misfit is None:
        return Finding(
            "A storage is not above 0, so storage and loss cannot be compared",
            remedy="Check the sign of storage and force.",
            always_fails=True,
        )
    smooth_errors = [_compute_smooth_rms(error) for error in misfit]
    return Finding(
        f"The nearest passive model misses storage by {100 * smooth_errors[0]:.2g} % and loss by "
        f"{100 * smooth_errors[1]:.2g} % beyond scatter",
        max(smooth_errors),
        "Storage and loss contradict each other (Kramers-Kronig), so no fit can follow both",
        "Look for a wrong shift, slip, or a changed temperature or strain.",
        always_passes=all(
            value <= max(MAX_INCONSISTENT, _compute_chance_level(error))
            for value, error in zip(smooth_errors, misfit, strict=True)
        ),
    )


@criterion(
    "deformation of the instrument / all",
    "<=",
    UNSTATED_ERROR,
    "our choice; frames and load cells have 0.1 to 1 um/N, assumed 0.3",
    grade="note",
)
def instrument_stiff(data: DynamicTest) -> Finding:
    r"""The instrument is much stiffer than the part.

    The compliance C of frame and load cell is in series: :math:`K^*/(1 + C K^*)` is measured, with
    a storage by CK too low and a loss by 2CK. A modulus does not show how stiff its specimen was.
    """
    compliance_text = (
        f"frame and load cell that give {format_quantity(USUAL_COMPLIANCE, 'um/N', 'g')}"
    )
    if data.unit != "N/m":
        return Finding(
            "Of a specimen of more than "
            f"{format_quantity(UNSTATED_ERROR / USUAL_COMPLIANCE, 'N/mm', '.3g')}, "
            f"{compliance_text} take more than {100 * UNSTATED_ERROR:g} % off the storage and "
            f"{200 * UNSTATED_ERROR:g} % off the loss. How stiff it was is not said"
        )
    stiffest = float(np.hypot(data.storage, data.loss).max())
    return Finding(
        f"At {format_quantity(stiffest, 'N/mm', '.3g')}, {compliance_text} take "
        f"{100 * USUAL_COMPLIANCE * stiffest:.2g} % off "
        "the storage and twice as much off the loss",
        USUAL_COMPLIANCE * stiffest,
        "An instrument may have corrected it",
        remedy="Correct the compliance of the instrument, or test a softer specimen.",
    )


@criterion(
    "losses below 0", "<=", 0.0, "passivity; 3 standard deviations of their scatter",
    other_grade="stop where most losses are below zero",
)  # fmt: skip
def loss_positive(data: DynamicTest) -> Finding:
    """No loss is negative by more than its scatter."""
    part = data.loss / np.abs(data.value)
    bad_indices = np.flatnonzero(part < -MAX_SCATTER_SD * _estimate_sweep_scatter(data, part))
    if not bad_indices.size:
        return Finding("No loss is below zero beyond scatter", 0.0)
    return Finding(
        f"{bad_indices.size} of {len(data.loss)} losses are below zero beyond scatter, the first "
        f"at {data.frequency[bad_indices[0]]:.3g} Hz. No passive part does that",
        float(bad_indices.size),
        remedy="Check the sign, the phase calibration, and the resolution at small loss.",
        grade="stop" if 2 * bad_indices.size > len(data.loss) else "limit",
    )


@criterion("fall of the storage", "<=", 0.05, "our choice: scatter")
def storage_rises(data: DynamicTest) -> Finding:
    """The storage does not fall with frequency; mass in the grips would make it fall."""
    order = np.argsort(data.frequency, kind="stable")
    storage, frequency = data.storage[order], data.frequency[order]
    top = np.maximum.accumulate(storage)
    relative_fall = 1 - storage / np.where(top > 0, top, np.inf)
    worst_index = int(np.argmax(relative_fall))
    return Finding(
        "The storage does not fall with frequency beyond scatter",
        float(relative_fall[worst_index]),
        failure=f"The storage falls by {100 * relative_fall[worst_index]:.2g} % at "
        f"{frequency[worst_index]:.3g} Hz. No relaxing part does that: mass moved along, or the "
        "part warmed up",
        remedy=Remedy("Leave those frequencies out.", "band"),
    )


@criterion("last third / first third", "<=", 1.25, "our choice: scatter", grade="stop")
def modulus_falls(modulus: FloatArray) -> Finding:
    """The relaxation modulus falls with time."""
    third_length = max(len(modulus) // 3, 1)
    first, last = float(modulus[:third_length].mean()), float(modulus[-third_length:].mean())
    ratio = last / first if first > 0 else None
    return Finding(
        "The modulus falls with time",
        ratio,
        failure=f"It rises with time, from {first:.3g} in its first third to {last:.3g} in its "
        "last. A relaxation modulus falls; a creep compliance rises",
        remedy=Remedy("Read it as creep.", "kind", "creep"),
    )


# -- Fits of curves -------------------------------------------------------------------------------


@criterion("plateau, N/m or Pa", ">", source="3 standard errors")
def plateau_seen(model: GeneralizedMaxwell, se: float, *, unit: str, remedy: str) -> Finding:
    """The stiffness that does not relax is above zero."""
    return Finding(
        f"The plateau is {format_amount(model.k_inf, unit)} with a standard error of "
        f"{format_amount(se, unit)}",
        model.k_inf,
        "It may be zero: the material flows, or the measurement ended too early",
        remedy,
        limit=3.0 * se,
        # exact data leave a plateau of rounding size, and a standard error to match
        always_fails=model.k_inf <= ROUNDING * (model.k_inf + sum(model.k)),
    )


@criterion(
    "lowest k(10 T) / highest k(T)",
    ">=",
    MIN_PLATEAU_RATIO,
    "simulation: above it 1 plateau in 20 is off by more than 10 %",
    other_grade=f"{MIN_CREEP_PLATEAU_RATIO:g} of creep",
)
def plateau_determined(end: EndOfHold, unit: str) -> Finding:
    """The curve levels off: no model that fits the data relaxes much further."""
    return Finding(
        end.format_limits(unit),
        end.levels,
        "So k_inf is extrapolated, with no lower limit",
        end.remedy,
        limit=MIN_CREEP_PLATEAU_RATIO if end.test_kind == "creep" else MIN_PLATEAU_RATIO,
    )


@criterion(
    "fall per factor e of time",
    "<=",
    MAX_END_SLOPE,
    "as for a hold",
    other_grade=f"beyond {MAX_END_SHARE:g} of all that the data fell, if that is less",
)
def curve_level_at_end(end: EndOfHold, decrease: float) -> Finding:
    """At the end of the curve, no model that fits the data still falls much.

    `decrease` is the decrease from the first to the last value, over the last.
    """
    relative_slope = end.slope_limit / max(end.k_end[1], 1e-300)
    return Finding(
        f"At the end of the data the stiffness still falls by up to {100 * relative_slope:.2g} % "
        f"per factor of 2.7 in time. At first it was {1 + decrease:.3g} times as stiff",
        relative_slope,
        "A model that continues like this has another plateau, or none",
        end.remedy,
        limit=min(MAX_END_SLOPE, MAX_END_SHARE * max(decrease, 0.0)),
    )


@criterion(source="by the limits of every spectrum that the values allow")
def values_enough(count: int, values: str, *, are_limited: bool) -> Finding:
    """A curve has enough values to limit the arms that the model does not have."""
    return Finding(
        f"{count} {values} limit the arms that the model does not have",
        failure=f"{count} {values} are too few to limit the arms that the model does not have. "
        "What these would change is in no interval.",
        remedy=f"Measure at more {values}.",
        always_fails=not are_limited,
    )


def run_plateau_checks(
    model: GeneralizedMaxwell,
    se: float,
    end: EndOfHold | None,
    *,
    unit: str,
    first: float,
    remedy: str,
) -> tuple[Check, ...]:
    """Return the checks of the plateau: whether there is one, and its error where it was asked.

    `first` is the stiffness of the model where the data are fastest.
    """
    plateau_check = plateau_seen(model, se, unit=unit, remedy=remedy)
    if end is None or plateau_check.failed:
        return (plateau_check,)
    return plateau_determined(end, unit), curve_level_at_end(
        end, first / end.compute_stiffness(model) - 1
    )


@criterion(
    "rms error of the fit",
    "<",
    MAX_MISFIT,
    other_grade="note where several temperatures share the spectrum",
    fit_status=Status.NOT_IDENTIFIED,
)
def few_arms_sufficient(
    relative_misfit: float,
    arms: int,
    max_arms: int,
    dense_spectrum: tuple[int, float],
    limit: float | None = None,
) -> Finding:
    """A model with few arms fits the curves.

    `dense_spectrum` holds arms and rms of the dense spectrum; `limit` is of one that several
    temperatures share.
    """
    return Finding(
        f"The model fits the curves with {arms} arms",
        relative_misfit,
        failure=f"No number of arms up to {max_arms} fits the curves: best {arms}, "
        f"{100 * relative_misfit:.2g} % rms. This is the dense spectrum of "
        f"{dense_spectrum[0]} arms, at {100 * dense_spectrum[1]:.2g} %",
        remedy="Use it as a table for a solver; its single arms mean nothing.",
        limit=limit or MAX_MISFIT,
        grade="note" if limit else None,
    )


@criterion(
    "scatter jointly / separately",
    "<=",
    MAX_JOINT_RATIO,
    other_grade=f"what chance shows in few lines; stop beyond {CONTRADICTION_RATIO:g}, more in few",
    fit_status=Status.TESTS_DISAGREE,
)
def data_agree(
    residual_ratios: Sequence[float], names: Sequence[str], degrees_of_freedom: Sequence[float]
) -> Finding:
    r"""One model fits all data sets about as well as a model for each does.

    Parameters
    ----------
    residual_ratios : sequence of float
        Residual of each curve with the joint model, over that of a fit to its test alone.
    names : sequence of str
    degrees_of_freedom : sequence of float
        Of the latter: few of them may leave a scatter far too small.
    """
    least_scatter = _compute_least_scatter(np.maximum(degrees_of_freedom, 1.0), MIN_CHANCE)
    limits = np.maximum(MAX_JOINT_RATIO, 1 / least_scatter)
    worst_index = int(np.argmax(np.asarray(residual_ratios) / limits))
    return Finding(
        f"The joint model has {residual_ratios[worst_index]:.3g} times the residual of the "
        f"separate fit of {names[worst_index]}",
        float(residual_ratios[worst_index]),
        "The tests contradict each other, or one model needs more arms. Small vibration at depth "
        "has the tangent stiffness, a press from zero the secant",
        "Check that specimen, length, temperature and depth are the same.",
        limit=float(limits[worst_index]),
        grade="stop"
        if residual_ratios[worst_index] / limits[worst_index]
        > CONTRADICTION_RATIO / MAX_JOINT_RATIO
        else None,
    )


def _compute_least_scatter(degrees_of_freedom: FloatArray, chance: float) -> FloatArray:
    r"""Return the least scatter of degrees of freedom over the true one, by chance.

    .. math:: s/\sigma = \sqrt{\chi^2_{\nu, p} / \nu}

    >>> _compute_least_scatter(np.array([1.0, 1e5]), 0.05).round(4)
    array([0.0627, 0.9963])
    """
    # few fits need it, and scipy costs an import
    from scipy.special import chdtri

    return np.sqrt(np.asarray(chdtri(degrees_of_freedom, 1 - chance)) / degrees_of_freedom)


@criterion("gap, a factor", "<=", 10.0, "our choice: a decade")
def bands_overlap(sweep_band: tuple[float, float], relaxation: tuple[float, float]) -> Finding:
    """The bands of the two tests leave no gap of more than a decade."""
    return Finding(
        f"The sweep covers {sweep_band[0]:.3g} to {sweep_band[1]:.3g} Hz, and the valid band of "
        f"the relaxation test is {relaxation[0]:.3g} to {relaxation[1]:.3g} Hz",
        float(max(sweep_band[0] / relaxation[1], relaxation[0] / sweep_band[1])),
        "More than a decade between them was not measured, so arms there are not known",
        "Start the sweep lower, or ramp faster.",
    )


# -- measures -------------------------------------------------------------------------------------


def _estimate_sweep_scatter(data: DynamicTest, values: FloatArray) -> float:
    """The usual standard deviation of values of a sweep from their neighbours, 0 of few."""
    kelvin = np.zeros(len(values)) if data.temperature is None else np.round(data.temperature)
    numbers = []
    for temperature in distinct(kelvin):
        selected = np.flatnonzero(kelvin == temperature)
        ordered = values[selected[np.argsort(data.frequency[selected], kind="stable")]]
        numbers.append(estimate_robust_scatter(np.arange(float(len(selected))), ordered))
    return median(np.array(numbers))


def _compute_smooth_rms(error: FloatArray) -> float:
    r"""Return :math:`\sqrt{\overline{e_i e_{i+1}}}`: the rms of what neighbours share."""
    if len(error) < 2:
        return 0.0
    return float(np.sqrt(max(float(np.mean(error[1:] * error[:-1])), 0.0)))


def _compute_chance_level(error: FloatArray) -> float:
    r"""Return what :func:`_compute_smooth_rms` finds in white residuals, 2.5 standard deviations.

    The mean product of n white neighbours has the standard deviation :math:`s^2/\sqrt n`.
    """
    return float(np.sqrt(2.5 * np.mean(error * error)) / len(error) ** 0.25)
