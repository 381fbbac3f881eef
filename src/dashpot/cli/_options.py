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
from dashpot.base.errors import DashpotError, ReadError
from dashpot.base.options import flag_of
from dashpot.base.units import Dimension, parse_quantity, parse_range
from dashpot.cli._shell import File, Output, is_json, opens, reads
from dashpot.io.options import ReadOptions
from dashpot.records.machine import Machine
from dashpot.records.specimen import Specimen

T = TypeVar("T")

_TYPED = "dashpot.typed"
"""Where quantities are kept as they were typed."""


class WithUnit(click.ParamType[Any]):
    """A number with its unit, such as ``104g``; the value passed on is in SI."""

    _parsed: Callable[[str, Dimension], Any] = staticmethod(parse_quantity)

    def __init__(self, dimension: Dimension) -> None:
        self.dimension: Dimension = dimension
        self.name = dimension

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if not isinstance(value, str):
            return value
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


class LengthOrWeight(WithUnit):
    """A length, or ``weight`` for the compression of the mass's own weight; passed on as None."""

    def __init__(self) -> None:
        super().__init__("length")
        self.name = "weight|length"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        return None if value == "weight" else super().convert(value, param, ctx)


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


PICTURES = (".pdf", ".png", ".svg")  # written out, so that --help need not import matplotlib


class Figure(Output):
    """A figure's file, refused before the work if its suffix is none that is drawn."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        if Path(value).suffix.lower() not in PICTURES:
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
    asked = [one for one in fields(noun) if one.metadata and one.name not in leave]

    def decorate(function: Callable[..., T]) -> Callable[..., T]:
        @functools.wraps(function)
        def command(**given: Any) -> T:
            own = {one.name: _value(one, given.pop(f"{receives}_{one.name}")) for one in asked}
            return function(**{receives: noun(**own)}, **given)

        for one in reversed(asked):
            how = {key: one.metadata[key] for key in one.metadata if key in _PASSED}
            named = click.option(
                flag_of(one),
                f"{receives}_{one.name}",  # nouns may share the name of a field
                type=_type(one),
                default=None if one.default is MISSING or "multiple" in how else one.default,
                show_default=show_default,
                **how,
            )
            command = named(command)
        return command

    return decorate


_PASSED = ("help", "metavar", "multiple", "is_flag")


def _type(one: Field[Any]) -> click.ParamType[Any] | None:
    asked = one.metadata
    if "unit" in asked:
        return WithUnit(asked["unit"])
    if "choices" in asked:
        return click.Choice(asked["choices"])
    if asked.get("metavar") == "FILE":
        return File()
    if "above" in asked:
        return click.FloatRange(asked["above"], min_open=True)
    return click.IntRange(asked["least"]) if "least" in asked else None


def _value(one: Field[Any], given: Any) -> Any:
    return one.metadata["parse"](given) if "parse" in one.metadata else given


def specimen(function: Callable[..., T]) -> Callable[..., T]:
    """Give a command the options that describe the specimen; it receives one ``specimen``."""
    return filled(Specimen, "specimen")(function)


def specimens(function: Callable[..., T]) -> Callable[..., T]:
    """As :func:`specimen`, of several files that may each have a temperature: ``temperatures``."""
    named = click.option(
        "--temperature",
        "temperatures",
        type=WithUnit("temperature"),
        multiple=True,
        help="Test temperature, e.g. 23degC; once for all files, or for each, in their order.",
    )
    return named(filled(Specimen, "specimen", leave=("temperature",))(function))


def machine(function: Callable[..., T]) -> Callable[..., T]:
    """Give a command the options that describe the testing machine, one ``machine``."""
    return filled(Machine, "machine")(function)


def shifting(function: Callable[..., T]) -> Callable[..., T]:
    """Give a command the options of tests at several temperatures; it receives one ``shifting``."""
    from dashpot.workflow.shifting import ShiftChoices

    return filled(ShiftChoices, "shifting")(function)


def hammer(function: Callable[..., T]) -> Callable[..., T]:
    """Give a command the options of an impact test; it receives one ``hammer``."""
    from dashpot.workflow.job import HammerChoices

    return filled(HammerChoices, "hammer", show_default=True)(function)


def cuts(function: Callable[..., T]) -> Callable[..., T]:
    """Give a command the options that cut one relaxation test by hand; it receives ``cuts``."""
    from dashpot.workflow.job import Cuts

    return filled(Cuts, "cuts")(function)


def part(function: Callable[..., T]) -> Callable[..., T]:
    """Give a command the options of a part's geometry; it receives one ``part``."""
    from dashpot.workflow.part import PartChoices

    return filled(PartChoices, "part")(function)


def at_level(function: Callable[..., T]) -> Callable[..., T]:
    """Give a command the options of a level and its sweep; it receives one ``at_level``."""
    from dashpot.workflow.at_level import LevelChoices

    return filled(LevelChoices, "at_level")(function)


method = click.option(
    "--method",
    type=click.Choice(["full", "hold"]),
    default="full",
    show_default=True,
    help="full: the recorded motion, ramp and hold; hold: the paper's eq. 5.",
)
law = click.option(
    "--law",
    type=click.Choice(["auto", "linear", "nonlinear"]),
    default="auto",
    show_default=True,
    help="Elastic law of the seal, from the ramp: straight unless the record says otherwise.",
)
family = click.option(
    "--family",
    type=click.Choice(["auto", "maxwell", "fractional"]),
    default="maxwell",
    show_default=True,
    help="Of the solid: arms, a fractional Zener solid, or the one that the record prefers.",
)


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


arms = click.option(
    "--arms", type=ArmCount(), default="auto", show_default=True, help="Maxwell arms."
)
mass = click.option("--mass", type=WithUnit("mass"), required=True, help="Block mass, e.g. 104g.")
mass_if_known = click.option(
    "--mass", type=WithUnit("mass"), help="Block mass; inferred, and said so, if missing."
)
seal_mass = click.option(
    "--seal-mass",
    type=WithUnit("mass"),
    help="Of one seal: a third moves along, a sixth couples mass and base.",
)
seals = click.option(
    "--seals", type=float, default=1.0, show_default=True, help="Seals in parallel."
)
compression = click.option(
    "--compression",
    type=LengthOrWeight(),
    default="weight",
    show_default=True,
    help="Of the seals under the mass, e.g. 2.6mm.",
)
compared = click.option("--band", type=Range("frequency"), help="Lines compared, e.g. 5:40Hz.")
wlf = click.option(
    "--wlf", type=Wlf(), help="How the seal follows temperature, e.g. 6.94,129.6K,23degC."
)
filtered = click.option("--filter", metavar="SPEC", help="E.g. lowpass:10Hz; off by default.")


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


impact_temperature = click.option(
    "--impact-temperature",
    type=WithUnit("temperature"),
    help="Of the seals under the hammer, where tests at several temperatures say how they move.",
)
