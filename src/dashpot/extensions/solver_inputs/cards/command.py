"""dashpot import: a solver card back to a model."""

from __future__ import annotations

import click

from dashpot.base.errors import DataError, ExportError
from dashpot.base.units import parse_quantity
from dashpot.cli import _options as options
from dashpot.cli._command import build_options, group, mark_advanced, opt, verb
from dashpot.cli._command_io import CommandResult, format_command, format_json, write
from dashpot.cli._param_types import WithUnit
from dashpot.datamodel.specimen import Specimen
from dashpot.planning.plan_options import PlannedRamp

_TEST = "Test"


@verb(
    "import",
    """Read a viscoelastic card of a solver back to a model.

It says which arms a ramp and hold test could have determined. The model
goes to predict, compare, report and export as a fit does.

  dashpot import seal.inp --unit-system mm-t-s -o model.json
  dashpot import bush.bdf --unit-system mm-t-s --ramp 1s --hold 40s -o bush.json""",
    click.Argument(["card"], type=click.Path(), metavar="FILE"),
    group(
        "Card",
        opt("--unit-system", "units", metavar="SYSTEM", help="SI, mm-t-s or mm-kg-ms."),
        opt("--card", "name", metavar="NAME", help="Material or property, if there are several."),
        opt("--component", type=click.IntRange(1, 6), metavar="N", help="Component of a bush (1)."),
        opt("--modulus", type=WithUnit("stress"), metavar="STRESS",
            help="Instantaneous Young's modulus, if the card has none."),
    ),
    group(
        _TEST,
        build_options(PlannedRamp, "ramp_time", "hold_time", "depth", into="planned"),
        opt("--noise", default="0.2%", metavar="FORCE|PERCENT",
            help="Standard deviation of a sample, or its share of the peak (0.2%)."),
        mark_advanced(build_options(PlannedRamp, "rate", "baseline", into="planned")),
    ),
    options.piece(more=False),
    options.result("Model as .json.", ".json", plot=False, opens=False),
)  # fmt: skip
def command(
    *,
    card: str,
    units: str | None,
    name: str | None,
    component: int | None,
    modulus: float | None,
    planned: PlannedRamp,
    noise: str,
    output: str | None,
    specimen: Specimen,
) -> CommandResult:
    """Read the card, judge its arms, and write the model."""
    from dataclasses import fields

    from dashpot.base.provenance import Source
    from dashpot.export.unit_systems import UNIT_SYSTEMS, unit_system
    from dashpot.extensions.solver_inputs.cards.imported_model import import_card
    from dashpot.extensions.solver_inputs.cards.read_cards import read_cards, select_card
    from dashpot.planning.planned_ramp_hold import Bench
    from dashpot.reading.raw_file import open_raw

    if units is None:
        raise ExportError(
            f"a card names no units; add --unit-system, one of {', '.join(UNIT_SYSTEMS)}"
        )
    system = unit_system(units)
    raw = open_raw(card)
    text = raw.head(raw.size).decode("utf-8", errors="replace")
    chosen = select_card(read_cards(text, raw.name, system, component), name, raw.name)
    relative, force = _parse_noise(noise)
    terms = {field.name: getattr(planned, field.name) for field in fields(PlannedRamp)}
    if force is not None:
        if chosen.is_material:
            raise click.UsageError(
                f"--noise {noise} is a force, and the card is of a material. Give a percentage of "
                "the largest force, such as --noise 0.2%"
            )
        terms["noise"] = force
    result = import_card(
        chosen, system, Source(raw.name, raw.sha256, reader=chosen.keyword),
        test=Bench(**terms), relative_noise=relative, modulus=modulus, specimen=specimen,
    )  # fmt: skip
    if output:
        write(output, format_json(result.fit) + "\n")
    shape = () if result.fit.unit == "N/m" else ("--shape", "disc:20mm,20mm")
    follow = format_command("predict", output, "--mass", "MASS", *shape) if output else ""
    return CommandResult.from_result(result, follow=follow)


def _parse_noise(text: str) -> tuple[float | None, float | None]:
    """Return the noise in parts of the largest force, or as a force, N."""
    if text.strip().endswith("%"):
        try:
            share = float(text.strip().removesuffix("%")) / 100
        except ValueError:
            share = 0.0
        if not share > 0:
            raise DataError(f"--noise {text}: expected a percentage > 0, such as 0.2%")
        return share, None
    return None, parse_quantity(text, "force")
