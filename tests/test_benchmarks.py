"""The benchmarks run: by day what they ask of dashpot is there, by night each in its least form."""

from __future__ import annotations
import __future__

import ast
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from inspect import ismethod, signature
from pathlib import Path
from typing import Any, get_overloads

import pytest

import dashpot

BENCHMARKS = Path(__file__).resolve().parents[1] / "benchmarks"
TREES = {path.stem: ast.parse(path.read_text("utf-8")) for path in sorted(BENCHMARKS.glob("*.py"))}
OURS = {"dashpot", "kit"}
needs_chromium = pytest.mark.skipif(
    not (shutil.which("chromium") or shutil.which("chromium-browser")),
    reason="no chromium on this machine (apt-get install chromium)",
)

# arguments of a script with which it ends soon, and a line that it prints near its end
RUNS = [
    ("answers", r"run --only seal_8mm\.csv", r"^ +[\d.]+ s  0  dashpot fit seal_8mm\.csv"),
    ("anybody", "--records 1", r"^full, one arm more: \w"),
    pytest.param("app", "--usual --moves 10 --loads 2", r"^exit +[\d.]+ ms", marks=needs_chromium),
    ("batch", "1 1 20 --kinds quick", r"^  10000000 .*core h"),
    ("cold_start", "--rounds 1", r"^dashpot --help / \(import click\): [\d.]+ in CPU time"),
    ("coverage", "--seeds 2 --noise white", r"^white( +[01]\.\d{3}){5}"),
    ("coverage_kinds", "speeds --seeds 1", r"^  tau2 +[01]$"),
    ("engine", "--once", r"^batch, hold, R = 200, errors, per record .*scipy's optimum alone"),
    ("frf_peers", "", r"^  at the end  dashpot .*2\.00 .* %$"),
    (
        "growth",
        "--rows 2000 4000 --temperatures 1 --files 1 --watched 5 --rounds 1",
        r"^ +5 files, idle --watch +[\d.]+ ms a beat$",
    ),
    ("global_optimum", "4", r"^wide +thorough +[01]\.\d{4} / "),
    ("main_calls", "", r"^all main calls ran$"),
    ("master_curves", "", r"^together +5 arms, loss 0\.004-50 Hz off by +0\."),
    ("nist", "", r"^MGH17 +1\d\.\d"),
    ("order", "--seeds 1 --noise white", r"^white( +[01]\.\d\d){3}"),
    ("peers", "", r"^One run with Python"),
    ("report", "--rounds 1", r"^the page of both +[\d.]+ s CPU"),
    (
        "side_by_side",
        f"{sys.prefix} {sys.prefix} --rounds 1 --records 1 --only fit$|records",
        r"^  95 % of them, and sum +[\d.]+ +[\d.]+ +[\d.]+$",
    ),
    ("two_thousand", "64", r"^  repeat +[\d.]+ % \(.*\), drawn from 1 %: "),
    (
        "verdicts",
        (
            "OUT --per 0 --several 1 --kinds 2 --conditioned 2 --hammers 1 --pairs 1 --curves 6 "
            "--claims 1"
        ),
        r'^of \d+ with "use" \d+ are wrong',
    ),
    ("verdicts_results", "--each 3", r'^of \d+ called "use" \d+ miss'),
]

NAMES = [getattr(run, "values", run)[0] for run in RUNS]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "words", "text"), RUNS, ids=NAMES)
def test_a_benchmark_runs(name: str, words: str, text: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, BENCHMARKS / f"{name}.py", *words.split()],
        capture_output=True,
        text=True,
        check=False,
        cwd=tmp_path,
    )
    message = done.stdout + done.stderr
    assert done.returncode == 0, message
    assert re.search(text, message, re.MULTILINE), message


def test_every_benchmark_is_run_by_night():
    whole = {name for name, tree in TREES.items() if "__main__" in ast.unparse(tree)}
    assert set(NAMES) == whole


@pytest.mark.parametrize("name", TREES)
def test_what_a_benchmark_asks_of_dashpot_is_there(name: str) -> None:
    """Each name exists, and each call by its name is of the arguments that the function takes."""
    assert not list(rotten(TREES[name]))


def test_what_has_rotted_is_seen():
    head = "import dashpot as dp\nfrom functools import partial\nfit = partial(dp.fit, record)\n"

    def find_rotten(text: str) -> list[str]:
        return list(rotten(ast.parse(head + text)))

    assert not find_rotten("dp.fit(record, arms=2)")
    assert not find_rotten("fit(arms=2)")
    assert find_rotten("dp.fit(arms=2)") == ["dp.fit(arms=2)"]
    for text in ("dp.fit(record, intervals=False)", "fit(arms=2, intervals=False)"):
        assert find_rotten(text) == [text]
    with pytest.raises(AttributeError, match="fit_many"):
        find_rotten("dp.fit_many")


def rotten(tree: ast.Module) -> Iterator[str]:
    """Calls that dashpot would not take; of what is bound by `partial` the names alone are held."""
    imports, bound = resolve_imports(tree), {}
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            meant(node, imports)
        if isinstance(node, ast.Assign) and _is_partial(node.value):
            names = [target.id for target in node.targets if isinstance(target, ast.Name)]
            bound |= dict.fromkeys(names, node.value.args[0])
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        function, args, whole = node.func, node.args, True
        if _is_partial(node):
            function, args, whole = node.args[0], node.args[1:], False
        elif isinstance(function, ast.Name) and function.id in bound:
            function, args, whole = bound[function.id], [], False
        called = meant(function, imports)
        if callable(called) and not takes(called, args, node.keywords, whole=whole):
            yield ast.unparse(node)


def _is_partial(node: ast.expr) -> bool:
    return isinstance(node, ast.Call) and ast.unparse(node.func) == "partial"


def resolve_imports(tree: ast.Module) -> dict[str, Any]:
    """What the names stand for that a script has from here, and gives no other meaning."""
    values: dict[str, Any] = {}
    others = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for item in node.names:
                if (first := item.name.partition(".")[0]) in OURS:
                    module = import_module(item.name)
                    values[item.asname or first] = module if item.asname else sys.modules[first]
        elif isinstance(node, ast.ImportFrom) and node.module.partition(".")[0] in OURS:
            home = import_module(node.module)
            for item in node.names:
                if not hasattr(home, item.name):  # a module that nothing has loaded yet
                    import_module(f"{node.module}.{item.name}")
                values[item.asname or item.name] = getattr(home, item.name)
        elif isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load):
            others.add(node.id)
        elif isinstance(node, ast.arg):
            others.add(node.arg)
        elif isinstance(node, ast.FunctionDef | ast.ClassDef):
            others.add(node.name)
    return {name: value for name, value in values.items() if name not in others}


def meant(node: ast.expr, expected: dict[str, Any]) -> Any:
    """What a dotted name stands for; None where it is not known here."""
    if isinstance(node, ast.Name):
        return expected.get(node.id)
    if isinstance(node, ast.Attribute) and (home := meant(node.value, expected)) is not None:
        return getattr(home, node.attr)
    return None


@cache
def load_public_overloads() -> dict[str, list[Any]]:
    """Return the overloads of each function of the stub that holds the public signatures."""
    stub = Path(dashpot.__file__).with_name("_signatures.pyi")
    values: dict[str, Any] = {"__name__": "dashpot._signatures", "__package__": "dashpot"}
    functions: dict[str, list[Any]] = {}
    for node in ast.parse(stub.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef):
            node.decorator_list = []
        flags = __future__.annotations.compiler_flag
        code = compile(ast.Module([node], []), str(stub), "exec", flags, dont_inherit=True)
        exec(code, values)  # noqa: S102 -- a stub of our own
        if isinstance(node, ast.FunctionDef):
            functions.setdefault(node.name, []).append(values[node.name])
    return functions


def list_public_overloads(called: Any) -> list[Any]:
    """Return the overloads that the public stub states for a function of the API."""
    if not (getattr(called, "__module__", None) or "").startswith("dashpot.api."):
        return []
    return load_public_overloads().get(called.__name__, [])


def takes(called: Any, nodes: list[ast.expr], named: list[ast.keyword], *, whole: bool) -> bool:
    """Whether a function, or one of its overloads, takes such arguments."""
    plain: list[object] = [node for node in nodes if not isinstance(node, ast.Starred)]
    names = {quantity.arg: quantity.value for quantity in named if quantity.arg}
    whole &= len(plain) + len(names) == len(nodes) + len(named)
    several = get_overloads(called) or list_public_overloads(called)
    if several and ismethod(called):
        plain.insert(0, called.__self__)
    for item in several or [called]:
        try:
            taken = signature(item)
        except ValueError:  # an error's own: of anything
            return True
        try:
            (taken.bind if whole else taken.bind_partial)(*plain, **names)
        except TypeError:
            continue
        return True
    return False
