"""Form of the app for compression load deflection, and the fit by its fields."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.base.option_fields import FormData, FormField
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.materials.cld.fit_files import CLDResult, cld_files
from dashpot.reading.read_options import ReadOptions

FORM_FIELDS = (
    FormField("compression", "Compression", "mm", "--compression"),
    FormField(
        "compression_limits", "Compression limits", "mm", "--compression-limits", form="range"
    ),
    FormField("length", "Length of one specimen", "mm", "--length"),
)


def fit_form_files(files: Sequence[str], form: FormData, options: ReadOptions) -> CLDResult:
    """Return the figures of the specimens."""
    length = form.number("length", "length")
    return cld_files(
        files,
        at=form.number("compression", "length"),
        compression_limits=form.range("compression_limits", "length"),
        specimen=Specimen(length=length) if length else None,
        options=options,
    )
