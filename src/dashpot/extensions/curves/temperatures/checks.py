"""Criteria on one thermorheologically simple solid for tests at several temperatures."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.errors import Status
from dashpot.base.units import celsius
from dashpot.datamodel.parameter_estimate import Nuisance
from dashpot.datamodel.shift_factors import MIN_CONTRADICTING_TESTS, TemperatureShifts

# decades of time that neighbours both inform: pairs of simulated tests that shared 1.9 found their
# shift within its error, of those that shared 0.8 to 1.4 some missed it by five
MIN_SHARED_DECADES = 1.5
# of a normal variable beyond 3 standard deviations
SIGNIFICANCE_LEVEL = 0.0027
# a misfit of this part of the peak force is rounding; of that one, no solid of these tests
ROUNDING, TOO_MUCH = 5e-6, 1e-3
# how much further a decade of tau may shift: K at the resonance then is still inside its errors
MAX_SHIFT_SLOPE = 0.05
# K over a record
MAX_TEMPERATURE_DRIFT = 1.0
# of ln b_T: rubbers, filled ones too, stay within a few per cent of T/T_r over a tested step
MAX_LN_B_DEVIATION = 0.15
MAX_BACK = 2.5
# of log10 a_T, between rules of b_T that explain the tests alike; and standard errors, if more
SAME_SHIFT, SAME_SHIFT_ERRORS = 0.1, 3.0


@criterion(
    "probability by chance",
    ">=",
    SIGNIFICANCE_LEVEL,
    "chi-square of the joint model, alone and over that of each test's own, 3 standard errors; and "
    "arms that shift apart by less than 5 % per decade, or 2.5 standard errors",
    other_grade="stop where the misfit is above 0.1 % of the peak force",
    fit_status=Status.TESTS_DISAGREE,
)
def thermorheologically_simple(
    chance: float,
    excess: float,
    *,
    temperatures: int,
    slope: tuple[float, float] | None,
    enough_arms: int | None = None,
) -> Finding:
    """One model whose arms all shift alike fits every test as well as a model of its own.

    `excess` is the rms residual of the joint model beyond the noise, over the peak force; `slope`
    is the additional shift of each decade of tau, and its error, by the data alone: a prior would
    hide what two temperatures show. With `enough_arms`, if any, one model does explain the tests.
    A small misfit passes no sooner: two mechanisms of which every arm below 0.1 s shifts 0.6 times
    as far leave 1e-5 of the peak, and a loss factor that is 30 to 40 % off.
    """
    text, has_failed = "", False
    if slope is not None and abs(slope[0]) > MAX_BACK * slope[1]:
        text = (
            f"By the data alone slow arms shift {100 * slope[0]:+.2g} ± {100 * slope[1]:.1g} % "
            "further per decade"
        )
        has_failed = abs(slope[0]) > MAX_SHIFT_SLOPE
    cause_text, remedy = "The arms do not shift together", Remedy("Fit each temperature alone.")
    if enough_arms is not None and chance < SIGNIFICANCE_LEVEL:
        cause_text = f"It has too few arms ({enough_arms} do), they do not shift together"
        remedy = Remedy(
            "Use more arms, and fit each temperature alone to compare.", "arms", str(enough_arms)
        )
    misfit_text = (
        f"One model does not explain the tests: it misses the force by {100 * excess:.2g} % of the "
        f"peak. {cause_text}, or a temperature drifted"
    )
    result = (misfit_text,) if chance < SIGNIFICANCE_LEVEL else ()
    sentence = ". ".join((*result, text) if text else (misfit_text,))
    return Finding(
        f"One model explains the tests at {temperatures} temperatures (probability {chance:.2g} "
        f"by chance){text and '. '}{text}",
        chance,
        failure=f"{sentence}. The stiffness outside the band of each test is not supported",
        remedy=remedy,
        always_fails=has_failed,
        always_passes=excess < ROUNDING,
        grade="stop" if excess > TOO_MUCH else "limit",
    )


@criterion(
    "difference of log10 a_T",
    "<=",
    SAME_SHIFT,
    "our choice",
    other_grade="or 3 standard errors, if that is more; a note where a rule was stated",
)
def shifts_independent_of_vertical_rule(
    difference: float | None,
    se: float = 0.0,
    *,
    alternative: str = "with another b_T",
    is_stated: bool = False,
) -> Finding:
    """A rule for b_T that explains the tests as well gives the same shifts.

    Arms at even distances in log tau, shifted by one distance and by a factor of b_T, are nearly
    the same arms, and of a power law the two are the same: tests then cannot tell them apart.
    """
    if difference is None:
        return Finding("No other rule for b_T explains the tests as well")
    return Finding(
        f"One model explains the tests as well {alternative}",
        difference,
        "The shift rests on the rule that was stated"
        if is_stated
        else "The tests alone do not determine the shift, nor a prediction at another temperature",
        Remedy(
            "State the rule of b_T that the material follows: rubber elasticity gives T/T_r.",
            "vertical",
            "T/T_r",
        ),
        limit=max(SAME_SHIFT, SAME_SHIFT_ERRORS * se),
        grade="note" if is_stated else None,
    )


@criterion("K over the record", "|x| <=", MAX_TEMPERATURE_DRIFT, "our choice: chambers hold 0.5 K")
def temperature_steady(warming: Sequence[Nuisance]) -> Finding:
    """The temperature of each test was constant."""
    worst = max(warming, key=lambda nuisance: abs(nuisance.value))
    title = worst.name.partition(" of ")[2]
    return Finding(
        f"By its force, {title} warmed by {worst.value:.2g} ± {worst.standard_error:.1g} K while "
        "it was recorded",
        worst.value,
        remedy="Let the seal soak longer, and record its temperature.",
    )


@criterion(
    "|ln b_T - ln T/T_r|", "<=", MAX_LN_B_DEVIATION, "our choice: three times what rubbers show"
)
def vertical_shift_plausible(shifts: TemperatureShifts) -> Finding:
    """The stiffness is about proportional to absolute temperature, as rubber's is."""
    log_deviations = [
        float(np.log(shift.b_t * shifts.reference / shift.temperature)) for shift in shifts.shifts
    ]
    worst_index = int(np.argmax(np.abs(log_deviations)))
    temperature_text = celsius(shifts.shifts[worst_index].temperature)
    return Finding(
        f"At {temperature_text} every stiffness differs by "
        f"{100 * np.expm1(log_deviations[worst_index]):+.2g} % from "
        "rubber elasticity",
        abs(log_deviations[worst_index]),
        remedy=Remedy(
            "Check specimen, depth, length and temperature, or state rubber elasticity.",
            "vertical",
            "T/T_r",
        ),
    )


@criterion(
    "temperatures",
    ">=",
    MIN_CONTRADICTING_TESTS,
    "our choice: two temperatures always fit a law",
    grade="note",
)
def shifts_distinguished(count: int) -> Finding:
    """Enough temperatures were tested to detect arms that shift apart and to fit a law."""
    return Finding(
        f"{count} temperatures were tested; three are needed",
        count,
        "Two cannot show arms that shift apart, and no law can be extended beyond them",
        "Test at a third temperature, between them or beyond.",
    )
