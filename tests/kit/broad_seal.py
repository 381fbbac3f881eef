"""The broad seal on both virtual rigs, made once for all tests here."""

from __future__ import annotations

from functools import cache

from dashpot.fitting.relaxation import fit
from dashpot.preparation.prepare import prepare
from dashpot.records.fit import Fit
from dashpot.records.frf import FRF
from dashpot.records.relaxation import RampHold
from dashpot.simulation.impact import simulate_impact
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.table_1 import BROAD, BROAD_MASS
from dashpot.vibration.impact.frf_estimation import estimate_frf


@cache
def prepared() -> RampHold:
    return prepare(simulate_relaxation(BROAD, seed=3).test)


@cache
def fitted() -> Fit:
    return fit(prepared())


@cache
def measured() -> FRF:
    return estimate_frf(simulate_impact(BROAD, mass=BROAD_MASS, seed=3).test)
