r"""Block bootstrap: the spread of the fits of records that could have been.

Residuals are resampled in blocks longer than their correlation, put on the fitted force, and
fitted again. Slower than the covariance and free of its linearisation.
Source: H. R. Kunsch, Annals of Statistics 17 (1989) 1217; circular blocks.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import repeat
from typing import Literal, cast

import numpy as np

from dashpot.base.arrays import ByValue, FloatArray, frozen
from dashpot.base.errors import DataError, FitError
from dashpot.engine.blocks.block import Block, Evaluation
from dashpot.engine.inference.covariance import noise_of
from dashpot.engine.solver.variable_projection import Solution, solve
from dashpot.fitting.design import Design, bound, fitted_samples, nuisanced
from dashpot.fitting.uncertainty.estimate import estimated
from dashpot.preparation.ramp_holds import Tests, ramp_holds
from dashpot.records.estimate import parameter_names
from dashpot.records.fit import Fit
from dashpot.records.relaxation import RampHold

# blocks this many correlation lengths long keep what correlation there is
_LENGTHS = 5.0


@dataclass(frozen=True, eq=False)
class Bootstrap(ByValue):
    """Refits of resampled records.

    Attributes
    ----------
    parameters : tuple of str
        ``"k_inf"``, ``"k_1"``..., ``"tau_1"``...
    values : array, shape (repeats, p)
        N/m and s; NaN where a refit found another number of arms.
    """

    parameters: tuple[str, ...]
    values: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", frozen(np.asarray(self.values, dtype=float)))

    def standard_error(self) -> FloatArray:
        """Standard deviation over the refits, shape (p,)."""
        return np.asarray(np.nanstd(self.values, axis=0, ddof=1))

    def intervals(self, level: float = 0.95) -> FloatArray:
        """Percentile intervals, shape (p, 2)."""
        if not 0.0 < level < 1.0:
            raise DataError(f"level = {level!r}; expected a coverage between 0 and 1, such as 0.95")
        ends = (0.5 - level / 2, 0.5 + level / 2)
        return np.asarray(np.nanquantile(self.values, ends, axis=0).T)


def bootstrap(
    tests: Tests,
    fit: Fit,
    *,
    repeats: int = 200,
    block: float | None = None,
    seed: int = 0,
) -> Bootstrap:
    """Refit resampled records with as many arms and by the method of `fit`.

    Parameters
    ----------
    tests : RampHold, RelaxationTest or sequence of them
        The tests that `fit` was made from, which share their stiffnesses.
    fit : Fit
    repeats : int
    block : float, optional
        Length of a block, s; five correlation lengths of the residuals by default.
    seed : int
        Same seed, same result.

    Raises
    ------
    FitError
        If `repeats` is below 2, or the fit is not of relaxation tests that share a solid.
    """
    records = ramp_holds(tests)
    if repeats < 2:
        raise FitError(f"repeats = {repeats}; a spread needs at least 2")
    if fit.method not in {"full", "hold"} or fit.by_depth:
        raise FitError(
            "the bootstrap serves fits of relaxation tests that share one solid (method 'full' or "
            f"'hold', no depth law), found method {fit.method!r}"
        )
    design = Design(cast('Literal["full", "hold"]', fit.method))
    arms, start = fit.model.arms, np.log(np.array(fit.model.tau))
    blocks = nuisanced(records, design)
    samples = [block.exact for block in blocks]
    known = bound(records, blocks, design)
    peak = max(float(np.abs(record.force).max()) for record in records)
    first = solve([*blocks, *known], arms, log_tau_start=start)
    residuals = estimated(first, samples, priors=known, peak=peak).residuals
    used = [fitted_samples(record, design) for record in records]
    times = [record.time[here] for record, here in zip(records, used, strict=True)]
    lengths = list(map(_block_length, residuals, times, repeat(block)))
    random = np.random.default_rng(seed)
    rows = []
    for _ in range(repeats):
        drawn = list(map(_redrawn, records, used, residuals, lengths, repeat(random)))
        again = nuisanced(drawn, design)
        known = tuple(_redrawn_prior(one, random) for one in bound(drawn, again, design))
        rows.append(_row(solve([*again, *known], arms, log_tau_start=start), arms))
    names = tuple(name.removeprefix("ln_") for name in parameter_names(arms))
    return Bootstrap(names, np.array(rows))


def _row(found: Solution, arms: int) -> FloatArray:
    """Return k_inf, every k and every tau; NaN if an arm was lost."""
    k = found.arms.ravel()
    if found.order != arms or not (k > 0).all():
        return np.full(1 + 2 * arms, np.nan)
    return np.concatenate(([found.coefficient("k_inf")], k, found.tau))


def _block_length(residual: FloatArray, time: FloatArray, block: float | None) -> int:
    if block is not None:
        step = float(time[-1] - time[0]) / max(len(time) - 1, 1)
        return int(np.clip(round(block / step), 1, len(residual)))
    return int(np.clip(np.ceil(_LENGTHS * noise_of(residual).kappa), 1, len(residual) // 4 + 1))


def _redrawn_prior(block: Block, random: np.random.Generator) -> Block:
    """What might have been known before: its rows have a known variance."""
    error = np.sqrt(block.variance or 0.0) * random.standard_normal(block.samples)

    def rows(log_tau: FloatArray, derivative: bool) -> Evaluation:
        found = block.evaluate(log_tau, derivative)
        return found._replace(target=found.target + error)

    return replace(block, rows=rows)


def _redrawn(
    record: RampHold,
    used: slice,
    residual: FloatArray,
    length: int,
    random: np.random.Generator,
) -> RampHold:
    n = len(residual)
    starts = random.integers(0, n, -(-n // length))
    index = ((starts[:, None] + np.arange(length)) % n).ravel()[:n]
    force = record.force.copy()
    force[used] += (residual - residual.mean())[index] - residual
    return replace(record, force=force)
