"""The page of a lot: what it says, and nothing loaded."""

import base64
import hashlib
import json
import re
from dataclasses import replace
from html import unescape
from itertools import product

import polars as pl
import pytest
from kit.app import chromium
from kit.browser import needs_browser, probe
from kit.lots import draw_rows, lot_of

from dashpot.extensions.batch import page as page_of_lots
from dashpot.extensions.batch.batch_run import batch
from dashpot.extensions.batch.limits import Limits
from dashpot.extensions.batch.page import html
from dashpot.extensions.batch.summary import summary
from dashpot.reading.write import write_relaxation
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import PAPER

pytestmark = pytest.mark.once


@pytest.fixture(scope="module")
def browser():
    pytest.importorskip("playwright", reason="Playwright drives the browser")
    with chromium() as browser:
        yield browser


BY = r"lot(\w+)_seal(\d+)_rep(\d+)"


@pytest.fixture(scope="module")
def lot(tmp_path_factory):
    place = tmp_path_factory.mktemp("lot")
    rig = replace(Rig(), rate=100.0)
    for seed, (of, seal, repeat) in enumerate(product("AB", range(3), range(2))):
        stiff = 1 + 0.02 * seal + 0.004 * repeat
        hold = 3.0 if (of, seal, repeat) == ("B", 2, 1) else 6.0
        made = simulate_relaxation(stiff * PAPER, rig=rig, hold_time=hold, seed=seed)
        name = f"lot{of}_seal{seal}_rep{repeat}.csv"
        (place / name).write_text(write_relaxation(made.test))
    (place / "<b>junk & co.csv").write_text("no table\nat all\n")
    return batch(place, arms=1, label_pattern=BY, jobs=1)


def test_the_page_says_what_the_lot_is(lot):
    page = html(lot, title="L24 <117>")
    assert "12 of 13 files are tests that were fitted" in page
    assert "Use with care" in page
    assert "L24 &lt;117&gt;" in page
    assert "control limits of each lot" in page
    for source in ("lot", "seal", "repeat"):
        assert re.search(
            f'<rect class="s-{source}"[^>]*></svg>{source}</th>|</svg>{source}</th>', page
        )
    assert "held for 2.97\xa0s, its lot 5.97\xa0s: left out of the statistics" in page
    assert page.count('<td class="file">') == 13
    # what was not fitted leads, then what stands out
    message = r'<td class="file">[^<]*/([^<]*)</td>.*?<td class="(bad|care|good)">'
    first, second, *_ = re.findall(message, page)
    assert first == ("&lt;b&gt;junk &amp; co.csv", "bad")
    assert second == ("lotB_seal2_rep1.csv", "care")
    assert set(re.findall(r'href="#([^"]*)', page)) <= set(re.findall(r'id="([^"]*)', page))


def test_a_page_has_so_many_rows_and_says_where_the_others_are(lot, monkeypatch):
    assert "The first" not in html(lot)
    monkeypatch.setattr(page_of_lots, "ROWS", 12)
    page = html(lot)
    assert page.count('<td class="file">') == 12
    assert "The first 12 of 13 files; all are in" in page
    monkeypatch.setattr(page_of_lots, "ROWS", 5)
    page = html(lot)
    assert page.count('<td class="file">') == 5
    assert page.count('<th scope="row" class="path">') == 5
    assert "The first 5 of 6 seals; all are in" in page


def test_what_comes_from_a_file_is_escaped_and_nothing_is_loaded(lot):
    page = html(lot)
    assert "<b>junk" not in page
    assert "&lt;b&gt;junk &amp; co.csv" in page
    # what is linked lies beside the page
    linked = set(re.findall(r'(?:src|href)="(?!#)([^"]*)', page))
    assert linked == {"lot.csv", "lot.xlsx", "lot.json"}
    for kind, result in (
        ("style", re.findall(r"<style>(.*?)</style>", page, re.DOTALL)),
        ("script", re.findall(r'<script type="module">(.*?)</script>', page, re.DOTALL)),
    ):
        (item,) = result
        digest = base64.b64encode(hashlib.sha256(item.encode()).digest()).decode()
        assert f"{kind}-src 'sha256-{digest}'" in unescape(page)
    # the rows that the script reads hold no markup, and are every file
    (rows,) = re.findall(r'<script type="application/json"[^>]*>(.*?)</script>', page, re.DOTALL)
    assert "<" not in rows
    document = json.loads(rows)
    assert next(row[0] for row in document["rows"] if "junk" in row[0]).endswith("<b>junk & co.csv")
    assert len(document["rows"]) == 13
    assert len({len(row) for row in [document["heads"], *document["rows"]]}) == 1


def many(**requested):
    """Return a lot of 500 seals in 20 lots, and what it says."""
    large = lot_of(draw_rows(lots=20, seals=25, repeats=2, **requested))
    limits = [Limits(large.quantity("k_end"), 150.0, 250.0, 1.33)]
    return large, summary(large, limits=limits)


def test_a_page_is_as_high_for_many_tests_as_for_few(lot):
    large, result = many()
    page = html(large, lot_summary=result)
    assert len(page) < 1_000_000
    # of each table so many rows, and of every chart one dot a lot
    for rows in re.findall(r"<tbody>(.*?)</tbody>", page, re.DOTALL):
        assert rows.count("<tr") <= page_of_lots.ROWS
    assert page.count("<li>") <= 3 * page_of_lots.ROWS
    assert 'data-by="lot"' in page
    assert 'data-by="seal"' in html(lot)
    (points,) = re.findall(r'data-points="([^"]*)"', page)
    assert json.loads(unescape(points)) == [[f"L{i}", ""] for i in range(1, 21)]


def test_lot_page_lists_dates_if_stated(lot):
    days = pl.Series("date", [f"2026-11-{2 + i % 2:02}" for i in range(lot.table.height)])
    every = {
        name: json.loads(re.search(r'id="every"[^>]*>(.*?)</script>', html(item), re.DOTALL)[1])
        for name, item in (
            ("dated", replace(lot, table=lot.table.with_columns(days))),
            ("bare", lot),
        )
    }
    assert "date" not in every["bare"]["heads"]
    at = every["dated"]["heads"].index("date")
    assert {row[at] for row in every["dated"]["rows"]} == {"2026-11-02", "2026-11-03"}
    # each value in a place of its own: decision and mark stay behind
    assert {len(row) for row in every["dated"]["rows"]} == {len(every["dated"]["heads"])}


def test_what_the_page_says_is_what_the_document_says():
    large, result = many()
    page, document = unescape(html(large, lot_summary=result)), result.to_dict()
    for light in document["summary"]:
        assert light["message"] in page.replace("\xa0", " ")
    assert f">{document['verdict']['verdict_grade'].capitalize()}<" in page
    (of,) = document["statistics"]
    for entry in of["capability"]:
        assert f"<b>{entry['cpk']:.2f}</b>" in page or f">{entry['cpk']:.2f}<" in page


@pytest.mark.slow
@needs_browser
def test_a_point_of_the_chart_leads_to_its_tests(browser):
    large, result = many()
    script = """
    const lines = () => [...document.querySelectorAll("#rows tbody tr")];
    const rows = () => lines().map((one) => one.cells[1].textContent);
    const first = rows().length;
    const svg = document.querySelector("[data-points] svg.wide");
    const area = svg.querySelector(".plot").getBoundingClientRect();
    const x = area.left + (4.5 / 20) * area.width;
    svg.dispatchEvent(new MouseEvent("click", { clientX: x, clientY: area.top + 9 }));
    const found = rows();
    document.getElementById("find").value = "seal 3";
    document.getElementById("find").dispatchEvent(new Event("input"));
    const opened = document.getElementById("tests").open;
    return [first, [...new Set(found)], found.length, rows().length, opened];
    """
    first, lots, of_lot, of_seal, opened = probe(
        browser, html(large, lot_summary=result), script, width=1366, height=768
    )
    assert (first, lots, of_lot, of_seal, opened) == (50, ["L5"], 50, 2, True)


def test_simulated_tests_are_stamped(lot):
    assert "SIMULATED" not in html(lot)
    origin = ["", "simulated"] + [""] * 11
    some = replace(lot, table=lot.table.with_columns(pl.Series("origin", origin)))
    assert "SIMULATED: one file<" in html(some)


def test_a_quantity_that_no_seal_has_is_no_column(lot):
    stray = lot.table["file"].str.contains("junk")
    pressed = pl.when(stray).then(2.0)
    neighbour = replace(lot, table=lot.table.with_columns(cld_force_N=pressed))
    assert "cld_force" in {quantity.name for quantity in neighbour.quantities}
    heads = re.findall(r'<th scope="col" class="n">([^<]*)', html(neighbour))
    assert "instantaneous stiffness, N/mm" in heads
    assert not [head for head in heads if head.startswith("force at nominal")]


def test_without_labels_every_test_is_a_point(lot):
    nothing = lot.table["lot"].str.slice(0, 0)
    page = html(replace(lot, table=lot.table.with_columns(lot=nothing, seal=nothing)))
    assert "Stiffness at the end of the hold, N/mm: one test each" in page
    assert "Not known. Name the lot, seal and repeat of each test" in page


@needs_browser
@pytest.mark.parametrize("width", [390, 1366])
def test_nothing_is_cut(lot, browser, width):
    script = "return document.documentElement.scrollWidth"
    assert probe(browser, html(lot), script, width=width, height=800) <= width
