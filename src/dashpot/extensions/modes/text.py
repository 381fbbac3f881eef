"""Modes of measured FRFs, as text."""

from __future__ import annotations

import cmath
import math
from typing import TYPE_CHECKING

from dashpot.base.units import convert_to_unit
from dashpot.text_output.layout import Text, table
from dashpot.text_output.results import hertz, with_error

if TYPE_CHECKING:
    from dashpot.extensions.modes.mass_series_files import MassSeriesModes
    from dashpot.extensions.modes.measured_modes import MeasuredModes


def modes(modes: MeasuredModes) -> Text:
    """Return each mode with its errors, where modes were sought, and of several points shapes."""
    has_several_points = bool(modes.points)
    # the modal mass is determined by a point that is struck itself
    last_columns = ["MPC", "MPD, deg"] if has_several_points else ["modal mass, kg"]
    rows = [
        ["mode", "frequency, Hz", "damping ratio, %", "residue, m/(N s)", *last_columns, "stable"]
    ]
    over_base = modes.frf.quantity.over_base
    for number, mode in enumerate(modes.modes, start=1):
        rows.append(
            [
                str(number),
                *(reported_value.cells.ascii.with_error for reported_value in mode.mode.facts),
                *(
                    [f"{mode.phase_collinearity:.3f}", f"{mode.phase_deviation_deg:.2g}"]
                    if has_several_points
                    else [f"{mode.modal_mass:.4g}"]
                ),
                f"{mode.orders}/{modes.highest_order}",
            ]
        )
    band_frf = modes.frf.band(*modes.band)
    points_text = f" at each of {len(modes.points)} points" if modes.points else ""
    band_text = (
        f"  {len(band_frf.frequency)} frequency lines, {hertz(modes.band)}, of the "
        f"{modes.frf.quantity.label}{points_text}"
    )
    unit = ["  residues and masses are those of 1 kg on the base"] if over_base else []
    lines = [*(table(rows) if modes.modes else ()), band_text, *unit]
    if modes.points and modes.modes:
        lines += ["", *_format_shapes(modes), "", *_format_macs(modes)]
    if modes.matched_modes:
        lines += ["", *_format_matched_modes(modes)]
    return Text(lines)


def _format_shapes(measured_modes: MeasuredModes) -> list[str]:
    """Return every point's part in every mode, as magnitude and phase."""
    rows = [["point", *(f"mode {i + 1}" for i in range(len(measured_modes.modes)))]]
    for i, point in enumerate(measured_modes.points):
        values = [complex(mode.shape[i].real, mode.shape[i].imag) for mode in measured_modes.modes]
        rows.append(
            [point, *(f"{abs(v):.3f} {math.degrees(cmath.phase(v)):+4.0f} deg" for v in values)]
        )
    return table(rows)


def _format_macs(measured_modes: MeasuredModes) -> list[str]:
    """Modal assurance criterion of each mode with each."""
    numbers = [str(i + 1) for i in range(len(measured_modes.modes))]
    rows = [["MAC", *numbers]]
    rows += [[name, *(f"{value:.3f}" for value in row)]
             for name, row in zip(numbers, measured_modes.mac, strict=True)]  # fmt: skip
    return table(rows)


def _format_matched_modes(measured_modes: MeasuredModes) -> list[str]:
    """Return the modes common with another test."""
    rows = [["mode", "there", "frequency there, Hz", "change, %", "damping there, %", "MAC"]]
    for mode in measured_modes.matched_modes:
        change = mode.frequency_hz / measured_modes.modes[mode.mode - 1].frequency_hz - 1
        rows.append(
            [
                str(mode.mode),
                str(mode.other),
                f"{mode.frequency_hz:.5g}",
                f"{100 * change:+.2g}",
                f"{100 * mode.damping_ratio:.3g}",
                "" if mode.mac is None else f"{mode.mac:.3f}",
            ]
        )
    return table(rows)


def modes_by_mass(modes_by_mass: MassSeriesModes) -> Text:
    """Return main mode and stiffness under each mass, and the deviation of a common solid."""
    joint_modes = modes_by_mass.joint_modes
    modes = [["mass, g", "frequency, Hz", "damping ratio, %"]]
    rows = [["mass, g", "K', N/mm", "K'', N/mm", "model K', %", "model K'', %"]]
    pairs = zip(
        joint_modes.masses,
        joint_modes.modes,
        joint_modes.stiffness,
        joint_modes.spread,
        joint_modes.stiffness_at_poles,
        strict=True,
    )
    for mass, mode, k, se, solid in pairs:
        name = f"{convert_to_unit(mass, 'g'):.5g}"
        modes.append(
            [name, *(reported_value.cells.ascii.with_error for reported_value in mode.facts[:2])]
        )
        rows.append(
            [
                name,
                with_error(k.real, float(se[0]), "N/m"),
                with_error(k.imag, float(se[1]), "N/m"),
                f"{100 * (solid.real / k.real - 1):+.2f}",
                f"{100 * (solid.imag / k.imag - 1):+.2f}",
            ]
        )
    note = "  of one seal, at each pole; model: the linear one closest to all"
    return Text([*table(modes), "", *table(rows), note])
