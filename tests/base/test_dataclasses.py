"""Dataclasses made on first use are those of the standard library."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import re
from dataclasses import FrozenInstanceError, field, fields, is_dataclass, replace
from pathlib import Path

import pytest

from dashpot.base.dataclasses import dataclass


class Point:
    """A value with defaults of every kind, and names that its methods use."""

    name: str
    x: float = 1.0
    tags: tuple[str, ...] = field(default_factory=tuple)
    hidden: int = field(default=3, repr=False, compare=False)
    made: list[int] = field(init=False, default_factory=list, compare=False)
    set: float = 2.0
    unset: float = 3.0
    last: float = field(default=0.0, kw_only=True)

    def __post_init__(self):
        object.__setattr__(self, "post", (*self.tags, self.name))


class Single:
    """A value of one field, with a hash of its own."""

    value: float

    def __hash__(self):
        return 7


def make(kind, by, **how):
    """Return the class as a decorator makes it."""
    body = {key: item for key, item in vars(kind).items() if key not in {"__dict__", "__weakref__"}}
    return by(frozen=True, **how)(type(kind.__name__, (), {**body, "__qualname__": kind.__name__}))


CHOICES = [{}, {"eq": False}, {"repr": False}, {"eq": False, "repr": False}, {"kw_only": True}]


@pytest.fixture(params=CHOICES, ids=str)
def pair(request):
    """The class of the standard library and ours."""
    return [make(Point, by, **request.param) for by in (dataclasses.dataclass, dataclass)]


def test_a_dataclass_has_the_members_of_the_standard_library(pair):
    theirs, ours = pair
    assert inspect.signature(theirs) == inspect.signature(ours) or (
        str(inspect.signature(theirs)) == str(inspect.signature(ours))
    )
    assert theirs.__match_args__ == ours.__match_args__
    assert set(vars(ours)) == set(vars(theirs)) | {"__init__"}
    assert ours.__init__.__annotations__ == theirs.__init__.__annotations__
    assert ours.__init__.__qualname__ == theirs.__init__.__qualname__
    assert is_dataclass(ours)
    assert [str(item) for item in fields(ours)] == [str(item) for item in fields(theirs)]


def test_values_compare_print_and_copy_as_those_of_the_standard_library(pair):
    outcomes = []
    for kind in pair:
        values = [kind(name="a"), kind(name="a", hidden=9), kind(name="b", tags=("t",), last=2.0)]
        outcomes.append(
            [
                [value == other for value in values for other in values],
                [repr(value).partition(" object at ")[0] for value in values],
                [hash(value) == hash(other) for value in values for other in values],
                values[0] == 1,
                dataclasses.asdict(replace(values[2], x=4.0, name="c")),
                vars(copy.deepcopy(values[2])),
                vars(kind(name="c", x=2.0)),
            ]
        )
    assert outcomes[0] == outcomes[1]


def test_a_frozen_value_refuses_changes_in_the_words_of_the_standard_library(pair):
    message = []
    for kind in pair:
        value = kind(name="a")
        for change, words in ((setattr, ("x", 1)), (delattr, ("name",)), (setattr, ("other", 1))):
            with pytest.raises(FrozenInstanceError) as error:
                change(value, *words)
            message.append(str(error.value))
        for words in ({}, {"name": "a", "wrong": 1}):
            with pytest.raises(TypeError) as error:
                kind(**words)
            message.append(str(error.value))
    assert message[: len(message) // 2] == message[len(message) // 2 :]


def test_dataclass_keeps_a_hash_of_the_class():
    kind = make(Single, dataclass)
    assert hash(kind(1.0)) == 7
    assert kind(1.0) == kind(1.0) != kind(2.0)


@dataclass(frozen=False)
class Count:
    """A value that changes."""

    number: int
    names: list[str] = field(default_factory=list)


def test_unfrozen_value_changes_and_equals_only_itself():
    count, other = Count(1), Count(1)
    count.number += 2
    del other.number
    assert str(count) == "Count(number=3, names=[])"
    assert not hasattr(other, "number")
    assert count.names is not other.names
    assert len({count, Count(3)}) == 2
    assert count != Count(3)


@dataclass(frozen=True)
class Base:
    """A value with a field of its own."""

    first: int

    def double(self):
        return 2 * self.first


@dataclass(frozen=True)
class DerivedValue(Base):
    """A value of a class that inherits."""

    second: int = 2

    def double(self):
        return super().double() + self.second


class PlainSubclass(DerivedValue):
    """A subclass that is no dataclass may have more."""


def test_inherited_fields_come_first():
    value = DerivedValue(1)
    assert (value.first, value.second, value.double()) == (1, 2, 4)
    assert value == copy.deepcopy(value) == replace(value)
    assert Base(1) != value
    assert str(Base(1)) == "Base(first=1)"
    plain = PlainSubclass(1)
    plain.more = 3
    with pytest.raises(FrozenInstanceError):
        plain.first = 2
    del plain.more
    assert plain == PlainSubclass(1)
    assert "__init__" not in vars(PlainSubclass)


SOURCE = Path(__file__).resolve().parents[2] / "src" / "dashpot"
MIXED = {"extensions/systems/door/closing.py", "extensions/formats/mdf4.py"}
"""Modules that have values which change, too."""


def test_frozen_dataclasses_of_the_source_are_made_on_first_use():
    """Take `dataclass` from `dashpot.base`: the standard library's costs 0.2 to 0.6 ms a class."""
    eager = {
        path.relative_to(SOURCE).as_posix()
        for path in SOURCE.rglob("*.py")
        if re.search(
            r"^from dataclasses import .*\bdataclass\b", text := path.read_text("utf-8"), re.M
        )
        and re.search(r"@dataclass\(frozen=True(?!, slots)", text)
    }
    assert eager - MIXED == set()
