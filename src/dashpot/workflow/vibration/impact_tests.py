"""From the files of a hammer test to an FRF, to a comparison, and to the solid behind it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import DataError, ReadError
from dashpot.base.reported_values import ReportedValue
from dashpot.base.result_mixins import HasVerdict, Series
from dashpot.base.serialisation import Serialisable
from dashpot.base.units import format_quantity
from dashpot.base.version import byline
from dashpot.datamodel.base_excitation import ShakenTest
from dashpot.datamodel.bounds import FRFBounds
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF, Mode
from dashpot.datamodel.impact import ImpactTest
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.specimen import Specimen
from dashpot.fitting.identification.prior_knowledge import HammerRig
from dashpot.fitting.pipeline import FitOptions
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.base_excitation import read_shaken
from dashpot.reading.readers.impact import read_impact
from dashpot.registry import find_handler
from dashpot.vibration.comparison.compare import compare, infer_mass
from dashpot.vibration.comparison.comparison import Comparison
from dashpot.vibration.modal.dynamic_stiffness import (
    DEGREE,
    DynamicStiffness,
    dynamic_stiffness,
)
from dashpot.vibration.systems.frf_prediction import predict_frf
from dashpot.vibration.systems.operating_point import MassOnSeals, operating_point
from dashpot.workflow.checks import fit_is_tested, seals_counted
from dashpot.workflow.fit_bench_tests import BenchFitOptions
from dashpot.workflow.job import Cuts, HammerChoices, require_test_for_machine
from dashpot.workflow.prepare_tests import prepared_files, refuse_others
from dashpot.workflow.response.static_equilibrium import (
    LIMIT_LINES,
    StaticEquilibrium,
    find_static_equilibrium,
    formal_limits,
    frf_limits,
)
from dashpot.workflow.shift_options import shifted_ramps
from dashpot.workflow.vibration.measured_frf import (
    average,
    estimate_base_transmissibility,
    read_measured,
    remove_seal_mass,
    total_mass,
)
from dashpot.workflow.vibration.modes import ImpactMode, Modes

# rounds in which a mass and the stiffness under it find each other
WEIGHINGS = 100


@dataclass(frozen=True, repr=False)
class ImpactResult(Modes):
    """What hits tell: an FRF that one can trust, and its modes.

    Attributes
    ----------
    frf : FRF
        With every hit and check.
    modes : tuple of ImpactMode
    estimator, window : str
        How the hits were averaged and windowed.
    file : str or None
        Where the FRF was written.
    """

    schema = "dashpot/impact@1"
    keys = (
        "estimator", "window", "frf.averages", "modes", "peak", "frf.hits", "frf.checks", "verdict",
        "frf.source", "file", "frf",
    )  # fmt: skip

    estimator: str
    window: str
    file: str | None = None

    @property
    def peak(self) -> dict[str, float]:
        """Frequency, Hz, and magnitude of the highest line."""
        height = np.abs(self.frf.value)
        top = int(height.argmax())
        return {"frequency_hz": float(self.frf.frequency[top]), "value": float(height[top])}


def impact_files(
    files: Sequence[str | Path],
    *,
    hammer: HammerChoices | None = None,
    options: ReadOptions | None = None,
    mass: float | None = None,
    band: tuple[float, float] | None = None,
    file: str | None = None,
) -> tuple[ImpactResult, str]:
    """Average the hits in files into an FRF and find its modes.

    Parameters
    ----------
    files : sequence of path
    hammer, options
        How the hits are averaged, and what the user said of the files.
    mass : float, optional
        kg, of the block: checks the mass line.
    band : (float, float), optional
        Where to look for modes, Hz.
    file : str, optional
        Where the FRF will be written; told in the document.

    Returns
    -------
    result : ImpactResult
    reason : str
        Why no mode was found, else empty.
    """
    options = options or ReadOptions()
    driven = options.of(files[0]).base_acceleration is not None
    test = read_shaken(files, options) if driven else read_impact(list(files), options=options)
    result, reason = modes_of_hits(test, hammer=hammer, mass=mass, band=band)
    return replace(result, file=file), reason


def modes_of_hits(
    test: ImpactTest | ShakenTest,
    *,
    hammer: HammerChoices | None = None,
    mass: float | None = None,
    band: tuple[float, float] | None = None,
) -> tuple[ImpactResult, str]:
    """Average hits, or a base that was shaken, into an FRF and find its modes.

    The parameters and what is returned are those of :func:`impact_files`.
    """
    hammer = hammer or HammerChoices()
    if isinstance(test, ShakenTest):
        frf, modes, reason = estimate_base_transmissibility(
            test, choices=hammer, mass=mass, band=band
        )
    else:
        frf = average(test, choices=hammer, mass=mass, band=band)
        modes, reason = _modes(frf, band)
    return _vibration(frf, modes, hammer), reason


def _modes(frf: FRF, band: tuple[float, float] | None) -> tuple[tuple[Mode, ...], str]:
    """The modes of an FRF, or why there is none."""
    try:
        return frf.modes(band=band), ""
    except DataError as error:
        return (), str(error)


def _vibration(frf: FRF, modes: Sequence[Mode], hammer: HammerChoices) -> ImpactResult:
    shown = tuple(
        ImpactMode(
            mode.frequency,
            mode.damping_ratio,
            finite(mode.frequency_se),
            finite(mode.damping_ratio_se),
            mode.method,
        )
        for mode in modes
    )
    return ImpactResult(frf, shown, hammer.estimator, hammer.window)


def weighed(
    fit: Fit,
    frf: FRF,
    *,
    mass: float | None,
    seals: float,
    band: tuple[float, float] | None = None,
    compression: float | None = None,
) -> MassOnSeals:
    """Return the mass given, else the one that the peak of the FRF in `band`, Hz, implies.

    The seals are as stiff as under that mass, or at the compression given, m.
    """
    if mass is not None:
        return MassOnSeals(mass, seals, compression)
    near = frf if band is None else frf.band(*band)
    mass = infer_mass(seals * fit.model, near)[0]
    for _ in range(WEIGHINGS):
        point = operating_point(fit, mass=mass, seals=seals, compression=compression)
        last, mass = mass, infer_mass(seals * point.solid(fit), near)[0]
        if abs(mass - last) <= 1e-9 * mass:
            return MassOnSeals(mass, seals, compression)
    raise DataError(
        "no mass rests where its peak is: the stiffness of the seals changes too fast with the "
        "compression; give --mass"
    )


def compare_with_measured(
    fit: Fit, measured: FRF, on: MassOnSeals, *, band: tuple[float, float] | None = None
) -> tuple[FRF, Comparison]:
    """Return what a fit predicts on the measured lines, and how well that agrees."""
    predicted = predict_frf(
        fit,
        frequency=measured.frequency,
        kind=measured.quantity,
        shift=measured.shift,
        **on.keywords,
    )
    return predicted, compare(predicted, measured, fit=fit, band=band, **on.keywords)


@dataclass(frozen=True)
class LeaveOneOut(Serialisable):
    """How well hits are predicted by a fit that has not seen them.

    Attributes
    ----------
    error : float
        Mean over the hits of the rms error, over the rms of the measured accelerance.
    hits : int
        Each left out once.
    frequency : (float, float)
        Least and largest error of the peak's frequency, Hz.
    height : (float, float)
        And of its height, relative.
    """

    keys = ("error", "hits", "frequency_error_hz=frequency", "height_error=height")

    error: float
    hits: int
    frequency: tuple[float, float]
    height: tuple[float, float]


@dataclass(frozen=True, repr=False)
class Agreement(HasVerdict, Serialisable):
    """What ``dashpot compare`` found.

    Attributes
    ----------
    comparison : Comparison
    mass : float
        What moves, kg.
    mass_inferred : bool
        True if the mass was taken from the measured FRF, so that the frequency proves nothing.
    noted : tuple of Check
        What the FRF and the mass of the seals say beside the comparison's own checks.
    at_rest : AtRest
        Where the mass rests, and what secant and tangent make of it.
    interval : (array, array)
        Lines, Hz, and limits of the predicted accelerance by standard errors alone, 1/kg.
    limits : FRFBounds or None
        By both kinds of ignorance, if the relaxation record is at hand.
    seals : float
        How many carry the block.
    in_sample : bool
        The fit was made from this very record: its agreement tests nothing.
    unseen : LeftOut or None
        Of such a fit: how well hits that were left out in turn are predicted, if the relaxation
        record is at hand.

    Examples
    --------
    >>> import dashpot as dp
    >>> hits = dp.simulate("impact", hits=3)
    >>> fit = dp.fit(dp.simulate("relaxation", hold="5s", noise_free=True), arms=2)
    >>> dp.compare(fit, hits).mass_inferred
    True
    """

    # the verdict is of the measured FRF too, not of the comparison alone
    keys = (
        "*comparison", "mass", "mass_inferred", "seals", "in_sample", "unseen", "verdict",
        "*at_rest.told",
    )  # fmt: skip

    comparison: Comparison
    mass: float
    mass_inferred: bool
    noted: tuple[Check, ...]
    at_rest: StaticEquilibrium
    interval: tuple[FloatArray, FloatArray] = field(compare=False)
    limits: FRFBounds | None = None
    seals: float = 1.0
    in_sample: bool = False
    unseen: LeaveOneOut | None = None

    @property
    def series(self) -> Series:
        """Measured and predicted, line by line."""
        return self.comparison.series

    @property
    def checks(self) -> tuple[Check, ...]:
        """Those of the comparison and what was noted, what forbids the use of the FRF first."""
        useless = _useless(self.comparison.measured)
        others = tuple(check for check in self.noted if check not in useless)
        return (*useless, *self.comparison.checks, *others)

    @property
    def verdict(self) -> Verdict:
        """What to make of the prediction; it says how near it came, where the FRF is one."""
        new_verdict = verdict(self.checks)
        if _useless(self.comparison.measured):
            return new_verdict
        if self.in_sample:
            return replace(new_verdict, says=self._circular())
        if not self.mass_inferred:
            return replace(new_verdict, says=self.comparison.says)
        return replace(
            new_verdict,
            says=f"The mass, {format_quantity(self.mass, 'g')}, was found from the measured peak, "
            "so the "
            "stiffness is not tested. Weigh the block, and give its mass.",
        )

    def _circular(self) -> str:
        """What a comparison with the hits that were fitted shows."""
        off = 100 * self.comparison.frequency_error
        says = f"The peak is off by {off:+.2g} %. This tests nothing"
        first = f"{says}, because the fit was made from these hits."
        if self.unseen is None:
            return f"{first} Compare it with other hits, or give the fitted relaxation record too."
        low, high = (100 * value for value in self.unseen.height)
        return (
            f"{first} Each hit left out in turn is predicted within "
            f"{100 * self.unseen.error:.2g} % rms, its peak {low:+.2g} to {high:+.2g} % high."
        )


def compare_files(
    fit: Fit,
    measured: Sequence[str | Path],
    *,
    hammer: HammerChoices,
    options: ReadOptions,
    mass: float | None = None,
    band: tuple[float, float] | None = None,
    records: Sequence[str | Path] = (),
    options_with: ReadOptions | None = None,
    **asked: Any,
) -> Agreement:
    """Hold the prediction of a fit against the hits or the FRF in files.

    Parameters
    ----------
    fit : Fit
        Of one seal.
    measured : sequence of path
    hammer, options
        How hits are averaged, and what the user said of the files.
    records : sequence of path
        The relaxation tests behind the fit: they bound the unresolved arms.
    options_with : ReadOptions, optional
        What the user said of those.
    mass, band, asked
        As of :func:`agreement`.
    """
    impact, frf = read_measured(measured, choices=hammer, options=options, mass=mass, band=band)
    tests = prepared_files(records, options=options_with)
    held = agreement(fit, frf, tests=tests, mass=mass, band=band, **asked)
    if not (held.in_sample and tests):
        return held
    leave_out = find_handler("leave one out", impact)
    if leave_out is None:
        return held
    unmeasured = leave_out(
        impact,
        tests,
        fit,
        MassOnSeals(held.mass, held.seals, asked.get("compression")),
        choices=hammer,
        band=band,
    )
    return replace(held, unseen=unmeasured)


def agreement(
    fit: Fit,
    frf: FRF,
    *,
    tests: Sequence[RampHold] = (),
    mass: float | None = None,
    seal_mass: float | None = None,
    seals: float = 1.0,
    band: tuple[float, float] | None = None,
    compression: float | None = None,
) -> Agreement:
    """Hold the prediction of a fit against an FRF.

    Parameters
    ----------
    fit : Fit
        Of one seal.
    frf : FRF
    tests : sequence of RampHold
        The relaxation tests behind the fit.
    mass, seal_mass : float, optional
        Of the block, inferred from the FRF if missing, and of one seal, kg.
    seals : float
        How many carry the block.
    band : (float, float), optional
        Lines compared, Hz.
    compression : float, optional
        Of the seals, m; by default that of the mass's weight.
    """
    total, noted = total_mass(mass, seal=seal_mass, seals=seals)
    frf = remove_seal_mass(frf, total, seal_mass, seals)
    on = weighed(fit, frf, mass=total, seals=seals, band=band, compression=compression)
    _, comparison = compare_with_measured(fit, frf, on, band=band)
    rests = find_static_equilibrium(fit, on)
    lines = comparison.measured.frequency[comparison.measured.frequency > 0]
    formal = formal_limits(fit, rests.point, on, frequency=lines)
    limits = None
    circular = find_fitted_files(fit, frf)
    if tests and not circular:  # the unseen arms of a joint fit have no bound
        refuse_others(tests, fit)
        about = np.linspace(lines[0], lines[-1], min(len(lines), LIMIT_LINES))
        limits = frf_limits(fit, tests, rests.point, on, frequency=about)
    noted = (*frf.checks, *noted, fit_is_tested(len(circular)))
    return Agreement(
        comparison, on.mass, mass is None, noted, rests, (lines, formal), limits, seals,
        in_sample=bool(circular),
    )  # fmt: skip


def find_fitted_files(fit: Fit, frf: FRF) -> frozenset[str]:
    """The files of an FRF, by what they hold, that a fit was made from."""
    return frozenset(source.sha256 for source in fit.source) & {
        source.sha256 for source in frf.source
    } - {""}


class Changes(NamedTuple):
    """Of the stiffness, relative, and of the loss factor."""

    stiffness_relative: FloatArray
    loss_factor: FloatArray


@dataclass(frozen=True)
class DirectStiffness(Serialisable):
    """Stiffness and damping of a seal straight from the FRF, each with all its errors."""

    keys = (
        "frequency_hz=of.frequency", "stiffness=of.storage", "stiffness_sd=of.storage_sd",
        "of.damping", "of.loss_factor", "of.loss_factor_sd", "stiffness_band_hz=of.storage_band~",
        "loss_band_hz=of.loss_band~", "sensitivity",
    )  # fmt: skip

    of: DynamicStiffness

    @property
    def sensitivity(self) -> dict[str, Changes]:
        """What a degree of phase, and a per cent of mass, change."""
        phase, mass = self.of.changes("phase", DEGREE), self.of.changes("mass", 0.01)
        return {"phase_1_degree": Changes(*phase), "mass_1_percent": Changes(*mass)}

    @property
    def table(self) -> str:
        """They as CSV, with the bands where they are good in the head."""
        of = self.of
        head = (
            f"# {byline('stiffness from the FRF')}\n"
            f"# stiffness good to 10 % from {of.storage_band[0]:.4g} to {of.storage_band[1]:.4g} "
            f"Hz, loss to 30 % from {of.loss_band[0]:.4g} to {of.loss_band[1]:.4g} Hz\n"
            "frequency [Hz],stiffness [N/m],sd of stiffness [N/m],damping [N*s/m],loss factor [1],"
            "sd of loss factor [1]\n"
        )
        columns = (
            of.frequency, of.storage, of.storage_sd, of.damping, of.loss_factor, of.loss_factor_sd,
        )  # fmt: skip
        rows = zip(*(column.tolist() for column in columns), strict=True)
        return head + "".join(",".join(map(repr, row)) + "\n" for row in rows)


@dataclass(frozen=True, repr=False)
class Identified(HasVerdict, Serialisable):
    """What ``dashpot fit`` found.

    Attributes
    ----------
    fit : Fit
    direct : Direct
    noted : tuple of Check
        What the FRF and the mass of the seals say beside the fit's own.
    at_rest : AtRest
        Where the mass rests on it.
    vibration : ImpactResult or None
        The modes of what was measured, where nothing else was fitted.
    """

    keys = (
        "*fit", "checks", "verdict", "vibration.modes?", "vibration.frf.hits?", "direct",
        "*at_rest.told",
    )  # fmt: skip

    fit: Fit
    direct: DirectStiffness
    noted: tuple[Check, ...]
    at_rest: StaticEquilibrium
    vibration: ImpactResult | None = None

    @property
    def kept(self) -> Fit:
        """The fit with every check that decided the verdict."""
        return self.fit.with_checks(self.checks)

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """Those of the fit."""
        return self.fit.facts

    @property
    def checks(self) -> tuple[Check, ...]:
        """Those of the fit, and what was noted."""
        return (*self.fit.checks, *self.noted)

    @property
    def verdict(self) -> Verdict:
        """What to make of the fit."""
        return verdict(self.checks, headline=self.fit.sound)


def identify_files(
    measured: Sequence[str | Path],
    *,
    hammer: HammerChoices,
    options: ReadOptions,
    mass: float,
    band: tuple[float, float] | None = None,
    tests: Sequence[str | Path] = (),
    bench: BenchFitOptions | None = None,
    temperatures: Sequence[float] = (),
    impact_temperature: float | None = None,
    options_with: ReadOptions | None = None,
    **asked: Any,
) -> Identified:
    """Identify the solid under a mass from hits or an FRF, alone or with the relaxation test.

    Parameters
    ----------
    measured, tests : sequence of path
        The hammer's files, and relaxation tests to fit together with them.
    bench : BenchFitOptions, optional
        How the tests are prepared and fitted.
    temperatures : sequence of float
        Of the tests, K: one for all of them, or one for each, in their order; without tests, of
        the seals.
    impact_temperature : float, optional
        Of the seals under the hammer, K, where tests at several temperatures are fitted too.
    options_with : ReadOptions, optional
        What the user said of the files of the tests.
    hammer, mass, band, asked
        As of :func:`identify_solid`.
    """
    bench = bench or BenchFitOptions()
    machine, specimen = bench.machine, bench.specimen
    on_bench = machine and machine.on_bench
    require_test_for_machine(on_bench, tests=len(tests), add="a relaxation test")
    _refuse_both(asked.get("fits", ()), tests)
    if impact_temperature is not None and not (tests or asked.get("fits")):
        raise ReadError(
            "--hammer-temperature is for seals whose relaxation tests, or their fit, are of other "
            "temperatures, and there are none here; say that of the seals by --temperature"
        )
    if not tests and len(temperatures) > 1:
        raise ReadError(
            f"{len(temperatures)} temperatures and no relaxation test; expected one, that "
            "of the seals under the hammer"
        )
    _, frf = read_measured(measured, choices=hammer, options=options, mass=mass, band=band)
    shifts = shifted_ramps(bench.shifting)
    apart = FitOptions(method=bench.method, law=bench.law, thorough=bench.thorough, **shifts)
    if not tests and (apart.choices or bench.cuts != Cuts() or bench.filter):
        raise DataError(
            "method, elastic law, cuts, filter, starting points and shifts say how relaxation "
            "tests are prepared and fitted, and there are none here. Give the tests in place of "
            "their fit, or leave those options out."
        )
    prepared = prepared_files(
        tests, machine=on_bench, options=options_with, temperatures=temperatures,
        filter=bench.filter, cuts=bench.cuts,
    )  # fmt: skip
    if not tests and temperatures:
        specimen = replace(specimen or Specimen(), temperature=temperatures[0])
    asked["rig"] = (asked.get("rig") or HammerRig()).on(machine)
    return identify_solid(
        frf, tests=prepared, mass=mass, band=band,
        temperature=impact_temperature, specimen=specimen, hammer=hammer, bench=apart, **asked,
    )  # fmt: skip


def identify_solid(
    frf: FRF,
    *,
    tests: Sequence[RampHold] = (),
    fits: Sequence[Fit] = (),
    mass: float,
    seal_mass: float | None = None,
    seals: float = 1.0,
    band: tuple[float, float] | None = None,
    compression: float | None = None,
    temperature: float | None = None,
    specimen: Specimen | None = None,
    hammer: HammerChoices | None = None,
    seals_assumed: bool = False,
    **choices: Any,
) -> Identified:
    """Identify the solid under a mass from an FRF, alone or with prepared tests or their fit.

    Parameters
    ----------
    frf : FRF
    tests : sequence of RampHold
        Relaxation tests to fit together with it.
    fits : sequence of Fit
        At most one, in place of the tests.
    mass, seal_mass : float
        Of the block and of one seal, kg.
    band : (float, float), optional
        Lines fitted, Hz.
    compression : float, optional
        Of the seals, m; by default that of the mass's weight.
    temperature : float, optional
        Of the seals under the hammer, K, where tests at several temperatures are fitted too.
    specimen : Specimen, optional
        What is known of the seals; it wins over what the tests say.
    hammer : HammerChoices, optional
        How hits were averaged.
    seals_assumed : bool
        Nobody counted the seals: `seals` is what is usual, and this is said.
    choices
        As in :func:`~dashpot.fitting.identification.identify.identify`.
    """
    from dashpot.fitting.identification.identify import identify

    _refuse_both(fits, tests)
    vibration = None
    if not tests and not fits:
        vibration = _vibration(frf, _modes(frf, band)[0], hammer or HammerChoices())
    total, noted = total_mass(mass, seal=seal_mass, seals=seals)
    if seals_assumed:
        noted = (*noted, seals_counted(seals))
    frf = remove_seal_mass(frf, total, seal_mass, seals)
    mass = total or mass
    straight = dynamic_stiffness(frf, mass, seals=seals, band=band)
    fit = identify(
        frf,
        band=band,
        tests=tests,
        fit=fits[0] if fits else None,
        mass=mass,
        seals=seals,
        compression=compression,
        temperature=temperature,
        **choices,
    )
    if specimen is not None:
        provenance = replace(fit.provenance, specimen=specimen.over(fit.specimen))
        fit = replace(fit, provenance=provenance)
    useless = _useless(frf)
    # an FRF that is none comes before what a solid makes of it
    evidence = replace(fit.evidence, checks=(*useless, *fit.checks))
    others = tuple(check for check in frf.checks if check not in useless)
    fit = replace(fit, evidence=evidence)
    rests = find_static_equilibrium(fit, MassOnSeals(mass, seals, compression))
    return Identified(fit, DirectStiffness(straight), (*others, *noted), rests, vibration)


def _refuse_both(fits: Sequence[Fit], tests: Sequence[Any]) -> None:
    """Refuse several fits, and a fit beside the tests that it may be of."""
    if len(fits) > 1 or (fits and tests):
        raise ReadError("tests are fitted together, or one fit with vibration: leave the fit out")


def _useless(frf: FRF) -> tuple[Check, ...]:
    """What forbids the use of an FRF by itself."""
    return tuple(check for check in frf.checks if check.failed and check.grade == "stop")


def finite(value: float) -> float | None:
    """Return a number, or None where it is not known."""
    return value if np.isfinite(value) else None
