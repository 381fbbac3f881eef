"""A door on its seal, dropped on the page with the files that it names."""

from __future__ import annotations

import shutil
import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from dashpot import workflow
from dashpot.base.errors import ReadError
from dashpot.base.numbers import rounded
from dashpot.door.result import DoorResult
from dashpot.records.fit import Fit
from dashpot.report.answer import Row
from dashpot.report.kind_page import Group, KindPage, lights
from dashpot.web import results
from dashpot.workflow.archive import to_json
from dashpot.workflow.job import Job

DOOR = "door"


def row(path: Path) -> dict[str, Any]:
    """What the list of files says of a door."""
    return {"kind": DOOR, "page": "judged", "line": "a door on its seal", "mark": "good",
            "simulated": False, "long": False, "asks": [], "alone": False,
            "name": path.name}  # fmt: skip


def page(found: DoorResult) -> KindPage:
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


def predicted(files: Sequence[str], behind: str = "") -> DoorResult:
    """A door with the files that are open beside it: it names them, and none elsewhere.

    Parameters
    ----------
    files : sequence of path
        The door's own first.
    behind : path, optional
        The open relaxation test whose fit the door may name.
    """
    path = Path(files[0])
    names = {Path(one).name: Path(one) for one in files[1:]}
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
    if isinstance(wanted, str) and wanted not in names and behind:
        # the door names the fit of a test that is open
        job = Job(behind)
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
