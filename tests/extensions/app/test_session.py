"""The saved session of a server, and its restoration by the next."""

import asyncio
import json

import pytest

from dashpot.extensions.app import session
from dashpot.extensions.app.recent import get_state_path
from dashpot.extensions.app.server import AppContext
from dashpot.extensions.app.upload_store import Store, find_file


@pytest.fixture(autouse=True)
def _place(tmp_path, monkeypatch):
    monkeypatch.setenv("DASHPOT_STATE", str(tmp_path / "state"))


@pytest.fixture
def store():
    store = Store()
    yield store
    store.remove()


def state(*files):
    return {"files": [{"id": file, "name": "seal.csv"} for file in files], "job": {"arms": 2}}


def test_a_session_is_taken_up_by_another_server(store):
    identity = store.put("seal.csv", b"1,2,3\n")
    session.save_session(state(identity), store)
    store.remove()
    assert session.get_saved_session()["files"] == ["seal.csv"]
    after = Store()
    result = session.restore_session(after)
    assert result == state(identity)
    assert find_file(after.folder, identity).read_bytes() == b"1,2,3\n"
    after.remove()


def test_session_is_removed_with_its_files_and_on_request(store):
    item, other = store.put("a.csv", b"1\n"), store.put("b.csv", b"2\n")
    session.save_session(state(item, other), store)
    session.save_session(state(other), store)
    assert [each.name for each in get_state_path("session").iterdir()] == [other]
    session.save_session(state(), store)
    assert session.get_saved_session() is None
    assert not get_state_path("session").exists()
    session.save_session(state(item), store)
    session.delete_session()
    assert session.get_saved_session() is None


def test_what_is_not_whole_is_not_offered(store):
    identity = store.put("a.csv", b"1\n")
    session.save_session(state(identity), store)
    next((get_state_path("session") / identity).iterdir()).unlink()
    assert session.get_saved_session() is None
    assert session.restore_session(store) == {}
    get_state_path("session.json").write_text("no JSON")
    assert session.get_saved_session() is None


@pytest.mark.parametrize("name", ["../../secret", "", "0" * 16])
def test_session_ignores_a_file_that_is_not_on_the_page(store, name):
    session.save_session(state(name), store)
    assert session.get_saved_session() is None


def test_only_an_empty_server_offers_it(store, tmp_path):
    session.save_session(state(store.put("a.csv", b"1\n")), store)
    (tmp_path / "own.csv").write_text("1\n")

    async def open_session(*files):
        desk = AppContext(files)
        result = json.loads(json.dumps(desk.state))
        await desk.close()
        return result

    assert asyncio.run(open_session())["last_session"]["files"] == ["seal.csv"]
    assert "left" not in asyncio.run(open_session(tmp_path / "own.csv"))
