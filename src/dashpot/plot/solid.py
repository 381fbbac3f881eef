"""Figures of the solid: its relaxation spectrum, its stiffness fitted and straight from an FRF."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray
from dashpot.base.errors import DataError
from dashpot.plot import panels as panel
from dashpot.plot.style import (
    BLUE,
    CHOSEN,
    COLUMN,
    GREEN,
    GREY,
    JOINT,
    MEASURED,
    ORANGE,
    PAGE,
    PURPLE,
    SMALL,
    Pen,
    dress,
    figure,
    legend_above,
)
from dashpot.records.bounds import StiffnessBounds
from dashpot.records.fit import Fit
from dashpot.solids.maxwell import Solid
from dashpot.vibration.modal.dynamic_stiffness import DynamicStiffness

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FREQUENCY = "frequency, Hz"
DASHED = Pen(GREY, (0, (4, 2)), 0.9)
LABELS = {
    "storage": "storage stiffness K′, N/mm",
    "damping": "damping c, N·s/m",
    "loss_factor": "loss factor K″/K′, –",
}


def spectrum(fit: Fit, *, joint: Fit | None = None) -> Figure:
    """Relaxation spectrum: one stem per arm, 95 % intervals, the identified window shaded.

    The dashed line is the equilibrium stiffness. A relaxation time outside the window is one
    that the test could not have told from its neighbours.
    """
    made = figure(COLUMN, 72)
    ax = made.subplots()
    words = _words(fit)
    low, high = (1 / (2 * np.pi * f) for f in reversed(fit.band))
    panel.shade(ax, low, high, label=words.band)
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
    dress(ax, x="relaxation time τ, s", y=words.arm, log="x")
    ax.annotate(
        words.plateau, (0.02, k_inf), xycoords=("axes fraction", "data"), xytext=(0, 1.5),
        textcoords="offset points", fontsize=SMALL, color=CHOSEN.color, va="bottom",
    )  # fmt: skip
    legend_above(made, ax, columns=1)
    return made


def elastic_law(fit: Fit, *, compression: float | None = None) -> Figure:
    """Relaxed force and tangent stiffness against compression, the tangent with two errors.

    The dashed lines are the secant of the fit, which a straight law would follow. `compression`,
    m, is where a mass rests.

    Raises
    ------
    DataError
        If the fit has no elastic law.
    """
    law = fit.elastic_law
    if law is None:
        raise DataError("the fit has no elastic law: it is not of a relaxation test")
    made = figure(PAGE, 62)
    x = np.linspace(0.0, law.depth, 201)
    knots, at = np.asarray(law.knots), 1e3 * x
    left, right = made.subplots(1, 2)
    panel.line(left, at, law.force(x), CHOSEN, "elastic law, relaxed")
    panel.line(left, at, law.stiffness * x, DASHED, f"secant at {1e3 * law.depth:.3g} mm")
    error = 2e-3 * law.stiffness * law.factor_se(x)
    tangent = 1e-3 * law.tangent(x)
    limits = np.array([tangent - error, tangent + error])
    panel.limits(right, at, limits, BLUE, label="± 2 standard errors", alpha=0.3)
    panel.line(right, at, tangent, CHOSEN, "tangent")
    panel.line(right, at, np.full(len(x), 1e-3 * law.stiffness), DASHED, "secant")
    right.plot(1e3 * knots, 1e-3 * law.tangent(knots), "o", color=CHOSEN.color, markersize=2.5)
    for ax in (left, right):
        if compression is not None:
            ax.axvline(1e3 * compression, color=GREY, linewidth=0.8, linestyle=(0, (1, 1.5)),
                       label=f"the mass rests at {1e3 * compression:.3g} mm")  # fmt: skip
        ax.set_xlim(0, at[-1])
        ax.set_ylim(0, None)
    dress(left, x="compression, mm", y="relaxed force, N")
    dress(right, x="compression, mm", y="stiffness k∞, N/mm")
    legend_above(made, right, columns=4)
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
    limits = (
        (unseen, PURPLE, "bound over unresolved arms", 0.25),
        (parameters, BLUE, "standard errors (95 %)", 0.35),
    )
    for ax, name, label in zip(axes, ("storage", "loss", "loss_factor"), words.axes, strict=True):
        factor = 1.0 if name == "loss_factor" else words.scale
        panel.shade(ax, *fit.band, label=words.band)
        for bounds, color, what, alpha in limits:
            if bounds is not None:
                between = factor * getattr(bounds, name)
                panel.limits(ax, bounds.frequency, between, color, label=what, alpha=alpha)
        curve = factor * getattr(fit.solid, name)(2 * np.pi * f)
        panel.known_and_extrapolated(ax, f, curve, CHOSEN, known=fit.band, label=words.fit)
        if joint is not None:
            panel.line(
                ax, f, factor * getattr(joint.solid, name)(2 * np.pi * f), JOINT, "joint fit"
            )
        if measured is not None:
            _points(ax, measured, name)
        if mark is not None:
            ax.axvline(mark, color=GREY, linewidth=0.8, linestyle=(0, (1, 1.5)),
                       label=f"resonance, {mark:.4g} Hz")  # fmt: skip
        ax.set_xlim(f[0], f[-1])
        dress(ax, x=FREQUENCY, y=label, log=_scales(ax, name, curve))
    legend_above(made, axes[0], columns=4)
    return made


def _scales(ax: Axes, name: str, curve: FloatArray) -> Literal["x", "xy"]:
    """Which axes are logarithmic: that of a loss too, unless it is a spring's, which has none."""
    if name == "storage" or not curve.max() > 0:
        return "x"
    # a lower limit that touches zero must not make the axis dive after it
    top = max(ax.get_ylim()[1], 2 * float(np.max(curve)))
    ax.set_ylim(0.5 * float(np.min(curve)), top)
    return "xy"


class _Words(NamedTuple):
    """What a fit is called on an axis, and the factor from SI to the unit said there."""

    scale: float
    arm: str
    plateau: str
    axes: tuple[str, str, str]
    band: str
    fit: str


def _words(fit: Fit) -> _Words:
    of_force = fit.method in {"full", "hold"}
    band = "band of the relaxation test" if of_force else "band of the test"
    name = "relaxation fit" if of_force else "fit"
    if fit.unit == "Pa":
        axes = ("storage modulus E′, MPa", "loss modulus E″, MPa", "loss factor E″/E′, –")
        return _Words(1e-6, "modulus E, MPa", "E∞", axes, band, name)
    axes = (LABELS["storage"], "loss stiffness K″, N/mm", LABELS["loss_factor"])
    return _Words(1e-3, "stiffness k, N/mm", "k∞", axes, band, name)


def _stems(ax: Axes, one: Fit, color: str, label: str, *, width: float) -> None:
    """One stem per arm, with the intervals of its stiffness and of its relaxation time."""
    scale, tau, k_0 = _words(one).scale, one.model.tau, one.model.k_0
    k = [scale * value for value in one.model.k]
    ax.vlines(tau, 0.0, k, color=color, linewidth=width, label=label)
    ax.plot(tau, k, "o", color=color, markersize=2 + width)
    if not one.parameters:
        return  # a dense spectrum has no intervals to draw
    bounds = one.intervals(level=0.95)
    window = [1 / (2 * np.pi * f) for f in reversed(one.band)]
    # an open end is drawn to the edge of what could matter
    ends = [
        ((t, t), (scale * a, scale * min(b, k_0)))
        for t, (a, b) in zip(tau, bounds["k"], strict=True)
    ]
    ends += [
        ((max(a, window[0] / 10), min(b, window[1] * 10)), (height, height))
        for height, (a, b) in zip(k, bounds["tau"], strict=True)
    ]
    for x, y in ends:
        ax.plot(x, y, color=color, linewidth=3.5, alpha=0.35)


def _frequencies(
    fit: Fit, measured: DynamicStiffness | None, unseen: StiffnessBounds | None, mark: float | None
) -> FloatArray:
    tops = [fit.band[1] * 30, 30.0]
    if mark is not None:
        tops.append(3 * mark)
    tops += [float(one.frequency[-1]) for one in (unseen, measured) if one is not None]
    return np.geomspace(fit.band[0] / 3, max(tops), 400)


def _points(ax: Axes, measured: DynamicStiffness, name: str) -> None:
    """What the FRF says in thirds of an octave, where that is good, with one standard deviation."""
    lines = {one.name: one for one in quantities(measured)}
    line = lines["damping" if name == "loss" else name]
    f, one = averaged(measured.frequency, line, per_octave=3)
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


# -- straight from an FRF -------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Quantity:
    """One panel: what it shows, in the unit that is read, and the three errors of it."""

    name: str
    value: FloatArray
    random: FloatArray
    phase: FloatArray
    mass: FloatArray
    good: tuple[float, float]

    @property
    def nested(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """All errors together, those of phase and scatter, and scatter alone."""
        inner = np.hypot(self.random, self.phase)
        return np.hypot(inner, self.mass), inner, self.random

    def of(self, solid: Solid, f: FloatArray) -> FloatArray:
        """The same quantity as a solid has it, at `f`, Hz."""
        omega = 2 * np.pi * f
        if self.name == "storage":
            return 1e-3 * solid.storage(omega)
        return solid.loss(omega) / omega if self.name == "damping" else solid.loss_factor(omega)


def dynamic_stiffness(
    measured: DynamicStiffness, *, fit: Fit | None = None, joint: Fit | None = None
) -> Figure:
    """Stiffness, damping and loss factor of one seal, line by line, with their errors.

    Shaded about the points, one standard deviation each: the scatter of the FRF, with it the
    phase error between the channels, and with both the error of the mass. The blue background is
    where all of them together leave a usable value.

    Parameters
    ----------
    measured : DynamicStiffness
    fit, joint : Fit, optional
        Solids of one seal to hold against it.
    """
    made = figure(PAGE, 82)
    axes = made.subplots(1, 3)
    errors = (
        (ORANGE, f"and {100 * measured.mass_sd / measured.mass:.2g} % of mass"),
        (GREEN, f"and {np.degrees(measured.phase_sd):.2g}° of phase"),
        ("#8f8f8f", "error (1 SD): scatter"),
    )
    span = _span(measured)
    dense = np.geomspace(*span, 200)
    for ax, line in zip(axes, quantities(measured), strict=True):
        if np.isfinite(line.good).all():
            panel.shade(ax, *line.good, label="usable: K′ to 10 %, c to 30 %")
        f, one = averaged(measured.frequency, line)
        for error, (color, label) in zip(one.nested, errors, strict=True):
            between = np.array([one.value - error, one.value + error])
            panel.limits(ax, f, between, color, label=label, alpha=0.4)
        low, high = extent(measured.frequency, line.value)
        ax.vlines(f, low, high, color=GREY, linewidth=0.7, label="range of the lines")
        ax.plot(f, one.value, ".", color=MEASURED.color, markersize=3, label="from the FRF")
        for found, pen, who in ((fit, CHOSEN, "relaxation fit"), (joint, JOINT, "joint fit")):
            if found is not None:
                panel.line(ax, dense, line.of(found.solid, dense), pen, who)
        ax.set_xlim(*span)
        ax.set_ylim(*_view(one, f))
        dress(ax, x=FREQUENCY, y=LABELS[line.name], log="x")
    legend_above(made, axes[0], columns=4)
    return made


def quantities(measured: DynamicStiffness) -> tuple[Quantity, Quantity, Quantity]:
    """Storage stiffness, damping and loss factor with their errors."""
    m, omega = measured, 2 * np.pi * measured.frequency
    none = np.zeros(len(omega))

    def of_factor(loss: FloatArray, storage: FloatArray) -> FloatArray:
        return np.asarray(np.abs(m.loss_factor) * np.hypot(loss / m.loss, storage / m.storage))

    return (
        Quantity("storage", 1e-3 * m.storage, 1e-3 * m.storage_random, 1e-3 * m.storage_phase,
                 1e-3 * m.storage_mass, m.storage_band),
        Quantity("damping", m.damping, m.loss_random / omega, m.loss_phase / omega, none,
                 m.loss_band),
        Quantity("loss_factor", m.loss_factor, of_factor(m.loss_random, m.storage_random),
                 of_factor(m.loss_phase, m.storage_phase), of_factor(none, m.storage_mass),
                 m.loss_band),
    )  # fmt: skip


def averaged(f: FloatArray, line: Quantity, *, per_octave: int = 12) -> tuple[FloatArray, Quantity]:
    """The mean over every part of an octave, lines weighted by their scatter.

    Scatter shrinks with the number of lines; the errors of phase and mass, alike in all, stay.
    """
    starts = _bins(f, per_octave)
    weight = 1 / line.random**2 if (line.random > 0).all() else np.ones(len(f))
    total = np.add.reduceat(weight, starts)

    def mean(values: FloatArray) -> FloatArray:
        return np.asarray(np.add.reduceat(weight * values, starts) / total)

    scatter = np.sqrt(np.add.reduceat((weight * line.random) ** 2, starts)) / total
    return mean(f), Quantity(
        line.name, mean(line.value), scatter, mean(line.phase), mean(line.mass), line.good
    )


def extent(
    f: FloatArray, value: FloatArray, *, per_octave: int = 12
) -> tuple[FloatArray, FloatArray]:
    """The lowest and the highest line in every part of an octave."""
    starts = _bins(f, per_octave)
    return np.minimum.reduceat(value, starts), np.maximum.reduceat(value, starts)


def _bins(f: FloatArray, per_octave: int) -> IndexArray:
    """Where every part of an octave begins, empty ones left out."""
    number = np.floor(per_octave * np.log2(f / f[0]))
    return np.flatnonzero(np.concatenate(([True], np.diff(number) > 0)))


def _span(measured: DynamicStiffness) -> tuple[float, float]:
    """The usable band and a little more; all lines if none is usable."""
    f = measured.frequency
    low, high = measured.storage_band
    if not np.isfinite(low):
        return float(f[0]), float(f[-1])
    return max(low / 1.3, float(f[0])), min(high * 1.3, float(f[-1]))


def _view(one: Quantity, f: FloatArray) -> tuple[float, float]:
    """Limits that show the usable part with its errors, not the excesses beside it."""
    usable = (f >= one.good[0]) & (f <= one.good[1])
    near = usable if usable.any() else np.ones(len(f), dtype=bool)
    error = one.nested[0]
    low = float(np.min((one.value - error)[near]))
    high = float(np.max((one.value + error)[near]))
    if one.name != "storage" and not one.good[1] > 2 * one.good[0]:
        # a lightly damped part is usable at its peak only: leave room for what is not
        middle = float(np.median(one.value[near]))
        low, high = min(low, -0.5 * abs(middle)), max(high, middle + 1.5 * abs(middle))
    margin = 0.1 * (high - low)
    return low - margin, high + margin
