"""dashpot import: a solver card back to a model."""

from __future__ import annotations

import click

from dashpot.cli import _options as options
from dashpot.cli._command import build_options, group, mark_advanced, opt, verb
from dashpot.cli._command_files import format_command
from dashpot.cli._command_result import CommandResult, format_json, write_output
from dashpot.cli._param_types import WithUnit
from dashpot.datamodel.specimen import Specimen
from dashpot.planning.plan_options import PlannedRamp

_TEST = "Test"
RELATIVE_NOISE = 0.002
"""Relative noise of a material without a stated one; its forces have no size."""


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
        opt("--unit-system", "units", metavar="SYSTEM", help="SI, mm-t-s, mm-kg-ms, in-lbf-s."),
        opt("--card", "name", metavar="NAME", help="Material or property, if there are several."),
        opt("--component", type=click.IntRange(1, 6), metavar="N", help="Component of a bush (1)."),
        opt("--modulus", type=WithUnit("stress"), metavar="STRESS",
            help="Instantaneous Young's modulus, if the card has none."),
    ),
    group(
        _TEST,
        build_options(PlannedRamp, "ramp_time", "hold_time", "depth", "noise", argument="planned"),
        opt("--relative-noise", type=float, metavar="SHARE",
            help="Noise over the peak, of a material (0.002)."),
        mark_advanced(build_options(PlannedRamp, "rate", "baseline", argument="planned")),
    ),
    options.specimen_options(is_advanced=False),
    options.result_options("Model as .json.", ".json", plot=False, has_open_option=False),
)  # fmt: skip
def command(
    *,
    card: str,
    units: str | None,
    name: str | None,
    component: int | None,
    modulus: float | None,
    planned: PlannedRamp,
    relative_noise: float | None,
    output: str | None,
    specimen: Specimen,
) -> CommandResult:
    """Read the card, judge its arms, and write the model."""
    from dataclasses import fields

    from dashpot.base.provenance import Source
    from dashpot.extensions.solver_inputs.cards.imported_model import import_card
    from dashpot.extensions.solver_inputs.cards.read_cards import (
        read_cards,
        read_stated_modulus,
        read_stated_units,
        select_card,
    )
    from dashpot.planning.planned_ramp_hold import Bench
    from dashpot.reading.raw_file import open_raw

    raw = open_raw(card)
    text = raw.head(raw.size).decode("utf-8", errors="replace")
    system = read_stated_units(text, raw.name, units)
    selected_card = select_card(read_cards(text, raw.name, system, component), name, raw.name)
    if relative_noise is None and selected_card.is_material:
        relative_noise = RELATIVE_NOISE
    terms = {field.name: getattr(planned, field.name) for field in fields(PlannedRamp)}
    result = import_card(
        selected_card, system, Source(raw.name, raw.sha256, reader=selected_card.keyword),
        test=Bench(**terms), relative_noise=relative_noise, modulus=modulus, specimen=specimen,
        stated_modulus=read_stated_modulus(text),
    )  # fmt: skip
    if output:
        write_output(output, format_json(result.fit) + "\n")
    next_command = _format_next(output, result.fit.unit) if output else ""
    return CommandResult.from_result(result, next_command=next_command)


def _format_next(model: str, unit: str) -> str:
    """Return the command that predicts the response of a mass on the model."""
    shape = () if unit == "N/m" else ("--shape", "disc:20mm,20mm")
    return format_command("predict", model, "--mass", "MASS", *shape)
