"""Seal along a line: its section per metre, friction, and springs at stations."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass
from dashpot.base.arrays import EqualByValue, FloatArray
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, convert_to_si
from dashpot.base.value_ranges import SIZES
from dashpot.datamodel.fit import Fit
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.maxwell import Solid

ShearStiffness: TypeAlias = float | Solid
"""Factor on the normal stiffness at the same place, or a stiffness of its own, N/m per m."""


@dataclass(frozen=True)
class Shear:
    """Shear stiffness of a compressed seal.

    A ratio is of the stiffness normal to the line at the same place: it follows compression and
    joints, and has the same arms. A solid of its own is one metre of seal as it was moved
    sideways at the depth of its test; it is the same wherever the seal touches, but at joints.

    Attributes
    ----------
    across : float or Solid
        Square to the line and to the way in which the seal is pressed; 0 is none.
    along : float or Solid
        Along the line.
    band : (float, float) or None
        The frequencies, Hz, that the tests of its own solids inform; None where it has none.
    """

    across: ShearStiffness = 0.0
    along: ShearStiffness = 0.0
    band: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        for name in ("across", "along"):
            ratio = getattr(self, name)
            if not isinstance(ratio, Solid) and not 0 <= ratio <= MAX_STIFFNESS_RATIO:
                raise DataError(
                    f"shear: {name} = {ratio:g}; expected 0 to {MAX_STIFFNESS_RATIO:g} of the "
                    "stiffness normal to the line, such as 0.35, or the seal's own stiffness "
                    "that way"
                )

    @property
    def holds(self) -> bool:
        """Whether the seal has lateral stiffness."""
        return not (self.across == self.along == 0)


@dataclass(frozen=True)
class LineFriction:
    r"""Friction of a seal in shear beside its arms: a Jenkins element.

    .. math:: k_t = r\,\kappa_\infty\,\Delta s, \qquad F_c = \mu\,F_e(x)\,\Delta s

    of a station at a compression x: it sticks with a share r of the relaxed stiffness normal to
    the line there, and slips at mu times the relaxed force by which the seal is pressed.

    Attributes
    ----------
    mu : float
        > 0.
    across, along : float
        The share r either way; 0 is none.
    """

    mu: float
    across: float = 0.0
    along: float = 0.0

    def __post_init__(self) -> None:
        if not 0 < self.mu <= MAX_FRICTION:
            raise DataError(
                f"friction: mu = {self.mu:g}; expected more than 0 and at most {MAX_FRICTION:g}, "
                "such as 0.4"
            )
        for name in ("across", "along"):
            ratio = getattr(self, name)
            if not 0 <= ratio <= MAX_STIFFNESS_RATIO:
                raise DataError(
                    f"friction: {name} = {ratio:g}; expected 0 to {MAX_STIFFNESS_RATIO:g} of the "
                    "relaxed stiffness normal to the line, such as 0.15"
                )
        if self.across == self.along == 0:
            raise DataError(
                "friction: neither across nor along is given; expected the share of the relaxed "
                "stiffness with which the seal sticks, such as across = 0.15"
            )


MAX_FRICTION = 3.0
"""No dry rubber rubs more."""
MAX_STIFFNESS_RATIO = SIZES["shear"].hard[1]
"""A seal is softer sideways than in compression; far beyond, it is a percentage."""


@dataclass(frozen=True)
class SealSection:
    r"""Section of a seal: the properties of one metre.

    All its arms answer the relaxed force (Fung), so that small vibration about a compression x
    feels :math:`F_e'(x)/k` times the solid, k its secant stiffness at the depth tested.

    Attributes
    ----------
    solid : Solid
        N/m per m, the secant at the depth tested.
    law : ElasticLaw or None
        Relaxed force per metre, N/m; None is a straight line.
    band : (float, float) or None
        Frequencies of the valid band of its test, Hz.
    shear : Shear
        None by default: the seal has no lateral stiffness.
    friction : LineFriction or None
        Friction in parallel.
    """

    solid: Solid
    law: ElasticLaw | None = None
    band: tuple[float, float] | None = None
    shear: Shear = Shear()
    friction: LineFriction | None = None

    def __post_init__(self) -> None:
        for name in ("across", "along") if self.friction else ():
            if getattr(self.friction, name) > 0 and getattr(self.shear, name) == 0:
                raise DataError(
                    f"friction rubs {name} the line, where the seal has no shear: give {name} in "
                    "[seal.shear], too (Python: Shear)"
                )

    @classmethod
    def from_fit(
        cls,
        fit: Fit,
        *,
        length: Quantity | None = None,
        temperature: Quantity | None = None,
        shear: Shear | None = None,
        friction: LineFriction | None = None,
    ) -> SealSection:
        """One metre of the tested seal.

        Parameters
        ----------
        fit : Fit
            Fit of a specimen of seal.
        length : str or float, optional
            Length of that specimen, m; by default the length in the fit.
        temperature : str or float, optional
            K; by default that of the fit.
        shear : Shear, optional
            Lateral stiffness; none by default.
        friction : LineFriction, optional
            Friction in parallel; none by default.

        Raises
        ------
        DataError
            If the length is not known, or the fit is of a material or not at that temperature.
        """
        shifted_fit = fit if temperature is None else fit.at_temperature(temperature)
        if shifted_fit.unit != "N/m":
            raise DataError(
                f"the fit is of a material, in {shifted_fit.unit}: a seal line needs a part's"
            )
        metres = shifted_fit.specimen.length if length is None else convert_to_si(length, "length")
        if metres is None or not (np.isfinite(metres) and metres > 0):
            text = "is not known" if metres is None else f"is {metres!r} m"
            raise DataError(
                f"the length of the tested specimen of seal {text}; expected one > 0, of "
                'which the stiffness of a metre follows: length = "100mm" in [seal] '
                "(Python: length=)"
            )
        law = shifted_fit.elastic_law
        elastic_law = None if law is None or law.kind == "linear" else law * (1 / metres)
        return cls(
            (1 / metres) * shifted_fit.solid,
            elastic_law,
            shifted_fit.band,
            shear or Shear(),
            friction,
        )

    def path(self, compression: npt.ArrayLike) -> FloatArray:
        """Return the displacement, m, that loads the solid; less where the law starts softer.

        The force of a history of compressions is that of the solid under this one.
        """
        x = np.maximum(np.asarray(compression, dtype=float), 0.0)
        return x if self.law is None else self.law.path(x)

    def force(self, compression: npt.ArrayLike) -> FloatArray:
        """Relaxed force per metre, N/m; none where it does not touch."""
        return np.asarray(self.solid.k_inf * self.path(compression))

    def factor(self, compression: npt.ArrayLike) -> FloatArray:
        """Tangent stiffness over that of the solid; 0 without contact."""
        x = np.asarray(compression, dtype=float)
        tangent = np.ones_like(x) if self.law is None else self.law.factor(x)
        return np.where(x < 0, 0.0, tangent)

    def ways(self, stations: Stations) -> tuple[LineDirection, ...]:
        """Return the stiffness of the stations normal to the line, across and along it.

        Raises
        ------
        DataError
            If the seal is not linear, or rubs, and its compression is not stated.
        """
        station_lengths, depths = stations.length * stations.factor, stations.compression
        direction_lengths = station_lengths
        if depths is not None:
            direction_lengths, station_lengths = (
                direction_lengths * self.factor(depths),
                np.where(depths < 0, 0.0, station_lengths),
            )
        elif self.law is not None and self.law.kind != "linear":
            raise DataError(
                "the seal is not linear and how far it is pressed along the line is not stated; "
                "give its compression, or gap and height"
            )
        directions = [LineDirection(self.solid, direction_lengths, stations.normal)]
        for name, direction in (("across", stations.across), ("along", stations.tangent)):
            solid, friction = getattr(self.shear, name), None
            if self.friction is not None:
                slip_force = getattr(self.friction, name) * self.solid.k_inf * direction_lengths
                friction = (slip_force, self._slip(stations))
            if isinstance(solid, Solid):
                directions.append(LineDirection(solid, station_lengths, direction, friction))
            else:
                directions.append(
                    LineDirection(self.solid, solid * direction_lengths, direction, friction)
                )
        return tuple(directions)

    def _slip(self, stations: Stations) -> FloatArray:
        """Return force at which each station slips sideways, N, shape (n,)."""
        if self.friction is None or stations.compression is None:
            raise DataError(
                "friction of a seal line follows from the force by which it is pressed, and its "
                "compression is not stated; give its compression, or gap and height"
            )
        force = self.force(stations.compression)
        return np.asarray(self.friction.mu * force * stations.length * stations.factor)


@dataclass(frozen=True, eq=False)
class LineDirection:
    """Springs of a line in one direction.

    Attributes
    ----------
    solid : Solid
        N/m per m.
    share : array, shape (n,)
        Metres of it that each station is; 0 where it does not answer.
    direction : array, shape (n, 3)
    friction : (array, array) or None
        Stiffness, N/m, of the friction element of each station, and force, N, at which it slips.
    """

    solid: Solid
    share: FloatArray
    direction: FloatArray
    friction: tuple[FloatArray, FloatArray] | None = None


@dataclass(frozen=True, eq=False)
class Stations(EqualByValue):
    r"""Stations of a line: the two Gauss points of each of its cells.

    .. math:: s_{1,2} = s_m \mp \frac{h}{2\sqrt 3}

    of a cell of length h about :math:`s_m`, each for half of it: what is a cubic along the cell,
    as the stiffness of a straight one about any axis is, they sum exactly.

    Attributes
    ----------
    along : array, shape (n,)
        From the first point, m.
    place, normal, tangent : array, shape (n, 3)
        m; the direction in which the seal is pressed there, of length 1; and that in which the
        line runs, square to it.
    length : array, shape (n,)
        Length of seal represented by each, m: together the whole line.
    factor : array, shape (n,)
        Stiffness over that of the seal: 1 but at joints.
    compression : array, shape (n,), or None
        m, below 0 by as much as the seal does not reach; None where it is not stated.
    """

    along: FloatArray
    place: FloatArray
    normal: FloatArray
    tangent: FloatArray
    length: FloatArray
    factor: FloatArray
    compression: FloatArray | None = None

    @property
    def across(self) -> FloatArray:
        """Square to both, shape (n, 3)."""
        return np.cross(self.normal, self.tangent)
