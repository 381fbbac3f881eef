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
"""Of the records, in the folder of the files; no identity of a file is called so."""
_FEW = 8
_SIGNALS = ("time", "displacement", "force")


def relaxation(path: str, *, options: ReadOptions, specimen: Specimen | None) -> RelaxationTest:
    """Return the test in a file, as read before if any worker has.

    Of a specimen the temperature alone can change what a reader says.
    """
    stated = specimen or Specimen()
    place = _place(path, options, stated.temperature)
    test = _load_record(place)
    if test is None:
        requested_specimen = Specimen(temperature=stated.temperature)
        test = read_relaxation(path, options=options, specimen=requested_specimen)
        _keep(place, test)
    return replace(test, specimen=replace(stated, temperature=test.specimen.temperature))


def keep(path: str, reading: ReadOptions, record: RelaxationTest) -> RelaxationTest:
    """Return a test that was read with nothing said of its specimen, and keep it."""
    _keep(_place(path, reading, None), record)
    return record


def _place(path: str, reading: ReadOptions, temperature: float | None) -> Path:
    key = sha256(repr((path, reading, temperature)).encode()).hexdigest()
    return Path(path).parents[1] / FOLDER / key


def _keep(place: Path, record: RelaxationTest) -> None:
    """Write the signals, then the words, which say that all is there."""
    place.parent.mkdir(exist_ok=True)
    part = place.with_suffix(f".{os.getpid()}")
    size = len(_SIGNALS), len(record.time)
    signals = np.lib.format.open_memmap(part, mode="w+", dtype=np.float64, shape=size)
    for row, name in zip(signals, _SIGNALS, strict=True):
        row[:] = getattr(record, name)
    part.replace(place.with_suffix(".npy"))
    # from end to end: of a fast clock the first few are no record
    at = np.unique(np.linspace(0, len(record.time) - 1, _FEW).astype(int))
    few = replace(record, **{name: getattr(record, name)[at] for name in _SIGNALS})
    part.write_text(to_json(few), encoding="utf-8")
    part.replace(place.with_suffix(".json"))


def _load_record(place: Path) -> RelaxationTest | None:
    words = place.with_suffix(".json")
    if not words.exists():
        return None
    signals = np.load(place.with_suffix(".npy"), mmap_mode="r", allow_pickle=False)
    few: RelaxationTest = from_json(words.read_text(encoding="utf-8"))
    return replace(few, **dict(zip(_SIGNALS, signals, strict=True)))
