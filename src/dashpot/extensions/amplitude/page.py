"""Result page of a fit at several amplitudes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from dashpot import plot
from dashpot.base.arrays import FloatArray
from dashpot.base.number_format import round_to_error
from dashpot.base.progress import send_progress
from dashpot.base.reported_values import ReportedValue
from dashpot.extensions.amplitude.datamodel import AmplitudeFit
from dashpot.extensions.amplitude.fit_files import AmplitudeResult, level_files
from dashpot.extensions.amplitude.hits_by_amplitude import HitLevels
from dashpot.extensions.amplitude.level_prediction import LevelPrediction
from dashpot.extensions.amplitude.level_results import Elements, LevelFit
from dashpot.plot.picture import Picture
from dashpot.plot.plotted_data import select_plot_unit
from dashpot.report import result_output, solid_and_frf_pages
from dashpot.report.result_page import (
    AppCard,
    Group,
    JobPage,
    KindPage,
    Topic,
    format_specimen_header,
    group,
    make_indicators,
    row,
)
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.rate_independent import InParallel
from dashpot.workflow.job import LevelJob

_MIN_RELATIVE_ERROR = 1e-6
"""Smallest relative error of a number."""


def page(levels: AmplitudeResult) -> KindPage:
    """Return the contents of the result page of a fit at several amplitudes."""
    fit = levels.fit
    stiffness_checks = {
        "amplitude_dependence_detected",
        "softening_seen",
        "law_residual_small",
        "levels_residual_small",
        "no_hidden_cubic_spring",
        "machine_deflection_small",
    }
    loss = {"loss_residual_small"}
    topics = [Topic("Record"), Topic("Stiffness", stiffness_checks)]
    if any(check.name in loss for check in levels.checks):
        topics.append(Topic("Damping", loss))
    low, high = fit.amplitudes
    unit_name, scale = select_plot_unit(np.array(fit.amplitudes), "m")
    if isinstance(fit, AmplitudeFit) and fit.amplitude_unit == "strain":
        unit_name, scale = "%", 100.0
    amplitude_fact = (
        "Amplitudes",
        f"{round_to_error(scale * low)} to {round_to_error(scale * high)} {unit_name}",
    )
    frequencies: tuple[tuple[str, str], ...] = ()
    if isinstance(fit, AmplitudeFit):
        text = ", ".join(round_to_error(item) for item in fit.frequency[:4].tolist())
        frequencies = (("Frequency", f"{text} Hz"),)
    picture = plot.level(fit, levels.records)
    return KindPage(
        subject="amplitudes of a hammer or shaker"
        if picture.name == "levels"
        else "amplitude sweep",
        summary_line=(
            *format_specimen_header(getattr(levels.records[0], "specimen", None)),
            *frequencies,
            amplitude_fact,
        ),
        indicators=make_indicators(levels.checks, *topics),
        figure_title="Stiffness and loss with amplitude",
        picture=picture,
        table_title="What amplitude does",
        groups=(group("", list_level_values(levels)),),
        note=format_residual_note(levels),
        sources=tuple(dict.fromkeys(levels.source)),
    )


def prediction_page(prediction: LevelPrediction) -> KindPage:
    """Return the contents of the page of a prediction at several amplitudes."""
    linear_page = solid_and_frf_pages.prediction_page(prediction)
    levels = (
        Group(
            f"At {level.level:.4g} {level.unit}",
            tuple(row(reported_value) for reported_value in level.facts),
        )
        for level in prediction.preloaded
    )
    return replace(linear_page, groups=(linear_page.groups[0], *levels, *linear_page.groups[1:]))


def draw_prediction(prediction: LevelPrediction) -> Picture:
    """Return the picture of a prediction at several amplitudes."""
    names = (f"at {level.level:.4g} {level.unit}" for level in prediction.resonances)
    return result_output.draw_prediction(
        prediction,
        *(level.frf for level in prediction.resonances),
        labels=("predicted at a vanishing amplitude", *names),
        ordered=True,
        intervals=[level.magnitude for level in prediction.preloaded],
    )


def fit_job(job: LevelJob) -> tuple[AmplitudeResult, JobPage]:
    """Fit the files of a job, and return the cards for the app."""
    send_progress(f"fitting {', '.join(Path(path).name for path in job.files)}")
    levels = level_files(**vars(job))
    return levels, JobPage(
        (AppCard("", plot.level(levels.fit, levels.records)),),
        "What amplitude does",
        tuple(list_level_values(levels)),
        levels.source,
        format_residual_note(levels),
    )


def list_level_values(levels: AmplitudeResult) -> list[ReportedValue]:
    """Return the amplitude-dependent quantities, and the resonance at every requested level."""
    fit = levels.fit
    if isinstance(fit, AmplitudeFit):
        return [*_make_law_facts(fit)]
    rows = _make_hit_facts(fit) if isinstance(fit, HitLevels) else _make_level_facts(fit)
    return [*rows, *(row for peak in levels.peaks for row in peak.facts)]


def format_residual_note(levels: AmplitudeResult) -> str:
    """Return a note on the residual of the fit, and on the range of the data."""
    fit = levels.fit
    if isinstance(fit, AmplitudeFit):
        unit_name, scale = _get_amplitude_unit(fit)
        text = f"Leaves {round_to_error(100 * fit.residual, digits=2)} % rms"
        if fit.omitted_samples:
            text += (
                f", less {fit.omitted_samples} samples of the smallest amplitudes, which scatter"
            )
    elif isinstance(fit, HitLevels):
        unit_name, scale = select_plot_unit(np.array(fit.amplitudes), "m")
        text = (
            "Four of five such tests find "
            f"{round_to_error(100 * fit.trend.detectable_stiffness_change, digits=2)} % of "
            f"stiffness and {round_to_error(100 * fit.trend.detectable_damping_change, digits=2)} "
            "% of damping per doubling"
        )
    else:
        unit_name, scale = select_plot_unit(np.array(fit.amplitudes), "m")
        arms, sliders = fit.solid.arms, len(fit.sliders)
        text = (
            f"{arms} arm{'s' * (arms != 1)}, {sliders} slider{'s' * (sliders != 1)}"
            f"{' and a cubic spring' * bool(fit.k3)} leave "
            f"{round_to_error(100 * fit.residual, digits=2)} % of F/X, arms alone "
            f"{round_to_error(100 * fit.linear_residual, digits=2)} %"
        )
    low, high = (round_to_error(scale * end) for end in fit.amplitudes)
    return f"{text}. Nothing is known outside {low} to {high} {unit_name}."


def _make_law_facts(fit: AmplitudeFit) -> Iterator[ReportedValue]:
    """Storage and loss at a vanishing amplitude, and the law's own numbers."""
    letter = "E" if fit.unit == "Pa" else "K"
    for hz, value, error in zip(
        fit.frequency.tolist(), fit.linear.tolist(), fit.linear_se.tolist(), strict=True
    ):
        magnitude = abs(value)
        yield _make_fact(
            f"{letter}′, {hz:.4g} Hz", value.real, error.real, fit.unit, size=magnitude
        )
        yield _make_fact(
            f"{letter}″, {hz:.4g} Hz", value.imag, error.imag, fit.unit, size=magnitude
        )
    error_of = dict(fit.se)
    word, stretch = _get_amplitude_unit(fit)
    if fit.k3:
        # per square of an amplitude it is a number that nobody has seen: what it adds is
        squared_amplitude = 0.75 * fit.amplitudes[1] ** 2
        text = f"cubic spring, at {round_to_error(stretch * fit.amplitudes[1])} {word}"
        yield _make_fact(
            text, squared_amplitude * fit.k3, squared_amplitude * error_of["k3"], fit.unit
        )
    if "lost" not in error_of:
        return
    softening_units = ("1", "%") if fit.law.startswith("factor") else (fit.unit, "")
    yield _make_fact("lost", fit.lost, error_of["lost"], *softening_units)
    text, si = ("strain", "1") if fit.amplitude_unit == "strain" else ("amplitude", "m")
    yield _make_fact(f"half of the softening, {text}", fit.half_way, error_of["half_way"], si, word)
    # one that was set is not known
    yield _make_fact("exponent", fit.exponent, error_of["exponent"] or np.inf, "")


def _make_hit_facts(fit: HitLevels) -> Iterator[ReportedValue]:
    """Yield the change of stiffness and damping for twice the motion."""
    for name, line in (
        ("stiffness per doubling", fit.trend.stiffness_line),
        ("damping per doubling", fit.trend.damping_line),
    ):
        yield _make_fact(name, line.slope, line.se, "1", "%")


def _get_amplitude_unit(fit: AmplitudeFit) -> tuple[str, float]:
    """Return the word and the factor in which an amplitude is read."""
    if fit.amplitude_unit == "strain":
        return "%", 100.0
    return select_plot_unit(np.array(fit.amplitudes), "m")


def _make_fact(
    name: str, value: float, error: float, unit: str, read: str = "", *, size: float = 0.0
) -> ReportedValue:
    """Return a number with its error; `size` is the quantity to which it is relative."""
    error = max(error, _MIN_RELATIVE_ERROR * max(abs(value), size))
    return ReportedValue.from_error(name, value, error, unit=unit, read=read)


def _make_level_facts(fit: LevelFit) -> Iterator[ReportedValue]:
    """Storage and loss factor of one seal at the ends of its amplitudes, mid-band."""
    omega = np.pi * (fit.band[0] + fit.band[1])
    X = np.array(fit.amplitudes)

    def read(solid: GeneralizedMaxwell, elements: Elements) -> FloatArray:
        K = InParallel((solid, *elements)).equivalent(omega, X)
        return np.array((K.real, K.imag / K.real))

    value, (low, high) = read(fit.solid, fit.rate_independent), fit.interval(read)
    for i, (name, unit) in enumerate((("K′", "N/m"), ("loss factor", ""))):
        for j, amplitude in enumerate(X.tolist()):
            unit_name, mm = select_plot_unit(np.array(amplitude), "m")
            text = f"{name}, {round_to_error(mm * amplitude, digits=2)} {unit_name}"
            yield ReportedValue(text, float(value[i, j]), float(low[i, j]), float(high[i, j]), unit)
    if fit.k3:
        unit_name, mm = select_plot_unit(X[1], "m")
        share = 0.75 * X[1] ** 2
        text = f"cubic spring, {round_to_error(mm * X[1], digits=2)} {unit_name}"
        low_end, high_end = (share * end for end in fit.k3_interval)
        yield ReportedValue(text, share * fit.k3, low_end, high_end, "N/m")
