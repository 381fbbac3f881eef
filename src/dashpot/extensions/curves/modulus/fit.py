"""Fit of a Maxwell solid with the fewest arms to a relaxation modulus."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Literal

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError, FitError
from dashpot.base.plain_text import decapitalise_sentence
from dashpot.base.provenance import Source, Step, list_sources
from dashpot.datamodel.bounds import BandError, EndOfHold
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.fit_diagnostics import Evidence, Provenance
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.curves.checks import modulus_falls, run_plateau_checks, values_enough
from dashpot.extensions.curves.curve_uncertainty import (
    MIN_FITTED_SHARE,
    BeforeCurve,
    CurveData,
    find_admissible_spectra,
    fit_single_test,
    is_limited,
    limit_end_of_curve,
    weight_curve,
)
from dashpot.extensions.curves.datamodel.modulus import RelaxationModulus
from dashpot.extensions.curves.datamodel.superposition import Superposition, UnshiftedCurve
from dashpot.extensions.curves.relaxation_spectrum import dense_spectrum_if_needed, master_curve
from dashpot.extensions.curves.shift_uncertainty import find_band_with_shift_errors
from dashpot.extensions.curves.superposition.superpose import superpose
from dashpot.fitting.checks.solid import (
    arms_distinct,
    arms_supported,
    loss_factor_determined,
    order_agreed,
    residuals_white,
    tau_inside_window,
)
from dashpot.fitting.data_blocks import FitData
from dashpot.fitting.fit_construction import build_fit
from dashpot.fitting.fit_options import FitOptions
from dashpot.fitting.order_selection import select_order, validate_arm_count
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.design_matrices.recorded_motion import build_hold_block
from dashpot.preprocessing.checks import check_temperature
from dashpot.solids.maxwell import GeneralizedMaxwell

# Smallest number of values for a dense spectrum.
_MIN_VALUES = 3


def fit_modulus(
    time: npt.ArrayLike | RelaxationModulus | Superposition,
    modulus: npt.ArrayLike = (),
    *,
    arms: int | Literal["auto"] = "auto",
    weights: Literal["relative", "uniform"] = "relative",
    thorough: bool = False,
    max_arms: int = 6,
    unit: str = "Pa",
    source: Source | None = None,
    specimen: Specimen | None = None,
) -> Fit:
    r"""Fit a generalized Maxwell solid to a relaxation modulus, the answer to a unit step.

    .. math:: E(t) = E_\infty + \sum_j E_j e^{-t/\tau_j}, \qquad E_\infty, E_j \ge 0

    A plateau is always looked for; a liquid's rests at zero. A force record is no modulus: its
    ramp must be answered for, as :func:`~dashpot.fitting.relaxation.fit` does.

    Parameters
    ----------
    time : array_like, shape (n,), RelaxationModulus or Superposition
        s, >= 0, strictly increasing; or the whole curve, with its unit, source and specimen. At
        several temperatures :func:`~dashpot.extensions.curves.superposition.superpose.superpose`
        shifts it to a master curve with its defaults first.
    modulus : array_like, shape (n,)
        In `unit`; > 0 with relative weights.
    arms : int or "auto"
        ``"auto"`` takes the number that BIC and the significance of every arm both support; if no
        number up to `max_arms` follows the curve, with relative weights, the dense spectrum of
        :func:`~dashpot.extensions.curves.relaxation_spectrum.master_curve` stands in, without
        standard errors; of several temperatures, the one that all of them share.
    weights : "relative" or "uniform"
        Residuals relative to what the best solid expects, or all alike.
    thorough : bool
        Add quasi-random starts.
    max_arms : int
        The most that ``"auto"`` tries.
    unit : str
        ``"Pa"`` or ``"N/m"``.
    source : Source, optional
    specimen : Specimen, optional

    Returns
    -------
    Fit
        `method` is ``"modulus"``; residuals are relative, or in `unit` if uniform; `band` is
        1/(2 pi t) of the first and last time above 0, Hz.

    Raises
    ------
    DataError
        If the arrays are invalid.
    FitError
        If an option makes no sense, or there are fewer samples than parameters.
    """
    if unit not in {"Pa", "N/m"}:
        raise FitError(f"unit = {unit!r}; expected 'Pa' or 'N/m'")
    if isinstance(time, RelaxationModulus | Superposition):
        data, origin = _select_one_temperature(time)
    else:
        curve = RelaxationModulus(time, modulus, unit, specimen or Specimen(), source, units="SI")  # type: ignore[arg-type]
        data, origin = curve, UnshiftedCurve(list_sources([curve]))
    t, values, unit = data.time, data.modulus, data.unit
    modulus_check = modulus_falls(values)
    if modulus_check.failed:
        raise DataError(
            "this is no relaxation modulus: "
            f"{decapitalise_sentence(modulus_check.message_with_remedy)}"
        )
    max_arm_count = validate_arm_count(arms, max_arms)
    window = _get_window(t)
    block = _weight_curve(t, values, weights, window, max_arm_count)
    selection = select_order(
        FitData([block], [block]), FitOptions(arms, max_arms=max_arms, thorough=thorough)
    )
    model = selection.model
    positive = t[t > 0]
    lines = float(1 / (2 * np.pi * positive[-1])), float(1 / (2 * np.pi * positive[0]))
    weighted_curve = _weight_values(t, block)
    end = _limit_end(t, weighted_curve, model)
    find_band = partial(_find_band, t, values, weighted_curve, lines, origin=origin)
    band, band_error = find_band(model)
    checks = run_plateau_checks(
        model,
        float(selection.error[0]),
        end,
        unit=unit,
        first=float(model.relaxation(t[0])),
        remedy="Measure longer.",
    )
    requested_checks = (
        selection.convergence_check,
        *origin.checks,
        *check_temperature(data.specimen),
        arms_supported(model, selection.error, unit=unit),
        tau_inside_window(model, window, "the curve"),
        arms_distinct(model),
        *checks,
        residuals_white(selection.estimate.kappa, selection.estimate.rms),
        *([] if selection.choice is None else [order_agreed(selection.choice)]),
        *selection.check_arm_count("1" if weights == "relative" else unit),
        values_enough(len(t), "times", are_limited=is_limited(end, band_error, model, band)),
        loss_factor_determined(band_error),
    )
    step = Step(
        "fit_modulus",
        (("arms", str(arms)), ("weights", weights), ("unit", unit)),
        f"fitted a generalized Maxwell model with {model.arms} arms to {len(t)} values of a "
        "relaxation modulus",
    )
    residual = replace(selection.residual, unit="1" if weights == "relative" else unit)
    fit_with_few_arms = build_fit(
        selection.make_solid_estimate(residual),
        Evidence(
            band,
            selection.orders,
            selection.certificate,
            checks=requested_checks,
            end_of_hold=end,
            band_error=band_error,
        ),
        Provenance("modulus", origin.sources, (*origin.steps, step), data.specimen),
        unit=unit,
        temperatures=origin.temperatures,
    )
    is_positive_time = t > 0
    if arms != "auto" or weights != "relative" or is_positive_time.sum() < _MIN_VALUES:
        return fit_with_few_arms
    error = model.relaxation(t) / values - 1.0
    return dense_spectrum_if_needed(
        fit_with_few_arms,
        error,
        origin,
        lambda: master_curve(t[is_positive_time], values[is_positive_time]),
        (*origin.checks, *checks),
        find_band=find_band,
    )


def _weight_values(t: FloatArray, block: DataBlock) -> CurveData | None:
    """Return the values of a curve with their errors; None if they are few."""
    shortest, longest = _get_window(t)
    return weight_curve(block, np.maximum(t, t[1]), window=(shortest, 10 * longest))


def _limit_end(
    t: FloatArray, curve: CurveData | None, model: GeneralizedMaxwell
) -> EndOfHold | None:
    """Return the limits at the end of a curve; None if it has few values."""
    if curve is None:
        return None
    longest = _get_window(t)[1]
    return limit_end_of_curve(curve, "curve", time=longest, model=model, extra=model.tau)


def _find_band(
    t: FloatArray,
    values: FloatArray,
    curve: CurveData | None,
    band: tuple[float, float],
    model: GeneralizedMaxwell,
    *,
    origin: Superposition | UnshiftedCurve,
) -> tuple[tuple[float, float], BandError | None]:
    """Return where in a band the curve knows a model, Hz, and the errors there.

    The whole band without errors for a curve of few values.
    """
    if curve is None:
        return band, None
    extended_curve = BeforeCurve(curve, float(t[t > 0][0]), model)
    spectra = find_admissible_spectra(extended_curve, time=_get_window(t)[1], extra=model.tau)
    band, error = find_band_with_shift_errors(spectra, model, band, origin=origin)
    if error is not None:
        # a curve shows its modulus alone
        misfit = _compute_misfit_in_band(model, t, values, band)
        error = replace(error, misfit=(misfit, 0.0))
    return band, error


def _compute_misfit_in_band(
    model: GeneralizedMaxwell, t: FloatArray, values: FloatArray, band: tuple[float, float]
) -> float:
    """Return the largest relative misfit of the curve in a band."""
    with np.errstate(divide="ignore"):
        line = 1 / (2 * np.pi * t)
    error = np.abs(model.relaxation(t) / values - 1)
    return float(np.max(error[(line >= band[0]) & (line <= band[1])], initial=0.0))


def _select_one_temperature(
    data: RelaxationModulus | Superposition,
) -> tuple[RelaxationModulus, Superposition | UnshiftedCurve]:
    """Return the fitted data, and their source."""
    if isinstance(data, RelaxationModulus):
        if data.temperature is None:
            return data, UnshiftedCurve(list_sources([data]))
        data = superpose(data)
    if not isinstance(data.curve, RelaxationModulus):
        raise FitError("a master curve of storage and loss is fitted with fit_dynamic")
    return data.curve, data


def _weight_curve(
    t: FloatArray, values: FloatArray, weights: str, window: tuple[float, float], max_arms: int
) -> DataBlock:
    """Return the curve as rows, relative to the best model of up to `max_arms` arms, or equal."""
    first = _make_block(t, values, _compute_weights(values, weights), window)
    if weights == "uniform":
        return first
    # the size of noisy data is a biased weight: low values would count most
    expected = fit_single_test([first], [first], max_arms).model.relaxation(t)
    return _make_block(t, values, 1 / np.maximum(expected, MIN_FITTED_SHARE * values), window)


def _make_block(
    t: FloatArray, values: FloatArray, weight: FloatArray, window: tuple[float, float]
) -> DataBlock:
    block = build_hold_block(t, values, weights=weight, compress=False)
    return replace(block, window=(window[0], 10 * window[1]))


def _get_window(t: FloatArray) -> tuple[float, float]:
    """Return the relaxation times that the curve can show, s: two samples apart to its end."""
    return (float(t[min(1, len(t) - 1)]) - float(t[0])) / 3, float(t[-1])


def _compute_weights(values: FloatArray, weights: str) -> FloatArray:
    if weights == "uniform":
        return np.ones(len(values))
    if weights != "relative":
        raise FitError(f"weights = {weights!r}; expected 'relative' or 'uniform'")
    bad_indices = np.flatnonzero(values <= 0)
    if bad_indices.size:
        i = int(bad_indices[0])
        raise DataError(
            f"modulus[{i}] = {values[i]:g}; relative weights need values > 0: cut the curve "
            "before it drowns in noise (Python: or weights='uniform')"
        )
    return np.asarray(1 / values)
