"""Strain and stress over time in every container: recognised, read as stored, or asked about."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from kit.material_histories import HISTORIES, History

from dashpot.base.errors import ReadError
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.detect_kind import recognise
from dashpot.reading.readers.inspect import inspect_file
from dashpot.registry import KINDS, load_object

ROWS = 60
"""How many the table holds, at least."""


def read_record(path: Path, **answer: Any) -> Any:
    options = ReadOptions(**answer)
    kind = recognise(path, options).kind
    mode = ["uniaxial"] if kind == "stress-strain" else []
    return load_object(KINDS[kind].reader)(path, *mode, options=options)


def assert_holds(record: Any, history: History) -> None:
    time, strain, stress = history.truth
    displacement, pushed = history.sign
    columns = ("displacement", "force") if hasattr(record, "force") else ("strain", "stress")
    read_strain, read_stress = (getattr(record, name) for name in columns)
    np.testing.assert_allclose(record.time - record.time[0], time - time[0], atol=2e-3)
    np.testing.assert_allclose(displacement * read_strain, strain, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(pushed * read_stress, 1e6 * stress, rtol=1e-5, atol=10)


@pytest.mark.parametrize("history", HISTORIES, ids=lambda history: history.name)
def test_recognise_and_read_every_history(tmp_path: Path, history: History) -> None:
    path = history.write(tmp_path)
    if history.kind:
        assert recognise(path).kind == history.kind
    if history.question:
        with pytest.raises(ReadError) as caught:
            read_record(path)
        assert history.question in str(caught.value)
    else:
        assert not inspect_file(path).questions
    assert_holds(read_record(path, **history.answer), history)


def test_the_table_of_histories_is_long_enough() -> None:
    assert len({history.name for history in HISTORIES}) == len(HISTORIES) >= ROWS
