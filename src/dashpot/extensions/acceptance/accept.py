"""Limits held against a result: ``read_limits("limits.toml", "damping >= 3%").judge(study)``."""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import Any

from dashpot.base import dataclass, replace
from dashpot.base.errors import DataError
from dashpot.base.reported_values import ReportedValue
from dashpot.extensions.acceptance.datamodel import Acceptance, LimitAssessment
from dashpot.extensions.acceptance.judgement import (
    POWER_QUANTILE,
    count_additional_tests,
    judge_interval,
)
from dashpot.extensions.acceptance.limit_files import (
    LimitEntry,
    is_expression,
    parse_expression,
    split_expression,
)
from dashpot.extensions.acceptance.limit_files import read_limits as read_limit_file
from dashpot.extensions.acceptance.result_values import ResultValue, find_value


@dataclass(frozen=True)
class AcceptanceLimits:
    """Acceptance limits as stated; their units follow from the result.

    Attributes
    ----------
    sources : tuple of str or Path
        Each an expression or a TOML file.
    """

    sources: tuple[str | Path, ...]

    def judge(self, result: Any) -> Acceptance:
        """Return each limit held against the 95 % interval of a result.

        A limit is met if the whole interval is within it, missed if the whole interval is beyond
        it, otherwise open. Of a result that is not to be used every limit is open.

        Parameters
        ----------
        result : Study, Fit or another result that reports values

        Raises
        ------
        DataError
            If the result has no such value, or a limit has no or another unit.
        """
        find_quantity = partial(find_value, result)
        entries: dict[str, LimitEntry[ResultValue]] = {}
        for source in self.sources:
            if isinstance(source, str) and is_expression(source):
                limit_entries: Iterable[LimitEntry[ResultValue]] = [
                    parse_expression(source, find_quantity)
                ]
            else:
                limit_entries = read_limit_file(source, find_quantity)
            for entry in limit_entries:
                column = entry.quantity.column
                entries[column] = _combine_limits(entries.get(column), entry)
        use = result.verdict.use
        limits = tuple(
            _judge_entry(entry, is_usable=use != "do not use") for entry in entries.values()
        )
        return Acceptance(result, use, limits)


def read_limits(*sources: str | Path) -> AcceptanceLimits:
    """Return acceptance limits from files and expressions.

    Parameters
    ----------
    *sources : str or path
        Each a TOML file as ``dashpot batch --limits`` takes it, or an expression such as
        ``"damping >= 3%"``.

    Raises
    ------
    DataError
        If there is no limit, or an expression is invalid.

    Examples
    --------
    >>> import dashpot as dp
    >>> fit = dp.fit(dp.simulate("relaxation", seed=1), arms=2)
    >>> dp.files.read_limits("k_end >= 0.15N/mm").judge(fit).word
    'meets'
    """
    if not sources:
        raise DataError('no limit is given; expected such as "damping >= 3%" or "limits.toml"')
    for source in sources:
        if isinstance(source, str) and is_expression(source):
            split_expression(source)
        elif not str(source).strip():
            raise DataError('a limit is empty; expected such as "damping >= 3%" or "limits.toml"')
    return AcceptanceLimits(sources)


def _combine_limits(
    first: LimitEntry[ResultValue] | None, other: LimitEntry[ResultValue]
) -> LimitEntry[ResultValue]:
    """Return the limits of one quantity that were stated in two places.

    Raises
    ------
    DataError
        If both state the same one, or the lower one is not below the upper one.
    """
    if first is None:
        return other
    limits, texts = [], []
    for side in ("lower", "upper"):
        values = [getattr(entry, side) for entry in (first, other)]
        if None not in values:
            raise DataError(f"the {side} limit of {first.quantity.column} is given twice; keep one")
        limits.append(values[0] if values[1] is None else values[1])
        texts.append(getattr(first, f"{side}_text") or getattr(other, f"{side}_text"))
    if not limits[0] < limits[1]:
        raise DataError(f"the lower limit of {first.quantity.column} is not below the upper one")
    lower, upper = limits
    return LimitEntry(other.quantity, lower, upper, other.cpk, *texts)


def _judge_entry(entry: LimitEntry[ResultValue], *, is_usable: bool) -> LimitAssessment:
    value, lower, upper = entry.quantity, entry.lower, entry.upper
    reported_value = _read_in_stated_unit(value, entry.lower_text or entry.upper_text)
    low, high = _get_interval(reported_value)
    outcome = judge_interval(lower, upper, low, high) if is_usable else "open"
    additional_tests: int | None = None
    additional_tests_90: int | None = None
    if outcome == "open" and is_usable and value.spread == "random":
        additional_tests, additional_tests_90 = (
            count_additional_tests(
                lower, upper, reported_value.value, low, high,
                noise_share=value.noise_share, quantile=quantile,
            )
            for quantile in (0.0, POWER_QUANTILE)
        )  # fmt: skip
    return LimitAssessment(
        value.column,
        reported_value,
        lower,
        upper,
        outcome,
        value.spread,
        additional_tests,
        additional_tests_90,
        value.remedy,
        is_usable,
        (entry.lower_text, entry.upper_text),
    )


def _read_in_stated_unit(value: ResultValue, limit_text: str) -> ReportedValue:
    """Return a value in the unit of its limit: a life in years if the limit is in years."""
    unit = limit_text.partition(" ")[2]
    return replace(value.fact, read=unit) if unit and value.dimension is not None else value.fact


def _get_interval(reported_value: ReportedValue) -> tuple[float, float]:
    """Return the interval of a value.

    Without one it is the value alone where its error is 0, else unlimited.
    """
    if reported_value.has_interval:
        low = -math.inf if math.isnan(reported_value.low) else reported_value.low
        return low, math.inf if math.isnan(reported_value.high) else reported_value.high
    return (
        (reported_value.value, reported_value.value)
        if reported_value.error == 0
        else (-math.inf, math.inf)
    )
