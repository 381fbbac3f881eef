"""OpenSees commands, Tcl or Python."""

from __future__ import annotations

from dashpot.export.deck import Deck, DeckText
from dashpot.export.deck_validation import target
from dashpot.export.unit_systems import text

FORMS = ("python", "tcl")
SUFFIX = "txt"
VERIFIED = (
    "verified: OpenSeesPy runs these commands in dashpot's tests; the force of a ramp and hold is "
    "within 1e-5 of the model"
)
CYCLED = (
    "verified: OpenSeesPy runs these commands in dashpot's tests; loops of several amplitudes have "
    "the energy and the secant of the model within 1e-3"
)


@target(*FORMS)
def opensees(
    deck: Deck,
    *,
    first_tag: int = 1,
) -> DeckText:
    r"""OpenSees uniaxial materials: Elastic, Maxwell and Viscous, joined by Parallel.

    Sliders are ElasticPP, a cubic spring is ElasticMultiLinear.

    The Parallel material, which comes last, is the solid: give it to a zeroLength element. (A
    Series of Elastic and Viscous is not a Maxwell arm in OpenSees: its answer is wrong.)

    Parameters
    ----------
    solid, units, specimen, allow
        As in :func:`dashpot.export.nastran`.
    form : str
        ``"python"`` for OpenSeesPy, ``"tcl"`` for the interpreter.
    first_tag : int
        Tag of the first material; the others follow.
    """
    materials = []
    if deck.k_inf > 0:
        materials.append(["Elastic", text(deck.k_inf)])
    if deck.b > 0:
        materials.append(["Viscous", text(deck.b), "1."])
    # stiffness, viscosity, exponent of the dashpot, length
    materials += [["Maxwell", text(k), text(b), "1.", "1."] for k, _, b in deck.arms]
    materials += [["ElasticPP", text(k), text(x)] for k, _, x in deck.beside.sliders]
    if deck.beside.k3:
        x, F = zip(*deck.beside.both_ways(), strict=True)
        materials.append(
            ["ElasticMultiLinear", "0.", "-strain", *map(text, x), "-stress", *map(text, F)]
        )
    tags = [str(first_tag + i) for i in range(len(materials) + 1)]
    materials.append(["Parallel", *tags[:-1]])
    head, command = _WRITTEN[deck.form]
    commands = [
        *head,
        *(command(kind, tag, values) for tag, (kind, *values) in zip(tags, materials, strict=True)),
    ]
    return deck.written(
        "#",
        "uniaxial material for OpenSees",
        commands,
        verified=CYCLED if deck.beside.parts else VERIFIED,
        remarks=[
            f"material {tags[-1]} is the solid; in a zeroLength element it acts along one",
            "direction, force against displacement",
        ],
    )


def _argument(value: str) -> str:
    """As Python writes it: a flag is a text."""
    return repr(value) if value in {"-strain", "-stress"} else value


def _python(kind: str, tag: str, values: list[str]) -> str:
    return f"ops.uniaxialMaterial({', '.join([repr(kind), tag, *map(_argument, values)])})"


def _tcl(kind: str, tag: str, values: list[str]) -> str:
    return " ".join(["uniaxialMaterial", kind, tag, *values])


_WRITTEN = {"python": (("import openseespy.opensees as ops", ""), _python), "tcl": ((), _tcl)}
"""Of each form: what stands first, and how a material is written."""
