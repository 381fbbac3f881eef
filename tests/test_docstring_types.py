"""What docstrings and pages name exists: what was renamed is not left behind in prose."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import TypeAlias

from kit.structure import PACKAGE, read_source

ENTRY = re.compile(r"(?m)^ {0,4}[a-z_][\w, *]* : (.+)$")
"""A parameter or attribute of a numpydoc section, and its type."""
CLASS = re.compile(r"(?<![\w.\"'`])[A-Z][a-z]\w+(?![\w\"'])")


def list_defined_names(tree: ast.AST) -> set[str]:
    """Return the classes, constants and imported names of a module."""
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef):
            names.add(node.name)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            names |= {alias.asname or alias.name for alias in node.names}
    return names


def test_docstrings_name_types_that_exist():
    files = read_source()
    names = {"None", "True", "False"}.union(*(list_defined_names(file.tree) for file in files))
    stale = {
        f"{file.path}: {entry[0].strip()}"
        for file in files
        for node in ast.walk(file.tree)
        if isinstance(node, ast.FunctionDef | ast.ClassDef)
        for entry in ENTRY.finditer(ast.get_docstring(node) or "")
        if set(CLASS.findall(entry[1])) - names
    }
    assert stale == set()


SECTION = re.compile(r"(?ms)^(?:Parameters|Attributes)\n-+\n(.*?)(?=^\w[\w ]*\n-+$|\Z)")
LINE = re.compile(r"(?m)^((?:\*{0,2}[A-Za-z_]\w*(?:, )?)+)(?: : .*)?$")
"""Names of parameters or attributes at the margin of a section."""


Definition: TypeAlias = ast.FunctionDef | ast.ClassDef


def list_arguments(node: ast.AST) -> set[str]:
    return {item.arg for item in ast.walk(node) if isinstance(item, ast.arg)}


def list_members(node: ast.ClassDef, definitions: Mapping[str, list[Definition]]) -> set[str]:
    members = list_arguments(node)
    for item in ast.walk(node):
        if isinstance(item, ast.FunctionDef):
            members.add(item.name)
        elif isinstance(item, ast.Name | ast.Attribute) and isinstance(item.ctx, ast.Store):
            members.add(item.id if isinstance(item, ast.Name) else item.attr)
    bases = [
        name.id for base in node.bases for name in ast.walk(base) if isinstance(name, ast.Name)
    ]
    for parent in (parent for base in bases for parent in definitions[base]):
        if isinstance(parent, ast.ClassDef) and parent is not node:
            members |= list_members(parent, definitions)
    return members


def list_documentable_names(
    node: Definition, definitions: Mapping[str, list[Definition]]
) -> set[str]:
    if isinstance(node, ast.ClassDef):
        return list_members(node, definitions)
    names = list_arguments(node)
    for decorator in node.decorator_list:  # it may take arguments of its own
        name = decorator.func if isinstance(decorator, ast.Call) else decorator
        if isinstance(name, ast.Name):
            names = names.union(*map(list_arguments, definitions[name.id]))
    return names


def test_docstrings_name_parameters_and_attributes_that_exist():
    definitions: defaultdict[str, list[Definition]] = defaultdict(list)
    documented = []
    for file in read_source():
        for node in ast.walk(file.tree):
            if isinstance(node, Definition):
                definitions[node.name].append(node)
                sections = SECTION.findall(ast.get_docstring(node) or "")
                words = re.findall(r"\w+", " ".join(LINE.findall("\n".join(sections))))
                documented.append((file.path, node, set(words)))
    stale = set()
    for path, node, words in documented:
        takes_any = isinstance(node, ast.FunctionDef) and node.args.kwarg is not None
        if words and not takes_any:
            missing = words - list_documentable_names(node, definitions)
            stale |= {f"{path}: {node.name}: {word}" for word in missing}
    assert stale == set()


PARAMETERS = re.compile(r"(?ms)^Parameters\n-+\n(.*?)(?=^\w[\w ]*\n-+$|\Z)")


def test_classes_document_the_arguments_of_their_initialiser():
    stale = set()
    for file in read_source():
        for node in (node for node in ast.walk(file.tree) if isinstance(node, ast.ClassDef)):
            sections = PARAMETERS.findall(ast.get_docstring(node) or "")
            words = set(re.findall(r"\w+", " ".join(LINE.findall("\n".join(sections)))))
            for item in node.body:
                if isinstance(item, ast.FunctionDef) and item.name == "__init__":
                    missing = words - list_arguments(item)
                    stale |= {f"{file.path}: {node.name}: {word}" for word in missing}
    assert stale == set()


ROOT = PACKAGE.parents[1]
DOTTED = re.compile(r"`~?dashpot\.(?!toml`)([a-z][\w.]*\w)(?:\(\))?`")
"""A name in full, as a reference of a docstring or a page."""


def is_name_of_package(name: str) -> bool:
    path, parts = PACKAGE, name.split(".")
    while parts and ((path / parts[0]).is_dir() or (path / f"{parts[0]}.py").is_file()):
        path /= parts.pop(0)
    files = [path / "__init__.py", path / "__init__.pyi", Path(f"{path}.py"), Path(f"{path}.pyi")]
    words = {word for file in files if file.is_file() for word in re.findall(r"\w+", read(file))}
    return not parts or parts[0] in words


@cache
def read(path: Path) -> str:
    return path.read_text("utf-8")


def test_full_names_in_docstrings_and_pages_exist():
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md"), *PACKAGE.rglob("*.py")]
    stale = {
        f"{page.relative_to(ROOT)}: {name}"
        for page in pages
        for name in DOTTED.findall(read(page))
        if not is_name_of_package(name) and name != "package.module"
    }
    assert stale == set()


def test_names_in_the_pages_for_contributors_exist():
    paths = (path for value in ("src", "tests", "docs") for path in (ROOT / value).rglob("*.py"))
    words = {word for path in paths for word in re.findall(r"\w+", read(path))}
    for page in ("CONTRIBUTING.md", "docs/architecture.md"):
        names = set(re.findall(r"(?<!`)`(\w*[A-Z_]\w*)(?:\(.*?\))?`", read(ROOT / page)))
        # a package that dashpot does without
        assert names - {"lazy_loader"} <= words
        assert len(names) > 20
