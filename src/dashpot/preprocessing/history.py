r"""Loading history of a seal before the fitted loading, including loss of contact.

The hereditary integral begins with the first sample. Where the plate is away from a seal that has
not recovered, the face follows from its own force, which is zero
(:mod:`dashpot.solids.moving_plate`), and so from the solid that is sought: solid and face are found
by turns, beginning with a face that goes straight from where the force ended to where it begins.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, find_true_runs
from dashpot.datamodel.relaxation import RampHold
from dashpot.preprocessing.denoising import denoise_displacement
from dashpot.signals.noise import median_of_three
from dashpot.solids.maxwell import GeneralizedMaxwell

# Largest number of arms of the model that predicts the recovery of the face.
ARM_COUNTS = (4, 3, 2, 1)
# times the scatter of the force: what is left of the last loading is noise; of their force, what is
# left of earlier ones
NOISE_RATIO, MAX_EARLIER_MISFIT = 1.1, 5e-3
# of the peak: less is no noise
MIN_NOISE_SHARE = 1e-4
# times that solid and face are found, each with the other
MAX_ITERATIONS = 8
# of the depth: a face that moves by less has been found
FACE_TOLERANCE = 1e-4
# times its scatter, and of its peak, by which a seal that is pressed shows a force
PRESSED_SCATTER, PRESSED_SHARE = 5.0, 0.004
# of the peak, and times the scatter, by which a bonded seal pulls at a plate that went back
PULL_SHARE, PULL_SCATTER = 0.01, 8.0
# of the depth: a plate as near to first contact has gone back
RETURN_SHARE = 0.1


class EarlierLoadings(NamedTuple):
    """Earlier loadings whose effect on the fitted one is computed.

    Attributes
    ----------
    misfit : float
        Largest rms deviation of the force of one of them from the response of the fitted solid,
        over the rms of its force.
    arms : int
        Number of arms of that solid.
    converged : bool
        Whether solid and face were found, each with the other.
    """

    misfit: float
    arms: int
    converged: bool


def is_bonded(
    force: FloatArray, compression: FloatArray, *, noise: float, peak: float, depth: float
) -> bool:
    """Return whether the force on a retracting plate is tensile: the seal is bonded to it.

    Force and compression of the loadings before the last, N and m; the force is 0 in air.
    """
    force_limit = max(PULL_SHARE * peak, PULL_SCATTER * noise)
    return bool(
        np.any((median_of_three(force) < -force_limit) & (compression < RETURN_SHARE * depth))
    )


def follow_history(record: RampHold) -> tuple[RampHold, EarlierLoadings]:
    """Return the record with the face of its seal, and how well its earlier loadings agree.

    Parameters
    ----------
    record : RampHold
        With earlier loadings. If it has a `plate`, its displacement is not used.
    """
    plate = record.plate
    if plate is None:
        solid, _ = _fit_solid(record, ARM_COUNTS[0])
        return record, EarlierLoadings(_compute_misfit(record, solid), solid.arms, converged=True)
    first_record = replace(record, displacement=_estimate_first_face(record, plate))
    candidates: list[tuple[float, RampHold, EarlierLoadings]] = []
    for arms in ARM_COUNTS:
        # a fast arm can stand for a wrong face: fewer arms then leave less
        remainder, ramp_hold, earlier_loadings = _fit_alternately(first_record, plate, arms)
        noise = max(record.force_noise, MIN_NOISE_SHARE * float(record.force.max()))
        excess = max(remainder / noise - NOISE_RATIO, 0.0)
        candidates.append((excess + earlier_loadings.misfit, ramp_hold, earlier_loadings))
        if candidates[-1][0] <= MAX_EARLIER_MISFIT:
            break
    _, record, earlier_loadings = min(candidates, key=lambda pair: pair[0])
    return record, earlier_loadings


def _fit_alternately(
    record: RampHold, plate: FloatArray, arms: int
) -> tuple[float, RampHold, EarlierLoadings]:
    """Return residual, N, record and history of a solid and a seal face fitted in turn."""
    from dashpot.solids.moving_plate import simulate_face_under_plate

    (solid, remainder), ratio = _fit_solid(record, arms), np.inf
    for _ in range(MAX_ITERATIONS):
        face, _ = simulate_face_under_plate(solid, record.time, plate)
        ratio = float(np.abs(face - record.displacement)[: record.hold.stop].max()) / record.depth
        record = replace(record, displacement=face)
        solid, remainder = _fit_solid(record, arms)
        if ratio < FACE_TOLERANCE:
            break
    converged = ratio < 10 * FACE_TOLERANCE
    return (
        remainder,
        record,
        EarlierLoadings(_compute_misfit(record, solid), solid.arms, converged=converged),
    )


def _estimate_first_face(record: RampHold, plate: FloatArray) -> FloatArray:
    """Return the face of the seal, m: the plate where in contact, else interpolated."""
    force, t = median_of_three(record.force), record.time
    force_limit = max(PRESSED_SCATTER * record.force_noise, PRESSED_SHARE * float(force.max()))
    is_compressed = (force > force_limit) & (plate > 0)
    first = int(np.argmax(is_compressed))
    face = np.interp(t, t[is_compressed], plate[is_compressed])
    face[:first] = np.maximum(plate[:first], 0.0)
    return np.maximum(face, plate)


def _fit_solid(record: RampHold, arms: int) -> tuple[GeneralizedMaxwell, float]:
    """Return a solid fitted to the last loading after the earlier ones, and its residual, N rms."""
    from dashpot.numerics.design_matrices.recorded_motion import build_recorded_block
    from dashpot.numerics.exponential_fit import solve_orders

    used_samples = slice(0, record.hold.stop)
    x, _ = denoise_displacement(record)
    time = record.time[used_samples] - record.time[0]
    first = int(np.searchsorted(record.time, record.onset))
    # the force is tared: an offset would take what slow arms do
    block = build_recorded_block(
        time, x - x[0], record.force[used_samples], window=slice(first, None)
    )
    solution = solve_orders([block], arms, negligible=float(2 * np.log(block.samples)))[-1]
    k = solution.arms[0] if solution.order else np.zeros(0)
    is_active = k > 0
    solid = GeneralizedMaxwell(
        max(solution.coefficient("k_inf"), 1e-9 * float(k.sum() + 1e-300)),
        tuple(k[is_active].tolist()),
        tuple(np.asarray(solution.tau)[is_active].tolist()),
    )
    return solid, float(np.sqrt(solution.sse / block.samples))


def _compute_misfit(record: RampHold, solid: GeneralizedMaxwell) -> float:
    """Return the relative misfit of a solid to the forces of earlier loadings."""
    stop = record.start
    x = denoise_displacement(record)[0][:stop]
    time, force = record.time[:stop] - record.time[0], record.force[:stop]
    if stop < 8:
        return 0.0
    response = solid.force(time, x - x[0])
    force_limit = PRESSED_SHARE * float(record.force.max())
    largest_misfit = 0.0
    for a, b in find_true_runs(
        response > max(force_limit, PRESSED_SCATTER * record.force_noise)
    ).tolist():
        response_rms = float(np.sqrt(np.mean(response[a : b + 1] ** 2)))
        if b - a < 4 or response_rms < 0.05 * float(record.force.max()):
            continue
        # scatter is no misfit
        excess = (
            float(np.mean((force[a : b + 1] - response[a : b + 1]) ** 2)) - record.force_noise**2
        )
        largest_misfit = max(largest_misfit, float(np.sqrt(max(excess, 0.0))) / response_rms)
    return largest_misfit
