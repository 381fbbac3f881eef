"""ASAM MDF: against what asammdf reads, files made block by block, and damaged ones."""

from __future__ import annotations

import contextlib
import json
import struct
import subprocess
import sys
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kit.foreign.files import press_and_hold
from kit.mdf_files import Channel, Group, mdf3, mdf4, pack_block

from dashpot.base.errors import ReadError
from dashpot.base.provenance import list_cautions
from dashpot.extensions.formats.mdf_table import MdfTable
from dashpot.reading.formats import read_table
from dashpot.reading.raw_file import RawFile, open_raw
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.readers.impact import read_impact
from dashpot.reading.readers.inspect import inspect_file
from dashpot.reading.readers.relaxation import read_relaxation

WRITTEN = Path(__file__).parents[2] / "data" / "asammdf"
TRUTH = json.loads((WRITTEN / "truth.json").read_text("utf-8"))
TIME, DISPLACEMENT, FORCE = press_and_hold(20.0)
COUNTS = np.round(FORCE / 1e-3).astype(int)


def clock(time=TIME, **more) -> Channel:
    return Channel("t", time, "s", kind=2, sync=1, **more)


def bench(**force) -> Group:
    return Group(
        [clock(), Channel("Travel", DISPLACEMENT, "mm"), Channel("Force", FORCE, "N", **force)]
    )


def columns(data: bytes, sheet: str | None = None) -> dict[str, np.ndarray]:
    table = MdfTable(BytesIO(data), sheet)
    values = table.load(range(len(table.columns))).values.T
    return dict(zip([column.name for column in table.columns], values, strict=True))


def save(path: Path, data: bytes) -> Path:
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("name", TRUTH)
def test_files_of_asammdf_are_read_as_it_reads_them(name: str) -> None:
    data, unread = (WRITTEN / name).read_bytes(), set(TRUTH[name])
    for sheet in ("group 1", "group 2") if name.endswith("mf4") else ("Python 1", "Python 2"):
        table = MdfTable(BytesIO(data), sheet)
        values = table.load(range(len(table.columns))).values
        for column, read in zip(table.columns[1:], values.T[1:], strict=True):
            unit, stamps, samples = TRUTH[name][column.name]
            unread.discard(column.name)
            assert column.unit == unit
            np.testing.assert_allclose(values[:, 0], stamps, rtol=1e-14, atol=1e-14)
            expected = [np.nan if sample is None else sample for sample in samples]
            np.testing.assert_allclose(read, expected, rtol=1e-12, atol=1e-12)
        assert (table.columns[0].name, table.columns[0].unit) == ("time", "s")
    assert not unread
    if name.endswith("mf4"):
        assert table.notes == [
            "'states' holds names of states: passed over",
            "'text' holds samples of varying length: passed over",
        ]


@pytest.mark.parametrize("how", ["DT", "DZ", "DZT", "DL", "HL"])
def test_mdf_reads_five_layouts_of_data(tmp_path: Path, how: str) -> None:
    test = read_relaxation(save(tmp_path / "a.mf4", mdf4([bench()], how=how)))
    np.testing.assert_allclose(test.force, FORCE, rtol=0, atol=1e-12)
    np.testing.assert_allclose(test.displacement, DISPLACEMENT * 1e-3, rtol=1e-12)
    np.testing.assert_allclose(test.time, TIME, rtol=0, atol=1e-12)


@pytest.mark.parametrize("dtype", ["<i2", ">i2", "<u4", ">u8", ">f4", ">f8", "<i8"])
def test_numbers_of_both_byte_orders(dtype: str) -> None:
    counts = np.abs(COUNTS) if dtype[1] == "u" else COUNTS
    made = Channel("Force", counts, "N", dtype, conversion=(1, [0.5, 1e-3], []))
    read = columns(mdf4([Group([clock(), made])]))["Force"]
    np.testing.assert_allclose(read, 0.5 + 1e-3 * counts, rtol=1e-6)


STATE = (7, [65535.0], ["overload", (1, [0.0, 0.5], [])])
CONVERTED = {
    "ranges of whole numbers": ((6, [0, 4, 7, 6, 11, 9, -1], []), "<u2", [7, 7, 7, -1, 9, 9, -1]),
    "ranges of floats": ((6, [0, 4, 7, 6, 11, 9, -1], []), "<f8", [7, 7, -1, -1, 9, -1, -1]),
    "rational": ((2, [0, 2, 1, 0, 0, 4], []), "<u2", [0.25, 0.75, 2.25, 2.75, 3.25, 5.75, 6.25]),
    "table": ((4, [0, 0, 10, 20], []), "<u2", [0, 2, 8, 10, 12, 20, 20]),
    "nearest": ((5, [0, 0, 10, 20], []), "<u2", [0, 0, 0, 0, 20, 20, 20]),
}
RAW = [0, 1, 4, 5, 6, 11, 12]


@pytest.mark.parametrize(("conversion", "dtype", "expected"), CONVERTED.values(), ids=CONVERTED)
def test_conversions(conversion, dtype: str, expected: list[float]) -> None:
    made = Channel("Force", RAW, "N", dtype, conversion=conversion)
    read = columns(mdf4([Group([clock(np.arange(7.0)), made])]))["Force"]
    np.testing.assert_allclose(read, expected)


def test_a_named_state_is_no_number() -> None:
    made = Channel("Force", [1, 65535, 3], "N", "<u2", conversion=STATE)
    read = columns(mdf4([Group([clock(np.arange(3.0)), made])]))["Force"]
    np.testing.assert_array_equal(read, [0.5, np.nan, 1.5])


@pytest.mark.parametrize("how", ["DT", "HL"])
@pytest.mark.parametrize("id_size", [1, 2, 8])
def test_unsorted_records_are_parted(how: str, id_size: int) -> None:
    slow = Group([clock(TIME[::7]), Channel("Temp", TIME[::7] + 20, "degC")], "slow", 3)
    data = mdf4([replace_number(bench(), 9), slow], how=how, id_size=id_size)
    read = columns(data, "slow")
    np.testing.assert_array_equal(read["Temp"], TIME[::7] + 20)
    np.testing.assert_array_equal(columns(data, "group 1")["Force"], FORCE)


def replace_number(group: Group, number: int) -> Group:
    return replace(group, number=number)


def test_marks_of_invalid_numbers(tmp_path: Path) -> None:
    marked = (TIME > 20) & (TIME < 20.2)
    wild = np.where(marked, 1e4, FORCE)
    group = Group(
        [
            clock(),
            Channel("Travel", DISPLACEMENT, "mm"),
            Channel("Force", wild, "N", invalid=marked),
        ]
    )
    path = save(tmp_path / "a.mf4", mdf4([group]))
    read = columns(path.read_bytes())["Force"]
    np.testing.assert_array_equal(np.isnan(read), marked)
    test = read_relaxation(path)
    assert test.force.max() < 20
    assert any("'Force' are marked as invalid" in note for note in test.source.notes)


def test_channels_without_numbers_are_named() -> None:
    group = bench()
    group.channels += [
        Channel("Where", np.zeros(len(TIME)), kind=1),
        Channel("Power", np.zeros(len(TIME)), conversion=(3, [], ["X1*X2"])),
        Channel("Broken", np.zeros(len(TIME)), flags=1),
    ]
    table = MdfTable(BytesIO(mdf4([group])), None)
    assert [column.name for column in table.columns] == ["t", "Travel", "Force"]
    assert table.notes == [
        "'Where' holds samples of varying length: passed over",
        "'Power' holds raw numbers of a formula, X1*X2: passed over",
        "'Broken' holds no valid number, by its flag: passed over",
    ]


@pytest.mark.parametrize("force_is_slow", [True, False])
def test_mdf_takes_the_slower_clock_of_force_and_travel(
    tmp_path: Path, force_is_slow: bool
) -> None:
    """Straight lines between slow samples would be taken for a record of the fast ones."""
    late = TIME[::2] + 0.013
    slow, fast = ("Force", "Travel") if force_is_slow else ("Travel", "Force")
    numbers, unit = {"Force": FORCE, "Travel": DISPLACEMENT}, {"Force": "N", "Travel": "mm"}
    wire = Group(
        [clock(late), Channel(slow, np.interp(late, TIME, numbers[slow]), unit[slow])], "wire"
    )
    cell = Group([clock(), Channel(fast, numbers[fast], unit[fast])], "cell")
    test = read_relaxation(save(tmp_path / "a.mf4", mdf4([wire], [cell])))
    within = late[(late >= TIME[0]) & (late <= TIME[-1])]
    np.testing.assert_allclose(test.time, within)
    measured = {name: np.interp(within, TIME, values) for name, values in numbers.items()}
    np.testing.assert_allclose(test.force, measured["Force"], atol=1e-12)
    np.testing.assert_allclose(test.displacement, measured["Travel"] * 1e-3, atol=1e-12)
    message = "group 'cell' (20 Hz) has a clock of its own: its channels were interpolated to the"
    assert any(note.startswith(message) for note in test.source.notes)


def test_mdf_reads_force_and_travel_on_their_clock_with_a_slow_speed(tmp_path: Path) -> None:
    slow = Group([clock(TIME[::9]), Channel("EngineSpeed", TIME[::9] + 800, "mm/s")], "engine")
    test = read_relaxation(save(tmp_path / "a.mf4", mdf4([slow], [bench()])))
    np.testing.assert_allclose(test.time, TIME)


@pytest.mark.parametrize("unit", ["ticks", "0.1ms"])
def test_mdf_aligns_no_clock_of_an_unknown_unit(unit: str) -> None:
    other = Group([replace(clock(TIME * 1e3), unit=unit), Channel("Temp", TIME, "degC")], "air")
    table = MdfTable(BytesIO(mdf4([bench()], [other])), None)
    assert "Temp" not in {column.name for column in table.columns}
    assert any(unit in note for note in list_cautions(table.notes))


def test_nothing_is_interpolated_across_a_pause_nor_an_invalid_number() -> None:
    slow = np.concatenate([TIME[:200:2], TIME[500::2]])
    marked = np.arange(len(slow)) == 20
    temperature = Channel("Temp", np.full(len(slow), 20.0), "degC", invalid=marked)
    read = columns(mdf4([bench()], [Group([clock(slow), temperature], "air")]))["Temp"]
    lost = (slow[99] < TIME) & (slow[100] > TIME)
    lost |= (slow[19] < TIME) & (slow[21] > TIME)
    lost |= slow[-1] < TIME
    np.testing.assert_array_equal(np.isnan(read), lost)


def halves(more: int) -> tuple[Group, Group]:
    """Two halves of one record, of which one has a channel more."""
    parts = []
    for at, part in enumerate((slice(0, 400), slice(400, None))):
        group = [clock(TIME[part]), Channel("Travel", DISPLACEMENT[part], "mm")]
        group.append(Channel("Force", FORCE[part], "N"))
        if at == more:
            group.append(Channel("Temp", TIME[part], "degC"))
        parts.append(Group(group, f"half {at + 1}"))
    return parts[0], parts[1]


RIVAL = Channel("Force ref", 2 * FORCE, "N")
TAKEN = [clock(), Channel("Travel", DISPLACEMENT, "mm"), RIVAL]
NAMES = (7, [float(k) for k in range(13)], [f"{k} N" for k in range(13)])
DROPPED = {
    "first half": (mdf4(*([half] for half in halves(0))), "shares no time"),
    "second half": (mdf4(*([half] for half in halves(1))), "shares no time"),
    "of another time": (
        mdf4([Group(TAKEN)], [Group([clock(TIME + 1e3), bench().channels[2]], "late")]),
        "'late' shares no time",
    ),
    "without samples": (
        mdf4([Group(TAKEN)], [replace(bench(), name="gone", rows=0)]),
        "no samples stand in 'gone'",
    ),
    "of names": (
        mdf4([Group([*TAKEN, Channel("Force", COUNTS // 1000, "N", "<i2", conversion=NAMES)])]),
        "'Force' holds names of states",
    ),
    "of a formula": (
        mdf4([Group([*TAKEN, Channel("Kraft", FORCE, "N", conversion=(3, [], ["2*X1"]))])]),
        "'Kraft' holds raw numbers of a formula",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("data", "says"), DROPPED.values(), ids=DROPPED)
def test_a_channel_of_the_test_that_is_passed_over_is_a_caution(
    tmp_path: Path, data: bytes, says: str
) -> None:
    test = read_relaxation(save(tmp_path / "a.mf4", data))
    assert any(says in note for note in test.source.cautions)


def test_halves_with_the_same_channels_are_joined(tmp_path: Path) -> None:
    test = read_relaxation(save(tmp_path / "a.mf4", mdf4(*([half] for half in halves(9)))))
    np.testing.assert_allclose(test.force, FORCE)
    assert not test.source.cautions


def test_groups_without_a_clock_side_by_side_are_a_caution(tmp_path: Path) -> None:
    travel, force = (Group([channel], channel.name) for channel in bench().channels[1:])
    path = save(tmp_path / "a.mf4", mdf4([travel], [force]))
    test = read_relaxation(path, options=ReadOptions(rate=20.0))
    assert any("no clock and 840 rows each" in note for note in test.source.cautions)


def test_mdf_reads_a_group_of_one_sample(tmp_path: Path) -> None:
    once = Group([clock(TIME[:1]), Channel("Temp", [21.0], "degC")], "air")
    path = save(tmp_path / "a.mf4", mdf4([bench()], [once]))
    np.testing.assert_allclose(read_relaxation(path).force, FORCE)
    assert columns(path.read_bytes())["Temp"][0] == 21.0


def test_a_group_without_samples_is_named() -> None:
    table = MdfTable(BytesIO(mdf4([bench()], [replace(bench(), name="gone", rows=0)])), None)
    assert table.notes == ["no samples stand in 'gone'"]
    assert len(table.columns) == 3


def test_a_hammer_with_another_clock_is_a_caution() -> None:
    time = np.arange(400) * 1e-3
    hammer = Group([clock(time), Channel("Hammer", np.zeros(400), "N")], "hammer")
    other = Group([clock(time + 4e-4), Channel("Acceleration", np.ones(400), "m/s^2")], "mass")
    table = MdfTable(BytesIO(mdf4([hammer], [other])), None)
    assert len(list_cautions(table.notes)) == 1


def test_groups_with_the_same_channels_are_segments(tmp_path: Path) -> None:
    time = np.arange(2000) * 5e-4
    hammer = 100 * np.exp(-(((time - 0.05) / 1e-3) ** 2))
    motion = np.where(time > 0.05, np.exp(-8 * (time - 0.05)) * np.sin(300 * (time - 0.05)), 0.0)
    hit = Group(
        [clock(time), Channel("Hammer", hammer, "N"), Channel("Acceleration", motion, "g")], "hit"
    )
    test = read_impact(save(tmp_path / "a.mf4", mdf4([hit], [hit], [hit])))
    assert test.starts == (0, 2000, 4000)


@pytest.mark.parametrize("order", ["<", ">"])
def test_mdf_3_of_both_byte_orders(tmp_path: Path, order: str) -> None:
    made = [
        Channel("t", TIME, "s", f"{order}f8", sync=1),
        Channel("Travel", DISPLACEMENT, "mm", f"{order}f4"),
        Channel("Force", COUNTS, "N", f"{order}i2", conversion=(0, [0.0, 1e-3], ())),
    ]
    test = read_relaxation(save(tmp_path / "a.dat", mdf3(made, order=order)))
    np.testing.assert_allclose(test.force, COUNTS * 1e-3)
    np.testing.assert_allclose(test.displacement, DISPLACEMENT * 1e-3, atol=1e-9)


def test_numbers_of_the_other_byte_order_than_the_blocks() -> None:
    data = bytearray(mdf3([Channel("t", TIME, "s", sync=1), Channel("Force", FORCE, "N")]))
    data[24] = 1
    read = columns(bytes(data))["Force"]
    np.testing.assert_array_equal(read, FORCE.astype("<f8").view(">f8"))


def test_a_clock_that_is_not_stored() -> None:
    made = Channel("t", [], "s", "", kind=3, sync=1, conversion=(1, [-0.5, 0.05], []))
    read = columns(mdf4([Group([made, Channel("Force", FORCE, "N")])]))
    np.testing.assert_allclose(read["t"], TIME - 0.5, atol=1e-12)


MDF3 = {
    "polynomial": ((6, [0, 2, 1, 0, 0, 0], ()), lambda x: 2 / x),
    "rational": ((9, [0, 2, 1, 0, 0, 4], ()), lambda x: (2 * x + 1) / 4),
    "exponential": ((7, [1, 2, 0, 0, 0, 1, 0], ()), lambda x: np.exp(x) / 2),
    "logarithmic": ((8, [1, 2, 0, 0, 0, 1, 0], ()), lambda x: np.log(x) / 2),
    "table": ((1, [0, 0, 10, 20], ()), lambda x: 2 * x),
    "keys of a table": ((2, [1, 5, 2, 6, 3, 9], ()), lambda x: np.array([5.0, 6, 9])),
}


@pytest.mark.parametrize(("conversion", "expected"), MDF3.values(), ids=MDF3)
def test_conversions_of_mdf_3(conversion, expected) -> None:
    raw = np.array([1.0, 2, 3])
    made = [Channel("Force", raw, "N", "<u1", conversion=conversion), Channel("x", raw, "mm")]
    np.testing.assert_allclose(columns(mdf3(made))["Force"], expected(raw))


def test_mdf_3_table_refuses_values_between_its_keys() -> None:
    made = [Channel("Force", [1, 2, 3], "N", "<u1", conversion=(2, [1, 5, 3, 9], ()))]
    with pytest.raises(ReadError, match=r"'Force': a table of MDF 3 .* two ways"):
        columns(mdf3(made))


def test_mdf_step_without_a_clock_is_a_hint() -> None:
    data = mdf3([Channel("Force", [1, 2, 3], "N", "<u1")], step=0.5)
    table = MdfTable(BytesIO(data), None).table()
    assert table.hints == (
        "the file says that 'Force' has a sample each 0.5 s; if that is right, add --rate 2Hz",
    )


WHOLE = mdf4([bench()])
REFUSED = {
    "unfinished": (mdf4([bench()], mark=b"UnFinMF "), "was not finished"),
    "another version": (mdf4([bench()], version=b"5.00    "), "version '5.00'; 2, 3 and 4"),
    "too few samples": (
        mdf4([replace(bench(), rows=len(TIME) + 1)]), "says 841 records and holds 840",
    ),
    "a thousand million samples": (mdf4([replace(bench(), rows=10**9)]), "and at most"),
    "columns": (WHOLE.replace(b"##DT", b"##DV"), "stored by columns"),
    "a packed block that says less": (
        mdf4([bench()], how="DZ").replace(struct.pack("<Q", 25 * 840), struct.pack("<Q", 25 * 800)),
        "says 20000 bytes and unpacks to others",
    ),
    "a packed block that says more": (
        mdf4([bench()], how="DZ").replace(struct.pack("<Q", 25 * 840), struct.pack("<Q", 1 << 40)),
        "that unpack to 1099511627776",
    ),
    "nothing": (mdf4(), "no samples of numeric channels"),
}  # fmt: skip


@pytest.mark.parametrize(("data", "message"), REFUSED.values(), ids=REFUSED)
def test_mdf_names_what_it_does_not_read(tmp_path: Path, data: bytes, message: str) -> None:
    with pytest.raises(ReadError, match=message):
        inspect_file(save(tmp_path / "a.mf4", data))


def test_a_link_that_goes_round_ends() -> None:
    data = bytearray(WHOLE)
    place = data.find(b"##DG") + 24
    struct.pack_into("<Q", data, place, place - 24)
    with pytest.raises(ReadError, match="links go round"):
        columns(bytes(data))


def test_a_block_of_zeros_unpacks_to_no_more_than_it_says() -> None:
    data = mdf4([bench()], how="DZ")
    body = pack_block(bytes(64 << 20), message=25 * 840)
    place = data.find(b"##DZ")
    bomb = struct.pack("<4s4xQQ", b"##DZ", 24 + len(body), 0) + body
    shifted = data[:place] + bomb + data[place:]
    with pytest.raises(ReadError):
        columns(shifted[: place + len(bomb)] + bytes(1000))


FILES = {
    "sorted": WHOLE,
    "packed": mdf4([bench()], how="HL"),
    "slow": mdf4([bench()], [Group([clock(TIME[::7]), Channel("Temp", TIME[::7], "degC")], "b")]),
    "unsorted": mdf4([replace(bench(), number=1), Group([clock(TIME[::9])], "b", 2)], id_size=1),
    "mdf3": mdf3([Channel("t", TIME, "s", sync=1), Channel("Force", FORCE, "N")]),
    "asammdf": (WRITTEN / "4.10-2.mf4").read_bytes(),
}


@pytest.mark.parametrize("name", FILES)
@given(data=st.data())
@settings(max_examples=60, deadline=None)
def test_a_cut_file_is_refused_or_lacks_nothing(name: str, data: st.DataObject) -> None:
    whole = FILES[name]
    cut = whole[: data.draw(st.integers(64, len(whole) - 1))]
    try:
        read = columns(cut)
    except ReadError:
        return
    for key, values in columns(whole).items():
        np.testing.assert_array_equal(read[key], values)


@pytest.mark.parametrize("name", FILES)
@given(data=st.data())
@settings(max_examples=60, deadline=None)
def test_a_damaged_word_ends_in_a_table_or_in_a_sentence(name: str, data: st.DataObject) -> None:
    """Of 8 bytes: a link, a length, a count or numbers."""
    whole = bytearray(FILES[name])
    at = 8 * data.draw(st.integers(8, len(whole) // 8 - 2))
    struct.pack_into("<Q", whole, at, data.draw(st.integers(1, (1 << 64) - 1)))
    with contextlib.suppress(ReadError):
        columns(bytes(whole))


def test_a_file_is_read_in_a_child_process(tmp_path: Path) -> None:
    raw = open_raw(save(tmp_path / "a.mf4", WHOLE))
    table = read_table(raw, ReadOptions())
    assert table.format == "MDF 4.10"
    assert read_table(RawFile("pipe", None, WHOLE), ReadOptions()).columns == table.columns
    with pytest.raises(ReadError, match="--file-part sheet=x: the groups are 'group 1'"):
        read_table(raw, ReadOptions(sheet="x"))


PROBE = """
import json, resource, sys
from dashpot.reading.readers.inspect import inspect_file
found = inspect_file(sys.argv[1])
own = int(open("/proc/self/status").read().split("VmHWM:")[1].split()[0]) >> 10
child = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss >> 10
print(json.dumps([found.kind, found.rows, len(found.columns), own, child]))
"""


def test_a_large_file_is_read_by_column(tmp_path: Path) -> None:
    time = np.arange(400_000) * 1e-2
    shifted, force = np.interp(time, TIME, DISPLACEMENT), np.interp(time, TIME, FORCE)
    counts = np.zeros(len(time), "<i2")
    group = [clock(time), Channel("Travel", shifted, "mm"), Channel("Force", force, "N")]
    group += [Channel(f"gauge {k}", counts, "um/m", "<i2") for k in range(37)]
    path = tmp_path / "large.mf4"
    records = np.zeros(len(time), [(c.name, c.dtype) for c in group] + [("marks", "u1")])
    for channel in group[:3]:
        records[channel.name] = channel.raw
    short = [replace(channel, raw=channel.raw[:1]) for channel in group]
    head = mdf4([Group(short, rows=len(time))])
    place = head.find(b"##DT")
    stored = struct.pack("<4s4xQQ", b"##DT", 24 + records.nbytes, 0) + records.tobytes()
    # the block of data stands last but for the group that points to it: it is put at the end
    data = bytearray(head)
    link = data.find(struct.pack("<Q", place), data.find(b"##DG"))
    data += bytes(-len(data) % 8)
    struct.pack_into("<Q", data, link, len(data))
    path.write_bytes(bytes(data) + stored)
    done = subprocess.run(
        [sys.executable, "-c", PROBE, path], capture_output=True, text=True, check=True,
        env={"PYTHONPATH": ":".join(sys.path)},
    )  # fmt: skip
    kind, rows, count, specific, child = json.loads(done.stdout)
    assert (kind, rows, count) == ("relaxation", 400_000, 40)
    assert max(specific, child) < 200  # MB; as floats they are 128 MB, and twice that on the way
