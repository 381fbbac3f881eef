"""dashpot fit, an indenter: hits as other labs' files hold them."""

from __future__ import annotations

import json
from functools import partial

import numpy as np
import pytest
from kit import contacts, shell
from kit.kinds import save_table

from dashpot.reading.readers.inspect import inspect_file
from dashpot.workflow.example_files import EXAMPLES

pytestmark = pytest.mark.once

BALL = ("--kind", "indentation", "--mass", "5g", "--radius", "5mm", "--model", "hertz-kelvin-voigt")


ran = partial(shell.did, "fit")


@pytest.fixture(scope="module")
def hit():
    rows = contacts.march(contacts.kuwabara(4 / 3 * 4e6 * 5e-3**0.5, 1e-4), 5e-3, 1.0)
    return {
        of: contacts.record_sensor(rows, 5e-3, 1e5, of=of) for of in ("acceleration", "velocity")
    }


def test_the_example_end_to_end(tmp_path):
    path, figure = tmp_path / "hit.csv", tmp_path / "hit.svg"
    path.write_text(EXAMPLES["hit.csv"](), encoding="utf-8")
    assert inspect_file(path).kind == "indentation"
    words = [path, *BALL, "--drop-height", "51mm"]
    document = json.loads(ran(*words, "--json", "--plot", figure).stdout)
    assert document["schema"] == "dashpot/indentation@2"
    assert document["modulus"] == pytest.approx(4e6, rel=0.01)
    low, high = document["intervals"]["modulus"]
    assert low < document["modulus"] < high
    assert document["verdict"]["verdict_grade"] == "use"
    assert "hertz-kelvin-voigt" in figure.read_text("utf-8")
    text = ran(*words).stdout
    assert "restitution" in text
    assert "MPa" in text


@pytest.mark.parametrize(
    ("of", "header", "scale"),
    [
        ("acceleration", "t [ms],Beschleunigung [g]", 1 / 9.80665),
        ("velocity", "Time (ms),Velocity (mm/s)", 1e3),
    ],
)
def test_headers_and_units_of_other_labs(tmp_path, hit, of, header, scale):
    t, y = hit[of]
    path = save_table(tmp_path / "a.csv", header, 1e3 * t, scale * y)
    document = json.loads(ran(path, *BALL, "--impact-velocity", "1m/s", "--json").stdout)
    assert document["quantity"] == of
    assert document["modulus"] == pytest.approx(4e6, rel=2e-3)


def test_fit_asks_for_missing_or_wrong_indentation_input(tmp_path, hit):
    t, y = hit["acceleration"]
    path = save_table(tmp_path / "a.csv", "time [s],acceleration [m/s^2]", t, y)
    assert "--mass 5g" in ran(path, "--kind", "indentation", code=2).stderr
    unitless = save_table(tmp_path / "b.csv", "time [s],acceleration", t, y)
    assert "has no unit" in ran(unitless, *BALL, code=2).stderr
    slow = save_table(tmp_path / "c.csv", "time [s],acceleration [m/s^2]", 1e3 * t, y)
    assert "(--units time=ms)" in ran(slow, *BALL, code=2).stderr
    hot = save_table(tmp_path / "d.csv", "time [s],acceleration [g]", t, 1e3 * y)
    assert "The unit may be m/s^2." in ran(hot, *BALL, code=2).stderr
    two = save_table(tmp_path / "e.csv", "time [s],acc 1 [g],acc 2 [g]", t, y, 2 * y)
    assert "--column acceleration=" in ran(two, *BALL, code=2).stderr
    fast = save_table(tmp_path / "f.csv", "time [s],velocity [m/s]", t, 1e3 * hit["velocity"][1])
    assert "The unit may be mm/s." in ran(fast, *BALL, code=2).stderr
    none = save_table(tmp_path / "g.csv", "time [s],noise [V]", t, y)
    assert "--column acceleration=NAME" in ran(none, *BALL, code=2).stderr
    still = save_table(tmp_path / "h.csv", "time [s],acceleration [m/s^2]", t, np.sin(1e9 * t))
    assert "h.csv: no contact stands out" in ran(still, *BALL, code=2).stderr
