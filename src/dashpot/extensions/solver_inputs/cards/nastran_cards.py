"""Nastran and OptiStruct bushes and MATVE materials."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.export.unit_systems import UnitSystem
from dashpot.extensions.solver_inputs.cards.card import (
    FrequencyTable,
    ViscoelasticCard,
    parse_number,
)
from dashpot.extensions.solver_inputs.cards.spring_network import Element, convert_network
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.part_geometry import RUBBER_POISSON_RATIO

Entry = tuple[str, list[str]]
"""Name of a bulk data entry, and its fields, eight for each line."""


def parse_bulk_data(text: str) -> Iterator[Entry]:
    """Yield the entries of bulk data in free, small (8 columns) and large (16 columns) field."""
    current: Entry | None = None
    is_half_line = False
    for raw in text.splitlines():
        line = raw.partition("$")[0].rstrip().expandtabs(8)
        if not line:
            continue
        head, fields, is_large_field = _split_line(line)
        is_continuation = not head or head[0] in "+*"
        if is_continuation and current is not None:
            if not (is_large_field and is_half_line):
                _pad_to_eight(current[1])
            current[1].extend(fields)
            is_half_line = is_large_field and not is_half_line
            continue
        if current is not None:
            yield current
        current, is_half_line = (head.rstrip("*").upper(), fields), is_large_field
    if current is not None:
        yield current


def _split_line(line: str) -> tuple[str, list[str], bool]:
    """Return the first field of a line, the data fields, and whether it is of large field."""
    if "," in line:
        head, *fields = [word.strip() for word in line.split(",")]
        is_large_field = "*" in head
        count = 4 if is_large_field else 8
        return head, (fields + [""] * count)[:count], is_large_field
    head = line[:8].strip()
    is_large_field = "*" in head
    width, count = (16, 4) if is_large_field else (8, 8)
    body = line[8:].ljust(width * count)
    return head, [body[i * width : (i + 1) * width].strip() for i in range(count)], is_large_field


def _pad_to_eight(fields: list[str]) -> None:
    fields.extend([""] * (-len(fields) % 8))


def read_nastran_cards(
    text: str, units: UnitSystem, component: int | None
) -> tuple[ViscoelasticCard, ...]:
    """Return the bushes and viscoelastic materials of bulk data.

    Parameters
    ----------
    text : str
    units : UnitSystem
    component : int, optional
        1 to 6 of the bushes; by default the first that has a stiffness.

    Raises
    ------
    ReadError
        If a property has only structural damping, a table is logarithmic, or a material has no
        Prony series.
    """
    entries = list(parse_bulk_data(text))
    tables = {fields[0]: _read_table(fields) for name, fields in entries if name == "TABLED1"}
    bushes = {fields[0]: _split_rows(fields) for name, fields in entries if name == "PBUSH"}
    by_frequency = {fields[0]: _split_rows(fields) for name, fields in entries if name == "PBUSHT"}
    cards = [
        _read_bush(pid, rows, by_frequency.get(pid, {}), tables, units=units, component=component)
        for pid, rows in bushes.items()
    ]
    elastic = {fields[0]: fields for name, fields in entries if name == "MAT1"}
    cards += [
        _read_material(name, fields, elastic)
        for name, fields in entries
        if name in {"MATVE", "MATFVE"}
    ]
    # next to a card, single springs belong to the surrounding structure
    return tuple(cards or _read_network(entries, component))


def _read_network(entries: Sequence[Entry], component: int | None) -> Iterator[ViscoelasticCard]:
    """Yield the model of springs and dashpots (CELAS2, CDAMP2) with an SPOINT in each arm."""
    inner_points = {word for name, fields in entries if name == "SPOINT" for word in fields if word}
    elements: dict[str, list[Element]] = {"CELAS2": [], "CDAMP2": []}
    for name, fields in entries:
        if name not in elements:
            continue
        number, value, *words = [*fields, *[""] * 8][:8]
        pairs = [(grid, direction or "0") for grid, direction in (words[:2], words[2:4])]
        directions = {
            int(direction) for grid, direction in pairs if grid and grid not in inner_points
        }
        if component is None or directions <= {component}:
            first, second = (
                grid if grid in inner_points else f"{grid or 'ground'} (component {direction})"
                for grid, direction in pairs
            )
            elements[name].append(Element((first, second), parse_number(value, f"{name} {number}")))
    springs, dashpots = elements.values()
    if not springs or not dashpots:
        return
    points = {point for element in (*springs, *dashpots) for point in element.points}
    keyword = "CELAS2 and CDAMP2"
    spring = convert_network(springs, dashpots, points - inner_points, keyword)
    yield ViscoelasticCard("arms", keyword, spring=spring)


def _read_table(fields: Sequence[str]) -> tuple[FloatArray, FloatArray] | str:
    """Return abscissae and ordinates of a TABLED1, or the reason why it is not read."""
    axes = [word.upper() for word in fields[1:3] if word]
    if any(axis != "LINEAR" for axis in axes):
        return f"TABLED1 {fields[0]} has axes {', '.join(axes)}; expected LINEAR"
    values = []
    for word in fields[8:]:
        if word.upper() == "ENDT":
            break
        if word and word.upper() != "SKIP":
            values.append(parse_number(word, f"TABLED1 {fields[0]}"))
    if len(values) % 2 or not values:
        return f"TABLED1 {fields[0]} has {len(values)} numbers; expected pairs"
    return np.array(values[::2]), np.array(values[1::2])


def _split_rows(fields: Sequence[str]) -> dict[str, list[str]]:
    """Return the six fields that follow each flag (K, B, GE) of a PBUSH or PBUSHT."""
    rows = {}
    for start in range(0, len(fields), 8):
        flag, *values = (list(fields[start + 1 : start + 8]) + [""] * 7)[:7]
        if flag:
            rows[flag.upper()] = values
    return rows


def _read_bush(
    pid: str,
    rows: dict[str, list[str]],
    table_ids: dict[str, list[str]],
    tables: dict[str, tuple[FloatArray, FloatArray] | str],
    *,
    units: UnitSystem,
    component: int | None,
) -> ViscoelasticCard:
    entry_text = f"PBUSH {pid}"
    stiffness_fields = rows.get("K", [""] * 6)
    stiffness_components = [i for i, word in enumerate(stiffness_fields, start=1) if word]
    index = (component or (stiffness_components or [1])[0]) - 1
    notes = [f"{entry_text}: only component {index + 1} is read, of {stiffness_components}"] * (
        len(stiffness_components) > 1
    )
    notes += [f"PBUSHT {pid}: the force over deflection (KN) is not read"] * ("KN" in table_ids)

    def constant(flag: str) -> float:
        word = rows.get(flag, [""] * 6)[index] or (rows.get(flag, [""])[0] if flag == "GE" else "")
        return parse_number(word or "0", entry_text)

    used_tables = {
        flag: tables.get(tid, f"TABLED1 {tid} is missing")
        for flag in ("K", "B", "GE")
        if (tid := table_ids.get(flag, [""] * 6)[index])
    }
    for table in used_tables.values():
        if isinstance(table, str):
            raise ReadError(f"PBUSHT {pid}: {table}")
    K, B, GE = (constant(flag) for flag in ("K", "B", "GE"))
    if not used_tables:
        if GE:
            raise ReadError(
                f"{entry_text} has structural damping GE = {GE:g} at all frequencies, which "
                "springs and dashpots cannot represent; expected tables (PBUSHT), or B"
            )
        return ViscoelasticCard(pid, "PBUSH", spring=GeneralizedMaxwell(K, b=B), notes=tuple(notes))
    f = np.unique(np.concatenate([table[0] for table in used_tables.values() if table[0].size]))  # type: ignore[union-attr]
    f = f[f > 0]

    def column(flag: str, value: float) -> FloatArray:
        table = used_tables.get(flag)
        if table is None:
            return np.full(len(f), value)
        return np.interp(f, table[0], table[1])  # type: ignore[arg-type]

    hertz = f / units.time
    storage = column("K", K) / units.stiffness(1.0)
    loss = storage * column("GE", GE)
    loss = loss + 2 * np.pi * hertz * column("B", B) / units.damping(1.0)
    return ViscoelasticCard(
        pid, "PBUSHT", table=FrequencyTable(hertz, storage + 1j * loss), notes=tuple(notes)
    )


def _read_material(name: str, fields: list[str], elastic: dict[str, list[str]]) -> ViscoelasticCard:
    """Return a MATVE: relative moduli of OptiStruct (PRONY), moduli of MSC (ISO, ISO1, LINEAR)."""
    material_id, model = fields[0], fields[1].upper()
    entry_text = f"{name} {material_id}"
    E, poisson = _read_mat1(elastic.get(material_id), entry_text)
    if model == "PRONY":
        words = [fields[2:6], *[fields[i : i + 2] for i in range(8, len(fields), 2)]]
        pairs = [words[0][:2], *words[1:5]], [words[0][2:4], *words[5:9]]
        shear, bulk = (_list_pairs(group, entry_text) for group in pairs)
        ratio_note = f"{entry_text}: its ratios are relative to the instantaneous modulus"
        card = ViscoelasticCard(
            material_id, f"{name}, PRONY", shear, bulk, E, poisson, notes=(ratio_note,)
        )
        return card.add_notes(*card.format_poisson_note())
    if model in {"ISO1", "LINEAR", ""}:
        words = [fields[i : i + 4] for i in range(8, len(fields), 8)]
        groups = [word[:2] for word in words], [word[2:4] for word in words]
    elif model == "ISO":
        pairs_of_line = [fields[i : i + 2] for i in range(8, len(fields), 2)]
        groups = [fields[4:6], *pairs_of_line[:4]], [fields[6:8], *pairs_of_line[4:8]]
    else:
        raise ReadError(
            f"{entry_text} has the model {model}, which is not read; expected PRONY (OptiStruct), "
            "ISO or ISO1"
        )
    if E is None:
        raise ReadError(
            f"{entry_text} holds moduli, but MAT1 {material_id} with the instantaneous modulus is "
            "missing"
        )
    G_0, K_0 = E / (2 * (1 + poisson)), E / (3 * (1 - 2 * poisson)) if poisson < 0.5 else 0.0
    shear = tuple((G / G_0, tau) for G, tau in _list_pairs(groups[0], entry_text))
    bulk = tuple((K / K_0, tau) for K, tau in _list_pairs(groups[1], entry_text)) if K_0 else ()
    card = ViscoelasticCard(material_id, f"{name}, {model or 'ISO1'}", shear, bulk, E, poisson)
    return card.add_notes(*card.format_poisson_note())


def _list_pairs(
    groups: Sequence[Sequence[str]], entry_text: str
) -> tuple[tuple[float, float], ...]:
    pairs = []
    for group in groups:
        value, time = ([*group, "", ""])[:2]
        if value:
            pairs.append((parse_number(value, entry_text), parse_number(time or "0", entry_text)))
    for modulus, tau in pairs:
        if not tau > 0:
            raise ReadError(
                f"{entry_text}: the relaxation time of {modulus:g} is {tau:g}; expected > 0"
            )
    return tuple(pairs)


def _read_mat1(fields: Sequence[str] | None, entry_text: str) -> tuple[float | None, float]:
    """Return Young's modulus and Poisson's ratio of a MAT1: E, G, NU, of which two suffice."""
    if fields is None:
        return None, RUBBER_POISSON_RATIO
    E, G, nu = (
        parse_number(word, f"MAT1 of {entry_text}") if word else None
        for word in (*fields, "", "")[1:4]
    )
    if nu is None:
        nu = E / (2 * G) - 1 if E is not None and G else RUBBER_POISSON_RATIO
    if E is None and G is not None:
        E = 2 * (1 + nu) * G
    return E, nu
