"""Comparison of a lot's fit with a hammer test, or their joint fit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dashpot.base.checks import verdict
from dashpot.base.errors import DataError
from dashpot.base.plain_text import decapitalise_sentence
from dashpot.base.provenance import SIMULATED, Source
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.relaxation import RampHold
from dashpot.extensions.batch.batch_options import BatchOptions, find_test_machine
from dashpot.extensions.batch.input_files import Entry
from dashpot.vibration.comparison.comparison_result import Comparison
from dashpot.vibration.mass_on_seals import MassOnSeals
from dashpot.vibration.modal.peaks import find_peak
from dashpot.workflow.frf_comparison import compare_with_measured
from dashpot.workflow.job import HammerChoices
from dashpot.workflow.measured_frf import read_measured
from dashpot.workflow.stiffness_under_mass import find_static_equilibrium

if TYPE_CHECKING:
    from dashpot.workflow.bench_tests import Record


def compare_with_hammer(
    fit: Fit, record: Record, entry: Entry, choices: BatchOptions, mass: float | None
) -> tuple[Fit, dict[str, Any]]:
    """Return the fit, or the joint fit if requested, and the comparison with the hammer.

    Of seals at another temperature the resonance alone: one test does not say how they move.

    Raises
    ------
    ReadError, DataError, FitError
        If the hits cannot be read, averaged or held against a prediction.
    """
    if mass is None:
        raise DataError("no mass is known, so that nothing is predicted: give --mass")
    if fit.unit != "N/m":
        raise DataError("a test of a material predicts no resonance; pair it with a test of a seal")
    _, frf = read_measured(
        entry.hammer, choices=HammerChoices(), options=choices.reading_impact, mass=mass
    )
    origin = make_origin_column(*fit.source, *frf.source)
    if entry.hammer_temperature is not None:
        try:
            fit.at(entry.hammer_temperature)
        except DataError as error:
            return fit, _find_resonance(frf) | origin | {"reason": f"hammer: {error}"}
    mass_on_seals = MassOnSeals(mass, choices.seals)
    _, comparison = compare_with_measured(fit, frf, mass_on_seals)
    numbers = _compare_peaks(comparison) | origin
    if choices.joint and isinstance(record, RampHold):
        compression = find_static_equilibrium(fit, mass_on_seals).point.compression
        from dashpot.fitting.identification.identify import identify
        from dashpot.fitting.identification.prior_knowledge import HammerRig

        fit = identify(
            frf, tests=(record,), fit=fit, mass=mass, seals=choices.seals, compression=compression,
            rig=HammerRig().with_machine(find_test_machine(entry, choices)),
        )  # fmt: skip
        _, comparison = compare_with_measured(fit, frf, mass_on_seals)
    verdict_with_hammer = verdict((*frf.checks, *comparison.checks), headline=comparison.message)
    numbers |= {
        "agreement": verdict_with_hammer.use,
        "peak_dB": comparison.ratio_db,
        "frac": comparison.frac,
        "reason": ""
        if verdict_with_hammer.use == "use"
        else f"hammer: {decapitalise_sentence(verdict_with_hammer.message)}",
    }
    return fit, numbers


def read_hammer_resonance(
    entry: Entry, choices: BatchOptions, mass: float | None
) -> dict[str, Any]:
    """Return the resonance in a hammer file, or an FRF, that is paired with no test."""
    _, frf = read_measured(
        (entry.file,), choices=HammerChoices(), options=choices.reading_impact, mass=mass
    )
    return _find_resonance(frf) | make_origin_column(*frf.source)


def make_origin_column(*files: Source) -> dict[str, Any]:
    """Return the origin of files of which one was simulated."""
    return {"origin": SIMULATED} if any(file.simulated for file in files) else {}


def _find_resonance(frf: FRF) -> dict[str, Any]:
    peak = find_peak(frf)
    return {
        "measured_Hz": peak.frequency,
        "measured_se_Hz": peak.frequency_se,
        "measured_damping_ratio": peak.damping_ratio,
        "measured_damping_ratio_se": peak.damping_se,
    }


def _compare_peaks(comparison: Comparison) -> dict[str, Any]:
    """Return the peak predicted by the relaxation fit, and that of the hammer."""
    return {
        "predicted_Hz": comparison.predicted_hz,
        "predicted_damping_ratio": comparison.predicted_damping,
        "measured_Hz": comparison.measured_hz,
        "measured_se_Hz": comparison.measured_hz_se,
        "measured_damping_ratio": comparison.measured_damping,
        "measured_damping_ratio_se": comparison.measured_damping_se,
    }
