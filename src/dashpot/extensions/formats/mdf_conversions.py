"""Conversions of ASAM MDF, from raw to physical numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError

Conversion: TypeAlias = Callable[[FloatArray], FloatArray]


class NoNumbersError(Exception):
    """Reason why a channel is passed over: it holds no numbers, or only unknown ones."""


def keep_raw(raw: FloatArray) -> FloatArray:
    """Return the numbers as they are stored."""
    return raw


def linear(parameters: Sequence[float]) -> Conversion:
    """Return the conversion offset + factor * raw of two parameters.

    >>> linear([1.0, 0.5])(np.array([4.0])).tolist()
    [3.0]
    """
    offset, factor = _require_count(parameters, 2)
    return lambda raw: offset + factor * raw


def rational(parameters: Sequence[float]) -> Conversion:
    """Return the ratio of two parabolas of the raw number.

    >>> rational([0, 2, 1, 0, 0, 4])(np.array([3.5])).tolist()
    [2.0]
    """
    a, b, c, d, e, f = _require_count(parameters, 6)

    def convert(raw: FloatArray) -> FloatArray:
        denominator = (d * raw + e) * raw + f
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(denominator == 0, np.nan, ((a * raw + b) * raw + c) / denominator)

    return convert


def interpolated_table(pairs: Sequence[float]) -> Conversion:
    """Return the table of keys and values, straight between keys, held beyond its ends."""
    keys, values = _sort_table(pairs)
    return lambda raw: np.where(np.isnan(raw), np.nan, np.interp(raw, keys, values))


def nearest_table(pairs: Sequence[float]) -> Conversion:
    """Return the table that takes the value of the nearest key, the lower one half way.

    >>> nearest_table([0, 10, 1, 20])(np.array([0.5, 0.6])).tolist()
    [10.0, 20.0]
    """
    keys, values = _sort_table(pairs)

    def convert(raw: FloatArray) -> FloatArray:
        upper_index = np.clip(np.searchsorted(keys, raw), 1, len(keys) - 1) if len(keys) > 1 else 0
        lower_index = np.maximum(upper_index - 1, 0)
        nearest_index = np.where(
            raw - keys[lower_index] > keys[upper_index] - raw, upper_index, lower_index
        )
        return np.where(np.isnan(raw), np.nan, values[nearest_index])

    return convert


def exact_table(pairs: Sequence[float]) -> Conversion:
    """Return the table of which only the keys are defined.

    Readers of MDF 3 differ in the value between two keys: nearest, or next above.
    """
    keys, values = _sort_table(pairs)

    def convert(raw: FloatArray) -> FloatArray:
        key_index = np.clip(np.searchsorted(keys, raw), 0, len(keys) - 1)
        if not np.array_equal(keys[key_index], raw):
            raise ReadError(
                "a table of MDF 3 without interpolation is asked between its keys, which programs "
                "answer in two ways; export the channel as physical numbers, as MDF 4 or HDF5"
            )
        return values[key_index]

    return convert


def ranges(parameters: Sequence[float], *, is_integer: bool) -> Conversion:
    """Return the value of the range in which a number lies; the last parameter of any other.

    The end of a range belongs to it where the numbers are whole.
    """
    if len(parameters) % 3 != 1:
        raise ReadError("damaged: a conversion of ranges has a parameter too many or too few")
    rows = np.reshape(np.asarray(parameters[:-1], dtype=float), (-1, 3))

    def convert(raw: FloatArray) -> FloatArray:
        result = np.full(raw.shape, float(parameters[-1]))
        for low, high, value in rows[::-1]:
            result[(raw >= low) & ((raw <= high) if is_integer else (raw < high))] = value
        result[np.isnan(raw)] = np.nan
        return result

    return convert


def some_text(
    spans: Sequence[tuple[float, float]],
    state_conversions: Sequence[Conversion | None],
    default: Conversion | None,
    *,
    is_integer: bool,
) -> Conversion:
    """Return the conversion of numbers other than named states: a named state is no number."""
    if default is None and not any(state_conversions):
        raise NoNumbersError("names of states")

    def convert(raw: FloatArray) -> FloatArray:
        result = np.full(raw.shape, np.nan) if default is None else default(raw)
        result = np.array(result, dtype=float)
        for (low, high), conversion in zip(
            reversed(spans), reversed(state_conversions), strict=True
        ):
            in_range = (raw >= low) & ((raw <= high) if is_integer or low == high else (raw < high))
            result[in_range] = np.nan if conversion is None else conversion(raw[in_range])
        return result

    return convert


def mdf3_polynomial(parameters: Sequence[float]) -> Conversion:
    """Return the polynomial of MDF 3, which is a ratio of two straight lines."""
    a, b, c, d, e, f = _require_count(parameters, 6)

    def convert(raw: FloatArray) -> FloatArray:
        x = raw - e - f
        denominator = c * x - a
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(denominator == 0, np.nan, (b - d * x) / denominator)

    return convert


def mdf3_exponential(parameters: Sequence[float], *, logarithm: bool) -> Conversion:
    """Return the conversion by logarithm (of an exponential raw number) or by exponential.

    Raises
    ------
    ReadError
        If none of its two forms is meant by the parameters.
    """
    a, b, c, d, e, f, g = _require_count(parameters, 7)
    function = np.log if logarithm else np.exp
    if (d == 0) == (a == 0):
        raise ReadError("damaged: a logarithmic conversion has no form that MDF 3 defines")

    def convert(raw: FloatArray) -> FloatArray:
        with np.errstate(all="ignore"):
            result = (
                function(((raw - g) * f - c) / a) / b
                if d == 0
                else function((c / (raw - g) - f) / d) / e
            )
        return np.where(np.isfinite(result), result, np.nan)

    return convert


def _require_count(parameters: Sequence[float], count: int) -> tuple[float, ...]:
    if len(parameters) < count or not np.isfinite(parameters[:count]).all():
        raise ReadError(f"damaged: a conversion of {count} parameters has others")
    return tuple(float(parameter) for parameter in parameters[:count])


def _sort_table(pairs: Sequence[float]) -> tuple[FloatArray, FloatArray]:
    if len(pairs) < 2 or len(pairs) % 2:
        raise ReadError("damaged: a conversion table has keys without values")
    keys, values = np.reshape(np.asarray(pairs, dtype=float), (-1, 2)).T
    if not (np.diff(keys) > 0).all():
        raise ReadError("damaged: the keys of a conversion table do not rise")
    return keys, values
