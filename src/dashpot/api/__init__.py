"""Public Python functions: read, inspect, fit, predict, compare, report, export, plan, batch.

Each verb takes records and results of any kind; which work they mean is decided where the command
line asks, too (`dashpot.reading.readers.detect_kind`, `dashpot.workflow.fit_routing`). The public
names are listed in ``dashpot/__init__.pyi``.

A function whose result depends on its arguments has one signature for each case, in the stub
``dashpot/_signatures.pyi``; its run-time signature, which `help` shows, names the options of all.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Mapping
from functools import cache, wraps
from inspect import Parameter, Signature, signature
from numbers import Integral, Real
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

from dashpot.base.errors import DashpotError, DataError
from dashpot.base.option_fields import iterate_option_fields
from dashpot.registry import call_handler, load_object

P = ParamSpec("P")
R = TypeVar("R")
F = TypeVar("F", bound=Callable[..., Any])

_STUB = Path(__file__).parents[1] / "_signatures.pyi"
OPTION_CLASSES = {
    "hammer": "dashpot.workflow.job:HammerChoices",
    "machine": "dashpot.datamodel.machine:Machine",
    "prior": "dashpot.fitting.identification.prior_knowledge:SolidPrior",
    "rig": "dashpot.fitting.identification.prior_knowledge:HammerRig",
    "specimen": "dashpot.datamodel.specimen:Specimen",
    "time_limits": "dashpot.workflow.job:TimeLimits",
}
"""Classes of options that hold several values, and may be given as a mapping of these."""


@cache
def read_overloads() -> Mapping[str, tuple[Signature, ...]]:
    """Return the signatures of each function of the stub, with annotations as text."""
    overloads: dict[str, tuple[Signature, ...]] = {}
    for node in ast.parse(_STUB.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef):
            overloads[node.name] = (*overloads.get(node.name, ()), _convert_to_signature(node))
    return overloads


def _convert_to_signature(node: ast.FunctionDef) -> Signature:
    """Return the keyword-only parameters and the result of a definition."""
    parameters = [
        Parameter(
            argument.arg,
            Parameter.KEYWORD_ONLY,
            default=Parameter.empty if default is None else ast.literal_eval(default),
            annotation=ast.unparse(argument.annotation) if argument.annotation else Parameter.empty,
        )
        for argument, default in zip(node.args.kwonlyargs, node.args.kw_defaults, strict=True)
    ]
    return Signature(parameters, return_annotation=ast.unparse(node.returns or ast.Constant(None)))


def merge_signatures(function: Callable[..., Any], cases: Iterable[Signature]) -> Signature:
    """Return the signature of a function with the keyword parameters of all its cases.

    An argument that some cases lack is optional; its type and default come from the first case that
    has it.
    """
    signatures = tuple(cases)
    own_signature = signature(function)
    option_kinds = (Parameter.KEYWORD_ONLY, Parameter.VAR_KEYWORD)
    leading = [item for item in own_signature.parameters.values() if item.kind not in option_kinds]
    options: dict[str, Parameter] = {
        item.name: item
        for item in own_signature.parameters.values()
        if item.kind is option_kinds[0]
    }
    for case in signatures:
        for name, item in case.parameters.items():
            if item.kind is not Parameter.KEYWORD_ONLY:
                continue
            first = options.setdefault(name, item)
            required = all(
                name in other.parameters and other.parameters[name].default is Parameter.empty
                for other in signatures
            )
            if first.default is Parameter.empty and not required:
                options[name] = first.replace(
                    default=None,
                    annotation=f"{first.annotation} | None".replace("None | None", "None"),
                )
    results = dict.fromkeys(str(case.return_annotation) for case in signatures)
    return own_signature.replace(
        parameters=[*leading, *options.values()], return_annotation=" | ".join(results)
    )


def show_stub_signature(function: F) -> F:
    """Give a function the signature of its overloads in the stub, as a decorator."""
    merged_signature = merge_signatures(function, read_overloads()[function.__name__])
    function.__signature__ = merged_signature  # type: ignore[attr-defined]
    return call_handler("add advice", "function", function, default=function)  # type: ignore[no-any-return]


def show_typed_keywords(keywords: type) -> Callable[[F], F]:
    """Return a decorator that shows the keys of a typed dictionary as optional keywords."""
    kinds = {
        name: getattr(kind, "__forward_arg__", kind)
        for name, kind in keywords.__annotations__.items()
    }
    case = Signature(
        [
            Parameter(name, Parameter.KEYWORD_ONLY, default=None, annotation=f"{kind} | None")
            for name, kind in kinds.items()
        ]
    )

    def show(function: F) -> F:
        result = signature(function).return_annotation
        merged = merge_signatures(function, [case.replace(return_annotation=result)])
        function.__signature__ = merged  # type: ignore[attr-defined]
        return function

    return show


def refuse_wrong_options(function: Callable[P, R]) -> Callable[P, R]:
    """Raise a clear error for a keyword that the function does not have, as a decorator."""
    own_signature = signature(function)
    names = [
        item.name for item in own_signature.parameters.values()
        if item.kind in {Parameter.KEYWORD_ONLY, Parameter.POSITIONAL_OR_KEYWORD}
    ]  # fmt: skip

    @wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        refuse_unknown_option(kwargs, names, f"dp.{function.__name__}")
        given_arguments = own_signature.bind(*args, **kwargs).arguments
        refuse_wrong_types(own_signature, given_arguments)
        options: Any = {name: convert_option(name, value) for name, value in kwargs.items()}
        return function(*args, **options)

    return call_handler("add advice", "function", call, default=call)  # type: ignore[no-any-return]


def refuse_wrong_types(
    parameters: Signature, arguments: Mapping[str, Any], error: type[DashpotError] = DataError
) -> None:
    """Refuse an argument that is not of the type that a function states.

    Raises
    ------
    DashpotError
        Of the type `error`.
    """
    call_handler("check arguments", "Python", parameters, arguments, error, default=None)


def refuse_unknown_option(
    options: Iterable[str],
    names: Iterable[str],
    subject: str,
    error: type[DashpotError] = DataError,
) -> None:
    """Refuse an unknown option, and suggest the most similar name.

    Raises
    ------
    DashpotError
        Of the type `error`.
    """
    expected = sorted(names)
    unknown = sorted(set(options) - set(expected))
    if not unknown:
        return
    suggestion = call_handler("suggest", "keyword", unknown[0], expected, default="")
    hint = f"Did you mean {suggestion}? " if suggestion else ""
    accepted_text = f"It takes {', '.join(expected)}" if expected else "It takes no options"
    raise error(f"{unknown[0]}= does not suit {subject}. {hint}{accepted_text}")


def convert_option(name: str, value: Any) -> Any:
    """Return the value of an option; one of :data:`OPTION_CLASSES` may be a mapping of its fields.

    A number of another type, of NumPy or a fraction, becomes one of Python.

    Raises
    ------
    DataError
        If one of :data:`OPTION_CLASSES` is anything else.
    """
    if value is None or name not in OPTION_CLASSES:
        value = value.item() if getattr(value, "ndim", None) == 0 else value
        return (
            float(value) if isinstance(value, Real) and not isinstance(value, Integral) else value
        )
    kind = load_object(OPTION_CLASSES[name])
    if isinstance(value, kind):
        return value
    fields = [field.name for field in iterate_option_fields(kind)]
    if not isinstance(value, Mapping):
        raise DataError(
            f"{name}= is of the type {type(value).__name__}; expected a mapping, such as "
            f'{name}={{"{fields[0]}": ...}}, with some of {", ".join(fields)}'
        )
    refuse_unknown_option(value, fields, f"{name}=")
    return kind(**value)


def call_with_options(
    function: Callable[..., R],
    *args: Any,
    options: Mapping[str, Any],
    subject: str,
    error: type[DashpotError] = DataError,
) -> R:
    """Call a function with options, and refuse in a sentence those that it lacks or needs.

    Raises
    ------
    DashpotError
        Of the type `error`.
    """
    parameters = list(signature(function).parameters.values())[len(args) :]
    refuse_unknown_option(options, [item.name for item in parameters], subject, error)
    missing = [
        item.name
        for item in parameters
        if item.default is Parameter.empty and item.name not in options
    ]
    if missing:
        raise error(f"{subject} needs {missing[0]}=: it was not given")
    refuse_wrong_types(signature(function), options, error)
    return function(*args, **{name: convert_option(name, options[name]) for name in options})
