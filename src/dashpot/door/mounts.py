"""A seal line as mounts between a body and what it seals against."""

from __future__ import annotations

from collections.abc import Iterator

from dashpot.base.errors import DataError
from dashpot.base.units import Quantity
from dashpot.records.seal_line import SealLine, Stations, Way
from dashpot.vibration.systems.bodies import Mount

SEAL = "seal"


def line_mounts(
    line: SealLine, body: str, pitch: Quantity, *, ground: str = "ground"
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
        What it lies between.
    pitch : str or float
        Wanted distance of the mounts, m.

    Raises
    ------
    DataError
        If the line has no section, or a seal that is not linear no compression.
    """
    section, stations = line.section, line.stations(pitch)
    if section is None:
        raise DataError(
            "the seal line has no section: one metre of the seal is not known (Python: section=)"
        )
    return tuple(
        mount for way in section.ways(stations) for mount in _mounts(way, stations, (body, ground))
    )


def _mounts(way: Way, stations: Stations, between: tuple[str, str]) -> Iterator[Mount]:
    """One at each station that answers that way; stations of one share are one solid."""
    shares = [float(f"{one:.14g}") for one in way.share.tolist()]
    solids = {one: one * way.solid for one in set(shares) if one > 0}
    for place, along, one in zip(
        stations.place.tolist(), way.direction.tolist(), shares, strict=True
    ):
        if one > 0:
            yield Mount(solids[one], between, tuple(place), tuple(along), name=SEAL)
