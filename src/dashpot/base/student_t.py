r"""Student's t distribution in NumPy alone: SciPy's special functions import too slowly.

With :math:`x = \sqrt\nu \tan\varphi` the central probability is

.. math:: P(|t| < x) = \frac{2\,\Gamma(\frac{\nu+1}{2})}{\sqrt\pi\,\Gamma(\frac\nu2)}
          \int_0^{\varphi} \cos^{\nu-1} u \, du

whose integrand is smooth: Gauss-Legendre quadrature gives it to rounding. Its nodes are the
eigenvalues of the Jacobi matrix of the Legendre polynomials (G. H. Golub and J. H. Welsch,
*Math. Comp.* 23, 1969); to import numpy.polynomial for them would take longer.
"""

from __future__ import annotations

from math import atan, cos, exp, inf, lgamma, log, pi, sqrt, tan

import numpy as np

_DEGREE = np.arange(1.0, 64.0)
_NODES, _VECTORS = np.linalg.eigh(np.diag(_DEGREE / np.sqrt(4.0 * _DEGREE**2 - 1.0), -1))
_WEIGHTS = 2.0 * _VECTORS[0] ** 2
# relative step after which Newton's quadratic convergence has reached rounding
_LAST_STEP = 1e-12


def t_quantile(level: float, dof: float) -> float:
    """Return x with P(abs(t) < x) = `level`: the half-width of a two-sided interval, in SE.

    Below one degree of freedom nothing is known and the answer is infinite.

    >>> round(t_quantile(0.95, 10.0), 4)
    2.2281
    """
    if dof < 1.0:
        return inf
    dof = min(dof, 1e7)  # beyond, cos u to such a power loses digits and t is normal
    low, high = 0.0, pi / 2
    angle = atan(2.0 / sqrt(dof))
    for _ in range(100):
        error = _central(angle, dof) - level
        low, high = (low, angle) if error > 0 else (angle, high)
        density = exp(_log_constant(dof)) * max(cos(angle), 0.0) ** (dof - 1.0)
        step = error / density if density > 0 else inf
        # rounding may lie on either side of the level
        if abs(step) > _LAST_STEP * angle and not low < angle - step < high:
            step = angle - 0.5 * (low + high)
        angle -= step
        if abs(step) <= _LAST_STEP * angle:
            break
    return sqrt(dof) * tan(angle)


def _central(angle: float, dof: float) -> float:
    # beyond 40 standard deviations the integrand is zero to rounding
    angle = min(angle, 40.0 / sqrt(dof)) if dof > 1000.0 else angle
    u = 0.5 * angle * (_NODES + 1.0)
    value = 0.5 * angle * float(_WEIGHTS @ np.cos(u) ** (dof - 1.0))
    return exp(_log_constant(dof)) * value


def _log_constant(dof: float) -> float:
    half_dof = 0.5 * dof
    # lgamma loses digits in the difference of two large numbers; Stirling does not
    ratio = (
        lgamma(half_dof + 0.5) - lgamma(half_dof)
        if half_dof < 100.0
        else 0.5 * log(half_dof)
        - 1.0 / (8.0 * half_dof)
        + 1.0 / (192.0 * half_dof**3)
        - 1.0 / (640 * half_dof**5)
    )
    return log(2.0) - 0.5 * log(pi) + ratio
