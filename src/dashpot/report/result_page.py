"""Page of a result: facts, verdict with lights, figure, table, checks, details."""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Iterable, Sequence
from itertools import groupby
from typing import Any, NamedTuple

from dashpot.base import dataclass, replace
from dashpot.base.checks import Check, Verdict, format_check_tally
from dashpot.base.provenance import Source
from dashpot.base.reported_values import UNKNOWN, ReportedValue
from dashpot.base.result_mixins import HasVerdict
from dashpot.base.serialisation import Serialisable
from dashpot.base.units import format_quantity
from dashpot.datamodel.specimen import Specimen
from dashpot.plot.picture import Panel, Picture
from dashpot.registry import find_handler, page_of
from dashpot.report import page_frame, tables
from dashpot.report.figures import LEAD_WIDTH, RenderedFigure, render_figure
from dashpot.report.first_screen import NOT_GIVEN, Indicator, Row, count_passed
from dashpot.report.page_frame import VERDICT_COLOURS, attachment, frame
from dashpot.report.tables import TextTable

# Contents of a result's page.


class Topic(NamedTuple):
    """Topic of the verdict: the checks behind its light, and its text.

    `message` is its text where no check failed except notes, `failure_text` where one did; by
    default the number of checks that passed.
    """

    name: str
    checks: Collection[str] = ()
    message: str = ""
    failure_text: str = ""


class Group(NamedTuple):
    """Rows of the table under one heading."""

    title: str
    rows: tuple[Row, ...]


class CollapsibleSection(NamedTuple):
    """Collapsible section: a table, a figure, or both."""

    title: str
    line: str
    table: TextTable | None = None
    picture: Picture | None = None


class AppCard(NamedTuple):
    """Card of the app: a figure, panels of one kind, a table, or HTML."""

    title: str
    content: Picture | tuple[Panel, ...] | TextTable | str
    cards_per_row: int = 1


class JobPage(NamedTuple):
    """Page of the files of one job in the app: cards, and titled facts with a note."""

    cards: tuple[AppCard, ...]
    title: str
    facts: tuple[ReportedValue, ...]
    sources: tuple[Source, ...]
    note: str = ""


@dataclass(frozen=True)
class KindPage:
    """Contents of the page of one result besides the common ones.

    Attributes
    ----------
    subject : str
        The tested specimen, in addition to the file names.
    summary_line : tuple of (str, str)
        The line of facts.
    indicators : tuple of Indicator
        None is worse than the verdict; together they are as bad.
    figure_title : str
        Title of the figure.
    picture : Picture
    table_title : str
        Title of the table.
    groups : tuple of Group
    note : str
        What "from" and "to" are, and what an empty cell means.
    sources : tuple of Source
    collapsible_sections : tuple of CollapsibleSection
    name : str
        Name of the document, without its ending; by default as its schema is called.
    """

    subject: str
    summary_line: tuple[tuple[str, str], ...]
    indicators: tuple[Indicator, ...]
    figure_title: str
    picture: Picture
    table_title: str
    groups: tuple[Group, ...]
    sources: tuple[Source, ...]
    note: str = "From and to are the 95 % interval; an empty cell was not computed."
    collapsible_sections: tuple[CollapsibleSection, ...] = ()
    name: str = ""


def make_indicators(
    checks: Iterable[Check], first: Topic, *other_topics: Topic
) -> tuple[Indicator, ...]:
    """One indicator for each topic, with the grade of its worst check.

    Checks that no other topic names belong to the first one, which is omitted beside others if none
    of its checks was judged.
    """
    unique_checks = tuple(dict.fromkeys(checks))
    other_names = {name for other in other_topics for name in other.checks}
    first_checks = [check for check in unique_checks if check.name not in other_names]
    checks_by_topic = [
        first_checks,
        *([check for check in unique_checks if check.name in part.checks] for part in other_topics),
    ]
    lights = tuple(map(_light, (first, *other_topics), checks_by_topic))
    return (
        lights[1:]
        if other_topics and all(check.passed is None for check in first_checks)
        else lights
    )


def _light(part: Topic, topic_checks: Sequence[Check]) -> Indicator:
    class_name, count = count_passed(topic_checks, topic_checks)
    text = part.message if class_name in {"good", "note"} else part.failure_text
    return Indicator(
        part.name, class_name, text or format_check_tally(topic_checks).rstrip(".") or count
    )


def row(reported_value: ReportedValue, name: str = "") -> Row:
    """Return a number as the table has it: value, from, to, unit."""
    has_interval = reported_value.has_interval and reported_value.error != 0
    cells = reported_value.cells
    value, low, high = reported_value.cell_texts if has_interval else (cells.value, "", "")
    low = UNKNOWN if not reported_value.has_interval and cells.error == UNKNOWN else low
    if math.isnan(reported_value.value):
        value = "" if reported_value.is_upper_bound else value
    return Row(
        name or reported_value.symbol, value, low, high, reported_value.word, "", is_limit=False
    )


def group(title: str, reported_values: Iterable[ReportedValue]) -> Group:
    """Facts under one heading."""
    return Group(title, tuple(map(row, reported_values)))


def group_by_record(all_values: Iterable[ReportedValue]) -> Iterable[Group]:
    """Facts of the whole, then those of each record, whose names begin with it."""
    for record_name, reported_values in groupby(
        all_values, lambda reported_value: reported_value.symbol.rpartition(": ")[0]
    ):
        yield Group(
            record_name,
            tuple(row(value, value.symbol.rpartition(": ")[2]) for value in reported_values),
        )


def format_specimen_header(specimen: Specimen | None) -> tuple[tuple[str, str], ...]:
    """Return the facts of the specimen: the first four of the line."""
    known_specimen = specimen or Specimen()
    length = (
        ""
        if known_specimen.length is None
        else f"{format_quantity(known_specimen.length, 'mm', '.4g')} long"
    )
    items = (
        ("Specimen", ", ".join(filter(None, (known_specimen.name, length)))),
        ("Lot", known_specimen.lot),
        ("Operator", known_specimen.operator),
        (
            "Temperature",
            ""
            if known_specimen.temperature is None
            else format_quantity(known_specimen.temperature, "°C", ".1f"),
        ),
    )
    return tuple((name, text or NOT_GIVEN) for name, text in items)


def get_sources(result: Any) -> tuple[Source, ...]:
    """Return the source files of a result, whichever attribute holds them."""
    value = getattr(result, "sources", None)
    value = getattr(result, "source", None) if value is None else value
    if value is None:
        return ()
    return (value,) if isinstance(value, Source) else tuple(dict.fromkeys(value))


def kind_page(verdict: Any) -> KindPage:
    """Return the contents of a result's page; of one without its own page, its facts.

    Raises
    ------
    TypeError
        If it is no result that was judged, or shows no number.
    """
    make_page = page_of(verdict)
    if make_page is not None:
        page: KindPage = make_page(verdict)
        return page if page.name else replace(page, name=_get_schema_name(verdict.schema))
    reported_values = verdict.facts if isinstance(verdict, HasVerdict) else ()
    if not reported_values:
        raise TypeError(f"a {type(verdict).__name__} has no page")
    picture = verdict.plot()
    return KindPage(
        subject=picture.name.replace("-", " "),
        summary_line=format_specimen_header(getattr(verdict, "specimen", None)),
        indicators=make_indicators(verdict.checks, Topic("Checks")),
        figure_title="Measured and fitted",
        picture=picture,
        table_title="What was found",
        groups=tuple(group_by_record(reported_values)),
        sources=get_sources(verdict),
        name=picture.name,
    )


def _get_schema_name(schema: str) -> str:
    """Return the name of a schema without package and version."""
    return schema.partition("/")[2].partition("@")[0]


# Page of a judged result, the same for every kind.


_COLUMNS = 2
"""Largest number of strips in a row of a page's figure."""


_NUMBERS = "numbers.json"
"""File with all numbers of a result whose fit is in another file."""


def build_page_contents(
    result: Any, *, lead: Picture | None = None, pictures: Sequence[Picture] = ()
) -> dict[str, Any]:
    """Return the contents of the page of a kind's result.

    Parameters
    ----------
    result
        It was judged.
    lead : Picture, optional
        The figure that answers, where more is known than `result` itself shows.
    pictures : sequence of Picture
        Figures of the records behind it, which are folded.
    """
    page = kind_page(result)
    figure = lead or page.picture
    folds = (
        *(CollapsibleSection("The test", picture.caption, None, picture) for picture in pictures),
        *page.collapsible_sections,
    )
    names = dict.fromkeys(source.file for source in page.sources)
    document = f"{page.name}.json"
    saved_value = result._saved_result
    text = format_json(saved_value)
    sentence = "every number" if saved_value is result else "the fit, for other commands"
    files = [attachment(document, f"Download {document}", sentence, "application/json", text)]
    saved_result = saved_value if find_handler("deck terms", saved_value) else None
    decks = () if saved_result is None else page_frame.decks(saved_result)
    files += page_frame.attach_decks(decks, document)
    if saved_value is not result:
        result_text = format_json(result)
        files.append(
            attachment(_NUMBERS, _NUMBERS, "every number", "application/json", result_text)
        )
    return {
        **make_verdict_contents(page.name, result.verdict, result.checks, page.sources),
        "title": ", ".join(names) or page.subject,
        "page": page,
        "figures": {"lead": _render_wide_figure(figure, "lead")}
        | {
            f"fold{i}": _render_wide_figure(fold.picture, f"fold{i}")
            for i, fold in enumerate(folds)
            if fold.picture
        },
        "folds": folds,
        "files": files,
        "about_decks": ""
        if saved_result is None
        else page_frame.format_deck_note(saved_result, decks),
    }


def make_verdict_contents(
    name: str, verdict: Verdict, checks: Sequence[Check], sources: Sequence[Source]
) -> dict[str, Any]:
    """Return the common contents of a judged result's page: verdict, checks, files behind it."""
    unique_checks = tuple(dict.fromkeys(checks))
    other_failures = [
        check for check in unique_checks if check.failed and check not in verdict.failed_checks
    ]
    return {
        **frame(),
        "verdict": verdict,
        "colour": VERDICT_COLOURS[verdict.use],
        "weighty": (*verdict.failed_checks, *other_failures),
        "tally": count_passed(unique_checks, unique_checks),
        "checks": tables.checks([(name, unique_checks)], unique_checks),
        "sources": sources,
        "simulated": list(dict.fromkeys(source.file for source in sources if source.simulated)),
    }


def _render_wide_figure(picture: Picture, name: str) -> RenderedFigure:
    """Return a figure for the 760 px of a page, or for less."""
    columns = min(picture.columns, len(picture.strips), _COLUMNS)
    figure_width = (LEAD_WIDTH - 24 * (columns - 1)) / columns
    return render_figure(replace(picture, name=name, columns=columns), width=figure_width)


def has_kind_page(result: object) -> bool:
    """Return whether a result has all values of its page."""
    try:
        return isinstance(kind_page(result), KindPage)
    except TypeError:
        return False


def format_json(document: Serialisable) -> str:
    """Return the JSON that ``dashpot fit --json`` prints."""
    return json.dumps(document.to_dict(), indent=2, ensure_ascii=False, allow_nan=False)
