"""Figure files: SVG directly, PNG and PDF through matplotlib in the same layout."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ExportError
from dashpot.base.file_writing import write_atomic
from dashpot.base.option_fields import FigureFormat, FigureSize, get_choice_values
from dashpot.base.version import byline
from dashpot.plot.layout import Fill, Frame, Markers, Polyline, Word, arrange_sheet
from dashpot.plot.picture import Dots, Keyed, Line, Pen, Picture, Rule
from dashpot.plot.style import LIGHT
from dashpot.plot.svg import to_svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


# PNG and PDF by matplotlib, in the same layout.


INCH = 96.0
"""px of an inch, as a page counts them; a point is 4/3 of a px."""

PT = 0.75

FONTS = ["Arial", "Liberation Sans", "Helvetica", "DejaVu Sans"]


def to_figure(picture: Picture) -> Figure:
    """Return the picture as a matplotlib figure, without pyplot's global state."""
    from matplotlib.figure import Figure
    from matplotlib.font_manager import fontManager

    sheet = arrange_sheet(picture)
    figure = Figure(figsize=(picture.width / INCH, sheet.height / INCH), facecolor="white")
    ax = figure.add_axes((0, 0, 1, 1))
    ax.set(xlim=(0, picture.width), ylim=(sheet.height, 0))
    ax.set_axis_off()
    names = set(fontManager.get_font_names())
    canvas = _Canvas(ax, [name for name in FONTS if name in names])
    for x, y, layout in sheet.strips:
        for frame in layout.frames:
            canvas.frame(frame, x, y)
    for x, y, mark in sheet.legend:
        canvas.sample(mark, x, y - 4)
    for word in sheet.labels:
        canvas.word(word, 0, 0)
    return figure


class _Canvas:
    """Axes whose units are px, downwards."""

    def __init__(self, ax: Axes, fonts: list[str]) -> None:
        from matplotlib.font_manager import findfont, get_font

        self.ax, self.fonts = ax, fonts
        self.letters = [get_font(findfont(name)) for name in fonts]

    def frame(self, frame: Frame, x: float, y: float) -> None:
        """Axes, then their contents, then labels."""
        from matplotlib.patches import Rectangle

        box = frame.box
        for axis_line in frame.axis_lines:
            points = np.array([(axis_line.x0, axis_line.y0), (axis_line.x1, axis_line.y1)])
            self.line(points + np.array((x, y)), Pen(axis_line.colour, axis_line.width), None)
        corner = (x + box.x, y + box.y)
        clip = Rectangle(corner, box.width, box.height, transform=self.ax.transData)
        for mark in frame.inner:
            self.inner(mark, np.array(corner), clip)
        for word in (*frame.ticks, *frame.labels):
            self.word(word, x, y)

    def inner(self, mark: Polyline | Fill | Markers, corner: FloatArray, clip: Any) -> None:
        """Draw a mark inside the axes, clipped at them."""
        if isinstance(mark, Polyline):
            for part in mark.parts:
                self.line(part + corner, mark.pen, clip)
        elif isinstance(mark, Fill):
            for part in mark.parts:
                self.fill(part + corner, mark.colour, mark.tint, clip, hatched=mark.hatched)
        else:
            self.dots(mark.centres + corner, mark.size, mark.colour, clip, hollow=mark.hollow)

    def line(self, points: FloatArray, pen: Pen, clip: Any) -> None:
        """An unbroken curve."""
        style: Any = "-" if not pen.dashes else (0, tuple(d / pen.width for d in pen.dashes))
        (line,) = self.ax.plot(
            *points.T, color=LIGHT[pen.colour], linewidth=PT * pen.width, linestyle=style,
            solid_capstyle="butt", alpha=pen.opacity,
        )  # fmt: skip
        line.set_clip_path(clip)

    def fill(
        self, points: FloatArray, colour: str, tint: float, clip: Any, *, hatched: bool
    ) -> None:
        """A tinted area; a hatched one has lines over it."""
        from matplotlib.patches import Polygon

        is_unresolved = colour == "away"
        looks: list[dict[str, Any]] = [{"facecolor": (LIGHT[colour], tint)}]
        if hatched:
            colour_and_alpha = (LIGHT["ref" if is_unresolved else colour], 0.55)
            looks.append(
                {
                    "fill": False,
                    "edgecolor": colour_and_alpha,
                    "hatch": "\\\\" * 2 if is_unresolved else "////",
                }
            )
        for look_style in looks:
            polygon = self.ax.add_patch(Polygon(points, linewidth=0, **look_style))
            polygon.set_clip_path(clip)

    def dots(
        self, points: FloatArray, size: float, colour: str, clip: Any, *, hollow: bool
    ) -> None:
        """Discs, or rings."""
        (markers,) = self.ax.plot(
            *points.T, linestyle="none", marker="o", markersize=PT * size,
            markerfacecolor="white" if hollow else LIGHT[colour], markeredgecolor=LIGHT[colour],
            markeredgewidth=PT * 1.75 if hollow else 0,
        )  # fmt: skip
        markers.set_clip_path(clip)

    def word(self, word: Word, x: float, y: float) -> None:
        """Draw a label, without parsing mathematics in it."""
        from matplotlib.patheffects import withStroke

        anchors = {"start": "left", "middle": "center", "end": "right"}
        drawn_text = "".join(c if self._has(c) else "□" for c in word.text)
        self.ax.text(
            x + word.x, y + word.y, drawn_text, color=LIGHT[word.colour], fontsize=PT * word.size,
            fontweight="bold" if word.bold else "normal", ha=anchors[word.anchor], va="baseline",
            family=self.fonts, parse_math=False,
            path_effects=[withStroke(linewidth=2.2, foreground="white")] if word.halo else None,
        )  # fmt: skip

    def _has(self, letter: str) -> bool:
        code = ord(letter)
        return letter.isprintable() and any(font.get_char_index(code) for font in self.letters)

    def sample(self, mark: Keyed, x: float, y: float) -> None:
        """A sample of a mark, 28 px wide, about the height y."""
        if isinstance(mark, (Line, Rule)):
            self.line(np.array([(x, y), (x + 28, y)]), mark.pen, None)
        elif isinstance(mark, Dots):
            at = np.array([(x + dx, y) for dx in (6, 14, 22)])
            self.dots(at, mark.size, mark.colour, None, hollow=mark.hollow)
        else:
            corners = [(x, y - 5), (x + 28, y - 5), (x + 28, y + 5), (x, y + 5)]
            self.fill(np.array(corners), mark.colour, mark.tint, None, hatched=mark.hatched)


# Writing of a picture.


def save(
    picture: Picture, path: str | Path, *, dpi: float = 300.0, size: FigureSize | None = None
) -> None:
    """Write `picture` to `path`; the suffix gives the format: .pdf, .png or .svg.

    `size` is ``"column"``, 85 mm wide as in a journal, or ``"slide"``; else its own.

    Raises
    ------
    ExportError
        If it is no picture, the suffix names none of these, or the file cannot be written.
    """
    if not hasattr(picture, "panels"):
        raise ExportError(
            f"a {type(picture).__name__} is no picture. Draw one first: "
            'dp.plot.save(result.plot(), "figure.png")'
        )
    target = Path(path)
    try:
        write_atomic(target, render_figure(picture, target.suffix, dpi=dpi, size=size))
    except ExportError as error:
        raise ExportError(f"{target.name}: {error}") from None
    except OSError as error:
        reason = error.strerror or error
        raise ExportError(f"{target}: the figure cannot be written: {reason}") from error


def render_figure(
    picture: Picture, suffix: str, *, dpi: float = 300.0, size: FigureSize | None = None
) -> bytes:
    """Return `picture` as the file that `suffix` names: .pdf, .png or .svg.

    No date is written, so the same picture gives the same bytes. A PDF embeds TrueType fonts, as
    journals ask; the letters of an SVG stay letters.

    Raises
    ------
    ExportError
        If the suffix names none of these.
    """
    kind = suffix.lower().lstrip(".")
    picture = picture if size is None else picture.resize(size)
    if kind not in get_choice_values(FigureFormat):
        raise ExportError(
            f"a figure is written as .pdf, .png or .svg, found '{suffix or 'no suffix'}'"
        )
    if kind == "svg":
        return f"<!-- {byline('figure')} -->\n{to_svg(picture)}\n".encode()
    from matplotlib import rc_context

    metadata: dict[str, str | None] = {"Software": byline("figure")}
    if kind == "pdf":
        metadata = {"Creator": byline("figure"), "CreationDate": None}
    buffer = io.BytesIO()
    with rc_context({"pdf.fonttype": 42}):
        to_figure(picture).savefig(buffer, format=kind, dpi=dpi, metadata=metadata)
    return buffer.getvalue()
