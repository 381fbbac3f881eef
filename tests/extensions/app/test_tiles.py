"""Layout of figure cards on the page of a file."""

from __future__ import annotations

import numpy as np
import pytest

from dashpot.extensions.app.figure_cards import _arrange_rows, make_figure_cards
from dashpot.plot.picture import Dots, Panel, Picture, Scale, Tag

X = np.array([0.0, 1.0])


def panel(quantity: str, *labels: str, tags: tuple[Tag, ...] = ()) -> Panel:
    marks = tuple(Dots(X, X, "fit", label) for label in labels)
    return Panel(Scale("time, s", (0, 1)), Scale(quantity, (0, 1)), (*marks, *tags))


@pytest.mark.parametrize(
    ("count", "beside"), [(1, [1]), (2, [2]), (3, [1, 2]), (4, [2, 2]), (5, [1, 2, 2])]
)
def test_rows_places_two_unlike_strips_side_by_side(count: int, beside: list[int]) -> None:
    strips = tuple((panel(f"quantity {i}", f"mark {i}"),) for i in range(count))
    rows = _arrange_rows(Picture("p", "words", strips))
    assert [len(row) for row in rows] == beside
    assert sum(rows, ()) == strips


@pytest.mark.parametrize(("count", "beside"), [(2, [2]), (3, [3]), (5, [3, 2])])
def test_of_alike_strips_three_do(count: int, beside: list[int]) -> None:
    strips = tuple((panel("force, N", "measured"),) for _ in range(count))
    assert [len(row) for row in _arrange_rows(Picture("p", "words", strips))] == beside


def test_of_strips_of_two_panels_no_three_do() -> None:
    strips = tuple((panel("force, N", "measured"),) * 2 for _ in range(3))
    assert [len(row) for row in _arrange_rows(Picture("p", "words", strips))] == [1, 2]


def test_what_is_named_at_its_line_is_in_no_key() -> None:
    named = panel("force, N", "own word", tags=(Tag(0.5, 0.5, "own word", "fit"),))
    picture = Picture("p", "words", ((named,), (panel("x, mm", "own word", "other word"),)))
    _, second = make_figure_cards(picture, 1000)
    key = second.html.partition("</ul>")[0]
    assert "other word" in key
    assert "own word" not in key
