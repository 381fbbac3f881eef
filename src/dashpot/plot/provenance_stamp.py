"""What every figure says of its origin: file, specimen, lot, date, mass, and SIMULATED."""

from __future__ import annotations

from collections.abc import Iterable

from dashpot.base import number_format
from dashpot.base.number_format import format_with_error
from dashpot.base.provenance import Source, sources_of
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.frf import FRF
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.datamodel.specimen import Specimen

# that many file names are told apart; of more, the number
NAMED = 3


def stamp(
    sources: Iterable[Source] = (),
    specimen: Specimen | None = None,
    *,
    mass: float | None = None,
    seals: float | None = None,
) -> str:
    """One line that stands on a figure wherever it goes.

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
    named = ", ".join(files) if len(files) <= NAMED else f"{files[0]} and {len(files) - 1} more"
    sentences = ["SIMULATED"] * (simulated or _is_simulated(specimen)) + [named]
    if specimen is not None:
        sentences += [specimen.name, f"lot {specimen.lot}" * bool(specimen.lot), specimen.date]
    if mass is not None:
        on = "" if seals is None else f" on {number_format.seals(seals)}"
        sentences.append(f"{format_with_error(mass, 'g', digits=4)}{on}")
    return "  ·  ".join(part for part in sentences if part)


def _is_simulated(specimen: Specimen | None) -> bool:
    """A record in memory says so in its notes."""
    return specimen is not None and "simulated" in specimen.notes.lower()


def format_test_stamp(test: RampHold | RelaxationTest) -> str:
    """Of one test of a specimen."""
    return stamp(sources_of([test]), test.specimen)


def format_fit_stamp(fit: Fit) -> str:
    """Of a fit."""
    return stamp(fit.source, fit.specimen)


def format_frf_stamp(frf: FRF) -> str:
    """Of a measured FRF."""
    return stamp(frf.source)
