r"""Hyperelastic laws of rubber and foam: energy, nominal stress, tangent and stability.

With :math:`e_i = \ln\lambda_i` the logarithms of the principal stretches, an energy W per volume at
rest has the Kirchhoff stresses :math:`\partial W/\partial e_i`, so one law serves every mode of
test. On the path of a mode the stretches are powers of one, :math:`e = \varepsilon\,d`, free faces
being free:

=========== ==================================
uniaxial    :math:`d = (1, -\nu, -\nu)`
equibiaxial :math:`d = (1, 1, -2\nu/(1-\nu))`
planar      :math:`d = (1, 0, -\nu/(1-\nu))`
=========== ==================================

where :math:`\nu = 1/2` for a rubber that keeps its volume. Energies, in the convention of Abaqus:

.. math::
    W = \sum_{ij} C_{ij}(I_1-3)^i(I_2-3)^j, \qquad
    W = \sum_k \frac{2\mu_k}{\alpha_k^2}\Bigl[\sum_i\lambda_i^{\alpha_k} - 3
        + \tfrac1\beta\bigl(J^{-\alpha_k\beta}-1\bigr)\Bigr],\quad \beta=\frac{\nu}{1-2\nu}

the second for foam (R. Hill 1978; B. Storakers 1986) and, without its last part, for rubber
(R. W. Ogden, Proc. R. Soc. A 326 (1972) 565).
"""

from __future__ import annotations

import math
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.base.option_fields import require_choice
from dashpot.extensions.materials.hyperelastic.law_choices import ElasticKind
from dashpot.extensions.materials.options import Mode

SHEARING: tuple[Mode, ...] = ("uniaxial", "equibiaxial", "planar")
"""The modes that change the shape."""
POWERS: MappingProxyType[ElasticKind, tuple[tuple[int, int], ...]] = MappingProxyType({
    "neo-hooke": ((1, 0),), "mooney-rivlin": ((1, 0), (0, 1)), "yeoh": ((1, 0), (2, 0), (3, 0)),
})  # fmt: skip
"""Exponents of I1 - 3 and I2 - 3 for each constant of a law of the invariants."""
MAX_STRETCH = 10.0
"""Stretch, or one over it, to which stability is sought."""
_SCAN_POINTS = 600


class Path(NamedTuple):
    r"""Mode at some stretches; a power term has the stress 2 mu (e^{a p} - e^{a q}) / (a s).

    Attributes
    ----------
    p, q, s : array, shape (n,)
    by_poisson : array, shape (n,)
        Derivative of q by Poisson's ratio.
    """

    p: FloatArray
    q: FloatArray
    s: FloatArray
    by_poisson: FloatArray


def path(mode: Mode, stretch: npt.ArrayLike, poisson: float) -> Path:
    """Return the path of a mode; its `stretch` is the volume ratio if volumetric."""
    x = np.asarray(stretch, dtype=float)
    e, v = np.log(x), poisson
    if mode == "volumetric":
        return Path(e / 3, -e * v / (1 - 2 * v), x, -e / (1 - 2 * v) ** 2)
    lateral, slope = {
        "uniaxial": (v, 1.0),
        "equibiaxial": (2 * v / (1 - v), 2 / (1 - v) ** 2),
        "planar": (v / (1 - v), 1 / (1 - v) ** 2),
    }[mode]
    return Path(e, -lateral * e, x, -slope * e)


def direction(mode: Mode, poisson: float) -> FloatArray:
    """Logarithms of the three stretches of a mode over that of the one that is imposed."""
    if mode == "volumetric":
        return np.full(3, 1 / 3)
    free = float(path(mode, [math.e], poisson).q[0])
    return np.array([1.0, {"uniaxial": free, "equibiaxial": 1.0, "planar": 0.0}[mode], free])


def power_column(strain_path: Path, exponent: float) -> FloatArray:
    """Nominal stress on a path of a term whose mu is 1; of a rubber or a foam."""
    a = exponent if abs(exponent) > _NO_POWER else _NO_POWER
    return np.asarray(
        2 / a * (np.expm1(a * strain_path.p) - np.expm1(a * strain_path.q)) / strain_path.s
    )


def power_slope(strain_path: Path, exponent: float) -> FloatArray:
    """Return derivative of that column by the exponent."""
    a = exponent if abs(exponent) > _NO_POWER else _NO_POWER
    grows = (
        2
        / a
        * (strain_path.p * np.exp(a * strain_path.p) - strain_path.q * np.exp(a * strain_path.q))
        / strain_path.s
    )
    return np.asarray(grows - power_column(strain_path, a) / a)


def power_by_poisson(strain_path: Path, exponent: float) -> FloatArray:
    """Return derivative of that column by Poisson's ratio."""
    return np.asarray(
        -2 * np.exp(exponent * strain_path.q) * strain_path.by_poisson / strain_path.s
    )


_NO_POWER = 1e-6
"""A smaller exponent is taken for this: the term is that of a logarithm."""


@dataclass(frozen=True)
class Hyperelastic:
    """Hyperelastic law.

    Attributes
    ----------
    kind : str
        ``"neo-hooke"``, ``"mooney-rivlin"``, ``"yeoh"``, ``"ogden"`` or ``"hyperfoam"``.
    constants : tuple of float
        Pa: C10; C10, C01; C10, C20, C30; or every mu; their sum is the shear modulus at rest.
    exponents : tuple of float
        Every alpha of ``"ogden"`` and ``"hyperfoam"``.
    poisson : float
        Poisson's ratio of a foam, the same for all its terms; 0.5 for all others, which keep their
        volume.
    bulk : float or None
        Bulk modulus of a rubber, Pa, where it is known: W has K (J - 1)^2 / 2 besides. A foam has
        its own.

    >>> rubber = Hyperelastic("mooney-rivlin", (0.15e6, 0.05e6))
    >>> rubber.nominal("uniaxial", 2.0).round(6), rubber.nominal("equibiaxial", 2.0).round(6)
    (np.float64(612500.0), np.float64(1378125.0))
    """

    kind: ElasticKind
    constants: tuple[float, ...]
    exponents: tuple[float, ...] = ()
    poisson: float = 0.5
    bulk: float | None = None

    def __post_init__(self) -> None:
        require_choice("law", self.kind, ElasticKind)
        powers = self.kind not in POWERS
        expected = len(self.exponents) if powers else len(POWERS[self.kind])
        if len(self.constants) != expected or expected < 1 or (self.exponents and not powers):
            raise DataError(
                f"{self.kind} with {len(self.constants)} constants and {len(self.exponents)} "
                "exponents; expected an exponent for each constant of ogden and hyperfoam, none "
                "for others"
            )
        if not all(map(math.isfinite, (*self.constants, *self.exponents, self.poisson))):
            raise DataError(f"{self.kind}: every constant must be finite")
        foam = self.kind == "hyperfoam"
        if not (-1 < self.poisson < 0.5 if foam else self.poisson == 0.5):
            raise DataError(
                f"{self.kind} with Poisson's ratio {self.poisson:g}; expected one below 0.5 of a "
                "foam, and 0.5 of all others"
            )
        if self.bulk is not None and (foam or not self.bulk > 0):
            raise DataError(
                f"{self.kind} with bulk modulus {self.bulk:g} Pa; expected a number > 0, and none "
                "of a foam, whose Poisson's ratio says it"
            )

    # -- at rest ------------------------------------------------------------------------------

    @property
    def constant_names(self) -> tuple[str, ...]:
        """Names of the constants."""
        if self.kind in POWERS:
            return tuple(f"C{i}{j}" for i, j in POWERS[self.kind])
        return tuple(f"mu{k}" for k in range(1, len(self.constants) + 1))

    @property
    def shear_modulus(self) -> float:
        """Shear modulus at rest, Pa."""
        if self.kind not in POWERS:
            return sum(self.constants)
        first = zip(self.constants, POWERS[self.kind], strict=True)
        return 2 * sum(c for c, (i, j) in first if i + j == 1)

    @property
    def bulk_modulus(self) -> float | None:
        """Bulk modulus at rest, Pa; None if it is unknown."""
        if self.kind != "hyperfoam":
            return self.bulk
        v = self.poisson
        return 2 * self.shear_modulus * (1 / 3 + v / (1 - 2 * v))

    # -- under stretch ------------------------------------------------------------------------

    def energy(self, mode: Mode, stretch: npt.ArrayLike) -> FloatArray:
        """J/m^3 at rest; of a mode in which the law keeps its volume, its shape's alone."""
        x = np.asarray(stretch, dtype=float)
        if mode == "volumetric" and self.kind != "hyperfoam":
            return np.asarray(0.5 * self._require_bulk() * (x - 1) ** 2)
        e = np.log(x)[..., None] * direction(mode, self.poisson)
        if self.kind in POWERS:
            a, b = np.expm1(2 * e).sum(-1), np.expm1(-2 * e).sum(-1)
            terms = zip(self.constants, POWERS[self.kind], strict=True)
            return np.asarray(sum(c * a**i * b**j for c, (i, j) in terms))
        beta = self.poisson / (1 - 2 * self.poisson) if self.kind == "hyperfoam" else 0.0
        log_volume = e.sum(-1)
        total = np.zeros(e.shape[:-1])
        for mu, al in zip(self.constants, self.exponents, strict=True):
            volume_part = -al * log_volume
            if beta:
                volume_part = np.expm1(-al * beta * log_volume) / beta
            total = total + 2 * mu / al**2 * (np.expm1(al * e).sum(-1) + volume_part)
        return np.asarray(total)

    def nominal(self, mode: Mode, stretch: npt.ArrayLike) -> FloatArray:
        """Return force over area at rest, Pa; the mean true stress where the mode is volumetric.

        Parameters
        ----------
        mode : str
        stretch : array_like
            In the direction of the force; the volume ratio J where the mode is volumetric.
        """
        x = np.asarray(stretch, dtype=float)
        if mode == "volumetric" and self.kind != "hyperfoam":
            return np.asarray(self._require_bulk() * (x - 1))
        if self.kind not in POWERS:
            strain_path = path(mode, x, self.poisson)
            terms = zip(self.constants, self.exponents, strict=True)
            return np.asarray(sum(mu * power_column(strain_path, a) for mu, a in terms))
        e = np.log(x)[..., None] * direction(mode, self.poisson)
        by_first, by_second = self._compute_invariant_derivatives(e)
        first = np.expm1(2 * e[..., 0]) - np.expm1(2 * e[..., 2])
        second = np.expm1(-2 * e[..., 2]) - np.expm1(-2 * e[..., 0])
        return np.asarray(2 * (by_first * first + by_second * second) / x)

    def tangent(self, mode: Mode, stretch: npt.ArrayLike) -> FloatArray:
        """Derivative of the nominal stress by the stretch, Pa, as for small vibration about it."""
        x = np.asarray(stretch, dtype=float)
        if mode == "volumetric" and self.kind != "hyperfoam":
            return np.full_like(x, self._require_bulk())
        strain_direction = direction(mode, self.poisson)
        H = self._hessian(np.log(x)[..., None] * strain_direction)
        tau = self.nominal(mode, x) * x
        if mode == "volumetric":
            return np.asarray((H[..., 0, :] @ strain_direction - tau) / x**2)
        return np.asarray(((H[..., 0, :] - H[..., 2, :]) @ strain_direction - tau) / x**2)

    def columns(self, mode: Mode, stretch: npt.ArrayLike) -> FloatArray:
        """Nominal stress of each constant alone at 1 Pa, shape (n, constants)."""
        count = len(self.constants)
        units = [tuple(float(i == k) for i in range(count)) for k in range(count)]
        return np.stack(
            [replace(self, constants=unit).nominal(mode, stretch) for unit in units], -1
        )

    # -- stability ----------------------------------------------------------------------------

    def drucker(self, mode: Mode, stretch: npt.ArrayLike) -> FloatArray:
        """Least eigenvalue of d tau_i / d e_j in the planes that the law allows, over G.

        D. C. Drucker: it does work in every small further strain where this is above 0; of a rubber
        over strains that keep the volume, as Abaqus asks (Analysis Guide, Hyperelastic behavior).
        """
        H = self._hessian(
            np.log(np.asarray(stretch, float))[..., None] * direction(mode, self.poisson)
        )
        if self.kind != "hyperfoam":
            H = _ISOCHORIC.T @ H @ _ISOCHORIC
        return np.asarray(np.linalg.eigvalsh(H)[..., 0] / abs(self.shear_modulus or 1.0))

    def stable_range(self, mode: Mode) -> tuple[float | None, float | None]:
        """The first stretches below and above 1 at which Drucker's condition fails, or None.

        Sought from a tenth to ten times the length.
        """
        return self._first_unstable(mode, -1.0), self._first_unstable(mode, 1.0)

    def _first_unstable(self, mode: Mode, sign: float) -> float | None:
        # the path itself sits between 1 / MAX_STRETCH and MAX_STRETCH in the imposed direction
        e = sign * np.linspace(0.0, math.log(MAX_STRETCH), _SCAN_POINTS)
        unstable_indices = np.flatnonzero(self.drucker(mode, np.exp(e)) <= 0)
        if not unstable_indices.size:
            return None
        high = int(unstable_indices[0])
        if high == 0:
            return 1.0
        stable_strain, unstable_strain = float(e[high - 1]), float(e[high])
        for _ in range(40):
            midpoint = 0.5 * (stable_strain + unstable_strain)
            if self.drucker(mode, math.exp(midpoint)) > 0:
                stable_strain = midpoint
            else:
                unstable_strain = midpoint
        return math.exp(unstable_strain)

    # -- the energy and its derivatives ---------------------------------------------------------

    def _require_bulk(self) -> float:
        if self.bulk is None:
            raise DataError(
                f"this {self.kind} law has no bulk modulus; give one (Python: bulk=, Pa)"
            )
        return self.bulk

    def _compute_invariant_derivatives(self, e: FloatArray) -> tuple[FloatArray, FloatArray]:
        """dW/dI1 and dW/dI2."""
        a, b = np.expm1(2 * e).sum(-1), np.expm1(-2 * e).sum(-1)
        first, second = np.zeros_like(a), np.zeros_like(a)
        for c, (i, j) in zip(self.constants, POWERS[self.kind], strict=True):
            first = first + (c * i * a ** (i - 1) * b**j if i else 0.0)
            second = second + (c * j * a**i * b ** (j - 1) if j else 0.0)
        return first, second

    def _hessian(self, e: FloatArray) -> FloatArray:
        """d2W / de_i de_j, shape (..., 3, 3)."""
        eye = np.eye(3)
        if self.kind in POWERS:
            first, second = self._compute_invariant_derivatives(e)
            a, grown = np.expm1(2 * e).sum(-1), np.exp(2 * e)
            # of the laws here I1 alone comes in powers
            terms = zip(self.constants, POWERS[self.kind], strict=True)
            curved = np.zeros_like(a)
            for c, (i, j) in terms:
                curved = curved + (c * i * (i - 1) * a ** (i - 2) if i > 1 and not j else 0.0)
            diagonal = 4 * (first[..., None] * grown + second[..., None] / grown)
            outer = grown[..., :, None] * grown[..., None, :]
            return np.asarray(diagonal[..., None] * eye + 4 * curved[..., None, None] * outer)
        foam = self.kind == "hyperfoam"
        beta = self.poisson / (1 - 2 * self.poisson) if foam else 0.0
        diagonal, common = np.zeros_like(e), np.zeros(e.shape[:-1])
        for mu, al in zip(self.constants, self.exponents, strict=True):
            diagonal = diagonal + 2 * mu * np.exp(al * e)
            common = common + 2 * mu * beta * np.exp(-al * beta * e.sum(-1))
        return np.asarray(diagonal[..., None] * eye + common[..., None, None])


_ISOCHORIC = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, -1.0]])


def poisson_of(axial: FloatArray, lateral: FloatArray) -> float:
    r"""Return :math:`-\ln\lambda_q/\ln\lambda` of stretches along and across a uniaxial force.

    By least squares through rest, as a foam of one ratio has it at any stretch (B. Storåkers,
    1986).
    """
    e, q = np.log(axial), np.log(lateral)
    return -float(e @ q / (e @ e))
