"""Poles on trial: the best residues of every channel at given poles, and what is left over.

Residues and background enter linearly (variable projection). The background needs no trial, so it
is taken off the lines once; each trial has but the modes to solve for.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.vibration.modal.frf_lines import FRFLines, kernel, kernel_slope

SLOW_POLES = (1e-3, 0.3, 1.5, 7.0)  # of the background, times the middle of the band
RATIOS = np.geomspace(3e-4, 0.4, 9)  # of damping, at which a pole is tried
ROOM = 1 << 20  # numbers of a block that is worked on at once
MOST_DAMPED = 0.75  # sigma / omega of a mode; beyond it is relaxation


@dataclass(frozen=True, eq=False)
class BackgroundProjection:
    """Lines without their background, which needs no trial: what is left for modes to explain.

    Real and imaginary part of each line are two rows, over its standard deviation.

    Attributes
    ----------
    lines : FRFLines
    basis : array, shape (channels, 2n, background)
        Orthonormal.
    rest : array, shape (channels, 2n)
        The values without it.
    """

    lines: FRFLines
    basis: FloatArray
    rest: FloatArray

    @classmethod
    def from_lines(cls, lines: FRFLines) -> BackgroundProjection:
        """Mass line, modes above the band and, as slow real poles, what is below it."""
        s = lines.s
        rates = np.array(SLOW_POLES) * float(np.sqrt(s.imag[0] * s.imag[-1]))
        columns = [np.ones_like(s), (s / s.imag[-1]) ** 2]
        columns += list(kernel(lines, -rates[:, None].astype(complex)) * rates[1])
        rows = _rows(np.array(columns), lines.sd)
        basis = np.linalg.qr(rows / np.linalg.norm(rows, axis=1, keepdims=True))[0]
        y = _rows(lines.value[:, None], lines.sd)
        return cls(lines, basis, _subtract_projection(basis, y)[..., 0])

    @cached_property
    def broad(self) -> list[Scan]:
        """Poles of much damping all over the band, tried whenever one more is sought."""
        omega = self.lines.s.imag
        places = np.geomspace(omega[0], omega[-1], 16)[1:-1]
        return scans(self.lines, [(r * at, float(at)) for r in RATIOS[5:] for at in places])

    def parts(self, columns: int) -> list[slice]:
        """Channels that are solved for at once: as many as a cache of so many columns holds."""
        channels, rows = self.rest.shape
        value = max(1, ROOM // (rows * max(columns, 1)))
        return [slice(at, at + value) for at in range(0, channels, value)]

    def remove_background(self, part: slice, columns: ComplexArray) -> FloatArray:
        """Weighted columns of shape (k, n) or (channels, k, n), the background taken off."""
        return _subtract_projection(self.basis[part], _rows(columns, self.lines.sd[part]))


class _Residues(NamedTuple):
    """Best residues of each channel, and what the poles' slopes say besides."""

    residues: ComplexArray  # (channels, modes)
    residuals: FloatArray  # (channels, 2n)
    inverse: FloatArray  # (channels, 2 modes, 2 modes): from rows' coordinates to coefficients
    crossing: FloatArray  # (channels, 2 modes, 2 modes): the slopes' coordinates
    normal: FloatArray  # (channels, 2 modes, 2 modes): slopes' products, residues projected out
    gradient: FloatArray  # (channels, 2 modes)


@dataclass(frozen=True, eq=False)
class PoleTrial:
    """Poles, as ln sigma and ln omega of each, with the best residues and background there.

    Modes, two real coefficients each, are solved for channel by channel, so that it is no problem
    of dense rows; it descends as any other
    (:class:`dashpot.numerics.least_squares.levenberg_marquardt.Trial`).
    """

    ground: BackgroundProjection
    theta: FloatArray

    @cached_property
    def poles(self) -> ComplexArray:
        """Shape (modes,)."""
        sigma, omega = np.exp(self.theta.reshape(-1, 2)).T
        return np.asarray(-sigma + 1j * omega)

    @cached_property
    def columns(self) -> ComplexArray:
        """What a residue of 1 and of j looks like, pole by pole: shape (2 modes, n)."""
        return _pairs(self.ground.lines, self.poles)

    @cached_property
    def slopes(self) -> tuple[ComplexArray, ComplexArray]:
        """Slopes of the kernels of poles and of their conjugates, shape (modes, n) each."""
        lines, p = self.ground.lines, self.poles[:, None]
        return kernel_slope(lines, p), kernel_slope(lines, p.conj())

    def basis(self, part: slice) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The modes' rows of some channels, their orthonormal basis, and the way back from it."""
        rows = self.ground.remove_background(part, self.columns)
        weight = 1 / self.ground.lines.sd[part] ** 2
        scale = np.sqrt(weight @ (np.abs(self.columns) ** 2).T)
        q, triangle = np.linalg.qr(rows / scale[:, None, :])
        return rows, q, np.linalg.pinv(triangle, rcond=1e-12) / scale[:, :, None]

    @cached_property
    def solution(self) -> _Residues:
        """The linear problem at these poles."""
        residues = [self._solve_residues(part) for part in self.ground.parts(len(self.theta))]
        return _Residues(*(np.concatenate(group) for group in zip(*residues, strict=True)))

    def _solve_residues(self, part: slice) -> _Residues:
        rows, q, inverse = self.basis(part)
        y = self.ground.rest[part]
        c = _times(inverse, _times(q.swapaxes(1, 2), y))
        residual = y - _times(rows, c)
        residues = c[:, 0::2] + 1j * c[:, 1::2]
        up, down = (
            by[None] * slope
            for by, slope in zip(
                (residues[..., None], residues[..., None].conj()), self.slopes, strict=True
            )
        )
        slopes = np.empty((len(c), len(self.theta), up.shape[-1]), complex)
        sigma, omega = -self.poles.real[:, None], self.poles.imag[:, None]
        slopes[:, 0::2], slopes[:, 1::2] = -sigma * (up + down), 1j * omega * (up - down)
        jacobian = self.ground.remove_background(part, slopes)
        crossing = q.swapaxes(1, 2) @ jacobian
        jacobian -= q @ crossing
        turned = jacobian.swapaxes(1, 2)
        return _Residues(
            residues, residual, inverse, crossing, turned @ jacobian, _times(turned, residual)
        )

    @cached_property
    def sse(self) -> float:
        """Sum of squared residuals; infinite where a pole does not oscillate."""
        if (self.theta[0::2] - self.theta[1::2] >= np.log(MOST_DAMPED)).any():
            return np.inf
        return float((self.solution.residuals**2).sum())

    @cached_property
    def gradient(self) -> FloatArray:
        """Half the slope of the sum of squares by theta."""
        return np.asarray(-self.solution.gradient.sum(axis=0))

    @cached_property
    def curvature(self) -> FloatArray:
        """Of Gauss and Newton."""
        return np.asarray(self.solution.normal.sum(axis=0))

    def ahead(self, step: FloatArray) -> PoleTrial:
        """The trial a short step away."""
        return replace(self, theta=self.theta + step)

    @cached_property
    def misfit(self) -> FloatArray:
        """Squared residual of each line over its variance, shape (channels, n)."""
        residuals = self.solution.residuals
        return np.asarray((residuals.reshape(len(residuals), -1, 2) ** 2).sum(axis=2))

    @property
    def residues(self) -> ComplexArray:
        """Shape (channels, modes)."""
        return self.solution.residues

    @property
    def beta(self) -> FloatArray:
        """The residues' real and imaginary parts in turn, shape (channels * 2 modes,)."""
        return self.residues.view(float).ravel()

    def only(self, modes: list[int]) -> PoleTrial:
        """The chosen modes."""
        return replace(self, theta=self.theta.reshape(-1, 2)[modes].ravel())


class Scan(NamedTuple):
    """Poles to be tried, and what does not depend on those that are there already."""

    poles: ComplexArray
    rows: FloatArray  # (2 poles, 2n)
    squares: FloatArray  # (3, channels, poles): of each pair of weighted rows, and their product


def scans(lines: FRFLines, starts: list[tuple[float, float]]) -> list[Scan]:
    """Several (sigma, omega), as many in each as there is room for."""
    weights = 1 / np.repeat(lines.sd, 2, axis=1) ** 2
    value = max(1, ROOM // weights.shape[1])
    scans = []
    for at in range(0, len(starts), value):
        poles = np.array([complex(-sigma, omega) for sigma, omega in starts[at : at + value]])
        rows = _pairs(lines, poles).view(float)
        values, other = rows[0::2], rows[1::2]
        pairs = ((values, values), (values, other), (other, other))
        scans.append(Scan(poles, rows, np.array([weights @ (u * v).T for u, v in pairs])))
    return scans


def _pairs(lines: FRFLines, poles: ComplexArray) -> ComplexArray:
    """What a residue of 1 and of j of each pole looks like, shape (2 poles, n)."""
    p = poles[:, None]
    up, down = kernel(lines, p), kernel(lines, p.conj())
    pairs = np.empty((2 * len(poles), len(lines.s)), complex)
    pairs[0::2], pairs[1::2] = up + down, 1j * (up - down)
    return pairs


def _rows(columns: ComplexArray, sd: FloatArray) -> FloatArray:
    """Weighted real and imaginary parts of each line, shape (channels, 2n, k)."""
    return np.ascontiguousarray(columns / sd[:, None]).view(float).swapaxes(1, 2)


def _subtract_projection(basis: FloatArray, rows: FloatArray) -> FloatArray:
    """What of rows an orthonormal basis does not have, by channel."""
    return np.asarray(rows - basis @ (basis.swapaxes(1, 2) @ rows))


def _times(matrix: FloatArray, vector: FloatArray) -> FloatArray:
    """By channel."""
    return np.asarray((matrix @ vector[..., None])[..., 0])
