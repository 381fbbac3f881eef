"""What every page of dashpot shares: its templates' environment, filters, marks and policy."""

from __future__ import annotations

import base64
import hashlib
from functools import cache
from importlib import resources
from typing import TYPE_CHECKING, Any

from dashpot.base import number_format
from dashpot.base.checks import Use
from dashpot.base.sentences import sentence
from dashpot.base.version import byline, software
from dashpot.plot import style as tokens

if TYPE_CHECKING:
    from jinja2 import Environment

COLOURS: dict[Use, str] = {"use": "good", "use with care": "care", "do not use": "bad"}
"""The style of each verdict; its words stand beside the colour."""


@cache
def environment(package: str) -> Environment:
    """The templates of a package, and those that pages share; whatever fills them is escaped."""
    from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

    result = Environment(
        loader=ChoiceLoader([PackageLoader(package), PackageLoader("dashpot.report")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    result.filters.update(
        words=number_format.split_identifier,
        sentence=sentence,
        readable=number_format.format_typographic,
        shorter=number_format.shorter,
        rounded=number_format.round_to_error,
        hertz=number_format.hertz,
    )
    return result


@cache
def _part(package: str, *path: str) -> str:
    """A part of a page that is no HTML, as it stands in its file."""
    return resources.files(package).joinpath(*path).read_text("utf-8").strip()


def frame() -> dict[str, Any]:
    """What every page of the report's look has: style, script, policy, what computed it."""
    style = f"{tokens.css()}\n{_part('dashpot.report', 'templates', 'report.css')}"
    name = _part("dashpot.report", "templates", "report.js")
    # the one page holds the modules one after the other, so the second imports nothing
    script = f"{_part('dashpot.plot', 'charts.js')}\n{name.partition(chr(10))[2]}"
    return {
        "byline": byline("report"),
        "style": style,
        "script": script,
        "policy": f"default-src 'none'; img-src data:; style-src {digest(style)}; "
        f"script-src {digest(script)}; base-uri 'none'; form-action 'none'",
        "versions": software().items(),
    }


def encode_data_uri(kind: str, text: str) -> str:
    """A link that holds the file itself."""
    return f"data:{kind};base64,{base64.b64encode(text.encode()).decode()}"


def digest(text: str) -> str:
    """What a content security policy calls the one script or style that may stand in a page."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
