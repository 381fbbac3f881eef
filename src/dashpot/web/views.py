"""Nouns for the eye: panels as drawn for the page, pieces of it, and bare curves while it moves.

Pure functions, tested without a server. Words, digits and marks are those of the report.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from dashpot import plot
from dashpot.base import units
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, Verdict
from dashpot.base.facts import Fact
from dashpot.base.numbers import cell, rounded, symbol
from dashpot.base.units import Dimension, in_unit, read_in
from dashpot.io.columns.kinds import RECOGNISED
from dashpot.kinds import KINDS
from dashpot.plot import relaxation
from dashpot.plot.layout import ROW
from dashpot.plot.picture import (
    PREDICTED,
    REF,
    Line,
    Mark,
    Panel,
    Pen,
    Picture,
    Rule,
    Tag,
    joint_pen,
)
from dashpot.plot.svg import strip, swatch
from dashpot.plot.thinning import extremes
from dashpot.plot.vibration import SHOWN, Curve, magnitude_panel
from dashpot.records.fit import Fit
from dashpot.records.frf import FRF, Kind
from dashpot.records.relaxation import RampHold
from dashpot.report import answer
from dashpot.report.answer import GRADES, Row
from dashpot.report.figures import chart_of
from dashpot.report.pages import COLOURS, environment
from dashpot.vibration.impact.hits import cut_hits
from dashpot.web.words import on_page
from dashpot.workflow.inspections import InspectedFile
from dashpot.workflow.predictions import Prediction
from dashpot.workflow.recommendation import recommendation
from dashpot.workflow.study import Study

ROLES = ("time", "displacement", "force", "hammer", "acceleration")
"""What a column of a relaxation test or of a hammer test can be."""
_ALONE = ("response", "base", "bench", "level")
"""Places of the page where a file is no part of a job, or not of one only."""
ASKED: tuple[Dimension, ...] = ("time", "length", "force", "acceleration")
"""What its unit can be one of."""
EQ5 = Pen("ref", 1.6, (2, 3))
SHORT = {
    "residual: range of samples": "range of samples", "residual: mean": "mean",
    "noise, one SD": "noise", "ramp": "", "eq. (5), hold only": "eq. (5)",
    "k∞, relaxation fit": "k∞", "k∞, fit": "k∞", "relaxation fit": "arms",
    "band that every accepted hit excites": "excited by all",
    "mode found": "mode", "new at its order": "new", "stable in frequency": "frequency stays",
    "stable in frequency and damping": "damping too",
}  # fmt: skip
"""What the key calls a mark where the title has said the rest."""
Sizes = Mapping[str, tuple[float, float]]
"""Width and height of the drawing of each panel, px."""
UNKNOWN = (400.0, 180.0)
"""Of one that is not shown yet, px."""
AROUND = 2 * ROW + 6 + ROW + 4
"""Of a drawing above and below its axes, px."""
PULSE, PART = (88, 26), 0.1
"""Size of the drawing of a pulse, px; at which part of its peak it begins and ends."""
SINGLE = 8
"""Arms of a table that is read; more are a spectrum for a solver."""
TWO, CARD = 700.0, 18.0
"""Room for two cards beside each other, and what the border of a card takes, px."""
LEAST = 44.0
"""Of a plot, px: below it no curve can be read."""
LIVE_POINTS = 240
"""Of a curve that follows a handle: more than a panel has px across a bend."""


def piece(name: str, **values: Any) -> str:
    """A piece of the page, from its template; whatever came from a file is escaped."""
    return str(environment("dashpot.web").get_template(f"{name}.html").render(values))


# -- panels ---------------------------------------------------------------------------------------


def drawn(name: str, panel: Panel, sizes: Sizes) -> str:
    """A panel as the page has it: the key, then the drawing at the size of its place."""
    width, height = sizes.get(name, UNKNOWN)
    panel = replace(panel, height=max(height - AROUND, LEAST))
    key = Picture(name, "", ((panel,),)).key
    samples = [(swatch(mark, name=f"{name}-k{i}"), mark.label) for i, mark in enumerate(key)]
    svg = strip((panel,), name=name, width=max(width, 240.0), kind="figure")
    return piece("figure", key=samples, svg=svg)


def test_panels(fit: Fit, prepared: RampHold, by_eq5: Fit | None, sizes: Sizes) -> dict[str, str]:
    """Ramp, hold, residual and spectrum of a fit."""
    chosen = relaxation.fitted(fit, (), prepared)[0]
    hold = relaxation.force_panel([chosen], prepared)
    if by_eq5 is not None and fit.method != "hold":
        t, force = relaxation.fitted_force(by_eq5, prepared)
        curve = extremes(t, _scale(hold) * force, bins=200, log=True)
        marks = (*hold.marks[:-1], Line(*curve, EQ5, "eq. (5), hold only"), hold.marks[-1])
        hold = replace(hold, marks=marks)
    panels = {
        "ramp": relaxation.ramp_panel([chosen], prepared),
        "hold": hold,
        "residual": relaxation.residual_panel(chosen, prepared),
        "spectrum": _named(plot.spectrum(fit).panels[0], fit),
    }
    return {name: drawn(name, _in_short(one), sizes) for name, one in panels.items()}


def _named(panel: Panel, fit: Fit) -> Panel:
    """The spectrum with the name of each arm at its tip."""
    if fit.family != "maxwell":
        return panel
    k = in_unit(np.array(fit.model.k), read_in(fit.unit)).tolist()
    arms = enumerate(zip(fit.model.tau, k, strict=True), 1)
    tags = [Tag(tau, tip, symbol(f"tau_{j}"), "fit", "filled") for j, (tau, tip) in arms]
    marks = (
        replace(one, label="arms") if isinstance(one, Line) and one.label == "fit" else one
        for one in panel.marks
    )
    return replace(panel, marks=(*marks, *tags))


def _in_short(panel: Panel) -> Panel:
    """The panel with a key of one line: beside its title each mark needs a word."""
    marks: list[Mark] = []
    for mark in panel.marks:
        if not isinstance(mark, Tag) and mark.label:
            plain = "fit" if mark.label.startswith("fit, ") else mark.label
            mark = replace(mark, label=SHORT.get(plain, plain))  # noqa: PLW2901
        marks.append(mark)
    return replace(panel, marks=tuple(marks))


def _scale(panel: Panel) -> float:
    """From N to the unit of a panel of forces."""
    return in_unit(1.0, panel.y.label.split(", ")[-1])


def response_panel(predicted: FRF, sizes: Sizes) -> str:
    """The predicted response before anything bounds it."""
    if predicted.quantity is Kind.TRANSMISSIBILITY:
        curve = Curve(predicted, "predicted from relaxation", PREDICTED)
        return drawn("frf", magnitude_panel([curve]), sizes)
    return drawn("frf", plot.resonance(None, predicted).panels[0], sizes)


def bench_panels(picture: Picture, width: float) -> list[tuple[str, str]]:
    """What stands over each strip of a picture, and the strip; two in a row if they fit."""
    narrow = width < TWO or len(picture.strips) == 1
    found = []
    for i, panels in enumerate(picture.strips):
        name, title = f"bench{i}", panels[0].title or panels[0].y.label.partition(",")[0]
        panels = (replace(panels[0], title=""), *panels[1:])  # noqa: PLW2901
        key = Picture(name, "", (panels,)).key
        samples = [(swatch(mark, name=f"{name}-k{j}"), mark.label) for j, mark in enumerate(key)]
        svg = strip(
            panels, name=name, width=(width if narrow else (width - 8) / 2) - CARD, kind="figure"
        )
        found.append((title, piece("figure", key=samples, svg=svg)))
    return found


def study_panel(study: Study, sizes: Sizes) -> str:
    """The response of the mass, with all that is known of it; nothing without a mass."""
    if study.prediction is None:
        return ""
    predicted, failed = study.prediction, study.joint is not None
    failed = failed and study.joint.verdict.use == "do not use"  # type: ignore[union-attr]
    picture = plot.resonance(
        study.comparison, predicted, joint=study.joint_comparison, failed=failed,
        band=study.frf_band, rival=study.rival,
    )  # fmt: skip
    return drawn("frf", picture.panels[0], sizes)


def base_panel(found: Prediction, joint: bool, sizes: Sizes) -> str:
    """The transmissibility to the mass, its peak, and from where on the mass is isolated."""
    pen, name = joint_pen(failed=False) if joint else (PREDICTED, "predicted from relaxation")
    panel = magnitude_panel([Curve(found.frf, name, pen, found.peak)], tagged=True)
    if found.isolation is not None:
        said = f"less than its base above {rounded(found.isolation, digits=4)} Hz"
        panel = replace(panel, marks=(*panel.marks, Rule(found.isolation, REF, label=said)))
    return drawn("frf", panel, sizes)


def hit_panels(study: Study, sizes: Sizes) -> dict[str, str]:
    """The pulses of the hits, their spectra, the answers to them, and the chart of their poles."""
    if study.impact is None or study.measured is None:
        return {}
    strips = plot.hits(study.impact, study.measured).strips
    found = {"pulses": strips[0][0], "force": strips[1][0], "answers": strips[-1][0]}
    chart = chart_of(study)
    if chart is not None:
        found["poles"] = chart.panels[-1]
    return {
        name: drawn(name, replace(_in_short(one), title=""), sizes) for name, one in found.items()
    }


def hammer_line(study: Study) -> str:
    """What the list of files says of a hammer test once it was averaged."""
    if study.measured is None or not study.measured.hits:
        return ""
    accepted = sum(hit.accepted for hit in study.measured.hits)
    peak = "" if study.comparison is None else f", {rounded(study.comparison.measured_hz)} Hz"
    return f"{accepted} of {len(study.measured.hits)} hits{peak}"


# -- curves while a handle is held ----------------------------------------------------------------


class LiveCurves(NamedTuple):
    """Curves by panel and name, in the units of their axes, and words beside them."""

    arrays: dict[str, FloatArray]
    words: str


def live_test(fit: Fit, prepared: RampHold, by_eq5: Fit | None) -> LiveCurves:
    """What a fit says while a handle is held: its curves, its residual, its numbers."""
    chosen = relaxation.fitted(fit, (), prepared)[0]
    ramp, hold = (
        relaxation.ramp_panel([chosen], prepared),
        relaxation.force_panel([chosen], prepared),
    )
    curves = {"ramp/fit": ramp.marks[-1], "hold/fit": hold.marks[-1]}
    rest = relaxation.residual_panel(chosen, prepared)
    curves["residual/mean"] = rest.marks[-1]
    arrays: dict[str, FloatArray] = {}
    for name, mark in curves.items():
        if isinstance(mark, Line):
            keep = np.unique(np.linspace(0, len(mark.x) - 1, LIVE_POINTS).astype(int))
            arrays[f"{name}/x"], arrays[f"{name}/y"] = mark.x[keep], mark.y[keep]
    return LiveCurves(arrays, piece("beside", rows=beside(fit, by_eq5)))


def beside(fit: Fit, by_eq5: Fit | None) -> list[tuple[str, str, str, str]]:
    """Name, value of the fit, value of eq. (5) and unit, of every parameter."""
    there = {}
    if by_eq5 is not None and fit.family != "fractional":
        there = {one.name: one.cells.value for one in by_eq5.known}
    return [
        (one.symbol, one.cells.value, there.get(one.name, ""), one.word)
        for one in fit.known
        if one.name[0] != "b" and one.name != "k_end"
    ]


def live_response(predicted: FRF) -> LiveCurves:
    """The predicted response while the mass moves."""
    size = np.abs(predicted.value)
    top = int(size.argmax())
    words = (
        f"{rounded(float(predicted.frequency[top]), digits=4)} Hz, {rounded(float(size[top]))} "
        f"{SHOWN[predicted.quantity][0]}"
    )
    return LiveCurves({"frf/predicted/x": predicted.frequency, "frf/predicted/y": size}, words)


# -- pieces of the page ---------------------------------------------------------------------------


def verdict(found: Verdict) -> str:
    """The verdict in colour and words."""
    return piece("verdict", verdict=found, colour=COLOURS[found.use])


class Term(NamedTuple):
    """A parameter with its 95 % interval and a mark."""

    name: str
    value: str
    low: str
    high: str
    unit: str
    mark: str
    pads: tuple[str, ...] = ()
    """What stands unseen behind value, low and high, so that points stand below each other."""


def terms(fit: Fit) -> list[Term]:
    """Every parameter of the solid, the stiffness at the end of the hold first."""
    # b = k tau says of an arm what k and tau say
    return [term(one) for one in fit.known if not one.name.startswith("b_")]


def term(fact: Fact) -> Term:
    """A number with the ends of its interval, and whether it is determined."""
    half = (fact.high - fact.low) / 2
    # known to half of itself is seen; beyond, it is not determined
    mark = "good" if 0 < half < 0.5 * abs(fact.value) else "care"
    return Term(fact.symbol, *fact.ends, fact.word, mark)


def solid_table(fit: Fit) -> str:
    """The solid of one seal, each term with its interval and a mark."""
    found, more = terms(fit), ""
    if fit.family == "maxwell" and fit.model.arms > SINGLE:
        found = [one for one in found if one.name == symbol("k_inf")]
        more = (
            f"and a spectrum of {fit.model.arms} arms from {fit.model.tau[0]:.3g} to "
            f"{fit.model.tau[-1]:.3g} s, a table for a solver: fit.json holds it."
        )
    return term_table("Model of one seal", found, more, of=fit.identity)


def term_table(title: str, found: Sequence[Term], more: str = "", *, of: str = "") -> str:
    """Terms by unit, each with its interval and a mark, and what else is to be said of them.

    `of` is the identity of the fit, which a deck is then asked for.
    """
    groups = []
    for unit in dict.fromkeys(one.unit for one in found):
        rows = [one for one in found if one.unit == unit]
        columns = [_pads(texts) for texts in zip(*(row[1:4] for row in rows), strict=True)]
        groups.append(
            (unit, [one._replace(pads=pads) for one, *pads in zip(rows, *columns, strict=True)])
        )
    return piece("solid", title=title, groups=groups, more=more, of=of)


def _pads(texts: Sequence[str]) -> list[str]:
    """What each number lacks behind its point to be as long as the longest."""
    behind = [len(text.partition(".")[2]) for text in texts]
    return [
        "." * (not short and max(behind) > 0) + "0" * (max(behind) - short)
        if text[-1:].isdigit()
        else ""
        for text, short in zip(texts, behind, strict=True)
    ]


def check_list(checks: Sequence[Check]) -> str:
    """What failed, the gravest first, and how many were judged."""
    distinct = list(dict.fromkeys(checks))
    failed = [(GRADES[one.grade], one.told) for one in distinct if one.failed]
    failed.sort(key=lambda pair: -answer.ORDER.index(pair[0]))
    passed = sum(one.passed is True for one in distinct)
    return piece("checks", failed=failed, passed=passed, judged=passed + len(failed))


def answers(study: Study) -> str:
    """The numbers that one came for, as the report's first screen has them."""
    found = recommendation(study)
    title, rows = answer.under_mass(study, found)
    every: list[tuple[str, tuple[Row, ...]]] = [(title, rows)] if rows else []
    every.append(("One seal", answer.rows(found.one_seal)))
    return piece(
        "answers",
        heading=answer.heading(found),
        groups=every,
        measured=study.comparison is not None,
    )


def hit_table(study: Study) -> str:
    """Every hit with its pulse and its verdict; nothing where no hits were averaged."""
    if study.measured is None or not study.measured.hits:
        return ""
    return piece("hits", hits=study.measured.hits, pulses=_pulses(study), size=PULSE)


def _pulses(study: Study) -> dict[str, str]:
    """The path of each hit's pulse by its name, all to one scale."""
    if study.impact is None:
        return {}
    (width, height), blocks = PULSE, cut_hits([study.impact])
    longest = max(max(one.width(PART), 8 / one.rate) for one in blocks)
    top = max(float(one.force.max()) for one in blocks)
    found = {}
    for one in blocks:
        time = (np.arange(len(one.force)) - one.onset) / one.rate
        near = (time > -0.5 * longest) & (time < 2.5 * longest)
        t, force = extremes(time[near], one.force[near], bins=width)
        x, y = width * (t / longest + 0.5) / 3, height * (1 - np.clip(force / top, -0.05, 1)) + 1
        found[one.name] = "M" + "L".join(f"{a:.1f} {b:.1f}" for a, b in zip(x, y, strict=True))
    return found


def place_of(found: InspectedFile) -> str:
    """Where the page takes a file; empty where it does not."""
    return KINDS[found.kind].page if found.kind in KINDS else ""


def file_row(found: InspectedFile) -> dict[str, Any]:
    """What the list of files says of one: its kind, one line, a mark."""
    strange = _refusal(found) or _stranger(found)
    mark = "care" if found.questions else "bad" if strange else "good"
    return {
        "kind": found.kind, "page": place_of(found), "line": _told(found), "mark": mark,
        "simulated": found.simulated,
    }  # fmt: skip


def _told(found: InspectedFile) -> str:
    ready = found.preparation
    if ready is not None:
        ramp, hold = rounded(ready.ramp_time), rounded(ready.hold_time)
        return f"{cell(ready.depth, 'mm')} mm, {ramp} s, {hold} s"
    if found.questions:
        return "asks: " + ("a unit" if "--units" in found.questions[0].option else "a column")
    if place_of(found) in _ALONE:
        return _refusal(found) or RECOGNISED[found.kind].what
    return found.refusal or found.reason


def _refusal(found: InspectedFile) -> str:
    """Why a file is not fitted; that loops are no ramp and hold is no reason."""
    return "" if place_of(found) == "level" else found.refusal


def _heading(found: InspectedFile) -> str:
    if found.questions:
        return f"What does {found.file} hold?"
    if _stranger(found):
        return f"{found.file} is {RECOGNISED[found.kind].what}"
    return f"{found.file} was not read"


def _stranger(found: InspectedFile) -> str:
    """What to do with a file of a kind that this page has no place for, if it is one."""
    known = place_of(found) or found.kind not in RECOGNISED
    if found.questions or found.refusal or known:
        return ""
    advice = RECOGNISED[found.kind].use
    return (
        "this page takes relaxation tests, hammer files, FRFs, sweeps, loops, moduli and creep "
        f"tests; for this one: {advice}"
    )


class Consequence(NamedTuple):
    """What the seal would be, were a column in this unit: its largest force and its stiffness."""

    unit: str
    force: str
    stiffness: str


def asked(found: InspectedFile, consequences: Sequence[Consequence]) -> str:
    """The first rows with roles and units to choose, and what is to be answered."""
    words: dict[str, list[str]] = {}
    for unit in units.TABLE.values():
        if unit.dimension in ASKED:
            words.setdefault(unit.dimension, []).append(unit.word)
    return piece(
        "asked", file=found, heading=_heading(found), stranger=_stranger(found), roles=ROLES,
        units=words, consequences=consequences, on_page=on_page,
        rows=list(zip(*(column.first for column in found.columns), strict=False)),
    )  # fmt: skip
