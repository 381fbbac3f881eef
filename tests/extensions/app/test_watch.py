"""Open files against the disk, room for files, connections that stall, requests that are none."""

import asyncio
import contextlib
import http.client
import json
import os
import socket
import subprocess
import sys
import time
from contextlib import closing
from hashlib import sha256
from urllib.parse import urlsplit

import pytest
from kit.asgi import Client

from dashpot.extensions.app.access_control import Guard
from dashpot.extensions.app.file_watch import FileWatch
from dashpot.extensions.app.server import MAX_BYTES, AppContext, application
from dashpot.extensions.app.upload_store import Store, TooLargeError, find_file

PORT = 8124
ROWS = "time [s],force [N]\n0,1\n1,2\n"


@pytest.fixture
def store(tmp_path):
    home = tmp_path / "store"
    home.mkdir()
    return Store(home)


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "seal.csv"
    path.write_text(ROWS)
    return path


def look_twice(watch, name):
    """What two looks say: one that is still written is left alone at the first."""
    watch.list_file_states([name])
    return watch.list_file_states([name])[name]


def test_a_file_that_rests_is_as_it_was_read(store, file):
    name = store.put_file(file)
    row = FileWatch(store).list_file_states([name])[name]
    assert row["state"] == ""
    assert row["sha256"] == sha256(ROWS.encode()).hexdigest()


def test_a_file_of_the_same_size_and_time_is_seen_to_have_changed(store, file):
    name, about = store.put_file(file), file.stat()
    file.write_text(ROWS.replace("1,2", "1,3"))
    os.utime(file, ns=(about.st_atime_ns, about.st_mtime_ns))
    assert (file.stat().st_size, file.stat().st_mtime_ns) == (about.st_size, about.st_mtime_ns)
    row = look_twice(FileWatch(store), name)
    assert row["state"] == "changed"
    assert find_file(store.folder, row["new"]["id"]).read_text() == file.read_text()
    assert find_file(store.folder, name).read_text() == ROWS  # what was shown stays what it was


def test_a_file_that_another_one_replaced_is_read_again(store, file, tmp_path):
    name = store.put_file(file)
    other = tmp_path / "other.csv"
    other.write_text(ROWS.replace("0,1", "0,7"))
    other.replace(file)
    assert look_twice(FileWatch(store), name)["state"] == "changed"


def test_a_file_is_read_again_once_it_rests(store, file):
    name, watch = store.put_file(file), FileWatch(store)
    for i in range(3):
        with file.open("a") as rows:
            rows.write(f"{2 + i},5\n")
        assert watch.list_file_states([name])[name]["state"] == "writing"
    row = watch.list_file_states([name])[name]
    assert row["state"] == "changed"
    assert find_file(store.folder, row["new"]["id"]).read_text() == file.read_text()


def test_a_file_that_was_touched_is_the_same(store, file):
    name = store.put_file(file)
    os.utime(file)
    watch = FileWatch(store)
    assert look_twice(watch, name)["state"] == ""
    assert watch.list_file_states([name])[name]["state"] == ""


def test_deleted_file_is_reported(store, file):
    name = store.put_file(file)
    file.unlink()
    assert FileWatch(store).list_file_states([name])[name]["state"] == "gone"


def test_what_a_page_sent_has_no_place_on_disk(store):
    name = store.put("seal.csv", ROWS.encode())
    assert FileWatch(store).list_file_states([name, "no such", 7, None]).keys() == {name}


async def blocks(*parts):
    for part in parts:
        yield part


def test_all_files_together_have_a_limit(store):
    store.put("a.csv", b"x" * 80)
    with pytest.raises(TooLargeError, match="together"):
        asyncio.run(store.keep("b.csv", blocks(b"y" * 15, b"y" * 15), total=100))
    assert len(list(store.folder.glob("*/*"))) == 1
    asyncio.run(store.keep("c.csv", blocks(b"z" * 20), total=100))


def test_unreferenced_files_are_deleted_for_space(store):
    old, wanted = store.put("a.csv", b"x" * 60), store.put("b.csv", b"y" * 60)
    store.make_room(lambda name: name == wanted, total=200)
    assert find_file(store.folder, wanted).exists()
    assert not (store.folder / old).exists()


# -- requests -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def desk():
    desk = AppContext()
    yield desk
    desk.store.remove()


@pytest.fixture
def page(desk):
    guarded = Guard(application(desk), port=PORT, token="secret")  # noqa: S106 -- of this test
    return Client(guarded, f"127.0.0.1:{PORT}", {f"dashpot-{PORT}": "secret"})


@pytest.mark.parametrize("origin", ["http://[::1", "http://[", "//", "http://a:b:c", "null"])
def test_an_origin_that_is_none_is_refused(page, origin):
    assert page.get("/api/state", headers={"origin": origin}).status_code == 403


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity"])
def test_a_state_with_what_is_no_number_is_refused(page, number):
    answer = page.request("PUT", "/api/state", f'{{"files": [], "at": {number}}}'.encode())
    assert answer.status_code == 422
    assert page.get("/api/state").status_code == 200


def test_state_of_many_files_is_stored(page):
    files = [{"id": f"{i:016x}", "line": "x" * 8000} for i in range(200)]
    body = json.dumps({"files": files}).encode()
    assert len(body) > MAX_BYTES
    assert page.request("PUT", "/api/state", body).status_code == 200
    assert len(json.loads(page.get("/api/state").content)["files"]) == 200
    page.request("PUT", "/api/state", b"{}")


# -- connections ----------------------------------------------------------------------------------

QUICK = """
from dashpot.extensions.app import connection_limits, server
connection_limits.HEAD_SECONDS = connection_limits.BODY_SECONDS = 0.5
server.serve(browser=False)
"""


@pytest.fixture(scope="module")
def server():
    words = [sys.executable, "-c", QUICK]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as run:
        address = urlsplit(run.stdout.readline().strip())
        yield address.port, address.query.partition("=")[2]
        run.terminate()


HEAD = "POST /api/files?name=a HTTP/1.1\r\nHost: 127.0.0.1:{0}\r\nCookie: dashpot-{0}={1}\r\n"


@pytest.mark.parametrize("part", ["", "GET / HT", HEAD + "Content-Length: 100\r\n\r\nabc"])
def test_a_connection_that_stalls_is_closed(server, part):
    with closing(socket.create_connection(("127.0.0.1", server[0]))) as line:
        line.sendall(part.format(*server).encode())
        line.settimeout(20)
        with contextlib.suppress(ConnectionResetError):
            assert line.recv(100) == b""


def test_a_head_that_drips_wins_no_time(server):
    with closing(socket.create_connection(("127.0.0.1", server[0]))) as line:
        line.settimeout(0.05)
        began = time.monotonic()
        while time.monotonic() - began < 20:
            try:
                line.sendall(b"G")
                if line.recv(100) == b"":
                    break
            except TimeoutError:
                continue
            except OSError:
                break
        else:
            pytest.fail("a connection that drips was kept for 20 s")


def test_an_answer_that_takes_longer_than_the_limit_is_waited_for(server):
    port, token = server
    with closing(http.client.HTTPConnection("127.0.0.1", port, timeout=60)) as line:
        for _ in range(2):  # the second on the connection that was kept
            cookie = {"Cookie": f"dashpot-{port}={token}"}
            line.request("POST", "/api/example", b"", cookie)
            assert line.getresponse().read()


WRONG = (None, [], {}, "x", -1, 1e308, True, [[]], [None], {"a": 1}, 0)
FIELDS = {
    "bench": ("file", "options", "temperature", "arms", "sizes"),
    "take": ("job", "what", "target", "units", "solid"),
    "hammer": ("files", "options", "hammer", "band", "sizes"),
    "overlay": ("jobs", "sizes"),
    "watch": ("files",),
}


@pytest.mark.parametrize("verb", FIELDS)
def test_a_malformed_request_is_refused_in_words(server, verb):
    port, token = server
    with closing(http.client.HTTPConnection("127.0.0.1", port, timeout=60)) as line:
        for name in FIELDS[verb]:
            for value in WRONG:
                body = json.dumps({"file": "0" * 16, "job": {}} | {name: value})
                line.request("POST", f"/api/{verb}", body, {"Cookie": f"dashpot-{port}={token}"})
                answer = line.getresponse()
                answer.read()
                assert answer.status < 500, (name, value)
