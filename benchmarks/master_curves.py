"""Master curves and known relaxation spectra, ours beside whatever peers are installed.

Run: OMP_NUM_THREADS=1 python benchmarks/master_curves.py [FOLDER OF REAL MEASUREMENTS]

Without a folder the measurements are those of tests/data.

The norm: root mean square, and largest, of model/data - 1, over every value of E(t), or of E' and
E'' alike. Terms without an instantaneous modulus get the one that serves them best on this norm.
Times are medians of thread CPU milliseconds. Peers: pyvisco, mastercurves and lmfit if they can be
imported (pip install pyvisco mastercurves lmfit, in an environment of its own);
the terms that a commercial FE code found for the same data, and the answers that pyReSpect's own
tests state, come with the data.
"""

from __future__ import annotations

import contextlib
import io
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from dashpot.datamodel.shift_factors import Shift
from dashpot.extensions.curves.checks import kramers_kronig
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.datamodel.modulus import RelaxationModulus
from dashpot.extensions.curves.dynamic.fit import fit_dynamic
from dashpot.extensions.curves.dynamic.read import read_dynamic
from dashpot.extensions.curves.modulus.fit import fit_modulus
from dashpot.extensions.curves.modulus.read import read_modulus
from dashpot.extensions.curves.relaxation_spectrum import (
    compute_passive_misfit,
    dynamic_master_curve,
    master_curve,
)
from dashpot.extensions.curves.superposition.read_shift_factors import read_shifts
from dashpot.extensions.curves.superposition.superpose import superpose
from dashpot.reading.read_options import ReadOptions
from dashpot.solids.demo_seals import BROAD
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.shift_laws import WLF

DEFAULT = Path(__file__).resolve().parents[1] / "tests" / "data"


def measure_time(work: Callable[[], Any], repeats: int = 9) -> tuple[Any, float]:
    """The result, and the median thread CPU time in ms."""
    spent = []
    for _ in range(repeats):
        start = time.thread_time()
        result = work()
        spent.append(1e3 * (time.thread_time() - start))
    return result, float(np.median(spent))


def quiet(work: Callable[[], Any]) -> Any:
    with contextlib.redirect_stdout(io.StringIO()):
        return work()


def terms_of(file: Path) -> np.ndarray:
    """Pairs of relative modulus and relaxation time out of TBDATA lines."""
    lines = [line for line in file.read_text().splitlines() if line.startswith("TBDATA")]
    return np.array([float(word) for line in lines for word in line.split(",")[2:]]).reshape(-1, 2)


def prony_time(t: np.ndarray, terms: np.ndarray) -> np.ndarray:
    g, tau = terms.T
    return 1 - g.sum() + np.exp(-t[:, None] / tau) @ g


def prony_frequency(omega: np.ndarray, terms: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    g, tau = terms.T
    x = omega[:, None] * tau
    return 1 - g.sum() + (x * x / (1 + x * x)) @ g, (x / (1 + x * x)) @ g


def percent(error: np.ndarray) -> str:
    rms, largest = np.sqrt(np.mean(error**2)), np.abs(error).max()
    return f"{100 * rms:8.3f} {100 * largest:8.2f}"


# -- relaxation over 31 decades -------------------------------------------------------------------


def over_time(folder: Path) -> None:
    t, modulus = np.loadtxt(folder / "time_user_master.csv", delimiter=",", skiprows=2, unpack=True)
    print(f"\nE(t), {len(t)} values over {np.log10(t[-1] / t[0]):.0f} decades")
    print(f"{'':34s} arms   rms %   max %      ms")
    ours = {}
    for per_decade in (1, 2, 4):
        result, spent = measure_time(lambda n=per_decade: master_curve(t, modulus, per_decade=n))
        error = result.model.relaxation(t) / modulus - 1
        ours[per_decade] = spent
        name = f"dashpot, {per_decade} per decade"
        print(f"{name:34s} {result.model.arms:4d}{percent(error)} {spent:9.2f}")
    table = np.loadtxt(folder / "ansys-reference" / "prony_terms_KPf_MD.csv", delimiter=",")
    error = 1739.03 * prony_time(t, table) / modulus - 1
    print(f"{'commercial FE code':34s} {len(table):4d}{percent(error)}")
    theirs = pyvisco_terms(folder / "time_user_master.csv", "time")
    if theirs is not None:
        e_0, terms, spent = theirs
        error = e_0 * prony_time(t, terms) / modulus - 1
        ratio = spent / ours[4]
        print(f"{'pyvisco':34s} {len(terms):4d}{percent(error)} {spent:9.2f}  ({ratio:.0f}x ours)")


# -- storage and loss over 26 decades -------------------------------------------------------------


def over_frequency(folder: Path) -> None:
    data = read_dynamic(folder / "freq_user_master.csv")
    print(f"\nE', E'', {len(data.frequency)} frequencies; E' at the lowest is "
          f"{1e-6 * data.storage[0]:.1f} MPa")  # fmt: skip
    print(f"{'':34s} arms   rms %   max %  | E' rms, max %  |  E'' rms, max %  | E'(f_min)     ms")
    ours = 0.0
    for per_decade in (1, 4):
        result, ours = measure_time(lambda n=per_decade: dynamic_master_curve(data, per_decade=n))
        value = result.model.complex_stiffness(omega=data.omega)
        row(f"dashpot, {per_decade} per decade", result.model.arms, data, value, ours)
    terms = terms_of(folder / "ansys-reference" / "freq_master.prony_terms.MPL")
    storage, loss = prony_frequency(data.omega, terms)
    ratio = np.concatenate((storage / data.storage, loss / data.loss))
    e_0 = ratio.sum() / (ratio @ ratio)
    row("commercial FE code, best E_0", len(terms), data, e_0 * (storage + 1j * loss))
    theirs = pyvisco_terms(folder / "freq_user_master.csv", "freq")
    if theirs is not None:
        e_0, terms, spent = theirs
        storage, loss = prony_frequency(data.omega, terms)
        row("pyvisco", len(terms), data, 1e6 * e_0 * (storage + 1j * loss), spent)
    print("  " + kramers_kronig(compute_passive_misfit(data)).message)


def row(
    name: str, arms: int, data: DynamicTest, value: np.ndarray, spent: float | None = None
) -> None:
    storage, loss = value.real / data.storage - 1, value.imag / data.loss - 1
    both = np.concatenate((storage, loss))
    lowest = 1e-6 * value.real[np.argmin(data.frequency)]
    cost = "" if spent is None else f"{spent:9.2f}"
    print(f"{name:34s} {arms:4d}{percent(both)}  |{percent(storage)}|{percent(loss)} "
          f"| {lowest:7.1f} {cost}")  # fmt: skip


def pyvisco_terms(file: Path, domain: str) -> tuple[float, np.ndarray, float] | None:
    """E_0, terms and CPU ms of pyvisco with its defaults; None if it is not installed."""
    try:
        from pyvisco import load, master, prony
    except ImportError:
        print("pyvisco                            (not installed)")
        return None
    curve, _ = load.user_master(load.file(str(file)), domain, 0, "E")
    curve = master.smooth(curve, 1)
    result, spent = measure_time(
        lambda: quiet(lambda: prony.fit(prony.discretize(curve), curve)), repeats=3
    )
    table = result[0]["df_terms"]
    return float(result[0]["E_0"]), table[["alpha_i", "tau_i"]].to_numpy(), spent


# -- known answers --------------------------------------------------------------------------------


def compare_exact_answers(folder: Path) -> None:
    print("\npyReSpect's tests, fewest arms (its stated answers in brackets)")
    stated = {
        "test1": "tau 5, 50",
        "test2": "g 1, 1, 1, 1 at tau 0.05, 0.5, 5, 50",
    }
    for name, answer in stated.items():
        t, modulus = np.loadtxt(folder / f"{name}.dat", unpack=True)
        result, spent = measure_time(lambda t=t, m=modulus: fit_modulus(t, m), repeats=3)
        print(
            f"{name}: {listed_terms(result.model)}  [{answer}]  "
            f"{result.status.name}, {spent:.0f} ms"
        )
        lmfit_modes(t, modulus, result.model)
    for name, plateau in (("test3", 0.0), ("test7", 10.0)):
        t, modulus = np.loadtxt(folder / f"{name}.dat", unpack=True)
        result, spent = measure_time(lambda t=t, m=modulus: master_curve(t, m))
        print(f"{name}: plateau {result.model.k_inf:.3f} [{plateau:g}], {result.model.arms} arms, "
              f"max error {result.max_error:.1e}, {spent:.1f} ms")  # fmt: skip


def lmfit_modes(t: np.ndarray, modulus: np.ndarray, model: GeneralizedMaxwell) -> None:
    """Residuals over the curve that dashpot found, in lmfit, told the number of arms.

    Over noisy values themselves low ones would count most. It starts from even relaxation times.
    """
    try:
        import lmfit
    except ImportError:
        print("  lmfit (not installed)")
        return
    size = model.relaxation(t)
    ours = float(np.square(modulus / size - 1).sum())
    start = lmfit.Parameters()
    start.add("g0", value=1e-3 * modulus.max(), min=0)
    for j, tau in enumerate(np.geomspace(t[0], t[-1], model.arms + 2)[1:-1]):
        start.add(f"g{j + 1}", value=modulus[0] / model.arms, min=0)
        start.add(f"ln_tau{j + 1}", value=np.log(tau))

    def residual(p: Any) -> np.ndarray:
        value = np.full(len(t), float(p["g0"]))
        for j in range(1, model.arms + 1):
            value = value + p[f"g{j}"] * np.exp(-t / np.exp(float(p[f"ln_tau{j}"])))
        return (value - modulus) / size

    result, spent = measure_time(lambda: lmfit.minimize(residual, start), repeats=3)
    tau = sorted(float(np.exp(result.params[f"ln_tau{j}"])) for j in range(1, model.arms + 1))
    times = ", ".join(f"{value:.5g}" for value in tau)
    print(f"  lmfit, told {model.arms} arms: tau {times}; "
          f"SSE {result.chisqr / ours:.3g} times ours, {spent:.0f} ms")  # fmt: skip


def listed_terms(model: GeneralizedMaxwell) -> str:
    pairs = zip(model.k, model.tau, strict=True)
    return ", ".join(f"g {k:.7g} at tau {tau:.7g}" for k, tau in pairs)


# -- shift factors --------------------------------------------------------------------------------


def shift_factors(folder: Path) -> None:
    """Of 21 published temperatures, and of nine simulated ones whose truth is known."""
    curve = read_modulus(folder / "time_user_raw.csv", options=ReadOptions(modulus="E_relax"))
    published = read_shifts(folder / "time_user_raw__shift_factors.csv")
    compare_shifts(
        "published moduli, 21 temperatures; a step against the published ones", curve, published
    )
    sweep = read_dynamic(folder / "freq_user_raw.csv")
    compare_shifts("published storage and loss, 21 temperatures; as above", sweep, published)


def simulated_shifts() -> None:
    reference, tau = 293.15, np.logspace(-8, 4, 49)
    share = np.exp(-0.5 * ((np.log10(tau) + 2) / 2) ** 2)
    h = 2e9 * share / share.sum()
    kelvin = reference + np.arange(-40.0, 41.0, 10.0)
    true = WLF(8.0, 110.0, reference).log10_a_t(kelvin)
    normal = np.random.default_rng(0).standard_normal
    t, f = np.geomspace(1.0, 100.0, 14), np.geomspace(0.1, 10.0, 14)
    decay = [3e6 + np.exp(-t[:, None] / (tau * 10**a)) @ h for a in true]
    z = [2j * np.pi * f[:, None] * tau * 10**a for a in true]
    value = np.concatenate([3e6 + (value / (1 + value)) @ h for value in z])
    value = value + 0.01 * np.abs(value) * (normal(len(value)) + 1j * normal(len(value)))
    warm = np.repeat(kelvin, 14)
    moduli = np.concatenate(decay) * (1 + 0.01 * normal(len(warm)))
    shifts = [Shift(k, a, 0.0) for k, a in zip(kelvin, true, strict=True)]
    curve = RelaxationModulus(np.tile(t, 9), moduli, temperature=warm, units="SI")
    compare_shifts(
        "simulated moduli, 9 temperatures, 1 % noise; a step against the truth", curve, shifts
    )
    data = DynamicTest(np.tile(f, 9), value.real, value.imag, warm, units="SI")
    compare_shifts("simulated storage and loss; as above", data, shifts)


def compare_shifts(title: str, data: DynamicTest | RelaxationModulus, expected: Any) -> None:
    """Shifts of each method: error of its steps, what they leave on one spectrum, time."""
    print(f"\n{title}\n{'':34s} rms, decades  largest  on one spectrum, rms %        ms")
    result, spent = measure_time(lambda: superpose(data), repeats=3)
    methods = [("known shifts", expected, None), ("dashpot", result.temperatures.shifts, spent)]
    tested = np.array([shift.temperature for shift in result.temperatures.shifts])
    for name, peer in (("pyvisco", pyvisco_shifts), ("mastercurves", mastercurves_shifts)):
        start = time.thread_time()
        try:
            log10 = quiet(lambda peer=peer: peer(data, tested))
        except ImportError:
            print(f"{name:34s} (not installed)")
            continue
        except RuntimeError as error:
            print(f"{name:34s} fails: {error}")
            continue
        spent = 1e3 * (time.thread_time() - start)
        theirs = [Shift(k, a, 0.0) for k, a in zip(tested, log10, strict=True)]
        methods.append((name, theirs, spent))
    truth = steps(expected, tested)
    for name, shifts, spent in methods:
        off = steps(shifts, tested) - truth
        rms = superpose(data, shifts=shifts).rms
        cost = "" if spent is None else f"{spent:9.0f}"
        print(f"{name:34s} {np.sqrt(np.mean(off**2)):12.3f} {np.abs(off).max():8.3f} "
              f"{100 * rms:21.3f}  {cost}")  # fmt: skip


def steps(shifts: Any, tested: np.ndarray) -> np.ndarray:
    """Differences of log10 a_T between neighbouring temperatures."""
    expected = np.array([shift.temperature for shift in shifts])
    nearest = [shifts[int(np.argmin(np.abs(expected - kelvin)))].log10_a_t for kelvin in tested]
    return np.diff(nearest)


def blocks(data: DynamicTest | RelaxationModulus, tested: np.ndarray) -> list[np.ndarray]:
    """Rows of time or frequency, modulus (and loss), of each temperature, rising."""
    nearest = np.argmin(np.abs(data.temperature[:, None] - tested), axis=1)
    names = (
        ("frequency", "storage", "loss") if isinstance(data, DynamicTest) else ("time", "modulus")
    )
    rows = np.column_stack([getattr(data, name) for name in names])
    parts = [rows[nearest == i] for i in range(len(tested))]
    return [part[np.argsort(part[:, 0])] for part in parts]


def pyvisco_shifts(data: DynamicTest | RelaxationModulus, tested: np.ndarray) -> np.ndarray:
    """Its sequential overlay of power laws, with its defaults."""
    from pyvisco import load, master

    of_time = isinstance(data, RelaxationModulus)
    head = "t,E_relax,T,Set\ns,MPa,C,-" if of_time else "f,E_stor,E_loss,T,Set\nHz,MPa,MPa,C,-"
    rows = []
    for number, (kelvin, part) in enumerate(zip(tested, blocks(data, tested), strict=True)):
        # its files list times from the longest, as frequencies rise
        for item in part[::-1] if of_time else part:
            rows.append([item[0], *(1e-6 * item[1:]), round(kelvin - 273.15), number])
    body = "\n".join(",".join(f"{value:.10g}" for value in row) for row in rows)
    domain = "time" if of_time else "freq"
    raw, temperatures = load.user_raw(f"{head}\n{body}\n".encode(), domain, "E")[:2]
    middle = float(temperatures.iloc[len(temperatures) // 2])
    return np.asarray(master.get_aT(raw, middle)[0]["log_aT"], dtype=float)


def mastercurves_shifts(data: DynamicTest | RelaxationModulus, tested: np.ndarray) -> np.ndarray:
    """Its Gaussian processes, pair by pair, a step of up to four decades; of sweeps the storage."""
    from mastercurves import MasterCurve
    from mastercurves.transforms import Multiply

    result = MasterCurve()
    parts = blocks(data, tested)
    x, y = ([np.log(part[:, j]) for part in parts] for j in (0, 1))
    result.add_data(x, y, list(tested))
    result.add_htransform(Multiply(bounds=(1e-4, 1e4)))
    result.superpose()
    factor = np.log10(np.array(result.hparams[0], dtype=float))
    return factor if isinstance(data, DynamicTest) else -factor


# -- a sweep and a hold together ------------------------------------------------------------------


def compare_joint_fits() -> None:
    from dashpot.datamodel.relaxation import RampHold
    from dashpot.fitting.relaxation import fit

    generator = np.random.default_rng(0)
    frequency = np.geomspace(1.0, 50.0, 30)
    value = BROAD.complex_stiffness(omega=2 * np.pi * frequency)
    item, two = 1 + 0.005 * generator.standard_normal((2, 30))
    data = DynamicTest(frequency, value.real * item, value.imag * two, unit="N/m", units="SI")
    t = np.arange(41_001) / 1000.0
    force = BROAD.ramp_hold_force(t, depth=8e-3, ramp_time=1.0)
    held = RampHold(
        t, 8e-3 * np.clip(t, 0, 1), force + 5e-3 * generator.standard_normal(len(t)),
        onset=0.0, ramp_end=1.0, hold_end=41.0, depth=8e-3, force_noise=5e-3,
    )  # fmt: skip
    omega = 2 * np.pi * np.geomspace(0.004, 50.0, 100)
    print("\nthe broad seal (5 arms): sweep 1-50 Hz with 0.5 %, and 1 s + 40 s at 1 kHz with 5 mN")
    for name, work in (
        ("sweep alone", lambda: fit_dynamic(data)),
        ("hold alone", lambda: fit(held)),
        ("together", lambda: fit_dynamic(data, tests=held)),
    ):
        result, spent = measure_time(work, repeats=3)
        error = result.model.loss(omega=omega) / BROAD.loss(omega=omega) - 1
        print(f"{name:34s} {result.model.arms:4d} arms, loss 0.004-50 Hz off by "
              f"{100 * np.abs(error).max():6.1f} % at most, {spent:.0f} ms")  # fmt: skip


def main() -> None:
    data = Path(sys.argv[1]) if len(sys.argv) > 1 else DEFAULT
    if data.is_dir():
        over_time(data / "pyvisco-master-curves")
        over_frequency(data / "pyvisco-master-curves")
        compare_exact_answers(data / "pyrespect-time-tests")
        shift_factors(data / "pyvisco-master-curves")
    else:
        print(f"no real measurements at {data}; give their folder as the first argument")
    simulated_shifts()
    compare_joint_fits()


if __name__ == "__main__":
    main()
