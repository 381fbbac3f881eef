"""Detection of the kind of record by its columns: a test, a derived curve, or neither."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from itertools import chain
from types import MappingProxyType
from typing import Literal, NamedTuple, TypeAlias, cast

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, field, replace, units
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.base.units import Dimension
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.header_units import parse_response_unit
from dashpot.reading.columns.role_assignment import (
    accelerations,
    find_column,
    option_of,
    score,
    score_columns,
)
from dashpot.reading.columns.vocabulary import Role
from dashpot.reading.read_options import ReadOptions, flag
from dashpot.reading.table import FileTable
from dashpot.registry import find_handler

# Amplitude and phase of two signals, whose ratio is a response.


_PAIRED_MOTIONS: tuple[Dimension, ...] = ("acceleration", "length", "velocity")
_NAMED_SCORE = 1.5
_FEWEST_COLUMNS, _MOST_COLUMNS = 5, 64
"""Columns of a controller's table."""


class AmplitudePhaseColumns(NamedTuple):
    """Columns of a signal's amplitude and phase, and whether it is a force."""

    amplitude: int
    phase: int
    is_force: bool


def find_amplitude_phase_pairs(
    table: FileTable, options: ReadOptions
) -> tuple[AmplitudePhaseColumns, AmplitudePhaseColumns] | None:
    """Return the two signals of a table that holds two amplitudes with two phases over frequency.

    None of any other, and where a column is a response already.
    """
    phases, sizes, lines = [], [], 0
    if not _FEWEST_COLUMNS <= len(table.columns) <= _MOST_COLUMNS:
        return None
    for i, column in enumerate(table.columns):
        if column.content != "number":
            continue
        word = column.unit or ""
        if parse_response_unit(word) or any(
            score(column, r, options) >= _NAMED_SCORE for r in ("real", "storage")
        ):
            return None
        if score(column, "frequency", options) >= _NAMED_SCORE:
            lines += 1
        elif score(column, "phase", options) >= _NAMED_SCORE:
            phases.append(i)
        elif units.find_unit(word, "force") or any(
            units.find_unit(word, motion) for motion in _PAIRED_MOTIONS
        ):
            sizes.append(i)
    pushes = [bool(units.find_unit(table.columns[i].unit or "", "force")) for i in sizes]
    if not lines or len(sizes) != 2 or len(phases) != 2 or all(pushes):
        return None
    if _has_reversed_phases(table, sizes, phases):
        phases.reverse()
    first, second = (
        AmplitudePhaseColumns(*item) for item in zip(sizes, phases, pushes, strict=True)
    )
    return first, second


def _has_reversed_phases(table: FileTable, sizes: list[int], phases: list[int]) -> bool:
    """Return whether the names say that the first phase is that of the second amplitude."""
    words = {i: set(vocabulary.tokens(table.columns[i].name)) for i in (*sizes, *phases)}
    entries = {i: words[i] - words[j] for i, j in (sizes, sizes[::-1])}
    straight, across = (
        sum(len(entries[i] & words[p]) for i, p in zip(sizes, order, strict=True))
        for order in (phases, phases[::-1])
    )
    return across > straight


FileKind: TypeAlias = Literal[
    "relaxation", "impact", "frf", "transmissibility", "dma", "master-curve", "strain-sweep",
    "temperature-sweep", "one-frequency", "modulus", "creep", "indentation", "cld", "cyclic",
    "stress-strain", "csr", "drop", "seal-line", "free-modes", "plug-in", "blank", "preload-map",
    "not-a-test", "unclear",
]  # fmt: skip

SWEEPS: tuple[FileKind, ...] = (
    "dma", "master-curve", "strain-sweep", "temperature-sweep", "one-frequency",
)  # fmt: skip
"""The kinds of a table of storage and loss."""


class KindOfFile(NamedTuple):
    """Kind of file: its name, its purpose, and the roles of its columns.

    Attributes
    ----------
    what, use : str
        Its name, and which command wants it or why none does.
    roles : tuple of str
        Of its columns; what a creep test or a sweep has, its reader finds.
    accelerated : bool
        Whether every acceleration beside them is of it, too.
    by_hand : bool
        Whether its rows are read by hand, at no rate.
    """

    what: str
    use: str
    roles: tuple[Role, ...] = ()
    accelerated: bool = False
    by_hand: bool = False


RAMP: tuple[Role, ...] = ("time", "displacement", "force")
_RESPONSE: tuple[Role, ...] = ("frequency", "real", "imaginary", "magnitude", "phase", "coherence")
_SWEPT: tuple[Role, ...] = ("frequency", "storage", "loss", "temperature")
_NO_TIMES = "it tells no relaxation times; sweep the frequency"
RECOGNISED: Mapping[str, KindOfFile] = MappingProxyType({
    "relaxation": KindOfFile("a relaxation test", "use dashpot fit or dashpot report", RAMP),
    "impact": KindOfFile("a hammer file", "use dashpot fit", ("time", "hammer"), True),
    "frf": KindOfFile("an FRF", "use dashpot fit or dashpot compare", _RESPONSE),
    "transmissibility": KindOfFile(
        "a transmissibility", "use dashpot fit, with the mass for the model, or compare", _RESPONSE
    ),
    "dma": KindOfFile("a dynamic (DMA) sweep", "use dashpot fit", _SWEPT),
    "master-curve": KindOfFile("a master curve of storage and loss", "use dashpot fit", _SWEPT),
    "strain-sweep": KindOfFile(
        "an amplitude sweep at one frequency or a few", "use dashpot fit", _SWEPT
    ),
    "temperature-sweep": KindOfFile("a temperature sweep at one frequency", _NO_TIMES, _SWEPT),
    "one-frequency": KindOfFile("a dynamic test at one frequency", _NO_TIMES, _SWEPT),
    "modulus": KindOfFile(
        "a relaxation modulus over time", "use dashpot fit", ("time", "modulus")
    ),
    "creep": KindOfFile("a creep test", "use dashpot fit"),
    "cld": KindOfFile(
        "a compression load deflection (CLD), pressed and released", "use dashpot fit", RAMP,
    ),
    "indentation": KindOfFile(
        "a contact of an indenter", "use dashpot fit with its mass", ("time", "velocity"), True
    ),
    "drop": KindOfFile(
        "a drop test of a mass on a specimen", "use dashpot fit with its mass",
        ("time", "force"), True,
    ),
    "stress-strain": KindOfFile(
        "stress over strain of a material",
        "use dashpot fit; of a relaxation test multiply by area and height first",
        ("time", "stretch", "strain", "stress"),
    ),
    "csr": KindOfFile(
        "a record of compression stress relaxation (CSR)", "use dashpot fit", ("time", "force"),
        by_hand=True,
    ),
    "cyclic": KindOfFile("a cyclic run without a hold", "use dashpot fit", RAMP),
    "plug-in": KindOfFile(
        "a test of a plug-in's kind", "use dashpot fit",
        ("time", "displacement", "force", "stress", "strain", "temperature", "frequency"),
        by_hand=True,
    ),
    "blank": KindOfFile(
        "a blank test of the machine", "use dashpot fit --kind blank -o rig.toml", RAMP
    ),
    "preload-map": KindOfFile(
        "storage and loss at several compressions", "use dashpot map", _SWEPT
    ),
    "seal-line": KindOfFile(
        "points of a seal line", "a door file names it: [seal] points, for dashpot predict"
    ),
    "free-modes": KindOfFile(
        "modes of a structure at points", "a door file names it: [modes] file, for dashpot predict"
    ),
})  # fmt: skip
"""Every kind that a file can be seen to be; what else is of a kind, ``dashpot.registry`` names."""

_SIGNALS = {"force", "displacement", "stress", "strain"}


@dataclass(frozen=True, eq=False)
class NamedColumns:
    """What the names and units of a table's columns say."""

    table: FileTable
    options: ReadOptions
    best_scores: dict[Role, float] = field(default_factory=dict)

    @cached_property
    def unique_names(self) -> tuple[str, ...]:
        """The names, once where they differ by a number alone: there may be thousands of them."""
        return tuple(
            dict.fromkeys(vocabulary.replace_channel_number(c.name) for c in self.table.columns)
        )

    def _find_best_score(self, role: Role) -> float:
        """Return how well the likeliest column suits a role."""
        if role not in self.best_scores:
            scores = score_columns(self.table, role, self.options).values()
            self.best_scores[role] = max(scores, default=0.0)
        return self.best_scores[role]

    def has(self, *roles: Role, least: float = 1.5) -> bool:
        """Return whether each role is named by the user, or suits a column that well."""
        return all(self.has_named_column(option_of(role)) or self._find_best_score(role) >= least for role in roles)

    def has_named_column(self, *fields: str) -> bool:
        """Whether the user names a column that is here in one of these fields of the options."""
        return any(self._has_column(getattr(self.options, field, None)) for field in fields)

    def _has_column(self, named: str | None) -> bool:
        try:
            return bool(named) and find_column(self.table.columns, str(named), "") >= 0
        except ReadError:  # it is of another file, or its reader says so
            return False

    def has_time(self, least: float = 1.5) -> bool:
        """Return whether there is a clock, or the user states the rate."""
        return self.has("time", least=least) or self.options.rate is not None

    def has_ramp_columns(self) -> bool:
        """Return whether there are the columns of a ramp and hold, be it by their units alone."""
        return self.has_time(least=1.0) and self.has("force", "displacement", least=1.0)

    def has_acceleration(self) -> bool:
        """Return whether there is an acceleration."""
        return bool(accelerations(self.table, (), self.options))

    def has_response(self) -> bool:
        """Return whether there is a complex value over frequency."""
        if self.has("frequency", least=1.0) and self.has("real", "imaginary"):
            return True  # over what is called the linear axis, in Hz
        sized = self.has("magnitude", least=1.0)  # by its unit alone, such as a2/a1 [g/g]
        return sized and self.has("frequency", "phase") and not self.has_motion_as_magnitude()

    def has_partial_response(self) -> bool:
        """Return whether there is one part of a complex value over frequency, and no time."""
        parts: tuple[Role, ...] = ("magnitude", "phase", "real")
        return (
            not self.has_time() and self.has("frequency") and any(self.has(part) for part in parts)
        )

    def has_motion_as_magnitude(self) -> bool:
        """Whether a dynamic stiffness is named, and what looks like a magnitude is the motion."""
        columns, named = self.table.columns, self.options.magnitude
        sizes = [columns[i] for i in self._find_likely_columns("complex_modulus", 2.5)]
        if named is not None:
            return columns[find_column(columns, named, flag("magnitude"))] in sizes
        words = [columns[i].unit for i in self._find_likely_columns("magnitude", 1.5)]
        return bool(sizes) and all(
            word and any(units.find_unit(word, name) for name in ("length", "strain", "force"))
            for word in words
        )

    def _find_likely_columns(self, role: Role, least: float) -> list[int]:
        return [
            i
            for i, value in score_columns(self.table, role, self.options).items()
            if value >= least
        ]

    def has_sweep(self) -> bool:
        """Whether there is frequency, and a complex modulus in parts or by its size and angle.

        A table that holds the record behind them, too, is a sweep, unless the user names what a
        sweep has no use for, or its cells are empty.
        """
        if not self._has_sweep_columns():
            return False
        if self.has_named_column("storage", "loss", "loss_factor") or not self.has_ramp_columns():
            return True
        return not self.has_named_column("time", "force") and all(
            bool(np.any(_load_role_values(self.table, role, self.options) > 0))
            for role in _FILLED
            if self.has(role)
        )

    def _has_sweep_columns(self) -> bool:
        return self.has("frequency") and self.has_complex_modulus()

    def has_complex_modulus(self) -> bool:
        """Whether there is a complex modulus in parts or by its size and angle, over whatever."""
        ratio = self.has("loss_factor") or self.has("loss_angle")
        parts = self.has("storage") and (ratio or self.has("loss"))
        return parts or (ratio and self.has("complex_modulus") and not self.has("coherence"))

    def has_signal_pair(self, *, pushed: bool) -> bool:
        """Return whether there are two amplitudes with two phases, one of them a force or none."""
        pair = find_amplitude_phase_pairs(self.table, self.options)
        return pair is not None and pushed == any(columns.is_force for columns in pair)

    def has_motion_ratio(self) -> bool:
        """Return whether a response is of a motion to another."""
        return is_motion_ratio(self.table)

    def has_creep(self) -> bool:
        """Return whether there is a creep compliance, or the header says creep."""
        header = " ".join(self.table.header).casefold()
        names = map(str.casefold, self.unique_names)
        named = any("compliance" in name and "machine" not in name for name in names)
        named = named or self.has("creep_compliance", least=2.5)  # J(t), in 1/Pa
        stated = "creep" in header and "relax" not in header
        # what moves of columns that the user names is asked of the record
        return named or (stated and not self.has_named_column("displacement", "force"))

    def has_coordinates(self, *more: str) -> bool:
        """Return whether the columns are named x, y and z, and so."""
        return {"x", "y", "z", *more} <= set(map(vocabulary.normalise_name, self.unique_names))

    def satisfies(self, kind: FileKind) -> bool:
        """Return whether the rule of a kind of an extension holds."""
        rule = find_handler("table rule", kind)
        return bool(rule and rule(self))

    def has_spectral_density(self) -> bool:
        """Return whether a column is a power spectral density."""
        return any(
            "spectral density" in name or "psd" in vocabulary.tokens(name)
            for name in map(str.casefold, self.unique_names)
        )


_RULES: tuple[tuple[FileKind, str, Callable[[NamedColumns], bool] | None], ...] = (
    (
        "free-modes",
        "it has mode, frequency, and x, y and z of points",
        lambda s: s.has_coordinates("mode", "frequency"),
    ),
    (
        "seal-line",
        "it has x, y and z of points, and no clock",
        lambda s: s.has_coordinates() and not s.has_time(),
    ),
    (
        "transmissibility",
        "it has frequency, and a motion over a motion",
        lambda s: s.has_response() and s.has_motion_ratio(),
    ),
    (
        "transmissibility",
        "it has frequency, and two motions, each with its phase",
        lambda s: s.has_signal_pair(pushed=False),
    ),
    (
        "frf",
        "it has frequency, and a force and a motion, each with its phase",
        lambda s: s.has_signal_pair(pushed=True),
    ),
    ("frf", "it has frequency, and a complex value", NamedColumns.has_response),
    (
        "preload-map",
        "it has frequency, storage and loss at several compressions",
        lambda s: s.has_sweep() and s.satisfies("preload-map"),
    ),
    (
        "dma",
        "it has frequency, storage and loss",
        NamedColumns.has_sweep,
    ),
    ("not-a-test", "it is a power spectral density, which has no phase", NamedColumns.has_spectral_density),
    (
        "indentation",
        "it has time and the acceleration or velocity of an indenter",
        None,
    ),
    (
        "drop",
        "it has time and a force or an acceleration, and says slam",
        None,
    ),
    (
        "impact",
        "it has time, and an acceleration is said to be that of the base",
        lambda s: s.has_time() and s.options.base_acceleration is not None,
    ),
    (
        "impact",
        "it has time and an acceleration",
        lambda s: s.has_time() and s.has_acceleration() and not s.has("displacement", least=2.5),
    ),
    (
        "creep",
        "it has a creep compliance, or its header says creep",
        lambda s: s.has_time() and s.has_creep(),
    ),
    (
        "relaxation",
        "it has time, displacement and force",
        NamedColumns.has_ramp_columns,
    ),
    (
        "csr",
        "it has force over hours, and no displacement",
        None,
    ),
    (
        "modulus",
        "it has time and a modulus, a curve derived from a test",
        lambda s: s.has("modulus") and s.has_time(),
    ),
    (
        "not-a-test",
        "it is a flow curve of a rheometer (viscosity, shear rate)",
        lambda s: s.has("viscosity") or (s.has("shear_rate") and not s.has_time()),
    ),
    (
        "stress-strain",
        "it has stress and strain, not force and displacement",
        lambda s: s.has("stress", "strain") or s.has("stress", "stretch"),
    ),
    (
        "cld",
        "it has displacement and force, and no clock",
        lambda s: not s.has_time() and s.has("force", "displacement", least=2.5),
    ),
    ("frf", "it has frequency, and a part of a complex value", NamedColumns.has_partial_response),
    (
        "not-a-test",
        "it has storage and loss, and no frequency. Write a column 'frequency [Hz]' beside them",
        lambda s: not s.has_time() and s.has_complex_modulus(),
    ),
    ("unclear", "no set of columns that makes a test was recognised", lambda _: True),
)
"""The kinds, their reasons and what shows them, None if an extension says it; the first that holds
is taken."""


_FILLED: tuple[Role, ...] = ("frequency", "storage", "complex_modulus")
"""What is empty, or 0, in a sweep's columns where a machine wrote another test into them."""

_OF_ROLE: Mapping[str, tuple[FileKind, ...]] = MappingProxyType({
    "modulus": ("modulus",), "creep_compliance": ("creep",), "base_acceleration": ("impact",),
    "hammer": ("impact",), "velocity": ("indentation",), "stretch": ("stress-strain",),
    "storage": ("dma",), "loss": ("dma",), "loss_factor": ("dma",),
    "real": ("transmissibility", "frf"), "imaginary": ("transmissibility", "frf"),
    "coherence": ("transmissibility", "frf"),
})  # fmt: skip
"""The kinds that alone have a role: who names its column says what the file is."""


_FORMER_KINDS = {"slam": "drop"}
"""Present name of a kind by its name in the edition before."""


def detect_table_kind(table: FileTable, options: ReadOptions) -> tuple[FileKind, str]:
    """Return the kind of record and why, from names and units, and of a sweep from its range.

    What only a record's motion tells, `dashpot.reading.readers.detect_kind` adds.
    """
    if options.kind is not None:
        return parse_file_kind(options.kind)
    named = NamedColumns(table, options)
    swept = named.has_sweep()
    meant = named.has_named_column("force", "displacement", "acceleration")
    peaks = (
        None if swept or meant or find_amplitude_phase_pairs(table, options) else explain_cycle_summary(table)
    )
    if peaks:
        return "not-a-test", peaks
    stated = {kind for role, kinds in _OF_ROLE.items() if named.has_named_column(role) for kind in kinds}
    if named.has_named_column("stress", "strain") and not swept:  # of a sweep they are amplitudes
        stated.add("stress-strain")
    rules = sorted(_RULES, key=lambda rule: rule[0] not in stated)
    kind, reason = next(
        (kind, reason)
        for kind, reason, holds in rules
        if (holds(named) if holds else named.satisfies(kind))
    )
    if kind == "dma":
        kind, reason = _detect_sweep_kind(table, options, reason)
        if kind == "dma" and named.has_named_column("displacement") and named.has_ramp_columns():
            return "relaxation", "it has time, displacement and force, as named"
    if kind == "modulus":
        decades = _compute_decades(table, "time", options)
        return kind, reason + (f", over {decades:.0f} decades" if decades >= MASTER else "")
    return kind, reason


def parse_file_kind(word: str) -> tuple[FileKind, str]:
    """Return the kind that a user says a file is, by its word or by that of a plug-in, and why.

    Raises
    ------
    ReadError
        If there is none, with the nearest.
    """
    word = _FORMER_KINDS.get(word, word)
    if word in RECOGNISED and word != "plug-in":
        return cast("FileKind", word), "as was said"
    from difflib import get_close_matches  # few need them, and they cost time to import

    from dashpot.registry.plugins import find_plugin, format_plugin_names

    plugged = find_plugin("kinds", word)
    if plugged is not None:
        return "plug-in", f"for {plugged.label}, as was said"
    near = get_close_matches(word, RECOGNISED, 1)
    raise ReadError(
        f"'{word}' is no kind of file. "
        + (f"Did you mean '{near[0]}'?" if near else f"Kinds are {', '.join(RECOGNISED)}.")
        + format_plugin_names("kinds")
    )


def is_motion_ratio(table: FileTable) -> bool:
    """Return whether a response is of a motion to another, as under base excitation."""
    return any("transmissib" in line.casefold() for line in table.header) or any(
        "transmissib" in column.name.casefold() or _is_motion_ratio_unit(column.unit or "")
        for column in table.columns
    )


def is_relative_transmissibility(table: FileTable) -> bool:
    """Return whether a name or the header says a relative transmissibility."""
    sentences = (*table.header, *(column.name for column in table.columns))
    return any(
        "relative transmissib" in sentence.casefold().replace("_", " ") for sentence in sentences
    )


MASTER = 7.0
"""Decades of frequency or time that no machine sweeps in one test: they were shifted together."""
ONE_FREQUENCY = 0.02
"""Decades within which a sweep stays at one frequency."""


def _is_motion_ratio_unit(unit: str) -> bool:
    """Return whether a unit is that of a motion over a motion, such as g/g or mm/g."""
    new_ratio = parse_response_unit(unit)
    return new_ratio is not None and new_ratio.kind.over_base


def _load_role_values(table: FileTable, role: Role, options: ReadOptions) -> FloatArray:
    """Return the numbers of the column likeliest in a role; none if there is no such column."""
    indexes = _find_role_columns(table, (role,), options)
    values = table.load(indexes).values[:, 0] if indexes else np.empty(0)
    return values[np.isfinite(values)]


def _find_role_columns(table: FileTable, roles: Sequence[Role], options: ReadOptions) -> list[int]:
    """The index of the column likeliest in each role; of a role without such a column none."""
    indices = []
    for role in roles:
        named = getattr(options, role, None)
        if named is not None:
            indices.append(find_column(table.columns, named, flag(role)))
            continue
        scores = score_columns(table, role, options)
        best = max(scores, key=lambda i: scores[i], default=None)
        indices += [best] if best is not None and scores[best] >= 1.0 else []
    return indices


def _compute_decades(table: FileTable, role: Role, options: ReadOptions) -> float:
    """Over how many decades a column runs; NaN without three values above zero."""
    values = _load_role_values(table, role, options)
    values = values[values > 0]
    return float(np.ptp(np.log10(values))) if len(values) > 2 else math.nan


def _has_variation(table: FileTable, role: Role, options: ReadOptions) -> bool:
    values = _load_role_values(table, role, options)
    return bool(len(values) and np.ptp(values) > 0.05 * np.abs(values).max())


def _detect_sweep_kind(table: FileTable, options: ReadOptions, reason: str) -> tuple[FileKind, str]:
    """Return what a table of storage and loss was swept over."""
    decades = _compute_decades(table, "frequency", options)
    if decades >= MASTER:
        return "master-curve", f"{reason}, over {decades:.0f} decades"
    if not decades <= ONE_FREQUENCY:
        if _has_amplitude_sweep(table, assign_amplitude_column(table, options)):
            return "strain-sweep", reason + ", and each frequency recurs at several amplitudes"
        return "dma", reason
    reason += ", and the frequency never changes"
    named = assign_amplitude_column(table, options)
    if any(_has_variation(table, role, named) for role in _AMPLITUDES):
        return "strain-sweep", reason
    warmed = _has_variation(table, "temperature", options)
    return "temperature-sweep" if warmed else "one-frequency", reason


_AMPLITUDES: tuple[Role, ...] = ("strain", "stress", "displacement", "force")
_APART = 1.5
"""Ratio of amplitudes that no drive drifts by at one frequency and temperature."""
_SAME_WARMTH = 3.0
"""K within which rows are of one temperature."""


def assign_amplitude_column(table: FileTable, options: ReadOptions) -> ReadOptions:
    """The options, with a length that is called an amplitude and nothing else as displacement."""
    if any(
        getattr(options, role)
        or max(score_columns(table, role, options).values(), default=0.0) >= 1.0
        for role in ("strain", "displacement")
    ):
        return options
    for number, column in enumerate(table.columns, 1):
        long = column.unit and units.find_unit(column.unit, "length")
        if long and "amplitude" in vocabulary.tokens(column.name):
            return replace(options, displacement=str(number))
    return options


def group_values(values: FloatArray, width: float) -> npt.NDArray[np.intp]:
    """The group of each value: those that lie within a width of the smallest of their group."""
    order = np.argsort(values)
    result, first, group = np.zeros(len(values), dtype=np.intp), -math.inf, -1
    for i in order.tolist():
        if not values[i] - first <= width:
            first, group = float(values[i]), group + 1
        result[i] = group
    return result


def _has_amplitude_sweep(table: FileTable, options: ReadOptions) -> bool:
    """Return whether most frequencies were met at several amplitudes at one temperature."""
    amplitudes = _find_role_columns(table, ("strain", "displacement"), options)
    if not amplitudes:
        return False
    frequency = _find_role_columns(table, ("frequency",), options)
    temperature = _find_role_columns(table, ("temperature",), options)
    loaded = table.load([*frequency, amplitudes[0], *temperature])
    block = np.repeat(np.arange(len(loaded.starts)), np.diff((*loaded.starts, len(loaded.values))))
    text = np.all(np.isfinite(loaded.values), axis=1) & np.all(loaded.values[:, :2] > 0, axis=1)
    rows, block = loaded.values[text], block[text]
    warmth = np.zeros(len(rows), dtype=np.intp)
    if rows.shape[1] > 2:
        warmth = group_values(rows[:, 2], _SAME_WARMTH)
    elif any("temp" in line.casefold() for line in chain(*loaded.above)):
        warmth = block
    cells = np.stack((group_values(np.log10(rows[:, 0]), ONE_FREQUENCY), warmth))
    _, cell = np.unique(cells, axis=1, return_inverse=True)
    alike = [rows[cell.ravel() == index, 1] for index in range(int(cell.max(initial=-1)) + 1)]
    separate = [float(X.max()) >= _APART * float(X.min()) for X in alike]
    return 2 * sum(separate) >= max(len(separate), 1)


def refuse_kind(
    table: FileTable, options: ReadOptions, accepted: Sequence[FileKind], want: str
) -> None:
    """Refuse a table that is surely not what `want` says, with the command that takes it.

    A user who names columns of what is wanted knows better: the caller does not ask then.

    Raises
    ------
    ReadError
    """
    kind, reason = detect_table_kind(table, options)
    if kind in RECOGNISED and kind not in accepted:
        raise ReadError(format_other_kind(kind, reason, want))


def format_other_kind(kind: str, reason: str, want: str) -> str:
    """Say what a file is, where another is wanted, and which command takes it."""
    what, command, *_ = RECOGNISED[kind]
    return f"this is {what} ({reason}), where {want} expected: {command}"


def explain_cycle_summary(table: FileTable) -> str | None:
    """Return why a table is one row per cycle (trends, peaks), or None."""
    names = [column.name for column in table.columns]
    extremes = list(filter(_is_extreme, names))
    if len(extremes) < 2:
        return None
    recorded = any(_is_recorded(name) for name in names if name not in extremes)
    counted = any("cycle" in vocabulary.matches(name) for name in names)
    if recorded and not counted:
        return None
    listed = ", ".join(f"'{name}'" for name in extremes[:3])
    return (
        f"it is a summary with one row per cycle ({listed}), not the recorded signals; "
        "export the raw time, displacement and force instead"
    )


def _is_extreme(name: str) -> bool:
    signal = not _SIGNALS.isdisjoint(vocabulary.matches(name))
    return signal and vocabulary.has_word(name, vocabulary.EXTREMES)


def _is_recorded(name: str) -> bool:
    pushed = vocabulary.matches(name).get("force", 0.0) >= 2.5
    return pushed and not vocabulary.has_word(name, vocabulary.DERIVED)
