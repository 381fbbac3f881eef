"""Options as dataclass fields: choices, units, names in the command line and in forms."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import Field, field, fields
from typing import Any, Literal, NamedTuple, TypeAlias, get_args

from dashpot.base import dataclass
from dashpot.base.errors import DashpotError, DataError
from dashpot.base.units import Dimension, convert_to_si, si_range

# Types of options with a fixed set of values.
#
# Signatures, options of the command line, buttons of the app and error messages take the values
# from these types. This module does not import NumPy, which ``--help`` does without.


Method: TypeAlias = Literal["full", "hold"]
RampLawOption: TypeAlias = Literal["auto", "linear", "nonlinear"]
Family: TypeAlias = Literal["maxwell", "fractional"]
FamilyOption: TypeAlias = Literal["auto", Family]
Estimate: TypeAlias = Literal["H1", "H2", "Hv", "Hs"]
OverBase: TypeAlias = Literal["absolute", "relative"]
ShiftLaw: TypeAlias = Literal["auto", "wlf", "arrhenius", "free"]
Vertical: TypeAlias = Literal["1", "T/T_r", "free"]
VerticalOption: TypeAlias = Literal["auto", Vertical]
AmplitudeLaw: TypeAlias = Literal["factor", "additive", "cubic", "factor+cubic", "additive+cubic"]
AmplitudeLawOption: TypeAlias = Literal["auto", AmplitudeLaw]
PartMode: TypeAlias = Literal[
    "compression", "shear", "axial", "torsion", "radial-short", "radial-long"
]  # fmt: skip
FrfKind: TypeAlias = Literal["receptance", "mobility", "accelerance", "dynamic_stiffness"]
Driver: TypeAlias = Literal["simulated", "serial", "replay"]
Rehearsed: TypeAlias = Literal["relaxation", "creep", "impact", "motion"]

FigureFormat: TypeAlias = Literal["pdf", "png", "svg"]
FigureSize: TypeAlias = Literal["column", "slide"]


def get_choice_values(choice: Any) -> tuple[str, ...]:
    """Return the words of such a type, or of an enumeration.

    >>> get_choice_values(FamilyOption)
    ('auto', 'maxwell', 'fractional')
    """
    return get_args(choice) or tuple(choice)


def require_choice(
    name: str, value: object, choice: Any, error: type[DashpotError] = DataError
) -> None:
    """Raise an error if a word is none of the allowed choices.

    Raises
    ------
    DataError
        Or another `error`, if it is none.
    """
    values = get_choice_values(choice)
    if value not in values:
        raise error(f"{name} = {value!r}; expected one of {', '.join(values)}")


# Fields of options. Each is declared once, in its dataclass.
#
# Command line, Python and app take name, unit, limits and default of an option from it.


def option(default: Any, help: str | None = None, **metadata: Any) -> Any:
    """Return a dataclass field with the metadata of its option.

    Keys of `metadata`:

    - ``metavar``, ``multiple``, ``is_flag``: as of click;
    - ``flag``: name of the option if it is not that of the field; ``hidden_alias``: its name in the
      previous edition, still accepted;
    - ``keyed_flag``: option that takes the value as KEY=VALUE; ``key``: KEY if it is not the name
      of the field; ``separator``: sign between them if it is not ``"="``;
    - ``argument``: position of an argument without an option name;
    - ``unit``: dimension of a quantity; ``is_range``: whether two of them make a range; ``size``:
      row of ``SIZES``, its plausible values;
    - ``choices``: type of this module; ``minimum``: of an integer; ``exclusive_minimum``: of any
      number; ``keyword``: word that stands for no number, such as ``"auto"``;
    - ``parse``: function from the value of click to that of the field; ``unparse``: its inverse;
    - ``stage``: first stage of a job that depends on it, ``"test"`` or ``"fit"``.
    """
    if "choices" in metadata:
        metadata["choices"] = get_choice_values(metadata["choices"])
    return field(default=default, metadata={"help": help, **metadata})


def copy_option(cls: type, name: str, **other: Any) -> Any:
    """Return the field of another dataclass, with these changes."""
    attribute = next(field for field in fields(cls) if field.name == name)
    return option(**{"default": attribute.default, **attribute.metadata, **other})


def make_nested_options(kind: type, **metadata: Any) -> Any:
    """Return the field that holds a value with options of its own."""
    return field(default_factory=kind, metadata={"options_class": kind, **metadata})


def iterate_option_fields(result: Any) -> Iterator[Field[Any]]:
    """Yield the option fields of a dataclass, without those of nested dataclasses."""
    for attribute in fields(result):
        if "help" in attribute.metadata and "argument" not in attribute.metadata:
            yield attribute


def is_path_field(attribute: Field[Any]) -> bool:
    """Return whether a field holds a path, or several."""
    return attribute.metadata.get("metavar") in {"FILE", "FRF"}


def get_option_flag(attribute: Field[Any]) -> str:
    """Return the option that takes a field, as it is typed: ``--seal-mass``, ``--machine``."""
    metadata = attribute.metadata
    return "--" + str(metadata.get("keyed_flag", metadata.get("flag", attribute.name))).replace(
        "_", "-"
    )


def get_option_key(attribute: Field[Any]) -> str:
    """Return the KEY by which an option of KEY=VALUE takes a field: ``ramp-end``."""
    return str(attribute.metadata.get("key", attribute.name)).replace("_", "-")


def format_option_flags(cls: type) -> str:
    """Return the options of a value as a sentence lists them.

    >>> from dashpot.workflow.job import TimeLimits
    >>> format_option_flags(TimeLimits)
    '--time-limits'
    """
    *other_flags, last = dict.fromkeys(map(get_option_flag, iterate_option_fields(cls)))
    return f"{', '.join(other_flags)} and {last}" if other_flags else last


# Form of the app: the fields that a kind of test needs besides its files, and their values.


Form: TypeAlias = Literal["number", "bare", "range", "sizes", "words"]


class FormField(NamedTuple):
    """Field of a form: label, unit of a number without one, and option of the command line.

    Attributes
    ----------
    name, label, unit, flag : str
    choices : tuple of str
        One of them is chosen, the first by default.
    per_file : bool
        Whether each file has its own value.
    form : str
        A number with its unit, in a shell ``"bare"`` without one; a ``"range"`` 4 to 8; ``"sizes"``
        with commas between; or ``"words"``, each an option of its own.
    prefix : str
        Text before the value on the command line, such as ``"disc:"``.
    """

    name: str
    label: str
    unit: str
    flag: str
    choices: tuple[str, ...] = ()
    per_file: bool = False
    form: Form = "number"
    prefix: str = ""

    def read(self, text: str) -> str:
        """Return the typed text, with points for decimal commas."""
        return text.strip() if self.form == "sizes" else text.strip().replace(",", ".")

    def words(self, text: str) -> tuple[str, ...]:
        """Return the entries of a field as values of its option: none of an empty text."""
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
        return (f"{self.prefix}{text}",)


@dataclass(frozen=True)
class FormData:
    """Values of a filled-in form.

    Attributes
    ----------
    fields : tuple of FormField
    entries : tuple of (str, str)
        Name of the field (with the number of the file, where each file has its own value), and the
        typed text.
    """

    fields: tuple[FormField, ...] = ()
    entries: tuple[tuple[str, str], ...] = ()

    def get_text(self, name: str) -> str:
        """Return the text of a field; empty if there is none."""
        return dict(self.entries).get(name, "")

    def number(self, name: str, dimension: Dimension) -> float | None:
        """Return a quantity, SI: in the field's unit, or in the one typed after it."""
        text = self.get_option_value(name)
        return convert_to_si(text, dimension) if text else None

    def range(self, name: str, dimension: Dimension) -> tuple[float, float] | None:
        """Two of them, SI, as 4 to 8."""
        text = self.get_option_value(name)
        return si_range(text, dimension) if text else None

    def get_option_value(self, name: str) -> str:
        """Return the text of a field as a value of its option."""
        return next(iter(self._ask(name).words(self.get_text(name))), "")

    def _ask(self, name: str) -> FormField:
        return next(form_field for form_field in self.fields if form_field.name == name)
