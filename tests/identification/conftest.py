"""The broad seal on both virtual rigs, once for all tests here."""

from __future__ import annotations

import pytest

from dashpot.relaxation.fit import Fit
from dashpot.relaxation.fitting import fit
from dashpot.relaxation.preparation import prepare
from dashpot.relaxation.records import RampHold
from dashpot.simulation.hammer import simulate_impact
from dashpot.simulation.rig import simulate_relaxation
from dashpot.simulation.seals import BROAD, BROAD_MASS
from dashpot.vibration.frf import FRF
from dashpot.vibration.impact import estimate_frf


@pytest.fixture(scope="session")
def broad_test() -> RampHold:
    return prepare(simulate_relaxation(BROAD, seed=3).test)


@pytest.fixture(scope="session")
def broad_fit(broad_test: RampHold) -> Fit:
    return fit(broad_test)


@pytest.fixture(scope="session")
def broad_frf() -> FRF:
    return estimate_frf(simulate_impact(BROAD, mass=BROAD_MASS, seed=3).test)
