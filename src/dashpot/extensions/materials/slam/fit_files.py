"""Fit of a piece's loss factor to slam files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from dashpot.base.errors import DataError, ReadError
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.materials.slam.datamodel import SlamFit
from dashpot.extensions.materials.slam.fit import fit_slams
from dashpot.extensions.materials.slam.read import read_slams
from dashpot.reading.read_options import ReadOptions


def slam_files(
    files: Sequence[str | Path],
    *,
    mass: float | None = None,
    slam: Sequence[str] = (),
    memory: Sequence[Fit] = (),
    specimen: Specimen | None = None,
    options: ReadOptions | None = None,
) -> SlamFit:
    """Find what the slams in files say of one piece.

    Parameters
    ----------
    files : sequence of path
    mass, slam, memory
        As :func:`~dashpot.extensions.materials.slam.fit.fit_slams` takes them, of the slams of all
        files in their order.
    specimen : Specimen, optional
    options : ReadOptions, optional
        What the user said of the files.

    Raises
    ------
    ReadError, FitError
        If a file cannot be read, or no motion follows its slams.
    """
    tests = [read_slams(path, options=options, specimen=specimen) for path in files]
    try:
        return fit_slams(tests, mass=mass, slam=slam, memory=memory)
    except DataError as error:
        raise ReadError(str(error)) from None
