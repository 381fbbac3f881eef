"""Whatever tests a fit is given, as ramps and holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeAlias

from dashpot.base.errors import FitError
from dashpot.base.provenance import Step
from dashpot.preparation.prepare import prepare
from dashpot.records.relaxation import RampHold, RelaxationTest

Tests: TypeAlias = RampHold | RelaxationTest | Sequence[RampHold | RelaxationTest]
"""One or several tests, prepared or as they were read."""

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
    return tuple(_prepared(test) for test in tests)


def _prepared(test: object) -> RampHold:
    if isinstance(test, RampHold):
        return test
    if not isinstance(test, RelaxationTest):
        raise FitError(
            f"a fit takes relaxation tests, prepared or as read, found a {type(test).__name__}"
        )
    made = prepare(test)
    return replace(made, steps=(BY_DEFAULT, *made.steps))
