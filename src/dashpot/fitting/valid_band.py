"""Valid band of a fit: informed by the tests, with stiffness and loss known."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol, TypeAlias

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray, find_true_runs
from dashpot.datamodel.bounds import WELL_KNOWN, BandError
from dashpot.fitting.admissible_spectra import AdmissibleSpectra
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.log_tau_descent import Stack
from dashpot.solids.maxwell import Solid

# Part of a band in which the loss factor is known, with its error.


#: lines that are sought between one that is known and one that is not, at most
MOST_LINES_BETWEEN = 5
#: a band ends where the error is so much of the largest that is known, or within this of ln f
AT_END, PLACED = 0.85, 0.05
Errors: TypeAlias = Callable[[float], tuple[float, float]]


def find_loss_factor_band(
    errors: Errors,
    band: tuple[float, float],
    lines: Mapping[float, tuple[float, float]],
    *,
    around: float | None = None,
) -> tuple[tuple[float, float], BandError]:
    """Return the widest part of a band in which the loss factor is known, and how well.

    With `around` it is the part that holds this line. Where it is known at no line, or not at that
    one, the band stays as it is: the errors show that.

    Parameters
    ----------
    errors : callable
    band : (float, float)
        Hz.
    lines : mapping of float to (float, float)
        Errors at some lines of the band, Hz, increasing; its two ends among them.
    around : float, optional
        One of these lines, Hz.
    """
    at, every = np.array(list(lines)), dict(lines)
    certain = np.array([error[1] for error in lines.values()]) <= WELL_KNOWN
    if certain.all() or not certain.any():
        return band, _build_band_error(every)
    parts = find_true_runs(certain).tolist()
    if around is not None:
        parts = [part for part in parts if at[part[0]] <= around <= at[part[1]]]
        if not parts:
            return band, _build_band_error(every)
    first, last = max(parts, key=lambda run: at[run[1]] / at[run[0]])
    ends = []
    for inside, outside in ((first, first - 1), (last, last + 1)):
        end = float(at[inside])
        if 0 <= outside < len(at):
            end = _find_band_end(errors, every, end, float(at[outside]))
        ends.append(end)
    low, high = ends
    return (low, high), _build_band_error({f: e for f, e in every.items() if low <= f <= high})


def _find_band_end(
    errors: Errors, every: dict[float, tuple[float, float]], inside: float, outside: float
) -> float:
    """Return the last frequency found from one that is known towards one that is not."""
    for turn in range(MOST_LINES_BETWEEN):
        near, far = every[inside][1], every[outside][1]
        share = 0.5
        if 0 < near < WELL_KNOWN < far < np.inf:
            share = float(np.log(WELL_KNOWN / near) / np.log(far / near))
        # an error rises ever faster towards the end of a band: a straight line crosses too early
        share = min(max(share, 0.5 if turn else 0.1), 0.98)
        middle = inside * (outside / inside) ** share
        every[middle] = errors(middle)
        if every[middle][1] <= WELL_KNOWN:
            inside = middle
        else:
            outside = middle
        if every[inside][1] > AT_END * WELL_KNOWN or abs(np.log(outside / inside)) < PLACED:
            break
    return inside


def _build_band_error(errors: Mapping[float, tuple[float, float]]) -> BandError:
    lines = sorted(errors)
    stiffness, loss_factor = zip(*(errors[line] for line in lines), strict=True)
    return BandError(tuple(lines), tuple(stiffness), tuple(loss_factor))


# Where stiffness and loss factor are known, over every spectrum that a test does not reject.
#
# At a line :math:`\omega` the limits of the loss factor :math:`\eta = K''/K'` follow by
# Dinkelbach's iteration (*Management Science* 13, 1967), which starts from that of the fit. Those
# of :math:`|K^*|` are of its part along that of the fit,
#
# .. math:: |K^*| \cos(\phi - \phi_0) = K'\cos\phi_0 + K''\sin\phi_0,
#
# which is linear in the spectrum, over the cosine of the widest angle that the loss factor allows.
# Of creep :math:`J^* = 1/K^*` takes the place of K*: its angle and its size are as well known.
#
# The valid band ends where the loss factor is not known to 30 %, above or below a gap of the data,
# too: there an arm may stand that nothing shows.


#: a ratio is found when a step moves it by less than this part of the way from where it started
SETTLED = 0.02
#: a stiffness whose limits are no farther apart, as a factor, is as good as known
NARROW = 1.25
#: steps of a ratio, at most
STEPS = 8
#: lines over a band on which the least loss factor is sought
OF_A_HOLD = 9
#: grid of relaxation times that is left for a hold, decades
THINNED = 0.15


@dataclass(frozen=True, eq=False)
class SolidErrors:
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
            _find_largest_ratio(self.spectra, sign * loss, storage, sign * eta, spread)
            for sign in (-1, 1)
        )
        if self.stiffness is not None:
            return self.stiffness, _compute_relative_error(-low, eta, high)
        widest = max(abs(np.arctan(end) - angle) for end in (-low, high))
        most /= max(float(np.cos(widest)), 1e-9)
        return _compute_relative_error(max(least, 0.0), size, most), _compute_relative_error(-low, eta, high)


def _find_largest_ratio(
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


def _compute_relative_error(low: float, value: float, high: float) -> float:
    """Return by how much a value may lie off, relative to itself or to the truth."""
    if not (low > 0 and value > 0 and np.isfinite(high)):
        return np.inf
    return float(max(high / value, value / low, 1.0) - 1)


# -- a band ---------------------------------------------------------------------------------------


def find_hold_band(
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
    if not has_loss_band(solid, band):
        return band, None
    errors = SolidErrors(spectra.reduce_grid(THINNED), solid)
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


def has_loss_band(solid: Solid, band: tuple[float, float]) -> bool:
    """Return whether there is a band, and a solid that has a loss."""
    return 0 < band[0] < band[1] < np.inf and sum(solid.maxwell.k) > 0


# Frequencies that a relaxation test informs.
#
# Ask the test about any seal, not about the one arm model it happened to choose: arms at half
# decades of tau, none of them known beyond a plausible size (a tenth of the stiffness found, one
# standard deviation). The test then leaves a posterior spread of the loss stiffness
#
# .. math:: K''(\omega) = \sum_j k_j \frac{\omega\tau_j}{1 + \omega^2\tau_j^2}
#
# and a frequency is informed where that spread is at most half of what it was before. Noise,
# sampling, ramp, hold, offset and drift all enter through the columns of the fit. Beyond what
# noise allows, no frequency is claimed that the motion itself hardly holds: above
# :math:`1/(\pi c)` for the shortest ramp c, above half the sampling rate, or below one radian in
# the longest hold.


_ARMS_PER_DECADE = 2
_PLAUSIBLE = 0.1
_INFORMED = 0.5
_FREQUENCIES_PER_DECADE = 20


class HeldTest(Protocol):
    """Interface of a ramp and hold, of a motion or of a load: its times."""

    @property
    def time(self) -> FloatArray:
        """Of every sample, s."""

    @property
    def ramp_time(self) -> float:
        """How long the ramp takes, s."""

    @property
    def hold_time(self) -> float:
        """How long the hold lasts, s."""


def find_informed_band(
    tests: Sequence[HeldTest],
    blocks: Sequence[DataBlock],
    *,
    stiffness: float,
    noise: float,
    slower: Sequence[float] | None = None,
) -> tuple[float, float]:
    """Return the band, Hz; both ends equal if the test informs no frequency by half.

    Parameters
    ----------
    tests, blocks : sequences
        The tests and their compressed blocks.
    stiffness : float
        k_0 of the solid found, N/m; of a creep test its compliance at rest, m/N.
    noise : float
        Standard deviation of one residual, N or m, widened for correlation (s times root kappa).
    slower : sequence of float, optional
        How many times slower than the solid asked about each test's was: its shift factor.
    """
    group = list(zip(tests, slower or [1.0] * len(tests), strict=True))
    slowest = 1.0 / (2.0 * np.pi * max(test.hold_time / a for test, a in group))
    step = min(float(np.diff(test.time).min()) / a for test, a in group)
    ramp = min(test.ramp_time / a for test, a in group)
    fastest = min(1.0 / (np.pi * max(ramp, step)), 0.5 / step)
    frequency, residual = compute_posterior_spread(blocks, stiffness=stiffness, noise=noise)
    return _find_widest_band(frequency, residual, slowest, fastest)


def compute_posterior_spread(
    blocks: Sequence[DataBlock], *, stiffness: float, noise: float
) -> tuple[FloatArray, FloatArray]:
    """Return frequencies, Hz, and the part of the prior spread of K'' that the test leaves."""
    stack = Stack(blocks)
    low, high = stack.bounds
    decades = (high - low) / np.log(10.0) + 2.0
    log_tau = np.linspace(
        low - np.log(10.0), high + np.log(10.0), int(_ARMS_PER_DECADE * decades) + 1
    )
    rows = stack.evaluate(log_tau, derivative=False)
    fixed, arms = rows.phi[:, : len(stack.names)], rows.phi[:, len(stack.names) :]
    basis = np.linalg.qr(fixed)[0]
    # spring, offset and drift are free: what they explain tells nothing of an arm
    arms = arms - basis @ (basis.T @ arms)
    prior = _PLAUSIBLE * stiffness
    information = arms.T @ arms * (prior / noise) ** 2
    posterior = np.linalg.inv(information + np.eye(len(log_tau)))
    tau = np.exp(log_tau)
    count = int(_FREQUENCIES_PER_DECADE * decades)
    omega = np.exp(-np.linspace(log_tau[-1], log_tau[0], count))
    x = omega[:, None] * tau
    loss = x / (1.0 + x * x)
    # what millions of samples leave is less than its rounding
    spread = np.maximum(((loss @ posterior) * loss).sum(axis=1), 0.0)
    remainder = np.sqrt(spread / (loss * loss).sum(axis=1))
    return omega / (2.0 * np.pi), remainder


def _find_widest_band(
    frequency: FloatArray, left: FloatArray, slowest: float, fastest: float
) -> tuple[float, float]:
    best = float(
        np.clip(frequency[int(np.argmin(left))], min(slowest, fastest), max(slowest, fastest))
    )
    ends = frequency[find_true_runs(left <= _INFORMED)].tolist()
    clipped = [(max(low, slowest), min(high, fastest)) for low, high in ends]
    wide = [(low, high) for low, high in clipped if high > low]
    return max(wide, key=lambda run: run[1] / run[0], default=(best, best))
