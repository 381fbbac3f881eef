r"""From a material's modulus to the stiffness of a part: :math:`K^* = g\,E^*`.

The geometry factor g, m (m^3 for torsion), of rubber parts that are small against the wave in
them and nearly incompressible, :math:`G = E/3`:

- compression between plates: :math:`g = A/h` lubricated, :math:`(A/h)(1 + 2 S^2)` bonded, with the
  shape factor S, loaded over free area (A. N. Gent and P. B. Lindley, Proc. IMechE 173 (1959)
  111);
- shear: :math:`A / 3h`;
- a bonded bush of radii a < b and length L: axially :math:`2\pi L / 3 \ln(b/a)`, in torsion
  :math:`4\pi L / 3 (a^{-2} - b^{-2})`, radially as the short or the long bush of J. E. Adkins and
  A. N. Gent, Brit. J. Appl. Phys. 5 (1954) 354, between which a real one lies;
- a thin hollow bulb of wall t and mean radius R, pressed across between plates, is a ring under two
  opposite loads (S. Timoshenko, Strength of Materials):
  :math:`L t^3 / 12(1 - \nu^2)(\pi/4 - 2/\pi) R^3`.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dashpot.base.choices import PartMode
from dashpot.base.errors import DataError
from dashpot.base.units import si


class Geometry:
    """A shape of rubber that loads go through.

    A shape gives :meth:`factor`, and the ways to load it.
    """

    modes: tuple[PartMode, ...] = ("compression", "shear")

    def factor(self, mode: PartMode | None = None, *, bonded: bool = True) -> float:
        """Stiffness of the part over Young's modulus, m (m^3 in torsion).

        Parameters
        ----------
        mode : str, optional
            How it is loaded; by default the first of `modes`.
        bonded : bool
            To its plates; False where they are lubricated.

        Raises
        ------
        DataError
            If the shape is not loaded so.
        """
        asked = mode or self.modes[0]
        if asked not in self.modes:
            raise DataError(
                f"a {type(self).__name__.lower()} in {asked}; expected one of "
                f"{', '.join(self.modes)}"
            )
        if asked == "shear" and not bonded:
            raise DataError("a lubricated part carries no shear; leave one of the two out")
        return self._factor(asked, bonded)

    def _factor(self, mode: PartMode, bonded: bool) -> float:
        raise NotImplementedError


class _Pad(Geometry):
    """A flat piece between two plates."""

    @property
    def area(self) -> float:
        """Of each plate, m^2."""
        raise NotImplementedError

    @property
    def shape_factor(self) -> float:
        """S: the loaded area over the one that is free to bulge."""
        raise NotImplementedError

    height: float

    def _factor(self, mode: PartMode, bonded: bool) -> float:
        plain = self.area / self.height
        if mode == "shear":
            return plain / 3
        return plain * (1 + 2 * self.shape_factor**2 if bonded else 1)


@dataclass(frozen=True)
class Disc(_Pad):
    """A round pad: diameter and height, m; texts with a unit are taken, too.

    >>> round(1e6 * Disc(0.02, 0.02).factor(), 3), round(Disc(0.02, 0.02).shape_factor, 3)
    (17671.459, 0.25)
    """

    diameter: float
    height: float

    def __post_init__(self) -> None:
        _lengths(self, "diameter", "height")

    @property
    def area(self) -> float:
        """Of each plate, m^2."""
        return float(np.pi / 4 * self.diameter**2)

    @property
    def shape_factor(self) -> float:
        """S = D / 4h."""
        return self.diameter / (4 * self.height)


@dataclass(frozen=True)
class Block(_Pad):
    """A rectangular pad: length, width and height, m."""

    length: float
    width: float
    height: float

    def __post_init__(self) -> None:
        _lengths(self, "length", "width", "height")

    @property
    def area(self) -> float:
        """Of each plate, m^2."""
        return self.length * self.width

    @property
    def shape_factor(self) -> float:
        """S = ab / 2h(a + b)."""
        return self.area / (2 * self.height * (self.length + self.width))


@dataclass(frozen=True)
class Bush(Geometry):
    """A tube of rubber between two sleeves: inner and outer diameter and length, m."""

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
        a, b, L = (float(one) / 2 for one in (self.inner, self.outer, 2 * self.length))
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
    """A hollow round seal that is pressed across, a little: outer diameter, wall and length, m.

    A thin wall that bends. Its stretch and shear, left out, make it softer: by 2.5 % at a wall of a
    tenth of the mean radius, 9 % at a fifth. `poisson` is that of the wall; a sponge has less
    than solid rubber.

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
        if not self.wall <= _THIN * self.radius:
            raise DataError(
                f"a bulb of {self.outer:g} m with a wall of {self.wall:g} m is no thin ring; "
                f"expected a wall of at most {_THIN:g} of its mean radius"
            )
        if not 0 <= self.poisson <= 0.5:
            raise DataError(f"poisson = {self.poisson!r}; expected 0 to 0.5")

    @property
    def radius(self) -> float:
        """Of the middle of the wall, m."""
        return (self.outer - self.wall) / 2

    # one way to be loaded, whatever its plates
    def _factor(self, mode: PartMode, bonded: bool) -> float:  # noqa: ARG002
        bending = self.length * self.wall**3 / (12 * (1 - self.poisson**2))
        return float(bending / ((np.pi / 4 - 2 / np.pi) * self.radius**3))


_THIN = 0.3


def _lengths(shape: Geometry, *names: str) -> None:
    for name in names:
        value = si(getattr(shape, name), "length")
        if not (np.isfinite(value) and value > 0):
            raise DataError(f"{type(shape).__name__}: {name} = {value!r} m; expected a length > 0")
        object.__setattr__(shape, name, float(value))
