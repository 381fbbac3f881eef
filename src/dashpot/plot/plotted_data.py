"""Data for figures: thinning, axis limits, display units, and a stamp of origin."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

import numpy as np

from dashpot.base import number_format
from dashpot.base.arrays import FloatArray, IndexArray
from dashpot.base.number_format import format_with_error
from dashpot.base.provenance import Source, list_sources
from dashpot.base.units import convert_to_unit, get_display_unit
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.datamodel.specimen import Specimen
from dashpot.plot.picture import FIT, PREDICTED, Line

# Thinning that keeps the visible noise.


def downsample_to_extremes(
    x: FloatArray, y: FloatArray, *, bins: int = 500, log: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and the highest sample of every bin of x, in the order they were recorded.

    A line through them covers the same paper as a line through every sample, once a bin is
    narrower than the line is wide. Bins are even in x, or in ln x (then only x > 0 is kept).
    Returns the samples untouched where there are few.
    """
    x, y = _positive(x, y) if log else (x, y)
    if len(x) <= 2 * bins:
        return x, y
    label, starts = _assign_bins(x, bins, log)
    low = _first_equal(y, np.minimum.reduceat(y, starts), label)
    high = _first_equal(y, np.maximum.reduceat(y, starts), label)
    kept_indices = np.union1d(low, high)
    return x[kept_indices], y[kept_indices]


def downsample_to_means(
    x: FloatArray, y: FloatArray, *, bins: int = 120, log: bool = False
) -> tuple[FloatArray, FloatArray]:
    """Return the mean of x and of y over every bin that holds a sample."""
    x, y = _positive(x, y) if log else (x, y)
    if len(x) == 0:
        return x, y
    _, starts = _assign_bins(x, bins, log)
    count = np.diff(np.append(starts, len(x)))
    return np.add.reduceat(x, starts) / count, np.add.reduceat(y, starts) / count


def _positive(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    first = int(np.searchsorted(x, 0.0, side="right"))
    return x[first:], y[first:]


def _assign_bins(x: FloatArray, bins: int, log: bool) -> tuple[IndexArray, IndexArray]:
    """Number the bin of every sample 0, 1, 2..., empty bins omitted; where each bin starts."""
    scale = np.log(x) if log else x
    span = scale[-1] - scale[0] or 1.0
    raw = np.minimum((scale - scale[0]) / span * bins, bins - 1).astype(np.intp)
    is_new_bin = np.concatenate(([True], np.diff(raw) > 0))
    return np.cumsum(is_new_bin) - 1, np.flatnonzero(is_new_bin)


def _first_equal(y: FloatArray, extremes: FloatArray, label: IndexArray) -> IndexArray:
    hits = np.flatnonzero(y == extremes[label])
    _, first = np.unique(label[hits], return_index=True)
    return hits[first]


# Stamp of origin: file, specimen, lot, date, mass, and SIMULATED.


# Largest number of file names that are listed.
MAX_NAMED = 3


def stamp(
    sources: Iterable[Source] = (),
    specimen: Specimen | None = None,
    *,
    mass: float | None = None,
    seals: float | None = None,
) -> str:
    """Line of text with the origin of the data, part of every figure.

    Parameters
    ----------
    sources : iterable of Source
    specimen : Specimen, optional
    mass : float, optional
        kg.
    seals : float, optional
        That carry it.
    """
    files = list(dict.fromkeys(source.file for source in sources))
    simulated = any(source.simulated for source in sources)
    names = ", ".join(files) if len(files) <= MAX_NAMED else f"{files[0]} and {len(files) - 1} more"
    sentences = ["SIMULATED"] * (simulated or _is_simulated(specimen)) + [names]
    if specimen is not None:
        sentences += [specimen.name, f"lot {specimen.lot}" * bool(specimen.lot), specimen.date]
    if mass is not None:
        seals_text = "" if seals is None else f" on {number_format.seals(seals)}"
        sentences.append(f"{format_with_error(mass, 'g', digits=4)}{seals_text}")
    return "  ·  ".join(part for part in sentences if part)


def _is_simulated(specimen: Specimen | None) -> bool:
    """Return whether the notes of a specimen mark its record, in memory, as simulated."""
    return specimen is not None and "simulated" in specimen.notes.lower()


def format_test_stamp(test: RampHold | RelaxationTest) -> str:
    """Return the stamp of one test of a specimen."""
    return stamp(list_sources([test]), test.specimen)


def format_fit_stamp(fit: Fit) -> str:
    """Return the stamp of a fit."""
    return stamp(fit.source, fit.specimen)


def format_frf_stamp(frf: FRF) -> str:
    """Return the stamp of a measured FRF."""
    return stamp(frf.source)


def select_plot_unit(values: FloatArray, unit: Literal["N", "m"]) -> tuple[str, float]:
    """Return the word and the factor in which values, SI, read best: N, mN..., mm, µm...

    A seal stays in N and mm; the cantilever of a microscope is in nN and nm.
    """
    size = float(np.max(np.abs(values), initial=0.0))
    choices = {
        "N": ("N", "mN", "µN", "nN", "pN"),
        "m": ("mm", "µm", "nm"),
    }[unit]
    suitable_units = (word for word in choices if convert_to_unit(size, word) >= 0.1)
    word = next(suitable_units, choices[0] if size == 0 else choices[-1])
    return word, convert_to_unit(1.0, word)


def read_as(unit: str) -> tuple[str, float]:
    """Return the customary unit of an SI unit, and its factor."""
    word = get_display_unit(unit)
    return word, convert_to_unit(1.0, word)


def compute_padded_limits(*arrays: FloatArray, margin: float = 0.06) -> tuple[float, float]:
    """Return limits that contain every finite value with a margin; 0 and 1 if there is none."""
    values = np.concatenate([np.asarray(a, dtype=float).ravel() for a in arrays])
    values = values[np.isfinite(values)]
    low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
    pad = margin * ((high - low) or abs(high) or 1.0)
    return low - pad, high + pad


def compute_padded_log_limits(*arrays: FloatArray, margin: float = 1.25) -> tuple[float, float]:
    """Return limits of a logarithmic axis that include every positive value."""
    positive_values = np.concatenate([np.asarray(a).ravel() for a in arrays])
    positive_values = positive_values[np.isfinite(positive_values) & (positive_values > 0)]
    return float(positive_values.min()) / margin, float(positive_values.max()) * margin


def split_at_band(
    values: tuple[float, float], x: FloatArray, y: FloatArray, label: str, *, text: str
) -> tuple[Line, Line]:
    """Return a curve, solid inside the `values` band and dashed outside it."""
    in_band = (x >= values[0]) & (x <= values[1])
    # the dashes reach the solid part: less its first and last line
    is_inner = in_band & np.roll(in_band, 1) & np.roll(in_band, -1)
    return (
        Line(x, np.where(is_inner, np.nan, y), PREDICTED, text),
        Line(x, np.where(in_band, y, np.nan), FIT, label),
    )


# Stiffness from an FRF with its errors.


FREQUENCY = "frequency, Hz"
