r"""Errors of a solid that a hammer identified, over every spectrum that its lines do not reject.

The covariance of a fit is of the arms that it has. Where the lines show fewer arms than the seal
has, its loss factor is wrong at the ends of the band, however small the covariance. So a line is
taken about the optimum,

.. math::

    A(s) \approx \hat A(s) - n\,\frac{\hat A(s)^2}{s^2}\,\bigl(K(s) - \hat K(s)\bigr)

which is linear in the spectrum of one seal, and its limits are those of every spectrum that the
lines do not reject (:mod:`dashpot.fitting.admissible_spectra`), whatever mass, gain and delay are
within their priors.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.datamodel.bounds import MAX_LOSS_FACTOR_ERROR, BandError
from dashpot.datamodel.fit import Fit
from dashpot.fitting.admissible_spectra import AdmissibleSpectra, deviance_limit
from dashpot.fitting.identification.likelihood import Candidate
from dashpot.fitting.marginal_relaxation import RelaxationData, RelaxationRows
from dashpot.fitting.valid_band import HOLD_GRID_DECADES, SolidErrors, find_loss_factor_band
from dashpot.numerics.inference.correlated_noise import marginalise
from dashpot.numerics.least_squares import stack_real_rows


@dataclass(frozen=True, eq=False)
class SpectralLines:
    """Lines of a hammer test about an optimum, as rows of unit noise."""

    best: Candidate

    @property
    def window(self) -> tuple[float, float]:
        """Shortest and longest relaxation time that the lines could show, s."""
        return self.best.problem.frf_data.stiffness_block(1.0, dashpot=False).window

    def rows(self, log_tau: FloatArray, *, with_slopes: bool) -> RelaxationRows:
        """Rows whitened for mass, gain and delay; their slopes are not given."""
        del with_slopes
        problem, prediction = self.best.problem, self.best.model_prediction
        data, point = problem.frf_data, prediction.point
        model = point.model.maxwell
        response = data.response(model, point.mass)
        s = response.s
        x = s[:, None] * np.append(np.exp(log_tau), model.tau)
        stiffness = np.column_stack((np.ones_like(s), s, x / (1 + x)))
        slope = -data.seals * (response.accelerance / s)[:, None] ** 2 * stiffness
        slope = data.slopes(response, *point.channel, slope)[0] / data.sd[:, None]
        columns = stack_real_rows(slope) / problem.scale
        indices, mean, sd = problem.rig
        has_prior = np.isfinite(sd)
        known, mean, sd = np.array(indices, dtype=int)[has_prior], mean[has_prior], sd[has_prior]
        free = [i for name, i in problem.index.items() if name != "b" and i not in known]
        first = sum(map(len, prediction.tests))
        jacobian = prediction.slope[first : first + len(columns)]
        grid, own = np.split(columns, [2 + len(log_tau)], axis=1)
        target = grid[:, :2] @ (model.k_inf, model.b) + own @ model.k - prediction.lines
        target += jacobian[:, known] @ (self.best.theta[known] - mean)
        white = marginalise(jacobian[:, free], jacobian[:, known] * sd)
        grid = white(grid)
        return RelaxationRows(white(target), grid[:, 0], grid[:, 1], grid[:, 2:], grid[:, 2:])


def widen_to_spectra(fit: Fit, best: Candidate, relaxations: Sequence[RelaxationData]) -> Fit:
    """Return a fit with its valid band and errors over all spectra that its tests do not reject.

    They are added to what the rig may do without a trace. Where that alone leaves the loss factor
    open at the peak, the band is what the spectra leave. A fit whose seals were stiffer under the
    hammer, or of several temperatures, stays as it is.

    Parameters
    ----------
    fit : Fit
    best : Candidate
        Its optimum.
    relaxations : sequence of RelaxationData
        Its relaxation tests, with what their rigs may have done.
    """
    error, peak = fit.evidence.band_error, best.problem.frf_data.peak_hz
    is_known = error is not None and np.isfinite(error.max_errors).all()
    is_of_one_seal = best.point.factor == best.point.spring == 1 and fit.temperatures is None
    if best.exact or error is None or not (is_known and is_of_one_seal):
        return fit
    spectra = AdmissibleSpectra(
        [SpectralLines(best), *relaxations],
        fastest=2 * np.pi * fit.band[1],
        limit=deviance_limit(0.95, fit.estimate.dof),
        extra=fit.model.tau,
    )
    of_spectra = SolidErrors(spectra.reduce_grid(HOLD_GRID_DECADES), fit.solid)

    def total(line: float) -> tuple[float, float]:
        stiffness, loss_factor = (
            float(np.hypot(own, np.interp(line, error.frequency, values)))
            for own, values in zip(
                of_spectra(line), (error.stiffness, error.loss_factor), strict=True
            )
        )
        return stiffness, loss_factor

    errors = total if total(peak)[1] <= MAX_LOSS_FACTOR_ERROR else of_spectra
    lines = {line: errors(line) for line in sorted({*error.frequency, peak})}
    band, narrowed = find_loss_factor_band(errors, fit.band, lines, included_line=peak)
    stiffness, loss_factor = zip(*map(total, narrowed.frequency), strict=True)
    widened = BandError(narrowed.frequency, stiffness, loss_factor, error.misfit)
    return replace(fit, evidence=replace(fit.evidence, band=band, band_error=widened))
