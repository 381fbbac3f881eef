"""Storage stiffness, loss stiffness and loss factor of a fit at frequencies."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source
from dashpot.base.reported_values import ReportedValue
from dashpot.base.result_mixins import HasVerdict, Series
from dashpot.base.serialisation import Serialisable
from dashpot.base.units import Quantity, convert_to_si
from dashpot.base.value_ranges import require_positive
from dashpot.datamodel.fit import Fit
from dashpot.extensions.dynamic_stiffness import checks
from dashpot.fitting.prediction_bounds import parameter_band, unresolved_arm_band

if TYPE_CHECKING:
    from dashpot.datamodel.machine import Machine
    from dashpot.reading.read_options import ReadOptions


@dataclass(frozen=True, eq=False, repr=False)
class StiffnessPrediction(HasVerdict, Serialisable):
    r"""Complex stiffness :math:`K^* = K' + iK''` of a fit at frequencies.

    Attributes
    ----------
    fit : Fit
        At the requested temperature, for all seals.
    frequencies : tuple of float
        Hz.
    values : tuple of ReportedValue
        Values: at each frequency storage and loss, N/m of a seal or Pa of a material, and loss
        factor.
    checks : tuple of Check
    """

    schema = "dashpot/dynamic-stiffness@1"
    _keys = ("verdict", "frequencies", "values", "checks")
    _is_loadable = False

    fit: Fit
    frequencies: tuple[float, ...]
    values: tuple[ReportedValue, ...]
    checks: tuple[Check, ...]

    @property
    def _table_columns(self) -> Series:
        """Every number and its limits over the frequencies."""
        columns: dict[str, Any] = {"frequency": (np.array(self.frequencies), "Hz")}
        for index, name in enumerate(("storage", "loss", "loss_factor")):
            values = self.values[index::3]
            columns |= {
                f"{name}{end}": (
                    np.array([getattr(value, attribute) for value in values]),
                    values[0].unit,
                )
                for end, attribute in (("", "value"), ("_low", "low"), ("_high", "high"))
            }
        return columns

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """The predicted numbers."""
        return self.values

    @property
    def sources(self) -> tuple[Source, ...]:
        """The files behind the fit."""
        return self.fit.source

    @property
    def verdict(self) -> Verdict:
        """Verdict, with the stiffness and the loss factor at the first frequency."""
        storage, _, loss_factor = (value.cells for value in self.values[:3])
        word = "modulus" if self.fit.unit == "Pa" else "stiffness"
        return verdict(
            self.checks,
            headline=f"at {self.frequencies[0]:.4g} Hz the storage {word} is {storage.value} "
            f"{storage.unit}, the loss factor {loss_factor.value}",
        )


def predict_stiffness(
    fit: Fit,
    *,
    frequency: Quantity | Sequence[Quantity],
    seals: float = 1.0,
    temperature: Quantity | None = None,
    records: Sequence[str | Path] = (),
    machine: Machine | None = None,
    options: ReadOptions | None = None,
) -> StiffnessPrediction:
    r"""Return storage, loss and loss factor of a fit at frequencies, without a mass.

    .. math:: K^*(\omega) = K' + iK'', \quad \eta = K''/K'

    In the valid band the limits are those of the fit's standard errors, and at least as wide as
    those of all spectra that its test does not reject. Beyond it there are no limits, unless the
    records are given.

    Parameters
    ----------
    fit : Fit
    frequency : float or str, or sequence of them
        Hz, or ``"12.71Hz"``.
    seals : float
        Number of seals in parallel.
    temperature : float or str, optional
        K, or ``"23degC"``; by default that of the fit.
    records : sequence of path
        The relaxation tests of the fit; they bound the stiffness above the valid band.
    machine : Machine, optional
        On which they were made.
    options : ReadOptions, optional
        How their files are read.

    Raises
    ------
    DataError
        If a number is not > 0, or a record is not one of the fitted ones.
    """
    requested_frequencies = (
        [frequency] if isinstance(frequency, str | float | int) else list(frequency)
    )
    hertz = tuple(convert_to_si(item, "frequency") for item in requested_frequencies)
    for value in hertz:
        require_positive(frequency=value, unit=" Hz")
    require_positive(seals=seals)
    if fit.unit == "Pa" and seals != 1:
        raise DataError(
            "a modulus is of the material, however many seals there are: leave out --seals "
            "(Python: seals)"
        )
    limits = None
    if records:
        from dashpot.workflow.bench_tests import prepared_files  # imports every kind of fit

        tests = prepared_files(records, machine=machine, options=options)
        unique = np.unique(hertz)
        bounds = unresolved_arm_band(fit, tests, unique)
        indices = np.searchsorted(unique, hertz)
        limits = [
            seals * bounds.storage[:, indices], seals * bounds.loss[:, indices],
            bounds.loss_factor[:, indices],
        ]  # fmt: skip
    fit_here = fit if temperature is None else fit.at_temperature(temperature)
    fit_here = fit_here if seals == 1 else fit_here.in_parallel(seals)
    values = tuple(
        value
        for i, f in enumerate(hertz)
        for value in _report_values(
            fit_here, f, None if limits is None else [limit[:, i] for limit in limits]
        )
    )
    errors = [_compute_relative_error(value) for value in values[2::3]]
    largest = max((error for error in errors if error is not None), default=None)
    has_hammer = fit.method in ("joint", "frf")
    own_checks = [checks.loss_factor_determined_at(largest, with_hammer=has_hammer)]
    if not records:
        own_checks.insert(0, checks.frequencies_in_valid_band(hertz, fit_here.band))
    return StiffnessPrediction(fit_here, hertz, values, (*own_checks, *fit.checks))


def _report_values(
    fit: Fit, frequency: float, limits: Sequence[FloatArray] | None
) -> tuple[ReportedValue, ...]:
    """Return storage, loss and loss factor at a frequency, Hz."""
    K = complex(fit.solid.complex_stiffness(omega=2 * math.pi * frequency))
    numbers = K.real, K.imag, K.imag / K.real
    if limits is None:
        limits = _compute_limits_in_band(fit, frequency, numbers)
    frequency_text, symbol = f"{frequency:.5g} Hz", "E" if fit.unit == "Pa" else "K"
    names = (
        ("storage", f"{symbol}' at {frequency_text}", fit.unit),
        ("loss", f"{symbol}'' at {frequency_text}", fit.unit),
        ("loss_factor", f"loss factor at {frequency_text}", "1"),
    )
    return tuple(
        ReportedValue(name, value, float(low), float(high), unit, words=words)
        for (name, words, unit), value, (low, high) in zip(names, numbers, limits, strict=True)
    )


def _compute_limits_in_band(
    fit: Fit, frequency: float, values: Sequence[float]
) -> list[FloatArray]:
    """Return the limits of storage, loss and loss factor; nan outside the valid band.

    They contain the limits by the covariance and, as factors, by the band errors of size and loss
    factor.
    """
    low, high = fit.band
    error = fit.evidence.band_error
    if not (high > 0 and low <= frequency <= high) or error is None:
        return [np.array([math.nan, math.nan])] * 3
    log_frequency = np.log(error.frequency)
    size, factor = (
        max(float(np.interp(math.log(frequency), log_frequency, errors)), min_error)
        for errors, min_error in zip(
            (error.stiffness, error.loss_factor), error.misfit, strict=True
        )
    )
    formal = parameter_band(fit, [frequency])
    relative = (size, (1 + size) * (1 + factor) - 1, factor)
    return [
        np.array([min(value / (1 + relative_error), low), max(value * (1 + relative_error), high)])
        for value, relative_error, (low, high) in zip(
            values, relative, (formal.storage[:, 0], formal.loss[:, 0], formal.loss_factor[:, 0]),
            strict=True,
        )
    ]  # fmt: skip


def _compute_relative_error(value: ReportedValue) -> float | None:
    """Return the larger relative distance of a value to its limits; None if unknown."""
    if math.isnan(value.low) and math.isnan(value.high):
        return None
    if not (value.low > 0 and math.isfinite(value.high)):
        return math.inf
    return max(value.high / value.value - 1, 1 - value.low / value.value)
