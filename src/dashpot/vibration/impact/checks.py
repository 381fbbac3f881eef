"""What the hits say about each other, and what the FRF can be trusted with."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dashpot.base.arrays import BoolArray, FloatArray
from dashpot.base.checks import Check
from dashpot.records.frf import FRF, Mode
from dashpot.vibration.impact.estimators import Estimator, Spectra, estimate, leave_one_out
from dashpot.vibration.impact.mass_line import apparent_mass, mass_line_check
from dashpot.vibration.impact.quality import Verdict
from dashpot.vibration.impact.rocking import Combination

ENOUGH = 3  # good hits
COHERENT = 0.9
LINES = 5  # in the half-power band
TIME_CONSTANTS = 6  # of decay that a record should hold: FRF errors below 0.5 %
WEAK = 10.0  # dB that the force may have fallen at the resonance
ROCKING = 0.05
OFF_CENTRE = 0.25  # of the bounce that rocking may be at the accelerometers
OUTLIER = 5.0  # times the usual disagreement between a hit and the others
DISAGREES = 0.1


def agreement(
    spectra: Spectra,
    verdicts: Sequence[Verdict],
    taken: BoolArray,
    accept: Sequence[str],
) -> tuple[list[Verdict], BoolArray]:
    """Hold each hit against the others; leave out one that the others contradict.

    With fewer than four hits nobody can say who is wrong, so none is left out.
    """
    verdicts, taken = list(verdicts), taken.copy()
    apart = disagreement(spectra.only(taken))
    if apart is None:
        return verdicts, taken
    usual = float(np.median(apart))
    for i, value in zip(np.flatnonzero(taken), apart, strict=True):
        if value < max(OUTLIER * usual, DISAGREES):
            continue
        says = (
            f"incoherent: its response differs by {100 * value:.0f} % from what the other hits "
            f"predict, where {100 * usual:.1f} % is usual"
        )
        if np.count_nonzero(taken) > ENOUGH:
            verdicts[i] = replace(verdicts[i], faults=(*verdicts[i].faults, says))
            taken[i] = str(i + 1) in accept
        else:
            verdicts[i] = replace(verdicts[i], doubts=(*verdicts[i].doubts, says))
    return verdicts, taken


def disagreement(spectra: Spectra) -> FloatArray | None:
    """How far each response is from what another hit's FRF makes of its force, relative.

    The median over the other hits, so that one bad hit does not discredit the good ones.
    """
    if spectra.averages < ENOUGH:
        return None
    force, response = spectra.force, spectra.response
    each = response / force
    size = np.linalg.norm(response, axis=1)
    apart = [
        np.linalg.norm(response[i] - np.delete(each, i, axis=0) * force[i], axis=1) / size[i]
        for i in range(spectra.averages)
    ]
    return np.asarray(np.median(apart, axis=1))


def checks_of(
    frf: FRF,
    spectra: Spectra,
    estimator: Estimator,
    combination: Combination | None,
    mass: float | None,
) -> tuple[Check, ...]:
    """Every named question to a measured FRF."""
    modes = frf.modes()
    main = modes[0] if modes else None
    checks = [_enough(frf), _coherent(frf, main), _resonance(frf, main)]
    if main is not None:
        checks += [_long_enough(frf, main), _lines(frf, main), _excited(frf, spectra, main)]
    if spectra.averages >= ENOUGH and main is not None:
        checks.append(_stable(frf, spectra, estimator, main))
    if combination is not None:
        checks += [_rocking(frf, combination), _centred(frf, combination)]
    if mass is not None:
        apparent = None
        if main is not None:
            apparent = apparent_mass(
                frf.frequency,
                frf.value,
                natural_frequency=main.frequency,
                shift=frf.shift,
                sd=frf.sd,
            )
        checks.append(mass_line_check(apparent, mass))
    return tuple(checks)


def _enough(frf: FRF) -> Check:
    n = frf.averages
    left_out = len(frf.hits) - n
    says = f"{n} of {n + left_out} hits averaged"
    if n >= ENOUGH:
        return Check("hits_enough", True, says, n, ENOUGH)
    return Check(
        "hits_enough",
        False,
        f"{says}: too few to trust an average or to tell its error; hit at least {ENOUGH} times, "
        "better 5",
        n,
        ENOUGH,
    )


def _coherent(frf: FRF, main: Mode | None) -> Check:
    if frf.coherence is None:
        return Check(
            "coherence",
            False,
            "there is no coherence of a single hit: it would be 1 whatever was measured; hit again",
            None,
            COHERENT,
        )
    at = int(np.argmax(np.abs(frf.value)))
    if main is not None:
        at = int(np.argmin(np.abs(frf.frequency - main.frequency)))
    near = slice(max(at - 1, 0), at + 2)
    value = float(frf.coherence[near].min())
    says = f"coherence at the resonance ({frf.frequency[at]:.4g} Hz) is {value:.4f}"
    if value >= COHERENT:
        return Check("coherence", True, says, value, COHERENT)
    return Check(
        "coherence",
        False,
        says + ": the hits disagree there; strike the same place squarely, listen to the hits' "
        "reasons, or record longer",
        value,
        COHERENT,
    )


def _resonance(frf: FRF, main: Mode | None) -> Check:
    if main is not None:
        return Check(
            "resonance",
            True,
            f"resonance at {main.frequency:.5g} Hz, damping ratio {100 * main.damping_ratio:.3g} %",
            main.frequency,
        )
    return Check(
        "resonance",
        False,
        f"no resonance stands out between {frf.frequency[0]:.3g} and {frf.frequency[-1]:.3g} Hz; "
        "check the channels, or the solid is damped too much to ring",
    )


def _long_enough(frf: FRF, main: Mode) -> Check:
    have = frf.record or 0.0
    need = TIME_CONSTANTS / main.decay
    says = (
        f"{have:.3g} s were recorded after the hit; {TIME_CONSTANTS} time constants of the decay "
        f"are {need:.3g} s"
    )
    if have >= need:
        return Check("record_long_enough", True, says, have, need)
    cut = 100 * np.exp(-(main.decay + frf.shift) * have)
    return Check(
        "record_long_enough",
        False,
        f"{says}. The cut flattens the FRF's peak ({cut:.2g} % of the response is left at its "
        "end), though the modes here allow for that; record longer",
        have,
        need,
    )


def _lines(frf: FRF, main: Mode) -> Check:
    spacing = float(np.median(np.diff(frf.frequency)))
    width = main.bandwidth + frf.shift / np.pi
    lines = width / spacing
    need = max(LINES / main.bandwidth, TIME_CONSTANTS / main.decay)
    says = f"{lines:.1f} lines, {spacing:.3g} Hz apart, in the half-power band of {width:.3g} Hz"
    if lines >= LINES:
        return Check("lines_in_half_power_band", True, says, lines, LINES)
    return Check(
        "lines_in_half_power_band",
        False,
        f"{says}: the peak falls between the lines and half-power damping is refused; "
        f"record {need:.3g} s",
        lines,
        LINES,
    )


def _excited(frf: FRF, spectra: Spectra, main: Mode) -> Check:
    """How far the pulse's spectrum has fallen where the block resonates."""
    power = (np.abs(spectra.force) ** 2).mean(axis=0)
    at = int(np.argmin(np.abs(frf.frequency - main.frequency)))
    level = 10 * float(np.log10(power[at] / power[:3].mean()))
    says = (
        f"at the resonance the hammer's force is {max(-level, 0.0):.2g} dB below its plateau; "
        f"lines up to {frf.frequency[-1]:.3g} Hz are kept"
    )
    if level >= -WEAK:
        return Check("hammer_excites", True, says, level, -WEAK)
    return Check("hammer_excites", False, f"{says}; take a harder tip", level, -WEAK)


def _stable(frf: FRF, spectra: Spectra, estimator: Estimator, main: Mode) -> Check:
    """Leave one hit out in turn and watch the FRF about the resonance."""
    reach = max(main.bandwidth, 2 * float(np.median(np.diff(frf.frequency))))
    near = np.abs(frf.frequency - main.frequency) <= reach
    without = leave_one_out(spectra, estimator)[:, near]
    whole = estimate(spectra, estimator)[near]
    change = np.linalg.norm(without - whole, axis=1) / np.linalg.norm(whole)
    worst = int(np.argmax(change))
    name = [hit.name for hit in frf.hits if hit.accepted][worst]
    value = float(change[worst])
    says = f"without any one hit the FRF about the resonance changes by {100 * value:.2g} %"
    if value <= DISAGREES:
        return Check("hits_agree", True, says, value, DISAGREES)
    return Check(
        "hits_agree",
        False,
        f"{says} (hit {name}): the result hangs on single hits; hit more often and more alike",
        value,
        DISAGREES,
    )


def _rocking(frf: FRF, found: Combination) -> Check:
    weighted = any(
        step.name == "combine" and len({value for _, value in step.parameters}) > 1
        for step in frf.steps
    )
    value = found.ratio if weighted else found.mean_ratio
    rocking, bounce = abs(found.rocking) / (2 * np.pi), abs(found.bounce) / (2 * np.pi)
    says = (
        f"rocking at {rocking:.5g} Hz is left with {value:.3f} of the bounce peak at "
        f"{bounce:.5g} Hz"
    )
    if value <= ROCKING:
        return Check("rocking_cancelled", True, says, value, ROCKING)
    advice = (
        "strike closer to the centre"
        if weighted
        else f"combine 'weighted' would leave {found.ratio:.3f}; strike closer to the centre"
    )
    return Check("rocking_cancelled", False, f"{says}; {advice}", value, ROCKING)


def _centred(frf: FRF, found: Combination) -> Check:
    names = [hit.name for hit in frf.hits if hit.accepted]
    worst = int(np.argmax(np.abs(found.eccentricity)))
    value = float(abs(found.eccentricity[worst]))
    scatter = float(np.std(found.eccentricity))
    says = (
        f"the hits set the block rocking by up to {100 * value:.0f} % of its bounce at the "
        f"accelerometers (hit {names[worst]}; {100 * scatter:.0f} % scatter)"
    )
    if found.reach is not None:
        reach = found.reach
        # a slender block as long as the accelerometers are apart: rho^2 = x^2 / 3
        says += (
            f", as hits some {1000 * value * reach / 3:.1f} mm off centre would on a slender block "
            f"{2000 * reach:.0f} mm long"
        )
    if value <= OFF_CENTRE:
        return Check("hits_centred", True, says, value, OFF_CENTRE)
    return Check("hits_centred", False, f"{says}; strike closer to the centre", value, OFF_CENTRE)
