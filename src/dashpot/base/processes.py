"""Processes of our own: another interpreter like this one, with one thread of BLAS."""

from __future__ import annotations

import os
import sys


def interpreter(module: str, *flags: str) -> list[str]:
    """Return the words that start another interpreter and, in it, ``main()`` of a module.

    It imports from where this one does.
    """
    start = f"import sys; sys.path[:] = {sys.path!r}; from {module} import main; main()"
    return [sys.executable, "-P", *flags, "-c", start]


def one_thread() -> dict[str, str]:
    """Return this environment with one thread of BLAS: beside other processes more only wait."""
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    return {**os.environ, **dict.fromkeys(names, "1")}
