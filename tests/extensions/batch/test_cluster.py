"""A cluster makes the rows that this machine makes, though one of its workers is killed."""

from __future__ import annotations

import json
import os
import signal
import socket
from io import BytesIO
from pathlib import Path

import pytest

from dashpot.base.errors import DataError
from dashpot.base.serialisation import to_plain_value
from dashpot.base.version import __version__
from dashpot.extensions.batch import batch_run
from dashpot.extensions.batch.batch_options import BatchOptions
from dashpot.extensions.batch.batch_run import batch
from dashpot.extensions.batch.cluster_worker import make_rows, stop_idle_workers
from dashpot.extensions.batch.input_files import Entry
from dashpot.extensions.batch.parquet_parts import make_tasks
from dashpot.reading.write import write_relaxation
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.demo_seals import PAPER

QUICK = {"arms": 1, "quick": True}
CHOICES = BatchOptions(**QUICK)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Six short tests and a file that is none, named as seen from here."""
    monkeypatch.chdir(tmp_path)
    Path("tests").mkdir()
    for i in range(6):
        made = simulate_relaxation((1 + 0.01 * i) * PAPER, hold_time=3.0, seed=i)
        Path(f"tests/{i}.csv").write_text(write_relaxation(made.test))
    Path("tests/junk.csv").write_text("junk\n")
    return "tests"


def as_bytes(table):
    written = BytesIO()
    table.write_parquet(written)
    return written.getvalue()


@pytest.mark.once
@pytest.mark.filterwarnings("ignore")  # of dask, beside processes that are killed
def test_a_cluster_makes_the_same_table_though_a_worker_is_killed(folder, tmp_path, monkeypatch):
    distributed = pytest.importorskip("distributed")
    whole = batch(folder, jobs=1, **QUICK).table
    monkeypatch.setattr(batch_run, "CHUNK", 1)
    killed = []

    def kill_worker(by):
        def compute_chunks(chunks, choices):
            for result in by.computed(chunks, choices):
                if not killed:
                    killed.append(next(iter(cluster.workers.values())).pid)
                    os.kill(killed[0], signal.SIGKILL)
                yield result

        return by._replace(computed=compute_chunks)

    compute = batch_run._compute
    monkeypatch.setattr(batch_run, "_compute", lambda *of: compute(*of[:-1], kill_worker(of[-1])))
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50
    ) as cluster:
        lot = batch(folder, output="lot", scheduler=cluster.scheduler_address, **QUICK)
    assert killed
    assert as_bytes(lot.table) == as_bytes(whole)
    assert len(list(Path("lot").glob("part-*.parquet"))) == 7
    assert batch(folder, output="lot", jobs=1, **QUICK).computed == 0


def run_worker(entries, **changes):
    """What a worker of a cluster answers."""
    how = {"choices": json.dumps(to_plain_value(CHOICES)), "folder": ".", "version": __version__}
    return make_rows(
        json.dumps([task.serialised for task in make_tasks(entries, CHOICES)]), **(how | changes)
    )


def test_cluster_worker_refuses_another_version_or_folder(folder, tmp_path):
    here = [Entry("tests/junk.csv")]
    with pytest.raises(DataError, match="a worker of the cluster has dashpot"):
        run_worker(here, version="0.0.1")
    with pytest.raises(DataError, match="such as on a shared drive"):
        run_worker(here, folder=str(tmp_path / "elsewhere"))
    with pytest.raises(DataError, match="such as on a shared drive"):
        run_worker(
            [Entry(str(Path("tests/0.csv").absolute()), hammer=("tests/1.csv",))], folder="/"
        )
    (row,) = json.loads(run_worker(here))
    stop_idle_workers()
    assert (row["file"], row["outcome"]) == ("tests/junk.csv", "refused")


def test_batch_refuses_an_unreachable_scheduler_immediately(folder):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        nobody = f"tcp://127.0.0.1:{taken.getsockname()[1]}"
        for address in (nobody, "127.0.0.1", "tcp://[", "foo://x:1"):
            with pytest.raises(DataError, match="no scheduler answers there"):
                batch(folder, scheduler=address, **QUICK)
    with pytest.raises(DataError, match="--jobs are processes of this machine"):
        batch(folder, scheduler=nobody, jobs=2, **QUICK)
