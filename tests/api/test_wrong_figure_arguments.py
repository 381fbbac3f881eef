"""Whatever type an argument of a function of figures has, the answer is a picture or a sentence."""

from __future__ import annotations

import contextlib
import inspect
from types import FunctionType
from typing import Any

import pytest

import dashpot as dp

FUNCTIONS = [name for name in dir(dp.plot) if isinstance(getattr(dp.plot, name), FunctionType)]
WRONG: tuple[Any, ...] = ("x", "3", 3, None, [], ["x"], {"a": 1}, object(), b"x", 1j)


def test_a_figure_is_one_function_and_what_the_stub_imports_is_none() -> None:
    assert dp.plot.frf is dp.plot.frf
    assert not {"Callable", "Any"} & set(dir(dp.plot))


def test_every_figure_is_called() -> None:
    assert {"frf", "stiffness", "door", "to_svg", "hero"} <= set(FUNCTIONS)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_figure_of_an_argument_of_any_type_is_answered(name: str) -> None:
    """A text was an AttributeError from some lines deeper."""
    function = getattr(dp.plot, name)
    required = [
        parameter
        for parameter in inspect.signature(function).parameters.values()
        if parameter.default is parameter.empty
    ]
    for wrong in WRONG:
        positional = [wrong for item in required if item.kind is not item.KEYWORD_ONLY]
        named = {item.name: wrong for item in required if item.kind is item.KEYWORD_ONLY}
        with contextlib.suppress(dp.DashpotError):
            function(*positional, **named)
    with pytest.raises(dp.DataError, match=f"dp.plot.{name}|nonsense"):
        function(nonsense=1)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("x",), r'^measured is \'x\'; expected an FRF. Read the file first: dp.read\("x"\)$'),
        ((), "^dp.plot.frf needs measured: it was not given$"),
    ],
)
def test_sentence_names_the_argument_of_a_figure(arguments: tuple[Any, ...], message: str) -> None:
    with pytest.raises(dp.DataError, match=message):
        dp.plot.frf(*arguments)
