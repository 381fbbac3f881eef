"""Columns of a plug-in's kind of test, and its result."""

from __future__ import annotations

from dashpot.base import dataclass
from dashpot.base.arrays import EqualByValue, FloatArray
from dashpot.base.checks import Check
from dashpot.base.provenance import Source, describe_record_source
from dashpot.base.reported_values import HasReportedValues, ReportedValue
from dashpot.base.result_mixins import HasSummary, HasVerdict, Series
from dashpot.base.serialisation import EVERY_FIELD, Key, Serialisable


@dataclass(frozen=True, eq=False)
class PluggedColumn(EqualByValue):
    """Column of a file.

    Attributes
    ----------
    name, role : str
        Name in the file; role such as ``"force"``, empty if not known.
    unit : str
        Unit of SI; empty if the file names none known to dashpot.
    values : array, shape (n,)
    """

    name: str
    role: str
    unit: str
    values: FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class PluggedTest(EqualByValue, HasSummary):
    """Columns of a file, for a kind of test that a plug-in fits.

    Attributes
    ----------
    kind : str
        The name of the plug-in.
    columns : tuple of PluggedColumn
    source : Source or None
    """

    kind: str
    columns: tuple[PluggedColumn, ...]
    source: Source | None = None

    @property
    def _table_columns(self) -> Series:
        """Columns by their names."""
        return {column.role or column.name: (column.values, column.unit) for column in self.columns}

    @property
    def _summary_lines(self) -> tuple[str, ...]:
        """Summary: the file and its columns."""
        columns_text = ", ".join(
            f"{column.role or column.name} [{column.unit or '?'}]" for column in self.columns
        )
        return describe_record_source(
            self.source, len(self.columns[0].values)
        ), f"for '{self.kind}': {columns_text}"


@dataclass(frozen=True, eq=False, repr=False)
class PluginFit(EqualByValue, HasReportedValues, HasVerdict, Serialisable):
    """Result of a plug-in: its numbers and checks, under its own name.

    Attributes
    ----------
    kind, package : str
        The name of the plug-in; its package and version.
    reported_values : tuple of ReportedValue
    checks : tuple of Check
    notes : tuple of str
    sources : tuple of Source
    """

    schema = "dashpot/plugged@2"
    _keys = ("verdict", EVERY_FIELD, Key("values", "reported_values"))

    kind: str
    package: str
    reported_values: tuple[ReportedValue, ...]
    checks: tuple[Check, ...] = ()
    notes: tuple[str, ...] = ()
    sources: tuple[Source, ...] = ()

    @property
    def source(self) -> Source | None:
        """The first file behind it."""
        return next(iter(self.sources), None)

    @property
    def _headline(self) -> str:
        """First number of the result, and its plug-in."""
        first_value = self.reported_values[0].text
        return f"{first_value}, by '{self.kind}' of {self.package}, not verified by dashpot"
