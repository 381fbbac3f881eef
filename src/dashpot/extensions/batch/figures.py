"""Figures of a lot: control charts, capability, all curves."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.number_format import round_to_error
from dashpot.base.units import convert_to_unit
from dashpot.extensions.batch.quantities import Quantity
from dashpot.extensions.batch.seals import (
    Charts,
    LotCharts,
    Seal,
    average_seals,
    split_seals_by_lot,
)
from dashpot.extensions.batch.statistics.control_chart import Chart
from dashpot.extensions.batch.statistics.process_capability import Capability
from dashpot.plot.picture import Area, Dots, Line, Mark, Panel, Pen, Picture, Ring, Rule, Scale, Tag
from dashpot.plot.plotted_data import compute_padded_limits, compute_padded_log_limits

_SAMPLES = 80
_BARS, _MAX_BARS = 6, 24
"""Bars of a histogram, at least and at most."""
CHART = 210.0
"""Height of the chart and of the histogram beside it, px."""
_GROUPS = 8
"""Largest number of group names above a chart."""
_CURVE = Pen("measured", 0.8)
_OUTLIER_PEN = Pen("care", 1.6)
_MEAN = Pen("fit", 2.0)
_LOT_PEN = Pen("fit", 1.4)
_CEILING = Pen("fit", 1.4, (2, 3))
_THREAD = Pen("ref", 0.8)
_LIMIT_PEN = Pen("bad", 1.6, (5, 3))
_SHAPE = Pen("measured", 1.6)


def control_picture(
    quantity: Quantity,
    charts: Mapping[str, Charts],
    seals: Sequence[Seal],
    requested: Sequence[float] = (),
) -> Picture:
    """Return seals in their order with the control limits of each lot, and the scatter inside.

    Below the seals are the standard deviations of their repeats or, if no seal was tested twice,
    the moving ranges. Limits that are `requested`, SI, are drawn across.
    """
    positions = {(seal.lot, seal.name): i + 1.0 for i, seal in enumerate(seals)}
    scale = Scale("seal, in the order of lot and name", (0.5, max(len(seals), 1) + 0.5), whole=True)
    x = np.arange(1.0, len(seals) + 1)
    y = quantity.scale * average_seals(seals)
    areas: list[Mark] = []
    marks: list[Mark] = [Line(x, y, _THREAD)]
    titles, spans = list[tuple[float, str]](), list[tuple[Charts, FloatArray]]()
    for name, chart in charts.items():
        seal_positions = np.array([positions[seal.lot, seal.name] for seal in chart.seals])
        end_positions = _get_axis_limits(seal_positions)
        lower_line, centre, upper_line = (
            quantity.scale * value * np.ones(2)
            for value in (chart.means.lower[0], chart.means.centre, chart.means.upper[0])
        )
        areas.insert(
            0, Area(end_positions, lower_line, upper_line, "fit", "control limits of each lot")
        )
        marks.append(Line(end_positions, centre, _MEAN, "mean of each lot"))
        marks += _make_signal_tags(chart.seals, chart.means, seal_positions, quantity.scale)
        if name:
            titles.append((float(end_positions[0]), name))
        spans.append((chart, seal_positions))
    limits = quantity.scale * np.array(requested)
    marks += [Rule(end, _LIMIT_PEN, "limits asked", is_horizontal=True) for end in limits]
    marks.append(Dots(x, y, "measured", "seal: mean of its tests", size=5.0))
    low, high = _make_value_axis(quantity, charts, seals, requested)
    marks += [Tag(seal_positions, high, text, "soft") for seal_positions, text in titles]
    upper = Panel(scale, Scale(quantity.title, (low, high)), (*areas, *marks), height=CHART)
    panels = (upper, *_make_scatter_panel(scale, quantity, spans))
    return Picture("chart", f"{quantity.title}: seals of each lot", (panels,))


def _make_scatter_panel(
    scale: Scale, quantity: Quantity, spans: Sequence[tuple[Charts, FloatArray]]
) -> Iterator[Panel]:
    """The panel of repeats or neighbours, unless there are none; each lot with its places."""
    repeated = any(charts.repeats is not None for charts, _ in spans)
    scatter_title = "SD of repeats" if repeated else "moving range"
    marks, heights = list[Mark](), [np.zeros(1)]
    for item, lot_positions in spans:
        chart = item.repeats if repeated else item.moving
        if chart is None:
            continue
        values, ceiling = quantity.scale * chart.values, quantity.scale * chart.upper
        marks += [
            Line(
                _get_axis_limits(lot_positions),
                quantity.scale * chart.centre * np.ones(2),
                _LOT_PEN,
            ),
            Line(lot_positions, ceiling, _CEILING, "its upper control limit"),
            Dots(lot_positions, values, "measured", size=4.0),
            *_make_signal_tags(item.seals, chart, lot_positions, quantity.scale),
        ]
        heights += [values, ceiling]
    if marks:
        top = 1.15 * max(float(np.nanmax(height, initial=0.0)) for height in heights) or 1.0
        title = f"{scatter_title}, {quantity.unit}".rstrip(", ")
        yield Panel(scale, Scale(title, (0.0, top)), tuple(marks), height=70)


def _get_axis_limits(positions: FloatArray) -> FloatArray:
    return np.array([positions[0] - 0.5, positions[-1] + 0.5])


def _make_signal_tags(
    seals: Sequence[Seal], chart: Chart, positions: FloatArray, scale: float
) -> list[Tag]:
    """Return the names of the seals that break a rule."""
    return [
        Tag(
            float(positions[i]), scale * float(chart.values[i]), seals[i].name, "care-ink", "hollow"
        )
        for i in dict.fromkeys(signal.point for signal in chart.signals)
    ]


def _make_value_axis(
    quantity: Quantity,
    charts: Mapping[str, Charts],
    seals: Sequence[Seal],
    limits: Sequence[float],
) -> tuple[float, float]:
    """The upright axis that chart and histogram share: seals, control limits, what is asked."""
    edges = [quantity.scale * average_seals(seals), quantity.scale * np.array(limits)]
    for chart in charts.values():
        edges += [quantity.scale * chart.means.lower, quantity.scale * chart.means.upper]
    low, high = compute_padded_limits(np.concatenate(edges))
    # the names of the lots stand above all that is drawn
    return low, high + 0.12 * (high - low)


def histogram_picture(
    quantity: Quantity,
    charts: Mapping[str, Charts],
    seals: Sequence[Seal],
    required_limits: Sequence[float] = (),
) -> Picture:
    """Return the means of all seals as a histogram that lies on the axis of their chart."""
    means = quantity.scale * average_seals(seals)
    counts, edges = np.histogram(
        means, bins=max(_BARS, min(_MAX_BARS, int(1.5 * len(means) ** 0.5)))
    )
    gap = 0.06 * (edges[1] - edges[0])
    marks: list[Mark] = [
        Area(np.array([0.0, count]), np.full(2, low + gap), np.full(2, high - gap), "ref", "seals",
             tint=0.5)
        for low, high, count in zip(edges[:-1], edges[1:], counts.tolist(), strict=True) if count
    ]  # fmt: skip
    limits = _make_value_axis(quantity, charts, seals, required_limits)
    mean, top = float(means.mean()), float(counts.max())
    deviation = float(means.std(ddof=1)) if len(means) > 1 else 0.0
    if deviation > 0:
        y = np.linspace(*limits, 121)
        shape = np.exp(-0.5 * ((y - mean) / deviation) ** 2) / (deviation * np.sqrt(2 * np.pi))
        shape *= len(means) * (edges[1] - edges[0])
        top = max(top, float(shape.max()))
        marks.append(Line(shape, y, _SHAPE, "normal"))
    marks += [Rule(quantity.scale * end, _LIMIT_PEN, is_horizontal=True) for end in required_limits]
    marks += [Rule(mean, _MEAN, is_horizontal=True)]
    text = round_to_error(mean, deviation / 10 if deviation > 0 else None)
    scale = Scale("seals", (0.0, 1.1 * top), whole=True)
    vertical = Scale(f"all {len(seals)} seals", limits, unnumbered=True)
    panel = Panel(scale, vertical, tuple(marks), height=CHART, note=f"mean {text}")
    return Picture("histogram", f"{quantity.title}: all seals", ((panel,),))


def cpk_picture(capabilities: Sequence[Capability], required_cpk: float | None) -> Picture:
    """Return the Cpk of each lot with its interval, the lowest first."""
    ranked_lots = sorted(capabilities, key=lambda capability: capability.cpk or 0.0)
    ranks = np.arange(1.0, len(ranked_lots) + 1)
    cpk = np.array([capability.cpk or 0.0 for capability in ranked_lots])
    low, high = (
        np.array([(capability.cpk_interval or (0.0, 0.0))[i] for capability in ranked_lots])
        for i in (0, 1)
    )
    # along a line each lot has its interval; so drawn, they make one area
    marks: list[Mark] = [
        Ring(
            np.concatenate([low, high[::-1]]),
            np.concatenate([ranks, ranks[::-1]]),
            "ref",
            "95 %",
            0.4,
        ),
        Line(cpk, ranks, Pen("measured", 1.8), "Cpk"),
    ]
    interval = [low, high]
    if required_cpk is not None:
        marks.append(Rule(required_cpk, _LIMIT_PEN, "required"))
        interval.append(np.array([required_cpk]))
    horizontal = Scale("Cpk", compute_padded_limits(*interval))
    vertical = Scale("", (0.0, len(ranked_lots) + 1.0), unnumbered=True)
    panel = Panel(horizontal, vertical, tuple(marks), height=70, without_y_label=True)
    return Picture("cpks", "Cpk of every lot", ((panel,),))


def lots_picture(
    quantity: Quantity,
    charts: Mapping[str, Charts],
    lots: LotCharts | None,
    seals: Sequence[Seal],
    required_limits: Sequence[float] = (),
) -> Picture:
    """Return each lot as a dot, the middle 90 % and all of its seals, and the scatter of repeats.

    Control limits are those of the means of lots; points that break a rule have a ring.
    """
    entries = {
        name: quantity.scale * average_seals(seal)
        for name, seal in split_seals_by_lot(seals).items()
    }
    names, lot_positions = list(entries), np.arange(1.0, len(entries) + 1)
    scale = Scale("lot, in the order of name", (0.5, len(names) + 0.5), whole=True)
    means = np.array([entry.mean() for entry in entries.values()])
    low, lower_quartile, upper_quartile, high = (
        np.array([np.quantile(entry, part) for entry in entries.values()])
        for part in (0.0, 0.05, 0.95, 1.0)
    )
    marks: list[Mark] = []
    if lots is not None:
        edges = quantity.scale * lots.mean.lower, quantity.scale * lots.mean.upper
        marks.append(Area(lot_positions, *edges, "fit", "control limits of lot means"))
        marks.append(
            Rule(quantity.scale * lots.mean.centre, _MEAN, "mean of all", is_horizontal=True)
        )
    marks.append(_make_error_bars(lot_positions, low, high, Pen("ref", 1.0), "all of its seals"))
    marks.append(
        _make_error_bars(
            lot_positions, lower_quartile, upper_quartile, Pen("ref", 5.0), "90 % of its seals"
        )
    )
    marks += [
        Rule(quantity.scale * end, _LIMIT_PEN, "limits asked", is_horizontal=True)
        for end in required_limits
    ]
    marks.append(Dots(lot_positions, means, "measured", "mean of a lot", size=5.0))
    if lots is not None and lots.mean.signalling_points:
        signalling = [names.index(lots.names[i]) for i in lots.mean.signalling_points]
        marks.insert(
            -1,
            Dots(
                lot_positions[signalling],
                means[signalling],
                "care",
                "signal",
                size=10.0,
                hollow=True,
            ),
        )
    limits = _make_value_axis(quantity, charts, seals, required_limits)
    marks += _group_lots(names, means, limits[1])
    upper = Panel(scale, Scale(quantity.title, limits), tuple(marks), height=CHART)
    panels = (upper, *_make_repeats_panel(scale, quantity, names, charts))
    return Picture("chart", f"{quantity.title}: every lot", (panels,))


def _make_error_bars(
    positions: FloatArray, low: FloatArray, high: FloatArray, pen: Pen, label: str
) -> Line:
    """Upright strokes as one line that breaks between them."""
    gap = np.full(len(positions), np.nan)
    x, y = (
        np.column_stack([positions, positions, gap]).ravel(),
        np.column_stack([low, high, gap]).ravel(),
    )
    return Line(x, y, pen, label)


def _group_lots(names: Sequence[str], means: FloatArray, label_height: float) -> Iterator[Mark]:
    """Lots that are named alike but for a number: where each group begins, and its mean.

    Of lots that are one group, or of no group, some are named.
    """
    stems = [name.rstrip("0123456789") for name in names]
    starts = [i for i, stem in enumerate(stems) if i == 0 or stem != stems[i - 1]]
    if 1 < len(starts) <= _GROUPS:
        for start, stop in zip(starts, [*starts[1:], len(names)], strict=True):
            span = names[start] if stop - start == 1 else f"{names[start]} to {names[stop - 1]}"
            if start:
                yield Rule(start + 0.5, Pen("edge", 1.0))
            words = f"{span}  mean {round_to_error(float(means[start:stop].mean()), digits=4)}"
            yield Tag(start + 0.7, label_height, words, "soft")
        return
    step = -(-len(names) // _GROUPS) if len(names) > 2 * _GROUPS else 1
    for i in range(0, len(names), max(step, 1)):
        yield Tag(i + 1.0, label_height, names[i], "soft")


def _make_repeats_panel(
    scale: Scale, quantity: Quantity, names: Sequence[str], charts: Mapping[str, Charts]
) -> Iterator[Panel]:
    """The standard deviations of repeats, a column of dots a lot; those beyond are named."""
    x, y, tags, centres = list[FloatArray](), list[FloatArray](), list[Mark](), []
    for i, name in enumerate(names):
        single_charts = charts.get(name)
        if single_charts is None or single_charts.repeats is None:
            continue
        values = quantity.scale * single_charts.repeats.values
        x.append(np.full(len(values), i + 1.0))
        y.append(values)
        centres.append(quantity.scale * single_charts.repeats.centre)
        tags += [
            Tag(
                i + 1.0,
                float(values[index]),
                f"{name}-{single_charts.seals[index].name}",
                "care-ink",
                "hollow",
            )
            for index in single_charts.repeats.signalling_points
        ]
    if not y:
        return
    all_values = np.concatenate(y)
    marks: list[Mark] = [Dots(np.concatenate(x), all_values, "ref", size=2.5),
                         Rule(float(np.mean(centres)), _LOT_PEN, is_horizontal=True)]  # fmt: skip
    marks += tags[:_GROUPS]
    title = f"SD of repeats of each seal, {quantity.unit}".rstrip(", ")
    top = 1.2 * float(np.nanmax(all_values, initial=0.0)) or 1.0
    yield Panel(scale, Scale(title, (0.0, top)), tuple(marks), height=70)


def curves_picture(rows: Sequence[Mapping[str, Any]], outliers: Sequence[str] = ()) -> Picture:
    """Return the relaxation of the solid of every row, from 10 ms to the end of its hold."""
    longest = max((float(row["hold_s"] or 0.0) for row in rows), default=0.0)
    time = np.geomspace(1e-2, max(longest, 1.0), _SAMPLES)
    curves = [_compute_relaxation(row, time) for row in rows]
    marks = tuple(
        Line(time, k, _OUTLIER_PEN if row["file"] in outliers else _CURVE,
             "stands out" if row["file"] in outliers else "model of each test")
        for row, k in zip(rows, curves, strict=True)
    )  # fmt: skip
    axes = (
        Scale("time after a step, s", (float(time[0]), float(time[-1])), log=True),
        Scale("stiffness k(t), N/mm", compute_padded_log_limits(*curves, margin=1.05), log=True),
    )
    return Picture("curves", "relaxation of every model", ((Panel(*axes, marks, height=170),),))


def _compute_relaxation(row: Mapping[str, Any], time: FloatArray) -> FloatArray:
    k = np.full(len(time), float(row["k_inf_N_per_m"]))
    for j in range(1, int(row["arms"]) + 1):
        k += row[f"k_{j}_N_per_m"] * np.exp(-time / row[f"tau_{j}_s"])
    return convert_to_unit(k, "N/mm")
