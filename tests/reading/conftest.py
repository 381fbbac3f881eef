"""Foreign formats are parsed in this process: a child costs an interpreter for each file."""

from __future__ import annotations

import warnings
from functools import partial
from io import BytesIO

import pytest

from dashpot.base.errors import DashpotError, ReadError
from dashpot.extensions.formats import workbook
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.sandbox import child_process, message_protocol, parent_process

CHILDREN = {"test_bombs", "test_child"}
"""Whose subject is the child itself."""


def parsed_here(what, function, raw, options, *, columns=None):
    """Return what the parent receives from a child, without its limits."""
    values = {name: getattr(options, name) for name in parent_process.CHILD_OPTIONS}
    read_options = ReadOptions(**values)
    pipe = BytesIO()
    function = function if columns is None else partial(function, columns=columns)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # as a child does
        try:
            message_protocol.send_reply(
                pipe, child_process.run_parser(what, function, raw, read_options)
            )
        except DashpotError as error:
            raise ReadError(str(error)) from None
    pipe.seek(0)
    return message_protocol.receive_answer(pipe, message_protocol.receive(pipe))


@pytest.fixture(autouse=True)
def _parsed_here(request, monkeypatch):
    if request.path.stem not in CHILDREN:
        monkeypatch.setattr(parent_process, "run_in_child", parsed_here)
        monkeypatch.setattr(workbook, "run_in_child", parsed_here)
