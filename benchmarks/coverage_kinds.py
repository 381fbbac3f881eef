"""How often 95 % limits hold the truth, for pressed, squeezed and struck parts, under white noise.

    python benchmarks/coverage_kinds.py STUDY [--seeds 200] [--first 7000]
    python benchmarks/coverage_kinds.py --list

Truths are those of `tests/kit/foreign`. The last tables printed are kept in docs/performance.md.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

import dashpot as dp
from dashpot.extensions.depths.depth_dependence import fit_depths
from dashpot.extensions.materials.cld.datamodel import CLD
from dashpot.extensions.materials.cld.equilibrium_curve import fit_relaxed_law
from dashpot.extensions.materials.cld.multi_speed_fit import fit_speeds
from dashpot.extensions.materials.cld.preprocess import cld
from dashpot.extensions.materials.indentation.fit import fit_indentation
from dashpot.extensions.materials.indentation.indenter import Indenter
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.prepare import prepare

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from kit.foreign import kinds
from kit.foreign.aging import Rubber, lot
from kit.foreign.rigs import Protocol, noisy, press_seal, sample_record
from kit.foreign.truths import TABLE_1, Seal

Held = Iterator[tuple[str, bool]]
RUBBER = Rubber()
DEPTH = 6e-3
"""Of a load deflection test, m."""


def check_interval(name: str, true: float, value: float, error: float) -> tuple[str, bool]:
    return name, bool(abs(value - true) <= 1.96 * error)


def seal_of(seed: int) -> Seal:
    """Table 1's solid under a law whose tangent is a line."""
    return Seal(TABLE_1, DEPTH, a=np.random.default_rng([seed, 1]).uniform(0, 0.6))


def bends(law: dp.solids.ElasticLaw, seal: Seal) -> Held:
    """Its tangent over its secant at the depth."""
    for part in (0.0, 0.5, 1.0):
        at, step = part * law.depth, 1e-3 * law.depth
        true = float(np.diff(seal.elastic([at - step, at + step]))[0]) / (2 * step)
        name = f"tangent at {part:g} of the depth"
        yield check_interval(name, true, float(law.factor(at)), float(law.factor_se(at)))


def pressed_once(seal: Seal, speed: float, seed: int, air: bool) -> CLD:
    """From air or from contact, in and back to a quarter of the depth, 400 rows to a stroke."""
    step = DEPTH / speed / 400
    rows = np.arange(-100, 701)
    plate = DEPTH * np.interp(rows, (-50, 400, 700), (-50, 400, 100)) / 400
    pressed = np.maximum(plate, 0.0)
    force = seal.force(pressed, step)
    noise = 2e-3 * np.random.default_rng([seed, round(1e9 * speed)]).standard_normal(len(rows))
    return cld(
        dp.CLDTest(plate if air else pressed, force + noise, step * (rows + 100), units="SI")
    )


def figures(seed: int) -> Held:
    """Force and slope of the loading halfway and at the depth."""
    sheet = kinds.cld(seed)
    x, pure = 1e-3 * sheet["displacement"], sheet.truth["pure"]
    test = dp.CLDTest(x, sheet["force"], sheet["time"], units="SI")
    for name, at in (("halfway", DEPTH / 2), ("at the depth", DEPTH)):
        result = cld(test, at=at)
        rows = result.loading.samples
        rows = slice(rows.start + 1, rows.stop - 1)  # between the turns the force is smooth
        true = CubicSpline(x[rows], pure[rows])
        nominal = result.nominal
        yield check_interval(f"force {name}", float(true(at)), nominal.loading, nominal.loading_se)
        yield check_interval(f"slope {name}", float(true(at, 1)), nominal.slope, nominal.slope_se)


@cache
def relaxation() -> dp.Fit:
    """Table 1's, known to rounding."""
    record = sample_record(press_seal(Seal(TABLE_1), Protocol(rate=200.0)), None)
    return fit(
        dp.RelaxationTest(record.time, record.displacement, record.force, units="SI"), arms=2
    )


def check_tangents(seed: int, air: bool) -> Held:
    """Tangents of the law under one cycle whose relaxation is known."""
    seal, speed = seal_of(seed), np.random.default_rng([seed, 2]).choice([1e-4, 5e-4, 2e-3])
    law = fit_relaxed_law(pressed_once(seal, speed, seed, air), relaxation()).law
    yield from bends(law, seal)


def intervals(result: dp.Fit, prefix: str = "") -> Held:
    """Those of Table 1's solid."""
    bounds = result.intervals()
    true = {"k_inf": [TABLE_1.k_inf], "k": TABLE_1.k, "tau": TABLE_1.tau}
    for name, values in true.items():
        pairs = np.reshape(bounds[name], (-1, 2)).tolist()
        for i, value in enumerate(values):
            message = result.model.arms == 2 and pairs[i][0] <= value <= pairs[i][1]
            yield f"{prefix}{name}{i + 1 if len(values) > 1 else ''}", message


def speeds(seed: int, air: bool) -> Held:
    """One relaxation at three speeds, its number of arms chosen."""
    seal = seal_of(seed)
    result = fit_speeds([pressed_once(seal, speed, seed, air) for speed in (2e-4, 2e-3, 2e-2)])
    yield from intervals(result)
    yield from bends(result.elastic_law, seal)


def depths(seed: int) -> Held:
    """Three tests of one seal, and their law."""
    seal, random = Seal(TABLE_1, a=0.48), np.random.default_rng(seed)
    tests = []
    for depth in (4e-3, 6e-3, 8e-3):
        record = sample_record(press_seal(seal, Protocol(depth=depth, rate=200.0)), random)
        record = noisy(record, random, sd=4e-3)
        tests.append(
            prepare(dp.RelaxationTest(record.time, record.displacement, record.force, units="SI"))
        )
    depth_law = fit_depths(tests, arms=2)
    for at in depth_law.by_depth:
        name = f"k_inf at {1e3 * at.depth:.0f} mm"
        secant = TABLE_1.k_inf * float(seal.elastic(at.depth)) / at.depth
        yield f"at most, {name}", secant <= at.k_inf_most
    yield from intervals(depth_law.fit, "together ")
    yield from bends(depth_law.fit.elastic_law, seal)


def indentation(seed: int) -> Held:
    """A ball on rubber with one arm."""
    sheet = kinds.indentation(4 * (seed // 3) + 1 + seed % 3)  # every fourth has no arm
    true, solid = sheet.truth, sheet.truth["contact"]
    ball = Indenter(true["mass"], impact_velocity=true["speed"])
    test = dp.IndentationTest(
        1e-3 * sheet["time"], sheet["indenter"], "acceleration", ball, units="SI"
    )
    indentation_fit = fit_indentation(test, law="hertz-maxwell")
    numbers = {
        "k": solid.k_inf, "g": solid.k[0] / solid.k_inf, "tau": solid.tau[0],
        "impact_velocity": true["speed"], "depth": true["depth"],
    }  # fmt: skip
    for name, value in numbers.items():
        quantity = next(item for item in indentation_fit.reported_values if item.name == name)
        yield name, bool(quantity.low <= value <= quantity.high)


def aging(seed: int, *, rubber: Rubber = RUBBER, oven: float = 1.0, off: float = 1.0) -> Held:
    """Specimens in three ovens that are off: life and F/F0 at 70 degC, activation energy."""
    item = lot(rubber, seed, off=off)
    record = dp.CSRTest(
        item.hours, item.force, item.celsius, item.specimen_number, units="h, N, degC"
    )
    result = dp.fit(record, machine=dp.Machine(oven=oven))
    aged = dp.predict(result, temperature="70degC", until=("50%", "1000h"))
    life, retention = (fact for fact in aged.facts if fact.name in {"life", "left"})
    energy = result["activation_energy"]
    yield "life", bool(life.low <= 3600 * rubber.life(70.0) <= life.high)
    yield "activation energy", bool(energy.low <= rubber.energy <= energy.high)
    yield "F/F0 after 1000 h", bool(retention.low <= rubber.left(1000.0, 70.0) <= retention.high)


STUDIES = {
    "aging": aging, "aging-exact-ovens": partial(aging, oven=0.0, off=0.0),
    "aging-ovens-unsaid": partial(aging, oven=0.0),
    "aging-chemical-only": partial(aging, rubber=replace(RUBBER, loss=0.0)),
    "figures": figures, "depths": depths, "indentation": indentation,
    "relaxed": partial(check_tangents, air=False),
    "relaxed-from-air": partial(check_tangents, air=True),
    "speeds": partial(speeds, air=False), "speeds-from-air": partial(speeds, air=True),
}  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("study", choices=STUDIES, nargs="?", default="figures")
    parser.add_argument("--list", action="store_true", help="the studies, and nothing else")
    parser.add_argument("--seeds", type=int, default=200)
    parser.add_argument("--first", type=int, default=7000)
    options = parser.parse_args()
    if options.list:
        print(" ".join(STUDIES))
        return
    held: Counter[str] = Counter()
    start = time.process_time()
    for seed in range(options.first, options.first + options.seeds):
        held.update(dict(STUDIES[options.study](seed)))
    cost = (time.process_time() - start) / options.seeds
    print(f"{options.study}: held of {options.seeds}, {1e3 * cost:.0f} ms of CPU each")
    for name, count in held.items():
        print(f"  {name:28}{count:5d}")


if __name__ == "__main__":
    main()
