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


def copy_option(cls: type, name: str, **other: Any) -> Any:
    """Return the field of another noun, but for what is said otherwise here."""
    attribute = next(field for field in fields(cls) if field.name == name)
    return option(**{"default": attribute.default, **attribute.metadata, **other})


def make_nested_options(kind: type, **how: Any) -> Any:
    """Return the field that holds a noun with options of its own."""
    return field(default_factory=kind, metadata={"part": kind, **how})


def iterate_option_fields(result: Any) -> Iterator[Field[Any]]:
    """Yield the fields of a noun that are options, without those of its parts."""
    for attribute in fields(result):
        if "help" in attribute.metadata and "argument" not in attribute.metadata:
            yield attribute


def is_path_field(attribute: Field[Any]) -> bool:
    """Whether a field holds a path, or several."""
    return attribute.metadata.get("metavar") in {"FILE", "FRF"}


def flag_of(attribute: Field[Any]) -> str:
    """Return the option that takes a field, as it is typed: ``--seal-mass``, ``--machine``."""
    how = attribute.metadata
    return "--" + str(how.get("under", how.get("flag", attribute.name))).replace("_", "-")


def key_of(attribute: Field[Any]) -> str:
    """Return the KEY by which an option of KEY=VALUE takes a field: ``ramp-end``."""
    return str(attribute.metadata.get("key", attribute.name)).replace("_", "-")


def format_command_words(attribute: Field[Any], text: str) -> list[str]:
    """Return the words by which a field is typed: ``["--machine", "sync=0.5ms"]``."""
    if "under" not in attribute.metadata:
        return [flag_of(attribute), text]
    return [flag_of(attribute), f"{key_of(attribute)}{attribute.metadata.get('sign', '=')}{text}"]


def flags_of(cls: type) -> str:
    """Return the options of a noun as a sentence lists them.

    >>> from dashpot.workflow.job import Cuts
    >>> flags_of(Cuts)
    '--cuts'
    """
    *others, last = dict.fromkeys(map(flag_of, iterate_option_fields(cls)))
    return f"{', '.join(others)} and {last}" if others else last


def words_of(result: Any, *names: str) -> list[str]:
    """Return the options that say what a noun says, or these fields of it, as they are typed.

    Nothing of its defaults; its parts say theirs.

    >>> from dashpot.reading.read_options import ReadOptions
    >>> words_of(ReadOptions(units={"force": "N"}, skip_rows=3))
    ['--units', 'force=N', '--text', 'skip=3']
    """
    sentences: list[str] = []
    for glob, item in getattr(result, "own", ()):
        words = iter(words_of(item))
        sentences += [word for flag in words for word in (flag, f"{glob}:{next(words)}")]
    for attribute in fields(result):
        value = getattr(result, attribute.name)
        if names and attribute.name not in names:
            continue
        if "part" in attribute.metadata:
            sentences += words_of(value)
        elif value != attribute.default and attribute in iterate_option_fields(result):
            if "is_flag" in attribute.metadata:
                sentences.append(flag_of(attribute))
            else:
                sentences += [
                    word
                    for text in texts_of(attribute, value)
                    for word in format_command_words(attribute, text)
                ]
    return sentences


def texts_of(attribute: Field[Any], value: Any) -> list[str]:
    """Return a field's value as it is typed, one text for every time."""
    how = attribute.metadata
    if "typed" in how:
        return list(how["typed"](value))
    if "ends" in how:
        return [f"{value[0]!r}:{format_command_quantity(value[1], how['unit'])}"]
    several = value if isinstance(value, tuple) else (value,)
    if "unit" in how:
        return [format_command_quantity(item, how["unit"]) for item in several]
    return [repr(number).removesuffix(".0") if isinstance(number, float) else str(number)
            for number in several]  # fmt: skip
