"""Public functions before a test: what it can determine, and simulated tests of known seals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

from dashpot.api import refuse_unknown_option, refuse_wrong_options
from dashpot.base.errors import DataError
from dashpot.base.option_fields import Method
from dashpot.base.units import Quantity, convert_to_si
from dashpot.base.value_ranges import require_nonnegative
from dashpot.datamodel.fit import Fit, get_temperature_law
from dashpot.datamodel.machine import Machine
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

if TYPE_CHECKING:
    from dashpot.planning.plan import Plan
    from dashpot.solids.shift_laws import TemperatureLaw


@refuse_wrong_options
def plan(
    *,
    frequency: Quantity,
    depth: Quantity = "8mm",
    ramp: Quantity = "1s",
    hold: Quantity = "40s",
    rate: Quantity = "1kHz",
    noise: Quantity = "5mN",
    baseline: Quantity = "1s",
    method: Method = "full",
    machine: Machine | None = None,
    seal: str | Fit | GeneralizedMaxwell = "paper",
    cold: Sequence[Quantity] = (),
    mass: Quantity | None = None,
    seals: float = 1.0,
    hits: int = 5,
    max_std: float = 0.1,
) -> Plan:
    """Return how well a planned test will determine stiffness and loss factor at a frequency.

    Parameters
    ----------
    frequency : float or str
        Frequency of interest, Hz or ``"12.71Hz"``.
    depth, ramp, hold, rate, noise, baseline, method
        Depth, ramp time, hold time, sampling rate, noise and baseline time of the ramp and hold, in
        m, s, s, Hz, N and s.
    machine : Machine, optional
        Known properties of the testing machine.
    seal : str, Fit or GeneralizedMaxwell
        Assumed seal: ``"paper"``, ``"broad"`` or ``"hidden"``, or a solid.
    cold : sequence of float or str
        Temperatures at which the test is repeated, K or ``"0degC"``.
    mass, seals, hits
        Settings of an additional hammer test.
    max_std : float
        Target relative standard deviation of the loss factor.

    Raises
    ------
    DataError
        If a value is out of range.

    Examples
    --------
    >>> import dashpot as dp
    >>> planned = dp.plan(frequency="12.71Hz", ramp="1s", hold="40s")
    >>> planned.expected.loss_factor_sd > 0.1
    True
    """
    from dashpot.planning.assumed_seal import AssumedSeal
    from dashpot.planning.plan import plan as compute_plan
    from dashpot.planning.plan_options import HammerPlan
    from dashpot.planning.planned_ramp_hold import Bench

    solid, law, _ = _get_seal_model(seal)
    bench = Bench(
        depth=convert_to_si(depth, "length"),
        ramp_time=convert_to_si(ramp, "time"),
        hold_time=convert_to_si(hold, "time"),
        rate=convert_to_si(rate, "frequency"),
        noise=convert_to_si(noise, "force"),
        method=method,
        baseline=convert_to_si(baseline, "time"),
        machine=machine or Machine(),
    )
    return compute_plan(
        bench,
        at=frequency,
        seal=AssumedSeal(model=solid.maxwell, law=law),
        hammer=HammerPlan(mass=convert_to_si(mass, "mass"), seals=seals, hits=hits),
        cold=[convert_to_si(item, "temperature") for item in cold],
        target_sd=max_std,
    )


@refuse_wrong_options
def simulate(
    what: Literal["relaxation", "creep", "impact"],
    *,
    seal: str | Fit | Solid = "paper",
    seed: int = 0,
    temperature: Quantity | None = None,
    noise_free: bool = False,
    rate: Quantity | None = None,
    depth: Quantity | None = None,
    load: Quantity | None = None,
    ramp: Quantity | None = None,
    hold: Quantity | None = None,
    mass: Quantity | None = None,
    seals: float | None = None,
    hits: int | None = None,
    hit_length: Quantity | None = None,
) -> Any:
    """Simulate a test of a known seal; the record is marked as simulated.

    Parameters
    ----------
    what : str
        ``"relaxation"``, ``"creep"`` or ``"impact"`` (a hammer test).
    seal : str, Fit or Solid
        ``"paper"`` (its Table 1), ``"broad"`` (three faster arms) or ``"hidden"`` (one), or a
        fit or model.
    depth, load, ramp, hold : float or str
        Settings of the ramp and hold, in m or N, s and s.
    mass, seals, hits, hit_length
        Test mass, kg; number of seals that carry it; number of hits and their length, s.
    temperature : float or str, optional
        Temperature of the test, K.
    noise_free : bool
        Without noise, drift, bias, hum and steps.
    seed : int

    Raises
    ------
    DataError
        If there is no such seal, or an option does not apply to the test.

    Examples
    --------
    >>> import dashpot as dp
    >>> test = dp.simulate("relaxation", seal="broad", hold="5s", noise_free=True)
    >>> dp.fit(test, arms=2).model.arms
    2
    """
    from dashpot import simulation

    if what not in _TESTS:
        raise DataError(f"'{what}' is not simulated; expected one of {', '.join(_TESTS)}")
    instrument, words = _TESTS[what]
    require_nonnegative(seed=seed)
    stated_options = {
        "depth": depth, "load": load, "ramp": ramp, "hold": hold, "mass": mass, "seals": seals,
        "hits": hits, "hit_length": hit_length,
    }  # fmt: skip
    stated_options = {name: value for name, value in stated_options.items() if value is not None}
    refuse_unknown_option(stated_options, words, f"a test of {what}")
    solid, law, block = _get_seal_model(seal)
    options: dict[str, Any] = {words[name]: value for name, value in stated_options.items()}
    if what == "impact":
        options = {"mass": block, "seals": 2.0, **options}
        if options["mass"] is None:
            raise DataError('the mass under the hammer is not known for this seal: mass="104g"')
        options["mass"] = convert_to_si(options["mass"], "mass")
    rig: Any = getattr(simulation, instrument)()
    given_values = {
        "rate": convert_to_si(rate, "frequency"),
        "record": convert_to_si(options.pop("record", None), "time"),
    }
    rig = replace(
        rig.noise_free() if noise_free else rig,
        **{name: item for name, item in given_values.items() if item is not None},
    )
    climate = None
    if temperature is not None:
        climate = simulation.Climate(convert_to_si(temperature, "temperature"), law)
    simulate_kind = getattr(simulation, f"simulate_{what}")
    return simulate_kind(solid, rig=rig, seed=seed, climate=climate, **options).test


_TIMES = {"ramp": "ramp_time", "hold": "hold_time"}
_TESTS: dict[str, tuple[str, dict[str, str]]] = {
    "relaxation": ("Rig", {"depth": "depth", **_TIMES}),
    "creep": ("Rig", {"load": "load", **_TIMES}),
    "impact": (
        "Hammer", {"mass": "mass", "seals": "seals", "hits": "hits", "hit_length": "record"}
    ),
}  # fmt: skip
"""Instrument of each simulated test, and the names of its options in the simulation."""


def _get_seal_model(seal: str | Fit | Solid) -> tuple[Any, TemperatureLaw, float | None]:
    """A solid, how it follows temperature, and the block that is known to peak on two of it."""
    from dashpot.solids.demo_seals import SEALS, SHIFT

    if isinstance(seal, str):
        if seal not in SEALS:
            raise DataError(f"seal='{seal}': expected one of {', '.join(SEALS)}, or a model")
        solid, mass = SEALS[seal]
        return solid, SHIFT, mass
    if isinstance(seal, Fit):
        return seal.solid, get_temperature_law(seal) or SHIFT, None
    return seal, SHIFT, None
