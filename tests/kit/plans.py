"""Plans from options in any order: each goes to the value that has it."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from dashpot.datamodel.machine import Machine
from dashpot.planning.assumed_seal import AssumedSeal
from dashpot.planning.plan import Plan, plan
from dashpot.planning.plan_options import HammerPlan
from dashpot.planning.planned_ramp_hold import Bench


def make_bench_plan(**words: Any) -> Plan:
    """The plan of the usual test at 12.71 Hz, with changes to bench, machine, seal and hammer.

    With ``force_alone`` there is no machine: nothing but the noise of the force.
    """
    single, values = words.pop("force_alone", False), []
    for cls in (Bench, Machine, AssumedSeal, HammerPlan):
        individual = {field.name for field in fields(cls)} & words.keys()
        values.append(cls(**{name: words.pop(name) for name in individual}))
    bench, machine, seal, hammer = values
    bench = replace(bench, machine=None if single else machine)
    return plan(bench, seal=seal, hammer=hammer, **({"at": 12.71} | words))
