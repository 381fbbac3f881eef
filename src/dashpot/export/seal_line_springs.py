"""Springs of a deck: one at the origin, or three at each station of a line."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.base.errors import ExportError
from dashpot.datamodel.seal_line import SealSection, Shear, Stations
from dashpot.export.deck import Deck
from dashpot.solids.maxwell import Solid

DIRECTION_NAMES = ("normal to the line", "across it", "along it")
"""The springs of a station, in the order of every deck: components 1, 2 and 3."""
_DIGITS = 12
"""Digits of a direction: frames that differ by rounding count as equal."""
_X = (1.0, 0.0, 0.0)


@dataclass(frozen=True)
class LineStation:
    """Station of a line: position of a pair of nodes, and the springs between them.

    Attributes
    ----------
    position : (float, float, float)
        Deck units.
    frame : tuple of three directions
        Orthonormal directions: normal, across and along.
    shares : (float, float, float)
        Share of the solid in each direction; 0 for no spring.
    """

    position: tuple[float, ...] = (0.0, 0.0, 0.0)
    frame: tuple[tuple[float, ...], ...] = (_X, (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    shares: tuple[float, float, float] = (1.0, 0.0, 0.0)


@dataclass(frozen=True)
class SpringRow:
    """Springs of a deck.

    Attributes
    ----------
    solids : (Solid, Solid, Solid)
        Model of each direction, SI; a station has its share of it.
    stations : tuple of LineStation
    comments : tuple of str
        Lines of the header on the springs.
    """

    solids: tuple[Solid, Solid, Solid]
    stations: tuple[LineStation, ...] = (LineStation(),)
    comments: tuple[str, ...] = ()

    @cached_property
    def shares(self) -> dict[tuple[float, float, float], int]:
        """Rank of each distinct set of shares."""
        entries = dict.fromkeys(station.shares for station in self.stations)
        return {shares: rank for rank, shares in enumerate(entries)}

    @cached_property
    def frames(self) -> dict[tuple[tuple[float, ...], ...], int]:
        """Rank of each distinct frame in which a spring acts off the global x axis."""
        entries = dict.fromkeys(station.frame for station in self.stations)
        rotated_frames = [
            frame for frame in entries if self.direction_count > 1 or not np.allclose(frame[0], _X)
        ]
        return {frame: rank for rank, frame in enumerate(rotated_frames)}

    @cached_property
    def direction_count(self) -> int:
        """Number of directions of a station: 1 without lateral stiffness, else 3."""
        return 3 if any(any(station.shares[1:]) for station in self.stations) else 1

    def nodes(self, station: int, first_id: int) -> tuple[int, int]:
        """Return the two coincident nodes of a station: on the body or frame, and on the door."""
        return first_id + 2 * station, first_id + 2 * station + 1

    def format_node_numbering(self, first_id: int) -> str:
        """Return the lines of the header that explain the numbers of the nodes."""
        last = self.nodes(len(self.stations) - 1, first_id)[1]
        return (
            f"nodes {first_id} to {last}, two at each place: the first is the ground side, the "
            "second the moving side"
        )

    def springs(self, shares: tuple[float, ...]) -> list[tuple[int, Solid]]:
        """Return the springs of a station as direction, 0 to 2, and solid, SI."""
        rows = zip(self.solids, shares, strict=True)
        return [
            (direction, solid * share) for direction, (solid, share) in enumerate(rows) if share > 0
        ]


def make_springs(deck: Deck, line: Stations | None, shear: Shear | None = None) -> SpringRow:
    """Return the springs of a deck: its solid at the origin, or its share at each station.

    Raises
    ------
    ExportError
        If the tested length is not known, or no station touches.
    """
    if line is None:
        return SpringRow((deck.solid,) * 3)
    metres = deck.specimen.length
    if metres is None:
        raise ExportError(
            "a seal line needs the contact length that the model stands for; give "
            "--length 100mm (Python: Specimen(length=...), m)"
        )
    shear = shear or Shear()
    # without a stated compression the secant stiffness of the test is valid
    law = None if line.compression is None else deck.elastic_law
    per_metre = SealSection(deck.solid, None if law is None else law * (1 / metres), shear=shear)
    directions = per_metre.ways(line)
    # shares refer to the solid in the header, or for a separate solid to one metre
    items = [isinstance(value, Solid) for value in (0.0, shear.across, shear.along)]
    shares = [
        direction.share / (1.0 if item else metres)
        for direction, item in zip(directions, items, strict=True)
    ]
    has_contact = directions[0].share > 0
    if not has_contact.any():
        raise ExportError("no station of the seal line touches: its compression is below 0 m")
    solids = [direction.solid for direction in directions]
    return SpringRow(
        (solids[0], solids[1], solids[2]),
        tuple(_stations(deck, line, shares, has_contact, is_axisymmetric=not shear.holds)),
        tuple(_remarks(deck, line, shares[0][has_contact], shear)),
    )


def _stations(
    deck: Deck,
    line: Stations,
    shares: list[FloatArray],
    has_contact: BoolArray,
    *,
    is_axisymmetric: bool,
) -> list[LineStation]:
    """Return the stations in contact; without shear the frame has any angle about the normal."""
    normal = line.normal
    across, along = line.across, line.tangent
    if is_axisymmetric:
        along = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal), axis=1)])
        along = along / np.linalg.norm(along, axis=1)[:, None]
        across = np.cross(normal, along)
    frames = np.stack((normal, across, along), axis=1).round(_DIGITS) + 0.0
    stations = []
    for i in np.flatnonzero(has_contact).tolist():
        # shares that differ by rounding count as equal
        a, b, c = (float(f"{share[i]:.9g}") for share in shares)
        frame = tuple(tuple(row) for row in frames[i].tolist())
        position = tuple((line.place[i] / deck.units.length).tolist())
        stations.append(LineStation(position, frame, (a, b, c)))
    return stations


def _remarks(deck: Deck, line: Stations, shares: FloatArray, shear: Shear) -> list[str]:
    unit, unit_name = deck.units.length, deck.units.words[0]
    lowest, highest = float(f"{shares.min():.9g}"), float(f"{shares.max():.9g}")
    share_text = f"{lowest:.6g}" if lowest == highest else f"{lowest:.6g} to {highest:.6g}"
    description = (
        f"seal line: {line.length.sum() / unit:.6g} {unit_name}, {len(shares)} elements, "
        f"{line.length.mean() / unit:.6g} {unit_name} apart on average, each with {share_text} of "
        "the stiffness above"
    )
    remaining = len(line.length) - len(shares)
    if remaining:
        description += f"; {remaining} more do not touch and are left out"
    sideways = [
        f"{direction}: "
        f"{'a stiffness of its own' if isinstance(value, Solid) else f'{value:g} of it'}"
        for direction, value in zip(DIRECTION_NAMES[1:], (shear.across, shear.along), strict=True)
        if value != 0
    ]
    no_shear_text = "no shear is given: the line holds nothing sideways"
    return [description, "; ".join(sideways) if sideways else no_shear_text]
