"""Recording of an instrument, displayed while it runs and saved to a file."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dashpot.base.arrays import FloatArray, IndexArray
from dashpot.base.errors import DashpotError, DataError
from dashpot.base.option_fields import Driver, require_choice
from dashpot.extensions.app.upload_store import MAX_FILE_BYTES, Store, find_file
from dashpot.plot.picture import Line, Panel, Pen, Scale
from dashpot.plot.plotted_data import compute_padded_limits
from dashpot.plot.svg import strip
from dashpot.registry import require_handler

if TYPE_CHECKING:
    from dashpot.files import acquisition


MAX_CURVE_POINTS = 2000
"""Number of points of a curve above which neighbours are merged."""
_AXES_HEIGHT = 60.0
"""Height of the axes of a drawing below and above its plot, px."""
_WIDTH_RANGE, _HEIGHT_RANGE = (240.0, 2000.0), (60.0, 600.0)
"""Ranges of width and height of a drawing that a page may request, px."""


class Trace:
    """Channel over time, thinned to the minimum and maximum of equal intervals."""

    def __init__(self) -> None:
        self._samples_per_point = 1
        self._minima = self._maxima = self._remaining_samples = np.empty((0, 2))

    def add(self, time: FloatArray, value: FloatArray) -> None:
        """Add the received samples."""
        samples = np.concatenate([self._remaining_samples, np.column_stack([time, value])])
        complete_count = len(samples) // self._samples_per_point * self._samples_per_point
        self._take_block(samples[:complete_count].reshape(-1, self._samples_per_point, 2))
        self._remaining_samples = samples[complete_count:]
        while len(self._minima) > MAX_CURVE_POINTS:
            ends = np.stack([self._minima, self._maxima], axis=1)
            if len(ends) % 2:
                self._remaining_samples, ends = (
                    np.concatenate([ends[-1], self._remaining_samples]),
                    ends[:-1],
                )
            self._minima = self._maxima = np.empty((0, 2))
            self._take_block(ends.reshape(-1, 4, 2))
            self._samples_per_point *= 2

    def curve(self) -> tuple[FloatArray, FloatArray]:
        """Return times and values, in the order in which they came."""
        ends = [self._minima, self._maxima]
        if len(self._remaining_samples):
            low, high = _find_extremes(self._remaining_samples[None, :, 1])
            ends += [
                self._remaining_samples[low],
                self._remaining_samples[high],
                self._remaining_samples[-1:],
            ]
        points = np.unique(np.concatenate(ends), axis=0)
        return points[:, 0], points[:, 1]

    def _take_block(self, stretches: FloatArray) -> None:
        row = np.arange(len(stretches))
        low, high = _find_extremes(stretches[:, :, 1])
        self._minima = np.concatenate([self._minima, stretches[row, low]])
        self._maxima = np.concatenate([self._maxima, stretches[row, high]])


def _find_extremes(values: FloatArray) -> tuple[IndexArray, IndexArray]:
    """Return where each row is lowest and highest."""
    if not values.size:
        return np.zeros(0, dtype=np.intp), np.zeros(0, dtype=np.intp)
    return values.argmin(axis=1), values.argmax(axis=1)


class Live:
    """Current or last recording.

    Parameters
    ----------
    store : Store
        Where a record lies that no folder was named for, and a copy of every other, to be fitted.
    """

    def __init__(self, store: Store) -> None:
        self._store, self._lock, self._request_lock = store, threading.Lock(), threading.Lock()
        self._thread: threading.Thread | None = None
        self._recorder: acquisition.Recorder | None = None
        self._traces: list[Trace] = []
        self._rows, self._notes, self._failed = 0, (), ""  # type: tuple[int, tuple[str, ...], str]
        self._path = Path()
        self._saved_file: dict[str, str] | None = None

    @property
    def running(self) -> bool:
        """Whether an instrument is being read."""
        return self._thread is not None and self._thread.is_alive()

    def start(self, options: Mapping[str, Any]) -> None:
        """Begin a record.

        Raises
        ------
        DataError, ReadError
            If one is running, or the instrument or the folder is not there.
        """
        with self._request_lock:
            self._start_recorder(options)

    def _start_recorder(self, options: Mapping[str, Any]) -> None:
        if self.running:
            raise DataError("a record is running; stop it first")
        driver = str(options.get("driver", ""))
        folder = self._folder(driver, str(options.get("folder", "")).strip())
        recorder = self._device(driver, options)
        name = f"record-{datetime.now():%Y-%m-%dT%H-%M-%S-%f}.csv"
        with self._lock:
            self._recorder, self._path = recorder, folder / name
            self._traces = [Trace() for _ in recorder.describe().channels]
            self._rows, self._notes, self._failed, self._saved_file = 0, (), "", None
        self._thread = threading.Thread(target=self._run, args=(recorder,), daemon=True)
        self._thread.start()

    def stop(self, timeout: float = 10.0) -> None:
        """End the record, and wait, up to a time limit, until it is on the disk."""
        if self._recorder is not None:
            self._recorder.stop()
        if self._thread is not None:
            self._thread.join(timeout=timeout)

    def describe_state(self, width: float, height: float) -> dict[str, Any]:
        """Return the displayed state: the state, in words, and a drawing of each channel."""
        recorder = self._recorder
        if recorder is None:
            return {"running": False, "rows": 0, "message": "", "drawn": [], "saved_file": None}
        description, running = recorder.describe(), self.running
        with self._lock:
            curves = [trace.curve() for trace in self._traces]
            rows, sentences, failed, saved_file = (
                self._rows,
                self._notes,
                self._failed,
                self._saved_file,
            )
        notes = description.notes if running else sentences
        message = "; ".join(
            [f"{rows} samples", description.device, *notes, *self._format_location(rows)]
        )
        size = (
            min(max(width, _WIDTH_RANGE[0]), _WIDTH_RANGE[1]),
            min(max(height, _HEIGHT_RANGE[0]), _HEIGHT_RANGE[1]),
        )
        drawings = _render_channels(description.channels, curves, size)
        return {
            "running": running, "rows": rows, "message": message, "failed": failed,
            "drawn": drawings,
            "saved_file": None if running else saved_file,
        }  # fmt: skip

    def _format_location(self, rows: int) -> list[str]:
        """Return the path of the record as text."""
        if not rows:
            return []
        if self._path.parent == self._store.folder:
            return ["it goes with the app: name a folder to keep the next one"]
        return [f"kept in {self._path}"]

    def _run(self, recorder: acquisition.Recorder) -> None:
        """Read until the end, in a thread of its own."""
        error_text, notes, saved_file = "", (), None  # type: tuple[str, tuple[str, ...], dict[str, str] | None]
        try:
            record = require_handler("record", "file")
            _, notes = record(recorder, self._path, on_block=self._add_block)
            if self._path.stat().st_size <= MAX_FILE_BYTES:
                name = self._path.name
                saved_file = {"id": self._store.put(name, self._path.read_bytes()), "name": name}
            else:
                error_text = f"too long for this page; fit it with: dashpot fit {self._path}"
        except (DashpotError, OSError) as error:
            error_text = str(error)
        except Exception as error:  # noqa: BLE001 -- a driver of anyone's; the page must hear of it
            error_text = f"a fault in the driver: {type(error).__name__}: {error}"
        with self._lock:
            self._failed, self._notes, self._saved_file = error_text, notes, saved_file

    def _add_block(self, block: acquisition.Block) -> None:
        with self._lock:
            self._rows += len(block[0])
            for trace, values in zip(self._traces, block[1].T, strict=True):
                trace.add(block[0], values)

    def _folder(self, driver: str, name: str) -> Path:
        """Return the folder of the record; of a measurement never the server's temporary one."""
        if not name and driver == "serial":
            raise DataError("say in which folder the record is kept: it cannot be measured again")
        if not name:
            return self._store.folder
        folder = Path(name).expanduser()
        if not folder.is_dir():
            raise DataError(f"{name} is no folder; name one that is there")
        return folder

    def _device(self, driver: str, options: Mapping[str, Any]) -> acquisition.Recorder:
        require_choice("driver", driver, Driver)
        open_device: Callable[..., acquisition.Recorder] = require_handler("recorder", driver)
        if driver == "serial":
            return open_device(
                str(options.get("port", "")).strip(),
                columns=str(options.get("columns", "")).split(","),
                baud=_read_number(options, "baud", 115200, int),
            )
        files = [find_file(self._store.folder, options.get("file"))] if driver == "replay" else []
        return open_device(*files, speed=_read_number(options, "speed", 1.0, float))


def _read_number(
    options: Mapping[str, Any], name: str, default: Any, convert: Callable[[Any], Any]
) -> Any:
    try:
        return convert(options.get(name) or default)
    except (TypeError, ValueError):
        raise DataError(f"{name}: '{options[name]}' is no number") from None


def _render_channels(
    names: Sequence[str], curves: Sequence[tuple[FloatArray, FloatArray]], size: tuple[float, float]
) -> list[dict[str, Any]]:
    """Name, last value and drawing of each channel of which there is a curve, all of one time."""
    times = [time for time, _ in curves if len(time) > 1]
    span = (min(t[0] for t in times), max(t[-1] for t in times)) if times else (0.0, 1.0)
    return [
        {"name": name, "now": f"{y[-1]:.4g}", "svg": _render_channel(i, name, (x, y), span, size)}
        for i, (name, (x, y)) in enumerate(zip(names, curves, strict=True))
        if len(x) > 1
    ]


def _render_channel(
    number: int,
    name: str,
    curve: tuple[FloatArray, FloatArray],
    span: tuple[float, float],
    size: tuple[float, float],
) -> str:
    """Return a channel as the page has it."""
    label = name.replace(" [", ", ").removesuffix("]")
    mark, value_axis = (
        Line(*curve, Pen("measured", 1.2)),
        Scale(label, compute_padded_limits(curve[1])),
    )
    panel = Panel(Scale("time, s", span), value_axis, (mark,), height=size[1] - _AXES_HEIGHT)
    return strip((panel,), name=f"live{number}", width=size[0], kind="figure")
