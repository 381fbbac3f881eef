"""Words that are no verb: commands of former editions, each answered with the line that runs."""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from dashpot.cli import COMMANDS
from dashpot.cli._param_types import nearest

_COLUMNS = (
    "time", "displacement", "force", "stress", "strain", "stretch", "creep-compliance",
    "acceleration", "hammer", "base-acceleration", "velocity", "frequency", "storage", "loss",
    "loss-factor", "modulus", "real", "imaginary", "magnitude", "phase", "coherence",
)  # fmt: skip
_KEYS = {
    "--temperature-column": ("--column", "temperature"),
    "--delimiter": ("--text", "delimiter"), "--decimal": ("--text", "decimal"),
    "--encoding": ("--text", "encoding"), "--skip-rows": ("--text", "skip"),
    "--segment": ("--part", "segment"), "--cycle": ("--part", "cycle"),
    "--sheet": ("--part", "sheet"),
    **{f"--{role}": ("--column", role) for role in _COLUMNS},
    **{f"--{key}": ("--machine", key) for key in ("sync", "drift", "compliance", "force-filter")},
    **{f"--{key}": ("--cuts", key) for key in ("onset", "ramp-end", "hold-end")},
    "--static-stiffness": ("--known", "stiffness"),
    "--natural-frequency": ("--known", "frequency"), "--damping-ratio": ("--known", "damping"),
    **{f"--{key}": ("--label", key) for key in ("name", "lot", "operator", "date", "notes")},
}  # fmt: skip
"""Options that are a KEY=VALUE of another now."""


class _Former(NamedTuple):
    """What a former command is now: verb and words, its renamed options, those that were files."""

    verb: tuple[str, ...]
    renamed: dict[str, str] = {}  # noqa: RUF012 -- never changed
    files: tuple[str, ...] = ()
    flags: tuple[str, ...] = ()


_SAME = {
    "--family": "--model", "--law": "--model", "--direct": "--stiffness-table",
    "--parallel-dashpot": "--dashpot", "--record": "--hit-length",
    "--impact-temperature": "--hammer-temperature", "--limits": "--force-limits",
}  # fmt: skip
_FLAGS = (
    "--json", "--strict", "-v", "--verbose", "--overwrite", "--open", "--lubricated", "--all",
    "--modes", "--quick", "--joint", "--parallel-dashpot", "--base", "--thorough",
)  # fmt: skip
_HELP = {"help": "--help", "version": "--version"}
"""Words that other programs take for a command."""
_QUANTITY = re.compile(r"\A[\d.+-]+\s*[^\W\d]")
_MODES = ("uniaxial", "biaxial", "planar", "compression", "volumetric")
_SHAPES = ("--disc", "--block", "--bush", "--bulb")
_FIT = ("fit",)
FORMER = {
    "impact": _Former(_FIT),
    "modes": _Former(_FIT),
    "identify": _Former(_FIT, files=("--with",)),
    "level": _Former(_FIT, {"--at": "--resonance-at"}),
    "cld": _Former(_FIT, {"--at": "--compression", "--with": "--memory"}),
    "hyperelastic": _Former(_FIT, {"--with": "--memory"}),
    "indent": _Former(_FIT),
    "rod": _Former(_FIT),
    "door": _Former(("predict",)),
    "watch": _Former(("batch",), {"--at": "--frequency"}),
    "example": _Former(("demo", "--files")),
}
"""Commands that are no more; with 1.0 this table goes."""
_BENCH = {"--law": "--elastic", "--family": "--model", "--at": "--only"}
CHANGED = {
    "inspect": _Former(("inspect",), {"--save-profile": "--save"}),
    "fit": _Former(_FIT, _BENCH),
    "report": _Former(("report",), _BENCH, files=("--impact",)),
    "predict": _Former(
        ("predict",), {"--with": "--record", "--record": "--record", "--lines": "--points"}
    ),
    "compare": _Former(("compare",), {"--with": "--record", "--record": "--record"}),
    "export": _Former(("export",), {"--units": "--unit-system", "--range": "--band"}),
    "plan": _Former(("plan",), {"--at": "--frequency", "--model": "--seal"}),
    "simulate": _Former(("simulate",), {"--model": "--seal", "--motion": "--follow"}),
    "record": _Former(("record",), {"--model": "--seal"}),
    "batch": _Former(("batch",), {"--at": "--frequency", "--limits": "--limits"}),
}
"""Verbs whose options were called otherwise."""


def instead(name: str, rest: Sequence[str]) -> str:
    """Return what to type in place of a word that is no verb."""
    if name in FORMER:
        return f"Type: {shlex.join(['dashpot', *_translated(FORMER[name], name, list(rest))])}"
    if name in _HELP:
        known = [word for word in rest[:1] if word in COMMANDS]
        return f"Type: {shlex.join(['dashpot', *known, _HELP[name]])}"
    if Path(name).exists():
        return f"To see what it is: dashpot inspect {shlex.quote(name)}"
    return nearest(name, COMMANDS)


def renamed(name: str, option: str, rest: Sequence[str]) -> str:
    """Return what to type where a verb was given an option by its former name; else nothing."""
    known = {*_KEYS, *_SAME, *_SHAPES, "--motion", "--depth-law", "--force"}
    former = CHANGED.get(name)
    said = list(rest)[list(rest).index(option) + 1 :] if option in rest else []
    if option in _KEYS and said and _QUANTITY.match(said[0]):  # no name of a column
        return ""
    if former is None or option not in {*known, *former.renamed, *former.files}:
        return ""
    return f"Type: {shlex.join(['dashpot', *_translated(former, name, list(rest))])}"


def _translated(former: _Former, name: str, words: list[str]) -> list[str]:
    """Return a former command in the words of today."""
    verb, files, options = former.verb, [], []
    if name == "modes" and "--against" in words:
        verb = ("compare",)
    left = iter(words)
    for word in left:
        if not word.startswith("-"):
            files.append(word)
        elif word == "--depth-law":
            options += ["--elastic", "by-depth"]
        elif word == "--force" and name == "export":
            options += ["--allow", "all"]
        elif word in _FLAGS:
            options.append(_SAME.get(word, word))
        else:
            options += _option(former, name, word, next(left, ""), files)
    if name == "watch":
        options.append("--watch")
    return [*verb, *files, *options]


def _option(former: _Former, name: str, word: str, value: str, files: list[str]) -> list[str]:
    if word in former.files or word == "--against":
        files.append(value)
        return []
    if name == "hyperelastic" and word in {f"--{mode}" for mode in _MODES}:
        files.append(value)
        return ["--test", word[2:]]
    if word in _SHAPES:
        return ["--shape", f"{word[2:]}:{value}"]
    if word in former.renamed:
        return [former.renamed[word], value]
    if word == "--motion":
        return ["--relative"] if value == "relative" else []
    if word in _KEYS and Path(value).is_file():
        # a record is an argument
        files.append(value)
        return []
    if word in _KEYS and not (name == "indent" and word == "--notes"):
        option, key = _KEYS[word]
        return [option, f"{key}={value}"]
    return [_SAME.get(word, word), value]
