"""Public Python functions for the modes of FRFs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dashpot.api.fit import identify_record_kinds
from dashpot.base.units import Quantity, Range, convert_to_si, si_range
from dashpot.datamodel.structure import FRFSet
from dashpot.extensions.modes.mass_series_files import MassSeriesModes
from dashpot.extensions.modes.measured_modes import modes_of
from dashpot.extensions.modes.read_frf_set import read_frfs
from dashpot.workflow.measured_frf import Modes


def merge_frf_set(records: Sequence[Any]) -> FRFSet:
    """Return FRFs as one set of points."""
    if len(records) == 1 and isinstance(records[0], FRFSet):
        return records[0]
    frfs = [
        frf
        for record in records
        for frf in (record.frfs if isinstance(record, FRFSet) else (record,))
    ]
    return FRFSet(tuple(frfs))


def fit_modes(records: list[Any], *, band: Range | None = None) -> Modes:
    """Fit modes to FRFs without a mass."""
    return modes_of(merge_frf_set(records), band=si_range(band, "frequency"))[0]


def fit_mass_series(
    records: list[Any],
    *,
    mass: Sequence[Quantity],
    seals: float = 1.0,
    band: Range | None = None,
) -> MassSeriesModes:
    """Fit modes to FRFs under several masses."""
    from dashpot.extensions.modes.mass_series_files import fit_modes_by_mass

    return fit_modes_by_mass(
        [merge_frf_set([record]) for record in records],
        [convert_to_si(item, "mass") for item in mass],
        list(identify_record_kinds(records)),
        seals=seals,
        band=si_range(band, "frequency"),
    )


def read_frf_record(path: str | Path, options: dict[str, Any], _: Mapping[str, Any]) -> Any:
    """Read an FRF, or a set of them at several points."""
    frfs = read_frfs([path], **options)
    return frfs if len(frfs.points) > 1 else frfs.frfs[0]
