"""Leak speeds of a door, as text."""

from __future__ import annotations

from dashpot.base.units import celsius, convert_to_unit, format_quantity
from dashpot.extensions.systems.door.leak_result import LeakResult
from dashpot.text_output.layout import Text, table
from dashpot.text_output.results import format_rounded

_HEAD = ("state", "N/m", "Pa", "km/h", "95 % interval", "at, m")


def render_leak(result: LeakResult) -> Text:
    """Return the pressure, and of each state the station that lifts first."""
    setup, verdicts = result.setup, result.limit_verdicts
    first = (
        f"  seal line {format_rounded(float(result.stations.length.sum()))} m, "
        f"{len(result.arc_length)} stations; pressure on {format_quantity(setup.lip, 'mm')}, "
        f"coefficient {setup.pressure_coefficient:g}"
    )
    lines = [first]
    if setup.limit is not None:
        lines.append(f"  limit {convert_to_unit(setup.limit, 'km/h'):.4g} km/h")
    rows = [[*_HEAD, *(["limit"] if verdicts else [])]]
    for state in result.states:
        i = state.weakest
        value, low, high = (convert_to_unit(item, "km/h") for item in state.least)
        row = [
            state.name,
            format_rounded(float(state.force[i])),
            format_rounded(float(state.pressure[i])),
            f"{value:.1f}",
            f"{low:.1f} to {high:.1f}",
            f"{result.arc_length[i]:.3f}",
        ]
        rows.append([*row, *([verdicts[state.name]] if verdicts else [])])
    details = [["state", "which is", "force left, %", "air, kg/m^3"]]
    for state, words in zip(result.states, describe_states(result), strict=True):
        details.append([state.name, words, f"{100 * state.retained:.3g}", f"{state.density:.3f}"])
    return Text([*lines, *table(rows)], table(details))


def describe_states(result: LeakResult) -> tuple[str, ...]:
    """Return of each state its gap, temperature and aging in words."""
    words = ["as the file of the door describes it"]
    for state in result.setup.states:
        parts = []
        if state.gap:
            parts.append(f"gap {format_quantity(state.gap, 'mm')} wider")
        if state.time < float("inf"):
            parts.append(f"{format_quantity(state.time, 's')} after that")
        if state.temperature is not None:
            parts.append(celsius(state.temperature))
        if state.retained < 1:
            parts.append(f"{100 * state.retained:.3g} % of the force")
        if state.aging is not None:
            hours = format_quantity(state.aging.time, "h", ".6g")
            parts.append(f"aged {hours} at {celsius(state.aging.temperature)}")
        words.append(", ".join(parts) or "as new")
    return tuple(words)
