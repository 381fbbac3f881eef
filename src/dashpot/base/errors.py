"""Exceptions of dashpot, and the status with which an optimisation ends."""

from __future__ import annotations

from enum import Enum

# Exceptions.
#
# ::
#
#     DashpotError            anything dashpot refuses, in one clear sentence
#     ├── ReadError           a file is not what it should be
#     ├── DataError           numbers or units that cannot be what they claim
#     ├── FitError            a fit that cannot be asked for
#     └── ExportError         a deck that must not be written
#
# The text of an error says where, what was found, what was expected and what to do.
# A fit that does not converge, or a parameter that the data cannot see, is no error:
# it is a :class:`~dashpot.base.errors.Status` or a failed :class:`~dashpot.base.checks.Check`.


class DashpotError(Exception):
    """Base class of all errors of dashpot.

    >>> import dashpot as dp
    >>> try:
    ...     dp.read("nowhere.csv")
    ... except dp.DashpotError as error:
    ...     type(error).__name__
    'ReadError'
    """


class ReadError(DashpotError):
    """Error in the contents of a file.

    >>> import dashpot as dp
    >>> dp.read("nowhere.csv")
    Traceback (most recent call last):
        ...
    dashpot.base.errors.ReadError: ...
    """


class DataError(DashpotError, ValueError):
    """Error in numbers or units that cannot be valid.

    >>> import dashpot as dp
    >>> dp.Specimen(length="50")
    Traceback (most recent call last):
        ...
    dashpot.base.errors.DataError: ...
    """


class FitError(DashpotError, ValueError):
    """Error of a fit that these data or options do not allow.

    >>> import dashpot as dp
    >>> dp.fit(dp.simulate("relaxation", hold="5s", noise_free=True), seals=2)
    Traceback (most recent call last):
        ...
    dashpot.base.errors.FitError: seals= does not suit tests on a bench. ...
    """


class ExportError(DashpotError, ValueError):
    """Error of a deck that must not be written.

    >>> import dashpot as dp
    >>> dp.save(dp.GeneralizedMaxwell(1.0), "solid.xlsx")
    Traceback (most recent call last):
        ...
    dashpot.base.errors.ExportError: ...
    """


# Status of an optimisation.


class Status(Enum):
    """Status of an optimisation, the gravest last; names for programs, values for people.

    It does not say whether the result is good: `Fit.verdict` does.
    """

    CONVERGED = "the optimum was found"
    NOT_IDENTIFIED = "the optimum was found, but the data do not determine every parameter"
    TESTS_DISAGREE = "the optimum was found, but no single model explains every test"
    TAU_AT_BOUND = "a relaxation time of the optimum lies at the edge of the measured window"
    FEWER_ARMS = "the optimum has fewer arms than asked for; one more arm would have k <= 0"
    NOT_CONVERGED = "the iteration limit was reached before the gradient vanished"
    FORCE_RISES = "the force rises during the hold; a relaxing seal cannot do that"
    NO_DATA = "nothing was fitted, because the record has values that are not finite"
