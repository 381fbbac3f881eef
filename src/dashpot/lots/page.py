"""A lot as one page: what it is like, where its scatter comes from, what stands out, every test."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from importlib import resources
from itertools import groupby
from math import isfinite
from typing import Any, NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import verdict
from dashpot.base.errors import DataError
from dashpot.base.numbers import counted, rounded
from dashpot.base.version import byline
from dashpot.lots.lot import Lot
from dashpot.lots.statistics.control import individuals
from dashpot.plot import tokens
from dashpot.plot.picture import (
    Area,
    Axis,
    Dots,
    Line,
    Mark,
    Panel,
    Pen,
    Picture,
    Tag,
    around,
    around_log,
)
from dashpot.report.figures import Drawn, drawn
from dashpot.report.pages import COLOURS, digest, environment

CURVES = 200
"""Drawn at most, evenly over the lot; more would be one stain."""
WIDE = 1180.0
_CURVE = Pen("measured", 0.8)
_MEAN = Pen("fit", 2.0)
_THREAD = Pen("ref", 0.8)


class Point(NamedTuple):
    """A seal, or a test whose seal nobody named: its lot, its name, and its stiffness, N/mm."""

    lot: str
    name: str
    stiffness: float


def html(lot: Lot, *, title: str = "Lot") -> str:
    """Return the page of a lot as one self-contained file: no network, no script.

    Whatever came from a file or its name is escaped.
    """
    style = f"{tokens.css()}\n{_part('lot.css')}"
    found = verdict(lot.checks, sound="every file is a test whose fit may be used")
    points = tuple(_points(lot))
    return str(
        environment("dashpot.lots")
        .get_template("lot.html")
        .render(
            title=title,
            byline=byline("lot"),
            style=style,
            policy=f"default-src 'none'; style-src {digest(style)}; base-uri 'none'; "
            "form-action 'none'",
            verdict=found,
            colour=COLOURS[found.use],
            counts=_counts(lot, points),
            what="seals: means of their tests" if _sealed(lot) else "tests",
            chart=_drawn("chart", _chart(points)) if points else None,
            curves=_drawn("curves", _curves(lot)) if points else None,
            scatter=_scatter(lot),
            outliers=[(file, f"{away:+.1f}") for file, away in lot.outliers()],
            short=lot.short_holds,
            others=_others(lot),
            tests=_tests(lot),
        )
    )


@cache
def _part(name: str) -> str:
    return resources.files("dashpot.lots").joinpath("templates", name).read_text("utf-8").strip()


# -- figures --------------------------------------------------------------------------------------


def _sealed(lot: Lot) -> bool:
    return bool((lot.used["seal"] != "").any())


def _points(lot: Lot) -> Iterator[Point]:
    """One point for each seal, else for each test, lot by lot."""
    rows = lot.used.drop_nulls("k_end_N_per_m").sort("lot", "seal", "file")
    named = _sealed(lot)
    told = zip(rows["lot"], rows["seal"] if named else rows["file"], rows["k_end_N_per_m"],
               strict=True)  # fmt: skip
    for (of, name), tests in groupby(told, key=lambda row: (row[0], row[1])):
        yield Point(str(of), str(name), 1e-3 * float(np.mean([row[2] for row in tests])))


def _chart(points: Sequence[Point]) -> Panel:
    """Individual values with the control limits of each lot."""
    x = np.arange(1, len(points) + 1, dtype=float)
    y = np.array([one.stiffness for one in points])
    marks: list[Mark] = [Line(x, y, _THREAD)]
    edges = [y]
    for name, members in groupby(enumerate(points), key=lambda pair: pair[1].lot):
        at = np.array([i for i, _ in members])
        if len(at) < 2:
            continue
        limits, _ = individuals(y[at])
        mean, low, high = limits.centre, float(limits.lower[0]), float(limits.upper[0])
        ends = np.array([at[0] + 0.5, at[-1] + 1.5])
        level = np.ones(2)
        marks.insert(0, Area(ends, low * level, high * level, "fit", "control limits of each lot"))
        marks.append(Line(ends, mean * level, _MEAN, "mean of each lot"))
        marks += [
            Tag(x[i], y[i], points[i].name, "care-ink", "hollow")
            for i in at
            if not low <= y[i] <= high
        ]
        if name:
            marks.append(Tag(ends[0], high, f"lot {name}", "soft"))
        edges.append(np.array([low, high]))
    marks.append(Dots(x, y, "measured", "seal or test", size=5.0))
    axes = (
        Axis("in the order of lot and seal, no.", (0.5, len(points) + 0.5)),
        Axis("stiffness at the end of the hold, N/mm", around(*edges)),
    )
    return Panel(*axes, tuple(marks), height=200)


def _curves(lot: Lot) -> Panel:
    """The relaxation of every solid, from a hundredth of a second to the end of the hold."""
    rows = lot.used.drop_nulls("k_end_N_per_m")
    kept = np.unique(np.linspace(0, rows.height - 1, min(rows.height, CURVES)).astype(int))
    time = np.geomspace(1e-2, max(float(rows["hold_s"].max() or 1.0), 1.0), 80)  # type: ignore[arg-type]
    drawn = [_relaxation(rows.row(int(i), named=True), time) for i in kept]
    marks = tuple(Line(time, k, _CURVE, "solid of each test") for k in drawn)
    axes = (
        Axis("time after a step, s", (float(time[0]), float(time[-1])), log=True),
        Axis("stiffness k(t), N/mm", around_log(*drawn, margin=1.05), log=True),
    )
    return Panel(*axes, marks, height=170)


def _relaxation(row: dict[str, Any], time: FloatArray) -> FloatArray:
    k = np.full(len(time), float(row["k_inf_N_per_m"]))
    for j in range(1, int(row["arms"]) + 1):
        k += row[f"k_{j}_N_per_m"] * np.exp(-time / row[f"tau_{j}_s"])
    return np.asarray(1e-3 * k)


def _drawn(name: str, panel: Panel) -> Drawn:
    return drawn(Picture(name, panel.y.label, ((panel,),)), width=WIDE)


# -- words and tables -----------------------------------------------------------------------------


def _counts(lot: Lot, points: Sequence[Point]) -> str:
    lots = len({one.lot for one in points})
    told = f"{counted(lot.table.height, 'file')}, {counted(lot.used.height, 'fit')} used"
    return f"{told}, {counted(lots, 'lot')}" if lots > 1 else told


def _scatter(lot: Lot) -> list[tuple[str, str, str, str, str, float]]:
    """Source, share in per cent, standard deviation and its ends, N/mm, and the share of a bar."""
    try:
        found = lot.components("k_end_N_per_m")
    except DataError:
        return []
    rows = []
    for one in found:
        low, high = ("", "") if one.interval is None else (
            rounded(1e-3 * end**0.5, digits=2) if isfinite(end) else "no limit"
            for end in one.interval
        )  # fmt: skip
        sd = rounded(1e-3 * one.variance**0.5, digits=2)
        rows.append((one.source, f"{100 * one.share:.1f}", sd, low, high, 100 * one.share))
    return rows


def _others(lot: Lot) -> list[tuple[str, str]]:
    rows = lot.table.select("file", "outcome", "reason").iter_rows()
    return [(file, reason) for file, outcome, reason in rows if outcome != "fitted"]


def _tests(lot: Lot) -> list[dict[str, str]]:
    """Every fitted test, those not to be used first."""
    gravity = {"do not use": 0, "use with care": 1}
    rows = [row for row in lot.table.iter_rows(named=True) if row["outcome"] == "fitted"]
    rows.sort(key=lambda row: (gravity.get(row["verdict"], 2), row["file"]))
    return [
        {
            "file": row["file"],
            "lot": row["lot"],
            "seal": row["seal"],
            "repeat": row["repeat"],
            "end": _read(row["k_end_N_per_m"], 1e-3),
            "once": _read(row["k_0_N_per_m"], 1e-3),
            "frequency": _read(row.get("frequency_Hz")),
            "verdict": row["verdict"] or "point estimate",
            "mark": COLOURS.get(row["verdict"], ""),
            "reason": row["reason"] or "",
        }
        for row in rows
    ]


def _read(value: float | None, scale: float = 1.0) -> str:
    return "" if value is None else rounded(scale * value, digits=4)
