"""Figure of compression load deflection: all cycles, and the requested compressions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.provenance import list_sources
from dashpot.base.units import convert_to_unit, format_quantity
from dashpot.extensions.materials.cld.datamodel import CLD, SAME_SPEED, Branch, Cycle
from dashpot.plot.picture import REF, Line, Mark, Panel, Pen, Picture, Rule, Scale, Span, Tag
from dashpot.plot.plotted_data import compute_padded_limits, downsample_to_extremes
from dashpot.plot.plotted_data import stamp as format_stamp
from dashpot.plot.style import sequential

if TYPE_CHECKING:
    from dashpot.extensions.materials.cld.fit_files import CLDResult


_FIRST_CYCLE_STYLE = Pen("ref", 1.4, (2, 3)), "first cycle"
_EARLIER = Pen("ref", 1.1), "other cycles"
_SPECIMEN_COLOURS = ("measured", "joint-ink", "fit")
"""Colours of as many specimens; of more, all are alike."""
_LETTER = 0.016
"""Part of the axis that a letter of a name takes."""


def cld(
    results: CLD | Sequence[CLD],
    *,
    limits: tuple[float | None, float | None] | None = None,
    stamp: str = "",
) -> Picture:
    """Return loading and unloading over compression: the evaluated cycle over the others.

    Nominal compression and tolerance are marked. Of several specimens the evaluated cycle alone is
    drawn, named where its line ends; three at most have a colour of their own.

    Parameters
    ----------
    results : CLD or sequence of CLD
    limits : (float or None, float or None), optional
        Asked of the force at the nominal compression, N, as `CLD.per` gives it.
    stamp : str
        Origin of the data, printed below the figure; by default files, specimen and date.
    """
    specimens = (results,) if isinstance(results, CLD) else tuple(results)
    first, single = specimens[0], len(specimens) == 1
    lines, names = _make_curves(specimens)
    marks: list[Mark] = [
        *_make_tolerance_mark(first),
        *lines,
        *names,
        *_make_nominal_marks(first, valued=single),
    ]
    x, y = (np.concatenate([getattr(line, way) for line in lines]) for way in ("x", "y"))
    finite_limits = [limit for limit in limits or () if limit is not None and np.isfinite(limit)]
    if finite_limits:
        marks += _draw_force_limits(first, finite_limits)
        y = np.append(y, finite_limits)
    start, stop = compute_padded_limits(x)
    longest = max((len(name.text) for name in names), default=0)
    axis = Scale(
        "compression since first contact, mm", (start, stop + _LETTER * longest * (stop - start))
    )
    panel = Panel(
        axis, Scale(f"force, {first.unit}", compute_padded_limits(y)), tuple(marks), height=320
    )
    caption = (
        "Compression load deflection: force on the way in and back, with the nominal compression "
        "and its tolerance."
    )
    return Picture(
        "cld",
        caption,
        ((panel,),),
        1,
        stamp or format_stamp(list_sources(specimens), first.specimen),
    )


def draw_specimens(result: CLDResult) -> Picture:
    """Return the figure of the specimens of one result."""
    return cld(result.specimens)


def _make_curves(specimens: Sequence[CLD]) -> tuple[list[Line], list[Tag]]:
    """Return the evaluated cycle of every specimen, and its name at the end of its line."""
    single = len(specimens) == 1
    lines = _draw_other_cycles(specimens[0]) if single else []
    names: list[Tag] = []
    for specimen, colour, name in zip(specimens, *_select_line_styles(specimens), strict=True):
        pens = Pen(colour, 2.0 if single else 1.6), Pen(colour, 1.4, (6, 3))
        lines += _make_branches(specimen, specimen.cycle, pens, ("pressed", "released"))
        if name:
            compressions, high = (
                convert_to_unit(specimen.loading.compression, "mm"),
                specimen.per * specimen.loading.force,
            )
            deepest_index = int(np.argmax(compressions))
            names.append(Tag(float(compressions[deepest_index]), float(high[deepest_index]), name,
            colour,
                             bold=True, end=True))  # fmt: skip
    return lines, names


def _make_nominal_marks(result: CLD, *, valued: bool) -> Iterator[Mark]:
    """Return marks of nominal compression and limits, of one specimen with the force."""
    for mark in result.limit_marks:
        compression, force = convert_to_unit(mark.compression, "mm"), result.per * mark.loading
        yield Rule(compression, REF)
        if valued:
            yield Tag(compression, force, f"{force:.3g}", "fit", "filled", bold=True)


def _select_line_styles(specimens: Sequence[CLD]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return colour and name of each line: of up to three specimens, or of each speed."""
    speeds = [specimen.cycle.speed for specimen in specimens]
    values = [speed for speed in speeds if speed is not None]
    if len(specimens) == 1:
        return ("fit",), ("",)
    if len(values) == len(specimens) and max(values) > SAME_SPEED * min(values):
        rank = np.argsort(np.argsort(values))
        colours = sequential(len(specimens))
        labels = tuple(format_quantity(value, "mm/s", ".3g") for value in values)
        return tuple(colours[i] for i in rank.tolist()), labels
    if len(specimens) > len(_SPECIMEN_COLOURS):
        return ("ref",) * len(specimens), ("",) * len(specimens)
    files = ("" if specimen.source is None else specimen.source.file for specimen in specimens)
    labels = tuple(name.rpartition(".")[0] or name or f"specimen {i}"
                  for i, name in enumerate(files, start=1))  # fmt: skip
    return _SPECIMEN_COLOURS[: len(specimens)], labels


def _make_tolerance_mark(result: CLD) -> list[Mark]:
    """Return the tolerance of the compression, if it has one."""
    if result.least is None or result.most is None:
        return []
    low, high = (
        convert_to_unit(tolerance_mark.compression, "mm")
        for tolerance_mark in (result.least, result.most)
    )
    return [Span(low, high, "fit", f"tolerance {low:.4g} to {high:.4g} mm", tint=0.07)]


def _draw_force_limits(result: CLD, limits: Sequence[float]) -> list[Mark]:
    """Return the limits of the force at the nominal compression, as a bar there."""
    nominal = convert_to_unit(result.nominal.compression, "mm")
    limits_text = " to ".join(f"{end:.3g}" for end in limits)
    return [
        Line(np.full(len(limits), nominal), np.array(limits), Pen("bad", 2.5)),
        Tag(nominal, max(limits), f"asked {limits_text} {result.unit}", "bad-ink", "filled"),
    ]


def _draw_other_cycles(result: CLD) -> list[Line]:
    """Return the cycles that the figures are not of."""
    lines = []
    for cycle in result.cycles:
        if cycle is not result.cycle:
            pen, label = _FIRST_CYCLE_STYLE if cycle.number == 1 else _EARLIER
            lines += _make_branches(result, cycle, (pen, pen), (label, label))
    return lines


def _make_branches(
    result: CLD, cycle: Cycle, pens: tuple[Pen, Pen], labels: tuple[str, str]
) -> list[Line]:
    """Loading and unloading of a cycle, as far as it was recorded."""
    branches = zip((cycle.loading, cycle.unloading), pens, labels, strict=True)
    return [
        _make_line(result, branch, pen, label)
        for branch, pen, label in branches
        if branch is not None
    ]


def _make_line(result: CLD, branch: Branch, pen: Pen, label: str) -> Line:
    x, y = branch.compression, branch.force
    if x[0] > x[-1]:
        x, y = x[::-1], y[::-1]
    # bins need a rising x: noise makes a few readings fall
    order = np.argsort(x, kind="stable")
    downsampled_line: tuple[FloatArray, FloatArray] = downsample_to_extremes(
        convert_to_unit(x[order], "mm"), result.per * y[order], bins=300
    )
    return Line(*downsampled_line, pen, label)
