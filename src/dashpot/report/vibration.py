"""Tables of the hammer half: peaks, resonance, arms tested, hits, what moved."""

from __future__ import annotations

import math

from dashpot.base.errors import DashpotError
from dashpot.base.numbers import decibels, duration, percent, readable, rounded, symbol, with_error
from dashpot.records.fit import Fit, Moved
from dashpot.records.frf import FRF
from dashpot.report.tables import Table
from dashpot.vibration.comparison.comparison import Comparison
from dashpot.vibration.modal.modes import model_modes
from dashpot.workflow.study import Study


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
