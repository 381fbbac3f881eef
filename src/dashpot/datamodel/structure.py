"""Structure measured at several points: its FRFs, mode shapes and free modes."""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import ComplexArray, EqualByValue, FloatArray
from dashpot.base.errors import DataError
from dashpot.base.result_mixins import load_function
from dashpot.base.units import Range, si_range
from dashpot.datamodel.frf import FRF, Kind, Mode

# FRFs and mode shapes.


LINE_TOLERANCE = 1e-6
"""Relative difference of a frequency in files that round it differently."""


@dataclass(frozen=True, eq=False)
class FRFSet(EqualByValue):
    """FRFs of one structure at several points, on the same lines, under the same window.

    Attributes
    ----------
    frfs : tuple of FRF
        Motion per force, of any kind.
    points : tuple of str
        Name of each FRF, such as ``"3+Z/1+Z"``: response point and excitation point. By default
        their numbers.

    Examples
    --------
    >>> import dashpot as dp, numpy as np
    >>> t = np.linspace(0, 10, 50)
    >>> one = dp.FRF(frequency=t, value=t + 1j, units="Hz, (m/s^2)/N")
    >>> dp.FRFSet((one, one), ("1+Z/1+Z", "2+Z/1+Z")).points
    ('1+Z/1+Z', '2+Z/1+Z')
    """

    frfs: tuple[FRF, ...]
    points: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "frfs", tuple(self.frfs))
        if not self.frfs:
            raise DataError("there is no FRF in the set; expected one or more")
        names = tuple(self.points) or tuple(str(i + 1) for i in range(len(self.frfs)))
        object.__setattr__(self, "points", names)
        if len(names) != len(self.frfs) or len(set(names)) < len(names):
            raise DataError(
                f"{len(set(names))} different names of points for {len(self.frfs)} FRFs; "
                "expected one name each"
            )
        first_frf = self.frfs[0]
        for name, frf in zip(names, self.frfs, strict=True):
            if frf.quantity.over_base != first_frf.quantity.over_base:
                raise DataError(
                    f"the quantity of '{name}' is {frf.quantity.label}, that of '{names[0]}' "
                    f"{first_frf.quantity.label}; expected "
                    "motions over that of a base, or motions per force, at every point (Python: "
                    "frf.to('accelerance', mass=m))"
                )
            self._refuse_other_lines(name, frf, first_frf)

    def _refuse_other_lines(self, name: str, frf: FRF, first_frf: FRF) -> None:
        frequency, first_frequency = frf.frequency, first_frf.frequency
        if len(frequency) != len(first_frequency) or not np.allclose(
            frequency, first_frequency, rtol=LINE_TOLERANCE, atol=0
        ):
            raise DataError(
                f"'{name}' has {len(frequency)} lines from {frequency[0]:.6g} to "
                f"{frequency[-1]:.6g} Hz, '{self.points[0]}' {len(first_frequency)} from "
                f"{first_frequency[0]:.6g} to {first_frequency[-1]:.6g} Hz; poles "
                "common to several points need the same lines at each: export them alike"
            )
        if (frf.shift, frf.record) != (first_frf.shift, first_frf.record):
            raise DataError(
                f"'{name}' has another window or another length of record than "
                f"'{self.points[0]}'; expected the same at every point: average them alike"
            )

    @property
    def over_base(self) -> bool:
        """Whether they are transmissibilities from a base."""
        return self.frfs[0].quantity.over_base

    def per_force(self, *, mass: float) -> FRFSet:
        """Return the FRFs as motions per force, for a mass, kg, on the base, if they are not yet.

        Poles and damping do not depend on that mass.
        """
        if not self.over_base:
            return self
        frfs = tuple(frf.to(Kind.ACCELERANCE, mass=mass) for frf in self.frfs)
        return FRFSet(frfs, self.points)

    @property
    def accelerance(self) -> ComplexArray:
        """1/kg, shape (points, n)."""
        return np.array([frf.to(Kind.ACCELERANCE).value for frf in self.frfs])

    @property
    def sd(self) -> FloatArray | None:
        """Standard deviation of the accelerance, 1/kg, shape (points, n); None if one has none."""
        columns = [frf.to(Kind.ACCELERANCE).random_sd for frf in self.frfs]
        arrays = [column for column in columns if column is not None]
        return np.array(arrays) if len(arrays) == len(columns) else None

    def modes(
        self, *, band: Range | None = None, count: int | None = None
    ) -> tuple[ModeShape, ...]:
        """Modes common to all points, the one that moves most first; see :class:`ModeShape`.

        Parameters
        ----------
        band : (float, float) or str, optional
            Hz, ``"4:40Hz"``; by default two octaves to either side of where the points together
            move most.
        count : int, optional
            Exactly this many; by default the significant ones.

        Raises
        ------
        DataError
            If the band holds too few lines.
        """
        shapes: tuple[ModeShape, ...] = load_function(
            "vibration.modal.modal_methods", "find_shapes"
        )(self, band=si_range(band, "frequency"), count=count)
        return shapes


@dataclass(frozen=True, eq=False)
class ModeShape(EqualByValue):
    """Mode and its motion at each point.

    Attributes
    ----------
    mode : Mode
        Pole and errors; its residue is that of the point with the largest motion.
    residues : complex array, shape (n,)
        Residues of the receptances at n points, m/(N s).
    residue_se : array, shape (n,)
        Their standard errors.
    misfit : float
        Squared misfit of the lines about the mode over its variance, for each degree of freedom.
    """

    mode: Mode
    residues: ComplexArray
    residue_se: FloatArray
    misfit: float
