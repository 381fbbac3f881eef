"""Comparison of a predicted FRF with a measured one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dashpot.base.arrays import BoolArray, ComplexArray
from dashpot.base.errors import DashpotError, DataError
from dashpot.base.option_fields import Method, get_choice_values
from dashpot.base.provenance import find_origins
from dashpot.base.units import GRAVITY, Quantity, Range, convert_to_si, si_range
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF, Kind, Mode
from dashpot.numerics.inference.model_order import significant
from dashpot.solids.maxwell import Solid
from dashpot.vibration.comparison.checks import checks, format_conclusion
from dashpot.vibration.comparison.comparison_result import ArmEvidence, Comparison
from dashpot.vibration.mass_on_seals import (
    MassOnSeals,
    OperatingPoint,
    accelerance,
    mass_for_peak,
    model_modes,
    operating_point,
)
from dashpot.vibration.modal.peaks import Peak, find_mount_band, find_peak

# Factor of frequency around the measured peak; lines outside are mass line, tip roll-off and
# drift.
COMPARED_BAND_FACTOR = 4.0
# a mode belongs to a peak if their frequencies differ by less than this part
MAX_MODE_DISTANCE = 0.1
# a damping ratio with a larger relative standard error is not reported
MAX_DAMPING_ERROR = 0.3
# fewest lines in the half-power band of a predicted peak that is read off the lines
MIN_HALF_POWER_LINES = 0.5


def compare(
    predicted: FRF,
    measured: FRF,
    *,
    model: Solid | None = None,
    fit: Fit | None = None,
    mass: Quantity | None = None,
    seals: float = 1.0,
    band: Range | None = None,
    compression: Quantity | None = None,
) -> Comparison:
    r"""Return the comparison of a predicted FRF with a measured one, on the measured lines.

    The measurement is never interpolated. Both peaks are read off the measured lines in the same
    way (:func:`~dashpot.vibration.modal.peaks.find_peak`). Only if less than half a line lies in
    the half-power band of the predicted one, and more in that of the measured, the predicted one is
    read off :math:`s^2/(m s^2 + n K(s))` on these lines: a truncated record does not show a peak
    between them. Criteria over the lines are

    .. math::

        \mathrm{FRAC} = \frac{|\sum \bar H_p H_m|^2}{\sum |H_p|^2 \sum |H_m|^2}, \qquad
        \mathrm{rms} = \sqrt{\overline{(20 \log_{10} |H_p/H_m|)^2}}, \qquad
        z = \frac{|H_p - H_m|}{\sqrt 2\,\sigma}

    Where the measured FRF has an exponential window or a truncated record and a model is known, the
    prediction is computed with both: at :math:`s = j\omega + a` and truncated after the same time.

    Parameters
    ----------
    predicted : FRF
        Predicted at ``measured.frequency``, any kind.
    measured : FRF
    model : Solid, optional
        The model of one seal behind the prediction.
    fit : Fit, optional
        Fit of the model: it gives `model`, the tangent stiffness at the static equilibrium of the
        mass (:mod:`~dashpot.vibration.mass_on_seals`), and the arms that the relaxation test
        determined.
    mass : float, optional
        kg; with a model but no mass, that of `predicted` is used. A transmissibility needs it for
        conversion to an accelerance.
    seals : float
        Number of seals under the mass.
    band : (float, float), optional
        Lines to compare, Hz. By default those within a factor of 4 of the measured peak.
    compression : float, optional
        Compression of the seals of a `fit`, m; by default that of the mass's weight.

    Raises
    ------
    DataError
        If the prediction is on other lines, or for another window and no model is given to repeat
        it; or the elastic law of the fit is nonlinear and no mass is given.
    """
    mass, band = convert_to_si(mass, "mass"), si_range(band, "frequency")
    compression = convert_to_si(compression, "length")
    measured = measured.to(Kind.ACCELERANCE, mass=mass)
    measured = measured if band is None else measured.band(*band)
    predicted_lines = _select_measured_lines(predicted.to(Kind.ACCELERANCE, mass=mass), measured)
    model, mass, point = _assemble_mass_on_seals(
        predicted_lines, model, fit, mass=mass, seals=seals, compression=compression
    )
    predicted_lines = _apply_test_window(predicted_lines, measured, model, mass)
    is_compared = _select_compared_lines(measured, find_peak(measured), explicit=band is not None)
    modes = _find_modes(measured, is_compared)
    measured, predicted_lines = measured.only(is_compared), predicted_lines.only(is_compared)
    measured_peak, predicted_peak = find_peak(measured), find_peak(predicted_lines)
    line_count = predicted_peak.half_power_lines
    if model and mass and line_count < MIN_HALF_POWER_LINES < measured_peak.half_power_lines:
        predicted_peak = find_peak(
            replace(predicted_lines, value=accelerance(model, mass, predicted_lines.s), record=None)
        )
    mode = _drop_uncertain_mode(_find_nearest_mode(modes, measured_peak.frequency))
    comparison = Comparison(
        predicted=predicted_lines,
        measured=measured,
        predicted_hz=predicted_peak.frequency,
        measured_hz=measured_peak.frequency,
        predicted_peak=predicted_peak.height,
        measured_peak=measured_peak.height,
        predicted_damping=_find_predicted_damping(model, mass, predicted_lines, predicted_peak),
        measured_damping=None if mode is None else mode.damping_ratio,
        frac=_compute_frac(predicted_lines.value, measured.value),
        rms_db=_compute_rms_db(predicted_lines.value, measured.value),
        z_rms=None,
        legend=_get_legend(fit, measured),
        arms=_list_arm_evidence(model, fit, measured_peak.frequency),
        checks=(),
        message="",
        band=(float(measured.frequency[0]), float(measured.frequency[-1])),
        measured_hz_se=measured_peak.frequency_se,
        measured_damping_se=None if mode is None else mode.damping_ratio_se,
    )
    z = comparison.z
    if z is not None:
        comparison = replace(comparison, z_rms=float(np.sqrt(np.mean(z**2))))
    comparison = replace(
        comparison,
        checks=checks(
            comparison, measured=measured_peak, predicted=predicted_peak, fit=fit, point=point
        ),
    )
    return replace(comparison, message=format_conclusion(comparison))


def infer_mass(model: Solid, frf: FRF) -> tuple[float, float]:
    r"""Return the mass with which the predicted peak of the accelerance is the measured one.

    A frequency predicted with this mass is no test of the model
    (:func:`~dashpot.vibration.mass_on_seals.mass_for_peak`).

    Parameters
    ----------
    model : Solid
        All the seals together.
    frf : FRF
        Measured, any kind.

    Returns
    -------
    mass, standard_error : float
        kg. The error is that of the measured frequency alone, :math:`2 m\,\sigma_f/f`; an error
        of the model's stiffness goes into the mass in full.

    Raises
    ------
    DataError
        If the model has no stiffness to balance a mass at the measured peak.
    """
    peak = find_peak(frf)
    mass = mass_for_peak(model, peak.frequency)
    if not 0 < mass < np.inf:
        raise DataError(
            f"no mass puts a peak of this model at {peak.frequency:.4g} Hz; give --mass"
        )
    return mass, float(2 * mass * peak.frequency_se / peak.frequency)


# -- Common lines and window -------------------------------------------------------------------


def _get_legend(fit: Fit | None, measured: FRF) -> str:
    """Return the legend of the prediction of a fit."""
    if fit is None:
        return "predicted"
    if find_fitted_files(fit, measured):
        return "fitted to these hits"
    if fit.method in get_choice_values(Method):
        return "predicted from relaxation"
    return "predicted by the joint model"


def find_fitted_files(fit: Fit, frf: FRF) -> set[str]:
    """Return the files that a fit and an FRF have in common, by their contents."""
    return find_origins(fit.source) & find_origins(frf.source)


def _select_measured_lines(predicted: FRF, measured: FRF) -> FRF:
    """Return the prediction at the measured lines, which must be among its own."""
    predicted_frequency = predicted.frequency
    nearest_index = np.rint(
        np.interp(measured.frequency, predicted_frequency, np.arange(len(predicted_frequency)))
    ).astype(int)
    distance = np.abs(predicted_frequency[nearest_index] - measured.frequency)
    step = float(np.median(np.diff(measured.frequency))) if len(measured.frequency) > 1 else 1.0
    if distance.max() > 1e-6 * step:
        i = int(np.argmax(distance))
        raise DataError(
            f"the prediction has no line at {measured.frequency[i]:.6g} Hz, where there is a "
            f"measured one (its nearest is at {predicted_frequency[nearest_index[i]]:.6g} Hz); a "
            "measurement is not interpolated: predict at measured.frequency"
        )
    return replace(
        predicted,
        frequency=measured.frequency,
        value=predicted.value[nearest_index],
        coherence=None,
        sd=None,
    )


def _assemble_mass_on_seals(
    predicted: FRF,
    model: Solid | None,
    fit: Fit | None,
    *,
    mass: float | None,
    seals: float,
    compression: float | None,
) -> tuple[Solid | None, float | None, OperatingPoint | None]:
    """Return model of all seals, mass and operating point; None where unknown."""
    if model is not None:
        solid = seals * model
        mass = _infer_predicted_mass(predicted, solid) if mass is None else mass
        static_compression = mass * GRAVITY / solid.k_inf if solid.k_inf > 0 else np.inf
        law = None if fit is None else fit.elastic_law
        return solid, mass, OperatingPoint(static_compression, None if law is None else law.depth)
    if fit is None:
        return None, mass, None
    if mass is None:
        law = fit.elastic_law
        if compression is None and law is not None and law.kind != "linear":
            raise DataError(
                "the stiffness of this fit depends on the compression: give --mass, or "
                "--compression"
            )
        # with a straight law, or at a compression that is given, the stiffness needs no mass
        point_without_mass = operating_point(fit, MassOnSeals(1.0, seals, compression))
        mass = _infer_predicted_mass(predicted, seals * point_without_mass.solid(fit))
    point = operating_point(fit, MassOnSeals(mass, seals, compression))
    return seals * point.solid(fit), mass, point


def _infer_predicted_mass(predicted: FRF, model: Solid) -> float:
    """Return the mass in a prediction: (D(s) - K(s)) / s^2 of its dynamic stiffness D."""
    stiffness = predicted.to(Kind.DYNAMIC_STIFFNESS)
    masses = (stiffness.value - model.stiffness_at(stiffness.s)) / stiffness.s**2
    mass = float(np.median(masses.real))
    if not mass > 0 or float(np.median(np.abs(masses - mass))) > 1e-3 * mass:
        raise DataError(
            "the prediction was not made with this solid: what is left of its dynamic stiffness "
            f"is no mass (about {mass:.4g} kg); check --seals, or give --mass"
        )
    return mass


def _apply_test_window(
    predicted: FRF, measured: FRF, model: Solid | None, mass: float | None
) -> FRF:
    """Return the prediction with the exponential window and the record length of the test."""
    if model is not None and mass is not None:
        record = measured.record if measured.frequency[0] > 0 else None
        return replace(
            predicted,
            value=accelerance(model, mass, measured.s, record, measured.pulse),
            shift=measured.shift,
            record=measured.record,
            pulse=measured.pulse,
        )
    if not np.isclose(predicted.shift, measured.shift, rtol=1e-6, atol=1e-9):
        raise DataError(
            f"the measured FRF carries an exponential window of {measured.shift:.6g} 1/s and the "
            f"prediction one of {predicted.shift:.6g} 1/s: predict with shift=measured.shift, "
            "or give model= and mass="
        )
    return predicted


def _select_compared_lines(measured: FRF, peak: Peak, *, explicit: bool) -> BoolArray:
    if explicit:
        return measured.usable
    return (
        measured.usable
        & (measured.frequency >= peak.frequency / COMPARED_BAND_FACTOR)
        & (measured.frequency <= peak.frequency * COMPARED_BAND_FACTOR)
    )


# -- Criteria and modes --------------------------------------------------------------------------


def _compute_frac(predicted: ComplexArray, measured: ComplexArray) -> float:
    return float(
        np.abs(np.vdot(predicted, measured)) ** 2
        / (np.vdot(predicted, predicted).real * np.vdot(measured, measured).real)
    )


def _compute_rms_db(predicted: ComplexArray, measured: ComplexArray) -> float:
    return float(np.sqrt(np.mean((20 * np.log10(np.abs(predicted) / np.abs(measured))) ** 2)))


def _find_predicted_damping(
    model: Solid | None, mass: float | None, predicted: FRF, peak: Peak
) -> float | None:
    modes = (
        _find_modes(predicted, predicted.frequency >= 0)
        if model is None or mass is None
        else model_modes(model, mass)
    )
    mode = _find_nearest_mode(modes, peak.frequency)
    return None if mode is None else mode.damping_ratio


def _find_modes(frf: FRF, is_used: BoolArray) -> tuple[Mode, ...]:
    """Return the modes of selected lines by the rational fraction; none where they are too few.

    Lines without a gap are fitted on the whole FRF, which caches its modes: several solids are
    compared with one FRF.
    """
    try:
        lines = frf.only(is_used)
        band = find_mount_band(lines.frequency, lines.value, lines.random_sd)
        is_gapless = len(frf.band(*band).frequency) == len(lines.band(*band).frequency)
        return (frf if is_gapless else lines).modes(band=band)
    except DashpotError:
        return ()


def _find_nearest_mode(modes: tuple[Mode, ...], frequency: float) -> Mode | None:
    near_modes = [mode for mode in modes if abs(mode.frequency / frequency - 1) < MAX_MODE_DISTANCE]
    return min(near_modes, key=lambda mode: abs(mode.frequency - frequency), default=None)


def _drop_uncertain_mode(mode: Mode | None) -> Mode | None:
    """Return the mode if the standard error of its damping is small enough, else None."""
    if mode is None or not mode.damping_ratio_se < MAX_DAMPING_ERROR * mode.damping_ratio:
        return None
    return mode


def _list_arm_evidence(
    model: Solid | None, fit: Fit | None, frequency: float
) -> tuple[ArmEvidence, ...]:
    if model is None or not model.maxwell.arms:
        return ()
    maxwell, omega = model.maxwell, 2 * np.pi * frequency
    omega_tau = omega * np.asarray(maxwell.tau)
    loss = np.asarray(maxwell.k) * omega_tau / (1 + omega_tau**2)
    loss_fractions = loss / (loss.sum() + omega * maxwell.b)
    return tuple(
        ArmEvidence(tau, float(loss_fraction), _is_arm_identified(fit, j))
        for j, (tau, loss_fraction) in enumerate(
            zip(maxwell.tau, loss_fractions, strict=True), start=1
        )
    )


def _is_arm_identified(fit: Fit | None, arm: int) -> bool:
    """Return whether the relaxation test determines an arm: k > 3 SE and SE(ln tau) < 0.5.

    Arms that the hammer test added to a joint fit are not; without a covariance those are that
    relax inside the band of the fit.
    """
    if fit is None or arm > fit.model.arms or fit.method == "frf":
        return False
    if any(
        change.name == f"k_{arm}" and change.before is None
        for change in fit.evidence.parameter_changes
    ):
        return False
    variances = dict(
        zip(fit.estimate.parameters, np.diag(fit.estimate.noise_only.covariance), strict=True)
    )
    k_var, tau_var = variances.get(f"k_{arm}"), variances.get(f"ln_tau_{arm}")
    if k_var is None or tau_var is None:
        return fit.band[0] <= 1 / (2 * np.pi * fit.model.tau[arm - 1]) <= fit.band[1]
    k = np.array([fit.model.k[arm - 1]])
    return significant(k, np.sqrt([k_var]), np.sqrt([tau_var]))
