r"""Where stiffness and loss factor are known, over every spectrum that a test does not reject.

At a line :math:`\omega` the limits of the loss factor :math:`\eta = K''/K'` follow by Dinkelbach's
iteration (*Management Science* 13, 1967), which starts from that of the fit. Those of
:math:`|K^*|` are of its part along that of the fit,

.. math:: |K^*| \cos(\phi - \phi_0) = K'\cos\phi_0 + K''\sin\phi_0,

which is linear in the spectrum, over the cosine of the widest angle that the loss factor allows. Of
creep :math:`J^* = 1/K^*` takes the place of K*: its angle and its size are as well known.

The valid band ends where the loss factor is not known to 30 %, above or below a gap of the data,
too: there an arm may stand that nothing shows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.datamodel.band_error import WELL_KNOWN, BandError
from dashpot.fitting.known_band import find_loss_factor_band
from dashpot.fitting.relaxation_data import RelaxationRows
from dashpot.fitting.uncertainty.admissible_spectra import AdmissibleSpectra
from dashpot.fitting.uncertainty.curve_data import CurveData
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid

#: a ratio is found when a step moves it by less than this part of the way from where it started
SETTLED = 0.02
#: a stiffness whose limits are no farther apart, as a factor, is as good as known
NARROW = 1.25
#: steps of a ratio, at most
STEPS = 8
#: lines over a band on which the least loss factor is sought
OF_A_HOLD = 9
#: lines over the band of a curve, at least
FEWEST = 3
#: lines to a decade of a curve, which may have gaps
PER_DECADE = 3
#: grid of relaxation times that is left for a hold, decades
THINNED = 0.15
#: arms are as fast as this part of the first time of a curve
EARLIER = 0.1
#: what relaxes before the first time of a curve, over its modulus there, at least
LITTLE = 0.01
#: a dashpot beside a curve counts so many times as much as an arm of its first time
UNSHOWN = 100.0


@dataclass(frozen=True, eq=False)
class ErrorsAbout:
    """Relative errors of a fitted solid over some spectra.

    Attributes
    ----------
    spectra : AdmissibleSpectra
    solid : Solid
    creep : bool
        The spectra are of compliance.
    stiffness : float or None
        The relative error of the stiffness at every line, where it is known already.
    """

    spectra: AdmissibleSpectra
    solid: Solid
    creep: bool = False
    stiffness: float | None = None

    def __call__(self, frequency: float) -> tuple[float, float]:
        """Return those of stiffness and of loss factor at a frequency, Hz."""
        omega = 2 * np.pi * frequency
        K = complex(self.solid.complex_stiffness(omega=omega))
        columns = self.spectra.compliance_at if self.creep else self.spectra.stiffness_at
        storage, loss = columns(omega)
        if not self.spectra.shown[1]:
            # data without a column of a dashpot: the fastest arm stands for it
            loss[1] = 0.0
        size, angle = (1 / abs(K) if self.creep else abs(K)), float(np.angle(K))
        eta = K.imag / K.real if K.real > 0 else np.inf
        if self.stiffness is None:
            least, most = self.spectra.reach(storage * np.cos(angle) + loss * np.sin(angle))
        else:
            least, most = size / (1 + self.stiffness), size * (1 + self.stiffness)
        spread = most / least if least > 0 else np.inf
        low, high = (
            _largest_ratio(self.spectra, sign * loss, storage, sign * eta, spread)
            for sign in (-1, 1)
        )
        if self.stiffness is not None:
            return self.stiffness, _relative(-low, eta, high)
        widest = max(abs(np.arctan(end) - angle) for end in (-low, high))
        most /= max(float(np.cos(widest)), 1e-9)
        return _relative(max(least, 0.0), size, most), _relative(-low, eta, high)


def _largest_ratio(
    spectra: AdmissibleSpectra, above: FloatArray, below: FloatArray, start: float, spread: float
) -> float:
    """Return the largest (above . k) / (below . k), at least `start`.

    The gain g of a step from r to r + g/(below . k) bounds the ratio by r + g/b, b the least of
    below . k: of a below . k that does not `spread` much one step is enough.
    """
    ratio = start
    for _ in range(STEPS):
        values = spectra.find_extreme_spectrum(above - ratio * below)
        if not np.isfinite(values).all():
            return np.inf
        base = float(below @ values)
        larger = float(above @ values) / base if base > 0 else -np.inf
        if not larger > ratio:
            break
        change, ratio = larger - ratio, larger
        if spread <= NARROW:
            return start + spread * change
        if change <= SETTLED * (ratio - start):
            break
    return ratio


def _relative(low: float, value: float, high: float) -> float:
    """Return by how much a value may lie off, relative to itself or to the truth."""
    if not (low > 0 and value > 0 and np.isfinite(high)):
        return np.inf
    return float(max(high / value, value / low, 1.0) - 1)


# -- a band ---------------------------------------------------------------------------------------


def band_of_hold(
    spectra: AdmissibleSpectra, solid: Solid, band: tuple[float, float]
) -> tuple[tuple[float, float], BandError | None]:
    """Return the valid band of a hold, and how well its solid is known there.

    Parameters
    ----------
    spectra : AdmissibleSpectra
        What the holds do not reject.
    solid : Solid
        The fit.
    band : (float, float)
        The frequencies that the test informs, Hz.
    """
    if not _has_loss_band(solid, band):
        return band, None
    errors = ErrorsAbout(spectra.reduce_grid(THINNED), solid)
    ends = [errors(line) for line in band]
    # of a hold the stiffness is known alike over the band: what its ends say is enough
    between = replace(errors, stiffness=max(stiffness for stiffness, _ in ends))
    lines = dict(zip(band, ends, strict=True))
    at = np.geomspace(*band, OF_A_HOLD)
    K = solid.complex_stiffness(omega=2 * np.pi * at)
    eta = K.imag / K.real
    if all(error > WELL_KNOWN for _, error in ends):
        # best known where there is most of it
        inner = [*np.argsort(-eta).tolist()]
    else:
        # and worst where there is least: at an end, as a rule
        inner = [int(np.argmin(eta))]
    for place in inner:
        if 0 < place < len(at) - 1:
            lines[float(at[place])] = between(float(at[place]))
            if lines[float(at[place])][1] <= WELL_KNOWN:
                break
    lines = dict(sorted(lines.items()))
    return find_loss_factor_band(between, band, lines)


def band_of_curve(
    spectra: AdmissibleSpectra,
    solid: Solid,
    band: tuple[float, float],
    *,
    creep: bool = False,
) -> tuple[tuple[float, float], BandError | None]:
    """Return the valid band of a curve, which ends at a gap, and how well its solid is known there.

    The parameters are those of :func:`band_of_hold`; `creep` where the spectra are of compliance.
    """
    if not _has_loss_band(solid, band):
        return band, None
    count = int(np.ceil(PER_DECADE * np.log10(band[1] / band[0]))) + 1
    lines = np.geomspace(*band, max(count, FEWEST)).tolist()
    errors = ErrorsAbout(spectra.reduce_grid(0.0), solid, creep)
    return find_loss_factor_band(errors, band, {line: errors(line) for line in lines})


@dataclass(frozen=True, eq=False)
class BeforeCurve:
    """A relaxation modulus, and what may relax before its first value.

    No value shows an arm that is faster than the first time. All of them together are as stiff as
    what the curve shows of its first decade, one standard deviation; a part of `LITTLE` at least.

    Attributes
    ----------
    data : CurveData
    first : float
        The first time after the step, s.
    solid : GeneralizedMaxwell
        The fit.
    """

    data: CurveData
    first: float
    solid: GeneralizedMaxwell

    @property
    def window(self) -> tuple[float, float]:
        """Shortest and longest relaxation time that is asked about, s."""
        return EARLIER * self.first, self.data.window[1]

    @property
    def dof(self) -> float:
        """Degrees of freedom of the noise."""
        return self.data.dof

    def rows(self, log_tau: FloatArray, *, slopes: bool = True) -> RelaxationRows:
        """Those of the curve, and one of what may relax before it."""
        rows = self.data.rows(log_tau, slopes=slopes)
        start, later = (float(self.solid.relaxation(n * self.first)) for n in (1.0, 10.0))
        weight = 1 / max(start - later, LITTLE * start)
        # how much of an arm is gone at the first time
        before = -np.expm1(-self.first / np.exp(log_tau)) * weight
        relaxed = float(self.solid.relaxation(0.0)) - start
        return rows._replace(
            target=np.append(rows.target, relaxed * weight),
            spring=np.append(rows.spring, 0.0),
            # a dashpot is no arm that a curve can show
            dashpot=np.append(rows.dashpot, UNSHOWN * weight / self.first),
            arms=np.vstack((rows.arms, before)),
            slopes=np.vstack((rows.slopes, np.zeros(len(log_tau)))) if slopes else rows.slopes,
        )


def _has_loss_band(solid: Solid, band: tuple[float, float]) -> bool:
    """Whether there is a band, and a solid that has a loss."""
    return 0 < band[0] < band[1] < np.inf and sum(solid.maxwell.k) > 0
