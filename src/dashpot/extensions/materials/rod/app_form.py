"""Form of the app for a rod beside its FRF, and the fit by its fields."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.base.errors import DataError
from dashpot.base.option_fields import FormData, FormField
from dashpot.extensions.materials.options import RodChoices, require_quantity
from dashpot.extensions.materials.rod.fit_files import Rod, rod_files
from dashpot.reading.read_options import ReadOptions

_WATER = 1000.0
"""Density of a rod of which none is given, kg/m^3."""
FORM_FIELDS = (
    FormField("mass", "Mass on it", "g", "--mass"),
    FormField("density", "Density", "kg/m^3", "--density", form="bare"),
    FormField("disc", "\u2300, length", "mm", "--shape", form="sizes", prefix="disc:"),
)


def fit_form_files(files: Sequence[str], form: FormData, options: ReadOptions) -> Rod:
    """Return the modulus of the rod's material."""
    disc = form.get_option_value("disc").removeprefix("disc:")
    if not disc:
        raise DataError("the shape is not given: type diameter and length, such as 20, 20")
    return rod_files(
        files, mass=require_quantity(form, "mass", "mass"),
        density=get_density(form) or _WATER, rod=RodChoices(disc=disc), options=options,
    )  # fmt: skip


def get_density(form: FormData) -> float | None:
    """Return the density of the form, kg/m^3; None if it is empty.

    Raises
    ------
    DataError
        If it is no number.
    """
    text = form.get_text("density")
    try:
        return float(text) if text else None
    except ValueError:
        raise DataError(f"density is '{text}'; expected a number of kg/m^3, without it") from None
