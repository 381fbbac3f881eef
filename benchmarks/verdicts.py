"""How often a verdict is right, judged on truths and rigs that share no line with dashpot.

    python benchmarks/verdicts.py OUT.jsonl [--per 10] [--several 84] [--kinds 20] [--curves 300]
        [--conditioned 84] [--claims 20] [--hammers 20] [--pairs 60] [--only REGEX]
    python benchmarks/verdicts.py --table OUT.jsonl

The relaxation records of `tests/kit/foreign`: its 42 truths on its 40 rigs, `--per` truths of each,
on rigs of which a channel stands still, or whose servo hunts, or whose converter folds the mains,
and by turns on `--several` rigs that have several faults at once; its other kinds of test, sound
and spoilt by turns; `--conditioned` seals that were pressed before their test, of which limits of
k(T), k(3T) and k_inf are asked; `--hammers` hammer tests of each kind of rig (`hammer_rigs`:
windows, cables); `--pairs` seals with an arm slower than their test, fitted to bench and hammer and
to the hammer alone, of which the most that k_inf may be is asked; and its curves: `--curves` moduli
and a third as many compliances and sweeps, which end before their plateau or after, each whole and
cut. Of `--claims` records each: curves with gaps, tests of which too few arms or as many as the
truth has are asked for, and the first sentence of relaxation records on five rigs. Each record is
one line of OUT.jsonl; those that stand there are not run again, and the same seed gives the same
records.

A relaxation record misses if one of its 95 % limits does: of the accelerance of two seals under
the mass that they bring to resonance at 12.7 Hz (there, its peak's height and frequency), of k(T)
and k(3T), T the hold as the record was understood, or the most that k_inf may be. A sheet of
another kind misses if what is asked of it (`SHEETS`) errs by more than 5 %; a hammer test if the
95 % limits of |K*| or of the loss factor at its resonance do; a record with a late channel
(`DELAYED`) if the interval of what a delay moves does; a curve if a limit of its end does, or its
plateau is off by more than 10 %. A claim misses where stiffness or loss factor lie off by more than
the result says, anywhere in its band. A refusal gives no limits and no "use", and counts as neither
held nor missed.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from zlib import crc32

import numpy as np
from scipy.stats import beta

import dashpot as dp
from dashpot.extensions.amplitude.fit import fit_amplitude
from dashpot.extensions.amplitude.fit_files import fit_amplitude_record
from dashpot.extensions.curves.creep.fit import fit_creep
from dashpot.extensions.curves.creep.read import read_creep
from dashpot.extensions.curves.dynamic.fit import fit_dynamic
from dashpot.extensions.curves.dynamic.read import read_dynamic
from dashpot.extensions.curves.modulus.fit import fit_modulus
from dashpot.extensions.curves.modulus.read import read_modulus
from dashpot.extensions.materials.cld.preprocess import cld
from dashpot.extensions.materials.cld.read import read_cld
from dashpot.extensions.materials.hyperelastic.fit import fit_hyperelastic
from dashpot.extensions.materials.indentation.fit import fit_indentation
from dashpot.extensions.materials.indentation.indenter import Indenter
from dashpot.extensions.materials.indentation.read import read_indentation
from dashpot.fitting.identification.identify import identify
from dashpot.fitting.prediction_bounds import frf_band
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.prepare import prepare
from dashpot.reading.readers.frf import read_frf
from dashpot.reading.readers.impact import read_impact
from dashpot.vibration.impact.frf_estimation import estimate_frf

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from kit import curve_ends
from kit.drop_relaxation import make_relaxation_fit
from kit.foreign import conditioning, curves, forced_orders, gaps
from kit.foreign.catalogue import protocol_of, verdict_records
from kit.foreign.delayed_channels import cycle_of, make_delayed_sheet, over_displacement
from kit.foreign.hammer_rigs import KINDS as HAMMERS
from kit.foreign.hammer_rigs import HammerRecord, struck_rig
from kit.foreign.kinds import Sheet, nominal, sheets
from kit.foreign.lying_channels import CHANNELS
from kit.foreign.rigs import RIGS, Record, read, several
from kit.foreign.slow_arms import SlowPair, slow_pairs
from kit.foreign.truths import TRUTHS, Seal, Solid

HERTZ, SEALS = 12.7, 2
MISSED, HELD, SURE = 0.06, 0.93, 0.15
"""Goals: misses of all "use" at most, limits that hold at least, misses of one disturbance's."""
DOUBTED = 0.20
"""A disturbance of which no more are called "use" is doubted."""
USED, USED_EACH = 0.80, 0.70
SEVERAL = "several faults at once"
WIDTHS = {"k_end": 0.035, "k_3end": 0.11, "frf": 1.75}
"""Largest median half widths of a sound rig: of k(T), k(3T) over the truth; of ln |a/F|."""


# -- one record ------------------------------------------------------------------------------------


def limits_of(item: Record) -> tuple[dp.Fit, dict[str, tuple[float, float, float]]]:
    """The fit, and by name the lower limit, the truth and the upper limit of what it claims."""
    test = dp.RelaxationTest(item.time, item.displacement, item.force, units="SI")
    record = prepare(test, machine=dp.Machine(**item.machine_options))
    result = fit(record)
    mass = item.seal.mass_at(HERTZ, SEALS)
    bound = frf_band(result, record, mass=mass, frequency=[HERTZ], seals=SEALS)
    there = abs(item.seal.accelerance(HERTZ, mass, SEALS))
    limits = {"frf": (bound.unmeasured[0, 0], there, bound.unmeasured[1, 0])}
    # the bound's resonance is where K' = m w^2/n: where the mass was chosen to have it
    for name, truth, pair in (
        ("peak_frequency", HERTZ, bound.peak_frequency),
        ("peak_height", item.seal.peak(mass, SEALS)[1], bound.peak_height),
    ):
        limits[name] = (np.nan, truth, np.nan) if pair is None else (pair[0], truth, pair[1])
    opened = result.stiffness_limits
    for name, times in (("k_end", 1), ("k_3end", 3), ("k_inf", np.inf)):
        low, high = (np.nan, np.nan) if opened is None else opened[name]
        truth = float(item.seal.secant(times * record.hold_time))
        limits[name] = (0.0 if name == "k_inf" else low, truth, high)
    return result, limits


def judge_record(record: Record) -> dict[str, object]:
    """One line of a relaxation record."""
    start = time.process_time()
    try:
        result, limits = limits_of(record)
    except dp.DashpotError as error:
        values: dict[str, object] = {"use": "refused", "reason": [str(error)]}
    else:
        values = {
            **_describe_verdict(result.verdict),
            "limits": {name: [float(v) for v in three] for name, three in limits.items()},
        }
    return {**values, "cpu": round(time.process_time() - start, 3)}


def judge_conditioned(item: conditioning.ConditionedRecord) -> dict[str, object]:
    """One line of a seal that was pressed before its test."""
    start = time.process_time()
    try:
        record = prepare(dp.RelaxationTest(item.time, item.displacement, item.force, units="SI"))
        result = fit(record)
    except dp.DashpotError as error:
        values: dict[str, object] = {"use": "refused", "reason": [str(error)]}
    else:
        limits = conditioning.limits_of(item, result.stiffness_limits or {}, record.hold_time)
        values = {
            **_describe_verdict(result.verdict),
            "limits": {name: [float(v) for v in three] for name, three in limits.items()},
        }
    return {**values, "cpu": round(time.process_time() - start, 3)}


def holds_truth(line: Mapping) -> bool:
    """Whether every limit holds its truth; one that is not stated holds nothing."""
    if "limits" in line:
        return all(low <= truth <= high for low, truth, high in line["limits"].values())
    return bool(line["error"] <= line["allowed"])


def half_width(line: Mapping, name: str) -> float:
    """Of a stiffness over its truth; of the logarithm of the response."""
    low, truth, high = line["limits"][name]
    if name == "frf":
        return float(np.log(high / low) / 2) if low > 0 else np.inf
    return (high - low) / 2 / truth


# -- the table -------------------------------------------------------------------------------------


def least(count: int, of: int) -> float:
    """Lower 95 % limit of a rate (Clopper and Pearson 1934), one-sided."""
    return float(beta.ppf(0.05, count, of - count + 1)) if count else 0.0


def most(count: int, of: int) -> float:
    """Upper 95 % limit of a rate, one-sided."""
    return float(beta.ppf(0.95, count + 1, of - count)) if count < of else 1.0


def _part(count: int, of: int) -> float:
    return count / of if of else np.nan


@dataclass(frozen=True)
class Row:
    """The counts of some records; refused ones are counted apart."""

    name: str
    refused: int
    answered: int
    held: int
    used: int
    used_held: int
    widths: Mapping[str, float]

    @classmethod
    def of(cls, name: str, lines: Iterable[Mapping]) -> Row:
        lines = list(lines)
        answered = [line for line in lines if line["use"] != "refused"]
        right = [line for line in answered if holds_truth(line)]
        widths = {}
        if answered and "frf" in answered[0].get("limits", ()):
            widths = {w: float(np.median([half_width(o, w) for o in answered])) for w in WIDTHS}
        return cls(
            name, len(lines) - len(answered), len(answered), len(right),
            sum(line["use"] == "use" for line in answered),
            sum(line["use"] == "use" for line in right), widths,
        )  # fmt: skip

    @property
    def missed(self) -> int:
        """Called "use", and a limit misses."""
        return self.used - self.used_held

    @property
    def doubted(self) -> bool:
        return self.used <= DOUBTED * (self.answered + self.refused)

    @property
    def faults(self) -> list[str]:
        """Goals of one disturbance that it does not meet."""
        result = []
        if not self.doubted and least(self.missed, self.used) > SURE:
            result.append("misses")
        if not self.doubted and most(self.held, self.answered) < HELD:
            result.append("held")
        if not self.doubted and self.held and self.used_held < USED_EACH * self.held:
            result.append("used")
        return result


def rows_of(lines: Iterable[Mapping]) -> list[Row]:
    """One row to a disturbance, in the order in which they first stand."""
    groups: dict[str, list[Mapping]] = {}
    for line in lines:
        groups.setdefault(line["group"], []).append(line)
    return [Row.of(name, some) for name, some in groups.items()]


def format_table(rows: Iterable[Row], whole: Row) -> Iterator[str]:
    """As a table of Markdown: rates of the answered, and widths where they were asked."""
    wide = tuple(whole.widths)
    yield (
        '| | n | refused | limits right | "use" | wrong with "use" | sound with "use" |'
        + (" k(T), % | k(3T), % | ln a/F | goals missed |" if wide else "")
    )
    yield "|---|" + (9 if wide else 6) * "---:|" + ("---|" if wide else "")
    for row in (*rows, whole):
        cells = [
            row.name, f"{row.answered + row.refused}", f"{row.refused}",
            f"{_part(row.held, row.answered):.2f}", f"{_part(row.used, row.answered):.2f}",
            f"{row.missed}/{row.answered - row.held}", f"{row.used_held}/{row.held}",
        ]  # fmt: skip
        if wide:
            k, k_3, frf = (row.widths.get(name, np.nan) for name in WIDTHS)
            cells += [f"{100 * k:.1f}", f"{100 * k_3:.1f}", f"{frf:.2f}"]
            cells.append("" if row is whole else ", ".join(row.faults))
        yield "| " + " | ".join(cells).replace("nan", "-") + " |"


def goals(rows: list[Row], whole: Row) -> Iterator[tuple[str, bool]]:
    """Each goal with its figure, and whether it is met."""
    rate, intact = _part(whole.missed, whole.used), _part(whole.used_held, whole.held)
    message = f'of {whole.used} with "use" {whole.missed} are wrong: {100 * rate:.1f} %'
    yield f"{message} (goal <= {100 * MISSED:g} %)", rate <= MISSED
    message = f'of {whole.held} sound ones {whole.used_held} have "use": {100 * intact:.0f} %'
    yield f"{message} (goal >= {100 * USED:g} %)", intact >= USED
    for fault, message in (
        ("misses", f'wrong with "use": lower limit above {100 * SURE:g} %'),
        ("held", f"limits right: upper limit below {HELD:g}"),
        ("used", f'sound ones with "use" below {100 * USED_EACH:g} %'),
    ):
        names = [row.name for row in rows if fault in row.faults]
        yield f"{message}, in {len(names)} disturbances (goal 0): {'; '.join(names)}", not names
    none = next((row for row in rows if row.name == "none"), None)
    for name, goal in WIDTHS.items() if none is not None and none.widths else ():
        value = none.widths[name]
        yield (
            f"median half width, no disturbance, {name}: {value:.3g} (goal <= {goal:g})",
            (value <= goal),
        )


def shown_curves(lines: Iterable[Mapping]) -> Iterator[str]:
    """The ends of curves as a table of Markdown."""
    groups: dict[str, list[Mapping]] = {}
    for line in lines:
        groups.setdefault(line["group"], []).append(line)
    yield '| | n | k(T) | k(3T) | k(10T) | upper limit | "use" | of them wrong | sound with "use" |'
    yield "|---|" + 8 * "---:|"
    for name, some in groups.items():
        score = curve_ends.Score.of(some)
        held = " | ".join(f"{score.held[limit]:.3f}" for limit in curve_ends.NAMES)
        yield (
            f"| {name} | {score.count} | {held} | {score.used} | {score.used_off} | "
            f"{score.faultless_used}/{score.faultless} |"
        )
    yield ""


def report(lines: Iterable[Mapping]) -> Iterator[str]:
    """Tables of relaxation records and of other kinds, each with its totals and goals."""
    lines = list(lines)
    ended = [line for line in lines if "settled" in line]
    if ended:
        yield from shown_curves(ended)
    parts = (
        ("relaxation", [line for line in lines if line["rig"]]),
        ("other kinds", [line for line in lines if not line["rig"] and "settled" not in line]),
    )
    for title, some in parts:
        if not some:
            continue
        rows, whole = rows_of(some), Row.of("all", some)
        yield f"\n{title}: {len(some)} records, {sum(line['cpu'] for line in some):.0f} CPU s\n"
        yield from format_table(rows, whole)
        yield ""
        if title == "relaxation":
            needless = [r.name for r in rows if r.doubted and most(r.held, r.answered) >= HELD]
            for message, met in goals(rows, whole):
                yield f"{'met    ' if met else 'NOT met'} {message}"
            yield f"        doubted, though its limits may well hold: {'; '.join(needless)}"
        else:
            rate = _part(whole.missed, whole.used)
            yield f'of {whole.used} with "use" {whole.missed} are wrong: {100 * rate:.1f} %'


# -- other kinds -----------------------------------------------------------------------------------
Answer = tuple[dp.Verdict | Mapping, float]
"""The verdict, of a command as its document has it, and the largest relative error of the asked."""
ALLOWED = 0.05
"""More than this is a miss: dashpot's own limit for a stiffness that is called right."""


def _error(result, truth) -> float:
    return float(np.max(np.abs(np.asarray(result) / np.asarray(truth) - 1)))


def _measure_hits(sheet: Sheet, path: Path) -> Answer:
    """K at the resonance, by the mass."""
    return _measure_on_mass(sheet, estimate_frf(read_impact(path)), sheet.truth["mass"])


def _measure_frf(sheet: Sheet, path: Path) -> Answer:
    """K at the resonance, by the mass that the lab names."""
    return _measure_on_mass(sheet, read_frf(path), sheet.truth["stated"])


def _measure_on_mass(sheet: Sheet, frf: dp.FRF, mass: float) -> Answer:
    result = identify(frf, mass=mass, seals=sheet.truth["seals"])
    seal = sheet.truth["seal"]
    there = 2 * np.pi * seal.peak(sheet.truth["mass"], sheet.truth["seals"])[0]
    error = _error(result.solid.complex_stiffness(omega=there), seal.stiffness(there))
    return result.verdict, error


def _measure_creep(sheet: Sheet, path: Path) -> Answer:
    """k(t) at .1 s to the end of the record."""
    result = fit_creep(read_creep(path))
    t = np.geomspace(0.1, sheet["time"][-1] - 1, 20)
    return result.verdict, _error(result.solid.relaxation(t), sheet.truth["solid"].relaxation(t))


def _measure_modulus(sheet: Sheet, path: Path) -> Answer:
    """E(t) from the first row to three times the last."""
    result = fit_modulus(read_modulus(path))
    t = np.geomspace(0.01, 3 * sheet.truth["end"], 40)
    return result.verdict, _error(result.solid.relaxation(t), sheet.truth["solid"].relaxation(t))


def _measure_dma(sheet: Sheet, path: Path) -> Answer:
    """E* over the lines, at 20 degC."""
    result = fit_dynamic(read_dynamic(path))
    if sheet.kind == "dma temperatures":
        result = result.at_temperature(293.15)
    omega = 2 * np.pi * np.geomspace(0.1, 30.0, 40)
    truth = sheet.truth["solid"].stiffness(omega)
    return result.verdict, _error(result.solid.complex_stiffness(omega=omega), truth)


def _measure_amplitude(sheet: Sheet, _: Path) -> Answer:
    """G* over the amplitudes, at the first frequency, of what was tested, spoilt or not."""
    f, X = sheet["frequency"], sheet["strain"] / 100
    storage, loss = 1e6 * sheet["storage"], 1e6 * sheet["loss"]
    amplitude_fit = fit_amplitude(dp.AmplitudeSweep(f, X, storage, loss, units="SI"))
    first = f == f[0]
    return amplitude_fit.verdict, _error(
        amplitude_fit.stiffness(X[first]), sheet.truth["pure"][first]
    )


def _command(*words: str | Path) -> dict:
    """What a command prints as JSON; a refusal is one here, too."""
    done = subprocess.run(
        [sys.executable, "-m", "dashpot", *map(str, words), "--json"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    document = json.loads(done.stdout)
    if document["schema"].startswith("dashpot/error"):
        raise dp.DashpotError(document["message"])
    return document


def _measure_loops(sheet: Sheet, path: Path) -> Answer:
    """K of a vanishing loop: of the solid and of sliders that stick."""
    document = _command("fit", path)
    seal, hertz = sheet.truth["seal"], sheet.truth["frequency"]
    sticks = sum(seal.friction / 5 / seal.reach / times for times in 2.0 ** np.arange(5))
    first = document["linear"][0]
    truth = seal.stiffness(2 * np.pi * hertz) + sticks
    return document["verdict"], _error(first["storage"] + 1j * first["loss"], truth)


def _measure_cld(sheet: Sheet, path: Path) -> Answer:
    """Force of the pressing at .6 of the depth in the cycle that is told, read as it was."""
    at = 0.6 * sheet.truth["seal"].depth
    test = read_cld(path)
    result = cld(replace(test, specimen=dp.Specimen(length=0.1)), at=at)
    plate = 1e-3 * sheet["displacement"]
    rows = np.arange(len(plate)) * sheet.truth["cycles"] * 2 // len(plate)
    message = rows == 2 * (result.cycle.number - 1)
    slack = plate.max() - sheet.truth["seal"].depth
    truth = np.interp(at, plate[message] - slack, sheet.truth["pure"][message])
    return result.verdict, _error(result.nominal.loading, truth)


def _measure_rod(sheet: Sheet, path: Path) -> Answer:
    """E* at the line of the largest response: ends slide, for it is a rod's theory."""
    size = f"{sheet.truth['diameter']}m,{sheet.truth['length']}m"
    document = _command(
        "fit", path, "--shape", f"disc:{size}", "--lubricated",
        "--density", str(sheet.truth["density"]), "--mass", f"{sheet.truth['mass']!r}kg",
    )  # fmt: skip
    lines = np.asarray(document["frequency"])
    highest = sheet["frequency"][np.argmax(np.hypot(sheet["real"], sheet["imaginary"]))]
    line = np.argmin(np.abs(lines - highest))
    result = document["storage"][line] * (1 + 1j * document["loss_factor"][line])
    return document["verdict"], _error(
        result, sheet.truth["solid"].stiffness(2 * np.pi * lines[line])
    )


def _measure_stretch(sheet: Sheet, _: Path) -> Answer:
    """Stress in the three modes over what was stretched, in the largest of each."""
    law, constants = sheet.truth["law"], sheet.truth["constants"]
    modes, stretch = ("uniaxial", "equibiaxial", "planar"), 1 + sheet["strain"]
    tests = [dp.StressStrainTest(mode, stretch, 1e6 * sheet[mode], units="SI") for mode in modes]
    hyperelastic_fit = fit_hyperelastic(tests, poisson=0.0 if law == "hyperfoam" else None)
    worst = 0.0
    for mode in modes:
        truth = nominal(law, mode, stretch, constants)
        off = np.abs(hyperelastic_fit.law.nominal(mode, stretch) - truth)
        worst = max(worst, float(off.max() / np.abs(truth).max()))
    return hyperelastic_fit.verdict, worst


def _measure_indentation(sheet: Sheet, path: Path) -> Answer:
    """The deepest point: of the ball's path, which Hertz and one arm give."""
    # as a lab knows it, by the height of its fall
    indenter = Indenter(mass=sheet.truth["mass"], impact_velocity=sheet.truth["speed"])
    indentation_fit = fit_indentation(read_indentation(path, indenter=indenter))
    depth = next(fact.value for fact in indentation_fit.reported_values if fact.name == "depth")
    return indentation_fit.verdict, _error(depth, sheet.truth["depth"])


SHEETS: Mapping[str, Callable[[Sheet, Path], Answer]] = {
    "impact": _measure_hits,
    "frf": _measure_frf,
    "rod": _measure_rod,
    "creep": _measure_creep,
    "modulus": _measure_modulus,
    "dma": _measure_dma,
    "dma temperatures": _measure_dma,
    "amplitude": _measure_amplitude,
    "loops": _measure_loops,
    "cld": _measure_cld,
    "stress strain": _measure_stretch,
    "indentation": _measure_indentation,
}


WITHIN = 1.96
"""Standard errors of a 95 % interval; of limits, in quarters of their width."""


def _late_creep(sheet: Sheet) -> Answer:
    """Force over displacement at the end of the hold, by the limits."""
    test = dp.CreepTest(sheet["time"], 1e-3 * sheet["displacement"], sheet["force"], units="SI")
    result = dp.fit(test)
    low, high = result.stiffness_limits["k_end"]
    truth = over_displacement(sheet.truth["solid"], result.evidence.end_of_hold.end_time)
    return result.verdict, WITHIN * abs(truth - (low + high) / 2) / ((high - low) / 2)


def _late_loops(sheet: Sheet) -> Answer:
    """The loss of a vanishing loop, of which sliders that stick are no part."""
    test = dp.RelaxationTest(
        sheet["time"], 1e-3 * sheet["displacement"], sheet["force"], units="SI"
    )
    amplitude_result = fit_amplitude_record(test)
    line = amplitude_result.fit.lines[0]
    truth = sheet.truth["seal"].stiffness(2 * np.pi * sheet.truth["frequency"]).imag
    return amplitude_result.verdict, abs(line.loss - truth) / line.loss_se


def _late_cld(sheet: Sheet) -> Answer:
    """The part of the work that is lost in the cycle that is told."""
    columns = 1e-3 * sheet["displacement"], sheet["force"], sheet["time"]
    result = cld(dp.CLDTest(*columns, dp.Specimen(length=0.1), units="SI"))
    x, force, top = cycle_of(sheet, result.cycle.number)
    sensed = np.maximum(x, 0.0)
    put = np.trapezoid(force[: top + 1], sensed[: top + 1])
    lost = 1 + np.trapezoid(force[top:], sensed[top:]) / put
    return result.verdict, abs(result.cycle.hysteresis - lost) / result.cycle.hysteresis_se


def _late_drop(sheet: Sheet) -> Answer:
    """The loss factor, beside a relaxation test of the slow arms."""
    specimen = sheet.truth["specimen"]
    test = dp.DropTest(sheet["time"], sheet["force"], sheet["acceleration"], units="SI")
    random = np.random.default_rng([77, *sheet.name.encode()])
    result = dp.fit(test, mass=specimen.mass, relaxation=make_relaxation_fit(specimen, random))
    loss = result.reported_values[0]
    off = specimen.loss_factor(result.frequency) - loss.value
    return result.verdict, WITHIN * abs(off) / ((loss.high - loss.low) / 2)


DELAYED: Mapping[str, Callable[[Sheet], Answer]] = {
    "creep": _late_creep, "loops": _late_loops, "cld": _late_cld, "slam": _late_drop,
}  # fmt: skip


def judge_delayed(sheet: Sheet) -> dict[str, object]:
    """One line of a record with a late channel."""
    start = time.process_time()
    try:
        verdict, error = DELAYED[sheet.kind](sheet)
    except dp.DashpotError as refusal:
        values: dict[str, object] = {"use": "refused", "reason": [str(refusal)]}
    else:
        values = {**_describe_verdict(verdict), "error": float(error), "allowed": WITHIN}
    return {**values, "cpu": round(time.process_time() - start, 3)}


def _describe_verdict(verdict: dp.Verdict | Mapping) -> dict[str, object]:
    """What a verdict says, and because of which checks."""
    if isinstance(verdict, Mapping):
        return {"use": verdict["verdict_grade"], "reason": verdict["failed_checks"]}
    return {"use": verdict.use, "reason": list(verdict.reasons)}


def judge_sheet(sheet: Sheet) -> dict[str, object]:
    """One line of a sheet, by its file."""
    start = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "one.csv"
        path.write_text(sheet.text(), "utf-8")
        try:
            verdict, error = SHEETS[sheet.kind](sheet, path)
        except dp.DashpotError as refusal:
            values: dict[str, object] = {"use": "refused", "reason": [str(refusal)]}
        else:
            values = {**_describe_verdict(verdict), "error": error, "allowed": ALLOWED}
    return {**values, "cpu": round(time.process_time() - start, 3)}


# -- hammers ---------------------------------------------------------------------------------------
NORMAL = 1.96
"""Standard errors of a 95 % limit."""


def judge_hammer(hammer_record: HammerRecord, head: str) -> dict[str, object]:
    """One line of a hammer test: how far its solid is off at the resonance, over its limits."""
    start = time.process_time()
    omega, truth = hammer_record.truth["omega"], hammer_record.truth["stiffness"]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "hits.csv"
        path.write_text(hammer_record.text(head), "utf-8")
        try:
            result = dp.fit(
                dp.read(path), mass=hammer_record.truth["mass"], seals=hammer_record.truth["seals"]
            )
        except dp.DashpotError as refusal:
            values: dict[str, object] = {"use": "refused", "reason": [str(refusal)]}
        else:
            K = result.solid.complex_stiffness(omega=omega)
            size, loss = result.estimate.errors_of_vibration(result.model, np.array([1j * omega]))
            off = (
                _error(abs(truth), abs(K)) / (NORMAL * size),
                _error(truth.imag / truth.real, K.imag / K.real) / (NORMAL * loss),
            )
            values = {**_describe_verdict(result.verdict), "error": max(off), "allowed": 1.0}
    return {**values, "cpu": round(time.process_time() - start, 3)}


def work_of_hammers(options: argparse.Namespace) -> Iterator[tuple[dict, Callable[[], dict]]]:
    """Hammer tests of every kind of rig, by turns."""
    for kind in HAMMERS:
        group = f"hammer, {kind}"
        if not re.search(options.only, group):
            continue
        for turn in range(options.hammers):
            seed = 1000 * options.seed + turn
            name = {"group": group, "rig": False, "name": f"{turn}", "seed": options.seed}
            yield name, lambda kind=kind, seed=seed: judge_hammer(*struck_rig(kind, seed))


# -- arms slower than a test -----------------------------------------------------------------------


def judge_pair(pair: SlowPair, *, joint: bool) -> dict[str, object]:
    """One line of a fit of bench and hammer, or of the hammer alone: whether k_inf is held."""
    start = time.process_time()
    bench, truth = pair.bench, pair.hammer.truth
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "hits.csv"
        path.write_text(pair.hammer.text(), "utf-8")
        tests = [dp.RelaxationTest(bench.time, bench.displacement, bench.force, units="SI")]
        try:
            fit_ = dp.fit(*tests * joint, dp.read(path), mass=truth["mass"], seals=truth["seals"])
        except dp.DashpotError as refusal:
            values: dict[str, object] = {"use": "refused", "reason": [str(refusal)]}
        else:
            low, high = fit_.intervals()["k_inf"]
            values = {
                **_describe_verdict(fit_.verdict),
                "limits": {"k_inf": [float(low), pair.seal.solid.k_inf, float(high)]},
            }
    return {**values, "cpu": round(time.process_time() - start, 3)}


def work_of_pairs(options: argparse.Namespace) -> Iterator[tuple[dict, Callable[[], dict]]]:
    """Seals with an arm slower than their test, by both tests and by the hammer alone."""
    for joint, group in ((True, "slow arm, joint"), (False, "slow arm, hammer")):
        if not re.search(options.only, group):
            continue
        for pair in slow_pairs(options.pairs, options.seed):
            name = {"group": group, "rig": False, "name": pair.name, "seed": options.seed}
            yield name, lambda pair=pair, joint=joint: judge_pair(pair, joint=joint)


# -- all of them -----------------------------------------------------------------------------------


def chosen(per: int, seed: int) -> Iterator[tuple[int, str]]:
    """Truths, by number, and rigs: round by round, in each every rig with a truth of its own."""
    orders = {
        rig: np.random.default_rng([seed, crc32(rig.encode())]).permutation(len(TRUTHS))
        for rig in RIGS
    }
    for turn in range(min(per, len(TRUTHS))):
        for rig, order in orders.items():
            yield int(order[turn]), rig


def lines_of(path: Path) -> list[dict]:
    return [json.loads(line) for line in path.read_text("utf-8").splitlines() if line]


def work(options: argparse.Namespace) -> Iterator[tuple[dict, Callable[[], dict]]]:
    """What names each record, and what judges it."""
    wanted = re.compile(options.only)
    for number, rig in chosen(options.per, options.seed):
        if wanted.search(rig):
            name = {"group": rig, "rig": True, "name": TRUTHS[number].name, "seed": options.seed}
            yield (
                name,
                lambda number=number, rig=rig: judge_record(
                    next(verdict_records([TRUTHS[number]], [rig], options.seed))
                ),
            )
    for turn in range(options.per):
        for rig in filter(wanted.search, CHANNELS):
            truth, seed = (
                TRUTHS[(5 * turn + crc32(rig.encode())) % len(TRUTHS)],
                options.seed + turn,
            )
            name = {"group": rig, "rig": True, "name": f"{turn} {truth.name}", "seed": options.seed}
            yield (
                name,
                lambda truth=truth, rig=rig, seed=seed: judge_record(
                    read(Seal(truth), protocol_of(truth), CHANNELS[rig], seed=seed, name=rig)
                ),
            )
    for turn in range(options.several if wanted.search(SEVERAL) else 0):
        truth, seed = TRUTHS[turn % len(TRUTHS)], options.seed + turn
        name = {"group": SEVERAL, "rig": True, "name": f"{turn} {truth.name}", "seed": options.seed}
        yield (
            name,
            lambda truth=truth, seed=seed: judge_record(
                read(Seal(truth), protocol_of(truth, seed), several(seed), seed=seed)
            ),
        )
    for number in range(options.conditioned):
        kind = conditioning.HISTORIES[number % len(conditioning.HISTORIES)]
        if wanted.search(f"conditioned, {kind}"):
            record = conditioning.make_conditioned_record(number, options.seed)
            group = f"conditioned, {'faultless' if record.faultless else 'softens'}"
            name = {"group": group, "rig": False, "name": record.name, "seed": options.seed}
            yield name, lambda item=record: judge_conditioned(item)
    for kind in SHEETS:
        for record in sheets(kind, options.kinds, options.seed) if wanted.search(kind) else ():
            group = f"{kind}, {record.spoilt or 'sound'}"
            name = {"group": group, "rig": False, "name": record.name, "seed": options.seed}
            yield name, lambda item=record: judge_sheet(item)
    yield from work_of_hammers(options)
    yield from work_of_pairs(options)
    for kind in DELAYED:
        group = f"delays in {kind}"
        for turn in range(options.kinds if wanted.search(group) else 0):
            record = make_delayed_sheet(kind, options.seed + turn)
            name = {
                "group": group, "rig": False, "name": f"{turn} {record.name}", "seed": options.seed,
            }  # fmt: skip
            yield name, lambda item=record: judge_delayed(item)
    yield from work_of_curves(options)
    yield from work_of_claims(options)


# -- what a first sentence claims ------------------------------------------------------------------

HEADLINES = ("none", "white 10 mN", "skew 2 ms", "drift .5 mN/s", "hum 50 Hz")


def evaluate_claim(
    result: dp.Fit, solid: dp.GeneralizedMaxwell, truth: Solid | Seal
) -> dict[str, object]:
    """The verdict, and the largest error over the band, over what is said of it."""
    lines = np.geomspace(*result.band, 60)
    errors = gaps.off(truth, lines, solid.complex_stiffness(omega=2 * np.pi * lines))
    error = max(e / c for e, c in zip(errors, result._error_in_band, strict=True))
    return {**_describe_verdict(result.verdict), "error": float(error), "allowed": 1.0}


def _curve(curve: curves.Curve, arms: int | str = "auto") -> dp.Fit:
    if curve.kind == "curve":
        return fit_modulus(curve.at, curve.values, arms=arms)
    if curve.kind == "creep":
        return fit_creep(
            dp.CreepCompliance(curve.at, curve.values, unit="1/Pa", units="SI"), arms=arms
        )
    return fit_dynamic(dp.DynamicTest(curve.at, *curve.values, unit="Pa", units="SI"), arms=arms)


def _claim_of_curve(curve: curves.Curve, arms: int | str = "auto") -> dict[str, object]:
    result = _curve(curve, arms)
    return evaluate_claim(result, result.model, curve.solid)


def _claim_of_record(record: Record, arms: int | str = "auto") -> dict[str, object]:
    test = dp.RelaxationTest(record.time, record.displacement, record.force, units="SI")
    result = fit(prepare(test, machine=dp.Machine(**record.machine_options)), arms=arms)
    return evaluate_claim(result, result.model_at(record.seal.depth), record.seal)


def judge_claim(claim: Callable[[], dict[str, object]]) -> dict[str, object]:
    """One line of a claim; a refusal claims nothing."""
    start = time.process_time()
    try:
        values = claim()
    except dp.DashpotError as error:
        values = {"use": "refused", "reason": [str(error)]}
    return {**values, "cpu": round(time.process_time() - start, 3)}


def work_of_claims(options: argparse.Namespace) -> Iterator[tuple[dict, Callable[[], dict]]]:
    """Curves with gaps; orders that are forced, too few and enough; headlines of five rigs."""
    count, seed = options.claims, options.seed

    def make_key(group: str, name: str) -> dict:
        return {"group": group, "rig": False, "name": name, "seed": seed}

    def is_selected(group: str) -> bool:
        return bool(re.search(options.only, group))

    for kind in gaps.KINDS if count else ():
        for group, whole in ((f"gaps, {kind}", False), (f"gaps, {kind}, none", True)):
            for forced_order in (
                gaps.generate_gapped_curves(kind, count, seed, whole=whole)
                if is_selected(group)
                else ()
            ):
                yield (
                    make_key(group, forced_order.name),
                    lambda item=forced_order: judge_claim(lambda: _claim_of_curve(item)),
                )
    for kind in forced_orders.KINDS if count else ():
        claim = _claim_of_record if kind == "ramp and hold" else _claim_of_curve
        for forced_order in forced_orders.generate_forced_orders(kind, count, seed):
            for arms in range(1, forced_order.arms + 1):
                few = "enough" if arms == forced_order.arms else "too few"
                if is_selected(group := f"forced, {kind}, {few}"):
                    yield (
                        make_key(group, f"{forced_order.test.name}, {arms} asked"),
                        lambda item=forced_order, arms=arms, claim=claim: judge_claim(
                            lambda: claim(item.test, arms)
                        ),
                    )
    for rig in HEADLINES:
        order = np.random.default_rng([seed, 46, crc32(rig.encode())]).permutation(len(TRUTHS))
        for number in order[:count].tolist() if is_selected(group := f"headline, {rig}") else ():
            record = next(verdict_records([TRUTHS[number]], [rig], seed + 46))
            yield (
                make_key(group, TRUTHS[number].name),
                lambda record=record: judge_claim(lambda: _claim_of_record(record)),
            )


CURVES = {
    "moduli": (curves.moduli, 1),
    "compliances": (curves.compliances, 3),
    "sweeps": (curves.sweeps, 3),
}
FEWEST = 12
"""Values of a curve that was cut."""


def work_of_curves(options: argparse.Namespace) -> Iterator[tuple[dict, Callable[[], dict]]]:
    """Every curve whole, then cut to its first tenth."""
    for kind, (make, part) in CURVES.items():
        for cut in (False, True):
            group = f"{kind}, first tenth" if cut else kind
            if not re.search(options.only, group):
                continue
            for whole in make(options.curves // part, options.seed):
                item = whole.cut() if cut else whole
                if len(item.at) >= FEWEST:
                    name = {"group": group, "rig": False, "name": item.name, "seed": options.seed}
                    yield name, lambda element=item: judge_curve(element)


def judge_curve(curve: curves.Curve) -> dict[str, object]:
    """One line of a curve."""
    start = time.process_time()
    message = curve_ends.evaluate_curve(curve)
    return {**message, "cpu": round(time.process_time() - start, 3)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=Path, nargs="?", help="a line to a record; added to")
    parser.add_argument("--per", type=int, default=10, help="truths to a disturbance, up to 42")
    parser.add_argument("--several", type=int, default=84, help="rigs with several faults at once")
    parser.add_argument("--kinds", type=int, default=20, help="sheets of each other kind")
    parser.add_argument("--conditioned", type=int, default=84, help="seals pressed before")
    parser.add_argument("--curves", type=int, default=300, help="moduli, and thrice the others")
    parser.add_argument("--claims", type=int, default=20, help="of each kind of claim")
    parser.add_argument("--pairs", type=int, default=60, help="seals with a slow arm")
    parser.add_argument("--hammers", type=int, default=20, help="hammer tests of each rig")
    parser.add_argument("--only", default="", help="disturbances and kinds, a regular expression")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--table", type=Path, help="print a kept file and run nothing")
    options = parser.parse_args()
    if options.table is None:
        if options.out is None:
            options.out = Path(tempfile.mkdtemp()) / "verdicts.jsonl"
        expected = lines_of(options.out) if options.out.exists() else []
        done = {(o["group"], o["name"], o["seed"]) for o in expected}
        with options.out.open("a", encoding="utf-8") as out:
            for name, judge in work(options):
                if (name["group"], name["name"], name["seed"]) not in done:
                    out.write(json.dumps({**name, **judge()}) + "\n")
                    out.flush()
    print("\n".join(report(lines_of(options.table or options.out))))


if __name__ == "__main__":
    main()
