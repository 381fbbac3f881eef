"""Names of modules, functions and variables say what they are, to a reader who is new here.

The limits are today's figures, rounded up. They may only fall, and the floor of the share of verbs
may only rise. ``python tests/kit/structure.py`` prints the figures.
"""

from __future__ import annotations

import pytest
from kit.structure import (
    VAGUE_TEST_NAMES,
    begins_with_verb,
    compute_share,
    compute_vague_share,
    count_bare_functions,
    is_bare,
    list_bare_modules,
    list_functions,
    list_vague_test_names,
    read_bare_names,
    read_rows,
)

MOST_BARE_FUNCTIONS = 3.4  # % of all functions
LEAST_VERBS = 27.6  # % of all functions begin with a verb
MOST_VAGUE_IDENTIFIERS = 0.8  # % of all identifiers


def test_no_module_has_a_bare_name():
    assert list_bare_modules() == []


def test_few_functions_have_a_bare_name():
    assert compute_share(list_functions(), is_bare) <= MOST_BARE_FUNCTIONS


def test_no_function_has_a_new_bare_name():
    """A participle, preposition, adverb or adjective alone: begin with a verb instead."""
    assert dict(count_bare_functions() - read_bare_names()) == {}


def test_every_allowed_bare_name_exists():
    """Shorten the list by ``python tests/kit/structure.py --write-lists``."""
    assert sorted(read_bare_names().keys() - count_bare_functions().keys()) == []


def test_functions_begin_with_a_verb():
    assert compute_share(list_functions(), begins_with_verb) >= LEAST_VERBS


def test_few_identifiers_hold_a_vague_word():
    assert compute_vague_share() <= MOST_VAGUE_IDENTIFIERS


def test_no_name_of_a_test_is_vague():
    """Name a test ``test_<subject>_<behaviour>`` in the terms of the field."""
    assert sorted(list_vague_test_names() - read_rows(VAGUE_TEST_NAMES).keys()) == []


def test_every_allowed_vague_name_of_a_test_exists():
    """Shorten the list by ``python tests/kit/structure.py --write-lists``."""
    assert sorted(read_rows(VAGUE_TEST_NAMES).keys() - list_vague_test_names()) == []


@pytest.mark.parametrize(
    "name", ["_told", "of_arms", "_apart", "rounded", "Elsewhere", "soundest", "each"]
)
def test_a_bare_name_is_recognised(name: str) -> None:
    assert is_bare(name)


@pytest.mark.parametrize(
    "name", ["fit_arms", "speed", "_seed", "storage_modulus", "__init__", "rounded_value", "_"]
)
def test_a_name_of_an_object_is_not_bare(name: str) -> None:
    assert not is_bare(name)
