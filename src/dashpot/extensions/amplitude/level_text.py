"""The text of a prediction at levels."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.extensions.amplitude.level_prediction import LevelPrediction
from dashpot.extensions.amplitude.preloaded_response import PreloadedLevel
from dashpot.text_output import results
from dashpot.text_output.layout import Text, table


def prediction(found: LevelPrediction) -> Text:
    """Return the text of a prediction, with the resonance at each level."""
    return results.prediction(found, _format_level_resonances(found))


def _format_level_resonances(found: LevelPrediction) -> list[str]:
    """The resonance at each level, and what the first and the last make of it."""
    if found.preloaded:
        return _on_bending_seals(found.preloaded, found.frf.read)
    assert found.swept is not None  # noqa: S101
    of = found.levels[0]
    rows = [[f"level, {of.unit}", "peak, Hz", "between", found.frf.read, "between", "moved"]]
    for one in found.levels:
        moved = format_quantity(one.amplitude, "mm", ".3g")
        if one.strain is not None:
            moved += f", {format_quantity(one.strain, '%', '.3g')}"
        rows.append(
            [
                f"{one.level:.4g}",
                f"{one.frequency:.5g}",
                "{:.5g} to {:.5g}".format(*one.frequency_between),
                f"{one.value:.4g}",
                "{:.4g} to {:.4g}".format(*one.value_between),
                moved,
            ]
        )
    listed = " or ".join(f"{one:.3g}" for one in found.swept.factors)
    says = f"  {' or '.join(found.swept.names)} law of the sweep"
    if of.strain is not None:
        says += f", its strain {listed} of X/height"
    last = found.levels[-1]
    if last is not of:
        change = 100 * (last.frequency / of.frequency - 1)
        says += f"; the peak moves by {change:+.3g} % from first to last"
    return [*table(rows), says]


_HARMONIC = 1e-4
"""Part of the first harmonic below which none is told."""


def _on_bending_seals(found: Sequence[PreloadedLevel], unit: str) -> list[str]:
    """The resonance and harmonics at each level, by the elastic law, and what the seal does."""
    head = [f"level, {found[0].unit}", "peak, Hz", unit, "1st, mm", "2nd, mm",
            "3rd, mm", "mean shift, mm", "apart", "floquet"]  # fmt: skip
    rows: list[list[str]] = [head]
    says: list[str] = []
    for one in found:
        at = one.orbit
        # what is less is rounding
        least = _HARMONIC * one.amplitude
        rows.append(
            [
                f"{one.level:.4g}",
                f"{one.frequency:.5g}",
                f"{one.value:.4g}",
                *(
                    f"{convert_to_unit(each, 'mm') * (abs(each) > least):.3g}"
                    for each in (*at.amplitudes[1:4].tolist(), at.shift)
                ),
                f"{100 * at.lost:.3g} %",
                f"{at.growth:.3g}",
            ]
        )
        if one.interval is not None:
            rows.append(_within(one, least))
        says += _of_level(one, least)
    return [*table(rows), *says]


def _of_level(one: PreloadedLevel, least: float) -> Iterator[str]:
    """What else is to be known of the response at one level."""
    name, shift = f"at {one.level:.4g} {one.unit}", one.orbit.shift
    if one.interval is not None and one.interval.value is None:
        jumps = one.interval.harmonics is None
        why = "a sweep jumps down from it" if jumps else "its error is as large as itself"
        yield f"  ! {name} the height of the peak is not identified: {why}"
    if abs(shift) <= least:
        return
    does, second = "opens" if shift < 0 else "closes", one.second_harmonic
    yield (
        f"  {name} the seal {does} by {format_quantity(abs(shift), 'mm', '.2g')} when shaken; the "
        f"second harmonic is largest at {second['frequency_hz']:.4g} Hz, "
        f"{100 * second['amplitude'] / second['first']:.3g} % of the first"
    )
    for low, high in one.unsteady:
        yield f"  ! {name} no answer at the drive's period lasts from {low:.4g} to {high:.4g} Hz"
    for hz in one.jumps_hz:
        yield (
            f"  ! {name} two answers last below {hz:.5g} Hz. This is a rising frequency's; a "
            "falling one keeps the other"
        )


def _within(one: PreloadedLevel, least: float) -> list[str]:
    """The row of 95 % intervals under a level's, as far as they are known."""
    hz, height, shift, *harmonics = one.facts
    cells = ["  95 %"]
    for fact in (hz, height, *harmonics, shift):
        told = fact.bounded and (fact.unit != "m" or abs(fact.value) > least)
        half = convert_to_unit(0.5 * (fact.high - fact.low), fact.read or "1")
        cells.append(f"± {half:.2g}" if told else "")
    return [*cells, "", ""]
