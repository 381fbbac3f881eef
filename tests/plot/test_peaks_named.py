"""Peak labels of an FRF figure, and the valid band of a prediction."""

import numpy as np
import pytest
from kit import handmade

import dashpot as dp
from dashpot.plot.frf_figure import frf
from dashpot.plot.picture import Line, Span, Tag

S = handmade.study()


def tags(picture):
    return [item.text for item in picture.panels[0].marks if isinstance(item, Tag)]


def test_frf_figure_tags_peak_frequency_height_and_width():
    drawn = frf(S.measured, labels=("measured",))
    message, wide = tags(drawn)
    hz = S.measured.frequency[np.argmax(np.abs(S.measured.value))]
    assert float(message.split()[1]) == pytest.approx(hz, abs=0.2)
    assert message.endswith("1/kg")
    # the width at half the power, between lines of it, and drawn as wide
    size = np.abs(S.measured.value)
    above = S.measured.frequency[size >= size.max() / np.sqrt(2)]
    step = S.measured.frequency[1] - S.measured.frequency[0]
    assert float(wide.split()[0]) == pytest.approx(np.ptp(above) + step, abs=step)
    bar = next(
        curve for curve in drawn.panels[0].marks if isinstance(curve, Line) and len(curve.x) == 2
    )
    assert float(wide.split()[0]) == pytest.approx(np.ptp(bar.x), rel=0.05)
    # of several the first peak alone is named
    assert len(tags(frf(S.measured, S.measured, labels=("measured", "again")))) == 1


def test_the_end_of_a_band_is_no_peak():
    below = S.measured.band(1.0, 9.0)
    assert not tags(frf(below))
    # nor has a stiffness one
    assert not tags(frf(S.measured.to("dynamic_stiffness", mass=S.mass)))


@pytest.mark.parametrize("kind", ["receptance", "transmissibility"])
def test_other_kinds_are_drawn_without(kind):
    pred = dp.predict(S.fit, mass="114.8g", seals=2, base=kind == "transmissibility")
    result = pred.frf if kind == "transmissibility" else pred.frf.to(kind)
    assert not tags(frf(result, labels=("predicted",)))


def test_frf_figure_shades_the_valid_band_or_states_it():
    pred = dp.predict(S.fit, mass="114.8g", seals=2)
    upper = pred.plot().panels[0]
    assert "extrapolated" in upper.note
    assert not [item for item in upper.marks if isinstance(item, Span)]
    inside = frf(pred.frf, valid_band=(5.0, 20.0)).panels[0]
    (span,) = (item for item in inside.marks if isinstance(item, Span))
    assert (span.low, span.high) == (5.0, 20.0)
    assert not inside.note
