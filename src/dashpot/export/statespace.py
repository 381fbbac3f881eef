"""State-space matrices as an Octave and MATLAB script."""

from __future__ import annotations

from collections.abc import Collection

from dashpot.export.number_fields import text
from dashpot.export.open_deck import Solid, choose_form, open_deck
from dashpot.records.specimen import Specimen

FORMS = ("octave",)


def statespace(
    solid: Solid,
    *,
    units: str | None = None,
    specimen: Specimen | None = None,
    allow: Collection[str] = (),
    form: str = "octave",
) -> str:
    r"""State-space matrices of a solid, displacement in, force out.

    .. math::

        \dot y = A y + B x, \qquad F = C y + D x + E \dot x

    with one state per arm, the elongation of its dashpot: A = -diag(1/tau), B = 1/tau,
    C = -k, D = k_inf + sum k, E = b.

    Parameters are those of :func:`dashpot.export.nastran.nastran`.
    """
    choose_form(form, FORMS, "statespace")
    deck = open_deck(solid, units=units, specimen=specimen, allow=allow)
    rates = [1 / tau for _, tau, _ in deck.arms]
    through = deck.k_inf + sum(k for k, _, _ in deck.arms)
    header = deck.header(
        "%",
        "state space of the solid: displacement x in, force F out",
        remarks=[
            "dy/dt = A y + B x, F = C y + D x + E dx/dt; y is the elongation of each arm's dashpot",
        ],
    )
    row = " ".join(text(rate) for rate in rates)
    return "\n".join(
        [
            *header,
            f"A = -diag([{row}]);",
            f"B = [{'; '.join(text(rate) for rate in rates)}];",
            f"C = -[{' '.join(text(k) for k, _, _ in deck.arms)}];",
            f"D = {text(through)};",
            f"E = {text(deck.b)};",
            "",
        ]
    )
