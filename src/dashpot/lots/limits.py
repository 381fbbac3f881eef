"""Acceptance limits of a lot, and what they make of each seal."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np

from dashpot.base.errors import DashpotError, ReadError
from dashpot.base.student_t import t_quantile
from dashpot.base.units import parse_quantity
from dashpot.io.source import open_raw
from dashpot.lots.quantities import Quantity
from dashpot.lots.rows import Lot
from dashpot.lots.seals import Seal

Decision = Literal["pass", "not proven", "fail", "no result"]
_KNOWN = ("lower", "upper", "cpk")
_LARGEST = 1 << 20
SURE = 0.95
"""Probability with which a seal that passes keeps the limit (ISO 14253-1:2017)."""


@dataclass(frozen=True)
class Limits:
    """What is asked of one quantity.

    Attributes
    ----------
    quantity : Quantity
    lower, upper : float or None
        SI.
    cpk : float or None
        The least that is asked.
    """

    quantity: Quantity
    lower: float | None = None
    upper: float | None = None
    cpk: float | None = None

    @property
    def ends(self) -> tuple[float, ...]:
        """The limits that there are."""
        return tuple(end for end in (self.lower, self.upper) if end is not None)

    def inside(self, value: float, guard: float = 0.0) -> bool:
        """Whether a value keeps to both limits, by so much."""
        low = -math.inf if self.lower is None else self.lower
        high = math.inf if self.upper is None else self.upper
        return low + guard <= value <= high - guard

    def __str__(self) -> str:
        ends = [
            f"{word} {self.quantity.read(end)}"
            for word, end in (("at least", self.lower), ("at most", self.upper))
            if end is not None
        ]
        return " and ".join(ends)


class Judged(NamedTuple):
    """What the limits make of one seal.

    Attributes
    ----------
    lot, seal : str
    decision : str
        ``"pass"``; ``"fail"`` outside a limit; ``"not proven"`` inside it by less than the guard
        band; ``"no result"`` where no test of the seal is used.
    value : float or None
        Mean of its tests, SI.
    guard : float or None
        The guard band: what the uncertainty of this mean takes off either limit.
    """

    lot: str
    seal: str
    decision: Decision
    value: float | None
    guard: float | None


def read_limits(path: str | Path, lot: Lot) -> tuple[Limits, ...]:
    """Return the limits that a TOML states, each as a table named as a quantity of the lot.

    Raises
    ------
    ReadError
        If the file is no such TOML, or names what the lot has not.
    """
    try:
        tables = tomllib.loads(open_raw(Path(path)).head(_LARGEST).decode("utf-8-sig"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ReadError(f"{path}: not TOML: {error}") from None
    if not tables:
        raise ReadError(f'{path}: no limit is in it; expected such as [k_end] lower = "0.18N/mm"')
    return tuple(_stated(f"{path}, [{name}]", name, table, lot) for name, table in tables.items())


def _stated(where: str, name: str, table: object, lot: Lot) -> Limits:
    if not isinstance(table, Mapping):
        raise ReadError(f"{where}: expected a table with {', '.join(_KNOWN)}")
    unknown = [one for one in table if one not in _KNOWN]
    if unknown:
        raise ReadError(f"{where}: '{unknown[0]}' is unknown; known are {', '.join(_KNOWN)}")
    try:
        quantity = lot.quantity(name)
        lower, upper = (_number(table.get(one), quantity) for one in ("lower", "upper"))
        cpk = table.get("cpk")
        asked = None if cpk is None else float(cpk)
    except (DashpotError, TypeError, ValueError) as error:
        raise ReadError(f"{where}: {error}") from None
    if lower is None and upper is None:
        raise ReadError(f"{where}: it has no limit; give lower, upper, or both")
    if lower is not None and upper is not None and lower >= upper:
        raise ReadError(f"{where}: lower is not below upper; exchange them")
    if asked is not None and not asked > 0:
        raise ReadError(f"{where}: cpk = {asked:g}; expected a number > 0, such as 1.33")
    return Limits(quantity, lower, upper, asked)


def _number(value: object, quantity: Quantity) -> float | None:
    if value is None:
        return None
    if quantity.dimension is not None:
        return parse_quantity(str(value), quantity.dimension)
    number = float(str(value))
    if not math.isfinite(number):
        raise ValueError(f"{value} is no limit; expected a finite number")
    return number


def judged(lot: Lot, limits: Limits) -> tuple[Judged, ...]:
    r"""Return what limits make of every seal that was tested, in the order of lot and seal.

    The guard band is :math:`t_{0.95,\nu}\,u`, the decision rule of ISO 14253-1, with the standard
    uncertainty u of the mean of n repeats: :math:`u^2 = s_r^2/n`, pooled over all seals with
    :math:`\nu` degrees of freedom, and what operators add where several are named. Without a repeat
    it is not known, and a seal passes inside the limits.
    """
    seals = lot.seals(limits.quantity.name)
    deviation, freedom = _pooled(seals)
    between = _between_operators(lot, limits.quantity.name)
    found = []
    for one in seals:
        guard = None
        if freedom:
            own = math.hypot(deviation / math.sqrt(len(one.values)), between)
            guard = t_quantile(2 * SURE - 1, freedom) * own
        decision: Decision = "pass"
        if not limits.inside(one.mean):
            decision = "fail"
        elif guard is not None and not limits.inside(one.mean, guard):
            decision = "not proven"
        found.append(Judged(one.lot, one.name, decision, one.mean, guard))
    known = {(one.lot, one.name) for one in seals}
    rows = lot.table.select("lot", "seal", "outcome").iter_rows()
    lost = dict.fromkeys((of, seal) for of, seal, _ in rows if seal and (of, seal) not in known)
    return (*found, *(Judged(of, seal, "no result", None, None) for of, seal in lost))


def _pooled(seals: Sequence[Seal]) -> tuple[float, int]:
    """Standard deviation of repeats, and its degrees of freedom."""
    freedom = sum(len(one.values) - 1 for one in seals)
    squares = sum(float(np.sum((one.values - one.mean) ** 2)) for one in seals)
    return (math.sqrt(squares / freedom) if freedom else 0.0), freedom


def _between_operators(lot: Lot, name: str) -> float:
    if lot.used["operator"].n_unique() < 2:
        return 0.0
    try:
        study = lot.gauge(name)
    except DashpotError:
        return 0.0
    return math.hypot(*(
        one.deviation for one in study.variations if one.name in ("operator", "interaction")
    ))  # fmt: skip
