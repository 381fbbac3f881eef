"""Inputs of an identification, validated: mass, rig, earlier fit and tests as priors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base.errors import DataError, FitError
from dashpot.base.option_fields import Method, get_choice_values
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.relaxation import RampHold
from dashpot.fitting.fit_options import FitOptions, require_maxwell_family
from dashpot.fitting.identification.likelihood import UNCHANGED, Constraints, NuisancePriors
from dashpot.fitting.identification.prior_knowledge import HammerRig, SolidPrior
from dashpot.fitting.input_tests import list_temperatures
from dashpot.fitting.marginal_relaxation import RelaxationData
from dashpot.fitting.nuisance_priors import Prior
from dashpot.fitting.relaxation import fit as fit_tests
from dashpot.fitting.relaxation_likelihood import build_relaxation_data
from dashpot.vibration.mass_on_seals import MassOnSeals, OperatingPoint, operating_point

# Relative error of a weighed mass: 0.1 g of 100 g on a workshop balance.
USUAL_MASS_SD = 0.001
MAX_ARMS = 3


class PriorTests(NamedTuple):
    """Tests and fit known before the hammer test.

    Attributes
    ----------
    arms, fractional_fit : Fit or None
        The earlier fit of either family, at the temperature of the hammer.
    relaxations : tuple of RelaxationData
        The tests that they are of.
    doubtful : tuple of RelaxationData
        The same with all that their rigs may have done without a trace.
    """

    arms: Fit | None
    fractional_fit: Fit | None
    relaxations: tuple[RelaxationData, ...]
    doubtful: tuple[RelaxationData, ...] = ()

    @property
    def primary_fit(self) -> Fit | None:
        """The one that knows of elastic law and temperatures."""
        return self.fractional_fit if self.arms is None else self.arms


def find_prior_tests(
    records: Sequence[RampHold],
    fit: Fit | None,
    temperature: float | None,
    family: str,
    bench: FitOptions,
) -> PriorTests:
    """Return the earlier fits, at the temperature of the hammer, and the tests that they are of.

    Tests that no earlier fit is of are fitted as `bench` says.

    Raises
    ------
    FitError
        If the family requested is not that of an earlier fit, or knows of one temperature alone.
    """
    if not records:
        return _use_earlier_fit(fit, temperature, family)
    if len(list_temperatures(records)) > 1:
        require_maxwell_family(family)
    # arms are matched to arms: of a fractional solid, those of the same tests
    earlier_fit = _select_family_fit("maxwell", fit) or fit_tests(list(records), **bench.choices)
    if temperature is not None:
        earlier_fit = earlier_fit.at_temperature(temperature)
    is_same_fit = len(records) == 1 and earlier_fit.method in get_choice_values(Method)
    # a test by itself has one temperature
    fit_choices = FitOptions(method=bench.method, law=bench.law, thorough=bench.thorough).choices
    fits = (
        [earlier_fit] if is_same_fit else [fit_tests(record, **fit_choices) for record in records]
    )
    relaxation_datasets, doubtful_tests = (
        tuple(
            build_relaxation_data(record, earlier_fit, single_fit=fit, for_limits=for_limits)
            for record, fit in zip(records, fits, strict=True)
        )
        for for_limits in (False, True)
    )
    is_nonlinear = earlier_fit.elastic_law is not None and earlier_fit.elastic_law.kind != "linear"
    if family == "maxwell" or is_nonlinear:
        return PriorTests(earlier_fit, None, relaxation_datasets, doubtful_tests)
    fractional_fit = _select_family_fit("fractional", fit) or fit_tests(
        list(records), family="fractional", **bench.choices
    )
    return PriorTests(earlier_fit, fractional_fit, relaxation_datasets, doubtful_tests)


def _select_family_fit(family: str, fit: Fit | None) -> Fit | None:
    return fit if fit is not None and fit.family == family else None


def _use_earlier_fit(fit: Fit | None, temperature: float | None, family: str) -> PriorTests:
    if fit is None:
        return PriorTests(None, None, ())
    if fit.family != family:
        raise FitError(
            f"the earlier fit is of family {fit.family}, and without its relaxation tests no "
            f"other can be fitted: ask for its own (--model {fit.family}), or give the tests "
            "in its place"
        )
    if temperature is not None:
        fit = fit.at_temperature(temperature)
    return PriorTests(None, fit, ()) if family == "fractional" else PriorTests(fit, None, ())


def find_operating_point(
    earlier_fit: Fit | None, mass: float | None, seals: float, compression: float | None
) -> OperatingPoint | None:
    """Return the operating point under the hammer; None if it is not needed or unknown."""
    law = None if earlier_fit is None else earlier_fit.elastic_law
    if earlier_fit is None or law is None or law.kind == "linear":
        return None
    if mass is None and compression is None:
        raise DataError(
            "the stiffness of the seals depends on their compression: give --mass, or --compression"
        )
    return operating_point(earlier_fit, MassOnSeals(mass or 1.0, seals, compression))


def list_arm_counts(arms: int | str, earlier_fit: Fit | None) -> list[int]:
    """Return the numbers of arms to try: from those of the earlier fit on, or as asked."""
    fewest_arms = 0 if earlier_fit is None else earlier_fit.model.arms
    if arms == "auto":
        return list(range(fewest_arms, fewest_arms + MAX_ARMS + 1))
    if not isinstance(arms, int | np.integer) or arms < 0:
        raise FitError(f'arms = {arms!r}; expected a number >= 0 or "auto"')
    if arms < fewest_arms:
        raise FitError(
            f"arms = {arms}, but the relaxation test alone has {fewest_arms}: ask for at least as "
            "many, one more for what only the hammer sees"
        )
    return [int(arms)]


def require_seals(seals: float) -> float:
    """Return how many seals there are, > 0."""
    if not (np.isfinite(seals) and seals > 0):
        raise DataError(f"seals = {seals!r}; expected a number > 0")
    return seals


def make_priors(mass: float | None, rig: HammerRig, point: OperatingPoint | None) -> NuisancePriors:
    """Return the priors of mass, rig and seals."""
    factor = UNCHANGED if point is None else Prior(point.factor, point.factor_se)
    return NuisancePriors(
        _make_mass_prior(mass, rig.mass_sd),
        Prior(1.0, rig.gain_sd),
        Prior(0.0, rig.delay_sd),
        factor,
        high_pass=Prior(rig.high_pass or 0.0),
    )


def make_constraints(solid_prior: SolidPrior, prior_tests: PriorTests) -> Constraints:
    """Return the constraints on the solid: its priors, and an earlier fit without its tests."""

    def prior(name: str) -> Prior | None:
        pair = solid_prior.pair(name)
        return None if pair is None else Prior(*pair)

    return Constraints(
        prior("static_stiffness"),
        prior("natural_frequency"),
        prior("damping_ratio"),
        before=None if prior_tests.relaxations else prior_tests.primary_fit,
    )


def _make_mass_prior(mass: float | None, sd: float | None) -> Prior | None:
    """Return the prior of a mass, kg."""
    if mass is None:
        return None
    if not (np.isfinite(mass) and mass > 0):
        raise DataError(f"mass = {mass!r} kg; expected a number > 0")
    if sd is not None and sd >= mass:
        raise DataError(
            f"mass_sd = {sd:g} kg of a mass of {mass:g} kg; expected less: check its unit"
        )
    return Prior(mass, USUAL_MASS_SD * mass if sd is None else sd)
