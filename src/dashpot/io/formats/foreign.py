"""Readers that others keep well: imported when used, and named when missing."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from dashpot.base.errors import ReadError


def extra(module: str, package: str, file: str, what: str) -> Any:
    """Return an optional package's module.

    Raises
    ------
    ReadError
        If it is not installed, with the command that installs it.
    """
    try:
        return import_module(module)
    except ImportError:
        raise ReadError(
            f'{file}: {what} need the package {package}; install it with pip install "dashpot[io]"'
        ) from None
