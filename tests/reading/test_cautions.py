"""A note that can change a number caps the verdict, and is printed; any other is not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from kit.foreign.files import format_table, press_and_hold
from kit.shell import did, run_json

import dashpot as dp
from dashpot.base.provenance import Caution, list_cautions
from dashpot.extensions.app import record_cache
from dashpot.reading.read_options import ReadOptions
from dashpot.workflow.json_archive import from_json, to_json

TIME, DISPLACEMENT, FORCE = press_and_hold(20.0)
PLAIN = "time [s];displacement [mm];force [N]"

DOUBTFUL = {
    "newtons under kN": (PLAIN.replace("[N]", "[kN]"), "kN"),
    "newtons under mN": (PLAIN.replace("[N]", "[mN]"), "mN"),
    "seconds under min": (PLAIN.replace("[s]", "[min]"), "unit of time"),
    "a row of factors": (f"factor;1;1;0.1\n{PLAIN}", "factor;1;1;0.1"),
    "a gain": (f"Gain: 10\n{PLAIN}", "Gain: 10"),
    "a gain in German": (f"Verstärkung: 10\n{PLAIN}", "Verst"),
    "a factor in German": (f"Skalierungsfaktor;0,1\n{PLAIN}", "Skalierungsfaktor;0,1"),
    "a slope": (f"Force slope = 0.1\n{PLAIN}", "slope = 0.1"),
    "a calibration": (f"# Calibration: y = 10*x\n{PLAIN}", "y = 10*x"),
    "a formula in German": (f"Kraft = Spannung * 2,5\n{PLAIN}", "Spannung * 2,5"),
    "a scale in a comment": (f"# scaling 0.5 applied by the amplifier\n{PLAIN}", "scaling 0.5"),
}
HARMLESS = {
    "nothing": PLAIN,
    "a gain of one": f"Gain: 1\n{PLAIN}",
    "a count of columns": f"1;2;3\n{PLAIN}",
    "a shape factor": f"Shape factor: 0.25\n{PLAIN}",
    "a date of calibration": f"# Calibration: 2026-01-07, certificate = 4711\n{PLAIN}",
    "a speed": f"# v = 10 mm/s, x = 8 mm\n{PLAIN}",
    "an operator": f"# operator: nobody\n{PLAIN}",
}


def test_the_type_of_a_note_tells_whether_it_can_change_a_number() -> None:
    gain = Caution('a gain; say it with --units "force=N"', "a gain")
    assert list_cautions(["200 rows", gain, gain]) == ("a gain",)
    assert gain.endswith('"force=N"')


@pytest.mark.parametrize(("head", "words"), DOUBTFUL.values(), ids=DOUBTFUL.keys())
def test_what_can_change_a_number_caps_the_verdict_and_is_printed(
    tmp_path: Path, head: str, words: str
) -> None:
    path = tmp_path / "seal.csv"
    path.write_text(format_table(head, (TIME, DISPLACEMENT, FORCE)))
    fitted = dp.fit(dp.read(path))
    assert fitted.verdict.use == "use with care"
    assert "numbers_unambiguous" in fitted.verdict.reasons
    for command in ("fit", "inspect"):
        assert words in " ".join(did(command, path).output.split())
    document = run_json("fit", path)
    check = next(check for check in document["checks"] if check["name"] == "numbers_unambiguous")
    assert check["passed"] is False
    assert words in check["message"]
    assert "--" not in check["message"]


@pytest.mark.parametrize("head", HARMLESS.values(), ids=HARMLESS.keys())
def test_what_changes_no_number_costs_nothing(tmp_path: Path, head: str) -> None:
    path = tmp_path / "seal.csv"
    path.write_text(format_table(head, (TIME, DISPLACEMENT, FORCE)))
    fitted = dp.fit(dp.read(path))
    assert fitted.verdict.use == "use"
    assert not any(check.name == "numbers_unambiguous" for check in fitted.checks)


@pytest.mark.parametrize("rate", [20.0, 100.0, 250.0])
def test_seconds_under_min_are_noted_at_any_rate(tmp_path: Path, rate: float) -> None:
    path = tmp_path / "seal.csv"
    columns = press_and_hold(rate, hold=20.0)
    path.write_text(format_table(PLAIN.replace("[s]", "[min]"), columns))
    assert dp.read(path).source.cautions
    time, *others = columns
    path.write_text(format_table(PLAIN.replace("[s]", "[min]"), (time / 60, *others)))
    assert not dp.read(path).source.cautions


def test_units_that_are_stated_do_not_tell_what_a_factor_is_of(tmp_path: Path) -> None:
    path = tmp_path / "seal.csv"
    path.write_text(format_table(f"Gain: 10\n{PLAIN}", (TIME, DISPLACEMENT, FORCE)))
    fitted = dp.fit(dp.read(path, units={"force": "N"}))
    assert {check.name for check in fitted.verdict.failed_checks} == {"numbers_unambiguous"}


def test_page_and_lot_have_the_check(tmp_path: Path) -> None:
    path = tmp_path / "seal.csv"
    path.write_text(format_table(f"Gain: 10\n{PLAIN}", (TIME, DISPLACEMENT, FORCE)))
    page = tmp_path / "fit.html"
    did("fit", path, "-o", page)
    assert "Gain: 10" in page.read_text(encoding="utf-8")
    lot = tmp_path / "lot"
    assert "use with care" in did("batch", path, "-o", lot).output
    assert "numbers_unambiguous" in (lot / "lot.csv").read_text(encoding="utf-8")


def test_saved_record_keeps_its_cautions(tmp_path: Path) -> None:
    """As JSON, by which the app keeps what it has read."""
    path = tmp_path / "seal.csv"
    path.write_text(format_table(f"Gain: 10\n{PLAIN}", (TIME, DISPLACEMENT, FORCE)))
    record = dp.read(path)
    assert from_json(to_json(record)).source == record.source
    plain = tmp_path / "plain.csv"
    plain.write_text(format_table(PLAIN, (TIME, DISPLACEMENT, FORCE)))
    assert "cautions" not in to_json(dp.read(plain))
    (tmp_path / "files" / "one").mkdir(parents=True)
    place = tmp_path / "files" / "one" / "seal.csv"
    place.write_text(path.read_text())
    for _ in range(2):  # as read, and as kept
        relaxation = record_cache.read_relaxation_test(
            str(place), options=ReadOptions(), specimen=None
        )
        assert dp.fit(relaxation).verdict.reasons == ("numbers_unambiguous",)


def test_every_kind_of_result_is_capped(tmp_path: Path) -> None:
    """A hammer file, a modulus and a sweep: the note is a check of each."""
    time = np.geomspace(1e-2, 1e3, 60)
    modulus = 1 + 0.4 * np.exp(-time / 0.3) + 0.3 * np.exp(-time / 30)
    path = tmp_path / "modulus.csv"
    path.write_text(format_table("Gain: 10\ntime [s];relaxation modulus [MPa]", (time, modulus)))
    assert "numbers_unambiguous" in [check.name for check in dp.fit(dp.read(path)).checks]
    hits = np.arange(0, 1, 1e-3)
    ring = np.exp(-10 * hits) * np.sin(80 * hits)
    pulse = 20 * np.exp(-(((hits - 0.05) / 0.002) ** 2))
    path = tmp_path / "hammer.csv"
    path.write_text(
        format_table("Gain: 10\ntime [s];force [N];acceleration [m/s^2]", (hits, pulse, ring))
    )
    assert "numbers_unambiguous" in [check.name for check in dp.fit(dp.read(path)).checks]
    assert "Gain: 10" in did("inspect", path).output
