"""Figures: labelled, legible, true to the numbers they show."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from kit import handmade
from kit.fits import a_fit, altered
from kit.fractional import SEAL
from matplotlib.colors import to_hex
from matplotlib.text import Text

from dashpot import plot
from dashpot.fitting.modulus import fit_modulus
from dashpot.fitting.relaxation import fit
from dashpot.plot.impact import force_spectrum
from dashpot.plot.panels import half_power, phase_axis, turned
from dashpot.plot.relaxation import fits_to_show, fitted_force
from dashpot.plot.solid import averaged, quantities
from dashpot.plot.style import BLUE, COLUMN, MM, PAGE, REJECTED, SMALL, unit_of
from dashpot.plot.vibration import smooth
from dashpot.preparation.prepare import prepare
from dashpot.records.fit import AtDepth
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.table_1 import BROAD, PAPER, PAPER_MASS
from dashpot.vibration.impact.hits import HitBlock
from dashpot.vibration.systems.prediction import predict_frf

S = handmade.study()

DRAW = {
    "segments": lambda: plot.segments(S.prepared),
    "fit": lambda: plot.fit(S.fit, S.prepared, alternatives=S.alternatives),
    "hold": lambda: plot.fit(S.hold_fit, S.prepared),
    "spectrum": lambda: plot.spectrum(S.fit, joint=S.joint),
    "stiffness": lambda: plot.stiffness(
        S.fit, parameters=S.parameters, unseen=S.unseen, joint=S.joint, mark=12.71
    ),
    "comparison": lambda: plot.comparison(S.comparison, joint=S.joint_comparison, band=S.frf_band),
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
}

UNIT = re.compile(
    r", (s|s \(log\)|ms|mm|N|mN|N/mm|N·s/m|Hz|°|–|m/s²|\(m/s²\)/N|\(mm/s\)/N|mm/N|dB re 0 Hz)$"
)


@pytest.fixture(scope="module")
def drawn():
    return {name: draw() for name, draw in DRAW.items()}


@pytest.mark.parametrize("name", DRAW)
def test_every_axis_names_its_quantity_and_unit(drawn, name):
    figure = drawn[name]
    assert figure.axes
    for ax in figure.axes:
        assert (
            UNIT.search(ax.get_ylabel())
            or "residual, mN" in ax.get_ylabel()
            or (
                ax.get_subplotspec().colspan.start > 0
                and name == "segments"  # shares the left axis
            )
        ), ax.get_ylabel()
        below = ax.get_subplotspec().is_last_row() or ax.xaxis.get_tick_params().get("labelbottom")
        if below is not False and not _shares_x_below(ax):
            assert UNIT.search(ax.get_xlabel()), (name, ax.get_xlabel())


def _shares_x_below(ax) -> bool:
    siblings = ax.get_shared_x_axes().get_siblings(ax)
    return any(one is not ax and UNIT.search(one.get_xlabel()) for one in siblings)


@pytest.mark.parametrize("name", DRAW)
def test_figures_fit_a_journal_and_can_be_read(drawn, name):
    figure = drawn[name]
    width = figure.get_size_inches()[0] / MM
    assert width == pytest.approx(COLUMN) or width == pytest.approx(PAGE)
    sizes = [t.get_fontsize() for t in figure.findobj(Text) if t.get_text()]
    assert min(sizes) >= SMALL >= 7.0


def test_matplotlib_is_loaded_by_the_first_figure_and_pyplot_never():
    code = (
        "import sys, dashpot.plot as plot; from kit import handmade\n"
        "assert not any(m.startswith('matplotlib') for m in sys.modules)\n"
        "plot.to_svg(plot.segments(handmade.prepared()))\n"
        "assert 'matplotlib.pyplot' not in sys.modules\n"
    )
    folder = Path(__file__).parents[1]
    subprocess.run([sys.executable, "-c", code], check=True, cwd=folder)


# -- the bench --------------------------------------------------------------------------------


def test_the_drawn_residual_is_the_residual_of_the_fit():
    still = replace(S.prepared, displacement_noise=0.0)  # made by hand from this very motion
    when, force = fitted_force(S.fit, still)
    left = S.prepared.force[: len(when)] - force
    assert np.sqrt(np.mean(left**2)) == pytest.approx(S.fit.residual.rms, rel=1e-6)


@pytest.mark.parametrize("method", ["full", "hold"])
def test_the_drawn_residual_is_that_of_a_real_fit(method):
    test = prepare(simulate_relaxation(PAPER, hold_time=10.0).test)
    found = fit(test, arms=2, method=method)
    when, force = fitted_force(found, test)
    left = np.interp(when, test.time - test.onset, test.force) - force
    # a full fit leaves the time before contact out, eq. 5 that in which the plate settles
    fitted = when > (0 if method == "full" else 1.2 * test.ramp_time)
    assert np.sqrt(np.mean(left[fitted] ** 2)) == pytest.approx(found.residual.rms, rel=3e-3)


@pytest.mark.parametrize(
    ("size", "unit", "expected"),
    [(2.1, "N", ("N", 1.0)), (4.6e-3, "N", ("mN", 1e3)), (2.2e-6, "N", ("µN", 1e6)),
     (3e-16, "N", ("pN", 1e12)), (0.0, "N", ("N", 1.0)), (8e-3, "m", ("mm", 1e3)),
     (1.9e-6, "m", ("µm", 1e6)), (4e-8, "m", ("nm", 1e9))],
)  # fmt: skip
def test_units_follow_the_size_of_the_thing(size, unit, expected):
    assert unit_of(np.array([0.0, -size]), unit) == expected


def test_a_record_of_a_microscope_is_drawn_in_its_own_units():
    small = replace(
        S.prepared, displacement=1e-4 * S.prepared.displacement, depth=1e-4 * S.prepared.depth,
        force=1e-6 * S.prepared.force, force_noise=1e-6 * S.prepared.force_noise,
    )  # fmt: skip
    axes = plot.segments(small).axes
    assert [axes[0].get_ylabel(), axes[2].get_ylabel()] == ["compression, µm", "force, µN"]
    highest = max(line.get_ydata().max() for line in axes[2].get_lines())
    assert highest == pytest.approx(S.prepared.force.max())


def test_log_time_starts_within_the_ramp_even_if_sampling_slows_down_in_the_hold():
    kept = np.unique(np.round(np.geomspace(1, len(S.prepared.time) - 1, 400)).astype(int))
    sparse = replace(
        S.prepared, time=S.prepared.time[kept], displacement=S.prepared.displacement[kept],
        force=S.prepared.force[kept],
    )  # fmt: skip
    start, _ = plot.fit(S.fit, sparse).axes[1].get_xlim()
    assert start <= 0.1 * sparse.ramp_time


def test_a_fit_without_offset_is_drawn_without_one():
    bare = altered(S.fit, nuisance=())
    _, with_offset = fitted_force(S.fit, S.prepared)
    _, without = fitted_force(bare, S.prepared)
    assert without[0] == 0.0
    assert with_offset[0] == pytest.approx(S.fit.nuisance[0].value, rel=1e-3)


def test_several_depths_are_drawn_at_their_own_stiffness():
    at = AtDepth(
        depth=8e-3, k_inf=S.fit.model.k_inf, k_inf_se=0.1, k=S.fit.model.k, k_se=(0.1, 0.1)
    )
    several = altered(S.fit, by_depth=(replace(at, depth=4e-3, k_inf=100.0), at))
    assert np.array_equal(fitted_force(several, S.prepared)[1], fitted_force(S.fit, S.prepared)[1])
    shallow = replace(S.prepared, depth=4.2e-3)
    without_offset = altered(several, nuisance=())
    assert fitted_force(without_offset, shallow)[1].max() < 0.9 * S.prepared.force.max()


def test_fits_are_shown_once_per_number_of_arms_fewest_first():
    shown = fits_to_show(S.fit, (S.fit, *S.alternatives))
    assert [one.model.arms for one in shown] == [1, 2]


def test_the_spike_that_thinning_must_not_hide_is_drawn():
    force = np.array(S.prepared.force)
    force[7000] += 0.9
    figure = plot.fit(S.fit, replace(S.prepared, force=force))
    highest = max(line.get_ydata().max() for line in figure.axes[1].get_lines())
    assert highest == pytest.approx(force[7000], rel=1e-12)


def test_ramp_and_hold_are_shaded_where_they_are():
    ax = plot.segments(S.prepared).axes[0]
    spans = [patch.get_extents().transformed(ax.transData.inverted()) for patch in ax.patches]
    edges = sorted({round(float(edge), 6) for box in spans for edge in (box.x0, box.x1)})
    assert {0.0, 1.0} <= set(edges)
    assert max(edges) == pytest.approx(S.prepared.hold_end - S.prepared.onset)


# -- the solid --------------------------------------------------------------------------------


def test_stiffness_is_solid_where_identified_and_dashed_elsewhere(drawn):
    low, high = S.fit.band
    for ax in drawn["stiffness"].axes:
        solid = next(one for one in ax.get_lines() if one.get_label() == "relaxation fit")
        x, y = solid.get_xdata(), np.asarray(solid.get_ydata())
        assert np.array_equal(np.isfinite(y), (x >= low) & (x <= high))
        dashed = [
            one for one in ax.get_lines()
            if to_hex(one.get_color()) == BLUE.lower() and one.get_linestyle() == "--"
            and np.isnan(np.asarray(one.get_ydata(), dtype=float)).any()
        ]  # fmt: skip
        assert len(dashed) == 1
        together = np.isfinite(y) | np.isfinite(np.asarray(dashed[0].get_ydata()))
        assert together.all()


def test_stiffness_shows_newtons_per_millimetre(drawn):
    ax = drawn["stiffness"].axes[0]
    curve = next(one for one in ax.get_lines() if one.get_label() == "joint fit")
    at = curve.get_xdata()
    assert curve.get_ydata() == pytest.approx(1e-3 * S.joint.model.storage(2 * np.pi * at))


def test_a_solid_that_is_no_sum_of_arms_is_drawn_by_its_own_stiffness_and_by_its_arms():
    found = a_fit(SEAL)
    for ax, name, factor in zip(
        plot.stiffness(found).axes, ("storage", "loss", "loss_factor"), (1e-3, 1e-3, 1.0),
        strict=True,
    ):  # fmt: skip
        curve = next(one for one in ax.get_lines() if one.get_label() == "relaxation fit")
        x, y = curve.get_xdata(), np.asarray(curve.get_ydata())
        own = factor * getattr(SEAL, name)(2 * np.pi * x)
        assert y[np.isfinite(y)] == pytest.approx(own[np.isfinite(y)], rel=1e-12)
    stems = plot.spectrum(found).axes[0].collections[0].get_segments()
    assert len(stems) == SEAL.maxwell.arms == 49
    held = plot.dynamic_stiffness(S.direct, fit=found).axes[1]
    curve = next(one for one in held.get_lines() if one.get_label() == "relaxation fit")
    omega = 2 * np.pi * np.asarray(curve.get_xdata())
    assert curve.get_ydata() == pytest.approx(SEAL.loss(omega) / omega, rel=1e-12)
    when, force = fitted_force(found, replace(S.prepared, displacement_noise=0.0))
    assert force == pytest.approx(
        SEAL.force(when, S.prepared.displacement[: len(when)]), rel=1e-9, abs=1e-9
    )


def test_a_material_is_drawn_in_megapascals():
    t = np.geomspace(1e-3, 1e3, 100)
    found = fit_modulus(t, 1e6 * (1 + 2 * np.exp(-t / 0.1)))
    ax = plot.stiffness(found).axes[0]
    assert ax.get_ylabel() == "storage modulus E′, MPa"
    assert max(np.nanmax(line.get_ydata()) for line in ax.get_lines()) == pytest.approx(3.0, 0.01)
    stems = plot.spectrum(found).axes[0]
    assert stems.get_ylabel() == "modulus E, MPa"
    assert stems.get_ylim()[1] == pytest.approx(2.2, 0.1)


def test_a_very_wide_axis_has_few_numbers():
    figure = plot.spectrum(
        altered(S.fit, band=(1e-15, 1e3), parameters=(), covariance=np.zeros((0, 0)))
    )
    figure.canvas.draw()
    labels = [text for text in figure.axes[0].get_xticklabels() if text.get_text()]
    assert 2 <= len(labels) <= 8
    boxes = [text.get_window_extent() for text in labels]
    assert all(a.x1 < b.x0 for a, b in pairwise(boxes))


def test_stiffness_from_the_frf_is_drawn_with_its_scatter_where_it_is_good():
    figure = plot.stiffness(S.fit, measured=S.direct)
    for ax, band in zip(
        figure.axes, (S.direct.storage_band, *[S.direct.loss_band] * 2), strict=True
    ):
        (points,) = ax.containers
        x, y = points[0].get_data()
        assert len(x) >= 3
        assert band[0] <= x.min() < x.max() <= band[1]
        name = {0: "storage", 1: "loss", 2: "loss_factor"}[figure.axes.index(ax)]
        factor = 1.0 if name == "loss_factor" else 1e-3
        truth = factor * getattr(BROAD, name)(2 * np.pi * x)
        assert np.abs(y / truth - 1).max() < 0.2


def test_averaging_lines_shrinks_scatter_and_leaves_the_errors_of_phase_and_mass():
    storage, _, _ = quantities(S.direct)
    f, mean = averaged(S.direct.frequency, storage)
    assert len(f) < len(S.direct.frequency) / 3
    top = f > 20  # many lines in each bin
    at = np.interp(f[top], S.direct.frequency, storage.mass)
    assert mean.mass[top] == pytest.approx(at, rel=0.05)
    assert (mean.random[top] < 0.7 * np.interp(f[top], S.direct.frequency, storage.random)).all()
    truth = 1e-3 * BROAD.storage(2 * np.pi * f)
    assert np.sqrt(np.mean(((mean.value - truth) / mean.random) ** 2)) < 2.0


def test_spectrum_has_one_stem_per_arm_and_the_window_of_the_test(drawn):
    ax = drawn["spectrum"].axes[0]
    stems = [len(c.get_segments()) for c in ax.collections if hasattr(c, "get_segments")]
    assert stems == [S.fit.model.arms, S.joint.model.arms]
    box = ax.patches[0].get_extents().transformed(ax.transData.inverted())
    assert (box.x0, box.x1) == pytest.approx(
        tuple(1 / (2 * np.pi * f) for f in reversed(S.fit.band))
    )


# -- the hammer -------------------------------------------------------------------------------


def test_the_peaks_are_marked_where_they_are_and_named(drawn):
    ax = drawn["comparison"].axes[0]
    dots = {
        (float(one.get_xdata()[0]), float(one.get_ydata()[0]))
        for one in ax.get_lines()
        if one.get_marker() == "o"
    }
    c, joint = S.comparison, S.joint_comparison
    assert dots == {
        (c.measured_hz, c.measured_peak),
        (c.predicted_hz, c.predicted_peak),
        (joint.predicted_hz, joint.predicted_peak),
    }
    texts = [t.get_text() for t in ax.texts]
    assert f"{c.measured_hz:.2f} Hz, 155 (m/s²)/N" in texts[0]


def test_decibels_stand_on_the_right_of_the_same_magnitudes(drawn):
    ax = drawn["comparison"].axes[0]
    right = ax.child_axes[0]
    drawn["comparison"].draw_without_rendering()
    low, high = ax.get_ylim()
    assert right.get_ylabel() == "dB re 1 (m/s²)/N"
    shown = {
        float(tick.label1.get_text() or tick.label2.get_text()): right.transData.transform((0, at))[
            1
        ]
        for tick, at in zip(right.yaxis.get_major_ticks(), right.get_yticks(), strict=True)
    }
    assert len(shown) >= 3
    for level, height in shown.items():
        assert low <= 10 ** (level / 20) <= high
        assert height == pytest.approx(ax.transData.transform((1, 10 ** (level / 20)))[1], abs=0.01)


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


def test_phase_does_not_wrap_through_the_noise_of_an_accelerance(drawn):
    ax = drawn["frf"].axes[1]
    assert ax.get_ylim() == (-15, 195)
    lowest = phase_axis(ax, S.measured.value)
    assert np.abs(np.diff(turned(S.measured.value, lowest))).max() < 90


def test_an_frf_without_coherence_or_scatter_has_no_strip_for_it():
    bare = replace(S.measured, coherence=None, sd=None, averages=1)
    assert [ax.get_ylabel() for ax in plot.frf(bare).axes] == ["accelerance, (m/s²)/N", "phase, °"]


def test_an_frf_that_starts_at_zero_frequency_is_drawn_on_log_axes():
    frequency = np.concatenate(([0.0], S.measured.frequency))
    value = np.concatenate(([0.0], S.measured.value))
    from_zero = replace(S.measured, frequency=frequency, value=value, coherence=None, sd=None)
    figure = plot.frf(from_zero)
    plot.to_svg(figure)
    assert figure.axes[0].get_xlim()[0] > 0


def test_hits_of_an_undersampled_pulse_show_its_few_samples():
    one = slice(0, S.impact.starts[1], 10)
    few = replace(
        S.impact, time=S.impact.time[one], force=S.impact.force[one],
        acceleration=S.impact.acceleration[:, one], starts=(0,),
    )  # fmt: skip
    pulses, spectra, *_ = plot.hits(few, replace(S.measured, hits=())).axes
    assert all(len(line.get_xdata()) >= 6 for line in pulses.get_lines())
    assert spectra.get_xlim()[1] <= 0.5 * few.rate


def test_half_power_rings_give_the_damping():
    frequency = np.linspace(12.0, 13.4, 4001)
    value = predict_frf(2 * PAPER, mass=PAPER_MASS, frequency=frequency).value
    low, high = frequency[half_power(value)]
    assert high - low == pytest.approx(0.112747, rel=0.01)


def test_nyquist_axes_are_equal(drawn):
    assert drawn["nyquist"].axes[0].get_aspect() == 1.0


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


def test_rejected_hits_are_seen_and_named(drawn):
    pulses = drawn["hits"].axes[0]
    rejected = [one for one in pulses.get_lines() if one.get_color() == REJECTED.color]
    assert [one.get_label() for one in rejected] == ["hit 3: rejected"]
    assert rejected[0].get_xdata().max() > 60.0  # the second hit, 60 ms later, is in sight
    assert pulses.get_title(loc="left") == "4 of 5 hits accepted"


def test_words_from_a_file_are_not_read_as_mathematics():
    hostile = replace(S.impact, channels=(r"$\frac{", "加速度 \x07"))
    figure = plot.hits(hostile, S.measured)
    plot.to_svg(figure)
    markup = replace(S.impact, channels=("<img src=x>--><b>", "]]></svg>"))
    assert not re.search(r"<img|<b>|\]\]>", plot.to_svg(plot.hits(markup, S.measured)))
    assert figure.axes[2].get_title(loc="left") == r"\$\frac{"
    assert figure.axes[3].get_title(loc="left") == "□□□ □"
