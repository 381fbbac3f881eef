"""State-space matrices as an Octave and MATLAB script."""

from __future__ import annotations

from dashpot.export.deck import Deck, DeckText
from dashpot.export.deck_validation import target
from dashpot.export.unit_systems import text

FORMS = ("octave",)
SUFFIX = "m"


@target(*FORMS)
def statespace(
    deck: Deck,
) -> DeckText:
    r"""State-space matrices of a solid, displacement in, force out.

    .. math::

        \dot y = A y + B x, \qquad F = C y + D x + E \dot x

    with one state per arm, the elongation of its dashpot: A = -diag(1/tau), B = 1/tau,
    C = -k, D = k_inf + sum k, E = b.

    Parameters are those of :func:`dashpot.export.nastran`.
    """
    rates = [text(1 / tau) for _, tau, _ in deck.arms]
    return deck.format_text(
        "%",
        "state space of the model: displacement x in, force F out",
        [
            f"A = -diag([{' '.join(rates)}]);",
            f"B = [{'; '.join(rates)}];",
            f"C = -[{' '.join(text(k) for k, _, _ in deck.arms)}];",
            f"D = {text(deck.k_inf + sum(k for k, _, _ in deck.arms))};",
            f"E = {text(deck.b)};",
        ],
        remarks=[
            "dy/dt = A y + B x, F = C y + D x + E dx/dt; y is the elongation of each arm's dashpot",
        ],
    )
