"""Uncertainties of the test machine or oven that records do not show."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from dashpot.base import dataclass, replace
from dashpot.base.errors import DataError
from dashpot.base.option_fields import get_option_key, iterate_option_fields, option
from dashpot.base.serialisation import EVERY_FIELD, Key, Serialisable
from dashpot.base.units import si_fields
from dashpot.base.value_ranges import (
    SIZES,
    require_nonnegative,
    require_positive,
    select_fields,
)

# Delay between two channels of one clock, in samples.
_CLOCK_TOLERANCE = 0.01


class DefaultUncertainty(NamedTuple):
    """Default uncertainty of a machine, as one standard deviation.

    Attributes
    ----------
    size : float
    quantity : str
        What it is measured by.
    source : str
        Why so much, and no more.
    """

    size: float
    quantity: str
    source: str


DEFAULT_UNCERTAINTIES: Mapping[str, DefaultUncertainty] = MappingProxyType({
    "drift over the record": DefaultUncertainty(
        3.5e-3, "of the final force", "data sheets of load cells: zero drift of a warm amplifier"
    ),
    "drift rate": DefaultUncertainty(
        2.4e-4, "1/s, of the final force, until it is warm",
        "simulation: .5 mN/s on a seal of 1 N, one in twenty",
    ),
    "drift of a noisy cell": DefaultUncertainty(
        0.1, "1/s, of the scatter of its readings", "simulation: a cell too large for its test"
    ),
    "warm after": DefaultUncertainty(
        120.0, "s; later it drifts as the root of time", "amplifiers settle within minutes"
    ),
    "drift changes": DefaultUncertainty(
        1e-3, "of the final force over the record", "a slope before contact may be another later on"
    ),
    "delay": DefaultUncertainty(5e-3, "s, and one sample at least", "two converters, each with its "
                                                                    "own filter"),
    "give": DefaultUncertainty(
        0.0125, "of the depth, under the largest force",
        "cells give .2 to .5 mm at full scale, of which a test uses a tenth to a third",
    ),
    "give, named": DefaultUncertainty(0.1, "of the named one", "pressed steel on steel, once"),
    "crosshead": DefaultUncertainty(
        1.25e-3, "of the depth in a factor e of time after its stop",
        "20 um in a factor e of time, of 8 mm, is two standard deviations",
    ),
    "earlier press": DefaultUncertainty(
        0.1, "of the depth, by which a seal was pressed for long before its record",
        "conditioning cycles to the full depth: their mean, less what a rest takes",
    ),
    "set": DefaultUncertainty(
        0.03, "of the depth, by which its face may be lower than it was; half of a gap at most",
        "simulation: 4 s after conditioning cycles, half of what is left",
    ),
    "rest after it": DefaultUncertainty(4.0, "s", "the time that a recorder takes to be started by "
                                                  "hand"),
    "folded mains": DefaultUncertainty(
        5e-3, "of the largest force, as amplitude",
        "8 mN of a seal of 1.5 N, before a converter that states no filter",
    ),
    "warming": DefaultUncertainty(0.7, "K, of the seal over its record", "a room without a "
                                                                         "chamber"),
    "warming in a chamber": DefaultUncertainty(
        0.5, "K, of the seal over its record", "what a chamber holds its temperature to"
    ),
    "faster by warmth": DefaultUncertainty(
        0.19, "of ln a_T in a kelvin", "WLF's universal constants 75 K above a glass transition"
    ),
    "cable": DefaultUncertainty(
        0.015, "of the stiffness of the seals at the resonance",
        "trials: cables of accelerometers add 1 to 3 %",
    ),
    "loss of the cable": DefaultUncertainty(0.5, "its loss factor", "plasticised PVC and silicone "
                                                                    "jackets"),
    "high-pass": DefaultUncertainty(
        0.16, "Hz, its corner, of one channel of a hammer test alone",
        "accelerometers that are stated to lose 5 % at .5 Hz; small ones have twice that",
    ),
    "high-pass, named": DefaultUncertainty(0.1, "of the named one", "resistor and capacitor"),
    "table": DefaultUncertainty(
        5e-3, "of the give of the seals", "a bench whose own modes lie ten times higher"
    ),
    "mass that moves along": DefaultUncertainty(
        3e-3, "of the mass", "half of a cable of 1 g, wax and a stud, on 100 to 200 g"
    ),
})  # fmt: skip
"""One standard deviation of each effect that limits include and fitted values do not.

The table of a machine that nobody has described; the values of `Machine` replace it.
"""


HAMMER_RIG_FIELDS = ("cable", "high_pass")
"""Fields of `Machine` that describe the rig of a hammer."""


@dataclass(frozen=True)
class MachineCalibration(Serialisable):
    """Errors of a machine as measured by blank tests; they are subtracted from its records.

    Attributes
    ----------
    delay : float
        Delay of the force behind the displacement, s.
    gain, gain_error : float
        Reading of the force over the force, with its standard error.
    compliance_error : float
        Standard error of the compliance, m/N.
    settling : float
        Way by which the crosshead presses on in a factor e of time after its stop, m.
    source : str
        The machine file and its date, for people.
    """

    delay: float = 0.0
    gain: float = 1.0
    gain_error: float = 0.0
    compliance_error: float = 0.0
    settling: float = 0.0
    source: str = ""


@dataclass(frozen=True)
class Machine(Serialisable):
    r"""Test machine: properties that its records show badly or not at all.

    None is an unknown value; `DEFAULT_UNCERTAINTIES` then applies.

    Attributes
    ----------
    sync : float or None
        Standard deviation of the delay between the clocks of force and displacement, s; by default
        at least one sample.
    drift : float or None
        Standard deviation of the drift of the load cell, N/s, as its data sheet gives it.
    compliance : float or None
        Compliance of machine and load cell, m/N: the seal is compressed by :math:`x - C F`; 0 if
        the displacement is measured at the seal.
    creep : float or None
        Standard deviation of the settling of its crosshead per factor e of time after the stop, m,
        where no reading shows it.
    force_filter : float or None
        Cut-off of a first-order low-pass in the force channel, Hz.
    rest : float or None
        Time without load before the record began, s.
    oven : float or None
        Standard deviation of the true temperature of an oven from its reading, K.
    cable : float or None
        In a hammer's rig: standard deviation of the stiffness that the cables add beside the seals,
        over that of the seals at the resonance; 0 if they hang free.
    high_pass : float or None
        In a hammer's rig: corner of a first-order high-pass in the channel of the accelerometer
        alone, Hz; 0 if it has none, or the hammer's channel has the same.
    calibration : MachineCalibration or None
        What blank tests measured; the standard deviations above are then theirs.

    Examples
    --------
    >>> import dashpot as dp
    >>> dp.Machine(drift="0.2mN/s").drift
    0.0002
    """

    _keys = (EVERY_FIELD, Key("high_pass", optional=True), Key("calibration", optional=True))

    sync: float | None = option(
        None, "Uncertainty of the delay between force and displacement.", unit="time",
        keyed_flag="machine", size=SIZES["delay"],
    )  # fmt: skip
    drift: float | None = option(
        None, "Drift of the load cell, e.g. 0.2mN/s.", unit="force rate", keyed_flag="machine"
    )
    compliance: float | None = option(
        None, "Compliance of the machine, e.g. 50um/N.", unit="compliance", keyed_flag="machine"
    )
    creep: float | None = option(
        None,
        "Creep of the crosshead in e-fold time, e.g. 5um.",
        unit="length",
        keyed_flag="machine",
    )
    force_filter: float | None = option(
        None,
        "First-order low-pass in the force channel, e.g. 10Hz.",
        unit="frequency",
        keyed_flag="machine",
    )

    rest: float | None = option(
        None, "Rest of the seal before the record, e.g. 10min.", unit="time", keyed_flag="machine"
    )
    oven: float | None = option(
        None, "Error of an oven's temperature, e.g. 1K.", unit="temperature", keyed_flag="machine"
    )

    cable: float | None = option(
        None, "Cable stiffness over the seals', e.g. 1%; 0: it hangs.", unit="strain",
        keyed_flag="machine",
    )  # fmt: skip
    high_pass: float | None = option(
        None, "Corner of the accelerometer's high-pass alone, e.g. 0.16Hz.", unit="frequency",
        keyed_flag="machine",
    )  # fmt: skip
    calibration: MachineCalibration | None = None

    @property
    def on_bench(self) -> Machine:
        """Machine of a relaxation test, without the rig of the hammer."""
        return replace(self, **dict.fromkeys(HAMMER_RIG_FIELDS))

    def refuse_unused(self, *names: str, subject: str) -> None:
        """Refuse stated properties of the machine that a test of this kind does not use.

        Raises
        ------
        DataError
        """
        if self.calibration is not None and "compliance" not in names:
            raise DataError(
                f"a machine file is for a ramp and hold, and does not suit {subject}. State what "
                f"it takes instead: --machine {names[0]}="
            )
        for field in iterate_option_fields(self):
            if getattr(self, field.name) is not None and field.name not in names:
                raise DataError(
                    f"--machine {get_option_key(field)}= does not suit {subject}. Leave it out; it "
                    f"takes {', '.join(names)}"
                )

    def delay_sd(self, sample: float) -> float:
        """Return the standard deviation of the force's delay, s, for a sample interval, s."""
        filtered = 1 / (2 * math.pi * self.force_filter) if self.force_filter else 0.0
        if self.sync is None:
            return max(sample, DEFAULT_UNCERTAINTIES["delay"].size, filtered)
        return max(_CLOCK_TOLERANCE * sample, self.sync, filtered)

    def give_sd(self, depth: float, peak: float) -> float:
        """Standard deviation of its unstated deflection under the `peak` of the force, N, in m."""
        if self.compliance is None:
            return DEFAULT_UNCERTAINTIES["give"].size * depth
        calibration = self.calibration
        if calibration is not None:
            return math.hypot(calibration.compliance_error * peak, calibration.gain_error * depth)
        return DEFAULT_UNCERTAINTIES["give, named"].size * self.compliance * peak

    def creep_sd(self, depth: float) -> float:
        """Return the standard deviation of the crosshead's settling per factor e of time, m."""
        return DEFAULT_UNCERTAINTIES["crosshead"].size * depth if self.creep is None else self.creep

    @property
    def min_rest_time(self) -> float:
        """Least time that the seal was unloaded before its record, s."""
        return DEFAULT_UNCERTAINTIES["rest after it"].size if self.rest is None else self.rest

    def drift_sd(self, final: float, duration: float, noise: float | None = None) -> float:
        r"""Standard deviation of the drift, N/s; of a cell not described, from the final force, N.

        Over a record of `duration` T, s, it may drift by :math:`3.5 \cdot 10^{-3} F_e`: the bounds
        of a fit. A limit includes more. With the `noise` of the force s, N, that is

        .. math:: \max\Bigl(3.5 \cdot 10^{-3} F_e/T,\
                  \sqrt{(2.4 \cdot 10^{-4} F_e)^2 + (0.1\,s)^2}\,/\sqrt{1 + T/120\,\mathrm s}\Bigr)
        """
        if self.drift is not None:
            return self.drift
        default_drift = DEFAULT_UNCERTAINTIES["drift over the record"].size * final / duration
        if noise is None:
            return default_drift
        values = (
            DEFAULT_UNCERTAINTIES["drift rate"].size * final,
            DEFAULT_UNCERTAINTIES["drift of a noisy cell"].size * noise,
        )
        return max(
            default_drift,
            math.hypot(*values)
            / math.sqrt(1 + duration / DEFAULT_UNCERTAINTIES["warm after"].size),
        )

    def combine_drift(
        self, slope: tuple[float, float], final: float, duration: float, noise: float | None = None
    ) -> tuple[float, float]:
        r"""Return mean and standard deviation of the drift as baseline and cell say together, N/s.

        A baseline with the `slope` m and its error e, N/s, may have drifted otherwise than the
        record, by :math:`w = 10^{-3} F_e/T`. With s that of :meth:`drift_sd`

        .. math:: 1/\sigma^2 = 1/s^2 + 1/(e^2 + w^2), \qquad \mu = m\,\sigma^2/(e^2 + w^2)

        Where they contradict each other (:meth:`drift_conflict` above 1) there is no average: the
        drift is then 0 with :math:`\sigma = s`, and of a limit :math:`\sigma^2 = s^2 + m^2`.
        As free a drift in the fit would replace slow arms.
        """
        mean, error = slope
        drift_sd = self.drift_sd(final, duration, noise)
        if not math.isfinite(error) or drift_sd == 0:
            return 0.0, drift_sd
        if self.drift_conflict(slope, final, duration, noise) > 1:
            return 0.0, drift_sd if noise is None else math.hypot(drift_sd, mean)
        variance = error**2 + (DEFAULT_UNCERTAINTIES["drift changes"].size * final / duration) ** 2
        sd = 1 / math.sqrt(1 / variance + 1 / drift_sd**2)
        return mean * sd**2 / variance, sd

    def drift_conflict(
        self, slope: tuple[float, float], final: float, duration: float, noise: float | None = None
    ) -> float:
        r"""Return the deviation of the measured drift from the stated one; above 1 they conflict.

        .. math:: |m| \big/ 3\sqrt{e^2 + w^2 + s^2}

        with the slope m of :meth:`combine_drift`. Source: G. E. P. Box, J. R. Statist. Soc. A 143
        (1980) 383, the prior predictive check.
        """
        mean, error = slope
        if not math.isfinite(error):
            return 0.0
        changes = DEFAULT_UNCERTAINTIES["drift changes"].size * final / duration
        difference_sd = math.hypot(error, changes, self.drift_sd(final, duration, noise))
        return abs(mean) / (3 * difference_sd) if difference_sd > 0 else 0.0

    def __post_init__(self) -> None:
        si_fields(self)
        fields = select_fields(
            self, "sync", "drift", "compliance", "creep", "rest", "oven", *HAMMER_RIG_FIELDS
        )
        require_nonnegative(
            "machine ", **fields, expected="a number >= 0 in SI units", optional=True
        )
        require_positive("machine ", force_filter=self.force_filter, unit=" Hz", optional=True)
