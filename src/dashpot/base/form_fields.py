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
            text = ",".join(
                f"{part.strip()}{self.unit}" for part in text.split(",") if part.strip()
            )
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
        of = {form_field.name: form_field for form_field in asks}
        stated = ((name, of[name.split(" ")[0]].read(text)) for name, text in fields.items()
                if name.split(" ")[0] in of)  # fmt: skip
        return cls(asks, tuple(sorted((name, text) for name, text in stated if text)))

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
            item = self._ask(name)
            raise DataError(
                f"{item.label.lower()} is '{text}'; expected a number of {item.unit}, without it"
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
        value = self.number(name, dimension)
        if value is None:
            label = self._ask(name).label.lower()
            raise DataError(f"{label} is not given: type it beside the files")
        return value

    def options(self, files: int) -> tuple[str, ...]:
        """The words of a shell that say the same of so many files."""
        results: list[str] = []
        for form_field in self.asks:
            names = (
                [f"{form_field.name} {i}" for i in range(files)]
                if form_field.each
                else [form_field.name]
            )
            for name in names:
                for word in form_field.words(
                    self.get_text(name) or next(iter(form_field.choices), "")
                ):
                    results += [form_field.flag, word]
        return tuple(results)

    def get_option_value(self, name: str) -> str:
        """What stands in a field, as a value of its option."""
        return next(iter(self._ask(name).words(self.get_text(name))), "")

    def _ask(self, name: str) -> FormField:
        return next(form_field for form_field in self.asks if form_field.name == name)
