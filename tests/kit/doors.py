"""A door whose seal line, stiffness and modes were computed apart: for whoever lays such a line.

Its line is closed and leans outwards by 15 degrees in the plane of the door, x-z; one metre of its
seal has K' of the published one at 12.71 Hz. Numbers in m, N, kg.
"""

from __future__ import annotations

import numpy as np

CORNERS = [(0.05, 0, 0.05), (1.05, 0, 0.05), (1.05, 0, 0.75), (0.75, 0, 1.15), (0.05, 0, 1.15)]
CENTRE = (0.55, 0.0, 0.60)
MASS, INERTIA = 25.0, (3.0, 5.5, 2.5)
KAPPA = 331.72696175567918 / 0.05
TILT = np.radians(15)
ACROSS, ALONG = 0.35, 0.15
# N/m, N and N m about the centre of gravity: the integrals along the line
SHEARED = (
    "xx 7406.1925205 yy 25382.639311 zz 7018.4035794 aa 4757.1296508 bb 1883.3398532 "
    "cc 4078.1440493 xz 387.78894106 xb -310.34168758 xc 1121.2371307 ya 824.93577760 "
    "yc -824.93577760 za -1121.2371307 zb 332.96270914 ab -25.874703017 ac 453.71467768 "
    "bc -26.952815643"
)
NORMAL_ONLY = (
    "xx 942.19129801 yy 24760.437510 zz 835.52813219 aa 4640.5186634 bb 136.89921045 "
    "cc 3978.1769600 xz 106.66316581 xb -49.776144046 xc 1724.9802011 ya 804.71421908 "
    "yc -804.71421908 za -1724.9802011 zb 55.998162051 ab -39.807235411 ac 442.59282050 "
    "bc -41.465870219"
)
FREE = [2.4908481, 2.7042687, 3.0077182, 4.9698162, 6.1584210, 6.7308732]
"""Hz, of the door that only this seal holds."""
_MOTIONS = "xyzabc"


def parse_matrix(words: str) -> np.ndarray:
    """The matrix of such words."""
    K = np.zeros((6, 6))
    message = words.split()
    for name, value in zip(message[::2], map(float, message[1::2]), strict=True):
        i, j = map(_MOTIONS.index, name)
        K[i, j] = K[j, i] = value
    return K


def close_outline() -> np.ndarray:
    """Its corners, the first again at the end."""
    return np.array([*CORNERS, CORNERS[0]])


def leaning() -> np.ndarray:
    """The way in which each piece is pressed."""
    points = close_outline()
    runs = np.diff(points, axis=0)
    out = np.cross(runs, (0, 1, 0)) / np.linalg.norm(runs, axis=1)[:, None]
    away = (points[1:] + points[:-1]) / 2 - np.mean(CORNERS, axis=0)
    out *= np.sign((out * away).sum(axis=1))[:, None]
    return np.cos(TILT) * np.array([0, 1, 0]) + np.sin(TILT) * out


def six_by_six(place: np.ndarray, way: np.ndarray, k: np.ndarray) -> np.ndarray:
    """About its centre of gravity, of springs of k at places along unit vectors."""
    rows = np.hstack((way, np.cross(np.asarray(place) - CENTRE, way)))
    return (rows.T * k) @ rows


def compute_largest_difference(values: np.ndarray, exact: np.ndarray) -> float:
    """Largest difference of two such matrices, over the root of its two diagonal terms."""
    size = np.sqrt(np.outer(exact.diagonal(), exact.diagonal()))
    return float((np.abs(values - exact) / size).max())
