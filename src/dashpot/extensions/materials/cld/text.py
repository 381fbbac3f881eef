"""Compression load deflection, as text."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from dashpot.base.number_format import ascii_only
from dashpot.base.units import convert_to_unit, format_quantity, get_display_unit
from dashpot.extensions.materials.cld.datamodel import (
    CLD,
    ProcessCapability,
    RateLaw,
    RelaxedLaw,
    format_hysteresis,
)
from dashpot.extensions.materials.cld.fit_files import CLDResult
from dashpot.text_output import results
from dashpot.text_output.layout import Text, table
from dashpot.text_output.results import cell, format_rounded, with_error

if TYPE_CHECKING:
    from dashpot.extensions.materials.cld.fit_files import SpecimenStatistics


def cld(result: CLDResult) -> Text:
    """Return the figures of each specimen and their scatter; every cycle in the details."""
    lines, details = [], []
    for specimen in result.specimens:
        name = "" if specimen.source is None else specimen.source.file
        lines += [
            f"{name}: cycle {specimen.cycle.number} of {len(specimen.cycles)}",
            *_format_specimen(specimen),
        ]
        details += [f"{name}, every cycle", *_format_cycles(specimen)]
    if result.scatter:
        scatter = [f"{len(result.specimens)} specimens", *_format_scatter(result.scatter)]
        # a row for each specimen is shorter than a block
        lines = [
            *(_format_overview(result) if len(result.specimens) > _MAX_SPECIMENS else lines),
            *scatter,
        ]
    lines += _format_capability(result.capability)
    if result.fit is not None and result.relaxed is None:
        fit_text = results.render_fit(result.fit)
        lines = [*_format_overview(result), *fit_text.lines]
        details += fit_text.details
    if result.rate is not None:
        lines += [_format_choice(result.rate)]
        # of a law that explains the speeds worse the numbers are for who asks
        (details if result.rate.bic > 0 else lines).extend(_format_rate(result.rate))
    if result.relaxed is not None:
        lines += _format_relaxed_law(result.relaxed, result.specimens[0])
    return Text(lines, details)


def _format_scatter(statistics: Sequence[SpecimenStatistics]) -> list[str]:
    rows = [["", "mean", "SD", "CV, %", "unit"]]
    for statistic in statistics:
        unit = get_display_unit(statistic.unit) or "%"
        cv = format_rounded(100 * statistic.deviation / statistic.mean) if statistic.mean else ""
        numbers = (
            format_rounded(convert_to_unit(value, unit))
            for value in (statistic.mean, statistic.deviation)
        )
        rows.append([statistic.name, *numbers, cv, unit])
    return table(rows)


def _format_capability(capability: ProcessCapability | None) -> list[str]:
    if capability is None or capability.cpk is None:
        return []
    return [f"  {capability.summary}, {capability.outside} of {capability.count} outside"]


def _format_choice(rate: RateLaw) -> str:
    comparison = "better" if rate.bic < 0 else "worse"
    return (
        f"  A spring and a dashpot that depend on compression explain the speeds {comparison} than "
        f"one relaxation function (BIC {rate.bic:+.3g})."
    )


def _format_rate(rate: RateLaw) -> list[str]:
    rows = [["F_e + c(x) v, mm", "force, N", "tangent, N/mm", "c, N s/m"]]
    for knot in rate.knots[1:]:
        c, error = rate.c(knot)
        law, k = rate.law, rate.law.stiffness
        stiffness, stiffness_se = (
            float(k * function(knot)) for function in (law.factor, law.factor_se)
        )
        rows.append(
            [
                cell(knot, "mm"),
                format_rounded(float(law.force(knot))),
                with_error(stiffness, stiffness_se, "N/m"),
                with_error(c, error) if c > 2 * error else f"below {c + 2 * error:.2g}",
            ]
        )
    arms = ", ".join(
        f"{with_error(k, se, 'N/m')} N/mm over {with_error(tau, tau * relative_se)} s"
        for k, tau, se, relative_se in zip(rate.k, rate.tau, rate.k_se, rate.ln_tau_se, strict=True)
    )
    return [*table(rows), f"  arms in parallel: {arms or 'none'}"]


def _format_relaxed_law(curve: RelaxedLaw, result: CLD) -> list[str]:
    law = curve.law
    rows = [["relaxed, mm", "force, N", "secant, N/mm", "tangent, N/mm"]]
    for mark in (at.compression for at in result.limit_marks):
        tangent, error = (
            float(law.stiffness * function(mark)) for function in (law.factor, law.factor_se)
        )
        rows.append(
            [
                cell(mark, "mm"),
                with_error(float(law.force(mark)), curve.force_se(mark)),
                cell(float(law.secant(mark)), "N/mm"),
                with_error(tangent, error, "N/m"),
            ]
        )
    text = f"  softer than cycle 1 by {100 * curve.softening:.3g} % without relaxation"
    if curve.residual_hysteresis is not None and curve.hysteresis is not None:
        text += (
            f"; hysteresis {100 * curve.residual_hysteresis:.2g} % instead of "
            f"{100 * curve.hysteresis:.3g} %"
        )
    return [*table(rows), text]


_MAX_SPECIMENS = 2
"""Largest number of specimens that are shown one by one."""


def _format_overview(result: CLDResult) -> list[str]:
    rows = [["", "mm/s", f"{result.unit} at nominal", "hysteresis, %", "set, mm"]]
    for specimen in result.specimens:
        loss_ratio = specimen.cycle.hysteresis
        rows.append(
            [
                "" if specimen.source is None else specimen.source.file,
                cell(specimen.cycle.speed, "mm/s"),
                with_error(
                    specimen.per * specimen.nominal.loading,
                    specimen.per * specimen.nominal.loading_se,
                ),
                cell(loss_ratio, "%", digits=3),
                cell(specimen.set, "mm", digits=3),
            ]
        )
    return table(rows)


def _format_specimen(result: CLD) -> list[str]:
    per_length, of = result.per, result.unit.removeprefix("N")
    rows = [["compression, mm", f"loading, {result.unit}", "unloading", f"slope, N/mm{of}",
             f"energy, mJ{of}"]]  # fmt: skip
    for mark in result.limit_marks:
        unloading_text = (
            "" if mark.unloading is None else format_rounded(per_length * mark.unloading)
        )
        rows.append(
            [
                cell(mark.compression, "mm"),
                with_error(per_length * mark.loading, per_length * mark.loading_se),
                unloading_text,
                with_error(per_length * mark.slope, per_length * mark.slope_se, "N/m"),
                cell(per_length * mark.energy, "mJ"),
            ]
        )
    cycle, sentences = result.cycle, []
    if cycle.hysteresis is not None and cycle.recovered_energy is not None:
        sentences.append(
            f"hysteresis {ascii_only(format_hysteresis(cycle))} of "
            f"{format_quantity(per_length * cycle.energy, 'mJ')}{of}"
        )
    if len(result.cycles) > 1:
        sentences.append(f"softer than cycle 1 by {100 * result.softening:.3g} %")
    if result.set is not None:
        sentences.append(f"set {format_quantity(result.set, 'mm', '.3g')} at the next contact")
    if cycle.speed is not None:
        sentences.append(format_quantity(cycle.speed, "mm/s"))
    if result.time is not None:
        quantity = format_quantity(result.delay_sd, "ms", ".3g")
        sentences.append(
            f"the errors include a delay of 0 ± {quantity} (dashpot fit --machine sync=0.1ms)"
        )
    return [*table(rows), f"  {'; '.join(sentences)}"] if sentences else table(rows)


def _format_cycles(result: CLD) -> list[str]:
    rows = [
        [
            "cycle",
            "depth, mm",
            "peak, N",
            "loading, mJ",
            "unloading, mJ",
            "hysteresis, %",
            "contact, mm",
        ]
    ]
    for cycle in result.cycles:
        hysteresis, recovered_energy = cycle.hysteresis, cycle.recovered_energy
        rows.append(
            [
                str(cycle.number),
                cell(cycle.depth, "mm"),
                format_rounded(cycle.peak),
                cell(cycle.energy, "mJ"),
                cell(recovered_energy, "mJ"),
                cell(hysteresis, "%"),
                cell(cycle.contact, "mm"),
            ]
        )
    return table(rows)
