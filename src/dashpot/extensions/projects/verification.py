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
    OWN,
    Project,
    contents,
    name_of,
    numbers,
    paths_of,
    profiles,
    resolve_job_paths,
    resolve_project_path,
)
from dashpot.extensions.projects.revised_numbers import REVISED_NUMBERS, split_common
from dashpot.workflow.job import Job
from dashpot.workflow.json_archive import from_json, has_edited_fit, parts_of, require_unique_keys
from dashpot.workflow.study import Study, run

_ROUNDED = 1.000001
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
    for name in OWN:
        resolve_project_path(project, name)
    history = read_history(project.folder)
    new_checks = [
        verification_checks.history_present(len(history.lines)),
        verification_checks.history_complete(len(history.lines), torn=bool(history.torn)),
        verification_checks.history_whole(
            len(history.lines),
            history.written,
            shortened=history.is_truncated,
            headed=history.has_matching_head,
        ),
    ]
    if expect is not None:
        new_checks.append(_check_expected_hash(history, expect))
    for line, intact in zip(history.lines, history.intact, strict=True):
        new_checks.append(verification_checks.history_unchanged(line.line, is_unchanged=intact))
        files = [_file(project, entry, line.line) for entry in (*line.inputs, *line.outputs)]
        new_checks += files
        if not any(check.failed for check in files):
            new_checks += _compare_with_rerun(project, line, page)
    new_checks.append(verification_checks.files_listed(_find_unlisted_files(project, history)))
    return (*new_checks, check_half_written_files(project.folder))


def check_half_written_files(folder: Path) -> Check:
    """Whether a folder of results, of whatever kind, holds what killed runs left half written."""
    paths = find_partial_files(folder)
    return verification_checks.nothing_half_written(
        [path.relative_to(folder).as_posix() for path in paths]
    )


def _check_expected_hash(history: History, expect: str) -> Check:
    hashes = [line.hash for line in history.lines]
    place = hashes.index(expect) if expect in hashes else None
    return verification_checks.history_expected(expect, place, len(hashes))


def _file(project: Project, listed: FileEntry, number: int) -> Check:
    path = resolve_project_path(project, listed.file)
    if not path.is_file():
        return verification_checks.file_present(listed.file, number)
    same = sha256(path.read_bytes()) == listed.sha256
    return verification_checks.file_unchanged(listed.file, number, same=same)


def _find_unlisted_files(project: Project, history: History) -> list[str]:
    """Return the files of the project's folder that no line lists."""
    names = {*OWN} | {
        entry.file for line in history.lines for entry in (*line.inputs, *line.outputs)
    }
    files = (path for path in project.folder.rglob("*") if path.is_file() or path.is_symlink())
    whole = (path for path in files if not is_partial_file(path.name))
    return sorted({path.relative_to(project.folder).as_posix() for path in whole} - names)


# -- the work, done again -------------------------------------------------------------------------


def _compare_with_rerun(
    project: Project, line: HistoryLine, page: Callable[[Study], str]
) -> list[Check]:
    job = from_json(json.dumps(line.job))
    if not isinstance(job, Job):
        raise ReadError(f"line {line.line} of history.jsonl holds no job: it was changed")
    needed = {*paths_of(job), *profiles(job)}
    unlisted = sorted(needed - {entry.file for entry in (*line.inputs, *line.outputs)})
    if unlisted:
        return [verification_checks.inputs_listed(unlisted, line.line)]
    made = contents(run(resolve_job_paths(project, job)), page)
    retained = {
        _kind(output.file): resolve_project_path(project, output.file).read_bytes()
        for output in line.outputs
    }
    documents = [place for place in retained if place.endswith(".json")]
    versions = {_is_former(retained[place]) for place in documents}
    versions.add(_is_former(json.dumps(line.job).encode()))
    former = True in versions
    # another version may word and draw the same numbers otherwise
    alike = line.software == software() and not former
    names = {match[1] for output in line.outputs if (match := _NAMED.search(output.file))}
    other = retained.keys() != made.keys() or len(names) != 1
    if other or (alike and names != {name_of(line.job, retained["records/.json"])}):
        return [
            verification_checks.result_recomputed(float("inf"), "it keeps other files", line.line)
        ]
    if any(entry.file not in needed for entry in line.inputs):
        return [
            verification_checks.result_recomputed(
                float("inf"), "its job reads fewer files", line.line
            )
        ]
    if len(versions) > 1:
        where = "its job and documents are of different versions"
        return [verification_checks.result_recomputed(float("inf"), where, line.line)]
    if former:
        return [
            *_compare_with_former(line, retained, made, documents),
            verification_checks.page_redrawn(line.line, same=False, is_same=False),
        ]
    worst, where = max(
        _json_difference(retained[place], made[place], place, words=alike) for place in documents
    )
    same = alike and same_page(retained["reports/.html"], made["reports/.html"])
    return [
        verification_checks.result_recomputed(worst, where, line.line),
        verification_checks.page_redrawn(line.line, same=same, is_same=alike),
    ]


_NAMED = re.compile(rf"/([0-9a-f]{{{NAME}}})\.")


def _kind(place: str) -> str:
    """Return a place without the name of the result: ``records/0123456789abcdef.fit.json``."""
    return _NAMED.sub("/.", place)


def _is_former(content: bytes) -> bool:
    """Return whether a file is a document of a former version."""
    try:
        document = json.loads(content)
    except (ValueError, RecursionError):
        return False
    schema = document.get("schema") if isinstance(document, dict) else None
    return isinstance(schema, str) and name_present_schema(schema) != schema


def _compare_with_former(
    line: HistoryLine, retained: dict[str, bytes], new_files: dict[str, bytes], documents: list[str]
) -> list[Check]:
    """Compare what documents of a former version and the present ones both hold."""
    faults: list[str] = []
    written: dict[str, Any] = {}
    for place in documents:
        try:
            before = json.loads(retained[place], object_pairs_hook=require_unique_keys)
        except (ValueError, RecursionError):
            faults.append(f"{place} is no JSON")
            continue
        if place != "records/.json" and has_edited_fit(before):  # which holds parts of fits
            faults.append(f"{place} holds a fit that was changed by hand")
        written[place] = numbers(convert_document(before))
    result = written.get("records/.json", {})
    for name in ("fit", "joint"):
        alone = written.get(f"records/.{name}.json")
        held = numbers(result.get(name) or {})
        if alone is not None and held | {DIGEST: ""} != alone | {DIGEST: ""}:
            faults.append(f"the result and its {name}.json hold different fits")
    if faults:
        return [verification_checks.result_recomputed(float("inf"), faults[0], line.line)]
    worst, where, revised = 0.0, "", set()
    for place, before in written.items():
        old, new, differing = split_common(before, numbers(json.loads(new_files[place])))
        worst, where = max((worst, where), find_largest_difference(old, new, place))
        revised |= {
            name.rpartition(".")[2]
            for name, (was, now) in differing.items()
            if find_largest_difference(was, now)[0] > verification_checks.SAME
        }
    if worst == float("inf"):
        return [verification_checks.result_recomputed(worst, where, line.line)]
    by = line.software.get("dashpot", "another version")
    reasons = {name: reason for name, reason in REVISED_NUMBERS.items() if name in revised}
    return [
        verification_checks.former_result_recomputed(worst, where, line.line, by),
        verification_checks.uncertainty_unrevised(reasons, line.line, by),
    ]


def _json_difference(content: bytes, again: bytes, place: str, *, words: bool) -> tuple[float, str]:
    try:
        before, after = (
            json.loads(content, object_pairs_hook=require_unique_keys),
            json.loads(again),
        )
    except (ValueError, RecursionError):
        return float("inf"), f"{place} is no JSON"
    if not words and isinstance(before, dict):
        before, after = numbers(before), numbers(after)
    return find_largest_difference(before, after, place)


def find_largest_difference(retained: Any, again: Any, where: str = "") -> tuple[float, str]:
    """Return the largest relative difference between two documents, and its place."""
    if not (isinstance(retained, dict | list) and isinstance(again, type(retained))):
        compute = (
            _compute_gap_difference if where.endswith(".gap") else _compute_relative_difference
        )
        return compute(retained, again), f"{where} was {retained!r} and is {again!r}"
    if where.endswith("model.arms"):
        retained, again = _merge_coincident_arms(retained), _merge_coincident_arms(again)
    before, after = parts_of(retained, where), parts_of(again, where)
    if before.keys() != after.keys():
        otherwise = "other keys" if isinstance(retained, dict) else "another length"
        return float("inf"), f"{where or 'the document'} has {otherwise}"
    pairs = (
        find_largest_difference(before[place], after[place], place.lstrip("."))
        for place in before
        if place != f"{where}.{DIGEST}"
    )
    return max(pairs, default=(0.0, ""), key=lambda item: item[0])


def _merge_coincident_arms(arms: Any) -> Any:
    """Return the arms of a solid in which those of one time constant are one arm.

    Only the sum of their stiffnesses is determined: a fit with more arms than the record shows may
    split it in any way, as rounding of the processor will have it.
    """
    keys = {"k", "tau", "b"}
    listed = isinstance(arms, list)
    if not listed or not all(isinstance(arm, dict) and keys <= arm.keys() for arm in arms):
        return arms
    merged: list[Any] = []
    for arm in arms:
        last = merged[-1] if merged else {"tau": None}
        if _compute_relative_difference(last["tau"], arm["tau"]) > verification_checks.SAME:
            merged.append(arm)
        else:
            merged[-1] = last | {key: last[key] + arm[key] for key in ("k", "b")}
    return merged


def _compute_relative_difference(text: Any, again: Any) -> float:
    """Return relative difference of two values; of texts that of the numbers in them, if any."""
    if repr(text) == repr(again):  # as NaN equals nothing
        return 0.0
    if _is_number(text) and _is_number(again) and text != again:
        number, scale = abs(Decimal(text) - Decimal(again)), max(abs(text), abs(again))
        # what is not finite is no rounding of what is
        return float(number / Decimal(scale)) if number.is_finite() else float("inf")
    if isinstance(text, str) and isinstance(again, str):
        same = _same_words(text, again)
    else:
        same = text == again and isinstance(text, bool) == isinstance(again, bool)
    return 0.0 if same else float("inf")


def _compute_gap_difference(gap: Any, again: Any) -> float:
    """Return the difference of two gaps, which are fractions: all digits of a small one round."""
    if _is_number(gap) and _is_number(again) and math.isfinite(gap) and math.isfinite(again):
        return float(abs(gap - again))
    return _compute_relative_difference(gap, again)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def same_page(content: bytes, again: bytes) -> bool:
    """Tell whether two pages say and show the same, but for how a last digit is rounded.

    The files inside a page are compared as what they are.
    """
    if content == again:
        return True
    try:
        before, after = (_decode_embedded_files(text.decode()) for text in (content, again))
    except ValueError:
        return False
    return _same_words(before, after)


def _decode_embedded_files(page: str) -> str:
    """Return a page with the files that its links hold as text."""
    return re.sub(
        r"(?<=;base64,)[A-Za-z0-9+/=]+",
        lambda link: base64.b64decode(link[0]).decode(errors="backslashreplace"),
        page,
    )


_NUMBER = re.compile(r"(-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)", re.ASCII)


def _same_words(text: str, again: str) -> bool:
    """Tell whether two texts differ in nothing but the last printed digit of their numbers."""
    if text == again:
        return True
    before, after = _NUMBER.split(text), _NUMBER.split(again)
    return before[::2] == after[::2] and all(
        # of 13 and 12.71 the finer counts: who prints fewer digits has not computed another number
        a == b or _is_rounded(a, b)
        for a, b in zip(before[1::2], after[1::2], strict=True)
    )


def _is_rounded(a: str, b: str) -> bool:
    """Tell whether two printed numbers may be one that was rounded twice: a count is never.

    >>> _is_rounded("12.70", "12.71"), _is_rounded("13", "12.71"), _is_rounded("13", "14")
    (True, False, False)
    """
    counted = a.lstrip("-").isdigit() and b.lstrip("-").isdigit()
    unit = min(_last_digit(a), _last_digit(b))
    return not counted and abs(float(a) - float(b)) <= _ROUNDED * unit


def _last_digit(number: str) -> float:
    """Return what one unit of the last digit of a printed number is.

    >>> _last_digit("12.70"), _last_digit("-3e-05"), _last_digit("40")
    (0.01, 1e-05, 1.0)
    """
    digits, _, exponent = number.lower().partition("e")
    return float(f"1e{int(exponent or 0) - len(digits.partition('.')[2])}")
