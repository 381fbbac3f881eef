"""Table of a predicted FRF."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from kit.shell import did

import dashpot as dp
from dashpot.base.provenance import Source


@pytest.fixture(scope="module")
def simulated_fit() -> dp.Fit:
    return dp.fit(dp.simulate("relaxation", seed=1), arms=2)


@pytest.mark.parametrize("simulated", [False, True])
def test_prediction_table_names_a_simulation(
    tmp_path: Path, simulated_fit: dp.Fit, simulated: bool
) -> None:
    source = (Source("seal.csv", "0" * 64, simulated=simulated),)
    fit = replace(simulated_fit, provenance=replace(simulated_fit.provenance, source=source))
    prediction = dp.predict(fit, mass="114.8g", seals=2)
    text = prediction.save(tmp_path / "python.csv").read_text(encoding="utf-8")
    assert ("SIMULATED" in text) is simulated
    assert dp.read(tmp_path / "python.csv").source[0].simulated is simulated
    fit.save(tmp_path / "fit.json")
    table = tmp_path / "command.csv"
    did("predict", str(tmp_path / "fit.json"), "--mass", "114.8g", "--seals", "2", "-o", str(table))
    assert ("SIMULATED" in table.read_text(encoding="utf-8")) is simulated
