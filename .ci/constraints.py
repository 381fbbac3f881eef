"""Pip constraints: every package that is installed here, at its version, as it was tested.

``python .ci/constraints.py > constraints.txt`` writes them, from an environment that holds every
extra; with ``--check`` it says what is installed otherwise than ``constraints.txt`` has it.
"""

from __future__ import annotations

import re
import sys
from importlib.metadata import distributions
from pathlib import Path

PYTHON = f"{sys.version_info.major}.{sys.version_info.minor}"
HEAD = f"# What the gate tests on Python {PYTHON}: pip install -c constraints.txt dashpot"
OURS = {"dashpot", "pip", "setuptools", "wheel"}


def list_versions() -> dict[str, str]:
    """Return the version of every package, by its name as PyPI normalises it."""
    versions = {
        re.sub(r"[-_.]+", "-", distribution.metadata["Name"]).lower(): distribution.version
        for distribution in distributions()
    }
    return {name: versions[name] for name in sorted(versions.keys() - OURS)}


def main() -> None:
    """Write the constraints, or hold what is installed to them."""
    here = [f"{name}=={version}" for name, version in list_versions().items()]
    if "--check" not in sys.argv:
        print("\n".join([HEAD, *here]))
        return
    pinned = Path("constraints.txt").read_text("utf-8").splitlines()
    if pinned[0] != HEAD:
        print(f"constraints.txt is not of Python {PYTHON}: what is installed is not held to it")
        return
    strangers = sorted(set(here) - set(pinned))
    if strangers:
        sys.exit(
            f"not in constraints.txt: {', '.join(strangers)}; in an environment that holds every "
            "extra, write it again with: python .ci/constraints.py > constraints.txt"
        )


if __name__ == "__main__":
    main()
