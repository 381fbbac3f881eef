"""Results as text for people: N/mm, mm, Hz, and no more digits than are known."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, TypeAlias

from dashpot.base import numbers
from dashpot.base.numbers import READ_IN, ascii_only
from dashpot.base.units import celsius
from dashpot.cli._terminal import Text

if TYPE_CHECKING:
    from dashpot import Comparison
    from dashpot.base.provenance import Source
    from dashpot.kinds.indentation.from_files import Indentation
    from dashpot.records.fit import Fit
    from dashpot.records.frf import Mode
    from dashpot.records.temperature import TemperatureShifts
    from dashpot.solids.elastic import ElasticLaw
    from dashpot.workflow.impacts import ImpactResult
    from dashpot.workflow.levels import Levels
    from dashpot.workflow.predictions import Prediction, ShakenMass
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


_RESIDUAL = {
    "N": (1e3, "mN rms"), "m": (1e6, "um rms"), "1": (100.0, "% rms"), "sd": (1.0, "of the noise"),
}  # fmt: skip


def fit(found: Fit, *, asked: int | str = "auto") -> Text:
    """Return a fit as the paper's Table 1 with intervals, and what it must not be asked.

    `asked` is the number of arms that was wanted.
    """
    files = ", ".join(source.file for source in found.source) or "arrays in memory"
    arms = f"{found.model.arms} Maxwell arm{'s' * (found.model.arms != 1)}"
    if found.family == "fractional":
        arms = f"fractional Zener solid ({arms} stand for it)"
    residual = found.residual
    scale, unit = _RESIDUAL.get(residual.unit, (1.0, residual.unit))
    size = f"{scale * residual.rms:.3g} {unit}"
    short = asked not in ("auto", found.model.arms) and found.family == "maxwell"
    kept = f", not the {asked} asked for: {found.status.value}" if short else ""
    lines = [
        f"{files}: {arms}, method {found.method}{kept}",
        *_parameters(found),
        "",
        f"  residual    {size} over {residual.n} samples (each worth 1/{residual.kappa:.3g})",
        f"  informed    {hertz(found.band)}; outside it the model is an extrapolation",
    ]
    for section in (
        _creep, _bent, _left_open, _beside, _temperatures, _by_depth, _explained, _moved,
    ):  # fmt: skip
        lines += section(found)
    details = [f"  optimiser   {found.status.value}"]
    if found.certificate:
        details.append(f"  certificate {found.certificate.says}")
    (details if residual.unit == "N" else lines).extend(_nuisance(found))
    return Text(lines, [*details, *_read(found.source), *_orders(found)])


def _bent(found: Fit) -> list[str]:
    """The elastic law, where it is no straight line."""
    law = found.elastic_law
    return [f"  elastic law {_law(law)}"] if law and law.kind != "linear" else []


def _left_open(found: Fit) -> list[str]:
    end = found.end_of_hold
    return [f"  left open   {ascii_only(end.says)}"] if end else []


def _beside(found: Fit) -> list[str]:
    """The other family of solids, unless the verdict has named it."""
    other = found.alternative
    return [f"  beside it   {other.says}"] if other and other.says not in found.verdict.says else []


def _nuisance(found: Fit) -> list[str]:
    listed = "; ".join(
        f"{item.name} {with_error(item.value, item.standard_error)} {item.unit}"
        for item in found.nuisance
    )
    return [f"  nuisance    {listed}"] if listed else []


def _read(sources: Sequence[Source]) -> list[str]:
    """What the readers noticed."""
    return [
        f"  read        {ascii_only(f'{source.file}: {note}')}"
        for source in sources
        for note in source.notes
    ]


def _creep(found: Fit) -> list[str]:
    """The compliances that were fitted to creep, and their times."""
    creep = found.creep
    if creep is None:
        return []
    unit, scale = ("mm/N", 1e3) if found.unit == "N/m" else ("1/MPa", 1e6)
    known = creep.standard_error

    def told(name: str, value: float) -> str:
        return with_error(value, known(name), scale=scale)

    parts = [f"at once {told('glass', creep.spectrum.glass)} {unit}"]
    for i, (d, lam) in enumerate(zip(creep.spectrum.d, creep.spectrum.lam, strict=True), start=1):
        parts.append(f"{told(f'd_{i}', d)} {unit} in {with_error(lam, known(f'lam_{i}'))} s")
    if creep.spectrum.flow > 0:
        parts.append(f"flow {told('flow', creep.spectrum.flow)} {unit} per s, without end")
    return [f"  creep       {'; '.join(parts)}"]


_SHOWN = {"N/m": ("N/mm", "N s/mm", 1e-3), "Pa": ("MPa", "MPa s", 1e-6)}


def _parameters(found: Fit) -> list[str]:
    stiffness, damping, size = _SHOWN.get(found.unit, (found.unit, f"{found.unit} s", 1.0))
    rows = [["", "value", "± SE", "95 % interval", "unit"]]
    end = found.end_of_hold
    if end is not None:
        held = rounded(size * float(found.model.relaxation(end.time)))
        ends = ascii_only(numbers.interval(*(size * limit for limit in end.k_end)))
        rows.append([f"k({rounded(end.time)} s)", held, "", ends, stiffness])
    units = {"k": (stiffness, size), "b": (damping, size), "tau": ("s", 1.0), "alpha": ("", 1.0)}
    for name, value, se, between in _known(found):
        unit, scale = units[re.split("[_ ]", name)[0]]
        rows.append([name, *_cells(value, se, between, scale), unit])
    return table(rows)


_Known: TypeAlias = tuple[str, float, float | None, tuple[float, float] | None]


def _known(found: Fit) -> Iterator[_Known]:
    """Name, value, standard error (None of what was given) and interval of each parameter, SI."""
    model, error, interval = found.model, found.standard_error, found.intervals(level=0.95)
    if found.family == "fractional":
        known, between = found.solid_standard_error, found.solid_intervals()
        for name in ("k_inf", "k_0", "tau", "alpha"):
            yield name, getattr(found.solid, name), known[name], between[name]
        return
    yield "k_inf", model.k_inf, error["k_inf"], interval["k_inf"]
    if not found.parameters:  # a dense spectrum, whose single arms mean nothing
        yield "k_0", model.k_0, math.inf, None
        if model.arms:  # a spectrum may find none
            yield "tau from", model.tau[0], math.inf, None
            yield "tau to", model.tau[-1], math.inf, None
        return
    for j in range(model.arms):
        yield f"k_{j + 1}", model.k[j], error["k"][j], interval["k"][j]
        yield f"tau_{j + 1}", model.tau[j], error["tau"][j], interval["tau"][j]
        yield f"b_{j + 1}", model.arm_b[j], error["b"][j], None
    if model.b > 0:
        yield "b", model.b, None, None


def _cells(
    value: float, se: float | None, ends: tuple[float, float] | None, scale: float
) -> tuple[str, str, str]:
    """A value, its error and its interval."""
    if se is None or not math.isfinite(se):
        return rounded(value * scale), "" if se is None else "unknown", ""
    between = ""
    if ends:
        low, high = (end * scale for end in ends)
        between = ascii_only(numbers.known_between(value * scale, low, high, se * scale))
    return rounded(value * scale, se * scale), rounded(se * scale, se * scale), between


def _temperatures(found: Fit) -> list[str]:
    """Return the law of temperature and the shifts, where several were fitted."""
    moved = found.temperatures
    if moved is None:
        return []
    rows = [["", "log10 a_T", "± SE", "b_T"]]
    rows += [
        [
            celsius(one.temperature),
            rounded(one.log10_a_t, one.se or None),
            rounded(one.se, digits=2) if one.se else "",
            rounded(one.b_t, one.b_t_se or None),
        ]
        for one in moved.shifts
    ]
    return [
        f"  reference   {celsius(moved.reference)}, of {len(moved.shifts)} temperatures; b_T "
        + ("free" if moved.vertical == "free" else f"= {moved.vertical}"),
        f"  law         {_shift_law(moved)}",
        *table(rows),
        *(
            f"  advice      {check.says}"
            for check in found.checks
            if check.name == "shifts_told_apart" and check.failed
        ),
    ]


def _shift_law(moved: TemperatureShifts) -> str:
    """The law of the shifts with its constants, where it has any."""
    errors = moved.law_covariance.diagonal() ** 0.5
    constants = ", ".join(
        f"{_CONSTANTS[name][0]} {with_error(getattr(moved.law, name), error, scale=scale)}{unit}"
        for name, error in zip(moved.law_parameters, errors, strict=True)
        for scale, unit in [_CONSTANTS[name][1:]]
    )
    law = {"wlf": "WLF", "arrhenius": "Arrhenius"}.get(moved.law.kind, "none, the shifts alone")
    return ": ".join(filter(None, (law, constants)))


# how a constant of a law is called, in which size and unit people read it
_CONSTANTS = {"c1": ("C1", 1.0, ""), "c2": ("C2", 1.0, " K"), "energy": ("E_a", 1e-3, " kJ/mol")}


def _by_depth(found: Fit) -> list[str]:
    """Return the stiffnesses of each depth, where each has its own."""
    if not found.by_depth:
        return []
    unit, _, scale = _SHOWN.get(found.unit, (found.unit, "", 1.0))
    # an arm that is nothing at the deepest is no arm of the model
    names = ["k_inf", *(f"k_{j + 1}" for j in range(len(found.by_depth[0].k)))]
    rows = [[f"  by depth, {unit}", *names]]
    for one in found.by_depth:
        known = zip((one.k_inf, *one.k), (one.k_inf_se, *one.k_se), strict=True)
        rows.append(
            [f"  {1e3 * one.depth:.4g} mm", *(with_error(k, se, scale=scale) for k, se in known)]
        )
    return table(rows)


def _moved(found: Fit) -> list[str]:
    """Return what a further test changed, one parameter a row."""
    if not found.moved:
        return []
    rows = [["  moved", "before", "after", "by, in SE before"]]
    for item in found.moved:
        unit, _, scale = _SHOWN.get(item.unit, (item.unit.replace("1", ""), "", 1.0))
        after = f"{rounded(item.after * scale, item.after_se * scale)} {unit}".rstrip()
        if item.before is None:
            rows.append([f"  {item.name}", "-", after, "new"])
            continue
        before = f"{rounded(item.before * scale, (item.before_se or 0.0) * scale)} {unit}".rstrip()
        rows.append([f"  {item.name}", before, after, ascii_only(numbers.signed(item.shift))])
    return table(rows)


def _explained(found: Fit) -> list[str]:
    """Return what would explain two tests that disagree, the best first."""
    return [
        ascii_only(
            f"  explained?  {'yes' if one.explains else 'no'}: {one.says} "
            f"(chi2 falls by {one.fall:.4g})"
        )
        for one in found.explanations
    ]


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


def impact(found: ImpactResult) -> Text:
    """Return the modes, the hits with their verdicts, and why a hit was left out."""
    frf = found.frf
    lines = []
    for mode in found.modes:
        frequency = with_error(mode.frequency_hz, mode.frequency_se_hz)
        ratio = with_error(mode.damping_ratio, mode.damping_ratio_se, scale=100)
        lines.append(f"  mode  {frequency} Hz, damping ratio {ratio} % ({mode.method})")
    used = f"{frf.averages} of {len(frf.hits)} hit{'s' * (len(frf.hits) != 1)} averaged"
    spacing = frf.frequency[1] - frf.frequency[0]
    if frf.kind.over_base:
        used = f"base shaken, worth {frf.averages} averages"
    lines.append(f"{used}, {found.estimator}, {spacing:.4g} Hz between lines")
    if not frf.hits:
        return Text(lines)
    # hits of records that each begin at 0 strike at the same time
    restarts = len({round(hit.time, 3) for hit in frf.hits}) < len(frf.hits)
    rows = [
        ["hit", "s in its record" if restarts else "time, s", "peak, N", "pulse, ms", "verdict"]
    ]
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
    return Text(lines)


def levels(found: Levels) -> Text:
    """Return what moves with amplitude, and the resonance at each level that was asked for."""
    lines = [f"  {line}" for line in found.fit.described[1:]]
    if found.loss_per_lag is not None:
        lines.append(
            f"  1 ms between force and displacement is {1e-3 * found.loss_per_lag:.2g} of the loss "
            f"factor at {found.loss_per_lag / 2 / math.pi:.4g} Hz, whatever the amplitude: loops "
            "of one frequency do not tell it"
        )
    rows = [["level, N", "peak, Hz", "95 %", "motion, mm/N", "95 %", "seal, mm"]]
    for one in found.at:
        low, high = one.frequency_interval
        least, most = one.receptance_interval
        rows.append(
            [
                f"{one.level:.4g}",
                f"{one.frequency:.5g}",
                f"{low:.5g} to {high:.5g}",
                f"{1e3 * one.receptance:.4g}",
                f"{1e3 * least:.4g} to {1e3 * most:.4g}",
                f"{1e3 * one.amplitude:.3g}",
            ]
        )
    return Text([*lines, *(table(rows) if found.at else ()), *_read(found.source)])


def indentation(found: Indentation) -> Text:
    """Return the law of a contact, its numbers with their intervals, and the laws tried."""
    rows = [["", "", "95 %", ""]]
    for one in found.fit.found:
        scale, unit = READ_IN.get(one.unit, (1.0, one.unit))
        low, high = scale * one.low, scale * one.high
        value = scale * one.value
        error = (high - low) / 4
        rows.append(
            [one.name.replace("_", " "), rounded(value, error), f"{low:.4g} to {high:.4g}", unit]
            if one.low > 0
            else [one.name.replace("_", " "), "", f"below {high:.3g}", unit]
        )
    least = min(score for _, score in found.fit.orders)
    tried = ", ".join(f"{name} {score - least:.1f}" for name, score in found.fit.orders)
    return Text([f"  law: {found.fit.law}", *table(rows), f"  BIC above the least: {tried}"])


def comparison(found: Comparison, joint: Comparison | None = None) -> list[str]:
    """Return predicted against measured, and what both tests together make of it."""
    rows = [["", "predicted", "measured", "difference"], *(list(row) for row in found.rows)]
    if joint is not None:
        rows[0] += ["both tests", "difference"]
        for row, (_, fitted, _, difference) in zip(rows[1:], joint.rows, strict=True):
            row += [fitted, difference]
    return [*table(rows), f"  {(joint or found).lines}"]


def study(found: Study) -> Text:
    """Return the seal under the mass and its solid; the fits behind it for who asks."""
    lines, details = [], []
    if found.mass is not None and found.comparison is not None:
        inferred = " (inferred from the FRF)" if found.mass_inferred else ""
        lines.append(f"{found.mass * 1e3:.6g} g{inferred} on {found.seals:g} seals")
        lines += comparison(found.comparison, found.joint_comparison)
        details += ["", "the prediction from the relaxation test alone", str(found.comparison)]
    if found.at_rest is not None and str(found.at_rest):
        lines.append(str(found.at_rest))
    solid = fit(found.fit if found.joint is None else found.joint)
    if lines:
        lines.append("")
    if found.joint is not None:
        lines.append("relaxation and hammer fitted together")
        alone = fit(found.fit)
        details += ["", "the relaxation test alone", *alone.lines, *alone.details]
    return Text([*lines, *solid.lines], [*solid.details, *details])


def prediction(found: Prediction, *, mass: float, seals: float) -> Text:
    """Return a prediction's peak, modes and limits."""
    hz, height = found.peak
    on = f"{mass * 1e3:.6g} g on {seals:g} seal{'s' * (seals != 1)}"
    does = "is largest" if found.at_edge else "peaks"
    kind = found.frf.kind.replace("_", " ")
    lines = [f"{on}: {kind} {does} at {hz:.5g} Hz with {height:.5g} {found.frf.unit}"]
    if found.isolation is not None:
        lines.append(f"  above {found.isolation:.5g} Hz the mass moves less than its base")
    if found.shaken is not None:
        lines += _shaken(found.shaken)
    if found.at_edge:
        lines.append(f"  that is the end of the band, and no peak{_wider(found.modes)}")
    lines += _at_levels(found)
    for mode in found.modes:
        ratio = f"{100 * mode.damping_ratio:.4g} %"
        lines.append(f"  mode  {mode.frequency:.6g} Hz, damping ratio {ratio}")
    if str(found.at_rest):
        lines.append(str(found.at_rest))
    if found.limits is not None:
        lines.append(f"  {ascii_only(found.limits.peak_says)}")
    return Text(lines)


def _at_levels(found: Prediction) -> list[str]:
    """The resonance at each level, and what the first and the last make of it."""
    if found.swept is None or not found.levels:
        return []
    of = found.levels[0]
    rows = [
        [f"level, {of.unit}", "peak, Hz", "between", found.frf.unit or "height", "between", "moved"]
    ]
    for one in found.levels:
        moved = f"{1e3 * one.amplitude:.3g} mm"
        if one.strain is not None:
            moved += f", {100 * one.strain:.3g} %"
        rows.append(
            [
                f"{one.level:.4g}",
                f"{one.frequency:.5g}",
                "{:.5g} to {:.5g}".format(*one.frequency_between),
                f"{one.value:.4g}",
                "{:.4g} to {:.4g}".format(*one.value_between),
                moved,
            ]
        )
    listed = " or ".join(f"{one:.3g}" for one in found.swept.factors)
    says = f"  {' or '.join(found.swept.names)} law of the sweep"
    if of.strain is not None:
        says += f", its strain {listed} of X/height"
    last = found.levels[-1]
    if last is not of:
        change = 100 * (last.frequency / of.frequency - 1)
        says += f"; from first to last the peak moves by {change:+.3g} %"
    return [*table(rows), says]


def _shaken(found: ShakenMass) -> list[str]:
    """What a base that shakes at random does, and at most."""
    band, response = found.band, found.response
    reach = "" if band is None else f" ({band[0]:.4g} to {band[1]:.4g} Hz)"
    does = (
        f"  shaken by {found.of}{reach} the mass feels {response.acceleration:.4g} m/s^2 rms "
        f"and the seals move {1e3 * response.stretch:.4g} mm rms, {response.crossings:.4g} times "
        "a second"
    )
    lines = [does]
    if (limits := found.limits) is not None:
        felt, moved = _reach(limits.acceleration), _reach(limits.stretch, 1e3)
        low, high = limits.band_hz
        part = "" if band is not None else f", to the noise from {low:.4g} to {high:.4g} Hz"
        lines.append(f"  the relaxation test allows {felt} m/s^2 rms and {moved} mm rms{part}")
    return lines


def _reach(ends: tuple[float, float], unit: float = 1.0) -> str:
    """Between which limits something lies; from the lower one on where nothing else limits it."""
    low, high = ends
    most = f"{unit * high:.4g}" if math.isfinite(high) else "unlimited"
    return f"{unit * low:.4g} to {most}"


def _wider(modes: Iterable[Mode]) -> str:
    """The band in which the lowest mode shows its peak."""
    lowest = min((mode.frequency for mode in modes), default=0.0)
    if not lowest > 0:
        return ""
    low, high = (rounded(end, digits=2) for end in (lowest / 4, 4 * lowest))
    return f": add --band {low}:{high}Hz, about the mode at {lowest:.4g} Hz"


def _law(law: ElasticLaw) -> str:
    """The tangent of an elastic law at a few compressions, beside its secant."""
    step = max(1, (len(law.knots) - 1) // 4)
    shown = law.knots[::step]
    each = zip(shown, law.tangent(shown), law.stiffness * law.factor_se(shown), strict=True)
    tangents = ", ".join(
        f"{with_error(1e-3 * k, 1e-3 * se or None)} at {1e3 * x:.3g} mm" for x, k, se in each
    )
    return f"secant {1e-3 * law.stiffness:.4g} N/mm at {1e3 * law.depth:.3g} mm; tangent {tangents}"
