"""Frozen dataclasses whose methods are made when they are first used.

:func:`dataclasses.dataclass` compiles six functions of each class when its module is imported,
which was a third of the CPU of a short command. Here `__init__` is compiled when the first value of
the class is made, and nothing else is.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import FrozenInstanceError, field, fields, replace
from functools import cache
from operator import attrgetter
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

__all__ = ("dataclass", "field", "fields", "replace")

if TYPE_CHECKING:
    from dataclasses import dataclass
else:

    def dataclass(*, frozen: bool, eq: bool = True, repr: bool = True, **how: bool):
        """Return what makes a class a dataclass, as that of the standard library does.

        Parameters
        ----------
        frozen : bool
            True; use the standard library's for others.
        eq, repr : bool
        **how : bool
            Such as ``kw_only``.
        """
        assert frozen  # noqa: S101

        def add_methods(kind: type) -> type:
            dataclasses.dataclass(init=False, repr=False, eq=False, **how)(kind)
            methods = _build_methods(kind)
            if not repr:
                del methods["__repr__"]
            if not eq:
                del methods["__eq__"], methods["__hash__"]
            for name, method in methods.items():
                if vars(kind).get(name) is None:
                    setattr(kind, name, method)
            return kind

        return add_methods


class _Unset:
    """The default of a parameter whose value a factory makes."""

    def __repr__(self) -> str:
        return "<factory>"


_UNSET = _Unset()


class _Constructor:
    """``__init__`` of a class until it is first looked up, which compiles it."""

    def __init__(self, kind: type) -> None:
        self._kind = kind

    def __get__(self, value: object, owner: type | None = None) -> Any:
        function: Any = _compile_constructor(self._kind)
        self._kind.__init__ = function  # type: ignore[misc]
        return function.__get__(value, owner)


def _build_methods(kind: Any) -> dict[str, Any]:
    """Return the methods of a frozen dataclass by name."""

    def equals(self: Any, other: object) -> Any:
        if other.__class__ is not self.__class__:
            return NotImplemented
        pick = _build_pick(kind)
        return pick(self) == pick(other)

    @recursive_repr()
    def represent(self: Any) -> str:
        cells = (f"{item.name}={getattr(self, item.name)!r}" for item in fields(kind) if item.repr)
        return f"{self.__class__.__qualname__}({', '.join(cells)})"

    def refuse(self: Any, name: str, *value: object) -> None:
        change = "assign to" if value else "delete"
        if type(self) is kind or name in {item.name for item in fields(kind)}:
            raise FrozenInstanceError(f"cannot {change} field {name!r}")
        getattr(super(kind, self), "__setattr__" if value else "__delattr__")(name, *value)

    return {
        "__init__": _Constructor(kind),
        "__repr__": represent,
        "__eq__": equals,
        "__hash__": lambda self: hash(_build_pick(kind)(self)),
        "__setattr__": refuse,
        "__delattr__": refuse,
    }


@cache
def _build_pick(kind: Any) -> Callable[[Any], Any]:
    """Return what picks the compared fields of a value, as a tuple."""
    names = [item.name for item in fields(kind) if item.compare]
    if len(names) > 1:
        return attrgetter(*names)
    return lambda value: tuple(getattr(value, name) for name in names)


def _compile_constructor(kind: type) -> Callable[..., None]:
    """Return ``__init__`` of a dataclass: its parameters, defaults and ``__post_init__``."""
    names: dict[str, Any] = {
        "_set": object.__setattr__, "_unset": _UNSET, "__name__": kind.__module__,
    }  # fmt: skip
    ordinary: list[str] = []
    by_name: list[str] = []
    body: list[str] = []
    for item in fields(kind):
        value, default = item.name, ""
        if item.default is not dataclasses.MISSING:
            names[f"_{item.name}"], default = item.default, f"=_{item.name}"
        elif item.default_factory is not dataclasses.MISSING:
            names[f"_{item.name}"], default = item.default_factory, "=_unset"
            made = f"_{item.name}()"
            value = f"{made} if {item.name} is _unset else {item.name}" if item.init else made
        elif not item.init:
            continue
        if item.init:
            (by_name if item.kw_only else ordinary).append(item.name + default)
        elif item.default is not dataclasses.MISSING:
            continue
        body.append(f"_set(self, {item.name!r}, {value})")
    if hasattr(kind, "__post_init__"):
        body.append("self.__post_init__()")
    parameters = ", ".join(["self", *ordinary, *(["*", *by_name] if by_name else [])])
    exec("\n ".join((f"def __init__({parameters}):", *body, "pass")), names)  # noqa: S102
    function: Any = names["__init__"]
    function.__qualname__ = f"{kind.__qualname__}.__init__"
    types = {item.name: item.type for item in fields(kind) if item.init}
    function.__annotations__ = {**types, "return": None}
    return function  # type: ignore[no-any-return]
