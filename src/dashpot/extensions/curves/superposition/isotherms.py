r"""Isotherm: data at one temperature as rows of a shifted non-negative spectrum.

With :math:`v = t / (a_T \tau)` over time, :math:`z = \omega a_T \tau` over frequency:

.. math:: E(t) = b_T \Bigl(E_\infty + \sum_k h_k e^{-v_k}\Bigr), \qquad
          E^*(\omega) = b_T \Bigl(E_\infty + \sum_k h_k \frac{j z_k}{1 + j z_k}\Bigr), \qquad
          J(t) = \frac{1}{b_T} \Bigl(J_g + \sum_k h_k (1 - e^{-v_k})\Bigr)

with retardation times in the place of relaxation times in the last, the slowest of them, far beyond
what was measured, as good as a flow.

Residuals are over the size of the measured modulus; storage and loss both over :math:`|E^*|`, for
a loss relative to itself weighs most where it is nearly zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, TypeAlias

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, FloatArray, IndexArray, median
from dashpot.base.errors import FitError
from dashpot.base.provenance import Source, list_sources
from dashpot.base.units import celsius
from dashpot.extensions.curves.datamodel.creep import CreepCompliance
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.datamodel.modulus import RelaxationModulus
from dashpot.extensions.curves.datamodel.sample_temperatures import ONE_TEMPERATURE

Measured: TypeAlias = DynamicTest | RelaxationModulus | CreepCompliance
Domain: TypeAlias = Literal["frequency", "time", "creep"]

_COLUMNS: dict[type, tuple[str, ...]] = {
    DynamicTest: ("frequency", "storage", "loss"),
    RelaxationModulus: ("time", "modulus"),
    CreepCompliance: ("time", "compliance"),
}

# Smallest number of values of an isotherm whose shift is fitted.
MIN_VALUES = 2


@dataclass(frozen=True, eq=False)
class Isotherm:
    """Data at one temperature.

    Attributes
    ----------
    temperature : float
        K, the median of its samples.
    domain : str
    at : array, shape (n,)
        Angular frequency, rad/s, or time, s; rising.
    value : array, shape (m,)
        Storage, then loss (m = 2 n), or the modulus or compliance (m = n), over `size`.
    size : array, shape (m,)
        Reference values of relative errors, in the unit of the data.
    """

    temperature: float
    domain: Domain
    at: FloatArray
    value: FloatArray
    size: FloatArray

    @property
    def window(self) -> tuple[float, float]:
        """The shortest and the longest relaxation time that it sees there, natural logarithms."""
        log_range = np.log(self.at[[0, -1]])
        low, high = -log_range[::-1] if self.domain == "frequency" else log_range
        return float(low), float(high)

    @property
    def complex(self) -> ComplexArray:
        """The complex modulus, in the unit of the data, shape (n,)."""
        n, value = len(self.at), self.value * self.size
        return np.asarray(value[:n] + 1j * value[n:], dtype=complex)

    def vertical(self, ln_b: float) -> float:
        """Return factor of its values where stiffnesses are b_T times those of the reference."""
        return float(np.exp(-ln_b if self.domain == "creep" else ln_b))

    def columns(self, ln_tau: FloatArray, ln_a: float) -> FloatArray:
        """Return rows of the plateau and of unit arms at the reference, shape (m, 1 + k)."""
        unit = self._unit(ln_tau, ln_a)
        plateau = np.ones((len(unit), 1))
        if self.domain == "frequency":
            plateau[len(self.at) :] = 0.0
        return np.concatenate((plateau, unit), axis=1) / self.size[:, None]

    def _unit(self, ln_tau: FloatArray, ln_a: float) -> FloatArray:
        if self.domain != "frequency":
            v = self.at[:, None] * np.exp(-ln_tau - ln_a)
            return np.exp(-v) if self.domain == "time" else -np.expm1(-v)
        z = self.at[:, None] * np.exp(ln_tau + ln_a)
        storage = 1 - 1 / (1 + z * z)
        return np.concatenate((storage, z / (1 + z * z)))

    def slope(self, ln_tau: FloatArray, ln_a: float, h: FloatArray) -> FloatArray:
        r"""Return derivative of the rows' sum, arms `h`, in :math:`\ln a_T`, shape (m,)."""
        if self.domain != "frequency":
            v = self.at[:, None] * np.exp(-ln_tau - ln_a)
            sign = 1.0 if self.domain == "time" else -1.0
            return np.asarray(sign * (np.exp(-v) * v) @ h / self.size)
        z = self.at[:, None] * np.exp(ln_tau + ln_a)
        ratio = 1 / (1 + z * z)
        storage, loss = 2 * ratio * (1 - ratio), z * ratio * (2 * ratio - 1)
        return np.concatenate((storage @ h, loss @ h)) / self.size


def join_tests(data: Measured | Sequence[Measured]) -> tuple[Measured, tuple[Source, ...]]:
    """Return several tests as the samples of one, each at its specimen's temperature if need be.

    Rows that repeat another to the last digit are omitted.

    Raises
    ------
    FitError
        If they are of different kinds or units, or one has no temperature.
    """
    tests = [data] if isinstance(data, Measured) else list(data)
    if len({(type(test), test.unit) for test in tests}) != 1:
        raise FitError(
            "a master curve takes tests of one kind and one unit: sweeps, or relaxation moduli, "
            "or creep compliances, all of a material or all of a part"
        )
    temperatures = [_with_temperature(test, i) for i, test in enumerate(tests, start=1)]

    def all_of(name: str) -> FloatArray:
        return np.concatenate([getattr(test, name) for test in temperatures])

    names = (*_COLUMNS[type(temperatures[0])], "temperature")
    columns = [all_of(name) for name in names]
    # a row that stands twice is one measurement
    row_indices = np.sort(np.unique(np.column_stack(columns), axis=0, return_index=True)[1])
    columns_by_name: Any = dict(
        zip(names, (column[row_indices] for column in columns), strict=True)
    )
    return replace(temperatures[0], **columns_by_name), list_sources(tests)


def _with_temperature(test: Measured, number: int) -> Measured:
    if test.temperature is not None:
        return test
    kelvin = test.specimen.temperature
    if kelvin is None:
        name = f"test {number}" if test.source is None else test.source.file
        raise FitError(
            f"{name} says no temperature, so nothing can be shifted. Of one temperature leave "
            "--reference out. Of several name the column, --column temperature=NAME, or give "
            "--temperature for each file"
        )
    abscissa = test.frequency if isinstance(test, DynamicTest) else test.time
    return replace(test, temperature=np.full(len(abscissa), kelvin))


def split_isotherms(data: Measured) -> tuple[Isotherm, ...]:
    """Return the isotherms of a test, by rising temperature.

    Samples belong together whose temperatures lie within :data:`ONE_TEMPERATURE` of each other,
    without a gap of half of that.

    Raises
    ------
    FitError
        If the test has no temperatures, an isotherm too few values, or a modulus is not above 0.
    """
    if data.temperature is None:
        raise FitError("the test has no temperatures, so nothing can be shifted")
    isotherms = []
    for sample_indices in _group_by_temperature(data.temperature):
        kelvin = median(data.temperature[sample_indices])
        if len(sample_indices) < MIN_VALUES:
            raise FitError(
                f"there is one value at {celsius(kelvin)}; a shift needs at least "
                f"{MIN_VALUES} frequencies or times at each temperature: leave it out"
            )
        if isinstance(data, DynamicTest):
            part = data.only(
                sample_indices[np.argsort(data.frequency[sample_indices], kind="stable")]
            )
            magnitude = np.abs(part.value)
            _require_positive(part.storage, kelvin)
            both_parts = np.concatenate((magnitude, magnitude))
            value = np.concatenate((part.storage, part.loss)) / both_parts
            isotherms.append(Isotherm(kelvin, "frequency", part.omega, value, both_parts))
        else:
            sorted_indices = sample_indices[np.argsort(data.time[sample_indices], kind="stable")]
            name = _COLUMNS[type(data)][1]
            time, values = data.time[sorted_indices], getattr(data, name)[sorted_indices]
            _require_positive(values, kelvin, name)
            _require_positive(time, kelvin, "time")
            domain: Domain = "time" if isinstance(data, RelaxationModulus) else "creep"
            isotherms.append(Isotherm(kelvin, domain, time, np.ones(len(sample_indices)), values))
    return tuple(isotherms)


def _require_positive(values: FloatArray, kelvin: float, quantity_name: str = "modulus") -> None:
    if (values <= 0).any():
        raise FitError(
            f"a {quantity_name} at {celsius(kelvin)} is {values.min():g}; expected > 0, so that "
            "errors can be relative and times be shifted: leave it out"
        )


def _group_by_temperature(temperature: FloatArray) -> list[IndexArray]:
    """Return indices of the samples of each isotherm, by rising temperature."""
    groups: list[list[int]] = []
    for i in np.argsort(temperature, kind="stable"):
        t = temperature[i]
        is_same_group = groups and (
            t - temperature[groups[-1][-1]] <= ONE_TEMPERATURE / 2
            and t - temperature[groups[-1][0]] <= ONE_TEMPERATURE
        )
        if is_same_group:
            groups[-1].append(int(i))
        else:
            groups.append([int(i)])
    return [np.sort(np.array(group)) for group in groups]
