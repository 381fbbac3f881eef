"""What every page of dashpot shares: its templates' environment, filters, marks and policy."""

from __future__ import annotations

import base64
import hashlib
from functools import cache
from typing import TYPE_CHECKING

from dashpot.base import numbers
from dashpot.base.checks import Use

if TYPE_CHECKING:
    from jinja2 import Environment

COLOURS: dict[Use, str] = {"use": "good", "use with care": "care", "do not use": "bad"}
"""The style of each verdict; its words stand beside the colour."""


@cache
def environment(package: str) -> Environment:
    """The templates of a package, and those that pages share; whatever fills them is escaped."""
    from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

    found = Environment(
        loader=ChoiceLoader([PackageLoader(package), PackageLoader("dashpot.report")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    found.filters.update(
        words=numbers.words,
        sentence=lambda text: text[:1].upper() + text[1:] + ("" if text.endswith(".") else "."),
        readable=numbers.readable,
        shorter=numbers.shorter,
        rounded=numbers.rounded,
        hertz=numbers.hertz,
    )
    return found


def digest(text: str) -> str:
    """What a content security policy calls the one script or style that may stand in a page."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
