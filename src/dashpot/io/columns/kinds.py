"""What kind of record a table is: a test, a curve derived from one, or no test at all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias

from dashpot.io.columns import vocabulary
from dashpot.io.columns.roles import accelerations, score
from dashpot.io.columns.vocabulary import Role
from dashpot.io.options import ReadOptions
from dashpot.io.table import Table

FileKind: TypeAlias = Literal["relaxation", "impact", "frf", "dma", "not-a-test", "unclear"]

_SIGNALS = {"force", "displacement", "stress", "strain"}


@dataclass(frozen=True, eq=False)
class _NamedColumns:
    """What the names and units of a table's columns say."""

    table: Table
    options: ReadOptions

    def has(self, *roles: Role, least: float = 1.5) -> bool:
        """Whether each role is named by the user, or suits a column that well."""
        return all(
            getattr(self.options, role, None)
            or any(score(column, role, self.options) >= least for column in self.table.columns)
            for role in roles
        )

    def timed(self) -> bool:
        return self.has("time") or self.options.rate is not None

    def accelerated(self) -> bool:
        return bool(accelerations(self.table, (), self.options))

    def spectral(self) -> bool:
        return any(
            "spectral density" in c.name.casefold() or "psd" in vocabulary.tokens(c.name)
            for c in self.table.columns
        )


_RULES: tuple[tuple[FileKind, str, Callable[[_NamedColumns], bool]], ...] = (
    (
        "frf",
        "it has frequency, and a complex value",
        lambda s: (
            s.has("frequency", "real", "imaginary") or s.has("frequency", "magnitude", "phase")
        ),
    ),
    (
        "dma",
        "it has frequency, storage and loss",
        lambda s: s.has("storage", "frequency") and (s.has("loss") or s.has("loss_factor")),
    ),
    ("not-a-test", "it is a power spectral density, which has no phase", _NamedColumns.spectral),
    (
        "impact",
        "it has time and an acceleration",
        lambda s: s.timed() and s.accelerated() and not s.has("displacement", least=2.5),
    ),
    (
        "relaxation",
        "it has time, displacement and force",
        lambda s: s.timed() and s.has("force", "displacement", least=1.0),
    ),
    (
        "not-a-test",
        (
            "it is a relaxation modulus over time, a curve derived from a test, with no "
            "displacement and force; dashpot fit --modulus COLUMN fits the curve itself"
        ),
        lambda s: s.has("modulus") and s.timed(),
    ),
    (
        "not-a-test",
        "it is a flow curve of a rheometer (viscosity, shear rate)",
        lambda s: s.has("viscosity") or (s.has("shear_rate") and not s.timed()),
    ),
    (
        "not-a-test",
        (
            "it has stress and strain, not force and displacement; multiply by the area and the "
            "height of the specimen first"
        ),
        lambda s: s.has("stress", "strain") and s.timed(),
    ),
    ("unclear", "no set of columns that makes a test was recognised", lambda _: True),
)
"""The kinds, their reasons and what shows them; the first that holds is taken."""


def kind_of(table: Table, options: ReadOptions) -> tuple[FileKind, str]:
    """Return the kind of record and the reason, from the names and units alone."""
    peaks = cycle_peaks(table)
    if peaks:
        return "not-a-test", peaks
    named = _NamedColumns(table, options)
    return next((kind, reason) for kind, reason, holds in _RULES if holds(named))


def cycle_peaks(table: Table) -> str | None:
    """Return why a table is one row per cycle (trends, peaks), or None."""
    names = [column.name for column in table.columns]
    extremes = list(filter(_is_extreme, names))
    recorded = any(_is_recorded(name) for name in names if name not in extremes)
    counted = any("cycle" in vocabulary.matches(name) for name in names)
    if len(extremes) < 2 or (recorded and not counted):
        return None
    listed = ", ".join(f"'{name}'" for name in extremes[:3])
    return (
        f"it is a summary with one row per cycle ({listed}), not the recorded signals; "
        "export the raw time, displacement and force instead"
    )


def _is_extreme(name: str) -> bool:
    says_one = vocabulary.has_word(name, vocabulary.EXTREMES)
    return says_one and not _SIGNALS.isdisjoint(vocabulary.matches(name))


def _is_recorded(name: str) -> bool:
    derived = vocabulary.has_word(name, vocabulary.DERIVED)
    return not derived and vocabulary.matches(name).get("force", 0.0) >= 2.5
