"""Fit of a solid to a dynamic (DMA) test, alone or with relaxation tests."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.checks import Check
from dashpot.base.errors import FitError
from dashpot.base.option_fields import FamilyOption, require_choice
from dashpot.base.provenance import Step, list_sources, list_steps
from dashpot.base.reported_values import NORMAL
from dashpot.base.units import Quantity, convert_to_si
from dashpot.datamodel.bounds import BandError, EndOfHold
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.fit_diagnostics import Evidence, Provenance
from dashpot.datamodel.parameter_estimate import Residual
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.curves.checks import (
    bands_overlap,
    data_agree,
    instrument_stiff,
    kramers_kronig,
    loss_positive,
    run_plateau_checks,
    storage_rises,
    values_enough,
)
from dashpot.extensions.curves.curve_uncertainty import (
    MIN_FITTED_SHARE,
    CurveData,
    find_admissible_spectra,
    find_valid_band,
    fit_single_test,
    is_limited,
    limit_end_of_curve,
    weight_curve,
)
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.datamodel.superposition import Superposition, UnshiftedCurve
from dashpot.extensions.curves.relaxation_spectrum import (
    EDGE_FACTOR,
    compute_passive_misfit,
    dense_spectrum_if_needed,
    dynamic_master_curve,
    get_error_scale,
)
from dashpot.extensions.curves.shift_uncertainty import find_band_with_shift_errors
from dashpot.extensions.curves.superposition.superpose import superpose
from dashpot.fitting.admissible_spectra import (
    AdmissibleSpectra,
    compute_end_limits,
    deviance_limit,
)
from dashpot.fitting.checks.solid import (
    arms_distinct,
    arms_supported,
    loss_factor_determined,
    order_agreed,
    residuals_white,
    tau_inside_window,
)
from dashpot.fitting.data_blocks import FitData, FitSetup, compress_tests
from dashpot.fitting.fit_construction import build_fit
from dashpot.fitting.fit_options import FitOptions, checked_family, require_maxwell_family
from dashpot.fitting.fractional_model.family_selection import (
    FractionalFit,
    describe_fit,
    select_family,
)
from dashpot.fitting.input_tests import Tests, ramp_holds, refuse_copies
from dashpot.fitting.marginal_relaxation import RelaxationData, RelaxationRows
from dashpot.fitting.order_selection import SelectedModel, select_order, validate_arm_count
from dashpot.fitting.relaxation_likelihood import build_fitted_data
from dashpot.fitting.valid_band import ErrorFunction, find_informed_band
from dashpot.numerics.design_matrices.block import DataBlock, design_block
from dashpot.preprocessing.checks import check_temperature
from dashpot.solids.maxwell import Solid


def make_frequency_block(
    omega: FloatArray,
    stiffness: FloatArray,
    *,
    weights: tuple[FloatArray, FloatArray] | None = None,
    dashpot: bool = False,
) -> DataBlock:
    r"""Return storage and loss stiffness at given frequencies as one block of real rows.

    .. math:: K' + jK'' = k_\infty + \sum_j k_j \frac{j\omega\tau_j}{1 + j\omega\tau_j}
        + j\omega b

    Parameters
    ----------
    omega : array, shape (m,)
        rad/s, > 0, any order.
    stiffness : complex array, shape (m,)
        K' + jK'', N/m.
    weights : (array, array), optional
        1/sd of K' and of K'', each shape (m,); 1 by default.
    dashpot : bool
        Add the column of a parallel dashpot, named ``b``.
    """
    omega = np.asarray(omega, dtype=float)
    stiffness = np.asarray(stiffness, dtype=complex)
    ones = np.ones(len(omega))
    weight = np.concatenate(weights if weights is not None else (ones, ones))
    spring = np.concatenate((ones, 0 * omega))
    damper = np.concatenate((0 * omega, omega))
    names = ("k_inf", "b") if dashpot else ("k_inf",)
    fixed = np.column_stack((spring, damper)[: len(names)]) * weight[:, None]

    def columns(tau: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
        x = omega[:, None] * tau
        arms = np.concatenate((x * x, x)) / np.tile(1 + x * x, (2, 1)) * weight[:, None]
        if not derivative:
            return arms, arms
        # d/d ln tau of jx/(1+jx) is jx/(1+jx)^2
        slope = np.concatenate((2 * x * x, x * (1 - x * x))) / np.tile((1 + x * x) ** 2, (2, 1))
        return arms, slope * weight[:, None]

    return design_block(
        target=np.concatenate((stiffness.real, stiffness.imag)) * weight,
        fixed=fixed,
        fixed_names=names,
        columns=columns,
        window=(0.1 / float(omega.max()), 10 / float(omega.min())),
    )


FAMILY_ADVICE = "a sweep to higher frequencies or a colder one"


Weights: TypeAlias = Literal["relative", "modulus"]

# ratio above which a faster arm acts as a dashpot in a sweep
_DASHPOT_RATIO = 30.0
# ratio up to which a slower arm still adds loss at the lowest lines
_SLOW_ARM_RATIO = 1000.0
# weights of one temperature, and of several
_USUAL_WEIGHTS: tuple[Weights, Weights] = ("relative", "modulus")


def fit_dynamic(
    data: DynamicTest | Superposition,
    *,
    arms: int | Literal["auto"] = "auto",
    tests: Tests = (),
    weights: Weights | None = None,
    dashpot: bool = False,
    temperature: Quantity | None = None,
    thorough: bool = False,
    max_arms: int = 6,
    family: FamilyOption = "maxwell",
    common_errors: Sequence[ComplexArray] = (),
) -> Fit:
    r"""Fit a generalized Maxwell solid to storage and loss, and to relaxation tests with them.

    .. math:: K' + jK'' = k_\infty + \sum_j k_j \frac{j\omega\tau_j}{1 + j\omega\tau_j}
        \; [+ j\omega b]

    No starting guess is needed. Residuals of storage and of loss are relative to what the best
    solid of the sweep alone expects there; then each curve, and each relaxation test, is divided
    by its own scatter about the best solid that it alone allows, so that every test speaks as
    loudly as it is sure.

    Parameters
    ----------
    data : DynamicTest or Superposition
        One temperature; or several, shifted to a master curve first, by the defaults of
        :func:`~dashpot.extensions.curves.superposition.superpose.superpose`; frequencies in any
        order.
    arms : int or "auto"
        Number of Maxwell arms; ``"auto"`` takes the number that BIC with the effective sample
        size and the significance of every arm both support.
    tests : RampHold, RelaxationTest or sequence of them
        Prepared relaxation tests of the same part, fitted in the same stack by their recorded
        motion, each with its own tare and drift. `data` must then be in N/m.
    weights : "relative" or "modulus"
        Errors of storage and of loss relative each to its own size, or both to the size of the
        complex modulus (an error of the phase), as by default those of a master curve.
    dashpot : bool
        Allow a parallel dashpot b; not together with `tests`.
    temperature : float, optional
        K; takes the samples within 1 K of it out of sweeps at several temperatures.
    thorough : bool
        Add quasi-random starts.
    max_arms : int
        The most that ``"auto"`` tries.
    family : "maxwell", "fractional" or "auto"
        Arms, a fractional Zener model, or the one that BIC prefers, as in
        :func:`~dashpot.fitting.relaxation.fit`; of one temperature.
    common_errors : sequence of array
        Relative changes of the lines, in order of frequency, by one standard deviation of each
        error that all of them share; of one temperature without `tests`.

    Returns
    -------
    Fit
        `method` is ``"dynamic"``, `unit` that of the data; the residual is relative, with `tests`
        in units of scatter. Of several temperatures, the solid is that of their reference, and
        where no few arms follow it, the positive spectrum that all of them share.
        `band` is the measured frequencies, Hz, and with tests also what they inform, unless
        more than a decade between the two was not measured.

    Raises
    ------
    FitError
        If sweeps at several temperatures cannot be shifted, a storage is not above 0, or an
        option makes no sense.
    """
    temperature = convert_to_si(temperature, "temperature")
    checked_family(family, arms)
    data, origin = _select_one_temperature(data, temperature)
    records = _build_records(tests, data, dashpot=dashpot)
    shifted = isinstance(origin, Superposition)
    if shifted:
        _validate_temperature_options(family, records)
    weights = weights or _USUAL_WEIGHTS[shifted]
    max_arm_count = validate_arm_count(arms, max_arms)
    sets = (
        _build_sweep(data, weights, dashpot=dashpot, max_arms=max_arm_count),
        *_build_relaxation_sets(records, max_arm_count),
    )
    selection = select_order(
        _stack_parts(sets), FitOptions(arms, max_arms=max_arms, thorough=thorough)
    )
    family_choice = select_family(selection, family)
    selection = family_choice.best
    band, overlap_check = _find_band(data, records, sets[1:], selection.model.k_0)
    curve = _weight_sweep(data, sets[0])
    find_band = partial(
        _find_valid_band, data, curve, band, origin=origin, common_errors=common_errors
    )
    if records:
        end, band, band_error = _limit_with_records(
            data,
            curve,
            records,
            sets[1:],
            selection=family_choice.arms,
            solid=selection.solid,
            band=band,
        )
    else:
        tau = family_choice.arms.model.tau
        end = _compute_end_limits(data, curve, selection, tau)
        band, band_error = find_band(selection.solid, tau)
    other = family_choice.alternative(band, FAMILY_ADVICE)
    data_checks = (
        kramers_kronig(compute_passive_misfit(data)),
        loss_positive(data),
        instrument_stiff(data),
        *origin.checks,
    )
    options = (
        ("arms", str(arms)),
        ("weights", weights),
        ("dashpot", str(dashpot).lower()),
        ("temperature", "all" if temperature is None else f"{temperature:g} K"),
        ("thorough", str(thorough).lower()),
    )
    error = _get_relative_errors(selection.solid, data, weights if shifted else "relative")
    residual = (
        replace(selection.residual, unit="sd")
        if records
        else _compute_residual_statistics(error, selection.residual)
    )
    fit_with_few_arms = build_fit(
        selection.make_solid_estimate(residual, selection.nuisances()),
        Evidence(
            band,
            selection.orders,
            selection.certificate,
            checks=(
                selection.convergence_check,
                *data_checks,
                *check_temperature(data.specimen),
                *_run_checks(
                    selection, data, records, end, [n for item in sets for n in item.record_dof]
                ),
                values_enough(
                    len(data.frequency),
                    "frequencies",
                    are_limited=is_limited(end, band_error, selection.solid, band),
                ),
                *family_choice.checks(other),
                *overlap_check,
                loss_factor_determined(band_error),
            ),
            alternative=other,
            end_of_hold=end,
            band_error=band_error,
        ),
        Provenance(
            "dynamic",
            (*origin.sources, *list_sources(records)),
            (*origin.steps, *list_steps(records), _make_step(data, records, selection, options)),
            data.specimen,
        ),
        unit=data.unit,
        temperatures=origin.temperatures,
    )
    if records or arms != "auto" or dashpot or fit_with_few_arms.family != "maxwell":
        return fit_with_few_arms
    return dense_spectrum_if_needed(
        fit_with_few_arms, error, origin, lambda: dynamic_master_curve(data), data_checks,
        find_band=lambda model: find_band(model, model.tau),
    )  # fmt: skip


def fit_complex_modulus(
    frequency: FloatArray,
    modulus: ComplexArray,
    *,
    arms: int | Literal["auto"] = "auto",
    family: FamilyOption = "maxwell",
    specimen: Specimen | None = None,
    common_errors: Sequence[ComplexArray] = (),
) -> Fit:
    """Fit a solid to a complex modulus, Pa, at frequencies, Hz, as a dynamic test is fitted.

    `common_errors` holds one standard deviation of what spoils all lines together: the relative
    change of each, for each cause.
    """
    test = DynamicTest(
        frequency, modulus.real, modulus.imag, specimen=specimen or Specimen(), units="SI"
    )
    return fit_dynamic(test, arms=arms, family=family, common_errors=common_errors)


def _get_relative_errors(solid: Solid, data: DynamicTest, weights: str) -> FloatArray:
    """Errors of storage, then of loss, relative to each, or both to the complex modulus."""
    K = solid.complex_stiffness(omega=data.omega)
    storage, loss = get_error_scale(data)
    if weights == "modulus":
        storage = loss = np.abs(data.value)
    return np.concatenate(((K.real - data.storage) / storage, (K.imag - data.loss) / loss))


def _compute_residual_statistics(error: FloatArray, weighted: Residual) -> Residual:
    """Statistics of relative errors, whose neighbours say as much alike as weighted ones do."""
    sse, rms = float(error @ error), float(np.sqrt(np.mean(error**2)))
    return replace(weighted, n=len(error), sse=sse, rms=rms, unit="1")


class _WeightedDataSet(NamedTuple):
    """One data set in units of its scatter: the block to solve, and one block per record.

    Also the degrees of freedom of each separate fit, and the scatter of a record, N.
    """

    block: DataBlock
    record_blocks: tuple[DataBlock, ...]
    record_dof: tuple[float, ...]
    scatter: float = 1.0


def _select_one_temperature(
    data: DynamicTest | Superposition, temperature: float | None
) -> tuple[DynamicTest, Superposition | UnshiftedCurve]:
    """Return the fitted data in order of frequency, and their source."""
    if isinstance(data, DynamicTest) and temperature is None and data.several_temperatures:
        data = superpose(data)
    if isinstance(data, Superposition):
        if temperature is not None or not isinstance(data.curve, DynamicTest):
            raise FitError(
                "a master curve of storage and loss is fitted whole, at its own reference: no one "
                "temperature of it, and no moduli over time"
            )
        return data.curve, data
    if temperature is not None:
        data = data.select_temperature(temperature)
    data = data.only(np.argsort(data.frequency, kind="stable"))
    return data, UnshiftedCurve(list_sources([data]), (storage_rises(data),))


def _validate_temperature_options(family: str, records: Sequence[RampHold]) -> None:
    """Refuse options that apply only to a sweep at one temperature."""
    require_maxwell_family(family)
    if records:
        raise FitError(
            "the sweeps are of several temperatures, the relaxation tests of one: choose the "
            "sweep of theirs with --at-temperature (Python: temperature=)"
        )


def _build_records(tests: Tests, data: DynamicTest, *, dashpot: bool) -> tuple[RampHold, ...]:
    records = ramp_holds(tests)
    refuse_copies(records)
    if records and data.unit != "N/m":
        raise FitError(
            f"the sweep is in {data.unit}, the relaxation tests in N and m; multiply storage and "
            "loss by area over height to get N/m, or fit the two alone"
        )
    if records and dashpot:
        raise FitError(
            "a parallel dashpot is fitted to a sweep alone; leave out dashpot=True or the tests "
            "(an arm much faster than the sweep is such a dashpot)"
        )
    return records


def _stack_parts(sets: Sequence[_WeightedDataSet]) -> FitData:
    return FitData(
        [item.block for item in sets], [row for item in sets for row in item.record_blocks]
    )


def _build_sweep(
    data: DynamicTest, weights: str, *, dashpot: bool, max_arms: int
) -> _WeightedDataSet:
    _validate_data(data, weights)
    n = len(data.frequency)
    first = _build_sweep_block(
        data, _compute_expected_size(data, data.value, weights), dashpot=dashpot
    )
    best = fit_single_test([first], _split_storage_and_loss(first, n), max_arms)
    # the size of noisy data is a biased weight: low values would speak loudest
    storage, loss = _compute_expected_size(
        data, best.model.complex_stiffness(omega=data.omega), weights
    )
    scale = (storage * best.scatter[0], loss * best.scatter[1])
    block = _build_sweep_block(data, scale, dashpot=dashpot)
    return _WeightedDataSet(block, _split_storage_and_loss(block, n), best.record_dof)


def _build_sweep_block(
    data: DynamicTest, scale: tuple[FloatArray, FloatArray], *, dashpot: bool
) -> DataBlock:
    return make_frequency_block(
        data.omega,
        data.value,  # type: ignore[arg-type]
        weights=(1 / scale[0], 1 / scale[1]),
        dashpot=dashpot,
    )


def _validate_data(data: DynamicTest, weights: str) -> None:
    require_choice("weights", weights, Weights, FitError)
    bad_indices = np.flatnonzero(data.storage <= 0)
    if bad_indices.size:
        i = int(bad_indices[0])
        raise FitError(
            f"the storage at {data.frequency[i]:.3g} Hz is {data.storage[i]:g}; no viscoelastic "
            "model has a storage <= 0 (mass moved along, or the phase is wrong): leave it out"
        )


def _compute_expected_size(
    data: DynamicTest, expected: ComplexArray, weights: str
) -> tuple[FloatArray, FloatArray]:
    """Return what errors of storage and loss are relative to: the size expected of each."""
    size = np.maximum(np.abs(expected), MIN_FITTED_SHARE * np.abs(data.value))
    if weights == "modulus":
        return size, size
    storage, loss = get_error_scale(data)
    return (
        np.maximum(np.abs(expected.real), MIN_FITTED_SHARE * storage),
        np.maximum(np.abs(expected.imag), MIN_FITTED_SHARE * loss),
    )


def _split_storage_and_loss(block: DataBlock, n: int) -> tuple[DataBlock, DataBlock]:
    """Return the storage and the loss of a sweep as records of their own, in order of frequency."""
    first, second = slice(0, n), slice(n, 2 * n)
    return (
        block.transform_rows(lambda part: part[first], samples=n),
        block.transform_rows(lambda part: part[second], samples=n),
    )


def _build_relaxation_sets(records: Sequence[RampHold], max_arms: int) -> list[_WeightedDataSet]:
    design = FitSetup("full")
    blocks = compress_tests(records, design)
    sets = []
    for block in blocks:
        fit = fit_single_test([block], [block.exact], max_arms)
        scatter = fit.scatter[0]
        record_blocks = (block.exact.scale_rows(1 / scatter),)
        sets.append(
            _WeightedDataSet(block.scale_rows(1 / scatter), record_blocks, fit.record_dof, scatter)
        )
    return sets


def _weight_sweep(data: DynamicTest, sweep: _WeightedDataSet) -> CurveData | None:
    """Return the lines of a sweep with their errors; None if they are few."""
    window = (
        1 / (_DASHPOT_RATIO * float(data.omega.max())),
        _SLOW_ARM_RATIO / float(data.omega.min()),
    )
    return weight_curve(sweep.block, data.frequency, window=window)


def _compute_end_limits(
    data: DynamicTest, curve: CurveData | None, selection: SelectedModel, tau: Sequence[float]
) -> EndOfHold | None:
    """Return the limits of the storage below a sweep; None for one of few lines."""
    if curve is None:
        return None
    slowest = 1 / float(data.omega.min())
    return limit_end_of_curve(curve, "sweep", time=slowest, model=selection.model, extra=tau)


@dataclass(frozen=True, eq=False)
class _WithoutDashpot:
    """A relaxation test beside a sweep, in which the fastest arms stand for a dashpot."""

    data: RelaxationData

    @property
    def window(self) -> tuple[float, float]:
        return self.data.window

    def rows(self, log_tau: FloatArray, *, with_slopes: bool) -> RelaxationRows:
        rows = self.data.rows(log_tau, with_slopes=with_slopes)
        return rows._replace(dashpot=np.zeros_like(rows.dashpot))


def _limit_with_records(
    data: DynamicTest,
    curve: CurveData | None,
    records: Sequence[RampHold],
    sets: Sequence[_WeightedDataSet],
    *,
    selection: SelectedModel,
    solid: Solid,
    band: tuple[float, float],
) -> tuple[EndOfHold | None, tuple[float, float], BandError | None]:
    """Return the limits at the end of the holds, and the valid band of sweep and tests together.

    They are of every spectrum that neither the sweep nor the tests reject.
    """
    model, estimate = selection.model, selection.estimate
    relaxations = [
        build_fitted_data(
            record, item.block.scale_rows(item.scatter), model, item.scatter * residual
        )
        for record, item, residual in zip(records, sets, estimate.residuals[2:], strict=True)
    ]
    spectra = AdmissibleSpectra(
        [*([] if curve is None else [curve]), *map(_WithoutDashpot, relaxations)],
        fastest=float(data.omega.max()),
        limit=deviance_limit(0.95, estimate.dof),
        extra=model.tau,
    )
    end = compute_end_limits(
        relaxations,
        time=max(record.hold_time for record in records),
        model=model,
        dof=estimate.dof,
        spectra=spectra,
    ).widen_to_contain(model)
    band, error = find_valid_band(spectra, solid, band)
    if error is not None:
        error = replace(error, misfit=_compute_misfit_in_band(solid, data, band))
    return end, band, error


def _find_valid_band(
    data: DynamicTest,
    curve: CurveData | None,
    band: tuple[float, float],
    solid: Solid,
    tau: Sequence[float],
    *,
    origin: Superposition | UnshiftedCurve,
    common_errors: Sequence[ComplexArray],
) -> tuple[tuple[float, float], BandError | None]:
    """Return where in a band a sweep knows a solid, Hz, and the errors there.

    The whole band without errors for a sweep of few lines.
    """
    if curve is None:
        return band, None
    spectra = find_admissible_spectra(curve, time=1 / float(data.omega.min()), extra=tau)
    if common_errors:
        add_errors = partial(_CommonErrors, data.frequency, common_errors)
        band, error = find_valid_band(spectra, solid, band, add_errors=add_errors)
    else:
        band, error = find_band_with_shift_errors(spectra, solid, band, origin=origin)
    if error is not None:
        error = replace(error, misfit=_compute_misfit_in_band(solid, data, band))
    return band, error


@dataclass(frozen=True, eq=False)
class _CommonErrors:
    """Relative errors of a solid at a frequency, with those that all lines share."""

    frequency: FloatArray
    relative_changes: Sequence[ComplexArray]
    solid: Solid
    errors: ErrorFunction

    def __call__(self, frequency: float) -> tuple[float, float]:
        """Return the relative errors of stiffness and loss factor at a frequency, Hz."""
        K = complex(self.solid.complex_stiffness(omega=2 * np.pi * frequency))
        log_lines = np.log(self.frequency)
        changed = K * np.array(
            [1 + np.interp(np.log(frequency), log_lines, item) for item in self.relative_changes]
        )
        sizes = np.abs(changed) / abs(K) - 1
        factors = (changed.imag / changed.real) / (K.imag / K.real) - 1
        stiffness, loss_factor = self.errors(frequency)
        return (
            float(np.hypot(stiffness, NORMAL * np.linalg.norm(sizes))),
            float(np.hypot(loss_factor, NORMAL * np.linalg.norm(factors))),
        )


def _compute_misfit_in_band(
    solid: Solid, data: DynamicTest, band: tuple[float, float]
) -> tuple[float, float]:
    """Return the relative misfit of stiffness and loss factor of a line in a band."""
    in_band = (data.frequency >= band[0]) & (data.frequency <= band[1])
    K, measured = solid.complex_stiffness(omega=data.omega), data.value
    is_compared = in_band & (data.loss > 0)
    magnitude = np.abs(np.abs(K) / np.abs(measured) - 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        loss = np.abs((K.imag / K.real) / (measured.imag / measured.real) - 1)
    return float(np.max(magnitude[in_band], initial=0.0)), float(
        np.max(loss[is_compared], initial=0.0)
    )


def _run_checks(
    selection: SelectedModel,
    data: DynamicTest,
    records: Sequence[RampHold],
    end: EndOfHold | None,
    degrees_of_freedom: Sequence[float],
) -> tuple[Check, ...]:
    """Return the checks of the fit; `degrees_of_freedom` are those of the separate fits."""
    model, estimate, error = selection.model, selection.estimate, selection.error
    shortest, longest = 1 / float(data.omega.max()), 1 / float(data.omega.min())
    if records:
        shortest = min(shortest, *(2 * float(np.diff(record.time).min()) for record in records))
        longest = max(longest, *(record.hold_time for record in records))
    arm_checks = (
        []
        if isinstance(selection, FractionalFit)
        else [
            arms_distinct(model),
            arms_supported(model, error, unit=data.unit),
            tau_inside_window(
                model,
                (shortest / EDGE_FACTOR, longest * EDGE_FACTOR),
                "the sweep and the holds" if records else "the sweep",
            ),
        ]
    )
    fastest = float(model.complex_stiffness(omega=data.omega.max()).real)
    sweep_advice = "Sweep to lower frequencies."
    all_checks = [
        *arm_checks,
        *run_plateau_checks(
            model,
            float(error[0]),
            # a hold ends elsewhere
            None if records else end,
            unit=data.unit,
            first=fastest,
            remedy=sweep_advice,
        ),
        residuals_white(estimate.kappa, estimate.rms),
        *([] if selection.choice is None else [order_agreed(selection.choice)]),
        *selection.check_arm_count("sd"),
    ]
    if records:
        residual_sds = [
            float(np.sqrt(np.mean(residual**2) * noise.kappa))
            for residual, noise in zip(estimate.residuals, estimate.noises, strict=True)
        ]
        names = ["storage", "loss", *(f"relaxation test {i + 1}" for i in range(len(records)))]
        all_checks.append(data_agree(residual_sds, names, degrees_of_freedom))
    return tuple(all_checks)


def _find_band(
    data: DynamicTest, records: Sequence[RampHold], sets: Sequence[_WeightedDataSet], k_0: float
) -> tuple[tuple[float, float], tuple[Check, ...]]:
    """Return the frequencies of the tests' valid bands, and whether there is a gap."""
    sweep = (float(data.frequency.min()), float(data.frequency.max()))
    if not records:
        return sweep, ()
    # the blocks are in units of their own scatter
    blocks = [item.block for item in sets]
    relaxation_band = find_informed_band(records, blocks, stiffness=max(k_0, 1e-300), noise=1.0)
    overlap_check = bands_overlap(sweep, relaxation_band)
    if overlap_check.failed:
        return sweep, (overlap_check,)
    return (min(sweep[0], relaxation_band[0]), max(sweep[1], relaxation_band[1])), (overlap_check,)


def _make_step(
    data: DynamicTest,
    records: Sequence[RampHold],
    selection: SelectedModel,
    options: tuple[tuple[str, str], ...],
) -> Step:
    n = len(records)
    text = "" if not n else f" and {n} relaxation test{'s' * (n > 1)}"
    message = (
        f"fitted {describe_fit(selection)} to storage and loss at {len(data.frequency)} "
        f"frequencies{text}"
    )
    return Step("fit_dynamic", options, message)
