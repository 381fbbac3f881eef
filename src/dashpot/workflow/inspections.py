"""Inspection of files, with the preparation of relaxation tests."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from inspect import signature
from pathlib import Path
from typing import Any, TypeAlias

from dashpot.base import dataclass, fields, replace
from dashpot.base.checks import Check
from dashpot.base.errors import DashpotError
from dashpot.base.provenance import Step
from dashpot.base.serialisation import Key, Serialisable
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.datamodel.specimen import Specimen
from dashpot.preprocessing.prepare import prepare
from dashpot.reading.columns.file_kinds import RecognisedKind
from dashpot.reading.raw_file import add_name_to_errors
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.channels import OpenedFile, cache_open_file, pop_cached_file, read_once
from dashpot.reading.readers.detect_kind import open_or_identify
from dashpot.reading.readers.inspect import Inspection, inspect_opened, inspect_other_path
from dashpot.reading.readers.relaxation import relaxation_in
from dashpot.registry import KINDS, load_object

Reader: TypeAlias = Callable[[OpenedFile], RelaxationTest]
Preparer: TypeAlias = Callable[[RelaxationTest, ReadOptions], RampHold]


@dataclass(frozen=True)
class Preparation:
    """Preparation of a relaxation test; SI units, as in a ``RampHold``."""

    onset: float
    ramp_end: float
    hold_end: float
    ramp_time: float
    hold_time: float
    depth: float
    preload: float
    force_noise: float
    displacement_noise: float
    steps: tuple[Step, ...]
    checks: tuple[Check, ...]


@dataclass(frozen=True)
class InspectedFile(Inspection, Serialisable):
    """Inspection of a file, with the preparation of a relaxation test.

    Attributes
    ----------
    preparation : Preparation or None
    refusal : str
        Why a relaxation test cannot be prepared.
    """

    _keys = (
        *(field.name for field in fields(Inspection)),
        Key("preparation", "account", optional=True),
    )

    preparation: Preparation | None = None
    refusal: str = ""

    @property
    def account(self) -> Preparation | dict[str, str] | None:
        """The preparation, or why there is none."""
        return {"error": self.refusal} if self.refusal else self.preparation


def convert_old_inspection(entries: dict[str, Any]) -> dict[str, Any]:
    """Return the fields of an inspected file from its values; an older one has its error there."""
    account = entries.get("preparation", {})
    if "error" not in account:
        return entries
    other_entries = {key: value for key, value in entries.items() if key != "preparation"}
    return other_entries | {"refusal": account["error"]}


@dataclass(frozen=True)
class Inspections(Serialisable):
    """Result of ``dashpot inspect``, file by file."""

    schema = "dashpot/inspection@2"

    files: tuple[InspectedFile, ...]

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks of the preparation."""
        return tuple(
            check for file in self.files if file.preparation for check in file.preparation.checks
        )


def inspect_files(
    files: Sequence[str | Path],
    *,
    options: ReadOptions | None = None,
    read: Reader | None = None,
    prepare_test: Preparer | None = None,
) -> Inspections:
    """Inspect files, and prepare those that are relaxation tests and leave no question open.

    `read` and `prepare_test` replace reader and preparation by cached versions. Data needed by both
    the inspection and the reader are read once.
    """
    options = options or ReadOptions()
    reader_and_preparer = read or _read, prepare_test or _prepare_record
    return Inspections(tuple(_inspect_path(path, options, *reader_and_preparer) for path in files))


def _read(file: OpenedFile) -> RelaxationTest:
    return relaxation_in(file, Specimen())


def _prepare_record(record: RelaxationTest, options: ReadOptions) -> RampHold:
    return prepare(record, cycle=options.cycle)


def _inspect_path(
    path: str | Path, options: ReadOptions, read: Reader, prepare_test: Preparer
) -> InspectedFile:
    opened_file = open_or_identify(path, options)
    if isinstance(opened_file, RecognisedKind):
        return _build_inspected_file(inspect_other_path(path, opened_file))
    file = read_once(opened_file)
    with add_name_to_errors(file.raw.name):
        inspection = inspect_opened(file)
    if inspection.questions:
        return _build_inspected_file(inspection)
    if inspection.kind != "relaxation":
        return _build_inspected_file(
            _add_cautions(inspection, _read_by_kind(path, file, inspection.kind))
        )
    try:
        with add_name_to_errors(file.raw.name):
            record = read(file)
        inspection = _add_cautions(inspection, record)
        test = prepare_test(record, options)
    except DashpotError as error:
        return _build_inspected_file(inspection, refusal=str(error))
    preparation = Preparation(
        **{field.name: getattr(test, field.name) for field in fields(Preparation)}
    )
    return _build_inspected_file(inspection, preparation=preparation)


def _read_by_kind(path: str | Path, file: OpenedFile, kind: str) -> object:
    """Return the record of an open file by the reader of its kind; None if it cannot be read."""
    row = KINDS.get(kind)
    if row is None or not row.reader or str(path) == "-":
        return None
    reader = load_object(row.reader)
    parameters = signature(reader).parameters
    if (
        "options" not in parameters
        or sum(parameter.default is parameter.empty for parameter in parameters.values()) > 1
    ):
        return None  # the file leaves questions open
    cache_open_file(path, file)
    try:
        return reader(path, options=file.options)
    except DashpotError:
        return None
    finally:
        pop_cached_file(path, file.options)


def _add_cautions(inspection: Inspection, record: object) -> Inspection:
    """Return the inspection, with the cautions of the reader of its kind."""
    source = getattr(record, "source", None)
    sources = source if isinstance(source, tuple) else () if source is None else (source,)
    notes = dict.fromkeys(note for source in sources for note in source.cautions)
    text = "\n".join(inspection.warnings)
    new_notes = tuple(note for note in notes if note not in text)
    if not new_notes:
        return inspection
    final_inspection = replace(inspection, warnings=(*inspection.warnings, *new_notes))
    vars(final_inspection).update(
        {name: var for name, var in vars(inspection).items() if name not in vars(final_inspection)}
    )
    return final_inspection


def _build_inspected_file(inspection: Inspection, **changes: Any) -> InspectedFile:
    inspected_file = InspectedFile(
        **{field.name: getattr(inspection, field.name) for field in fields(inspection)}, **changes
    )
    vars(inspected_file).update(
        {
            name: value
            for name, value in vars(inspection).items()
            if name not in vars(inspected_file)
        }
    )
    return inspected_file  # with the course of its columns, which is drawn and no field
