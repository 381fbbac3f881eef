"""The running server against foreign requests to its port."""

import http.client
import json
import re
import subprocess
import sys
from contextlib import closing
from pathlib import Path
from urllib.parse import urlsplit

import pytest

pytestmark = pytest.mark.once

CUSTOMER = "Gaskets of Nowhere Ltd"
LIMIT = 4 << 20
SMALL = f"""
from dashpot.extensions.app import server, upload_store
upload_store.Store.keep.__kwdefaults__["limit"] = {LIMIT}
server.serve(browser=False)
"""
"""The app with a limit that a test need not send 200 MB to reach."""


@pytest.fixture(scope="module")
def server():
    """Port and token of a server; what it wrote is looked at when it has ended."""
    words = [sys.executable, "-c", SMALL]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
        address = urlsplit(run.stdout.readline().strip())
        token = address.query.partition("=")[2]
        yield address.port, token
        run.terminate()
        out, err = run.communicate()
    for message in (out, err):
        assert CUSTOMER not in message
        assert token not in message
        assert "Traceback" not in message


@pytest.fixture
def ask(server):
    port, token = server

    def send_request(method, path, body=None, **headers):
        headers = {"Cookie": f"dashpot-{port}={token}"} | headers
        with closing(http.client.HTTPConnection("127.0.0.1", port, timeout=30)) as line:
            line.request(method, path, body, headers)
            answer = line.getresponse()
            return answer.status, answer.read().decode(errors="replace")

    return send_request


def test_server_listens_on_localhost_only(server):
    if sys.platform != "linux":
        pytest.skip("sockets are looked up in /proc")
    table = "".join(Path(f"/proc/net/{kind}").read_text() for kind in ("tcp", "tcp6"))
    places = re.findall(rf": ([0-9A-F]+):{server[0]:04X} [0-9A-F]+:0000 0A", table)
    assert places == ["0100007F"]


def test_a_rebound_name_another_page_and_a_missing_cookie_get_nothing(server, ask):
    port, token = server
    assert ask("GET", "/")[0] == 200
    assert ask("GET", "/", Host=f"rebound.example:{port}")[0] == 403
    assert ask("GET", f"/?token={token}", Host="rebound.example", Cookie="")[0] == 403
    assert ask("POST", "/api/example", Origin="https://evil.example")[0] == 403
    assert ask("GET", "/api/state", Cookie="")[0] == 403
    assert ask("GET", f"/api/state?token={token}", Cookie="")[0] == 403
    for method in ("GET", "POST", "DELETE"):
        assert ask(method, "/api/record", Cookie="")[0] == 403
        assert ask(method, "/api/record", Origin="https://evil.example")[0] == 403
    assert ask("GET", "/record", Cookie="")[0] == 403
    assert ask("POST", "/api/record", "{}")[0] == 422
    assert ask("POST", "/api/record/fit")[0] == 422
    assert ask("GET", "/api/record?width=-1&height=1e999")[0] == 200
    assert ask("GET", "/static/../server.py")[0] == 404
    assert ask("GET", "/plot/../web/server.py")[0] == 404


def test_an_upload_without_a_length_is_refused_when_it_is_too_long(ask):
    blocks = (b"0.1,0.2\n" * (1 << 14) for _ in range(64))
    status, message = ask("POST", "/api/files?name=long.csv", blocks)
    assert status == 413
    assert "larger than 4 MB" in json.loads(message)["error"]


def test_what_is_in_a_file_and_what_it_is_called_are_in_no_log(ask):
    bad = f"{CUSTOMER}\ntime [s],force [N],displacement [mm]\n0,{CUSTOMER},1\n"
    for name in (f"{CUSTOMER}.csv", f"{CUSTOMER}" + "x" * 5000 + "%FF%00"):
        status, message = ask("POST", f"/api/files?name={name.replace(' ', '%20')}", bad)
        assert status == 200, message
        file = json.loads(message)["id"]
        assert re.fullmatch("[0-9a-f]{16}", file)
        assert ask("POST", "/api/inspect", json.dumps({"file": file}))[0] in {200, 422}
        job = {"relaxation": file, "title": CUSTOMER}
        status, message = ask("POST", "/api/settle", json.dumps({"job": job}))
        assert status == 422, message
    status, message = ask("POST", "/api/settle", "{" + CUSTOMER)
    assert (status, json.loads(message)["error"]) == (422, "the request is not JSON")
    for body in ({"job": CUSTOMER}, {"file": CUSTOMER}, {"job": {CUSTOMER: 1}}):
        for verb in ("settle", "inspect"):
            assert ask("POST", f"/api/{verb}", json.dumps(body))[0] == 422


def test_who_goes_away_in_the_middle_leaves_nothing(server, ask):
    port, token = server
    with closing(http.client.HTTPConnection("127.0.0.1", port)) as line:
        line.putrequest("POST", f"/api/files?name={CUSTOMER.replace(' ', '_')}.csv")
        line.putheader("Cookie", f"dashpot-{port}={token}")
        line.putheader("Content-Length", "1000000")
        line.endheaders()
        line.send(CUSTOMER.encode() * 100)
    status, message = ask("GET", "/api/state")
    assert status == 200
    assert CUSTOMER.replace(" ", "_") not in message
