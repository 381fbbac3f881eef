"""Lot row of an indentation test."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dashpot.extensions.materials.indentation.datamodel import IndentationFit
from dashpot.extensions.materials.indentation.fit import fit_indentation
from dashpot.extensions.materials.indentation.indenter import Indenter
from dashpot.extensions.materials.indentation.read import read_indentation
from dashpot.registry import LotSpecimen
from dashpot.workflow.job import require_test_for_machine


def build_lot_row(
    file: str | Path, lot_specimen: LotSpecimen
) -> tuple[IndentationFit, dict[str, Any]]:
    """Return the contact law of a hit, and its columns of a lot row.

    Raises
    ------
    ReadError, DataError, FitError
        If it cannot be read, or no law follows it.
    """
    require_test_for_machine(lot_specimen.machine, tests=0, add="a ramp and hold")
    ball = Indenter(mass=lot_specimen.mass, radius=lot_specimen.radius)
    test = read_indentation(file, indenter=ball, options=lot_specimen.options)
    fit = fit_indentation(test)
    entries: dict[str, Any] = {
        "samples": len(test.time),
        "method": fit.law,
        "contact_s": fit.duration,
        "indent_depth_m": fit["depth"].value,
        "restitution": fit["restitution"].value,
    }
    if ball.radius is not None:
        modulus = fit["modulus"]
        columns = {"": modulus.value, "_low": modulus.low, "_high": modulus.high}
        entries |= {f"indent_modulus{end}_Pa": value for end, value in columns.items()}
    return fit, entries
