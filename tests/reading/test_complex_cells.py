"""Complex numbers in one cell, as programs print them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from dashpot.reading.readers.frf import read_frf

FREQUENCY = np.linspace(6.0, 25.0, 120)
VALUE = -((2 * np.pi * FREQUENCY) ** 2) / (
    717.0 * (1 + 0.04j) - 0.1148 * (2 * np.pi * FREQUENCY) ** 2
)


def comma(text: str) -> str:
    return text.replace(".", ",")


def format_signed(value: float) -> str:
    return f"{value:+.6g}"


WRITTEN: dict[str, tuple[str, Callable[[complex], str]]] = {
    "Python": (",", lambda z: f"({z.real:.6g}{format_signed(z.imag)}j)"),
    "Python, quoted": (",", lambda z: f'"({z.real:.6g}{format_signed(z.imag)}j)"'),
    "MATLAB": (",", lambda z: f"{z.real:.6g} {'-' if z.imag < 0 else '+'} {abs(z.imag):.6g}i"),
    "MATLAB, closed up": (";", lambda z: f"{z.real:.6g}{format_signed(z.imag)}i"),
    "NumPy": (" ", lambda z: f"({z.real:.8e}{z.imag:+.8e}j)"),
    "NumPy, of old": (" ", lambda z: f"({z.real:.8e}+{z.imag:.8e}j)"),
    "an analyser": ("\t", lambda z: f"{z.real:.6g}{'-' if z.imag < 0 else '+'}j{abs(z.imag):.6g}"),
    "Excel": (";", lambda z: comma(f"{z.real:.6g}{format_signed(z.imag)}i")),
    "capitals": ("\t", lambda z: f"{z.real:.6E}{z.imag:+.6E}*I"),
}  # fmt: skip
HEADS = {
    "units beside": ["frequency [Hz]", "FRF [(m/s^2)/N]"],
    "units below": ["frequency", "FRF", "Hz", "(m/s^2)/N"],
}


@pytest.mark.parametrize(("sign", "of"), WRITTEN.values(), ids=WRITTEN.keys())
@pytest.mark.parametrize("head", HEADS.values(), ids=HEADS.keys())
def test_complex_cells_are_read(
    tmp_path: Path, sign: str, of: Callable[[complex], str], head: list[str]
) -> None:
    if sign == " ":
        head = [text.replace(" [", "[") for text in head]
    decimal = comma if of is WRITTEN["Excel"][1] else str
    names = [sign.join(head[i : i + 2]) for i in range(0, len(head), 2)]
    rows = [
        sign.join([decimal(f"{f:.6g}"), of(complex(z))])
        for f, z in zip(FREQUENCY, VALUE, strict=True)
    ]
    path = tmp_path / "frf.csv"
    path.write_text("\n".join([*names, *rows]) + "\n")
    frf = read_frf(path)
    assert frf.quantity.name == "ACCELERANCE"
    np.testing.assert_allclose(frf.value, VALUE, rtol=1e-4)
    np.testing.assert_allclose(frf.frequency, FREQUENCY, rtol=1e-5)
    assert frf.source[0].sha256 != ""


def test_words_that_end_in_i_are_no_complex_numbers(tmp_path: Path) -> None:
    path = tmp_path / "frf.csv"
    rows = [f"{f:.6g};{z.real:.6g};{z.imag:.6g}" for f, z in zip(FREQUENCY, VALUE, strict=True)]
    path.write_text(
        "run 1+2i\nfrequency [Hz];real [(m/s^2)/N];imag [(m/s^2)/N]\n" + "\n".join(rows)
    )
    np.testing.assert_allclose(read_frf(path).value, VALUE, rtol=1e-4)
