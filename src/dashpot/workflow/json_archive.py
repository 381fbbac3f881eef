"""The archive: every noun as versioned JSON, back and forth."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import is_dataclass
from functools import cache
from itertools import zip_longest
from types import UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np

from dashpot.base.errors import DataError, ReadError
from dashpot.base.reported_values import NORMAL
from dashpot.base.serialisation import NOT_FINITE, Serialisable, decode_fields
from dashpot.base.status import Status
from dashpot.datamodel.bounds import EndOfHold
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.fit_diagnostics import DepthStiffness
from dashpot.datamodel.shift_factors import TemperatureShifts
from dashpot.planning.plan import Plan
from dashpot.registry import KINDS, find_handler, list_names, load_object
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.friction import Jenkins
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid
from dashpot.solids.nonlinear_springs import Cubic
from dashpot.solids.parallel import Parallel
from dashpot.solids.rate_independent import RateIndependent
from dashpot.solids.shift_laws import WLF, Arrhenius, FreeShifts, TemperatureLaw
from dashpot.vibration.comparison.comparison import Comparison
from dashpot.workflow.inspections import InspectedFile, Inspections
from dashpot.workflow.job import Job
from dashpot.workflow.json_validation import (
    find_mistyped_number,
    find_unknown_keys,
    has_edited_fit,
    require_unique_keys,
)
from dashpot.workflow.study import Study
from dashpot.workflow.vibration.impact_tests import ImpactResult

_OF_THE_JOB: dict[str, type[Serialisable]] = {
    noun.schema: noun
    for noun in (
        GeneralizedMaxwell, FractionalZener, Parallel, Fit, ImpactResult, Inspections, Comparison,
        Plan, Job, Study,
    )
}  # fmt: skip


@cache
def schemas() -> dict[str, type[Serialisable]]:
    """What each versioned schema name holds, those of every kind included, which it loads."""
    of_kinds = (load_object(noun) for kind in KINDS.values() for noun in kind.nouns)
    kept = (
        one for one in of_kinds if issubclass(one, Serialisable) and one.schema and one.read_back
    )
    others = {name: find_handler("document", name) for name in list_names("document")}
    return {**_OF_THE_JOB, **others, **{noun.schema: noun for noun in kept}}


def _find_schema_class(name: str) -> type[Serialisable] | None:
    """What a schema name holds; no kind is loaded for what the main job keeps."""
    return _OF_THE_JOB.get(name) or find_handler("document", name) or schemas().get(name)


def to_json(noun: object, *, indent: int | None = 2) -> str:
    """Return a noun as one JSON document: its ``"schema"``, SI units, floats in full precision.

    A fit and a comparison also carry the keys of the command line's contract.
    """
    import json

    return json.dumps(to_document(noun), indent=indent, ensure_ascii=False, allow_nan=False)


def to_document(noun: object) -> dict[str, Any]:
    """Return what :func:`to_json` writes, as plain dictionaries, lists, strings and numbers."""
    if not isinstance(noun, Serialisable) or _find_schema_class(noun.schema) is not type(noun):
        raise DataError(
            f"a {type(noun).__name__} has no archive form; expected one of "
            f"{', '.join(sorted(kind.__name__ for kind in schemas().values()))}"
        )
    return noun.document


def from_json(text: str | bytes) -> Any:
    """Return the noun that a JSON document holds.

    Raises
    ------
    ReadError
        If the text is not JSON, its schema is unknown, a value has the wrong type, or the
        document holds anything that the noun does not.
    """
    import msgspec

    kind, found = _parse_document(text)
    name = kind.schema
    try:
        with np.errstate(divide="raise", over="raise", invalid="raise"):
            noun = _convert_to_class(kind, _map_to_fields(kind, found))
            unknown = find_unknown_keys(found, to_document(noun))
            changed = has_edited_fit(found)
    except (*_WRONG, msgspec.ValidationError) as error:
        raise ReadError(f"the {name} document is not valid: {_because(error, found)}") from None
    if unknown:
        raise ReadError(f"the {name} document is not valid: {unknown}")
    if changed:
        raise ReadError(
            "the fit in this document is not the one that dashpot wrote: something in it was "
            'changed by hand; fit again, or take "digest" out of it if the change is meant'
        )
    return noun


_WRONG = (KeyError, TypeError, ValueError, ArithmeticError, AttributeError)
"""What a value of the wrong kind raises where a noun is made of it, beside msgspec's own."""


def _because(error: Exception, found: dict[str, Any]) -> str:
    """Why a document does not make its noun, in words."""
    import msgspec

    if isinstance(error, TypeError | msgspec.ValidationError):
        return find_mistyped_number(found) or str(error)
    if isinstance(error, AttributeError):
        return "a part has the wrong type"
    return f"{error} is missing" if isinstance(error, KeyError) else str(error)


def _parse_document(text: str | bytes) -> tuple[type[Serialisable], dict[str, Any]]:
    """What a JSON document is of, and its values."""
    import json

    try:
        found = json.loads(text, object_pairs_hook=require_unique_keys)
    except (ValueError, RecursionError) as error:
        raise ReadError(f"this is not a JSON document: {error}") from None
    name = found.get("schema") if isinstance(found, dict) else None
    kind = _find_schema_class(name) if isinstance(name, str) else None
    if kind is None:
        raise ReadError(
            f'the document\'s "schema" is {name!r}; this version of dashpot reads '
            f"{', '.join(sorted(schemas()))}"
        )
    return kind, found


# -- plain values to nouns -----------------------------------------------------------------------


def _map_to_fields(kind: Any, value: Any) -> Any:
    """What a document has of a value of this kind, every noun in it by its fields."""
    if isinstance(value, str):
        return NOT_FINITE.get(value, value)
    if not isinstance(value, list | dict):
        return value
    kinds = get_args(kind) if get_origin(kind) in {Union, UnionType} else (kind,)
    if isinstance(value, list):
        of = next((get_args(one) for one in kinds if get_origin(one) is tuple), (Any, ...))
        each = of[:1] * len(value) if ... in of else of
        return [_map_to_fields(*pair) for pair in zip_longest(each, value)][: len(value)]
    noun = _find_value_class(kinds, value)
    if noun is None:
        return {key: _map_to_fields(Any, item) for key, item in value.items()}
    hints, found = _hints(noun), decode_fields(noun, _find_completion(noun)(value))
    laid = {name: _map_to_fields(hints[name], item) for name, item in found.items()}
    # the decoder knows no noun of which there are several kinds
    return _convert_to_class(noun, laid) if _CHOSEN.keys() & kinds else laid


def _convert_to_class(noun: type, laid: dict[str, Any]) -> Any:
    import msgspec

    return msgspec.convert(laid, type=noun, dec_hook=_decode_value)


def _decode_value(kind: type, value: Any) -> Any:
    """Return what the decoder does not know: an array, or a noun that was chosen already."""
    if isinstance(value, dict) and set(value) == {"real", "imag"}:
        return np.asarray(value["real"], dtype=float) + 1j * np.asarray(value["imag"], dtype=float)
    if isinstance(value, list):
        array = np.asarray(value, dtype=float)
        return array.reshape(0, 0) if array.size == 0 and array.ndim == 1 else array
    if isinstance(value, tuple(_CHOSEN)):
        return value
    raise TypeError(f"expected an array, found {type(value).__name__} for {kind}")


def _find_value_class(kinds: Sequence[Any], value: dict[str, Any]) -> type | None:
    """The noun that an object of a document is of; None of one that holds any keys."""
    for kind in kinds:
        if kind in _CHOSEN:
            return _CHOSEN[kind](value)
        if isinstance(kind, type) and is_dataclass(kind):
            return kind
    return None


@cache
def _find_completion(noun: type) -> Callable[[dict[str, Any]], dict[str, Any]]:
    """Return what adds to the values of a document what its keys leave out."""
    other = find_handler("read document", getattr(noun, "schema", ""))
    return _FILLED.get(noun) or other or dict


@cache
def _hints(noun: type) -> dict[str, Any]:
    return get_type_hints(noun)


_LAWS: dict[str, type] = {"wlf": WLF, "arrhenius": Arrhenius, "free": FreeShifts}


def _law_of(found: dict[str, Any]) -> type:
    if found["kind"] not in _LAWS:
        raise ValueError(f"law {found['kind']!r} is none of {', '.join(_LAWS)}")
    return _LAWS[found["kind"]]


def _solid_of(found: dict[str, Any]) -> type:
    if found.get("schema") == Parallel.schema:
        return Parallel
    return FractionalZener if "alpha" in found else GeneralizedMaxwell


_CHOSEN: dict[type, Callable[[dict[str, Any]], type]] = {
    Solid: _solid_of,
    TemperatureLaw: _law_of,
    RateIndependent: lambda found: Cubic if "k3" in found else Jenkins,
}
"""Nouns of which there are several kinds, and which of them an object of a document is."""


# -- what the bare contract leaves out, and what no key says -------------------------------------


def _model(found: dict[str, Any]) -> dict[str, Any]:
    """The fields of a model from its list of arms."""
    if "arms" not in found:
        raise ValueError('a model has no "arms"; that of a spring alone is []')
    rest = {name: found[name] for name in ("k_inf", "b") if name in found}
    return rest | {name: [arm[name] for arm in found["arms"]] for name in ("k", "tau")}


def _fit(found: dict[str, Any]) -> dict[str, Any]:
    names = {status.name.lower(): status.value for status in Status}
    status = found.get("status", "converged")
    if status not in names:
        raise ValueError(f"status {status!r} is none of {', '.join(names)}")
    own, model = found.get("solid", {}), found["model"]
    # a fit typed by hand may hold no more than a model: nothing else is then claimed
    nothing = {"n": 0, "sse": 0.0, "rms": 0.0}
    defaults = {"method": "full", "band_hz": [0.0, 0.0], **_diagonal_covariance(found)}
    return (
        defaults
        | found
        | {
            "status": names[status],
            "solid": own if own.get("family") == "fractional" else model,
            "residual": nothing | found.get("residual", nothing),
            # the bare contract lists neither a candidate's significance nor its solid
            "orders": [order for order in found.get("orders", []) if "model" in order],
        }
    )


def _diagonal_covariance(found: dict[str, Any]) -> dict[str, Any]:
    """Return the covariance that bare standard errors stand for: uncorrelated, normal."""
    errors = found.get("standard_error")
    if not errors:
        return {"parameters": [], "covariance": [], "dof": 0.0}
    taus, arms = _model(found["model"])["tau"], errors["arms"]
    k, tau = (
        [*(arm[name] for arm in arms), *(None for _ in taus)][: len(taus)] for name in ("k", "tau")
    )
    numbers = range(1, len(taus) + 1)
    variances = [
        _square(errors["k_inf"]),
        *(_square(error) for error in k),
        *(_square(error) / time**2 for error, time in zip(tau, taus, strict=True)),
    ]
    return {
        "parameters": ["k_inf", *(f"k_{j}" for j in numbers), *(f"ln_tau_{j}" for j in numbers)],
        "covariance": np.diag(variances).tolist(),
        "dof": float("inf"),
    }


def _square(error: float | None) -> float:
    return np.inf if error is None else float(error) ** 2


def _elastic(found: dict[str, Any]) -> dict[str, Any]:
    """An elastic law, with the shape that a bare one leaves to its tangents."""
    if "ratio" in found:
        return found
    tangent = np.asarray(found["tangent"], dtype=float)
    stiffness = float(np.trapezoid(tangent, found["knots"]) / found["knots"][-1])
    return found | {"stiffness": stiffness, "ratio": (tangent / stiffness).tolist()}


def _convert_old_depth(found: dict[str, Any]) -> dict[str, Any]:
    """The stiffnesses of one depth; an older document holds the standard error of k_inf."""
    error = found.get("k_inf_se")
    if error is None:
        return found
    return {"k_inf_most": found["k_inf"] + NORMAL * error} | found


def _shifts(found: dict[str, Any]) -> dict[str, Any]:
    """Shifts whose law has their reference; the bare contract holds the errors alone."""
    count = 2 * len(found["shifts"])
    law = {**found["law"], "reference": found["reference"]}
    return {"covariance": np.zeros((count, count)).tolist(), **found, "law": law}


def _convert_old_inspection(found: dict[str, Any]) -> dict[str, Any]:
    account = found.get("preparation", {})
    if "error" not in account:
        return found
    rest = {key: item for key, item in found.items() if key != "preparation"}
    return rest | {"refusal": account["error"]}


_FILLED: dict[type, Callable[[dict[str, Any]], dict[str, Any]]] = {
    GeneralizedMaxwell: _model,
    Fit: _fit,
    ElasticLaw: _elastic,
    TemperatureShifts: _shifts,
    DepthStiffness: _convert_old_depth,
    # the bare contract does not say how long the seal was held
    EndOfHold: lambda found: {"time": np.nan} | found,
    InspectedFile: _convert_old_inspection,
}
"""What is more of a noun than its keys turned back."""
