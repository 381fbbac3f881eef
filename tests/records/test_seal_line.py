"""A seal along a line: its pieces add up, and what no line can be is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from kit.fits import a_fit, altered

from dashpot.base.errors import DataError
from dashpot.records.seal_line import Joint, SealLine, SealSection
from dashpot.records.specimen import Specimen
from dashpot.solids.elastic import ElasticLaw
from dashpot.solids.table_1 import BROAD

DOOR = [(0, 0, 0), (1.1, 0, 0), (1.1, 1.2, 0), (0, 1.2, 0), (0, 0, 0)]


@given(st.floats(0.003, 4.6), st.floats(0, 4.6), st.floats(1e-3, 4.6), st.floats(0, 5))
def test_the_stations_carry_the_whole_line(pitch, at, length, factor):
    """The sum of factor times length is the length of the line, with what its joints add."""
    line = SealLine(DOOR, joints=(Joint(at, length, factor),))
    stations = line.stations(pitch)
    assert line.closed
    assert stations.length.sum() == pytest.approx(4.6)
    carried = float(stations.factor @ stations.length)
    assert carried == pytest.approx(4.6 + (factor - 1) * length, rel=1e-9)


def test_a_joint_at_the_end_of_an_open_line_lies_half_on_it():
    stations = SealLine(DOOR[:3], joints=(Joint(0.0, 0.1, 3.0),)).stations(0.025)
    assert stations.factor.tolist()[:3] == pytest.approx([3, 3, 1])
    assert stations.factor[-1] == 1


def test_compression_and_normal_are_straight_between_the_points():
    line = SealLine(DOOR[:2], [0.004, 0.008], normal=[(0, 0, 1), (0, 3, 0)])
    stations = line.stations(0.275)
    assert stations.along == pytest.approx([0.1375, 0.4125, 0.6875, 0.9625])
    assert stations.compression == pytest.approx([0.0045, 0.0055, 0.0065, 0.0075])
    assert np.linalg.norm(stations.normal, axis=1) == pytest.approx(1)
    assert stations.normal[0] == pytest.approx(np.array([0, 1, 7]) / np.sqrt(50))


def test_a_section_is_what_was_tested_over_its_length():
    """Force and tangent of a metre are those of the piece over its length, at any compression."""
    law = ElasticLaw((0.0, 0.004, 0.008), (0.5, 0.9, 1.7), 200.0)
    fit = altered(a_fit(BROAD), elastic_law=law, specimen=Specimen(length=0.1))
    section = SealSection.of(fit)
    x = np.array([0.0, 0.002, 0.006, 0.008])
    assert section.solid.k_inf == pytest.approx(10 * fit.solid.k_inf)
    assert section.factor(x) == pytest.approx(law.factor(x))
    assert section.factor(-1e-9) == section.force(-1e-9) == 0
    assert SealSection.of(fit, length="50mm").solid.k_inf == pytest.approx(20 * fit.solid.k_inf)
    slope = (section.force(x + 1e-7) - section.force(x - 1e-7))[1:3] / 2e-7
    assert slope == pytest.approx(section.solid.k_inf * section.factor(x[1:3]), rel=1e-6)
    with pytest.raises(DataError, match="was tested is not known"):
        SealSection.of(altered(fit, specimen=Specimen()))


@pytest.mark.parametrize(
    ("made", "sentence"),
    [
        (lambda: SealLine([(0, 0, 0)]), "at least two points"),
        (lambda: SealLine([(0, 0, 0), (0, 0, 0)]), "point 1 of the seal line repeats"),
        (lambda: SealLine([(0, 0, 0), (1, 0, np.nan)]), "point 1 of the seal line is not"),
        (lambda: SealLine(DOOR[:2]).stations(0.0), "pitch = 0.0"),
        (lambda: SealLine(DOOR[:2]).stations("2m"), "pitch = '2m' on a seal line of 1.1 m"),
        (lambda: SealLine(DOOR[:2], normal=(0, 0, 0)), "no direction"),
        (lambda: SealLine(DOOR[:2], normal=[(0, 0, 1), (0, 0, -1)]), "points 0 and 1 .* 180 deg"),
        (lambda: SealLine(DOOR[:2], normal=[(0, 0, 1)]), r"2 points; found shape \(1, 3\)"),
        (lambda: SealLine(DOOR[:2], [1.0, 2.0, 3.0]), r"2 points; found shape \(3,\)"),
        (lambda: SealLine(DOOR[:2], np.nan), "one finite number"),
        (lambda: SealLine(DOOR[:2], joints=(Joint(1.2, 0.1, 1.0),)), "is not on the seal line"),
        (lambda: SealLine(DOOR[:2], joints=(Joint(1.0, 0.1, -1.0),)), "joint: factor = -1"),
    ],
)
def test_what_a_seal_line_cannot_be(made, sentence):
    with pytest.raises(DataError, match=sentence):
        made()


def test_a_section_may_be_a_bare_solid():
    line = SealLine(DOOR, section=20 * BROAD)
    assert line.section == SealSection(20 * BROAD)
    assert replace(line, compression=0.006) != line


@pytest.mark.parametrize(
    ("points", "pieces"),
    [
        ([(0, 0, 0), (1, 1, 0), (1, 0, 0), (0, 1, 0)], "from point 0 meets the one from point 2"),
        ([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0.5, 0, 0)], "from point 0 meets the one from point 2"),
        ([(0, 0, 0), (2, 0, 0), (2, 1, 0), (1, 0, 0), (0, 0, 0)], "crosses itself"),
    ],
)
def test_a_seal_line_that_crosses_itself_is_refused(points, pieces):
    with pytest.raises(DataError, match=pieces):
        SealLine(points)


def test_a_closed_or_a_passing_seal_line_is_no_crossing():
    assert SealLine([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 0)]).length == 4
    SealLine([(0, 0, 0), (1, 1, 0), (1, 0, 0.1), (0, 1, 0.1)])  # passes 50 mm above itself


@given(st.integers(3, 12), st.floats(0.1, 5.0))
def test_a_convex_loop_never_crosses_itself(corners: int, size: float):
    angle = 2 * np.pi * np.arange(corners + 1) / corners
    loop = size * np.column_stack((np.cos(angle), np.sin(angle), 0.2 * np.cos(3 * angle)))
    assert len(SealLine(loop).stations(size / 50).length) > 0
