"""Thinning keeps every excursion and every mean."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dashpot.plot.plotted_data import downsample_to_extremes, downsample_to_means


def record(seed: int, size: int) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    return np.cumsum(random.uniform(1e-3, 1.0, size)), random.standard_normal(size)


@given(st.integers(0, 10_000), st.integers(2, 3000), st.integers(1, 200), st.booleans())
def test_the_highest_and_the_lowest_sample_of_every_bin_stay(seed, size, bins, log):
    x, y = record(seed, size)
    retained, selected = downsample_to_extremes(x, y, bins=bins, log=log)
    assert len(retained) <= max(2 * bins, size if size <= 2 * bins else 0)
    assert np.all(np.diff(retained) > 0)
    # only samples, none invented
    place = np.searchsorted(x, retained)
    assert np.array_equal(x[place], retained)
    assert np.array_equal(y[place], selected)
    scale = np.log(x) if log else x
    edges = np.linspace(scale[0], scale[-1], bins + 1)
    label = np.clip(np.searchsorted(edges, scale, side="right") - 1, 0, bins - 1)
    for part in np.unique(label):
        inside = y[label == part]
        shown = selected[label[place] == part]
        # a sample on an edge may fall to either side: allow the neighbours
        near = selected[np.abs(label[place] - part) <= 1]
        assert near.max() >= inside.max()
        assert near.min() <= inside.min()
        assert shown.size or near.size


@given(st.integers(0, 10_000), st.integers(1, 2000), st.integers(1, 200))
def test_means_keep_the_mean(seed, size, bins):
    x, y = record(seed, size)
    mean_x, mean_y = downsample_to_means(x, y, bins=bins)
    assert len(mean_x) <= bins
    assert np.all(np.diff(mean_x) > 0)
    assert y.min() - 1e-12 <= mean_y.min()
    assert mean_y.max() <= y.max() + 1e-12
    if bins == 1:
        assert mean_y[0] == pytest.approx(y.mean(), abs=1e-12)


def test_downsample_returns_a_short_record_unchanged():
    x, y = np.array([-1.0, 0.0, 0.5, 2.0]), np.array([1.0, 2.0, 3.0, 4.0])
    assert [a.tolist() for a in downsample_to_extremes(x, y)] == [x.tolist(), y.tolist()]
    assert downsample_to_extremes(x, y, log=True)[0].tolist() == [0.5, 2.0]
    assert downsample_to_means(x[:2], y[:2], log=True)[0].size == 0


def test_downsample_retains_a_single_spike():
    x = np.arange(1, 1_000_001, dtype=float)
    y = np.zeros_like(x)
    y[777_777] = 1.0
    assert downsample_to_extremes(x, y, bins=100, log=True)[1].max() == 1.0
