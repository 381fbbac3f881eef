"""Comparison of an FRF or its files with a fit, and the mass at which both agree."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from dashpot.base import dataclass, field, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, Use, Verdict, verdict
from dashpot.base.errors import DataError
from dashpot.base.result_mixins import HasVerdict, Series
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import format_quantity
from dashpot.datamodel.bounds import FRFBounds
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.relaxation import RampHold
from dashpot.reading.read_options import ReadOptions
from dashpot.registry import find_handler
from dashpot.vibration.comparison.compare import compare, find_fitted_files, infer_mass
from dashpot.vibration.comparison.comparison_result import Comparison
from dashpot.vibration.mass_on_seals import MassOnSeals, operating_point, predict_frf
from dashpot.workflow.checks import measurement_independent_of_fit
from dashpot.workflow.job import BlockOnSeals, HammerChoices
from dashpot.workflow.measured_frf import read_measured, remove_seal_mass, total_mass
from dashpot.workflow.stiffness_under_mass import (
    LIMIT_LINES,
    StaticEquilibrium,
    find_static_equilibrium,
    formal_limits,
    frf_limits,
)

# Iterations of the mass and the stiffness under it.
MAX_ITERATIONS = 100


def find_mass_on_seals(
    fit: Fit,
    frf: FRF,
    block: BlockOnSeals,
    *,
    band: tuple[float, float] | None = None,
) -> MassOnSeals:
    """Return the mass that moves: by the options, else by the peak of the FRF in `band`, Hz.

    The seals are as stiff as under that mass, or at the compression given.
    """
    mass, _ = total_mass(block)
    if mass is not None:
        return MassOnSeals(mass, block.seals, block.compression)
    band_frf = frf if band is None else frf.band(*band)
    mass = infer_mass(block.seals * fit.model, band_frf)[0]
    for _ in range(MAX_ITERATIONS):
        load = MassOnSeals(mass, block.seals, block.compression)
        solid = operating_point(fit, load).solid(fit)
        mass = infer_mass(block.seals * solid, band_frf)[0]
        if abs(mass - load.mass) <= 1e-9 * mass:
            return replace(load, mass=mass)
    raise DataError(
        "no mass rests where its peak is: the stiffness of the seals changes too fast with the "
        "compression; give --mass"
    )


def compare_with_measured(
    fit: Fit, measured: FRF, load: MassOnSeals, *, band: tuple[float, float] | None = None
) -> tuple[FRF, Comparison]:
    """Return a fit's prediction on the measured lines, and its agreement."""
    predicted = predict_frf(
        fit,
        frequency=measured.frequency,
        kind=measured.quantity,
        shift=measured.shift,
        **load.keywords,
    )
    return predicted, compare(predicted, measured, fit=fit, band=band, **load.keywords)


@dataclass(frozen=True)
class LeaveOneOut(Serialisable):
    """Leave-one-out error: hits predicted by a fit that has not seen them.

    Attributes
    ----------
    error : float
        Mean over the hits of the rms error, over the rms of the measured accelerance.
    hits : int
        Each omitted once.
    frequency_error_hz : (float, float)
        Least and largest error of the peak's frequency, Hz.
    height_error : (float, float)
        And of its height, relative.
    """

    _keys = ("error", "hits", "frequency_error_hz", "height_error")

    error: float
    hits: int
    frequency_error_hz: tuple[float, float]
    height_error: tuple[float, float]


@dataclass(frozen=True, repr=False)
class FRFComparison(HasVerdict, Serialisable):
    """Result of ``dashpot compare``.

    Attributes
    ----------
    comparison : Comparison
    mass : float
        Moving mass, kg.
    mass_inferred : bool
        True if the mass was taken from the measured FRF, so that the frequency proves nothing.
    frf_checks : tuple of Check
        Checks of the FRF and of the mass of the seals, besides the comparison's own.
    static_equilibrium : StaticEquilibrium
        Where the mass rests, and what secant and tangent make of it.
    interval : (array, array)
        Lines, Hz, and limits of the predicted accelerance by standard errors alone, 1/kg.
    limits : FRFBounds or None
        By both kinds of ignorance, if the relaxation record is at hand.
    seals : float
        How many carry the block.
    in_sample : bool
        The fit used this record: the agreement is no test.
    unmeasured : LeaveOneOut or None
        For such a fit: leave-one-out prediction of the hits, if the relaxation record is available.

    Examples
    --------
    >>> import dashpot as dp
    >>> hits = dp.simulate("impact", hits=3)
    >>> fit = dp.fit(dp.simulate("relaxation", hold="5s", noise_free=True), arms=2)
    >>> dp.compare(fit, hits).mass_inferred
    True
    """

    # the verdict is of the measured FRF too, not of the comparison alone
    _keys = (
        Key("comparison", flatten=True),
        "mass",
        "mass_inferred",
        "seals",
        "in_sample",
        "unmeasured",
        "verdict",
        Key("static_equilibrium.summary", flatten=True),
    )

    comparison: Comparison
    mass: float
    mass_inferred: bool
    frf_checks: tuple[Check, ...]
    static_equilibrium: StaticEquilibrium
    interval: tuple[FloatArray, FloatArray] = field(compare=False)
    limits: FRFBounds | None = None
    seals: float = 1.0
    in_sample: bool = False
    unmeasured: LeaveOneOut | None = None

    @property
    def _table_columns(self) -> Series:
        """Measured and predicted, line by line."""
        return self.comparison._table_columns

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks of the comparison and the notes; those that forbid its use come first."""
        stop_checks = select_failed_stops(self.comparison.measured)
        other_checks = tuple(check for check in self.frf_checks if check not in stop_checks)
        return (*stop_checks, *self.comparison.checks, *other_checks)

    @property
    def verdict(self) -> Verdict:
        """Verdict on the prediction, with its difference from the measured FRF."""
        new_verdict = verdict(self.checks)
        if select_failed_stops(self.comparison.measured):
            return new_verdict
        if self.in_sample:
            use: Use = "no test" if new_verdict.use == "use" else new_verdict.use
            return replace(new_verdict, use=use, message=self._circular())
        if not self.mass_inferred:
            return replace(new_verdict, message=self.comparison.message)
        return replace(
            new_verdict,
            message=f"The mass, {format_quantity(self.mass, 'g')}, was found from the measured "
            "peak, so the stiffness is not tested. Weigh the block, and give its mass.",
        )

    def _circular(self) -> str:
        """Return the sentences on a comparison with the fitted hits."""
        error_percent = 100 * self.comparison.frequency_error
        first = (
            f"The peak frequency is off by {error_percent:+.2g} %. The fit was made from these "
            "hits."
        )
        if self.unmeasured is None:
            return f"{first} Compare it with other hits, or give the fitted relaxation record too."
        low, high = (100 * value for value in self.unmeasured.height_error)
        return (
            f"{first} Each hit left out in turn is predicted within "
            f"{100 * self.unmeasured.error:.2g} % rms, its peak {low:+.2g} to {high:+.2g} % high."
        )


def compare_files(
    fit: Fit,
    measured: Sequence[str | Path],
    block: BlockOnSeals,
    *,
    hammer: HammerChoices,
    options: ReadOptions,
    band: tuple[float, float] | None = None,
    records: Sequence[str | Path] = (),
    options_with: ReadOptions | None = None,
) -> FRFComparison:
    """Hold the prediction of a fit against the hits or the FRF in files.

    Parameters
    ----------
    fit : Fit
        Fit of one seal.
    measured : sequence of path
    block, band
        As of :func:`agreement`.
    hammer, options
        How hits are averaged, and what the user said of the files.
    records : sequence of path
        The relaxation tests behind the fit: they bound the unresolved arms.
    options_with : ReadOptions, optional
        Reading options of those files.
    """
    impact, frf = read_measured(
        measured, choices=hammer, options=options, mass=block.mass, band=band
    )
    tests: tuple[RampHold, ...] = ()
    if records:
        from dashpot.workflow.bench_tests import prepared_files  # it brings every fit

        tests = prepared_files(records, options=options_with)
    comparison = agreement(fit, frf, block, tests=tests, band=band)
    if not (comparison.in_sample and tests):
        return comparison
    leave_out = find_handler("leave one out", impact)
    if leave_out is None:
        return comparison
    left_out_tests = leave_out(
        impact,
        tests,
        fit,
        MassOnSeals(comparison.mass, block.seals, block.compression),
        choices=hammer,
        band=band,
    )
    return replace(comparison, unmeasured=left_out_tests)


def agreement(
    fit: Fit,
    frf: FRF,
    block: BlockOnSeals,
    *,
    tests: Sequence[RampHold] = (),
    band: tuple[float, float] | None = None,
) -> FRFComparison:
    """Hold the prediction of a fit against an FRF.

    Parameters
    ----------
    fit : Fit
        Fit of one seal.
    frf : FRF
    block : BlockOnSeals
        Its mass is inferred from the FRF if missing.
    tests : sequence of RampHold
        The relaxation tests behind the fit.
    band : (float, float), optional
        Lines compared, Hz.
    """
    _, mass_checks = total_mass(block)
    frf = remove_seal_mass(frf, block)
    load = find_mass_on_seals(fit, frf, block, band=band)
    _, comparison = compare_with_measured(fit, frf, load, band=band)
    rest_state = find_static_equilibrium(fit, load)
    lines = comparison.measured.frequency[comparison.measured.frequency > 0]
    formal = formal_limits(fit, rest_state.point, load, frequency=lines)
    limits = None
    circular = find_fitted_files(fit, frf)
    if tests and not circular:  # the unresolved arms of a joint fit have no bound
        from dashpot.workflow.bench_tests import refuse_unfitted_tests

        refuse_unfitted_tests(tests, fit)
        limit_frequencies = np.linspace(lines[0], lines[-1], min(len(lines), LIMIT_LINES))
        limits = frf_limits(fit, tests, rest_state.point, load, frequency=limit_frequencies)
    mass_checks = (*frf.checks, *mass_checks, measurement_independent_of_fit(len(circular)))
    return FRFComparison(
        comparison, load.mass, block.mass is None, mass_checks, rest_state, (lines, formal), limits,
        load.seals,
        in_sample=bool(circular),
    )  # fmt: skip


def select_failed_stops(frf: FRF) -> tuple[Check, ...]:
    """Return the failed checks that forbid the use of an FRF by itself."""
    return tuple(check for check in frf.checks if check.failed and check.grade == "stop")
