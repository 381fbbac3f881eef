"""What was tested."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dashpot.base.errors import DataError


@dataclass(frozen=True)
class Specimen:
    """What was tested.

    Attributes
    ----------
    length : float or None
        Contact length of the seal under the plate, m.
    height : float or None
        Free height of the section, m.
    temperature : float or None
        Test temperature, K.
    notes : str
        Anything else worth keeping: material, fixing, load history.
    """

    length: float | None = None
    height: float | None = None
    temperature: float | None = None
    notes: str = ""

    def __post_init__(self) -> None:
        for name in ("length", "height", "temperature"):
            value = getattr(self, name)
            if value is not None and not (np.isfinite(value) and value > 0):
                raise DataError(f"specimen {name} = {value!r}; expected a number > 0 in SI units")
