"""What single numbers of a noun must be; needs no NumPy, as ``--help`` does not."""

from __future__ import annotations

import math
from typing import Any

from dashpot.base.errors import DataError


def require_positive(
    of: str = "",
    /,
    *,
    unit: str = "",
    expected: str = "a number > 0",
    optional: bool = False,
    **named: float | None,
) -> None:
    """Refuse the first of the named numbers that is not finite and > 0.

    Parameters
    ----------
    of : str
        What is said before the name.
    unit : str
        What is said behind the number.
    expected : str
        What is asked for.
    optional : bool
        None is passed over.
    named : float

    >>> require_positive("axis ", rate=0.0, unit=" Hz")
    Traceback (most recent call last):
    dashpot.base.errors.DataError: axis rate = 0.0 Hz; expected a number > 0
    """
    for name, value in named.items():
        provided: Any = value
        if not (optional and provided is None) and not (math.isfinite(provided) and provided > 0):
            raise DataError(f"{of}{name} = {provided!r}{unit}; expected {expected}")


def require_nonnegative(of: str = "", /, *, expected: str = "a number >= 0", **named: Any) -> None:
    """Refuse the first number that is not finite and >= 0, as :func:`require_positive` does."""
    require_positive(
        of, expected=expected, **{name: value for name, value in named.items() if value != 0}
    )


def select_fields(result: object, *names: str) -> dict[str, Any]:
    """Return some of the fields of a record by name."""
    return {name: getattr(result, name) for name in names}
