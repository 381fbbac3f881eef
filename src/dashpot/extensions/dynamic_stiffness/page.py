"""Page of stiffness and loss factor at frequencies."""

from __future__ import annotations

from dashpot.base.number_format import hertz
from dashpot.extensions.dynamic_stiffness.figure import draw_stiffness_prediction
from dashpot.extensions.dynamic_stiffness.prediction import StiffnessPrediction
from dashpot.report.result_page import (
    Group,
    KindPage,
    Topic,
    format_specimen_header,
    make_indicators,
    row,
)


def lay_out_stiffness(prediction: StiffnessPrediction) -> KindPage:
    """Return the page of stiffness and loss factor at the requested frequencies."""
    fit = prediction.fit
    values = tuple(
        row(value, value.symbol.replace("''", "\N{DOUBLE PRIME}").replace("'", "\N{PRIME}"))
        for value in prediction.values
    )
    return KindPage(
        subject="stiffness at frequencies",
        summary_line=(
            *format_specimen_header(fit.specimen),
            ("Valid band", hertz(fit.band)),
        ),
        indicators=make_indicators(prediction.checks, Topic("Checks")),
        figure_title="Stiffness and loss factor over frequency",
        picture=draw_stiffness_prediction(prediction),
        table_title="At the frequencies asked",
        groups=(Group("", values),),
        sources=prediction.sources,
        note="From and to are the 95 % interval; where they are empty nothing bounds the value.",
    )
