"""Values created at first use: public names of a package, and regular expressions.

The public names are listed in ``__init__.pyi``.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from functools import cache
from importlib import import_module
from importlib.util import resolve_name
from os.path import splitext
from types import ModuleType
from typing import TYPE_CHECKING, Any


def build_lazy_exports(
    package: str, file: str
) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """Return ``__getattr__`` and ``__dir__`` of a module from its stub file.

    A line of the stub names the module that defines a name, in any layer: so a low package offers a
    name of a higher one without importing it. The stub is read when the first name is requested;
    its names are ``__all__``.
    """

    @cache
    def read_homes() -> dict[str, tuple[str, str]]:
        return _read_homes(package, f"{splitext(file)[0]}.pyi")

    def find(name: str) -> Any:
        if name == "__all__":
            return sorted(read_homes())
        if name not in read_homes():
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        module, text = read_homes()[name]
        if module == package:  # a submodule
            return import_module(f"{package}.{text}")
        home = import_module(module)
        # a submodule that nobody has imported yet is no attribute of its package
        return getattr(home, text) if hasattr(home, text) else import_module(f"{module}.{text}")

    return find, lambda: sorted(read_homes())


def _read_homes(package: str, stub: str) -> dict[str, tuple[str, str]]:
    """Return the module and the name there of each public name of a stub."""
    import ast  # not for ``dashpot --help``

    with open(stub, encoding="utf-8") as file:
        tree = ast.parse(file.read())
    homes = {
        alias.asname: (
            resolve_name("." * line.level + (line.module or ""), package),
            alias.name,
        )
        for line in tree.body
        if isinstance(line, ast.ImportFrom)
        for alias in line.names
        if alias.asname  # PEP 484: a name is exported as itself
    }
    # ``_name``: where a name is whose signature another line of the stub names
    homes |= {name[1:]: homes.pop(name) for name in list(homes) if name[1:] in homes}
    for line in tree.body:  # ``public = _imported``: another public name of what a line imports
        if isinstance(line, ast.Assign):
            homes[ast.unparse(line.targets[0])] = homes.pop(ast.unparse(line.value))
    return homes


class LazyPackage(ModuleType):
    """Package some of whose functions have the name of one of its modules; the function wins.

    A module that is imported is set as an attribute of its package, which would hide the function.
    """

    def __setattr__(self, name: str, value: object) -> None:
        fits = isinstance(value, ModuleType) and value.__name__ == f"{self.__name__}.{name}"
        if not (fits and name in self.VERBS):
            super().__setattr__(name, value)

    def __reduce__(self) -> Any:
        """Pickle the package by its name, as Python does for any module."""
        return import_module, (self.__name__,)


def set_package_functions(package: str, *verbs: str) -> None:
    """Set attributes of a package to functions, also after modules of that name are imported."""
    module = sys.modules[package]
    module.VERBS = frozenset(verbs)  # type: ignore[attr-defined]
    module.__class__ = LazyPackage


if TYPE_CHECKING:
    compile_on_use = re.compile
else:

    class PatternOnUse:
        """Delay the compilation of a pattern until one of its methods is used.

        A short command uses half of the patterns of the modules that it loads.
        """

        def __init__(self, source: str | bytes, flags: int = 0) -> None:
            self._parts = source, flags

        def __getattr__(self, name: str) -> Any:
            method = getattr(re.compile(*self._parts), name)  # compiled once: `re` keeps it
            setattr(self, name, method)
            return method

        def __reduce__(self) -> Any:
            return compile_on_use, self._parts

    compile_on_use = PatternOnUse
