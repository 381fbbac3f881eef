"""Nouns as tables of other libraries: pandas and xarray, where they are installed."""

from __future__ import annotations

from dataclasses import replace
from functools import singledispatch
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.io.readers.inspect import Inspection
from dashpot.kinds.cld.record import CLD, CompressionTest
from dashpot.records.creep import CreepCompliance, CreepTest
from dashpot.records.dynamic import DynamicTest
from dashpot.records.fit import Fit
from dashpot.records.frf import FRF
from dashpot.records.impact import ImpactTest
from dashpot.records.modulus import RelaxationModulus
from dashpot.records.relaxation import RampHold, RelaxationTest
from dashpot.records.superposition import Superposition
from dashpot.vibration.comparison.comparison import Comparison
from dashpot.workflow.study import Study


class UnitFrame(NamedTuple):
    """Columns of one length, the first their index, each with its SI unit ("" if it has none)."""

    columns: dict[str, Any]
    units: dict[str, str]


def to_pandas(noun: object) -> Any:
    """Return a noun as a :class:`pandas.DataFrame`, its units in ``attrs["units"]``.

    Raises
    ------
    DataError
        If pandas is not installed.
    """
    made = frame(noun)
    index, *_ = made.columns
    table = library("pandas").DataFrame(made.columns).set_index(index)
    table.attrs["units"] = made.units
    return table


def to_xarray(noun: object) -> Any:
    """Return a noun as an :class:`xarray.Dataset` over its index, each variable with its unit.

    Raises
    ------
    DataError
        If xarray is not installed.
    """
    xarray, made = library("xarray"), frame(noun)
    index, *others = made.columns

    def variable(name: str) -> Any:
        return xarray.Variable((index,), made.columns[name], {"units": made.units[name]})

    return xarray.Dataset({name: variable(name) for name in others}, {index: variable(index)})


def library(name: str) -> Any:
    """Return a library that the extra ``frames`` brings, or say so."""
    try:
        return import_module(name)
    except ImportError:
        raise DataError(
            f'{name} is not installed; pip install "dashpot[frames]" brings it'
        ) from None


@singledispatch
def frame(noun: object) -> UnitFrame:
    """Return the numbers of a noun as columns."""
    raise DataError(f"a {type(noun).__name__} is no table")


def _frame(**columns: tuple[Any, str]) -> UnitFrame:
    """Return a frame of columns that are there, each given with its unit."""
    known = {name: pair for name, pair in columns.items() if pair[0] is not None}
    return UnitFrame(
        {name: values for name, (values, _) in known.items()},
        {name: unit for name, (_, unit) in known.items()},
    )


@frame.register(RelaxationTest)
@frame.register(RampHold)
def _(noun: RelaxationTest | RampHold) -> UnitFrame:
    return _frame(
        time=(noun.time, "s"), displacement=(noun.displacement, "m"), force=(noun.force, "N")
    )


@frame.register
def _(noun: CompressionTest) -> UnitFrame:
    return _frame(
        displacement=(noun.displacement, "m"), force=(noun.force, "N"), time=(noun.time, "s")
    )


@frame.register
def _(noun: CLD) -> UnitFrame:
    return _frame(
        compression=(noun.compression, "m"), force=(noun.force, "N"), time=(noun.time, "s")
    )


@frame.register
def _(noun: ImpactTest) -> UnitFrame:
    record = np.repeat(np.arange(1, len(noun.starts) + 1), np.diff((*noun.starts, len(noun.time))))
    accelerations = {
        name: (row, "m/s^2") for name, row in zip(noun.channels, noun.acceleration, strict=True)
    }
    return _frame(time=(noun.time, "s"), record=(record, ""), force=(noun.force, "N"),
                  **accelerations)  # fmt: skip


@frame.register
def _(noun: DynamicTest) -> UnitFrame:
    return _frame(
        frequency=(noun.frequency, "Hz"),
        storage=(noun.storage, noun.unit),
        loss=(noun.loss, noun.unit),
        temperature=(noun.temperature, "K"),
    )


@frame.register
def _(noun: CreepTest) -> UnitFrame:
    moved, pushed = ("m", "N") if noun.unit == "N/m" else ("1", "Pa")
    return _frame(
        time=(noun.time, "s"),
        displacement=(noun.displacement, moved),
        force=(noun.force, pushed),
    )


@frame.register
def _(noun: CreepCompliance) -> UnitFrame:
    return _frame(time=(noun.time, "s"), compliance=(noun.compliance, noun.unit))


@frame.register
def _(noun: RelaxationModulus) -> UnitFrame:
    return _frame(
        time=(noun.time, "s"),
        modulus=(noun.modulus, noun.unit),
        temperature=(noun.temperature, "K"),
    )


@frame.register
def _(noun: Superposition) -> UnitFrame:
    """The master curve, and the temperature that each of its samples was measured at."""
    made = frame(replace(noun.curve, temperature=None))
    return UnitFrame(
        {**made.columns, "temperature": noun.temperature}, {**made.units, "temperature": "K"}
    )


@frame.register
def _(noun: FRF) -> UnitFrame:
    return _frame(
        frequency=(noun.frequency, "Hz"),
        value=(noun.value, noun.unit),
        coherence=(noun.coherence, ""),
        sd=(noun.sd, noun.unit),
    )


@frame.register
def _(noun: Comparison) -> UnitFrame:
    return _frame(
        frequency=(noun.measured.frequency, "Hz"),
        measured=(noun.measured.value, noun.measured.unit),
        predicted=(noun.predicted.value, noun.predicted.unit),
        z=(noun.z, ""),
    )


@frame.register
def _(noun: Fit) -> UnitFrame:
    """One row per parameter of the solid, with its standard error and 95 % interval."""
    if noun.family == "fractional":
        return _of_element(noun)
    model, error, ends = noun.model, noun.standard_error, noun.intervals()
    rows = [("k_inf", model.k_inf, error["k_inf"], *ends["k_inf"], noun.unit)]
    for j in range(model.arms):
        rows += [
            (f"k_{j + 1}", model.k[j], error["k"][j], *ends["k"][j], noun.unit),
            (f"tau_{j + 1}", model.tau[j], error["tau"][j], *ends["tau"][j], "s"),
        ]
    names, *numbers, units = zip(*rows, strict=True)
    value, se, low, high = (_column(column) for column in numbers)
    return _frame(
        parameter=(list(names), ""), value=(value, ""), standard_error=(se, ""), low=(low, ""),
        high=(high, ""), unit=(list(units), ""),
    )  # fmt: skip


def _of_element(noun: Fit) -> UnitFrame:
    own, ends = noun.solid_standard_error, noun.solid_intervals()
    units = {"k_inf": noun.unit, "k_0": noun.unit, "tau": "s", "alpha": ""}
    rows = [(getattr(noun.solid, name), own[name], *ends[name]) for name in units]
    value, se, low, high = (_column(column) for column in zip(*rows, strict=True))
    return _frame(
        parameter=(list(units), ""), value=(value, ""), standard_error=(se, ""), low=(low, ""),
        high=(high, ""), unit=(list(units.values()), ""),
    )  # fmt: skip


@frame.register
def _(noun: Study) -> UnitFrame:
    """The parameters of the solid that the study ends with."""
    return frame(noun.fit if noun.joint is None else noun.joint)


@frame.register
def _(noun: Inspection) -> UnitFrame:
    return _frame(
        number=([one.number for one in noun.columns], ""),
        name=([one.name for one in noun.columns], ""),
        unit=([one.unit or "" for one in noun.columns], ""),
        role=([one.role or "" for one in noun.columns], ""),
        because=([one.reason for one in noun.columns], ""),
    )


def _column(values: tuple[float, ...]) -> FloatArray:
    return np.array(values, dtype=float)
