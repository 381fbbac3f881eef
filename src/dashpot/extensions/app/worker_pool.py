"""Pool of worker processes, divided so that a long computation delays no short one."""

from __future__ import annotations

import asyncio
import json
import time
from pathlib import Path
from typing import Any

from dashpot.base.errors import DashpotError, DataError
from dashpot.base.subprocesses import get_long_lived_env, interpreter
from dashpot.extensions.app import wire_format
from dashpot.extensions.app.worker_process import stop_process_group


class StoppedError(DashpotError):
    """Error of a computation that was cancelled, or whose process died."""


class FaultError(DashpotError):
    """Error caused by a bug of dashpot."""


class WorkerProcess:
    """Worker process that answers one request at a time; restarted after a cancellation.

    Parameters
    ----------
    folder : Path
        Folder of the files.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._request_lock = asyncio.Lock()
        self._process: asyncio.subprocess.Process | None = None
        self._started_at = 0.0
        self._cancelled = self._is_closed = False
        self.verb = self.doing = ""

    @property
    def seconds(self) -> float | None:
        """For how long it has been at work; None if it is not."""
        return time.monotonic() - self._started_at if self._started_at else None

    async def ask(self, verb: str, request: Any) -> bytes:
        """Return the response to a request.

        Raises
        ------
        DataError
            With the sentence that the work ended in.
        StoppedError, FaultError
            If it was cancelled, or went wrong.
        """
        async with self._request_lock:
            if self._is_closed:
                raise StoppedError("cancelled")
            process = await self.start()
            self._started_at, self.doing, self._cancelled = time.monotonic(), "", False
            self.verb = verb
            try:
                return await self._answer(process, verb, request)
            except (asyncio.IncompleteReadError, ConnectionError):
                await process.wait()
                if self._cancelled:
                    await self._prestart()
                raise StoppedError(
                    "cancelled"
                    if self._cancelled
                    else "the computation ended without an answer: "
                    "it may have needed more memory than there is"
                ) from None
            except asyncio.CancelledError:
                # nobody waits for the answer, and the next question must not get it
                self.cancel()
                raise
            finally:
                self._started_at = 0.0

    async def start(self) -> asyncio.subprocess.Process:
        """Start the worker if none is running."""
        if self._process is None or self._process.returncode is not None:
            self._process = await asyncio.create_subprocess_exec(
                *interpreter("dashpot.extensions.app.worker_process"), str(self._folder),
                stdin=asyncio.subprocess.PIPE, stdout=asyncio.subprocess.PIPE,
                env=get_long_lived_env(), start_new_session=True,
            )  # fmt: skip
        return self._process

    async def _prestart(self) -> None:
        """Start a new process, so that its modules are loaded before the next request."""
        if not self._is_closed:
            await self.start()
        self._end_if_closed()

    def _end_if_closed(self) -> None:
        if self._is_closed:  # meanwhile
            self.end()

    async def _answer(self, process: asyncio.subprocess.Process, verb: str, request: Any) -> bytes:
        assert process.stdin is not None and process.stdout is not None  # noqa: PT018, S101
        question = json.dumps({"verb": verb, "request": request}).encode()
        process.stdin.write(wire_format.encode_frame("q", question))
        await process.stdin.drain()
        while True:
            kind, length = wire_format.parse_frame_head(
                await process.stdout.readexactly(wire_format.FRAME_HEAD)
            )
            body = await process.stdout.readexactly(length)
            if kind == "d":
                return body
            if kind == "e":
                raise DataError(body.decode())
            if kind == "f":
                raise FaultError(
                    f"internal error of dashpot: {body.decode()}. The terminal shows more."
                )
            self.doing = body.decode()

    def cancel(self) -> bool:
        """End the computation with its process and its reader; True if there was one."""
        is_running = self.seconds is not None
        if is_running:
            self._cancelled = True
            self.end()
        return is_running

    def end(self) -> None:
        """End the worker at once."""
        if self._process is not None and self._process.returncode is None:
            stop_process_group(self._process.pid)

    def shut_down(self) -> None:
        """End the worker, and start no other for waiting requests."""
        self._is_closed = True
        self.end()

    async def close(self) -> None:
        """End the worker, and see it gone."""
        self.shut_down()
        if self._process is not None:
            await self._process.wait()
