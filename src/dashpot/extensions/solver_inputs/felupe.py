"""FElupe material as Python text."""

from __future__ import annotations

from dashpot.base.units import Quantity, convert_to_si
from dashpot.base.value_ranges import require_positive
from dashpot.export.deck import Deck, DeckText
from dashpot.export.deck_validation import target
from dashpot.export.unit_systems import text

FORMS = ("prony",)
SUFFIX = "txt"
_RUBBER = 1000.0
"""Bulk modulus of rubber over its shear modulus."""
NEEDS = {"prony": ("modulus",)}


@target(*FORMS)
def felupe(
    deck: Deck,
    *,
    modulus: Quantity | None = None,
    bulk_modulus: Quantity | None = None,
) -> DeckText:
    r"""FElupe small-strain material: ``linear_elastic_viscoelastic``, exact for each straight step.

    FElupe takes the long-term shear modulus :math:`\mu` and Lamé's :math:`\lambda` with it, and
    absolute moduli :math:`G_j = G_0 k_j/k_0` of the deviatoric arms. The bulk modulus does not
    relax: :math:`\lambda = K - 2\mu/3`. The written function takes the step of the job, for the
    material knows no time.

    Parameters
    ----------
    solid, units, specimen, allow
        As in :func:`dashpot.export.nastran`.
    form : str
        ``"prony"``.
    modulus : float
        Instantaneous shear modulus G_0 of the rubber, Pa: a part's stiffness does not give it.
    bulk_modulus : float, optional
        Pa; by default that of rubber, 1000 G_0.
    """
    from dashpot.extensions.solver_inputs.procedures import format_procedures

    modulus, bulk_modulus = convert_to_si(modulus, "stress"), convert_to_si(bulk_modulus, "stress")
    long_term, terms = deck.shear(modulus, "FElupe")
    require_positive(bulk_modulus=bulk_modulus, unit=" Pa", optional=True)
    bulk = _RUBBER * (modulus or 0.0) if bulk_modulus is None else bulk_modulus
    lame = deck.units.stress(bulk) - 2 / 3 * long_term
    verified, *further_remarks = format_procedures("felupe", "prony")
    return deck.format_text(
        "#",
        "small-strain material for FElupe",
        [
            "import felupe as fem",
            "",
            f"MU, LAME = {text(long_term)}, {text(lame)}",
            f"G = [{', '.join(text(G) for G, _ in terms)}]",
            f"TAU = [{', '.join(text(1 / beta) for _, beta in terms)}]",
            "",
            "",
            "def make_material(step):",
            "    return fem.MaterialStrain(",
            "        material=fem.linear_elastic_viscoelastic,",
            "        statevars=((len(G), 3, 3),),",
            # the arguments of FElupe are the Greek letters lambda, mu, tau and Delta
            '        **{"\\u03bb": LAME, "\\u03bc": MU, "G": G, "\\u03c4": TAU, "\\u0394t": step},',
            "    )",
        ],
        verified=verified,
        remarks=[
            *further_remarks,
            "MU is the long-term shear modulus; the moduli G add to it, and the bulk modulus is",
            f"constant; `step` is the time step of the job, in {deck.units.words[2]}",
        ],
    )
