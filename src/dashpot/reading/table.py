"""Table of named columns as a file holds it, returned by every format reader."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Literal, TypeAlias

from dashpot.base import dataclass

if TYPE_CHECKING:  # a child that reads workbooks needs no numbers, and is there in half the time
    from dashpot.base.arrays import FloatArray

Content: TypeAlias = Literal["number", "clock", "text", "blank"]
SEGMENT = "--file-part segment=NUMBER"
"""Option that selects one of several FRFs in a file."""


@dataclass(frozen=True)
class Question:
    """Open question on a file.

    Attributes
    ----------
    message : str
    option : str
        The option for the answer.
    choices : int
        Columns that could be meant; 0 if none shows itself.
    role, example : str
        Missing role, and an example of the answer.
    answers : tuple of (str, str)
        For several specimens or repeats, the name of each, and its answer as it is typed.
    """

    message: str
    option: str
    choices: int = 0
    role: str = ""
    example: str = ""
    answers: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Column:
    """Column of a file: its name ("" if none) and its unit (None if none).

    `factor` is what the file states of it besides, such as "gain = 10": whether its numbers are
    multiplied by it already nobody can know.
    """

    name: str
    unit: str | None = None
    content: Content = "number"
    factor: str = ""

    def label(self, number: int) -> str:
        """Return how to name it to a user: its name, else its number counted from 1."""
        return self.name or str(number)


@dataclass(frozen=True, eq=False)
class LoadedColumns:
    """Numbers of the chosen columns.

    Attributes
    ----------
    values : array, shape (rows, columns)
        NaN where the cell is blank or says that it holds no number.
    starts : tuple of int
        First row of each segment.
    segments : tuple of str
        Name of each segment, "" if it has none.
    lines : tuple of (row, line)
        First row of each unbroken run and its line in the file; empty for binary files.
    notes : tuple of str
    questions : tuple of (segment, Question)
        Questions to answer before the numbers of a segment, counted from 0, can be trusted; None is
        every segment.
    above : tuple of tuple of str
        For a text file, the lines over each segment; none over the first, whose are the header.
    """

    values: FloatArray
    starts: tuple[int, ...] = (0,)
    segments: tuple[str, ...] = ("",)
    lines: tuple[tuple[int, int], ...] = ()
    notes: tuple[str, ...] = ()
    questions: tuple[tuple[int | None, Question], ...] = ()
    above: tuple[tuple[str, ...], ...] = ()

    def format_row_position(self, row: int) -> str:
        """Return where a row is: "line 12" of a text file, "row 3" of another."""
        return f"line {self.line(row)}" if self.lines else f"row {row + 1}"

    def line(self, row: int) -> int:
        """Return the line of a row in its text file, counted from 1."""
        first, line = self.lines[bisect_right(self.lines, row, key=lambda run: run[0]) - 1]
        return line + row - first


@dataclass(frozen=True, eq=False)
class FileTable:
    """Table found in a file; `load` reads the numbers of the requested columns, by index."""

    format: str
    columns: tuple[Column, ...]
    load: Callable[[Sequence[int]], LoadedColumns]
    encoding: str = ""
    delimiter: str = ""
    decimal: str = ""
    header: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    simulated: bool = False
    questions: tuple[Question, ...] = ()
    """Questions to answer before the numbers can be trusted."""
    hints: tuple[str, ...] = ()
    """Hints of the file at a sampling rate, if it has no time."""
    large: bool = False
    """Whether columns are read when they are asked for, as all of them may not fit in memory."""


def make_loader(
    values: FloatArray, starts: tuple[int, ...] = (0,), segments: tuple[str, ...] = ()
) -> Callable[[Sequence[int]], LoadedColumns]:
    """Return the `load` of a table that is already read."""
    names = segments or ("",) * len(starts)
    return lambda indexes: LoadedColumns(values[:, list(indexes)], starts, names)
