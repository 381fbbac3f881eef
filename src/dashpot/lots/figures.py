"""The figures of a lot: control charts, capability, every curve."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.units import in_unit
from dashpot.lots.quantities import Quantity
from dashpot.lots.seals import Charts, Seal, seal_means
from dashpot.lots.statistics.control import Chart
from dashpot.plot.picture import (
    Area,
    Dots,
    Line,
    Mark,
    Panel,
    Pen,
    Picture,
    Rule,
    Scale,
    Tag,
    around,
    around_log,
)

_SAMPLES = 80
_BARS = 6
"""Bars at least, of a histogram."""
_CURVE = Pen("measured", 0.8)
_ODD = Pen("care", 1.6)
_MEAN = Pen("fit", 2.0)
_USUAL = Pen("fit", 1.4)
_CEILING = Pen("fit", 1.4, (2, 3))
_THREAD = Pen("ref", 0.8)
_ASKED = Pen("bad", 1.6, (7, 4))
_SHAPE = Pen("measured", 1.6)


def control_picture(
    quantity: Quantity,
    charts: Mapping[str, Charts],
    seals: Sequence[Seal],
    asked: Sequence[float] = (),
) -> Picture:
    """Return seals in their order with the control limits of each lot, and the scatter inside.

    Below the seals stand the standard deviations of their repeats, or, where no seal was tested
    twice, the moving ranges of neighbours. Limits that are `asked`, SI, are drawn across.
    """
    place = {(one.lot, one.name): i + 1.0 for i, one in enumerate(seals)}
    scale = Scale("seal, in the order of lot and name", (0.5, max(len(seals), 1) + 0.5))
    x = np.arange(1.0, len(seals) + 1)
    y = quantity.scale * seal_means(seals)
    areas: list[Mark] = []
    marks: list[Mark] = [Line(x, y, _THREAD)]
    edges, titles, spans = [y], list[tuple[float, str]](), list[tuple[Charts, FloatArray]]()
    for name, one in charts.items():
        at = np.array([place[seal.lot, seal.name] for seal in one.seals])
        ends = _ends(at)
        least, centre, most = (
            quantity.scale * value * np.ones(2)
            for value in (one.means.lower[0], one.means.centre, one.means.upper[0])
        )
        areas.insert(0, Area(ends, least, most, "fit", "control limits of each lot"))
        marks.append(Line(ends, centre, _MEAN, "mean of each lot"))
        marks += _named(one.seals, one.means, at, quantity.scale)
        if name:
            titles.append((float(ends[0]), name))
        edges += [least, most]
        spans.append((one, at))
    limits = quantity.scale * np.array(asked)
    marks += [Rule(end, _ASKED, "limits asked", across=True) for end in limits]
    marks.append(Dots(x, y, "measured", "seal: mean of its tests", size=5.0))
    low, high = around(np.concatenate([*edges, limits]))
    # the names of the lots stand above all that is drawn
    marks += [Tag(at, high, text, "soft") for at, text in titles]
    reach = (low, high + 0.12 * (high - low) * bool(titles))
    upper = Panel(scale, Scale(quantity.title, reach), (*areas, *marks), height=190)
    panels = (upper, *_scatter(scale, quantity, spans))
    return Picture("chart", f"{quantity.title}: seals of each lot", (panels,))


def _scatter(
    scale: Scale, quantity: Quantity, spans: Sequence[tuple[Charts, FloatArray]]
) -> Iterator[Panel]:
    """The panel of repeats or neighbours, unless there are none; each lot with its places."""
    repeated = any(one.repeats is not None for one, _ in spans)
    what = "SD of repeats" if repeated else "moving range"
    marks, heights = list[Mark](), [np.zeros(1)]
    for one, at in spans:
        chart = one.repeats if repeated else one.moving
        if chart is None:
            continue
        values, ceiling = quantity.scale * chart.values, quantity.scale * chart.upper
        marks += [
            Line(_ends(at), quantity.scale * chart.centre * np.ones(2), _USUAL),
            Line(at, ceiling, _CEILING, "its upper control limit"),
            Dots(at, values, "measured", size=4.0),
            *_named(one.seals, chart, at, quantity.scale),
        ]
        heights += [values, ceiling]
    if marks:
        top = 1.15 * max(float(np.nanmax(one, initial=0.0)) for one in heights) or 1.0
        title = f"{what}, {quantity.unit}".rstrip(", ")
        yield Panel(scale, Scale(title, (0.0, top)), tuple(marks), height=70)


def _ends(at: FloatArray) -> FloatArray:
    return np.array([at[0] - 0.5, at[-1] + 0.5])


def _named(seals: Sequence[Seal], chart: Chart, at: FloatArray, scale: float) -> list[Tag]:
    """The names of the seals that break a rule."""
    return [
        Tag(float(at[i]), scale * float(chart.values[i]), seals[i].name, "care-ink", "hollow")
        for i in dict.fromkeys(signal.point for signal in chart.signals)
    ]


def capability_picture(
    quantity: Quantity, seals: Sequence[Seal], asked: Sequence[float]
) -> Picture:
    """Return the tests of one lot as a histogram, the normal curve of its seals, and the limits."""
    tests = quantity.scale * np.concatenate([one.values for one in seals])
    means = quantity.scale * seal_means(seals)
    ends = quantity.scale * np.array(asked)
    counts, edges = np.histogram(tests, bins=max(_BARS, int(1.5 * np.sqrt(len(tests)))))
    width, gap = edges[1] - edges[0], 0.08
    bars = tuple(
        Area(
            left + width * np.array([gap, 1 - gap]), np.zeros(2), np.full(2, float(count)),
            "fit", "tests", tint=0.55,
        )
        for left, count in zip(edges, counts, strict=False)
        if count
    )  # fmt: skip
    mean, deviation = float(means.mean()), float(means.std(ddof=1))
    span = around(edges, ends, margin=0.08)
    marks: list[Mark] = [*bars, *(Rule(end, _ASKED, "limits asked") for end in ends)]
    top = float(counts.max())
    if deviation > 0:
        x = np.linspace(*span, 161)
        shape = np.exp(-0.5 * ((x - mean) / deviation) ** 2) / (deviation * np.sqrt(2 * np.pi))
        shape *= len(tests) * width
        marks.append(Line(x, shape, _SHAPE, "normal, from the means of the seals"))
        top = max(top, float(shape.max()))
    axes = Scale(quantity.title, span), Scale("tests", (0.0, 1.12 * top))
    caption = f"{quantity.title}: tests of a lot and the limits asked"
    return Picture("capability", caption, ((Panel(*axes, tuple(marks), height=150),),))


def curves_picture(rows: Sequence[Mapping[str, Any]], odd: Sequence[str] = ()) -> Picture:
    """Return the relaxation of the solid of every row, from 10 ms to the end of its hold."""
    longest = max((float(one["hold_s"] or 0.0) for one in rows), default=0.0)
    time = np.geomspace(1e-2, max(longest, 1.0), _SAMPLES)
    drawn = [_relaxation(one, time) for one in rows]
    marks = tuple(
        Line(time, k, _ODD if one["file"] in odd else _CURVE,
             "stands out" if one["file"] in odd else "solid of each test")
        for one, k in zip(rows, drawn, strict=True)
    )  # fmt: skip
    axes = (
        Scale("time after a step, s", (float(time[0]), float(time[-1])), log=True),
        Scale("stiffness k(t), N/mm", around_log(*drawn, margin=1.05), log=True),
    )
    return Picture("curves", "relaxation of every solid", ((Panel(*axes, marks, height=170),),))


def _relaxation(row: Mapping[str, Any], time: FloatArray) -> FloatArray:
    k = np.full(len(time), float(row["k_inf_N_per_m"]))
    for j in range(1, int(row["arms"]) + 1):
        k += row[f"k_{j}_N_per_m"] * np.exp(-time / row[f"tau_{j}_s"])
    return in_unit(k, "N/mm")
