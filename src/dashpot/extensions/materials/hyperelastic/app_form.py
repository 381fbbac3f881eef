"""Form of the app for stress-strain curves, and the fit by its fields."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.base.option_fields import FormData, FormField
from dashpot.extensions.materials.hyperelastic.datamodel import HyperelasticFit
from dashpot.extensions.materials.hyperelastic.fit_files import hyperelastic_files
from dashpot.extensions.materials.options import MODES
from dashpot.reading.read_options import ReadOptions

FORM_FIELDS = (FormField("test", "Kind of test", "", "--test", tuple(MODES), per_file=True),)


def fit_form_files(files: Sequence[str], form: FormData, options: ReadOptions) -> HyperelasticFit:
    """Return the hyperelastic law fitted to the files."""
    modes: dict[str, list[str]] = {}
    for i, path in enumerate(files):
        modes.setdefault(form.get_text(f"test {i}") or next(iter(MODES)), []).append(path)
    return hyperelastic_files(modes, options=options)
