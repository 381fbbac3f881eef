"""Dataclasses whose methods are compiled at first use.

:func:`dataclasses.dataclass` compiles six functions of each class when its module is imported,
which was a third of the CPU of a short command. Here only `__init__` is compiled, at the first
instance of the class.
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

    def dataclass(*, frozen: bool, eq: bool = True, repr: bool = True, **options: bool):
        """Decorate a class as ``dataclasses.dataclass`` does, `__init__` on first use.

        Parameters
        ----------
        frozen : bool
            False of values that change, which are then compared by identity.
        eq, repr : bool
        **options : bool
            Such as ``kw_only``.
        """

        def add_methods(kind: type) -> type:
            dataclasses.dataclass(init=False, repr=False, eq=False, **options)(kind)
            methods = _build_methods(kind)
            if not repr:
                del methods["__repr__"]
            if not (eq and frozen):
                del methods["__eq__"], methods["__hash__"]
            if not frozen:
                del methods["__setattr__"], methods["__delattr__"]
            for name, method in methods.items():
                if vars(kind).get(name) is None:
                    setattr(kind, name, method)
            return kind

        return add_methods


class _Unset:
    """Default of a parameter whose field has a factory."""

    def __repr__(self) -> str:
        return "<factory>"


_UNSET = _Unset()


class _Constructor:
    """Descriptor in place of ``__init__`` that compiles it on first access."""

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
        key = _build_comparison_key(kind)
        return key(self) == key(other)

    @recursive_repr()
    def represent(self: Any) -> str:
        texts = (f"{item.name}={getattr(self, item.name)!r}" for item in fields(kind) if item.repr)
        return f"{self.__class__.__qualname__}({', '.join(texts)})"

    def refuse_change(self: Any, name: str, *value: object) -> None:
        action = "assign to" if value else "delete"
        if type(self) is kind or name in {item.name for item in fields(kind)}:
            raise FrozenInstanceError(f"cannot {action} field {name!r}")
        getattr(super(kind, self), "__setattr__" if value else "__delattr__")(name, *value)

    return {
        "__init__": _Constructor(kind),
        "__repr__": represent,
        "__eq__": equals,
        "__hash__": lambda self: hash(_build_comparison_key(kind)(self)),
        "__setattr__": refuse_change,
        "__delattr__": refuse_change,
    }


@cache
def _build_comparison_key(kind: Any) -> Callable[[Any], Any]:
    """Return the function from a value to the tuple of its compared fields."""
    names = [item.name for item in fields(kind) if item.compare]
    if len(names) > 1:
        return attrgetter(*names)
    return lambda value: tuple(getattr(value, name) for name in names)


def _compile_constructor(kind: type) -> Callable[..., None]:
    """Return ``__init__`` of a dataclass: its parameters, defaults and ``__post_init__``."""
    namespace: dict[str, Any] = {
        "_set": object.__setattr__, "_unset": _UNSET, "__name__": kind.__module__,
    }  # fmt: skip
    positional: list[str] = []
    keyword_only: list[str] = []
    body: list[str] = []
    for item in fields(kind):
        expression, default = item.name, ""
        if item.default is not dataclasses.MISSING:
            namespace[f"_default_{item.name}"] = item.default
            default = f"=_default_{item.name}"
        elif item.default_factory is not dataclasses.MISSING:
            namespace[f"_default_{item.name}"], default = item.default_factory, "=_unset"
            factory_call = f"_default_{item.name}()"
            expression = (
                f"{factory_call} if {item.name} is _unset else {item.name}"
                if item.init
                else factory_call
            )
        elif not item.init:
            continue
        if item.init:
            (keyword_only if item.kw_only else positional).append(item.name + default)
        elif item.default is not dataclasses.MISSING:
            continue
        body.append(f"_set(self, {item.name!r}, {expression})")
    if hasattr(kind, "__post_init__"):
        body.append("self.__post_init__()")
    parameters = ", ".join(["self", *positional, *(["*", *keyword_only] if keyword_only else [])])
    exec("\n ".join((f"def __init__({parameters}):", *body, "pass")), namespace)  # noqa: S102
    function: Any = namespace["__init__"]
    function.__qualname__ = f"{kind.__qualname__}.__init__"
    types = {item.name: item.type for item in fields(kind) if item.init}
    function.__annotations__ = {**types, "return": None}
    return function  # type: ignore[no-any-return]
