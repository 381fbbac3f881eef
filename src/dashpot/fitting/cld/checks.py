"""What the elastic law of a load deflection test can be trusted with, as criteria."""

from __future__ import annotations

from math import pi

from dashpot.base.checks import Finding, criterion
from dashpot.base.status import Status
from dashpot.base.units import written

UNEXPLAINED = 0.03
AGREES = 0.05
TOLD = 0.5
BETTER = 10.0


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
    held = f"at {written(depth, 'mm')} the relaxation test has {k_inf * depth:.4g} N at rest"
    if difference is None:
        return Finding(f"{held}; the cycle does not go so deep")
    return Finding(
        f"{held}, the load deflection without its memory {100 * difference:+.2g} %",
        difference,
        ": another piece, another conditioning, or another zero of the compression; say both "
        "lengths, and press both alike",
    )


@criterion("largest difference of F(t) / F at rest", "<=", AGREES, "as pieces scatter")
def memories_agree(apart: float | None) -> Finding:
    """The relaxation tests have one memory, whatever depth they were held at."""
    if apart is None:
        return Finding("no speed is known, so over what times memories should agree is not told")
    return Finding(
        f"over the time of a stroke the memories of the relaxation tests differ by "
        f"{100 * apart:.2g} %",
        apart,
        ": force and time do not separate, and a law with one memory holds near the compression "
        "alone whose test it was taken from; or the tests are of different seals",
    )


@criterion("BIC over that of a dashpot", "<=", BETTER, "Kass and Raftery 1995: very strong beyond")
def memory_suffices(over: float) -> Finding:
    """One memory explains the speeds as well as a dashpot that depends on compression does."""
    if over >= -BETTER:
        says = "the speeds do not tell one memory from a dashpot that depends on compression"
    else:
        says = "one memory explains the speeds better than a dashpot that depends on compression"
    return Finding(
        f"{says} (BIC {over:+.3g})",
        over,
        instead=f"a dashpot that depends on compression explains the speeds better than one memory "
        f"does (BIC {over:+.3g}): take c(x) at the compression of use, not the arms of this fit",
    )


@criterion("fastest / slowest", ">=", 10.0, "our choice: one arm is told over a decade of speeds")
def speeds_spread(ratio: float) -> Finding:
    """The speeds lie far enough apart to tell a memory."""
    return Finding(
        f"the speeds span a factor of {ratio:.3g}",
        ratio,
        ", too narrow: arms and elastic law trade; press a decade slower or faster",
    )


@criterion("residual / noise", "<=", 2.0, "pieces 2 % apart: 3.4; one piece: 0.9 to 1.1")
def speeds_followed(residual: float, noise: float, peak: float) -> Finding:
    """One law and one memory follow every speed, in and back, to the noise or 0.1 %."""
    return Finding(
        f"what is left is {100 * residual / peak:.2g} % of the greatest force, the noise "
        f"{100 * noise / peak:.2g} %",
        residual / max(noise, 1e-3 * peak),
        ": the seal rubs, softens within the cycle, or is not one piece, and arms are as much off; "
        "press one piece, conditioned, at every speed",
    )


@criterion("longest time / slowest stroke", "<=", 1.0, "what is slower is not at rest by then")
def slowest_relaxed(longest: float | None, stroke: float) -> Finding:
    """The slowest stroke is slow against the longest relaxation time."""
    if longest is None:
        return Finding("no memory was found")
    return Finding(
        f"the slowest stroke takes {stroke:.3g} s, the longest relaxation time is {longest:.3g} s",
        longest / stroke,
        ": the law at rest is extrapolated; press slower, or hold a relaxation test",
    )


@criterion(
    "standard error of ln tau",
    "<=",
    TOLD,
    "as for the arms of a relaxation test",
    ends=Status.NOT_IDENTIFIED,
)
def memory_told(error: float | None) -> Finding:
    """Every relaxation time is told."""
    if error is None:
        return Finding("no memory was found")
    return Finding(
        f"the least known relaxation time is known to a factor of {1 + error:.3g}",
        error,
        ": more speeds, or fewer arms",
    )
