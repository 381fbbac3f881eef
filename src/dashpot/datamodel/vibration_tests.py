"""Vibration tests as recorded: hammer hits, and a mass on a shaken base."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import (
    EqualByValue,
    FloatArray,
    compute_run_numbers,
    convert_arrays_to_si,
    make_readonly_copy,
    make_units_field,
    require_same_length,
    slices,
    validate_measured,
    validate_measured_fields,
)
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source, describe_record_source
from dashpot.base.result_mixins import HasSummary, Series, collect_arrays, load_function
from dashpot.base.serialisation import Serialisable
from dashpot.base.value_ranges import require_positive

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dashpot.base.units import Quantity, Range
    from dashpot.datamodel.frf import FRF


# Base excitation.


@dataclass(frozen=True, eq=False, repr=False)
class ShakenTest(EqualByValue, HasSummary):
    """Motions of a base and of the mass on its mounts, sampled together.

    Attributes
    ----------
    rate : float
        Samples a second, Hz.
    base, mass : array, shape (n,)
        The base's acceleration, m/s^2, and the mass's motion in the same direction.
    order : int
        How often the displacement was differentiated in `mass`: 2 if it is an acceleration, m/s^2,
        1 a velocity, 0 a displacement.
    relative : bool
        Whether the mass was measured relative to the base.
    starts : tuple of int
        First sample of each continuous record.
    source : tuple of Source
    """

    rate: float
    base: FloatArray
    mass: FloatArray
    starts: tuple[int, ...] = (0,)
    source: tuple[Source, ...] = ()
    order: int = 2
    relative: bool = False

    def __post_init__(self) -> None:
        require_positive(rate=self.rate, unit=" Hz", expected="a sampling rate > 0")
        validate_measured_fields(self, "base", "mass", minimum=8)
        if self.order not in (0, 1, 2):
            raise DataError(f"order = {self.order!r}; expected 0, 1 or 2")

    @property
    def _table_columns(self) -> Series:
        """The motions of base and mass over time, and the number of the record."""
        time = np.arange(len(self.base)) / self.rate
        return {
            "time": (time, "s"), "record": (compute_run_numbers(self.starts, len(time)), ""),
            **collect_arrays(self, base="m/s^2", mass=("m", "m/s", "m/s^2")[self.order]),
        }  # fmt: skip

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary: the record, and the amplitude of the base."""
        source = self.source[0] if len(self.source) == 1 else None
        return (
            describe_record_source(source, len(self.base)),
            f"base and mass at {self.rate:.6g} Hz, the base at {self.base.std():.4g} m/s^2 rms",
        )

    def records(self) -> tuple[slice, ...]:
        """Return the continuous records, as slices of the samples."""
        return slices(self.starts, len(self.base))


# Hammer tests.


@dataclass(frozen=True, eq=False, repr=False)
class ImpactTest(EqualByValue, HasSummary, Serialisable):
    """Hammer force and one or more accelerations, sampled together, in SI units.

    Attributes
    ----------
    time : array, shape (n,)
        s; evenly spaced within each continuous record.
    force : array, shape (n,)
        Hammer force, N, sign as recorded.
    acceleration : array, shape (channels, n)
        m/s^2.
    starts : tuple of int
        First sample of each continuous record, ``(0,)`` for a single one; time may restart there.
    channels : tuple of str
        Name of each acceleration channel.
    positions : tuple of float or None
        Signed distance of each accelerometer from the hammer's line of action, m.
    source : tuple of Source
        One per file read.
    window_rate : float or None
        Decay a of an exponential window :math:`e^{-at}` that the records were multiplied by, 1/s; 0
        without a window, nan if its decay is not stated, None if unknown.
    units : str
        Units of the arrays, in their order: ``"s, mm, N"``, or ``"SI"``. Stored in SI.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> t = np.linspace(0, 10, 50)
    >>> hits = dp.ImpactTest(time=t, force=t, acceleration=[t], units="s, N, g")
    >>> round(float(hits.acceleration[0, -1]), 4)
    98.0665
    """

    schema = "dashpot/impact-test@1"

    time: FloatArray
    force: FloatArray
    acceleration: FloatArray
    starts: tuple[int, ...] = (0,)
    channels: tuple[str, ...] = ()
    positions: tuple[float, ...] | None = None
    source: tuple[Source, ...] = ()
    window_rate: float | None = None
    units: str = make_units_field()

    def __post_init__(self) -> None:
        convert_arrays_to_si(self, time="time", force="force", acceleration="acceleration")
        time = validate_measured("time", self.time, minimum=8)
        force = validate_measured("force", self.force, minimum=8)
        acceleration = np.atleast_2d(np.asarray(self.acceleration, dtype=float))
        names = self.channels or tuple(f"acceleration {i + 1}" for i in range(len(acceleration)))
        if len(names) != len(acceleration):
            raise DataError(f"{len(names)} channel names for {len(acceleration)} accelerations")
        for name, row in zip(names, acceleration, strict=True):
            require_same_length(
                time=time, force=force, **{f"channel {name}": validate_measured(name, row)}
            )
        if self.positions is not None and len(self.positions) != len(acceleration):
            raise DataError(
                f"{len(self.positions)} positions for {len(acceleration)} accelerometers"
            )
        if self.window_rate is not None and self.window_rate < 0:
            raise DataError(f"window_rate = {self.window_rate!r} 1/s; expected a decay >= 0")
        starts = tuple(self.starts)
        if starts[:1] != (0,) or any(b <= a for a, b in itertools.pairwise(starts)):
            raise DataError(f"record starts must rise from 0, found {starts}")
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "force", force)
        object.__setattr__(self, "acceleration", make_readonly_copy(acceleration))
        object.__setattr__(self, "channels", tuple(names))
        object.__setattr__(self, "starts", starts)
        first, *other_records = self.records()
        _require_uniform_time(time[first])
        for record in other_records:
            _require_uniform_time(time[record])
            rate, samples = _rate(time[record]), len(time[record])
            if not same_rate(self.rate, rate, min(samples, len(time[first]))):
                raise DataError(
                    f"the record that begins at sample {record.start} is sampled at {rate:.6g} Hz, "
                    f"the first at {self.rate:.6g} Hz; expected one rate: give their hits apart"
                )

    @property
    def _table_columns(self) -> Series:
        """Force and accelerations over time, and the number of the record."""
        pairs = zip(self.channels, self.acceleration, strict=True)
        return {
            "time": (self.time, "s"),
            "record": (compute_run_numbers(self.starts, len(self.time)), ""),
            "force": (self.force, "N"),
            **{name: (row, "m/s^2") for name, row in pairs},
        }

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary: the records and their channels."""
        single_source = self.source[0] if len(self.source) == 1 else None
        files = ", ".join(source.file for source in self.source)
        return (
            describe_record_source(single_source, len(self.time))
            + (f" of {files}" if single_source is None and files else ""),
            (
                f"{len(self.starts)} record{'s' * (len(self.starts) != 1)} at {self.rate:.6g} Hz, "
                f"hammer to {np.abs(self.force).max():.4g} N, {', '.join(self.channels)}"
            ),
        )

    def frf(
        self,
        *,
        estimator: str = "H1",
        window: str = "none",
        accept: Sequence[str] = (),
        reject: Sequence[str] = (),
        record: Quantity | None = None,
        pretrigger: Quantity | None = None,
        combine: str = "mean",
        mass: Quantity | None = None,
        polarity: Sequence[int] | None = None,
        band: Range | None = None,
        resonance_band: Range | None = None,
    ) -> FRF:
        """Return the FRF of the hits.

        As :func:`~dashpot.vibration.impact.frf_estimation.estimate_frf` computes it.
        """
        frf: FRF = load_function("vibration.impact.frf_estimation", "estimate_frf")(
            self, estimator=estimator, window=window, accept=accept, reject=reject, record=record,
            pretrigger=pretrigger, combine=combine, mass=mass, polarity=polarity, band=band,
            resonance_band=resonance_band,
        )  # fmt: skip
        return frf

    def records(self) -> tuple[slice, ...]:
        """Return the continuous records, as slices of the samples."""
        return slices(self.starts, len(self.time))

    @property
    def rate(self) -> float:
        """Sampling rate, Hz, from the first record; the others have the same."""
        return _rate(self.time[self.records()[0]])


def same_rate(first_rate: float, other_rate: float, samples: int) -> bool:
    """Whether two sampling rates are one, as far as so many samples show: a thousandth, or more."""
    return abs(other_rate / first_rate - 1) <= max(1e-3, 0.5 / (samples - 1))


def _rate(time: FloatArray) -> float:
    return float((len(time) - 1) / (time[-1] - time[0]))


def _require_uniform_time(time: FloatArray) -> None:
    steps = np.diff(time)
    if steps.size == 0:
        raise DataError(f"the record at t = {time[0]:.9g} s is one sample; leave it out")
    step = float(np.median(steps))
    step_index = int(np.argmax(np.abs(steps - step)))
    # a time column printed with few digits jitters by its last digit
    if step <= 0 or abs(steps[step_index] - step) > 0.2 * step:
        raise DataError(
            f"an impact record needs even sampling, but the step after t = {time[step_index]:.9g} "
            f"s is {steps[step_index]:.6g} s where {step:.6g} s is usual; split the record there"
        )
