"""What ``dashpot fit`` found, as text."""

from __future__ import annotations

from dashpot import workflow
from dashpot.base.units import format_quantity
from dashpot.text_output import results as text_of
from dashpot.text_output.frequency_table import sensitive
from dashpot.text_output.layout import Text
from dashpot.text_output.results import hertz

_ROWS = 8
"""Lines of a rod that are shown."""
_ERRORS = ("phase", "gain")
"""Of the test, what small ones do to every line."""


def rod(found: workflow.Rod) -> Text:
    """Return the modulus of a rod over its usable band, what errors do to it, and the solid."""
    of, factor = found.modulus, found.part.factor(bonded=found.bonded)
    stiffer = factor * found.part.height / found.part.area
    ends = f"bonded, so {stiffer:.4g} times as stiff as its material" if found.bonded else "sliding"
    lines = [
        (
            f"a rod of {format_quantity(found.own_mass, 'g')} under "
            f"{format_quantity(found.mass, 'g')} "
            f"({found.mass / found.own_mass:.3g} times its own), shape factor "
            f"{found.part.shape_factor:.3g}: its ends are {ends}"
        )
    ]
    lines.append(
        f"  usable      {hertz(of.band)}: storage and loss factor are known to 10 %"
        if of.usable.any()
        else "  usable      nowhere"
    )
    lines += _lines(found, _ROWS, ())
    if found.fit is None:
        lines.append(f"  No model was fitted: {found.reason}")
        return Text(lines, _lines(found, len(of.frequency)))
    fitted = text_of.fit(found.fit)
    details = ["every line", *_lines(found, len(of.frequency))]
    return Text([*lines, *fitted.lines], [*fitted.details, *details])


def _lines(found: workflow.Rod, shown: int, errors: tuple[str, ...] = _ERRORS) -> list[str]:
    return sensitive(found.modulus, errors=errors, unit="Pa", shown=shown)
