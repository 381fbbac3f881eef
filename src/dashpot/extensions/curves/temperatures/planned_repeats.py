"""Planned repeats of a ramp and hold at other temperatures, where the arms are slower or faster."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.base.units import celsius
from dashpot.datamodel.shift_factors import GLASS_MARGIN, SAME_TEMPERATURE
from dashpot.planning.planned_ramp_hold import Bench, PlannedRows, Repeat
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.shift_laws import WLF, TemperatureLaw

# Every test shares the solid :math:`\theta = (k_\infty, k_j, \ln\tau_j)`; at :math:`T_i` its arms
# are :math:`a_i \tau_j`, its stiffnesses :math:`b_i k_j`, and the fit finds
#
# .. math:: \ln a_i, \quad \ln b_i, \quad o_i, \dot o_i, d_i, \quad
#     \ln a_i \to \ln a_i \, \bigl[1 + g \log_{10}(\tau_j / \tau_0)\bigr]
#
# besides: shifts of time and stiffness without a law, offset, drift and delay of every record,
# and the slope g by which slow arms may shift further than fast ones, known before to 0 within
# .03.


SLOPE_SD = 0.03
"""Prior standard deviation of the slope of the shifts, per decade of relaxation time."""
_MIDDLE_TAU = 0.5
"""Relaxation time whose shift does not depend on the slope, s."""


def plan_repeat(temperature: float, test_temperature: float, law: TemperatureLaw) -> Repeat:
    """Return a repeat at a temperature, K, with its shift factors of time and stiffness.

    The stiffness is in proportion to T; both factors are 1 at `test_temperature`, K.

    Raises
    ------
    DataError
        If that is no other temperature, or nearer than 10 K to the glass transition.
    """
    if abs(temperature - test_temperature) <= SAME_TEMPERATURE:
        raise DataError(
            f"the test is at {celsius(test_temperature)} and is to be repeated at "
            f"{celsius(temperature)}; expected another temperature"
        )
    coldest = law.glass + GLASS_MARGIN if isinstance(law, WLF) else 0.0
    if temperature < coldest:
        raise DataError(
            f"{celsius(temperature)} is nearer than {GLASS_MARGIN:g} K to the glass transition "
            f"that the law supposes; expected {celsius(coldest)} or more"
        )
    a_t = float(law.a_t(temperature) / law.a_t(test_temperature))
    return Repeat(temperature, a_t, temperature / test_temperature)


def plan_repeats(
    temperatures: Sequence[float], test_temperature: float, law: TemperatureLaw
) -> tuple[Repeat, ...]:
    """Return the repeats of a test at `test_temperature`, K, at other temperatures, K.

    Raises
    ------
    DataError
        If two temperatures are one, or :func:`plan_repeat` refuses one.
    """
    repeats = tuple(plan_repeat(kelvin, test_temperature, law) for kelvin in temperatures)
    _refuse_equal_temperatures(temperatures)
    return repeats


def _refuse_equal_temperatures(temperatures: Sequence[float]) -> None:
    """Refuse a temperature, K, that is given twice: its tests would share one shift.

    Raises
    ------
    DataError
    """
    for lower, higher in pairwise(sorted(temperatures)):
        if higher - lower <= SAME_TEMPERATURE:
            raise DataError(
                f"the test is to be repeated at {celsius(lower)} and at {celsius(higher)}, which "
                f"is one temperature; expected each once, more than {SAME_TEMPERATURE:g} K apart"
            )


def build_planned_rows(
    model: GeneralizedMaxwell,
    bench: Bench,
    repeats: Sequence[Repeat],
    slope_sd: float = SLOPE_SD,
) -> PlannedRows:
    """Return the rows of a fit of the test and all its repeats, with the errors of each rig.

    The first columns are those of the solid, as in
    :class:`~dashpot.planning.planned_ramp_hold.Bench`; a `slope_sd` of 0 supposes that one factor
    shifts every arm.
    """
    shared = 1 + 2 * model.arms
    planned_rows = bench.rows(model, has_several_tests=True)
    blocks = [_build_repeat_rows(model, bench, repeat) for repeat in repeats]
    private = [planned_rows.rows[:, shared:], *(block.rows[:, shared:-1] for block in blocks)]
    slope = [np.zeros(len(planned_rows.rows)), *(block.rows[:, -1] for block in blocks)]
    all_rows = [planned_rows, *blocks]
    rows = np.hstack(
        (
            np.vstack([rows.rows[:, :shared] for rows in all_rows]),
            _build_block_diagonal(*private),
            np.concatenate(slope)[:, None],
        )
    )
    values = np.zeros((1, rows.shape[1]))
    values[0, -1] = 1 / max(slope_sd, 1e-12)
    diag = _build_block_diagonal(*(rows.unmeasured for rows in all_rows), np.zeros((1, 0)))
    return PlannedRows(np.vstack((rows, values)), diag)


def _build_block_diagonal(*blocks: FloatArray) -> FloatArray:
    """Return a matrix of blocks along its diagonal; SciPy's takes 120 ms to import."""
    block_ends = np.cumsum([block.shape for block in blocks], axis=0)
    matrix = np.zeros(block_ends[-1])
    for block, (row, column) in zip(blocks, block_ends, strict=True):
        matrix[row - block.shape[0] : row, column - block.shape[1] : column] = block
    return matrix


def _build_repeat_rows(model: GeneralizedMaxwell, bench: Bench, repeat: Repeat) -> PlannedRows:
    """Return rows of one repeat in (k_inf, k, ln tau, ln a, ln b[, of its rig and warming], g)."""
    solid = model.shift_to_temperature(repeat.a_t, repeat.b_t)
    values, unmeasured = bench.rows(solid, has_several_tests=True)
    n = model.arms
    stiffness_columns, log_tau_columns, nuisances = (
        values[:, : 1 + n],
        values[:, 1 + n : 1 + 2 * n],
        values[:, 1 + 2 * n :],
    )
    decades = np.log10(np.asarray(model.tau) / _MIDDLE_TAU)
    changes = [
        log_tau_columns.sum(axis=1),
        stiffness_columns @ np.array([solid.k_inf, *solid.k]),
        *nuisances.T,
        np.log(repeat.a_t) * log_tau_columns @ decades,
    ]
    return PlannedRows(
        np.hstack((repeat.b_t * stiffness_columns, log_tau_columns, np.column_stack(changes))),
        unmeasured,
    )
