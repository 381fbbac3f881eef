"""Nastran and OptiStruct bulk data."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence

import numpy as np

from dashpot.base import dataclass
from dashpot.base.units import Quantity, Range, convert_to_si, si_range
from dashpot.base.value_ranges import require_positive
from dashpot.datamodel.seal_line import Shear, Stations
from dashpot.export.deck import Deck, DeckText
from dashpot.export.deck_validation import target
from dashpot.export.frequency_tables import Damping, Table
from dashpot.export.seal_line_springs import SpringRow, make_springs
from dashpot.export.unit_systems import format_fixed_width
from dashpot.registry import find_handler
from dashpot.solids.maxwell import Solid

FORMS = ("table", "viscous-table", "arms")
_TABLES = FORMS[:2]
SUFFIX = "bdf"
_VERIFIED = (
    "not solver-verified: no Nastran runs this form in dashpot's tests; an independent bulk-data "
    "reader reads such a deck back to the printed digits"
)


@target(*FORMS, line=FORMS, frequency_range=_TABLES, tolerance=_TABLES, nominal=_TABLES)
def nastran(
    deck: Deck,
    *,
    frequency_range: Range = (1.0, 100.0),
    tolerance: float = 1e-3,
    nominal: Quantity | None = None,
    line: Stations | None = None,
    shear: Shear | None = None,
    first_id: int = 1,
) -> DeckText:
    r"""Return Nastran and OptiStruct bulk data of a bushing with stiffness over frequency.

    ``"table"`` writes CBUSH, PBUSH and PBUSHT with K = K' and GE = K''/K' in TABLED1 (large
    field), for direct and modal frequency response (SOL 108, 111); ``"viscous-table"`` the same
    with B = K''/omega; ``"arms"`` the exact network of CELAS2 and CDAMP2 with an SPOINT inside
    each arm, for transient and complex modes (SOL 107, 109).

    Parameters
    ----------
    solid : Solid or Fit
    units : str
        ``"SI"``, ``"mm-t-s"``, ``"mm-kg-ms"`` or ``"in-lbf-s"``.
    specimen, allow
        As in :func:`dashpot.export.deck_validation.open_deck`.
    form : str
    frequency_range : (float, float)
        Frequency range of the tables, Hz; by default the valid band of a fit, and 1 to 100 Hz of a
        bare solid.
    tolerance : float
        Largest relative error of the FRF of any mass that the tables may cause.
    nominal : float, optional
        Frequency, Hz, of the nominal K and GE of PBUSH, which normal modes use; if not given the
        geometric middle of a given range, else 10 Hz or the end of the valid band below it.
    line : Stations, optional
        Puts one CBUSH at each station of a seal line, each with its share of the stiffness, at its
        compression and its normal: needs the contact length of the model. Without it there is one
        CBUSH at the origin.
    shear : Shear, optional
        Stiffness of the seal of that line across it and along it: components 2 and 3.
    first_id : int
        First number given to grids, elements, properties, tables, coordinate systems.

    Raises
    ------
    ExportError
        If the deck must not be written.
    """
    frequency_range = si_range(frequency_range, "frequency")
    nominal = convert_to_si(nominal, "frequency")
    row = make_springs(deck, line, shear)
    if deck.form == "arms":
        return _format_arms(deck, row, first_id)
    damping: Damping = "loss_factor" if deck.form == "table" else "damping"
    require_positive("--", nominal=nominal, unit=" Hz", optional=True)
    table_range = frequency_range, tolerance
    return _format_tables(
        deck, row, table_range=table_range, damping=damping, nominal=nominal, first_id=first_id
    )


def _format_tables(
    deck: Deck,
    row: SpringRow,
    *,
    table_range: tuple[tuple[float, float], float],
    damping: Damping,
    nominal: float | None,
    first_id: int,
) -> DeckText:
    nominal_frequency = nominal or float(np.sqrt(np.prod(table_range[0])))
    properties: list[str] = []
    tables: list[Table] = []
    for shares, index in row.shares.items():
        direction_solids = row.springs(shares)
        frequency_tables = [
            deck.table(
                *table_range, solid=solid, damping=damping, format_number=_format_large_number
            )
            for _, solid in direction_solids
        ]
        property_id = first_id + 2 * row.direction_count * index
        components = [
            _build_component(
                deck, direction, solid, table, damping=damping, nominal=nominal_frequency
            )
            for (direction, solid), table in zip(direction_solids, frequency_tables, strict=True)
        ]
        properties += format_bush_property(
            property_id, components, label="GE" if damping == "loss_factor" else "B"
        )
        tables += frequency_tables
    direction_remark = "the bushing acts along its x axis"
    if row.direction_count > 1:
        direction_remark = "components 1 to 3 act normal to the line, across it and along it"
    return deck.format_text(
        "$",
        "frequency-dependent bushing for Nastran and OptiStruct",
        _name_continuations([*_format_bushings(row, first_id), *properties]),
        verified=_VERIFIED,
        remarks=[
            *row.comments,
            f"nominal K and damping: those at {nominal_frequency:.6g} Hz; {direction_remark}",
        ],
        table=max(tables, key=lambda table: table.error),
        nominal=nominal,
    )


@dataclass(frozen=True)
class BushComponent:
    """One direction of a bushing in deck units: its table, PBUSH stiffness and damping."""

    number: int
    frequency: Sequence[float]
    stiffness: Sequence[float]
    damping: Sequence[float]
    nominal: tuple[float, float]


def _build_component(
    deck: Deck, direction: int, solid: Solid, table: Table, *, damping: Damping, nominal: float
) -> BushComponent:
    units = deck.units
    K = complex(solid.complex_stiffness(omega=2 * np.pi * nominal))
    nominal_damping, table_damping = K.imag / K.real, table.damping
    if damping == "damping":
        nominal_damping = units.damping(K.imag / (2 * np.pi * nominal))
        table_damping = units.damping(table.damping)
    return BushComponent(
        direction + 1,
        units.frequency(table.frequency).tolist(),
        units.stiffness(table.storage).tolist(),
        table_damping.tolist(),
        (units.stiffness(K.real), nominal_damping),
    )


def format_bush_property(
    property_id: int, components: Sequence[BushComponent], *, label: str
) -> list[str]:
    """Return PBUSH, PBUSHT and TABLED1 cards, numbered from `property_id`; `label` is GE or B."""
    last_number = components[-1].number
    K, damping, K_table, damping_table = ([""] * last_number for _ in range(4))
    fields: list[list[float | str]] = [K, damping, K_table, damping_table]  # type: ignore[list-item]
    blank = [""] * (6 - last_number)
    tables = []
    for index, component in enumerate(components):
        stiffness_id, damping_id = property_id + 2 * index, property_id + 2 * index + 1
        for row, value in zip(fields, (*component.nominal, stiffness_id, damping_id), strict=True):
            row[component.number - 1] = value
        tables += [
            *_format_tabled1(stiffness_id, component.frequency, component.stiffness),
            *_format_tabled1(damping_id, component.frequency, component.damping),
        ]
    return [
        # large fields: a small field keeps four digits of a small number
        *_format_large_card(
            "PBUSH*", [property_id, "K", *fields[0], *blank, "", label, *fields[1]]
        ),
        _format_small_card("PBUSHT", property_id, "K", *fields[2]),
        _format_small_card("", "", label, *fields[3]),
        *tables,
    ]


def _format_frames(row: SpringRow, first_id: int) -> list[str]:
    cards: list[str] = []
    for (normal, _, along), index in row.frames.items():
        cards += _format_coordinate_system(first_id + index, normal, along)
    return cards


def _format_bushings(row: SpringRow, first_id: int) -> list[str]:
    cards = _format_frames(row, first_id)
    for i, station in enumerate(row.stations):
        grid_a, grid_b = row.nodes(i, first_id)
        for grid in (grid_a, grid_b):
            cards += _format_large_card("GRID*", [grid, "", *station.position])
        system = first_id + row.frames[station.frame] if station.frame in row.frames else 0
        property_id = first_id + 2 * row.direction_count * row.shares[station.shares]
        cards.append(
            _format_small_card(
                "CBUSH", first_id + i, property_id, grid_a, grid_b, "", "", "", system
            )
        )
    return cards


def _format_coordinate_system(
    system_id: int, normal: Sequence[float], z_axis: Sequence[float]
) -> list[str]:
    """Return a CORD2R card: z along the line, x along the normal."""
    return _format_large_card("CORD2R*", [system_id, 0, 0.0, 0.0, 0.0, *z_axis, *normal])


def _format_arms(deck: Deck, row: SpringRow, first_id: int) -> DeckText:
    cards, next_grid = _format_frames(row, first_id), first_id
    element_ids = itertools.count(first_id)
    for station in row.stations:
        grid_a, grid_b = next_grid, next_grid + 1
        # the components of the grids are those of the line at this station
        system = [first_id + row.frames[station.frame]] if station.frame in row.frames else []
        for point in (grid_a, grid_b):
            cards += _format_large_card("GRID*", [point, "", *station.position, *system])
        next_grid = grid_b + 1
        for direction, solid in row.springs(station.shares):
            deck_solid, component = deck.with_solid(solid), direction + 1
            if deck_solid.k_inf > 0:
                cards += _format_large_card(
                    "CELAS2*",
                    [next(element_ids), deck_solid.k_inf, grid_a, component, grid_b, component],
                )
            if deck_solid.b > 0:
                cards += _format_large_card(
                    "CDAMP2*",
                    [next(element_ids), deck_solid.b, grid_a, component, grid_b, component],
                )
            for inner_grid, (k, _, arm_b) in enumerate(deck_solid.arms, start=next_grid):
                cards.append(_format_small_card("SPOINT", inner_grid))
                cards += _format_large_card(
                    "CELAS2*", [next(element_ids), k, grid_a, component, inner_grid, ""]
                )
                cards += _format_large_card(
                    "CDAMP2*", [next(element_ids), arm_b, inner_grid, "", grid_b, component]
                )
            next_grid += len(deck_solid.arms)
    format_procedures = find_handler("procedures", "solver input")
    verified, *procedure_remarks = (
        format_procedures("nastran", "arms") if format_procedures else [_VERIFIED]
    )
    direction_remark = "the network acts along component 1 of its grids"
    if row.direction_count > 1:
        direction_remark = (
            "the networks act along components 1 to 3 of their grids, in whose own systems"
        )
    return deck.format_text(
        "$",
        "network of springs and dashpots for Nastran and OptiStruct",
        _name_continuations(cards),
        verified=verified,
        remarks=[*procedure_remarks, *row.comments, direction_remark],
    )


def _format_tabled1(table_id: int, x: Iterable[float], y: Iterable[float]) -> list[str]:
    pairs = [value for pair in zip(x, y, strict=True) for value in pair]
    return _format_large_card("TABLED1*", [table_id, *[""] * 7, *pairs, "ENDT"])


def _format_large_card(name: str, fields: Sequence[float | str]) -> list[str]:
    """Return a large-field card: four fields of 16 columns a line, an even number of lines."""
    words = [
        _format_large_number(value) if isinstance(value, float) else str(value) for value in fields
    ]
    rows = [words[i : i + 4] for i in range(0, len(words), 4)]
    rows += [[]] * (len(rows) % 2)
    row_names = [name] + ["*"] * (len(rows) - 1)
    lines = [
        f"{row_name:<8}" + "".join(f"{word:>16}" for word in row)
        for row_name, row in zip(row_names, rows, strict=True)
    ]
    return [f"{line:<72}*" for line in lines[:-1]] + [lines[-1].rstrip()]


def _name_continuations(lines: Sequence[str]) -> list[str]:
    """Return cards with named continuations, which Nastran before 2001 requires."""
    named_lines = list(lines)
    names = (f"*S{number}" for number in itertools.count(1))
    for i, (line, next_line) in enumerate(itertools.pairwise(lines)):
        if line[72:] == "*":
            name = next(names)
            named_lines[i] = named_lines[i][:72] + name
            named_lines[i + 1] = f"{name:<8}{next_line[8:]}"
    return named_lines


def _format_small_card(name: str, *fields: float | str) -> str:
    words = [
        format_fixed_width(value, 8) if isinstance(value, float) else str(value) for value in fields
    ]
    return (f"{name:<8}" + "".join(f"{word:<8}" for word in words)).rstrip()


def _format_large_number(value: float) -> str:
    return f"{value:.9E}"
