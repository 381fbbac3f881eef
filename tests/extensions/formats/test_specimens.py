"""Channels and rows that share a file: copies of one sensor, what one segment of several holds."""

from __future__ import annotations

import numpy as np
import pytest
from kit.look_alikes import truth

from dashpot.base.errors import ReadError
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.readers.relaxation import read_relaxation

TIME, DISPLACEMENT, FORCE = truth()


def write(path, head, *columns):
    rows = [";".join(f"{cell:.9g}" for cell in row) for row in zip(*columns, strict=True)]
    path.write_text("\n".join([head, *rows]) + "\n")
    return path


@pytest.mark.parametrize(("share", "noted"), [(0.0, False), (0.5, True), (1.0, False)])
def test_read_notes_a_sensor_that_is_partly_a_copy(tmp_path, share, noted) -> None:
    """Of a part of the rows: of none there is nothing to say, of all it is one channel twice."""
    other = np.where(np.arange(len(TIME)) < share * len(TIME), FORCE, 1.4 * FORCE + 0.01)
    head = "Time [s];Displacement [mm];Force A [N];Force B [N]"
    path = write(tmp_path / "cells.csv", head, TIME, DISPLACEMENT, FORCE, other)
    test = read_relaxation(path, options=ReadOptions(force="Force A"))
    message = [note for note in test.source.notes if "hold the same numbers in" in note]
    assert bool(message) == noted


def test_read_refuses_a_segment_that_is_not_there(tmp_path) -> None:
    head = "Specimen;Time [s];Displacement [mm];Force [N]"
    label = np.repeat([1.0, 2.0], len(TIME))
    columns = (np.tile(values, 2) for values in (TIME, DISPLACEMENT, FORCE))
    path = write(tmp_path / "seals.csv", head, label, *columns)
    with pytest.raises(ReadError, match="the file has two segments"):
        read_relaxation(path, options=ReadOptions(segment=3))


def test_inspect_lists_specimens_with_their_answers(tmp_path) -> None:
    head = "Specimen;Time [s];Displacement [mm];Force [N]"
    label = np.repeat([7.0, 9.0], len(TIME))
    columns = (np.tile(values, 2) for values in (TIME, DISPLACEMENT, FORCE))
    seen = inspect_file(write(tmp_path / "seals.csv", head, label, *columns))
    assert [segment.name for segment in seen.segments] == ["7", "9"]
    (question,) = seen.questions
    assert question.answers == (("7", "segment=1"), ("9", "segment=2"))


@pytest.mark.parametrize("rows", [1, 5])
def test_padding_is_no_specimen(tmp_path, rows) -> None:
    columns = [np.concatenate([values, np.zeros(rows)]) for values in (TIME, DISPLACEMENT, FORCE)]
    path = write(tmp_path / "a.csv", "Time [s];Displacement [mm];Force [N]", *columns)
    assert not inspect_file(path).questions
    assert len(read_relaxation(path).time) == len(TIME)


@pytest.mark.parametrize("label", [np.arange(len(TIME)) + 1.0, np.zeros(len(TIME))])
def test_a_count_of_samples_is_no_specimen(tmp_path, label) -> None:
    head = "Sample;Time [s];Displacement [mm];Force [N]"
    path = write(tmp_path / "a.csv", head, label, TIME, DISPLACEMENT, FORCE)
    assert len(read_relaxation(path).time) == len(TIME)


@pytest.mark.parametrize("suffix", [".csv", ".xlsx"])
@pytest.mark.parametrize(
    ("heads", "clocks"),
    [
        (["Time [s];Displacement [mm];Force [N];Time [s];Displacement [mm];Force [N]"], True),
        (["Seal A;;;Seal B;;", "Time;Weg;Kraft;Time;Weg;Kraft", "s;mm;N;s;mm;N"], True),
        (["t 1 [s];Travel 1 [mm];Force 1 [N];t 2 [s];Travel 2 [mm];Force 2 [N]"], True),
        (["Time [s];Displacement 1 [mm];Force 1 [N];Displacement 2 [mm];Force 2 [N]"], False),
    ],
)
def test_inspect_asks_once_which_of_two_specimens_side_by_side(
    tmp_path, suffix, heads, clocks
) -> None:
    columns = [TIME, DISPLACEMENT, FORCE, *([TIME] if clocks else []), DISPLACEMENT, 1.1 * FORCE]
    path = tmp_path / f"seals{suffix}"
    if suffix == ".csv":
        write(path, "\n".join(heads), *columns)
    else:
        openpyxl = pytest.importorskip("openpyxl", reason="it writes the workbook")
        book = openpyxl.Workbook()
        for head in heads:
            book.active.append([cell or None for cell in head.split(";")])
        for row in zip(*columns, strict=True):
            book.active.append([float(cell) for cell in row])
        book.save(path)
    inspected = inspect_file(path)
    (question,) = inspected.questions
    assert "2 sets of columns" in question.message
    roles = [column.role for column in inspected.columns]
    assert [role for role in roles if role] == ["time", "displacement", "force"]
    for segment, factor in ((1, 1.0), (2, 1.1)):
        options = ReadOptions(segment=segment)
        assert not inspect_file(path, options=options).questions
        assert read_relaxation(path, options=options).force == pytest.approx(factor * FORCE)
