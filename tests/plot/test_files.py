"""Figures as files: the same bytes every time, and SVGs that share a page."""

from __future__ import annotations

import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from kit import handmade

from dashpot import plot
from dashpot.base.errors import ExportError


def draw():
    return plot.spectrum(handmade.two_arms(), joint=handmade.joint())


@pytest.fixture(scope="module")
def figure():
    return draw()


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_the_same_figure_gives_the_same_bytes(tmp_path, figure, suffix):
    first, second = tmp_path / f"a.{suffix}", tmp_path / f"b.{suffix}"
    plot.save(figure, first, dpi=50)
    plot.save(draw(), second, dpi=50)
    assert first.read_bytes() == second.read_bytes()
    assert first.stat().st_size > 2000


def test_another_process_gives_the_same_svg(figure):
    code = (
        "from kit import handmade as h; from dashpot import plot; import sys;"
        "sys.stdout.write(plot.to_svg(plot.spectrum(h.two_arms(), joint=h.joint())))"
    )
    folder = Path(__file__).parents[1]
    other = subprocess.run(
        [sys.executable, "-X", "utf8", "-c", code], check=True, capture_output=True, cwd=folder,
        encoding="utf-8",
    ).stdout  # fmt: skip
    assert other == plot.to_svg(figure)


def test_svgs_share_a_page_without_sharing_an_id(figure):
    one, two = plot.to_svg(figure, name="one"), plot.to_svg(figure, name="two")
    ids = [set(re.findall(r'\bid="([^"]*)"', text)) for text in (one, two)]
    assert not ids[0] & ids[1]
    assert all(name.startswith("one-") for name in ids[0])
    used = set(re.findall(r'url\(#([^)]*)\)|href="#([^"]*)"', one))
    assert {a or b for a, b in used} <= ids[0]


def test_an_svg_is_plain_xml_without_date_or_remarks(figure):
    text = plot.to_svg(figure, title='N = 2 & "more"')
    root = ET.fromstring(text)  # noqa: S314
    assert root.tag.endswith("svg")
    assert root.attrib["aria-label"] == 'N = 2 & "more"'
    assert "<metadata" not in text
    assert "<!--" not in text
    assert not any(re.search(r"\.\d{3}", path) for path in re.findall(r' d="([^"]*)"', text))


def test_a_name_that_is_no_id_is_refused(figure):
    with pytest.raises(ExportError, match="cannot begin an SVG id"):
        plot.to_svg(figure, name="a b")


def test_an_unknown_suffix_is_refused_with_the_known_ones(tmp_path, figure):
    with pytest.raises(ExportError, match=r"fit\.bmp: a figure is written as .pdf, .png or .svg"):
        plot.save(figure, tmp_path / "fit.bmp")
    with pytest.raises(ExportError, match="no suffix"):
        plot.save(figure, tmp_path / "fit")


def test_a_folder_that_is_not_there_is_said(tmp_path, figure):
    with pytest.raises(ExportError, match="cannot be written: No such file or directory"):
        plot.save(figure, tmp_path / "nowhere" / "fit.png")
