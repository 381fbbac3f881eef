"""Write the page of all checks from the register: ``python docs/checks.py``."""

from __future__ import annotations

from importlib import import_module
from itertools import groupby
from pathlib import Path

import dashpot
from dashpot.base.checks import REGISTER, Criterion
from dashpot.base.errors import Status

PAGE = Path(__file__).with_suffix(".md")
HEAD = """\
# Checks

A check compares one value of a record, a fit or a comparison with a limit. Its message says what
was found, what it means, and what to do. This page lists every check with its limit and the source
of the limit. *Our choice* marks a limit that no standard sets. Some limits depend on the record.
`python docs/checks.py` writes this page from the checks in the source.

A check *passed*, *failed*, or is *not applicable*, because the record does not contain what it
needs. In JSON this is `"passed": true`, `false` or `null`. A failure has one of three grades:

| grade | what a failure means |
|---|---|
| `note` | the result is not affected; its intervals include the effect |
| `limit` | use the result with care, within what the message says |
| `stop` | do not use the result |

The worst failure decides the verdict of a result: *do not use* after a `stop`, else *use with care*
after a `limit`, else *use*. The verdict is the first line of every result. With `--strict` the
command ends with exit code 1 after a `limit` or a `stop`. Some checks grade a failure by its size,
as the column *grade of a failure* says.

The status of the optimiser is separate, and printed below the verdict. It is the worst status that
a failed check sets, or that the optimum itself shows. The worst comes first:

| status | meaning | set by |
|---|---|---|
"""
TITLES = {
    "datamodel": "Numbers as read",
    "export": "Solver input",
    "extensions/amplitude": "Several amplitudes",
    "extensions/batch": "Batches and lots",
    "extensions/blank_tests": "Blank tests of the machine",
    "extensions/curves": "Curves: DMA, modulus, creep",
    "extensions/curves/creep": "Creep",
    "extensions/curves/superposition": "Master curves",
    "extensions/curves/temperatures": "Relaxation tests at several temperatures",
    "extensions/systems/door": "Doors",
    "extensions/materials/cld": "Compression load deflection",
    "extensions/materials/csr": "Compression stress relaxation and aging",
    "extensions/materials/hyperelastic": "Hyperelastic laws",
    "extensions/materials/indentation": "Rebound indentation",
    "extensions/materials/rod": "Rods",
    "extensions/materials/drop": "Drop tests",
    "extensions/modes": "Modes of several points and masses",
    "extensions/projects": "Projects",
    "extensions/dynamic_stiffness": "Stiffness at requested frequencies",
    "extensions/preload_map": "Preload maps",
    "extensions/transfer_stiffness": "Transfer stiffness of mounts",
    "extensions/solver_inputs/cards": "Imported cards",
    "extensions/solver_inputs/draws": "Solver inputs drawn from the uncertainty",
    "fitting": "Fit of a relaxation test",
    "fitting/fractional_model": "Fractional models",
    "fitting/identification": "Fit of an FRF, alone or with a relaxation test",
    "fitting/nonlinear_ramp": "Fit of the ramp",
    "planning": "Plans",
    "preprocessing": "Preparation of a relaxation record",
    "reading/readers": "Plausible sizes",
    "vibration": "Mass on seals",
    "vibration/comparison": "Comparison of prediction and measurement",
    "vibration/impact": "Hammer tests and FRFs",
    "workflow": "Prediction and report",
}
"""Heading of each package of checks."""
OTHER_CAUSES = {
    Status.NO_DATA: "a record that is not finite",
    Status.FEWER_ARMS: "fewer arms than were asked for",
    Status.TAU_AT_BOUND: "an optimum at a bound",
    Status.CONVERGED: "none of these",
}
"""What sets a status besides checks."""
WORDS = {
    "<=": "at most", "<": "below", ">=": "at least", ">": "above", "==": "equal to",
    "|x| <=": "within ±", "x/": "within a factor",
}  # fmt: skip


def page() -> str:
    """Return the page: a table of checks for each package."""
    sources = Path(dashpot.__file__).parent
    for file in sorted(sources.rglob("*.py")):
        module = file.relative_to(sources).with_suffix("").parts
        if any(name.endswith("checks") for name in module):
            import_module(".".join(("dashpot", *module)))
    parts = [HEAD, *map(_format_ending, reversed(Status))]
    for stage, ours in groupby(sorted(REGISTER.values(), key=_file), key=_stage):
        parts.append(
            f"\n## {TITLES.get(stage, stage)}\n\n| check | passes if this is true | value | "
            "limit | grade of a failure | source of the limit |\n"
        )
        parts.append("|---|---|---|---|---|---|\n")
        parts += [_row(asked) for asked in ours]
    return "".join(parts)


def _file(asked: Criterion[...]) -> tuple[str, str]:
    return asked.stage, asked.evaluate.__module__


def _stage(asked: Criterion[...]) -> str:
    return asked.stage


def _grade(asked: Criterion[...]) -> str:
    return ", or ".join(filter(None, (asked.grade, asked.other_grade)))


def _format_ending(status: Status) -> str:
    names = dict.fromkeys(
        f"`{one.name}`" for _, one in sorted(REGISTER.items()) if one.fit_status is status
    )
    ways = [*names, *([OTHER_CAUSES[status]] if status in OTHER_CAUSES else [])]
    return f"| `{status.name.lower()}` | {status.value} | {', '.join(ways)} |\n"


def _row(asked: Criterion[...]) -> str:
    limit = "set by the record" if asked.limit is None else f"{asked.limit:g}"
    passes = f"{WORDS[asked.rule]} {limit}" if asked.rule else ""
    cells = (f"`{asked.name}`", asked.question, asked.measure, passes, _grade(asked), asked.source)
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
