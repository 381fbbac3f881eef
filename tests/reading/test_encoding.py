"""Code page of a header: units of Western files, and words of Chinese ones."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import pytest

import dashpot as dp
from dashpot.reading.text.dialect import find_encoding

NAMES = ("Temperatur", "Force", "Weg", "TC1")
UNITS = ("°C", "°", "±", "µm", "µs", "mm²", "cm³", "kg/m³", "m/s²")
ROWS = "1;2;3\n1.5;3;4\n"


@pytest.mark.parametrize("separator", [",", ";", "\t", "|"])
@pytest.mark.parametrize("layout", ["{name} [{unit}]", "{name}/{unit}", "{name} {unit}", "{unit}"])
def test_find_encoding_reads_units_of_a_western_header(separator: str, layout: str) -> None:
    """Degrees and C are the two bytes of a Chinese character; so is a sign and a separator."""
    for i, (first, second) in enumerate(product(UNITS, UNITS)):
        cells = (
            layout.format(name=NAMES[(i + j) % len(NAMES)], unit=unit)
            for j, unit in enumerate((first, second, "N"))
        )
        text = f"{separator.join(cells)}\n{ROWS}"
        raw = text.encode("cp1252")
        assert raw.decode(find_encoding(raw)) == text


@pytest.mark.parametrize("unit", ["℃", "（℃）", "(N)", "（秒）", "[mm]", "/s", "μm"])
@pytest.mark.parametrize("separator", [",", ";", "\t", "|"])
def test_find_encoding_reads_words_of_a_chinese_header(unit: str, separator: str) -> None:
    words = ("时间", "位移", "试验力", "温度", "载荷", "横梁位移", "环境温度")
    for first, second in product(words, words):
        text = f"{first}{unit}{separator}{second}{separator}{first}(N)\n{ROWS}"
        raw = text.encode("gbk")
        assert raw.decode(find_encoding(raw)) == text


def test_polish_words_are_no_cubic_metres() -> None:
    text = "Przemysł;Umysł;Siła (N);Temperatura (°C)\n" + ROWS
    raw = text.encode("cp1250")
    assert raw.decode(find_encoding(raw)) == text


def test_a_header_without_rows_counts_too() -> None:
    """The last line may be cut off within a character, unless it ends."""
    text = "Kraft|Temperatur\nN|°C\n"
    assert text.encode("cp1252").decode(find_encoding(text.encode("cp1252"))) == text


def test_temperature_in_a_pipe_table_is_read_with_its_unit(tmp_path: Path) -> None:
    rows = "".join(
        f"{0.1 * i:.1f}|{min(max(0.1 * i - 1, 0), 1) * 8:.3f}|{min(max(0.1 * i - 1, 0), 1) * 3:.3f}"
        f"|23.0|±\n"
        for i in range(200)
    )
    head = "time|displacement|force|temperature|range\ns|mm|N|°C|±\n"
    path = tmp_path / "seal.csv"
    path.write_bytes((head + rows).encode("cp1252"))
    test = dp.read(path)
    assert isinstance(test, dp.RelaxationTest)
    assert test.specimen.temperature == pytest.approx(296.15)
