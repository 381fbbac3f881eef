"""Modulus of a rod, as text."""

from __future__ import annotations

from dashpot.base.units import format_quantity
from dashpot.extensions.materials.rod.fit_files import Rod
from dashpot.text_output import results
from dashpot.text_output.layout import Text
from dashpot.text_output.results import format_error_sensitivity, hertz

_ROWS = 8
"""Lines of a rod that are shown."""
_ERRORS = ("phase", "gain")
"""Errors of the test whose effect on every line is listed."""


def rod(rod: Rod) -> Text:
    """Return the modulus of a rod over its usable band, its errors, and the fitted model."""
    modulus, factor = rod.modulus, rod.part.factor(bonded=rod.bonded)
    stiffer = factor * rod.part.height / rod.part.area
    ends_text = (
        f"bonded, so {stiffer:.4g} times as stiff as its material" if rod.bonded else "sliding"
    )
    lines = [
        (
            f"a rod of {format_quantity(rod.rod_mass, 'g')} under "
            f"{format_quantity(rod.mass, 'g')} "
            f"({rod.mass / rod.rod_mass:.3g} times its own), shape factor "
            f"{rod.part.shape_factor:.3g}: its ends are {ends_text}"
        )
    ]
    lines.append(
        f"  usable      {hertz(modulus.band)}: storage and loss factor are known to 10 %"
        if modulus.usable.any()
        else "  usable      nowhere"
    )
    lines += _format_lines(rod, _ROWS, ())
    if rod.fit is None:
        lines.append(f"  No model was fitted: {rod.reason}")
        return Text(lines, _format_lines(rod, len(modulus.frequency)))
    fit_text = results.render_fit(rod.fit)
    details = ["every line", *_format_lines(rod, len(modulus.frequency))]
    return Text([*lines, *fit_text.lines], [*fit_text.details, *details])


def _format_lines(rod: Rod, lines_shown: int, errors: tuple[str, ...] = _ERRORS) -> list[str]:
    return format_error_sensitivity(rod.modulus, errors=errors, unit="Pa", line_count=lines_shown)
