"""Page of a lot: distribution, variance components, outliers and all tests."""

from __future__ import annotations

import hashlib
import json
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from importlib import resources
from typing import Any

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import GRADES, Check
from dashpot.base.number_format import format_count, round_to_error
from dashpot.base.units import format_quantity
from dashpot.base.version import byline
from dashpot.extensions.batch.figures import (
    control_picture,
    cpk_picture,
    curves_picture,
    histogram_picture,
    lots_picture,
)
from dashpot.extensions.batch.input_files import LABELS
from dashpot.extensions.batch.lot import Lot
from dashpot.extensions.batch.quantities import Quantity
from dashpot.extensions.batch.seals import Seal, average_seals, split_seals_by_lot
from dashpot.extensions.batch.statistics.control_chart import MIN_POINTS, OUTSIDE_LIMITS
from dashpot.extensions.batch.statistics.gauge_rr import GOOD_SHARE, LIMIT
from dashpot.extensions.batch.summary import QuantitySummary, Summary, summary
from dashpot.plot.picture import Picture
from dashpot.report.figures import PAPER_WIDTH, RenderedFigure, render_figure
from dashpot.report.first_screen import MARK_ORDER
from dashpot.report.page_frame import VERDICT_COLOURS, digest, environment, frame

ROWS = 50
"""Rows of a table or a list in the page: its height does not depend on the number of tests."""
BY_SEALS, FEW_LOTS, MAX_FLAGS = 100, 6, 6
"""Most seals that the chart shows one by one, lots in the table of Cpk, and rows of the gravest
flags."""
CURVES = 200
"""Largest number of drawn curves, evenly over the lot, and as many outliers."""
CHART_WIDTH, SIDE_WIDTH = 920.0, 250.0
"""Widths of the chart and of the figure beside it, px."""
_GRAVITY = {"fail": 0, "not proven": 1, "no result": 2, "look": 3}
_MARKS = {"fail": "bad", "not proven": "care", "no result": "note", "pass": "good", "look": "care"}
_SOURCES = {
    "repeatability": "repeats", "operator": "operators", "interaction": "operator and seal",
    "gauge": "gauge R&R", "part": "seals", "total": "all",
}  # fmt: skip


def html(lot: Lot, *, title: str = "Lot", lot_summary: Summary | None = None) -> str:
    """Return the page of a lot as one self-contained file: no network.

    Its height does not depend on how many tests there are: tables hold the gravest rows, and the
    script, which a content security policy names, turns the pages of all, filters them, and goes
    from a point of the chart to its tests. Without it the page is whole but for the others, which
    stand in ``lot.csv``. Whatever came from a file or its name is escaped.

    Parameters
    ----------
    lot : Lot
    title : str
    lot_summary : Summary, optional
        Values of the summary; by default of the stiffness at the end of the hold, without limits.
    """
    lot_summary = lot_summary or summary(lot)
    frame_values = frame()
    style = f"{frame_values['style']}\n{_read_page_part('lot.css')}"
    script = _read_page_part("lot.js")
    verdict, main = lot_summary.verdict, lot_summary.main
    quantities = _select_other_quantities(lot, main)
    # a lot of an earlier version has no date
    names = [name for name in LABELS if name in lot.table.columns]
    labels = [name for name in names if (lot.table[name].fill_null("") != "").any()]
    tests, by_lots = _make_test_rows(lot_summary, labels), len(main.seals) > BY_SEALS
    signals, findings = (
        list(_make_signal_rows(main)),
        sorted(_list_findings(lot_summary), key=lambda entry: -MARK_ORDER.index(entry["mark"])),
    )
    seals = _make_seal_rows(lot_summary, quantities)
    return str(
        environment("dashpot.extensions.batch")
        .get_template("lot.html")
        .render(
            title=title,
            byline=byline("lot"),
            style=style,
            script=script,
            policy=f"default-src 'none'; style-src {digest(style)}; script-src {digest(script)}; "
            "base-uri 'none'; form-action 'none'",
            verdict=verdict,
            colour=VERDICT_COLOURS[verdict.use],
            lights=[
                {
                    "name": light.label[0].upper() + light.label[1:],
                    "mark": light.mark,
                    "message": light.message,
                }
                for light in lot_summary.indicators
            ],
            counts=_count_outcomes(lot, main),
            simulated=[format_count(lot.simulated_count, "file")] if lot.simulated_count else [],
            quantity=main.quantity,
            heading=main.quantity.title[:1].upper() + main.quantity.title[1:],
            anchor=lambda name: f"a{hashlib.sha256(name.encode()).hexdigest()[:12]}",
            what=_format_chart_points(main, by_lots=by_lots),
            chart=_make_chart(main, by_lots=by_lots),
            by_lots=by_lots,
            histogram=_make_histogram(main),
            points=json.dumps(_list_points(main, by_lots=by_lots)),
            few=[name for name, chart in main.charts.items() if len(chart.seals) < MIN_POINTS],
            enough=MIN_POINTS,
            curves=_make_curves(lot, lot_summary),
            curves_most=CURVES,
            capability=_make_capability_row(main),
            capable=[(name, *capability.cells) for name, capability in main.capabilities.items()],
            cpks=_format_cpks(main),
            lots=_make_lot_rows(main),
            scatter=_make_scatter_rows(main),
            gauge=_make_gauge_rows(main),
            weighs=findings[:MAX_FLAGS],
            remarks=len(findings),
            checked=[
                {"mark": _mark(check), "message": check.message_with_remedy}
                for check in lot_summary.checks
                if check.passed is not None
            ],
            signals=signals,
            other_quantities=quantities,
            seals=seals,
            decisions=_count_decisions(seals),
            has_decisions=bool(main.seal_decisions),
            labels=labels,
            tests=tests,
            every=_encode_test_rows(tests, labels, lot_summary),
            files=lot.table.height,
            most=ROWS,
            marks=_MARKS,
        )
    )  # fmt: skip


def _format_chart_points(main: QuantitySummary, *, by_lots: bool) -> str:
    if by_lots:
        return "every lot"
    return "mean of the tests of each seal" if _has_repeats(main) else "one test each"


def _mark(check: Check) -> str:
    if not check.failed:
        return "good"
    return {"stop": "bad", "limit": "care", "note": "note"}[check.grade]


@cache
def _read_page_part(name: str) -> str:
    return (
        resources.files("dashpot.extensions.batch")
        .joinpath("templates", name)
        .read_text("utf-8")
        .strip()
    )


# -- figures --------------------------------------------------------------------------------------


def _render_picture(picture: Picture, width: float = CHART_WIDTH) -> RenderedFigure:
    """Return the picture for a screen, a phone and, if it is wider than a sheet, paper."""
    total_height = sum(panel.height for panel in picture.panels)
    return render_figure(picture, width=width, low=total_height if width > PAPER_WIDTH else None)


def _make_chart(main: QuantitySummary, *, by_lots: bool) -> RenderedFigure | None:
    if not main.seals:
        return None
    if by_lots:
        return _render_picture(
            lots_picture(main.quantity, main.charts, main.lots, main.seals, _get_limit_ends(main))
        )
    return _render_picture(
        control_picture(main.quantity, main.charts, main.seals, _get_limit_ends(main))
    )


def _get_limit_ends(main: QuantitySummary) -> tuple[float, ...]:
    return () if main.limits is None else main.limits.ends


def _make_histogram(main: QuantitySummary) -> RenderedFigure | None:
    if not main.seals:
        return None
    picture = histogram_picture(main.quantity, main.charts, main.seals, _get_limit_ends(main))
    return _render_picture(picture, SIDE_WIDTH)


def _format_cpks(main: QuantitySummary) -> RenderedFigure | None:
    """Return the sentence on lots that the table omits."""
    if len(main.capabilities) <= FEW_LOTS:
        return None
    cpk = None if main.limits is None else main.limits.cpk
    return _render_picture(cpk_picture(list(main.capabilities.values()), cpk), SIDE_WIDTH)


def _list_points(main: QuantitySummary, *, by_lots: bool) -> list[tuple[str, str]]:
    """Return the lot and seal of each point of the chart."""
    if by_lots:
        return [(lot, "") for lot in split_seals_by_lot(main.seals)]
    return [(seal.lot, f"seal {seal.name}") for seal in main.seals]


def _make_curves(lot: Lot, summary: Summary) -> RenderedFigure | None:
    rows = lot.rows_in_statistics.drop_nulls("k_end_N_per_m")
    files = [flag.file for flag in summary.flags if flag.file and flag.weighty]
    for chart in summary.main.charts.values():
        for index in {index for index, rule in chart.means.signals if rule == OUTSIDE_LIMITS}:
            files += chart.seals[index].files
    if rows.is_empty():
        return None
    row_indices = np.unique(np.linspace(0, rows.height - 1, min(rows.height, CURVES)).astype(int))
    outlier_rows = rows.filter(rows["file"].is_in(files)).head(CURVES)
    return _render_picture(
        curves_picture([*rows[row_indices].to_dicts(), *outlier_rows.to_dicts()], files)
    )


def _make_capability_row(main: QuantitySummary) -> dict[str, Any] | None:
    if main.lowest is None or main.limits is None:
        return None
    worst, capability = main.lowest
    cpk, low, high = capability.cells
    nearer_tail, farther_tail = capability.outside_interval
    return {
        "lot": worst,
        "several": len(main.capabilities) > 1,
        "cpk": cpk,
        "from": low,
        "to": high,
        "cp": "" if capability.cp is None else f"{capability.cp:.2f}",
        "count": capability.count,
        "outside": capability.outside,
        "share": f"{100 * nearer_tail:.2g} to {100 * farther_tail:.2g} %",
        "suspect": capability.suspect,
        "normal": None
        if capability.normal is None
        else round_to_error(capability.normal, digits=2),
    }


# -- Texts and tables -----------------------------------------------------------------------------


def _has_repeats(main: QuantitySummary) -> bool:
    return any(len(seal.values) > 1 for seal in main.seals)


def _count_outcomes(lot: Lot, main: QuantitySummary) -> str:
    lots = {seal.lot for seal in main.seals}
    sentences = [
        format_count(lot.table.height, "file"),
        f"{format_count(lot.rows_in_statistics.height, 'fit')} used",
        format_count(len(main.seals), "seal") if _has_repeats(main) else "",
        format_count(len(lots), "lot") if len(lots) > 1 else "",
    ]
    depth, hold = (lot.rows_in_statistics[name].median() for name in ("depth_m", "hold_s"))
    for value, unit in ((depth, "mm"), (hold, "s")):
        if isinstance(value, float):
            sentences.append(format_quantity(value, unit))
    return ", ".join(filter(None, sentences))


def _make_scatter_rows(main: QuantitySummary) -> list[dict[str, Any]]:
    """Source, share in per cent, standard deviation and its ends, and where its bar stands."""
    rows, bar_start = [], 0.0
    for item, (reported_value, share) in zip(main.components, main.sources, strict=True):
        sd, low, high = reported_value.cell_texts
        rows.append({
            "source": item.source, "share": share, "sd": sd,
            "low": low * reported_value.has_interval, "high": high * reported_value.has_interval,
            "at": f"{bar_start:.3f}", "width": f"{100 * item.share:.3f}", "wide": item.share > 0.2,
        })  # fmt: skip
        bar_start += 100 * item.share
    return rows


def _make_gauge_rows(main: QuantitySummary) -> dict[str, Any] | None:
    study = main.gauge
    if study is None:
        return None
    rows = []
    for variation in study.variations:
        shares = (f"{100 * end:.0f}" for end in variation.share_interval)
        reported_value = main.quantity.fact(
            _SOURCES[variation.name], variation.deviation, variation.interval
        )
        rows.append(
            (
                reported_value.name,
                *reported_value.cell_texts,
                f"{100 * variation.share:.1f}",
                *shares,
            )
        )
    share = study["gauge"].share
    distance = None if main.limits is None else main.limits.distance
    return {
        "rows": rows, "message": study.summary, "ratio": f"{100 * share:.0f}",
        "mark": "good" if share <= GOOD_SHARE else "care" if share <= LIMIT else "bad",
        "operators": study.operators, "parts": study.parts, "tests": study.tests,
        "omitted_tests": study.omitted_tests, "pooled": study.is_pooled,
        "tolerance": distance and f"{100 * 6 * study['gauge'].deviation / distance:.1f}",
    }  # fmt: skip


def _make_signal_rows(main: QuantitySummary) -> Iterator[tuple[str, str, str]]:
    """Lot, seal and rule of outliers, and the outlying lots."""
    for name, charts in main.charts.items():
        for index, rule in charts.means.signals:
            yield name, charts.seals[index].name, rule
    if main.lots is not None:
        names, means, deviations = main.lots
        for chart, statistic in ((means, "its mean"), (deviations, "its scatter")):
            for index, rule in chart.signals:
                yield names[index], "", f"{statistic} is {rule} of all lots"


def _make_lot_rows(main: QuantitySummary) -> list[tuple[str, ...]]:
    """Lot, seals, mean, standard deviation, control limits, Cpk and its ends, causes of alarms."""
    rows: list[tuple[str, ...]] = []
    for name, seals in split_seals_by_lot(main.seals).items():
        values = average_seals(seals)
        format_value, charts = main.quantity.format_value, main.charts.get(name)
        capability = main.capability.get(name)
        deviation = float(np.std(values, ddof=1)) if len(values) > 1 else None
        limit_texts = ("", "")
        if charts is not None:
            limit_texts = (
                format_value(float(charts.means.lower[0])),
                format_value(float(charts.means.upper[0])),
            )
        cpk_cells = ("", "", "") if capability is None else capability.cells
        alarms = "" if charts is None else f"{len(charts.means.causes)}"
        rows.append((name or "unnamed", f"{len(values)}", format_value(float(np.mean(values))),
                     format_value(deviation, digits=2), *limit_texts, *cpk_cells,
            alarms))  # fmt: skip
    # what is least capable leads, else what signals most
    return sorted(rows, key=lambda row: (float(row[6] or "inf"), -int(row[9] or 0)))


def _select_other_quantities(
    lot: Lot, main: QuantitySummary
) -> list[tuple[Quantity, Mapping[tuple[str, str], str]]]:
    """The other quantities of the table of seals, each with the means that any of them has."""
    sentences, seal_keys = (
        (main.quantity.name, "k_inf", "E_inf"),
        {(seal.lot, seal.name) for seal in main.seals},
    )
    pairs = [
        (
            quantity,
            {
                (seal.lot, seal.name): quantity.format_value(seal.mean)
                for seal in lot.seals(quantity.name)
            },
        )
        for quantity in lot.quantities
        if quantity.name not in sentences and not quantity.name.startswith("loss_at_")
    ]
    return [(quantity, means) for quantity, means in pairs if not seal_keys.isdisjoint(means)]


def _make_seal_rows(
    summary: Summary, other_columns: Sequence[tuple[Quantity, Mapping[tuple[str, str], str]]]
) -> list[dict[str, Any]]:
    """Return a row per seal, the gravest first: failed, flagged, others."""
    decisions = {
        (decision.lot, decision.seal): decision for decision in summary.main.seal_decisions
    }
    seals = {(seal.lot, seal.name): seal for seal in summary.main.seals}
    reasons, rows = _build_seal_reasons(summary), []
    # those of which no test is used are judged alone
    for key in dict.fromkeys((*seals, *decisions)):
        text = "; ".join(reasons[key])
        word: str = decisions[key].decision if key in decisions else "ok"
        if text and word in ("ok", "pass"):
            word = "look"
        rows.append({
            "lot": key[0], "name": key[1], "word": word, "why": text,
            "rank": _GRAVITY.get(word, len(_GRAVITY)),
            "more": [means.get(key, "") for _, means in other_columns],
            **_format_seal_cells(seals.get(key), summary.main.quantity),
        })  # fmt: skip
    return sorted(rows, key=lambda row: row["rank"])


def _format_seal_cells(seal: Seal | None, quantity: Quantity) -> dict[str, Any]:
    """Return the values of the tests of a seal, if one is used."""
    if seal is None:
        return {"tests": 0, "value": "", "sd": ""}
    sd = quantity.format_value(seal.repeats_sd, digits=2)
    return {"tests": len(seal.files), "value": quantity.format_value(seal.mean), "sd": sd}


def _count_decisions(seals: Sequence[Mapping[str, Any]]) -> str:
    counts = Counter(str(seal["word"]) for seal in seals)
    return ", ".join(f"{count} {word}" for word, count in counts.most_common())


def _list_causes(main: QuantitySummary) -> Iterator[dict[str, Any]]:
    """The runs of lots that set off an alarm."""
    lots = main.lots
    if lots is None:
        return
    centre, values = lots.mean.centre, np.asarray(lots.mean.values)
    centre_text = main.quantity.format_value(centre)
    for low, high in lots.mean.causes:
        run = np.arange(low, high + 1)
        for side_name, side_values in (
            ("low", run[values[run] < centre]),
            ("high", run[values[run] > centre]),
        ):
            if not len(side_values):
                continue
            names = [lots.names[index] for index in side_values]
            single = len(names) == 1
            yield {
                "mark": "care", "name": f"Lot{'' if single else 's'} "
                                        f"{_join_lot_names(names, len(run))}",
                "filter": names[0],
                "message": f"{'lies' if single else 'lie'} {side_name}: "
                f"{_format_range(main, values[side_values])}, all lots {centre_text}.",
            }  # fmt: skip


def _join_lot_names(names: Sequence[str], run: int) -> str:
    """Name lots of one run on one side of the centre: all of them by the first and the last."""
    if len(names) > 2 and len(names) == run:
        return f"{names[0]} to {names[-1]}"
    *other_names, last = names
    return f"{', '.join(other_names)} and {last}" if other_names else last


def _format_range(main: QuantitySummary, values: FloatArray) -> str:
    """Return the value of a lot, or the least and the largest of several."""
    low, high = (
        main.quantity.format_value(float(values.min())),
        main.quantity.read(float(values.max())),
    )
    return high if len(values) == 1 else f"{low} to {high}"


def _list_findings(summary: Summary) -> Iterator[dict[str, Any]]:
    """Findings by severity: the failed checks, causes of alarms, then single seals and files.

    Each may have a search text that finds its tests.
    """
    failed_checks = [check for check in summary.checks if check.failed]
    for check in sorted(failed_checks, key=lambda check: -GRADES.index(check.grade)):
        yield {
            "mark": _mark(check),
            "name": "",
            "filter": None,
            "message": check.message_with_remedy,
        }
    yield from _list_causes(summary.main)
    for flag in summary.flags:
        location = ", ".join(filter(None, (flag.lot, flag.seal and f"seal {flag.seal}")))
        yield {
            "mark": "care" if flag.weighty else "note",
            "name": location or flag.file,
            "filter": flag.file or f"seal {flag.seal}",
            "message": flag.message,
        }


def _encode_test_rows(
    tests: Sequence[Mapping[str, Any]], labels: Sequence[str], summary: Summary
) -> str:
    """Return all rows for the script: no markup can end their element."""
    decided = {
        (decision.lot, decision.seal): decision.decision for decision in summary.main.seal_decisions
    }
    heads = ["file", *labels, "value", "verdict", "why", "mark"]
    rows = [
        [
            test["file"],
            *test["labels"],
            test["value"],
            test["verdict"],
            test["reason"],
            test["mark"],
        ]
        for test in tests
    ]
    if decided and {"lot", "seal"} <= set(labels):
        label_columns = [labels.index(name) for name in ("lot", "seal")]
        for row, entry in zip(rows, tests, strict=True):
            key = tuple(entry["labels"][i] for i in label_columns)
            row[-1:-1] = [decided.get(key, "")]
        heads[-1:-1] = ["decision"]
    return json.dumps({"heads": heads, "rows": rows}, separators=(",", ":")).replace("<", "\\u003c")


def _build_seal_reasons(summary: Summary) -> dict[tuple[str, str], list[str]]:
    """Return why each seal is flagged: its decision, then its flags."""
    reasons: dict[tuple[str, str], list[str]] = defaultdict(list)
    for decision in summary.main.seal_decisions:
        reasons[decision.lot, decision.seal] += filter(
            None, [decision.explain_decision(summary.main.quantity)]
        )
    for flag in summary.flags:
        if not flag.file or flag.weighty:
            reasons[flag.lot, flag.seal or flag.file].append(flag.message)
    return reasons


def _make_test_rows(summary: Summary, labels: Sequence[str]) -> list[dict[str, Any]]:
    """Return a row per file: not fitted first, then outliers, then the others."""
    quantity = summary.main.quantity
    gravity = {"do not use": 1, "use with care": 2}
    marks: dict[Any, str] = {**VERDICT_COLOURS, None: "", "ignored": ""}
    flagged_files = {flag.file for flag in summary.flags}
    names = ("file", "outcome", "verdict", "reason", quantity.column, *labels)
    rows = sorted(
        summary.lot.table.select(*names).iter_rows(),
        key=lambda row: (
            row[1] in {"fitted", "ignored"}, gravity.get(row[2], 3), row[0] not in flagged_files,
            row[0],
        ),
    )  # fmt: skip
    return [
        {
            "file": file,
            "labels": labels_of_row,
            "value": quantity.format_value(value),
            "verdict": (verdict or "point estimate") if outcome == "fitted" else outcome,
            "mark": marks.get(verdict if outcome == "fitted" else outcome, "bad"),
            "reason": reason or "",
        }
        for file, outcome, verdict, reason, value, *labels_of_row in rows
    ]
