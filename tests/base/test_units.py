"""Unit words, held against a well-kept units library."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dashpot.base.errors import DataError
from dashpot.base.units import (
    TABLE,
    convert_to_unit,
    dimensions,
    find_unit,
    get_display_unit,
    parse_quantity,
    parse_range,
    parse_unit,
    si_unit,
)

PINT = {
    "gn": "standard_gravity", "gf": "gram_force", "kgf": "kilogram_force", "kp": "kilogram_force",
    "lbf": "pound_force", "in": "inch", "t": "metric_ton", "1": "dimensionless", "%": "percent",
    "lb": "pound", "h": "hour", "degC": "degree_Celsius", "degF": "degree_Fahrenheit",
    "daN": "decanewton", "ozf": "force_ounce", "mil": "thou", "tf": "force_metric_ton",
}  # fmt: skip
SI = {
    "time": "s", "length": "m", "force": "N", "mass": "kg", "acceleration": "m/s^2",
    "velocity": "m/s", "frequency": "Hz", "stiffness": "N/m", "damping": "N*s/m", "strain": "",
    "stress": "Pa", "voltage": "V", "torque": "N*m", "angle": "rad", "temperature": "K",
    "compliance": "m/N", "force rate": "N/s", "material compliance": "1/Pa",
    "moment of inertia": "kg*m^2", "area": "m^2", "volume": "m^3", "viscosity": "Pa*s",
    "energy": "J", "molar energy": "J/mol",
}  # fmt: skip


def test_every_factor_is_that_of_pint() -> None:
    import pint

    registry = pint.UnitRegistry()
    for key, unit in TABLE.items():
        dimension, word = key.split(":")
        name = "standard_gravity" if key == "acceleration:g" else PINT.get(word, word)
        name = name.replace("/h", "/hour")  # an h alone is Planck's constant to pint
        if word == "rad/s":  # pint takes a radian for a number; a cycle is 2 pi of them
            assert unit.factor == pytest.approx(1 / (2 * math.pi))
            continue
        theirs = registry.Quantity(1.0, name).to(SI[dimension]).magnitude
        assert unit.factor + unit.offset == pytest.approx(theirs, rel=1e-12), key


@pytest.mark.parametrize(
    ("word", "dimension", "text"),
    [
        ("mm", "length", "mm"), ("Newtons", "force", "N"), ("µm", "length", "um"),
        ("μm", "length", "um"), ("Sec.", "time", "sec"), ("HZ", "frequency", "Hz"),
        ("days", "time", "d"), ("Tage", "time", "d"),
        ("m/s²", "acceleration", "m/s^2"), ("m/s2", "acceleration", "m/s^2"),
        ("g", "acceleration", "g"), ("g", "mass", "g"), ("nm", "length", "nm"),
        ("Nm", "torque", "N*m"), ("°C", "temperature", "degC"), ("千牛", "force", "kN"),
        ("毫米", "length", "mm"), ("мм", "length", "mm"), ("Sekunden", "time", "s"),
        ("mils", "length", "mil"), ("pond", "force", "gf"), ("ft/s²", "acceleration", "ft/s^2"),
        ("GAL", "acceleration", "Gal"), ("lb/in", "stiffness", "lbf/in"), ("µε", "strain", "um/m"),
        ("N/(m/s)", "damping", "N*s/m"), ("dyne", "force", "dyn"), ("pounds", "mass", "lb"),
        ("lb_f", "force", "lbf"), ("KN", "force", "kN"),
        ("µm/N", "compliance", "um/N"), ("Pa⁻¹", "material compliance", "1/Pa"),
        ("mn/s", "force rate", "mN/s"),
        ("N.s/mm", "damping", "N*s/mm"), ("-", "strain", "1"), ("millimetres", "length", "mm"),
    ],
)  # fmt: skip
def test_spellings(word: str, dimension, text: str) -> None:
    unit = find_unit(word, dimension)
    assert unit is not None
    assert unit.word == text


@pytest.mark.parametrize(
    ("word", "dimension"), [("mn", "force"), ("MM", "time"), ("x", None), ("", None)]
)
def test_what_is_no_unit(word: str, dimension) -> None:
    assert find_unit(word, dimension) is None


def test_a_meganewton_is_no_millinewton() -> None:
    assert find_unit("MN", "force").factor == 1e6
    assert find_unit("mN", "force").factor == 1e-3


def test_words_of_two_meanings() -> None:
    assert dimensions("g") == ("mass", "acceleration")
    assert dimensions("nm") == ("length", "torque")
    assert dimensions("furlong") == ()
    with pytest.raises(
        DataError, match="'g' is a unit of mass or acceleration; expected a unit of force"
    ):
        parse_unit("g", "force")
    with pytest.raises(DataError, match="'furlong' is not a known unit; expected a unit of length"):
        parse_unit("furlong", "length")


@given(st.floats(1e-6, 1e6), st.sampled_from(["s", "ms", "min"]))
def test_quantities(value: float, word: str) -> None:
    factor = {"s": 1.0, "ms": 1e-3, "min": 60.0}[word]
    assert parse_quantity(f"{value!r}{word}", "time") == pytest.approx(value * factor, rel=1e-15)
    assert parse_quantity(f" {value!r} {word} ", "time") == pytest.approx(value * factor, rel=1e-15)


def test_quantities_as_people_write_them() -> None:
    assert parse_quantity("104g", "mass") == 0.104
    assert parse_quantity("-40 °C", "temperature") == pytest.approx(233.15)
    assert parse_quantity("73.4degF", "temperature") == pytest.approx(296.15)
    assert parse_quantity("1e3Hz", "frequency") == 1000.0
    assert parse_quantity(".5mm", "length") == 0.0005
    assert parse_range("1:50Hz", "frequency") == (1.0, 50.0)
    assert parse_range("500 ms : 2 s", "time") == (0.5, 2.0)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("104", "has no unit; add a unit of mass to it, for example '104g'"),
        ("g", "is not a quantity"),
        ("104N", "'N' is a unit of force"),
        ("1,5g", "write '1.5g' with a point"),
        ("", "is not a quantity"),
    ],
)
def test_bad_quantities(text: str, words: str) -> None:
    with pytest.raises(DataError, match=words):
        parse_quantity(text, "mass")


@pytest.mark.parametrize("text", ["5Hz", "5:1Hz", "1:5", "a:bHz"])
def test_bad_ranges(text: str) -> None:
    with pytest.raises(DataError):
        parse_range(text, "frequency")


@pytest.mark.parametrize("text", ["1e400g", "1e-400g", "1e19 g", "-1e19g", "9e-14g"])
def test_what_nobody_can_mean_is_refused(text: str) -> None:
    with pytest.raises(DataError, match=r"expected 0 or a magnitude from 1e-15 to 1e.15"):
        parse_quantity(text, "mass")


def test_the_ends_of_what_can_be_meant() -> None:
    assert parse_quantity("1e15kg", "mass") == 1e15
    assert parse_quantity("1e-12g", "mass") == 1e-15
    assert parse_quantity("0e400g", "mass") == 0


def test_a_range_begins_at_nought_or_above() -> None:
    assert parse_range("0:5Hz", "frequency") == (0.0, 5.0)
    with pytest.raises(DataError, match="begins below 0"):
        parse_range("-5:5Hz", "frequency")


@given(st.sampled_from(sorted(TABLE)), st.floats(-1e6, 1e6))
def test_in_a_unit_and_back(key: str, value: float) -> None:
    dimension, word = key.split(":")
    if word in {"g", "nm"} and dimension == "acceleration":
        return  # shown in m/s^2, never in g
    unit = TABLE[key]
    shown = convert_to_unit(value, word)
    assert unit.factor * shown + unit.offset == pytest.approx(value, rel=1e-12, abs=1e-9)


def test_what_people_read_is_the_same_quantity() -> None:
    for unit in TABLE.values():
        plain = si_unit(unit.dimension)
        read = find_unit(get_display_unit(plain.word), unit.dimension)
        assert read is not None, unit.word


def test_a_unit_that_is_not_in_the_table_is_refused() -> None:
    with pytest.raises(DataError, match="'furlong' is not a known unit"):
        convert_to_unit(1.0, "furlong")


def test_a_share_without_a_unit_is_shown_with_its_sign():
    with pytest.raises(DataError, match="for example '4%'"):
        parse_quantity("4", "strain")
