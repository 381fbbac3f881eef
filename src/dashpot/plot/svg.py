"""SVG text of pictures: one drawing for each strip of a page, or one file.

Letters stay letters. Colours are custom properties of the page (`tokens.css`), so that one drawing
serves the light and the dark page; a file has them as they are on paper. Whatever is inside the
axes stands in an inner `svg` in twentieths of a px, and the group about it says its axes
(``data-x="log 6 30"``): a script can zoom it and read it off.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from html import escape

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ExportError
from dashpot.plot import style
from dashpot.plot.layout import (
    AxisLine,
    Fill,
    Frame,
    Markers,
    Polyline,
    Word,
    arrange_sheet,
    format_axis_limits,
    lay_out,
)
from dashpot.plot.picture import Dots, Keyed, Line, Panel, Pen, Picture, Rule

FINE = 20
"""Units of the inner drawing in a px."""


def strip(panels: tuple[Panel, ...], *, name: str, width: float, kind: str = "wide") -> str:
    """One strip of panels as an ``svg`` of a page, of class `kind`; ids begin with `name`."""
    sheet = lay_out(panels, width)
    size = f"{sheet.width:.0f} {sheet.height:.0f}"
    return (
        f'<svg class="{kind}" viewBox="0 0 {size}" aria-hidden="true">'
        f"{_patterns(sheet.frames, name)}"
        f"{''.join(_frame(item, name) for item in sheet.frames)}</svg>"
    )


def swatch(mark: Keyed, *, name: str) -> str:
    """Return a sample of a mark as an ``svg`` element of a page's key."""
    return (
        f'<svg viewBox="0 0 28 12" width="28" height="12" aria-hidden="true">'
        f"{_sample(mark, name)}</svg>"
    )


def to_svg(picture: Picture) -> str:
    """Return the picture as an SVG file: every strip, the key, the stamp."""
    name, sheet = validate_svg_id(picture.name), arrange_sheet(picture)
    body = [
        _patterns([f for placed_strip in sheet.strips for f in placed_strip.layout.frames], name)
    ]
    for x, y, item in sheet.strips:
        frames = "".join(_frame(frame, name) for frame in item.frames)
        body.append(f'<g transform="translate({x:.1f} {y:.1f})">{frames}</g>')
    for i, (x, y, mark) in enumerate(sheet.legend):
        sample = _sample(mark, f"{name}-{i}")
        body.append(f'<g transform="translate({x:.1f} {y - 10:.1f})">{sample}</g>')
    body += map(_word, sheet.labels)
    size = f"{picture.width:.0f} {sheet.height:.0f}"
    width, height = size.split()
    return style.on_paper(
        f'<svg xmlns="http://www.w3.org/2000/svg" role="img" aria-label="{_text(picture.caption)}" '
        f'width="{width}" height="{height}" viewBox="0 0 {size}" '
        f'font-family="{_text(style.SANS)}">'
        f'<rect width="100%" height="100%" fill="var(--panel)"/>{"".join(body)}</svg>'
    )


def validate_svg_id(name: str) -> str:
    """Return the name, if an id can begin with it."""
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9-]*", name):
        raise ExportError(f"'{name}' cannot begin an SVG id; use letters, digits and hyphens")
    return name


# -- Axes and labels ------------------------------------------------------------------------------


def _text(words: str) -> str:
    """Text escaped for XML, without characters that XML forbids."""
    return escape("".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in words))


def _hair(line: AxisLine) -> str:
    return (
        f'<path d="M{line.x0:.1f} {line.y0:.1f}L{line.x1:.1f} {line.y1:.1f}" '
        f'stroke="var(--{line.colour})"/>'
    )


def _word(word: Word) -> str:
    attributes = f' text-anchor="{word.anchor}"' if word.anchor != "start" else ""
    attributes += ' font-weight="700"' if word.bold else ""
    if word.halo:
        attributes += ' class="tag"'
        attributes += ' paint-order="stroke" stroke="var(--panel)" stroke-width="3"'
    return (
        f'<text x="{word.x:.1f}" y="{word.y:.1f}" font-size="{word.size:g}" '
        f'fill="var(--{word.colour})"{attributes}>{_text(word.text)}</text>'
    )


def _frame(frame: Frame, name: str) -> str:
    x, y, w, h = frame.box
    inner = "".join(_inner(mark, name) for mark in frame.inner)
    return (
        f'<g class="panel" data-x="{format_axis_limits(frame.panel.x)}" '
        f'data-y="{format_axis_limits(frame.panel.y)}" '
        f'data-box="{x:.2f} {y:.2f} {w:.2f} {h:.2f}" data-label="{_text(frame.panel.x.label)}|'
        f'{_text(frame.panel.y.label)}">'
        f'<g class="ticks">{"".join(map(_hair, frame.axis_lines))}'
        f"{''.join(map(_word, frame.ticks))}</g>"
        f'<svg class="plot" x="{x:.2f}" y="{y:.2f}" width="{w:.2f}" height="{h:.2f}" '
        f'viewBox="0 0 {FINE * w:.0f} {FINE * h:.0f}" preserveAspectRatio="none">{inner}</svg>'
        f"{''.join(map(_word, frame.labels))}</g>"
    )


# -- marks ----------------------------------------------------------------------------------------


def _path(parts: Iterable[FloatArray], *, is_closed: bool = False) -> str:
    """Return the data of a path: whole units, each point from the last one."""
    commands = []
    for part in parts:
        units = np.rint(FINE * part).astype(np.int64)
        steps = np.diff(units, axis=0)
        steps = steps[np.any(steps != 0, axis=1)]
        start = f"M{units[0, 0]} {units[0, 1]}"
        commands.append(
            start + (f"l{' '.join(map(str, steps.ravel().tolist()))}" if len(steps) else "")
        )
    return "".join(commands).replace(" -", "-") + "z" * is_closed


def _pen(pen: Pen) -> str:
    dashes = f' stroke-dasharray="{" ".join(f"{d:g}" for d in pen.dashes)}"' if pen.dashes else ""
    opacity_attribute = "" if pen.opacity == 1 else f' stroke-opacity="{pen.opacity:g}"'
    return f'stroke="var(--{pen.colour})" stroke-width="{pen.width:g}"{dashes}{opacity_attribute}'


FIXED_STROKE = 'vector-effect="non-scaling-stroke"'


def _inner(mark: Polyline | Fill | Markers, name: str) -> str:
    if isinstance(mark, Polyline):
        if not mark.parts:
            return ""
        read = f' data-name="{_text(mark.name)}"' if mark.name else ""
        read += f' data-edge="{mark.edge}"' if mark.edge else ""
        return f'<path{read} d="{_path(mark.parts)}" fill="none" {_pen(mark.pen)} {FIXED_STROKE}/>'
    if isinstance(mark, Fill):
        d = _path(mark.parts, is_closed=True)
        plain_path = f'<path d="{d}" fill="var(--{mark.colour})" fill-opacity="{mark.tint:g}"/>'
        lines = f'<path d="{d}" fill="url(#{name}-{mark.colour})"/>' if mark.hatched else ""
        return plain_path + lines
    units = np.rint(FINE * mark.centres).astype(np.int64)
    d = "".join(f"M{x} {y}h0" for x, y in units.tolist())
    read = f' data-name="{_text(mark.name)}"' if mark.name else ""

    def round_(size: float, colour: str, text: str = "") -> str:
        return (
            f'<path{text} d="{d}" fill="none" stroke="var(--{colour})" stroke-width="{size:g}" '
            f'stroke-linecap="round" {FIXED_STROKE}/>'
        )

    filled = round_(mark.size, mark.colour, read)
    return filled + round_(max(mark.size - 3.5, 1), "panel") if mark.hollow else filled


def _hatch(key: str, colour: str, *, spacing: int) -> str:
    """Return lines at 45 degrees; those out of reach lean the other way."""
    lean = -45 if colour == "away" else 45
    ink_name = "ref" if colour == "away" else colour
    step = 7 * spacing
    return (
        f'<pattern id="{key}" width="{step}" height="{step}" patternUnits="userSpaceOnUse" '
        f'patternTransform="rotate({lean})"><path d="M0 0V{step}" stroke="var(--{ink_name})" '
        f'stroke-opacity=".55" stroke-width="{2 * spacing}"/></pattern>'
    )


def _patterns(frames: Iterable[Frame], name: str) -> str:
    used_colours = {
        mark.colour
        for frame in frames
        for mark in frame.inner
        if isinstance(mark, Fill) and mark.hatched
    }
    patterns = "".join(
        _hatch(f"{name}-{colour}", colour, spacing=FINE) for colour in sorted(used_colours)
    )
    return f"<defs>{patterns}</defs>" if patterns else ""


# -- Legend ---------------------------------------------------------------------------------------


def _sample(mark: Keyed, name: str) -> str:
    if isinstance(mark, (Line, Rule)):
        return f'<path d="M0 6H28" fill="none" {_pen(mark.pen)}/>'
    if isinstance(mark, Dots):
        rim = f'fill="var(--panel)" stroke="var(--{mark.colour})" stroke-width="1.75"'
        body = rim if mark.hollow else f'fill="var(--{mark.colour})"'
        size = mark.size / 2
        return "".join(f'<circle cx="{x}" cy="6" r="{size:g}" {body}/>' for x in (6, 14, 22))
    tint = f'<path d="M0 1H28V11H0z" fill="var(--{mark.colour})" fill-opacity="{mark.tint:g}"/>'
    if not mark.hatched:
        return tint
    key = f"{name}-key"
    return (
        f"<defs>{_hatch(key, mark.colour, spacing=1)}</defs>{tint}"
        f'<path d="M0 1H28V11H0z" fill="url(#{key})" stroke="var(--{mark.colour})"/>'
    )
