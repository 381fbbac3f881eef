"""From vibration, alone or with relaxation, to a solid."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, TypeAlias

import numpy as np

from dashpot.base.errors import DataError, FitError
from dashpot.fitting.identification.fit_assembly import assembled
from dashpot.fitting.identification.frf_data import frf_data_of
from dashpot.fitting.identification.likelihood import Constraints, NuisancePriors, Prior
from dashpot.fitting.identification.search import Search, chosen, line_scale
from dashpot.fitting.relaxation_data import RelaxationData, relaxation_data
from dashpot.records.fit import Fit
from dashpot.records.frf import FRF
from dashpot.records.relaxation import RampHold, listed

Given: TypeAlias = float | tuple[float, float] | None

# a block on a balance, with its glue, studs and a part of the seals' own mass
# a block on a workshop balance: 0.1 g of 100 g
USUAL_MASS_SD = 0.001
USUAL_GAIN_SD = 0.01
USUAL_DELAY_SD = 1e-4
MOST_ARMS = 3


def identify(
    frf: FRF,
    *,
    tests: RampHold | Sequence[RampHold] = (),
    fit: Fit | None = None,
    mass: float | None = None,
    seals: float = 1.0,
    arms: int | Literal["auto"] = "auto",
    parallel_dashpot: bool | Literal["auto"] = False,
    static_stiffness: Given = None,
    natural_frequency: Given = None,
    damping_ratio: Given = None,
    mass_sd: float | None = None,
    gain_sd: float = USUAL_GAIN_SD,
    delay_sd: float = USUAL_DELAY_SD,
    band: tuple[float, float] | None = None,
) -> Fit:
    r"""Find the solid of one seal from the FRF of a mass on `seals` of them.

    The model is held against the complex accelerance, line by line in units of its scatter, at
    :math:`s = j\omega + a` and cut where the record was, so neither an exponential window nor a
    short record needs a correction. With relaxation tests both kinds of test share one likelihood
    (:mod:`dashpot.fitting.identification.likelihood`); mass, gain and delay between the channels
    are nuisance parameters with priors.

    Parameters
    ----------
    frf : FRF
        Measured, any kind.
    tests : RampHold or sequence of RampHold
        Relaxation tests of the same seal, prepared.
    fit : Fit, optional
        An earlier fit. With `tests` it is what they were fitted to; without, its parameters and
        covariance are a prior.
    mass : float, optional
        kg; None leaves it free.
    seals : float
        How many such seals carry the mass.
    arms : int or "auto"
        Maxwell arms in all. ``"auto"`` takes the number that the data support.
    parallel_dashpot : bool or "auto"
        Add a dashpot: with no arm a Voigt solid, with one a Maxwell-Voigt solid.
    static_stiffness, natural_frequency, damping_ratio : float or (float, float), optional
        What the solid must also obey: k_inf of one seal, N/m; natural frequency :math:`|p|/2\pi`,
        Hz, and damping ratio of the mass on the seals. A pair is a value and its standard
        deviation, a number is exact (Zhang and Richards 2007).
    mass_sd : float, optional
        Standard deviation of the mass, kg; 0.1 % by default, 0 if exact.
    gain_sd, delay_sd : float
        What acceleration over force may be off by, relative, and late by, s; 0 if exact.
    band : (float, float), optional
        Lines to explain, Hz; by default those within a factor of 3 of the peak.

    Returns
    -------
    Fit
        Of one seal, `method` ``"frf"`` or ``"joint"``; ``nuisance`` holds mass, gain and delay,
        ``moved`` what the hammer changed.

    Raises
    ------
    DataError
        If there are too few lines, or an option cannot be.
    FitError
        If there are fewer arms than the earlier fit has.
    """
    records = listed(tests)
    frf_data = frf_data_of(frf, seals=_seals(seals), band=band)
    priors = NuisancePriors(
        _mass(mass, mass_sd), _spread("gain_sd", gain_sd), _spread("delay_sd", delay_sd)
    )
    before, relaxations = _relaxations(records, fit)
    constraints = Constraints(
        _known("static_stiffness", static_stiffness),
        _known("natural_frequency", natural_frequency),
        _known("damping_ratio", damping_ratio),
        before if before is not None and not relaxations else None,
    )
    numbers = _numbers(arms, before)
    dashpots = (False, True) if parallel_dashpot == "auto" else (bool(parallel_dashpot),)
    search = Search(relaxations, frf_data, priors, constraints, before)
    found = [best for dashpot in dashpots for best in search.candidates(numbers, dashpot=dashpot)]
    fewer = min(numbers)
    while not found and fewer > 0 and constraints.before is None:
        fewer -= 1  # the data reject that many arms
        found = [best for on in dashpots for best in search.candidates([fewer], dashpot=on)]
    if not found:
        raise FitError("no solid with arms of positive stiffness explains the FRF; widen band=")
    best = chosen(found)
    scale = line_scale(best)
    final = search.refined(best, scale)
    orders = [search.rescaled(candidate, scale) for candidate in found]
    return assembled(
        final, orders, frf=frf, tests=records, before=before, asked=arms, most=max(numbers)
    )


# -- what was given ---------------------------------------------------------------------------


def _relaxations(
    records: Sequence[RampHold], fit: Fit | None
) -> tuple[Fit | None, tuple[RelaxationData, ...]]:
    if not records:
        return fit, ()
    from dashpot.fitting.relaxation import fit as fit_tests

    before = fit if fit is not None else fit_tests(list(records))
    same = len(records) == 1 and before.method in {"full", "hold"}
    alone = [before] if same else [fit_tests(record) for record in records]
    return before, tuple(
        relaxation_data(record, before, noise=own.residual)
        for record, own in zip(records, alone, strict=True)
    )


def _numbers(arms: int | str, before: Fit | None) -> list[int]:
    least = 0 if before is None else before.model.arms
    if arms == "auto":
        return list(range(least, least + MOST_ARMS + 1))
    if not isinstance(arms, int | np.integer) or arms < 0:
        raise FitError(f'arms = {arms!r}; expected a number >= 0 or "auto"')
    if arms < least:
        raise FitError(
            f"arms = {arms}, but the relaxation test alone has {least}: ask for at least as many, "
            "one more for what only the hammer sees"
        )
    return [int(arms)]


def _seals(seals: float) -> float:
    if not (np.isfinite(seals) and seals > 0):
        raise DataError(f"seals = {seals!r}; expected a number > 0")
    return seals


def _mass(mass: float | None, sd: float | None) -> Prior | None:
    if mass is None:
        return None
    if not (np.isfinite(mass) and mass > 0):
        raise DataError(f"mass = {mass!r} kg; expected a number > 0")
    return Prior(mass, _spread("mass_sd", USUAL_MASS_SD * mass if sd is None else sd))


def _spread(name: str, value: float) -> float:
    if not (np.isfinite(value) and value >= 0):
        raise DataError(f"{name} = {value!r}; expected a standard deviation >= 0")
    return float(value)


def _known(name: str, given: Given) -> Prior | None:
    if given is None:
        return None
    value, sd = given if isinstance(given, tuple) else (given, 0.0)
    if not (np.isfinite(value) and value > 0):
        raise DataError(f"{name} = {value!r}; expected a number > 0")
    return Prior(float(value), _spread(name, sd))
