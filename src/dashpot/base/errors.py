"""What can go wrong, as types.

::

    DashpotError            anything dashpot refuses, in one clear sentence
    ├── ReadError           a file is not what it should be
    ├── DataError           numbers or units that cannot be what they claim
    ├── FitError            a fit that cannot be asked for
    └── ExportError         a deck that must not be written

The text of an error says where, what was found, what was expected and what to do.
A fit that does not converge, or a parameter that the data cannot see, is no error:
it is a :class:`~dashpot.base.status.Status` or a failed :class:`~dashpot.base.checks.Check`.
"""


class DashpotError(Exception):
    """The root of everything that dashpot refuses.

    >>> import dashpot as dp
    >>> try:
    ...     dp.read("nowhere.csv")
    ... except dp.DashpotError as error:
    ...     type(error).__name__
    'ReadError'
    """


class ReadError(DashpotError):
    """A file is not what it should be.

    >>> import dashpot as dp
    >>> dp.read("nowhere.csv")
    Traceback (most recent call last):
        ...
    dashpot.base.errors.ReadError: ...
    """


class DataError(DashpotError, ValueError):
    """Numbers or units that cannot be what they claim to be.

    >>> import dashpot as dp
    >>> dp.Specimen(length="50")
    Traceback (most recent call last):
        ...
    dashpot.base.errors.DataError: ...
    """


class FitError(DashpotError, ValueError):
    """A fit that cannot be asked for with this data or these options.

    >>> import dashpot as dp
    >>> dp.fit(dp.simulate("relaxation", hold="5s", noise_free=True), seals=2)
    Traceback (most recent call last):
        ...
    dashpot.base.errors.FitError: seals= does not suit tests on a bench. ...
    """


class ExportError(DashpotError, ValueError):
    """A deck that must not be written.

    >>> import dashpot as dp
    >>> dp.save(dp.GeneralizedMaxwell(1.0), "solid.xlsx")
    Traceback (most recent call last):
        ...
    dashpot.base.errors.ExportError: ...
    """
