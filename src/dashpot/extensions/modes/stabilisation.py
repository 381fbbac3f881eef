r"""Stabilisation chart: poles over the model order, and which of them are stable.

A right-hand fraction with one denominator for all points, :math:`H_o(\omega) = \sum_k \beta_{ok}
z^k / \sum_k \alpha_k z^k`, :math:`z = e^{j\omega T}`, is fitted in linear least squares (LSCF:
Guillaume, Verboven and Vanlanduit, ISMA 1998) for each order up to the highest. The band is laid
over three quarters of the circle and the coefficients are complex, so that the order is the number
of poles in the band. With the first coefficient of the denominator fixed, poles that only follow
the noise grow instead of decaying, and are omitted (Cauberghe et al. 2005). Poles of the structure
keep their place as the order rises.

The chart knows nothing of the model that `dashpot.vibration.modal.pole_fit` fits, so it is a
second opinion on each of its modes.
"""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass
from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray, IndexArray
from dashpot.datamodel.frf import Mode
from dashpot.datamodel.structure import FRFSet
from dashpot.vibration.modal.modal_methods import (
    compute_rms_accelerance,
    get_set_lines,
    select_mode_band,
)
from dashpot.vibration.modal.pole_fit import MAX_DAMPING, FRFLines, mac

HIGHEST = 30
MAX_POLE_ANGLE = 1.5 * np.pi
NOTHING_NEW = 1e-11
"""Share of a numerator's columns below which they follow the noise."""
SAME_FREQUENCY, SAME_DAMPING, SAME_SHAPE = 0.01, 0.05, 0.98
"""Relative, relative, and by the modal assurance criterion: properties kept from order to order."""
NEW, FREQUENCY, DAMPING, SHAPE = range(4)
"""States of a pole compared with the order before."""


@dataclass(frozen=True, eq=False)
class Stabilisation:
    """Poles of every order, with their agreement with the order before.

    Attributes
    ----------
    order, state : int array, shape (poles,)
        State: 0 new, 1 frequency, 2 damping too, 3 shape too, which one point does not have.
    frequency, damping_ratio : array, shape (poles,)
        Hz, 1.
    lines, height : array, shape (n,)
        Hz, and the root mean square of the points' accelerances there, 1/kg.
    highest : int
        Order.
    points : int
    """

    order: IndexArray
    frequency: FloatArray
    damping_ratio: FloatArray
    state: IndexArray
    lines: FloatArray
    height: FloatArray
    highest: int
    points: int

    @property
    def stable(self) -> BoolArray:
        """Poles that are stable by every criterion that applies, shape (poles,)."""
        return np.asarray(self.state == (SHAPE if self.points > 1 else DAMPING))

    def orders_with(self, mode: Mode) -> int:
        """Return the number of orders with a stable pole in the half-power band of a mode."""
        max_distance = max(0.5 * mode.bandwidth, SAME_FREQUENCY * mode.frequency)
        is_near = self.stable & (np.abs(self.frequency - mode.frequency) <= max_distance)
        return len(np.unique(self.order[is_near]))


def stabilisation(
    points: FRFSet, *, band: tuple[float, float] | None = None, highest: int = HIGHEST
) -> Stabilisation:
    """Stabilisation chart of the FRFs of one or several points.

    Parameters
    ----------
    points : FRFSet
    band : (float, float), optional
        Hz; by default where modes are sought.
    highest : int
        Order; no more than a third of the lines can determine.

    Raises
    ------
    DataError
        If the band holds fewer than 8 lines.
    """
    band_frfs = select_mode_band(points, band)
    rms_accelerance = compute_rms_accelerance(band_frfs)
    lines = get_set_lines(band_frfs)
    highest = min(highest, len(rms_accelerance.frequency) // 3)
    rows: list[tuple[int, float, float, int]] = []
    previous_order: tuple[ComplexArray, ComplexArray] | None = None
    for order, poles, residues in _fit_orders(lines, np.abs(rms_accelerance.value), highest):
        magnitude = np.abs(poles)
        ratio = -poles.real / magnitude
        state = _classify_poles(poles, residues, previous_order)
        rows += zip([order] * len(poles), magnitude / (2 * np.pi), ratio, state, strict=True)
        previous_order = poles, residues
    table = np.array(rows, dtype=float).reshape(-1, 4)
    return Stabilisation(
        table[:, 0].astype(int), table[:, 1], table[:, 2], table[:, 3].astype(int),
        rms_accelerance.frequency, np.abs(rms_accelerance.value), highest, len(points.frfs),
    )  # fmt: skip


def _fit_orders(
    lines: FRFLines, height: FloatArray, highest: int
) -> list[tuple[int, ComplexArray, ComplexArray]]:
    """Order, poles in the band and their residues, shape (points, poles), for each order."""
    omega = lines.s.imag
    tick = MAX_POLE_ANGLE / (omega[-1] - omega[0])
    powers = np.exp(1j * tick * np.outer(omega - omega[0], np.arange(highest + 1)))
    # the equation's error is the scatter times the denominator, which is small at a peak
    value = powers * (height / lines.sd)[..., None]
    weighted_values = -value * lines.value[..., None]
    conjugate = value.conj().swapaxes(1, 2)
    square = conjugate @ value
    size = np.trace(square, axis1=1, axis2=2).real / len(powers.T)
    square += NOTHING_NEW * size[:, None, None] * np.eye(len(powers.T))
    # its leading block is the factor of each lower order
    factor = np.linalg.cholesky(square)
    cross = np.linalg.solve(factor, conjugate @ weighted_values)
    normal_matrix = (weighted_values.conj().swapaxes(1, 2) @ weighted_values).sum(axis=0)
    pairs = []
    for order in range(1, highest + 1):
        k = order + 1
        by = cross[:, :k, :k]
        residual = normal_matrix[:k, :k] - (by.conj().swapaxes(1, 2) @ by).sum(axis=0)
        c = np.append(1.0, -np.linalg.lstsq(residual[1:, 1:], residual[1:, 0], rcond=1e-14)[0])
        z = np.roots(c[::-1])
        z = z[np.abs(z) > 0]
        angle = np.angle(z)
        angle[angle < 0.5 * (MAX_POLE_ANGLE - 2 * np.pi)] += (
            2 * np.pi
        )  # the gap is beyond both ends
        poles = (np.log(np.abs(z)) + 1j * angle) / tick + 1j * omega[0] + lines.s[0].real
        keep = (poles.real < 0) & (-poles.real < MAX_DAMPING * poles.imag)
        keep &= (poles.imag > omega[0]) & (poles.imag < omega[-1])
        z, poles = z[keep], poles[keep]
        order_of = np.argsort(poles.imag)
        z, poles = z[order_of], poles[order_of]
        base = z[:, None] ** np.arange(k)
        slope = (base[:, :-1] * np.arange(1, k)) @ c[1:] * z * tick
        numerators = -np.linalg.solve(factor[:, :k, :k].conj().swapaxes(1, 2), (by @ c)[..., None])
        residues = (base @ numerators)[..., 0] / slope
        pairs.append((order, np.asarray(poles), residues))
    return pairs


def _classify_poles(
    poles: ComplexArray,
    residues: ComplexArray,
    previous_order: tuple[ComplexArray, ComplexArray] | None,
) -> list[int]:
    """Return which properties of each pole were found at the previous order."""
    if previous_order is None or not len(previous_order[0]) or not len(poles):
        return [NEW] * len(poles)
    previous_poles, previous_residues = previous_order
    mac_values = mac(residues, previous_residues)
    state = []
    for i, p in enumerate(poles):
        j = int(np.argmin(np.abs(np.abs(previous_poles) - abs(p))))
        if abs(abs(previous_poles[j]) / abs(p) - 1) > SAME_FREQUENCY:
            state.append(NEW)
        elif (
            abs((previous_poles[j].real / abs(previous_poles[j])) / (p.real / abs(p)) - 1)
            > SAME_DAMPING
        ):
            state.append(FREQUENCY)
        elif len(residues) == 1 or mac_values[i, j] < SAME_SHAPE:
            state.append(DAMPING)
        else:
            state.append(SHAPE)
    return state
