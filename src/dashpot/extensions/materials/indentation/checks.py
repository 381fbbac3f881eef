"""Criteria on the fit of a contact."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.checks import Check, Finding, Remedy, criterion
from dashpot.base.reported_values import ReportedValue
from dashpot.base.units import GRAVITY
from dashpot.extensions.materials.indentation.collision import Collision
from dashpot.extensions.materials.indentation.datamodel import IndentationFit, IndentationTest
from dashpot.extensions.materials.indentation.preprocess import ContactInterval

SAMPLED = 20
FLIGHT = 0.1
ALIKE = 0.05
KNOWN_FACTOR = 1.25
"""A factor within which a parameter is known."""
FOLLOWED = 1.5
LOST = 0.02
SMALL_RESIDUAL = 2e-3
"""Largest relative residual of a record without noise."""
_NOISELESS_SHARE = 1e-4
"""Relative scatter in flight below which a record has no noise."""
_UNKNOWN = 100.0
"""Interval factor above which a value is undetermined."""
_COMPARED = ("restitution", "modulus", "depth")


def run_checks(
    fit: IndentationFit,
    hit: Collision,
    test: IndentationTest,
    *,
    contact: ContactInterval,
    clipped_count: int,
    other_laws: Sequence[tuple[str, Sequence[ReportedValue]]],
) -> tuple[Check, ...]:
    """Every check of a contact."""
    time_since_touch, T = fit.time, fit.duration
    duration_before, duration_after = (
        float(-time_since_touch[0] / T),
        float(time_since_touch[-1] / T - 1),
    )
    size = float(np.ptp(fit.modelled)) or 1.0
    is_noiseless = fit.noise < _NOISELESS_SHARE * size
    relative = fit.residual * size / fit.noise if not is_noiseless else None
    stated_velocity = test.indenter.stated_velocity
    names = [
        reported_value
        for reported_value in fit.reported_values
        if reported_value.name in {"k", "c", "viscous_time", "g", "tau"}
    ]
    bounded_values = [name for name in names if name.low > 0] or names
    worst = max(
        bounded_values, key=lambda reported_value: reported_value.high / reported_value.value
    )
    limit_text = ", ".join(
        f"{name.name.replace('_', ' ')} is below {name.high:.3g} {name.unit}".strip()
        for name in names
        if name.low == 0
    )
    return (
        contact_sampled(T / test.step),
        flights_recorded(duration_before, duration_after),
        sensor_in_range(clipped_count),
        first_contact(contact.contacts_before, contact.contacts_after),
        law_residual_small(relative, fit.residual),
        no_adhesion_on_release(*_compute_undershoot(fit, size)),
        parameters_determined(
            worst.name,
            worst.high / worst.value,
            limit_text,
            leading_factor=_get_widest_interval(fit),
        ),
        laws_agree(fit, other_laws),
        velocity_agrees(fit["impact_velocity"].value, stated_velocity),
        gravity_stated(GRAVITY * T / hit.approach, stated_velocity),
        force_agrees(_compute_force_ratio(fit, test)),
        indentation_shallow(hit.depth, test.indenter.radius),
        sensor_fast_enough(_noise_correlation_fraction(fit, test.step)),
    )


def _compute_undershoot(fit: IndentationFit, size: float) -> tuple[float | None, float]:
    """Return the mean record after release over the push, and its noise; None where it ends."""
    if fit.quantity not in {"acceleration", "force"}:
        return None, 0.0
    is_after_contact = (fit.time > 1.02 * fit.duration) & (fit.time < 1.25 * fit.duration)
    count = int(np.count_nonzero(is_after_contact))
    if count < 4:
        return None, 0.0
    return float(np.mean(fit.measured[is_after_contact])) / size, 4 * fit.noise / size / np.sqrt(
        count
    )


def _compute_force_ratio(fit: IndentationFit, test: IndentationTest) -> float | None:
    """Return the impulse of a recorded force over mass times the change of speed."""
    if test.force is None or test.quantity == "force" or test.indenter.mass is None:
        return None
    time_since_touch = test.time - fit.touch
    in_contact = (time_since_touch > -0.05 * fit.duration) & (
        time_since_touch < 1.05 * fit.duration
    )
    is_near_contact = (time_since_touch > -0.5 * fit.duration) & (
        time_since_touch < 1.5 * fit.duration
    )
    rest_force = (
        float(np.median(test.force[is_near_contact & ~in_contact]))
        if (is_near_contact & ~in_contact).any()
        else 0.0
    )
    impulse = abs(float(np.sum(test.force[in_contact] - rest_force))) * test.step
    speed = fit["impact_velocity"].value
    change = speed * (1 + fit["restitution"].value) + test.indenter.gravity * fit.duration
    return impulse / (test.indenter.mass * change)


def _noise_correlation_fraction(fit: IndentationFit, step: float) -> float | None:
    """Return the correlation time of the noise in flight, over the length of the contact."""
    residual = (fit.measured - fit.modelled)[fit.time < 0]
    if len(residual) < 24 or fit.noise < _NOISELESS_SHARE * float(np.ptp(fit.modelled)):
        return None
    residual = residual - residual.mean()
    difference_ratio = float(
        np.sum(np.diff(residual) ** 2) / np.sum(residual**2)
    )  # 2 where it is white
    correlation = min(max(1 - difference_ratio / 2, 0.0), 0.999)
    return -step / np.log(correlation) / fit.duration if correlation > 0 else 0.0


@criterion(
    "samples in contact", ">=", SAMPLED, "below it, first contact and damping are correlated"
)
def contact_sampled(samples: float) -> Finding:
    """The contact has enough samples to show its shape."""
    return Finding(
        f"The contact has {samples:.0f} samples; at least {SAMPLED} are needed",
        samples,
        remedy="Sample faster.",
    )


@criterion(
    "shorter flight / contact",
    ">=",
    FLIGHT,
    "our choice: a tenth of the contact shows offset and touch",
    other_grade="stop where a third of the contact is missing",
)
def flights_recorded(duration_before: float, duration_after: float) -> Finding:
    """The record begins before the contact and ends after the release."""
    short = min(duration_before, duration_after)
    verb = "begins" if duration_before <= duration_after else "ends"
    where_text = "before the touch" if duration_before <= duration_after else "after the release"
    message = f"The record {verb} {abs(short):.2g} contact times {where_text}"
    reason = "Offset, touch and damping cannot be separated" if short >= 0 else ""
    instead = (
        f"The record {verb} in the contact: {100 * -short:.0f} % of it is missing, so stiffness "
        "and damping are not known"
        if short < 0
        else ""
    )
    return Finding(
        message,
        short,
        reason,
        "Trigger earlier, and record longer.",
        instead,
        grade="stop" if short < -1 / 3 else "limit",
    )


@criterion("samples at the limit", "<=", 0.0, "a sensor at its limit repeats one number")
def sensor_in_range(clipped_count: int) -> Finding:
    """The sensor did not saturate."""
    return Finding(
        f"{clipped_count} samples have the same largest value",
        float(clipped_count),
        "The sensor or its amplifier was clipped. These samples were left out",
        "Use a larger range, or hit more softly.",
    )


@criterion("earlier contacts", "<=", 0.0, "later contacts are slower bounces")
def first_contact(earlier_contacts: int, later_contacts: int) -> Finding:
    """The fitted contact is the first one of the record."""
    more_text = f"; {later_contacts} later contacts were left out" if later_contacts else ""
    return Finding(
        f"{earlier_contacts} contacts come before the one fitted{more_text}",
        float(earlier_contacts),
        "The body did not meet the surface at rest, or something else touched it",
        "Cut the record.",
    )


@criterion(
    "residual in contact / in flight",
    "<=",
    FOLLOWED,
    "faultless records: 0.8 to 1.3",
    other_grade="stop where a fiftieth of the push is left",
)
def law_residual_small(ratio: float | None, residual: float) -> Finding:
    """The contact law fits the contact to within the noise."""
    return Finding(
        f"The contact law misses the force by {100 * residual:.2g} % of the push"
        + (f", {ratio:.2g} times the noise in flight" if ratio is not None else ""),
        ratio,
        "Yielding, adhesion, a double contact, a thin layer, or a filter may cause this",
        "Use the numbers for this hit only.",
        always_passes=ratio is not None and residual <= SMALL_RESIDUAL,
        grade="stop" if residual > LOST else "limit",
    )


@criterion(
    "tension after release / contact force", ">=", -0.02, "our choice: a fiftieth of the push"
)
def no_adhesion_on_release(tensile_force: float | None, noise: float) -> Finding:
    """Nothing holds the indenter back as it leaves the surface."""
    if tensile_force is None:
        return Finding("No acceleration or force shows the release", None)
    return Finding(
        f"After the release {100 * tensile_force:.2g} % of the push is recorded",
        min(tensile_force + noise, 0.0) if tensile_force < 0 else tensile_force,
        "The surface is sticky, or the sensor does not pass low frequencies",
        "Clean the surface, or use another sensor.",
    )


@criterion(
    "worst interval, a factor",
    "<=",
    KNOWN_FACTOR,
    "our choice: a quarter",
    other_grade="note where stiffness, depth, restitution and modulus are",
)
def parameters_determined(
    name: str, factor: float, limit_text: str = "", *, leading_factor: float = np.inf
) -> Finding:
    """Each parameter is known to 25 %, or the loss has an upper limit.

    `leading_factor` is the worst of stiffness, depth, restitution and modulus; what shares a loss
    among other parameters is in their intervals.
    """
    word = name.replace("_", " ")
    sentence = f"{word} is known within a factor of {factor:.4g}"
    if factor >= _UNKNOWN:
        sentence = f"{word} is not known, not even in its size"
    return Finding(
        sentence + f"; {limit_text}" * bool(limit_text),
        factor,
        f"This contact does not determine {word} alone",
        "Use the numbers with narrow intervals.",
        grade="note" if leading_factor <= KNOWN_FACTOR else None,
    )


def _get_widest_interval(fit: IndentationFit) -> float:
    """The widest interval, as a factor, of the main results of a contact."""
    return max(
        reported_value.high / reported_value.value
        for reported_value in fit.reported_values
        if reported_value.name in {"k", *_COMPARED}
    )


@criterion("largest difference between contact laws", "<=", ALIKE, "our choice: 5 %")
def laws_agree(
    fit: IndentationFit, other_laws: Sequence[tuple[str, Sequence[ReportedValue]]]
) -> Finding:
    """Contact laws that fit equally well give the same restitution, modulus and depth."""
    if not other_laws:
        return Finding(f"No other contact law fits the record as well as {fit.law}", 0.0)
    separate = []
    for law, reported_values in other_laws:
        other_values = {
            reported_value.name: reported_value.value for reported_value in reported_values
        }
        for reported_value in fit.reported_values:
            if reported_value.name in _COMPARED and reported_value.name in other_values:
                separate.append(
                    (
                        abs(other_values[reported_value.name] / reported_value.value - 1),
                        law,
                        reported_value.name,
                    )
                )
    largest, law, name = max(separate)
    return Finding(
        f"{law} explains the contact too; its {name} differs by {100 * largest:.2g} %",
        largest,
        "The record does not separate the two contact laws",
        Remedy("Hit at another speed or with another mass, or name the contact law.", "model"),
    )


@criterion(
    "recorded speed / stated",
    "x/",
    1.04,
    "faultless records 0.993 to 1.012; depth and k are then 4 to 5 % wrong",
)
def velocity_agrees(speed: float, stated_velocity: float | None) -> Finding:
    """The recorded speed agrees with the stated one."""
    if stated_velocity is None:
        return Finding("No height of fall or speed was given to compare with", None)
    ratio = speed / stated_velocity
    unit = next(
        (
            f"The factor is that between {word}. "
            for factor, word in ((GRAVITY, "g and m/s^2"), (1e3, "units a thousandfold apart"))
            if 0.85 < ratio / factor < 1.18 or 0.85 < ratio * factor < 1.18
        ),
        "",
    )
    return Finding(
        f"The record shows an approach at {speed:.4g} m/s; {stated_velocity:.4g} m/s was given",
        ratio,
        f"{unit}Depth, k and modulus scale with it",
        Remedy("Check unit and sensitivity, the mass and the height.", "units"),
    )


@criterion(
    "gravity x contact / speed",
    "<=",
    0.01,
    "if not stated, k, depth and e have an error of this size",
)
def gravity_stated(part: float, stated_gravity: float | None) -> Finding:
    """The direction of gravity is stated, or it makes no difference."""
    message = f"Over the contact gravity changes the speed by {100 * part:.2g} %"
    return Finding(
        message if stated_gravity is None else "Whether the indenter falls is known",
        part if stated_gravity is None else None,
        "Whether the indenter falls is not given",
        Remedy("Give the height of fall, or the speed of approach.", "drop-height"),
    )


@criterion("impulse / change of momentum", "x/", 1.1, "our choice: 5 % for two sensors")
def force_agrees(ratio: float | None) -> Finding:
    """The recorded force and the recorded motion give the same change of momentum."""
    if ratio is None:
        return Finding("No force was recorded beside the motion", None)
    return Finding(
        f"The recorded force gives {ratio:.4g} times the change of momentum",
        ratio,
        "The mass, or one of the sensitivities, is wrong",
        Remedy("Check the mass and the sensitivities.", "mass"),
    )


@criterion(
    "depth / radius", "<=", 0.3, "I. N. Sneddon, Int. J. Eng. Sci. 3 (1965) 47: 3.5 % in the force"
)
def indentation_shallow(depth: float, radius: float | None) -> Finding:
    """The indentation is shallow relative to the radius, as Hertz assumes."""
    if radius is None:
        return Finding("No radius is given, so there is no modulus", None)
    return Finding(
        f"The depth is {depth / radius:.2g} of the radius",
        depth / radius,
        "A sphere is no paraboloid so deep, and the modulus is too low",
        "Hit more softly, or use a larger sphere.",
    )


@criterion(
    "correlation time of the noise / contact",
    "<=",
    0.03,
    "our choice: a filter distorts such a pulse",
)
def sensor_fast_enough(fraction: float | None) -> Finding:
    """Sensor and filter are fast relative to the contact."""
    if fraction is None:
        return Finding("Too little flight is recorded to see a filter in its noise", None)
    return Finding(
        f"The noise is correlated over {100 * fraction:.2g} % of the contact",
        fraction,
        "A filter, a slow sensor or hum widens the pulse and adds damping",
        "Record without a filter.",
    )
