"""Columns of a frequency sweep: complex modulus by its parts, or by magnitude and angle."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray, median
from dashpot.base.errors import ReadError
from dashpot.base.units import si_unit
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.kind_detection import detect_table_kind
from dashpot.reading.columns.role_assignment import (
    RoleAssignment,
    assign_role,
    format_column,
    quote_column,
)
from dashpot.reading.columns.vocabulary import Role
from dashpot.reading.readers import channels
from dashpot.reading.readers.channels import Channel, OpenedFile
from dashpot.reading.readers.header_metadata import temperatures_of_segments
from dashpot.reading.table import LoadedColumns, Question

_ROLES: tuple[Role, ...] = ("frequency", "storage", "loss")
SWEEP_OPTIONS = ("storage", "magnitude")
"""Options that say that a file is a sweep."""
_LOSS_FACTOR_TOLERANCE = 1.05
"""Tolerance of a loss factor over loss and storage, for printed digits and harmonics."""
_MAX_DEVIATION = 1.5
"""Deviation at which the user is asked which is right, also for moduli of two blocks."""
_A_SWEEP = 3
"""Frequencies of a block, at least."""


def sweep_columns(file: OpenedFile) -> tuple[list[RoleAssignment], int | None]:
    """The columns by role, and that of the loss factor if there is no loss and no loss angle.

    Storage is given with loss, loss factor or loss angle; where no column is storage, the size of
    the complex modulus stands beside one of the last two.

    Raises
    ------
    ReadError
        If a column is not found, or one could be storage or the size.
    """
    assignments = _find_part_columns(file)
    columns = channels.require_answers(file, list(assignments.values()), _hint(file, assignments))
    _refuse_equal_columns(file, columns)
    ratio = next((column.index for column in columns if column.role == "loss_factor"), None)
    columns = [column for column in columns if column.role != "loss_factor"]
    temperature = file.find_unambiguous_column("temperature")
    return [*columns, temperature] if temperature else columns, ratio


def load_sweep(file: OpenedFile) -> tuple[LoadedColumns, dict[Role, FloatArray], str, list[str]]:
    """Return the columns of a sweep, as :func:`load_parts`.

    Raises
    ------
    ReadError
        With what the file leaves open.
    """
    roles_wanted, ratio = sweep_columns(file)
    parts = load_parts(file, channels.add_units(file, roles_wanted), ratio)
    if "temperature" not in parts[1] and temperatures_of_segments(file, parts[0]) is None:
        refuse_unlike_blocks(*parts[:2])
    return parts


def refuse_unlike_blocks(loaded_columns: LoadedColumns, values: Mapping[Role, FloatArray]) -> None:
    """Ask for one block where no temperature parts blocks that sweep the same frequencies.

    Raises
    ------
    ReadError
        If the moduli of one are half as much again as those of another, or more.
    """
    is_complete: BoolArray = np.all(np.isfinite(loaded_columns.values), axis=1)
    blocks = [np.flatnonzero(part) for part in _blocks(loaded_columns, is_complete)]
    sweeps = [
        (np.log(values["frequency"][at]), np.log(values["storage"][at]))
        for at in blocks
        if len(at) >= _A_SWEEP
        and min(values["frequency"][at].min(), values["storage"][at].min()) > 0
    ]
    for f, storage in sweeps[1:]:
        order = np.argsort(sweeps[0][0])
        first, reference = sweeps[0][0][order], sweeps[0][1][order]
        in_range = (f >= first[0]) & (f <= first[-1])
        if not in_range.any() or len(set(f.tolist())) < _A_SWEEP:
            continue
        times = math.exp(median(np.abs(storage - np.interp(f, first, reference))[in_range]))
        if times >= _MAX_DEVIATION:
            raise ReadError(
                f"its blocks sweep the same frequencies, and their moduli differ {times:.3g} "
                "times, but no column and no title says a temperature: read one block with "
                "--file-part segment=1, or add a column of the temperature"
            )


def _blocks(loaded_columns: LoadedColumns, is_complete: BoolArray) -> list[BoolArray]:
    """Return the complete rows of each block."""
    of_row = np.searchsorted(
        np.array(loaded_columns.starts), np.arange(len(is_complete)), side="right"
    )
    return [of_row[is_complete] == number for number in range(1, len(loaded_columns.starts) + 1)]


def _find_part_columns(file: OpenedFile) -> dict[Role, RoleAssignment | Question]:
    """Return the columns of frequency and of the modulus: with loss, loss factor or loss angle."""
    table, options = file.table, file.options
    assignments = {role: assign_role(table, role, options) for role in _ROLES}
    other = _find_loss_substitute(file)
    size = file.column("complex_modulus")
    size = None if options.storage else size
    separate = _has_both_columns(assignments) and not options.loss_factor
    if options.loss or separate or other is None:
        if size and not separate:
            _require_loss_angle(file, table.columns[size.index].name)
        return assignments
    if isinstance(other, Question):
        return {**assignments, "loss": other, "storage": size or assignments["storage"]}
    del assignments["loss"]
    assignments[other.role] = other
    if size and _is_size(file, size, assignments):
        assignments["storage"] = size
    return assignments


def _hint(file: OpenedFile, assignments: Mapping[Role, RoleAssignment | Question]) -> str:
    """Return the actual kind of the file, where a column is not found."""
    if not any(isinstance(assignment, Question) for assignment in assignments.values()):
        return ""
    kind, reason = detect_table_kind(file.table, file.options)
    return "" if kind in {"dma", "unclear"} else f" (it is not a DMA test: {reason})"


def _refuse_equal_columns(file: OpenedFile, columns: Sequence[RoleAssignment]) -> None:
    """Refuse one column for storage and loss."""
    modulus_columns = [column.index for column in columns if column.role in {"storage", "loss"}]
    if len(modulus_columns) == len(set(modulus_columns)):
        return
    raise ReadError(
        f"only '{file.table.columns[modulus_columns[0]].name}' could be storage or loss, and it is "
        "not both; expected a column of each, or of storage and loss factor, or of |K*| and loss "
        "angle: name the columns with --column ROLE=NAME (storage, loss, loss-factor; magnitude, "
        "phase)"
    )


def _has_both_columns(assignments: Mapping[Role, RoleAssignment | Question]) -> bool:
    """Return whether storage and loss are columns of their own."""
    pair = [assignments["storage"], assignments["loss"]]
    at = {assignment.index for assignment in pair if isinstance(assignment, RoleAssignment)}
    return len(at) == len(pair)


def _find_loss_substitute(file: OpenedFile) -> RoleAssignment | Question | None:
    """Return the column of the loss factor, or else of the loss angle.

    Where several could be the one, or the other, what to ask.
    """
    roles: list[Role] = ["loss_factor", "loss_angle"]
    if file.options.phase and not file.options.loss_factor:
        roles.reverse()
    for role in roles:
        assignment = assign_role(file.table, role, file.options)
        if isinstance(assignment, RoleAssignment) or assignment.choices:
            return assignment
    return None


def _require_loss_angle(file: OpenedFile, name: str) -> None:
    """Refuse the size of the complex modulus without its angle."""
    if vocabulary.names_magnitude(name) or file.options.magnitude:
        raise ReadError(
            f"'{name}' is the size |K*|, and no column is its loss angle or loss factor; "
            "expected one of these beside it (--column phase=NAME or loss-factor=NAME), or "
            "storage and loss"
        )


def _is_size(
    file: OpenedFile, size: RoleAssignment, assignments: Mapping[Role, RoleAssignment | Question]
) -> bool:
    """Return whether a column is the size of the complex modulus: its name, or the user, says so.

    Raises
    ------
    ReadError
        If the name says neither that nor storage.
    """
    columns, storage = file.table.columns, assignments["storage"]
    if file.options.magnitude or vocabulary.names_magnitude(columns[size.index].name):
        is_named = isinstance(storage, RoleAssignment) and storage.index != size.index
        return bool(file.options.magnitude) or not is_named
    if isinstance(storage, Question) or (
        vocabulary.matches(columns[storage.index].name).get("storage", 0.0) < 1.5
    ):
        name = quote_column(columns, size.index)
        raise ReadError(
            f"{format_column(columns, size.index)} could be the storage part K' or the size |K*|, "
            "which "
            f'is larger by 1 / cos(delta); say which: --column storage="{name}" or --column '
            f'magnitude="{name}"'
        )
    return False


def load_parts(
    file: OpenedFile, channels_chosen: Sequence[Channel], ratio: int | None
) -> tuple[LoadedColumns, dict[Role, FloatArray], str, list[str]]:
    """Return the loaded rows, the SI values by role with storage and loss, their unit and notes.

    K' = |K*| cos delta and K'' = K' tan delta, where the file has these instead.

    Raises
    ------
    ReadError
        If storage and loss are of two kinds, or an angle is not that of a solid.
    """
    column_by_role = {c.role: c for c in channels_chosen}
    base = column_by_role["storage" if "storage" in column_by_role else "complex_modulus"]
    indexes = [c.index for c in channels_chosen] + ([] if ratio is None else [ratio])
    assignment = file.column("loss_factor") if "loss" in column_by_role else None
    columns = [*indexes, *([assignment.index] if assignment else [])]
    loaded_columns = channels.load(file.table, columns, file.options.segment)
    reported = loaded_columns.values[:, -1]
    loaded_columns = replace(loaded_columns, values=loaded_columns.values[:, : len(indexes)])
    loaded_columns = channels.fill_down(loaded_columns, [c.role for c in channels_chosen])
    rows, gaps = channels.select_complete_rows(loaded_columns)
    values = channels.convert_signals_to_si(rows, channels_chosen)
    warmth = [column_by_role["temperature"]] if "temperature" in column_by_role else []
    notes = [*file.table.notes, *gaps, *channels.describe_alternatives(file, warmth)]
    if "loss" in column_by_role:
        if base.unit.dimension != column_by_role["loss"].unit.dimension:
            raise ReadError(
                f"storage is a {base.unit.dimension} and loss a "
                f"{column_by_role['loss'].unit.dimension}; "
                "expected both in one kind of unit, such as MPa or N/mm"
            )
        if assignment is not None:
            reported = reported[np.isfinite(loaded_columns.values).all(axis=1)]
            notes += _check_loss_factor(
                file, column_by_role["loss"].index, assignment.index, reported, values
            )
        return loaded_columns, values, si_unit(base.unit.dimension).word, notes
    if ratio is None:
        angle = column_by_role["loss_angle"]
        tangent = np.tan(_solid_angle(file, angle, values["loss_angle"]))
        message = f"the tangent of '{file.table.columns[angle.index].name}'"
    else:
        factor = file.table.columns[ratio]
        tangent, message = rows[:, -1] / (100 if factor.unit == "%" else 1), f"'{factor.name}'"
    if base.role == "complex_modulus":
        values["storage"] = values["complex_modulus"] / np.sqrt(1 + tangent**2)
        notes.append(
            f"storage is '{file.table.columns[base.index].name}', taken as the size |K*|, times "
            "the cosine of the loss angle; if it is storage itself, name it with --column "
            "storage=NAME"
        )
    values["loss"] = values["storage"] * tangent
    notes.append(f"loss is storage times {message}")
    return loaded_columns, values, si_unit(base.unit.dimension).word, notes


def _check_loss_factor(
    file: OpenedFile,
    loss: int,
    factor: int,
    reported: FloatArray,
    values: Mapping[Role, FloatArray],
) -> list[str]:
    """Return a note if the loss factor is not loss over storage; ask if it is far off."""
    columns = file.table.columns
    reported = reported / (100 if columns[factor].unit == "%" else 1)
    valid = np.isfinite(reported) & (reported > 0) & (values["storage"] > 0) & (values["loss"] > 0)
    if not valid.any():
        return []
    times = median((reported * values["storage"] / np.where(valid, values["loss"], 1.0))[valid])
    if max(times, 1 / times) <= _LOSS_FACTOR_TOLERANCE:
        return []
    message = (
        f"{format_column(columns, factor)} is {times:.3g} times loss over storage, "
        f"{format_column(columns, loss)} over the other"
    )
    if max(times, 1 / times) <= _MAX_DEVIATION or file.options.loss:
        return [f"{message}; the loss was taken"]
    raise ReadError(
        f"{message}: a unit or a column is wrong; say which is right: --column "
        f'loss="{quote_column(columns, loss)}" or --column '
        f'loss-factor="{quote_column(columns, factor)}"'
    )


def _solid_angle(file: OpenedFile, channel: Channel, angle: FloatArray) -> FloatArray:
    """Refuse values that are no loss angle of a solid; ask for the unit if it is likely wrong."""
    name, degree = format_column(file.table.columns, channel.index), math.pi / 180
    low, high = float(angle.min(initial=0.0)), float(angle.max(initial=0.0))
    raw = high / channel.unit.factor
    if low < 0:
        raise ReadError(
            f"{name} falls to {low / degree:.3g} deg; expected the loss angle, by which the force "
            "leads the motion, of 0 to 90 deg: if it is the angle of the motion to the force, "
            "write it into the file with its sign turned"
        )
    if channel.unit.word == "rad" and raw >= math.pi / 2:
        raise ReadError(
            f"{name} goes to {raw:.3g} rad, where a loss angle stays below 1.57: is the unit deg? "
            'Then add --units "phase=deg"'
        )
    if (
        channel.unit.word != "rad"
        and 0 < raw < math.pi / 2
        and not channels.is_stated(file, channel)
    ):
        raise ReadError(
            f"{name} goes to no more than {raw:.3g} deg: is the unit rad? Then add "
            '--units "phase=rad"; if it is meant so, say it: --units "phase=deg"'
        )
    if high >= math.pi / 2:
        raise ReadError(
            f"{name} goes to {high / degree:.3g} deg; expected the loss angle of a solid, of 0 to "
            "90 deg: leave out the lines beyond, where the machine or a mass resonates"
        )
    return angle
