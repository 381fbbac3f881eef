"""Form of the app for blank tests, the fit by its fields, and the machine file that it saves."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.base.option_fields import FormData, FormField
from dashpot.extensions.blank_tests.datamodel import MachineFit
from dashpot.extensions.blank_tests.fit_files import fit_blank_files
from dashpot.extensions.blank_tests.machine_file import render_machine_file
from dashpot.reading.read_options import ReadOptions

FORM_FIELDS = (
    FormField("spring_stiffness", "Spring stiffness", "N/mm", "--spring-stiffness"),
    FormField("spring_error", "Its standard error", "%", "--spring-error"),
)


def fit_form_files(files: Sequence[str], form: FormData, options: ReadOptions) -> MachineFit:
    """Return the fit of a testing machine from the files."""
    return fit_blank_files(
        files,
        spring_stiffness=form.number("spring_stiffness", "stiffness"),
        spring_error=form.number("spring_error", "strain"),
        options=options,
    )


def save_machine_file(fit: MachineFit) -> tuple[str, str, str]:
    """Return name, media type and text of the machine file."""
    return "rig.toml", "application/toml", render_machine_file(fit)
