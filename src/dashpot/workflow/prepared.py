"""From files of relaxation tests to prepared records; where their questions are answered."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import dashpot as dp
from dashpot.base.errors import DataError, ReadError
from dashpot.io.options import ReadOptions
from dashpot.records.machine import Machine
from dashpot.records.relaxation import RampHold


def prepared_files(
    files: Sequence[str | Path],
    *,
    options: ReadOptions | None = None,
    machine: Machine | None = None,
) -> tuple[RampHold, ...]:
    """Return the relaxation tests in files, prepared, each by the loading that was asked for."""
    cycle = None if options is None else options.cycle
    return tuple(
        dp.prepare(dp.read_relaxation(path, options=options), machine=machine, cycle=cycle)
        for path in files
    )


@contextmanager
def answered_in(option: str) -> Iterator[None]:
    """Say where a question is answered if the command's own options are for another file."""
    try:
        yield
    except (ReadError, DataError) as error:
        if "--" not in str(error):
            raise
        raise ReadError(
            f"{error} (the options of this command are for its other file: keep the answer for "
            f"this one with dashpot inspect --save-profile FILE, and give it by {option} FILE)"
        ) from None
