"""The page of a lot: what it says, and nothing loaded."""

import base64
import hashlib
import re
from dataclasses import replace
from html import unescape
from itertools import product

import polars as pl
import pytest
from kit import browser

from dashpot.io.write import write_relaxation
from dashpot.lots import page as page_of_lots
from dashpot.lots.batches import batch
from dashpot.lots.page import html
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig import Rig
from dashpot.solids.table_1 import PAPER

pytestmark = pytest.mark.once

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
    return batch(place, arms=1, by=BY, jobs=1)


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
    told = r'<td class="file">[^<]*/([^<]*)</td>.*?<td class="(bad|care|good)">'
    first, second, *_ = re.findall(told, page)
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
    assert "<script" not in page
    # what is linked lies beside the page
    assert set(re.findall(r'(?:src|href)="(?!#)([^"]*)', page)) == {"lot.csv", "lot.xlsx"}
    (style,) = re.findall(r"<style>(.*?)</style>", page, re.DOTALL)
    digest = base64.b64encode(hashlib.sha256(style.encode()).digest()).decode()
    assert f"style-src 'sha256-{digest}'" in unescape(page)


def test_simulated_tests_are_stamped(lot):
    assert "SIMULATED" not in html(lot)
    origin = ["", "simulated"] + [""] * 11
    some = replace(lot, table=lot.table.with_columns(pl.Series("origin", origin)))
    assert "SIMULATED: one file<" in html(some)


def test_a_quantity_that_no_seal_has_is_no_column(lot):
    stray = lot.table["file"].str.contains("junk")
    pressed = pl.when(stray).then(2.0)
    beside = replace(lot, table=lot.table.with_columns(cld_force_N=pressed))
    assert "cld_force" in {one.name for one in beside.quantities}
    heads = re.findall(r'<th scope="col" class="n">([^<]*)', html(beside))
    assert "stiffness at once, N/mm" in heads
    assert not [one for one in heads if one.startswith("force at nominal")]


def test_without_labels_every_test_is_a_point(lot):
    nothing = lot.table["lot"].str.slice(0, 0)
    page = html(replace(lot, table=lot.table.with_columns(lot=nothing, seal=nothing)))
    assert "Stiffness at the end of the hold, N/mm: one test each" in page
    assert "Not known. Name the lot, seal and repeat of each test" in page


@browser.needs_browser
@pytest.mark.parametrize("width", [390, 1366])
def test_nothing_is_cut(lot, tmp_path, width):
    script = "return document.documentElement.scrollWidth"
    assert browser.probe(tmp_path, html(lot), script, width=width, height=800) <= width
