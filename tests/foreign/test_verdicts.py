"""The arithmetic by which `benchmarks/verdicts.py` judges, on lines that are made up."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "benchmarks" / "verdicts.py"


@pytest.fixture(scope="module")
def verdicts():
    spec = importlib.util.spec_from_file_location("benchmark_verdicts", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    # a dataclass asks for the module of its annotations
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


def line(use="use", right=True, group="none", **limits):
    """Limits of .9 and 1.1 about a truth of 1, or of 1.2."""
    truth = 1.0 if right else 1.2
    names = ("frf", "peak_frequency", "peak_height", "k_end", "k_3end", "k_inf")
    three = {name: [0.9, truth, 1.1] for name in names} | limits
    message = {"limits": three} if use != "refused" else {}
    return {"group": group, "rig": True, "use": use, "cpu": 0.1, **message}


def some(used_held=0, used=0, doubted_held=0, doubted=0, group="none"):
    return [
        *(line(group=group) for _ in range(used_held)),
        *(line(right=False, group=group) for _ in range(used - used_held)),
        *(line("use with care", group=group) for _ in range(doubted_held)),
        *(line("do not use", right=False, group=group) for _ in range(doubted - doubted_held)),
    ]


def test_holds_truth_counts_limits_with_their_ends_and_rejects_missing_ones(verdicts):
    assert verdicts.holds_truth(line(k_end=[1.0, 1.0, 2.0]))
    assert verdicts.holds_truth(line(k_end=[0.0, 2.0, 2.0]))
    assert not verdicts.holds_truth(line(k_end=[1.0 + 1e-12, 1.0, 2.0]))
    assert not verdicts.holds_truth(line(k_inf=[0.0, 2.0, 2.0 - 1e-12]))
    assert not verdicts.holds_truth(line(peak_height=[np.nan, 1.0, np.nan]))
    assert verdicts.holds_truth({"error": 0.05, "allowed": 0.05})
    assert not verdicts.holds_truth({"error": 0.0501, "allowed": 0.05})


def test_half_widths_are_of_the_truth_and_of_a_logarithm(verdicts):
    item = line(k_end=[3.0, 2.0, 4.0], frf=[1.0, 1.0, np.e**3])
    assert verdicts.half_width(item, "k_end") == pytest.approx(0.25)
    assert verdicts.half_width(item, "frf") == pytest.approx(1.5)
    assert verdicts.half_width(line(frf=[0.0, 1.0, 2.0]), "frf") == np.inf


def test_limits_of_a_rate_are_those_of_the_binomial(verdicts):
    """None of n: 1 - .05^(1/n); the others turned about."""
    assert verdicts.most(0, 10) == pytest.approx(1 - 0.05**0.1)
    assert verdicts.least(10, 10) == pytest.approx(0.05**0.1)
    assert (verdicts.least(0, 10), verdicts.most(10, 10)) == (0.0, 1.0)
    assert verdicts.least(3, 10) == pytest.approx(1 - verdicts.most(7, 10))
    assert verdicts.least(3, 10) == pytest.approx(0.08726, abs=1e-5)


def test_counts(verdicts):
    row = verdicts.Row.of("one", [*some(3, 5, 2, 4), line("refused"), line("refused")])
    assert (row.refused, row.answered, row.held) == (2, 9, 5)
    assert (row.used, row.used_held, row.missed) == (5, 3, 2)
    assert row.widths["k_end"] == pytest.approx(0.1)


def test_a_disturbance_is_doubted_where_a_fifth_or_fewer_are_used(verdicts):
    assert verdicts.Row.of("one", some(2, 2, 0, 8)).doubted
    assert not verdicts.Row.of("one", some(3, 3, 0, 7)).doubted
    # a refusal is no "use"
    assert verdicts.Row.of("one", [*some(2, 2, 0, 7), line("refused")]).doubted


@pytest.mark.parametrize(
    ("counts", "message"),
    [
        # misses of 10 that are used: 3 may be of 15 %, 4 may not (.0873, .1500)
        ((7, 10, 0, 0), ["held"]),
        ((6, 10, 0, 0), ["misses", "held"]),
        # held: 8 of 10 may be of .93, 7 of 10 not (.963, .913)
        ((8, 8, 0, 2), []),
        ((7, 7, 0, 3), ["held"]),
        # sound and used: .70, and one less of ten
        ((7, 7, 3, 3), []),
        ((6, 6, 4, 4), ["used"]),
        # doubted: nothing is asked
        ((0, 2, 0, 8), []),
    ],
)
def test_goals_of_a_disturbance(verdicts, counts, message):
    assert verdicts.Row.of("one", some(*counts)).faults == message


def test_goals_of_all(verdicts):
    def list_goals(lines):
        rows = verdicts.rows_of(lines)
        return [good for _, good in verdicts.goals(rows, verdicts.Row.of("all", lines))]

    # 6 of 100 that are used; .80 of the sound; widths of .1 are over that of k(T) alone
    assert list_goals(some(94, 100, 23, 23)) == [True, True, True, True, True, False, True, True]
    assert list_goals(some(94, 101, 23, 23))[:2] == [False, True]
    assert list_goals(some(94, 100, 24, 24))[:2] == [True, False]
    spoilt = some(2, 12, 0, 0, group="drift")
    assert list_goals([*some(94, 94), *spoilt])[2:4] == [False, False]


def test_the_report_tells_rigs_from_kinds(verdicts):
    sheet = {"group": "dma, sound", "rig": False, "use": "use", "cpu": 1, "error": 1, "allowed": 2}
    text = "\n".join(verdicts.report([*some(3, 4), line("refused", group="clock"), sheet]))
    assert "| none | 4 | 0 | 0.75 | 1.00 | 1/1 | 3/3 | 10.0 | 10.0 | 0.10 |  |" in text
    assert "| clock | 1 | 1 | - | - | 0/0 | 0/0 | - | - | - |  |" in text
    assert "| dma, sound | 1 | 0 | 1.00 | 1.00 | 0/0 | 1/1 |" in text
    assert "relaxation: 5 records" in text


def test_every_rig_meets_another_truth_each_turn(verdicts):
    first, more = list(verdicts.chosen(2, 0)), list(verdicts.chosen(3, 0))
    assert more[: len(first)] == first
    assert len(set(more)) == len(more) == 3 * 40
    assert len(set(verdicts.chosen(42, 0))) == 42 * 40
