"""Pool of worker processes on this machine that survives the death of one."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any, NamedTuple, TypeAlias

from dashpot.base.serialisation import to_plain_value
from dashpot.base.subprocesses import get_long_lived_env, interpreter
from dashpot.extensions.batch.batch_options import BatchOptions
from dashpot.extensions.batch.columns import make_empty_row
from dashpot.extensions.batch.parquet_parts import KEY, Task

Chunk: TypeAlias = tuple[Task, ...]
Rows: TypeAlias = list[dict[str, Any]]

MAX_LOST_WORKERS = 3
"""Workers that may die on a file before it is skipped."""


def count_processors() -> int:
    """Return how many this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Executor(NamedTuple):
    """Interface of an executor, which computes rows.

    Attributes
    ----------
    parallel_chunks : int
        Number of chunks computed in parallel.
    processor_count : int
        How many of them have a processor of their own.
    compute_chunks : callable
        Yields each chunk with its rows, as they are done.
    """

    parallel_chunks: int
    processor_count: int
    compute_chunks: Callable[[Sequence[Chunk], BatchOptions], Iterator[tuple[Chunk, Rows]]]


@contextmanager
def open_process_pool(jobs: int | None) -> Iterator[Executor]:
    """Yield an executor of processes of this machine; by default as many as processors."""
    process_count = jobs or count_processors()
    yield Executor(
        process_count,
        min(process_count, count_processors()),
        partial(_compute_chunks, process_count),
    )


def _compute_chunks(
    jobs: int, chunks: Sequence[Chunk], choices: BatchOptions
) -> Iterator[tuple[Chunk, Rows]]:
    """Yield rows of chunks; a file whose worker process dies gets a row with that reason."""
    chunk_queue: queue.SimpleQueue[Chunk] = queue.SimpleQueue()
    for chunk in chunks:
        chunk_queue.put(chunk)
    results: queue.SimpleQueue[tuple[Chunk, Rows] | BaseException] = queue.SimpleQueue()
    workers = [Worker(choices) for _ in range(min(jobs, len(chunks)))]
    stop_event = threading.Event()
    threads = [
        threading.Thread(
            target=_run_worker, args=(worker, chunk_queue, results, stop_event), daemon=True
        )
        for worker in workers
    ]
    for thread in threads:
        thread.start()
    try:
        for _ in chunks:
            result = results.get()
            if isinstance(result, BaseException):
                raise result
            yield result
    finally:
        stop_event.set()
        for worker, thread in zip(workers, threads, strict=True):
            worker.end()
            thread.join()
            worker.end()  # what the thread had just begun to start


def _run_worker(
    worker: Worker,
    chunk_queue: queue.SimpleQueue[Chunk],
    results: queue.SimpleQueue[tuple[Chunk, Rows] | BaseException],
    stop_event: threading.Event,
) -> None:
    try:
        while not stop_event.is_set():
            chunk = chunk_queue.get_nowait()
            results.put((chunk, [row for task in chunk for row in worker.rows(task, stop_event)]))
    except queue.Empty:
        worker.end()
    except BaseException as error:  # noqa: BLE001 -- it is raised where the rows are waited for
        results.put(error)


class Worker:
    """Worker process, started on first use in a folder, and restarted after its end."""

    def __init__(self, choices: BatchOptions, folder: str | None = None) -> None:
        self._choices, self._folder = choices, folder
        self._process: subprocess.Popen[bytes] | None = None

    def rows(self, task: Task, stop_event: threading.Event) -> Rows:
        """Return the row of one file, or one for each of its specimens."""
        for _ in range(MAX_LOST_WORKERS):
            if stop_event.is_set():
                break
            reply = self._answer(task)
            if reply.endswith(b"\n"):
                data: Rows = json.loads(reply)
                return [row | {KEY: task.key} for row in data]
            self.end()
        row_of_dead_worker = make_empty_row(task.entry, task.hashes[0], self._choices) | {
            "outcome": "died",
            "reason": f"the process that read it died {MAX_LOST_WORKERS} times: it may need more "
            "memory than there is; run it again with fewer --jobs, or look at it with dashpot "
            "inspect",
            KEY: task.key,
        }
        return [row_of_dead_worker]

    def _answer(self, task: Task) -> bytes:
        """Return the line of an answer; cut short where the process died."""
        try:
            process = self._start_process()
            assert process.stdin is not None and process.stdout is not None  # noqa: PT018, S101
            question = {"entry": to_plain_value(task.entry), "hashes": task.hashes}
            process.stdin.write(json.dumps(question).encode() + b"\n")
            process.stdin.flush()
            return process.stdout.readline()
        except (BrokenPipeError, ConnectionError):
            return b""

    def _start_process(self) -> subprocess.Popen[bytes]:
        if self._process is None:
            self._process = subprocess.Popen(  # noqa: S603 -- this interpreter, our module
                interpreter("dashpot.extensions.batch.rows_worker"),
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=get_long_lived_env(),
                cwd=self._folder,
            )  # fmt: skip
            assert self._process.stdin is not None  # noqa: S101
            self._process.stdin.write(json.dumps(to_plain_value(self._choices)).encode() + b"\n")
        return self._process

    def end(self) -> None:
        """End the process, if there is one."""
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            process.wait()
            for pipe in (process.stdin, process.stdout):
                if pipe is not None:
                    try:
                        pipe.close()
                    except OSError:  # what it never read
                        continue
