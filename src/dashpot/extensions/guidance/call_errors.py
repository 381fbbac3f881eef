"""Advice in errors of Python calls: arguments that a function or a method cannot take.

A call that succeeds is not checked, and takes 1 to 2 us more, where a stiffness at one frequency
takes 20. The methods are those of public results, tests and solids whose modules are loaded: what a
call returns is one of them.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterator, Mapping
from functools import wraps
from inspect import Parameter, Signature, signature
from types import FunctionType
from typing import Any, ParamSpec, TypeVar

from dashpot.api import refuse_unknown_option
from dashpot.base.errors import DashpotError, DataError, ExportError, FitError, ReadError
from dashpot.base.result_mixins import Printable
from dashpot.extensions.guidance.argument_types import refuse_wrong_types, suggest_argument
from dashpot.registry import call_handler

P = ParamSpec("P")
R = TypeVar("R")
_SOLIDS = "dashpot.solids.maxwell"
_CLASSES_DONE: set[type] = set()
_MISUSE = (TypeError, ValueError, AttributeError, LookupError)
"""Exceptions that a wrong argument may cause where a method does not check it."""


def add_advice(function: Callable[P, R]) -> Callable[P, R]:
    """Let errors of a public function and of methods of its results say what to do, as a decorator.

    Examples
    --------
    >>> import dashpot as dp
    >>> dp.plan("5Hz")
    Traceback (most recent call last):
        ...
    dashpot.base.errors.DataError: dp.plan takes nothing by place, found 1 value. ...
    """
    name = function.__name__

    @wraps(function)
    def call(*args: P.args, **keywords: P.kwargs) -> R:
        try:
            return function(*args, **keywords)
        except DashpotError as error:
            call_handler("add advice", name, error, *args[:1], default=None)
            _add_keywords(error, signature(function).parameters)
            raise
        except TypeError as error:
            _refuse_arguments(error, f"dp.{name}", signature(function), args, keywords)
            raise
        finally:
            _add_advice_to_methods()

    return call


def _add_keywords(error: DashpotError, keywords: Mapping[str, Parameter]) -> None:
    """Raise an error with the keywords in place of the options that it names, if it names some.

    Raises
    ------
    DashpotError
        Of the same type.
    """
    text = str(error)
    if type(error) not in _ERRORS or "(Python: " in text or _COMMAND.search(text):
        return
    options = [(name.replace("-", "_"), value) for name, value in _OPTION.findall(text)]
    words = [
        f"{name}={'True' if keywords[name].annotation == 'bool' else _quote(value)}"
        for name, value in options
        if name in keywords
    ]
    if words:
        raise type(error)(f"{text} (Python: {', '.join(dict.fromkeys(words))})") from None


def _quote(value: str) -> str:
    """Return the value of an option as Python writes it: a number, or a text with its unit."""
    return value if not value or value.replace(".", "", 1).isdigit() else f'"{value}"'


def _add_advice_to_methods() -> None:
    """Let methods of the public classes that are loaded say which argument they cannot take."""
    roots: list[type] = [Printable]
    if _SOLIDS in sys.modules:
        roots.append(sys.modules[_SOLIDS].Solid)
    for root in roots:
        for kind in _iterate_subclasses(root):
            if kind not in _CLASSES_DONE and kind.__module__.startswith("dashpot."):
                _CLASSES_DONE.add(kind)
                for method_name, method in list(vars(kind).items()):
                    if isinstance(method, FunctionType) and _is_checked(method_name, method):
                        setattr(kind, method_name, _catch_misuse(method))


def _is_checked(name: str, method: FunctionType) -> bool:
    """Return whether a method is public and takes an argument."""
    code = method.__code__
    return not name.startswith("_") and code.co_argcount + code.co_kwonlyargcount > 1


def _iterate_subclasses(kind: type) -> Iterator[type]:
    yield kind
    subclass: type
    for subclass in kind.__subclasses__():
        yield from _iterate_subclasses(subclass)


def refuse_figure_arguments(
    function: Callable[..., Any],
    error: Exception,
    args: tuple[Any, ...],
    keywords: Mapping[str, Any],
) -> None:
    """Refuse wrong arguments of a function of :mod:`dashpot.plot` that caused an error.

    Raises
    ------
    DataError
    """
    if isinstance(error, _MISUSE) and not isinstance(error, DashpotError):
        subject = f"dp.plot.{function.__name__}"
        _refuse_arguments(error, subject, signature(function), args, keywords)


def _catch_misuse(method: Callable[..., Any]) -> Callable[..., Any]:
    @wraps(method)
    def call(*args: Any, **keywords: Any) -> Any:
        try:
            return method(*args, **keywords)
        except _MISUSE as error:
            if not isinstance(error, DashpotError):
                owner = type(args[0]).__name__ if args else method.__qualname__.split(".")[0]
                subject = f"{owner}.{method.__name__}"
                _refuse_arguments(error, subject, signature(method), args, keywords)
            raise

    return call


def _refuse_arguments(
    error: Exception,
    subject: str,
    parameters: Signature,
    args: tuple[Any, ...],
    keywords: Mapping[str, Any],
) -> None:
    """Refuse arguments that are too many, missing, unknown or of a wrong type.

    Raises
    ------
    DataError
    """
    try:
        _refuse_unbound(subject, parameters, args, keywords)
        given_arguments = parameters.bind(*args, **keywords).arguments
        given_arguments.pop("self", None)
        is_verb = subject.startswith("dp.") and not subject.startswith("dp.plot.")
        refuse_wrong_types(parameters, given_arguments, DataError, takes_mappings=is_verb)
    except DataError as problem:
        raise problem from error


def _refuse_unbound(
    subject: str, parameters: Signature, args: tuple[Any, ...], keywords: Mapping[str, Any]
) -> None:
    items = [item for item in parameters.parameters.values() if item.name != "self"]
    names = [item.name for item in items]
    by_place = [item for item in items if item.kind in _BY_PLACE]
    by_name = [item for item in items if item.kind is Parameter.KEYWORD_ONLY]
    if not any(item.kind is Parameter.VAR_KEYWORD for item in items):
        refuse_unknown_option(keywords, names, subject)
    count = len(args) - ("self" in parameters.parameters)
    is_variadic = any(item.kind is Parameter.VAR_POSITIONAL for item in items)
    if count > len(by_place) and not is_variadic:
        text = ", ".join(item.name for item in by_place) or "nothing"
        others = ", ".join(f"{item.name}=" for item in by_name[:_MOST_NAMES])
        others += " and others" if len(by_name) > _MOST_NAMES else ""
        hint = f"Name what else it takes: {others}" if by_name else "Leave the others out"
        values = "1 value" if count == 1 else f"{count} values"
        raise DataError(f"{subject} takes {text} by place, found {values}. {hint}")
    given_names = {item.name for item in by_place[:count]} | keywords.keys()
    for item in (*by_place, *by_name):
        if item.name not in given_names and item.default is Parameter.empty:
            sign = "=" if item in by_name else ""
            example = suggest_argument(item)
            hint = f". Give it, such as {item.name}={example}" if example else ""
            raise DataError(f"{subject} needs {item.name}{sign}: it was not given{hint}")


_MOST_NAMES = 8
"""Largest number of keywords that a message names."""
_ERRORS = (DataError, ExportError, FitError, ReadError)
_COMMAND = re.compile(r"\bdashpot [a-z]+ [^.]*--")
_OPTION = re.compile(r"(?<![\w-])--([a-z][a-z-]*[a-z])\b(?: (\d(?:[\w.:/^]*\w)?))?")
"""An option of the command line as shown in messages, with its value if that is a quantity."""
_BY_PLACE = (Parameter.POSITIONAL_ONLY, Parameter.POSITIONAL_OR_KEYWORD)
