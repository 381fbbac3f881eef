"""Random base excitation of a mass on seals, and its limits."""

import json
import re

import numpy as np
import pytest
from kit.shell import ran, run_json

import dashpot as dp
from dashpot.base.errors import DashpotError, DataError
from dashpot.extensions.systems.base_response import (
    random_base,
    random_limits,
    random_response,
)
from dashpot.extensions.systems.multibody import Body, Mount, Point, System, point_mass
from dashpot.extensions.systems.read_psd import read_psd
from dashpot.reading.write import write_relaxation
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids import networks as net
from dashpot.solids.demo_seals import BROAD, BROAD_MASS, PAPER, PAPER_MASS

pytestmark = pytest.mark.once


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    """A seal's relaxation test and its fit, as files."""
    folder = tmp_path_factory.mktemp("bench")
    seal, fit = folder / "seal.csv", folder / "fit.json"
    assert ran("simulate", "relaxation", "-o", seal).exit_code == 0
    assert ran("fit", seal, "-o", fit).exit_code == 0
    return seal, fit


class TestRandomBase:
    def test_white_noise_of_the_papers_seals(self):
        result = random_base(2 * PAPER, mass=PAPER_MASS, psd=1.0)
        assert result.acceleration == pytest.approx(47.448949, rel=1e-7)
        assert 1e3 * result.stretch == pytest.approx(7.441384, rel=1e-6)
        assert result.crossings == pytest.approx(12.71, rel=1e-3)

    @pytest.mark.parametrize("zeta", [0.01, 0.3])
    def test_white_noise_through_a_dashpot_is_that_of_miles(self, zeta):
        r"""Crandall & Mark: :math:`\sigma_a^2 = \pi f_n S (1 + 4\zeta^2) / 4\zeta`."""
        m, f, S = 0.2, 15.0, 0.3
        w = 2 * np.pi * f
        result = random_base(dp.GeneralizedMaxwell(m * w**2, b=2 * zeta * m * w), mass=m, psd=S)
        exact = np.pi * f * S * (1 + 4 * zeta**2) / (4 * zeta)
        assert result.acceleration == pytest.approx(np.sqrt(exact), rel=1e-9)
        assert result.crossings == pytest.approx(f, rel=1e-9)

    @pytest.mark.parametrize(
        "solid", [2 * BROAD, dp.solids.FractionalZener(200.0, 800.0, 0.05, 0.5)]
    )
    def test_a_table_that_is_wide_and_flat_is_white(self, solid):
        """Arms of a fractional element reach from nanoseconds to years."""
        white = random_base(solid, mass=BROAD_MASS, psd=0.3)
        wide = random_base(solid, mass=BROAD_MASS, psd=[0.3, 0.3], frequency=[1e-3, 1e5])
        assert wide.acceleration == pytest.approx(white.acceleration, rel=1e-4)
        assert wide.stretch == pytest.approx(white.stretch, rel=1e-4)

    def test_a_narrow_table_is_a_tone(self):
        f, S, width = 9.0, 2.0, 1e-4
        result = random_base(2 * PAPER, mass=PAPER_MASS, psd=[S, S], frequency=[f, f + width])
        T = dp.systems.predict_frf(
            2 * PAPER, mass=PAPER_MASS, frequency=[f], kind="transmissibility"
        ).value[0]
        assert result.acceleration == pytest.approx(abs(T) * np.sqrt(S * width), rel=1e-4)
        assert result.crossings == pytest.approx(f, rel=1e-4)

    @pytest.mark.parametrize(
        ("solid", "words"),
        [
            (PAPER, {"psd": -1.0}),
            (PAPER, {"psd": [1.0, 1.0], "frequency": [0.0, 1.0]}),
            (PAPER, {"psd": [1.0, -1.0], "frequency": [1.0, 2.0]}),
            (dp.GeneralizedMaxwell(0.0, (1.0,), (1.0,)), {"psd": 1.0}),
        ],
    )
    def test_noise_that_has_no_answer(self, solid, words):
        with pytest.raises(DataError):
            random_base(solid, mass=0.1, **words)

    def test_a_march_in_time_says_the_same(self):
        """Every 0.05 Hz a sine of the table's density at a chance phase; arms exact for ramps."""
        from scipy.signal import cont2discrete, lfilter, ss2tf

        solid, mass, df, rate = 2 * BROAD, BROAD_MASS, 0.05, 800.0
        ends, S = np.array([5.0, 20.0, 60.0]), np.array([0.4, 2.0, 0.1])
        n = round(rate / df)
        f = np.arange(1, n // 2) * df
        density = np.exp(np.interp(np.log(f), np.log(ends), np.log(S)))
        density[(f < ends[0]) | (f > ends[-1])] = 0
        turn = np.exp(2j * np.pi * np.random.default_rng(5).random(len(f)))
        lines = np.concatenate(([0], n * np.sqrt(density * df / 2) * turn, [0]))
        base = np.tile(np.fft.irfft(lines, n), 3)
        k, tau = np.array(solid.k), np.array(solid.tau)
        A = np.zeros((2 + len(k), 2 + len(k)))
        A[0, 1] = A[2:, 1] = 1
        A[1] = [-solid.k_inf / mass, 0, *(-k / mass)]
        A[2:, 2:] = -np.diag(1 / tau)
        push = np.zeros((len(A), 1))
        push[1] = -1
        out = np.array([[1.0, *np.zeros(len(A) - 1)], A[1]])
        a, b, c, d, _ = cont2discrete((A, push, out, np.zeros((2, 1))), 1 / rate, method="foh")
        tops, bottom = ss2tf(a, b, c, d)
        stretch, sensed = (lfilter(top, bottom, base)[-n:].std() for top in tops)
        result = random_base(solid, mass=mass, psd=S, frequency=ends)
        assert sensed == pytest.approx(result.acceleration, rel=5e-3)
        assert stretch == pytest.approx(result.stretch, rel=5e-3)

    @pytest.mark.parametrize("mounts", [0.0, 2e-3])
    def test_a_table_is_the_integral_of_the_transmissibility(self, mounts):
        from scipy.integrate import quad

        ends, S = [4.0, 40.0], [1.0, 0.01]
        moving = BROAD_MASS + mounts / 3

        def compute_carried_psd(f):
            w2 = (2 * np.pi * f) ** 2
            K = complex((2 * BROAD).complex_stiffness(omega=np.array([2 * np.pi * f]))[0])
            T = (K + w2 * mounts / 6) / (K - w2 * moving)
            return abs(T) ** 2 * (f / 4) ** -2

        words = {"limit": 500, "points": [12.2, 12.6, 13.0], "epsrel": 1e-9}
        exact = np.sqrt(quad(compute_carried_psd, *ends, **words)[0])
        result = random_base(2 * BROAD, mass=moving, psd=S, frequency=ends, coupled=mounts / 6)
        assert result.acceleration == pytest.approx(exact, rel=1e-5)

    @pytest.mark.parametrize(
        ("unit", "scale"),
        [
            ("g^2/Hz", 9.80665**2),
            ("g2/Hz", 9.80665**2),
            ("g²/Hz", 9.80665**2),
            ("(m/s^2)^2/Hz", 1.0),
            ("(m/s²)²/Hz", 1.0),
            ("m^2/s^3", 1.0),
            ("(mm/s^2)^2/Hz", 1e-6),
        ],
    )
    def test_the_command_line_shakes_the_base(self, tmp_path, unit, scale):
        fit, psd = tmp_path / "fit.json", tmp_path / "psd.csv"
        arms = [{"k": k, "tau": t} for k, t in zip(PAPER.k, PAPER.tau, strict=True)]
        model = {"k_inf": PAPER.k_inf, "arms": arms}
        fit.write_text(json.dumps({"schema": "dashpot/fit@2", "model": model}))
        psd.write_text(f"frequency [Hz],PSD [{unit}]\n5,0.01\n20,0.04\n200,0.001\n")
        words = ["predict", str(fit), "--mass", f"{1e3 * PAPER_MASS}g", "--seals", "2"]
        message = run_json(*words, "--base-psd", psd)["random"]
        table = scale * np.array([0.01, 0.04, 0.001])
        expected = random_base(2 * PAPER, mass=PAPER_MASS, psd=table, frequency=[5.0, 20.0, 200.0])
        assert message["acceleration"] == pytest.approx(expected.acceleration, rel=1e-9)
        assert message["band_hz"] == [5.0, 200.0]
        white = ran(*words, "--base-psd", f"1{unit}")
        flat = random_base(2 * PAPER, mass=PAPER_MASS, psd=scale)
        assert f"the mass has {flat.acceleration:.4g} m/s^2 rms" in " ".join(white.output.split())

    @pytest.mark.parametrize("ends", [(5.0, 60.0), (30.0, 300.0)])
    @pytest.mark.parametrize("seed", [1, 2])
    def test_the_limits_hold_what_the_test_cannot_see(self, tmp_path, seed, ends):
        """An arm of 2 ms, unseen: the shaken mass feels a third at its peak, more above it."""
        seal = dp.GeneralizedMaxwell(
            PAPER.k_inf, (*PAPER.k, PAPER.k_inf), (*PAPER.tau, 2e-3), PAPER.b
        )
        record, fit, psd = (tmp_path / name for name in ("seal.csv", "fit.json", "psd.csv"))
        # a machine that nobody named may hide twice as much
        machine = ["--machine", "sync=1ms,compliance=0um/N,drift=20uN/s"]
        write_relaxation(simulate_relaxation(seal, seed=seed).test, record)
        assert ran("fit", record, "-o", fit, "--overwrite", *machine).exit_code == 0
        on = ["predict", fit, "--mass", f"{1e3 * PAPER_MASS}g", "--seals", "2"]
        psd.write_text("f [Hz],S [m^2/s^3]\n" + "".join(f"{f},1\n" for f in ends))
        words = [*on, "--base-psd", psd]
        single = run_json(*words)["random"]
        message = run_json(*words, "--record", record, *machine)["random"]
        limits = message.pop("limits")
        assert message == single
        assert limits.pop("band_hz") == list(ends)
        truth = random_base(2 * seal, mass=PAPER_MASS, psd=[1.0, 1.0], frequency=ends)
        for name, (low, high) in limits.items():
            assert low < getattr(truth, name) < high < 10 * low
            assert low <= message[name] <= high
        # the point alone is wrong: too much where it resonates, too little above
        assert (message["acceleration"] > truth.acceleration) == (ends[0] < 12)
        assert abs(message["acceleration"] / truth.acceleration - 1) > 0.1

    def test_predict_states_which_part_of_white_noise_has_limits(self, bench):
        seal, fit = bench
        words = ["predict", str(fit), "--mass", "114.8g", "--seals", "2", "--record", seal]
        heard = ran(*words, "--base-psd", "1m^2/s^3").output
        message = (
            r"limits these to [\d.]+ to [\d.]+ m/s\^2 and [\d.]+ to [\d.]+ mm rms, to the noise"
        )
        assert re.search(message, " ".join(heard.split()))

    @pytest.mark.parametrize("coupled", [0.0, 3e-3])
    def test_limits_without_width_are_the_value(self, coupled):
        """The lines of limits lie apart; what stands between them is within their straight line."""
        table = {"psd": [1.0, 0.2], "frequency": [5.0, 60.0]}
        on = {"mass": BROAD_MASS, "coupled": coupled}

        def compute_limits(f, kind):
            w = 2 * np.pi * f
            K = 2 * BROAD.complex_stiffness(omega=w)
            top = K + coupled * w**2 if kind == "transmissibility" else w**2
            return np.abs(np.array([top, top]) / (K - BROAD_MASS * w**2))

        value = random_base(2 * BROAD, **on, **table)
        limits = random_limits(2 * BROAD, compute_limits, **on, **table)
        for name in ("acceleration", "stretch"):
            low, high = getattr(limits, name)
            assert low <= getattr(value, name) <= high
            assert high == pytest.approx(low, rel=1e-3)

    def test_a_line_that_nothing_limits_leaves_no_limit_where_the_base_shakes(self):
        def compute_limits(f, kind):
            return np.array([0 * f, np.where(f > 20, np.inf, 1e3)])

        on = {"mass": BROAD_MASS, "frequency": [5.0, 10.0, 10.001, 60.0]}
        still = random_limits(2 * BROAD, compute_limits, psd=[1.0, 1.0, 0.0, 0.0], **on)
        assert still.acceleration[1] == pytest.approx(1e3 * np.sqrt(5), rel=1e-2)
        shaken = random_limits(2 * BROAD, compute_limits, psd=[1.0] * 4, **on)
        assert shaken.acceleration == (0.0, np.inf)
        assert shaken.stretch == (0.0, np.inf)

    @pytest.mark.parametrize(
        ("header", "message"),
        [
            ("frequency [Hz],PSD [g/Hz]", "expected a density in g^2/Hz"),
            ("frequency [Hz],PSD", "has no unit"),
            ("frequency [Hz],PSD [mm^2/Hz]", "expected a density in g^2/Hz"),
            ("frequency [Hz],x [g^2/Hz],y [g^2/Hz]", "2 columns beside the frequency"),
        ],
    )
    def test_a_density_of_another_kind_is_refused(self, tmp_path, header, message):
        psd = tmp_path / "psd.csv"
        more = ",1" * (header.count(",") - 1)
        psd.write_text(f"{header}\n5,0.01{more}\n20,0.04{more}\n200,0.001{more}\n")
        with pytest.raises(DashpotError, match=re.escape(message)):
            read_psd(psd)

    def test_words_that_are_no_density_are_refused(self):
        for word in ("0.01", "0.01g", "0.01g^2", "no-such-file.csv", "1 m/Hz"):
            with pytest.raises(DashpotError):
                read_psd(word)


def rocking(*, free: tuple[str, ...] = ("x", "y", "rz")) -> System:
    body = Body("block", 5.0, (0.0, 0.0, 0.02), free=free)
    return System(
        (body, point_mass("rider", 0.5)),
        (
            Mount(100 * BROAD, ("block", "ground"), (-0.1, 0.0, 0.0), (0.0, 1.0, 0.0)),
            Mount(60 * BROAD, ("block", "ground"), (0.1, 0.0, 0.0), (0.0, 1.0, 0.0)),
            Mount(net.kelvin_voigt(3e4, 20.0), ("block", "ground"), (0, 0.02, 0), (1.0, 0.0, 0.0)),
            Mount(net.spring(1e3), ("rider", "ground")),
        ),
    )


@pytest.mark.parametrize("along", [(0.0, 1.0, 0.0), (1.0, 1.0, 0.0)])
def test_white_noise_and_a_wide_table_agree(along):
    """The Lyapunov equation and the integral over lines, which know nothing of each other."""
    place = Point("block", (0.1, 0.0, 0.0), (0.0, 1.0, 0.0))
    white = random_response(rocking(), response=place, psd=0.5, along=along)
    wide = random_response(
        rocking(), response=place, psd=[0.5, 0.5], frequency=[1e-4, 1e6], along=along
    )
    assert white.acceleration == pytest.approx(wide.acceleration, rel=2e-4)
    assert white.stretch == pytest.approx(wide.stretch, rel=2e-4)
    assert white.crossings == pytest.approx(wide.crossings, rel=2e-4)


def test_what_cannot_follow_its_base_is_refused():
    with pytest.raises(DataError, match="held in a motion in which 'ground' shakes"):
        random_response(
            rocking(free=("y", "rz")), response="block.y", psd=1.0, along=(1.0, 0.0, 0.0)
        )
    with pytest.raises(DataError, match=r"nothing damps a motion that it shakes, at 7\.118 Hz"):
        random_response(rocking(), response="block.y", psd=1.0)
    with pytest.raises(DataError, match="'earth' is no ground"):
        random_response(rocking(), response="block.y", psd=1.0, base="earth")
