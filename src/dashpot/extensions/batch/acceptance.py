"""Decisions on the seals of a lot by acceptance limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from dashpot.base.errors import DashpotError
from dashpot.base.student_t import t_quantile
from dashpot.extensions.batch.limits import Limits
from dashpot.extensions.batch.lot import Lot
from dashpot.extensions.batch.quantities import Quantity
from dashpot.extensions.batch.seals import Seal

Decision = Literal["pass", "not proven", "fail", "no result"]
CONFORMITY_PROBABILITY = 0.95
"""Probability with which a seal that passes keeps the limit (ISO 14253-1:2017)."""


class SealDecision(NamedTuple):
    """Decision on one seal by the limits.

    Attributes
    ----------
    lot, seal : str
    decision : str
        ``"pass"``; ``"fail"`` outside a limit; ``"not proven"`` inside it by less than the guard
        band; ``"no result"`` if no test of the seal is used.
    value : float or None
        Mean of its tests, SI.
    guard : float or None
        Guard band: the uncertainty of this mean, by which both limits are tightened.
    """

    lot: str
    seal: str
    decision: Decision
    value: float | None
    guard: float | None

    def explain_decision(self, quantity: Quantity) -> str:
        """Return why it does not pass; "" if it does, or if there is no limit."""
        if self.decision != "not proven" or self.guard is None:
            return "outside the limits" * (self.decision == "fail")
        guard = quantity.read(self.guard, digits=2)
        return f"inside the limits by less than its guard band, {guard}"


def check_lot_acceptance(lot: Lot, limits: Limits) -> tuple[SealDecision, ...]:
    r"""Return the judgement of every tested seal by limits, in the order of lot and seal.

    The guard band is :math:`t_{0.95,\nu}\,u`, the decision rule of ISO 14253-1, with the standard
    uncertainty u of the mean of n repeats: :math:`u^2 = s_r^2/n`, pooled over all seals with
    :math:`\nu` degrees of freedom, and what operators add where several are named. Without a repeat
    it is not known, and a seal passes inside the limits.
    """
    seals = lot.seals(limits.quantity.column)
    deviation, freedom = _compute_pooled_deviation(seals)
    operator_note = _compute_operator_share(lot, limits.quantity.column)
    decisions = []
    for item in seals:
        guard = None
        if freedom:
            value = math.hypot(deviation / math.sqrt(len(item.values)), operator_note)
            guard = t_quantile(2 * CONFORMITY_PROBABILITY - 1, freedom) * value
        decisions.append(
            SealDecision(
                item.lot, item.name, _decide_acceptance(limits, item.mean, guard), item.mean, guard
            )
        )
    items = {(seal.lot, seal.name) for seal in seals}
    missing_seals = (key for key in _find_tested_seals(lot) if key not in items)
    return (
        *decisions,
        *(SealDecision(lot, seal, "no result", None, None) for lot, seal in missing_seals),
    )


def _find_tested_seals(lot: Lot) -> dict[tuple[str, str], None]:
    """Lot and name of every seal; a file without a seal's name counts only if it was fitted."""
    rows = lot.table.select("lot", "seal", "file", "outcome").iter_rows()
    return {(lot, seal or file): None for lot, seal, file, end in rows if seal or end == "fitted"}


def _decide_acceptance(limits: Limits, value: float, guard_band: float | None) -> Decision:
    if limits.judge(value, value) == "missed":
        return "fail"
    band = guard_band or 0.0
    return "pass" if limits.judge(value - band, value + band) == "met" else "not proven"


def _compute_pooled_deviation(seals: Sequence[Seal]) -> tuple[float, int]:
    """Return standard deviation of repeats, and its degrees of freedom."""
    freedom = sum(len(seal.values) - 1 for seal in seals)
    squares = sum(float(np.sum((seal.values - seal.mean) ** 2)) for seal in seals)
    return (math.sqrt(squares / freedom) if freedom else 0.0), freedom


def _compute_operator_share(lot: Lot, name: str) -> float:
    if lot.rows_in_statistics["operator"].n_unique() < 2:
        return 0.0
    try:
        study = lot.gauge(name)
    except DashpotError:
        return 0.0
    return math.hypot(*(
        item.deviation for item in study.variations if item.name in ("operator", "interaction")
    ))  # fmt: skip
