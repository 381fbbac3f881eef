"""Figures of the fitted solid: its relaxation spectrum, its stiffness against frequency."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.plot.dynamic_stiffness import averaged, quantities
from dashpot.plot.panels import frequency as panel
from dashpot.plot.panels import stems as spectrum_panel
from dashpot.plot.style import (
    BLUE,
    CHOSEN,
    COLUMN,
    GREY,
    JOINT,
    MEASURED,
    PAGE,
    PURPLE,
    SMALL,
    dress,
    figure,
    legend_above,
    log_axis,
)
from dashpot.records.bounds import StiffnessBounds
from dashpot.records.fit import Fit
from dashpot.vibration.modal.dynamic_stiffness import DynamicStiffness

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FREQUENCY = "frequency, Hz"


def spectrum(fit: Fit, *, joint: Fit | None = None) -> Figure:
    """Relaxation spectrum: one stem per arm, 95 % intervals, the identified window shaded.

    The dashed line is the equilibrium stiffness. A relaxation time outside the window is one
    that the test could not have told from its neighbours.
    """
    made = figure(COLUMN, 72)
    ax = made.subplots()
    words = _words(fit)
    low, high = (1 / (2 * np.pi * f) for f in reversed(fit.band))
    spectrum_panel.window(ax, low, high, label=words.seen)
    named = f", with 95 % intervals of {words.plateau[0]} and τ"
    label = words.fit + named if fit.parameters else words.fit
    _stems(ax, fit, CHOSEN.color, label, width=3.2)
    if joint is not None:
        _stems(ax, joint, JOINT.color, "joint fit", width=1.1)
    k_inf = words.scale * fit.model.k_inf
    ax.axhline(k_inf, color=CHOSEN.color, linewidth=0.9, linestyle=(0, (4, 2)))
    shown = [*fit.model.tau, *(joint.model.tau if joint else ())]
    ax.set_xlim(min([low, *shown]) / 4, max([high, *shown]) * 4)
    ax.set_ylim(0, 1.12 * ax.get_ylim()[1])
    log_axis(ax, "x")
    dress(ax, x="relaxation time τ, s", y=words.arm)
    ax.annotate(
        words.plateau, (0.02, k_inf), xycoords=("axes fraction", "data"), xytext=(0, 1.5),
        textcoords="offset points", fontsize=SMALL, color=CHOSEN.color, va="bottom",
    )  # fmt: skip
    legend_above(made, ax, columns=1)
    return made


def stiffness(
    fit: Fit,
    *,
    parameters: StiffnessBounds | None = None,
    unseen: StiffnessBounds | None = None,
    joint: Fit | None = None,
    measured: DynamicStiffness | None = None,
    mark: float | None = None,
) -> Figure:
    """Storage, loss and loss factor against frequency: stiffness of one seal, or a modulus.

    Solid where the relaxation test informs the model, dashed where it is extrapolated.

    Parameters
    ----------
    fit : Fit
    parameters, unseen : StiffnessBand, optional
        What the standard errors allow; what any spectrum allows that the test cannot reject.
    joint : Fit, optional
        The fit to relaxation and FRF together.
    measured : DynamicStiffness, optional
        Stiffness of one seal straight from the FRF, drawn as points where it is good.
    mark : float, optional
        A frequency to point at, such as the measured resonance, Hz.
    """
    made = figure(PAGE, 78)
    axes = made.subplots(1, 3)
    f = _frequencies(fit, measured, unseen, mark)
    words = _words(fit)
    names = ("storage", "loss", "loss_factor")
    for ax, name, label in zip(axes, names, words.axes, strict=True):
        factor = 1.0 if name == "loss_factor" else words.scale
        panel.identified(ax, fit.band, label=words.seen)
        if unseen is not None:
            panel.limits(ax, unseen.frequency, factor * getattr(unseen, name), PURPLE,
                         label="room for arms it cannot see", alpha=0.25)  # fmt: skip
        if parameters is not None:
            panel.limits(ax, parameters.frequency, factor * getattr(parameters, name),
                         BLUE, label="standard errors (95 %)", alpha=0.35)  # fmt: skip
        curve = factor * getattr(fit.model, name)(2 * np.pi * f)
        panel.known_and_extrapolated(ax, f, curve, CHOSEN, known=fit.band, label=words.fit)
        if joint is not None:
            ax.plot(f, factor * getattr(joint.model, name)(2 * np.pi * f), color=JOINT.color,
                    linestyle=JOINT.dashes, linewidth=JOINT.width, label="joint fit")  # fmt: skip
        if measured is not None:
            _points(ax, measured, name)
        if mark is not None:
            ax.axvline(mark, color=GREY, linewidth=0.8, linestyle=(0, (1, 1.5)),
                       label=f"resonance, {mark:.4g} Hz")  # fmt: skip
        ax.set_xlim(f[0], f[-1])
        if name != "storage" and curve.max() > 0:  # a spring has no loss to put on a log axis
            _from_smallest(ax, curve)
            log_axis(ax, "y")
        log_axis(ax, "x")
        dress(ax, x=FREQUENCY, y=label)
    legend_above(made, axes[0], columns=4)
    return made


class _Words(NamedTuple):
    """What a fit is called on an axis, and the factor from SI to the unit said there."""

    scale: float
    arm: str
    plateau: str
    axes: tuple[str, str, str]
    seen: str
    fit: str


def _words(fit: Fit) -> _Words:
    of_force = fit.method in {"full", "hold"}
    seen = "seen by the relaxation test" if of_force else "seen by the test"
    name = "relaxation fit" if of_force else "fit"
    if fit.unit == "Pa":
        axes = ("storage modulus E′, MPa", "loss modulus E″, MPa", "loss factor E″/E′, –")
        return _Words(1e-6, "modulus E, MPa", "E∞", axes, seen, name)
    axes = ("storage stiffness K′, N/mm", "loss stiffness K″, N/mm", "loss factor K″/K′, –")
    return _Words(1e-3, "stiffness k, N/mm", "k∞", axes, seen, name)


def _stems(ax: Axes, one: Fit, color: str, label: str, *, width: float) -> None:
    # a dense spectrum has no intervals to draw
    bounds = one.intervals(level=0.95) if one.parameters else {"tau": (), "k": ()}
    scale = _words(one).scale
    low, high = (1 / (2 * np.pi * f) for f in reversed(one.band))
    spectrum_panel.stems(
        ax,
        one.model.tau,
        tuple(scale * k for k in one.model.k),
        color,
        # an open end is drawn to the edge of what could matter
        tau_range=tuple((max(a, low / 10), min(b, high * 10)) for a, b in bounds["tau"]),
        k_range=tuple((scale * a, scale * min(b, one.model.k_0)) for a, b in bounds["k"]),
        label=label,
        width=width,
    )


def _frequencies(
    fit: Fit, measured: DynamicStiffness | None, unseen: StiffnessBounds | None, mark: float | None
) -> FloatArray:
    low, high = fit.band[0] / 3, max(fit.band[1] * 30, 30.0)
    if mark is not None:
        high = max(high, 3 * mark)
    if unseen is not None:
        high = max(high, float(unseen.frequency[-1]))
    if measured is not None:
        high = max(high, float(measured.frequency[-1]))
    return np.geomspace(low, high, 400)


def _points(ax: Axes, measured: DynamicStiffness, name: str) -> None:
    """What the FRF says in thirds of an octave, where that is good, with one standard deviation."""
    lines = dict(zip(("storage", "damping", "loss_factor"), quantities(measured), strict=True))
    f, one = averaged(
        measured.frequency, lines["damping" if name == "loss" else name], per_octave=3
    )
    good = (f >= one.good[0]) & (f <= one.good[1])
    factor = 2e-3 * np.pi * f if name == "loss" else np.ones(len(f))
    ax.errorbar(
        f[good],
        (factor * one.value)[good],
        yerr=(factor * one.nested[0])[good],
        fmt=".",
        markersize=3,
        elinewidth=0.5,
        color=MEASURED.color,
        label="straight from the FRF",
        zorder=4,
    )


def _from_smallest(ax: Axes, curve: FloatArray) -> None:
    """Keep a log axis from diving after a lower limit that touches zero."""
    top = ax.get_ylim()[1]
    ax.set_ylim(0.5 * float(np.min(curve)), max(top, 2 * float(np.max(curve))))
