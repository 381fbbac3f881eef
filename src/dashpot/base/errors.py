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
    """The root of everything that dashpot refuses."""


class ReadError(DashpotError):
    """A file is not what it should be."""


class DataError(DashpotError, ValueError):
    """Numbers or units that cannot be what they claim to be."""


class FitError(DashpotError, ValueError):
    """A fit that cannot be asked for with this data or these options."""


class ExportError(DashpotError, ValueError):
    """A deck that must not be written."""
