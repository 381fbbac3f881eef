"""Cards and tables that no solver here runs, read back by parsers of their own."""

from __future__ import annotations

import io
import re

import numpy as np
import pytest

import dashpot as dp
from dashpot.base.errors import ExportError

SEAL = dp.GeneralizedMaxwell(196.5, k=(117.5, 17.8), tau=(59.0 / 117.5, 292.2 / 17.8))
K_0 = 196.5 + 117.5 + 17.8


def write(to: str, form: str, unit_system: str = "mm-t-s", **arguments: object) -> str:
    return dp.export(SEAL, to=to, form=form, unit_system=unit_system, **arguments)  # type: ignore[arg-type]


def compute_stiffness(frequency: float) -> complex:
    s = 2j * np.pi * frequency
    return complex(196.5 + 117.5 * s / (s + 117.5 / 59.0) + 17.8 * s / (s + 17.8 / 292.2))


def read_small_fields(deck: str) -> list[str]:
    """Return the fields of the one card of a deck, its continuation behind it."""
    rows = [line for line in deck.splitlines() if line and not line.startswith("$")]
    cells = [[row[i : i + 8].strip() for i in range(0, len(row), 8)] for row in rows]
    assert [row[0] for row in cells[1:]] == ["+"] * (len(cells) - 1)
    return [cells[0][0], *(cell for row in cells for cell in row[1:])]


def test_matve_holds_relative_moduli_and_times():
    name, number, kind, *terms = read_small_fields(write("optistruct", "prony", first_id=7))
    assert (name, number, kind) == ("MATVE", "7", "PRONY")
    expected = [117.5 / K_0, 59.0 / 117.5, 17.8 / K_0, 292.2 / 17.8]
    np.testing.assert_allclose(list(map(float, terms)), expected, rtol=2e-6)


def test_matve_holds_at_most_five_terms():
    times = 10.0 ** np.arange(6)
    deck = dp.export(
        dp.GeneralizedMaxwell(1.0, k=(1.0,) * 5, tau=times[:5]), to="optistruct", form="prony",
        unit_system="SI",
    )  # fmt: skip
    assert len(read_small_fields(deck)) == 3 + 10
    many = dp.GeneralizedMaxwell(1.0, k=(1.0,) * 6, tau=times)
    with pytest.raises(ExportError, match="MATVE holds 5 terms, and the model has 6 arms"):
        dp.export(many, to="optistruct", form="prony", unit_system="SI")


@pytest.mark.parametrize("form", ["table", "viscous-table", "arms"])
def test_optistruct_bushings_are_those_of_nastran(form):
    assert write("optistruct", form) == write("nastran", form)


@pytest.mark.parametrize(("unit_system", "unit"), [("SI", 1.0), ("mm-t-s", 1e-3)])
def test_comsol_table_interpolates_to_the_stiffness(unit_system, unit):
    deck = write("comsol", "table", unit_system, band=(1, 50))
    frequency, storage, loss = np.loadtxt(io.StringIO(deck), comments="%").T
    middle = np.sqrt(frequency[:-1] * frequency[1:])
    for f in middle:
        result = complex(np.interp(f, frequency, storage), np.interp(f, frequency, loss)) / unit
        wanted = compute_stiffness(f)
        assert abs(result - wanted) <= 1e-3 * wanted.imag


def test_comsol_branches_add_to_the_long_term_modulus():
    deck = write("comsol", "prony", modulus="1.2MPa")
    moduli, times = np.loadtxt(io.StringIO(deck), comments="%").T
    np.testing.assert_allclose(moduli, 1.2 * np.array([117.5, 17.8]) / K_0, rtol=1e-9)
    np.testing.assert_allclose(times, [59.0 / 117.5, 292.2 / 17.8], rtol=1e-9)
    (long_term,) = re.findall(r"long-term shear modulus, (\S+)", deck)
    assert float(long_term) + moduli.sum() == pytest.approx(1.2)


def read_property_file(text: str) -> dict[str, list[str]]:
    """Return the lines of each block of a property file."""
    blocks: dict[str, list[str]] = {}
    for line in text.splitlines():
        if line.startswith("["):
            rows = blocks.setdefault(line.strip("[]"), [])
        elif line and not line.startswith("$"):
            rows.append(line.strip())
    return blocks


@pytest.mark.parametrize(
    ("unit_system", "unit", "word"), [("SI", 1, "meter"), ("mm-t-s", 1e-3, "mm")]
)
def test_bushing_property_file_is_right_at_its_frequency(unit_system, unit, word):
    blocks = read_property_file(write("adams", "bus", unit_system, nominal="12.71Hz"))
    assert "FILE_TYPE = 'bus'" in blocks["MDI_HEADER"]
    assert f"LENGTH = '{word}'" in blocks["UNITS"]
    stiffness = compute_stiffness(12.71)
    damping = dict(row.split(" = ") for row in blocks["DAMPING"])
    assert float(damping.pop("FX_DAMPING")) == pytest.approx(
        stiffness.imag / (2 * np.pi * 12.71) * unit
    )
    assert set(damping.values()) == {"0."}
    head, *rows = blocks["FX_CURVE"]
    x, force = np.array([row.split() for row in rows], dtype=float).T
    assert head == "{ x fx }"
    np.testing.assert_allclose(force, stiffness.real * unit * x, rtol=1e-9, atol=1e-12)
    for axis in ("FY", "FZ", "TX", "TY", "TZ"):
        assert all(float(row.split()[1]) == 0 for row in blocks[f"{axis}_CURVE"][1:])


def test_bushing_property_file_is_refused_in_kilonewtons():
    with pytest.raises(ExportError, match="take --unit-system SI or mm-t-s"):
        write("adams", "bus", "mm-kg-ms")


@pytest.mark.parametrize("k_inf", [196.5, 0.0])
def test_header_of_lsdyna_material_has_its_number_of_terms(k_inf):
    deck = dp.export(
        dp.GeneralizedMaxwell(k_inf, k=(117.5, 17.8), tau=(0.5, 16.0)), to="lsdyna", form="prony",
        unit_system="mm-t-s", modulus="1MPa", bulk_modulus="2000MPa", density=1200.0,
        allow="all",
    )  # fmt: skip
    (stated,) = re.findall(r"^\$ terms: (\d+);", deck, flags=re.MULTILINE)
    rows = deck.split("betai\n")[1].split("*END")[0].splitlines()
    assert int(stated) == len(rows) == 2 + (k_inf > 0)
    assert ("the first has beta = 0" in deck) == (k_inf > 0)


@pytest.mark.parametrize("density", ["1200kg/m^3", None, -1.0])
def test_density_of_a_card_is_a_number(density):
    with pytest.raises(dp.DashpotError, match=r"density= (in kg/m\^3\); found|is '1200kg/m\^3')"):
        write("lsdyna", "prony", modulus="1MPa", bulk_modulus="2GPa", density=density)
