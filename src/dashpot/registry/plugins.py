"""Plug-ins of other packages: their rows of formats, kinds of tests and solver inputs.

A package names itself in the group of entry points ``dashpot.extensions``. Its row is a TOML file
beside its ``__init__.py``, with the fields of `dashpot.registry.row.Extension`.

Plain data pass the border. A list reads metadata and rows as text; a plug-in is imported when its
name is typed or stands in a profile, and at no other time: a name of dashpot's own is never asked
for here.
"""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Literal, NoReturn

from dashpot.base import dataclass
from dashpot.base.errors import DashpotError, DataError, ReadError
from dashpot.base.plain_text import escape_terminal_text
from dashpot.base.serialisation import Key, Serialisable
from dashpot.registry.row import Extension, FileFormat, KindOfTest, SolverInput

Group = Literal["formats", "kinds", "solver_inputs"]
ENTRY_POINTS = "dashpot.extensions"
"""The group of entry points, whose values are packages."""
ROW = "dashpot_extension.toml"
"""The file of the row in such a package."""
NO_PLUGINS = "none"
"""The value of :data:`SWITCH` with which no plug-in is used."""
SWITCH = "DASHPOT_PLUGINS"
_MAX_LENGTH = 300
"""Largest length of a plug-in's error message, characters."""

_MODULE = r"\w+(\.\w+)*"
_PLUGGED: Mapping[str, tuple[Any, str, str, str]] = {
    "formats": (FileFormat, "module", _MODULE, "package.module"),
    "kinds": (KindOfTest, "fits", rf"{_MODULE}:\w+", "package.module:function"),
    "solver_inputs": (SolverInput, "module", _MODULE, "package.module"),
}
"""Fields of a row of plain data, with their patterns."""


@dataclass(frozen=True)
class Plugin(Serialisable):
    """One thing that the row of another package adds.

    Attributes
    ----------
    group, name : str
        Field of the row, and name for the user.
    value : str
        ``"module"`` or ``"module:function"``.
    package, version : str
        The distribution that brings it.
    """

    group: str
    name: str
    value: str
    package: str
    version: str

    @property
    def package_version(self) -> str:
        """The package and its version, as provenance states them."""
        return f"{self.package} {self.version}"

    @property
    def full_label(self) -> str:
        """Name with the package that brings it, as for a reader: ``"labkit (labkit 0.1.0)"``."""
        return f"{self.name} ({self.package_version})"

    @property
    def label(self) -> str:
        """Name in an error message."""
        return f"the plug-in '{self.name}' of {self.package_version}"

    def load(self) -> Any:
        """Import it, and return its module or function.

        Raises
        ------
        ReadError
            If it cannot be imported.
        """
        if os.environ.get(SWITCH) == NO_PLUGINS:
            raise ReadError(f"{self.label} is not used: {SWITCH}={NO_PLUGINS}")
        module, _, attribute = self.value.partition(":")
        try:
            new_module = import_module(module)
            return getattr(new_module, attribute) if attribute else new_module
        except BaseException as error:  # noqa: BLE001  others' code may raise anything
            self.raise_failure(error)

    def raise_failure(self, error: BaseException) -> NoReturn:
        """Raise its failure as one sentence that names the plug-in.

        Raises
        ------
        ReadError
        """
        if isinstance(error, KeyboardInterrupt | MemoryError | DashpotError):
            raise error
        text = format_plain_line(str(error))[:_MAX_LENGTH]
        raise ReadError(
            f"{self.label} failed: {type(error).__name__}{': ' + text if text else ''}. "
            f"Ask who maintains {self.package}"
        ) from error


@dataclass(frozen=True)
class Installed(Serialisable):
    """The plug-ins of this environment, and the rows that hold none, each as a sentence."""

    schema = "dashpot/plugins@1"
    _keys = ("plugins", Key("refused", "refusals", optional=True))
    _is_loadable = False

    plugins: tuple[Plugin, ...]
    refusals: tuple[str, ...] | None = None


@cache
def read_plugins() -> Installed:
    """Return every plug-in that is installed; none is imported."""
    if os.environ.get(SWITCH) == NO_PLUGINS:
        return Installed(())
    from importlib.metadata import distributions  # it costs more than all that the scan does

    plugins_by_key: dict[tuple[str, str], tuple[Plugin, ...]] = {}
    refusals = []
    for distribution in distributions():
        for entry in distribution.entry_points.select(group=ENTRY_POINTS):
            package, version = distribution.name, distribution.version
            if (package, entry.name) in plugins_by_key:
                continue  # the first on the path is the one that is imported
            plugins_by_key[package, entry.name] = ()
            try:
                row = _read_row(entry.value)
            except (ValueError, OSError, ImportError) as error:
                refusals.append(
                    f"{package} {version} is not used: {format_plain_line(str(error))}. "
                    f"Ask who maintains {package}"
                )
                continue
            plugins_by_key[package, entry.name] = (
                *(Plugin("formats", i.name, i.module, package, version) for i in row.formats),
                *(Plugin("kinds", i.name, i.fits, package, version) for i in row.kinds),
                *(
                    Plugin("solver_inputs", i.name, f"{i.module}:{i.name}", package, version)
                    for i in row.solver_inputs
                ),
            )
    plugins = [plugin for plugins in plugins_by_key.values() for plugin in plugins]
    plugins.sort(key=lambda plugin: (plugin.group, plugin.name, plugin.package))
    return Installed(tuple(plugins), tuple(refusals) or None)


def _read_row(package: str) -> Extension:
    """Return the row of a package, found without an import."""
    spec = find_spec(package) if package.isidentifier() else None
    for folder in (spec and spec.submodule_search_locations) or ():
        path = Path(folder, ROW)
        if path.is_file():
            try:
                return parse_extension(package, tomllib.loads(path.read_text("utf-8")))
            except ValueError as error:
                raise DataError(f"{package}/{ROW}: {error}") from None
    raise DataError(
        f"its entry point says '{package}', where no {ROW} is; expected a package of the top "
        "level that holds one"
    )


def parse_extension(name: str, mapping: Mapping[str, Any]) -> Extension:
    """Return the row of a plug-in from plain data, as its TOML file states it.

    Raises
    ------
    DataError
        If it holds what a plug-in cannot add, or an item is not its name and its word.
    """
    rows: dict[str, Any] = {}
    for group, items in mapping.items():
        if group not in _PLUGGED:
            raise DataError(f"found '{group}'; expected {', '.join(_PLUGGED)}")
        kind, key, pattern, example = _PLUGGED[group]
        if not isinstance(items, list):
            raise DataError(f"found '{group}' without items; expected [[{group}]] before each")
        for item in items:
            patterns = {"name": r"[\w.-]+", key: pattern}
            if (
                not isinstance(item, dict)
                or item.keys() != patterns.keys()
                or not all(isinstance(text, str) for text in item.values())
                or not all(re.fullmatch(patterns[field], text) for field, text in item.items())
            ):
                raise DataError(
                    f"found {item!r:.100} in '{group}'; expected "
                    f'name = "word" and {key} = "{example}" alone'
                )
        names = [item["name"] for item in items]
        if len(set(names)) < len(names):
            raise DataError(f"found a name of '{group}' twice in {names}; give each its own")
        rows[group] = tuple(kind(**item) for item in items)
    return Extension(name, **rows)


def find_plugin(group: Group, name: str) -> Plugin | None:
    """Return the plug-in of this name; None if it is not installed.

    Raises
    ------
    ReadError
        If two packages bring one name.
    """
    result = [plugin for plugin in _list_plugins(group) if plugin.name == name]
    if len(result) > 1:
        raise ReadError(
            f"'{name}' is brought by {' and by '.join(item.package_version for item in result)}. "
            "Uninstall one of them"
        )
    return result[0] if result else None


def _list_plugins(group: Group) -> list[Plugin]:
    return [plugin for plugin in read_plugins().plugins if plugin.group == group]


def format_plugin_names(group: Group) -> str:
    """Return the names of a group and the refused plug-ins, as the end of an error message."""
    names = ", ".join(plugin.name for plugin in _list_plugins(group))
    refusals_text = "".join(f" {sentence}." for sentence in read_plugins().refusals or ())
    return (f" By plug-ins: {names}." if names else "") + refusals_text


def require_plugin(group: Group, name: str) -> Plugin:
    """Return the plug-in of a name.

    Raises
    ------
    ReadError
        If there is none.
    """
    plugin = find_plugin(group, name)
    if plugin is None:
        is_switched_off = os.environ.get(SWITCH) == NO_PLUGINS
        text = format_plugin_names(group) or (
            " Plug-ins are off here."
            if is_switched_off
            else " To see them: dashpot inspect --plugins."
        )
        raise ReadError(f"no plug-in brings the {group[:-1]} '{escape_terminal_text(name)}'.{text}")
    return plugin


def format_plain_line(text: str) -> str:
    """Return others' words on one line that a terminal does not obey."""
    return " ".join(escape_terminal_text(text).split())
