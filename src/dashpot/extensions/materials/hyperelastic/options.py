"""Options of stress-strain tests: mode, and the measures of stress and strain."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeAlias

from dashpot.base import dataclass
from dashpot.base.option_fields import option, require_choice

if TYPE_CHECKING:
    from dashpot.extensions.materials.hyperelastic.strain_energy import Mode

Measure: TypeAlias = Literal["auto", "nominal", "true"]


class FilesOfMode(NamedTuple):
    """Files of one mode of test: their texts, and whether their specimen was pressed."""

    message: str
    mode: Mode
    pressed: bool = False


MODES = MappingProxyType({
    "uniaxial": FilesOfMode("Uniaxial: stress over strain; tension > 0.", "uniaxial"),
    "compression": FilesOfMode("Uniaxial, pressed: whatever the signs.", "uniaxial", pressed=True),
    "biaxial": FilesOfMode("Equibiaxial.", "equibiaxial"),
    "planar": FilesOfMode("Planar tension (pure shear).", "planar"),
    "volumetric": FilesOfMode(
        "Pressure over volume ratio or volumetric strain.", "volumetric", pressed=True
    ),
})  # fmt: skip
"""By the option that names them."""


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
