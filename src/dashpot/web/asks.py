"""What a kind that stands alone is asked beside its files, as fields of the page."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from dashpot.kinds.hyperelastic.asked import MODES

DOOR, ROD = "door", "rod"


class Ask(NamedTuple):
    """A field of the page: what it is called, the unit typed without it, its option in a shell.

    `each` is asked of every file; with `choices` one of them is chosen.
    """

    name: str
    label: str
    unit: str
    flag: str
    choices: tuple[str, ...] = ()
    each: bool = False


_MASS = Ask("mass", "Moving mass", "g", "--mass")
ASKS: Mapping[str, tuple[Ask, ...]] = {
    "cld": (
        Ask("compression", "Compression", "mm", "--compression"),
        Ask("between", "Asked between", "mm", "--between"),
        Ask("length", "Length of a piece", "mm", "--length"),
    ),
    "stress-strain": (Ask("test", "Kind of test", "", "--test", tuple(MODES), each=True),),
    "indentation": (
        _MASS,
        Ask("radius", "Tip radius", "mm", "--radius"),
        Ask("drop_height", "Drop height", "mm", "--drop-height"),
    ),
    "slam": (_MASS, Ask("slam", "Speed or fall", "", "--slam")),
    ROD: (
        _MASS,
        Ask("density", "Density", "kg/m^3", "--density"),
        Ask("disc", "Diameter, length", "mm", "--shape"),
    ),
    DOOR: (),
}
"""What each kind is asked beside its files."""


def asks_of(kind: str) -> list[dict[str, Any]]:
    """Return the fields of a kind as the page draws them."""
    return [{**one._asdict(), "choices": [*one.choices]} for one in ASKS.get(kind, ())]


def door_row(path: Path) -> dict[str, Any]:
    """What the list of files says of a door."""
    return {"kind": DOOR, "page": "judged", "line": "a door on its seal", "mark": "good",
            "simulated": False, "long": False, "asks": [], "name": path.name}  # fmt: skip
