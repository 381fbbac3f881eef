"""Thousands of columns cost what they say, not what they are counted by."""

from __future__ import annotations

import re
from typing import get_args

import numpy as np
import pytest

from dashpot.io.columns import roles, vocabulary
from dashpot.io.columns.kinds import kind_of
from dashpot.io.columns.roles import score, suited
from dashpot.io.columns.vocabulary import FIRST, SECOND, Role, has_word, matches, unnumbered
from dashpot.io.options import ReadOptions
from dashpot.io.table import Column, FileTable, in_memory


def wide(count: int) -> FileTable:
    named = [Column("time", "s"), Column("displacement", "mm"), Column("force", "N")]
    columns = (*named, *(Column(f"Temp {i}", "degC") for i in range(count)))
    return FileTable("made", columns, in_memory(np.zeros((8, len(columns)))))


def test_what_differs_by_a_number_is_judged_once(monkeypatch: pytest.MonkeyPatch) -> None:
    judged: list[str] = []
    inner = roles._scores
    monkeypatch.setattr(
        roles, "_scores", lambda one, options: judged.append(one.name) or inner(one, options)
    )
    roles._own_scores.cache_clear()
    assert kind_of(wide(5000), ReadOptions())[0] == "relaxation"
    # three names, ten of one digit, and one for all of more
    assert len(judged) <= 14


def test_a_table_is_gone_through_once_for_all_roles(monkeypatch: pytest.MonkeyPatch) -> None:
    table, gone = wide(20), []
    inner = roles.scores
    monkeypatch.setattr(
        roles, "scores", lambda one, options: gone.append(one) or inner(one, options)
    )
    for role in get_args(Role):
        assert suited(table, role, ReadOptions()) == {
            i: value
            for i, one in enumerate(table.columns)
            if (value := score(one, role, ReadOptions()))
        }
    assert len(gone) == 23 * (1 + len(get_args(Role)))  # once, and once a role by the oracle
    units = ReadOptions(units={"temperature": "K"})
    suited(table, "temperature", units)
    assert len(gone) == 23 * (2 + len(get_args(Role)))


@pytest.mark.parametrize(
    "name",
    ["Force {}", "Weg_{}", "tan delta {}", "sg{}", "gamma{}", "Kraft max [{}]", "x{}", "力{}"],
)
def test_a_number_says_nothing(name: str) -> None:
    one, other = name.format("17"), name.format("40372")
    assert unnumbered(one) == unnumbered(other)
    bare = vocabulary._matches.__wrapped__  # what each says where its number is kept
    assert bare(one) == bare(other) == matches(one)
    for words in (vocabulary.EXTREMES, vocabulary.DERIVED):
        asked = vocabulary._has_word.__wrapped__
        assert asked(one, words) == asked(other, words) == has_word(one, words)


def test_one_digit_may_be_a_word_and_two_are_none() -> None:
    assert matches("gamma2") != matches("gamma3")
    words = [*FIRST, *SECOND, *vocabulary.EXTREMES, *vocabulary.DERIVED, *vocabulary.COMMANDED]
    assert not [word for word in words if re.search(r"\d\d", word)]


def test_the_name_that_users_give_a_unit_keeps_its_number() -> None:
    options = ReadOptions(units={"ai_0017": "N"})
    assert score(Column("ai_0017"), "force", options) == 1.0
    assert score(Column("ai_0018"), "force", options) == 0.0
