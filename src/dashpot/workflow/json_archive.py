"""Results as versioned JSON documents, written and read with validation."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import is_dataclass
from functools import cache
from itertools import zip_longest
from pathlib import Path
from types import UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np

from dashpot.base.errors import DataError, ReadError, Status
from dashpot.base.serialisation import (
    DIGEST,
    NOT_FINITE,
    Serialisable,
    compute_document_digest,
    decode_fields,
)
from dashpot.datamodel.bounds import EndOfHold
from dashpot.datamodel.fit import Fit
from dashpot.reading.raw_file import looks_like_json, open_raw
from dashpot.registry import KINDS, call_handler, find_handler, list_names, load_object
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.jenkins import Jenkins
from dashpot.solids.maxwell import GeneralizedMaxwell, Parallel, Solid
from dashpot.solids.nonlinear_springs import Cubic
from dashpot.solids.rate_independent import RateIndependent
from dashpot.solids.shift_laws import WLF, Arrhenius, FreeShifts, TemperatureLaw

# Invalid documents: duplicate or unknown keys, texts for numbers, edits.


_NUMERIC = {"k_inf", "k", "tau", "b"}
"""Keys of a solid, whose values are numbers."""


def has_edited_fit(value: Any) -> bool:
    """Whether a document holds a fit that was changed since; one typed by hand has no digest."""
    if isinstance(value, list):
        return any(map(has_edited_fit, value))
    if not isinstance(value, dict):
        return False
    sealed = "schema" in value and DIGEST in value
    return (sealed and value[DIGEST] != compute_document_digest(value)) or any(
        map(has_edited_fit, value.values())
    )


def require_unique_keys(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Return a JSON object; raise an error if a key occurs twice."""
    entries = dict(pairs)
    if len(entries) < len(pairs):
        keys = [key for key, _ in pairs]
        repeated_key = next(key for key in keys if keys.count(key) > 1)
        raise ValueError(f'the key "{repeated_key}" stands twice in one object')
    return entries


def list_children(value: Any, path: str) -> dict[str, Any]:
    """Return the members of a JSON object or array by their path; empty for other values."""
    if isinstance(value, dict):
        return {f"{path}.{key}": child for key, child in value.items()}
    if isinstance(value, list):
        return {f"{path}[{i}]": child for i, child in enumerate(value)}
    return {}


def find_mistyped_number(value: Any, path: str = "$") -> str:
    """Return a message for a number that a document has as text; "" if there is none."""
    if isinstance(value, str) and re.fullmatch(r"[-+]?[\d.,]+(?:[eE][-+]?\d+)?", value):
        numeric = path.rpartition(".")[2].partition("[")[0] in _NUMERIC
        return f'{path} is the text "{value}"; expected a number, with a point' if numeric else ""
    children = list_children(value, path).items()
    return next(
        filter(None, (find_mistyped_number(child, item_path) for item_path, child in children)), ""
    )


def find_unknown_keys(value: Any, reference: Any, path: str = "$") -> str:
    """Return a message for keys that are not in the format; "" if there are none."""
    if value == reference:
        return ""
    if isinstance(value, dict | list) and type(value) is not type(reference):
        text, expected = (
            _JSON_KINDS.get(type(json_value), "one value") for json_value in (value, reference)
        )
        return f"{path} is {text}; expected {expected}"
    if isinstance(value, dict):
        unknown = sorted(value.keys() - reference.keys())
        if unknown:
            return f'{path} has "{unknown[0]}", which this version of dashpot does not know'
    # the bare contract's orders are left out: then there is nothing to hold the items against
    elif isinstance(value, list) and len(value) != len(reference):
        return ""
    reference_parts = list_children(reference, path)
    children = list_children(value, path).items()
    return next(
        filter(
            None,
            (
                find_unknown_keys(json_value, reference_parts[item_path], item_path)
                for item_path, json_value in children
            ),
        ),
        "",
    )


_JSON_KINDS: dict[type, str] = {dict: "an object", list: "an array"}


# Writing and reading of results.


@cache
def schemas() -> dict[str, type[Serialisable]]:
    """Return the class of each versioned schema name, with those of every kind."""
    of_kinds = (load_object(name) for kind in KINDS.values() for name in kind.classes)
    loadable_kinds = (
        kind
        for kind in of_kinds
        if issubclass(kind, Serialisable) and kind.schema and kind._is_loadable
    )
    other_loaders = {name: find_handler("document", name) for name in list_names("document")}
    return {**other_loaders, **{item.schema: item for item in loadable_kinds}}


def _find_schema_class(name: str) -> type[Serialisable] | None:
    """Return the class of a schema name; only the module that it needs is imported."""
    return find_handler("document", name) or schemas().get(name)


def to_json(result: object, *, indent: int | None = 2) -> str:
    """Return a result as one JSON document: its ``"schema"``, SI units, floats in full precision.

    A fit and a comparison also carry the keys of the command line's contract.
    """
    import json

    return json.dumps(to_document(result), indent=indent, ensure_ascii=False, allow_nan=False)


def to_document(result: object) -> dict[str, Any]:
    """Return the document that :func:`to_json` writes, as plain dictionaries, lists and values."""
    if not isinstance(result, Serialisable) or _find_schema_class(result.schema) is not type(
        result
    ):
        raise DataError(
            f"a {type(result).__name__} has no archive form; expected one of "
            f"{', '.join(sorted(kind.__name__ for kind in schemas().values()))}"
        )
    return result.to_dict()


def from_json(text: str | bytes) -> Any:
    """Return the result that a JSON document holds.

    Raises
    ------
    ReadError
        If the text is not JSON, its schema is unknown, a value has the wrong type, or the document
        holds anything that the result does not.
    """
    import msgspec

    kind, written = _parse_document(text)
    name, entries = (
        kind.schema,
        call_handler("former document", "convert", written, default=written),
    )
    try:
        with np.errstate(divide="raise", over="raise", invalid="raise"):
            result = _convert_to_class(kind, _map_to_fields(kind, entries))
            unknown = find_unknown_keys(entries, to_document(result))
            changed = has_edited_fit(written)
    except (*_VALUE_ERRORS, msgspec.ValidationError) as error:
        raise ReadError(
            f"the {name} document is not valid: {_format_reason(error, entries)}"
        ) from None
    if unknown:
        raise ReadError(f"the {name} document is not valid: {unknown}")
    if changed:
        raise ReadError(
            "the fit in this document is not the one that dashpot wrote: something in it was "
            'changed by hand; fit again, or take "digest" out of it if the change is meant'
        )
    return result


_VALUE_ERRORS = (KeyError, TypeError, ValueError, ArithmeticError, AttributeError)
"""Exceptions of classes constructed from a wrong value, besides msgspec's own."""


def _format_reason(error: Exception, entries: dict[str, Any]) -> str:
    """Return why a document makes no valid value, as text."""
    import msgspec

    if isinstance(error, TypeError | msgspec.ValidationError):
        return find_mistyped_number(entries) or str(error)
    if isinstance(error, AttributeError):
        return "a part has the wrong type"
    return f"{error} is missing" if isinstance(error, KeyError) else str(error)


def _parse_document(text: str | bytes) -> tuple[type[Serialisable], dict[str, Any]]:
    """Return the class of a JSON document, and its values."""
    import json

    try:
        data = json.loads(text, object_pairs_hook=require_unique_keys)
    except (ValueError, RecursionError) as error:
        raise ReadError(f"this is not a JSON document: {error}") from None
    name = data.get("schema") if isinstance(data, dict) else None
    kind = None
    if isinstance(name, str):
        present_name = call_handler("former document", "name schema", name, default=name)
        kind = _find_schema_class(present_name)
    # a mass and what rests on it are beside a comparison that a command answered
    if kind is None or (kind.__name__ == "Comparison" and "mass_inferred" in data):
        raise ReadError(_format_unknown_schema(name))
    return kind, data


def _format_unknown_schema(name: object) -> str:
    """Return why a document of this schema is not read, and what to do."""
    schema_name, _, version = str(name).partition("@")
    present = next((schema for schema in schemas() if schema.startswith(f"{schema_name}@")), "")
    newest = present.partition("@")[2]
    if newest and version.isdecimal() and int(version) > int(newest):
        return (
            f'the document\'s "schema" is {name!r}, of a newer version of dashpot; this version '
            f"reads {schema_name!r} up to @{newest}. Update dashpot, or write the document with "
            "this one"
        )
    subject = (
        _describe_kind(schema_name)
        if schema_name.startswith("dashpot/")
        else "no result of dashpot"
    )
    return (
        f'this is {subject}: its "schema" is {name!r}, which is not read back. Give the fit or the '
        "record that it was made from"
    )


# -- Conversion of plain values to results ---------------------------------------------------------


def _map_to_fields(kind: Any, value: Any) -> Any:
    """Return the form of this type in a document, every dataclass by its fields."""
    if isinstance(value, str):
        return NOT_FINITE.get(value, value)
    if not isinstance(value, list | dict):
        return value
    kinds = get_args(kind) if get_origin(kind) in {Union, UnionType} else (kind,)
    if isinstance(value, list):
        item_types = next(
            (get_args(kind) for kind in kinds if get_origin(kind) is tuple), (Any, ...)
        )
        group = item_types[:1] * len(value) if ... in item_types else item_types
        return [_map_to_fields(*pair) for pair in zip_longest(group, value)][: len(value)]
    cls = _find_value_class(kinds, value)
    if cls is None:
        return {key: _map_to_fields(Any, entry) for key, entry in value.items()}
    types, entries = _evaluate_types(cls), decode_fields(cls, _find_completion(cls)(value))
    layout = {name: _map_to_fields(types[name], entry) for name, entry in entries.items()}
    # the decoder knows no class with several subclasses
    return _convert_to_class(cls, layout) if _CLASS_CHOICES.keys() & kinds else layout


def _convert_to_class(cls: type, layout: dict[str, Any]) -> Any:
    import msgspec

    return msgspec.convert(layout, type=cls, dec_hook=_decode_value)


def _decode_value(kind: type, value: Any) -> Any:
    """Return a value that the decoder does not know: an array, or a value chosen already."""
    if isinstance(value, dict) and set(value) == {"real", "imag"}:
        return np.asarray(value["real"], dtype=float) + 1j * np.asarray(value["imag"], dtype=float)
    if isinstance(value, list):
        array = np.asarray(value, dtype=float)
        return array.reshape(0, 0) if array.size == 0 and array.ndim == 1 else array
    if isinstance(value, tuple(_CLASS_CHOICES)):
        return value
    raise TypeError(f"expected an array, found {type(value).__name__} for {kind}")


def _find_value_class(kinds: Sequence[Any], value: dict[str, Any]) -> type | None:
    """Return the class of an object in a document; None of one with arbitrary keys."""
    for kind in kinds:
        if kind in _CLASS_CHOICES:
            return _CLASS_CHOICES[kind](value)
        if isinstance(kind, type) and is_dataclass(kind):
            return kind
    return None


@cache
def _find_completion(cls: type) -> Callable[[dict[str, Any]], dict[str, Any]]:
    """Return the function that adds default values to the keys of a document."""
    completion = find_handler("read document", getattr(cls, "schema", "") or cls.__qualname__)
    return _FIELD_CONVERSIONS.get(cls) or completion or dict


_evaluate_types = cache(get_type_hints)
"""Types of the fields of a class."""


_LAWS: dict[str, type] = {"wlf": WLF, "arrhenius": Arrhenius, "free": FreeShifts}


def _make_law(entries: dict[str, Any]) -> type:
    if entries["kind"] not in _LAWS:
        raise ValueError(f"law {entries['kind']!r} is none of {', '.join(_LAWS)}")
    return _LAWS[entries["kind"]]


def _make_solid(entries: dict[str, Any]) -> type:
    if entries.get("schema") == Parallel.schema:
        return Parallel
    return FractionalZener if "alpha" in entries else GeneralizedMaxwell


_CLASS_CHOICES: dict[type, Callable[[dict[str, Any]], type]] = {
    Solid: _make_solid,
    TemperatureLaw: _make_law,
    RateIndependent: lambda entries: Cubic if "k3" in entries else Jenkins,
}
"""Classes with several subclasses, and the function that chooses among them by an object."""


# -- Default values of missing keys --------------------------------------------------------------


def _convert_model(entries: dict[str, Any]) -> dict[str, Any]:
    """Return the fields of a model from its list of arms."""
    if "arms" not in entries:
        raise ValueError('a model has no "arms"; that of a spring alone is []')
    model_entries = {name: entries[name] for name in ("k_inf", "b") if name in entries}
    return model_entries | {name: [arm[name] for arm in entries["arms"]] for name in ("k", "tau")}


def _fit(entries: dict[str, Any]) -> dict[str, Any]:
    names = {status.name.lower(): status.value for status in Status}
    status = entries.get("status", "converged")
    if status not in names:
        raise ValueError(f"status {status!r} is none of {', '.join(names)}")
    value, model = entries.get("solid", {}), entries["model"]
    # a fit typed by hand may hold no more than a model: nothing else is then claimed
    empty_residual = {"n": 0, "sse": 0.0, "rms": 0.0}
    defaults = {"method": "full", "band_hz": [0.0, 0.0], **_diagonal_covariance(entries)}
    return (
        defaults
        | entries
        | {
            "status": names[status],
            "solid": value if value.get("family") == "fractional" else model,
            "residual": empty_residual | entries.get("residual", empty_residual),
            # the bare contract lists neither a candidate's significance nor its solid
            "orders": [order for order in entries.get("orders", []) if "model" in order],
        }
    )


def _diagonal_covariance(entries: dict[str, Any]) -> dict[str, Any]:
    """Return a diagonal covariance from standard errors."""
    errors = entries.get("standard_error")
    if not errors:
        return {"parameters": [], "covariance": [], "dof": 0.0}
    taus, arms = _convert_model(entries["model"])["tau"], errors["arms"]
    k, tau = (
        [*(arm[name] for arm in arms), *(None for _ in taus)][: len(taus)] for name in ("k", "tau")
    )
    numbers = range(1, len(taus) + 1)
    variances = [
        _square_error(errors["k_inf"]),
        *(_square_error(error) for error in k),
        *(_square_error(error) / time**2 for error, time in zip(tau, taus, strict=True)),
    ]
    return {
        "parameters": ["k_inf", *(f"k_{j}" for j in numbers), *(f"ln_tau_{j}" for j in numbers)],
        "covariance": np.diag(variances).tolist(),
        "dof": float("inf"),
    }


def _square_error(error: float | None) -> float:
    return np.inf if error is None else float(error) ** 2


def _convert_elastic_law(entries: dict[str, Any]) -> dict[str, Any]:
    """Return an elastic law, with the shape that a bare one leaves to its tangents."""
    if "ratio" in entries:
        return entries
    tangent = np.asarray(entries["tangent"], dtype=float)
    stiffness = float(np.trapezoid(tangent, entries["knots"]) / entries["knots"][-1])
    return entries | {"stiffness": stiffness, "ratio": (tangent / stiffness).tolist()}


_FIELD_CONVERSIONS: dict[type, Callable[[dict[str, Any]], dict[str, Any]]] = {
    GeneralizedMaxwell: _convert_model,
    Fit: _fit,
    ElasticLaw: _convert_elastic_law,
    # the bare contract does not say how long the seal was held
    EndOfHold: lambda entries: {"end_time": np.nan} | entries,
}
"""Constructors of classes that need more than their keys."""


# Contents of a JSON file of dashpot.


A_FIT = "a fit, as 'dashpot fit FILE -o fit.json' writes it"


def read_json_document(path: str | Path, *, hint: str = "") -> object:
    """Return the result in a JSON file; ``-`` is stdin.

    Raises
    ------
    ReadError
        If it is none; the sentence ends with the hint.
    """
    raw = open_raw(path)
    if not looks_like_json(raw.head(64)):
        raise ReadError(f"{path}: this is not a JSON document{hint}")
    try:
        return from_json(raw.head(raw.size).decode())
    except UnicodeDecodeError:
        raise ReadError(f"{path} is not a JSON document: it is not UTF-8 text") from None
    except ReadError as error:
        raise ReadError(f"{path}: {error}{hint}") from None


def read_fit(path: str | Path) -> Fit:
    """Return the fit in a JSON file, as written by ``dashpot fit -o``; ``-`` is stdin.

    Raises
    ------
    ReadError
        If it holds something else.
    """
    return _require_fit(path, read_json_document(path, hint=f"; expected {A_FIT}"))


def read_exported(path: str | Path) -> object:
    """Read a solid or a fit for an export; ``-`` is stdin.

    Raises
    ------
    ReadError
        If it holds something else.
    """
    document = read_json_document(
        path, hint=f"; expected {A_FIT}, or of FRFs at several amplitudes"
    )
    return document if find_handler("export", document) else _require_fit(path, document)


def _require_fit(path: str | Path, result: object) -> Fit:
    if not isinstance(result, Fit):
        raise ReadError(f"{format_unexpected_kind(path, result)}; expected {A_FIT}")
    return result


def format_unexpected_kind(path: str | Path, result: object) -> str:
    """Return the message for a document of another kind than the command needs."""
    return f"{path} is {_describe_kind(str(getattr(result, 'schema', '')))}"


def _describe_kind(schema: str) -> str:
    """Return the kind of document of a schema, and the command that reads it."""
    from dashpot.reading.columns.file_kinds import get_kind_command, get_kind_label

    kind = schema.partition("/")[2].partition("@")[0]
    use = get_kind_command(kind)
    return f"{get_kind_label(kind)}{f' ({use})' if use else ''}"
