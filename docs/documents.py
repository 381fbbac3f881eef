"""Writes the page of former names and schemas, keys from the code: ``python docs/documents.py``."""

from __future__ import annotations

from pathlib import Path

from dashpot.extensions.projects.document_versions import (
    EVERYWHERE,
    FORMER_PROJECT,
    RENAMED_CHECKS,
    RENAMED_KEYS,
    name_present_schema,
)
from dashpot.extensions.projects.revised_numbers import REVISED_NUMBERS

PAGE = Path(__file__).with_suffix(".md")
FORMER_NAMES = {
    "`--as`": "`--kind`",
    "`--text`": "`--text-format`",
    "`--part`": "`--file-part`",
    "`--known`": "`--prior`",
    "`--only`": "`--at-temperature`",
    "`--until`": "`--end`",
    "`--new`": "`--unaged-fit`",
    "`--by`": "`--label-pattern`",
    "`--wanted`": "`--target-sd`",
    "`--cuts`": "`--time-limits`",
    "`--level`, `--fitted-at`": "`--amplitude`, `--reference-strain`",
    "`--resonance-at`, `--resonance-level`": "`--resonance-amplitude`",
    "`--memory`, `--slam`, `--between`": "`--relaxation`, `--drop`, `--compression-limits`",
    "`--kind slam`": "`--kind drop`",
    "`--kind one-frequency`": "`--kind single-frequency`",
    "`dashpot predict --kind`": "`dashpot predict --frf-type`",
    "`dp.fit(cuts=)`, `dp.report(cuts=)`": "`time_limits=`",
    "`dp.Pieces`, `dp.CompressionTest`": "`dp.CLDResult`, `dp.CLDTest`",
    "`dp.Levels`": "`dp.AmplitudeResult`",
    "`dp.ModesByMass`": "`dp.MassSeriesModes`",
    "`dp.CounterforceTest`": "`dp.CSRTest`",
    "`dp.Agreement`": "`dp.FRFComparison`",
    "`dp.systems.Closing`": "`dp.systems.ClosingAnalysis`",
    "`dp.systems.transfer_stiffness`": "`dp.systems.compute_transfer_stiffness`",
    "`dp.files.recording`": "`dp.files.acquisition`",
    "`dp.plan(wanted=)`": "`dp.plan(max_std=)`",
    "`dp.fit(known=, only=)`": "`dp.fit(prior=, temperature=)`",
    "`dp.SlamTest`": "`dp.DropTest`",
    "`dp.fit(memory=, slam=)`, `dp.predict(slam=)`": (
        "`dp.fit(relaxation=, drop=)`, `dp.predict(drop=)`"
    ),
    "`.pieces` of a load deflection result, `CSRTest(piece=)`": (
        "`.specimens`, `CSRTest(specimen_number=)`"
    ),
    "`fit.residual`, `.dof`, `.profiles`, `.nuisance`, `.parameters`": "the same of `fit.estimate`",
    "`fit.orders`, `.certificate`, `.explanations`, `.alternative`, `.end_of_hold`, `.creep`": (
        "the same of `fit.evidence`"
    ),
    "`fit.by_depth`, `fit.moved`": (
        "`fit.evidence.stiffness_by_depth`, `fit.evidence.parameter_changes`"
    ),
    "`fit.left_open`": "`fit.stiffness_limits`",
    "`check.says`, `verdict.says`, `verdict.because`": (
        "`check.message`, `verdict.message`, `verdict.failed_checks`"
    ),
    "`fit.estimate.residual.kappa`": "`.variance_inflation`",
    "`study.unseen`, `.further`, `.at_rest`": (
        "`.unmeasured`, `.other_tests`, `.static_equilibrium`"
    ),
    "`described`, `series`, `document` of a result": "`print(result)`, `to_pandas()`, `to_dict()`",
    "`dp.fit(between=)`": "`dp.fit(compression_limits=)`",
    "`dp.batch(by=)`": "`dp.batch(label_pattern=)`",
    "`.found` of a result": "`.reported_values`",
    "`modes.sound`": "`modes.verdict.message`",
    "`prediction.at_rest`, `.limited`, `.at_edge`, `.of_part`": (
        "`.static_equilibrium`, `.response_limits`, `.is_peak_at_edge`, `.is_of_part`"
    ),
    "`comparison.at_rest`, `.noted`": "`.static_equilibrium`, `.frf_checks`",
    "`dp.AmplitudeFit.of`, `.left_out`, `dp.AmplitudeSweep.of`, `dp.AmplitudeResult.at`": (
        "`.amplitude_unit`, `.omitted_samples`, `.amplitude_unit`, `.peaks`"
    ),
    "`dp.IndentationTest(of=)`, `dp.IndentationFit.of`": "`quantity=`, `.quantity`",
    "`dp.files.ReadOptions(own=)`": "`dp.files.ReadOptions(file_options=)`",
    "`dp.plot.frf(informed=)`, `dp.plot.bench(found)`": "`valid_band=`, `bench_fit`",
    "`dp.systems.mac(one, other)`": "`dp.systems.mac(shapes, other_shapes)`",
    "`beyond` of `[closing.latch]`": "`overtravel`",
}
"""Options and names of Python before 0.9.0, and what they are now."""
HEAD = """\
# Former names, and versions of documents

## Options and names in Python

Names before 0.9.0. An old option still works in 0.9.0 and is not shown in the help; an old Python
name is gone.

| old | new |
|---|---|
"""
DOCUMENTS = """
## JSON documents

`--json` prints one JSON document, `-o fit.json` and `dp.save` write one. Each says in `"schema"`
what it holds and in which version: `"dashpot/fit@2"`. A version changes where a key changes its
name or its meaning; new keys do not change it. Values are in SI units. This page is written from
the tables of the code by `python docs/documents.py`.

dashpot reads the present version and the former ones below. Keys and names of checks of a former
version are converted before the document is decoded, so that it holds the same value; it is written
anew in the present version. An unknown version is refused, with what to do: of a newer one, update
dashpot.

### Schemas

| former | present |
|---|---|
"""
KEYS = """
### Keys

A key that stands in an object of the document follows the key of that object: `checks.says` is
`"says"` of each of the `"checks"`.

| schema | former key | present key |
|---|---|---|
"""
CHECKS = """
## Checks

| former | present |
|---|---|
"""
PROJECTS = """
## Saved projects

`dashpot verify` checks the history and every hash of a project of any version as they are. A result
in documents of a former version is computed again and compared in what both versions hold: the
model, its residual and what is predicted from it must be the same to 1e-7 of each number
(`former_result_recomputed`). These numbers are computed otherwise since; where they differ a note
says so (`uncertainty_unrevised`):

| key | why it is another number |
|---|---|
"""


def format_page() -> str:
    """Return the page: former and present schemas, keys and names of checks."""
    schemas = sorted({*RENAMED_KEYS, FORMER_PROJECT})
    rows = [_row(f"`{schema}`", f"`{name_present_schema(schema)}`") for schema in schemas]
    keys = [_row("every schema", f"`{old}`", f"`{new}`") for old, new in EVERYWHERE.items()]
    keys += [
        _row(f"`{name_present_schema(schema)}`", f"`{old.lstrip('.')}`", f"`{new}`")
        for schema, renamed in sorted(RENAMED_KEYS.items())
        for old, new in renamed.items()
    ]
    checks = [_row(f"`{old}`", f"`{new}`") for old, new in sorted(RENAMED_CHECKS.items())]
    revised = [_row(f"`{key}`", reason) for key, reason in REVISED_NUMBERS.items()]
    names = [_row(old, new) for old, new in FORMER_NAMES.items()]
    return "".join(
        [HEAD, *names, DOCUMENTS, *rows, KEYS, *keys, CHECKS, *checks, PROJECTS, *revised]
    )


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |\n"


if __name__ == "__main__":
    PAGE.write_text(format_page(), encoding="utf-8")
