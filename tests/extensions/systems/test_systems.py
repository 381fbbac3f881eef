"""Many degrees of freedom: laws, the cited numbers, and oracles that share no code."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from dashpot.base.errors import DataError
from dashpot.extensions.systems.door.modes import count_free_motions
from dashpot.extensions.systems.multibody import Body, Mount, Point, System, planar_body, point_mass
from dashpot.extensions.systems.time_response import complex_modes, newton_modes, respond
from dashpot.solids import networks as net
from dashpot.solids.demo_seals import SHIFT
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.shift_laws import shift_to_temperature
from dashpot.vibration.mass_on_seals import model_modes, predict_frf

number = st.floats(-1, 1).map(lambda power: 10.0**power)
solids = st.builds(
    lambda k_inf, k, tau, b: GeneralizedMaxwell(
        1e3 * k_inf,
        tuple(300 * value for value in k),
        tuple(0.1 * value for value in tau[: len(k)]),
        b,
    ),
    number,
    st.lists(number, min_size=1, max_size=3),
    st.lists(number, min_size=3, max_size=3, unique_by=lambda tau: round(np.log10(tau), 2)),
    st.one_of(st.just(0.0), number),
)
chains = st.lists(st.tuples(number, solids), min_size=1, max_size=4).map(
    lambda links: chain([mass for mass, _ in links], [solid for _, solid in links])
)


def chain(masses, mounts) -> System:
    """Ground - mount - mass - mount - mass ..."""
    names = ["ground"] + [f"m{i}" for i in range(len(masses))]
    return System(
        tuple(point_mass(name, mass) for name, mass in zip(names[1:], masses, strict=True)),
        tuple(Mount(solid, (names[i + 1], names[i])) for i, solid in enumerate(mounts)),
    )


# -- laws ------------------------------------------------------------------------------------------


# two masses as stiff as heavy: one search begins at the pole of the other, or is drawn to it
NEAR = (
    GeneralizedMaxwell(115.47819846894582, (310.98987853130944,), (0.1,), 1.0),
    GeneralizedMaxwell(
        237.13737056616552, (1409.2766450119475, 57.328589249113215, 305.4455165154546),
        (0.01, 0.1, 1.0), 0.27384196342643613,
    ),
    GeneralizedMaxwell(7383.358316936518, (300.0,) * 3, (0.1, 0.316227766016838, 1.0)),
)  # fmt: skip


@given(chains)
@example(chain((1.0, 10**-0.84375, 1.0, 1.0), (GeneralizedMaxwell(1e3, (300.0,), (0.1,)), *NEAR)))
@example(
    chain(
        (1.0, 10**-0.84375, 1.0, 1.0),
        (GeneralizedMaxwell(1e3, (300.0,), (0.047149440258693004,)), *NEAR),
    )
)
def test_two_ways_to_the_same_modes(system):
    newton = newton_modes(system)
    for mode in complex_modes(system):
        if mode.oscillates and mode.damping_ratio < 0.2:
            nearest = min(newton, key=lambda other: abs(other.pole - mode.pole))
            assert nearest.converged
            assert abs(nearest.pole - mode.pole) < 1e-10 * abs(mode.pole)


@given(chains, st.floats(-1, 2))
def test_poles_and_shapes_rebuild_the_receptance(system, power):
    s = 2j * np.pi * 10.0**power
    direct = system.receptance(s)
    modal = np.zeros_like(direct)
    for mode in complex_modes(system):
        term = np.outer(mode.shape, mode.shape)
        modal += term / (s - mode.pole)
        if mode.oscillates:
            modal += term.conj() / (s - mode.pole.conjugate())
    assert np.abs(modal - direct).max() < 1e-7 * np.abs(direct).max()


@given(chains, st.floats(-1, 2))
def test_reciprocity_and_passivity(system, power):
    frequency = [10.0**power]
    ends = system.dofs[0], system.dofs[-1]
    there = system.frf(response=ends[0], force=ends[1], frequency=frequency, kind="receptance")
    back = system.frf(response=ends[1], force=ends[0], frequency=frequency, kind="receptance")
    assert there.value == pytest.approx(back.value, rel=1e-9)
    driving = system.frf(response=ends[0], force=ends[0], frequency=frequency, kind="receptance")
    assert driving.value[0].imag <= 0


@given(chains)
def test_every_pole_decays(system):
    assert all(mode.pole.real < 0 for mode in complex_modes(system))


@given(st.lists(solids, min_size=1, max_size=3), st.integers(2, 4), number)
def test_equal_parallel_mounts_equal_one_mount(parts, count, mass):
    """Mounts that share relaxation times add no poles that the system has not."""
    parts = [  # relaxation times alike or clearly apart
        GeneralizedMaxwell(s.k_inf, s.k, tuple(float(f"{tau:.2g}") for tau in s.tau), s.b)
        for s in parts
    ]
    body = point_mass("m", mass)
    many = System((body,), tuple(Mount(s, ("m", "ground")) for s in parts * count))
    system = System((body,), (Mount(count * net.parallel(*parts), ("m", "ground")),))
    for a, b in zip(complex_modes(many), complex_modes(system), strict=True):
        assert a.pole == pytest.approx(b.pole, rel=1e-6)
    t = np.linspace(0, 0.5, 20)
    histories = {"force": {"m.z": np.sin(9 * t)}, "base": {"ground.z": 1e-3 * np.cos(5 * t)}}
    a, b = respond(many, t, **histories), respond(system, t, **histories)
    assert a.displacement == pytest.approx(b.displacement, rel=1e-7, abs=1e-12)
    assert a.mount_force.sum(axis=0) == pytest.approx(b.mount_force[0], rel=1e-7, abs=1e-9)


@given(chains)
def test_at_rest_everything_follows_the_ground(system):
    for dof in system.dofs:
        at_rest = system.transmissibility(response=dof, base="ground.z", frequency=[0.0])
        assert at_rest == pytest.approx([1.0], rel=1e-9)


@given(chains, st.integers(0, 1000))
def test_response_does_not_depend_on_where_a_straight_line_is_sampled(system, seed):
    rng = np.random.default_rng(seed)
    corners = np.cumsum(rng.uniform(0.01, 0.2, 6))
    force, variant = rng.normal(size=(2, 6))
    finer = np.unique(np.concatenate((corners, rng.uniform(corners[0], corners[-1], 20))))
    coarse = respond(system, corners, force={"m0.z": force}, base={"ground.z": variant})
    fine = respond(
        system,
        finer,
        force={"m0.z": np.interp(finer, corners, force)},
        base={"ground.z": np.interp(finer, corners, variant)},
    )
    at = np.searchsorted(finer, corners)
    scale = np.abs(coarse.displacement).max()
    assert np.abs(fine.displacement[:, at] - coarse.displacement).max() < 1e-9 * scale


# -- cited numbers ---------------------------------------------------------------------------------


def test_system_of_one_mass_is_equation_7_of_the_paper(paper_seal):
    """|-w^2 H| with the transfer function typed as printed, block on two seals."""
    system = System(
        (point_mass("block", 0.104),),
        (Mount(paper_seal, ("block", "ground")), Mount(paper_seal, ("block", "ground"))),
    )
    frequency = np.linspace(1, 50, 200)
    frf = system.frf(response="block.z", force="block.z", frequency=frequency)
    prediction = predict_frf(2 * paper_seal, mass=0.104, frequency=frequency)
    assert frf.value == pytest.approx(prediction.value, rel=1e-12)


def test_two_masses_on_ten_seals(paper_seal):
    """Reference row of Jeong and Singh (2001): 1 and 2 kg, both mounts ten times Table 1."""
    system = chain([1.0, 2.0], [10 * paper_seal, 10 * paper_seal])
    for modes in (complex_modes(system)[:2], newton_modes(system)):
        assert [mode.frequency for mode in modes] == pytest.approx([4.289756, 13.844388], abs=1e-6)
        assert [mode.damping_ratio for mode in modes] == pytest.approx(
            [0.0131139, 0.00407171], abs=6e-8
        )
    exact, newton = complex_modes(system)[:2], newton_modes(system)
    for item, other in zip(exact, newton, strict=True):
        assert abs(item.pole - other.pole) < 1e-10 * abs(item.pole)
        assert np.abs(item.shape / item.shape[0] - other.shape / other.shape[0]).max() < 1e-9


def test_papers_block_has_the_poles_of_its_seal(paper_seal):
    system = chain([0.104042], [2 * paper_seal])
    modes = complex_modes(system)
    assert modes[0].pole == pytest.approx(-0.354171 + 79.85693j, abs=1e-3)
    assert [mode.pole.real for mode in modes[1:]] == pytest.approx([-1.288324, -0.055776], abs=1e-5)
    assert modes[0].damping_ratio == pytest.approx(0.00443503, rel=1e-5)


def test_complex_modes_of_one_mass_equal_the_polynomial_roots(paper_seal):
    """The same poles as the roots found for one mass on one solid, residue included."""
    mode = complex_modes(chain([0.104], [2 * paper_seal]))[0]
    single = model_modes(2 * paper_seal, 0.104)[0]
    assert mode.pole == pytest.approx(single.pole, rel=1e-10)
    assert complex(mode.shape[0] ** 2) == pytest.approx(single.residue, rel=1e-9)


def test_maxwell_voigt_of_zhang_and_richards():
    """m = 1, k_v = 1e4, c_v = 10, k_m = 1e4, c_m = 50: same f and damping, different FRF."""
    system = chain([1.0], [net.maxwell_voigt(1e4, 10.0, arm_k=1e4, arm_b=50.0)])
    oscillation, relaxation = complex_modes(system)
    assert oscillation.frequency == pytest.approx(18.265016, abs=1e-6)
    assert oscillation.damping_ratio == pytest.approx(0.253326, abs=1e-6)
    assert relaxation.pole.real == pytest.approx(-151.855, abs=1e-3)
    omega, zeta = abs(oscillation.pole), oscillation.damping_ratio
    voigt = chain([1.0], [net.kelvin_voigt(omega**2, 2 * zeta * omega)])
    f = oscillation.frequency * np.array([0.1, 0.5, 1.0, 2.0, 5.0])
    ratio = [
        np.abs(item.frf(response="m0.z", force="m0.z", frequency=f).value)
        for item in (system, voigt)
    ]
    assert ratio[0] / ratio[1] == pytest.approx([1.3155, 1.2817, 1.2114, 1.1062, 1.0238], abs=6e-5)


def door(kappa: float = 0.0, pieces: int = 40) -> System:
    """A rigid plate on two hinges and a latch, with a line of seal around it."""
    width, height, mass = 1.1, 1.2, 25.0
    body = Body(
        "door", mass,
        inertia=(mass * height**2 / 12, mass * width**2 / 12, mass * (width**2 + height**2) / 12),
        at=(width / 2, height / 2, 0.0), free=("z", "rx", "ry"),
    )  # fmt: skip
    fixed = [(5e6, 0.0, 0.3), (5e6, 0.0, 0.9), (1e6, width, 0.6)]
    corners = np.array([(0, 0), (width, 0), (width, height), (0, height), (0, 0)])
    if kappa:
        for a, b in itertools.pairwise(corners):
            for part in (np.arange(pieces) + 0.5) / pieces:
                x, y = a + part * (b - a)
                fixed.append((kappa * float(np.hypot(*(b - a))) / pieces, float(x), float(y)))
    return System(
        (body,),
        tuple(Mount(net.spring(k), ("door", "ground"), at=(x, y, 0.0)) for k, x, y in fixed),
    )


def test_a_door_on_hinges_latch_and_seal():
    bare = [mode.frequency for mode in complex_modes(door())]
    assert bare == pytest.approx([54.404, 87.173, 204.014], abs=1e-3)
    sealed = [mode.frequency for mode in complex_modes(door(33180.0))]
    assert sealed == pytest.approx([56.112, 88.891, 204.703], abs=1.5e-3)


def test_a_viscoelastic_door_is_small_and_quick(paper_seal):
    """160 mounts of the same seal: three states a relaxation time, FRF and modes agree."""
    line = 33180.0 / paper_seal.k_0
    stiff = door(line)
    seal = System(
        stiff.bodies,
        tuple(
            Mount(mount.solid if i < 3 else mount.solid.k_inf * paper_seal, mount.between, mount.at)
            for i, mount in enumerate(stiff.mounts)
        ),
    )
    modes = complex_modes(seal)
    assert [mode.oscillates for mode in modes].count(True) == 3
    assert len(modes) == 3 + 2 * 3
    assert all(0 < mode.damping_ratio < 0.01 for mode in modes[:3])
    # the seal is glassy at these frequencies: the same modes as with springs of its k_0
    assert [m.frequency for m in modes[:3]] == pytest.approx([56.112, 88.891, 204.703], abs=2e-3)
    s = 2j * np.pi * 60.0
    modal = sum(
        np.outer(m.shape, m.shape) / (s - m.pole)
        + (np.outer(m.shape, m.shape) / (s.conjugate() - m.pole)).conj() * m.oscillates
        for m in modes
    )
    assert modal == pytest.approx(seal.receptance(s), rel=1e-8, abs=1e-14)


def sealed_door(line: GeneralizedMaxwell) -> System:
    """The door with a seal, N/m per m of line: two Gauss points a side integrate it exactly."""
    bare = door()
    corners = np.array([(0, 0), (1.1, 0), (1.1, 1.2), (0, 1.2), (0, 0)])
    mounts = []
    for a, b in itertools.pairwise(corners):
        for part in (0.5 - 0.5 / 3**0.5, 0.5 + 0.5 / 3**0.5):
            x, y = a + part * (b - a)
            piece = line * (float(np.hypot(*(b - a))) / 2)
            mounts.append(Mount(piece, ("door", "ground"), at=(float(x), float(y), 0.0)))
    return System(bare.bodies, bare.mounts + tuple(mounts))


@pytest.mark.parametrize(
    ("celsius", "frequencies", "ratios"),
    [
        (-20, [57.79719, 90.60847, 205.40435], [1.1e-6]),
        (23, [58.26584, 91.13105, 205.63511], [0.0024313, 0.0012544, 0.000119]),
        (80, [57.94382, 91.00565, 205.67290], [0.0125267, 0.0069561, 0.0008755]),
    ],
)
def test_a_door_in_the_cold_and_in_the_heat(broad_seal, celsius, frequencies, ratios):
    """Numbers computed apart: ten broad seals of 50 mm to a line, WLF, stiffness as T."""
    line = shift_to_temperature((10 / 0.05) * broad_seal, celsius + 273.15, SHIFT)
    system = sealed_door(line)
    modes = newton_modes(system)[:3]
    assert [mode.frequency for mode in modes] == pytest.approx(frequencies, abs=6e-6)
    damping_ratios = [mode.damping_ratio for mode in modes]
    assert damping_ratios[: len(ratios)] == pytest.approx(ratios, abs=6e-8)
    # a solver of the linear states finds the same poles
    for mode, other in zip(modes, complex_modes(system), strict=False):
        assert mode.pole == pytest.approx(other.pole, rel=1e-9)


def test_block_rocks_where_its_geometry_says(broad_seal):
    """Bounce at 12.71 Hz, rocking at 16.57 Hz: L = 120 mm, seals 45 mm off the middle."""
    mass, length, arm = 0.114829829, 0.120, 0.045
    block = planar_body("block", mass, mass * length**2 / 12)
    system = System(
        (block,),
        (
            Mount(broad_seal, ("block", "ground"), at=(-arm, 0.0, 0.0), along=(0.0, 1.0, 0.0)),
            Mount(broad_seal, ("block", "ground"), at=(arm, 0.0, 0.0), along=(0.0, 1.0, 0.0)),
            Mount(net.spring(1e6), ("block", "ground"), along=(1.0, 0.0, 0.0)),
        ),
    )
    f = np.linspace(5, 30, 5001)
    middle = Point("block", (0.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    bounce = np.abs(system.frf(response=middle, force=middle, frequency=f).value)
    assert f[bounce.argmax()] == pytest.approx(12.71, abs=0.01)
    assert bounce.max() == pytest.approx(155.227, rel=1e-4)
    rocking = np.abs(system.frf(response="block.rz", force="block.rz", frequency=f).value)
    assert f[rocking.argmax()] == pytest.approx(16.57, abs=0.05)
    # two accelerometers: their mean hears bounce alone, however eccentric the hit
    hit = Point("block", (0.010, 0.0, 0.0), (0.0, 1.0, 0.0))
    pair = [Point("block", (x, 0.0, 0.0), (0.0, 1.0, 0.0)) for x in (-0.05, 0.05)]
    heard = [system.frf(response=item, force=hit, frequency=f).value for item in pair]
    expected = system.frf(response=middle, force=middle, frequency=f).value
    assert (heard[0] + heard[1]) / 2 == pytest.approx(expected, rel=1e-9)


@pytest.fixture(scope="module")
def broad_seal() -> GeneralizedMaxwell:
    """Table 1 with three fast arms that a slow ramp cannot see."""
    return GeneralizedMaxwell(
        196.5,
        (117.5, 17.8, 20.0, 20.0, 20.0),
        (59.0 / 117.5, 292.2 / 17.8, 0.08, 0.016, 0.0032),
    )


def test_a_clutch_turns_as_masses_slide():
    """Gaillard and Singh's linear clutch in rotary units: same numbers, N m/rad for N/m."""
    clutch = net.maxwell_voigt(1000.0, 5.0, arm_k=400.0, arm_b=20.0)
    shaft = net.kelvin_voigt(3000.0, 1.0)
    inertia = {"flywheel": 0.2, "gearbox": 0.05}
    turning = System(
        tuple(
            Body(name, 3.0, inertia=(0.0, 0.0, value), at=(0.1, 0.2, 0.3), free=("rz",))
            for name, value in inertia.items()
        ),
        (
            Mount(clutch, ("gearbox", "flywheel"), rotary=True),
            Mount(shaft, ("flywheel", "ground"), rotary=True),
        ),
    )
    sliding = chain(list(inertia.values()), [shaft, clutch])
    pairs = zip(complex_modes(turning), complex_modes(sliding), strict=True)
    assert all(mode.pole == pytest.approx(other.pole, rel=1e-12) for mode, other in pairs)
    f = [1.0, 10.0, 30.0]
    spun = turning.frf(response="gearbox.rz", force=Point("flywheel", rotary=True), frequency=f)
    slid = sliding.frf(response="m1.z", force="m0.z", frequency=f)
    assert spun.value == pytest.approx(slid.value, rel=1e-10)


# -- time ------------------------------------------------------------------------------------------


def test_steady_state_is_the_frf(paper_seal):
    """A sine long enough to settle, on the two-mass system: within 0.5 % of the FRF."""
    system = chain([1.0, 2.0], [10 * paper_seal, 10 * paper_seal])
    f = 6.0
    t = np.arange(0, 20, 1 / (f * 200))
    motion = respond(system, t, force={"m1.z": np.cos(2 * np.pi * f * t)})
    last = t > 18
    basis = np.stack([np.cos(2 * np.pi * f * t[last]), -np.sin(2 * np.pi * f * t[last])], axis=1)
    frf = system.frf(response="m0.z", force="m1.z", frequency=[f], kind="receptance").value[0]
    real, imaginary = np.linalg.lstsq(basis, motion.displacement[0, last], rcond=None)[0]
    assert abs(complex(real, imaginary) / frf - 1) < 0.005


def test_a_mount_on_an_unmovable_body_pulls_as_equation_5(paper_seal):
    """The ground makes the paper's ramp and hold; the body is too heavy to follow."""
    system = chain([1e15], [paper_seal])
    t = np.linspace(0, 41, 83)
    variant = 8e-3 * np.clip(t, 0, 1)
    motion = respond(system, t, base={"ground.z": variant})
    expected = paper_seal.ramp_hold_force(t, depth=8e-3, ramp_time=1.0)
    assert -motion.mount_force[0] == pytest.approx(expected, rel=1e-9, abs=1e-12)
    assert -motion.mount_force[0, 2] == pytest.approx(2.117728, abs=1e-6)


def test_time_response_agrees_with_an_integrator(paper_seal):
    """scipy's stiff integrator on equations of motion written out by hand, dashpot included."""
    from scipy.integrate import solve_ivp

    m, k, tau, b = 0.05, 117.5, 0.5, 0.3
    system = chain([m], [GeneralizedMaxwell(196.5, (k,), (tau,), b)])
    corners = np.array([0.0, 0.05, 0.1, 0.2, 0.4])
    force = np.array([0.0, 1.0, 0.0, 0.0, 0.5])
    variant = np.array([0.0, 1e-3, 1e-3, -2e-3, 0.0])

    def equations(t, z):
        i = min(int(np.searchsorted(corners, t, side="right")) - 1, len(corners) - 2)
        speed = (variant[i + 1] - variant[i]) / (corners[i + 1] - corners[i])
        e, e_dot = z[0] - np.interp(t, corners, variant), z[1] - speed
        pull = 196.5 * e + k * (e - z[2]) + b * e_dot
        return [z[1], (np.interp(t, corners, force) - pull) / m, (e - z[2]) / tau]

    state = np.zeros(3)
    for a, c in itertools.pairwise(corners):
        inside = (a, c - 1e-15)
        state = solve_ivp(equations, inside, state, rtol=1e-10, atol=1e-13, method="Radau").y[:, -1]
    motion = respond(system, corners, force={"m0.z": force}, base={"ground.z": variant})
    assert motion.displacement[0, -1] == pytest.approx(state[0], rel=1e-6)
    assert motion.velocity[0, -1] == pytest.approx(state[1], rel=1e-6)


def test_a_step_of_the_ground_kicks_through_a_dashpot():
    """A Kelvin-Voigt mount whose ground jumps by u gives the mass the momentum b u."""
    system = chain([2.0], [net.kelvin_voigt(100.0, 3.0)])
    motion = respond(system, [0.0, 1e-9], base={"ground.z": [0.01, 0.01]})
    assert motion.velocity[0, 0] == pytest.approx(3.0 * 0.01 / 2.0)


def test_a_free_body_flies():
    """Nothing holds it: x = F t^2 / 2 m, and rigid motions are not listed as modes."""
    system = System((point_mass("puck", 2.0), point_mass("tail", 1.0)), (
        Mount(net.kelvin_voigt(1e4, 1.0), ("puck", "tail")),
    ))  # fmt: skip
    t = np.linspace(0, 1, 11)
    motion = respond(system, t, force={"puck.z": np.full(11, 3.0)})
    centre = (2 * motion.displacement[0] + motion.displacement[1]) / 3
    assert centre == pytest.approx(t**2 / 2, abs=1e-9)
    assert len(complex_modes(system)) == 1


def test_six_degrees_of_freedom_turn_with_the_axes(paper_seal):
    """The same tilted block described along other axes has the same poles."""
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    everything = ("x", "y", "z", "rx", "ry", "rz")
    rng = np.random.default_rng(1)
    places, directions = rng.normal(size=(2, 8, 3))
    inertia = np.diag([0.02, 0.03, 0.04])

    def build(R):
        tensor = tuple(tuple(row) for row in (R @ inertia @ R.T).tolist())
        body = Body("block", 2.0, inertia=tensor, free=everything)
        return System((body,), tuple(
            Mount(5 * paper_seal, ("block", "ground"), tuple(R @ p), tuple(R @ d))
            for p, d in zip(places, directions, strict=True)
        ))  # fmt: skip

    straight, turned = (complex_modes(build(R)) for R in (np.eye(3), turn))
    assert len([mode for mode in straight if mode.oscillates]) == 6
    assert [m.pole for m in turned] == pytest.approx([m.pole for m in straight], rel=1e-8)


# -- refusals --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: point_mass("a", 0.0), "mass = 0.0 kg"),
        (lambda: Body("a", 1.0, free=("w",)), "expected different names"),
        (lambda: Body("a", 1.0, free=("rx",)), "inertia"),
        (lambda: Body("a.b", 1.0), "dot"),
        (lambda: Mount(net.spring(1.0), ("a", "a")), "to itself"),
        (lambda: Mount(net.spring(1.0), ("a", "b"), along=(0.0, 0.0, 0.0)), "no length"),
        (lambda: System((), ()), "at least one body"),
        (lambda: System((point_mass("a", 1.0), point_mass("a", 2.0)), ()), "two things"),
        (
            lambda: System((point_mass("a", 1.0),), (Mount(net.spring(1.0), ("a", "wall")),)),
            "'wall', which is not in the system",
        ),
        (
            lambda: chain([1.0], [net.spring(1.0)]).frf(
                response="m0.x", force="m0.z", frequency=[1.0]
            ),
            "'m0.x' is no degree of freedom",
        ),
        (
            lambda: chain([1.0], [net.spring(1.0)]).transmissibility(
                response="m0.z", base="floor.z", frequency=[1.0]
            ),
            "'floor.z' is no ground motion",
        ),
        (
            lambda: System((point_mass("a", 1.0),), ()).frf(
                response="a.z", force="a.z", frequency=[0.0]
            ),
            "the response is infinite",
        ),
        (
            lambda: respond(chain([1.0], [net.spring(1.0)]), [0, 1], force={"m0.z": [1.0]}),
            "one value per sample",
        ),
        (
            lambda: respond(chain([1.0], [net.spring(1.0)]), [0, 0], force={}),
            "increase strictly",
        ),
    ],
)
def test_what_is_refused(call, sentence):
    with pytest.raises(DataError, match=sentence):
        call()


@pytest.mark.parametrize("grounds", [("car",), ()])
@pytest.mark.parametrize("missing", [0, 1, 2])
def test_motions_of_a_door_that_nothing_holds_are_counted(grounds, missing):
    """Six bars hold a body on another; the six motions of a car that flies are none of the door."""
    bars = [((0, 0, 0), (1, 0, 0)), ((0, 0, 0), (0, 1, 0)), ((0, 0, 0), (0, 0, 1)),
            ((1, 0, 0), (0, 1, 0)), ((1, 0, 0), (0, 0, 1)), ((0, 1, 0), (0, 0, 1))]  # fmt: skip
    solid = GeneralizedMaxwell(1e4, (1e3,), (0.1,))
    mounts = tuple(
        Mount(solid, ("door", "car"), at, along=along) for at, along in bars[: 6 - missing]
    )
    six = ("x", "y", "z", "rx", "ry", "rz")
    bodies = [Body("door", 30.0, (1.0, 2.0, 3.0), free=six)]
    if not grounds:
        bodies.append(Body("car", 900.0, (300.0, 900.0, 900.0), at=(0.5, 1.0, 0.0), free=six))
    assert count_free_motions(System(tuple(bodies), mounts, grounds)) == missing
