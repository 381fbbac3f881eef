"""Before a test: what it will tell at a frequency, and what to change."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dashpot.base.arrays import FloatArray, sample_count
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, si
from dashpot.planning import checks
from dashpot.planning.checks import percent
from dashpot.planning.expected import (
    Bench,
    ExpectedError,
    Pulse,
    RecordNeed,
    expected_error,
    half_sine,
    hammer_rows,
    record_need,
)
from dashpot.records.machine import Machine
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.table_1 import PAPER
from dashpot.vibration.systems.prediction import mass_for_peak

# the seal of the paper's Table 1, where the user knows nothing better yet
USUAL_SEAL = PAPER
# an arm of this part of the instantaneous stiffness is what sponge rubber may hide
USUAL_PART = 0.1
# an arm of the model this near, as a factor in time, already stands for the unseen one
NEAR = 3.0
WANTED = 0.1
FASTER = (1 / 3, 1 / 10, 1 / 30)
# a hammer test informs the lines within this factor of the peak; their usual spacing, Hz
AROUND = 3.5
LINE_STEP = 0.1


@dataclass(frozen=True)
class Plan:
    """What a test can and cannot tell at a frequency, and what to change.

    Attributes
    ----------
    at : float
        Hz.
    model : GeneralizedMaxwell
        The solid that was supposed, the unseen arm included.
    arm : (float, float) or None
        Stiffness, N/m, and relaxation time, s, of the arm that the test may not see.
    expected : ExpectedError
        Of the test as asked.
    alternatives : tuple of ExpectedError
        Of the other method, of faster ramps, and of the same test with a hammer test.
    band : (float, float)
        The frequencies that the relaxation test can inform, Hz.
    record : RecordNeed
    pulse : Pulse or None
    checks : tuple of Check
    advice : tuple of str
        What to change, most useful first.
    """

    at: float
    model: GeneralizedMaxwell
    arm: tuple[float, float] | None
    expected: ExpectedError
    alternatives: tuple[ExpectedError, ...]
    band: tuple[float, float]
    record: RecordNeed
    pulse: Pulse | None
    checks: tuple[Check, ...]
    advice: tuple[str, ...]

    def __str__(self) -> str:
        head = f"{'method':<8}{'ramp, s':>10}{'hold, s':>10}{'storage':>12}{'loss factor':>14}"
        rows = [
            f"{e.method:<8}{e.ramp_time:>10.3g}{e.hold_time:>10.3g}"
            f"{percent(e.storage_sd, 'unknown'):>12}{percent(e.loss_factor_sd, 'unknown'):>14}"
            for e in (self.expected, *self.alternatives)
        ]
        title = f"expected standard deviation at {self.at:g} Hz"
        return "\n".join([title, head, *rows, *self.advice])


def plan(
    *,
    depth: Quantity,
    ramp_time: Quantity,
    hold_time: Quantity,
    rate: Quantity,
    noise: Quantity,
    at: Quantity,
    model: GeneralizedMaxwell | None = None,
    method: str = "full",
    arm: tuple[Quantity, Quantity] | None = None,
    baseline: Quantity = 1.0,
    sync: Quantity | None = None,
    drift: Quantity | None = None,
    mass: Quantity | None = None,
    seals: float = 1.0,
    record: Quantity | None = None,
    pulse: Quantity | None = None,
    hits: int = 5,
    coherence: float = 0.99,
    wanted: float = WANTED,
) -> Plan:
    r"""Tell what a test will tell at a frequency, before it is run.

    Supposes that the seal has an arm at :math:`\tau = 1/\omega`, where it matters most for damping,
    and asks the Cramer-Rao bound how well the relaxation test would know storage stiffness and loss
    factor there (:mod:`dashpot.planning.expected`), with offset, drift and delay of the force known
    before as the fit knows them. For the hammer test, how long the record must be and what the tip
    excites.

    Parameters
    ----------
    depth, ramp_time, hold_time : float
        m, s, s.
    rate : float
        Samples per second, Hz.
    noise : float
        Standard deviation of a force sample, N; multiply by the square root of the correlation
        (``fit.residual.kappa``) if samples are filtered.
    at : float
        The frequency that matters, Hz.
    model : GeneralizedMaxwell, optional
        A guess at one seal; the paper's Table 1 by default.
    method : str
        ``"full"`` fits ramp and hold, ``"hold"`` the hold alone.
    arm : (float, float), optional
        Stiffness, N/m, and relaxation time, s, of the unseen arm. By default 10 % of the
        instantaneous stiffness at 1/omega, unless the model has an arm within a factor of 3.
    baseline : float
        Recorded before the ramp, s: it tells the offset of the load cell.
    sync, drift : float, optional
        Standard deviations of the delay between the clocks of force and displacement, s, and of
        the drift of the load cell, N/s, as in :class:`~dashpot.records.machine.Machine`.
    mass : float, optional
        kg, of the block on `seals` seals; by default the one that puts the peak at `at`.
    record : float, optional
        Length of the planned impact record, s.
    pulse : float, optional
        Duration of the hammer pulse, s: soft rubber tips give 10 to 20 ms.
    hits : int
        How many hits of the hammer test are averaged.
    coherence : float
        Their coherence about the peak, below 1.
    wanted : float
        The relative standard deviation of the loss factor that would do.

    Raises
    ------
    DataError
        If a number is not positive or the method unknown.
    """
    depth, ramp_time, hold_time = si(depth, "length"), si(ramp_time, "time"), si(hold_time, "time")
    rate, noise, at = si(rate, "frequency"), si(noise, "force"), si(at, "frequency")
    baseline, sync, drift = si(baseline, "time"), si(sync, "time"), si(drift, "force rate")
    mass, record, pulse = si(mass, "mass"), si(record, "time"), si(pulse, "time")
    _positive(depth=depth, ramp_time=ramp_time, hold_time=hold_time, rate=rate, noise=noise, at=at)
    _positive(
        baseline=baseline,
        mass=mass,
        seals=seals,
        record=record,
        pulse=pulse,
        wanted=wanted,
        hits=hits,
    )
    if not 0 < coherence < 1:
        raise DataError(f"coherence = {coherence!r}; expected a number between 0 and 1")
    if method not in {"full", "hold"}:
        raise DataError(f'method = {method!r}; expected "full" or "hold"')
    seal = USUAL_SEAL if model is None else model
    supposed, arm = _with_arm(seal, arm, at)
    index = None if arm is None else supposed.tau.index(arm[1])
    machine = Machine(sync=sync, drift=drift)
    bench = Bench(depth, ramp_time, hold_time, rate, noise, method, baseline, machine)
    expected = expected_error(supposed, bench, at, index)
    total = seals * supposed
    weight = mass_for_peak(total, at) if mass is None else mass
    rows = hammer_rows(
        supposed,
        weight,
        seals=seals,
        lines=_lines(at, record),
        relative_sd=float(np.sqrt((1 - coherence) / (2 * hits * coherence))),
    )
    alternatives = (
        *(expected_error(supposed, other, at, index) for other in _others(bench)),
        expected_error(supposed, replace(bench, method="full"), at, index, rows),
    )
    need = record_need(total, weight, record)
    without = "" if arm is None else _without_arm(seals * seal, mass, at)
    tip = None if pulse is None else half_sine(pulse, at)
    band = (1 / (2 * np.pi * hold_time), 1 / (np.pi * ramp_time))
    answers = _checks(expected, band, need, tip, at=at, wanted=wanted)
    return Plan(
        at=at,
        model=supposed,
        arm=arm,
        expected=expected,
        alternatives=alternatives,
        band=band,
        record=need,
        pulse=tip,
        checks=answers,
        advice=_advice(
            expected, alternatives, answers, need, tip, at=at, wanted=wanted, without=without
        ),
    )


def _positive(**named: float | None) -> None:
    for name, value in named.items():
        if value is not None and not (np.isfinite(value) and value > 0):
            raise DataError(f"{name} = {value!r}; expected a number > 0 in SI units")


def _with_arm(
    model: GeneralizedMaxwell, arm: tuple[Quantity, Quantity] | None, at: float
) -> tuple[GeneralizedMaxwell, tuple[float, float] | None]:
    if arm is None:
        tau = 1 / (2 * np.pi * at)
        if any(1 / NEAR < own / tau < NEAR for own in model.tau):
            return model, None
        arm = (USUAL_PART * model.k_0, tau)
    known = si(arm[0], "stiffness"), si(arm[1], "time")
    return model + GeneralizedMaxwell(0.0, known[:1], known[1:]), known


def _others(bench: Bench) -> list[Bench]:
    other = "hold" if bench.method == "full" else "full"
    faster = [
        replace(bench, method="full", ramp_time=bench.ramp_time * part)
        for part in FASTER
        if bench.ramp_time * part * bench.rate >= 5
    ]
    return [replace(bench, method=other), *faster]


def _lines(at: float, record: float | None) -> FloatArray:
    """The lines that a hammer test would give about the peak, Hz."""
    step = LINE_STEP if record is None else 1 / record
    first, last = at / AROUND, at * AROUND
    count = max(sample_count(last - first, 1 / step), 8)
    return np.asarray(first + step * np.arange(count, dtype=float))


# -- words ------------------------------------------------------------------------------------


def _checks(
    expected: ExpectedError,
    band: tuple[float, float],
    need: RecordNeed,
    tip: Pulse | None,
    *,
    at: float,
    wanted: float,
) -> tuple[Check, ...]:
    found = [
        checks.loss_factor_known(expected.loss_factor_sd, at, wanted),
        checks.inside_identified_band(at, band),
    ]
    if need.record is not None and need.peak_error is not None:
        found.append(checks.record_long_enough(need))
    if tip is not None:
        found.append(checks.tip_excites(tip, at))
    return tuple(found)


def _advice(
    expected: ExpectedError,
    alternatives: Sequence[ExpectedError],
    answers: Sequence[Check],
    need: RecordNeed,
    tip: Pulse | None,
    *,
    at: float,
    wanted: float,
    without: str,
) -> tuple[str, ...]:
    words = []
    if expected.loss_factor_sd > wanted:
        words.append(_ramp_advice(expected, alternatives, at=at, wanted=wanted))
    if need.record is None:
        words.append(
            f"Record each hit for {_needed(need):.3g} s{without}: {need.for_decay:.3g} s hold six "
            f"time constants, {need.for_lines:.3g} s put five lines into the half-power band; with "
            "an exponential window on both channels and the model taken at s = jw + a a shorter "
            "record does."
        )
    failed = {check.name for check in answers if check.failed}
    if "record_long_enough" in failed:
        words.append(
            f"Record each hit for {_needed(need):.3g} s{without} instead of {need.record:g} s, or "
            "fit the model to the cut or windowed record."
        )
    if tip is not None and "tip_excites" in failed:
        words.append(
            f"Use a harder tip: the pulse must be shorter than {1e3 * _pulse_for(at):.3g} ms to "
            f"lose less than 10 dB at {at:g} Hz."
        )
    if not words:
        words.append(f"This test will do: it knows the loss factor at {at:g} Hz well enough.")
    return tuple(words)


def _without_arm(seal: GeneralizedMaxwell, mass: float | None, at: float) -> str:
    """The record that the seal needs if the arm that was supposed is not there."""
    need = record_need(seal, mass_for_peak(seal, at) if mass is None else mass, None)
    return f" ({_needed(need):.3g} s if the seal has no such arm)"


def _needed(need: RecordNeed) -> float:
    """The record that a hit needs, s."""
    return max(need.for_decay, need.for_lines)


def _ramp_advice(
    expected: ExpectedError, alternatives: Sequence[ExpectedError], *, at: float, wanted: float
) -> str:
    joint = next(e for e in alternatives if e.method == "joint")
    hammer = (
        f"test the damping with a hammer test and fit both together (identify, "
        f"{percent(joint.loss_factor_sd)})"
    )
    good = [e for e in alternatives if e.loss_factor_sd <= wanted and e is not joint]
    start = (
        f"The loss factor at {at:g} Hz would be known to {percent(expected.loss_factor_sd)} only"
    )
    if not good:
        return f"{start}, and no faster ramp tried here brings it to {percent(wanted)}: {hammer}."
    best = max(good, key=lambda e: e.ramp_time)
    how = f"ramp in {best.ramp_time:.3g} s" if best.ramp_time < expected.ramp_time else ""
    fit = "fit ramp and hold together" if best.method != expected.method else ""
    change = " and ".join(part for part in (how, fit) if part)
    return f"{start}: {change} ({percent(best.loss_factor_sd)}), or {hammer}."


def _pulse_for(at: float) -> float:
    # the spectrum depends on f T alone
    return half_sine(1.0, at).band_10db / at
