"""Construction of a `Fit` from an identification: family, errors, nuisances, changes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.checks import Check
from dashpot.base.provenance import Step, list_sources, list_steps
from dashpot.base.reported_values import NORMAL
from dashpot.datamodel.bounds import MAX_LOSS_FACTOR_ERROR, BandError, EndOfHold
from dashpot.datamodel.fit import LINES_IN_BAND, Fit
from dashpot.datamodel.fit_diagnostics import (
    Alternative,
    Evidence,
    OrderScore,
    ParameterChange,
    Provenance,
)
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.machine import DEFAULT_UNCERTAINTIES
from dashpot.datamodel.parameter_estimate import (
    Nuisance,
    ParameterEstimate,
    Residual,
    parameter_names,
)
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.shift_factors import TemperatureShifts
from dashpot.datamodel.specimen import Specimen
from dashpot.fitting.checks.solid import optimiser_converged
from dashpot.fitting.fit_construction import SolidEstimate, build_fit
from dashpot.fitting.fractional_model.checks import (
    fractional_model_suffices,
    fractional_slope_determined,
    model_families_distinguished,
)
from dashpot.fitting.fractional_model.family_selection import DECISIVE_FAMILY_BIC, build_alternative
from dashpot.fitting.identification import checks
from dashpot.fitting.identification.discrepancy_causes import Discrepancy, agreement
from dashpot.fitting.identification.likelihood import LINEAR_UNITS, UNCHANGED, Candidate
from dashpot.fitting.identification.parametrisation import Arms, FractionalElement, is_at_edge
from dashpot.fitting.identification.prior_knowledge import HammerRig
from dashpot.fitting.marginal_relaxation import RelaxationData
from dashpot.fitting.valid_band import find_loss_factor_band
from dashpot.numerics.inference.model_order import is_significant_fall
from dashpot.numerics.least_squares import stack_real_rows
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import Solid

# Arms or a fractional element, with a hammer test: which family is selected, and the alternative.
#
# The rule is that of tests alone (:mod:`dashpot.fitting.fractional_model.family_selection`): arms
# keep their place unless BIC falls by more than 10, and what chance does not distinguish from the
# best is reported beside it.


# Tests that would distinguish the model families, for a hammer test and for a joint fit.
_HAMMER_ADVICE, _JOINT_ADVICE = (
    "a relaxation test of the seal",
    "a colder test or a hammer on another mass",
)


class AlternativeCandidate(NamedTuple):
    """Best candidate of the other family.

    Attributes
    ----------
    best, other : Candidate
    explains : bool
        What it leaves may be chance, or BIC does not distinguish the two.
    """

    best: Candidate
    other: Candidate
    explains: bool

    @property
    def worst_misfit_ratio(self) -> float:
        """Ratio of the misfits of both families, of the test where it is worst."""
        own_misfits, other_misfits = (
            _compute_misfits(candidate) for candidate in (self.best, self.other)
        )
        return float(np.sqrt(np.max(own_misfits / np.maximum(other_misfits, 1e-300))))

    def alternative(self, band: tuple[float, float]) -> Alternative:
        """Return the other family as a fit keeps it; `band` is what the tests inform, Hz."""
        problem, bic_difference = self.best.problem, self.other.bic - self.best.bic
        hammer_only = not problem.relaxations and problem.constraints.before is None
        return build_alternative(
            self.best.point.model, self.other.point.model, bic_difference, band,
            is_sufficient=self.explains, extra=_HAMMER_ADVICE if hammer_only else _JOINT_ADVICE,
        )  # fmt: skip


def select_family_candidate(
    arms: Candidate, candidates: Sequence[Candidate], candidate: Candidate, family: str
) -> AlternativeCandidate:
    """Return the family requested, or with ``"auto"`` the one that BIC prefers, and the other.

    Parameters
    ----------
    arms : Candidate
        The number of arms taken.
    candidates : sequence of Candidate
        Every one.
    candidate : Candidate
        The best element.
    family : "fractional" or "auto"
    """
    arm_candidates = [arms, *(other for other in candidates if other.arms > arms.arms)]
    is_better = candidate.bic + DECISIVE_FAMILY_BIC < arms.bic and not is_at_bound(candidate)
    best, contenders = (
        (candidate, arm_candidates) if family == "fractional" or is_better else (arms, [candidate])
    )
    explain = [other for other in contenders if _is_equally_good(other, best)]
    return AlternativeCandidate(best, (explain or contenders)[0], bool(explain))


def reselect_family(
    family_candidate: AlternativeCandidate, refit_freed: Callable[[Candidate], Candidate]
) -> AlternativeCandidate:
    """Return the same two fits with the contradicted quantity free: a wrong mass misleads."""
    best, other = refit_freed(family_candidate.best), refit_freed(family_candidate.other)
    return AlternativeCandidate(best, other, _is_equally_good(other, best))


def is_at_bound(candidate: Candidate) -> bool:
    """Return whether a relaxation time or a slope is at an end of its range."""
    problem = candidate.problem
    numbers = candidate.theta[: problem.parametrisation.size]
    return is_at_edge(problem.parametrisation, numbers, problem.log_tau_range)


def run_family_checks(
    best: Candidate, alternative: AlternativeCandidate | None, rival: Alternative | None
) -> list[Check]:
    """Ask of an element whether it is known and explains the tests, of either for the other."""
    all_checks = []
    if isinstance(best.problem.parametrisation, FractionalElement):
        all_checks.append(
            fractional_slope_determined(
                float(np.sqrt(best.covariance[3, 3])), edge=is_at_bound(best)
            )
        )
        if alternative is not None:
            all_checks.append(
                fractional_model_suffices(alternative.worst_misfit_ratio, alternative.other.arms)
            )
    return all_checks if alternative is None else [*all_checks, model_families_distinguished(rival)]


def _compute_misfits(candidate: Candidate) -> np.ndarray:
    """Squared misfit of the lines, then of each relaxation test."""
    return np.array([candidate.line_misfit, *candidate.relaxation_chi2])


def _is_equally_good(rival: Candidate, best: Candidate) -> bool:
    extra_parameters = len(best.theta) - len(rival.theta)
    bic_difference = rival.bic - best.bic
    deviance_fall = bic_difference + extra_parameters * float(np.log(best.samples))
    return bic_difference < DECISIVE_FAMILY_BIC or not is_significant_fall(
        deviance_fall, max(extra_parameters, 1)
    )


# What the rig of a hammer may add to a response that no channel shows.
#
# Each effect is a stiffness :math:`\delta K(s)` beside the n seals, of which the accelerance
# follows
#
# .. math:: \delta A = -\frac{A^2}{s^2}\,\delta K
#
# with the cables of accelerometers :math:`\epsilon K' (1 + j\eta_c)(\omega/\omega_r)^\alpha`, K' of
# the seals at the resonance, and half of their own loss once more, as eta_c is known to half of it.
# One loss factor eta_c at every frequency is that of a stiffness that rises by
# :math:`\alpha = (2/\pi)\arctan\eta_c` (Kramers and Kronig). Further a table that gives,
# :math:`-\epsilon_t K^2/K'`; a mass that moves along, :math:`\epsilon_m m s^2`. Sizes are those of
# :data:`~dashpot.datamodel.machine.DEFAULT_UNCERTAINTIES`. A high-pass of the accelerometer alone
# adds its corner times the derivative of A by it: the default's where the hammer is alone; beside
# relaxation tests the root mean square of what both leave of it. A window whose decay a has the
# error :math:`\sigma_a` adds :math:`\sigma_a\,\partial A/\partial a`.
#
# A fit is of the quiet rig; its parameters follow an effect c by :math:`\delta\theta = C J' c`.


# Step of the finite difference by the decay rate of a window, in its standard errors.
_DECAY_STEP = 1e-3


def compute_hammer_rig_sensitivity(best: Candidate, rig: HammerRig) -> FloatArray:
    """Return by how much the flat parameter vector follows each effect, shape (p, d).

    Parameters
    ----------
    best : Candidate
        The optimum.
    rig : HammerRig
        With what is stated of its cables.
    """
    problem = best.problem
    rows = (
        stack_real_rows(_compute_rig_effects(best, rig) / problem.frf_data.sd[:, None])
        / problem.scale
    )
    row_count = sum(len(rows) for rows in best.model_prediction.tests)
    slope = best.model_prediction.slope[row_count : row_count + len(rows)]
    covariance = np.where(np.isfinite(best.covariance), best.covariance, 0.0)
    sensitivity = np.asarray(covariance @ (slope.T @ rows))
    if not problem.is_hammer_alone:
        # a relaxation test shows a high-pass: its mean square by both tests, over that before them
        information = rows[:, 0] @ (rows[:, 0] - slope @ sensitivity[:, 0])
        precision = 1 + max(float(information), 0.0)
        mean = float(rows[:, 0] @ best.model_prediction.lines) / precision
        sensitivity[:, 0] *= np.sqrt(1 / precision + mean**2)
    return sensitivity


def _compute_rig_effects(best: Candidate, rig: HammerRig) -> ComplexArray:
    """Return what each effect adds to the predicted lines, one standard deviation a column."""
    data, point = best.problem.frf_data, best.point
    response = data.response(point.seal_under_hammer, point.mass)
    s, accelerance = response.s, response.accelerance
    seals = s**2 / accelerance - point.mass * s**2
    peak_k = complex((data.seals * point.seal_under_hammer).stiffness_at(2j * np.pi * data.peak_hz))
    loss = DEFAULT_UNCERTAINTIES["loss of the cable"].size
    rise = (s.imag / (2 * np.pi * data.peak_hz)) ** (2 / np.pi * np.arctan(loss))
    cable = rig.cable_sd * abs(peak_k.real) * rise
    rig_columns = np.column_stack((
        (1 + 1j * loss) * cable,
        1j * loss / 2 * cable,
        -DEFAULT_UNCERTAINTIES["table"].size * seals**2 / abs(peak_k.real),
        DEFAULT_UNCERTAINTIES["mass that moves along"].size * point.mass * s**2,
    ))  # fmt: skip
    by = -(accelerance**2 / s**2)[:, None] * rig_columns
    line_slopes, *_, high_pass_slope = data.slopes(response, *point.channel, by)
    line_slopes = np.column_stack((rig.high_pass_sd * high_pass_slope, line_slopes))
    error = data.lines.shift_sd
    if error <= 0:
        return line_slopes
    step = _DECAY_STEP * error
    shifted_windows = (
        replace(data, lines=replace(data.lines, shift=data.lines.shift + change))
        for change in (step, -step)
    )
    raised_lines, lowered_lines = (
        item.predict(item.response(point.seal_under_hammer, point.mass), *point.channel)
        for item in shifted_windows
    )
    return np.column_stack((line_slopes, error * (raised_lines - lowered_lines) / (2 * step)))


# Construction of a fit: errors, nuisances, changes.


# Distance in ln tau below which two arms count as the same.
SAME_ARM_DISTANCE = 1.0


def build_identified_fit(
    best: Candidate,
    orders: Sequence[Candidate],
    *,
    frf: FRF,
    tests: Sequence[RampHold],
    earlier_fit: Fit | None,
    fit: Fit | None,
    doubtful_tests: Sequence[RelaxationData],
    request: int | str,
    requested_arms: int,
    discrepancy: Discrepancy | None,
    family_candidate: AlternativeCandidate | None,
    dashpot: tuple[Check, ...],
    rig: HammerRig,
) -> Fit:
    """Return the fit of one seal, with everything needed to judge it.

    `earlier_fit` is what was known of the seal before the hammer, `fit` that of the same family;
    `doubtful_tests` are its tests with all that their rigs may have done without a trace.
    """
    point, covariance = best.point, best.covariance
    names, values, physical = _compute_physical_parameters(best)
    rig_sensitivity = _compute_rig_sensitivity(best, physical, doubtful_tests, rig)
    if discrepancy is not None:
        # which of the two solids is right is a doubt of its own
        physical = physical + np.outer(
            *[values - _compute_physical_parameters(best, discrepancy.other)[1]] * 2
        )
    residual, samples = _compute_residual(best)
    band = compute_data_band(best, earlier_fit)
    alternative = None if family_candidate is None else family_candidate.alternative(band)
    estimate = ParameterEstimate(
        names,
        physical,
        dof=max(samples - len(best.theta), 1.0),
        residual=residual,
        nuisance=_list_nuisances(best, covariance),
    )
    in_band = np.asarray(2j * np.pi * np.geomspace(*band, LINES_IN_BAND), dtype=complex)
    errors = (np.inf, np.inf)
    if earlier_fit is None and isinstance(best.problem.parametrisation, Arms):
        errors = estimate.errors_of_vibration(point.model.maxwell, in_band)
    all_checks = (
        *_run_checks(best, covariance, earlier_fit, discrepancy, errors),
        *run_family_checks(best, family_candidate, alternative),
        *dashpot,
    )
    noise_estimate, estimate = estimate, estimate.with_rig(rig_sensitivity)
    band, band_error = _find_loss_factor_band(best, band, noise_estimate, estimate)
    high_pass = rig.high_pass_sd if best.problem.is_hammer_alone else 0.0
    cables = checks.cables_described(
        band_error, best.problem.frf_data.peak_hz, rig.cable_sd, high_pass
    )
    all_checks = (*all_checks, cables)
    end_of_hold = compute_end_of_data(best, earlier_fit, estimate)
    law = None if earlier_fit is None else earlier_fit.elastic_law
    return build_fit(
        SolidEstimate(
            point.model,
            estimate,
            has_fewer_arms=request != "auto" and requested_arms > point.model.maxwell.arms,
            at_bound=is_at_bound(best),
        ),
        Evidence(
            band,
            orders=tuple(_make_order_score(candidate) for candidate in orders),
            checks=all_checks,
            parameter_changes=()
            if fit is None
            else _compare_parameters(fit, point.model, names, physical, end_of_hold),
            explanations=() if discrepancy is None else discrepancy.explanations,
            alternative=alternative,
            end_of_hold=end_of_hold,
            band_error=band_error,
        ),
        Provenance(
            "joint" if tests or earlier_fit is not None else "frf",
            (*frf.source, *list_sources(tests)),
            (*frf.steps, *list_steps(tests), _make_step(best)),
            _select_specimen(tests, earlier_fit),
        ),
        elastic_law=None if law is None else replace(law, stiffness=point.model.k_inf),
        temperatures=None if earlier_fit is None else _get_temperature_shifts(earlier_fit),
    )


def compute_end_of_data(
    best: Candidate, earlier_fit: Fit | None, estimate: ParameterEstimate
) -> EndOfHold | None:
    r"""Return the limits of the stiffness at rest; None if no test limits it.

    A hammer says nothing of it: with a hold it is what the hold leaves. Of vibration alone it is at
    most the storage at the lowest line, :math:`k_\infty \le K'(\omega_1)`, for
    :math:`K' - k_\infty = \sum_j k_j \omega^2\tau_j^2/(1 + \omega^2\tau_j^2) \ge 0`.
    """
    solid = best.point.model
    if earlier_fit is not None and earlier_fit.evidence.end_of_hold is not None:
        return earlier_fit.evidence.end_of_hold.widen_to_contain(solid)
    of_arms = estimate.convert_to_arms(solid) if isinstance(solid, FractionalZener) else estimate
    model = solid.maxwell
    rows = [of_arms.parameters.index(name) for name in parameter_names(model.arms)]
    covariance = of_arms.covariance[np.ix_(rows, rows)]
    if not np.isfinite(covariance).all():
        return None
    omega = 2 * np.pi * float(best.problem.frf_data.lines.frequency[0])
    slope = model.arm_slopes(np.array([1j * omega]))[0][0].real
    half_width = of_arms.quantile(0.95) * float(np.sqrt(max(slope @ covariance @ slope, 0.0)))
    storage = float(solid.complex_stiffness(omega=omega).real)
    low, high = max(storage - half_width, 0.0), storage + half_width
    return EndOfHold(
        end_time=1 / omega,
        k_end=(low, high),
        k_3end=(0.0, high),
        k_inf=(0.0, high),
        test_kind="frf",
    ).widen_to_contain(solid)


def _get_temperature_shifts(earlier_fit: Fit) -> TemperatureShifts | None:
    """Return how the solid of the relaxation tests moves with temperature; the hammer is of one."""
    shifts = earlier_fit.temperatures
    return None if shifts is None else replace(shifts, cross=shifts.cross[-1:])


def _select_specimen(tests: Sequence[RampHold], earlier_fit: Fit | None) -> Specimen:
    """Return the piece that the relaxation tests were made on."""
    if earlier_fit is not None and earlier_fit.temperatures is not None:
        return earlier_fit.specimen
    if tests:
        return max(tests, key=lambda test: test.depth).specimen
    return Specimen() if earlier_fit is None else earlier_fit.specimen


def _compute_physical_parameters(
    best: Candidate, model: Solid | None = None
) -> tuple[tuple[str, ...], FloatArray, FloatArray]:
    """Names, values and covariance of the solid's parameters; values of another model, if given."""
    problem, parametrisation = best.problem, best.problem.parametrisation

    def physical(theta: FloatArray) -> FloatArray:
        b = [np.exp(theta[problem.index["b"]])] if problem.dashpot else []
        return np.append(parametrisation.physical(theta[: parametrisation.size])[1], b)

    names = (
        parametrisation.physical(best.theta[: parametrisation.size])[0] + ("b",) * problem.dashpot
    )
    quantity = best.estimate.derive_quantity(physical)
    if model is None:
        return names, quantity.values, quantity.covariance
    b = [model.maxwell.b] if problem.dashpot else []
    return (
        names,
        np.append(parametrisation.physical(parametrisation.pack(model))[1], b),
        quantity.covariance,
    )


def _compute_rig_sensitivity(
    best: Candidate,
    covariance: FloatArray,
    doubtful_tests: Sequence[RelaxationData],
    rig: HammerRig,
) -> FloatArray:
    r"""Return the errors of the solid by the rigs of relaxation and hammer test, shape (p, d).

    Their gradient is J'c, and C J'c the change of the solid, C being the covariance of
    all that was fitted. An earlier fit without its tests has as gradient its change
    times :math:`C_0^{-1}`.
    """
    parameter_count = len(covariance)
    gradients = [
        data.compute_rig_gradient(best.point.model)[:parameter_count] for data in doubtful_tests
    ]
    prior = best.problem.constraints.before
    if prior is not None and best.problem.earlier is not None:
        earlier_indices, _, root = best.problem.earlier
        gradients.append(np.zeros((parameter_count, len(earlier_indices))))
        gradients[-1][earlier_indices] = np.linalg.solve(
            root @ root.T, _compute_rig_covariance_root(prior, best)
        )
    hammer_gradient = _differentiate_physical_parameters(best) @ compute_hammer_rig_sensitivity(
        best, rig
    )
    indices = np.where(np.isfinite(covariance), covariance, 0.0)
    return np.hstack([*(indices @ gradient for gradient in gradients), hammer_gradient])


def _differentiate_physical_parameters(best: Candidate) -> FloatArray:
    """Return derivative of the solid's parameters by the flat vector."""
    problem, parametrisation = best.problem, best.problem.parametrisation
    slope = np.zeros((parametrisation.size + problem.dashpot, len(best.theta)))
    slope[: parametrisation.size, : parametrisation.size] = parametrisation.physical(
        best.theta[: parametrisation.size]
    )[2]
    if problem.dashpot:
        slope[-1, problem.index["b"]] = np.exp(best.theta[problem.index["b"]])
    return slope


def _compute_rig_covariance_root(earlier_fit: Fit, best: Candidate) -> FloatArray:
    """A root of what rigs add to the covariance of an earlier fit, in the rows that are kept."""
    estimate = earlier_fit.estimate
    rows = best.problem.earlier_rows
    added_covariance = (estimate.covariance - estimate.noise_only.covariance)[np.ix_(rows, rows)]
    values, vectors = np.linalg.eigh(added_covariance)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))


def _compute_residual(best: Candidate) -> tuple[Residual, float]:
    lines, relaxations = 2 * len(best.problem.frf_data.lines.s), best.problem.relaxations
    effective = lines + sum(relaxation.samples for relaxation in relaxations)
    n = lines + sum(relaxation.block.samples for relaxation in relaxations)
    rms = float(np.sqrt(best.chi2 / effective))
    kappa = float(n / effective)
    return Residual(n=n, sse=best.chi2, rms=rms, variance_inflation=kappa, unit="sd"), float(
        effective
    )


def _make_order_score(candidate: Candidate) -> OrderScore:
    return OrderScore(
        candidate.point.model.maxwell.arms,
        candidate.chi2,
        candidate.bic,
        candidate.significant,
        candidate.point.model.maxwell,
    )


def _find_loss_factor_band(
    best: Candidate,
    band: tuple[float, float],
    noise_estimate: ParameterEstimate,
    estimate: ParameterEstimate,
) -> tuple[tuple[float, float], BandError]:
    """Return the part of a band around the peak in which the loss factor is known, and how well.

    What a rig may add without a trace counts, but where it alone leaves the loss factor open at
    the peak:
    the band is then what the noise leaves of it, and its errors say what the rig may have added.
    """
    solid, peak = best.point.model, best.problem.frf_data.peak_hz
    model = solid.maxwell

    def errors_by(parameter_estimate: ParameterEstimate) -> Callable[[float], tuple[float, float]]:
        arms = (
            parameter_estimate.convert_to_arms(solid)
            if isinstance(solid, FractionalZener)
            else parameter_estimate
        )

        def errors(line: float) -> tuple[float, float]:
            s = np.array([2j * np.pi * line], dtype=complex)
            stiffness, loss_factor = arms.errors_of_vibration(model, s)
            return NORMAL * stiffness, NORMAL * loss_factor

        return errors

    full_errors, noise = errors_by(estimate), errors_by(noise_estimate)
    # an error by a covariance costs little: so many lines place the ends to a few per cent
    lines = sorted({*np.geomspace(*band, 8 * LINES_IN_BAND).tolist(), peak})
    errors = full_errors if full_errors(peak)[1] <= MAX_LOSS_FACTOR_ERROR else noise
    values, band_error = find_loss_factor_band(
        errors, band, {line: errors(line) for line in lines}, included_line=peak
    )
    if errors is full_errors:
        return values, band_error
    entries = {line: full_errors(line) for line in band_error.frequency}
    return values, replace(
        band_error,
        stiffness=tuple(error[0] for error in entries.values()),
        loss_factor=tuple(error[1] for error in entries.values()),
    )


def compute_data_band(best: Candidate, earlier: Fit | None) -> tuple[float, float]:
    """Return the valid band: an octave about the peak, and that of the relaxation test."""
    frf_data = best.problem.frf_data
    low = max(frf_data.peak_hz / 2, float(frf_data.lines.frequency[0]))
    high = min(frf_data.peak_hz * 2, float(frf_data.lines.frequency[-1]))
    return (
        (low, high) if earlier is None else (min(low, earlier.band[0]), max(high, earlier.band[1]))
    )


def _list_nuisances(best: Candidate, covariance: FloatArray) -> tuple[Nuisance, ...]:
    index, point = best.problem.index, best.point
    items = [("mass", "mass", "kg"), ("gain", "gain", "1"), ("delay", "delay", "s")]
    items += [
        (title, name, "1")
        for title, name in (("stiffness_factor", "factor"), ("k_inf_factor", "spring"))
        if getattr(best.problem.priors, name) != UNCHANGED
    ]
    items += [("high_pass", "high_pass", "Hz")] * ("high_pass" in index)
    nuisances = []
    for title, name, unit in items:
        value = float(getattr(point, name))
        number = covariance[index[name], index[name]] if name in index else 0.0
        scale = LINEAR_UNITS.get(name, value)
        nuisances.append(Nuisance(title, value, float(np.sqrt(number)) * scale, unit))
    return tuple(nuisances)


def _make_step(best: Candidate) -> Step:
    frf_data, relaxations = best.problem.frf_data, best.problem.relaxations
    return Step(
        "identify",
        (
            ("lines", str(len(frf_data.lines.s))),
            ("band_hz", f"{frf_data.lines.frequency[0]:.6g} {frf_data.lines.frequency[-1]:.6g}"),
            ("seals", f"{frf_data.seals:g}"),
            ("relaxation_tests", str(len(relaxations))),
            ("scatter_scaled_by", f"{best.problem.scale:.6g}"),
        ),
        f"fitted {len(frf_data.lines.s)} lines of the FRF"
        + (f" together with {len(relaxations)} relaxation test(s)" if relaxations else ""),
    )


def _compare_parameters(
    earlier_fit: Fit,
    solid: Solid,
    names: tuple[str, ...],
    covariance: FloatArray,
    end: EndOfHold | None,
) -> tuple[ParameterChange, ...]:
    """Return each parameter before and after; arms are matched by their relaxation times."""
    # as the fit of both weighed it
    noise_estimate = earlier_fit.estimate.noise_only.covariance
    old_errors, new_errors = (
        dict(zip(rows, np.sqrt(np.diag(matrix)).tolist(), strict=True))
        for rows, matrix in ((earlier_fit.estimate.parameters, noise_estimate), (names, covariance))
    )
    # title and unit, then value and row before and after
    if isinstance(solid, FractionalZener):
        rows: list[tuple[str, str, float | None, str, float, str]] = [
            (name, unit, getattr(earlier_fit.solid, name), row, getattr(solid, name), row)
            for name, unit, row in (
                ("k_inf", "N/m", "k_inf"), ("k_0", "N/m", "k_0"), ("tau", "s", "ln_tau"),
                ("alpha", "1", "alpha"),
            )
        ]  # fmt: skip
    else:
        old_model, new_model = earlier_fit.model, solid.maxwell
        rows = [("k_inf", "N/m", old_model.k_inf, "k_inf", new_model.k_inf, "k_inf")]
        partner = _match_arms(old_model.tau, new_model.tau)
        for j, (k, tau) in enumerate(zip(new_model.k, new_model.tau, strict=True)):
            i = partner.get(j)
            k0, tau0 = (None, None) if i is None else (old_model.k[i], old_model.tau[i])
            arm_number = 0 if i is None else i + 1
            rows.append((f"k_{j + 1}", "N/m", k0, f"k_{arm_number}", k, f"k_{j + 1}"))
            rows.append((f"tau_{j + 1}", "s", tau0, f"ln_tau_{arm_number}", tau, f"ln_tau_{j + 1}"))
    if solid.maxwell.b > 0:
        rows.append(("b", "N s/m", earlier_fit.model.b, "", solid.maxwell.b, "b"))

    def error(errors: dict[str, float], row: str, value: float) -> float:
        return errors[row] * (value if row.startswith("ln_") else 1.0)

    changes = []
    for title, unit, value_before, error_before, value_after, error_after in rows:
        if title == "k_inf":
            upper_limit = None if end is None else end.k_inf[1]
            changes.append(
                ParameterChange(
                    title,
                    value_before,
                    None,
                    value_after,
                    None,
                    unit,
                    earlier_fit.intervals()["k_inf"][1],
                    upper_limit,
                )
            )
            continue
        reference = (
            None
            if value_before is None or error_before not in old_errors
            else error(old_errors, error_before, value_before)
        )
        changes.append(
            ParameterChange(
                title,
                value_before,
                reference,
                value_after,
                error(new_errors, error_after, value_after),
                unit,
            )
        )
    return tuple(changes)


def _match_arms(old: tuple[float, ...], new: tuple[float, ...]) -> dict[int, int]:
    """Return the old arm of each new arm: nearest pairs first, within a factor e."""
    pairs = sorted((abs(np.log(a / b)), i, j) for i, a in enumerate(old) for j, b in enumerate(new))
    entries: dict[int, int] = {}
    for distance, i, j in pairs:
        if distance < SAME_ARM_DISTANCE and j not in entries and i not in entries.values():
            entries[j] = i
    return entries


def _run_checks(
    best: Candidate,
    covariance: FloatArray,
    earlier_fit: Fit | None,
    discrepancy: Discrepancy | None,
    in_band: tuple[float, float],
) -> tuple[Check, ...]:
    leading_explanation = None if discrepancy is None else discrepancy.explanations[0]
    all_checks = [optimiser_converged(stationary=best.optimum.stationary)]
    requested_checks = agreement(best, None if discrepancy is None else discrepancy.priors)
    if earlier_fit is not None:
        check = checks.tests_agree(leading_explanation)
        if leading_explanation is not None and leading_explanation.is_sufficient:
            # what follows from the cause is no graver than the cause
            requested_checks = [
                replace(requested_check, grade=check.grade)
                if requested_check.failed
                else requested_check
                for requested_check in requested_checks
            ]
        all_checks.append(check)
    all_checks += requested_checks
    if isinstance(best.problem.parametrisation, Arms):
        arms = best.problem.parametrisation.count
        largest_error = float(max(np.sqrt(np.diag(covariance))[1 : 1 + 2 * arms], default=0.0))
        new_arms = 0 if earlier_fit is None else arms - earlier_fit.model.arms
        all_checks.append(
            checks.arms_identified(
                arms, largest_error, unknown=best.unknown, new=new_arms, in_band=in_band
            )
        )
    return tuple(all_checks)
