"""Figures of amplitude: loops, sweeps and FRFs at levels."""

from __future__ import annotations

import numpy as np
import pytest
from kit import levels
from kit.pictures import first, lines, marks

from dashpot import plot
from dashpot.extensions.amplitude.preprocess import compute_sweep, find_steady_cycles
from dashpot.plot.picture import Dots, Tag

pytestmark = pytest.mark.once


def test_every_amplitude_has_its_loop_and_its_fit():
    picture = plot.level(levels.law_of_loops(), [levels.loops()])
    storage, _, *loops = picture.panels
    assert [loop.title for loop in loops] == ["0.1 mm", "0.3 mm", "1 mm", "3 mm"]
    assert len({(loop.x.limits, loop.y.limits) for loop in loops}) == 1
    for panel in loops:
        fitted, measured = lines(panel)
        # a miss shows as the thin line that leaves the band
        assert measured.pen.width < fitted.pen.width
        # the preload is gone, and the loop is closed
        assert abs(measured.x.mean()) < 0.05 * np.ptp(measured.x)
        for curve in (fitted, measured):
            assert curve.x[0] == curve.x[-1]
            assert curve.y[0] == curve.y[-1]
            assert np.abs(curve.x).max() == pytest.approx(1, abs=0.02)
    # the law, and the stiffness that the panel above shows, are the slope of the loops below
    steep = [float(np.polyfit(line.x, line.y, 1)[0]) for line in (lines(loop)[1] for loop in loops)]
    dots = marks(storage, Dots)[0]
    assert steep == pytest.approx([dots.y[i] for i in (0, 4, 8, 12)], rel=0.02)
    # two figures of half the width, then every loop in one row; in a journal's column three
    assert [(full, len(row)) for full, row in picture.strip_rows] == [(2, 2), (4, 4)]
    column = picture.resize("column").strip_rows
    assert [(full, len(row)) for full, row in column] == [(1, 1), (1, 1), (3, 3), (3, 1)]
    assert len(plot.loops(levels.loops()).panels) == 4


def test_steady_cycles_of_noisy_loops_have_one_frequency():
    shaken = levels.loops(jitter=2e-6)
    (hz,) = {loop.frequency for loop in find_steady_cycles(shaken)}
    assert hz == pytest.approx(5.0, rel=1e-3)
    assert len(np.unique(compute_sweep(shaken).frequency)) == 1


def test_a_law_is_dashed_where_it_was_not_measured():
    sweep = levels.sweep()
    storage, loss = plot.amplitude_sweep(sweep, levels.law_of_sweep()).panels
    for panel, value in ((storage, sweep.storage), (loss, sweep.loss)):
        dots = marks(panel, Dots)
        assert [marker.label for marker in dots] == ["10 Hz", "100 Hz"]
        assert np.concatenate([marker.y for marker in dots]) == pytest.approx(1e-6 * value)
        inside, outside = first(panel, "fit"), first(panel, "extrapolated")
        finite = np.isfinite(inside.y)
        assert not (finite & np.isfinite(outside.y)).any()
        ends = 100 * np.array([sweep.amplitude.min(), sweep.amplitude.max()])
        assert inside.x[finite][[0, -1]] == pytest.approx(ends, rel=0.02)


def test_level_figure_draws_data_model_and_backbone():
    ideal_fit, frfs = levels.make_ideal_fit(), levels.frfs()
    sizes, storage, loss = plot.level(ideal_fit, frfs).panels
    dots, fits = marks(sizes, Dots), [line for line in lines(sizes) if line.pen.colour == "fit"]
    # each is named at its peak
    tags = [mark for mark in sizes.marks if isinstance(mark, Tag)]
    assert [tag.text.partition(":")[0] for tag in tags] == ["0.005 N", "0.05 N", "0.5 N"]
    for tag, marker in zip(tags, dots, strict=True):
        top = int(marker.y.argmax())
        # between the lines it is higher
        assert tag.x == pytest.approx(marker.x[top], rel=0.03)
        assert marker.y[top] * 0.999 < tag.y < 1.2 * marker.y[top]
        assert tag.colour == marker.colour
        assert f"{tag.x:.2f} Hz" in tag.text
    for marker, fit, frf in zip(dots, fits, frfs, strict=True):
        assert marker.y == pytest.approx(np.abs(frf.value))
        assert np.interp(marker.x, fit.x, fit.y) == pytest.approx(marker.y, rel=0.05)
    # the top of each resonance lies on the backbone
    spine = first(sizes, "backbone")
    for fit in fits:
        top = int(fit.y.argmax())
        near = np.hypot((spine.x - fit.x[top]) / 0.3, np.log(spine.y / fit.y[top]) / 0.3)
        assert np.nanmin(near) < 0.5
    w = 2 * np.pi * 14.0
    for panel, part in ((storage, np.real), (loss, np.imag)):
        shown = first(panel, "fit")
        K = levels.SEAL.complex_stiffness(omega=w) + levels.SLIDER.stiffness(1e-3 * shown.x)
        assert shown.y == pytest.approx(1e-3 * part(K))
        measured = first(panel, "measured")
        assert np.interp(measured.x, shown.x, shown.y) == pytest.approx(measured.y, rel=0.03)
        assert (first(panel, "95 % interval").low <= first(panel, "95 % interval").high).all()


def test_transmissibility_has_its_backbone_too():
    ideal_fit = levels.make_ideal_fit()
    base = [frf.to("transmissibility", mass=levels.MASS) for frf in levels.frfs()]
    sizes = plot.frfs_at_levels(ideal_fit, base).panels[0]
    assert sizes.y.label == "transmissibility, m/m"
    spine = first(sizes, "backbone")
    assert np.nanmax(spine.y) > 5
