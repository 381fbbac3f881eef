"""Tables of a door file: keys that are required, vectors, lists and switches."""

from __future__ import annotations

from typing import TypeAlias

from dashpot.base.errors import ReadError
from dashpot.base.units import Dimension
from dashpot.reading.toml import Section, is_plain_number

Vector: TypeAlias = tuple[float, float, float]


class DoorSection(Section):
    """Table of a door file."""

    def require_keys(self, *names: str) -> None:
        """Raise a :class:`ReadError` for the first of the keys that is missing."""
        for name in names:
            if name not in self.entries:
                raise ReadError(f"{self.location}: {name} is missing")

    def quantities(self, name: str, dimension: Dimension) -> tuple[float, ...] | None:
        """Return quantities: ``["5mm", "6mm"]``, or ``"5, 6, 7 mm"`` with one unit for all."""
        value = self.entries.get(name)
        if value is None:
            return None
        if isinstance(value, str):
            *first, last = value.split(",")
            unit = last.lstrip("+-0123456789.eE ")
            value = [text if text.lstrip("+-0123456789.eE ") else text + unit for text in first]
            value.append(last)
        if not isinstance(value, list):
            value = [value]
        return tuple(self._quantity(name, item, dimension) for item in value)

    def vector(self, name: str, dimension: Dimension) -> Vector | None:
        """Return three quantities, along x, y and z: ``"0, 300, 0 mm"``."""
        values = self.quantities(name, dimension)
        if values is None:
            return None
        if len(values) != 3:
            raise ReadError(
                f"{self.location}: {name} has {len(values)} numbers; expected three, of x, y and z"
            )
        return values[0], values[1], values[2]

    def direction(self, name: str) -> Vector | None:
        """Return three plain numbers: ``[0, 0, 1]``."""
        value = self.entries.get(name)
        if value is None:
            return None
        is_vector = isinstance(value, list) and len(value) == 3
        if not is_vector or not all(is_plain_number(item) for item in value) or not any(value):
            raise ReadError(
                f"{self.location}: {name} = {value!r}; expected a direction, three numbers such as "
                "[0, 0, 1]"
            )
        return float(value[0]), float(value[1]), float(value[2])

    def words(self, name: str) -> tuple[str, ...] | None:
        """Return texts."""
        value = self.entries.get(name)
        if value is not None and not (
            isinstance(value, list) and all(isinstance(item, str) for item in value)
        ):
            raise ReadError(f"{self.location}: {name} = {value!r}; expected a list of texts")
        return None if value is None else tuple(value)

    def flag(self, name: str) -> bool:
        """Return true or false; false if it is not there."""
        value = self.entries.get(name, False)
        if not isinstance(value, bool):
            raise ReadError(f"{self.location}: {name} = {value!r}; expected true or false")
        return value
