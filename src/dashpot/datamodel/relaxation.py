"""Relaxation tests, as recorded and prepared, and the trajectory of the plate."""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise

import numpy as np

from dashpot.base import dataclass, field, replace
from dashpot.base.arrays import (
    EqualByValue,
    FloatArray,
    convert_arrays_to_si,
    make_cosine_sequence,
    make_readonly_copy,
    make_units_field,
    median,
    validate_measured_fields,
)
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source, Step, describe_record_source
from dashpot.base.result_mixins import HasSummary, Plottable, Series, collect_arrays, load_function
from dashpot.base.serialisation import EVERY_FIELD, Serialisable
from dashpot.base.units import Quantity, convert_to_si, format_quantity
from dashpot.base.value_ranges import refuse_absurd_record, require_positive
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.specimen import Specimen
from dashpot.numerics.design_matrices.data_compression import uniform_step

# Relaxation tests.


# Relative distance from the depth below which a plate has settled, and share of the ramp time
# allowed for it.
SETTLED_DISTANCE = 0.002
SETTLING_SHARE = 0.2
# largest motion in a hold, relative to the depth, for a fit of the hold alone
MAX_CREEP = 0.01
# samples of a free seal that show the zero of its force
MIN_UNLOADED_SAMPLES = 5


@dataclass(frozen=True, eq=False, repr=False)
class RelaxationTest(EqualByValue, HasSummary, Serialisable):
    """Relaxation test as recorded, in SI units.

    Attributes
    ----------
    time : array, shape (n,)
        s, strictly increasing; any sampling.
    displacement : array, shape (n,)
        m, sign and zero as recorded.
    force : array, shape (n,)
        N, sign and zero as recorded.
    specimen : Specimen
    source : Source or None
        The file it came from; None for arrays made in memory.
    units : str
        Units of the arrays, in their order: ``"s, mm, N"``, or ``"SI"``. Stored in SI.

    Raises
    ------
    DataError
        If the arrays differ in length, hold fewer than 8 samples, are not finite, or time stalls.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> t = np.linspace(0, 10, 50)
    >>> test = dp.RelaxationTest(time=t, displacement=8 + 0 * t, force=t, units="s, mm, N")
    >>> float(test.displacement[0])
    0.008
    """

    schema = "dashpot/relaxation-test@1"

    time: FloatArray
    displacement: FloatArray
    force: FloatArray
    specimen: Specimen = field(default_factory=Specimen)
    source: Source | None = None
    units: str = make_units_field()

    def __post_init__(self) -> None:
        convert_arrays_to_si(self, time="time", displacement="length", force="force")
        validate_measured_fields(self, "time", "displacement", "force", minimum=8)
        refuse_absurd_record(self)

    def prepare(
        self,
        *,
        onset: Quantity | None = None,
        ramp_end: Quantity | None = None,
        hold_end: Quantity | None = None,
        contact: Quantity | None = None,
        cycle: int | None = None,
        sign: int | None = None,
        filter: str | None = None,
        drift: float | str | None = None,
        force_range: Quantity | None = None,
        machine: Machine | None = None,
    ) -> RampHold:
        """Cut, tare and judge the test, as :func:`~dashpot.preprocessing.prepare.prepare` does.

        A fit does so by itself; the arguments replace the detected values.
        """
        ramp_hold: RampHold = load_function("preprocessing.prepare", "prepare")(
            self, onset=onset, ramp_end=ramp_end, hold_end=hold_end, contact=contact, cycle=cycle,
            sign=sign, filter=filter, drift=drift, force_range=force_range, machine=machine,
        )  # fmt: skip
        return ramp_hold

    @property
    def _table_columns(self) -> Series:
        """Displacement and force over time."""
        return collect_arrays(self, time="s", displacement="m", force="N")

    @cached_property
    def displacement_quantum(self) -> float:
        """The step of the displacement's readings, m; 0 if none shows."""
        return find_quantum(self.displacement)

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary: the record and its range."""
        return (
            describe_record_source(self.source, len(self.time)),
            (
                f"{np.ptp(self.time):.5g} s; displacement spans "
                f"{format_quantity(np.ptp(self.displacement), 'mm')}, force "
                f"{np.ptp(self.force):.4g} N"
            ),
        )


@dataclass(frozen=True)
class Hum:
    """Line of one frequency that was removed from the force.

    Attributes
    ----------
    frequency : float
        Hz.
    cosine, sine : float
        N, with the phase counted from `origin`.
    origin : float
        s, on the clock of the record.
    """

    frequency: float
    cosine: float
    sine: float
    origin: float

    @property
    def amplitude(self) -> float:
        """N."""
        return float(np.hypot(self.cosine, self.sine))

    def force(self, time: FloatArray) -> FloatArray:
        """Return the line at times, s."""
        omega, step = 2 * np.pi * self.frequency, uniform_step(time)
        complex_amplitude = complex(self.cosine, -self.sine)
        if step is not None:
            at_first = np.exp(1j * omega * (time[0] - self.origin))
            return make_cosine_sequence(len(time), omega * step, complex_amplitude * at_first)
        return np.asarray((complex_amplitude * np.exp(1j * omega * (time - self.origin))).real)


@dataclass(frozen=True, eq=False, repr=False)
class RampHold(EqualByValue, Plottable, Serialisable):
    """Prepared relaxation test: its ramp and hold, compression positive, tared.

    Made by :func:`dashpot.preprocessing.prepare.prepare`; the input of every fit.

    Attributes
    ----------
    time : array, shape (n,)
        s, on the clock of the raw record.
    displacement : array, shape (n,)
        Compression of the seal from first contact, m, the input of the fit. The machine's own give
        is off it. Zero before contact; positive is compression.
    force : array, shape (n,)
        Compressive force less the tare and the lines of `hum`, N; positive is compression. Not
        filtered by default.
    onset, ramp_end, hold_end : float
        First contact, end of the ramp and end of the hold, s on the same clock. With several
        ramps, the first ramp and the last hold.
    depth : float
        Compression held, m: the mean displacement over the hold.
    preload : float
        Force, N, carried at the first sample if the record starts in contact; else 0.
    force_noise, displacement_noise : float
        Standard deviation of the sample-to-sample scatter of each channel, N and m.
    contact_error : float
        Standard error of the zero of the displacement, m, where first contact had to be found
        behind an air gap; else 0.
    specimen, source
        As in the raw test.
    steps : tuple of Step
        Steps of preparation, in order.
    checks : tuple of Check
        Checks of preparation.
    unfiltered : RampHold or None
        The same record before the filter that was requested; None if none was.
    machine : Machine
        Known properties of the machine.
    hum : tuple of Hum
        Lines found in the force and taken off it.
    machine_deflection : array, shape (n,), or None
        Deflection of the machine, m, subtracted from `displacement`; None if nothing was
        subtracted.
    gap : float
        Air that the plate crossed before first contact, m; 0 if none shows.
    loading_start : float or None
        Where the stand before the loading that is fitted begins, s, in a record with earlier ones:
        all before it is followed, and not fitted. None if there is no earlier loading.
    plate : array, shape (n,), or None
        Compression by the plate, m, negative where it is away from first contact, in a record in
        which it left a seal that had not recovered: `displacement` is then that of the face of the
        seal. None if they are the same.

    Examples
    --------
    >>> import dashpot as dp
    >>> ready = dp.simulate("relaxation", hold="5s", noise_free=True).prepare()
    >>> round(ready.ramp_time, 2)
    1.0
    """

    schema = "dashpot/ramp-hold@2"
    _keys = (EVERY_FIELD, "machine_deflection")

    time: FloatArray
    displacement: FloatArray
    force: FloatArray
    onset: float
    ramp_end: float
    hold_end: float
    depth: float
    preload: float = 0.0
    force_noise: float = 0.0
    displacement_noise: float = 0.0
    contact_error: float = 0.0
    specimen: Specimen = field(default_factory=Specimen)
    source: Source | None = None
    steps: tuple[Step, ...] = ()
    checks: tuple[Check, ...] = ()
    unfiltered: RampHold | None = None
    machine: Machine = field(default_factory=Machine)
    hum: tuple[Hum, ...] = ()
    machine_deflection: FloatArray | None = None
    gap: float = 0.0
    loading_start: float | None = None
    plate: FloatArray | None = None

    def __post_init__(self) -> None:
        validate_measured_fields(
            self, "time", "displacement", "force", "machine_deflection", "plate", minimum=8
        )
        if not self.onset < self.ramp_end < self.hold_end:
            raise DataError(
                f"the ramp must start, end and be held in that order, found onset "
                f"{self.onset:g} s, ramp end {self.ramp_end:g} s, hold end {self.hold_end:g} s"
            )
        require_positive(depth=self.depth, unit=" m", expected="a compression > 0")

    @property
    def _table_columns(self) -> Series:
        """Displacement and force over time."""
        return collect_arrays(self, time="s", displacement="m", force="N")

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary: the record, its ramp and hold, and notes of the preparation."""
        failed = (f"  {check.name}: {check.message}" for check in self.checks if check.failed)
        return (
            describe_record_source(self.source, len(self.time)),
            (
                f"ramp of {format_quantity(self.depth, 'mm')} in {self.ramp_time:.4g} s from "
                f"{self.onset:.5g} s, held {self.hold_time:.5g} s"
            ),
            (
                f"noise {format_quantity(self.force_noise, 'mN', '.3g')} and "
                f"{format_quantity(self.displacement_noise, 'um', '.3g')}"
            ),
            *failed,
        )

    @property
    def ramp_time(self) -> float:
        """Duration of the ramp, the paper's c, s."""
        return self.ramp_end - self.onset

    @property
    def hold_time(self) -> float:
        """Duration of the hold, s."""
        return self.hold_end - self.ramp_end

    def with_hold_end(self, hold_end: Quantity) -> RampHold:
        """Return the record with an earlier end of its hold, s or ``"20s"``, with its readings."""
        record = replace(self, hold_end=min(convert_to_si(hold_end, "time"), self.hold_end))
        vars(record)["displacement_quantum"] = self.displacement_quantum
        return record

    @cached_property
    def step(self) -> float:
        """Median sampling interval, s."""
        return median(np.diff(self.time))

    @property
    def travel(self) -> FloatArray:
        """Travel of the plate from first contact, m: the encoder's readings.

        Compression plus the deflection of the machine.
        """
        return (
            self.displacement
            if self.machine_deflection is None
            else self.displacement + self.machine_deflection
        )

    @cached_property
    def displacement_quantum(self) -> float:
        """The step of the displacement's readings, m; 0 if none shows."""
        if self.plate is None:
            return find_quantum(self.travel)
        return find_quantum(
            self.plate if self.machine_deflection is None else self.plate + self.machine_deflection
        )

    @cached_property
    def start(self) -> int:
        """The first sample of the rest before the fitted loading."""
        start = self.loading_start
        return 0 if start is None else int(np.searchsorted(self.time, start))

    @cached_property
    def baseline_samples(self) -> slice:
        """The samples before the ramp, or before the first of all, at which the seal is free.

        Where the plate is away from the seal when the ramp begins, those; else those before the
        first compression.
        """
        if self.loading_start is None:
            return slice(0, int(np.searchsorted(self.time, self.onset)))
        if self.plate is not None:
            stop = int(np.searchsorted(self.time, self.onset))
            loaded_indices = np.flatnonzero(
                self.plate[:stop] >= self.displacement[:stop] - self._contact_clearance
            )
            first_free = int(loaded_indices[-1]) + 1 if loaded_indices.size else 0
            # the last of them feel the face already
            stop = first_free + 9 * (stop - first_free) // 10
            if stop - first_free >= MIN_UNLOADED_SAMPLES:
                return slice(first_free, stop)
        indices = np.flatnonzero(self.displacement != 0)
        return slice(0, int(indices[0]) if indices.size else 0)

    @property
    def _contact_clearance(self) -> float:
        """A plate so far from the face does not touch it, m."""
        return max(
            SETTLED_DISTANCE * self.depth, self.displacement_quantum, 5 * self.displacement_noise
        )

    @cached_property
    def last_loading(self) -> RampHold:
        """The record from the rest before the fitted loading to its end."""
        if self.loading_start is None:
            return self
        span = slice(self.start, None)
        record = replace(
            self,
            time=self.time[span],
            displacement=self.displacement[span],
            force=self.force[span],
            machine_deflection=None
            if self.machine_deflection is None
            else self.machine_deflection[span],
            plate=None if self.plate is None else self.plate[span],
            loading_start=None,
        )
        vars(record)["displacement_quantum"] = self.displacement_quantum
        return record

    @property
    def encoder_step(self) -> float:
        """The step of the displacement's readings, m; 0 if noise hides it.

        Noise beyond half a step dithers it away: readings then average to the truth.
        """
        step = self.displacement_quantum
        return 0.0 if self.displacement_noise > 0.5 * step else step

    @property
    def depth_error(self) -> float:
        r"""Relative standard deviation of the depth by the encoder's step.

        Depth is the difference of two readings, each uniform within one step q: :math:`q/\sqrt6`.
        """
        return self.encoder_step / float(np.sqrt(6.0)) / self.depth

    @cached_property
    def changed_readings(self) -> int:
        """Number of readings in the later half of the hold that differ from the one before."""
        x = self.travel[self.hold]
        return int(np.count_nonzero(np.diff(x[len(x) // 2 :])))

    @cached_property
    def hold_creep(self) -> float:
        """Largest remaining motion in the hold, to its last tenth, as a fraction of the depth.

        Means over twelve stretches, each longer than the one before; the first fifth of a ramp
        time is left to the plate for settling.
        """
        x, t = self.displacement[self.hold], self.time[self.hold] - self.ramp_end
        edges = np.searchsorted(t, np.geomspace(SETTLING_SHARE * self.ramp_time, t[-1], 13))
        final_position = float(x[-max(1, len(x) // 10) :].mean())
        means = [x[a:b].mean() for a, b in pairwise(edges) if b > a]
        changes = [final_position - float(mean) for mean in means]
        return max(changes, key=abs, default=0.0) / self.depth

    @cached_property
    def reading(self) -> FloatArray:
        """The force with its hum, in the counts of its converter, N."""
        lines = [line.force(self.time) for line in self.hum]
        return np.asarray(self.force + np.sum(lines, axis=0)) if lines else self.force

    @property
    def hold(self) -> slice:
        """The samples of the hold, ramp end included."""
        start, stop = np.searchsorted(self.time, [self.ramp_end, self.hold_end])
        return slice(int(start), min(int(stop) + 1, len(self.time)))

    @cached_property
    def settled_samples(self) -> slice:
        """The samples of the hold after the plate has settled, within a fifth of the ramp time."""
        hold = self.hold
        early_hold = slice(
            hold.start,
            int(np.searchsorted(self.time, self.ramp_end + SETTLING_SHARE * self.ramp_time)),
        )
        tolerance = max(
            SETTLED_DISTANCE * self.depth,
            0.5 * self.displacement_quantum,
            5 * self.displacement_noise,
        )
        unsettled_samples = np.flatnonzero(
            np.abs(self.displacement[early_hold] - self.depth) > tolerance
        )
        # what is left of the swing dies away in as long again
        first_settled = 2 * (int(unsettled_samples[-1]) + 1) if unsettled_samples.size else 0
        return slice(min(hold.start + first_settled, early_hold.stop), hold.stop)


# Smallest number of samples of a segment of constant speed, and of samples outside the ramp at
# its ends.
STRETCH_SAMPLES, PARTIAL_SAMPLES = 4, 2
# of the travel: a step that bears on the depth
COARSE_STEP = 0.003


def find_quantum(values: FloatArray) -> float:
    """Return the step of which all differences are whole multiples; 0 if there is none.

    Quantised readings repeat; where every second reading is a new one, no quantum is claimed.
    """
    levels = np.sort(values)
    level_differences = np.diff(levels)
    level_differences = level_differences[level_differences > 0]
    if not 1 <= len(level_differences) <= 0.5 * len(values) - 1:
        return 0.0
    # what arithmetic leaves between two equal readings is no quantum
    level_differences = level_differences[
        level_differences > 1e-9 * max(abs(levels[0]), abs(levels[-1]))
    ]
    if len(level_differences) == 0:
        return 0.0
    step = float(level_differences.min())
    counts = np.round(level_differences / step)
    count_errors = np.abs(level_differences / step - counts) / counts
    step = float(level_differences.sum() / counts.sum())
    return 0.0 if np.mean(count_errors < 0.02) < 0.98 or _is_evenly_climbed(values, step) else step


def _is_evenly_climbed(values: FloatArray, step: float) -> bool:
    """True if the steps are those of an ideal ramp between ideal rests, not of a converter."""
    magnitude = np.abs(np.diff(values))
    is_moving = magnitude > 0.5 * step
    # a converter that counts a ramp in single steps also pauses on it
    is_isolated = is_moving[1:-1] & ~(is_moving[:-2] & is_moving[2:])
    is_single_stepped = np.mean(np.abs(magnitude[is_moving] / step - 1) < 0.02) > 0.9
    if is_single_stepped and np.count_nonzero(is_isolated) < 0.1 * np.count_nonzero(is_moving) + 4:
        return True
    # counts finer than that are distinguished from a continuous path, and cost nothing
    return step > COARSE_STEP * float(np.ptp(values)) and _keeps_its_speeds(np.diff(values) / step)


def _keeps_its_speeds(counts: FloatArray) -> bool:
    """True if a path, in counts from sample to sample, is of long stretches of one speed each.

    That is a commanded motion, with any number of ramps and rests. A converter slips: between two
    stretches of one speed a few samples move otherwise, unless the speed is a whole number of
    counts.
    """
    edges = np.flatnonzero(np.abs(np.diff(counts)) > 0.1) + 1
    starts = np.concatenate(([0], edges))
    lengths = np.diff(np.append(starts, len(counts)))
    speeds = counts[starts]
    is_moving, is_long = np.abs(speeds) > 0.5, lengths >= STRETCH_SAMPLES
    if lengths[is_moving & ~is_long].sum() > PARTIAL_SAMPLES * np.count_nonzero(
        is_moving & is_long
    ):
        return False
    is_pause = ~is_long[1:-1] & (np.abs(speeds[2:] - speeds[:-2]) < 0.1)
    return not is_pause.any()


# Motion of the plate, recorded or planned.


@dataclass(frozen=True, eq=False)
class Trajectory(EqualByValue):
    """Trajectory of the plate, as set or as recorded.

    Attributes
    ----------
    time : array, shape (n,)
        s, strictly increasing.
    displacement : array, shape (n,)
        Along the plate's normal, m; into the seal is positive.
    position : array, shape (n, 3), or None
        The same in space, m.
    source : Source or None

    Raises
    ------
    DataError
        If the arrays differ in length, are not finite, or time stalls.
    """

    time: FloatArray
    displacement: FloatArray
    position: FloatArray | None = None
    source: Source | None = None

    def __post_init__(self) -> None:
        validate_measured_fields(self, "time", "displacement", minimum=2)
        if self.position is not None:
            if self.position.shape != (len(self.time), 3):
                raise DataError(
                    f"position has the shape {self.position.shape}; expected {len(self.time)} rows "
                    "of x, y, z"
                )
            object.__setattr__(self, "position", make_readonly_copy(self.position))
