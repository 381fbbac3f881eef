"""Registry: handlers of a task, found by type, kind of test or name.

The core's own rows stand in `dashpot.registry.core`, those of an extension in its module
`registration`. A row names functions by words, ``"package.module:name"``, which are imported when
they are needed. What a table must hold to be of a kind stands in
`dashpot.reading.columns.kind_detection`.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from importlib import import_module
from types import MappingProxyType
from typing import Any

from dashpot.base.errors import DashpotError
from dashpot.registry.core import EXTENSION as CORE
from dashpot.registry.row import (
    Command,
    Example,
    Extension,
    FileFormat,
    FitRow,
    KindOfTest,
    LotSpecimen,
    Place,
    SolverInput,
)

__all__ = [
    "COMMANDS",
    "EXTENSIONS",
    "FIGURES",
    "FITS",
    "FIT_FILES",
    "FORMATS",
    "KINDS",
    "PREDICTED",
    "RESPONSES",
    "SOLVER_INPUTS",
    "SOLVER_NAMES",
    "Command",
    "Example",
    "Extension",
    "FileFormat",
    "FitRow",
    "KindOfTest",
    "LotSpecimen",
    "Place",
    "SolverInput",
    "call_handler",
    "figure_of",
    "find_handler",
    "find_kinds_by_option",
    "format_install_command",
    "list_names",
    "load_object",
    "page_of",
    "require_handler",
    "row_of",
]

_PACKAGE = "dashpot.extensions"


def _read_rows() -> Iterator[Extension]:
    """Iterate over the rows of the core and of every extension that is installed."""
    yield CORE
    for folder in import_module(_PACKAGE).__path__:
        for name in sorted(os.listdir(folder)):
            path = os.path.join(folder, name, "registration.py")
            if os.path.exists(path):
                yield _read_registration(path, f"{_PACKAGE}.{name}.registration")


def _read_registration(path: str, module: str) -> Extension:
    """Return the rows of a registration file.

    Raises
    ------
    DashpotError
        If it has no rows, or cannot be imported, with the line that is to blame.
    """
    try:
        extension: object = getattr(import_module(module), "EXTENSION", None)
        if isinstance(extension, Extension):
            return extension
        problem = f"EXTENSION is {extension!r}; expected EXTENSION = Extension(...)"
    except Exception as error:  # noqa: BLE001 -- whatever an extension under work may raise
        from traceback import extract_tb

        lines = [frame.lineno for frame in extract_tb(error.__traceback__) if frame[0] == path]
        # of what cannot be parsed no line was run
        line = lines[-1] if lines else getattr(error, "lineno", "")
        problem, path = f"{type(error).__name__}: {error}", f"{path}:{line}"
    raise DashpotError(
        f"{path}: the rows of this extension cannot be read: {problem}. Correct the file, or move "
        "the folder of the extension elsewhere"
    )


def load_object(word: str) -> Any:
    """Return the object of a name: ``"package.module:name"``."""
    module, _, name = word.partition(":")
    return getattr(import_module(module), name)


EXTENSIONS = tuple(_read_rows())
"""The rows of the core, and of each extension."""


def _sort_rows(group: str) -> Mapping[str, Any]:
    """Return the rows of all extensions in a group by name, in their order."""
    rows = (row for extension in EXTENSIONS for row in getattr(extension, group))
    return MappingProxyType({row.name: row for row in sorted(rows, key=lambda row: row.order)})


KINDS: Mapping[str, KindOfTest] = _sort_rows("kinds")
"""Every kind of test, in the order of columns and examples."""

FITS: Mapping[str, FitRow] = _sort_rows("fits")
"""Every fit that records may mean, but for those that the row of a kind says whole."""

COMMANDS: Mapping[str, Command] = _sort_rows("commands")
"""Every command, in the order of ``dashpot --help``."""

FORMATS: Mapping[str, FileFormat] = MappingProxyType(
    {form.name: form for extension in EXTENSIONS for form in extension.formats}
)
"""Every file format."""

FILE_KINDS: Mapping[str, tuple[Any, ...]] = MappingProxyType(
    {name: row for extension in EXTENSIONS for name, row in extension.file_kinds.items()}
)
"""Kinds of file of extensions, each with what `KindOfFile` holds."""

SOLVER_INPUTS: Mapping[str, SolverInput] = _sort_rows("solver_inputs")
"""Every solver whose input is written, in the order in which they are listed."""

SOLVER_NAMES: Mapping[str, str] = MappingProxyType(
    {word: name for name, row in SOLVER_INPUTS.items() for word in (name, *row.synonyms)}
)
"""Each name and synonym of a solver, in lower case, with its name."""

FIT_FILES = "dashpot.workflow.bench_tests:fit_files"
RESPONSES = tuple(kind.name for kind in KINDS.values() if kind.app_section in {"response", "base"})
"""Kinds of responses of a mass on its seals over frequency."""

_NOUNS = {name: kind for kind in KINDS.values() for name in kind.classes}
_HANDLERS: dict[str, dict[str, str]] = {}
for _extension in EXTENSIONS:
    for _task, _words in _extension.handlers.items():
        _HANDLERS.setdefault(_task, {}).update(_words)
FIGURES = {
    name: figure for kind in KINDS.values() for name, figure in kind.classes.items()
} | _HANDLERS.get("figure", {})
"""Figure of each record and result."""

_PAGES = {
    name: page for kind in KINDS.values() for name, page in kind.pages.items()
} | _HANDLERS.get("page", {})

PREDICTED = tuple(kind for kind in KINDS.values() if kind.predict)
"""Kinds whose fit predicts by itself, and not as a solid."""


def find_handler(task: str, subject: object) -> Any:
    """Return the function that does a task for a value of some type, or for a name.

    Parameters
    ----------
    task : str
        A task of `Extension.handlers`.
    subject : object
        A name, or a value whose class, or one that it inherits from, is looked up.

    Returns
    -------
    callable or None
        None where no row names one.
    """
    words = _HANDLERS.get(task, {})
    if isinstance(subject, str):
        names = [subject]
    else:
        names = [_type_name(kind) for kind in type(subject).__mro__]
    word = next((words[name] for name in names if name in words), None)
    return load_object(word) if word else None


def require_handler(task: str, subject: object) -> Any:
    """Return the result of `find_handler` for a required task.

    Raises
    ------
    DashpotError
        If no extension of this installation does the task.
    """
    handler = find_handler(task, subject)
    if handler is None:
        raise DashpotError(
            f"no extension of this installation does the task '{task}'; install dashpot whole, or "
            f"put the folder of the extension back into {_PACKAGE}"
        )
    return handler


def call_handler(task: str, subject: object, *arguments: Any, default: Any) -> Any:
    """Return the result of a task's function; the default if no row names one."""
    handler = find_handler(task, subject)
    return default if handler is None else handler(*arguments)


def format_install_command(extras: str) -> str:
    """Return the command that installs extras of dashpot, ``"batch,cluster"``."""
    default = f"pip install 'dashpot[{extras}]'"
    return str(call_handler("install command", "extra", extras, default=default))


def list_names(task: str) -> tuple[str, ...]:
    """Return every type or name for which a row has a handler of a task."""
    return tuple(_HANDLERS.get(task, {}))


def find_kinds_by_option(option: str) -> str:
    """Return the kinds with a fit of their own that takes an option, as the help wants them."""
    unrecognised = {kind.alternative_kind for kind in KINDS.values()}
    return " ".join(
        kind.name
        for kind in KINDS.values()
        if kind.name not in unrecognised
        and (
            option in kind.fit_options or (kind.name in FITS and option in FITS[kind.name].options)
        )
    )


def row_of(result: object) -> KindOfTest | None:
    """Return the kind of a record or a result; None if it has none or several."""
    return _NOUNS.get(_type_name(type(result)))


def figure_of(result: object) -> Any:
    """Return the function that draws a record or a result; None if there is none."""
    word = FIGURES.get(_type_name(type(result)))
    return load_object(word) if word else None


def page_of(result: object) -> Any:
    """Return the function that lays out the page of a result; None if there is none."""
    words = (_PAGES.get(_type_name(kind)) for kind in type(result).__mro__)
    return next((load_object(word) for word in words if word), None)


def _type_name(kind: type) -> str:
    return f"{kind.__module__}:{kind.__qualname__}"
