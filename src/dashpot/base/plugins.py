"""Entry points of other packages: file formats, kinds of tests and solver inputs.

Three groups are looked into::

    [project.entry-points."dashpot.formats"]   # a module: read(raw: bytes, *, name: str) -> dict
    [project.entry-points."dashpot.kinds"]     # a module: fit(columns: dict, options: dict) -> dict
    [project.entry-points."dashpot.decks"]     # a function (solid: dict, *, units, name) -> str

Plain data pass the border. A list reads the metadata of packages as text; a plug-in is imported
when its name is typed or stands in a profile, and at no other time: a name of dashpot's own is
never asked for here.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any, Literal, NoReturn, get_args

from dashpot.base.errors import DashpotError, ReadError
from dashpot.base.plain_text import escape_terminal_text
from dashpot.base.serialisation import Serialisable

Group = Literal["formats", "kinds", "decks"]
GROUPS: tuple[Group, ...] = get_args(Group)
OFF = "none"
"""The value of :data:`SWITCH` with which no plug-in is used."""
SWITCH = "DASHPOT_PLUGINS"
_LONGEST = 300
"""Characters of what a plug-in says of its own failure."""


@dataclass(frozen=True)
class Plugin(Serialisable):
    """Entry point of a plug-in.

    Attributes
    ----------
    group, name : str
        What it adds, and how it is asked for.
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
        """Its name and who brings it, as a reader is named: ``"labkit (labkit 0.1.0)"``."""
        return f"{self.name} ({self.package_version})"

    @property
    def says(self) -> str:
        """How an error speaks of it."""
        return f"the plug-in '{self.name}' of {self.package_version}"

    def load(self) -> Any:
        """Import it, and return its module or function.

        Raises
        ------
        ReadError
            If it cannot be imported.
        """
        if os.environ.get(SWITCH) == OFF:
            raise ReadError(f"{self.says} is not used: {SWITCH}={OFF}")
        module, _, attribute = self.value.partition(":")
        try:
            new_module = import_module(module)
            return getattr(new_module, attribute) if attribute else new_module
        except BaseException as error:  # noqa: BLE001  others' code may raise anything
            self.failed(error)

    def failed(self, error: BaseException) -> NoReturn:
        """Raise what stopped it as one sentence that names it.

        Raises
        ------
        ReadError
        """
        if isinstance(error, KeyboardInterrupt | MemoryError | DashpotError):
            raise error
        text = _line(str(error))[:_LONGEST]
        raise ReadError(
            f"{self.says} failed: {type(error).__name__}{': ' + text if text else ''}. "
            f"Ask who maintains {self.package}"
        ) from error

    def wrong(self, found: str, expected: str) -> NoReturn:
        """Raise that it returned what the contract does not have.

        Raises
        ------
        ReadError
        """
        raise ReadError(
            f"{self.says} returned {found}; expected {expected}. Ask who maintains {self.package}"
        )


@dataclass(frozen=True)
class Installed(Serialisable):
    """Plug-ins installed in this environment."""

    schema = "dashpot/plugins@1"
    read_back = False

    plugins: tuple[Plugin, ...]


def plugins(group: Group | None = None) -> tuple[Plugin, ...]:
    """Return every plug-in that is installed, or those of a group; none is imported."""
    plugins = _scan_plugins()
    return tuple(plugin for plugin in plugins if group in {None, plugin.group})


@cache
def _scan_plugins() -> tuple[Plugin, ...]:
    if os.environ.get(SWITCH) == OFF:
        return ()
    from importlib.metadata import distributions  # it costs more than all that the scan does

    plugins: dict[tuple[str, str, str], Plugin] = {}
    for distribution in distributions():
        for entry in distribution.entry_points:
            package, _, group = entry.group.partition(".")
            if package == "dashpot" and group in GROUPS:
                # the first on the path is the one that is imported, also of one found twice
                key = (group, entry.name, distribution.name)
                plugins.setdefault(
                    key,
                    Plugin(group, entry.name, entry.value, distribution.name, distribution.version),
                )
    return tuple(sorted(plugins.values(), key=lambda p: (p.group, p.name, p.package)))


def find_plugin(group: Group, name: str) -> Plugin | None:
    """Return the plug-in of a name; None if there is none.

    Raises
    ------
    ReadError
        If two packages bring one name.
    """
    result = [plugin for plugin in plugins(group) if plugin.name == name]
    if len(result) > 1:
        raise ReadError(
            f"'{name}' is brought by {' and by '.join(item.package_version for item in result)}. "
            "Uninstall one of "
            "them"
        )
    return result[0] if result else None


def format_plugin_names(group: Group) -> str:
    """Return the names of a group as the end of an error's sentence; empty where there are none."""
    names = ", ".join(plugin.name for plugin in plugins(group))
    return f" By plug-ins: {names}." if names else ""


def require_plugin(group: Group, name: str) -> Plugin:
    """Return the plug-in of a name.

    Raises
    ------
    ReadError
        If there is none.
    """
    plugin = find_plugin(group, name)
    if plugin is None:
        off = os.environ.get(SWITCH) == OFF
        text = format_plugin_names(group) or (
            " Plug-ins are off here." if off else " To see them: dashpot inspect --plugins."
        )
        raise ReadError(f"no plug-in brings the {group[:-1]} '{escape_terminal_text(name)}'.{text}")
    return plugin


def items(plugin: Plugin, document: Mapping[str, Any], key: str) -> Sequence[Mapping[str, Any]]:
    """Return a list of dictionaries in what a plug-in returned; empty where the key is not there.

    Raises
    ------
    ReadError
        If something else stands there.
    """
    return _get_typed_list(plugin, document, key, dict, "a list of dictionaries")


def texts(plugin: Plugin, document: Mapping[str, Any], key: str) -> tuple[str, ...]:
    """Return a list of texts in what a plug-in returned; empty where the key is not there.

    Raises
    ------
    ReadError
        If something else stands there.
    """
    return tuple(map(_line, _get_typed_list(plugin, document, key, str, "a list of texts")))


def _get_typed_list(
    plugin: Plugin, document: Mapping[str, Any], key: str, kind: type, expected: str
) -> Sequence[Any]:
    results = document.get(key, [])
    if not isinstance(results, list | tuple) or not all(
        isinstance(result, kind) for result in results
    ):
        plugin.wrong(f"'{key}' of type {type(results).__name__}", expected)
    return results


def _line(text: str) -> str:
    """Others' words on one line that a terminal does not obey."""
    return " ".join(escape_terminal_text(text).split())


def word(plugin: Plugin, item: Mapping[str, Any], key: str, otherwise: str | None = None) -> str:
    """Return a text in an item of what a plug-in returned.

    Raises
    ------
    ReadError
        If it is no text, or is missing and nothing stands in its place.
    """
    text = item.get(key, otherwise)
    if not isinstance(text, str):
        plugin.wrong(f"'{key}' of type {type(text).__name__}", "a text")
    return _line(text)
