"""Every public name stands by itself, says what it is, and is in the documents."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import dashpot as dp

API = (Path(__file__).resolve().parents[1] / "docs" / "api.md").read_text(encoding="utf-8")
# one interpreter that has imported dashpot and nothing else; a child of its own for each name
EACH_ALONE = """
import os, sys, dashpot
for name in dashpot.__all__:
    child = os.fork()
    if not child:
        try:
            thing = getattr(dashpot, name)
            told = bool(isinstance(thing, str) or thing.__doc__)
            if name in ("networks", "recording", "simulation"):
                told &= bool([getattr(thing, inner) for inner in dir(thing)])
        except BaseException as error:
            print(name, repr(error), flush=True)
        else:
            told or print(name, "says nothing", flush=True)
        os._exit(0)
    os.waitpid(child, 0)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_every_public_name_is_there_first_and_alone():
    done = subprocess.run(
        [sys.executable, "-c", EACH_ALONE], capture_output=True, text=True, check=True
    )
    assert done.stdout + done.stderr == ""


def documented(name: str) -> bool:
    thing = getattr(dp, name)
    if isinstance(thing, str):
        return f"`dashpot.{name}`" in API
    home = getattr(thing, "__module__", None) or thing.__name__
    given = re.search(rf"automodule:: {re.escape(home)}\n(?:   :members:(?P<names>.*)\n)?", API)
    if given is None:
        return False
    names = given["names"]
    whole = hasattr(thing, "__path__") or hasattr(thing, "__file__") or names == ""
    return whole or bool(re.search(rf"\b{name}\b", names or ""))


@pytest.mark.parametrize("name", dp.__all__)
def test_every_public_name_is_in_the_documents(name):
    assert documented(name), f"docs/api.md lacks dashpot.{name}"


def test_python_m_dashpot_is_the_command_line():
    done = subprocess.run(
        [sys.executable, "-m", "dashpot", "--version"], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == f"dashpot, version {dp.__version__}"
