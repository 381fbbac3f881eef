"""Tables of the bench half: the seal, the test, its fits, the solid in frequency."""

from __future__ import annotations

import math

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.numbers import hertz, interval, percent, rounded, symbol, with_error
from dashpot.records.bounds import StiffnessBounds
from dashpot.records.fit import Fit
from dashpot.records.relaxation import RampHold
from dashpot.report.tables import Table
from dashpot.workflow.study import Study


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


def in_frequency(fit: Fit, unseen: StiffnessBounds | None, mark: float | None) -> Table:
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


def _range_at(band: StiffnessBounds, limits: FloatArray, f: float) -> str:
    if not band.frequency[0] <= f <= band.frequency[-1]:
        return "not computed"
    low, high = (float(np.interp(np.log(f), np.log(band.frequency), edge)) for edge in limits)
    return f"{rounded(low, digits=3)} to {rounded(high, digits=3)}"


def _stiff(value: float, se: float) -> str:
    return with_error(1e-3 * value, 1e-3 * se)
