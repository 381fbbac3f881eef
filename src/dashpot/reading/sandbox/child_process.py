"""Child process of the sandbox: reads one file for its parent and ends."""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Callable
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import BinaryIO

from dashpot.base.errors import DashpotError, ReadError
from dashpot.reading.raw_file import RawFile
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox import limits, message_protocol

_MAX_LENGTH = 2000


def main() -> None:
    """Read a request from stdin, write the response to stdout, and exit at once."""
    with os.fdopen(os.dup(1), "wb") as output:
        os.dup2(2, 1)  # what a library prints is not the answer
        _serve(sys.stdin.buffer, output)
    os._exit(0)


def _serve(stream: BinaryIO, output: BinaryIO) -> None:
    request = message_protocol.receive(stream)
    gc.disable()  # soon all is gone; of sixty thousand channels it costs a fifth to look for it
    limits.confine(request["seconds"])
    raw = RawFile(request["name"], request["path"] and Path(request["path"]), stream.read())
    options = ReadOptions(**request["options"])
    module, name = request["function"]
    try:
        function = getattr(import_module(module), name)
        if request["columns"] is not None:
            function = partial(function, columns=request["columns"])
        message_protocol.send_reply(output, run_parser(request["format"], function, raw, options))
    except DashpotError as error:
        message_protocol.send(output, {"error": str(error)[:_MAX_LENGTH]})


def run_parser(
    format_name: str,
    function: Callable[[RawFile, ReadOptions], message_protocol.Reply],
    raw: RawFile,
    options: ReadOptions,
) -> message_protocol.Reply:
    """Return the table that a foreign parser reads from a file of the format `format_name`.

    Raises
    ------
    DashpotError
        On any failure, including panics of Rust, which are no Exception.
    """
    try:
        return function(raw, options)
    except DashpotError:
        raise
    except (MemoryError, SystemError):  # NumPy raises this where it has no memory to select rows
        raise ReadError(
            f"takes more than {limits.MEMORY >> 30} GiB of memory to read as {format_name}; "
            "export a part of it, or as text"
        ) from None
    except OSError as error:
        raise ReadError(f"cannot be read: {type(error).__name__} {error}") from None
    except BaseException as error:  # noqa: BLE001
        raise ReadError(
            f"a broken or unknown variety of {format_name}: {type(error).__name__}: {error}; "
            "export it again, or as text"
        ) from None
