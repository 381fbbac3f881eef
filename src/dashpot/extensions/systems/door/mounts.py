"""Seal line as mounts between a body and its counterpart."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from dashpot.base.errors import DataError
from dashpot.base.units import Quantity
from dashpot.datamodel.seal_line import LineDirection, Stations
from dashpot.extensions.systems.door.seal_line import SealLine
from dashpot.extensions.systems.multibody import Mount
from dashpot.solids.jenkins import Jenkins
from dashpot.solids.networks import spring

SEAL = "seal"


def make_line_mounts(
    line: SealLine,
    body: str,
    pitch: Quantity,
    *,
    ground: str = "ground",
    friction_sticks: bool = False,
) -> tuple[Mount, ...]:
    r"""Return the mounts of each station of a line that touches: its share of the seal there.

    .. math:: K_i = \kappa(x_i)\,\Delta s\,c_i, \qquad \kappa(x) = \kappa\,F_e'(x)/k

    with the tangent at the station's compression and the factor c of its joints. One acts along
    the normal; where the section has shear, one across the line and one along it, of
    :math:`r\,K_i`, or of :math:`\kappa_r\,\Delta s\,c_i` with a stiffness of its own.

    Parameters
    ----------
    line : SealLine
        With its section.
    body, ground : str
        Bodies that it connects.
    pitch : str or float
        Wanted distance of the mounts, m.
    friction_sticks : bool
        Friction sticks, as under small vibration: a spring beside the arms. Otherwise the mounts
        have the friction, and depend on amplitude.

    Raises
    ------
    DataError
        If the line has no section, or a seal that is not linear, or rubs, no compression.
    """
    section, stations = line.section, line.stations(pitch)
    if section is None:
        raise DataError(
            "the seal line has no section: one metre of the seal is not known (Python: section=)"
        )
    return tuple(
        mount
        for direction in section.ways(stations)
        for mount in _make_direction_mounts(
            direction, stations, (body, ground), friction_sticks=friction_sticks
        )
    )


def _make_direction_mounts(
    direction: LineDirection, stations: Stations, bodies: tuple[str, str], *, friction_sticks: bool
) -> Iterator[Mount]:
    """One at each station that answers that way; stations of one share are one solid."""
    nothing = np.zeros(len(direction.share))
    columns = (direction.share, *(direction.friction or (nothing, nothing)))
    rows = [[float(f"{item:.14g}") for item in row] for row in zip(*columns, strict=True)]
    solids = {value: value * direction.solid for value, _, _ in rows if value > 0}
    for position, tangent, (number, k, slip) in zip(
        stations.place.tolist(), direction.direction.tolist(), rows, strict=True
    ):
        if not number > 0:
            continue
        mount = Mount(solids[number], bodies, tuple(position), tuple(tangent), name=SEAL)
        rubs = Jenkins(k, slip) if k > 0 and slip > 0 else None
        yield mount if friction_sticks else replace(mount, friction=rubs)
        if friction_sticks and rubs is not None:
            yield replace(mount, solid=spring(k))
