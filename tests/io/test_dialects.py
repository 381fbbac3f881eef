"""The dialects of many labs give one record."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from kit.look_alikes import DIALECTS, truth

from dashpot.io.readers.inspect import inspect_file
from dashpot.io.readers.relaxation import read_relaxation


@pytest.mark.parametrize("dialect", DIALECTS, ids=lambda d: d.name)
def test_dialect(tmp_path: Path, dialect) -> None:
    path = tmp_path / "test.txt"
    path.write_bytes(dialect.content)
    test = read_relaxation(path)
    time, moved, force = truth()
    np.testing.assert_allclose(test.time, time, atol=1e-9)
    np.testing.assert_allclose(test.displacement, moved * 1e-3, atol=1e-12)
    np.testing.assert_allclose(test.force, force, atol=1e-9)
    found = inspect_file(path)
    assert found.kind == "relaxation"
    assert not found.questions
    assert found.rows == len(time)
    assert {c.role for c in found.columns} >= {"time", "displacement", "force"}
