"""Modes of a door with and without its seal."""

from __future__ import annotations

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.serialisation import Key, Serialisable
from dashpot.datamodel.seal_line import Shear
from dashpot.extensions.systems.door.assembly import DOOR, Assembly
from dashpot.extensions.systems.door.energy_shares import EnergyShare, energy_shares
from dashpot.extensions.systems.free_modes import FreeModes
from dashpot.extensions.systems.multibody import System
from dashpot.extensions.systems.time_response import ComplexMode, complex_modes, newton_modes

_STATES = 1200
"""Largest first-order form; beyond it the nonlinear eigenproblem is faster."""
_LOSSLESS = 1e-9
"""Loss factor of rounding."""
_FREE_STIFFNESS_SHARE, _ROUNDING_SHARE = 0.1, 1e-12
"""Share of a stiffness below which a motion is free, and of the largest that is rounding."""
_COARSE_PITCHES = 8
"""Pitches between stations that show what is free; they need not show how stiff it is."""
_MIN_SIMILARITY = 0.5
"""Least similarity of a mode with seal and one without."""


@dataclass(frozen=True)
class DoorMode(Serialisable):
    """Mode of the closed door.

    Attributes
    ----------
    mode : ComplexMode
    shares : tuple of EnergyShare
        Shares of each hinge, the latch, the bumpers, the seal, and the door itself.
    without_seal : float or None
        Frequency of the same motion without the seal, Hz; None if no mode is similar.
    """

    _keys = (
        Key("frequency_hz", "mode.frequency"),
        "mode.damping_ratio",
        "loss_factor",
        Key("without_seal_hz", "without_seal"),
        "shares",
    )

    mode: ComplexMode
    shares: tuple[EnergyShare, ...]
    without_seal: float | None = None

    @property
    def loss_factor(self) -> float:
        """Loss factor by the energies of the springs."""
        return sum(share.loss for share in self.shares)

    def share(self, name: str) -> float:
        """Fraction of the energy that one of its parts stores; 0 for a missing part."""
        return sum(share.energy for share in self.shares if share.name == name)

    def loss_share(self, name: str) -> float:
        """Fraction of the loss in one of its parts; 0 if hardly any energy is lost."""
        loss = sum(share.loss for share in self.shares if share.name == name)
        return loss / self.loss_factor if self.loss_factor > _LOSSLESS else 0.0


def find_oscillations(system: System, max_hz: float = np.inf) -> tuple[ComplexMode, ...]:
    """Return the modes of a system that oscillate, up to a frequency, Hz, by rising frequency."""
    n = len(system.dofs)
    times = {tau for spring in system.springs for tau in spring.linearised_solid.maxwell.tau}
    is_small = 2 * n + len(times) * min(n, len(system.springs)) <= _STATES
    modes = complex_modes(system) if is_small else newton_modes(system)
    return tuple(mode for mode in modes if mode.oscillates and mode.frequency <= max_hz)


def door_modes(assembly: Assembly, max_hz: float) -> tuple[DoorMode, ...]:
    """The modes of a door on its seal up to a frequency, Hz, each beside that without the seal."""
    system, system_without_seal = assembly.system(), assembly.system(sealed=False)
    modes_without_seal = find_oscillations(system_without_seal)
    M = system.mass_matrix
    modes = []
    for mode in find_oscillations(system, max_hz):
        similarities = [
            compute_similarity(mode.shape, other.shape, M) for other in modes_without_seal
        ]
        best_index = int(np.argmax(similarities)) if similarities else -1
        nearest_frequency = (
            modes_without_seal[best_index].frequency
            if similarities and similarities[best_index] >= _MIN_SIMILARITY
            else None
        )
        modes.append(DoorMode(mode, energy_shares(system, mode), nearest_frequency))
    return tuple(modes)


def estimate_station_error(assembly: Assembly, max_hz: float) -> float:
    """Largest relative change of a frequency up to one, Hz, with twice as many stations."""
    line, pitch = assembly.door.line, assembly.door.pitch
    # a pitch longer than the pieces of the line cuts nothing: half of what stands there does
    half_pitch = pitch / 2 if line is None else float(line.stations(pitch).length.max()) / 2
    return _compute_frequency_change(
        *(find_oscillations(assembly.system(pitch=value), max_hz) for value in (pitch, half_pitch))
    )


def estimate_basis_error(assembly: Assembly, max_hz: float) -> float | None:
    """Return the change of frequencies without the upper third of the elastic modes."""
    modes = assembly.modes
    if modes is None or (elastic := int((~modes.rigid).sum())) < 3:
        return None
    order = np.argsort(modes.frequency)
    with_fewer_modes = replace(assembly, modes=modes.only(order[: len(modes) - elastic // 3]))
    highest_kept = modes.frequency[order[len(modes) - elastic // 3 - 1]]
    limit = min(max_hz, float(highest_kept)) / 2
    return _compute_frequency_change(
        *(find_oscillations(item.system(), limit) for item in (assembly, with_fewer_modes))
    )


def find_farthest_point(assembly: Assembly, modes: FreeModes) -> tuple[float, str]:
    """Return the largest distance, m, of a used point from the known shapes, and its name."""
    door = assembly.door
    latch = () if door.latch is None else (door.latch,)
    points_and_names = [(hinge.at, hinge.name) for hinge in (*door.hinges, *latch, *door.bumpers)]
    points_and_names += [(point.at, point.name) for point in door.points if point.on == DOOR]
    if door.line is not None:
        stations = door.line.stations(assembly.door.pitch)
        station_positions = zip(stations.place.tolist(), stations.along.tolist(), strict=True)
        points_and_names += [
            (tuple(position), f"the seal at {arc_length:.3g} m")
            for position, arc_length in station_positions
        ]
    return max((modes.evaluate_shapes(position)[1], name) for position, name in points_and_names)


def count_free_motions(system: System) -> int:
    """Motions that stretch no spring, without rigid motions of a free car."""
    flying = 0 if system.grounds else 6
    return max(len(system.dofs) - int(np.linalg.matrix_rank(_scale_stretches(system))) - flying, 0)


def count_lateral_free_motions(assembly: Assembly) -> tuple[int, float | None]:
    r"""Motions restrained only by the seal's lateral stiffness, and the slowest of them, Hz.

    Those by whose shapes the springs of the door are at rest less than a tenth of what they were
    with a seal as stiff sideways as normal to its line: :math:`K\phi = \rho K_1\phi`, with
    :math:`\rho` below it. The frequency is None where such a motion does not oscillate.
    """
    door = assembly.door
    if door.line is None or door.line.section is None:
        return 0, None
    sheared_section = replace(door.line.section, shear=Shear(1.0, 1.0))
    restrained_assembly = replace(
        assembly, door=replace(door, line=replace(door.line, section=sheared_section))
    )
    pitch = min(_COARSE_PITCHES * door.pitch, door.line.length)
    K, K_1 = (
        _compute_rest_stiffness(item.system(pitch=pitch))
        for item in (assembly, restrained_assembly)
    )
    size, axes = np.linalg.eigh(K_1)
    is_restrained = size > _ROUNDING_SHARE * size.max(initial=0.0)
    scaled = axes[:, is_restrained] / np.sqrt(size[is_restrained])
    count = int((np.linalg.eigvalsh(scaled.T @ K @ scaled) < _FREE_STIFFNESS_SHARE).sum())
    if not count:
        return 0, None
    modes = find_oscillations(assembly.system())
    return count, modes[0].frequency if modes and count_free_motions(
        assembly.system()
    ) == 0 else None


def _compute_rest_stiffness(system: System) -> FloatArray:
    """Return stiffness at rest by unit masses, 1/s^2, shape (n, n)."""
    E = system.stretch / np.sqrt(np.diag(system.mass_matrix))
    k = np.array([spring.linearised_solid.k_0 for spring in system.springs])
    return np.asarray((E.T * k) @ E)


def _scale_stretches(system: System) -> FloatArray:
    """Stretches by the square root of stiffness over mass, so that all motions compare."""
    stiffness_roots = np.sqrt(
        [
            spring.linearised_solid.k_0 + spring.linearised_solid.maxwell.b
            for spring in system.springs
        ]
    )
    return np.asarray(
        stiffness_roots[:, None] * system.stretch / np.sqrt(np.diag(system.mass_matrix))
    )


def _compute_frequency_change(
    first: tuple[ComplexMode, ...], second: tuple[ComplexMode, ...]
) -> float:
    pairs = zip(first, second, strict=False)
    return max((abs(b.frequency / a.frequency - 1) for a, b in pairs), default=0.0)


def compute_similarity(a: ComplexArray, b: ComplexArray, M: FloatArray) -> float:
    """Return the modal assurance criterion of two shapes with the mass matrix between."""
    product_square = abs(a.conj() @ M @ b) ** 2
    return float(product_square / abs((a.conj() @ M @ a) * (b.conj() @ M @ b)))
