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
from dashpot.registry import format_install_command, plugins

if TYPE_CHECKING:
    from starlette.applications import Starlette
    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.routing import Route

WORKERS = {
    "inspect": "settle", "live": "live", "predict": "live", "look": "settle",
    "settle": "settle", "study": "slow",
    "take": "slow", "profile": "live", "project": "slow", "bench": "slow", "take-bench": "slow",
    "level": "slow", "take-level": "slow",
    "hammer": "slow", "take-hammer": "slow", "modes": "slow", "take-modes": "slow",
    "against": "slow", "overlay": "slow", "standalone": "slow", "take-standalone": "slow",
    "recent": "live", "folder": "settle", "row": "settle",
}  # fmt: skip
"""Worker pool of each request."""
MAX_BYTES = 1 << 20
"""Most bytes of a request."""
MAX_STATE_BYTES = 16 << 20
"""Most bytes of the state of a page: files, choices and history."""
MAX_CACHED = 32
"""Number of cached answers, for a page that is reloaded."""
_MEDIA_TYPES = {"js": "text/javascript", "css": "text/css", "svg": "image/svg+xml"}
_READING_REQUESTS = {"inspect", "folder", "row"}
"""Requests that read a file."""
CLOSING_SECONDS = 1
"""Seconds that open connections have when the server ends."""
_CACHED_REQUESTS = {
    "settle",
    "study",
    "bench",
    "level",
    "modes",
    "standalone",
    "against",
    "hammer",
    "overlay",
}


class AppContext:
    """State of one server: files, workers, results, and the page's last state.

    Parameters
    ----------
    files : sequence of path
        Opened at once; a folder is a project, or a lot.
    """

    def __init__(self, files: Sequence[str | Path] = ()) -> None:
        self.store = Store()
        self.workers = {
            name: WorkerProcess(self.store.folder) for name in dict.fromkeys(WORKERS.values())
        }
        self.live = Live(self.store)
        self.watch = FileWatch(self.store)
        self.fresh: set[str] = set()
        self.answers: OrderedDict[str, bytes] = OrderedDict()
        paths = [Path(path) for path in files]
        self.state: dict[str, Any] = {
            "open": [
                {"id": self.store.put_file(place), "name": place.name}
                for place in paths
                if not place.is_dir()
            ],
            "folders": [str(place.resolve()) for place in paths if place.is_dir()],
        }
        if not paths and (saved_session := session.get_saved_session()):
            self.state["last_session"] = saved_session

    async def answer(self, verb: str, body: bytes) -> bytes:
        """Return the response to a request, from the cache if possible."""
        name = sha256(verb.encode() + b"\0" + body).hexdigest()
        if name in self.answers:
            self.answers.move_to_end(name)
            return self.answers[name]
        content = await self.workers[WORKERS[verb]].ask(verb, parse_json_object(body))
        if verb in _CACHED_REQUESTS:
            self.answers[name] = content
            while len(self.answers) > MAX_CACHED:
                self.answers.popitem(last=False)
        return content

    def make_room(self) -> None:
        """Remove the oldest files that no state of the page names, if the store is full.

        Files uploaded since the page saved its state are named by none yet, and stay.
        """
        state_text = json.dumps(self.state)
        self.store.make_room(lambda identity: identity in state_text or identity in self.fresh)

    def cancel(self) -> bool:
        """Cancel long requests: studies, downloads, readings; return whether any ran."""
        workers = [self.workers["slow"]]
        if self.workers["settle"].verb in _READING_REQUESTS:
            workers.append(self.workers["settle"])
        cancelled = [worker.cancel() for worker in workers]
        return any(cancelled)

    def shut_down(self) -> None:
        """End every worker at once: pending requests get an error, and none delays the end."""
        for worker in self.workers.values():
            worker.shut_down()

    async def close(self) -> None:
        """End every worker, and remove the files."""
        await asyncio.to_thread(self.live.stop, CLOSING_SECONDS)
        for worker in self.workers.values():
            await worker.close()
        self.store.remove()


_STATE_LISTS: dict[str, type] = {"files": dict, "open": dict, "past": dict, "folders": str}
"""Type of the entries of each list in the state of a page."""


def parse_state(body: bytes) -> dict[str, Any]:
    """Return the state of a page from the body of a request, validated.

    Raises
    ------
    DataError
        If it is not a JSON object, or lists something else.
    """
    entries = parse_json_object(body)
    for name, kind in _STATE_LISTS.items():
        rows = entries.get(name, [])
        if not (isinstance(rows, list) and all(isinstance(row, kind) for row in rows)):
            type_name = "texts" if kind is str else "objects"
            raise DataError(f"the state's '{name}' is no list of {type_name}")
    return entries


def parse_json_object(body: bytes) -> dict[str, Any]:
    """Return the JSON object in the body of a request.

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
    """Raise for NaN and infinities, which are no JSON although Python reads them."""
    raise ValueError(name)


def application(context: AppContext) -> Starlette:  # noqa: C901 -- a list of routes
    """Return the routes of the app over its state, without access control."""
    from starlette.applications import Starlette
    from starlette.responses import JSONResponse, Response
    from starlette.routing import Route

    async def page(_: Request) -> Response:
        return _make_response(_read_static_file("index.html"), "text/html")

    async def static(request: Request) -> Response:
        name = request.path_params["name"]
        kind = _MEDIA_TYPES.get(name.rpartition(".")[2])
        if kind is None or name not in _list_static_files():
            return Response("there is no such file", status_code=404)
        return _make_response(_read_static_file(name), kind)

    async def charts(_: Request) -> Response:
        script = _PACKAGE.joinpath("plot", "charts.js").read_text("utf-8")
        return _make_response(script, _MEDIA_TYPES["js"])

    async def files(request: Request) -> Response:
        name = request.query_params.get("name", "file")
        modified = request.query_params.get("modified", "")
        await asyncio.to_thread(context.make_room)
        identity = await context.store.keep(
            name, request.stream(), modified=int(modified) / 1e3 if modified.isdecimal() else None
        )
        context.fresh.add(identity)
        return JSONResponse({"id": identity, "name": name})

    async def example(_: Request) -> Response:
        from dashpot import workflow

        example_files = [
            {"id": context.store.put(name, workflow.EXAMPLES[name]().encode()), "name": name}
            for name in workflow.FIRST
        ]
        return JSONResponse({"files": example_files, "mass": "114.8g", "seals": 2})

    async def ask(request: Request) -> Response:
        verb = request.path_params["verb"]
        if verb not in WORKERS:
            return JSONResponse({"error": f"there is no '{verb}'"}, status_code=404)
        return Response(
            await context.answer(verb, await _read_body(request)),
            media_type="application/octet-stream",
        )

    async def watch(request: Request) -> Response:
        names = get_list(parse_json_object(await _read_body(request)), "files")
        return JSONResponse(await asyncio.to_thread(context.watch.list_file_states, names))

    async def cancel(_: Request) -> Response:
        return JSONResponse({"cancelled": context.cancel()})

    async def working(_: Request) -> Response:
        slow = context.workers["slow"]
        return JSONResponse({"seconds": slow.seconds, "doing": slow.doing})

    async def state(request: Request) -> Response:
        if request.method == "PUT":
            context.state = parse_state(await _read_body(request, MAX_STATE_BYTES))
            context.fresh.clear()
            await asyncio.to_thread(session.save_session, context.state, context.store)
        return JSONResponse(context.state)

    async def resume(request: Request) -> Response:
        if request.method == "DELETE":
            session.delete_session()
            context.state.pop("last_session", None)
        else:
            context.state = await asyncio.to_thread(session.restore_session, context.store)
        return JSONResponse(context.state)

    async def sentence(_: Request, error: Exception) -> Response:
        codes: dict[type, int] = {TooLargeError: 413, StoppedError: 409, FaultError: 500}
        return JSONResponse(
            {"error": format_for_page(str(error))}, status_code=codes.get(type(error), 422)
        )

    async def fault(_: Request, error: Exception) -> Response:
        words = f"internal error of dashpot: {type(error).__name__}. The terminal shows more."
        return JSONResponse({"error": words}, status_code=500)

    @contextlib.asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncIterator[None]:
        for worker in context.workers.values():
            await worker.start()
        try:
            yield
        finally:
            await context.close()

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
            *_list_recording_routes(context),
            Route("/api/{verb}", ask, methods=["POST"]),
        ],
        exception_handlers={DashpotError: sentence, Exception: fault},
        lifespan=lifespan,
    )


def _list_recording_routes(context: AppContext) -> list[Route]:
    """Return the routes of the page of a live recording."""
    from starlette.responses import JSONResponse
    from starlette.routing import Route

    async def record_page(_: Request) -> Response:
        return _make_response(_read_static_file("record.html"), "text/html")

    async def recording(request: Request) -> Response:
        if request.method == "POST":
            await asyncio.to_thread(
                context.live.start, parse_json_object(await _read_body(request))
            )
        elif request.method == "DELETE":
            await asyncio.to_thread(context.live.stop)
        size = [_get_size(request, name) for name in ("width", "height")]
        return JSONResponse(await asyncio.to_thread(context.live.describe_state, *size))

    async def fit_recorded(_: Request) -> Response:
        recorded_file = context.live.describe_state(0, 0)["saved_file"]
        if recorded_file is None:
            raise DataError("no record is there to fit: start one, and stop it")
        context.state["open"] = [*context.state.get("open", []), recorded_file]
        return JSONResponse(recorded_file)

    return [
        Route("/record", record_page),
        Route("/api/record", recording, methods=["GET", "POST", "DELETE"]),
        Route("/api/record/fit", fit_recorded, methods=["POST"]),
    ]


def _get_size(request: Request, name: str) -> float:
    """Return a size in the query of a request, px; 0 without one."""
    text = request.query_params.get(name, "")
    return float(text) if text.isdecimal() else 0.0


async def _read_body(request: Request, max_bytes: int = MAX_BYTES) -> bytes:
    body = bytearray()
    async for block in request.stream():
        body += block
        if len(body) > max_bytes:
            raise TooLargeError(f"the request is larger than {max_bytes >> 20} MB")
    return bytes(body)


# Modules by their path: the name of a package would import it.
_PACKAGE = resources.files("dashpot")


def _list_static_files() -> set[str]:
    return {path.name for path in _PACKAGE.joinpath("extensions", "app", "static").iterdir()}


def _make_response(text: str, kind: str) -> Response:
    from starlette.responses import Response

    headers = {"content-encoding": "gzip"}
    return Response(_compress_text(text), media_type=kind, headers=headers)


@cache
def _compress_text(text: str) -> bytes:
    return gzip.compress(text.encode(), mtime=0)


def _read_static_file(name: str) -> str:
    text = _PACKAGE.joinpath("extensions", "app", "static", name).read_text("utf-8")
    if name == "index.html":
        icons = _PACKAGE.joinpath("report", "templates", "icons.html").read_text("utf-8")
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
        advice = format_install_command("app")
        raise DataError(f"the app needs its extra; install it with: {advice}") from None
    os.environ[plugins.SWITCH] = (
        plugins.NO_PLUGINS
    )  # a page may name none: who types a command does
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
    bound_port = int(listener.getsockname()[1])
    remove_stale_stores()
    context = AppContext(files)
    guarded_app = Guard(application(context), port=bound_port)
    address = f"http://127.0.0.1:{bound_port}/?token={guarded_app.token}"
    print(address, flush=True)  # noqa: T201 -- the one line that a program may wait for
    if browser:
        webbrowser.open(address)
    from dashpot.extensions.app.connection_limits import LimitedProtocol

    config = uvicorn.Config(
        guarded_app, log_level="error", access_log=False, lifespan="on", http=LimitedProtocol,
        timeout_graceful_shutdown=CLOSING_SECONDS,
    )  # fmt: skip

    class Server(uvicorn.Server):
        async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
            context.shut_down()
            await super().shutdown(sockets)

    Server(config).run(sockets=[listener])
