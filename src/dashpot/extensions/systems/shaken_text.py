"""Text of a mass on seals whose base shakes at random."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dashpot.base.units import convert_to_unit, format_quantity

if TYPE_CHECKING:
    from dashpot.workflow.frf_prediction import Prediction


def format_shaken_mass(prediction: Prediction) -> list[str]:
    """Return the response of a mass on seals to a random base as text, with its upper limit."""
    mass = prediction.random
    assert mass is not None  # noqa: S101
    band, response = mass.band, mass.response
    band_text = "" if band is None else f" ({band[0]:.4g} to {band[1]:.4g} Hz)"
    sentence = (
        f"  shaken by {mass.excitation}{band_text}, the mass has {response.acceleration:.4g} "
        f"m/s^2 rms and the seals move {format_quantity(response.stretch, 'mm')} rms, "
        f"{response.crossings:.4g} times a second"
    )
    lines = [sentence]
    if (limits := mass.limits) is not None:
        text, name = _format_limits(limits.acceleration), _format_limits(limits.stretch, "mm")
        low, high = limits.band_hz
        part = "" if band is not None else f", to the noise from {low:.4g} to {high:.4g} Hz"
        lines.append(f"  the relaxation test limits these to {text} m/s^2 and {name} mm rms{part}")
    return lines


def _format_limits(limits: tuple[float, float], unit: str = "1") -> str:
    """Return limits as text; an infinite upper one is "unlimited"."""
    low, high = (convert_to_unit(end, unit) for end in limits)
    return f"{low:.3g} to {f'{high:.3g}' if math.isfinite(high) else 'unlimited'}"
