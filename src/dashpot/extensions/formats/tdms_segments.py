"""Segments of a TDMS file with their own properties, which npTDMS merges."""

from __future__ import annotations

from typing import Any

from nptdms.reader import TdmsReader

from dashpot.base.errors import ReadError

_CLOCK = ("wf_increment", "wf_xunit_string")
_STARTS = ("wf_start_offset", "wf_start_time")
_UNITS = ("unit_string", "NI_UnitDescription", "Unit", "unit", "Units")
_SCALED = ("NI_Scal", "NI_Number_Of_Scales")
_CONTIGUOUS = 0.5
"""Largest deviation of the start of a later segment from the end of the last, in steps."""


class SegmentReader(TdmsReader):  # type: ignore[misc]
    """Reader of TDMS metadata, which refuses properties of some segments only.

    A property that gives numbers their meaning (clock, start, unit, scale) is one of the object for
    the whole file. Where it changes between samples, those before it were recorded under another.
    """

    def __init__(self, stream: Any) -> None:
        super().__init__(stream)
        self._values_before: dict[str, int] = {}
        self._number = 0
        self._changed: dict[str, tuple[str, Any, Any]] = {}

    def _update_object_metadata(self, segment: Any) -> None:
        self._number += 1
        paths = [ordered_object.path for ordered_object in segment.ordered_objects]
        previous_values = {path: self._values(path) for path in paths}
        super()._update_object_metadata(segment)
        self._values_before = previous_values
        self._filled = {path for path in paths if self._values(path) > previous_values[path]}

    def _update_object_properties(self, segment_object_properties: Any) -> None:
        for path, properties in (segment_object_properties or {}).items():
            self._compare(path, list(properties))
        super()._update_object_properties(self._without_starts(segment_object_properties))
        for owner, (key, old, new) in self._changed.items():
            if any(_owns(owner, path) for path in self._filled):
                raise ReadError(
                    f"segment {self._number} of the file says {key} = {new} of {owner}, where the "
                    f"segments before it say {old}: samples of both were recorded under one name; "
                    "export each part by itself"
                )

    def _compare(self, owner: str, properties: list[tuple[str, Any]]) -> None:
        """Record a property of effect on the numbers that changed after samples were written."""
        if self._number == 1:
            return
        channel = "'/'" in owner  # of its group and its own name; there may be tens of thousands
        channel_paths = (
            [owner] if channel else [path for path in self.object_metadata if _owns(owner, path)]
        )
        previous_count = max((self._values_until_now(path) for path in channel_paths), default=0)
        if not previous_count:
            return
        entries = self.object_metadata[owner].properties if owner in self.object_metadata else {}
        for key, new in properties:
            old = entries.get(key)
            if not _matters(key) or _same(old, new):
                continue
            if key in _STARTS and self._goes_on(entries, key, old, new, previous_count):
                continue
            self._changed[owner] = (key, "nothing" if old is None else old, new)

    def _goes_on(self, value: Any, key: str, old: Any, new: Any, previous_count: int) -> bool:
        """Return whether the stated start of a segment is the end of the one before it."""
        step = float(value.get("wf_increment") or 0.0)
        if old is None or not step:
            return False
        difference = (
            _seconds(new) - _seconds(old) if key == "wf_start_time" else float(new) - float(old)
        )
        return abs(difference - previous_count * step) <= _CONTIGUOUS * step

    def _without_starts(self, properties: Any) -> Any:
        """Return the properties of a segment without a start that the first segment has stated."""
        if properties is None or self._number == 1:
            return properties
        return {
            path: [
                (key, value)
                for key, value in item
                if not (
                    key in _STARTS
                    and self._values_until_now(path)
                    and key in self.object_metadata[path].properties
                )
            ]
            for path, item in properties.items()
        }

    def _values(self, path: str) -> int:
        result = self.object_metadata.get(path)
        return int(result.num_values) if result else 0

    def _values_until_now(self, path: str) -> int:
        """Return the values of a channel before the segment that is being read."""
        return self._values_before.get(path, self._values(path))


def _owns(owner: str, path: str) -> bool:
    """Return whether the properties of a channel, a group or the file are those of a channel."""
    return owner in {path, "/"} or path.startswith(f"{owner}/")


def _matters(key: str) -> bool:
    return key in (*_CLOCK, *_STARTS, *_UNITS) or key.startswith(_SCALED)


def _same(old: Any, new: Any) -> bool:
    return bool(old == new) or str(old) == str(new)


def _seconds(instant: Any) -> float:
    """Seconds of an instant, from any zero."""
    if hasattr(instant, "as_datetime64"):
        instant = instant.as_datetime64("ns")
    return float(instant.astype("datetime64[ns]").astype(float)) * 1e-9
