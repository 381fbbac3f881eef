"""Poles and shapes common to several points, by dashpot and by sdypy-EMA: part of frf_peers.py."""

from __future__ import annotations

from dataclasses import replace
from time import process_time
from typing import NamedTuple

import numpy as np
from frf_peers import HAVE_EMA, HAVE_PYFRF, quietly, without_offset

from dashpot.datamodel.frf import FRF
from dashpot.datamodel.structure import FRFSet, ModeShape
from dashpot.extensions.modes.stabilisation import stabilisation
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.impact import read_impact
from dashpot.vibration.impact.frf_estimation import estimate_frf
from dashpot.vibration.modal.pole_fit import mac

FOUR = {  # undamped natural frequency, Hz; damping ratio; mass, kg; shape
    "two modes": ((12.7, 0.02, 0.1, (1, 0.8, 0.5, -0.2)), (31.0, 0.04, 0.15, (1, -0.5, 0.3, 0.9))),
    "2 % apart": ((20.0, 0.01, 0.1, (1, 0.8, 0.5, -0.2)), (20.4, 0.01, 0.15, (1, -0.5, 0.3, 0.9))),
    "2 %, broad": ((20.0, 0.04, 0.1, (1, 0.8, 0.5, -0.2)), (20.4, 0.04, 0.15, (1, -0.5, 0.3, 0.9))),
    "0.5 %": ((20.0, 0.005, 0.1, (1, 0.8, 0.5, -0.2)), (37.0, 0.005, 0.15, (1, -0.5, 0.3, 0.9))),
    "30 %": ((20.0, 0.3, 0.1, (1, 0.8, 0.5, -0.2)), (47.0, 0.3, 0.15, (1, -0.5, 0.3, 0.9))),
    "at the end": ((20.0, 0.02, 0.1, (1, 0.8, 0.5, -0.2)), (78.0, 0.02, 0.1, (1, -0.5, 0.3, 0.9))),
}
BAND, DRAWS = (5.0, 79.0), 25


def four_points(name: str, seed: int) -> FRFSet:
    """Accelerances by their closed form with 2 % of scatter on each line."""
    f, rng = np.arange(1.0, 80.0, 0.1), np.random.default_rng(seed)
    s, frfs = 2j * np.pi * f, []
    for point in range(4):
        value = np.zeros(len(f), complex)
        for hz, ratio, mass, shape in FOUR[name]:
            p = 2 * np.pi * hz * complex(-ratio, np.sqrt(1 - ratio**2))
            r = shape[point] / (2j * mass * p.imag)
            value += s**2 * (r / (s - p) + np.conj(r) / (s - np.conj(p)))
        sd = 0.02 * np.abs(value)
        scatter = rng.standard_normal((2, len(f)))
        frfs.append(FRF(f, value + sd * (scatter[0] + 1j * scatter[1]), sd=sd, units="SI"))
    return FRFSet(tuple(frfs))


class ModeEstimates(NamedTuple):
    """Modes as (frequency, damping ratio, shape), and the CPU time that they took, s."""

    modes: list[tuple[float, float, np.ndarray]]
    seconds: float


def shapes_by_ema(points: FRFSet, near: list[float]) -> ModeEstimates:
    """LSCF; of its highest order the poles nearest to the truth, as a user picks on a good day."""
    from sdypy import EMA

    first = points.frfs[0].frequency
    keep = first <= BAND[1]

    def run() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        model = EMA.Model(
            frf=points.accelerance[:, keep], freq=first[keep], lower=BAND[0], upper=BAND[1],
            pol_order_high=30, frf_form="accelerance",
        )  # fmt: skip
        model.get_poles(show_progress=False)
        pick(model, near)
        model.get_constants()
        return np.array(model.nat_freq), np.array(model.nat_xi), np.asarray(model.A)

    start = process_time()
    hz, ratio, shape = quietly(run)
    seconds = process_time() - start
    return ModeEstimates([(hz[i], ratio[i], shape[:, i]) for i in range(len(hz))], seconds)


def pick(model: object, near: list[float]) -> None:
    """Of the highest order the decaying pole nearest to each: its own pick merges two."""
    order = len(model.all_poles) - 1
    poles = model.all_poles[order]
    hz = np.where((poles.real < 0) & (poles.imag > 0), np.abs(poles) / (2 * np.pi), np.inf)
    chosen = [int(np.argmin(np.abs(hz - value))) for value in near]
    model.pole_ind = np.array([[order, i] for i in chosen])
    model.nat_freq, model.nat_xi = hz[chosen], -poles[chosen].real / np.abs(poles[chosen])


def shapes_by_dashpot(points: FRFSet) -> tuple[ModeEstimates, tuple[ModeShape, ...]]:
    start = process_time()
    modes = points.modes(band=BAND)
    stabilisation(points, band=BAND)
    seconds = process_time() - start
    estimates = [
        (
            mode.mode.frequency,
            mode.mode.damping_ratio,
            mode.residues / mode.residues[np.argmax(np.abs(mode.residues))],
        )
        for mode in modes
    ]
    return ModeEstimates(estimates, seconds), modes


def rms(errors: list[float]) -> str:
    return f"{100 * float(np.sqrt(np.mean(np.square(errors)))):10.3g} %"


def errors_of(mode_estimates: ModeEstimates, name: str, into: dict[str, list[float]]) -> None:
    """Against the nearest mode told, each by its frequency, damping and shape."""
    if not mode_estimates.modes:
        return
    for hz, ratio, _, shape in FOUR[name]:
        item = min(
            mode_estimates.modes, key=lambda mode: abs(mode[0] / hz - 1) + abs(mode[1] - ratio)
        )
        into["f"].append(item[0] / hz - 1)
        into["damping"].append(item[1] / ratio - 1)
        true = np.array(shape, complex)[:, None]
        into["mac"].append(float(mac(np.asarray(item[2])[:, None], true)[0, 0]))
    into["time"].append(mode_estimates.seconds)


def shapes() -> None:
    print(f"\nFour points, 2 % of scatter on each line, {DRAWS} draws of it; CPU time each:")
    print(f"  {'':12s}{'by':12s}{'f_n':>12s}{'damping':>12s}{'least MAC':>11s}{'time':>10s}"
          f"{'modes':>7s}{'95 % holds':>12s}")  # fmt: skip
    for name, true in FOUR.items():
        sums: dict[str, dict[str, list[float]]] = {
            by: {"f": [], "damping": [], "mac": [], "time": []} for by in ("dashpot", "sdypy-EMA")
        }
        inside, counts = [], []
        for seed in range(DRAWS):
            points = four_points(name, seed)
            text, result = shapes_by_dashpot(points)
            errors_of(text, name, sums["dashpot"])
            counts.append(len(result))
            for hz, ratio, *_ in true if len(result) == len(true) else ():
                mode = min((item.mode for item in result), key=lambda m: abs(m.frequency - hz))
                inside.append(abs(mode.frequency - hz) < 1.96 * mode.frequency_se)
                inside.append(abs(mode.damping_ratio - ratio) < 1.96 * mode.damping_ratio_se)
            if HAVE_EMA:
                near = [hz for hz, *_ in true]
                errors_of(shapes_by_ema(points, near), name, sums["sdypy-EMA"])
        for by, entry in sums.items():
            if entry["f"]:
                took = f"{1e3 * np.mean(entry['time']):7.0f} ms"
                print(f"  {name:12s}{by:12s}{rms(entry['f'])}{rms(entry['damping'])}", end="")
                print(f"{min(entry['mac']):11.4f}{took}", end="")
                text = f"{np.mean(counts):7.2f}{100 * np.mean(inside):10.0f} %"
                print(text if by == "dashpot" else "   picked")


def real_hits(file: str) -> None:
    print(f"\n{file}: two accelerometers, modes from 17 to 24 Hz")
    options = ReadOptions(hammer="F", acceleration=("m_1", "m_2"), units={"F": "N"})
    test = read_impact(file, options=options)
    frfs = [
        estimate_frf(replace(test, acceleration=test.acceleration[[i]], channels=(name,)))
        for i, name in enumerate(("m_1", "m_2"))
    ]
    for item in FRFSet(tuple(frfs), ("m_1", "m_2")).modes(band=(17, 24)):
        mode = item.mode
        print(f"  dashpot    {mode.frequency:9.4f} ± {mode.frequency_se:.4f} Hz"
              f"{100 * mode.damping_ratio:9.4f} ± {100 * mode.damping_ratio_se:.4f} %")  # fmt: skip
    if not (HAVE_PYFRF and HAVE_EMA):
        return
    import pyFRF

    half = len(test.force) // 2
    force = without_offset(test.force[: 2 * half].reshape(2, half))
    rate = round(1 / float(np.median(np.diff(test.time))))
    for window in ("none", "exponential:0.01"):
        rows = []
        for channel in test.acceleration:
            response = without_offset(channel[: 2 * half].reshape(2, half))
            words = window if window == "none" else (window, window)
            frf = pyFRF.FRF(rate, window=words, fft_len=half, units="SI")
            for pair in zip(force, response, strict=True):
                quietly(lambda pair=pair, frf=frf: frf.add_data(*(x.copy() for x in pair)))
            value = quietly(lambda frf=frf: frf.get_FRF(frf_form="accelerance"))
            rows.append(np.nan_to_num(np.squeeze(value)))
        for hz, ratio in poles_of(np.array(rows), frf.get_f_axis()):
            print(f"  pyFRF ({window}), sdypy-EMA {hz:9.4f} Hz{100 * ratio:9.4f} %")


def poles_of(value: np.ndarray, frequency: np.ndarray) -> list[tuple[float, float]]:
    """The two poles of the real block by sdypy-EMA's LSCF from 10 to 40 Hz."""
    from sdypy import EMA

    def run() -> list[tuple[float, float]]:
        keep = frequency <= 40
        model = EMA.Model(
            frf=value[:, keep], freq=frequency[keep], lower=10, upper=40, pol_order_high=30,
            frf_form="accelerance",
        )  # fmt: skip
        model.get_poles(show_progress=False)
        pick(model, [19.76, 21.15])
        return list(zip(model.nat_freq, model.nat_xi, strict=True))

    return quietly(run)
