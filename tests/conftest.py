"""What many tests share: the paper's seal, and the folder of real measurements."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import settings

# one worker per core already: threads of BLAS beside them only wait for each other
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")

from dashpot.solids.maxwell import GeneralizedMaxwell  # noqa: E402

# how long an example takes is the machine's affair
settings.register_profile("dashpot", deadline=None)
settings.load_profile("dashpot")


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of real measurements beside the repository; skips where it is missing."""
    folder = Path(__file__).resolve().parents[2] / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(f"real measurements not found at {folder}; they are not part of the project")
    return folder


@pytest.fixture(scope="session")
def paper_seal() -> GeneralizedMaxwell:
    """Table 1 of the paper, in SI units."""
    return GeneralizedMaxwell(k_inf=196.5, k=(117.5, 17.8), tau=(59.0 / 117.5, 292.2 / 17.8))
