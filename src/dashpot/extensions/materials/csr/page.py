"""Pages of an aging law, and of the life at a temperature of use."""

from __future__ import annotations

import math

from dashpot.base import replace
from dashpot.base.number_format import round_to_error
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.extensions.materials.csr.datamodel import Aging
from dashpot.extensions.materials.csr.figure import (
    draw_life,
    draw_life_chart,
    put_chart_first,
)
from dashpot.extensions.materials.csr.life_table import (
    Life,
    format_life,
    format_temperature,
    get_life_unit,
    has_arrhenius_line,
    list_lives,
)
from dashpot.extensions.materials.csr.lifetime_prediction import LOWER, AgingPrediction
from dashpot.extensions.materials.law_ranking import make_law_ranking
from dashpot.report.first_screen import Row
from dashpot.report.result_page import (
    CollapsibleSection,
    Group,
    KindPage,
    Topic,
    group,
    make_indicators,
)
from dashpot.report.tables import TextTable

USUAL_RETAINED_FORCE = 0.5
"""Default F/F0 at the end of life."""
_ROWS = 20.0
"""Distance of the temperatures in the first table, K: those of every second row."""
_OVENS = Topic(
    "Ovens", {"ovens_enough", "single_activation_energy_explains_ovens"}, "on one line"
)  # fmt: skip
_CHEMISTRY = Topic(
    "Chemistry",
    {"chemical_aging_resolved", "aging_exceeds_cell_drift", "load_cell_zero_stable"},
    "seen",
)
_REACH = Topic(
    "Extrapolation",
    {
        "temperature_near_ovens", "robust_to_lower_activation_energy", "time_near_readings",
        "end_point_reached",
    },
    "within reach of the ovens",
)  # fmt: skip


def page(aging: Aging) -> KindPage:
    """Return the page of an aging law."""
    kelvin = [oven.temperature for oven in aging.ovens]
    life_rows = list_lives(aging, USUAL_RETAINED_FORCE) if has_arrhenius_line(aging) else ()
    picture = aging.plot()
    if life_rows:
        picture = put_chart_first(draw_life_chart(aging, USUAL_RETAINED_FORCE), picture)
    return KindPage(
        subject="compression stress relaxation",
        summary_line=_format_strip(aging),
        indicators=make_indicators(
            aging.checks, Topic("Readings"),
            _OVENS._replace(message=f"{len(kelvin)} on one line"), _CHEMISTRY,
        ),
        figure_title="How long it seals" if life_rows else "What is left of the force",
        picture=picture,
        table_title="The aging law",
        groups=(group("", aging.facts), *_make_life_groups(life_rows[::2], USUAL_RETAINED_FORCE)),
        sources=aging.sources,
        collapsible_sections=(*_make_life_sections(aging, life_rows, USUAL_RETAINED_FORCE),
        make_law_ranking(aging.orders)),
    )  # fmt: skip


def lay_out_aged(prediction: AgingPrediction) -> KindPage:
    """Return the page of the life at a temperature of use, or of the force after a time."""
    aging, part = prediction.aging, prediction.first_part
    has_life_chart = part is not None and has_arrhenius_line(aging)
    life_rows = list_lives(aging, part) if has_life_chart and part is not None else ()
    return KindPage(
        subject="compression stress relaxation",
        summary_line=(
            ("Temperature of use", format_temperature(prediction.temperature)),
            *_format_strip(aging),
        ),
        indicators=make_indicators(
            prediction.checks, Topic("Readings"), _OVENS, _CHEMISTRY, _REACH
        ),
        figure_title="How long it seals" if has_life_chart else "What is left of the force",
        picture=draw_life(prediction),
        table_title=f"At {format_temperature(prediction.temperature)}",
        groups=(
            group("", [_read_in_life_unit(reported_value) for reported_value in prediction.facts]),
            group("The aging law", aging.facts),
        ),
        sources=aging.sources,
        note=f"{KindPage.note} {prediction.interval_note}".rstrip(),
        collapsible_sections=_make_life_sections(aging, life_rows, part or USUAL_RETAINED_FORCE),
        name="aged" if prediction._saved_result is prediction else "csr",
    )


def _read_in_life_unit(reported_value: ReportedValue) -> ReportedValue:
    """Return a life in hours or years, as the chart has it; any other value as it is."""
    if reported_value.unit != "s" or math.isnan(reported_value.value):
        return reported_value
    return replace(reported_value, read=get_life_unit(reported_value.value)[1])


def _format_strip(aging: Aging) -> tuple[tuple[str, str], ...]:
    """Return the facts about the test: ovens, time and scatter."""
    kelvin = [oven.temperature for oven in aging.ovens]
    range_text = " to ".join(
        f"{convert_to_unit(value, '°C'):.4g}" for value in (kelvin[0], kelvin[-1])
    )
    return (
        ("Ovens", f"{len(kelvin)}, {range_text} °C"),
        ("Longest", format_quantity(aging.longest, "h", ".4g")),
        ("Scatter", f"{100 * aging.scatter:.2g} % of F0"),
    )


def _make_life_groups(life_rows: tuple[Life, ...], part: float) -> tuple[Group, ...]:
    """Return the lives as rows of the table of numbers."""
    rows = []
    for life_row in life_rows:
        reported_value = life_row.life
        size, unit = get_life_unit(reported_value.value)
        low, value, high = (
            round_to_error(number / size, reported_value.value / size / 10)
            for number in (reported_value.low, reported_value.value, reported_value.high)
        )
        name = format_temperature(life_row.temperature)
        rows.append(Row(name, value, *((low, high) if reported_value.has_interval else ("", "")),
        unit, "",
                        is_limit=False))  # fmt: skip
    return (Group(f"Time until F/F0 is {100 * part:g} %", tuple(rows)),) if rows else ()


def _make_life_sections(
    aging: Aging, life_rows: tuple[Life, ...], part: float
) -> tuple[CollapsibleSection, ...]:
    """Return the lives at several temperatures, each with its verdict."""
    if not life_rows:
        return ()
    coldest = format_temperature(aging.ovens[0].temperature)
    energy = format_quantity(LOWER, "kJ/mol", "g")
    header = ("temperature", "life", "from", "to", f"if Ea is {energy} below {coldest}", "verdict")
    rows = tuple(
        (
            format_temperature(life_row.temperature),
            *(
                format_life(number, life_row.life.value / 10, reference=life_row.life.value)
                if number is not None
                else ""
                for number in (
                    life_row.life.value,
                    *(
                        (life_row.life.low, life_row.life.high)
                        if life_row.life.has_interval
                        else (None, None)
                    ),
                    life_row.lower_energy_life,
                )
            ),
            life_row.use,
        )
        for life_row in life_rows
    )
    line = (
        f"time until F/F0 is {100 * part:g} %; many rubbers age with a lower activation energy in "
        "the cold, which no hotter oven shows"
    )
    row_classes = tuple("" if life_row.use == "use" else "doubt" for life_row in life_rows)
    return (
        CollapsibleSection(
            "Life at other temperatures", line, TextTable(header, rows, row_classes)
        ),
    )
