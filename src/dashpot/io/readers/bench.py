"""From a file to the test of a bench, whichever it is: ramp and hold, creep, dynamic sweep."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from dashpot.base.errors import ReadError
from dashpot.io.columns import vocabulary
from dashpot.io.columns.kinds import SWEEPS, kind_of
from dashpot.io.options import ReadOptions
from dashpot.io.readers import channels
from dashpot.io.readers.channels import Opened
from dashpot.io.readers.relaxation import relaxation_in, roles
from dashpot.records.relaxation import RelaxationTest
from dashpot.records.specimen import Specimen

if TYPE_CHECKING:
    from dashpot.records.creep import CreepCompliance, CreepTest
    from dashpot.records.dynamic import DynamicTest


def read_bench(
    path: str | Path, *, options: ReadOptions | None = None, specimen: Specimen | None = None
) -> RelaxationTest | DynamicTest | CreepTest | CreepCompliance:
    """Return the relaxation test, the dynamic (DMA) test or the creep in a file, in SI units.

    A table of frequency, storage and loss is a dynamic test, unless it holds the columns of a
    relaxation test too. One that holds a creep compliance, or whose header says creep, is a creep
    test; whether it is the force that was held, only preparation finds out.

    Raises
    ------
    ReadError
        If the file is neither, or leaves open which column is what or in which unit.
    """
    with channels.opened(path, options) as file:
        if _is_sweep(file):
            from dashpot.io.readers.dynamic import dynamic_in

            return dynamic_in(file, specimen or Specimen())
        if _is_creep(file):
            from dashpot.io.readers.creep import creep_in

            return creep_in(file, specimen or Specimen())
        return relaxation_in(file, specimen or Specimen())


def _is_creep(file: Opened) -> bool:
    options = file.options
    if options.creep_compliance or options.stress or options.strain:
        return True
    named = options.displacement or options.force
    return not named and kind_of(file.table, options)[0] == "creep"


def _is_sweep(file: Opened) -> bool:
    if kind_of(file.table, file.options)[0] not in SWEEPS:
        return False
    try:
        found = channels.choose(file, roles(file))
    except ReadError:
        return True
    # the amplitude of a displacement and that of a force are no record
    names = [file.table.columns[one.index].name for one in found if one.role != "time"]
    return all(vocabulary.has_word(name, vocabulary.EXTREMES) for name in names)
