"""Whatever tests a fit is given, as ramps and holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np

from dashpot.base.errors import FitError
from dashpot.base.provenance import Step
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.preprocessing.checks import history_forgotten
from dashpot.preprocessing.prepare import prepare

Tests: TypeAlias = RampHold | RelaxationTest | Sequence[RampHold | RelaxationTest]
"""One or several tests, prepared or as they were read."""

SAME_DEPTH = 0.02
"""Depths that differ by less, relative, are one."""
BY_DEFAULT = Step("by_default", (), "prepared by default: the fit was given the record as read")


def ramp_holds(tests: Tests) -> tuple[RampHold, ...]:
    """Return one or several tests, prepared; what was done to a record as read is in its steps.

    Raises
    ------
    FitError
        If one of them is no relaxation test.
    DataError
        If one cannot be prepared as it is.
    """
    if isinstance(tests, RampHold | RelaxationTest):
        tests = (tests,)
    return tuple(_prepare_test(test) for test in tests)


def depths_of(test: RelaxationTest, **how: Any) -> tuple[RampHold, ...]:
    """Return the loadings of one record that hold, one to a depth, each as a record of its own.

    Of several to one depth the one with the longest hold. What a later one remembers of those
    before is left out, and a check says how much that is.

    Parameters
    ----------
    test : RelaxationTest
    how
        As :func:`~dashpot.preprocessing.prepare.prepare` takes it, without a cycle.
    """
    chosen = prepare(test, **how)
    parameters = next(dict(step.parameters) for step in chosen.steps if step.name == "segments")
    of = int(parameters["cycle"].partition(" of ")[2])
    every = [prepare(test, **how, cycle=number) for number in range(1, of + 1)] if of > 1 else []
    records: list[RampHold] = []
    for ramp_hold in sorted(every, key=lambda record: -record.hold_time):
        if all(abs(ramp_hold.depth / other.depth - 1) > SAME_DEPTH for other in records):
            records.append(ramp_hold)
    if len(records) < 2:
        return (chosen,)
    return tuple(
        map(_isolate_loading, sorted(records, key=lambda record: record.time[record.start]))
    )


def _isolate_loading(record: RampHold) -> RampHold:
    """A loading without its history, and the check of what that leaves out.

    Of a seal that has not recovered the way from where it was met is taken for that from first
    contact: as long, in proportion.
    """
    if record.loading_start is None:
        return record
    met = int(np.searchsorted(record.time, record.onset))
    last = record.last_loading
    if last.plate is None:
        ratio = float(record.force[max(met - 1, 0)]) / float(record.force.max())
    else:
        face = float(record.displacement[max(met - 1, 0)])
        ratio = face / record.depth
        way = np.maximum(last.plate - face, 0.0) / (1 - ratio)
        last = replace(last, displacement=way, plate=None)
    return replace(last, checks=(*record.checks, history_forgotten(ratio)))


def _prepare_test(test: object) -> RampHold:
    if isinstance(test, RampHold):
        return test
    if not isinstance(test, RelaxationTest):
        raise FitError(
            f"a fit takes relaxation tests, prepared or as read, found a {type(test).__name__}"
        )
    made = prepare(test)
    return replace(made, steps=(BY_DEFAULT, *made.steps))
