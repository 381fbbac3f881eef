"""From a material to a part: published factors, and the chain from DMA sweeps to a shaker."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from kit.shell import ran, run_json
from scipy.optimize import brentq, minimize_scalar

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.extensions.amplitude.datamodel import AmplitudeSweep
from dashpot.extensions.amplitude.fit import fit_amplitude
from dashpot.extensions.amplitude.payne_softening import Softening
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.dynamic.fit import fit_dynamic
from dashpot.extensions.systems.level_response import response_at_level
from dashpot.extensions.systems.multibody import Mount, System, point_mass
from dashpot.solids.part_geometry import Block, Bulb, Bush, Disc, bonded_block, bonded_cylinder
from dashpot.vibration.mass_on_seals import geometry_factor, mass_for_peak

ELEMENTS = Path(__file__).parents[1] / "solids"
TAU = np.geomspace(1e-7, 1e3, 21)
RUBBER = dp.GeneralizedMaxwell(
    3e6, tuple(2e6 * np.exp(-0.5 * ((np.log10(TAU) + 3) / 2.5) ** 2)), tuple(TAU)
)
"""Pa, at 23 degC."""


class TestFactors:
    def test_a_disc_between_plates(self):
        disc = Disc(0.02, 0.02)
        assert 1e6 * disc.factor(bonded=False) == pytest.approx(15707.963, rel=1e-7)
        assert 1e6 * disc.factor() == pytest.approx(15707.963 * bonded_cylinder(0.25), rel=1e-7)
        assert disc.factor("shear") == pytest.approx(disc.area / 0.02 / 3)
        assert Disc("20mm", "20mm") == disc

    def test_bonded_cylinders_are_those_of_finite_elements(self):
        """Within .41 %, where 1 + 2 S^2 is off by 6 %."""
        rows = np.genfromtxt(ELEMENTS / "bonded_cylinder.csv", delimiter=",", comments="#")
        S, nu = rows[0, 1:], rows[1:, 0]
        ours = np.array([[bonded_cylinder(s, n) for s in S] for n in nu])
        assert np.abs(ours / rows[1:, 1:] - 1).max() < 0.0041
        soft = rows[1 + np.argmin(np.abs(nu - 0.499)), 1:]
        assert np.abs((1 + 2 * S**2) / soft - 1)[S < 1.5].max() > 0.055

    def test_bonded_blocks_are_those_of_finite_elements(self):
        rows = np.genfromtxt(ELEMENTS / "bonded_block.csv", delimiter=",", comments="#")
        for wide, S, *factors in rows[1:]:
            ours = [bonded_block(S, 1 / wide, nu) for nu in rows[0, 2:]]
            assert ours == pytest.approx(factors, rel=0.0125), (wide, S)
        # a, b = 20, 40 mm: S = 6.667 / h
        block = Block(0.02, 0.04, 0.02)
        assert block.shape_factor == pytest.approx(1 / 3)
        stiffer = block.factor() / block.factor(bonded=False)
        assert stiffer == bonded_block(1 / 3, 0.5) == Block(0.04, 0.02, 0.02).factor() / 0.04
        assert replace(block, poisson=0.35).factor() < block.factor()

    def test_a_thin_layer_is_that_of_lubrication(self):
        """A flat disc: 2 S^2; a flat square 2.249, a strip 4/3 of its own, incompressible."""
        S = 60.0
        for thin, factor in (
            (2.0, bonded_cylinder(S, 0.5)), (2.24923, bonded_block(S, 1.0, 0.5)),
            (4 / 3, bonded_block(S, 1e-4, 0.5)),
        ):  # fmt: skip
            assert factor / S**2 == pytest.approx(thin, rel=0.02)

    def test_a_thin_bush_is_a_flat_pad_in_shear(self):
        a, t, L = 0.05, 1e-5, 0.03
        bush = Bush(2 * a, 2 * (a + t), L)
        around = 2 * np.pi * a * L
        assert bush.factor("axial") == pytest.approx(around / t / 3, rel=1e-3)
        assert bush.factor("torsion") == pytest.approx(around * a**2 / t / 3, rel=1e-3)

    def test_long_bush_is_stiffer_than_a_short_bush(self):
        bush = Bush(0.012, 0.03, 0.04)
        assert bush.factor("radial-long") > bush.factor("radial-short") > bush.factor("axial")

    def test_a_bulb_is_a_thin_ring(self):
        # t = 2, R = 10 mm, E = 2 MPa, nu = .45: 1.12375 N/mm per 100 mm
        bulb = Bulb("22mm", "2mm", "100mm", poisson=0.45)
        assert 2e6 * bulb.factor() == pytest.approx(1123.75, rel=1e-5)
        thin = Bulb(20.2e-3, 0.2e-3, 0.1)
        assert thin.factor() == pytest.approx(ring_of_beams(thin), rel=2e-3)
        # what stretch and shear of the wall take
        for wall, softer in ((1e-3, 0.025), (2e-3, 0.09)):
            bulb = Bulb(20e-3 + wall, wall, 0.1)
            assert 1 - ring_of_beams(bulb) / bulb.factor() == pytest.approx(softer, abs=0.005)

    @pytest.mark.parametrize(
        "ask",
        [
            lambda: Disc(0.02, 0.0),
            lambda: Disc("20g", "20mm"),
            lambda: Bush(0.03, 0.012, 0.04),
            lambda: Bush(0.012, 0.03, 0.04).factor("compression"),
            lambda: Bush(0.012, 0.03, 0.04).factor(bonded=False),
            lambda: Disc(0.02, 0.02).factor("shear", bonded=False),
            lambda: Disc(0.02, 0.02).factor("torsion"),
            lambda: Bulb(0.023, 0.00301, 0.1),
            lambda: Bulb(0.02, 0.002, 0.1, poisson=0.51),
            lambda: Disc(0.02, 0.02, poisson=0.19),
            lambda: Block(0.02, 0.02, 0.02, poisson=0.51),
        ],
    )
    def test_shapes_that_are_none(self, ask):
        with pytest.raises(DataError):
            ask()


def ring_of_beams(bulb, count=160):
    """Stiffness of a pressed ring over Young's modulus, m: a quarter of it in straight beams."""
    radius, plain = bulb.radius, 1 / (1 - bulb.poisson**2)
    area, inertia = (plain * bulb.length * bulb.wall**n / {1: 1, 3: 12}[n] for n in (1, 3))
    sheared = bulb.length * bulb.wall / 1.2 / (2 * (1 + bulb.poisson))
    angle = np.linspace(0, np.pi / 2, count + 1)
    place = radius * np.column_stack((np.cos(angle), np.sin(angle)))
    whole = np.zeros((3 * count + 3,) * 2)
    for i in range(count):
        along = place[i + 1] - place[i]
        L = np.hypot(*along)
        c, s = along / L
        f = 12 * inertia / (sheared * L**2)  # Timoshenko's beam
        a, b = area / L, inertia / L**3 / (1 + f)
        local = np.zeros((6, 6))
        local[np.ix_([0, 3], [0, 3])] = a * np.array([[1, -1], [-1, 1]])
        local[np.ix_([1, 2, 4, 5], [1, 2, 4, 5])] = b * np.array(
            [
                [12, 6 * L, -12, 6 * L],
                [6 * L, (4 + f) * L**2, -6 * L, (2 - f) * L**2],
                [-12, -6 * L, 12, -6 * L],
                [6 * L, (2 - f) * L**2, -6 * L, (4 + f) * L**2],
            ]
        )
        turn = np.kron(np.eye(2), [[c, s, 0], [-s, c, 0], [0, 0, 1]])
        at = slice(3 * i, 3 * i + 6)
        whole[at, at] += turn.T @ local @ turn
    # symmetry: at the side no rise and no turn, at the top no drift and no turn
    free = np.setdiff1d(np.arange(len(whole)), [1, 2, len(whole) - 3, len(whole) - 1])
    load = np.zeros(len(whole))
    load[-2] = 0.5  # half the load on each side of the top
    variant = np.linalg.solve(whole[np.ix_(free, free)], load[free])[-1]
    return 1 / (2 * variant)


def peak_of(K, mass, near=60.0):
    """Frequency and height of |T|, by a search of our own."""

    def height(hz):
        w = 2 * np.pi * hz
        stiffness = K(omega=w)
        return -abs(stiffness / (stiffness - mass * w**2))

    grid = np.geomspace(near / 8, near * 8, 4000)
    at = grid[np.argmin([height(hz) for hz in grid])]
    best = minimize_scalar(
        height, bounds=(0.99 * at, 1.01 * at), method="bounded", options={"xatol": 1e-7}
    )
    return best.x, -best.fun


class TestResonance:
    @pytest.mark.parametrize("kind", ["transmissibility", "accelerance"])
    def test_the_factor_comes_back(self, kind):
        factor, mass = 0.0234, 0.15
        f = np.linspace(40, 300, 200001)
        frf = dp.systems.predict_frf(RUBBER * factor, mass=mass, frequency=f, kind=kind)
        at = f[np.abs(frf.value).argmax()]
        assert geometry_factor(RUBBER, mass=mass, peak=at, kind=kind) == pytest.approx(
            factor, rel=1e-4
        )

    def test_the_mass_under_a_peak_of_transmissibility(self):
        mass = mass_for_peak(RUBBER * 0.02, 60.0, "transmissibility")
        hz, _ = peak_of((RUBBER * 0.02).complex_stiffness, mass)
        assert hz == pytest.approx(60.0, rel=1e-5)

    def test_what_has_no_peak(self):
        with pytest.raises(DataError, match="no part of this material has a peak"):
            geometry_factor(dp.solids.networks.dashpot(5.0), mass=1.0, peak=10.0)
        with pytest.raises(DataError, match="peak = -1"):
            geometry_factor(RUBBER, mass=1.0, peak=-1.0)


def sweeps(seed=0, noise=0.01):
    """Five temperatures of a DMA, half of whose range overlaps."""
    rng = np.random.default_rng(seed)
    f, rows = np.geomspace(0.1, 40, 14), []
    for celsius in (-15, 0, 12, 23, 45):
        T = celsius + 273.15
        a = 10 ** (-6.94 * (T - 296.15) / (129.6 + T - 296.15))
        E = RUBBER.complex_stiffness(omega=2 * np.pi * f * a)
        E = E * (1 + noise * (rng.normal(size=len(f)) + 1j * rng.normal(size=len(f))) / np.sqrt(2))
        rows.append((f, E.real, E.imag, np.full(len(f), T)))
    return DynamicTest(*(np.concatenate(item) for item in zip(*rows, strict=True)), units="SI")


@pytest.mark.once
def test_from_sweeps_to_two_discs_on_a_shaker():
    """One factor from the lightest mass; the others, and ten times the level, are foretold."""
    master = dp.solids.superpose(sweeps(), reference="23degC")
    fit = fit_dynamic(master)
    true = RUBBER * (2 * Disc(0.02, 0.012).factor() * 0.93)  # bonds that are not perfect
    masses = (0.15, 0.4, 1.0)
    real = [peak_of(true.complex_stiffness, mass) for mass in masses]
    factor = geometry_factor(fit.solid, mass=masses[0], peak=real[0][0])
    part = fit.part(factor)
    assert part.unit == "N/m"
    for mass, (hz, height) in zip(masses, real, strict=True):
        message, peak = peak_of(part.solid.complex_stiffness, mass)
        assert message == pytest.approx(hz, rel=0.02)
        assert peak == pytest.approx(height, rel=0.15)

    def phi(X, d=0.5, X_c=4e-5, m=0.5):
        u = (X / X_c) ** m
        return 1 - d + d / (1 + u**2) + 2j * d * m / np.pi * u / (1 + u**2)

    # an amplitude sweep of the material at 10 Hz shows the softening, in displacement of the part
    X = np.geomspace(1e-6, 1e-3, 16)
    E = RUBBER.complex_stiffness(omega=2 * np.pi * 10) * phi(X)
    law = fit_amplitude(
        AmplitudeSweep(np.full(16, 10.0), X, E.real, E.imag, amplitude_unit="m", units="SI"),
        law="factor",
    )
    solid = part.solid.maxwell
    system = System(
        (point_mass("m", masses[1]),),
        (
            Mount(
                solid,
                ("m", "ground"),
                friction=Softening(solid, law.lost, law.half_way, law.exponent),
            ),
        ),
    )

    def find_peaks_at_level(base):
        f = np.linspace(0.5 * real[1][0], 1.2 * real[1][0], 200)
        got = (
            response_at_level(
                system, response="m.z", base="ground.z", level=base, frequency=f
            ).amplitude
            / base
        )
        want = []
        for hz in f:
            w = 2 * np.pi * hz
            K = true.complex_stiffness(omega=w)

            def compute_log_excess(u, w=w, K=K):
                X = np.exp(u)
                return np.log(abs(K * phi(X) - masses[1] * w**2) * X / (masses[1] * w**2 * base))

            X = np.exp(brentq(compute_log_excess, np.log(1e-12), 0.0))
            relative = masses[1] * w**2 * base / (K * phi(X) - masses[1] * w**2)
            want.append(abs(1 + relative / base))
        want = np.array(want)
        return f[got.argmax()], got.max(), f[want.argmax()], want.max()

    low, high = find_peaks_at_level(1e-6), find_peaks_at_level(1e-5)
    assert high[0] / low[0] == pytest.approx(high[2] / low[2], rel=0.015)
    assert high[2] < 0.97 * low[2]
    assert high[0] == pytest.approx(high[2], rel=0.03)
    assert high[1] == pytest.approx(high[3], rel=0.2)


class TestCommand:
    @pytest.fixture
    def dma(self, tmp_path):
        f = np.geomspace(0.01, 1000, 40)
        E = RUBBER.complex_stiffness(omega=2 * np.pi * f)
        path = tmp_path / "dma.csv"
        np.savetxt(
            path,
            np.column_stack((f, E.real * 1e-6, E.imag * 1e-6)),
            delimiter=",",
            header="frequency [Hz],storage modulus [MPa],loss modulus [MPa]",
            comments="",
        )
        fit = tmp_path / "dma.json"
        done = ran("fit", path, "-o", fit)
        assert done.exit_code == 0, done.output
        return str(fit)

    def peak(self, *words):
        document = run_json("predict", *words, "--base", "--band", "5:300Hz")
        return document["peak"]["frequency_hz"]

    def test_predict_accepts_a_shape_or_a_resonance(self, dma):
        mass = ["--mass", "400g", "--seals", "2"]
        drawn = self.peak(dma, "--shape", "disc:20mm,12mm", *mass)
        expected, _ = peak_of((2 * Disc(0.02, 0.012).factor() * RUBBER).complex_stiffness, 0.4)
        assert drawn == pytest.approx(expected, rel=0.01)
        light, _ = peak_of((2 * Disc(0.02, 0.012).factor() * RUBBER).complex_stiffness, 0.15)
        heard = self.peak(dma, "--resonance", f"{light}Hz", "--resonance-mass", "150g", *mass)
        assert heard == pytest.approx(expected, rel=0.01)

    def test_predict_states_first_that_a_peak_is_outside_the_sweep(self, dma):
        words = ["predict", dma, "--mass", "10g", "--resonance-mass", "10g", "--base"]
        # the sweep ended before its plateau: within it that comes first
        for hz, first in (("900Hz", "plateau_determined"), ("1100Hz", "prediction_in_valid_band")):
            requested = [*words, "--resonance", hz, "--band", "100:2000Hz"]
            verdict = run_json(*requested)["verdict"]
            assert verdict["failed_checks"][0] == first
            assert ("prediction_in_valid_band" in verdict["failed_checks"]) == (hz == "1100Hz")
            grade, message = verdict["verdict_grade"].capitalize(), verdict["message"]
            first_line = f"{grade}: {message[0].lower()}{message[1:50]}"
            assert ran(*requested).stdout.startswith(first_line)
        assert verdict["failed_checks"][0] == "prediction_in_valid_band"

    @pytest.mark.parametrize(
        ("words", "message"),
        [
            (["--shape", "disc:20mm,12mm", "--resonance", "60Hz"], "both give the geometry"),
            (["--shape", "disc:20mm"], "has one length; expected 2"),
            (["--resonance", "60Hz"], "needs the mass"),
            (["--lubricated"], "belong to a --shape"),
            (["--shape", "disc:20mm,12mm", "--resonance-mass", "1kg"], "belongs to a --resonance"),
            (["--shape", "bush:12mm,30mm,40mm", "--loading", "shear"], "expected one of axial"),
            ([], "in Pa"),
        ],
    )
    def test_a_geometry_that_is_none(self, dma, words, message):
        refused = ran("predict", dma, "--mass", "400g", *words)
        assert refused.exit_code == 2, refused.output
        assert message in refused.stderr


def test_material_part_accepts_a_shape_in_words():
    f = np.geomspace(0.1, 100, 30)
    E = dp.GeneralizedMaxwell(1e6, k=(4e5,), tau=(0.02,)).complex_stiffness(frequency=f)
    material = dp.fit(dp.DynamicTest(f, E.real, E.imag, units="Hz, Pa, Pa"), arms=1)
    assert material.part("disc:20mm,10mm").solid == material.part(Disc("20mm", "10mm")).solid
    for words, message in (("disk:1mm,1mm", "is no shape"), ("disc:1mm", "expected 2: diameter")):
        with pytest.raises(DataError, match=message):
            material.part(words)
