"""Web server: routes of the page to the worker processes."""

from __future__ import annotations

import asyncio
import contextlib
import gzip
import json
import os
import socket
import webbrowser
from collections import OrderedDict
from collections.abc import AsyncIterator, Sequence
from functools import cache
from hashlib import sha256
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dashpot.base.errors import DashpotError, DataError
from dashpot.extensions.app import session
from dashpot.extensions.app.access_control import Guard
from dashpot.extensions.app.file_watch import FileWatch
from dashpot.extensions.app.live_recording import Live
from dashpot.extensions.app.page_form import fill_form
from dashpot.extensions.app.request_parsing import get_list
from dashpot.extensions.app.upload_store import Store, TooLargeError, remove_stale_stores
from dashpot.extensions.app.words import format_for_page
from dashpot.extensions.app.worker_pool import FaultError, StoppedError, WorkerProcess
from dashpot.plot import style
from dashpot.registry import find_handler, plugins

if TYPE_CHECKING:
    from starlette.applications import Starlette
    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.routing import Route

LANES = {
    "inspect": "settle", "live": "live", "predict": "live", "look": "settle",
    "settle": "settle", "study": "slow",
    "take": "slow", "profile": "live", "project": "slow", "bench": "slow", "take-bench": "slow",
    "level": "slow", "take-level": "slow",
    "hammer": "slow", "take-hammer": "slow", "modes": "slow", "take-modes": "slow",
    "against": "slow", "overlay": "slow", "judged": "slow", "take-judged": "slow",
    "recent": "live", "folder": "settle", "row": "settle",
}  # fmt: skip
"""Which lane answers which verb."""
MOST = 1 << 20
"""Bytes of a question."""
MOST_OF_STATE = 16 << 20
"""Bytes of what a page keeps of itself: its files, its choices, and the way back through them."""
ANSWERS = 32
"""Answers that are kept, so that a page that was loaded again need not wait."""
_KINDS = {"js": "text/javascript", "css": "text/css", "svg": "image/svg+xml"}
_READS = {"inspect", "folder", "row"}
"""Verbs that wait for a file."""
GRACE = 1
"""Seconds that a connection is given when the server ends."""
_KEPT = {"settle", "study", "bench", "level", "modes", "judged", "against", "hammer", "overlay"}


class AppContext:
    """State of one server: files, workers, results, and the page's last state.

    Parameters
    ----------
    files : sequence of path
        Opened at once; a folder is a project, or a lot.
    """

    def __init__(self, files: Sequence[str | Path] = ()) -> None:
        self.store = Store()
        self.lanes = {
            name: WorkerProcess(self.store.folder) for name in dict.fromkeys(LANES.values())
        }
        self.live = Live(self.store)
        self.watch = FileWatch(self.store)
        self.fresh: set[str] = set()
        self.answers: OrderedDict[str, bytes] = OrderedDict()
        places = [Path(path) for path in files]
        self.state: dict[str, Any] = {
            "open": [
                {"id": self.store.put_file(place), "name": place.name}
                for place in places
                if not place.is_dir()
            ],
            "folders": [str(place.resolve()) for place in places if place.is_dir()],
        }
        if not places and (remaining := session.get_saved_session()):
            self.state["left"] = remaining

    async def answer(self, verb: str, body: bytes) -> bytes:
        """Return the answer to a question, from memory where it was put before."""
        name = sha256(verb.encode() + b"\0" + body).hexdigest()
        if name in self.answers:
            self.answers.move_to_end(name)
            return self.answers[name]
        content = await self.lanes[LANES[verb]].ask(verb, json_of(body))
        if verb in _KEPT:
            self.answers[name] = content
            while len(self.answers) > ANSWERS:
                self.answers.popitem(last=False)
        return content

    def make_room(self) -> None:
        """Remove the oldest files that no state of the page names, where the store is full.

        What was uploaded since the page kept its state is named by none yet, and stays.
        """
        named = json.dumps(self.state)
        self.store.make_room(lambda identity: identity in named or identity in self.fresh)

    def cancel(self) -> bool:
        """End what may take long: a study, what is made to be taken away, a reading."""
        long = [self.lanes["slow"]]
        if self.lanes["settle"].verb in _READS:
            long.append(self.lanes["settle"])
        cancelled = [worker.cancel() for worker in long]
        return any(cancelled)

    def leave(self) -> None:
        """End every worker at once: pending requests get an error, and none delays the end."""
        for lane in self.lanes.values():
            lane.leave()

    async def close(self) -> None:
        """End every worker, and leave nothing of the files."""
        await asyncio.to_thread(self.live.stop, GRACE)
        for lane in self.lanes.values():
            await lane.close()
        self.store.remove()


_LISTS: dict[str, type] = {"files": dict, "open": dict, "past": dict, "folders": str}
"""What the state of a page lists, and of what."""


def state_of(body: bytes) -> dict[str, Any]:
    """Return what a page keeps of itself, of the types that it is kept in.

    Raises
    ------
    DataError
        If it is not a JSON object, or lists something else.
    """
    entries = json_of(body)
    for name, kind in _LISTS.items():
        rows = entries.get(name, [])
        if not (isinstance(rows, list) and all(isinstance(row, kind) for row in rows)):
            what = "texts" if kind is str else "objects"
            raise DataError(f"the state's '{name}' is no list of {what}")
    return entries


def json_of(body: bytes) -> dict[str, Any]:
    """Return what must be a JSON object.

    Raises
    ------
    DataError
        If it is not.
    """
    try:
        data = json.loads(body, parse_constant=_refuse_constant)
    except (ValueError, RecursionError):
        raise DataError("the request is not JSON") from None
    if not isinstance(data, dict):
        raise DataError("the request is not a JSON object")
    return data


def _refuse_constant(name: str) -> None:
    """Refuse NaN and infinities, which Python would read and no answer could hold."""
    raise ValueError(name)


def application(desk: AppContext) -> Starlette:  # noqa: C901 -- a list of routes
    """Return the routes over a desk, without their guard."""
    from starlette.applications import Starlette
    from starlette.responses import JSONResponse, Response
    from starlette.routing import Route

    async def page(_: Request) -> Response:
        return _make_response(_static("index.html"), "text/html")

    async def static(request: Request) -> Response:
        name = request.path_params["name"]
        kind = _KINDS.get(name.rpartition(".")[2])
        if kind is None or name not in _names():
            return Response("there is no such file", status_code=404)
        return _make_response(_static(name), kind)

    async def charts(_: Request) -> Response:
        script = _HOUSE.joinpath("plot", "charts.js").read_text("utf-8")
        return _make_response(script, _KINDS["js"])

    async def files(request: Request) -> Response:
        name = request.query_params.get("name", "file")
        modified = request.query_params.get("modified", "")
        await asyncio.to_thread(desk.make_room)
        identity = await desk.store.keep(
            name, request.stream(), modified=int(modified) / 1e3 if modified.isdecimal() else None
        )
        desk.fresh.add(identity)
        return JSONResponse({"id": identity, "name": name})

    async def example(_: Request) -> Response:
        from dashpot import workflow

        made = [
            {"id": desk.store.put(name, workflow.EXAMPLES[name]().encode()), "name": name}
            for name in workflow.FIRST
        ]
        return JSONResponse({"files": made, "mass": "114.8g", "seals": 2})

    async def ask(request: Request) -> Response:
        verb = request.path_params["verb"]
        if verb not in LANES:
            return JSONResponse({"error": f"there is no '{verb}'"}, status_code=404)
        return Response(
            await desk.answer(verb, await _body(request)), media_type="application/octet-stream"
        )

    async def watch(request: Request) -> Response:
        names = get_list(json_of(await _body(request)), "files")
        return JSONResponse(await asyncio.to_thread(desk.watch.look, names))

    async def cancel(_: Request) -> Response:
        return JSONResponse({"cancelled": desk.cancel()})

    async def working(_: Request) -> Response:
        slow = desk.lanes["slow"]
        return JSONResponse({"seconds": slow.seconds, "doing": slow.doing})

    async def state(request: Request) -> Response:
        if request.method == "PUT":
            desk.state = state_of(await _body(request, MOST_OF_STATE))
            desk.fresh.clear()
            await asyncio.to_thread(session.keep, desk.state, desk.store)
        return JSONResponse(desk.state)

    async def resume(request: Request) -> Response:
        if request.method == "DELETE":
            session.forget()
            desk.state.pop("left", None)
        else:
            desk.state = await asyncio.to_thread(session.resume, desk.store)
        return JSONResponse(desk.state)

    async def sentence(_: Request, error: Exception) -> Response:
        codes: dict[type, int] = {TooLargeError: 413, StoppedError: 409, FaultError: 500}
        return JSONResponse(
            {"error": format_for_page(str(error))}, status_code=codes.get(type(error), 422)
        )

    async def fault(_: Request, error: Exception) -> Response:
        words = f"a fault of dashpot's own: {type(error).__name__}; the shell's command says more"
        return JSONResponse({"error": words}, status_code=500)

    @contextlib.asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        for lane in desk.lanes.values():
            await lane.start()
        try:
            yield
        finally:
            await desk.close()

    return Starlette(
        routes=[
            Route("/", page),
            Route("/static/{name}", static),
            # the page's modules name it by its path in the package
            Route("/plot/charts.js", charts),
            Route("/api/files", files, methods=["POST"]),
            Route("/api/example", example, methods=["POST"]),
            Route("/api/watch", watch, methods=["POST"]),
            Route("/api/cancel", cancel, methods=["POST"]),
            Route("/api/working", working),
            Route("/api/state", state, methods=["GET", "PUT"]),
            Route("/api/session", resume, methods=["POST", "DELETE"]),
            *_recording(desk),
            Route("/api/{verb}", ask, methods=["POST"]),
        ],
        exception_handlers={DashpotError: sentence, Exception: fault},
        lifespan=lifespan,
    )


def _recording(desk: AppContext) -> list[Route]:
    """Return the page that shows an instrument as it is read, and what it asks."""
    from starlette.responses import JSONResponse
    from starlette.routing import Route

    async def record_page(_: Request) -> Response:
        return _make_response(_static("record.html"), "text/html")

    async def recording(request: Request) -> Response:
        if request.method == "POST":
            await asyncio.to_thread(desk.live.start, json_of(await _body(request)))
        elif request.method == "DELETE":
            await asyncio.to_thread(desk.live.stop)
        size = [_pixels(request, name) for name in ("width", "height")]
        return JSONResponse(await asyncio.to_thread(desk.live.look, *size))

    async def fit_recorded(_: Request) -> Response:
        made = desk.live.look(0, 0)["kept"]
        if made is None:
            raise DataError("no record is there to fit: start one, and stop it")
        desk.state["open"] = [*desk.state.get("open", []), made]
        return JSONResponse(made)

    return [
        Route("/record", record_page),
        Route("/api/record", recording, methods=["GET", "POST", "DELETE"]),
        Route("/api/record/fit", fit_recorded, methods=["POST"]),
    ]


def _pixels(request: Request, name: str) -> float:
    """Return a size that a page asks for; 0 if it asks for none."""
    text = request.query_params.get(name, "")
    return float(text) if text.isdecimal() else 0.0


async def _body(request: Request, most: int = MOST) -> bytes:
    body = bytearray()
    async for block in request.stream():
        body += block
        if len(body) > most:
            raise TooLargeError(f"the request is larger than {most >> 20} MB")
    return bytes(body)


# by their path: naming a package would import it
_HOUSE = resources.files("dashpot")


def _names() -> set[str]:
    return {path.name for path in _HOUSE.joinpath("extensions", "app", "static").iterdir()}


def _make_response(text: str, kind: str) -> Response:
    from starlette.responses import Response

    headers = {"content-encoding": "gzip"}
    return Response(_compress_text(text), media_type=kind, headers=headers)


@cache
def _compress_text(text: str) -> bytes:
    return gzip.compress(text.encode(), mtime=0)


def _static(name: str) -> str:
    text = _HOUSE.joinpath("extensions", "app", "static", name).read_text("utf-8")
    if name == "index.html":
        icons = _HOUSE.joinpath("report", "templates", "icons.html").read_text("utf-8")
        return fill_form(text.replace("<!-- icons -->", icons))
    return f"{style.css()}\n{text}" if name == "app.css" else text


def serve(files: Sequence[str | Path] = (), *, port: int = 0, browser: bool = True) -> None:
    """Serve the app on this machine until it is interrupted; say its address.

    Raises
    ------
    DataError
        If the extra is not installed, or the port is taken.
    """
    try:
        import uvicorn
    except ImportError:
        advice = find_handler("install command", "extra")("app")
        raise DataError(f"the app needs its extra; install it with: {advice}") from None
    os.environ[plugins.SWITCH] = plugins.OFF  # a page may name none: who types a command does
    # only where the protocol is named does asyncio turn off the wait for a fuller packet, 40 ms
    listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind(("127.0.0.1", port))
        # whoever comes before the server is up waits, and is not refused
        listener.listen()
    except OSError:
        listener.close()
        raise DataError(f"port {port} is taken; leave out --port to get a free one") from None
    taken = int(listener.getsockname()[1])
    remove_stale_stores()
    desk = AppContext(files)
    guarded = Guard(application(desk), port=taken)
    address = f"http://127.0.0.1:{taken}/?token={guarded.token}"
    print(address, flush=True)  # noqa: T201 -- the one line that a program may wait for
    if browser:
        webbrowser.open(address)
    from dashpot.extensions.app.connection_limits import LimitedProtocol

    config = uvicorn.Config(
        guarded, log_level="error", access_log=False, lifespan="on", http=LimitedProtocol,
        timeout_graceful_shutdown=GRACE,
    )  # fmt: skip

    class Server(uvicorn.Server):
        async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
            desk.leave()
            await super().shutdown(sockets)

    Server(config).run(sockets=[listener])
