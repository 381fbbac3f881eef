"""A picture for a column of a journal, and for a slide."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from kit.shell import ran

import dashpot as dp
from dashpot.plot.picture import FIT, Line, Panel, Picture, Scale


def draw_figure(size: str | None, columns: int = 1) -> tuple[float, str]:
    ends = np.array([0.0, 1.0])
    axes = Scale("time, s", (0, 1)), Scale("force, N", (0, 1))
    panel = Panel(*axes, (Line(ends, ends, FIT),))
    picture = Picture("p", "A line.", ((panel,),) * columns, columns=columns)
    svg = dp.plot.render_figure(picture, "svg", size=size).decode()
    return float(re.search(r'width="(\d+)"', svg)[1]), svg


def test_column_figure_is_85_mm_wide() -> None:
    for columns in (1, 3):
        width, _ = draw_figure("column", columns)
        assert width / 96 * 25.4 == pytest.approx(85, abs=0.2)


def test_strips_of_a_slide_stand_side_by_side() -> None:
    assert (draw_figure("slide")[0], draw_figure("slide", 3)[0], draw_figure(None)[0]) == (
        640,
        900,
        680,
    )


def test_column_layout_pairs_drawings_and_separates_figures() -> None:
    axes = Scale("x, m", (0, 1)), Scale("y, m", (0, 1))
    figure, shape = Panel(*axes, ()), Panel(*axes, (), drawing=True)
    picture = Picture("p", "A door.", ((figure,),) * 3 + ((shape,),) * 5, columns=3, rows=(3, 5))
    assert [(full, len(row)) for full, row in picture.strip_rows] == [(3, 3), (3, 3), (3, 2)]
    column = [(full, len(row)) for full, row in picture.resize("column").strip_rows]
    assert column == [(1, 1)] * 3 + [(2, 2), (2, 2), (2, 1)]
    # one alone has all the width of a column, and is no larger than the others where it has not
    single = replace(picture, strips=((shape,),) * 6, rows=(1, 5))
    assert [full for full, _ in single.resize("column").strip_rows] == [1, 2, 2, 2]
    assert [full for full, _ in single.strip_rows] == [3, 3, 3]


def test_letters_keep_their_size() -> None:
    letters = [
        set(re.findall(r'font-size="([\d.]+)"', draw_figure(size)[1])) for size in (None, "column")
    ]
    assert letters[0] == letters[1] != set()


def test_the_command_draws_so(tmp_path: Path) -> None:
    fit, picture = tmp_path / "fit.json", tmp_path / "frf.svg"
    dp.save(dp.fit(dp.simulate("relaxation", hold="20s", noise_free=True), arms=1), fit)
    done = ran("predict", fit, "--mass", "104g", "--plot", picture, "--size", "column")
    assert done.exit_code == 0, done.output
    assert 'width="321"' in picture.read_text()
    assert "'poster' is unknown" in ran("predict", fit, "--mass", "1g", "--size", "poster").stderr
