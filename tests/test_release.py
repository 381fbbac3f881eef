"""What is released: a version that sorts, and constraints that fit what is asked for."""

from __future__ import annotations

import re
import runpy
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

import dashpot as dp
from dashpot.base.version import byline, is_ours
from dashpot.registry import COMMANDS

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
REQUIREMENTS = [
    Requirement(line)
    for group in (PROJECT["dependencies"], *PROJECT["optional-dependencies"].values())
    for line in group
    if not line.startswith("dashpot[")
]


@pytest.fixture(scope="module")
def pins_by_name():
    lines = (ROOT / "constraints.txt").read_text("utf-8").splitlines()
    pins = [Requirement(line) for line in lines if not line.startswith("#")]
    return {canonicalize_name(pin.name): pin.specifier for pin in pins}


@pytest.mark.parametrize("requested", REQUIREMENTS, ids=str)
def test_pinned_versions_satisfy_the_requirements(pins_by_name, requested):
    (pin,) = pins_by_name[canonicalize_name(requested.name)]
    assert pin.operator == "=="
    assert requested.specifier.contains(pin.version, prereleases=True)


def test_every_file_that_a_user_installs_is_pinned_with_its_hash(pins_by_name):
    """All that the extra `all` asks for, at the versions that the gate tests."""
    text = (ROOT / "requirements.txt").read_text("utf-8")
    held = dict(re.findall(r"^([\w-]+)==([^ ]+) .*\\\n +--hash=sha256:[0-9a-f]{64}\b", text, re.M))
    assert len(held) == text.count("==")
    for name, version in held.items():
        if name in pins_by_name:
            assert pins_by_name[name].contains(version, prereleases=True), name
    extras = PROJECT["optional-dependencies"]
    of_all = re.search(r"\[([\w,]+)\]", extras["all"][0])[1].split(",")
    for group in (PROJECT["dependencies"], *(extras[item] for item in of_all)):
        assert {canonicalize_name(Requirement(item).name) for item in group} <= {*held}


def test_sbom_has_the_hash_of_every_component_or_is_refused():
    add_hashes = runpy.run_path(str(ROOT / ".ci" / "sbom.py"))["add_hashes"]
    file = {"archive_info": {"hashes": {"sha256": "ab" * 32}}}
    item = {"metadata": {"name": "Some_Part", "version": "1.0"}, "download_info": file}
    part, other = {"name": "some-part", "version": "1.0"}, {"name": "some-part", "version": "1.1"}
    sbom = add_hashes({"metadata": {"component": part}, "components": []}, {"install": [item]})
    assert sbom["metadata"]["component"]["hashes"] == [{"alg": "SHA-256", "content": "ab" * 32}]
    with pytest.raises(KeyError):
        add_hashes({"metadata": {"component": part}, "components": [other]}, {"install": [item]})


def test_sbom_lists_the_extras_that_readme_installs():
    readme, recipes = ((ROOT / name).read_text("utf-8") for name in ("README.md", "Justfile"))
    (extras,) = re.findall(r'pip install -q "\.\[(\w+)\]"', readme)
    assert f'"$wheel[{extras}]"' in recipes


def test_sbom_hashes_local_files_itself(tmp_path):
    add_hashes = runpy.run_path(str(ROOT / ".ci" / "sbom.py"))["add_hashes"]
    wheel = tmp_path / "part 1.whl"
    wheel.write_bytes(b"part")
    item = {
        "metadata": {"name": "part", "version": "1.0"},
        "download_info": {"url": wheel.as_uri(), "archive_info": {}},
    }
    part = {"name": "part", "version": "1.0"}
    sbom = add_hashes({"metadata": {"component": part}, "components": []}, {"install": [item]})
    assert sbom["metadata"]["component"]["hashes"][0]["content"].startswith("37a680133bd09342")


def test_the_changelog_names_every_command():
    text = (ROOT / "CHANGELOG.md").read_text("utf-8")
    (listed,) = re.findall(r"^- \w+ commands: (.*?)\. Python", text, re.MULTILINE | re.DOTALL)
    assert set(re.findall(r"`(\w+)`", listed)) == set(COMMANDS)


def test_the_changelog_has_a_section_for_each_version_and_the_citation_is_of_the_newest():
    text = (ROOT / "CHANGELOG.md").read_text("utf-8")
    released = [Version(match) for match in re.findall(r"^## (\d\S*)", text, re.M)]
    assert released == sorted(set(released), reverse=True)
    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    assert f"\nversion: {released[0]}\n" in citation


def test_a_copy_without_a_tag_has_the_version_that_comes_next():
    """Pages and decks from a copy of the repository name it, not an older one."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["hatch"]
    fallback = Version(settings["version"]["fallback-version"])
    text = (ROOT / "CHANGELOG.md").read_text("utf-8")
    newest = re.search(r"^## (\d\S*)", text, re.M)
    assert newest is not None
    assert fallback.is_devrelease
    assert fallback.base_version == newest[1]


def test_the_version_sorts_and_stands_in_the_byline():
    assert str(Version(dp.__version__)) == dp.__version__
    assert is_ours(f"# {byline('a test')}".encode())


@pytest.mark.parametrize(
    "version", ["0.1.0", "0.1.1.dev409+ga25fdc401.d20261122", "0.1.dev3+g1", "1.0.0rc1", "10.2.0"]
)
def test_is_ours_accepts_every_version(version):
    assert is_ours(f"$ dashpot {version}: network of springs".encode())


def test_nightly_summary_reads_the_result_files(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "benchmarks")
    monkeypatch.syspath_prepend(ROOT / "tests")
    (tmp_path / "fuzz.xml").write_text(
        '<testsuites><testsuite tests="3" failures="1" errors="0" skipped="1">'
        '<testcase><properties><property name="mutants" value="700"/></properties></testcase>'
        '<testcase><properties><property name="mutants" value="30"/></properties>'
        "<failure/></testcase>"
        '<testcase><properties><property name="kills" value="1"/></properties></testcase>'
        "</testsuite></testsuites>"
    )
    (tmp_path / "coverage.txt").write_text(
        "aging: held of 20, 41 ms of CPU each\n  life           19\n  F/F0 after 1000 h   18\n"
        "depths: held of 10, 3 ms of CPU each\n  k_inf   10\n"
    )
    (tmp_path / "speed.txt").write_text(
        "CPU ms       n   min  median p95 max  dearest\n"
        "hold, auto                  24      8.1     12.0     24.9    130.5  power law, 5 rows\n"
    )
    quality = runpy.run_path(str(ROOT / ".ci" / "quality.py"))
    table = quality["table"](quality["rows"](tmp_path)).splitlines()
    assert table[2:] == [
        "| tests: fuzz | 1 passed, 1 skipped, 1 failed | 3 | 0 failed |",
        "| mutants of files and documents | 1 found a fault | 730 | 0 |",
        "| kills of a batch | 0 found a fault | 1 | 0 |",
        "| coverage: aging | life 19, F/F0 after 1000 h 18 | 20 | 95 % |",
        "| coverage: depths | k_inf 10 | 10 | 95 % |",
        "| speed: hold, auto | p95 24.9 ms (median 12.0, most 130.5) | 24 | p95 <= 25 ms |",
    ]
