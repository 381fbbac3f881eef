"""Options: those that a noun's fields declare, and those that several commands share."""

from __future__ import annotations

import functools
from collections.abc import Callable, Container, Sequence
from contextlib import suppress
from dataclasses import MISSING, Field, fields
from pathlib import Path
from typing import Any, TypeVar

import click
from click.core import ParameterSource

import dashpot as dp
from dashpot.base.choices import Drawn, words
from dashpot.base.errors import DashpotError, ReadError
from dashpot.base.options import flag_of, names_files, offered
from dashpot.base.units import Dimension, parse_quantity, parse_range
from dashpot.cli._shell import File, Output, is_json, opens, reads
from dashpot.io.options import ReadOptions
from dashpot.records.machine import Machine
from dashpot.records.specimen import Specimen
from dashpot.workflow.job import Cuts, HammerChoices, Job

T = TypeVar("T")

_TYPED = "dashpot.typed"
"""Where quantities are kept as they were typed."""


class WithUnit(click.ParamType[Any]):
    """A number with its unit, such as ``104g``; the value passed on is in SI.

    A `word` stands for no number, and is passed on as None.
    """

    _parsed: Callable[[str, Dimension], Any] = staticmethod(parse_quantity)

    def __init__(self, dimension: Dimension, word: str = "") -> None:
        self.dimension: Dimension = dimension
        self.word = word
        self.name = f"{word}|{dimension}" if word else dimension

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if not isinstance(value, str) or value == self.word:
            return None if value == self.word else value
        if ctx is not None and param is not None and param.name is not None:
            kept = ctx.meta.setdefault(_TYPED, {})
            kept[param.name] = (*kept.get(param.name, ()), value) if param.multiple else value
        try:
            return self._parsed(value, self.dimension)
        except DashpotError as error:
            self.fail(str(error), param, ctx)


class Range(WithUnit):
    """Two quantities, such as ``1:50Hz``, in SI."""

    _parsed = staticmethod(parse_range)


class Wlf(click.ParamType[Any]):
    """A law of Williams, Landel and Ferry: ``C1,C2,T_r``, such as ``6.94,129.6K,23degC``."""

    name = "C1,C2,T_r"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if not isinstance(value, str):
            return value
        from dashpot.solids.temperature import WLF

        try:
            c1, c2, reference = value.split(",")
            # C_2 is a difference of temperatures: a K is a degree
            return WLF(float(c1), float(c2.strip().removesuffix("K")), _kelvin(reference))
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


def _kelvin(text: str) -> float:
    return parse_quantity(text.strip(), "temperature")


class Figure(Output):
    """A figure's file, refused before the work if its suffix is none that is drawn."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        if Path(value).suffix.lower().lstrip(".") not in words(Drawn):
            self.fail(f"'{value}': a figure is written as .pdf, .png or .svg", param, ctx)
        return super().convert(value, param, ctx)


class ArmCount(click.ParamType[Any]):
    """A number of Maxwell arms, or ``auto``."""

    name = "auto|N"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if value == "auto" or isinstance(value, int):
            return value
        if not value.isdecimal():
            self.fail(
                f"'{value}' is not a number of arms; expected 'auto', 0, 1, 2, ...", param, ctx
            )
        return int(value)


def filled(
    noun: type, receives: str, *, show_default: bool = False, leave: Sequence[str] = ()
) -> Callable[[Callable[..., T]], Callable[..., T]]:
    """Give a command the options that the fields of `noun` declare; it receives one noun.

    A field is an option if :func:`~dashpot.base.options.option` made it, but for those to `leave`.
    """
    asked = [one for one in offered(noun) if one.name not in leave]
    # nouns may share the name of a field
    return _declared(
        asked, f"{receives}_", lambda own: {receives: noun(**own)}, show_default=show_default
    )


def of(noun: type, *names: str, **other: Any) -> Callable[[Callable[..., T]], Callable[..., T]]:
    """Give a command the options that these fields of `noun` declare, or all; it receives each.

    `other` is what these options say otherwise here: `help`, `default`, `required`.
    """
    every = {one.name: one for one in offered(noun)}
    asked = [every[name] for name in names or every]
    return _declared(asked, "", lambda own: own, show_default=True, **other)


def _declared(
    asked: Sequence[Field[Any]],
    prefix: str,
    made: Callable[[dict[str, Any]], dict[str, Any]],
    *,
    show_default: bool,
    **other: Any,
) -> Callable[[Callable[..., T]], Callable[..., T]]:
    def decorate(function: Callable[..., T]) -> Callable[..., T]:
        @functools.wraps(function)
        def command(**given: Any) -> T:
            own = {one.name: _value(one, given.pop(prefix + one.name)) for one in asked}
            return function(**made(own), **given)

        for one in reversed(asked):
            how = {key: one.metadata[key] for key in one.metadata if key in _PASSED}
            how |= {"default": _usual(one), **other}
            shown = show_default and bool(how["default"])
            named = click.option(
                flag_of(one), f"{prefix}{one.name}", type=_type(one), show_default=shown, **how
            )
            command = named(command)
        return command

    return decorate


_PASSED = ("help", "metavar", "multiple", "is_flag")


def _usual(one: Field[Any]) -> Any:
    """What click takes where nothing is typed."""
    if "is_flag" in one.metadata:
        return False
    if one.default is MISSING or "multiple" in one.metadata:
        return None
    return one.metadata.get("word") if one.default is None else one.default


def _type(one: Field[Any]) -> click.ParamType[Any] | None:
    asked = one.metadata
    if "unit" in asked:
        kind = Range if "ends" in asked else WithUnit
        return kind(asked["unit"], asked.get("word", ""))
    if "choices" in asked:
        return click.Choice(asked["choices"])
    if names_files(one):
        return File()
    if "above" in asked:
        return click.FloatRange(asked["above"], min_open=True)
    if "word" in asked:
        return ArmCount()
    return click.IntRange(asked["least"]) if "least" in asked else None


def _value(one: Field[Any], given: Any) -> Any:
    return one.metadata["parse"](given) if "parse" in one.metadata else given


specimen = filled(Specimen, "specimen")
machine = filled(Machine, "machine")
hammer = filled(HammerChoices, "hammer", show_default=True)
cuts = filled(Cuts, "cuts")


def specimens(function: Callable[..., T]) -> Callable[..., T]:
    """As :func:`specimen`, of several files that may each have a temperature: ``temperatures``."""
    return of(Job, "temperatures")(filled(Specimen, "specimen", leave=("temperature",))(function))


def reading(function: Callable[..., T]) -> Callable[..., T]:
    """Give a command the reading options and ``--profile``; it receives one ``options``."""

    @click.option(
        "--profile", type=File(), metavar="FILE", help="Saved answers, TOML; options win over it."
    )
    @functools.wraps(function)
    def command(*, options: ReadOptions, profile: str | None, **given: Any) -> T:
        _refuse_unknown(options)
        return function(options=over_profile(options, profile), **given)

    return filled(ReadOptions, "options")(command)


def _refuse_unknown(options: ReadOptions) -> None:
    """Refuse a unit that was given to no role, nor to a column of any file that is read."""
    names = options.by_name().keys() - {one.name for one in fields(ReadOptions)}
    inputs = [path for path in click.get_current_context().obj.inputs if not is_json(path)]
    for path in inputs if names else ():
        with suppress(DashpotError):
            columns = dp.inspect_file(path, options=options).columns
            names -= {one.name.strip().casefold() for one in columns}
    if names and inputs:
        wrong = next(name for name in dict(options.units) if name.strip().casefold() in names)
        raise ReadError(
            f"--units: '{wrong}' is no role (time, displacement, force, hammer, acceleration, ...) "
            f"and no column of {', '.join(inputs)}; dashpot inspect lists the columns"
        )


def over_profile(options: ReadOptions, path: str | None) -> ReadOptions:
    """Return what the user said, and what the profile says wherever the user said nothing."""
    if not path:
        return options
    from dashpot.io.options import load_profile

    profile = load_profile(path)
    if profile.calibration:
        reads(profile.calibration)
    return options.over(profile)


weighed = of(Job, "mass", required=True, help="Block mass, e.g. 104g.")
carried = of(Job, "seal_mass", "seals", "compression")
wlf = click.option(
    "--wlf", type=Wlf(), help="How the seal follows temperature, e.g. 6.94,129.6K,23degC."
)


def picture(function: Callable[..., T]) -> Callable[..., T]:
    """Give a command ``--plot``; it receives the ``picture``'s file, and may open it."""
    saved = click.option(
        "--plot", "picture", type=Figure(), metavar="FILE", help="Save the figure (png, svg, pdf)."
    )
    return saved(opens(function))


_REPLACE = "Replace a file that dashpot did not write."
overwrite = click.option("--overwrite", is_flag=True, help=_REPLACE)
# where no column has the name
force = click.option("--overwrite", "--force", is_flag=True, help=_REPLACE)


def output(help: str, *suffixes: str, **how: Any) -> Callable[[Callable[..., T]], Callable[..., T]]:
    """Give a command ``-o FILE``, refused before the work if its suffix names another format."""
    kind = Output(suffixes)
    return click.option("-o", "--output", type=kind, metavar="FILE", help=help, **how)


fit_output = output("Write the fit as JSON; - is stdout.", ".json")
temperature = click.option(
    "--temperature",
    type=WithUnit("temperature"),
    help="Of the seals, where the fit knows how they follow it [default: that of its solid].",
)


def _as_typed(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def given(*nouns: str, but: Container[str] = ()) -> list[str]:
    """Return the options of these nouns, or of these fields of them, as they were typed.

    For the command that comes next; ``given()`` returns those of all nouns, without what says where
    the results go.
    """
    context = click.get_current_context()
    words = []
    for one in context.command.params:
        name = one.name or ""
        typed_here = context.get_parameter_source(name) is ParameterSource.COMMANDLINE
        wanted = not nouns or name in nouns or name.partition("_")[0] in nouns
        if not (isinstance(one, click.Option) and typed_here and wanted) or name in but:
            continue
        words += _typed(one, context.meta.get(_TYPED, {}).get(name, context.params.get(name)))
    return words


def _typed(one: click.Option, value: object) -> list[str]:
    flag = max(one.opts, key=len)
    if one.is_flag:
        return [flag]
    several = value if one.multiple and isinstance(value, tuple) else (value,)
    return [word for each in several for word in (flag, _as_typed(each))]
