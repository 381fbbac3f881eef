"""Columns of a lot's table."""

from __future__ import annotations

from typing import Any, TypeAlias

from dashpot.base.units import column, convert_to_unit
from dashpot.base.version import __version__
from dashpot.extensions.batch.batch_options import BatchOptions
from dashpot.extensions.batch.input_files import LABELS, Entry
from dashpot.registry import KINDS

FrequencyAndCompression: TypeAlias = tuple[float | None, float | None]
"""A frequency and a compression."""
TEXT_COLUMNS = (
    "file", "part", "sha256", "hammer", *LABELS, "kind", "outcome", "verdict", "agreement",
    "reason", "failed_checks", "status", "method", "version", "origin",
)  # fmt: skip
"""The columns of words; `outcome` is ``fitted``, ``refused``, ``other``, ``ignored``, or one of
`RETRIED_OUTCOMES`.

`part` is which of several specimens in its file a row is of, as ``--file-part`` takes it. `origin`
is ``simulated`` if a file of the row is marked so.
"""
LEADING_COLUMNS = ("file", *LABELS, "kind", "outcome", "verdict", "reason")
"""The columns with which a written table begins."""
TRAILING_COLUMNS = (
    "failed_checks", "status", "method", "arms", "samples", "bytes", "origin", "version", "hammer",
    "sha256", "key",
)  # fmt: skip
"""Last columns of a written table: metadata of the file."""
REQUIRED_COLUMNS = ("file", "kind", "outcome", "verdict", "reason")
"""The columns that are written even if empty."""
RETRIED_OUTCOMES = ("died", "changed")
"""Outcomes that may change in another run: such a file is tried again."""
COUNT_COLUMNS = ("bytes", "samples", "arms")
_STIFFNESS_SUFFIXES = ("0", "end", "end_low", "end_high", "inf", "inf_se", "inf_low", "inf_high")


def format_stiffness_column(suffix: str, unit: str) -> str:
    """Return the column of a stiffness: k of a part (`unit` N/m), E of a material (Pa)."""
    return column(f"{'k' if unit == 'N/m' else 'E'}_{suffix}", unit)


NUMBER_COLUMNS = (
    "temperature_K", "hammer_temperature_K", "mass_kg", "depth_m", "ramp_s", "hold_s",
    "force_noise_N",
    *(format_stiffness_column(suffix, "N/m") for suffix in _STIFFNESS_SUFFIXES), "rms_N",
    "band_low_Hz",
    "band_high_Hz", "frequency_Hz", "damping_ratio",
    "predicted_Hz", "predicted_damping_ratio", "measured_Hz", "measured_se_Hz",
    "measured_damping_ratio", "measured_damping_ratio_se", "peak_dB", "frac",
    *(name for kind in KINDS.values() for name in kind.columns),
    *(format_stiffness_column(suffix, "Pa") for suffix in _STIFFNESS_SUFFIXES),
)  # fmt: skip


def list_arm_columns(arms: int) -> tuple[str, ...]:
    """Return the columns of the arms, and of their standard errors."""
    return tuple(
        name
        for j in range(1, arms + 1)
        for name in (
            format_stiffness_column(f"{j}", "N/m"),
            format_stiffness_column(f"{j}_se", "N/m"),
            column(f"tau_{j}", "s"),
            column(f"tau_{j}_se", "s"),
            format_stiffness_column(f"{j}", "Pa"),
            format_stiffness_column(f"{j}_se", "Pa"),
        )
    )


def build_requested_columns(
    choices: BatchOptions, unit: str
) -> dict[FrequencyAndCompression, tuple[str, ...]]:
    """Return the columns of each frequency, Hz, and compression, m, that was requested.

    Without a frequency, the column of the stiffness at the end of the hold; without a compression,
    those at the depth of the test. A material (`unit` Pa) has no compression.
    """
    compressions = choices.compression if unit == "N/m" else ()
    entries: dict[FrequencyAndCompression, tuple[str, ...]] = {
        (None, value): (
            format_stiffness_column(f"end_at_{convert_to_unit(value, 'mm'):g}mm", unit),
        )
        for value in compressions
    }
    for frequency in choices.at:
        for compression in compressions or (None,):
            compression_suffix = (
                "" if compression is None else f"_{convert_to_unit(compression, 'mm'):g}mm"
            )
            column_suffix = f"at_{frequency:g}Hz{compression_suffix}"
            entries[frequency, compression] = (
                column(f"storage_{column_suffix}", unit), column(f"loss_{column_suffix}", unit),
                f"loss_factor_{column_suffix}",
            )  # fmt: skip
    return entries


def list_chosen_columns(choices: BatchOptions) -> tuple[str, ...]:
    """Return the columns that depend on the choices, all of numbers."""
    columns_by_unit = (build_requested_columns(choices, unit).values() for unit in ("N/m", "Pa"))
    names = (name for groups in columns_by_unit for group in groups for name in group)
    return (*list_arm_columns(choices.columns), *dict.fromkeys(names))


def list_number_columns(choices: BatchOptions) -> tuple[str, ...]:
    """Return every column of numbers but the counts."""
    return (*NUMBER_COLUMNS, *list_chosen_columns(choices))


def make_empty_row(entry: Entry, sha256: str, choices: BatchOptions) -> dict[str, Any]:
    """Return the empty row of a file."""
    numbers = dict.fromkeys((*COUNT_COLUMNS, *list_number_columns(choices)))
    entries = {name: getattr(entry, name) for name in ("file", *LABELS)}
    return (
        dict.fromkeys(TEXT_COLUMNS, "")
        | numbers
        | entries
        | {
            "sha256": sha256,
            "hammer": "; ".join(entry.hammer),
            "temperature_K": entry.temperature,
            "hammer_temperature_K": entry.hammer_temperature,
            "mass_kg": entry.mass,
            "version": __version__,
        }
    )
