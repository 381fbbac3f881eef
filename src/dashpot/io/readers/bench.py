"""From a file to the test of a bench, whichever it is: ramp and hold, or a dynamic sweep."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from dashpot.base.errors import ReadError
from dashpot.io.options import ReadOptions
from dashpot.io.readers.relaxation import read_relaxation
from dashpot.records.relaxation import RelaxationTest
from dashpot.records.specimen import Specimen

if TYPE_CHECKING:
    from dashpot.records.dynamic import DynamicTest


def read_bench(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> RelaxationTest | DynamicTest:
    """Return the relaxation test or the dynamic (DMA) test in a file, in SI units.

    Raises
    ------
    ReadError
        If the file is neither, or leaves open which column is what or in which unit.
    """
    try:
        return read_relaxation(path, options=options, specimen=specimen)
    except ReadError:
        from dashpot.io.readers.dynamic import read_dynamic
        from dashpot.io.readers.inspect import inspect_file

        if str(path) == "-" or inspect_file(path, options=options).kind != "dma":
            raise
    return read_dynamic(path, options=options, specimen=specimen)
