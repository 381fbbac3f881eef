"""Steady response of a system with friction at a level, and the backbone of its modes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from dashpot.base import dataclass, replace
from dashpot.base.arrays import BoolArray, ComplexArray, FloatArray, FrozenArrays, validate_samples
from dashpot.base.errors import DataError
from dashpot.base.units import Quantity, convert_to_si
from dashpot.datamodel.frf import FRF, Kind
from dashpot.extensions.systems.harmonic_balance import (
    LinearSubsystem,
    solve_several_harmonics,
    with_friction,
    with_slope,
)
from dashpot.extensions.systems.multibody import Mount, Point, System, point_mass
from dashpot.extensions.systems.time_response import newton_modes
from dashpot.solids.maxwell import Solid
from dashpot.solids.rate_independent import AmplitudeDependent


@dataclass(frozen=True, eq=False)
class LevelResponse(FrozenArrays):
    r"""Steady responses to harmonic excitation, one in each row.

    Attributes
    ----------
    frequency : array, shape (n,)
        Hz.
    level : array, shape (n,)
        Amplitude of the force, N, or of the ground's motion, m.
    motion : complex array, shape (n,)
        First harmonic of the place that was requested, m.
    stretch : array, shape (mounts, n)
        Amplitude of the first harmonic over each mount with friction, m.
    stable : array of bool, shape (n,)
        Whether a small disturbance dies away: :math:`d|F|/dX > 0`. Determined for one mount with
        friction; for several every answer is one that was reached from its neighbour.
    harmonic : array, shape (n,)
        Largest higher harmonic of a stretch over its first; 0 where only one was requested.
    """

    frequency: FloatArray
    level: FloatArray
    motion: ComplexArray
    stretch: FloatArray
    stable: BoolArray
    harmonic: FloatArray

    @property
    def amplitude(self) -> FloatArray:
        """Amplitude of the motion requested, m."""
        return np.abs(self.motion)

    def frf(self, kind: Kind | str = Kind.ACCELERANCE) -> FRF:
        """Motion per force at this level, by rising frequency.

        Raises
        ------
        DataError
            If a frequency has more than one answer.
        """
        order = np.argsort(self.frequency)
        H = self.motion[order] / self.level[order]
        return FRF.from_receptance(self.frequency[order], H, kind=kind)


def response_at_level(
    system: System,
    *,
    response: str | Point,
    level: npt.ArrayLike | str,
    frequency: npt.ArrayLike,
    force: str | Point | None = None,
    base: str | None = None,
    harmonics: tuple[int, ...] = (1,),
) -> LevelResponse:
    """Steady response of a system some of whose mounts have friction, at a level.

    One answer a line, each the continuation of the line before, in the order given: frequencies
    that rise show what a sweep upwards does, frequencies that fall what one downwards does, and
    levels at one frequency a sweep of the level. Where a sweep has to jump, it does.

    Parameters
    ----------
    system : System
    response : str or Point
        Where the motion is wanted, such as ``"block.z"``.
    level : str, float or array_like, shape (n,)
        Amplitude of the force (``"0.1N"``), or of the ground's motion (``"0.1mm"``).
    frequency : array_like, shape (n,)
        Hz, in the order of the sweep; one frequency serves several levels.
    force : str or Point
        Where the force acts.
    base : str
        The ground motion, such as ``"ground.z"``, instead of a force.
    harmonics : tuple of int
        Odd, 1 first; ``(1, 3, 5)`` where the third is more than a percent of the first.

    Raises
    ------
    DataError
        If no mount has friction, or a line has no answer that can be reached.
    """
    if isinstance(level, str):
        level = convert_to_si(level, "force" if force is not None else "length")
    f, levels = np.broadcast_arrays(
        validate_samples("frequency", np.atleast_1d(frequency)),
        validate_samples("level", np.atleast_1d(level)),
    )
    if (levels <= 0).any() or (f <= 0).any():
        raise DataError("frequency and amplitude must be above 0")
    if tuple(harmonics[:1]) != (1,) or any(h % 2 == 0 or h < 1 for h in harmonics):
        raise DataError(f"harmonics = {harmonics!r}; expected odd numbers, 1 first")
    participation = system.participation(response)
    subsystem = LinearSubsystem(system, force=force, base=base)
    pairs = []
    previous_stretch: ComplexArray | None = None
    for hz, size in zip(f.tolist(), levels.tolist(), strict=True):
        line = subsystem.line(2 * np.pi * hz, size)
        answer = previous_stretch = line.solve_from_previous(previous_stretch)
        third_harmonic, third_amplitude = line.compute_friction_force(answer), 0.0
        if len(harmonics) > 1 and answer.any():
            answer, third_harmonic, third_amplitude = solve_several_harmonics(
                subsystem, line, answer, harmonics
            )
        motion = line.frictionless_motion - line.motion_per_force @ third_harmonic
        pairs.append(
            (
                participation @ motion,
                np.abs(answer),
                line.is_stable(previous_stretch),
                third_amplitude,
            )
        )
    motions, stretch, stable, share = zip(*pairs, strict=True)
    return LevelResponse(
        f, levels, np.array(motions), np.array(stretch).T, np.array(stable), np.array(share)
    )


def sweep_mass_at_level(
    solid: Solid, friction: AmplitudeDependent, *, mass: float, level: float, frequency: FloatArray
) -> LevelResponse:
    """Return the response in an upward sweep of a mass, kg, on a solid under a force, N."""
    return response_at_level(
        System((point_mass("mass", mass),), (Mount(solid, ("mass", "ground"), friction=friction),)),
        response="mass.z",
        force="mass.z",
        level=level,
        frequency=frequency,
    )


def find_all_responses(
    system: System,
    *,
    response: str | Point,
    level: Quantity,
    frequency: Quantity,
    force: str | Point | None = None,
    base: str | None = None,
) -> LevelResponse:
    """Return every steady answer of one harmonic at a frequency and a level, the smallest first.

    More than one where a resonance folds: a sweep never shows the unstable ones. Parameters as for
    :func:`response_at_level`; for one mount with friction.
    """
    size = convert_to_si(level, "force" if force is not None else "length")
    hz = convert_to_si(frequency, "frequency")
    line = LinearSubsystem(system, force=force, base=base).line(2 * np.pi * hz, size)
    if len(line.stretch) > 1:
        raise DataError(
            f"{len(line.stretch)} mounts have friction: every answer is found for one such mount; "
            "response_at_level follows one answer for several"
        )
    participation = system.participation(response)
    answers = line.find_all_solutions()
    motion = [
        participation
        @ (line.frictionless_motion - line.motion_per_force @ line.compute_friction_force(answer))
        for answer in answers
    ]
    count = len(answers)
    return LevelResponse(
        np.full(count, hz),
        np.full(count, size),
        np.array(motion),
        np.abs(np.array(answers)).T,
        np.array([line.is_stable(answer) for answer in answers]),
        np.zeros(count),
    )


@dataclass(frozen=True, eq=False)
class Backbone(FrozenArrays):
    """Backbone of a mode: frequency and damping over amplitude.

    Attributes
    ----------
    amplitude : array, shape (n,)
        Amplitude of the stretch of the mount that was requested, m.
    frequency : array, shape (n,)
        Natural frequency, Hz.
    damping_ratio : array, shape (n,)
    """

    amplitude: FloatArray
    frequency: FloatArray
    damping_ratio: FloatArray


def backbone(
    system: System, *, amplitude: npt.ArrayLike, mode: int = 1, mount: int | None = None
) -> Backbone:
    """Natural frequency and damping of a mode against amplitude: one harmonic, no excitation.

    Parameters
    ----------
    system : System
    amplitude : array_like, shape (n,)
        Amplitude of the stretch of the mount, m.
    mode : int
        From 1, by rising frequency.
    mount : int
        Which mount's stretch; by default the first with friction.
    """
    without_friction = with_friction(system)
    mount = without_friction[0] if mount is None else mount
    rows = []
    for X in validate_samples("amplitude", np.atleast_1d(amplitude)).tolist():
        shares = np.ones(len(without_friction))
        for _ in range(100):
            mounts = list(system.mounts)
            for i, share in zip(without_friction, shares, strict=True):
                mounts[i] = replace(mounts[i], amplitude=X * max(float(share), 1e-9))
            new_mode = newton_modes(replace(system, mounts=tuple(mounts)))[mode - 1]
            magnitude = np.abs(system.stretch @ new_mode.shape)
            if not magnitude[mount] > 0:
                raise DataError(f"mode {mode} does not stretch mount {mount}")
            previous_shares, shares = shares, magnitude[without_friction] / magnitude[mount]
            if np.abs(shares / previous_shares - 1).max() < 1e-9:
                break
        rows.append((X, new_mode.frequency, new_mode.damping_ratio))
    return Backbone(*np.array(rows).T)


def can_fold(
    part: AmplitudeDependent, *, omega: npt.ArrayLike, amplitude: npt.ArrayLike
) -> BoolArray:
    r"""Return whether a mass on a part has three answers at some frequency near an amplitude.

    .. math:: \left|\frac{dK'}{d\ln X}\right| >
        2 \sqrt{K''\left(K'' + \frac{dK''}{d\ln X}\right)}

    with the whole stiffness of the part, arms included. Jenkins elements beside arms never fold:
    the difference of two motions loses energy in every slip.

    Parameters
    ----------
    part : AmplitudeDependent
        Such as ``solid + Cubic(1e9)``.
    omega : array_like
        rad/s.
    amplitude : array_like
        m; broadcasts with omega.
    """
    K, slope = with_slope(part, np.asarray(omega, dtype=float), np.asarray(amplitude, dtype=float))
    discriminant = K.imag * (K.imag + slope.imag)
    return np.asarray(np.abs(slope.real) > 2 * np.sqrt(np.maximum(discriminant, 0.0)))
