"""Figure and page of the doors of many cars: the distribution of each quantity, and its limit."""

from __future__ import annotations

import numpy as np

from dashpot.extensions.systems.door.population import (
    MIN_SD,
    DoorPopulation,
    DoorQuantity,
    format_limit,
    format_share,
)
from dashpot.plot.picture import FIT, REJECTED, Area, Line, Mark, Panel, Picture, Rule, Scale
from dashpot.plot.plotted_data import stamp as format_stamp
from dashpot.report.first_screen import Indicator, Row
from dashpot.report.result_page import Group, KindPage, Topic, group, make_indicators

_MAX_PANELS, _PANEL_WIDTHS, _POINTS = 4, 4.0, 241
"""Panels at most, standard deviations to both sides, points of a curve."""


def draw_population(population: DoorPopulation, *, stamp: str = "") -> Picture:
    """Return the share of the cars over each quantity, those with a limit first.

    Parameters
    ----------
    population : DoorPopulation
    stamp : str
        Origin of the data, printed below the figure; by default the files.
    """
    quantities = [
        quantity
        for quantity in population.quantities
        if quantity.limit or quantity.between_sd > MIN_SD
    ] or list(population.quantities)
    shown_quantities = sorted(quantities, key=lambda quantity: quantity.limit is None)[:_MAX_PANELS]
    panels = [_draw_quantity(quantity, population.spread.mean) for quantity in shown_quantities]
    caption = (
        "Distribution over the cars: in each panel the density of a quantity, 95 % of the cars "
        "shaded, and the part beyond its limit."
    )
    origin = format_stamp(population.sources) if population.sources else ""
    strips = tuple((panel,) for panel in panels)
    return Picture("cars", caption, strips, 2, stamp or origin)


def lay_out_population(population: DoorPopulation) -> KindPage:
    """Return the page of the doors of many cars."""
    specimen_spread = population.spread
    tested = (
        "stated"
        if specimen_spread.specimens is None
        else f"{specimen_spread.specimens} seals of the lot"
    )
    limited = tuple(
        _make_share_row(quantity)
        for quantity in population.quantities
        if quantity.nonconforming_share is not None
    )
    scattered = {
        quantity.name.replace(" ", "_")
        for quantity in population.quantities
        if quantity.between_sd > MIN_SD
    }
    other_values = tuple(
        reported_value for reported_value in population.facts if reported_value.name in scattered
    )
    groups = [group("95 % of the cars lie from, to", other_values)]
    if limited:
        groups.insert(0, Group("Share beyond a limit, with its 95 % interval", limited))
    return KindPage(
        subject="doors of many cars",
        summary_line=(
            ("Scatter between seals", f"{100 * specimen_spread.between_sd:.2g} %, {tested}"),
            ("Error of their mean", f"{100 * specimen_spread.mean_sd:.2g} %"),
        ),
        indicators=make_indicators(
            population.checks, Topic("Seal and door"),
            Topic("Scatter", {"seals_suffice", "scatter_exceeds_testing"},
                  "stated" if specimen_spread.specimens is None else "known"),
        ) + tuple(
            Indicator("Limit", "note", f"{row.name}: {row.value} %") for row in limited
        ),
        figure_title="How the cars differ",
        picture=draw_population(population),
        table_title="Of the cars",
        groups=tuple(groups),
        sources=population.sources,
        note="Of a share, from and to are its 95 % interval.",
    )  # fmt: skip


def _make_share_row(quantity: DoorQuantity) -> Row:
    """Return the row of the share of the cars beyond a limit."""
    low, high = format_share(quantity.share_low), format_share(quantity.share_high)
    range_texts = ("", "") if low == high else (low, high)
    name = f"cars with {quantity.label} {format_limit(quantity)}"
    return Row(
        name, format_share(quantity.nonconforming_share), *range_texts, "%", "", is_limit=False
    )


def _draw_quantity(quantity: DoorQuantity, mean: float) -> Panel:
    """Return the density of a quantity over the cars."""
    u, values = np.log(quantity.factors), np.log(quantity.values)
    slope = abs(float(np.polynomial.Polynomial.fit(u, values, 4).deriv()(mean)))
    between_sd = max(quantity.between_sd, 1e-9 * max(slope, 1e-9))
    half_range = _PANEL_WIDTHS * between_sd
    limit = quantity.limit
    axis_values = [quantity.value * np.exp(-half_range), quantity.value * np.exp(half_range)]
    if limit is not None:
        axis_values += [limit / (1 + half_range / 8), limit * (1 + half_range / 8)]
    x = np.linspace(min(axis_values), max(axis_values), _POINTS)
    density = np.exp(-0.5 * (np.log(x / quantity.value) / between_sd) ** 2)
    in_interval = (x >= quantity.low) & (x <= quantity.high)
    zero = np.zeros_like(x)
    marks: list[Mark] = [
        Area(x[in_interval], zero[in_interval], density[in_interval], "fit", "95 % of the cars"),
        Line(x, density, FIT, "cars"),
    ]
    note = ""
    if limit is not None and quantity.nonconforming_share is not None:
        is_beyond = x > limit if quantity.limit_is_most else x < limit
        if is_beyond.sum() > 1:
            marks.append(
                Area(
                    x[is_beyond],
                    zero[is_beyond],
                    density[is_beyond],
                    "bad",
                    "beyond the limit",
                    tint=0.6,
                )
            )
        marks.append(Rule(limit, REJECTED, "limit"))
        note = f"{format_share(quantity.nonconforming_share)} % beyond"
        if quantity.share_low != quantity.share_high:
            low, high = format_share(quantity.share_low), format_share(quantity.share_high)
            note += f" ({low} to {high})"
    horizontal = Scale(f"{quantity.label}, {quantity.unit}", (float(x[0]), float(x[-1])))
    up = Scale("density over its largest", (0.0, 1.1))
    return Panel(horizontal, up, tuple(marks), note=note)
