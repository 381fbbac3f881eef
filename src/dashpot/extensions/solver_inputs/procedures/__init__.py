"""Under which procedures of a solver a deck was run, and how far its answer was off."""

from __future__ import annotations

import csv
from functools import cache
from importlib.resources import files
from typing import NamedTuple

MAX_RELATIVE_DIFFERENCE = 1e-3
"""Largest difference to the model, over the peak, of an answer that is called right."""
READ_ONLY = "only read"


class Run(NamedTuple):
    """One procedure of a solver that a test runs.

    Attributes
    ----------
    target, form, solver : str
        The deck, and the program that took it, with its version.
    procedure : str
        Step and integrator.
    case : str
        Procedure applied to the seal.
    deviation : float
        Largest difference to the model over the peak.
    """

    target: str
    form: str
    solver: str
    procedure: str
    case: str
    deviation: float

    @property
    def is_right(self) -> bool:
        """Whether the solver's result agrees with the model."""
        return self.deviation <= MAX_RELATIVE_DIFFERENCE


@cache
def read_runs() -> tuple[Run, ...]:
    """Return all that was run: ``python tests/kit/procedures.py`` writes it."""
    table = files(__name__).joinpath("runs.csv").read_text(encoding="utf-8")
    return tuple(
        Run(**row | {"deviation": float(row["deviation"])})  # type: ignore[arg-type]
        for row in csv.DictReader(table.splitlines())
    )


_MEASURED = "the largest difference to the model, over the peak:"
WITH_DASHPOT = "with b"
"""Suffix of a case of solids with a parallel dashpot."""


def format_procedures(target: str, form: str, *, with_dashpot: bool = False) -> list[str]:
    """Return the solver procedures in which a deck was verified right or wrong.

    Cases of a parallel dashpot stand in the place of the others where there is one.
    """
    matching_runs = [run for run in read_runs() if (run.target, run.form) == (target, form)]
    damped_runs = [run for run in matching_runs if run.case.endswith(WITH_DASHPOT)]
    runs = (
        damped_runs
        if with_dashpot and damped_runs
        else [run for run in matching_runs if run not in damped_runs]
    )
    if not runs:
        return [f"not solver-verified: only read. No solver here runs the form {form}"]
    solvers = " and ".join(dict.fromkeys(run.solver for run in runs))
    lines = [f"verified: {solvers} runs such a deck in dashpot's tests; {_MEASURED}"]
    for word in ("right", "WRONG"):
        variants_by_procedure: dict[str, list[str]] = {}
        for run in runs:
            if run.is_right == (word == "right"):
                case = run.case.partition(",")[0]
                variants_by_procedure.setdefault(run.procedure, []).append(
                    f"{run.deviation:.1e} {case}"
                )
        procedure_text = "; ".join(
            f"{procedure}: {', '.join(variants)}"
            for procedure, variants in variants_by_procedure.items()
        )
        lines += [f"  {word} under {procedure_text}"] * bool(variants_by_procedure)
    return lines
