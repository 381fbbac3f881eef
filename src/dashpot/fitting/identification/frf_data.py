"""Hammer test as data of an identification: lines, their scatter, and rig effects."""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import DataError
from dashpot.datamodel.frf import FRF, Kind
from dashpot.numerics.design_matrices.block import DataBlock, design_block
from dashpot.numerics.least_squares import stack_real_rows
from dashpot.solids.maxwell import Solid
from dashpot.vibration.mass_on_seals import Response
from dashpot.vibration.modal.peaks import find_peak
from dashpot.vibration.modal.pole_fit import MIN_LINE_ERROR

# lines within this factor of the peak are fitted unless a band is given
PEAK_BAND_FACTOR = 3.0
MIN_LINES = 8
# a relaxation time can be determined up to so many times beyond the lines, and farther where the
# lines are better known than any that were measured: of an arm so slow they show k/tau alone, but
# for a part of (omega tau)^-2, which must stand so far above what is left of them
TAU_REACH, MAX_TAU_REACH, TAU_SIGNAL_RATIO = 10.0, 3e3, 100.0


@dataclass(frozen=True, eq=False)
class FRFData:
    """Lines of a measured accelerance as data of a fit.

    Attributes
    ----------
    lines : FRF
        Accelerance.
    sd : array, shape (n,)
        Standard deviation of real and imaginary part, what leakage leaves included.
    has_absolute_sd : bool
        False if the scatter is unknown, so that lines count by their relative misfit, or by
        their shares of it where there is a coherence.
    seals : float
    peak_hz : float
    kind : Kind
        What was measured.
    weighed_mass : float or None
        For a motion over a base, the mass with which it was made an accelerance, kg.
    reach : float
        How many times slower than the lowest line an arm may be to be determined.
    """

    lines: FRF
    sd: FloatArray
    has_absolute_sd: bool
    seals: float
    peak_hz: float
    kind: Kind = Kind.ACCELERANCE
    weighed_mass: float | None = None
    reach: float = TAU_REACH

    def extend_reach(self, remainder: float) -> FRFData:
        """Return the data with the reach at which a part of that size stays unexplained."""
        slowest_factor = min(
            max(1 / np.sqrt(TAU_SIGNAL_RATIO * max(remainder, 1e-300)), TAU_REACH), MAX_TAU_REACH
        )
        return replace(self, reach=float(slowest_factor))

    def response(self, model: Solid, mass: float) -> Response:
        """Return the mass on seals, one of which is `model`, to the end of the record."""
        lines = self.lines
        return Response(self.seals * model, mass, lines.s, lines.record, lines.pulse)

    def predict(
        self, response: Response, gain: float, delay: float, high_pass: float
    ) -> ComplexArray:
        r"""Accelerance as this rig would show it.

        .. math::

            A(s) = h(s)\,\frac{s^2}{m s^2 + n K(s)},
            \qquad h(s) = g\,e^{-s d}\,\frac{s}{s + 2\pi f_c}

        less what a cut record loses; g is the gain of acceleration over force, d its delay, f_c
        the corner of its high-pass, Hz. Over a base that moves they are of the upper over the lower
        sensor, and what the rig shows of :math:`T = 1 - m A` is :math:`(1 - h\,T) / m_0`, with the
        mass m_0 of the scale; of a sensor between both ends, :math:`h\,m A / m_0`.
        """
        relative_motion, base = self._over_base(response.mass)
        line_gain = self._compute_line_gain(gain, delay, high_pass)
        return np.asarray(line_gain * (relative_motion * response.accelerance - base) + base)

    def slopes(
        self,
        response: Response,
        gain: float,
        delay: float,
        high_pass: float,
        columns: ComplexArray,
    ) -> tuple[ComplexArray, ...]:
        """Return the derivative of :meth:`predict` by parameters, and by ln m, ln g, d and f_c.

        `columns` is that of the accelerance by those parameters, shape (n, q).
        """
        relative_motion, base = self._over_base(response.mass)
        line_gain = self._compute_line_gain(gain, delay, high_pass)
        moving = line_gain * relative_motion * response.accelerance
        moving_part = moving - line_gain * base
        mass_slope = moving if self.weighed_mass is not None else 0 * moving
        return (
            (line_gain * relative_motion)[:, None] * columns,
            mass_slope,
            moving_part,
            -self.lines.s * moving_part,
            -2 * np.pi / (self.lines.s + 2 * np.pi * high_pass) * moving_part,
        )

    def _compute_line_gain(self, gain: float, delay: float, high_pass: float) -> ComplexArray:
        s = self.lines.s
        return np.asarray(gain * np.exp(-s * delay) / (1 + 2 * np.pi * high_pass / s))

    def _over_base(self, mass: float) -> tuple[float, float]:
        """Return the factor on the accelerance, and its value where the mass does not move."""
        if self.weighed_mass is None:
            return 1.0, 0.0
        is_over_base = self.kind is Kind.TRANSMISSIBILITY
        return mass / self.weighed_mass, is_over_base / self.weighed_mass

    def misfit(self, predicted: ComplexArray) -> FloatArray:
        """Weighted differences, real then imaginary, shape (2n,)."""
        return stack_real_rows((predicted - self.lines.value) / self.sd)

    def stiffness_block(self, mass: float | None, *, dashpot: bool) -> DataBlock:
        r"""Return the same lines as a linear problem in the stiffnesses of one seal, for starts.

        .. math:: s^2/A - m s^2 = n\left[k_\infty + \sum_j k_j \frac{s\tau_j}{1+s\tau_j}
                  + b s\right]

        With no mass given it is one more unknown, named ``mass@frf``.
        """
        s, value = self.lines.s, self.lines.value
        stiffness = s**2 / value
        weight = np.abs(value) / (np.abs(stiffness) * self.sd)
        weights = np.concatenate((weight, weight))[:, None]
        columns = {"k_inf": self.seals * np.ones_like(s)}
        if dashpot:
            columns["b"] = self.seals * s
        if mass is None:
            columns["mass@frf"] = s**2
        else:
            stiffness = stiffness - mass * s**2

        def arms(tau: FloatArray, derivative: bool) -> tuple[FloatArray, FloatArray]:
            x = s[:, None] * tau
            design = weights * stack_real_rows(self.seals * x / (1 + x))
            if not derivative:
                return design, design
            return design, weights * stack_real_rows(self.seals * x / (1 + x) ** 2)

        return design_block(
            target=weights[:, 0] * stack_real_rows(stiffness),
            fixed=weights * stack_real_rows(np.column_stack(list(columns.values()))),
            fixed_names=tuple(columns),
            columns=arms,
            window=(
                0.1 / float(np.abs(s).max()),
                self.reach / float(np.abs(s).min()),
            ),
        )


def select_frf_data(
    frf: FRF, *, seals: float, band: tuple[float, float] | None, mass: float | None = None
) -> FRFData:
    """Choose the lines of an FRF that a mass on seals can explain.

    Raises
    ------
    DataError
        If fewer than 8 lines remain, or a transmissibility comes without the mass, kg.
    """
    over_base = frf.quantity.over_base
    if over_base and mass is None:
        raise DataError(
            "a transmissibility gives the stiffness over the mass, and neither alone: give the mass"
        )
    accelerance = frf.to(Kind.ACCELERANCE, mass=mass)
    peak = find_peak(accelerance if band is None else accelerance.band(*band)).frequency
    low, high = (peak / PEAK_BAND_FACTOR, peak * PEAK_BAND_FACTOR) if band is None else band
    keep = accelerance.usable & (accelerance.frequency >= low) & (accelerance.frequency <= high)
    if np.count_nonzero(keep) < MIN_LINES:
        raise DataError(
            f"{np.count_nonzero(keep)} usable lines between {low:.4g} and {high:.4g} Hz; a model "
            f"needs at least {MIN_LINES}, and the FRF has lines from {frf.frequency[0]:.3g} to "
            f"{frf.frequency[-1]:.4g} Hz: widen --band, or record longer for more lines"
        )
    lines = accelerance.only(keep)
    scatter, magnitude = lines.random_sd, np.abs(lines.value)
    has_scatter = scatter is not None
    if scatter is None and lines.single_average_sd is not None:
        # of an unknown number of hits: the lines' shares of the misfit, which shows its size
        relative_scatter = np.hypot(lines.single_average_sd / magnitude, MIN_LINE_ERROR)
        scatter = magnitude * relative_scatter / np.sqrt(np.mean(relative_scatter**2))
    sd = (
        _size(lines, frf.quantity, mass)
        if scatter is None
        else np.hypot(scatter, MIN_LINE_ERROR * magnitude)
    )
    rig_mass = mass if over_base else None
    return FRFData(lines, sd, has_scatter, float(seals), peak, frf.quantity, rig_mass)


def _size(lines: FRF, kind: Kind, mass: float | None) -> FloatArray:
    """Return the magnitude of the measured part to which relative errors apply: T, not T - 1."""
    if kind is Kind.TRANSMISSIBILITY:
        return np.asarray(np.abs(lines.to(kind, mass=mass).value) / mass)
    return np.abs(lines.value)
