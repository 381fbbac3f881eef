"""The examples of the verbs run beside the example files, as a user runs them."""

from __future__ import annotations

from pathlib import Path

import pytest

_FILES = ("seal_8mm.csv", "hammer.csv", "cld_1.csv")


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    """Leave out what has no example: to import it only to find none took a tenth of collecting."""
    if collection_path.suffix == ".py" and b">>>" not in collection_path.read_bytes():
        return True
    return None


@pytest.fixture(scope="session")
def example_files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the example files that the docstrings name."""
    from dashpot.workflow.example_files import EXAMPLES

    folder = tmp_path_factory.mktemp("examples")
    for name in _FILES:
        (folder / name).write_text(EXAMPLES[name](), encoding="utf-8")
    return folder


@pytest.fixture(autouse=True)
def _beside_the_example_files(
    request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> None:
    name = getattr(getattr(request.node, "dtest", None), "name", "")
    if name == "dashpot" or name.startswith("dashpot.api."):
        monkeypatch.chdir(request.getfixturevalue("example_files"))
