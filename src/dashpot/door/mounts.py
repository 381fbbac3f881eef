"""A seal line as mounts between a body and what it seals against."""

from __future__ import annotations

import numpy as np

from dashpot.base.errors import DataError
from dashpot.base.units import Quantity
from dashpot.records.seal_line import SealLine
from dashpot.vibration.systems.bodies import Mount

SEAL = "seal"


def line_mounts(
    line: SealLine, body: str, pitch: Quantity, *, ground: str = "ground"
) -> tuple[Mount, ...]:
    r"""Return a mount for each station of a line that touches: its share of the seal there.

    .. math:: K_i = \kappa(x_i)\,\Delta s\,c_i, \qquad \kappa(x) = \kappa\,F_e'(x)/k

    with the tangent at the station's compression and the factor c of its joints.

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
    share = stations.length * stations.factor
    if stations.compression is not None:
        share = share * section.factor(stations.compression)
    elif section.law is not None and section.law.kind != "linear":
        raise DataError(
            "the seal is not linear and how far it is pressed along the line is not stated; give "
            "its compression, or gap and height"
        )
    # stations of one share are one solid
    solids = {one: one * section.solid for one in np.unique(share).tolist() if one > 0}
    rows = zip(stations.place.tolist(), stations.normal.tolist(), share.tolist(), strict=True)
    return tuple(
        Mount(solids[one], (body, ground), tuple(place), tuple(normal), name=SEAL)
        for place, normal, one in rows
        if one > 0
    )
