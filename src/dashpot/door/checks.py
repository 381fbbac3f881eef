"""What a door on its seal can be trusted with, as criteria with a sentence."""

from __future__ import annotations

import math
from collections.abc import Sequence

from dashpot.base.checks import Finding, criterion
from dashpot.base.units import written

NOT_THERE = 0.3
"""m, beyond which shapes are not those of this door."""
ANOTHER = 2.0
"""Ratio of masses, so too."""
HELD_BY_SEAL = 0.01
"""Share of a mode's energy, or of its loss, in the seal above which its test has a say."""


@criterion("distance from the band, a factor", "<=", 1.0, "the band of the fit")
def door_modes_informed(
    modes: Sequence[tuple[float, float]], band: tuple[float, float] | None
) -> Finding:
    """Modes of which the seal holds or loses a hundredth lie where its test informs it.

    `modes` are their frequencies, Hz, and the seal's share of their energy or loss.
    """
    felt = [f for f, share in modes if share > HELD_BY_SEAL]
    if band is None or not felt:
        return Finding("the seal holds no mode of the door, or the band of its test is not known")
    low, high = band
    if not high > 0:
        return Finding("no test that the fit of the seal knows of informs a mode", math.inf)
    away = {f: max(f / high, low / f) for f in felt}
    outside = [f for f in felt if away[f] > 1]
    worst = max(away.values())
    listed = ", ".join(f"{f:.4g}" for f in outside[:4]) + (", ..." if len(outside) > 4 else "")
    return Finding(
        f"all {len(felt)} modes that the seal holds lie in the band of its test",
        worst,
        instead=f"{len(outside)} of {len(felt)} modes that the seal holds ({listed} Hz) lie "
        f"outside what its test informs, {low:.2g} to {high:.3g} Hz, up to x{worst:.3g}: stiffness "
        "and loss of the seal are extrapolated there; test it faster, in the cold or with a hammer",
    )


@criterion(
    "part of the line", "<=", 0.0, "by definition: there it leaks",
    otherwise="stop where nothing is pressed",
)  # fmt: skip
def seal_touches(part: float, *, length: float, least: float, where: float, most: float) -> Finding:
    """The seal reaches its counterpart all along the line."""
    if most <= 0:
        return Finding(
            f"no station of the seal is pressed: the compression is {written(most, 'mm', '.3g')} "
            "at most, so the seal holds nothing. Check compression, gap and height in [seal], and "
            "their units",
            part,
            faulted=True,
            grade="stop",
        )
    return Finding(
        "the seal touches all along the line",
        part,
        instead=f"{written(part * length, 'mm')} of {length:.3g} m of seal do not touch, most at "
        f"{where:.4g} m along the line, by {written(-least, 'mm', '.3g')}: no force there, and a "
        "leak",
    )


@criterion(source="our choice: most door seals are closed", grade="note")
def line_closed(length: float, apart: float) -> Finding:
    """The seal line ends where it begins."""
    return Finding(
        f"the seal line of {length:.4g} m is closed",
        instead=f"the seal line of {length:.4g} m ends {written(apart, 'mm')} from where it "
        "begins: is that so, or is its last point missing?",
        faulted=apart > 0,
    )


@criterion("change of frequency", "<=", 1e-3, "our choice: below what a door is tuned to")
def stations_suffice(change: float, pitch: float) -> Finding:
    """Half the distance of the stations changes no mode."""
    return Finding(
        f"with stations twice as dense as {written(pitch, 'mm')} no mode moves by more than "
        f"{100 * change:.2g} %",
        change,
        ": take a smaller pitch in [seal]",
    )


@criterion("change of frequency", "<=", 5e-3, "our choice: half a percent")
def modes_suffice(change: float | None, kept: int, highest: float) -> Finding:
    """The elastic modes of the door are enough: without the upper third of them little changes."""
    if change is None:
        return Finding(f"{kept} elastic modes are too few to tell whether they are enough")
    return Finding(
        f"without the upper third of {kept} elastic modes, to {highest:.4g} Hz, those below move "
        f"by {100 * change:.2g} %",
        change,
        ": give more modes of the door, to higher frequencies",
    )


@criterion(
    "distance, m", "<=", 0.03, "our choice: a tenth of a short panel wave",
    otherwise="stop beyond 0.3",
)  # fmt: skip
def shapes_known_there(away: float, place: str) -> Finding:
    """Shapes are known near the seal, the supports and the points."""
    return Finding(
        f"the shapes are known within {written(away, 'mm', '.3g')} of all places that are used",
        away,
        instead=f"the shapes are known only {written(away, 'mm', '.3g')} from {place}: export "
        "points there, or check the axes and the unit of the modes",
        grade="stop" if away > NOT_THERE else "limit",
    )


@criterion("ratio of masses", "x/", 1.05, "5 %: trim is often left out", otherwise="stop beyond 2")
def masses_agree(stated: float, implied: float) -> Finding:
    """The rigid modes weigh what [door] says."""
    return Finding(
        f"the rigid modes weigh {implied:.4g} kg, [door] says {stated:.4g} kg",
        implied / stated,
        ": the modal masses or the units of the modes are not what was said, or the modes are of "
        "another door",
        grade="limit" if 1 / ANOTHER <= implied / stated <= ANOTHER else "stop",
    )


@criterion("motions", "<=", 0, "by definition")
def door_held(loose: int) -> Finding:
    """Something holds the door in every motion in which it is free."""
    return Finding(
        "every motion of the door is held",
        loose,
        instead=f"{loose} motions of the door are held by nothing, and have no natural frequency: "
        "is a hinge or the latch missing, or does one act along one direction alone?",
    )


@criterion("distance from the band, a factor", "<=", 1.0, "the band of the fit")
def closing_informed(
    seconds: float,
    band: tuple[float, float] | None,
    *,
    glassy: float,
    known: tuple[float, float] | None,
) -> Finding:
    """A door that closes presses its seal as slowly as the test of it informs.

    An even press over a time T is taken as a quarter of a period, 1/(4 T); `glassy` is
    k_0/k_inf of the fit, `known` the least speeds that its doubt leaves, m/s.
    """
    if band is None or not band[1] > 0 or not seconds > 0:
        return Finding("the band that the test of the seal informs is not known")
    factor = 1 / (4 * seconds) / band[1]
    speeds = ""
    if known is not None:
        ends = f"{known[0]:.3g} to {known[1]:.3g} m/s"
        if math.isinf(known[1]):
            ends = f"{known[0]:.3g} m/s or more"
        speeds = f"; with what its test leaves open for faster arms, the least speed is {ends}"
    return Finding(
        f"the door presses its seal in {written(seconds, 'ms', '.3g')}, as slowly as its test "
        "informs",
        factor,
        instead=f"the door presses its seal in {written(seconds, 'ms', '.3g')}, x{factor:.3g} "
        f"faster than its test informs: there it answers with all but all its arms, {glassy:.3g} "
        f"times its relaxed force by the fit{speeds}; test it faster, in the cold or with a hammer",
    )


@criterion(source="by definition", grade="note")
def faster_doors_close(closes: bool) -> Finding:
    """Every door that is faster than the least speed closes."""
    return Finding(
        "every faster door that was tried closes too",
        instead="some faster doors do not close: the least speed is not the only limit; look at "
        "the air, which takes more the faster the door",
        faulted=not closes,
    )
