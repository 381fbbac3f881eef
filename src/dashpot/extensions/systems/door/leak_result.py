"""Result of the leak speeds of a door's seal."""

from __future__ import annotations

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, HasChecks
from dashpot.base.provenance import Source
from dashpot.base.reported_values import ReportedValue
from dashpot.base.result_mixins import HasVerdict, Series
from dashpot.base.serialisation import Key, Serialisable
from dashpot.base.units import convert_to_unit
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.seal_line import Stations
from dashpot.extensions.systems.door.door_model import Door
from dashpot.extensions.systems.door.leak_analysis import Interval, StateLeak
from dashpot.extensions.systems.door.leak_setup import LeakSetup
from dashpot.registry import require_handler


@dataclass(frozen=True, eq=False, repr=False)
class LeakResult(HasChecks, HasVerdict, Serialisable):
    """Result of ``dashpot predict --leak``.

    Attributes
    ----------
    door : Door
    setup : LeakSetup
    fit : Fit
        Fit of the seal, at its temperature.
    stations : Stations
    compression : array, shape (n,)
        Compression of each station, m.
    states : tuple of StateLeak
        The first is the state of the door file.
    checks : tuple of Check
    """

    schema = "dashpot/leak@1"
    _keys = (
        Key("lip", "setup.lip"),
        Key("pressure_coefficient", "setup.pressure_coefficient"),
        Key("limit", "setup.limit"),
        "arc_length",
        "place",
        "compression",
        "states",
        "limit_verdicts",
        "verdict",
        "checks",
        Key("source", "sources"),
    )

    door: Door
    setup: LeakSetup
    fit: Fit
    stations: Stations
    compression: FloatArray
    states: tuple[StateLeak, ...]
    checks: tuple[Check, ...]

    @property
    def arc_length(self) -> FloatArray:
        """Arc length of each station, m."""
        return self.stations.along

    @property
    def place(self) -> FloatArray:
        """Position of each station, m, shape (n, 3)."""
        return self.stations.place

    @property
    def sources(self) -> tuple[Source, ...]:
        """The files behind it."""
        door_sources = () if self.door.source is None else (self.door.source,)
        return (*door_sources, *self.fit.source)

    @property
    def limit_verdicts(self) -> dict[str, str]:
        """Verdict on the limit in each state: met, missed or open; empty without a limit."""
        limit = self.setup.limit
        if limit is None:
            return {}
        judge = require_handler("judge interval", "limits")
        return {
            state.name: judge(limit, None, state.least.low, state.least.high)
            for state in self.states
        }

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """Leak speed in each state, of the station that lifts first."""
        return tuple(
            ReportedValue(f"leak speed, {state.name}", *state.least, unit="m/s", read="km/h")
            for state in self.states
        )

    @property
    def _table_columns(self) -> Series:
        """Stations, with the leak speed in each state."""
        columns: dict[str, tuple[FloatArray, str]] = {
            "along": (self.arc_length, "m"),
            "x": (self.place[:, 0], "m"),
            "y": (self.place[:, 1], "m"),
            "z": (self.place[:, 2], "m"),
            "compression": (self.compression, "m"),
        }
        for state in self.states:
            columns |= {
                f"force {state.name}": (state.force, "N/m"),
                f"speed {state.name}": (state.speed, "m/s"),
                f"speed_low {state.name}": (state.limits[0], "m/s"),
                f"speed_high {state.name}": (state.limits[1], "m/s"),
            }
        return columns

    def csv(self) -> str:
        """Return the stations as a table."""
        columns = self._table_columns
        header = ",".join(
            '"' + f"{name} [{unit}]".replace('"', '""') + '"' for name, (_, unit) in columns.items()
        )
        rows = zip(*(values for values, _ in columns.values()), strict=True)
        lines = (",".join(f"{value:.9g}" for value in row) for row in rows)
        return "\n".join((header, *lines)) + "\n"

    @property
    def _headline(self) -> str:
        """Leak speed as described, and the lowest of the other states."""
        first, *other_states = self.states
        text = f"the seal leaks from {format_speed(first.least)} on"
        if other_states:
            worst = min(other_states, key=lambda state: state.least.value)
            text += f", {worst.name} from {format_speed(worst.least)} on"
        return text


def format_speed(speed: Interval) -> str:
    """Return a leak speed with its limits, km/h."""
    value, low, high = (convert_to_unit(item, "km/h") for item in speed)
    return f"{value:.0f} km/h ({low:.0f} to {high:.0f})"
