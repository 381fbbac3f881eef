"""Transfer function for multibody codes such as Adams."""

from __future__ import annotations

import numpy as np

from dashpot.base.errors import ExportError
from dashpot.export.deck import Deck, DeckText
from dashpot.export.deck_validation import target
from dashpot.export.unit_systems import text
from dashpot.solids.networks import creep_of, parallel

FORMS = ("transfer-function",)
SUFFIX = "txt"


@target(*FORMS)
def adams(
    deck: Deck,
) -> DeckText:
    r"""K(s)/k_inf as a transfer function, for frequency-dependent bushings.

    A frequency-dependent bushing takes a linear stiffness times a displacement transfer
    function:

    .. math::

        K(s) = k_\infty \frac{\prod_i (1 + \lambda_i s)}{\prod_j (1 + \tau_j s)}
             = k_\infty \frac{a_0 + a_1 s + \dots}{b_0 + b_1 s + \dots}, \qquad a_0 = b_0 = 1

    The time constants above and below are the retardation and the relaxation times, found
    without a root of a polynomial. Both the factors and the coefficients are written: keep the
    factors where the times span many decades.

    Parameters are those of :func:`dashpot.export.nastran`.

    Raises
    ------
    ExportError
        If k_inf = 0: there is no static stiffness to factor out.
    """
    if not deck.model.k_inf > 0:
        raise ExportError(
            "k_inf = 0: a bushing of stiffness times transfer function needs a static stiffness; "
            "export the state space instead"
        )
    time = deck.units.words[2]
    merged = parallel(deck.model)  # arms of equal time are one factor
    lam = [value / deck.units.time for value in creep_of(merged).lam]
    tau = [value / deck.units.time for value in merged.tau]
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
            *(text(value) for value in _ascending(lam)),
            "[DENOMINATOR_COEFFICIENTS]",
            *(text(value) for value in _ascending(tau)),
        ],
        remarks=[
            "K(s) = stiffness * product(1 + lambda_i s) / product(1 + tau_j s); the coefficients",
            "are those of s^0, s^1, ...",
            "copy the numbers into the property file of your bushing: its layout differs between",
            "codes and versions, and is not written here",
        ],
    )


def _ascending(times: list[float]) -> list[float]:
    """Coefficients of product(1 + t s), from s^0 up."""
    polynomial = np.ones(1)
    for time in times:
        polynomial = np.convolve(polynomial, [1.0, time])
    return polynomial.tolist()
