"""Least-squares sum of exponentials in plain arrays, without starting values."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass
from dashpot.base.arrays import FloatArray, FrozenArrays, require_same_length, validate_samples
from dashpot.base.errors import DataError, FitError
from dashpot.numerics.design_matrices.recorded_motion import build_hold_block
from dashpot.numerics.exponential_fit import OptimalityCertificate, certificate, solve


@dataclass(frozen=True, eq=False)
class ExponentialSum(FrozenArrays):
    r"""Least-squares sum of exponentials :math:`y = c + \sum_j a_j e^{-r_j x}`.

    Attributes
    ----------
    amplitudes, rates : array, shape (terms,)
        a and r, ascending in r. Fewer than requested if the data reject a further positive term.
    constant : float
        c; 0 if none was requested.
    sse : float
        (Weighted) sum of squared residuals.
    amplitude_errors, rate_errors : array, shape (terms,)
        Standard errors for white residuals, from the spread of the residuals.
    constant_error : float
    converged : bool
    certificate : OptimalityCertificate or None
        How far the best positive sum with any number of terms could be below; None if amplitudes
        of either sign were allowed.
    """

    amplitudes: FloatArray
    rates: FloatArray
    constant: float
    sse: float
    amplitude_errors: FloatArray
    rate_errors: FloatArray
    constant_error: float
    converged: bool
    certificate: OptimalityCertificate | None

    def __call__(self, x: npt.ArrayLike) -> FloatArray:
        """The sum at x."""
        abscissa = np.asarray(x, dtype=float)
        return np.asarray(
            self.constant + np.exp(-abscissa[..., None] * self.rates) @ self.amplitudes
        )


def exponential_sum(
    x: npt.ArrayLike,
    y: npt.ArrayLike,
    *,
    terms: int,
    constant: bool = False,
    signed: bool = False,
    weights: npt.ArrayLike | None = None,
) -> ExponentialSum:
    r"""Fit a sum of decaying exponentials to data, with no starting values.

    .. math:: y = c + \sum_{j=1}^{n} a_j e^{-r_j x}, \qquad r_j > 0

    Rates are sought where the data can distinguish them: 1/r from twice the finest step of x to ten
    times its span.

    Parameters
    ----------
    x, y : array_like, shape (M,)
        Any order, any spacing; no x twice.
    terms : int
        n >= 1.
    constant : bool
        Fit c, of either sign.
    signed : bool
        Allow amplitudes of either sign; else a_j > 0.
    weights : array_like, shape (M,), optional
        1/sd of each y.

    Returns
    -------
    ExponentialSum

    Raises
    ------
    DataError
        If the arrays differ in length, hold fewer values than parameters, or an x comes twice.
    FitError
        If `terms` is less than one.

    Examples
    --------
    >>> import numpy as np
    >>> x = np.arange(24) / 20
    >>> y = 0.0951 * np.exp(-x) + 0.8607 * np.exp(-3 * x) + 1.5576 * np.exp(-5 * x)
    >>> exponential_sum(x, y, terms=3).rates.round(6)
    array([1., 3., 5.])
    """
    if terms < 1:
        raise FitError(f"terms = {terms}; expected at least one exponential")
    abscissa, values = validate_samples("x", x, minimum=3), validate_samples("y", y)
    root = None if weights is None else validate_samples("weights", weights)
    require_same_length(x=abscissa, y=values, weights=root)
    if len(abscissa) < 2 * terms + constant:
        raise DataError(
            f"{len(abscissa)} samples cannot determine {2 * terms + constant} parameters; fit "
            "fewer terms"
        )
    order = np.argsort(abscissa, kind="stable")
    abscissa, values = abscissa[order], values[order]
    root = None if root is None else root[order]
    if (np.diff(abscissa) == 0).any():
        repeated_time = abscissa[int(np.argmin(np.diff(abscissa)))]
        raise DataError(f"x = {repeated_time:g} comes twice; average its values or shift one")
    origin = float(abscissa[0])
    name = "constant" if constant else None
    block = build_hold_block(abscissa - origin, values, k_inf=name, weights=root)
    solution = solve([block], terms, signed=signed)
    optimality = None if signed else certificate([block], solution)
    rates, shifted_amplitudes = np.exp(-solution.log_tau)[::-1], solution.arms[0][::-1]
    rescaling = np.exp(rates * origin)
    rows = _compute_sensitivity(
        abscissa - origin, rates, shifted_amplitudes, root, constant=constant
    )
    n = len(rates)
    # a = A e^{r origin}, so da = e^{r origin} (dA + A origin dr)
    rows[:n] = rescaling[:, None] * (
        rows[:n] + shifted_amplitudes[:, None] * origin * rows[n : 2 * n]
    )
    dof = max(len(abscissa) - len(rows), 1)
    standard_errors = np.linalg.norm(rows, axis=1) * np.sqrt(solution.sse / dof)
    return ExponentialSum(
        amplitudes=shifted_amplitudes * rescaling,
        rates=rates,
        constant=solution.coefficient("constant") if constant else 0.0,
        sse=solution.sse,
        amplitude_errors=standard_errors[:n],
        rate_errors=standard_errors[n : 2 * n],
        constant_error=float(standard_errors[-1]) if constant else 0.0,
        converged=solution.converged,
        certificate=optimality,
    )


def _compute_sensitivity(
    x: FloatArray,
    rates: FloatArray,
    amplitudes: FloatArray,
    weights: FloatArray | None,
    *,
    constant: bool,
) -> FloatArray:
    """Return the sensitivity of each parameter to each weighted sample: the pseudo-inverse of J."""
    decay = np.exp(-x[:, None] * rates)
    columns = [decay, -x[:, None] * decay * amplitudes]
    if constant:
        columns.append(np.ones((len(x), 1)))
    jacobian = np.concatenate(columns, axis=1)
    if weights is not None:
        jacobian = jacobian * weights[:, None]
    scale = np.linalg.norm(jacobian, axis=0)
    return np.asarray(np.linalg.pinv(jacobian / scale) / scale[:, None])
