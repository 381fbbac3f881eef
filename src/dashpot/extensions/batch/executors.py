"""Choice of the executor of a batch: this machine or a cluster."""

from __future__ import annotations

from contextlib import AbstractContextManager

from dashpot.base.errors import DataError
from dashpot.extensions.batch.process_pool import Executor, open_process_pool


def open_executor(jobs: int | None, scheduler: str | None) -> AbstractContextManager[Executor]:
    """Return processes of this machine, or the workers of a cluster.

    Raises
    ------
    DataError
        If both are requested, or no number of processes.
    """
    if jobs is not None and jobs < 1:
        raise DataError(f"jobs = {jobs}; expected a number of processes >= 1")
    if scheduler is None:
        return open_process_pool(jobs)
    if jobs is not None:
        raise DataError("--jobs are processes of this machine; a cluster (--scheduler) has its own")
    from dashpot.extensions.batch.cluster import connect_to_cluster  # dask takes a second to import

    return connect_to_cluster(scheduler)
