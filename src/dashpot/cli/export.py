"""dashpot export: the solid as a deck that a solver reads."""

from __future__ import annotations

import click

from dashpot.cli._shell import Outcome, Quantity, Range, reports, write

TARGETS = (
    "nastran", "abaqus", "ansys", "lsdyna", "radioss", "calculix", "opensees", "adams",
    "statespace", "csv",
)  # fmt: skip
