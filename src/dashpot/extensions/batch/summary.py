"""Summary of a lot for the page, the command line and programs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import floor, isfinite, sqrt
from typing import Literal, NamedTuple

import numpy as np

from dashpot.base import dataclass
from dashpot.base.checks import GRADES, Check, HasChecks
from dashpot.base.errors import DataError
from dashpot.base.number_format import ascii_only, format_count
from dashpot.base.plain_text import sentence
from dashpot.base.reported_values import ReportedValue
from dashpot.base.serialisation import Key, Serialisable
from dashpot.extensions.batch.acceptance import SealDecision, check_lot_acceptance
from dashpot.extensions.batch.checks import (
    capability_requirement_met,
    charts_in_control,
    few_fits_doubted,
    files_fitted,
    fits_usable,
    frequencies_in_band,
    gauge_discriminates,
    hammers_compared,
    no_lot_outlier,
    records_distinct,
    scatter_normal,
    seals_named,
    seals_within_limits,
    tests_alike,
)
from dashpot.extensions.batch.limits import Limits
from dashpot.extensions.batch.lot import Lot
from dashpot.extensions.batch.quantities import Quantity
from dashpot.extensions.batch.seals import (
    Charts,
    LotCharts,
    Seal,
    average_seals,
    split_seals_by_lot,
)
from dashpot.extensions.batch.statistics.control_chart import OUTSIDE_LIMITS, Chart
from dashpot.extensions.batch.statistics.gauge_rr import Gauge
from dashpot.extensions.batch.statistics.process_capability import Capability
from dashpot.extensions.batch.statistics.variance_components import (
    Component,
    find_outlier_distances,
    robust_distance,
)

_FILES = frozenset(
    criterion.name
    for criterion in (
        few_fits_doubted, files_fitted, fits_usable, hammers_compared, tests_alike,
        records_distinct, seals_named, frequencies_in_band,
    )
)  # fmt: skip
_MEASURING = frozenset({gauge_discriminates.name})
_CONTROL = frozenset(
    criterion.name for criterion in (charts_in_control, no_lot_outlier, scatter_normal)
)


class Flag(NamedTuple):
    """Finding of a lot that needs attention.

    Attributes
    ----------
    lot, seal, file : str
        Lot, seal and file; `file` is empty if the flag concerns the whole seal.
    message : str
    weighty : bool
        Whether it affects the statistics.
    """

    lot: str
    seal: str
    file: str
    message: str
    weighty: bool = True


class ExcludedFile(NamedTuple):
    """File that was excluded from a lot, with the reason."""

    file: str
    reason: str


class LotLight(NamedTuple):
    """One of the four summary lines of a lot's verdict.

    Attributes
    ----------
    name : str
        ``"files"``, ``"measuring"``, ``"control"`` or ``"limits"``.
    mark : str
        ``"good"``, ``"note"``, ``"care"`` or ``"bad"``.
    message : str
    """

    name: str
    mark: str
    message: str

    @property
    def label(self) -> str:
        """Name of the indicator on a page and in a terminal."""
        return _LIGHT_LABELS.get(self.name, self.name)


_LIGHT_LABELS = {"measuring": "gauge R&R", "control": "SPC charts"}


class Signals(NamedTuple):
    """Signals of the control charts of a quantity: causes, signalling points, all points."""

    causes: int
    points: int
    of: int


class LotControlCharts(NamedTuple):
    """Control charts of one lot: seals, moving ranges, and repeats."""

    lot: str
    seals: Chart
    moving_range: Chart
    repeats: Chart | None


@dataclass(frozen=True)
class LotCapability(Serialisable):
    """Process capability of one lot."""

    _keys = ("lot", Key("capability", flatten=True))

    lot: str
    capability: Capability


@dataclass(frozen=True)
class QuantitySummary(Serialisable):
    """Statistics of one quantity.

    Attributes
    ----------
    quantity : Quantity
    seals : tuple of Seal
    charts : dict
        Charts of each lot with two seals.
    lots : LotCharts or None
        The X-bar and s charts of the lots.
    components : tuple of Component
        Empty without repeats.
    gauge : Gauge or None
        None where no seal was tested twice.
    limits : Limits or None
    capability : dict
        Capability of each lot with two seals, where there are limits.
    seal_decisions : tuple of SealDecision
        Judgements of each seal, where there are limits.
    """

    _keys = (
        Key("quantity", "quantity.name"),
        "quantity.column",
        "seals",
        Key("charts", "charts_by_lot"),
        "lots",
        "components",
        "gauge",
        Key("limits", optional=True),
        Key("capability", "capable", optional=True),
        Key("decisions", optional=True),
    )

    quantity: Quantity
    seals: tuple[Seal, ...]
    charts: dict[str, Charts]
    lots: LotCharts | None
    components: tuple[Component, ...]
    gauge: Gauge | None
    limits: Limits | None
    capability: dict[str, Capability]
    seal_decisions: tuple[SealDecision, ...]

    @property
    def charts_by_lot(self) -> tuple[LotControlCharts, ...]:
        """The charts of each lot."""
        items = self.charts.items()
        return tuple(
            LotControlCharts(lot, charts.means, charts.moving, charts.repeats)
            for lot, charts in items
        )

    @property
    def signals(self) -> Signals:
        """Signals of the charts of seals and lots; each run of points is one cause."""
        signals = self.signals_of("seals"), self.signals_of("lots")
        return Signals(*map(sum, zip(*signals, strict=True)))

    def signals_of(self, chart: Literal["seals", "lots"]) -> Signals:
        """Return the signals of the charts of seals in each lot, or of the chart of lots."""
        charts = [chart.means for chart in self.charts.values()]
        if chart == "lots":
            charts = [] if self.lots is None else [self.lots.mean, self.lots.sd]
        return Signals(
            sum(len(chart.causes) for chart in charts),
            sum(len(chart.signalling_points) for chart in charts),
            sum(len(chart.values) for chart in charts),
        )

    @property
    def capable(self) -> tuple[LotCapability, ...] | None:
        """The capability of each lot; None without limits."""
        capabilities = tuple(LotCapability(*item) for item in self.capability.items())
        return None if self.limits is None else capabilities

    @property
    def decisions(self) -> tuple[SealDecision, ...] | None:
        """The judgement of each seal; None without limits."""
        return None if self.limits is None else self.seal_decisions

    @property
    def sources(self) -> tuple[tuple[ReportedValue, str], ...]:
        """The standard deviation of each source of scatter, and its share of the variance, %."""
        return tuple(
            (
                self._deviation(component.source, component.variance, component.interval),
                f"{100 * component.share:.1f}",
            )
            for component in self.components
        )

    def _deviation(
        self, name: str, variance: float, interval: tuple[float, float] | None
    ) -> ReportedValue:
        deviation_interval = None if interval is None else (sqrt(interval[0]), sqrt(interval[1]))
        return self.quantity.fact(name, sqrt(variance), deviation_interval)

    @property
    def capabilities(self) -> dict[str, Capability]:
        """The capability of each lot whose seals scatter."""
        return {
            name: capability
            for name, capability in self.capability.items()
            if capability.cpk is not None
        }

    @property
    def lowest(self) -> tuple[str, Capability] | None:
        """The lot with the lowest Cpk, or the only one."""
        return min(self.capabilities.items(), key=lambda pair: pair[1].cpk or 0.0, default=None)


@dataclass(frozen=True, eq=False)
class Summary(HasChecks, Serialisable):
    """Summary of a lot.

    Attributes
    ----------
    lot : Lot
    main : QuantitySummary
        Results of the quantity that the page shows.
    others : tuple of QuantitySummary
        Results of the further quantities that have limits.
    flags : tuple of Flag
    checks : tuple of Check
    """

    _keys = (
        "verdict",
        Key("summary", "indicators"),
        Key("statistics", "quantities", nonfinite_as_null=True),
        "flags",
        "dissimilar",
        "copies",
        "checks",
    )

    lot: Lot
    main: QuantitySummary
    others: tuple[QuantitySummary, ...]
    flags: tuple[Flag, ...]
    checks: tuple[Check, ...]

    @property
    def quantities(self) -> tuple[QuantitySummary, ...]:
        """The statistics of every quantity, the main one first."""
        return (self.main, *self.others)

    @property
    def _headline(self) -> str:
        """Number of fitted files, mean of the quantity, and signals of its charts."""
        fitted_count, file_count = self.lot.outcomes.get("fitted", 0), self.lot.record_count
        count_text = f"{fitted_count} of {file_count} files were fitted"
        if fitted_count == file_count:
            count_text = (
                f"all {file_count} files were fitted"
                if file_count > 1
                else "the one file was fitted"
            )
        main = self.main
        if len(main.seals) < 2:
            return count_text
        mean = main.quantity.read(float(average_seals(main.seals).mean()))
        return (
            f"{count_text}. {sentence(main.quantity.words)[:-1]}: mean {mean} of {len(main.seals)} "
            f"seals. {_list_alarms(main).capitalize()}"
        )

    @property
    def indicators(self) -> tuple[LotLight, ...]:
        """Files, gauge R&R, control charts and limits: the verdict is the worst of them."""
        main = self.main
        names = {"files": _FILES, "measuring": _MEASURING, "control": _CONTROL}
        checks_by_indicator: dict[str, list[Check]] = {name: [] for name in (*names, "limits")}
        for check in self.checks:
            package = next((name for name, words in names.items() if check.name in words), "limits")
            checks_by_indicator[package].append(check)
        message = {
            "files": self._files, "measuring": _format_gauge(main),
            "control": _format_control(main),
            "limits": _format_limits(main),
        }  # fmt: skip
        return tuple(
            LotLight(
                name,
                _mark(checks, is_certain=bool(message[name])),
                message[name] or _NOT_JUDGED[name],
            )
            for name, checks in checks_by_indicator.items()
        )

    @property
    def _files(self) -> str:
        lot = self.lot
        fitted_count, copies = lot.outcomes.get("fitted", 0), len(lot.copies)
        text = f"{fitted_count} of {lot.record_count} fitted"
        if lot.dissimilar:
            text += f", {len(lot.dissimilar)} tested differently"
        return text + (f", {copies} cop{'y' if copies == 1 else 'ies'}" if copies else "")

    @property
    def copies(self) -> tuple[ExcludedFile, ...]:
        """Files with the same record as another one, which are omitted from the statistics."""
        return tuple(ExcludedFile(*names) for names in self.lot.copies.items())

    @property
    def lines(self) -> list[str]:
        """Lines of text on each quantity: seals, gauge, capability, decisions."""
        return [
            line for quantity_summary in self.quantities for line in _format_lines(quantity_summary)
        ]

    @property
    def dissimilar(self) -> tuple[ExcludedFile, ...]:
        """Files tested under other conditions than the others."""
        return tuple(ExcludedFile(*names) for names in self.lot.dissimilar.items())


def summary(lot: Lot, *, quantity: str = "k_end", limits: Sequence[Limits] = ()) -> Summary:
    """Return the summary of a lot: of a quantity, and of those that have limits.

    Raises
    ------
    DataError
        If no column of numbers is called so.
    """
    main = lot.quantity(quantity)
    # a stiffness and a modulus share a name, and never a column
    requested_limits = {limit.quantity.column: limit for limit in limits}
    first, *other_summaries = [
        _compute_quantity_summary(lot, quantity, requested_limits.get(quantity.column))
        for quantity in (main, *(limit.quantity for limit in limits if limit.quantity != main))
    ]
    flags = tuple(_flag_seals(lot, first))
    checks = (*_run_checks(lot, (first, *other_summaries), flags), *lot.checks)
    return Summary(lot, first, tuple(other_summaries), flags, checks)


def _compute_quantity_summary(
    lot: Lot, quantity: Quantity, limits: Limits | None
) -> QuantitySummary:
    name = quantity.column
    try:
        scatter = lot.components(name)
    except DataError:
        scatter = ()
    try:
        gauge = lot.gauge(name)
    except DataError:
        gauge = None
    capabilities = {} if limits is None else lot.capability(name, limits.lower, limits.upper)
    return QuantitySummary(
        quantity, lot.seals(name), lot.charts(name), lot.lot_chart(name), scatter, gauge,
        limits, capabilities, () if limits is None else check_lot_acceptance(lot, limits),
    )  # fmt: skip


# -- Findings -------------------------------------------------------------------------------------


def _flag_seals(lot: Lot, quantity: QuantitySummary) -> Iterator[Flag]:
    for name, chart in quantity.charts.items():
        yield from _list_outlier_seals(name, chart, quantity.quantity)
    yield from _list_outlier_repeats(quantity)
    rows = lot.table.select("file", "lot", "seal", "outcome", "verdict", "reason").rows()
    test_keys = {file: (name, seal, file) for file, name, seal, *_ in rows}
    for file, message in lot.dissimilar.items():
        yield Flag(*test_keys[file], f"{message}: left out of the statistics")
    for file, other in lot.copies.items():
        yield Flag(*test_keys[file], f"the same record as {other}: left out of the statistics")
    for file, _, _, outcome, verdict, reason in rows:
        if outcome not in {"fitted", "ignored"} or verdict == "do not use":
            message = (reason or outcome).removeprefix(f"{file}: ")
            yield Flag(*test_keys[file], message, weighty=False)


def _list_outlier_seals(name: str, charts: Charts, quantity: Quantity) -> Iterator[Flag]:
    """Yield flags of outlying seals of a lot, then of seals whose repeats scatter."""
    distances, is_outlier = (
        robust_distance(average_seals(charts.seals)),
        find_outlier_distances(average_seals(charts.seals)),
    )
    indices_outside = {index for index, rule in charts.means.signals if rule == OUTSIDE_LIMITS}
    for i, seal in enumerate(charts.seals):
        if is_outlier[i] or i in indices_outside:
            message = _format_distance(
                quantity, seal, float(distances[i])
            ) + f", {OUTSIDE_LIMITS}" * (i in indices_outside)
            yield Flag(name, seal.name, _get_single_value(seal), message)
    if charts.repeats is None:
        return
    typical_text = quantity.read(charts.repeats.centre, digits=2)
    for index, _ in charts.repeats.signals:
        scatter = quantity.read(float(charts.repeats.values[index]), digits=2)
        yield Flag(name, charts.seals[index].name, "", f"its repeats scatter by {scatter}, those "
                   f"of others by {typical_text}: was it mounted anew?")  # fmt: skip


def _get_single_value(seal: Seal) -> str:
    return seal.files[0] if len(seal.files) == 1 else ""


def _format_distance(quantity: Quantity, seal: Seal, distance: float) -> str:
    distance_text = f"{abs(distance):.1f} robust deviations " if isfinite(distance) else ""
    side = _format_side(distance)
    return f"{quantity.read(seal.mean)}, {distance_text}{side} the median seal of its lot"


def _format_side(distance: float) -> str:
    return "above" if distance > 0 else "below"


def _list_outlier_repeats(quantity: QuantitySummary) -> Iterator[Flag]:
    """Yield flags of outlying repeats, by their deviation from the mean of their seal."""
    repeated_seals = [seal for seal in quantity.seals if len(seal.values) > 2]
    if not repeated_seals:
        return
    # of n values about their own mean the deviation is smaller
    standardised = np.concatenate([
        (seal.values - seal.mean) / np.sqrt(1 - 1 / len(seal.values)) for seal in repeated_seals
    ])  # fmt: skip
    files = [(seal, file) for seal in repeated_seals for file in seal.files]
    for (seal, file), distance_of_test, is_outlier in zip(
        files, robust_distance(standardised), find_outlier_distances(standardised), strict=True
    ):
        if is_outlier and isfinite(distance_of_test):
            message = (
                f"{abs(distance_of_test):.1f} robust deviations {_format_side(distance_of_test)} "
                "the other tests of its seal"
            )
            yield Flag(seal.lot, seal.name, file, message)


# -- checks ---------------------------------------------------------------------------------------


def _run_checks(
    lot: Lot, summaries: Sequence[QuantitySummary], flags: Sequence[Flag]
) -> Iterator[Check]:
    for quantity_summary in summaries:
        if quantity_summary.limits is not None:
            yield from _check_limits(quantity_summary, quantity_summary.limits)
    main = summaries[0]
    if main.gauge is not None:
        yield gauge_discriminates(main.gauge)
    kinds: tuple[Literal["seals", "lots"], ...] = ("seals", "lots")
    rows = [(kind, *main.signals_of(kind)) for kind in kinds]
    if any(lot for *_, lot in rows):
        yield charts_in_control([row for row in rows if row[-1]])
    seals = {(flag.lot, flag.seal, flag.file) for flag in flags if flag.weighty}
    yield no_lot_outlier(len(seals), len(summaries[0].seals))
    normal = [component for component in summaries[0].components if component.normal is not None]
    if normal:
        least_normal = min(normal, key=lambda component: component.normal or 0.0)
        yield scatter_normal(least_normal.source, least_normal.normal)
    entries = {frequency: _count_out_of_band(lot, frequency) for frequency in _frequencies(lot)}
    if entries:
        frequencies_out_of_band = [frequency for frequency, count in entries.items() if count]
        yield frequencies_in_band(frequencies_out_of_band, max(entries.values()))


def _check_limits(quantity_summary: QuantitySummary, limits: Limits) -> Iterator[Check]:
    decision_texts = [decision.decision for decision in quantity_summary.seal_decisions]
    yield seals_within_limits(quantity_summary.quantity.words, str(limits), decision_texts)
    if limits.cpk is not None:
        lot_names = {decision.lot for decision in quantity_summary.seal_decisions} or {""}
        unknown_count = len(lot_names) - len(quantity_summary.capabilities)
        yield capability_requirement_met(
            quantity_summary.quantity.words, quantity_summary.lowest, unknown_count, limits.cpk
        )


def _frequencies(lot: Lot) -> tuple[float, ...]:
    """Return the requested frequencies, Hz, by the columns of their loss factors."""
    names = (column for column in lot.table.columns if column.startswith("loss_factor_at_"))
    texts = (name.removeprefix("loss_factor_at_").partition("Hz")[0] for name in names)
    return tuple(sorted({float(text) for text in texts}))


def _count_out_of_band(lot: Lot, frequency: float) -> int:
    """Return how many tests in the statistics have a frequency, Hz, outside their valid band."""
    bands = lot.rows_in_statistics.select("band_low_Hz", "band_high_Hz").drop_nulls().iter_rows()
    return sum(not low <= frequency <= high for low, high in bands)


# -- Indicators ------------------------------------------------------------------------------------


_NOT_JUDGED = {
    "files": "none",
    "measuring": "not known: too few repeats",
    "control": "not known: too few seals",
    "limits": "no limits given",
}
"""Message of an indicator without a result."""


def _mark(checks: Sequence[Check], *, is_certain: bool) -> str:
    failed_grades = [GRADES.index(check.grade) for check in checks if check.failed]
    if not failed_grades:
        return "good" if is_certain and any(check.passed for check in checks) else "note"
    return ("note", "care", "bad")[max(failed_grades)]


def _format_gauge(quantity: QuantitySummary) -> str:
    if quantity.gauge is None:
        return ""
    low, high = (100 * end for end in quantity.gauge["gauge"].share_interval)
    ndc = quantity.gauge.categories
    text = f"{floor(ndc)}" if isfinite(ndc) else "∞"
    return f"R&R {100 * quantity.gauge['gauge'].share:.0f} % ({low:.0f} to {high:.0f}), ndc {text}"


def _format_control(quantity: QuantitySummary) -> str:
    if not quantity.signals.of:
        return ""
    if not quantity.signals.points:
        return f"no alarm in {format_count(len(quantity.charts), 'lot')}"
    signals_by_kind = [
        (quantity.signals_of("seals"), "seals"),
        (quantity.signals_of("lots"), "lots"),
    ]
    points = " and ".join(
        f"{signals.points} of {signals.of} points of {kind}"
        for signals, kind in signals_by_kind
        if signals.points
    )
    return f"{format_count(quantity.signals.causes, 'cause')}: {points}"


def _format_limits(quantity: QuantitySummary) -> str:
    if quantity.limits is None:
        return "no limits given"
    if quantity.lowest is not None and quantity.limits.cpk is not None:
        lot, capability = quantity.lowest
        lot_text = f" in {lot}" if lot and len(quantity.capabilities) > 1 else ""
        return f"Cpk {capability.cells[0]}{lot_text}, asked {quantity.limits.cpk:.2f}"
    passed_count = sum(decision.decision == "pass" for decision in quantity.seal_decisions)
    return f"{passed_count} of {len(quantity.seal_decisions)} seals pass"


# -- Text and documents ----------------------------------------------------------------------------


def _list_alarms(quantity_summary: QuantitySummary) -> str:
    causes = quantity_summary.signals.causes
    alarms = f"{format_count(causes, 'cause')} of control-chart alarms"
    return alarms if causes else "no control-chart alarm"


def _format_lines(quantity_summary: QuantitySummary) -> Iterator[str]:
    if len(quantity_summary.seals) < 2:
        return
    mean = ascii_only(
        quantity_summary.quantity.read(float(average_seals(quantity_summary.seals).mean()))
    )
    yield (
        f"{quantity_summary.quantity.words}: mean {mean} of {len(quantity_summary.seals)} seals in "
        f"{format_count(len(split_seals_by_lot(quantity_summary.seals)), 'lot')}; "
        f"{_list_alarms(quantity_summary)}"
    )
    if quantity_summary.gauge is not None:
        yield f"  gauge R&R   {ascii_only(quantity_summary.gauge.summary)}"
    for name, capability in quantity_summary.capabilities.items():
        yield (
            f"  capability  {capability.summary}, {capability.count} "
            f"seals{f', lot {name}' if name else ''}"
        )
    if quantity_summary.sources:
        yield f"  scatter, standard deviations, {quantity_summary.quantity.unit}:"
    for reported_value, share in quantity_summary.sources:
        value, low, high = map(ascii_only, reported_value.cell_texts)
        interval_text = f" ({low} to {high})" if reported_value.has_interval else ""
        yield f"    {reported_value.name:<9} {value}{interval_text}, {share} % of the variance"
    yield from (
        _format_decision(judge, quantity_summary.quantity)
        for judge in quantity_summary.seal_decisions
        if judge.decision != "pass"
    )


def _format_decision(decision: SealDecision, quantity: Quantity) -> str:
    value = "" if decision.value is None else f", {ascii_only(quantity.read(decision.value))}"
    lot_text = f"{decision.lot} " if decision.lot else ""
    return f"  {decision.decision:<11} {lot_text}seal {decision.seal}{value}"
