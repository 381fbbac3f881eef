"""The other tests are what their formulas say, and a file of each is read as what it is."""

from __future__ import annotations

import numpy as np
import pytest
from kit.foreign.kinds import (
    KINDS,
    jenkins,
    nominal,
    rod_response,
    sheets,
    simulate_impact,
    simulate_response,
    wlf,
)
from kit.foreign.truths import Seal, Solid

from dashpot.reading.readers.inspect import inspect_file


def same(sheet, other):
    """To the byte."""
    pairs = zip(sheet.columns.values(), other.columns.values(), strict=True)
    return all(a.tobytes() == b.tobytes() for a, b in pairs)


@pytest.mark.parametrize("kind", KINDS)
def test_twenty_of_a_kind_repeat_and_half_are_spoilt(kind):
    made, ways = KINDS[kind]
    some = sheets(kind, 6)
    assert [sheet.spoilt != "" for sheet in some] == [False, True] * 3
    assert {sheet.spoilt for sheet in some} >= set(ways[:3])
    assert same(made(0), some[0])
    assert not same(some[0], some[2])
    for item in some:
        assert item.kind == kind
        assert len({len(column) for column in item.columns.values()}) == 1
        assert all(np.all(np.isfinite(column)) for column in item.columns.values())
    for way in ways:
        assert made(1, way).truth.keys() == made(1).truth.keys()
        spoilt, intact = made(1, way), made(1)
        assert not same(spoilt, intact) or spoilt.truth["stated"] != intact.truth["stated"]


@pytest.mark.parametrize(
    ("kind", "seen"),
    [
        ("impact", "impact"),
        ("frf", "frf"),
        ("rod", "transmissibility"),
        ("modulus", "modulus"),
        ("dma", "dma"),
        ("dma temperatures", "dma"),
        ("amplitude", "strain-sweep"),
        ("stress strain", "stress-strain"),
        ("indentation", "indentation"),
        # the columns of these are those of a relaxation test: the motion distinguishes them
        ("loops", "cyclic"),
        ("cld", "cld"),
        ("creep", "creep"),
    ],
)
def test_inspect_file_recognises_every_foreign_kind(kind, seen, tmp_path):
    path = tmp_path / "one.csv"
    path.write_text(KINDS[kind][0](0).text(), "utf-8")
    assert inspect_file(path).kind == seen


def test_a_system_answers_by_its_modes():
    """Two decays and an oscillation against closed forms, under a ramp and a hold."""
    t = np.arange(2001) / 100
    u = np.minimum(t, 1.0)
    response = simulate_response(
        (np.diag([-2.0, -1e-9]), np.array([1.0, 3.0]), np.ones(2), 0.5), u, 0.01
    )
    first = np.where(
        t < 1, t / 2 - (1 - np.exp(-2 * t)) / 4,
        0.5 + np.exp(-2 * t) * (1 - np.exp(2.0)) / 4,
    )  # fmt: skip
    second = 3 * np.where(t < 1, t**2 / 2, t - 0.5)
    np.testing.assert_allclose(response, 0.5 * u + first + second, rtol=1e-7, atol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_hits_are_the_accelerance(seed):
    sheet = KINDS["impact"][0](seed)
    seal, mass = sheet.truth["seal"], sheet.truth["mass"]
    lines = np.fft.rfftfreq(len(sheet["time"]), 1 / 2048)
    band = (lines > 4) & (lines < 40)
    hammer, variant = (np.fft.rfft(sheet.truth[name])[band] for name in ("hammer", "pure"))
    # an arm that is still at work when the record ends is cut
    expected = seal.accelerance(lines[band], mass, 2) * hammer
    assert np.max(np.abs(variant - expected)) < 2e-4 * np.abs(expected).max()


@pytest.mark.parametrize("seed", range(3))
def test_creep_is_the_inverse_of_relaxation(seed):
    sheet = KINDS["creep"][0](seed)
    force = sheet.truth["solid"].force(sheet.truth["pure"], 1 / 50)
    # the answer to a straight load bends within a step
    np.testing.assert_allclose(force, sheet.truth["force"], atol=2e-3 * force.max())
    assert np.abs(force - sheet.truth["force"])[100:].max() < 2e-4 * force.max()


def test_a_rods_response_is_that_of_the_domain():
    class Lossy:
        def stiffness(self, omega):
            return 1e6 * (1 + 0.1j)

    magnitude = np.abs(rod_response(Lossy(), [50, 100, 150, 200], 20e-3, 1000.0, 5.0))
    np.testing.assert_allclose(magnitude, [1.271252, 5.535471, 1.180417, 0.469645], rtol=1e-6)


def test_numbers_of_the_literature():
    assert jenkins(1e-3, 5e3, 2.0) == pytest.approx(1867.650 + 1527.887j, rel=1e-6)
    assert jenkins(1e-4, 5e3, 2.0) == pytest.approx(5e3)
    stresses = [nominal("mooney-rivlin", mode, 2.0, (0.15, 0.05)) for mode in MODES]
    assert stresses == pytest.approx([0.6125, 1.378125, 0.75])
    assert nominal("hyperfoam", "uniaxial", 0.6, (0.2, 8.0)) == pytest.approx(-0.0819337, rel=1e-6)
    assert wlf(253.15, 296.15, 6.943704, 129.6) == pytest.approx(3.44780, abs=1e-3)


MODES = ("uniaxial", "equibiaxial", "planar")


def test_ogdens_law_of_2_is_neo_hookes():
    x = np.linspace(0.6, 2.0, 15)
    for mode in MODES:
        item = nominal("ogden", mode, x, (0.3, 2.0))
        np.testing.assert_allclose(item, nominal("mooney-rivlin", mode, x, (0.15, 0.0)), atol=1e-14)


def test_foreign_ball_follows_hertz_and_loses_energy_on_rubber():
    mass, speed, k = 5e-3, 1.3, 2e5
    deep = (1.25 * mass * speed**2 / k) ** 0.4
    t, x, force = simulate_impact(Solid("", k, (), ()), mass, speed, 1e-6)
    assert x.max() == pytest.approx(deep, rel=1e-6)
    assert t[-1] == pytest.approx(2.94326 * deep / speed, abs=3e-6)
    np.testing.assert_allclose(force, k * np.maximum(x, 0) ** 1.5, atol=1e-5 * force.max())
    rubber = Solid.arms("", k / 2, [k / 2], [1e-3])
    (t, _, coarse), (fine_t, _, fine) = (
        simulate_impact(rubber, mass, speed, h) for h in (2e-6, 1e-6)
    )
    np.testing.assert_allclose(np.interp(t, fine_t, fine, right=0), coarse, atol=1e-5 * fine.max())
    # it comes back slower than it came
    assert 0.5 < np.sum(fine) * 1e-6 / mass / speed - 1 < 0.95


def test_foreign_cld_softens_and_a_slow_cycle_follows_the_law():
    sheet = KINDS["cld"][0](0)
    parts = np.array_split(sheet.truth["pure"], sheet.truth["cycles"])
    tops = [part.max() for part in parts]
    assert np.all(np.diff(tops) < 0)
    assert tops[-1] > 0.85 * tops[0]
    seal = sheet.truth["seal"]
    assert tops[0] > seal.solid.k_inf * seal.depth


def test_foreign_temperature_sweeps_form_one_curve():
    sheet = KINDS["dma temperatures"][0](1)
    solid, law = sheet.truth["solid"], sheet.truth["law"]
    kelvin = sheet["temperature"] + 273.15
    reduced = 2 * np.pi * sheet["frequency"] * 10 ** wlf(kelvin, *law)
    curve = kelvin / law[0] * solid.stiffness(reduced)
    np.testing.assert_allclose(sheet.truth["pure"], curve, rtol=1e-12)
    np.testing.assert_allclose(1e6 * sheet["storage"], curve.real, rtol=0.08)


def test_loops_hold_a_seal_and_its_sliders():
    sheet = KINDS["loops"][0](2)
    last = slice(-101, None)
    area = np.trapezoid(sheet.truth["pure"][last], 1e-3 * sheet["displacement"][last])
    seal = sheet.truth["seal"]
    solid = np.pi * seal.solid.stiffness(2 * np.pi * 5.0).imag * 4e-6
    dry = 4 * seal.friction / 5 * np.sum(2e-3 - 1e-4 * 2.0 ** np.arange(5))
    assert abs(area) == pytest.approx(solid + dry, rel=0.02)
    assert isinstance(seal, Seal)
