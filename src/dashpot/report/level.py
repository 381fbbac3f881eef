"""What is read of a fit of several levels: its numbers in the units of people, and its page."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from dashpot import plot
from dashpot.base.arrays import FloatArray
from dashpot.base.numbers import rounded
from dashpot.kinds.level.hits import HitLevels
from dashpot.kinds.level.levels import Elements, LevelFit, PeakAtLevel
from dashpot.kinds.level.record import AmplitudeFit
from dashpot.plot.picture import unit_of
from dashpot.report.figures import drawn
from dashpot.report.pages import COLOURS, frame, held
from dashpot.report.tables import READ, ParameterRow, TextTable, checks
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.rate_independent import InParallel
from dashpot.workflow.levels import Levels

_95 = 1.96
"""Standard errors to either end of a 95 % interval."""
_FINEST = 1e-6
"""Part of a number to which it is known at best: no sweep has more digits."""


def contents(found: Levels) -> dict[str, Any]:
    """What the page of a fit of several levels holds."""
    rows = []
    for one in numbers(found):
        half = (one.ends[1] - one.ends[0]) / 2
        value, low, high = (rounded(each, half) for each in (one.value, *one.ends))
        rows.append((one.name, value, low, high, one.unit))
    picture = replace(plot.level(found.fit, found.records), name="level")
    names = dict.fromkeys(one.file for one in found.source)
    return {
        **frame(),
        "title": ", ".join(names) or "levels",
        "verdict": found.verdict,
        "colour": COLOURS[found.verdict.use],
        "figures": {"level": drawn(picture)},
        "numbers": TextTable(("", "value", "95 % from", "to", "unit"), tuple(rows)),
        "beyond": beyond(found),
        "checks": checks([("levels", found.checks)], found.checks),
        "sources": tuple(dict.fromkeys(found.source)),
        "simulated": list(dict.fromkeys(one.file for one in found.source if one.simulated)),
        "link": held("application/json", document(found)),
    }


def document(found: Levels) -> str:
    """The JSON that ``dashpot level --json`` prints."""
    return json.dumps(found.document, indent=2, ensure_ascii=False, allow_nan=False)


def numbers(found: Levels) -> list[ParameterRow]:
    """What moves with amplitude, and the resonance at every level that was asked for."""
    fit = found.fit
    if isinstance(fit, AmplitudeFit):
        return [*_of_law(fit)]
    rows = _of_hits(fit) if isinstance(fit, HitLevels) else _of_levels(fit)
    return [*rows, *(row for one in found.at for row in _of_peak(one))]


def beyond(found: Levels) -> str:
    """What the fit leaves, and where nothing is known of it."""
    fit = found.fit
    if isinstance(fit, AmplitudeFit):
        word, scale = _amplitude(fit)
        said = f"Leaves {rounded(100 * fit.residual, digits=2)} % rms"
        if fit.left_out:
            said += f", less {fit.left_out} samples of the smallest amplitudes, which scatter"
    elif isinstance(fit, HitLevels):
        word, scale = unit_of(np.array(fit.amplitudes), "m")
        said = (
            f"Four of five such tests find {rounded(100 * fit.trend.stiffness_found, digits=2)} % "
            f"of stiffness and {rounded(100 * fit.trend.damping_found, digits=2)} % of damping per "
            "doubling"
        )
    else:
        word, scale = unit_of(np.array(fit.amplitudes), "m")
        arms, sliders = fit.solid.arms, len(fit.sliders)
        said = (
            f"{arms} arm{'s' * (arms != 1)}, {sliders} slider{'s' * (sliders != 1)}"
            f"{' and a cubic spring' * bool(fit.k3)} leave "
            f"{rounded(100 * fit.residual, digits=2)} % of F/X, arms alone "
            f"{rounded(100 * fit.linear_residual, digits=2)} %"
        )
    low, high = (rounded(scale * end) for end in fit.amplitudes)
    return f"{said}. Nothing is known beyond {low} to {high} {word}."


def _of_law(fit: AmplitudeFit) -> Iterator[ParameterRow]:
    """Storage and loss at a vanishing amplitude, and the law's own numbers."""
    unit, scale = READ[fit.unit]
    letter = "E" if fit.unit == "Pa" else "K"
    for i, hz in enumerate(fit.frequency.tolist()):
        value, error = scale * complex(fit.linear[i]), scale * complex(fit.linear_se[i])
        size = abs(value)
        yield _known(f"{letter}′, {hz:.4g} Hz", value.real, error.real, unit, size)
        yield _known(f"{letter}″, {hz:.4g} Hz", value.imag, error.imag, unit, size)
    error_of = dict(fit.se)
    word, stretch = _amplitude(fit)
    if fit.k3:
        # per square of an amplitude it is a number that nobody has seen: what it adds is
        most = 0.75 * scale * fit.amplitudes[1] ** 2
        said = f"cubic spring, at {rounded(stretch * fit.amplitudes[1])} {word}"
        yield _known(said, most * fit.k3, most * error_of["k3"], unit)
    if "lost" not in error_of:
        return
    lost = ("%", 100.0) if fit.law.startswith("factor") else (unit, scale)
    yield _known("lost", lost[1] * fit.lost, lost[1] * error_of["lost"], lost[0])
    yield _known(
        f"half lost, {'strain' if fit.of == 'strain' else 'amplitude'}",
        stretch * fit.half_way, stretch * error_of["half_way"], word,
    )  # fmt: skip
    # one that was set is not known
    yield _known("exponent", fit.exponent, error_of["exponent"] or np.inf, "")


def _of_hits(fit: HitLevels) -> Iterator[ParameterRow]:
    """How stiffness and damping change for twice the motion."""
    for name, line in (
        ("stiffness per doubling", fit.trend.stiffness_line),
        ("damping per doubling", fit.trend.damping_line),
    ):
        yield _known(name, 100 * line.slope, 100 * line.se, "%")


def _amplitude(fit: AmplitudeFit) -> tuple[str, float]:
    """The word and the factor in which an amplitude is read."""
    if fit.of == "strain":
        return "%", 100.0
    return unit_of(np.array(fit.amplitudes), "m")


def _known(name: str, value: float, error: float, unit: str, size: float = 0.0) -> ParameterRow:
    """A number with its error; `size` is what it is a part of."""
    error = max(error, _FINEST * max(abs(value), size))
    return ParameterRow(name, value, error, (value - _95 * error, value + _95 * error), unit)


def _of_levels(fit: LevelFit) -> Iterator[ParameterRow]:
    """Storage and loss factor of one seal at the ends of its amplitudes, mid-band."""
    omega = np.pi * (fit.band[0] + fit.band[1])
    X = np.array(fit.amplitudes)

    def read(solid: GeneralizedMaxwell, beside: Elements) -> FloatArray:
        K = InParallel((solid, *beside)).equivalent(omega, X)
        return np.array((1e-3 * K.real, K.imag / K.real))

    value, (low, high) = read(fit.solid, fit.beside), fit.interval(read)
    for i, (name, unit) in enumerate((("K′", "N/mm"), ("loss factor", ""))):
        for j, at in enumerate(X.tolist()):
            ends = (float(low[i, j]), float(high[i, j]))
            error = (ends[1] - ends[0]) / 2 / _95
            word, mm = unit_of(np.array(at), "m")
            said = f"{name}, {rounded(mm * at, digits=2)} {word}"
            yield ParameterRow(said, float(value[i, j]), error, ends, unit)
    if fit.k3:
        word, mm = unit_of(X[1], "m")
        share = 0.75e-3 * X[1] ** 2
        low_end, high_end = (share * end for end in fit.k3_interval)
        yield ParameterRow(
            f"cubic spring, {rounded(mm * X[1], digits=2)} {word}", share * fit.k3,
            (high_end - low_end) / 2 / _95, (low_end, high_end), "N/mm",
        )  # fmt: skip


def _of_peak(one: PeakAtLevel) -> Iterator[ParameterRow]:
    """Where the motion of the mass is largest at a level, and how large it is per force."""
    for name, value, (low, high), unit, scale in (
        ("peak", one.frequency, one.frequency_interval, "Hz", 1.0),
        ("motion", one.receptance, one.receptance_interval, "mm/N", 1e3),
    ):
        said = f"{name} at {one.level:.4g} N"
        error = (high - low) / 2 / _95
        yield ParameterRow(said, scale * value, scale * error, (scale * low, scale * high), unit)
