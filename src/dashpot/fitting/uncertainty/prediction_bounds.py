"""How far a prediction may be off: by its parameters, and by arms that the test cannot see."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import ComplexArray, FloatArray, samples
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, si
from dashpot.fitting.relaxation_data import relaxation_data
from dashpot.fitting.uncertainty.admissible_spectra import Spectra, deviance_limit
from dashpot.preparation.ramp_holds import Tests, ramp_holds
from dashpot.records.bounds import FRFBounds, StiffnessBounds
from dashpot.records.estimate import ELEMENT, parameter_names
from dashpot.records.fit import Fit
from dashpot.solids.fractional import FractionalZener

DRAWS = 400
SEED = 20061
# what an unidentified ln tau or relative stiffness may do in a draw
UNKNOWN = 3.0
# inner and outer distance of a point from the set of stiffnesses differ by less
CLOSE = 0.01
# directions in which that set is felt, at most
# so many times the stiffness of a mass is as good as infinite
FAR = 1e9
DIRECTIONS = 40
# the resonance is sought within this factor of the fit's own
SOUGHT = 5.0
# where the resonance may lie, to this part of a frequency
PLACED = 1e-4
# lines of that range, over which the height of the peak is sought
PEAK_LINES = 61
# and other lines within this factor of it
ABOUT = 1.5


def parameter_band(fit: Fit, frequency: npt.ArrayLike, *, level: float = 0.95) -> StiffnessBounds:
    """Limits of the stiffness that the standard errors of a fit allow, by seeded draws.

    This is the formal band: it knows nothing of arms that the fit does not have.

    Parameters
    ----------
    fit : Fit
    frequency : array_like, shape (n,)
        Hz, > 0.
    level : float
        Coverage.
    """
    f = _frequencies(frequency)
    _level(level)
    K = _drawn(fit, 2 * np.pi * f)
    own = fit.solid.complex_stiffness(2 * np.pi * f)
    # a draw that bears nothing has no loss factor
    borne = np.where(K == 0, own, K)
    return StiffnessBounds(
        f,
        _quantiles(K.real, own.real, level),
        _quantiles(K.imag, own.imag, level),
        _quantiles(borne.imag / borne.real, own.imag / own.real, level),
        f"{100 * level:g} % of the solids that the fit's own standard errors allow; arms that the "
        "fit does not have are not in it",
    )


def unseen_arm_band(
    fit: Fit,
    tests: Tests,
    frequency: npt.ArrayLike,
    *,
    level: float = 0.95,
) -> StiffnessBounds:
    r"""Widest limits of the stiffness over all non-negative spectra that the tests do not reject.

    A spectrum is rejected if it leaves more than 1.3 times the squared Student quantile above the
    best one, in units of the noise (:mod:`dashpot.fitting.uncertainty.admissible_spectra`).
    Offset, drift and delay are as uncertain as their priors
    (:mod:`dashpot.fitting.nuisance`). Every line has its own limits: on simulated seals each holds
    the truth in nearly 95 % of tests, line by line; all lines together are held less often. The
    fit's own solid is within the limits, also where the tests would have more arms.

    Parameters
    ----------
    fit : Fit
        Of these tests: gives their noise.
    tests : RampHold, RelaxationTest or sequence of them
    frequency : array_like, shape (n,)
        Hz, > 0.
    level : float
        Coverage of each limit.
    """
    f = _frequencies(frequency)
    spectra = _spectra(fit, tests, fastest=2 * np.pi * float(f[-1]), level=level)
    limits = np.array([_limits(spectra, 2 * np.pi * at) for at in f])
    own = fit.solid.complex_stiffness(2 * np.pi * f)
    storage, loss, factor = (
        _holding(part, value)
        for part, value in zip(
            limits.transpose(1, 2, 0), (own.real, own.imag, own.imag / own.real), strict=True
        )
    )
    says = (
        f"every spectrum of non-negative arms that the relaxation test does not reject at nearly "
        f"{100 * level:g} %, line by line"
    )
    return StiffnessBounds(f, storage, loss, factor, says)


def frf_band(
    fit: Fit,
    tests: Tests,
    *,
    mass: Quantity,
    frequency: npt.ArrayLike,
    seals: float = 1.0,
    level: float = 0.95,
) -> FRFBounds:
    r"""Limits of the accelerance of a mass on `seals` seals, by both kinds of ignorance.

    With :math:`|A| = \omega^2 / |n K^* - m\omega^2|`, the limits follow from the nearest and the
    farthest point of the set of (K', K'') to :math:`(m\omega^2/n, 0)`. For the unseen arms that
    set is convex, and known by its support in every direction asked. The resonance lies where
    :math:`K' = m\omega^2/n` for one of them, its height between the largest lower and the largest
    upper limit.

    Parameters
    ----------
    fit : Fit
        Of one seal.
    tests : RampHold, RelaxationTest or sequence of them
        What it was fitted to.
    mass : float
        kg.
    frequency : array_like, shape (n,)
        Hz, > 0.
    seals, level : float
    """
    mass = si(mass, "mass")
    f = _frequencies(frequency)
    own, formal = _formal(fit, 2 * np.pi * f, mass=mass, seals=seals, level=level)
    resonance = np.sqrt(seals * fit.model.k_0 / mass) / (2 * np.pi)
    fastest = 2 * np.pi * max(float(f[-1]), SOUGHT * resonance)
    spectra = _spectra(fit, tests, fastest=fastest, level=level)

    def limits(at: FloatArray) -> FloatArray:
        omega = 2 * np.pi * at
        inertia = mass * omega**2 / seals
        reach = [_distances(spectra, *each) for each in zip(omega, inertia, strict=True)]
        alone = np.abs(fit.solid.complex_stiffness(omega) - inertia)
        near, far = _holding(np.transpose(reach), alone)
        return np.array([_magnitude(omega, far, seals), _magnitude(omega, near, seals)])

    unseen = limits(f)
    peak = _resonance(spectra, mass / seals, 2 * np.pi * resonance)
    height = None
    if peak is not None and np.isfinite(peak[1]):
        there = limits(np.linspace(*peak, PEAK_LINES))
        about = (f > peak[0] / ABOUT) & (f < peak[1] * ABOUT)
        low, high = np.concatenate((there, unseen[:, about]), axis=1).max(axis=1)
        height = (float(low), float(high))
    return FRFBounds(
        frequency=f,
        magnitude=own,
        parameter=formal,
        unseen=unseen,
        peak_frequency=peak,
        peak_height=height,
        says=f"{100 * level:g} % limits of a predicted accelerance: by the fit's standard errors, "
        "and, nearly so and line by line, by every spectrum that the relaxation test does not "
        "reject",
    )


def formal_frf_band(
    fit: Fit,
    *,
    mass: float,
    frequency: npt.ArrayLike,
    seals: float = 1.0,
    level: float = 0.95,
) -> FloatArray:
    """Lowest and highest accelerance, 1/kg, that the standard errors allow, shape (2, n).

    Parameters are those of :func:`frf_band`, but for the tests: arms that the fit does not have
    are not in it.
    """
    omega = 2 * np.pi * _frequencies(frequency)
    return _formal(fit, omega, mass=mass, seals=seals, level=level)[1]


def _formal(
    fit: Fit, omega: FloatArray, *, mass: float, seals: float, level: float
) -> tuple[FloatArray, FloatArray]:
    """The fit's own accelerance, shape (n,), and its limits by the draws, shape (2, n)."""
    if not (np.isfinite(mass) and mass > 0):
        raise DataError(f"mass = {mass!r} kg; expected a number > 0")
    inertia = mass * omega**2 / seals
    own = np.abs(fit.solid.complex_stiffness(omega) - inertia)
    drawn = np.abs(_drawn(fit, omega) - inertia)
    limits = _quantiles(drawn, own, level)[::-1]
    return _magnitude(omega, own, seals), _magnitude(omega, limits, seals)


def _magnitude(omega: FloatArray, distance: FloatArray, seals: float) -> FloatArray:
    # where a spectrum without loss may resonate at the line, nothing limits the response
    with np.errstate(divide="ignore"):
        return np.asarray(omega**2 / (seals * distance))


# -- draws ------------------------------------------------------------------------------------


def _drawn(fit: Fit, omega: FloatArray) -> ComplexArray:
    """Complex stiffness of solids drawn from the fit's covariance, shape (draws, n)."""
    if isinstance(fit.solid, FractionalZener):
        return _drawn_elements(fit, fit.solid, omega)
    model = fit.model
    names = parameter_names(model.arms, dashpot="b" in fit.parameters)
    rows = [fit.parameters.index(name) for name in names if name in fit.parameters]
    mean = np.array(
        [model.k_inf, *model.k, *np.log(model.tau), *([model.b] if "b" in names else [])]
    )
    here = [i for i, name in enumerate(names) if name in fit.parameters]
    covariance = np.zeros((len(names), len(names)))
    covariance[np.ix_(here, here)] = fit.covariance[np.ix_(rows, rows)]
    widest = UNKNOWN * np.where([name.startswith("ln") for name in names], 1.0, mean)
    variance = np.diag(covariance)
    lost = ~np.isfinite(variance) | (variance > widest**2)
    covariance[lost, :] = covariance[:, lost] = 0.0
    covariance[lost, lost] = widest[lost] ** 2
    draws = _draws(mean, covariance)
    N = model.arms
    k = np.maximum(draws[:, 1 : 1 + N], 0.0)
    x = omega * np.exp(np.clip(draws[:, 1 + N : 1 + 2 * N], -60.0, 60.0))[..., None]
    K = np.maximum(draws[:, :1], 0.0) + (k[..., None] * (1j * x / (1 + 1j * x))).sum(axis=1)
    b = np.maximum(draws[:, -1:], 0.0) if "b" in names else np.full((DRAWS, 1), model.b)
    return np.asarray(K + 1j * omega * b)


def _drawn_elements(fit: Fit, solid: FractionalZener, omega: FloatArray) -> ComplexArray:
    """As :func:`_drawn`, of a fractional solid."""
    rows = [fit.parameters.index(name) for name in ELEMENT]
    covariance = np.array(fit.covariance[np.ix_(rows, rows)])
    mean = np.array([solid.k_inf, solid.k_0, np.log(solid.tau), solid.alpha])
    widest = UNKNOWN * np.array([solid.k_0, solid.k_0, 1.0, 0.1])
    variance = np.diag(covariance)
    lost = ~np.isfinite(variance) | (variance > widest**2)
    covariance[lost, :] = covariance[:, lost] = 0.0
    covariance[lost, lost] = widest[lost] ** 2
    k_inf, k_0, log_tau, alpha = _draws(mean, covariance).T[..., None]
    k_inf = np.maximum(k_inf, 0.0)
    power = np.exp(np.clip(alpha, 1e-3, 1.0) * np.log(1j * omega * np.exp(log_tau)))
    K = k_inf + np.maximum(k_0 - k_inf, 0.0) * (1 - 1 / (1 + power))
    return np.asarray(K + 1j * omega * solid.b)


def _draws(mean: FloatArray, covariance: FloatArray) -> FloatArray:
    """Normal draws of parameters, shape (draws, p)."""
    values, vectors = np.linalg.eigh(covariance)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    normal = np.random.default_rng(SEED).standard_normal((DRAWS, len(mean)))
    return np.asarray(mean + normal @ root.T)


def _quantiles(values: FloatArray, own: FloatArray, level: float) -> FloatArray:
    """Limits that hold the middle `level` of the draws, and the fit itself; shape (2, n)."""
    low, high = np.quantile(values, [(1 - level) / 2, (1 + level) / 2], axis=0)
    return np.array([np.minimum(low, own), np.maximum(high, own)])


# -- spectra ----------------------------------------------------------------------------------


def _spectra(fit: Fit, tests: Tests, *, fastest: float, level: float) -> Spectra:
    _level(level)
    records = ramp_holds(tests)
    if not records:
        raise DataError("no relaxation test: the unseen arms are those that such a test misses")
    if fit.method not in {"full", "hold"}:
        raise DataError(
            f"the fit's method is {fit.method!r}: the unseen arms are bounded by the noise of the "
            "relaxation test alone; give the fit of that test"
        )
    return Spectra(
        [relaxation_data(record, fit) for record in records],
        fastest=fastest,
        limit=deviance_limit(level, fit.dof),
        further=fit.few_arms.tau,
    )


def _limits(spectra: Spectra, omega: float) -> list[tuple[float, float]]:
    storage, loss = spectra.stiffness_at(omega)
    return [spectra.reach(storage), spectra.reach(loss), spectra.ratio_reach(loss, storage)]


def _holding(limits: FloatArray, own: FloatArray) -> FloatArray:
    """Limits, shape (2, n), that hold the fit itself."""
    return np.array([np.minimum(limits[0], own), np.maximum(limits[1], own)])


def _distances(spectra: Spectra, omega: float, inertia: float) -> tuple[float, float]:
    """Nearest and farthest distance of the convex set of (K', K'') from (inertia, 0), outer."""
    columns = np.array(spectra.stiffness_at(omega))
    point = np.array([inertia, 0.0])
    felt = _Felt(columns, spectra, point)
    for direction in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
        felt.towards(np.array(direction))
    while len(felt.directions) < DIRECTIONS:
        nearest, inside = felt.nearest()
        gap_near = 0.0 if inside else 1 - felt.near / max(float(np.linalg.norm(nearest)), 1e-300)
        corner = felt.farthest_corner()
        reach = float(np.linalg.norm(corner))
        # a set that is one point, where the point is, has no farther one
        gap_far = 1 - felt.far / reach if reach > 0 else 0.0
        if max(gap_near, gap_far) <= CLOSE:
            break
        felt.towards(-nearest if gap_near > gap_far else corner)
    nearest, inside = felt.nearest()
    return 0.0 if inside else felt.near, float(np.linalg.norm(felt.farthest_corner()))


class _Felt:
    """What supports in some directions say of a convex set in the plane, seen from a point."""

    def __init__(self, columns: FloatArray, spectra: Spectra, point: FloatArray) -> None:
        self.columns, self.spectra, self.point = columns, spectra, point
        self.directions: list[FloatArray] = []
        self.points: list[FloatArray] = []

    def towards(self, direction: FloatArray) -> None:
        """Feel the set in one more direction."""
        unit = direction / np.linalg.norm(direction)
        spectrum = self.spectra.farthest(unit @ self.columns)
        open_ended = np.isinf(spectrum)
        # as good as without end, and still a point
        end = FAR * float(np.linalg.norm(self.point)) / np.linalg.norm(self.columns, axis=0)
        farthest = self.columns @ np.where(open_ended, end, spectrum)
        self.directions.append(unit)
        self.points.append(farthest - self.point)

    @property
    def near(self) -> float:
        """No point of the set is nearer."""
        supports = np.vecdot(np.array(self.directions), np.array(self.points))
        return max(0.0, -float(supports.min()))

    @property
    def far(self) -> float:
        """Some point of the set is as far."""
        return float(np.linalg.norm(self.points, axis=1).max())

    def nearest(self) -> tuple[FloatArray, bool]:
        """The nearest point of the hull of all points met, and whether the origin is in it."""
        points = np.array(self.points)
        angles = np.sort(np.arctan2(points[:, 1], points[:, 0]))
        inside = float(np.diff(angles, append=angles[0] + 2 * np.pi).max()) < np.pi
        start, end = (points[i] for i in np.triu_indices(len(points), 1))
        along = end - start
        length = np.maximum(np.vecdot(along, along), np.finfo(float).tiny)
        part = np.clip(-np.vecdot(start, along) / length, 0.0, 1.0)
        candidates = start + part[:, None] * along
        distances = np.linalg.norm(candidates, axis=1)
        return candidates[np.argmin(distances)], inside or float(distances.min()) == 0.0

    def farthest_corner(self) -> FloatArray:
        """The farthest corner of the polygon that the support lines enclose."""
        directions, points = np.array(self.directions), np.array(self.points)
        order = np.argsort(np.arctan2(directions[:, 1], directions[:, 0]))
        u, h = directions[order], np.vecdot(directions, points)[order]
        v, g = np.roll(u, -1, axis=0), np.roll(h, -1)
        cross = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        turned = cross > 1e-9
        u, v, h, g = u[turned], v[turned], h[turned], g[turned]
        corners = np.column_stack((h * v[:, 1] - g * u[:, 1], g * u[:, 0] - h * v[:, 0]))
        corners /= cross[turned, None]
        return np.asarray(corners[np.argmax(np.linalg.norm(corners, axis=1))])


def _resonance(spectra: Spectra, share: float, own: float) -> tuple[float, float] | None:
    r"""Frequencies, Hz, at which :math:`K' = m\omega^2/n` for some spectrum; `share` is m/n.

    None if every spectrum is softer or stiffer than that wherever it was sought, an upper end of
    infinity if some are stiffer up to the highest frequency.
    """

    def excess(sign: float, omega: float) -> float:
        storage, _ = spectra.stiffness_at(omega)
        return float(storage @ spectra.farthest(sign * storage)) / (share * omega**2) - 1

    low, high = own / SOUGHT, own * SOUGHT
    if excess(1, low) < 0 or excess(-1, high) > 0:
        return None
    ends = [_crossing(partial(excess, sign), low, high) for sign in (-1, 1)]
    return ends[0] / (2 * np.pi), ends[1] / (2 * np.pi)


def _crossing(excess: Callable[[float], float], low: float, high: float) -> float:
    """Where a falling function passes zero: `low` if it begins below, inf if it ends above."""
    at_low, at_high = excess(low), excess(high)
    if at_low <= 0:
        return low
    if at_high > 0:
        return np.inf
    while high / low - 1 > PLACED:
        # between the middle, which never fails, and a straight line, which is quick
        middle = float(np.sqrt(low * high))
        line = low * (high / low) ** (at_low / (at_low - at_high))
        for at in (line, middle):
            if low < at < high:
                value = excess(at)
                if value > 0:
                    low, at_low = at, value
                else:
                    high, at_high = at, value
    return float(np.sqrt(low * high))


# -- frequencies ------------------------------------------------------------------------------


def _frequencies(frequency: npt.ArrayLike) -> FloatArray:
    f = samples("frequency", frequency)
    if f[0] <= 0:
        raise DataError(f"frequency[0] = {f[0]:g} Hz; a band needs frequencies > 0")
    return f


def _level(level: float) -> None:
    if not 0 < level < 1:
        raise DataError(f"level = {level!r}; expected a coverage between 0 and 1, such as 0.95")
