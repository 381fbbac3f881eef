"""`read_test`: one function for every file of a bench."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from dashpot.base.errors import ReadError
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.workflow.bench_tests import read_test


def test_a_ramp_and_hold_is_a_relaxation_test(tmp_path: Path) -> None:
    t = np.arange(60) / 10
    x = np.clip(t, 0, 1) * 8
    path = tmp_path / "seal.csv"
    rows = "\n".join(f"{a:.3f},{b:.4f},{0.2 * b:.5f}" for a, b in zip(t, x, strict=True))
    path.write_text(f"time [s],displacement [mm],force [N]\n{rows}\n")
    assert isinstance(read_test(path), RelaxationTest)


def test_a_sweep_is_a_dynamic_test(tmp_path: Path) -> None:
    path = tmp_path / "dma.csv"
    path.write_text("f,E_stor,E_loss\nHz,MPa,MPa\n1,10,1\n2,11,1.1\n5,12,1.2\n")
    bench = read_test(path, specimen=Specimen(temperature=296.0))
    assert isinstance(bench, DynamicTest)
    assert bench.storage[0] == pytest.approx(10e6)
    assert bench.specimen.temperature == 296.0


def test_anything_else_keeps_the_sentence_of_the_relaxation_reader(tmp_path: Path) -> None:
    path = tmp_path / "odd.csv"
    path.write_text("time [s],colour\n1,2\n2,3\n3,4\n")
    with pytest.raises(ReadError, match="displacement"):
        read_test(path)


@pytest.mark.parametrize(
    "header", ["time [s],displacement [mm],force [N]", "f [Hz],E_stor [MPa],E_loss [MPa]"]
)
def test_read_test_opens_a_file_a_single_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, header: str
) -> None:
    path = tmp_path / "bench.csv"
    rows = "\n".join(f"{i + 1},{min(i, 5)},{min(i, 5) / 2}" for i in range(9))
    path.write_text(f"{header}\n{rows}\n")
    opened = []
    plain = Path.open

    def count_reads(self: Path, *args: object, **kwargs: object) -> object:
        opened.append(self)
        return plain(self, *args, **kwargs)

    monkeypatch.setattr(Path, "open", count_reads)
    read_test(path)
    assert opened == [path]
