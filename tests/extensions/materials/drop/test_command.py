"""dashpot predict --drop and dashpot fit of impacts, as they are typed."""

from __future__ import annotations

from pathlib import Path

import pytest
from kit.fits import a_fit
from kit.shell import ran, run_json

from dashpot.extensions.materials.drop.examples import EXAMPLES
from dashpot.solids.demo_seals import PAPER
from dashpot.solids.elastic import ElasticLaw
from dashpot.workflow.json_archive import to_json


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("slams")
    fit = a_fit(PAPER, elastic_law=ElasticLaw.linear(PAPER.k_inf, 8e-3))
    (place / "law.json").write_text(to_json(fit), encoding="utf-8")
    (place / "slam.csv").write_text(EXAMPLES["slam.csv"].write(), encoding="utf-8")
    return place


def test_predict_writes_an_impact(folder: Path, tmp_path: Path) -> None:
    page, how = tmp_path / "slam.html", ("--drop", "0.3m/s", "--mass", "200g", "--seals", "2")
    document = run_json(
        "predict", folder / "law.json", *how, "-o", page, "--plot", tmp_path / "slam.svg"
    )
    assert document["schema"] == "dashpot/slammed@2"
    force = document["values"][0]
    # of the straight law 393 x, as the table has it
    assert (force["name"], force["unit"]) == ("peak_force", "N")
    assert force["value"] == pytest.approx(3.423483, rel=1e-6)
    assert force["low"] < force["value"] < force["high"]
    assert max(document["force"]) == pytest.approx(force["value"], rel=1e-3)
    assert "peak force" in page.read_text(encoding="utf-8")
    assert "relaxed" in (tmp_path / "slam.svg").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (("--drop", "0.3m/s"), "--mass 200g"),
        (("--drop", "0.3m/s", "--mass", "200g", "--band", "1:50Hz"), "--band is for a vibration"),
        (("--drop", "0.3m/s", "--mass", "200g", "-o", "slam.csv"), ".json or .html"),
    ],
)
def test_predict_drop_command_refuses_unsuitable_options(
    folder: Path, more: tuple[str, ...], message: str
) -> None:
    done = ran("predict", folder / "law.json", *more)
    assert done.exit_code == 2
    assert message in done.stderr


# the page of the documents runs the same
@pytest.mark.slow
def test_drop_test_is_recognised_fitted_and_predicted_from(folder: Path, tmp_path: Path) -> None:
    path = tmp_path / "slam.json"
    done = ran(
        "fit", folder / "slam.csv", "--mass", "200g", "--drop", "0.3m/s", "--relaxation",
        folder / "law.json", "-o", path,
    )  # fmt: skip
    assert "recognised slam.csv: a drop test of a mass on a specimen" in done.stderr
    assert "from three impacts" in done.stdout
    document = run_json("predict", path, "--mass", "104g")
    assert document["schema"].startswith("dashpot/")
    missing = ran("fit", folder / "slam.csv")
    assert missing.exit_code == 2
    assert "--mass 200g" in missing.stderr
