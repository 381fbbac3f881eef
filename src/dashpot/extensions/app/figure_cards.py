"""Cards of a page: their layout side by side, and shared keys."""

from __future__ import annotations

import re
from collections.abc import Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace
from typing import NamedTuple

from dashpot.extensions.app.view_models import render_template
from dashpot.plot.picture import Panel, Picture
from dashpot.plot.svg import strip, swatch
from dashpot.report.result_page import AppCard
from dashpot.report.tables import TextTable

TWO_CARDS_WIDTH, CARD_BORDER = 700.0, 18.0
"""Width of two cards side by side, and width of a card's border, px."""


class FigureCard(NamedTuple):
    """Card of a page: its title, its contents, and how many are side by side."""

    title: str
    html: str
    cards_per_row: int = 1


def draw_cards(cards: Sequence[AppCard], width: float) -> list[FigureCard]:
    """Return the figures of an extension as cards; of a titled picture the first strip only."""
    figure_cards: list[FigureCard] = []
    for title, content, cards_per_row in cards:
        if isinstance(content, Picture):
            strips = make_figure_cards(content, width)
            figure_cards += [strips[0]._replace(title=title)] if title else strips
        elif isinstance(content, TextTable):
            html = render_template("cells", head=content.head, rows=content.rows)
            figure_cards.append(FigureCard(title, html, cards_per_row))
        elif isinstance(content, str):
            figure_cards.append(FigureCard(title, content, cards_per_row))
        else:
            figure_cards.append(
                FigureCard(title, render_small_multiples(content, "shape", width), cards_per_row)
            )
    return figure_cards


def make_figure_cards(picture: Picture, width: float) -> list[FigureCard]:
    """A card for each strip of a picture, two in a row; one for more than two that are alike."""
    cards: list[FigureCard] = []
    # what is named at its line in one card is in no key of the others
    key = {mark.label for mark in picture.key}
    for row in _arrange_rows(picture):
        name = f"bench{len(cards)}"
        if len(row) > 2:
            svg = render_small_multiples([panel for (panel,) in row], name, width)
            cards.append(FigureCard(re.split("[:,]", picture.caption)[0], svg))
        else:
            cards += [
                _make_card(f"{name}-{i}", panels, width, len(row), key)
                for i, panels in enumerate(row)
            ]
    return cards


def _arrange_rows(picture: Picture) -> list[tuple[tuple[Panel, ...], ...]]:
    """Return rows of strips: all equal ones in one row, of three others the last two."""
    strips = picture.strips
    if picture.rows:
        return [row for _, row in picture.strip_rows]
    if len(strips) > 2 and _are_alike(strips):
        return [strips[i : i + 3] for i in range(0, len(strips), 3)]
    single_count = len(strips) % 2
    return [strips[:single_count]] * single_count + [
        strips[i : i + 2] for i in range(single_count, len(strips), 2)
    ]


def _are_alike(strips: tuple[tuple[Panel, ...], ...]) -> bool:
    """Return whether each is one panel, and all show the same quantity or the same marks."""
    y_labels = {panels[0].y.label for panels in strips}
    marks = {tuple(mark.label for mark in Picture("", "", (panels,)).key) for panels in strips}
    return all(len(panels) == 1 for panels in strips) and 1 in {len(y_labels), len(marks)}


def _make_card(
    name: str, panels: tuple[Panel, ...], width: float, cards_per_row: int, key: AbstractSet[str]
) -> FigureCard:
    """One strip under its title; an axis with the same label as the title is named there."""
    first, *lower_panels = panels
    has_y_label_as_title = not (first.title or first.note or first.drawing)
    title = first.title or (
        first.y.label if has_y_label_as_title else first.y.label.partition(",")[0]
    )
    drawing = (replace(first, title="", without_y_label=has_y_label_as_title), *lower_panels)
    cards_per_row = cards_per_row if width >= TWO_CARDS_WIDTH else 1
    svg = strip(
        drawing,
        name=name,
        width=(width - 8 * (cards_per_row - 1)) / cards_per_row - CARD_BORDER,
        kind="figure",
    )
    samples = [sample for sample in _make_key(drawing, name) if sample[1] in key]
    html = render_template("figure", key=samples, svg=svg, title="", note="")
    return FigureCard(title[:1].upper() + title[1:], html, cards_per_row)


def _make_key(panels: Sequence[Panel], name: str) -> list[tuple[str, str]]:
    """Return the symbol and the name of each mark."""
    key = Picture(name, "", (tuple(panels),)).key
    return [(swatch(mark, name=f"{name}-k{i}"), mark.label) for i, mark in enumerate(key)]


def render_small_multiples(panels: Sequence[Panel], name: str, width: float) -> str:
    """Panels of one kind under one key, all in a row, or two where that is too narrow."""
    panels_in_row = len(panels) if width >= TWO_CARDS_WIDTH else 2
    panel_width = (width - CARD_BORDER - 8 * (panels_in_row - 1)) / panels_in_row
    drawn = []
    for i, panel in enumerate(panels):
        (left, right), (low, high) = panel.x.limits, panel.y.limits
        panel_height = panel_width * (high - low) / (right - left) if panel.square else panel.height
        resized = replace(panel, height=min(panel.height, panel_height))
        drawn.append(strip((resized,), name=f"{name}-{i}", width=panel_width, kind="figure"))
    return render_template(
        "shapes", key=_make_key(panels, name), drawn=drawn, two=panels_in_row == 2
    )
