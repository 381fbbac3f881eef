"""Ansys Mechanical APDL input."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.base.errors import ExportError
from dashpot.export.beside import CARRIERS
from dashpot.export.deck import Deck, DeckText
from dashpot.export.notation import text
from dashpot.export.opening import target
from dashpot.export.shift import ansys_shift

FORMS = ("arms", "prony")
SUFFIX = "mac"
_MOST_POINTS = 20


@target(*FORMS)
def ansys(
    deck: Deck,
) -> DeckText:
    r"""Mechanical APDL commands of a solid.

    ``"arms"`` writes the exact network of COMBIN14 springs and dampers acting along UX, for any
    analysis; sliders are COMBIN40, a cubic spring is COMBIN39, for transient ones.
    ``"prony"`` writes a TB,PRONY table of relative shear moduli alpha_j = k_j/k_0 and times, for
    transient and full harmonic analyses, and ``TB,SHIFT`` where the fit has a temperature law.

    Parameters are those of :func:`dashpot.export.nastran`.
    """
    return _prony(deck) if deck.form == "prony" else _arms(deck)


def _arms(deck: Deck) -> DeckText:
    nodes = ["N,1,0,0,0", "N,2,0,0,0", *(f"N,{11 + j},0,0,0" for j in range(deck.model.arms))]
    elements: list[tuple[float, float, int, int]] = []  # K, CV1, I, J
    # a COMBIN39 must rise at its origin, as a cubic spring does not: it carries k_inf too
    k_inf = 0.0 if deck.beside.k3 else deck.k_inf
    if k_inf > 0 or deck.b > 0:
        elements.append((k_inf, deck.b, 1, 2))
    for j, (k, _, b) in enumerate(deck.arms):
        elements += [(k, 0.0, 2, 11 + j), (0.0, b, 11 + j, 1)]
    cards = ["/PREP7", "ET,1,COMBIN14", "KEYOPT,1,2,1", *nodes, "TYPE,1"]
    for number, (k, c, i, j) in enumerate(elements, start=1):
        cards += [f"R,{number},{text(k)},{text(c)}", f"REAL,{number}", f"E,{i},{j}"]
    cards += _beside(deck, 1 + len(elements))
    return deck.written(
        "!",
        "network of springs and dampers for Ansys Mechanical APDL",
        [*cards, "FINISH"],
        remarks=[
            "node 1 is the ground side, node 2 the moving side, one inner node in each arm; all",
            "act along UX of the nodes (KEYOPT(2) = 1), wherever the nodes stand",
            *["COMBIN40: K1, C, M, GAP = 0, FSLIDE: slides both ways"] * bool(deck.beside.sliders),
            *["COMBIN39: k_inf and the cubic spring in one, from 0; it is reflected"]
            * bool(deck.beside.k3),
        ],
    )


def _beside(deck: Deck, number: int) -> list[str]:
    """Sliders, and k_inf with the cubic spring: a curve of 20 points at most, from 0 up."""
    cards = []
    if deck.beside.sliders:
        cards += ["ET,2,COMBIN40", "TYPE,2"]
    for k, F, _ in deck.beside.sliders:
        cards += [f"R,{number},{text(k)},0.,0.,0.,{text(F)},0.", f"REAL,{number}", "E,1,2"]
        number += 1
    if not deck.beside.k3:
        return cards
    curve = deck.beside.curve(_MOST_POINTS - 1, k=deck.k_inf)
    if not curve[1][1] > 0:
        raise ExportError(
            "COMBIN39 must rise at its origin, and beside a spring that softens there is no k_inf "
            "that makes it; those that hold such: --to "
            f"{', '.join(one for one in CARRIERS if one != 'ansys')}"
        )
    values = [text(value) for pair in curve for value in pair]
    cards += ["ET,3,COMBIN39", "TYPE,3", f"R,{number},{','.join(values[:6])}"]
    cards += [f"RMORE,{','.join(values[at : at + 6])}" for at in range(6, len(values), 6)]
    return [*cards, f"REAL,{number}", "E,1,2"]


def _prony(deck: Deck) -> DeckText:
    rows = tbdata([value for pair in deck.prony for value in pair])
    shift, says = ansys_shift(deck.temperatures)
    return deck.written(
        "!",
        "material of relative moduli for Ansys Mechanical APDL",
        [f"TB,PRONY,1,1,{deck.model.arms},SHEAR", *rows, *shift],
        remarks=[
            "alpha_j = k_j / k_0 refers to the instantaneous modulus: the elastic constants of",
            "material 1 are the instantaneous ones",
            "repeat the table with BULK in place of SHEAR for a sponge, which keeps its Poisson",
            "ratio as it relaxes",
            *says,
        ],
    )


def tbdata(values: Sequence[float]) -> list[str]:
    """The rows of a table, six numbers a row."""
    return [
        f"TBDATA,{start + 1}," + ",".join(map(text, values[start : start + 6]))
        for start in range(0, len(values), 6)
    ]
