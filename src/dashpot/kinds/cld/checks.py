"""What a compression load deflection test can be trusted with, as criteria."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

from dashpot.base.capability import Capability
from dashpot.base.checks import Finding, criterion
from dashpot.base.status import Status
from dashpot.base.units import written
from dashpot.preparation.zero import MOST_PRELOAD

SETTLED = 0.02
DEEPER = 1.02
MOST_DRIFT = 0.02
EVEN = 0.02
PULLS = 0.01


@criterion(
    "force at the first sample / rise",
    "<=",
    MOST_PRELOAD,
    "our choice: less may be the load cell's own zero",
)
def zero_recorded(preload: float, *, air: bool) -> Finding:
    """The plate comes through air, or begins on a seal that carries nothing."""
    if air:
        return Finding("the plate comes through air: compression and force have their zero", 0.0)
    return Finding(
        "the record begins in contact: compression is counted from its first sample",
        preload,
        instead=f"the record begins in contact, under {100 * preload:.2g} % of the force: "
        "compression is counted from there, and how far the seal was pressed by then is not "
        "known; begin the record in air",
    )


@criterion(
    "change of the force from the cycle before",
    "|x| <=",
    SETTLED,
    "our choice: what is left of softening is then within the scatter of seals",
)
def conditioned(change: float | None, *, cycle: int, softening: float) -> Finding:
    """The seal has softened as far as it does in such cycles (Mullins)."""
    if change is None:
        return Finding(
            "the figures are of the first cycle of a seal: later ones are softer, by what this "
            "record does not tell; record three or more cycles",
            faulted=True,
        )
    return Finding(
        f"cycle {cycle} carries {100 * change:+.2g} % against the cycle before; the first cycle "
        f"carried {100 * softening:.2g} % more than the last",
        change,
        ": the seal still softens, or had no time to recover; record more cycles",
    )


@criterion(
    "depth / deepest before",
    "<=",
    DEEPER,
    "our choice: Mullins' softening reaches as far as the seal was pressed before",
)
def depth_conditioned(ratio: float | None, cycle: int) -> Finding:
    """The seal was pressed as deep in the cycles before."""
    if ratio is None:
        return Finding("one cycle shows no depth of those before it")
    return Finding(
        f"cycle {cycle} goes to {100 * ratio:.4g} % of the deepest compression before it",
        ratio,
        ": beyond that the seal is as it was never pressed; record every cycle to one depth",
    )


@criterion("compression / depth", "<=", 1.0, "beyond the depth there is no reading")
def compressions_reached(most: float, depth: float) -> Finding:
    """The cycle reaches every compression asked for."""
    return Finding(
        f"asked for up to {written(most, 'mm')}, pressed to {written(depth, 'mm')}",
        most / depth,
        ": nothing is said of what was not reached; press deeper, or ask for less",
    )


@criterion(
    "drift of the zero / force", "|x| <=", MOST_DRIFT, "our choice: then a line takes it off"
)
def load_cell_steady(drift: float | None) -> Finding:
    """The load cell reads in air at the end what it read at the beginning."""
    if drift is None:
        return Finding("air at one time alone shows no drift of the load cell")
    return Finding(
        f"the load cell's zero moves by {100 * drift:+.2g} % of the force, which is taken off",
        drift,
        ": between two stays in air it is only supposed to be a line; let the load cell warm up",
    )


@criterion(
    "largest departure / depth",
    "<=",
    EVEN,
    "our choice: a stop of a twentieth of the stroke",
)
def speed_even(departure: float | None) -> Finding:
    """The plate moves at one speed."""
    if departure is None:
        return Finding("without a clock nothing shows the speed")
    return Finding(
        f"the plate departs from a constant speed by {100 * departure:.2g} % of the depth",
        departure,
        ": where it waits or slows down the seal relaxes, so that the curve has no one speed",
    )


@criterion(
    "energy lost / put in",
    ">=",
    -0.02,
    "no seal gives back more than it is given; less is noise",
    grade="stop",
)
def energy_lost(hysteresis: float | None) -> Finding:
    """The seal gives back no more energy than was put in."""
    if hysteresis is None:
        return Finding("without the unloading nothing shows what is given back")
    return Finding(
        f"of the energy put in {100 * hysteresis:.3g} % is lost",
        hysteresis,
        ": a seal does not make energy; are force and displacement swapped (--column force=NAME)?",
    )


@criterion("pull / greatest force", "<=", PULLS, "our choice: a load cell's zero is known to less")
def released_freely(pull: float | None) -> Finding:
    """The seal leaves the plate as it is released, and does not pull on it."""
    if pull is None:
        return Finding("without air beside the release no pull on the plate is told from a zero")
    return Finding(
        f"as it is released the seal pulls on the plate with {100 * pull:.2g} % of the force",
        pull,
        ": it sticks, so that hysteresis and set are its adhesion's too; clean or powder the "
        "plate, or leave the release out of what the material is said to lose",
    )


@criterion(grade="note")
def unloading_recorded(*, recorded: bool) -> Finding:
    """The way back was recorded, too."""
    return Finding(
        "loading and unloading were recorded",
        instead="the unloading was not recorded: no hysteresis and no energy given back",
        faulted=not recorded,
    )


@criterion(grade="note")
def length_given(*, given: bool) -> Finding:
    """The length of the seal is known, so that forces are of 100 mm."""
    return Finding(
        "the length of the seal is known",
        instead="the length of the seal is not known: forces are N of this piece, not N per "
        "100 mm; give the length (--length)",
        faulted=not given,
    )


# -- the elastic law under the cycle

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


@criterion("conditions that differ", "<=", 0, "by definition")
def pieces_tested_alike(otherwise: Sequence[str]) -> Finding:
    """Pieces were pressed alike: speed, depth, cycle and temperature, so that they may scatter."""
    return Finding(
        "the pieces were tested alike",
        len(otherwise),
        instead=f"the pieces were not tested alike ({'; '.join(otherwise)}): part of their "
        "scatter is the testing's",
    )


@criterion("Cpk", ">=", 1.33, "AIAG's usual demand of a process that is known")
def pieces_capable(of: Capability, unit: str) -> Finding:
    """The force at the nominal compression keeps to its limits by a margin."""
    low, high = of.cpk_interval or (0.0, 0.0)
    return Finding(
        f"Cpk of the force at the nominal compression is "
        f"{'unknown' if of.cpk is None else f'{of.cpk:.2f}'} ({low:.2f} to {high:.2f}, "
        f"{of.count} pieces, {of.lower:g} to {of.upper:g} {unit})",
        of.cpk,
        ": test more pieces" if high >= 1.33 else ": they scatter too much, or lie off centre",
    )
