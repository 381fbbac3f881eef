"""Read-only finite arrays, frozen dataclasses that hold them, and conversion to SI units."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import field, fields
from functools import wraps
from itertools import pairwise
from types import SimpleNamespace
from typing import Any, TypeAlias, TypeVar

import numpy as np
import numpy.typing as npt

from dashpot.base.errors import DataError
from dashpot.base.serialisation import FIXED_VALUE
from dashpot.base.units import (
    Dimension,
    Quantity,
    Unit,
    find_unit,
    from_unit,
    get_default_unit,
    parse_quantity,
    si_unit,
)

# Read-only finite arrays.


T = TypeVar("T")
R = TypeVar("R")
Scalar = TypeVar("Scalar", bound=np.generic)

FloatArray: TypeAlias = npt.NDArray[np.float64]
ComplexArray: TypeAlias = npt.NDArray[np.complex128]
BoolArray: TypeAlias = npt.NDArray[np.bool_]
IndexArray: TypeAlias = npt.NDArray[np.intp]

MIN_SI_MAGNITUDE, MAX_SI_MAGNITUDE = 1e-30, 1e30
"""Smallest and largest magnitude of any measured array, in SI units."""

MAX_SAMPLES = 2e7
"""Largest length of a planned or simulated record: a day at 200 Hz, a minute at 300 kHz."""


class EqualByValue:
    """Equality by value for frozen dataclasses that hold arrays (declare them ``eq=False``)."""

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return all(
            _are_equal(getattr(self, item.name), getattr(other, item.name))
            for item in fields(self)  # type: ignore[arg-type]
        )

    __hash__ = None  # type: ignore[assignment]


class FrozenArrays(EqualByValue):
    """Frozen dataclass whose arrays become read-only, of their declared kind."""

    def __post_init__(self) -> None:
        for item in fields(self):  # type: ignore[arg-type]
            if (kind := _KINDS.get(str(item.type))) is not None:
                values: npt.NDArray[Any] = np.asarray(getattr(self, item.name), dtype=kind)
                object.__setattr__(self, item.name, make_readonly_copy(values))


_KINDS = {"FloatArray": float, "ComplexArray": complex, "BoolArray": bool}


def _are_equal(a: object, b: object) -> bool:
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return a.dtype == b.dtype and bool(np.array_equal(a, b, equal_nan=True))
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return False
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(_are_equal(x, y) for x, y in zip(a, b, strict=True))
    return bool(a == b)


def cache_on_record(function: Callable[[T], R]) -> Callable[[T], R]:
    """Cache the result of a function on its frozen record, as a decorator."""

    @wraps(function)
    def wrapper(record: T) -> R:
        entries: dict[str, R] = vars(record)
        if key not in entries:
            entries[key] = function(record)
        return entries[key]

    key = f"_{function.__name__}"
    return wrapper


def replace_notes(record: T, **changes: object) -> T:
    """Return a frozen record with changes in fields that no result depends on.

    As :func:`dataclasses.replace`, but cached values (:func:`cache_on_record`, cached properties)
    are copied as well.
    """
    result = copy(record)
    for name, value in changes.items():
        object.__setattr__(result, name, value)
    return result


def validate_samples(name: str, values: npt.ArrayLike, *, minimum: int = 1) -> FloatArray:
    """Return `values` as a read-only float array of shape (n,), every sample finite.

    Raises
    ------
    DataError
        If the values are not numbers, not one-dimensional, fewer than `minimum`, or not finite.
    """
    return _validate_array(name, values, np.dtype(np.float64), minimum)


def convert_numbers_to_si(
    name: str, values: Quantity | npt.ArrayLike, dimension: Dimension | None = None
) -> FloatArray:
    """Return numbers of any shape in SI units; with a dimension, texts are quantities of it.

    Raises
    ------
    DataError
        If they are neither numbers nor texts, or a text cannot be parsed as a quantity.
    """
    try:
        array = np.asarray(values)
        if array.dtype.kind in "iuf" or (array.dtype.kind == "O" and None not in array.flat):
            return np.asarray(array, dtype=float)
    except (TypeError, ValueError, OverflowError):
        array = np.array(None)
    if array.dtype.kind == "U" and dimension is not None:
        numbers = [parse_quantity(str(text), dimension) for text in array.flat]
        return np.array(numbers).reshape(array.shape)
    texts = "" if dimension is None else f", or texts with a unit of {dimension}"
    raise DataError(
        f"{name} is of the type {type(values).__name__}; expected numbers in SI units{texts}"
    )


def to_float(values: npt.ArrayLike) -> FloatArray:
    """Return real numbers as an array.

    Raises
    ------
    TypeError
        If they are no real numbers; NumPy would also read a text.
    """
    return _cast(values, np.float64)


def to_complex(values: npt.ArrayLike) -> ComplexArray:
    """Return numbers as a complex array.

    Raises
    ------
    TypeError
        If they are no numbers; NumPy would also read a text.
    """
    return _cast(values, np.complex128)


def _cast(values: npt.ArrayLike, dtype: type) -> npt.NDArray[Any]:
    array = np.asarray(values)
    # an object column of pandas, or fractions; None would become a number that is none
    is_mixed = array.dtype == object and None not in array.flat
    return array.astype(dtype, casting="unsafe" if is_mixed else "same_kind", copy=False)


def validate_complex_samples(name: str, values: npt.ArrayLike) -> ComplexArray:
    """Return `values` as a read-only complex array of shape (n,), every sample finite."""
    return _validate_array(name, values, np.dtype(np.complex128), 1)


def validate_measured(name: str, values: npt.ArrayLike, *, minimum: int = 1) -> FloatArray:
    """Return `values`, in SI units, as :func:`validate_samples` does, if their size is plausible.

    Raises
    ------
    DataError
        As for :func:`validate_samples`, or if their largest magnitude is neither 0 nor from
        :data:`MIN_SI_MAGNITUDE` to :data:`MAX_SI_MAGNITUDE`: their squares
        would overflow or underflow.
    """
    array = validate_samples(name, values, minimum=minimum)
    peak = max(-float(array.min()), float(array.max()))
    if peak != 0 and not MIN_SI_MAGNITUDE <= peak <= MAX_SI_MAGNITUDE:
        raise DataError(
            f"{name} reaches {peak:.3g} in SI units; expected a magnitude from "
            f"{MIN_SI_MAGNITUDE:g} to "
            f"{MAX_SI_MAGNITUDE:g}: check the unit"
        )
    return array


def validate_measured_fields(result: object, *names: str, minimum: int = 1) -> None:
    """Set fields of a frozen value to :func:`validate_measured` arrays of one length, except None.

    A ``time`` among them must increase.

    Raises
    ------
    DataError
        As for :func:`validate_measured`, :func:`require_same_length` and
        :func:`require_increasing`.
    """
    options = {name: getattr(result, name) for name in names if getattr(result, name) is not None}
    arrays = {
        name: validate_measured(name, values, minimum=minimum) for name, values in options.items()
    }
    for name, values in arrays.items():
        object.__setattr__(result, name, values)
    require_same_length(**arrays)
    if "time" in arrays:
        require_increasing("time", arrays["time"])


def sample_count(duration: float, rate: float) -> int:
    """Return the number of samples of a duration, s, at a rate, Hz, rounded.

    Raises
    ------
    DataError
        If it exceeds :data:`MAX_SAMPLES`.
    """
    count = duration * rate
    if not count <= MAX_SAMPLES:
        raise DataError(
            f"{duration:.6g} s at {rate:.6g} Hz are {count:.3g} samples; expected at most "
            f"{MAX_SAMPLES:.0e}: give a shorter time or a lower rate"
        )
    return round(count)


def require_same_length(**arrays: FloatArray | ComplexArray | None) -> int:
    """Return the common length of the named arrays, without those that are None."""
    sizes = {name: len(values) for name, values in arrays.items() if values is not None}
    if len(set(sizes.values())) > 1:
        lengths_text = ", ".join(f"{name} has {size}" for name, size in sizes.items())
        raise DataError(f"every array must have one value per sample, but {lengths_text}")
    return next(iter(sizes.values()))


def slices(starts: Sequence[int], count: int) -> tuple[slice, ...]:
    """Return the runs of `count` rows, which begin at `starts`, as slices."""
    return tuple(slice(a, b) for a, b in pairwise((*starts, count)))


def compute_run_numbers(starts: Sequence[int], count: int) -> IndexArray:
    """Return the run number of each row, from 1."""
    return np.repeat(np.arange(1, len(starts) + 1), np.diff((*starts, count)))


def make_cosine_sequence(count: int, angle: float, amplitude: complex = 1.0) -> FloatArray:
    """Return Re(amplitude exp(j angle i)) for i = 0 .. count - 1, from two short tables."""
    fine, coarse = _make_rotation_tables(count, angle)
    coarse = amplitude * coarse
    parts = np.stack((coarse.real, -coarse.imag), axis=1) @ np.stack((fine.real, fine.imag))
    return np.asarray(parts.ravel()[:count])


def compute_single_dft(values: FloatArray, angle: float) -> complex:
    """Return the sum of values[i] exp(j angle i), from two short tables."""
    fine, coarse = _make_rotation_tables(len(values), angle)
    rows = len(values) // len(fine)
    head, rest = values[: rows * len(fine)].reshape(rows, -1), values[rows * len(fine) :]
    sums = head @ np.stack((fine.real, fine.imag), axis=1)
    result = coarse[:rows] @ (sums[:, 0] + 1j * sums[:, 1])
    return complex(result + np.exp(1j * angle * rows * len(fine)) * (fine[: len(rest)] @ rest))


def _make_rotation_tables(count: int, angle: float) -> tuple[ComplexArray, ComplexArray]:
    """Return exp(j angle i) within a block, and at the start of each block, for `count` values."""
    short = max(int(np.ceil(np.sqrt(count))), 1)
    fine, coarse = (np.exp(1j * angle * np.arange(short) * index) for index in (1, short))
    return fine, coarse


def require_increasing(name: str, values: FloatArray) -> FloatArray:
    """Return `values`; raise DataError at the first that does not increase strictly."""
    falls = np.flatnonzero(values[1:] <= values[:-1])
    if falls.size:
        i = int(falls[0]) + 1
        raise DataError(
            f"{name} must increase strictly, but {name}[{i}] = {values[i]:.9g} follows "
            f"{values[i - 1]:.9g}; remove repeated or reset time stamps"
        )
    return values


def median(values: FloatArray) -> float:
    """Return the median of finite values, shape (n,).

    ``numpy.median`` does the same, but imports ``numpy.ma`` to look for a mask, which takes an
    eighth of the time of importing NumPy itself; nothing else of a fit needs it.
    """
    low, high = (len(values) - 1) // 2, len(values) // 2
    partitioned = np.partition(values, (low, high))
    return 0.5 * float(partitioned[low] + partitioned[high])


def interpolate_quantile(values: FloatArray, part: float) -> FloatArray:
    """Return a quantile along the first axis, by linear interpolation, as ``numpy.quantile`` does.

    That imports ``numpy.ma``, as ``numpy.median`` does.
    """
    position = part * (len(values) - 1)
    neighbours = math.floor(position), math.ceil(position)
    first, second = np.partition(values, neighbours, axis=0)[[*neighbours]]
    step, t = second - first, position % 1
    return np.asarray(second - step * (1 - t) if t >= 0.5 else first + step * t)


def distinct(values: npt.NDArray[Scalar]) -> npt.NDArray[Scalar]:
    """Return the distinct values of an array, shape (n,), sorted.

    ``numpy.unique`` does the same, but imports ``numpy.ma``, as ``numpy.median`` does.

    >>> distinct(np.array([3, 1, 3])).tolist()
    [1, 3]
    """
    result = np.sort(values, axis=None)
    return result[np.append(True, result[1:] != result[:-1])] if len(result) else result


def block_means(values: FloatArray, count: int) -> FloatArray:
    """Means of blocks of `count` samples along the last axis; an incomplete block is dropped."""
    whole_length = values.shape[-1] // count * count
    parts = values[..., :whole_length].reshape(*values.shape[:-1], -1, count)
    # a product is several times as fast as many short sums
    return np.asarray(parts @ np.full(count, 1.0 / count))


def find_fast_length(minimum: int) -> int:
    """Return the smallest 2^i 3^j 5^k >= `minimum`.

    `scipy.fft.next_fast_len` returns the same, but its import takes longer than the first fit.
    """
    best = 1 << max(minimum - 1, 0).bit_length()
    five = 1
    while five < best:
        product = five
        while product < best:
            rest = -(-minimum // product)
            best = min(best, product << (rest - 1).bit_length())
            product *= 3
        five *= 5
    return best


def slow_periodogram(values: FloatArray, max_cycles: float) -> tuple[FloatArray, FloatArray]:
    """Return cycles per record, up to about `max_cycles`, and the periodogram of the deviations."""
    n = len(values)
    size = find_fast_length(n)
    spectrum = np.fft.rfft(values - values.mean(), size)[: int(max_cycles * size / n) + 2]
    return np.arange(len(spectrum)) * n / size, np.abs(spectrum) ** 2 / n


def find_true_runs(mask: BoolArray) -> IndexArray:
    """Return the first and the last index of every run of True, shape (m, 2).

    >>> find_true_runs(np.array([True, True, False, True])).tolist()
    [[0, 1], [3, 3]]
    """
    edges = np.flatnonzero(np.diff(np.concatenate(([False], mask, [False]))))
    return np.asarray(edges.reshape(-1, 2) - (0, 1))


def make_readonly_copy(values: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return a read-only copy; an array that is read-only already is returned itself.

    :func:`validate_measured` and :func:`validate_samples` do the same.
    """
    return _copy_if_writable(values, None)


def set_readonly(values: FloatArray) -> FloatArray:
    """Make an array read-only and return it; a frozen value then stores it without a copy."""
    values.setflags(write=False)
    return values


def _copy_if_writable(values: npt.ArrayLike, dtype: np.dtype[Any] | None) -> npt.NDArray[Any]:
    """Return a read-only array: a copy, unless it is read-only and 1/4 of its base or more."""
    array = np.asarray(values, dtype=dtype)
    inner: Any = array
    while isinstance(inner, np.ndarray) and not inner.flags.writeable:
        owner, inner = inner, inner.base
    if isinstance(inner, np.ndarray) or not array.flags.c_contiguous or array.size < owner.size / 4:
        array = np.array(array)
        array.setflags(write=False)
    return array


def _validate_array(
    name: str, values: npt.ArrayLike, dtype: np.dtype[Any], minimum: int
) -> npt.NDArray[Any]:
    try:
        array = _copy_if_writable(values, dtype)
    except (TypeError, ValueError, OverflowError) as error:
        raise DataError(f"{name} must hold numbers: {error}") from None
    if array.ndim != 1:
        raise DataError(f"{name} must be one-dimensional, found shape {array.shape}")
    if len(array) < minimum:
        raise DataError(f"{name} needs at least {minimum} samples, found {len(array)}")
    finite = np.isfinite(array)
    if not finite.all():
        bad_indices = np.flatnonzero(~finite)
        raise DataError(
            f"{name}[{int(bad_indices[0])}] is {array[bad_indices[0]]}; every sample must be "
            f"finite ({bad_indices.size} of {len(array)} are not)"
        )
    return array


# Stated units of arrays.


SI = "SI"
Dimensions: TypeAlias = Dimension | tuple[Dimension, ...]
"""Dimension of an array: one, or one of several, as for the modulus of a material or a part."""


def make_units_field() -> Any:
    """Return the dataclass field with the units of the arrays: ``"SI"``, or one for each.

    After conversion the field is ``"SI"``; it is not written to documents.
    """
    return field(default="", kw_only=True, repr=False, compare=False, metadata={FIXED_VALUE: SI})


def convert_arrays_to_si(result: Any, **dimensions: Dimensions) -> Mapping[str, Dimension]:
    """Convert the arrays of a frozen value to SI by their stated units, in this order.

    Parameters
    ----------
    result : dataclass
        With a field of :func:`make_units_field`; an array that is None has no unit.
    **dimensions
        Admissible dimensions of each array, by the name of its field.

    Returns
    -------
    mapping of str to str
        Dimension of the stated unit of each array; empty if all are in SI already.

    Raises
    ------
    DataError
        If no unit, too few or too many units are given, or a unit is unknown or has another
        dimension.
    """
    if result.units == SI:
        return {}
    options = {name: item for name, item in dimensions.items() if getattr(result, name) is not None}
    units = {
        name: _unit(result, name, word, option)
        for (name, option), word in zip(
            options.items(), get_unit_words(result, options), strict=True
        )
    }
    for name, unit in units.items():
        convert_field_to_si(result, name, unit)
    object.__setattr__(result, "units", SI)
    return {name: unit.dimension for name, unit in units.items()}


def get_unit_words(result: Any, options: Mapping[str, Dimensions], example: str = "") -> list[str]:
    """Return the words of the units, one for each array."""
    kind, names = _get_type_label(result), ", ".join(options)
    example = example or ", ".join(
        get_default_unit(_list_dimensions(option)[0]) for option in options.values()
    )
    if not result.units:
        raise DataError(
            f'{kind} has arrays without a unit. Add units="SI", or the unit '
            f'of each in this order ({names}): units="{example}"'
        )
    words = [word.strip() for word in str(result.units).split(",")]
    if len(words) != len(options):
        raise DataError(
            f'{kind}: units="{result.units}" names {len(words)} units for {len(options)} arrays '
            f'({names}). Name one for each, in this order: units="{example}"'
        )
    return words


def _get_type_label(result: Any) -> str:
    return "a batch" if isinstance(result, SimpleNamespace) else type(result).__name__


def _list_dimensions(value: Dimensions) -> tuple[Dimension, ...]:
    return (value,) if isinstance(value, str) else value


def _unit(result: Any, name: str, word: str, value: Dimensions) -> Unit:
    units = (find_unit(word, text) for text in _list_dimensions(value))
    unit = next((unit for unit in units if unit is not None), None)
    if unit is None:
        expected = " or ".join(_list_dimensions(value))
        example = " or ".join(dict.fromkeys(map(get_default_unit, _list_dimensions(value))))
        raise DataError(
            f"{_get_type_label(result)}: '{word}' is no unit of {expected}, the dimension of "
            f"{name}. Write for example {example}"
        )
    return unit


def convert_field_to_si(result: Any, name: str, unit: Unit) -> None:
    """Convert one array of a frozen value to SI."""
    values = np.asarray(getattr(result, name))
    object.__setattr__(result, name, from_unit(values, unit))


def resolve_unit(value: Any, given_units: Mapping[str, Dimension], *names: str) -> None:
    """Set the unit of a value of a part or of a material, by the stated units of its arrays.

    Raises
    ------
    DataError
        If the stated units of some arrays belong to a part, of others to a material.
    """
    if not given_units:
        return
    unit_words = {si_unit(given_units[name]).word for name in names if name in given_units}
    if len(unit_words) > 1:
        raise DataError(
            f"{type(value).__name__}: {' and '.join(names)} are in units of "
            f"{' and '.join(unit_words)}. Give both as a modulus, or both as a stiffness"
        )
    object.__setattr__(value, "unit", unit_words.pop())
