"""What is released: a version that sorts, and constraints that fit what is asked for."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

import dashpot as dp
from dashpot.base.version import byline, is_ours

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
ASKED = [
    Requirement(line)
    for group in (PROJECT["dependencies"], *PROJECT["optional-dependencies"].values())
    for line in group
    if not line.startswith("dashpot[")
]


@pytest.fixture(scope="module")
def pinned():
    lines = (ROOT / "constraints.txt").read_text("utf-8").splitlines()
    pins = [Requirement(line) for line in lines if not line.startswith("#")]
    return {canonicalize_name(pin.name): pin.specifier for pin in pins}


@pytest.mark.parametrize("asked", ASKED, ids=str)
def test_what_is_asked_for_is_pinned_at_a_version_that_will_do(pinned, asked):
    (pin,) = pinned[canonicalize_name(asked.name)]
    assert pin.operator == "=="
    assert asked.specifier.contains(pin.version, prereleases=True)


def test_the_version_sorts_and_stands_in_the_byline():
    assert str(Version(dp.__version__)) == dp.__version__
    assert is_ours(f"# {byline('a test')}".encode())


@pytest.mark.parametrize(
    "version", ["0.1.0", "0.1.1.dev409+ga25fdc401.d20261122", "0.1.dev3+g1", "1.0.0rc1", "10.2.0"]
)
def test_every_version_is_known_again(version):
    assert is_ours(f"$ dashpot {version}: network of springs".encode())
