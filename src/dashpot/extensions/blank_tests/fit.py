"""Properties of a testing machine from all its blank tests together."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import DataError
from dashpot.base.provenance import list_sources
from dashpot.base.reported_values import NORMAL
from dashpot.base.student_t import t_quantile
from dashpot.base.units import Quantity, convert_to_si
from dashpot.datamodel.checks import caution_checks
from dashpot.extensions.blank_tests import checks
from dashpot.extensions.blank_tests.datamodel import (
    SPRING_ERROR,
    BlankCurve,
    BlankTest,
    MachineFit,
    MachineValue,
)
from dashpot.extensions.blank_tests.estimation import (
    Blanks,
    EmptyRun,
    Press,
    RigEstimate,
    estimate_empty_run,
    estimate_press,
    name_record,
)
from dashpot.extensions.blank_tests.roles import AssignedRole, assign_roles

_FIGURE_SAMPLES = 600
"""Samples of a record that its figure shows."""


def fit_blank_tests(
    records: Sequence[BlankTest],
    *,
    spring_stiffness: Quantity | None = None,
    spring_error: float | str | None = None,
) -> MachineFit:
    r"""Return the properties of a testing machine from blank tests.

    A rigid stop gives the compliance :math:`C` and the creep, a spring of stiffness k in a machine
    that reads :math:`K` the gain

    .. math:: g = \frac{1}{k\,(1/K - C_r)}, \qquad C = g\,C_r

    with the compliance :math:`C_r` in readings of the force, and the delay; an empty run noise,
    drift and hum. Errors follow to first order.

    Parameters
    ----------
    records : sequence of BlankTest
    spring_stiffness : float or str, optional
        Stiffness of the spring, N/m or ``"1N/mm"``; without it there is no gain.
    spring_error : float or str, optional
        Its relative standard error, such as ``"0.1%"``, by default that.

    Raises
    ------
    DataError
        If the role of a record is unknown, or a record is incomplete for its role.
    """
    stiffness = convert_to_si(spring_stiffness, "stiffness")
    relative_error = convert_to_si(spring_error, "strain")
    if stiffness is not None and not 0 < stiffness < math.inf:
        raise DataError(
            f"spring stiffness = {stiffness:.4g} N/m; expected a number above 0, such as 1N/mm"
        )
    if relative_error is not None and not 0 <= relative_error < 0.5:
        raise DataError(
            f"uncertainty of the spring = {relative_error:.4g}; expected 0 to 0.5, such as 0.1%"
        )
    if relative_error is not None and stiffness is None:
        raise DataError(
            "an uncertainty of the spring is given without its stiffness. Give it: "
            "--spring-stiffness 1N/mm"
        )
    relative_error = SPRING_ERROR if relative_error is None else relative_error
    _refuse_duplicates(records)
    roles = assign_roles(records, stiffness)
    blanks = estimate_blanks(records, roles)
    values = report_values(blanks, stiffness, relative_error)
    has_spring = stiffness is not None and bool(blanks.spring_presses)
    sources = list_sources(records)
    return MachineFit(
        values,
        tuple(map(_thin_record, records, roles, blanks.in_record_order)),
        stiffness if has_spring else None,
        relative_error if has_spring else None,
        predict_drift(blanks),
        max((abs(press.curvature.value) for press in blanks.stop_presses), default=0.0),
        (*checks.run_checks(blanks, values), *caution_checks(sources)),
        sources,
    )


def _refuse_duplicates(records: Sequence[BlankTest]) -> None:
    """Refuse one record given twice, which would count as two measurements."""
    for i, record in enumerate(records):
        if any(
            np.array_equal(record.time, other.time) and np.array_equal(record.force, other.force)
            for other in records[:i]
        ):
            raise DataError(
                f"{name_record(record)} holds a record that was given before: it counts once. "
                "Leave it out"
            )


def estimate_blanks(records: Sequence[BlankTest], roles: Sequence[AssignedRole]) -> Blanks:
    """Return the estimates of every record.

    Raises
    ------
    DataError
        If a record is incomplete for its role; the sentence names it.
    """
    series = tuple(map(_estimate_record, records, roles))
    pairs = list(zip(series, roles, strict=True))
    presses = [(estimate, role.role) for estimate, role in pairs if isinstance(estimate, Press)]
    return Blanks(
        tuple(estimate for estimate, role in presses if role == "stop"),
        tuple(estimate for estimate, role in presses if role == "spring"),
        tuple(estimate for estimate in series if isinstance(estimate, EmptyRun)),
        series,
    )


def _estimate_record(record: BlankTest, role: AssignedRole) -> Press | EmptyRun:
    try:
        if role.role == "empty":
            return estimate_empty_run(record)
        return estimate_press(record, spring=role.role == "spring")
    except DataError as error:
        name = name_record(record)
        text = str(error)
        raise DataError(text if text.startswith(name) else f"{name}: {text}") from None


def combine_estimates(estimates: Sequence[RigEstimate]) -> RigEstimate | None:
    r"""Return the weighted mean of repeats; None if there are none.

    Its error is scaled by :math:`\sqrt{\chi^2/(n - 1)}` if they scatter more than their errors.
    """
    if not estimates:
        return None
    value, error = np.array(estimates).T
    weights = 1 / np.maximum(error, 1e-300) ** 2
    mean = float(weights @ value / weights.sum())
    scatter_ratio = float(weights @ (value - mean) ** 2) / max(len(value) - 1, 1)
    return RigEstimate(mean, float(np.sqrt(max(scatter_ratio, 1.0) / weights.sum())))


def report_values(
    blanks: Blanks, stiffness: float | None, relative_error: float
) -> tuple[MachineValue, ...]:
    """Return the numbers of the machine that these records give, each with its 95 % interval."""
    stop = combine_estimates([press.stiffness for press in blanks.stop_presses])
    spring = combine_estimates([press.stiffness for press in blanks.spring_presses])
    compliance = None if stop is None else RigEstimate(1 / stop.value, stop.error / stop.value**2)
    gain = None
    if compliance is not None and spring is not None and stiffness is not None:
        gain = _compute_gain(compliance, spring, stiffness, relative_error)
        if gain is not None:
            # m in a newton of force, not of its reading
            error = np.hypot(gain.value * compliance.error, compliance.value * gain.error)
            compliance = RigEstimate(compliance.value * gain.value, float(error))
    creep = combine_estimates(
        [press.creep for press in blanks.stop_presses or blanks.spring_presses]
    )
    delay = combine_estimates(
        [press.delay for press in blanks.spring_presses or blanks.stop_presses]
    )
    noise = combine_estimates([run.noise for run in blanks.empty_runs])
    drift = combine_estimates([run.drift for run in blanks.empty_runs])
    rows = (
        ("compliance", compliance, "m/N", "um/N"), ("creep", creep, "m", "um"),
        ("gain", gain, "", ""), ("delay", delay, "s", "ms"), ("noise", noise, "N", "mN"),
        ("drift", drift, "N/s", "mN/s"),
    )  # fmt: skip
    return (
        *(
            MachineValue.from_error(name, *entry, unit=unit, read=display_unit, words=name)
            for name, entry, unit, display_unit in rows
            if entry is not None
        ),
        *_report_hum(blanks.empty_runs),
    )


def _compute_gain(
    compliance: RigEstimate, spring: RigEstimate, stiffness: float, relative_error: float
) -> RigEstimate | None:
    """Return the gain of the force over the displacement; None without a spring."""
    spring_compliance = 1 / spring.value - compliance.value
    if not spring_compliance > 0:
        return None
    gain = 1 / (stiffness * spring_compliance)
    error = math.hypot(spring.error / spring.value**2, compliance.error) / spring_compliance
    return RigEstimate(gain, gain * math.hypot(error, relative_error))


def _report_hum(empty_runs: Sequence[EmptyRun]) -> tuple[MachineValue, ...]:
    """Return amplitude and frequency of the strongest line, or an upper limit."""
    if not empty_runs:
        return ()
    strongest = max(empty_runs, key=lambda run: run.hum.value)
    value, error = strongest.hum
    if math.isnan(strongest.hum_frequency):
        upper_limit = value + NORMAL * error
        return (MachineValue("hum", value, 0.0, upper_limit, "N", error, "mN", "hum"),)
    return (
        MachineValue.from_error("hum", value, error, unit="N", read="mN", words="hum"),
        MachineValue("hum_frequency", strongest.hum_frequency, unit="Hz", words="hum frequency"),
    )


def predict_drift(blanks: Blanks) -> float | None:
    r"""Return the standard deviation of a drift to come, N/s; None without an empty run.

    That of n drifts :math:`d_i` seen, of mean zero: :math:`\sqrt{\overline{d^2}}\,t_n/1.96` with
    Student's quantile at 95 %.
    """
    if not blanks.empty_runs:
        return None
    drifts = [run.drift for run in blanks.empty_runs]
    limit = max(max(abs(value), 6 * error) for value, error in drifts) / 2
    drifts += [press.drift for press in blanks.presses if press.drift.error <= limit]
    size = math.sqrt(sum(value**2 + error**2 for value, error in drifts) / len(drifts))
    return size * t_quantile(0.95, len(drifts)) / NORMAL


def _thin_record(record: BlankTest, role: AssignedRole, estimate: Press | EmptyRun) -> BlankCurve:
    """Return a record as its figure shows it."""
    count = max(len(record.time) // _FIGURE_SAMPLES, 1)
    time, x = record.time - record.time[0], record.displacement

    def thin(values: FloatArray) -> FloatArray:
        return np.ascontiguousarray(values[::count])

    return BlankCurve(
        role.role, name_record(record), role.reason, thin(time), thin(x - x[0]),
        thin(estimate.force), thin(estimate.fitted),
    )  # fmt: skip
