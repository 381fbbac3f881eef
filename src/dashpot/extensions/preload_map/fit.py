"""Fit of a preload map to sweeps at several compressions and amplitudes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import ComplexArray, FloatArray
from dashpot.base.checks import Check
from dashpot.base.errors import DataError
from dashpot.base.provenance import Source, Step
from dashpot.base.reported_values import NORMAL
from dashpot.base.student_t import t_quantile
from dashpot.base.units import Quantity, Range, convert_to_si, convert_to_unit, si_range
from dashpot.base.value_ranges import require_nonnegative
from dashpot.extensions.preload_map import checks
from dashpot.extensions.preload_map.interpolation import compute_level_weights
from dashpot.extensions.preload_map.preload_map import MapCell, PreloadMap, build_arm_columns
from dashpot.extensions.preload_map.preload_sweep import PreloadSweep, PreloadTable
from dashpot.extensions.preload_map.separability import (
    Layout,
    SweepScatter,
    build_layouts,
    estimate_scatter,
    judge_pairs,
)
from dashpot.extensions.preload_map.stiffness_lines import StiffnessLines, collect_lines
from dashpot.numerics.nonnegative_least_squares import solve_linear
from dashpot.preprocessing.checks import check_machine
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.vibration.modal.dynamic_stiffness import DEGREE

GAIN_ERROR = 0.01
"""Relative standard error of the ratio of two sensors where none is stated."""
_ARMS_PER_DECADE, _BEYOND_BAND = 24, 30.0
"""Candidate relaxation times of a decade, and the factor by which they extend beyond the band."""
_MIN_SCATTER = 1e-9
"""Scatter of ln|K| and of the angle, rad, at least: rounding leaves as much."""
_MIN_SHARE = 1e-9
"""Share of the stiffness that an arm carries at least."""
_LARGEST_ERROR = 0.5
"""Relative error of a sensor, or angle, rad, that still determines a stiffness."""
_RANK = 1e-9
_GRID_POINTS = 40
"""Points of the common curve of sweeps that share no frequencies."""
_ITERATIONS = 4
"""Fits of the arms, each about the angle of the one before."""
_ANGLE_SD = 0.1
"""Standard deviation of the angle that a curve may have beside its arms, rad."""


def fit_preload_map(
    sweeps: Sequence[PreloadSweep] | PreloadTable,
    /,
    *,
    band: Range | None = None,
    repeatability: float | None = None,
    gain_error: float = GAIN_ERROR,
    phase_error: Quantity = DEGREE,
    mass: Quantity | None = None,
    seals: float = 1.0,
) -> PreloadMap:
    r"""Fit one law to the complex stiffness at several compressions, amplitudes and frequencies.

    .. math::

        K^*(f, X, c) = \frac{F_e'(c)}{k}\Big[k + \sum_j k_j
            \frac{j\omega\tau_j}{1 + j\omega\tau_j}\Big] s(X)

    The logarithm is additive in the three variables, so weighted least squares give a factor of
    each compression, a complex factor of each amplitude and a common curve over frequency; the
    positive spectrum of arms that is nearest to the curve makes it a Maxwell model. Separability
    is tested pair by pair (:mod:`~dashpot.extensions.preload_map.separability`). The 95 % limits
    hold the scatter of lines and of sweeps, the common errors of the sensors, and between levels
    the difference of a parabola and a straight line.

    Parameters
    ----------
    sweeps : sequence of PreloadSweep, or PreloadTable
        At two compressions or more; sweeps at one setting are repeats.
    band : (float, float) or str, optional
        Hz; by default all lines.
    repeatability : float, optional
        Relative standard deviation of a whole sweep at a setting reached anew; repeated sweeps
        show it themselves.
    gain_error : float
        Relative standard error of the ratio of the sensors; 1 % by default.
    phase_error : float or str
        Between the channels, rad; one degree by default.
    mass : float or str, optional
        Mass of a body on the part, kg: its resonance at each compression.
    seals : float
        Parts in parallel under the mass.

    Returns
    -------
    PreloadMap

    Raises
    ------
    DataError
        If the sweeps are too few, too short or not linked, or an option is impossible.
    """
    if isinstance(sweeps, PreloadTable):
        sweeps = sweeps.sweeps
    turn = convert_to_si(phase_error, "angle")
    require_nonnegative(gain_error=gain_error, phase_error=turn)
    if repeatability is not None:
        require_nonnegative(repeatability=repeatability)
    if max(gain_error, turn, repeatability or 0.0) >= _LARGEST_ERROR:
        raise DataError(
            f"a gain error of {gain_error:g}, a phase error of {turn:g} rad and a repeatability of "
            f"{repeatability or 0:g} determine no stiffness; expected below {_LARGEST_ERROR:g}"
        )
    lines = collect_lines(_select_band(sweeps, si_range(band, "frequency")))
    layouts = build_layouts(lines)
    _require_linked(lines, layouts[0])
    values = (lines.magnitude, lines.angle)
    magnitude, angle = (
        estimate_scatter(lines, y, layout, repeatability or 0.0)
        for y, layout in zip(values, layouts, strict=True)
    )
    scatters = (magnitude, angle)
    pairs = judge_pairs(lines, layouts, scatters)
    law = _fit_law(lines, layouts, scatters)
    no_amplitude = bool(np.isnan(lines.amplitudes[0]))
    preload_map = PreloadMap(
        model=law.model,
        band=(float(lines.frequency.min()), float(lines.frequency.max())),
        compressions=lines.compressions,
        amplitudes=np.zeros(0) if no_amplitude else lines.amplitudes,
        reference=law.reference,
        compression_factor=np.exp(law.compression),
        amplitude_factor=np.exp(law.amplitude),
        covariance=law.covariance,
        gain_error=gain_error,
        phase_error=turn,
        line_scatter=(magnitude.line, angle.line),
        sweep_scatter=(magnitude.sweep, angle.sweep),
        pairs=pairs,
        cells=(),
        frequency=lines.frequency,
        value=np.exp(lines.magnitude + 1j * lines.angle),
        line_compression=lines.compressions[lines.compression],
        line_amplitude=lines.amplitudes[lines.amplitude],
        seals=seals,
        source=_collect_sources(sweeps),
        steps=(Step("fit_preload_map", _make_settings(band, repeatability, gain_error, turn)),),
    )
    preload_map = replace(preload_map, cells=_measure_cells(lines, preload_map))
    repeats = int(lines.sweep.max()) + 1 - len(preload_map.cells)
    preload_map = replace(
        preload_map,
        checks=_run_checks(preload_map, law, repeats=repeats, is_stated=repeatability is not None),
    )
    return preload_map if mass is None else add_resonances(preload_map, mass, seals)


def add_resonances(preload_map: PreloadMap, mass: Quantity, seals: float = 1.0) -> PreloadMap:
    """Return the map with the resonance of a mass at each measured compression.

    Raises
    ------
    DataError
        If one lies outside the measured band.
    """
    resonances = tuple(
        preload_map.find_resonance(mass, seals=seals, compression=c)
        for c in preload_map.compressions.tolist()
    )
    return replace(
        preload_map, mass=convert_to_si(mass, "mass"), seals=seals, resonances=resonances
    )


class _SeparableLaw(NamedTuple):
    """Logarithms of the factors, the model, their covariance, and the model's misfit."""

    model: GeneralizedMaxwell
    reference: tuple[int, int]
    compression: FloatArray
    amplitude: ComplexArray
    covariance: FloatArray
    misfit: float
    misfit_ratio: float


def _select_band(
    sweeps: Sequence[PreloadSweep], band: tuple[float, float] | None
) -> list[PreloadSweep]:
    if band is None:
        return list(sweeps)
    selected_sweeps = []
    for sweep in sweeps:
        in_band = (sweep.frequency >= band[0]) & (sweep.frequency <= band[1])
        if not in_band.any():
            raise DataError(
                f"{sweep.name} has no line from {band[0]:.4g} to {band[1]:.4g} Hz: widen the band "
                "(--band), or leave the file out"
            )
        weight = None if sweep.weight is None else sweep.weight[in_band]
        selected_sweeps.append(
            replace(sweep, frequency=sweep.frequency[in_band], value=sweep.value[in_band],
                    weight=weight)
        )  # fmt: skip
    return selected_sweeps


def _require_linked(lines: StiffnessLines, layout: Layout) -> None:
    """Refuse sweeps whose compressions and amplitudes never meet."""
    weighted = layout.main * lines.weight[:, None]
    rank = int(np.linalg.matrix_rank(weighted, tol=_RANK * float(np.linalg.norm(weighted))))
    columns = layout.main.shape[1]
    if rank < columns - 2:
        raise DataError(
            "compression and amplitude, or compression and frequency, change together from sweep "
            "to sweep, so that their effects cannot be distinguished. Measure one compression at "
            "two amplitudes, and all sweeps at the same frequencies"
        )


def _fit_law(
    lines: StiffnessLines,
    layouts: tuple[Layout, Layout],
    scatters: tuple[SweepScatter, SweepScatter],
) -> _SeparableLaw:
    """Fit the additive law, and the arms that follow its curve over frequency."""
    nc, nx = len(lines.compressions), len(lines.amplitudes)
    reference = (nc // 2, 0)
    curve_column_count = layouts[0].main.shape[1] - nc - nx
    curve = _make_curve_columns(lines, curve_column_count)
    tones = curve.frequency
    contrast_c, contrast_x = _make_contrasts(nc, reference[0]), _make_contrasts(nx, reference[1])
    magnitude = _estimate(lines, lines.magnitude, layouts[0].main, scatters[0])
    angle = _estimate(lines, lines.angle, layouts[1].main, scatters[1])
    compression_unit_vector, amplitude_unit_vector = (
        np.eye(nc)[reference[0]],
        np.eye(nx)[reference[1]],
    )
    n = len(tones)
    magnitude_columns = np.hstack(
        (
            curve.columns,
            np.tile(compression_unit_vector, (n, 1)),
            np.tile(amplitude_unit_vector, (n, 1)),
        )
    )
    angle_columns = np.hstack((curve.columns, np.tile(amplitude_unit_vector, (n, 1))))
    ln_master = magnitude_columns @ magnitude.beta + 1j * (angle_columns @ angle.beta)
    sd = [max(scatter.line, _MIN_SCATTER) / curve.root_weight for scatter in scatters]
    model, angle_left = _fit_arms(tones, np.exp(ln_master), sd)
    fitted_stiffness = model.complex_stiffness(omega=2 * np.pi * tones) * np.exp(1j * angle_left)
    to_k, to_angle = _invert_curve(model, tones, sd)
    zeros = np.zeros
    q = angle_columns.shape[1]
    pick_c = np.hstack((zeros((nc, curve_column_count)), contrast_c, zeros((nc, nx))))
    pick_x = np.hstack((zeros((nx, curve_column_count + nc)), contrast_x))
    turn_x = np.hstack((zeros((nx, curve_column_count)), contrast_x))
    by_magnitude, by_angle = (magnitude_columns / sd[0][:, None]), (angle_columns / sd[1][:, None])
    L_magnitude = np.vstack(
        (pick_c, pick_x, np.tile(to_angle[:n] @ by_magnitude, (nx, 1)), to_k[:, :n] @ by_magnitude)
    )
    L_angle = np.vstack(
        (zeros((nc, q)), zeros((nx, q)), turn_x + to_angle[n:] @ by_angle, to_k[:, n:] @ by_angle)
    )
    covariance = (
        L_magnitude @ magnitude.covariance @ L_magnitude.T + L_angle @ angle.covariance @ L_angle.T
    )
    gap = np.log(fitted_stiffness) - ln_master
    # the curve is known worse than its lines where the sweeps share only some of them
    noise = np.concatenate((gap.real / sd[0], gap.imag / sd[1]))
    freedom = max(2 * n - len(model.tau) - 2, 1)
    return _SeparableLaw(
        model,
        reference,
        pick_c @ magnitude.beta,
        pick_x @ magnitude.beta + 1j * (turn_x @ angle.beta + angle_left),
        covariance,
        float(np.abs(gap).max()),
        float(np.sqrt(noise @ noise / freedom)),
    )


class _CommonCurve(NamedTuple):
    """Frequencies of the common curve, Hz, its columns, and root of the weight behind each."""

    frequency: FloatArray
    columns: FloatArray
    root_weight: FloatArray


def _make_curve_columns(lines: StiffnessLines, shared: int) -> _CommonCurve:
    """Return where the common curve is taken: at shared frequencies, or on a grid."""
    total = float((lines.weight**2).sum())
    if lines.shares_tones:
        weight = np.bincount(
            lines.frequency_index, lines.weight**2, len(lines.distinct_frequencies)
        )
        return _CommonCurve(lines.distinct_frequencies, np.eye(shared), np.sqrt(weight))
    low, high = float(lines.frequency.min()), float(lines.frequency.max())
    f = np.asarray(np.geomspace(low, high, _GRID_POINTS), dtype=float)
    u = np.linspace(-1.0, 1.0, _GRID_POINTS)
    columns = np.asarray(np.polynomial.legendre.legvander(u, shared - 1), dtype=float)
    return _CommonCurve(f, columns, np.full(_GRID_POINTS, np.sqrt(total / _GRID_POINTS)))


class _AdditiveCoefficients(NamedTuple):
    """Coefficients and their covariance, widened so that 1.96 standard errors are 95 %."""

    beta: FloatArray
    covariance: FloatArray


def _estimate(
    lines: StiffnessLines, y: FloatArray, main: FloatArray, scatter: SweepScatter
) -> _AdditiveCoefficients:
    weighted = main * lines.weight[:, None]
    pseudoinverse = np.linalg.pinv(weighted, rcond=_RANK)
    sweeps = (lines.sweep[:, None] == np.arange(int(lines.sweep.max()) + 1)) * lines.weight[:, None]
    line, sweep = (
        (sd * t_quantile(0.95, dof) / NORMAL) ** 2
        for sd, dof in ((scatter.line, scatter.dof), (scatter.sweep, scatter.sweep_dof))
    )
    by_sweep = pseudoinverse @ sweeps
    return _AdditiveCoefficients(
        pseudoinverse @ (y * lines.weight),
        line * (pseudoinverse @ pseudoinverse.T) + sweep * (by_sweep @ by_sweep.T),
    )


def _make_contrasts(count: int, reference: int) -> FloatArray:
    """Return each level less the reference."""
    contrasts = np.eye(count)
    contrasts[:, reference] -= 1.0
    return contrasts


def _fit_arms(
    frequency: FloatArray, master: ComplexArray, sd: Sequence[FloatArray]
) -> tuple[GeneralizedMaxwell, float]:
    """Return the positive spectrum nearest to a curve, and the angle that the curve has beside it.

    Friction turns the stiffness by an angle that no arm has: it is the same at every frequency.
    """
    omega = 2 * np.pi * frequency
    low, high = 1 / omega.max() / _BEYOND_BAND, _BEYOND_BAND / omega.min()
    tau = np.geomspace(low, high, round(_ARMS_PER_DECADE * float(np.log10(high / low))) + 1)
    columns = build_arm_columns(omega, tau)
    n, added_stiffness = len(omega), 0.0
    target = np.concatenate((1 / sd[0], zeros := np.zeros(n), [0.0]))
    positive = np.append(np.ones(len(tau) + 1, dtype=bool), False)
    for _ in range(_ITERATIONS):
        A = columns / (master * np.exp(-1j * added_stiffness))[:, None]
        turn = np.concatenate((zeros, 1 / sd[1], [1 / _ANGLE_SD]))
        rows = np.vstack((A.real / sd[0][:, None], A.imag / sd[1][:, None], 0 * A.real[:1]))
        target[-1] = -added_stiffness / _ANGLE_SD
        k, _ = solve_linear(np.column_stack((rows, turn)), target, positive=positive)
        added_stiffness += float(k[-1])
    is_significant = k[1:-1] > _MIN_SHARE * float(k[:-1].sum())
    model = GeneralizedMaxwell(
        float(k[0]), tuple(k[1:-1][is_significant]), tuple(tau[is_significant])
    )
    return model, added_stiffness


def _invert_curve(
    model: GeneralizedMaxwell, frequency: FloatArray, sd: Sequence[FloatArray]
) -> tuple[FloatArray, FloatArray]:
    """Return what stiffnesses and angle gain with the rows of ln|K|, then of the angle, over sd."""
    omega, n = 2 * np.pi * frequency, len(frequency)
    A = (
        build_arm_columns(omega, np.array(model.tau))
        / model.complex_stiffness(omega=omega)[:, None]
    )
    rows = np.vstack((A.real / sd[0][:, None], A.imag / sd[1][:, None]))
    turn = np.concatenate((np.zeros(n), 1 / sd[1]))
    free = np.flatnonzero(np.array((model.k_inf, *model.k)) > 0)
    pseudoinverse = np.linalg.pinv(np.column_stack((rows[:, free], turn)), rcond=_RANK)
    to_k = np.zeros((rows.shape[1], 2 * n))
    to_k[free] = pseudoinverse[:-1]
    return to_k, pseudoinverse[-1]


def _measure_cells(lines: StiffnessLines, preload_map: PreloadMap) -> tuple[MapCell, ...]:
    """Return how many lines each setting has, and how far the map misses them."""
    cells = []
    for i, c in enumerate(lines.compressions.tolist()):
        for j, X in enumerate(lines.amplitudes.tolist()):
            is_cell = (lines.compression == i) & (lines.amplitude == j)
            if not is_cell.any():
                continue
            amplitude = None if np.isnan(X) else X
            expected = preload_map.evaluate(
                lines.frequency[is_cell], compression=c, amplitude=amplitude
            ).value
            gap = preload_map.value[is_cell] / expected - 1
            rms = float(np.sqrt(np.mean(np.abs(gap) ** 2)))
            cells.append(
                MapCell(
                    c, amplitude, len(set(lines.sweep[is_cell].tolist())), int(is_cell.sum()), rms
                )
            )
    return tuple(cells)


def _run_checks(
    preload_map: PreloadMap, law: _SeparableLaw, *, repeats: int, is_stated: bool
) -> tuple[Check, ...]:
    criteria = {
        "compression and frequency": checks.compression_and_frequency_separable,
        "amplitude and frequency": checks.amplitude_and_frequency_separable,
        "compression and amplitude": checks.compression_and_amplitude_separable,
    }
    untested_pairs = [test.pair for test in preload_map.pairs if not test.tested]
    worst = max(preload_map.cells, key=lambda cell: cell.residual)
    sweep_text = f"{convert_to_unit(worst.compression, 'mm'):.4g} mm"
    if worst.amplitude is not None:
        sweep_text += f" and an amplitude of {convert_to_unit(worst.amplitude, 'mm'):.4g} mm"
    counts = {"compression": len(preload_map.compressions)}
    if len(preload_map.amplitudes) > 1:
        counts["amplitude"] = len(preload_map.amplitudes)
    fewest_levels = min(counts, key=lambda name: counts[name])
    gaps = {
        "compression": _estimate_interpolation_error(
            preload_map.compressions, np.log(preload_map.compression_factor)
        )
    }
    if len(preload_map.amplitudes) > 1:
        gaps["amplitude"] = _estimate_interpolation_error(
            np.log(preload_map.amplitudes), np.log(preload_map.amplitude_factor)
        )
    widest = max(gaps, key=lambda name: gaps[name])
    return (
        *(criteria[test.pair](test) for test in preload_map.pairs),
        checks.every_pair_tested(untested_pairs),
        checks.departure_excluded(
            max((test.departure_limit or 0.0 for test in preload_map.pairs), default=0.0),
            max((test.angle_limit or 0.0 for test in preload_map.pairs), default=0.0),
        ),
        checks.sweeps_followed(worst.residual, sweep_text=sweep_text),
        checks.levels_enough(counts[fewest_levels], axis=fewest_levels),
        checks.levels_dense(gaps[widest], axis=widest),
        checks.solid_follows_master_curve(law.misfit_ratio, misfit=law.misfit),
        *_judge_limits(preload_map),
        *check_machine(preload_map.source, float(np.abs(preload_map.value).max())),
        checks.repeatability_determined(repeats, is_stated=is_stated),
    )


def _estimate_interpolation_error(
    levels: FloatArray, logarithm: FloatArray | ComplexArray
) -> float:
    """Return the largest difference of parabola and line half way between levels."""
    middles = (levels[1:] + levels[:-1]) / 2
    gaps = [
        abs(compute_level_weights(levels, float(middle)).difference @ logarithm)
        for middle in middles
    ]
    return float(max(gaps))


def _judge_limits(preload_map: PreloadMap) -> tuple[Check, ...]:
    """Return the checks of the limits at all measured settings."""
    f = preload_map.grid
    evaluated = [
        preload_map.evaluate(f, compression=c, amplitude=X) for c, X in preload_map.settings
    ]
    eta = np.concatenate(
        [cell_stiffness.value.imag / cell_stiffness.value.real for cell_stiffness in evaluated]
    )
    error = np.concatenate([cell_stiffness.loss_factor_error for cell_stiffness in evaluated])
    highest = eta + error
    measured = preload_map.value.imag / preload_map.value.real
    relative_limit = NORMAL * preload_map.line_scatter[1] + NORMAL * preload_map.phase_error
    i = int(measured.argmin())
    lowest = float(measured[i]) + relative_limit
    ratio = error / np.maximum(eta, 1e-12)
    j = int(ratio.argmax())
    return (
        checks.part_dissipates(
            min(lowest, float(highest.min())), frequency=float(preload_map.frequency[i])
        ),
        checks.stiffness_determined(
            float(max(cell_stiffness.magnitude_error.max() for cell_stiffness in evaluated))
        ),
        checks.loss_factor_determined(float(ratio[j]), loss_factor=float(eta[j])),
    )


def _collect_sources(sweeps: Sequence[PreloadSweep]) -> tuple[Source, ...]:
    """Return each file once."""
    return tuple(dict.fromkeys(sweep.source for sweep in sweeps if sweep.source is not None))


def _make_settings(
    band: Range | None, repeatability: float | None, gain: float, phase: float
) -> tuple[tuple[str, str], ...]:
    settings = [("gain_error", f"{gain:g}"), ("phase_error", f"{phase:.6g} rad")]
    if repeatability is not None:
        settings.append(("repeatability", f"{repeatability:g}"))
    if band is not None:
        low, high = si_range(band, "frequency")
        settings.append(("band", f"{low:g} to {high:g} Hz"))
    return tuple(settings)
