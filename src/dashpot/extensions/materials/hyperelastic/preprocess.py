"""Preparation of a stress-strain test: one loading as an averaged elastic curve."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray
from dashpot.base.errors import FitError
from dashpot.extensions.materials.hyperelastic.datamodel import ElasticCurve, StressStrainTest
from dashpot.extensions.materials.strokes import Stroke, find_strokes
from dashpot.solids.maxwell import GeneralizedMaxwell

MAX_POINTS = 100
"""Largest number of points of one curve: neighbours in stretch are averaged."""
_WHOLE_SHARE = 0.95
"""Fraction of the largest strain that a loading must reach to be chosen."""
_BOTH_SHARE = 0.1
"""Fraction of the largest strain from which a record has both tension and compression."""
_MIN_STROKE_SAMPLES = 4
"""Smallest mean number of samples of a stroke; below it the rows are unordered points."""


class _LoadingRows(NamedTuple):
    """Rows of the chosen loading, with its loss and softening."""

    rows: IndexArray
    loss_fraction: float | None
    softening: float | None


def extract_elastic_curve(
    test: StressStrainTest,
    *,
    relaxation: GeneralizedMaxwell | None = None,
    cycle: int | None = None,
) -> ElasticCurve:
    r"""Return the curve to which a law is fitted: the last complete loading of a test.

    Parameters
    ----------
    test : StressStrainTest
    relaxation : GeneralizedMaxwell, optional
        With k_inf = 1. The true stress is taken to be that of an elastic curve with relaxation,
        :math:`\sigma = \int g(t-s)\,d\sigma_e(s)`, which is inverted exactly.
    cycle : int, optional
        The loading to use, counted from 1.

    Raises
    ------
    FitError
        If relaxation is to be removed from a test without a clock, or there is no such loading.
    """
    stress = test.stress if relaxation is None else _remove_relaxation(relaxation, test)
    chosen_samples = _choose_loading(test.stretch, stress, cycle)
    rows = chosen_samples.rows
    x, y = _average_points(test.stretch[rows], stress[rows])
    duration = None if test.time is None else float(np.ptp(test.time[rows]))
    return ElasticCurve(
        test.mode, x, y, len(rows), chosen_samples.loss_fraction, chosen_samples.softening,
        duration,
        test.stated,
        test.source
    )  # fmt: skip


def _remove_relaxation(relaxation: GeneralizedMaxwell, test: StressStrainTest) -> FloatArray:
    """Return the nominal stress at rest; relaxation is that of the true stress."""
    if test.time is None:
        raise FitError(
            f"the {test.mode} test has no clock, so relaxation cannot be removed; give the "
            "rate (--rate 10Hz), or a file with a column of time"
        )
    if test.mode == "volumetric":
        return test.stress
    return relaxation.displacement(test.time, test.stress * test.stretch) / test.stretch


def _choose_loading(stretch: FloatArray, stress: FloatArray, cycle: int | None) -> _LoadingRows:
    strain = stretch - 1
    largest_strain = strain[np.argmax(np.abs(strain))]
    if min(float(strain.max()), -float(strain.min())) > _BOTH_SHARE * abs(largest_strain):
        return _LoadingRows(np.argsort(stretch, kind="stable"), None, None)
    strain_size = np.sign(largest_strain) * strain
    strokes = find_strokes(strain_size, resolution=0.0)
    if len(stretch) < _MIN_STROKE_SAMPLES * len(strokes):
        return _LoadingRows(np.argsort(strain_size, kind="stable"), None, None)
    loadings = _find_loadings(strain_size, strokes)
    if cycle is not None and cycle > len(loadings):
        raise FitError(f"cycle = {cycle}, but the test has {len(loadings)} whole loadings")
    chosen_stroke = loadings[-1 if cycle is None else cycle - 1]
    softer = None
    if len(loadings) > 1:
        softer = 1 - _get_stress_at_half_strain(
            strain_size, stress, loadings[-1]
        ) / _get_stress_at_half_strain(strain_size, stress, loadings[0])
    loss_fraction = _compute_loss_fraction(strain_size, stress, chosen_stroke, strokes)
    return _LoadingRows(
        np.arange(chosen_stroke.first, chosen_stroke.last + 1), loss_fraction, softer
    )


def _find_loadings(strain_size: FloatArray, strokes: Sequence[Stroke]) -> list[Stroke]:
    """Return the complete loadings; if there is none, the incomplete ones."""
    loading_strokes = [stroke for stroke in strokes if stroke.inward]
    complete_strain = _WHOLE_SHARE * float(strain_size.max())
    # a record of unloading only is one stroke
    return (
        [stroke for stroke in loading_strokes if strain_size[stroke.last] >= complete_strain]
        or loading_strokes
        or list(strokes[:1])
    )


def _sort_stroke_samples(
    x: FloatArray, y: FloatArray, stroke: Stroke
) -> tuple[FloatArray, FloatArray]:
    part = np.argsort(x[stroke.samples], kind="stable")
    return x[stroke.samples][part], y[stroke.samples][part]


def _compute_loss_fraction(
    x: FloatArray, y: FloatArray, loading: Stroke, strokes: Sequence[Stroke]
) -> float | None:
    """Return the fraction of the loading energy lost in unloading; None without unloading."""
    unloading = next(
        (stroke for stroke in strokes if stroke.first >= loading.last and not stroke.inward), None
    )
    if unloading is None:
        return None
    (x1, y1), (x2, y2) = _sort_stroke_samples(x, y, loading), _sort_stroke_samples(x, y, unloading)
    stretches = np.linspace(max(x1[0], x2[0]), min(x1[-1], x2[-1]), 200)
    work_in, work_out = (
        float(np.trapezoid(np.interp(stretches, a, b), stretches)) for a, b in ((x1, y1), (x2, y2))
    )
    return 1 - work_out / work_in


def _get_stress_at_half_strain(x: FloatArray, y: FloatArray, stroke: Stroke) -> float:
    """Return the stress at half the largest strain."""
    return float(np.interp(0.5 * x.max(), *_sort_stroke_samples(x, y, stroke)))


def _average_points(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the points sorted by stretch, averaged if there are many."""
    order = np.argsort(x, kind="stable")
    x, y = x[order], y[order]
    if len(x) <= MAX_POINTS:
        return x, y
    edges = np.linspace(x[0], x[-1], MAX_POINTS + 1)[1:-1]
    firsts = np.unique(np.concatenate(([0], np.searchsorted(x, edges))))
    counts = np.diff(np.append(firsts, len(x)))
    return np.add.reduceat(x, firsts) / counts, np.add.reduceat(y, firsts) / counts
