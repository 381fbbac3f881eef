"""Results as pandas and xarray tables, where those are installed."""

from __future__ import annotations

from collections.abc import Sequence
from functools import singledispatch
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.base.reported_values import HasReportedValues, ReportedValue
from dashpot.base.result_mixins import HasSummary, HasVerdict
from dashpot.datamodel.fit import Fit
from dashpot.registry import format_install_command
from dashpot.workflow.study import Study


class UnitFrame(NamedTuple):
    """Columns of one length, the first their index, each with its SI unit ("" if it has none)."""

    columns: dict[str, Any]
    units: dict[str, str]


def to_pandas(result: object) -> Any:
    """Return a result as a :class:`pandas.DataFrame`, its units in ``attrs["units"]``.

    Raises
    ------
    DataError
        If pandas is not installed.
    """
    data = frame(result)
    index, *_ = data.columns
    table = library("pandas").DataFrame(data.columns).set_index(index)
    table.attrs["units"] = data.units
    return table


def to_xarray(result: object) -> Any:
    """Return a result as an :class:`xarray.Dataset` over its index, each variable with its unit.

    Raises
    ------
    DataError
        If xarray is not installed.
    """
    xarray, data = library("xarray"), frame(result)
    index, *other_columns = data.columns

    def variable(name: str) -> Any:
        return xarray.Variable((index,), data.columns[name], {"units": data.units[name]})

    return xarray.Dataset(
        {name: variable(name) for name in other_columns}, {index: variable(index)}
    )


def library(name: str) -> Any:
    """Return a library of the extra ``frames``, or raise an error with the install command."""
    try:
        return import_module(name)
    except ImportError:
        advice = format_install_command("frames")
        raise DataError(f"{name} is not installed; install it with: {advice}") from None


@singledispatch
def frame(result: object) -> UnitFrame:
    """Return the numbers of a result as columns: its own series, or its facts."""
    if isinstance(result, HasSummary) and result._table_columns:
        return _make_frame(**result._table_columns)
    if isinstance(result, HasVerdict | HasReportedValues) and result.facts:
        return _build_facts_frame(result.facts)
    raise DataError(f"a {type(result).__name__} is no table")


def _make_frame(**columns: tuple[Any, str]) -> UnitFrame:
    """Return a frame of columns that are there, each given with its unit."""
    entries = {name: pair for name, pair in columns.items() if pair[0] is not None}
    return UnitFrame(
        {name: values for name, (values, _) in entries.items()},
        {name: unit for name, (_, unit) in entries.items()},
    )


@frame.register
def _(result: Fit) -> UnitFrame:
    """Return the values, without the dashpots that follow from k and tau."""
    return _build_facts_frame(
        [
            reported_value
            for reported_value in result.facts
            if not reported_value.name.startswith("b")
        ]
    )


def _build_facts_frame(rows: Sequence[ReportedValue]) -> UnitFrame:
    """One row for each, with its standard error and 95 % interval."""
    return _make_frame(
        parameter=([row.name for row in rows], ""), value=(_get_column(rows, "value"), ""),
        standard_error=(_get_column(rows, "error"), ""), low=(_get_column(rows, "low"), ""),
        high=(_get_column(rows, "high"), ""), unit=([row.unit for row in rows], ""),
    )  # fmt: skip


@frame.register
def _(result: Study) -> UnitFrame:
    """The parameters of the solid that the study ends with."""
    return frame(result.fit if result.joint is None else result.joint)


def _get_column(rows: Sequence[ReportedValue], name: str) -> FloatArray:
    return np.array([getattr(row, name) for row in rows], dtype=float)
