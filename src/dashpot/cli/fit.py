"""dashpot fit: the solid behind one or several relaxation tests."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import click

from dashpot.base.errors import FitError
from dashpot.cli._reading import reading
from dashpot.cli._shell import Arms, Outcome, printed, reports, write
from dashpot.cli._specimen import specimen

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from matplotlib.figure import Figure

    from dashpot.io.options import ReadOptions
    from dashpot.records.dynamic import DynamicTest
    from dashpot.records.fit import Fit
    from dashpot.records.relaxation import RelaxationTest
    from dashpot.records.specimen import Specimen

    Fitted = tuple[Fit, Callable[[], Figure]]


@click.command("fit", short_help="The solid behind a relaxation test, and how well it is known.")
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@click.option("--arms", type=Arms(), default="auto", show_default=True, help="Maxwell arms.")
@click.option(
    "--method",
    type=click.Choice(["full", "hold"]),
    default="full",
    show_default=True,
    help="full: the recorded motion, ramp and hold; hold: the paper's eq. 5.",
)
@click.option("--depth-law", is_flag=True, help="Several depths: shared times, k for each depth.")
@click.option("--thorough", is_flag=True, help="Add quasi-random starts.")
@click.option("--filter", "filter_", metavar="SPEC", help="E.g. lowpass:10Hz; off by default.")
@click.option("--modulus", metavar="COLUMN", help="FILE is a modulus over time, E(t): its column.")
@click.option("--plot", "picture", metavar="FILE", help="Save the figure (png, svg, pdf).")
@click.option("-o", "--output", metavar="FILE", help="Write the fit as JSON; - is stdout.")
@reports
@specimen
@reading
def command(
    *,
    files: tuple[str, ...],
    arms: int | Literal["auto"],
    method: Literal["full", "hold"],
    depth_law: bool,
    thorough: bool,
    filter_: str | None,
    modulus: str | None,
    picture: str | None,
    output: str | None,
    specimen: Specimen,
    options: ReadOptions,
) -> Outcome:
    """Fit a generalized Maxwell solid to the ramp and hold in FILE; several files fit together.

    FILE may also be a dynamic (DMA) sweep, storage and loss against frequency, or, with
    --modulus, a relaxation modulus over time.

    \b
    dashpot fit seal_8mm.csv
    dashpot fit seal_8mm.csv --arms 2 --method hold -o fit.json --plot fit.png
    dashpot fit seal_4mm.csv seal_8mm.csv --depth-law
    dashpot fit curve.csv --modulus "E(t)"
    """
    column = modulus or options.modulus
    if column is not None:
        if len(files) > 1 or depth_law or method == "hold" or filter_:
            raise FitError(
                "a relaxation modulus is fitted one at a time, without --depth-law, --method hold "
                "and --filter: it is the answer to a step already"
            )
        found, draw = _of_modulus(
            files[0], column, arms, thorough=thorough, specimen=specimen, options=options
        )
    else:
        from dashpot.io.readers.bench import read_bench

        tests = [read_bench(path, options=options, specimen=specimen) for path in files]
        found, draw = _of_tests(
            tests, arms, method=method, depth_law=depth_law, thorough=thorough, filter_=filter_
        )
    if picture:
        from dashpot import plot

        plot.save(draw(), picture)

    def content() -> dict[str, Any]:
        from dashpot.workflow.archive import document

        return document(found)

    if output:
        write(output, printed(content()) + "\n")

    from dashpot.cli import _text as _words

    return Outcome(content, "" if output == "-" else _words.fit(found), found.checks)


def _of_modulus(
    file: str,
    column: str,
    arms: int | Literal["auto"],
    *,
    thorough: bool,
    specimen: Specimen,
    options: ReadOptions,
) -> Fitted:
    from dataclasses import replace

    from dashpot.fitting.modulus import fit_modulus
    from dashpot.io.readers.modulus import read_modulus

    curve = read_modulus(file, options=replace(options, modulus=column), specimen=specimen)
    found = fit_modulus(
        curve.time,
        curve.modulus,
        arms=arms,
        thorough=thorough,
        unit=curve.unit,
        source=curve.source,
        specimen=curve.specimen,
    )
    return found, lambda: _stiffness(found)


def _of_tests(
    tests: Sequence[RelaxationTest | DynamicTest],
    arms: int | Literal["auto"],
    *,
    method: Literal["full", "hold"],
    depth_law: bool,
    thorough: bool,
    filter_: str | None,
) -> Fitted:
    from dashpot.preparation.prepare import prepare
    from dashpot.records.relaxation import RelaxationTest

    sweeps = [test for test in tests if not isinstance(test, RelaxationTest)]
    prepared = [prepare(test, filter=filter_) for test in tests if isinstance(test, RelaxationTest)]
    if sweeps:
        if len(sweeps) > 1 or depth_law or method == "hold":
            raise FitError(
                "a dynamic sweep is fitted one at a time, alone or with relaxation tests of the "
                "same part, without --depth-law and --method hold"
            )
        from dashpot.fitting.dynamic import fit_dynamic

        found = fit_dynamic(sweeps[0], arms=arms, tests=prepared, thorough=thorough)
    else:
        from dashpot.fitting.relaxation import fit

        found = fit(prepared, arms=arms, method=method, depth_law=depth_law, thorough=thorough)

    def draw() -> Figure:
        from dashpot import plot

        if not prepared:
            return _stiffness(found)
        if sweeps or len(prepared) > 1:
            return plot.fit(found, prepared[0])
        others = [fit(prepared, arms=n, method=method) for n in (1, 2)]  # the paper's Fig. 4
        return plot.fit(found, prepared[0], alternatives=others)

    return found, draw


def _stiffness(found: Fit) -> Figure:
    from dashpot import plot

    return plot.stiffness(found)
