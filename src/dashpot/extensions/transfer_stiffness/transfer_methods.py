"""Transfer stiffness of a mount: direct and indirect measurement, and prediction from a fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.number_format import format_count
from dashpot.base.provenance import Source, Step
from dashpot.base.reported_values import NORMAL
from dashpot.base.units import Quantity, Range, convert_to_si, si_range
from dashpot.base.value_ranges import require_nonnegative, require_positive
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF, Kind
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.datamodel.vibration_tests import ImpactTest, ShakenTest
from dashpot.extensions.transfer_stiffness import checks
from dashpot.extensions.transfer_stiffness.checks import MIN_BLOCKED_DIFFERENCE
from dashpot.extensions.transfer_stiffness.stiffness_sheet import (
    BandStiffness,
    Method,
    TransferStiffness,
    compute_level,
)
from dashpot.extensions.transfer_stiffness.third_octaves import (
    MIN_LINES,
    BandMeans,
    ThirdOctave,
    assign_lines,
    compute_band_means,
    estimate_line_noise,
    list_third_octaves,
)
from dashpot.fitting.prediction_bounds import parameter_band, unresolved_arm_band
from dashpot.registry import find_handler, require_handler
from dashpot.vibration.modal.dynamic_stiffness import DEGREE
from dashpot.workflow.job import HammerChoices

RELATIVE_ERROR = 0.01
"""Relative standard error of the ratio of two sensors, and of a mass, where none is stated."""
PREDICTED_LINES = 11
"""Lines of a predicted third octave; with the limits of a record `LEAST_LINES`."""
_USUAL_BAND = (1.0, 100.0)
"""Default predicted frequencies, Hz."""
_MAX_GAIN, _MAX_PHASE = 0.5, 0.5
"""Relative gain error and phase error, rad, below which a measurement determines a stiffness."""


class SensorErrors(NamedTuple):
    """Standard errors of a measurement that all lines have in common.

    Attributes
    ----------
    gain : float
        Relative, of the ratio of the two sensors.
    phase : float
        Between them, rad.
    mass : float or None
        Mass of the blocking mass, kg; None is 1 % of it.
    """

    gain: float = RELATIVE_ERROR
    phase: float = DEGREE
    mass: float | None = None


def compute_transfer_stiffness(
    measured: FRF | ShakenTest | Fit,
    /,
    *,
    mass: Quantity | None = None,
    flange_mass: Quantity = 0.0,
    exact: bool = False,
    band: Range | None = None,
    output_response: FRF | None = None,
    gain_error: float = RELATIVE_ERROR,
    phase_error: Quantity = DEGREE,
    mass_error: Quantity | None = None,
    rigid_to: Quantity | None = None,
    preload: Quantity | None = None,
    temperature: Quantity | None = None,
    compression: Quantity | None = None,
    seals: float = 1.0,
    record: RelaxationTest | RampHold | Sequence[RelaxationTest | RampHold] = (),
) -> TransferStiffness:
    r"""Return the dynamic transfer stiffness of a mount over frequency and third octaves.

    Direct method, of an FRF of blocked force and input motion, and indirect method, of a
    transmissibility T to a blocking mass (ISO 10846-2, -3):

    .. math::

        k = \frac{F_{2,b}}{u_1}, \qquad k = -(2\pi f)^2 (m_2 + m_f)\,T

    The second holds where T is small. The exact formulas of a mount without mass of its own are

    .. math::

        k = \frac{F_2/u_1 - (2\pi f)^2 m_f T}{1 - T}, \qquad
        k = (2\pi f)^2 (m_2 + m_f) \frac{T}{T - 1}

    The 95 % limits hold the scatter of the lines and the common errors of sensors and
    mass; those of the standard's formula also reach to the exact one.

    Parameters
    ----------
    measured : FRF, ShakenTest or Fit
        Force over motion, or its inverse: direct. A transmissibility, or a record of base and
        mass: indirect. A fit: predicted. A dynamic test of a part, N/m: direct.
    mass : float or str, optional
        Blocking mass :math:`m_2`, kg; of a fit, that of a planned indirect test.
    flange_mass : float or str
        Output flange :math:`m_f`, kg: part of the blocking mass, or between mount and force
        transducers, where it needs `output_response`.
    exact : bool
        Take the exact formula.
    band : (float, float) or str, optional
        Hz; by default all lines, of a fit 1 to 100 Hz.
    output_response : FRF, optional
        Transmissibility from the input to the output of a direct test.
    gain_error : float
        Relative standard error of the ratio of the sensors; 1 % by default.
    phase_error : float or str
        Between the channels, rad; one degree by default.
    mass_error : float or str, optional
        kg; 1 % of the mass by default.
    rigid_to : float or str, optional
        Up to which frequency mass and foundation are rigid, Hz.
    preload, temperature : float or str, optional
        N and K, as the sheet states them; to the temperature a fit is shifted.
    compression : float or str, optional
        For a fit: at which the tangent is taken, m.
    seals : float
        For a fit: how many in parallel.
    record : RelaxationTest, RampHold or sequence of them
        Behind the fit: the limits then include every arm that it does not exclude.

    Returns
    -------
    TransferStiffness

    Raises
    ------
    DataError
        If an option does not suit the measurement, a value is missing or impossible, or no third
        octave lies in the band.
    """
    request = _Request(
        convert_to_si(mass, "mass"),
        convert_to_si(flange_mass, "mass"),
        exact,
        si_range(band, "frequency"),
        output_response,
        SensorErrors(
            gain_error, convert_to_si(phase_error, "angle"), convert_to_si(mass_error, "mass")
        ),
        convert_to_si(rigid_to, "frequency"),
        convert_to_si(preload, "force"),
        convert_to_si(temperature, "temperature"),
    )
    _validate(request, seals)
    if isinstance(measured, Fit):
        tests = (record,) if isinstance(record, RelaxationTest | RampHold) else tuple(record)
        return _predict(measured, request, convert_to_si(compression, "length"), seals, tests)
    if seals != 1.0 or compression is not None or record:
        raise DataError(
            "what was measured is one mount as it stood: leave out the number of seals, the "
            "compression and the record, which are of a fit (--seals, --compression, --record)"
        )
    if isinstance(measured, ShakenTest):
        estimate = require_handler("estimate frf", measured)
        measured = estimate(measured, choices=HammerChoices(), mass=request.mass, band=None)[0]
    convert = None if isinstance(measured, FRF) else find_handler("dynamic stiffness", measured)
    measured = measured if convert is None else convert(measured)
    if isinstance(measured, ImpactTest) or not isinstance(measured, FRF) or measured.is_from_hits:
        raise DataError(
            "hits on a mass show mass and mount together, no transfer stiffness. Fit them (dashpot "
            "fit), or give force over input motion, or a transmissibility. (Python: "
            "frf.stiffness(mass=...) gives the stiffness under a hammer)"
        )
    return (
        _measure_indirect(measured, request)
        if measured.quantity.over_base
        else _measure_direct(measured, request)
    )


class _Request(NamedTuple):
    """Arguments of :func:`compute_transfer_stiffness` in SI; `output` is `output_response`."""

    mass: float | None
    flange_mass: float
    exact: bool
    band: tuple[float, float] | None
    output: FRF | None
    errors: SensorErrors
    rigid_to: float | None
    preload: float | None
    temperature: float | None


def _validate(request: _Request, seals: float) -> None:
    require_positive(mass=request.mass, rigid_to=request.rigid_to, optional=True)
    require_positive(seals=seals)
    require_nonnegative(
        flange_mass=request.flange_mass,
        gain_error=request.errors.gain,
        phase_error=request.errors.phase,
    )
    if request.errors.mass is not None:
        require_nonnegative(mass_error=request.errors.mass)
        if request.mass is None or request.errors.mass >= request.mass:
            raise DataError(
                f"an error of {request.errors.mass:g} kg needs a larger blocking mass: give both "
                "(--mass, --mass-error)"
            )
    if request.errors.gain >= _MAX_GAIN or request.errors.phase >= _MAX_PHASE:
        raise DataError(
            f"a gain error of {request.errors.gain:g} and a phase error of "
            f"{request.errors.phase:g} rad determine no stiffness; expected below {_MAX_GAIN:g} "
            f"and {_MAX_PHASE:g}"
        )


class _MeasuredLines(NamedTuple):
    """Lines of a measurement, with their errors.

    `random_error` is the relative sd of the real and of the imaginary part of each;
    `common_error`, shape (errors, n), is the change of ln k by one standard error of each cause.
    """

    frequency: FloatArray
    value: ComplexArray
    random_error: FloatArray
    common_error: ComplexArray


def _select_lines(frf: FRF, request: _Request) -> FRF:
    """Return the lines in the band, none at 0 Hz or without a value."""
    frf = frf if request.band is None else frf.band(*request.band)
    frf = frf.only((frf.frequency > 0) & (np.abs(frf.value) > 0))
    if len(frf.frequency) < MIN_LINES:
        raise DataError(
            f"{format_count(len(frf.frequency), 'line')} left; expected {MIN_LINES} "
            "or more: widen the band (--band)"
        )
    return frf


def _estimate_relative_noise(
    frf: FRF, smooth_frf: ComplexArray
) -> tuple[FloatArray, tuple[Check, ...]]:
    """Return the relative random error of each line, with a check where the FRF states none.

    There it is that of neighbouring lines of `smooth_frf`, a stiffness.
    """
    scatter = frf.random_sd
    if scatter is not None:
        return np.asarray(scatter / np.abs(frf.value)), ()
    noise = estimate_line_noise(smooth_frf)
    return np.full(len(smooth_frf), noise), (checks.line_noise_stated(noise),)


def _measure_direct(frf: FRF, request: _Request) -> TransferStiffness:
    if request.mass is not None or request.errors.mass is not None:
        raise DataError(
            "a blocking mass is of the indirect method, and this FRF relates a force to a motion: "
            "leave out --mass, or give the transmissibility"
        )
    if request.output is None and (request.flange_mass or request.exact):
        raise DataError(
            "what the flange and the motion of the output do to a direct test follows from that "
            "motion. Add its transmissibility: --output-response FILE (Python: output_response=)"
        )
    stiffness = _select_lines(frf, request).to(Kind.DYNAMIC_STIFFNESS)
    measured = stiffness.value
    T = (
        None
        if request.output is None
        else _interpolate_response(request.output, stiffness.frequency)
    )
    noise, noise_checks = _estimate_relative_noise(stiffness, measured)
    ones = np.ones_like(measured)
    common = np.array([request.errors.gain * ones, 1j * request.errors.phase * ones])
    standard = _MeasuredLines(stiffness.frequency, measured, noise, common)
    if T is None:
        corrected, inertia_share = standard, None
    else:
        inertia = request.flange_mass * (2 * np.pi * stiffness.frequency) ** 2 * T
        inertia_share = (
            float((np.abs(inertia) / np.abs(measured)).max()) if request.flange_mass else None
        )
        value = (measured - inertia) / (1 - T)
        slope = measured / (measured - inertia)
        corrected = _MeasuredLines(
            stiffness.frequency, value, noise * np.abs(slope), common * slope
        )
    inertia_checks = (
        (checks.flange_inertia_negligible(inertia_share),)
        if request.flange_mass or T is None
        else ()
    )
    return _assemble(
        "direct",
        stiffness,
        request,
        (standard, corrected),
        transmissibility=T,
        own_checks=(*noise_checks, *inertia_checks),
    )


def _measure_indirect(frf: FRF, request: _Request) -> TransferStiffness:
    if request.mass is None:
        raise DataError(
            "a transmissibility gives the stiffness over the mass: give the blocking mass, --mass "
            "5kg"
        )
    if request.output is not None:
        raise DataError(
            "the transmissibility is the motion of the output already: leave out --output-response"
        )
    lines = _select_lines(frf.to(Kind.TRANSMISSIBILITY), request)
    T = lines.value
    inertia = (request.mass + request.flange_mass) * (2 * np.pi * lines.frequency) ** 2
    noise, noise_checks = _estimate_relative_noise(lines, -inertia * T)
    errors = request.errors
    mass_error = RELATIVE_ERROR * request.mass if errors.mass is None else errors.mass
    mass_share = mass_error / (request.mass + request.flange_mass)
    ones = np.ones_like(T)
    slope = 1 / (1 - T)
    # of a relative motion R = T - 1 the sensors' ratio is that of R
    sensor_ratio = ones if frf.quantity is Kind.TRANSMISSIBILITY else (T - 1) / T
    ratio = np.array([errors.gain * sensor_ratio, 1j * errors.phase * sensor_ratio])
    standard = _MeasuredLines(
        lines.frequency, -inertia * T, noise, np.array([*ratio, mass_share * ones])
    )
    corrected = _MeasuredLines(
        lines.frequency,
        inertia * T / (T - 1),
        noise * np.abs(slope),
        np.array([*(ratio * slope), mass_share * ones]),
    )
    return _assemble(
        "indirect",
        lines,
        request,
        (standard, corrected),
        transmissibility=T,
        own_checks=noise_checks,
    )


def _interpolate_response(response: FRF, frequency: FloatArray) -> ComplexArray:
    """Return the motion of the output over that of the input at these frequencies."""
    if not response.quantity.over_base:
        raise DataError(
            f"the response of the output is a {response.quantity.label}; expected a "
            "transmissibility, output over input motion"
        )
    transmissibility = response.to(Kind.TRANSMISSIBILITY)
    f = transmissibility.frequency
    if f[0] > frequency[0] * (1 + 1e-6) or f[-1] < frequency[-1] * (1 - 1e-6):
        raise DataError(
            f"the response of the output has {f[0]:.4g} to {f[-1]:.4g} Hz, the stiffness "
            f"{frequency[0]:.4g} to {frequency[-1]:.4g} Hz: narrow the band (--band)"
        )
    parts = (
        np.interp(frequency, f, part)
        for part in (transmissibility.value.real, transmissibility.value.imag)
    )
    real, imaginary = parts
    return np.asarray(real + 1j * imaginary)


def _assemble(
    method: Method,
    frf: FRF,
    request: _Request,
    formulas: tuple[_MeasuredLines, _MeasuredLines],
    *,
    transmissibility: ComplexArray | None,
    own_checks: tuple[Check, ...],
) -> TransferStiffness:
    """Return the sheet of a measurement: by the standard's formula, or by the exact one.

    Parameters
    ----------
    method : {"direct", "indirect"}
    frf : FRF
        What was measured.
    request : _Request
    formulas : (_MeasuredLines, _MeasuredLines)
        Stiffness by the standard's formula, and by the exact one.
    transmissibility : complex array, shape (n,), or None
        Output over input.
    own_checks : tuple of Check
        Checks of noise and flange.
    """
    standard, corrected = formulas
    lines = corrected if request.exact else standard
    bands = _list_covered_bands(lines.frequency)
    spans = assign_lines(lines.frequency, bands)
    covered = tuple(
        (band, span) for band, span in zip(bands, spans, strict=True) if span[1] > span[0]
    )
    if not covered:
        raise _make_no_band_error(lines.frequency)
    singles = [(i, i + 1) for i in range(len(lines.frequency))]
    by_line = _compute_limits(formulas, singles, exact=request.exact)
    by_band = _compute_limits(formulas, [span for _, span in covered], exact=request.exact)
    blocked = _is_blocked(transmissibility, len(lines.value))
    indirect = standard.value if method == "indirect" else None
    band_table = tuple(
        _build_band(
            band,
            span,
            by_band,
            i,
            transmissibility=transmissibility,
            blocked=blocked,
            indirect=indirect,
            exact=request.exact,
        )
        for i, (band, span) in enumerate(covered)
    )
    sheet = TransferStiffness(
        method=method,
        exact=request.exact,
        frequency=lines.frequency,
        value=lines.value,
        limits=by_line.stiffness_limits,
        loss_factor_limits=by_line.loss_factor_limits,
        transmissibility=transmissibility,
        blocked=blocked,
        indirect=indirect,
        bands=band_table,
        mass=request.mass,
        flange_mass=request.flange_mass,
        rigid_to=request.rigid_to,
        preload=request.preload,
        temperature=request.temperature,
        source=frf.source,
        steps=(*frf.steps, _make_step(method, request)),
    )
    return replace(sheet, checks=(*frf.checks, *own_checks, *_run_checks(sheet)))


def _make_step(method: Method, request: _Request) -> Step:
    settings: list[tuple[str, Any]] = [("method", method), ("exact", str(request.exact).lower())]
    if request.mass is not None:
        settings.append(("mass_kg", f"{request.mass:g}"))
    if request.flange_mass:
        settings.append(("flange_mass_kg", f"{request.flange_mass:g}"))
    return Step("transfer_stiffness", tuple(settings))


def _make_no_band_error(frequency: FloatArray) -> DataError:
    return DataError(
        f"no third octave lies in {frequency[0]:.4g} to {frequency[-1]:.4g} Hz as a whole; "
        "expected lines over a factor of 1.26 or more: widen the band (--band)"
    )


def _list_covered_bands(frequency: FloatArray) -> tuple[ThirdOctave, ...]:
    """Return the third octaves that the lines cover, to half their distance."""
    gap = np.diff(frequency)
    low, high = frequency[0] - gap[0] / 2, frequency[-1] + gap[-1] / 2
    return list_third_octaves(max(float(low), float(frequency[0]) / 1.06), float(high))


def _compute_limits(
    formulas: tuple[_MeasuredLines, _MeasuredLines],
    spans: Sequence[tuple[int, int]],
    *,
    exact: bool,
) -> BandMeans:
    """Return means over spans of lines, the limits of the standard's formula out to the exact."""
    standard, corrected = (_compute_means(lines, spans) for lines in formulas)
    if exact:
        return corrected
    low, high = corrected.stiffness_limits
    lower, upper = corrected.loss_factor_limits
    value, eta = standard.stiffness, standard.loss_factor
    return BandMeans(
        value,
        np.array([np.minimum(low, value), np.maximum(high, value)]),
        eta,
        np.array([np.minimum(lower, eta), np.maximum(upper, eta)]),
    )


def _compute_means(lines: _MeasuredLines, spans: Sequence[tuple[int, int]]) -> BandMeans:
    order = np.concatenate([np.arange(first, last) for first, last in spans])
    counts = np.array([last - first for first, last in spans])
    return compute_band_means(
        lines.value[order],
        np.concatenate(([0], np.cumsum(counts)[:-1])),
        random=lines.random_error[order],
        common=lines.common_error[:, order],
        quantile=NORMAL,
    )


def _is_blocked(transmissibility: ComplexArray | None, count: int) -> BoolArray:
    if transmissibility is None:
        return np.ones(count, dtype=bool)
    return np.asarray(-compute_level(np.abs(transmissibility)) >= MIN_BLOCKED_DIFFERENCE)


def _build_band(
    band: ThirdOctave,
    span: tuple[int, int],
    means: BandMeans,
    i: int,
    *,
    transmissibility: ComplexArray | None,
    blocked: BoolArray,
    indirect: ComplexArray | None,
    exact: bool,
    in_fit_band: bool | None = None,
) -> BandStiffness:
    lines = slice(*span)
    low, high = means.stiffness_limits[:, i].tolist()
    lower, upper = means.loss_factor_limits[:, i].tolist()
    output_motion = None if transmissibility is None else np.abs(transmissibility[lines]).max()
    count = span[1] - span[0]
    return BandStiffness(
        band.nominal,
        count,
        float(means.stiffness[i]),
        (low, high),
        float(means.loss_factor[i]),
        (lower, upper),
        None if output_motion is None else float(-compute_level(output_motion)),
        None if indirect is None else float(np.sqrt((np.abs(indirect[lines]) ** 2).mean())),
        count >= MIN_LINES and (exact or bool(blocked[lines].all())),
        in_fit_band,
    )


def _run_checks(sheet: TransferStiffness) -> tuple[Check, ...]:
    """Return the checks of a measured sheet."""
    bands = sheet.bands
    fewest_lines = min(bands, key=lambda band: band.lines)
    # the check of the output judges the bands that are not valid
    valid_bands = [band for band in bands if band.valid] or list(bands)
    widest = max(valid_bands, key=lambda band: band.half_width)
    lossless = min(valid_bands, key=lambda band: band.loss_factor_limits[1])
    cosine = sheet.value.real / np.abs(sheet.value)
    min_index = int(cosine.argmin())
    difference = sheet.level_difference
    least_difference = None if difference is None else float(difference.min())
    T = sheet.transmissibility
    output_check = (
        checks.errors_not_magnified(float((1 / np.abs(1 - T)).max()))
        if sheet.exact and T is not None
        else checks.output_blocked(least_difference, valid_from=sheet.valid_from)
    )
    return (
        output_check,
        checks.blocking_mass_rigid(float(sheet.frequency[-1]), sheet.rigid_to),
        checks.third_octaves_resolved(fewest_lines.lines, centre=fewest_lines.centre),
        checks.level_determined(widest.half_width, centre=widest.centre),
        checks.mount_dissipates(lossless.loss_factor_limits[1], centre=lossless.centre),
        checks.mount_acts_as_spring(
            float(cosine[min_index]), frequency=float(sheet.frequency[min_index])
        ),
    )


def _predict(
    fit: Fit,
    request: _Request,
    compression: float | None,
    seals: float,
    tests: Sequence[RelaxationTest | RampHold],
) -> TransferStiffness:
    """Return the sheet that a fit predicts, with the values that the indirect method would give."""
    if request.output is not None or request.exact:
        raise DataError(
            "a fit predicts the blocked force itself: leave out --exact and --output-response"
        )
    if fit.unit != "N/m":
        raise DataError(
            f"the fit is of a material, in {fit.unit}: a mount has a shape. Fit a test of the "
            "mount, or predict a part (dashpot predict --shape)"
        )
    if request.temperature is not None:
        fit = fit.at_temperature(request.temperature)
    if compression is not None:
        fit = fit.at_compression(compression)
    prepared = [test.prepare() if isinstance(test, RelaxationTest) else test for test in tests]
    low, high = request.band or _USUAL_BAND
    require_positive(frequency=low, unit=" Hz")
    bands = list_third_octaves(low, high)
    if not bands:
        raise _make_no_band_error(np.array([low, high]))
    count = MIN_LINES if prepared else PREDICTED_LINES
    steps = (np.arange(count) + 0.5) / count
    frequency = np.concatenate([band.low + (band.high - band.low) * steps for band in bands])
    spans = [(i * count, (i + 1) * count) for i in range(len(bands))]
    value = seals * fit.solid.complex_stiffness(omega=2 * np.pi * frequency)
    bounds = (
        unresolved_arm_band(fit, prepared, frequency)
        if prepared
        else parameter_band(fit, frequency)
    )
    limits = seals * np.hypot(bounds.storage, np.maximum(bounds.loss, 0.0))
    transmissibility, indirect = None, None
    if request.mass is not None:
        inertia = (request.mass + request.flange_mass) * (2 * np.pi * frequency) ** 2
        transmissibility = value / (value - inertia)
        indirect = -inertia * transmissibility
    blocked = _is_blocked(transmissibility, len(value))
    starts = np.array([first for first, _ in spans])
    means = compute_band_means(
        value, starts, random=np.zeros(len(value)), common=np.zeros((1, len(value)), complex),
        quantile=NORMAL,
    )  # fmt: skip
    band_limits = np.sqrt(np.add.reduceat(limits**2, starts, axis=1) / count)
    factors = np.array(
        [
            np.minimum.reduceat(bounds.loss_factor[0], starts),
            np.maximum.reduceat(bounds.loss_factor[1], starts),
        ]
    )
    means = means._replace(stiffness_limits=band_limits, loss_factor_limits=factors)
    band_table = tuple(
        _build_band(
            band,
            span,
            means,
            i,
            transmissibility=transmissibility,
            blocked=blocked,
            indirect=indirect,
            exact=True,
            in_fit_band=bool(fit.band[0] <= band.low and band.high <= fit.band[1]),
        )
        for i, (band, span) in enumerate(zip(bands, spans, strict=True))
    )
    edges = (bands[0].low, bands[-1].high)
    widest = max(band_table, key=lambda band: band.half_width)
    source: tuple[Source, ...] = fit.source
    return TransferStiffness(
        method="predicted",
        exact=False,
        frequency=frequency,
        value=value,
        limits=limits,
        loss_factor_limits=bounds.loss_factor,
        transmissibility=transmissibility,
        blocked=blocked,
        indirect=indirect,
        bands=band_table,
        mass=request.mass,
        flange_mass=request.flange_mass,
        rigid_to=request.rigid_to,
        preload=request.preload,
        temperature=fit.specimen.temperature
        if request.temperature is None
        else request.temperature,
        seals=seals,
        checks=(
            checks.third_octaves_in_valid_band(edges, fit.band, has_record=bool(prepared)),
            checks.level_determined(widest.half_width, centre=widest.centre),
            *fit.checks,
        ),
        source=source,
        steps=(*fit.steps, _make_step("predicted", request)),
    )
