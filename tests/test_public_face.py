"""Public names: each imports by itself, has a docstring and is documented."""

from __future__ import annotations

import os
import pickle
import re
import subprocess
import sys
from pathlib import Path

import pytest

import dashpot as dp

USE = Path(__file__).with_name("public_use.py")
DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGES = (DOCS / "api.md", *sorted((DOCS / "api").glob("*.md")))
API = "".join(page.read_text(encoding="utf-8") for page in PAGES)
# one interpreter that has imported dashpot and nothing else; a child of its own for each name
EACH_ALONE = """
import os, sys, dashpot
for name in dashpot.__all__:
    child = os.fork()
    if not child:
        try:
            thing = getattr(dashpot, name)
            told = bool(isinstance(thing, str) or thing.__doc__)
            if name in ("files", "lots", "plot", "simulation", "solids", "systems"):
                told &= bool([getattr(thing, inner) for inner in dir(thing)])
        except BaseException as error:
            print(name, repr(error), flush=True)
        else:
            told or print(name, "says nothing", flush=True)
        os._exit(0)
    os.waitpid(child, 0)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_every_public_name_imports_first():
    done = subprocess.run(
        [sys.executable, "-c", EACH_ALONE], capture_output=True, text=True, check=True
    )
    assert done.stdout + done.stderr == ""


def test_packages_pickle_by_name():
    """As modules do for dask and joblib, whose functions may name it."""
    assert pickle.loads(pickle.dumps(dp)) is dp  # noqa: S301  our own bytes


def test_every_public_name_is_there_whatever_was_named_before():
    named = "for name in reversed(dashpot.__all__): getattr(dashpot, name)"
    done = subprocess.run(
        [sys.executable, "-c", f"import dashpot\n{named}"],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert done.stdout + done.stderr == ""


def test_there_are_at_most_sixty_names():
    assert len(dp.__all__) == len(set(dp.__all__)) <= 60
    assert dir(dp) == dp.__all__


def test_an_unknown_name_has_the_plain_answer():
    with pytest.raises(AttributeError, match="has no attribute 'fitt'"):
        dp.fitt  # noqa: B018


@pytest.mark.once
def test_a_type_checker_knows_the_results():
    """Each line of `public_use.py` says in its comment what mypy is to reveal, or to refuse."""
    lines = USE.read_text(encoding="utf-8").splitlines()
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", str(USE)],
        capture_output=True, text=True, check=False, cwd=USE.parents[1],
    )  # fmt: skip
    values = {}
    for line in done.stdout.splitlines():
        match = re.match(r".*public_use\.py:(\d+): (error:|note: Revealed type is) (.*)", line)
        if match:
            values.setdefault(int(match[1]), match[0])
    wanted = {i: line.partition("  # ")[2] for i, line in enumerate(lines, 1) if "  # " in line}
    assert wanted.keys() == values.keys(), done.stdout + done.stderr
    for i, what in wanted.items():
        refused = what.startswith("refused")
        assert ("error" in values[i]) == refused, values[i]
        assert refused or re.search(rf'type is "[\w.]*\.{what}"', values[i]), values[i]


def is_documented(name: str) -> bool:
    thing = getattr(dp, name)
    if isinstance(thing, str):
        return f"`dashpot.{name}`" in API
    home = getattr(thing, "__module__", None) or thing.__name__
    match = re.search(rf"automodule:: {re.escape(home)}\n(?:   :members:(?P<names>.*)\n)?", API)
    if match is None:
        return False
    names = match["names"]
    whole = hasattr(thing, "__path__") or hasattr(thing, "__file__") or names == ""
    return whole or bool(re.search(rf"\b{name}\b", names or ""))


@pytest.mark.parametrize("name", dp.__all__)
def test_every_public_name_is_in_the_documents(name):
    assert is_documented(name), f"docs/api lacks dashpot.{name}"


def test_python_m_dashpot_is_the_command_line():
    done = subprocess.run(
        [sys.executable, "-m", "dashpot", "--version"], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == f"dashpot, version {dp.__version__}"
