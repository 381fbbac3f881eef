"""The geometry factor of a part, from a resonance that was measured at some level."""

from __future__ import annotations

import pytest

from dashpot.solids.demo_seals import PAPER
from dashpot.workflow.frf_prediction import _part_factor
from dashpot.workflow.job import PartChoices


@pytest.mark.parametrize("softening", [0.0, 0.1, 0.4])
def test_a_factor_has_the_resonance_that_was_measured_at_its_level(softening: float) -> None:
    """A peak that falls with the level, the less the stiffer the part is."""

    def peak(solid: object, factor: float, mass: float) -> float:
        return 10.0 * (factor / (1 + softening / factor)) ** 0.5

    part_factor = _part_factor(
        PartChoices(resonance=14.0, resonance_mass=0.4), 14.0, PAPER, base=True, peak=peak
    )
    assert peak(PAPER, part_factor, 0.4) == pytest.approx(14.0, rel=1e-4)
