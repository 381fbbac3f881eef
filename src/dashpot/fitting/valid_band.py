"""Valid band of a fit: informed by the tests, with stiffness and loss known."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol, TypeAlias

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray, find_true_runs
from dashpot.datamodel.bounds import MAX_LOSS_FACTOR_ERROR, BandError
from dashpot.fitting.admissible_spectra import AdmissibleSpectra
from dashpot.numerics.design_matrices.block import DataBlock
from dashpot.numerics.log_tau_descent import Stack
from dashpot.solids.maxwell import Solid

# Part of a band in which the loss factor is known, with its error.


#: largest number of lines evaluated to find one end of a band
MAX_END_LINES = 5
#: an end is found at this part of the largest admissible error, or to this tolerance of ln f
END_ERROR_RATIO, END_TOLERANCE = 0.85, 0.05
#: a band is at least an octave wide
MIN_BAND_RATIO = 2.0
ErrorFunction: TypeAlias = Callable[[float], tuple[float, float]]


def find_loss_factor_band(
    errors: ErrorFunction,
    band: tuple[float, float],
    lines: Mapping[float, tuple[float, float]],
    *,
    included_line: float | None = None,
) -> tuple[tuple[float, float], BandError]:
    """Return the widest part of a band in which the loss factor is known, and its errors.

    With `included_line` it is the part that contains it, however narrow. Where the loss factor is
    known over less than an octave, or not at that line, the whole band is returned with its errors.

    Parameters
    ----------
    errors : callable
        Errors of stiffness and loss factor, relative, at a frequency in Hz.
    band : (float, float)
        Hz.
    lines : mapping of float to (float, float)
        Errors at some lines of the band, Hz, increasing; its two ends among them.
    included_line : float, optional
        One of these lines, Hz.
    """
    frequencies, all_errors = np.array(list(lines)), dict(lines)
    is_known = np.array([error[1] for error in lines.values()]) <= MAX_LOSS_FACTOR_ERROR
    known_runs = find_true_runs(is_known).tolist()
    if included_line is not None:
        known_runs = [
            run for run in known_runs if frequencies[run[0]] <= included_line <= frequencies[run[1]]
        ]
    if is_known.all() or not known_runs:
        return band, _build_band_error(all_errors)
    first, last = max(known_runs, key=lambda run: frequencies[run[1]] / frequencies[run[0]])
    band_ends = []
    for inside_index, outside_index in ((first, first - 1), (last, last + 1)):
        end = float(frequencies[inside_index])
        if 0 <= outside_index < len(frequencies):
            end = _find_band_end(errors, all_errors, end, float(frequencies[outside_index]))
        band_ends.append(end)
    low, high = band_ends
    if high <= low * (MIN_BAND_RATIO if included_line is None else 1.0):
        return band, _build_band_error(all_errors)
    return (low, high), _build_band_error({f: e for f, e in all_errors.items() if low <= f <= high})


def _find_band_end(
    errors: ErrorFunction,
    all_errors: dict[float, tuple[float, float]],
    known_line: float,
    unknown_line: float,
) -> float:
    """Return the last frequency at which the loss factor is known well enough."""
    for iteration in range(MAX_END_LINES):
        known_error, unknown_error = all_errors[known_line][1], all_errors[unknown_line][1]
        exponent = 0.5
        if 0 < known_error < MAX_LOSS_FACTOR_ERROR < unknown_error < np.inf:
            exponent = float(
                np.log(MAX_LOSS_FACTOR_ERROR / known_error) / np.log(unknown_error / known_error)
            )
        # the error rises faster than this power law towards the end: the crossing lies farther out
        exponent = min(max(exponent, 0.5 if iteration else 0.1), 0.98)
        trial_frequency = known_line * (unknown_line / known_line) ** exponent
        all_errors[trial_frequency] = errors(trial_frequency)
        if all_errors[trial_frequency][1] <= MAX_LOSS_FACTOR_ERROR:
            known_line = trial_frequency
        else:
            unknown_line = trial_frequency
        if (
            all_errors[known_line][1] > END_ERROR_RATIO * MAX_LOSS_FACTOR_ERROR
            or abs(np.log(unknown_line / known_line)) < END_TOLERANCE
        ):
            break
    return known_line


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
#
# The valid band ends where the loss factor is not known to 30 %, above or below a gap of the data,
# too: there an arm may stand that nothing shows.


#: relative step at which Dinkelbach's iteration ends
RATIO_TOLERANCE = 0.02
#: upper over lower limit of a stiffness up to which one step of a ratio suffices
NARROW_STIFFNESS_RATIO = 1.25
#: most steps of the iteration of a ratio
MAX_RATIO_STEPS = 8
#: number of lines of a band among which the extreme loss factor is searched
HOLD_LINES = 9
#: spacing of the grid of relaxation times for a hold, decades
HOLD_GRID_DECADES = 0.15


@dataclass(frozen=True, eq=False)
class SolidErrors:
    """Relative errors of a fitted solid over some spectra.

    Attributes
    ----------
    spectra : AdmissibleSpectra
    solid : Solid
    stiffness : float or None
        Relative error of the stiffness at every line, if it is known already.
    """

    spectra: AdmissibleSpectra
    solid: Solid
    stiffness: float | None = None

    def evaluate(self, omega: float) -> tuple[complex, FloatArray, FloatArray]:
        """Return the stiffness at omega, rad/s, and storage and loss of unit columns there."""
        return complex(self.solid.complex_stiffness(omega=omega)), *self.spectra.stiffness_at(omega)

    def __call__(self, frequency: float) -> tuple[float, float]:
        """Return the relative errors of stiffness and loss factor at a frequency, Hz."""
        K, storage, loss = self.evaluate(2 * np.pi * frequency)
        if not self.spectra.shown[1]:
            # data without a column of a dashpot: the fastest arm represents it
            loss[1] = 0.0
        magnitude, angle = abs(K), float(np.angle(K))
        eta = K.imag / K.real if K.real > 0 else np.inf
        if self.stiffness is None:
            lowest, highest = self.spectra.limit_functional(
                storage * np.cos(angle) + loss * np.sin(angle)
            )
        else:
            lowest, highest = magnitude / (1 + self.stiffness), magnitude * (1 + self.stiffness)
        stiffness_ratio = highest / lowest if lowest > 0 else np.inf
        low_eta, high_eta = (
            _find_largest_ratio(self.spectra, sign * loss, storage, sign * eta, stiffness_ratio)
            for sign in (-1, 1)
        )
        if self.stiffness is not None:
            return self.stiffness, _compute_relative_error(-low_eta, eta, high_eta)
        widest = max(abs(np.arctan(ratio) - angle) for ratio in (-low_eta, high_eta))
        highest /= max(float(np.cos(widest)), 1e-9)
        return _compute_relative_error(
            max(lowest, 0.0), magnitude, highest
        ), _compute_relative_error(-low_eta, eta, high_eta)


def _find_largest_ratio(
    spectra: AdmissibleSpectra,
    numerator: FloatArray,
    denominator: FloatArray,
    start: float,
    stiffness_ratio: float,
) -> float:
    """Return the largest ratio (numerator . k) / (denominator . k), at least `start`.

    With n and d the two products, the gain g of a step from r to r + g/d bounds the ratio by
    r + g/min(d): if d varies by a small factor, `stiffness_ratio`, one step is enough.
    """
    ratio = start
    for _ in range(MAX_RATIO_STEPS):
        spectrum = spectra.find_extreme_spectrum(numerator - ratio * denominator)
        if not np.isfinite(spectrum).all():
            return np.inf
        value = float(denominator @ spectrum)
        new_ratio = float(numerator @ spectrum) / value if value > 0 else -np.inf
        if not new_ratio > ratio:
            break
        change, ratio = new_ratio - ratio, new_ratio
        if stiffness_ratio <= NARROW_STIFFNESS_RATIO:
            return start + stiffness_ratio * change
        if change <= RATIO_TOLERANCE * (ratio - start):
            break
    return ratio


def _compute_relative_error(low: float, value: float, high: float) -> float:
    """Return the larger relative error of a value against its limits, low and high."""
    if not (low > 0 and value > 0 and np.isfinite(high)):
        return np.inf
    return float(max(high / value, value / low, 1.0) - 1)


# -- Ends of a band -------------------------------------------------------------------------------


def find_hold_band(
    spectra: AdmissibleSpectra, solid: Solid, band: tuple[float, float]
) -> tuple[tuple[float, float], BandError | None]:
    """Return the valid band of a hold, and the errors of its solid there.

    Parameters
    ----------
    spectra : AdmissibleSpectra
        Spectra that the holds do not reject.
    solid : Solid
        The fit.
    band : (float, float)
        The frequencies that the test informs, Hz.
    """
    if not has_loss_band(solid, band):
        return band, None
    errors = SolidErrors(spectra.reduce_grid(HOLD_GRID_DECADES), solid)
    end_errors = [errors(line) for line in band]
    # the stiffness of a hold is known equally well over the band: the errors at its ends suffice
    errors_within = replace(errors, stiffness=max(stiffness for stiffness, _ in end_errors))
    lines = dict(zip(band, end_errors, strict=True))
    frequencies = np.geomspace(*band, HOLD_LINES)
    K = solid.complex_stiffness(omega=2 * np.pi * frequencies)
    loss_factor = K.imag / K.real
    if all(error > MAX_LOSS_FACTOR_ERROR for _, error in end_errors):
        # the loss factor is known best where it is largest
        candidate_lines = [*np.argsort(-loss_factor).tolist()]
    else:
        # and worst where it is smallest, mostly at an end
        candidate_lines = [int(np.argmin(loss_factor))]
    for index in candidate_lines:
        if 0 < index < len(frequencies) - 1:
            lines[float(frequencies[index])] = errors_within(float(frequencies[index]))
            if lines[float(frequencies[index])][1] <= MAX_LOSS_FACTOR_ERROR:
                break
    lines = dict(sorted(lines.items()))
    return find_loss_factor_band(errors_within, band, lines)


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
_PRIOR_SD_RATIO = 0.1
_MAX_SPREAD_RATIO = 0.5
_FREQUENCIES_PER_DECADE = 20


class HeldTest(Protocol):
    """Interface of a ramp and hold, of a motion or of a load: its times."""

    @property
    def time(self) -> FloatArray:
        """Time of every sample, s."""

    @property
    def ramp_time(self) -> float:
        """Duration of the ramp, s."""

    @property
    def hold_time(self) -> float:
        """Duration of the hold, s."""


def find_informed_band(
    tests: Sequence[HeldTest],
    blocks: Sequence[DataBlock],
    *,
    stiffness: float,
    noise: float,
    shift_factors: Sequence[float] | None = None,
) -> tuple[float, float]:
    """Return the widest band that the tests inform, Hz; its ends are equal if there is none.

    Parameters
    ----------
    tests, blocks : sequences
        The tests and their compressed blocks.
    stiffness : float
        k_0 of the solid found, N/m; of a creep test its compliance at rest, m/N.
    noise : float
        Standard deviation of one residual, N or m, widened for correlation (s times root kappa).
    shift_factors : sequence of float, optional
        Shift factor of each test: relaxation times in it over those of the returned band.
    """
    tests_and_shifts = list(zip(tests, shift_factors or [1.0] * len(tests), strict=True))
    slowest = 1.0 / (2.0 * np.pi * max(test.hold_time / shift for test, shift in tests_and_shifts))
    step = min(float(np.diff(test.time).min()) / shift for test, shift in tests_and_shifts)
    ramp = min(test.ramp_time / shift for test, shift in tests_and_shifts)
    fastest = min(1.0 / (np.pi * max(ramp, step)), 0.5 / step)
    frequency, spread_ratio = compute_posterior_spread(blocks, stiffness=stiffness, noise=noise)
    return _find_widest_band(frequency, spread_ratio, slowest, fastest)


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
    # spring, offset and drift are free: what they explain shows nothing of an arm
    arms = arms - basis @ (basis.T @ arms)
    prior_sd = _PRIOR_SD_RATIO * stiffness
    information = arms.T @ arms * (prior_sd / noise) ** 2
    posterior = np.linalg.inv(information + np.eye(len(log_tau)))
    tau = np.exp(log_tau)
    count = int(_FREQUENCIES_PER_DECADE * decades)
    omega = np.exp(-np.linspace(log_tau[-1], log_tau[0], count))
    omega_tau = omega[:, None] * tau
    loss = omega_tau / (1.0 + omega_tau * omega_tau)
    # for millions of samples the variance may be negative by rounding
    variance = np.maximum(((loss @ posterior) * loss).sum(axis=1), 0.0)
    remainder = np.sqrt(variance / (loss * loss).sum(axis=1))
    return omega / (2.0 * np.pi), remainder


def _find_widest_band(
    frequency: FloatArray, spread_ratio: FloatArray, slowest: float, fastest: float
) -> tuple[float, float]:
    best = float(
        np.clip(
            frequency[int(np.argmin(spread_ratio))], min(slowest, fastest), max(slowest, fastest)
        )
    )
    runs = frequency[find_true_runs(spread_ratio <= _MAX_SPREAD_RATIO)].tolist()
    clipped = [(max(low, slowest), min(high, fastest)) for low, high in runs]
    bands = [(low, high) for low, high in clipped if high > low]
    return max(bands, key=lambda run: run[1] / run[0], default=(best, best))
