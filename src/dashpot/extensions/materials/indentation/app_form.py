"""Form of the app for indentation tests, and the fit by its fields."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.base.option_fields import FormData, FormField
from dashpot.extensions.materials.indentation.datamodel import IndentationFit
from dashpot.extensions.materials.indentation.fit_files import indent_file
from dashpot.extensions.materials.indentation.indenter import Indenter
from dashpot.extensions.materials.options import require_quantity
from dashpot.reading.read_options import ReadOptions

FORM_FIELDS = (
    FormField("mass", "Moving mass", "g", "--mass"),
    FormField("radius", "Tip radius", "mm", "--radius"),
    FormField("drop_height", "Drop height", "mm", "--drop-height"),
)


def fit_form_files(files: Sequence[str], form: FormData, options: ReadOptions) -> IndentationFit:
    """Return the fitted contact law of the file, with the values of the form."""
    indenter = Indenter(
        mass=require_quantity(form, "mass", "mass"),
        radius=form.number("radius", "length"),
        drop_height=form.number("drop_height", "length"),
    )
    return indent_file(files[0], indenter=indenter, options=options)
