"""What is made on first use is what would have been made at once."""

from __future__ import annotations

import copy
import pickle
import re

import pytest

from dashpot.base.lazy import compile_on_use


@pytest.mark.parametrize(
    ("source", "flags", "text"),
    [(r"(\w+)=(\d+)", 0, "a=1, b=22"), ("A=", re.IGNORECASE, "a=1"), (rb"\d", 0, b"a1")],
)
def test_a_pattern_finds_what_a_compiled_one_does(source, flags, text):
    pattern, compiled = compile_on_use(source, flags), re.compile(source, flags)
    for name in ("search", "match", "fullmatch", "findall", "split"):
        for _ in range(2):
            groups, expected = (getattr(item, name)(text) for item in (pattern, compiled))
            if isinstance(expected, re.Match):
                groups, expected = groups.groups(), expected.groups()
            assert groups == expected
    assert (pattern.pattern, pattern.flags, pattern.groups) == (
        compiled.pattern,
        compiled.flags,
        compiled.groups,
    )


@pytest.mark.parametrize("used", [False, True])
@pytest.mark.parametrize(
    "duplicate",
    [copy.copy, copy.deepcopy, lambda pattern: pickle.loads(pickle.dumps(pattern))],  # noqa: S301
    ids=["copy", "deepcopy", "pickle"],
)
def test_a_pattern_can_be_copied_before_and_after_its_use(duplicate, used):
    pattern = compile_on_use("a+", re.IGNORECASE)
    if used:
        assert pattern.match("A")
    assert duplicate(pattern).match("AA")[0] == "AA"


def test_a_wrong_pattern_is_refused_when_it_is_used():
    pattern = compile_on_use("(")
    with pytest.raises(re.error):
        pattern.search("")
