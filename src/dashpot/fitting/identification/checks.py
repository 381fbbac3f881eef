"""Each way in which an identification can deceive, as a criterion with a sentence."""

from __future__ import annotations

import numpy as np

from dashpot.base.checks import Criterion, Finding, criterion
from dashpot.engine.inference.order import MAX_SE_LN_TAU

STRAINED = 2.5
EXPLAINED = 2.0
UNEXPLAINED = 0.1
# a squared residual so many times as large is another seal
CONTRADICTED = 4.0
# a force missed by less than this part of its peak changes no use of the solid
IMMATERIAL = 1e-4


@criterion(
    "misfit / scatter",
    "<=",
    EXPLAINED,
    "our choice; 0.1 of the FRF without scatter",
    otherwise="stop beyond 20, and 0.5",
)
def lines_explained(scale: float, *, known_sd: bool) -> Finding:
    """The solid explains the lines of the FRF."""
    if known_sd:
        return Finding(
            f"the solid leaves {scale:.2g} times the random scatter of the lines",
            scale,
            ": another mode, leakage or nonlinearity is in the FRF; narrow band=, or add arms",
            grade="stop" if scale > 10 * EXPLAINED else None,
        )
    return Finding(
        f"the solid leaves {100 * scale:.2g} % of the FRF unexplained; the FRF came "
        "without coherence or scatter, so every line counted alike",
        scale,
        limit=UNEXPLAINED,
        grade="stop" if scale > 5 * UNEXPLAINED else None,
    )


@criterion(
    "squared residual jointly / alone",
    "<=",
    1.3,
    "our choice; or too little to matter",
    otherwise=f"stop beyond {CONTRADICTED:g}",
)
def relaxation_still_explained(number: int, ratio: float, *, missed: float = np.inf) -> Finding:
    """The hammer does not contradict a relaxation test.

    `missed` is the rms force that the joint fit adds to the residual, over the peak force.
    """
    return Finding(
        f"in the joint fit relaxation test {number} has {ratio:.3g} times the squared residual "
        "of its own fit",
        ratio,
        ": hammer and relaxation contradict each other; check mass, number and length of seals, "
        "and whether both tests are at the same compression",
        excused=missed < IMMATERIAL,
        grade="stop" if ratio > CONTRADICTED else None,
    )


def _believable(quantity: str) -> Criterion[[str, float, float]]:
    @criterion(
        "distance in standard deviations",
        "<=",
        STRAINED,
        source="1.2 % of normal errors are beyond",
        otherwise=f"stop beyond {4 * STRAINED:g}",
        name=f"{quantity}_believable",
        question=f"The {quantity} stays near what was known of it.",
    )
    def judge(found: str, off: float, sd: float) -> Finding:
        return Finding(
            f"the fit puts the {quantity} at {found}, {abs(off) / sd:.2g} standard deviations from "
            "what was known",
            abs(off) / sd,
            f": check the {quantity} itself",
            grade="stop" if abs(off) > 4 * STRAINED * sd else None,
        )

    return judge


mass_believable, gain_believable, delay_believable = map(_believable, ("mass", "gain", "delay"))


@criterion("relative standard error", "<", MAX_SE_LN_TAU, "a factor 1.6 in tau; and k > 3 SE")
def arms_identified(arms: int, worst: float, *, significant: bool, new: int = 0) -> Finding:
    """Every arm is known.

    `new` of them only with the help of the hammer.
    """
    how = f"of the {arms} arms is known (largest relative standard error {100 * worst:.2g} %)"
    hammer = f"; {new} of them only with the help of the hammer" if new > 0 else ""
    return Finding(
        f"every one {how}{hammer}",
        worst,
        instead=f"not every one {how}: ask for fewer arms, widen band=, or add a relaxation "
        f"test{hammer}",
        faulted=not significant,
    )
