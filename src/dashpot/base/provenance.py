"""Provenance of numbers: the file, its hash, and every processing step."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Protocol, Self

from dashpot.base import dataclass
from dashpot.base.serialisation import EVERY_FIELD, Key, Serialisable

SIMULATED = "simulated"
"""Word in a table for a file that simulation made."""


class Caution(str):
    """Note of a reader on data that may differ from the measured ones.

    `sentence` is the same without the options of a command line, as checks say it.

    >>> list_cautions(["200 rows", Caution("the header states a gain")])
    ('the header states a gain',)
    """

    sentence: str

    def __new__(cls, note: str, displayed_text: str = "") -> Self:
        """Return the note; by default both texts are the same."""
        caution = super().__new__(cls, note)
        caution.sentence = displayed_text or str(note)
        return caution


def list_cautions(notes: Iterable[str]) -> tuple[str, ...]:
    """Return the notes that can change a number, each once, as plain text."""
    return tuple(dict.fromkeys(note.sentence for note in notes if isinstance(note, Caution)))


@dataclass(frozen=True)
class Source(Serialisable):
    """File from which a record was read.

    Attributes
    ----------
    file : str
        File name without its folder.
    sha256 : str
        Hash of the raw bytes, hexadecimal.
    reader : str
        Name of the reader, such as ``"text"``.
    columns : tuple of str
        One line per column used: role, name found, unit found.
    notes : tuple of str
        Observations and changes of the reader, one sentence each.
    simulated : bool
        True if the file is marked as simulated.
    cautions : tuple of str
        Notes that can change a number; the checks of every result of the record repeat them.

    Examples
    --------
    >>> import dashpot as dp
    >>> dp.Source("seal.csv", "0" * 64).file
    'seal.csv'
    """

    _keys = (
        "file",
        "sha256",
        "reader",
        "columns",
        "notes",
        "simulated",
        Key("cautions", "cautions_or_none", optional=True),
    )

    file: str
    sha256: str
    reader: str = "text"
    columns: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    simulated: bool = False
    cautions: tuple[str, ...] = ()

    @property
    def cautions_or_none(self) -> tuple[str, ...] | None:
        """The cautions; None if there are none, so that a document leaves the key out."""
        return self.cautions or None


def describe_record_source(source: Source | None, samples: int) -> str:
    """Return which record it is, for people: its file, how many samples, and whether simulated."""
    if source is None:
        return f"{samples} samples in memory"
    return f"{source.file}{', SIMULATED' * source.simulated}, {samples} samples"


@dataclass(frozen=True)
class Step(Serialisable):
    """Processing step: its name, its parameters as text, and a sentence on its effect."""

    _keys = (EVERY_FIELD, "message")

    name: str
    parameters: tuple[tuple[str, str], ...] = ()
    message: str = ""


class Read(Protocol):
    """Interface of a record with a source file."""

    @property
    def source(self) -> Source | None:
        """The file; None of arrays in memory."""
        ...


class HasSteps(Protocol):
    """Interface of a record with processing steps."""

    @property
    def steps(self) -> tuple[Step, ...]:
        """All processing steps, in their order."""
        ...


def list_sources(records: Iterable[Read]) -> tuple[Source, ...]:
    """Return the files behind records."""
    return tuple(record.source for record in records if record.source is not None)


def list_steps(records: Iterable[HasSteps]) -> tuple[Step, ...]:
    """Return the processing steps of records, in order."""
    return tuple(step for record in records for step in record.steps)


def find_origins(sources: tuple[Source, ...]) -> set[str]:
    """Return the hashes of files, and of those from which, by their notes, they were made."""
    texts = (f"sha256 {source.sha256}; {'; '.join(source.notes)}" for source in sources)
    return set(re.findall(r"sha256\W+(\w{64})", "; ".join(texts)))
