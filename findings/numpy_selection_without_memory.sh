#!/usr/bin/env bash
# NumPy: a selection of rows without memory left raises SystemError, not MemoryError.
#
# Expected: whatever allocates raises MemoryError where nothing is left, as x.copy() and x + 1 do of a
#   large array, so that a program can catch it and read less.
# Happens: x[mask], x[rows] and x[:, columns] first allocate an iterator of some kilobytes. Without
#   memory for it they return an error and set none, and Python raises "SystemError: error return
#   without exception set". The same selection by numpy.take, which needs no such iterator, works.
# Matters: readers of foreign files run under a limit of addresses (ulimit -v, a batch queue), and
#   select rows at every step. "except MemoryError" passes this by, and the log names a fault of the
#   interpreter where the file was too large. Catch SystemError, too, and say "out of memory".
set -euo pipefail
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q "numpy==2.4.6"
cd "$folder"
venv/bin/python - <<'PYTHON'
import ctypes
import resource

import numpy as np

LEAST = 1024
"""Bytes of the smallest block that is taken away; small Python objects need less."""
libc = ctypes.CDLL(None)
libc.malloc.restype, libc.malloc.argtypes = ctypes.c_void_p, [ctypes.c_size_t]
libc.free.argtypes = [ctypes.c_void_p]


def run_without_memory(operation):
    """Return what an operation raises while no block of LEAST bytes can be allocated."""
    operation()  # nothing is imported or cached later
    taken, count, size, raised = [None] * 500_000, 0, 1 << 20, None
    used = int(open("/proc/self/statm").read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used, resource.RLIM_INFINITY))
    while size >= LEAST:
        block = libc.malloc(size)
        if block:
            taken[count], count = block, count + 1
        else:
            size //= 2
    try:
        operation()
    except (MemoryError, SystemError) as error:
        raised = error
    resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    for block in taken[:count]:
        libc.free(block)
    return raised


small, large = np.arange(30.0).reshape(10, 3), np.zeros((1000, 3))
mask, rows, columns = small[:, 0] > 9.0, np.array([1, 5, 7]), np.array([0, 2])
operations = {
    "small[mask]": lambda: small[mask],
    "small[rows]": lambda: small[rows],
    "small[:, columns]": lambda: small[:, columns],
    "np.take(small, rows)": lambda: np.take(small, rows, axis=0),
    "large.copy()": lambda: large.copy(),
    "large + 1": lambda: large + 1,
}
print("NumPy", np.__version__)
found = {name: run_without_memory(operation) for name, operation in operations.items()}
for name, error in found.items():
    print(f"  {name:22} {type(error).__name__ if error else 'done':12} {error or ''}")
for name in ("small[mask]", "small[rows]", "small[:, columns]"):
    assert type(found[name]) is SystemError, name
    assert "without exception set" in str(found[name]), name
assert found["np.take(small, rows)"] is None
for name in ("large.copy()", "large + 1"):
    assert isinstance(found[name], MemoryError), name
PYTHON
