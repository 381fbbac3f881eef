"""Fit of a specimen's loss factor to drop-test files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from dashpot.base.errors import DataError, ReadError
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.materials.drop.datamodel import DropFit
from dashpot.extensions.materials.drop.fit import fit_drop_tests
from dashpot.extensions.materials.drop.read import read_drop_test
from dashpot.reading.read_options import ReadOptions


def fit_drop_files(
    files: Sequence[str | Path],
    *,
    mass: float | None = None,
    drop: Sequence[str] = (),
    relaxation: Sequence[Fit] = (),
    specimen: Specimen | None = None,
    options: ReadOptions | None = None,
) -> DropFit:
    """Fit the loss factor of one specimen to drop-test files.

    Parameters
    ----------
    files : sequence of path
    mass, drop, relaxation
        As in :func:`~dashpot.extensions.materials.drop.fit.fit_drop_tests`, of the impacts of all
        files in their order.
    specimen : Specimen, optional
    options : ReadOptions, optional
        How to read the files.

    Raises
    ------
    ReadError, FitError
        If a file cannot be read, or no motion fits its impacts.
    """
    tests = [read_drop_test(path, options=options, specimen=specimen) for path in files]
    try:
        return fit_drop_tests(tests, mass=mass, drop=drop, relaxation=relaxation)
    except DataError as error:
        raise ReadError(str(error)) from None
