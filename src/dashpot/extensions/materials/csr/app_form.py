"""Form of the app for compression stress relaxation, and the fit by its fields."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from dashpot.base.option_fields import FormData, FormField
from dashpot.datamodel.machine import Machine
from dashpot.extensions.materials.csr.datamodel import Aging
from dashpot.extensions.materials.csr.fit_files import csr_files
from dashpot.extensions.materials.csr.lifetime_prediction import AgingPrediction
from dashpot.reading.read_options import ReadOptions

FORM_FIELDS = (
    FormField("use_at", "Temperature of use", "degC", "--use-at"),
    FormField("oven", "Ovens known to", "K", "--machine", prefix="oven="),
)


def fit_form_files(
    files: Sequence[str], form: FormData, options: ReadOptions
) -> Aging | AgingPrediction:
    """Return the aging law of the files, or the life at the temperature of use."""
    oven: Any = form.get_option_value("oven").removeprefix("oven=")
    return csr_files(
        files,
        machine=Machine(oven=oven) if oven else None,
        use_at=form.number("use_at", "temperature"),
        options=options,
    )
