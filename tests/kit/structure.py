"""Figures of the structure of the source: names, size, files that a command runs, imports.

    python tests/kit/structure.py                 prints every figure
    python tests/kit/structure.py --write-lists   shortens the lists of allowed exceptions

The core is ``src/dashpot`` without ``extensions/``. Four lists hold the exceptions that
``tests/test_names.py`` and ``tests/test_structure.py`` allow: ``tests/data/bare_names.txt``,
``tests/data/vague_test_names.txt``, ``tests/data/extension_imports.txt`` and
``tests/data/core_files_not_entered.txt``.
``--write-lists`` removes entries that are no longer needed, of the last those of files that no
longer exist, and never adds one. ``--write-lists --admit-new`` adds to the others what is new,
which a review has to justify.
"""

from __future__ import annotations

import ast
import gc
import io
import os
import re
import statistics
import subprocess
import sys
import tempfile
import tokenize
import tomllib
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from types import FrameType
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "src" / "dashpot"
DATA = ROOT / "tests" / "data"
BARE_NAMES = DATA / "bare_names.txt"
VAGUE_TEST_NAMES = DATA / "vague_test_names.txt"
EXTENSION_IMPORTS = DATA / "extension_imports.txt"
FILES_NOT_ENTERED = DATA / "core_files_not_entered.txt"
MAIN_COMMANDS = ROOT / "benchmarks" / "main_commands.sh"
GENERATED = {"base/_version.py"}


def parse_words(text: str) -> frozenset[str]:
    """Return the words of a text."""
    return frozenset(text.split())


PARTICIPLES = parse_words(
    "told said given kept known left found shown drawn laid met felt held taken made written begun "
    "sought stood struck swung spoken worn bent done seen lost sent built"
)
"""Irregular ones; any word in -ed but those of `NOT_PARTICIPLES` is a participle, too."""
NOT_PARTICIPLES = parse_words("seed feed speed need embed")
FUNCTION_WORDS = parse_words(
    "of at in on by beside against behind beyond about above below under over upon within without "
    "between among around along through toward towards inside outside near apart alone again "
    "further elsewhere together alike so too both every each one other others whole bare own here "
    "there what who how which where when why"
)
"""Prepositions, adverbs, pronouns and question words."""
ADJECTIVES = parse_words(
    "soundest closest farthest nearest gravest largest worst likely clear sound gentle usual "
    "proper ready short odd plain neutral natural"
)
OPENING_PREPOSITIONS = parse_words("of at by in")
VERBS = parse_words(
    "get set read write load save compute calculate calc fit plot add remove delete create make "
    "build run parse format validate check is has to from convert update apply find select filter "
    "transform predict estimate evaluate eval solve minimize minimise sample draw render open "
    "close init register call copy merge split join sort stack unstack concat reset drop fill "
    "interp interpolate resample infer assert ensure test handle normalize normalise encode "
    "decode serialize serialise deserialize dump print log show export import generate gen "
    "simulate integrate differentiate derive process prepare initialize initialise start stop "
    "wait send receive connect replace rename map reduce iterate iter unpack pack extract insert "
    "append extend clip round invert inverse determine decide resolve require refuse raise expand "
    "simplify optimize optimise search scan count detect identify classify compare correlate "
    "average decimate"
)
VAGUE_WORDS = parse_words(
    "told said asked given found kept left beside apart moved felt noun room judged unseen one "
    "known alone sound each own further elsewhere offered former laid beyond"
)
"""Words that name no object of the field: a reader cannot tell what such an identifier holds."""
VAGUE_TEST_WORDS = parse_words(
    "told said asked given found kept known left beside beyond apart alone moved felt sound noun "
    "room house judged judging unseen own laid elsewhere former"
)
"""Words that name neither the subject of a test nor its behaviour."""


def split_words(name: str) -> list[str]:
    """Split an identifier into lower-case words and numbers.

    >>> split_words("_fit_RampHold2")
    ['fit', 'ramp', 'hold', '2']
    """
    pattern = r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+"
    return [word.lower() for part in name.split("_") for word in re.findall(pattern, part)]


def is_bare(name: str) -> bool:
    """Return whether a name is a participle, preposition, adverb or adjective and nothing more.

    >>> [is_bare(name) for name in ("_kept", "rounded", "of_arms", "speed", "keep_fit")]
    [True, True, True, False, False]
    """
    words = split_words(name)
    if len(words) > 1:
        return words[0] in OPENING_PREPOSITIONS and not name.startswith("__")
    return any(
        word in PARTICIPLES | FUNCTION_WORDS | ADJECTIVES
        or (word.endswith("ed") and word not in NOT_PARTICIPLES)
        for word in words
    )


def begins_with_verb(name: str) -> bool:
    """Return whether the first word of a name is a usual verb of programs."""
    return not VERBS.isdisjoint(split_words(name)[:1])


@dataclass(frozen=True)
class SourceFile:
    """A module of the package and its syntax tree."""

    path: str
    """Relative to the package, with slashes."""
    text: str
    tree: ast.Module

    @property
    def module(self) -> str:
        """Its dotted name, such as ``dashpot.cli.fit``."""
        return ".".join(("dashpot", *Path(self.path).with_suffix("").parts)).removesuffix(
            ".__init__"
        )

    @property
    def is_core(self) -> bool:
        """Whether it belongs to no extension."""
        return not self.path.startswith("extensions/")

    @cached_property
    def nodes(self) -> tuple[ast.AST, ...]:
        """Every node of the tree."""
        return tuple(ast.walk(self.tree))

    @property
    def functions(self) -> list[ast.FunctionDef | ast.AsyncFunctionDef]:
        """Functions and methods, nested ones included."""
        return [n for n in self.nodes if isinstance(n, (ast.FunctionDef, ast.AsyncFunctionDef))]

    @property
    def docstrings(self) -> set[ast.AST]:
        """Strings that stand alone as a statement."""
        return {
            n.value
            for n in self.nodes
            if isinstance(n, ast.Expr) and isinstance(n.value, ast.Constant)
        }


@cache
def read_source() -> tuple[SourceFile, ...]:
    """Parse every module of the package, without those that the build generates."""
    paths = {path.relative_to(PACKAGE).as_posix(): path for path in PACKAGE.rglob("*.py")}
    texts = {name: paths[name].read_text("utf-8") for name in sorted(paths.keys() - GENERATED)}
    collects = gc.isenabled()
    gc.disable()  # looking for garbage among growing trees takes longer than parsing does
    try:
        return tuple(SourceFile(name, text, ast.parse(text)) for name, text in texts.items())
    finally:
        if collects:
            gc.enable()


def select_core() -> list[SourceFile]:
    """Return the modules of the core."""
    return [file for file in read_source() if file.is_core]


# names


@cache
def list_functions() -> tuple[str, ...]:
    """Return the name of every function and method but the special ones (``__len__``)."""
    names = (node.name for file in read_source() for node in file.functions)
    return tuple(name for name in names if not name.startswith("__"))


def list_bare_modules() -> list[str]:
    """Return the modules whose file name is bare."""
    stems = ((file.path, Path(file.path).stem) for file in read_source())
    return [path for path, stem in stems if not stem.startswith("__") and is_bare(stem)]


def count_bare_functions() -> Counter[str]:
    """Count how many functions bear each bare name."""
    return Counter(name for name in list_functions() if is_bare(name))


def compute_share(names: Iterable[str], has_property: Callable[[str], bool]) -> float:
    """Return the percentage of names that have a property."""
    answers = [has_property(name) for name in names]
    return 100 * sum(answers) / len(answers)


def list_identifiers() -> Iterator[str]:
    """Yield every identifier where it stands: variables, attributes, parameters, definitions."""
    for file in read_source():
        for node in file.nodes:
            match node:
                case ast.Name(id=name) | ast.Attribute(attr=name) | ast.arg(arg=name):
                    yield name
                case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                    yield name
                case _:
                    pass


def compute_vague_share() -> float:
    """Return the percentage of identifiers that contain one of `VAGUE_WORDS`."""
    counts = Counter(list_identifiers())
    vague = sum(n for name, n in counts.items() if not VAGUE_WORDS.isdisjoint(split_words(name)))
    return 100 * vague / counts.total()


def list_vague_test_names() -> set[str]:
    """Return ``file name`` for each module, class and function of the tests with a vague word.

    The names of `VAGUE_TEST_WORDS` count. A file is named relative to ``tests/``.
    """
    names: set[tuple[str, str]] = set()
    for path in (ROOT / "tests").rglob("*.py"):
        file = path.relative_to(ROOT / "tests").as_posix()
        names.add((file, path.stem))
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
                names.add((file, node.name))
    return {
        f"{file} {name}"
        for file, name in names
        if not VAGUE_TEST_WORDS.isdisjoint(split_words(name))
    }


# size


def count_tokens(files: Iterable[SourceFile]) -> int:
    """Count names, operators and numbers: neither comments nor strings nor line breaks count."""
    counted = {tokenize.NAME, tokenize.OP, tokenize.NUMBER}
    return sum(
        token.type in counted
        for file in files
        for token in tokenize.generate_tokens(io.StringIO(file.text).readline)
    )


# imports of extensions by the core

EXTENSIONS = "dashpot.extensions"
ROW_FILES = {"registry/core.py"}
"""Their strings name modules of extensions; ``registration.py`` of one is no core anyway."""
DISCOVERY = (f"{EXTENSIONS.partition('.')[0]}.registry", EXTENSIONS)
"""The registry names the package in which it looks for extensions, and none of them."""
MODULE_IN_STRING = re.compile(r"^(?:dashpot\.)?(extensions(?:\.\w+)+)(?::\w+)?$")


@cache
def list_modules() -> frozenset[str]:
    """Return the dotted name of every module of the package."""
    return frozenset(file.module for file in read_source())


def resolve_import(file: SourceFile, node: ast.Import | ast.ImportFrom) -> list[str]:
    """Return the dotted names that a statement imports, relative ones made absolute."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    package = file.module.split(".")
    if not file.path.endswith("__init__.py"):
        package = package[:-1]
    start = ".".join(package[: len(package) - node.level + 1]) if node.level else ""
    module = ".".join(filter(None, (start, node.module or "")))
    names = (f"{module}.{alias.name}" for alias in node.names)
    return [name if name in list_modules() else module for name in names]


def find_module_in_string(file: SourceFile, value: object) -> list[str]:
    """Return the module of an extension that a string is the name of, if it is."""
    if not isinstance(value, str) or file.path in ROW_FILES:
        return []
    match = MODULE_IN_STRING.match(value)
    return [f"dashpot.{match[1]}"] if match else []


def list_extension_imports() -> set[str]:
    """Return ``importer -> imported`` for each import of an extension by the core.

    Imports inside functions and for types count, and strings that are a module of an extension;
    docstrings and the rows of the registry do not.
    """
    pairs: set[tuple[str, str]] = set()
    for file in select_core():
        docstrings = file.docstrings
        for node in file.nodes:
            targets: list[str] = []
            if isinstance(node, (ast.Import, ast.ImportFrom)):
                targets = resolve_import(file, node)
            elif isinstance(node, ast.Constant) and node not in docstrings:
                targets = find_module_in_string(file, node.value)
            pairs |= {(file.module, name) for name in targets}
    inside = {pair for pair in pairs if f"{pair[1]}.".startswith(f"{EXTENSIONS}.")}
    return {f"{importer} -> {imported}" for importer, imported in inside - {DISCOVERY}}


def read_linter_exceptions() -> set[str]:
    """Return the imports of extensions that ``pyproject.toml`` still allows the core."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    contracts = project["tool"]["importlinter"]["contracts"]
    rows = {row for contract in contracts for row in contract.get("ignore_imports", ())}
    return {row for row in rows if f"-> {EXTENSIONS}" in row}


# files that a command runs


def trace_files(*words: str, folder: Path) -> set[str]:
    """Return the files of the package in which a command runs a function or a class body.

    The command runs in a process of its own, whose working directory is `folder`.
    """
    trace = folder / "files.txt"
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    subprocess.run(
        [sys.executable, __file__, "--trace", str(trace), *words],
        check=True, capture_output=True, cwd=folder, env=environment,
    )  # fmt: skip
    return set(trace.read_text("utf-8").split())


def run_traced(trace: Path, words: list[str]) -> None:
    """Run a command in this process and write the files that it ran a function of."""
    import dashpot
    from dashpot.cli import main

    root = f"{Path(dashpot.__file__).parent}{os.sep}"
    files: set[str] = set()

    def record_call(frame: FrameType, event: str, _: Any) -> None:
        code = frame.f_code
        if event == "call" and code.co_filename.startswith(root) and code.co_name[0] != "<":
            files.add(code.co_filename)

    sys.setprofile(record_call)
    try:
        main(words, standalone_mode=False)
    finally:
        sys.setprofile(None)
        names = (Path(file).relative_to(root).as_posix() for file in files)
        trace.write_text("\n".join(sorted(names)), "utf-8")


def write_example_files(folder: Path) -> None:
    """Write the two files of the main job: ``seal_8mm.csv`` and ``hammer.csv``."""
    demo = [sys.executable, "-m", "dashpot", "demo", "--files"]
    subprocess.run(demo, check=True, capture_output=True, cwd=folder)


FIT_COMMAND = ("fit", "seal_8mm.csv")
REPORT_COMMAND = (
    "report", "seal_8mm.csv", "hammer.csv", "--mass", "114.8g", "--seals", "2", "-o", "page.html",
)  # fmt: skip


# files of the core that the main commands enter


def measure_main_commands(folder: Path) -> dict[str, set[int]]:
    """Run the main commands under coverage and return the lines that ran of each file."""
    from coverage import Coverage, CoverageData

    data = folder / ".coverage"
    coverage = f"{sys.executable} -m coverage run -p --data-file={data} --source=dashpot"
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        ["bash", MAIN_COMMANDS, f"{coverage} -m dashpot", coverage],
        check=False, capture_output=True, text=True, cwd=folder, env=environment,
    )  # fmt: skip
    if done.returncode:
        messages = (folder / "messages.txt").read_text("utf-8")
        raise RuntimeError(f"{done.stdout}{done.stderr}\n{messages[-2000:]}")
    combined = Coverage(data_file=str(data), config_file=False)
    combined.combine([str(folder)])
    combined.save()
    lines = CoverageData(basename=str(data))
    lines.read()
    return {
        Path(file).relative_to(PACKAGE).as_posix(): set(lines.lines(file) or ())
        for file in lines.measured_files()
        if Path(file).is_relative_to(PACKAGE)
    }


def list_body_lines(file: SourceFile) -> set[int]:
    """Return the lines inside functions, without docstrings, overloads and bodies of ``...``."""
    lines: set[int] = set()
    for node in file.functions:
        body = [
            n
            for n in node.body
            if not (isinstance(n, ast.Expr) and isinstance(n.value, ast.Constant))
        ]
        for statement in body:
            lines |= set(range(statement.lineno, (statement.end_lineno or statement.lineno) + 1))
    return lines


def list_files_not_entered(lines: dict[str, set[int]]) -> set[str]:
    """Return the files of the core that hold functions of which none ran."""
    bodies = ((file.path, list_body_lines(file)) for file in select_core())
    return {path for path, body in bodies if body and body.isdisjoint(lines.get(path, set()))}


# lists of allowed exceptions


def read_rows(path: Path) -> dict[str, str]:
    """Read a list: ``name: value`` or a name alone on each line; ``#`` opens a comment line."""
    rows = (line for line in path.read_text("utf-8").splitlines() if line and line[0] != "#")
    return {name: value.strip() for name, _, value in (row.partition(": ") for row in rows)}


def read_bare_names() -> Counter[str]:
    """Return how many functions may still bear each bare name."""
    return Counter({name: int(count) for name, count in read_rows(BARE_NAMES).items()})


def write_rows(path: Path, rows: Iterable[str]) -> None:
    """Replace the rows of a list and keep its opening comment."""
    text = path.read_text("utf-8").splitlines()
    head = [line for line in text if line.startswith("#")]
    path.write_text("\n".join([*head, *rows, ""]), "utf-8")


def shorten_lists(*, admit_new: bool = False) -> None:
    """Rewrite the lists by what the source has now: no entry is added unless `admit_new`."""
    counts = count_bare_functions()
    if not admit_new:
        counts &= read_bare_names()
    write_rows(BARE_NAMES, (f"{name}: {counts[name]}" for name in sorted(counts)))
    test_names = list_vague_test_names()
    if not admit_new:
        test_names &= set(read_rows(VAGUE_TEST_NAMES))
    write_rows(VAGUE_TEST_NAMES, sorted(test_names))
    imports = list_extension_imports() - read_linter_exceptions()
    if not admit_new:
        imports &= set(read_rows(EXTENSION_IMPORTS))
    write_rows(EXTENSION_IMPORTS, sorted(imports))
    core = {file.path for file in select_core()}
    reasons = read_rows(FILES_NOT_ENTERED)
    write_rows(FILES_NOT_ENTERED, (f"{path}: {reasons[path]}" for path in reasons if path in core))


# sizes of packages in docs/architecture.md

TREE = ROOT / "docs" / "architecture.md"
SIZE_ROW = re.compile(r"^\| `(?P<package>[\w/]+)/` \| (?P<size>\d+) \|", re.MULTILINE)


def count_package_tokens() -> Counter[str]:
    """Return the tokens of each package of the core and of each extension, by its path."""
    counts: Counter[str] = Counter()
    for file in read_source():
        parents = file.path.removesuffix(".py").split("/")
        length = 2 if parents[0] == EXTENSIONS.rpartition(".")[2] else 1
        counts["/".join(parents[:length])] += count_tokens([file])
    return counts


def read_tree_sizes() -> dict[str, int]:
    """Return the sizes that the page of the tree states, thousands of tokens."""
    text = TREE.read_text("utf-8")
    return {row["package"]: int(row["size"]) for row in SIZE_ROW.finditer(text)}


def write_tree_sizes() -> None:
    """Write the sizes of the packages into the page of the tree."""
    counts = count_package_tokens()

    def fill_row(row: re.Match[str]) -> str:
        package = row["package"]
        return f"| `{package}/` | {round(counts[package] / 1000)} |"

    TREE.write_text(SIZE_ROW.sub(fill_row, TREE.read_text("utf-8")), "utf-8")


def print_figures() -> None:
    """Print every figure that the tests hold, and a few beside them."""
    functions, core = list_functions(), select_core()
    words = [len(split_words(name)) for name in functions]
    print(f"modules {len(read_source())}, with a bare name {len(list_bare_modules())}")
    print(f"functions {len(functions)}, with a bare name {compute_share(functions, is_bare):.2f} %")
    print(f"functions that begin with a verb {compute_share(functions, begins_with_verb):.2f} %")
    print(f"words in the name of a function: median {statistics.median(words):g}")
    print(f"identifiers with a vague word {compute_vague_share():.2f} %")
    print(f"names of tests with a vague word {len(list_vague_test_names())}")
    print(f"core: {len(core)} files, {count_tokens(core)} tokens")
    print(f"extensions: {count_tokens(set(read_source()) - set(core))} tokens")
    imports, allowed = list_extension_imports(), read_linter_exceptions()
    print(
        f"imports of extensions by the core {len(imports)}, "
        f"{len(imports & allowed)} of them in pyproject.toml"
    )
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_example_files(folder)
        print(f"fit FILE runs {len(trace_files(*FIT_COMMAND, folder=folder))} files")
        print(f"report runs {len(trace_files(*REPORT_COMMAND, folder=folder))} files")
    with tempfile.TemporaryDirectory() as name:
        idle = sorted(list_files_not_entered(measure_main_commands(Path(name))))
    print(f"files of the core that the main commands do not enter: {len(idle)}", *idle, sep="\n  ")


def main(words: list[str]) -> None:
    """Act on the words of the command line."""
    match words:
        case []:
            print_figures()
        case ["--trace", trace, *command]:
            run_traced(Path(trace), command)
        case ["--write-lists"] | ["--write-lists", "--admit-new"]:
            shorten_lists(admit_new="--admit-new" in words)
            write_tree_sizes()
        case _:
            sys.exit(__doc__)


if __name__ == "__main__":
    main(sys.argv[1:])
