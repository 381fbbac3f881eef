"""Page of leak speeds."""

from __future__ import annotations

from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.extensions.systems.door.leak_figure import draw_door, draw_line, draw_states
from dashpot.extensions.systems.door.leak_result import LeakResult, format_speed
from dashpot.extensions.systems.door.leak_text import describe_states
from dashpot.plot.picture import Picture
from dashpot.plot.plotted_data import stamp
from dashpot.report.first_screen import NOT_GIVEN, Indicator
from dashpot.report.result_page import CollapsibleSection, KindPage, Topic, group, make_indicators
from dashpot.report.tables import TextTable, describe_rows, select_rows

_CAPTION = (
    "Speed of the car at which the pressure lifts the seal: of the first station in every state "
    "with its 95 % limits, and along the line."
)
_ROWS = 60
"""Stations in the table, at most; every one stands in the document."""


def leak_page(result: LeakResult) -> KindPage:
    """Return the page of leak speeds."""
    setup = result.setup
    limit, indices = NOT_GIVEN, select_rows(len(result.arc_length), _ROWS)
    if setup.limit is not None:
        limit = f"{convert_to_unit(setup.limit, 'km/h'):.4g} km/h"
    return KindPage(
        subject="leak speed of the seal of a door",
        summary_line=(
            ("Seal line", f"{float(result.stations.length.sum()):.3g} m"),
            ("Stations", str(len(result.arc_length))),
            ("Pressure on", format_quantity(setup.lip, "mm")),
            ("Pressure coefficient", f"{setup.pressure_coefficient:g}"),
            ("Limit", limit),
        ),
        indicators=tuple(_make_lights(result)),
        figure_title="Speed of the car at which the seal lifts",
        picture=Picture(
            "leak", _CAPTION, ((draw_states(result),), (draw_line(result),)), 2,
            stamp(result.sources),
        ),
        table_title="The first station lifts at",
        groups=(group("", result.facts),),
        sources=result.sources,
        collapsible_sections=(
            CollapsibleSection(
                "On the door", "leak speed of every station as described", None,
                Picture("leak-door", "Leak speed of every station, seen from outside.",
                        ((draw_door(result),),), stamp=stamp(result.sources)),
            ),
            CollapsibleSection(
                "States", "what each is, and where it leaks first", _make_state_table(result)
            ),
            CollapsibleSection(
                "Stations", describe_rows(indices, "stations"),
                _make_station_table(result, indices),
            ),
        ),
        name="leak",
    )  # fmt: skip


def _make_lights(result: LeakResult) -> list[Indicator]:
    leak_lights = list(
        make_indicators(
            result.checks,
            Topic("Seal"),
            Topic("Leak speed", {"leak_speed_determined"}, format_speed(result.states[0].least)),
        )
    )
    verdicts = result.limit_verdicts
    if verdicts:
        missed_names = [name for name, word in verdicts.items() if word == "missed"]
        undecided = [name for name, word in verdicts.items() if word == "open"]
        text = "met in every state"
        if missed_names or undecided:
            parts = [f"missed: {', '.join(missed_names)}"] if missed_names else []
            parts += [f"open: {', '.join(undecided)}"] if undecided else []
            text = "; ".join(parts)
        class_name = "good" if not missed_names and not undecided else "note"
        leak_lights.append(Indicator("Limit", class_name, text))
    return leak_lights


def _make_state_table(result: LeakResult) -> TextTable:
    header = ("state", "which is", "N/m", "Pa", "km/h", "from", "to", "at, m", "limit")
    rows = []
    for state, words in zip(result.states, describe_states(result), strict=True):
        i = state.weakest
        speeds = (f"{convert_to_unit(item, 'km/h'):.1f}" for item in state.least)
        rows.append((
            state.name, words, f"{state.force[i]:.4g}", f"{state.pressure[i]:.4g}", *speeds,
            f"{result.arc_length[i]:.3f}", result.limit_verdicts.get(state.name, ""),
        ))  # fmt: skip
    return TextTable(header, tuple(rows))


def _make_station_table(result: LeakResult, indices: range) -> TextTable:
    header = ("along, m", "compression, mm", *(f"{state.name}, km/h" for state in result.states))
    rows = tuple(
        (
            f"{result.arc_length[i]:.3f}",
            f"{convert_to_unit(float(result.compression[i]), 'mm'):.2f}",
            *(f"{convert_to_unit(float(state.speed[i]), 'km/h'):.1f}" for state in result.states),
        )
        for i in indices
    )
    return TextTable(header, rows)
