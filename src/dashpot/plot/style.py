"""One look for every figure: sizes, pens, and how axes are dressed.

Everything is set on the artists themselves, so no global setting of matplotlib is read for a
choice made here and none is touched. Colours are those of Okabe and Ito (2008), which readers
with any colour vision tell apart; every pen also has its own dashes, for a grey print.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np

from dashpot.base.arrays import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axes._secondary_axes import SecondaryAxis
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from matplotlib.typing import LineStyleType

MM = 1 / 25.4
"""One millimetre in matplotlib's inches."""

COLUMN, PAGE = 88.0, 180.0
"""Widths of one and of two columns of a journal, mm."""

SMALL, NORMAL = 7.0, 7.5
"""Sizes of tick labels and legends, and of axis labels, points."""

# a log axis wider than this has room for few numbers, and plain ones are short in these limits
WIDE, PLAIN = 1e6, (1e-4, 1e5)

BLACK, GREY, PALE = "#000000", "#767676", "#d9d9d9"
ORANGE, SKY, GREEN, YELLOW = "#E69F00", "#56B4E9", "#009E73", "#F0E442"
BLUE, VERMILLION, PURPLE = "#0072B2", "#D55E00", "#CC79A7"

Corner: TypeAlias = Literal[
    "best", "upper right", "upper left", "lower right", "lower left", "center left"
]


@dataclass(frozen=True)
class Pen:
    """How one kind of curve is drawn, in every figure alike."""

    color: str
    dashes: LineStyleType = "-"
    width: float = 1.1


MEASURED = Pen(BLACK, "-", 0.9)
CHOSEN = Pen(BLUE, "-", 1.3)
SIMPLER = Pen(ORANGE, (0, (4.0, 1.4)), 1.3)
JOINT = Pen(VERMILLION, (0, (7.0, 1.2, 1.2, 1.2)), 1.3)
OTHERS = (
    Pen(GREEN, (0, (1.2, 1.0)), 1.3),
    Pen(PURPLE, (0, (5.0, 1.0, 1.0, 1.0, 1.0, 1.0)), 1.3),
    SIMPLER,
    Pen(SKY, (0, (2.5, 1.0)), 1.3),
)
REJECTED = Pen(VERMILLION, (0, (3.0, 1.5)), 0.8)


def pen_of_arms(arms: int, chosen: int) -> Pen:
    """The pen of a fit with that many arms: the chosen one is blue, one arm is orange."""
    if arms == chosen:
        return CHOSEN
    return SIMPLER if arms == 1 else OTHERS[arms % 2]


def figure(width: float, height: float) -> Figure:
    """An empty figure of `width` by `height`, mm, that lays its axes out by itself."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    engine = ConstrainedLayoutEngine(w_pad=0.02, h_pad=0.02, wspace=0.02, hspace=0.03)
    return Figure(figsize=(width * MM, height * MM), layout=engine, facecolor="white")


def unit_of(values: FloatArray, unit: Literal["N", "m"]) -> tuple[str, float]:
    """The word and the factor in which values, SI, read best: N, mN..., mm, µm...

    A seal stays in N and mm; the cantilever of a microscope is in nN and nm.
    """
    size = float(np.max(np.abs(values), initial=0.0))
    choices = {
        "N": (("N", 1.0), ("mN", 1e3), ("µN", 1e6), ("nN", 1e9), ("pN", 1e12)),
        "m": (("mm", 1e3), ("µm", 1e6), ("nm", 1e9)),
    }[unit]
    for word, factor in choices:
        if size * factor >= 0.1:
            return word, factor
    return choices[0] if size == 0 else choices[-1]


def plain(text: str) -> str:
    """Words from a file as they stand: no mathematics read into a dollar, no missing letter."""
    from matplotlib.font_manager import findfont, get_font

    font = get_font(findfont("DejaVu Sans"))
    known = (c if c.isprintable() and font.get_char_index(ord(c)) else "□" for c in text)
    return "".join(known).replace("$", r"\$")


def label_axes(ax: Axes, *, x: str = "", y: str = "", title: str = "") -> None:
    """Name what the axes show, as far as it is given."""
    if x:
        ax.set_xlabel(x, fontsize=NORMAL)
    if y:
        ax.set_ylabel(y, fontsize=NORMAL)
    if title:
        ax.set_title(title, fontsize=NORMAL, loc="left", fontweight="bold")


def dress(
    ax: Axes, *, x: str = "", y: str = "", title: str = "", log: Literal["", "x", "y", "xy"] = ""
) -> None:
    """Give the axes their labels, quiet spines and a pale grid; `log` ones have their limits."""
    for which in log:
        _log_axis(ax, which)
    label_axes(ax, x=x, y=y, title=title)
    ax.tick_params(which="both", labelsize=SMALL, color=GREY, direction="out")
    ax.tick_params(which="major", length=3.0, width=0.6)
    ax.tick_params(which="minor", length=1.6, width=0.4)
    for spine in ax.spines.values():
        spine.set(linewidth=0.6, color=GREY)
    ax.grid(visible=True, which="major", linewidth=0.4, color="#e6e6e6")
    ax.set_axisbelow(True)


def _log_axis(ax: Axes, which: str) -> None:
    """Make an axis logarithmic with plain numbers on it; a very wide one has powers of ten."""
    from matplotlib.ticker import FuncFormatter, LogFormatterMathtext, LogLocator, NullFormatter

    getattr(ax, f"set_{which}scale")("log")
    axis: Axis = getattr(ax, f"{which}axis")
    low, high = sorted(getattr(ax, f"get_{which}lim")())
    ratio = high / low if low > 0 else 1e3
    wide = ratio > WIDE
    plain = not wide or (PLAIN[0] <= low and high <= PLAIN[1])
    subs = (1.0,) if ratio > 200 else (1.0, 2.0, 5.0) if ratio > 8 else (1, 1.5, 2, 3, 5, 7)
    axis.set_minor_formatter(NullFormatter())
    axis.set_major_formatter(
        FuncFormatter(lambda value, _: f"{value:g}") if plain else LogFormatterMathtext()
    )
    axis.set_major_locator(LogLocator(base=10, subs=subs, numticks=6 if wide else 15))
    axis.set_minor_locator(
        LogLocator(base=10, subs=(1.0,) if wide else range(1, 10), numticks=50 if wide else 100)
    )


def legend(ax: Axes, *, loc: Corner = "best") -> None:
    """A small legend of what is labelled on these axes, if anything is."""
    if ax.get_legend_handles_labels()[0]:
        made = ax.legend(
            loc=loc,
            fontsize=SMALL,
            handlelength=2.6,
            frameon=True,
            framealpha=0.9,
            edgecolor="none",
            borderpad=0.3,
            labelspacing=0.3,
        )
        made.set_zorder(10)


def legend_above(figure: Figure, ax: Axes, *, columns: int) -> None:
    """A legend of what is labelled on these axes, above all axes of the figure."""
    handles, texts = ax.get_legend_handles_labels()
    if handles:
        figure.legend(
            handles, texts, loc="outside upper left", ncols=columns, fontsize=SMALL,
            frameon=False, handlelength=2.6, labelspacing=0.25, columnspacing=1.4,
        )  # fmt: skip


def right_axis(
    ax: Axes, label: str, to: Callable[[Any], Any], back: Callable[[Any], Any]
) -> SecondaryAxis:
    """The y axis in another unit on the right-hand side."""
    right = ax.secondary_yaxis("right", functions=(to, back))
    right.set_ylabel(label, fontsize=SMALL)
    right.tick_params(labelsize=SMALL, color=GREY, length=3.0, width=0.6)
    right.spines["right"].set(linewidth=0.6, color=GREY)
    return right


def note(
    ax: Axes,
    text: str,
    at: tuple[float, float],
    *,
    ha: Literal["left", "center", "right"] = "left",
    va: Literal["top", "center", "bottom"] = "top",
    color: str = "#333333",
) -> None:
    """A few words at a place given in fractions of the axes."""
    ax.text(
        *at, text, transform=ax.transAxes, ha=ha, va=va, fontsize=SMALL, color=color, zorder=6,
        bbox={"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none",
              "alpha": 0.8},
    )  # fmt: skip
