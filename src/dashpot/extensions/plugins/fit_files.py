"""Fit by a plug-in to a file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from dashpot.extensions.plugins.datamodel import PluginFit
from dashpot.extensions.plugins.fit import fit_plugged
from dashpot.extensions.plugins.read import read_plugged
from dashpot.reading.raw_file import add_name_to_errors
from dashpot.reading.read_options import ReadOptions


def plugged_files(files: Sequence[str | Path], *, options: ReadOptions | None = None) -> PluginFit:
    """Return the result for a file by the plug-in that ``options.kind`` names.

    Raises
    ------
    ReadError, FitError
        If the file cannot be read, the plug-in fails, or there are several files.
    """
    tests = [read_plugged(path, options=options) for path in files]
    with add_name_to_errors(Path(files[0]).name):
        return fit_plugged(tests)
