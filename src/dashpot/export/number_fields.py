"""Numbers as solvers read them."""

from __future__ import annotations

import re

from dashpot.base.errors import ExportError


def text(value: float) -> str:
    """A number as decks print it: ten digits and always a point, without which it is an integer.

    >>> text(2e-05), text(196.5), text(3.0)
    ('2.e-05', '196.5', '3.')
    """
    mantissa, exponent, power = f"{value:.10g}".partition("e")
    return mantissa + ("" if "." in mantissa else ".") + exponent + power


def packed(value: float, width: int) -> str:
    """A number in at most `width` columns, with as many digits as they hold, always a point.

    >>> packed(0.50212766, 10), packed(3.68393e-05, 10), packed(-120.0, 8)
    ('0.50212766', '3.68393E-5', '-120.')
    """
    if value == 0:
        return "0."
    for digits in range(min(17, width), 0, -1):
        rounded = f"{value:.{digits - 1}E}"
        mantissa, _, power = rounded.partition("E")
        plain = f"{value:.{max(digits - 1 - int(power), 0)}f}" if abs(int(power)) < 17 else ""
        for candidate in (
            _pointed(plain),
            re.sub(r"^(-?)0(?=\.)", r"\1", _pointed(plain)),
            f"{_pointed(mantissa)}E{int(power)}",
        ):
            if candidate and len(candidate) <= width and float(candidate) == float(rounded):
                return candidate
    raise ExportError(f"{value!r} does not fit into {width} columns")


def _pointed(number: str) -> str:
    """Trailing zeros gone, a decimal point there."""
    if not number:
        return ""
    return number.rstrip("0") if "." in number else number + "."


def one_line(line: str) -> str:
    """Printable ASCII: a file name can hold anything, a solver reads no more."""
    return "".join(sign if " " <= sign <= "~" else "?" for sign in line)
