"""Transfer stiffness of a mount: lines, third octaves, limits, and their valid range."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, TypeAlias

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import (
    BoolArray,
    ComplexArray,
    EqualByValue,
    FloatArray,
    make_readonly_copy,
    validate_complex_samples,
    validate_samples,
)
from dashpot.base.checks import Check, HasChecks
from dashpot.base.provenance import Source, Step
from dashpot.base.reported_values import ReportedValue
from dashpot.base.result_mixins import HasVerdict, Series
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import convert_to_unit
from dashpot.base.version import byline

Method: TypeAlias = Literal["direct", "indirect", "predicted"]


def compute_level(stiffness: FloatArray) -> FloatArray:
    r"""Return the level :math:`20\lg(|k|/1\,\mathrm{N/m})`, dB."""
    return np.asarray(20 * np.log10(stiffness))


@dataclass(frozen=True)
class BandStiffness(Serialisable):
    """Transfer stiffness of one third octave.

    Attributes
    ----------
    centre : float
        Nominal, Hz.
    lines : int
    stiffness : float
        Root of the mean of :math:`|k|^2` over the lines, N/m.
    limits : (float, float)
        95 %, N/m.
    loss_factor : float
    loss_factor_limits : (float, float)
        95 %.
    level_difference : float or None
        The least of input over output, dB.
    indirect : float or None
        Mean by the standard's formula of the indirect method, N/m; None without a blocking mass.
    valid : bool
        Valid by ISO 10846: it has enough lines, and where it was measured the output is blocked
        at each.
    in_fit_band : bool or None
        Whether it lies in the valid band of the fit that predicts it; None of a measurement.
    """

    _keys = (
        Key("centre_hz", "centre"),
        "lines",
        "stiffness",
        "limits",
        Key("level_db", "level"),
        Key("level_limits_db", "level_limits"),
        "loss_factor",
        "loss_factor_limits",
        Key("level_difference_db", "level_difference"),
        "indirect",
        Key("indirect_level_db", "indirect_level"),
        "valid",
        Key("in_fit_band", optional=True),
    )

    centre: float
    lines: int
    stiffness: float
    limits: tuple[float, float]
    loss_factor: float
    loss_factor_limits: tuple[float, float]
    level_difference: float | None
    indirect: float | None
    valid: bool
    in_fit_band: bool | None = None

    @property
    def level(self) -> float:
        """Level, dB re 1 N/m."""
        return float(compute_level(np.array(self.stiffness)))

    @property
    def level_limits(self) -> tuple[float, float]:
        """95 %, dB re 1 N/m."""
        low, high = compute_level(np.array(self.limits)).tolist()
        return low, high

    @property
    def indirect_level(self) -> float | None:
        """Level by the formula of the indirect method, dB."""
        return None if self.indirect is None else float(compute_level(np.array(self.indirect)))

    @property
    def half_width(self) -> float:
        """The wider half of the interval of its level, dB."""
        low, high = self.level_limits
        return max(self.level - low, high - self.level)


@dataclass(frozen=True, eq=False, repr=False)
class TransferStiffness(EqualByValue, HasChecks, HasVerdict, Serialisable):
    r"""Dynamic transfer stiffness of a mount: blocked output force over input displacement.

    Attributes
    ----------
    method : {"direct", "indirect", "predicted"}
    exact : bool
        The formula takes the motion of the output into account.
    frequency : array, shape (n,)
        Hz.
    value : complex array, shape (n,)
        k, N/m.
    limits, loss_factor_limits : array, shape (2, n)
        95 % of :math:`|k|`, N/m, and of the loss factor.
    transmissibility : complex array, shape (n,), or None
        Output over input; None where it is not known.
    blocked : bool array, shape (n,)
        The output is blocked; True where its motion is not known.
    indirect : complex array, shape (n,), or None
        What the standard's formula of the indirect method gives, N/m.
    bands : tuple of BandStiffness
    mass, flange_mass : float or None
        Blocking mass, and output flange, kg.
    rigid_to : float or None
        Up to which frequency mass or foundation are rigid, as stated, Hz.
    preload : float or None
        Static, as stated, N.
    temperature : float or None
        K.
    seals : float
        Parts in parallel that were predicted as one mount; 1 of a measured one.
    checks, source, steps
        As in a fit.
    """

    schema = "dashpot/transfer-stiffness@1"
    _keys = (
        "method",
        "exact",
        Key("third_octaves", "bands"),
        Key("frequency_hz", "frequency"),
        "value",
        "limits",
        "loss_factor",
        "loss_factor_limits",
        Key("level_db", "level"),
        "transmissibility",
        "indirect",
        "blocked",
        Key("valid_from_hz", "valid_from"),
        "mass",
        "flange_mass",
        Key("rigid_to_hz", "rigid_to"),
        "preload",
        "temperature",
        "seals",
        "verdict",
        "checks",
        "source",
        "steps",
    )

    method: Method
    exact: bool
    frequency: FloatArray
    value: ComplexArray
    limits: FloatArray
    loss_factor_limits: FloatArray
    transmissibility: ComplexArray | None
    blocked: BoolArray
    indirect: ComplexArray | None
    bands: tuple[BandStiffness, ...]
    mass: float | None = None
    flange_mass: float | None = None
    rigid_to: float | None = None
    preload: float | None = None
    temperature: float | None = None
    seals: float = 1.0
    checks: tuple[Check, ...] = ()
    source: tuple[Source, ...] = ()
    steps: tuple[Step, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "frequency", validate_samples("frequency", self.frequency))
        for name in ("value", "transmissibility", "indirect"):
            values = getattr(self, name)
            if values is not None:
                object.__setattr__(self, name, validate_complex_samples(name, values))
        for name in ("limits", "loss_factor_limits"):
            object.__setattr__(
                self, name, make_readonly_copy(np.asarray(getattr(self, name), dtype=float))
            )
        object.__setattr__(
            self, "blocked", make_readonly_copy(np.asarray(self.blocked, dtype=bool))
        )

    @property
    def interval_note(self) -> str:
        """Note on errors outside the valid band that the intervals do not include; else ""."""
        if not any(
            check.failed and check.name == "third_octaves_in_valid_band" for check in self.checks
        ):
            return ""
        return "Outside the valid band of the fit the intervals contain standard errors alone."

    @property
    def level(self) -> FloatArray:
        r""":math:`20\lg(|k|/1\,\mathrm{N/m})` of each line, dB."""
        return compute_level(np.abs(self.value))

    @property
    def loss_factor(self) -> FloatArray:
        """Loss factor of each line."""
        return np.asarray(self.value.imag / self.value.real)

    @property
    def level_difference(self) -> FloatArray | None:
        r"""Input over output of each line, :math:`-20\lg|T|`, dB."""
        return (
            None if self.transmissibility is None else -compute_level(np.abs(self.transmissibility))
        )

    @property
    def valid_from(self) -> float | None:
        """The frequency from which on the output is blocked at every line, Hz; None if nowhere."""
        moving = np.flatnonzero(~self.blocked)
        first = int(moving[-1]) + 1 if len(moving) else 0
        return float(self.frequency[first]) if first < len(self.frequency) else None

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """The stiffness of every third octave."""
        return tuple(
            ReportedValue(f"|k| at {band.centre:g} Hz", band.stiffness, *band.limits, unit="N/m")
            for band in self.bands
        )

    @property
    def _table_columns(self) -> Series:
        """The third octaves."""
        bands = self.bands
        return {
            "centre": ([band.centre for band in bands], "Hz"),
            "lines": ([band.lines for band in bands], ""),
            "stiffness": ([band.stiffness for band in bands], "N/m"),
            "stiffness_low": ([band.limits[0] for band in bands], "N/m"),
            "stiffness_high": ([band.limits[1] for band in bands], "N/m"),
            "level": ([band.level for band in bands], "dB"),
            "level_low": ([band.level_limits[0] for band in bands], "dB"),
            "level_high": ([band.level_limits[1] for band in bands], "dB"),
            "loss_factor": ([band.loss_factor for band in bands], ""),
            "loss_factor_low": ([band.loss_factor_limits[0] for band in bands], ""),
            "loss_factor_high": ([band.loss_factor_limits[1] for band in bands], ""),
            "level_difference": ([_replace_none(band.level_difference) for band in bands], "dB"),
            **self._make_validity_column([1] * len(bands)),
        }

    @property
    def _line_columns(self) -> Series:
        """The lines."""
        difference = self.level_difference
        gap = np.full(len(self.frequency), np.nan) if difference is None else difference
        return {
            "frequency": (self.frequency, "Hz"),
            "storage": (self.value.real, "N/m"),
            "loss": (self.value.imag, "N/m"),
            "stiffness": (np.abs(self.value), "N/m"),
            "stiffness_low": (self.limits[0], "N/m"),
            "stiffness_high": (self.limits[1], "N/m"),
            "level": (self.level, "dB"),
            "loss_factor": (self.loss_factor, ""),
            "loss_factor_low": (self.loss_factor_limits[0], ""),
            "loss_factor_high": (self.loss_factor_limits[1], ""),
            "level_difference": (gap, "dB"),
            "blocked": (self.blocked, ""),
            **(
                self._make_validity_column([band.lines for band in self.bands])
                if self.method == "predicted"
                else {}
            ),
        }

    def _make_validity_column(self, repeats: Sequence[int]) -> Series:
        """Return whether each band, repeated, is valid: by its fit, or by ISO 10846."""
        is_predicted = self.method == "predicted"
        valid = [bool(band.in_fit_band if is_predicted else band.valid) for band in self.bands]
        name = "in_valid_band_of_fit" if is_predicted else "valid_iso_10846"
        return {name: (np.repeat(valid, repeats), "")}

    def csv(self, *, lines: bool = False) -> str:
        """Return a heading and the table of third octaves, or of lines."""
        notes = [
            byline("transfer stiffness of " + ", ".join(source.file for source in self.source))
        ]
        if any(source.simulated for source in self.source):
            notes.append("SIMULATED: the test behind this table was simulated")
        columns = self._line_columns if lines else self._table_columns
        header = ",".join(
            f"{name} [{unit}]" if unit else name for name, (_, unit) in columns.items()
        )
        rows = zip(*(values for values, _ in columns.values()), strict=True)
        comment_lines = (f"# {note}" for note in notes)
        return (
            "\n".join((*comment_lines, header, *(",".join(map(_format_cell, row)) for row in rows)))
            + "\n"
        )

    @property
    def _headline(self) -> str:
        """The stiffness of the first and of the last third octave that is valid."""
        valid = [band for band in self.bands if band.valid] or list(self.bands)
        end_texts = [
            f"{convert_to_unit(band.stiffness, 'N/mm'):.4g} N/mm ({band.level:.2f} dB) at "
            f"{band.centre:g} Hz"
            for band in (valid[0], valid[-1])
        ]
        return "the transfer stiffness is " + " to ".join(dict.fromkeys(end_texts))


def _replace_none(value: float | None) -> float:
    return np.nan if value is None else value


def _format_cell(value: float | bool | np.bool_) -> str:
    """Return a cell of a table: a truth value as 0 or 1, nan as an empty cell."""
    if isinstance(value, bool | np.bool_):
        return str(int(value))
    return "" if np.isnan(value) else f"{value:.10g}"
