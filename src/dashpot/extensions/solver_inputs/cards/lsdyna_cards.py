"""LS-DYNA materials 006 and 076, and networks of discrete springs and dampers."""

from __future__ import annotations

from collections.abc import Iterator

from dashpot.base import dataclass
from dashpot.base.errors import ReadError
from dashpot.extensions.solver_inputs.cards.card import (
    ViscoelasticCard,
    convert_shear_to_young,
    parse_number,
)
from dashpot.solids.maxwell import GeneralizedMaxwell

_WIDTH = 10
_GENERAL = ("MAT_GENERAL_VISCOELASTIC", "MAT_076")
_SINGLE = ("MAT_VISCOELASTIC", "MAT_006")
_SPRINGS = ("MAT_SPRING_ELASTIC", "MAT_S01", "MAT_SPRING_MAXWELL", "MAT_S06", "MAT_DAMPER_VISCOUS",
            "MAT_S02")  # fmt: skip


@dataclass(frozen=True)
class KeywordBlock:
    """One keyword and its cards, lines of text without comments."""

    name: str
    lines: tuple[str, ...]

    def fields(self, index: int, width: int = _WIDTH) -> list[str]:
        """Return the fields of a card: by commas, or in fields of fixed width."""
        line = self.lines[index] if index < len(self.lines) else ""
        if "," in line:
            return [word.strip() for word in line.split(",")]
        return [line[i : i + width].strip() for i in range(0, max(len(line), 1), width)]

    def numbers(self, index: int) -> list[float]:
        """Return the fields of a card as numbers; a blank one is 0."""
        return [parse_number(word or "0", f"*{self.name}") for word in self.fields(index)]


def parse_blocks(text: str) -> Iterator[KeywordBlock]:
    """Yield the keywords of an LS-DYNA input; ``_TITLE`` and its line are taken off.

    A blank line is a card of defaults.
    """
    name = ""
    lines: list[str] = []
    for line in [*text.splitlines(), "*END"]:
        if line.startswith("$"):
            continue
        if line.startswith("*"):
            if name:
                title = name.endswith("_TITLE")
                yield KeywordBlock(
                    name.removesuffix("_TITLE"), tuple(lines[1:] if title else lines)
                )
            name, lines = line[1:].split()[0].upper(), []
        else:
            lines.append(line)


def read_lsdyna_cards(text: str) -> tuple[ViscoelasticCard, ...]:
    """Return the viscoelastic materials and networks of an LS-DYNA input.

    Raises
    ------
    ReadError
        If a material 076 holds a curve to be fitted.
    """
    blocks = list(parse_blocks(text))
    cards = [_read_general(block) for block in blocks if block.name in _GENERAL]
    cards += [_read_single(block) for block in blocks if block.name in _SINGLE]
    springs = {
        block.fields(0)[0]: (block.name, block.numbers(0)[1:])
        for block in blocks
        if block.name in _SPRINGS
    }
    return (*cards, *_read_network(blocks, springs))


def _read_general(block: KeywordBlock) -> ViscoelasticCard:
    first, second = (block.numbers(0) + [0.0] * 8)[:8], (block.numbers(1) + [0.0] * 8)[:8]
    name = f"material {block.fields(0)[0]}"
    if second[0] or second[4]:
        raise ReadError(
            f"*{block.name} of {name} holds a curve (LCID), which LS-DYNA fits; expected G and "
            "beta of each term"
        )
    terms, bulk_terms = [], []
    for index in range(2, len(block.lines)):
        G, beta, K, beta_k = (block.numbers(index) + [0.0] * 4)[:4]
        terms += [(G, beta)] * (G != 0)
        bulk_terms += [(K, beta_k)] * (K != 0)
    G_0 = sum(G for G, _ in terms)
    K_0 = first[2] + sum(K for K, _ in bulk_terms)
    if not G_0 > 0:
        raise ReadError(f"*{block.name} of {name} has no shear term G > 0")
    E, poisson = convert_shear_to_young(G_0, K_0)
    notes = [f"*{block.name} of {name}: TREF, A and B are not read"] * (any(first[5:8]))
    card = ViscoelasticCard(
        name,
        f"*{block.name}",
        tuple((G / G_0, 1 / beta) for G, beta in terms if beta > 0),
        tuple((K / K_0, 1 / beta) for K, beta in bulk_terms if beta > 0),
        E,
        poisson,
        notes=tuple(notes),
    )
    return card.add_notes(*card.format_poisson_note())


def _read_single(block: KeywordBlock) -> ViscoelasticCard:
    name = f"material {block.fields(0)[0]}"
    _, _, bulk, G_0, G_inf, beta = (block.numbers(0) + [0.0] * 6)[:6]
    if not (G_0 > 0 and beta > 0):
        raise ReadError(f"*{block.name} of {name}: expected G0 > 0 and BETA > 0")
    E, poisson = convert_shear_to_young(G_0, bulk)
    card = ViscoelasticCard(
        name, f"*{block.name}", (((G_0 - G_inf) / G_0, 1 / beta),), (), E, poisson
    )
    return card.add_notes(*card.format_poisson_note())


def _read_network(
    blocks: list[KeywordBlock], springs: dict[str, tuple[str, list[float]]]
) -> tuple[ViscoelasticCard, ...]:
    """Return the discrete elements of each pair of nodes as one model, in parallel."""
    materials: dict[str, str] = {}
    for block in blocks:
        if block.name == "PART":
            for index in range(1, len(block.lines), 2):
                pid, _, material_id = [*block.fields(index), "", "", ""][:3]
                materials[pid] = material_id
    pairs: dict[tuple[str, str, str], list[str]] = {}
    for block in blocks:
        if block.name == "ELEMENT_DISCRETE":
            for index in range(len(block.lines)):
                _, pid, a, b, vector = (block.fields(index, 8) + [""] * 5)[:5]
                if materials.get(pid) in springs:
                    pairs.setdefault((a, b, vector), []).append(materials[pid])
    if not pairs:
        return tuple(
            _build_network(f"material {material_id}", [item])
            for material_id, item in springs.items()
            if "MAXWELL" in item[0] or item[0] == "MAT_S06"
        )
    cards_by_key: dict[tuple[GeneralizedMaxwell | None, str], ViscoelasticCard] = {}
    for (a, b, vector), mids in pairs.items():
        card = _build_network(f"nodes {a} and {b}", [springs[material_id] for material_id in mids])
        # many stations of one line have the same springs
        cards_by_key.setdefault((card.spring, vector), card)
    return tuple(cards_by_key.values())


def _build_network(name: str, items: list[tuple[str, list[float]]]) -> ViscoelasticCard:
    k_inf, b = 0.0, 0.0
    arms = []
    for keyword, values in items:
        values = [*values, 0.0, 0.0, 0.0]  # noqa: PLW2901
        if keyword in {"MAT_SPRING_ELASTIC", "MAT_S01"}:
            k_inf += values[0]
        elif keyword in {"MAT_DAMPER_VISCOUS", "MAT_S02"}:
            b += values[0]
        else:
            k_0, k_end, beta = values[:3]
            if not (k_0 > k_end and beta > 0):
                raise ReadError(f"*{keyword} of {name}: expected K0 > KI and BETA > 0")
            k_inf += k_end
            arms.append((k_0 - k_end, 1 / beta))
    arms.sort(key=lambda arm: arm[1])
    spring = GeneralizedMaxwell(k_inf, tuple(k for k, _ in arms), tuple(tau for _, tau in arms), b)
    return ViscoelasticCard(name, "*MAT_SPRING_MAXWELL", spring=spring)
