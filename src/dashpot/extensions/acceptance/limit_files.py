"""Reading of acceptance limits: TOML files and expressions such as ``damping >= 3%``."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

from dashpot.base.errors import DashpotError, DataError, ReadError
from dashpot.base.units import Dimension, find_unit, parse_quantity
from dashpot.reading.columns.file_kinds import RecognisedKind
from dashpot.reading.toml import Section, read_tables

_KEYS = ("lower", "upper", "cpk")
_NUMBER = r"\s*[-+]?(?:\d+\.?\d*|\.\d+)"
_WITH_UNIT = re.compile(rf"({_NUMBER}(?:[eE][-+]?\d+)?)(?:\s+|(?![\d.]))(\S.*)")
_QUANTITIES: Mapping[str, str] = {"frequency": "frequency", "stiffness": "stiffness"}
"""Quantity of a dimension that a user may have meant."""
_SHARES = ("damping_ratio", "loss_factor")
"""Dimensionless quantities that are stated in per cent and hardly exceed 1."""
_SPELLINGS = str.maketrans({"≤": "<=", "≥": ">="})


class LimitedQuantity(Protocol):
    """Quantity with limits."""

    @property
    def column(self) -> str:
        """Column name of the quantity, with the unit if a table has it."""
        ...

    @property
    def unit(self) -> str:
        """Unit in which the quantity is shown; empty for a plain number."""
        ...

    @property
    def dimension(self) -> Dimension | None:
        """Dimension of the quantity; None for a plain number."""
        ...


Q = TypeVar("Q", bound=LimitedQuantity)


class LimitEntry(NamedTuple, Generic[Q]):
    """Limits of one quantity as stated, SI.

    Attributes
    ----------
    quantity
    lower, upper : float or None
    cpk : float or None
        Required capability of a lot.
    lower_text, upper_text : str
        The limits with the unit in which they were stated, such as ``"10 years"``; empty where
        they were stated without one.
    """

    quantity: Q
    lower: float | None
    upper: float | None
    cpk: float | None
    lower_text: str = ""
    upper_text: str = ""


def is_expression(text: str) -> bool:
    """Return whether a text is an expression of a limit, and not the path of a file.

    >>> is_expression("damping >= 3%"), is_expression("limits.toml")
    (True, False)
    """
    return re.search("[<>=≤≥]", text) is not None


def recognise_limits(tables: Mapping[str, Any]) -> RecognisedKind | None:
    """Return that the tables of a TOML file are limits; None of another TOML file."""
    if not tables or not all(
        isinstance(table, dict) and table and table.keys() <= set(_KEYS)
        for table in tables.values()
    ):
        return None
    return RecognisedKind("limits", f"its tables state limits: {', '.join(list(tables)[:4])}")


def read_limits(path: str | Path, find_quantity: Callable[[str], Q]) -> tuple[LimitEntry[Q], ...]:
    """Return the limits that a TOML file states, each a table named for a quantity.

    Parameters
    ----------
    path : path
    find_quantity : callable
        From the name of a table to the quantity; it refuses a name that it does not know.

    Raises
    ------
    ReadError
        If the file is no such TOML, or names no known quantity.
    """
    _, tables = read_tables(path)
    if not tables:
        raise ReadError(f'{path}: no limit is in it; expected such as [k_end] lower = "0.18N/mm"')
    entries = []
    for name, table in tables.items():
        section = Section(f"{path}, [{name}]", table, _KEYS)
        try:
            entries.append(_parse_entry(find_quantity(name), section.entries))
        except (DashpotError, TypeError, ValueError) as error:
            raise ReadError(f"{section.location}: {error}") from None
    column, times = Counter(entry.quantity.column for entry in entries).most_common(1)[0]
    if times > 1:
        raise ReadError(f"{path}: limits of {column} stand there twice, by two names; keep one")
    return tuple(entries)


def split_expression(text: str) -> tuple[str, dict[str, str]]:
    """Return the quantity's name in an expression, and its limits as texts.

    >>> split_expression("damping >= 3%")
    ('damping', {'lower': '3%'})
    >>> split_expression("0.18N/mm <= stiffness at 40s <= 0.22N/mm")
    ('stiffness at 40s', {'lower': '0.18N/mm', 'upper': '0.22N/mm'})

    Raises
    ------
    DataError
        If it is no expression.
    """
    parts = [part.strip() for part in re.split("(<=|>=)", text.translate(_SPELLINGS))]
    name_indices = [i for i in range(0, len(parts), 2) if not re.match(_NUMBER, parts[i])]
    count = len(parts)
    if not all(parts) or (count, *name_indices) not in {(3, 0), (3, 2), (5, 2)}:
        raise DataError(
            f"'{text}' is no limit; expected a quantity, <= or >=, and a value with its unit, such "
            "as 'damping >= 3%' or '0.18N/mm <= stiffness at 40s <= 0.22N/mm'"
        )
    (name_index,) = name_indices
    limits = {}
    for i in range(1, count, 2):
        # 12 <= f reads as f >= 12
        is_before = i < name_index
        side = "upper" if (parts[i] == "<=") != is_before else "lower"
        if side in limits:
            raise DataError(f"'{text}' has two {side} limits; expected one lower and one upper")
        limits[side] = parts[i - 1 if is_before else i + 1]
    return parts[name_index], limits


def parse_expression(text: str, find_quantity: Callable[[str], Q]) -> LimitEntry[Q]:
    """Return the limits of an expression such as ``"damping >= 3%"``.

    Raises
    ------
    DataError
        If it is no expression, or names no known quantity.
    """
    name, limits = split_expression(text)
    try:
        return _parse_entry(find_quantity(name), limits)
    except (DashpotError, ValueError) as error:
        raise DataError(f"'{text}': {error}") from None


def _parse_entry(quantity: Q, table: Mapping[str, Any]) -> LimitEntry[Q]:
    limit_entries = [table.get(side) for side in ("lower", "upper")]
    lower, upper = (_parse_number(value, quantity) for value in limit_entries)
    cpk = float(table["cpk"]) if "cpk" in table else None
    given_limits = [end for end in (lower, upper) if end is not None]
    if not given_limits:
        raise DataError("it has no limit; give lower, upper, or both")
    if given_limits != sorted(set(given_limits)):
        raise DataError("lower is not below upper; exchange them")
    if cpk is not None and not cpk > 0:
        raise DataError(f"cpk = {cpk:g}; expected a number > 0, such as 1.33")
    return LimitEntry(quantity, lower, upper, cpk, *map(_format_stated, limit_entries))


def _format_stated(value: object) -> str:
    """Return a stated limit with a space before its unit; empty without a unit.

    >>> _format_stated("3%"), _format_stated("1e5 h"), _format_stated("200")
    ('3 %', '1e5 h', '')
    """
    match = _WITH_UNIT.fullmatch(str(value))
    return f"{match[1].strip()} {match[2].strip()}" if match else ""


def _parse_number(value: object, quantity: LimitedQuantity) -> float | None:
    """Return a limit in SI: of a plain number also in per cent, or with the quantity's unit."""
    if value is None:
        return None
    if quantity.dimension is not None:
        return parse_quantity(str(value), quantity.dimension)
    match = _WITH_UNIT.fullmatch(str(value))
    if match is not None and match[2].strip() in {
        quantity.unit,
        quantity.unit.removeprefix("1"),
    } - {"", "%"}:
        number = float(match[1])
    elif match is not None and (unit := find_unit(match[2], "strain")) is not None:
        number = float(match[1]) * unit.factor
    else:
        try:
            number = float(str(value))
        except ValueError:
            unit_hint = f" or with {quantity.unit}" if quantity.unit not in {"", "%"} else ""
            unit = None if match is None else find_unit(match[2])
            other = "" if unit is None else _QUANTITIES.get(unit.dimension, "")
            hint = f". Is the {other} meant: '{other} <= {value}'?" if other else ""
            raise DataError(
                f"'{value}' is no limit of {quantity.column}; expected a number such as 0.03 or "
                f"3%{unit_hint}{hint}"
            ) from None
    if not math.isfinite(number):
        raise ValueError(f"{value} is no limit; expected a finite number")
    if abs(number) > 1 and quantity.column.startswith(_SHARES) and "%" not in str(value):
        raise DataError(f"{value} would be {100 * number:g} %; write {value}% if that is meant")
    return number
