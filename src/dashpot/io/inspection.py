"""What is in a file, as a value: shown by ``dashpot inspect`` before anything is trusted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from dashpot.io.table import Question

FileKind: TypeAlias = Literal["relaxation", "impact", "frf", "dma", "not-a-test", "unclear"]


@dataclass(frozen=True)
class InspectedColumn:
    """One column: what it is called, its unit, the role it would play and why.

    `first` holds the first few numbers as they stand, in the file's own unit; None
    where there is none.
    """

    number: int
    name: str
    unit: str | None
    role: str | None
    reason: str
    first: tuple[float | None, ...] = ()


@dataclass(frozen=True)
class Segment:
    """A run of rows: its name, number of rows, and first and last time, s, if known."""

    name: str
    rows: int
    start: float | None = None
    end: float | None = None


@dataclass(frozen=True)
class Inspection:
    """What a file holds and what it leaves open.

    Attributes
    ----------
    file, sha256, format, encoding, delimiter, decimal : str
    kind : str
        What the file seems to be, and `reason` why.
    header : tuple of str
        The lines above the table.
    columns : tuple of InspectedColumn
    rows : int
    rate : float or None
        Median sampling rate, Hz; None without a usable clock.
    even : bool
        Whether the sampling is even.
    duration : float or None
        s.
    segments : tuple of Segment
    warnings : tuple of str
    questions : tuple of Question
        What must be answered before the file can be read, and the option that answers it.
    simulated : bool
    """

    file: str
    sha256: str
    format: str
    kind: FileKind
    reason: str
    encoding: str = ""
    delimiter: str = ""
    decimal: str = ""
    header: tuple[str, ...] = ()
    columns: tuple[InspectedColumn, ...] = ()
    rows: int = 0
    rate: float | None = None
    even: bool = True
    duration: float | None = None
    segments: tuple[Segment, ...] = ()
    warnings: tuple[str, ...] = ()
    questions: tuple[Question, ...] = ()
    simulated: bool = False
