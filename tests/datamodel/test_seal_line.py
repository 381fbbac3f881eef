"""A seal along a line: its pieces add up, and what no line can be is refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from kit.fits import a_fit, replace_fields

from dashpot.base.errors import DataError
from dashpot.datamodel.seal_line import SealSection, Shear
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.systems.door.seal_line import Joint, SealLine
from dashpot.solids.demo_seals import BROAD
from dashpot.solids.elastic import ElasticLaw

DOOR = [(0, 0, 0), (1.1, 0, 0), (1.1, 1.2, 0), (0, 1.2, 0), (0, 0, 0)]


@given(st.floats(0.003, 4.6), st.floats(0, 4.6), st.floats(1e-3, 4.6), st.floats(0, 5))
def test_the_stations_carry_the_whole_line(pitch, at, length, factor):
    """The sum of factor times length is the length of the line, with what its joints add."""
    line = SealLine(DOOR, joints=(Joint(at, length, factor),))
    stations = line.stations(pitch)
    assert line.is_closed
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
    gauss = 0.275 / np.sqrt(3)
    part = np.array([0.275 - gauss, 0.275 + gauss, 0.825 - gauss, 0.825 + gauss]) / 1.1
    assert stations.along == pytest.approx(1.1 * part)
    assert stations.length == pytest.approx(0.275)
    assert stations.compression == pytest.approx(0.004 + 0.004 * part)
    assert np.linalg.norm(stations.normal, axis=1) == pytest.approx(1)
    size = np.hypot(part, 1 - part)
    assert stations.normal[:, 1:] == pytest.approx(np.stack((part, 1 - part), 1) / size[:, None])
    assert stations.tangent == pytest.approx(np.tile([1.0, 0, 0], (4, 1)))
    assert line.normal_at(0.55) == pytest.approx([0, np.sqrt(0.5), np.sqrt(0.5)])


def test_no_cell_reaches_over_a_corner_a_joint_or_the_end_of_a_long_straight_piece():
    """A quarter of a circle in points 13 mm apart is one curve; what it joins is not."""
    angle = np.linspace(0, np.pi / 2, 13)
    arc = 0.1 * np.column_stack((np.sin(angle), 1 - np.cos(angle), 0 * angle))
    points = [(-0.5, 0, 0), *arc, (0.1, 0.6, 0)]
    line = SealLine(points, joints=(Joint(0.2, 0.02, 3.0),))
    stations = line.stations(0.025)
    # 0.19 m before the joint, its 0.02 m, 0.29 m behind it; 0.157 m of curve; 0.5 m
    cells = [(0.19, 4), (0.02, 1), (0.29, 6), (float(line.arc_length[-2]) - 0.5, 3), (0.5, 10)]
    halves = np.concatenate([np.full(2 * count, span / count / 2) for span, count in cells])
    assert stations.length == pytest.approx(halves)
    assert stations.factor[stations.along < 0.19] == pytest.approx(1)
    assert stations.factor[(stations.along > 0.19) & (stations.along < 0.21)] == pytest.approx(3)
    sharp = SealLine([(0, 0, 0), (0.03, 0, 0), (0.03, 0.03, 0)]).stations(0.025)
    assert sharp.length == pytest.approx(0.015)


@pytest.mark.parametrize(("turn", "cells"), [(29.0, 1), (31.0, 2)])
def test_a_corner_turns_by_more_than_30_degrees(turn, cells):
    a = np.radians(turn)
    line = SealLine([(0, 0, 0), (0.02, 0, 0), (0.02 + 0.02 * np.cos(a), 0.02 * np.sin(a), 0)])
    assert len(line.stations(0.02).length) == 2 * cells


@pytest.mark.parametrize(("sine", "refused"), [(0.0101, False), (0.0099, True)])
def test_seal_line_refuses_a_normal_along_the_line(sine, refused):
    normal = (np.sqrt(1 - sine**2), 0, sine)
    if not refused:
        frame = SealLine(DOOR[:2], normal=normal).stations(0.5)
        assert frame.tangent[0] == pytest.approx([sine, 0, -np.sqrt(1 - sine**2)])
        assert frame.across[0] == pytest.approx([0, 1, 0])
        return
    with pytest.raises(DataError, match="runs along its own normal from point 0 to 1"):
        SealLine(DOOR[:2], normal=normal)


@pytest.mark.parametrize(("ratio", "refused"), [(0.0, False), (3.0, False), (3.01, True),
                                                (-0.01, True)])  # fmt: skip
def test_shear_is_a_ratio(ratio, refused):
    if refused:
        with pytest.raises(DataError, match=r"shear: along = .* expected 0 to 3 of the stiffness"):
            Shear(along=ratio)
    else:
        assert Shear(along=ratio).holds == (ratio > 0)


def test_separate_shear_stiffness_acts_wherever_the_seal_touches():
    """A ratio follows the tangent at the compression; a stiffness of its own only the joints."""
    law = ElasticLaw((0.0, 0.004, 0.008), (0.5, 0.9, 1.7), 100.0)
    section = SealSection(100.0 / BROAD.k_inf * BROAD, law, shear=Shear(0.5, 3 * BROAD))
    line = SealLine(DOOR[:2], [-0.002, 0.006], joints=(Joint(1.0, 0.2, 2.0),))
    stations = line.stations(0.01)
    pressed, across, along = section.ways(stations)
    assert across.share == pytest.approx(0.5 * pressed.share)
    touches = stations.along > 1.1 / 4
    assert along.share == pytest.approx(stations.length * stations.factor * touches)
    assert along.solid == 3 * BROAD


def test_a_section_is_what_was_tested_over_its_length():
    """Force and tangent of a metre are those of the piece over its length, at any compression."""
    law = ElasticLaw((0.0, 0.004, 0.008), (0.5, 0.9, 1.7), 200.0)
    fit = replace_fields(a_fit(BROAD), elastic_law=law, specimen=Specimen(length=0.1))
    section = SealSection.from_fit(fit)
    x = np.array([0.0, 0.002, 0.006, 0.008])
    assert section.solid.k_inf == pytest.approx(10 * fit.solid.k_inf)
    assert section.factor(x) == pytest.approx(law.factor(x))
    assert section.factor(-1e-9) == section.force(-1e-9) == 0
    assert SealSection.from_fit(fit, length="50mm").solid.k_inf == pytest.approx(
        20 * fit.solid.k_inf
    )
    slope = (section.force(x + 1e-7) - section.force(x - 1e-7))[1:3] / 2e-7
    assert slope == pytest.approx(section.solid.k_inf * section.factor(x[1:3]), rel=1e-6)
    with pytest.raises(DataError, match="specimen of seal is not known"):
        SealSection.from_fit(replace_fields(fit, specimen=Specimen()))


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
        (lambda: SealLine(DOOR[:2], normal=[(0, 0, 1)] * 3), r"them; found shape \(3, 3\)"),
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
