"""Text of each result, in N/mm, mm and Hz with significant digits only."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Protocol

import numpy as np

from dashpot.base import number_format
from dashpot.base.arrays import BoolArray, FloatArray, IndexArray
from dashpot.base.number_format import ascii_only
from dashpot.base.reported_values import UNKNOWN, ReportedValue
from dashpot.base.result_mixins import HasVerdict
from dashpot.base.units import convert_to_unit, format_quantity, get_display_unit
from dashpot.datamodel.fit import (
    get_error_label,
    list_model_values,
    list_reported_nuisances,
    list_undetermined_times,
)
from dashpot.registry import find_handler
from dashpot.text_output.layout import Text, format_values, table

if TYPE_CHECKING:
    from dashpot import Comparison
    from dashpot.base.provenance import Source
    from dashpot.datamodel.fit import Fit
    from dashpot.datamodel.fit_diagnostics import Explanation
    from dashpot.datamodel.frf import Hit, Mode
    from dashpot.datamodel.parameter_estimate import Residual
    from dashpot.solids.elastic import ElasticLaw
    from dashpot.workflow.frf_comparison import FRFComparison
    from dashpot.workflow.frf_prediction import Prediction
    from dashpot.workflow.identification import IdentificationResult
    from dashpot.workflow.measured_frf import ImpactResult
    from dashpot.workflow.study import Study


def format_rounded(value: float, error: float | None = None, *, digits: int = 4) -> str:
    """Return `value` with no more digits than its error supports, as every terminal shows it."""
    return ascii_only(number_format.round_to_error(value, error, digits=digits))


def cell(value: float | None, unit: str, *, digits: int = 4) -> str:
    """Return a value, SI, in a column of a unit, rounded likewise; empty if there is none."""
    return ascii_only(number_format.format_cell(value, unit, digits=digits))


def with_error(value: float, error: float | None, unit: str = "") -> str:
    """Return a value and its error in display units; an error of None is unknown."""
    return ReportedValue.from_error("", value, error, unit=unit).cells.ascii.with_error


def hertz(band: tuple[float, float]) -> str:
    """Return a band of frequencies, rounded likewise."""
    return ascii_only(number_format.hertz(band))


_METHODS = {
    "full": "fitted to ramp and hold",
    "hold": "fitted to the hold",
    "joint": "joint model of all tests",
    "frf": "fitted to the FRF",
}
"""Name of each method in the heading of a fit."""
_UNITS = {"N": "mN", "m": "um", "1": "%"}
"""Display unit of the rms residual, by its SI unit."""


def render_fit(fit: Fit, *, requested_arms: int | str = "auto") -> Text:
    """Return a fit as the paper's Table 1 with intervals, and its limits of use.

    `requested_arms` is the number of arms that was requested.
    """
    residual = fit.estimate.residual
    lines = [_format_fit_heading(fit, requested_arms), *_format_model(fit)]
    if residual.n > 0:  # none of a model without a test
        lines += [
            f"  residual    {_format_rms(residual)}; {_format_sample_count(residual)}",
            f"  valid band  {hertz(fit.band)}",
        ]
    lines += _format_part(fit, fit.evidence.creep)
    for section in (_format_elastic_law, _format_undetermined, _format_alternative):
        lines += section(fit)
    lines += _format_part(fit, fit.temperatures)
    lines += _format_part(fit, next(iter(fit.evidence.stiffness_by_depth), None))
    lines += _format_explanations(fit)
    source_text = (
        " of the one model of all depths, at the deepest" if fit.evidence.stiffness_by_depth else ""
    )
    parameter_lines = (
        [f"every parameter{source_text}", *format_values(list_model_values(fit))]
        if fit.estimate.parameters
        else []
    )
    details = [
        *parameter_lines,
        *_format_parameter_changes(fit),
        f"  optimiser   {fit.status.value}",
    ]
    if fit.evidence.certificate:
        details.append(f"  optimality  {fit.evidence.certificate.message}")
    (details if residual.unit == "N" else lines).extend(_format_nuisances(fit))
    return Text(lines, [*details, *list_notes(fit.source), *_format_orders(fit)])


def _format_part(result: object, part: object) -> list[str]:
    """Return the lines of a part of a result that an extension made."""
    format_part = None if part is None else find_handler("part text", part)
    return [] if format_part is None else list(format_part(result))


def _format_fit_heading(fit: Fit, request: int | str) -> str:
    """Return files, number of arms and method, and whether there are fewer arms than requested."""
    files = ", ".join(source.file for source in fit.source) or "arrays in memory"
    arms = f"{fit.model.arms} Maxwell arm{'s' * (fit.model.arms != 1)}"
    if fit.family == "fractional":
        arms = f"fractional Zener model ({arms} stand for it)"
    elif list_undetermined_times(fit):
        times = ", ".join(f"{tau:.3g} s" for tau in list_undetermined_times(fit))
        arms += f", relaxation time {times} not determined"
    short = request not in ("auto", fit.model.arms) and fit.family == "maxwell"
    text = f", not the {request} asked for: {fit.status.value}" if short else ""
    return f"{files}: {arms}, {_METHODS.get(fit.method, f'method {fit.method}')}{text}"


def _format_rms(residual: Residual) -> str:
    """Return the rms residual, in its unit or as a multiple of the noise."""
    if residual.unit == "sd":
        return f"{residual.rms:.3g} times the noise"
    return f"{format_quantity(residual.rms, _UNITS.get(residual.unit, residual.unit), '.3g')} rms"


def _format_model(fit: Fit) -> list[str]:
    """Return the table of the arms, after values that have an interval and no error."""
    reported_values = {
        reported_value.name: reported_value for reported_value in list_model_values(fit)
    }
    # stiffnesses that each depth has of its own stand there, and nowhere else
    parameter_names = ("tau",) if fit.evidence.stiffness_by_depth else ("k", "tau", "b")
    arms = [
        [reported_values.pop(name) for name in names]
        for j in range(1, fit.model.arms + 1)
        if reported_values.keys() >= set(names := [f"{name}_{j}" for name in parameter_names])
    ]
    if not arms:
        return format_values(list_model_values(fit))
    rows = [["arm"]]
    for text, reported_value in zip(parameter_names, arms[0], strict=True):
        rows[0] += [f"{text}, {reported_value.cells.ascii.unit}", "±"]
    rest = reported_values.get("k_inf")
    if fit.evidence.stiffness_by_depth:
        reported_values.clear()
    elif rest is not None and rest.cells.error:
        rows.append([reported_values.pop("k_inf").label, *_format_value_and_error(rest), *[""] * 4])
    for arm in arms:
        number = arm[0].name.partition("_")[2]
        rows.append(
            [
                number,
                *(
                    cell
                    for reported_value in arm
                    for cell in _format_value_and_error(reported_value)
                ),
            ]
        )
    return [*(format_values([*reported_values.values()]) if reported_values else ()), *table(rows)]


def _format_value_and_error(reported_value: ReportedValue) -> tuple[str, str]:
    """Return value and standard error; replaced by a bound or "not identified"."""
    cells = reported_value.cells.ascii
    if not cells.value:
        return cells.interval, ""
    return cells.value, UNKNOWN if cells.interval == UNKNOWN else cells.error


def _format_sample_count(residual: Residual) -> str:
    """Return the number of samples fitted, and to how many independent ones they are equal."""
    count, effective_count = residual.n, residual.n / residual.variance_inflation
    independent = float(f"{effective_count:.3g}")
    if abs(independent / count - 1) < 0.005:
        return f"{count:,} independent samples"
    return f"{count:,} samples, equal to {independent:,.0f} independent ones"


def _format_elastic_law(fit: Fit) -> list[str]:
    """Return the elastic law if it is nonlinear."""
    law = fit.elastic_law
    if law is None or law.kind == "linear":
        return []
    secant = (
        f"secant {format_quantity(law.stiffness, 'N/mm')} at "
        f"{format_quantity(law.depth, 'mm', '.3g')}; "
    )
    noise = "" if fit.estimate.noise_covariance is None else f" ({get_error_label(fit)})"
    secant_text = "" if fit.evidence.stiffness_by_depth else secant
    return [f"  elastic     {secant_text}tangent{noise} {_format_tangents(law)}"]


_SMALL_CABLE_ERROR = 0.05
"""Error of the loss factor by cables, relative, which needs no line."""


def _format_undetermined(fit: Fit) -> list[str]:
    """Return the limits at the end of the test, and a note on cables without data."""
    end = fit.evidence.end_of_hold
    paragraphs = [end.format_with_remedy(fit.unit)] if end else []
    cables = next((check for check in fit.checks if check.name == "cables_described"), None)
    if cables is not None and cables.passed and (cables.value or 0.0) > _SMALL_CABLE_ERROR:
        advice = "Cables that hang free leave less: cable=0 of the machine"
        if fit.method == "frf":
            advice += ". So do channels with the same coupling: high-pass=0"
        paragraphs.append(f"{cables.message} {advice}")
    labels = ["not known", *[""] * len(paragraphs)]
    return [
        f"  {label:11} {ascii_only(text)}" for label, text in zip(labels, paragraphs, strict=False)
    ]


def _format_alternative(fit: Fit) -> list[str]:
    """Return the other family of solids, unless the verdict has named it."""
    alternative = fit.evidence.alternative
    return (
        [f"  alternative {alternative.message}"]
        if alternative and alternative.message.partition(".")[0] not in fit.verdict.message
        else []
    )


def _format_nuisances(fit: Fit) -> list[str]:
    reported_values = (nuisance.fact for nuisance in list_reported_nuisances(fit))
    values_text = ascii_only(
        ", ".join(f"{value.label} {value.cells.with_unit}" for value in reported_values)
    )
    return [f"  also fitted {values_text}"] if values_text else []


def list_notes(sources: Sequence[Source]) -> list[str]:
    """Return the notes of the readers."""
    return [
        f"  read        {ascii_only(f'{source.file}: {note}')}"
        for source in sources
        for note in source.notes
    ]


def _format_parameter_changes(fit: Fit) -> list[str]:
    """Return the changes by a further test, one parameter a row."""
    if not fit.evidence.parameter_changes:
        return []
    rows = [
        ["  parameter", "before, ± SE of noise", "after, ± SE of noise", "change, in SE before"]
    ]
    for change in fit.evidence.parameter_changes:
        before = "-" if change.was is None else _with_limit(change.was)
        change_text = (
            "new"
            if change.was is None
            else ascii_only(number_format.format_signed_difference(change.shift))
        )
        rows.append([f"  {change.name}", before, _with_limit(change.now), change_text])
    return table(rows)


def _with_limit(reported_value: ReportedValue) -> str:
    """Value, error or upper limit, and unit."""
    cells = reported_value.cells.ascii
    return f"{cells.with_limit} {cells.unit}".rstrip()


def _format_match(explanation: Explanation) -> str:
    if explanation.is_sufficient:
        return "a match"
    return "closer, but no match" if explanation.deviance_fall > 0 else "no match"


def _format_explanations(fit: Fit) -> list[str]:
    """Return the explanations of two tests that disagree, the best first."""
    return [
        ascii_only(
            f"  tried       {explanation.message} ({_format_match(explanation)}; chi-square "
            f"{'falls' if explanation.deviance_fall > 0 else 'rises'} by "
            f"{abs(explanation.deviance_fall):.4g})"
        )
        for explanation in fit.evidence.explanations
    ]


def _format_orders(fit: Fit) -> list[str]:
    if len(fit.evidence.orders) < 2:
        return []
    best = min(order.bic for order in fit.evidence.orders)
    squares = "chi-square" if fit.estimate.residual.unit == "sd" else "SSE"
    rows = [["  arms", squares, "BIC - best", "all arms significant"]]
    rows += [
        [
            f"  {order.arms}{' <' if order.arms == fit.model.arms else ''}",
            f"{order.sse:.6g}",
            f"{order.bic - best:.1f}",
            "yes" if order.significant else "no",
        ]
        for order in fit.evidence.orders
    ]
    return table(rows)


def render_impact(result: ImpactResult) -> Text:
    """Return the modes, the hits with their verdicts, and why a hit was rejected."""
    frf = result.frf
    lines = []
    for mode in result.modes:
        frequency, ratio, _ = (item.cells.ascii.with_unit for item in mode.mode.facts)
        lines.append(
            f"  mode  {frequency}, damping ratio {ratio} "
            f"({mode.method.replace('rational', 'rational-fraction fit')})"
        )
    used_text = f"{frf.averages} of {len(frf.hits)} hit{'s' * (len(frf.hits) != 1)} used"
    spacing = frf.frequency[1] - frf.frequency[0]
    if frf.quantity.over_base:
        used_text = f"base shaken, equal to {frf.averages} averages"
    lines.append(f"{used_text}; {result.estimator}; frequency resolution {spacing:.3g} Hz")
    return Text([*lines, *(_format_hits(frf.hits) if frf.hits else ())])


def _format_hits(hits: Sequence[Hit]) -> list[str]:
    """Return the table of hits with their verdicts, and each reason with the hits it is of."""
    rows = [["hit", "time, s", "peak, N", "pulse width, ms", "verdict"]]
    rows += [
        [
            hit.name,
            f"{hit.time:.3f}",
            f"{hit.peak:.3g}",
            f"{convert_to_unit(hit.duration, 'ms'):.3g}",
            "accepted" if hit.accepted else "REJECTED",
        ]
        for hit in hits
    ]
    lines = [*table(rows)]
    for reason in dict.fromkeys(reason for hit in hits for reason in hit.reasons):
        names = [hit.name for hit in hits if reason in hit.reasons]
        count_text = f"{len(names)} hits, " if len(names) > 1 else ""
        lines.append(f"    {count_text}{', '.join(names)}: {reason}")
    return lines


def render_agreement(result: FRFComparison) -> Text:
    """Return predicted against measured, the static equilibrium, and whether it was inferred."""
    lines = format_comparison(result.comparison)
    if str(result.static_equilibrium):
        lines.append(str(result.static_equilibrium))
    if result.mass_inferred:
        lines.append(
            f"  mass        {format_quantity(result.mass, 'g', '.4g')}, inferred from the measured "
            "FRF: the agreement in frequency then proves nothing; give the mass to test it"
        )
    return Text(lines, [f"  {arm}" for arm in result.comparison.arms])


def format_comparison(comparison: Comparison, joint: Comparison | None = None) -> list[str]:
    """Return the table of predicted and measured values, and those of the joint model."""
    rows = [["", "predicted", "measured", "difference"], *(list(row) for row in comparison.rows)]
    if joint is not None:
        rows[0] += ["joint model", "difference"]
        for row, (_, fitted, _, difference) in zip(rows[1:], joint.rows, strict=True):
            row += [fitted, difference]
    return [*table(rows), f"  {(joint or comparison).lines}"]


def render_study(study: Study) -> Text:
    """Return the mass on its seals and its model; the fits behind it as details."""
    from dashpot.workflow.recommended_solid import recommend_solid  # a fit does without

    lines, details = [], []
    if study.mass is not None and study.comparison is not None:
        inferred = " (found from the FRF)" if study.mass_inferred else ""
        lines.append(
            f"{format_quantity(study.mass, 'g', '.4g' if inferred else '.6g')}{inferred} on "
            f"{number_format.seals(study.seals)}"
        )
        lines += format_comparison(study.comparison, study.joint_comparison)
        details += ["", "prediction from the relaxation test alone", str(study.comparison)]
    if study.static_equilibrium is not None and str(study.static_equilibrium):
        lines.append(str(study.static_equilibrium))
    solid = render_fit(study.fit if study.joint is None else study.joint)
    rows = [["main results", "value", "from", "to", "unit"]]
    for value in recommend_solid(study, allow_rejected=True).values:
        rows.append([value.quantity, *value.fact.cell_texts, value.fact.word])
    details += ["", *table(rows)]
    if study.joint is not None:
        text = render_fit(study.fit)
        details += ["", "relaxation test alone", *text.lines, *text.details]
    return Text([*lines, *solid.lines], [*solid.details, *details])


def render_prediction(prediction: Prediction, levels: Sequence[str] = ()) -> Text:
    """Return a prediction's peak, modes and limits."""
    (hz, height), seals = prediction.peak, prediction.seals
    load_text = f"{format_quantity(prediction.mass, 'g', '.6g')} on {number_format.seals(seals)}"
    peak_name = "largest value" if prediction.is_peak_at_edge else "peak"
    lines = [
        (
            f"{load_text}: {peak_name} of the {prediction.frf.quantity.label} {height:.5g} "
            f"{prediction.frf.read} at {hz:.5g} Hz"
        )
    ]
    if prediction.height_between is not None:
        height_interval = number_format.interval(*prediction.height_between)
        lines.append(f"  95 % limits there {height_interval} {prediction.frf.read}")
    if prediction.isolation is not None:
        lines.append(f"  the mass moves less than its base above {prediction.isolation:.5g} Hz")
    if prediction.random is not None:
        lines += _format_part(prediction, prediction.random)
    if prediction.is_peak_at_edge:
        lines.append(
            f"  This is the end of the band, not a peak.{_format_wider_band(prediction.modes)}"
        )
    lines += levels
    for mode in prediction.modes:
        ratio = f"{100 * mode.damping_ratio:.4g} %"
        lines.append(f"  mode  {mode.frequency:.6g} Hz, damping ratio {ratio}")
    if str(prediction.static_equilibrium):
        lines.append(str(prediction.static_equilibrium))
    if prediction.limits is not None:
        lines.append(f"  {ascii_only(prediction.limits.peak_text)}")
    return Text(lines)


def _format_wider_band(modes: Iterable[Mode]) -> str:
    """Return the band in which the lowest mode shows its peak."""
    lowest_frequency = min((mode.frequency for mode in modes), default=0.0)
    if not lowest_frequency > 0:
        return ""
    low, high = (
        format_rounded(end, digits=2) for end in (lowest_frequency / 4, 4 * lowest_frequency)
    )
    return f" Add --band {low}:{high}Hz for the mode at {lowest_frequency:.4g} Hz."


def _format_tangents(law: ElasticLaw) -> str:
    """Return the tangent of an elastic law at a few compressions."""
    step = max(1, (len(law.knots) - 1) // 4)
    knots = law.knots[::step]
    pairs = zip(knots, law.tangent(knots), law.stiffness * law.factor_se(knots), strict=True)
    return ", ".join(
        f"{with_error(k, se or None, 'N/m')} at {format_quantity(x, 'mm', '.3g')}"
        for x, k, se in pairs
    )


# Storage stiffness and loss factor line by line, with the effect of small errors.


ERRORS = {
    "phase": ("1 deg", "1 degree of phase", float(np.pi / 180)),
    "gain": ("1 %", "1 % of gain", 0.01),
    "mass": ("1 %", "1 % of mass", 0.01),
}
"""Heading, name and size of each error."""


class Measured(Protocol):
    """Storage and loss factor against frequency, such as a rod's modulus or a seal's stiffness."""

    @property
    def frequency(self) -> FloatArray:
        """Hz."""
        ...

    @property
    def storage(self) -> FloatArray:
        """Real part, by line."""
        ...

    @property
    def loss_factor(self) -> FloatArray:
        """Loss factor, by line."""
        ...

    @property
    def storage_sd(self) -> FloatArray:
        """Standard deviation of the real part."""
        ...

    @property
    def loss_factor_sd(self) -> FloatArray:
        """Standard deviation of the loss factor."""
        ...

    @property
    def usable(self) -> BoolArray:
        """Lines that determine both."""
        ...

    def changes(self, name: str, size: float) -> tuple[FloatArray, FloatArray]:
        """Return the changes of storage and loss factor by an error of a kind and size."""
        ...


def render_facts(verdict: HasVerdict) -> Text:
    """Return the values of a result with their intervals, and the notes of the readers."""
    sources = getattr(verdict, "sources", ())
    notes = [f"  read        {source.file}: {note}" for source in sources for note in source.notes]
    return Text(format_values(verdict.facts), ascii_only("\n".join(notes)).splitlines())


def render_summary(result: object) -> Text:
    """Return the summary of a result."""
    return Text(str(result).splitlines())


def format_error_sensitivity(
    measured: Measured, *, errors: tuple[str, ...], unit: str, line_count: int
) -> list[str]:
    """Return a table of lines of the usable band, or of all, with the effect of small errors.

    Parameters
    ----------
    measured : Measured
    errors : tuple of str
        Names in :data:`ERRORS`; none for the lines alone.
    unit : str
        Unit of SI, of the storage.
    line_count : int
        Number of lines.
    """
    pairs = [(ERRORS[name], measured.changes(name, ERRORS[name][2])) for name in errors]
    rows = [["Hz", f"storage, {get_display_unit(unit)}", "loss factor"]]
    for (heading, _, _), _ in pairs:
        rows[0] += [f"{heading}: %", "loss factor"]
    for i in _select_lines(measured, line_count):
        row = [
            format_rounded(float(measured.frequency[i])),
            with_error(float(measured.storage[i]), float(measured.storage_sd[i]), unit),
            with_error(float(measured.loss_factor[i]), float(measured.loss_factor_sd[i])),
        ]
        for _, (storage, loss) in pairs:
            row += [f"{100 * storage[i]:+.2f}", f"{loss[i]:+.4f}"]
        rows.append(row)
    if not errors:
        return table(rows)
    words = ", ".join(ERRORS[name][1] for name in errors)
    return [*table(rows), f"  {words}: change of the storage, %, and of the loss factor"]


def _select_lines(measured: Measured, line_count: int) -> IndexArray:
    """Return lines at even ratios over the usable band."""
    lines = np.flatnonzero(
        measured.usable if measured.usable.any() else np.isfinite(measured.frequency)
    )
    if line_count >= len(lines):
        return lines
    f = measured.frequency[lines]
    low, high = float(f[0]), float(f[-1])
    even_ratios = np.geomspace(low, high, line_count)
    return np.unique(lines[np.abs(f[:, None] - even_ratios).argmin(axis=0)])


# Identified solid, and direct measurements.


_SEAL_COUNT_CHECK = "seals_counted"
"""Check whose failure changes every stiffness shown."""
_SHOWN_LINES = 3
"""Number of shown lines of a transmissibility: both ends of its band, and the middle."""


def render_identification(result: IdentificationResult) -> Text:
    """Return the model, and the measured modes if there is no other fit."""
    model, stiffness = render_fit(result.fit), result.direct.stiffness
    first_lines, lines = list(model.lines[:1]), model.lines[1:]
    if stiffness.over_base:
        first_lines += format_error_sensitivity(
            stiffness, errors=("phase", "mass"), unit="N/m", line_count=_SHOWN_LINES
        )
    assumption_lines = [
        check.message
        for check in result.frf_checks
        if check.failed and check.name == _SEAL_COUNT_CHECK
    ]
    rest_lines = [str(result.static_equilibrium)] if str(result.static_equilibrium) else []
    modes = render_impact(result.vibration) if result.vibration else Text()
    all_lines = [*first_lines, *lines, *assumption_lines, *rest_lines, *modes.lines]
    return Text(all_lines, [*model.details, *modes.details], model.requested_lines)
