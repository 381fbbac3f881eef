"""The table of dear tests names tests, and lets the others run."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace

import pytest
from kit.cost import KEPT, waiting

TESTS = Path(__file__).parent


@pytest.mark.parametrize("name", KEPT)
def test_a_dear_test_is_there(name: str) -> None:
    file, *_, function = name.split("::")
    assert re.search(rf"def {function}\b", (TESTS / file).read_text(encoding="utf-8"))


def test_the_cases_that_are_kept_run_and_no_other_test_waits() -> None:
    name = next(name for name, kept in KEPT.items() if kept == 2)
    cases = [SimpleNamespace(nodeid=f"tests/{name}[{i}]") for i in range(5)]
    other = SimpleNamespace(nodeid="tests/test_cost.py::test_a_dear_test_is_there[x]")
    assert waiting([*cases, other]) == cases[1:4]
    # one that is asked for by its name runs
    assert waiting(cases[3:4]) == []
