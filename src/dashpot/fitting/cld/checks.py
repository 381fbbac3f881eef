"""What the elastic law of a load deflection test can be trusted with, as criteria."""

from __future__ import annotations

from math import pi

from dashpot.base.checks import Finding, criterion

UNEXPLAINED = 0.03
AGREES = 0.05


@criterion("part of the energy", "|x| <=", UNEXPLAINED, "our choice: a tenth of a usual hysteresis")
def memory_explains(raw: float | None, left: float | None) -> Finding:
    """Without the memory, loading and unloading fall onto one curve."""
    if raw is None or left is None:
        return Finding("without the unloading nothing shows whether the memory is the right one")
    return Finding(
        f"the cycle loses {100 * raw:.3g} % of its energy; without the memory {100 * left:+.2g} % "
        "are left",
        left,
        ": the seal rubs or softens within the cycle, or its memory is another than that of the "
        "relaxation test",
    )


@criterion("stroke / longest or shortest time of the test", "x/", 1.0, "the band of the fit")
def stroke_within_memory(stroke: float | None, band: tuple[float, float]) -> Finding:
    """The stroke takes as long as a time that the relaxation test informs."""
    if stroke is None:
        return Finding("no speed is known")
    longest, shortest = (1 / (2 * pi * end) for end in band)
    factor = max(stroke / longest, shortest / stroke, 1.0)
    return Finding(
        f"a stroke takes {stroke:.3g} s, and the relaxation test informs {shortest:.2g} to "
        f"{longest:.3g} s",
        factor,
        ": the memory is extrapolated to the speed of the stroke; hold longer, or press slower",
    )


@criterion("relaxed force / k_inf x, less 1", "|x| <=", AGREES, "our choice: pieces scatter so")
def relaxed_agrees(difference: float | None, depth: float, k_inf: float) -> Finding:
    """The relaxed force is that of the relaxation test at the compression that it was held at."""
    held = f"at {1e3 * depth:.4g} mm the relaxation test has {k_inf * depth:.4g} N at rest"
    if difference is None:
        return Finding(f"{held}; the cycle does not go so deep")
    return Finding(
        f"{held}, the load deflection without its memory {100 * difference:+.2g} %",
        difference,
        ": another piece, another conditioning, or another zero of the compression; say both "
        "lengths, and press both alike",
    )
