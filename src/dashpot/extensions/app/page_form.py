"""The form of the page: what a job declares of its choices and of what is usual, laid into it."""

from __future__ import annotations

import json
from dataclasses import Field
from html import escape
from typing import Any

from dashpot.base.choices import AmplitudeLawAsked, get_choice_values
from dashpot.base.option_fields import is_path_field, iterate_option_fields
from dashpot.workflow.job import Job

LABELS = {
    "full": "recorded", "hold": "eq. (5)", "linear": "straight", "nonlinear": "bent",
    "maxwell": "arms",
}  # fmt: skip
"""What the page says of a word that a command is told."""


def fill_form(page: str) -> str:
    """Return the page with the choices of a job in their places, and what is usual as data."""
    for name in ("method", "law", "family"):
        one = _get_field(Job, name)
        page = page.replace(f"<!-- {name} -->", _buttons(one))
        page = page.replace(f"<!-- {name} says -->", escape(one.metadata["help"]))
    listed = "".join(f"<option>{word}</option>" for word in get_choice_values(AmplitudeLawAsked))
    page = page.replace("<!-- amplitude-law -->", listed)
    return page.replace("<!-- usual -->", json.dumps(get_job_defaults()))


def get_job_defaults() -> dict[str, Any]:
    """Return what a page says of a job of which nothing was said; its parts and files apart."""
    return {
        one.name: "" if one.default is None else one.default
        for one in iterate_option_fields(Job)
        if not is_path_field(one)
    }


def _get_field(noun: type, name: str) -> Field[Any]:
    return next(one for one in iterate_option_fields(noun) if one.name == name)


def _buttons(one: Field[Any]) -> str:
    return "".join(
        f'<button data-{one.name}="{word}" aria-pressed="{str(word == one.default).lower()}">'
        f"{LABELS.get(word, word)}</button>"
        for word in one.metadata["choices"]
    )
