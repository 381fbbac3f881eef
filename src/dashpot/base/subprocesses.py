"""Subprocesses that run this Python interpreter with one BLAS thread."""

from __future__ import annotations

import os
import sys


def interpreter(module: str, *flags: str) -> list[str]:
    """Return the words that start another interpreter and, in it, ``main()`` of a module.

    It imports from where this one does.
    """
    start = f"import sys; sys.path[:] = {sys.path!r}; from {module} import main; main()"
    return [sys.executable, "-P", *flags, "-c", start]


def get_single_thread_env() -> dict[str, str]:
    """Return this environment with one BLAS thread: more would only wait for other processes."""
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    return {**os.environ, **dict.fromkeys(names, "1")}


def get_long_lived_env() -> dict[str, str]:
    """Return that environment for a process that makes arrays over and over: it keeps its memory.

    The C library (of GNU) gives arrays of 100 kB back to the system as they come and go, and takes
    them again page by page: a tenth of a fit, and half of one under the limit that dask sets.
    """
    return get_single_thread_env() | {
        "MALLOC_TRIM_THRESHOLD_": f"{1 << 30}",
        "MALLOC_MMAP_THRESHOLD_": f"{1 << 25}",
    }
