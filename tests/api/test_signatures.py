"""Signatures of the public functions: what `help` shows is what the stub and the functions take."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import pytest
from kit.verbs import CASES, FUNCTIONS

import dashpot as dp
from dashpot.api import read_overloads
from dashpot.api.read_save import ReadOptionKeywords
from dashpot.registry import load_object


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda function: function.__name__)
def test_signature_names_every_keyword(function: Callable[..., Any]) -> None:
    parameters = inspect.signature(function).parameters.values()
    assert all(item.kind is not inspect.Parameter.VAR_KEYWORD for item in parameters)
    assert "**" not in str(inspect.signature(function))


@pytest.mark.parametrize("method", [dp.RelaxationTest.prepare, dp.ImpactTest.frf, dp.FRF.stiffness])
def test_method_signature_names_every_keyword(method: Callable[..., Any]) -> None:
    assert "**" not in str(inspect.signature(method))


@pytest.mark.parametrize("name", CASES)
def test_stub_overload_agrees_with_a_function(name: str) -> None:
    words = [case for case in CASES[name] if case]
    functions = [load_object(case) if isinstance(case, str) else case for case in words]
    for overload in read_overloads()[name]:
        names = overload.parameters.keys()
        expected = [inspect.signature(function).parameters for function in functions]
        assert any(
            names <= parameters.keys()
            and all(
                overload.parameters[key].default
                in (inspect.Parameter.empty, None, parameters[key].default)
                for key in names
            )
            for parameters in expected
        ), (name, list(names))


def test_read_takes_the_keywords_of_the_stub() -> None:
    names = inspect.signature(dp.read).parameters.keys() - {"path", "kind"}
    assert names == ReadOptionKeywords.__annotations__.keys()
    assert names == inspect.signature(dp.inspect).parameters.keys() - {"path", "kind"}


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda test: dp.fit(test, arm=2), "Did you mean arms="),
        (lambda test: dp.predict(dp.GeneralizedMaxwell(1.0), mas=1), "Did you mean mass="),
        (lambda test: dp.predict(dp.GeneralizedMaxwell(1.0)), "needs mass="),
        (lambda test: dp.plan(freqency="1Hz"), "Did you mean frequency="),
        (lambda test: dp.read("seal.csv", colums={}), "Did you mean columns="),
        (lambda test: dp.simulate("relaxation", mass="1g"), "mass= does not suit a test of relax"),
        (
            lambda test: dp.fit(test, memory=test),
            "memory= does not suit .* Did you mean relaxation=",
        ),
        (
            lambda test: dp.predict(dp.GeneralizedMaxwell(1.0), slam="1m/s", mass=1),
            "Did you mean drop=",
        ),
        (lambda test: dp.batch("tests", outputs="lot"), "outputs= does not suit a batch of files"),
    ],
)
def test_wrong_keyword_is_refused_with_the_nearest(
    call: Callable[[Any], Any], message: str
) -> None:
    test = dp.simulate("relaxation", hold="5s", noise_free=True)
    with pytest.raises(dp.DashpotError, match=message) as raised:
        call(test)
    assert " _" not in str(raised.value)


def test_a_fit_shows_few_public_attributes():
    fit = dp.fit(dp.simulate("relaxation", hold="5s", noise_free=True), arms=2)
    assert len([name for name in dir(fit) if not name.startswith("_")]) <= 35


def test_help_of_predict_names_the_frequencies_of_a_fit() -> None:
    assert "frequency" in inspect.signature(dp.predict).parameters
    assert "frequency : float or str" in (dp.predict.__doc__ or "")
