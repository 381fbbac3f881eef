r"""From the motion of an indenter to the law of the surface.

For each law the record about its largest contact is followed by what the law's own motion would
make of the sensor, with its touch, its speed of approach, an offset and a drift free:

.. math:: y(t) = s(t - t_0;\, \theta, V) + b + d\,(t - \bar t) + \text{noise}

by least squares; offset and drift are projected out. The noise, coloured or not, is that of the
residual, and the covariance is the sandwich with it. Between laws BIC decides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.base.errors import DataError, FitError
from dashpot.base.student_t import t_quantile
from dashpot.engine.inference.covariance import Columns, Noise, noise_of, toeplitz_form
from dashpot.engine.inference.order import bic
from dashpot.fitting.indentation import checks
from dashpot.fitting.indentation.contacts import Contact, largest_contact
from dashpot.fitting.indentation.laws import LAWS, Law, recorded
from dashpot.records.indentation import Found, IndentationFit, IndentationTest
from dashpot.solids.contact import ContactLaw, RelaxingContact, ViscousContact, reduced_modulus
from dashpot.vibration.systems.contact import Collision

_ABOUT = 1.0
"""How much of the flights is taken to either side, in times of the contact."""
_VELOCITY_OFFSET = 3e-3
"""Standard deviation of a velocity's offset, as a part of the speed: no flight shows it."""
_AT_TOUCH = 0.29
"""Standard deviation of a time that is known to lie between two samples, in their distance."""
_TOUCHES = tuple(np.arange(-5.0, 5.5, 0.5).tolist())
"""Where such a touch is sought, in samples."""
_CLIPPED = 3
"""Samples at one and the same extreme that a sensor at its limit leaves."""
_ROUNDING = 1e-5
"""Part of the record that integration and interpolation leave."""
_STEP = 1e-4
_LOSS = 1
"""Place of the law's viscous time, or of g, among the parameters."""
_SLIGHT, _SLIGHT_STEP = 0.02, 2e-3
"""Of a loss, in the unit of time, or of g: below it a step by its logarithm drowns in digits."""
_LOSSES = frozenset({"c", "viscous_time", "g"})
_REACH = 8.0
"""Of the logarithm of a parameter, from where it begins."""
_FIRST_TRIES, _TRIES = 5, 30
_DECIDED = 10.0
"""Difference of BIC beyond which another law is out (Kass and Raftery 1995: very strong)."""

LawName = Literal["auto", "kelvin-voigt", "hertz", "hertz-kelvin-voigt", "hertz-maxwell"]


@dataclass(frozen=True, eq=False)
class _Window:
    """The samples about one contact, and the columns of what the sensor adds."""

    test: IndentationTest
    contact: Contact
    time: FloatArray
    signal: FloatArray
    kept: BoolArray
    clipped: int
    mass: float
    fixed: FloatArray
    prior: FloatArray  # inverse standard deviation of each column, over the noise's

    def modelled(self, hit: Collision, touch: float) -> FloatArray:
        whole = recorded(hit, self.test.of, self.time - touch, self.test.step)
        return whole[self.kept]

    def left(self, model: FloatArray) -> FloatArray:
        """What is left of the record beside a model, offset and drift projected out."""
        return self.signal[self.kept] - model - self.fixed @ self.added(model)

    def penalised(self, model: FloatArray) -> FloatArray:
        """The same, and what the prior has against offset and drift."""
        added = self.added(model)
        rest = self.signal[self.kept] - model - self.fixed @ added
        return np.concatenate((rest, self.prior * added))

    def struck(self, law: Law, theta: FloatArray) -> Collision:
        return law.collision(theta, self.mass, self.test.indenter.pull)

    def added(self, model: FloatArray) -> FloatArray:
        A = self.fixed
        gram = A.T @ A + np.diag(self.prior**2)
        return np.asarray(np.linalg.solve(gram, A.T @ (self.signal[self.kept] - model)))


@dataclass(frozen=True, eq=False)
class _Solved:
    """One law at its optimum."""

    name: str
    theta: FloatArray
    hit: Collision
    model: FloatArray
    residual: FloatArray
    jacobian: FloatArray
    covariance: FloatArray
    noise: Noise

    @property
    def law(self) -> Law:
        return LAWS[self.name]

    @property
    def contact(self) -> ContactLaw:
        return self.law.contact(self.theta, self.hit.mass)


def fit_indentation(test: IndentationTest, *, law: LawName = "auto") -> IndentationFit:
    """Return what the largest contact of a record says of the surface.

    Parameters
    ----------
    test : IndentationTest
        Its indenter's mass must be known; its radius makes a modulus of k.
    law : str
        ``"kelvin-voigt"``, ``"hertz"``, ``"hertz-kelvin-voigt"``, ``"hertz-maxwell"``, or
        ``"auto"``: the one that BIC prefers.

    Raises
    ------
    DataError
        If the mass is missing, or no contact stands out.
    FitError
        If no law can follow the record.
    """
    if law != "auto" and law not in LAWS:
        raise DataError(f"law = '{law}'; expected auto, {', '.join(LAWS)}")
    window = _window(test, largest_contact(test))
    tried = [one for name in ([law] if law != "auto" else LAWS) if (one := _solved(window, name))]
    if not tried:
        raise FitError(
            "no law of contact follows the record: expected one push, in flight before and after; "
            "cut the record about the contact (--segment), or look at it with dashpot inspect"
        )
    least = min(tried, key=lambda one: float(one.residual @ one.residual))
    scores = {one.name: _score(one, least.noise.effective) for one in tried}
    tried.sort(key=lambda one: scores[one.name])
    best = tried[0]
    found = _found(window, best)
    in_contact = _in_contact(window, best)
    flight = best.residual[~in_contact]
    noise = float(np.sqrt(np.mean(flight**2))) if len(flight) > 8 else 0.0
    left = float(np.sqrt(np.mean(best.residual[in_contact] ** 2)))
    size = float(np.ptp(best.model)) or 1.0
    touch = float(best.theta[-1])
    near = [one for one in tried[1:] if scores[one.name] - scores[best.name] < _DECIDED]
    others = [(one.name, _found(window, one)) for one in near]
    fitted = IndentationFit(
        best.name, best.contact, found, tuple((one.name, scores[one.name]) for one in tried),
        test.indenter, test.of, window.time[window.kept] - touch, best.model + best.residual,
        best.model, noise, left / size, touch, best.hit.duration, (), test.source,
    )  # fmt: skip
    judged = checks.judge(
        fitted, best.hit, test, contact=window.contact, clipped=window.clipped, others=others
    )
    return replace(fitted, checks=judged)


def _window(test: IndentationTest, contact: Contact) -> _Window:
    mass = test.indenter.mass
    if mass is None:
        raise DataError("the mass of the indenter is not known; give it (--mass 5g)")
    reach = _ABOUT * contact.duration
    inside = (test.time >= contact.start - reach) & (
        test.time <= contact.start + contact.duration + reach
    )
    time, signal = test.time[inside], contact.sign * test.signal[inside]
    kept = ~_clipped(signal, test.of)
    clipped = int(np.count_nonzero(~kept))
    centred = (time - time.mean()) / max(float(np.ptp(time)), 1e-300)
    columns = {
        "acceleration": np.stack((np.ones(len(time)), centred), axis=1),
        "force": np.stack((np.ones(len(time)), centred), axis=1),
        "velocity": np.ones((len(time), 1)),
        "displacement": np.ones((len(time), 1)),
    }[test.of]
    prior = np.zeros(columns.shape[1])
    if test.of == "velocity":
        scatter = float(np.std(np.diff(signal, 2))) / np.sqrt(6)
        prior[:] = scatter / (_VELOCITY_OFFSET * float(np.ptp(signal)) / 2)
    return _Window(test, contact, time, signal, kept, clipped, mass, columns[kept], prior)


def _clipped(signal: FloatArray, of: str) -> BoolArray:
    """Samples at the limit of a sensor: several in a row of one and the same largest value."""
    if of in {"velocity", "displacement"}:
        return np.zeros(len(signal), dtype=bool)
    at = np.flatnonzero(signal >= signal.max() - 1e-9 * float(np.ptp(signal)))
    clipped = np.zeros(len(signal), dtype=bool)
    if len(at) >= _CLIPPED and at[-1] - at[0] < 2 * len(at):
        clipped[at[0] : at[-1] + 1] = True
    return clipped


def _speed(window: _Window) -> float:
    """Of approach, roughly: of what the contact changes of the speed, somewhat more than half."""
    signal, of = window.signal, window.test.of
    if of == "velocity":
        return 0.55 * float(np.ptp(signal))
    if of == "displacement":
        return 2.0 * float(np.ptp(signal)) / (3 * window.contact.duration)
    begin, end = window.contact.start, window.contact.start + window.contact.duration
    within = (window.time >= begin) & (window.time <= end)
    rest = float(np.median(signal[~within])) if (~within).any() else 0.0
    change = float(np.sum(signal[within] - rest)) * window.test.step
    return max(change, 1e-12) / (1.75 * (window.mass if of == "force" else 1.0))


def _solved(window: _Window, name: str) -> _Solved | None:
    """Least squares from each start of a law; None if none leads to a motion."""
    from scipy.optimize import least_squares

    law, speed, duration = LAWS[name], _speed(window), window.contact.duration
    count = int(window.kept.sum()) + len(window.prior)
    beyond = np.full(count, 10 * float(np.ptp(window.signal)))

    def left(theta: FloatArray) -> FloatArray:
        try:
            return window.penalised(window.modelled(window.struck(law, theta), float(theta[-1])))
        except DataError:
            return beyond

    def slopes(theta: FloatArray) -> FloatArray:
        here, steps = left(theta), np.diag(_steps(theta, duration))
        return np.stack([(left(theta + one) - here) / one.sum() for one in steps], axis=1)

    def descended(first: FloatArray, tries: int) -> tuple[float, FloatArray]:
        scale = np.array([*np.ones(len(first) - 1), duration])
        reach = scale * np.array([*np.full(len(first) - 1, _REACH), 0.8])
        solved = least_squares(
            left, first, jac=slopes, x_scale=scale, bounds=(first - reach, first + reach),
            max_nfev=tries, xtol=1e-7, ftol=1e-7, gtol=1e-12,
        )  # fmt: skip
        return float(solved.cost), np.asarray(solved.x)

    starts = [
        np.array([*np.log((duration / law.lasts, *own, speed)), window.contact.start])
        for own in law.starts
    ]
    first = min((descended(one, _FIRST_TRIES) for one in starts), key=lambda one: one[0])
    cost, theta = descended(first[1], _TRIES)
    if law.exponent == 1:
        # where the force jumps, a touch between two other samples is another valley
        others = [theta + np.eye(len(theta))[-1] * by * window.test.step for by in _TOUCHES]
        near = min(others, key=lambda one: float(np.sum(left(one) ** 2)))
        cost, theta = min((cost, theta), descended(near, _TRIES), key=lambda one: one[0])
    return _assembled(window, name, theta)


def _slopes(
    of: Callable[[FloatArray], FloatArray], theta: FloatArray, duration: float
) -> FloatArray:
    """Central differences by each parameter, shape (n, p)."""
    return np.stack(
        [
            (of(theta + one) - of(theta - one)) / (2 * one.sum())
            for one in np.diag(_steps(theta, duration))
        ],
        axis=1,
    )


def _slight(law: Law, theta: FloatArray) -> bool:
    """Whether the law's loss is so small that its logarithm says nothing."""
    return bool(law.starts[0]) and float(np.exp(theta[_LOSS])) < _SLIGHT


def _from_zero(of: Callable[[FloatArray], FloatArray], theta: FloatArray) -> FloatArray:
    """The derivative by the logarithm of a slight loss, from a step that a motion shows."""
    loss = float(np.exp(theta[_LOSS]))
    more = theta.copy()
    more[_LOSS] = np.log(loss + _SLIGHT_STEP)
    return loss * (of(more) - of(theta)) / _SLIGHT_STEP


def _steps(theta: FloatArray, duration: float) -> FloatArray:
    """How far each parameter is moved: the touch, in s, as far as the motion is sampled densely."""
    return np.array([*np.full(len(theta) - 1, _STEP), 10 * _STEP * duration])


def _assembled(window: _Window, name: str, theta: FloatArray) -> _Solved | None:
    law = LAWS[name]
    try:
        hit = window.struck(law, theta)
    except DataError:
        return None
    model = window.modelled(hit, float(theta[-1]))
    residual = window.left(model)

    def followed(theta: FloatArray) -> FloatArray:
        return window.modelled(window.struck(law, theta), float(theta[-1]))

    try:
        slopes = _slopes(followed, theta, window.contact.duration)
        if _slight(law, theta):
            slopes[:, _LOSS] = _from_zero(followed, theta)
    except DataError:
        return None
    J = np.concatenate((slopes, window.fixed), axis=1)
    noise = noise_of(residual, J, rounding=_ROUNDING * float(np.ptp(model)))
    covariance = _covariance(J, noise, np.concatenate((np.zeros(len(theta)), window.prior)))
    if hit.force[0] > 0:
        # how a recorder takes a jump is not known: the touch lies between two samples
        along = covariance[:, len(theta) - 1] * _AT_TOUCH * window.test.step
        along /= max(covariance[len(theta) - 1, len(theta) - 1], 1e-300)
        covariance = covariance + np.outer(along, along)
    return _Solved(name, theta, hit, model, residual, J, covariance, noise)


def _score(one: _Solved, effective: float) -> float:
    """BIC; all laws by the noise of the one that leaves least, for a misfit is no noise."""
    return bic(
        float(one.residual @ one.residual),
        effective=max(effective, 2.0),
        parameters=one.jacobian.shape[1],
        floor=len(one.residual) * (_ROUNDING * float(np.ptp(one.model))) ** 2,
    )


def _covariance(J: FloatArray, noise: Noise, prior: FloatArray) -> FloatArray:
    """The sandwich with the noise's own autocovariance, and the prior on what the sensor adds."""
    scale = np.sqrt(np.sum(J**2, axis=0) + prior**2)
    scale = np.where(scale > 0, scale, 1.0)
    A = J / scale
    weight = np.diag((prior / scale) ** 2)
    inverse = np.linalg.pinv(A.T @ A + weight, rcond=1e-14, hermitian=True)
    middle = toeplitz_form(Columns(A), noise.autocovariance) + noise.autocovariance[0] * weight
    return np.asarray(inverse @ middle @ inverse / np.outer(scale, scale))


def _in_contact(window: _Window, one: _Solved) -> BoolArray:
    since = window.time[window.kept] - one.theta[-1]
    return np.asarray((since >= 0) & (since <= one.hit.duration))


def _found(window: _Window, one: _Solved) -> tuple[Found, ...]:
    """The law's parameters and what follows from them, each with its interval."""
    values = _follows(window, one.law, one.theta)
    count = len(one.theta)
    slopes = []
    for i in range(count - 1):
        step = np.zeros(count)
        step[i] = 1e-3
        up, down = (_follows(window, one.law, one.theta + sign * step) for sign in (1, -1))
        slopes.append([(np.log(up[name][0]) - np.log(down[name][0])) / 2e-3 for name in values])
    if _slight(one.law, one.theta):

        def logarithms(theta: FloatArray) -> FloatArray:
            return np.log([value for value, _ in _follows(window, one.law, theta).values()])

        # the loss is as its logarithm has it; what follows from it moves too little to be seen so
        for i, slope in enumerate(_from_zero(logarithms, one.theta).tolist()):
            if list(values)[i] not in _LOSSES:
                slopes[_LOSS][i] = slope
    G = np.array([*slopes, [0.0] * len(values)])
    variance = np.einsum("in,ij,jn->n", G, one.covariance[:count, :count], G)
    dof = max(one.noise.effective - one.jacobian.shape[1], 1.0)
    error = np.sqrt(np.maximum(variance, 0.0))
    wide, once = t_quantile(0.95, dof) * error, t_quantile(0.90, dof) * error
    found = []
    for (name, (value, unit)), by, beyond in zip(
        values.items(), wide.tolist(), once.tolist(), strict=True
    ):
        if name in _LOSSES:  # which has a normal error itself, where its logarithm has none
            low, high = (0.0, 1 + beyond) if by >= 1 else (1 - by, 1 + by)
            found.append(Found(name, value, value * low, value * high, unit))
            continue
        spread = float(np.exp(min(by, 50.0)))
        found.append(Found(name, value, value / spread, value * spread, unit))
    return tuple(found)


def _follows(window: _Window, law: Law, theta: FloatArray) -> dict[str, tuple[float, str]]:
    """Each number that a law's parameters give, by name, with its unit."""
    contact, hit = law.contact(theta, window.mass), window.struck(law, theta)
    radius = window.test.indenter.radius
    known: dict[str, tuple[float, str]] = {"k": (contact.k, f"N/m^{contact.exponent:g}")}
    sphere = radius is not None and contact.exponent != 1
    if isinstance(contact, ViscousContact) and contact.viscous_time > 0:
        if contact.exponent == 1:
            known = {"k": (contact.k, "N/m"), "c": (contact.c, "N s/m")}
        else:
            known["viscous_time"] = (contact.viscous_time, "s")
    if isinstance(contact, RelaxingContact):
        known |= {"g": (contact.g, ""), "tau": (contact.tau, "s")}
    if sphere and radius is not None:
        known["modulus"] = (reduced_modulus(contact.k, radius), "Pa")
        if isinstance(contact, RelaxingContact):
            known["glassy_modulus"] = (known["modulus"][0] * (1 + contact.g), "Pa")
    elif radius is not None:
        # of the sphere that is as stiff at the largest indentation
        known["modulus"] = (reduced_modulus(contact.k / np.sqrt(hit.depth), radius), "Pa")
    return known | {
        "restitution": (hit.restitution, ""),
        "impact_velocity": (hit.approach, "m/s"),
        "duration": (hit.duration, "s"),
        "depth": (hit.depth, "m"),
        "largest_force": (hit.largest_force, "N"),
    }
