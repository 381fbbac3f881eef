"""Fits of drop tests by an independent generator, on specimens whose parameters are known."""

from __future__ import annotations

import numpy as np
import pytest
from kit.drop_relaxation import cubic, make_relaxation_fit
from kit.foreign.drop_tests import OTHER, WAYS, DropSet, Specimen, drop_set, impact_force
from kit.foreign.truths import Solid

import dashpot as dp
from dashpot.extensions.materials.drop.datamodel import DropFit
from dashpot.extensions.materials.drop.elastic_law import ElasticLawPrior
from dashpot.extensions.materials.drop.fit import fit_drop_tests


def fit_impacts(of: DropSet, seed: int, *, expected: bool) -> DropFit:
    """The fit of three impacts, of a law that is free or known to 1 %."""
    random, specimen = np.random.default_rng([seed, 77]), of.specimen
    tests = [
        dp.DropTest(time, force=force, units="s, N")
        for time, force in zip(of.time, of.force, strict=True)
    ]
    relaxation, law = make_relaxation_fit(specimen, random), ElasticLawPrior.without_law()
    if expected:
        c = np.array(specimen.c)
        sd = np.maximum(0.01 * c, 0.003 * c[0] / specimen.depth ** np.arange(3))
        off = c + sd * random.standard_normal(3)
        law = ElasticLawPrior(cubic(off, 1.3 * specimen.depth), np.diag(1 / sd))
    return fit_drop_tests(
        tests, mass=specimen.mass, drop=of.stated_speeds, relaxation=relaxation, law=law
    )


def test_the_generator_is_that_of_another_solver() -> None:
    solid = Solid.arms("", 1.0, (0.59796, 0.09058), (0.50212766, 16.41573034))
    clock, force = impact_force(Specimen(0.2, (240.0, 1e4, 3e6), solid, 0.01), 0.6)
    assert force.max() == pytest.approx(10.21478, rel=1e-5)
    assert clock[-1] == pytest.approx(46.48818e-3, abs=2.5e-5)


SHAPES = {
    "friction 2 %": "friction",
    "steep 10 %": "a law that is steeper than a cubic",
    "tilted 3 mm": "a contact at an angle",
    "rings at 300 Hz": "a ",  # keeps vibrating, and touches the specimen as at an angle
}
"""What is found of each way, in its first words."""


@pytest.mark.parametrize(
    "way", [item if item == "friction 2 %" else pytest.param(item, marks=pytest.mark.slow)
            for item in ("", *SHAPES)]
)  # fmt: skip
def test_unmodelled_force_of_specimen_or_sensor_is_marked(way: str) -> None:
    drop_fit = fit_impacts(drop_set(way, 2), 2, expected=False)
    (check,) = [check for check in drop_fit.checks if check.name == "impact_residual_structureless"]
    assert check.passed is (way == "")
    assert (drop_fit.verdict.use == "use") is (way == "")
    if way:
        assert f"is most like {SHAPES[way]}" in check.message


@pytest.mark.slow
def test_usable_drop_fits_cover_simulated_loss_factor() -> None:
    """Of specimens and sensors within the model and outside, 12 of each way."""
    used, missed, intact = 0, 0, 0
    for way in (*WAYS, "fractional"):
        for seed in range(100, 112):
            of = drop_set(way, seed)
            drop_fit = fit_impacts(of, seed, expected=bool(seed % 2))
            if drop_fit.verdict.use != "use":
                continue
            loss, peak = (
                drop_fit["loss_factor"],
                dp.predict(drop_fit.fit, drop=OTHER, mass=of.specimen.mass),
            )
            truth = of.specimen.loss_factor(drop_fit.frequency)
            held = loss.low < truth < loss.high and peak.answers[0].low < of.peak
            used, intact = used + 1, intact + (way == "")
            missed += not (held and of.peak < peak.answers[0].high)
    assert intact >= 0.6 * 12
    # of these 4 of 26, of the seeds by which the limit was set 6 of 82; 82 of 220 without the check
    assert missed <= 0.2 * used
