"""What many tests share: the paper's seal, and the folder of real measurements."""

from __future__ import annotations

import gc
import os
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path

import pytest
from hypothesis import settings

# one worker per core already: threads of BLAS beside them only wait for each other
for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")

import numpy as np  # noqa: E402
from kit.cost import waiting  # noqa: E402
from kit.fuzzing import Fuzzer  # noqa: E402

from dashpot.datamodel.fit import Fit  # noqa: E402
from dashpot.datamodel.frf import FRF  # noqa: E402
from dashpot.datamodel.relaxation import RampHold  # noqa: E402
from dashpot.fitting.relaxation import fit  # noqa: E402
from dashpot.preprocessing.prepare import prepare  # noqa: E402
from dashpot.simulation.impact import simulate_impact  # noqa: E402
from dashpot.simulation.relaxation import simulate_relaxation  # noqa: E402
from dashpot.solids.demo_seals import BROAD, BROAD_MASS  # noqa: E402
from dashpot.solids.maxwell import GeneralizedMaxwell  # noqa: E402
from dashpot.vibration.impact.frf_estimation import estimate_frf  # noqa: E402

collect_ignore = ["public_use.py", "data/asammdf/write.py", "data/pyarrow/write.py"]
"""Read by a type checker, or run by hand with libraries that the tests do without."""

# how long an example takes is the machine's affair; by day a law is tried on a few, the same each
# time: what a new one finds is no fault of who works there, and is looked for at night
settings.register_profile("night", deadline=None, max_examples=200)
settings.register_profile("day", deadline=None, max_examples=20, derandomize=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "day"))


@pytest.fixture(autouse=True)
def same_numbers(request: pytest.FixtureRequest) -> Iterator[None]:
    """A module's generator gives each of its tests the same numbers, whatever ran before."""
    names = vars(request.module) if isinstance(request.node, pytest.Function) else {}
    ours = [g for g in names.values() if isinstance(g, np.random.Generator)]
    states = [g.bit_generator.state for g in ours]
    yield
    for g, state in zip(ours, states, strict=True):
        g.bit_generator.state = state


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[None]:
    """Look for no garbage among what collecting makes: all of it stays. It took a tenth of that."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.set_threshold(10_000)  # few tests leave rings; looking for them took a fiftieth
        gc.enable()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Let the cases of dear tests that need not run every time wait with the slow ones."""
    for item in waiting(items):
        item.add_marker(pytest.mark.slow)


@pytest.fixture(scope="session")
def real_data() -> Path:
    """The real measurements that come with the tests, each folder with its licence."""
    return Path(__file__).parent / "data"


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Real measurements too large for the repository, beside it; skips where they are missing."""
    folder = Path(__file__).resolve().parents[2] / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(f"real measurements not found at {folder}; they are not part of the project")
    return folder


@pytest.fixture(scope="module")
def fuzzer() -> Iterator[Fuzzer]:
    """The process that mutants are given to."""
    with closing(Fuzzer()) as item:
        yield item


@pytest.fixture
def mutants(fuzzer: Fuzzer, record_property: Callable[[str, object], None]) -> Iterator[None]:
    """Count what a test tries, for docs/quality.md."""
    before = fuzzer.tries
    yield
    record_property("mutants", fuzzer.tries - before)


@pytest.fixture(scope="session")
def paper_seal() -> GeneralizedMaxwell:
    """Table 1 of the paper, in SI units."""
    return GeneralizedMaxwell(k_inf=196.5, k=(117.5, 17.8), tau=(59.0 / 117.5, 292.2 / 17.8))


@pytest.fixture(scope="session")
def broad_test() -> RampHold:
    """The broad seal on the virtual rig."""
    return prepare(simulate_relaxation(BROAD, seed=3).test)


@pytest.fixture(scope="session")
def broad_fit(broad_test: RampHold) -> Fit:
    """What that test shows of it."""
    return fit(broad_test)


@pytest.fixture(scope="session")
def broad_frf() -> FRF:
    """The broad seal under the virtual hammer."""
    return estimate_frf(simulate_impact(BROAD, mass=BROAD_MASS, seed=3).test)
