"""A noun's own picture, and how a notebook shows it."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import replace
from functools import singledispatch
from html import escape
from typing import Any

from dashpot import plot
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF
from dashpot.plot import Picture
from dashpot.reading.readers.inspect import Inspection
from dashpot.registry import figure_of
from dashpot.vibration.comparison.comparison import Comparison
from dashpot.workflow.response.frf_prediction import Prediction
from dashpot.workflow.study import Study
from dashpot.workflow.vibration.impact_tests import Agreement, Identified
from dashpot.workflow.vibration.modes import Modes


@singledispatch
def picture(result: object) -> Picture:
    """Return the picture of a noun; that of a kind of test, or a door, is named in the register."""
    draw = figure_of(result)
    if draw is None:
        raise TypeError(f"a {type(result).__name__} has no picture")
    drawn: Picture = draw(result)
    return drawn


picture.register(Fit, plot.stiffness)
picture.register(Comparison, plot.comparison)
picture.register(Study, plot.hero)


@picture.register
def _(noun: Identified) -> Picture:
    return plot.stiffness(noun.fit)


@picture.register
def _(noun: Modes) -> Picture:
    return plot.frf(noun.frf, labels=("measured",), stamp=plot.stamp(noun.frf.source))


@picture.register
def _(noun: Agreement) -> Picture:
    return plot.comparison(noun.comparison, band=noun.limits, interval=noun.interval)


@picture.register
def _(noun: Inspection) -> Picture:
    names = [f"{column.name or column.number} [{column.unit or '?'}]" for column in noun.columns]
    roles = [column.role for column in noun.columns]
    stamp = f"{noun.file}{', SIMULATED' * noun.simulated}"
    return plot.columns(names, roles, noun.course, stamp=stamp)


def draw_prediction(
    prediction: Prediction, *levels: FRF, labels: Sequence[str] = ("predicted",), **how: Any
) -> Picture:
    """Return the picture of a prediction, and of FRFs at levels."""
    fit, rig = prediction.fit, {"mass": prediction.mass, "seals": prediction.seals}
    return plot.frf(
        prediction.frf,
        *levels,
        labels=labels,
        band=prediction.limits,
        interval=prediction.interval,
        informed=fit.band,
        stamp=plot.stamp(fit.source, fit.specimen, **rig),
        **how,
    )


def html(result: object) -> str:
    """Return a noun's words above its picture, as a piece of an HTML page."""
    words = repr(result)
    # pictures on one page must not share their ids
    name = "n" + hashlib.sha256(words.encode()).hexdigest()[:12]
    drawing = plot.to_svg(replace(picture(result), name=name))
    return f"<div><pre>{escape(words)}</pre>{drawing}</div>"
