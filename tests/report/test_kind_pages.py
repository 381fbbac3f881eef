"""The page of every kind: one grammar, and no light that says another thing than the verdict."""

import base64
import json
import re
import shlex
from dataclasses import replace
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from kit import handmade
from kit.fits import replace_fields
from kit.shell import ran

import dashpot as dp
from dashpot.base.checks import Check
from dashpot.base.errors import Status
from dashpot.base.reported_values import ReportedValue
from dashpot.datamodel.shift_factors import Shift, TemperatureShifts
from dashpot.extensions.materials.cld.datamodel import CLD
from dashpot.extensions.materials.cld.figure import cld as cld_figure
from dashpot.plot.layout import arrange_sheet
from dashpot.plot.picture import Tag
from dashpot.report import html
from dashpot.report.first_screen import MARK_ORDER
from dashpot.report.page_frame import VERDICT_COLOURS
from dashpot.report.result_page import (
    Topic,
    build_page_contents,
    group_by_record,
    kind_page,
    make_indicators,
    row,
)
from dashpot.solids.shift_laws import WLF
from dashpot.workflow.identification import DirectStiffness, IdentificationResult
from dashpot.workflow.json_archive import from_json

pytestmark = pytest.mark.once

S = handmade.study()


def press_specimen(scale: float = 1.0) -> dp.CLDTest:
    """One specimen, pressed and released."""
    t = np.linspace(0, 20, 800)
    x = 8 * np.sin(np.pi * t / 20)
    return dp.CLDTest(displacement=x, force=scale * x / 4, time=t, units="mm, N, s")


RESULTS = {
    "fit": lambda: S.fit,
    "prediction": lambda: dp.predict(S.fit, mass="114.8g", seals=2),
    "one specimen": lambda: dp.fit(press_specimen(), compression="6mm"),
    "pieces": lambda: dp.fit(
        press_specimen(), press_specimen(1.04), press_specimen(0.97), compression="6mm"
    ),
    "modes": lambda: dp.fit(dp.simulate("impact", hits=3)),
}


@pytest.mark.parametrize("name", RESULTS)
def test_page_of_every_kind_has_the_same_structure(name):
    result = RESULTS[name]()
    page = html(result)
    shown = kind_page(result)
    for part in ('class="who"', 'id="verdict"', 'class="lights"', 'id="numbers"', 'id="checks"'):
        assert page.count(part) == 1, part
    assert f">{result.verdict.use.capitalize()}<" in page
    worst = max((item.mark for item in shown.indicators), key=MARK_ORDER.index)
    assert (VERDICT_COLOURS[result.verdict.use] == "good") == (worst in {"good", "note"})
    (link,) = re.findall(
        rf'download="{shown.name}.json" href="data:application/json;base64,([^"]+)"', page
    )
    assert json.loads(base64.b64decode(link)) == json.loads(json.dumps(result.to_dict()))
    rows = [item for group in shown.groups for item in group.rows]
    assert rows
    assert all(quantity.value for quantity in rows)
    assert "nan" not in unescape(re.sub(r"<script.*|<style.*?</style>|href=\S+", "", page)).split()


@pytest.mark.parametrize("grade", ["note", "limit", "stop"])
@pytest.mark.parametrize("name", ["asked", "nobody_names_it"])
def test_lights_are_as_bad_as_the_worst_check(name, grade):
    # whatever part asks a question, some light shows how it was answered
    checks = (Check("sound", True, "It is."), Check(name, False, "It is not.", grade=grade))
    message = "as it should be"
    result = make_indicators(
        checks, Topic("Test", message=message), Topic("Peak", {"asked"}, message)
    )
    marks = {item.name: item.mark for item in result}
    assert marks.pop("Peak" if name == "asked" else "Test") == {
        "note": "note", "limit": "care", "stop": "bad",
    }[grade]  # fmt: skip
    assert set(marks.values()) <= {"good", "note"}
    # what is sound may say so in words; what is not never does
    message = next(check.message for check in result if (check.name == "Peak") == (name == "asked"))
    assert ("should" in message) == (grade == "note")


def test_page_row_shows_only_available_limits():
    expected = row(ReportedValue("k", 100.0, 90.0, 110.0, "N/m"))
    assert (expected.value, expected.low, expected.high, expected.unit) == (
        "0.100",
        "0.090",
        "0.110",
        "N/mm",
    )
    single, held = (
        row(ReportedValue("k", 100.0, unit="N/m")),
        row(ReportedValue.from_error("k", 100.0, 0.0, unit="N/m")),
    )
    assert (single.low, single.high) == (held.low, held.high) == ("", "")
    most = row(ReportedValue("k", 100.0, np.nan, 110.0, "N/m"))
    assert (most.low, bool(most.high)) == ("unknown", True)


def test_pieces_are_named_at_the_end_of_their_lines():
    fit = dp.fit(press_specimen(), press_specimen(1.04), press_specimen(0.97), compression="6mm")
    picture = cld_figure(fit.specimens, limits=(1.4, 1.6))
    tags = [item for item in picture.panels[0].marks if isinstance(item, Tag) and item.end]
    assert len({tag.colour for tag in tags}) == 3
    (frame,) = arrange_sheet(picture).strips[0].layout.frames
    words = {word.text: word for word in frame.labels}
    # from the top down in the order of their lines, and none upon another
    heights = [words[tag.text].y for tag in sorted(tags, key=lambda curve: -curve.y)]
    assert all(np.diff(heights) >= 14)
    assert "asked 1.4 to 1.6 N" in words
    many = cld_figure([replace(fit.specimens[0])] * 4)
    assert not [item for item in many.panels[0].marks if isinstance(item, Tag) and item.end]


def test_pieces_at_speeds_have_the_speed_at_their_line():
    clds = [specimen_at(speed) for speed in (0.1, 1.0)]
    (panel,) = cld_figure(clds).panels
    assert [item.text for item in panel.marks if isinstance(item, Tag)] == ["0.04 mm/s", "0.4 mm/s"]


def specimen_at(speed: float) -> CLD:
    t = np.linspace(0, 4 / speed, 400)
    x = 8 * (1 - np.abs(1 - 2 * t / t[-1])) * 0.1
    test = dp.CLDTest(displacement=x, force=x / 4, time=t, units="mm, N, s")
    return dp.fit(test).specimens[0]


def test_a_fit_goes_to_a_page(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    test = press_specimen()
    Path("piece.csv").write_text(
        "time [s], displacement [mm], force [N]\n"
        + "\n".join(f"{t:.4f},{x:.6f},{x / 4:.6f}"
                    for t, x in zip(test.time, 1e3 * test.displacement, strict=True)),
        encoding="utf-8",
    )  # fmt: skip
    done = ran("fit", "piece.csv", "-o", "page.html")
    assert done.exit_code == 0, done.output
    assert "next:" not in done.stderr
    assert 'id="numbers"' in Path("page.html").read_text(encoding="utf-8")
    refused = ran("fit", "piece.csv", "-o", "page.docx")
    assert refused.exit_code == 2
    assert ".json or .html" in refused.stderr


def test_page_lists_each_finding_and_file_once():
    source = S.fit.source[0]
    bad = Check("of_the_file", False, "It is not.", grade="stop")
    noted = Check("aside", False, "It is odd.", grade="note")
    checks = (*S.fit.checks, bad, noted, noted)
    fit = replace_fields(S.fit, checks=checks, source=(source, source))
    message = build_page_contents(fit)
    weighty = list(message["weighty"])
    assert weighty.count(bad) == weighty.count(noted) == 1
    assert message["title"].count(source.file) == 1


def held_in(page: str) -> dict[str, str]:
    """The files in a page."""
    return {
        name: base64.b64decode(data).decode()
        for name, data in re.findall(r'download="([^"]+)" href="data:[^;]+;base64,([^"]+)"', page)
    }


DENSE = Check("few_arms_sufficient", False, "No number of arms up to 6 follows.", grade="note")
EXPORTED = {
    "a seal": (lambda: S.fit, ["fit.json", "model.bdf", "model.inp"]),
    "a material": (lambda: replace_fields(S.fit, unit="Pa"), ["fit.json", "model.inp"]),
    "a table of arms": (
        lambda: replace_fields(S.fit, unit="Pa", status=Status.NOT_IDENTIFIED,
                        checks=(*S.fit.checks, DENSE)),
        ["fit.json", "model.inp"],
    ),
    "what is not identified": (
        lambda: replace_fields(S.fit, unit="Pa", status=Status.NOT_IDENTIFIED,
                        checks=(
                            *S.fit.checks, replace(DENSE, name="arms_supported", grade="limit")
                        )),
        ["fit.json"],
    ),
    "what must not be used": (
        lambda: replace_fields(S.fit, checks=(replace(DENSE, name="strain_small", grade="stop"),)),
        ["fit.json"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", EXPORTED)
def test_deck_of_a_page_equals_that_of_its_command(name, tmp_path):
    made, names = EXPORTED[name]
    page = html(made())
    files = held_in(page)
    assert list(dict.fromkeys(files)) == names
    (tmp_path / "fit.json").write_text(files["fit.json"])
    decks = [files[name] for name in names if name.startswith("model.")]
    commands = re.findall(r"the same as (dashpot export [^<]*)", unescape(page))
    for deck, command in zip(decks, commands, strict=True):
        words = shlex.split(command)
        result = ran("export", tmp_path / words[2], *words[3:])
        assert result.exit_code == 0, result.output
        assert result.stdout == deck
        # a material has moduli, and no length of contact
        assert (" MPa" in deck.partition("k_inf = ")[2].splitlines()[0]) == (name != "a seal")
        assert ("contact length" in deck) == (name == "a seal")


def test_what_a_page_holds_of_both_tests_is_read_by_other_commands_and_no_calmer_than_it():
    grave = Check("high_frequency_mass_agrees", False, "The mass is another.", grade="stop")
    identified = IdentificationResult(
        S.fit, DirectStiffness(S.direct), (grave,), S.static_equilibrium
    )
    (name,) = [item for item in held_in(html(identified)) if item not in {"numbers.json"}]
    retained = from_json(held_in(html(identified))[name])
    assert retained.verdict.use == identified.verdict.use == "do not use"
    assert retained._identity == S.fit._identity
    calm = IdentificationResult(S.fit, DirectStiffness(S.direct), (), S.static_equilibrium)
    assert calm._saved_result is S.fit


def test_constant_of_a_shift_law_shows_interval_or_noise_error():
    law = WLF(7.0, 120.0, 296.15)
    shifts = (Shift(283.15, 0.77, 0.01), Shift(296.15, 0.0, 0.0))
    temperature_shifts = TemperatureShifts(
        law, shifts, np.zeros((4, 4)), ("c1", "c2"), np.diag([0.01, 4.0])
    )
    for noise, title, row_ in (
        (None, "WLF about 23 °C", ("C1", "7.00", "6.80", "7.20")),
        (S.fit.estimate.covariance, "WLF about 23 °C (± noise)", ("C1", "7.00 ± 0.10", "", "")),
    ):
        estimate = replace(S.fit.estimate, noise_covariance=noise)
        shown = kind_page(replace_fields(S.fit, temperatures=temperature_shifts, estimate=estimate))
        (item,) = [group for group in shown.groups if group.title == title]
        assert item.rows[0][:4] == row_


def test_a_light_counts_its_checks_as_the_verdict_does() -> None:
    passed, noted = Check("a", True, ""), Check("b", False, "", grade="note")
    (light,) = make_indicators([passed, noted], Topic("Records"))
    assert (light.mark, light.message) == ("note", "1 check passed, 1 note")


def test_numbers_are_grouped_by_record() -> None:
    names = ("loss factor", "a.csv, impact 1: speed", "a.csv, impact 1: contact", "b.csv: speed")
    groups = group_by_record(ReportedValue(name, 1.0, unit="m") for name in names)
    assert [(group.title, [row.name for row in group.rows]) for group in groups] == [
        ("", ["loss factor"]), ("a.csv, impact 1", ["speed", "contact"]), ("b.csv", ["speed"]),
    ]  # fmt: skip
