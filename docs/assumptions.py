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
    return "".join((HEAD, *(_section(one) for one in ASSUMPTIONS)))


def _section(one: Assumption) -> str:
    lines = [f"\n## {one.name.capitalize()}\n", f"{one.holds}\n", f"**If not.** {one.otherwise}\n"]
    lines.append(f"**Tested by** {_listed(one.checks)}.\n")
    if one.options:
        lines.append(f"**Not needed with** {_listed(one.options)}.\n")
    lines.append(f"**On the bench.** {one.advice}\n")
    return "\n".join(lines)


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(f"`{name}`" for name in names)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
