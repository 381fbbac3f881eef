"""OpenSees commands, Tcl or Python."""

from __future__ import annotations

from collections.abc import Collection

from dashpot.export.number_fields import text
from dashpot.export.open_deck import Solid, choose_form, open_deck
from dashpot.records.specimen import Specimen

FORMS = ("python", "tcl")
VERIFIED = (
    "verified: OpenSeesPy runs these commands in dashpot's tests; the force of a ramp and hold is "
    "within 1e-5 of the model"
)


def opensees(
    solid: Solid,
    *,
    units: str | None = None,
    specimen: Specimen | None = None,
    allow: Collection[str] = (),
    form: str = "python",
    first_tag: int = 1,
) -> str:
    r"""OpenSees uniaxial materials: Elastic, Maxwell and Viscous, joined by Parallel.

    The Parallel material, which comes last, is the solid: give it to a zeroLength element. (A
    Series of Elastic and Viscous is not a Maxwell arm in OpenSees: its answer is wrong.)

    Parameters
    ----------
    solid, units, specimen, allow
        As in :func:`dashpot.export.nastran.nastran`.
    form : str
        ``"python"`` for OpenSeesPy, ``"tcl"`` for the interpreter.
    first_tag : int
        Tag of the first material; the others follow.
    """
    choose_form(form, FORMS, "opensees")
    deck = open_deck(solid, units=units, specimen=specimen, allow=allow)
    materials: list[tuple[str, list[str]]] = []
    if deck.k_inf > 0:
        materials.append(("Elastic", [text(deck.k_inf)]))
    if deck.b > 0:
        materials.append(("Viscous", [text(deck.b), "1."]))
    # stiffness, viscosity, exponent of the dashpot, length
    materials += [("Maxwell", [text(k), text(b), "1.", "1."]) for k, _, b in deck.arms]
    commands = [
        ("uniaxialMaterial", kind, str(first_tag + i), *values)
        for i, (kind, values) in enumerate(materials)
    ]
    tags = [str(first_tag + i) for i in range(len(materials))]
    whole = str(first_tag + len(materials))
    commands.append(("uniaxialMaterial", "Parallel", whole, *tags))
    header = deck.header(
        "#",
        "uniaxial material for OpenSees",
        verified=VERIFIED,
        remarks=[
            f"material {whole} is the solid; in a zeroLength element it acts along one",
            "direction, force against displacement",
        ],
    )
    if form == "tcl":
        return "\n".join([*header, *(" ".join(command) for command in commands), ""])
    calls = [f"ops.{name}({', '.join([repr(kind), *values])})" for name, kind, *values in commands]
    return "\n".join([*header, "import openseespy.opensees as ops", "", *calls, ""])
