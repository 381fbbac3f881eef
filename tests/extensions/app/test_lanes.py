"""Worker processes: answers, cancellation, and end with their server."""

import asyncio
import contextlib
import gc
import http.client
import json
import os
import queue
import signal
import subprocess
import sys
import threading
import time
import weakref
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from kit.processes import ON_LINUX, alive, children

from dashpot import workflow
from dashpot.base.errors import DataError
from dashpot.base.subprocesses import get_long_lived_env
from dashpot.extensions.app import wire_format, worker_process
from dashpot.extensions.app.upload_store import Store, remove_stale_stores
from dashpot.extensions.app.worker_pool import FaultError, StoppedError, WorkerProcess


@pytest.fixture
def store():
    store = Store()
    yield store
    store.remove()


def test_store_clears_files_of_a_killed_server(store, tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    living, dead, other = Store(), tmp_path / "dashpot-dead", tmp_path / "dashpot-other"
    for item in (dead, other):
        item.mkdir()
        (item / "customer.csv").write_text("1")
    (dead / ".lock").touch()
    remove_stale_stores()
    assert sorted(tmp_path.iterdir()) == sorted([living.folder, other])
    living.remove()


def with_lane(store, work):
    async def run():
        lane = WorkerProcess(store.folder)
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

    assert wire_format.decode_message(with_lane(store, work))[0]["name"] == "profile.toml"


BLOCKER = """
import sys

class Blocker:
    def find_spec(self, name, path=None, target=None):
        if name == "dashpot.extensions.app.overlay_fits":
            raise ModuleNotFoundError("No module named 'overlaid'", name="overlaid")

sys.meta_path.insert(0, Blocker())
"""


def test_worker_whose_modules_cannot_be_imported_says_so_at_once(store, tmp_path, monkeypatch):
    """It answers, and is not started anew for every question, only to end without an answer."""
    (tmp_path / "sitecustomize.py").write_text(BLOCKER)
    monkeypatch.setenv(
        "PYTHONPATH", os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])
    )

    async def work(lane):
        for verb in ("settle", "inspect"):
            with pytest.raises(FaultError, match="ModuleNotFoundError, No module named 'overlaid'"):
                await asyncio.wait_for(lane.ask(verb, {}), 30)
        return (await lane.start()).returncode

    assert with_lane(store, work) is None


def test_a_long_computation_is_cancelled_and_the_next_one_works(store):
    seal, hammer = (store.put(name, workflow.EXAMPLES[name]().encode()) for name in workflow.FIRST)
    job = {"relaxation": seal, "impact": [hammer], "mass": "114.8g", "seals": 2}

    async def work(lane):
        long = asyncio.create_task(lane.ask("study", {"job": job}))
        while not lane.doing:
            await asyncio.sleep(0.001)
        assert lane.seconds is not None
        process = await lane.start()
        assert lane.cancel()
        with pytest.raises(StoppedError, match=r"^cancelled$"):
            await long
        assert process.returncode is not None
        assert lane._process.returncode is None  # the next stands by
        assert lane._process is not process
        assert not lane.cancel()
        return await lane.ask("inspect", {"file": seal})

    assert wire_format.decode_message(with_lane(store, work))[0]["kind"] == "relaxation"


@ON_LINUX
def test_killed_server_leaves_no_process():
    words = [sys.executable, "-m", "dashpot", "app", "--no-browser"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as server:
        address = server.stdout.readline()
        assert address.startswith("http://127.0.0.1:")
        until = time.monotonic() + 20
        while len(result := children(server.pid)) < 3 and time.monotonic() < until:
            time.sleep(0.05)
        assert len(result) == 3
        folder = Path(Path(f"/proc/{result[0]}/cmdline").read_bytes().split(b"\0")[-2].decode())
        assert folder.is_dir()
        os.kill(server.pid, signal.SIGKILL)
    until = time.monotonic() + 20
    while any(map(alive, result)) and time.monotonic() < until:
        time.sleep(0.05)
    assert not any(map(alive, result))
    assert not folder.exists()


@ON_LINUX
def test_a_reading_can_be_cancelled_and_an_interrupt_ends_it_whatever_it_does():
    words = [sys.executable, "-m", "dashpot", "app", "--no-browser"]
    seal = workflow.EXAMPLES["seal_8mm.csv"]()
    how = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(words, **how) as run, contextlib.ExitStack() as open_:
        address = urlsplit(run.stdout.readline().strip())
        cookie = {"Cookie": f"dashpot-{address.port}={address.query.partition('=')[2]}"}

        def send_request(path, body):
            line = open_.enter_context(
                contextlib.closing(
                    http.client.HTTPConnection("127.0.0.1", address.port, timeout=60)
                )
            )
            line.request("POST", path, body, cookie)
            return line

        def read_response(line):
            answer = line.getresponse()
            return answer.status, answer.read()

        file = json.loads(read_response(send_request("/api/files?name=seal.csv", seal))[1])["id"]
        inspect = "/api/inspect", json.dumps({"file": file})
        # who reads or computes stands still: it would never end by itself
        for item in children(run.pid):
            os.kill(item, signal.SIGSTOP)
        reading = send_request(*inspect)
        while not json.loads(read_response(send_request("/api/cancel", ""))[1])["cancelled"]:
            time.sleep(0.05)
        assert read_response(reading)[0] == 409
        status, body = read_response(send_request(*inspect))
        assert (status, wire_format.decode_message(body)[0]["kind"]) == (200, "relaxation")
        for item in children(run.pid):
            os.kill(item, signal.SIGSTOP)
        send_request(*inspect)
        send_request("/api/study", json.dumps({"job": {"relaxation": file}}))
        half = open_.enter_context(
            contextlib.closing(http.client.HTTPConnection("127.0.0.1", address.port))
        )
        half.putrequest("POST", "/api/files?name=half.csv")
        for name, value in (*cookie.items(), ("Content-Length", "1000000")):
            half.putheader(name, value)
        half.endheaders()
        half.send(seal[:1000].encode())
        time.sleep(0.3)
        run.send_signal(signal.SIGINT)
        # those that it waits for stand still for ever
        _, message = run.communicate(timeout=60)
        assert "Traceback" not in message


@ON_LINUX
def test_a_worker_gives_back_what_a_long_record_took():
    """As workers are set, the C library would keep all of it."""
    script = (
        "from dashpot.extensions.app.worker_process import trim_memory\n"
        "from pathlib import Path\n"
        "held = [bytearray(1 << 20) for _ in range(120)]\n"
        "last = bytearray(1 << 20)\n"
        "size = lambda: int(Path('/proc/self/statm').read_text().split()[1])\n"
        "full = size(); del held; kept = size()\n"
        "trim_memory(1 << 40); same = size(); trim_memory(1 << 20); print(full, kept, same, size())"
    )
    message = subprocess.run(
        [sys.executable, "-c", script],
        env=get_long_lived_env(),
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    full, selected, same, remaining = map(int, message.split())
    assert selected > 0.9 * full
    assert same == pytest.approx(selected, rel=0.01)
    assert remaining < 0.5 * full


def test_a_worker_without_questions_collects_its_garbage(monkeypatch):
    monkeypatch.setattr(worker_process, "IDLE_SECONDS", 0.01)
    questions = queue.Queue()
    gc.disable()  # a search for cycles of its own would hide what is tested
    try:
        cycle = type("Record", (), {})()
        cycle.itself, reference = cycle, weakref.ref(cycle)
        del cycle
        threading.Timer(0.2, questions.put, [b"next"]).start()
        assert worker_process._wait_for_question(questions) == b"next"
        assert reference() is None
    finally:
        gc.enable()
