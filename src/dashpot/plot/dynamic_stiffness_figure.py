"""The figure of a stiffness straight from an FRF, line by line, with its errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray
from dashpot.base.units import convert_to_unit
from dashpot.datamodel.fit import Fit
from dashpot.plot.picture import (
    FIT,
    Area,
    Dots,
    Line,
    Mark,
    Panel,
    Pen,
    Picture,
    Scale,
    Span,
    joint_pen,
)
from dashpot.solids.maxwell import Solid
from dashpot.vibration.modal.dynamic_stiffness import DynamicStiffness

FREQUENCY = "frequency, Hz"
LABELS = {
    "storage": "storage stiffness K′, N/mm",
    "damping": "damping c, N·s/m",
    "loss_factor": "loss factor K″/K′, 1",
}


@dataclass(frozen=True, eq=False)
class PlottedQuantity:
    """A quantity as it is drawn: in the unit that is read, and the three errors of it."""

    name: str
    value: FloatArray
    random: FloatArray
    phase: FloatArray
    mass: FloatArray
    good: tuple[float, float]

    @property
    def nested_errors(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """All errors together, those of phase and scatter, and scatter alone."""
        inner = np.hypot(self.random, self.phase)
        return np.hypot(inner, self.mass), inner, self.random

    def evaluate_for_solid(self, solid: Solid, f: FloatArray) -> FloatArray:
        """The same quantity as a solid has it, at `f`, Hz."""
        omega = 2 * np.pi * f
        if self.name == "storage":
            return convert_to_unit(solid.storage(omega=omega), "N/mm")
        return (
            solid.loss(omega=omega) / omega
            if self.name == "damping"
            else solid.loss_factor(omega=omega)
        )


def dynamic_stiffness(
    measured: DynamicStiffness,
    *,
    fit: Fit | None = None,
    joint: Fit | None = None,
    stamp: str = "",
) -> Picture:
    """Stiffness, damping and loss factor of one seal, line by line, with their errors.

    Shaded about the points, one standard deviation each: the scatter of the FRF, with it the
    phase error between the channels, and with both the error of the mass. Hatched is where all
    of them together leave no usable value.

    Parameters
    ----------
    measured : DynamicStiffness
    fit, joint : Fit, optional
        Solids of one seal to hold against it.
    """
    errors = (
        f"and {100 * measured.mass_sd / measured.mass:.2g} % of mass",
        f"and {np.degrees(measured.phase_sd):.2g}° of phase",
        "error (1 SD): scatter",
    )
    span = _span(measured)
    dense = np.geomspace(*span, 150)
    solids = (
        [] if joint is None else [(joint, *joint_pen(failed=joint.verdict.use == "do not use"))]
    )
    solids += [] if fit is None else [(fit, FIT, "relaxation fit")]
    panels = []
    for line in quantities(measured):
        marks: list[Mark] = []
        if np.isfinite(line.good).all():
            marks.append(Span(span[0], line.good[0], "away", "not usable", True, 1.0))
            marks.append(Span(line.good[1], span[1], "away", hatched=True, tint=1.0))
        f, plotted = average_octave_bands(measured.frequency, line)
        for error, label, tint in zip(
            plotted.nested_errors, errors, (0.15, 0.25, 0.4), strict=True
        ):
            marks.append(
                Area(f, plotted.value - error, plotted.value + error, "ref", label, tint=tint)
            )
        low, high = extent(measured.frequency, line.value)
        gap = np.full(len(f), np.nan)
        marks.append(Line(np.column_stack([f, f, gap]).ravel(),
                          np.column_stack([low, high, gap]).ravel(), Pen("ref", 0.8),
                          "range of the lines"))  # fmt: skip
        marks += [
            Line(dense, line.evaluate_for_solid(fit.solid, dense), pen, who)
            for fit, pen, who in solids
        ]
        marks.append(Dots(f, plotted.value, "measured", "from the FRF"))
        axes = Scale(FREQUENCY, span, log=True), Scale(LABELS[line.name], _view(plotted, f))
        panels.append(Panel(*axes, tuple(marks), height=210))
    caption = (
        "One seal straight from the measured FRF, without a model: the mean of each twelfth of an "
        "octave, the range of its lines, and its errors laid upon each other."
    )
    strips = tuple((panel,) for panel in panels)
    return Picture("direct", caption, strips, 3, stamp, width=900.0)


def quantities(
    measured: DynamicStiffness,
) -> tuple[PlottedQuantity, PlottedQuantity, PlottedQuantity]:
    """Storage stiffness, damping and loss factor with their errors."""
    m, omega = measured, 2 * np.pi * measured.frequency
    none = np.zeros(len(omega))

    def compute_factor_error(loss: FloatArray, storage: FloatArray) -> FloatArray:
        return np.asarray(np.abs(m.loss_factor) * np.hypot(loss / m.loss, storage / m.storage))

    storage, random, phase, mass = (
        convert_to_unit(values, "N/mm")
        for values in (m.storage, m.storage_random, m.storage_phase, m.storage_mass)
    )
    return (
        PlottedQuantity("storage", storage, random, phase, mass, m.storage_band),
        PlottedQuantity(
            "damping", m.damping, m.loss_random / omega, m.loss_phase / omega, none, m.loss_band
        ),
        PlottedQuantity(
            "loss_factor",
            m.loss_factor,
            compute_factor_error(m.loss_random, m.storage_random),
            compute_factor_error(m.loss_phase, m.storage_phase),
            compute_factor_error(none, m.storage_mass),
            m.loss_band,
        ),
    )


def average_octave_bands(
    f: FloatArray, line: PlottedQuantity, *, per_octave: int = 12
) -> tuple[FloatArray, PlottedQuantity]:
    """The mean over every part of an octave, lines weighted by their scatter.

    Scatter shrinks with the number of lines; the errors of phase and mass, alike in all, stay.
    """
    starts = _bins(f, per_octave)
    weight = 1 / line.random**2 if (line.random > 0).all() else np.ones(len(f))
    total = np.add.reduceat(weight, starts)

    def mean(values: FloatArray) -> FloatArray:
        return np.asarray(np.add.reduceat(weight * values, starts) / total)

    scatter = np.sqrt(np.add.reduceat((weight * line.random) ** 2, starts)) / total
    return mean(f), PlottedQuantity(
        line.name, mean(line.value), scatter, mean(line.phase), mean(line.mass), line.good
    )


def extent(f: FloatArray, value: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The lowest and the highest line in every twelfth of an octave."""
    starts = _bins(f, 12)
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


def _view(plotted: PlottedQuantity, f: FloatArray) -> tuple[float, float]:
    """Limits that show the usable part with its errors, not the excesses beside it."""
    usable = (f >= plotted.good[0]) & (f <= plotted.good[1])
    near = usable if usable.any() else np.ones(len(f), dtype=bool)
    error = plotted.nested_errors[0]
    low = float(np.min((plotted.value - error)[near]))
    high = float(np.max((plotted.value + error)[near]))
    if plotted.name != "storage" and not plotted.good[1] > 2 * plotted.good[0]:
        # a lightly damped part is usable at its peak only: leave room for what is not
        middle = float(np.median(plotted.value[near]))
        low, high = min(low, -0.5 * abs(middle)), max(high, middle + 1.5 * abs(middle))
    margin = 0.1 * (high - low)
    return low - margin, high + margin
