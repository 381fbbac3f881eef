"""What the documents say is there, is there."""

from __future__ import annotations

import re
import shlex
import tomllib
from pathlib import Path

import pytest
from click.testing import CliRunner

from dashpot.cli import COMMANDS, main
from dashpot.cli.export import TARGETS as OFFERED
from dashpot.export import TARGETS

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_is_documented(name):
    assert f"dashpot {name}" in README
    help_text = CliRunner().invoke(main, [name, "--help"])
    assert help_text.exit_code == 0, help_text.output
    assert f"dashpot {name} " in help_text.output or f"dashpot {name}\n" in help_text.output


def test_every_option_in_the_readme_exists():
    for line in re.findall(r"^(dashpot .*)$", README, flags=re.MULTILINE):
        words = shlex.split(line.split("#")[0])
        if len(words) < 2 or words[1] not in COMMANDS:
            continue
        known = CliRunner().invoke(main, [words[1], "--help"]).output
        for word in words[2:]:
            if word.startswith("-") and word != "-":
                assert re.search(rf"(?<![\w-]){re.escape(word)}(?![\w-])", known), line


def test_the_command_line_offers_every_deck():
    assert set(OFFERED) == set(TARGETS)


def test_pictures_of_the_readme_exist():
    pictures = re.findall(r"!\[[^\]]*\]\(([^)]+)\)", README)
    assert pictures
    for picture in pictures:
        assert (ROOT / picture).is_file()


@pytest.mark.parametrize("page", ["CONTRIBUTING.md", "docs/architecture.md"])
def test_every_path_that_a_page_names_is_there(page):
    text = re.sub(r"^```.*?^```", "", (ROOT / page).read_text("utf-8"), flags=re.DOTALL | re.M)
    words = [word for quoted in re.findall(r"`([^`]+)`", text) for word in quoted.split()]
    named = [word for word in words if re.search(r"\w/|\.(py|pyi|md|rst|toml)$", word)]
    assert named
    for word in named:
        path = word.partition("NAME")[0].rstrip("/")  # a place for something new
        stands = any(
            (ROOT / path).exists() or any((ROOT / "src").rglob(f"{path}{ending}"))
            for ending in ("", ".py")
        )
        assert stands, word


def test_the_layers_of_the_house_are_those_that_are_held():
    held = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]
    page = (ROOT / "docs" / "architecture.md").read_text("utf-8")
    layers = [line for line in held["contracts"][0]["layers"] if line != "__main__"]
    assert "\n".join(["```text", *layers, "```"]) in page
    rooms = re.findall(r"^\| `(\w+)/` \|", page, flags=re.M)
    assert sorted(rooms) == sorted(word for line in layers for word in line.split(" | "))
