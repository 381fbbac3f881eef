"""Bounds of a prediction: parameter errors, and arms outside the test's window."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass
from dashpot.base.arrays import ComplexArray, FloatArray, interpolate_quantile, validate_samples
from dashpot.base.errors import DataError
from dashpot.base.option_fields import Method, get_choice_values
from dashpot.base.student_t import t_quantile
from dashpot.base.units import Quantity, convert_to_si
from dashpot.datamodel.bounds import FRFBounds, StiffnessBounds
from dashpot.datamodel.fit import Fit, get_fewest_arms_model
from dashpot.datamodel.frf import Kind
from dashpot.datamodel.parameter_estimate import ELEMENT_PARAMETERS, parameter_names
from dashpot.numerics.quasirandom import draw_normal
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid
from dashpot.vibration.mass_on_seals import MassOnSeals

if TYPE_CHECKING:
    from dashpot.fitting.admissible_spectra import AdmissibleSpectra
    from dashpot.fitting.input_tests import Tests

# Parameters of a fit as a vector, and the solid of a vector.


_MIN_SHARE = 0.02
"""Smallest fraction of a stiffness after a change."""


class SolidParameters(NamedTuple):
    """Named parameters of a fitted solid, with their covariance.

    The covariance is zero for parameters that the fit holds fixed.
    """

    names: tuple[str, ...]
    values: FloatArray
    covariance: FloatArray


def get_solid_parameters(fit: Fit) -> SolidParameters:
    """Return the parameters of the solid, in the order of a covariance that is of them alone."""
    solid = fit.solid
    names: tuple[str, ...] = ELEMENT_PARAMETERS
    if isinstance(solid, FractionalZener):
        results = [solid.k_inf, solid.k_0, np.log(solid.tau), solid.alpha]
    else:
        model, dashpot = fit.model, "b" in fit.estimate.parameters
        names = parameter_names(model.arms, dashpot=dashpot)
        results = [model.k_inf, *model.k, *np.log(model.tau), *([model.b] if dashpot else [])]
    indices = [i for i, name in enumerate(names) if name in fit.estimate.parameters]
    rows = [fit.estimate.parameters.index(names[i]) for i in indices]
    covariance = np.zeros((len(names), len(names)))
    covariance[np.ix_(indices, indices)] = fit.covariance[np.ix_(rows, rows)]
    return SolidParameters(names, np.array(results), covariance)


def get_parameter_values(fit: Fit) -> FloatArray | None:
    """Return the parameters in the order of the covariance; None where it is not of them."""
    names, result, _ = get_solid_parameters(fit)
    return result if names == fit.estimate.parameters else None


def compute_covariance_axes(covariance: FloatArray) -> FloatArray:
    """Return one standard error along each axis of a covariance, a row each, shape (p, p).

    The sign of an axis is that of its first component that is not small, so that it does not depend
    on the library.
    """
    eigenvalues, eigenvectors = np.linalg.eigh(covariance)
    rows = (eigenvectors * np.sqrt(np.maximum(eigenvalues, 0.0))).T
    magnitudes = np.abs(eigenvectors.T)
    first_large = np.argmax(magnitudes > 0.5 * magnitudes.max(axis=1, keepdims=True), axis=1)
    return np.asarray(
        rows * np.sign(eigenvectors.T[np.arange(len(first_large)), first_large])[:, None]
    )


def compute_covariance_root(covariance: FloatArray) -> FloatArray:
    """Return the symmetric square root of a covariance, shape (p, p), which is the only one."""
    eigenvalues, eigenvectors = np.linalg.eigh(covariance)
    return np.asarray((eigenvectors * np.sqrt(np.maximum(eigenvalues, 0.0))) @ eigenvectors.T)


def off_by_error(fit: Fit) -> tuple[Solid, ...]:
    """Return the solid one standard error off, along each axis of the covariance.

    None where no covariance is known; a stiffness is moved no nearer to 0 than 2 % of it.
    """
    values = get_parameter_values(fit)
    if values is None or not np.isfinite(fit.covariance).all():
        return ()
    return tuple(
        _build_solid(fit, values, values + by) for by in compute_covariance_axes(fit.covariance)
    )


def _build_solid(fit: Fit, values: FloatArray, sampled_values: FloatArray) -> Solid:
    if fit.estimate.parameters == ELEMENT_PARAMETERS:
        k_inf, k_0 = np.maximum(sampled_values[:2], _MIN_SHARE * values[:2])
        alpha = float(np.clip(sampled_values[3], 0.05, 1.0))
        return FractionalZener(float(k_0), float(k_inf), float(np.exp(sampled_values[2])), alpha)
    arms = fit.model.arms
    k = np.maximum(sampled_values[: 1 + arms], _MIN_SHARE * values[: 1 + arms]).tolist()
    tau = np.exp(sampled_values[1 + arms : 1 + 2 * arms])
    order = np.argsort(tau)
    return GeneralizedMaxwell(
        k[0], tuple(k[1 + i] for i in order), tuple(tau[order].tolist()), fit.model.b
    )


DRAW_COUNT = 400
# standard error of a stiffness, as a part of it, and of ln tau, where the fit knows none
UNKNOWN_SD = 3.0
# the resonance is sought within this factor of the fit's own
SEARCH_FACTOR = 5.0
# where the resonance may lie, to this part of a frequency
FREQUENCY_TOLERANCE = 1e-4
# lines of that range, over which the height of the peak is sought
PEAK_LINES = 61
# and other lines within this factor of it
LINE_FACTOR = 1.5


def parameter_band(fit: Fit, frequency: npt.ArrayLike, *, level: float = 0.95) -> StiffnessBounds:
    r"""Return limits of the stiffness that the standard errors of a fit allow.

    This is the formal band: it does not include arms that the fit lacks. The errors of the
    parameters p move each value to first order, as they do in the errors that the fit states:

    .. math:: \sigma_y^2 = \frac{\partial y}{\partial p} \operatorname{cov}(p)
              \frac{\partial y}{\partial p}^T, \qquad y = K',\; K'',\; K''/K'

    Limits are the normal quantiles; none is negative.

    Parameters
    ----------
    fit : Fit
    frequency : array_like, shape (n,)
        Hz, > 0.
    level : float
        Coverage.
    """
    f = _frequencies(frequency)
    _validate_level(level)
    omega = 2 * np.pi * f
    K = fit.solid.complex_stiffness(omega=omega)
    errors = _compute_stiffness_errors(fit, omega)
    loss_factor = K.imag / K.real
    loss_factor_errors = (errors.imag - loss_factor[:, None] * errors.real) / K.real[:, None]
    quantile = t_quantile(level, np.inf)

    def compute_limits(values: FloatArray, errors: FloatArray) -> FloatArray:
        width = quantile * np.sqrt((errors**2).sum(axis=1))
        return np.array([np.maximum(values - width, np.minimum(values, 0.0)), values + width])

    return StiffnessBounds(
        f,
        compute_limits(K.real, errors.real),
        compute_limits(K.imag, errors.imag),
        compute_limits(loss_factor, loss_factor_errors),
        f"{100 * level:g} % of the solids that the fit's own standard errors allow; arms that the "
        "fit does not have are not in it",
    )


def unresolved_arm_band(
    fit: Fit, tests: Tests, frequency: npt.ArrayLike, *, level: float = 0.95
) -> StiffnessBounds:
    r"""Widest limits of the stiffness over all non-negative spectra that the tests do not reject.

    A spectrum is rejected if it leaves more than 1.3 times the squared Student quantile above the
    best one, in units of the noise (:mod:`dashpot.fitting.admissible_spectra`).
    Offset, drift and delay are as uncertain as their priors
    (:mod:`dashpot.fitting.nuisance_priors`). Every line has its own limits: on simulated seals each
    holds the truth in nearly 95 % of tests, line by line; all lines together are held less often.
    The fit's own solid is within the limits, also where the tests would have more arms.

    Parameters
    ----------
    fit : Fit
        Fit of these tests: gives their noise.
    tests : RampHold, RelaxationTest or sequence of them
    frequency : array_like, shape (n,)
        Hz, > 0.
    level : float
        Coverage of each limit.
    """
    f = _frequencies(frequency)
    spectra = _spectra(fit, tests, fastest=2 * np.pi * float(f[-1]), level=level)
    limits = np.array([_limits(spectra, 2 * np.pi * at) for at in f])
    stiffness = fit.solid.complex_stiffness(omega=2 * np.pi * f)
    storage, loss, factor = (
        _widen_to_contain(part, value)
        for part, value in zip(
            limits.transpose(1, 2, 0),
            (stiffness.real, stiffness.imag, stiffness.imag / stiffness.real),
            strict=True,
        )
    )
    message = (
        f"every spectrum of non-negative arms that the relaxation test does not reject at nearly "
        f"{100 * level:g} %, at each frequency alone"
    )
    return StiffnessBounds(f, storage, loss, factor, message)


def frf_band(
    fit: Fit,
    tests: Tests,
    *,
    mass: Quantity,
    frequency: npt.ArrayLike,
    seals: float = 1.0,
    level: float = 0.95,
    kind: Kind | str = Kind.ACCELERANCE,
    coupled: float = 0.0,
) -> FRFBounds:
    r"""Return limits of the response of a mass on `seals` seals, by both kinds of ignorance.

    With :math:`|A| = \omega^2 / |n K^* - m\omega^2|`, the limits follow from the nearest and the
    farthest point of the set of (K', K'') to :math:`(m\omega^2/n, 0)`; those of :math:`|T| = |K^*|
    / |K^* - m\omega^2/n|` from its distances to the origin and that point. For the unresolved arms
    that set is convex, and given by its support function. The resonance lies where :math:`K' =
    m\omega^2/n` for one of them, its height between the largest lower and the largest upper limit.

    Parameters
    ----------
    fit : Fit
        Fit of one seal.
    tests : RampHold, RelaxationTest or sequence of them
        Fitted tests.
    mass : float
        kg.
    frequency : array_like, shape (n,)
        Hz, > 0.
    seals, level : float
    kind : Kind or str
        An accelerance, 1/kg, or the transmissibility from a base that moves, relative or not.
    coupled : float
        For mounts that weigh something, the mass that couples both ends, kg
        (:mod:`dashpot.vibration.mass_on_seals`); of a transmissibility alone.
    """
    mass, kind = convert_to_si(mass, "mass"), Kind(kind)
    if kind is not Kind.ACCELERANCE and not kind.over_base:
        raise DataError(
            f"limits of a {kind} are not known; expected accelerance or transmissibility, "
            "relative or not"
        )
    f = _frequencies(frequency)
    predicted = PredictedFRF(MassOnSeals(mass, seals, coupled=coupled), kind)
    values, formal = _formal(fit, 2 * np.pi * f, predicted, level=level)
    resonance = np.sqrt(seals * fit.model.k_0 / mass) / (2 * np.pi)
    fastest = 2 * np.pi * max(float(f[-1]), SEARCH_FACTOR * resonance)
    spectra = _spectra(fit, tests, fastest=fastest, level=level)

    def limits(at: FloatArray) -> FloatArray:
        omega = 2 * np.pi * at
        stiffness_ranges = np.transpose(
            [predicted.magnitude_limits(spectra, angular_frequency) for angular_frequency in omega]
        )
        return _widen_to_contain(
            stiffness_ranges, predicted.magnitude(fit.solid.complex_stiffness(omega=omega), omega)
        )

    spectrum_limits = limits(f)
    peak = _find_resonance_range(spectra, mass / seals, 2 * np.pi * resonance)
    height = None
    if peak is not None and np.isfinite(peak[1]):
        band_at_peak = limits(np.linspace(*peak, PEAK_LINES))
        is_near_peak = (f > peak[0] / LINE_FACTOR) & (f < peak[1] * LINE_FACTOR)
        low, high = np.concatenate((band_at_peak, spectrum_limits[:, is_near_peak]), axis=1).max(
            axis=1
        )
        height = (float(low), float(high))
    return FRFBounds(
        frequency=f,
        magnitude=values,
        parameter=formal,
        unmeasured=spectrum_limits,
        peak_frequency=peak,
        peak_height=height,
        kind=kind,
        message=f"{100 * level:g} % limits of a predicted {kind}: by the fit's standard errors, "
        "and, approximately and at each frequency alone, by every spectrum that the test does not "
        "reject",
    )


def formal_frf_band(
    fit: Fit, load: MassOnSeals, *, frequency: npt.ArrayLike, kind: Kind
) -> FloatArray:
    """Return lowest and highest magnitude that the standard errors allow at 95 %, shape (2, n).

    Parameters are those of :func:`frf_band`, but for the tests: arms that the fit does not have
    are not in it.
    """
    omega = 2 * np.pi * _frequencies(frequency)
    return _formal(fit, omega, PredictedFRF(load, kind), level=0.95)[1]


@dataclass(frozen=True)
class PredictedFRF:
    """Predicted FRF of a mass on seals: see :func:`frf_band`."""

    mass_on_seals: MassOnSeals
    kind: Kind

    def __post_init__(self) -> None:
        if not (np.isfinite(self.mass_on_seals.mass) and self.mass_on_seals.mass > 0):
            raise DataError(f"mass = {self.mass_on_seals.mass!r} kg; expected a number > 0")

    @property
    def _excited_mass(self) -> float:
        """Return the mass, kg, that the base accelerates; 1 for a force at the mass."""
        over_base = self.kind is Kind.RELATIVE_TRANSMISSIBILITY
        return self.mass_on_seals.mass + self.mass_on_seals.coupled if over_base else 1.0

    def magnitude(self, stiffness: ComplexArray, omega: FloatArray) -> FloatArray:
        """Magnitude of the response on seals of one such stiffness each, shape (..., n)."""
        dynamic_stiffness = np.abs(
            self.mass_on_seals.seals * stiffness - self.mass_on_seals.mass * omega**2
        )
        with np.errstate(divide="ignore"):
            if self.kind is Kind.TRANSMISSIBILITY:
                return np.asarray(
                    np.abs(
                        self.mass_on_seals.seals * stiffness + self.mass_on_seals.coupled * omega**2
                    )
                    / dynamic_stiffness
                )
            return np.asarray(self._excited_mass * omega**2 / dynamic_stiffness)

    def magnitude_limits(self, spectra: AdmissibleSpectra, omega: float) -> tuple[float, float]:
        """Return lowest and highest magnitude over all spectra that the tests do not reject."""
        from dashpot.fitting.admissible_spectra import (
            compute_distance_range,
            compute_transmissibility_range,
        )

        ratio = omega**2 / self.mass_on_seals.seals
        if self.kind is Kind.TRANSMISSIBILITY:
            return compute_transmissibility_range(
                spectra, omega, self.mass_on_seals.mass * ratio, self.mass_on_seals.coupled * ratio
            )
        nearest, farthest = compute_distance_range(spectra, omega, self.mass_on_seals.mass * ratio)
        ratio = ratio * self._excited_mass
        # where a spectrum without loss may resonate, nothing limits the response
        return ratio / farthest, ratio / nearest if nearest > 0 else np.inf


def _formal(
    fit: Fit, omega: FloatArray, predicted: PredictedFRF, *, level: float
) -> tuple[FloatArray, FloatArray]:
    """Return the fit's own magnitude, shape (n,), and its limits by the draws, shape (2, n)."""
    values = predicted.magnitude(fit.solid.complex_stiffness(omega=omega), omega)
    return values, _compute_quantiles(
        predicted.magnitude(_draw_stiffnesses(fit, omega), omega), values, level
    )


# -- errors of the stiffness ------------------------------------------------------------------


def _compute_stiffness_errors(fit: Fit, omega: FloatArray) -> ComplexArray:
    """Return changes of the stiffness by independent standard errors, shape (n, parameters).

    An error that is not known is :data:`UNKNOWN_SD`.
    """
    solid, (names, mean, covariance) = fit.solid, get_solid_parameters(fit)
    slopes = fit.model.arm_slopes(1j * omega)[0]
    if isinstance(solid, FractionalZener):
        slopes = slopes @ solid.arm_gradient()
        sizes = np.array([solid.k_0, solid.k_0, 1.0, 0.1])
    else:
        slopes = np.column_stack((slopes, 1j * omega))[:, : len(names)]
        sizes = np.where([name.startswith("ln") for name in names], 1.0, mean)
    is_undetermined = ~np.isfinite(np.diag(covariance))
    covariance[is_undetermined, :] = covariance[:, is_undetermined] = 0.0
    covariance[is_undetermined, is_undetermined] = (UNKNOWN_SD * sizes[is_undetermined]) ** 2
    return np.asarray(slopes @ compute_covariance_root(covariance))


def _draw_stiffnesses(fit: Fit, omega: FloatArray) -> ComplexArray:
    """Return complex stiffnesses that the standard errors allow, shape (draws, n)."""
    errors = _compute_stiffness_errors(fit, omega)
    K = (
        fit.solid.complex_stiffness(omega=omega)
        + draw_normal(DRAW_COUNT, errors.shape[1]) @ errors.T
    )
    return np.asarray(np.maximum(K.real, 0.0) + 1j * np.maximum(K.imag, 0.0))


def _compute_quantiles(values: FloatArray, base: FloatArray, level: float) -> FloatArray:
    """Return limits that hold the middle `level` of the draws, and the fit itself; shape (2, n)."""
    low, high = (interpolate_quantile(values, q) for q in ((1 - level) / 2, (1 + level) / 2))
    return np.array([np.minimum(low, base), np.maximum(high, base)])


# -- spectra ----------------------------------------------------------------------------------


def _spectra(fit: Fit, tests: Tests, *, fastest: float, level: float) -> AdmissibleSpectra:
    from dashpot.fitting.admissible_spectra import AdmissibleSpectra, deviance_limit
    from dashpot.fitting.input_tests import ramp_holds
    from dashpot.fitting.marginal_relaxation import misfits
    from dashpot.fitting.relaxation_likelihood import build_relaxation_data

    _validate_level(level)
    records = ramp_holds(tests)
    if not records:
        raise DataError("no relaxation test: the unresolved arms are those that such a test misses")
    if fit.method not in get_choice_values(Method):
        raise DataError(
            f"the fit's method is {fit.method!r}: the unresolved arms are bounded by the noise "
            "of the relaxation test alone; give the fit of that test"
        )
    data = [build_relaxation_data(record, fit) for record in records]
    spectra = AdmissibleSpectra(
        data,
        fastest=fastest,
        limit=deviance_limit(level, fit.estimate.dof),
        extra=get_fewest_arms_model(fit).tau,
    )
    spectra.validate_misfit(*misfits(data))
    return spectra


def _limits(spectra: AdmissibleSpectra, omega: float) -> list[tuple[float, float]]:
    storage, loss = spectra.stiffness_at(omega)
    return [
        spectra.limit_functional(storage),
        spectra.limit_functional(loss),
        spectra.ratio_reach(loss, storage),
    ]


def _widen_to_contain(limits: FloatArray, values: FloatArray) -> FloatArray:
    """Limits, shape (2, n), that contain the fit itself."""
    return np.array([np.minimum(limits[0], values), np.maximum(limits[1], values)])


def _find_resonance_range(
    spectra: AdmissibleSpectra, share: float, value: float
) -> tuple[float, float] | None:
    r"""Frequencies, Hz, at which :math:`K' = m\omega^2/n` for some spectrum; `share` is m/n.

    None if every spectrum is softer or stiffer than that wherever it was sought, an upper end of
    infinity if some are stiffer up to the highest frequency.
    """

    def excess(sign: float, omega: float) -> float:
        storage, _ = spectra.stiffness_at(omega)
        return (
            float(storage @ spectra.find_extreme_spectrum(sign * storage)) / (share * omega**2) - 1
        )

    low, high = value / SEARCH_FACTOR, value * SEARCH_FACTOR
    if excess(1, low) < 0 or excess(-1, high) > 0:
        return None
    resonance_limits = [_find_crossing(partial(excess, sign), low, high) for sign in (-1, 1)]
    return resonance_limits[0] / (2 * np.pi), resonance_limits[1] / (2 * np.pi)


def _find_crossing(excess: Callable[[float], float], low: float, high: float) -> float:
    """Return the zero of a falling function: `low` if it begins below, inf if it ends above."""
    at_low, at_high = excess(low), excess(high)
    if at_low <= 0:
        return low
    if at_high > 0:
        return np.inf
    while high / low - 1 > FREQUENCY_TOLERANCE:
        # between the middle, which never fails, and a straight line, which is quick
        middle = float(np.sqrt(low * high))
        line = low * (high / low) ** (at_low / (at_low - at_high))
        for trial_frequency in (line, middle):
            if low < trial_frequency < high:
                value = excess(trial_frequency)
                if value > 0:
                    low, at_low = trial_frequency, value
                else:
                    high, at_high = trial_frequency, value
    return float(np.sqrt(low * high))


# -- frequencies ------------------------------------------------------------------------------


def _frequencies(frequency: npt.ArrayLike) -> FloatArray:
    f = validate_samples("frequency", frequency)
    if f[0] <= 0:
        raise DataError(f"frequency[0] = {f[0]:g} Hz; a band needs frequencies > 0")
    return f


def _validate_level(level: float) -> None:
    if not 0 < level < 1:
        raise DataError(f"level = {level!r}; expected a coverage between 0 and 1, such as 0.95")
