"""Before a test: what it will tell at a frequency, and what to change."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from dashpot.base.arrays import FloatArray, positive, sample_count
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, si
from dashpot.planning import checks
from dashpot.planning.advice import advice, listed, needed
from dashpot.planning.bench import Bench
from dashpot.planning.checks import percent
from dashpot.planning.cold import Elsewhere, elsewhere, refuse_twice
from dashpot.planning.expected import (
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
from dashpot.solids.table_1 import PAPER, SHIFT
from dashpot.solids.temperature import TemperatureLaw
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
# where a test is repeated if nobody says: a refrigerator, K; if that is so much colder
USUAL_COLD = 273.15
COLDER = 10.0
_IN_SI = "a number > 0 in SI units"


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
        Of the test as asked, with its repeats.
    alternatives : tuple of ExpectedError
        Of the test alone and at each other temperature, of the other method, of faster ramps,
        of the test repeated at 0 degC if no other was asked for, and with a hammer test.
    band : (float, float)
        The frequencies that the relaxation test can inform, Hz.
    record : RecordNeed
    pulse : Pulse or None
    checks : tuple of Check
    advice : tuple of str
        What to change, most useful first.
    temperature : float
        Of the test, K.
    repeats : tuple of Elsewhere
        Where it is repeated, as asked.
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
    temperature: float = SHIFT.reference
    repeats: tuple[Elsewhere, ...] = ()

    def __str__(self) -> str:
        head = f"{'method':<8}{'ramp, s':>10}{'hold, s':>10}{'storage':>12}{'loss factor':>14}"
        rows = [
            f"{e.method:<8}{e.ramp_time:>10.3g}{e.hold_time:>10.3g}"
            f"{percent(e.storage_sd, 'unknown'):>12}{percent(e.loss_factor_sd, 'unknown'):>14}"
            f"{f'  and at {listed(e.repeated)}' if e.repeated else ''}"
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
    cold: Quantity | Sequence[Quantity] = (),
    temperature: Quantity | None = None,
    law: TemperatureLaw = SHIFT,
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
    cold : float or sequence of float
        Temperatures, K, at which the same test is repeated: arms that are too fast for the ramp
        are slower there (:mod:`dashpot.planning.cold`).
    temperature : float, optional
        Of the test, K, at which the seal is `model`; by default the reference of the law.
    law : TemperatureLaw
        How the seal is supposed to follow temperature: by default as a rubber with its glass
        transition at -55 degC. The fit needs no law.

    Raises
    ------
    DataError
        If a number is not positive or the method unknown, or the law does not reach so far.
    """
    depth, ramp_time, hold_time = si(depth, "length"), si(ramp_time, "time"), si(hold_time, "time")
    rate, noise, at = si(rate, "frequency"), si(noise, "force"), si(at, "frequency")
    baseline, sync, drift = si(baseline, "time"), si(sync, "time"), si(drift, "force rate")
    mass, record, pulse = si(mass, "mass"), si(record, "time"), si(pulse, "time")
    positive(
        depth=depth, ramp_time=ramp_time, hold_time=hold_time, rate=rate, noise=noise, at=at,
        baseline=baseline, mass=mass, seals=seals, record=record, pulse=pulse, wanted=wanted,
        hits=hits, expected=_IN_SI, optional=True,
    )  # fmt: skip
    if not 0 < coherence < 1:
        raise DataError(f"coherence = {coherence!r}; expected a number between 0 and 1")
    if method not in {"full", "hold"}:
        raise DataError(f'method = {method!r}; expected "full" or "hold"')
    room = law.reference if temperature is None else si(temperature, "temperature")
    asked = [cold] if isinstance(cold, str | float | int) else cold
    places = [si(each, "temperature") for each in asked]
    for kelvin in (room, *places):
        positive(temperature=kelvin, expected=_IN_SI)
    repeats = tuple(elsewhere(kelvin, room, law) for kelvin in places)
    refuse_twice(places)
    seal = USUAL_SEAL if model is None else model
    supposed, arm = _with_arm(seal, arm, at)
    index = None if arm is None else supposed.tau.index(arm[1])
    machine = Machine(sync=sync, drift=drift)
    bench = Bench(depth, ramp_time, hold_time, rate, noise, method, baseline, machine)
    expected = expected_error(supposed, bench, at, index, repeats=repeats)
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
        *(
            expected_error(supposed, other, at, index, repeats=where)
            for other, where in _others(bench, repeats, room, law)
        ),
        expected_error(supposed, replace(bench, method="full"), at, index, rows),
    )
    need = record_need(total, weight, record)
    tip = None if pulse is None else half_sine(pulse, at)
    band = _band(bench, repeats)
    answers = _checks(expected, band, need, tip, at=at, wanted=wanted)
    words = advice(
        expected, alternatives, answers, need, tip, at=at, wanted=wanted, room=room,
        without="" if arm is None else _without_arm(seals * seal, mass, at),
    )  # fmt: skip
    return Plan(
        at=at, model=supposed, arm=arm, expected=expected, alternatives=alternatives, band=band,
        record=need, pulse=tip, checks=answers, advice=words, temperature=room, repeats=repeats,
    )  # fmt: skip


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


def _others(
    bench: Bench, repeats: Sequence[Elsewhere], room: float, law: TemperatureLaw
) -> list[tuple[Bench, Sequence[Elsewhere]]]:
    """The tests beside the one that was asked for, each with its repeats."""
    other = replace(bench, method="hold" if bench.method == "full" else "full")
    faster = [
        replace(bench, method="full", ramp_time=bench.ramp_time * part)
        for part in FASTER
        if bench.ramp_time * part * bench.rate >= 5
    ]
    ramps = [(each, ()) for each in (other, *faster)]
    if not repeats:
        return [*ramps, *((bench, place) for place in _usual_cold(room, law))]
    single = [(bench, (each,)) for each in repeats] if len(repeats) > 1 else []
    return [(bench, ()), *single, (other, repeats), *ramps]


def _usual_cold(room: float, law: TemperatureLaw) -> list[tuple[Elsewhere]]:
    """A refrigerator, if it is colder than the room and the law reaches so far."""
    if room < USUAL_COLD + COLDER:
        return []
    try:
        return [(elsewhere(USUAL_COLD, room, law),)]
    except DataError:
        return []


def _band(bench: Bench, repeats: Sequence[Elsewhere]) -> tuple[float, float]:
    """What ramp and hold inform, Hz; a repeat informs a_T times that of the solid."""
    slower = [1.0, *(each.a_t for each in repeats)]
    low, high = 1 / (2 * np.pi * bench.hold_time), 1 / (np.pi * bench.ramp_time)
    return min(slower) * low, max(slower) * high


def _without_arm(seal: GeneralizedMaxwell, mass: float | None, at: float) -> str:
    """The record that the seal needs if the arm that was supposed is not there."""
    need = record_need(seal, mass_for_peak(seal, at) if mass is None else mass, None)
    return f" ({needed(need):.3g} s if the seal has no such arm)"


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
