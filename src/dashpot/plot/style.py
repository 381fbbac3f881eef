"""Colours, sizes and mark shapes of figures and pages.

Colours of data are those of Okabe and Ito (2008), which readers with any colour vision
distinguish. Green, orange and vermillion are kept for judgement: no curve of a valid measurement
has them. Every token has a value for a light and for a dark page.
"""

from __future__ import annotations

import re

COLOURS: dict[str, tuple[str, str]] = {
    "bg": ("#f4f6f8", "#101316"),
    "panel": ("#ffffff", "#171a1e"),
    "ink": ("#16191d", "#e8ebee"),
    "soft": ("#4a525b", "#a9b2bb"),
    "line": ("#d9dee3", "#2d343b"),
    "edge": ("#7d8791", "#6f7a85"),
    "act": ("#0b5c8f", "#6cb6e6"),
    "act-ink": ("#ffffff", "#0b1a24"),
    "act-soft": ("#e6f0f7", "#1b2c38"),
    "measured": ("#16191d", "#f1f3f5"),
    "fit": ("#0072b2", "#56b4e9"),
    "joint": ("#cc79a7", "#e58bbe"),
    "joint-ink": ("#a03a76", "#f0a8cf"),
    "ref": ("#7d858d", "#8b949e"),
    "away": ("#e9ecef", "#22272d"),
    "coldest": ("#16357f", "#9db8ff"),
    "cold": ("#2977b6", "#56b4e9"),
    "mild": ("#8468b0", "#b39ddb"),
    "warm": ("#b84a93", "#e58bbe"),
    "hottest": ("#7a1740", "#ff7ab0"),
    "good": ("#009e73", "#2bb98f"),
    "good-ink": ("#005f43", "#5fd6ad"),
    "good-bg": ("#e3f3ec", "#12302a"),
    "care": ("#e69f00", "#e69f00"),
    "care-ink": ("#6b4500", "#f3c14f"),
    "care-bg": ("#fdf1d3", "#33290f"),
    "bad": ("#d55e00", "#f07b45"),
    "bad-ink": ("#8f2f00", "#ff9a78"),
    "bad-bg": ("#fdeae3", "#3a1f16"),
}
"""Name: on light, on dark."""

SEQUENTIAL = ("coldest", "cold", "mild", "warm", "hottest")
"""Tokens of data in an order, temperatures or levels: blue to red, no colour of judgement."""


def sequential(count: int) -> tuple[str, ...]:
    """Tokens of so many classes in an order, as far apart as they can be; at most five differ."""
    last = len(SEQUENTIAL) - 1
    return tuple(SEQUENTIAL[round(i * last / max(count - 1, 1))] for i in range(count))


LIGHT = {name: light for name, (light, _) in COLOURS.items()}
"""Colours of printed figures and figure files."""

SANS = '-apple-system, "Segoe UI", Roboto, Arial, "Liberation Sans", system-ui, sans-serif'
SMALL_TEXT, BOLD_TEXT = 12.0, 13.0
"""Sizes of the letters in a figure, px: nothing is smaller."""


def css() -> str:
    """The tokens as custom properties of a page: light, dark where the reader asks, light in print.

    >>> css().startswith(":root{color-scheme:light dark;--bg:#f4f6f8;")
    True
    """
    light, dark = (
        "".join(f"--{name}:{pair[i]};" for name, pair in COLOURS.items()) for i in (0, 1)
    )
    return (
        f":root{{color-scheme:light dark;{light}}}\n"
        f"@media screen and (prefers-color-scheme:dark){{:root{{{dark}}}}}\n"
        "@media print{:root{color-scheme:light}}"
    )


def on_paper(text: str) -> str:
    """Text with every ``var(--token)`` as its light colour: a file knows no page."""
    return re.sub(r"var\(--([a-z-]+)\)", lambda match: LIGHT[match[1]], text)
