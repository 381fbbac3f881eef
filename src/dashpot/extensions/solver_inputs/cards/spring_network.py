"""Networks of springs and dashpots between two points, as a deck of the form ``arms`` has them."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from dashpot.base.errors import ReadError
from dashpot.solids.maxwell import GeneralizedMaxwell


class Element(NamedTuple):
    """Spring or dashpot between two points, in units of its file."""

    points: tuple[str, str]
    value: float


def convert_network(
    springs: Sequence[Element],
    dashpots: Sequence[Element],
    ends: Iterable[str],
    name: str,
) -> GeneralizedMaxwell:
    """Return the generalized Maxwell model of a network: springs, dashpots, and both in series.

    Parameters
    ----------
    springs, dashpots : sequence of Element
    ends : two points
        Between which the model acts; every other point is inside an arm.
    name : str
        Of the elements, for messages.

    Raises
    ------
    ReadError
        If the network is another one.
    """
    pair = frozenset(ends)
    if len(pair) != 2:
        raise ReadError(
            f"{name} join {len(pair)} points besides those inside arms; expected two, between "
            "which one model acts"
        )
    k_inf = sum(spring.value for spring in springs if frozenset(spring.points) == pair)
    b = sum(dashpot.value for dashpot in dashpots if frozenset(dashpot.points) == pair)
    inner_springs, inner_dashpots = (
        _group_by_inner_point(elements, pair, name) for elements in (springs, dashpots)
    )
    arms = []
    for point in sorted(inner_springs.keys() | inner_dashpots.keys()):
        pairs = inner_springs[point], inner_dashpots[point]
        outer_points = {end for elements in pairs for end, _ in elements}
        if any(len(elements) != 1 for elements in pairs) or outer_points != pair:
            raise ReadError(
                f"{name}: the point {point} is not between one spring and one dashpot in series; "
                "expected arms side by side, each of one spring and one dashpot"
            )
        (k,), (damping,) = ([value for _, value in elements] for elements in pairs)
        if not (k > 0 and damping > 0):
            raise ReadError(f"{name}: an arm has k = {k:g}, b = {damping:g}; expected both > 0")
        arms.append((damping / k, k))
    arms.sort()
    return GeneralizedMaxwell(k_inf, tuple(k for _, k in arms), tuple(tau for tau, _ in arms), b)


def _group_by_inner_point(
    elements: Sequence[Element], ends: frozenset[str], name: str
) -> defaultdict[str, list[tuple[str, float]]]:
    """Return the other end and the value of each element by its point inside an arm."""
    groups: defaultdict[str, list[tuple[str, float]]] = defaultdict(list)
    for points, value in elements:
        inner = [point for point in points if point not in ends]
        if len(inner) > 1:
            raise ReadError(
                f"{name} join the points {inner[0]} and {inner[1]}, and neither is an end; "
                "expected arms of one spring and one dashpot"
            )
        if inner:
            (outer,) = (point for point in points if point in ends)
            groups[inner[0]].append((outer, value))
    return groups
