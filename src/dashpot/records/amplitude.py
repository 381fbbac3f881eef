"""Amplitude sweeps: storage and loss against how far a part is moved."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import BoolArray, ByValue, ComplexArray, FloatArray, measured, same_length
from dashpot.base.checks import Check, Verdict, verdict
from dashpot.base.errors import DataError
from dashpot.base.offered import Described
from dashpot.base.provenance import Source, of_file
from dashpot.records.specimen import Specimen
from dashpot.solids.friction import Kraus
from dashpot.solids.softening import softened


@dataclass(frozen=True, eq=False, repr=False)
class AmplitudeSweep(ByValue, Described):
    """Storage and loss of one specimen at several amplitudes, at one frequency or a few.

    Attributes
    ----------
    frequency : array, shape (n,)
        Hz, > 0.
    amplitude : array, shape (n,)
        m, or a strain, > 0.
    storage, loss : array, shape (n,)
        Pa or N/m (`unit`).
    unit : str
        ``"Pa"`` or ``"N/m"``.
    of : str
        ``"m"`` or ``"strain"``: what the amplitude is of.
    specimen : Specimen
    source : Source or None

    Raises
    ------
    DataError
        If the arrays differ in length, are not finite, or a frequency or amplitude is not above 0.
    """

    frequency: FloatArray
    amplitude: FloatArray
    storage: FloatArray
    loss: FloatArray
    unit: str = "Pa"
    of: str = "strain"
    specimen: Specimen = field(default_factory=Specimen)
    source: Source | None = None

    def __post_init__(self) -> None:
        for name in ("frequency", "amplitude", "storage", "loss"):
            object.__setattr__(self, name, measured(name, getattr(self, name)))
        same_length(
            frequency=self.frequency,
            amplitude=self.amplitude,
            storage=self.storage,
            loss=self.loss,
        )
        for name, unit in (("frequency", "Hz"), ("amplitude", self.of)):
            values = getattr(self, name)
            bad = np.flatnonzero(values <= 0)
            if bad.size:
                raise DataError(f"{name}[{bad[0]}] = {values[bad[0]]:g} {unit}; expected > 0")
        if self.unit not in {"Pa", "N/m"} or self.of not in {"m", "strain"}:
            raise DataError(
                f"unit '{self.unit}' of storage and loss, '{self.of}' of amplitude; expected 'Pa' "
                "or 'N/m', and 'm' or 'strain'"
            )

    @property
    def described(self) -> tuple[str, ...]:
        """Which sweep it is, and what it covers."""
        tones = ", ".join(f"{one:.4g}" for one in np.unique(self.frequency))
        return (
            of_file(self.source, len(self.frequency)),
            (
                f"storage and loss in {self.unit} at {tones} Hz, amplitudes of "
                f"{self.amplitude.min():.3g} to {self.amplitude.max():.3g} {self.of}"
            ),
        )

    @property
    def value(self) -> ComplexArray:
        """Complex modulus or stiffness, in `unit`."""
        return np.asarray(self.storage + 1j * self.loss, dtype=complex)

    def only(self, chosen: BoolArray) -> AmplitudeSweep:
        """The chosen samples."""
        names = ("frequency", "amplitude", "storage", "loss")
        return replace(self, **{name: getattr(self, name)[chosen] for name in names})


@dataclass(frozen=True, eq=False, repr=False)
class AmplitudeFit(ByValue, Described):
    r"""What an amplitude sweep says of how stiffness and loss move with amplitude.

    ``"factor"``: :math:`K^*(\omega, X) = K^*(\omega)\,\phi(X)`; ``"additive"``:
    :math:`K^*(\omega) + d\,[\phi_1(X) - 1]`, with :math:`\phi_1` that of a share of 1;
    ``"none"``: no dependence is seen.

    Attributes
    ----------
    law : str
    frequency : array, shape (f,)
        Hz.
    linear : complex array, shape (f,)
        At a vanishing amplitude, in `unit`.
    lost : float
        d: share of the stiffness (factor), or stiffness in `unit` (additive), that is lost.
    half_way : float
        Amplitude X_c where half of it is lost.
    exponent : float
    se : tuple of (str, float)
        Standard errors of lost, half_way and exponent; 0 for an exponent that was set.
    amplitudes : (float, float)
        The range that the sweep informs.
    residual : float
        Rms of what is left, over the size of the modulus.
    orders : tuple of (str, float)
        BIC of each law that was tried, the smallest best.
    left_out : int
        Samples of the smallest amplitudes that scatter beyond the rest, and were left out.
    unit, of : str
        As in the sweep.
    checks : tuple of Check
    source : Source or None
    """

    law: str
    frequency: FloatArray
    linear: ComplexArray
    lost: float
    half_way: float
    exponent: float
    se: tuple[tuple[str, float], ...]
    amplitudes: tuple[float, float]
    residual: float
    orders: tuple[tuple[str, float], ...]
    left_out: int = 0
    unit: str = "Pa"
    of: str = "strain"
    checks: tuple[Check, ...] = ()
    source: Source | None = None

    @property
    def verdict(self) -> Verdict:
        """What to make of it."""
        return verdict(self.checks)

    @property
    def described(self) -> tuple[str, ...]:
        """The verdict, the law and its numbers."""
        judged = self.verdict
        lines = [f"{judged.use}: {judged.says}"]
        if self.law != "none":
            error = dict(self.se)
            size = (
                f"{100 * self.lost:.3g} %"
                if self.law == "factor"
                else f"{self.lost:.4g} {self.unit}"
            )
            lines.append(
                f"{self.law} law: {size} of the stiffness is lost with amplitude, half of it at "
                f"{self.half_way:.3g} +- {error['half_way']:.2g} {self.of}, exponent "
                f"{self.exponent:.2g}"
            )
        low, high = self.amplitudes
        lines.append(
            f"leaves {100 * self.residual:.2g} % rms from {low:.3g} to {high:.3g} {self.of}; "
            "beyond it nothing is known"
        )
        if self.left_out:
            lines.append(
                f"left out: {self.left_out} samples of the smallest amplitudes, that scatter"
            )
        return tuple(lines)

    def stiffness(self, amplitude: npt.ArrayLike, *, tone: int = 0) -> ComplexArray:
        """Complex stiffness, in `unit`, at amplitudes, at one of the frequencies."""
        return np.asarray(self.linear[tone] * self.ratio(amplitude, tone=tone))

    def ratio(self, amplitude: npt.ArrayLike, *, tone: int = 0) -> ComplexArray:
        """Complex stiffness at amplitudes over that at a vanishing one, at one frequency."""
        X = np.asarray(amplitude, dtype=float)
        if self.law == "none":
            return np.ones(X.shape, dtype=complex)
        if self.law == "factor":
            return softened(X, self.lost, self.half_way, self.exponent)
        change = softened(X, 1.0, self.half_way, self.exponent) - 1
        return np.asarray(1 + self.lost * change / complex(self.linear[tone]))

    def element(self, scale: float = 1.0, *, stretch: float = 1.0) -> Kraus:
        """The additive law as an element beside a solid.

        Parameters
        ----------
        scale : float
            N/m for each of `unit`: 1 for a part, area over height for a material.
        stretch : float
            m for each of `of`: 1 for a part, the height over the strain factor for a material.
        """
        if self.law != "additive":
            raise DataError(f"the law is '{self.law}'; only an additive law stands beside a solid")
        return Kraus(self.lost * scale, self.half_way * stretch, self.exponent)
