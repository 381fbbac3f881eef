"""Results as text for people: N/mm, mm, Hz, and no more digits than are known."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from dashpot.base import numbers
from dashpot.base.numbers import ascii_only
from dashpot.cli._shell import failed

if TYPE_CHECKING:
    from dashpot.base.checks import Check, Verdict
    from dashpot.records.fit import Fit
    from dashpot.records.frf import FRF, Mode
    from dashpot.solids.elastic import ElasticLaw
    from dashpot.workflow.impacts import ImpactResult
    from dashpot.workflow.study import Study


def rounded(value: float, error: float | None = None, *, digits: int = 4) -> str:
    """Return `value` with no more digits than its error supports, as every terminal shows it."""
    return ascii_only(numbers.rounded(value, error, digits=digits))


def with_error(value: float, error: float | None, *, scale: float = 1.0) -> str:
    """Return a value and its error, so too; None is an error that is not known."""
    error = math.nan if error is None else error
    return ascii_only(numbers.with_error(value * scale, error * scale))


def hertz(band: tuple[float, float]) -> str:
    """Return a band of frequencies, so too."""
    return ascii_only(numbers.hertz(band))


def table(rows: Sequence[Sequence[str]], *, left: bool = False) -> list[str]:
    """Return rows of cells as lines of aligned columns: the first, or all, to the left."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = []
    for row in rows:
        cells = [
            cell.ljust(width) if left or i == 0 else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        lines.append(("  " + "  ".join(cells)).rstrip())
    return lines


def fit(found: Fit) -> str:
    """Return a fit as the paper's Table 1 with intervals, and what it must not be asked."""
    files = ", ".join(source.file for source in found.source) or "arrays in memory"
    head = f"{files}: {found.model.arms} Maxwell arm{'s' * (found.model.arms != 1)}, "
    lines = [verdict(found.verdict), head + f"method {found.method}", *_parameters(found), ""]
    residual = found.residual
    lines.append(f"  optimiser   {found.status.value}")
    in_force, relative = found.method in {"full", "hold"}, found.method in {"dynamic", "modulus"}
    size = f"{residual.rms * 1e3:.3g} mN rms" if in_force else f"{residual.rms:.3g} of the noise"
    size = f"{100 * residual.rms:.3g} % rms" if relative else size
    lines.append(
        f"  residual    {size} over {residual.n} samples (each worth 1/{residual.kappa:.3g})"
    )
    lines.append(f"  informed    {hertz(found.band)}; outside it the model is an extrapolation")
    if found.elastic_law and found.elastic_law.kind != "linear":
        lines.append(f"  elastic law {_law(found.elastic_law)}")
    if found.end_of_hold:
        lines.append(f"  left open   {ascii_only(found.end_of_hold.says)}")
    if found.certificate:
        lines.append(f"  certificate {found.certificate.says}")
    if found.nuisance:
        listed = "; ".join(
            f"{item.name} {with_error(item.value, item.standard_error)} {item.unit}"
            for item in found.nuisance
        )
        lines.append(f"  nuisance    {listed}")
    lines += [*_orders(found), *_moved(found), *_explained(found)]
    bad = failed(found.checks)
    lines.append(f"  checks      {counted(found.checks)}")
    return "\n".join(lines + bad)


def verdict(found: Verdict) -> str:
    """Return a verdict and why, as the first line of a result."""
    return ascii_only(f"{found.use}: {found.says}")


def counted(checks: Sequence[Check]) -> str:
    """Return how many checks passed, failed and were not judged."""
    states = [check.passed for check in checks]
    shown = ((True, "passed"), (False, "failed"), (None, "not judged"))
    return ", ".join(f"{states.count(state)} {word}" for state, word in shown if state in states)


_SHOWN = {"N/m": ("N/mm", "N s/mm", 1e-3), "Pa": ("MPa", "MPa s", 1e-6)}


def _parameters(found: Fit) -> list[str]:
    model, error, interval = found.model, found.standard_error, found.intervals(level=0.95)
    stiffness, damping, size = _SHOWN.get(found.unit, (found.unit, f"{found.unit} s", 1.0))
    rows = [["", "value", "± SE", "95 % interval", "unit"]]

    def row(
        name: str,
        value: float,
        se: float,
        *,
        unit: str,
        ends: tuple[float, float] | None = None,
        scale: float = size,
    ) -> None:
        between = ""
        if not math.isfinite(se):
            rows.append([name, rounded(value * scale), "unknown", "", unit])
            return
        if ends:
            low, high = (rounded(end * scale, se * scale) for end in ends)
            between = f"{low} to {high}"
        shown = (rounded(number * scale, se * scale) for number in (value, se))
        rows.append([name, *shown, between, unit])

    end = found.end_of_hold
    if end is not None:
        value = rounded(size * float(model.relaxation(end.time)))
        ends = ascii_only(numbers.interval(*(size * limit for limit in end.k_end)))
        rows.append([f"k({rounded(end.time)} s)", value, "", ends, stiffness])
    row("k_inf", model.k_inf, error["k_inf"], ends=interval["k_inf"], unit=stiffness)
    for j in range(model.arms):
        row(f"k_{j + 1}", model.k[j], error["k"][j], ends=interval["k"][j], unit=stiffness)
        row(
            f"tau_{j + 1}",
            model.tau[j],
            error["tau"][j],
            ends=interval["tau"][j],
            unit="s",
            scale=1,
        )
        row(f"b_{j + 1}", model.arm_b[j], error["b"][j], unit=damping)
    if model.b > 0:
        rows.append(["b", rounded(model.b * size), "", "", damping])
    return table(rows)


def _moved(found: Fit) -> list[str]:
    """Return what a further test changed, one parameter a row."""
    if not found.moved:
        return []
    rows = [["  moved", "before", "after", "by, in SE before"]]
    for item in found.moved:
        unit, _, scale = _SHOWN.get(item.unit, (item.unit, "", 1.0))
        after = f"{rounded(item.after * scale, item.after_se * scale)} {unit}"
        if item.before is None or not item.before_se:
            rows.append([f"  {item.name}", "-", after, "new"])
            continue
        before = f"{rounded(item.before * scale, item.before_se * scale)} {unit}"
        rows.append(
            [f"  {item.name}", before, after, f"{(item.after - item.before) / item.before_se:+.2g}"]
        )
    return table(rows)


def _explained(found: Fit) -> list[str]:
    """Return what would explain two tests that disagree, the best first."""
    if not found.explanations:
        return []
    rows = [["  tests disagree", "chi2 falls by", "explains both"]]
    rows += [
        [f"  {one.says}", f"{one.fall:.4g}", "yes" if one.explains else "no"]
        for one in found.explanations
    ]
    return [ascii_only(line) for line in table(rows)]


def _orders(found: Fit) -> list[str]:
    if len(found.orders) < 2:
        return []
    best = min(order.bic for order in found.orders)
    rows = [["  arms", "SSE", "BIC - best", "all arms significant"]]
    rows += [
        [
            f"  {order.arms}{' <' if order.arms == found.model.arms else ''}",
            f"{order.sse:.6g}",
            f"{order.bic - best:.1f}",
            "yes" if order.significant else "no",
        ]
        for order in found.orders
    ]
    return table(rows)


def impact(found: ImpactResult) -> str:
    """Return the hits with their verdicts, the modes, and what the record cannot support."""
    frf = found.frf
    used = f"{frf.averages} of {len(frf.hits)} hit{'s' * (len(frf.hits) != 1)} averaged"
    lines = [
        f"{used}, {found.estimator}, {frf.frequency[1] - frf.frequency[0]:.4g} Hz between lines"
    ]
    rows = [["hit", "time, s", "peak, N", "pulse, ms", "verdict"]]
    rows += [
        [
            hit.name,
            f"{hit.time:.3f}",
            f"{hit.peak:.3g}",
            f"{hit.duration * 1e3:.3g}",
            "accepted" if hit.accepted else "REJECTED",
        ]
        for hit in frf.hits
    ]
    lines += table(rows)
    lines += [f"    {hit.name}: {reason}" for hit in frf.hits for reason in hit.reasons]
    for mode in found.modes:
        frequency = with_error(mode.frequency_hz, mode.frequency_se_hz)
        ratio = with_error(mode.damping_ratio, mode.damping_ratio_se, scale=100)
        lines.append(f"  mode  {frequency} Hz, damping ratio {ratio} % ({mode.method})")
    return "\n".join(lines + failed(frf.checks))


def study(found: Study) -> str:
    """Return the whole story in a screenful."""
    lines = [verdict(found.verdict), "", fit(found.fit)]
    if found.mass is not None and found.comparison is not None:
        inferred = " (inferred from the FRF)" if found.mass_inferred else ""
        lines += ["", f"{found.mass * 1e3:.6g} g{inferred} on {found.seals:g} seals"]
        lines.append(str(found.comparison))
    if found.at_rest is not None and str(found.at_rest):
        lines.append(str(found.at_rest))
    if found.joint is not None and found.joint_comparison is not None:
        lines += ["", "relaxation and hammer fitted together", fit(found.joint)]
        lines.append(str(found.joint_comparison))
    return "\n".join(lines + failed(found.checks))


def prediction(
    found: Fit,
    frf: FRF,
    modes: Iterable[Mode],
    *,
    peak: tuple[float, float],
    mass: float,
    seals: float,
) -> str:
    """Return a prediction's peak and modes, and whether the test supports them."""
    lines = [
        (
            f"{mass * 1e3:.6g} g on {seals:g} seal{'s' * (seals != 1)}: "
            f"{frf.kind} peaks at {peak[0]:.5g} Hz with {peak[1]:.5g} {frf.unit}"
        )
    ]
    for mode in modes:
        lines.append(
            f"  mode  {mode.frequency:.6g} Hz, damping ratio {100 * mode.damping_ratio:.4g} %"
        )
    low, high = found.band
    if high > 0 and not low <= peak[0] <= high:
        lines.append(
            f"  ! extrapolated: the relaxation test informs {hertz(found.band)}, the peak is at "
            f"{peak[0]:.4g} Hz (a factor {max(peak[0] / high, low / peak[0]):.3g} away); the "
            "damping there is not known from this test"
        )
    return "\n".join(lines)


def _law(law: ElasticLaw) -> str:
    """The tangent of an elastic law at a few compressions, beside its secant."""
    step = max(1, (len(law.knots) - 1) // 4)
    shown = law.knots[::step]
    each = zip(shown, law.tangent(shown), law.stiffness * law.factor_se(shown), strict=True)
    tangents = ", ".join(
        f"{with_error(1e-3 * k, 1e-3 * se or None)} at {1e3 * x:.3g} mm" for x, k, se in each
    )
    return f"secant {1e-3 * law.stiffness:.4g} N/mm at {1e3 * law.depth:.3g} mm; tangent {tangents}"
