"""The set of stiffnesses that tests allow at one frequency, and how a mass on any of them answers.

The set of (K', K'') over all spectra that a test does not reject is convex: it is felt by its
support in some directions, chosen where they tell most.
"""

from __future__ import annotations

from bisect import bisect
from cmath import phase
from itertools import pairwise, starmap
from math import pi

import numpy as np

from dashpot.base.arrays import FloatArray
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
    stiffness_set = StiffnessSet(spectra, omega, inertia)
    while True:
        nearest, inside = stiffness_set.find_hull_point()
        corner = max(stiffness_set.corners(), key=abs)
        if len(stiffness_set) >= DIRECTIONS:
            break
        gap_near = (
            0.0 if inside else 1 - stiffness_set.nearest_distance_bound / max(abs(nearest), 1e-300)
        )
        # a set that is one point, where the point is, has no farther one
        gap_far = 1 - stiffness_set.far / abs(corner) if corner else 0.0
        if max(gap_near, gap_far) <= CLOSE:
            break
        stiffness_set.add_direction(-nearest if gap_near > gap_far else corner)
    return 0.0 if inside else stiffness_set.nearest_distance_bound, abs(corner)


def ratios(
    spectra: AdmissibleSpectra, omega: float, inertia: float, coupled: float = 0.0
) -> tuple[float, float]:
    r"""Lowest and highest transmissibility :math:`|K| / |K - m\omega^2/n|` over the set, outer.

    `coupled` is what mounts that weigh something add to K above the line, N/m.

    Its logarithm is harmonic but where either distance is none: over a polygon it is extreme on
    the edges. Where it goes beyond 1 upwards, or below 1 downwards, the stiffnesses that go as far
    are a disc, which a straight line parts from the set; else a corner reaches farthest.
    """
    stiffness_set = StiffnessSet(spectra, omega, inertia)
    base = inertia + coupled
    while True:
        outer = [_extreme(stiffness_set.corners(), base, sign) for sign in (1, -1)]
        inner = [_extreme(stiffness_set.points, base, sign) for sign in (1, -1)]
        (most, _), (least, _) = outer
        # where nothing limits a ratio nothing more can be felt
        gaps = [
            0.0 if inner[0][0] == most else 1 - inner[0][0] / most,
            0.0 if inner[1][0] == least else 1 - least / inner[1][0],
        ]
        worse = int(np.argmax(gaps))
        if gaps[worse] <= CLOSE or len(stiffness_set) >= DIRECTIONS:
            return least, most
        sign, disc = ((1, most > 1), (-1, least < 1))[worse]
        at = (inner if disc else outer)[worse][1]
        stiffness_set.add_direction(complex(*(sign * _steepest(at, base))))


class StiffnessSet:
    """What supports in some directions say of that set, seen from the stiffness of a mass.

    Stiffnesses and directions are complex numbers, in the order of the directions from -pi to pi:
    so are the points then, of which each is a corner of their hull.
    """

    def __init__(self, spectra: AdmissibleSpectra, omega: float, inertia: float) -> None:
        self._columns, self._spectra = np.array(spectra.stiffness_at(omega)), spectra
        self._inertia = inertia
        self._angles: list[float] = []
        self._directions: list[complex] = []
        self.points: list[complex] = []
        for direction in (1, -1, 1j, -1j):
            self.add_direction(direction)

    def __len__(self) -> int:
        return len(self.points)

    def add_direction(self, direction: complex) -> None:
        """Feel the set in one more direction."""
        unit = direction / abs(direction)
        storage, loss = self._columns
        spectrum = self._spectra.find_extreme_spectrum(unit.real * storage + unit.imag * loss)
        open_ended = np.isinf(spectrum)
        if open_ended.any():
            # as good as without end, and still a point
            end = FAR * self._inertia / np.hypot(storage, loss)
            spectrum = np.where(open_ended, end, spectrum)
        farthest = complex(*(self._columns @ spectrum).tolist())
        at = bisect(self._angles, angle := phase(unit))
        self._angles.insert(at, angle)
        self._directions.insert(at, unit)
        self.points.insert(at, farthest - self._inertia)

    @property
    def _supports(self) -> list[float]:
        """How far the set reaches in each direction."""
        return [_dot(*pair) for pair in zip(self._directions, self.points, strict=True)]

    @property
    def nearest_distance_bound(self) -> float:
        """No point of the set is nearer."""
        return max(0.0, -min(self._supports))

    @property
    def far(self) -> float:
        """Some point of the set is as far."""
        return max(map(abs, self.points))

    def find_hull_point(self) -> tuple[complex, bool]:
        """The nearest point of the hull of all points met, and whether the origin is in it."""
        angles = sorted(map(phase, self.points))
        widest = max(b - a for a, b in pairwise((*angles, angles[0] + 2 * pi)))
        nearest = min(
            starmap(_find_nearest_point, pairwise((*self.points, self.points[0]))), key=abs
        )
        return nearest, widest < pi or nearest == 0

    def corners(self) -> list[complex]:
        """Corners of the polygon that the support lines enclose, in their order."""
        lines = [*zip(self._directions, self._supports, strict=True)]
        return [
            complex(h * v.imag - g * u.imag, g * u.real - h * v.real) / cross
            for (u, h), (v, g) in pairwise((*lines, lines[0]))
            if (cross := (u.conjugate() * v).imag) > 1e-9
        ]


def _dot(first: complex, second: complex) -> float:
    return first.real * second.real + first.imag * second.imag


def _find_nearest_point(start: complex, end: complex) -> complex:
    """The point nearest to the origin of the way from one to another."""
    along = end - start
    length = _dot(along, along)
    part = -_dot(start, along) / length if length > 0 else 0.0
    return start + min(max(part, 0.0), 1.0) * along


def _extreme(corners: list[complex], offset: float, sign: int) -> tuple[float, FloatArray]:
    """The highest (sign 1) or lowest ratio |d + offset| / |d| over a polygon, and where."""
    start = np.array(corners).view(float).reshape(-1, 2)
    along = np.roll(start, -1, axis=0) - start
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
    residual = along[:, 1] * start[:, 0] - along[:, 0] * start[:, 1]
    return bool((residual >= 0).all() and (residual > 0).any())


def _steepest(at: FloatArray, offset: float) -> FloatArray:
    """The direction in which ln (|d + offset| / |d|) grows most."""
    base = at + np.array([offset, 0.0])
    return np.asarray(base / max(float(base @ base), _TINY) - at / max(float(at @ at), _TINY))
