"""The tables of the report: cells as text, rounded to what is known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dashpot._arrays import FloatArray
from dashpot.checks import Check
from dashpot.comparison import Comparison
from dashpot.errors import DashpotError
from dashpot.relaxation.fit import Fit, Moved
from dashpot.relaxation.records import RampHold
from dashpot.report.numbers import (
    decibels,
    duration,
    hertz,
    interval,
    percent,
    readable,
    rounded,
    symbol,
    with_error,
    words,
)
from dashpot.solids.band import StiffnessBand
from dashpot.study import Study
from dashpot.vibration.frf import FRF
from dashpot.vibration.modes import model_modes


@dataclass(frozen=True)
class Table:
    """Head and rows; `marks` names a style for a row: "good", "bad", "doubt" or ""."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    marks: tuple[str, ...] = ()
    caption: str = ""

    def mark(self, row: int) -> str:
        """The style of a row."""
        return self.marks[row] if row < len(self.marks) else ""


# -- up front ---------------------------------------------------------------------------------


def key_numbers(study: Study) -> Table:
    """The numbers a reader came for."""
    fit, comparison = study.fit, study.comparison
    error = fit.standard_error
    rows = [
        ("stiffness at rest, k∞, one seal", _stiff(fit.model.k_inf, error["k_inf"]), "N/mm"),
        ("stiffness at once, k₀, one seal", rounded(1e-3 * fit.model.k_0), "N/mm"),
    ]
    for j, (tau, se) in enumerate(zip(fit.model.tau, error["tau"], strict=True), start=1):
        rows.append((f"relaxation time {symbol(f'tau_{j}')}", with_error(tau, se), "s"))
    rows.append(("what the relaxation test can tell", hertz(fit.band).removesuffix(" Hz"), "Hz"))
    if comparison is not None:
        f = comparison.measured_hz
        factor = f / fit.band[1]
        far = f" (extrapolated ×{rounded(factor, digits=2)})" if factor > 1 else ""
        eta = float(fit.model.loss_factor(2 * np.pi * f))
        room = (
            ""
            if study.unseen is None
            else f", left open {_range_at(study.unseen, study.unseen.loss_factor, f)}"
        )
        rows.append((f"loss factor at {rounded(f)} Hz{far}", f"{rounded(eta)}{room}", "–"))
    elif study.prediction is not None and study.mass is not None:
        peak = int(np.argmax(np.abs(study.prediction.value)))
        rows.append(("predicted peak", rounded(study.prediction.frequency[peak], digits=4), "Hz"))
    return Table(("", "value ± standard error", "unit"), tuple(rows))


def peaks(study: Study) -> Table | None:
    """Predicted, measured and joint: frequency, height and damping of the peak."""
    c, joint = study.comparison, study.joint_comparison
    if c is None:
        return None
    head = ["", "measured", "predicted", "difference"]
    rows = [
        ["peak frequency, Hz", _measured_hz(c), rounded(c.predicted_hz, digits=4),
         percent(c.frequency_error)],
        ["peak accelerance, (m/s²)/N", rounded(c.measured_peak), rounded(c.predicted_peak),
         decibels(c.ratio_db)],
        ["damping ratio, %", _measured_damping(c), _damping(c.predicted_damping),
         _relative(c.damping_ratio_error)],
        ["FRAC (1 is alike)", "", rounded(c.frac), ""],
        ["rms difference, dB", "", rounded(c.rms_db), ""],
    ]  # fmt: skip
    if joint is not None:
        head += ["after the joint fit", "difference"]
        rows[0] += [rounded(joint.predicted_hz, digits=4), percent(joint.frequency_error)]
        rows[1] += [rounded(joint.predicted_peak), decibels(joint.ratio_db)]
        rows[2] += [_damping(joint.predicted_damping), _relative(joint.damping_ratio_error)]
        rows[3] += [rounded(joint.frac), ""]
        rows[4] += [rounded(joint.rms_db), ""]
    return Table(tuple(head), tuple(tuple(row) for row in rows))


# -- the bench --------------------------------------------------------------------------------


def test_facts(prepared: RampHold) -> Table:
    """What was done to the seal."""
    steps = np.diff(prepared.time)
    rate = 1 / float(np.median(steps))
    even = float(np.ptp(steps)) < 0.01 / rate
    specimen = prepared.specimen
    rows = [
        ("compression", rounded(1e3 * prepared.depth, digits=4), "mm"),
        ("ramp", rounded(prepared.ramp_time), "s"),
        ("speed", rounded(1e3 * prepared.depth / prepared.ramp_time), "mm/s"),
        ("hold", rounded(prepared.hold_time), "s"),
        ("samples", f"{len(prepared.time)}", ""),
        ("sampling" if even else "sampling, uneven, median", rounded(rate), "Hz"),
        ("force noise (standard deviation)", rounded(1e3 * prepared.force_noise, digits=2), "mN"),
    ]
    if prepared.preload:
        rows.append(("preload at the first sample", rounded(prepared.preload), "N"))
    if specimen.length:
        rows.append(("length under the plate", rounded(1e3 * specimen.length, digits=4), "mm"))
    if specimen.height:
        strain = prepared.depth / specimen.height
        rows.append(("free height", rounded(1e3 * specimen.height, digits=4), "mm"))
        rows.append(("compression / height", rounded(100 * strain, digits=2), "%"))
    if specimen.temperature:
        rows.append(("temperature", f"{specimen.temperature - 273.15:.1f}", "°C"))
    return Table(("", "value", "unit"), tuple(rows))


def halves(table: Table) -> tuple[Table, Table]:
    """A long narrow table as two, to stand side by side."""
    middle = (len(table.rows) + 1) // 2
    return Table(table.head, table.rows[:middle]), Table(table.head, table.rows[middle:])


def coefficients(fit: Fit, length: float | None) -> Table:
    """Table 1 of the paper, with intervals, and per 100 mm of seal if the length is known."""
    model, error, between = fit.model, fit.standard_error, fit.intervals(level=0.95)
    scale = None if length is None else 0.1 / length
    head = ["", "value ± standard error", "95 % interval", "unit"]
    if scale is not None:
        head.append("per 100 mm")
    rows: list[tuple[str, ...]] = []

    def row(
        name: str,
        value: float,
        se: float,
        ends: tuple[float, float],
        unit: str,
        *,
        stiff: bool = True,
    ) -> None:
        f = 1e-3 if stiff else 1.0
        cells = [name, with_error(f * value, f * se), interval(f * ends[0], f * ends[1]), unit]
        if scale is not None:
            each = rounded(f * value * scale, f * se * scale)
            cells.append(f"{each} {unit}" if stiff else "")
        rows.append(tuple(cells))

    row("k∞", model.k_inf, error["k_inf"], between["k_inf"], "N/mm")
    for j in range(model.arms):
        name = f"k_{j + 1}"
        row(symbol(name), model.k[j], error["k"][j], between["k"][j], "N/mm")
    for j in range(model.arms):
        name = f"b_{j + 1}"
        row(symbol(name), model.arm_b[j], error["b"][j], between["b"][j], "N·s/mm")
    for j in range(model.arms):
        name = f"tau_{j + 1}"
        row(symbol(name), model.tau[j], error["tau"][j], between["tau"][j], "s", stiff=False)
    if model.b > 0:
        rows.append(("b", rounded(1e-3 * model.b), "", "N·s/mm", *[""] * (scale is not None)))
    return Table(tuple(head), tuple(rows))


def orders(study: Study) -> Table:
    """One, two and more arms side by side."""
    fit = study.fit
    by_arms = {one.arms: one for one in fit.orders}
    full = {one.model.arms: one for one in (*study.alternatives, fit)}
    best = min((one.bic for one in fit.orders), default=math.nan)
    rows, marks = [], []
    for arms in sorted({*by_arms, *full}):
        score, one = by_arms.get(arms), full.get(arms)
        model = one.model if one is not None else by_arms[arms].model
        rms = one.residual.rms if one is not None else math.sqrt(by_arms[arms].sse / fit.residual.n)
        listed = ", ".join(
            f"{rounded(1e-3 * k)} at {rounded(tau)} s"
            for k, tau in zip(model.k, model.tau, strict=True)
        )
        chosen = arms == fit.model.arms
        rows.append((
            f"{arms}{' (chosen)' if chosen else ''}",
            rounded(1e-3 * model.k_inf, digits=4),
            listed or "none",
            rounded(1e3 * rms),
            rounded(score.bic - best, digits=4) if score else "",
            ("yes" if score.significant else "no") if score else "",
        ))  # fmt: skip
        marks.append("chosen" if chosen else "")
    head = ("arms N", "k∞, N/mm", "arms: k, N/mm at τ", "residual rms, mN", "BIC − best",
            "every arm significant")  # fmt: skip
    return Table(head, tuple(rows), tuple(marks))


def two_routes(fit: Fit, hold: Fit) -> Table | None:
    """The full history against the paper's eq. (5) on the hold; None if their arms differ."""
    if fit.model.arms != hold.model.arms:
        return None
    names = ["k∞", *(symbol(f"k_{j + 1}") for j in range(fit.model.arms))]
    names += [symbol(f"tau_{j + 1}") for j in range(fit.model.arms)]
    units = ["N/mm"] * (1 + fit.model.arms) + ["s"] * fit.model.arms
    both = []
    for one in (fit, hold):
        error = one.standard_error
        both.append([
            *((1e-3 * v, 1e-3 * se) for v, se in zip(
                (one.model.k_inf, *one.model.k), (error["k_inf"], *error["k"]), strict=True)),
            *zip(one.model.tau, error["tau"], strict=True),
        ])  # fmt: skip
    rows = tuple(
        (f"{name}, {unit}", with_error(*a), with_error(*b), percent(b[0] / a[0] - 1))
        for name, unit, a, b in zip(names, units, *both, strict=True)
        if a[0]
    )
    return Table(("", "full history", "hold only, eq. (5)", "difference"), rows)


# -- the solid in frequency -------------------------------------------------------------------


def in_frequency(fit: Fit, unseen: StiffnessBand | None, mark: float | None) -> Table:
    """Stiffness and loss factor of one seal at some frequencies, and whether they are known."""
    low, high = fit.band
    chosen = sorted({low, float(np.sqrt(low * high)), high, 1.0, *([mark] if mark else []), 50.0})
    rows, marks = [], []
    for f in chosen:
        omega = 2 * np.pi * f
        stiffness = fit.model.complex_stiffness(omega)
        factor = max(f / high, low / f)
        known = factor < 1.0001
        cells = [
            rounded(f),
            rounded(1e-3 * float(stiffness.real)),
            rounded(1e-3 * float(stiffness.imag)),
            rounded(float(stiffness.imag / stiffness.real)),
        ]
        if unseen is not None:
            cells.append(_range_at(unseen, 1e-3 * unseen.storage, f))
            cells.append(_range_at(unseen, unseen.loss_factor, f))
        cells.append("identified" if known else f"extrapolated ×{rounded(factor, digits=2)}")
        rows.append(tuple(cells))
        marks.append("" if known else "doubt")
    head = ["frequency, Hz", "storage K′, N/mm", "loss K″, N/mm", "loss factor"]
    if unseen is not None:
        head += ["K′ left open, N/mm", "loss factor left open"]
    return Table((*head, "this test"), tuple(rows), tuple(marks))


def _range_at(band: StiffnessBand, limits: FloatArray, f: float) -> str:
    if not band.frequency[0] <= f <= band.frequency[-1]:
        return "not computed"
    low, high = (float(np.interp(np.log(f), np.log(band.frequency), edge)) for edge in limits)
    return f"{rounded(low, digits=3)} to {rounded(high, digits=3)}"


# -- the hammer -------------------------------------------------------------------------------


def resonance(study: Study) -> Table | None:
    """Natural frequency and damping of the resonance, read in every way the record supports."""
    c, measured = study.comparison, study.measured
    if c is None or measured is None or study.mass is None:
        return None
    ways = {
        "rational": "poles of a record of this length",
        "circle": "Nyquist circle",
        "half-power": "half-power width",
        "decrement": "decay",
        "peak": "highest line and its neighbours",
    }
    rows = [(f"measured: {says}", *_mode_cells(measured, way, c)) for way, says in ways.items()]
    solids = [("model from relaxation", study.fit, study.mass)]
    if study.joint is not None:
        mass = next((n.value for n in study.joint.nuisance if n.name == "mass"), study.mass)
        solids.append(("model from both tests", study.joint, mass))
    for says, one, mass in solids:
        for mode in model_modes(study.seals * one.model, mass)[:1]:
            rows.append((f"{says}: exact pole", rounded(mode.frequency, digits=5),
                         rounded(100 * mode.damping_ratio)))  # fmt: skip
    return Table(("", "natural frequency, Hz", "damping ratio, %"), tuple(rows))


def _mode_cells(measured: FRF, way: str, c: Comparison) -> tuple[str, str]:
    try:
        modes = measured.modes(method=way)
    except DashpotError as refused:
        return "refused", readable(str(refused))
    if not modes:
        return "none found", ""
    # rocking and other modes beside it are not what the prediction is of
    mode = min(modes, key=lambda one: abs(one.frequency - c.measured_hz))
    return (
        with_error(mode.frequency, mode.frequency_se),
        with_error(100 * mode.damping_ratio, 100 * mode.damping_ratio_se),
    )


def arms_tested(comparison: Comparison) -> Table | None:
    """Which arms carried the loss at the measured peak, and who saw them."""
    if not comparison.arms:
        return None
    rows = tuple(
        (
            duration(arm.tau),
            f"{100 * arm.loss_share:.1f}",
            "yes" if arm.loss_share > 0.1 else "hardly",
            "yes" if arm.seen_by_relaxation else "no",
        )
        for arm in comparison.arms
    )
    marks = tuple(
        "bad" if arm.loss_share > 0.1 and not arm.seen_by_relaxation else ""
        for arm in comparison.arms
    )
    head = ("arm's τ", "share of the loss at the peak, %", "tested by this FRF",
            "seen by the relaxation test")  # fmt: skip
    return Table(head, rows, marks)


def hits(frf: FRF) -> Table | None:
    """Every hit and the verdict on it."""
    if not frf.hits:
        return None
    rows = tuple(
        (
            hit.name,
            rounded(hit.time, digits=4),
            rounded(hit.peak),
            rounded(1e3 * hit.duration),
            "accepted" if hit.accepted else "rejected",
            "; ".join(hit.reasons),
        )
        for hit in frf.hits
    )
    marks = tuple("" if hit.accepted else "bad" for hit in frf.hits)
    head = ("hit", "at, s", "peak, N", "pulse, ms", "verdict", "why")
    said = any(hit.reasons for hit in frf.hits)
    return Table(head if said else head[:-1], rows if said else tuple(r[:-1] for r in rows), marks)


def moved(joint: Fit) -> Table | None:
    """What the hammer changed in the solid."""
    if not joint.moved:
        return None
    rows = tuple(_moved_row(one) for one in joint.moved)
    marks = tuple("doubt" if row[-1] == "new" else "" for row in rows)
    return Table(("", "relaxation alone", "both tests", "moved by"), rows, marks)


def _moved_row(m: Moved) -> tuple[str, ...]:
    unit, f = {"N/m": ("N/mm", 1e-3), "N s/m": ("N·s/mm", 1e-3)}.get(m.unit, (m.unit, 1.0))
    name = f"{symbol(m.name)}, {unit}"
    now = with_error(f * m.after, f * m.after_se)
    if m.before is None:
        return name, "", now, "new"
    known = m.before_se is not None
    then = with_error(f * m.before, f * (m.before_se or 0.0)) if known else rounded(f * m.before)
    change = percent(m.after / m.before - 1) if m.before else ""
    spread = math.hypot(m.before_se or 0.0, m.after_se)
    if math.isfinite(spread) and spread > 0:
        change += f" ({rounded(abs(m.after - m.before) / spread, digits=2)} SE)"
    return name, then, now, change


def nuisances(fit: Fit) -> Table | None:
    """What the fit needed and nobody asked for."""
    if not fit.nuisance:
        return None
    people = {"N": ("mN", 1e3), "N/s": ("mN/s", 1e3), "kg": ("g", 1e3), "s": ("ms", 1e3)}
    rows = []
    for term in fit.nuisance:
        unit, f = people.get(term.unit, ("–" if term.unit == "1" else term.unit, 1.0))
        rows.append((term.name, with_error(f * term.value, f * term.standard_error), unit))
    return Table(("", "value ± standard error", "unit"), tuple(rows))


# -- trust ------------------------------------------------------------------------------------


def checks(groups: Sequence[tuple[str, Sequence[Check]]]) -> Table:
    """Every check in words, failed ones first; what two stages said alike is said once."""
    seen: dict[tuple[str, str], tuple[str, Check]] = {}
    for stage, found in groups:
        for check in found:
            seen.setdefault((check.name, check.says), (stage, check))
    ordered = sorted(seen.values(), key=lambda pair: pair[1].passed)
    rows = tuple(
        ("passed" if check.passed else "failed", stage, words(check.name), readable(check.says))
        for stage, check in ordered
    )
    marks = tuple("good" if check.passed else "bad" for _, check in ordered)
    return Table(("", "stage", "question", "answer"), rows, marks)


# -- cells ------------------------------------------------------------------------------------


def _stiff(value: float, se: float) -> str:
    return with_error(1e-3 * value, 1e-3 * se)


def _measured_hz(c: Comparison) -> str:
    if c.measured_hz_se is not None and c.measured_hz_se > 0:
        return with_error(c.measured_hz, c.measured_hz_se)
    return rounded(c.measured_hz, digits=4)


def _measured_damping(c: Comparison) -> str:
    if c.measured_damping is None:
        return "not supported by the record"
    if c.measured_damping_se is not None and c.measured_damping_se > 0:
        return with_error(100 * c.measured_damping, 100 * c.measured_damping_se)
    return rounded(100 * c.measured_damping)


def _damping(value: float | None) -> str:
    return "none" if value is None else rounded(100 * value)


def _relative(value: float | None) -> str:
    return "" if value is None else percent(value)
