"""Run of a batch of tests to one table; a second run adds the missing rows."""

from __future__ import annotations

import datetime as dt
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

from dashpot.base import dataclass
from dashpot.base.errors import ExportError
from dashpot.base.file_writing import open_exclusive_lock
from dashpot.base.option_fields import Method
from dashpot.base.progress import send_progress
from dashpot.base.serialisation import Serialisable
from dashpot.base.units import Quantity, convert_to_si
from dashpot.datamodel.machine import Machine
from dashpot.extensions.batch.batch_options import BatchOptions, convert_quantities
from dashpot.extensions.batch.executors import open_executor
from dashpot.extensions.batch.input_files import LOG, Entry, find_entries
from dashpot.extensions.batch.limits import Limits
from dashpot.extensions.batch.lot import Lot
from dashpot.extensions.batch.parquet_parts import (
    KEY,
    SMALL_PART,
    Task,
    build_row_frame,
    collect_table,
    create_results_folder,
    import_polars,
    list_done_keys,
    make_tasks,
    write_part,
)
from dashpot.extensions.batch.process_pool import Executor, Rows
from dashpot.extensions.batch.table_row import make_row
from dashpot.reading.read_options import ReadOptions

CHUNK = SMALL_PART
"""Files of a chunk, the largest loss of an interrupted run for each process."""
_LAST_CHUNK_FILES = 5
"""Smallest number of files of the last chunks: each part takes 3 ms to write."""
_LOCK = ".lock"
_TIMED_TESTS = 3
"""Tests that a dry run times."""


@dataclass(frozen=True)
class BatchJob:
    """Job of a batch: its tests, its executor and its statistics.

    The fields are the arguments of :func:`batch`, and two more: the quantity that the page shows,
    if one was requested, and the limits of acceptance.
    """

    paths: tuple[str | Path, ...]
    output: Path
    choices: BatchOptions
    label_pattern: str | None = None
    manifest: str | Path | None = None
    pair: str | None = None
    jobs: int | None = None
    scheduler: str | None = None
    quantity: str = ""
    limits: tuple[Limits, ...] = ()

    def entries(self, *, allow_none: bool = False) -> tuple[Entry, ...]:
        """Return the tests found; an empty list is an error unless `allow_none` is set."""
        return find_entries(
            self.paths, manifest=self.manifest, label_pattern=self.label_pattern, pair=self.pair,
            output_folder=self.output, allow_none=allow_none,
        )  # fmt: skip

    def tasks(self) -> tuple[Task, ...]:
        """Return the rows that are requested."""
        send_progress("finding the files")
        entries = self.entries()
        send_progress(f"hashing the files of {len(entries)} tests")
        return make_tasks(entries, self.choices)


@dataclass(frozen=True)
class BatchPlan(Serialisable):
    """Plan of a batch: number of files, expected time and processes.

    Attributes
    ----------
    files, done : int
        Number of files, and of those whose rows exist already.
    chunks : int
        Number of chunks to compute.
    seconds : float
        Expected time, estimated from the first few tests on this machine; 0 if no row is missing.
    jobs : int
        Number of parallel processes.
    """

    schema = "dashpot/batch-plan@1"

    files: int
    done: int
    chunks: int
    seconds: float
    jobs: int


def batch(
    paths: Sequence[str | Path] | str | Path,
    *,
    output: str | Path | None = None,
    arms: int | Literal["auto"] = "auto",
    method: Method = "full",
    quick: bool = False,
    mass: Quantity | None = None,
    seals: float = 1.0,
    at: Quantity | Sequence[Quantity] = (),
    compression: Quantity | Sequence[Quantity] = (),
    length: Quantity | None = None,
    radius: Quantity | None = None,
    machine: Machine | None = None,
    label_pattern: str | None = None,
    manifest: str | Path | None = None,
    pair: str | None = None,
    joint: bool = False,
    jobs: int | None = None,
    scheduler: str | None = None,
    options: ReadOptions | None = None,
    impact_options: ReadOptions | None = None,
) -> Lot:
    r"""Fit every test in files, folders and patterns, one row each.

    Each test is fitted separately by its kind, as by ``dashpot fit``: a ramp and hold, a creep
    test, a dynamic sweep, a master curve, a relaxation modulus. A paired hammer test is compared
    with its prediction. A file without a fit, or that cannot be read, is a row with the reason.
    Rows are stored in `output` as Parquet parts by the hash of their inputs: configuration,
    version, contents; a second run, after an interrupted first one, computes only the missing rows
    and gives the same table.

    Parameters
    ----------
    paths : path or sequence of path
    output : path, optional
        Folder of the parts and of the log; without it nothing is written.
    arms, method
        As in :func:`~dashpot.fitting.relaxation.fit`.
    quick : bool
        The optimum alone, without errors, checks and verdict; `arms` must then be a number.
    mass : float, optional
        Mass of a block, kg, on so many `seals`: the table then has its frequency and damping ratio.
        The manifest may give each test its own.
    at : float or sequence of float
        Frequencies, Hz: the table then has storage and loss stiffness and loss factor there.
    compression : float or sequence of float
        Compression of the seals, m, for these and for the stiffness at the end of the hold: of
        small vibration about it. By default each test's own depth. The first is the nominal one of
        load deflection.
    length : float, optional
        Contact length of each specimen, m: load deflection is then per 100 mm.
    radius : float, optional
        Radius of an indenter's tip, m; `mass` is then the indenter's.
    machine : Machine, optional
        On which the tests were made; the manifest may give each test its own.
    label_pattern : str, optional
        A regular expression for the path, whose groups are lot, seal, repeat, operator and date:
        ``r"lot(\w+)_seal(\d+)_rep(\d+)"``; named groups may be in any order.
    manifest : path, optional
        CSV or TOML with the columns file, lot, seal, repeat, operator, date, temperature, mass,
        hammer, hammer_temperature, machine.
    pair : str, optional
        The pattern of the hammer's files of a test, seen from its folder:
        ``"{stem}_hammer*.csv"``, with {lot}, {seal} and {repeat} too. They are no rows of their
        own.
    joint : bool
        Fit a ramp and hold and its hammer together.
    jobs : int, optional
        Number of parallel processes; by default as many as there are processors.
    scheduler : str, optional
        Address of a cluster of dask.distributed, ``"tcp://host:8786"``, whose workers make the
        rows: the same dashpot is installed there, and the files have the same paths.
    options, impact_options : ReadOptions, optional
        Reading options of the tests' files, and of the hammer's.

    Raises
    ------
    ReadError, DataError
        If a path names nothing, or a choice makes no sense. No file's contents raise.
    ExportError
        If `output` contains other Parquet files, or polars is missing.
    """
    choices = BatchOptions(
        arms,
        method,
        quick,
        convert_to_si(mass, "mass"),
        seals,
        options or ReadOptions(),
        impact_options or ReadOptions(),
        joint,
        convert_quantities(at, "frequency"),
        convert_quantities(compression, "length"),
        convert_to_si(length, "length"),
        convert_to_si(radius, "length"),
        machine or Machine(),
    )
    path_list = (paths,) if isinstance(paths, str | Path) else tuple(paths)
    with _make_results_folder(output) as folder:
        return run_batch(
            BatchJob(path_list, folder, choices, label_pattern, manifest, pair, jobs, scheduler)
        )


def run_batch(job: BatchJob) -> Lot:
    """Make the rows of a batch that are missing, and return all."""
    import_polars()
    open_executor(job.jobs, job.scheduler)  # refuses what makes no sense before anything is written
    tasks = job.tasks()
    with lock_results_folder(job.output):
        return compute_missing_rows(job, tasks)


@contextmanager
def lock_results_folder(folder: Path) -> Iterator[None]:
    """Make the folder of the results, and keep others out of it."""
    create_results_folder(folder)
    with open_exclusive_lock(folder / _LOCK, str(folder)):
        yield


def compute_missing_rows(job: BatchJob, tasks: Sequence[Task]) -> Lot:
    """Compute the missing ones of the requested rows, in a locked folder."""
    missing = _select_missing_tasks(tasks, job.output)
    if missing:
        try:
            with open_executor(job.jobs, job.scheduler) as executor:
                _compute(missing, job.choices, job.output, executor)
        except (KeyboardInterrupt, OSError) as error:
            made_now = len(missing) - len(_select_missing_tasks(missing, job.output))
            text = (
                f"{made_now} of {len(missing)} rows are made and kept in {job.output}, and the "
                "same command goes on from there"
            )
            if isinstance(error, OSError):
                raise ExportError(f"{job.output}: {error.strerror or error}: {text}") from None
            raise KeyboardInterrupt(f"interrupted: {text}") from None
    frame = collect_table(job.output, (task.key for task in tasks))
    made_keys = [task.key for task in missing]
    return Lot(frame, frame.filter(import_polars().col(KEY).is_in(made_keys)).height)


def plan_batch(job: BatchJob) -> BatchPlan:
    """Return the work of :func:`batch` and its expected time; write nothing.

    Raises
    ------
    ReadError, DataError, ExportError
        As :func:`batch`.
    """
    import_polars()
    executor, tasks = open_executor(job.jobs, job.scheduler), job.tasks()
    missing = _select_missing_tasks(tasks, job.output)
    with executor as running_executor:
        chunks = len(_split_into_chunks(missing, running_executor.parallel_chunks))
    seconds_per_row = _estimate_seconds_per_row(missing[:_TIMED_TESTS], job.choices)
    seconds = seconds_per_row * len(missing) / min(running_executor.processor_count, max(chunks, 1))
    return BatchPlan(
        len(tasks), len(tasks) - len(missing), chunks, seconds, running_executor.parallel_chunks
    )


def _estimate_seconds_per_row(sample_tasks: Sequence[Task], choices: BatchOptions) -> float:
    if not sample_tasks:
        return 0.0
    make_row(
        sample_tasks[0].entry, sample_tasks[0].hashes, choices
    )  # what is imported once does not count
    start_time = time.perf_counter()
    for task in sample_tasks:
        make_row(task.entry, task.hashes, choices)
    return (time.perf_counter() - start_time) / len(sample_tasks)


@contextmanager
def _make_results_folder(output: str | Path | None) -> Iterator[Path]:
    if output is not None:
        yield Path(output)
        return
    with tempfile.TemporaryDirectory() as folder:
        yield Path(folder)


def _select_missing_tasks(tasks: Sequence[Task], folder: Path) -> list[Task]:
    done_keys = list_done_keys(folder) if folder.is_dir() else set()
    return [task for task in tasks if task.key not in done_keys]


def _split_into_chunks(missing: Sequence[Task], jobs: int) -> list[tuple[Task, ...]]:
    """Smaller ones towards the end, so that no process waits long for the last of another."""
    task_groups: list[tuple[Task, ...]] = []
    first, chunk_limit = 0, max(1, len(missing) // jobs)
    while first < len(missing):
        remaining_count = len(missing) - first
        size = min(CHUNK, max(_LAST_CHUNK_FILES, remaining_count // (2 * jobs)), chunk_limit)
        task_groups.append(tuple(missing[first : first + size]))
        first += size
    return task_groups


def _compute(
    missing: Sequence[Task], choices: BatchOptions, folder: Path, executor: Executor
) -> None:
    chunks, done_count, start_time = (
        _split_into_chunks(missing, executor.parallel_chunks),
        0,
        time.monotonic(),
    )
    send_progress(f"{len(missing)} tests in {len(chunks)} chunks")
    first = (0, 0.0)
    for number, (chunk, rows) in enumerate(executor.compute_chunks(chunks, choices), start=1):
        path = write_part(folder, build_row_frame(rows, choices))
        done_count += len(chunk)
        progress = done_count, max(time.monotonic() - start_time, 1e-6)
        first = progress if number == 1 else first
        tests_per_second = estimate_rate(
            first, progress, number, min(executor.parallel_chunks, len(chunks))
        )
        text = f"{done_count} of {len(missing)} tests, {tests_per_second:.1f} tests/s"
        if done_count < len(missing):
            text += f", {(len(missing) - done_count) / tests_per_second:.0f} s left"
        send_progress(text)
        append_log_line(folder, f"{path.name} {_format_outcome_counts(rows)}; {text}")


def estimate_rate(
    first: tuple[int, float], progress: tuple[int, float], chunks: int, parallel_chunks: int
) -> float:
    """Return tests in a second, by how many were done, and after how many s, at two chunks.

    In the first round of `parallel_chunks` chunks, the unfinished ones are counted as nearly done;
    after it, the start of the workers is not counted.
    """
    if chunks <= parallel_chunks:
        return progress[0] * parallel_chunks / chunks / progress[1]
    return (progress[0] - first[0]) / max(progress[1] - first[1], 1e-6)


def append_log_line(folder: Path, message: str) -> None:
    """Add a line to the log."""
    with (folder / LOG).open("a", encoding="utf-8") as log:
        log.write(f"{dt.datetime.now(dt.UTC).isoformat(timespec='seconds')} {message}\n")


def _format_outcome_counts(rows: Rows) -> str:
    counts: Counter[Any] = Counter(row["outcome"] for row in rows)
    return ", ".join(f"{count} {outcome}" for outcome, count in counts.most_common())
