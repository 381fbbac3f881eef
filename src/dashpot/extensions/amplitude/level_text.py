"""Predictions at several amplitudes, as text."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from dashpot.base.number_format import ascii_only, interval
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.extensions.amplitude.level_prediction import LevelPrediction
from dashpot.extensions.amplitude.preloaded_response import PreloadedLevel
from dashpot.text_output import results
from dashpot.text_output.layout import Text, table


def prediction(level_prediction: LevelPrediction) -> Text:
    """Return the text of a prediction, with the resonance at each level."""
    return results.render_prediction(level_prediction, _format_level_resonances(level_prediction))


def _format_level_resonances(level_prediction: LevelPrediction) -> list[str]:
    """Return the table of the resonance at each amplitude, and its change from first to last."""
    if level_prediction.preloaded:
        return _format_nonlinear_resonances(level_prediction.preloaded, level_prediction.frf.read)
    assert level_prediction.sweep is not None  # noqa: S101
    first_level = level_prediction.levels[0]
    rows = [
        [
            f"amplitude, {first_level.unit}",
            "peak, Hz",
            "95 %",
            level_prediction.frf.read,
            "95 %",
            "motion of the seal",
        ]
    ]
    for level in level_prediction.levels:
        quantity = format_quantity(level.amplitude, "mm", ".3g")
        if level.strain is not None:
            quantity += f", {format_quantity(level.strain, '%', '.3g')}"
        rows.append(
            [
                f"{level.level:.4g}",
                f"{level.frequency:.5g}",
                ascii_only(interval(*level.frequency_between)),
                f"{level.value:.4g}",
                ascii_only(interval(*level.value_between)),
                quantity,
            ]
        )
    factors_text = " or ".join(f"{factor:.3g}" for factor in level_prediction.sweep.factors)
    message = f"  {' or '.join(level_prediction.sweep.names)} law of the sweep"
    if first_level.strain is not None:
        message += f", its strain {factors_text} of X/height"
    largest_level = level_prediction.levels[-1]
    if largest_level is not first_level:
        change = 100 * (largest_level.frequency / first_level.frequency - 1)
        message += f"; the peak moves by {change:+.3g} % from first to last"
    return [*table(rows), message]


_HARMONIC = 1e-4
"""Part of the first harmonic below which none is reported."""


def _format_nonlinear_resonances(levels: Sequence[PreloadedLevel], unit: str) -> list[str]:
    """Return the table of resonance and harmonics at each amplitude by a nonlinear elastic law."""
    header = [f"amplitude, {levels[0].unit}", "peak, Hz", unit, "1st, mm", "2nd, mm",
            "3rd, mm", "mean shift, mm", "no contact", "growth"]  # fmt: skip
    rows: list[list[str]] = [header]
    message: list[str] = []
    for level in levels:
        orbit = level.orbit
        # what is less is rounding
        min_shift = _HARMONIC * level.amplitude
        rows.append(
            [
                f"{level.level:.4g}",
                f"{level.frequency:.5g}",
                f"{level.value:.4g}",
                *(
                    f"{convert_to_unit(amplitude, 'mm') * (abs(amplitude) > min_shift):.3g}"
                    for amplitude in (*orbit.amplitudes[1:4].tolist(), orbit.shift)
                ),
                f"{100 * orbit.lost_contact:.3g} %",
                f"{orbit.growth:.3g}",
            ]
        )
        if level.interval is not None:
            rows.append(_format_interval_row(level, min_shift))
        message += _list_level_lines(level, min_shift)
    return [*table(rows), *message]


def _list_level_lines(level: PreloadedLevel, min_shift: float) -> Iterator[str]:
    """Yield lines on opening, harmonics and stability of the response at one amplitude."""
    name, shift = f"at {level.level:.4g} {level.unit}", level.orbit.shift
    if level.interval is not None and level.interval.value is None:
        has_jump = level.interval.harmonics is None
        reason = "a sweep jumps down from it" if has_jump else "its error is as large as itself"
        yield f"  ! {name} the height of the peak is not identified: {reason}"
    if abs(shift) <= min_shift:
        return
    verb, second = "opens" if shift < 0 else "closes", level.second_harmonic
    yield (
        f"  {name} the seal {verb} by {format_quantity(abs(shift), 'mm', '.2g')} on average; the "
        f"second harmonic is largest at {second['frequency_hz']:.4g} Hz, "
        f"{100 * second['amplitude'] / second['first']:.3g} % of the first"
    )
    for low, high in level.unsteady:
        yield (
            f"  ! {name} no response with the period of the force is stable from {low:.4g} to "
            f"{high:.4g} Hz"
        )
    for hz in level.jumps_hz:
        yield (
            f"  ! {name} two stable responses exist below {hz:.5g} Hz. This is that of a rising "
            "sweep; a falling sweep stays on the other"
        )


def _format_interval_row(level: PreloadedLevel, min_value: float) -> list[str]:
    """Return the row of 95 % intervals under a level's, as far as they are known."""
    hz, height, shift, *harmonics = level.facts
    cells = ["  95 %"]
    for reported_value in (hz, height, *harmonics, shift):
        has_reported_interval = reported_value.has_interval and (
            reported_value.unit != "m" or abs(reported_value.value) > min_value
        )
        half_width = convert_to_unit(
            0.5 * (reported_value.high - reported_value.low), reported_value.read or "1"
        )
        cells.append(f"± {half_width:.2g}" if has_reported_interval else "")
    return [*cells, "", ""]
