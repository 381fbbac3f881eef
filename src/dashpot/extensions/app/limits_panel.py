"""Acceptance limits entered on a page, compared with a result."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from dashpot.base import dataclass
from dashpot.base.errors import DashpotError, DataError
from dashpot.extensions.app.request_parsing import get_list, require_mapping
from dashpot.extensions.app.upload_store import find_file
from dashpot.registry import require_handler
from dashpot.report.result_page import format_json


@dataclass(frozen=True)
class LimitsPanel:
    """Limits of a page.

    Attributes
    ----------
    html : str
        Section with the outcome of each limit; empty without limits, or if one is refused.
    refusal : str
        Why one is no limit of this result.
    words : tuple of str
        Equivalent options of the command line.
    document : Serialisable or None
        The result with the outcome of its limits.
    """

    html: str = ""
    refusal: str = ""
    words: tuple[str, ...] = ()
    document: Any = None

    def add_to(self, command: str) -> dict[str, Any]:
        """Return the entries of an answer: the limits, and the equivalent command."""
        return {
            "limits": {"html": self.html, "refusal": self.refusal},
            "command": " ".join([command, shlex.join(self.words)]).rstrip(),
        }

    def render_document(self, text: str) -> str:
        """Return the JSON of the result with its limits; without limits the `text` of it alone."""
        return text if self.document is None else format_json(self.document)


def judge_limits(request: Mapping[str, Any], folder: Path, result: Any) -> LimitsPanel:
    """Return the limits of a request compared with a result; an invalid one is a message.

    A limit that cannot be judged does not count against the result.
    """
    requested_limits = require_mapping(request.get("limits", {}), "limits")
    expressions = [text.strip() for text in map(_read_text, get_list(requested_limits, "typed"))]
    files = [find_file(folder, item) for item in get_list(requested_limits, "files")]
    expressions = [text for text in expressions if text]
    if not expressions and not files:
        return LimitsPanel()
    try:
        html, words, document = require_handler("judge limits", "app")(result, expressions, files)
    except DashpotError as error:
        return LimitsPanel(refusal=str(error))
    return LimitsPanel(html, "", words, document)


def _read_text(item: object) -> str:
    if not isinstance(item, str):
        raise DataError(f"limits: {item!r}; expected a text such as 'damping >= 3%'")
    return item
