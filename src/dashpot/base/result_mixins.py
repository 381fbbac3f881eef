"""Mixins of result classes: text, table, figure, saving; what they call is imported when called.

This is the one module that names packages of a higher layer, as text and not by an import, so that
a result loads nothing before it is needed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from dashpot.base.reported_values import ReportedValue
    from dashpot.plot.picture import Picture

Series: TypeAlias = Mapping[str, tuple[Any, str]]
"""Columns of one length, each with its SI unit ("" if it has none)."""

MAX_LINES = 15
"""Most lines of a result in a Python shell."""


def load_function(module: str, name: str) -> Callable[..., Any]:
    """Return a function of a higher layer: ``load_function("report.result_output", "picture")``."""
    function: Callable[..., Any] = getattr(import_module(f"dashpot.{module}"), name)
    return function


def collect_arrays(result: object, **units: str) -> Series:
    """Return the named arrays of a result, each with its SI unit."""
    return {name: (getattr(result, name), unit) for name, unit in units.items()}


def collect_columns(rows: Iterable[object], **units: str) -> Series:
    """Return attributes of several objects by their names, each with its SI unit."""
    group = tuple(rows)
    return {name: ([getattr(item, name) for item in group], unit) for name, unit in units.items()}


class Printable:
    """Mixin of results that print like their command, and save themselves to a file."""

    @property
    def _saved_result(self) -> Any:
        """Part of the result saved in a file for other commands: itself, or its fit."""
        return self

    def __str__(self) -> str:
        text: str = load_function("text_output", "format_result")(self)
        return text

    def save(self, path: str | Path, *, overwrite: bool = False) -> Path:
        """Write it: ``.json``, ``.csv``, ``.html``, or its picture as ``.png``, ``.svg``, ``.pdf``.

        Raises
        ------
        ExportError
            If it is not written so, or the file exists and is not dashpot's; `overwrite` replaces
            that.
        """
        return Path(load_function("report.result_output", "save")(self, path, overwrite=overwrite))


class HasSummary(Printable):
    """Result with a summary of a few lines and a table of its numbers.

    The dataclass that inherits it is declared ``repr=False`` and has `_summary_lines`.
    """

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary that a Python shell prints, line by line."""
        raise NotImplementedError

    @property
    def _table_columns(self) -> Series:
        """Numbers as columns, the first of them their index.

        Missing numbers are None. The mapping is empty where the reported values are the table.
        """
        return {}

    def __repr__(self) -> str:
        lines = "\n".join(self._summary_lines).split("\n")
        shown_lines = [*lines[: MAX_LINES - 1], "..."] if len(lines) > MAX_LINES else lines
        return "\n".join((f"{type(self).__name__}: {shown_lines[0]}", *shown_lines[1:]))

    def to_pandas(self) -> pd.DataFrame:
        """Return the numbers as a :class:`pandas.DataFrame`; units are in its ``attrs``.

        Raises
        ------
        DataError
            If pandas is not installed (``pip install "dashpot[frames]"``).
        """
        frame: pd.DataFrame = load_function("workflow.dataframes", "to_pandas")(self)
        return frame

    def to_xarray(self) -> xr.Dataset:
        """Return the numbers as an :class:`xarray.Dataset`; each variable carries its unit.

        Raises
        ------
        DataError
            If xarray is not installed (``pip install "dashpot[frames]"``).
        """
        dataset: xr.Dataset = load_function("workflow.dataframes", "to_xarray")(self)
        return dataset


class Plottable(HasSummary):
    """Mixin of results with a figure, which a notebook displays."""

    def plot(self) -> Picture:
        """Return the :class:`~dashpot.plot.picture.Picture` for :func:`dashpot.plot.save`."""
        picture: Picture = load_function("report.result_output", "picture")(self)
        return picture

    def _repr_html_(self) -> str:
        """Return its picture and its text, for a notebook."""
        page: str = load_function("report.result_output", "html")(self)
        return page


class HasVerdict(Plottable):
    """Mixin of results with a verdict, which a Python shell displays."""

    verdict: Any

    @property
    def facts(self) -> tuple[ReportedValue, ...]:
        """Reported values, each with its unit and interval."""
        return ()

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """The verdict."""
        return (str(self.verdict),)
