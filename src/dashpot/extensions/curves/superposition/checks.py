"""Criteria on tests at several temperatures for time-temperature superposition."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from dashpot.base.arrays import FloatArray
from dashpot.base.checks import Check, Finding, Remedy, criterion
from dashpot.base.units import celsius
from dashpot.datamodel.shift_factors import GLASS_MARGIN
from dashpot.extensions.curves.shift_law_fit import MAX_MISSED, LawScore, ShiftLawFit, ShiftOutlier
from dashpot.numerics.inference.model_order import is_significant_fall
from dashpot.solids.shift_laws import WLF, TemperatureLaw

MIN_OVERLAP = 0.5
"""Decades that neighbours are to share."""
MAX_STEP_SE = 0.3
MAX_RISE = 3.0
MAX_JOINT_OVER_OWN = 1.2
MIN_BIC_MARGIN = 10.0
MAX_ODD = 0.05
MAX_VERTICAL = 0.03
# residuals below this part of the modulus are of no instrument
_EXACT = 1e-6
# decades by which shifts may differ without a matter
_NEGLIGIBLE_DECADES = 0.1


@criterion(
    "decades shared",
    ">=",
    MIN_OVERLAP,
    "our choice: with less, any shift fits; 1.5 for ramps and holds (simulation)",
)
def isotherms_overlap(
    shared: FloatArray | Sequence[float],
    temperature: FloatArray | Sequence[float],
    overlap_decades: float = MIN_OVERLAP,
) -> Finding:
    """Neighbouring temperatures share a range of relaxation times after the shift.

    `shared` is of each pair of neighbours, shape (n - 1,), `temperature` K, (n,); `overlap_decades`
    is the overlap that they need.
    """
    i = int(np.argmin(shared))
    return Finding(
        f"{celsius(temperature[i])} and {celsius(temperature[i + 1])} share {shared[i]:.2g} "
        f"decades of relaxation time; at least {overlap_decades:g} are needed",
        float(shared[i]),
        "With less in common, the shift between them follows from the assumed spectrum alone",
        "Test at a temperature between them, or over more decades.",
        limit=overlap_decades,
    )


@criterion("SE of a step, decades", "<=", MAX_STEP_SE, "our choice: a factor 2 in time")
def shifts_determined(
    error: FloatArray, temperature: FloatArray, total_error: FloatArray
) -> Finding:
    """The data determine the shift between neighbouring temperatures.

    `error` is of each step of log10 a_T, shape (n - 1,), `total_error` of each log10 a_T, (n,).
    """
    i = int(np.argmax(error))
    flat = celsius(temperature[i + int(np.argmax(total_error[i : i + 2]))])
    return Finding(
        f"The step from {celsius(temperature[i])} to {celsius(temperature[i + 1])} is known to "
        f"±{error[i]:.2g} decades, the least certain of all",
        float(error[i]),
        f"The curve at {flat} is flat and fits anywhere. So is that of a glass, of rubber at rest, "
        "and of a seal that relaxes within the ramp",
        "Leave that temperature out, or use the law alone.",
    )


@criterion("rise of log a_T, SE", "<=", MAX_RISE, "3 standard errors")
def shift_monotone(step: FloatArray, error: FloatArray, temperature: FloatArray) -> Finding:
    """Relaxation is faster at each higher temperature.

    `step` is log10 a_T of each temperature less that of the next colder one, with its `error`.
    """
    rise_over_error = np.where(
        error > 0, step / np.where(error > 0, error, 1.0), np.sign(step) * np.inf
    )
    rise_over_error = np.where(step == 0, 0.0, rise_over_error)
    i = int(np.argmax(rise_over_error))
    return Finding(
        "Relaxation is faster at every warmer temperature",
        float(np.clip(rise_over_error[i], -1e9, 1e9)),
        failure=f"From {celsius(temperature[i])} to {celsius(temperature[i + 1])} relaxation times "
        f"grow by {step[i]:.2g} decades; warmth should shorten them",
        remedy="Look for exchanged files, a wrong temperature, or a specimen that changed.",
    )


@criterion(
    "mean square jointly / alone",
    "<=",
    MAX_JOINT_OVER_OWN,
    "simulated simple models give 0.96 to 1.12",
)
def thermorheologically_simple(ratio: float | None, by_chance: float, rms: float) -> Finding:
    """One shift factor for all arms fits each temperature as well as a model of its own.

    `ratio` is None where the temperatures alone leave too few degrees of freedom, `by_chance` what
    it reaches by chance alone, `rms` the relative rms residual of the joint model.
    """
    return Finding(
        "Each temperature has too few values to be compared with its own fit"
        if ratio is None
        else f"The joint model has {ratio:.3g} times the mean squared residual of a model of each "
        "temperature alone",
        ratio,
        "No single shift moves the whole model: two processes, crystals, a filler network, or "
        "another strain. A prediction at a new temperature is worse than its errors",
        "Fit each temperature alone.",
        limit=max(MAX_JOINT_OVER_OWN, by_chance),
        always_passes=ratio is not None and rms < _EXACT,
    )


def collect_law_checks(
    law_fit: ShiftLawFit, coldest: float, *, is_requested: bool = False
) -> list[Check]:
    """Return what must hold of a law and of the shifts that it was laid through.

    `coldest` is the coldest test, K; `is_requested` is as in :func:`law_follows_shifts`.
    """
    error = float(np.sqrt(law_fit.covariance[-1, -1])) if law_fit.law.kind == "wlf" else 0.0
    return [
        law_follows_shifts(law_fit.score, law_fit.scores, is_requested=is_requested),
        no_temperature_outlier(law_fit.outlier),
        glass_below_tests(law_fit.law, coldest, error),
    ]


@criterion("decades between law and shift", "<=", MAX_MISSED, "our choice: a factor 1.4 in time")
def law_follows_shifts(
    selected_law: LawScore, scores: Sequence[LawScore], *, is_requested: bool = False
) -> Finding:
    """The shift law agrees with the shift factors within their errors.

    `scores` are of every law that was tried; `is_requested` if the user wants none.
    """
    laws = [score for score in scores if score.kind != "free"]
    if selected_law.kind == "free":
        no_law_text = "No law was fitted to the shifts; they reach no further than the tests"
        if is_requested or not laws:
            return Finding(no_law_text)
        best = min(laws, key=lambda score: score.missed)
        return Finding(
            no_law_text,
            best.missed,
            f"The nearest law, {best.kind}, is {best.missed:.2g} decades off at {celsius(best.at)}",
            "Look for a glass transition among the temperatures, or a wrong temperature.",
            always_fails=True,
        )
    return Finding(
        f"The {selected_law.kind} law misses a shift by at most {selected_law.missed:.2g} decades, "
        f"at {celsius(selected_law.at)}",
        selected_law.missed,
        "That is more than chance. A glass transition among them or a wrong temperature may cause "
        "this",
        Remedy("Use the shifts themselves between the tested temperatures.", "shift", "free"),
        always_passes=not selected_law.fails,
    )


@criterion("decades from the law of the others", "|x| <=", MAX_ODD, "our choice: 12 % in time")
def no_temperature_outlier(outlier: ShiftOutlier | None) -> Finding:
    """No temperature deviates from the shift law of all others."""
    if outlier is None:
        return Finding("No single temperature lies off a law that all others follow", 0.0)
    return Finding(
        f"{celsius(outlier.temperature)} lies {outlier.missed:+.2g} decades off the law that all "
        "other temperatures follow",
        outlier.missed,
        remedy="Check that temperature, its gain and its specimen, or leave it out.",
    )


@criterion("K from the coldest test to the law's end", "<=", 0.0, "10 K above the glass transition")
def glass_below_tests(law: TemperatureLaw, coldest: float, error: float) -> Finding:
    """The glass transition of the shift law lies well below the coldest test.

    `coldest` is in K, and so is the standard `error` of C_2.
    """
    if not isinstance(law, WLF):
        return Finding("No WLF law was fitted, so none gives a glass transition")
    short = law.glass + GLASS_MARGIN - coldest
    return Finding(
        f"The WLF law puts the glass transition near {celsius(law.glass)}",
        short,
        f"The coldest test, at {celsius(coldest)}, is less than {GLASS_MARGIN:g} K above it, where "
        "no such law is valid",
        Remedy("Check the temperatures. Until then use the shifts themselves.", "shift", "free"),
        always_passes=short < MAX_RISE * error,
    )


@criterion(
    "difference of BIC",
    ">=",
    MIN_BIC_MARGIN,
    "Kass and Raftery, J. Am. Stat. Assoc. 90 (1995) 773: very strong",
)
def vertical_shift_determined(vertical: str, margin: float, difference: float) -> Finding:
    """The data, or the user, determine how the stiffness depends on temperature.

    `margin` is the BIC of the other rule less that of the one taken, or N ln of the ratio of what
    they leave if that is less, and `difference` by how many decades its shifts differ.
    """
    is_free = vertical == "free"
    return Finding(
        "The vertical shifts are free"
        if is_free
        else f"b_T = {vertical} is ahead by {margin:.3g} in BIC. The other rule moves no shift by "
        f"more than {difference:.2g} decades",
        None if is_free else margin,
        "They trade with the horizontal shifts, so neither can be used; this is a diagnostic"
        if is_free
        else "The data hardly separate the two rules",
        Remedy("Choose one: T/T_r for rubber, 1 below the glass transition.", "vertical", "T/T_r"),
        always_passes=not is_free and difference < _NEGLIGIBLE_DECADES,
        always_fails=is_free,
    )


@criterion(
    "relative change of b_T",
    "<=",
    MAX_VERTICAL,
    "our choice; or what chance exceeds with probability 0.0027",
)
def vertical_rule_holds(step: FloatArray, score: float, temperature: FloatArray) -> Finding:
    """The stiffness depends on temperature as the vertical shift says.

    `step` is by how much ln b_T of each temperature would move if it could, and `score` the fall of
    chi-square.
    """
    i = int(np.argmax(np.abs(step)))
    return Finding(
        f"Free factors of the moduli would change by at most {100 * abs(step[i]):.2g} %, at "
        f"{celsius(temperature[i])}",
        float(abs(step[i])),
        "That is more than chance. The moduli there differ from the rule of b_T, and the shift "
        "with them",
        "Look for another grip, length or strain, machine compliance, or a glass transition.",
        always_passes=not is_significant_fall(score, max(len(step) - 1, 1)),
    )


def collect_shift_checks(
    temperature: FloatArray,
    log10_a_t: npt.ArrayLike,
    covariance: FloatArray,
    law_fit: ShiftLawFit,
    *,
    is_requested: bool = False,
) -> tuple[Check, ...]:
    """Return the checks of each shift against that of the next temperature, and of the law.

    `covariance` begins with that of the shifts; `is_requested` if none but they were requested.
    """
    n = len(temperature)
    difference_matrix = np.diff(np.eye(n), axis=0)
    step = difference_matrix @ np.asarray(log10_a_t)
    variances = np.diag(difference_matrix @ covariance[:n, :n] @ difference_matrix.T)
    error = np.sqrt(np.maximum(variances, 0.0))
    return (
        shifts_determined(error, temperature, np.sqrt(np.maximum(np.diag(covariance)[:n], 0.0))),
        shift_monotone(step, error, temperature),
        *collect_law_checks(law_fit, float(temperature[0]), is_requested=is_requested),
    )
