"""Treacherous files: read right, with a note, or refused with the line; never wrong in silence."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from kit.look_alikes import truth
from kit.treacherous import CASES, Case

from dashpot.base.errors import ReadError
from dashpot.io.options import ReadOptions
from dashpot.io.readers.inspect import inspect_file
from dashpot.io.readers.relaxation import read_relaxation


def is_the_truth(path: Path, case: Case, **answer: object) -> None:
    test = read_relaxation(path, options=ReadOptions(**answer))
    keep = np.setdiff1d(np.arange(len(truth()[0])), case.without)
    time, moved, force = (values[keep] for values in truth())
    np.testing.assert_allclose(test.time - test.time[0], case.slow * time, atol=1e-6)
    np.testing.assert_allclose(test.displacement, moved * 1e-3, atol=1e-9)
    np.testing.assert_allclose(test.force, force, atol=case.coarse)
    assert case.noted in " ".join(test.source.notes)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_case(tmp_path: Path, case: Case) -> None:
    path = tmp_path / "case.csv"
    path.write_bytes(case.content)
    if not case.refused:
        is_the_truth(path, case)
        return
    with pytest.raises(ReadError) as caught:
        read_relaxation(path)
    message = str(caught.value)
    assert all(word in message for word in case.refused), message
    if case.answer:
        assert inspect_file(path).questions
        is_the_truth(path, case, **case.answer)


def test_there_are_enough() -> None:
    assert len({case.name for case in CASES}) == len(CASES) >= 55
