"""Writes the page of what is assumed from its list: ``python docs/assumptions.py``."""

from __future__ import annotations

from pathlib import Path

from dashpot.workflow.assumptions import ASSUMPTIONS, Assumption

PAGE = Path(__file__).with_suffix(".md")
HEAD = """\
# Assumptions, and the checks that test them

Every result of dashpot depends on these assumptions. A record can contradict most of them: then the
{doc}`checks` named here fail. An assumption that no check could test is your responsibility. Some
options make an assumption unnecessary. The report has the same list, with the checks of its study.
`python docs/assumptions.py` writes this page.
"""


def page() -> str:
    """Return the page: one section for each assumption."""
    text = "".join((HEAD, *(_section(assumption) for assumption in ASSUMPTIONS)))
    return text.replace(" um/N", " µm/N").replace(" degC", " °C")


def _section(assumption: Assumption) -> str:
    lines = [
        f"\n## {assumption.name.capitalize()}\n",
        f"{assumption.holds}\n",
        f"**If not.** {assumption.otherwise}\n",
        f"**Tested by** {_format_list(assumption.checks)}.\n",
    ]
    if assumption.options:
        lines.append(f"**Not needed with** {_format_list(assumption.options)}.\n")
    lines.append(f"**On the bench.** {assumption.advice}\n")
    return "\n".join(lines)


def _format_list(names: tuple[str, ...]) -> str:
    return ", ".join(f"`{name}`" for name in names)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
