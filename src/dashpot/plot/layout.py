"""Layout of a strip of panels in px: polylines, markers and labels.

Both `svg` and `figure_files` draw it, so a figure looks alike everywhere.
"""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.plot.picture import (
    Area,
    Dots,
    Keyed,
    Line,
    Mark,
    Panel,
    Pen,
    Picture,
    Ring,
    Rule,
    Scale,
    Span,
    Tag,
)
from dashpot.plot.style import BOLD_TEXT, SMALL_TEXT
from dashpot.plot.ticks import compute_minor_ticks, format_ticks, numbers, place

Anchor = Literal["start", "middle", "end"]

ROW = 16.0
"""Height of a row of small letters, px."""

RIGHT, GAP = 14.0, 10.0
"""Right of the axes, for half a number; between a number and its axis."""

TINT_OF_HATCH = 0.1

STRAIGHT_TOLERANCE = 0.03
"""A point so near to the line between its neighbours is left out, px; at most eight times so."""

MARGIN, PANEL_SPACING = 12.0, 20.0
"""About a file's drawing, and between its strips, px."""

LINE_SPACING = 14.0
"""Line spacing of a tag, px."""

SWATCH = 34.0
"""Distance from a sample in the key to its words, px."""


class Box(NamedTuple):
    """Rectangle, px."""

    x: float
    y: float
    width: float
    height: float


class Word(NamedTuple):
    """Text at a point; `halo` separates it from a curve behind it."""

    x: float
    y: float
    text: str
    colour: str = "soft"
    bold: bool = False
    anchor: Anchor = "start"
    halo: bool = False
    size: float = SMALL_TEXT


class AxisLine(NamedTuple):
    """Straight line of the axes."""

    x0: float
    y0: float
    x1: float
    y1: float
    colour: str
    width: float = 1.0


class Polyline(NamedTuple):
    """Curves inside the axes, from their upper left corner, px; one array per unbroken part.

    `name` and `edge` are the labels for a cursor.
    """

    parts: tuple[FloatArray, ...]
    pen: Pen
    name: str = ""
    edge: str = ""


class Fill(NamedTuple):
    """Filled area inside the axes."""

    parts: tuple[FloatArray, ...]
    colour: str
    tint: float
    hatched: bool = False


class Markers(NamedTuple):
    """Markers inside the axes."""

    centres: FloatArray
    size: float
    colour: str
    hollow: bool = False
    name: str = ""


class Frame(NamedTuple):
    """Panel in px: axes, contents and labels."""

    panel: Panel
    box: Box
    inner: tuple[Polyline | Fill | Markers, ...]
    axis_lines: tuple[AxisLine, ...]
    ticks: tuple[Word, ...]
    labels: tuple[Word, ...]


class StripLayout(NamedTuple):
    """Layout of a strip."""

    width: float
    height: float
    frames: tuple[Frame, ...]


class PlacedStrip(NamedTuple):
    """Strip on a sheet, with its upper left corner, px."""

    x: float
    y: float
    layout: StripLayout


class Sheet(NamedTuple):
    """Picture as a file: its strips, the samples of its key, and labels."""

    height: float
    strips: tuple[PlacedStrip, ...]
    legend: tuple[tuple[float, float, Keyed], ...]
    labels: tuple[Word, ...]


@cache
def text_width(text: str, *, bold: bool = False) -> float:
    """About how long some words are, px: widths of Arial, by groups of letters."""
    groups = {"fijl.,:;'|!It ()[]/": 0.28, "rs-ckvxyz": 0.48, "mMW%@": 0.85, "ABCDGHKNOQRUVX": 0.7}
    sizes = {letter: width for group, width in groups.items() for letter in group}
    return SMALL_TEXT * sum(sizes.get(letter, 0.56) for letter in text) * (1.06 if bold else 1.0)


def lay_out(strip: tuple[Panel, ...], width: float) -> StripLayout:
    """Return the places of a strip `width` px wide."""
    ticks = [[] if panel.drawing else _list_vertical_numbers(panel) for panel in strip]
    widest = max((text_width(word) for tick in ticks for _, word in tick), default=0.0)
    left_margin = 0.0 if all(panel.drawing for panel in strip) else GAP + widest
    inner_width = width - left_margin - RIGHT
    frames, y = [], 0.0
    for i, panel in enumerate(strip):
        last = i == len(strip) - 1
        names_height = y + (ROW + 4) * bool(panel.title)
        has_y_label = not (panel.drawing or panel.without_y_label)
        top_margin = 4 + ROW * (has_y_label + _count_note_rows(panel, inner_width))
        box = Box(left_margin, names_height + top_margin, inner_width, panel.height)
        shown_panel, at = panel, ticks[i]
        if panel.square:
            shown_panel = _equalise_scales(panel, inner_width)
            at = [] if panel.drawing else _list_vertical_numbers(shown_panel)
        frames.append(_lay_out_frame(shown_panel, box, at, with_name=last))
        y = box.y + box.height + (_compute_height_below(panel) if last else 10)
    return StripLayout(width, y, tuple(frames))


def _compute_height_below(panel: Panel) -> float:
    """Return the height of numbers and texts below a panel, px."""
    lines = panel.below.count("\n") + 1 if panel.below else 0
    return 10 + ROW * lines if panel.drawing else 2 * ROW + 6


def _list_vertical_numbers(panel: Panel) -> list[tuple[float, str]]:
    """Return the numbers of the upright axis, and how they are written."""
    if panel.y.unnumbered:
        return []
    at = numbers(panel.y, panel.height, 22 if panel.y.log or panel.height < 110 else 30)
    return list(zip(at, format_ticks(panel.y, at), strict=True))


def arrange_sheet(picture: Picture) -> Sheet:
    """Return the layout of a figure file: strips in rows, key, stamp."""
    y, strips = MARGIN, []
    for columns, panel_groups in picture.strip_rows:
        strip_width = (picture.width - 2 * MARGIN - PANEL_SPACING * (columns - 1)) / columns
        row = [lay_out(group, strip_width) for group in panel_groups]
        strips += [
            PlacedStrip(MARGIN + i * (strip_width + PANEL_SPACING), y, layout)
            for i, layout in enumerate(row)
        ]
        y += max(layout.height for layout in row)
    x, y, key, words = MARGIN, y + ROW, [], []
    for mark in picture.key:
        key_width = SWATCH + text_width(mark.label) + 16
        if x + key_width > picture.width and x > MARGIN:
            x, y = MARGIN, y + ROW + 2
        key.append((x, y, mark))
        words.append(Word(x + SWATCH, y, mark.label))
        x += key_width
    if picture.stamp:
        y += (ROW + 6) * bool(key)
        for i, line in enumerate(_wrap_text(picture.stamp, picture.width - 2 * MARGIN)):
            y += ROW * bool(i)
            words.append(Word(MARGIN, y, line))
    return Sheet(y + MARGIN, tuple(strips), tuple(key), tuple(words))


def _equalise_scales(panel: Panel, width: float) -> Panel:
    """Return the panel with the limits of one axis widened until both have one scale."""
    (x0, x1), (y0, y1) = panel.x.limits, panel.y.limits
    unit = max((x1 - x0) / width, (y1 - y0) / panel.height)

    def widen_limits(low: float, high: float, length: float) -> tuple[float, float]:
        midpoint, half_range = (low + high) / 2, unit * length / 2
        return midpoint - half_range, midpoint + half_range

    return replace(
        panel,
        x=replace(panel.x, limits=widen_limits(x0, x1, width)),
        y=replace(panel.y, limits=widen_limits(y0, y1, panel.height)),
    )


def _lay_out_frame(
    panel: Panel, box: Box, vertical_numbers: list[tuple[float, str]], *, with_name: bool
) -> Frame:
    """One panel; `with_name` adds numbers and a label to the horizontal axis."""
    axis_lines: list[AxisLine] = []
    ticks: list[Word] = []
    words = _make_panel_words(panel, box)
    if not panel.drawing:
        numbered = _make_horizontal_numbers(panel.x, box)
        axis_lines, ticks = _lay_out_axes(panel, box, vertical_numbers, numbered)
        if with_name:
            ticks += numbered
            label_y = box.y + box.height + 34
            words.append(Word(box.x + box.width / 2, label_y, panel.x.label, anchor="middle"))
    inner = tuple(item for mark in panel.marks for item in _lay_out_mark(mark, panel, box))
    tags = [mark for mark in panel.marks if isinstance(mark, Tag)]
    return Frame(
        panel,
        box,
        inner,
        tuple(axis_lines),
        tuple(ticks),
        (*words, *_place_tags(tags, panel, box, inner)),
    )


def _lay_out_axes(
    panel: Panel, box: Box, vertical_numbers: list[tuple[float, str]], numbered: list[Word]
) -> tuple[list[AxisLine], list[Word]]:
    """Return the lines of both axes, and the numbers of the upright one."""
    bottom, right = box.y + box.height, box.x + box.width
    heights = [bottom - box.height * float(place(panel.y, value)) for value, _ in vertical_numbers]
    axis_lines = [AxisLine(box.x, y, right, y, "line") for y in heights]
    axis_lines.append(AxisLine(box.x, bottom, right, bottom, "edge"))
    axis_lines += [AxisLine(word.x, bottom, word.x, bottom + 5, "edge") for word in numbered]
    small = box.x + box.width * place(panel.x, compute_minor_ticks(panel.x))
    axis_lines += [AxisLine(x, bottom, x, bottom + 3, "edge") for x in small]
    ticks = [
        Word(box.x - 6, y + 4, word, anchor="end")
        for y, (_, word) in zip(heights, vertical_numbers, strict=True)
    ]
    return axis_lines, ticks


def _wrap_note(panel: Panel, width: float) -> list[str]:
    """Return the note in lines, each no wider than the axes."""
    return _wrap_text(panel.note, width) if panel.note else []


def _count_note_rows(panel: Panel, width: float) -> int:
    """Rows of a note over the one that names the upright axis, beside which a short one stands."""
    lines = _wrap_note(panel, width)
    if panel.without_y_label or panel.drawing:
        return len(lines) if panel.drawing else 0
    needed_width = text_width(panel.y.label) + text_width(panel.note) + RIGHT
    return 0 if not lines or needed_width <= width + 4 else len(lines)


def _wrap_text(text: str, width: float) -> list[str]:
    """Return text in lines of limited width, px, broken at spaces."""
    lines = [""]
    # a number stays with its unit
    for word in re.findall(r"(?:\S*\d (?=[a-zA-Z%°µ]))?\S+\s*", text):
        if lines[-1] and text_width((lines[-1] + word).rstrip()) > width:
            lines.append("")
        lines[-1] += word
    return [line.rstrip(" ·") for line in lines]


def _make_panel_words(panel: Panel, box: Box) -> list[Word]:
    """Return the labels above the axes: y label, title, note."""
    words = (
        []
        if panel.without_y_label or panel.drawing
        else [Word(box.x - 4, box.y - 6, panel.y.label)]
    )
    for i, line in enumerate(panel.below.split("\n") if panel.below else ()):
        at = box.x + box.width / 2, box.y + box.height + ROW * (i + 1)
        has_heading = i == 0 and "\n" in panel.below
        words.append(Word(*at, line, "ink" if has_heading else "soft", has_heading, "middle"))
    rows = _count_note_rows(panel, box.width)
    if panel.title:
        title_y = -6 if panel.drawing and not panel.note else -8 - ROW * (rows or 1)
        if rows and not panel.drawing:
            title_y -= ROW
        words.append(Word(0, box.y + title_y, panel.title, "ink", bold=True, size=BOLD_TEXT))
    lines = _wrap_note(panel, box.width)
    title_height = ROW * (len(lines) if rows and not panel.drawing else len(lines) - 1)
    for i, line in enumerate(lines):
        words.append(
            Word(box.x + box.width, box.y - 6 - title_height + ROW * i, line, anchor="end")
        )
    return words


def _make_horizontal_numbers(scale: Scale, box: Box) -> list[Word]:
    """Return the numbers below the horizontal axis."""
    at = numbers(scale, box.width, 46)
    positions = box.x + box.width * place(scale, at)
    return [
        Word(x, box.y + box.height + 18, word, anchor="middle")
        for x, word in zip(positions, format_ticks(scale, at), strict=True)
    ]


def _convert_to_px(panel: Panel, box: Box, x: FloatArray, y: FloatArray) -> FloatArray:
    """Data to px from the upper left corner of the axes, shape (n, 2); far ones brought near."""
    horizontal = box.width * place(panel.x, x)
    vertical = box.height * (1 - place(panel.y, y))
    far_limit = 4 * (box.width + box.height)
    return np.column_stack(
        [np.clip(horizontal, -far_limit, far_limit), np.clip(vertical, -far_limit, far_limit)]
    )


def _clip_to_axis(panel: Panel, x: FloatArray, *rows: FloatArray) -> tuple[FloatArray, ...]:
    """Return the part of a curve that runs between the limits of its axis, and one point beyond."""
    low, high = panel.x.limits
    if len(x) < 2 or not np.all(np.diff(x) > 0):
        return (x, *rows)
    start, stop = np.searchsorted(x, low) - 1, np.searchsorted(x, high, "right") + 1
    visible = slice(max(int(start), 0), int(stop))
    return (x[visible], *(row[visible] for row in rows))


def _split_at_gaps(points: FloatArray) -> tuple[FloatArray, ...]:
    """Return the unbroken parts of a curve, each of two points or more."""
    values = np.isfinite(points).all(axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate(([False], values, [False])).astype(np.int8)))
    pairs = zip(edges[::2], edges[1::2], strict=True)
    return tuple(simplify_line(points[start:stop]) for start, stop in pairs if stop - start > 1)


def simplify_line(points: FloatArray) -> FloatArray:
    """Return a curve without points within `STRAIGHT_TOLERANCE` of the line between neighbours."""
    for first in (1, 2) * 4:
        i = np.arange(first, len(points) - 1, 2)
        if not len(i):
            break
        chord, offset = points[i + 1] - points[i - 1], points[i] - points[i - 1]
        size = np.hypot(*chord.T)
        cross = np.abs(chord[:, 0] * offset[:, 1] - chord[:, 1] * offset[:, 0])
        # between its neighbours, not beyond them: a spike has a short chord
        inner = (chord * offset).sum(axis=1)
        straight = (cross <= STRAIGHT_TOLERANCE * size) & (inner >= 0) & (inner <= size**2)
        points = np.delete(points, i[straight], axis=0)
    return points


def _lay_out_mark(mark: Mark, panel: Panel, box: Box) -> list[Polyline | Fill | Markers]:
    if isinstance(mark, Line):
        points = _convert_to_px(panel, box, *_clip_to_axis(panel, mark.x, mark.y))
        return [Polyline(_split_at_gaps(points), mark.pen, mark.label)]
    if isinstance(mark, Dots):
        return _lay_out_dots(mark, panel, box)
    if isinstance(mark, Area):
        return _lay_out_area(mark, panel, box)
    if isinstance(mark, Ring):
        points = _convert_to_px(panel, box, mark.x, mark.y)
        return [Fill((points,), mark.colour, mark.tint, mark.hatched)]
    if isinstance(mark, Span):
        x = np.clip(box.width * place(panel.x, (mark.low, mark.high)), 0, box.width)
        y = (0.0, box.height)
        corners = np.array([(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])])
        return [Fill((corners,), mark.colour, mark.tint, mark.hatched)] if x[1] > x[0] else []
    if isinstance(mark, Rule):
        at = float(place(panel.y if mark.is_horizontal else panel.x, mark.position))
        if not 0 <= at <= 1:
            return []
        w, h = box.width, box.height
        ends = (
            [(0, h * (1 - at)), (w, h * (1 - at))]
            if mark.is_horizontal
            else [(w * at, 0), (w * at, h)]
        )
        return [Polyline((np.array(ends, dtype=float),), mark.pen)]
    return [
        Markers(
            _convert_to_px(panel, box, *_get_tag_position(mark)),
            9.0,
            mark.colour,
            mark.dot == "hollow",
        )
    ] * bool(mark.dot)


def _get_tag_position(tag: Tag) -> tuple[FloatArray, FloatArray]:
    return np.array([tag.x]), np.array([tag.y])


def _lay_out_dots(mark: Dots, panel: Panel, box: Box) -> list[Polyline | Fill | Markers]:
    centres = _convert_to_px(panel, box, mark.x, mark.y)
    values = np.isfinite(centres).all(axis=1)
    shapes: list[Polyline | Fill | Markers] = []
    if mark.error is not None:
        low, high = (_convert_to_px(panel, box, mark.x, mark.y + s * mark.error) for s in (-1, 1))
        bars = tuple(np.array(pair) for pair in zip(low[values], high[values], strict=True))
        shapes.append(Polyline(bars, Pen(mark.colour, 1.0)))
    return [*shapes, Markers(centres[values], mark.size, mark.colour, mark.hollow, mark.label)]


def _lay_out_area(mark: Area, panel: Panel, box: Box) -> list[Polyline | Fill | Markers]:
    x, *edges = _clip_to_axis(panel, mark.x, mark.low, mark.high)
    edge_points = [_convert_to_px(panel, box, x, edge) for edge in edges]
    values = np.isfinite(edge_points).all(axis=(0, 2))
    low, high = (simplify_line(edge[values]) for edge in edge_points)
    ring = np.concatenate([low, high[::-1]])
    tint = TINT_OF_HATCH if mark.hatched else mark.tint
    shapes: list[Polyline | Fill | Markers] = [Fill((ring,), mark.colour, tint, mark.hatched)]
    if mark.label:
        thin_pen = Pen(mark.colour, 0.8 if mark.hatched else 0.4)
        shapes += [
            Polyline((edge,), thin_pen, mark.label, edge_name)
            for edge, edge_name in ((low, "low"), (high, "high"))
        ]
    return shapes


# -- Labels of points -----------------------------------------------------------------------------


def _place_tags(
    tags: list[Tag], panel: Panel, box: Box, inner: tuple[Polyline | Fill | Markers, ...]
) -> list[Word]:
    """Labels beside their points, inside the axes, clear of each other, and best of all else."""
    drawn_points = _sample_curves(inner, box) if tags else np.zeros((0, 2))
    tag_points = [
        _convert_to_px(panel, box, *_get_tag_position(tag))[0] + (box.x, box.y) for tag in tags
    ]
    boxes = [Box(x - 5, y - 5, 10, 10) for tag, (x, y) in zip(tags, tag_points, strict=True)
             if not tag.end]  # fmt: skip
    # what reaches beyond the sheet stands further in, upon its own curve
    right_limit = box.x + box.width + RIGHT + 2
    placed_words = [
        Word(min(x + 6, right_limit - text_width(tag.text, bold=tag.bold)), y, tag.text, tag.colour,
             tag.bold, halo=True)
        for tag, x, y in _place_end_names(tags, tag_points)
    ]  # fmt: skip
    boxes += map(_get_word_box, placed_words)
    for tag, (x, y) in zip(tags, tag_points, strict=True):
        if tag.end:
            continue
        near_spots: list[_Spot] = [
            (x + 10, y + 4, "start"), (x - 10, y + 4, "end"), (x + 10, y - 10, "start"),
            (x - 10, y - 10, "end"), (x, y - 12, "middle"), (x + 14, y + 21, "start"),
            (x - 14, y + 21, "end"),
        ]  # fmt: skip
        if not tag.dot:
            # beneath the words of the point that it shares
            near_spots = [*near_spots[5:7], *near_spots]
        far_spots: list[_Spot] = [
            (box.x + box.width - 4, y - 10, "end"), (box.x + 4, y - 10, "start"),
            (box.x + box.width - 4, y + 21, "end"), (box.x + 4, y + 21, "start"),
        ]  # fmt: skip
        layout = [
            _place_tag_lines(
                tag,
                lines,
                near_spots,
                far_spots,
                _Surroundings(box, boxes, drawn_points, _get_hatched_rings(inner, box)),
            )
            for lines in dict.fromkeys(((tag.text,), tuple(_split_in_two_lines(tag.text))))
        ]
        # in two lines only where one is too long, or more runs through it
        words, _ = min(layout, key=lambda pair: pair[1])
        boxes += map(_get_word_box, words)
        placed_words += words
    return placed_words


_Spot: TypeAlias = tuple[float, float, Anchor]


class _Surroundings(NamedTuple):
    """Obstacles for words: the ends of the axes, other words, curves and hatched areas."""

    box: Box
    boxes: list[Box]
    points: FloatArray
    hatched: list[FloatArray]


def _split_in_two_lines(text: str) -> list[str]:
    """Words in two lines, about as long."""
    # a number stays with its unit
    at = [match.start() for match in re.finditer(r"(?<!\d) ", text)]
    if not at:
        return [text]
    middle = min(at, key=lambda index: abs(index - len(text) / 2))
    return [text[:middle], text[middle + 1 :]]


def _place_tag_lines(
    tag: Tag,
    lines: tuple[str, ...],
    near_spots: list[_Spot],
    far_spots: list[_Spot],
    surroundings: _Surroundings,
) -> tuple[list[Word], tuple[float, int]]:
    """Return the words of a tag in lines at the best of its places, and how bad that is."""

    def words(spot: _Spot) -> list[Word]:
        # what stands above its point ends there
        x, y, anchor = spot
        y -= LINE_SPACING * (len(lines) - 1) * (y < near_spots[0][1])
        return [
            Word(x, y + LINE_SPACING * i, line, tag.colour, tag.bold, anchor, halo=True)
            for i, line in enumerate(lines)
        ]

    def is_clear(placed_words: list[Word]) -> bool:
        return all(
            _is_free_box(_get_word_box(word), surroundings.box, surroundings.boxes)
            for word in placed_words
        )

    def count_crossings(placed_words: list[Word]) -> int:
        return sum(
            _count_crossed_points(_get_word_box(word), surroundings.points)
            + _count_points_inside(_get_word_box(word), surroundings.hatched)
            for word in placed_words
        )

    free = [group for group in map(words, near_spots) if is_clear(group)]
    if free:
        best = min(free, key=count_crossings)
        return best, (0.0, count_crossings(best))
    far_words = next((group for group in map(words, far_spots) if is_clear(group)), None)
    if far_words is not None:
        return far_words, (0.5, count_crossings(far_words))
    # where nothing is clear of the others, what stays inside is read
    overhangs = [
        max(_compute_overhang(_get_word_box(word), surroundings.box) for word in words(spot))
        for spot in near_spots
    ]
    smallest_overhang = min(overhangs)
    return words(near_spots[overhangs.index(smallest_overhang)]), (1.0 + smallest_overhang, 0)


def _sample_curves(inner: tuple[Polyline | Fill | Markers, ...], box: Box) -> FloatArray:
    """Places that curves run through, and about which hatched areas end, every few px."""
    parts = [
        part
        for mark in inner
        if isinstance(mark, Polyline) or (isinstance(mark, Fill) and mark.hatched)
        for part in mark.parts
    ]
    arrays = [np.zeros((0, 2))]
    for part in parts:
        path_length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(part, axis=0).T))])
        at = np.arange(0.0, path_length[-1], 5.0)
        arrays.append(np.column_stack([np.interp(at, path_length, part[:, i]) for i in (0, 1)]))
    return np.asarray(np.concatenate(arrays) + np.array([box.x, box.y]))


def _get_hatched_rings(inner: tuple[Polyline | Fill | Markers, ...], box: Box) -> list[FloatArray]:
    """Return the rings within which something is hatched."""
    hatches = (mark for mark in inner if isinstance(mark, Fill) and mark.hatched)
    return [part + np.array((box.x, box.y)) for hatch in hatches for part in hatch.parts]


def _count_crossed_points(box: Box, points: FloatArray) -> int:
    """Return by how much the drawing overlaps some labels."""
    x, y = points.T
    is_across = (x > box.x) & (x < box.x + box.width)
    return int(np.count_nonzero(is_across & (y > box.y + 2) & (y < box.y + box.height - 2)))


def _count_points_inside(box: Box, rings: list[FloatArray]) -> int:
    """Return how many places along the middle of some words lie inside rings, every few px."""
    x = np.arange(box.x, box.x + box.width + 1e-9, 5.0)[:, None]
    y, count = box.y + box.height / 2, 0
    for ring in rings:
        (x0, y0), (x1, y1) = ring.T, np.roll(ring, -1, axis=0).T
        # as many sides to the right of a place as make it lie inside
        sides = (y0 > y) != (y1 > y)
        run = np.divide(x1 - x0, y1 - y0, out=np.zeros_like(x0), where=sides)
        count += int(np.count_nonzero(np.sum(sides & (x < x0 + (y - y0) * run), axis=1) % 2))
    return count


def _place_end_names(
    tags: list[Tag], tag_points: list[FloatArray]
) -> list[tuple[Tag, float, float]]:
    """Return the names at the ends of curves from the top down, none upon another.

    Those that are too near to stand where their curves end keep their order, about their middle.
    """
    curve_ends = [
        (tag, float(x), float(y) + 4)
        for tag, (x, y) in zip(tags, tag_points, strict=True)
        if tag.end
    ]
    crowds: list[list[tuple[Tag, float, float, float]]] = []
    for tag, x, y in sorted(curve_ends, key=lambda pair: pair[2]):
        word_width = text_width(tag.text, bold=tag.bold)
        for group in crowds:
            last, at, _, lowest = group[-1]
            is_beside = x > at + text_width(last.text, bold=last.bold) or at > x + word_width
            if not is_beside and y < lowest + ROW - 1:
                group.append((tag, x, y, lowest + ROW - 1))
                break
        else:
            crowds.append([(tag, x, y, y)])
    pairs = []
    for group in crowds:
        shift = sum(value - y for _, _, y, value in group) / len(group)
        pairs += [(tag, x, value - shift) for tag, x, _, value in group]
    return pairs


def _is_free_box(word_box: Box, box: Box, boxes: list[Box]) -> bool:
    """Return whether some labels lie inside the axes without overlap."""
    is_between = (
        box.x - 2 <= word_box.x and word_box.x + word_box.width <= box.x + box.width + RIGHT
    )
    is_inside = box.y - 4 <= word_box.y <= box.y + box.height - ROW
    return is_between and is_inside and not any(_overlap(word_box, other) for other in boxes)


def _get_word_box(word: Word) -> Box:
    word_width = text_width(word.text, bold=word.bold)
    left_edge = word.x - {"start": 0.0, "middle": 0.5, "end": 1.0}[word.anchor] * word_width
    return Box(left_edge, word.y - 12, word_width, ROW)


def _compute_overhang(word_box: Box, box: Box) -> float:
    """Return how far some words reach out of the axes on either side, px."""
    right = word_box.x + word_box.width - box.x - box.width - RIGHT
    return max(box.x - word_box.x, 0.0) + max(right, 0.0)


def _overlap(first: Box, second: Box) -> bool:
    separate = (
        first.x + first.width < second.x
        or second.x + second.width < first.x
        or first.y + first.height < second.y
        or second.y + second.height < first.y
    )
    return not separate


def format_axis_limits(scale: Scale) -> str:
    """Return an axis as a page's script reads it: its kind and its limits."""
    return f"{'log' if scale.log else 'lin'} {scale.limits[0]:.8g} {scale.limits[1]:.8g}"
