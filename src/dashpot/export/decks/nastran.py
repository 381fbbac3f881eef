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
from dashpot.export.seal_line_springs import SpringRow, row_of
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
    r"""Bulk data for Nastran and OptiStruct: a bushing whose stiffness depends on frequency.

    ``"table"`` writes CBUSH, PBUSH and PBUSHT with K = K' and GE = K''/K' in TABLED1 (large
    field), for direct and modal frequency response (SOL 108, 111); ``"viscous-table"`` the same
    with B = K''/omega; ``"arms"`` the exact network of CELAS2 and CDAMP2 with an SPOINT inside
    each arm, for transient and complex modes (SOL 107, 109).

    Parameters
    ----------
    solid : Solid or Fit
    units : str
        ``"SI"``, ``"mm-t-s"`` or ``"mm-kg-ms"``.
    specimen, allow
        As in :func:`dashpot.export.deck_validation.open_deck`.
    form : str
    frequency_range : (float, float)
        Of the tables, Hz; by default the valid band of a fit, and 1 to 100 Hz of a bare solid.
    tolerance : float
        Largest relative error of the FRF of any mass that the tables may cause.
    nominal : float, optional
        Frequency, Hz, of the nominal K and GE of PBUSH, which normal modes use; if not given the
        geometric middle of a given range, else 10 Hz or the end of the valid band below it.
    line : Stations, optional
        Puts one CBUSH at each station of a seal line, each with its share of the stiffness, at its
        compression and its normal: needs the contact length that the model stands for. Without it
        there is one CBUSH at the origin.
    shear : Shear, optional
        What the seal of that line answers across it and along it: components 2 and 3.
    first_id : int
        First number given to grids, elements, properties, tables, coordinate systems.

    Raises
    ------
    ExportError
        If the deck must not be written.
    """
    frequency_range = si_range(frequency_range, "frequency")
    nominal = convert_to_si(nominal, "frequency")
    row = row_of(deck, line, shear)
    if deck.form == "arms":
        return _format_arms(deck, row, first_id)
    damping: Damping = "loss_factor" if deck.form == "table" else "damping"
    require_positive("--", nominal=nominal, unit=" Hz", optional=True)
    requested = frequency_range, tolerance
    return _format_tables(
        deck, row, requested=requested, damping=damping, nominal=nominal, first_id=first_id
    )


def _format_tables(
    deck: Deck,
    row: SpringRow,
    *,
    requested: tuple[tuple[float, float], float],
    damping: Damping,
    nominal: float | None,
    first_id: int,
) -> DeckText:
    at = nominal or float(np.sqrt(np.prod(requested[0])))
    properties: list[str] = []
    tables: list[Table] = []
    for shares, rank in row.shares.items():
        springs = row.springs(shares)
        frequency_tables = [
            deck.table(*requested, solid=solid, damping=damping, printed=_format_large_number)
            for _, solid in springs
        ]
        count = first_id + 2 * row.ways * rank
        rows = [
            _build_component(deck, way, solid, table, damping=damping, nominal=at)
            for (way, solid), table in zip(springs, frequency_tables, strict=True)
        ]
        properties += format_bush_property(count, rows, label="GE" if damping == "loss_factor" else "B")
        tables += frequency_tables
    acts = "the bushing acts along its x axis"
    if row.ways > 1:
        acts = "components 1 to 3 act normal to the line, across it and along it"
    return deck.format_text(
        "$",
        "frequency-dependent bushing for Nastran and OptiStruct",
        _name_continuations([*_format_bushings(row, first_id), *properties]),
        verified=_VERIFIED,
        remarks=[
            *row.remarks,
            f"nominal K and damping: those at {at:.6g} Hz; {acts}",
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
    deck: Deck, way: int, solid: Solid, table: Table, *, damping: Damping, nominal: float
) -> BushComponent:
    units = deck.units
    K = complex(solid.complex_stiffness(omega=2 * np.pi * nominal))
    nominal_damping, damped = K.imag / K.real, table.damping
    if damping == "damping":
        nominal_damping = units.damping(K.imag / (2 * np.pi * nominal))
        damped = units.damping(table.damping)
    return BushComponent(
        way + 1,
        units.frequency(table.frequency).tolist(),
        units.stiffness(table.storage).tolist(),
        damped.tolist(),
        (units.stiffness(K.real), nominal_damping),
    )


def format_bush_property(
    property_id: int, components: Sequence[BushComponent], *, label: str
) -> list[str]:
    """PBUSH, PBUSHT and their TABLED1, numbered from `property_id`; `label` is GE or B."""
    last = components[-1].number
    K, damped, K_table, damping_table = ([""] * last for _ in range(4))
    fields: list[list[float | str]] = [K, damped, K_table, damping_table]  # type: ignore[list-item]
    blank = [""] * (6 - last)
    tables = []
    for rank, component in enumerate(components):
        first, second = property_id + 2 * rank, property_id + 2 * rank + 1
        for row, value in zip(fields, (*component.nominal, first, second), strict=True):
            row[component.number - 1] = value
        tables += [
            *_format_tabled1(first, component.frequency, component.stiffness),
            *_format_tabled1(second, component.frequency, component.damping),
        ]
    return [
        # large: a small field holds four digits of a small number
        *_format_large_card("PBUSH*", [property_id, "K", *fields[0], *blank, "", label, *fields[1]]),
        _format_small_card("PBUSHT", property_id, "K", *fields[2]),
        _format_small_card("", "", label, *fields[3]),
        *tables,
    ]


def _format_frames(row: SpringRow, first_id: int) -> list[str]:
    cards: list[str] = []
    for (normal, _, along), rank in row.frames.items():
        cards += _format_coordinate_system(first_id + rank, normal, along)
    return cards


def _format_bushings(row: SpringRow, first_id: int) -> list[str]:
    cards = _format_frames(row, first_id)
    for i, station in enumerate(row.stations):
        a, b = row.nodes(i, first_id)
        for grid in (a, b):
            cards += _format_large_card("GRID*", [grid, "", *station.place])
        system = first_id + row.frames[station.frame] if station.frame in row.frames else 0
        count = first_id + 2 * row.ways * row.shares[station.shares]
        cards.append(_format_small_card("CBUSH", first_id + i, count, a, b, "", "", "", system))
    return cards


def _format_coordinate_system(number: int, normal: Sequence[float], along: Sequence[float]) -> list[str]:
    """CORD2R: a point on its z axis, along the line, and one on x, the normal, in the xz plane."""
    return _format_large_card("CORD2R*", [number, 0, 0.0, 0.0, 0.0, *along, *normal])


def _format_arms(deck: Deck, row: SpringRow, first_id: int) -> DeckText:
    cards, grid, element = _format_frames(row, first_id), first_id, itertools.count(first_id)
    for station in row.stations:
        a, b = grid, grid + 1
        # its own components are those of the line there
        system = [first_id + row.frames[station.frame]] if station.frame in row.frames else []
        for point in (a, b):
            cards += _format_large_card("GRID*", [point, "", *station.place, *system])
        grid = b + 1
        for way, solid in row.springs(station.shares):
            arms = deck.with_solid(solid)
            if arms.k_inf > 0:
                cards += _format_large_card("CELAS2*", [next(element), arms.k_inf, a, way + 1, b, way + 1])
            if arms.b > 0:
                cards += _format_large_card("CDAMP2*", [next(element), arms.b, a, way + 1, b, way + 1])
            for inner, (k, _, arm_b) in enumerate(arms.arms, start=grid):
                cards.append(_format_small_card("SPOINT", inner))
                cards += _format_large_card("CELAS2*", [next(element), k, a, way + 1, inner, ""])
                cards += _format_large_card("CDAMP2*", [next(element), arm_b, inner, "", b, way + 1])
            grid += len(arms.arms)
    format_procedures = find_handler("procedures", "solver input")
    verified, *more = format_procedures("nastran", "arms") if format_procedures else [_VERIFIED]
    acts = "the network acts along component 1 of its grids"
    if row.ways > 1:
        acts = "the networks act along components 1 to 3 of their grids, in whose own systems"
    return deck.format_text(
        "$",
        "network of springs and dashpots for Nastran and OptiStruct",
        _name_continuations(cards),
        verified=verified,
        remarks=[*more, *row.remarks, acts],
    )


def _format_tabled1(number: int, x: Iterable[float], y: Iterable[float]) -> list[str]:
    pairs = [value for pair in zip(x, y, strict=True) for value in pair]
    return _format_large_card("TABLED1*", [number, *[""] * 7, *pairs, "ENDT"])


def _format_large_card(name: str, fields: Sequence[float | str]) -> list[str]:
    """Return a large-field card: four fields of 16 columns a line, an even number of lines."""
    words = [_format_large_number(value) if isinstance(value, float) else str(value) for value in fields]
    rows = [words[i : i + 4] for i in range(0, len(words), 4)]
    rows += [[]] * (len(rows) % 2)
    heads = [name] + ["*"] * (len(rows) - 1)
    lines = [
        f"{head:<8}" + "".join(f"{word:>16}" for word in row)
        for head, row in zip(heads, rows, strict=True)
    ]
    return [f"{line:<72}*" for line in lines[:-1]] + [lines[-1].rstrip()]


def _name_continuations(lines: Sequence[str]) -> list[str]:
    """Return cards whose continuations have names, as Nastran before 2001 asks for them."""
    made = list(lines)
    names = (f"*S{number}" for number in itertools.count(1))
    for i, (line, following) in enumerate(itertools.pairwise(lines)):
        if line[72:] == "*":
            name = next(names)
            made[i] = made[i][:72] + name
            made[i + 1] = f"{name:<8}{following[8:]}"
    return made


def _format_small_card(name: str, *fields: float | str) -> str:
    words = [
        format_fixed_width(value, 8) if isinstance(value, float) else str(value) for value in fields
    ]
    return (f"{name:<8}" + "".join(f"{word:<8}" for word in words)).rstrip()


def _format_large_number(value: float) -> str:
    return f"{value:.9E}"
