"""Parameter types of options: quantities, ranges, KEY=VALUE, and values for some files only."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import Field
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import click

from dashpot.base.errors import DashpotError
from dashpot.base.lazy import compile_on_use
from dashpot.base.option_fields import (
    FigureFormat,
    get_choice_values,
    get_option_key,
    is_path_field,
)
from dashpot.base.units import Dimension, parse_quantity, parse_range
from dashpot.registry import find_handler

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from dashpot.registry.plugins import Group


def format_suggestion(word: str, names: Iterable[str]) -> str:
    """Return the sentence that names the likeliest of known words, or all of them.

    >>> format_suggestion("forc", ["force", "time"])
    "Did you mean 'force'?"
    >>> format_suggestion("x", ["force", "time"])
    'Known are force and time.'
    """
    from difflib import get_close_matches  # where a word was misspelt

    known_names = list(dict.fromkeys(names))
    close_matches = get_close_matches(word, known_names, 1)
    if close_matches:
        return f"Did you mean '{close_matches[0]}'?"
    return format_choices(known_names)


def format_choices(words: Sequence[str]) -> str:
    """Return all words there are, as a sentence."""
    return f"Known are {', '.join(words[:-1])} and {words[-1]}." if words[1:] else ""


class File(click.ParamType[str]):
    """Path of an input file, which the shell completes."""

    name = "file"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        return str(value)

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        from click.shell_completion import CompletionItem

        return [CompletionItem(incomplete, type=self.name)]


class Folder(File):
    """Path of a folder."""

    name = "dir"


class Output(File):
    """Path of an output file; ``-`` is stdout.

    With `suffixes` a name that ends otherwise is refused: it would name another format.
    """

    def __init__(self, suffixes: Sequence[str] = ()) -> None:
        self.suffixes = tuple(suffixes)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        suffix = Path(value).suffix.lower()
        if self.suffixes and suffix and suffix not in self.suffixes:
            text = " or ".join(self.suffixes)
            self.fail(f"'{value}': this is written as {text}, not as {suffix}", param, ctx)
        return super().convert(value, param, ctx)


class WithUnit(click.ParamType[Any]):
    """Number with its unit, such as ``104g``; the value passed on is in SI.

    A `word` stands for no number, and is passed on as None.
    """

    _parsed: Callable[[str, Dimension], Any] = staticmethod(parse_quantity)

    def __init__(self, dimension: Dimension, word: str = "") -> None:
        self.dimension: Dimension = dimension
        self.word = word
        self.name = DIMENSION_NAMES.get(dimension, dimension.replace(" ", "-"))

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if not isinstance(value, str) or value == self.word:
            return None if value == self.word else value
        try:
            return self._parsed(value, self.dimension)
        except DashpotError as error:
            self.fail(str(error), param, ctx)

    def get_missing_message(self, param: click.Parameter, ctx: click.Context | None) -> str:
        return getattr(param, "help", None) or ""


class PlainNumber(click.ParamType[float]):
    """Number without a unit; that unit is stated by another option."""

    name = "number"

    def __init__(self, unit_text: str, example: str) -> None:
        self.of, self.example = unit_text, example

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        try:
            return float(value)
        except ValueError:
            self.fail(f"'{value}' is no plain number{self.of}, such as {self.example}", param, ctx)


DENSITY = PlainNumber(" of kg/m^3", "1000")

DIMENSION_NAMES = {"strain": "share", "force rate": "rate"}
"""Name of a dimension in the help, if different from its own name."""


class Range(WithUnit):
    """Two quantities, such as ``1:50Hz``, in SI."""

    _parsed = staticmethod(parse_range)

    def __init__(self, dimension: Dimension, word: str = "") -> None:
        super().__init__(dimension, word)
        self.name = "range"


class Wlf(click.ParamType[Any]):
    """Law of Williams, Landel and Ferry: ``C1,C2,T_r``, such as ``6.94,129.6K,23degC``."""

    name = "C1,C2,T_r"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if not isinstance(value, str):
            return value
        from dashpot.solids.shift_laws import WLF

        try:
            c1, c2, reference = value.split(",")
            # C_2 is a difference of temperatures: a K is a degree
            kelvin = parse_quantity(reference.strip(), "temperature")
            return WLF(float(c1), float(c2.strip().removesuffix("K")), kelvin)
        except DashpotError as error:
            self.fail(str(error), param, ctx)
        except ValueError:
            self.fail(f"'{value}': expected C1,C2,T_r, such as 6.94,129.6K,23degC", param, ctx)


class Direction(click.ParamType[Any]):
    """Three numbers, ``x,y,z``."""

    name = "x,y,z"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if not isinstance(value, str):
            return value
        try:
            x, y, z = map(float, value.split(","))
        except ValueError:
            self.fail(f"'{value}': expected x,y,z, such as 0,0,-1", param, ctx)
        return x, y, z


class Figure(Output):
    """Path of a figure, refused at once if its suffix is not supported."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        if Path(value).suffix.lower().lstrip(".") not in get_choice_values(FigureFormat):
            self.fail(f"'{value}': a figure is written as .pdf, .png or .svg", param, ctx)
        return super().convert(value, param, ctx)


class ArmCount(click.ParamType[Any]):
    """Number of Maxwell arms, or ``auto``."""

    name = "N"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if value == "auto" or isinstance(value, int):
            return value
        if not value.isdecimal():
            self.fail(
                f"'{value}' is not a number of arms; expected 'auto', 0, 1, 2, ...", param, ctx
            )
        return int(value)


class ChoiceWithSuggestion(click.Choice[str]):
    """Word of a choice, or plug-in of a group; an error names the nearest."""

    name = "NAME"

    def __init__(
        self,
        choices: Sequence[str],
        *,
        plugins: Group | None = None,
        synonyms: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        super().__init__(choices)
        self.plugins, self.synonyms = plugins, synonyms

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        key = str(value).lower()
        spellings = {choice.lower(): choice for choice in self.choices} | dict(self.synonyms)
        value = spellings.get(key) or spellings.get(re.sub("[-_ ]", "", key), value)
        if value not in self.choices and not self._is_plugin(str(value)):
            advice = find_handler("choice", key) or format_suggestion(key, self.choices)
            message = f"'{value}' is unknown. {advice}"
            self.fail(message + self._example_units(), param, ctx)
        return str(value)

    def get_missing_message(self, param: click.Parameter, ctx: click.Context | None) -> str:
        return format_choices(self.choices)

    def _is_plugin(self, value: str) -> bool:
        if self.plugins is None:
            return False
        from dashpot.registry.plugins import (
            find_plugin,  # no name of dashpot's own asks for metadata
        )

        return find_plugin(self.plugins, value) is not None

    def _example_units(self) -> str:
        if self.plugins is None:
            return ""
        from dashpot.registry.plugins import format_plugin_names

        return format_plugin_names(self.plugins)


class Scoped(click.ParamType[Any]):
    """A value for all files, or ``GLOB:VALUE`` for those whose name the pattern matches."""

    def __init__(self, kind: click.ParamType[Any]) -> None:
        self.kind = kind
        self.name = kind.name

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if not isinstance(value, str):
            return value
        # one letter before a colon is a drive
        match = re.match(r"^(?P<glob>.{2,}?):(?P<rest>(?:[A-Za-z]:)?[^:]+)$", value)
        glob, text = (match["glob"], match["rest"]) if match else ("", value)
        return glob, self.kind.convert(text, param, ctx)

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[click.shell_completion.CompletionItem]:
        return self.kind.shell_complete(ctx, param, incomplete)


class Keyed(click.ParamType[Any]):
    """``KEY=VALUE``, or several with commas between; ``GLOB:`` before it is for some files alone.

    The value passed on is the pattern and the stated fields, in SI.
    """

    name = "KEY=VALUE"

    def __init__(self, flag: str, fields: Sequence[Field[Any]]) -> None:
        self.flag = flag
        self.fields = {get_option_key(field): field for field in fields}
        self.sign = fields[-1].metadata.get("separator", "=")
        # the field that the option is named after is typed without a key: FILE,axis=Fz
        self.first = next((field for field in fields if f"--{field.name}" == flag), None)
        keys = "|".join(map(re.escape, self.fields))
        self.between = compile_on_use(rf",(?=(?:{keys}){self.sign})")

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if not isinstance(value, str):
            return value
        read_file = find_handler("read option", self.flag) if value.endswith(".toml") else None
        if read_file is not None:
            return "", read_file(value)
        glob, pairs_text = self._scope(value)
        values: dict[str, Any] = {}
        for position, pair in enumerate(self.between.split(pairs_text)):
            field, text = self._field(pair, position, param, ctx)
            converted = self._convert_field(field, text, param, ctx)
            values[field.name] = (
                (*values.get(field.name, ()), converted)
                if "multiple" in field.metadata
                else converted
            )
        return glob, values

    def _scope(self, value: str) -> tuple[str, str]:
        if self.sign != "=":
            return "", value
        if self.first is not None:
            match = re.match(r"^(?P<glob>[^=]{2,}?):(?P<rest>(?:[A-Za-z]:)?[^:]+)$", value)
        else:
            match = re.match(r"^(?P<glob>[^=]+):(?P<rest>[\w -]+=.*)$", value, re.DOTALL)
        return (match["glob"], match["rest"]) if match else ("", value)

    def _field(
        self, pair: str, position: int, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[Field[Any], str]:
        key, separator, text = pair.partition(self.sign)
        key = re.sub(r"[ _]", "-", key.strip().lower())
        keys = [word for word in self.fields if self.first is None or f"--{word}" != self.flag]
        if self.first is not None and position == 0 and key not in keys:
            return self.first, pair
        if not separator or not text.strip():
            word = key if key in keys else keys[0]
            self.fail(f"'{pair}': write {self.flag} {word}{self.sign}VALUE", param, ctx)
        if key not in keys:
            suggest = find_handler("suggest key", self.flag)
            advice = (suggest and suggest(key, text)) or format_suggestion(key, keys)
            self.fail(f"'{key}' is unknown. {advice}", param, ctx)
        return self.fields[key], text

    def _convert_field(
        self,
        field: Field[Any],
        text: str,
        param: click.Parameter | None,
        ctx: click.Context | None,
    ) -> Any:
        kind = type_of(field)
        value = kind.convert(text, param, ctx)
        if is_path_field(field) and ctx is not None:
            with suppress(AttributeError):
                ctx.meta.setdefault("dashpot.reads", []).append(value)
        return value

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[click.shell_completion.CompletionItem]:
        """Propose the keys."""
        if self.first is not None:
            return [click.shell_completion.CompletionItem(incomplete, type="file")]
        return [
            click.shell_completion.CompletionItem(f"{key}{self.sign}")
            for key in self.fields
            if key.startswith(incomplete)
        ]


class Units(Scoped):
    """``ROLE=UNIT``, or several; ``GLOB:`` before it is for some files alone."""

    def __init__(self) -> None:
        super().__init__(click.STRING)
        self.name = "ROLE=UNIT"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        from dashpot.reading.read_options import parse_units

        if not isinstance(value, str):
            return value
        # a pattern has the look of a file; what else stands before a colon is a column's name
        file_pattern = r"(?:[A-Za-z]:)?[^=:]*[*?\[./\\][^=:]*"
        match = re.match(rf"^(?P<glob>{file_pattern}):(?P<rest>\S[^=]*=.*)$", value, re.DOTALL)
        glob, text = (match["glob"], match["rest"]) if match else ("", value)
        try:
            return glob, parse_units(text)
        except DashpotError as error:
            self.fail(str(error), param, ctx)


def type_of(field: Field[Any]) -> click.ParamType[Any]:
    """Return the click type of a field."""
    metadata = field.metadata
    if "unit" in metadata:
        kind = Range if "is_range" in metadata else WithUnit
        return kind(metadata["unit"], metadata.get("keyword", ""))
    if "choices" in metadata:
        return ChoiceWithSuggestion(tuple(metadata["choices"]))
    if is_path_field(field):
        return File()
    if "exclusive_minimum" in metadata:
        return click.FloatRange(metadata["exclusive_minimum"], min_open=True)
    if "keyword" in metadata:
        return ArmCount()
    if "minimum" in metadata:
        return click.IntRange(metadata["minimum"])
    return _TYPES.get(type(field.default), click.STRING)


_TYPES: dict[type, click.ParamType[Any]] = {bool: click.BOOL, float: click.FLOAT, int: click.INT}
