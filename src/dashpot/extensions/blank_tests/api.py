"""Public Python function for blank tests."""

from __future__ import annotations

from typing import Any

from dashpot.base.units import Quantity
from dashpot.extensions.blank_tests.datamodel import MachineFit


def fit_machine(
    records: list[Any],
    *,
    spring_stiffness: Quantity | None = None,
    spring_error: float | str | None = None,
) -> MachineFit:
    """Return the properties of a testing machine from blank tests."""
    from dashpot.extensions.blank_tests.fit import fit_blank_tests

    return fit_blank_tests(records, spring_stiffness=spring_stiffness, spring_error=spring_error)
