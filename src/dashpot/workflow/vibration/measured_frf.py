"""What was measured, whatever was struck or shaken: from files to an FRF that is judged."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from dashpot.base.checks import Check
from dashpot.base.errors import DataError, FitError, ReadError
from dashpot.base.number_format import format_count
from dashpot.base.option_fields import flag_of, iterate_option_fields
from dashpot.base.plausibility import SIZES
from dashpot.base.provenance import Step
from dashpot.datamodel.base_excitation import ShakenTest
from dashpot.datamodel.checks import caution_checks
from dashpot.datamodel.frf import FRF, Mode
from dashpot.datamodel.impact import ImpactTest
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.base_excitation import read_shaken
from dashpot.reading.readers.detect_kind import recognise
from dashpot.reading.readers.frf import read_frf
from dashpot.reading.readers.impact import HITS, hits_in
from dashpot.registry import RESPONSES
from dashpot.vibration.impact.base_excitation import estimate_transmissibility
from dashpot.vibration.impact.checks import (
    channels_not_clipped,
    coherence,
    frf_dissipates,
    mass_over_base,
    resonance,
    scatter_known,
    segments_resolve,
)
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.vibration.modal.peaks import find_peak
from dashpot.vibration.systems.frf_prediction import moving_mass
from dashpot.vibration.systems.mount_mass import as_relative, compute_coupled_mass, on_light_mounts
from dashpot.workflow.job import HammerChoices

_NO_MASS = (
    "the file holds a transmissibility, which tells the stiffness over the mass and neither alone: "
    "give the mass (--mass)"
)
_UNIT = 1.0
"""kg; the mass that a transmissibility leaves open."""
_NO_BASE = "--relative is of a mass over a base that moves, and here a force moves it: leave out"


def read_measured(
    paths: Sequence[str | Path],
    *,
    choices: HammerChoices,
    options: ReadOptions,
    mass: float | None = None,
    band: tuple[float, float] | None = None,
) -> tuple[ImpactTest | None, FRF]:
    """Return the hits that files hold and their FRF, or the FRF that a file holds.

    Its checks are about the resonance in `band`, Hz.
    """
    record: FRF | ShakenTest | ImpactTest
    if options.base_acceleration is not None:
        record = read_shaken(paths, options)
    elif len(paths) == 1 and recognise(paths[0], options).kind in RESPONSES:
        record = read_frf(paths[0], options=options)
    else:
        record = hits_in(list(paths), options, f"an FRF or {HITS}")
    frf = measured_frf(record, choices=choices, mass=mass, band=band)
    return record if isinstance(record, ImpactTest) else None, frf


def measured_frf(
    record: FRF | ShakenTest | ImpactTest | Sequence[ImpactTest],
    *,
    choices: HammerChoices,
    mass: float | None = None,
    band: tuple[float, float] | None = None,
) -> FRF:
    """Return the FRF of what was measured, with what it says of itself.

    Raises
    ------
    ReadError
        If it is of a base that moves, and no mass, kg, is given.
    """
    if isinstance(record, ShakenTest):
        if mass is None:
            raise ReadError(_NO_MASS)
        return estimate_base_transmissibility(record, choices=choices, mass=mass, band=band)[0]
    if isinstance(record, FRF):
        refuse_choices_of_hits(choices, "the file holds an FRF", but=("motion", "polarity"))
        frf = _apply_polarity(as_measured(record, choices.motion), choices)
        if frf.quantity.over_base and mass is None:
            raise ReadError(_NO_MASS)
        return add_frf_checks(frf, band, mass=mass)
    return average(record, choices=choices, mass=mass, band=band)


def _apply_polarity(frf: FRF, choices: HammerChoices) -> FRF:
    """The FRF with the sign that the user gives it; refuse what else is of hits.

    Raises
    ------
    ReadError
    """
    refuse_choices_of_hits(choices, "an FRF was averaged already", but=("polarity", "motion"))
    return with_polarity([frf], choices.polarity)[0]


def with_polarity(frfs: Sequence[FRF], polarity: Sequence[int] | None) -> tuple[FRF, ...]:
    """Return FRFs with the sign that is given to each, +1 or -1; without any as they are.

    Raises
    ------
    ReadError
        If there is not one sign for each.
    """
    if polarity is None:
        return tuple(frfs)
    if len(polarity) != len(frfs):
        raise ReadError(
            f"--polarity was given {len(polarity)} times for {format_count(len(frfs), 'FRF')}; "
            "give +1 "
            "or -1 for each, in their order"
        )
    step = Step("polarity", (("turned", "FRF"),), "the sign of the FRF was turned, as given")
    return tuple(
        replace(frf, value=-frf.value, steps=(*frf.steps, step)) if sign < 0 else frf
        for frf, sign in zip(frfs, polarity, strict=True)
    )


def estimate_base_transmissibility(
    test: ShakenTest,
    *,
    choices: HammerChoices,
    mass: float | None,
    band: tuple[float, float] | None = None,
) -> tuple[FRF, tuple[Mode, ...], str]:
    """Return the transmissibility of a shaken base, judged, its modes, and why there are none.

    Frequency and damping do not depend on the mass, kg: where it is not given, 1 kg stands for it.
    """
    refuse_choices_of_hits(
        choices, "the base was shaken (--column base-acceleration)",
        but=("estimator", "record", "motion"),
    )  # fmt: skip
    frf = estimate_transmissibility(test, estimator=choices.estimator, segment=choices.record)
    frf = as_measured(frf, choices.motion)
    whole = channels_not_clipped(test)
    mass = _UNIT if mass is None else mass
    modes: tuple[Mode, ...] = ()
    reason = ""
    try:
        modes = frf.to("accelerance", mass=mass).modes(band=band)
    except (DataError, FitError) as error:
        reason = str(error)
    main = next(iter(modes), None)
    checks = [] if main is not None else [resonance(frf, None)]
    resolved = segments_resolve(frf, main)
    frf = add_frf_checks(frf, band, mass=mass)
    return replace(frf, checks=(*frf.checks, whole, *checks, resolved)), modes, reason


def as_measured(frf: FRF, motion: str) -> FRF:
    """The same, relative where the user says so of the motion of a mass over a base."""
    if motion == "absolute":
        return frf
    if not frf.quantity.over_base:
        raise ReadError(_NO_BASE)
    return as_relative(frf)


def refuse_choices_of_hits(choices: HammerChoices, why: str, *, but: Sequence[str] = ()) -> None:
    """Refuse choices that only hits have a use for, all `but` some.

    Raises
    ------
    ReadError
    """
    default = HammerChoices()
    odd = [
        flag_of(field)
        for field in iterate_option_fields(choices)
        if field.name not in but and getattr(choices, field.name) != getattr(default, field.name)
    ]
    if odd:
        raise ReadError(f"{', '.join(odd)}: of hits, and {why}; leave out")


def add_frf_checks(
    frf: FRF,
    band: tuple[float, float] | None,
    main: Mode | None = None,
    *,
    mass: float | None = None,
    driven: bool = True,
) -> FRF:
    """Return an FRF that was averaged elsewhere with what it says of itself at its peak.

    The peak is the highest in `band`, Hz, or that of a mode; a transmissibility needs the mass, kg.
    Only where a point is struck itself (`driven`) does its phase tell whether the part dissipates.
    """
    near = frf.to("accelerance", mass=mass)
    near = near if band is None else near.band(*band)
    peak = find_peak(near) if main is None else main
    at = int(np.argmin(np.abs(near.frequency - peak.frequency)))
    checks = [frf_dissipates(complex(near.value[at]), float(near.frequency[at]))] * driven
    if frf.quantity.over_base:
        checks.insert(0, mass_over_base(frf))
    if frf.coherence is not None:
        checks.append(coherence(near, at))
    elif frf.sd is None:
        checks.append(scatter_known())
    checks += caution_checks(frf.source)
    return replace(frf, checks=(*frf.checks, *checks))


def average(
    impact: ImpactTest | Sequence[ImpactTest],
    *,
    choices: HammerChoices,
    mass: float | None = None,
    band: tuple[float, float] | None = None,
) -> FRF:
    """Return the FRF of an impact test under these choices."""
    options = asdict(choices)
    if options.pop("motion") != "absolute":
        raise ReadError(_NO_BASE)
    return estimate_frf(impact, **options, mass=mass, resonance_band=band)


def total_mass(
    block: float | None, *, seal: float | None, seals: float
) -> tuple[float | None, tuple[Check, ...]]:
    """Return the block's mass with what moves of the seals, where both are known."""
    if block is not None:
        SIZES["mass"].refuse(block)
    if block is None or seal is None:
        return block, ()
    mass, check = moving_mass(block, seal=seal, seals=seals)
    return mass, (check,)


def remove_seal_mass(frf: FRF, mass: float | None, seal_mass: float | None, seals: float) -> FRF:
    """Return a transmissibility as seals without mass would show it; another FRF as it is."""
    if not frf.quantity.over_base or mass is None:
        return frf
    return on_light_mounts(frf, mass=mass, coupled=compute_coupled_mass(seal_mass, seals))
