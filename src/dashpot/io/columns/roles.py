"""Which column plays which role, why, and what must be asked."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from dashpot.base import units
from dashpot.base.errors import DataError, ReadError
from dashpot.base.units import Dimension, Unit
from dashpot.io.columns import vocabulary
from dashpot.io.columns.vocabulary import DIMENSION, Role
from dashpot.io.options import ReadOptions
from dashpot.io.table import Column, Question, Table

_EXAMPLE = {
    "time": "s", "displacement": "mm", "force": "N", "acceleration": "m/s^2", "frequency": "Hz",
    "storage": "MPa", "loss": "MPa", "temperature": "degC", "modulus": "MPa",
}  # fmt: skip
_MODULI = {"storage", "loss", "modulus"}  # of a part they are stiffnesses
_WEIGHTS = {"g": "gf", "kg": "kgf", "lb": "lbf"}
_SENSITIVITY = re.compile(
    r"([\d.]+(?:e[+-]?\d+)?)\s*(m|u|µ)?V\s*/\s*\(?([^()]+)\)?\Z", re.IGNORECASE
)
_SAME = 0.25


@dataclass(frozen=True)
class Assigned:
    """A column in a role, and the reason why."""

    role: Role
    index: int
    reason: str
    rivals: tuple[int, ...] = ()


def assign(table: Table, role: Role, options: ReadOptions) -> Assigned | Question:
    """Return the column that plays a role, or the question to ask.

    Raises
    ------
    ReadError
        If the options name a column that is not there.
    """
    named = getattr(options, role, None)
    if named:
        index = find_column(table.columns, str(named), f"--{role}")
        return Assigned(role, index, f"named by --{role}")
    scored = sorted(
        ((score(column, role, options), -i) for i, column in enumerate(table.columns)), reverse=True
    )
    scored = [(s, -i) for s, i in scored if s >= 1.0]
    if not scored:
        return Question(_nothing(table, role), f"--{role} NAME")
    top, index = scored[0]
    rivals = tuple(i for s, i in scored[1:] if s > top - _SAME)
    if rivals:
        labels = [quoted(table.columns, i) for i in sorted((index, *rivals))]
        listed = ", ".join(labels[:-1]) + " and " + labels[-1]
        best = handle(table.columns, index)
        return Question(
            f'{listed} could each be the {role}; say which, for example --{role} "{best}"',
            f"--{role} NAME",
        )
    others = tuple(i for _, i in scored[1:])
    return Assigned(role, index, _reason(table.columns[index], role), others)


def accelerations(table: Table, taken: Sequence[int], options: ReadOptions) -> tuple[int, ...]:
    """Return every acceleration column, as named or as found."""
    if options.acceleration:
        return tuple(find_column(table.columns, n, "--acceleration") for n in options.acceleration)
    scores = {
        i: score(column, "acceleration", options)
        for i, column in enumerate(table.columns)
        if i not in taken and vocabulary.matches(column.name).get("force", 0.0) < 1.5
    }
    best = max(scores.values(), default=0.0)
    if best < 1.0:  # named so, but in volts or the like: the question is the unit
        return tuple(i for i in scores if _named(table.columns[i], "acceleration"))
    # one unit-only column beside named ones is something else
    floor = 1.0 if best < 2.0 else 1.5 if best < 3.5 else best - 1.5
    return tuple(i for i, s in scores.items() if s >= max(1.0, floor))


def _named(column: Column, role: Role) -> bool:
    says = vocabulary.matches(column.name).get(role, 0.0)
    return column.content == "number" and says >= 2.5


def score(column: Column, role: Role, options: ReadOptions) -> float:
    """How well a column's name and unit suit a role; 0 if it cannot play it."""
    if column.content not in {"number", "clock"}:
        return 0.0
    if column.content == "clock" and role != "time":
        return 0.0
    says = vocabulary.matches(column.name)
    value = says.get(role, 0.0)
    dimension = DIMENSION.get(role)
    word = _given(column, role, options, by_role=value >= 1.5) or column.unit
    fits = False
    if word is not None and dimension is not None:
        fits = units.find(word, dimension) is not None or (
            role in _MODULI and units.find(word, "stiffness") is not None
        )
        if not fits and units.find(word) is not None and not _SENSITIVITY.match(word):
            return 0.0
    if fits:
        # "Force" in mm is no force; "x" in N may well be one
        other = max(
            (s for r, s in says.items() if r != role and DIMENSION.get(r) == dimension), default=0.0
        )
        value = value + 1.0 if value else (1.0 if other < 2.0 else 0.0)
    if value == 0.0:
        return 0.0
    if vocabulary.has_word(column.name, vocabulary.DERIVED):
        return 0.5
    if vocabulary.has_word(column.name, vocabulary.COMMANDED):
        value -= 1.5
    if role != "time" and vocabulary.has_word(column.name, vocabulary.EXTREMES):
        value -= 1.0
    if role == "time" and vocabulary.has_word(column.name, vocabulary.PARTIAL_TIME):
        value -= 1.0
    return value


def _given(column: Column, role: Role, options: ReadOptions, *, by_role: bool) -> str | None:
    if by_role:
        return options.unit_of(role, column.name)
    return options.by_name().get(column.name.strip().casefold()) if column.name else None


def _reason(column: Column, role: Role) -> str:
    says = vocabulary.matches(column.name).get(role, 0.0)
    dimension = DIMENSION.get(role)
    fits = column.unit is not None and units.find(column.unit, dimension) is not None
    if says and fits:
        return f"its name says {role}, its unit {column.unit} fits"
    if says:
        return f"its name says {role}"
    return f"the only column in a unit of {dimension} ({column.unit})"


def _nothing(table: Table, role: Role) -> str:
    """Why no column was found for a role: a wrong label is worth naming."""
    for column in table.columns:
        says = vocabulary.matches(column.name)
        word = column.unit or ""
        fits = any(r in DIMENSION and units.find(word, DIMENSION[r]) for r in says)
        meant = says.get(role, 0.0) >= max([1.5, *says.values()])
        if meant and not fits and units.find(word) is not None:
            return mislabelled(column, role)
    dimension = DIMENSION.get(role)
    more = ", or --rate 1000Hz if the rows are evenly spaced in time" if role == "time" else ""
    if more and table.hints:
        more = "; " + "; ".join(table.hints)
    kind = f" (a unit of {dimension} would show it)" if dimension else ""
    return (
        f"no column is recognised as {role}{kind}; the columns are {list_columns(table.columns)}; "
        f'name it by its name or number, for example --{role} "{_example(table, role)}"{more}'
    )


def _example(table: Table, role: Role) -> str:
    """A column that could be meant: one whose name says nothing else."""
    numbers = [i for i, c in enumerate(table.columns) if c.content == "number"]
    free = [i for i in numbers if not vocabulary.matches(table.columns[i].name)]
    place = {"displacement": 1, "force": 2}.get(role, 0)
    unnamed = free and not any(table.columns[i].name for i in free)
    index = free[min(place, len(free) - 1)] if unnamed else (free or numbers or [0])[0]
    return handle(table.columns, index) if table.columns else "NAME"


def mislabelled(column: Column, role: Role) -> str:
    """The sentence for a column whose label is no unit of its role."""
    dimension = DIMENSION[role]
    example = _EXAMPLE.get(role, "")
    sensed = "100mV/g" if role == "acceleration" else f"22.5mV/{example}"
    word = column.unit or ""
    found = units.dimensions(word)
    kind = f"a unit of {' or '.join(found)}" if found else "no unit known"
    mass = units.find(word, "mass")
    weight = _WEIGHTS.get(mass.word, "") if mass is not None and role == "force" else ""
    weighed = f'; if they are a weight, add --units "force={weight}"' if weight else ""
    return (
        f"column '{column.name}' is labelled '{column.unit}', {kind}, where a unit of {dimension} "
        f"is expected: the label is wrong, or the signal was never calibrated; if its numbers are "
        f'{example}, add --units "{role}={example}"{weighed}; if they are volts, give the '
        f'sensitivity, for example --units "{role}={sensed}"'
    )


def find_column(columns: Sequence[Column], named: str, option: str) -> int:
    """Return the index of a column given by its name, or by its number from 1.

    Raises
    ------
    ReadError
        If there is no such column, or the name stands twice.
    """
    wanted = named.strip().casefold()
    for spell in (str.casefold, vocabulary.plain):
        key = spell(named.strip())
        hits = [i for i, c in enumerate(columns) if c.name and spell(c.name.strip()) == key]
        if len(hits) == 1:
            return hits[0]
        if len(hits) > 1:
            numbers = " and ".join(str(i + 1) for i in hits)
            raise ReadError(
                f"{option} {named}: columns {numbers} have that name; give the number instead"
            )
    if wanted.isdigit() and 1 <= int(wanted) <= len(columns):
        return int(wanted) - 1
    raise ReadError(
        f"{option} {named}: there is no such column; the columns are {list_columns(columns)}"
    )


def unit_for(column: Column, number: int, role: Role, options: ReadOptions) -> Unit:
    """Return the unit of a column in its role.

    Raises
    ------
    ReadError
        If no unit is given, or the one given is unknown or measures something else.
    """
    dimension = DIMENSION[role]
    said = options.unit_of(role, column.name)
    example = _EXAMPLE.get(role, "")
    label = column.name or f"column {number}"
    if said is None and column.unit is None:
        raise ReadError(
            f"'{label}' ({role}) has no unit; add --units \"{role}={example}\", or write the unit "
            f"into the header as '{column.name or role} [{example}]'"
        )
    word = said if said is not None else str(column.unit)
    scaled = sensitivity(word, dimension, column.unit if said is not None else None)
    if scaled is not None:
        return scaled
    try:
        return _modulus_or(word, role, dimension)
    except DataError as error:
        if said is None and units.find(word) is not None:
            raise ReadError(mislabelled(column, role)) from None
        raise ReadError(f"'{label}' ({role}): {error}; add --units \"{role}={example}\"") from None


def _modulus_or(word: str, role: Role, dimension: Dimension) -> Unit:
    if role in _MODULI and (stiffness := units.find(word, "stiffness")) is not None:
        return stiffness
    return units.parse_unit(word, dimension)


def sensitivity(word: str, dimension: Dimension, column_unit: str | None) -> Unit | None:
    """Return the unit behind a sensitivity such as ``22.5mV/N``: volts divided by it.

    The column is taken to be in volts unless it says another unit of voltage.
    """
    match = _SENSITIVITY.match(word.strip())
    if match is None:
        return None
    measured = units.find(match[3], dimension)
    if measured is None or float(match[1]) <= 0:
        return None
    prefix = {"m": 1e-3, "u": 1e-6, "µ": 1e-6}.get(match[2] or "", 1.0)
    volts = units.find(column_unit, "voltage") if column_unit else None
    factor = (volts.factor if volts else 1.0) * measured.factor / (float(match[1]) * prefix)
    return Unit(word, dimension, factor)


def quoted(columns: Sequence[Column], index: int) -> str:
    """A column as the user sees it: its name and unit in quotes, or its number."""
    column = columns[index]
    unit = f" [{column.unit}]" if column.unit else ""
    if handle(columns, index) == column.name:
        return f"'{column.name}{unit}'"
    named = f" '{column.name}'" if column.name else ""
    return f"column {index + 1}{named}{unit}"


def handle(columns: Sequence[Column], index: int) -> str:
    """What names one column and no other: its name, or its number where names repeat."""
    name = columns[index].name.strip().casefold()
    alone = sum(column.name.strip().casefold() == name for column in columns) == 1
    return columns[index].name if name and alone else str(index + 1)


def list_columns(columns: Sequence[Column]) -> str:
    """All columns with their numbers, for a message."""
    shown = [
        f"{i + 1} {quoted(columns, i) if c.name else '(no name)'}"
        for i, c in enumerate(columns)
        if c.content != "blank"
    ]
    return ", ".join(shown[:12]) + (f" and {len(shown) - 12} more" if len(shown) > 12 else "")
