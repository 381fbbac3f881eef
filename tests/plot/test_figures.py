"""Figures: labelled, legible, true to the numbers they show."""

from __future__ import annotations

import math
import re
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from kit import handmade, levels
from kit.fits import a_fit, replace_fields
from kit.fractional import SEAL
from kit.pictures import first, lines, marks

from dashpot import plot
from dashpot.base.checks import Check
from dashpot.datamodel.bounds import StiffnessBounds
from dashpot.datamodel.fit_diagnostics import DepthStiffness
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.datamodel.modulus import RelaxationModulus
from dashpot.extensions.curves.dynamic.fit import fit_dynamic
from dashpot.extensions.curves.modulus.fit import fit_modulus
from dashpot.fitting.relaxation import fit
from dashpot.plot.frf_figure import half_power, phase_axis, smooth, wrap_phase
from dashpot.plot.picture import Area, Dots, Line, Panel, Pen, Picture, Rule, Scale, Span, Tag
from dashpot.plot.plotted_data import compute_padded_limits, select_plot_unit
from dashpot.plot.records import force_spectrum
from dashpot.plot.relaxation import fits_to_show, fitted_force
from dashpot.plot.solid import average_octave_bands, build_plotted_quantities
from dashpot.plot.svg import strip as svg_strip
from dashpot.plot.ticks import numbers
from dashpot.preprocessing.prepare import prepare
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.demo_seals import BROAD, PAPER, PAPER_MASS
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.impact.hits import HitBlock
from dashpot.vibration.mass_on_seals import predict_frf

S = handmade.study()
SPRING = GeneralizedMaxwell(0.1 * (2 * np.pi * 10.0) ** 2)
CURVE = np.geomspace(1e-3, 1e3, 100)

DRAW = {
    "segments": lambda: plot.segments(S.prepared),
    "fit": lambda: plot.fit(S.fit, S.prepared, alternatives=S.alternatives),
    "hold": lambda: plot.fit(S.hold_fit, S.prepared),
    "spectrum": lambda: plot.spectrum(S.fit, joint=S.joint),
    "stiffness": lambda: plot.stiffness(
        S.fit, parameters=S.parameters, unresolved_bounds=S.unmeasured, joint=S.joint, mark=12.71
    ),
    "comparison": lambda: plot.comparison(S.comparison, joint=S.joint_comparison, band=S.frf_band),
    "resonance": lambda: plot.resonance(
        S.comparison, S.prediction, joint=S.joint_comparison, band=S.frf_band
    ),
    "frf": lambda: plot.frf(S.measured, S.prediction, labels=("measured", "predicted")),
    "prediction": lambda: plot.frf(S.prediction, band=S.frf_band),
    "receptance": lambda: plot.frf(S.measured.to("receptance")),
    "mobility": lambda: plot.frf(S.measured.to("mobility")),
    "dynamic_stiffness": lambda: plot.frf(S.measured.to("dynamic_stiffness")),
    "direct": lambda: plot.dynamic_stiffness(S.direct, fit=S.fit, joint=S.joint),
    "nyquist": lambda: plot.nyquist(S.measured, S.prediction, labels=("measured", "predicted")),
    "hits": lambda: plot.hits(S.impact, S.measured),
    "hero": lambda: plot.hero(S),
    "hero without hammer": lambda: plot.hero(handmade.bench_only()),
    "modulus": lambda: plot.modulus(*make_modulus_fit()),
    "loops": lambda: plot.level(levels.law_of_loops(), [levels.loops()]),
    "loops alone": lambda: plot.loops(levels.loops()),
    "amplitude sweep": lambda: plot.level(levels.law_of_sweep(), [levels.sweep()]),
    "amplitude sweep alone": lambda: plot.amplitude_sweep(levels.sweep()),
    "levels": lambda: plot.level(levels.make_ideal_fit(), levels.frfs()),
    "dynamic": lambda: plot.stiffness(fit_dynamic(sweep()), data=sweep()),
}

UNIT = re.compile(r", (s|ms|mm|N|mN|N/mm|MPa|N·s/m|Hz|°|1|%|m/s²|1/kg|\(mm/s\)/N|mm/N|dB re 0 Hz)$")


def make_modulus_fit():
    """The fit of a relaxation modulus, and what it was fitted to."""
    data = RelaxationModulus(CURVE, 1e6 * (1 + 2 * np.exp(-CURVE / 0.1)), units="SI")
    return fit_modulus(data.time, data.modulus), data


def sweep() -> DynamicTest:
    """Of one arm, 1 N/mm + 2 N/mm at 10 ms."""
    f = np.geomspace(0.1, 1000, 40)
    K = 1e3 * (1 + 2 * 2j * np.pi * f * 0.01 / (1 + 2j * np.pi * f * 0.01))
    return DynamicTest(f, K.real, K.imag, unit="N/m", units="SI")


@pytest.fixture(scope="module")
def pictures():
    return {name: draw() for name, draw in DRAW.items()}


@pytest.mark.parametrize("name", DRAW)
def test_every_axis_names_its_quantity_and_unit(pictures, name):
    assert pictures[name].panels
    for panel in pictures[name].panels:
        assert UNIT.search(panel.x.label), panel.x.label
        assert UNIT.search(panel.y.label), panel.y.label


@pytest.mark.parametrize("name", DRAW)
def test_figures_can_be_read_on_paper_and_on_a_phone(pictures, name):
    """No letters below 12 px, every axis with two numbers or more, none of them on another."""
    from dashpot.plot.layout import lay_out, text_width

    for width in (360.0, 660.0):
        for strip in pictures[name].strips:
            for frame in lay_out(strip, width).frames:
                assert min(word.size for word in (*frame.ticks, *frame.labels)) >= 12
                upright = [word for word in frame.ticks if word.anchor == "end"]
                level = [word for word in frame.ticks if word.anchor == "middle"]
                assert len(upright) >= 2
                assert all(abs(a.y - b.y) >= 12 for a, b in pairwise(upright))
                assert all(
                    b.x - a.x > (text_width(a.text) + text_width(b.text)) / 2
                    for a, b in pairwise(level)
                )


@pytest.mark.parametrize("name", ["segments", "fit", "spectrum", "stiffness", "comparison", "hits"])
def test_every_figure_says_where_it_comes_from(pictures, name):
    assert pictures[name].stamp.startswith("SIMULATED")
    assert ".csv" in pictures[name].stamp


def test_stamp_states_available_specimen_data():
    who = replace(S.fit.specimen, name="Door seal", lot="L24", date="2026-11-21")
    message = plot.stamp(S.fit.source, who, mass=0.1148, seals=2)
    for part in ("SIMULATED", "seal_8mm.csv", "Door seal", "lot L24", "2026-11-21",
                 "114.8 g on 2 seals"):  # fmt: skip
        assert part in message
    assert plot.stamp() == ""
    many = [replace(S.fit.source[0], file=f"{i}.csv", simulated=False) for i in range(4)]
    assert plot.stamp(many[:3]) == "0.csv, 1.csv, 2.csv"
    assert plot.stamp(many) == "0.csv and 3 more"


def test_matplotlib_is_loaded_for_png_and_pdf_only_and_pyplot_never():
    code = (
        "import sys, dashpot.plot as plot; from kit import handmade\n"
        "picture = plot.segments(handmade.make_ramp_hold()); plot.to_svg(picture)\n"
        "assert not any(m.startswith('matplotlib') for m in sys.modules)\n"
        "plot.render_figure(picture, '.png', dpi=40)\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    folder = Path(__file__).parents[1]
    subprocess.run([sys.executable, "-c", code], check=True, cwd=folder)


# -- the bench --------------------------------------------------------------------------------


def test_the_drawn_residual_is_the_residual_of_the_fit():
    still = replace(S.prepared, displacement_noise=0.0)  # made by hand from this very motion
    when, force = fitted_force(S.fit, still)
    residual = S.prepared.force[: len(when)] - force
    assert np.sqrt(np.mean(residual**2)) == pytest.approx(S.fit.estimate.residual.rms, rel=1e-6)


@pytest.mark.parametrize("method", ["full", "hold"])
def test_the_drawn_residual_is_that_of_a_real_fit(method):
    test = prepare(simulate_relaxation(PAPER, hold_time=10.0).test)
    result = fit(test, arms=2, method=method)
    when, force = fitted_force(result, test)
    residual = np.interp(when, test.time - test.onset, test.force) - force
    # a full fit leaves the time before contact out, eq. 5 that in which the plate settles
    fitted = when > (0 if method == "full" else 1.2 * test.ramp_time)
    assert np.sqrt(np.mean(residual[fitted] ** 2)) == pytest.approx(
        result.estimate.residual.rms, rel=3e-3
    )


@pytest.mark.parametrize(
    ("size", "unit", "expected"),
    [(2.1, "N", ("N", 1.0)), (4.6e-3, "N", ("mN", 1e3)), (2.2e-6, "N", ("µN", 1e6)),
     (3e-16, "N", ("pN", 1e12)), (0.0, "N", ("N", 1.0)), (8e-3, "m", ("mm", 1e3)),
     (1.9e-6, "m", ("µm", 1e6)), (4e-8, "m", ("nm", 1e9))],
)  # fmt: skip
def test_units_follow_the_size_of_the_thing(size, unit, expected):
    assert select_plot_unit(np.array([0.0, -size]), unit) == expected


def test_segments_figure_uses_units_of_the_record():
    small = replace(
        S.prepared, displacement=1e-4 * S.prepared.displacement, depth=1e-4 * S.prepared.depth,
        force=1e-6 * S.prepared.force, force_noise=1e-6 * S.prepared.force_noise,
    )  # fmt: skip
    variant, pushed = plot.segments(small).strips[0]
    assert [variant.y.label, pushed.y.label] == ["compression, µm", "force, µN"]
    assert max(line.y.max() for line in lines(pushed)) == pytest.approx(S.prepared.force.max())


def test_log_time_starts_within_the_ramp_even_if_sampling_slows_down_in_the_hold():
    retained = np.unique(np.round(np.geomspace(1, len(S.prepared.time) - 1, 400)).astype(int))
    sparse = replace(
        S.prepared, time=S.prepared.time[retained], displacement=S.prepared.displacement[retained],
        force=S.prepared.force[retained],
    )  # fmt: skip
    start, _ = plot.fit(S.fit, sparse).panels[0].x.limits
    assert start <= 0.1 * sparse.ramp_time


def test_fitted_force_without_offset_starts_at_zero():
    bare = replace_fields(S.fit, nuisance=())
    _, with_offset = fitted_force(S.fit, S.prepared)
    _, without = fitted_force(bare, S.prepared)
    assert without[0] == 0.0
    assert with_offset[0] == pytest.approx(S.fit.estimate.nuisance[0].value, rel=1e-3)


def test_fitted_force_of_several_depths_uses_each_stiffness():
    at = DepthStiffness(
        depth=8e-3,
        k_inf=S.fit.model.k_inf,
        k_inf_most=1.01 * S.fit.model.k_inf,
        k=S.fit.model.k,
        k_se=(0.1, 0.1),
    )
    several = replace_fields(S.fit, stiffness_by_depth=(replace(at, depth=4e-3, k_inf=100.0), at))
    assert np.array_equal(fitted_force(several, S.prepared)[1], fitted_force(S.fit, S.prepared)[1])
    shallow = replace(S.prepared, depth=4.2e-3)
    without_offset = replace_fields(several, nuisance=())
    assert fitted_force(without_offset, shallow)[1].max() < 0.9 * S.prepared.force.max()


def test_fits_to_show_has_one_fit_per_order_ascending():
    shown = fits_to_show(S.fit, (S.fit, *S.alternatives))
    assert [item.model.arms for item in shown] == [1, 2]


def test_the_spike_that_thinning_must_not_hide_is_drawn():
    force = np.array(S.prepared.force)
    force[7000] += 0.9
    panel = plot.fit(S.fit, replace(S.prepared, force=force)).panels[0]
    highest = max(line.y.max() for line in lines(panel))
    assert highest == pytest.approx(force[7000], rel=1e-12)


def test_the_ramp_is_shaded_where_it_is():
    (ramp,) = marks(plot.segments(S.prepared).panels[0], Span)
    assert (ramp.low, ramp.high) == (0.0, S.prepared.ramp_time)


def test_the_residual_is_drawn_with_its_range_its_mean_and_the_noise():
    _, panel, other = plot.fit(S.fit, S.prepared, alternatives=S.alternatives).panels
    assert panel.y.label == "residual of two arms, mN"
    assert other.y.label == "residual of one arm, mN"
    (area,), (mean,) = marks(panel, Area), lines(panel)
    assert (area.low <= mean.y).all()
    assert (mean.y <= area.high).all()
    assert sorted(rule.position for rule in marks(panel, Rule)) == pytest.approx([-5.0, 5.0])
    # of 5 mN of noise the range of a hundred samples is some five deviations
    assert np.median(area.high - area.low) == pytest.approx(25, abs=8)


# -- the solid --------------------------------------------------------------------------------


def test_stiffness_figure_is_solid_in_the_band_and_dashed_outside(pictures):
    low, high = S.fit.band
    for panel in pictures["stiffness"].panels:
        solid, dashed = first(panel, "relaxation fit"), first(panel, "relaxation fit, extrapolated")
        assert np.array_equal(np.isfinite(solid.y), (solid.x >= low) & (solid.x <= high))
        assert not solid.pen.dashes
        assert dashed.pen.dashes
        assert (np.isfinite(solid.y) | np.isfinite(dashed.y)).all()


@pytest.mark.parametrize("endless", ["some", "all"])
def test_a_bound_that_no_test_sets_runs_out_at_the_top_of_a_finite_axis(endless):
    result = a_fit(PAPER)
    f = np.geomspace(1e-3, 100, 61)
    tops = np.where((f > 1) | (endless == "all"), np.inf, 2 * result.solid.k_0)
    edges = np.array([0 * f, tops])
    bounds = StiffnessBounds(f, edges, edges, edges)
    picture = plot.stiffness(result, unresolved_bounds=bounds)
    for strip in picture.strips:
        for panel in strip:
            assert np.isfinite(panel.y.limits).all()
            assert len(numbers(panel.y, panel.height, 30)) > 1
            assert "inf" not in svg_strip((panel,), name="a", width=400.0, kind="screen").lower()


def test_axes_hold_what_is_finite():
    assert compute_padded_limits(
        np.array([1.0, np.inf]), np.array([3.0, np.nan, -np.inf]), margin=0.0
    ) == (1, 3)
    assert np.isfinite(compute_padded_limits(np.array([np.inf, np.nan]))).all()


def test_stiffness_shows_newtons_per_millimetre(pictures):
    curve = first(pictures["stiffness"].panels[0], "joint model")
    assert curve.y == pytest.approx(1e-3 * S.joint.model.storage(omega=2 * np.pi * curve.x))


def test_stiffness_figure_of_a_fractional_model_draws_it_with_its_arms():
    result = a_fit(SEAL)
    for panel, name, factor in zip(
        plot.stiffness(result).panels, ("storage", "loss", "loss_factor"), (1e-3, 1e-3, 1.0),
        strict=True,
    ):  # fmt: skip
        curve = first(panel, "relaxation fit")
        individual = factor * getattr(SEAL, name)(frequency=curve.x)
        finite = np.isfinite(curve.y)
        assert curve.y[finite] == pytest.approx(individual[finite], rel=1e-12)
    tips = marks(plot.spectrum(result).panels[0], Dots)[0]
    assert len(tips.x) == SEAL.maxwell.arms > 20
    curve = first(plot.dynamic_stiffness(S.direct, fit=result).panels[1], "relaxation fit")
    omega = 2 * np.pi * curve.x
    assert curve.y == pytest.approx(SEAL.loss(omega=omega) / omega, rel=1e-12)
    when, force = fitted_force(result, replace(S.prepared, displacement_noise=0.0))
    assert force == pytest.approx(
        SEAL.force(when, S.prepared.displacement[: len(when)]), rel=1e-9, abs=1e-9
    )


def test_a_material_is_drawn_in_megapascals():
    result, _ = make_modulus_fit()
    panel = plot.stiffness(result).panels[0]
    assert panel.y.label == "storage modulus E′, MPa"
    assert max(np.nanmax(line.y) for line in lines(panel)) == pytest.approx(3.0, 0.01)
    stems = plot.spectrum(result).panels[0]
    assert stems.y.label == "modulus E, MPa"
    assert stems.y.limits[1] == pytest.approx(2.4, 0.1)


def test_a_modulus_and_a_sweep_are_drawn_with_what_was_measured(pictures):
    upper, lower = pictures["modulus"].panels
    points = first(upper, "measured")
    assert points.y == pytest.approx(1 + 2 * np.exp(-CURVE / 0.1))
    residual = marks(lower, Dots)[0]
    assert np.abs(residual.y).max() < 0.1  # per cent: the data have no noise
    data = sweep()
    for panel, name in zip(pictures["dynamic"].panels, ("storage", "loss"), strict=False):
        points = first(panel, "measured")
        assert np.array_equal(points.x, data.frequency)
        assert points.y == pytest.approx(1e-3 * getattr(data, name))
    last = first(pictures["dynamic"].panels[2], "measured")
    assert last.y == pytest.approx(data.loss / data.storage)


def test_a_very_wide_axis_has_few_numbers():
    wide = replace_fields(S.fit, band=(1e-15, 1e3), parameters=(), covariance=np.zeros((0, 0)))
    axis = plot.spectrum(wide).panels[0].x
    assert 2 <= len(numbers(axis, 300.0, 46)) <= 8


def test_an_frf_that_is_good_nowhere_draws_no_points():
    """A range far from every line: nothing is drawn, and the figure stands."""
    nowhere = replace(S.direct, storage_band=(0.0, 0.0), loss_band=(0.0, 0.0))
    panels = plot.stiffness(S.fit, measured=nowhere).panels
    assert not [m for panel in panels for m in panel.marks if isinstance(m, Dots)]


def test_stiffness_from_the_frf_is_drawn_with_its_scatter_where_it_is_good():
    panels = plot.stiffness(S.fit, measured=S.direct).panels
    for panel, name, band in zip(
        panels, ("storage", "loss", "loss_factor"),
        (S.direct.storage_band, *[S.direct.loss_band] * 2), strict=True,
    ):  # fmt: skip
        points = first(panel, "directly from the FRF")
        assert len(points.x) >= 3
        assert band[0] <= points.x.min() < points.x.max() <= band[1]
        assert (points.error > 0).all()
        factor = 1.0 if name == "loss_factor" else 1e-3
        truth = factor * getattr(BROAD, name)(frequency=points.x)
        assert np.abs(points.y / truth - 1).max() < 0.2


def test_averaging_lines_shrinks_scatter_and_leaves_the_errors_of_phase_and_mass():
    storage, _, _ = build_plotted_quantities(S.direct)
    f, mean = average_octave_bands(S.direct.frequency, storage)
    assert len(f) < len(S.direct.frequency) / 3
    top = f > 20  # many lines in each bin
    at = np.interp(f[top], S.direct.frequency, storage.mass)
    assert mean.mass[top] == pytest.approx(at, rel=0.05)
    assert (mean.random[top] < 0.7 * np.interp(f[top], S.direct.frequency, storage.random)).all()
    truth = 1e-3 * BROAD.storage(omega=2 * np.pi * f)
    assert np.sqrt(np.mean(((mean.value - truth) / mean.random) ** 2)) < 2.0


def test_spectrum_figure_has_a_stem_per_arm_and_hatches_outside_the_band(pictures):
    panel = pictures["spectrum"].panels[0]
    tips = marks(panel, Dots)
    assert [len(dots.x) for dots in tips] == [S.joint.model.arms, S.fit.model.arms]
    below, above = marks(panel, Span)
    assert below.hatched
    assert above.hatched
    assert (below.high, above.low) == pytest.approx(
        tuple(1 / (2 * np.pi * f) for f in reversed(S.fit.band))
    )


# -- the hammer -------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["comparison", "resonance", "hero"])
def test_the_peaks_are_marked_where_they_are_and_named(pictures, name):
    panel = next(
        panel for panel in pictures[name].panels if panel.y.label.startswith("accelerance")
    )
    c = S.comparison
    measured, predicted, joint = marks(panel, Tag)
    assert (measured.x, measured.y, measured.dot) == (c.measured_hz, c.measured_peak, "filled")
    assert (predicted.x, predicted.y, predicted.dot) == (
        c.predicted_hz, c.predicted_peak, "hollow",
    )  # fmt: skip
    assert measured.text == "measured 12.71 Hz, 155 1/kg"
    after = S.joint_comparison
    assert (joint.x, joint.y, joint.dot) == (after.predicted_hz, after.predicted_peak, "")
    assert joint.text == "joint model 12.66 Hz, 174 1/kg"


@pytest.mark.parametrize("name", ["comparison", "resonance", "hero"])
def test_a_joint_solid_shows_on_both_sides_of_the_measured_line_that_it_lies_under(pictures, name):
    panel = next(
        panel for panel in pictures[name].panels if panel.y.label.startswith("accelerance")
    )
    order = [line.label for line in lines(panel) if line.label]
    assert order == ["joint model", "predicted from relaxation", "measured"]
    joint, measured = first(panel, "joint model"), first(panel, "measured")
    assert joint.pen.width >= measured.pen.width + 4


def test_a_joint_fit_that_failed_lies_over_the_prediction_and_has_no_peak():
    panel = plot.comparison(S.comparison, joint=S.joint_comparison, failed=True).panels[0]
    order = [line.label for line in lines(panel) if line.label]
    assert order == ["predicted from relaxation", "joint model, failed", "measured"]
    assert len(marks(panel, Tag)) == 2


@pytest.mark.parametrize("name", ["comparison", "resonance", "hero", "prediction"])
def test_predicted_curve_lies_inside_its_bounds(pictures, name):
    panel = next(
        panel for panel in pictures[name].panels if panel.y.label.startswith("accelerance")
    )
    bound = first(panel, "95 % bounds over all spectra")
    assert bound.hatched
    curve = next(line for line in lines(panel) if line.pen.dashes)
    inside = (curve.x >= bound.x[0]) & (curve.x <= bound.x[-1])
    assert inside.sum() > 100
    low, high = (np.interp(curve.x, bound.x, edge)[inside] for edge in (bound.low, bound.high))
    shown = curve.y[inside] >= panel.y.limits[0]
    assert (low[shown] <= curve.y[inside][shown] * (1 + 1e-9)).all()
    assert (curve.y[inside] <= high * (1 + 1e-9)).all()


@pytest.mark.parametrize("kind", ["receptance", "mobility", "accelerance", "dynamic_stiffness"])
def test_every_kind_of_prediction_is_drawn_with_what_it_leaves_open(kind):
    frf = S.prediction.to(kind)
    size = np.abs(S.prediction.value)
    f = S.prediction.frequency
    panel = plot.frf(frf, interval=(f, np.array([0.8 * size, 1.25 * size]))).panels[0]
    area, curve = marks(panel, Area)[0], lines(panel)[0]
    interpolated = np.interp(f, curve.x, curve.y)
    for edge, factor in ((area.low, 0.8), (area.high, 1.25)):
        at = np.interp(f, area.x, edge)
        near = np.abs(f / 12.3 - 1) > 0.2  # between the lines of a sharp peak it is no line
        assert at[near] == pytest.approx(factor * interpolated[near], rel=2e-3)


def test_a_joint_fit_that_fails_looks_failed():
    bad = Check("peak_agrees", False, "misses", grade="stop")
    failed = replace(S.joint_comparison, checks=(bad,))
    panel = plot.comparison(S.comparison, joint=failed).panels[0]
    curve = first(panel, "joint model, failed")
    assert curve.pen.colour == "bad"
    assert curve.pen.dashes
    intact = plot.comparison(S.comparison, joint=replace(failed, checks=())).panels[0]
    assert first(intact, "joint model").pen.colour == "joint"
    message = plot.comparison(S.comparison, joint=S.joint_comparison, failed=True).panels[0]
    assert first(message, "joint model, failed").pen.colour == "bad"
    lame = replace_fields(S.joint, checks=(bad,))
    for picture in (
        plot.spectrum(S.fit, joint=lame),
        plot.stiffness(S.fit, joint=lame),
        plot.dynamic_stiffness(S.direct, joint=lame),
        plot.hero(replace(S, joint=lame)),
    ):
        labels = {mark.label for mark in picture.key}
        assert "joint model, failed" in labels
        assert "joint model" not in labels


def test_tag_replaces_the_key_entry_of_the_same_panel_only():
    axes = Scale("x", (0.0, 1.0)), Scale("y", (0.0, 1.0))
    line = Line(np.array([0.0, 1.0]), np.array([0.0, 1.0]), Pen("fit", 1.0), "latch")
    tag = Tag(1.0, 1.0, "latch", "ink", end=True)
    picture = Picture("apart", "", ((Panel(*axes, (tag,)),), (Panel(*axes, (line,)),)))
    neighbour = Picture("beside", "", ((Panel(*axes, (tag, line)),), (Panel(*axes, (line,)),)))
    assert [mark.label for mark in picture.key] == ["latch"]
    assert neighbour.key == ()


def test_a_resonance_without_damping_does_not_stretch_the_axis():
    f = np.union1d(np.geomspace(1.0, 100.0, 400), 10.0 * (1 + 1e-12))
    free = predict_frf(SPRING, mass=0.1, frequency=f)
    low, high = plot.frf(free).panels[0].y.limits
    assert np.abs(free.value).max() > 1e10
    assert high / low < 1e6


def test_resonance_figure_includes_a_predicted_peak_outside_the_lines():
    heavy = predict_frf(S.fit, mass=50 * S.mass, seals=2, frequency=np.geomspace(0.3, 60, 2001))
    panel = plot.resonance(S.comparison, heavy).panels[0]
    tags = {tag.dot: tag.x for tag in marks(panel, Tag)}
    low, high = panel.x.limits
    assert low < tags["hollow"] < 2.0 < tags["filled"] < high


def test_a_sharp_peak_between_lines_is_drawn_round():
    coarse = predict_frf(2 * PAPER, mass=PAPER_MASS, frequency=np.arange(10.0, 16.0, 0.22))
    f, value = smooth(coarse)
    fine = predict_frf(2 * PAPER, mass=PAPER_MASS, frequency=f)
    assert np.abs(coarse.value).max() < 0.85 * np.abs(fine.value).max()
    assert np.abs(value).max() == pytest.approx(np.abs(fine.value).max(), rel=0.01)
    assert np.isin(coarse.frequency, f).all()


def test_a_measured_frf_is_never_interpolated():
    f, value = smooth(S.measured)
    assert f is S.measured.frequency
    assert value is S.measured.value


def test_phase_axis_over_a_base_spans_180_degrees():
    f = np.linspace(2, 40, 500)
    base = predict_frf(2 * PAPER, mass=PAPER_MASS, frequency=f, kind="transmissibility")
    lowest, ticks = phase_axis(base.value)
    assert ticks == (-180.0, -90.0, 0.0)
    degrees = wrap_phase(base.value, lowest)
    assert np.abs(np.diff(degrees)).max() < 180


def test_phase_does_not_wrap_through_the_noise_of_an_accelerance(pictures):
    assert pictures["frf"].panels[1].y.limits == (-15, 195)
    lowest, _ = phase_axis(S.measured.value)
    assert np.abs(np.diff(wrap_phase(S.measured.value, lowest))).max() < 90


def test_an_frf_without_coherence_or_scatter_has_no_strip_for_it():
    bare = replace(S.measured, coherence=None, sd=None, averages=1)
    assert [panel.y.label for panel in plot.frf(bare).panels] == ["accelerance, 1/kg", "phase, °"]


def test_an_frf_that_starts_at_zero_frequency_is_drawn_on_log_axes():
    frequency = np.concatenate(([0.0], S.measured.frequency))
    value = np.concatenate(([0.0], S.measured.value))
    from_zero = replace(S.measured, frequency=frequency, value=value, coherence=None, sd=None)
    picture = plot.frf(from_zero)
    assert "nan" not in plot.to_svg(picture)
    assert picture.panels[0].x.limits[0] > 0


def test_hits_of_an_undersampled_pulse_show_its_few_samples():
    item = slice(0, S.impact.starts[1], 10)
    few = replace(
        S.impact, time=S.impact.time[item], force=S.impact.force[item],
        acceleration=S.impact.acceleration[:, item], starts=(0,),
    )  # fmt: skip
    pulses, spectra, *_ = plot.hits(few, replace(S.measured, hits=())).panels
    assert all(len(line.x) >= 6 for line in lines(pulses))
    assert spectra.x.limits[1] <= 0.5 * few.rate


def test_half_power_rings_give_the_damping():
    frequency = np.linspace(12.0, 13.4, 4001)
    value = predict_frf(2 * PAPER, mass=PAPER_MASS, frequency=frequency).value
    low, high = frequency[half_power(value)]
    assert high - low == pytest.approx(0.112747, rel=0.01)


def test_nyquist_axes_are_equal(pictures):
    from dashpot.plot.layout import lay_out

    (frame,) = lay_out(pictures["nyquist"].strips[0], 400.0).frames
    x, y = frame.panel.x.limits, frame.panel.y.limits
    assert (x[1] - x[0]) / frame.box.width == pytest.approx((y[1] - y[0]) / frame.box.height)


@pytest.mark.parametrize(("width", "expected"), [(0.010, -0.131), (0.020, -0.529)])
def test_the_force_spectrum_is_that_of_a_half_sine(width, expected):
    rate = 51_200.0
    time = np.arange(-0.02, 0.2, 1 / rate)
    force = np.where((time >= 0) & (time <= width), 3.0 * np.sin(np.pi * time / width), 0.0)
    hit = HitBlock(
        name="1", time=0.0, rate=rate, onset=int(np.argmax(time >= 0)), force=force,
        acceleration=np.zeros((1, len(force))), noise=np.zeros(2), ringing=np.zeros(1),
        offset=np.zeros(2),
    )  # fmt: skip
    frequency, level = force_spectrum(hit)
    # the foot of the pulse below 2 % of its peak is left out
    assert np.interp(12.71, frequency, level) == pytest.approx(expected, abs=0.01)


def test_rejected_hits_are_seen_and_named(pictures):
    pulses = pictures["hits"].panels[0]
    (rejected,) = [line for line in lines(pulses) if line.pen.colour == "bad"]
    assert rejected.label == "hit 3, rejected"
    assert rejected.pen.dashes
    assert rejected.x.max() > 60.0  # the second hit, 60 ms later, is in sight
    assert pulses.title == "4 of 5 hits accepted"


def test_words_from_a_file_stay_words():
    markup = replace(S.impact, channels=("<img src=x>--><b>", "]]></svg>"))
    assert not re.search(r"<img|<b>|\]\]>", plot.to_svg(plot.hits(markup, S.measured)))
    hostile = plot.hits(replace(S.impact, channels=(r"$\frac{", "加速度 \x07")), S.measured)
    assert "\x07" not in plot.to_svg(hostile)
    assert r"$\frac{" in plot.to_svg(hostile)
    assert plot.render_figure(hostile, ".png", dpi=40)


def test_limits_without_an_end_are_drawn_within_the_axes():
    open_ended = replace(S.frf_band, unmeasured=np.array([S.frf_band.unmeasured[0],
                         np.full(len(S.frf_band.frequency), math.inf)]))  # fmt: skip
    picture = plot.comparison(S.comparison, band=open_ended)
    bound = first(picture.panels[0], "95 % bounds over all spectra")
    assert np.isfinite(bound.high).all()
    assert not re.search(r"nan|inf\b", plot.to_svg(picture))
