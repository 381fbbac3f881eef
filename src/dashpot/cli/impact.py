"""dashpot impact: hammer hits to an FRF one can trust."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from dashpot.cli._hammer import hammer
from dashpot.cli._reading import reading
from dashpot.cli._shell import Outcome, Quantity, Range, finite, reports, said, write

if TYPE_CHECKING:
    from dashpot.io.options import ReadOptions
    from dashpot.records.frf import FRF, Mode
    from dashpot.workflow.job import HammerChoices


@click.command("impact", short_help="Hammer hits to an FRF, natural frequency and damping.")
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@click.option("--mass", type=Quantity("mass"), help="Block mass: checks the mass line.")
@click.option("--band", type=Range("frequency"), help="Where to look for modes, e.g. 5:40Hz.")
@click.option("--plot", "picture", metavar="FILE", help="Save the figure (png, svg, pdf).")
@click.option("-o", "--output", metavar="FILE", help="Write the FRF: .csv, .uff, or - for stdout.")
@reports
@hammer
@reading
def command(
    *,
    files: tuple[str, ...],
    mass: float | None,
    band: tuple[float, float] | None,
    picture: str | None,
    output: str | None,
    hammer: HammerChoices,
    options: ReadOptions,
) -> Outcome:
    """Cut the records in FILE into hits, judge each, and average them into an FRF.

    \b
    dashpot impact hammer.csv
    dashpot impact hit1.csv hit2.csv hit3.csv --estimator Hv --combine weighted -o frf.uff
    dashpot impact hammer.csv --reject 3 --window exponential --mass 104g
    """
    from dashpot.base.errors import DataError
    from dashpot.cli import _text as _words
    from dashpot.io.read import read_impact
    from dashpot.workflow.job import average

    impact = read_impact(list(files), options=options)
    frf = average(impact, choices=hammer, mass=mass)
    try:
        modes = frf.modes(band=band)
    except DataError as error:
        modes = ()
        said(f"no mode: {error}")
    if output:
        write_frf_file(frf, output)
    if picture:
        from dashpot import plot

        plot.save(plot.frf(frf), picture)
    text = "" if output == "-" else _words.impact(frf, modes, estimator=hammer.estimator)
    return Outcome(
        lambda: impact_document(frf, modes, hammer=hammer, file=output), text, frf.checks
    )


def write_frf_file(frf: FRF, path: str) -> None:
    """Write an FRF as CSV, or as UFF 58 where the file's name ends in .uff or .unv."""
    from dashpot.io.writers.text import write_frf
    from dashpot.io.writers.uff import write_frf_uff

    if path.lower().endswith((".uff", ".unv")):
        write_frf_uff(frf, path)
        said(f"wrote {path}")
    else:
        write(path, write_frf(frf))


def impact_document(
    frf: FRF, modes: tuple[Mode, ...], *, hammer: HammerChoices, file: str | None
) -> dict[str, Any]:
    """Return the contract's document of an impact test."""
    import numpy as np

    from dashpot.workflow.archive import document

    height = np.abs(frf.value)
    top = int(height.argmax())
    whole = document(frf)
    return {
        "schema": "dashpot/impact@1",
        "estimator": hammer.estimator,
        "window": hammer.window,
        "averages": frf.averages,
        "modes": [
            {
                "frequency_hz": mode.frequency,
                "damping_ratio": mode.damping_ratio,
                "frequency_se_hz": finite(mode.frequency_se),
                "damping_ratio_se": finite(mode.damping_ratio_se),
                "method": mode.method,
            }
            for mode in modes
        ],
        "peak": {"frequency_hz": float(frf.frequency[top]), "value": float(height[top])},
        "hits": whole["hits"],
        "checks": whole["checks"],
        "source": whole["source"],
        "file": file,
        "frf": whole,
    }
