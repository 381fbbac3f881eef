r"""Doors of many cars: seals that scatter from car to car, to modes and closing speed.

The seal of a car is that of the door's file with every stiffness and force times :math:`e^u`,

.. math:: u = m + s_b z, \qquad m \sim N(\mu, s_m^2),

with the standard deviation :math:`s_b` between specimens and the error :math:`s_m` of their mean,
which all cars share. A quantity q (the frequency of a mode, the least closing speed) is a function
of u alone, computed at a few u. Where the seal stores the share e of a mode's energy,
:math:`d\ln f/du = e/2`. The share of doors beyond a limit is

.. math:: P(q > L) = 1 - \Phi\bigl((u_L - m)/s_b\bigr), \qquad q(u_L) = L,

and its interval that of draws of m and :math:`s_b` from what the lot knows of them: mean squares
over chi-squared, the generalized interval of Weerahandi (1993).
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import DataError
from dashpot.base.number_format import round_to_error
from dashpot.base.provenance import Source
from dashpot.base.reported_values import INTERVAL_LEVELS, NORMAL, ReportedValue
from dashpot.base.result_mixins import HasVerdict
from dashpot.base.serialisation import EVERY_FIELD, Key, Serialisable
from dashpot.base.units import Dimension, Quantity, convert_to_si, format_quantity, parse_quantity
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.seal_line import SealSection
from dashpot.extensions.systems.door import checks
from dashpot.extensions.systems.door.analyse_file import (
    BAND,
    add_file_to_errors,
    check_door,
    open_door,
)
from dashpot.extensions.systems.door.assembly import Assembly
from dashpot.extensions.systems.door.closing_analysis import find_least_speed, make_closing_door
from dashpot.extensions.systems.door.closing_setup import ClosingSetup
from dashpot.extensions.systems.door.door_model import Door
from dashpot.extensions.systems.door.modes import (
    DoorMode,
    compute_similarity,
    door_modes,
    find_oscillations,
)
from dashpot.extensions.systems.door.mounts import SEAL
from dashpot.extensions.systems.door.result import list_sources
from dashpot.registry import find_handler

_RANGE_SD, _NODES, _DEGREE = 5.0, 11, 4
"""Standard deviations on both sides at which a quantity is computed, how often, and the degree of
the polynomial of its logarithm."""
_DRAWS, _FACTORS = 4000, 4001
_MAX_MODES = 6
"""Modes that are listed at most, if no limit names a higher one."""
_MAX_STIFFNESS_RATIO = 1.5
"""Ratio of the stiffness of a lot and of the fit beyond which they are other seals."""
MIN_SHARE = 1e-3
"""Share of the cars below which the distribution is not known."""
MIN_SD = 1e-6
"""Relative standard deviation below which the seal does not move a quantity."""
_MIN_SPECIMENS = 4
"""Specimens of a lot of which a scatter is taken."""
CLOSING = "closing"
_LIMIT = re.compile(r"\s*(?:mode\s*(\d+)|closing)\s*(<=|>=|<|>)\s*(\S.*?)\s*", re.IGNORECASE)


@dataclass(frozen=True)
class SpecimenSpread(Serialisable):
    """Scatter of the stiffness of seals from car to car.

    Attributes
    ----------
    between_sd : float
        Standard deviation of the ln stiffness between specimens.
    mean : float
        Mean ln of their stiffness over that of the door's fit.
    mean_sd : float
        Standard deviation of its error, which all cars share.
    specimens : int or None
        Number of tested seals; None where the scatter is stated.
    between_square, within_square : float
        Variance of the means of the specimens, and that part of it which repeated tests or the
        fits' own errors explain.
    within_freedom : int
        Degrees of freedom of the second; 0 if it is known.
    """

    _keys = (EVERY_FIELD,)

    between_sd: float
    mean: float = 0.0
    mean_sd: float = 0.0
    specimens: int | None = None
    between_square: float = 0.0
    within_square: float = 0.0
    within_freedom: int = 0

    def draw(self, count: int, seed: int = 0) -> tuple[FloatArray, FloatArray]:
        r"""Return draws of the mean and of the standard deviation between specimens.

        .. math:: s_b^2 = s^2\,\nu/\chi^2_\nu - s_w^2\,\nu_w/\chi^2_{\nu_w}, \qquad
                  m = \mu + z\,\sqrt{s^2\,\nu/\chi^2_\nu / n}

        with the mean squares :math:`s^2` between specimens and :math:`s_w^2` within. Of a stated
        scatter the mean alone is drawn.

        Parameters
        ----------
        count, seed : int
        """
        random = np.random.default_rng(seed)
        z = random.standard_normal(count)
        if self.specimens is None:
            return self.mean + self.mean_sd * z, np.full(count, self.between_sd)
        freedom = self.specimens - 1
        square = self.between_square * freedom / random.chisquare(freedom, count)
        within_variances: FloatArray | float = self.within_square
        if self.within_freedom:
            within_variances = (
                within_variances
                * self.within_freedom
                / random.chisquare(self.within_freedom, count)
            )
        mean = self.mean + np.sqrt(square / self.specimens) * z
        return mean, np.sqrt(np.maximum(square - within_variances, 0.0))


class DoorLimit(NamedTuple):
    """Limit of a quantity of the doors.

    Attributes
    ----------
    quantity : str
        ``"mode 1"`` or ``"closing"``.
    value : float
        Hz or m/s.
    is_upper : bool
        Whether it is an upper limit; else a lower one.
    """

    quantity: str
    value: float
    is_upper: bool


@dataclass(frozen=True)
class DoorQuantity(Serialisable):
    """One quantity over the cars.

    Attributes
    ----------
    name : str
        ``"mode 1"`` or ``"closing"``.
    value : float
        Value of the door whose seal is the median one, Hz or m/s.
    sd, between_sd, mean_sd : float
        Standard deviation of its ln: over the cars with the common error, of the cars, and of the
        common error.
    low, high : float
        Between which 95 % of the cars lie.
    seal_share : float or None
        Share of the seal in the energy of the mode.
    limit : float or None
    limit_is_most : bool
    nonconforming_share : float or None
        Share of the cars, for the median draw of mean and scatter.
    share_low, share_high : float or None
        Its 95 % interval.
    factors, values : tuple of float
        Factors of the stiffness of the seal, and the quantity with each.
    """

    _keys = (EVERY_FIELD,)

    name: str
    value: float
    sd: float
    between_sd: float
    mean_sd: float
    low: float
    high: float
    seal_share: float | None
    factors: tuple[float, ...]
    values: tuple[float, ...]
    limit: float | None = None
    limit_is_most: bool = False
    nonconforming_share: float | None = None
    share_low: float | None = None
    share_high: float | None = None

    @property
    def unit(self) -> str:
        """Unit of the quantity."""
        return "m/s" if self.name == CLOSING else "Hz"

    @property
    def label(self) -> str:
        """Name of the quantity in a table."""
        return "least closing speed" if self.name == CLOSING else self.name


@dataclass(frozen=True, repr=False)
class DoorPopulation(HasVerdict, Serialisable):
    """Doors of many cars with scattered seals.

    Attributes
    ----------
    spread : SpecimenSpread
    quantities : tuple of DoorQuantity
    checks : tuple of Check
    sources : tuple of Source
    """

    schema = "dashpot/door-population@1"
    _keys = ("verdict", Key("shares", "facts"), EVERY_FIELD)

    spread: SpecimenSpread
    quantities: tuple[DoorQuantity, ...]
    checks: tuple[Check, ...] = ()
    sources: tuple[Source, ...] = ()

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """Each quantity with the range of 95 % of the cars, and the share beyond each limit."""
        reported_values = []
        for quantity in self.quantities:
            # of a mode that moves no seal nothing is left but rounding
            scatters = quantity.between_sd > MIN_SD
            reported_values.append(
                ReportedValue(
                    quantity.name.replace(" ", "_"),
                    quantity.value,
                    quantity.low if scatters else math.nan,
                    quantity.high if scatters else math.nan,
                    quantity.unit,
                    None,  # the range is the scatter of the cars, not an error of the value
                    quantity.unit,
                    f"{quantity.label}, 95 % of the cars",
                )
            )
            if quantity.nonconforming_share is not None:
                reported_values.append(
                    ReportedValue(
                        f"{quantity.name.replace(' ', '_')}_beyond",
                        quantity.nonconforming_share,
                        *_compute_share_limits(quantity),
                        "1",
                        None,
                        "%",
                        f"cars with {quantity.label} {format_limit(quantity)}",
                    )
                )
        return tuple(reported_values)

    @property
    def verdict(self) -> Verdict:
        """Verdict, with the share of cars beyond the first limit, or the scatter of a mode."""
        limited = [
            quantity for quantity in self.quantities if quantity.nonconforming_share is not None
        ]
        if limited:
            quantity = limited[0]
            low, share, high = map(
                format_share,
                (quantity.share_low, quantity.nonconforming_share, quantity.share_high),
            )
            interval = low if low == high else f"{low} to {high}"
            words = f"{share} % of the cars (95 % interval {interval}) have the {quantity.label} "
            return verdict(self.checks, headline=words + format_limit(quantity))
        quantity = self.quantities[0]
        words = (
            f"the {quantity.label} is {format_quantity(quantity.value, quantity.unit)} with a "
            f"standard deviation of {100 * quantity.sd:.2g} %"
        )
        return verdict(self.checks, headline=words)


def format_share(share: float | None) -> str:
    """Return a share of the cars in per cent; one that no lot could show is below a limit."""
    if share is None:
        return ""
    if share < MIN_SHARE:
        return f"below {100 * MIN_SHARE:g}"
    return round_to_error(100 * share, digits=2)


def _compute_share_limits(quantity: DoorQuantity) -> tuple[float, float]:
    """Return the interval of a share beyond; nan of one that every draw has the same."""
    low, high = quantity.share_low, quantity.share_high
    if low is None or high is None or low == high:
        return math.nan, math.nan
    return low, high


def format_limit(quantity: DoorQuantity) -> str:
    """Return on which side of its limit a quantity is bad: "above 1.2 m/s"."""
    side_word = "above" if quantity.limit_is_most else "below"
    return f"{side_word} {format_quantity(quantity.limit or 0.0, quantity.unit)}"


def parse_limit(text: str) -> DoorLimit:
    """Return a limit: ``"mode 1 >= 30Hz"`` or ``"closing <= 1.2m/s"``.

    Raises
    ------
    DataError
        If it is none.
    """
    match = _LIMIT.fullmatch(text)
    if match is None:
        raise DataError(
            f"--limit '{text}': expected a mode or the closing speed with a bound, such as "
            "'mode 1 >= 30Hz' or 'closing <= 1.2m/s'"
        )
    number, sign, value = match.groups()
    dimension: Dimension = "velocity" if number is None else "frequency"
    name = CLOSING if number is None else f"mode {int(number)}"
    return DoorLimit(name, parse_quantity(value, dimension), sign.startswith("<"))


def predict_population(
    path: str | Path | Door,
    *,
    lot: Any = None,
    spread: Quantity | None = None,
    limits: Sequence[str] = (),
    band: tuple[float, float] | None = None,
    temperature: float | None = None,
) -> DoorPopulation:
    """Predict modes and closing speed of many cars with seals scattered as in a lot.

    Parameters
    ----------
    path : path or Door
        As :func:`~dashpot.extensions.systems.door.analyse_file.door_file` takes it.
    lot : path or lot, optional
        The seals that were tested, as ``dashpot batch`` wrote them. The mean stiffness of the cars
        is the lot's mean, not that of the seal in the door's fit.
    spread : float or str, optional
        Standard deviation of the stiffness between seals instead, 0.04 or ``"4%"``; the mean is
        that of the door's fit, with its error.
    limits : sequence of str
        ``"mode 1 >= 30Hz"``, ``"closing <= 1.2m/s"``.
    band : (float, float), optional
        Band of the modes, Hz.
    temperature : float, optional
        Temperature of the seal, K.

    Raises
    ------
    ReadError
        If a file cannot be read, or holds an impossible value.
    DataError
        If neither or both of lot and spread are given, or a limit concerns a quantity that the door
        lacks.
    """
    if (lot is None) is (spread is None):
        raise DataError(
            "doors of many cars need the scatter of their seals once: the lot that was tested "
            "(--lot FOLDER), or a standard deviation (--spread 4%)"
        )
    door_limits = [parse_limit(text) for text in limits]
    if len({limit.quantity for limit in door_limits}) < len(door_limits):
        raise DataError("two limits are of the same quantity. Give each its own call")
    assembly, fit = open_door(path, temperature=temperature)
    if fit is None or assembly.door.line is None or assembly.door.line.section is None:
        raise DataError("this door has no seal with a fit, so nothing scatters: give it a [seal]")
    seal_spread = _widen_spread(spread, fit) if lot is None else _read_spread(lot, fit)
    with add_file_to_errors(path):
        widest = math.hypot(_find_widest_sd(seal_spread), seal_spread.mean_sd)
        max_hz = (band or BAND)[1]
        modes = door_modes(_scale_seal(assembly, math.exp(seal_spread.mean)), max_hz)
        u = seal_spread.mean + widest * np.linspace(-_RANGE_SD, _RANGE_SD, _NODES)
        quantities = [
            *_follow_modes(assembly, u, modes, max_hz),
            *_follow_closing(
                assembly, u, is_wanted=any(limit.quantity == CLOSING for limit in door_limits)
            ),
        ]
        names = [name for name, *_ in quantities]
        for limit in door_limits:
            if limit.quantity not in names:
                raise DataError(
                    f"a limit is of {limit.quantity}, and this door has {', '.join(names)}. Name "
                    "one of those, or widen the band"
                )
        by_name = {limit.quantity: limit for limit in door_limits}
        shown_quantities = [
            quantity for i, quantity in enumerate(quantities)
            if i < _MAX_MODES or quantity[0] in by_name or quantity[0] == CLOSING
        ]  # fmt: skip
        distributions = tuple(
            describe_quantity(
                name, u, values, seal_spread, limit=by_name.get(name), seal_share=share
            )
            for name, values, share in shown_quantities
        )
    spread_checks = (
        checks.seals_suffice(seal_spread.specimens),
        checks.scatter_exceeds_testing(
            None if seal_spread.specimens is None else seal_spread.between_sd**2,
            seal_spread.within_square,
        ),
    )
    door_checks = check_door(assembly, fit, modes, max_hz)
    return DoorPopulation(
        seal_spread,
        distributions,
        (*spread_checks, *fit.checks, *door_checks),
        list_sources(assembly, fit),
    )


def _widen_spread(stated_spread: Quantity | None, fit: Fit) -> SpecimenSpread:
    """Return a stated scatter about the door's fit, with the error of that."""
    sd = (
        convert_to_si(stated_spread, "strain")
        if isinstance(stated_spread, str)
        else float(stated_spread or 0.0)
    )
    if not 1e-4 <= sd <= 0.5:
        raise DataError(f"--spread {stated_spread}: expected 0.01 to 50 %, such as 4%")
    return SpecimenSpread(sd, mean_sd=_find_end_stiffness(fit)[1])


def _find_end_stiffness(fit: Fit) -> tuple[float, float]:
    """Return the stiffness at the end of the test, N/m, and the standard deviation of its ln."""
    end = fit.evidence.end_of_hold
    if end is not None and 0 < end.k_end[0] < end.k_end[1] < math.inf:
        reported_value = end.fact(fit.solid, fit.unit)
        return reported_value.value, math.log(reported_value.high / reported_value.low) / (
            2 * NORMAL
        )
    k_inf = fit.model.k_inf
    return k_inf, float(np.sqrt(fit.estimate.covariance[0, 0])) / k_inf


def _read_spread(lot: Any, fit: Fit) -> SpecimenSpread:
    """Return the scatter of the seals of a lot, by the extension that reads lots."""
    read = find_handler("scatter of specimens", "lot")
    if read is None:
        raise DataError("lots are not read by this installation. State the scatter: --spread 4%")
    summary = read(lot)
    if summary["specimens"] < _MIN_SPECIMENS:
        raise DataError(
            f"the lot has {summary['specimens']} seals; at least {_MIN_SPECIMENS} show how they "
            "scatter. Test more, or state the scatter: --spread 4%"
        )
    mean = summary["mean"] - math.log(_find_end_stiffness(fit)[0])
    if abs(mean) > math.log(_MAX_STIFFNESS_RATIO):
        raise DataError(
            f"the seals of the lot are {math.exp(mean):.3g} times as stiff as the fit of the door. "
            "Use a fit of one of them, of the same length"
        )
    square, within_square = summary["between_square"], summary["within_square"]
    return SpecimenSpread(
        math.sqrt(max(square - within_square, 0.0)), mean, math.sqrt(square / summary["specimens"]),
        summary["specimens"], square, within_square, summary["within_freedom"],
    )  # fmt: skip


def _find_widest_sd(specimen_spread: SpecimenSpread) -> float:
    """Return the largest scatter that is drawn, for the range of the factors."""
    factors_drawn = specimen_spread.draw(_DRAWS)[1]
    return max(float(np.quantile(factors_drawn, 0.95)), 1e-4)


def _scale_seal(assembly: Assembly, factor: float) -> Assembly:
    """Return the door with the stiffness and the force of its seal times a factor."""
    line = assembly.door.line
    section = None if line is None else line.section
    assert line is not None  # noqa: S101  -- predict_population refuses a door without a line
    assert isinstance(section, SealSection)  # noqa: S101  -- and without a section
    scaled = replace(
        section,
        solid=section.solid * factor,
        law=None if section.law is None else section.law * factor,
    )
    return replace(assembly, door=replace(assembly.door, line=replace(line, section=scaled)))


def _follow_modes(
    assembly: Assembly, u: FloatArray, modes: Sequence[DoorMode], max_hz: float
) -> list[tuple[str, FloatArray, float | None]]:
    """Return each mode with its frequencies for the factors e^u, followed by its shape."""
    middle = len(u) // 2
    M = assembly.system().mass_matrix
    frequency = np.empty((len(modes), len(u)))
    frequency[:, middle] = [door_mode.mode.frequency for door_mode in modes]
    for indices in (range(middle - 1, -1, -1), range(middle + 1, len(u))):
        shapes = [door_mode.mode.shape for door_mode in modes]
        for i in indices:
            modes_there = find_oscillations(
                _scale_seal(assembly, float(np.exp(u[i]))).system(), 2 * max_hz
            )
            assigned: set[int] = set()
            for j, shape in enumerate(shapes):
                similarities = [
                    -1.0 if k in assigned else compute_similarity(shape, other.shape, M)
                    for k, other in enumerate(modes_there)
                ]
                best_index = int(np.argmax(similarities))
                assigned.add(best_index)
                frequency[j, i], shapes[j] = (
                    modes_there[best_index].frequency,
                    modes_there[best_index].shape,
                )
    return [
        (f"mode {j + 1}", frequency[j], door_mode.share(SEAL)) for j, door_mode in enumerate(modes)
    ]


def _follow_closing(
    assembly: Assembly, u: FloatArray, *, is_wanted: bool
) -> list[tuple[str, FloatArray, float | None]]:
    """Return the lowest closing speed for the factors e^u; empty without [closing] or `is_wanted`.

    Raises
    ------
    DataError
        If the door does not close with one of them.
    """
    if assembly.door.closing in (None, ClosingSetup()) and not is_wanted:
        return []
    speed = find_least_speed(make_closing_door(assembly.door), load=np.exp(u))
    if not np.isfinite(speed).all():
        raise DataError(
            "the stiffest of these seals keep the door from closing at any speed, so no share of "
            "closing speeds follows. Check the latch and the seal of [closing]"
        )
    return [(CLOSING, speed, None)]


def describe_quantity(
    name: str,
    u: FloatArray,
    values: FloatArray,
    specimen_spread: SpecimenSpread,
    *,
    limit: DoorLimit | None = None,
    seal_share: float | None = None,
) -> DoorQuantity:
    """Return the distribution of a quantity over the cars, and the share beyond a limit.

    Parameters
    ----------
    name : str
    u, values : array, shape (n,)
        ln of the factor of the seal's stiffness, and the quantity there.
    specimen_spread : SpecimenSpread
    limit : DoorLimit, optional
    seal_share : float, optional
        Share of the seal in the energy of the mode.
    """
    mean_value, half_range = float(u.mean()), float(np.ptp(u)) / 2
    polynomial = np.polynomial.Polynomial.fit(u, np.log(values), _DEGREE)
    slope = float(polynomial.deriv()(specimen_spread.mean))

    def evaluate(point: float | FloatArray) -> FloatArray:
        return np.exp(polynomial(np.clip(point, mean_value - half_range, mean_value + half_range)))

    value = float(evaluate(specimen_spread.mean))
    interval = evaluate(
        specimen_spread.mean + NORMAL * specimen_spread.between_sd * np.array([-1.0, 1.0])
    )
    common_sd = abs(slope) * specimen_spread.mean_sd
    quantity = DoorQuantity(
        name, value, abs(slope) * math.hypot(specimen_spread.between_sd, specimen_spread.mean_sd),
        abs(slope) * specimen_spread.between_sd, common_sd, float(interval.min()),
        float(interval.max()), seal_share,
        tuple(np.exp(u).tolist()), tuple(values.tolist()),
    )  # fmt: skip
    if limit is None:
        return quantity
    dense = np.linspace(mean_value - half_range, mean_value + half_range, _FACTORS)
    is_beyond = evaluate(dense) > limit.value if limit.is_upper else evaluate(dense) < limit.value
    edges = np.flatnonzero(np.diff(is_beyond))
    share = _make_share_function(dense, is_beyond, edges)
    share_drawn = share(*specimen_spread.draw(_DRAWS))
    nominal = share(np.array([specimen_spread.mean]), np.array([specimen_spread.between_sd]))
    low, high = np.quantile(share_drawn, INTERVAL_LEVELS).tolist()
    return replace(
        quantity, limit=limit.value, limit_is_most=limit.is_upper,
        nonconforming_share=float(nominal[0]), share_low=low, share_high=high,
    )  # fmt: skip


def _make_share_function(
    u_grid: FloatArray, is_beyond: BoolArray, edges: IndexArray
) -> Callable[[FloatArray, FloatArray], FloatArray]:
    """Return a function that gives the share of a normal u beyond the limit.

    Parameters
    ----------
    u_grid : array, shape (n,)
        ln factors at which the quantity was compared with its limit.
    is_beyond : bool array, shape (n,)
        Whether it lies beyond it there.
    edges : array of int
        Last index before each change of `is_beyond`.

    Returns
    -------
    callable
        From arrays of means and standard deviations of u to the shares.
    """
    from scipy.special import ndtr

    bounds = (u_grid[edges] + u_grid[edges + 1]) / 2
    first = bool(is_beyond[0])

    def share(mean: FloatArray, sd: FloatArray) -> FloatArray:
        probability_below = ndtr((bounds[:, None] - mean) / np.maximum(sd, 1e-12))
        levels = np.vstack((np.zeros(len(mean)), probability_below, np.ones(len(mean))))
        return np.asarray(np.diff(levels, axis=0)[(0 if first else 1) :: 2].sum(axis=0))

    return share
