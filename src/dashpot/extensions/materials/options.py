"""Options of fits of material tests; imports no NumPy, so that help is fast."""

from __future__ import annotations

from types import MappingProxyType
from typing import Literal, NamedTuple, TypeAlias

from dashpot.base import dataclass
from dashpot.base.errors import DataError
from dashpot.base.option_fields import FormData, option, require_choice
from dashpot.base.units import Dimension, si_fields
from dashpot.workflow.job import declare_shape

Mode: TypeAlias = Literal["uniaxial", "equibiaxial", "planar", "volumetric"]


@dataclass(frozen=True)
class DropOptions:
    """Options of a drop test: impact speeds, or drop heights.

    Attributes
    ----------
    drop : tuple of str
        Impact speed, ``"0.6m/s"``, or drop height, ``"18mm"``, of each impact in its order.
    """

    drop: tuple[str, ...] = option(
        (), "Impact speed of the mass, 0.6m/s, or drop height, 18mm.", metavar="SPEED",
        multiple=True, flag="drop", hidden_alias="slam",
    )  # fmt: skip


@dataclass(frozen=True)
class RodChoices:
    """Options of a rod under a mass: its dimensions and the errors of its test."""

    disc: str | None = declare_shape("Diameter and length of a round rod: 20mm,20mm.")
    block: str | None = declare_shape("Both widths and length of another: 30mm,20mm,10mm.")
    lubricated: bool = option(False, "The ends slide.", is_flag=True)
    gain_error: float = option(0.01, "Gain error between the sensors, e.g. 1%.", unit="strain")
    phase_error: float = option("1deg", "Phase error between the sensors.", unit="angle")
    glue_error: float = option(0.065, "Give of the glue over the rod's; 0: none.", unit="strain")

    def __post_init__(self) -> None:
        si_fields(self)
        for name in ("gain_error", "phase_error", "glue_error"):
            value = getattr(self, name)
            if not 0 <= value < 1:
                raise DataError(
                    f"--{name.replace('_', '-')} {value:g}; expected an error from 0 to below 1"
                )


# Options of stress-strain tests: mode, and the measures of stress and strain.


Measure: TypeAlias = Literal["auto", "nominal", "true"]


class ModeFiles(NamedTuple):
    """Files of one mode of test: their texts, and whether their specimen was pressed."""

    message: str
    mode: Mode
    is_compressed: bool = False


MODES = MappingProxyType({
    "uniaxial": ModeFiles("Uniaxial: stress over strain; tension > 0.", "uniaxial"),
    "compression": ModeFiles(
        "Uniaxial, pressed: whatever the signs.", "uniaxial", is_compressed=True
    ),
    "biaxial": ModeFiles("Equibiaxial.", "equibiaxial"),
    "planar": ModeFiles("Planar tension (pure shear).", "planar"),
    "volumetric": ModeFiles(
        "Pressure over volume ratio or volumetric strain.", "volumetric", is_compressed=True
    ),
})  # fmt: skip
"""Modes by the option that names them."""


@dataclass(frozen=True)
class Measures:
    """Measures of stress and strain in a file: nominal or true.

    Attributes
    ----------
    stress_is : str
        ``"nominal"`` (force over area at rest), ``"true"`` (over the area as it is, of a material
        that keeps its volume), or ``"auto"``: as its column is named, or nominal.
    strain_is : str
        ``"nominal"`` (elongation over length at rest), ``"true"`` (logarithmic) or ``"auto"``.
    """

    stress_is: str = option("auto", "Over the area at rest, or as it is.", choices=Measure)
    strain_is: str = option("auto", "Over the length at rest, or its log.", choices=Measure)

    def __post_init__(self) -> None:
        for name, var in vars(self).items():
            require_choice(name, var, Measure)


def require_quantity(form: FormData, name: str, dimension: Dimension) -> float:
    """Return a quantity of a form of the app that has to be given.

    Raises
    ------
    DataError
        If it is not.
    """
    value = form.number(name, dimension)
    if value is None:
        label = next(form_field.label for form_field in form.fields if form_field.name == name)
        raise DataError(f"{label.lower()} is not given: type it beside the files")
    return value
