"""Kinds that stand alone, as the page has them: verdict, lights, figure, table, checks of each.

What one is asked beside its files is declared here as the page's own fields; what it tells is what
the page of its kind tells in `dashpot.report`.
"""

from __future__ import annotations

import json
import shlex
import shutil
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from dashpot import workflow
from dashpot.base.errors import DataError, ReadError
from dashpot.base.numbers import rounded
from dashpot.base.progress import doing
from dashpot.base.units import si, si_range
from dashpot.io.options import ReadOptions
from dashpot.kinds import KINDS, load
from dashpot.kinds.hyperelastic.asked import MODES
from dashpot.kinds.indentation.indenter import Indenter
from dashpot.records.fit import Fit
from dashpot.records.specimen import Specimen
from dashpot.report.answer import Row
from dashpot.report.judged import text_of
from dashpot.report.kind_page import Group, KindPage, lights
from dashpot.report.of_kinds import kind_page
from dashpot.report.pages import COLOURS
from dashpot.web import results, views, wire
from dashpot.web.asks import ASKS, DOOR, ROD, Ask, asks_of
from dashpot.web.bench import KEPT, WIDE
from dashpot.web.requests import listed, mapping, part, sizes_of
from dashpot.web.store import path_in
from dashpot.workflow.archive import to_json
from dashpot.workflow.job import Job, RodChoices


@dataclass(frozen=True)
class JudgedFiles:
    """What a page asks of such files."""

    kind: str
    files: tuple[str, ...]
    said: tuple[tuple[str, str], ...]
    options: ReadOptions
    behind: str = ""

    def of(self, name: str) -> str:
        """What stands in a field; empty where nothing does."""
        return dict(self.said).get(name, "")


def _asked(request: Mapping[str, Any], folder: Path) -> JudgedFiles:
    files = tuple(str(path_in(folder, one)) for one in listed(request, "files"))
    if not files:
        raise DataError("no file of this kind is open: open one first")
    said = {}
    for name, text in mapping(request.get("said", {}), "said").items():
        if not isinstance(text, str):
            raise DataError(f"{name} = {text!r}; expected a text")
        if text.strip():
            said[str(name)] = text.strip().replace(",", ".") if name != "disc" else text.strip()
    test = request.get("test")
    return JudgedFiles(
        str(request.get("kind", "")), files, tuple(sorted(said.items())),
        part(ReadOptions, request.get("options", {}), "options"),
        str(path_in(folder, test)) if test else "",
    )  # fmt: skip


@lru_cache(KEPT)
def _found(asked: JudgedFiles) -> tuple[Any, KindPage]:
    """What was found in such files, and what its page tells."""
    doing(f"fitting {', '.join(Path(path).name for path in asked.files)}")
    fits: dict[str, Callable[[JudgedFiles], Any]] = {
        "cld": _cld, "stress-strain": _stress_strain, "indentation": _indentation,
        "slam": _slam, ROD: _rod, DOOR: _door,
    }  # fmt: skip
    row = KINDS.get(asked.kind)
    if asked.kind in fits:
        found = fits[asked.kind](asked)
    elif row is not None and row.fits:
        found = load(row.fit)(asked.files, options=asked.options)
    else:
        raise DataError(f"'{asked.kind}' is no kind of test that is fitted by itself")
    return found, _door_page(found) if asked.kind == DOOR else kind_page(found)


def _door_page(found: Any) -> KindPage:
    """A door's own page is laid out otherwise: its first modes, in the form of the other kinds."""
    rows = tuple(
        Row(f"Mode {i}", rounded(one.mode.frequency, digits=4), "", "", "Hz", "", bound=False)
        for i, one in enumerate(found.modes[:8], 1)
    )
    return KindPage(
        about="a door on its seal", strip=(), lights=lights(found.checks, {"Door": frozenset()}),
        answers="A door", picture=found.plot(), told="Modes", groups=(Group("", rows),),
        sources=(), note="", name="door",
    )  # fmt: skip


def _number(asked: JudgedFiles, name: str, dimension: Any) -> float | None:
    """A quantity of a field, SI: in the field's unit, or in the one typed after it."""
    text = asked.of(name)
    unit = next(one.unit for one in ASKS[asked.kind] if one.name == name)
    if not text:
        return None
    return si(text if text[-1].isalpha() else f"{text}{unit}", dimension)


def _needed(asked: JudgedFiles, name: str, dimension: Any) -> float:
    found = _number(asked, name, dimension)
    if found is None:
        label = next(one.label for one in ASKS[asked.kind] if one.name == name)
        raise DataError(f"{label.lower()} is not given: type it beside the files")
    return found


def _cld(asked: JudgedFiles) -> Any:
    between = asked.of("between").replace(" to ", ":").replace("-", ":")
    length = _number(asked, "length", "length")
    return workflow.cld_files(
        asked.files,
        at=_number(asked, "compression", "length"),
        between=si_range(f"{between}mm", "length") if between else None,
        specimen=Specimen(length=length) if length else None,
        options=asked.options,
    )


def _stress_strain(asked: JudgedFiles) -> Any:
    modes: dict[str, list[str]] = {}
    for i, path in enumerate(asked.files):
        mode = asked.of(f"test {i}") or next(iter(MODES))
        modes.setdefault(mode, []).append(path)
    return workflow.hyperelastic_files(modes, options=asked.options)


def _indentation(asked: JudgedFiles) -> Any:
    indenter = Indenter(
        mass=_needed(asked, "mass", "mass"),
        radius=_number(asked, "radius", "length"),
        drop_height=_number(asked, "drop_height", "length"),
    )
    return workflow.indent_file(asked.files[0], indenter=indenter, options=asked.options)


def _slam(asked: JudgedFiles) -> Any:
    mass, slams = _number(asked, "mass", "mass"), tuple(asked.of("slam").split())
    return workflow.slam_files(asked.files, mass=mass, slam=slams, options=asked.options)


def _rod(asked: JudgedFiles) -> Any:
    disc = ",".join(f"{one.strip()}mm" for one in asked.of("disc").split(",") if one.strip())
    if not disc:
        raise DataError("the shape is not given: type diameter and length, such as 20, 20")
    return workflow.rod_files(
        asked.files[:1], mass=_needed(asked, "mass", "mass"),
        density=float(asked.of("density") or 1000.0), rod=RodChoices(disc=disc),
        options=asked.options,
    )  # fmt: skip


def _door(asked: JudgedFiles) -> Any:
    """A door with the files that are open beside it: it names them, and none elsewhere."""
    path = Path(asked.files[0])
    names = {Path(one).name: Path(one) for one in asked.files[1:]}
    try:
        said = tomllib.loads(path.read_text("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ReadError(f"{path.name}: it is no TOML: {error}") from None
    for text in _texts(said):
        if Path(text).is_absolute() or ".." in Path(text).parts or text[1:3] == ":\\":
            raise ReadError(
                f"{path.name} names a file elsewhere ({text}). Name it alone, and open it here"
            )
    home = path.parent.parent / "doors" / path.parent.name
    shutil.rmtree(home, ignore_errors=True)
    home.mkdir(parents=True)
    shutil.copy(path, home / path.name)
    for name, one in names.items():
        shutil.copy(one, home / name)
    wanted = said.get("seal", {}).get("fit") if isinstance(said.get("seal"), dict) else None
    if isinstance(wanted, str) and wanted not in names and asked.behind:
        # the door names the fit of a test that is open
        job = Job(asked.behind)
        fitted: Fit = results.fitted(results.of_fit(job), True, None)
        (home / wanted).write_text(to_json(fitted), encoding="utf-8")
    return workflow.door_file(home / path.name)


def _texts(said: Any) -> Iterator[str]:
    """Every text in a document."""
    if isinstance(said, str):
        yield said
    elif isinstance(said, dict | list):
        for one in said.values() if isinstance(said, dict) else said:
            yield from _texts(one)


def judge(request: Mapping[str, Any], folder: Path) -> bytes:
    """The result of such files: verdict, lights, figures, numbers, checks and command."""
    asked = _asked(request, folder)
    found, page = _found(asked)
    said = found.verdict
    width = sizes_of(request).get("bench", WIDE)[0]
    return wire.packed(
        {
            "verdict": views.verdict(said, page.lights),
            "colour": COLOURS[said.use],
            "answers": views.groups(page.groups, page.told, page.note),
            "solid": "",
            "arms": "",
            "checks": views.check_list(found.checks),
            "figures": views.bench_panels(page.picture, width),
            "facts": [list(one) for one in page.strip],
            "asks": asks_of(asked.kind),
            "simulated": any(source.simulated for source in page.sources),
            "command": _line(asked),
        }
    )


def take_judged(request: Mapping[str, Any], folder: Path) -> bytes:
    """The result as its JSON, as the command prints it with ``--json``."""
    found, page = _found(_asked(request, folder))
    text = text_of(found) if hasattr(found, "document") else json.dumps(found)
    return wire.packed({"name": f"{page.name}.json", "kind": "application/json", "text": text})


def _line(asked: JudgedFiles) -> str:
    """The command that gives the same."""
    names = [Path(path).name for path in asked.files]
    if asked.kind == DOOR:
        return shlex.join(["dashpot", "predict", names[0]])
    words = ["dashpot", "fit", *(names[:1] if asked.kind in {"indentation", ROD} else names)]
    for one in ASKS.get(asked.kind, ()):
        texts = (
            [asked.of(f"{one.name} {i}") or one.choices[0] for i in range(len(names))]
            if one.each
            else asked.of(one.name).split() if one.name == "slam" else [asked.of(one.name)]
        )  # fmt: skip
        for text in texts:
            if text:
                words += [one.flag, _with_unit(one, text)]
    return shlex.join([*words])


def _with_unit(one: Ask, text: str) -> str:
    if one.name == "disc":
        return "disc:" + ",".join(f"{each.strip()}mm" for each in text.split(","))
    if one.name == "between":
        return text.replace(" to ", ":").replace("-", ":") + one.unit
    bare = one.unit if one.name != "density" else ""
    return text if not text[-1].isdigit() else f"{text}{bare}"
