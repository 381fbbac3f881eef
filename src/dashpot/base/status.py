"""How a fit can end."""

from __future__ import annotations

from enum import Enum


class Status(Enum):
    """How the optimiser ended, the gravest last; the name is for programs, the value for people.

    It does not say whether the result is good: `Fit.verdict` does.
    """

    CONVERGED = "the optimum was found"
    NOT_IDENTIFIED = "the optimum was found, but the data do not determine every parameter"
    TESTS_DISAGREE = "the optimum was found, but no single model explains every test"
    TAU_AT_BOUND = "a relaxation time of the optimum lies at the edge of the measured window"
    FEWER_ARMS = "the optimum has fewer arms than asked for; one more arm would have k <= 0"
    NOT_CONVERGED = "the iteration limit was reached before the gradient vanished"
    FORCE_RISES = "the force rises during the hold; no relaxing part does that"
    NO_DATA = "nothing was fitted, because the record has values that are not finite"
