"""Sweeps of complex stiffness over frequency, each at one compression and one amplitude."""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import (
    ComplexArray,
    EqualByValue,
    FloatArray,
    validate_complex_samples,
    validate_samples,
)
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source, describe_record_source
from dashpot.base.result_mixins import HasSummary, Series
from dashpot.base.units import Quantity, convert_to_si, convert_to_unit, format_quantity
from dashpot.base.value_ranges import SIZES


@dataclass(frozen=True, eq=False)
class PreloadSweep(EqualByValue):
    r"""Complex stiffness :math:`K^*(f) = K' + jK''` at one compression and one amplitude.

    Attributes
    ----------
    frequency : array, shape (n,)
        Hz, > 0.
    value : complex array, shape (n,)
        N/m, with a storage stiffness > 0.
    compression : float or str
        Static compression, m, > 0.
    amplitude : float, str or None
        Amplitude of the motion, m, > 0; None where it is not known.
    weight : array, shape (n,), or None
        Relative weight of each line, 1 over its relative error; None: equal weights.
    source : Source or None

    Raises
    ------
    DataError
        If the arrays differ in length, or a value is impossible.

    Examples
    --------
    >>> from dashpot.systems import PreloadSweep
    >>> sweep = PreloadSweep([1, 10], [300 + 9j, 310 + 11j], "4mm", "0.1mm")
    >>> sweep.compression, sweep.amplitude
    (0.004, 0.0001)
    """

    frequency: FloatArray
    value: ComplexArray
    compression: Quantity
    amplitude: Quantity | None = None
    weight: FloatArray | None = None
    source: Source | None = None

    def __post_init__(self) -> None:
        frequency = validate_samples("frequency", self.frequency)
        value = validate_complex_samples("value", self.value)
        weight = (
            np.ones(len(frequency))
            if self.weight is None
            else validate_samples("weight", self.weight)
        )
        if not len(frequency) == len(value) == len(weight):
            raise DataError(
                f"{len(frequency)} frequencies, {len(value)} stiffnesses and {len(weight)} "
                "weights; expected as many of each"
            )
        for name, values, unit in (
            ("frequency", frequency, "Hz"), ("storage", value.real, "N/m"), ("weight", weight, ""),
        ):  # fmt: skip
            bad_indices = np.flatnonzero(values <= 0)
            if bad_indices.size:
                where_text = (
                    "" if name == "frequency" else f" at {frequency[bad_indices[0]]:.4g} Hz"
                )
                raise DataError(
                    f"the {name}{where_text} is {values[bad_indices[0]]:g} {unit}".rstrip()
                    + "; expected > 0. Leave such lines out"
                )
        compression = convert_to_si(self.compression, "length")
        amplitude = convert_to_si(self.amplitude, "length")
        if not compression > 0:
            raise DataError(f"compression = {compression:g} m; expected > 0, such as 4mm")
        if amplitude is not None and not amplitude > 0:
            raise DataError(f"amplitude = {amplitude:g} m; expected > 0")
        for size, quantity, text in (
            ("travel", compression, f"compression = {compression:g} m"),
            ("stiffness", float(np.abs(value).max()), f"stiffness = {np.abs(value).max():.3g} N/m"),
        ):
            SIZES[size].refuse(quantity, f"{text}", remedy="Check its unit.")
        if amplitude is not None and amplitude >= compression:
            raise DataError(
                f"the amplitude, {format_quantity(amplitude, 'mm')}, is not below the compression, "
                f"{format_quantity(compression, 'mm')}: the part would lose contact. Check both"
            )
        fields_of_sweep = (frequency, value, compression, amplitude, weight)
        names = ("frequency", "value", "compression", "amplitude", "weight")
        for name, entry in zip(names, fields_of_sweep, strict=True):
            object.__setattr__(self, name, entry)

    @property
    def name(self) -> str:
        """The file, if it has one."""
        return "sweep" if self.source is None else self.source.file


@dataclass(frozen=True, eq=False, repr=False)
class PreloadTable(EqualByValue, HasSummary):
    """Sweeps of complex stiffness at several compressions, of one table.

    Attributes
    ----------
    sweeps : tuple of PreloadSweep
    source : Source or None
    """

    sweeps: tuple[PreloadSweep, ...]
    source: Source | None = None

    @property
    def _table_columns(self) -> Series:
        """Every line."""
        sweeps = self.sweeps
        lengths = [len(sweep.frequency) for sweep in sweeps]
        amplitudes = [
            np.nan if sweep.amplitude is None else float(sweep.amplitude) for sweep in sweeps
        ]
        value = np.concatenate([sweep.value for sweep in sweeps])
        return {
            "compression": (np.repeat([float(s.compression) for s in sweeps], lengths), "m"),
            "amplitude": (np.repeat(amplitudes, lengths), "m"),
            "frequency": (np.concatenate([sweep.frequency for sweep in sweeps]), "Hz"),
            "storage": (value.real, "N/m"),
            "loss": (value.imag, "N/m"),
        }

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary: the sweeps."""
        compressions = sorted({float(sweep.compression) for sweep in self.sweeps})
        compressions_text = ", ".join(f"{convert_to_unit(c, 'mm'):.4g}" for c in compressions)
        lines = sum(len(sweep.frequency) for sweep in self.sweeps)
        return (
            describe_record_source(self.source, lines),
            (
                f"{len(self.sweeps)} sweeps of complex stiffness at compressions of "
                f"{compressions_text} mm"
            ),
        )
