"""Worker process that computes rows until its parent process ends.

Requests are lines of JSON on standard input, rows lines of JSON on standard output. A thread waits
for the end of the input: a parent that dies closes it, and the worker then exits at once.
"""

from __future__ import annotations

import json
import os
import queue
import signal
import threading
from typing import BinaryIO


def main() -> None:
    """Answer until the input ends; the choices are its first line."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to heed
    questions: queue.Queue[bytes] = queue.Queue()
    source = os.fdopen(os.dup(0), "rb")
    answers = os.fdopen(os.dup(1), "wb")
    # whatever a library prints is no row
    os.dup2(2, 1)
    threading.Thread(target=_read_questions, args=(source, questions), daemon=True).start()
    import msgspec  # noqa: F401 -- what is imported once and reads every file faster

    from dashpot.extensions.batch.batch_options import (
        BatchOptions,  # the imports are what makes a worker worth it
    )
    from dashpot.extensions.batch.input_files import Entry
    from dashpot.extensions.batch.table_row import build_rows

    choices = BatchOptions.from_plain(json.loads(questions.get()))
    while True:
        data = json.loads(questions.get())
        rows = build_rows(Entry.from_plain(data["entry"]), data["hashes"], choices)
        answers.write(json.dumps(rows, allow_nan=False).encode() + b"\n")
        answers.flush()


def _read_questions(source: BinaryIO, questions: queue.Queue[bytes]) -> None:
    while line := source.readline():
        questions.put(line)
    os._exit(0)


if __name__ == "__main__":
    main()
