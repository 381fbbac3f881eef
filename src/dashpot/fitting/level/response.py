"""What the mass under FRFs at several levels does at any level."""

from __future__ import annotations

from dashpot.base.arrays import FloatArray
from dashpot.records.frf import FRF, Kind
from dashpot.records.level import LevelFit
from dashpot.solids.friction import Jenkins
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.rate_independent import InParallel
from dashpot.vibration.systems.level import response_at_level
from dashpot.vibration.systems.prediction import predict_frf
from dashpot.vibration.systems.system import Mount, System, point_mass


def receptance_at_level(
    found: LevelFit,
    level: float,
    frequency: FloatArray,
    *,
    of: tuple[GeneralizedMaxwell, tuple[Jenkins, ...]] | None = None,
) -> FRF:
    """Motion of the mass over a force of that amplitude, N, by harmonic balance, m/N.

    Parameters
    ----------
    found : LevelFit
    level : float
        N.
    frequency : array, shape (n,)
        Hz, rising.
    of : (GeneralizedMaxwell, tuple of Jenkins), optional
        One of the fit's draws, in the place of the fit itself.
    """
    solid, sliders = (found.solid, found.sliders) if of is None else of
    if not sliders:
        return predict_frf(
            found.seals * solid, mass=found.mass, frequency=frequency, kind=Kind.RECEPTANCE
        )
    mount = Mount(
        found.seals * solid, ("mass", "ground"), friction=found.seals * InParallel(sliders)
    )
    system = System((point_mass("mass", found.mass),), (mount,))
    return response_at_level(
        system, response="mass.z", force="mass.z", level=level, frequency=frequency
    ).frf(Kind.RECEPTANCE)
