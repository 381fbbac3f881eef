"""Every registered check just passes and just fails at its limit; the limits are typed here."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest
from kit.fits import a_fit

import dashpot
from dashpot.base.checks import REGISTER, Check, Finding, criterion, select_fit_status
from dashpot.base.errors import Status
from dashpot.base.reported_values import ReportedValue
from dashpot.datamodel import checks as records
from dashpot.datamodel.bounds import BandError, EndOfHold
from dashpot.datamodel.fit_diagnostics import Alternative, Explanation
from dashpot.datamodel.frf import FRF, Hit, Mode
from dashpot.datamodel.parameter_estimate import Nuisance
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.shift_factors import Shift, TemperatureShifts
from dashpot.datamodel.specimen import Specimen
from dashpot.datamodel.structure import ModeShape
from dashpot.datamodel.vibration_tests import ShakenTest
from dashpot.export import checks as export
from dashpot.extensions.amplitude import checks as level
from dashpot.extensions.batch import checks as lots
from dashpot.extensions.batch.statistics.process_capability import capability
from dashpot.extensions.blank_tests import checks as blank
from dashpot.extensions.blank_tests.estimation import EmptyRun, RigEstimate
from dashpot.extensions.curves import checks as curves
from dashpot.extensions.curves.creep import checks as creep
from dashpot.extensions.curves.datamodel.creep import LoadHold
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.shift_law_fit import LawScore, ShiftOutlier
from dashpot.extensions.curves.superposition import checks
from dashpot.extensions.curves.temperatures import checks as several
from dashpot.extensions.dynamic_stiffness import checks as dynamic_stiffness
from dashpot.extensions.materials.cld import checks as cld
from dashpot.extensions.materials.csr import checks as csr
from dashpot.extensions.materials.drop import checks as drop
from dashpot.extensions.materials.hyperelastic import checks as hyper
from dashpot.extensions.materials.hyperelastic import size_checks as hyper_sizes
from dashpot.extensions.materials.indentation import checks as indentation
from dashpot.extensions.materials.indentation import size_checks
from dashpot.extensions.materials.indentation.contact_law import ViscousContact
from dashpot.extensions.materials.indentation.datamodel import IndentationFit
from dashpot.extensions.materials.indentation.indenter import Indenter
from dashpot.extensions.materials.rod import checks as rod
from dashpot.extensions.modes import checks as modal
from dashpot.extensions.modes.stabilisation import DAMPING, Stabilisation
from dashpot.extensions.preload_map import checks as maps
from dashpot.extensions.preload_map.separability import PairTest
from dashpot.extensions.projects import verification_checks
from dashpot.extensions.solver_inputs.cards import checks as cards
from dashpot.extensions.solver_inputs.draws import checks as draws
from dashpot.extensions.systems.door import checks as seals
from dashpot.extensions.transfer_stiffness import checks as mounts
from dashpot.fitting.checks import relaxation, solid
from dashpot.fitting.fractional_model import checks as fractional
from dashpot.fitting.identification import checks as identification
from dashpot.fitting.input_tests import EndStiffness
from dashpot.fitting.nonlinear_ramp import checks as ramp
from dashpot.fitting.nonlinear_ramp.linearity import assess_linear_fit
from dashpot.numerics.inference.correlated_noise import Noise, estimate_noise, nearly_white
from dashpot.numerics.inference.model_order import (
    DECISIVE_BIC,
    ArmShortage,
    OrderChoice,
    select_model_order,
)
from dashpot.planning import checks as planning
from dashpot.planning.expected_errors import Pulse, RecordNeed
from dashpot.preprocessing import checks as preparation
from dashpot.preprocessing.contact import Baseline, Touch
from dashpot.preprocessing.history import EarlierLoadings
from dashpot.preprocessing.signal_conditioning import parse_filter
from dashpot.reading.readers import size_checks as reading
from dashpot.signals.noise import estimate_robust_scatter
from dashpot.signals.segments import MotionSegment, RampHoldCycle
from dashpot.solids.demo_seals import PAPER
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.interconversion import CreepSpectrum
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.shift_laws import WLF, FreeShifts
from dashpot.vibration import checks as vibration
from dashpot.vibration.comparison import checks as comparison
from dashpot.vibration.comparison.compare import compare
from dashpot.vibration.comparison.comparison_result import Comparison
from dashpot.vibration.impact import checks as impact
from dashpot.vibration.impact.amplitude_trend import RegressionLine
from dashpot.vibration.impact.exponential_window import ExponentialWindow
from dashpot.vibration.impact.rocking import Combination
from dashpot.vibration.impact.spectral_estimators import Estimator, Spectra
from dashpot.vibration.mass_on_seals import OperatingPoint, moving_mass, predict_frf
from dashpot.vibration.modal.peaks import Peak
from dashpot.workflow import checks as workflow
from dashpot.workflow.json_archive import to_json

ROOT = Path(__file__).parents[1]
SOURCES = Path(dashpot.__file__).parent


# -- what is judged -------------------------------------------------------------------------------


def arm(k: float = 1.0, tau: float = 1.0) -> GeneralizedMaxwell:
    return GeneralizedMaxwell(1.0, (k,), (tau,))


#: errors of k_inf, k and ln tau that leave an arm unsupported
WEAK = np.array([0.0, 1.0, 0.0])
DEPTH = 8e-3
TIME = np.arange(-100, 4101) / 100
PLATE = DEPTH * np.clip(TIME, 0, 1)
RECORD = RampHold(TIME, PLATE, PAPER.force(TIME, PLATE), 0.0, 1.0, 41.0, DEPTH)


TESTED = TemperatureShifts(
    FreeShifts((270.0, 300.0), (2.0, 0.0), 300.0),
    (Shift(270.0, 2.0, 0.1), Shift(300.0, 0.0, 0.0)),
    np.zeros((4, 4)),
)


def simple(
    chance: float,
    excess: float,
    slope: tuple[float, float] | None = None,
    enough_arms: int | None = None,
) -> Check:
    return several.thermorheologically_simple(
        chance, excess, temperatures=3, slope=slope, enough_arms=enough_arms
    )


def test_misfit_of_too_few_arms_is_named_before_shifts_of_single_arms() -> None:
    """Ten arms of a wide spectrum for seven: a loss factor 1 % off, not 31 %."""
    few, separate = simple(1e-4, 8e-6, (0.13, 0.02), 8), simple(1e-4, 8e-6, None)
    assert "It has too few arms (8 do), they do not shift together" in few.message
    assert few.remedy is not None
    assert few.remedy.command_option == "--arms 8"
    # where no number of arms explains the tests, none is advised
    assert "too few arms" not in separate.message
    assert separate.remedy is not None
    assert not separate.remedy.option
    # nor where one model explains them and its arms shift apart
    assert "too few arms" not in simple(0.5, 0.0, (-0.062, 0.01), 8).message


def b_of(departure: float) -> TemperatureShifts:
    """The shifts of a colder test whose stiffness departs so far from T/T_r, in ln b_T."""
    cold = Shift(270.0, 2.0, 0.1, 0.9 * float(np.exp(departure)))
    return replace(TESTED, shifts=(cold, TESTED.shifts[1]))


def warming(kelvin: float) -> Nuisance:
    return Nuisance("warming of test 1", kelvin, 0.1, "K")


def plate(shape: np.ndarray) -> RampHold:
    """The record with its displacement times a shape."""
    return replace(RECORD, displacement=PLATE * shape)


def pause(length: float) -> RampHold:
    keep = (TIME <= 0.3) | (0.3 + length < TIME)
    time = np.sort(np.append(TIME[keep], 0.3 + length))
    x = DEPTH * np.clip(time, 0, 1)
    return replace(RECORD, time=time, displacement=x, force=PAPER.force(time, x))


def make_spiked_record(count: int) -> RampHold:
    force = RECORD.force + 1e-3 * np.random.default_rng(0).standard_normal(len(TIME))
    force[1000 : 1000 + 100 * count : 100] += 1.0
    return replace(RECORD, force=force)


def sinking(share: float) -> RampHold:
    """The plate gives way after the first tenth of the hold; the force rests."""
    shape = np.where(TIME > 6, 1 - share, 1.0)
    return replace(plate(shape), force=np.clip(TIME, 0, 1))


def bending(share: float, *, bends: int = 5) -> RampHold:
    """A ramp that swings so often, missed between samples by this share of the noise."""
    at = np.arange(len(TIME)) - int(np.searchsorted(TIME, 0.5))
    wave = np.where(at % 2, 1.0, -1.0) * (at > 0) * (at <= bends)
    tie = 1e-9 * (np.abs(PLATE - 0.2 * DEPTH) < 1e-9)  # no sample at the very limit
    scatter = 5e-6  # of the encoder; three of its standard deviations explain as much of a bend
    size, noise = 0.0, 0.1
    for _ in range(20):
        x = PLATE + size * wave + tie
        pressed = x > 0.2 * DEPTH
        stiffness = (RECORD.force[pressed] / x[pressed]).max()
        # of few bends the sixth is one of the two ends, a quarter of those between
        size = (8 if bends < 8 else 2) * (share * noise / stiffness + 3 * 6**0.5 / 8 * scatter)
    return replace(RECORD, displacement=x, force_noise=noise, displacement_noise=scatter)


def leaping(share: float) -> RampHold:
    """A clock of uneven steps that leaps in mid-hold by this part of the time since onset."""
    uneven = TIME - 0.008 * (np.arange(len(TIME)) % 10)  # in bursts, as a reading changes
    late = TIME > 10
    leap = share * uneven[~late][-1] - np.diff(uneven)[np.flatnonzero(late)[0] - 1]
    return replace(RECORD, time=uneven + late * leap, hold_end=41 + leap)


def leapt(share: float) -> RampHold:
    """A clock of even steps, 1 ms at last, that leaps by this part of the time since onset."""
    time = np.concatenate((np.arange(0, 30, 0.01), np.arange(30, 32, 1e-3)))
    time[time > 31] += share * time[time <= 31][-1] - 1e-3
    x = DEPTH * np.clip(time, 0, 1)
    return RampHold(time, x, PAPER.force(time, x), 0.0, 1.0, 32.0, DEPTH)


def creeping(readings: int) -> RampHold:
    x = PLATE.copy()
    x[len(x) - 1 - readings : -1] += 1e-6 * np.arange(1, readings + 1)
    x[-1] = x[-2]
    return replace(RECORD, displacement=x)


def flat_top(samples: int) -> RampHold:
    force = RECORD.force.copy()
    force[(0.899 - 0.01 * samples < TIME) & (TIME < 0.899)] = 3.0
    return replace(RECORD, force=force)


def make_quantised_record(step: float) -> RampHold:
    return replace(RECORD, displacement=np.round(PLATE / step) * step)


def make_sampled_record(count: int) -> RampHold:
    time = np.concatenate((np.linspace(0, 1, count), np.linspace(1.1, 41, 400)))
    x = DEPTH * np.clip(time, 0, 1)
    return RampHold(time, x, PAPER.force(time, x), 0.0, 1.0, 41.0, DEPTH)


def rising(share: float) -> RampHold:
    """The last tenth of the hold is higher by this share of the largest force."""
    return replace(RECORD, force=np.where(TIME > 36.9, 2 / (1 - share), 2.0 * np.clip(TIME, 0, 1)))


def stuck(share: float) -> Check:
    """A force with noise that keeps one value for this share of the hold."""
    force = RECORD.force + 0.01 * np.random.default_rng(0).standard_normal(len(TIME))
    held = RECORD.hold
    first, count = held.start + 2000, round(share * (held.stop - held.start))
    force[first : first + count] = force[first]
    return preparation.readings_not_repeated(replace(RECORD, force=force), force, PLATE)


def stuck_gauge(share: float) -> Check:
    """A displacement with noise that keeps one value for this share of the held load."""
    time = np.arange(-100, 4001) / 100
    x = np.clip(time, 0, 1) + 0.01 * np.random.default_rng(0).standard_normal(len(time))
    test = LoadHold(time, x, x, x, 0.0, 1.0, 40.0, 1.0, displacement_noise=0.01)
    held = test.hold
    first, count = held.start + 2000, round(share * (held.stop - held.start))
    x[first : first + count] = x[first]
    return creep.displacement_samples_not_repeated(test, x)


def draw_counts() -> np.ndarray:
    return np.random.default_rng(0).integers(0, 8, 500).astype(float)


def loadings(count: int) -> tuple[RampHoldCycle, ...]:
    ramp = MotionSegment("load", 0, 100, 0.0, 1.0, 0.0, DEPTH)
    hold = MotionSegment("hold", 100, 4100, 1.0, 41.0, DEPTH, DEPTH)
    return count * (RampHoldCycle(None, (ramp, hold)),)


def wandering(ratio: float) -> np.ndarray:
    power = np.zeros(501)
    power[60:241], power[6:25] = 1.0, ratio
    return np.fft.irfft(np.sqrt(power), 1000)


def sweep(*, storage: float = 2.0, negative: int = 0) -> DynamicTest:
    loss = np.array([0.1, 0.1, 0.1])
    loss[:negative] = -0.1
    return DynamicTest(np.array([1.0, 2.0, 4.0]), np.array([1.0, 2.0, storage]), loss, units="SI")


@cache
def agreeing() -> Comparison:
    frf = predict_frf(2 * PAPER, mass=0.104, frequency=np.arange(5, 20, 0.01))
    return compare(frf, frf, model=PAPER, mass=0.104, seals=2)


def make_comparison(**changes: object) -> Comparison:
    return replace(agreeing(), **changes)


def make_scaled_comparison(height: float) -> Comparison:
    frf = agreeing().measured
    return make_comparison(measured=replace(frf, value=height * frf.value))


def peak(lines: float) -> Peak:
    return Peak(12.7, 1000.0, 0.004, 0.0, 0.0, lines, 0.0)


BENT = ElasticLaw((0.0, DEPTH), (0.8, 1.2), 200.0)
SEEN = a_fit(PAPER, band=(0.1, 2.0))
GRAVITY = 9.80665

LINES = np.arange(5.0, 20.0, 0.1)
MODE = Mode(10.0, 0.05, 1j)
HITS = tuple(Hit(str(i), float(i), accepted=True) for i in (1, 2, 3))


def make_measured_frf(**changes: object) -> FRF:
    frf = predict_frf(2 * PAPER, mass=0.104, frequency=LINES)
    return replace(frf, **{"averages": 3, "hits": HITS, "coherence": np.ones(150), **changes})


def over_base(part: float) -> FRF:
    """A mass on a spring that peaks at 12 Hz, so much softer or stiffer below 7.2 Hz."""
    f = np.linspace(2.0, 24.0, 45)
    stretch = (f / 12) ** 2 * np.where(f <= 7.2, part, 1.0)
    return FRF(f, 1 / (1 - stretch + 0.1j), "transmissibility", units="SI")


def held_at(runs: int) -> ShakenTest:
    """A mass that so often stays for three samples at the end of its range."""
    base = np.sin(np.arange(400.0))
    mass = base.copy()
    for run in range(runs):
        mass[20 * run + 5 : 20 * run + 8] = 2.0 * (-1) ** run
    return ShakenTest(256.0, base, mass)


def spectra(*, level: float = 0.0, odd: float = 0.0) -> Spectra:
    """Three hits on a system that answers 1; `level` dB at the mode, one response off by `odd`."""
    force = np.ones((3, 150), dtype=complex)
    force[:, np.argmin(np.abs(LINES - MODE.frequency))] = 10 ** (level / 20)
    response = force.copy()
    response[2] *= 1 + odd
    return Spectra(LINES, force, response)


def make_combination(*, residual: float = 0.0, eccentric: float = 0.0) -> Combination:
    return Combination((0.5, 0.5), 60j, 200j, residual, residual, (0.0, eccentric, 0.0))


# -- where each check passes, and where it fails --------------------------------------------------


def gauge_of(high: float):
    """A study of a gauge whose part of all reaches as far as that."""
    return {"gauge": SimpleNamespace(share=0.9 * high, share_interval=(0.5 * high, high))}


class Case(NamedTuple):
    """A check of what `judge` makes of a number: it passes at one, and fails at another."""

    check: str
    judge: Callable[[float], Check]
    passes: float | None
    fails: float | None


def stiffer(departure: float, *, explains: bool = True) -> Explanation:
    return Explanation(
        "stiffness", 1 + departure, 0.01, "1", departure, 50.0, explains, "the seals are stiffer"
    )


def trend(**changes: float) -> impact.Trend:
    """Hits of 1 to 4 in height, whose resonance changes by so much a doubling."""
    stiffness = 0.02 if "stiffness_sure" in changes else 0.0
    values = {"stiffness": stiffness, "damping": 0.0} | changes
    stiffer, damped = (
        RegressionLine(
            values[name], values.get(f"{name}_sure", 0.0), values.get(f"{name}_found", 0.0),
            0.0, 0.0, 0.0, 1.0, 3,
        )
        for name in ("stiffness", "damping")
    )  # fmt: skip
    return impact.Trend(stiffer, damped, 0.1, 0.0, (1e-4, 4e-4), 4.0)


def judge_integer(judge: Callable[[int], Check]) -> Callable[[float], Check]:
    return lambda x: judge(int(x))


def baseline(x: int) -> Check:
    return preparation.baseline_recorded(Baseline(x, 1.0, 0.0, 1e-3, 0.0, 0.0, 0.0))


def judge_filter_bias(x: float) -> Check:
    changes = {"hold": {"k_inf": x}, "full": {"k_inf": 0.0}}
    return relaxation.filter_bias(parse_filter("lowpass:20Hz"), changes, 1.0)


def cut_off(hertz: float) -> Check:
    changes = {"hold": {"k_inf": 0.0}, "full": {"k_inf": 0.0}}
    return relaxation.filter_bias(parse_filter(f"lowpass:{hertz}Hz"), changes, 1.0)


def law(missed: float) -> LawScore:
    """One that misses its shifts by more than chance."""
    return LawScore("wlf", 1e4, 6, 0.0, missed, 273.15)


def check_k_inf(width: float) -> Check:
    """k_inf within an interval of this part of the stiffness at the end of the hold."""
    spring = GeneralizedMaxwell(1.0)
    return relaxation.k_end_determined(spring, width / 4, [RECORD])


def check_k_end(width: float) -> Check:
    """k(T) = 1 N/m within an interval of this width, and k_inf anywhere."""
    end = EndOfHold(40.0, (1 - width / 2, 1 + width / 2), (0.0, 9.0), (0.0, 9.0), 0.0)
    return relaxation.k_end_determined(GeneralizedMaxwell(1.0), np.inf, [RECORD], end)


def curve_end(levels: float, falls: float = 0.0) -> EndOfHold:
    """A curve that may fall to so much of its end in ten times as long."""
    ends = (0.9, 1.0), (0.5, 1.0), (0.0, 1.0)
    return EndOfHold(40.0, *ends, slope_limit=falls, k_10end=(levels, 1.0), test_kind="curve")


def falling(share: float) -> RampHold:
    """The force loses this share of its peak a tenth into the hold."""
    return replace(RECORD, force=np.where(TIME > 6, 1 - share, 1.0))


NOISY = replace(RECORD, force_noise=0.01)


def make_ramp_residual(times: float) -> np.ndarray:
    """A residual of so many times the noise, in the ramp alone."""
    return np.where((TIME > 0) & (TIME <= 1), times * NOISY.force_noise, 0.0)


def load(rest: int = 10, change: float = 0.0) -> LoadHold:
    """A load of 1 after so many samples, that rises by `change` while it is held."""
    time = 0.1 * np.arange(rest + 100)
    since = time - 0.1 * rest
    held = np.where(since >= -1e-9, 1.0 + change * np.clip(since / 10, 0, 1), 0.0)
    first, end = float(time[rest]), float(time[-1])
    return LoadHold(time, held, held, held, first, first, end, 1.0, displacement_noise=0.01)


def crept(residual: float) -> Check:
    """A part that has this part of its displacement at rest to come after 10 s."""
    lam = 10.0
    spectrum = CreepSpectrum(1 - residual * np.e, (residual * np.e,), (lam,))
    return creep.creep_finished(spectrum, lam)


def judge_hold_residual(times: float) -> Check:
    """A residual of so many times the noise in the hold."""
    held = load()
    return creep.displacement_residual_small(held, np.full(len(held.time), 0.01 * times))


PREPARATION = [
    Case("baseline_recorded", judge_integer(baseline), 5, 4),
    Case(
        "contact_detected",
        lambda x: preparation.contact_detected(Touch(0.0, 1e-3, DEPTH * x), DEPTH, is_given=False),
        0.00999,
        0.01001,
    ),
    Case("preload_absent", lambda x: preparation.preload_absent(-2 * x, 2.0), 0.0499, 0.0501),
    Case("ramp_recorded", lambda x: preparation.ramp_recorded(-2.0, 2 * x), 1.0999, 1.1001),
    Case(
        "single_loading",
        judge_integer(lambda n: preparation.single_loading(0, loadings(n), is_requested=False)),
        1,
        2,
    ),
    Case(
        "history_explained",
        lambda x: preparation.history_explained(
            EarlierLoadings(x, 2, converged=True), has_missing_rows=False
        ),
        0.0299,
        0.0301,
    ),
    Case("earlier_loading_negligible", preparation.earlier_loading_negligible, 0.00499, 0.00501),
    Case(
        "face_recovered",
        lambda x: preparation.face_recovered(1e-3 + DEPTH * x, 1e-3, error=0.0, depth=DEPTH),
        0.00999,
        0.01001,
    ),
    Case(
        "overshoot_small",
        lambda x: preparation.overshoot_small(
            plate(np.where((TIME > 0.995) & (TIME < 1.1), 1 + x, 1.0)), ramp_count=1
        ),
        0.0499,
        0.0501,
    ),
    Case("samples_unbroken", lambda x: preparation.samples_unbroken(pause(x)), 0.1999, 0.2001),
    Case("readings_not_repeated", stuck, 20 / 4001, 21 / 4001),
    Case(
        "spikes_absent",
        judge_integer(lambda n: preparation.spikes_absent(make_spiked_record(n))),
        0,
        1,
    ),
    Case(
        "temperature_as_stated",
        lambda x: preparation.temperature_as_stated(
            Specimen(temperature=296.0 + x, stated_temperature=296.0)
        ),
        0.99,
        1.01,
    ),
    Case(
        "temperature_held",
        lambda x: preparation.temperature_held(Specimen(warmed=x)),
        0.99,
        1.01,
    ),
    Case(
        "machine_deflection_small",
        lambda x: preparation.machine_deflection_small(x / 5e-5, "Measure it at the seal."),
        0.0249,
        0.0251,
    ),
    Case("columns_plausible", lambda x: preparation.columns_plausible(sinking(x)), 0.0299, 0.0301),
    Case("motion_resolved", lambda x: preparation.motion_resolved(bending(x)), 0.1249, 0.1251),
    Case(
        "motion_resolved",
        lambda x: preparation.motion_resolved(bending(x, bends=40)),
        0.0599,
        0.0601,
    ),
    Case("clock_steady", lambda x: preparation.clock_steady(leaping(x)), 0.2499, 0.2501),
    Case("clock_steady", lambda x: preparation.clock_steady(leapt(x)), 0.000999, 0.001001),
    Case(
        "motion_measured",
        judge_integer(lambda n: preparation.motion_measured(creeping(n))),
        1,
        None,
    ),
    Case(
        "load_cell_range_used",
        lambda x: preparation.load_cell_range_used(70 * x, 70.0),
        0.0501,
        0.0499,
    ),
    Case(
        "force_not_clipped",
        judge_integer(lambda n: preparation.force_not_clipped(flat_top(n))),
        4,
        5,
    ),
    Case("force_resolved", lambda x: preparation.force_resolved(draw_counts(), x), 20.0, 19.99),
    Case(
        "depth_resolved",
        lambda x: preparation.depth_resolved(make_quantised_record(x * np.sqrt(6) * DEPTH)),
        0.00249,
        0.00251,
    ),
    Case(
        "hold_is_still",
        lambda x: preparation.hold_is_still(
            plate(np.where((TIME > 1) & (TIME < 2), 1 - x, 1.0)), method="hold"
        ),
        0.00999,
        0.01001,
    ),
    Case(
        "hold_outlasts_ramp",
        lambda x: preparation.hold_outlasts_ramp(replace(RECORD, hold_end=1 + x)),
        10.01,
        9.99,
    ),
    Case(
        "ramp_sampled",
        judge_integer(lambda n: preparation.ramp_sampled(make_sampled_record(n))),
        10,
        9,
    ),
    Case("force_relaxes", lambda x: preparation.force_relaxes(rising(x)), 0.00499, 0.00501),
    Case(
        "strain_small",
        lambda x: preparation.strain_small(replace(RECORD, specimen=Specimen(height=DEPTH / x))),
        0.1999,
        0.2001,
    ),
]

COLD_AND_WARM = np.array([273.15, 296.15])
FITTING = [
    Case(
        "uncertainty_estimated", lambda x: solid.uncertainty_estimated(is_estimated=bool(x)), 1, 0
    ),
    Case("optimiser_converged", lambda x: solid.optimiser_converged(stationary=bool(x)), 1, 0),
    Case("k_end_determined", check_k_inf, 0.499, 0.501),
    Case("k_end_determined", check_k_end, 0.499, 0.501),
    Case(
        "arms_where_force_relaxes",
        lambda x: relaxation.arms_where_force_relaxes(GeneralizedMaxwell(1.0), falling(x)),
        0.0199,
        0.0201,
    ),
    Case(
        "force_residual_small",
        lambda x: relaxation.force_residual_small(NOISY, make_ramp_residual(x)),
        1.749,
        1.751,
    ),
    Case(
        "same_specimen",
        lambda x: relaxation.same_specimen(
            [EndStiffness(200.0, 4.0, DEPTH, None), EndStiffness(200 + 5 * x, 3.0, DEPTH, None)]
        ),
        2.99,
        3.01,
    ),
    Case(
        "hold_long_enough",
        lambda x: relaxation.hold_long_enough(
            EndOfHold(40.0, (90.0, 100.0), (80.0, 95.0), (0.0, 95.0), 100 * x)
        ),
        0.0299,
        0.0301,
    ),
    Case(
        "arms_distinct",
        lambda x: solid.arms_distinct(GeneralizedMaxwell(1.0, (1.0, 1.0), (1.0, x))),
        1.501,
        1.499,
    ),
    Case("arms_supported", lambda x: solid.arms_supported(arm(x), np.array([0, 1, 0])), 3.01, 2.99),
    Case("arms_supported", lambda x: solid.arms_supported(arm(), np.array([0, 0.1, x])), 0.49, 0.5),
    Case(
        "tau_inside_window",
        lambda x: solid.tau_inside_window(arm(1, x), (0.1, 10), "it"),
        9.99,
        10.01,
    ),
    Case(
        "tau_inside_window",
        lambda x: solid.tau_inside_window(arm(1, x), (0.1, 10), "it"),
        0.101,
        0.099,
    ),
    Case(
        "tau_inside_window",
        lambda x: solid.tau_inside_window(arm(1, 10.0), (0.1, 10.0), "it", is_closed=bool(x)),
        0,
        1,
    ),
    Case(
        "k_inf_positive",
        lambda x: relaxation.k_inf_positive(GeneralizedMaxwell(x, (), ()), 1.0),
        3.001,
        2.999,
    ),
    Case("residuals_white", lambda x: solid.residuals_white(x, 1.0), 19.99, 20.01),
    Case(
        "ramp_accounted_for",
        lambda x: relaxation.ramp_accounted_for(arm(1, x), [RECORD]),
        1e-3,
        None,
    ),
    Case(
        "fast_arm_visible", lambda x: relaxation.fast_arm_visible(arm(1, x), [RECORD]), 0.1, 0.0999
    ),
    Case(
        "drift_distinguished_from_arm",
        lambda x: relaxation.drift_distinguished_from_arm(arm(), 0.95, x),
        0.0999,
        0.1001,
    ),
    Case(
        "drift_distinguished_from_arm",
        lambda x: relaxation.drift_distinguished_from_arm(arm(), x, 0.2),
        0.899,
        0.901,
    ),
    Case("residuals_steady", lambda x: relaxation.residuals_steady([wandering(x)]), 3.99, 4.01),
    Case("order_agreed", judge_integer(lambda n: solid.order_agreed(OrderChoice(1, 2, n))), 2, 1),
    Case(
        "order_agreed",
        lambda x: solid.order_agreed(OrderChoice(2, 2, 2, is_largest_tried=bool(x))),
        0,
        1,
    ),
    Case(
        "hold_and_full_agree",
        lambda x: relaxation.hold_and_full_agree(arm(), arm(1 + x), np.zeros(3)),
        0.0999,
        0.1001,
    ),
    Case(
        "hold_and_full_agree",
        lambda x: relaxation.hold_and_full_agree(arm(), arm(1 + x), np.array([0.0, 0.1, 0.0])),
        0.299,
        0.301,
    ),
    Case(
        "hold_and_full_agree",
        lambda x: relaxation.hold_and_full_agree(
            arm(), GeneralizedMaxwell(1 + x, (), ()), np.zeros(3)
        ),
        0.0999,
        0.1001,
    ),
    Case("valid_band_exists", lambda x: solid.valid_band_exists((1.0, x)), 1.001, 1.0),
    Case(
        "loss_factor_determined",
        lambda x: solid.loss_factor_determined(BandError((1.0, 2.0), (0.1, 0.1), (0.1, x))),
        0.299,
        0.301,
    ),
    Case(
        "loss_factor_determined",
        lambda x: solid.loss_factor_determined(BandError((1.0,), (0.1,), (0.1,), (0.1, x))),
        0.299,
        0.301,
    ),
    Case(
        "arms_enough",
        judge_integer(
            lambda n: solid.arms_enough(
                None if n < 2 else ArmShortage(1, n, 9e-3, 4e-3), 1, unit="N"
            )
        ),
        1,
        2,
    ),
    Case("samples_independent", lambda x: solid.samples_independent(x, 0, 20.0), 5.01, 4.99),
    Case("samples_independent", lambda x: solid.samples_independent(7.0, 6, x), 9.99, 10.01),
    Case("filter_bias", judge_filter_bias, 0.00999, 0.01001),
    Case("filter_bias", cut_off, 5.0, 4.99),
    Case(
        "depth_and_time_separable",
        lambda x: relaxation.depth_and_time_separable(x, 0.5),
        0.0101,
        0.0099,
    ),
    Case(
        "depth_and_time_separable",
        lambda x: relaxation.depth_and_time_separable(1e-9, x),
        0.99e-3,
        1.01e-3,
    ),
]
CURVES = [
    Case(
        "plateau_seen",
        lambda x: curves.plateau_seen(
            GeneralizedMaxwell(x, (), ()), 1.0, unit="Pa", remedy="Measure longer."
        ),
        3.001,
        2.999,
    ),
    Case(
        "plateau_seen",
        lambda x: curves.plateau_seen(
            GeneralizedMaxwell(x, (1.0,), (1.0,)), 0.0, unit="Pa", remedy="Measure longer."
        ),
        1.1e-12,
        0.9e-12,
    ),
    Case(
        "plateau_determined", lambda x: curves.plateau_determined(curve_end(x), "Pa"), 0.801, 0.799
    ),
    Case(
        "plateau_determined",
        lambda x: curves.plateau_determined(replace(curve_end(x), test_kind="creep"), "Pa"),
        0.651,
        0.649,
    ),
    Case(
        "curve_level_at_end",
        lambda x: curves.curve_level_at_end(curve_end(0.9, x), 1.0),
        0.0299,
        0.0301,
    ),
    Case(
        "curve_level_at_end",
        lambda x: curves.curve_level_at_end(curve_end(0.9, x), 0.1),
        0.0199,
        0.0201,
    ),
    Case(
        "few_arms_sufficient",
        lambda x: curves.few_arms_sufficient(x, 2, 6, (20, 1e-3)),
        0.0499,
        0.05,
    ),
    Case(
        "kramers_kronig",
        lambda x: curves.kramers_kronig((np.full(50, x), np.zeros(50))),
        0.0499,
        0.0501,
    ),
    Case(
        "instrument_stiff",
        lambda x: curves.instrument_stiff(
            replace(sweep(storage=x / curves.USUAL_COMPLIANCE), unit="N/m")
        ),
        0.0099,
        0.0101,
    ),
    Case("loss_positive", judge_integer(lambda n: curves.loss_positive(sweep(negative=n))), 0, 1),
    Case("storage_rises", lambda x: curves.storage_rises(sweep(storage=2 - 2 * x)), 0.0499, 0.0501),
    Case("modulus_falls", lambda x: curves.modulus_falls(np.repeat([1.0, 1.1, x], 3)), 1.24, 1.26),
    Case("strain_not_small", lambda x: curves.strain_not_small(x, "%"), 0.0051, 0.0049),
    Case("strain_not_large", lambda x: curves.strain_not_large(x, "mm/mm"), 2.99, 3.01),
    Case("modulus_of_a_rubber", lambda x: curves.modulus_of_a_rubber(3e6 * x, "MPa"), 299, 301),
    Case("modulus_of_a_rubber", lambda x: curves.modulus_of_a_rubber(3e6 / x, "kPa"), 299, 301),
    Case(
        "data_agree",
        lambda x: curves.data_agree([1.0, x], ["storage", "loss"], [80, 80]),
        1.299,
        1.301,
    ),
    Case("bands_overlap", lambda x: curves.bands_overlap((x, 100.0), (0.1, 1.0)), 9.99, 10.01),
    Case("values_enough", lambda x: curves.values_enough(5, "times", are_limited=bool(x)), 1, 0),
]
CREEP = [
    Case("load_begins_at_rest", judge_integer(lambda n: creep.load_begins_at_rest(load(n))), 5, 4),
    Case("load_held", lambda x: creep.load_held(load(change=x / 0.89)), 0.0199, 0.0201),
    Case("displacement_samples_not_repeated", stuck_gauge, 19 / 3901, 20 / 3901),
    Case(
        "compliance_rises",
        lambda x: creep.compliance_rises(np.repeat([1.0, 1.0, x], 3)),
        0.801,
        0.799,
    ),
    Case("creep_finished", crept, 0.0499, 0.0501),
    Case(
        "flow_exceeds_slow_retardation",
        lambda x: creep.flow_exceeds_slow_retardation(CreepSpectrum(1.0 - x, (), (), x), 1.0),
        0.501,
        0.499,
    ),
    Case("flow_distinguished", lambda x: creep.flow_distinguished(True, x, 0.01), 10.01, 9.99),
    Case(
        "drift_distinguished_from_flow",
        lambda x: creep.drift_distinguished_from_flow(-x * 1e-6, 1e-6, is_reported=False),
        1.99,
        2.01,
    ),
    Case("displacement_residual_small", judge_hold_residual, 1.99, 2.01),
    Case(
        "compliance_residual_small", lambda x: creep.compliance_residual_small(x, 6), 0.0499, 0.0501
    ),
    Case("levels_agree", lambda x: creep.levels_agree(-x, 1e-3), 0.0299, 0.0301),
]
SUPERPOSITION = [
    Case(
        "isotherms_overlap",
        lambda x: checks.isotherms_overlap(np.array([x]), COLD_AND_WARM),
        0.501,
        0.499,
    ),
    Case(
        "shifts_determined",
        lambda x: checks.shifts_determined(np.array([x]), COLD_AND_WARM, np.array([0.0, x])),
        0.299,
        0.301,
    ),
    Case(
        "shift_monotone",
        lambda x: checks.shift_monotone(np.array([0.1 * x]), np.array([0.1]), COLD_AND_WARM),
        2.999,
        3.001,
    ),
    Case(
        "thermorheologically_simple",
        lambda x: checks.thermorheologically_simple(x, 1.0, 0.01),
        1.199,
        1.201,
    ),
    Case(
        "vertical_rule_holds",
        lambda x: checks.vertical_rule_holds(np.array([0.0, -x]), 99.0, COLD_AND_WARM),
        0.0299,
        0.0301,
    ),
    Case("law_follows_shifts", lambda x: checks.law_follows_shifts(law(x), []), 0.1499, 0.1501),
    Case(
        "no_temperature_outlier",
        lambda x: checks.no_temperature_outlier(ShiftOutlier(296.15, x)),
        0.0499,
        0.0501,
    ),
    Case(
        "glass_below_tests",
        lambda x: checks.glass_below_tests(WLF(8.0, 51.6, 296.15), 306.15 - x, 0.0),
        -0.01,
        0.01,
    ),
    Case(
        "vertical_shift_determined",
        lambda x: checks.vertical_shift_determined("1", x, 1.0),
        10.01,
        9.99,
    ),
]

RAMP = [
    Case("clocks_agree", lambda x: ramp.clocks_agree([(x, 1.0, 1e9)]), 2.99, 3.01),
    Case(
        "ramp_residual_small",
        lambda x: ramp.ramp_residual_small(x, 0.0, 3.0, "piecewise"),
        0.01,
        0.0101,
    ),
    Case(
        "ramp_residual_small",
        lambda x: ramp.ramp_residual_small(0.03, x, 3.0, "piecewise"),
        0.0201,
        0.0199,
    ),
    Case(
        "ramp_residual_small", lambda x: ramp.ramp_residual_small(0.0, 1.0, x, "linear"), 1.5, 1.51
    ),
    Case(
        "ramp_explained",
        lambda x: ramp.ramp_explained(
            assess_linear_fit(x, 1.0, 1.0, noise=1.0, discrepancy=1.0, samples=1e6, peak=1.0)
        ),
        1.199,
        1.201,
    ),
    Case(
        "hold_residual_small",
        lambda x: ramp.hold_residual_small([1.0, x], [1.0, 1.0]),
        1.249,
        1.251,
    ),
    Case("hold_residual_small", lambda x: ramp.hold_residual_small([9.0], [x]), 0.005, 0.0051),
    Case("tangent_determined", lambda x: ramp.tangent_determined(BENT, int(x)), 2, 1),
    Case(
        "k_inf_plausible",
        lambda x: ramp.k_inf_plausible(GeneralizedMaxwell(1.0, (), ()), 0.0, 1 / (1 - x), 1.0),
        0.0499,
        0.0501,
    ),
    Case(
        "k_inf_plausible",
        lambda x: ramp.k_inf_plausible(GeneralizedMaxwell(1.0, (), ()), x, 2.0, 1.0),
        0.334,
        0.333,
    ),
    Case("offset_plausible", lambda x: ramp.offset_plausible([(x, 0.0, 1.0, 9.0)]), 2.999, 3.001),
    Case("baseline_agrees", lambda x: ramp.baseline_agrees([(1e-3, x)]), 0.999, 1.001),
    Case("drift_plausible", lambda x: ramp.drift_plausible([(x, 0.0, 1.0, 9.0)]), 2.999, 3.001),
]


def make_alternative(parts_at: float | None, *, explains: bool = True) -> Alternative:
    """Another family of solids, which parts from the fit's own at a frequency."""
    return Alternative(PAPER, 3.0, explains, parts_at, "another solid explains the data too")


FRACTIONAL = [
    Case(
        "fractional_slope_determined",
        lambda x: fractional.fractional_slope_determined(x, edge=False),
        0.0499,
        0.0501,
    ),
    Case(
        "fractional_model_suffices",
        lambda x: fractional.fractional_model_suffices(x, 2),
        1.0199,
        1.0201,
    ),
    Case(
        "model_families_distinguished",
        lambda x: fractional.model_families_distinguished(make_alternative(x)),
        101.0,
        99.0,
    ),
]

IDENTIFICATION = [
    Case(
        "lines_explained",
        lambda x: identification.lines_explained(x, has_absolute_sd=True),
        1.999,
        2.001,
    ),
    Case(
        "lines_explained",
        lambda x: identification.lines_explained(x, has_absolute_sd=False),
        0.099,
        0.101,
    ),
    Case(
        "hammer_agrees_with_relaxation_test",
        lambda x: identification.hammer_agrees_with_relaxation_test(1, x),
        1.299,
        1.301,
    ),
    Case(
        "cables_described",
        lambda x: identification.cables_described(
            BandError((5.0, 20.0), (0.1, 0.1), (x, x)), 10.0, 0.015, 0.16
        ),
        0.299,
        0.301,
    ),
    Case("mass_plausible", lambda x: identification.mass_plausible(-2 * x, 2.0), 2.499, 2.501),
    Case("gain_plausible", lambda x: identification.gain_plausible(2 * x, 2.0), 2.499, 2.501),
    Case("delay_plausible", lambda x: identification.delay_plausible(2 * x, 2.0), 2.499, 2.501),
    Case(
        "stiffness_plausible",
        lambda x: identification.stiffness_plausible(2 * x, 2.0),
        2.499,
        2.501,
    ),
    Case(
        "hammer_agrees_with_earlier_fit",
        identification.hammer_agrees_with_earlier_fit,
        2.499,
        2.501,
    ),
    Case(
        "tests_agree",
        lambda x: identification.tests_agree(stiffer(x) if x else None),
        0,
        1,
    ),
    Case(
        "dashpot_not_missed",
        lambda x: identification.dashpot_not_missed(x, "1 arm", 0.1),
        49.9,
        50.1,
    ),
    Case(
        "dashpot_not_missed",
        lambda x: identification.dashpot_not_missed(x, "1 arm", 0.1, is_determined=False),
        -0.1,
        0.1,
    ),
    Case(
        "arms_identified",
        lambda x: identification.arms_identified(2, x),
        0.499,
        0.5,
    ),
    Case(
        "arms_identified",
        lambda x: identification.arms_identified(2, 0.3, unknown=(1.0,) * (not x)),
        1,
        0,
    ),
]

PLANNING = [
    Case(
        "loss_factor_determined",
        lambda x: planning.loss_factor_determined(x, 12.0, 0.1),
        0.0999,
        0.1001,
    ),
    Case(
        "inside_valid_band",
        lambda x: planning.inside_valid_band(x, (1.0, 2.0)),
        2.0,
        2.001,
    ),
    Case(
        "inside_valid_band",
        lambda x: planning.inside_valid_band(x, (1.0, 2.0)),
        1.0,
        0.999,
    ),
    Case(
        "record_long_enough",
        lambda x: planning.record_long_enough(RecordNeed(12.0, 0.01, 1.0, 1.0, 6.0, 3.0, x, 0.0)),
        6.0,
        5.99,
    ),
    Case(
        "tip_excites",
        lambda x: planning.tip_excites(Pulse(0.01, x, 1.0, 1.0, 1.0), 12.0),
        -9.99,
        -10.01,
    ),
]

VIBRATION = [
    Case(
        "seal_mass_negligible", lambda x: moving_mass(1.0, seal=x / 2, seals=2)[1], 0.0199, 0.0201
    ),
    Case("mass_of_a_block", vibration.mass_of_a_block, 1.01e-3, 0.99e-3),
    Case("compression_tested", lambda x: vibration.compression_tested(2 * x, 2.0), 0.99, 1.01),
    Case(
        "stiffness_causal",
        lambda x: vibration.stiffness_causal(x, 0.1, error=0.0, peak=12.0),
        0.1499,
        0.1501,
    ),
    Case(
        "stiffness_causal",
        lambda x: vibration.stiffness_causal(x, 0.1, error=0.05, peak=12.0),
        0.1999,
        0.2001,
    ),
]

SEALS = [
    *(
        Case(
            "door_modes_in_valid_band",
            lambda x, edge=edge, way=way: seals.door_modes_in_valid_band(
                [(1.0, 0.5), (edge * x**way, 0.0101)], (0.1, 2.0)
            ),
            0.999,
            1.001,
        )
        for edge, way in ((2.0, 1), (0.1, -1))
    ),
    Case(
        "door_modes_in_valid_band",
        lambda x: seals.door_modes_in_valid_band([(1.0, 0.5), (9.0, x)], (0.1, 2.0)),
        0.0099,
        0.0101,
    ),
    Case(
        "seal_touches",
        lambda x: seals.seal_touches(
            x, length=4.0, min_compression=-1e-3, position=1.0, max_compression=1e-3
        ),
        0.0,
        0.01,
    ),
    Case(
        "leak_speed_determined", lambda x: seals.leak_speed_determined(x, state="new"), 0.199, 0.201
    ),
    Case("line_closed", lambda x: seals.line_closed(4.0, x), 0.0, 0.001),
    Case("line_closed", lambda x: seals.line_closed(4.0, 0.0, (0.02, 0.1, x)), 0.99, 1.01),
    Case("lateral_restraint_present", lambda x: seals.lateral_restraint_present(x, 0.354), 0, 1),
    Case("seals_suffice", judge_integer(seals.seals_suffice), 10, 9),
    Case(
        "scatter_exceeds_testing",
        lambda x: seals.scatter_exceeds_testing(1e-4, 1e-4 * x),
        0.99,
        1.01,
    ),
    Case("shear_stiffness_plausible", seals.shear_stiffness_plausible, 1.499, 1.501),
    Case("stations_suffice", lambda x: seals.stations_suffice(x, 0.025), 0.99e-3, 1.01e-3),
    Case("modes_suffice", lambda x: seals.modes_suffice(x, 12, 300.0), 4.99e-3, 5.01e-3),
    Case(
        "mode_shapes_cover_points",
        lambda x: seals.mode_shapes_cover_points(x, "latch"),
        0.0299,
        0.0301,
    ),
    *(
        Case("masses_agree", lambda x, way=way: seals.masses_agree(25.0, 25 * x**way), 1.049, 1.051)
        for way in (1, -1)
    ),
    Case("door_supported", judge_integer(seals.door_supported), 0, 1),
    Case(
        "closing_in_valid_band",
        lambda x: seals.closing_in_valid_band(
            1 / (4 * x), (0.1, 1.0), glassy=1.7, values=(0.4, 0.5)
        ),
        0.99,
        1.01,
    ),
    Case("faster_closings_latch", lambda x: seals.faster_closings_latch(x == 0), 0, 1),
]

COMPARISON = [
    *(
        Case(
            "stiffness_agrees",
            lambda x, sign=sign: comparison.stiffness_agrees(
                make_comparison(predicted_hz=(1 + sign * x) * agreeing().measured_hz)
            ),
            0.0499,
            0.0501,
        )
        for sign in (1, -1)
    ),
    *(
        Case(
            "peak_agrees",
            lambda x: comparison.peak_agrees(
                make_comparison(predicted_peak=10 ** (x / 20) * agreeing().measured_peak)
            ),
            sign * 2.99,
            sign * 3.01,
        )
        for sign in (1, -1)
    ),
    *(
        Case(
            "damping_agrees",
            lambda x: comparison.damping_agrees(
                make_comparison(predicted_damping=0.01 * x, measured_damping=0.01), peak(10)
            ),
            1.249**sign,
            1.251**sign,
        )
        for sign in (1, -1)
    ),
    *(
        Case(
            "no_unit_error",
            lambda x: comparison.no_unit_error(
                make_comparison(measured_hz=1.0, predicted_hz=1 / x, measured=agreeing().predicted)
            ),
            passes * np.sqrt(1000),
            fails * np.sqrt(1000),
        )
        for passes, fails in ((1.101, 1.099), (1 / 1.101, 1 / 1.099))
    ),
    Case(
        "no_unit_error",
        lambda x: comparison.no_unit_error(make_scaled_comparison(x * GRAVITY)),
        1.101,
        1.099,
    ),
    Case(
        "no_unit_error",
        lambda x: comparison.no_unit_error(make_scaled_comparison(x * 1000)),
        1.101,
        1.099,
    ),
    Case(
        "lines_resolve_the_peak",
        lambda x: comparison.lines_resolve_the_peak(peak(50), peak(x)),
        1.5,
        1.499,
    ),
    *(
        Case(
            "inside_valid_band",
            lambda x, edge=edge, way=way: comparison.inside_valid_band(
                make_comparison(measured_hz=edge * x**way), SEEN
            ),
            0.999,
            1.001,
        )
        for edge, way in ((2.0, 1), (0.1, -1))
    ),
    Case(
        "damping_tested",
        lambda x: comparison.damping_tested(make_comparison(measured_hz=x), SEEN),
        2.0,
        2.001,
    ),
    *(
        Case(
            "operating_point",
            lambda x: comparison.operating_point(OperatingPoint(x * DEPTH, DEPTH)),
            passes,
            fails,
        )
        for passes, fails in ((1.249, 1.251), (0.751, 0.749))
    ),
    Case(
        "operating_point",
        lambda x: comparison.operating_point(
            OperatingPoint(x * DEPTH, DEPTH, 0.8, 0.01, linear=False)
        ),
        0.999,
        1.001,
    ),
]


def shape(misfit: float) -> ModeShape:
    """A mode of one point whose lines are missed by so much."""
    return ModeShape(MODE, np.array([MODE.residue]), np.zeros(1), misfit)


def make_chart(orders: int) -> Stabilisation:
    """A chart of one point in which a mode is stable at so many orders."""
    count = np.arange(1, orders + 1)
    hz, ratio = (np.full(orders, x) for x in (MODE.frequency, MODE.damping_ratio))
    state = np.full(orders, DAMPING)
    return Stabilisation(count, hz, ratio, state, np.ones(9), np.ones(9), highest=30, points=1)


def sharing(overlap: float) -> list[ModeShape]:
    """Two close modes of two points whose shapes share so much."""
    other = np.array([overlap, -np.sqrt(1 - overlap**2)], dtype=complex)
    close = replace(MODE, frequency=1.02 * MODE.frequency)
    mode_shape = ModeShape(MODE, np.array([1.0, 0.0], dtype=complex), np.zeros(2), 1.0)
    return [mode_shape, ModeShape(close, other, np.zeros(2), 1.0)]


MODAL = [
    Case("channels_not_clipped", lambda x: modal.channels_not_clipped(held_at(int(x))), 1, 2),
    Case(
        "segments_resolve",
        lambda x: modal.segments_resolve(make_measured_frf(), replace(MODE, damping_ratio=x / 200)),
        6.01,
        5.99,
    ),
    Case(
        "modes_within_band",
        lambda x: modal.modes_within_band([MODE] * 2, (MODE.frequency + x, 99.0)),
        0.0,
        1e-6,
    ),
    Case(
        "modes_stable",
        judge_integer(lambda n: modal.modes_stable([shape(1.0)], make_chart(n))),
        5,
        4,
    ),
    Case(
        "modes_explain_lines",
        lambda x: modal.modes_explain_lines([shape(0.5), shape(x)], is_known=True),
        3.999,
        4.001,
    ),
    Case("points_share_modes", lambda x: modal.points_share_modes(sharing(x)), 0.2001, 0.1999),
    # of two masses four numbers, whose sum of squares exceeds 13.28 once in a hundred
    Case(
        "single_solid_explains_masses",
        lambda x: modal.single_solid_explains_masses(x, (0.1, 0.2), (0.1, "1 % of stiffness")),
        3.63,
        3.66,
    ),
]

ROD = [
    Case(
        "modulus_determined_near_resonance",
        judge_integer(lambda n: rod.modulus_determined_near_resonance(n, (10.0, 20.0))),
        8,
        7,
    ),
    Case("mass_ratio_suitable", rod.mass_ratio_suitable, 99.9, 100.1),
    Case("single_solid_explains_lines", rod.single_solid_explains_lines, 1.499, 1.501),
    Case("waves_plane", lambda x: rod.waves_plane(x, 300.0), 0.0499, 0.0501),
    Case(
        "sensors_agree", lambda x: rod.sensors_agree(x / 100, 0.0, values=(0.01, 0.02)), 2.99, 3.01
    ),
    Case(
        "sensors_agree", lambda x: rod.sensors_agree(0.0, -x / 50, values=(0.01, 0.02)), 2.99, 3.01
    ),
]


def empty_run(**parts: float) -> EmptyRun:
    none = np.zeros(0)
    value, ratio = RigEstimate(1.0, 0.01), {"motion_force": 0.0, "slow_noise": 0.0} | parts
    return EmptyRun(
        noise=value, drift=value, hum=value, hum_frequency=50.0, motion_error=0.5,
        unsteady_share=0.0, fitted=none, force=none, **ratio,
    )  # fmt: skip


BLANK_TESTS = [
    Case("blank_tests_complete", lambda x: blank.blank_tests_complete(True, True, x > 2), 3, 2),
    Case("stop_rigid", blank.stop_rigid, 199e-6, 201e-6),
    Case("stop_force_straight", blank.stop_force_straight, 0.0299, -0.0301),
    Case("stop_force_returns", blank.stop_force_returns, -0.0199, 0.0201),
    Case("stop_follows_machine", blank.stop_follows_machine, 0.0049, 0.0051),
    Case("crosshead_creep_plausible", blank.crosshead_creep_plausible, -29e-6, -31e-6),
    Case("spring_force_straight", blank.spring_force_straight, 0.0049, 0.0051),
    Case("spring_force_returns", blank.spring_force_returns, 0.0029, -0.0031),
    Case("spring_follows_machine", blank.spring_follows_machine, 0.0019, 0.0021),
    Case(
        "stop_and_spring_creep_agree",
        lambda x: blank.stop_and_spring_creep_agree(x, 2e-6, 1e-6), 2.99, -3.01,
    ),
    Case(
        "stop_and_spring_delay_agree",
        lambda x: blank.stop_and_spring_delay_agree(x, 2e-3, 1e-3), -2.99, 3.01,
    ),
    Case("repeated_stops_agree", blank.repeated_stops_agree, 0.099, 0.101),
    Case("repeated_springs_agree", blank.repeated_springs_agree, 0.0099, 0.0101),
    Case("delay_determined", blank.delay_determined, 0.49e-3, 0.51e-3),
    Case("gain_plausible", blank.gain_plausible, 1.034, 1.036),
    Case("gain_plausible", blank.gain_plausible, 1 / 1.034, 1 / 1.036),
    Case(
        "empty_run_force_free_of_motion",
        lambda x: blank.empty_run_force_free_of_motion(empty_run(motion_force=x / 2)), 4.99, 5.01,
    ),
    Case("empty_run_plate_steady", blank.empty_run_plate_steady, 0.149, 0.151),
    Case(
        "empty_run_force_steady",
        lambda x: blank.empty_run_force_steady(empty_run(slow_noise=x)), 0.199, 0.201,
    ),
]  # fmt: skip
CSR = [
    Case("force_falls", csr.force_falls, 2.99, 3.01),
    Case("f0_read", lambda x: csr.f0_read(1800 * x), 1.99, 2.01),
    Case("readings_residuals_random", csr.readings_residuals_random, 2.99, 3.01),
    Case("chemical_aging_resolved", lambda x: csr.chemical_aging_resolved(x, 400.0), 4.01, 3.99),
    Case("readings_residual_small", csr.readings_residual_small, 0.0399, 0.0401),
    Case(
        "robust_to_lower_activation_energy",
        lambda x: csr.robust_to_lower_activation_energy(x, 65e3, 373.0),
        1.99,
        2.01,
    ),
    Case("ovens_enough", judge_integer(csr.ovens_enough), 3, 2),
    Case(
        "activation_energy_plausible",
        lambda x: csr.activation_energy_plausible(9e4 * x),
        2.99,
        3.01,
    ),
    Case(
        "activation_energy_plausible",
        lambda x: csr.activation_energy_plausible(9e4 * x),
        0.34,
        -0.5,
    ),
    Case("aging_prediction_determined", csr.aging_prediction_determined, 0.99, 1.01),
    Case(
        "single_activation_energy_explains_ovens",
        csr.single_activation_energy_explains_ovens,
        8.99,
        9.01,
    ),
    *(
        Case(
            "load_cell_zero_stable",
            lambda x, way=way: csr.load_cell_zero_stable(0.01 * way * x, 0.01),
            2.99,
            3.01,
        )
        for way in (1, -1)
    ),
    Case(
        "aging_exceeds_cell_drift",
        lambda x: csr.aging_exceeds_cell_drift(x / 1.8e8, 0.02),
        1.01,
        0.99,
    ),
    Case("temperature_near_ovens", lambda x: csr.temperature_near_ovens(x, 300.0), 29.9, 30.1),
    Case("stiffness_follows_force", csr.stiffness_follows_force, 0.0999, 0.1001),
    Case("life_sd_within_target", lambda x: csr.life_sd_within_target(0.2 * x, 0.2), 0.99, 1.01),
    Case("end_point_reached", judge_integer(lambda x: csr.end_point_reached(x, 0.5)), 1, 0),
    Case("time_near_readings", lambda x: csr.time_near_readings(x, 3.6e6), 1.99, 2.01),
]

DYNAMIC_STIFFNESS = [
    Case(
        "frequencies_in_valid_band",
        lambda x: dynamic_stiffness.frequencies_in_valid_band((5.0, 10 * x), (1.0, 10.0)),
        0.999,
        1.001,
    ),
    *(
        Case(
            "loss_factor_determined_at",
            partial(dynamic_stiffness.loss_factor_determined_at, with_hammer=with_hammer),
            0.299,
            0.301,
        )
        for with_hammer in (False, True)
    ),
]

DROP = [
    Case(
        "impact_within_measured_depth",
        lambda x: drop.impact_within_measured_depth(0.01 * x, 0.01),
        0.999,
        1.001,
    ),
    Case("impact_in_valid_band", lambda x: drop.impact_in_valid_band(10 * x, 10.0), 0.999, 1.001),
    Case("air_escapes", drop.air_escapes, 0.099, 0.101),
    Case("loss_determined", lambda x: drop.loss_determined(x, 12.0), 0.249, 0.251),
    Case("impacts_residual_small", drop.impacts_residual_small, 1.499, 1.501),
    Case(
        "impact_residual_structureless",
        lambda x: drop.impact_residual_structureless({"friction": -x}),
        2.499,
        2.501,
    ),
    Case("impacts_sampled", drop.impacts_sampled, 50.1, 49.9),
    Case("impact_speeds_spread", drop.impact_speeds_spread, 2.001, 1.999),
    Case("slow_arms_determined", lambda x: drop.slow_arms_determined(is_given=bool(x)), 1, 0),
    Case("impact_speeds_agree", drop.impact_speeds_agree, 2.999, 3.001),
    Case("impacts_separated", drop.impacts_separated, 10.01, 9.99),
    Case("impact_mass_agrees", lambda x: drop.impact_mass_agrees(1 + x), 0.0299, 0.0301),
    Case("impact_mass_agrees", lambda x: drop.impact_mass_agrees(1 - x), 0.0299, 0.0301),
    Case("arms_agree_with_relaxation_test", drop.arms_agree_with_relaxation_test, 2.999, 3.001),
    Case("spectrum_has_gaps", drop.spectrum_has_gaps, 4, 5),
    Case(
        "loss_factors_agree",
        lambda x: drop.loss_factors_agree(-x, 0.08, 0.1, is_in_interval=True),
        2.999,
        3.001,
    ),
    Case(
        "loss_factors_agree",
        lambda x: drop.loss_factors_agree(x, 0.1, 0.08, is_in_interval=True),
        2.999,
        3.001,
    ),
    Case("specimen_length_stated", lambda x: drop.specimen_length_stated(is_given=bool(x)), 1, 0),
]

IMPACT = [
    Case(
        "hits_enough",
        judge_integer(lambda n: impact.hits_enough(make_measured_frf(averages=n))),
        3,
        2,
    ),
    Case(
        "frf_dissipates",
        lambda x: impact.frf_dissipates(np.sqrt(1 - x * x) + 1j * x, 12.0),
        -0.299,
        -0.301,
    ),
    Case("mass_over_base", lambda x: impact.mass_over_base(over_base(x)), 2.99, 3.01),
    Case("mass_over_base", lambda x: impact.mass_over_base(over_base(x)), 0.34, 0.33),
    Case("line_errors_stated", lambda _: impact.line_errors_stated(), None, 0),
    Case(
        "coherence",
        lambda x: impact.coherence(make_measured_frf(coherence=np.full(150, x)), 75),
        0.9001,
        0.8999,
    ),
    *(
        Case(
            "amplitude_linear",
            lambda x, part=part, unit=unit, way=way: impact.amplitude_linear(
                trend(**{part: unit * x**way}), MODE
            ),
            0.999,
            1.001,
        )
        # hits of 1 to 4 are two doublings: 1 % of stiffness, 10 % of damping over them
        for part, unit, way in (
            ("stiffness", 0.005, 1),
            ("damping", -0.05, 1),
            ("stiffness_sure", 0.02, -1),
        )
    ),
    Case(
        "resonance", lambda x: impact.resonance(make_measured_frf(), MODE if x else None), 10.0, 0
    ),
    Case(
        "record_long_enough",
        lambda x: impact.record_long_enough(make_measured_frf(record=x / MODE.decay), MODE),
        6.001,
        5.999,
    ),
    Case(
        "window_decay_determined",
        lambda x: impact.window_decay_determined(
            ExponentialWindow(1.0, x * MODE.decay, evident=True, seen_rate=1.0), MODE
        ),
        0.0999,
        0.1001,
    ),
    Case(
        "lines_in_half_power_band",
        lambda x: impact.lines_in_half_power_band(
            make_measured_frf(), replace(MODE, damping_ratio=x / 200)
        ),
        1.501,
        1.499,
    ),
    Case(
        "hammer_excites",
        lambda x: impact.hammer_excites(make_measured_frf(), spectra(level=x), MODE),
        -9.99,
        -10.01,
    ),
    Case(
        "hits_agree",
        lambda x: impact.hits_agree(
            make_measured_frf(), spectra(odd=3 * x / (1 - x)), Estimator.H1, MODE
        ),
        0.0999,
        0.1001,
    ),
    Case(
        "rocking_cancelled",
        lambda x: impact.rocking_cancelled(make_measured_frf(), make_combination(residual=x)),
        0.0499,
        0.0501,
    ),
    Case(
        "hits_centred",
        lambda x: impact.hits_centred(make_measured_frf(), make_combination(eccentric=-x)),
        0.249,
        0.251,
    ),
    *(
        Case(
            "high_frequency_mass_agrees",
            lambda x: impact.high_frequency_mass_agrees((1 + x, 0.01), 1.0),
            sign * 0.049,
            sign * 0.051,
        )
        for sign in (1, -1)
    ),
]

TEMPERATURE = [
    Case("thermorheologically_simple", lambda x: simple(x, 5e-4), 0.00271, 0.00269),
    Case("thermorheologically_simple", lambda x: simple(0.0, x), 0.99 * 5e-6, 1.01 * 5e-6),
    Case("thermorheologically_simple", lambda x: simple(0.5, 5e-4, (x, 0.01)), 0.0499, 0.0501),
    Case("thermorheologically_simple", lambda x: simple(0.5, 5e-4, (0.1, 0.1 / x)), 2.49, 2.51),
    Case(
        "vertical_shift_plausible",
        lambda x: several.vertical_shift_plausible(b_of(x)),
        0.1499,
        0.1501,
    ),
    Case(
        "vertical_shift_plausible",
        lambda x: several.vertical_shift_plausible(b_of(-x)),
        None,
        0.1501,
    ),
    Case("temperature_steady", lambda x: several.temperature_steady([warming(x)]), 0.99, 1.01),
    Case("temperature_steady", lambda x: several.temperature_steady([warming(-x)]), None, 1.01),
    Case("shifts_distinguished", judge_integer(several.shifts_distinguished), 3, 2),
    Case(
        "shifts_independent_of_vertical_rule",
        several.shifts_independent_of_vertical_rule,
        0.0999,
        0.1001,
    ),
    Case(
        "shifts_independent_of_vertical_rule",
        lambda x: several.shifts_independent_of_vertical_rule(x, 0.1),
        0.2999,
        0.3001,
    ),
]


def contact_fit() -> IndentationFit:
    """A contact whose restitution is 1, beside nothing else."""
    result = (ReportedValue("restitution", 1.0, 0.9, 1.1, ""),)
    none = np.zeros(0)
    return IndentationFit(
        "hertz", ViscousContact(1.0), result, (), Indenter(1.0), "force", none, none, none, 0.0,
        0.0, 0.0, 1.0,
    )  # fmt: skip


def differs(part: float) -> Check:
    return indentation.laws_agree(
        contact_fit(), [("hertz-maxwell", (ReportedValue("restitution", 1 + part, 0.9, 1.2, ""),))]
    )


INDENTATION = [
    Case("contact_sampled", indentation.contact_sampled, 20.0, 19.9),
    Case("flights_recorded", lambda x: indentation.flights_recorded(x, 1.0), 0.101, 0.099),
    Case("flights_recorded", lambda x: indentation.flights_recorded(1.0, x), 0.101, -0.2),
    Case("sensor_in_range", judge_integer(indentation.sensor_in_range), 0, 1),
    Case("first_contact", lambda x: indentation.first_contact(int(x), 2), 0, 1),
    Case("law_residual_small", lambda x: indentation.law_residual_small(x, 0.01), 1.49, 1.51),
    Case("law_residual_small", lambda x: indentation.law_residual_small(2.0, x), 0.0019, 0.0021),
    Case(
        "no_adhesion_on_release",
        lambda x: indentation.no_adhesion_on_release(x, 0.0),
        -0.0199,
        -0.0201,
    ),
    Case(
        "no_adhesion_on_release",
        lambda x: indentation.no_adhesion_on_release(x, 0.01),
        -0.0299,
        -0.0301,
    ),
    Case(
        "parameters_determined", lambda x: indentation.parameters_determined("k", x), 1.249, 1.251
    ),
    Case("laws_agree", differs, 0.0499, 0.0501),
    Case("velocity_agrees", lambda x: indentation.velocity_agrees(x, 1.0), 1.039, 1.041),
    Case("velocity_agrees", lambda x: indentation.velocity_agrees(1.0, x), 1.039, 1.041),
    Case("gravity_stated", lambda x: indentation.gravity_stated(x, None), 0.0099, 0.0101),
    Case("force_agrees", indentation.force_agrees, 1.099, 1.101),
    Case("indentation_shallow", lambda x: indentation.indentation_shallow(x, 1.0), 0.299, 0.301),
    Case("sensor_fast_enough", indentation.sensor_fast_enough, 0.0299, 0.0301),
]


def possible(travel: float) -> Check:
    return reading.size_possible("travel", travel, "mm", role="displacement")


def bears(size: float, unit: str) -> Check:
    return reading.stress_of_a_rubber(1e6 * size, unit)


HYPERELASTIC = [
    Case("strain_of_a_rubber", lambda x: hyper_sizes.strain_of_a_rubber(x, "%"), 0.0501, 0.0499),
    Case("law_residual_small", lambda x: hyper.law_residual_small(x, "planar"), 0.0499, 0.0501),
    Case("no_better_law", lambda x: hyper.no_better_law(0.01 * x, 0.01), 1.99, 2.01),
    Case("no_better_law", lambda x: hyper.no_better_law(0.005 * x, 0.0), 1.99, 2.01),
    Case(
        "compressible_law_no_better",
        lambda x: hyper.compressible_law_no_better(0.01 * x, 0.01),
        1.29,
        1.31,
    ),
    Case("stable_in_use", lambda x: hyper.stable_in_use(x, "", ()), 1e-6, 0.0),
    *(
        Case(
            "lateral_swelling_agrees",
            lambda x, foam=foam: hyper.lateral_swelling_agrees(0.3, 0.3 + x, foam=foam),
            *ends,
        )
        for foam, ends in ((True, (0.0499, 0.0501)), (False, (-0.0499, -0.0501)))
    ),
    Case(
        "unmeasured_modes_determined",
        lambda x: hyper.unmeasured_modes_determined(x, "planar", "it is"),
        0.0999,
        0.1001,
    ),
    Case(
        "modes_enough",
        judge_integer(lambda n: hyper.modes_enough(n, has_two_modes=False, foam=False)),
        2,
        1,
    ),
    Case("modes_in_scale", lambda x: hyper.modes_in_scale(x, 0.05, "planar"), 1.099, 1.101),
    Case("use_range_measured", hyper.use_range_measured, 1.0, 1.001),
    Case("constants_determined", lambda x: hyper.constants_determined("C01", x), 0.249, 0.251),
    Case("rows_enough", lambda x: hyper.rows_enough(int(2 * x), 2), 4.0, 3.5),
    Case("files_agree", hyper.files_agree, 0.0499, 0.0501),
    Case(
        "loading_reversible", lambda x: hyper.loading_reversible(x, is_removed=True), 0.0999, 0.1001
    ),
    Case(
        "loading_reversible",
        lambda x: hyper.loading_reversible(x, is_removed=False),
        0.0999,
        0.1001,
    ),
    Case("specimen_conditioned", hyper.specimen_conditioned, 0.0499, 0.0501),
    Case("specimen_conditioned", hyper.specimen_conditioned, -0.0499, -0.0501),
    Case(
        "zero_stress_at_zero_strain",
        lambda x: hyper.zero_stress_at_zero_strain(x, "planar"),
        0.0049,
        0.0051,
    ),
    Case("labels_agree", lambda x: hyper.labels_agree(x, "planar", 0.03), 2.99, 3.01),
    Case("measures_stated", hyper.measures_stated, 0.0999, 0.1001),
    Case(
        "strain_measured_on_specimen",
        lambda x: hyper.strain_measured_on_specimen(("uniaxial",) * x),
        0,
        1,
    ),
    Case(
        "bulk_modulus_determined", lambda x: hyper.bulk_modulus_determined(is_known=bool(x)), 1, 0
    ),
]

LEVEL = [
    Case(
        "softening_detectable",
        lambda x: level.softening_detectable(trend(stiffness_found=x)),
        0.0099,
        0.0101,
    ),
    Case("loops_not_clipped", lambda x: level.loops_not_clipped(x, "force"), 0.099, 0.101),
    Case(
        "amplitude_dependence_detected",
        lambda x: level.amplitude_dependence_detected(x, (1e-4, 1e-3), "m", "friction"),
        20.1,
        19.9,
    ),
    Case("spring_cubic", level.spring_cubic, 19.9, 20.1),
    Case("no_hidden_cubic_spring", level.no_hidden_cubic_spring, 0.099, 0.101),
    Case("amplitudes_spread", lambda x: level.amplitudes_spread(x, "m"), 3.01, 2.99),
    Case("softening_seen", level.softening_seen, 2.01, 1.99),
    Case("law_residual_small", level.law_residual_small, 0.0299, 0.0301),
    Case("up_and_down_sweeps_agree", lambda x: level.up_and_down_sweeps_agree(-x), 0.0299, 0.0301),
    Case("loss_residual_small", level.loss_residual_small, 0.119, 0.121),
    Case(
        "levels_residual_small", lambda x: level.levels_residual_small(x * 0.01, 0.01), 1.39, 1.41
    ),
    Case("levels_as_stated", lambda x: level.levels_as_stated([2.0, x], [2.0, 1.0]), 1.99, 2.01),
    Case("levels_as_stated", lambda x: level.levels_as_stated([2.0, x], [2.0, 1.0]), 0.51, 0.49),
    Case("levels_controlled", lambda x: level.levels_controlled(["low.csv"] * int(x)), 0, 1),
    Case(
        "amplitude_in_tested_range",
        lambda x: level.amplitude_in_tested_range(2e-3 * x, (1e-3, 2e-3), location="1 N"),
        0.999,
        1.001,
    ),
    Case(
        "amplitude_in_tested_range",
        lambda x: level.amplitude_in_tested_range(1e-3 / x, (1e-3, 2e-3), location="1 N"),
        0.999,
        1.001,
    ),
]

CLD = [
    Case("zero_recorded", lambda x: cld.zero_recorded(x, comes_through_air=False), 0.0499, 0.0501),
    Case(
        "specimen_conditioned",
        lambda x: cld.specimen_conditioned(x, cycle=3, softening=0.1),
        0.0199,
        0.0201,
    ),
    Case(
        "specimen_conditioned",
        lambda x: cld.specimen_conditioned(-x, cycle=3, softening=0.1),
        0.0199,
        0.0201,
    ),
    Case(
        "specimen_conditioned",
        lambda x: cld.specimen_conditioned(0.0 if x else None, cycle=1, softening=0.0),
        1,
        0,
    ),
    Case("depth_conditioned", lambda x: cld.depth_conditioned(x, 2), 1.019, 1.021),
    Case("compressions_reached", lambda x: cld.compressions_reached(x, 1.0), 0.999, 1.001),
    Case("load_cell_steady", cld.load_cell_steady, 0.0199, 0.0201),
    Case("load_cell_steady", lambda x: cld.load_cell_steady(-x), 0.0199, 0.0201),
    Case("plate_speed_constant", cld.plate_speed_constant, 0.0199, 0.0201),
    Case("no_adhesion_on_release", cld.no_adhesion_on_release, 0.0099, 0.0101),
    Case("no_energy_gained", cld.no_energy_gained, -0.0199, -0.0201),
    Case("unloading_recorded", lambda x: cld.unloading_recorded(is_recorded=bool(x)), 1, 0),
    Case("length_stated", lambda x: cld.length_stated(is_given=bool(x)), 1, 0),
    Case(
        "relaxation_explains_hysteresis",
        lambda x: cld.relaxation_explains_hysteresis(0.2, x),
        0.0299,
        0.0301,
    ),
    Case(
        "relaxation_explains_hysteresis",
        lambda x: cld.relaxation_explains_hysteresis(0.2, -x),
        0.0299,
        0.0301,
    ),
    Case(
        "stroke_within_relaxation_times",
        lambda x: cld.stroke_within_relaxation_times(x * 5 / np.pi, (0.1, 1.0)),
        1.0,
        1.01,
    ),
    Case(
        "stroke_within_relaxation_times",
        lambda x: cld.stroke_within_relaxation_times(0.5 / np.pi / x, (0.1, 1.0)),
        1.0,
        1.01,
    ),
    Case("relaxed_agrees", lambda x: cld.relaxed_agrees(x, 8e-3, 200.0), 0.0499, 0.0501),
    Case("speeds_spread", cld.speeds_spread, 10.01, 9.99),
    Case(
        "speeds_residual_small",
        lambda x: cld.speeds_residual_small(x * 5e-3, 5e-3, 2.0),
        1.99,
        2.01,
    ),
    Case(
        "slowest_stroke_quasi_static",
        lambda x: cld.slowest_stroke_quasi_static(x * 80.0, 80.0),
        0.999,
        1.001,
    ),
    Case("relaxation_times_determined", cld.relaxation_times_determined, 0.499, 0.501),
    Case("single_relaxation_explains_speeds", cld.single_relaxation_explains_speeds, 9.9, 10.1),
    Case("relaxation_tests_agree", cld.relaxation_tests_agree, 0.0499, 0.0501),
    Case("relaxed_agrees", lambda x: cld.relaxed_agrees(-x, 8e-3, 200.0), 0.0499, 0.0501),
    Case("specimens_tested_alike", lambda x: cld.specimens_tested_alike(["speed"] * int(x)), 0, 1),
    Case(
        "specimens_capable",
        lambda x: cld.specimens_capable(capability(np.array([-1.0, 0.0, 1.0]), -9.0, 3 * x), "N"),
        1.331,
        1.329,
    ),
]

LOTS = [
    Case("files_fitted", lambda x: lots.files_fitted(int(x), 9), 0, 1),
    Case("few_fits_doubted", lambda x: lots.few_fits_doubted(round(100 * x), 100), 0.5, 0.51),
    Case("fits_usable", lambda x: lots.fits_usable(int(x), 9), 0, 1),
    Case("scatter_normal", lambda x: lots.scatter_normal("seal", x), 0.251, 0.249),
    Case("hammers_compared", lambda x: lots.hammers_compared(int(x), 9), 0, 1),
    Case("tests_alike", lambda x: lots.tests_alike(int(x), 9), 0, 1),
    Case("records_distinct", lambda x: lots.records_distinct(int(x), 9), 0, 1),
    Case("gauge_discriminates", lambda x: lots.gauge_discriminates(gauge_of(x)), 0.2999, 0.3001),
    Case("charts_in_control", lambda x: lots.charts_in_control([("seals", 1, int(x), 25)]), 2, 3),
    Case(
        "seals_within_limits",
        lambda x: lots.seals_within_limits("k", "at most 1", ["pass"] + ["fail"] * int(x)),
        0,
        1,
    ),
    Case(
        "capability_requirement_met",
        lambda x: lots.capability_requirement_met(
            "k", ("A", capability(np.array([-1.0, 0.0, 1.0]), None, 3 * x)), 0, 1.33
        ),
        1.33,
        1.3299,
    ),
    Case("no_lot_outlier", lambda x: lots.no_lot_outlier(int(x), 9), 0, 1),
    Case("lots_tested_alike", lambda x: lots.lots_tested_alike(["hold"] * int(x)), 0, 1),
    Case("seals_named", lambda x: lots.seals_named(int(x), 9), 0, 1),
    Case("frequencies_in_band", lambda x: lots.frequencies_in_band([12.7] * int(x), int(x)), 0, 1),
]

WORKFLOW = [
    Case(
        "base_band_in_valid_band",
        lambda x: workflow.base_band_in_valid_band((0.1, 20 * x), 12.0, (1.0, 20.0)),
        0.999,
        1.001,
    ),
    Case(
        "base_band_in_valid_band",
        # below a quarter of the peak nothing need be known
        lambda x: workflow.base_band_in_valid_band((0.1, 10.0), 4 / x, (1.0, 20.0)),
        0.999,
        1.001,
    ),
    Case(
        "prediction_in_valid_band",
        lambda x: workflow.prediction_in_valid_band(2 * x, (1.0, 2.0)),
        0.999,
        1.001,
    ),
    Case(
        "prediction_in_valid_band",
        lambda x: workflow.prediction_in_valid_band(1 / x, (1.0, 2.0)),
        0.999,
        1.001,
    ),
    Case(
        "families_predict_alike",
        lambda x: workflow.families_predict_alike(MODE, Mode(10.0, x * 0.05, 1j)),
        1.0999,
        1.1001,
    ),
    Case(
        "families_predict_alike",
        lambda x: workflow.families_predict_alike(MODE, Mode(x, 0.05, 1j)),
        10.099,
        10.101,
    ),
    Case("hold_fit_possible", lambda _: workflow.hold_fit_possible("two ramps"), None, 0),
    Case("seals_counted", lambda _: workflow.seals_counted(1.0), None, 0),
    Case(
        "measurement_independent_of_fit",
        lambda x: workflow.measurement_independent_of_fit(int(x)),
        0,
        1,
    ),
]
PROJECTS = [
    Case("history_present", verification_checks.history_present, 1, 0),
    Case(
        "history_complete",
        lambda x: verification_checks.history_complete(1, has_incomplete_line=bool(x)),
        0,
        1,
    ),
    Case(
        "history_whole",
        lambda x: verification_checks.history_whole(
            1, 1, is_truncated=False, has_matching_head=not x
        ),
        0,
        1,
    ),
    Case(
        "history_expected",
        lambda x: verification_checks.history_expected("0" * 64, None if x else 0, 1),
        0,
        1,
    ),
    Case("inputs_listed", lambda _: verification_checks.inputs_listed(["raw.csv"], 1), None, 0),
    Case("files_listed", lambda x: verification_checks.files_listed(["raw.csv"] * int(x)), 0, 1),
    Case(
        "nothing_half_written",
        lambda x: verification_checks.nothing_half_written(["a"] * int(x)),
        0,
        1,
    ),
    Case(
        "page_redrawn",
        lambda x: verification_checks.page_redrawn(1, is_same_page=not x, is_same=True),
        0,
        1,
    ),
    Case(
        "history_unchanged",
        lambda x: verification_checks.history_unchanged(1, is_unchanged=bool(x)),
        1,
        0,
    ),
    Case("file_present", lambda _: verification_checks.file_present("raw.csv", 1), None, 0),
    Case(
        "file_unchanged",
        lambda x: verification_checks.file_unchanged("raw.csv", 1, is_same=bool(x)),
        1,
        0,
    ),
    Case(
        "earlier_result_reproduced",
        lambda x: verification_checks.earlier_result_reproduced(x, "k", 1, "0.1"),
        0.99e-6,
        1.01e-6,
    ),
    Case(
        "uncertainty_unrevised",
        lambda x: verification_checks.uncertainty_unrevised(
            {"dof": "a reason"} if x else {}, 1, "0"
        ),
        0,
        1,
    ),
    Case(
        "result_recomputed",
        lambda x: verification_checks.result_recomputed(x, "k", 1),
        0.99e-6,
        1.01e-6,
    ),
]

READING = [
    Case("travel_of_a_seal", lambda x: reading.travel_of_a_seal(x, "m"), 0.199, 0.201),
    Case(
        "travel_of_a_bench",
        lambda x: reading.travel_of_a_bench(x, "mm", force=1.0),
        2.01e-5,
        1.99e-5,
    ),
    Case(
        "force_of_a_bench", lambda x: reading.force_of_a_bench(x, "N", travel=5e-4), 0.0101, 0.0099
    ),
    Case(
        "stiffness_of_a_seal",
        lambda x: reading.stiffness_of_a_seal(8e-3 * x, "mN", travel=8e-3, travel_unit="mm"),
        10.01,
        9.99,
    ),
    Case("ramp_not_slow", lambda x: reading.ramp_not_slow(x, "s"), 199, 201),
    Case("size_possible", lambda x: possible(0.5 * x), 0.999, 1.001),
    Case(
        "clock_unit_constant", lambda x: reading.clock_unit_constant(1e-3, x, 9.0, "s"), 2.01, 1.99
    ),
    Case(
        "clock_unit_constant", lambda x: reading.clock_unit_constant(x, 1e-3, 9.0, "s"), 2.01, 1.99
    ),
    Case("size_possible", lambda x: possible(1e-9 / x), 0.999, 1.001),
    Case("ramp_not_fast", lambda x: reading.ramp_not_fast(x, "s"), 0.299, 0.301),
    Case("hammer_not_heavy", lambda x: reading.hammer_not_heavy(x, "kN"), 999, 1001),
    Case(
        "impact_force_measurable",
        lambda x: reading.impact_force_measurable(x, "mN"),
        0.0501,
        0.0499,
    ),
    Case("shock_not_large", lambda x: size_checks.shock_not_large(x, "g"), 9.99e5, 1.01e6),
    Case("indenter_not_fast", lambda x: size_checks.indenter_not_fast(x, "m/s"), 99.9, 100.1),
    Case("stress_of_a_rubber", lambda x: bears(x, "Pa"), 1.01e-4, 0.99e-4),
    Case("stress_of_a_rubber", lambda x: bears(x, "GPa"), 9999, 10001),
    Case("contact_rate", lambda x: size_checks.contact_rate(x, "s"), 501, 499),
    Case(
        "acceleration_not_large", lambda x: reading.acceleration_not_large(x, "g"), 9.99e3, 1.01e4
    ),
    Case("hammer_sampled", lambda x: reading.hammer_sampled(x, "s"), 50.1, 49.9),
    Case(
        "hammer_not_oversampled", lambda x: reading.hammer_not_oversampled(x, "ms"), 2.49e5, 2.51e5
    ),
    Case("force_of_a_seal", lambda x: reading.force_of_a_seal(x, "kN"), 999, 1001),
    Case("time_of_a_test", lambda x: reading.time_of_a_test(x, "ms"), 0.1001, 0.0999),
]

EXPORT = [
    Case("rows_in_valid_band", lambda x: export.rows_in_valid_band(x, 69, 1.0, 100.0), 0, 1),
    Case("nominal_in_valid_band", lambda x: export.nominal_in_valid_band(x, 12.0), 0, 1),
]

CARDS = [
    Case("test_behind_model", lambda x: cards.test_behind_model("PBUSH" * x), 0, 1),
    Case("arms_testable", lambda x: cards.arms_testable(x, 3, ""), 0, 1),
    Case("table_followed", cards.table_followed, 0.0099, 0.0101),
]
MOUNTS = [
    Case("output_blocked", lambda x: mounts.output_blocked(x, valid_from=6.0), 20.01, 19.99),
    Case("errors_not_magnified", mounts.errors_not_magnified, 1.99, 2.01),
    Case("flange_inertia_negligible", mounts.flange_inertia_negligible, 0.0599, 0.0601),
    Case("blocking_mass_rigid", lambda x: mounts.blocking_mass_rigid(500 * x, 500.0), 0.99, 1.01),
    Case("third_octaves_resolved", lambda n: mounts.third_octaves_resolved(n, centre=10.0), 5, 4),
    Case("level_determined", lambda x: mounts.level_determined(x, centre=10.0), 1.49, 1.51),
    Case("mount_dissipates", lambda x: mounts.mount_dissipates(x, centre=10.0), 0.001, -0.001),
    Case(
        "mount_acts_as_spring",
        lambda x: mounts.mount_acts_as_spring(x, frequency=80.0), 0.001, -0.001,
    ),
    Case("line_noise_stated", mounts.line_noise_stated, None, 0.01),
    Case(
        "third_octaves_in_valid_band",
        lambda x: mounts.third_octaves_in_valid_band((1.0, 10 * x), (0.5, 10.0), has_record=False),
        0.99, 1.01,
    ),
]  # fmt: skip


def departure(pair: str, chance: float) -> PairTest:
    """A departure of 3 %, at most 5 %, in a pair of variables."""
    return PairTest(pair, True, chance, 0.03, 0.05, 0.01, 0.02)


PRELOAD_MAPS = [
    Case(
        "compression_and_frequency_separable",
        lambda x: maps.compression_and_frequency_separable(
            departure("compression and frequency", x)
        ),
        0.0101, 0.0099,
    ),
    Case(
        "amplitude_and_frequency_separable",
        lambda x: maps.amplitude_and_frequency_separable(departure("amplitude and frequency", x)),
        0.0101, 0.0099,
    ),
    Case(
        "compression_and_amplitude_separable",
        lambda x: maps.compression_and_amplitude_separable(
            departure("compression and amplitude", x)
        ),
        0.0101, 0.0099,
    ),
    Case(
        "every_pair_tested",
        judge_integer(lambda n: maps.every_pair_tested(["compression and amplitude"][:n])), 0, 1,
    ),
    Case("departure_excluded", lambda x: maps.departure_excluded(0.05 * x, 0.0), 0.99, 1.01),
    Case("departure_excluded", lambda x: maps.departure_excluded(0.0, 0.02 * x), 0.99, 1.01),
    Case("sweeps_followed", lambda x: maps.sweeps_followed(x, sweep_text="8 mm"), 0.099, 0.101),
    Case("levels_enough", judge_integer(lambda n: maps.levels_enough(n, axis="compression")), 3, 2),
    Case("levels_dense", lambda x: maps.levels_dense(x, axis="compression"), 0.049, 0.051),
    Case(
        "solid_follows_master_curve",
        lambda x: maps.solid_follows_master_curve(x, misfit=0.01), 1.99, 2.01,
    ),
    Case("part_dissipates", lambda x: maps.part_dissipates(x, frequency=10.0), 0.001, -0.001),
    Case("stiffness_determined", maps.stiffness_determined, 0.099, 0.101),
    Case(
        "loss_factor_determined",
        lambda x: maps.loss_factor_determined(x, loss_factor=0.1), 0.49, 0.51,
    ),
    Case(
        "repeatability_determined",
        lambda x: maps.repeatability_determined(int(x), is_stated=False), 2, 0,
    ),
]  # fmt: skip
DRAWS = [
    Case(
        "unresolved_arm_drawn",
        lambda x: draws.unresolved_arm_drawn(x, 12.5, has_record=False), 0, 1,
    ),
]  # fmt: skip

RECORDS = [
    Case(
        "numbers_unambiguous",
        judge_integer(lambda n: records.numbers_unambiguous(("a gain of 10 is stated",)[:n])),
        0,
        1,
    ),
    Case("temperature_tested", lambda x: records.temperature_tested(TESTED, 300 + x), 0, 0.01),
    Case("temperature_tested", lambda x: records.temperature_tested(TESTED, 270 - x), 0, 0.01),
]
STAGES = {
    "export": EXPORT,
    "extensions/solver_inputs/cards": CARDS,
    "extensions/solver_inputs/draws": DRAWS,
    "extensions/transfer_stiffness": MOUNTS,
    "extensions/preload_map": PRELOAD_MAPS,
    "datamodel": RECORDS,
    "reading/readers": READING,
    "preprocessing": PREPARATION,
    "extensions/blank_tests": BLANK_TESTS,
    "extensions/materials/cld": CLD,
    "fitting": FITTING,
    "extensions/curves": CURVES,
    "extensions/curves/creep": CREEP,
    "extensions/curves/superposition": SUPERPOSITION,
    "fitting/identification": IDENTIFICATION,
    "fitting/nonlinear_ramp": RAMP,
    "fitting/fractional_model": FRACTIONAL,
    "extensions/curves/temperatures": TEMPERATURE,
    "extensions/materials/hyperelastic": HYPERELASTIC,
    "extensions/materials/indentation": INDENTATION,
    "extensions/amplitude": LEVEL,
    "extensions/materials/csr": CSR,
    "extensions/materials/rod": ROD,
    "extensions/dynamic_stiffness": DYNAMIC_STIFFNESS,
    "extensions/materials/drop": DROP,
    "extensions/batch": LOTS,
    "planning": PLANNING,
    "vibration": VIBRATION,
    "extensions/systems/door": SEALS,
    "vibration/comparison": COMPARISON,
    "vibration/impact": IMPACT,
    "extensions/modes": MODAL,
    "extensions/projects": PROJECTS,
    "workflow": WORKFLOW,
}
#: what each value that the cases give is held against, where the criterion itself sets the limit
LIMITS = {
    "export": {"rows_in_valid_band": 0, "nominal_in_valid_band": 0},
    "extensions/solver_inputs/cards": {"arms_testable": 0, "table_followed": 0.01},
    "extensions/solver_inputs/draws": {"unresolved_arm_drawn": 0},
    "reading/readers": {
        "travel_of_a_seal": 0.2, "force_of_a_seal": 1000, "stiffness_of_a_seal": 10.0,
        "time_of_a_test": 0.1,
        "travel_of_a_bench": 2e-5, "force_of_a_bench": 0.01, "ramp_not_slow": 200,
        "ramp_not_fast": 0.3, "size_possible": 1, "hammer_not_heavy": 1000,
        "impact_force_measurable": 0.05,
        "shock_not_large": 1e6, "indenter_not_fast": 100, "contact_rate": 500,
        "clock_unit_constant": 2,
        "stress_of_a_rubber": 1e4,
        "acceleration_not_large": 1e4, "hammer_sampled": 50, "hammer_not_oversampled": 2.5e5,
    },
    "preprocessing": {
        "baseline_recorded": 5, "contact_detected": 0.01, "preload_absent": 0.05,
        "single_loading": 1, "ramp_recorded": 1.1,
        "history_explained": 0.03, "face_recovered": 0.01, "earlier_loading_negligible": 0.005,
        "overshoot_small": 0.05, "samples_unbroken": 0.2, "spikes_absent": 0,
        "readings_not_repeated": 0.005,
        "clock_steady": 0.25,
        "temperature_as_stated": 1, "temperature_held": 1,
        "machine_deflection_small": 0.025,
        "columns_plausible": 0.03, "motion_resolved": 0.125, "motion_measured": 0,
        "load_cell_range_used": 0.05, "force_not_clipped": 5, "force_resolved": 20,
        "depth_resolved": 0.0025, "hold_is_still": 0.01, "hold_outlasts_ramp": 10,
        "ramp_sampled": 10, "strain_small": 0.2,
    },
    "extensions/blank_tests": {
        "blank_tests_complete": 3.0,
        "stop_rigid": 200e-6,
        "stop_force_straight": 0.03,
        "stop_force_returns": 0.02,
        "stop_follows_machine": 0.005,
        "crosshead_creep_plausible": 30e-6,
        "spring_force_straight": 0.005,
        "spring_force_returns": 0.003,
        "spring_follows_machine": 0.002,
        "stop_and_spring_creep_agree": 3.0,
        "stop_and_spring_delay_agree": 3.0,
        "repeated_stops_agree": 0.1,
        "repeated_springs_agree": 0.01,
        "delay_determined": 0.5e-3,
        "gain_plausible": 1.035,
        "empty_run_force_free_of_motion": 5.0,
        "empty_run_plate_steady": 0.15,
        "empty_run_force_steady": 0.2,
    },
    "extensions/materials/cld": {
        "zero_recorded": 0.05, "specimen_conditioned": 0.02, "depth_conditioned": 1.02,
        "compressions_reached": 1, "load_cell_steady": 0.02, "plate_speed_constant": 0.02,
        "no_energy_gained": -0.02, "no_adhesion_on_release": 0.01,
        "relaxation_explains_hysteresis": 0.03, "stroke_within_relaxation_times": 1,
        "relaxed_agrees": 0.05,
        "relaxation_tests_agree": 0.05, "single_relaxation_explains_speeds": 10,
        "speeds_spread": 10, "speeds_residual_small": 2, "slowest_stroke_quasi_static": 1,
        "relaxation_times_determined": 0.5,
        "specimens_tested_alike": 0, "specimens_capable": 1.33,
    },
    "fitting": {
        "same_specimen": 3,
        "hold_long_enough": 0.03,
        "arms_distinct": 1.5,
        "arms_supported": 3,
        "residuals_white": 20,
        "fast_arm_visible": 0.1,
        "drift_distinguished_from_arm": 0.1,
        "residuals_steady": 4,
        "hold_and_full_agree": 0.1,
        "filter_bias": 0.01,
        "depth_and_time_separable": 0.01,
        "loss_factor_determined": 0.3,
        "samples_independent": 5,
        "k_end_determined": 0.5,
        "force_residual_small": 1.75,
        "arms_where_force_relaxes": 0.02,
    },
    "extensions/curves": {
        "few_arms_sufficient": 0.05,
        "kramers_kronig": 0.05,
        "loss_positive": 0,
        "storage_rises": 0.05,
        "instrument_stiff": 0.01,
        "plateau_determined": 0.8,
        "curve_level_at_end": 0.03,
        "modulus_falls": 1.25,
        "strain_not_small": 0.005, "strain_not_large": 3, "modulus_of_a_rubber": 300,
        "data_agree": 1.3,
        "bands_overlap": 10,
    },
    "extensions/curves/creep": {
        "load_begins_at_rest": 5, "load_held": 0.02, "displacement_samples_not_repeated": 0.005,
        "compliance_rises": 0.8,
        "compliance_residual_small": 0.05,
        "creep_finished": 0.05,
        "flow_distinguished": 10,
        "flow_exceeds_slow_retardation": 0.5,
        "displacement_residual_small": 2,
        "drift_distinguished_from_flow": 2,
        "levels_agree": 0.03,
    },
    "extensions/curves/superposition": {
        "isotherms_overlap": 0.5,
        "shifts_determined": 0.3,
        "shift_monotone": 3,
        "thermorheologically_simple": 1.2,
        "law_follows_shifts": 0.15,
        "vertical_shift_determined": 10,
        "no_temperature_outlier": 0.05,
        "glass_below_tests": 0,
        "vertical_rule_holds": 0.03,
    },
    "fitting/nonlinear_ramp": {
        "ramp_residual_small": 0.01, "ramp_explained": 1.2, "tangent_determined": 2,
        "hold_residual_small": 1.25,
        "k_inf_plausible": 0.05,
        "offset_plausible": 3, "drift_plausible": 3, "baseline_agrees": 1, "clocks_agree": 3,
    },
    "fitting/fractional_model": {
        "fractional_slope_determined": 0.05, "fractional_model_suffices": 1.02,
        "model_families_distinguished": 100,
    },
    "extensions/curves/temperatures": {
        "thermorheologically_simple": 0.0027, "vertical_shift_plausible": 0.15,
        "temperature_steady": 1, "shifts_distinguished": 3,
        "shifts_independent_of_vertical_rule": 0.1,
    },
    "fitting/identification": {
        "lines_explained": 2, "hammer_agrees_with_relaxation_test": 1.3, "mass_plausible": 2.5,
        "gain_plausible": 2.5, "delay_plausible": 2.5, "stiffness_plausible": 2.5,
        "hammer_agrees_with_earlier_fit": 2.5, "dashpot_not_missed": 50, "arms_identified": 0.5,
        "cables_described": 0.3,
    },
    "extensions/materials/hyperelastic": {
        "strain_of_a_rubber": 0.05,
        "law_residual_small": 0.05, "no_better_law": 2, "compressible_law_no_better": 1.3,
        "stable_in_use": 0,
        "unmeasured_modes_determined": 0.1, "use_range_measured": 1,
        "constants_determined": 0.25, "rows_enough": 4,
        "files_agree": 0.05, "loading_reversible": 0.1, "specimen_conditioned": 0.05,
        "zero_stress_at_zero_strain": 0.005,
        "labels_agree": 3, "lateral_swelling_agrees": 0.05,
        "measures_stated": 0.1, "modes_enough": 2, "modes_in_scale": 1.1,
        "strain_measured_on_specimen": 0,
    },
    "extensions/materials/indentation": {
        "contact_sampled": 20, "flights_recorded": 0.1, "sensor_in_range": 0, "first_contact": 0,
        "law_residual_small": 1.5, "no_adhesion_on_release": -0.02,
        "parameters_determined": 1.25, "laws_agree": 0.05,
        "velocity_agrees": 1.04, "gravity_stated": 0.01, "force_agrees": 1.1,
        "indentation_shallow": 0.3, "sensor_fast_enough": 0.03,
    },
    "extensions/materials/csr": {
        "force_falls": 3, "f0_read": 2, "readings_residuals_random": 3,
        "readings_residual_small": 0.04,
        "chemical_aging_resolved": 4, "ovens_enough": 3, "activation_energy_plausible": 3,
        "aging_prediction_determined": 1,
        "single_activation_energy_explains_ovens": 9, "aging_exceeds_cell_drift": 1,
        "load_cell_zero_stable": 3,
        "temperature_near_ovens": 30, "robust_to_lower_activation_energy": 2,
        "time_near_readings": 2, "stiffness_follows_force": 0.1, "end_point_reached": 1,
        "life_sd_within_target": 1,
    },
    "extensions/dynamic_stiffness": {
        "frequencies_in_valid_band": 1, "loss_factor_determined_at": 0.3,
    },
    "extensions/materials/drop": {
        "impact_within_measured_depth": 1, "impact_in_valid_band": 1, "air_escapes": 0.1,
        "loss_determined": 0.25,
        "impacts_residual_small": 1.5, "impact_residual_structureless": 2.5, "impacts_sampled": 50,
        "impact_speeds_spread": 2,
        "impact_speeds_agree": 3, "impacts_separated": 10, "impact_mass_agrees": 0.03,
        "arms_agree_with_relaxation_test": 3,
        "spectrum_has_gaps": 4, "loss_factors_agree": 3,
    },
    "extensions/materials/rod": {
        "modulus_determined_near_resonance": 8, "waves_plane": 0.05, "sensors_agree": 3,
        "mass_ratio_suitable": 100,
        "single_solid_explains_lines": 1.5,
    },
    "extensions/amplitude": {
        "softening_detectable": 0.01,
        "loops_not_clipped": 0.1,
        "amplitude_dependence_detected": 20, "amplitudes_spread": 3, "softening_seen": 2,
        "law_residual_small": 0.03,
        "levels_residual_small": 1.4, "loss_residual_small": 0.12, "no_hidden_cubic_spring": 0.1,
        "spring_cubic": 20, "up_and_down_sweeps_agree": 0.03,
        "levels_as_stated": 2, "levels_controlled": 0, "amplitude_in_tested_range": 1,
    },
    "extensions/batch": {"files_fitted": 0, "fits_usable": 0, "few_fits_doubted": 0.5,
        "hammers_compared": 0,
             "tests_alike": 0, "records_distinct": 0, "seals_within_limits": 0,
             "gauge_discriminates": 0.3,
             "no_lot_outlier": 0, "frequencies_in_band": 0, "lots_tested_alike": 0,
             "seals_named": 0, "scatter_normal": 0.25},
    "planning": {"tip_excites": -10},
    "extensions/systems/door": {
        "door_modes_in_valid_band": 1, "seal_touches": 0, "stations_suffice": 1e-3,
        "modes_suffice": 5e-3, "mode_shapes_cover_points": 0.03, "masses_agree": 1.05,
        "door_supported": 0,
        "closing_in_valid_band": 1.0, "lateral_restraint_present": 0,
        "shear_stiffness_plausible": 1.5, "leak_speed_determined": 0.2,
        "seals_suffice": 10, "scatter_exceeds_testing": 1,
    },
    "extensions/preload_map": {
        "compression_and_frequency_separable": 0.01, "amplitude_and_frequency_separable": 0.01,
        "compression_and_amplitude_separable": 0.01, "every_pair_tested": 0,
        "departure_excluded": 1.0, "sweeps_followed": 0.1, "levels_enough": 3,
        "levels_dense": 0.05, "solid_follows_master_curve": 2.0, "part_dissipates": 0.0,
        "stiffness_determined": 0.1, "loss_factor_determined": 0.5,
    },
    "extensions/transfer_stiffness": {
        "output_blocked": 20.0, "errors_not_magnified": 2.0, "flange_inertia_negligible": 0.06,
        "blocking_mass_rigid": 1.0, "third_octaves_resolved": 5, "level_determined": 1.5,
        "mount_dissipates": 0.0, "mount_acts_as_spring": 0.0, "third_octaves_in_valid_band": 1.0,
    },
    "datamodel": {"numbers_unambiguous": 0, "temperature_tested": 0},
    "vibration": {
        "seal_mass_negligible": 0.02, "mass_of_a_block": 1e-3, "compression_tested": 1,
    },
    "vibration/comparison": {
        "stiffness_agrees": 0.05, "peak_agrees": 3, "damping_agrees": 1.25,
        "lines_resolve_the_peak": 1.5, "inside_valid_band": 1,
    },
    "vibration/impact": {
        "hits_enough": 3, "coherence": 0.9, "lines_in_half_power_band": 1.5,
        "window_decay_determined": 0.1,
        "hammer_excites": -10,
        "frf_dissipates": -0.3, "mass_over_base": 3,
        "hits_agree": 0.1, "amplitude_linear": 1,
        "rocking_cancelled": 0.05, "hits_centred": 0.25,
        "high_frequency_mass_agrees": 0.05,
    },
    "extensions/modes": {
        "segments_resolve": 6, "channels_not_clipped": 1, "modes_within_band": 0,
        "modes_stable": 5, "modes_explain_lines": 4, "points_share_modes": 0.2,
    },
    "extensions/projects": {
        "result_recomputed": 1e-6, "earlier_result_reproduced": 1e-6, "uncertainty_unrevised": 0,
        "history_present": 1,
        "files_listed": 0, "page_redrawn": 0, "history_whole": 0, "nothing_half_written": 0,
    },
    "workflow": {
        "prediction_in_valid_band": 1,
        "base_band_in_valid_band": 1, "measurement_independent_of_fit": 0,
        "families_predict_alike": 1.1,
    },
}  # fmt: skip
#: what a failure means; of every other check, that the result is to be used with care
GRADES = {
    "note": {
        "extensions/systems/door": {"line_closed", "faster_closings_latch"},
        "extensions/transfer_stiffness": {"line_noise_stated"},
        "extensions/preload_map": {"repeatability_determined"},
        "extensions/batch": {"records_distinct", "no_lot_outlier", "scatter_normal"},
        "extensions/blank_tests": {"blank_tests_complete"},
        "extensions/materials/cld": {"unloading_recorded", "length_stated"},
        "preprocessing": {
            "baseline_recorded", "single_loading", "overshoot_small", "load_cell_range_used",
            "hold_outlasts_ramp", "motion_resolved", "preload_absent",
        },
        "fitting": {
            "hold_long_enough", "tau_inside_window", "residuals_white", "ramp_accounted_for",
            "fast_arm_visible", "drift_distinguished_from_arm", "order_agreed",
            "hold_and_full_agree",
        },
        "extensions/curves": {"instrument_stiff"},
        "extensions/curves/creep": {"load_held"},
        "fitting/identification": {"dashpot_not_missed", "cables_described"},
        "extensions/curves/temperatures": {"shifts_distinguished"},
        "extensions/amplitude": {"amplitude_dependence_detected"},
        "extensions/materials/hyperelastic": {"bulk_modulus_determined"},
        "extensions/materials/csr": {"f0_read", "load_cell_zero_stable",
        "aging_exceeds_cell_drift"},
        "extensions/materials/drop": {"air_escapes", "specimen_length_stated"},
        "reading/readers": {
            "travel_of_a_seal", "force_of_a_seal", "ramp_not_slow", "stiffness_of_a_seal",
        },
        "fitting/nonlinear_ramp": {"clocks_agree", "offset_plausible", "drift_plausible"},
        "extensions/projects": {
            "history_complete", "files_listed", "nothing_half_written", "uncertainty_unrevised",
        },
        "workflow": {"hold_fit_possible", "base_band_in_valid_band",
        "measurement_independent_of_fit", "seals_counted"},
    },
    "stop": {
        "extensions/transfer_stiffness": {"mount_dissipates"},
        "extensions/preload_map": {"part_dissipates", "sweeps_followed"},
        "extensions/materials/cld": {"no_energy_gained"},
        "preprocessing": {
            "columns_plausible", "force_not_clipped", "force_resolved", "force_relaxes",
            "ramp_recorded",
        },
        "reading/readers": {
            "time_of_a_test", "travel_of_a_bench", "size_possible",
            "force_of_a_bench", "ramp_not_fast", "hammer_not_heavy",
            "shock_not_large", "indenter_not_fast", "contact_rate",
            "stress_of_a_rubber", "clock_unit_constant",
            "impact_force_measurable", "acceleration_not_large", "hammer_sampled",
            "hammer_not_oversampled",
        },
        "fitting": {
            "optimiser_converged", "arms_where_force_relaxes", "valid_band_exists", "same_specimen",
        },
        "extensions/amplitude": {"loops_not_clipped"},
        "extensions/curves": {
            "modulus_falls", "strain_not_small", "strain_not_large", "modulus_of_a_rubber",
        },
        "extensions/curves/creep": {"compliance_rises"},
        "extensions/materials/hyperelastic": {"stable_in_use", "strain_of_a_rubber"},
        "extensions/materials/csr": {"force_falls"},
        "extensions/materials/drop": {"loss_determined"},
        "fitting/identification": {"tests_agree"},
        "vibration/comparison": {"no_unit_error"},
        "vibration/impact": {
            "resonance", "frf_dissipates", "mass_over_base",
        },
        "extensions/modes": {"channels_not_clipped"},
        "extensions/projects": {
            "history_present", "history_whole", "history_expected", "history_unchanged",
            "file_present", "file_unchanged", "inputs_listed", "result_recomputed",
            "page_redrawn",
        },
    },
}  # fmt: skip


#: how a fit that fails a check ended, by its stage; any other check ends none
ENDS = {
    "preprocessing": {"force_relaxes": Status.FORCE_RISES},
    "fitting": {
        "optimiser_converged": Status.NOT_CONVERGED,
        "tau_inside_window": Status.TAU_AT_BOUND,
        "arms_supported": Status.NOT_IDENTIFIED,
        "k_inf_positive": Status.NOT_IDENTIFIED,
    },
    "extensions/curves": {
        "data_agree": Status.TESTS_DISAGREE,
        "few_arms_sufficient": Status.NOT_IDENTIFIED,
    },
    "fitting/fractional_model": {"fractional_slope_determined": Status.NOT_IDENTIFIED},
    "extensions/curves/temperatures": {"thermorheologically_simple": Status.TESTS_DISAGREE},
    "fitting/identification": {
        "lines_explained": Status.TESTS_DISAGREE,
        "hammer_agrees_with_relaxation_test": Status.TESTS_DISAGREE,
        "tests_agree": Status.TESTS_DISAGREE,
        "mass_plausible": Status.TESTS_DISAGREE,
        "arms_identified": Status.NOT_IDENTIFIED,
    },
    "extensions/materials/cld": {"relaxation_times_determined": Status.NOT_IDENTIFIED},
}
#: the gravest first
GRAVEST_FIRST = (
    Status.NO_DATA, Status.FORCE_RISES, Status.NOT_CONVERGED, Status.FEWER_ARMS,
    Status.TAU_AT_BOUND, Status.TESTS_DISAGREE, Status.NOT_IDENTIFIED, Status.CONVERGED,
)  # fmt: skip


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(case, id=f"{stage}-{case.check}-{case.passes}")
        for stage, cases in STAGES.items()
        for case in cases
    ],
)
def test_every_check_just_passes_and_just_fails_at_its_limit(case: Case) -> None:
    for x, passed in ((case.passes, True), (case.fails, False)):
        if x is None:
            continue
        judge = case.judge(x)
        assert judge.name == case.check
        assert judge.passed is passed, judge
        assert judge.message


def test_ramps_and_holds_share_more_decades_than_sweeps() -> None:
    def judge_overlap(decades: float) -> Check:
        return checks.isotherms_overlap(
            [decades, 2.0], [273.0, 283.0, 296.0], several.MIN_SHARED_DECADES
        )

    assert not judge_overlap(1.501).failed
    assert judge_overlap(1.499).failed


def test_the_value_of_a_check_is_what_its_case_says() -> None:
    """The cases drive the very number that meets the limit: it is given back."""
    for stage, limits in LIMITS.items():
        for name in limits:
            case = next(case for case in STAGES[stage] if case.check == name)
            assert case.passes is not None
            assert case.judge(case.passes).value == pytest.approx(case.passes, rel=1e-3), name


def test_the_limits_are_those_typed_here() -> None:
    for stage, limits in LIMITS.items():
        registered = {
            name: check.limit
            for (where, name), check in REGISTER.items()
            if where == stage and check.limit is not None
        }
        assert registered == limits, "type its limit here"


def test_the_grades_are_those_typed_here() -> None:
    for (stage, name), check in REGISTER.items():
        grades = [grade for grade, stages in GRADES.items() if name in stages.get(stage, ())]
        assert check.grade == (grades or ["limit"])[0], (stage, name)


def test_the_statuses_that_checks_set_are_those_typed_here() -> None:
    """A check that failed ends a fit as its criterion says, one that passed ends none."""
    for stage, cases in STAGES.items():
        for case in cases:
            ends = ENDS.get(stage, {}).get(case.check)
            for x, status in ((case.passes, Status.CONVERGED), (case.fails, ends)):
                if x is not None:
                    assert select_fit_status([case.judge(x)]) is (status or Status.CONVERGED), (
                        case.check
                    )
    typed = {(stage, name) for stage, names in ENDS.items() for name in names}
    assert typed == {at for at, item in REGISTER.items() if item.fit_status is not None}


def test_the_gravest_of_what_went_wrong_is_how_a_fit_ended() -> None:
    optimum, arms = solid.optimiser_converged(stationary=False), solid.arms_supported(arm(), WEAK)
    assert select_fit_status([arms, optimum, arms]) is Status.NOT_CONVERGED
    assert select_fit_status([arms], {Status.FEWER_ARMS: True}) is Status.FEWER_ARMS
    assert select_fit_status([arms], {Status.FEWER_ARMS: False}) is Status.NOT_IDENTIFIED
    assert (
        select_fit_status([solid.arms_supported(arm(), WEAK, arms_selected=True)])
        is Status.NOT_IDENTIFIED
    )
    for i, grave in enumerate(GRAVEST_FIRST):
        assert select_fit_status([], dict.fromkeys(GRAVEST_FIRST[i:], True)) is grave


def test_no_document_and_no_comparison_of_checks_holds_the_status_that_they_set() -> None:
    check = solid.optimiser_converged(stationary=False)
    assert check.fit_status is Status.NOT_CONVERGED
    assert check == replace(check, fit_status=None)
    assert list(check.to_dict()) == [
        "name", "passed", "grade", "value", "limit", "message", "remedy"
    ]  # fmt: skip
    retained = json.loads(to_json(a_fit(arm(), checks=(check,))))["checks"]
    assert retained == [check.to_dict()]


@pytest.mark.parametrize(
    ("at", "limit", "stop"),
    [
        pytest.param(check_k_inf, 0.99, 1.01, id="k_end_determined"),
        pytest.param(check_k_end, 0.99, 1.01, id="k_end"),
        pytest.param(lambda x: preparation.clock_steady(leaping(x)), 4.09, 4.11, id="clock_steady"),
        pytest.param(
            lambda x: seals.mode_shapes_cover_points(x, "latch"),
            0.299,
            0.301,
            id="mode_shapes_cover_points",
        ),
        pytest.param(lambda x: seals.masses_agree(25.0, 25 * x), 1.99, 2.01, id="masses_agree"),
        pytest.param(
            lambda x: relaxation.force_residual_small(NOISY, make_ramp_residual(x)),
            9.9,
            10.1,
            id="force_residual_small",
        ),
        pytest.param(judge_hold_residual, 9.9, 10.1, id="displacement_residual_small"),
        pytest.param(lambda x: curves.data_agree([x], ["loss"], [80]), 2.9, 3.1, id="data_agree"),
        pytest.param(
            lambda x: identification.lines_explained(x, has_absolute_sd=True),
            19.9,
            20.1,
            id="lines",
        ),
        pytest.param(
            lambda x: identification.lines_explained(x, has_absolute_sd=False),
            0.49,
            0.51,
            id="share",
        ),
        pytest.param(
            lambda x: identification.hammer_agrees_with_relaxation_test(1, x),
            3.9,
            4.1,
            id="relaxation",
        ),
        pytest.param(
            lambda x: identification.mass_plausible(x, 1.0), 9.9, 10.1, id="mass_plausible"
        ),
        pytest.param(
            lambda x: comparison.stiffness_agrees(
                make_comparison(predicted_hz=(1 + x) * agreeing().measured_hz)
            ),
            0.199,
            0.201,
            id="stiffness_agrees",
        ),
        pytest.param(
            lambda x: comparison.peak_agrees(
                make_comparison(predicted_peak=10 ** (x / 20) * agreeing().measured_peak)
            ),
            11.9,
            12.1,
            id="peak_agrees",
        ),
        pytest.param(
            lambda x: comparison.damping_agrees(
                make_comparison(predicted_damping=0.01 * 1.25**x, measured_damping=0.01), peak(10)
            ),
            3.9,
            4.1,
            id="damping_agrees",
        ),
        pytest.param(
            lambda x: impact.high_frequency_mass_agrees((x, 0.01), 1.0),
            1.49,
            1.51,
            id="high_frequency_mass_agrees",
        ),
        pytest.param(
            lambda x: impact.high_frequency_mass_agrees((-x, 0.01), 1.0), None, 1.0, id="sign"
        ),
        pytest.param(lambda x: simple(0.0, x), 0.99e-3, 1.01e-3, id="simple"),
        pytest.param(lambda x: level.levels_residual_small(x, 0.01), 0.099, 0.101, id="levels"),
        pytest.param(
            lambda x: hyper.law_residual_small(x, "planar"), 0.199, 0.201, id="hyperelastic"
        ),
        pytest.param(lambda x: indentation.law_residual_small(2.0, x), 0.019, 0.021, id="contact"),
        pytest.param(
            lambda x: indentation.flights_recorded(-x, 1.0), 0.33, 0.34, id="part of a contact"
        ),
    ],
)
def test_a_gross_failure_forbids_the_use(
    at: Callable[[float], Check], limit: float | None, stop: float
) -> None:
    assert limit is None or (at(limit).failed and at(limit).grade == "limit")
    assert at(stop).failed
    assert at(stop).grade == "stop"


def test_what_another_condition_makes_harmless_is_a_note() -> None:
    assert solid.arms_supported(arm(), WEAK).grade == "limit"
    assert solid.arms_supported(arm(), WEAK, arms_selected=True).grade == "note"
    short = replace(RECORD, hold_end=1 + 5.0)
    assert preparation.hold_outlasts_ramp(short).grade == "note"
    assert preparation.hold_outlasts_ramp(replace(RECORD, hold_end=1 + 3.0)).grade == "limit"
    assert ramp.offset_plausible([(8.9, 0.0, 1.0, 9.0)]).grade == "note"
    assert ramp.drift_plausible([(0.0, 0.0, 1.0, 9.0), (9.1, 0.0, 1.0, 9.0)]).grade == "limit"
    other = GeneralizedMaxwell(1.0, (2.0,), (1.0,))
    assert relaxation.hold_and_full_agree(arm(), other, np.zeros(3)).grade == "note"
    other = GeneralizedMaxwell(2.0, (1.0,), (1.0,))
    assert relaxation.hold_and_full_agree(arm(), other, np.zeros(3)).grade == "limit"
    # where the end of the hold is known, it is what both must agree on, to 2 % of it
    for most, grade in ((1.979, "limit"), (1.981, "note")):
        end = EndOfHold(40.0, (0.9, most), (0.0, 9.0), (0.0, 9.0), 0.0)
        assert relaxation.hold_and_full_agree(arm(), other, np.zeros(3), end=end).grade == grade
    for excess, grade in ((0.249, "note"), (0.251, "limit")):
        far = ramp.drift_plausible([(9.1, 0.0, 1.0, 9.0)], excess)
        assert far.failed
        assert far.grade == grade
    # a tangent of 1 + a at the depth: determined by one ramp where it hardly bends
    for bent, grade in ((0.099, "note"), (-0.099, "note"), (0.101, "limit")):
        law = ElasticLaw((0.0, DEPTH), (1 - bent, 1 + bent), 200.0)
        assert ramp.tangent_determined(law, 1).grade == grade
    # as little at the depth, but all of it in a toe, as friction leaves it
    for steep, grade in ((1.2, "note"), (1.3, "limit")):
        last = (1 - 0.05 * (steep + 0.95)) / 0.45 - 0.95
        toe = ElasticLaw((0.0, 0.1 * DEPTH, DEPTH), (steep, 0.95, last), 200.0)
        assert abs(last - 1) < 0.04
        assert ramp.tangent_determined(toe, 1).grade == grade
    slow = wandering(9.0)
    rms = float(np.sqrt(np.mean(slow * slow)))
    for peak, grade in ((rms / 0.00499, "note"), (rms / 0.00501, "limit")):
        assert relaxation.residuals_steady([slow], peak=peak).grade == grade
    loose = GeneralizedMaxwell(1.0)
    at_end = EndOfHold(40.0, (0.9, 1.1), (0.0, 1.1), (0.0, 1.1), 0.0)
    assert relaxation.k_inf_positive(loose, 1.0).grade == "limit"
    assert relaxation.k_inf_positive(loose, 1.0, at_end).grade == "note"
    for in_band, grade in (
        ((0.024, 0.099), "note"),
        ((0.026, 0.099), "limit"),
        ((0.024, 0.101), "limit"),
    ):
        unknown = identification.arms_identified(2, 0.3, unknown=(1.0,), in_band=in_band)
        assert unknown.grade == grade
    for leads, grade in ((1.249, "note"), (1.251, "limit")):
        assert indentation.parameters_determined("g", 2.0, leading_factor=leads).grade == grade
    # a loss that scatters about zero is no breach, and one beyond three deviations is
    lines = np.geomspace(0.1, 30, 32)
    scatter = np.where(np.arange(32) % 2, 0.01, -0.01)
    sd = estimate_robust_scatter(np.arange(32.0), scatter / np.hypot(1, scatter))
    for times, failed in ((2.9, False), (3.1, True)):
        loss = scatter.copy()
        loss[16] = -times * sd
        test = DynamicTest(lines, np.ones(32), loss, units="SI")
        assert curves.loss_positive(test).failed == failed
    # a step is reported from half as much on, and doubts no more than what does not
    for bends in (5, 40):
        assert preparation.motion_resolved(bending(1.99, bends=bends)).grade == "note"
        assert preparation.motion_resolved(bending(2.01, bends=bends)).grade == "limit"


def test_no_registered_check_is_missing_here() -> None:
    for file in SOURCES.rglob("*.py"):
        module = file.relative_to(SOURCES).with_suffix("").parts
        if "checks" in module:
            import_module(".".join(("dashpot", *module)))
    cases = {(stage, case.check) for stage, cases in STAGES.items() for case in cases}
    assert cases == set(REGISTER), "add its case here: just at its limit, and just beyond"


def test_checks_are_constructed_in_the_register_only() -> None:
    built = [
        file.relative_to(SOURCES).as_posix()
        for file in SOURCES.rglob("*.py")
        if re.search(r"\bCheck\(", file.read_text(encoding="utf-8"))
    ]
    # those of a plug-in are its own
    assert sorted(built) == ["base/checks.py", "extensions/plugins/fit.py"]


def test_no_status_is_decided_outside_the_criteria() -> None:
    """A fit ends as its failed checks say: no package reads a status off their names."""
    texts = {
        file.relative_to(SOURCES).as_posix(): file.read_text("utf-8")
        for file in SOURCES.rglob("*.py")
    }
    decide = {name for name, text in texts.items() if "select_fit_status(" in text}
    assert decide == {
        "base/checks.py",
        "fitting/fit_construction.py",
        "extensions/batch/arrays/fit_many.py",
    }
    named = {
        name for name, text in texts.items()
        if re.search(r"\bStatus\.[A-Z]", text) and "checks" not in Path(name).with_suffix("").parts
    }  # fmt: skip
    assert named <= decide | {"datamodel/fit.py", "export/deck_validation.py"}
    by_name = r"\{check\.name|\.name (not )?in \{"
    assert not [name for name in decide | named if re.search(by_name, texts[name])]


def test_every_criterion_says_what_it_asks_and_where_its_limit_comes_from() -> None:
    for (stage, name), requested in REGISTER.items():
        assert requested.question.endswith("."), name
        assert requested.source, name
        assert bool(requested.rule) <= bool(requested.measure), name
        assert any((SOURCES / stage).glob("*checks*"))


def test_the_page_of_every_check_is_the_register() -> None:
    spec = spec_from_file_location("checks_page", ROOT / "docs" / "checks.py")
    assert spec is not None
    assert spec.loader is not None
    written = module_from_spec(spec)
    spec.loader.exec_module(written)
    text = written.PAGE.read_text(encoding="utf-8")
    assert written.page() == text, "run `python docs/checks.py`"


def test_a_slight_disagreement_that_is_explained_is_a_limit_and_any_other_a_stop() -> None:
    assert identification.tests_agree(stiffer(-0.049)).grade == "limit"
    assert identification.tests_agree(stiffer(0.051)).grade == "stop"
    assert identification.tests_agree(stiffer(0.01, explains=False)).grade == "stop"


def test_criterion_refuses_a_duplicate_name() -> None:
    def overshoot_small() -> Finding:
        """Whatever."""
        return Finding("nothing")

    overshoot_small.__module__ = "dashpot.preprocessing.checks"
    with pytest.raises(ValueError, match="two criteria overshoot_small"):
        criterion(source="nowhere")(overshoot_small)


# -- what is not checked, and what is excused ------------------------------------------------------


def test_undecidable_check_neither_passes_nor_fails() -> None:
    spring = GeneralizedMaxwell(1.0)
    unknown = make_comparison(measured_damping=None)
    for check in (
        preparation.contact_detected(Touch(0.0, 1e-3), DEPTH, is_given=True),
        preparation.contact_detected(Touch(0.0, 0.0), DEPTH, is_given=False),
        preparation.overshoot_small(RECORD, ramp_count=2),
        preparation.force_resolved(RECORD.force),
        preparation.strain_small(RECORD),
        relaxation.hold_long_enough(None),
        ramp.clocks_agree([]),
        ramp.ramp_explained(None),
        solid.arms_distinct(arm()),
        solid.loss_factor_determined(None),
        solid.arms_supported(spring, np.zeros(1)),
        relaxation.ramp_accounted_for(spring, [RECORD]),
        relaxation.fast_arm_visible(spring, [RECORD]),
        relaxation.drift_distinguished_from_arm(spring, None, 0.0),
        relaxation.drift_distinguished_from_arm(arm(), None, 9.0),
        relaxation.residuals_steady([np.zeros(799)]),
        relaxation.hold_and_full_agree(arm(), None, np.zeros(3)),
        ramp.clocks_agree([]),
        relaxation.residuals_steady([np.full(1000, 1e-9)], rounding=1e-6),
        relaxation.arms_where_force_relaxes(spring, replace(RECORD, hold_end=1.1)),
        solid.tau_inside_window(spring, (0.1, 1.0), "it"),
        ramp.tangent_determined(ElasticLaw.linear(1.0, DEPTH), 1),
        ramp.offset_plausible([]),
        ramp.drift_plausible([]),
        relaxation.depth_and_time_separable(None, None),
        relaxation.depth_and_time_separable(None, 0.5),
        relaxation.filter_bias(None),
        comparison.damping_agrees(unknown, peak(1)),
        comparison.damping_agrees(make_comparison(predicted_damping=None), peak(1)),
        comparison.operating_point(OperatingPoint(1e-3, None)),
        impact.coherence(make_measured_frf(coherence=None), 75),
        impact.high_frequency_mass_agrees(None, 1.0),
        curves.instrument_stiff(sweep()),
        modal.modes_explain_lines([shape(9.0)], is_known=False),
        modal.points_share_modes([shape(1.0)]),
    ):
        assert check.passed is None, check
        assert not check.failed
        assert check.value is None


def test_check_of_a_failed_search_fails_without_a_value() -> None:
    for check in (
        relaxation.filter_bias(parse_filter("lowpass:20Hz"), "it is a spike"),
        curves.kramers_kronig(None),
    ):
        assert check.failed, check
        assert check.value is None


def test_where_the_peaks_agree_the_hammer_has_tested_the_extrapolation() -> None:
    lone = make_comparison(measured_hz=20.0)
    for check in (
        comparison.inside_valid_band(lone, SEEN, is_confirmed=True),
        comparison.damping_tested(lone, SEEN, is_confirmed=True),
        comparison.operating_point(OperatingPoint(2e-3, 1e-3), is_confirmed=True),
    ):
        assert check.passed, check
        assert "bears" in check.message or "agrees" in check.message


def test_a_contradiction_too_small_to_matter_is_none() -> None:
    assert identification.hammer_agrees_with_relaxation_test(1, 1e9, residual_ratio=0.99e-4).passed
    assert identification.hammer_agrees_with_relaxation_test(1, 1e9, residual_ratio=1.01e-4).failed


def test_what_the_method_bears_is_excused() -> None:
    creeping = plate(np.where((TIME > 1) & (TIME < 2), 0.9, 1.0))
    assert preparation.hold_is_still(creeping, method="full").passed
    assert preparation.single_loading(0, loadings(3), is_requested=True).passed
    for share, moving, grade in (
        (0.099, True, "note"),
        (0.101, True, "limit"),
        (0.199, True, "limit"),
        (0.201, True, "stop"),
        (0.099, False, "note"),
        (9, False, "limit"),
    ):
        assert preparation.preload_absent(share, 1.0, is_moving=moving).grade == grade
    even = replace(RECORD, time=np.arange(len(TIME)) * 0.3, onset=30.0, ramp_end=31.0, hold_end=999)
    assert preparation.samples_unbroken(even).value == pytest.approx(0.3)
    assert preparation.samples_unbroken(even).passed
    swapped_not = replace(sinking(0.5), force=2 - np.clip(TIME, 0, 41) / 41)
    assert preparation.columns_plausible(swapped_not).passed
    resting = replace(RECORD, displacement=np.full(len(TIME), DEPTH))
    assert preparation.force_not_clipped(replace(resting, force=np.ones(len(TIME)))).passed
    assert relaxation.arms_where_force_relaxes(arm(), falling(0.5)).passed
    assert relaxation.fast_arm_visible(arm(1, 0.001), [RECORD], error=0.0099).passed
    assert relaxation.fast_arm_visible(arm(1, 0.001), [RECORD], error=0.0101).failed
    noisy = replace(falling(0.05), force_noise=1.0)
    assert relaxation.arms_where_force_relaxes(GeneralizedMaxwell(1.0), noisy).passed
    fine = replace(RECORD, force_noise=1e-9)
    tiny = np.full(len(TIME), 1.7e-3 * float(fine.force.max()))
    assert relaxation.force_residual_small(fine, tiny).passed
    wavy = replace(RECORD, force=RECORD.force + 0.03 * np.where(TIME < 0, np.sin(40 * TIME), 0))
    assert relaxation.force_residual_small(wavy, np.full(len(TIME), 0.03)).passed
    assert not relaxation.filter_bias(
        parse_filter("lowpass:20Hz:causal"), {"hold": {"k_inf": 0.0}, "full": {"k_inf": 0.0}}, 1.0
    ).passed
    assert vibration.stiffness_causal(0.0, -0.1, error=1.0, peak=12.0).failed
    # a plateau at zero is measured by the whole stiffness, and excuses no other parameter
    lost, model = GeneralizedMaxwell(0.0, (1.0,), (1.0,)), GeneralizedMaxwell(1.0, (1.0,), (2.0,))
    assert relaxation.hold_and_full_agree(lost, model, np.array([1.0, 0.0, 0.0])).failed
    assert relaxation.hold_and_full_agree(lost, model, np.array([1.0, 0.0, 0.4])).passed


def test_advice_follows_only_where_a_check_fails() -> None:
    low = comparison.peak_agrees(make_comparison(predicted_peak=0.1 * agreeing().measured_peak))
    assert low.message.endswith("(-20.0 dB). The model has too much damping there.")
    high = comparison.peak_agrees(make_comparison(predicted_peak=10 * agreeing().measured_peak))
    assert high.message.endswith("(+20.0 dB). The model has too little damping there.")
    off = comparison.stiffness_agrees(make_comparison(predicted_hz=1.1 * agreeing().measured_hz))
    assert off.message.endswith("differs by +21.0 %.")
    assert off.remedy is not None
    assert off.remedy.words.startswith("Check the mass, the number of seals")
    assert comparison.stiffness_agrees(agreeing()).message.endswith("differs by +0.0 %.")
    assert comparison.stiffness_agrees(agreeing()).remedy is None
    falling = replace(agreeing().predicted, value=1 / (1 + agreeing().predicted.frequency) + 0j)
    away = make_comparison(predicted=falling, predicted_hz=0.5 * agreeing().measured_hz)
    assert comparison.stiffness_agrees(away).message.startswith("The prediction has no peak from")
    assert comparison.stiffness_agrees(away).message_with_remedy.endswith("length and the preload.")
    assert "damping" not in comparison.peak_agrees(away).message
    assert "ratio 1.5" in comparison.damping_agrees(
        make_comparison(predicted_damping=0.03, measured_damping=0.02), peak(10)
    ).message  # fmt: skip


# -- decisions of the engine ----------------------------------------------------------------------


def test_bic_is_decisive_from_50_on() -> None:
    doubtful = (True, True, False)
    assert (
        select_model_order(range(3), (99.0, 49.9, 0.0), doubtful, decisive=DECISIVE_BIC).arms == 1
    )
    assert (
        select_model_order(range(3), (99.0, 50.1, 0.0), doubtful, decisive=DECISIVE_BIC).arms == 2
    )


@pytest.mark.parametrize(("kappa", "white"), [(2.99, True), (3.01, False)])
def test_noise_is_nearly_white_where_three_neighbours_say_the_same(
    kappa: float, white: bool
) -> None:
    noises = [Noise(1000, np.ones(1), item, 2.0) for item in (1.0, kappa)]
    assert nearly_white(noises) is white


@pytest.mark.parametrize("tau", [0.5, 2.0, 5.0, 20.0])
def test_kappa_is_the_closed_form_of_ar_1(tau: float) -> None:
    r""":math:`\kappa = 1 + 2\sum_l \phi^l = (1 + \phi)/(1 - \phi)`, :math:`\phi = e^{-1/\tau}`."""
    phi = np.exp(-1 / tau)
    result = np.mean([estimate_noise(_ar_1(phi, 2**19, seed)).kappa for seed in range(4)])
    assert result == pytest.approx((1 + phi) / (1 - phi), rel=0.03)


def _ar_1(phi: float, samples: int, seed: int) -> np.ndarray:
    """AR(1) noise: white noise through 1/(1 - phi z) as a convolution cut where it is nothing."""
    white = np.random.default_rng(seed).standard_normal(samples)
    length = int(np.ceil(-40 / np.log(phi)))
    size = 2 ** int(np.ceil(np.log2(samples + length)))
    kernel = phi ** np.arange(length)
    return np.fft.irfft(np.fft.rfft(white, size) * np.fft.rfft(kernel, size), size)[length:samples]


def test_another_family_that_explains_nothing_or_parts_nowhere_limits_nothing() -> None:
    for other in (None, make_alternative(1.0, explains=False), make_alternative(None)):
        assert fractional.model_families_distinguished(other).passed is True
    assert fractional.fractional_slope_determined(0.01, edge=True).passed is False
    assert fractional.fractional_model_suffices(1.1001, 2).grade == "stop"
    assert fractional.fractional_model_suffices(1.0999, 2).grade == "limit"
