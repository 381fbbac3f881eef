"""Criteria on compression load deflection tests."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

from dashpot.base.checks import Finding, Remedy, criterion
from dashpot.base.errors import Status
from dashpot.base.units import format_quantity
from dashpot.extensions.materials.cld.datamodel import ProcessCapability
from dashpot.extensions.materials.cld.zero_point import MAX_PRELOAD

MAX_CYCLE_CHANGE = 0.02
MAX_DEPTH_RATIO = 1.02
MAX_DRIFT = 0.02
MAX_SPEED_VARIATION = 0.02
MAX_TENSION = 0.01


@criterion(
    "force at the first sample / rise",
    "<=",
    MAX_PRELOAD,
    "our choice: less may be the load cell's own zero",
)
def zero_recorded(preload: float, *, comes_through_air: bool) -> Finding:
    """The record shows the force at zero compression."""
    if comes_through_air:
        return Finding("The plate comes through air, so compression and force have their zero", 0.0)
    return Finding(
        "The record begins in contact. Compression counts from its first sample",
        preload,
        failure=f"The record begins in contact, under {100 * preload:.2g} % of the force. The "
        "compression before it is not known",
        remedy="Begin the record in air.",
    )


@criterion(
    "change of the force from the cycle before",
    "|x| <=",
    MAX_CYCLE_CHANGE,
    "our choice: what is left of softening is then within the scatter of seals",
)
def specimen_conditioned(change: float | None, *, cycle: int, softening: float) -> Finding:
    """The seal is conditioned: its force no longer falls from cycle to cycle (Mullins)."""
    if change is None:
        return Finding(
            "The figures are of cycle 1 of a seal; later cycles are softer",
            remedy=Remedy("Record three or more cycles.", "file-part", "cycle=N"),
            always_fails=True,
        )
    return Finding(
        f"Cycle {cycle} differs from the one before by {100 * change:+.2g} % of the force. The "
        f"first cycle carried {100 * softening:.2g} % more than the last",
        change,
        "The seal still softens, or had no time to recover",
        "Record more cycles.",
    )


@criterion(
    "depth / deepest before",
    "<=",
    MAX_DEPTH_RATIO,
    "our choice: Mullins' softening reaches as far as the seal was pressed before",
)
def depth_conditioned(ratio: float | None, cycle: int) -> Finding:
    """Earlier cycles compressed the seal as far as this one."""
    if ratio is None:
        return Finding("One cycle shows no depth of those before it")
    return Finding(
        f"Cycle {cycle} goes to {100 * ratio:.4g} % of the deepest compression before it",
        ratio,
        "Beyond that the seal is not conditioned",
        "Record every cycle to one depth.",
    )


@criterion("compression / depth", "<=", 1.0, "by definition: no reading beyond it")
def compressions_reached(largest: float, depth: float) -> Finding:
    """The cycle reaches every requested compression."""
    return Finding(
        f"Compressions up to {format_quantity(largest, 'mm')} are asked for; the cycle goes to "
        f"{format_quantity(depth, 'mm')}",
        largest / depth,
        remedy=Remedy("Press deeper, or ask for less.", "compression"),
    )


@criterion(
    "drift of the zero / force",
    "|x| <=",
    MAX_DRIFT,
    "our choice: a linear drift is then subtracted",
)
def load_cell_steady(drift: float | None) -> Finding:
    """The load cell reads the same force in air at the end as at the beginning."""
    if drift is None:
        return Finding("Air at one time only shows no drift of the load cell")
    return Finding(
        f"The zero of the load cell drifts by {100 * drift:+.2g} % of the force. A straight drift "
        "is taken off",
        drift,
        remedy="Let the load cell warm up.",
    )


@criterion(
    "largest deviation / compression",
    "<=",
    MAX_SPEED_VARIATION,
    "our choice: a stop of a twentieth of the stroke",
)
def plate_speed_constant(relative_variation: float | None) -> Finding:
    """The plate moves at a constant speed."""
    if relative_variation is None:
        return Finding("Without a clock there is no speed to judge")
    return Finding(
        f"The plate departs from a constant speed by {100 * relative_variation:.2g} % of the depth",
        relative_variation,
        "Where it slows down the seal relaxes, so the curve has no single speed",
        "Drive the plate at one speed.",
    )


@criterion(
    "energy lost / received",
    ">=",
    -0.02,
    "by physics; less is noise",
    grade="stop",
)
def no_energy_gained(hysteresis: float | None) -> Finding:
    """The seal returns no more energy than it received."""
    if hysteresis is None:
        return Finding("Without the unloading the energy returned is not known")
    return Finding(
        f"The seal loses {100 * hysteresis:.3g} % of the energy put in",
        hysteresis,
        "No seal makes energy, so force and displacement may be swapped",
        Remedy("Name the columns.", "column", "force=NAME"),
    )


@criterion(
    "tension / largest force",
    "<=",
    MAX_TENSION,
    "our choice: above the error of the load cell's zero",
)
def no_adhesion_on_release(tensile_force: float | None) -> Finding:
    """The seal does not stick to the plate during release."""
    if tensile_force is None:
        return Finding("Without air beside the release a pull on the plate is not seen")
    return Finding(
        f"On release the seal pulls on the plate with {100 * tensile_force:.2g} % of the force",
        tensile_force,
        "It sticks, so hysteresis and set contain its adhesion",
        "Clean or powder the plate.",
    )


@criterion(grade="note")
def unloading_recorded(*, is_recorded: bool) -> Finding:
    """The unloading was recorded."""
    return Finding(
        "Loading and unloading were recorded",
        failure="The unloading was not recorded, so hysteresis and returned energy are not known",
        remedy="Record the unloading.",
        always_fails=not is_recorded,
    )


@criterion(grade="note")
def length_stated(*, is_given: bool) -> Finding:
    """The length of the seal is given, so that forces are per 100 mm."""
    return Finding(
        "The length of the seal is known",
        failure="The length of the seal is not given, so forces are N of this specimen, not N per "
        "100 mm",
        remedy=Remedy("Give the length.", "length"),
        always_fails=not is_given,
    )


# -- the elastic law under the cycle

MAX_UNEXPLAINED = 0.03
MAX_LAW_DIFFERENCE = 0.05
LARGEST_LN_TAU_SE = 0.5
MIN_BIC_GAIN = 10.0


@criterion(
    "part of the energy", "|x| <=", MAX_UNEXPLAINED, "our choice: a tenth of a usual hysteresis"
)
def relaxation_explains_hysteresis(
    measured_loss: float | None, remaining_loss: float | None
) -> Finding:
    """With the relaxation removed, loading and unloading are one curve."""
    if measured_loss is None or remaining_loss is None:
        return Finding("Without the unloading the relaxation function cannot be checked")
    return Finding(
        f"The cycle loses {100 * measured_loss:.3g} % of its energy; without relaxation it "
        f"loses {100 * remaining_loss:+.2g} %",
        remaining_loss,
        "The seal has friction or softens within the cycle, or the relaxation test is of another "
        "seal",
        "Give the fit of a relaxation test of the same specimen.",
    )


@criterion("stroke / longest or shortest tau of the test", "x/", 1.0, "the valid band of the fit")
def stroke_within_relaxation_times(stroke: float | None, band: tuple[float, float]) -> Finding:
    """The stroke lasts as long as a relaxation time that the relaxation test covers."""
    if stroke is None:
        return Finding("No speed is known")
    longest, shortest = (1 / (2 * pi * end) for end in band)
    factor = max(stroke / longest, shortest / stroke, 1.0)
    return Finding(
        f"A stroke takes {stroke:.3g} s; the relaxation test covers {shortest:.2g} to "
        f"{longest:.3g} s",
        factor,
        "The relaxation function is extrapolated to the speed of the stroke",
        "Hold longer, or press slower.",
    )


@criterion(
    "relaxed force / k_inf x, less 1",
    "|x| <=",
    MAX_LAW_DIFFERENCE,
    "our choice: scatter of specimens",
)
def relaxed_agrees(difference: float | None, depth: float, k_inf: float) -> Finding:
    """The relaxed force agrees with the relaxation test at its compression."""
    force_text = (
        f"At {format_quantity(depth, 'mm')} the relaxation test has {k_inf * depth:.4g} N at rest"
    )
    if difference is None:
        return Finding(f"{force_text}. The cycle does not go so deep")
    return Finding(
        f"{force_text}. The load deflection without relaxation differs by {100 * difference:+.2g} "
        "%",
        difference,
        "It is another specimen, another conditioning, or another zero of the compression",
        Remedy("Give both lengths, and press both alike.", "length"),
    )


@criterion(
    "largest difference of F(t) / F at rest", "<=", MAX_LAW_DIFFERENCE, "scatter of specimens"
)
def relaxation_tests_agree(difference: float | None) -> Finding:
    """The relaxation tests at all compressions have the same relative relaxation."""
    if difference is None:
        return Finding("No speed is known, so the relaxation functions are not compared")
    return Finding(
        f"Over the time of a stroke the relaxation functions of the tests differ by "
        f"{100 * difference:.2g} %",
        difference,
        "Force and time do not separate, or the tests are of different seals. One relaxation "
        "function is valid near the compression of its test only",
        "Use the test held nearest to your compression.",
    )


@criterion(
    "BIC over that of a dashpot", "<=", MIN_BIC_GAIN, "Kass and Raftery 1995: very strong beyond"
)
def single_relaxation_explains_speeds(bic_difference: float) -> Finding:
    """Relaxation explains the speeds as well as a dashpot that depends on compression."""
    if bic_difference >= -MIN_BIC_GAIN:
        message = (
            "The speeds do not separate one relaxation function from a dashpot that depends on "
            "compression"
        )
    else:
        message = (
            "One relaxation function explains the speeds better than a dashpot that depends on "
            "compression"
        )
    return Finding(
        f"{message} (BIC {bic_difference:+.3g})",
        bic_difference,
        failure=f"A dashpot that depends on compression explains the speeds better than one "
        f"relaxation function (BIC {bic_difference:+.3g})",
        remedy="Use c(x) at your compression, not the arms of this fit.",
    )


@criterion("fastest / slowest", ">=", 10.0, "our choice: an arm shows over a decade of speeds")
def speeds_spread(ratio: float) -> Finding:
    """The speeds differ enough to determine a relaxation time."""
    return Finding(
        f"The speeds span a factor of {ratio:.3g}; at least 10 is needed",
        ratio,
        "Arms and elastic law cannot be separated",
        "Press a decade slower or faster.",
    )


@criterion("residual / noise", "<=", 2.0, "specimens 2 % apart: 3.4; one specimen: 0.9 to 1.1")
def speeds_residual_small(residual: float, noise: float, peak: float) -> Finding:
    """One elastic law and one relaxation function fit every speed to the noise or 0.1 %."""
    return Finding(
        f"The model misses {100 * residual / peak:.2g} % of the greatest force; the noise is "
        f"{100 * noise / peak:.2g} %",
        residual / max(noise, 1e-3 * peak),
        "The seal has friction, softens within the cycle, or is not one specimen. The arms are "
        "as much off",
        "Press one conditioned specimen at every speed.",
    )


@criterion(
    "longest relaxation time / slowest stroke", "<=", 1.0, "slower arms have not relaxed by then"
)
def slowest_stroke_quasi_static(longest: float | None, stroke: float) -> Finding:
    """The slowest stroke takes longer than the longest relaxation time."""
    if longest is None:
        return Finding("No relaxation time was found")
    return Finding(
        f"The slowest stroke takes {stroke:.3g} s, the longest relaxation time is {longest:.3g} s",
        longest / stroke,
        "The elastic law is extrapolated",
        "Press slower, or add a relaxation test.",
    )


@criterion(
    "standard error of ln tau",
    "<=",
    LARGEST_LN_TAU_SE,
    "as for the arms of a relaxation test",
    fit_status=Status.NOT_IDENTIFIED,
)
def relaxation_times_determined(error: float | None) -> Finding:
    """The data determine every relaxation time."""
    if error is None:
        return Finding("No relaxation time was found")
    return Finding(
        f"The least certain relaxation time is known to a factor of {1 + error:.3g}",
        error,
        remedy=Remedy("Test more speeds, or use fewer arms.", "arms"),
    )


@criterion("conditions that differ", "<=", 0, "by definition")
def specimens_tested_alike(differences: Sequence[str]) -> Finding:
    """The specimens were tested alike: speed, compression, cycle and temperature."""
    return Finding(
        "The specimens were tested alike",
        len(differences),
        failure=f"The specimens were not tested alike ({', '.join(differences)}). Part of their "
        "scatter "
        "comes from the tests",
        remedy="Test every specimen alike.",
    )


@criterion("Cpk", ">=", 1.33, "usual requirement (AIAG) for a known process")
def specimens_capable(capability: ProcessCapability, unit: str) -> Finding:
    """The force at the nominal compression keeps a margin to its limits."""
    low, high = capability.cpk_interval or (0.0, 0.0)
    return Finding(
        f"Cpk of the force at the nominal compression is "
        f"{'unknown' if capability.cpk is None else f'{capability.cpk:.2f}'} ({low:.2f} to "
        f"{high:.2f}); 1.33 is "
        f"asked. {capability.count} specimens, limits {capability.lower:g} to "
        f"{capability.upper:g} {unit}",
        capability.cpk,
        "" if high >= 1.33 else "The specimens scatter too much, or lie off centre",
        "Test more specimens." if high >= 1.33 else "Look at scatter and mean of the specimens.",
    )
