"""Pip constraints: every dependency of the package at the lowest version admitted."""

import tomllib
from pathlib import Path

project = tomllib.loads(Path("pyproject.toml").read_text("utf-8"))["project"]
extras = project["optional-dependencies"]
for dependency in project["dependencies"] + [
    item for extra in ("io", "frames", "app", "batch", "cluster") for item in extras[extra]
]:
    print(dependency.replace(">=", "=="))
