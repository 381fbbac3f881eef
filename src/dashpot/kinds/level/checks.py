"""What an amplitude sweep, or FRFs at several levels, can be trusted with, as criteria."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base.checks import Finding, criterion
from dashpot.base.units import in_unit
from dashpot.kinds.level.record import moved_in

MATTERS = 20.0
FAR_ENOUGH = 2.0
LOST = 0.1
"""Part of F/X that is left where nothing was explained."""


@criterion(
    "2 ln likelihood ratio",
    ">",
    MATTERS,
    "linear truths: at most 12 over 40 seeds; slipping ones at least 199",
    grade="note",
)
def level_matters(
    gain: float, amplitudes: tuple[float, float], of: str, by: str, *, followed: bool = True
) -> Finding:
    """Stiffness or loss moves with amplitude as friction or a cubic spring does."""
    low, high = amplitudes
    linear = (
        f"no dependence on amplitude is seen from {low:.3g} to {high:.3g} {of} (2 ln L = "
        f"{gain:.3g}): the solid is linear there, and nothing is said of larger amplitudes"
    )
    return Finding(
        f"{by} explains what arms alone do not (2 ln L = {gain:.3g})",
        gain,
        instead=linear
        if followed
        else "neither friction nor a cubic spring nor arms alone explain the tests",
    )


@criterion("range of amplitudes", ">=", 3.0, "sweeps of one amplitude: other levels 7 % wrong")
def amplitudes_spread(ratio: float, of: str) -> Finding:
    """The tests cover amplitudes far enough apart to show what amplitude does."""
    return Finding(
        f"the amplitudes ({of}) span a factor of {ratio:.3g}",
        ratio,
        ", too narrow: each slider looks like a spring and a loss; test at a second level",
    )


@criterion("largest amplitude / X_c", ">=", FAR_ENOUGH, "below it the exponent and the share trade")
def softening_seen(reach: float) -> Finding:
    """The sweep goes beyond the amplitude where half of the stiffness is lost."""
    return Finding(
        f"the largest amplitude is {reach:.3g} times that at which half is lost",
        reach,
        ": the exponent was set to 0.5, and how much is lost in the end is extrapolated; sweep to "
        "larger amplitudes",
    )


@criterion("2 ln L of a term of X^4", "<=", MATTERS, "as of any dependence on amplitude")
def spring_cubic(gain: float) -> Finding:
    """The spring stiffens with the square of the amplitude."""
    return Finding(
        "the spring stiffens as a cubic one",
        gain,
        instead=f"the spring does not stiffen with the square of the amplitude alone "
        f"(2 ln L = {gain:.3g}), or the friction beside it is not Kraus's: k3 is of this range of "
        "amplitudes, and known as badly as its error says",
    )


@criterion("residual / modulus", "<=", 0.03, "real sweeps of filled rubbers leave 0.3 to 3 %")
def law_followed(residual: float) -> Finding:
    """The law follows the sweep."""
    return Finding(
        f"what is left is {100 * residual:.2g} % of the modulus",
        residual,
        ": this rubber softens in another way; take its numbers only where they were measured",
    )


@criterion("change of modulus, way down", "<=", 0.03, "as what a law may leave")
def ways_agree(change: float) -> Finding:
    """The way down through the amplitudes tells what the way up told."""
    way = "softer" if change < 0 else "stiffer"
    return Finding(
        f"at the same amplitude the way down is {100 * abs(change):.2g} % {way} than the way up",
        abs(change),
        ": the rubber remembers what was done to it (Mullins, no time to recover) or warmed, and "
        "the law is a mean of both; write the way that counts to a file of its own",
    )


@criterion("loss left / loss", "<=", 0.15, "our choice: a sixth of the damping")
def loss_followed(left: float) -> Finding:
    """The law follows the loss by itself, which is small beside the storage."""
    return Finding(
        f"what is left of the loss is {100 * left:.2g} % of it",
        left,
        ": the law's loss is not this rubber's, and a damping from it is as much off; take the "
        "loss where it was measured",
    )


@criterion("said / struck, a factor", "x/", 2.0, "hits of one intent differ by less")
def levels_as_struck(said: Sequence[float], struck: Sequence[float]) -> Finding:
    """Hits were as hard as is said of their files."""
    off = np.log(np.divide(said, struck))
    forces, names = (", ".join(f"{one:.3g}" for one in each) for each in (struck, said))
    within = np.log(2)
    if np.abs(np.log(np.divide(np.sort(said), np.sort(struck)))).max() <= within:
        why = "the levels belong to each other's files: give them in the order of the files"
    elif np.abs(np.abs(off) - np.log(1e3)).max() <= within and abs(off.sum()) > np.abs(off).max():
        why = "a factor of 1000: is the level, or the force in the files, in mN or kN?"
    else:
        why = (
            "the level of a hammer's file is the peak force of its hits; say that, or none, and if "
            "it is right look at the unit and the sensitivity of the force"
        )
    says = f"the hits show {forces} N (peaks, the median of each file)"
    return Finding(
        f"{says} and {names} N are said",
        float(np.exp(off[np.abs(off).argmax()])),
        instead=f"{says} where {names} N are said: {why}; the hits themselves count here",
    )


@criterion("FRFs of hits", "<=", 0.0, "their lines have no one amplitude")
def levels_held(struck: Sequence[str]) -> Finding:
    """Every FRF is of a motion that was held at a level, not of hits."""
    return Finding(
        "no FRF says that it is of hits",
        len(struck),
        instead=f"{', '.join(struck)}: of hits, whose motion dies away, so that no line has one "
        "amplitude and the peak of the force is no level; give the hammer's own records instead "
        "of their FRF, or FRFs of a shaker at a held level",
    )


@criterion(
    "residual / noise",
    "<=",
    1.4,
    "1 degree of phase: 1.5; sound records: 0.9 to 1.1",
    otherwise="stop where a tenth of F/X is left",
)
def levels_followed(residual: float, noise: float | None) -> Finding:
    """One solid with friction follows the FRFs of every level."""
    says = f"what is left is {100 * residual:.2g} % of F/X"
    if noise is None:
        return Finding(says + "; too few lines show how much of it is their noise")
    return Finding(
        f"{says}, noise {100 * noise:.2g} %",
        residual / noise,
        ": no arms, sliders and cubic spring explain every level; check the mass, which level "
        "belongs to which FRF, and the phase between the channels",
        grade="stop" if residual > LOST else "limit",
    )


@criterion("distance from the range, a factor", "<=", 1.0, "the amplitudes of the tests")
def level_covered(
    amplitude: float, tested: tuple[float, float], *, at: str, of: str = "m"
) -> Finding:
    """At the level asked for the seal moves as far as it did in a test."""
    unit, said = moved_in(of)
    size, least, most = (f"{in_unit(one, unit):.3g}" for one in (amplitude, *tested))
    low, high = tested
    factor = max(amplitude / high, low / amplitude)
    says = f"at {at} the seal {'moves' if of == 'm' else 'is moved by'} {size} {said}"
    range_ = f"{least} to {most} {said} of the tests"
    return Finding(
        f"{says}, within the {range_}",
        factor,
        instead=f"{says}, {factor:.3g} times beyond the {range_}: what slips there nobody has "
        "measured; test at that level",
    )
