"""Types that docstrings name exist: a class that was renamed is not left behind in prose."""

from __future__ import annotations

import ast
import re

from kit.structure import read_source

ENTRY = re.compile(r"(?m)^ {0,4}[a-z_][\w, *]* : (.+)$")
"""A parameter or attribute of a numpydoc section, and its type."""
CLASS = re.compile(r"(?<![\w.\"'`])[A-Z][a-z]\w+(?![\w\"'])")
CODE = re.compile(r'"""(?:.|\n)*?"""')


def test_docstrings_name_types_that_exist():
    files = read_source()
    names = {"None", "True", "False", "Path"}
    for file in files:
        names |= set(re.findall(r"\b[A-Z]\w+", CODE.sub("", file.text)))
    stale = {
        f"{file.path}: {entry[0].strip()}"
        for file in files
        for node in ast.walk(file.tree)
        if isinstance(node, ast.FunctionDef | ast.ClassDef)
        for entry in ENTRY.finditer(ast.get_docstring(node) or "")
        if set(CLASS.findall(entry[1])) - names
    }
    assert stale == set()
