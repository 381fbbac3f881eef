"""A relaxation spectrum as stems."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dashpot.plot.style import SKY

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def stems(
    ax: Axes,
    tau: tuple[float, ...],
    k: tuple[float, ...],
    color: str,
    *,
    tau_range: tuple[tuple[float, float], ...] = (),
    k_range: tuple[tuple[float, float], ...] = (),
    label: str = "",
    width: float = 1.8,
) -> None:
    """One stem per arm, with the intervals of its stiffness and of its relaxation time."""
    ax.vlines(tau, 0.0, k, color=color, linewidth=width, label=label)
    ax.plot(tau, k, "o", color=color, markersize=2 + width)
    for place, (low, high) in zip(tau, k_range, strict=False):
        ax.plot([place, place], [low, high], color=color, linewidth=3.5, alpha=0.35)
    for height, (low, high) in zip(k, tau_range, strict=False):
        ax.plot([low, high], [height, height], color=color, linewidth=3.5, alpha=0.35)


def window(ax: Axes, low: float, high: float, *, label: str) -> None:
    """Shade the relaxation times that the test can inform."""
    ax.axvspan(low, high, color=SKY, alpha=0.2, linewidth=0, zorder=0, label=label)
