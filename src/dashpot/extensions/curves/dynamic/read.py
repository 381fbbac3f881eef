"""Reader of dynamic (DMA) tests."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from dashpot.base.errors import DataError
from dashpot.datamodel.frf import FRF, Kind
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.reading.columns.kind_detection import detect_table_kind
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import OpenedFile
from dashpot.reading.readers.header_metadata import (
    add_specimen_temperature,
    temperatures_of_segments,
)
from dashpot.reading.readers.sweep_columns import (
    SWEEP_OPTIONS,
    load_parts,
    refuse_unlike_blocks,
    sweep_columns,
)


def read_dynamic(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> DynamicTest:
    """Return the dynamic (DMA) test in a file, in SI units.

    Storage and loss are moduli or stiffnesses; where there is no loss, it is storage times the
    loss factor (tan delta). Rows that lack a number are omitted with a note.

    Raises
    ------
    ReadError
        If frequency, storage or loss is not found, or has no unit.
    """
    with channels.open_file(path, options) as file:
        return read_dynamic_in(file, specimen or Specimen())


def read_dynamic_in(file: OpenedFile, specimen: Specimen) -> DynamicTest:
    """Return the dynamic test in an opened file."""
    # who names the columns says what they are, not what was swept
    by_numbers = detect_table_kind(file.table, file.options)[0] == "strain-sweep"
    sweep_options = () if by_numbers else SWEEP_OPTIONS
    channels.refuse_other_kinds(
        file, ["dma", "master-curve"], "a sweep of frequency is", stated_columns=sweep_options
    )
    signal_roles, ratio = sweep_columns(file)
    channels_chosen = channels.add_units(file, signal_roles)
    loaded_columns, values, unit, notes = load_parts(file, channels_chosen, ratio)
    if "temperature" not in values:
        temperature = temperatures_of_segments(file, loaded_columns)
        if temperature is not None:
            values["temperature"] = temperature[np.isfinite(loaded_columns.values).all(axis=1)]
            notes.append(
                f"{len(set(temperature.tolist()))} temperatures, from the lines over each block"
            )
    if "temperature" not in values:
        refuse_unlike_blocks(loaded_columns, values)
        specimen, sentences = add_specimen_temperature(file, specimen)
        notes += sentences
    return DynamicTest(
        values["frequency"],
        values["storage"],
        values["loss"],
        values.get("temperature"),
        unit,
        specimen,
        channels.make_source(file, [c.message for c in channels_chosen], notes),
        units="SI",
    )


def convert_to_frf(sweep: DynamicTest) -> FRF:
    """Return a sweep of a part, N/m, at one temperature as an FRF of force over displacement.

    Raises
    ------
    DataError
        If it is of a material, of several temperatures, or measures a frequency twice.
    """
    if sweep.unit != "N/m":
        raise DataError(
            f"the sweep is of a material, in {sweep.unit}; expected the stiffness of a mount, N/m"
        )
    if sweep.several_temperatures:
        raise DataError("the sweeps are of several temperatures: choose one, or fit them")
    order = np.argsort(sweep.frequency, kind="stable")
    frequency = sweep.frequency[order]
    if (np.diff(frequency) <= 0).any():
        repeated_frequency = float(frequency[np.flatnonzero(np.diff(frequency) <= 0)[0]])
        raise DataError(
            f"the sweep has {repeated_frequency:g} Hz twice; expected each frequency once"
        )
    source = () if sweep.source is None else (sweep.source,)
    return FRF(frequency, sweep.value[order], Kind.DYNAMIC_STIFFNESS, source=source, units="SI")
