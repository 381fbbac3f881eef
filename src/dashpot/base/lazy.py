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


def build_lazy_exports(
    package: str, file: str
) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return ``__getattr__``, ``__dir__`` and ``__all__`` of a module whose stub stands beside it.

    A line of the stub names the module that a name is of, in whatever room: a low room offers so
    what stands in a higher one, and imports none of it.
    """
    stub = ast.parse(Path(file).with_suffix(".pyi").read_text(encoding="utf-8"))
    homes = {
        alias.asname or alias.name: (
            resolve_name("." * line.level + (line.module or ""), package),
            alias.name,
        )
        for line in stub.body
        if isinstance(line, ast.ImportFrom)
        for alias in line.names
    }
    # ``_name``: where a name is whose signature another line of the stub names
    homes |= {name[1:]: homes.pop(name) for name in list(homes) if name[1:] in homes}

    for line in stub.body:  # ``public = _imported``: another public name of what a line imports
        if isinstance(line, ast.Assign):
            homes[ast.unparse(line.targets[0])] = homes.pop(ast.unparse(line.value))

    def find(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        module, text = homes[name]
        if module == package:  # a submodule
            return import_module(f"{package}.{text}")
        home = import_module(module)
        # a submodule that nobody has imported yet is no attribute of its package
        return getattr(home, text) if hasattr(home, text) else import_module(f"{module}.{text}")

    names = sorted(homes)
    return find, lambda: names, names


class LazyPackage(ModuleType):
    """A package some of whose public verbs bear the names of rooms: what is meant is the verb.

    A room that is imported is set as an attribute of its package, which would hide the verb.
    """

    def __setattr__(self, name: str, value: object) -> None:
        fits = isinstance(value, ModuleType) and value.__name__ == f"{self.__name__}.{name}"
        if not (fits and name in self.VERBS):
            super().__setattr__(name, value)


def set_package_functions(package: str, *verbs: str) -> None:
    """Let these names of a package be its verbs, whatever rooms of these names are imported."""
    module = sys.modules[package]
    module.VERBS = frozenset(verbs)  # type: ignore[attr-defined]
    module.__class__ = LazyPackage
