"""The same simulated hammer hits, by dashpot and by its peers: errors of both against the truth.

    pip install pyFRF sdypy-EMA && python benchmarks/frf_peers.py [HITS.lvm]

A record of real hits with a force F and two accelerometers m_1 and m_2 is analysed by both if it is
given; nobody knows its truth, so the two are held against each other.

FRF error: root mean square of |H / H_true - 1| over 5 to 40 Hz. Each is held against the truth
of what it claims to give: pyFRF and SciPy against H(j omega), dashpot with an exponential window
against H(j omega + a), since it says that its FRF is there. Missing peers are passed over.
"""

from __future__ import annotations

import contextlib
import io
import sys
import warnings
from collections.abc import Callable
from dataclasses import replace
from importlib.util import find_spec

import numpy as np

from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.simulation.impact import Hammer, simulate_impact
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.vibration.impact.spectral_estimators import Spectra, estimate
from dashpot.vibration.mass_on_seals import model_modes, predict_frf

PAPER = GeneralizedMaxwell(196.5, (117.5, 17.8), (59.0 / 117.5, 292.2 / 17.8))
BROAD = PAPER + GeneralizedMaxwell(0.0, (20.0, 20.0, 20.0), (0.08, 0.016, 0.0032))
SEALS = {"paper": (PAPER, 0.1040426), "broad": (BROAD, 0.114829829)}
RATE = 2048
HITS = 5
LOW, HIGH = 5.0, 40.0
HAVE_PYFRF = find_spec("pyFRF") is not None
HAVE_EMA = find_spec("sdypy") is not None and find_spec("sdypy.EMA") is not None


def hits(name: str, record: float) -> tuple[ImpactTest, np.ndarray, np.ndarray]:
    """Five hits on the middle of the block; as one test, and as arrays with a row per hit."""
    seal, mass = SEALS[name]
    rig = replace(Hammer(), record=record, eccentricity=0.0)
    test = simulate_impact(seal, mass=mass, hits=HITS, rig=rig, seed=1).test
    mean = test.acceleration.mean(axis=0)
    return test, test.force.reshape(HITS, -1), mean.reshape(HITS, -1)


def without_offset(rows: np.ndarray) -> np.ndarray:
    """What a careful user of a peer does: take the mean of the 0.1 s before each hit off."""
    return rows - rows[:, :200].mean(axis=1, keepdims=True)


def frf_error(name: str, frequency: np.ndarray, value: np.ndarray, shift: float = 0.0) -> str:
    seal, mass = SEALS[name]
    near = (frequency >= LOW) & (frequency <= HIGH)
    true = predict_frf(2 * seal, mass=mass, frequency=frequency[near], shift=shift).value
    return f"{100 * np.sqrt(np.mean(np.abs(value[near] / true - 1) ** 2)):10.3g} %"


def mode_error(name: str, frequency: float, damping_ratio: float) -> str:
    seal, mass = SEALS[name]
    (true,) = model_modes(2 * seal, mass)
    return (
        f"{100 * (frequency / true.frequency - 1):+10.4f} %"
        f"{100 * (damping_ratio / true.damping_ratio - 1):+10.2f} %"
    )


def quietly(call: Callable[[], object]) -> object:
    """Peers print and warn."""
    hush = io.StringIO()
    with (
        contextlib.redirect_stdout(hush),
        contextlib.redirect_stderr(hush),
        warnings.catch_warnings(),
    ):
        warnings.simplefilter("ignore")
        return call()


def pyfrf(force: np.ndarray, response: np.ndarray, window: object, kind: str = "H1"):
    """FRF of pyFRF as accelerance, and the object it came from."""
    from pyFRF import FRF

    def run() -> tuple[np.ndarray, np.ndarray, object]:
        frf = FRF(RATE, window=window, frf_estimator=kind, fft_len=force.shape[1], units="SI")
        for values, item in zip(force, response, strict=True):
            frf.add_data(values.copy(), item.copy())
        value = frf.get_FRF(frf_form="accelerance")
        return frf.get_f_axis(), np.nan_to_num(np.squeeze(value)), frf  # nan at 0 Hz

    return quietly(run)


def scipy_default(force: np.ndarray, response: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """csd over welch as their defaults are, one segment per hit: a Hann window."""
    from scipy.signal import csd, welch

    n = force.shape[1]
    f, cross = csd(force.ravel(), response.ravel(), RATE, nperseg=n, noverlap=0)
    _, power = welch(force.ravel(), RATE, nperseg=n, noverlap=0)
    return f, cross / power


def poles_by_ema(frequency: np.ndarray, value: np.ndarray) -> tuple[float, float]:
    """The pole that sdypy-EMA's LSCF finds next to the truth: the user's best pick."""
    from sdypy import EMA

    def run() -> tuple[float, float]:
        keep = frequency <= 80
        model = EMA.Model(
            frf=value[None, keep],
            freq=frequency[keep],
            lower=3,
            upper=60,
            pol_order_high=20,
            frf_form="accelerance",
        )
        model.get_poles(show_progress=False)
        poles = np.concatenate([np.atleast_1d(row) for row in model.all_poles])
        poles = poles[(poles.imag > 0) & (poles.real < 0)]
        best = poles[np.argmin(np.abs(poles.imag / (2 * np.pi) - 12.7))]
        return abs(best) / (2 * np.pi), -best.real / abs(best)

    return quietly(run)


def half_power(frequency: np.ndarray, value: np.ndarray) -> tuple[float, float]:
    """Highest line and the width at 0.707 of it, by straight lines."""
    near = (frequency > LOW) & (frequency < HIGH)
    f, size = frequency[near], np.abs(value[near])
    top = int(np.argmax(size))
    level = size[top] / np.sqrt(2)
    interpolated = np.interp(level, size[: top + 1], f[: top + 1])
    right = np.interp(-level, -size[top:], f[top:])
    return f[top], (right - interpolated) / (2 * f[top])


def frfs() -> None:
    print(f"{'seal':6s} {'record':>7s}  {'by':42s}{'FRF':>12s}{'f_n':>12s}{'damping':>12s}")
    for name in SEALS:
        for record in (2.0, 8.0, 20.0):
            test, force, response = hits(name, record)
            force, response = without_offset(force), without_offset(response)
            for window in ("none", "exponential:0.01"):
                frf = estimate_frf(test, window=window)
                mode = frf.modes()[0]
                show(
                    name, record, f"dashpot, {window}",
                    frf_error(name, frf.frequency, frf.value, frf.shift),
                    mode_error(name, mode.frequency, mode.damping_ratio),
                )  # fmt: skip
            if HAVE_PYFRF:
                for window in ("none", ("exponential:0.01", "exponential:0.01"),
                               (f"force:{0.2 / record:.3f}", "exponential:0.01")):  # fmt: skip
                    f, value, _ = pyfrf(force, response, window)
                    label = window if isinstance(window, str) else "+".join(
                        word.split(":")[0] for word in window
                    )  # fmt: skip
                    show(
                        name, record, f"pyFRF, {label}; half power",
                        frf_error(name, f, value), mode_error(name, *half_power(f, value)),
                    )  # fmt: skip
                    if HAVE_EMA and window == "none":
                        show(
                            name, record, "pyFRF, none; sdypy-EMA LSCF",
                            " " * 12, mode_error(name, *poles_by_ema(f, value)),
                        )  # fmt: skip
            f, value = scipy_default(force, response)
            show(
                name, record, "scipy csd/welch default (Hann)",
                frf_error(name, f, value), mode_error(name, *half_power(f, value)),
            )  # fmt: skip
            print()


def show(name: str, record: float, by: str, frf: str, mode: str) -> None:
    print(f"{name:6s} {record:5.0f} s  {by:42s}{frf}{mode}")


def offsets() -> None:
    print("\nAn offset of 1 % of the peak on both channels, exponential window, broad seal, 8 s:")
    test, force, response = hits("broad", 8.0)
    raised = replace(
        test,
        force=test.force + 0.01 * np.abs(test.force).max(),
        acceleration=test.acceleration + 0.01 * np.abs(test.acceleration).max(),
    )
    frf = estimate_frf(raised, window="exponential:0.01")
    print(f"  dashpot{frf_error('broad', frf.frequency, frf.value, frf.shift)}")
    if HAVE_PYFRF:
        force, response = without_offset(force), without_offset(response)
        f, value, _ = pyfrf(
            force + 0.01 * np.abs(force).max(),
            response + 0.01 * np.abs(response).max(),
            ("exponential:0.01", "exponential:0.01"),
        )
        print(f"  pyFRF  {frf_error('broad', f, value)}")


def units() -> None:
    print("\nHv of the same hits in N and in kN, largest relative difference from 5 to 40 Hz:")
    test, force, response = hits("broad", 8.0)
    plain = estimate_frf(test, estimator="Hv")
    scaled = estimate_frf(replace(test, force=test.force / 1000), estimator="Hv")
    near = (plain.frequency >= LOW) & (plain.frequency <= HIGH)
    print(f"  dashpot {np.abs(scaled.value / plain.value / 1000 - 1)[near].max():.1e}")
    if HAVE_PYFRF:
        f, value, _ = pyfrf(force, response, "none", "Hv")
        _, other, _ = pyfrf(force / 1000, response, "none", "Hv")
        near = (f >= LOW) & (f <= HIGH)
        print(f"  pyFRF   {np.abs(other[near] / value[near] / 1000 - 1).max():.1e}")


def verdicts() -> None:
    print("\nHits called bad, of 5 clean ones and of 5 double ones (40 % after 60 ms):")
    for double in (False, True):
        rig = replace(Hammer(), record=8.0, double_hits=tuple(range(HITS)) if double else ())
        test = simulate_impact(BROAD, mass=SEALS["broad"][1], hits=HITS, rig=rig, seed=1).test
        names = [str(i + 1) for i in range(HITS)]
        bad = sum(
            any("double" in reason for reason in hit.reasons)
            for hit in estimate_frf(test, accept=names).hits
        )
        line = f"  {'double' if double else 'clean':8s}dashpot {bad}"
        if HAVE_PYFRF:
            from pyFRF import FRF

            judge = FRF(RATE, fft_len=test.force.size // HITS, units="SI")
            force = without_offset(test.force.reshape(HITS, -1))
            response = without_offset(test.acceleration[0].reshape(HITS, -1))
            bad = sum(
                not quietly(
                    lambda f=f, a=a, judge=judge: judge.is_data_ok(f[None, None], a[None, None])
                )
                for f, a in zip(force, response, strict=True)
            )
            line += f"   pyFRF {bad}"
        print(line)


def single_hit() -> None:
    print("\nCoherence of a single hit with a response of nothing but noise:")
    random = np.random.default_rng(0)
    test, force, _ = hits("broad", 8.0)
    noise = random.standard_normal(force.shape[1])
    item = ImpactTest(test.time[: force.shape[1]], force[0], noise[None], units="SI")
    print(f"  dashpot {estimate_frf(item).coherence}")
    if HAVE_PYFRF:
        _, _, frf = pyfrf(force[:1], noise[None], "none")
        print(f"  pyFRF   {float(np.nanmean(quietly(frf.get_coherence).real)):.3f}")


def estimators() -> None:
    print("\nNoise on both channels (10 % of the force line, 10 % of the response line), 200 hits:")
    random = np.random.default_rng(0)
    f = np.linspace(LOW, HIGH, 300)
    true = predict_frf(2 * BROAD, mass=SEALS["broad"][1], frequency=f).value
    force = random.uniform(1, 3, (200, 1)) * np.ones((200, 300), complex)
    size = 2 * np.abs(true).mean()

    def noise(level: float) -> np.ndarray:
        return level * (
            random.standard_normal((200, 300)) + 1j * random.standard_normal((200, 300))
        )

    spectra = Spectra(f, force + noise(0.2), true * force + noise(0.1 * size), (0.2, 0.1 * size))
    for kind in ("H1", "H2", "Hv", "Hs"):
        ratio = np.abs(estimate(spectra, kind) / true)
        print(f"  dashpot {kind}  median bias {100 * (np.median(ratio) - 1):+7.2f} %")


if __name__ == "__main__":
    import modal_peers

    for peer, have in (("pyFRF", HAVE_PYFRF), ("sdypy-EMA", HAVE_EMA)):
        if not have:
            print(f"{peer} is not installed: pip install {peer}")
    frfs()
    offsets()
    units()
    verdicts()
    single_hit()
    estimators()
    modal_peers.shapes()
    for given in sys.argv[1:]:
        modal_peers.real_hits(given)
