"""The page of a door: its line, modes with what holds and what loses, shapes, and how it closes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.number_format import duration, format_count, hertz, round_to_error
from dashpot.base.sentences import sentence
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.extensions.door.closing_figure import (
    doors_panel,
    moments_panel,
    speed_panel,
    waterfall,
)
from dashpot.extensions.door.closing_result import ClosingResult
from dashpot.extensions.door.figure import (
    SHOWN,
    View,
    frf_panel,
    line_panel,
    pressed_panel,
    shape_panels,
)
from dashpot.extensions.door.modes import DoorMode
from dashpot.extensions.door.mounts import SEAL
from dashpot.extensions.door.result import DoorResult
from dashpot.plot.picture import Panel, Picture
from dashpot.plot.provenance_stamp import stamp
from dashpot.report.attachments import Attachment, attachment
from dashpot.report.figures import RenderedFigure, render_figure
from dashpot.report.first_screen import NBSP, Light
from dashpot.report.page_content import CollapsibleSection, Topic, lights
from dashpot.report.page_frame import environment
from dashpot.report.result_page import judgement, text_of
from dashpot.report.tables import TextTable

_MODES = frozenset({"door_modes_informed", "modes_suffice", "shapes_known_there", "masses_agree"})
_CLOSING = frozenset({"closing_informed", "faster_doors_close"})
_HOLDS = 0.01
"""Share of the energy from which the seal is said to hold a mode."""
_ROWS = 12
"""Modes in the table; all stand in the document."""
_MANY = 0.05
"""Share of doors beyond the limit that is remarked."""
_HINGES = ("edge", "soft", "ref", "hottest")
"""Colours of what holds a door beside seal and latch."""
_SIDE, _THIRD = 290.0, 376.0
"""Widths of the line, and of the three figures below, px."""


class Bar(NamedTuple):
    """Part of a bar: where it begins, how wide it is, both in per cent, and its colour."""

    at: str
    width: str
    colour: str
    name: str


class ModeRow(NamedTuple):
    """A mode as the table has it."""

    number: int
    frequency: str
    bare: str
    damping: str
    holds: tuple[Bar, ...]
    held: str
    loses: tuple[Bar, ...]
    lost: str
    beyond: str
    marked: bool


class ModesTable(NamedTuple):
    """The modes of a door: rows, the parts that share them with their colours, what is said."""

    rows: tuple[ModeRow, ...]
    parts: tuple[tuple[str, str], ...]
    note: str
    more: int


def door_html(*results: DoorResult | ClosingResult) -> str:
    """Return the page of a door: how it vibrates, how it closes, or both."""
    found = next((one for one in results if isinstance(one, DoorResult)), None)
    closed = next((one for one in results if isinstance(one, ClosingResult)), None)
    template = environment("dashpot.extensions.door").get_template("door.html")
    return str(template.render(build_page_contents(found, closed)))


def build_page_contents(found: DoorResult | None, closed: ClosingResult | None) -> dict[str, Any]:
    """What the page of a door holds: how it vibrates, how it closes, or both."""
    results = [one for one in (found, closed) if one is not None]
    every = tuple(dict.fromkeys(check for one in results for check in one.checks))
    sources = tuple(dict.fromkeys(source for one in results for source in one.sources))
    said = _verdict(results, every)
    names = dict.fromkeys(one.file for one in sources)
    folds = tuple(_folds(found, closed))
    return {
        **judgement("door", said, every, sources),
        "title": next(iter(names), "door"),
        "about": format_door_summary(results[0]),
        "beside": " ".join(sentence(one.sound) for one in results),
        "lights": tuple(lights_of(found, closed, every, said)),
        "figures": dict(_figures(found, closed))
        | {f"fold{i}": render_figure(one.picture) for i, one in enumerate(folds) if one.picture},
        "modes": ModesTable((), (), "", 0) if found is None else modes_of(found),
        "closing_notes": () if closed is None else _closing_notes(closed),
        "speed": "" if closed is None else f"{closed.closing.speed:.2f} m/s",
        "folds": folds,
        "files": tuple(_files(found, closed)),
    }


def _verdict(results: Sequence[DoorResult | ClosingResult], every: Sequence[Check]) -> Verdict:
    return results[0].verdict if len(results) == 1 else verdict(every, sound=results[-1].sound)


def format_door_summary(found: DoorResult | ClosingResult) -> str:
    """The mass, what holds it, and the seal."""
    door = found.door
    said = [] if door.rigid is None else [f"{door.rigid.mass:.3g} kg"]
    if door.line is not None:
        said.append(f"{door.line.length:.3g} m of seal")
    said.append(format_count(len(door.hinges), "hinge"))
    if door.latch is not None:
        said.append("one latch")
    if found.fit is not None and found.fit.specimen.temperature is not None:
        said.append(format_quantity(found.fit.specimen.temperature, "°C", ".1f"))
    return ", ".join(said)


def lights_of(
    found: DoorResult | None,
    closed: ClosingResult | None,
    every: Sequence[Check],
    said: Verdict,
) -> Iterator[Light]:
    """Of the seal line, the modes, the closing and its limit, as far as each was asked."""
    asked = []
    if found is not None:
        beyond = [found.beyond(one.mode.frequency) for one in _select_seal_modes(found)]
        factors = ", ".join(f"×{one:.3g}" for one in beyond if one > 1)
        asked.append(Topic(
            "Modes", _MODES, f"{len(found.modes)} to {found.band[1]:g}{NBSP}Hz",
            f"{len(beyond)} held by the seal, {factors}" if factors else "",
        ))  # fmt: skip
    if closed is not None:
        least = f"from {closed.closing.minimum:.3g}{NBSP}m/s"
        asked.append(Topic("Closing", _CLOSING, least, _format_speed_interval(closed)))
    yield from lights(every, Topic("Seal line", says=_line_says(found, closed)), *asked)
    scatter = None if closed is None else closed.closing.scatter
    above = None if scatter is None else scatter.above
    if above is not None and scatter is not None:
        mark = "good" if above <= _MANY else "note" if said.use == "use" else "care"
        limit = scatter.variation.limit
        yield Light("Limit", mark, f"{100 * above:.3g} % need more than {limit:g}{NBSP}m/s")


def _format_speed_interval(closed: ClosingResult) -> str:
    interval = closed.closing.interval
    if interval is None or not math.isfinite(interval[1]):
        return ""
    return f"from {interval[0]:.3g} to {interval[1]:.3g}{NBSP}m/s"


def _line_says(found: DoorResult | None, closed: ClosingResult | None) -> str:
    pressed = np.zeros(0)
    if found is not None and found.stations is not None and found.stations.compression is not None:
        pressed = found.stations.compression
    elif closed is not None:
        pressed = closed.closing.door.compression
    if not len(pressed):
        return ""
    low, high = (
        f"{convert_to_unit(float(end), 'mm'):.2f}" for end in (pressed.min(), pressed.max())
    )
    return f"{low} to {high}{NBSP}mm" + ", all touch" * bool((pressed >= 0).all())


def _select_seal_modes(found: DoorResult) -> list[DoorMode]:
    """The modes that the seal holds."""
    return [one for one in found.modes if one.share(SEAL) >= _HOLDS]


def modes_of(found: DoorResult) -> ModesTable:
    """The table of the modes."""
    rows, parts = tuple(_rows(found)), tuple(_colours(found.modes).items())
    return ModesTable(rows, parts, _seal_note(found), len(found.modes) - len(rows))


def _seal_note(found: DoorResult) -> str:
    if found.fit is None or not found.modes:
        return ""
    return (
        "Marked: the seal stores more than 1 % of the energy there, and its test does not reach "
        f"that frequency; it covers {hertz(found.fit.band)}."
    )


def _closing_notes(closed: ClosingResult) -> tuple[str, str]:
    done = closed.closing
    seal = sum(one.work for one in done.terms if one.name.startswith(SEAL))
    whole = sum(one.work for one in done.terms)
    first = (
        f"The seal takes {round_to_error(seal, digits=2)} of {round_to_error(whole, digits=3)} J, "
        "in "
        f"{duration(done.sealing)}."
    )
    scatter = done.scatter
    if scatter is None:
        return first, ""
    vary = scatter.variation
    leaks = "none leaks" if scatter.leaking == 0 else f"{100 * scatter.leaking:.2g} % leak"
    return first, (
        f"Gap ±{convert_to_unit(vary.gap, 'mm'):g} mm and force ±{100 * vary.load:g} % (three SD). "
        "95 % of "
        f"doors close from {round_to_error(scatter.least_speed_95, digits=3)} m/s; {leaks}."
    )


# -- the table of modes ---------------------------------------------------------------------------


def _colours(modes: Sequence[DoorMode]) -> dict[str, str]:
    """Each part that holds the door, and its colour: seal, latch, hinges, the door itself."""
    parts = list(dict.fromkeys(share.name for one in modes for share in one.shares))
    others = [one for one in parts if one not in {SEAL, "latch", "door"}]
    found = {SEAL: "fit"} | ({"latch": "mild"} if "latch" in parts else {})
    found |= {name: _HINGES[i % len(_HINGES)] for i, name in enumerate(others)}
    return {name: colour for name, colour in (found | {"door": "line"}).items() if name in parts}


def _rows(found: DoorResult) -> Iterator[ModeRow]:
    colours = _colours(found.modes)
    for number, one in enumerate(found.modes[:_ROWS], start=1):
        hz = one.mode.frequency
        beyond = found.beyond(hz)
        lossy = one.loss_share(SEAL)
        yield ModeRow(
            number,
            round_to_error(hz, digits=4),
            "" if one.without_seal is None else round_to_error(one.without_seal, digits=4),
            round_to_error(100 * one.mode.damping_ratio, digits=2),
            _bars({share.name: share.energy for share in one.shares}, colours),
            f"{100 * one.share(SEAL):.1f}",
            _bars({share.name: share.loss for share in one.shares}, colours),
            f"{100 * lossy:.1f}",
            "" if math.isnan(beyond) else "inside" if beyond <= 1 else f"×{beyond:.3g}",
            marked=one.share(SEAL) >= _HOLDS and beyond > 1,
        )


def _bars(shares: dict[str, float], colours: dict[str, str]) -> tuple[Bar, ...]:
    """What each part has, side by side, of all of it."""
    whole, at, found = sum(shares.values()), 0.0, []
    for name, colour in colours.items():
        width = 100 * shares.get(name, 0.0) / whole if whole > 0 else 0.0
        if width > 0:
            found.append(Bar(f"{at:.2f}", f"{width:.2f}", colour, f"{name} {width:.1f} %"))
        at += width
    return tuple(found)


# -- figures --------------------------------------------------------------------------------------


def _figures(
    found: DoorResult | None, closed: ClosingResult | None
) -> Iterator[tuple[str, RenderedFigure]]:
    """Every figure of the page by its name."""
    if found is not None:
        view = View.from_result(found)
        if view is not None:
            yield _render_panel(
                "line", line_panel(found, view), _SIDE, "Where the seal is pressed", 240.0
            )
            shapes = shape_panels(found, view)
            if shapes:
                words = "How the seal line moves in each mode, seen from outside"
                picture = Picture("shapes", words, tuple((one,) for one in shapes), len(shapes))
                yield "shapes", render_figure(picture, phone=2)
        if found.frfs:
            words = "Accelerance with the seal and without, where the seal holds a mode"
            yield _render_panel("frf", frf_panel(found, 0, height=220.0), _THIRD, words)
    if closed is not None:
        done = closed.closing
        yield _render_panel(
            "waterfall", waterfall(done), _THIRD, "What each term takes of the energy"
        )
        if done.scatter is not None and np.isfinite(done.scatter.speed).any():
            panel = doors_panel(done, done.scatter, height=205.0)
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


def _folds(found: DoorResult | None, closed: ClosingResult | None) -> Iterator[CollapsibleSection]:
    if found is not None and found.stations is not None and found.stations.compression is not None:
        picture = Picture("pressed", "Compression along the line", ((pressed_panel(found),),),
                          stamp=stamp(found.sources))  # fmt: skip
        yield CollapsibleSection("Along the line", _line_line(found), None, picture)
    if found is not None and found.modes:
        yield CollapsibleSection(
            "Every share", "per cent of the energy, and of the loss", _shares(found)
        )
    if closed is not None:
        panels = ((moments_panel(closed.closing),), (speed_panel(closed.closing),))
        words = "Moments against closing, and the speed of the edge over the way"
        yield CollapsibleSection("As it closes", "moments and speed over the way", _terms(closed),
                   Picture("course", words, panels, 2, stamp(closed.sources)))  # fmt: skip


def _line_line(found: DoorResult) -> str:
    seal = found.seal
    if seal is None or seal.force is None:
        return "compression by place"
    return (
        f"{seal.stations} stations, {round_to_error(seal.force)} N in all after relaxation, "
        f"{round_to_error(convert_to_unit(seal.stiffness, 'N/mm'))} N/mm"
    )


def _shares(found: DoorResult) -> TextTable:
    parts = list(_colours(found.modes))
    rows = []
    for number, one in enumerate(found.modes[: 2 * SHOWN], start=1):
        whole = sum(share.loss for share in one.shares) or 1.0
        by_name = {share.name: share for share in one.shares}
        cells = [f"{100 * by_name[name].energy:.2f}" if name in by_name else "" for name in parts]
        cells += [
            f"{100 * by_name[name].loss / whole:.2f}" if name in by_name else "" for name in parts
        ]
        rows.append((f"{number}: {round_to_error(one.mode.frequency, digits=4)} Hz", *cells))
    head = ("mode", *(f"{name}, energy" for name in parts), *(f"{name}, loss" for name in parts))
    return TextTable(head, tuple(rows))


def _terms(closed: ClosingResult) -> TextTable:
    rows = tuple(
        (one.name, round_to_error(one.work, digits=3), round_to_error(one.stored, digits=3),
         round_to_error(one.moment, digits=3))
        for one in closed.closing.terms
    )  # fmt: skip
    return TextTable(("term", "J", "recoverable, J", "highest moment, N m"), rows)


def _files(found: DoorResult | None, closed: ClosingResult | None) -> Iterator[Attachment]:
    for name, one in (("door", found), ("closing", closed)):
        if one is not None:
            document = f"{name}.json"
            yield attachment(document, document, "every number", "application/json", text_of(one))
