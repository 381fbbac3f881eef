"""Dense discrete relaxation spectrum of a master curve."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import (
    FloatArray,
    require_increasing,
    require_same_length,
    validate_samples,
)
from dashpot.base.checks import Check
from dashpot.base.errors import DataError, FitError
from dashpot.base.provenance import Source
from dashpot.datamodel.bounds import BandError
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.parameter_estimate import ParameterEstimate, Residual
from dashpot.extensions.curves.checks import MAX_MISFIT, few_arms_sufficient
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.datamodel.superposition import Superposition, UnshiftedCurve
from dashpot.fitting.fit_construction import SolidEstimate, build_fit
from dashpot.numerics.nonnegative_least_squares import solve_linear
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

FindBand: TypeAlias = Callable[[GeneralizedMaxwell], tuple[tuple[float, float], BandError | None]]

# Arms within half a decade outside the measured frequencies affect the loss at the ends of the
# band; of those farther out only the tail of their loss peak does.
EDGE_FACTOR = float(np.sqrt(10.0))
# a loss below this part of the modulus is not weighed by its own value
_SMALL_LOSS = 1e-3
_MAX_POINTS_PER_DECADE = 24
# a grid on which one sharp arm between two others is followed to 1 %
_TAU_PER_DECADE = 8


@dataclass(frozen=True)
class Misfit:
    """Relative misfit between a curve and its model.

    Attributes
    ----------
    curve : str
        ``"modulus"``, ``"storage"`` or ``"loss"``.
    samples : int
    rms, largest : float
        Root mean square and largest |model/data - 1|.
    at : float
        Position of the largest: s for a modulus over time, else Hz.
    """

    curve: str
    samples: int
    rms: float
    largest: float
    at: float


@dataclass(frozen=True)
class MasterCurve:
    r"""Non-negative spectrum on a uniform grid of ln tau, fitted to a master curve.

    Attributes
    ----------
    model : GeneralizedMaxwell
        In the unit of the data; only the arms that carry something.
    misfit : tuple of Misfit
        One for each curve.
    grid : tuple of float
        Relaxation times offered, s.
    band : (float, float)
        Frequencies that the data cover, Hz; for a curve over time 1/(2 pi t) of its ends.
    source : Source or None
    """

    model: GeneralizedMaxwell
    misfit: tuple[Misfit, ...]
    grid: tuple[float, ...]
    band: tuple[float, float]
    source: Source | None = None

    @property
    def rms(self) -> float:
        """Root mean square relative error over every sample of every curve."""
        count = sum(misfit.samples for misfit in self.misfit)
        return float(np.sqrt(sum(misfit.samples * misfit.rms**2 for misfit in self.misfit) / count))

    @property
    def max_error(self) -> float:
        """Largest relative error of any sample."""
        return max(misfit.largest for misfit in self.misfit)


def master_curve(
    time: npt.ArrayLike, modulus: npt.ArrayLike, *, per_decade: float = 4
) -> MasterCurve:
    r"""Fit a dense spectrum to a relaxation modulus over time.

    .. math:: \min_{k_\infty, k_j \ge 0} \sum_i \Bigl(
        \frac{k_\infty + \sum_j k_j e^{-t_i/\tau_j}}{E_i} - 1\Bigr)^2

    with :math:`\tau_j` on an even grid of ln tau between the second and the last time. This is
    the table of terms that a finite-element code wants; for the fewest arms that explain a curve
    see :func:`~dashpot.extensions.curves.modulus.fit.fit_modulus`.

    Parameters
    ----------
    time : array_like, shape (n,)
        s, > 0, strictly increasing.
    modulus : array_like, shape (n,)
        > 0, in Pa for a material or N/m for a part.
    per_decade : float
        Relaxation times offered per decade.

    Returns
    -------
    MasterCurve
        `model` in the unit of `modulus`.

    Raises
    ------
    DataError
        If the times do not increase from above 0, or a modulus is not above 0.
    """
    t = require_increasing("time", validate_samples("time", time, minimum=3))
    values = validate_samples("modulus", modulus)
    require_same_length(time=t, modulus=values)
    _require_positive("time", t)
    _require_positive("modulus", values)
    # an arm faster than the second time would show in one sample only
    grid = _make_grid(float(t[1]), float(t[-1]), per_decade)
    columns = np.concatenate((np.ones((len(t), 1)), np.exp(-t[:, None] / grid)), axis=1)
    result, _ = solve_linear(columns / values[:, None], np.ones(len(t)), positive=True)
    return MasterCurve(
        _make_solid(result, grid),
        (_compute_misfit("modulus", columns @ result / values - 1.0, t),),
        tuple(grid.tolist()),
        (float(1 / (2 * np.pi * t[-1])), float(1 / (2 * np.pi * t[0]))),
    )


def dynamic_master_curve(data: DynamicTest, *, per_decade: float = 4) -> MasterCurve:
    r"""Fit a dense spectrum to storage and loss over frequency.

    .. math:: \min_{k_\infty, k_j \ge 0} \sum_i \Bigl(\frac{K'(\omega_i)}{K'_i} - 1\Bigr)^2
        + \Bigl(\frac{K''(\omega_i)}{K''_i} - 1\Bigr)^2

    with :math:`\tau_j` on an even grid of ln tau, half a decade beyond the measured
    :math:`1/\omega` at both ends. Each value is weighed by itself; a loss below a thousandth of
    the modulus by that thousandth, and its relative error refers to it too.

    Parameters
    ----------
    data : DynamicTest
        One temperature, or a master curve; the frequencies in any order.
    per_decade : float
        Relaxation times offered per decade.

    Raises
    ------
    DataError
        If a storage is not above 0.
    """
    w = data.omega
    _require_positive("storage", data.storage)
    scale = get_error_scale(data)
    grid = _make_grid(1 / (EDGE_FACTOR * float(w.max())), EDGE_FACTOR / float(w.min()), per_decade)
    x = w[:, None] * grid
    storage = np.concatenate((np.ones((len(w), 1)), x * x / (1 + x * x)), axis=1)
    loss = np.concatenate((np.zeros((len(w), 1)), x / (1 + x * x)), axis=1)
    columns = np.concatenate((storage / scale[0][:, None], loss / scale[1][:, None]))
    target = np.concatenate((data.storage / scale[0], data.loss / scale[1]))
    values, _ = solve_linear(columns, target, positive=True)
    error = columns @ values - target
    n = len(w)
    return MasterCurve(
        _make_solid(values, grid),
        (
            _compute_misfit("storage", error[:n], data.frequency),
            _compute_misfit("loss", error[n:], data.frequency),
        ),
        tuple(grid.tolist()),
        (float(data.frequency.min()), float(data.frequency.max())),
        data.source,
    )


def get_error_scale(data: DynamicTest) -> tuple[FloatArray, FloatArray]:
    """Return the error scales of storage and loss, each its own magnitude, (n,) and (n,)."""
    return (
        np.abs(data.storage),
        np.maximum(np.abs(data.loss), _SMALL_LOSS * np.abs(data.value)),
    )


def compute_passive_misfit(data: DynamicTest) -> tuple[FloatArray, FloatArray] | None:
    """Return the relative residuals of storage and loss of the nearest passive solid, by frequency.

    None if a storage is not above 0, so that errors cannot be relative.
    """
    try:
        dense_model = dynamic_master_curve(data, per_decade=_TAU_PER_DECADE).model
    except DataError:
        return None
    order = np.argsort(data.frequency, kind="stable")
    error = dense_model.complex_stiffness(omega=data.omega) - data.value
    storage, loss = get_error_scale(data)
    return (error.real / storage)[order], (error.imag / loss)[order]


def _make_grid(shortest: float, longest: float, per_decade: float) -> FloatArray:
    if not 1 <= per_decade <= _MAX_POINTS_PER_DECADE:
        raise FitError(
            f"per_decade = {per_decade!r}; expected a number of relaxation times per decade, "
            f"1 to {_MAX_POINTS_PER_DECADE}"
        )
    count = int(np.ceil(np.log10(longest / shortest) * per_decade)) + 1
    return np.geomspace(shortest, longest, count)


def _make_solid(values: FloatArray, grid: FloatArray) -> GeneralizedMaxwell:
    k = values[1:]
    return GeneralizedMaxwell(float(values[0]), tuple(k[k > 0]), tuple(grid[k > 0]))


def _compute_misfit(curve: str, error: FloatArray, abscissa: FloatArray) -> Misfit:
    worst_index = int(np.argmax(np.abs(error)))
    return Misfit(
        curve,
        len(error),
        float(np.sqrt(np.mean(error * error))),
        float(abs(error[worst_index])),
        float(abscissa[worst_index]),
    )


def _require_positive(name: str, values: FloatArray) -> None:
    bad_indices = np.flatnonzero(values <= 0)
    if bad_indices.size:
        i = int(bad_indices[0])
        raise DataError(
            f"{name}[{i}] = {values[i]:g}; expected > 0, so that errors can be relative "
            f"({bad_indices.size} of {len(values)} are not): cut the curve before it drowns in "
            "noise"
        )


# Ratio of the misfits, few arms over dense spectrum, above which the dense spectrum is used.
_MUCH_BETTER = 0.5
# few arms that leave no more than this of what a spectrum of several temperatures leaves will do
_AS_CLOSE = 1.2


class Dense(Protocol):
    """Dense spectrum, and its relative root mean square error."""

    @property
    def model(self) -> GeneralizedMaxwell:
        """Arms of the spectrum."""
        ...

    @property
    def rms(self) -> float:
        """Root mean square over every value of the curves."""
        ...


def dense_spectrum_if_needed(
    fit: Fit,
    error: FloatArray,
    origin: Superposition | UnshiftedCurve,
    spectrum: Callable[[], Dense],
    of_data: Sequence[Check] = (),
    *,
    find_band: FindBand | None = None,
) -> Fit:
    """Return the fit, or the dense spectrum if no small number of arms fits the curves.

    Parameters
    ----------
    fit : Fit
    error : array, shape (n,)
        Its relative errors on every value of the curves.
    origin : Superposition or UnshiftedCurve
        Where the curve comes from; one of several temperatures is left to
        :func:`shared_spectrum_if_needed`.
    spectrum : callable
        Fits the dense spectrum of one temperature.
    of_data : sequence of Check
        Checks of the fit that do not concern its arms.
    find_band : callable, optional
        Finds the valid band of a model, Hz, and its errors there.
    """
    if isinstance(origin, Superposition):
        return shared_spectrum_if_needed(fit, error, origin, of_data, find_band=find_band)
    misfit = float(np.sqrt(np.mean(error * error)))
    if misfit < MAX_MISFIT:
        return fit
    dense = spectrum()
    if dense.rms > _MUCH_BETTER * misfit:
        return fit
    return _replace_by_dense(fit, (misfit, None), dense, len(error), of_data, find_band=find_band)


def shared_spectrum_if_needed(
    fit: Fit,
    error: FloatArray,
    shared: Dense,
    of_data: Sequence[Check] = (),
    *,
    find_band: FindBand | None = None,
) -> Fit:
    """Return the fit, or the spectrum of several temperatures where few arms follow less closely.

    The parameters are those of :func:`dense_spectrum_if_needed`; `shared` is there already.
    """
    misfit, limit = float(np.sqrt(np.mean(error * error))), _AS_CLOSE * shared.rms
    return (
        fit
        if misfit < limit
        else _replace_by_dense(
            fit, (misfit, limit), shared, len(error), of_data, find_band=find_band
        )
    )


def _replace_by_dense(
    fit: Fit,
    misfit_and_limit: tuple[float, float | None],
    dense: Dense,
    values: int,
    of_data: Sequence[Check],
    *,
    find_band: FindBand | None,
) -> Fit:
    """Return the fit with a dense spectrum in the place of arms that miss more than a limit.

    Where it can be found, the valid band is that of the spectrum: about arms that miss
    the curves by much, hardly any frequency is valid.
    """
    check = few_arms_sufficient(
        misfit_and_limit[0],
        fit.model.arms,
        max(order.arms for order in fit.evidence.orders),
        (dense.model.arms, dense.rms),
        misfit_and_limit[1],
    )
    residual = Residual(values, values * dense.rms**2, dense.rms, unit="1")
    estimate = ParameterEstimate(
        (), np.zeros((0, 0)), np.inf, residual, nuisance=fit.estimate.nuisance
    )
    end = fit.evidence.end_of_hold
    band, error = fit.evidence.band, fit.evidence.band_error
    if find_band is not None:
        band, error = find_band(dense.model)
    elif error is not None:
        error = _convert_errors(error, dense.model, fit.model)
    evidence = replace(
        fit.evidence,
        band=band,
        band_error=error,
        certificate=None,
        checks=(*of_data, check),
        end_of_hold=None if end is None else end.widen_to_contain(dense.model),
    )
    return build_fit(
        SolidEstimate(dense.model, estimate),
        evidence,
        fit.provenance,
        unit=fit.unit,
        temperatures=fit.temperatures,
    )


def _convert_errors(error: BandError, target_solid: Solid, fitted: Solid) -> BandError:
    """Return errors about a solid as those about another."""
    omega = 2 * np.pi * np.array(error.frequency)
    K, K_other = (solid.complex_stiffness(omega=omega) for solid in (fitted, target_solid))
    return replace(
        error,
        stiffness=_increase_errors(error.stiffness, np.abs(K), np.abs(K_other)),
        loss_factor=_increase_errors(
            error.loss_factor, K.imag / K.real, K_other.imag / K_other.real
        ),
    )


def _increase_errors(
    errors: tuple[float, ...], value: np.ndarray, other_value: np.ndarray
) -> tuple[float, ...]:
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = np.maximum(value / other_value, other_value / value)
    change = (1 + np.array(errors)) * np.where(np.isfinite(factor), factor, np.inf) - 1
    return tuple(change.tolist())
