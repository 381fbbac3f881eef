"""Doors on their hinges, latch and seal: numbers that were computed apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from dashpot.base.errors import DataError
from dashpot.datamodel.seal_line import SealSection
from dashpot.extensions.systems.door.assembly import Assembly, find_rigid_body
from dashpot.extensions.systems.door.door_model import (
    Door,
    ModesChoice,
    RigidPart,
    SealChoice,
    Support,
)
from dashpot.extensions.systems.door.energy_shares import energy_shares
from dashpot.extensions.systems.door.free_plate import free_plate
from dashpot.extensions.systems.door.modes import estimate_basis_error, find_oscillations
from dashpot.extensions.systems.door.seal_line import Joint, SealLine
from dashpot.extensions.systems.free_modes import FreeModes
from dashpot.extensions.systems.time_response import complex_modes
from dashpot.solids import networks as net
from dashpot.solids.demo_seals import BROAD
from dashpot.solids.elastic import ElasticLaw

WIDTH, HEIGHT, MASS = 1.1, 1.2, 25.0
PLATE = RigidPart(
    MASS,
    (MASS * HEIGHT**2 / 12, MASS * WIDTH**2 / 12, MASS * (WIDTH**2 + HEIGHT**2) / 12),
    (WIDTH / 2, HEIGHT / 2, 0.0),
    ("z", "rx", "ry"),
)
ROUND = SealLine([(0, 0, 0), (WIDTH, 0, 0), (WIDTH, HEIGHT, 0), (0, HEIGHT, 0), (0, 0, 0)])


def door(kappa: float, *, hinge: float = 5e6, latch: float = 1e6) -> Door:
    """Two hinges, a latch, and a seal of kappa, N/m per m, around a rigid plate."""
    return Door(
        rigid=PLATE,
        hinges=(
            Support("hinge 1", (0.0, 0.3, 0.0), (hinge,) * 3),
            Support("hinge 2", (0.0, 0.9, 0.0), (hinge,) * 3),
        ),
        latch=Support("latch", (WIDTH, 0.6, 0.0), (latch,) * 3),
        line=replace(ROUND, section=net.spring(kappa)),
        seal=SealChoice("", pitch=0.02),
    )


def test_a_latched_door_and_who_holds_its_energy():
    """54.404, 87.173, 204.014 Hz without seal; with it a plain eigensolver found those shares."""
    assembly = Assembly(door(33180.0))
    bare = complex_modes(assembly.system(sealed=False))
    assert [mode.frequency for mode in bare] == pytest.approx([54.404, 87.173, 204.014], abs=1e-3)
    system = assembly.system()
    modes = complex_modes(system)
    assert [m.frequency for m in modes] == pytest.approx([56.112, 88.891, 204.703], abs=1e-3)
    shares = [
        {energy_share.name: energy_share.energy for energy_share in energy_shares(system, m)}
        for m in modes
    ]
    assert [100 * share["seal"] for share in shares] == pytest.approx(
        [5.990, 3.829, 0.673], abs=1e-3
    )
    assert list(shares[0]) == ["hinge 1", "hinge 2", "latch", "seal"]


@pytest.mark.parametrize(("latch", "hertz"), [(0.0, 3.398172), (1e5, 17.762633)])
def test_a_door_on_hinges_that_hardly_give(latch, hertz):
    """One motion, about the hinges: the moment of a seal of 1965 N/m^2 is 2.339333 m^3."""
    system = Assembly(door(1965.0, hinge=9e11, latch=latch)).system(pitch=0.005)
    assert complex_modes(system)[0].frequency == pytest.approx(hertz, rel=4e-6)


def test_the_tangent_at_the_local_compression_holds_the_door():
    """Where the seal does not reach it carries nothing; elsewhere F_e'(x), and more at a joint."""
    law = ElasticLaw((0.0, 0.004, 0.008), (0.5, 0.9, 1.7), 100.0)
    section = SealSection(100.0 / BROAD.k_inf * BROAD, law)
    straight = SealLine(
        [(0, 0, 0), (1, 0, 0), (2, 0, 0)],
        [-0.002, 0.002, 0.006],
        section,
        joints=(Joint(1.75, 0.5, 2.0),),
    )
    mounts = straight.mounts("door", "0.25m", ground="body")
    gauss = 0.25 / np.sqrt(3)
    at = np.array([0.25 + gauss, 0.75 - gauss, 0.75 + gauss, 1.25 - gauss, 1.25 + gauss,
                   1.75 - gauss, 1.75 + gauss])  # fmt: skip
    at = at[at > 0.5]  # before it does not reach
    assert [mount.at[0] for mount in mounts] == pytest.approx(at.tolist())
    expected = 0.25 * law.tangent(-0.002 + 0.004 * at) * [1, 1, 1, 1, 2, 2]
    assert [mount.solid.k_inf for mount in mounts] == pytest.approx(expected.tolist())
    assert {mount.name for mount in mounts} == {"seal"}
    with pytest.raises(DataError, match="how far it is pressed along the line is not stated"):
        replace(straight, compression=None).mounts("door", 0.5)
    with pytest.raises(DataError, match="has no section"):
        ROUND.mounts("door", 0.5)


def cross(r: np.ndarray) -> np.ndarray:
    return np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])


def test_six_rigid_modes_give_mass_centre_and_tensor():
    """In any mixture of them, about any point."""
    draw = np.random.default_rng(1)
    centre, half = np.array([0.4, 0.7, 0.1]), draw.standard_normal((3, 3))
    tensor = half @ half.T + 3 * np.eye(3)
    M = np.zeros((6, 6))
    M[:3, :3], M[:3, 3:], M[3:, :3] = MASS * np.eye(3), -MASS * cross(centre), MASS * cross(centre)
    M[3:, 3:] = tensor + MASS * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    mixed = np.linalg.cholesky(np.linalg.inv(M)) @ np.linalg.qr(draw.standard_normal((6, 6)))[0]
    place = draw.uniform(0, 1, (20, 3))
    motions = np.array([np.hstack((np.eye(3), -cross(p))) for p in place])
    shape = np.concatenate(
        (np.einsum("pij,jr->rpi", motions, mixed), draw.standard_normal((1, 20, 3)))
    )
    modes = FreeModes([0.0] * 6 + [40.0], place, shape)
    rigid_part = find_rigid_body(modes)
    assert rigid_part.mass == pytest.approx(MASS)
    assert rigid_part.centre == pytest.approx(centre)
    assert np.array(rigid_part.inertia) == pytest.approx(tensor)
    body = Assembly(Door(modes=ModesChoice("door.unv")), modes).body()
    assert (body.mass, len(body.motions)) == (pytest.approx(MASS), 7)
    skewed = replace(modes, shapes=modes.shapes * np.array([1.5] + [1] * 6)[:, None, None])
    with pytest.raises(DataError, match=r"imply masses of .* kg along x, y and z"):
        find_rigid_body(skewed)
    held = Assembly(Door(modes=ModesChoice("door.unv", is_hung=True)), modes).body()
    assert held.motions == tuple(f"q{i}" for i in range(1, 8))
    with pytest.raises(DataError, match="the door has no mass"):
        Assembly(Door()).body()


def test_a_car_body_may_move_too():
    """On the latch and hinges of a body of its own mass: six motions are free, and it answers."""
    car = RigidPart(1200.0, (500.0, 2000.0, 2000.0), (1.5, 0.5, 0.3))
    system = Assembly(
        replace(door(33180.0), rigid=replace(PLATE, motions=RigidPart.motions), body=car)
    ).system()
    assert len(system.dofs) == 12
    assert system.grounds == ()
    assert np.linalg.matrix_rank(system.stretch) == 6
    assert len(complex_modes(system)) == 6


def test_free_modes_under_a_seal_and_under_stiff_hinges():
    """A seal needs few of them, hinges many: what the last third moves is about what is missing."""
    places = ROUND.stations(0.1).place
    held = [(0.0, 0.3, 0.0), (0.0, 0.9, 0.0), (WIDTH, 0.6, 0.0)]

    def build_assembly(elastic: int, hinge: float) -> Assembly:
        modes = free_plate(
            np.concatenate((places, held)), width=WIDTH, height=HEIGHT, mass=MASS, rigidity=3e4,
            elastic=elastic,
        )  # fmt: skip
        plate = door(33180.0, hinge=hinge, latch=hinge / 5)
        choice = replace(plate.seal, pitch=0.1)
        return Assembly(replace(plate, seal=choice), modes)

    for hinge, few, missing in ((0.0, 8, 1e-3), (5e6, 24, 0.02)):
        exact, result = (
            np.array(
                [
                    mode.frequency
                    for mode in find_oscillations(build_assembly(n, hinge).system())[:5]
                ]
            )
            for n in (100, few)
        )
        error = float(np.abs(result / exact - 1).max())
        assert error < missing
        if hinge:
            assert estimate_basis_error(build_assembly(few, hinge), 250.0) == pytest.approx(
                error, rel=0.5
            )


def test_door_modes_are_checked_to_half_the_highest_plate_mode(monkeypatch):
    places = ROUND.stations(0.3).place
    modes = free_plate(
        np.concatenate((places, [(0.0, 0.3, 0.0), (0.0, 0.9, 0.0), (WIDTH, 0.6, 0.0)])),
        width=WIDTH, height=HEIGHT, mass=MASS, rigidity=3e4, elastic=9,
    )  # fmt: skip
    plate, limits = door(33180.0, hinge=5e6, latch=1e6), []
    monkeypatch.setattr(
        "dashpot.extensions.systems.door.modes.find_oscillations",
        lambda system, below: limits.append((len(system.dofs), below)) or find_oscillations(system),
    )
    assembly = Assembly(replace(plate, seal=replace(plate.seal, pitch=0.3)), modes)
    for below in (np.inf, 20.0):
        estimate_basis_error(assembly, below)
    retained = np.sort(modes.frequency)[: len(modes) - 3]
    count = len(assembly.system().dofs)
    expected = [(n, limit) for limit in (retained[-1] / 2, 10.0) for n in (count, count - 3)]
    assert limits == expected
    assert retained[-1] > 20.0
