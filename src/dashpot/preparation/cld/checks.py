"""What a compression load deflection test can be trusted with, as criteria."""

from __future__ import annotations

from dashpot.base.checks import Finding, criterion
from dashpot.base.units import written
from dashpot.preparation.cld.zero import MOST_PRELOAD

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
        ": a seal does not make energy; are force and displacement swapped (--force, "
        "--displacement)?",
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
