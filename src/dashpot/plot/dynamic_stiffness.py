"""The figure of stiffness and damping straight from an FRF, with what spoils them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray
from dashpot.plot.panels import frequency as panel
from dashpot.plot.style import (
    CHOSEN,
    GREEN,
    GREY,
    JOINT,
    MEASURED,
    ORANGE,
    PAGE,
    dress,
    figure,
    legend_above,
    log_axis,
)
from dashpot.records.fit import Fit
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.modal.dynamic_stiffness import DynamicStiffness

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class Quantity:
    """One panel: what it shows, in the unit that is read, and the three errors of it."""

    label: str
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
    mass = 100 * measured.mass_sd / measured.mass
    words = (
        f"and {mass:.2g} % of mass",
        f"and {np.degrees(measured.phase_sd):.2g}° of phase",
        "error (1 SD): scatter",
    )
    span = _span(measured)
    for ax, line in zip(axes, quantities(measured), strict=True):
        if np.isfinite(line.good).all():
            panel.identified(ax, line.good, label="usable: K′ to 10 %, c to 30 %")
        f, one = averaged(measured.frequency, line)
        for error, color, label in zip(one.nested, (ORANGE, GREEN, "#8f8f8f"), words, strict=True):
            panel.limits(ax, f, np.array([one.value - error, one.value + error]), color,
                         label=label, alpha=0.4)  # fmt: skip
        low, high = extent(measured.frequency, line.value)
        ax.vlines(f, low, high, color=GREY, linewidth=0.7, label="range of the lines")
        ax.plot(f, one.value, ".", color=MEASURED.color, markersize=3, label="from the FRF")
        dense = np.geomspace(*span, 200)
        for solid, pen, who in ((fit, CHOSEN, "relaxation fit"), (joint, JOINT, "joint fit")):
            if solid is not None:
                curve = of_model(solid.model, line.label, dense)
                ax.plot(dense, curve, color=pen.color, linestyle=pen.dashes, linewidth=pen.width,
                        label=who)  # fmt: skip
        ax.set_xlim(*span)
        ax.set_ylim(*_view(one, f))
        log_axis(ax, "x")
        dress(ax, x="frequency, Hz", y=line.label)
    legend_above(made, axes[0], columns=4)
    return made


STORAGE, DAMPING, FACTOR = "storage stiffness K′, N/mm", "damping c, N·s/m", "loss factor K″/K′, –"


def quantities(measured: DynamicStiffness) -> tuple[Quantity, Quantity, Quantity]:
    """Storage stiffness, damping and loss factor with their errors."""
    m, omega = measured, 2 * np.pi * measured.frequency
    relative = [
        np.abs(m.loss_factor) * np.hypot(loss / m.loss, storage / m.storage)
        for loss, storage in (
            (m.loss_random, m.storage_random),
            (m.loss_phase, m.storage_phase),
            (np.zeros(len(omega)), m.storage_mass),
        )
    ]
    return (
        Quantity(STORAGE, 1e-3 * m.storage, 1e-3 * m.storage_random, 1e-3 * m.storage_phase,
                 1e-3 * m.storage_mass, m.storage_band),
        Quantity(DAMPING, m.damping, m.loss_random / omega, m.loss_phase / omega,
                 np.zeros(len(omega)), m.loss_band),
        Quantity(FACTOR, m.loss_factor, relative[0], relative[1], relative[2], m.loss_band),
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
        line.label, mean(line.value), scatter, mean(line.phase), mean(line.mass), line.good
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


def of_model(model: GeneralizedMaxwell, label: str, f: FloatArray) -> FloatArray:
    """The quantity of that label as a solid has it."""
    omega = 2 * np.pi * f
    if label == STORAGE:
        return 1e-3 * model.storage(omega)
    return model.loss(omega) / omega if label == DAMPING else model.loss_factor(omega)


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
    if one.label != STORAGE and not one.good[1] > 2 * one.good[0]:
        # a lightly damped part is usable at its peak only: leave room for what is not
        middle = float(np.median(one.value[near]))
        low, high = min(low, -0.5 * abs(middle)), max(high, middle + 1.5 * abs(middle))
    margin = 0.1 * (high - low)
    return low - margin, high + margin
