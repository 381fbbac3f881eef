"""Options by which every test of a batch is read and fitted."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from dashpot.base import dataclass
from dashpot.base.errors import DataError
from dashpot.base.option_fields import (
    Method,
    copy_option,
    get_option_key,
    iterate_option_fields,
    make_nested_options,
    option,
)
from dashpot.base.units import Dimension, Quantity, convert_to_si, si_fields
from dashpot.base.value_ranges import SIZES
from dashpot.datamodel.machine import HAMMER_RIG_FIELDS, Machine, MachineCalibration
from dashpot.extensions.batch.input_files import Entry
from dashpot.reading.raw_file import open_raw
from dashpot.reading.read_options import ReadOptions
from dashpot.workflow.job import Job

MAX_ARMS = 6
"""Largest number of arms with ``arms="auto"``, and of joint fits."""


def convert_quantities(
    quantity_or_quantities: Quantity | Sequence[Quantity], dimension: Dimension
) -> tuple[float, ...]:
    """Return one quantity or several in SI."""
    quantities = (
        [quantity_or_quantities]
        if isinstance(quantity_or_quantities, str | float | int)
        else quantity_or_quantities
    )
    return tuple(convert_to_si(quantity, dimension) for quantity in quantities)


def _require_positive(
    name: str, value: float, unit: str = "", *, expected: str = "a number"
) -> None:
    if not 0 < value < math.inf:
        raise DataError(f"{name} = {value!r}{unit}; expected {expected} > 0")


def make_machine(values: dict[str, Any]) -> Machine:
    """Return a machine from plain values of JSON."""
    calibration = values.get("calibration")
    if calibration is None:
        return Machine(**values)
    return Machine(**(values | {"calibration": MachineCalibration(**calibration)}))


@dataclass(frozen=True)
class BatchOptions:
    """Options by which every test of a batch is read and fitted.

    Attributes
    ----------
    arms, method
        As in :func:`~dashpot.fitting.relaxation.fit`.
    quick : bool
        The optimum alone: no errors, no checks, no verdict.
    mass : float or None
        Mass of the block on the seals, kg, for tests without their own.
    seals : float
        Under that mass.
    reading, reading_impact : ReadOptions
        Options of the tests, and of the hammer's files.
    joint : bool
        Where a hammer is paired with a ramp and hold: one solid for both.
    at : tuple of float
        Frequencies, Hz, at which each row has storage and loss stiffness and loss factor.
    compression : tuple of float
        Compression of the seals, m, for these and for the stiffness at the end of the hold; without
        any, the depth of each test. The first is the nominal one of a load deflection record.
    length : float or None
        Contact length of each specimen, m: load deflection is then per 100 mm.
    radius : float or None
        Radius of an indenter's tip, m: a hit then has a modulus.
    machine : Machine
        Testing machine of tests without one in the manifest.
    """

    arms: int | Literal["auto"] = copy_option(Job, "arms")
    method: Method = copy_option(Job, "method")
    quick: bool = option(False, "No intervals; needs a number of --arms.", is_flag=True)
    mass: float | None = copy_option(Job, "mass", help="Test mass or indenter: adds its frequency.")
    seals: float = copy_option(Job, "seals")
    reading: ReadOptions = make_nested_options(ReadOptions)
    reading_impact: ReadOptions = make_nested_options(ReadOptions)
    joint: bool = option(False, "Joint model of a test and its hammer.", is_flag=True)
    at: tuple[float, ...] = option(
        (),
        "Add stiffness and loss factor there, e.g. 12.7Hz.",
        unit="frequency", multiple=True, flag="frequency",
    )  # fmt: skip
    compression: tuple[float, ...] = option(
        (),
        "Compression for these results (as tested).",
        unit="length", multiple=True, size=SIZES["travel"],
    )  # fmt: skip
    length: float | None = option(
        None,
        "Contact length of each specimen, e.g. 100mm.",
        unit="length",
        size=SIZES["seal length"],
    )
    radius: float | None = option(
        None, "Radius of an indenter's tip.", unit="length", size=SIZES["radius"]
    )
    machine: Machine = make_nested_options(Machine)

    def __post_init__(self) -> None:
        si_fields(self)
        if self.quick and self.arms == "auto":
            raise DataError(
                "--quick needs the number of arms (such as --arms 2): choosing it takes the "
                "errors that it leaves out"
            )
        for name, unit in (("mass", " kg"), ("length", " m"), ("radius", " m"), ("seals", "")):
            value = getattr(self, name)
            if value is not None:
                _require_positive(name, value, unit)
        for name in ("at", "compression"):
            results = tuple(dict.fromkeys(getattr(self, name)))
            object.__setattr__(self, name, results)
            for result in results:
                _require_positive(name, result, expected="numbers")
        _refuse_unused_rig(self.machine, is_joint=self.joint)
        if self.joint and self.quick:
            raise DataError(
                "--joint weights relaxation and hammer test by errors, which --quick leaves out"
            )

    @property
    def columns(self) -> int:
        """Largest number of arms in a row."""
        return MAX_ARMS if self.arms == "auto" or self.joint else self.arms

    @property
    def bench(self) -> ReadOptions:
        """Options to read a test, before it is known to be a modulus."""
        return self.reading.drop_fields(("modulus",))

    @staticmethod
    def from_plain(values: dict[str, Any]) -> BatchOptions:
        """Return the options from plain values of JSON."""
        options = {
            name: ReadOptions(**(values[name] | {"units": dict(values[name]["units"])}))
            for name in ("reading", "reading_impact")
        }
        return BatchOptions(**(values | options | {"machine": make_machine(values["machine"])}))

    def calibration(self) -> str:
        """Return the hash of the calibration that the readings are turned by; empty without one."""
        path = self.reading.calibration
        return (
            "" if path is None else hashlib.sha256(open_raw(Path(path)).head(1 << 20)).hexdigest()
        )


def find_test_machine(entry: Entry, choices: BatchOptions) -> Machine:
    """Return the machine on which a test was made: its own, or that of all tests."""
    machine = make_machine(json.loads(entry.machine)) if entry.machine else choices.machine
    _refuse_unused_rig(machine, is_joint=choices.joint)
    return machine


def _refuse_unused_rig(machine: Machine, *, is_joint: bool) -> None:
    if is_joint:
        return
    for field in iterate_option_fields(machine):
        if field.name in HAMMER_RIG_FIELDS and getattr(machine, field.name) is not None:
            raise DataError(
                f"--machine {get_option_key(field)}= is of the hammer's rig, and the row of a test "
                "takes it with --joint alone. Add --joint, or leave it out"
            )
