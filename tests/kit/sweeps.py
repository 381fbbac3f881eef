"""Sweeps at several temperatures of a material with a broad spectrum, made apart from `src`."""

import numpy as np

from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.curves.datamodel.creep import CreepCompliance
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.datamodel.modulus import RelaxationModulus

REFERENCE = 293.15
TEMPERATURES = REFERENCE + np.arange(-40.0, 41.0, 10.0)
TAU = np.logspace(-8, 4, 49)
SHARE = np.exp(-0.5 * ((np.log10(TAU) + 2) / 2) ** 2)
PLATEAU, GLASSY = 3e6, 2e9
H = (GLASSY - PLATEAU) * SHARE / SHARE.sum()


def wlf(kelvin, c1=8.0, c2=110.0):
    """Decadic logarithm of a_T."""
    return -c1 * (kelvin - REFERENCE) / (c2 + kelvin - REFERENCE)


def arrhenius(kelvin, energy=150e3):
    return energy / (8.314462618 * np.log(10)) * (1 / kelvin - 1 / REFERENCE)


def modulus(frequency, kelvin, *, law=wlf, rubbery=True, complexity=0.0):
    """E* of a log-normal spectrum; `complexity` shifts slow arms further than fast ones."""
    a = law(kelvin) * (1 + complexity * (np.log10(TAU) + 2))
    z = 2 * np.pi * frequency[:, None] * TAU * 10**a
    value = PLATEAU + (H * (z * z + 1j * z) / (1 + z * z)).sum(axis=1)
    return value * (kelvin / REFERENCE if rubbery else 1.0)


def sweeps(
    seed=0, *, noise=0.01, temperatures=TEMPERATURES, points=14, ends=(0.1, 10.0), **material
):
    """Two decades at each temperature, with noise of |E*| in storage and loss."""
    draw = np.random.default_rng(seed).standard_normal
    frequency = np.geomspace(*ends, points)
    value = [modulus(frequency, kelvin, **material) for kelvin in temperatures]
    value = np.concatenate(
        [v + noise * np.abs(v) * (draw(points) + 1j * draw(points)) for v in value]
    )
    count = len(temperatures)
    return DynamicTest(
        np.tile(frequency, count),
        value.real,
        value.imag,
        np.repeat(temperatures, points),
        units="SI",
    )


def moduli(seed=0, *, noise=0.005, temperatures=TEMPERATURES, points=12):
    """Relaxation moduli, two decades at each temperature."""
    draw = np.random.default_rng(seed).standard_normal
    time = np.geomspace(1.0, 100.0, points)
    decay = [
        np.exp(-time[:, None] / (TAU * 10 ** wlf(temperature))) @ H for temperature in temperatures
    ]
    value = np.concatenate([(PLATEAU + value) * (1 + noise * draw(points)) for value in decay])
    return RelaxationModulus(
        np.tile(time, len(temperatures)),
        value,
        temperature=np.repeat(temperatures, points),
        units="SI",
    )


def compliances(*, noise=0.005, seed=1, rubbery=True, flow=0.0):
    """Creep compliances, two decades at each temperature, one test each; `flow` in 1/(Pa s)."""
    draw = np.random.default_rng(seed).standard_normal
    time, result = np.geomspace(1.0, 100.0, 14), []
    for kelvin in TEMPERATURES:
        reduced = time / 10 ** wlf(kelvin)
        rise = -np.expm1(-reduced[:, None] / TAU) @ (SHARE / SHARE.sum())
        value = (1 / GLASSY + rise / PLATEAU + flow * reduced) * (1 + noise * draw(len(time)))
        b_t = kelvin / REFERENCE if rubbery else 1.0
        result.append(
            CreepCompliance(time, value / b_t, specimen=Specimen(temperature=kelvin), units="SI")
        )
    return result
