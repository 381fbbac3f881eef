"""Binaries of an FMU for several platforms, by the C compiler of the package ziglang."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType

from dashpot.base.errors import ExportError

_PACKAGE = "ziglang"
_TIMEOUT = 600.0
"""s; the first compilation for a platform also compiles its C library."""

PLATFORMS: Mapping[str, Mapping[str, tuple[str, str]]] = MappingProxyType(
    {
        "fmi2": MappingProxyType(
            {
                "linux64": ("x86_64-linux-gnu.2.17", "so"),
                "win64": ("x86_64-windows-gnu", "dll"),
                "darwin64": ("x86_64-macos", "dylib"),
            }
        ),
        "fmi3": MappingProxyType(
            {
                "x86_64-linux": ("x86_64-linux-gnu.2.17", "so"),
                "aarch64-linux": ("aarch64-linux-gnu.2.17", "so"),
                "x86_64-windows": ("x86_64-windows-gnu", "dll"),
                "x86_64-darwin": ("x86_64-macos", "dylib"),
                "aarch64-darwin": ("aarch64-macos", "dylib"),
            }
        ),
    }
)
"""Platforms of each form: folder in the archive, name for the compiler, and suffix."""


def find_platforms(form: str) -> tuple[str, ...]:
    """Return the platforms that an FMU is compiled for here; none without the compiler."""
    return tuple(PLATFORMS[form]) if find_spec(_PACKAGE) is not None else ()


def compile_binaries(form: str, identifier: str, sources: Mapping[str, str]) -> dict[str, bytes]:
    """Return the shared library of each platform by its path in the archive.

    They repeat to the byte: no date, no path and no debugging symbols are in them.

    Raises
    ------
    ExportError
        If the compiler fails.
    """
    compiled = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, text in sources.items():
            (folder / file).write_text(text, encoding="ascii", newline="\n")
        for platform in find_platforms(form):
            machine, suffix = PLATFORMS[form][platform]
            library = f"{identifier}.{suffix}"
            command = [
                sys.executable, "-m", _PACKAGE, "cc", "-target", machine, "-shared", "-O2", "-fPIC",
                "-std=c99", "-s", "-fvisibility=hidden", "-ffp-contract=off", "-o", library,
                f"{form}.c",
            ]  # fmt: skip
            run = subprocess.run(  # noqa: S603  the compiler, with words of our own
                command, cwd=folder, capture_output=True, text=True, timeout=_TIMEOUT, check=False
            )
            if run.returncode:
                raise ExportError(
                    f"the C compiler of {_PACKAGE} failed for {platform}: "
                    f"{(run.stderr.strip() or 'no message').splitlines()[-1]}; uninstall it to "
                    "write an FMU of sources only"
                )
            compiled[f"binaries/{platform}/{library}"] = (folder / library).read_bytes()
    return compiled
