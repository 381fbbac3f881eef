"""Writes the page of what is assumed from its list: ``python docs/assumptions.py``."""

from __future__ import annotations

from pathlib import Path

from dashpot.workflow.assumptions import ASSUMPTIONS, Assumption

PAGE = Path(__file__).with_suffix(".md")
HEAD = """\
# What is assumed, and how to see when it is not

Every number that dashpot gives supposes what follows. Most of it a record can contradict: then the
{doc}`checks` named here fail, and say so. What no check is named for, or what a check could not
judge, rests on your word. An option, where there is one, makes the assumption unnecessary. This
page is written by `python docs/assumptions.py`; the report shows the same list with what the study
at hand says of each.
"""


def page() -> str:
    """Return the page: one section for each assumption."""
    return "".join((HEAD, *(_section(one) for one in ASSUMPTIONS)))


def _section(one: Assumption) -> str:
    lines = [f"\n## {one.name.capitalize()}\n", f"{one.holds}\n", f"**If not.** {one.otherwise}\n"]
    lines.append(f"**Watched by** {_listed(one.checks)}.\n")
    if one.options:
        lines.append(f"**Lifted by** {_listed(one.options)}.\n")
    lines.append(f"**On the bench.** {one.advice}\n")
    return "\n".join(lines)


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(f"`{name}`" for name in names)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
