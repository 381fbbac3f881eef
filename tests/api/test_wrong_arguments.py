"""Whatever type an argument of a public function has, the answer is a result or a sentence."""

from __future__ import annotations

import contextlib
import inspect
import warnings
from collections.abc import Callable, Mapping
from fractions import Fraction
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np
import pytest
from kit.verbs import CASES, FUNCTIONS

import dashpot as dp
from dashpot.base.result_mixins import Printable
from dashpot.extensions.batch import api as batch_api
from dashpot.extensions.guidance import argument_types, call_errors
from dashpot.registry import list_names, load_object
from dashpot.solids.fractional import FractionalZener
from dashpot.workflow.example_files import FILES, MASS

WRONG: Mapping[str, Any] = {
    "None": None, "word": "x1y", "text of a number": "2", "empty text": "", "empty list": [],
    "number and unit": (114.8, "g"), "one item": (1,), "mapping": {"a": 1}, "object": object(),
    "True": True, "nan": float("nan"), "-1": -1, "infinite": float("inf"), "path": Path("no.csv"),
    "bytes": b"1", "complex": 1j, "array": np.array([2.0, 1.0]), "nested list": [["1Hz"]],
    "huge": 10**400, "list of a text": ["1Hz"], "class": dict,
}  # fmt: skip


class _Records:
    """Records and results that the calls below are of; each is made once."""

    def __init__(self, folder: Path) -> None:
        self.test = dp.simulate("relaxation", hold="2s", rate="200Hz", noise_free=True)
        self.file, hits = folder / "seal_8mm.csv", folder / "hammer.csv"
        dp.save(self.test, self.file)
        hits.write_text(FILES["hammer.csv"].write(), encoding="utf-8")
        self.hits = dp.read(hits)
        self.frf = self.hits.frf()
        self.fit = dp.fit(self.test, arms=1)
        self.folder = folder


@pytest.fixture(scope="module")
def records(tmp_path_factory: pytest.TempPathFactory) -> _Records:
    return _Records(tmp_path_factory.mktemp("wrong"))


Call = Callable[..., Any]
_MASS: dict[str, Any] = {"mass": MASS, "seals": 2}
#: what is called -> the call, and what it is given beside the wrong argument
CALLS: Mapping[str, tuple[Callable[[_Records], Call], dict[str, Any]]] = {
    "fit tests": (lambda r: lambda **k: dp.fit(r.test, **k), {"arms": 1}),
    "fit hits": (lambda r: lambda **k: dp.fit(r.hits, **k), {}),
    "fit both": (lambda r: lambda **k: dp.fit(r.fit, r.frf, **k), _MASS | {"arms": 1}),
    "predict": (lambda r: lambda **k: dp.predict(r.fit, **k), {"mass": MASS}),
    "predict solid": (lambda r: lambda **k: dp.predict(r.fit.model, **k), {"mass": MASS}),
    "predict stiffness": (lambda r: lambda **k: dp.predict(r.fit, **k), {"frequency": "1Hz"}),
    "compare": (lambda r: lambda **k: dp.compare(r.fit, r.frf, **k), _MASS),
    "compare FRFs": (lambda r: lambda **k: dp.compare(r.frf, r.frf, **k), {}),
    "report": (lambda r: lambda **k: dp.report(r.test, **k), {"arms": 1}),
    "export": (
        lambda r: lambda **k: dp.export(r.fit, **k),
        {"to": "nastran", "unit_system": "SI", "temperature": "23degC", "length": "0.1m",
         "allow": "all"},
    ),
    "plan": (lambda r: dp.plan, {"frequency": "5Hz", "hold": "2s", "rate": "100Hz"}),
    "simulate relaxation": (
        lambda r: lambda **k: dp.simulate("relaxation", **k), {"hold": "1s", "rate": "100Hz"},
    ),
    "simulate creep": (
        lambda r: lambda **k: dp.simulate("creep", **k), {"hold": "1s", "rate": "100Hz"},
    ),
    "simulate impact": (lambda r: lambda **k: dp.simulate("impact", **k), {"hits": 1}),
    "read": (lambda r: lambda **k: dp.read(r.file, **k), {}),
    "inspect": (lambda r: lambda **k: dp.inspect(r.file, **k), {}),
    "batch": (
        lambda r: lambda **k: dp.batch(r.file, **k), {"arms": 1, "quick": True, "jobs": 1},
    ),
    "batch of arrays": (
        lambda r: lambda **k: dp.batch([r.test.force], **k), {"units": "SI", "arms": 1},
    ),
    "save": (lambda r: dp.save, {"result": dp.GeneralizedMaxwell(1.0), "path": "result.json"}),
}  # fmt: skip
#: arguments by place: what is called -> the call with it
PLACES: Mapping[str, Callable[[_Records, Any], Any]] = {
    "fit": lambda r, wrong: dp.fit(wrong),
    "fit with": lambda r, wrong: dp.fit(r.test, wrong),
    "predict": lambda r, wrong: dp.predict(wrong, mass=MASS),
    "compare": lambda r, wrong: dp.compare(wrong, r.frf),
    "compare with": lambda r, wrong: dp.compare(r.fit, wrong),
    "report": lambda r, wrong: dp.report(wrong),
    "report with": lambda r, wrong: dp.report(r.test, wrong, arms=1),
    "export": lambda r, wrong: dp.export(wrong, to="nastran"),
    "export to": lambda r, wrong: dp.export(r.fit, wrong, to="csv"),
    "simulate": lambda r, wrong: dp.simulate(wrong),
    "read": lambda r, wrong: dp.read(wrong),
    "inspect": lambda r, wrong: dp.inspect(wrong),
    "batch": lambda r, wrong: dp.batch(wrong),
    "batch of arrays": lambda r, wrong: dp.batch(
        wrong, time=r.test.time, displacement=r.test.displacement, units="SI"
    ),
    "save": lambda r, wrong: dp.save(wrong, "result.json"),
    "save to": lambda r, wrong: dp.save(r.fit, wrong),
    "save swapped": lambda r, wrong: dp.save("result.json", r.fit),
}  # fmt: skip
_VERBS = {function.__name__: function for function in FUNCTIONS}
#: parameters of arrays, which come together
_ARRAYS = {"time", "displacement", "ramp", "units", "errors"}


def _list_options() -> list[tuple[str, str]]:
    """Return each call with each option that its function has."""
    options = []
    for name in CALLS:
        for parameter in inspect.signature(_VERBS[name.split()[0]]).parameters.values():
            if parameter.kind is parameter.KEYWORD_ONLY or name == "save":
                options.append((name, parameter.name))
    return options


def test_every_verb_is_called() -> None:
    assert {name.split()[0] for name in CALLS} == _VERBS.keys()


@pytest.mark.parametrize(("name", "option"), _list_options())
def test_option_of_any_type_is_answered(
    records: _Records, name: str, option: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(records.folder)
    make_call, stated = CALLS[name]
    if "arrays" in name:
        stated = stated | {"time": records.test.time, "displacement": records.test.displacement}
    call = make_call(records)
    for word, wrong in WRONG.items():
        if name == "report" and word in {"None", "True", "-1", "mapping"}:
            continue  # may be valid, and takes seconds
        try:
            assert call(**stated | {option: wrong}) is not None
        except dp.DashpotError as error:
            assert len(str(error).split()) > 3  # noqa: PT017 -- any other exception is a fault


@pytest.mark.parametrize("name", PLACES)
def test_argument_of_any_type_is_answered(
    records: _Records, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(records.folder)
    for wrong in WRONG.values():
        with contextlib.suppress(dp.DashpotError):
            assert PLACES[name](records, wrong) is not None


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda r: dp.fit(r.fit, r.frf, mass=(114.8, "g")), 'such as mass="114.8g"'),
        (lambda r: dp.fit(r.fit, r.frf, mass=MASS, seals="2"), "seals= is '2'.*such as seals=2"),
        (lambda r: dp.fit(r.frf, band=(1,)), r"band= is \(1,\); expected two numbers"),
        (lambda r: dp.predict(r.fit, frequency=[]), "frequency= is empty"),
        (lambda r: dp.predict(r.fit, frequency=None), "frequency= is None"),
        (lambda r: dp.save("a.json", r.fit), "path is of the type Fit; expected the path of a fi"),
        (lambda r: dp.export("a.json", to="csv"), r'Read the file first: dp\.read\("a\.json"\)'),
        (lambda r: dp.predict(r.fit, mass=MASS, quantity="x"), "'x'; expected one of receptance"),
    ],
)
def test_sentence_names_argument_and_example(
    records: _Records, call: Callable[[_Records], Any], message: str
) -> None:
    with pytest.raises(dp.DashpotError, match=message):
        call(records)


def _list_parameters() -> list[inspect.Parameter]:
    """Return the parameters of each function whose arguments are checked."""
    words = [case for cases in CASES.values() for case in cases if case]
    functions: list[Any] = [load_object(case) if isinstance(case, str) else case for case in words]
    functions += [*FUNCTIONS, batch_api._fit_files, batch_api._fit_arrays]
    return [
        parameter
        for function in functions
        for parameter in inspect.signature(function).parameters.values()
    ]


def test_every_annotation_is_understood() -> None:
    """A word is a type of the table, or a class by its name; an alias would refuse everything."""
    public = {name.rpartition(":")[2] for name in (*list_names("figure"), *list_names("document"))}
    classes = public | set(dp.__all__) | {
        "HasVerdict", "Solid", "Shear", "Stations", "Disc", "Block", "Bush", "Bulb", "ShakenTest",
        "HammerChoices", "HammerRig", "SolidPrior", "TimeLimits", "ReadOptions", "Aging",
        "ElasticLawPrior", "PluggedTest",
    }  # fmt: skip
    unknown = {
        word
        for parameter in _list_parameters()
        for word in argument_types._split(str(parameter.annotation))
        if argument_types._is_class(word) and word not in classes
    }
    assert unknown == set()


def test_every_quantity_has_an_example() -> None:
    names = {
        parameter.name
        for parameter in _list_parameters()
        if {"Quantity", "Range"} & set(argument_types._split(str(parameter.annotation)))
    }
    assert names - argument_types._EXAMPLES.keys() == set()


#: method -> the result that has it, and what it is given beside the wrong argument
METHODS: Mapping[str, tuple[Callable[[_Records], Any], dict[str, Any]]] = {
    "at": (lambda r: r.fit, {"temperature": "23degC"}),
    "at_compression": (lambda r: r.fit, {"compression": "4mm"}),
    "at_temperature": (lambda r: r.fit, {"temperature": "23degC"}),
    "in_parallel": (lambda r: r.fit, {"count": 2}),
    "intervals": (lambda r: r.fit, {"level": 0.9}),
    "model_at": (lambda r: r.fit, {"compression": "4mm", "secant": True}),
    "part": (lambda r: r.fit, {"shape": 2.0, "mode": None, "bonded": False}),
    "save": (lambda r: r.fit, {"path": "fit.json"}),
    "band": (lambda r: r.frf, {"low": 4, "high": 40}),
    "modes": (lambda r: r.frf, {"method": "peak", "band": (4, 40), "count": None}),
    "only": (lambda r: r.frf, {"keep": slice(None)}),
    "stiffness": (lambda r: r.frf, {"mass": MASS, "seals": 2}),
    "to": (lambda r: r.frf, {"kind": "receptance", "mass": None}),
    "frf": (lambda r: r.hits, {"estimator": "H1", "accept": (), "record": None}),
    "prepare": (
        lambda r: r.test,
        {"onset": None, "cycle": None, "filter": None, "drift": None, "machine": None},
    ),
    "with_hold_end": (lambda r: r.test.prepare(), {"hold_end": 1.5}),
    "ramp_hold_force": (lambda r: r.fit.model, {"t": [0.0], "depth": 8e-3, "ramp_time": 1.0}),
    "stiffness_at": (lambda r: r.fit.model, {"s": 3j}),
    "with_length": (lambda r: r.fit.model, {"length": 0.1, "measured_length": 0.05}),
}


@pytest.mark.parametrize("name", METHODS)
def test_method_with_an_argument_of_any_type_is_answered(
    records: _Records, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A type that the annotation does not name was a TypeError from some lines deeper."""
    monkeypatch.chdir(records.folder)
    monkeypatch.setattr(warnings, "filters", [("ignore", None, Warning, None, 0)])
    find_owner, stated = METHODS[name]
    method = getattr(find_owner(records), name)
    for argument in stated:
        for word, wrong in WRONG.items():
            if word not in {"nan", "infinite", "huge"}:
                with contextlib.suppress(dp.DashpotError):
                    method(**stated | {argument: wrong})


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda r: r.frf.band("a"), "FRF.band needs high: it was not given"),
        (lambda r: r.fit.at(), 'Fit.at needs temperature.* such as temperature="23degC"'),
        (lambda r: r.fit.intervals("95%"), "level is '95%'; expected a number, such as level=0.95"),
        (lambda r: r.fit.model.stiffness_at("3"), "s is '3'; expected an array of numbers"),
        (lambda r: r.fit.model.slope_at(["3"]), "s is .*'3'.*; expected an array of numbers"),
        (lambda r: r.frf.modes("peak"), "by place, found 1 value. Name what else it takes: method"),
        (lambda r: r.fit.save("a.json", True), "Fit.save takes path by place, found 2 values"),
        (lambda r: r.fit.intervals(levle=0.9), "levle= does not suit Fit.int.*Did you mean level="),
        (lambda r: r.test.prepare(machine={"drift": 1}), "of the type dict; expected a Machine"),
        (lambda r: dp.predict(r.fit, MASS), "dp.predict takes solid by place, found 2 values"),
        (lambda r: dp.save(r.fit), 'dp.save needs path.*Give it, such as path="result.json"'),
        (lambda r: dp.plan(hold="2s"), 'needs frequency=.*such as frequency="12.71Hz"'),
        (lambda r: dp.read(r.file, r.file), "dp.read takes path by place, found 2 values"),
        (lambda r: dp.fit(r.test, r.hits), r'such as --mass 104g. \(Python: mass="104g"\)'),
        (lambda r: dp.batch(r.file, quick=True), r"\(Python: quick=True, arms=2\)"),
        (lambda r: dp.export(r.fit, to="csv"), r"--unit-system.*\(Python: "),
        (lambda r: dp.GeneralizedMaxwell("100N/mm"), r"'100N/mm'.*expected numbers in SI: N/m"),
        (lambda r: dp.fit(r.test, n_arms=2), r"Did you mean arms=\?"),
        (lambda r: dp.read(r.file, sheet=2), r'Did you mean part=\{"sheet": ...\}\?'),
    ],
)
def test_sentence_names_what_a_call_lacks(
    records: _Records, call: Callable[[_Records], Any], message: str
) -> None:
    with pytest.raises(dp.DashpotError, match=message):
        call(records)


def test_methods_of_every_loaded_result_are_checked(records: _Records) -> None:
    """The class of what a call returns may have been loaded by that call."""
    dp.save(records.test, records.folder / "again.csv")
    for root in (Printable, dp.GeneralizedMaxwell.__base__):
        for kind in call_errors._iterate_subclasses(root):
            for name, method in vars(kind).items():
                if kind.__module__.startswith("dashpot.") and isinstance(method, FunctionType):
                    is_wrapped = hasattr(method, "__wrapped__")
                    assert is_wrapped or not call_errors._is_checked(name, method), (kind, name)


def test_exception_without_a_wrong_argument_stays(records: _Records) -> None:
    with pytest.raises(IndexError, match="boolean index did not match"):
        records.frf.only([True, False])


FINITE = [wrong for word, wrong in WRONG.items() if word not in {"-1", "infinite", "nan"}]
SOLIDS = [
    dp.GeneralizedMaxwell(200.0, k=(100.0,), tau=(0.5,)),
    FractionalZener(300.0, 200.0, 0.5, 0.4),
]


@pytest.mark.parametrize("solid", SOLIDS, ids=lambda solid: type(solid).__name__)
@pytest.mark.parametrize("method", ["complex_stiffness", "storage", "loss", "loss_factor"])
def test_frequency_of_any_type_is_answered(solid: Any, method: str) -> None:
    function = getattr(solid, method)
    for wrong in FINITE:
        for name in ("frequency", "omega"):
            if wrong is not None:  # then neither is said
                with contextlib.suppress(dp.DataError):
                    assert isinstance(function(**{name: wrong}), np.ndarray | float)
    assert (function(frequency=["1Hz", "2Hz"]) == function(frequency=[1.0, 2.0])).all()
    with pytest.raises(dp.DataError, match="omega is of the type str; expected numbers"):
        function(omega="1Hz")


@pytest.mark.parametrize("solid", SOLIDS, ids=lambda solid: type(solid).__name__)
@pytest.mark.parametrize("method", ["relaxation", "creep"])
def test_time_of_any_type_is_answered(solid: Any, method: str) -> None:
    function = getattr(solid, method)
    for wrong in FINITE:
        with contextlib.suppress(dp.DataError):
            function(wrong)
    assert function("500ms") == pytest.approx(function(0.5))
    with pytest.raises(dp.DataError, match="t is of the type NoneType"):
        function(None)


@pytest.mark.parametrize(
    "convert", [np.array, np.float32, np.float64, Fraction], ids=["array", "float32", "64", "ratio"]
)
def test_number_of_another_type_is_the_number(convert: Callable[..., Any], records: _Records):
    """A frequency out of an array of NumPy, one of them, was a TypeError."""
    for call, name, value in (
        (lambda **k: dp.predict(records.fit, **k).values[0].value, "frequency", 2.0),
        (lambda **k: dp.predict(records.fit, mass=MASS, **k).frf.value, "seals", 2.0),
        (lambda **k: dp.predict(records.fit, seals=2, **k).frf.value, "mass", 0.125),
        (lambda **k: dp.Specimen(**k).length, "length", 0.0625),
    ):
        assert np.array_equal(call(**{name: convert(value)}), call(**{name: value})), name
