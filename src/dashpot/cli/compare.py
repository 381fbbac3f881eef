"""dashpot compare: predicted against measured."""

from __future__ import annotations

from typing import Any

import click

import dashpot as dp
from dashpot import workflow
from dashpot.cli import _options as options
from dashpot.cli._shell import Outcome, failed, read_fit, reports, write_figure


@click.command("compare")
@click.argument("fit")
@click.argument("measured", nargs=-1, required=True, metavar="IMPACT|FRF...")
@options.mass_if_known
@options.seal_mass
@options.seals
@options.compression
@options.compared
@options.picture
@options.overwrite
@reports
@options.hammer
@options.reading
def command(
    *, fit: str, measured: tuple[str, ...], seals: float, picture: str | None, **choices: Any
) -> Outcome:
    """Hold the prediction of FIT against the hits or the FRF in IMPACT|FRF.

    \b
    dashpot compare fit.json hammer.csv --mass 104g --seals 2
    dashpot compare fit.json frf.uff --mass 104g --seals 2 --json
    """
    found = workflow.compare_files(read_fit(fit), measured, seals=seals, **choices)
    if picture:
        write_figure(picture, dp.plot.comparison(found.comparison))
    lines = [str(found.comparison), *([str(found.at_rest)] if str(found.at_rest) else [])]
    if found.mass_inferred:
        lines.append(
            f"  mass        {found.mass * 1e3:.5g} g, inferred from the measured FRF: the "
            "agreement in frequency then proves nothing; give --mass to test it"
        )
    return Outcome(
        found.comparison,
        "\n".join(lines + failed(found.noted)),
        (*found.comparison.checks, *found.noted),
        {
            "mass": found.mass,
            "mass_inferred": found.mass_inferred,
            "seals": seals,
            **found.at_rest.document,
        },
    )
