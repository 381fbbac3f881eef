"""Figures as values, independent of their drawing.

A `Picture` holds strips of panels; a panel holds marks in data coordinates, in the units that
people read. `svg` writes it for a page or a file, `figure_files` gives it to matplotlib for PNG and
PDF.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal, TypeAlias

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.option_fields import FigureSize
from dashpot.base.result_mixins import load_function

COLUMN = 321.0
"""px, of which 96 are an inch: the 85 mm of a journal's column."""
_SMALL = 3
"""Number of small multiples in a row of a column."""
_DRAWINGS = 2
"""Number of drawings in a row of a column."""
SLIDE, MIN_STRIP = 640.0, 300.0
"""px of a slide, and of each of the strips that stand side by side on one."""


@dataclass(frozen=True)
class Pen:
    """Style of one kind of curve, the same in every figure.

    Attributes
    ----------
    colour : str
        A token.
    width : float
        px.
    dashes : tuple of float
        On, off, ..., px; empty for a solid line.
    opacity : float
    """

    colour: str
    width: float = 1.6
    dashes: tuple[float, ...] = ()
    opacity: float = 1.0


MEASURED = Pen("measured")
FIT = Pen("fit", 2.0)
PREDICTED = Pen("fit", 2.0, (7, 4))
JOINT = Pen("joint", 3.0)
REF = Pen("ref", 1.2, (2, 3))
FIT_BAND, DATA_ON_FIT = Pen("fit", 5.5, opacity=0.55), Pen("measured", 1.3)
"""Pens of a fit, drawn as a band, and of the measurement, a thin line on it."""
SIMPLER = (Pen("ref", 1.8, (8, 3)), Pen("ref", 1.8, (3, 2)))
REJECTED = Pen("bad", 1.4, (5, 3))


def joint_pen(*, failed: bool) -> tuple[Pen, str]:
    """Return pen and name of a joint model, or of one that failed."""
    return (REJECTED, "joint model, failed") if failed else (JOINT, "joint model")


@dataclass(frozen=True, eq=False)
class Line:
    """Curve; nan interrupts it."""

    x: FloatArray
    y: FloatArray
    pen: Pen
    label: str = ""


@dataclass(frozen=True, eq=False)
class Dots:
    """Points, with error bars where there are errors."""

    x: FloatArray
    y: FloatArray
    colour: str
    label: str = ""
    size: float = 4.0
    hollow: bool = False
    error: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class Area:
    """Area between two curves: a plain tint for an interval, hatched for a bound."""

    x: FloatArray
    low: FloatArray
    high: FloatArray
    colour: str
    label: str = ""
    hatched: bool = False
    tint: float = 0.25


@dataclass(frozen=True, eq=False)
class Ring:
    """Closed outline, filled."""

    x: FloatArray
    y: FloatArray
    colour: str
    label: str = ""
    tint: float = 0.6
    hatched: bool = False


@dataclass(frozen=True)
class Span:
    """Range of the horizontal axis; hatched where it is out of reach."""

    low: float
    high: float
    colour: str
    label: str = ""
    hatched: bool = False
    tint: float = 0.12


@dataclass(frozen=True)
class Rule:
    """Straight line through the whole panel, vertical unless `is_horizontal`."""

    position: float
    pen: Pen
    label: str = ""
    is_horizontal: bool = False


@dataclass(frozen=True)
class Tag:
    """Label at a point of the data, with a dot there: filled, hollow or none.

    Those of the `end` of a curve stand to its right, as its name.
    """

    x: float
    y: float
    text: str
    colour: str
    dot: Literal["filled", "hollow", ""] = ""
    bold: bool = False
    end: bool = False


Keyed: TypeAlias = Line | Dots | Area | Ring | Span | Rule
Mark: TypeAlias = Keyed | Tag


@dataclass(frozen=True)
class Scale:
    """Scale of an axis: a quantity with its unit, and the range shown.

    An `unnumbered` one has no numbers: what stands along it is named in the panel. A `whole` scale
    counts items, and has ticks only at integers. `tick_names` replace the numbers at `ticks`.
    """

    label: str
    limits: tuple[float, float]
    log: bool = False
    ticks: tuple[float, ...] = ()
    unnumbered: bool = False
    whole: bool = False
    tick_names: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Panel:
    """Pair of axes with its marks, in drawing order.

    Attributes
    ----------
    x, y : Scale
    marks : tuple of Mark
    title : str
    height : float
        Height of the plotted part, px.
    note : str
        A few words in the upper right corner.
    square : bool
        Equal scales of x and y.
    without_y_label : bool
        No y label above the axes: it is given elsewhere.
    drawing : bool
        A drawing without axes.
    below : str
        Centred caption under a drawing.
    """

    x: Scale
    y: Scale
    marks: tuple[Mark, ...]
    title: str = ""
    height: float = 190.0
    note: str = ""
    square: bool = False
    without_y_label: bool = False
    drawing: bool = False
    below: str = ""


def _count_strips_across(row: tuple[tuple[Panel, ...], ...], columns: int) -> int:
    """Return the number of strips side by side in a row of its own."""
    if all(panel.drawing for strip in row for panel in strip):
        return columns if columns > 1 else min(len(row), _DRAWINGS)
    if columns > 1:
        return len(row)
    return _SMALL if len(row) > _SMALL else 1


@dataclass(frozen=True, eq=False, repr=False)
class Picture:
    """Figure as a value.

    Attributes
    ----------
    name : str
        Letters, digits and hyphens; prefix of ids.
    caption : str
        Text for readers who cannot see the figure.
    strips : tuple of tuple of Panel
        Panels one below the other share the horizontal axis; strips stand side by side.
    columns : int
        Number of strips in a row.
    stamp : str
        File, specimen, date, mass, and SIMULATED if so; printed on every saved figure.
    rows : tuple of int
        Strips in each row, where rows differ: small multiples stand below what they explain.
    """

    name: str
    caption: str
    strips: tuple[tuple[Panel, ...], ...]
    columns: int = 1
    stamp: str = ""
    width: float = 680.0
    rows: tuple[int, ...] = ()

    @property
    def strip_rows(self) -> tuple[tuple[int, tuple[tuple[Panel, ...], ...]], ...]:
        """The strips row by row, each row with how many would fill it."""
        columns = min(self.columns, len(self.strips))
        pairs, at = [], 0
        for count in self.rows or (len(self.strips),):
            row = self.strips[at : at + count]
            strips_across = _count_strips_across(row, columns) if self.rows else columns
            pairs += [
                (strips_across, row[i : i + strips_across])
                for i in range(0, len(row), strips_across)
            ]
            at += count
        return tuple(pairs)

    @property
    def panels(self) -> tuple[Panel, ...]:
        """All panels, in order."""
        return tuple(panel for strip in self.strips for panel in strip)

    def save(self, path: str | Path, **options: Any) -> None:
        """Write the picture: :func:`dashpot.plot.save`."""
        load_function("plot.figure_files", "save")(self, path, **options)

    def resize(self, size: FigureSize) -> Picture:
        """Return the same for a column of a journal, strips below each other, or for a slide.

        Letters keep their size, so that those of a column have 8 points on paper, and those of a
        slide can be read from the last row.
        """
        if size == "column":
            return replace(self, width=COLUMN, columns=1)
        return replace(self, width=max(SLIDE, MIN_STRIP * self.columns))

    @property
    def key(self) -> tuple[Keyed, ...]:
        """One mark for each label: first measurements, then the others in order.

        What a tag names at its line stands in no key; a tag of another panel names no line.
        """
        entries: dict[str, Keyed] = {}
        named_labels: set[str] = set()
        for panel in self.panels:
            tags = {mark.text for mark in panel.marks if isinstance(mark, Tag)}
            keyed = [mark for mark in panel.marks if not isinstance(mark, Tag) and mark.label]
            named_labels |= {mark.label for mark in keyed if mark.label in tags}
            for mark in keyed:
                entries.setdefault(mark.label, mark)
        for label in named_labels:
            del entries[label]
        return tuple(sorted(entries.values(), key=lambda mark: mark.label != "measured"))

    def __repr__(self) -> str:
        return f"Picture({self.name!r}, {len(self.panels)} panels: {self.caption!r})"

    def _repr_html_(self) -> str:
        """Show itself in a notebook."""
        text: str = load_function("plot.svg", "to_svg")(self)
        return text
