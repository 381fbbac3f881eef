"""Assignment of roles to columns, with reasons and open questions."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from itertools import chain
from typing import get_args

import numpy as np

from dashpot.base import dataclass, units
from dashpot.base.arrays import cache_on_record
from dashpot.base.errors import DataError, ReadError
from dashpot.base.lazy import compile_on_use
from dashpot.base.units import Dimension, Unit
from dashpot.reading.columns import vocabulary
from dashpot.reading.columns.header_units import (
    format_unit_multiple,
    parse_response_unit,
    parse_unit_multiple,
    split_factor,
)
from dashpot.reading.columns.vocabulary import DIMENSION, OF_A_PART, Role
from dashpot.reading.read_options import ReadOptions, flag
from dashpot.reading.table import Column, Content, FileTable, Question

EXAMPLE = {
    "time": "s", "displacement": "mm", "force": "N", "acceleration": "m/s^2", "frequency": "Hz",
    "storage": "MPa", "loss": "MPa", "temperature": "degC", "modulus": "MPa", "hammer": "N",
    "phase": "deg", "velocity": "m/s", "creep_compliance": "1/MPa", "stress": "MPa", "strain": "%",
    "stretch": "1", "complex_modulus": "MPa", "loss_angle": "deg",
}  # fmt: skip
"""Most common unit of a role."""
_SCORE_PENALTIES = (
    (vocabulary.COMMANDED, 1.5, None),
    (vocabulary.EXTREMES, 1.0, False),
    (vocabulary.STATIC, 1.5, False),
    (vocabulary.PARTIAL_TIME, 1.0, True),
    (vocabulary.WHOLE_TIME, 0.5, True),
)
"""Words that lower the score of a column, by how much, and whether for time or other roles."""
_WEIGHTS = {"g": "gf", "kg": "kgf", "lb": "lbf"}
_SENSITIVITY = compile_on_use(
    r"\A(\d++\.?\d*+(?:e[+-]?\d{1,3})?|\.\d++)\s*+(m|u|µ)?V\s*+/\s*+\(?([^()]++)\)?\Z",
    re.IGNORECASE,
)
_PLACE = {
    "displacement": 1, "force": 2, "hammer": 1, "storage": 1, "loss": 2, "modulus": 1,
}  # fmt: skip
"""Most common column of a role in a table without names, counted from 0."""
_ANGULAR = ("w", "omega", "ω", "angular", "kreisfrequenz")
_ROLES: tuple[Role, ...] = get_args(Role)
_SUITED = "_suited"
_NOTHING_SAID = ReadOptions()
_EQUAL_SCORE = 0.25
_MAX_LISTED = 12
"""Columns that a message names."""
_MAX_COPIES = 8
"""Columns of which it is asked which is meant, whatever they hold: nobody writes one so often."""
_COPY_TOLERANCE = 1e-3
"""Part of their range by which columns that are written to a few digits may differ."""


@dataclass(frozen=True)
class RoleAssignment:
    """Column with its role, and the reason."""

    role: Role
    index: int
    reason: str
    alternatives: tuple[int, ...] = ()


def option_of(role: Role) -> str:
    """Return the field of the options that names the column of a role."""
    return {"complex_modulus": "magnitude", "loss_angle": "phase"}.get(role, role)


def assign_role(table: FileTable, role: Role, options: ReadOptions) -> RoleAssignment | Question:
    """Return the column of a role, or the question to ask.

    Raises
    ------
    ReadError
        If the options name a column that is not there.
    """
    option = "force" if role == "hammer" and not options.hammer else option_of(role)
    names_or_option = getattr(options, option, None)
    if names_or_option:
        index = find_column(table.columns, str(names_or_option), flag(option))
        return RoleAssignment(role, index, f"named by {flag(option)}")
    suited = _rank_columns(table, role, options)
    if not suited:
        return _ask_missing_role(table, role)
    top, index = suited[0]
    equals = [i for value, i in suited if value > top - _EQUAL_SCORE]
    reason = _reason(table.columns[index], role)
    if len(equals) > 1:
        names = _names(table)
        names_or_option = [
            format_column(table.columns, i, names) for i in sorted(equals)[:_MAX_LISTED]
        ]
        unlisted_count = len(equals) - len(names_or_option)
        equals_text = join_words(
            [*names_or_option, f"{unlisted_count} more"] if unlisted_count else names_or_option
        )
        if len(equals) > _MAX_COPIES or not _same_numbers(table, equals, role, options):
            message = (
                f"{equals_text} could each be the {_word(role)}; say which, for example "
                f'{flag(option)}="{quote_column(table.columns, index, names)}"'
            )
            return Question(message, f"{flag(option)}=NAME", choices=len(equals))
        reason = f"{equals_text} hold the same numbers"
    alternatives = tuple(i for _, i in suited[len(equals) :])
    return RoleAssignment(role, index, reason, alternatives)


def join_words(words: Sequence[str], last: str = "and") -> str:
    """Return words as a sentence lists them: "a, b and c"."""
    return f" {last} ".join(filter(None, [", ".join(words[:-1]), words[-1]]))


def _word(role: Role) -> str:
    """Return a role as people say it."""
    return {"hammer": "hammer force"}.get(role, role.replace("_", " "))


def _same_numbers(
    table: FileTable, indexes: Sequence[int], role: Role, options: ReadOptions
) -> bool:
    """Return whether columns hold one signal, in SI: written twice, or in two units."""
    dimension = DIMENSION.get(role)
    columns = [table.columns[i] for i in indexes]
    words = [get_unit_word(column, role, options) for column in columns]
    new_units = [units.find_unit(word, dimension) if word and dimension else None for word in words]
    if any((unit is None) != (new_units[0] is None) for unit in new_units):
        return False
    # two that differ are enough, and all may not fit in memory
    if len(indexes) > 2 and not _same_numbers(table, indexes[:2], role, options):
        return False
    values = table.load(indexes).values
    for j, unit in enumerate(new_units):
        if unit is not None:
            values[:, j] = unit.factor * values[:, j] + unit.offset
    complete_rows = values[np.isfinite(values).all(axis=1)]
    if not len(complete_rows) or not len(complete_rows) > 0.5 * len(values):
        return False
    difference = np.abs(complete_rows - complete_rows[:, :1]).max(axis=0)
    return bool((difference <= _COPY_TOLERANCE * np.ptp(complete_rows[:, 0])).all())


def _rank_columns(table: FileTable, role: Role, options: ReadOptions) -> list[tuple[float, int]]:
    """Return the columns that could play a role with their scores, the best first."""
    scored = (
        (value, -i) for i, value in score_columns(table, role, options).items() if value >= 1.0
    )
    return [(value, -i) for value, i in sorted(scored, reverse=True)]


def accelerations(
    table: FileTable, taken_columns: Sequence[int], options: ReadOptions
) -> tuple[int, ...]:
    """Return every acceleration column, as named or as found."""
    if options.acceleration:
        return tuple(
            find_column(table.columns, n, "--column acceleration") for n in options.acceleration
        )
    columns = table.columns
    return _likely_accelerations(
        table, options, lambda i: i not in taken_columns and not _is_force(columns[i])
    )


def _likely_accelerations(
    table: FileTable, options: ReadOptions, is_free: Callable[[int], bool] = lambda _: True
) -> tuple[int, ...]:
    scored_columns = score_columns(table, "acceleration", options).items()
    likely_columns = {i: value for i, value in scored_columns if is_free(i)}
    best = max(likely_columns.values(), default=0.0)
    if best < 1.0:  # named so, but in volts or the like: the question is the unit
        candidates = (i for i, column in enumerate(table.columns) if _is_named_acceleration(column))
        return tuple(filter(is_free, candidates))
    return tuple(i for i, value in likely_columns.items() if value >= _floor(best))


def _floor(best: float) -> float:
    """Return the lowest score of an alternative candidate."""
    if best < 2.0:
        return 1.0
    return max(1.5, best - 1.5) if best >= 3.5 else 1.5


def _is_force(column: Column) -> bool:
    return vocabulary.matches(column.name).get("force", 0.0) >= vocabulary.MIN_SCORE


def _is_named_acceleration(column: Column) -> bool:
    message = vocabulary.matches(column.name).get("acceleration", 0.0)
    return column.content == "number" and message >= 2.5


def score_columns(table: FileTable, role: Role, options: ReadOptions) -> Mapping[int, float]:
    """Return the score of each suitable column for a role, by index.

    A table keeps what was found, for there may be thousands of columns.
    """
    entries: dict[object, dict[Role, dict[int, float]]] = vars(table).setdefault(_SUITED, {})
    if options.units not in entries:
        by_role = entries[options.units] = {role: {} for role in _ROLES}
        for i, column in enumerate(table.columns):
            for name, value in scores(column, options).items():
                by_role[name][i] = value
    return entries[options.units][role]


def score(column: Column, role: Role, options: ReadOptions) -> float:
    """Return how well a column's name and unit suit a role; 0 if it cannot play it."""
    return scores(column, options).get(role, 0.0)


def scores(column: Column, options: ReadOptions) -> Mapping[Role, float]:
    """Return how well a column's name and unit suit each of the roles that it can play."""
    if options.units:
        return _scores(column, options)
    return _compute_file_scores(
        vocabulary.find_informative_words(column.name), column.unit, column.content
    )


@lru_cache(maxsize=1 << 16)
def _compute_file_scores(name: str, unit: str | None, content: Content) -> Mapping[Role, float]:
    """Return the scores by the file of columns that differ by a number or have vague names."""
    return _scores(Column(name, unit, content), _NOTHING_SAID)


def _scores(column: Column, options: ReadOptions) -> Mapping[Role, float]:
    words = {column.unit, _get_stated_unit(column, "time", options, by_role=False)} - {None, ""}
    possible_roles = {*vocabulary.matches(column.name), *chain(*map(_find_roles_of_unit, words))}
    entries = {role: _score(column, role, options) for role in possible_roles}
    return {role: value for role, value in entries.items() if value}


@lru_cache(maxsize=1024)
def _find_roles_of_unit(word: str) -> tuple[Role, ...]:
    """Return the roles that a unit word fits."""
    return tuple(role for role in _ROLES if _fits(word, role))


def _score(column: Column, role: Role, options: ReadOptions) -> float:
    if column.content not in ({"number", "clock"} if role == "time" else {"number"}):
        return 0.0
    value = _named_score(column, role, options)
    if value == 0.0:
        return 0.0
    if role != "velocity" and vocabulary.has_word(column.name, vocabulary.DERIVED):
        return 0.5
    if role == "strain" and vocabulary.has_word(column.name, vocabulary.SIDEWAYS):
        return 0.5
    for words, penalty, of_time in _SCORE_PENALTIES:
        if of_time in {None, role == "time"} and vocabulary.has_word(column.name, words):
            value -= penalty
    return value


def _named_score(column: Column, role: Role, options: ReadOptions) -> float:
    """Return the score of a name for a role, one more where the unit fits; 0 if it does not."""
    scores = vocabulary.matches(column.name)
    if role == "magnitude" and "phase" in scores:
        return 0.0  # a part of it
    value = scores.get(role, 0.0)
    is_named = value >= vocabulary.MIN_SCORE
    word = _get_stated_unit(column, role, options, by_role=is_named) or column.unit
    fits = word is not None and _fits(word, role)
    if fits is None:
        return 0.0
    if value or not fits:
        return value + fits
    # "Force" in mm is no force; "x" in N may well be one
    if role == "magnitude":
        return float(max(scores.values(), default=0.0) < 2.0)
    same_dimension_scores = (s for r, s in scores.items() if DIMENSION.get(r) == DIMENSION[role])
    return float(max(same_dimension_scores, default=0.0) < 2.0)


def _fits(word: str, role: Role) -> bool | None:
    """Return whether a unit fits a role; None if it is of another dimension."""
    dimension = DIMENSION.get(role)
    if role == "magnitude":
        return parse_response_unit(word) is not None
    if dimension is None:
        return False
    if units.find_unit(word, dimension) or _find_part_unit(word, role):
        return True
    return False if units.find_unit(word) is None or _SENSITIVITY.match(word) else None


def _find_part_unit(word: str, role: Role) -> Unit | None:
    """Return the unit of a part's stiffness or compliance, where the role may be one of a part."""
    return units.find_unit(word, OF_A_PART[role]) if role in OF_A_PART else None


def _get_stated_unit(
    column: Column, role: Role, options: ReadOptions, *, by_role: bool
) -> str | None:
    if by_role:
        return options.unit_of(role, column.name)
    return options.get_units_by_name().get(column.name.strip().casefold()) if column.name else None


def _reason(column: Column, role: Role) -> str:
    message = vocabulary.matches(column.name).get(role, 0.0)
    dimension = DIMENSION.get(role)
    fits = column.unit is not None and units.find_unit(column.unit, dimension) is not None
    if role == "magnitude" and not message:
        return f"the only column in a unit of a ratio ({column.unit})"
    if message and fits:
        return f"its name says {role}, its unit {column.unit} fits"
    if message:
        return f"its name says {role}"
    return f"the only column in a unit of {dimension} ({column.unit})"


def acceleration_question(table: FileTable) -> Question:
    """Ask for the accelerations if no column is recognised as one."""
    numbers = [i for i, c in enumerate(table.columns) if c.content == "number"]
    column_options = [
        f'--column acceleration="{quote_column(table.columns, i)}"'
        for i in numbers[2:4] or numbers[-1:]
    ]
    message = (
        f"none of its columns ({_all_columns(table)}) looks like acceleration. Name each "
        f"by its name or number: {' '.join(column_options)}"
    )
    return Question(
        message, "--column acceleration=NAME", role="acceleration", example=" ".join(column_options)
    )


def _names_something(column: Column) -> bool:
    """Return whether a name surely has a meaning."""
    return max(vocabulary.matches(column.name).values(), default=0.0) >= 2.0


def _ask_missing_role(table: FileTable, role: Role) -> Question:
    """Ask for the column of a role without one, and name a column with a contradictory label."""
    option = flag(option_of(role))
    answer = f"{option}=NAME"
    for column in _unlike(table):
        if role in DIMENSION and _is_mislabelled(column, role):
            return Question(format_wrong_unit(column, role), answer)
        worded = column.content == "text" and column.unit
        fits = worded and units.find_unit(column.unit or "", DIMENSION.get(role))
        if fits and role in vocabulary.matches(column.name):
            message = (
                f"column '{column.name}' ({_word(role)}) holds words where numbers are expected. "
                f"Take them out of its cells, or name another column: {answer}"
            )
            return Question(message, answer)
    kind = f" (a unit of {DIMENSION[role]} would show it)" if role in DIMENSION else ""
    base_advice, columns = "", table.columns
    motions = _likely_accelerations(table, ReadOptions())
    if role == "hammer" and len(motions) > 1:
        base = max(motions, key=lambda i: vocabulary.has_word(columns[i].name, vocabulary.OF_BASE))
        base_advice = ". Where a base was shaken, name its acceleration: "
        base_advice += f'{flag("base_acceleration")}="{quote_column(columns, base, _names(table))}"'
    if role not in {"time", "acceleration"} and _all_say_something(table):
        message = (
            f"none of its columns ({_all_columns(table)}) looks like {_word(role)}. Export it "
            f"beside them, or name the column whose name misleads: {answer}{base_advice}"
        )
        return Question(message, answer, role=_word(role), example=answer + base_advice)
    example = f'{option}="{_example(table, role)}"{base_advice}'
    if role == "time":
        guess = "If none is, give the sampling rate: --rate 1000Hz"
        example += ". " + ". ".join(table.hints or [guess])
    message = (
        f"none of its columns ({_all_columns(table)}) looks like {_word(role)}{kind}. Name "
        f"it by its name or number: {example}"
    )
    return Question(message, answer, role=_word(role), example=example)


def join_questions(table: FileTable, questions: Sequence[Question]) -> str:
    """Return one sentence for each question, and one for all roles without a column."""
    missing_roles = [question for question in questions if question.role]
    if len(missing_roles) < 2:
        return ". ".join(item.message for item in questions)
    examples = " ".join(item.example for item in reversed(missing_roles))
    message = (
        f"none of its columns ({_all_columns(table)}) looks like "
        f"{join_words([item.role for item in missing_roles], 'or')}. Name each by its name or "
        f"number: {examples}"
    )
    return ". ".join([message, *(question.message for question in questions if not question.role)])


def _is_mislabelled(column: Column, role: Role) -> bool:
    """Return whether the name fits the role best, but the unit fits none of its meanings."""
    word = column.unit
    if not word:
        return False
    message = vocabulary.matches(column.name)
    if message.get(role, 0.0) < max([1.5, *message.values()]):
        return False
    fits = any(units.find_unit(word, DIMENSION[r]) for r in message if r in DIMENSION)
    return not fits and units.find_unit(word) is not None


def _all_say_something(table: FileTable) -> bool:
    """Whether each column of numbers is named for something, and so none is free for another."""
    items = [
        _names_something(column)
        for column in table.columns
        if column.content in {"number", "clock"}
    ]
    return bool(items) and all(items)


def _example(table: FileTable, role: Role) -> str:
    """Return a column that may have the role: its name has no other meaning."""
    numbers = [i for i, c in enumerate(table.columns) if c.content == "number"] or [0]
    example_index = _PLACE.get(role, 0)
    at = numbers[min(example_index, len(numbers) - 1)]
    free = (i for i in (at, *numbers) if not _names_something(table.columns[i]))
    return quote_column(table.columns, next(free, at), _names(table))


def format_wrong_unit(column: Column, role: Role) -> str:
    """Return the sentence for a column whose label is no unit of its role."""
    dimension = DIMENSION[role]
    example = EXAMPLE.get(role, "")
    sensor_unit = "100mV/g" if role == "acceleration" else f"22.5mV/{example}"
    word = column.unit or ""
    names = units.dimensions(word)
    kind = f"a unit of {' or '.join(names)}" if names else "no unit known"
    weight = find_weight(word) if role == "force" else ""
    weight_hint = f'; if they are a weight, add --units "force={weight}"' if weight else ""
    return (
        f"column '{column.name}' is labelled '{column.unit}', {kind}, where a unit of {dimension} "
        f"is expected: the label is wrong, or the signal was never calibrated; if its numbers are "
        f'{example}, add --units "{role}={example}"{weight_hint}; if they are volts, give the '
        f'sensitivity, for example --units "{role}={sensor_unit}"'
    )


def find_weight(word: str | None) -> str:
    """Return the unit of force that a unit of mass over a load means, "" of any other unit.

    >>> find_weight("lbs"), find_weight("N")
    ('lbf', '')
    """
    mass = units.find_unit(word or "", "mass")
    return _WEIGHTS.get(mass.word, "") if mass else ""


def find_column(columns: Sequence[Column], name_or_number: str, option: str) -> int:
    """Return the index of a column given by its name, or by its number from 1.

    Raises
    ------
    ReadError
        If there is no such column, or the name stands twice.
    """
    requested_name = name_or_number.strip().casefold()
    for spell in (str.casefold, vocabulary.normalise_name):
        key = spell(name_or_number.strip())
        hits = [i for i, c in enumerate(columns) if c.name and spell(c.name.strip()) == key]
        if len(hits) == 1:
            return hits[0]
        if len(hits) > 1:
            numbers = " and ".join(str(i + 1) for i in hits)
            raise ReadError(
                f"{option} {name_or_number}: columns {numbers} have that name; give the number "
                "instead"
            )
    if requested_name.isdigit() and 1 <= int(requested_name) <= len(columns):
        return int(requested_name) - 1
    raise ReadError(
        f"{option} {name_or_number}: there is no such column; the columns are "
        f"{list_columns(columns)}"
    )


def get_unit(column: Column, number: int, role: Role, options: ReadOptions) -> Unit:
    """Return the unit of a column in its role.

    Raises
    ------
    ReadError
        If no unit is given, or the one given is unknown or measures something else.
    """
    dimension = DIMENSION[role]
    stated_unit, word = options.unit_of(role, column.name), get_unit_word(column, role, options)
    label, header = _label(column, number, role), _add_unit(column, role)
    advice = f'add --units "{role}={_unit_like(column, role)}"'
    if column.content == "clock" and role == "time":
        return _clock_unit(label, stated_unit)
    if word is None:
        factor_text = f" and, stated beside its numbers, {column.factor}" if column.factor else ""
        raise ReadError(
            f"{label} has no unit{factor_text}; {advice}, or write the unit into the header as "
            f"'{header}'"
        )
    if stated_unit is None:
        _refuse_stated_factor(column, word, role, label)
        _refuse_factor(word, dimension, role, label)
        word = _determine_frequency_unit(word, column, label) if role == "frequency" else word
    try:
        unit_and_factor = sensitivity(word, dimension, column.unit) or parse_unit_multiple(
            word, dimension
        )
        return unit_and_factor or _find_part_unit(word, role) or units.parse_unit(word, dimension)
    except DataError as error:
        wrong = stated_unit is None and units.find_unit(word) is not None
        text = format_wrong_unit(column, role) if wrong else f"{label}: {error}; {advice}"
        if " or " in word:
            text = f"{label} stands under two units, {word}: say which is right: {advice}"
        raise ReadError(text) from None


def _angular(column: Column) -> bool:
    return vocabulary.has_word(column.name, _ANGULAR)


def _determine_frequency_unit(word: str, column: Column, label: str) -> str:
    """The unit of a frequency: 1/s of what is called angular is rad/s, and Hz a contradiction."""
    unit = units.find_unit(word, "frequency")
    if unit is None or unit.word == "rad/s" or not _angular(column):
        return word
    if unit.word == "Hz" and "z" not in word.casefold():
        return "rad/s"
    raise ReadError(
        f"{label} is called an angular frequency and stands in {word}: say which is right with "
        f'--units "frequency={unit.word}" or --units "frequency=rad/s"'
    )


def _refuse_factor(word: str, dimension: Dimension, role: Role, label: str) -> None:
    """Ask whether a factor next to a unit has been applied to the numbers."""
    result = split_factor(word)
    unit = result and (units.find_unit(result[1], dimension) or _find_part_unit(result[1], role))
    if not result or not unit or sensitivity(word, dimension, None):
        return
    factor, plain_unit = result[0], unit.word
    larger, smaller = (format_unit_multiple(unit, factor), format_unit_multiple(unit, 1 / factor))
    raise ReadError(
        f"{label} stands under '{word}', a factor and a unit: if its numbers are {plain_unit} as "
        "they "
        f'stand, add --units "{role}={plain_unit}"; if {factor:g} times each is, --units '
        f'"{role}={larger}"; if they are {factor:g} times too large already, --units '
        f'"{role}={smaller}"'
    )


def _refuse_stated_factor(column: Column, word: str, role: Role, label: str) -> None:
    """Ask whether a factor in the header has been applied to the numbers."""
    if not column.factor:
        return
    raise ReadError(
        f"{label} has the unit {word} and, stated beside its numbers, {column.factor}, which no "
        f"rule of this format applies: if its numbers are {word} as they stand, add --units "
        f'"{role}={word}"; if not, give the unit in which they stand, such as --units '
        f'"{role}=10{word}", or apply it in the file'
    )


def get_unit_word(column: Column, role: Role, options: ReadOptions) -> str | None:
    """Return the unit of the column of a role by the options, else by the file; or None."""
    pure = "1" if role == "stretch" else None  # a ratio of lengths
    sentences = (options.unit_of(role, column.name), column.unit, pure)
    return next((word for word in sentences if word is not None), None)


def _label(column: Column, number: int, role: Role) -> str:
    return f"'{column.name or f'column {number}'}' ({role})"


def _add_unit(column: Column, role: Role) -> str:
    """Return the possible unit labels of a column without a unit."""
    return f"{column.name or role} [{_unit_like(column, role)}]"


def _unit_like(column: Column, role: Role) -> str:
    """Return the likeliest unit of a column in a role."""
    if role == "frequency" and _angular(column):
        return "rad/s"
    return "50" * ("full scale" in column.factor) + EXAMPLE.get(role, "UNIT")


def _clock_unit(label: str, stated_unit: str | None) -> Unit:
    """Return seconds, the unit of clock times whatever their heading."""
    if stated_unit is None or stated_unit == "s" or vocabulary.clock_order(stated_unit):
        return units.parse_unit("s", "time")
    raise ReadError(
        f"{label} holds clock times, which have no unit such as '{stated_unit}'; leave that out, "
        "or say "
        'how they are written, for example --units "time=mm:ss" or --units "time=d/m/y"'
    )


def explain_missing_units(table: FileTable, missing_units: Sequence[RoleAssignment]) -> str:
    """Ask for the units of several columns that have none, in one sentence."""
    columns = [table.columns[assignment.index] for assignment in missing_units]
    group = list(zip(columns, missing_units, strict=True))
    labels = [_label(column, assignment.index + 1, assignment.role) for column, assignment in group]
    unit_options = [
        f"{assignment.role}={_unit_like(column, assignment.role)}" for column, assignment in group
    ]
    return (
        f"{labels[0]} has no unit, nor has {join_words(labels[1:], 'or')}; add --units "
        f'"{",".join(dict.fromkeys(unit_options))}", or write them into the header, as '
        f"'{_add_unit(columns[0], missing_units[0].role)}'"
    )


def sensitivity(word: str, dimension: Dimension, column_unit: str | None) -> Unit | None:
    """Return the unit behind a sensitivity such as ``22.5mV/N``: volts divided by it.

    The column is in volts unless it states another unit of voltage.
    """
    match = _SENSITIVITY.match(word.strip())
    if match is None:
        return None
    measured = units.find_unit(match[3], dimension)
    if measured is None or float(match[1]) <= 0:
        return None
    volt = units.parse_unit(f"{match[2] or ''}V", "voltage").factor
    volts = units.find_unit(column_unit, "voltage") if column_unit else None
    factor = (volts.factor if volts else 1.0) * measured.factor / (float(match[1]) * volt)
    return Unit(word, dimension, factor)


def format_column(columns: Sequence[Column], index: int, names: Counter[str] | None = None) -> str:
    """Return a column as the user sees it: its name and unit in quotes, or its number."""
    column = columns[index]
    unit = f" [{column.unit}]" if column.unit else ""
    if quote_column(columns, index, names) == column.name:
        return f"'{column.name}{unit}'"
    quoted_name = f" '{column.name}'" if column.name else ""
    return f"column {index + 1}{quoted_name}{unit}"


def quote_column(columns: Sequence[Column], index: int, names: Counter[str] | None = None) -> str:
    """Return a unique name of a column: its name, or its number where names repeat.

    For many columns the caller counts the names once.
    """
    name = _fold_column_name(columns[index])
    single = (names or _count_column_names(columns))[name] == 1
    return columns[index].name if name and single else str(index + 1)


def _count_column_names(columns: Sequence[Column]) -> Counter[str]:
    return Counter(map(_fold_column_name, columns))


def _fold_column_name(column: Column) -> str:
    return column.name.strip().casefold()


@cache_on_record
def _names(table: FileTable) -> Counter[str]:
    return _count_column_names(table.columns)


@cache_on_record
def _unlike(table: FileTable) -> tuple[Column, ...]:
    """The columns without those that differ from an earlier one by a number alone."""
    columns: dict[object, Column] = {}
    for column in table.columns:
        columns.setdefault(
            (vocabulary.replace_channel_number(column.name), column.unit, column.content), column
        )
    return tuple(columns.values())


@cache_on_record
def _all_columns(table: FileTable) -> str:
    """Return the list of columns for a question, made once for thousands of columns."""
    return list_columns(table.columns)


def list_columns(columns: Sequence[Column]) -> str:
    """Return all columns with their numbers, for a message."""
    filled = [i for i, c in enumerate(columns) if c.content != "blank"]
    names = _count_column_names(columns)
    shown_texts = [
        f"{i + 1} {format_column(columns, i, names) if columns[i].name else '(no name)'}"
        for i in filled[:_MAX_LISTED]
    ]
    unlisted_count = len(filled) - len(shown_texts)
    return ", ".join(shown_texts) + (f" and {unlisted_count} more" if unlisted_count else "")
