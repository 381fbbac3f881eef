"""Lot row of recorded loops."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from dashpot.base.arrays import median
from dashpot.base.units import column
from dashpot.extensions.amplitude.fit_files import AmplitudeResult, level_files
from dashpot.extensions.amplitude.preprocess import compute_sweep
from dashpot.registry import LotSpecimen

_SAME_AMPLITUDE_FACTOR = 1.05
"""Ratio up to which amplitudes count as equal."""
_UNITS = (("N/m", "m"), ("Pa", ""))
"""Units of storage and amplitude: of a part, and of a material."""


def build_lot_row(
    file: str | Path, lot_specimen: LotSpecimen
) -> tuple[AmplitudeResult, dict[str, Any]]:
    r"""Return the fit of loops, and its columns of a lot row.

    They are medians at the largest amplitude and, of several frequencies there, the lowest. The
    standard errors are of the scatter there and of the delay :math:`\delta` between the channels,
    :math:`\omega\delta K'` of the loss. The softening is the part of the storage at the smallest
    amplitude of that frequency that is lost at the largest.

    Raises
    ------
    ReadError, DataError, FitError
        If it cannot be read or fitted.
    """
    result = level_files((file,), options=lot_specimen.options, machine=lot_specimen.machine)
    record: Any = result.records[0]
    sweep = compute_sweep(record)
    top = sweep.only(sweep.amplitude >= sweep.amplitude.max() / _SAME_AMPLITUDE_FACTOR)
    tone = float(top.frequency.min())
    top, at_tone = top.only(top.frequency == tone), sweep.only(sweep.frequency == tone)
    smallest = at_tone.only(at_tone.amplitude <= at_tone.amplitude.min() * _SAME_AMPLITUDE_FACTOR)
    storage, loss = median(top.storage), median(top.loss)
    scatter = (
        1.4826
        * np.array([median(np.abs(values - median(values))) for values in (top.storage, top.loss)])
        / np.sqrt(len(top.amplitude))
    )
    phase_error = 2 * np.pi * tone * sweep.delay_sd
    has_several_amplitudes = (
        sweep.amplitude.max() > _SAME_AMPLITUDE_FACTOR * smallest.amplitude.max()
    )
    kelvin = sweep.specimen.temperature or lot_specimen.temperature
    values = {
        column(f"loop_{name}", unit): None
        for unit, _ in _UNITS
        for name in ("storage", "storage_se", "loss", "loss_se")
    } | {column("loop_amplitude", of): None for _, of in _UNITS}
    return result, values | {
        "samples": len(record.time),
        "temperature_K": kelvin,
        "loop_frequency_Hz": tone,
        column("loop_amplitude", "m" if sweep.amplitude_unit == "m" else ""): median(top.amplitude),
        column("loop_storage", sweep.unit): storage,
        column("loop_storage_se", sweep.unit): float(np.hypot(scatter[0], phase_error * abs(loss))),
        column("loop_loss", sweep.unit): loss,
        column("loop_loss_se", sweep.unit): float(np.hypot(scatter[1], phase_error * storage)),
        "loop_loss_factor": loss / storage,
        "loop_softening": 1 - storage / median(smallest.storage)
        if has_several_amplitudes
        else None,
    }
