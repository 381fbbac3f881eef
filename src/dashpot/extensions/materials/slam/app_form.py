"""Form of the app for slam tests, and the fit by its fields."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.base.option_fields import FormData, FormField
from dashpot.extensions.materials.slam.datamodel import SlamFit
from dashpot.extensions.materials.slam.fit_files import slam_files
from dashpot.reading.read_options import ReadOptions

ASKS = (
    FormField("mass", "Moving mass", "g", "--mass"),
    FormField("slam", "Speed or fall", "", "--drop", form="words"),
)


def fit_form_files(files: Sequence[str], form: FormData, options: ReadOptions) -> SlamFit:
    """Return what the slams say of the piece."""
    mass = form.number("mass", "mass")
    return slam_files(files, mass=mass, slam=form.get_text("slam").split(), options=options)
