"""Criteria on a study."""

from __future__ import annotations

import math

from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.number_format import seals as format_seals
from dashpot.base.plain_text import sentence
from dashpot.datamodel.frf import Mode


@criterion(source="the paper's eq. (5) needs one ideal ramp", grade="note")
def hold_fit_possible(refusal: str) -> Finding:
    """Equation (5) of the paper can be fitted to the record."""
    return Finding(
        f"The fit of the hold alone (eq. 5) is not possible. {sentence(refusal)}",
        remedy="Use the fit of ramp and hold.",
        always_fails=True,
    )


@criterion("distance from the valid band, a factor", "<=", 1.0, "the valid band of the fit")
def prediction_in_valid_band(peak: float, band: tuple[float, float]) -> Finding:
    """The predicted peak lies in the valid band of the test."""
    low, high = band
    factor = max(peak / high, low / peak) if high > 0 else math.inf
    side_word = "higher" if peak > high else "lower"
    if not high > 0:
        return Finding(
            f"The predicted peak ({peak:.4g} Hz) lies in no valid band; the fit has none",
            factor,
            remedy="Add a hammer test.",
        )
    return Finding(
        f"The predicted peak ({peak:.4g} Hz) lies in the valid band of the test",
        factor,
        failure=f"The damping at {peak:.3g} Hz is not known. The test covers {low:.2g} to "
        f"{high:.2g} Hz; the peak lies {factor:.3g} times {side_word}",
        remedy="Measure it with a hammer.",
    )


@criterion("files that were fitted", "<=", 0, "by definition", grade="note")
def measurement_independent_of_fit(fitted_file_count: int) -> Finding:
    """The measurement was not part of the fit."""
    return Finding(
        "The fit was not made from this measurement",
        fitted_file_count,
        failure=f"The fit was made from this measurement ({fitted_file_count} files)",
        reason="No test: its agreement says nothing",
        remedy="Compare it with other hits, or leave a hit out.",
    )


@criterion(source="the stiffness of one seal is that of all over their number", grade="note")
def seals_counted(seals: float) -> Finding:
    """The number of seals under the block was given."""
    return Finding(
        f"The number of seals is not given, so {format_seals(seals)} is assumed",
        reason="The stiffness of one seal goes with it",
        remedy=Remedy("Count the seals under the block.", "seals"),
        always_fails=True,
    )


@criterion(
    "distance from the valid band, a factor", "<=", 1.0, "the valid band of the fit", grade="note"
)
def base_band_in_valid_band(
    requested_band: tuple[float, float], peak: float, band: tuple[float, float]
) -> Finding:
    """All requested frequencies of a moving base lie in the valid band.

    Below a quarter of the `peak`, Hz, the mass follows its base whatever carries it.
    """
    low, high = max(requested_band[0], min(peak / 4, requested_band[1])), requested_band[1]
    factor = max(high / band[1], band[0] / low) if band[1] > 0 else math.inf
    message = f"From {low:.3g} to {high:.3g} Hz the transmissibility"
    return Finding(
        f"{message} depends on what the test covers",
        factor,
        failure=f"{message} is extrapolated by a factor of {factor:.3g}. The test covers "
        f"{band[0]:.2g} to {band[1]:.2g} Hz",
        remedy=Remedy("Narrow the band, or measure on a shaker.", "band"),
    )


@criterion("ratio of damping ratios", "x/", 1.1, "10 % of damping; and 1 % of frequency")
def families_predict_alike(mode: Mode | None, other_mode: Mode | None) -> Finding:
    """Another family of models that fits the test predicts the same resonance.

    `mode` and `other_mode` are the first modes of the mass on either solid.
    """
    if mode is None or other_mode is None or not mode.damping_ratio > 0:
        return Finding("No other family of models that explains the test predicts a resonance")
    ratio = other_mode.damping_ratio / mode.damping_ratio
    shift = other_mode.frequency / mode.frequency - 1
    return Finding(
        f"Another model that explains the test resonates at {other_mode.frequency:.4g} Hz with a "
        f"damping ratio of {100 * other_mode.damping_ratio:.3g} %. This one does at "
        f"{mode.frequency:.4g} Hz with {100 * mode.damping_ratio:.3g} %",
        ratio,
        "The test cannot separate the two",
        "Add a hammer test or a colder test, or ramp faster.",
        always_fails=abs(shift) > 0.01,
    )
