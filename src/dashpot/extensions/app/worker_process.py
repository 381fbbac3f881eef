"""Worker process: answers requests one by one until its server ends.

Questions come by standard input, answers leave by standard output, as frames of `wire_format`. A
thread waits for the end of the input: a server that dies, however it dies, closes it, and the
worker leaves at once, whatever it computes, and takes the customer's files along.
"""

from __future__ import annotations

import gc
import json
import os
import queue
import shutil
import signal
import sys
import threading
import traceback
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO, NoReturn

from dashpot.base.errors import DashpotError
from dashpot.base.progress import set_progress_listener
from dashpot.extensions.app import wire_format


def stop_process_group(process_id: int) -> None:
    """End a process that was started as the first of a session, and all that it started."""
    with suppress(ProcessLookupError):
        if sys.platform == "win32":
            os.kill(process_id, signal.SIGTERM)
        else:
            os.killpg(process_id, signal.SIGKILL)


def trim_memory(max_bytes: int) -> None:
    """Return free memory to the system if this process uses more than that many bytes.

    Where the C library (of GNU) keeps it; elsewhere nothing is done.
    """
    if sys.platform != "linux":
        return
    with suppress(OSError, AttributeError):  # no /proc, or another library of C
        resident = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
        if resident * os.sysconf("SC_PAGE_SIZE") > max_bytes:
            import ctypes  # long records alone need it

            ctypes.CDLL(None).malloc_trim(0)


MAX_IDLE_BYTES = 200 << 20
"""Memory above which an idle worker returns free memory to the system, bytes."""
IDLE_SECONDS = 1.0
"""Time without a question after which a worker collects its garbage."""


def main() -> None:
    """Serve until the input ends; the folder of the files is the one argument."""
    folder = Path(sys.argv[1])
    questions: queue.Queue[bytes] = queue.Queue()
    source = os.fdopen(os.dup(0), "rb")
    answers = os.fdopen(os.dup(1), "wb")
    # whatever a library prints is no answer
    os.dup2(2, 1)
    threading.Thread(target=_listen, args=(source, questions, folder), daemon=True).start()
    try:
        from dashpot.extensions.app.handler_registry import (
            VERBS,  # the imports are what makes a worker worth keeping
        )
        from dashpot.extensions.app.view_models import preload_templates
    except Exception as error:  # noqa: BLE001 -- of any module: the page says which, at once
        traceback.print_exc()
        _answer_all_with_fault(error, questions, answers)

    if questions.empty():
        preload_templates()
    while True:
        _answer(VERBS, _wait_for_question(questions), folder, answers)
        trim_memory(MAX_IDLE_BYTES)


def _wait_for_question(questions: queue.Queue[bytes]) -> bytes:
    """Return the next question; free unused memory if there is none for a while."""
    try:
        return questions.get(timeout=IDLE_SECONDS)
    except queue.Empty:
        gc.collect()
        trim_memory(0)
        return questions.get()


def _listen(source: BinaryIO, questions: queue.Queue[bytes], folder: Path) -> None:
    while len(head := source.read(wire_format.FRAME_HEAD)) == wire_format.FRAME_HEAD:
        _, length = wire_format.parse_frame_head(head)
        questions.put(source.read(length))
    shutil.rmtree(folder, ignore_errors=True)
    stop_process_group(os.getpid())
    os._exit(0)


def _answer_all_with_fault(
    error: Exception, questions: queue.Queue[bytes], answers: BinaryIO
) -> NoReturn:
    """Answer every request with the error of an import, which a new worker would raise as well."""
    while True:
        questions.get()
        answers.write(wire_format.encode_frame("f", _format_fault(error)))
        answers.flush()


def _format_fault(error: Exception) -> bytes:
    """Return an error as text: its own message for a file, its type for an import."""
    name = type(error).__name__
    return (f"{name}, {error}" if isinstance(error, ImportError | SyntaxError) else name).encode()


def _answer(verbs: Any, question: bytes, folder: Path, answers: BinaryIO) -> None:
    data = json.loads(question)

    def send(kind: str, body: bytes) -> None:
        answers.write(wire_format.encode_frame(kind, body))
        answers.flush()

    try:
        with set_progress_listener(lambda what: send("p", what.encode())):
            send("d", verbs[data["verb"]](data["request"], folder))
    except DashpotError as error:
        send("e", str(error).encode())
    except Exception as error:  # noqa: BLE001 -- a fault must not end the worker, nor tell of files
        send("f", _format_fault(error))


if __name__ == "__main__":
    main()
