"""Uploaded files, kept by their hash in a temporary folder of the server."""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import tempfile
from collections.abc import AsyncIterator, Callable
from contextlib import ExitStack, suppress
from pathlib import Path

from dashpot.base.errors import DataError, ReadError
from dashpot.base.file_writing import open_exclusive_lock

MAX_FILE_BYTES = 200 << 20
"""Bytes of one file, at most."""
MAX_TOTAL_BYTES = 2 << 30
"""Bytes of all files of a server, at most."""
MAX_NAME_BYTES = 240
"""Largest length of a name, bytes; its start and its suffix are kept."""
_FOLDER_PREFIX, _LOCK_NAME = "dashpot-", ".lock"
"""Prefix of a server's folder, and its lock file."""
_IDENTITY = re.compile(r"([0-9a-f]{16})(?:-[0-9a-f]{8})?")
"""Identity of a file, with the specimen after a dash."""
_DIGITS = 16
"""Digits of the identity of a file."""
_ORIGINS = "origins"
"""Folder with the original path of each file on this machine; no identity is called so."""


class TooLargeError(DataError):
    """Error of a file above the size limit."""


class Store:
    """Uploaded files by identity: the first sixteen digits of the hash of contents and name.

    Parameters
    ----------
    folder : path, optional
        Folder of the files; by default a new folder of the system's temporary ones.
    """

    def __init__(self, folder: str | Path | None = None) -> None:
        self.folder = Path(folder or tempfile.mkdtemp(prefix=_FOLDER_PREFIX))
        self._stored_size = ExitStack()
        if folder is None:
            self._stored_size.enter_context(
                open_exclusive_lock(self.folder / _LOCK_NAME, str(self.folder))
            )

    async def keep(
        self,
        name: str,
        blocks: AsyncIterator[bytes],
        *,
        limit: int = MAX_FILE_BYTES,
        total: int = MAX_TOTAL_BYTES,
        modified: float | None = None,
    ) -> str:
        """Write a file as it comes, and return its identity.

        Parameters
        ----------
        name : str
        blocks : async iterator of bytes
        limit, total : int
            Bytes of this file, and of it and all others, at most.
        modified : float, optional
            When its contents were changed last, s since 1970.

        Raises
        ------
        TooLargeError
            As soon as it is longer than `limit`, or all files than `total`; nothing of it is kept.
        """
        file_name, other_bytes = make_safe_name(name), sum(size for _, size in self._sizes())
        digest, size = hashlib.sha256(file_name.encode() + b"\0"), 0
        with tempfile.NamedTemporaryFile(dir=self.folder, delete=False) as temporary_file:
            try:
                async for block in blocks:
                    size += len(block)
                    if size > limit:
                        raise TooLargeError(
                            f"{file_name} is larger than {limit >> 20} MB; read it with 'dashpot "
                            "fit', which has no such limit"
                        )
                    if other_bytes + size > total:
                        raise TooLargeError(
                            f"the open files are larger than {total >> 20} MB together: remove "
                            f"some, and open {file_name} again"
                        )
                    digest.update(block)
                    temporary_file.write(block)
            except BaseException:
                Path(temporary_file.name).unlink(missing_ok=True)
                raise
        identity = digest.hexdigest()[:16]
        folder = self.folder / identity
        folder.mkdir(exist_ok=True)
        Path(temporary_file.name).replace(folder / file_name)
        _set_modified(folder / file_name, modified)
        return identity

    def put(
        self,
        name: str,
        content: bytes,
        *,
        origin: Path | None = None,
        stamp: tuple[int, ...] | None = None,
        modified: float | None = None,
    ) -> str:
        """Write a file that is at hand, and return its identity.

        `origin` is where on this machine it was read, `stamp` what :func:`get_file_stamp` said of
        it before; without one nothing is watched.
        """
        file_name = make_safe_name(name)
        identity = hashlib.sha256(file_name.encode() + b"\0" + content).hexdigest()[:16]
        folder = self.folder / identity
        folder.mkdir(exist_ok=True)
        (folder / file_name).write_bytes(content)
        _set_modified(folder / file_name, modified)
        if origin is not None and stamp is not None:
            origins_folder = self.folder / _ORIGINS
            origins_folder.mkdir(exist_ok=True)
            origin_text = json.dumps([str(origin.resolve()), stamp])
            (origins_folder / identity).write_text(origin_text, encoding="utf-8")
        return identity

    def put_file(self, path: Path) -> str:
        """Write a file of this machine, from then on watched there, and return its identity."""
        # of one that is written meanwhile the stamp is older than the contents: it is read again
        stamp = get_file_stamp(path)
        content = path.read_bytes()
        modified = path.stat().st_mtime
        return self.put(path.name, content, origin=path, stamp=stamp, modified=modified)

    def get_origin(self, identity: str) -> tuple[Path, tuple[int, ...]] | None:
        """Return where a file was read and its stamp then; None of an uploaded file."""
        try:
            origin_text = (self.folder / _ORIGINS / identity[:_DIGITS]).read_text(encoding="utf-8")
        except FileNotFoundError:
            return None
        path, stamp = json.loads(origin_text)
        return Path(path), tuple(stamp)

    def _sizes(self) -> list[tuple[Path, int]]:
        """Return each file with its bytes, the oldest first."""
        paths = [path for folder in self.folder.iterdir() if _IDENTITY.fullmatch(folder.name)
                 for path in folder.iterdir()]  # fmt: skip
        paths.sort(key=lambda path: path.parent.stat().st_mtime)
        return [(path, path.stat().st_size) for path in paths]

    def make_room(self, is_wanted: Callable[[str], bool], *, total: int = MAX_TOTAL_BYTES) -> None:
        """Remove the oldest files that are not wanted until half of `total` is free."""
        files = self._sizes()
        used_bytes = sum(size for _, size in files)
        for path, size in files:
            if used_bytes <= total / 2:
                return
            if not is_wanted(path.parent.name):
                shutil.rmtree(path.parent, ignore_errors=True)
                used_bytes -= size

    def remove(self) -> None:
        """Delete the store."""
        self._stored_size.close()
        shutil.rmtree(self.folder, ignore_errors=True)


def get_file_stamp(path: Path) -> tuple[int, ...] | None:
    """Return size, times and number of a file, which change with it; None if it is missing.

    The time of the directory entry cannot be set back, as that of the contents can.
    """
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_size, status.st_mtime_ns, status.st_ctime_ns, status.st_ino


def _set_modified(path: Path, modified: float | None) -> None:
    """Give a kept file the time of its contents, where that is known."""
    if modified is not None:
        with suppress(OSError, OverflowError):
            os.utime(path, (modified, modified))


def remove_stale_stores() -> None:
    """Delete the stores of servers that were killed with all their workers."""
    for lock in Path(tempfile.gettempdir()).glob(f"{_FOLDER_PREFIX}*/{_LOCK_NAME}"):
        with suppress(DataError, OSError), open_exclusive_lock(lock, ""):
            shutil.rmtree(lock.parent)


def identify_specimen(identity: str, selection: str) -> str:
    """Return the identity of one specimen of a file, by what ``--file-part`` takes for it.

    >>> identify_specimen("0123456789abcdef", "segment=2")
    '0123456789abcdef-e448b07e'
    """
    digest = hashlib.sha256(selection.encode()).hexdigest()
    return f"{identity[:_DIGITS]}-{digest[:8]}" if selection else identity[:_DIGITS]


def find_file(folder: Path, identity: object) -> Path:
    """Return the file of an identity.

    Raises
    ------
    ReadError
        If there is none.
    """
    match = _IDENTITY.fullmatch(identity) if isinstance(identity, str) else None
    if match:
        paths = [*(folder / match[1]).glob("*")]
        if paths:
            return paths[0]
    raise ReadError("this file is no longer here: open it again")


def make_safe_name(name: str) -> str:
    """Return the last part of a name, without what a file system or a terminal would obey."""
    base_name = re.split(r"[/\\]", name)[-1]
    printable = "".join(
        c if c.isprintable() and c not in '<>:"|?*' else "_" for c in base_name
    ).strip(". ")
    # a file system counts bytes
    encoded_name = printable.encode()
    if len(encoded_name) <= MAX_NAME_BYTES:
        return printable or "file"
    kept_ends = encoded_name[: MAX_NAME_BYTES // 2], encoded_name[-(MAX_NAME_BYTES // 2 - 1) :]
    return "_".join(end.decode(errors="ignore") for end in kept_ends)
