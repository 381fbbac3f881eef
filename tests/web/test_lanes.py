"""Workers: they answer, can be cancelled, and leave with their server."""

import asyncio
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from dashpot import workflow
from dashpot.base.errors import DataError
from dashpot.web import wire
from dashpot.web.lanes import FaultError, Lane, StoppedError
from dashpot.web.store import Store

ON_LINUX = pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")


@pytest.fixture
def store():
    store = Store()
    yield store
    store.remove()


def with_lane(store, work):
    async def run():
        lane = Lane(store.folder)
        try:
            return await work(lane)
        finally:
            await lane.close()

    return asyncio.run(run())


def test_a_sentence_is_an_answer_and_the_worker_goes_on(store):
    async def work(lane):
        with pytest.raises(DataError, match="open one first"):
            await lane.ask("settle", {"job": {}})
        with pytest.raises(FaultError, match="KeyError"):
            await lane.ask("none", {})
        return await lane.ask("profile", {"options": {}})

    assert wire.unpacked(with_lane(store, work))[0]["name"] == "profile.toml"


def test_a_long_computation_is_cancelled_and_the_next_one_works(store):
    seal, hammer = (store.put(name, workflow.EXAMPLES[name]().encode()) for name in workflow.FIRST)
    job = {"relaxation": seal, "impact": [hammer], "mass": "114.8g", "seals": 2}

    async def work(lane):
        long = asyncio.create_task(lane.ask("study", {"job": job}))
        while not lane.doing:
            await asyncio.sleep(0.02)
        assert lane.seconds is not None
        process = await lane.start()
        assert lane.cancel()
        with pytest.raises(StoppedError, match=r"^cancelled$"):
            await long
        assert process.returncode is not None
        assert not lane.cancel()
        return await lane.ask("inspect", {"file": seal})

    assert wire.unpacked(with_lane(store, work))[0]["kind"] == "relaxation"


def alive(process):
    """Whether a process runs: one that nobody waited for does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def children(process):
    return [
        int(one) for one in Path(f"/proc/{process}/task/{process}/children").read_text().split()
    ]


@ON_LINUX
def test_nothing_is_left_of_a_server_that_was_killed():
    words = [sys.executable, "-m", "dashpot", "app", "--no-browser"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as server:
        address = server.stdout.readline()
        assert address.startswith("http://127.0.0.1:")
        until = time.monotonic() + 20
        while len(found := children(server.pid)) < 3 and time.monotonic() < until:
            time.sleep(0.05)
        assert len(found) == 3
        folder = Path(Path(f"/proc/{found[0]}/cmdline").read_bytes().split(b"\0")[-2].decode())
        assert folder.is_dir()
        os.kill(server.pid, signal.SIGKILL)
    until = time.monotonic() + 2
    while any(map(alive, found)) and time.monotonic() < until:
        time.sleep(0.05)
    assert not any(map(alive, found))
    assert not folder.exists()
