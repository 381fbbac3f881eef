"""History of a project: one line per operation, each with the hash of the previous line.

``history.jsonl`` only grows, by one write for each line, and the hash of a line is that of its
bytes up to the hash. ``history.head`` says how many lines were written and the hash of the last, so
that a line cut off the end is noticed; while a line is written it announces the hash of that one.
"""

from __future__ import annotations

import getpass
import hashlib
import json
import os
import re
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from dashpot.base import dataclass, field, fields
from dashpot.base.errors import DataError, ReadError
from dashpot.base.file_writing import write_atomic
from dashpot.base.version import software

GENESIS = "0" * 64
"""Hash of the line before the first."""
_HEAD = re.compile(rb"(0|[1-9]\d{0,17}) ([0-9a-f]{64})\n(?:[1-9]\d{0,17} ([0-9a-f]{64})\n)?")


@dataclass(frozen=True)
class FileEntry:
    """File of the project as a line names it: its path, and the SHA-256 of its bytes."""

    file: str
    sha256: str


@dataclass(frozen=True)
class HistoryLine:
    """Line of the history: one operation.

    Attributes
    ----------
    operation, time, user : str
        Command, time (UTC) and user.
    job : dict
        The document of the :class:`~dashpot.workflow.job.Job`.
    inputs, outputs : tuple of FileEntry
    software : dict
        Version by name.
    previous, hash : str
        Hash of the line before, and of the bytes of this one before its hash.
    line : int
        Counted from 1.
    """

    operation: str
    time: str
    user: str
    job: dict[str, Any]
    inputs: tuple[FileEntry, ...]
    outputs: tuple[FileEntry, ...]
    software: dict[str, str]
    previous: str
    hash: str
    line: int


@dataclass(frozen=True)
class History:
    """Contents of ``history.jsonl``.

    Attributes
    ----------
    lines : tuple of HistoryLine
        The whole ones.
    is_intact : tuple of bool
        Whether each line is unchanged and in its place.
    incomplete_line : bytes
        An incomplete line after them.
    recorded_count : int
        Number of written lines, by ``history.head``.
    head : str
        Hash of the last written line, by ``history.head``; empty if unknown.
    announced_hash : str
        Hash of a line that was about to be written, by ``history.head``.
    """

    lines: tuple[HistoryLine, ...] = ()
    is_intact: tuple[bool, ...] = ()
    incomplete_line: bytes = b""
    recorded_count: int = 0
    head: str = ""
    announced_hash: str = ""
    raw_lines: tuple[bytes, ...] = field(default=(), repr=False)

    @property
    def last(self) -> str:
        """The hash of the last line."""
        return self.lines[-1].hash if self.lines else GENESIS

    @property
    def is_truncated(self) -> bool:
        """Whether lines were cut off its end."""
        has_all_lines = self.recorded_count <= len(self.lines)
        return not (has_all_lines and self.head in {"", *(line.hash for line in self.lines)})

    @property
    def has_matching_head(self) -> bool:
        """Whether ``history.head`` agrees with the last line."""
        last = (len(self.lines), self.last)
        parts = (self.recorded_count, self.head)
        return not self.lines or last in (parts, (self.recorded_count + 1, self.announced_hash))


def get_log_path(folder: Path) -> Path:
    """Return the append-only log."""
    return folder / "history.jsonl"


def get_head_path(folder: Path) -> Path:
    """Return the file with the number of written lines and the hash of the last."""
    return folder / "history.head"


def read_history(folder: Path) -> History:
    """Return the history of the project in `folder`; an empty one if there is no file.

    Raises
    ------
    ReadError
        If a line is not one that dashpot writes.
    """
    try:
        *raw_lines, unfinished_line = get_log_path(folder).read_bytes().split(b"\n")
    except FileNotFoundError:
        raw_lines, unfinished_line = [], b""
    if unfinished_line and _is_whole(unfinished_line, raw_lines):  # only its line end is lost
        raw_lines, unfinished_line = [*raw_lines, unfinished_line], b""
    lines = [_parse_line(text, number) for number, text in enumerate(raw_lines, start=1)]
    previous_hashes = [GENESIS, *(line.hash for line in lines)]
    is_intact = tuple(
        _has_valid_hash(text, line.hash) and (line.previous, line.line) == (previous, number)
        for number, (line, text, previous) in enumerate(
            zip(lines, raw_lines, previous_hashes, strict=False), 1
        )
    )
    return History(tuple(lines), is_intact, unfinished_line, *_read_head(folder), tuple(raw_lines))


def append(folder: Path, content: dict[str, Any]) -> str:
    """Add one line, with the hash of the line before it, in one write; return its hash.

    Raises
    ------
    DataError
        If lines were cut off the end of the history.
    """
    history = read_history(folder)
    if history.is_truncated:
        raise DataError(
            f"{get_log_path(folder)} has {len(history.lines)} lines where "
            f"{history.recorded_count} were written; put the file back from a copy before "
            "anything is added to it"
        )
    file = get_log_path(folder)
    all_lines = b"".join(line + b"\n" for line in history.raw_lines)
    # an operation that was cut short never happened; its half line must not stay
    if file.exists() and file.read_bytes() != all_lines:
        write_atomic(file, all_lines)
    entry = {
        "line": len(history.lines) + 1,
        "time": datetime.now(UTC).isoformat(timespec="seconds"),
        "user": _get_user(),
        **content,
        "software": software(),
        "previous": history.last,
    }
    text, line_hash = format_hashed_line(entry)
    head = get_head_path(folder)
    sentence = f"{len(history.lines)} {history.last}\n"
    write_atomic(head, f"{sentence}{entry['line']} {line_hash}\n".encode())
    with file.open("ab") as log:
        log.write(text + b"\n")
        log.flush()
        os.fsync(log.fileno())
    write_atomic(head, f"{entry['line']} {line_hash}\n".encode())
    return line_hash


def format_hashed_line(entry: dict[str, Any]) -> tuple[bytes, str]:
    """Return a line as it is written, and its hash: that of its bytes before the hash."""
    body = json.dumps({key: value for key, value in entry.items() if key != "hash"}).encode()[:-1]
    line_hash = sha256(body)
    return body + _format_line_end(line_hash), line_hash


def _format_line_end(line_hash: str) -> bytes:
    return f', "hash": "{line_hash}"}}'.encode()


def _has_valid_hash(text: bytes, line_hash: str) -> bool:
    """Return whether the bytes of a line agree with its hash."""
    if (
        text.endswith(_format_line_end(line_hash))
        and sha256(text.removesuffix(_format_line_end(line_hash))) == line_hash
    ):
        return True
    return _has_valid_old_hash(text, line_hash)


def _has_valid_old_hash(text: bytes, line_hash: str) -> bool:
    """Return the same for a line of the second edition, hashed by its sorted content."""
    entry = json.loads(text)
    entry_without_hash = {key: value for key, value in entry.items() if key != "hash"}
    sorted_text = json.dumps(entry_without_hash, sort_keys=True, ensure_ascii=False)
    is_same = sha256(sorted_text.encode("utf-8", "surrogatepass")) == line_hash
    return is_same and json.dumps(entry).encode() == text


def sha256(content: bytes) -> str:
    """Return the SHA-256 of bytes, hexadecimal."""
    return hashlib.sha256(content).hexdigest()


def _is_whole(text: bytes, previous_lines: list[bytes]) -> bool:
    try:
        entry, last = (
            json.loads(text),
            json.loads(previous_lines[-1]) if previous_lines else {"hash": GENESIS},
        )
        is_unchanged = _has_valid_hash(text, str(entry["hash"]))
        return bool(is_unchanged and entry["previous"] == last["hash"])
    except (ValueError, TypeError, KeyError, RecursionError):
        return False


def _parse_line(text: bytes, number: int) -> HistoryLine:
    import msgspec

    try:
        entry = json.loads(text)
        line = msgspec.convert(entry, type=HistoryLine)
        unknown_keys = entry.keys() - {attribute.name for attribute in fields(HistoryLine)}
        if unknown_keys:
            raise ValueError(f"it has {min(unknown_keys)!r}")
        return line
    except (msgspec.ValidationError, ValueError, RecursionError) as error:
        raise ReadError(
            f"line {number} of history.jsonl is none that dashpot writes: it was changed ({error})"
        ) from None


def _read_head(folder: Path) -> tuple[int, str, str]:
    """Return the number of lines, the hash of the last, and that of a line about to be written."""
    try:
        match = _HEAD.fullmatch(get_head_path(folder).read_bytes())
    except FileNotFoundError:
        return 0, "", ""
    if match is None:
        raise ReadError(f"{get_head_path(folder)} is not as dashpot writes it: it was changed")
    count, head, announced_hash = (part.decode() for part in match.groups(b""))
    return int(count), head, announced_hash


def _get_user() -> str:
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return "unknown"
