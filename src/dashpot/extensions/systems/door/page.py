"""Page of a door: seal line, modes with energy shares, shapes, and closing."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.number_format import duration, format_count, hertz, round_to_error
from dashpot.base.plain_text import sentence
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.extensions.systems.door.closing_figure import (
    make_doors_panel,
    make_energy_waterfall,
    make_moments_panel,
    make_speed_panel,
)
from dashpot.extensions.systems.door.closing_result import ClosingResult
from dashpot.extensions.systems.door.figure import (
    MAX_MODES,
    View,
    make_compression_panel,
    make_frf_panel,
    make_line_panel,
    make_shape_panels,
)
from dashpot.extensions.systems.door.modes import DoorMode
from dashpot.extensions.systems.door.mounts import SEAL
from dashpot.extensions.systems.door.result import DoorResult
from dashpot.plot.picture import Panel, Picture
from dashpot.plot.plotted_data import stamp
from dashpot.report.figures import RenderedFigure, render_figure
from dashpot.report.first_screen import NBSP, Indicator
from dashpot.report.page_frame import Attachment, attachment, environment
from dashpot.report.result_page import (
    CollapsibleSection,
    Topic,
    format_json,
    make_indicators,
    make_verdict_contents,
)
from dashpot.report.tables import TextTable

_MODES = frozenset(
    {"door_modes_in_valid_band", "modes_suffice", "mode_shapes_cover_points", "masses_agree"}
)
_CLOSING = frozenset({"closing_in_valid_band", "faster_closings_latch"})
_MIN_ENERGY_SHARE = 0.01
"""Smallest share of the energy in the seal of a mode that the seal holds."""
_ROWS = 12
"""Modes in the table; all stand in the document."""
_REMARKED_SHARE = 0.05
"""Share of doors beyond the limit that is remarked."""
_HINGES = ("edge", "soft", "ref", "hottest")
"""Colours of the supports of a door other than seal and latch."""
_SIDE, _THIRD = 290.0, 376.0
"""Widths of the line, and of the three figures below, px."""


class Bar(NamedTuple):
    """Part of a bar: start and width in per cent, and colour."""

    at: str
    width: str
    colour: str
    name: str


class ModeRow(NamedTuple):
    """Row of a mode in the table."""

    number: int
    frequency: str
    frequency_without_seal: str
    damping: str
    energy_bars: tuple[Bar, ...]
    seal_energy: str
    loss_bars: tuple[Bar, ...]
    seal_loss: str
    extrapolation: str
    is_marked: bool


class ModesTable(NamedTuple):
    """Table of a door's modes: rows, energy shares with colours, and texts."""

    rows: tuple[ModeRow, ...]
    parts: tuple[tuple[str, str], ...]
    note: str
    hidden_count: int


def door_html(*results: DoorResult | ClosingResult) -> str:
    """Return the page of a door: how it vibrates, how it closes, or both."""
    result = next((result for result in results if isinstance(result, DoorResult)), None)
    closed = next((result for result in results if isinstance(result, ClosingResult)), None)
    template = environment("dashpot.extensions.systems.door").get_template("door.html")
    return str(template.render(build_page_contents(result, closed)))


def build_page_contents(
    result: DoorResult | None, closing_result: ClosingResult | None
) -> dict[str, Any]:
    """Return the contents of the page of a door: vibration, closing, or both."""
    results = [item for item in (result, closing_result) if item is not None]
    checks = tuple(dict.fromkeys(check for result in results for check in result.checks))
    sources = tuple(dict.fromkeys(source for result in results for source in result.sources))
    verdict = _combine_verdicts(results, checks)
    names = dict.fromkeys(source.file for source in sources)
    folds = tuple(_make_sections(result, closing_result))
    return {
        **make_verdict_contents("door", verdict, checks, sources),
        "title": next(iter(names), "door"),
        "about": format_door_summary(results[0]),
        "verdict_note": " ".join(sentence(result._headline) for result in results),
        "lights": tuple(make_door_indicators(result, closing_result, checks, verdict)),
        "figures": dict(_make_figures(result, closing_result))
        | {f"fold{i}": render_figure(fold.picture) for i, fold in enumerate(folds) if fold.picture},
        "modes": ModesTable((), (), "", 0) if result is None else make_mode_table(result),
        "closing_notes": () if closing_result is None else _list_closing_notes(closing_result),
        "speed": "" if closing_result is None else f"{closing_result.closing.speed:.2f} m/s",
        "folds": folds,
        "files": tuple(_attach_files(result, closing_result)),
    }


def _combine_verdicts(
    results: Sequence[DoorResult | ClosingResult], checks: Sequence[Check]
) -> Verdict:
    return (
        results[0].verdict if len(results) == 1 else verdict(checks, headline=results[-1]._headline)
    )


def format_door_summary(result: DoorResult | ClosingResult) -> str:
    """Return the mass, its mounts, and the seal."""
    door = result.door
    sentences = [] if door.rigid is None else [f"{door.rigid.mass:.3g} kg"]
    if door.line is not None:
        sentences.append(f"{door.line.length:.3g} m of seal")
    sentences.append(format_count(len(door.hinges), "hinge"))
    if door.latch is not None:
        sentences.append("one latch")
    if result.fit is not None and result.fit.specimen.temperature is not None:
        sentences.append(format_quantity(result.fit.specimen.temperature, "°C", ".1f"))
    return ", ".join(sentences)


def make_door_indicators(
    result: DoorResult | None,
    closing_result: ClosingResult | None,
    checks: Sequence[Check],
    verdict: Verdict,
) -> Iterator[Indicator]:
    """Yield the indicators of the seal line, the modes, the closing and its limit, if asked."""
    topics = []
    if result is not None:
        outside = [
            result.extrapolation_factor(mode.mode.frequency) for mode in _select_seal_modes(result)
        ]
        factors = ", ".join(f"×{value:.3g}" for value in outside if value > 1)
        topics.append(Topic(
            "Modes", _MODES, f"{len(result.modes)} to {result.band[1]:g}{NBSP}Hz",
            f"{len(outside)} held by the seal, {factors}" if factors else "",
        ))  # fmt: skip
    if closing_result is not None:
        speed_text = f"from {closing_result.closing.minimum:.3g}{NBSP}m/s"
        topics.append(
            Topic("Closing", _CLOSING, speed_text, _format_speed_interval(closing_result))
        )
    yield from make_indicators(
        checks, Topic("Seal line", message=_format_line_note(result, closing_result)), *topics
    )
    scatter = None if closing_result is None else closing_result.closing.scatter
    share_above_limit = None if scatter is None else scatter.share_above_limit
    if share_above_limit is not None and scatter is not None:
        class_name = (
            "good"
            if share_above_limit <= _REMARKED_SHARE
            else "note"
            if verdict.use == "use"
            else "care"
        )
        limit = scatter.variation.limit
        yield Indicator(
            "Limit",
            class_name,
            f"{100 * share_above_limit:.3g} % need more than {limit:g}{NBSP}m/s",
        )


def _format_speed_interval(closing_result: ClosingResult) -> str:
    interval = closing_result.closing.interval
    if interval is None or not math.isfinite(interval[1]):
        return ""
    return f"from {interval[0]:.3g} to {interval[1]:.3g}{NBSP}m/s"


def _format_line_note(result: DoorResult | None, closing_result: ClosingResult | None) -> str:
    compressions = np.zeros(0)
    if (
        result is not None
        and result.stations is not None
        and result.stations.compression is not None
    ):
        compressions = result.stations.compression
    elif closing_result is not None:
        compressions = closing_result.closing.door.compression
    if not len(compressions):
        return ""
    low, high = (
        f"{convert_to_unit(float(end), 'mm'):.2f}"
        for end in (compressions.min(), compressions.max())
    )
    return f"{low} to {high}{NBSP}mm" + ", all touch" * bool((compressions >= 0).all())


def _select_seal_modes(result: DoorResult) -> list[DoorMode]:
    """Return the modes that the seal holds."""
    return [mode for mode in result.modes if mode.share(SEAL) >= _MIN_ENERGY_SHARE]


def make_mode_table(result: DoorResult) -> ModesTable:
    """Return the table of the modes."""
    rows, parts = tuple(_make_rows(result)), tuple(_choose_colours(result.modes).items())
    return ModesTable(rows, parts, _format_seal_note(result), len(result.modes) - len(rows))


def _format_seal_note(result: DoorResult) -> str:
    if result.fit is None or not result.modes:
        return ""
    return (
        "Marked: the seal stores more than 1 % of the energy there, and its test does not reach "
        f"that frequency; it covers {hertz(result.fit.band)}."
    )


def _list_closing_notes(closing_result: ClosingResult) -> tuple[str, str]:
    closing = closing_result.closing
    seal = sum(term.work for term in closing.terms if term.name.startswith(SEAL))
    total_work = sum(term.work for term in closing.terms)
    first = (
        f"The seal takes {round_to_error(seal, digits=2)} of "
        f"{round_to_error(total_work, digits=3)} J, in "
        f"{duration(closing.sealing)}."
    )
    scatter = closing.scatter
    if scatter is None:
        return first, ""
    vary = scatter.variation
    leaks = (
        "none leaks" if scatter.share_leaking == 0 else f"{100 * scatter.share_leaking:.2g} % leak"
    )
    return first, (
        f"Gap ±{convert_to_unit(vary.gap, 'mm'):g} mm and force ±{100 * vary.load:g} % (three SD). "
        f"95 % of doors close from {round_to_error(scatter.least_speed_95, digits=3)} m/s; {leaks}."
    )


# -- Table of modes -------------------------------------------------------------------------------


def _choose_colours(modes: Sequence[DoorMode]) -> dict[str, str]:
    """Each part that holds the door, and its colour: seal, latch, hinges, the door itself."""
    parts = list(dict.fromkeys(share.name for mode in modes for share in mode.shares))
    other_parts = [part for part in parts if part not in {SEAL, "latch", "door"}]
    entries = {SEAL: "fit"} | ({"latch": "mild"} if "latch" in parts else {})
    entries |= {name: _HINGES[i % len(_HINGES)] for i, name in enumerate(other_parts)}
    return {name: colour for name, colour in (entries | {"door": "line"}).items() if name in parts}


def _make_rows(result: DoorResult) -> Iterator[ModeRow]:
    colours = _choose_colours(result.modes)
    for number, mode in enumerate(result.modes[:_ROWS], start=1):
        hz = mode.mode.frequency
        excess = result.extrapolation_factor(hz)
        lossy = mode.loss_share(SEAL)
        yield ModeRow(
            number,
            round_to_error(hz, digits=4),
            "" if mode.without_seal is None else round_to_error(mode.without_seal, digits=4),
            round_to_error(100 * mode.mode.damping_ratio, digits=2),
            _make_share_bars({share.name: share.energy for share in mode.shares}, colours),
            f"{100 * mode.share(SEAL):.1f}",
            _make_share_bars({share.name: share.loss for share in mode.shares}, colours),
            f"{100 * lossy:.1f}",
            "" if math.isnan(excess) else "inside" if excess <= 1 else f"×{excess:.3g}",
            is_marked=mode.share(SEAL) >= _MIN_ENERGY_SHARE and excess > 1,
        )


def _make_share_bars(shares: dict[str, float], colours: dict[str, str]) -> tuple[Bar, ...]:
    """Return the share of each part in the total."""
    total, bar_start, bars = sum(shares.values()), 0.0, []
    for name, colour in colours.items():
        width = 100 * shares.get(name, 0.0) / total if total > 0 else 0.0
        if width > 0:
            bars.append(Bar(f"{bar_start:.2f}", f"{width:.2f}", colour, f"{name} {width:.1f} %"))
        bar_start += width
    return tuple(bars)


# -- figures --------------------------------------------------------------------------------------


def _make_figures(
    result: DoorResult | None, closing_result: ClosingResult | None
) -> Iterator[tuple[str, RenderedFigure]]:
    """Every figure of the page by its name."""
    if result is not None:
        view = View.from_result(result)
        if view is not None:
            yield _render_panel(
                "line", make_line_panel(result, view), _SIDE, "Where the seal is pressed", 240.0
            )
            shapes = make_shape_panels(result, view)
            if shapes:
                words = "How the seal line moves in each mode, seen from outside"
                picture = Picture("shapes", words, tuple((shape,) for shape in shapes), len(shapes))
                yield "shapes", render_figure(picture, phone=2)
        if result.frfs:
            words = "Accelerance with the seal and without, where the seal holds a mode"
            yield _render_panel("frf", make_frf_panel(result, 0, height=220.0), _THIRD, words)
    if closing_result is not None:
        closing = closing_result.closing
        yield _render_panel(
            "waterfall",
            make_energy_waterfall(closing),
            _THIRD,
            "What each term takes of the energy",
        )
        if closing.scatter is not None and np.isfinite(closing.scatter.least_speed).any():
            panel = make_doors_panel(closing, closing.scatter, height=205.0)
            yield _render_panel(
                "doors", panel, _THIRD, "The least speeds of doors within their tolerances"
            )


def _render_panel(
    name: str, panel: Panel, width: float, caption: str, height: float = 0.0
) -> tuple[str, RenderedFigure]:
    # a heading of the page says what its title says
    return name, render_figure(
        Picture(name, caption, ((replace(panel, title="", height=height or panel.height),),)),
        width=width,
    )


def _make_sections(
    result: DoorResult | None, closing_result: ClosingResult | None
) -> Iterator[CollapsibleSection]:
    if (
        result is not None
        and result.stations is not None
        and result.stations.compression is not None
    ):
        picture = Picture("pressed", "Compression along the line.",
        ((make_compression_panel(result),),),
                          stamp=stamp(result.sources))  # fmt: skip
        yield CollapsibleSection("Along the line", _format_line_facts(result), None, picture)
    if result is not None and result.modes:
        yield CollapsibleSection(
            "Every share", "per cent of the energy, and of the loss", _make_share_table(result)
        )
    if closing_result is not None:
        panels = (
            (make_moments_panel(closing_result.closing),),
            (make_speed_panel(closing_result.closing),),
        )
        words = "Moments against closing, and the speed of the edge over the way"
        yield CollapsibleSection("As it closes", "moments and speed over the way",
        _make_term_table(closing_result),
                   Picture("course", words, panels, 2, stamp(closing_result.sources)))  # fmt: skip


def _format_line_facts(result: DoorResult) -> str:
    seal = result.seal
    if seal is None or seal.force is None:
        return "compression by place"
    return (
        f"{seal.stations} stations, {round_to_error(seal.force)} N in all after relaxation, "
        f"{round_to_error(convert_to_unit(seal.stiffness, 'N/mm'))} N/mm"
    )


def _make_share_table(result: DoorResult) -> TextTable:
    parts = list(_choose_colours(result.modes))
    rows = []
    for number, mode in enumerate(result.modes[: 2 * MAX_MODES], start=1):
        total_loss = sum(share.loss for share in mode.shares) or 1.0
        by_name = {share.name: share for share in mode.shares}
        cells = [f"{100 * by_name[name].energy:.2f}" if name in by_name else "" for name in parts]
        cells += [
            f"{100 * by_name[name].loss / total_loss:.2f}" if name in by_name else ""
            for name in parts
        ]
        rows.append((f"{number}: {round_to_error(mode.mode.frequency, digits=4)} Hz", *cells))
    header = ("mode", *(f"{name}, energy" for name in parts), *(f"{name}, loss" for name in parts))
    return TextTable(header, tuple(rows))


def _make_term_table(closing_result: ClosingResult) -> TextTable:
    rows = tuple(
        (term.name, round_to_error(term.work, digits=3), round_to_error(term.stored, digits=3),
         round_to_error(term.peak_moment, digits=3))
        for term in closing_result.closing.terms
    )  # fmt: skip
    return TextTable(("term", "J", "recoverable, J", "highest moment, N m"), rows)


def _attach_files(
    result: DoorResult | None, closing_result: ClosingResult | None
) -> Iterator[Attachment]:
    for name, item in (("door", result), ("closing", closing_result)):
        if item is not None:
            document = f"{name}.json"
            yield attachment(
                document, document, "every number", "application/json", format_json(item)
            )
