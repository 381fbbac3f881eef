"""How far a prediction may be off: by its parameters, and by arms that the test cannot see."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import ComplexArray, FloatArray, samples
from dashpot.base.errors import DataError
from dashpot.base.student_t import t_quantile
from dashpot.fitting.relaxation_data import relaxation_data
from dashpot.fitting.uncertainty.admissible_spectra import Spectra
from dashpot.records.bounds import FRFBounds, StiffnessBounds
from dashpot.records.estimate import parameter_names
from dashpot.records.fit import Fit
from dashpot.records.relaxation import RampHold, listed

DRAWS = 400
SEED = 20061
# what an unidentified ln tau or relative stiffness may do in a draw
UNKNOWN = 3.0
# bands are smooth: they are worked out at this many frequencies and laid through
NODES = 24
DIRECTIONS = 16


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
    own = fit.model.complex_stiffness(2 * np.pi * f)
    return StiffnessBounds(
        f,
        _quantiles(K.real, own.real, level),
        _quantiles(K.imag, own.imag, level),
        _quantiles(K.imag / K.real, own.imag / own.real, level),
        f"{100 * level:g} % of the solids that the fit's own standard errors allow; arms that the "
        "fit does not have are not in it",
    )


def unseen_arm_band(
    fit: Fit,
    tests: RampHold | Sequence[RampHold],
    frequency: npt.ArrayLike,
    *,
    level: float = 0.95,
) -> StiffnessBounds:
    r"""Widest limits of the stiffness over all non-negative spectra that the tests cannot reject.

    A spectrum is rejected if its chi-square is more than the squared Student quantile above that
    of the best one, in units of the fit's residual with its effective sample size
    (:mod:`dashpot.fitting.uncertainty.admissible_spectra`). Tare and drift are free.

    Parameters
    ----------
    fit : Fit
        Of these tests: gives their noise.
    tests : RampHold or sequence of RampHold
    frequency : array_like, shape (n,)
        Hz, > 0. With more than 24, the band is worked out at 24 and laid through smoothly.
    level : float
        Coverage of each limit.
    """
    f = _frequencies(frequency)
    nodes = _nodes(f)
    spectra = _spectra(fit, tests, fastest=2 * np.pi * float(f[-1]), level=level)
    limits = np.array([_limits(spectra, 2 * np.pi * node) for node in nodes])
    storage, loss, factor = (
        np.array([_laid(f, nodes, limits[:, 2 * i + side]) for side in (0, 1)]) for i in range(3)
    )
    says = (
        f"every spectrum of non-negative arms that the relaxation test does not reject at "
        f"{100 * level:g} %"
    )
    return StiffnessBounds(
        f, np.sort(storage, axis=0), np.sort(loss, axis=0), np.sort(factor, axis=0), says
    )


def frf_band(
    fit: Fit,
    tests: RampHold | Sequence[RampHold],
    *,
    mass: float,
    frequency: npt.ArrayLike,
    seals: float = 1.0,
    level: float = 0.95,
) -> FRFBounds:
    r"""Limits of the accelerance of a mass on `seals` seals, by both kinds of ignorance.

    With :math:`|A| = \omega^2 / |n K^* - m\omega^2|`, the limits follow from the nearest and the
    farthest point of the set of (K', K'') to :math:`(m\omega^2/n, 0)`. For the unseen arms that
    set is convex, and a polygon of 16 sides holds it.

    Parameters
    ----------
    fit : Fit
        Of one seal.
    tests : RampHold or sequence of RampHold
        What it was fitted to.
    mass : float
        kg.
    frequency : array_like, shape (n,)
        Hz, > 0.
    seals, level : float
    """
    f = _frequencies(frequency)
    omega = 2 * np.pi * f
    own, formal = _formal(fit, omega, mass=mass, seals=seals, level=level)
    spectra = _spectra(fit, tests, fastest=float(omega[-1]), level=level)
    near, far = _distances(spectra, f, mass * omega**2 / seals)
    return FRFBounds(
        frequency=f,
        magnitude=own,
        parameter=formal,
        unseen=np.array([_magnitude(omega, far, seals), _magnitude(omega, near, seals)]),
        says=f"{100 * level:g} % limits of a predicted accelerance: by the fit's standard errors, "
        "and by every spectrum that the relaxation test does not reject",
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
    own = np.abs(fit.model.complex_stiffness(omega) - inertia)
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
    values, vectors = np.linalg.eigh(covariance)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    normal = np.random.default_rng(SEED).standard_normal((DRAWS, len(names)))
    draws = mean + normal @ root.T
    N = model.arms
    k = np.maximum(draws[:, 1 : 1 + N], 0.0)
    x = omega * np.exp(np.clip(draws[:, 1 + N : 1 + 2 * N], -60.0, 60.0))[..., None]
    K = np.maximum(draws[:, :1], 0.0) + (k[..., None] * (1j * x / (1 + 1j * x))).sum(axis=1)
    b = np.maximum(draws[:, -1:], 0.0) if "b" in names else np.full((DRAWS, 1), model.b)
    return np.asarray(K + 1j * omega * b)


def _quantiles(values: FloatArray, own: FloatArray, level: float) -> FloatArray:
    """Limits that hold the middle `level` of the draws, and the fit itself; shape (2, n)."""
    low, high = np.quantile(values, [(1 - level) / 2, (1 + level) / 2], axis=0)
    return np.array([np.minimum(low, own), np.maximum(high, own)])


# -- spectra ----------------------------------------------------------------------------------


def _spectra(
    fit: Fit, tests: RampHold | Sequence[RampHold], *, fastest: float, level: float
) -> Spectra:
    _level(level)
    records = listed(tests)
    if not records:
        raise DataError("no relaxation test: the unseen arms are those that such a test misses")
    if fit.method not in {"full", "hold"}:
        raise DataError(
            f"the fit's method is {fit.method!r}: the unseen arms are bounded by the noise of the "
            "relaxation test alone; give the fit of that test"
        )
    relaxations = [relaxation_data(record, fit) for record in records]
    return Spectra(relaxations, fastest=fastest, limit=t_quantile(level, fit.dof) ** 2)


def _limits(spectra: Spectra, omega: float) -> tuple[float, ...]:
    storage, loss = spectra.columns_at(omega)
    return *spectra.reach(storage), *spectra.reach(loss), *spectra.ratio_reach(loss, storage)


def _distances(
    spectra: Spectra, frequency: FloatArray, inertia: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Nearest and farthest point of the convex set of (K', K'') from (inertia, 0), per line."""
    nodes = _nodes(frequency)
    middle, size, support = (
        np.column_stack([_laid(frequency, nodes, row) for row in part.T])
        for part in _polygons(spectra, nodes)
    )
    reach = []
    for i, at in enumerate(inertia):
        corner = middle[i] + size[i] * _corners(support[i])
        corner[:, 1] = np.maximum(corner[:, 1], 0.0)
        reach.append(_from_point(corner, np.array([at, 0.0])))
    near, far = np.transpose(reach)
    return near, far


def _polygons(spectra: Spectra, nodes: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Centre, half axes and support of the set in 16 directions of scaled axes, per node."""
    angles = 2 * np.pi * np.arange(DIRECTIONS // 2) / DIRECTIONS
    found = []
    for node in nodes:
        columns = np.array(spectra.columns_at(2 * np.pi * node))
        ends = np.array([spectra.reach(v) for v in columns])
        centre = ends.mean(axis=1)
        half = np.maximum(np.ptp(ends, axis=1) / 2, 1e-12 * np.abs(centre).max())
        directions = np.column_stack((np.cos(angles), np.sin(angles))) / half
        low, high = np.transpose([spectra.reach(row @ columns) for row in directions])
        own = directions @ centre
        found.append((centre, half, np.concatenate((high - own, own - low))))
    middle, size, support = map(np.array, zip(*found, strict=True))
    return middle, size, support


def _corners(support: FloatArray) -> FloatArray:
    """Corners of the polygon that the support lines enclose, shape (directions, 2)."""
    angles = 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    step = 2 * np.pi / DIRECTIONS
    following = np.roll(support, -1)
    along = (following - support * np.cos(step)) / np.sin(step)
    return np.column_stack(
        (
            support * np.cos(angles) - along * np.sin(angles),
            support * np.sin(angles) + along * np.cos(angles),
        )
    )


def _from_point(corner: FloatArray, point: FloatArray) -> tuple[float, float]:
    """Nearest and farthest distance of a convex polygon from a point."""
    far = float(np.linalg.norm(corner - point, axis=1).max())
    start, along = corner, np.roll(corner, -1, axis=0) - corner
    length = np.maximum((along**2).sum(axis=1), np.finfo(float).tiny)
    part = np.clip(((point - start) * along).sum(axis=1) / length, 0.0, 1.0)
    near = float(np.linalg.norm(start + part[:, None] * along - point, axis=1).min())
    cross = along[:, 0] * (point - start)[:, 1] - along[:, 1] * (point - start)[:, 0]
    inside = (cross >= 0).all() or (cross <= 0).all()
    return (0.0 if inside else near), far


# -- frequencies ------------------------------------------------------------------------------


def _frequencies(frequency: npt.ArrayLike) -> FloatArray:
    f = samples("frequency", frequency)
    if f[0] <= 0:
        raise DataError(f"frequency[0] = {f[0]:g} Hz; a band needs frequencies > 0")
    return f


def _level(level: float) -> None:
    if not 0 < level < 1:
        raise DataError(f"level = {level!r}; expected a coverage between 0 and 1, such as 0.95")


def _nodes(frequency: FloatArray) -> FloatArray:
    if len(frequency) <= NODES:
        return frequency
    return np.geomspace(frequency[0], frequency[-1], NODES)


def _laid(frequency: FloatArray, nodes: FloatArray, values: FloatArray) -> FloatArray:
    """Values between the nodes, straight on a logarithmic frequency axis."""
    return np.asarray(np.interp(np.log(frequency), np.log(nodes), values))
