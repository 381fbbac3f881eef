"""Shift factors of tests at several temperatures, and the law fitted through them."""

from __future__ import annotations

from typing import Any

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import EqualByValue, FloatArray, make_readonly_copy
from dashpot.base.errors import DataError
from dashpot.base.reported_values import ReportedValue
from dashpot.base.serialisation import EVERY_FIELD, Key, Serialisable
from dashpot.base.units import celsius
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.shift_laws import WLF, Arrhenius, FreeShifts, TemperatureLaw

# Smallest distance from the glass transition at which a WLF law is used, K.
GLASS_MARGIN = 10.0
# temperatures that differ by less, K, count as equal
SAME_TEMPERATURE = 0.5
# fewer ramps and holds at as many temperatures cannot contradict one shift of all arms
MIN_CONTRADICTING_TESTS = 3
# relaxation time, s, that is shifted by a_T for any slope
REFERENCE_TAU = 0.5
_LN10 = float(np.log(10.0))
# deviation of a rubber's shifts from a straight line in 1/T, relative to the step between tests
_MAX_BEND = 0.03
# of a parameter, for a slope by differences
_DIFFERENCE_STEP = 1e-6
# name and unit of the constants of a law
_CONSTANTS = {"c1": ("C1", ""), "c2": ("C2", "K"), "energy": ("E_a", "J/mol")}


@dataclass(frozen=True)
class Shift:
    """Shift factors of one temperature against the reference.

    Attributes
    ----------
    temperature : float
        K.
    log10_a_t, se : float
        Decadic logarithm of the shift factor of time, and its standard error.
    b_t, b_t_se : float
        Factor of every stiffness, and its standard error; 0 if it was fixed.
    """

    temperature: float
    log10_a_t: float
    se: float
    b_t: float = 1.0
    b_t_se: float = 0.0

    @property
    def facts(self) -> tuple[ReportedValue, ReportedValue]:
        """Both shifts as rows of a table; a fixed one has no error."""
        return (
            ReportedValue("log10 a_T", self.log10_a_t, error=self.se or None),
            ReportedValue("b_T", self.b_t, error=self.b_t_se or None),
        )


@dataclass(frozen=True, eq=False)
class TemperatureShifts(EqualByValue, Serialisable):
    """Shift factors of several temperatures, and the law fitted through them.

    Attributes
    ----------
    law : TemperatureLaw
        Law of the shift factor of time.
    shifts : tuple of Shift
        By rising temperature; the reference is among them, with no shift and no error.
    covariance : array, shape (2 n, 2 n)
        Covariance of log10 a_T of every shift, then of ln b_T of every shift; zero rows at the
        reference.
    law_parameters : tuple of str
        Names of the rows of `law_covariance`: ``("c1", "c2")``, ``("energy",)`` or none.
    law_covariance : array, shape (p, p)
    vertical : str
        How stiffnesses follow the temperature: ``"free"``, ``"T/T_r"`` or ``"1"``.
    slope : float
        How much further each decade of relaxation time shifts: a solid whose arms all shift
        together has 0.
    cross : array, shape (p + 1, 2 n + 1) or empty
        Covariance of the p parameters of the fit's solid and of `slope` with what `covariance` is
        of and with `slope`; empty where nothing is known of it.
    untested : tuple of float or None
        Temperatures among the shifts, K, without a test, such as an extrapolated reference; None if
        there is none.
    """

    _keys = ("reference", EVERY_FIELD, Key("untested", optional=True))

    law: TemperatureLaw
    shifts: tuple[Shift, ...]
    covariance: FloatArray
    law_parameters: tuple[str, ...] = ()
    law_covariance: FloatArray = ()  # type: ignore[assignment]
    vertical: str = "free"
    slope: float = 0.0
    cross: FloatArray = ()  # type: ignore[assignment]
    untested: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        for name, rows in (
            ("covariance", 2 * len(self.shifts)),
            ("law_covariance", len(self.law_parameters)),
        ):
            values = np.asarray(getattr(self, name), dtype=float).reshape(-1)
            if values.size != rows * rows:
                raise DataError(f"{name} has {values.size} values, expected {rows} x {rows}")
            object.__setattr__(self, name, make_readonly_copy(values.reshape(rows, rows)))
        cross_covariance = np.asarray(self.cross, dtype=float).reshape(-1, 2 * len(self.shifts) + 1)
        object.__setattr__(self, "cross", make_readonly_copy(cross_covariance))
        temperatures = [shift.temperature for shift in self.shifts]
        if temperatures != sorted(set(temperatures)) or self.law.reference not in temperatures:
            raise DataError(
                f"shifts at {temperatures} K; expected rising temperatures with the reference of "
                f"{self.law.reference:g} K among them"
            )

    @property
    def reference(self) -> float:
        """T_r, K: the temperature of the fit's solid."""
        return self.law.reference

    @property
    def constants(self) -> tuple[ReportedValue, ...]:
        """Constants of the shift law with their errors."""
        errors = self.law_covariance.diagonal() ** 0.5
        return tuple(
            ReportedValue(name, getattr(self.law, name), unit=unit, error=float(error), words=label)
            for name, error in zip(self.law_parameters, errors, strict=True)
            for label, unit in [_CONSTANTS[name]]
        )

    @property
    def tested_range(self) -> tuple[float, float]:
        """The coldest and the warmest test, K."""
        return self.tested_shifts[0].temperature, self.tested_shifts[-1].temperature

    @property
    def tested_shifts(self) -> tuple[Shift, ...]:
        """The shifts of temperatures at which a test was made."""
        return tuple(
            shift for shift in self.shifts if shift.temperature not in (self.untested or ())
        )

    @property
    def coldest(self) -> float:
        """Below this, K, nothing is foretold: 10 K above the glass transition, or the coldest test.

        Only a WLF law gives the glass transition.
        """
        if isinstance(self.law, WLF):
            return min(self.law.glass + GLASS_MARGIN, self.tested_range[0])
        return self.tested_range[0] if isinstance(self.law, FreeShifts) else 0.0

    def shift_model(self, solid: GeneralizedMaxwell, temperature: float) -> GeneralizedMaxwell:
        """Return the solid of the reference at T, K.

        Raises
        ------
        DataError
            If T is below :attr:`coldest`, or where the law is not valid.
        """
        if temperature < self.coldest and isinstance(self.law, WLF):
            raise DataError(
                f"{celsius(temperature)} is below {celsius(self.coldest)}: nearer than "
                f"{GLASS_MARGIN:g} K to the glass transition, at about {celsius(self.law.glass)} "
                "by the fitted law, the law fails: test there"
            )
        log_a, tau = float(np.log(self.law.a_t(temperature))), np.asarray(solid.tau)
        change = np.exp(shifted_log_tau(np.log(tau), log_a, self.slope))
        shifted_solid = solid.shift_to_temperature(float(np.exp(log_a)), self.b_t(temperature))
        return replace(shifted_solid, tau=tuple(change.tolist()))

    def error(self, temperature: float) -> tuple[float, float]:
        """Return standard errors of ln a_T and of ln b_T at T, K."""
        gradient = self._gradient(temperature)
        shift_covariance = self.covariance[: len(self.shifts), : len(self.shifts)]
        if self.law_parameters:
            shift_covariance = self.law_covariance
        variance = (
            float(propagate_covariance(gradient[None], shift_covariance)[0, 0])
            + self._compute_bend_limit(temperature) ** 2
        )
        se = float(np.sqrt(max(variance, 0.0)))
        errors = [shift.b_t_se / shift.b_t for shift in self.shifts]
        temperatures = [shift.temperature for shift in self.shifts]
        return _LN10 * se, float(np.interp(temperature, temperatures, errors))

    def _compute_bend_limit(self, temperature: float) -> float:
        """Return the largest bend of free shifts between two tests: 3 % of the step, decades."""
        temperatures = np.array([shift.temperature for shift in self.shifts])
        if (
            not isinstance(self.law, FreeShifts)
            or not temperatures[0] < temperature < temperatures[-1]
        ):
            return 0.0
        i = int(np.searchsorted(temperatures, temperature, side="right")) - 1
        fraction = (temperature - temperatures[i]) / (temperatures[i + 1] - temperatures[i])
        step = self.shifts[i].log10_a_t - self.shifts[i + 1].log10_a_t
        return float(4 * fraction * (1 - fraction) * _MAX_BEND * abs(step))

    def covariance_at(
        self,
        temperature: float,
        names: tuple[str, ...],
        covariance: FloatArray,
        solid: GeneralizedMaxwell,
    ) -> FloatArray:
        """Return the covariance of a solid's parameters at T, K, with that of its shifts.

        `names`, `covariance` and `solid` are those at the reference.
        """
        log_a, b_t = float(np.log(self.law.a_t(temperature))), self.b_t(temperature)
        values = {f"k_{j}": k for j, k in enumerate(solid.k, start=1)} | {"k_inf": solid.k_inf}
        distances = {
            f"ln_tau_{j}": d for j, d in enumerate(decades(np.log(np.asarray(solid.tau))), start=1)
        }
        slopes = np.zeros((len(names), len(names) + 3))
        for row, name in enumerate(names):
            if name in distances:
                slope_factor = 1 + log_a * self.slope / _LN10
                slopes[row, row] = slope_factor
                slopes[row, -3:] = (1 + self.slope * distances[name], 0.0, log_a * distances[name])
            elif name == "b":
                a_b = float(np.exp(log_a)) * b_t
                slopes[row, row] = a_b
                slopes[row, -3:-1] = a_b * solid.b
            else:
                slopes[row, row] = b_t
                slopes[row, -2] = b_t * values.get(name, 0.0)
        return propagate_covariance(slopes, self._with_shifts(temperature, covariance))

    def _with_shifts(self, temperature: float, covariance: FloatArray) -> FloatArray:
        """Return covariance of a solid's parameters, of ln a_T, ln b_T at T, and of the slope."""
        parameter_count, count = len(covariance), len(self.shifts)
        error_of_a, error_of_b = self.error(temperature)
        full_covariance = np.zeros((parameter_count + 3, parameter_count + 3))
        full_covariance[:parameter_count, :parameter_count] = covariance
        (
            full_covariance[parameter_count, parameter_count],
            full_covariance[parameter_count + 1, parameter_count + 1],
        ) = error_of_a**2, error_of_b**2
        if len(self.cross) == parameter_count + 1:
            temperatures = [shift.temperature for shift in self.shifts]
            weights = np.array(
                [np.interp(temperature, temperatures, values) for values in np.eye(count)]
            )
            cross_rows = np.column_stack(
                (
                    self.cross[:, :count] @ weights * _LN10,
                    self.cross[:, count:-1] @ weights,
                    self.cross[:, -1],
                )
            )
            (
                full_covariance[:parameter_count, parameter_count:],
                full_covariance[parameter_count:, :parameter_count],
            ) = cross_rows[:-1], cross_rows[:-1].T
            full_covariance[-1, parameter_count:], full_covariance[parameter_count:, -1] = (
                cross_rows[-1],
                cross_rows[-1],
            )
        return full_covariance

    def rates(self, temperature: float) -> tuple[float, float]:
        """Slopes of ln a_T and of ln b_T over T between the tests about T, 1/K."""
        temperatures = [shift.temperature for shift in self.shifts]
        log_a = _LN10 * np.gradient([shift.log10_a_t for shift in self.shifts], temperatures)
        log_b = np.gradient(np.log([shift.b_t for shift in self.shifts]), temperatures)
        by_a, by_b = (
            float(np.interp(temperature, temperatures, values)) for values in (log_a, log_b)
        )
        return by_a, by_b

    def change_reference(self, temperature: float) -> TemperatureShifts:
        r"""Return the same shifts from another temperature, K, at which the solid then is.

        With :math:`s = \log_{10} a_T` at the new reference every other shift is
        :math:`(s_i - s)/(1 + g s)`: so the slope g does not change.

        Raises
        ------
        DataError
            Where the law is not valid.
        """
        temperatures = [shift.temperature for shift in self.shifts]
        log_a_t, b_t = float(self.law.log10_a_t(temperature)), self.b_t(temperature)
        scale = 1 / (1 + self.slope * log_a_t)
        grid = np.array(sorted({*temperatures, temperature}))
        weights = np.array(
            [np.interp(temperature, temperatures, values) for values in np.eye(len(temperatures))]
        )
        change = (
            np.array(
                [np.interp(grid, temperatures, values) for values in np.eye(len(temperatures))]
            ).T
            - weights
        )
        change[grid == temperature] = 0.0
        jacobian = np.kron(np.diag([scale, 1.0]), change)
        covariance = propagate_covariance(jacobian, self.covariance)
        # what the shift there may be off by, all others are
        is_other_temperature = np.append(grid != temperature, np.zeros(len(grid))) * scale
        covariance = covariance + self._compute_bend_limit(temperature) ** 2 * np.outer(
            is_other_temperature, is_other_temperature
        )
        error = np.sqrt(np.maximum(np.diag(covariance), 0.0)).reshape(2, -1)
        shifts = tuple(
            Shift(
                kelvin,
                0.0 if kelvin == temperature else scale * (self._log10_at(kelvin) - log_a_t),
                float(error[0, i]),
                self.b_t(kelvin) / b_t,
                float(error[1, i]) * self.b_t(kelvin) / b_t,
            )
            for i, kelvin in enumerate(grid.tolist())
        )
        law, jacobian_of_law = self._law_from(temperature, shifts, scale)
        cross_covariance = np.zeros((1, 2 * len(grid) + 1))
        if len(self.cross):
            cross_covariance[-1, -1] = self.cross[-1, -1]
        return replace(
            self,
            law=law,
            shifts=shifts,
            covariance=covariance,
            law_covariance=jacobian_of_law @ self.law_covariance @ jacobian_of_law.T,
            cross=cross_covariance,
            untested=tuple(
                sorted({*grid.tolist()} - {shift.temperature for shift in self.tested_shifts})
            )
            or None,
        )

    def _log10_at(self, temperature: float) -> float:
        """Return the shift found at a tested temperature, K, or the law's at another."""
        nearest_shift = self.find_nearest(temperature)
        if nearest_shift.temperature == temperature:
            return nearest_shift.log10_a_t
        return float(self.law.log10_a_t(temperature))

    def _law_from(
        self, temperature: float, shifts: tuple[Shift, ...], scale: float
    ) -> tuple[TemperatureLaw, FloatArray]:
        """Return the same law from another temperature, and the derivatives of its constants."""
        law = self.law
        if isinstance(law, WLF):
            law_there = law.change_reference(temperature)
            # C_1' = C_1 C_2 / C_2', and C_2' moves with C_2
            jacobian = np.array(
                [
                    [scale * law.c2 / law_there.c2, scale * (law.c1 - law_there.c1) / law_there.c2],
                    [0.0, 1.0],
                ]
            )
            return replace(law_there, c1=scale * law_there.c1), jacobian
        if isinstance(law, Arrhenius):
            return Arrhenius(scale * law.energy, temperature), np.array([[scale]])
        temperatures = tuple(shift.temperature for shift in shifts)
        values = tuple(shift.log10_a_t for shift in shifts)
        return FreeShifts(temperatures, values, temperature), np.zeros((0, 0))

    def find_nearest(self, temperature: float) -> Shift:
        """Return the tested temperature nearest to T, K."""
        return min(self.tested_shifts, key=lambda shift: abs(shift.temperature - temperature))

    def times(self, scale: FloatArray) -> TemperatureShifts:
        """Return the shifts of a solid whose parameters are scaled by these factors."""
        if not len(self.cross):
            return self
        return replace(self, cross=self.cross * np.append(scale, 1.0)[:, None])

    def _gradient(self, temperature: float) -> FloatArray:
        """Slope of log10 a_T by each parameter of the law, or by each free shift."""
        if isinstance(self.law, FreeShifts):
            unit = np.eye(len(self.shifts))
            inverse = [-1 / shift.temperature for shift in self.shifts]
            return np.array([np.interp(-1 / temperature, inverse, values) for values in unit])
        return np.array([self._slope(name, temperature) for name in self.law_parameters])

    def _slope(self, name: str, temperature: float) -> float:
        value = float(getattr(self.law, name))

        def evaluate_shift(factor: float) -> float:
            law: Any = replace(self.law, **{name: factor * value})  # type: ignore[type-var]
            return float(law.log10_a_t(temperature))

        return (evaluate_shift(1 + _DIFFERENCE_STEP) - evaluate_shift(1 - _DIFFERENCE_STEP)) / (
            2 * _DIFFERENCE_STEP * value
        )

    def b_t(self, temperature: float) -> float:
        """Return factor of every stiffness at T, K: ln b straight in T between tests and beyond."""
        if self.vertical == "1":
            return 1.0
        if self.vertical == "T/T_r":
            return temperature / self.reference
        temperatures = np.array([shift.temperature for shift in self.shifts])
        b = np.log([shift.b_t for shift in self.shifts])
        if len(temperatures) == 1:
            return 1.0
        i = int(np.clip(np.searchsorted(temperatures, temperature) - 1, 0, len(temperatures) - 2))
        slope = (b[i + 1] - b[i]) / (temperatures[i + 1] - temperatures[i])
        return float(np.exp(b[i] + slope * (temperature - temperatures[i])))


def propagate_covariance(turn: FloatArray, covariance: FloatArray) -> FloatArray:
    """Return the covariance of `turn` @ x for x of this covariance, which may be infinite."""
    unknown = np.isinf(np.diag(covariance))
    values = np.asarray(turn @ np.where(np.isfinite(covariance), covariance, 0.0) @ turn.T)
    is_affected = (turn[:, unknown] != 0).any(axis=1)
    values[is_affected], values[:, is_affected] = 0.0, 0.0
    values[is_affected, is_affected] = np.inf
    return values


def shifted_log_tau(log_tau: FloatArray, log_a: float, slope: float) -> FloatArray:
    """Ln tau at another temperature, each decade of tau shifted by `slope` further."""
    return np.asarray(log_tau + log_a * (1 + slope * decades(log_tau)))


def decades(log_tau: FloatArray) -> FloatArray:
    """Decades of tau above the one that is shifted by a_T, whatever the slope."""
    return np.asarray((log_tau - np.log(REFERENCE_TAU)) / _LN10)
