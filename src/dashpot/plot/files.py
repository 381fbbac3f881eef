"""A figure to a file, or to SVG text for a page."""

from __future__ import annotations

import io
import re
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from dashpot.base.atomic import write_whole
from dashpot.base.errors import ExportError
from dashpot.base.version import byline

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = ("pdf", "png", "svg")


def save(figure: Figure, path: str | Path, *, dpi: float = 300.0) -> None:
    """Write `figure` to `path`; the suffix says how: .pdf, .png or .svg.

    Raises
    ------
    ExportError
        If the suffix names none of these, or the file cannot be written.
    """
    target = Path(path)
    try:
        write_whole(target, rendered(figure, target.suffix, dpi=dpi))
    except ExportError as error:
        raise ExportError(f"{target.name}: {error}") from None
    except OSError as error:
        reason = error.strerror or error
        raise ExportError(f"{target}: the figure cannot be written: {reason}") from error


def rendered(figure: Figure, suffix: str, *, dpi: float = 300.0) -> bytes:
    """Return `figure` as the file that `suffix` names: .pdf, .png or .svg.

    No date is written and the layout is settled once, so the same figure gives the same bytes
    however often it is written. A PDF embeds TrueType fonts,
    as journals ask; an SVG draws its letters as paths, so that it looks alike everywhere.

    Raises
    ------
    ExportError
        If the suffix names none of these.
    """
    from matplotlib import rc_context

    kind = suffix.lower().lstrip(".")
    if kind not in FORMATS:
        raise ExportError(
            f"a figure is written as .pdf, .png or .svg, found '{suffix or 'no suffix'}'"
        )
    if kind == "svg":
        return f"<!-- {byline('figure')} -->\n{to_svg(figure)}\n".encode()
    _settle(figure)
    by: dict[str, str | None] = {"Software": byline("figure")}
    if kind == "pdf":
        by = {"Creator": byline("figure"), "CreationDate": None}
    buffer = io.BytesIO()
    with rc_context({"pdf.fonttype": 42}):
        figure.savefig(buffer, format=kind, dpi=dpi, metadata=by)
    return buffer.getvalue()


def to_svg(figure: Figure, *, name: str = "figure", title: str = "") -> str:
    """The figure as SVG text without XML header, to be placed inside an HTML page.

    The same figure always gives the same text. Every id begins with `name`, so that several
    figures live in one page as long as their names differ.

    Parameters
    ----------
    figure : Figure
    name : str
        Letters, digits and hyphens.
    title : str
        What a screen reader says in place of the picture.
    """
    from matplotlib import rc_context

    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9-]*", name):
        raise ExportError(f"'{name}' cannot begin an SVG id; use letters, digits and hyphens")
    _settle(figure)
    buffer = io.StringIO()
    with rc_context({"svg.hashsalt": "dashpot", "svg.fonttype": "path", "svg.id": None}):
        metadata = {"Date": None, "Creator": None, "Format": None, "Type": None}
        figure.savefig(buffer, format="svg", metadata=metadata)
    text = buffer.getvalue()
    text = text[text.index("<svg") :].rstrip()
    text = re.sub(r"\s*<metadata>.*?</metadata>|\s*<!--.*?-->", "", text, flags=re.DOTALL)
    text = _renamed(text, name)
    text = re.sub(r'(?<= d=")[^"]*', _rounded, text)
    label = f' role="img" aria-label="{escape(title)}"' if title else ' aria-hidden="true"'
    return text.replace("<svg", f"<svg{label}", 1)


def _settle(figure: Figure) -> None:
    """Lay the figure out and keep that: a second layout would begin where the first ended."""
    if figure.get_layout_engine() is not None:
        figure.draw_without_rendering()
        figure.set_layout_engine("none")


def _renamed(text: str, name: str) -> str:
    """Every id numbered in the order it is met: matplotlib's hold addresses of memory."""
    numbers: dict[str, int] = {}

    def new(found: re.Match[str]) -> str:
        return f"{found[1]}{name}-{numbers.setdefault(found[2], len(numbers))}"

    return re.sub(r'(\bid="|url\(#|href="#)([^")]+)', new, text)


def _rounded(path: re.Match[str]) -> str:
    """A path's coordinates to a hundredth of a point, finer than any printer, and no idle space."""
    short = re.sub(r"(\.\d\d)\d+", r"\1", path[0])
    short = re.sub(r"\.(\d)0\b|\.00\b", lambda m: f".{m[1]}" if m[1] and m[1] != "0" else "", short)
    return re.sub(r"\s*([MLQCz])\s*", r"\1", short)
