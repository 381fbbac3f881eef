r"""Expected errors of a planned relaxation test and hammer test.

The bench is judged by its Cramer-Rao bound. With the ramp known and white noise of standard
deviation sigma, no unbiased fit of :math:`\theta = (k_\infty, k_j, \ln\tau_j)` does better than

.. math::

    C = \sigma^2 (J^T J)^{-1}, \qquad
    \mathrm{sd}(g) = \sqrt{\nabla g^T C\, \nabla g}, \quad g = K', \tan\delta

with J the sensitivities of the force (paper eqs. 1-5) at every sample. What the fit of a recorded
motion must find besides, offset, drift and delay, stands in J too, each with a row 1/sd for what is
known of it before. Undetected effects of machine and climate change the fit, and are included in C
as in the intervals of a fit. An impact record must be long enough for the mass to come to rest, and
its pulse short enough to make it ring.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dashpot.base import dataclass, replace
from dashpot.base.arrays import FloatArray
from dashpot.base.number_format import duration, round_to_error
from dashpot.base.plain_text import paragraph
from dashpot.base.reported_values import NORMAL
from dashpot.base.serialisation import EVERY_FIELD, Serialisable
from dashpot.datamodel.bounds import MAX_DEVIANCE, naming
from dashpot.datamodel.machine import Machine
from dashpot.planning.planned_ramp_hold import Bench, Repeat
from dashpot.registry import require_handler
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.mass_on_seals import accelerance, ringing_pole

# Share of the information below which a direction is not determined.
SINGULAR = 1e-14
# of the machine that is named, s, and what it says to be nothing; its drift the baseline shows
NAMED_BASELINE = 10.0
_NAMED_EFFECTS = ("compliance", "creep")
# Trethewey and Cafeo 1992: six time constants leave less than 0.5 % error in the FRF
TIME_CONSTANTS = 6.0
LINES = 5.0
# places of the lines about the peak that are tried, as parts of a line
LINE_POSITIONS = 21


@dataclass(frozen=True)
class ExpectedError:
    """Expected error of one relaxation test at one frequency.

    Attributes
    ----------
    method : str
        ``"full"`` or ``"hold"``; ``"joint"`` for ramp, hold and a hammer test together.
    ramp_time, hold_time : float
        s.
    storage_sd, loss_factor_sd : float
        Expected standard deviation over the value, dimensionless; infinite if the test does not
        determine it.
    arm_sd : float or None
        Standard deviation of the stiffness of the unresolved arm; None without one.
    repeated : tuple of float
        Temperatures at which the test is repeated, K; all are fitted together.
    """

    method: str
    ramp_time: float
    hold_time: float
    storage_sd: float
    loss_factor_sd: float
    arm_sd: float | None
    repeated: tuple[float, ...] = ()


def expected_error(
    model: GeneralizedMaxwell,
    bench: Bench,
    frequency: float,
    arm: int | None,
    hammer: FloatArray | None = None,
    *,
    repeats: Sequence[Repeat] = (),
) -> ExpectedError:
    """Return the expected error of storage and loss factor at a frequency.

    Parameters
    ----------
    model : GeneralizedMaxwell
        Model of the seal.
    bench : Bench
        The relaxation test.
    frequency : float
        Frequency, Hz.
    arm : int or None
        Index of the unresolved arm.
    hammer : array, optional
        Rows of a hammer test in the same parameters and the mass, for a joint fit.
    repeats : sequence of Repeat
        The same test at other temperatures.
    """
    rows, unmeasured = (
        require_handler("planned rows", "temperatures")(model, bench, repeats)
        if repeats
        else bench.rows(model)
    )
    if hammer is not None:
        parameter_count = hammer.shape[1] - 1
        mass = np.vstack((np.zeros((len(rows), 1)), hammer[:, -1:]))
        extra = np.zeros((len(hammer), rows.shape[1] - parameter_count))
        rows = np.hstack((np.vstack((rows, np.hstack((hammer[:, :-1], extra)))), mass))
        unmeasured = np.pad(unmeasured, ((0, len(hammer)), (0, 0)))
    errors = _compute_errors(rows, unmeasured)
    storage, loss_factor, gradients = _compute_gradients(model, frequency)
    sd = np.linalg.norm(gradients @ errors[: gradients.shape[1]], axis=1)
    return ExpectedError(
        method=bench.method if hammer is None else "joint",
        ramp_time=bench.ramp_time,
        hold_time=bench.hold_time,
        storage_sd=float(sd[0]) / storage,
        loss_factor_sd=float(sd[1]) / loss_factor,
        arm_sd=None if arm is None else float(np.linalg.norm(errors[1 + arm])) / model.k[arm],
        repeated=tuple(repeat.temperature for repeat in repeats),
    )


def _compute_errors(rows: FloatArray, unmeasured: FloatArray) -> FloatArray:
    r"""Return independent errors E of the parameters, shape (p, m), and so their covariance E E'.

    .. math:: E E' = (J'J)^{-1} + \sum_c \delta\theta\,\delta\theta', \qquad
              \delta\theta = (J'J)^{-1} J' c

    The last columns are the shifts by unmeasured effects c, one standard deviation each.

    A fit does not estimate the compliance of its machine: it is shifted by it. Directions without
    information get a very large variance.
    """
    scale = np.linalg.norm(rows, axis=0)
    scale[scale == 0] = 1.0
    left_vectors, values, vectors = np.linalg.svd(rows / scale, full_matrices=False)
    values = np.maximum(values, SINGULAR * values[0])
    root = vectors.T / values / scale[:, None]
    shifts = root @ (left_vectors.T @ unmeasured)
    return np.hstack((root, shifts))


def _compute_gradients(
    model: GeneralizedMaxwell, frequency: float
) -> tuple[float, float, FloatArray]:
    r"""Return storage, loss factor, and their gradients in (k_inf, k, ln tau), shape (2, p)."""
    s = np.array([2j * np.pi * frequency])
    stiffness, complex_gradient = complex(model.stiffness_at(s)[0]), model.arm_slopes(s)[0][0]
    loss_factor = stiffness.imag / stiffness.real
    storage = complex_gradient.real
    ratio = (complex_gradient.imag - loss_factor * complex_gradient.real) / stiffness.real
    return stiffness.real, loss_factor, np.array([storage, ratio])


# -- Arms ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class ExpectedArm:
    """Expected relative half widths of the 95 % intervals of one arm.

    Attributes
    ----------
    k, tau : float
        Stiffness and relaxation time of the assumed arm, N/m and s.
    half_k, half_tau, half_b : float
        As the test is planned; b = k tau.
    named_k, named_tau, named_b : float
        The same with a baseline of 10 s, and drift, compliance, creep and clocks of the machine
        known.
    """

    k: float
    tau: float
    half_k: float
    half_tau: float
    half_b: float
    named_k: float
    named_tau: float
    named_b: float


def expected_arms(model: GeneralizedMaxwell, bench: Bench) -> tuple[ExpectedArm, ...]:
    """Return the expected errors of each arm of a model."""
    planned, named_half_widths = (
        _compute_arm_half_widths(model, planned_test)
        for planned_test in (bench, _name_machine(bench, *_NAMED_EFFECTS, "sync"))
    )
    smaller_half_widths = np.minimum(planned, named_half_widths)
    return tuple(
        ExpectedArm(k, tau, *as_planned, *if_named)
        for k, tau, as_planned, if_named in zip(
            model.k, model.tau, planned.tolist(), smaller_half_widths.tolist(), strict=True
        )
    )


def _compute_arm_half_widths(model: GeneralizedMaxwell, bench: Bench) -> FloatArray:
    """Return relative half widths of k, tau and b of every arm, shape (N, 3)."""
    n = model.arms
    arms = slice(1, 1 + 2 * n)
    errors = _compute_errors(*bench.rows(model))[arms]
    inv_k, identity = np.diag(1 / np.asarray(model.k)), np.eye(n)
    zeros = np.zeros((n, n))
    transformation = np.vstack(
        (
            np.hstack((inv_k, zeros)),
            np.hstack((zeros, identity)),
            np.hstack((inv_k, identity)),
        )
    )
    return np.asarray(NORMAL * np.linalg.norm(transformation @ errors, axis=1).reshape(3, n).T)


def _name_machine(bench: Bench, *names: str) -> Bench:
    """Return the test after a baseline of 10 s, with named effects of its machine stated as 0."""
    machine = bench.machine or Machine()
    entries = {name: getattr(machine, name) or 0.0 for name in names}
    named_machine = replace(machine, **entries)  # type: ignore[arg-type]  # numbers alone
    return replace(bench, baseline=max(bench.baseline, NAMED_BASELINE), machine=named_machine)


# -- End of the hold -------------------------------------------------------------------------------


@dataclass(frozen=True)
class ExpectedEnd(Serialisable):
    """Expected error of the stiffness at the end of a test, to first order.

    Attributes
    ----------
    time : float
        T, s.
    stiffness : float
        k(T) of the assumed solid, N/m.
    half_width : float
        Half width of its 95 % limits, over the value: all that machine and climate may do without a
        trace is in them.
    if_machine_named : float
        The same with a baseline of 10 s, and compliance and creep of the machine known.
    """

    _keys = (EVERY_FIELD, "if_machine_named")

    time: float
    stiffness: float
    half_width: float
    if_machine_named: float

    @property
    def message(self) -> str:
        """The expected error of k(T) and how to reduce it, as text."""
        return paragraph(
            f"At the end of the hold the stiffness k({duration(self.time)}) would be known to "
            f"about {round_to_error(100 * self.half_width, digits=2)} %",
            naming(self.time, self.half_width, self.if_machine_named),
        )


def expected_end(model: GeneralizedMaxwell, bench: Bench) -> ExpectedEnd:
    r"""Return the expected error of :math:`k(T) = k_\infty + \sum_j k_j e^{-T/\tau_j}`.

    Unmeasured effects of machine and climate are columns of J, each with a prior row of 1.
    """
    bench = replace(bench, method="full", machine=bench.machine or Machine())
    named_bench = _name_machine(bench, *_NAMED_EFFECTS)
    value = float(model.relaxation(bench.hold_time))
    half_width, named_half_width = (
        _compute_end_half_width(model, planned_test) / value
        for planned_test in (bench, named_bench)
    )
    return ExpectedEnd(bench.hold_time, value, half_width, min(named_half_width, half_width))


def _compute_end_half_width(model: GeneralizedMaxwell, bench: Bench) -> float:
    """Return the half width of the 95 % limits of k(T), N/m."""
    rows, unmeasured = bench.rows(model)
    # a limit is over every solid and every rig at once
    augmented_rows = np.vstack(
        (
            np.hstack((rows, unmeasured)),
            np.eye(
                unmeasured.shape[1],
                sum(part.shape[1] for part in (rows, unmeasured)),
                rows.shape[1],
            ),
        )
    )
    tau, k = np.asarray(model.tau), np.asarray(model.k)
    age = bench.hold_time / tau
    gradient = np.concatenate(([1.0], np.exp(-age), k * age * np.exp(-age)))
    gradient = np.pad(gradient, (0, augmented_rows.shape[1] - len(gradient)))
    errors = _compute_errors(augmented_rows, augmented_rows[:, :0])
    return float(np.sqrt(MAX_DEVIANCE) * np.linalg.norm(gradient @ errors))


# -- Hammer test -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class RecordNeed:
    """Required length of the impact record for the mass on this solid.

    Attributes
    ----------
    frequency, damping_ratio : float
        Frequency and damping ratio of the ringing pole, Hz and dimensionless.
    time_constant : float
        1/sigma of the free response, s.
    half_power_width : float
        Half-power width of the peak, Hz.
    for_decay, for_lines : float
        Six time constants, and five lines in the half-power band, s.
    record : float or None
        Planned length of the record, s.
    peak_error : float or None
        Relative error of the peak read off the lines, by the truncation of the record; at the
        worst position of the lines.
    """

    frequency: float
    damping_ratio: float
    time_constant: float
    half_power_width: float
    for_decay: float
    for_lines: float
    record: float | None = None
    peak_error: float | None = None


@dataclass(frozen=True)
class Pulse:
    """Half-sine hammer pulse, and the frequencies that it excites.

    Attributes
    ----------
    duration : float
        s.
    level_db : float
        Force spectrum at the frequency requested, relative to 0 Hz, dB.
    band_10db, band_20db : float
        Where the spectrum has fallen by 10 and 20 dB, Hz.
    first_zero : float
        1.5 / duration, Hz.
    """

    duration: float
    level_db: float
    band_10db: float
    band_20db: float
    first_zero: float


def record_need(model: GeneralizedMaxwell, mass: float, record: float | None) -> RecordNeed:
    """Return the length of record that the free decay of a mass on a seal needs."""
    pole = ringing_pole(model, mass)
    sigma = -float(pole.real)
    width = sigma / np.pi
    return RecordNeed(
        frequency=float(pole.imag) / (2 * np.pi),
        damping_ratio=float(sigma / abs(pole)),
        time_constant=1 / sigma,
        half_power_width=width,
        for_decay=TIME_CONSTANTS / sigma,
        for_lines=LINES / width,
        record=record,
        peak_error=None if record is None else _compute_peak_error(model, mass, pole, record),
    )


def hammer_rows(
    model: GeneralizedMaxwell,
    mass: float,
    *,
    seals: float,
    lines: FloatArray,
    relative_sd: float,
) -> FloatArray:
    r"""Return the sensitivities of a hammer test in units of its scatter, shape (2n, p + 1).

    .. math:: \frac{\partial \ln A}{\partial K} = -\frac{n}{m s^2 + n K}, \qquad
              \frac{\partial \ln A}{\partial \ln m} = -\frac{m s^2}{m s^2 + n K}

    Columns are k_inf, k, ln tau of one seal, then ln m; `relative_sd` is that of real and
    imaginary part of each line.
    """
    s = 2j * np.pi * lines
    inverse = 1 / (mass * s**2 + seals * model.stiffness_at(s))
    columns = -np.column_stack((seals * model.arm_slopes(s)[0], mass * s**2)) * inverse[:, None]
    return np.concatenate((columns.real, columns.imag)) / relative_sd


def _compute_peak_error(
    model: GeneralizedMaxwell, mass: float, pole: complex, record: float
) -> float:
    """Return the worst relative error of the highest line, over the positions of the lines."""
    frequencies = 1j * (pole.imag - pole.real / 20 * np.arange(-40, 41))
    peak = float(np.abs(accelerance(model, mass, frequencies)).max())
    step = 2 * np.pi / record
    offsets = np.linspace(-0.5, 0.5, LINE_POSITIONS)[:, None] * step + np.arange(-3, 4) * step
    s = 1j * np.maximum(pole.imag + offsets, step / 10)
    lines = np.abs(accelerance(model, mass, s.ravel(), record)).reshape(s.shape)
    errors = lines.max(axis=1) / peak - 1
    return float(errors[np.argmax(np.abs(errors))])


def half_sine(duration: float, frequency: float) -> Pulse:
    r"""Return the spectrum of a half-sine pulse of `duration` s.

    .. math:: \frac{|F(f)|}{|F(0)|} = \left|\frac{\cos \pi f T}{1 - (2 f T)^2}\right|
    """
    zero = 1.5 / duration

    def level(f: float) -> float:
        x = 2 * f * duration
        if abs(x - 1) < 1e-6:  # the removable singularity
            return float(np.pi / 4)
        return float(abs(np.cos(np.pi * x / 2) / (1 - x**2)))

    def find_fall(decibel: float) -> float:
        low, high = 0.0, zero
        for _ in range(60):
            midpoint = (low + high) / 2
            low, high = (
                (midpoint, high) if level(midpoint) > 10 ** (-decibel / 20) else (low, midpoint)
            )
        return low

    tiny = float(np.finfo(float).tiny)
    return Pulse(
        duration=duration,
        level_db=float(20 * np.log10(max(level(frequency), tiny))),
        band_10db=find_fall(10.0),
        band_20db=find_fall(20.0),
        first_zero=zero,
    )
