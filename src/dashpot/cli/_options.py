"""Options that several verbs share, in the groups in which the help shows them."""

from __future__ import annotations

from collections.abc import Container, Sequence
from contextlib import suppress
from dataclasses import fields, replace
from pathlib import Path

import click

import dashpot as dp
from dashpot.base.errors import DashpotError, ReadError
from dashpot.cli._grammar import Opt, Verb, group, of, opt, rest
from dashpot.cli._shell import File, Output, is_json, reads
from dashpot.cli._values import Figure, Scoped, Units, Wlf
from dashpot.io.options import ReadOptions
from dashpot.records.machine import Machine
from dashpot.records.specimen import Specimen
from dashpot.workflow.job import Cuts, HammerChoices, Job

MODEL, MASS, READING, RESULT = "Model", "Mass on seals", "Reading the files", "Result"
RAMP, WARM, HITS = "Ramp and hold", "Several temperatures", "Hammer hits"
PIECE = "Specimen"

VIBRATION = "impact frf transmissibility"
"""Kinds that are of a mass on its seals."""
SOLIDS = "relaxation dma master-curve modulus creep fit"
"""Kinds that are of a solid: tests of it, and its fit."""

_OTHER_LABELS = ("length", "height", "temperature")
_LABELS = tuple(one.name for one in fields(Specimen) if one.metadata.get("under") == "label")


def files(
    metavar: str, name: str = "files", *, several: bool = True, least: int = 1
) -> click.Argument:
    """Return the argument that names what a verb reads."""
    nargs = -1 if several else 1
    return click.Argument([name], type=File(), nargs=nargs, required=least > 0, metavar=metavar)


def reading(*, short: Sequence[str] = ("--column", "--units", "--profile")) -> list[Opt]:
    """Return the options that say what a file leaves open; `short` stand in the short help."""
    own = fields(ReadOptions)
    columns = [one.name for one in own if one.metadata.get("under") == "column"]
    text = [one.name for one in own if one.metadata.get("under") == "text"]
    part = [one.name for one in own if one.metadata.get("under") == "part"]
    into = {"into": "options"}
    found = [
        *of(ReadOptions, *columns, **into),
        *of(ReadOptions, "units", type=Units(), help="Unit of a role or column: force=N.", **into),
        opt("--profile", type=Scoped(File()), multiple=True, metavar="FILE",
            help="Answers saved by 'inspect --save'."),
        *of(ReadOptions, *text, **into),
        *of(ReadOptions, *part, **into),
        *of(ReadOptions, "rate", type=Scoped(_rate()), multiple=True, metavar="FREQUENCY", **into),
        *of(ReadOptions, "calibration", "axis", **into),
        *of(ReadOptions, "kind", type=Scoped(click.STRING), multiple=True, metavar="KIND",
            help="What a file is, if taken for another: FILE:KIND.", **into),
    ]  # fmt: skip
    for one in found:
        one.more = one.flag not in short
    return group(READING, found)


def _rate() -> click.ParamType[object]:
    from dashpot.cli._values import WithUnit

    return WithUnit("frequency")


def result(
    says: str = "",
    *suffixes: str,
    plot: bool = True,
    judged: bool = True,
    title: str = RESULT,
    default: str | None = None,
    required: bool = False,
    opens: bool = True,
) -> list[Opt]:
    """Return the options that say where a result goes and how it is told."""
    found: list[Opt] = []
    if says:
        found.append(Opt("-o", "--output", type=Output(suffixes), metavar="FILE", help=says,
                         default=default, required=required))  # fmt: skip
    if plot:
        found.append(opt("--plot", "picture", type=Figure(), metavar="FILE",
                         help="Draw the result: .png, .svg or .pdf."))  # fmt: skip
    if opens:
        found.append(opt("--open", "opens", help="Open the page or picture written."))
    found.append(opt("--overwrite", help="Replace a file that dashpot did not write."))
    if judged:
        found += [
            opt("--json", "as_json", help="Print one JSON document in SI units."),
            opt("--strict", help="Exit with 1 if a check limits the use."),
            opt("-v", "--verbose", help="Print everything."),
        ]
    return group(title, found)


def under_mass(*, kinds: str = "", known: str = "", required: bool = False) -> list[Opt]:
    """Return the options of a mass on its seals; `known` says what goes without it."""
    says = f"Mass of the block, e.g. 104g.{known}"
    return [
        *of(Job, "mass", kinds=kinds, help=says, required=required),
        *of(Job, "seals", kinds=kinds, metavar="N"),
        *rest(of(Job, "seal_mass", kinds=kinds), of(Job, "compression", kinds=kinds)),
    ]


def hammer(*, kinds: str = "", leave: Sequence[str] = ()) -> list[Opt]:
    """Return the options of hits, and of a mass over a base that moves."""
    hits = of(HammerChoices, into="hammer", leave=("motion", *leave), kinds=kinds)
    return rest(group(HITS, hits))


def relative(kinds: str = "") -> list[Opt]:
    """Return the option of a motion that was measured against the base."""
    return rest(of(HammerChoices, "motion", into="hammer", kinds=kinds))


def machine(kinds: str = "") -> list[Opt]:
    """Return the option of what is known of the testing machine."""
    return of(Machine, into="machine", kinds=kinds)


def cuts(kinds: str = "") -> list[Opt]:
    """Return the option of cuts that are made by hand."""
    return of(Cuts, into="cuts", kinds=kinds)


def piece(*, each: bool = False, more: bool = True) -> list[Opt]:
    """Return the options of the specimen; a temperature for `each` file where there are several."""
    found = [
        *(of(Job, "temperatures") if each else of(Specimen, "temperature", into="specimen")),
        *of(Specimen, "length", "height", into="specimen"),
        *of(Specimen, *_LABELS, into="specimen"),
    ]
    for one in found:
        one.more = more
    return group(PIECE, found)


def wlf() -> Opt:
    """Return the option of how a seal follows temperature."""
    says = "How the seal follows temperature: 6.94,129.6K,23degC."
    return opt("--wlf", type=Wlf(), metavar="C1,C2,T", help=says)


def over_profiles(
    ctx: click.Context, said: ReadOptions, profiles: Sequence[tuple[str, str]]
) -> ReadOptions:
    """Return what the user said, and what profiles say wherever the user said nothing.

    Raises
    ------
    click.UsageError
        If a pattern matches no file that was given.
    ReadError
        If a unit is given to no role and to no column.
    """
    from dashpot.io.options import load_profile

    known = ReadOptions()
    for glob, path in profiles:
        profile = load_profile(path)
        reads(ctx, path)
        known = (
            profile.over(known) if not glob else replace(known, own=(*known.own, (glob, profile)))
        )
    said = said.over(known)
    for one in (said, *(each for _, each in said.own)):
        if one.calibration:
            reads(ctx, one.calibration)
    _refuse_strange_patterns(ctx, said)
    _refuse_unknown_units(ctx, said)
    return said


def _records(ctx: click.Context) -> list[str]:
    """The files that stand as arguments of a command."""
    named = [one.name for one in ctx.command.params if isinstance(one, click.Argument)]
    several = (ctx.params.get(name or "") for name in named)
    flat = [word for one in several for word in (one if isinstance(one, tuple) else (one,))]
    return [word for word in flat if isinstance(word, str)]


def _refuse_strange_patterns(ctx: click.Context, said: ReadOptions) -> None:
    paths = [Path(one) for one in _records(ctx)]
    if any(path.is_dir() for path in paths) or any("*" in str(path) for path in paths):
        return
    for glob, _ in said.own:
        if not any(path.match(glob) for path in paths):
            listed = ", ".join(path.name for path in paths)
            raise click.UsageError(f"'{glob}:' matches none of the files {listed}.")


def _refuse_unknown_units(ctx: click.Context, said: ReadOptions) -> None:
    """Refuse a unit that was given to no role, nor to a column of any file that is read."""
    roles = {one.name for one in fields(ReadOptions)}
    names = said.by_name().keys() - roles
    inputs = [path for path in ctx.obj.inputs if not is_json(path)] if names else []
    for path in inputs:
        with suppress(DashpotError):
            columns = dp.inspect_file(path, options=said).columns
            names -= {one.name.strip().casefold() for one in columns}
    if names and inputs:
        wrong = next(name for name in dict(said.units) if name.strip().casefold() in names)
        raise ReadError(
            f"--units: '{wrong}' is no role (time, displacement, force, hammer, acceleration, ...) "
            f"and no column of {', '.join(inputs)}. To see the columns: dashpot inspect {inputs[0]}"
        )


def given(*titles: str, but: Container[str] = ()) -> list[str]:
    """Return the options that were typed, of these groups of the help or of all, as typed.

    For the command that comes next; without what says where results go.
    """
    context = click.get_current_context()
    assert isinstance(context.command, Verb)  # noqa: S101
    return [
        word
        for one in context.command.options
        if (not titles or one.group in titles) and one.name not in but and one.group != RESULT
        for word in one.typed(context)
    ]
