"""Detection of the kind of record by its columns: a test, a derived curve, or neither."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from itertools import chain
from types import MappingProxyType
from typing import NamedTuple, cast

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, field, replace, units
from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.base.units import Dimension
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.file_kinds import KINDS_OF_FILE, FileKind
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
from dashpot.registry import call_handler, find_handler

# Amplitude and phase of two signals, whose ratio is a response.


_PAIRED_MOTIONS: tuple[Dimension, ...] = ("acceleration", "length", "velocity")
_NAMED_SCORE = 1.5
_MIN_COLUMNS, _MAX_COLUMNS = 5, 64
"""Columns of a controller's table."""


class AmplitudePhaseColumns(NamedTuple):
    """Indices of the columns of a signal's amplitude and phase, and whether it is a force."""

    amplitude: int
    phase: int
    is_force: bool


def find_amplitude_phase_pairs(
    table: FileTable, options: ReadOptions
) -> tuple[AmplitudePhaseColumns, AmplitudePhaseColumns] | None:
    """Return the two signals of a table that holds two amplitudes with two phases over frequency.

    None is returned for any other table, and where a column is a response already.
    """
    phases, amplitudes, frequency_count = [], [], 0
    if not _MIN_COLUMNS <= len(table.columns) <= _MAX_COLUMNS:
        return None
    for i, column in enumerate(table.columns):
        if column.content != "number":
            continue
        unit = column.unit or ""
        if parse_response_unit(unit) or any(
            score(column, role, options) >= _NAMED_SCORE for role in ("real", "storage")
        ):
            return None
        if score(column, "frequency", options) >= _NAMED_SCORE:
            frequency_count += 1
        elif score(column, "phase", options) >= _NAMED_SCORE:
            phases.append(i)
        elif units.find_unit(unit, "force") or any(
            units.find_unit(unit, motion) for motion in _PAIRED_MOTIONS
        ):
            amplitudes.append(i)
    are_forces = [bool(units.find_unit(table.columns[i].unit or "", "force")) for i in amplitudes]
    if not frequency_count or len(amplitudes) != 2 or len(phases) != 2 or all(are_forces):
        return None
    if _has_reversed_phases(table, amplitudes, phases):
        phases.reverse()
    first, second = (
        AmplitudePhaseColumns(*item) for item in zip(amplitudes, phases, are_forces, strict=True)
    )
    return first, second


def _has_reversed_phases(table: FileTable, amplitudes: list[int], phases: list[int]) -> bool:
    """Return whether by its name the first phase belongs to the second amplitude."""
    words = {i: set(vocabulary.tokens(table.columns[i].name)) for i in (*amplitudes, *phases)}
    own_words = {i: words[i] - words[j] for i, j in (amplitudes, amplitudes[::-1])}
    in_order, reversed_order = (
        sum(len(own_words[i] & words[p]) for i, p in zip(amplitudes, phase_order, strict=True))
        for phase_order in (phases, phases[::-1])
    )
    return reversed_order > in_order


_SIGNAL_ROLES = {"force", "displacement", "stress", "strain"}


@dataclass(frozen=True, eq=False)
class NamedColumns:
    """Predicates on the names and units of a table's columns."""

    table: FileTable
    options: ReadOptions
    best_scores: dict[Role, float] = field(default_factory=dict)

    @cached_property
    def unique_names(self) -> tuple[str, ...]:
        """Names of the columns without channel numbers, each once: there may be thousands."""
        return tuple(
            dict.fromkeys(vocabulary.replace_channel_number(c.name) for c in self.table.columns)
        )

    def _find_best_score(self, role: Role) -> float:
        """Return the score of the likeliest column for a role."""
        if role not in self.best_scores:
            scores = score_columns(self.table, role, self.options).values()
            self.best_scores[role] = max(scores, default=0.0)
        return self.best_scores[role]

    def has(self, *roles: Role, min_score: float = 1.5) -> bool:
        """Return whether each role is named by the user, or has a column of that score."""
        return all(
            self.has_named_column(option_of(role)) or self._find_best_score(role) >= min_score
            for role in roles
        )

    def has_named_column(self, *fields: str) -> bool:
        """Return whether one of these fields of the options names a column of the table."""
        return any(self._has_column(getattr(self.options, field, None)) for field in fields)

    def _has_column(self, column_name: str | None) -> bool:
        try:
            return bool(column_name) and find_column(self.table.columns, str(column_name), "") >= 0
        except ReadError:  # it is of another file, or its reader says so
            return False

    def has_time(self, min_score: float = 1.5) -> bool:
        """Return whether there is a clock, or the user states the rate."""
        return self.has("time", min_score=min_score) or self.options.rate is not None

    def has_ramp_columns(self) -> bool:
        """Return whether there are the columns of a ramp and hold, by name or by unit alone."""
        return self.has_time(min_score=1.0) and self.has("force", "displacement", min_score=1.0)

    def has_acceleration(self) -> bool:
        """Return whether there is an acceleration."""
        return bool(accelerations(self.table, (), self.options))

    def has_response(self) -> bool:
        """Return whether there is a complex value over frequency."""
        if self.has("frequency", min_score=1.0) and self.has("real", "imaginary"):
            return True  # over what is called the linear axis, in Hz
        has_magnitude = self.has(
            "magnitude", min_score=1.0
        )  # by its unit alone, such as a2/a1 [g/g]
        return (
            has_magnitude and self.has("frequency", "phase") and not self.has_motion_as_magnitude()
        )

    def has_partial_response(self) -> bool:
        """Return whether there is one part of a complex value over frequency, and no time."""
        parts: tuple[Role, ...] = ("magnitude", "phase", "real")
        return (
            not self.has_time() and self.has("frequency") and any(self.has(part) for part in parts)
        )

    def has_motion_as_magnitude(self) -> bool:
        """Return whether a dynamic stiffness is named, and the likely magnitude is a motion."""
        columns, magnitude = self.table.columns, self.options.magnitude
        modulus_columns = [columns[i] for i in self._find_likely_columns("complex_modulus", 2.5)]
        if magnitude is not None:
            return columns[find_column(columns, magnitude, flag("magnitude"))] in modulus_columns
        magnitude_units = [columns[i].unit for i in self._find_likely_columns("magnitude", 1.5)]
        return bool(modulus_columns) and all(
            unit and any(units.find_unit(unit, name) for name in ("length", "strain", "force"))
            for unit in magnitude_units
        )

    def _find_likely_columns(self, role: Role, min_score: float) -> list[int]:
        return [
            i
            for i, value in score_columns(self.table, role, self.options).items()
            if value >= min_score
        ]

    def has_sweep(self) -> bool:
        """Return whether there are a frequency and a complex modulus.

        A table that contains time, displacement and force, too, is a sweep, unless the user names
        time or force, or the cells of the sweep are empty.
        """
        if not self._has_sweep_columns():
            return False
        if self.has_named_column("storage", "loss", "loss_factor") or not self.has_ramp_columns():
            return True
        return not self.has_named_column("time", "force") and all(
            bool(np.any(_load_role_values(self.table, role, self.options) > 0))
            for role in _REQUIRED_SWEEP_ROLES
            if self.has(role)
        )

    def _has_sweep_columns(self) -> bool:
        return self.has("frequency") and self.has_complex_modulus()

    def has_complex_modulus(self) -> bool:
        """Return whether there is a complex modulus, in parts or by its magnitude and angle."""
        has_loss_ratio = self.has("loss_factor") or self.has("loss_angle")
        has_parts = self.has("storage") and (has_loss_ratio or self.has("loss"))
        return has_parts or (
            has_loss_ratio and self.has("complex_modulus") and not self.has("coherence")
        )

    def has_signal_pair(self, *, has_force: bool) -> bool:
        """Return whether there are two amplitudes with two phases, one of them a force or none."""
        pair = find_amplitude_phase_pairs(self.table, self.options)
        return pair is not None and has_force == any(columns.is_force for columns in pair)

    def has_creep(self) -> bool:
        """Return whether there is a creep compliance, or the header mentions creep."""
        header = " ".join(self.table.header).casefold()
        names = map(str.casefold, self.unique_names)
        has_compliance = any("compliance" in name and "machine" not in name for name in names)
        has_compliance = has_compliance or self.has(
            "creep_compliance", min_score=2.5
        )  # J(t), in 1/Pa
        header_says_creep = "creep" in header and "relax" not in header
        # where the user names the columns, the record decides
        return has_compliance or (
            header_says_creep and not self.has_named_column("displacement", "force")
        )

    def has_coordinates(self, *further_names: str) -> bool:
        """Return whether columns are named x, y, z and as in `further_names`."""
        return {"x", "y", "z", *further_names} <= set(
            map(vocabulary.normalise_name, self.unique_names)
        )

    def satisfies(self, kind: FileKind) -> bool:
        """Return whether the table satisfies the rule of an extension's kind."""
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
        lambda s: s.has_response() and is_motion_ratio(s.table),
    ),
    (
        "transmissibility",
        "it has frequency, and two motions, each with its phase",
        lambda s: s.has_signal_pair(has_force=False),
    ),
    (
        "frf",
        "it has frequency, and a force and a motion, each with its phase",
        lambda s: s.has_signal_pair(has_force=True),
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
    (
        "not-a-test",
        "it is a power spectral density, which has no phase",
        NamedColumns.has_spectral_density,
    ),
    (
        "indentation",
        "it has time and the acceleration or velocity of an indenter",
        None,
    ),
    (
        "drop",
        "it has time and a force or an acceleration, and is named a drop test",
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
        lambda s: (
            s.has_time() and s.has_acceleration() and not s.has("displacement", min_score=2.5)
        ),
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
        lambda s: not s.has_time() and s.has("force", "displacement", min_score=2.5),
    ),
    ("frf", "it has frequency, and a part of a complex value", NamedColumns.has_partial_response),
    (
        "not-a-test",
        "it has storage and loss, and no frequency. Write a column 'frequency [Hz]' beside them",
        lambda s: not s.has_time() and s.has_complex_modulus(),
    ),
    ("unclear", "no set of columns that makes a test was recognised", lambda _: True),
)
"""Kinds, reasons and predicates, of which the first true one decides; None: an extension has it."""


_REQUIRED_SWEEP_ROLES: tuple[Role, ...] = ("frequency", "storage", "complex_modulus")
"""Roles whose columns are empty, or 0, where a machine wrote another test into a sweep's table."""

_KINDS_BY_ROLE: Mapping[str, tuple[FileKind, ...]] = MappingProxyType({
    "modulus": ("modulus",), "creep_compliance": ("creep",), "base_acceleration": ("impact",),
    "hammer": ("impact",), "velocity": ("indentation",), "stretch": ("stress-strain",),
    "storage": ("dma",), "loss": ("dma",), "loss_factor": ("dma",),
    "real": ("transmissibility", "frf"), "imaginary": ("transmissibility", "frf"),
    "coherence": ("transmissibility", "frf"),
})  # fmt: skip
"""Kinds with a unique role: naming a column for it states the kind."""


def detect_table_kind(table: FileTable, options: ReadOptions) -> tuple[FileKind, str]:
    """Return the kind of record and the reason, by names and units, and of a sweep by its range.

    Decisions by the motion in a record are in `dashpot.reading.readers.detect_kind`.
    """
    if options.kind is not None:
        return parse_file_kind(options.kind)
    columns = NamedColumns(table, options)
    is_sweep = columns.has_sweep()
    names_signals = columns.has_named_column("force", "displacement", "acceleration")
    summary_reason = (
        None
        if is_sweep or names_signals or find_amplitude_phase_pairs(table, options)
        else explain_cycle_summary(table)
    )
    if summary_reason:
        return "not-a-test", summary_reason
    named_kinds = {
        kind
        for role, kinds in _KINDS_BY_ROLE.items()
        if columns.has_named_column(role)
        for kind in kinds
    }
    # the stress and strain of a sweep are amplitudes
    if columns.has_named_column("stress", "strain") and not is_sweep:
        named_kinds.add("stress-strain")
    ordered_rules = sorted(_RULES, key=lambda rule: rule[0] not in named_kinds)
    kind, reason = next(
        (kind, reason)
        for kind, reason, holds in ordered_rules
        if (holds(columns) if holds else columns.satisfies(kind))
    )
    if kind == "dma":
        kind, reason = _detect_sweep_kind(table, options, reason)
        named_motion = columns.has_named_column("displacement")
        if kind == "dma" and named_motion and columns.has_ramp_columns():
            return "relaxation", "it has time, displacement and force, as named"
    if kind == "modulus":
        decades = _compute_decades(table, "time", options)
        return kind, reason + (
            f", over {decades:.0f} decades" if decades >= MASTER_CURVE_DECADES else ""
        )
    return kind, reason


def parse_file_kind(kind_name: str) -> tuple[FileKind, str]:
    """Return the kind of file that has a name, built in or of a plug-in, and the reason.

    Raises
    ------
    ReadError
        If there is none; the message names the nearest.
    """
    kind_name = call_handler("suggest", "kind", kind_name, default=kind_name)
    if kind_name in KINDS_OF_FILE and kind_name != "plug-in":
        return cast("FileKind", kind_name), "as stated"
    from difflib import get_close_matches  # few need them, and they cost time to import

    from dashpot.registry.plugins import find_plugin, format_plugin_names

    plugin = find_plugin("kinds", kind_name)
    if plugin is not None:
        return "plug-in", f"for {plugin.label}, as stated"
    nearest_names = get_close_matches(kind_name, KINDS_OF_FILE, 1)
    raise ReadError(
        f"'{kind_name}' is no kind of file. "
        + (
            f"Did you mean '{nearest_names[0]}'?"
            if nearest_names
            else f"Kinds are {', '.join(KINDS_OF_FILE)}."
        )
        + format_plugin_names("kinds")
    )


def is_motion_ratio(table: FileTable) -> bool:
    """Return whether a response is a motion over a motion, as under base excitation."""
    return any("transmissib" in line.casefold() for line in table.header) or any(
        "transmissib" in column.name.casefold() or _is_motion_ratio_unit(column.unit or "")
        for column in table.columns
    )


def is_relative_transmissibility(table: FileTable) -> bool:
    """Return whether a name or the header states a relative transmissibility."""
    texts = (*table.header, *(column.name for column in table.columns))
    return any("relative transmissib" in text.casefold().replace("_", " ") for text in texts)


MASTER_CURVE_DECADES = 7.0
"""Decades of frequency or time from which a curve was shifted together from several tests."""
SINGLE_FREQUENCY_DECADES = 0.02
"""Decades within which a sweep stays at one frequency."""


def _is_motion_ratio_unit(unit: str) -> bool:
    """Return whether a unit is that of a motion over a motion, such as g/g or mm/g."""
    response_unit = parse_response_unit(unit)
    return response_unit is not None and response_unit.kind.over_base


def _load_role_values(table: FileTable, role: Role, options: ReadOptions) -> FloatArray:
    """Return the finite values of the likeliest column of a role; empty without one."""
    indexes = _find_role_columns(table, (role,), options)
    values = table.load(indexes).values[:, 0] if indexes else np.empty(0)
    return values[np.isfinite(values)]


def _find_role_columns(table: FileTable, roles: Sequence[Role], options: ReadOptions) -> list[int]:
    """Return the indices of the likeliest columns of roles; roles without one are omitted."""
    indices = []
    for role in roles:
        column_name = getattr(options, role, None)
        if column_name is not None:
            indices.append(find_column(table.columns, column_name, flag(role)))
            continue
        scores = score_columns(table, role, options)
        best = max(scores, key=lambda i: scores[i], default=None)
        indices += [best] if best is not None and scores[best] >= 1.0 else []
    return indices


def _compute_decades(table: FileTable, role: Role, options: ReadOptions) -> float:
    """Return the range of a column in decades; NaN without three values above zero."""
    values = _load_role_values(table, role, options)
    values = values[values > 0]
    return float(np.ptp(np.log10(values))) if len(values) > 2 else math.nan


def _has_variation(table: FileTable, role: Role, options: ReadOptions) -> bool:
    values = _load_role_values(table, role, options)
    return bool(len(values) and np.ptp(values) > 0.05 * np.abs(values).max())


def _detect_sweep_kind(table: FileTable, options: ReadOptions, reason: str) -> tuple[FileKind, str]:
    """Return the kind of sweep of a table of storage and loss, and the reason."""
    decades = _compute_decades(table, "frequency", options)
    if decades >= MASTER_CURVE_DECADES:
        return "master-curve", f"{reason}, over {decades:.0f} decades"
    if not decades <= SINGLE_FREQUENCY_DECADES:
        if _has_amplitude_sweep(table, assign_amplitude_column(table, options)):
            return "strain-sweep", reason + ", and each frequency recurs at several amplitudes"
        return "dma", reason
    reason += ", and the frequency never changes"
    amplitude_options = assign_amplitude_column(table, options)
    if any(_has_variation(table, role, amplitude_options) for role in _AMPLITUDE_ROLES):
        return "strain-sweep", reason
    temperature_varies = _has_variation(table, "temperature", options)
    return "temperature-sweep" if temperature_varies else "single-frequency", reason


_AMPLITUDE_ROLES: tuple[Role, ...] = ("strain", "stress", "displacement", "force")
_MIN_AMPLITUDE_RATIO = 1.5
"""Ratio of amplitudes at one frequency and temperature from which they were swept."""
_TEMPERATURE_WIDTH = 3.0
"""Range of temperatures that counts as a single one, K."""


def assign_amplitude_column(table: FileTable, options: ReadOptions) -> ReadOptions:
    """Return the options, with a length column named amplitude as displacement if none is."""
    if any(
        getattr(options, role)
        or max(score_columns(table, role, options).values(), default=0.0) >= 1.0
        for role in ("strain", "displacement")
    ):
        return options
    for number, column in enumerate(table.columns, 1):
        is_length = column.unit and units.find_unit(column.unit, "length")
        if is_length and "amplitude" in vocabulary.tokens(column.name):
            return replace(options, displacement=str(number))
    return options


def group_values(values: FloatArray, width: float) -> npt.NDArray[np.intp]:
    """Return the group of each value: values within a width of the smallest of their group."""
    order = np.argsort(values)
    result, group_start, group = np.zeros(len(values), dtype=np.intp), -math.inf, -1
    for i in order.tolist():
        if not values[i] - group_start <= width:
            group_start, group = float(values[i]), group + 1
        result[i] = group
    return result


def _has_amplitude_sweep(table: FileTable, options: ReadOptions) -> bool:
    """Return whether most frequencies were tested at several amplitudes and one temperature."""
    amplitudes = _find_role_columns(table, ("strain", "displacement"), options)
    if not amplitudes:
        return False
    frequency = _find_role_columns(table, ("frequency",), options)
    temperature = _find_role_columns(table, ("temperature",), options)
    loaded_columns = table.load([*frequency, amplitudes[0], *temperature])
    block = np.repeat(
        np.arange(len(loaded_columns.starts)),
        np.diff((*loaded_columns.starts, len(loaded_columns.values))),
    )
    is_valid = np.all(np.isfinite(loaded_columns.values), axis=1) & np.all(
        loaded_columns.values[:, :2] > 0, axis=1
    )
    rows, block = loaded_columns.values[is_valid], block[is_valid]
    temperature_group = np.zeros(len(rows), dtype=np.intp)
    if rows.shape[1] > 2:
        temperature_group = group_values(rows[:, 2], _TEMPERATURE_WIDTH)
    elif any("temp" in line.casefold() for line in chain(*loaded_columns.above)):
        temperature_group = block
    conditions = np.stack(
        (group_values(np.log10(rows[:, 0]), SINGLE_FREQUENCY_DECADES), temperature_group)
    )
    _, condition = np.unique(conditions, axis=1, return_inverse=True)
    amplitudes_by_condition = [
        rows[condition.ravel() == index, 1] for index in range(int(condition.max(initial=-1)) + 1)
    ]
    is_swept = [
        float(condition_amplitudes.max())
        >= _MIN_AMPLITUDE_RATIO * float(condition_amplitudes.min())
        for condition_amplitudes in amplitudes_by_condition
    ]
    return 2 * sum(is_swept) >= max(len(is_swept), 1)


def refuse_kind(
    table: FileTable, options: ReadOptions, accepted: Sequence[FileKind], expected_kind: str
) -> None:
    """Refuse a table of a kind that is not accepted, and name the command that takes it.

    Callers skip this where the user names columns of the expected kind.

    Raises
    ------
    ReadError
        If the kind is recognised and not accepted.
    """
    kind, reason = detect_table_kind(table, options)
    if kind in KINDS_OF_FILE and kind not in accepted:
        raise ReadError(format_other_kind(kind, reason, expected_kind))


def format_other_kind(kind: str, reason: str, expected_kind: str) -> str:
    """Return the message that a file is of another kind than expected, and its command."""
    kind_name, command, *_ = KINDS_OF_FILE[kind]
    return f"this is {kind_name} ({reason}), where {expected_kind} expected: {command}"


def explain_cycle_summary(table: FileTable) -> str | None:
    """Return the reason why a table has one row per cycle (trends, peaks), or None."""
    names = [column.name for column in table.columns]
    extremes = list(filter(_is_extreme, names))
    if len(extremes) < 2:
        return None
    has_recorded_signal = any(_is_recorded(name) for name in names if name not in extremes)
    has_cycle_count = any("cycle" in vocabulary.matches(name) for name in names)
    if has_recorded_signal and not has_cycle_count:
        return None
    extreme_names = ", ".join(f"'{name}'" for name in extremes[:3])
    return (
        f"it is a summary with one row per cycle ({extreme_names}), not the recorded signals; "
        "export the raw time, displacement and force instead"
    )


def _is_extreme(name: str) -> bool:
    is_signal = not _SIGNAL_ROLES.isdisjoint(vocabulary.matches(name))
    return is_signal and vocabulary.has_word(name, vocabulary.EXTREMES)


def _is_recorded(name: str) -> bool:
    is_force = vocabulary.matches(name).get("force", 0.0) >= 2.5
    return is_force and not vocabulary.has_word(name, vocabulary.DERIVED)
