"""Figures as files: the same bytes every time, and SVGs that share a page."""

from __future__ import annotations

import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from kit import handmade

import dashpot as dp
from dashpot import plot
from dashpot.base.errors import ExportError
from dashpot.plot import style
from dashpot.plot.picture import FIT, Line, Panel, Picture, Scale


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
    svg, two = (plot.to_svg(replace(figure, name=name)) for name in ("one", "two"))
    ids = [set(re.findall(r'\bid="([^"]*)"', text)) for text in (svg, two)]
    assert ids[0]
    assert not ids[0] & ids[1]
    assert all(name.startswith("one-") for name in ids[0])
    used = set(re.findall(r"url\(#([^)]*)\)", svg))
    assert used <= ids[0]


def test_an_svg_is_plain_xml_whose_letters_are_letters_and_whose_colours_are_of_paper(figure):
    text = plot.to_svg(replace(figure, caption='N = 2 & "more"', stamp="seal_8mm.csv"))
    root = ET.fromstring(text)  # noqa: S314
    assert root.tag.endswith("svg")
    assert root.attrib["aria-label"] == 'N = 2 & "more"'
    words = [item.text for item in root.iter("{http://www.w3.org/2000/svg}text")]
    assert {"relaxation time τ, s", "stiffness k, N/mm", "joint model"} <= set(words)
    assert "seal_8mm.csv" in words
    assert "var(" not in text
    assert "<style" not in text
    assert not any(re.search(r"\.\d{3}", path) for path in re.findall(r' d="([^"]*)"', text))


def test_what_is_drawn_in_an_svg_are_the_numbers():
    """Read back from its path, by the axes that its group names, a curve is what was given."""
    x = np.geomspace(1.0, 100.0, 40)
    y = 3.0 + np.sin(x)
    axes = Scale("f, Hz", (1.0, 100.0), log=True), Scale("y, 1", (0.0, 5.0))
    text = plot.to_svg(Picture("one", "", ((Panel(*axes, (Line(x, y, FIT, "curve"),)),),)))
    (d,) = re.findall(r'data-name="curve" d="M([^"]*)"', text)
    (box,) = re.findall(r'data-box="([^"]*)"', text)
    _, _, width, height = map(float, box.split())
    steps = np.array(re.findall(r"-?\d+", d), dtype=float).reshape(-1, 2)
    points = np.cumsum(steps, axis=0) / 20
    assert 100 ** (points[:, 0] / width) == pytest.approx(x, rel=1e-3)
    assert 5 * (1 - points[:, 1] / height) == pytest.approx(y, abs=1e-3)


def test_a_gap_in_the_data_is_a_gap_in_the_curve():
    y = np.array([1.0, 2.0, np.nan, 2.0, 1.0, np.nan, 1.0])
    axes = Scale("x, s", (0.0, 6.0)), Scale("y, N", (0.0, 3.0))
    text = plot.to_svg(Picture("g", "", ((Panel(*axes, (Line(np.arange(7.0), y, FIT, "c"),)),),)))
    (d,) = re.findall(r'data-name="c" d="([^"]*)"', text)
    assert d.count("M") == 2  # a single point is no curve


def test_a_name_that_is_no_id_is_refused(figure):
    with pytest.raises(ExportError, match="cannot begin an SVG id"):
        plot.to_svg(replace(figure, name="a b"))


@pytest.mark.parametrize("token", style.COLOURS)
def test_every_token_is_a_colour_in_both_themes(token):
    assert all(re.fullmatch(r"#[0-9a-f]{6}", colour) for colour in style.COLOURS[token])


def luminance(colour: str) -> float:
    """Of sRGB, relative to white."""
    parts = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    return float(linear @ (0.2126, 0.7152, 0.0722))


@pytest.mark.parametrize("theme", [0, 1])
@pytest.mark.parametrize(
    ("word", "paper", "least"),
    [("ink", "panel", 4.5), ("soft", "panel", 4.5), ("soft", "bg", 4.5), ("act-ink", "act", 4.5),
     ("fit", "panel", 4.5), ("good-ink", "good-bg", 4.5), ("care-ink", "care-bg", 4.5),
     ("bad-ink", "bad-bg", 4.5), ("measured", "panel", 4.5), ("bad", "panel", 3.0),
     ("joint", "panel", 3.0), ("edge", "panel", 3.0), ("ref", "panel", 3.0)],
)  # fmt: skip
def test_letters_and_curves_stand_out_in_both_themes(theme, word, paper, least):
    # WCAG 2.2: 4.5 for words, 3 for what is drawn
    a, b = sorted(luminance(style.COLOURS[name][theme]) for name in (word, paper))
    assert (b + 0.05) / (a + 0.05) >= least


def test_a_picture_saves_itself_as_plot_save_does(tmp_path):
    picture = dp.fit(dp.simulate("relaxation", hold="5s")).plot()
    picture.save(tmp_path / "own.svg", size="column")
    dp.plot.save(picture, tmp_path / "fit.svg", size="column")
    assert (tmp_path / "own.svg").read_bytes() == (tmp_path / "fit.svg").read_bytes()
    with pytest.raises(dp.ExportError, match=r"\.pdf, \.png or \.svg"):
        picture.save(tmp_path / "fit.jpg")


def test_save_refuses_an_unknown_suffix_and_lists_valid_ones(tmp_path, figure):
    with pytest.raises(ExportError, match=r"fit\.bmp: a figure is written as .pdf, .png or .svg"):
        plot.save(figure, tmp_path / "fit.bmp")
    with pytest.raises(ExportError, match="no suffix"):
        plot.save(figure, tmp_path / "fit")


def test_save_reports_a_missing_folder(tmp_path, figure):
    with pytest.raises(ExportError, match="cannot be written: No such file or directory"):
        plot.save(figure, tmp_path / "nowhere" / "fit.png")


def test_save_of_a_result_says_to_draw_it(tmp_path):
    with pytest.raises(ExportError, match=r"GeneralizedMaxwell is no picture.*result\.plot\(\)"):
        plot.save(dp.GeneralizedMaxwell(1.0), tmp_path / "a.png")
