"""Nastran and OptiStruct bulk data."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

import numpy as np

from dashpot.base.errors import ExportError
from dashpot.export.deck import Deck
from dashpot.export.frequency_tables import Damping, Table, tabulate
from dashpot.export.number_fields import packed
from dashpot.export.open_deck import Solid, choose_form, open_deck
from dashpot.records.specimen import Specimen
from dashpot.seals.line import SealLine
from dashpot.solids.maxwell import GeneralizedMaxwell

FORMS = ("table", "viscous-table", "arms")
_VERIFIED = (
    "not solver-verified: no Nastran runs in dashpot's tests; an independent bulk-data reader "
    "reads such a deck back to the printed digits"
)


def nastran(
    solid: Solid,
    *,
    units: str | None = None,
    specimen: Specimen | None = None,
    allow: Collection[str] = (),
    form: str = "table",
    frequency_range: tuple[float, float] = (1.0, 100.0),
    tolerance: float = 1e-3,
    nominal: float | None = None,
    line: SealLine | None = None,
    first_id: int = 1,
) -> str:
    r"""Bulk data for Nastran and OptiStruct: a bushing whose stiffness depends on frequency.

    ``"table"`` writes CBUSH, PBUSH and PBUSHT with K = K' and GE = K''/K' in TABLED1 (large
    field), for direct and modal frequency response (SOL 108, 111); ``"viscous-table"`` the same
    with B = K''/omega; ``"arms"`` the exact network of CELAS2 and CDAMP2 with an SPOINT inside
    each arm, for transient and complex modes (SOL 107, 109).

    Parameters
    ----------
    solid : GeneralizedMaxwell or Fit
    units : str
        ``"SI"``, ``"mm-t-s"`` or ``"mm-kg-ms"``.
    specimen, allow
        As in :func:`dashpot.export.open_deck.open_deck`.
    form : str
    frequency_range : (float, float)
        Of the tables, Hz.
    tolerance : float
        Largest relative error of the FRF of any mass that the tables may cause.
    nominal : float, optional
        Frequency, Hz, of the nominal K and GE of PBUSH, which normal modes use; the geometric
        middle of the range if not given.
    line : SealLine, optional
        Puts one CBUSH at each station, each with its share of the stiffness: needs the contact
        length that the model stands for. Without it there is one CBUSH at the origin.
    first_id : int
        First number given to grids, elements, properties, tables, coordinate systems.

    Raises
    ------
    ExportError
        If the deck must not be written.
    """
    choose_form(form, FORMS, "nastran")
    deck = open_deck(solid, units=units, specimen=specimen, allow=allow)
    scale = _share(deck, line)
    if form == "arms":
        return _arms(deck, scale, line, first_id)
    return _table(
        deck,
        deck.model * scale,
        line=line,
        first_id=first_id,
        damping="loss_factor" if form == "table" else "damping",
        frequency_range=frequency_range,
        tolerance=tolerance,
        nominal=nominal,
    )


def _table(
    deck: Deck,
    model: GeneralizedMaxwell,
    *,
    line: SealLine | None,
    first_id: int,
    damping: Damping,
    frequency_range: tuple[float, float],
    tolerance: float,
    nominal: float | None,
) -> str:
    units = deck.units
    table = tabulate(
        model,
        frequency_range=frequency_range,
        tolerance=tolerance,
        damping=damping,
        edges=deck.band or (),
        rounded=lambda value: float(_large(value)),
    )
    at = nominal or float(np.sqrt(frequency_range[0] * frequency_range[1]))
    header = deck.header(
        "$",
        "frequency-dependent bushing for Nastran and OptiStruct",
        verified=_VERIFIED,
        remarks=[
            *_line_remarks(deck, line),
            table.says,
            *_marks(deck, table),
            f"nominal K and damping: those at {at:.6g} Hz; the bushing acts along its x axis",
        ],
    )
    K = complex(model.complex_stiffness(2 * np.pi * at))
    if damping == "loss_factor":
        label, nominal_damping, damped = "GE", K.imag / K.real, table.damping.tolist()
    else:
        label, nominal_damping = "B", units.damping(K.imag / (2 * np.pi * at))
        damped = [units.damping(b) for b in table.damping.tolist()]
    properties = bush_property(
        first_id,
        frequency=[units.frequency(f) for f in table.frequency.tolist()],
        stiffness=[units.stiffness(k) for k in table.storage.tolist()],
        damping=damped,
        label=label,
        nominal=(units.stiffness(K.real), nominal_damping),
    )
    return "\n".join([*header, *_bushings(deck, line, first_id), *properties, ""])


def bush_property(
    property_id: int,
    *,
    frequency: Sequence[float],
    stiffness: Sequence[float],
    damping: Sequence[float],
    label: str,
    nominal: tuple[float, float],
) -> list[str]:
    """PBUSH, PBUSHT and their two TABLED1, numbered from `property_id`; `label` is GE or B."""
    first, second = property_id, property_id + 1
    return [
        _small("PBUSH", property_id, "K", nominal[0]),
        _small("", "", label, nominal[1]),
        _small("PBUSHT", property_id, "K", first),
        _small("", "", label, second),
        *_tabled1(first, frequency, stiffness),
        *_tabled1(second, frequency, damping),
    ]


def _share(deck: Deck, line: SealLine | None) -> float:
    """How much of the tested stiffness one element carries."""
    if line is None:
        return 1.0
    if deck.specimen.length is None:
        raise ExportError(
            "a seal line needs the contact length that the model stands for; give "
            "specimen=Specimen(length=...) in m (command line: --length 100mm)"
        )
    return line.piece / deck.specimen.length


def _line_remarks(deck: Deck, line: SealLine | None) -> list[str]:
    if line is None:
        return []
    unit, word = deck.units.length, deck.units.words[0]
    share = _share(deck, line)
    pieces = f"{line.elements} elements of {line.piece / unit:.6g} {word}"
    length = f"{line.length / unit:.6g} {word}"
    return [f"seal line: {length}, {pieces}, each with {share:.6g} of the stiffness above"]


def _marks(deck: Deck, table: Table) -> list[str]:
    """Which rows of the table the test says nothing of."""
    if deck.band is None:
        return []
    outside = [f for f in table.frequency.tolist() if deck.extrapolated(f)]
    if not outside:
        return []
    count = f"{len(outside)} of {len(table.frequency)} rows"
    return [f"EXTRAPOLATED: {count}, from {min(outside):.6g} to {max(outside):.6g} Hz"]


def _stations(deck: Deck, line: SealLine | None) -> list[tuple[float, float, float]]:
    if line is None:
        return [(0.0, 0.0, 0.0)]
    return [(x, y, z) for x, y, z in (line.stations() / deck.units.length).tolist()]


def _bushings(deck: Deck, line: SealLine | None, first_id: int) -> list[str]:
    cards = []
    system: int | str = 0
    if line is not None and not np.allclose(line.normal, (1.0, 0.0, 0.0)):
        system = first_id
        cards += _coordinates(system, line.normal)
    for i, place in enumerate(_stations(deck, line)):
        a, b = first_id + 2 * i, first_id + 2 * i + 1
        for grid in (a, b):
            cards += _card("GRID*", [grid, "", *place])
        cards.append(_small("CBUSH", first_id + i, first_id, a, b, "", "", "", system))
    return cards


def _coordinates(number: int, normal: Sequence[float]) -> list[str]:
    """CORD2R whose x axis is the normal: a point on z, and one on x in the xz plane."""
    x = np.array(normal) / np.linalg.norm(normal)
    z = np.cross(x, np.eye(3)[int(np.argmin(np.abs(x)))])
    z /= np.linalg.norm(z)
    values = [number, 0, 0.0, 0.0, 0.0, *z.tolist(), *x.tolist()]
    return _card("CORD2R*", values)


def _arms(deck: Deck, scale: float, line: SealLine | None, first_id: int) -> str:
    header = deck.header(
        "$",
        "network of springs and dashpots for Nastran and OptiStruct",
        verified=_VERIFIED,
        remarks=[*_line_remarks(deck, line), "the network acts along component 1 of its grids"],
    )
    stations = _stations(deck, line)
    per = 2 + 2 * deck.model.arms + 2
    cards: list[str] = []
    for i, place in enumerate(stations):
        a, b = first_id + per * i, first_id + per * i + 1
        for grid in (a, b):
            cards += _card("GRID*", [grid, "", *place])
        element = iter(range(a, a + per))
        if deck.k_inf > 0:
            cards += _element("CELAS2*", next(element), deck.k_inf * scale, (a, 1), (b, 1))
        if deck.b > 0:
            cards += _element("CDAMP2*", next(element), deck.b * scale, (a, 1), (b, 1))
        for j, (k, _, arm_b) in enumerate(deck.arms):
            inner = b + 1 + j
            cards.append(_small("SPOINT", inner))
            cards += _element("CELAS2*", next(element), k * scale, (a, 1), (inner, ""))
            cards += _element("CDAMP2*", next(element), arm_b * scale, (inner, ""), (b, 1))
    return "\n".join([*header, *cards, ""])


def _element(
    name: str, number: int, value: float, a: tuple[int, int | str], b: tuple[int, int | str]
) -> list[str]:
    return _card(name, [number, value, *a, *b])


def _tabled1(number: int, x: Iterable[float], y: Iterable[float]) -> list[str]:
    pairs = [value for pair in zip(x, y, strict=True) for value in pair]
    return _card("TABLED1*", [number, *[""] * 7, *pairs, "ENDT"])


def _card(name: str, fields: Sequence[float | str]) -> list[str]:
    """A large-field card: four fields of 16 columns a line, an even number of lines."""
    words = [_large(value) if isinstance(value, float) else str(value) for value in fields]
    rows = [words[i : i + 4] for i in range(0, len(words), 4)]
    rows += [[]] * (len(rows) % 2)
    heads = [name] + ["*"] * (len(rows) - 1)
    lines = [
        f"{head:<8}" + "".join(f"{word:>16}" for word in row)
        for head, row in zip(heads, rows, strict=True)
    ]
    return [f"{line:<72}*" for line in lines[:-1]] + [lines[-1].rstrip()]


def _small(name: str, *fields: float | str) -> str:
    words = [packed(value, 8) if isinstance(value, float) else str(value) for value in fields]
    return (f"{name:<8}" + "".join(f"{word:<8}" for word in words)).rstrip()


def _large(value: float) -> str:
    return f"{value:.9E}"
