"""Named arrays of a binary file gathered to one table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.errors import ReadError
from dashpot.io.columns.names import part_unit
from dashpot.io.table import Column, FileTable, in_memory

_RATES = {"fs", "rate", "samplerate", "samplingrate", "samplefrequency", "samplingfrequency", "sr"}
_WINDOWS = ("window", "fenster", "exp_decay", "expdecay")
_STEPS = {"dt", "ts", "deltat", "timestep", "sampletime", "deltax", "increment"}


@dataclass(frozen=True, eq=False)
class Named:
    """One array with its name and unit as found."""

    name: str
    values: FloatArray | ComplexArray
    unit: str | None = None


def gather(arrays: Sequence[Named], *, format_: str, notes: Sequence[str] = ()) -> FileTable:
    """Return the arrays of the commonest length as one table; single numbers become hints.

    A complex array becomes two columns, named after it: its real and its imaginary part.

    Raises
    ------
    ReadError
        If no two arrays, nor one wide array, could be a test.
    """
    vectors = _vectors(arrays)
    if not vectors:
        raise ReadError(f"no numeric channels found in this {format_} file")
    counts = Counter(array.values.size for array in vectors)
    length = max(counts, key=lambda size: (counts[size] > 1, counts[size] * size))
    kept = [array for array in vectors if array.values.size == length]
    left = [array.name for array in vectors if array.values.size != length]
    passed = f"{len(left)} arrays of another length than {length} were passed over: " + ", ".join(
        left[:5]
    )
    return FileTable(
        format=format_,
        columns=tuple(map(_column, kept)),
        load=in_memory(np.column_stack([array.values for array in kept])),
        notes=(*notes, passed) if left else tuple(notes),
        hints=tuple(_hints(arrays)),
        header=tuple(_window_lines(arrays)),
    )


def window_line(name: str, value: object) -> str:
    """Return a line of a header for what a file states of a window; empty of anything else."""
    return f"{name}: {value}" if any(word in name.casefold() for word in _WINDOWS) else ""


def _window_lines(arrays: Sequence[Named]) -> list[str]:
    """What single numbers say of a window."""
    single = [one for one in arrays if np.size(one.values) == 1 and not np.iscomplexobj(one.values)]
    lines = [
        window_line(one.name, f"{float(np.squeeze(one.values)):g} {one.unit or ''}".strip())
        for one in single
    ]
    return [line for line in lines if line]


def _column(array: Named) -> Column:
    return Column(array.name, array.unit) if array.unit else Column(*part_unit(array.name))


def _vectors(arrays: Sequence[Named]) -> list[Named]:
    """Vectors as they are; a matrix as one vector for each of its columns."""
    out = []
    for array in chain.from_iterable(map(_parts, arrays)):
        values = np.squeeze(np.asarray(array.values, dtype=float))
        if values.ndim == 1:
            out.append(Named(array.name, values, array.unit))
        elif values.ndim == 2 and min(values.shape) <= 64:
            tall = values if values.shape[0] >= values.shape[1] else values.T
            out += [
                Named(f"{array.name} {i + 1}", tall[:, i], array.unit) for i in range(tall.shape[1])
            ]
    return [array for array in out if array.values.size >= 2]


def _parts(array: Named) -> tuple[Named, ...]:
    if not np.iscomplexobj(array.values):
        return (array,)
    real = np.asarray(np.real(array.values), dtype=float)
    imaginary = np.asarray(np.imag(array.values), dtype=float)
    return (
        Named(f"{array.name} real", real, array.unit),
        Named(f"{array.name} imaginary", imaginary, array.unit),
    )


def _hints(arrays: Sequence[Named]) -> list[str]:
    """What single numbers say about the sampling rate."""
    hints = []
    for array in arrays:
        if np.size(array.values) != 1 or np.iscomplexobj(array.values):
            continue
        value = float(np.squeeze(array.values))
        word = "".join(c for c in array.name.split(".")[-1].casefold() if c.isalpha())
        rate = value if word in _RATES else 1 / value if word in _STEPS and value > 0 else 0.0
        if rate > 0:
            hints.append(
                f"the file says {array.name} = {value:g}; if that is right, add "
                f"--rate {rate:.10g}Hz"
            )
    return hints


def numbers(values: object) -> FloatArray | ComplexArray | None:
    """Return an array of numbers as floats, complex ones as such, or None for anything else."""
    array = np.asarray(values)
    if array.dtype.kind == "c":
        return array.astype(complex)
    return array.astype(float) if array.dtype.kind in "iufb" else None
