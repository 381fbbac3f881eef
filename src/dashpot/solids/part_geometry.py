r"""Geometry factor of a part, from modulus to stiffness: :math:`K^* = g\,E^*`.

The geometry factor g, m (m^3 for torsion), of rubber parts that are small against the wave in
them and nearly incompressible, :math:`G = E/3`:

- compression between plates: :math:`g = A/h` lubricated; bonded more by :func:`bonded_cylinder` or
  :func:`bonded_block` of the shape factor S, loaded over free area;
- shear: :math:`A / 3h`;
- a bonded bush of radii a < b and length L: axially :math:`2\pi L / 3 \ln(b/a)`, in torsion
  :math:`4\pi L / 3 (a^{-2} - b^{-2})`, radially as the short or the long bush of J. E. Adkins and
  A. N. Gent, Brit. J. Appl. Phys. 5 (1954) 354, between which a real one lies;
- a thin hollow bulb of wall t and mean radius R, pressed across between plates, is a ring under two
  opposite loads (S. Timoshenko, Strength of Materials):
  :math:`L t^3 / 12(1 - \nu^2)(\pi/4 - 2/\pi) R^3`.
"""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass, field, fields
from dashpot.base.errors import DataError
from dashpot.base.number_format import format_count
from dashpot.base.option_fields import PartMode
from dashpot.base.units import convert_to_si

RUBBER_POISSON_RATIO = 0.4995
"""Poisson's ratio that a rubber has, nearly: a bulk modulus 1000 times its shear modulus."""
_MIN_POISSON_RATIO = 0.2
_CYLINDER_COEFFICIENTS = (0.87022479, 0.89154842, 4.78464784)
_COMPRESSIBLE_COEFFICIENTS = (2.3033, -1.1880, -0.0179, 0.2896)
_BLOCK_COEFFICIENTS = (
    (2.32679, -4.32343, 2.72279), (0.15043, 4.18544, -2.58491), (2.04442, -1.74645, 1.78379),
)  # fmt: skip
_BLOCK_EDGE_COEFFICIENTS = (2.20077, -1.99458, 0.04257, -0.51361)


def bonded_cylinder(S: float, poisson: float = RUBBER_POISSON_RATIO) -> float:
    r"""Stiffness of a cylinder between bonded plates over that of one between lubricated ones.

    With that of an incompressible one less 1,

    .. math:: f_0 = \frac{a S + b S^2 + 2 c S^3}{1 + c S}

    and M the modulus of uniaxial strain over E, less 1,

    .. math:: 1 + M \Bigl[1 - \frac{2 I_1(x)}{x I_0(x)}\Bigr]\,
        \Bigl[1 + \frac{(p_3 + p_4 (1 - 2\nu))\,u}{(1 + u)^2}\Bigr], \qquad
        u = \frac{x^2}{8} = (2\nu)^{p_1 + p_2 S/(1 + S)} \frac{f_0}{M}

    The thin layer of A. N. Gent and P. B. Lindley, Proc. IMechE 173 (1959) 111, for large S, with
    six constants fitted to axisymmetric finite elements (quadratic displacements, discontinuous
    linear pressures, graded to the edge): within 0.41 % of them for S of 0.02 to 5 and Poisson's
    ratios of 0.2 to 0.5. The parabola 1 + 2 S^2 is low by 6 % at S = 0.25.

    Parameters
    ----------
    S : float
        D / 4h.
    poisson : float

    >>> round(bonded_cylinder(0.25, 0.499), 3), round(bonded_cylinder(1.0, 0.499), 3)
    (1.191, 2.922)
    """
    a, b, c = _CYLINDER_COEFFICIENTS
    return _compressible(
        (a * S + b * S**2 + 2 * c * S**3) / (1 + c * S), S, poisson, _COMPRESSIBLE_COEFFICIENTS
    )


def _compressible(
    incompressible_excess: float, S: float, poisson: float, edges: tuple[float, ...]
) -> float:
    """Return the bonded factor, of what an incompressible one is more than 1."""
    from scipy.special import i0e, i1e

    p_1, p_2, p_3, p_4 = edges
    nu = min(poisson, 0.5 - 1e-7)
    M = (1 - nu) / ((1 + nu) * (1 - 2 * nu)) - 1
    u = (2 * nu) ** (p_1 + p_2 * S / (1 + S)) * incompressible_excess / M
    x = np.sqrt(8 * u)
    edge_term = 1 + (p_3 + p_4 * (1 - 2 * nu)) * u / (1 + u) ** 2
    return float(1 + M * (1 - 2 * i1e(x) / (x * i0e(x))) * edge_term)


def bonded_block(S: float, aspect: float, poisson: float = RUBBER_POISSON_RATIO) -> float:
    r"""Return the shape factor of :func:`bonded_cylinder` for a rectangular block.

    With r its narrow side over its wide one, :math:`f_0 = (A S + B S^2 + \beta C S^3)/(1 + C S)`,
    A, B and C quadratic in r, and

    .. math:: \beta = \tfrac43 (1 + r)^2 \Bigl[1 - \frac{192\,r}{\pi^5}
        \sum_{n = 1, 3, \ldots} \frac{\tanh(n\pi/2r)}{n^5}\Bigr]

    of the thin layer: 2.249 of a square, 4/3 of a strip. The constants are fitted to finite
    elements (CalculiX C3D20R, graded to the edges): within 1.3 % of them for S of 0.05 to 2, r of
    0.2 to 1 and Poisson's ratios of 0.35 to 0.4999.

    Parameters
    ----------
    S : float
        ab / 2h(a + b).
    aspect : float
        r, above 0 to 1.
    poisson : float

    >>> round(bonded_block(0.25, 1.0, 0.4985), 3), round(bonded_block(1.0, 0.4, 0.4985), 3)
    (1.238, 3.081)
    """
    n, r = np.arange(1, 20, 2), aspect
    thin_part = (
        4 / 3 * (1 + r) ** 2 * (1 - 192 * r / np.pi**5 * np.sum(np.tanh(n * np.pi / 2 / r) / n**5))
    )
    A, B, C = (float(np.polyval(values[::-1], r)) for values in _BLOCK_COEFFICIENTS)
    return _compressible(
        (A * S + B * S**2 + thin_part * C * S**3) / (1 + C * S),
        S,
        poisson,
        _BLOCK_EDGE_COEFFICIENTS,
    )


class Geometry:
    """Geometry of a rubber part under load.

    A shape gives :meth:`factor`, and the ways to load it.
    """

    modes: tuple[PartMode, ...] = ("compression", "shear")

    def factor(self, mode: PartMode | None = None, *, bonded: bool = True) -> float:
        """Return stiffness of the part over Young's modulus, m (m^3 in torsion).

        Parameters
        ----------
        mode : str, optional
            How it is loaded; by default the first of `modes`.
        bonded : bool
            To its plates; False if they are lubricated.

        Raises
        ------
        DataError
            If the shape is not loaded so.
        """
        requested = mode or self.modes[0]
        if requested not in self.modes:
            raise DataError(
                f"a {type(self).__name__.lower()} in {requested}; expected one of "
                f"{', '.join(self.modes)}"
            )
        if requested == "shear" and not bonded:
            raise DataError("a lubricated part carries no shear; leave one of the two out")
        return self._factor(requested, bonded)

    def _factor(self, mode: PartMode, bonded: bool) -> float:
        raise NotImplementedError


class _Pad(Geometry):
    """A flat piece between two plates."""

    @property
    def area(self) -> float:
        """Area of each plate, m^2."""
        raise NotImplementedError

    @property
    def shape_factor(self) -> float:
        """S: the loaded area over the one that is free to bulge."""
        raise NotImplementedError

    height: float
    poisson: float

    def _factor(self, mode: PartMode, bonded: bool) -> float:
        plain_ratio = self.area / self.height
        if mode == "shear":
            return plain_ratio / 3
        return plain_ratio * (self._compute_bonded_factor() if bonded else 1)

    def _compute_bonded_factor(self) -> float:
        """Return the stiffness factor of bonded plates."""
        raise NotImplementedError


@dataclass(frozen=True)
class Disc(_Pad):
    """Round pad: diameter and height, m; texts with a unit are allowed.

    `poisson`, 0.2 to 0.5, is asked where its plates are bonded.

    >>> disc = Disc("20mm", "20mm")
    >>> round(disc.factor(bonded=False), 6), round(disc.shape_factor, 3)
    (0.015708, 0.25)
    >>> round(disc.factor() / disc.factor(bonded=False), 4)
    1.192
    """

    diameter: float
    height: float
    poisson: float = field(default=RUBBER_POISSON_RATIO, kw_only=True)

    def __post_init__(self) -> None:
        _lengths(self, "diameter", "height")
        _require_rubber_poisson(self.poisson)

    @property
    def area(self) -> float:
        """Area of each plate, m^2."""
        return float(np.pi / 4 * self.diameter**2)

    @property
    def shape_factor(self) -> float:
        """S = D / 4h."""
        return self.diameter / (4 * self.height)

    def _compute_bonded_factor(self) -> float:
        return bonded_cylinder(self.shape_factor, self.poisson)


@dataclass(frozen=True)
class Block(_Pad):
    """Rectangular pad: length, width and height, m; `poisson` as of a :class:`Disc`."""

    length: float
    width: float
    height: float
    poisson: float = field(default=RUBBER_POISSON_RATIO, kw_only=True)

    def __post_init__(self) -> None:
        _lengths(self, "length", "width", "height")
        _require_rubber_poisson(self.poisson)

    @property
    def area(self) -> float:
        """Area of each plate, m^2."""
        return self.length * self.width

    @property
    def shape_factor(self) -> float:
        """S = ab / 2h(a + b)."""
        return self.area / (2 * self.height * (self.length + self.width))

    def _compute_bonded_factor(self) -> float:
        width, length = sorted((self.length, self.width))
        return bonded_block(self.shape_factor, width / length, self.poisson)


@dataclass(frozen=True)
class Bush(Geometry):
    """Rubber bush between two sleeves: inner and outer diameter and length, m."""

    inner: float
    outer: float
    length: float

    modes = ("axial", "torsion", "radial-short", "radial-long")

    def __post_init__(self) -> None:
        _lengths(self, "inner", "outer", "length")
        if self.inner >= self.outer:
            raise DataError(
                f"a bush of {self.inner} m inside and {self.outer} m outside; expected more outside"
            )

    def _factor(self, mode: PartMode, bonded: bool) -> float:
        if not bonded:
            raise DataError("a bush is bonded to its sleeves; leave the lubrication out")
        a, b, L = (float(value) / 2 for value in (self.inner, self.outer, 2 * self.length))
        if mode == "axial":
            return float(2 * np.pi * L / np.log(b / a) / 3)
        if mode == "torsion":
            return float(4 * np.pi * L / (a**-2 - b**-2) / 3)
        square, log = a**2 + b**2, np.log(b / a)
        if mode == "radial-long":
            return float(4 * np.pi * L * square / (square * log - (b**2 - a**2)) / 3)
        return float(80 * np.pi * L * square / (25 * square * log - 9 * (b**2 - a**2)) / 3)


@dataclass(frozen=True)
class Bulb(Geometry):
    """Hollow round seal, slightly compressed across: outer diameter, wall and length, m.

    A thin wall that bends. Its stretch and shear, omitted, make it softer: by 2.5 % at a wall of a
    tenth of the mean radius, 9 % at a fifth. `poisson` is Poisson's ratio of the wall; a sponge has
    a lower one than solid rubber.

    >>> bulb = Bulb(0.022, 0.002, 0.1, poisson=0.45)
    >>> round(2e6 * bulb.factor())  # N/m of 100 mm, of 2 MPa
    1124
    """

    outer: float
    wall: float
    length: float
    poisson: float = field(default=0.5, kw_only=True)

    modes = ("compression",)

    def __post_init__(self) -> None:
        _lengths(self, "outer", "wall", "length")
        if not self.wall <= _MAX_THIN_RATIO * self.radius:
            raise DataError(
                f"a bulb of {self.outer:g} m with a wall of {self.wall:g} m is no thin ring; "
                f"expected a wall of at most {_MAX_THIN_RATIO:g} of its mean radius"
            )
        if not 0 <= self.poisson <= 0.5:
            raise DataError(f"poisson = {self.poisson!r}; expected 0 to 0.5")

    @property
    def radius(self) -> float:
        """Radius of the middle of the wall, m."""
        return (self.outer - self.wall) / 2

    # one way to be loaded, whatever its plates
    def _factor(self, mode: PartMode, bonded: bool) -> float:  # noqa: ARG002
        bending = self.length * self.wall**3 / (12 * (1 - self.poisson**2))
        return float(bending / ((np.pi / 4 - 2 / np.pi) * self.radius**3))


_MAX_THIN_RATIO = 0.3


def _require_rubber_poisson(poisson: float) -> None:
    if not _MIN_POISSON_RATIO <= poisson <= 0.5:
        raise DataError(
            f"poisson = {poisson!r}; expected {_MIN_POISSON_RATIO:g} to 0.5. A foam has 0.3 to "
            f"0.45, a rubber {RUBBER_POISSON_RATIO:g}"
        )


def _lengths(shape: Geometry, *names: str) -> None:
    for name in names:
        value = convert_to_si(getattr(shape, name), "length")
        if not (np.isfinite(value) and value > 0):
            raise DataError(f"{type(shape).__name__}: {name} = {value!r} m; expected a length > 0")
        object.__setattr__(shape, name, float(value))


def find_shape(words: str) -> Geometry:
    """Return the shape that words name, its lengths with their units: ``"disc:20mm,20mm"``.

    >>> find_shape("disc:20mm,10mm")
    Disc(diameter=0.02, height=0.01, poisson=0.4995)

    Raises
    ------
    DataError
        If there is no such shape, or it has other lengths.
    """
    shapes: dict[str, type[Geometry]] = {"disc": Disc, "block": Block, "bush": Bush, "bulb": Bulb}
    name, _, lengths = words.partition(":")
    if name not in shapes:
        raise DataError(f"'{words}' is no shape. Write {', '.join(shapes)}, such as disc:20mm,20mm")
    kind = shapes[name]
    requested = [attribute.name for attribute in fields(kind) if not attribute.kw_only]  # type: ignore[arg-type]
    dimensions = lengths.split(",")
    if len(dimensions) != len(requested):
        raise DataError(
            f"'{words}' has {format_count(len(dimensions), 'length')}; expected {len(requested)}: "
            f"{', '.join(requested)}, with their units and commas between them"
        )
    return kind(*(convert_to_si(dimension.strip(), "length") for dimension in dimensions))
