"""Access to the server: this machine, this page, this user."""

import pytest
from kit.asgi import Client

from dashpot.extensions.app.access_control import SECURITY_POLICY, Guard
from dashpot.extensions.app.server import AppContext, application

PORT = 8123
HOST = f"127.0.0.1:{PORT}"
COOKIE = (f"dashpot-{PORT}", "secret")


@pytest.fixture(scope="module")
def desk():
    desk = AppContext()
    yield desk
    desk.store.remove()


@pytest.fixture
def guard(desk):
    return Guard(application(desk), port=PORT, token=COOKIE[1])


@pytest.fixture
def page(guard):
    return Client(guard, HOST)


def make_admitted_client(guarded):
    return Client(guarded, HOST, dict([COOKIE]))


def test_without_a_token_nothing_is_served(page):
    for path in ("/", "/static/app.js", "/api/state"):
        assert page.get(path).status_code == 403
    assert page.request("POST", "/api/example").status_code == 403


def test_a_wrong_token_is_none(page):
    assert page.get("/?token=secreT").status_code == 403
    assert page.get("/api/state?token=secret").status_code == 403  # good for the page alone


def test_the_token_is_good_for_a_cookie_that_scripts_cannot_read(page):
    answer = page.get("/?token=secret")
    assert (answer.status_code, answer.headers["location"]) == (303, "/")
    flags = answer.headers["set-cookie"]
    assert "HttpOnly" in flags
    assert "SameSite=Strict" in flags
    assert page.get("/").status_code == 200


def test_a_name_that_was_rebound_and_another_page_are_refused(guard):
    page = make_admitted_client(guard)
    assert page.get("/").status_code == 200
    assert page.get("/", headers={"host": f"evil.example:{PORT}"}).status_code == 403
    assert page.get("/", headers={"host": "127.0.0.1:9"}).status_code == 403
    for origin in ("https://evil.example", "null", f"http://127.0.0.1:{PORT + 1}"):
        assert page.request("POST", "/api/example", headers={"origin": origin}).status_code == 403
    assert (
        page.request("PUT", "/api/state", b"{}", headers={"origin": f"http://{HOST}"}).status_code
        == 200
    )


def test_every_answer_carries_the_policy(guard):
    page = make_admitted_client(guard)
    for path in ("/", "/static/app.js", "/api/state", "/nowhere"):
        headers = page.get(path).headers
        assert headers["content-security-policy"] == SECURITY_POLICY
        assert headers["cache-control"] == "no-store"
    assert "unsafe" not in SECURITY_POLICY


@pytest.mark.parametrize(
    "path", ["/static/../server.py", "/static/%2e%2e/server.py", "/static/..%2fserver.py",
             "/static/none.js", "/static/app.py"],
)  # fmt: skip
def test_server_serves_nothing_but_the_page(guard, path):
    assert make_admitted_client(guard).get(path).status_code == 404


@pytest.mark.parametrize("body", [b"", b"{", b"[]", b"[" * 100_000, b"\xff\xfe"])
def test_server_reports_a_body_that_is_no_json_object(guard, body):
    answer = make_admitted_client(guard).request("PUT", "/api/state", body)
    assert answer.status_code == 422
    assert "JSON" in answer.json()["error"]


@pytest.mark.parametrize(
    "body", ['{"files": 3}', '{"open": [1]}', '{"folders": [{}]}', '{"open": {"a": []}}']
)
def test_server_reports_a_state_of_wrong_types(guard, body):
    answer = make_admitted_client(guard).request("PUT", "/api/state", body.encode())
    assert answer.status_code == 422
    assert "no list of" in answer.json()["error"]


def test_a_request_that_no_page_sends_is_cut_short(guard):
    answer = make_admitted_client(guard).request("POST", "/api/settle", b" " * ((1 << 20) + 1))
    assert answer.status_code == 413


@pytest.mark.parametrize("verb", ["settle", "live", "inspect", "study", "take", "predict"])
def test_server_reports_a_request_that_is_no_json(guard, verb):
    for body in (b"", b"{'a': 1}", b'{"job":', b"null"):
        answer = make_admitted_client(guard).request("POST", f"/api/{verb}", body)
        assert answer.status_code == 422
        assert "JSON" in answer.json()["error"]


def test_server_reports_the_kind_of_a_fault_without_data(guard, desk, monkeypatch):
    monkeypatch.setattr(desk, "answer", lambda *_: {}["the customer's words"])
    answer = make_admitted_client(guard).request("POST", "/api/settle", b"{}")
    assert answer.status_code == 500
    assert answer.json()["error"].startswith("internal error of dashpot: KeyError")


def test_a_verb_that_is_none(guard):
    assert make_admitted_client(guard).request("POST", "/api/eval", b"{}").status_code == 404


def test_upload_over_the_limit_is_refused_during_transfer(desk, monkeypatch):
    import asyncio

    from dashpot.extensions.app import upload_store

    sent = 0

    async def endless():
        nonlocal sent
        while True:
            sent += 1
            yield b"1,2,3\n" * 100

    with pytest.raises(upload_store.TooLargeError, match="larger than"):
        asyncio.run(desk.store.keep("../../endless.csv", endless(), limit=10_000))
    assert sent == 17
    assert [item.name for item in desk.store.folder.iterdir()] == [".lock"]


@pytest.mark.parametrize(
    ("name", "kept"),
    [
        ("../../etc/passwd", "passwd"),
        ("C:\\x\\seal.csv", "seal.csv"),
        ("a\x1b[2Jb.csv", "a_[2Jb.csv"),
        ("..", "file"),
        ("", "file"),
        ("<b>.csv", "_b_.csv"),
        ("漢" * 200 + ".csv", "漢" * 40 + "_" + "漢" * 38 + ".csv"),
        ("\ud800.csv", "_.csv"),
    ],
)
def test_a_name_leads_nowhere(name, kept):
    from dashpot.extensions.app.upload_store import make_safe_name

    assert make_safe_name(name) == kept
