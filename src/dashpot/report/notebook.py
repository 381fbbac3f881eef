"""A noun's own picture, and how a notebook shows it."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from functools import singledispatch
from html import escape

from dashpot import plot
from dashpot.io.readers.inspect import Inspection
from dashpot.kinds.cld.record import CLD
from dashpot.plot import Picture
from dashpot.records.fit import Fit
from dashpot.records.frf import FRF
from dashpot.records.relaxation import RampHold
from dashpot.records.superposition import Superposition
from dashpot.vibration.comparison.comparison import Comparison
from dashpot.workflow.study import Study


@singledispatch
def picture(noun: object) -> Picture:
    """Return the picture of a noun."""
    raise TypeError(f"a {type(noun).__name__} has no picture")


picture.register(Fit, plot.stiffness)
picture.register(FRF, plot.frf)
picture.register(Comparison, plot.comparison)
picture.register(Study, plot.hero)
picture.register(RampHold, plot.segments)
picture.register(CLD, plot.cld)
picture.register(Superposition, plot.superposition)


@picture.register
def _(noun: Inspection) -> Picture:
    names = [f"{one.name or one.number} [{one.unit or '?'}]" for one in noun.columns]
    roles = [one.role for one in noun.columns]
    stamp = f"{noun.file}{', SIMULATED' * noun.simulated}"
    return plot.columns(names, roles, noun.course, stamp=stamp)


def html(noun: object) -> str:
    """Return a noun's words above its picture, as a piece of an HTML page."""
    words = repr(noun)
    # pictures on one page must not share their ids
    name = "n" + hashlib.sha256(words.encode()).hexdigest()[:12]
    drawing = plot.to_svg(replace(picture(noun), name=name))
    return f"<div><pre>{escape(words)}</pre>{drawing}</div>"
