r"""Equilibrium force of a load deflection cycle: the elastic law without viscous stress.

A quasi-linear seal (Fung) relaxes from its equilibrium force :math:`e(t) = F_e(x(t))`,

.. math:: F(t) = e(t) + \sum_j g_j \int_0^t e^{-(t-u)/\tau_j}\,de(u)

so a loading branch at a finite speed is not the elastic law but its convolution. With g from a
relaxation test this is inverted exactly, from the recorded force alone: it is creep under a force
that is linear between samples. Loading and release then fall onto one curve. In air, where the
force is zero, the inverse is the free recovery of the seal, which the plate does not show.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray
from dashpot.base.checks import Check
from dashpot.base.errors import FitError
from dashpot.datamodel.fit import Fit
from dashpot.extensions.materials.cld import checks
from dashpot.extensions.materials.cld.datamodel import CLD, Branch, RelaxedLaw
from dashpot.extensions.materials.cld.local_stiffness import WINDOW, delay_channel, fit_local_slope
from dashpot.extensions.materials.relaxation_model import normalise_relaxation
from dashpot.fitting.nonlinear_ramp.quasi_linear import integrate_hats
from dashpot.fitting.prediction_bounds import off_by_error
from dashpot.numerics.inference.covariance_estimate import Estimate, estimate
from dashpot.numerics.least_squares import solve_ordinary
from dashpot.solids.elastic import ElasticLaw

KNOTS = (2, 3, 5, 9, 13, 17)
_AS_WELL = 1.05
"""Largest residual of a law on fewer knots, relative to the finest law."""
_CONTACT_SD = 5.0
"""Standard deviations of the force above which the plate is on the seal."""


def fit_relaxed_law(cld: CLD, fit: Fit | Sequence[Fit]) -> RelaxedLaw:
    """Return the elastic law under the cycle of a load deflection test.

    Parameters
    ----------
    cld : CLD
        With a clock.
    fit : Fit or sequence of Fit
        Fit of a relaxation test of such a seal. Its relaxation function k_j / k_inf is used, not
        its stiffness; that is compared with the elastic law at the compression of the test. Of
        several fits the one nearest to the nominal compression is used (`find_nearest_fit`).

    Raises
    ------
    FitError
        If the record has no clock, or the fit no stiffness at rest.
    """
    fits = (fit,) if isinstance(fit, Fit) else tuple(fit)
    fit = find_nearest_fit(cld, fits)
    relaxation = normalise_relaxation(fit.model)
    time = get_clock(cld)
    e = relaxation.displacement(time, cld.force)
    cycle = cld.cycle
    rows = find_loaded_samples(cld)
    law, residual = fit_law_through(cld.compression[rows], e[rows], depth=cycle.depth)
    measured_hysteresis = cycle.hysteresis
    fraction = None if cycle.unloading is None else _compute_loss_fraction(cld, cycle.unloading, e)
    first, last = (_compute_common_force(cld, e, number) for number in (0, -1))
    stroke = cycle.depth / cycle.speed if cycle.speed else None
    knots = np.asarray(law.knots)
    # each input one standard error off: the relaxation along each axis, both zeros, the delay
    force, delayed_force = cld.force, delay_channel(time, cld.force, cld.delay_sd)
    variants = [(0.0, normalise_relaxation(other.maxwell), force) for other in off_by_error(fit)]
    variants += [(cld.contact_se, relaxation, force), (0.0, relaxation, force + cld.zero_se)]
    # of a force that is late the contact is, too
    variants += [(-cld.contact_delay_error, relaxation, delayed_force)] * (cld.delay_sd > 0)
    laws = (
        _fit_law(cld.compression[rows] + x, model.displacement(time, motion)[rows], knots)
        for x, model, motion in variants
    )
    variant_laws = tuple(law[0] for law in laws if law is not None)
    return RelaxedLaw(
        _add_ratio_errors(law, variant_laws),
        relaxation,
        residual,
        measured_hysteresis,
        fraction,
        1 - last / first,
        (
            checks.relaxation_explains_hysteresis(measured_hysteresis, fraction),
            checks.stroke_within_relaxation_times(stroke, fit.band),
            *(check for fit in fits for check in _check_relaxed_force(cld, law, fit)),
            *(
                [checks.relaxation_tests_agree(_compare_relaxations(fits, stroke))]
                if len(fits) > 1
                else ()
            ),
        ),
        variant_laws,
    )


def find_nearest_fit(cld: CLD, fits: Sequence[Fit]) -> Fit:
    """Return the fit of the test held nearest to the nominal compression."""
    if not fits:
        raise FitError("no fit of a relaxation test was given: its relaxation function is needed")
    return min(fits, key=lambda fit: abs(get_depth(fit) - cld.nominal.compression))


def _add_ratio_errors(law: ElasticLaw, variant_laws: Sequence[ElasticLaw]) -> ElasticLaw:
    """Return the law with the errors of relaxation and zeros added to those of its tangents."""
    values = np.asarray(law.ratio_se)
    ratio_changes = [np.subtract(other.ratio, law.ratio) for other in variant_laws]
    total = np.sqrt(values**2 + sum((change**2 for change in ratio_changes), np.zeros(len(values))))
    return replace(law, ratio_se=tuple(total.tolist()))


def _compare_relaxations(fits: Sequence[Fit], stroke: float | None) -> float | None:
    """Return the largest relative difference of the relaxation functions over the time of a stroke.

    In a separable material (Lakes) the normalised relaxation is the same at every compression.
    """
    if stroke is None:
        return None
    t = np.geomspace(stroke / 20, stroke, 12)
    curves = np.stack([normalise_relaxation(fit.model).relaxation(t) for fit in fits])
    return float((curves.max(axis=0) / curves.min(axis=0) - 1).max())


def get_length_ratio(cld: CLD, fit: Fit) -> float:
    """Return the length of the specimen over that of the fit's; 1 if one is unknown."""
    lengths = cld.specimen.length, fit.specimen.length
    return lengths[0] / lengths[1] if lengths[0] and lengths[1] else 1.0


def get_depth(fit: Fit) -> float:
    """Return the depth that the stiffnesses of a fit belong to, m."""
    law = fit.elastic_law
    if law is None:
        raise FitError("the fit is of no pressed part: expected one of a relaxation test")
    return law.depth


def get_clock(cld: CLD) -> FloatArray:
    """Return the times of a record that has them, s."""
    if cld.time is None:
        raise FitError(
            "the record has no clock, and without one relaxation cannot be removed; give the rate "
            "(--rate 10Hz), or a file with a column of time"
        )
    return cld.time


def find_loaded_samples(cld: CLD) -> IndexArray:
    """Return the samples of the chosen cycle at which the plate is on the seal."""
    branches = [branch for branch in (cld.loading, cld.unloading) if branch is not None]
    rows = np.concatenate(
        [np.arange(branch.samples.start, branch.samples.stop) for branch in branches]
    )
    is_loaded = cld.force[rows] > _CONTACT_SD * cld.noise
    return np.asarray(rows[is_loaded & (cld.compression[rows] > 0)])


def fit_law_through(x: FloatArray, force: FloatArray, *, depth: float) -> tuple[ElasticLaw, float]:
    """Return the law of the fewest knots that follows points as well as the finest, and its rms.

    Its tangent is linear between knots and nowhere below 0, determined by the points at each.
    """
    laws = [_fit_law(x, force, place_knots(x, depth, count)) for count in KNOTS]
    laws_found = [law for law in laws if law is not None]
    if not laws_found:
        raise FitError(
            f"{len(x)} samples of the cycle stand out of the noise, too few for an elastic law; "
            "press slower, or record faster"
        )
    _, finest = laws_found[-1]
    return next(item for item in laws_found if item[1] <= _AS_WELL * finest + 1e-12)


def place_knots(x: FloatArray, depth: float, count: int) -> FloatArray:
    """Return 0 and even knots to a depth, but for those between 0 and where points begin."""
    even_knots = np.linspace(0.0, depth, count)
    return np.asarray(
        even_knots[
            (even_knots == 0.0) | (even_knots > np.min(x, initial=np.inf)) | (even_knots == depth)
        ]
    )


def _fit_law(
    x: FloatArray, force: FloatArray, knots: FloatArray
) -> tuple[ElasticLaw, float] | None:
    """Return the law on knots; None where the points do not determine each tangent."""
    hat_columns = integrate_hats(x, knots)
    best = solve_ordinary(force, hat_columns, positive=True)
    uncertainty = estimate(best)
    if not np.isfinite(uncertainty.standard_error).all():
        return None
    return make_law(uncertainty, knots, slice(None)), float(np.sqrt(best.sse / len(x)))


def make_law(uncertainty: Estimate, knots: FloatArray, tangent_indices: slice) -> ElasticLaw:
    """Return the law whose tangents at the knots, N/m, are among the values of an estimate."""
    ratio = uncertainty.derive_quantity(
        lambda values: values[tangent_indices] / average_slope(values[tangent_indices], knots)
    )
    return ElasticLaw(
        tuple(knots.tolist()),
        tuple(ratio.values.tolist()),
        average_slope(uncertainty.optimum.values[tangent_indices], knots),
        tuple(ratio.standard_error.tolist()),
    )


def average_slope(slope: FloatArray, knots: FloatArray) -> float:
    """Return the mean of a tangent that is linear between knots from 0 on, N/m."""
    return float(0.5 * np.diff(knots) @ (slope[1:] + slope[:-1])) / float(knots[-1])


def _compute_loss_fraction(cld: CLD, unloading: Branch, e: FloatArray) -> float:
    """Return the part of the energy that relaxed forces lose over the chosen cycle in contact."""
    rows = find_loaded_samples(cld)
    is_unloading = rows >= unloading.first
    x = cld.compression
    common_compression = max(
        float(x[rows[~is_unloading]].min()), float(x[rows[is_unloading]].min())
    )
    work_in, work_out = (
        float(np.trapezoid(e[branch.samples], np.maximum(branch.compression, common_compression)))
        for branch in (cld.loading, unloading)
    )
    return (work_in + work_out) / work_in


def _compute_common_force(cld: CLD, e: FloatArray, number: int) -> float:
    cycle = cld.cycles[number]
    relaxed_loading = replace(cycle.loading, force=e[cycle.loading.samples])
    local_slope = fit_local_slope(
        relaxed_loading, cld.common, half_width=WINDOW * cycle.depth, excess=np.inf
    )
    return np.nan if local_slope is None else local_slope.force


def _check_relaxed_force(cld: CLD, law: ElasticLaw, fit: Fit) -> list[Check]:
    """Return checks of the relaxed force against the relaxation test at each compression."""
    held_stiffnesses = [
        (stiffness_at_depth.depth, stiffness_at_depth.k_inf)
        for stiffness_at_depth in fit.evidence.stiffness_by_depth
    ] or [(get_depth(fit), fit.model.k_inf)]
    times = get_length_ratio(cld, fit)
    return [
        checks.relaxed_agrees(
            float(law.force(depth)) / (times * k_inf * depth) - 1
            if depth <= 1.01 * law.depth
            else None,
            depth,
            k_inf,
        )
        for depth, k_inf in held_stiffnesses
    ]
