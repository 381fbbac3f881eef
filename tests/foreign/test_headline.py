"""The first sentence of a result: nowhere in its band is it wrong by more than it says."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from kit.foreign.catalogue import verdict_records
from kit.foreign.gaps import off
from kit.foreign.truths import TRUTHS

import dashpot as dp
from dashpot.preprocessing.prepare import prepare

RIGS = ("none", "white 10 mN", "skew 2 ms", "drift .5 mN/s", "hum 50 Hz")
SHORT = ("none",)


def claims(names: tuple[str, ...], seed: int, *, every: int = 1) -> Iterator[tuple[float, dp.Fit]]:
    """The largest error over the band over what is said of it, of each that is called "use"."""
    for record in verdict_records(TRUTHS[::every], list(names), seed):
        test = dp.RelaxationTest(record.time, record.displacement, record.force, units="SI")
        fit = dp.fit(prepare(test, machine=dp.Machine(**record.machine_options)))
        if fit.verdict.use != "use":
            continue
        lines = np.geomspace(*fit.band, 40)
        K = fit.model_at(record.seal.depth).complex_stiffness(omega=2 * np.pi * lines)
        errors = off(record.seal, lines, K)
        yield max(e / c for e, c in zip(errors, fit._error_in_band, strict=True)), fit


def test_a_headline_is_right_and_no_loss_factor_worse_than_30_percent_is_in_use() -> None:
    every = list(claims(SHORT, 7, every=4))
    assert len(every) >= 7
    assert max(error for error, _ in every) <= 1.0
    for _, fit in every:
        assert fit._error_in_band[1] <= 0.3
        assert f"±{100 * fit._error_in_band[1]:.2g} %" in str(fit.verdict)


@pytest.mark.slow
def test_of_many_headlines_few_are_off_by_more_than_they_say() -> None:
    every = [error for error, _ in claims(RIGS, 8)]
    assert len(every) >= 150
    assert np.mean(np.array(every) > 1.0) <= 0.06
