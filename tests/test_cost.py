"""The table of dear tests names tests, and lets the others run."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace

from kit.cost import GATE_CASES, waiting

TESTS = Path(__file__).parent


def test_every_dear_test_is_there() -> None:
    files: dict[str, str] = {}
    for name in GATE_CASES:
        file, *_, function = name.split("::")
        if file not in files:
            files[file] = (TESTS / file).read_text(encoding="utf-8")
        assert re.search(rf"def {function}\b", files[file]), name


def test_selected_cases_run_and_other_tests_do_not_wait() -> None:
    name = next(name for name, retained in GATE_CASES.items() if retained == 2)
    cases = [SimpleNamespace(nodeid=f"tests/{name}[{i}]") for i in range(5)]
    other = SimpleNamespace(nodeid="tests/test_cost.py::test_every_dear_test_is_there[x]")
    assert waiting([*cases, other]) == cases[1:4]
    # one that is asked for by its name runs
    assert waiting(cases[3:4]) == []
