"""How the documentation is built: offline, every reference resolved, every picture drawn anew."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import click
from docutils import nodes
from docutils.parsers.rst import Directive
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util.math import get_node_equation_number

from dashpot import __version__
from dashpot.cli import main as command_line
from dashpot.registry import COMMANDS

sys.path.insert(0, str(Path(__file__).parent))
import pictures

project = "dashpot"
author = "the dashpot developers"
copyright = "2026, the dashpot developers"
release = __version__
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
]
myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence", "deflist"]
myst_heading_anchors = 3
html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["cards.css"]
html_search_scorer = str(Path(__file__).with_name("scorer.js"))
html_title = "dashpot"
html_math_renderer = "mathml"
exclude_patterns = ["_build"]
autodoc_typehints = "none"
# there are none, and to look for them reads every function again
autodoc_use_type_comments = False
autodoc_member_order = "bysource"
add_module_names = False
toc_object_entries_show_parents = "hide"
napoleon_use_rtype = False
# an en dash is no option
smartquotes = False
nitpicky = True
# the words of a type in a docstring ("array", "optional") and others' nouns are no references
nitpick_ignore_regex = [("py:class", r"(?!dashpot\.).*")]


def inline_math(translator: nodes.NodeVisitor, node: nodes.math) -> None:
    """Write an inline formula as MathML, which every browser draws by itself."""
    translator.body.append(convert(node.astext()))
    raise nodes.SkipNode


def block_math(translator: nodes.NodeVisitor, node: nodes.math_block) -> None:
    """Write a formula on lines of its own, with its number if it has one."""
    text = node.astext().strip()
    if "\\\\" in text and "\\begin" not in text:
        text = rf"\begin{{aligned}}{text}\end{{aligned}}"
    translator.body.append('<div class="formula">')
    if node["number"]:
        number = get_node_equation_number(translator, node)
        translator.body.append(f'<span class="eqno">({number})</span>')
    translator.body.append(convert(text, display="block"))
    translator.body.append("</div>\n")
    raise nodes.SkipNode


class Commands(Directive):
    """The whole help of every command, as ``--help-all`` prints it, group by group."""

    def run(self) -> list[nodes.Node]:
        """Return a section for each group, and in it one for each command."""
        above = click.Context(command_line, info_name="dashpot")
        parts: list[nodes.Node] = []
        for title in dict.fromkeys(command.group for command in COMMANDS.values()):
            part = _section(title)
            for name in (name for name, row in COMMANDS.items() if row.group == title):
                verb = command_line.get_command(above, name)
                one = click.Context(verb, info_name=name, parent=above)
                section = _section(f"dashpot {name}")
                section += nodes.literal_block(
                    text=verb.render_help(one, show_all=True), language="text"
                )
                part += section
            parts.append(part)
        return parts


def _section(title: str) -> nodes.section:
    name = nodes.fully_normalize_name(title)
    return nodes.section("", nodes.title(text=title), ids=[nodes.make_id(name)], names=[name])


def trim_docstring(_app: Sphinx, _name: str, text: list[str]) -> None:
    """Take off the blank line that ends a session for doctest."""
    text[0] = text[0].replace("\n\n```\n", "\n```\n")


def shallow(app: Sphinx, _: nodes.document) -> None:
    """Keep classes and functions in the list of contents, and leave out their members.

    Two thousand of them, copied for every page, would cost a quarter of the build.
    """
    tree = app.env.tocs[app.env.docname]
    for deep in list(tree.findall(nodes.bullet_list)):
        if app.env.docname.startswith("api") and _depth(deep) > 2:
            deep.parent.remove(deep)


def _depth(node: nodes.Node) -> int:
    above = 0
    while node is not None:
        above += isinstance(node, nodes.bullet_list)
        node = node.parent
    return above


def sentence(_app: Sphinx, what: str, *rest: object) -> None:
    """Let no colon in the first sentence of a property end a type, as napoleon has it."""
    if what in ("property", "attribute"):
        rest[-1][:0] = ["..", ""]  # an empty comment stands where the type would


def part_commands(_app: Sphinx, tree: nodes.document) -> None:
    """Part each command of a session from its output, so that it wraps where the output scrolls."""
    for block in list(tree.findall(nodes.literal_block)):
        lines = block.astext().splitlines()
        if block.get("language") == "sh" or all(line.startswith("dashpot ") for line in lines):
            block["classes"].append("typed")
        if block.get("language") != "console":
            continue
        parts = []
        for command in re.split(r"^(?=\$ )", block.astext(), flags=re.M):
            first, _, output = command.partition("\n")
            if first:
                parts.append(
                    nodes.literal_block(first, first, language="console", classes=["typed"])
                )
            # a line that names the next command is one, too
            for text in filter(str.strip, re.split(r"^(next: .*\n?)", output, flags=re.M)):
                kind = "typed" if text.startswith("next: ") else "printed"
                lines = text.removesuffix("\n")
                parts.append(nodes.literal_block(lines, lines, language="text", classes=[kind]))
        whole = nodes.container("", *parts, classes=["session"])
        block.replace_self(whole)


def setup(app: Sphinx) -> None:
    """Register the renderer, and draw the gallery before anything is read."""
    app.add_directive("commands", Commands)
    app.add_html_math_renderer("mathml", (inline_math, None), (block_math, None))
    app.connect("source-read", trim_docstring)
    app.connect("doctree-read", part_commands)
    app.connect("doctree-read", shallow, priority=900)
    app.connect("autodoc-process-docstring", sentence, priority=100)
    app.connect("builder-inited", lambda _: pictures.gallery())
    if pictures.app():
        app.tags.add("browser")
