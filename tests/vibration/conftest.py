"""A block struck on its seals, in closed form: the oracle of the measured half."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.solids.maxwell import GeneralizedMaxwell

MASS = 0.1040426  # kg: two of the paper's seals then resonate at 12.71 Hz
BROAD_MASS = 0.114829829

Strike = Callable[..., ImpactTest]


def poles_of(model: GeneralizedMaxwell, mass: float) -> np.ndarray:
    """Roots of the characteristic polynomial: another way than the state matrix."""
    s = np.polynomial.Polynomial([0, 1])
    whole = np.polynomial.Polynomial([1.0])
    for tau in model.tau:
        whole = whole * (1 + s * tau)
    total = (mass * s**2 + model.b * s + model.k_inf) * whole
    for i, (k, tau) in enumerate(zip(model.k, model.tau, strict=True)):
        rest = np.polynomial.Polynomial([k]) * s * tau
        for j, other in enumerate(model.tau):
            rest = rest * (1 + s * other) if i != j else rest
        total = total + rest
    return total.roots().astype(complex)


def half_sine_response(
    model: GeneralizedMaxwell, mass: float, t: np.ndarray, length: float, peak: float
) -> tuple[np.ndarray, np.ndarray]:
    """Force and acceleration of a mass at rest under a half-sine that begins at t = 0, exactly."""
    omega = np.pi / length
    force = np.where((t >= 0) & (t <= length), peak * np.sin(omega * t), 0.0)
    acceleration = force / mass
    during, after = np.clip(t, 0, length), np.clip(t - length, 0, None)
    for p in poles_of(model, mass):
        slope = model.b + sum(
            k * tau / (1 + p * tau) ** 2 for k, tau in zip(model.k, model.tau, strict=True)
        )
        residue = p**2 / (2 * mass * p + slope)
        convolved = (
            omega * np.exp(p * during) - omega * np.cos(omega * during) - p * np.sin(omega * during)
        ) / (p**2 + omega**2)
        acceleration = acceleration + (peak * residue * convolved * np.exp(p * after)).real * (
            t >= 0
        )
    return force, acceleration


@pytest.fixture(scope="session")
def broad_seal(paper_seal: GeneralizedMaxwell) -> GeneralizedMaxwell:
    """The paper's seal with three arms more that a 1 s ramp hardly sees."""
    return paper_seal + GeneralizedMaxwell(0.0, (20.0, 20.0, 20.0), (0.08, 0.016, 0.0032))


@pytest.fixture(scope="session")
def strike(paper_seal: GeneralizedMaxwell) -> Strike:
    """Return a maker of hammer tests: one record per hit, of a block on two seals."""

    def make(
        model: GeneralizedMaxwell | None = None,
        mass: float = MASS,
        *,
        record: float = 8.0,
        rate: float = 2048.0,
        hits: int = 1,
        before: float = 0.1,
        pulse: float = 0.015,
        noise: tuple[float, float] = (0.0, 0.0),
        offset: tuple[float, float] = (0.0, 0.0),
        seed: int = 0,
        on_sample: bool = False,
    ) -> ImpactTest:
        random = np.random.default_rng(seed)
        model = 2 * paper_seal if model is None else model
        n = round(record * rate)
        t = np.arange(n) / rate
        forces, accelerations = [], []
        for _ in range(hits):
            start = before + (0 if on_sample else random.uniform(0, 1) / rate)
            peak = 3 * (1 + 0.3 * random.uniform(-1, 1))
            force, acceleration = half_sine_response(model, mass, t - start, pulse, peak)
            forces.append(force + offset[0] + noise[0] * random.standard_normal(n))
            accelerations.append(acceleration + offset[1] + noise[1] * random.standard_normal(n))
        return ImpactTest(
            time=np.tile(t, hits),
            force=np.concatenate(forces),
            acceleration=np.concatenate(accelerations)[None, :],
            starts=tuple(range(0, n * hits, n)),
            units="SI",
        )

    return make
