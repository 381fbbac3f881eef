"""Assumptions of results: the checks of them, and the tests that remove them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from dashpot.base import dataclass
from dashpot.base.checks import Check


@dataclass(frozen=True)
class Assumption:
    """Assumption of a result on the seal or the tests.

    Attributes
    ----------
    name : str
        Two or three words.
    holds : str
        The assumption, as a sentence.
    otherwise : str
        Effect on the result if violated, with measured numbers if available.
    checks : tuple of str
        Names of the checks that fail where a record shows that it does not hold.
    options : tuple of str
        Options of the command line that make it unnecessary.
    advice : str
        Test that removes it.
    """

    name: str
    holds: str
    otherwise: str
    checks: tuple[str, ...]
    options: tuple[str, ...]
    advice: str

    def state(
        self, checks: Iterable[Check]
    ) -> Literal["contradicted", "not contradicted", "not tested"]:
        """Return the state of the assumption by the checks of a study."""
        outcomes = [check.passed for check in checks if check.name in self.checks]
        if False in outcomes:
            return "contradicted"
        return "not contradicted" if True in outcomes else "not tested"


ASSUMPTIONS = (
    Assumption(
        "linear in time",
        "The relaxation has the same shape at every depth: the force is the superposition of the "
        "responses to all earlier motion (Boltzmann), or to its elastic force (Fung).",
        "The arms fit the ramp instead of the material; the hold and the whole record then give "
        "different models. No single ramp shows a seal that flows with a power of its force: in "
        "simulations the resonance peak was then 1.2 to 17 times above the upper limit.",
        ("hold_and_full_agree", "depth_and_time_separable", "residuals_white", "residuals_steady"),
        ("--elastic by-depth", "--method"),
        "Test several depths and ramp times, and strike the seal with a hammer.",
    ),
    Assumption(
        "elastic law",
        "The relaxed force is proportional to the compression, or follows the fitted elastic law.",
        "The test gives the secant, vibration depends on the tangent: for two quadratic laws the "
        "stiffness at the depth of the test was 19 % too high and 77 % too low.",
        (
            "ramp_residual_small",
            "ramp_explained",
            "tangent_determined",
            "strain_small",
            "depth_and_time_separable",
            "operating_point",
        ),
        ("--elastic", "--elastic by-depth", "--compression"),
        "Test at the compression of the installed seal, and at half and twice that value.",
    ),
    Assumption(
        "small vibration",
        "The vibration about one compression is so small that stiffness and damping do not depend "
        "on its amplitude.",
        "Filled rubber softens with amplitude (Payne), and its loss changes most: a hit twice as "
        "hard gives another result.",
        ("operating_point", "amplitude_linear", "hits_agree", "tests_agree"),
        ("--compression",),
        "Use hits of several forces; vibrate with the amplitude of the car.",
    ),
    Assumption(
        "isothermal",
        "Every test has one temperature, which is that of use; tests at several temperatures are "
        "of one model whose arms all shift alike.",
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
            "vertical_shift_plausible",
            "thermorheologically_simple",
        ),
        ("--temperature",),
        "Let the seal reach the temperature of the test, and note it; test at three temperatures, "
        "and fit them together.",
    ),
    Assumption(
        "conditioned rubber",
        "The seal has been pressed deeper before, and is not softened by the test itself (Mullins, "
        "set).",
        "A first loading is stiffer than all later ones, and its ramp is stiffer than its hold.",
        ("overshoot_small", "same_specimen"),
        (),
        "Press three to five times to the full depth, wait, then test.",
    ),
    Assumption(
        "known history",
        "The seal starts from rest, or earlier loadings are in the record and in the model.",
        "Relaxation from an earlier loading is taken for drift or for the slowest arm.",
        (
            "preload_absent",
            "baseline_recorded",
            "single_loading",
            "contact_detected",
            "history_explained",
            "face_recovered",
            "earlier_loading_negligible",
        ),
        ("--machine rest=",),
        "Rest ten times as long as the longest earlier hold, and record a second or more of it.",
    ),
    Assumption(
        "one seal",
        "Tests that are fitted together are of one seal, each given once.",
        "Two lots give their mean, which is right for neither; a record given twice makes every "
        "error 1.4 times too small.",
        ("same_specimen", "mass_plausible"),
        (),
        "Name files by specimen.",
    ),
    Assumption(
        "synchronous clocks",
        "Force and displacement are sampled at the same instants, with no filter in one alone.",
        "A delay d changes the loss factor by -omega d: 1 ms is 0.08 at 12.7 Hz; a first-order "
        "filter of 10 Hz in the force removes 24 % of the loss of the paper's seal there.",
        ("clocks_agree", "delay_plausible"),
        ("--machine sync=", "--machine force-filter="),
        "Record both channels on one converter, unfiltered.",
    ),
    Assumption(
        "rigid machine",
        "The recorded displacement is the compression of the seal.",
        "A machine compliance of 50 um/N lowers k_inf by 1 %; an unrecorded creep of the crosshead "
        "by 0.3 % of the depth makes the slowest arm 10 % wrong.",
        ("motion_measured", "hold_is_still", "depth_resolved"),
        ("--machine compliance=",),
        "Press steel on steel to measure the compliance; measure the displacement at the seal.",
    ),
    Assumption(
        "sampled motion",
        "The sampling rate resolves the motion.",
        "An axis that moves in steps between samples gives false fast arms: up to ten times the "
        "loss at 12.7 Hz.",
        ("motion_resolved", "samples_unbroken", "ramp_sampled"),
        (),
        "Sample at ten times the rate of the set-points, or faster.",
    ),
    Assumption(
        "steady load cell",
        "The zero of the force is that before contact, and its drift is as small as stated.",
        "Drift and the slowest arm look alike: an ignored drift of 0.2 mN/s makes k_2 7 % and "
        "tau_2 8 % wrong.",
        (
            "offset_plausible",
            "drift_plausible",
            "baseline_agrees",
            "k_inf_plausible",
            "baseline_recorded",
            "drift_distinguished_from_arm",
        ),
        ("--machine drift=",),
        "Record a long baseline; let the amplifier warm up.",
    ),
    Assumption(
        "calibrated sensors",
        "Load cell, encoder and accelerometer read the true values.",
        "A force that reads 5 % too high makes every stiffness 5 % too high, and no single test "
        "shows it: of 11 such records with the verdict *use*, 10 had a wrong stiffness after the "
        "hold.",
        (
            "gain_plausible",
            "mass_plausible",
            "high_frequency_mass_agrees",
            "hammer_agrees_with_relaxation_test",
        ),
        (),
        "Hang a known mass on the load cell before the test; add a hammer test with a weighed test "
        "mass.",
    ),
    Assumption(
        "rigid test mass",
        "The test mass is rigid, moves along one axis, and is weighed with all that it carries.",
        "An error of 1 % in the mass is 0.5 % of the natural frequency; rocking adds a second "
        "peak.",
        ("high_frequency_mass_agrees", "mass_plausible", "rocking_cancelled", "hits_centred"),
        ("--combine", "--mass-sd", "--seal-mass"),
        "Use two accelerometers, and hit above the centre.",
    ),
    Assumption(
        "positive arms",
        "The seal only stores and dissipates energy: every arm has a positive stiffness.",
        "Friction, adhesion or an active element appears as arms, or leaves a residual.",
        ("k_inf_positive", "loss_positive", "kramers_kronig", "residuals_white"),
        ("--dashpot",),
        "Unload as slowly as you load: the energy that is not returned is friction.",
    ),
    Assumption(
        "arms in the range of the test",
        "Relevant relaxation is neither much faster than the ramp nor much slower than the hold.",
        "Stiffness and loss outside the valid band are an extrapolation; k_inf is the stiffness "
        "at the end of the hold minus the relaxation still to come.",
        ("valid_band_exists", "inside_valid_band", "fast_arm_visible", "hold_long_enough"),
        (),
        "Ask `dashpot plan` before the test; add a hammer test.",
    ),
)
