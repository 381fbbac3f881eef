"""Criteria on a batch of tests."""

from __future__ import annotations

from collections.abc import Sequence

from dashpot.base.checks import Finding, Grade, Remedy, criterion
from dashpot.base.number_format import format_count
from dashpot.extensions.batch.statistics.control_chart import compute_chance_limit
from dashpot.extensions.batch.statistics.gauge_rr import GOOD_SHARE, LIMIT, Gauge
from dashpot.extensions.batch.statistics.process_capability import Capability
from dashpot.extensions.batch.statistics.variance_components import NOT_NORMAL

MAX_DOUBTED = 0.5
"""Allowed fraction of doubtful fits in a lot."""


@criterion(
    "files without a fit", "<=", 0, "by definition", other_grade="stop where no file was fitted"
)
def files_fitted(unfitted_count: int, files: int) -> Finding:
    """Every file of the batch is a test, and was fitted."""
    return Finding(
        f"{files - unfitted_count} of {files} files are tests that were fitted",
        unfitted_count,
        remedy="Look up the reason of each other file in the table.",
        grade="stop" if files and unfitted_count == files else "limit",
    )


@criterion('fits with the verdict "do not use"', "<=", 0, "by definition")
def fits_usable(unusable: int, fitted_count: int) -> Finding:
    """No fit of a batch has the verdict "do not use"."""
    return Finding(
        f"{unusable} of {fitted_count} fits have the verdict 'do not use'",
        unusable,
        remedy="Look up their reasons in the table.",
    )


@criterion(
    'fits with the verdict "use with care" / fits',
    "<=",
    MAX_DOUBTED,
    "our choice: what most tests share, a mean does not remove",
)
def few_fits_doubted(doubtful_count: int, fitted_count: int) -> Finding:
    """Few fits of a batch have the verdict "use with care"."""
    return Finding(
        f"{doubtful_count} of {fitted_count} fits have the verdict 'use with care'",
        doubtful_count / max(fitted_count, 1),
        "A fault that all tests share is in the mean, too",
        "Look up their reasons in the table.",
    )  # fmt: skip


@criterion("hammer tests not compared", "<=", 0, "by definition")
def hammers_compared(uncompared_count: int, pair_count: int) -> Finding:
    """Every hammer test of the batch was compared with its relaxation test."""
    if not pair_count:
        return Finding("No test of the batch has a hammer test, so none is compared")
    return Finding(
        f"{pair_count - uncompared_count} of {pair_count} hammer tests were compared with their "
        "relaxation tests",
        uncompared_count,
        remedy="Look up the reason of each other one in the table.",
    )


@criterion("tests that differ", "<=", 0, "by definition")
def tests_alike(dissimilar: int, tests: int) -> Finding:
    """Tests of a lot agree in hold and compression to 5 %, and in temperature to 3 K."""
    return Finding(
        f"{format_count(tests, 'test')} under the same conditions",
        dissimilar,
        "The statistics leave them out, and the page names them",
        "Test every seal with the same hold, compression and temperature.",
        f"{dissimilar} of {tests} tests were made under other conditions than the rest",
    )


@criterion("repeated records", "<=", 0, "by definition", grade="note")
def records_distinct(copy_count: int, tests: int) -> Finding:
    """No record is a copy of another."""
    return Finding(
        f"{tests - copy_count} of {tests} fits have records of their own",
        copy_count,
        "The others are copies, and left out of the statistics",
        "Give each record once.",
    )


@criterion(
    "R&R, SD of the gauge / SD of all",
    "<=",
    LIMIT,
    "AIAG, Measurement Systems Analysis, 4th ed.",
    other_grade="stop where all of its interval is above; note where a good gauge may do that",
)
def gauge_discriminates(study: Gauge) -> Finding:
    """The gauge contributes less than 30 % of the total standard deviation."""
    gauge = study["gauge"]
    low, high = gauge.share_interval
    message = (
        f"The SD of the gauge is {100 * gauge.share:.0f} % of all ({100 * low:.0f} to "
        f"{100 * high:.0f})"
    )
    # from a good gauge to none: so few seals show nothing of it
    is_outside = gauge.share > LIMIT and low > GOOD_SHARE
    grade: Grade = "stop" if low > LIMIT else "limit" if is_outside else "note"
    return Finding(
        message,
        high,
        "One test does not judge a seal" if is_outside else "So few tests do not show it",
        "Test every seal several times, and judge by the mean."
        if is_outside
        else "Test more seals.",
        grade=grade,
    )


@criterion("points that break a rule", "<=", None, "simulation: by chance 3 in 200")
def charts_in_control(charts: Sequence[tuple[str, int, int, int]]) -> Finding:
    """The control charts show no more alarms than chance gives.

    Of each kind of chart what its points are, and how many causes, points that break a rule, and
    points there are: lots among themselves are judged apart from the seals of a lot.
    """
    chart_name, causes, points, total = max(
        charts, key=lambda pair: pair[2] / compute_chance_limit(pair[3])
    )
    if not points:
        return Finding(
            f"No point of {sum(chart[3] for chart in charts)} breaks a rule of control", 0
        )
    return Finding(
        f"{points} of {total} points of {chart_name} break a rule of control, in "
        f"{format_count(causes, 'cause')}",
        points,
        "Chance does not do that",
        "Look at the chart: something changed.",
        limit=compute_chance_limit(total),
    )


@criterion("seals that do not pass", "<=", 0, "ISO 14253-1:2017, simple acceptance is not enough")
def seals_within_limits(words: str, limits: str, decisions: Sequence[str]) -> Finding:
    """Every seal lies inside its limits by more than the guard band."""
    counts = {name: decisions.count(name) for name in ("fail", "not proven", "no result")}
    decision_texts = {
        "fail": "outside", "not proven": "inside by less than the guard band",
        "no result": "without a value that is used",
    }  # fmt: skip
    failed_text = ", ".join(
        f"{count} {decision_texts[name]}" for name, count in counts.items() if count
    )
    passed_count, seal_count = decisions.count("pass"), len(decisions)
    return Finding(
        f"{passed_count} of {seal_count} seals pass: {words} {limits}",
        seal_count - passed_count,
        failed_text,
        "Look up those seals in the table.",
    )


@criterion("Cpk", ">=", None, "asked for with the limits",
           other_grade="stop where all of its interval is below")  # fmt: skip
def capability_requirement_met(
    words: str, lowest: tuple[str, Capability] | None, unknown_count: int, target: float
) -> Finding:
    """The Cpk of every lot is known and reaches the required value."""
    if lowest is None or unknown_count:
        return Finding(
            "",
            failure=f"Cpk of {words} is not known of {format_count(unknown_count, 'lot')}; "
            f"{target:.2f} is asked",
            remedy="Test two or more different seals of each lot.",
            limit=target,
            always_fails=True,
        )
    lot, capability = lowest
    low, high = capability.cpk_interval or (0.0, 0.0)
    lot_text = f" of lot {lot}" if lot else ""
    return Finding(
        f"Cpk of {words}{lot_text} is {capability.cpk:.2f} ({low:.2f} to {high:.2f}, "
        f"{capability.count} seals); "
        f"{target:.2f} is asked",
        capability.cpk,
        "" if high >= target else "The seals scatter too much, or lie off centre",
        "Test more seals." if high >= target else "Look at scatter and mean of that lot.",
        limit=target,
        grade="limit" if high >= target else "stop",
    )


@criterion("probability if normal", ">=", NOT_NORMAL, "S. S. Shapiro, M. B. Wilk (1965)",
           grade="note")  # fmt: skip
def scatter_normal(source: str, normal: float | None) -> Finding:
    """The scatter between seals, lots and repeats is normally distributed."""
    if normal is None:
        return Finding("The values are too few to show whether the scatter is normal")
    return Finding(
        f"The values of each {source} would scatter so with a probability of {normal:.2g} if they "
        "were normal",
        normal,
        "The interval of their scatter is Bonett's, which needs no normal values",
        "Test more of each, or look for two kinds among them.",
    )


@criterion("outliers", "<=", 0, "Iglewicz and Hoaglin (1993), for few values wider",
           grade="note")  # fmt: skip
def no_lot_outlier(outlier_count: int, seals: int) -> Finding:
    """No seal of a lot, and no repeat of a seal, is an outlier."""
    return Finding(
        f"{outlier_count} of {seals} seals or their tests differ from the others",
        outlier_count,
        remedy="Look at them.",
    )


@criterion("tests outside their valid band", "<=", 0, "by definition")
def frequencies_in_band(frequencies: Sequence[float], tests: int) -> Finding:
    """The requested frequencies lie inside the valid band of every test."""
    frequencies_text = ", ".join(f"{frequency:g}" for frequency in frequencies)
    return Finding(
        "The frequencies asked for lie in the valid band of every test",
        tests,
        failure=f"{frequencies_text} Hz lies outside the valid band of "
        f"{format_count(tests, 'test')}. Stiffness and loss factor there are extrapolated",
        remedy=Remedy("Add a hammer test, or ramp faster.", "pair"),
    )


@criterion("conditions that differ", "<=", 0, "by definition")
def lots_tested_alike(differences: Sequence[str]) -> Finding:
    """Both lots agree in hold, compression and ramp to 5 %, and in temperature to 3 K."""
    return Finding(
        "The lots were tested alike",
        len(differences),
        failure=f"The lots were not tested alike ({', '.join(differences)}). The tests may cause "
        "the difference",
        remedy="Test both lots alike.",
    )


@criterion("tests without the name of a seal", "<=", 0, "by definition")
def seals_named(unnamed: int, tests: int) -> Finding:
    """Every test states its seal, so that repeats of one seal do not count as several."""
    return Finding(
        f"{tests - unnamed} of {tests} tests name their seal",
        unnamed,
        "Each other one counts as a seal. Intervals are too short if any are repeats",
        Remedy("Name the seals.", "label-pattern"),
    )
