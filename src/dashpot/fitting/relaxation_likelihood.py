"""Likelihood of a relaxation test: its rows, noise and rig terms."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, IndexArray, median, slow_periodogram
from dashpot.base.errors import DataError
from dashpot.base.units import celsius
from dashpot.datamodel.fit import Fit, get_fewest_arms_model
from dashpot.datamodel.machine import DEFAULT_UNCERTAINTIES
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.shift_factors import SAME_TEMPERATURE
from dashpot.fitting.data_blocks import build_record_block, first_sample, motion
from dashpot.fitting.marginal_relaxation import (
    DASHPOT_TAU_RATIO,
    LN_10,
    RelaxationData,
    ThermalShift,
    UnmeasuredEffects,
)
from dashpot.fitting.nuisance_priors import (
    LINEAR_DELAY,
    Prior,
    build_delay_prior,
    build_load_cell_priors,
    build_nuisance_terms,
    build_recorded_warming_prior,
    build_warming_prior,
    get_column_kind,
)
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.design_matrices.data_compression import uniform_step
from dashpot.numerics.design_matrices.recorded_motion import (
    MAX_SLOWNESS,
    build_recorded_block,
    window_of,
)
from dashpot.preprocessing.denoising import (
    denoise_displacement,
    estimate_interpolation_noise,
    find_rests,
)
from dashpot.signals.disturbances import (
    build_earlier_press,
    build_folded_mains,
    build_machine_terms,
    compute_set_sd,
    compute_warming,
)
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import GeneralizedMaxwell, arm_response

_LOAD_CELL_TERMS = ("offset", "drift")
# relaxation times of a record on an uneven clock are asked about from this on, s
MIN_TAU = 1e-6
# largest number of pauses of the encoder during the ramp
MAX_PAUSES = 8
# the rate of a force is that of the arms slower than so many samples
SLOW_ARM = 5.0
# what lags may be a filter, in the difference of the two
FILTER_SD = 1.0
# a doubt is smooth, and needs few digits: samples of the hold at which it is laid out, three times
# as many of the ramp, and relaxation times of which it is a sum
DOUBT_SAMPLES, DOUBT_TIMES = 100, 16
# rows of a long hold whose samples differ in weight; 10,000 would move limits by 0.5 % at most
MAX_HOLD_ROWS = 2_000
# samples of earlier loadings
MAX_HISTORY_SAMPLES = 4000
# cycles per record between which noise limits the detection of an arm
SLOWEST_NOISE, FASTEST_NOISE = 8, 160
# a line of the periodogram so far above its middle is a hum, and no noise
HUM_RATIO = 20.0
# slower noise counts where its power is so much larger: by chance it never is
SLOW_NOISE_RATIO = 2.0
# standard errors of a shift within which other spectra may move it, and never less than this, ln
_FREE_SE, _MIN_SHIFT = 5.0, 0.007
# significance of a slope, in standard errors
_SIGNIFICANT_SE = 3.0
# relative change of stiffness with temperature beyond b_T, sd
_GAIN_SD = 0.02


def build_relaxation_data(
    test: RampHold,
    fit: Fit,
    *,
    single_fit: Fit | None = None,
    for_limits: bool = True,
    shift: ThermalShift | None = None,
    shift_slopes: tuple[float, float] = (0.0, 0.0),
) -> RelaxationData:
    r"""Weight a test by its residual, and include the uncertainty of all rig effects on the force.

    Samples before first contact determine only offset and drift, and are used in their priors. A
    reading that stands, such as the first and that of the hold, is uniform within a count q of the
    encoder, a standard deviation of :math:`q/\sqrt{12}`; while it moves, what is left of counts and
    noise makes the samples worth less. Either looks like an arm faster than the ramp.

    Parameters
    ----------
    test : RampHold
    fit : Fit
        The solid whose response to a small motion gives the effect of motion errors; its method is
        kept.
    single_fit : Fit, optional
        Fit of this test alone, where `fit` is of more than this test: its solid leaves the noise.
    for_limits : bool
        For limits, which allow all that a rig may have done without a trace in the record
        (:func:`compute_unmeasured_effects`). A fit of several tests is a point, and not of the
        doubtful rig: what could be moved by so much would hide that the tests disagree.
    shift : ThermalShift, optional
        Shift of the solid of interest at the temperature of the test and of `fit`: the seal may
        then have warmed while it was recorded.
    shift_slopes : (float, float)
        Slopes of ln a_T and ln b_T there, 1/K.

    Raises
    ------
    DataError
        If the fit is of several temperatures, and the test of none of them.
    """
    if fit.temperatures is not None:
        return _shift_to_reference(test, fit, single_fit, for_limits=for_limits)
    model, solid = get_fewest_arms_model(fit), get_fewest_arms_model(single_fit or fit)
    if fit.method == "hold":
        hold_residual = _compute_arm_residual(
            solid, build_record_block(test, method="hold", terms=_LOAD_CELL_TERMS)
        )
        return build_hold_data(test, model, hold_residual, for_limits=for_limits)
    law = fit.elastic_law
    if law is not None and law.kind == "linear":
        law = None
    (time, x, force), magnitude = motion(test), denoise_displacement(test)[1]
    magnitude = np.hypot(magnitude, estimate_interpolation_noise(test, time, x, magnitude))
    if law is not None:
        x, magnitude = law.path(x), magnitude * law.factor(x)
    effect_columns = {
        name: (model.force(time, 1.0 * changed_motion), sd)
        for name, (changed_motion, sd) in _list_motion_errors(test, time).items()
    }
    if for_limits:
        sample_indices = select_motion_samples(test, time)
        for name, (column, sd) in compute_unmeasured_effects(
            test, time[sample_indices], x[sample_indices], model
        ).items():
            effect_columns[name] = np.interp(time, time[sample_indices], column), sd
    if shift is not None:
        by_a, by_b = shift_slopes
        effect_columns["warming"] = compute_warming(time, x, model, by_a=by_a, by_b=by_b), 0.0
    delay = _find_fitted_delay(single_fit or fit)
    if delay:
        effect_columns |= _build_delay_columns(test, model, time, x, delay=delay)
    columns = {name: column for name, (column, _) in effect_columns.items()}
    data_block = build_record_block(
        test, terms=_LOAD_CELL_TERMS, law=law, tau_range=_get_tau_range(test, 1.0)
    )
    residual = _compute_arm_residual(solid, data_block)
    power = max(estimate_noise_power(residual), data_block.rounding_floor)
    variance = 1 + (model.k_0 * magnitude) ** 2 / power
    average, size = _group_samples(test, time, variance)
    block = build_recorded_block(
        *map(average, (time, x, force)),
        window=slice(first_sample(test), None),
        offset="offset",
        drift="drift",
        columns={name: average(column) for name, column in columns.items()},
        weights=np.sqrt(size / average(variance)),
        tau_range=_get_tau_range(test, shift.a_t if shift else 1.0),
    )
    relaxation_data = _weight_block(
        test,
        replace(block, samples=data_block.samples),
        data_block,
        model,
        residual,
        size=float(np.hypot(_compute_law_deviation(law), estimate_set_sd(test, model))),
        rms=fit.estimate.residual.rms,
        effect_sds={get_column_kind(name): sd for name, (_, sd) in effect_columns.items()},
        for_limits=for_limits,
    )
    relaxation_data = replace(relaxation_data, delay=0.0) if delay else relaxation_data
    if shift is None:
        return relaxation_data
    relaxation_data = replace(
        relaxation_data,
        terms=relaxation_data.terms.add_terms(warming=build_recorded_warming_prior(test.specimen)),
    )
    gain = _GAIN_SD if shift.shift_sd > 0 else 0.0
    return replace(
        relaxation_data, thermal_shift=shift, size=float(np.hypot(relaxation_data.size, gain))
    )


def _group_samples(
    test: RampHold, time: FloatArray, variance: FloatArray
) -> tuple[Callable[[FloatArray], FloatArray], FloatArray]:
    """Return a function that averages values over groups of samples, and their sizes.

    A long hold whose samples differ in weight is averaged to :data:`MAX_HOLD_ROWS` rows.
    """
    corner = int(np.searchsorted(time, test.ramp_end + test.ramp_time - test.time[0]))
    is_weighted = bool((variance[corner:] > 1).any())
    stride = max(is_weighted * (len(time) - corner) // MAX_HOLD_ROWS, 1)
    starts = np.append(np.arange(corner), np.arange(corner, len(time), stride))
    size = np.diff(np.append(starts, len(time))).astype(float)
    return lambda values: np.add.reduceat(values, starts) / size, size


def _build_delay_columns(
    test: RampHold, model: GeneralizedMaxwell, time: FloatArray, x: FloatArray, *, delay: float
) -> dict[str, tuple[FloatArray, float]]:
    """Return the columns of a force that is so late, s, with their standard deviations.

    They have the size of the fitted delay: there the chord is exact, unlike the tangent.
    """
    slow_model = _keep_slow_arms(model, SLOW_ARM * test.step)
    displacement = slow_model.force(time, np.interp(time - delay, time, x, left=0.0))
    # what has lagged once may lag by that, whatever was thought possible
    sd = max(build_delay_prior(test).sd, delay)
    entries = {"delay": ((displacement - slow_model.force(time, x)) / delay, sd)}
    if delay > 0:
        # all are as late, in the mean: one low-pass, two alike, and one behind a delay
        half_passed = x - arm_response(time, x, delay / 2)
        motions = (
            x - arm_response(time, x, delay),
            half_passed - arm_response(time, half_passed, delay / 2),
            np.interp(time - delay / 2, time, half_passed, left=0.0),
        )
        for i, low_passed in enumerate(motions):
            entries[f"filter@{i}"] = slow_model.force(time, low_passed) - displacement, FILTER_SD
    return entries


def _find_fitted_delay(fit: Fit) -> float:
    """The delay of the force of one test, s, where it is too large for a linearisation; else 0."""
    nuisances = fit.estimate.nuisance if fit.method == "full" else ()
    delay = next((nuisance.value for nuisance in nuisances if nuisance.name == "delay"), 0.0)
    return delay if abs(delay) > LINEAR_DELAY else 0.0


def _keep_slow_arms(solid: GeneralizedMaxwell, tau: float) -> GeneralizedMaxwell:
    """Return the arms of a solid that are no faster than this, s."""
    slow_arms = [j for j, value in enumerate(solid.tau) if value >= tau]
    return GeneralizedMaxwell(
        solid.k_inf, tuple(solid.k[j] for j in slow_arms), tuple(solid.tau[j] for j in slow_arms)
    )


def _compute_law_deviation(law: ElasticLaw | None) -> float:
    """Return the relative error of the vibration stiffness by a slightly nonlinear law.

    About the depth it is the tangent's, about the middle of the way the secant's.
    """
    return abs(float(law.factor(law.depth)) - 1) if law is not None and law.is_gentle else 0.0


def _shift_to_reference(
    test: RampHold, fit: Fit, single_fit: Fit | None, *, for_limits: bool
) -> RelaxationData:
    """Return a test at another temperature as data of the reference temperature.

    Its shifts are as free as other spectra may want them, within what the line through the fit
    bears; its stiffnesses may differ by a gain.
    """
    shifts, kelvin = fit.temperatures, test.specimen.temperature
    if shifts is None or kelvin is None:
        raise DataError(
            "the fit is of tests at several temperatures, and a record has none: give the records "
            "that were fitted, each with its temperature"
        )
    shift = shifts.find_nearest(kelvin)
    if abs(shift.temperature - kelvin) > SAME_TEMPERATURE:
        raise DataError(
            f"a record is of {celsius(kelvin)}, and no test of the fit is: give those that were "
            "fitted"
        )
    shifted_fit = replace(fit.at_temperature(shift.temperature), temperatures=None)
    rates, at_reference = shifts.rates(shift.temperature), shift.temperature == shifts.reference
    slope_sd = float(np.sqrt(shifts.cross[-1, -1])) if len(shifts.cross) else 0.0
    thermal_shift = ThermalShift(
        shift.log10_a_t * LN_10,
        float(np.log(shift.b_t)),
        # arms that shift apart by no more than chance are laid out together, and doubted
        shifts.slope if abs(shifts.slope) > _SIGNIFICANT_SE * slope_sd else 0.0,
        0.0 if at_reference else max(_FREE_SE * shift.se * LN_10, _MIN_SHIFT),
        0.0 if at_reference else _FREE_SE * slope_sd,
    )
    return build_relaxation_data(
        test,
        shifted_fit,
        single_fit=single_fit,
        for_limits=for_limits,
        shift=thermal_shift,
        shift_slopes=rates,
    )


def build_hold_data(
    test: RampHold,
    model: GeneralizedMaxwell,
    residual: FloatArray,
    *,
    law: ElasticLaw | None = None,
    for_limits: bool = True,
) -> RelaxationData:
    """The hold after an ideal ramp, whose depth scales the force, by way of its elastic law."""
    reference_time = float(test.ramp_end - test.time[0])
    depth = test.depth if law is None else float(law.path(test.depth))
    time, x, force = motion(test)
    # eq. 5 has no motion of the plate in the hold: its force is taken off
    moved = np.where(time < reference_time, 0.0, (x if law is None else law.path(x)) - depth)
    force = np.append(force - model.force(time, moved), test.force[len(force) :])
    block = build_record_block(
        replace(test, force=force), method="hold", terms=_LOAD_CELL_TERMS, law=law
    )
    ramp = depth * np.clip((time - (test.onset - test.time[0])) / test.ramp_time, 0.0, 1.0)
    relaxation_data = _weight_block(
        test,
        block,
        block,
        model,
        residual,
        reference_time=reference_time,
        for_limits=for_limits,
        size=float(np.hypot(test.depth_error, estimate_set_sd(test, model))),
    )
    if law is None:
        # eq. 5 is fitted with a drift as free as it may be
        relaxation_data = replace(relaxation_data, drift=relaxation_data.terms.priors["drift"])
    start = float(test.time[test.settled_samples.start] - test.time[0])
    return (
        relaxation_data
        if not for_limits
        else _add_rig_columns(
            relaxation_data, test, (time, ramp), reference_time=reference_time, start=start
        )
    )


def build_fitted_data(
    test: RampHold, block: DataBlock, model: GeneralizedMaxwell, residual: FloatArray
) -> RelaxationData:
    """Return the data of :func:`build_relaxation_data` from a block of recorded motion.

    What the encoder leaves unknown of the depth scales the force; what it leaves unknown of the
    ramp's corners is not in it, so it serves no question about fast arms.
    """
    depth_sd = float(np.hypot(test.depth_error, test.contact_error / test.depth))
    depth_sd = float(np.hypot(depth_sd, estimate_set_sd(test, model)))
    time, x, _ = motion(test)
    relaxation_data = _weight_block(test, block, block, model, residual, size=depth_sd)
    relaxation_data = _add_rig_columns(
        relaxation_data, test, (time, x), start=float(time[first_sample(test)])
    )
    has_delay = any(get_column_kind(name) == "delay" for name in block.fixed_names)
    return replace(relaxation_data, delay=0.0) if has_delay else relaxation_data


def _add_rig_columns(
    data: RelaxationData,
    test: RampHold,
    time_and_motion: tuple[FloatArray, FloatArray],
    *,
    start: float,
    reference_time: float = 0.0,
) -> RelaxationData:
    """The data with rig effects as sums of its own columns, accurate to some per cent.

    The motion that is answered is `time_and_motion`, s and m; the rows begin at `start`, s, and
    their drift counts from `reference_time`, s, all from the first sample on.
    """
    time, x = (
        values[select_motion_samples(test, time_and_motion[0])] for values in time_and_motion
    )
    rig_effects = compute_unmeasured_effects(test, time, x, data.model)
    tau = np.geomspace(max(test.ramp_time / 100, test.step), 10 * test.hold_time, DOUBT_TIMES)
    shapes = {"k_inf": x, "offset": np.ones(len(time)), "drift": time - reference_time}
    kinds = [get_column_kind(name) for name in data.block.fixed_names]
    has_column = [kind in shapes for kind in kinds]
    columns = [shapes[kind] for kind in kinds if kind in shapes]
    basis = np.column_stack((*columns, arm_response(time, x, tau)))[time >= start]
    scale = np.linalg.norm(basis, axis=0)
    rig_columns = np.column_stack(
        [sd * column[time >= start] for column, sd in rig_effects.values()]
    )
    weights = np.linalg.lstsq(basis / scale, rig_columns, rcond=1e-9)[0] / scale[:, None]
    fixed = np.zeros((len(kinds), rig_columns.shape[1]))
    fixed[has_column] = weights[: len(columns)]
    return replace(
        data,
        unmeasured_effects=UnmeasuredEffects(
            tuple(rig_effects), np.log(tau), fixed, weights[len(columns) :]
        ),
    )


def estimate_noise_power(residual: FloatArray) -> float:
    r"""Return the power S of noise in the band of the arms: its variance, if it is white.

    The mean periodogram between 8 and 160 cycles per record, lines of hum omitted; below, where
    the noise wanders. A standard deviation counts a hum as noise, and so does a sum of
    autocovariances; an arm does not see it.
    """
    cycles, power = slow_periodogram(residual, FASTEST_NOISE)
    medium = power[(cycles >= SLOWEST_NOISE) & (cycles <= FASTEST_NOISE)]
    if not len(medium):
        return float(np.mean(residual**2))
    powers = power[(cycles >= SLOWEST_NOISE / 3) & (cycles <= 2 * SLOWEST_NOISE)]
    level = float(medium[medium <= HUM_RATIO * median(medium)].mean())
    return max(level, float(powers.mean())) if powers.mean() > SLOW_NOISE_RATIO * level else level


def _weight_block(
    test: RampHold,
    block: DataBlock,
    data_block: DataBlock,
    model: GeneralizedMaxwell,
    residual: FloatArray,
    *,
    effect_sds: Mapping[str, float] = MappingProxyType({}),
    size: float = 0.0,
    reference_time: float = 0.0,
    rms: float = 0.0,
    for_limits: bool = True,
) -> RelaxationData:
    terms = build_nuisance_terms(test, for_limits=for_limits)
    power = max(estimate_noise_power(residual), data_block.rounding_floor)
    remainder = max(float(np.mean(residual**2)), rms**2, power)
    return RelaxationData(
        block=block,
        weight=1 / float(np.sqrt(power)),
        kappa=power / max(float(np.mean(residual**2)), data_block.rounding_floor / len(residual)),
        terms=replace(terms, drift_start=reference_time + terms.drift_start).add_terms(
            **{name: Prior(0.0, sd) for name, sd in effect_sds.items()}
        ),
        model=_keep_slow_arms(model, SLOW_ARM * test.step),
        delay=terms.priors["delay"].sd,
        size=size,
        certain=data_block,
        misfit=len(residual) * remainder / power,
        drift=build_load_cell_priors(test).drift,
    )


def _compute_arm_residual(model: GeneralizedMaxwell, block: DataBlock) -> FloatArray:
    """Return the residual of a record for these relaxation times, stiffnesses free."""
    rows = block.exact.evaluate(np.log(model.tau), derivative=False)
    columns = np.concatenate((rows.fixed, rows.arms), axis=1)
    return np.asarray(rows.target - columns @ np.linalg.lstsq(columns, rows.target, rcond=None)[0])


def _get_tau_range(test: RampHold, a_t: float) -> tuple[float, float]:
    """Relaxation times that are asked about where the solid is `a_t` times slower, s."""
    time = motion(test)[0]
    low, high = window_of(time, uniform_step(time))
    return min(DASHPOT_TAU_RATIO * low, MIN_TAU) * min(a_t, 1.0), MAX_SLOWNESS * high * max(
        a_t, 1.0
    )


def _list_motion_errors(test: RampHold, time: FloatArray) -> dict[str, tuple[BoolArray, float]]:
    """Motions that may have been, and the standard deviation of their size, m."""
    entries: dict[str, tuple[BoolArray, float]] = {}
    clock, count = time + test.time[0], test.encoder_step / np.sqrt(12)
    if test.contact_error > 0:
        entries["contact"] = clock >= test.onset, test.contact_error
    if count > 0:
        (_, leaves), *middle_rests, (return_time, _) = _select_rests(test, clock)
        # motion counts from the first reading: an error of it begins where it is left
        entries["rest@first"] = clock >= leaves, float(count)
        entries["rest@last"] = clock >= return_time, float(count)
        for i, (start, stop) in enumerate(middle_rests):
            entries[f"rest@{i}"] = (clock >= start) & (clock < stop), float(count)
    return entries


def compute_unmeasured_effects(
    test: RampHold, time: FloatArray, x: FloatArray, model: GeneralizedMaxwell
) -> dict[str, tuple[FloatArray, float]]:
    """Return forces that the rig may add without a trace, N per unit, and their SD in units.

    The machine gives under the force; its crosshead settles after its stop, where no reading moves;
    what the cell carries before the ramp may be a seal that was pressed already; the seal warms;
    the mains are folded to rest by a converter of which no filter is stated.

    Parameters
    ----------
    test : RampHold
    time, x : array, shape (n,)
        Since the first sample, s, and the motion that the solid `model` is thought to feel, m.
    """
    terms = build_machine_terms(
        test.machine,
        model,
        time,
        x,
        time_since_stop=time + test.time[0] - test.ramp_end,
        ramp_time=test.ramp_time,
        depth=test.depth,
        has_settling=not test.changed_readings,
    )
    peak = float(np.abs(model.force(time, x)).max())
    if test.preload and peak > 0:
        # pressed when the record begins; what it carries in the middle of the rest is offset
        relaxing = model.force(time, np.ones(len(time)))
        tared = float(np.interp(build_load_cell_priors(test).offset_time, time, relaxing))
        terms["preload"] = relaxing - tared, test.preload * test.depth / peak
    if test.loading_start is None and not test.gap > 0 and model.arms:
        remembered_force, sd = build_earlier_press(test.machine, model, time, depth=test.depth)
        # what it carries in the middle of the rest is offset
        terms["memory"] = (
            remembered_force
            - float(np.interp(build_load_cell_priors(test).offset_time, time, remembered_force)),
            sd,
        )
    # its temperature is that of its contact, however long the machine stood before
    rest_time = max(test.onset - test.ramp_time - test.time[0], 0.0)
    warming_force = compute_warming(time, x, model, start_time=rest_time)
    terms["warming"] = warming_force, build_warming_prior(test.specimen).sd
    if test.machine.force_filter is None:
        lines = build_folded_mains(time, step=test.step)
        # four parts of one line of that size
        sd = DEFAULT_UNCERTAINTIES["folded mains"].size * peak / 2
        terms |= {f"mains@{i}": (line, sd) for i, line in enumerate(lines)}
    return terms


def estimate_set_sd(test: RampHold, model: GeneralizedMaxwell) -> float:
    """Return the standard deviation of the depth that a set of earlier presses leaves, relative.

    A gap that was found may be the set of a seal that was pressed before its record began.
    """
    if not test.gap > 0 or test.loading_start is not None:
        return 0.0
    return compute_set_sd(test.machine, model, depth=test.depth, gap=test.gap) / test.depth


def select_motion_samples(test: RampHold, time: FloatArray) -> IndexArray:
    """Return some hundred samples of a motion, and some of what relaxes after it."""
    corner = test.ramp_end - test.time[0]
    ramp_stop = int(np.searchsorted(time, corner + test.ramp_time))
    late_samples = np.searchsorted(
        time, corner + np.geomspace(test.ramp_time, time[-1], DOUBT_SAMPLES)
    )
    early_samples = np.arange(
        test.start, ramp_stop, max((ramp_stop - test.start) // (3 * DOUBT_SAMPLES), 1)
    )
    # of earlier loadings the solid remembers the way, whose corners count
    history_samples = np.arange(0, test.start, max(test.start // MAX_HISTORY_SAMPLES, 1))
    indices = np.concatenate(
        (history_samples, early_samples, np.minimum(late_samples, len(time) - 1), [len(time) - 1])
    )
    indices.sort()
    return np.asarray(indices[np.append(True, np.diff(indices) > 0)])


def _select_rests(test: RampHold, clock: FloatArray) -> list[tuple[float, float]]:
    """Return the first and the last constant reading, and the longest between them."""
    all_rests = find_rests(clock, test.displacement[: len(clock)], test.encoder_step)
    first_rest, last_rest = (-np.inf, test.onset), (test.ramp_end, np.inf)
    if len(all_rests) > 1:
        first_rest, last_rest = all_rests[0], all_rests[-1]
    longest_rests = sorted(all_rests[1:-1], key=lambda rest: rest[0] - rest[1])[:MAX_PAUSES]
    return [first_rest, *longest_rests, last_rest]
