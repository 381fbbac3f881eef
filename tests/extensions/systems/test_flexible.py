"""Bodies that bend by their free modes: against exact beams, and who holds the energy."""

from __future__ import annotations

from decimal import Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dashpot.base.errors import DataError
from dashpot.extensions.systems.door.energy_shares import energy_shares
from dashpot.extensions.systems.free_modes import FreeModes
from dashpot.extensions.systems.multibody import Body, Mount, Point, System, planar_body
from dashpot.extensions.systems.time_response import complex_modes, newton_modes
from dashpot.solids import networks as net
from dashpot.solids.demo_seals import BROAD, PAPER
from dashpot.solids.maxwell import GeneralizedMaxwell


def beam(modes: int, solid: GeneralizedMaxwell, *, to: float = 1.0, pieces: int = 100) -> System:
    """A pinned beam, 1 m, 2 kg/m, 30 Hz by itself, on a seal, N/m per m, from 0 to `to`."""
    x = (np.arange(pieces) + 0.5) / pieces * to
    n = np.arange(1, modes + 1)
    shape = np.zeros((modes, pieces, 3))
    shape[:, :, 2] = np.sin(np.pi * n[:, None] * x)  # sqrt(2 / (mu L)) is 1
    place = np.stack((x, 0 * x, 0 * x), axis=1)
    body = Body("beam", 2.0, free=(), modes=FreeModes(30.0 * n**2, place, shape))
    piece = solid * (to / pieces)
    mounts = [Mount(piece, ("beam", "ground"), tuple(p), name="seal") for p in place.tolist()]
    return System((body,), tuple(mounts))


@pytest.mark.parametrize(
    ("solid", "exact"),
    [
        (PAPER, ["31.36945929 1.5350e-4", "120.34968100 2.718e-6", "270.15559569 2.403e-7"]),
        (BROAD, ["31.54618227 .002195376", "120.40959 8.1586e-5"]),
    ],
)
def test_a_beam_on_a_seal_is_exact(solid, exact):
    r"""Roots of :math:`s^2\mu + EI(n\pi/L)^4 + \kappa(s) = 0`, found apart; 50 mm carry `solid`."""
    system = beam(3, 20 * solid)
    for result in (complex_modes(system), newton_modes(system)):
        for mode, words in zip(result, exact, strict=False):
            for value, word in zip(
                (mode.frequency, mode.damping_ratio), words.split(), strict=True
            ):
                last = 10.0 ** Decimal(word).as_tuple().exponent
                assert value == pytest.approx(float(word), abs=1.01 * last)


@pytest.mark.parametrize(
    ("modes", "hertz"), [(1, 30.692367), (3, 30.690832), (10, 30.690816), (30, 30.69081592)]
)
def test_half_a_seal_converges_with_the_modes(modes, hertz):
    """Coupled by the seal on 0 to L/2 alone; the numbers were computed apart."""
    first = complex_modes(beam(modes, 20 * PAPER, to=0.5, pieces=200))[0]
    # the middles of 200 pieces integrate a product of sines to 3e-8 Hz
    assert first.frequency == pytest.approx(hertz, abs=5.5e-7 if modes < 30 else 3.5e-8)
    assert first.damping_ratio == pytest.approx(8.158e-5, rel=1e-4 if modes > 1 else 5e-3)


def rigid_shapes(place: np.ndarray, mass: float, inertia: np.ndarray) -> np.ndarray:
    """Six rigid modes of modal mass 1 of a body about the origin, shape (6, p, 3)."""
    x, y, z = place.T
    nil, ones_like = np.zeros_like(x), np.ones_like(x)
    motions = np.array(
        [
            (ones_like, nil, nil),
            (nil, ones_like, nil),
            (nil, nil, ones_like),
            (nil, -z, y),
            (z, nil, -x),
            (-y, x, nil),
        ]
    ).transpose(0, 2, 1)
    return motions / np.sqrt(np.array([mass] * 3 + inertia.tolist()))[:, None, None]


def test_rigid_modes_say_what_a_body_weighs():
    """The tensor about the origin comes back, and those modes alone are rigid."""
    draw = np.random.default_rng(0)
    place, inertia = draw.uniform(-1, 1, (20, 3)), np.array([3.0, 2.5, 5.0])
    bent = draw.standard_normal((2, 20, 3))
    modes = FreeModes(
        [1e-3] * 6 + [30.0, 50.0], place, np.concatenate((rigid_shapes(place, 25.0, inertia), bent))
    )
    assert modes.rigid.tolist() == [True] * 6 + [False] * 2
    assert modes.rigid_mass() == pytest.approx(np.diag([25.0] * 3 + inertia.tolist()), abs=1e-9)
    with pytest.raises(DataError, match="5 of the 7 modes are rigid motions"):
        modes.only(np.arange(8) != 2).rigid_mass()
    system = System((Body("door", 25.0, (3.0, 2.5, 5.0), free=("z", "rx", "ry")),), ())
    assert system.with_modes("door", modes).dofs == (
        "door.z", "door.rx", "door.ry", "door.q1", "door.q2",
    )  # fmt: skip
    with pytest.raises(DataError, match="no body 'roof'"):
        system.with_modes("roof", modes)


@given(st.integers(0, 5), st.integers(0, 5), st.floats(0, 1))
def test_shapes_between_points_are_straight(first, second, share):
    """At a point the shape is that of the point; on the way to its neighbour it is straight."""
    x = np.array([0.0, 0.2, 0.5, 0.6, 0.9, 1.0])
    place = np.stack((x, 0 * x, 0 * x), axis=1)
    modes = FreeModes([10.0], place, np.stack((0 * x, 3 * x, 1 - x), axis=1)[None])
    at = place[first] + share * (place[second] - place[first])
    shape, away = modes.evaluate_shapes(at + np.array([0, 0.02, 0]))
    assert shape[0] == pytest.approx([0.0, 3 * at[0], 1 - at[0]], abs=1e-5)  # nearest to 1e-12 m
    assert away == pytest.approx(0.02)


def test_a_free_free_beam_hung_by_both_of_its_models():
    """Rigid motions and elastic modes on two springs: the FRF of a fine chain of masses."""
    n, length, mass, rigidity = 41, 1.0, 2.0, 50.0
    x = np.linspace(0, length, n)
    weights = np.full(n, mass / (n - 1))
    weights[[0, -1]] /= 2
    bend = np.diff(np.eye(n), 2, axis=0) / (x[1] - x[0]) ** 2
    K = rigidity * (x[1] - x[0]) * bend.T @ bend
    root = np.sqrt(weights)
    squared, vectors = np.linalg.eigh(K / root / root[:, None])
    frequency = np.sqrt(np.maximum(squared, 0)) / (2 * np.pi)
    shape = np.zeros((n, n, 3))
    shape[:, :, 2] = (vectors / root[:, None]).T
    place = np.stack((x, 0 * x, 0 * x), axis=1)
    modes = FreeModes(frequency, place, shape)
    assert modes.rigid.sum() == 2
    inertia = float(weights @ (x - 0.5) ** 2)
    body = Body("beam", mass, (1.0, inertia, 1.0), (0.5, 0.0, 0.0), free=("z", "ry"))
    springs = tuple(
        Mount(net.spring(k), ("beam", "ground"), (at, 0.0, 0.0))
        for k, at in ((2e3, 0.2), (5e3, 0.9))
    )
    bent = System((body,), springs).with_modes("beam", modes)
    for k, at in ((2e3, 0.2), (5e3, 0.9)):
        node = int(np.abs(x - at).argmin())
        K[node, node] += k
    exact = np.sqrt(np.linalg.eigvalsh(K / root / root[:, None])) / (2 * np.pi)
    frequencies = [mode.frequency for mode in complex_modes(bent)[:4]]
    assert frequencies == pytest.approx(exact[:4], rel=1e-8)
    tip = Point("beam", (1.0, 0.0, 0.0))
    H = bent.frf(response=tip, force=tip, frequency=[7.0, 40.0], kind="receptance").value
    for f, value in zip((7.0, 40.0), H, strict=True):
        D = K - (2 * np.pi * f) ** 2 * np.diag(weights)
        assert value == pytest.approx(np.linalg.inv(D)[-1, -1], rel=1e-6)


def test_energy_shares_add_up_and_their_losses_are_the_damping():
    r"""Shares add to 1, losses to :math:`2\zeta` of a light mode; a lossless part loses nothing."""
    body = planar_body("plate", 10.0, 2.0)
    parts = [
        ("seal", 200 * BROAD, -0.4),
        ("seal", 100 * BROAD, 0.1),
        ("hinge", net.spring(4e4), 0.5),
    ]
    mounts = [
        Mount(solid, ("plate", "ground"), (x, 0.0, 0.0), (0.0, 1.0, 0.0), name=name)
        for name, solid, x in parts
    ]
    mounts.append(Mount(net.spring(1e5), ("plate", "ground"), along=(1.0, 0.0, 0.0), name="x"))
    system = System((body,), tuple(mounts))
    for mode in newton_modes(system):
        shares = {energy_share.name: energy_share for energy_share in energy_shares(system, mode)}
        assert list(shares) == ["seal", "hinge", "x"]
        assert sum(share.energy for share in shares.values()) == pytest.approx(1)
        assert shares["hinge"].loss == shares["x"].loss == 0
        assert shares["seal"].loss == pytest.approx(2 * mode.damping_ratio, rel=0.02, abs=1e-12)


def test_a_modal_spring_loses_what_its_damping_ratio_says():
    modes = FreeModes([20.0], [[0.0, 0.0, 0.0]], [[[0.0, 0.0, 1.0]]], 0.03)
    system = System((Body("panel", 1.0, free=(), modes=modes),), ())
    (mode,) = complex_modes(system)
    assert (mode.frequency, mode.damping_ratio) == pytest.approx((20.0, 0.03))
    (share,) = energy_shares(system, mode)
    assert (share.name, share.energy, share.loss) == ("panel", 1.0, pytest.approx(0.06))


# -- a base that shakes ----------------------------------------------------------------------------
