"""Cache on disk of relaxation tests, memory-mapped by all workers."""

from __future__ import annotations

import os
from dataclasses import replace
from hashlib import sha256
from pathlib import Path

import numpy as np

from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.datamodel.specimen import Specimen
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.workflow.json_archive import from_json, to_json

FOLDER = "records"
"""Folder of the records, in the folder of the files; no file identity has this name."""
_PREVIEW_SAMPLES = 8
_SIGNALS = ("time", "displacement", "force")


def read_relaxation_test(
    path: str, *, options: ReadOptions, specimen: Specimen | None
) -> RelaxationTest:
    """Return the test in a file, as read before if any worker has.

    Of the specimen only the temperature can change the result of a reader.
    """
    known_specimen = specimen or Specimen()
    cache_path = _get_cache_path(path, options, known_specimen.temperature)
    test = _load_record(cache_path)
    if test is None:
        requested_specimen = Specimen(temperature=known_specimen.temperature)
        test = read_relaxation(path, options=options, specimen=requested_specimen)
        _save_record(cache_path, test)
    return replace(test, specimen=replace(known_specimen, temperature=test.specimen.temperature))


def cache_record(path: str, options: ReadOptions, record: RelaxationTest) -> RelaxationTest:
    """Cache a test that was read without a stated specimen, and return it."""
    _save_record(_get_cache_path(path, options, None), record)
    return record


def _get_cache_path(path: str, options: ReadOptions, temperature: float | None) -> Path:
    key = sha256(repr((path, options, temperature)).encode()).hexdigest()
    return Path(path).parents[1] / FOLDER / key


def _save_record(cache_path: Path, record: RelaxationTest) -> None:
    """Write the signals, then the metadata, which mark the entry as complete."""
    cache_path.parent.mkdir(exist_ok=True)
    temporary_path = cache_path.with_suffix(f".{os.getpid()}")
    size = len(_SIGNALS), len(record.time)
    signals = np.lib.format.open_memmap(temporary_path, mode="w+", dtype=np.float64, shape=size)
    for row, name in zip(signals, _SIGNALS, strict=True):
        row[:] = getattr(record, name)
    temporary_path.replace(cache_path.with_suffix(".npy"))
    # from end to end: of a fast clock the first few are no record
    kept_samples = np.unique(np.linspace(0, len(record.time) - 1, _PREVIEW_SAMPLES).astype(int))
    preview = replace(record, **{name: getattr(record, name)[kept_samples] for name in _SIGNALS})
    temporary_path.write_text(to_json(preview), encoding="utf-8")
    temporary_path.replace(cache_path.with_suffix(".json"))


def _load_record(cache_path: Path) -> RelaxationTest | None:
    preview_path = cache_path.with_suffix(".json")
    if not preview_path.exists():
        return None
    signals = np.load(cache_path.with_suffix(".npy"), mmap_mode="r", allow_pickle=False)
    preview: RelaxationTest = from_json(preview_path.read_text(encoding="utf-8"))
    return replace(preview, **dict(zip(_SIGNALS, signals, strict=True)))
