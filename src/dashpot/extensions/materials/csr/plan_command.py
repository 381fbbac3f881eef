"""Options and text of ``dashpot plan`` for an aging test."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import click

from dashpot.base.number_format import round_to_error
from dashpot.base.units import celsius, convert_to_unit, format_quantity
from dashpot.cli._command import CommandOption, group, mark_advanced, opt
from dashpot.cli._command_result import CommandResult
from dashpot.cli._param_types import File, WithUnit
from dashpot.datamodel.machine import Machine
from dashpot.text_output.layout import Text, format_values, table

if TYPE_CHECKING:
    from dashpot.extensions.materials.csr.aging_plan import AgingPlan


def list_groups() -> list[list[CommandOption]]:
    """Return the options of a planned aging test, under their title."""
    return [
        group(
            "Aging test",
            opt(
                "--use-at",
                type=WithUnit("temperature"),
                metavar="TEMPERATURE",
                help="Plan ovens for the life here, e.g. 70degC.",
            ),
            mark_advanced(
                opt(
                    "--aging",
                    type=File(),
                    metavar="FIT",
                    help="Fit of an aging test: its law is supposed.",
                ),
                opt(
                    "--longest",
                    type=WithUnit("time"),
                    default="1000h",
                    metavar="TIME",
                    help="Time in the ovens (1000h).",
                ),
                opt(
                    "--hottest",
                    type=WithUnit("temperature"),
                    metavar="TEMPERATURE",
                    help="Hottest oven (150degC, or that of the fit).",
                ),
                opt(
                    "--ovens", type=click.IntRange(3, 5), default=3, metavar="N", help="Ovens (3)."
                ),
                opt("--end", default="50%", type=str, metavar="END", help="F/F0 at the end (50%)."),
                opt(
                    "--scatter",
                    type=WithUnit("strain"),
                    metavar="PART",
                    help="Scatter of a reading over F0 (1%).",
                ),
                opt(
                    "--life-within",
                    "within",
                    type=float,
                    default=1.5,
                    metavar="FACTOR",
                    help="Wanted 95% interval of the life (1.5).",
                ),
            ),
        )
    ]


def plan_test(
    *,
    use_at: float,
    aging: str | None,
    longest: float,
    hottest: float | None,
    ovens: int,
    end: str,
    scatter: float | None,
    within: float,
    machine: Machine,
) -> CommandResult:
    """Plan an aging test of which the options are typed.

    Raises
    ------
    DataError
        If a number makes no sense, or the file holds no aging law.
    """
    from dashpot import workflow
    from dashpot.base.errors import DataError
    from dashpot.extensions.materials.csr.aging_plan import plan_aging
    from dashpot.extensions.materials.csr.datamodel import Aging

    law = None if aging is None else workflow.read_json_document(aging)
    if law is not None and not isinstance(law, Aging):
        raise DataError(
            f"{aging} is no fit of an aging test. Fit one: dashpot fit ovens.csv -o csr.json"
        )
    plan = plan_aging(
        use_at=use_at,
        aging=law,
        longest=longest,
        hottest=hottest,
        ovens=ovens,
        part=end,
        scatter=scatter,
        within=within,
        machine=machine,
    )
    return CommandResult.from_result(plan)


def format_plan(plan: AgingPlan) -> Text:
    """Return the ovens of a plan, the expected life and the results of other tests."""
    rows = [("oven", "specimens", "F/F0 at the end", "chemistry shows by")]
    rows += [
        (
            celsius(oven.temperature),
            str(oven.specimens),
            f"{100 * oven.retained:.0f} %",
            f"{oven.significance:.0f} SE",
        )
        for oven in plan.ovens
    ]
    hours = ", ".join(f"{convert_to_unit(time, 'h'):.4g}" for time in plan.times)
    assumption = (
        f"  supposed    a reading scatters by {100 * plan.scatter:.2g} % of F0, an oven is known "
        f"to {plan.oven_sd:.2g} K, the load cell drifts by {100 * plan.drift:.2g} % in 1000 h"
    )
    alternatives = [("another test", "specimens", "interval of the life")]
    alternatives += [
        (
            alternative.change,
            str(alternative.specimens),
            f"a factor of {_format_factor(alternative.life_sd)}",
        )
        for alternative in plan.alternatives
    ]
    duration, factor = format_quantity(plan.longest, "h", ".4g"), _format_factor(plan.life_sd)
    return Text(
        [
            *table(rows),
            f"  read after  {hours} h ({duration} in all)",
            *format_values(plan.facts),
            f"  interval    a factor of {factor}; wanted {_format_factor(plan.target_sd)}",
            assumption,
            *table(alternatives, align_left=True),
        ]
    )


def _format_factor(life_sd: float) -> str:
    """Return the factor from a life to either end of its 95 % interval."""
    from dashpot.base.reported_values import NORMAL

    return round_to_error(math.exp(NORMAL * life_sd))
