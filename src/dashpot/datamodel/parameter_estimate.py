r"""Standard errors and confidence intervals of fitted parameters.

The rows of the covariance are k in N/m and ln tau; the reported values follow by the delta method:

.. math:: \mathrm{SE}(\tau) = \tau\,\mathrm{SE}(\ln\tau), \qquad
          \mathrm{Var}(\ln b) = \frac{\mathrm{Var}(k)}{k^2} + \frac{2\,\mathrm{Cov}(k, \ln\tau)}{k}
                              + \mathrm{Var}(\ln\tau), \quad b = k\tau

Intervals are Student's, symmetric in k and in ln tau (so tau > 0 always). Where a profile
likelihood is stored it replaces them: both ends are where the deviance reaches the quantile, and an
end that the data leave open is open. The deviance does not include undetected effects of a rig: its
part of the covariance lengthens either side of a profile by the root of the sum of squares.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import exp, hypot, inf, isfinite, nan, sqrt
from typing import TYPE_CHECKING, Any, NamedTuple, TypedDict, cast

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import (
    ComplexArray,
    EqualByValue,
    FloatArray,
    FrozenArrays,
    make_readonly_copy,
)
from dashpot.base.errors import DataError
from dashpot.base.reported_values import ReportedValue
from dashpot.base.serialisation import EVERY_FIELD, Serialisable
from dashpot.base.units import get_display_unit
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.interconversion import CreepSpectrum

if TYPE_CHECKING:
    from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

Interval = tuple[float, float]

#: rows of the covariance of a fractional Zener model
ELEMENT_PARAMETERS = ("k_inf", "k_0", "ln_tau", "alpha")
#: rows that no number of equal solids in parallel changes
SHAPE_PREFIXES = ("ln_", "alpha")


class Intervals(TypedDict):
    """Confidence intervals in SI units, one per parameter of the model."""

    k_inf: Interval
    k: tuple[Interval, ...]
    tau: tuple[Interval, ...]
    b: tuple[Interval, ...]


class StandardErrors(TypedDict):
    """Standard errors in SI units, one per parameter of the model."""

    k_inf: float
    k: tuple[float, ...]
    tau: tuple[float, ...]
    b: tuple[float, ...]


def parameter_names(arms: int, *, dashpot: bool = False) -> tuple[str, ...]:
    """Return the names of a solid's parameters: k_inf, every k, every ln tau, and b."""
    numbers = range(1, arms + 1)
    names = ("k_inf", *(f"k_{j}" for j in numbers), *(f"ln_tau_{j}" for j in numbers))
    return (*names, "b") if dashpot else names


@dataclass(frozen=True)
class Residual(Serialisable):
    """Statistics of the residual of a fit.

    Attributes
    ----------
    n : int
        Samples fitted.
    sse : float
        Sum of squared residuals, in the square of `unit`.
    rms : float
        Root mean square residual, in `unit`.
    variance_inflation : float
        n / effective n: how many neighbouring residuals say the same thing (1 if white).
    durbin_watson : float
        About 2 for white residuals, towards 0 for correlated ones.
    unit : str
        ``"N"``; ``"1"`` where each is relative to its own value; ``"sd"`` in standard deviations of
        the scatter of each set; else that of the modulus.
    """

    _keys = (EVERY_FIELD, "variance_inflation")

    n: int
    sse: float
    rms: float
    variance_inflation: float = 1.0
    durbin_watson: float = 2.0
    unit: str = "N"


@dataclass(frozen=True, eq=False)
class Profile(FrozenArrays):
    """Profile likelihood of one parameter: deviance against its value.

    Attributes
    ----------
    parameter : str
        Name as in ``Fit.parameters``, for example ``"ln_tau_2"``; ``"ln_b_2"`` for b = k tau.
    value, deviance : array, shape (m,)
        Trial values, ascending, and ``(SSE(value) - SSE_min) / (kappa * s^2)``: compared
        with the chi-square or F quantile of one degree of freedom.
    """

    parameter: str
    value: FloatArray
    deviance: FloatArray

    def __post_init__(self) -> None:
        if len(self.value) != len(self.deviance) or not len(self.value):
            raise DataError(
                f"the profile of {self.parameter} has {len(self.value)} values and "
                f"{len(self.deviance)} deviances; expected one of each, or more"
            )
        super().__post_init__()

    @property
    def best(self) -> float:
        """Parameter value of least deviance."""
        return float(self.value[int(np.argmin(self.deviance))])


@dataclass(frozen=True)
class Nuisance:
    """Nuisance parameter of a fit: tare, drift, gain, delay or mass.

    `prior_sd` is its standard deviation before the fit, where that is on record.
    """

    name: str
    value: float
    standard_error: float
    unit: str
    prior_sd: float | None = None

    @property
    def fact(self) -> ReportedValue:
        """Reported value, as every table shows it."""
        unit, display_unit = self.unit, get_display_unit(self.unit, prefers_small=True)
        return ReportedValue.from_error(
            self.name, self.value, self.standard_error, unit=unit, read=display_unit
        )


class _SolidParameter(NamedTuple):
    """Parameter of a solid, with the standard error of the fitted value or of its logarithm."""

    name: str
    value: float
    error: float
    is_logarithmic: bool = False
    upper_limit: float = inf

    @property
    def standard_error(self) -> float:
        return self.value * self.error if self.is_logarithmic else self.error


@dataclass(frozen=True, eq=False)
class ParameterEstimate(EqualByValue):
    """Uncertainty of the parameters of a solid.

    Attributes
    ----------
    parameters : tuple of str
        Names of the rows of `covariance`: ``"k_inf"``, ``"k_1"``..., ``"ln_tau_1"``...,
        and ``"b"`` if it was fitted; of a fractional Zener model ``"k_inf"``, ``"k_0"``,
        ``"ln_tau"`` and ``"alpha"``. Stiffness in N/m, ln of tau in s.
    covariance : array, shape (p, p)
        Covariance of those parameters, for correlated residuals and for all that a rig may have
        done without a trace. Infinite where not identified.
    dof : float
        Degrees of freedom of the t quantile: effective samples less parameters.
    residual : Residual
    profiles : tuple of Profile
        Where the covariance is no good guide to an interval; of the noise alone.
    nuisance : tuple of Nuisance
    noise_covariance : array, shape (p, p), or None
        The covariance for the residuals alone, which decides what the data can distinguish; None
        where no rig was doubted and it is all there is.
    """

    parameters: tuple[str, ...]
    covariance: FloatArray
    dof: float
    residual: Residual
    profiles: tuple[Profile, ...] = ()
    nuisance: tuple[Nuisance, ...] = ()
    noise_covariance: FloatArray | None = None

    def __post_init__(self) -> None:
        count = len(self.parameters)
        for name in ("covariance", "noise_covariance"):
            matrix = getattr(self, name)
            if matrix is None:
                continue
            covariance = np.asarray(matrix, dtype=float)
            if covariance.shape != (count, count):
                raise DataError(
                    f"{name} has shape {covariance.shape}, expected {(count, count)}: "
                    "one row per parameter"
                )
            object.__setattr__(self, name, make_readonly_copy(covariance))

    @property
    def noise_only(self) -> ParameterEstimate:
        """Estimate with the errors due to noise only, without those of the rig."""
        if self.noise_covariance is None:
            return self
        return replace(self, covariance=self.noise_covariance, noise_covariance=None)

    def with_rig(self, unmeasured: FloatArray) -> ParameterEstimate:
        """Return the estimate with its changes by the rig as columns, shape (p, d)."""
        return replace(
            self,
            covariance=self.covariance + unmeasured @ unmeasured.T,
            noise_covariance=self.noise_only.covariance,
        )

    def scale(self, by: FloatArray) -> ParameterEstimate:
        """Return the estimate with each parameter multiplied by a factor, shape (p,)."""
        products = np.outer(by, by)
        return replace(
            self,
            covariance=self.covariance * products,
            noise_covariance=None
            if self.noise_covariance is None
            else self.noise_covariance * products,
        )

    def convert_to_arms(self, solid: FractionalZener) -> ParameterEstimate:
        """Return the estimate of the arms that approximate a fractional solid, to first order."""
        gradient = solid.arm_gradient()
        rows = [self.parameters.index(name) for name in ELEMENT_PARAMETERS]

        def transform_covariance(covariance: FloatArray) -> FloatArray:
            values = covariance[np.ix_(rows, rows)]
            if not np.isfinite(values).all():
                return np.diag(np.full(len(gradient), inf))
            return np.asarray(gradient @ values @ gradient.T)

        return ParameterEstimate(
            parameter_names(len(gradient) // 2),
            transform_covariance(self.covariance),
            self.dof,
            self.residual,
            noise_covariance=None
            if self.noise_covariance is None
            else transform_covariance(self.noise_covariance),
        )

    def errors_of_vibration(
        self, model: GeneralizedMaxwell, s: ComplexArray
    ) -> tuple[float, float]:
        r"""Largest relative standard errors of :math:`|K(s)|` and of the loss factor, over s.

        Infinite where a parameter of the arms is not known.
        """
        names = ("k_inf", *parameter_names(model.arms)[1:])
        if not set(names) <= set(self.parameters) or model.b:
            return inf, inf
        rows = [self.parameters.index(name) for name in names]
        covariance = self.covariance[np.ix_(rows, rows)]
        if not np.isfinite(covariance).all():
            return inf, inf
        K = model.stiffness_at(s)
        if not (K.real > 0).all():
            return inf, inf
        slopes = model.arm_slopes(s)[0] / K[:, None]
        # d ln K = d ln |K| + j d(angle); the loss factor is the tangent of the angle
        size, angle = (
            np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", values, covariance, values), 0.0))
            for values in (slopes.real, slopes.imag)
        )
        loss_factor = K.imag / K.real
        indices = np.where(loss_factor > 0, loss_factor, np.nan)
        ratio = (1 + indices**2) / indices * angle
        return float(size.max()), float(np.nanmax(ratio)) if np.isfinite(ratio).any() else inf

    def list_values(
        self, solid: Solid, unit: str, level: float = 0.95
    ) -> tuple[ReportedValue, ...]:
        """Return every parameter of a solid, its stiffnesses in `unit`, with error and interval.

        ``k_inf``, then ``k_1``, ``tau_1`` and ``b_1`` = k tau of each arm, and ``b`` of a dashpot
        beside them; ``k_inf``, ``k_0``, ``tau`` and ``alpha`` of a fractional solid.

        Raises
        ------
        DataError
            If `level` is not between 0 and 1.
        """
        units = {"k": unit, "tau": "s", "b": "N s/m" if unit == "N/m" else f"{unit} s"}
        intervals = self.confidence_limits(solid, level)
        reported_values = [
            ReportedValue(
                row.name, float(row.value), *intervals[row.name],
                units.get(row.name.partition("_")[0], ""), row.standard_error,
            )
            for row in self._rows(solid)
        ]  # fmt: skip
        fixed_b = 0.0 if isinstance(solid, FractionalZener) else solid.maxwell.b
        if fixed_b > 0:
            error = self._error("b") if "b" in self.parameters else None
            half_width = nan if error is None else self.quantile(level) * error
            low, high = max(fixed_b - half_width, 0.0), fixed_b + half_width
            reported_values.append(ReportedValue("b", fixed_b, low, high, units["b"], error))
        return tuple(reported_values)

    def standard_errors(self, solid: Solid) -> StandardErrors:
        """Return standard errors of k_inf, and of k, tau and b = k tau of each arm of `solid`."""
        return cast("StandardErrors", _split_by_kind(self.errors(solid).items()))

    def intervals(self, solid: Solid, level: float) -> Intervals:
        """Intervals at `level` of the same, from the profile where there is one.

        Raises
        ------
        DataError
            If `level` is not between 0 and 1.
        """
        return cast("Intervals", _split_by_kind(self.confidence_limits(solid, level).items()))

    def errors(self, solid: Solid) -> dict[str, float]:
        """Return standard errors of the parameters of `solid` by their names, SI units."""
        return {row.name: row.standard_error for row in self._rows(solid)}

    def _rows(self, solid: Solid) -> Iterator[_SolidParameter]:
        """The parameters of a solid, those of each arm together."""
        yield _SolidParameter("k_inf", solid.k_inf, self._error("k_inf"))
        if isinstance(solid, FractionalZener):
            yield _SolidParameter("k_0", solid.k_0, self._error("k_0"))
            yield _SolidParameter("tau", solid.tau, self._error("ln_tau"), is_logarithmic=True)
            yield _SolidParameter("alpha", solid.alpha, self._error("alpha"), upper_limit=1.0)
            return
        model = solid.maxwell
        for j, (k, tau, b) in enumerate(zip(model.k, model.tau, model.arm_b, strict=True), start=1):
            yield _SolidParameter(f"k_{j}", k, self._error(f"k_{j}"))
            yield _SolidParameter(f"tau_{j}", tau, self._error(f"ln_tau_{j}"), is_logarithmic=True)
            yield _SolidParameter(f"b_{j}", b, self._error_of_log_b(model, j), is_logarithmic=True)

    def confidence_limits(self, solid: Solid, level: float) -> dict[str, Interval]:
        """Intervals at `level` of the parameters of `solid` by their names, SI units.

        Raises
        ------
        DataError
            If `level` is not between 0 and 1.
        """
        quantile = self.quantile(level)
        profiles = {profile.parameter: profile for profile in self.profiles}
        noise = {row.name: row.error for row in self.noise_only._rows(solid)}
        entries = {}
        for row in self._rows(solid):
            profile = profiles.get(f"ln_{row.name}" if row.is_logarithmic else row.name)
            if profile is None:
                half_width = quantile * row.error if isfinite(row.error) else inf
                estimate = float(np.log(row.value)) if row.is_logarithmic else row.value
                low, high = estimate - half_width, estimate + half_width
            else:
                low, high = profile_interval(profile, deviance_limit=quantile**2)
                difference = row.error**2 - noise[row.name] ** 2 if isfinite(row.error) else 0.0
                if difference > 0:
                    estimate, extra_half_width = profile.best, quantile * sqrt(difference)
                    low, high = (
                        estimate - hypot(estimate - low, extra_half_width),
                        estimate + hypot(high - estimate, extra_half_width),
                    )
            limits = (
                (_exp(low), _exp(high))
                if row.is_logarithmic
                else (max(low, 0.0), min(high, row.upper_limit))
            )
            entries[row.name] = limits
        return entries

    def quantile(self, level: float) -> float:
        """Return standard errors to either end of an interval at `level`."""
        # Student's distribution costs an import that a fit alone does not pay
        from dashpot.base.student_t import t_quantile

        if not 0.0 < level < 1.0:
            raise DataError(f"level = {level!r}; expected a coverage between 0 and 1, such as 0.95")
        return t_quantile(level, self.dof)

    def _error(self, name: str) -> float:
        """Return standard error of one row; 0 for a parameter that was held fixed.

        Infinite for every parameter if none has a row.
        """
        if not self.parameters:
            return inf
        if name not in self.parameters:
            return 0.0
        row = self.parameters.index(name)
        return sqrt(max(float(self.covariance[row, row]), 0.0))

    def _error_of_log_b(self, model: GeneralizedMaxwell, arm: int) -> float:
        if not self.parameters:
            return inf
        gradient = np.zeros(len(self.parameters))
        for name, slope in ((f"k_{arm}", 1.0 / model.k[arm - 1]), (f"ln_tau_{arm}", 1.0)):
            if name in self.parameters:
                gradient[self.parameters.index(name)] = slope
        has_effect = gradient != 0.0
        block = self.covariance[np.ix_(has_effect, has_effect)]
        if not np.all(np.isfinite(block)):
            return inf
        return sqrt(max(float(gradient[has_effect] @ block @ gradient[has_effect]), 0.0))


@dataclass(frozen=True, eq=False)
class CreepEstimate(FrozenArrays):
    r"""Compliances of a solid fitted to creep, with their uncertainty.

    Attributes
    ----------
    spectrum : CreepSpectrum
        :math:`J(t) = D_g + D_f t + \sum_i D_i (1 - e^{-t/\lambda_i})`, m/N or 1/Pa.
    parameters : tuple of str
        Names of the rows of `covariance`: ``"glass"``, ``"d_1"``..., ``"ln_lam_1"``..., and
        ``"flow"`` if the solid flows.
    covariance : array, shape (p, p)
        Covariance of those parameters, for correlated residuals.
    """

    spectrum: CreepSpectrum
    parameters: tuple[str, ...]
    covariance: FloatArray

    def standard_error(self, name: str) -> float:
        """Standard error of one parameter; of ``"lam_1"`` in s. 0 for one that was not fitted."""
        scale, row = 1.0, name
        if name.startswith("lam_"):
            scale, row = self.spectrum.lam[int(name.removeprefix("lam_")) - 1], f"ln_{name}"
        if row not in self.parameters:
            return 0.0
        index = self.parameters.index(row)
        return scale * sqrt(max(float(self.covariance[index, index]), 0.0))

    def list_values(self, unit: str) -> tuple[ReportedValue, ...]:
        """Return the compliances, in `unit`, the times and any flow of a solid."""
        spectrum, numbers = self.spectrum, range(1, len(self.spectrum.d) + 1)
        rows = [("glass", spectrum.glass, unit)]
        for j, d, lam in zip(numbers, spectrum.d, spectrum.lam, strict=True):
            rows += [(f"d_{j}", d, unit), (f"lam_{j}", lam, "s")]
        if spectrum.flow > 0:
            rows.append(("flow", spectrum.flow, f"{unit} per s"))
        return tuple(
            ReportedValue(name, value, unit=row_unit, error=self.standard_error(name))
            for name, value, row_unit in rows
        )


def _split_by_kind(group: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    """Reported values of k_inf, and of k, tau and b of every arm."""
    entries: dict[str, Any] = {"k_inf": None, "k": (), "tau": (), "b": ()}
    for name, value in group:
        kind, _, index_text = name.partition("_")
        if index_text.isdecimal():
            entries[kind] = (*entries[kind], value)
        else:
            entries[name] = value
    return entries


def profile_interval(profile: Profile, *, deviance_limit: float) -> Interval:
    """Return where the deviance crosses `deviance_limit` for good; an end it never reaches is open.

    The crossing is interpolated on the square root of the deviance, which is straight where the
    likelihood is Gaussian. Beyond a hill there may be another solution that the data do not reject,
    two arms having changed places: the interval reaches there.
    """
    value, root = profile.value, np.sqrt(np.maximum(profile.deviance, 0.0))
    limit = sqrt(deviance_limit)
    optimum_index = int(np.argmin(root))
    return (
        _find_crossing(value[optimum_index::-1], root[optimum_index::-1], limit, -inf),
        _find_crossing(value[optimum_index:], root[optimum_index:], limit, inf),
    )


def _find_crossing(value: FloatArray, root: FloatArray, limit: float, open_end: float) -> float:
    indices_below = np.flatnonzero(root < limit)
    i = int(indices_below[-1]) + 1 if indices_below.size else 0
    if i == len(root):
        return open_end
    if i == 0:
        return float(value[0])
    fraction = (limit - root[i - 1]) / (root[i] - root[i - 1])
    return float(value[i - 1] + fraction * (value[i] - value[i - 1]))


def _exp(value: float) -> float:
    return exp(value) if value < 700.0 else inf
