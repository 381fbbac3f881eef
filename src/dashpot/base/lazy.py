"""Public names of a room, each imported when it is first used: they stand in ``__init__.pyi``."""

from __future__ import annotations

import ast
import sys
from collections.abc import Callable
from importlib import import_module
from importlib.util import resolve_name
from pathlib import Path
from types import ModuleType
from typing import Any


def names_of(
    package: str, file: str
) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return ``__getattr__``, ``__dir__`` and ``__all__`` of a module whose stub stands beside it.

    A line of the stub names the module that a name is of, in whatever room: a low room offers so
    what stands in a higher one, and imports none of it.
    """
    stub = ast.parse(Path(file).with_suffix(".pyi").read_text(encoding="utf-8"))
    homes = {
        alias.name: resolve_name("." * line.level + (line.module or ""), package)
        for line in stub.body
        if isinstance(line, ast.ImportFrom)
        for alias in line.names
    }

    def find(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        if homes[name] == package:  # a room within the room
            return import_module(f"{package}.{name}")
        home = import_module(homes[name])
        # a room that nobody has opened yet is no attribute of the one that it is in
        return (
            getattr(home, name) if hasattr(home, name) else import_module(f"{home.__name__}.{name}")
        )

    names = sorted(homes)
    return find, lambda: names, names


class Face(ModuleType):
    """A package some of whose public verbs bear the names of rooms: what is meant is the verb.

    A room that is imported is set as an attribute of its package, which would hide the verb.
    """

    def __setattr__(self, name: str, value: object) -> None:
        room = isinstance(value, ModuleType) and value.__name__ == f"{self.__name__}.{name}"
        if not (room and name in self.VERBS):
            super().__setattr__(name, value)


def verbs_first(package: str, *verbs: str) -> None:
    """Let these names of a package be its verbs, whatever rooms of these names are imported."""
    module = sys.modules[package]
    module.VERBS = frozenset(verbs)  # type: ignore[attr-defined]
    module.__class__ = Face
