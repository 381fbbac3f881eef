"""Documents of former versions read as what they were, and are written without a former key."""

from __future__ import annotations

import json
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import pytest
from kit.kinds import files

import dashpot as dp
from dashpot.base.checks import REGISTER
from dashpot.base.errors import ReadError
from dashpot.base.serialisation import compute_document_digest
from dashpot.extensions.projects.document_versions import (
    EVERYWHERE,
    RENAMED_CHECKS,
    RENAMED_KEYS,
    convert_document,
    name_present_schema,
)
from dashpot.extensions.projects.verification import find_largest_difference
from dashpot.workflow.json_archive import from_json, schemas, to_document, to_json

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "tests" / "data" / "documents_1"
NAMES = sorted(path.stem for path in FOLDER.glob("*.json"))
RETURNED = [
    name
    for name in NAMES
    if name_present_schema(json.loads((FOLDER / f"{name}.json").read_text("utf-8"))["schema"])
    in schemas()
    and name != "strain-sweep"  # its document never was a result
]


def read_text(name: str) -> str:
    return (FOLDER / f"{name}.json").read_text(encoding="utf-8")


def find_places(value: Any, schema: str = "", parent: str = "") -> set[tuple[str, str]]:
    """Schema and place, by the key of the object above, of every key of a document."""
    if isinstance(value, list):
        return {place for item in value for place in find_places(item, schema, parent)}
    if not isinstance(value, dict):
        return set()
    if isinstance(value.get("schema"), str):
        schema, parent = value["schema"], ""
    below = {place for key, item in value.items() for place in find_places(item, schema, key)}
    return {(schema, f"{parent}.{key}") for key in value} | below


def without_digest(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: without_digest(item) for key, item in value.items() if key != "digest"}
    return [without_digest(item) for item in value] if isinstance(value, list) else value


ADDED_KEYS = {"error_in_band", "largest_error_in_band"}
"""Keys of a fit that every document of version 2 has."""


def fill_unknown(previous: Any, present: Any) -> Any:
    """A former document with the present numbers where it knew none."""
    if isinstance(previous, dict) and isinstance(present, dict):
        added = {key: present[key] for key in ADDED_KEYS - previous.keys() if key in present}
        return added | {key: fill_unknown(item, present.get(key)) for key, item in previous.items()}
    if isinstance(previous, list) and isinstance(present, list) and len(previous) == len(present):
        return [fill_unknown(*pair) for pair in zip(previous, present, strict=True)]
    return present if previous == "NaN" and isinstance(present, int | float) else previous


@pytest.mark.parametrize("name", NAMES)
def test_converted_document_has_no_version_1_key(name: str) -> None:
    document = json.loads(read_text(name))
    converted = convert_document(document)
    previous = {schema: {*keys, *EVERYWHERE} for schema, keys in RENAMED_KEYS.items()}
    assert not {
        (schema, place)
        for schema, place in find_places(converted)
        if place in previous.get(schema.replace("@2", "@1"), ())
    }
    assert "dashpot/" in converted["schema"]
    assert not {schema for schema, _ in find_places(converted)} & RENAMED_KEYS.keys()


def without_identity(value: Any) -> Any:
    """Return plain values without the names of results, which rounding decides."""
    if isinstance(value, dict):
        return {key: without_identity(item) for key, item in value.items() if key != "id"}
    return [without_identity(item) for item in value] if isinstance(value, list) else value


@pytest.mark.parametrize("name", RETURNED)
def test_version_1_document_reads_as_its_value(name: str) -> None:
    result = from_json(read_text(name))
    converted = without_digest(convert_document(json.loads(read_text(name))))
    written = without_digest(json.loads(to_json(result)))
    worst, where = find_largest_difference(
        without_identity(written), without_identity(fill_unknown(converted, written))
    )
    assert worst < 1e-9, where
    assert json.loads(to_json(from_json(to_json(result)))) == json.loads(to_json(result))


def without_texts(value: Any) -> Any:
    """Return plain values without their sentences, which an edition may word otherwise."""
    if isinstance(value, dict):
        return {key: without_texts(item) for key, item in value.items()}
    if isinstance(value, list):
        return [without_texts(item) for item in value]
    return "" if isinstance(value, str) and " " in value else value


BAND_KEYS = {"band_hz", "verdict", *ADDED_KEYS}
"""Keys of a fit that its valid band decides, which is narrower than in version 1."""
BAND_CHECKS = {"valid_band_exists", "loss_factor_determined"}


def without_band(document: dict[str, Any]) -> dict[str, Any]:
    checks = [check for check in document["checks"] if check["name"] not in BAND_CHECKS]
    return {key: item for key, item in document.items() if key not in BAND_KEYS} | {
        "checks": checks
    }


def test_version_1_fit_equals_a_new_fit(tmp_path: Path) -> None:
    head, *rows = files()["seal.csv"][0].splitlines()
    (tmp_path / "s.csv").write_text("\n".join([head, *rows[::3]]) + "\n")
    document = to_document(from_json(read_text("fit")))
    present = to_document(dp.fit(dp.read(tmp_path / "s.csv")))
    worst, where = find_largest_difference(
        without_identity(without_texts(without_digest(without_band(document)))),
        without_identity(without_texts(without_digest(without_band(present)))),
    )
    assert worst < 1e-6, where


def test_every_new_name_of_a_check_is_one() -> None:
    for kind in schemas().values():
        assert kind  # loads the checks of every kind
    names = {name for _, name in REGISTER}
    assert not set(RENAMED_CHECKS) & names


def test_the_page_of_documents_is_that_of_the_code() -> None:
    spec = spec_from_file_location("documents_page", ROOT / "docs" / "documents.py")
    assert spec is not None
    assert spec.loader is not None
    written = module_from_spec(spec)
    spec.loader.exec_module(written)
    page = (ROOT / "docs" / "documents.md").read_text(encoding="utf-8")
    assert written.format_page() == page, "run `python docs/documents.py`"


def test_edited_version_1_fit_is_refused() -> None:
    document = json.loads(read_text("levels"))
    document["mass"] *= 2
    with pytest.raises(dp.ReadError, match="changed by hand"):
        from_json(json.dumps(document))


def test_version_1_document_refuses_a_version_2_key() -> None:
    document = json.loads(read_text("plugin-fit"))
    document["nonsense"] = 1
    with pytest.raises(dp.ReadError, match='"nonsense", which this version'):
        from_json(json.dumps(document))


@pytest.mark.parametrize(
    ("schema", "message"),
    [
        (
            "dashpot/fit@3",
            "of a newer version of dashpot; this version reads 'dashpot/fit' up to @2",
        ),
        ("dashpot/model@2", "up to @1. Update dashpot"),
        ("dashpot/batch@2", "this is the result of a lot (use dashpot fit with the file of one"),
        (
            "dashpot/nothing@1",
            "a stored nothing: its \"schema\" is 'dashpot/nothing@1', which is not read back",
        ),
        ("another/fit@1", "this is no result of dashpot: its \"schema\" is 'another/fit@1'"),
        (None, 'this is no result of dashpot: its "schema" is None'),
    ],
)
def test_an_unknown_schema_is_refused_with_what_to_do(schema: str | None, message: str) -> None:
    with pytest.raises(dp.ReadError) as refusal:
        from_json(json.dumps({"schema": schema}))
    assert message in str(refusal.value)


def test_version_1_digest_covers_its_content() -> None:
    document = json.loads(read_text("levels"))
    assert compute_document_digest(document) == document["digest"]
    assert "digest" not in convert_document(document)


@pytest.mark.parametrize("key", ["noise_covariance", "parameter_changes", "message"])
def test_version_1_document_refuses_both_names_of_a_key(key: str) -> None:
    document = json.loads(read_text("fit"))
    document.pop("digest", None)
    with pytest.raises(ReadError, match=f'and "{key}" of the document are one'):
        from_json(json.dumps(document | {"of_noise": [[1.0]], key: None}))


@pytest.mark.parametrize("verb", ["predict", "compare"])
def test_answer_of_a_command_says_that_it_is_not_read_back(verb, tmp_path):
    """An answer holds less than it was made of, so that its verdict could be another."""
    test = dp.simulate("relaxation", hold="5s", noise_free=True)
    fit, path = dp.fit(test, arms=2), tmp_path / "answer.json"
    if verb == "predict":
        dp.predict(fit, mass="104g").save(path)
    else:
        comparison = dp.compare(fit, dp.simulate("impact", hits=3))
        comparison.save(path)
        assert type(from_json(to_json(comparison.comparison))) is type(comparison.comparison)
    with pytest.raises(dp.ReadError, match=r"which is not read back. Give the fit or the record"):
        dp.read(path)
