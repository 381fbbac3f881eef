"""The lot page on runs of lots, and a batch without any fit."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from kit.shell import ran

from dashpot.extensions.batch import page
from dashpot.extensions.batch.quantities import Quantity
from dashpot.extensions.batch.statistics.control_chart import Chart, Signal


def list_causes(values: list[float], broken: list[int]) -> list[dict[str, Any]]:
    x = np.array(values)
    signals = tuple(Signal(at, "beyond") for at in broken)
    chart = Chart("mean", x, float(x.mean()), x - 1, x + 1, signals)
    names = tuple("ABCDEFGH"[: len(values)])
    quantity = Quantity("k_end", "k_end_N_per_m", "stiffness", "N/mm")
    main: Any = SimpleNamespace(lots=SimpleNamespace(mean=chart, names=names), quantity=quantity)
    return list(page._list_causes(main))


def test_lot_page_lists_runs_on_both_sides_separately() -> None:
    low, high = list_causes([190.0, 203.0, 191.0, 202.0], [0, 1, 2, 3])
    assert low["name"] == "Lots A and C"
    assert low["message"].startswith("lie low: 0.1900 to 0.1910 N/mm")
    assert high["name"] == "Lots B and D"
    assert high["message"].startswith("lie high: 0.2020 to 0.2030 N/mm")


def test_lot_page_names_a_run_on_one_side_by_its_ends() -> None:
    (entry,) = list_causes([190.0, 191.0, 189.0, 250.0], [0, 1, 2])
    assert entry["name"] == "Lots A to C"
    assert entry["message"].startswith("lie low: 0.1890 to 0.1910 N/mm")


def test_a_batch_of_which_nothing_was_fitted_is_not_to_be_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "notes.csv").write_text("a;b\nno;number\n", encoding="utf-8")
    result = ran("batch", "notes.csv", "-o", "lot", "--jobs", "1")
    assert result.exit_code == 2, result.output
    assert result.stdout.startswith("Do not use: 0 of 1 files")
    assert "notes.csv: " in result.stdout
