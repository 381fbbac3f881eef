"""Transfer function and bushing property file for multibody codes such as Adams."""

from __future__ import annotations

import numpy as np

from dashpot.base.errors import ExportError
from dashpot.base.units import Quantity, convert_to_si
from dashpot.base.value_ranges import require_positive
from dashpot.export.deck import Deck, DeckText
from dashpot.export.deck_validation import NOMINAL, target
from dashpot.export.unit_systems import text
from dashpot.solids.networks import creep_of, parallel

FORMS = ("transfer-function", "bus")
SUFFIX = "txt"
_AXES = ("FX", "FY", "FZ", "TX", "TY", "TZ")
_CURVE_LENGTH = 0.02
"""Length to either side that the curve of a bushing spans, m."""
_LENGTHS = {"SI": "meter", "mm-t-s": "mm"}
"""Words of the property file for lengths of the unit systems with newton and second."""


@target(*FORMS, nominal=("bus",))
def adams(
    deck: Deck,
    *,
    nominal: Quantity | None = None,
) -> DeckText:
    r"""K(s)/k_inf as a transfer function, or a bushing property file at one frequency.

    ``"bus"`` is a property file of a bushing along x: a force curve of the slope K' and the damping
    K''/omega at the frequency `nominal`. It is exact only at that frequency.

    ``"transfer-function"`` is for frequency-dependent bushings. Such a bushing takes a linear
    stiffness times a displacement transfer function:

    .. math::

        K(s) = k_\infty \frac{\prod_i (1 + \lambda_i s)}{\prod_j (1 + \tau_j s)}
             = k_\infty \frac{a_0 + a_1 s + \dots}{b_0 + b_1 s + \dots}, \qquad a_0 = b_0 = 1

    The time constants above and below are the retardation and the relaxation times, found
    without a root of a polynomial. Both the factors and the coefficients are written: keep the
    factors where the times span many decades.

    Parameters
    ----------
    solid, units, specimen, allow
        As in :func:`dashpot.export.nastran`.
    form : str
    nominal : float, optional
        Hz, for ``"bus"``; by default 10 Hz, or the end of the valid band below it.

    Raises
    ------
    ExportError
        If k_inf = 0: there is no static stiffness to factor out.
    """
    if deck.form == "bus":
        at = convert_to_si(nominal, "frequency")
        require_positive("--", nominal=at, unit=" Hz", optional=True)
        return _write_bushing(deck, at or min(NOMINAL, (deck.band or (0.0, NOMINAL))[1]))
    if not deck.model.k_inf > 0:
        raise ExportError(
            "k_inf = 0: a bushing of stiffness times transfer function needs a static stiffness; "
            "export the state space instead"
        )
    time = deck.units.words[2]
    merged_model = parallel(deck.model)  # arms of equal time are one factor
    lam = [value / deck.units.time for value in creep_of(merged_model).lam]
    tau = [value / deck.units.time for value in merged_model.tau]
    return deck.format_text(
        "$",
        "transfer function K(s) / k_inf of a frequency-dependent bushing",
        [
            "[STIFFNESS]",
            f"linear_stiffness = {text(deck.k_inf)}",
            f"[NUMERATOR_TIMES]  $ lambda_i, {time}",
            *(text(value) for value in lam),
            f"[DENOMINATOR_TIMES]  $ tau_j, {time}",
            *(text(value) for value in tau),
            "[NUMERATOR_COEFFICIENTS]",
            *(text(value) for value in _expand_product(lam)),
            "[DENOMINATOR_COEFFICIENTS]",
            *(text(value) for value in _expand_product(tau)),
        ],
        remarks=[
            "K(s) = stiffness * product(1 + lambda_i s) / product(1 + tau_j s); the coefficients",
            "are those of s^0, s^1, ...",
            "copy the numbers into the property file of your bushing: its layout differs between",
            "codes and versions, and is not written here",
        ],
    )


def _expand_product(times: list[float]) -> list[float]:
    """Coefficients of product(1 + t s), from s^0 up."""
    polynomial = np.ones(1)
    for time in times:
        polynomial = np.convolve(polynomial, [1.0, time])
    return polynomial.tolist()


def _write_bushing(deck: Deck, nominal: float) -> DeckText:
    units, omega = deck.units, 2 * np.pi * nominal
    if units.name not in _LENGTHS:
        raise ExportError(
            f"a bushing property file is written in newton and second; found {units.name}: take "
            f"--unit-system {' or '.join(_LENGTHS)}"
        )
    stiffness = complex(deck.solid.complex_stiffness(omega=omega))
    slopes = {"FX": units.stiffness(stiffness.real)}
    damping = {"FX": units.damping(stiffness.imag / omega)}
    return deck.format_text(
        "$",
        "bushing property file",
        [
            *(
                "[MDI_HEADER]",
                " FILE_TYPE = 'bus'",
                " FILE_VERSION = 4.0",
                " FILE_FORMAT = 'ASCII'",
            ),
            *("[UNITS]", f" LENGTH = '{_LENGTHS[units.name]}'", " ANGLE = 'degrees'"),
            *(" FORCE = 'newton'", " MASS = 'kg'", " TIME = 'second'"),
            "[DAMPING]",
            *(f" {axis}_DAMPING = {text(damping.get(axis, 0.0))}" for axis in _AXES),
            *(
                line
                for axis in _AXES
                for line in _format_curve(axis, slopes.get(axis, 0.0), units.length)
            ),
        ],
        nominal=nominal,
        remarks=[
            f"stiffness and damping of {nominal:.6g} Hz along x, and none in other directions:",
            "right at that frequency alone; --form transfer-function holds all frequencies",
        ],
    )


def _format_curve(axis: str, slope: float, length: float) -> list[str]:
    """Return the block of a straight force or torque curve through zero."""
    is_force_axis = axis.startswith("F")
    max_abscissa = _CURVE_LENGTH / length if is_force_axis else 180.0
    rows = [f" {text(x)} {text(slope * x + 0.0)}" for x in (-max_abscissa, 0.0, max_abscissa)]
    return [f"[{axis}_CURVE]", f"{{ {'x' if is_force_axis else 'ang'} {axis.lower()} }}", *rows]
