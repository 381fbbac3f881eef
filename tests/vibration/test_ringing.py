"""A hit on a mass that still rings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dashpot.simulation.impact import Hammer, simulate_impact
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.vibration.impact.hits import cut_hits, remove_ringing

pytestmark = pytest.mark.once

MASS = 0.1040426
TRUE = 12.70975, 0.00443503


@pytest.fixture(scope="module")
def hasty(paper_seal):
    """Hits every 6 s, when an eighth of the motion is left."""
    rig = replace(Hammer(), record=6.0, continuous=True)
    return simulate_impact(paper_seal, mass=MASS, hits=5, rig=rig).test


def test_estimate_frf_removes_and_reports_ringing(hasty):
    frf = estimate_frf(hasty)
    mode = frf.modes()[0]
    assert mode.frequency == pytest.approx(TRUE[0], rel=5e-5)
    assert mode.damping_ratio == pytest.approx(TRUE[1], rel=0.01)
    (step,) = [step for step in frf.steps if step.name == "ringing"]
    assert dict(step.parameters)["hits"].endswith("2, 3, 4, 5")
    assert any("taken off as a free decay" in reason for reason in frf.hits[3].reasons)


def test_without_that_the_damping_would_be_wrong(hasty, monkeypatch):
    monkeypatch.setattr(
        "dashpot.vibration.impact.frf_estimation.remove_ringing", lambda hit, poles: hit
    )
    mode = estimate_frf(hasty).modes()[0]
    assert abs(mode.damping_ratio / TRUE[1] - 1) > 0.05


def test_estimate_frf_keeps_a_mass_at_rest_unchanged(strike):
    frf = estimate_frf(strike(hits=3, noise=(5e-3, 0.02)))
    assert "ringing" not in [step.name for step in frf.steps]


def test_remove_ringing_keeps_motion_without_free_decay(hasty):
    hit = cut_hits([hasty])[3]
    pole = complex(-0.354171, 79.85693)
    assert remove_ringing(hit, [pole]).calmed
    wrong = complex(-0.4, 300.0)
    assert not remove_ringing(hit, [wrong]).calmed
    assert not remove_ringing(hit, []).calmed
    shortened = replace(hit, past=hit.past[:, -6:])
    assert not remove_ringing(shortened, [pole]).calmed


def test_calm_takes_the_decay_off_the_whole_block(hasty):
    hit = cut_hits([hasty])[3]
    t = (np.arange(len(hit.force)) - hit.onset) / hit.rate
    pole = complex(-0.354171, 79.85693)
    ringing = np.vstack([(c * np.exp(pole * t)).real for c in (0.5 + 0.2j, 0.4 - 0.3j)])
    before = (np.arange(hit.past.shape[1]) - hit.past.shape[1] - 2) / hit.rate
    past = np.vstack([(c * np.exp(pole * before)).real for c in (0.5 + 0.2j, 0.4 - 0.3j)])
    still = replace(hit, acceleration=ringing, past=past)
    assert np.abs(remove_ringing(still, [pole]).acceleration).max() < 1e-9
