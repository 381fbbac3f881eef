"""Modes of measured FRFs as text for people."""

from __future__ import annotations

import cmath
import math
from typing import TYPE_CHECKING

from dashpot.base.units import convert_to_unit
from dashpot.text_output.layout import Text, table
from dashpot.text_output.results import hertz, with_error

if TYPE_CHECKING:
    from dashpot.extensions.modes.mass_series_files import ModesByMass
    from dashpot.extensions.modes.measured_modes import MeasuredModes


def modes(found: MeasuredModes) -> Text:
    """Return each mode with its errors, where modes were sought, and of several points shapes."""
    several = bool(found.points)
    # the mass that moves is told by a point that is struck itself
    last = ["MPC", "MPD, deg"] if several else ["modal mass, kg"]
    rows = [["mode", "frequency, Hz", "damping ratio, %", "residue, m/(N s)", *last, "stable"]]
    over_base = found.frf.quantity.over_base
    for number, mode in enumerate(found.modes, start=1):
        rows.append(
            [
                str(number),
                *(fact.cells.ascii.with_error for fact in mode.mode.facts),
                *(
                    [f"{mode.phase_collinearity:.3f}", f"{mode.phase_deviation_deg:.2g}"]
                    if several
                    else [f"{mode.modal_mass:.4g}"]
                ),
                f"{mode.orders}/{found.highest_order}",
            ]
        )
    near = found.frf.band(*found.band)
    at = f" at each of {len(found.points)} points" if found.points else ""
    sought = f"  {len(near.frequency)} lines, {hertz(found.band)}, of the {found.frf.quantity}{at}"
    unit = ["  residues and masses are those of 1 kg on the base"] if over_base else []
    lines = [*(table(rows) if found.modes else ()), sought, *unit]
    if found.points and found.modes:
        lines += ["", *_shapes(found), "", *_macs(found)]
    if found.against:
        lines += ["", *_format_matched_modes(found)]
    return Text(lines)


def _shapes(found: MeasuredModes) -> list[str]:
    """Every point's part in every mode, as magnitude and phase."""
    rows = [["point", *(f"mode {i + 1}" for i in range(len(found.modes)))]]
    for i, point in enumerate(found.points):
        values = [complex(mode.shape[i].real, mode.shape[i].imag) for mode in found.modes]
        rows.append(
            [point, *(f"{abs(v):.3f} {math.degrees(cmath.phase(v)):+4.0f} deg" for v in values)]
        )
    return table(rows)


def _macs(found: MeasuredModes) -> list[str]:
    """Modal assurance criterion of each mode with each."""
    numbers = [str(i + 1) for i in range(len(found.modes))]
    rows = [["MAC", *numbers]]
    rows += [[name, *(f"{value:.3f}" for value in row)]
             for name, row in zip(numbers, found.mac, strict=True)]  # fmt: skip
    return table(rows)


def _format_matched_modes(found: MeasuredModes) -> list[str]:
    """The modes that another test has too."""
    rows = [["mode", "there", "frequency there, Hz", "change, %", "damping there, %", "MAC"]]
    for one in found.against:
        change = one.frequency_hz / found.modes[one.mode - 1].frequency_hz - 1
        rows.append(
            [
                str(one.mode),
                str(one.other),
                f"{one.frequency_hz:.5g}",
                f"{100 * change:+.2g}",
                f"{100 * one.damping_ratio:.3g}",
                "" if one.mac is None else f"{one.mac:.3f}",
            ]
        )
    return table(rows)


def modes_by_mass(found: ModesByMass) -> Text:
    """Return the main mode under each mass, the stiffness there, and how near one solid comes."""
    held = found.together
    modes = [["mass, g", "frequency, Hz", "damping ratio, %"]]
    at_poles = [["mass, g", "K', N/mm", "K'', N/mm", "model K', %", "model K'', %"]]
    each = zip(held.masses, held.modes, held.stiffness, held.spread, held.at_poles, strict=True)
    for mass, mode, k, se, solid in each:
        name = f"{convert_to_unit(mass, 'g'):.5g}"
        modes.append([name, *(fact.cells.ascii.with_error for fact in mode.facts[:2])])
        at_poles.append(
            [
                name,
                with_error(k.real, float(se[0]), "N/m"),
                with_error(k.imag, float(se[1]), "N/m"),
                f"{100 * (solid.real / k.real - 1):+.2f}",
                f"{100 * (solid.imag / k.imag - 1):+.2f}",
            ]
        )
    note = "  of one seal, at each pole; model: the linear one closest to all"
    return Text([*table(modes), "", *table(at_poles), note])
