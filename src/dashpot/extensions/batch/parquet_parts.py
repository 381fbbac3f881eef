"""Table rows on disk as Parquet parts, written atomically and found by their inputs."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import astuple, dataclass
from io import BytesIO
from itertools import islice
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import TYPE_CHECKING, Any, Literal, cast

from dashpot.base.errors import DataError, ExportError
from dashpot.base.file_writing import PART, validate_path, write_atomic
from dashpot.base.serialisation import to_plain_value
from dashpot.base.version import __version__
from dashpot.extensions.batch.batch_options import BatchOptions
from dashpot.extensions.batch.columns import (
    COUNT_COLUMNS,
    RETRIED_OUTCOMES,
    TEXT_COLUMNS,
    list_number_columns,
)
from dashpot.extensions.batch.input_files import Entry, compute_file_hash
from dashpot.registry import format_install_command

if TYPE_CHECKING:
    import polars as pl


KEY = "key"
"""Column with the key of a row: a hash of its inputs."""
PART_PATTERN = "part-*.parquet"
SMALL_PART = 25
"""Number of rows below which a part is small; as many small parts are merged."""
_FORM = 4
"""Version of the row format; it is part of the key."""


_KEY_WIDE = 64


@dataclass(frozen=True, slots=True)
class Task:
    """Row to be computed.

    Attributes
    ----------
    serialised : str
        Key and entry as text: a batch holds one task per file, and as objects they need twice the
        memory.
    """

    serialised: str

    @staticmethod
    def from_entry(entry: Entry, hashes: Sequence[str], key: str) -> Task:
        """Return the task of a test, by the key of its row and the hashes of its files."""
        return Task(key + json.dumps([*astuple(entry), hashes], separators=(",", ":")))

    @property
    def key(self) -> str:
        """SHA-256 of everything that decides the row."""
        return self.serialised[:_KEY_WIDE]

    @property
    def entry(self) -> Entry:
        """Entry of the test."""
        return Entry.from_plain(dict(zip(Entry.__slots__, self._words, strict=False)))

    @property
    def hashes(self) -> tuple[str, ...]:
        """Hashes of its file, and of the hammer file."""
        return tuple(self._words[-1])

    @property
    def _words(self) -> list[Any]:
        words: list[Any] = json.loads(self.serialised[_KEY_WIDE:])
        return words


def make_tasks(
    entries: Iterable[Entry],
    options: BatchOptions,
    *,
    compute_hash: Callable[[str], str] = compute_file_hash,
) -> tuple[Task, ...]:
    """Return one task for each test, with a key from configuration, version and contents."""
    key_parts = [_FORM, __version__, to_plain_value(options), options.calibration()]
    common = hashlib.sha256(json.dumps(key_parts, sort_keys=True).encode())

    def task(entry: Entry) -> Task:
        key, hashes = common.copy(), entry.hashes(compute_hash)
        key.update(json.dumps([to_plain_value(entry), hashes], sort_keys=True).encode())
        return Task.from_entry(entry, hashes, key.hexdigest())

    return tuple(map(task, entries))


def import_polars() -> Any:
    """Return polars, or say how to get it."""
    try:
        import polars as pl
    except ImportError:
        advice = format_install_command("batch")
        raise ExportError(
            f"a lot is a table of polars, which is not installed; install it with: {advice}"
        ) from None
    return pl


def get_schema(options: BatchOptions) -> dict[str, Any]:
    """Return the columns of the table and their types."""
    polars = import_polars()
    numbers = list_number_columns(options)
    texts = dict.fromkeys((*TEXT_COLUMNS, KEY), polars.String)
    return (
        texts | dict.fromkeys(COUNT_COLUMNS, polars.Int64) | dict.fromkeys(numbers, polars.Float64)
    )


def write_part(folder: Path, rows: pl.DataFrame) -> Path:
    """Write rows as one part, atomically; its name is a hash of their keys."""
    rows = rows.sort("file")
    name = hashlib.sha256("".join(sorted(rows[KEY])).encode()).hexdigest()[:16]
    path, content = folder / f"part-{name}.parquet", BytesIO()
    rows.write_parquet(content)
    write_atomic(path, content.getvalue())
    return path


def build_row_frame(rows: Sequence[Mapping[str, Any]], options: BatchOptions) -> pl.DataFrame:
    """Return rows as a table."""
    return cast("pl.DataFrame", import_polars().DataFrame(rows, schema=get_schema(options)))


def read_parts(folder: Path) -> Iterator[tuple[Path, pl.DataFrame]]:
    """Yield the parts in a folder; skip those that cannot be read."""
    for path in sorted(folder.glob(PART_PATTERN)):
        try:
            frame = import_polars().read_parquet(path.read_bytes())
        except (OSError, import_polars().exceptions.PolarsError):
            continue
        if {KEY, "outcome", "file"} <= set(frame.columns):
            yield path, frame


def join_frames(
    frames: Iterable[pl.DataFrame], direction: Literal["vertical", "diagonal"] = "vertical"
) -> pl.DataFrame:
    """Return tables as one; few are in memory at once, as each needs ten times its contents."""
    frames_joined: list[pl.DataFrame] = []
    frame_iterator = iter(frames)
    while batch_of_frames := list(islice(frame_iterator, SMALL_PART)):
        frames_joined.append(import_polars().concat(batch_of_frames, how=direction, rechunk=True))
    return cast(
        "pl.DataFrame",
        import_polars().concat(frames_joined or [import_polars().DataFrame()], how=direction),
    )


def list_done_keys(folder: Path) -> set[str]:
    """Return the keys of the rows that need not be computed again."""
    return {
        key
        for _, frame in read_parts(folder)
        for key, outcome in frame.select(KEY, "outcome").iter_rows()
        if outcome not in RETRIED_OUTCOMES
    }


def collect_table(folder: Path, wanted_keys: Iterable[str]) -> pl.DataFrame:
    """Keep only the wanted parts in the folder, and return them, sorted by file.

    Old rows, duplicates and incomplete files are deleted. Rows to keep are written before their old
    part is deleted, so that an interrupted run loses none.

    Raises
    ------
    DataError
        If a part was deleted meanwhile.
    """
    part_files = set(folder.glob(PART_PATTERN))
    # where the first row of a part is sorted, all are after most runs, and sorting takes two copies
    parts = {
        path: (bool(frame["outcome"].is_in(RETRIED_OUTCOMES).any()), frame["file"][0])
        for path, frame in read_parts(folder)
        if frame.height
    }
    missing = set(wanted_keys)
    count = len(missing)
    frame = join_frames(
        _extract_missing_rows(folder, sorted(parts, key=lambda path: parts[path]), missing)
    )
    for path in (*(part_files - parts.keys()), *folder.glob(f".*{PART}")):
        path.unlink()
    _gather(folder)
    if missing:
        raise DataError(
            f"{folder} holds {count - len(missing)} of {count} rows: parts of it went while the "
            "batch ran; run it again"
        )
    return frame if frame["file"].is_sorted() else frame.sort("file")


def _extract_missing_rows(
    folder: Path, parts: Iterable[Path], missing: set[str]
) -> Iterator[pl.DataFrame]:
    """Yield of each part the rows that are still missing; leave no others in the folder."""
    for path in parts:
        frame = import_polars().read_parquet(path.read_bytes())
        kept_keys = missing.intersection(frame[KEY])
        missing -= kept_keys
        is_whole = len(kept_keys) == frame.height
        kept_rows = (
            frame if is_whole else frame.filter(import_polars().col(KEY).is_in(list(kept_keys)))
        )
        if kept_keys:
            yield kept_rows
        if not kept_keys or (
            kept_rows.height != frame.height and write_part(folder, kept_rows) != path
        ):
            path.unlink()


def _gather(folder: Path) -> None:
    """Merge many small parts, as written for tests that arrive one by one."""
    small = {path for path, frame in read_parts(folder) if frame.height < SMALL_PART}
    if len(small) >= SMALL_PART:
        parts = (frame for path, frame in read_parts(folder) if path in small)
        part_path = write_part(folder, join_frames(parts))
        for path in small - {part_path}:
            path.unlink()


def create_results_folder(folder: Path) -> None:
    """Make the folder of the results; refuse one with other Parquet files.

    Raises
    ------
    ExportError
    """
    if validate_path(folder).exists() and not folder.is_dir():
        raise ExportError(f"{folder} is a file; give a folder for the results")
    part_files = set(folder.glob(PART_PATTERN)) if folder.is_dir() else set()
    other_files = sorted(set(folder.glob("*.parquet")) - part_files) if folder.is_dir() else []
    if other_files:
        raise ExportError(
            f"{other_files[0]} was not written by dashpot batch, and would be taken for rows of "
            "the lot; give another folder"
        )
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with NamedTemporaryFile(dir=folder, prefix="."):
            pass
    except OSError as error:
        raise ExportError(
            f"{folder}: cannot be written to: {error.strerror or error}; give another place"
        ) from None
