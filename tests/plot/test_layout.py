"""Layout of figures: round ticks, labels without overlap, exact curves."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from dashpot.plot.layout import (
    STRAIGHT_TOLERANCE,
    arrange_sheet,
    lay_out,
    simplify_line,
    text_width,
)
from dashpot.plot.picture import FIT, Line, Panel, Pen, Picture, Scale, Span, Tag
from dashpot.plot.ticks import format_ticks, numbers, place

LOW = st.floats(-1e6, 1e6)


def distance(point: np.ndarray, curve: np.ndarray) -> float:
    """Of a point from an unbroken line."""
    a, b = curve[:-1], curve[1:]
    chord = b - a
    size = np.maximum((chord**2).sum(axis=1), 1e-300)
    part = np.clip(((point - a) * chord).sum(axis=1) / size, 0, 1)
    return float(np.hypot(*(a + part[:, None] * chord - point).T).min())


@given(st.integers(0, 10_000), st.integers(2, 120), st.sampled_from([0.0, 0.02, 0.2, 20.0]))
def test_a_curve_less_what_is_straight_stays_within_a_hair(seed, size, noise):
    random = np.random.default_rng(seed)
    x = np.cumsum(random.uniform(0.0, 3.0, size))
    y = 40 * np.sin(x / 30) + noise * random.standard_normal(size)
    points = np.column_stack([x, y])
    selected = simplify_line(points)
    assert np.array_equal(selected[[0, -1]], points[[0, -1]])
    assert max(distance(point, selected) for point in points) <= 8 * STRAIGHT_TOLERANCE + 1e-9


def test_a_straight_line_keeps_few_points_and_a_spike_stays():
    line = np.column_stack([np.arange(1001.0), np.arange(1001.0) / 7])
    assert len(simplify_line(line)) < 1001 / 2**4
    line[500, 1] += 5.0
    assert line[500].tolist() in simplify_line(line).tolist()


@given(LOW, st.floats(1e-6, 1e6), st.floats(60, 900))
def test_an_even_axis_has_two_round_numbers_or_more_inside_its_limits(low, span, length):
    assume(span > 1e-6 * abs(low))
    axis = Scale("x, s", (low, low + span))
    result = numbers(axis, length, 40.0)
    assert len(result) >= 2
    assert all(low - 1e-6 * span <= v <= low + span * (1 + 1e-6) for v in result)
    steps = np.diff(result)
    assert steps == pytest.approx(np.full(len(steps), steps[0]), rel=1e-3)
    mantissa = steps[0] / 10 ** math.floor(math.log10(steps[0]) + 1e-9)
    assert min(abs(mantissa - m) for m in (1, 2, 2.5, 5, 10)) < 1e-2
    assert len(set(format_ticks(axis, result))) == len(result)


@given(st.floats(-9, 6), st.floats(0.05, 12), st.floats(120, 900))
def test_logarithmic_axis_ticks_lie_inside_limits_with_clearance(low, decades, length):
    axis = Scale("f, Hz", (10**low, 10 ** (low + decades)), log=True)
    result = numbers(axis, length, 46.0)
    assert all(axis.limits[0] * (1 - 1e-6) <= v <= axis.limits[1] * (1 + 1e-6) for v in result)
    assert len(result) >= 2
    # a few short numbers stand closer: two or three say little of an axis
    separate = np.diff(length * place(axis, result)).min()
    assert len(result) == 2 or separate >= 0.7 * 46.0 * (1 - 1e-9)
    assert len(result) == 2 or separate >= 46.0 * (1 - 1e-9) or result[0] >= 1e-2


@pytest.mark.parametrize(
    "limits", [(6.0, 30.0), (2.0, 600.0), (0.01, 100.0), (5.8, 27.0), (0.004, 250.0)]
)
@pytest.mark.parametrize("length", [280.0, 780.0])
def test_a_logarithmic_axis_of_a_panel_has_five_numbers(limits, length):
    assert len(numbers(Scale("f, Hz", limits, log=True), length, 46.0)) >= 5


def test_words_at_two_peaks_side_by_side_are_clear_of_each_other_and_inside():
    """As a prediction that agrees: both peaks at one place, both named."""
    x = np.geomspace(6.0, 30.0, 50)
    tags = [Tag(12.71, 155.0, "measured 12.71 Hz, 155 1/kg", "measured", "filled", bold=True),
            Tag(12.70, 157.0, "predicted 12.70 Hz, 157 1/kg", "fit", "hollow")]  # fmt: skip
    axes = Scale("f, Hz", (6.0, 30.0), log=True), Scale("a, 1/kg", (2.0, 300.0), log=True)
    for width in (350.0, 728.0):
        (frame,) = lay_out((Panel(*axes, (Line(x, x, FIT), *tags)),), width).frames
        boxes = []
        for word in frame.labels:
            if word.halo:
                wide = text_width(word.text, bold=word.bold)
                remaining = word.x - (wide if word.anchor == "end" else 0)
                boxes.append((remaining, remaining + wide, word.y - 12, word.y))
        (a, b), (remaining, top, wide, _) = boxes, frame.box
        assert a[1] < b[0] or b[1] < a[0] or a[3] < b[2] or b[3] < a[2]
        for box in boxes:
            assert remaining - 2 <= box[0]
            assert box[1] <= remaining + wide + 14
            assert box[2] >= top - 4


WIDE = Scale("f, Hz", (1.0, 100.0), log=True)


def words_of(panel, width, **how):
    sheet = arrange_sheet(Picture("one", "One.", ((panel,),), 1, width=width, **how))
    return sheet, [
        label for strip in sheet.strips for f in strip.layout.frames for label in f.labels
    ]


def ends_of(word):
    wide = text_width(word.text, bold=word.bold)
    remaining = word.x - {"start": 0.0, "middle": 0.5, "end": 1.0}[word.anchor] * wide
    return remaining, remaining + wide


def test_a_note_that_is_wider_than_its_axes_stands_above_their_name():
    note = "valid from 0.004 to 0.32 Hz: all of this is extrapolated"
    panel = Panel(
        WIDE, Scale("accelerance, 1/kg", (1.0, 100.0), log=True), (), note=note, height=100
    )
    _, wide = words_of(panel, 800.0)
    _, narrow = words_of(panel, 300.0)
    name = next(item for item in wide if item.text == "accelerance, 1/kg")
    assert [item.y for item in wide if item.text == note] == [name.y]
    name = next(item for item in narrow if item.text == "accelerance, 1/kg")
    lines = [item for item in narrow if item.text in note]
    assert " ".join(line.text for line in lines) == note
    assert all(line.y < name.y for line in lines)
    assert all(ends_of(line)[0] >= 0 for line in lines)


def test_tag_without_space_wraps_and_keeps_its_unit():
    f = np.geomspace(1.0, 100.0, 400)
    tag = Tag(12.0, 100.0, "measured 12.71 Hz, 155 1/kg", "measured", "filled")
    curve = Line(f, 100.0 / (1 + 30 * np.abs(np.log(f / 12.0))), Pen("fit", 2.0))
    panel = Panel(WIDE, Scale("y", (1.0, 200.0), log=True), (curve, tag), height=200)
    _, wide = words_of(panel, 800.0)
    _, narrow = words_of(panel, 210.0)
    assert tag.text in {item.text for item in wide}
    assert "measured 12.71 Hz," in {item.text for item in narrow}
    assert "155 1/kg" in {item.text for item in narrow}


def test_two_numbers_of_an_axis_are_made_more_where_they_are_short():
    assert numbers(Scale("t, s", (1.03, 3.33)), 208.0, 46.0) == (1.5, 2.0, 2.5, 3.0)
    assert len(numbers(Scale("t, s", (10301.03, 10303.33)), 208.0, 46.0)) == 2


@pytest.mark.parametrize("low", [True, False])
def test_a_name_stands_on_the_side_that_is_not_hatched(low):
    middle = 10.0
    span = Span(*((1.0, middle) if low else (middle, 100.0)), "away", "", True, 1.0)
    tag = Tag(middle, 10.0, "16.4 s", "fit", "filled")
    panel = Panel(WIDE, Scale("y", (1.0, 100.0), log=True), (span, tag), height=200)
    (frame,) = lay_out((panel,), 400.0).frames
    ((left, right),) = (ends_of(label) for label in frame.labels if label.text == tag.text)
    edge = frame.box.x + frame.box.width / 2
    assert left > edge if low else right < edge


def test_a_stamp_ends_where_its_sheet_does():
    stamp = "SIMULATED  ·  depth_4mm.csv, depth_6mm.csv, depth_8mm.csv  ·  114.8 g on 2 seals"
    panel = Panel(WIDE, Scale("y", (1.0, 200.0), log=True), (), height=100)
    item, _ = words_of(panel, 800.0, stamp=stamp)
    several, _ = words_of(panel, 300.0, stamp=stamp)
    assert [word.text for word in item.labels] == [stamp]
    assert len(several.labels) > 1
    assert max(ends_of(word)[1] for word in several.labels) <= 300.0
    assert several.labels[-1].y < several.height


@given(st.integers(1, 400), st.floats(150, 1200))
def test_axis_of_counts_has_integer_ticks(count, length):
    axis = Scale("seals", (0.5, count + 0.5), whole=True)
    result = numbers(axis, length, 46)
    assert all(item == round(item) for item in result)
    assert result
    assert all("." not in word for word in format_ticks(axis, result))
