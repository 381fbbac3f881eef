"""Options of ``dashpot fit`` on material tests; imports no NumPy, so that help is fast."""

from __future__ import annotations

from typing import Any

import click

from dashpot.cli._command import CommandOption, build_options, group, opt
from dashpot.cli._options import VIBRATION
from dashpot.cli._param_types import DENSITY, ChoiceWithSuggestion, File, Range, WithUnit
from dashpot.extensions.materials.indentation.indenter import Indenter
from dashpot.extensions.materials.options import MODES, DropOptions, Measures, RodChoices


class LowHigh(click.ParamType[Any]):
    """Two numbers, ``LOW:HIGH``."""

    name = "LOW:HIGH"

    def convert(  # noqa: D102
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> Any:
        if not isinstance(value, str):
            return value
        try:
            low, high = map(float, value.split(":"))
        except ValueError:
            self.fail(f"'{value}': expected LOW:HIGH, such as 0.7:1.5", param, ctx)
        if not 0 < low < high:
            self.fail(f"'{value}': expected 0 < LOW < HIGH, such as 0.7:1.5", param, ctx)
        return low, high


_CLD, _STRAIN, _INDENTATION, _DROP, _AGING = "cld", "stress-strain", "indentation", "drop", "csr"


def list_groups() -> list[list[CommandOption]]:
    """Return the options of these tests, group by group."""
    return [
        group(
            "Load deflection",
            opt(
                "--compression-limits",
                hidden_alias="between",
                type=Range("length"),
                metavar="RANGE",
                kinds=_CLD,
                help="Tolerance of --compression, e.g. 4:8mm.",
            ),
            opt(
                "--force-limits",
                type=Range("force"),
                metavar="RANGE",
                kinds=_CLD,
                help="Limits of the force there, e.g. 4.5:5.5N.",
            ),
            opt(
                "--relaxation",
                hidden_alias="memory",
                type=File(),
                multiple=True,
                metavar="FIT",
                kinds=f"{_CLD} {_STRAIN} {_DROP}",
                help="Fit of a relaxation test of the same material.",
            ),
        ),
        group(
            "Stress over strain",
            opt(
                "--test",
                type=ChoiceWithSuggestion(tuple(MODES)),
                multiple=True,
                metavar="MODE",
                kinds=_STRAIN,
                help="Test of each file: uniaxial, biaxial, planar, ...",
            ),
            opt(
                "--poisson",
                type=float,
                metavar="NUMBER",
                kinds=f"{_STRAIN} {VIBRATION}",
                help="Poisson's ratio of a foam; selects a law of foam.",
            ),
            opt(
                "--stretches",
                type=LowHigh(),
                metavar="LOW:HIGH",
                kinds=_STRAIN,
                help="Stretches of use, e.g. 0.7:1.5.",
            ),
            opt(
                "--terms",
                type=click.IntRange(1, 3),
                metavar="N",
                kinds=_STRAIN,
                help="Number of terms of ogden and hyperfoam.",
            ),
            build_options(Measures, argument="measures", kinds=_STRAIN),
        ),
        group(
            "Indenter",
            build_options(Indenter, argument="indenter", omit=("mass",), kinds=_INDENTATION),
        ),
        group(
            "Aging",
            opt(
                "--use-at",
                type=WithUnit("temperature"),
                metavar="TEMPERATURE",
                kinds=_AGING,
                help="Temperature of use, e.g. 40degC: the life there.",
            ),
        ),
        group("Drop test", build_options(DropOptions, kinds=_DROP)),
        group(
            "Rod",
            build_options(RodChoices, argument="rod", kinds=VIBRATION),
            opt(
                "--density",
                type=DENSITY,
                metavar="KG/M^3",
                kinds=VIBRATION,
                help="Density of the rod.",
            ),
        ),
    ]
