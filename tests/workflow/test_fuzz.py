"""Documents, profiles and projects that were altered: a noun, a finding or a refusal."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st
from kit import handmade
from kit.fuzzing import Fuzzer
from kit.mutants import altered, tries, wounded

from dashpot.io.options import ReadOptions, dump_profile
from dashpot.solids.networks import kelvin_voigt
from dashpot.workflow.archive import document
from dashpot.workflow.job import Job

pytestmark = pytest.mark.fuzz


def documents() -> list[dict[str, object]]:
    nouns = (
        handmade.two_arms(), handmade.joint(), handmade.two_arms().model, kelvin_voigt(100.0, 2.0),
        handmade.study().comparison, Job("a.csv", impact=("b.csv",), mass=0.104),
    )  # fmt: skip
    return [document(noun) for noun in nouns]


@tries(400)
@given(content=st.sampled_from(documents()).flatmap(altered))
def test_altered_documents(fuzzer: Fuzzer, content: bytes) -> None:
    fuzzer.survives("unpack", content)


@tries(100)
@given(content=st.sampled_from(documents()).flatmap(lambda one: wounded(json.dumps(one).encode())))
def test_wounded_documents(fuzzer: Fuzzer, content: bytes) -> None:
    fuzzer.survives("unpack", content)


PROFILE = dump_profile(
    ReadOptions(
        time="Zeit", acceleration=("a", "b"), units={"force": "N"}, rate=1000.0, segment=2,
        decimal=",", skip_rows=3,
    )
)  # fmt: skip


@tries(200)
@given(content=wounded(PROFILE.encode()))
def test_wounded_profiles(fuzzer: Fuzzer, content: bytes) -> None:
    fuzzer.survives("profile", content)
