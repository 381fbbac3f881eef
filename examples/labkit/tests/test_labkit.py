"""What a lab tests of its plug-ins; ``pytest examples/labkit`` after ``pip install -e``."""

import json
import math
import struct

import labkit.deck
import labkit.format
import labkit.peel

from dashpot.testing import check_format


def write_sample(path):
    """A ramp of 8 mm in 1 s and a hold of 40 s, 100 Hz, as the machine would write it."""
    head = {
        "operator": "K. M.",
        "channels": [["time", "s"], ["displacement", "mm"], ["force", "N"]],
    }
    body = b""
    for i in range(4101):
        t = i / 100
        ramp = min(t, 1.0)
        rest = math.exp(-(t - ramp) / 12) * (1 - math.exp(-ramp / 12)) / (1 / 12)
        body += struct.pack("<3f", t, 8 * ramp, 1.6 * ramp + 0.2 * rest)
    path.write_bytes(labkit.format.MAGIC + json.dumps(head).encode() + b"\n" + body)
    return path


def test_the_format_keeps_the_contract(tmp_path):
    found = check_format(labkit.format, write_sample(tmp_path / "seal.lab"))
    assert found == ["time [s]", "displacement [mm]", "force [N]"]


def test_the_deck_holds_the_arms():
    solid = {"k_inf": 196.5, "k": [117.5], "tau": [0.5]}
    deck = labkit.deck.labsolver(solid, units="SI", name="labsolver")
    assert deck.splitlines()[1] == "ARM 117.5 0.5"


def test_the_mean_of_a_steady_peel():
    force = {"name": "F", "role": "force", "unit": "N", "values": [5.0, 4.9, 5.1, 5.0] * 10}
    assert abs(labkit.peel.fit([force], {})["numbers"][0]["value"] - 5.0) < 0.01
