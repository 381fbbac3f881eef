"""Ansys materials with ``TB,PRONY``."""

from __future__ import annotations

from dataclasses import dataclass, field

from dashpot.base.errors import ReadError
from dashpot.extensions.solver_inputs.cards.card import (
    ViscoelasticCard,
    convert_shear_to_young,
    parse_number,
)
from dashpot.solids.part_geometry import RUBBER_POISSON_RATIO
from dashpot.solids.shift_laws import GAS_CONSTANT, WLF, Arrhenius, TemperatureLaw


@dataclass
class _Material:
    """Elastic constants and tables of one material, by name and option."""

    elastic: dict[str, float] = field(default_factory=dict)
    tables: dict[tuple[str, str], list[float]] = field(default_factory=dict)
    counts: dict[tuple[str, str], int] = field(default_factory=dict)
    temperatures: dict[tuple[str, str], int] = field(default_factory=dict)


def read_ansys_cards(text: str) -> tuple[ViscoelasticCard, ...]:
    """Return the viscoelastic materials of Ansys Mechanical APDL commands.

    Raises
    ------
    ReadError
        If a table has an odd number of constants, a wrong count of pairs, or names of parameters.
    """
    materials: dict[str, _Material] = {}
    table: list[float] | None = None
    key, owner = ("", ""), _Material()
    last = 0
    for line in text.splitlines():
        for command in line.partition("!")[0].split("$"):
            words = [word.strip() for word in command.split(",")]
            name = words[0].upper()
            if name in {"MP", "MPDATA"} and len(words) > 3:
                at = 3 if name == "MP" else 4
                label, number = words[1].upper(), words[2] or "1"
                if label in _ELASTIC and len(words) > at and words[at]:
                    material = materials.setdefault(number, _Material())
                    material.elastic[label] = parse_number(words[at], f"{name},{label},{number}")
            elif name == "TB":
                words += [""] * 6
                label, number, option = words[1].upper(), words[2] or "1", words[5].upper()
                owner, key, last = materials.setdefault(number, _Material()), (label, option), 0
                table = owner.tables.setdefault(key, [])
                if words[4].isdecimal():
                    owner.counts[key] = int(words[4])
            elif name == "TBTEMP" and table is not None:
                owner.temperatures[key] = owner.temperatures.get(key, 0) + 1
            elif name == "TBDATA" and table is not None and owner.temperatures.get(key, 1) == 1:
                start = int(parse_number(words[1], "TBDATA")) if words[1:2] != [""] else last + 1
                values = words[2:]
                while values and not values[-1]:
                    values.pop()
                numbers = [parse_number(value or "0", f"TBDATA of {key[0]}") for value in values]
                last = start + len(numbers) - 1
                table.extend([0.0] * (last - len(table)))
                table[start - 1 : last] = numbers
    return tuple(
        _build_card(number, material)
        for number, material in materials.items()
        if any(label == "PRONY" for label, _ in material.tables)
    )


_ELASTIC = ("EX", "NUXY", "PRXY", "GXY")


def _build_card(number: str, material: _Material) -> ViscoelasticCard:
    relative = _pair_terms(number, material, "SHEAR")
    bulk = _pair_terms(number, material, "BULK")
    if not relative and not bulk:
        relative = _pair_terms(number, material, "")
    notes = [
        f"TB,{label} of material {number}: its first temperature alone is read"
        for (label, _), count in material.temperatures.items()
        if count > 1
    ]
    modulus, poisson, modulus_notes = _read_elasticity(number, material)
    law, shifts = _read_shift(number, material)
    card = ViscoelasticCard(
        number, "TB,PRONY", relative, bulk, modulus, poisson, law=law,
        notes=(*notes, *modulus_notes, *shifts),
    )  # fmt: skip
    return card.add_notes(*card.format_poisson_note())


def _pair_terms(number: str, material: _Material, option: str) -> tuple[tuple[float, float], ...]:
    key = ("PRONY", option)
    values = material.tables.get(key, [])
    if len(values) % 2:
        raise ReadError(
            f"TB,PRONY,{number} {option} has {len(values)} constants; expected pairs of relative "
            "modulus and time"
        )
    pairs = list(zip(values[::2], values[1::2], strict=True))
    stated_count = material.counts.get(key)
    if stated_count is not None and stated_count != len(pairs):
        raise ReadError(
            f"TB,PRONY,{number} {option} says {stated_count} pairs and has {len(pairs)}; a TBDATA "
            "is missing, or overwrites another"
        )
    for share, tau in pairs:
        if share and not tau > 0:
            raise ReadError(f"TB,PRONY,{number} {option}: the time of {share:g} is {tau:g}")
    return tuple(pair for pair in pairs if pair[0])


def _read_elasticity(number: str, material: _Material) -> tuple[float | None, float, list[str]]:
    elastic = material.elastic
    poisson = elastic.get("PRXY", elastic.get("NUXY"))
    if "EX" in elastic:
        note = f"material {number} has no Poisson's ratio; it is taken as 0.3, as Ansys does"
        return elastic["EX"], 0.3 if poisson is None else poisson, [note] * (poisson is None)
    for (label, option), values in material.tables.items():
        if label != "HYPER":
            continue
        if option.startswith("NEO"):
            shear = values[0]
        elif option.startswith("MOON"):
            shear = 2 * (values[0] + values[1])
        elif option.startswith("YEOH"):
            shear = 2 * values[0]
        elif option.startswith("OGDEN"):
            terms = material.counts.get((label, option), 1)
            pairs = values[: 2 * terms]
            shear = sum(mu * alpha for mu, alpha in zip(pairs[::2], pairs[1::2], strict=True)) / 2
        else:
            return None, RUBBER_POISSON_RATIO, [f"TB,HYPER,{option} is not read: give --modulus"]
        return *convert_shear_to_young(shear, 0.0), []
    return None, RUBBER_POISSON_RATIO, []


def _read_shift(number: str, material: _Material) -> tuple[TemperatureLaw | None, list[str]]:
    for (label, option), values in material.tables.items():
        if label != "SHIFT":
            continue
        if option.startswith("WLF") and len(values) >= 3 and values[0] > 150:
            note = f"TB,SHIFT of material {number}: its temperatures are taken as K"
            return WLF(values[1], values[2], values[0]), [note]
        if option.startswith("TN") and len(values) >= 2 and values[0] > 150:
            note = f"TB,SHIFT of material {number}: its temperatures are taken as K"
            return Arrhenius(values[1] * GAS_CONSTANT, values[0]), [note]
        note = (
            f"TB,SHIFT,{option or '?'} of material {number} is not read; expected WLF or TN with a "
            "reference in K"
        )
        return None, [note]
    return None, []
