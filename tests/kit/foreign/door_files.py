"""Door files of a plate of 25 kg with a seal around it, as text; imports nothing of dashpot."""

from __future__ import annotations

_PLATE = """
[door]
mass = "25kg"
width = "1.1m"
height = "1.2m"
centre = "0.55, 0.6, 0 m"
"""
_LINE = """points = ["0, 0, 0 mm", "1100, 0, 0 mm", "1100, 1200, 0 mm", "0, 1200, 0 mm"]
closed = true
"""


def render_hinged_door(*, hinge: str, latch: str, pitch: str) -> str:
    """Return a door that moves across its plane, on two hinges, a latch and its seal."""
    hinges = "".join(
        f'[[hinge]]\nat = "0, {height}, 0 mm"\nstiffness = "{hinge}"\n' for height in (300, 900)
    )
    return (
        f'{_PLATE}motions = ["z", "rx", "ry"]\n{hinges}'
        f'[latch]\nat = "1.1, 0.6, 0 m"\nstiffness = "{latch}"\n'
        f'[seal]\nfit = "fit.json"\n{_LINE}pitch = "{pitch}"\n'
    )


def render_leaking_door(leak: str, *, compression: str, pitch: str) -> str:
    """Return a door with a pressed seal of 50 mm to a fit, and the lines of its ``[leak]``."""
    return (
        f'{_PLATE}[seal]\nfit = "fit.json"\nlength = "50mm"\n{_LINE}pitch = "{pitch}"\n'
        f'compression = "{compression}"\n[leak]\n{leak}'
    )
