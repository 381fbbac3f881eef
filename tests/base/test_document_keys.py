"""Keys of documents: every attribute on the path of a key exists."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import sys
import types
import typing
from collections.abc import Iterator
from dataclasses import dataclass, is_dataclass
from functools import cache, cached_property
from typing import Any

import pytest

import dashpot
from dashpot.base.serialisation import Key, Serialisable, _list_keys


@cache
def list_serialisable_classes() -> tuple[type, ...]:
    """Every class of the package whose document is a list of its attributes."""
    for module in pkgutil.walk_packages(dashpot.__path__, "dashpot."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
    result, waiting = set(), [Serialisable]
    while waiting:
        subclasses = waiting.pop().__subclasses__()
        waiting += [subclass for subclass in subclasses if subclass not in result]
        result |= {
            subclass for subclass in subclasses if subclass.__module__.startswith("dashpot.")
        }
    return tuple(sorted(result, key=lambda class_: (class_.__module__, class_.__qualname__)))


@cache
def list_class_names() -> dict[str, type]:
    """Classes by their name, for annotations whose imports are for type checkers alone."""
    return {
        name: value
        for module in list(sys.modules.values())
        if getattr(module, "__name__", "").startswith("dashpot.")
        for name, value in vars(module).items()
        if inspect.isclass(value) and value.__module__.startswith("dashpot.")
    }


def resolve_annotation(annotation: Any, owner: Any) -> Any:
    """Return the type of an annotation, `Any` where it is not known."""
    if not isinstance(annotation, str):
        return annotation
    names = list_class_names() | vars(typing) | vars(sys.modules[owner.__module__])
    try:
        return eval(annotation, names)  # noqa: S307 -- an annotation of the package
    except (NameError, TypeError):
        return Any


def get_attribute_type(class_: type, name: str) -> Any:
    """Return the type of a field or a property; `AttributeError` where the class has none."""
    for base in class_.__mro__:
        member = vars(base).get(name)
        getter = getattr(member, "fget", None) or getattr(member, "func", None)
        if isinstance(member, property | cached_property) and getter is not None:
            return resolve_annotation(getter.__annotations__.get("return", Any), getter)
        if name in inspect.get_annotations(base):
            return resolve_annotation(inspect.get_annotations(base)[name], base)
        if name in vars(base) and not callable(member):
            return Any  # a constant of the class, or a descriptor of another kind
    raise AttributeError(f"{class_.__qualname__} has no field or property {name!r}")


def iterate_annotated_classes(type_: Any) -> Iterator[type]:
    """Yield the classes of an annotation whose attributes are known: of a union, each."""
    if isinstance(type_, types.UnionType) or typing.get_origin(type_) is typing.Union:
        for member in typing.get_args(type_):
            yield from iterate_annotated_classes(member)
    elif inspect.isclass(type_) and type_.__module__.startswith(("dashpot.", __name__)):
        yield type_


def find_missing_attributes(class_: type) -> list[str]:
    """Return what is missing on the paths of the keys of a class, as far as types are known."""
    missing = []
    for key in _list_keys(class_):
        owners: set[type] = {class_}
        for name in key.path:
            types_ = []
            for owner in owners:
                try:
                    types_.append(get_attribute_type(owner, name))
                except AttributeError as error:
                    missing.append(f"{class_.__qualname__}: {'.'.join(key.path)!r}: {error}")
            owners = {expected for type_ in types_ for expected in iterate_annotated_classes(type_)}
    return missing


@pytest.mark.parametrize(
    "class_",
    [class_ for class_ in list_serialisable_classes() if class_._keys or is_dataclass(class_)],
    ids=lambda class_: class_.__name__,
)
def test_keys_name_attributes_that_exist(class_: type) -> None:
    assert find_missing_attributes(class_) == []


@dataclass(frozen=True)
class Part:
    length: float

    @property
    def half(self) -> Part | None:
        return None


@dataclass(frozen=True)
class Whole(Serialisable):
    part: Part

    @cached_property
    def other(self) -> Part:
        return self.part


@pytest.mark.parametrize(
    "path", ["part", "part.length", "other.length", "part.half.half.length", "part.length.real"]
)
def test_find_missing_attributes_accepts_fields_and_properties(path: str) -> None:
    class_ = type("Known", (Whole,), {"_keys": (Key("number", path), path)})
    assert find_missing_attributes(class_) == []


@pytest.mark.parametrize(
    "path",
    ["parts", "prat.length", "part.lenght", "other.lenght", "part.half.half.lenght", "to_dict"],
)
def test_find_missing_attributes_reports_a_misspelt_path(path: str) -> None:
    class_ = type("Misspelt", (Whole,), {"_keys": ("part", Key("number", path))})
    (message,) = find_missing_attributes(class_)
    assert path in message
