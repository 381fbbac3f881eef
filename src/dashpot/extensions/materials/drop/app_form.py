"""Form of the app for drop tests, and the fit by its fields."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.base.option_fields import FormData, FormField
from dashpot.extensions.materials.drop.datamodel import DropFit
from dashpot.extensions.materials.drop.fit_files import fit_drop_files
from dashpot.reading.read_options import ReadOptions

FORM_FIELDS = (
    FormField("mass", "Moving mass", "g", "--mass"),
    FormField("drop", "Speed or fall", "", "--drop", form="words"),
)


def fit_form_files(files: Sequence[str], form: FormData, options: ReadOptions) -> DropFit:
    """Return the fit of the drop tests in files, with the values of the form."""
    mass = form.number("mass", "mass")
    return fit_drop_files(files, mass=mass, drop=form.get_text("drop").split(), options=options)
