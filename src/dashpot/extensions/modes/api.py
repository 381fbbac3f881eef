"""Modes of FRFs, as Python asks for them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from dashpot.api.fit import kinds_of, set_of
from dashpot.base.units import Quantity, Range, si, si_range
from dashpot.extensions.modes.mass_series_files import ModesByMass
from dashpot.extensions.modes.measured_modes import modes_of
from dashpot.extensions.modes.read_frf_set import read_frfs
from dashpot.workflow.vibration.modes import Modes


def fit_modes(records: list[Any], *, band: Range | None = None) -> Modes:
    """Fit modes to FRFs without a mass."""
    return modes_of(set_of(records), band=si_range(band, "frequency"))[0]


def fit_mass_series(
    records: list[Any],
    *,
    mass: Sequence[Quantity],
    seals: float = 1.0,
    band: Range | None = None,
) -> ModesByMass:
    """Fit modes to FRFs under several masses."""
    from dashpot.extensions.modes.mass_series_files import modes_under

    return modes_under(
        [set_of([one]) for one in records],
        [si(one, "mass") for one in mass],
        list(kinds_of(records)),
        seals=seals,
        band=si_range(band, "frequency"),
    )


def read_frf_record(path: str | Path, given: dict[str, Any], _: Mapping[str, Any]) -> Any:
    """Read an FRF, or a set of them at several points."""
    found = read_frfs([path], **given)
    return found if len(found.points) > 1 else found.frfs[0]
