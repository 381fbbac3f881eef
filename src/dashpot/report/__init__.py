"""Reports: a study or result as one self-contained HTML file."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.base.result_mixins import HasVerdict
from dashpot.plot.picture import Picture
from dashpot.registry import find_handler
from dashpot.report import result_page
from dashpot.report.page_frame import render_template
from dashpot.workflow.study import Study

__all__ = ["has_page", "html"]


def html(
    study: Study | HasVerdict,
    *,
    lead: Picture | None = None,
    extra_pictures: Sequence[Picture] = (),
    **sections: str,
) -> str:
    """Return the report as one self-contained HTML file.

    The first screen has the verdict, the main figure and the recommended model; then test, fit and
    failed checks; other sections are collapsed. No network: figures are inline SVG, attached files
    are links with their contents. A small script adds zoom and reading of values; it is optional
    for the page. A strict content security policy allows the hash of that script and of the style,
    and nothing else. Text from files is escaped.

    Parameters
    ----------
    study : Study or another result of a kind
        Result of ``dashpot report``, ``fit`` or ``predict``.
    lead : Picture, optional
        The main figure, in place of that of the result; not of a study.
    extra_pictures : sequence of Picture
        Figures of its records, which are folded; not of a study.
    **sections : str
        HTML below the verdict: ``limits``.

    Returns
    -------
    str
        The text of the file; the same study gives the same text.
    """
    write = find_handler("html", study)
    if write is not None:
        return str(write(study, **sections))
    return render_template(
        "result.html",
        result_page.build_page_contents(study, lead=lead, pictures=extra_pictures) | sections,
    )


def has_page(result: object) -> bool:
    """Return whether a result has a page."""
    return find_handler("html", result) is not None or result_page.has_kind_page(result)
