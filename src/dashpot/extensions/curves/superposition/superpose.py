"""Superposition of tests at several temperatures: master curve, shifts and law."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check
from dashpot.base.errors import FitError
from dashpot.base.option_fields import ShiftLaw, VerticalOption, require_choice
from dashpot.base.provenance import Step
from dashpot.base.units import Quantity, celsius, convert_to_si
from dashpot.datamodel.shift_factors import Shift, TemperatureShifts
from dashpot.extensions.curves.datamodel.creep import CreepCompliance
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.datamodel.sample_temperatures import ONE_TEMPERATURE, make_shifts
from dashpot.extensions.curves.datamodel.superposition import Superposition
from dashpot.extensions.curves.shift_law_fit import ShiftLawFit, fit_shift_law
from dashpot.extensions.curves.superposition.checks import (
    MIN_BIC_MARGIN,
    collect_shift_checks,
    isotherms_overlap,
    thermorheologically_simple,
    vertical_rule_holds,
    vertical_shift_determined,
)
from dashpot.extensions.curves.superposition.isotherms import (
    Isotherm,
    Measured,
    join_tests,
    split_isotherms,
)
from dashpot.extensions.curves.superposition.joint_spectrum import (
    ShiftedSpectrum,
    compute_vertical_step,
    fit_spectrum,
    make_grid,
    refine_shifts,
    solve_shifts,
)
from dashpot.extensions.curves.superposition.pairwise_shifts import make_chained_starts
from dashpot.solids.interconversion import CreepSpectrum, relaxation_spectrum
from dashpot.solids.maxwell import GeneralizedMaxwell

ROOM_TEMPERATURE = 296.15
"""The reference where nobody gives one: the temperature tested that is nearest to 23 degC, K."""
_LN10 = float(np.log(10.0))
# decades to which shifts are known that come without an error: as curves are overlaid by eye
_BY_EYE = 0.1
# relative misfit that is of no instrument
_NO_MATTER = 1e-3
# degrees of freedom that the temperatures alone must leave, for their scatter to be known
_MIN_DOF = 10


def superpose(
    data: Measured | Sequence[Measured],
    *,
    reference: Quantity | None = None,
    law: ShiftLaw = "auto",
    vertical: VerticalOption = "auto",
    shifts: Sequence[Shift] = (),
) -> Superposition:
    r"""Shift sweeps, moduli or creep at several temperatures onto one positive spectrum.

    .. math:: E^*_i(\omega) = b_i \Bigl(E_\infty + \sum_k h_k
        \frac{j\omega a_i\tau_k}{1 + j\omega a_i\tau_k}\Bigr), \qquad h_k \ge 0

    All shifts and the spectrum are fitted together, with errors relative to :math:`|E^*|`; nothing
    is overlaid in sequence, and nothing is smoothed. A law is laid through the shifts by their full
    covariance.

    Parameters
    ----------
    data : DynamicTest, RelaxationModulus, CreepCompliance or sequence of one of them
        Several temperatures, as the samples of one test or in one test each. A creep compliance is
        shifted as :math:`J(t) = J_r(t/a_T)/b_T`, onto one positive spectrum of retardations.
    reference : float, optional
        K, or a text such as ``"25degC"``: the tested temperature within 2 K of it; by default that
        nearest to 23 degC.
    law : str
        ``"auto"`` takes WLF or Arrhenius by BIC; or ``"wlf"``, ``"arrhenius"``, ``"free"``.
    vertical : str
        How moduli follow temperature: ``"1"``, not at all; ``"T/T_r"``, as those of an ideal
        rubber; ``"auto"``, the one of these that BIC supports; ``"free"``, one factor for each
        temperature, which ruins the horizontal shifts: a diagnostic.
    shifts : sequence of Shift
        Known shifts, taken as they are; the spectrum alone is then fitted.

    Raises
    ------
    FitError
        If there are no several temperatures, none is near the reference, or a modulus is not
        above 0.
    """
    require_choice("vertical", vertical, VerticalOption, FitError)
    test, sources = join_tests(data)
    isotherms = split_isotherms(test)
    t = np.array([isotherm.temperature for isotherm in isotherms])
    if len(t) < 2:
        raise FitError(
            f"every sample was measured at about {celsius(float(t[0]))}: a master curve needs "
            "several temperatures"
        )
    reference_index = _reference(t, convert_to_si(reference, "temperature"))
    parts = _fit_isotherms_separately(isotherms)
    if shifts:
        best, vertical_rule, checks = _apply_stated_shifts(isotherms, shifts, reference_index)
    else:
        best, vertical_rule, checks = _search_shifts(
            isotherms, reference_index, vertical, np.sqrt(parts.variance)
        )
    covariance = _compute_decadic_covariance(best, reference_index)
    table = make_shifts(t, best.ln_a / _LN10, np.exp(best.ln_b), covariance)
    shift_covariance = (
        covariance[: len(t), : len(t)] if covariance.any() else _BY_EYE**2 * np.eye(len(t))
    )
    law_fit = fit_shift_law(
        t, [shift.log10_a_t for shift in table], shift_covariance,
        reference=float(t[reference_index]), law=law
    )  # fmt: skip
    temperatures = TemperatureShifts(
        law_fit.law, table, covariance, law_fit.parameters, law_fit.covariance, vertical_rule
    )
    solid, rms = _solid(isotherms, best)
    curve, measured_at = _master(test, isotherms, best, float(t[reference_index]))
    return Superposition(
        curve,
        measured_at,
        temperatures,
        solid,
        rms,
        (
            *_collect_checks(isotherms, best, reference_index, law_fit, law),
            thermorheologically_simple(*parts.compare_with_joint(best), rms),
            *checks,
        ),
        sources,
        (_step(isotherms, temperatures, law_fit, are_stated=bool(shifts)),),
    )


class _SeparateSpectra(NamedTuple):
    """Residuals of the isotherms, each with a spectrum of its own."""

    sse: float
    dof: int

    @property
    def variance(self) -> float:
        return self.sse / max(self.dof, 1)

    def compare_with_joint(self, best: ShiftedSpectrum) -> tuple[float | None, float]:
        """Return mean square of the joint fit over this, and its upper limit by chance."""
        if self.dof < _MIN_DOF or self.sse <= 0:
            return None, 1.0
        extra_parameters = best.values - best.parameters - self.dof
        by_chance = 1 + 3 * np.sqrt(2 * max(extra_parameters, 1)) / self.dof
        return best.variance / self.variance, float(by_chance)


def _fit_isotherms_separately(isotherms: Sequence[Isotherm]) -> _SeparateSpectra:
    log_shift = np.zeros(1)
    spectra = [
        fit_spectrum([isotherm], log_shift, log_shift, make_grid([isotherm], log_shift))
        for isotherm in isotherms
    ]
    return _SeparateSpectra(
        sum(spectrum.sse for spectrum in spectra),
        sum(spectrum.values - spectrum.parameters for spectrum in spectra),
    )


def _reference(t: FloatArray, target: float | None) -> int:
    nearest_index = int(np.argmin(np.abs(t - (ROOM_TEMPERATURE if target is None else target))))
    if target is not None and abs(t[nearest_index] - target) > ONE_TEMPERATURE:
        raise FitError(
            f"no test within {ONE_TEMPERATURE:g} K of the reference of {celsius(target)}; tested "
            f"were {', '.join(celsius(item) for item in t)}"
        )
    return nearest_index


def _search_shifts(
    isotherms: Sequence[Isotherm], reference_index: int, vertical: VerticalOption, noise: float
) -> tuple[ShiftedSpectrum, str, tuple[Check, ...]]:
    """Return the shifts by the vertical rule that was requested, or that BIC takes."""
    t = np.array([isotherm.temperature for isotherm in isotherms])
    log_b_by_rule = {"1": np.zeros(len(t)), "T/T_r": np.log(t / t[reference_index])}
    vertical_rules = {"auto": ("1", "T/T_r"), "free": ("1",)}.get(vertical, (vertical,))
    spectra: dict[str, ShiftedSpectrum] = {}
    for name in vertical_rules:
        start = make_chained_starts(isotherms, log_b_by_rule[name], reference_index)
        spectra[name] = solve_shifts(
            isotherms, start, log_b_by_rule[name], reference=reference_index, noise=noise
        )
    vertical_rule = min(spectra, key=lambda name: spectra[name].bic)
    is_free = vertical == "free"
    best = refine_shifts(
        isotherms, spectra[vertical_rule], reference=reference_index, noise=noise, free_b=is_free
    )
    if is_free:
        return best, "free", (vertical_shift_determined("free", 0.0, 0.0),)
    step, score = compute_vertical_step(isotherms, best, reference=reference_index, noise=noise)
    rule_check = vertical_rule_holds(step, score, t)
    if vertical != "auto":
        return best, vertical_rule, (rule_check,)
    other = next(spectrum for name, spectrum in spectra.items() if name != vertical_rule)
    difference = float(np.abs(other.ln_a - spectra[vertical_rule].ln_a).max()) / _LN10
    # the support of a spectrum is a rough count: what both measures say is known
    spectrum = spectra[vertical_rule]
    margin = min(other.bic - spectrum.bic, other.deviance - spectrum.deviance)
    return (
        best,
        vertical_rule,
        (vertical_shift_determined(vertical_rule, margin, difference), rule_check),
    )


def _apply_stated_shifts(
    isotherms: Sequence[Isotherm], shifts: Sequence[Shift], reference_index: int
) -> tuple[ShiftedSpectrum, str, tuple[Check, ...]]:
    """Return the spectrum at shifts from elsewhere, referred to the isotherm `reference_index`."""
    values = np.array([shift.temperature for shift in shifts])
    stated_shifts = []
    for isotherm in isotherms:
        i = int(np.argmin(np.abs(values - isotherm.temperature)))
        if abs(values[i] - isotherm.temperature) > ONE_TEMPERATURE:
            raise FitError(
                f"the table of shifts has none within {ONE_TEMPERATURE:g} K of "
                f"{celsius(isotherm.temperature)}; it has {', '.join(celsius(k) for k in values)}"
            )
        stated_shifts.append(shifts[i])
    ln_a = _LN10 * np.array([shift.log10_a_t for shift in stated_shifts])
    ln_b = np.log([shift.b_t for shift in stated_shifts])
    ln_a, ln_b = ln_a - ln_a[reference_index], ln_b - ln_b[reference_index]
    vertical_rule = "free" if ln_b.any() else "1"
    return fit_spectrum(isotherms, ln_a, ln_b, make_grid(isotherms, ln_a)), vertical_rule, ()


# -- Stated shifts --------------------------------------------------------------------------------


def _compute_decadic_covariance(best: ShiftedSpectrum, reference_index: int) -> FloatArray:
    """Return the covariance of log10 a_T, then ln b_T, of every temperature, shape (2 n, 2 n)."""
    n = len(best.ln_a)
    free_indices = np.delete(np.arange(n), reference_index)
    free = np.concatenate((free_indices, free_indices + n))[: len(best.optimum.theta)]
    full_covariance = np.zeros((2 * n, 2 * n))
    if len(free):
        scale = np.where(free < n, 1 / _LN10, 1.0)
        full_covariance[np.ix_(free, free)] = best.covariance * np.outer(scale, scale)
    return full_covariance


def _collect_checks(
    isotherms: Sequence[Isotherm],
    best: ShiftedSpectrum,
    reference_index: int,
    law_fit: ShiftLawFit,
    law: ShiftLaw,
) -> tuple[Check, ...]:
    t = np.array([isotherm.temperature for isotherm in isotherms])
    values, is_law_requested = _compute_decadic_covariance(best, reference_index), law == "free"
    return (
        isotherms_overlap(_compute_overlap(isotherms, best), t),
        *collect_shift_checks(t, best.ln_a / _LN10, values, law_fit, is_requested=is_law_requested),
    )


def _compute_overlap(isotherms: Sequence[Isotherm], best: ShiftedSpectrum) -> FloatArray:
    """Return the decades of reduced time that neighbours share, negative for a gap, (n - 1,)."""
    log_ranges = np.array([isotherm.window for isotherm in isotherms]) - best.ln_a[:, None]
    return np.array(
        [
            (min(item[1], two[1]) - max(item[0], two[0])) / _LN10
            for item, two in pairwise(log_ranges)
        ]
    )  # fmt: skip


# -- Master curve ---------------------------------------------------------------------------------


def _solid(
    isotherms: Sequence[Isotherm], best: ShiftedSpectrum
) -> tuple[GeneralizedMaxwell, float]:
    """Return the spectrum as a model, and its relative residual.

    Its times end where the data do, but for half a decade where the loss still shows an arm: an
    arm of which only the tail was measured can have any stiffness.
    """
    excess = _LN10 / 2 if isotherms[0].domain == "frequency" else 0.0
    ln_tau = make_grid(isotherms, best.ln_a, excess)
    spectrum = fit_spectrum(isotherms, best.ln_a, best.ln_b, ln_tau)
    h, tau = spectrum.optimum.beta, np.exp(ln_tau)
    if isotherms[0].domain == "creep":
        # what comes to rest, as long as no flow is needed
        at_rest = fit_spectrum(isotherms, best.ln_a, best.ln_b, ln_tau[:-1])
        closer = at_rest.deviance - spectrum.deviance
        if closer < MIN_BIC_MARGIN or at_rest.rms < _NO_MATTER:
            h, spectrum = np.append(at_rest.optimum.beta, 0.0), at_rest
        d, is_positive = h[1:-1], h[1:-1] > 0
        creep = CreepSpectrum(
            float(h[0]), tuple(d[is_positive]), tuple(tau[:-1][is_positive]), float(h[-1] / tau[-1])
        )
        solid = GeneralizedMaxwell(*relaxation_spectrum(creep))
    else:
        k, is_positive = h[1:], h[1:] > 0
        solid = GeneralizedMaxwell(float(h[0]), tuple(k[is_positive]), tuple(tau[is_positive]))
    return solid, spectrum.rms


def _master(
    test: Measured, isotherms: Sequence[Isotherm], best: ShiftedSpectrum, reference: float
) -> tuple[Measured, FloatArray]:
    """Return every sample shifted to the reference temperature, and its measured temperature, K."""
    counts = [len(isotherm.at) for isotherm in isotherms]
    temperature = np.repeat([isotherm.temperature for isotherm in isotherms], counts)
    a, b = np.repeat(np.exp(best.ln_a), counts), np.repeat(np.exp(best.ln_b), counts)
    abscissa = np.concatenate([isotherm.at for isotherm in isotherms])
    specimen = replace(test.specimen, temperature=reference)
    if isinstance(test, DynamicTest):
        frequency = abscissa * a / (2 * np.pi)
        order = np.argsort(frequency, kind="stable")
        value = np.concatenate([isotherm.complex for isotherm in isotherms]) / b
        curve: Measured = DynamicTest(
            frequency[order], value.real[order], value.imag[order], None, test.unit, specimen,
            test.source, units="SI",
        )  # fmt: skip
        return curve, temperature[order]
    time, value = abscissa / a, np.concatenate([isotherm.size for isotherm in isotherms])
    value = value * b if isinstance(test, CreepCompliance) else value / b
    order = np.argsort(time, kind="stable")
    time, value, temperature = time[order], value[order], temperature[order]
    # two temperatures at the very same time are one sample of the curve
    first = np.concatenate(([True], np.diff(time) > 1e-12 * time[1:]))
    group_index = np.cumsum(first) - 1
    value = np.bincount(group_index, value) / np.bincount(group_index)
    curve = type(test)(time[first], value, test.unit, specimen, test.source, units="SI")
    return curve, temperature[first]


def _step(
    isotherms: Sequence[Isotherm],
    temperatures: TemperatureShifts,
    law_fit: ShiftLawFit,
    *,
    are_stated: bool,
) -> Step:
    cold, hottest = temperatures.tested_range
    scores = ", ".join(f"{score.kind} {score.bic:.4g}" for score in law_fit.scores)
    options = (
        ("reference", f"{temperatures.reference:g} K"),
        ("law", temperatures.law.kind),
        ("vertical", temperatures.vertical),
        ("shifts", "given" if are_stated else "fitted"),
    )
    message = (
        f"shifted {len(isotherms)} temperatures from {celsius(cold)} to {celsius(hottest)} onto "
        f"one spectrum at {celsius(temperatures.reference)}, b_T = {temperatures.vertical}, and "
        f"laid a law through the shifts (BIC: {scores})"
    )
    return Step("superpose", options, message)
