"""Predicted against measured: what the hammer confirms, and which arms it tested."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dashpot._arrays import BoolArray, ComplexArray, FloatArray
from dashpot.checks import Check
from dashpot.errors import DataError
from dashpot.relaxation.fit import Fit
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.frf import FRF, Kind
from dashpot.vibration.peaks import Peak, find_peak, random_sd, usable_lines
from dashpot.vibration.truncation import cut_accelerance, poles

GRAVITY = 9.80665
# limits of the verdict: a frequency within 5 % is stiffness within 10 %
FREQUENCY_LIMIT = 0.05
PEAK_LIMIT_DB = 3.0
DAMPING_LIMIT = 1.25
# lines outside this factor of the measured peak are mass line, tip roll-off and drift
AROUND_THE_PEAK = 4.0
# a response that has not decayed to this by the end of the record hides its damping
UNDECAYED = 0.1


@dataclass(frozen=True)
class ArmEvidence:
    """Whether one arm of the model was tested by this FRF.

    Attributes
    ----------
    tau : float
        Relaxation time, s.
    loss_share : float
        Share of the loss stiffness at the measured peak that this arm carries, 0 to 1.
    seen_by_relaxation : bool
        True if the relaxation test could identify an arm at this relaxation time.
    """

    tau: float
    loss_share: float
    seen_by_relaxation: bool


@dataclass(frozen=True)
class Comparison:
    """A predicted FRF held against a measured one, on the measured lines.

    Attributes
    ----------
    predicted, measured : FRF
        Accelerance on the same lines.
    predicted_hz, measured_hz : float
        Frequency of the peak, Hz.
    predicted_peak, measured_peak : float
        Height of the accelerance peak, 1/kg.
    predicted_damping, measured_damping : float or None
        Damping ratio; None where the record cannot support it.
    frac : float
        Frequency response assurance criterion, 0 to 1.
    rms_db : float
        Root mean square difference of the magnitudes over the lines, dB.
    z_rms : float or None
        Root mean square of the difference in units of the measured standard deviation.
    arms : tuple of ArmEvidence
    checks : tuple of Check
    verdict : str
        The sentence that matters: what agrees, what does not, and why.
    band : (float, float)
        First and last of the lines that `frac`, `rms_db` and `z_rms` were taken over, Hz.
    measured_hz_se, measured_damping_se : float or None
        Random standard errors of the measured peak frequency, Hz, and damping ratio.
    """

    predicted: FRF
    measured: FRF
    predicted_hz: float
    measured_hz: float
    predicted_peak: float
    measured_peak: float
    predicted_damping: float | None
    measured_damping: float | None
    frac: float
    rms_db: float
    z_rms: float | None
    arms: tuple[ArmEvidence, ...]
    checks: tuple[Check, ...]
    verdict: str
    band: tuple[float, float] = (0.0, float("inf"))
    measured_hz_se: float | None = None
    measured_damping_se: float | None = None

    @property
    def frequency_error(self) -> float:
        """Predicted over measured peak frequency, less one."""
        return self.predicted_hz / self.measured_hz - 1

    @property
    def ratio_db(self) -> float:
        """Predicted over measured peak height, dB."""
        return float(20 * np.log10(self.predicted_peak / self.measured_peak))

    @property
    def damping_ratio_error(self) -> float | None:
        """Predicted over measured damping ratio, less one; None if either is unknown."""
        if self.predicted_damping is None or not self.measured_damping:
            return None
        return self.predicted_damping / self.measured_damping - 1

    @property
    def z(self) -> FloatArray | None:
        """|predicted - measured| over the measured standard deviation, per line; None if unknown.

        The standard deviation is that of the complex value, so that z is about 1 where the
        model holds.
        """
        sd = random_sd(self.measured)
        if sd is None:
            return None
        difference = np.abs(self.predicted.value - self.measured.value)
        return np.asarray(difference / np.maximum(np.sqrt(2) * sd, np.finfo(float).tiny))

    def __str__(self) -> str:
        damping = (_ratio(self.predicted_damping), _ratio(self.measured_damping))
        error = self.damping_ratio_error
        rows = [
            ("", "predicted", "measured", "difference"),
            (
                "peak frequency, Hz",
                f"{self.predicted_hz:.3f}",
                f"{self.measured_hz:.3f}",
                f"{100 * self.frequency_error:+.2f} %",
            ),
            (
                "peak height, 1/kg",
                f"{self.predicted_peak:.2f}",
                f"{self.measured_peak:.2f}",
                f"{self.ratio_db:+.2f} dB",
            ),
            ("damping ratio", *damping, "" if error is None else f"{100 * error:+.1f} %"),
        ]
        lines = [f"{a:<20}{b:>12}{c:>12}{d:>13}" for a, b, c, d in rows]
        lines.append(
            f"{self.band[0]:.4g} to {self.band[1]:.4g} Hz, {len(self.measured.frequency)} lines: "
            f"FRAC {self.frac:.4f}, rms {self.rms_db:.2f} dB"
            + ("" if self.z_rms is None else f", rms z {self.z_rms:.2f}")
        )
        lines += [
            f"arm tau = {arm.tau:.4g} s: {100 * arm.loss_share:.1f} % of the model's loss at the "
            f"measured peak, {'seen' if arm.seen_by_relaxation else 'not seen'} by the relaxation"
            for arm in self.arms
        ]
        lines += [f"[{check.name}] {check.says}" for check in self.checks if not check.passed]
        return "\n".join([*lines, self.verdict])


def compare(
    predicted: FRF,
    measured: FRF,
    *,
    model: GeneralizedMaxwell | None = None,
    fit: Fit | None = None,
    mass: float | None = None,
    seals: float = 1.0,
    band: tuple[float, float] | None = None,
    depth: float | None = None,
) -> Comparison:
    r"""Hold a predicted FRF against a measured one, on the measured lines.

    The measurement is never interpolated. Both peaks are read off the measured lines in the same
    way (:func:`~dashpot.vibration.peaks.find_peak`). Figures over the lines are

    .. math::

        \mathrm{FRAC} = \frac{|\sum \bar H_p H_m|^2}{\sum |H_p|^2 \sum |H_m|^2}, \qquad
        \mathrm{rms} = \sqrt{\overline{(20 \log_{10} |H_p/H_m|)^2}}, \qquad
        z = \frac{|H_p - H_m|}{\sqrt 2\,\sigma}

    Where the measured FRF carries an exponential window or a cut record and a solid is known, the
    prediction is made anew as that test would see it: at :math:`s = j\omega + a` and cut after the
    same time.

    Parameters
    ----------
    predicted : FRF
        Predicted at ``measured.frequency``, any kind.
    measured : FRF
    model : GeneralizedMaxwell, optional
        The solid behind the prediction; `seals` times it carries the mass.
    fit : Fit, optional
        Where the solid came from: gives `model`, and tells which arms the relaxation test saw.
    mass : float, optional
        kg; with a solid known but no mass given, the mass inside `predicted` is used.
    seals : float
        How many such solids carry the mass.
    band : (float, float), optional
        Lines to compare, Hz. By default those within a factor of 4 of the measured peak.
    depth : float, optional
        Compression of the relaxation test, m, for the check of the operating point.

    Raises
    ------
    DataError
        If the prediction is on other lines, or was made for another window and no solid is
        given to make it anew.
    """
    model = _solid(model, fit, seals)
    measured = _lines(measured.to(Kind.ACCELERANCE), band)
    given = _on_lines(predicted.to(Kind.ACCELERANCE), measured)
    if model is not None and mass is None:
        mass = _mass_within(given, model)
    given = _as_tested(given, measured, model, mass)
    keep = _compared(measured, find_peak(measured), explicit=band is not None)
    measured, given = _take(measured, keep), _take(given, keep)
    seen, told = find_peak(measured), find_peak(given)
    comparison = Comparison(
        predicted=given,
        measured=measured,
        predicted_hz=told.frequency,
        measured_hz=seen.frequency,
        predicted_peak=told.height,
        measured_peak=seen.height,
        predicted_damping=_model_damping(model, mass, told),
        measured_damping=_measured_damping(seen),
        frac=_frac(given.value, measured.value),
        rms_db=_rms_db(given.value, measured.value),
        z_rms=None,
        arms=_evidence(model, fit, seen.frequency),
        checks=(),
        verdict="",
        band=(float(measured.frequency[0]), float(measured.frequency[-1])),
        measured_hz_se=seen.frequency_se,
        measured_damping_se=seen.damping_se,
    )
    z = comparison.z
    if z is not None:
        comparison = replace(comparison, z_rms=float(np.sqrt(np.mean(z**2))))
    checks = _checks(comparison, seen, told, model, fit, mass, depth)
    comparison = replace(comparison, checks=checks)
    return replace(comparison, verdict=_verdict(comparison, fit))


# -- bringing both to the same lines ----------------------------------------------------------


def _solid(
    model: GeneralizedMaxwell | None, fit: Fit | None, seals: float
) -> GeneralizedMaxwell | None:
    if model is None and fit is not None:
        model = fit.model
    return None if model is None else seals * model


def _lines(measured: FRF, band: tuple[float, float] | None) -> FRF:
    return measured if band is None else measured.band(*band)


def _on_lines(predicted: FRF, measured: FRF) -> FRF:
    """The prediction at the measured lines, which must be among its own."""
    where = np.searchsorted(predicted.frequency, measured.frequency)
    where = np.clip(where, 1, len(predicted.frequency) - 1)
    left, right = predicted.frequency[where - 1], predicted.frequency[where]
    where = where - (measured.frequency - left < right - measured.frequency)
    off = np.abs(predicted.frequency[where] - measured.frequency)
    step = float(np.median(np.diff(measured.frequency))) if len(measured.frequency) > 1 else 1.0
    if off.max() > 1e-6 * step:
        i = int(np.argmax(off))
        raise DataError(
            f"the prediction has no line at {measured.frequency[i]:.6g} Hz, where there is a "
            f"measured one (its nearest is at {predicted.frequency[where[i]]:.6g} Hz); a "
            "measurement is not interpolated: predict at measured.frequency"
        )
    return replace(
        predicted,
        frequency=measured.frequency,
        value=predicted.value[where],
        coherence=None,
        sd=None,
    )


def _mass_within(predicted: FRF, model: GeneralizedMaxwell) -> float:
    """The mass that the prediction was made with: what D(s) - K(s) leaves over s^2."""
    stiffness = predicted.to(Kind.DYNAMIC_STIFFNESS)
    ratio = (stiffness.value - model.stiffness_at(stiffness.s)) / stiffness.s**2
    mass = float(np.median(ratio.real))
    if not mass > 0 or float(np.median(np.abs(ratio - mass))) > 1e-3 * mass:
        raise DataError(
            "the prediction was not made with this solid: what is left of its dynamic stiffness "
            f"is no mass (about {mass:.4g} kg); check seals=, or give mass="
        )
    return mass


def _as_tested(
    predicted: FRF, measured: FRF, model: GeneralizedMaxwell | None, mass: float | None
) -> FRF:
    """The prediction as the test would see it: its window and its cut record included."""
    if model is not None and mass is not None:
        s = measured.s
        value = s**2 / (mass * s**2 + model.stiffness_at(s))
        if measured.record is not None and measured.frequency[0] > 0:
            value = cut_accelerance(model, mass, s, measured.record)
        return replace(predicted, value=value, shift=measured.shift, record=measured.record)
    if not np.isclose(predicted.shift, measured.shift, rtol=1e-6, atol=1e-9):
        raise DataError(
            f"the measured FRF carries an exponential window of {measured.shift:.6g} 1/s and the "
            f"prediction one of {predicted.shift:.6g} 1/s: predict with shift=measured.shift, "
            "or give model= and mass="
        )
    return predicted


def _compared(measured: FRF, peak: Peak, *, explicit: bool) -> BoolArray:
    keep = usable_lines(measured)
    if not explicit:
        near = (measured.frequency >= peak.frequency / AROUND_THE_PEAK) & (
            measured.frequency <= peak.frequency * AROUND_THE_PEAK
        )
        keep = keep & near
    return keep


def _take(frf: FRF, keep: BoolArray) -> FRF:
    return replace(
        frf,
        frequency=frf.frequency[keep],
        value=frf.value[keep],
        coherence=None if frf.coherence is None else frf.coherence[keep],
        sd=None if frf.sd is None else frf.sd[keep],
    )


# -- figures ----------------------------------------------------------------------------------


def _frac(a: ComplexArray, b: ComplexArray) -> float:
    return float(np.abs(np.vdot(a, b)) ** 2 / (np.vdot(a, a).real * np.vdot(b, b).real))


def _rms_db(a: ComplexArray, b: ComplexArray) -> float:
    return float(np.sqrt(np.mean((20 * np.log10(np.abs(a) / np.abs(b))) ** 2)))


def _model_damping(
    model: GeneralizedMaxwell | None, mass: float | None, peak: Peak
) -> float | None:
    if model is None or mass is None:
        return peak.damping_ratio if peak.damping_ratio > 0 else None
    p = poles(model, mass)
    ringing = p[p.imag > 0]
    if not ringing.size:
        return None
    pole = ringing[np.argmin(np.abs(ringing.imag - 2 * np.pi * peak.frequency))]
    return float(-pole.real / abs(pole))


def _measured_damping(peak: Peak) -> float | None:
    known = peak.damping_ratio > 0 and peak.decay < UNDECAYED
    return peak.damping_ratio if known else None


def _evidence(
    model: GeneralizedMaxwell | None, fit: Fit | None, frequency: float
) -> tuple[ArmEvidence, ...]:
    if model is None or not model.arms:
        return ()
    omega = 2 * np.pi * frequency
    x = omega * np.asarray(model.tau)
    loss = np.asarray(model.k) * x / (1 + x**2)
    share = loss / (loss.sum() + omega * model.b)
    return tuple(
        ArmEvidence(tau, float(part), _seen(fit, j))
        for j, (tau, part) in enumerate(zip(model.tau, share, strict=True), start=1)
    )


def _seen(fit: Fit | None, arm: int) -> bool:
    """Whether the test behind the fit pins this arm: inside its band, k > 3 SE, SE(ln tau) < 0.5."""
    if fit is None or arm > fit.model.arms:
        return False
    own = 1 / (2 * np.pi * fit.model.tau[arm - 1])
    if not fit.band[0] / 2 <= own <= fit.band[1] * 2:
        return False
    rows = dict(zip(fit.parameters, np.diag(fit.covariance), strict=True))
    k_var, tau_var = rows.get(f"k_{arm}"), rows.get(f"ln_tau_{arm}")
    if k_var is None or tau_var is None:
        return True
    return bool(fit.model.k[arm - 1] > 3 * np.sqrt(k_var) and np.sqrt(tau_var) < 0.5)


# -- words ------------------------------------------------------------------------------------


def _checks(
    c: Comparison,
    seen: Peak,
    told: Peak,
    model: GeneralizedMaxwell | None,
    fit: Fit | None,
    mass: float | None,
    depth: float | None,
) -> tuple[Check, ...]:
    checks = [_frequency(c), _height(c), _damping(c, seen), _units(c), _resolution(c, seen, told)]
    if fit is not None:
        checks += [_extrapolation(c, fit), _tested(c, fit)]
    if model is not None and mass is not None and model.k_inf > 0:
        checks.append(_operating_point(model, mass, depth))
    return tuple(checks)


def _frequency(c: Comparison) -> Check:
    error = c.frequency_error
    passed = abs(error) <= FREQUENCY_LIMIT
    says = (
        f"the predicted peak is at {c.predicted_hz:.3f} Hz, the measured one at "
        f"{c.measured_hz:.3f} Hz ({100 * error:+.2f} %), so the storage stiffness there is "
        f"{100 * ((1 + error) ** 2 - 1):+.1f} % off"
    )
    advice = "" if passed else ": check mass, number of seals, length and preload"
    return Check("stiffness_agrees", passed, says + advice, abs(error), FREQUENCY_LIMIT)


def _height(c: Comparison) -> Check:
    passed = abs(c.ratio_db) <= PEAK_LIMIT_DB
    says = (
        f"the predicted peak is {10 ** (c.ratio_db / 20):.3g} times the measured one "
        f"({c.ratio_db:+.1f} dB)"
    )
    cause = "damping is underestimated" if c.ratio_db > 0 else "damping is overestimated"
    return Check(
        "peak_agrees", passed, says + ("" if passed else f": {cause}"), c.ratio_db, PEAK_LIMIT_DB
    )


def _damping(c: Comparison, seen: Peak) -> Check:
    if c.measured_damping is None or c.predicted_damping is None:
        says = (
            f"the damping ratio is not given: at the end of the record the response is still at "
            f"{100 * seen.decay:.0f} % of its start; record longer"
            if seen.decay >= UNDECAYED
            else "the damping ratio is not given: one of the two curves has no damped peak"
        )
        return Check("damping_agrees", False, says)
    ratio = c.predicted_damping / c.measured_damping
    passed = 1 / DAMPING_LIMIT <= ratio <= DAMPING_LIMIT
    says = (
        f"predicted damping ratio {100 * c.predicted_damping:.3g} %, measured "
        f"{100 * c.measured_damping:.3g} %: {ratio:.3g} times"
    )
    return Check("damping_agrees", passed, says, ratio, DAMPING_LIMIT)


def _units(c: Comparison) -> Check:
    """Unit slips leave their mark: sqrt(1000) on a frequency, 9.81 or 1000 on a height."""
    frequency = c.measured_hz / c.predicted_hz
    height = float(np.median(np.abs(c.measured.value) / np.abs(c.predicted.value)))
    for ratio, factor, words in (
        (frequency, np.sqrt(1000), "a factor 1000 in mass or stiffness (g for kg, N/mm for N/m)"),
        (height, GRAVITY, "acceleration in g where m/s^2 was meant"),
        (height, 1000.0, "mm for m, or mN for N"),
    ):
        if abs(abs(np.log(ratio)) - np.log(factor)) < np.log(1.1):
            says = f"measured over predicted is {ratio:.3g}, close to {factor:.4g} or its inverse: "
            return Check("no_unit_slip", False, says + f"it looks like {words}", ratio, factor)
    says = "neither frequency nor height is off by the factor of a unit slip"
    return Check("no_unit_slip", True, says, frequency)


def _resolution(c: Comparison, seen: Peak, told: Peak) -> Check:
    lines = min(seen.half_power_lines, told.half_power_lines)
    which = "measured" if seen.half_power_lines <= told.half_power_lines else "predicted"
    passed = lines >= 5
    says = f"{lines:.1f} lines lie in the half-power band of the {which} peak"
    if not passed:
        says += (
            ": the lines themselves step over the peak; its height is read off the parabola of "
            "the inverse response, so record longer for a peak you can see"
        )
    return Check("lines_resolve_the_peak", passed, says, lines, 5.0)


def _extrapolation(c: Comparison, fit: Fit) -> Check:
    low, high = fit.band
    factor = max(c.measured_hz / high, low / c.measured_hz)
    passed = factor <= 1
    says = (
        f"the measured peak at {c.measured_hz:.4g} Hz lies inside the band that the fit can "
        f"inform, {low:.2g} to {high:.2g} Hz"
        if passed
        else f"the measured peak at {c.measured_hz:.4g} Hz is outside the band that the fit can "
        f"inform, {low:.2g} to {high:.2g} Hz: the prediction is extrapolated "
        f"x{factor:.3g}"
    )
    return Check("inside_identified_band", passed, says, factor, 1.0)


def _tested(c: Comparison, fit: Fit) -> Check:
    """Whether the loss that the hammer saw is of arms that the relaxation test can see."""
    low, high = fit.band
    tau = 1 / (2 * np.pi * c.measured_hz)
    inside = low <= c.measured_hz <= high
    lead = max(c.arms, key=lambda arm: arm.loss_share, default=None)
    if inside:
        says = (
            f"an arm that matters for damping at {c.measured_hz:.4g} Hz relaxes in about "
            f"{_time(tau)}, which the test behind the fit can see"
        )
        return Check("damping_tested", True, says, tau)
    says = (
        f"damping at {c.measured_hz:.4g} Hz comes from arms that relax in about {_time(tau)}; the "
        f"relaxation test sees {_time(1 / (2 * np.pi * high))} to {_time(1 / (2 * np.pi * low))}"
    )
    if lead is not None:
        says += (
            f", and {100 * lead.loss_share:.1f} % of the predicted loss is the far tail of the arm "
            f"at tau = {lead.tau:.4g} s, which acts as a spring here"
        )
    says += "; a faster ramp or a joint fit with this FRF (identify) tests it"
    return Check("damping_tested", False, says, tau, 1 / (2 * np.pi * high))


def _operating_point(model: GeneralizedMaxwell, mass: float, depth: float | None) -> Check:
    sag = mass * GRAVITY / model.k_inf
    says = f"under its own weight the mass sinks {1e3 * sag:.2f} mm into the seals"
    if depth is None:
        return Check("operating_point", True, says, sag)
    passed = abs(sag - depth) <= 0.25 * depth
    if passed:
        says += f", close to the {1e3 * depth:.3g} mm of the relaxation test"
    else:
        says += (
            f", but the relaxation test was at {1e3 * depth:.3g} mm: unless the seals were "
            "pre-compressed the two tests are at different operating points, and a stiffness that "
            "depends on depth makes them differ"
        )
    return Check("operating_point", passed, says, sag, depth)


def _verdict(c: Comparison, fit: Fit | None) -> str:
    passed = {check.name: check.passed for check in c.checks}
    slip = next(check for check in c.checks if check.name == "no_unit_slip")
    if not slip.passed:
        return f"A unit slip is likely before anything else: {slip.says}."
    stiffness = "agrees" if passed["stiffness_agrees"] else "does not agree"
    first = f"Stiffness {stiffness} (peak frequency {100 * c.frequency_error:+.1f} %)"
    damped = passed["peak_agrees"] and passed["damping_agrees"]
    size = f"peak {c.ratio_db:+.1f} dB"
    if c.damping_ratio_error is not None:
        size += f", damping ratio {100 * c.damping_ratio_error:+.0f} %"
    if fit is None:
        second = f"damping {'agrees' if damped else 'does not agree'} ({size})"
        return f"{first}; {second}."
    tested = next(check for check in c.checks if check.name == "damping_tested")
    if tested.passed:
        return f"{first}; damping {'agrees' if damped else 'does not agree'} ({size})."
    second = "and damping happens to agree, though it" if damped else "but damping"
    return f"{first}, {second} is not tested by the relaxation test ({size}): {tested.says}."


def _ratio(value: float | None) -> str:
    return "not given" if value is None else f"{100 * value:.3f} %"


def _time(value: float) -> str:
    return f"{1e3 * value:.3g} ms" if value < 1 else f"{value:.3g} s"
