"""Tables of a preload map for solvers: Nastran, Abaqus, MATLAB, CSV."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import ExportError
from dashpot.base.units import convert_to_unit
from dashpot.base.version import byline
from dashpot.export.decks.nastran import BushComponent, format_bush_property
from dashpot.export.unit_systems import UnitSystem, text
from dashpot.extensions.preload_map.preload_map import PreloadMap

TOLERANCE = 1e-4
"""Largest relative error of linear interpolation in a table."""
_MAX_FREQUENCIES = 2000
_FIRST_PROPERTY, _STEP = 1, 100
_LINE = 6


def tabulate_frequencies(preload_map: PreloadMap, tolerance: float = TOLERANCE) -> FloatArray:
    """Return frequencies, Hz, between which straight lines follow the map within a tolerance.

    Geometric steps, halved until the middle of every step is met; the same for every setting, for
    the settings differ by factors.

    Raises
    ------
    ExportError
        If that takes more than 2000 points.
    """
    low, high = preload_map.band
    points = 8
    while points <= _MAX_FREQUENCIES:
        f = np.geomspace(low, high, points + 1)
        middle = (f[1:] + f[:-1]) / 2
        K = preload_map.model.complex_stiffness(omega=2 * np.pi * f)
        interpolated = preload_map.model.complex_stiffness(omega=2 * np.pi * middle)
        if np.max(np.abs((K[1:] + K[:-1]) / 2 / interpolated - 1)) <= tolerance:
            return np.asarray(f)
        points *= 2
    raise ExportError(
        f"the table would need more than {_MAX_FREQUENCIES} frequencies; narrow the band (--band)"
    )


def render_csv(preload_map: PreloadMap) -> str:
    """Return the map at its levels with its 95 % limits, a row a frequency, in SI units."""
    columns = preload_map._table_columns
    header = ",".join(f"{name} [{unit}]" if unit else name for name, (_, unit) in columns.items())
    rows = zip(*(values for values, _ in columns.values()), strict=True)
    return "\n".join((header, *(",".join(f"{value:.10g}" for value in row) for row in rows))) + "\n"


def render_nastran(preload_map: PreloadMap, units: UnitSystem) -> str:
    """Return a frequency-dependent bushing property of each setting, acting along its x axis."""
    f = tabulate_frequencies(preload_map)
    middle = preload_map.middle_frequency
    lines = [
        *_format_head("$", preload_map, units, "frequency-dependent bushings, one of each setting")
    ]
    for number, (c, X) in enumerate(preload_map.settings):
        K = preload_map.evaluate(f, compression=c, amplitude=X).value
        stiffness = complex(
            preload_map.evaluate(np.array([middle]), compression=c, amplitude=X).value[0]
        )
        component = BushComponent(
            1,
            units.frequency(f).tolist(),
            units.stiffness(K.real).tolist(),
            (K.imag / K.real).tolist(),
            (units.stiffness(stiffness.real), stiffness.imag / stiffness.real),
        )
        lines.append(f"$ {_describe_setting(c, X)}; nominal at {middle:g} Hz")
        lines += format_bush_property(_FIRST_PROPERTY + _STEP * number, [component], label="GE")
    return "\n".join([*lines, ""])


def render_abaqus(preload_map: PreloadMap, units: UnitSystem) -> str:
    """Return a connector whose stiffness and damping depend on frequency, compression, amplitude.

    Compression is the first field variable, amplitude the second, in the unit of length.
    """
    f = tabulate_frequencies(preload_map)
    fields = 2 if len(preload_map.amplitudes) else 1
    stiffness_lines: list[str] = []
    damping_lines: list[str] = []
    # field variables change slowest, the last of them first
    for c, X in sorted(preload_map.settings, key=lambda setting: (setting[1] or 0.0, setting[0])):
        K = preload_map.evaluate(f, compression=c, amplitude=X).value
        levels = [c] if X is None else [c, X]
        tail = ", ".join(["", *(text(value / units.length) for value in levels)])
        for frequency, value in zip(f.tolist(), K.tolist(), strict=True):
            hertz = text(units.frequency(frequency))
            stiffness_lines.append(f"{text(units.stiffness(value.real))}, {hertz}, {tail}")
            damping_lines.append(f"{text(value.imag / value.real)}, {hertz}, {tail}")
    return "\n".join([
        *_format_head("**", preload_map, units,
        "connector behavior over frequency and field variables"),
        f"** field variable 1 is the compression, {units.words[0]}"
        + (f"; field variable 2 is the amplitude, {units.words[0]}" if fields > 1 else ""),
        "** acts along component 1, in direct or subspace-based steady-state dynamics",
        "*CONNECTOR BEHAVIOR, NAME=SEAL",
        f"*CONNECTOR ELASTICITY, COMPONENT=1, DEPENDENCIES={fields}",
        *stiffness_lines,
        f"*CONNECTOR DAMPING, COMPONENT=1, TYPE=STRUCTURAL, DEPENDENCIES={fields}",
        *damping_lines,
        "",
    ])  # fmt: skip


def render_matlab(preload_map: PreloadMap) -> str:
    """Return a script with the levels, the frequencies and K(frequency, amplitude, compression)."""
    f = tabulate_frequencies(preload_map)
    amplitudes = preload_map.amplitudes.tolist() or [None]
    lines = [
        f"% {byline('preload map')}",
        "% K(i, j, l) in N/m at frequency(i) in Hz, amplitude(j) and compression(l) in m",
        *_matlab_row("frequency", f),
        *_matlab_row("amplitude", np.array([np.nan if X is None else X for X in amplitudes])),
        *_matlab_row("compression", preload_map.compressions),
        f"K = complex(zeros({len(f)}, {len(amplitudes)}, {len(preload_map.compressions)}));",
    ]
    for n, c in enumerate(preload_map.compressions.tolist(), 1):
        for j, X in enumerate(amplitudes, 1):
            K: ComplexArray = preload_map.evaluate(f, compression=c, amplitude=X).value
            lines += [
                f"K(:, {j}, {n}) = complex( ...",
                *_wrap("[", K.real, "], ..."),
                *_wrap("[", K.imag, "]);"),
            ]
    return "\n".join([*lines, ""])


def _format_head(
    comment_sign: str, preload_map: PreloadMap, units: UnitSystem, title: str
) -> Sequence[str]:
    low, high = preload_map.band
    return (
        f"{comment_sign} {byline(title)}",
        f"{comment_sign} units: {', '.join(units.words)}; verdict: {preload_map.verdict.use}",
        f"{comment_sign} measured from {low:.6g} to {high:.6g} Hz; do not leave the table",
        f"{comment_sign} not solver-verified: no solver runs this form in dashpot's tests",
    )


def _describe_setting(compression: float, amplitude: float | None) -> str:
    words = f"compression {convert_to_unit(compression, 'mm'):.4g} mm"
    if amplitude is None:
        return words
    return f"{words}, amplitude {convert_to_unit(amplitude, 'mm'):.4g} mm"


def _matlab_row(name: str, values: FloatArray) -> list[str]:
    return _wrap(f"{name} = [", values, "];")


def _wrap(start: str, values: FloatArray, end: str) -> list[str]:
    words = [f"{value:.9g}".replace("nan", "NaN") for value in values.tolist()]
    rows = [" ".join(words[i : i + _LINE]) for i in range(0, len(words), _LINE)]
    # a column in MATLAB: rows stand below each other
    rows_with_semicolons = [row.replace(" ", "; ") for row in rows]
    return [
        f"{start} ...",
        *(f"  {row}; ..." for row in rows_with_semicolons[:-1]),
        f"  {rows_with_semicolons[-1]}{end}",
    ]
