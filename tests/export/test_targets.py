"""Names and synonyms of targets, and the range of a table where none is given."""

from __future__ import annotations

import re

import pytest
from kit.fits import a_fit
from kit.shell import ran

import dashpot as dp
from dashpot.base.errors import ExportError
from dashpot.datamodel.specimen import Specimen
from dashpot.export import FORMS, TARGETS
from dashpot.registry import SOLVER_INPUTS, SOLVER_NAMES
from dashpot.solids.demo_seals import PAPER

TERMS = {"unit_system": "mm-t-s", "temperature": "23degC", "length": "50mm"}


@pytest.mark.parametrize(
    ("word", "target"),
    [
        ("OptiStruct", "optistruct"), ("NX-Nastran", "nastran"), ("NASTRAN", "nastran"),
        ("MAPDL", "ansys"), ("ccx", "calculix"),
        ("LS-DYNA", "lsdyna"), ("OpenRadioss", "radioss"), ("Abaqus", "abaqus"), ("FMI", "fmu"),
        ("OpenSeesPy", "opensees"), ("Octave", "statespace"), ("CSV", "csv"),
    ],
)  # fmt: skip
def test_export_takes_synonyms_in_any_case(word, target):
    form = FORMS[target][0]
    more = {"modulus": "1MPa"} if target == "radioss" else {}
    assert dp.export(PAPER, to=word, **TERMS, **more) == dp.export(
        PAPER, to=target, form=form, **TERMS, **more
    )


def test_no_synonym_names_two_targets():
    words = [word for name, row in SOLVER_INPUTS.items() for word in (name, *row.synonyms)]
    assert len(words) == len(set(words)) == len(SOLVER_NAMES)
    assert all(word == word.lower() for word in words)


def test_the_command_takes_synonyms_in_any_case(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    dp.save(a_fit(PAPER, specimen=Specimen(temperature=296.15, length=0.05)), "fit.json")
    texts = []
    for word in ("NX-Nastran", "nastran"):
        done = ran("export", "fit.json", "--to", word, "--unit-system", "SI")
        assert done.exit_code == 0, done.output
        texts.append(done.stdout)
    assert texts[0] == texts[1]
    done = ran("export", "fit.json", "--to", "Nastrian", "--unit-system", "SI")
    assert done.exit_code == 2
    assert "nastran" in done.output


def test_export_refuses_what_is_no_target():
    with pytest.raises(ExportError, match="'lusas' is no solver"):
        dp.export(PAPER, to="lusas", **TERMS)


def row_ends(target: str, text: str) -> tuple[float, float]:
    """First and last frequency, Hz, of the table that the header counts."""
    (result,) = re.findall(r"table: \d+ points, (\S+) to (\S+) Hz", text)
    return float(result[0]), float(result[1])


@pytest.mark.parametrize(
    ("target", "form"),
    [("nastran", "table"), ("nastran", "viscous-table"), ("abaqus", "connector"),
     ("ansys", "table"), ("csv", "frequency")],
)  # fmt: skip
def test_a_table_without_a_band_spans_the_valid_band(target, form):
    fit = a_fit(
        PAPER, band=(0.0041239, 0.31831), specimen=Specimen(temperature=296.15, length=0.05)
    )
    low, high = row_ends(target, TARGETS[target](fit, units="SI", form=form))
    assert 0.0041239 <= low < 0.00413
    assert 0.3182 < high <= 0.31831
    inputs = TARGETS[target](fit, units="SI", form=form, frequency_range=(1.0, 30.0))
    assert row_ends(target, inputs) == (1.0, 30.0)
    assert row_ends(target, TARGETS[target](PAPER, units="SI", form=form)) == (1.0, 100.0)
    nowhere = a_fit(PAPER, band=(0.0, 0.0), specimen=Specimen(temperature=296.15, length=0.05))
    assert row_ends(target, TARGETS[target](nowhere, units="SI", form=form)) == (1.0, 100.0)
    assert "EXTRAPOLATED: " not in TARGETS[target](fit, units="SI", form=form)


def test_modes_take_the_stiffness_at_10_hz_or_at_the_end_of_the_valid_band():
    for end, nominal in ((0.31831, "0.3183"), (40.0, "10")):
        fit = a_fit(PAPER, band=(0.004, end), specimen=Specimen(temperature=296.15, length=0.05))
        assert f"nominal K and damping: those at {nominal} Hz" in TARGETS["nastran"](
            fit, units="SI"
        )
