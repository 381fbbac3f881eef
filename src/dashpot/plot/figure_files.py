"""A picture to a file."""

from __future__ import annotations

import io
from pathlib import Path

from dashpot.base.atomic import write_atomic
from dashpot.base.choices import Drawn, FigureSize, get_choice_values
from dashpot.base.errors import ExportError
from dashpot.base.version import byline
from dashpot.plot.matplotlib_writer import to_figure
from dashpot.plot.picture import Picture
from dashpot.plot.svg import to_svg


def save(
    picture: Picture, path: str | Path, *, dpi: float = 300.0, size: FigureSize | None = None
) -> None:
    """Write `picture` to `path`; the suffix says how: .pdf, .png or .svg.

    `size` is ``"column"``, 85 mm wide as in a journal, or ``"slide"``; else its own.

    Raises
    ------
    ExportError
        If the suffix names none of these, or the file cannot be written.
    """
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
    picture = picture if size is None else picture.sized(size)
    if kind not in get_choice_values(Drawn):
        raise ExportError(
            f"a figure is written as .pdf, .png or .svg, found '{suffix or 'no suffix'}'"
        )
    if kind == "svg":
        return f"<!-- {byline('figure')} -->\n{to_svg(picture)}\n".encode()
    from matplotlib import rc_context

    by: dict[str, str | None] = {"Software": byline("figure")}
    if kind == "pdf":
        by = {"Creator": byline("figure"), "CreationDate": None}
    buffer = io.BytesIO()
    with rc_context({"pdf.fonttype": 42}):
        to_figure(picture).savefig(buffer, format=kind, dpi=dpi, metadata=by)
    return buffer.getvalue()
