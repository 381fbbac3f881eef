"""Reported values: text, table cells and documents of one number."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

from dashpot.base.reported_values import ReportedValue
from dashpot.base.serialisation import (
    DIGEST,
    EVERY_FIELD,
    Key,
    Serialisable,
    compute_document_digest,
    decode_fields,
    to_plain_value,
)


def test_a_fact_is_read_in_the_unit_of_the_field() -> None:
    value = ReportedValue("k_1", 17432.1, 17000.0, 17864.2, "N/m", 200.0)
    assert value.cells == ("k_1", "17.43", "0.20", "17.00 to 17.86", "N/mm")
    assert value.cells.with_error == "17.43 ± 0.20"
    assert value.symbol == "k₁"
    assert value.text == "k_1 17.43 ± 0.20 N/mm, 95 % 17.00 to 17.86"


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (0.0, "2.000, held"),
        (math.inf, "2.000, not identified"),
        (None, "2.000"),
        (0.1, "2.00 ± 0.10"),
    ],
)
def test_reported_value_prints_its_error(error: float | None, text: str) -> None:
    assert ReportedValue("tau_1", 2.0, unit="s", error=error).cells.with_error == text


def test_reported_value_with_infinite_upper_end_prints_a_lower_limit() -> None:
    value = ReportedValue("life", math.nan, 3.6e6, math.inf, "s", read="h")
    assert value.text == "life at least 1000 h"
    assert value.cells[1:] == ("", "", "at least 1000", "h")
    assert value.cell_texts == ("unknown", "1000", "no limit")
    # a value of an infinite interval is known
    assert ReportedValue("life", 7.2e6, 3.6e6, math.inf, "s", read="h").cells.value == "2000"


def test_reported_value_with_upper_bound_only_prints_no_value() -> None:
    value = ReportedValue("viscous_time", 4e-4, 0.0, 2.2e-2, "s", read="ms")
    assert value.text == "viscous time below 22.0 ms"


def test_a_value_that_is_at_most_so_much_says_both_and_no_error() -> None:
    value = ReportedValue("k_inf", 204.4, math.nan, 208.6, "N/m")
    assert value.text == "k_inf 0.2044 N/mm, at most 0.2086"
    assert value.cells[1:] == ("0.2044", "", "at most 0.2086", "N/mm")
    # one that meets its bound has the digits of a thousandth of it
    assert ReportedValue("k_inf", 204.4, math.nan, 204.4, "N/m").cells.interval == "at most 0.20440"


@dataclass(frozen=True)
class Part:
    length: float
    inside: np.ndarray | None = None


@dataclass(frozen=True)
class Result(Serialisable):
    schema = "dashpot/result@0"
    _keys = (
        "law",
        "part.length",
        Key("high", "part.length"),
        Key("inside", "part.inside", optional=True),
        Key("more", flatten=True),
        "part",
    )

    law: str
    part: Part
    more: dict[str, float]


def test_a_document_is_a_list_of_attributes() -> None:
    document = Result("linear", Part(math.inf), {"k": 2.0}).to_dict()
    assert document == {
        "schema": "dashpot/result@0", "law": "linear", "length": "Infinity", "high": "Infinity",
        "k": 2.0, "part": {"length": "Infinity", "inside": None},
    }  # fmt: skip
    assert list(document) == ["schema", "law", "length", "high", "k", "part"]


@dataclass(frozen=True)
class WholeValue(Serialisable):
    _keys = (
        EVERY_FIELD,
        Key("high", "part.length", nonfinite_as_null=True),
        Key("result", flatten=True),
        Key("gone", "nothing.length"),
        Key("left", "nothing", optional=True),
    )

    part: Part
    result: Result | None = None
    nothing: Part | None = None

    @property
    def _has_digest(self) -> bool:
        return True


def test_document_writes_null_for_nan_and_omits_missing_fields() -> None:
    document = WholeValue(Part(math.nan)).to_dict()
    seal = document.pop(DIGEST)
    assert document == {
        "part": {"length": "NaN", "inside": None}, "result": None, "high": None,
        "gone": None,
    }  # fmt: skip
    assert seal == compute_document_digest(document | {DIGEST: "any"})
    assert seal != compute_document_digest(document | {"high": 1})


@dataclass(frozen=True)
class TakenValue(Serialisable):
    _keys = (Key("whole", flatten=True), "more")

    whole: WholeValue
    more: float = 2.0


def test_what_takes_in_a_sealed_document_is_sealed_as_a_whole() -> None:
    document = TakenValue(WholeValue(Part(1.0))).to_dict()
    assert (
        document[DIGEST]
        == compute_document_digest(document)
        != WholeValue(Part(1.0)).to_dict()[DIGEST]
    )


def test_the_fields_go_back_the_way_they_came() -> None:
    placed = {"law": "linear", "high": 2.0, "k": 3.0, "strange": 4.0}
    assert decode_fields(Result, placed) == {
        "law": "linear", "part": {"length": 2.0}, "more": placed,
    }  # fmt: skip
    whole = placed | {"part": {"length": 1.0, "inside": None}}
    assert decode_fields(Result, whole)["part"] == whole["part"]


def test_arrays_and_complex_numbers_are_plain() -> None:
    assert to_plain_value({"a": np.array([1 + 2j]), "n": np.float64(3.0)}) == {
        "a": {"real": [1.0], "imag": [2.0]}, "n": 3.0,
    }  # fmt: skip
