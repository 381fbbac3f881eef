"""The page of a result that was judged: verdict, picture, numbers, checks and files."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from dashpot.base.documents import Documented
from dashpot.base.facts import Fact
from dashpot.base.offered import Judged
from dashpot.base.provenance import Source
from dashpot.plot.picture import Picture
from dashpot.report.figures import drawn
from dashpot.report.pages import COLOURS, frame, held
from dashpot.report.tables import TextTable, checks


def contents(found: Any) -> dict[str, Any]:
    """What the page of a result of a kind holds: all that its facts tell."""
    rows = tuple(_row(one) for one in found.facts)
    picture = found.plot()
    table = TextTable(("", "value", "± SE", "95 % interval", "unit"), rows)
    return {
        **judged(found, picture, table, found.sources, name=picture.name),
        "drawn_as": "Picture",
        "told_as": "Numbers",
        "beyond": "",
    }


def paged(found: object) -> bool:
    """Whether a result has all that its page holds."""
    return isinstance(found, Judged) and bool(found.facts) and hasattr(found, "sources")


def _row(one: Fact) -> tuple[str, ...]:
    cells = one.cells
    return one.symbol, cells.value, cells.error, cells.interval, cells.unit


def judged(
    found: Any, picture: Picture, numbers: TextTable, sources: Sequence[Source], *, name: str
) -> dict[str, Any]:
    """What every such page holds."""
    names = dict.fromkeys(one.file for one in sources)
    return {
        **frame(),
        "title": ", ".join(names) or name,
        "verdict": found.verdict,
        "colour": COLOURS[found.verdict.use],
        "figures": {picture.name: drawn(picture)},
        "numbers": numbers,
        "checks": checks([(name, found.checks)], found.checks),
        "sources": tuple(dict.fromkeys(sources)),
        "simulated": list(dict.fromkeys(one.file for one in sources if one.simulated)),
        "document": f"{name}.json",
        "link": held("application/json", document(found)),
    }


def document(found: Documented) -> str:
    """The JSON that ``dashpot fit --json`` prints."""
    return json.dumps(found.document, indent=2, ensure_ascii=False, allow_nan=False)
