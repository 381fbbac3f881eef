"""Closing analysis of a door file."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from dashpot.base.checks import Check
from dashpot.datamodel.fit import Fit
from dashpot.extensions.systems.door import checks
from dashpot.extensions.systems.door.analyse_file import (
    add_file_to_errors,
    check_contact,
    open_door,
)
from dashpot.extensions.systems.door.closing_analysis import ClosingAnalysis, SealDoubt, close_door
from dashpot.extensions.systems.door.closing_result import ClosingResult
from dashpot.extensions.systems.door.door_model import Door
from dashpot.vibration.checks import compression_tested

__all__ = ["ClosingResult", "close_file"]


def close_file(
    path: str | Path | Door, speed: float, *, temperature: float | None = None
) -> ClosingResult:
    """Close the door of a file against its seal.

    Parameters
    ----------
    path : path or Door
        TOML, as :func:`~dashpot.extensions.systems.door.read.read_door` reads it.
    speed : float
        Initial speed at the door's edge, m/s.
    temperature : float, optional
        Temperature of the seal, K, in place of the value in the file.

    Raises
    ------
    ReadError
        If a file cannot be read, or holds an impossible value.
    DataError
        If the file lacks values for closing.
    """
    assembly, fit = open_door(path, temperature=temperature)
    with add_file_to_errors(path):
        closing = close_door(
            assembly.door,
            speed=speed,
            seal_uncertainty=None if fit is None else SealDoubt.from_fit(fit),
        )
        return ClosingResult(assembly.door, fit, closing, tuple(_check_closing(closing, fit)))


def _check_closing(closing: ClosingAnalysis, fit: Fit | None) -> Iterator[Check]:
    yield checks.faster_closings_latch(closing.monotone)
    compressions, pieces = closing.door.compression, closing.door.length
    yield check_contact(compressions, np.cumsum(pieces) - 0.5 * pieces, float(pieces.sum()))
    if fit is None:
        return
    solid = closing.door.section.solid
    yield checks.closing_in_valid_band(
        closing.sealing,
        fit.band,
        glassy=solid.k_0 / solid.k_inf if solid.k_inf > 0 else float("inf"),
        values=closing.interval,
    )
    law = fit.elastic_law
    yield compression_tested(float(compressions.max()), None if law is None else law.depth)
    yield from fit.checks
