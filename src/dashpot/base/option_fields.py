"""A field that users are asked for: declared once, in the noun it fills.

From the declaration come the option of a command, the word that is typed for a value, and what a
page may say in its place.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import Field, field, fields
from typing import Any

from dashpot.base.choices import get_choice_values
from dashpot.base.units import format_command_quantity


def option(default: Any, help: str | None = None, **how: Any) -> Any:
    """Return a dataclass's field that says how users are asked for it.

    `how` holds ``metavar``, ``multiple`` and ``is_flag`` as click knows them; ``unit``, the
    dimension of a quantity, and ``ends`` where two of them make a range; ``choices``, a type of
    :mod:`~dashpot.base.choices`; ``least``, of a whole number; ``above``, of any; ``word``, what
    stands for no number; ``parse``, from what click passes on to what the noun takes, and
    ``typed`` back to texts; ``flag``, the option's name where it is not the field's; ``under``, the
    option that takes it as KEY=VALUE, ``key``, that word where it is not the field's name, and
    ``sign`` in place of "="; ``argument``, the place of what is typed without an option;
    ``decides``, what a job needs it for first.
    """
    if "choices" in how:
        how["choices"] = get_choice_values(how["choices"])
    return field(default=default, metadata={"help": help, **how})


def copy_option(noun: type, name: str, **other: Any) -> Any:
    """Return the field of another noun, but for what is said otherwise here."""
    one = next(one for one in fields(noun) if one.name == name)
    return option(**{"default": one.default, **one.metadata, **other})


def make_nested_options(kind: type, **how: Any) -> Any:
    """Return the field that holds a noun with options of its own."""
    return field(default_factory=kind, metadata={"part": kind, **how})


def iterate_option_fields(noun: Any) -> Iterator[Field[Any]]:
    """Yield the fields of a noun that are options, without those of its parts."""
    for one in fields(noun):
        if "help" in one.metadata and "argument" not in one.metadata:
            yield one


def is_path_field(one: Field[Any]) -> bool:
    """Whether a field holds a path, or several."""
    return one.metadata.get("metavar") in {"FILE", "FRF"}


def flag_of(one: Field[Any]) -> str:
    """Return the option that takes a field, as it is typed: ``--seal-mass``, ``--machine``."""
    how = one.metadata
    return "--" + str(how.get("under", how.get("flag", one.name))).replace("_", "-")


def key_of(one: Field[Any]) -> str:
    """Return the KEY by which an option of KEY=VALUE takes a field: ``ramp-end``."""
    return str(one.metadata.get("key", one.name)).replace("_", "-")


def format_command_words(one: Field[Any], text: str) -> list[str]:
    """Return the words by which a field is typed: ``["--machine", "sync=0.5ms"]``."""
    if "under" not in one.metadata:
        return [flag_of(one), text]
    return [flag_of(one), f"{key_of(one)}{one.metadata.get('sign', '=')}{text}"]


def flags_of(noun: type) -> str:
    """Return the options of a noun as a sentence lists them.

    >>> from dashpot.workflow.job import Cuts
    >>> flags_of(Cuts)
    '--cuts'
    """
    *others, last = dict.fromkeys(map(flag_of, iterate_option_fields(noun)))
    return f"{', '.join(others)} and {last}" if others else last


def words_of(noun: Any, *names: str) -> list[str]:
    """Return the options that say what a noun says, or these fields of it, as they are typed.

    Nothing of its defaults; its parts say theirs.

    >>> from dashpot.reading.read_options import ReadOptions
    >>> words_of(ReadOptions(units={"force": "N"}, skip_rows=3))
    ['--units', 'force=N', '--text', 'skip=3']
    """
    said: list[str] = []
    for glob, own in getattr(noun, "own", ()):
        words = iter(words_of(own))
        said += [word for flag in words for word in (flag, f"{glob}:{next(words)}")]
    for one in fields(noun):
        value = getattr(noun, one.name)
        if names and one.name not in names:
            continue
        if "part" in one.metadata:
            said += words_of(value)
        elif value != one.default and one in iterate_option_fields(noun):
            if "is_flag" in one.metadata:
                said.append(flag_of(one))
            else:
                said += [
                    word
                    for text in texts_of(one, value)
                    for word in format_command_words(one, text)
                ]
    return said


def texts_of(one: Field[Any], value: Any) -> list[str]:
    """Return a field's value as it is typed, one text for every time."""
    how = one.metadata
    if "typed" in how:
        return list(how["typed"](value))
    if "ends" in how:
        return [f"{value[0]!r}:{format_command_quantity(value[1], how['unit'])}"]
    several = value if isinstance(value, tuple) else (value,)
    if "unit" in how:
        return [format_command_quantity(each, how["unit"]) for each in several]
    return [repr(each).removesuffix(".0") if isinstance(each, float) else str(each)
            for each in several]  # fmt: skip
