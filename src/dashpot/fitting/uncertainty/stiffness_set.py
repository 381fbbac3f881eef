"""The set of stiffnesses that tests allow at one frequency, and how a mass on any of them answers.

The set of (K', K'') over all spectra that a test does not reject is convex: it is felt by its
support in some directions, chosen where they tell most.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray
from dashpot.fitting.uncertainty.admissible_spectra import AdmissibleSpectra

# what the points met and the lines that enclose them allow differs by less, relatively
CLOSE = 0.01
# directions in which the set is felt, at most
DIRECTIONS = 40
# so many times the stiffness of a mass is as good as infinite
FAR = 1e9
_TINY = float(np.finfo(float).tiny)


def distances(spectra: AdmissibleSpectra, omega: float, inertia: float) -> tuple[float, float]:
    """Nearest and farthest distance of the convex set of (K', K'') from (inertia, 0), outer."""
    felt = StiffnessSet(spectra, omega, inertia)
    while len(felt.directions) < DIRECTIONS:
        nearest, inside = felt.nearest()
        gap_near = 0.0 if inside else 1 - felt.near / max(float(np.linalg.norm(nearest)), 1e-300)
        corner = felt.farthest_corner()
        reach = float(np.linalg.norm(corner))
        # a set that is one point, where the point is, has no farther one
        gap_far = 1 - felt.far / reach if reach > 0 else 0.0
        if max(gap_near, gap_far) <= CLOSE:
            break
        felt.towards(-nearest if gap_near > gap_far else corner)
    nearest, inside = felt.nearest()
    return 0.0 if inside else felt.near, float(np.linalg.norm(felt.farthest_corner()))


def ratios(
    spectra: AdmissibleSpectra, omega: float, inertia: float, coupled: float = 0.0
) -> tuple[float, float]:
    r"""Lowest and highest transmissibility :math:`|K| / |K - m\omega^2/n|` over the set, outer.

    `coupled` is what mounts that weigh something add to K above the line, N/m.

    Its logarithm is harmonic but where either distance is none: over a polygon it is extreme on
    the edges. Where it goes beyond 1 upwards, or below 1 downwards, the stiffnesses that go as far
    are a disc, which a straight line parts from the set; else a corner reaches farthest.
    """
    felt = StiffnessSet(spectra, omega, inertia)
    base = inertia + coupled
    while True:
        outer = [_extreme(felt.corners(), base, sign) for sign in (1, -1)]
        inner = [_extreme(felt.hull(), base, sign) for sign in (1, -1)]
        (most, _), (least, _) = outer
        # where nothing limits a ratio nothing more can be felt
        gaps = [
            0.0 if inner[0][0] == most else 1 - inner[0][0] / most,
            0.0 if inner[1][0] == least else 1 - least / inner[1][0],
        ]
        worse = int(np.argmax(gaps))
        if gaps[worse] <= CLOSE or len(felt.directions) >= DIRECTIONS:
            return least, most
        sign, disc = ((1, most > 1), (-1, least < 1))[worse]
        at = (inner if disc else outer)[worse][1]
        felt.towards(sign * _steepest(at, base))


class StiffnessSet:
    """What supports in some directions say of that set, seen from the stiffness of a mass."""

    def __init__(self, spectra: AdmissibleSpectra, omega: float, inertia: float) -> None:
        self.columns, self.spectra = np.array(spectra.stiffness_at(omega)), spectra
        self.point = np.array([inertia, 0.0])
        self.directions: list[FloatArray] = []
        self.points: list[FloatArray] = []
        for direction in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
            self.towards(np.array(direction))

    def towards(self, direction: FloatArray) -> None:
        """Feel the set in one more direction."""
        unit = direction / np.sqrt(direction @ direction)
        spectrum = self.spectra.farthest(unit @ self.columns)
        open_ended = np.isinf(spectrum)
        if open_ended.any():
            # as good as without end, and still a point
            end = FAR * float(np.linalg.norm(self.point)) / np.linalg.norm(self.columns, axis=0)
            spectrum = np.where(open_ended, end, spectrum)
        farthest = self.columns @ spectrum
        self.directions.append(unit)
        self.points.append(farthest - self.point)

    @property
    def near(self) -> float:
        """No point of the set is nearer."""
        supports = np.vecdot(np.array(self.directions), np.array(self.points))
        return max(0.0, -float(supports.min()))

    @property
    def far(self) -> float:
        """Some point of the set is as far."""
        points = np.array(self.points)
        return float(np.sqrt(np.vecdot(points, points).max()))

    def nearest(self) -> tuple[FloatArray, bool]:
        """The nearest point of the hull of all points met, and whether the origin is in it."""
        points = np.array(self.points)
        angles = np.sort(np.arctan2(points[:, 1], points[:, 0]))
        widest = max(float((angles[1:] - angles[:-1]).max()), angles[0] + 2 * np.pi - angles[-1])
        start, end = (points[i] for i in _pairs(len(points)))
        along = end - start
        length = np.maximum(np.vecdot(along, along), _TINY)
        part = np.minimum(np.maximum(-np.vecdot(start, along) / length, 0.0), 1.0)
        candidates = start + part[:, None] * along
        squares = np.vecdot(candidates, candidates)
        nearest = int(squares.argmin())
        return candidates[nearest], bool(widest < np.pi) or float(squares[nearest]) == 0.0

    def farthest_corner(self) -> FloatArray:
        """The farthest corner of the polygon that the support lines enclose."""
        corners = self.corners()
        return np.asarray(corners[np.vecdot(corners, corners).argmax()])

    def hull(self) -> FloatArray:
        """The points met, in the order of their directions, shape (n, 2)."""
        return np.array(self.points)[self._order()]

    def _order(self) -> IndexArray:
        """The directions from -pi to pi."""
        directions = np.array(self.directions)
        return np.argsort(np.arctan2(directions[:, 1], directions[:, 0]))

    def corners(self) -> FloatArray:
        """Corners of the polygon that the support lines enclose, in their order, shape (n, 2)."""
        order = self._order()
        directions, points = np.array(self.directions), np.array(self.points)
        u, h = directions[order], np.vecdot(directions, points)[order]
        after = np.append(np.arange(1, len(u)), 0)
        v, g = u[after], h[after]
        cross = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        turned = cross > 1e-9
        u, v, h, g = u[turned], v[turned], h[turned], g[turned]
        corners = np.array((h * v[:, 1] - g * u[:, 1], g * u[:, 0] - h * v[:, 0]))
        return np.asarray((corners / cross[turned]).T)


@lru_cache(maxsize=64)
def _pairs(count: int) -> tuple[IndexArray, ...]:
    return np.triu_indices(count, 1)


def _extreme(corners: FloatArray, offset: float, sign: int) -> tuple[float, FloatArray]:
    """The highest (sign 1) or lowest ratio |d + offset| / |d| over a polygon, and where."""
    start, along = corners, np.roll(corners, -1, axis=0) - corners
    base = start + np.array([offset, 0.0])
    pole = start if sign > 0 else base
    if _holds(pole, along):
        return (np.inf if sign > 0 else 0.0), start[0]
    # d over each edge is a + s v: the ratio's square is one of quadratics in s
    v2 = np.vecdot(along, along)
    n0, n1 = np.vecdot(base, base), 2 * np.vecdot(base, along)
    d0, d1 = np.vecdot(start, start), 2 * np.vecdot(start, along)
    a, b, c = v2 * (d1 - n1), v2 * (d0 - n0), n1 * d0 - n0 * d1
    with np.errstate(divide="ignore", invalid="ignore"):
        half = -(b + np.copysign(np.sqrt(b * b - a * c), b))
        steps = np.array([half / a, c / half, np.zeros_like(a)])
    steps = np.clip(np.nan_to_num(steps, nan=0.0, posinf=0.0, neginf=0.0), 0.0, 1.0)
    points = (start + steps[..., None] * along).reshape(-1, 2)
    with np.errstate(divide="ignore"):
        ratio = np.linalg.norm(points + np.array([offset, 0.0]), axis=1) / np.linalg.norm(
            points, axis=1
        )
    best = int(np.argmax(sign * ratio))
    return float(ratio[best]), points[best]


def _holds(start: FloatArray, along: FloatArray) -> bool:
    """Whether the origin lies within a convex polygon, its corners turning to the left."""
    left = along[:, 1] * start[:, 0] - along[:, 0] * start[:, 1]
    return bool((left >= 0).all() and (left > 0).any())


def _steepest(at: FloatArray, offset: float) -> FloatArray:
    """The direction in which ln (|d + offset| / |d|) grows most."""
    base = at + np.array([offset, 0.0])
    return np.asarray(base / max(float(base @ base), _TINY) - at / max(float(at @ at), _TINY))
