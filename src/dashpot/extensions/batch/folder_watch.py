"""Watch of a folder: each file is fitted once it has ceased to change."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, TypeAlias

from dashpot.base.errors import DashpotError, ReadError
from dashpot.base.progress import send_progress
from dashpot.extensions.batch.batch_run import (
    BatchJob,
    append_log_line,
    compute_missing_rows,
    lock_results_folder,
)
from dashpot.extensions.batch.executors import open_executor
from dashpot.extensions.batch.input_files import Entry, compute_file_hash, refuse_invalid_patterns
from dashpot.extensions.batch.lot import Lot
from dashpot.extensions.batch.parquet_parts import Task, make_tasks

UNCHANGED_SECONDS = 2.0
"""Seconds without a change after which a file is taken to be whole."""
POLL_PERIOD = 0.5
"""Seconds between two looks."""

_State: TypeAlias = tuple[int, ...]
"""Size, modification times and inode of a file, which change with its contents."""


def watch_batch(
    job: BatchJob,
    on_refresh: Callable[[Lot], None],
    *,
    wait: Callable[[float], object] = time.sleep,
    clock: Callable[[], float] = time.monotonic,
) -> Lot | None:
    """Run a batch again and again on the files that are still, until it is interrupted.

    The table is always that of a batch of the files present: a file that was replaced is fitted
    again, one that went loses its row, one that cannot be read yet gets another when it can.

    Parameters
    ----------
    job : BatchJob
    on_refresh : callable
        Takes the lot, each time that its rows are others.
    wait, clock : callable
        Waits for a number of seconds; returns the time, s.

    Returns
    -------
    Lot or None
        The last lot; None if there never was one.

    Raises
    ------
    ReadError, DataError, ExportError
        If a folder is missing, a choice makes no sense, or the results are in use.
    """
    for path in job.paths:
        if not Path(path).is_dir():
            raise ReadError(f"{path} is no folder; give the one into which the tests are written")
    open_executor(job.jobs, job.scheduler)
    refuse_invalid_patterns(job.label_pattern, job.pair)
    watched, lot = _Watched(job, clock), None
    with lock_results_folder(job.output):
        try:
            while True:
                lot = watched.update_lot(lot, on_refresh)
                wait(POLL_PERIOD)
        except KeyboardInterrupt:
            return lot


class _Watched:
    """State of the files as last read, and of the files of the rows."""

    def __init__(self, job: BatchJob, clock: Callable[[], float]) -> None:
        self._job, self._clock = job, clock
        self._stable_since: dict[str, tuple[_State, float]] = {}
        self._hashes: dict[str, tuple[_State, str]] = {}
        self._lot_keys: tuple[str, ...] = ()
        self._reported = ""
        self._idle_state: tuple[Any, str] | None = None

    def update_lot(self, lot: Lot | None, on_refresh: Callable[[Lot], None]) -> Lot | None:
        """Compute the missing rows of files that no longer change, if there are any."""
        states, idle_state = self._read_folder_states(), self._idle_state
        if idle_state is not None and idle_state[0] == states:
            send_progress(idle_state[1])
            return lot
        self._idle_state = None
        try:
            entries = self._job.entries(allow_none=True)
            tasks = self._tasks([entry for entry in entries if self._is_stable(entry)])
            keys = tuple(task.key for task in tasks)
            if keys and keys != self._lot_keys:
                lot = compute_missing_rows(self._job, tasks)
                on_refresh(lot)
                self._lot_keys = keys
                self._drop_missing(lot)
        except (DashpotError, OSError) as error:
            self._report(f"waiting: {error}")
        else:
            changing_count = len(entries) - len(tasks)
            text = f"watching: {len(tasks)} tests, {changing_count} still being written"
            send_progress(text)
            if (
                states is not None
                and not changing_count
                and keys == self._lot_keys
                and _are_all_read(tasks)
            ):
                self._idle_state = states, text
        return lot

    def _read_folder_states(self) -> tuple[object, ...] | None:
        """Return the states of all that decides the rows, in one pass; None if one is unknown.

        It is read before a look: a file that changes during the check differs at the next one.
        """
        job = self._job
        if job.manifest is not None or not _is_beside(job.pair):  # it may name files anywhere
            return None
        try:
            states = [state for path in job.paths for state in _scan_states(str(path), job.output)]
            return job.choices.calibration(), *states
        except (DashpotError, OSError, ValueError):
            return None

    def _is_stable(self, entry: Entry) -> bool:
        """Return whether none of its files has changed for a while."""
        return all(list(map(self._is_unchanged, (entry.file, *entry.hammer))))

    def _is_unchanged(self, file: str) -> bool:
        current, state = self._clock(), _get_file_state(file)
        if state is None:
            self._stable_since.pop(file, None)
            return False
        previous_state, unchanged_since = self._stable_since.setdefault(file, (state, current))
        if previous_state != state:
            self._stable_since[file] = state, current
            return False
        return current - unchanged_since >= UNCHANGED_SECONDS

    def _tasks(self, entries: list[Entry]) -> tuple[Task, ...]:
        return make_tasks(entries, self._job.choices, compute_hash=self._compute_hash)

    def _compute_hash(self, file: str) -> str:
        """Return the hash of its contents, computed once while it stays as it is."""
        state = _get_file_state(file)
        pair = self._hashes.get(file)
        if pair is not None and pair[0] == state:
            return pair[1]
        file_hash = compute_file_hash(file)
        if file_hash and state is not None:
            self._hashes[file] = state, file_hash
        return file_hash

    def _drop_missing(self, lot: Lot) -> None:
        """Take a file that changed under the fit as one that is being written."""
        rows = lot.table.filter(lot.table["outcome"] == "changed")
        for file in rows["file"]:
            self._stable_since.pop(file, None)
            self._lot_keys = ()

    def _report(self, message: str) -> None:
        send_progress(message)
        if message != self._reported:
            self._reported = message
            append_log_line(self._job.output, message)


def _is_beside(pair: str | None) -> bool:
    """Return whether the hammers of a test, if any, are files of the test's own folder."""
    text = (pair or "").replace("{stem}", "")
    return not any(character in text for character in ("{", "/", "\\", "**"))


def _are_all_read(tasks: Sequence[Task]) -> bool:
    """Return whether each file that is to be read could be read."""
    return all(task.entry.aside or all(task.hashes) for task in tasks)


def _scan_states(folder: str, results: Path) -> Iterator[tuple[object, ...]]:
    """Yield name and state of all files of a folder at any depth, following links."""
    paths: list[str] = []
    with os.scandir(folder) as items:
        for item in items:
            if item.is_dir(follow_symlinks=False):
                if not item.name.startswith(".") and Path(item).resolve() != results.resolve():
                    paths.append(item.path)
                yield (item.path,)
                continue
            yield item.name, *_pick_state(item.stat(follow_symlinks=False))
            if item.is_symlink():
                yield os.path.realpath(item.path), *(_get_file_state(item.path) or ())
    for path in paths:
        yield from _scan_states(path, results)


def _get_file_state(file: str) -> _State | None:
    try:
        return _pick_state(Path(file).stat())
    except (OSError, ValueError):
        return None


def _pick_state(stat: os.stat_result) -> _State:
    return stat.st_size, stat.st_mtime_ns, stat.st_ctime_ns, stat.st_ino
