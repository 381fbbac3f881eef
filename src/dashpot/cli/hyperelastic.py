"""dashpot hyperelastic: the law of a rubber or a foam under large strain."""

from __future__ import annotations

from typing import Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.base.choices import ElasticKindAsked, words
from dashpot.cli import _options as options
from dashpot.cli._shell import File, Outcome, printed, reports, typed, write, write_figure
from dashpot.cli._terminal import Text
from dashpot.cli._text import rounded, table
from dashpot.kinds.hyperelastic.read import MODES, Measures
from dashpot.records.specimen import Specimen


def _modes(function: Any) -> Any:
    for mode, of in [*MODES.items()][::-1]:
        named = click.option(f"--{mode}", type=File(), multiple=True, metavar="FILE", help=of.says)
        function = named(function)
    return function


@click.command("hyperelastic")
@_modes
@click.option(
    "--law",
    type=click.Choice(words(ElasticKindAsked)),
    default="auto",
    show_default=True,
    help="auto takes the one that the tests prefer and that is stable in use.",
)
@click.option(
    "--terms", type=click.IntRange(1, 3), help="Of ogden and hyperfoam [default: by the tests]."
)
@click.option("--poisson", type=float, help="Of a foam, e.g. 0; it makes auto one of foam.")
@click.option(
    "--stretches",
    type=float,
    nargs=2,
    metavar="LOW HIGH",
    help="Principal stretches of use, e.g. 0.7 1.5 [default: those measured].",
)
@click.option(
    "--with", "memory", type=File(), metavar="FIT",
    help="Of a relaxation test of the material: its memory is taken off.",
)  # fmt: skip
@options.filled(Measures, "measures", show_default=True)
@options.output("Write the law as JSON, for dashpot export.", ".json")
@options.picture
@options.overwrite
@reports
@options.specimen
@options.reading
def command(
    *,
    memory: str | None,
    terms: int | None,
    output: str | None,
    picture: str | None,
    specimen: Specimen,
    **choices: Any,
) -> Outcome:
    """Fit a hyperelastic law to stress over strain in one mode of test or several.

    Each FILE has columns of stress, and of strain or stretch, with units. Every mode has the same
    say. Several files of one mode are pieces, or, with a memory, rates.

    \b
    dashpot hyperelastic --uniaxial tension.csv --biaxial bubble.csv --planar shear.csv -o law.json
    dashpot hyperelastic --compression foam.csv --poisson 0 --stretches 0.5 1 --plot law.png
    dashpot export law.json --to abaqus --units mm-t-s --temperature 23degC --bulk-modulus 2000MPa
    """
    files = {mode: choices.pop(mode) for mode in MODES}
    known = None if memory is None else workflow.read_fit(memory)
    found = workflow.hyperelastic_files(
        files, memory=known, terms=terms or "auto", specimen=specimen, **choices
    )
    if output:
        write(output, printed(found) + "\n")
    if picture:
        write_figure(picture, dp.plot.hyperelastic(found))
    follow = ""
    if output and output != "-":
        bulk = () if found.law.bulk_modulus else ("--bulk-modulus", "2000MPa")
        warm = () if found.temperature else ("--temperature", "23degC")
        follow = typed("export", output, "--to", "abaqus", "--units", "mm-t-s", *warm, *bulk)
    return Outcome(found, _said(found), found.checks, verdict=found.verdict, follow=follow)


def _said(found: dp.HyperelasticFit) -> Text:
    """The law, its constants with their intervals, each curve, and where it is stable."""
    rows = [["", "", "95 %", ""]]
    for one in found.found:
        scale, unit = (1e-6, "MPa") if one.unit == "Pa" else (1.0, "")
        low, high, value = (scale * each for each in (one.low, one.high, one.value))
        name = one.name.replace("_", " ")
        rows.append([name, rounded(value, (high - low) / 4), f"{low:.4g} to {high:.4g}", unit])
    tests = [["", "stretch", "rows", "residual, %"]]
    for curve, left in zip(found.curves, found.residuals, strict=True):
        name = curve.mode if curve.source is None else f"{curve.mode}, {curve.source.file}"
        span = f"{curve.stretch.min():.4g} to {curve.stretch.max():.4g}"
        tests.append([name, span, str(curve.rows), rounded(100 * left, digits=3)])
    least = min(score for _, score in found.orders)
    tried = ", ".join(f"{name} {score - least:.1f}" for name, score in found.orders)
    notes = [
        f"  {one.file}: {note}" for one in found.sources for note in one.notes
    ]  # fmt: skip
    lines = [
        f"  law: {found.law.kind}",
        *table(rows),
        *table(tests),
        f"  BIC above the least: {tried}",
    ]
    return Text(lines, notes)
