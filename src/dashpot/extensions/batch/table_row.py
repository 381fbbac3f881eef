"""Row of one test: its results, or the error that prevented them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dashpot.base.checks import Check, Verdict
from dashpot.base.errors import DashpotError
from dashpot.base.provenance import SIMULATED
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import column
from dashpot.datamodel.fit import Fit, list_arm_values
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.batch.batch_options import BatchOptions, find_test_machine
from dashpot.extensions.batch.columns import (
    build_requested_columns,
    format_stiffness_column,
    make_empty_row,
)
from dashpot.extensions.batch.impact_comparison import (
    compare_with_hammer,
    make_origin_column,
    read_hammer_resonance,
)
from dashpot.extensions.batch.input_files import NO_TABLE, Entry, compute_file_hash
from dashpot.reading.columns.file_kinds import RecognisedKind
from dashpot.reading.readers.detect_kind import recognise
from dashpot.reading.readers.inspect import inspect_file
from dashpot.registry import (
    FIT_FILES,
    KINDS,
    KindOfTest,
    LotSpecimen,
    find_handler,
    load_object,
    row_of,
)
from dashpot.solids.elastic import require_plausible_compression
from dashpot.vibration.mass_on_seals import MassOnSeals
from dashpot.workflow.bench_tests import fit_files
from dashpot.workflow.stiffness_under_mass import find_static_equilibrium

if TYPE_CHECKING:
    from dashpot.workflow.bench_tests import Record


def make_row(entry: Entry, hashes: Sequence[str], choices: BatchOptions) -> dict[str, Any]:
    """Return the row of one test; faults of its files are stated in it.

    Parameters
    ----------
    entry : Entry
    hashes : sequence of str
        Hashes of its file and of its hammer's at the start of the batch.
    choices : BatchOptions
    """
    entries = make_empty_row(entry, "", choices)
    if entry.mass is None:
        entries["mass_kg"] = choices.mass
    cells: dict[str, Any]
    if entry.aside:
        outcome = "ignored" if entry.aside == NO_TABLE else "refused"
        return entries | {"outcome": outcome, "reason": entry.aside}
    try:
        cells = _fit_entry(entry, choices, entries)
    except DashpotError as error:
        cells = {"outcome": "refused", "reason": str(error)}
    except Exception as error:  # noqa: BLE001 -- one file's fault is one row
        cells = {
            "outcome": "refused",
            "reason": f"internal error of dashpot: {type(error).__name__}. dashpot fit shows more",
        }
    changed_file = _find_changed_file(entry, hashes, cells.get("sha256"))
    if changed_file:
        outcome_text = "changed" if Path(changed_file).exists() else "went"
        cells = {
            "outcome": "changed",
            "reason": f"{changed_file} {outcome_text} while the batch ran; run it again",
        }
    elif hashes[0]:
        with suppress(OSError):  # gone, by now
            cells["bytes"] = Path(entry.file).stat().st_size
    entries |= cells | {"sha256": hashes[0]}
    return {name: _replace_non_finite(value) for name, value in entries.items()}


def build_rows(
    entry: Entry, hashes: Sequence[str], choices: BatchOptions, part: str = ""
) -> list[dict[str, Any]]:
    """Return the row of one test, or a row for each of several specimens in its file.

    How each is chosen, and its name, stand behind the name of the file. Where the seal was named,
    the specimen's name is added to it. The arguments are those of :func:`make_row`.
    """
    single_row = make_row(entry, hashes, choices)
    # only the record of one specimen shows of which test strain and stress are
    told_by_record = find_handler("record rule", single_row.get("kind", "")) is not None
    is_unclear = single_row["outcome"] == "refused" or told_by_record
    specimens = _list_specimens(entry, choices) if is_unclear and not entry.aside else []
    if not specimens:
        return [single_row]
    built_rows: list[dict[str, Any]] = []
    for name, selection in specimens:
        key, _, value = selection.partition("=")
        selected: dict[str, Any] = {key: int(value) if key == "segment" else value}
        option_text = ",".join(filter(None, (part, selection)))
        seal = f"{entry.seal} {name or value}" if entry.seal else ""
        label = option_text if name in {"", value} else f"{option_text} {name}"
        rows = build_rows(
            replace(entry, seal=seal), hashes,
            replace(choices, reading=replace(choices.reading, **selected)), option_text,
        )  # fmt: skip
        built_rows += [
            table_row
            if table_row["part"]
            else table_row | {"part": option_text, "file": f"{entry.file} [{label}]"}
            for table_row in rows
        ]
    changed_rows = [table_row for table_row in built_rows if table_row["outcome"] == "changed"]
    return (
        [single_row | {"outcome": "changed", "reason": changed_rows[0]["reason"]}]
        if changed_rows
        else built_rows
    )


def _list_specimens(entry: Entry, choices: BatchOptions) -> Sequence[tuple[str, str]]:
    """Return the name of each specimen in a file with several, and the option that selects it."""
    with suppress(DashpotError):
        questions = inspect_file(entry.file, options=choices.bench).questions
        return next((question.answers for question in questions if question.answers), ())
    return ()


def _find_changed_file(entry: Entry, hashes: Sequence[str], read_hash: str | None) -> str:
    """Return the first file without its former hash, if any; `read_hash` is its hash as read."""
    current_hashes = (
        read_hash or compute_file_hash(entry.file),
        *map(compute_file_hash, entry.hammer),
    )
    files = zip((entry.file, *entry.hammer), current_hashes, hashes, strict=True)
    return next((file for file, name, former_hash in files if name != former_hash), "")


def _fit_entry(entry: Entry, choices: BatchOptions, entries: Mapping[str, Any]) -> dict[str, Any]:
    """Return the row of a fit, or of a file that cannot be fitted."""
    specimen = Specimen(temperature=entry.temperature)
    fit_keywords: dict[str, Any] = {
        "arms": choices.arms, "method": choices.method, "intervals": not choices.quick,
        "specimen": specimen, "machine": _get_machine(entry, choices),
    }  # fmt: skip
    recognised_file = recognise(entry.file, choices.bench)
    origin = {"origin": SIMULATED if recognised_file.simulated else ""}
    kind = KINDS.get(recognised_file.kind, KINDS["relaxation"])
    if kind.fit != FIT_FILES:
        return _build_other_row(recognised_file, kind, entry, choices, entries["mass_kg"]) | origin
    try:
        fit, records = fit_files((entry.file,), options=choices.bench, **fit_keywords)
    except DashpotError as error:
        return {"kind": recognised_file.kind, "outcome": "refused", "reason": str(error)} | origin
    return _build_fit_row(fit, records[0], entry, choices, entries)


def _build_other_row(
    recognised: RecognisedKind,
    kind: KindOfTest,
    entry: Entry,
    choices: BatchOptions,
    mass: float | None,
) -> dict[str, Any]:
    """Return the row of a file of another kind: its own, or its kind and the missing input."""
    specimen = _describe_lot_specimen(entry, choices, mass)
    if kind.lot_row and (
        not kind.required_value or getattr(specimen, kind.required_value) is not None
    ):
        return _build_kind_row(kind, entry, specimen)
    texts = {
        "kind": kind.name,
        "outcome": "other",
        "reason": f"it is {recognised.kind_title}: {kind.lot_hint or recognised.use}",
    }
    return texts | (read_hammer_resonance(entry, choices, mass) if kind.resonates else {})


def _describe_lot_specimen(entry: Entry, choices: BatchOptions, mass: float | None) -> LotSpecimen:
    return LotSpecimen(
        choices.bench, entry.temperature, mass,
        choices.length, choices.radius, next(iter(choices.compression), None),
        _get_machine(entry, choices),
    )  # fmt: skip


def _get_machine(entry: Entry, choices: BatchOptions) -> Machine | None:
    """Return the machine of a test without the hammer's rig; None if it is unknown."""
    machine = find_test_machine(entry, choices).on_bench
    return None if machine == Machine() else machine


def _build_kind_row(kind: KindOfTest, entry: Entry, specimen: LotSpecimen) -> dict[str, Any]:
    """Return the row of a kind that has its own."""
    try:
        result, numbers = load_object(kind.lot_row)(entry.file, specimen)
    except DashpotError as error:
        return {"kind": kind.name, "outcome": "refused", "reason": str(error)}
    sources = result.source if isinstance(result.source, tuple) else (result.source,)
    entries: dict[str, Any] = {
        "kind": kind.name, "outcome": "fitted",
        "sha256": sources[0].sha256 if any(sources) else "",
    }  # fmt: skip
    entries |= numbers
    return entries | _build_verdict_columns(result.verdict, result.checks)


def _build_fit_row(
    fit: Fit,
    record: Record,
    entry: Entry,
    choices: BatchOptions,
    entries: Mapping[str, Any],
) -> dict[str, Any]:
    numbers, mass = (
        _build_record_columns(record) | make_origin_column(*fit.source),
        entries["mass_kg"],
    )
    sentences: list[str] = []
    if entry.hammer:
        try:
            fit, comparison = compare_with_hammer(fit, record, entry, choices, mass)
            sentences.append(comparison.pop("reason"))
            numbers |= comparison
        except DashpotError as error:
            sentences.append(f"hammer: {error}")
    numbers |= _build_fit_columns(fit, numbers.get("hold_s"), choices.columns)
    if not choices.quick:
        numbers |= _build_uncertainty_columns(fit, choices.columns)
    try:
        numbers |= _compute_requested_columns(fit, choices, numbers.get("hold_s"))
    except DashpotError as error:
        sentences.append(str(error))
    try:
        numbers |= _compute_mode_under_mass(fit, mass, choices.seals)
    except DashpotError as error:
        sentences.append(f"under the mass: {error}")
    reasons = "; ".join(filter(None, (numbers.get("reason", ""), *sentences)))
    return numbers | {"reason": reasons}


def _build_record_columns(record: Record) -> dict[str, Any]:
    kelvin = getattr(record, "specimen", Specimen()).temperature
    source = getattr(record, "source", None)
    entries: dict[str, Any] = {} if kelvin is None else {"temperature_K": kelvin}
    entries |= {} if source is None else {"sha256": source.sha256}
    kind = row_of(record)
    entries |= {} if kind is None else {"kind": kind.name}
    if isinstance(record, RampHold):
        return entries | {
            "samples": len(record.time),
            "depth_m": record.depth,
            "ramp_s": record.ramp_time,
            "hold_s": record.hold_time,
            "force_noise_N": record.force_noise,
        }
    list_columns = find_handler("lot columns", record)
    return entries if list_columns is None else entries | list_columns(record)


def _build_fit_columns(fit: Fit, hold: float | None, space: int) -> dict[str, Any]:
    model, unit = fit.model, fit.unit
    entries: dict[str, Any] = {
        "outcome": "fitted",
        "status": fit.status.name.lower(),
        "method": fit.method,
        "arms": model.arms,
        "band_low_Hz": fit.band[0],
        "band_high_Hz": fit.band[1],
        format_stiffness_column("0", unit): model.k_0,
    }
    if hold is not None:
        entries[format_stiffness_column("end", unit)] = float(model.relaxation(hold))
    if fit.estimate.residual.unit == "N":
        entries["rms_N"] = fit.estimate.residual.rms
    return entries | {
        _get_column_name(reported_value): reported_value.value
        for reported_value in _select_arm_facts(fit, space)
    }


def _build_uncertainty_columns(fit: Fit, space: int) -> dict[str, Any]:
    """Errors, intervals, checks and verdict."""
    unit, reported_values = fit.unit, list(_select_arm_facts(fit, space))
    entries = _build_verdict_columns(fit.verdict, fit.checks) | {
        format_stiffness_column("inf_low", unit): reported_values[0].low,
        format_stiffness_column("inf_high", unit): reported_values[0].high,
    }
    if fit.stiffness_limits is not None:
        low, high = fit.stiffness_limits["k_end"]
        entries |= {
            format_stiffness_column("end_low", unit): low,
            format_stiffness_column("end_high", unit): high,
        }
    return entries | {
        _get_column_name(reported_value, "_se"): reported_value.error
        for reported_value in reported_values
    }


def _build_verdict_columns(verdict: Verdict, checks: Iterable[Check]) -> dict[str, Any]:
    """Return the verdict, why, and the checks that limit the use, each once."""
    failed_names = dict.fromkeys(
        check.name for check in checks if check.failed and check.grade != "note"
    )
    return {
        "verdict": verdict.use,
        "reason": "" if verdict.use == "use" else verdict.message,
        "failed_checks": " ".join(failed_names),
    }


def _select_arm_facts(fit: Fit, space: int) -> Iterator[ReportedValue]:
    """Return k_inf and the arms; a curve may have more than a row can hold."""
    arm_values = (
        arm_value for arm_value in list_arm_values(fit) if not arm_value.name.startswith("b")
    )
    return islice(arm_values, 1 + 2 * space)


def _get_column_name(reported_value: ReportedValue, suffix: str = "") -> str:
    """Return the column name of a number of a solid or of a nuisance parameter."""
    kind, _, index_text = reported_value.name.partition("_")
    if kind == "k":
        return format_stiffness_column(f"{index_text}{suffix}", reported_value.unit)
    return column(f"{reported_value.name}{suffix}", reported_value.unit)


def _compute_requested_columns(
    fit: Fit, choices: BatchOptions, hold: float | None
) -> dict[str, Any]:
    """Stiffness and loss at the requested frequencies: for small vibration about a compression."""
    entries: dict[str, Any] = {}
    for (frequency, compression), columns in build_requested_columns(choices, fit.unit).items():
        solid = fit.model
        if compression is not None:
            require_plausible_compression(compression, fit.elastic_law, fit.specimen.height)
            solid = fit.model_at(compression)
        if frequency is not None:
            value = complex(solid.complex_stiffness(omega=2 * math.pi * frequency))
            numbers = value.real, value.imag, value.imag / value.real
            entries |= dict(zip(columns, numbers, strict=True))
        elif hold is not None:
            entries[columns[0]] = float(solid.relaxation(hold))
    return entries


def _compute_mode_under_mass(fit: Fit, mass: float | None, seals: float) -> dict[str, Any]:
    """Return the mode of the mass at rest on the seals, as in ``dashpot predict``."""
    if mass is None or fit.unit != "N/m":
        return {}
    tangent_stiffness = find_static_equilibrium(fit, MassOnSeals(mass, seals)).tangent
    return {
        "frequency_Hz": tangent_stiffness.frequency,
        "damping_ratio": tangent_stiffness.damping_ratio,
    }


def _replace_non_finite(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
