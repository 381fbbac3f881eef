"""Lot row of a compression load deflection test."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.materials.cld.datamodel import CLD
from dashpot.extensions.materials.cld.preprocess import cld
from dashpot.extensions.materials.cld.read import read_cld
from dashpot.registry import LotSpecimen


def build_lot_row(file: str | Path, lot_specimen: LotSpecimen) -> tuple[CLD, dict[str, Any]]:
    """Return the figures of a load deflection record, and its columns of a lot row.

    Raises
    ------
    ReadError, DataError
        If it cannot be read, or was not pressed to the nominal compression.
    """
    specimen = Specimen(temperature=lot_specimen.temperature, length=lot_specimen.length)
    test = read_cld(file, options=lot_specimen.options, specimen=specimen)
    result = cld(
        test,
        at=lot_specimen.compression,
        cycle=lot_specimen.options.cycle,
        machine=lot_specimen.machine,
    )
    nominal, cycle = result.nominal, result.cycle
    has_several_cycles = len(result.cycles) > 1
    return result, {
        "samples": len(result.force),
        "temperature_K": result.specimen.temperature,
        "depth_m": cycle.depth,
        "force_noise_N": result.noise,
        "cld_at_m": nominal.compression,
        "cld_force_N": nominal.loading,
        "cld_force_se_N": nominal.loading_se,
        "cld_per_100mm_N": None if result.specimen.length is None else result.per * nominal.loading,
        "cld_slope_N_per_m": nominal.slope,
        "cld_hysteresis": cycle.hysteresis,
        "cld_softening": result.softening if has_several_cycles else None,
        "cld_set_m": result.set,
    }
