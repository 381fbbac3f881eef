r"""How late a force comes, where it begins late: behind air, or by its clock.

A force that lags its displacement by :math:`\delta` begins to rise when the plate has moved on by
:math:`v\delta`, as behind so much air. But it also lags at the end of the ramp, where air is long
crossed. So ramp and first relaxation are fitted with each delay that the clocks may have, from
where the plate rested and from where the force begins.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray, distinct, median
from dashpot.numerics.least_squares.nnls import solve_linear
from dashpot.solids.maxwell import arm_response

# delays that are tried, up to so many standard deviations of what the clocks may hide
DELAYS, MOST = 13, 4.0
# delays that are worse one after another: the best is behind
BEYOND = 2
# arms, from this part of the ramp to so many times it, and no faster than so many samples
ARMS, FASTEST, SLOWEST, SAMPLES = 6, 0.02, 3.0, 2.0
# rows near either corner of the ramp, and over all of it
ROWS = 100
# rows that could show a delay beside its arms
FEWEST = 4 * ARMS
# what is watched after the ramp, of its duration
AFTER = 0.5


class Lateness(NamedTuple):
    """The delay with which a force follows best from some contact, s, and how well: a deviance."""

    delay: float
    deviance: float


def estimate_contact_delay(
    time: FloatArray,
    pressed: FloatArray,
    force: FloatArray,
    *,
    corners: tuple[float, float],
    delay_sd: float,
) -> Lateness:
    """Return the delay with which arms of positive stiffness follow a force best.

    Parameters
    ----------
    time, pressed, force : array, shape (n,)
        From the rest before a ramp to `AFTER` of it later: s, the compression from the contact that
        is asked about, m, and N.
    corners : (float, float)
        Begin and end of the ramp, s.
    delay_sd : float
        Standard deviation of the delay between the clocks, s.

    Returns
    -------
    Lateness
        No delay, of no deviance, where the ramp has too few rows to show one.
    """
    rows = _rows(time, corners, MOST * delay_sd)
    if len(rows) < FEWEST:
        return Lateness(0.0, 0.0)
    ramp, step = corners[1] - corners[0], median(np.diff(time[rows]))
    fastest = max(FASTEST * ramp, SAMPLES * step)
    tau = np.geomspace(fastest, max(SLOWEST * ramp, 2 * fastest), ARMS)
    answers = [pressed, *arm_response(time, pressed, tau).T]
    target, must = force[rows], np.append(False, np.ones(len(answers), dtype=bool))
    best, risen = Lateness(0.0, np.inf), 0
    for delay in np.linspace(0.0, MOST * delay_sd, DELAYS).tolist():
        columns = [np.interp(time[rows] - delay, time, answer) for answer in answers]
        design = np.column_stack((np.ones(len(rows)), *columns))
        residual = target - design @ solve_linear(design, target, must)[0]
        misfit = len(rows) * float(np.log(max(float(residual @ residual), 1e-300)))
        tried = Lateness(delay, misfit + (delay / delay_sd) ** 2)
        best, risen = (tried, 0) if tried.deviance < best.deviance else (best, risen + 1)
        if risen == BEYOND:
            break
    return best


def _rows(time: FloatArray, corners: tuple[float, float], near: float) -> IndexArray:
    """Some rows: all near the corners of the ramp, if they are few, and fewer elsewhere."""
    begin, end = corners
    chosen = []
    for low, high in (
        (begin - near, begin + 3 * near),
        (begin, time[-1]),
        (end - near, end + near),
    ):
        first, stop = np.searchsorted(time, (low, high))
        chosen.append(np.arange(first, stop, max(1, (stop - first) // ROWS)))
    return distinct(np.concatenate(chosen))
