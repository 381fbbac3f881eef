"""The pages of what a mass does on its seals: measured, predicted, and both compared."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from dashpot.base.number_format import format_count, format_with_error, hertz, round_to_error, seals
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import convert_to_unit
from dashpot.report.first_screen import NBSP, Row
from dashpot.report.page_content import (
    CollapsibleSection,
    Group,
    KindPage,
    Topic,
    format_specimen_header,
    lights,
    row,
)
from dashpot.report.tables import TextTable
from dashpot.workflow.response.frf_prediction import Prediction
from dashpot.workflow.vibration.impact_tests import Agreement
from dashpot.workflow.vibration.modes import Modes

_PEAK = frozenset({"prediction_informed", "seal_mass_negligible", "mass_of_a_block"})
_RESONANCE = frozenset({
    "resonance", "record_long_enough", "lines_in_half_power_band", "amplitude_linear",
})  # fmt: skip


def mode_rows(mode: Any) -> Iterator[Row]:
    """The numbers of one mode."""
    frequency, ratio, _ = mode.facts
    yield row(frequency, "Natural frequency")
    yield row(ratio, "Damping ratio")


def modes_page(modes: Modes) -> KindPage:
    """What the page of hits or FRFs holds."""
    frf, first = modes.frf, next(iter(modes), None)
    used = f"{frf.averages} of {len(frf.hits)} used" if frf.hits else format_count(1, "FRF")
    top = f"to {round_to_error(float(frf.frequency[-1]), digits=3)}{NBSP}Hz"
    topics = (
        Topic("Hits" if frf.hits else "FRF", says=used),
        Topic("Resonance", _RESONANCE,
             "" if first is None else f"{round_to_error(first.frequency, digits=4)}{NBSP}Hz"),
        Topic("Band", {"coherence", "hammer_excites", "mass_line", "scatter_known"}, top),
    )  # fmt: skip
    hits = tuple(
        (hit.name, f"{hit.time:.3f}", round_to_error(hit.peak, digits=3),
         round_to_error(convert_to_unit(hit.duration, "ms"), digits=3),
         "accepted" if hit.accepted else f"rejected: {'; '.join(hit.reasons)}")
        for hit in frf.hits
    )  # fmt: skip
    marks = tuple("" if hit.accepted else "bad" for hit in frf.hits)
    head = ("hit", "time, s", "peak, N", "pulse, ms", "verdict")
    fold = CollapsibleSection("Every hit", used, TextTable(head, hits, marks))
    return KindPage(
        about="hammer test" if frf.hits else "measured FRF",
        strip=(("Hits", used), ("Averages", str(frf.averages)),
               ("Lines", str(len(frf.frequency))),
               ("Resolution", f"{frf.frequency[1] - frf.frequency[0]:.3g} Hz"),
               ("Quantity", frf.quantity.value.replace("_", " "))),
        lights=lights(modes.checks, *topics),
        answers="Measured response",
        picture=modes.plot(),
        told=format_count(len(modes), "mode").capitalize(),
        groups=tuple(Group(f"Mode {i}", tuple(mode_rows(mode)))
                     for i, mode in enumerate(list(modes)[:4], start=1)),
        sources=tuple(dict.fromkeys(frf.source)),
        folds=(fold,) if hits else (),
        name="modes",
    )  # fmt: skip


def prediction_page(prediction: Prediction) -> KindPage:
    """What the page of a prediction holds."""
    hz, height = prediction.peak
    weight = (
        f"{format_with_error(prediction.mass, 'g', digits=4)} on "
        f"{format_count(int(prediction.seals), 'seal')}"
        if prediction.seals == int(prediction.seals)
        else format_with_error(prediction.mass, "g", digits=4)
    )
    peak: list[Row] = []
    bounds = prediction.limits
    for name, value, ends, unit in (
        ("Largest at" if prediction.at_edge else "Peak frequency", hz,
         None if bounds is None else bounds.peak_frequency, "Hz"),
        ("Height", height, None if bounds is None else bounds.peak_height, ""),
    ):  # fmt: skip
        low, high = ends or (math.nan, math.nan)
        final_row = row(ReportedValue(name, value, low, high, unit))
        peak.append(
            final_row._replace(unit=final_row.unit or prediction.frf.read, bound=ends is not None)
        )
    return KindPage(
        about=f"prediction of {weight}",
        strip=(*format_specimen_header(prediction.fit.specimen), ("Mass", weight),
               ("Valid band", hertz(prediction.fit.band)), ("Fit", prediction.fit.identity[:8])),
        lights=lights(prediction.checks, Topic("Test"),
                      Topic("Peak", _PEAK, f"{round_to_error(hz, digits=4)}{NBSP}Hz"),
                      Topic("Rest", {"compression_tested"}, "within the depth tested")),
        answers="Predicted response",
        picture=prediction.plot(),
        told=f"{weight[:1].upper()}{weight[1:]}",
        groups=(Group("Peak", tuple(peak)),
                *(Group(f"Mode {i}", tuple(mode_rows(mode)))
                  for i, mode in enumerate(prediction.modes[:3], start=1))),
        note=("Hatched: what the relaxation test does not exclude." if bounds is not None else
              "No bound is known without the record behind the fit.")
        if prediction.limits is not None or prediction.interval is None else KindPage.note,
        sources=tuple(dict.fromkeys(prediction.fit.source)),
        name="prediction",
    )  # fmt: skip


def agreement_page(agreement: Agreement) -> KindPage:
    """What the page of a prediction against a hammer holds."""
    c = agreement.comparison
    rows = tuple(Row(name, predicted, "", "", "", measured, bound=False)
                 for name, predicted, measured, _ in c.rows)  # fmt: skip
    differ = tuple((name, predicted, measured, off) for name, predicted, measured, off in c.rows)
    weight = f"{format_with_error(agreement.mass, 'g', digits=4)} on {seals(agreement.seals)}"
    return KindPage(
        about=f"prediction against the hammer, {weight}",
        strip=(("Mass", weight), ("Lines", str(len(c.measured.frequency))),
               ("Mass was", "found from the FRF" if agreement.mass_inferred else "given")),
        lights=lights(agreement.checks, Topic("FRF"),
                      Topic("Stiffness", {"stiffness_agrees"}, "agrees"),
                      Topic("Damping", {"peak_agrees", "damping_agrees"}, "agrees")),
        answers="Measured against predicted",
        picture=agreement.plot(),
        told="Predicted",
        groups=(Group("", tuple(row._replace(unit=row.measured, measured="") for row in rows)),),
        note="The last column is what the hammer measured.",
        sources=tuple(dict.fromkeys(c.measured.source)),
        folds=(CollapsibleSection("How far apart", c.lines,
                    TextTable(("", "predicted", "measured", "difference"), differ)),),
        name="comparison",
    )  # fmt: skip
