"""Door on its seal in the app, predicted with the open files."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from dashpot.base.errors import ReadError
from dashpot.base.number_format import hertz, round_to_error
from dashpot.datamodel.fit import Fit
from dashpot.extensions.systems.door.analyse_file import door_file
from dashpot.extensions.systems.door.figure import (
    View,
    make_frf_panel,
    make_line_panel,
    make_shape_panels,
)
from dashpot.extensions.systems.door.page import (
    format_door_summary,
    make_door_indicators,
    make_mode_table,
)
from dashpot.extensions.systems.door.result import DoorResult
from dashpot.plot.picture import Picture
from dashpot.reading.toml import parsed_toml
from dashpot.report.first_screen import Row
from dashpot.report.page_frame import environment
from dashpot.report.result_page import AppCard, Group, KindPage
from dashpot.workflow.json_archive import to_json

_HEIGHT = 300.0
"""Height of a response without a seal line, px."""


def describe_file(path: Path) -> dict[str, Any]:
    """Return the entry of a door in the list of files."""
    return {"kind": "door", "page": "standalone", "line": "a door on its seal", "mark": "good",
            "simulated": False, "long": False, "form_fields": [], "takes_one_file": False,
            "name": path.name}  # fmt: skip


def page(result: DoorResult) -> KindPage:
    """Return the contents of the page of a door, in the format of the other kinds."""
    rows = tuple(
        Row(
            f"Mode {i}",
            round_to_error(mode.mode.frequency, digits=4),
            "",
            "",
            "Hz",
            "",
            is_limit=False,
        )
        for i, mode in enumerate(result.modes[:8], 1)
    )
    return KindPage(
        subject=format_door_summary(result),
        summary_line=(("Door", format_door_summary(result)), ("Band", hertz(result.band))),
        indicators=tuple(make_door_indicators(result, None, result.checks, result.verdict)),
        figure_title="A door",
        picture=result.plot(),
        table_title="Modes",
        groups=(Group("", rows),),
        sources=tuple(dict.fromkeys(result.sources)),
        note="",
        name="door",
    )


def list_cards(result: DoorResult) -> list[AppCard]:
    """Return the seal line and the response, the modes with their shares, and their shapes."""
    view = View.from_result(result)
    panels = [] if view is None else [make_line_panel(result, view)]
    if result.frfs:
        panels.append(make_frf_panel(result, 0, height=panels[0].height if panels else _HEIGHT))
    cards: list[AppCard] = []
    if panels:
        picture = Picture("door", "", tuple((panel,) for panel in panels), len(panels))
        cards.append(AppCard("", picture))
    if result.modes:
        table = environment("dashpot.extensions.systems.door").get_template("modes_table.html")
        html = table.render(modes=make_mode_table(result))
        cards.append(AppCard("Modes: who holds, who loses", html))
    shapes = [] if view is None else make_shape_panels(result, view)
    if shapes:
        cards.append(AppCard("Shapes, from outside", tuple(shapes)))
    return cards


def predict_open_files(
    files: Sequence[str], folder: Path, fit_test: Callable[[], Fit] | None = None
) -> DoorResult:
    """Predict a door with the files that it names, which must be open.

    Parameters
    ----------
    files : sequence of path
        The door's own first.
    folder : path
        Folder into which they are copied; its old contents are removed.
    fit_test : callable, optional
        Fits the open relaxation test, whose fit the door may name.
    """
    path = Path(files[0])
    names = {Path(file).name: Path(file) for file in files[1:]}
    try:
        toml = parsed_toml(path.read_bytes())
    except ReadError as error:
        raise ReadError(f"{path.name}: {error}") from None
    for text in _list_texts(toml):
        if Path(text).is_absolute() or ".." in Path(text).parts or text[1:3] == ":\\":
            raise ReadError(
                f"{path.name} names a file elsewhere ({text}). Name it alone, and open it here"
            )
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    shutil.copy(path, folder / path.name)
    for name, item in names.items():
        shutil.copy(item, folder / name)
    fit_name = toml.get("seal", {}).get("fit") if isinstance(toml.get("seal"), dict) else None
    if isinstance(fit_name, str) and fit_name not in names and fit_test is not None:
        # the door names the fit of a test that is open
        (folder / fit_name).write_text(to_json(fit_test()), encoding="utf-8")
    return door_file(folder / path.name)


def _list_texts(text: Any) -> Iterator[str]:
    """Every text in a document."""
    if isinstance(text, str):
        yield text
    elif isinstance(text, dict | list):
        for item in text.values() if isinstance(text, dict) else text:
            yield from _list_texts(item)
