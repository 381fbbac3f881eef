"""Criteria on an aging law."""

from __future__ import annotations

import numpy as np

from dashpot.base.checks import Check, Finding, Remedy, criterion
from dashpot.base.number_format import format_count
from dashpot.base.units import celsius, format_quantity, parse_quantity
from dashpot.extensions.materials.csr.datamodel import Aging
from dashpot.extensions.materials.csr.law import F0_TIME, THOUSAND_HOURS
from dashpot.extensions.materials.csr.preprocess import Readings
from dashpot.numerics.inference.covariance_estimate import Estimate

MIN_SIGNIFICANCE = 4.0
"""Standard errors by which the hottest oven must show chemical aging."""
MAX_EXTRAPOLATION = 30.0
"""Distance of a temperature below the coldest oven, K, at most."""
USUAL_ENERGY = parse_quantity("90kJ/mol", "molar energy")


def run_checks(
    aging: Aging, readings: Readings, estimate: Estimate, strain: float | None, *, drift: float
) -> tuple[Check, ...]:
    """Return every check of a fit."""
    hottest, coldest = aging.ovens[-1], aging.ovens[0]
    loss = float(estimate.optimum.theta[0] / estimate.standard_error[0])
    largest_rise = max(-loss, *(-oven.significance for oven in aging.ovens))
    residual = estimate.optimum.residual
    is_same_specimen = np.diff(readings.specimen_number) == 0
    correlation = float(
        (residual[1:] * residual[:-1])[is_same_specimen].sum() / (residual @ residual)
    ) * np.sqrt(len(residual))
    return (
        force_falls(largest_rise),
        f0_read(
            max(
                float(readings.time[readings.specimen_number == i].min())
                for i in range(readings.specimens)
            )
        ),
        readings_residuals_random(correlation),
        readings_residual_small(aging.scatter),
        chemical_aging_resolved(hottest.significance, hottest.temperature),
        ovens_enough(len(aging.ovens)),
        activation_energy_plausible(aging.law.activation or None),
        single_activation_energy_explains_ovens(strain),
        load_cell_zero_stable(*_estimate_drift(estimate, drift)),
        aging_exceeds_cell_drift(None if aging.law.is_lower_bound else coldest.rate, drift),
    )


def _estimate_drift(estimate: Estimate, drift: float) -> tuple[float | None, float]:
    """Return the drift of the readings, None if it is fixed, and its standard error."""
    if not drift:
        return None, drift
    last = len(estimate.optimum.theta) - 1
    return drift * float(estimate.optimum.theta[last]), drift * float(estimate.standard_error[last])


@criterion("rise / standard error", "<=", 3.0, "chance, once in 700", grade="stop")
def force_falls(rise_over_error: float) -> Finding:
    """The force of the specimens does not rise."""
    return Finding(
        f"The force rises by {max(rise_over_error, 0.0):.2g} standard errors of its trend",
        rise_over_error,
        "Crosslinks or swelling add force, and the aging law has none that grows",
        "Leave out the oven or the specimen that rises.",
    )


@criterion("time / 30 min", "<=", 2.0, "ISO 3384-1: F0 is read at 30 min", grade="note")
def f0_read(first: float) -> Finding:
    """F0 of every specimen was read close to 30 min."""
    return Finding(
        f"The last specimen was first read {format_quantity(first, 'h', '.3g')} after its "
        "compression",
        first / F0_TIME,
        "Its F0 follows from the aging law alone, and all its ratios share that error",
        "Read F0 at 30 min.",
    )


@criterion("correlation of neighbours * sqrt(readings)", "<=", 3.0, "chance, once in 700")
def readings_residuals_random(correlation: float) -> Finding:
    """The readings scatter independently about the aging law."""
    return Finding(
        f"Neighbours in time miss the aging law together by {correlation:.2g} standard deviations",
        correlation,
        "The aging law does not fit the readings, or the load cell drifts",
        "Look at the figure. Leave out ovens that age otherwise, such as the hottest.",
    )


@criterion("part of F0", "<=", 0.04, "our choice: four times the 1 % of a usual reading")
def readings_residual_small(scatter: float) -> Finding:
    """The readings lie close to the aging law."""
    return Finding(
        f"A reading lies {100 * scatter:.2g} % of F0 from the law",
        scatter,
        "The aging law does not fit the readings, or some were read otherwise, such as cold",
        "Look at the figure, and read all at one temperature.",
    )


@criterion("rate / standard error", ">=", MIN_SIGNIFICANCE, "our choice: chance, once in 30,000")
def chemical_aging_resolved(significance: float, hottest: float) -> Finding:
    """Chemical aging is significant in the hottest oven."""
    return Finding(
        f"At {celsius(hottest)} chemical aging is {significance:.2g} standard errors from none",
        significance,
        "A life is a lower limit",
        "Read longer, or use a hotter oven.",
    )


@criterion("ovens", ">=", 3.0, "ISO 11346: a line over 1/T needs three temperatures")
def ovens_enough(ovens: int) -> Finding:
    """There are enough ovens for an activation energy and its error."""
    return Finding(
        f"The specimens were in {format_count(ovens, 'oven')}",
        float(ovens),
        "The error of the activation energy then is that of the ovens alone"
        if ovens == 2
        else "No activation energy follows",
        Remedy("Add an oven, or say how well each is known.", "machine", "oven=1K")
        if ovens == 2
        else "Add an oven.",
    )


@criterion("energy / 90 kJ/mol", "x/", 3.0, "our choice: elastomers have 40 to 200 kJ/mol")
def activation_energy_plausible(energy: float | None) -> Finding:
    """The activation energy is in the range of rubbers."""
    if energy is None:
        return Finding("No activation energy was found, so this check does not apply")
    return Finding(
        f"The activation energy is {format_quantity(energy, 'kJ/mol', '.3g')}",
        energy / USUAL_ENERGY,
        "Hotter ovens do not age the seal faster, as the law supposes"
        if energy <= 0
        else "No rubber is known to age so",
        "Check which oven each specimen was in.",
    )


@criterion("chi square / degrees of freedom", "<=", 9.0, "our choice: chance, once in 370")
def single_activation_energy_explains_ovens(strain: float | None) -> Finding:
    """One activation energy fits all ovens within the error of their temperatures."""
    if strain is None:
        return Finding("Two ovens always lie on one line of 1/T, so this check does not apply")
    return Finding(
        f"The ovens lie {np.sqrt(max(strain, 0.0)):.2g} standard deviations from one line of 1/T",
        strain,
        "The activation energy changes, or an oven is not as warm as it says",
        Remedy("Leave out the hottest oven, or say the error of the ovens.", "machine", "oven=2K"),
    )


@criterion("drift / standard error", "|x| <=", 3.0, "chance, once in 700", grade="note")
def load_cell_zero_stable(drift: float | None, error: float) -> Finding:
    """The zero of the load cell does not drift, as a part of F0 in 1000 h."""
    if drift is None:
        return Finding("The load cell is said not to drift")
    return Finding(
        f"The zero of the load cell drifts by {100 * drift:+.2g} ± {100 * error:.2g} % of the "
        "force in 1000 h",
        drift / error,
        "That is taken off the forces, and its error is in every interval",
        "Check the cell with a weight.",
    )


@criterion("rate / drift", ">=", 1.0, "our choice: a rate at least as large", grade="note")
def aging_exceeds_cell_drift(rate: float | None, drift: float) -> Finding:
    """The coldest oven ages faster than the load cell drifts, in parts of F0 in 1000 h."""
    if rate is None:
        return Finding(
            "No chemical aging was resolved, so no drift of the cell is compared with it"
        )
    loss = rate * THOUSAND_HOURS
    return Finding(
        f"The coldest oven loses {100 * loss:.3g} % in 1000 h, where the load cell may drift by "
        f"{100 * drift:.3g} %",
        loss / drift if drift else np.inf,
        "A drift looks like chemical aging there; the intervals include both",
        Remedy("Check the cell with a weight, and give its drift.", "machine", "drift=10mN/h"),
    )


@criterion(
    "distance, K", "<=", MAX_EXTRAPOLATION, "our choice: the activation energy is lower in the cold"
)
def temperature_near_ovens(kelvin_below: float, temperature: float) -> Finding:
    """The requested temperature lies close to those of the ovens."""
    return Finding(
        f"{celsius(temperature)} lies {max(kelvin_below, 0.0):.3g} K below the coolest oven",
        kelvin_below,
        "The activation energy may fall there, and the life with it",
        "Test an oven nearer to it.",
    )


@criterion("change / standard error", "<=", 2.0, "inside the 95 % interval")
def robust_to_lower_activation_energy(
    change: float | None, lower: float, coldest: float
) -> Finding:
    """The result is robust to a lower activation energy below the tested temperatures."""
    if change is None:
        return Finding("The temperature is that of an oven, or above, so this check does not apply")
    return Finding(
        f"An activation energy of {format_quantity(lower, 'kJ/mol', 'g')} below {celsius(coldest)} "
        f"changes the result by {change:.2g} standard errors",
        change,
        "Many rubbers have so low an energy below the ovens, and these ovens cannot show it",
        "Test an oven at a lower temperature.",
    )


@criterion("ovens", ">=", 1.0, "our choice: ISO 11346 wants the end-point reached in each oven")
def end_point_reached(oven_index: int | None, part: float) -> Finding:
    """The force fell to the end-point in an oven."""
    if oven_index is None:
        return Finding("No end-point is asked, so this check does not apply")
    return Finding(
        f"The force fell to {100 * part:g} % in {format_count(oven_index, 'oven')}",
        float(oven_index),
        "The course of the law down to there was not seen",
        "Read the hottest oven for longer, or ask for a smaller loss.",
    )


@criterion("standard error / value", "<=", 1.0, "our choice: else not even its size is known")
def aging_prediction_determined(error: float | None) -> Finding:
    """The result is known to its order of magnitude."""
    if error is None:
        return Finding("The answer has no standard error, so this check does not apply")
    return Finding(
        f"The standard error of the answer is {100 * error:.3g} % of it",
        error,
        "The test does not determine it",
        Remedy("Read longer, add ovens, or say how well each is known.", "machine", "oven=1K"),
    )


@criterion("standard deviation / wanted", "<=", 1.0, "as wanted")
def life_sd_within_target(life_sd: float, target: float) -> Finding:
    """The planned test knows the life as well as wanted."""
    return Finding(
        f"The life will be known to {100 * life_sd:.3g} %, and {100 * target:.3g} % are wanted",
        life_sd / target,
        "More specimens alone do not reach it: the ovens and their hours limit it",
        Remedy("Test longer, in more ovens, or in ovens known better.", "machine", "oven=0.5K"),
    )


@criterion("part of the force", "<=", 0.1, "our choice: newly formed chains carry no force")
def stiffness_follows_force(loss: float) -> Finding:
    """Chemical aging is small, so that the stiffness falls as the force does."""
    return Finding(
        f"Chemical aging took {100 * loss:.3g} % of the force",
        loss,
        "Chains that form meanwhile carry none of it, and the stiffness fell by less",
        "Test an aged specimen.",
    )


@criterion("distance, decades", "<=", 2.0, "our choice: a hundred times as long as the readings")
def time_near_readings(decades: float, longest: float) -> Finding:
    """The requested or predicted time is not far beyond the last reading."""
    return Finding(
        f"The answer lies {max(decades, 0.0):.2g} decades of time beyond the last reading, at "
        f"{format_quantity(longest, 'h', '.4g')}",
        decades,
        "It follows from the aging law alone",
        "Read longer.",
    )
