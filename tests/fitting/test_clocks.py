"""Clocks that jump in mid-record: the verdict on no such fit is "use"."""

from __future__ import annotations

from pathlib import Path

import pytest
from kit.crafted.clocks import bench, leapt

from dashpot.base.errors import FitError
from dashpot.fitting.relaxation import fit
from dashpot.preprocessing.prepare import prepare
from dashpot.reading.readers.relaxation import read_relaxation


@pytest.mark.parametrize("by", [60.0, 3600.0])
def test_what_is_fitted_to_it_is_not_to_be_used(tmp_path: Path, by: float) -> None:
    path = tmp_path / "leap.csv"
    path.write_bytes(bench(leapt((10.0, by))))
    result = fit(prepare(read_relaxation(path)), arms=2, law="linear")
    assert result.verdict.use == "do not use"
    assert f"The clock goes on by {by:g} s" in result.verdict.message


def test_what_cannot_be_fitted_names_the_clock(tmp_path: Path) -> None:
    path = tmp_path / "leap.csv"
    path.write_bytes(bench(leapt((10.0, 1e5))))
    with pytest.raises(FitError, match=r"The clock jumped, .* As it is, the data bound nothing"):
        fit(prepare(read_relaxation(path)))
