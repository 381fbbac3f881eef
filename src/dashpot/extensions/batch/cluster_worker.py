"""Task of a cluster worker: a chunk of rows, computed in local subprocesses.

They are kept for the next chunk. So a file that costs a process its life costs the worker nothing,
the worker's environment (its threads, dask's limit for giving memory back) does not matter, and
rows are made in the folder of whoever asked, without moving the worker out of its own.
"""

from __future__ import annotations

import json
import threading
from pathlib import Path

from dashpot.base.errors import DataError
from dashpot.base.version import __version__
from dashpot.extensions.batch.batch_options import BatchOptions
from dashpot.extensions.batch.parquet_parts import Task
from dashpot.extensions.batch.process_pool import Worker

WAITING_TIME = 60.0
"""Time that an idle process waits for the next chunk, s."""

_idle: list[tuple[tuple[str, str], Worker]] = []
_lock = threading.Lock()


def make_rows(tasks: str, *, choices: str, folder: str, version: str) -> str:
    """Return the rows of a chunk, as JSON.

    Raises
    ------
    DataError
        If another dashpot is installed here, or a file is not where it was for whoever asked.
    """
    if version != __version__:
        raise DataError(
            f"a worker of the cluster has dashpot {__version__}, and this is {version}: install "
            "the same on every worker"
        )
    chunk = [Task(load) for load in json.loads(tasks)]
    _refuse_unreachable(chunk, Path(folder))
    key = (choices, folder)
    worker = _pop_idle_worker(key) or Worker(BatchOptions.from_plain(json.loads(choices)), folder)
    try:
        rows = (row for task in chunk for row in worker.rows(task, threading.Event()))
        return json.dumps(list(rows))
    finally:
        _add_idle_worker(key, worker)


def stop_idle_workers() -> None:
    """End the processes that wait."""
    with _lock:
        idle_workers, _idle[:] = list(_idle), []
    for _, worker in idle_workers:
        worker.end()


def _refuse_unreachable(chunk: list[Task], folder: Path) -> None:
    """Refuse a file that was hashed and is not there, which would stay as a row."""
    for task in chunk:
        entry = task.entry
        files = zip((entry.file, *entry.hammer), task.hashes, strict=True)
        for file, sha256 in files:
            if sha256 and not (folder / file).is_file():
                raise DataError(
                    f"{folder / file} is not there for a worker of the cluster: the files of a "
                    "batch must have the same paths on every worker, such as on a shared drive"
                )


def _pop_idle_worker(key: tuple[str, str]) -> Worker | None:
    with _lock:
        idle_index = next((i for i, (worker_key, _) in enumerate(_idle) if worker_key == key), None)
        return None if idle_index is None else _idle.pop(idle_index)[1]


def _add_idle_worker(key: tuple[str, str], worker: Worker) -> None:
    with _lock:
        _idle.append((key, worker))
    timer = threading.Timer(WAITING_TIME, _stop_idle_worker, (key, worker))
    timer.daemon = True
    timer.start()


def _stop_idle_worker(key: tuple[str, str], worker: Worker) -> None:
    with _lock:
        if (key, worker) not in _idle:
            return
        _idle.remove((key, worker))
    worker.end()
