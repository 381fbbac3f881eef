"""What a simulated file says of itself."""

from __future__ import annotations

import json

from dashpot.simulation.ground_truth import stamp, truth_json
from dashpot.simulation.impact import Hammer, simulate_impact
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import BROAD, BROAD_MASS, PAPER


def test_simulated_relaxation_has_a_stamp_and_truth():
    truth = simulate_relaxation(PAPER, hold_time=1.0, seed=7).truth
    lines = stamp(truth)
    assert lines[0].startswith("simulated by dashpot")
    assert "not a measurement" in lines[0]
    assert "seed 7" in lines[1]
    document = json.loads(truth_json(truth))
    assert document["schema"] == "dashpot/truth@1"
    assert document["simulated"] is True
    assert document["kind"] == "relaxation"
    assert tuple(document["model"]["k"]) == PAPER.k
    assert tuple(document["model"]["tau"]) == PAPER.tau
    assert document["onset"] == truth.onset
    assert document["rig"]["axis"]["frequency"] == 6.0
    assert "force" not in document


def test_simulated_impact_has_a_stamp_and_truth():
    truth = simulate_impact(BROAD, mass=BROAD_MASS, hits=2, rig=Hammer(record=1.0)).truth
    assert "virtual hammer" in stamp(truth)[0]
    document = json.loads(truth_json(truth))
    assert document["kind"] == "impact"
    assert document["mass"] == BROAD_MASS
    assert [hit["peak"] for hit in document["hits"]] == [hit.peak for hit in truth.hits]
    assert complex(*document["bounce_poles"][0]) == truth.bounce_poles[0]


def test_what_is_unlimited_is_null():
    truth = simulate_relaxation(PAPER, hold_time=1.0, rig=Rig().noise_free()).truth
    assert json.loads(truth_json(truth))["rig"]["limit"] is None
