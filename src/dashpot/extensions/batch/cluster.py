"""Rows of a batch computed on an existing dask.distributed cluster."""

from __future__ import annotations

import json
import logging
import socket
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from dashpot.base.errors import DashpotError, DataError, ExportError
from dashpot.base.serialisation import to_plain_value
from dashpot.base.version import __version__
from dashpot.extensions.batch.batch_options import BatchOptions
from dashpot.extensions.batch.cluster_worker import make_rows, stop_idle_workers
from dashpot.extensions.batch.process_pool import Chunk, Executor, Rows
from dashpot.registry import format_install_command

SCHEDULER_TIMEOUT = 10.0
"""Seconds for the scheduler to answer, and for a first worker to be there."""
_QUEUED_CHUNKS = 2
"""Chunks that wait for each thread of a worker; more would only fill the scheduler."""


@contextmanager
def connect_to_cluster(address: str) -> Iterator[Executor]:
    """The workers behind a scheduler.

    Raises
    ------
    DataError
        If no scheduler answers at that address, or it has no workers.
    ExportError
        If dask.distributed is missing.
    """
    try:
        import distributed
    except ImportError:
        advice = format_install_command("batch,cluster")
        raise ExportError(
            "a cluster is one of dask.distributed, which is not installed; install it with: "
            f"{advice}"
        ) from None
    with _silence_dask(), closing(_open_client(distributed, address)) as client:
        thread_count = sum(client.nthreads().values())
        yield Executor(
            thread_count, thread_count, partial(_compute_chunks, distributed, client, address)
        )


@contextmanager
def _silence_dask() -> Iterator[None]:
    """Silence dask's log: an error is reported in one sentence."""
    logs = [logging.getLogger(name) for name in ("distributed", "distributed.client")]
    levels = [log.level for log in logs]
    for logger in logs:
        logger.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for logger, level in zip(logs, levels, strict=True):
            logger.setLevel(level)


def _open_client(distributed: Any, address: str) -> Any:
    try:
        # a client that finds nobody would try on, and again when it is collected
        parts = urlsplit(address)
        socket.create_connection((parts.hostname or "", parts.port or 0), SCHEDULER_TIMEOUT).close()
        client = distributed.Client(
            address, timeout=SCHEDULER_TIMEOUT, set_as_default=False, name="dashpot-batch"
        )
    except (OSError, ValueError, TypeError) as error:
        error_lines = str(error).splitlines() or [type(error).__name__]
        raise DataError(
            f"--scheduler {address}: no scheduler answers there ({error_lines[0]}); give the "
            "address that dask scheduler prints, such as tcp://host:8786"
        ) from None
    try:
        client.wait_for_workers(1, timeout=SCHEDULER_TIMEOUT)
    except TimeoutError:
        client.close()
        raise DataError(
            f"--scheduler {address}: the scheduler has no worker; start one: dask worker {address}"
        ) from None
    return client


def _compute_chunks(
    distributed: Any,
    client: Any,
    address: str,
    chunks: Sequence[Chunk],
    choices: BatchOptions,
) -> Iterator[tuple[Chunk, Rows]]:
    common = {
        "choices": json.dumps(to_plain_value(choices)),
        "folder": str(Path.cwd()),
        "version": __version__,
    }
    chunk_iterator, requested_tasks = iter(chunks), dict[str, Chunk]()

    def send_chunk(chunk: Chunk) -> Any:
        tasks = json.dumps([task.serialised for task in chunk])
        future = client.submit(make_rows, tasks, **common, pure=False)
        requested_tasks[future.key] = chunk
        return future

    queue_length = _QUEUED_CHUNKS * sum(client.nthreads().values())
    first = list(map(send_chunk, islice(chunk_iterator, queue_length)))
    running = distributed.as_completed(first, loop=client.loop)
    try:
        for future in running:
            chunk = requested_tasks.pop(future.key)
            yield chunk, _get_rows(future, address)
            next_chunk = next(chunk_iterator, None)
            if next_chunk is not None:
                running.add(send_chunk(next_chunk))
        client.run(stop_idle_workers)
    finally:
        client.cancel(list(running.futures))


def _get_rows(future: Any, address: str) -> Rows:
    try:
        data: Rows = json.loads(future.result())
    except DashpotError:
        raise
    except Exception as error:  # noqa: BLE001 -- whatever a worker raised
        error_lines = str(error).splitlines() or [""]
        raise DataError(
            f"--scheduler {address}: a chunk was not made ({type(error).__name__}: "
            f"{error_lines[0]}); the "
            "rows that were made are kept, and the same command goes on from there. Scheduler and "
            f"workers need dashpot {__version__} as it is here, and memory for a test"
        ) from None
    return data
