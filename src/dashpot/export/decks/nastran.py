"""Nastran and OptiStruct bulk data."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from dashpot.base.errors import ExportError
from dashpot.base.units import Quantity, Range, si, si_range
from dashpot.export.deck import Deck, DeckText
from dashpot.export.frequency_tables import Damping, Table
from dashpot.export.notation import packed
from dashpot.export.opening import target
from dashpot.records.seal_line import SealSection, Stations

FORMS = ("table", "viscous-table", "arms")
SUFFIX = "bdf"
_VERIFIED = (
    "not solver-verified: no Nastran runs in dashpot's tests; an independent bulk-data reader "
    "reads such a deck back to the printed digits"
)


@target(*FORMS)
def nastran(
    deck: Deck,
    *,
    frequency_range: Range = (1.0, 100.0),
    tolerance: float = 1e-3,
    nominal: Quantity | None = None,
    line: Stations | None = None,
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
        As in :func:`dashpot.export.opening.open_deck`.
    form : str
    frequency_range : (float, float)
        Of the tables, Hz.
    tolerance : float
        Largest relative error of the FRF of any mass that the tables may cause.
    nominal : float, optional
        Frequency, Hz, of the nominal K and GE of PBUSH, which normal modes use; the geometric
        middle of the range if not given.
    line : Stations, optional
        Puts one CBUSH at each station of a :class:`~dashpot.records.seal_line.SealLine`, each with
        its share of the stiffness, at its compression and its normal: needs the contact length
        that the model stands for. Without it there is one CBUSH at the origin.
    first_id : int
        First number given to grids, elements, properties, tables, coordinate systems.

    Raises
    ------
    ExportError
        If the deck must not be written.
    """
    frequency_range, nominal = si_range(frequency_range, "frequency"), si(nominal, "frequency")
    row = _row_of(deck, line)
    if deck.form == "arms":
        return _arms(deck, row, first_id)
    damping: Damping = "loss_factor" if deck.form == "table" else "damping"
    at, asked = nominal or float(np.sqrt(np.prod(frequency_range))), (frequency_range, tolerance)
    return _table(deck, row, asked=asked, damping=damping, nominal=at, first_id=first_id)


@dataclass(frozen=True)
class _Standing:
    """Where one stands, deck units, and what it carries of the tested stiffness."""

    place: tuple[float, ...] = (0.0, 0.0, 0.0)
    normal: tuple[float, ...] = (1.0, 0.0, 0.0)
    share: float = 1.0


@dataclass(frozen=True)
class _BushRow:
    elements: tuple[_Standing, ...] = (_Standing(),)
    remarks: tuple[str, ...] = ()

    @property
    def shares(self) -> dict[float, int]:
        """Every share that there is, and its rank."""
        found = dict.fromkeys(one.share for one in self.elements)
        return {share: rank for rank, share in enumerate(found)}

    @property
    def normals(self) -> dict[tuple[float, ...], int]:
        """Every normal that is not the x axis, and its rank."""
        found = dict.fromkeys(one.normal for one in self.elements)
        turned = [normal for normal in found if not np.allclose(normal, (1.0, 0.0, 0.0))]
        return {normal: rank for rank, normal in enumerate(turned)}


def _row_of(deck: Deck, line: Stations | None) -> _BushRow:
    if line is None:
        return _BushRow()
    if deck.specimen.length is None:
        raise ExportError(
            "a seal line needs the contact length that the model stands for; give "
            "--length 100mm (Python: Specimen(length=...), m)"
        )
    unit, word = deck.units.length, deck.units.words[0]
    shares = line.factor * line.length / deck.specimen.length
    law = deck.elastic_law
    if line.compression is not None:
        shares = shares * SealSection(deck.solid, law).factor(line.compression)
    carried = shares > 0
    if not carried.any():
        raise ExportError("no station of the seal line touches: its compression is below 0 m")
    least, most = float(shares[carried].min()), float(shares.max())
    each = f"{least:.6g}" if least == most else f"{least:.6g} to {most:.6g}"
    remark = (
        f"seal line: {line.length.sum() / unit:.6g} {word}, {int(carried.sum())} elements of "
        f"{line.length[0] / unit:.6g} {word}, each with {each} of the stiffness above"
    )
    if not carried.all():
        remark += f"; {int((~carried).sum())} more do not touch and are left out"
    # shares that differ by rounding are one
    rows = zip(line.place / unit, line.normal, shares.tolist(), carried, strict=True)
    return _BushRow(
        tuple(
            _Standing(tuple(place.tolist()), tuple(np.round(normal, 9).tolist()), float(f"{s:.9g}"))
            for place, normal, s, touches in rows
            if touches
        ),
        (remark,),
    )


def _table(
    deck: Deck,
    row: _BushRow,
    *,
    asked: tuple[tuple[float, float], float],
    damping: Damping,
    nominal: float,
    first_id: int,
) -> DeckText:
    properties: list[str] = []
    for share, rank in row.shares.items():
        table = deck.table(*asked, share=share, damping=damping, printed=_large)
        own = first_id + 2 * rank
        properties += _property(deck, table, own, share=share, damping=damping, nominal=nominal)
    return deck.written(
        "$",
        "frequency-dependent bushing for Nastran and OptiStruct",
        [*_bushings(row, first_id), *properties],
        verified=_VERIFIED,
        remarks=[
            *row.remarks,
            f"nominal K and damping: those at {nominal:.6g} Hz; the bushing acts along its x axis",
        ],
        table=table,
    )


def _property(
    deck: Deck, table: Table, property_id: int, *, share: float, damping: Damping, nominal: float
) -> list[str]:
    """One share of the solid: its property and tables."""
    units = deck.units
    K = complex((deck.solid * share).complex_stiffness(omega=2 * np.pi * nominal))
    if damping == "loss_factor":
        label, nominal_damping, damped = "GE", K.imag / K.real, table.damping
    else:
        label, nominal_damping = "B", units.damping(K.imag / (2 * np.pi * nominal))
        damped = units.damping(table.damping)
    return bush_property(
        property_id,
        frequency=units.frequency(table.frequency).tolist(),
        stiffness=units.stiffness(table.storage).tolist(),
        damping=damped.tolist(),
        label=label,
        nominal=(units.stiffness(K.real), nominal_damping),
    )


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


def _bushings(row: _BushRow, first_id: int) -> list[str]:
    cards, shares, normals = [], row.shares, row.normals
    for normal, rank in normals.items():
        cards += _coordinates(first_id + rank, normal)
    for i, one in enumerate(row.elements):
        a, b = first_id + 2 * i, first_id + 2 * i + 1
        for grid in (a, b):
            cards += _card("GRID*", [grid, "", *one.place])
        system = first_id + normals[one.normal] if one.normal in normals else 0
        own = first_id + 2 * shares[one.share]
        cards.append(_small("CBUSH", first_id + i, own, a, b, "", "", "", system))
    return cards


def _coordinates(number: int, normal: Sequence[float]) -> list[str]:
    """CORD2R whose x axis is the normal: a point on z, and one on x in the xz plane."""
    x = np.array(normal) / np.linalg.norm(normal)
    z = np.cross(x, np.eye(3)[int(np.argmin(np.abs(x)))])
    z /= np.linalg.norm(z)
    values = [number, 0, 0.0, 0.0, 0.0, *z.tolist(), *x.tolist()]
    return _card("CORD2R*", values)


def _arms(deck: Deck, row: _BushRow, first_id: int) -> DeckText:
    per = 2 + 2 * deck.model.arms + 2
    cards: list[str] = []
    for i, one in enumerate(row.elements):
        a, b = first_id + per * i, first_id + per * i + 1
        for grid in (a, b):
            cards += _card("GRID*", [grid, "", *one.place])
        number = itertools.count(a)
        if deck.k_inf > 0:
            cards += _card("CELAS2*", [next(number), deck.k_inf * one.share, a, 1, b, 1])
        if deck.b > 0:
            cards += _card("CDAMP2*", [next(number), deck.b * one.share, a, 1, b, 1])
        for inner, (k, _, arm_b) in enumerate(deck.arms, start=b + 1):
            cards.append(_small("SPOINT", inner))
            cards += _card("CELAS2*", [next(number), k * one.share, a, 1, inner, ""])
            cards += _card("CDAMP2*", [next(number), arm_b * one.share, inner, "", b, 1])
    return deck.written(
        "$",
        "network of springs and dashpots for Nastran and OptiStruct",
        cards,
        verified=_VERIFIED,
        remarks=[*row.remarks, "the network acts along component 1 of its grids"],
    )


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
