"""The archive: every noun as versioned JSON, back and forth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import singledispatch
from typing import Any

import numpy as np

from dashpot.base.checks import Check
from dashpot.base.errors import DataError, ReadError
from dashpot.base.facts import Fact
from dashpot.base.numbers import json_number
from dashpot.base.status import Status
from dashpot.kinds.hyperelastic.record import HyperelasticFit
from dashpot.planning.plan import Plan
from dashpot.records.alternative import Alternative
from dashpot.records.creep import CreepCompliance, CreepTest, LoadHold
from dashpot.records.dynamic import DynamicTest
from dashpot.records.estimate import ParameterEstimate
from dashpot.records.fit import Evidence, Fit, Provenance
from dashpot.records.frf import FRF
from dashpot.records.impact import ImpactTest
from dashpot.records.relaxation import RampHold, RelaxationTest
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.fractional import FractionalZener
from dashpot.solids.maxwell import GeneralizedMaxwell, Solid
from dashpot.solids.parallel import Parallel
from dashpot.solids.temperature import WLF, Arrhenius, FreeShifts, TemperatureLaw
from dashpot.vibration.comparison.comparison import Comparison
from dashpot.workflow.documents import DIGEST, digest_of, edited, mistyped, once, strange
from dashpot.workflow.impacts import ImpactResult
from dashpot.workflow.inspections import InspectedFile, Inspections
from dashpot.workflow.job import Job
from dashpot.workflow.level_document import LevelDocument
from dashpot.workflow.measured_modes import MeasuredModes
from dashpot.workflow.study import Study

SCHEMAS: dict[str, type] = {
    "dashpot/model@1": GeneralizedMaxwell,
    "dashpot/fractional@1": FractionalZener,
    "dashpot/parallel@1": Parallel,
    "dashpot/relaxation-test@1": RelaxationTest,
    "dashpot/ramp-hold@1": RampHold,
    "dashpot/dynamic-test@1": DynamicTest,
    "dashpot/creep-test@1": CreepTest,
    "dashpot/load-hold@1": LoadHold,
    "dashpot/creep-compliance@1": CreepCompliance,
    "dashpot/fit@1": Fit,
    "dashpot/hyperelastic@1": HyperelasticFit,
    "dashpot/levels@1": LevelDocument,
    "dashpot/impact-test@1": ImpactTest,
    "dashpot/frf@1": FRF,
    "dashpot/impact@1": ImpactResult,
    "dashpot/modes@1": MeasuredModes,
    "dashpot/inspection@1": Inspections,
    "dashpot/comparison@1": Comparison,
    "dashpot/plan@1": Plan,
    "dashpot/job@1": Job,
    "dashpot/study@1": Study,
}
"""What each versioned schema name holds."""

_NAMES = {noun: name for name, noun in SCHEMAS.items()}
# JSON has no such numbers; a string that no measurement can be mistaken for stands in
_NOT_FINITE = {"Infinity": np.inf, "-Infinity": -np.inf, "NaN": np.nan}


def to_json(noun: object, *, indent: int | None = 2) -> str:
    """Return a noun as one JSON document: its ``"schema"``, SI units, floats in full precision.

    A fit and a comparison also carry the keys of the command line's contract.
    """
    import json

    return json.dumps(document(noun), indent=indent, ensure_ascii=False, allow_nan=False)


def document(noun: object) -> dict[str, Any]:
    """Return what :func:`to_json` writes, as plain dictionaries, lists, strings and numbers."""
    if type(noun) not in _NAMES:
        raise DataError(
            f"a {type(noun).__name__} has no archive form; expected one of "
            f"{', '.join(sorted(kind.__name__ for kind in _NAMES))}"
        )
    plain: dict[str, Any] = _plain(noun)
    return plain


def from_json(text: str | bytes) -> Any:
    """Return the noun that a JSON document holds.

    Raises
    ------
    ReadError
        If the text is not JSON, its schema is unknown, a value has the wrong type, or the
        document holds anything that the noun does not.
    """
    import msgspec

    name, found = _opened(text)
    try:
        with np.errstate(divide="raise", over="raise", invalid="raise"):
            noun: Any = msgspec.convert(_restored(found), type=SCHEMAS[name], dec_hook=_decoded)
            unknown = strange(found, document(noun))
            changed = edited(found)
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
        return mistyped(found) or str(error)
    if isinstance(error, AttributeError):
        return "a part has the wrong type"
    return f"{error} is missing" if isinstance(error, KeyError) else str(error)


def _opened(text: str | bytes) -> tuple[str, dict[str, Any]]:
    """The schema and the values of a JSON document."""
    import json

    try:
        found = json.loads(text, object_pairs_hook=once)
    except (ValueError, RecursionError) as error:
        raise ReadError(f"this is not a JSON document: {error}") from None
    name = found.get("schema") if isinstance(found, dict) else None
    if not isinstance(name, str) or name not in SCHEMAS:
        raise ReadError(
            f'the document\'s "schema" is {name!r}; this version of dashpot reads '
            f"{', '.join(sorted(SCHEMAS))}"
        )
    if name == "dashpot/levels@1" and "model" not in found:
        what = "a law of stiffness and loss" if "law" in found else "hits of different height"
        raise ReadError(
            f"the {name} document holds {what}, which has no force along a path: arms and sliders "
            "are what 'dashpot level' finds of FRFs of one mass at several levels"
        )
    return name, found


# -- nouns to plain values -----------------------------------------------------------------------


# msgspec encodes a dataclass without asking: the schema and the layout of an inner noun would be
# lost, so this walk stays; cattrs would take a hook per noun and a dependency more
@singledispatch
def _plain(value: Any) -> Any:
    if not is_dataclass(value):
        return value
    plain = {one.name: _plain(getattr(value, one.name)) for one in fields(value)}
    name = _NAMES.get(type(value))
    if type(value) in _CONTRACTS:
        plain = _CONTRACTS[type(value)](value, plain)
    whole = {"schema": name, **plain} if name else plain
    sealed = isinstance(value, Fit | LevelDocument)
    return {**whole, DIGEST: digest_of(whole)} if sealed else whole


@_plain.register(np.ndarray)
@_plain.register(np.generic)
def _(value: Any) -> Any:
    if np.iscomplexobj(value):
        return {"real": _plain(value.real), "imag": _plain(value.imag)}
    return _plain(value.tolist())


_plain.register(float, json_number)
_plain.register(Check, lambda check: check.document)
_plain.register(Fact, lambda fact: fact.document)
_plain.register(Enum, lambda value: value.value)
_plain.register(Status, lambda value: value.name.lower())
_plain.register(tuple, lambda value: [_plain(item) for item in value])
_plain.register(list, lambda value: [_plain(item) for item in value])
_plain.register(dict, lambda value: {str(key): _plain(item) for key, item in value.items()})


def _model_contract(model: GeneralizedMaxwell, _plain_model: dict[str, Any]) -> dict[str, Any]:
    arms = zip(model.k, model.tau, model.arm_b, strict=True)
    return {
        "k_inf": model.k_inf,
        "b": model.b,
        "arms": [{"k": k, "tau": tau, "b": _plain(b)} for k, tau, b in arms],
    }


# a fit's document is flat: its parts are laid out side by side, in this order
_FIT_PARTS: dict[str, type] = {
    "estimate": ParameterEstimate,
    "evidence": Evidence,
    "provenance": Provenance,
}
_END_OF_HOLD = ("k_inf", "k_end", "k_3end", "time", "falling")
_FIT_ORDER = (
    "method", "parameters", "covariance", "dof", "orders", "certificate", "profiles", "nuisance",
    "checks", "source", "steps", "by_depth", "specimen", "moved", "explanations", "alternative",
    "unit",
)  # fmt: skip


def _fit_contract(fit: Fit, plain: dict[str, Any]) -> dict[str, Any]:
    for part in _FIT_PARTS:
        plain |= plain.pop(part)
    mass = next((item.value for item in fit.nuisance if item.name == "mass"), None)
    return {
        "id": fit.identity,
        "status": plain["status"],
        "ok": fit.ok,
        "says": fit.status.value,
        "verdict": fit.verdict.document,
        "model": _plain(fit.model),
        "solid": _solid(fit),
        "standard_error": _standard_error(fit),
        "interval_95": _numbers_or_null(dict(fit.intervals(level=0.95))),
        "residual": plain["residual"],
        "band_hz": plain["band"],
        "elastic_law": _law(fit.elastic_law),
        "left_open": _left_open(plain.pop("end_of_hold")),
        "temperature": _temperature(fit, plain.pop("temperatures")),
        **({} if mass is None else {"mass": mass}),
        **({} if fit.creep is None else {"creep": plain["creep"]}),
        **{key: plain[key] for key in _FIT_ORDER},
    }


def _solid(fit: Fit) -> dict[str, Any]:
    """What was fitted: of another family than arms with its own parameters and their errors."""
    if fit.family == "maxwell":
        return {"family": fit.family}
    ends, error = fit.solid_intervals(level=0.95), fit.solid_standard_error
    return {
        "family": fit.family,
        **{one.name: getattr(fit.solid, one.name) for one in fields(type(fit.solid))},  # type: ignore[arg-type]
        "standard_error": _numbers_or_null(error),
        "interval_95": _numbers_or_null(ends),
    }


def _law(law: ElasticLaw | None) -> dict[str, Any] | None:
    if law is None:
        return None
    knots = list(law.knots)
    return {"kind": law.kind, "knots": knots, "tangent": law.tangent(knots).tolist(),
            "ratio": list(law.ratio), "ratio_se": list(law.ratio_se),
            "stiffness": law.stiffness}  # fmt: skip


def _temperature(fit: Fit, plain: dict[str, Any] | None) -> dict[str, Any] | None:
    """The reference, the law by its kind, and a shift for every tested temperature."""
    if fit.temperatures is None or plain is None:
        return None
    law = {"kind": fit.temperatures.law.kind, **plain.pop("law")}
    law.pop("reference")
    return {"reference": fit.temperatures.reference, "law": law, **plain}


def _left_open(end: dict[str, Any] | None) -> dict[str, Any] | None:
    """What a record leaves open of one stiffness, N/m, and the time T of k(T), s."""
    return None if end is None else {key: end[key] for key in _END_OF_HOLD}


def _standard_error(fit: Fit) -> dict[str, Any]:
    error = fit.standard_error
    arms = [
        {"k": k, "tau": tau, "b": b}
        for k, tau, b in zip(error["k"], error["tau"], error["b"], strict=True)
    ]
    whole: dict[str, Any] = _numbers_or_null({"k_inf": error["k_inf"], "arms": arms})
    return whole


def _judged_contract(found: HyperelasticFit, plain: dict[str, Any]) -> dict[str, Any]:
    return {"verdict": found.verdict.document, **plain}


def _comparison_contract(comparison: Comparison, plain: dict[str, Any]) -> dict[str, Any]:
    decibels = 20 * np.log10(comparison.predicted_peak / comparison.measured_peak)
    predicted, measured = comparison.predicted_damping, comparison.measured_damping
    found = {
        "peak": {
            "predicted_hz": comparison.predicted_hz,
            "measured_hz": comparison.measured_hz,
            "difference_percent": 100 * (comparison.predicted_hz / comparison.measured_hz - 1),
            "predicted": comparison.predicted_peak,
            "measured": comparison.measured_peak,
            "ratio": comparison.predicted_peak / comparison.measured_peak,
            "ratio_db": float(decibels),
        },
        "damping": {
            "predicted": predicted,
            "measured": measured,
            "ratio": predicted / measured if predicted and measured else None,
        },
    }
    return {**_plain(found), "verdict": comparison.verdict.document, **plain}


def _study_contract(study: Study, plain: dict[str, Any]) -> dict[str, Any]:
    return {"verdict": study.verdict.document, **plain}


def _impact_contract(result: ImpactResult, plain: dict[str, Any]) -> dict[str, Any]:
    frf = plain["frf"]
    return {
        "estimator": result.estimator,
        "window": result.window,
        "averages": result.frf.averages,
        "modes": plain["modes"],
        "peak": result.peak,
        **{key: frf[key] for key in ("hits", "checks", "source")},
        "file": result.file,
        "frf": frf,
    }


def _modes_contract(_found: MeasuredModes, plain: dict[str, Any]) -> dict[str, Any]:
    return {**{key: plain["frf"][key] for key in ("checks", "source")}, **plain}


def _inspected_contract(_file: InspectedFile, plain: dict[str, Any]) -> dict[str, Any]:
    refusal, ready = plain.pop("refusal"), plain.pop("preparation")
    account = {"error": refusal} if refusal else ready
    return {**plain, "preparation": account} if account else plain


_CONTRACTS: dict[type, Callable[[Any, dict[str, Any]], dict[str, Any]]] = {
    Alternative: lambda found, plain: {"family": found.family, **plain},
    GeneralizedMaxwell: _model_contract,
    Fit: _fit_contract,
    Comparison: _comparison_contract,
    Study: _study_contract,
    ImpactResult: _impact_contract,
    HyperelasticFit: _judged_contract,
    MeasuredModes: _modes_contract,
    InspectedFile: _inspected_contract,
}


def _numbers_or_null(value: Any) -> Any:
    """Plain values with null for what is not known, as the contract's readers expect."""
    if isinstance(value, dict):
        return {key: _numbers_or_null(item) for key, item in value.items()}
    if isinstance(value, tuple | list):
        return [_numbers_or_null(item) for item in value]
    return float(value) if np.isfinite(value) else None


# -- plain values to nouns -----------------------------------------------------------------------


def _restored(value: Any) -> Any:
    """Undo what the contract layouts and JSON itself did to the fields."""
    if isinstance(value, list):
        return [_restored(item) for item in value]
    if isinstance(value, str):
        return _NOT_FINITE.get(value, value)
    return _restored_object(value) if isinstance(value, dict) else value


def _restored_object(value: dict[str, Any]) -> dict[str, Any]:
    schema = value.get("schema")
    _refuse_without_arms(value if schema == "dashpot/model@1" else value.get("model"))
    if "arms" in value and "k_inf" in value:
        return _restored_model(value)
    restored = {key: _restored(item) for key, item in value.items()}
    if schema == "dashpot/fit@1":
        return _restored_fit(restored)
    if "preparation" in restored and "error" in restored["preparation"]:
        restored["refusal"] = restored.pop("preparation")["error"]
    return restored


def _refuse_without_arms(model: Any) -> None:
    if isinstance(model, dict) and "arms" not in model:
        raise ValueError('a model has no "arms"; that of a spring alone is []')


def _restored_model(value: dict[str, Any]) -> dict[str, Any]:
    """The fields of a model, or of its errors, from a list of arms."""
    k, tau = ([arm[name] for arm in value["arms"]] for name in ("k", "tau"))
    return {"k_inf": _restored(value["k_inf"]), "b": value.get("b", 0.0), "k": k, "tau": tau}


def _restored_fit(found: dict[str, Any]) -> dict[str, Any]:
    names = {status.name.lower(): status.value for status in Status}
    status = found.get("status", "converged")
    if status not in names:
        raise ValueError(f"status {status!r} is none of {', '.join(names)}")
    # a fit typed by hand may hold no more than a model: nothing else is then claimed
    defaults: dict[str, Any] = {
        "method": "full",
        "residual": {"n": 0, "sse": 0.0, "rms": 0.0},
        **_diagonal_covariance(found),
    }
    found = defaults | found | {"status": names[status]}
    found["residual"] = defaults["residual"] | found["residual"]
    found["band"] = found.pop("band_hz", [0.0, 0.0])
    # the bare contract lists neither a candidate's significance nor its solid
    found["orders"] = [order for order in found.get("orders", []) if "model" in order]
    model, own = found.pop("model"), found.get("solid", {})
    found["solid"] = own if own.get("family") == "fractional" else model
    found["elastic_law"] = _restored_law(found.get("elastic_law"))
    found["temperatures"] = _restored_temperature(found.pop("temperature", None))
    left = found.pop("left_open", None)
    # the bare contract does not say how long the seal was held, nor how the force still falls
    found["end_of_hold"] = left and {"time": np.nan, "falling": np.nan} | left
    for part, kind in _FIT_PARTS.items():
        found[part] = {one.name: found[one.name] for one in fields(kind) if one.name in found}
    return found


def _restored_law(found: dict[str, Any] | None) -> dict[str, Any] | None:
    """An elastic law, with the shape that a bare one leaves to its tangents."""
    if not found or "ratio" in found:
        return found
    tangent = np.asarray(found["tangent"], dtype=float)
    stiffness = float(np.trapezoid(tangent, found["knots"]) / found["knots"][-1])
    return found | {"stiffness": stiffness, "ratio": (tangent / stiffness).tolist()}


_LAWS: dict[str, type] = {"wlf": WLF, "arrhenius": Arrhenius, "free": FreeShifts}


def _restored_temperature(found: dict[str, Any] | None) -> dict[str, Any] | None:
    if found is None:
        return None
    reference, count = found["reference"], 2 * len(found["shifts"])
    law = {**found["law"], "reference": reference}
    if law["kind"] not in _LAWS:
        raise ValueError(f"law {law['kind']!r} is none of {', '.join(_LAWS)}")
    # the bare contract holds the errors alone
    bare = {"covariance": np.zeros((count, count)).tolist()}
    return {**bare, **{key: found[key] for key in found if key != "reference"}, "law": law}


def _diagonal_covariance(found: dict[str, Any]) -> dict[str, Any]:
    """Return the covariance that bare standard errors stand for: uncorrelated, normal."""
    errors = found.get("standard_error")
    if not errors:
        return {"parameters": [], "covariance": [], "dof": 0.0}
    taus = found["model"]["tau"]
    # standard errors are laid out as the model is, and so were restored like one
    k, tau = ([*errors[name], *(None for _ in taus)][: len(taus)] for name in ("k", "tau"))
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


def _decoded(kind: type, value: Any) -> Any:
    """Return a solid, a law or an array, which the decoder does not know."""
    if kind is TemperatureLaw:
        import msgspec

        law = dict(value)
        return msgspec.convert(law, _LAWS[law.pop("kind")])
    if kind is Solid:
        import msgspec

        kind = FractionalZener if "alpha" in value else GeneralizedMaxwell
        return msgspec.convert(value, kind)
    if isinstance(value, dict) and set(value) == {"real", "imag"}:
        return np.asarray(value["real"], dtype=float) + 1j * np.asarray(value["imag"], dtype=float)
    if isinstance(value, list):
        array = np.asarray(value, dtype=float)
        return array.reshape(0, 0) if array.size == 0 and array.ndim == 1 else array
    raise TypeError(f"expected an array, found {type(value).__name__} for {kind}")
