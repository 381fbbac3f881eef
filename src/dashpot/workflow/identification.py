"""Identification of a solid from hammer files, alone or with relaxation tests."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import DataError, ReadError
from dashpot.base.reported_values import ReportedValue
from dashpot.base.result_mixins import HasVerdict
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.version import byline
from dashpot.datamodel.fit import Fit, add_checks
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.relaxation import RampHold
from dashpot.datamodel.specimen import Specimen
from dashpot.fitting.identification.prior_knowledge import HammerRig
from dashpot.reading.read_options import ReadOptions
from dashpot.vibration.mass_on_seals import MassOnSeals
from dashpot.vibration.modal.dynamic_stiffness import DEGREE, DynamicStiffness, dynamic_stiffness
from dashpot.workflow.bench_tests import BenchFitOptions, prepared_files
from dashpot.workflow.checks import seals_counted
from dashpot.workflow.frf_comparison import select_failed_stops
from dashpot.workflow.job import BlockOnSeals, HammerChoices, TimeLimits, require_test_for_machine
from dashpot.workflow.measured_frf import (
    ImpactResult,
    build_impact_result,
    find_modes_or_reason,
    read_measured,
    remove_seal_mass,
    total_mass,
)
from dashpot.workflow.stiffness_under_mass import StaticEquilibrium, find_static_equilibrium


class Changes(NamedTuple):
    """Change of the stiffness, relative, and of the loss factor."""

    stiffness_relative: FloatArray
    loss_factor: FloatArray


@dataclass(frozen=True)
class DirectStiffness(Serialisable):
    """Stiffness and damping of a seal from the FRF directly, each with all its errors."""

    _keys = (
        Key("frequency_hz", "stiffness.frequency"),
        Key("stiffness", "stiffness.storage"),
        Key("stiffness_sd", "stiffness.storage_sd"),
        "stiffness.damping",
        "stiffness.loss_factor",
        "stiffness.loss_factor_sd",
        Key("stiffness_band_hz", "stiffness.storage_band", nonfinite_as_null=True),
        Key("loss_band_hz", "stiffness.loss_band", nonfinite_as_null=True),
        "sensitivity",
    )

    stiffness: DynamicStiffness

    @property
    def sensitivity(self) -> dict[str, Changes]:
        """Changes by a degree of phase, and by a per cent of mass."""
        phase, mass = self.stiffness.changes("phase", DEGREE), self.stiffness.changes("mass", 0.01)
        return {"phase_1_degree": Changes(*phase), "mass_1_percent": Changes(*mass)}

    @property
    def table(self) -> str:
        """The stiffnesses as CSV, with the usable bands in the header."""
        stiffness = self.stiffness
        head = (
            f"# {byline('stiffness from the FRF')}\n"
            f"# stiffness good to 10 % from {stiffness.storage_band[0]:.4g} to "
            f"{stiffness.storage_band[1]:.4g} "
            f"Hz, loss to 30 % from {stiffness.loss_band[0]:.4g} to {stiffness.loss_band[1]:.4g} "
            "Hz\n"
            "frequency [Hz],stiffness [N/m],sd of stiffness [N/m],damping [N*s/m],loss factor [1],"
            "sd of loss factor [1]\n"
        )
        columns = (
            stiffness.frequency, stiffness.storage, stiffness.storage_sd, stiffness.damping,
            stiffness.loss_factor, stiffness.loss_factor_sd,
        )  # fmt: skip
        rows = zip(*(column.tolist() for column in columns), strict=True)
        return head + "".join(",".join(map(repr, row)) + "\n" for row in rows)


@dataclass(frozen=True, repr=False)
class IdentificationResult(HasVerdict, Serialisable):
    """Result of ``dashpot fit`` on a hammer test.

    Attributes
    ----------
    fit : Fit
    direct : DirectStiffness
    frf_checks : tuple of Check
        Checks of the FRF and of the mass of the seals, besides the fit's own.
    static_equilibrium : StaticEquilibrium
        Where the mass rests on it.
    vibration : ImpactResult or None
        The measured modes, if no other test is part of the fit.
    """

    _keys = (
        Key("fit", flatten=True),
        "checks",
        "verdict",
        Key("modes", "vibration.modes", optional=True),
        Key("hits", "vibration.frf.hits", optional=True),
        "direct",
        Key("static_equilibrium.summary", flatten=True),
    )

    fit: Fit
    direct: DirectStiffness
    frf_checks: tuple[Check, ...]
    static_equilibrium: StaticEquilibrium
    vibration: ImpactResult | None = None

    @property
    def _saved_result(self) -> Fit:
        """The fit with every check that decided the verdict."""
        return add_checks(self.fit, self.checks)

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """Values of the fit."""
        return self.fit.facts

    @property
    def checks(self) -> tuple[Check, ...]:
        """Checks of the fit, and the notes."""
        return (*self.fit.checks, *self.frf_checks)

    @property
    def verdict(self) -> Verdict:
        """Verdict on the fit."""
        return verdict(self.checks, headline=self.fit._headline)


def identify_files(
    measured: Sequence[str | Path],
    block: BlockOnSeals,
    *,
    hammer: HammerChoices,
    options: ReadOptions,
    band: tuple[float, float] | None = None,
    tests: Sequence[str | Path] = (),
    bench: BenchFitOptions | None = None,
    temperatures: Sequence[float] = (),
    impact_temperature: float | None = None,
    options_with: ReadOptions | None = None,
    **choices: Any,
) -> IdentificationResult:
    """Identify the solid under a mass from hits or an FRF, alone or with the relaxation test.

    Parameters
    ----------
    measured, tests : sequence of path
        The hammer's files, and relaxation tests to fit together with them.
    bench : BenchFitOptions, optional
        How the tests are prepared and fitted.
    temperatures : sequence of float
        Temperatures of the tests, K: one for all of them, or one for each, in their order; without
        tests, of the seals.
    impact_temperature : float, optional
        Temperature of the seals under the hammer, K, where tests at several temperatures are fitted
        too.
    options_with : ReadOptions, optional
        Reading options of the test files.
    block, hammer, band, choices
        As of :func:`identify_solid`.
    """
    bench = bench or BenchFitOptions()
    machine, specimen = bench.machine, bench.specimen
    on_bench = machine and machine.on_bench
    require_test_for_machine(on_bench, tests=len(tests), add="a relaxation test")
    _refuse_both(choices.get("fits", ()), tests)
    if impact_temperature is not None and not (tests or choices.get("fits")):
        raise ReadError(
            "--hammer-temperature is for seals whose relaxation tests, or their fit, are of other "
            "temperatures, and there are none here; say that of the seals by --temperature"
        )
    if not tests and len(temperatures) > 1:
        raise ReadError(
            f"{len(temperatures)} temperatures and no relaxation test; expected one, that "
            "of the seals under the hammer"
        )
    _, frf = read_measured(measured, choices=hammer, options=options, mass=block.mass, band=band)
    ramp_options = bench.ramp_options
    if not tests and (ramp_options.choices or bench.time_limits != TimeLimits() or bench.filter):
        raise DataError(
            "method, elastic law, cuts, filter, starting points and shifts say how relaxation "
            "tests are prepared and fitted, and there are none here. Give the tests in place of "
            "their fit, or leave those options out."
        )
    prepared = prepared_files(
        tests, machine=on_bench, options=options_with, temperatures=temperatures,
        filter=bench.filter, time_limits=bench.time_limits,
    )  # fmt: skip
    if not tests and temperatures:
        specimen = replace(specimen or Specimen(), temperature=temperatures[0])
    choices["rig"] = (choices.get("rig") or HammerRig()).with_machine(machine)
    return identify_solid(
        frf, block, tests=prepared, band=band,
        temperature=impact_temperature, specimen=specimen, hammer=hammer, bench=ramp_options,
        **choices,
    )  # fmt: skip


def identify_solid(
    frf: FRF,
    block: BlockOnSeals,
    *,
    tests: Sequence[RampHold] = (),
    fits: Sequence[Fit] = (),
    band: tuple[float, float] | None = None,
    temperature: float | None = None,
    specimen: Specimen | None = None,
    hammer: HammerChoices | None = None,
    seals_assumed: bool = False,
    **choices: Any,
) -> IdentificationResult:
    """Identify the solid under a mass from an FRF, alone or with prepared tests or their fit.

    Parameters
    ----------
    frf : FRF
    block : BlockOnSeals
        Its mass is given.
    tests : sequence of RampHold
        Relaxation tests to fit together with the FRF.
    fits : sequence of Fit
        At most one, in place of the tests.
    band : (float, float), optional
        Lines fitted, Hz.
    temperature : float, optional
        Temperature of the seals under the hammer, K, where tests at several temperatures are fitted
        too.
    specimen : Specimen, optional
        Stated specimen of the seals; it has priority over the one in the files.
    hammer : HammerChoices, optional
        How hits were averaged.
    seals_assumed : bool
        The number of seals was not stated: the usual one is assumed, with a note.
    choices
        As in :func:`~dashpot.fitting.identification.identify.identify`.
    """
    from dashpot.fitting.identification.identify import identify

    _refuse_both(fits, tests)
    vibration = None
    if not tests and not fits:
        vibration = build_impact_result(
            frf, find_modes_or_reason(frf, band)[0], hammer or HammerChoices()
        )
    total, mass_checks = total_mass(block)
    load = MassOnSeals(total or block.weighed_mass, block.seals, block.compression)
    if seals_assumed:
        mass_checks = (*mass_checks, seals_counted(load.seals))
    frf = remove_seal_mass(frf, block)
    line_by_line = dynamic_stiffness(frf, load.mass, seals=load.seals, band=band)
    fit = identify(
        frf,
        band=band,
        tests=tests,
        fit=fits[0] if fits else None,
        temperature=temperature,
        **load.keywords,
        **choices,
    )
    if specimen is not None:
        provenance = replace(fit.provenance, specimen=specimen.with_defaults(fit.specimen))
        fit = replace(fit, provenance=provenance)
    stop_checks = select_failed_stops(frf)
    # an FRF that is none comes before what a solid makes of it
    evidence = replace(fit.evidence, checks=(*stop_checks, *fit.checks))
    other_checks = tuple(check for check in frf.checks if check not in stop_checks)
    fit = replace(fit, evidence=evidence)
    rest_state = find_static_equilibrium(fit, load)
    return IdentificationResult(
        fit, DirectStiffness(line_by_line), (*other_checks, *mass_checks), rest_state, vibration
    )


def _refuse_both(fits: Sequence[Fit], tests: Sequence[Any]) -> None:
    """Refuse several fits, and a fit beside the tests that it may be of."""
    if len(fits) > 1 or (fits and tests):
        raise ReadError("tests are fitted together, or one fit with vibration: leave the fit out")
