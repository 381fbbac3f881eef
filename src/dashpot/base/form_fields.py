"""What a page asks of a test beside its files: a field each, and what was answered in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple, TypeAlias

from dashpot.base.errors import DataError
from dashpot.base.units import Dimension, convert_to_si, si_range

Form: TypeAlias = Literal["number", "bare", "range", "sizes", "words"]


class FormField(NamedTuple):
    """A field: what it is called, the unit of a number typed without one, its option in a shell.

    Attributes
    ----------
    name, label, unit, flag : str
    choices : tuple of str
        One of them is chosen, the first by default.
    each : bool
        Whether it is asked of every file.
    form : str
        A number with its unit, in a shell ``"bare"`` without one; a ``"range"`` 4 to 8; ``"sizes"``
        with commas between; or ``"words"``, each an option of its own.
    before : str
        What stands before it in a shell.
    """

    name: str
    label: str
    unit: str
    flag: str
    choices: tuple[str, ...] = ()
    each: bool = False
    form: Form = "number"
    before: str = ""

    def read(self, typed: str) -> str:
        """What was typed, with points for decimal commas."""
        return typed.strip() if self.form == "sizes" else typed.strip().replace(",", ".")

    def words(self, text: str) -> tuple[str, ...]:
        """What was answered, as values of its option: none of an empty text."""
        if self.form == "words":
            return tuple(text.split())
        if not text:
            return ()
        if self.form == "sizes":
            text = ",".join(f"{one.strip()}{self.unit}" for one in text.split(",") if one.strip())
        elif self.form == "range":
            text = f"{text.replace(' to ', ':').replace('-', ':')}{self.unit}"
        elif self.form == "number" and text[-1].isdigit():
            text += self.unit
        return (f"{self.before}{text}",)


@dataclass(frozen=True)
class FormData:
    """What was answered.

    Attributes
    ----------
    asks : tuple of Ask
    said : tuple of (str, str)
        Name of the field, of one that is asked of every file with its number, and what was typed.
    """

    asks: tuple[FormField, ...] = ()
    said: tuple[tuple[str, str], ...] = ()

    @classmethod
    def from_fields(cls, asks: tuple[FormField, ...], fields: Mapping[str, str]) -> FormData:
        """The fields as they were typed; those that are not asked, and empty ones, fall away."""
        of = {one.name: one for one in asks}
        said = ((name, of[name.split(" ")[0]].read(text)) for name, text in fields.items()
                if name.split(" ")[0] in of)  # fmt: skip
        return cls(asks, tuple(sorted((name, text) for name, text in said if text)))

    def get_text(self, name: str) -> str:
        """What stands in a field; empty where nothing does."""
        return dict(self.said).get(name, "")

    def number(self, name: str, dimension: Dimension) -> float | None:
        """A quantity, SI: in the field's unit, or in the one typed after it."""
        text = self.get_option_value(name)
        return convert_to_si(text, dimension) if text else None

    def bare(self, name: str) -> float | None:
        """A number in the field's unit alone.

        Raises
        ------
        DataError
            If it is none.
        """
        text = self.get_text(name)
        try:
            return float(text) if text else None
        except ValueError:
            one = self._ask(name)
            raise DataError(
                f"{one.label.lower()} is '{text}'; expected a number of {one.unit}, without it"
            ) from None

    def range(self, name: str, dimension: Dimension) -> tuple[float, float] | None:
        """Two of them, SI, as 4 to 8."""
        text = self.get_option_value(name)
        return si_range(text, dimension) if text else None

    def require_quantity(self, name: str, dimension: Dimension) -> float:
        """A quantity that has to be given.

        Raises
        ------
        DataError
            If it is not.
        """
        found = self.number(name, dimension)
        if found is None:
            label = self._ask(name).label.lower()
            raise DataError(f"{label} is not given: type it beside the files")
        return found

    def options(self, files: int) -> tuple[str, ...]:
        """The words of a shell that say the same of so many files."""
        found: list[str] = []
        for one in self.asks:
            names = [f"{one.name} {i}" for i in range(files)] if one.each else [one.name]
            for name in names:
                for word in one.words(self.get_text(name) or next(iter(one.choices), "")):
                    found += [one.flag, word]
        return tuple(found)

    def get_option_value(self, name: str) -> str:
        """What stands in a field, as a value of its option."""
        return next(iter(self._ask(name).words(self.get_text(name))), "")

    def _ask(self, name: str) -> FormField:
        return next(one for one in self.asks if one.name == name)
