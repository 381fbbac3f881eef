"""A curve with a gap: what is claimed in its band holds the truth, arms in the gap included."""

from __future__ import annotations

import numpy as np
import pytest
from kit.curve_ends import fit_curve
from kit.foreign.curves import Curve
from kit.foreign.gaps import KINDS, generate_gapped_curves, measure_curve, off
from kit.foreign.truths import Solid

import dashpot as dp

#: over what is claimed; the lines of one band share their curve
CLAIMED = 1.0


def off_its_claim(fit: dp.Fit, curve: Curve) -> float:
    """The largest error over the band, over what the fit says of it."""
    lines = np.geomspace(*fit.band, 60)
    errors = off(curve.solid, lines, fit.solid.complex_stiffness(omega=2 * np.pi * lines))
    return max(error / claim for error, claim in zip(errors, fit._error_in_band, strict=True))


@pytest.mark.parametrize("kind", KINDS)
def test_no_curve_with_a_gap_is_used_with_the_truth_outside(kind: str) -> None:
    used = [
        (curve.name, off_its_claim(fit, curve))
        for curve in generate_gapped_curves(kind, 8, seed=43)
        for fit in [fit_curve(curve)]
        if fit.verdict.use == "use"
    ]
    assert len(used) >= 4
    assert not [name for name, error in used if error > CLAIMED]


@pytest.mark.parametrize("kind", KINDS)
def test_a_whole_curve_stays_in_use(kind: str) -> None:
    every = [
        (fit_curve(curve), curve) for curve in generate_gapped_curves(kind, 4, seed=44, whole=True)
    ]
    # of creep any record may hide a slow flow
    assert sum(fit.verdict.use == "use" for fit, _ in every) >= 3
    assert all(off_its_claim(*pair) <= CLAIMED for pair in every)


def test_the_band_of_a_modulus_ends_at_a_gap_that_hides_an_arm() -> None:
    """Three arms, and nothing between 10 ms and 3 s, where the middle one relaxes."""
    solid = Solid.arms("three", 10e6, (30e6, 40e6, 20e6), (0.02, 0.4, 6.0))
    random = np.random.default_rng(1)
    every = np.concatenate((np.linspace(2e-3, 10e-3, 30), np.geomspace(3.0, 60.0, 100)))
    fit = fit_curve(measure_curve("curve", "hole", solid, every, random))
    whole = fit_curve(
        measure_curve("curve", "no hole", solid, np.geomspace(2e-3, 60.0, 130), random)
    )
    assert fit.band[1] < 0.16 or fit.band[0] > 5.0
    assert whole.band[0] < 0.01
    assert whole.band[1] > 10
    assert (fit.verdict.use, whole.verdict.use) == ("use", "use")


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_of_many_curves_with_gaps_few_miss(kind: str) -> None:
    errors = [
        off_its_claim(fit, curve)
        for curve in generate_gapped_curves(kind, 60, seed=45)
        for fit in [fit_curve(curve)]
        if fit.verdict.use == "use"
    ]
    assert len(errors) >= 30
    assert np.mean(np.array(errors) > CLAIMED) <= 0.04
