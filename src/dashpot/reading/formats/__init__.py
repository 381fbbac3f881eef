"""File formats, one module for each, recognised by the first bytes of a file."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module

from dashpot.base.errors import ReadError
from dashpot.reading.columns.header_units import state_unit
from dashpot.reading.raw_file import RawFile, add_name_to_errors
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.table import FileTable
from dashpot.registry import FORMATS, find_handler

_PLUGGED = "plugin_format"
_MAGIC = tuple((signature, form.name) for form in FORMATS.values() for signature in form.marks)


def get_format_name(raw: RawFile) -> str:
    """Return the name of the format, which is that of a module of this folder."""
    head = raw.head(4096)
    head_without_bom = head.removeprefix(b"\xef\xbb\xbf")
    for signature, name in _MAGIC:
        if head_without_bom.startswith(signature):
            return name
    if re.match(rb"\A\s*+-1[ \t]*+[\r\n]\s*+\d++b?(\s|\Z)", head_without_bom):
        return "uff"
    is_json = head_without_bom.lstrip().startswith(
        (b"{", b"[{")
    ) and not head_without_bom.startswith(b"{\\rtf")
    return "trios" if is_json else "text"


def read_table(raw: RawFile, options: ReadOptions) -> FileTable:
    """Return the table in a file of any known format.

    Raises
    ------
    ReadError
        Whatever is wrong with the file. A foreign parser may stumble over a broken one in any way:
        it runs in a child process, with limits.
    """
    with add_name_to_errors(raw.name):
        table = _table(raw, options)
    if table.format != "text":  # whose units stand in two rows
        table = replace(table, columns=tuple(map(state_unit, table.columns)))
    tasks = ["adapt table"] + ["calibrate"] * (options.calibration is not None)
    for handler in filter(None, (find_handler(task, table) for task in tasks)):
        table = handler(table, raw, options)
    return table


def _table(raw: RawFile, options: ReadOptions) -> FileTable:
    name, plugin_label = get_format_name(raw), ""
    if options.format is not None:
        from dashpot.registry.plugins import require_plugin

        name, plugin_label = _PLUGGED, require_plugin("formats", options.format).full_label
    if options.sheet is not None and not FORMATS[name].sheets:
        raise ReadError(
            f"--file-part sheet={options.sheet}: this file has no sheets or groups; leave it out"
        )
    module = import_module(FORMATS[name].module)
    reader: Callable[[RawFile, ReadOptions], FileTable] = module.read
    try:
        if not FORMATS[name].sandboxed:
            return reader(raw, options)
        from dashpot.reading.sandbox.parent_process import run_in_child

        return run_in_child(plugin_label or name, reader, raw, options)
    except (MemoryError, OSError) as error:
        raise ReadError(f"cannot be read: {type(error).__name__} {error}") from None
