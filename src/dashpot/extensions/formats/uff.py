"""Universal file format through pyuff: dataset 58 (ascii and binary), shapes of dataset 55."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from math import exp, log
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypeAlias

import numpy as np

from dashpot.base.arrays import FloatArray
from dashpot.base.errors import ReadError
from dashpot.base.units import convert_to_unit
from dashpot.extensions.formats.common_clock import SampledChannel, interpolate_to_slowest
from dashpot.reading.raw_file import RawFile, import_extra
from dashpot.reading.read_options import ReadOptions, flag
from dashpot.reading.table import SEGMENT, Column, FileTable, Question, make_loader

TIME, FRF_, COHERENCE = 1, 4, 6
"""Function types of dataset 58."""
_PSD = 9
_NORMAL = 2
"""Analysis type of dataset 55."""
_NODES = (15, 2411)
"""Datasets of node coordinates."""
_QUANTITY = {8: "m", 11: "m/s", 12: "m/s^2", 9: "N", 13: "N", 17: "s", 18: "Hz"}
"""SI unit by the specific data type of an axis."""
_BLANK = {"", "NONE", "NULL"}
_AXES = ("", "X", "Y", "Z", "RX", "RY", "RZ")
_REAL = (2, 4)
"""Ordinate data types without an imaginary part."""
_EXPONENTIAL = (4, 6)
"""Window types of dataset 1858: exponential only, and with the impact window."""
_WINDOW_REMAINDERS = (3e-4, 0.2)
"""Remainder of exponential windows of analysers at the end of a record."""
_DOUBLE_EXPONENT = re.compile(rb"(?<=\d)[dD](?=[+-]\d\d)")
"""Fortran's D of a double: ``1.0D+01``."""
_BINARY_DATASET = re.compile(rb"^ {4}58b", re.MULTILINE)
_Set: TypeAlias = dict[str, Any]


def read(raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the FRFs of a file, else its time records, as a table.

    Of several FRFs one is chosen by ``--file-part segment``; without it those on the same
    lines are columns side by side, named after their points, for a reader that takes them all.
    Units are those of the axis labels; where a label is blank, dataset 164 and the specific data
    type give them. A file without any, but with normal modes at nodes, is a row for each node of
    each mode.

    Raises
    ------
    ReadError
        If there is no dataset 58 of either type nor one of shapes, or several FRFs and no choice.
    """
    pyuff = import_extra("pyuff", "pyuff", "UFF files")
    with warnings.catch_warnings(), _readable_path(raw) as path:
        warnings.simplefilter("ignore")
        results = pyuff.UFF(str(path)).read_sets()
    sets = _attach_windows(results if isinstance(results, list) else [results])
    units = _dataset(sets, 164)
    curves = [entry for entry in sets if entry.get("type") == 58 and np.size(entry.get("data", ()))]
    if not curves:
        return _build_mode_table(sets, units)
    notes = _list_notes(sets, units)
    frfs = _select_by_type(curves, FRF_)
    if frfs:
        return _build_frf_table(
            frfs, _select_by_type(curves, COHERENCE), units, segment=options.segment, notes=notes
        )
    # a spectrum or the like is shown, and refused where a test is asked for
    return _build_time_table(_select_by_type(curves, 0, TIME) or curves[:1], units, notes)


@contextmanager
def _readable_path(raw: RawFile) -> Iterator[Path]:
    """Yield the path of a file whose exponents pyuff reads: E where a text writes Fortran's D."""
    with raw.open() as stream:
        data = stream.read()
    if _BINARY_DATASET.search(data) or not _DOUBLE_EXPONENT.search(data):
        if raw.path is None:
            raise ReadError(
                "this format is read from a file, not through a pipe; save it and give its path"
            )
        yield raw.path
        return
    with TemporaryDirectory() as folder:
        path = Path(folder, "exponents.uff")
        path.write_bytes(_DOUBLE_EXPONENT.sub(b"E", data))
        yield path


def _attach_windows(sets: Sequence[_Set]) -> list[_Set]:
    """Return the datasets; each 58 with its 1858 under ``qualifiers``.

    An 1858 follows its 58, but in files that begin with one: there it stands before.
    """
    types = [entry.get("type") for entry in sets if entry.get("type") in {58, 1858}]
    stands_before = types[:1] == [1858]
    entries: list[_Set] = []
    for entry in reversed(sets) if stands_before else sets:
        if entry.get("type") == 1858 and entries and entries[-1].get("type") == 58:
            entries[-1] = {**entries[-1], "qualifiers": entry}
        else:
            entries.append(entry)
    return entries[::-1] if stands_before else entries


def _direction_sign(*directions: int) -> float:
    """-1 where an odd number of direction fields, -1 to -6, are against their axes; else 1."""
    return -1.0 if sum(direction < 0 for direction in directions) % 2 else 1.0


def _format_window(
    entry: _Set, record: float | None
) -> tuple[tuple[str, ...], tuple[Question, ...]]:
    r"""Header lines and questions for the exponential window that dataset 1858 states.

    Its damping factor has no stated unit: it may be the rate a in :math:`e^{-at}`, 1/s, the time
    constant 1/a, s, or what the window leaves at the end of the `record`, s. An interpretation is
    used if it is the only one with a remainder usual for analysers; otherwise the user must choose.
    """
    qualifiers = entry.get("qualifiers") or {}
    if int(qualifiers.get("window_type") or 0) not in _EXPONENTIAL:
        return (), ()
    factor = float(qualifiers.get("exponential_window_damping_factor") or 0.0)
    rates: list[float] = []
    if record is not None and factor > 0:
        readings = [factor, 1 / factor]
        if factor < _WINDOW_REMAINDERS[1]:
            readings.append(-log(factor) / record)
        rates = [
            rate
            for rate in readings
            if _WINDOW_REMAINDERS[0] <= exp(-rate * record) <= _WINDOW_REMAINDERS[1]
        ]
    if rates and max(rates) < 1.01 * min(rates):
        return (f"exponential window, decay rate [1/s]: {rates[0]!r}",), ()
    message = (
        f"dataset 1858 states an exponential window with the factor {factor:g} and no unit that "
        f"its record settles; give the time constant, for example {flag('window_decay')} 2s, or "
        f"{flag('window_decay')} 0s if the values are free of the window"
    )
    return (), (Question(message, f"{flag('window_decay')} TIME"),)


def _record_length(entry: _Set) -> float | None:
    """Length of the record behind an FRF, s, by the spacing of its lines; of a time record its own.

    None where neither is known.
    """
    x = np.asarray(entry["x"], dtype=float)
    if len(x) < 2:
        return None
    step = float(np.median(np.diff(x)))
    if step <= 0:
        return None
    return len(x) * step if entry["func_type"] in {0, TIME} else 1 / step


def _select_by_type(curves: Sequence[_Set], *types: int) -> list[_Set]:
    return [entry for entry in curves if entry["func_type"] in types]


def _dataset(sets: Sequence[_Set], number: int) -> _Set | None:
    return next((entry for entry in sets if entry.get("type") == number), None)


def _list_notes(sets: Sequence[_Set], units: _Set | None) -> list[str]:
    notes = []
    model = _dataset(sets, 151)
    if model is not None and str(model.get("model_name", "")).strip():
        notes.append(f"model {str(model['model_name']).strip()} (dataset 151)")
    if units is None:
        notes.append("no dataset 164: units are those of the axis labels")
    else:
        notes.append(f"units {str(units.get('units_description', '')).strip()} (dataset 164)")
    return notes


def _build_frf_table(
    frfs: Sequence[_Set],
    coherences: Sequence[_Set],
    units: _Set | None,
    *,
    segment: int | None,
    notes: list[str],
) -> FileTable:
    file_questions = _make_frf_question(frfs) if segment is None else ()
    number = segment or 1
    _require_complex_values(frfs if segment is None else frfs[number - 1 : number])
    if number > len(frfs):
        raise ReadError(f"--file-part segment={segment}, but the file has {len(frfs)} FRFs")
    record = frfs[number - 1]
    is_same_grid = segment is None and all(np.array_equal(e["x"], record["x"]) for e in frfs)
    columns = [Column("frequency", _label(record["abscissa_axis_units_lab"]) or "Hz")]
    values = [np.asarray(record["x"], dtype=float)]
    shown_records = frfs if is_same_grid else [record]
    for entry, name in zip(shown_records, _name_points(shown_records), strict=True):
        unit = _divide_units(_unit(entry, "ordinate", units), _unit(entry, "orddenom", units))
        value = np.asarray(entry["data"], dtype=complex)
        value = value * _direction_sign(*_directions(entry))
        columns += [Column(f"real{name}", unit), Column(f"imaginary{name}", unit)]
        values += [value.real, value.imag]
        coherence = _coherence_of(entry, coherences)
        if coherence is not None:
            columns.append(Column(f"coherence{name}", "1"))
            values.append(np.real(coherence["data"]))
    notes = [*notes, *_describe_sign_changes(shown_records)]
    lines, questions = _format_window(record, _record_length(record))
    return _add_header_lines(
        _build_table(columns, values, record, notes, (*file_questions, *questions)), lines
    )


def _require_complex_values(frfs: Sequence[_Set]) -> None:
    """Refuse FRFs whose data type is real: amplitudes, which show no damping.

    Raises
    ------
    ReadError
    """
    real = [entry for entry in frfs if int(entry["ord_data_type"]) in _REAL]
    if real:
        raise ReadError(
            f"the FRF {_title(real[0])} has real values alone (ordinate data type "
            f"{int(real[0]['ord_data_type'])}), as an amplitude without its phase has; expected "
            "complex values (type 5 or 6). Export the FRF as complex, or as real and imaginary part"
        )


def _directions(entry: _Set) -> tuple[int, int]:
    """Direction fields of response and reference, 0 where a file does not say."""
    return int(entry.get("rsp_dir") or 0), int(entry.get("ref_dir") or 0)


def _describe_sign_changes(records: Sequence[_Set]) -> list[str]:
    """Return a note on curves whose sign was changed to the positive axis direction."""
    reversed_texts = [
        f"{_title(entry)} ({_get_points(entry)[0] or '?'} over {_get_points(entry)[1] or '?'})"
        for entry in records
        if _direction_sign(*_directions(entry)) < 0
    ]
    return [
        f"sign turned by the direction fields of dataset 58: {', '.join(reversed_texts[:4])}"
    ] * bool(reversed_texts)


def _make_frf_question(frfs: Sequence[_Set]) -> tuple[Question, ...]:
    """Ask for one of several."""
    if len(frfs) == 1:
        return ()
    curves_text = ", ".join(f"{i + 1} {_title(entry)}" for i, entry in enumerate(frfs[:8]))
    message = (
        f"{len(frfs)} FRFs in the file: {curves_text}; choose one, for example --file-part "
        "segment=1"
    )
    return (Question(message, SEGMENT),)


def _coherence_of(frf: _Set, coherences: Sequence[_Set]) -> _Set | None:
    """Return the coherence of the same two points on the same lines; or the only one there is."""
    entries_on_grid = [e for e in coherences if np.array_equal(e["x"], frf["x"])]
    items = [e for e in entries_on_grid if _get_points(e) == _get_points(frf)]
    return (
        items[0] if len(items) == 1 else entries_on_grid[0] if len(entries_on_grid) == 1 else None
    )


def _get_points(entry: _Set) -> tuple[str, str]:
    """Return response and reference point, such as 3+Z and 1+Z; "" if a file gives none."""
    return _get_point(entry, "rsp"), _get_point(entry, "ref")


def _get_point(entry: _Set, end: str) -> str:
    node, direction = int(entry.get(f"{end}_node") or 0), int(entry.get(f"{end}_dir") or 0)
    axis = _AXES[abs(direction)] if abs(direction) < len(_AXES) else ""
    return f"{node}{'-' if direction < 0 else '+'}{axis}" if axis else str(node) if node else ""


def _name_points(frfs: Sequence[_Set]) -> list[str]:
    """Return the point names of the columns of each FRF; "" for a single FRF."""
    if len(frfs) == 1:
        return [""]
    # values are along the axes: a direction against one was turned
    names = ["/".join(end.replace("-", "+") for end in filter(None, _get_points(e))) for e in frfs]
    single = len(set(names)) == len(names) and all(names)
    return [f" {name}" if single else f" {i + 1}" for i, name in enumerate(names)]


def _divide_units(numerator: str | None, denominator: str | None) -> str | None:
    """Return the unit of a ratio, unless the upper label holds the lower one already."""
    if not numerator or not denominator or f"/{denominator}" in numerator or "(1/" in numerator:
        return numerator
    return f"({numerator})/{denominator}"


def _repeated_records(time_records: Sequence[_Set]) -> list[list[_Set]]:
    """Return the channels of each record of a file that holds several of one set-up, as of hits.

    A channel is identified by its title, its points and its unit. Each must come equally often,
    record after record or channel after channel; else all are channels of one record.
    """
    keys = [
        (
            _title(e),
            *_get_points(e),
            str(e.get("rsp_ent_name")),
            _label(e["ordinate_axis_units_lab"]),
        )
        for e in time_records
    ]
    width = keys.index(keys[0], 1) if keys[0] in keys[1:] else len(keys)
    count = keys.count(keys[0])
    if width > 1 and keys == keys[:width] * (len(keys) // width):
        records = [list(time_records[i : i + width]) for i in range(0, len(keys), width)]
    elif len(set(keys)) > 1 and all(keys.count(key) == count for key in keys):
        ordered_indices = sorted(range(len(keys)), key=lambda i: (keys[:i].count(keys[i]), i))
        width = len(set(keys))
        records = [
            [time_records[j] for j in ordered_indices[i : i + width]]
            for i in range(0, len(keys), width)
        ]
    else:
        return [list(time_records)]
    is_common_clock = all(
        np.array_equal(e["x"], record[0]["x"]) for record in records for e in record
    )
    return records if is_common_clock else [list(time_records)]


def _build_time_table(
    time_records: Sequence[_Set], units: _Set | None, notes: list[str]
) -> FileTable:
    records = _repeated_records(time_records)
    if len(records) == 1:
        return _build_record_table(time_records, units, notes)
    channels_text = " and ".join(f"'{_title(entry)}'" for entry in records[0])
    notes = [*notes, f"{len(records)} records of {channels_text}, each a segment"]
    tables = [_build_record_table(record, units, notes) for record in records]
    values = [table.load(range(len(table.columns))).values for table in tables]
    starts = np.cumsum([0, *map(len, values[:-1])]).tolist()
    load = make_loader(np.concatenate(values), tuple(starts))
    questions = tuple(dict.fromkeys(question for table in tables for question in table.questions))
    return replace(tables[0], load=load, questions=questions)


def _build_record_table(
    time_records: Sequence[_Set], units: _Set | None, notes: list[str]
) -> FileTable:
    first = time_records[0]
    grids = {
        (len(e["x"]), round(float(e["x"][0]), 12), round(float(e["x"][-1]), 12))
        for e in time_records
    }
    time = np.asarray(first["x"], dtype=float)
    resampled: dict[int, FloatArray] = {}
    if len(grids) > 1:
        time, resampled, resampling_notes = _resample_records(time_records, len(grids))
        notes = [*notes, *resampling_notes]
    word = _label(first["abscissa_axis_units_lab"]) or "s"
    columns = [Column("time" if first["func_type"] in {0, TIME} else "abscissa", word)]
    values = [time]
    for i, entry in enumerate(time_records):
        unit = _unit(entry, "ordinate", units)
        name = _title(entry) or f"channel {i + 1}"
        name += " (PSD)" if entry["func_type"] == _PSD else ""
        columns.append(Column(name, unit))
        sign = _direction_sign(_directions(entry)[0])
        data = np.real(np.asarray(entry["data"])).astype(float)
        values.append(sign * resampled.get(i, data))
        if sign < 0:
            notes = [
                *notes,
                f"'{name}': sign turned by its direction field, {_get_points(entry)[0]}",
            ]
    windowed = next((entry for entry in time_records if entry.get("qualifiers")), first)
    lines, questions = _format_window(windowed, _record_length(windowed))
    # the record itself may show a window that the header does not settle
    unresolved = ["exponential window"] * bool(questions)
    return _add_header_lines(_build_table(columns, values, first, notes), [*lines, *unresolved])


def _resample_records(
    time_records: Sequence[_Set], kinds: int
) -> tuple[FloatArray, dict[int, FloatArray], list[str]]:
    """Return the clock of time records of several rates, the values on it, and notes.

    Raises
    ------
    ReadError
        If the records are no signals over time, or no channel of a test shows itself.
    """
    words = {_label(entry["abscissa_axis_units_lab"]) or "s" for entry in time_records}
    if any(entry["func_type"] not in {0, TIME} for entry in time_records) or len(words) > 1:
        raise ReadError(
            f"the records differ in length or start ({kinds} kinds), and are no signals over one "
            "time; give files whose channels were recorded together"
        )
    channels = [
        SampledChannel(
            _title(entry) or f"channel {i + 1}",
            np.asarray(entry["x"], dtype=float),
            np.real(np.asarray(entry["data"])).astype(float),
        )
        for i, entry in enumerate(time_records)
    ]
    if len({float(f"{channel.step:.6g}") for channel in channels}) == 1:
        channels_text = ", ".join(
            f"'{c.name}' {len(c.time)} from {c.time[0]:.6g}" for c in channels[:6]
        )
        raise ReadError(
            f"the time records differ in length or start ({channels_text}); give files whose "
            "channels were recorded together"
        )
    notes: list[str] = []
    rows = interpolate_to_slowest(channels, notes)
    return rows[:, 0], dict(enumerate(rows[:, 1:].T)), notes


def _build_table(
    columns: Sequence[Column],
    values: Sequence[FloatArray],
    entry: _Set,
    notes: Sequence[str],
    questions: tuple[Question, ...] = (),
) -> FileTable:
    comments = tuple(f"# {entry[key]}" for key in ("id1", "id2", "id3", "id4", "id5"))
    return FileTable(
        format="UFF 58",
        questions=questions,
        columns=tuple(columns),
        load=make_loader(np.column_stack(values)),
        notes=tuple(notes),
        header=comments,
        simulated=any("simulated" in comment.casefold() for comment in comments),
    )


def _add_header_lines(table: FileTable, lines: Sequence[str]) -> FileTable:
    """Return the table with more lines in its header."""
    return replace(table, header=(*table.header, *(f"# {line}" for line in lines)))


def _build_mode_table(sets: Sequence[_Set], units: _Set | None) -> FileTable:
    """A row for each node of each mode: places in m, and modal masses in kg, by dataset 164."""
    shapes = _select_mode_shapes(sets)
    length, force = (1.0 if units is None else float(units[key]) for key in ("length", "force"))
    node_positions = _get_node_positions(sets, length)
    # a mass unit is that of force, times s^2, over that of length
    rows = [
        row
        for number, entry in enumerate(shapes, start=1)
        for row in _iterate_mode_rows(number, entry, node_positions, mass_unit=force / length)
    ]
    has_units = units is not None
    words = [
        None,
        "Hz",
        "1",
        "kg" if has_units else None,
        *3 * ["m" if has_units else None],
        *3 * [None],
    ]
    names = ("mode", "frequency", "damping ratio", "modal mass", "x", "y", "z", "ux", "uy", "uz")
    columns = [Column(name, word) for name, word in zip(names, words, strict=True)]
    values = list(np.array(rows, dtype=float).T)
    mode_table = _build_table(columns, values, shapes[0], _list_notes(sets, units))
    return replace(mode_table, format="UFF 55")


def _select_mode_shapes(sets: Sequence[_Set]) -> list[_Set]:
    shapes = [e for e in sets if e.get("type") == 55 and e.get("analysis_type") == _NORMAL]
    if not shapes:
        kinds = ", ".join(map(str, sorted({int(entry.get("type", 0)) for entry in sets})))
        raise ReadError(
            "no dataset 58 with an FRF or a time record, none of normal modes; the datasets are of "
            f"types {kinds or 'none'}"
        )
    return shapes


def _get_node_positions(sets: Sequence[_Set], unit: float) -> dict[int, list[float]]:
    """x, y and z of each node, m; 1 m is `unit` of the file's."""
    return {
        int(node): [value / unit for value in coordinates]
        for entry in sets
        if entry.get("type") in _NODES
        for node, *coordinates in _iterate_nodes(entry, "x", "y", "z")
    }


def _iterate_nodes(entry: _Set, *names: str) -> Iterator[tuple[Any, ...]]:
    return zip(*(entry[key] for key in ("node_nums", *names)), strict=True)


def _iterate_mode_rows(
    number: int, entry: _Set, node_positions: Mapping[int, list[float]], *, mass_unit: float
) -> Iterator[list[float]]:
    """The rows of one mode."""
    if np.iscomplexobj(entry["r1"]):
        raise ReadError(f"mode {number} is complex; give the real, undamped modes")
    viscous, hysteretic, mass = (
        float(entry.get(key) or 0) for key in ("modal_damp_vis", "modal_damp_his", "modal_m")
    )
    missing = {int(node) for node in entry["node_nums"]} - set(node_positions)
    if missing:
        raise ReadError(
            f"node {min(missing)} of mode {number} has no coordinates; export datasets 15 or "
            "2411 with the shapes"
        )
    header = [number, float(entry["freq"]), viscous or hysteretic / 2, mass / mass_unit or np.nan]
    for node, *shape in _iterate_nodes(entry, "r1", "r2", "r3"):
        yield [*header, *node_positions[int(node)], *shape]


def _title(entry: _Set) -> str:
    """Return the title of a curve: its axis label, response point or first identification line."""
    for key in ("ordinate_axis_lab", "rsp_ent_name", "id1"):
        word = _label(entry.get(key, ""))
        if word:
            return word
    return ""


def _label(word: Any) -> str | None:
    """Return a label, None if blank; a superscript two lost in a foreign encoding is put back."""
    text = str(word).strip()
    return (
        None if text.upper() in _BLANK else text.replace("s\ufffd", "s^2").replace("g\ufffd", "g^2")
    )


def _unit(entry: _Set, axis: str, units: _Set | None) -> str | None:
    """Return the unit in an axis' label, else that of dataset 164, if its factors are SI's."""
    label = _label(entry[f"{axis}_axis_units_lab"])
    if label or units is None:
        return label
    word = _QUANTITY.get(int(entry.get(f"{axis}_spec_data_type", 0) or 0), "")
    length, force = float(units.get("length", 1.0)), float(units.get("force", 1.0))
    if word == "N":
        return next(
            (name for name in ("N", "mN", "kN") if convert_to_unit(1.0, name) == force), None
        )
    if word.startswith("m"):
        prefix = {1.0: "", 1000.0: "m"}.get(length)
        return None if prefix is None else prefix + word
    return word or None
