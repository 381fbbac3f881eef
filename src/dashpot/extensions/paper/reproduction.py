"""Reproduction of the paper: each computed or printed statement beside dashpot's result.

Two solvers are compared: the paper's equations as printed (:mod:`.equations`), and dashpot's own
solids, fits and predictions. The paper has no data; the seal is that of its Table 1, on the ideal
ramp of eq. (1), on that with the steps of its load cell, and on the virtual rig.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.number_format import round_to_error
from dashpot.base.progress import send_progress
from dashpot.base.reported_values import ReportedValue
from dashpot.base.serialisation import EVERY_FIELD, Key, Serialisable
from dashpot.base.units import convert_to_unit
from dashpot.base.version import byline
from dashpot.datamodel.fit import Fit, list_model_values
from dashpot.datamodel.frf import Kind
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.extensions.paper.equations import Coefficients
from dashpot.extensions.paper.exponential_sum import exponential_sum
from dashpot.fitting.fit_options import FitOptions
from dashpot.reading.write import write_impact, write_relaxation
from dashpot.simulation.ground_truth import stamp, truth_json
from dashpot.simulation.impact import SimulatedImpact, simulate_impact
from dashpot.simulation.relaxation import SimulatedRelaxation, simulate_relaxation
from dashpot.solids.demo_seals import PAPER, PAPER_MASS
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.vibration.mass_on_seals import model_modes, predict_frf
from dashpot.vibration.modal.peaks import find_peak
from dashpot.workflow.job import BlockOnSeals
from dashpot.workflow.study import Study, characterise

DEPTH, RAMP, HOLD = 8e-3, 1.0, 40.0
"""The paper's test: m, s, s."""
SPEED = DEPTH / RAMP
SEALS = 2
BASELINE, RATE = 3.0, 1000.0
"""Assumed record before contact, s, and rate, Hz; the paper does not give them."""
QUANTUM = 1 / 1280
"""Resolution of the paper's load cell, N."""
PRINTED_HZ = 12.71
"""Natural frequency that the paper reads off its Fig. 6."""

TIMES = (0.25, 0.5, 1.0, 1.5, 2.0, 5.0, 10.0, 20.0, 41.0)
LINES = (1.0, 5.0, 10.0, 12.0, 12.71, 13.0, 15.0, 20.0, 30.0, 50.0)
SHIFTS = (0.0, 0.5, 5.0)
"""Real parts of s at which eq. (6) is compared, 1/s."""
FACTORS = (0.5, 1.0, 2.0, 5.0)
"""On every b_j: 'slightly change the damping values'."""
GRIDS = (0.1, 0.25, 0.5, 1.0)
"""Distances of the lines of an FRF, Hz."""

PRINTED = Coefficients(PAPER.k_inf, (PAPER.k[0], PAPER.k[1]), (PAPER.arm_b[0], PAPER.arm_b[1]))
"""Table 1 in SI."""


@dataclass(frozen=True)
class Statement(Serialisable):
    """Statement of the paper beside dashpot's result.

    Attributes
    ----------
    part : str
        ``"equation"``, ``"figure"``, ``"misprint"`` or ``"unsaid"``.
    name, paper, reproduced : str
        Place in the paper, value in the paper, reproduced value.
    difference, tolerance : float or None
        Difference and its tolerance; None if nothing is compared.
    """

    part: str
    name: str
    paper: str
    reproduced: str
    difference: float | None = None
    tolerance: float | None = None

    @property
    def within_interval(self) -> bool | None:
        """Whether it is within its tolerance; None if it is not compared."""
        if self.difference is None or self.tolerance is None:
            return None
        return bool(self.difference <= self.tolerance)

    _keys = (
        "part",
        "name",
        "paper",
        "reproduced",
        "difference",
        "tolerance",
        "within_interval",
    )


@dataclass(frozen=True)
class Coefficient(Serialisable):
    """Number of Table 1, in SI, as printed and as determined from each record.

    Attributes
    ----------
    name, unit : str
    printed, noise_free, quantised : float
        Values: of the paper; by eq. (5) from the ideal record; from that in steps of 1/1280 N.
    full, hold : ReportedValue
        From the virtual rig, with the interval: by the whole history, and by the hold alone as
        the paper does it.
    """

    _keys = (EVERY_FIELD,)

    name: str
    unit: str
    printed: float
    noise_free: float
    quantised: float
    full: ReportedValue
    hold: ReportedValue

    @property
    def is_covered(self) -> tuple[bool, bool]:
        """Whether each of the two intervals contains the printed value."""
        return is_within_interval(self.full, self.printed), is_within_interval(
            self.hold, self.printed
        )


@dataclass(frozen=True, eq=False)
class HoldFit(Serialisable):
    """Least-squares fit of eq. (5) to the hold, as in the paper.

    Attributes
    ----------
    solid : GeneralizedMaxwell
    time, force : array
        Time of the fitted samples, s after contact, and force of the fit, N.
    rms, worst : float
        Residual, rms and largest, N.
    """

    _keys = ("solid", "rms", "worst")

    solid: GeneralizedMaxwell
    time: FloatArray
    force: FloatArray
    rms: float
    worst: float


@dataclass(frozen=True, eq=False)
class Reproduction(Serialisable):
    """Reproduction of the paper.

    Attributes
    ----------
    seed : int
        Seed of simulated test and hammer.
    rows : tuple of Statement
    table : tuple of Coefficient
    force : tuple of (float, float)
        Eq. (1) at some times after contact, s and N.
    accelerance : tuple of (float, float, float)
        Eq. (7) at some lines: Hz, 1/kg, and the phase, degrees.
    peak, receptance_peak : (float, float)
        Where accelerance and receptance are highest: Hz, and 1/kg or m/N.
    mode : (float, float)
        Natural frequency, Hz, and damping ratio of the oscillating pole.
    single_arm, two_arms, quantised : HoldFit
    ideal : RelaxationTest
    rig, hammer : SimulatedRelaxation, SimulatedImpact
    study : Study
        The main job on simulated test and hammer.
    """

    schema = "dashpot/paper@2"
    _keys = (
        "seed",
        Key("reproduced", "is_reproduced"),
        "rows",
        "table",
        "force",
        "accelerance",
        "peak",
        "receptance_peak",
        "mode",
        "single_arm",
        "two_arms",
        "quantised",
    )

    seed: int
    rows: tuple[Statement, ...]
    table: tuple[Coefficient, ...]
    force: tuple[tuple[float, float], ...]
    accelerance: tuple[tuple[float, float, float], ...]
    peak: tuple[float, float]
    receptance_peak: tuple[float, float]
    mode: tuple[float, float]
    single_arm: HoldFit
    two_arms: HoldFit
    quantised: HoldFit
    ideal: RelaxationTest
    rig: SimulatedRelaxation
    hammer: SimulatedImpact
    study: Study

    @property
    def is_reproduced(self) -> bool:
        """Whether every comparable statement agrees within its tolerance."""
        return all(row.within_interval is not False for row in self.rows)

    @property
    def summary(self) -> str:
        """Summary of the result, in a sentence or two."""
        rows_with_interval = [row for row in self.rows if row.within_interval is not None]
        total = sum(bool(row.within_interval) for row in rows_with_interval)
        covered_counts = [
            sum(coefficient.is_covered[i] for coefficient in self.table) for i in (0, 1)
        ]
        return (
            f"{total} of {len(rows_with_interval)} statements of the paper come out to their "
            f"tolerance. In simulation {covered_counts[0]} of {len(self.table)} numbers of Table 1 "
            f"lie in their 95 % interval by the whole history, {covered_counts[1]} by the hold "
            "alone."
        )


def reproduce(seed: int = 0) -> Reproduction:
    """Make the paper's equations, figures and table again.

    Parameters
    ----------
    seed : int
        Seed of the noise of simulated test and hammer.
    """
    send_progress("eqs. (1) to (7)")
    noise_free_test = make_ideal_test()
    hold_fit, two = (fit_hold_phase(noise_free_test, arms) for arms in (1, 2))
    quantised_fit = fit_hold_phase(quantise_force(noise_free_test), 2)
    send_progress("simulated test and hammer")
    rig = simulate_relaxation(PAPER, depth=DEPTH, ramp_time=RAMP, hold_time=HOLD, seed=seed)
    hammer = simulate_impact(PAPER, mass=PAPER_MASS, seals=SEALS, seed=seed)
    study = characterise(
        rig.test, estimate_frf(hammer.test), impact=hammer.test,
        block=BlockOnSeals(PAPER_MASS, SEALS), options=FitOptions(2),
    )  # fmt: skip
    send_progress("the resonance")
    top, lower = find_paper_peak(Kind.ACCELERANCE), find_paper_peak(Kind.RECEPTANCE)
    (mode,) = model_modes(SEALS * PAPER, mass=PAPER_MASS)
    frf = predict_frf(SEALS * PAPER, mass=PAPER_MASS, frequency=LINES)
    phases = np.degrees(np.angle(frf.value))
    return Reproduction(
        seed=seed,
        rows=(
            *_check_equations(),
            *_compare_test_figures(noise_free_test, hold_fit, two, quantised_fit),
            *_compare_mass_figures(top, study),
            *_check_misprints(top[1]),
            *UNSTATED_VALUES,
        ),
        table=tuple(_compare_table(two.solid, quantised_fit.solid, study)),
        force=tuple(zip(TIMES, _compute_ramp(np.array(TIMES)).tolist(), strict=True)),
        accelerance=tuple(zip(LINES, np.abs(frf.value).tolist(), phases.tolist(), strict=True)),
        peak=top,
        receptance_peak=lower,
        mode=(mode.frequency, mode.damping_ratio),
        single_arm=hold_fit,
        two_arms=two,
        quantised=quantised_fit,
        ideal=noise_free_test,
        rig=rig,
        hammer=hammer,
        study=study,
    )


# -- records and fits -----------------------------------------------------------------------------


def make_ideal_test() -> RelaxationTest:
    """Return the paper's test without a rig: eq. (1) on Table 1, free of noise."""
    steps = int(BASELINE * RATE), int((RAMP + HOLD) * RATE)
    t = np.arange(-steps[0], steps[1] + 1) / RATE
    force = np.where(t >= 0, _compute_ramp(np.maximum(t, 0.0)), 0.0)
    return RelaxationTest(
        time=t + BASELINE, displacement=SPEED * np.clip(t, 0.0, RAMP), force=force, units="SI"
    )


def quantise_force(test: RelaxationTest) -> RelaxationTest:
    """Return the same as the paper's load cell resolves it."""
    return replace(test, force=QUANTUM * np.round(test.force / QUANTUM))


def make_paper_records(reproduction: Reproduction) -> dict[str, str]:
    """Return the records by file name, each with its origin, and the ground truth of the rigs."""
    comments = (byline("simulated by eq. (1) of the paper, not a measurement"),)
    bench, hammer = reproduction.rig, reproduction.hammer
    return {
        "paper.csv": write_relaxation(reproduction.ideal, comments=comments),
        "paper_steps.csv": write_relaxation(quantise_force(reproduction.ideal), comments=comments),
        "paper_rig.csv": write_relaxation(bench.test, comments=stamp(bench.truth)),
        "paper_rig.truth.json": truth_json(bench.truth),
        "paper_hammer.csv": write_impact(hammer.test, comments=stamp(hammer.truth)),
        "paper_hammer.truth.json": truth_json(hammer.truth),
    }


def fit_hold_phase(test: RelaxationTest, arms: int) -> HoldFit:
    r"""Eq. (5) by least squares on every sample after the ramp, as the paper fits it.

    .. math:: F = A k_\infty c + \sum_j A b_j (e^{c/\tau_j} - 1) e^{-t/\tau_j}
    """
    t = test.time - BASELINE
    in_hold = t > RAMP
    new_exponential_sum = exponential_sum(
        t[in_hold], test.force[in_hold], terms=arms, constant=True
    )
    rates, sizes = np.array(new_exponential_sum.rates), np.array(new_exponential_sum.amplitudes)
    b = sizes / (SPEED * np.expm1(RAMP * rates))
    fast_first = np.argsort(-rates)
    solid = GeneralizedMaxwell(
        new_exponential_sum.constant / DEPTH,
        tuple((b * rates)[fast_first]),
        tuple((1 / rates)[fast_first]),
    )
    fitted_force = new_exponential_sum.constant + np.exp(-np.outer(t[in_hold], rates)) @ sizes
    residual = fitted_force - test.force[in_hold]
    rms = float(np.sqrt(np.mean(residual**2)))
    return HoldFit(solid, t[in_hold], fitted_force, rms, float(np.max(np.abs(residual))))


def find_paper_peak(kind: Kind) -> tuple[float, float]:
    """Return frequency, Hz, and height of the peak of the FRF of the mass on two seals."""
    from scipy.optimize import minimize_scalar

    def height(hz: float) -> float:
        frf = predict_frf(SEALS * PAPER, mass=PAPER_MASS, frequency=[hz], kind=kind)
        return float(np.abs(frf.value[0]))

    frequency_range = (0.99 * PRINTED_HZ, 1.01 * PRINTED_HZ)
    solution = minimize_scalar(
        lambda hz: -height(hz), bounds=frequency_range, method="bounded", options={"xatol": 1e-12}
    )
    return float(solution.x), height(solution.x)


def _compute_ramp(t: FloatArray) -> FloatArray:
    return PAPER.ramp_hold_force(t, depth=DEPTH, ramp_time=RAMP)


def _compute_largest_deviation(first: FloatArray, second: FloatArray) -> float:
    """Return the largest difference, as a part of the value."""
    return float(np.max(np.abs(first - second) / np.abs(second)))


# -- statements -----------------------------------------------------------------------------------


def _check_equations() -> Iterator[Statement]:
    t = np.array(TIMES)
    computed, hold_time = _compute_ramp(t), t[t > RAMP]
    ramp_parameters = {"speed": SPEED, "c": RAMP}

    def row(name: str, paper: str, text: str, difference: float, tolerance: float) -> Statement:
        return Statement("equation", name, paper, text, difference, tolerance)

    yield row(
        "eq. (1)", "force of ramp and hold: A [z(t) - z(t - c) u(t - c)]",
        f"{round_to_error(float(computed.max()), digits=8)} N at 1 s, where it is highest",
        _compute_largest_deviation(computed, PRINTED.eq_1(t, **ramp_parameters)), 1e-12,
    )  # fmt: skip
    # a ramp that never ends, of 1 m/s
    ramp = PAPER.ramp_hold_force(t, depth=2 * t[-1], ramp_time=2 * t[-1])
    yield row(
        "eq. (2)", "z(t), the answer to a ramp of unit speed",
        f"{round_to_error(convert_to_unit(float(ramp[-1]), 'N*s/mm'), digits=8)} N s/mm at 41 s",
        _compute_largest_deviation(ramp, PRINTED.z(t)), 1e-12,
    )  # fmt: skip
    history = np.array([PRINTED.hereditary(float(time), **ramp_parameters) for time in hold_time])
    yield row(
        "eq. (3)", "the hold: A [z(t) - z(t - c)]", "the hereditary integral",
        _compute_largest_deviation(PRINTED.eq_3(hold_time, **ramp_parameters), history), 1e-13,
    )  # fmt: skip
    yield row(
        "eqs. (4), (5)",
        "the hold, written out in stress and in force",
        "the hereditary integral",
        _compute_largest_deviation(PRINTED.eq_5(hold_time, **ramp_parameters), history),
        1e-13,
    )
    two, s = PRINTED.times(SEALS), 2j * np.pi * np.array(LINES)
    differences = [_check_transfer_function(two, s + sigma) for sigma in SHIFTS]
    pole = max(two.poles(mass=PAPER_MASS), key=lambda item: item.imag)
    yield row(
        "eq. (6)", "displacement over force of a mass on the seal",
        f"{round_to_error(abs(pole) / (2 * math.pi), digits=8)} Hz and a damping ratio of "
        f"{round_to_error(-pole.real / abs(pole), digits=6)}, for two seals",
        max(differences), 1e-9,
    )  # fmt: skip
    accelerance = predict_frf(SEALS * PAPER, mass=PAPER_MASS, frequency=LINES)
    yield row(
        "eq. (7)",
        "magnitude of acceleration over force",
        f"{round_to_error(float(np.abs(accelerance.value).max()), digits=9)} 1/kg at 12.71 Hz",
        _compute_largest_deviation(
            np.abs(accelerance.value), two.eq_7(2 * np.pi * np.array(LINES), mass=PAPER_MASS)
        ),
        1e-8,
    )


def _check_transfer_function(coefficients: Coefficients, s: np.ndarray) -> float:
    """Return how far eq. (6) is from 1 / (m s^2 + K(s)) at complex frequencies, as a part of it."""
    shift, lines = float(s.real[0]), s.imag / (2 * np.pi)
    computed = predict_frf(
        SEALS * PAPER, mass=PAPER_MASS, frequency=lines, kind=Kind.RECEPTANCE, shift=shift
    )
    return float(np.max(np.abs(coefficients.eq_6(s, mass=PAPER_MASS) / computed.value - 1)))


def _build_figure_statement(
    name: str, paper: str, text: str, difference: float, tolerance: float
) -> Statement:
    return Statement("figure", name, paper, text, difference, tolerance)


def _compare_test_figures(
    noise_free_test: RelaxationTest, fit: HoldFit, two_arm_fit: HoldFit, quantised_fit: HoldFit
) -> Iterator[Statement]:
    """Figs. 1 to 4."""
    yield Statement(
        "figure", "Fig. 1", "the robotic indenter", "dashpot simulate relaxation is one"
    )
    peak_time = float(noise_free_test.time[np.argmax(noise_free_test.force)]) - BASELINE
    yield _build_figure_statement(
        "Fig. 2", "8 mm in 1 s, then held for 40 s",
        f"the force is highest where the hold begins, at {peak_time:g} s", abs(peak_time - RAMP),
        0.5 / RATE,
    )  # fmt: skip
    yield Statement("figure", "Fig. 3", "the solid with N = 1 and N = 2", "dashpot.solids, any N")
    yield _build_figure_statement(
        "Fig. 4, N = 2", "fits much better than N = 1",
        f"leaves {round_to_error(convert_to_unit(two_arm_fit.rms, 'mN'), digits=2)} mN rms of an "
        f"exact record, {round_to_error(convert_to_unit(quantised_fit.rms, 'mN'), digits=4)} mN of "
        "one in steps of 1/1280 N",
        convert_to_unit(two_arm_fit.rms, "mN"), 1e-9,
    )  # fmt: skip
    yield _build_figure_statement(
        "Fig. 4, N = 1", "does not follow the hold",
        f"leaves {round_to_error(convert_to_unit(fit.rms, 'mN'), digits=8)} mN rms and "
        f"{round_to_error(convert_to_unit(fit.worst, 'mN'), digits=6)} mN where the hold begins; "
        f"k_inf {round_to_error(convert_to_unit(fit.solid.k_inf, 'N/mm'), digits=8)} N/mm. Off: N "
        "= 2 over it",
        quantised_fit.rms / fit.rms, 0.05,
    )  # fmt: skip


def _compare_mass_figures(peak: tuple[float, float], study: Study) -> Iterator[Statement]:
    """Figs. 5 and 6."""
    yield Statement("figure", "Fig. 5", "a mass on two seals", "dashpot simulate impact is one")
    yield _build_figure_statement(
        "Fig. 6, model", f"peaks at {PRINTED_HZ} Hz",
        f"peaks at {round_to_error(peak[0], digits=10)} Hz, {round_to_error(peak[1], digits=9)} "
        "1/kg",
        abs(peak[0] - PRINTED_HZ), 5e-3,
    )  # fmt: skip
    comparison = study.comparison
    if comparison is not None:
        yield _build_figure_statement(
            "Fig. 6, measured", f"natural frequency {PRINTED_HZ} Hz, good agreement",
            f"the virtual hammer finds {round_to_error(comparison.measured_hz, digits=5)} Hz, the "
            f"model of the relaxation test {round_to_error(comparison.predicted_hz, digits=5)} Hz",
            abs(comparison.measured_hz - PRINTED_HZ), 0.05,
        )  # fmt: skip


def _check_misprints(top: float) -> Iterator[Statement]:
    def row(name: str, paper: str, text: str) -> Statement:
        return Statement("misprint", name, paper, text)

    yield row(
        "eq. (7)", "a magnitude with the factor (-w^2)",
        "a magnitude is not negative: the sign belongs to the complex accelerance",
    )  # fmt: skip
    # the largest x with a finite e^x
    shortest_tau = RAMP / math.log(np.finfo(float).max)
    yield row(
        "eq. (5)", "holds e^(c/tau)",
        f"overflows for tau below {round_to_error(convert_to_unit(shortest_tau, 'ms'), digits=3)} "
        "ms; b e^(-(t-c)/tau) (1 - e^(-c/tau)) does not",
    )  # fmt: skip
    yield row("eq. (5)", "K_inf", "the k_inf of the other equations")
    yield row(
        "Table 1", "N/mm and N s/mm",
        "masses in tonnes: with kilograms the peak comes a factor sqrt(1000) too low",
    )  # fmt: skip
    single = predict_frf(PAPER, mass=PAPER_MASS, frequency=np.linspace(8.5, 9.5, 1001))
    yield row(
        "eq. (6)", "one seal under the mass",
        f"two carry it: one peaks at {round_to_error(find_peak(single).frequency, digits=6)} Hz",
    )  # fmt: skip
    heights = [_compute_peak_with_damping(factor) for factor in FACTORS]
    sentence = ", ".join(
        f"x {factor:g} {round_to_error(height, digits=5)}"
        for factor, height in zip(FACTORS, heights, strict=True)
    )
    yield row(
        "Fig. 6", "more damping by slightly changed damping values",
        f"the wrong way: at 12.71 Hz both arms are glassy, so a larger b damps less. Peak, 1/kg, "
        f"with every b_j {sentence}. No factor keeps the relaxation curve",
    )  # fmt: skip
    sentence = ", ".join(
        f"{step:g} Hz {round_to_error(amplitude, digits=4)} "
        f"({round_to_error(100 * amplitude / top, digits=2)} %)"
        for step, amplitude in ((step, find_peak_on_grid(step)) for step in GRIDS)
    )
    yield row(
        "Fig. 6", "the peak may be cut by the sampling rate",
        f"by the length of the record: read at lines apart by {sentence}. A mismatch of this size "
        "proves no damping where the lines are 0.25 Hz apart or more",
    )  # fmt: skip


def _compute_peak_with_damping(factor: float) -> float:
    """Return the accelerance's peak, 1/kg, with every b_j, and so every tau_j, that many times."""
    solid = SEALS * replace(PAPER, tau=tuple(factor * tau for tau in PAPER.tau))
    lines = np.linspace(PRINTED_HZ - 0.2, PRINTED_HZ + 0.2, 4001)
    return find_peak(predict_frf(solid, mass=PAPER_MASS, frequency=lines)).height


def find_peak_on_grid(step: float) -> float:
    """Return the highest accelerance on lines of this spacing, Hz: as read off, 1/kg."""
    lines = step * np.arange(1, int(50 / step) + 1)
    return float(np.abs(predict_frf(SEALS * PAPER, mass=PAPER_MASS, frequency=lines).value).max())


UNSTATED_VALUES = tuple(
    Statement("unsaid", name, "not given", text)
    for name, text in (
        (
            "the block's mass",
            f"12.71 Hz takes {convert_to_unit(PAPER_MASS, 'g'):.4f} g on two seals",
        ),
        ("the length of seal under plate and block", "taken as equal"),
        ("the rate, the filter, the window of the fit", "1 kHz, none, the whole hold"),
        ("the length of the hammer's record", "the virtual hammer's"),
        ("how the fit was started, and its uncertainty", "no start is needed; 95 % intervals"),
    )
)  # fmt: skip
"""Quantities that the paper does not give, and their assumed values."""


def _compare_table(
    exact: GeneralizedMaxwell, coarse: GeneralizedMaxwell, study: Study
) -> Iterator[Coefficient]:
    printed_values = [("k_inf", "N/m", PRINTED.k_inf)]
    for unit, letter, values in (("N/m", "k", PRINTED.k), ("N s/m", "b", PRINTED.b)):
        printed_values += [(f"{letter}_{j}", unit, value) for j, value in enumerate(values, 1)]
    full_values, hold = (_get_facts_by_name(fit) for fit in (study.fit, study.hold_fit))
    for name, unit, value in printed_values:
        exact_value, coarse_value = (_get_coefficient(solid, name) for solid in (exact, coarse))
        yield Coefficient(
            name, unit, value, exact_value, coarse_value, full_values[name], hold[name]
        )


def _get_facts_by_name(fit: Fit | None) -> dict[str, ReportedValue]:
    return (
        {}
        if fit is None
        else {reported_value.name: reported_value for reported_value in list_model_values(fit)}
    )


def _get_coefficient(solid: GeneralizedMaxwell, name: str) -> float:
    letter, _, j = name.partition("_")
    if j == "inf":
        return solid.k_inf
    return float((solid.k if letter == "k" else solid.arm_b)[int(j) - 1])


def is_within_interval(reported_value: ReportedValue, value: float) -> bool:
    """Return whether the interval of a number holds a value."""
    low = -math.inf if math.isnan(reported_value.low) else reported_value.low
    return bool(low <= value <= reported_value.high)
