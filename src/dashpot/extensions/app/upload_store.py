"""Uploaded files, kept by their hash in a temporary folder of the server."""

from __future__ import annotations

import hashlib
import re
import shutil
import tempfile
from collections.abc import AsyncIterator
from contextlib import ExitStack, suppress
from pathlib import Path

from dashpot.base.errors import DataError, ReadError
from dashpot.base.file_writing import open_exclusive_lock

LIMIT = 200 << 20
"""Bytes of one file, at most."""
MOST = 120
"""Bytes of a name, at most: its end is kept, which says the format."""
_NAMED, _LOCK = "dashpot-", ".lock"
"""How the folder of a server is named, and what in it says that the server lives."""
_ID = re.compile(r"[0-9a-f]{16}")


class TooLargeError(DataError):
    """Error of a file above the size limit."""


class Store:
    """Uploaded files by identity: the first sixteen digits of the hash of contents and name.

    Parameters
    ----------
    folder : path, optional
        Where they lie; by default a new folder of the system's temporary ones.
    """

    def __init__(self, folder: str | Path | None = None) -> None:
        self.folder = Path(folder or tempfile.mkdtemp(prefix=_NAMED))
        self._held = ExitStack()
        if folder is None:
            self._held.enter_context(open_exclusive_lock(self.folder / _LOCK, str(self.folder)))

    async def keep(self, name: str, blocks: AsyncIterator[bytes], *, limit: int = LIMIT) -> str:
        """Write a file as it comes, and return its identity.

        Raises
        ------
        TooLargeError
            As soon as it is longer than `limit`; nothing of it is kept.
        """
        named = plain_name(name)
        digest, size = hashlib.sha256(named.encode() + b"\0"), 0
        with tempfile.NamedTemporaryFile(dir=self.folder, delete=False) as part:
            try:
                async for block in blocks:
                    size += len(block)
                    if size > limit:
                        raise TooLargeError(
                            f"{named} is larger than {limit >> 20} MB; read it with 'dashpot fit', "
                            "which has no such limit"
                        )
                    digest.update(block)
                    part.write(block)
            except BaseException:
                Path(part.name).unlink(missing_ok=True)
                raise
        identity = digest.hexdigest()[:16]
        home = self.folder / identity
        home.mkdir(exist_ok=True)
        Path(part.name).replace(home / named)
        return identity

    def put(self, name: str, content: bytes) -> str:
        """Write a file that is at hand, and return its identity."""
        named = plain_name(name)
        identity = hashlib.sha256(named.encode() + b"\0" + content).hexdigest()[:16]
        home = self.folder / identity
        home.mkdir(exist_ok=True)
        (home / named).write_bytes(content)
        return identity

    def remove(self) -> None:
        """Leave nothing behind."""
        self._held.close()
        shutil.rmtree(self.folder, ignore_errors=True)


def remove_stale_stores() -> None:
    """Remove what servers left that were killed together with all their workers."""
    for lock in Path(tempfile.gettempdir()).glob(f"{_NAMED}*/{_LOCK}"):
        with suppress(DataError, OSError), open_exclusive_lock(lock, ""):
            shutil.rmtree(lock.parent)


def path_in(folder: Path, identity: object) -> Path:
    """Return the file of an identity.

    Raises
    ------
    ReadError
        If there is none.
    """
    if isinstance(identity, str) and _ID.fullmatch(identity):
        paths = [*(folder / identity).glob("*")]
        if paths:
            return paths[0]
    raise ReadError("this file is no longer here: open it again")


def plain_name(name: str) -> str:
    """Return the last part of a name, without what a file system or a terminal would obey."""
    last = re.split(r"[/\\]", name)[-1]
    clean = "".join(c if c.isprintable() and c not in '<>:"|?*' else "_" for c in last).strip(". ")
    # a file system counts bytes
    return clean.encode()[-MOST:].decode(errors="ignore") or "file"
