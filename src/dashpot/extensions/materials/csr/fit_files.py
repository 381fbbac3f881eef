"""Fit of the aging law to compression stress relaxation files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from dashpot.base.errors import DataError, ReadError
from dashpot.base.units import Quantity
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.specimen import make_file_specimens
from dashpot.extensions.materials.csr.datamodel import Aging
from dashpot.extensions.materials.csr.lifetime_prediction import (
    AgingPrediction,
    FittedLife,
    fit_life,
)
from dashpot.extensions.materials.csr.read import read_csr
from dashpot.reading.read_options import ReadOptions


def csr_files(
    files: Sequence[str | Path],
    *,
    temperatures: Sequence[float] = (),
    machine: Machine | None = None,
    use_at: Quantity | None = None,
    options: ReadOptions | None = None,
) -> Aging | AgingPrediction:
    """Fit the aging law to files.

    Parameters
    ----------
    files : sequence of path
    temperatures : sequence of float
        Temperatures of the ovens, K, where the files do not say theirs: one of all, or one of each.
    machine : Machine, optional
        How well the ovens are known, and how the load cell drifts.
    use_at : float or str, optional
        Temperature of use, K or ``"40degC"``: the result is the life there.
    options : ReadOptions, optional
        Reading options of the files.

    Raises
    ------
    ReadError
        If a file cannot be read, or they are no lot of one test.
    """
    try:
        specimens = make_file_specimens(None, temperatures, len(files))
        tests = [
            read_csr(path, options=options, specimen=specimen)
            for path, specimen in zip(files, specimens, strict=True)
        ]
        result = fit_life(tests, machine=machine, use_at=use_at)
    except DataError as error:
        raise ReadError(str(error)) from None
    return FittedLife(**vars(result)) if isinstance(result, AgingPrediction) else result
