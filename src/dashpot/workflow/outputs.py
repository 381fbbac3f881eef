"""Output paths of results, protected against overwriting inputs or foreign files."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from dashpot.base import dataclass
from dashpot.base.errors import ExportError
from dashpot.base.file_writing import validate_path, write_atomic
from dashpot.base.version import is_ours, is_record

_HEAD_BYTES = 1 << 12
"""Bytes in which a file's byline stands; a PDF has it anywhere."""


@dataclass(frozen=True)
class Outputs:
    """Output files of a command.

    Attributes
    ----------
    inputs : tuple of str
        The files it reads, which are never written over.
    replace : bool
        Whether a file may be replaced that dashpot did not write.
    makes_records : bool
        Whether the work writes simulated records; to all other work they are measurements.
    """

    inputs: tuple[str, ...] = ()
    replace: bool = False
    makes_records: bool = False

    def check_writable(self, paths: Iterable[str | Path]) -> None:
        """Refuse, before any work is done, what could not be written at its end.

        Raises
        ------
        ExportError
            If a path is an input (by whatever name or link), a folder, in a place that cannot be
            written to, named twice, in a project, or an existing file that dashpot did not write.
        """
        claimed: set[str] = set()
        for path in map(validate_path, paths):
            reported_value = os.path.realpath(path)
            if reported_value in claimed:
                raise ExportError(f"{path} is named for two outputs; give each a name of its own")
            claimed.add(reported_value)
            self._refuse_input(path)
            if path.is_dir():
                raise ExportError(f"{path} is a folder; give the file to write in it")
            if path.exists():
                self._refuse_foreign(path)
            _refuse_closed(path)

    def write(self, path: str | Path, content: str | bytes) -> None:
        """Write a file atomically; create its folder if necessary."""
        self.check_writable([path])
        Path(path).parent.mkdir(parents=True, exist_ok=True)
        write_atomic(path, content.encode() if isinstance(content, str) else content)

    def _refuse_input(self, path: Path) -> None:
        for input_file in self.inputs:
            if _is_same_file(path, Path(input_file)):
                name = "" if str(path) == input_file else f" (it is {input_file})"
                raise ExportError(
                    f"{path} is a file that is read here{name} and is never written over; give "
                    "the output another name"
                )

    def _refuse_foreign(self, path: Path) -> None:
        if not path.is_file():
            return
        resolved_path = Path(os.path.realpath(path))
        if any((parent / "dashpot.toml").is_file() for parent in resolved_path.parents):
            raise ExportError(
                f"{path} belongs to a project, whose files are not replaced; give another name"
            )
        if self.replace:
            return
        first_lines = _read_head(path)
        if is_record(first_lines) and not self.makes_records:
            raise ExportError(
                f"{path} is a simulated record, an input like any measured one; give another "
                "name, or add --overwrite to replace it"
            )
        if first_lines and not is_ours(first_lines):
            raise ExportError(
                f"{path} exists and was not written by dashpot; give another name, or add "
                "--overwrite to replace it"
            )


def _is_same_file(path: Path, other: Path) -> bool:
    if os.path.realpath(path) == os.path.realpath(other):
        return True
    return path.exists() and other.exists() and path.samefile(other)


def _read_head(path: Path) -> bytes:
    """Return the part of a file that holds its byline."""
    with path.open("rb") as file:
        first_lines = file.read(_HEAD_BYTES)
        return first_lines + file.read() if first_lines.startswith(b"%PDF-") else first_lines


def _refuse_closed(path: Path) -> None:
    """Raise where the nearest folder that exists takes no new file, or the file no change."""
    if path.exists() and not path.is_file():
        return  # a device or a pipe
    if path.exists() and not os.access(path, os.W_OK):
        raise ExportError(f"{path} may only be read; give another name")
    folder = Path(os.path.realpath(path)).parent
    while not folder.exists():
        folder = folder.parent
    try:
        from tempfile import TemporaryFile

        with TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise ExportError(
            f"{path}: nothing can be written to {folder}: {error.strerror or error}; give "
            "another place"
        ) from None
