"""A TOML document as its tables, whoever wrote it."""

from __future__ import annotations

import re
from typing import Any

from dashpot.base.errors import ReadError

_DEEP = re.compile(r"""(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){64}""")
"""A key of more parts than anyone writes."""


def parsed_toml(content: bytes) -> dict[str, Any]:
    """Return the tables of a TOML document.

    Raises
    ------
    ReadError
        If it is not TOML in UTF-8, or nested so deeply that nobody wrote it.
    """
    import tomllib  # few need it, and it costs time to import

    try:
        text = content.decode("utf-8-sig")
        if _DEEP.search(text):  # the parser's time grows with the square of their number
            raise RecursionError
        return tomllib.loads(text)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ReadError(f"not TOML in UTF-8: {error}") from None
    except RecursionError:
        raise ReadError("not TOML that a person wrote: it is nested too deeply") from None
