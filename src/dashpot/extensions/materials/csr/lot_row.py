"""Lot row of a compression stress relaxation test."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.materials.csr.datamodel import Aging
from dashpot.extensions.materials.csr.fit import fit_aging
from dashpot.extensions.materials.csr.read import read_csr
from dashpot.registry import LotSpecimen


def build_lot_row(file: str | Path, lot_specimen: LotSpecimen) -> tuple[Aging, dict[str, Any]]:
    """Return the aging law of the specimens in one file, and its columns of a lot row.

    Raises
    ------
    ReadError, DataError, FitError
        If it cannot be read, or no law follows it.
    """
    specimen = Specimen(temperature=lot_specimen.temperature)
    test = read_csr(file, options=lot_specimen.options, specimen=specimen)
    aging = fit_aging([test], machine=lot_specimen.machine)
    loss, time, *_ = aging.reported_values
    return aging, {
        "samples": sum(len(oven.time) for oven in aging.ovens),
        "method": min(aging.orders, key=lambda pair: pair[1])[0] if aging.orders else "physical",
        "csr_loss_per_decade": loss.value,
        "csr_chemical_time_s": None if aging.law.is_lower_bound else time.value,
        "csr_chemical_time_low_s": time.low,
        "csr_activation_J_per_mol": aging.law.activation or None,
    }
