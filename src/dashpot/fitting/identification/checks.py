"""Criteria on an identification."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from dashpot.base.checks import Check, Finding, Remedy, criterion
from dashpot.base.errors import Status
from dashpot.datamodel.bounds import MAX_LOSS_FACTOR_ERROR, BandError
from dashpot.datamodel.fit_diagnostics import Explanation
from dashpot.numerics.inference.model_order import DECISIVE_BIC, MAX_SE_LN_TAU

MAX_PRIOR_DEVIATION = 2.5
MAX_EXPLAINED_MISFIT = 2.0
MAX_UNEXPLAINED = 0.1
# a squared residual so many times as large is another seal
CONTRADICTION_RATIO = 4.0
DEFAULT_REMEDY = Remedy(
    "Weigh the test mass. Check cables, and number, length and compression of the seals.", "mass"
)
_CONTRADICTION = "Hammer and relaxation test contradict each other"
# a force missed by less than this part of its peak changes no use of the solid
NEGLIGIBLE_FORCE = 1e-4
# a stiffness, mass or gain this far off moves a peak by half of it
SLIGHT_CHANGE = 0.05
# stiffness and loss factor are known so well in a band, a standard error
MAX_ERROR = 0.025, 0.1


@criterion(
    "misfit / scatter",
    "<=",
    MAX_EXPLAINED_MISFIT,
    "our choice; 0.1 of the FRF without scatter",
    other_grade="stop beyond 20, and 0.5",
    fit_status=Status.TESTS_DISAGREE,
)
def lines_explained(scale: float, *, has_absolute_sd: bool, coherent: bool = False) -> Finding:
    """The model fits the FRF to within its scatter."""
    reason = "A second mode, leakage or amplitude may cause this"
    advice = Remedy(
        "Check the mass and its unit. Then narrow the band, or allow more arms.", "band"
    )
    if has_absolute_sd:
        return Finding(
            f"The model misses the FRF by {scale:.2g} times its noise",
            scale,
            reason,
            advice,
            grade="stop" if scale > 10 * MAX_EXPLAINED_MISFIT else None,
        )
    weighting_text = (
        "It has coherence but no number of hits, so the misfit gave the scatter"
        if coherent
        else "It has neither coherence nor scatter, so every line counted alike"
    )
    return Finding(
        f"The model misses the FRF by {100 * scale:.2g} %. {weighting_text}",
        scale,
        reason,
        advice,
        limit=MAX_UNEXPLAINED,
        grade="stop" if scale > 5 * MAX_UNEXPLAINED else None,
    )


@criterion(
    "squared residual jointly / alone",
    "<=",
    1.3,
    "our choice; or too little to matter",
    other_grade=f"stop beyond {CONTRADICTION_RATIO:g}",
    fit_status=Status.TESTS_DISAGREE,
)
def hammer_agrees_with_relaxation_test(
    number: int, ratio: float, *, residual_ratio: float = np.inf
) -> Finding:
    """The joint model still fits the relaxation test.

    `residual_ratio` is the rms force that the joint model adds to the residual, over the peak
    force.
    """
    return Finding(
        f"With the joint model relaxation test {number} has {ratio:.3g} times the squared residual "
        "of its own fit",
        ratio,
        _CONTRADICTION,
        DEFAULT_REMEDY,
        always_passes=residual_ratio < NEGLIGIBLE_FORCE,
        grade="stop" if ratio > CONTRADICTION_RATIO else None,
    )


@criterion(
    "error of the loss factor", "<=", MAX_LOSS_FACTOR_ERROR, "our choice; 95 %", grade="note"
)
def cables_described(band_error: BandError, peak: float, cable: float, high_pass: float) -> Finding:
    """The loss factor is known at the peak although cables and table were not described.

    `cable` is the stiffness that the cables are taken to have, over that of the seals; `high_pass`
    the corner that one channel is taken to have, Hz, 0 if another test shows it.
    """
    error = float(np.interp(peak, band_error.frequency, band_error.loss_factor))
    coupling = ""
    if high_pass > 0:
        coupling = (
            ". Away from the resonance the limits allow for a high-pass of one channel, taken as "
            f"{high_pass:.2g} Hz"
        )
    return Finding(
        f"Cables (taken as {100 * cable:.2g} % of the stiffness), table and added mass leave the "
        f"loss factor at {peak:.3g} Hz known to ±{100 * error:.2g} %. A hammer does not separate a "
        f"stiffer cable from a stiffer seal{coupling}",
        error,
        "A cable of 3 % of the stiffness of the seals may add a quarter to a small loss",
        Remedy("Let the cables hang free, and say so.", "machine", "cable=0"),
    )


@criterion(
    "distance in standard deviations",
    "<=",
    MAX_PRIOR_DEVIATION,
    "root mean square of all parameters",
)
def hammer_agrees_with_earlier_fit(deviation: float) -> Finding:
    """The hammer test agrees with the earlier fit."""
    return Finding(
        f"The joint model moves the parameters of the earlier fit by {deviation:.2g} of their "
        "standard deviations",
        deviation,
        _CONTRADICTION,
        DEFAULT_REMEDY,
    )


@criterion(
    "fall of chi-square",
    source="a note: what explains both tests",
    grade="stop",
    fit_status=Status.TESTS_DISAGREE,
)
def tests_agree(lead: Explanation | None) -> Finding:
    """One model fits the relaxation test and the hammer test.

    `lead` is what explains them best if not. A departure of 5 % that explains both is a limit.
    """
    if lead is None:
        return Finding("One seal explains relaxation test and hammer", 0.0)
    if lead.is_sufficient:
        message = f"Both tests match only if {lead.message}"
    else:
        message = (
            "No single seal matches both tests, whatever mass, gain, stiffness or high-pass is "
            f"taken. Chi-square falls by {lead.deviance_fall:.3g} at most"
        )
    slight = lead.is_sufficient and abs(lead.relative_deviation) <= SLIGHT_CHANGE
    remedy = DEFAULT_REMEDY
    if lead.name == "high-pass" and lead.is_sufficient and lead.value > 0:
        words = "Use the same coupling for both channels, or state the high-pass."
        remedy = Remedy(words, "machine", f"high-pass={lead.value:.2g}Hz")
    return Finding(
        message,
        lead.deviance_fall,
        remedy=remedy,
        always_fails=True,
        grade="limit" if slight else "stop",
    )


REMEDIES: dict[str, Remedy | str] = {
    "mass": Remedy("Weigh the test mass again.", "mass"),
    "gain": "Check the sensitivities of hammer and accelerometer.",
    "delay": "Check the delay between hammer and accelerometer.",
    "stiffness": "Check number, length and compression of the seals.",
}
"""Remedies where the fit contradicts a known quantity."""


class Believable(Protocol):
    """Criterion on the departure of a quantity from its prior."""

    def __call__(self, deviation: float, sd: float) -> Check:
        """Return the answer."""


def _plausible(quantity: str, end_status: Status | None = None) -> Believable:
    remedy = REMEDIES[quantity]

    @criterion(
        "distance in standard deviations",
        "<=",
        MAX_PRIOR_DEVIATION,
        source="1.2 % of normal errors are beyond",
        other_grade=f"stop beyond {4 * MAX_PRIOR_DEVIATION:g}",
        fit_status=end_status,
        name=f"{quantity}_plausible",
        question=f"The fitted {quantity} agrees with its prior.",
    )
    def evaluate(deviation: float, sd: float) -> Finding:
        return Finding(
            f"The fitted {quantity} differs from the known one by {abs(deviation) / sd:.2g} "
            "standard deviations",
            abs(deviation) / sd,
            remedy=remedy,
            grade="stop" if abs(deviation) > 4 * MAX_PRIOR_DEVIATION * sd else None,
        )

    return evaluate


# An implausible fitted mass: hammer and balance disagree.
mass_plausible = _plausible("mass", Status.TESTS_DISAGREE)
gain_plausible, delay_plausible, stiffness_plausible = map(
    _plausible, ("gain", "delay", "stiffness")
)


@criterion("fall of BIC", "<=", DECISIVE_BIC, "0 beside arms that are not known", grade="note")
def dashpot_not_missed(
    deviance_fall: float | None, text: str, b: float, *, is_determined: bool = True
) -> Finding:
    """A parallel dashpot would not improve the fit much.

    `text` is the solid beside it, in words; `is_determined` is one of which every part is known.
    """
    if deviance_fall is None:
        return Finding(f"The model has a parallel dashpot of {b:.3g} N s/m")
    return Finding(
        "A parallel dashpot explains the FRF no better",
        deviance_fall,
        failure=f"A parallel dashpot of {b:.3g} N s/m beside {text} explains the FRF better "
        f"(BIC falls by {deviance_fall:.3g})",
        remedy=Remedy("Add a dashpot.", "dashpot"),
        limit=DECISIVE_BIC if is_determined else 0.0,
    )


@criterion(
    "relative standard error",
    "<",
    MAX_SE_LN_TAU,
    "a factor 1.6 in tau; and k > 3 SE",
    other_grade="note of vibration alone, where stiffness and loss in its band are known",
    fit_status=Status.NOT_IDENTIFIED,
)
def arms_identified(
    arms: int,
    worst: float,
    *,
    unknown: Sequence[float] = (),
    new: int = 0,
    in_band: tuple[float, float] = (np.inf, np.inf),
) -> Finding:
    """The data determine every arm.

    `unknown` are the relaxation times, s, of those that are not; `new` arms are known only with the
    help of the hammer; `in_band` are the relative standard errors of stiffness and loss factor in
    the band that a hammer alone informs, which is all that it is asked for.
    """
    name = f"known (largest standard error {100 * worst:.2g} %)"
    hammer = f"; the hammer test adds {new} of them" if new > 0 else ""
    be = "is" if len(unknown) == 1 else "are"
    return Finding(
        f"Every one of the {arms} arms is {name}{hammer}",
        worst,
        failure=f"{len(unknown)} of the {arms} arms (relaxation time "
        f"{', '.join(f'{tau:.3g} s' for tau in unknown)}) {be} not {name}{hammer}"
        if arms > 1
        else f"The one arm is not {name}",
        remedy=Remedy("Use fewer arms, widen the band, or add a relaxation test.", "arms"),
        always_fails=bool(unknown),
        grade="note" if in_band[0] <= MAX_ERROR[0] and in_band[1] <= MAX_ERROR[1] else None,
    )
