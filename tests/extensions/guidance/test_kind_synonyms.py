"""Names of kinds of files that users type."""

import pytest
from kit.shell import ran

import dashpot as dp
from dashpot import workflow
from dashpot.extensions.guidance.kind_synonyms import KIND_SYNONYMS, find_kind_of_file
from dashpot.reading.columns.file_kinds import KINDS_OF_FILE, get_kind_label
from dashpot.reading.columns.kind_detection import parse_file_kind


def test_every_synonym_means_a_kind_of_file_and_is_none():
    assert set(KIND_SYNONYMS.values()) <= set(KINDS_OF_FILE)
    assert not KIND_SYNONYMS.keys() & set(KINDS_OF_FILE)


@pytest.mark.parametrize("name", ["hammer", "Hammer test", "HIT", "tap_test"])
def test_hammer_test_is_read_by_what_users_call_it(name, tmp_path):
    path = tmp_path / "hammer.csv"
    path.write_text(workflow.EXAMPLES["hammer.csv"]())
    assert parse_file_kind(name) == parse_file_kind("impact")
    assert type(dp.read(path, kind=name)).__name__ == "ImpactTest"
    named, plain = (
        ran("inspect", path, "--kind", word, "--json").stdout for word in (name, "impact")
    )
    assert named == plain


@pytest.mark.parametrize("kind", sorted(set(KINDS_OF_FILE) - {"plug-in"}))
def test_kind_itself_and_its_words_in_messages_are_not_of_another(kind):
    assert find_kind_of_file(kind) == kind
    label = get_kind_label(kind).removeprefix("a ").removeprefix("an ")
    assert find_kind_of_file(label) in {kind, label}
