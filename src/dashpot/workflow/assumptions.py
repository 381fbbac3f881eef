"""Assumptions of results: which checks watch them, and what lifts them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from dashpot.base.checks import Check


@dataclass(frozen=True)
class Assumption:
    """Assumption of a result on the seal or the tests.

    Attributes
    ----------
    name : str
        Two or three words.
    holds : str
        What is supposed.
    otherwise : str
        What a result is worth where it does not hold, with numbers where they were measured.
    checks : tuple of str
        Names of the checks that fail where a record shows that it does not hold.
    options : tuple of str
        Options of the command line that make it unnecessary.
    advice : str
        What to do on the bench.
    """

    name: str
    holds: str
    otherwise: str
    checks: tuple[str, ...]
    options: tuple[str, ...]
    advice: str

    def state(self, checks: Iterable[Check]) -> Literal["doubted", "not contradicted", "unwatched"]:
        """Return the state of the assumption by the checks of a study."""
        answers = [check.passed for check in checks if check.name in self.checks]
        if False in answers:
            return "doubted"
        return "not contradicted" if True in answers else "unwatched"


ASSUMPTIONS = (
    Assumption(
        "linear in time",
        "The relaxation at every depth has one shape: the force is the sum of the answers to all "
        "earlier motion (Boltzmann), or to an elastic law of it (Fung).",
        "Arms follow the ramp instead of the material; the hold and the whole record then give "
        "different solids. A seal that flows as a power of its force shows in no single ramp: a "
        "vibration then peaked 1.2 to 17 times above the upper limit.",
        ("hold_and_full_agree", "depth_and_time_separable", "residuals_white", "residuals_steady"),
        ("--elastic by-depth", "--method"),
        "Test several depths and ramp times, and strike the seal with a hammer.",
    ),
    Assumption(
        "elastic law",
        "The relaxed force is proportional to the compression, or follows the law that was fitted.",
        "The test gives the secant, vibration feels the tangent: for two quadratic laws 19 % too "
        "much and 77 % too little stiffness at the depth of the test.",
        (
            "ramp_residual_small",
            "ramp_explained",
            "tangent_determined",
            "strain_small",
            "depth_and_time_separable",
            "operating_point",
        ),
        ("--elastic", "--elastic by-depth", "--compression"),
        "Test at the compression of the installed seal, and at half and twice of it.",
    ),
    Assumption(
        "small vibration",
        "The part moves so little about one compression that stiffness and damping do not depend "
        "on how much.",
        "Filled rubber softens with amplitude (Payne), most in its loss: a hammer that hits twice "
        "as hard finds another seal.",
        ("operating_point", "amplitude_linear", "hits_agree", "tests_agree"),
        ("--compression",),
        "Hit at several heights; vibrate as much as the car does.",
    ),
    Assumption(
        "isothermal",
        "Every test stands at one temperature, and the use is at that; tests at several are of one "
        "solid whose arms all shift alike.",
        "Rubber near its glass transition shifts by a decade of frequency in some 10 K. Arms below "
        "0.1 s that shift 0.8 times as far put the loss factor of a seal tested at 23 and 0 degC "
        "14 % off.",
        (
            "force_relaxes",
            "same_specimen",
            "data_agree",
            "temperature_steady",
            "temperature_tested",
            "shift_monotone",
            "stiffness_of_one_seal",
            "thermorheologically_simple",
        ),
        ("--temperature",),
        "Let the seal rest at the temperature of the test, and write that down; test it at three "
        "temperatures, and fit them together.",
    ),
    Assumption(
        "conditioned rubber",
        "The seal has been pressed deeper before, and is not softened by the test itself (Mullins, "
        "set).",
        "A first loading is stiffer than all that follow, and its ramp than its hold.",
        ("overshoot_small", "same_specimen"),
        (),
        "Press three to five times to the full depth, wait, then test.",
    ),
    Assumption(
        "known history",
        "The seal starts from rest, or what was pressed before is on record and is followed.",
        "What it still relaxes from an earlier loading is taken for drift or for the slowest arm.",
        (
            "preload_absent",
            "baseline_recorded",
            "single_loading",
            "contact_found",
            "history_explained",
            "face_recovered",
            "earlier_loading_negligible",
        ),
        ("--machine rest=",),
        "Rest ten times the longest hold before, and record a second or more of that rest.",
    ),
    Assumption(
        "one seal",
        "Tests that are fitted together are of one seal, each given once.",
        "Two lots give the mean of both, which neither is; a record given twice shrinks every "
        "error by 1.4.",
        ("same_specimen", "mass_plausible"),
        (),
        "Name files by specimen.",
    ),
    Assumption(
        "synchronous clocks",
        "Force and displacement are sampled at the same instants, with no filter in one alone.",
        "A delay d looks like a loss of -omega d: 1 ms is 0.08 of loss factor at 12.7 Hz; a "
        "first-order filter of 10 Hz in the force takes 24 % of the loss of the paper's seal "
        "there.",
        ("clocks_agree", "delay_plausible"),
        ("--machine sync=", "--machine force-filter="),
        "Record both channels on one converter, unfiltered.",
    ),
    Assumption(
        "rigid machine",
        "The recorded displacement is the compression of the seal.",
        "A machine that gives 50 um/N takes 1 % off k_inf; a crosshead that creeps on unseen by "
        "0.3 % of the depth puts the slowest arm a tenth off.",
        ("motion_measured", "hold_is_still", "depth_resolved"),
        ("--machine compliance=",),
        "Press steel on steel for the compliance; put a gauge at the seal.",
    ),
    Assumption(
        "motion seen",
        "The samples follow the motion between them.",
        "An axis that steps between samples leaves fast arms that are not there: up to ten times "
        "the loss at 12.7 Hz.",
        ("motion_resolved", "samples_unbroken", "ramp_sampled"),
        (),
        "Sample at ten times the rate of the set-points, or faster.",
    ),
    Assumption(
        "steady load cell",
        "The zero of the force is that before contact, and drifts as little as is said.",
        "Drift and the slowest arm look alike: 0.2 mN/s unheeded put k_2 7 % and tau_2 8 % off.",
        (
            "offset_plausible",
            "drift_plausible",
            "baseline_agrees",
            "k_inf_plausible",
            "baseline_recorded",
            "drift_distinguished_from_arm",
        ),
        ("--machine drift=",),
        "Record a baseline as long as can be; warm the amplifier up.",
    ),
    Assumption(
        "calibrated sensors",
        "Load cell, encoder and accelerometer read as much as there is.",
        "A force that reads 5 % too much is 5 % of every stiffness, and no single test shows it: "
        "of 11 such records called *use*, 10 missed the stiffness after the hold.",
        (
            "gain_plausible",
            "mass_plausible",
            "high_frequency_mass_agrees",
            "hammer_agrees_with_relaxation_test",
        ),
        (),
        "Hang a known mass on the load cell before the test; add a hammer test on a block that was "
        "weighed.",
    ),
    Assumption(
        "rigid block",
        "The mass under the hammer moves as one, along one axis, and is weighed with all it "
        "carries.",
        "1 % of mass is 0.5 % of the natural frequency; rocking adds a second peak.",
        ("high_frequency_mass_agrees", "mass_plausible", "rocking_cancelled", "hits_centred"),
        ("--combine", "--mass-sd", "--seal-mass"),
        "Two accelerometers, and a hit through the middle.",
    ),
    Assumption(
        "positive arms",
        "The solid only stores and dissipates: every arm has a positive stiffness.",
        "Friction, adhesion or an active element is turned into arms, or is not followed at all.",
        ("k_inf_positive", "loss_positive", "kramers_kronig", "residuals_white"),
        ("--dashpot",),
        "Unload as slowly as you loaded: what does not come back is friction.",
    ),
    Assumption(
        "arms in the window",
        "What matters relaxes neither much faster than the ramp nor much slower than the hold.",
        "Stiffness and loss outside the informed band are an extrapolation; k_inf is the stiffness "
        "at the end of the hold less what is still to come.",
        ("valid_band_exists", "inside_valid_band", "fast_arm_visible", "hold_long_enough"),
        (),
        "Ask `dashpot plan` before the test; add a hammer test.",
    ),
)
