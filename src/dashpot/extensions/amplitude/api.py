"""Public Python functions for tests at several amplitudes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dashpot.api.fit import VIBRATION_RECORDS
from dashpot.base.errors import FitError
from dashpot.base.option_fields import AmplitudeLawOption
from dashpot.base.units import Quantity, Range, convert_to_si, si_range
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.extensions.amplitude.datamodel import AmplitudeFit
from dashpot.extensions.amplitude.fit_files import AmplitudeResult
from dashpot.registry import KINDS, load_object
from dashpot.workflow.job import require_test_for_machine

if TYPE_CHECKING:
    from dashpot.extensions.amplitude.amplitude_response import SweptPart
    from dashpot.extensions.amplitude.datamodel import AmplitudeSweep
    from dashpot.workflow.job import LevelChoices, PartChoices


def fit_levels(
    records: list[Any],
    *,
    levels: Sequence[Quantity] = (),
    mass: Quantity | None = None,
    seals: float = 1.0,
    band: Range | None = None,
    model: AmplitudeLawOption = "auto",
    resonance_at: Sequence[Quantity] = (),
    machine: Machine | None = None,
) -> AmplitudeResult | AmplitudeFit:
    """Fit the law of tests at several amplitudes."""
    from dashpot.extensions.amplitude.fit_files import (
        fit_amplitude_record,
        frfs_at_levels,
        hits_at_levels,
    )

    at = [convert_to_si(item, "force") for item in resonance_at]
    kilograms, hertz = convert_to_si(mass, "mass"), si_range(band, "frequency")
    if any(isinstance(record, VIBRATION_RECORDS) for record in records):
        require_test_for_machine(machine, tests=0, add="recorded loops")
    if all(isinstance(record, ImpactTest) for record in records):
        return hits_at_levels(records, levels, mass=kilograms, band=hertz, at=at)
    if all(isinstance(record, FRF) for record in records):
        return frfs_at_levels(records, levels, mass=kilograms, seals=seals, band=hertz, at=at)
    if len(records) > 1:
        raise FitError(
            "one amplitude sweep is fitted at a time; only FRFs at several amplitudes, or hits, "
            "go together"
        )
    return fit_amplitude_record(records[0], law=model, machine=machine).fit  # type: ignore[return-value]  # of a sweep


def fit_sweep(
    sweep: AmplitudeSweep, choices: LevelChoices, *, unit: str, part: PartChoices | None
) -> SweptPart:
    """Fit an amplitude sweep, and return the effect of amplitude on the part."""
    from dashpot.extensions.amplitude.amplitude_response import make_swept_part
    from dashpot.extensions.amplitude.fit import fit_amplitude

    return make_swept_part(fit_amplitude(sweep), sweep, choices, unit=unit, part=part)


def read_loops_as_sweep(
    path: str | Path, arguments: dict[str, Any], keywords: Mapping[str, Any]
) -> Any:
    """Read recorded loops as a sweep of amplitude."""
    from dashpot.extensions.amplitude.preprocess import compute_sweep
    from dashpot.reading.raw_file import add_name_to_errors

    specimen = keywords.get("specimen")
    record = load_object(KINDS["cyclic"].reader)(path, specimen=specimen, **arguments)
    with add_name_to_errors(Path(path).name):
        return compute_sweep(record)
