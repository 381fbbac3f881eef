"""The whole story of a seal: from a relaxation test and a hammer test to one result."""

from __future__ import annotations

from dataclasses import dataclass

from dashpot.checks import Check
from dashpot.comparison import Comparison
from dashpot.relaxation.fit import Fit
from dashpot.relaxation.records import RampHold, RelaxationTest
from dashpot.solids.band import StiffnessBand
from dashpot.vibration.frf import FRF
from dashpot.vibration.records import ImpactTest


@dataclass(frozen=True)
class Study:
    """Everything the main job found, as values: what the report shows.

    Attributes
    ----------
    test, prepared : RelaxationTest, RampHold
        The relaxation test as recorded and as fitted.
    fit : Fit
        The chosen solid of one seal.
    alternatives : tuple of Fit
        The fits with one and with two arms, as in the paper's Fig. 4.
    hold_fit : Fit
        The same number of arms by the paper's eq. (5) on the hold alone.
    seals : float
        How many such seals (or how many times the tested length) carry the mass.
    mass : float or None
        kg; None if neither given nor inferred.
    mass_inferred : bool
        True if the mass was taken from the measured FRF, so that the frequency proves nothing.
    prediction : FRF or None
        Accelerance of the mass on the seals.
    impact : ImpactTest or None
    measured : FRF or None
        The FRF of the impact test.
    comparison : Comparison or None
    joint : Fit or None
        Relaxation and FRF fitted together.
    joint_prediction : FRF or None
    joint_comparison : Comparison or None
    parameter_band, unseen_band : StiffnessBand or None
        Of one seal: what the standard errors of `fit` allow, and what any non-negative
        spectrum allows that the relaxation test cannot reject.
    checks : tuple of Check
        What only the whole story shows.
    """

    test: RelaxationTest
    prepared: RampHold
    fit: Fit
    alternatives: tuple[Fit, ...]
    hold_fit: Fit | None
    seals: float
    mass: float | None
    mass_inferred: bool
    prediction: FRF | None
    impact: ImpactTest | None
    measured: FRF | None
    comparison: Comparison | None
    joint: Fit | None = None
    joint_prediction: FRF | None = None
    joint_comparison: Comparison | None = None
    parameter_band: StiffnessBand | None = None
    unseen_band: StiffnessBand | None = None
    checks: tuple[Check, ...] = ()
