"""The broad seal on both virtual rigs, made once for all tests here."""

from __future__ import annotations

from functools import cache

from dashpot.relaxation.fit import Fit
from dashpot.relaxation.fitting import fit
from dashpot.relaxation.preparation import prepare
from dashpot.relaxation.records import RampHold
from dashpot.simulation.hammer import simulate_impact
from dashpot.simulation.rig import simulate_relaxation
from dashpot.simulation.seals import BROAD, BROAD_MASS
from dashpot.vibration.frf import FRF
from dashpot.vibration.impact import estimate_frf


@cache
def prepared() -> RampHold:
    return prepare(simulate_relaxation(BROAD, seed=3).test)


@cache
def fitted() -> Fit:
    return fit(prepared())


@cache
def measured() -> FRF:
    return estimate_frf(simulate_impact(BROAD, mass=BROAD_MASS, seed=3).test)
