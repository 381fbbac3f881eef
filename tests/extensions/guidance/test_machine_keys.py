"""What is given for a key that ``--machine`` does not have."""

import re

import pytest
from kit.shell import ran

from dashpot.base.option_fields import get_option_key, iterate_option_fields
from dashpot.base.units import parse_quantity
from dashpot.datamodel.machine import Machine
from dashpot.extensions.guidance.machine_keys import MACHINE_SYNONYMS, suggest_machine_key


@pytest.mark.parametrize(
    "key", ["stiffness", "frame-stiffness", "Frame Stiffness", "stifness", "k"]
)
@pytest.mark.parametrize("text", ["30N/mm", "30kN/m", "171.3lbf/in"])
def test_stiffness_of_the_machine_is_answered_with_its_compliance(key, text):
    result = ran("fit", "seal.csv", "--machine", f"{key}={text}")
    assert result.exit_code == 2
    (compliance,) = re.findall(r"--machine compliance=(\S+)", result.stderr)
    inverse = parse_quantity(compliance, "compliance") * parse_quantity(text, "stiffness")
    assert inverse == pytest.approx(1, rel=1e-3)


@pytest.mark.parametrize("text", ["30", "0N/mm", "stiff", "30mm"])
def test_stiffness_without_a_value_names_an_example(text):
    assert "compliance=33um/N, which is 1/(30 N/mm)" in suggest_machine_key("stiffness", text)


def test_every_synonym_means_a_key_and_is_none():
    keys = {get_option_key(field) for field in iterate_option_fields(Machine)}
    assert set(MACHINE_SYNONYMS.values()) <= keys
    assert not MACHINE_SYNONYMS.keys() & keys


def test_another_word_of_a_key_is_suggested_and_nonsense_lists_the_keys():
    delay, nonsense = (
        ran("fit", "seal.csv", "--machine", word).stderr for word in ("delay=3ms", "zebra=1")
    )
    assert "Did you mean 'sync'?" in delay
    assert "Known are sync, drift, compliance" in nonsense
