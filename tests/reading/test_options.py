"""Reading options and the profiles that keep them."""

from __future__ import annotations

import tomllib
from dataclasses import fields
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dashpot.base.errors import DataError, ReadError
from dashpot.reading.read_options import ReadOptions, dump_profile, load_profile, parse_units
from dashpot.reading.toml import parsed_toml

text = st.text(st.characters(blacklist_categories=("Cs",)), min_size=1, max_size=12)
maybe = st.none() | text
OPTIONS = st.builds(
    ReadOptions,
    time=maybe, displacement=maybe, force=maybe, velocity=maybe, base_acceleration=maybe,
    acceleration=st.lists(text, max_size=3).map(tuple),
    frequency=maybe, storage=maybe, loss=maybe, loss_factor=maybe, modulus=maybe, stress=maybe,
    strain=maybe, stretch=maybe, creep_compliance=maybe,
    temperature=maybe, real=maybe, imaginary=maybe, magnitude=maybe, phase=maybe, coherence=maybe,
    hammer=maybe, cycle=st.none() | st.integers(1, 9),
    units=st.dictionaries(text, text, max_size=3),
    rate=st.none() | st.floats(1e-3, 1e7), delimiter=st.sampled_from([None, ",", "\t", "fixed"]),
    decimal=st.sampled_from([None, ".", ","]),
    encoding=st.sampled_from([None, "utf-8"]), skip_rows=st.integers(0, 99),
    window_decay=st.none() | st.just(0.0) | st.floats(1e-6, 1e3),
    segment=st.none() | st.integers(1, 9), sheet=maybe, format=maybe, kind=maybe, calibration=maybe,
    axis=st.sampled_from(["Fz", "Tx"]),
)  # fmt: skip


def test_every_field_is_drawn_above() -> None:
    names = {field.name for field in fields(ReadOptions)} - {"file_options"}
    drawn = {name for name in names if f"{name}=" in Path(__file__).read_text(encoding="utf-8")}
    assert drawn == names


@given(OPTIONS)
def test_profile_round_trip(tmp_path_factory: pytest.TempPathFactory, options: ReadOptions) -> None:
    path = tmp_path_factory.mktemp("p") / "lab.toml"
    path.write_text(dump_profile(options), encoding="utf-8")
    assert load_profile(path) == options


def test_profile_refuses_options_of_some_files() -> None:
    scoped = ReadOptions(file_options=(("h*.csv", ReadOptions(force="F")),))
    with pytest.raises(DataError, match=r"GLOB:lab\.toml"):
        dump_profile(scoped)


def test_a_profile_reads_well(tmp_path: Path) -> None:
    path = tmp_path / "lab.toml"
    path.write_text(
        'rate = "1 kHz"\n[columns]\nforce = "Kraft"\nacceleration = "a1"\n[units]\nforce = "kN"\n'
        '[text]\ndelimiter = "semicolon"\ndecimal = "comma"\n'
    )
    options = load_profile(path)
    assert (options.rate, options.force, options.acceleration) == (1000.0, "Kraft", ("a1",))
    assert (options.delimiter, options.decimal) == (";", ",")
    assert options.unit_of("force", "Kraft") == "kN"


def test_options_win_over_the_profile() -> None:
    profile = ReadOptions(force="Kraft", units={"force": "kN", "time": "ms"}, decimal=",")
    options = ReadOptions(force="Last", units={"force": "N"}).with_defaults(profile)
    assert (options.force, options.decimal) == ("Last", ",")
    assert dict(options.units) == {"force": "N", "time": "ms"}


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("force = ", "not a profile"),
        ("[columns]\nforse = 'F'", "forse is unknown; known are time"),
        ("[colums]\nforce = 'F'", "'colums' is unknown in a profile"),
        ("rate = '12 N'", "expected a unit of frequency"),
        ("[text]\ndecimal = '#'", "decimal mark '#'"),
        ("columns = 3", "lab.toml"),
    ],
)
def test_bad_profiles(tmp_path: Path, content: str, words: str) -> None:
    path = tmp_path / "lab.toml"
    path.write_text(content)
    with pytest.raises(ReadError, match=words):
        load_profile(path)
    with pytest.raises(ReadError, match=r"none.toml: there is no such file"):
        load_profile(tmp_path / "none.toml")


def test_units_from_the_command_line() -> None:
    assert parse_units("force=N, displacement = mm") == {"force": "N", "displacement": "mm"}
    assert parse_units("a=b=22.5mV/N") == {"a=b": "22.5mV/N"}
    for bad in ("force", "=N", "force=", ""):
        with pytest.raises(DataError, match="is not 'role=unit'"):
            parse_units(bad)


@pytest.mark.parametrize(
    "bad", [{"rate": 0.0}, {"rate": -1.0}, {"skip_rows": -1}, {"segment": 0}, {"delimiter": "ab"},
            {"decimal": ";"}, {"rate": float("nan")}],
)  # fmt: skip
def test_bad_options(bad: dict) -> None:
    with pytest.raises(DataError):
        ReadOptions(**bad)


@pytest.mark.parametrize(
    "content",
    ["x = " + "[" * 10_000 + "]" * 10_000, ".".join("a" * 65) + " = 1", "['a' . \"b\"" + ".c" * 63],
)
def test_a_profile_that_is_nested_too_deep_is_no_profile(
    tmp_path: Path, content: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if "=" not in content[:3]:  # its parser would take as long as the square of the parts
        monkeypatch.setattr(tomllib, "loads", lambda _: pytest.fail("it was parsed"))
    place = tmp_path / "deep.toml"
    place.write_text(content)
    with pytest.raises(ReadError, match="not a profile: not TOML that a person wrote"):
        load_profile(place)


def test_a_key_may_have_64_parts(tmp_path: Path) -> None:
    assert parsed_toml((".".join("a" * 64) + " = '1.2.3'").encode())
