"""What the documents say is there, is there; and every command in them runs as it stands."""

from __future__ import annotations

import ast
import importlib
import json
import re
import shlex
import shutil
import tomllib
from pathlib import Path
from typing import NamedTuple

import click
import pytest
from click.testing import CliRunner
from kit.foreign.files import press_and_hold
from kit.mdf_files import Channel, Group, mdf4

from dashpot import workflow
from dashpot.cli import COMMANDS, main
from dashpot.fitting.relaxation import fit as fit_tests
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.workflow.json_archive import to_json

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PAGES = sorted(
    path.relative_to(ROOT).as_posix()
    for path in (ROOT / "README.md", *(ROOT / "docs").rglob("*.md"))
    if "_build" not in path.parts
)
RUN_BY_OTHER_TESTS = {
    "demo": (".ci/run", "dashpot demo"),
    "app": ("tests/extensions/app/test_journeys.py", "dashpot app"),
    "batch --watch": ("tests/extensions/batch/test_watching.py", '"--watch"'),
    "record": ("tests/extensions/acquisition/test_recording.py", "dashpot record"),
}
"""Commands that another place runs, and what stands there: they take long, or have no end."""
AT_NIGHT = {
    "README.md": ("report",),  # the tutorial's line
    "docs/howto/bound.md": ("predict",),  # as is the tutorial's
    "docs/howto/cld.md": ("fit cld_slow.csv", "predict speeds.json"),
    "docs/howto/closing.md": ("predict",),
    "docs/howto/door.md": ("predict door.toml --modes",),
    "docs/howto/fractional.md": ("fit seal_8mm.csv hammer.csv",),
    "docs/howto/hammer.md": ("fit hammer.csv --mass",),
    "docs/howto/indentation.md": ("fit",),
    "docs/howto/level.md": (
        (
            "fit shaker_20mN.csv shaker_500mN.csv --amplitude 0.02N --amplitude 0.5N --mass 114.8g "
            "--seals 2 --resonance-amplitude"
        ),
        "fit depth_4mm.csv",
        "predict depths.json",
    ),
}
"""Beginnings of lines of seconds each: half of the time of all pages, in an eighth of their lines.

What they compute is tested where it is made, what they are typed as below; that they print what
the page says is known every night.
"""
WHOLE_AT_NIGHT = {
    "docs/dynamic.md",
    "docs/howto/batch.md",
    "docs/howto/cold_test.md",
    "docs/howto/creep.md",
    "docs/howto/depths.md",
    "docs/howto/joint.md",
    "docs/howto/master_curve.md",
    "docs/howto/solvers.md",
}
"""Pages that take seconds even without such lines; the pictures of the docs are of their like."""
SCRIPTS_BY_DAY = {"README.md", "docs/first_seal.md"}
"""Pages whose Python runs every time; the others' is of the same verbs."""


def find_other_test(name: str, words: list[str]) -> tuple[str, str] | None:
    """Where a command is run in place of these tests; None if these run it."""
    if name == "demo" and "--files" in words:
        return None
    return RUN_BY_OTHER_TESTS.get(f"{name} --watch" if "--watch" in words else name)


class PageCommand(NamedTuple):
    """A command of a page, and what the page says it prints; None if it does not."""

    line: str
    prints: str | None


def list_commands(text: str) -> list[PageCommand]:
    """Every line of a page's shell blocks that calls dashpot."""
    result = []
    for kind, block in re.findall(r"^```(sh|console)\n(.*?)^```", text, flags=re.DOTALL | re.M):
        if kind == "sh":
            result += [
                PageCommand(line, None)
                for line in block.splitlines()
                if line.startswith("dashpot ")
            ]
            continue
        for part in re.split(r"^\$ ", block, flags=re.M)[1:]:
            line, _, prints = part.partition("\n")
            result.append(PageCommand(line, prints))
    return result


def commands(page: str) -> list[PageCommand]:
    return list_commands((ROOT / page).read_text("utf-8"))


@pytest.fixture(scope="session")
def example(tmp_path_factory):
    """The example files and the fit of the first, written once."""
    folder = tmp_path_factory.mktemp("example")
    for name, made in workflow.EXAMPLES.items():
        (folder / name).write_text(made(), encoding="utf-8")
    fit = fit_tests(read_relaxation(folder / "seal_8mm.csv"))
    time, displacement, force = press_and_hold()
    made = [
        Channel("t", time, "s", kind=2, sync=1),
        Channel("Travel", displacement, "mm"),
        Channel("Force", force, "N"),
    ]
    (folder / "bench.mf4").write_bytes(mdf4([Group(made, "bench")], how="HL"))
    (folder / "fit.json").write_text(to_json(fit), encoding="utf-8")
    return folder


@pytest.fixture
def bench(example, tmp_path, monkeypatch):
    """A folder with the example files, to work in."""
    for path in example.iterdir():
        shutil.copy(path, tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


NUMBER = r"\d+\.\d+(?:e[-+]?\d+)?"
DECIMAL = re.compile(NUMBER)


def agree(wanted: str, got: str) -> bool:
    """Whether a page's output is what was printed: `...` is anything, blanks are blanks.

    A number with a decimal point agrees within 5 % or two of its last digit: an estimate's digits
    end in its noise, and a page need not change with that. Whole numbers and words agree exactly.
    """
    pieces = re.split(rf"(\.\.\.|\s+|{NUMBER})", wanted.strip())
    pattern = "".join(_pattern(piece) for piece in pieces)
    fullmatch = re.fullmatch(pattern, got.strip(), flags=re.DOTALL)
    if fullmatch is None:
        return False
    return all(map(_is_near, DECIMAL.findall(wanted), fullmatch.groups()))


def _is_near(text: str, printed: str) -> bool:
    last = 10.0 ** -len(text.partition("e")[0].partition(".")[2])
    return abs(float(printed) - float(text)) <= max(0.05 * float(text), 2.001 * last)


def _pattern(piece: str) -> str:
    if piece == "...":
        return ".*?"
    if not piece.strip():
        return r"\s+" if piece else ""
    return f"({NUMBER})" if DECIMAL.fullmatch(piece) else re.escape(piece)


@pytest.mark.once
@pytest.mark.parametrize(
    ("page", "residual"),
    [
        pytest.param(page, AT_NIGHT.get(page, ()), id=page)
        for page in PAGES
        if commands(page) and page not in WHOLE_AT_NIGHT
    ]
    + [pytest.param(page, (), id=f"all of {page}", marks=pytest.mark.slow)
       for page in sorted({*AT_NIGHT, *WHOLE_AT_NIGHT})],
)  # fmt: skip
def test_every_command_runs_as_it_stands(page, residual, bench):
    """In the page's order, in a folder with the example files."""
    waiting = [f"dashpot {line}" for line in residual]
    for item in waiting:
        assert sum(line.startswith(item) for line, _ in commands(page)) == 1, item
    for line, prints in commands(page):
        if line.startswith(tuple(waiting)):
            continue
        _, name, *words = shlex.split(line, comments=True)
        there = find_other_test(name, words)
        if there is not None:
            file, stands = there
            assert stands in (ROOT / file).read_text("utf-8")
            continue
        sent = words[-2:-1] == [">"]
        result = CliRunner().invoke(main, [name, *(words[:-2] if sent else words)])
        if sent:
            Path(words[-1]).write_text(result.stdout, encoding="utf-8")
        refused = re.search("^dashpot: ", prints or "", re.M) is not None
        assert result.exit_code == 2 * refused, f"{line}\n{result.output}"
        if prints is not None and not sent:
            assert agree(prints, result.output), f"{line}\n{prints}\n--- printed\n{result.output}"


@pytest.mark.parametrize("page", [page for page in PAGES if commands(page)])
def test_every_line_is_a_command_with_options_that_it_has(page):
    for line, prints in commands(page):
        _, name, *words = shlex.split(line, comments=True)
        command = main.get_command(click.Context(main), name)
        assert command is not None, line
        if not re.search("^dashpot: ", prints or "", re.M):
            command.make_context(name, words[:-2] if words[-2:-1] == [">"] else words)


def test_typed_finds_commands_and_agree_compares_output():
    page = (
        "```sh\ndashpot fit a # b\npip install x\n```\n```console\n$ dashpot plan\nuse: x\n...\n```"
    )
    assert list_commands(page) == [
        PageCommand("dashpot fit a # b", None),
        PageCommand("dashpot plan", "use: x\n...\n"),
    ]
    assert agree("use: 1.19  N\n...", "use: 1.2 N\nand more")
    assert agree("a\n... 3 of 5\n", "a\nb\nc 3 of 5")
    assert agree("use: 1.0 N", "use: 1.2 N")
    assert not agree("use: 1.0 N", "use: 1.3 N")
    assert not agree("use: 0.1900 N", "use: 0.2000 N")
    assert not agree("3 of 5", "4 of 5")
    assert not agree("use: 1.2 N", "use: 1.2 N and more")


def scripts(page: str) -> list[str]:
    """The Python of a page that is no session of doctest."""
    matches = re.findall(r"```python\n(.*?)```", (ROOT / page).read_text("utf-8"), re.DOTALL)
    return [code for code in matches if ">>>" not in code]


@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, marks=[pytest.mark.slow] * (page not in SCRIPTS_BY_DAY))
        for page in PAGES
        if scripts(page)
    ],
)
def test_the_python_of_a_page_runs_as_it_stands(page, bench):
    (code,) = scripts(page)
    names = {}
    exec(compile(code, page, "exec"), names)  # noqa: S102
    if "deck" in names:
        assert "CBUSH" in names["deck"]


@pytest.mark.once
def test_the_notebook_runs_as_it_stands(bench, monkeypatch):
    """Cell by cell; what a cell shows is what it showed."""
    monkeypatch.syspath_prepend(ROOT / "docs")
    notebook = importlib.import_module("notebook")
    book = json.loads(notebook.BOOK.read_text("utf-8"))
    assert book["nbformat"] == 4
    names = {}
    for cell, printed, value in notebook.cells(book, names):
        text = "".join("".join(output["text"]) for output in cell["outputs"] if "text" in output)
        assert agree(text, printed), f"python docs/notebook.py writes it anew\n{printed}"
        seen = [output["data"] for output in cell["outputs"] if "data" in output]
        assert (value is None) == (not seen)
        for data in seen:
            assert agree("".join(data["text/plain"]), repr(value)), "python docs/notebook.py"
            assert "<svg" in "".join(data["text/html"])
            assert "<svg" in value._repr_html_()
    assert "CBUSH" in names["deck"]


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_is_documented(name):
    assert re.search(rf"(dashpot |`){name}\b", README)
    help_text = CliRunner().invoke(main, [name, "--help"])
    assert help_text.exit_code == 0, help_text.output
    assert f"dashpot {name} " in help_text.output or f"dashpot {name}\n" in help_text.output


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_is_made_as_the_page_says(shell):
    page = (ROOT / "docs" / "howto" / "shell.md").read_text("utf-8")
    assert f"_DASHPOT_COMPLETE={shell}_source dashpot" in page
    done = CliRunner(env={"_DASHPOT_COMPLETE": f"{shell}_source"}).invoke(main, prog_name="dashpot")
    assert done.exit_code == 0
    assert "_DASHPOT_COMPLETE" in done.output


def list_completions(*words):
    """What the shell offers after those words."""
    env = {
        "_DASHPOT_COMPLETE": "bash_complete",
        "COMP_WORDS": " ".join(["dashpot", *words]),
        "COMP_CWORD": str(len(words)),
    }
    return CliRunner(env=env).invoke(main, prog_name="dashpot").output.split()


def test_commands_options_and_files_are_completed():
    assert list_completions("rep") == ["plain,report"]
    assert "plain,--strict" in list_completions("fit", "--st")
    for words in (("fit", "seal"), ("predict", "f"), ("report", "s"), ("compare", "fit.json", "h"),
                  ("fit", "seal.csv", "-o", "f"), ("fit", "a.csv", "--plot", "p"),
                  ("report", "a.csv", "h"), ("predict", "f.json", "--record", "s"),
                  ("fit", "a.csv", "--profile", "l"), ("verify", "d"),
                  ("report", "a.csv", "--project", "d"), ("demo", "-o", "d")):  # fmt: skip
        completions = list_completions(*words)
        assert completions
        assert {completion.split(",")[0] for completion in completions} <= {"file", "dir"}, words


def test_readme_has_two_setup_lines_and_the_gate_runs_the_second():
    lines = [line for line in README.splitlines() if "pip install" in line]
    assert len(lines) == 2
    assert all(
        line.startswith("python3 -m venv .venv && .venv/bin/pip install -q ") for line in lines
    )
    assert lines[0].endswith(" && .venv/bin/dashpot demo")
    assert lines[1].endswith(" && .venv/bin/pytest -q")
    pattern = re.search(
        r"grep -m 1 '([^']+)' README\.md", (ROOT / ".ci" / "run").read_text("utf-8")
    )
    assert pattern is not None
    assert [line for line in README.splitlines() if re.search(pattern[1], line)] == [lines[1]]
    install = (ROOT / "docs" / "install.md").read_text("utf-8").splitlines()
    assert lines[0] in install
    windows = lines[0].replace("python3", "py").replace(".venv/bin/", ".venv\\Scripts\\")
    assert windows in install


def test_readme_prints_what_the_main_job_prints(bench):
    """Number by number, to one of its last digit: the digits are those of this very run."""
    (job,) = (
        command
        for command in list_commands(README)
        if command.prints and "Peak at" in command.prints
    )
    _, name, *words = shlex.split(job.line)
    printed = CliRunner().invoke(main, [name, *words]).output.splitlines()
    rows = [" ".join(row.split()) for row in job.prints.splitlines()]
    compared = 0
    for row in rows:
        message = row.removesuffix(" ...")
        if message in {"...", ""}:
            continue
        where = DECIMAL.sub("#", message)
        result = [line for line in map(" ".join, map(str.split, printed))
                 if DECIMAL.sub("#", line).startswith(where)]  # fmt: skip
        assert result, f"{row}\n--- printed\n" + "\n".join(printed)
        for wanted, got in zip(DECIMAL.findall(message), DECIMAL.findall(result[0]), strict=False):
            last = 10.0 ** -len(wanted.partition(".")[2])
            assert abs(float(wanted) - float(got)) <= 1.001 * last, (row, result[0])
            compared += 1
    assert compared > 20


HIDDEN = {
    "a force 5 % too large": "a force 5 % too large, alone or with another fault",
    "a network that flows with a power of its force":
        "two networks, one of which flows with a power of its force",
    "one arm that flows with a power of its force":
        "an arm that flows with the second to fifth power of its force",
    "a change of temperature in the hold, .5 to 2.4 K":
        "seals that warm or cool by .5 to 2.4 K in the hold",
    "earlier loadings, cut off and ignored": "seed 31, ignored",
    "the same loadings, in the file": "seed 31, included",
    "an unstated compliance of 50 µm/N": "compliance 50 µm/N",
    "aliased mains hum": "mains hum aliased by a slow converter",
    "an arm slower than the hold, with a hammer test":
        "an arm slower than the hold, both tests",
}  # fmt: skip
"""What docs/limits.md calls a row of docs/bounds.md."""


def test_counts_of_the_limits_page_are_those_of_the_measured_tables():
    """Records, those with *use* and the wrong ones of these; some tables give shares of records."""
    measured = {}
    for line in (ROOT / "docs" / "bounds.md").read_text("utf-8").splitlines():
        label, *cells = [cell.strip() for cell in line.strip("|").split("|")]
        measured.setdefault(label, []).append(cells)
    page = (ROOT / "docs" / "limits.md").read_text("utf-8")
    rows = re.findall(r"^\| (.+?) \| (\d+) \| (\d+) \| (\d+) \|$", page, re.M)
    assert [label for label, *_ in rows] == list(HIDDEN)
    for label, *counts in rows:
        records, used, wrong = map(int, counts)
        result = [
            cells
            for cells in measured[HIDDEN[label]]
            if cells[0] == str(records)
            and (str(used) in cells or f"{used / records:.2f}" in cells)
            and (str(wrong) in cells or f"{wrong}/{wrong}" in cells)
        ]
        assert result, (label, counts, measured[HIDDEN[label]])


def test_pictures_of_the_readme_exist():
    pictures = re.findall(r"!\[[^\]]*\]\(([^)]+)\)", README)
    assert pictures
    for picture in pictures:
        assert (ROOT / picture).is_file()


@pytest.mark.parametrize("page", [page for page in PAGES if "/howto/" in page])
def test_every_how_to_shows_a_picture_and_the_index_shows_it(page):
    text = (ROOT / page).read_text("utf-8")
    assert re.search(r"_pictures/\w+\.svg", text)
    index = (ROOT / "docs" / "index.md").read_text("utf-8")
    name = Path(page).name
    assert re.search(rf"\]\(howto/{name}\)", index)


def test_every_picture_of_the_pages_is_drawn():
    drawn = (ROOT / "docs" / "pictures.py").read_text("utf-8")
    text = "".join((ROOT / page).read_text("utf-8") for page in PAGES)
    shown = set(re.findall(r"_pictures/(\w+)\.(svg|png)", text))
    assert shown
    for name, ending in shown:
        assert f'"{name}"' in drawn or f"{name}.{ending}" in drawn, name


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


def test_documented_layers_equal_the_contracts():
    held = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]
    page = (ROOT / "docs" / "architecture.md").read_text("utf-8")
    layers = [line for line in held["contracts"][0]["layers"] if line != "__main__"]
    assert "\n".join(["```text", *layers, "```"]) in page
    rooms = re.findall(r"^\| `(\w+)/` \|", page, flags=re.M)
    assert sorted(rooms) == sorted(word for line in layers for word in line.split(" | "))


def list_parameters() -> dict[str, list[set[str]]]:
    """Return the keywords of every function and dataclass of the package, by its name."""
    parameters: dict[str, list[set[str]]] = {}
    for file in (ROOT / "src" / "dashpot").rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text("utf-8"))):
            if isinstance(node, ast.FunctionDef):
                group = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
                names = {"**"} if node.args.kwarg else {argument.arg for argument in group}
            elif isinstance(node, ast.ClassDef):
                fields = (part.target for part in node.body if isinstance(part, ast.AnnAssign))
                names = {field.id for field in fields if isinstance(field, ast.Name)} or {"**"}
            else:
                continue
            parameters.setdefault(node.name, []).append(names)
    return parameters


def test_calls_in_a_sentence_name_parameters_that_exist() -> None:
    """The table of former names shows calls of earlier versions."""
    parameters, wrong = list_parameters(), []
    for page in PAGES:
        if page == "docs/documents.md":
            continue
        text = (ROOT / page).read_text("utf-8")
        for call in re.finditer(r"(\w+)\(([^()\n]*\w=[^()\n]*)\)", text):
            keywords = re.findall(r"(?<![\w=<>])(\w+)=(?!=)", re.sub('"[^"]*"', "", call[2]))
            expected = parameters.get(call[1])
            wrong += [
                f"{page}: {call[0]}"
                for keyword in keywords
                if expected and not any(names & {keyword, "**"} for names in expected)
            ]
    assert wrong == []


def test_every_member_of_an_api_page_exists():
    missing = []
    for page in sorted((ROOT / "docs" / "api").glob("*.md")):
        module = ""
        for line in page.read_text().splitlines():
            word, _, rest = line.strip().partition(":: ")
            if word == ".. automodule":
                module = rest
            elif line.strip().startswith(":members: "):
                names = line.partition(":members: ")[2].split(",")
                result = importlib.import_module(module)
                missing += [
                    f"{page.name}: {module} {name}"
                    for name in map(str.strip, names)
                    if not hasattr(result, name)
                ]
    assert missing == []
