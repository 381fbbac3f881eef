"""Version of dashpot, and the byline of every file that it writes."""

from __future__ import annotations

from dashpot.base.lazy import compile_on_use


def _read_version() -> str:
    try:  # the build writes it, from the last tag
        from dashpot.base._version import __version__ as found
    except ImportError:  # the sources were not installed
        return "0.0.0+unknown"
    return str(found)


__version__ = _read_version()

# A JSON document begins with its schema; every other file contains `byline`.
_BYLINE = compile_on_use(rb"\bdashpot \d+\.\d+\.[\w.+]+: [a-zA-Z]")
_SCHEMA = compile_on_use(rb'\s*\{\s*"schema": ?"dashpot/')
_PROFILE = b"# dashpot reading profile"
_RECORD = compile_on_use(rb"\bdashpot \d+\.\d+\.[\w.+]+: (?:a virtual|simulated) ")


def byline(title: str) -> str:
    """Return one line which states that dashpot made a file, and its title.

    >>> byline("frequency response function").startswith("dashpot ")
    True
    """
    return f"dashpot {__version__}: {title}"


def software() -> dict[str, str]:
    """Return the versions of dashpot and of the libraries that it computes with, by name."""
    import platform

    import numpy as np
    import scipy

    return {
        "dashpot": __version__,
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "python": platform.python_version(),
    }


def is_record(head: bytes) -> bool:
    """Return whether a file that begins with `head` is a record of simulation.

    >>> is_record(b"# simulated by dashpot 1.2.3: a virtual hammer, not a measurement")
    True
    """
    return bool(_RECORD.search(head))


def is_ours(head: bytes) -> bool:
    """Return whether a file that begins with `head` was written by dashpot.

    >>> is_ours(b'{"schema": "dashpot/fit@2"'), is_ours(b"dashpot 2: front left")
    (True, False)
    """
    schema, profile = _SCHEMA.match(head), head.startswith(_PROFILE)
    return bool(schema or profile or _BYLINE.search(head))
