"""Verification of a project: every hash, history line and recomputed result."""

from __future__ import annotations

import base64
import json
import math
import re
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Any

from dashpot.base.checks import Check
from dashpot.base.errors import ReadError
from dashpot.base.serialisation import DIGEST
from dashpot.base.version import software
from dashpot.extensions.projects import verification_checks
from dashpot.extensions.projects.document_versions import convert_document, name_present_schema
from dashpot.extensions.projects.history import (
    FileEntry,
    History,
    HistoryLine,
    read_history,
    sha256,
)
from dashpot.extensions.projects.partial_files import find_partial_files, is_partial_file
from dashpot.extensions.projects.project import (
    NAME,
    UNLISTED_FILES,
    Project,
    get_result_name,
    list_contents,
    list_paths,
    make_profiles,
    resolve_job_paths,
    resolve_project_path,
    select_numbers,
)
from dashpot.extensions.projects.revised_numbers import REVISED_NUMBERS, split_common
from dashpot.workflow.job import Job
from dashpot.workflow.json_archive import (
    from_json,
    has_edited_fit,
    list_children,
    require_unique_keys,
)
from dashpot.workflow.study import Study, run

_ROUNDING_UNITS = 1.000001
"""Units of the last digit by which one number may be printed twice: it was rounded both times."""


def verify(
    project: Project, *, page: Callable[[Study], str], expect: str | None = None
) -> tuple[Check, ...]:
    """Check every hash and the chain of history, and make every result again from its raw files.

    Parameters
    ----------
    project : Project
    page : function
        Makes the HTML report of a study.
    expect : str, optional
        The hash of a line that the history must hold, noted when that was its last.

    Raises
    ------
    ReadError
        If a line of the history or its head is none that dashpot writes, or names a file outside,
        or one of the project's own files is a link to a file outside.
    """
    for name in UNLISTED_FILES:
        resolve_project_path(project, name)
    history = read_history(project.folder)
    new_checks = [
        verification_checks.history_present(len(history.lines)),
        verification_checks.history_complete(
            len(history.lines), has_incomplete_line=bool(history.incomplete_line)
        ),
        verification_checks.history_whole(
            len(history.lines),
            history.recorded_count,
            is_truncated=history.is_truncated,
            has_matching_head=history.has_matching_head,
        ),
    ]
    if expect is not None:
        new_checks.append(_check_expected_hash(history, expect))
    for line, intact in zip(history.lines, history.is_intact, strict=True):
        new_checks.append(verification_checks.history_unchanged(line.line, is_unchanged=intact))
        files = [_verify_file(project, entry, line.line) for entry in (*line.inputs, *line.outputs)]
        new_checks += files
        if not any(check.failed for check in files):
            new_checks += _compare_with_rerun(project, line, page)
    new_checks.append(verification_checks.files_listed(_find_unlisted_files(project, history)))
    return (*new_checks, check_half_written_files(project.folder))


def check_half_written_files(folder: Path) -> Check:
    """Return whether a folder of results has files that killed runs left half written."""
    paths = find_partial_files(folder)
    return verification_checks.nothing_half_written(
        [path.relative_to(folder).as_posix() for path in paths]
    )


def _check_expected_hash(history: History, expect: str) -> Check:
    hashes = [line.hash for line in history.lines]
    line_index = hashes.index(expect) if expect in hashes else None
    return verification_checks.history_expected(expect, line_index, len(hashes))


def _verify_file(project: Project, entry: FileEntry, number: int) -> Check:
    path = resolve_project_path(project, entry.file)
    if not path.is_file():
        return verification_checks.file_present(entry.file, number)
    is_same = sha256(path.read_bytes()) == entry.sha256
    return verification_checks.file_unchanged(entry.file, number, is_same=is_same)


def _find_unlisted_files(project: Project, history: History) -> list[str]:
    """Return the files of the project's folder that no line lists."""
    names = {*UNLISTED_FILES} | {
        entry.file for line in history.lines for entry in (*line.inputs, *line.outputs)
    }
    files = (path for path in project.folder.rglob("*") if path.is_file() or path.is_symlink())
    complete_files = (path for path in files if not is_partial_file(path.name))
    return sorted({path.relative_to(project.folder).as_posix() for path in complete_files} - names)


# -- Recomputation --------------------------------------------------------------------------------


def _compare_with_rerun(
    project: Project, line: HistoryLine, page: Callable[[Study], str]
) -> list[Check]:
    job = from_json(json.dumps(line.job))
    if not isinstance(job, Job):
        raise ReadError(f"line {line.line} of history.jsonl holds no job: it was changed")
    input_files = {*list_paths(job), *make_profiles(job)}
    unlisted_files = sorted(input_files - {entry.file for entry in (*line.inputs, *line.outputs)})
    if unlisted_files:
        return [verification_checks.inputs_listed(unlisted_files, line.line)]
    rerun_files = list_contents(run(resolve_job_paths(project, job)), page)
    recorded_files = {
        _get_file_kind(output.file): resolve_project_path(project, output.file).read_bytes()
        for output in line.outputs
    }
    documents = [file_key for file_key in recorded_files if file_key.endswith(".json")]
    versions = {_is_former(recorded_files[file_key]) for file_key in documents}
    versions.add(_is_former(json.dumps(line.job).encode()))
    is_former = True in versions
    # another version may word and draw the same numbers otherwise
    is_same_version = line.software == software() and not is_former
    names = {match[1] for output in line.outputs if (match := _NAMED.search(output.file))}
    other = recorded_files.keys() != rerun_files.keys() or len(names) != 1
    if other or (
        is_same_version and names != {get_result_name(line.job, recorded_files["records/.json"])}
    ):
        return [
            verification_checks.result_recomputed(float("inf"), "it keeps other files", line.line)
        ]
    if any(entry.file not in input_files for entry in line.inputs):
        return [
            verification_checks.result_recomputed(
                float("inf"), "its job reads fewer files", line.line
            )
        ]
    if len(versions) > 1:
        location = "its job and documents are of different versions"
        return [verification_checks.result_recomputed(float("inf"), location, line.line)]
    if is_former:
        return [
            *_compare_with_former(line, recorded_files, rerun_files, documents),
            verification_checks.page_redrawn(line.line, is_same_page=False, is_same=False),
        ]
    worst, location = max(
        _compare_json(
            recorded_files[file_key], rerun_files[file_key], file_key, words=is_same_version
        )
        for file_key in documents
    )
    is_same = is_same_version and is_same_page(
        recorded_files["reports/.html"], rerun_files["reports/.html"]
    )
    return [
        verification_checks.result_recomputed(worst, location, line.line),
        verification_checks.page_redrawn(line.line, is_same_page=is_same, is_same=is_same_version),
    ]


_NAMED = re.compile(rf"/([0-9a-f]{{{NAME}}})\.")


def _get_file_kind(file_path: str) -> str:
    """Return a place without the name of the result: ``records/0123456789abcdef.fit.json``."""
    return _NAMED.sub("/.", file_path)


def _is_former(content: bytes) -> bool:
    """Return whether a file is a document of a former version."""
    try:
        document = json.loads(content)
    except (ValueError, RecursionError):
        return False
    schema = document.get("schema") if isinstance(document, dict) else None
    return isinstance(schema, str) and name_present_schema(schema) != schema


def _compare_with_former(
    line: HistoryLine,
    recorded_files: dict[str, bytes],
    new_files: dict[str, bytes],
    documents: list[str],
) -> list[Check]:
    """Compare what documents of a former version and the present ones both hold."""
    faults: list[str] = []
    written_documents: dict[str, Any] = {}
    for file_key in documents:
        try:
            earlier_document = json.loads(
                recorded_files[file_key], object_pairs_hook=require_unique_keys
            )
        except (ValueError, RecursionError):
            faults.append(f"{file_key} is no JSON")
            continue
        if file_key != "records/.json" and has_edited_fit(
            earlier_document
        ):  # which holds parts of fits
            faults.append(f"{file_key} holds a fit that was changed by hand")
        written_documents[file_key] = select_numbers(convert_document(earlier_document))
    result = written_documents.get("records/.json", {})
    for name in ("fit", "joint"):
        own_document = written_documents.get(f"records/.{name}.json")
        embedded_fit = select_numbers(result.get(name) or {})
        if own_document is not None and embedded_fit | {DIGEST: ""} != own_document | {DIGEST: ""}:
            faults.append(f"the result and its {name}.json hold different fits")
    if faults:
        return [verification_checks.result_recomputed(float("inf"), faults[0], line.line)]
    worst, location, revised_keys = 0.0, "", set()
    for file_key, earlier_document in written_documents.items():
        old, new, revised_values = split_common(
            earlier_document, select_numbers(json.loads(new_files[file_key]))
        )
        worst, location = max((worst, location), find_largest_difference(old, new, file_key))
        revised_keys |= {
            name.rpartition(".")[2]
            for name, (old_value, new_value) in revised_values.items()
            if find_largest_difference(old_value, new_value)[0]
            > verification_checks.SAME_NUMBER_TOLERANCE
        }
    if worst == float("inf"):
        return [verification_checks.result_recomputed(worst, location, line.line)]
    version = line.software.get("dashpot", "another version")
    reasons = {name: reason for name, reason in REVISED_NUMBERS.items() if name in revised_keys}
    return [
        verification_checks.earlier_result_reproduced(worst, location, line.line, version),
        verification_checks.uncertainty_unrevised(reasons, line.line, version),
    ]


def _compare_json(
    content: bytes, new_content: bytes, file_key: str, *, words: bool
) -> tuple[float, str]:
    try:
        recorded, recomputed = (
            json.loads(content, object_pairs_hook=require_unique_keys),
            json.loads(new_content),
        )
    except (ValueError, RecursionError):
        return float("inf"), f"{file_key} is no JSON"
    if not words and isinstance(recorded, dict):
        recorded, recomputed = select_numbers(recorded), select_numbers(recomputed)
    return find_largest_difference(recorded, recomputed, file_key)


def find_largest_difference(
    recorded_value: Any, recomputed: Any, location: str = ""
) -> tuple[float, str]:
    """Return the largest relative difference between two documents, and its place."""
    if not (
        isinstance(recorded_value, dict | list) and isinstance(recomputed, type(recorded_value))
    ):
        compute = (
            _compute_gap_difference if location.endswith(".gap") else _compute_relative_difference
        )
        return compute(
            recorded_value, recomputed
        ), f"{location} was {recorded_value!r} and is {recomputed!r}"
    if location.endswith("model.arms"):
        recorded_value, recomputed = (
            _merge_coincident_arms(recorded_value),
            _merge_coincident_arms(recomputed),
        )
    recorded_parts, recomputed_parts = (
        list_children(recorded_value, location),
        list_children(recomputed, location),
    )
    if recorded_parts.keys() != recomputed_parts.keys():
        difference_text = "other keys" if isinstance(recorded_value, dict) else "another length"
        return float("inf"), f"{location or 'the document'} has {difference_text}"
    pairs = (
        find_largest_difference(
            recorded_parts[key_path], recomputed_parts[key_path], key_path.lstrip(".")
        )
        for key_path in recorded_parts
        if key_path != f"{location}.{DIGEST}"
    )
    return max(pairs, default=(0.0, ""), key=lambda item: item[0])


def _merge_coincident_arms(arms: Any) -> Any:
    """Return the arms of a solid in which those of one time constant are one arm.

    Only the sum of their stiffnesses is determined: a fit with more arms than the record shows may
    split it in any way, as rounding of the processor will have it.
    """
    keys = {"k", "tau", "b"}
    is_list = isinstance(arms, list)
    if not is_list or not all(isinstance(arm, dict) and keys <= arm.keys() for arm in arms):
        return arms
    merged_arms: list[Any] = []
    for arm in arms:
        last_arm = merged_arms[-1] if merged_arms else {"tau": None}
        if (
            _compute_relative_difference(last_arm["tau"], arm["tau"])
            > verification_checks.SAME_NUMBER_TOLERANCE
        ):
            merged_arms.append(arm)
        else:
            merged_arms[-1] = last_arm | {key: last_arm[key] + arm[key] for key in ("k", "b")}
    return merged_arms


def _compute_relative_difference(text: Any, other_value: Any) -> float:
    """Return relative difference of two values; of texts that of the numbers in them, if any."""
    if repr(text) == repr(other_value):  # as NaN equals nothing
        return 0.0
    if _is_number(text) and _is_number(other_value) and text != other_value:
        number, scale = abs(Decimal(text) - Decimal(other_value)), max(abs(text), abs(other_value))
        # what is not finite is no rounding of what is
        return float(number / Decimal(scale)) if number.is_finite() else float("inf")
    if isinstance(text, str) and isinstance(other_value, str):
        is_same = _is_same_text(text, other_value)
    else:
        is_same = text == other_value and isinstance(text, bool) == isinstance(other_value, bool)
    return 0.0 if is_same else float("inf")


def _compute_gap_difference(gap: Any, other_gap: Any) -> float:
    """Return the difference of two gaps, which are fractions: all digits of a small one round."""
    if (
        _is_number(gap)
        and _is_number(other_gap)
        and math.isfinite(gap)
        and math.isfinite(other_gap)
    ):
        return float(abs(gap - other_gap))
    return _compute_relative_difference(gap, other_gap)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def is_same_page(content: bytes, other_content: bytes) -> bool:
    """Return whether two pages are equal but for the rounding of a last digit.

    The files inside a page are compared by their type.
    """
    if content == other_content:
        return True
    try:
        first_page, second_page = (
            _decode_embedded_files(text.decode()) for text in (content, other_content)
        )
    except ValueError:
        return False
    return _is_same_text(first_page, second_page)


def _decode_embedded_files(page: str) -> str:
    """Return a page with the files embedded in its links as text."""
    return re.sub(
        r"(?<=;base64,)[A-Za-z0-9+/=]+",
        lambda link: base64.b64decode(link[0]).decode(errors="backslashreplace"),
        page,
    )


_NUMBER = re.compile(r"(-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)", re.ASCII)


def _is_same_text(text: str, other_text: str) -> bool:
    """Return whether two texts are equal but for the last printed digit of their numbers."""
    if text == other_text:
        return True
    parts, other_parts = _NUMBER.split(text), _NUMBER.split(other_text)
    return parts[::2] == other_parts[::2] and all(
        # of 13 and 12.71 the finer counts: who prints fewer digits has not computed another number
        a == b or _is_rounded(a, b)
        for a, b in zip(parts[1::2], other_parts[1::2], strict=True)
    )


def _is_rounded(a: str, b: str) -> bool:
    """Return whether two printed numbers may be one number rounded twice; not for counts.

    >>> _is_rounded("12.70", "12.71"), _is_rounded("13", "12.71"), _is_rounded("13", "14")
    (True, False, False)
    """
    counted = a.lstrip("-").isdigit() and b.lstrip("-").isdigit()
    unit = min(_get_last_digit_unit(a), _get_last_digit_unit(b))
    return not counted and abs(float(a) - float(b)) <= _ROUNDING_UNITS * unit


def _get_last_digit_unit(number: str) -> float:
    """Return the value of one unit in the last digit of a printed number.

    >>> [_get_last_digit_unit(number) for number in ("12.70", "-3e-05", "40")]
    [0.01, 1e-05, 1.0]
    """
    digits, _, exponent = number.lower().partition("e")
    return float(f"1e{int(exponent or 0) - len(digits.partition('.')[2])}")
