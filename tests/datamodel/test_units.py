"""Units of arrays, and the refusal of implausible values."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

import dashpot as dp
from dashpot.base.errors import DataError
from dashpot.datamodel.frf import FRF, Kind
from dashpot.datamodel.relaxation import RelaxationTest
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.extensions.amplitude.datamodel import AmplitudeSweep
from dashpot.extensions.curves.datamodel.creep import CreepCompliance, CreepTest
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.datamodel.modulus import RelaxationModulus
from dashpot.extensions.materials.cld.datamodel import CLDTest
from dashpot.extensions.materials.hyperelastic.datamodel import StressStrainTest
from dashpot.extensions.materials.indentation.datamodel import IndentationTest, Indenter
from dashpot.workflow.json_archive import from_json, to_json

T = np.arange(20.0)
X = np.linspace(0.0, 8.0, 20)
F = np.linspace(1.0, 2.0, 20)

#: class -> its arrays as given, their units, what they are in SI, and the unit that follows
CLASSES = [
    (RelaxationTest, {"time": T, "displacement": X, "force": F}, "ms, mm, kN", (1e-3, 1e-3, 1e3)),
    (CreepTest, {"time": T, "displacement": X, "force": F}, "s, mm, N", (1, 1e-3, 1)),
    (CreepTest, {"time": T, "displacement": X, "force": F}, "s, %, MPa", (1, 1e-2, 1e6)),
    (CreepCompliance, {"time": T, "compliance": F}, "s, 1/MPa", (1, 1e-6)),
    (CreepCompliance, {"time": T, "compliance": F}, "s, mm/N", (1, 1e-3)),
    (DynamicTest, {"frequency": F, "storage": F, "loss": F}, "kHz, MPa, MPa", (1e3, 1e6, 1e6)),
    (DynamicTest, {"frequency": F, "storage": F, "loss": F}, "Hz, N/mm, N/mm", (1, 1e3, 1e3)),
    (RelaxationModulus, {"time": T, "modulus": F}, "min, MPa", (60, 1e6)),
    (CLDTest, {"displacement": X, "force": F}, "mm, N", (1e-3, 1)),
    (CLDTest, {"displacement": X, "force": F, "time": T}, "mm, N, s", (1e-3, 1, 1)),
    (ImpactTest, {"time": T, "force": F, "acceleration": [F]}, "ms, N, g", (1e-3, 1, 9.80665)),
    (FRF, {"frequency": F, "value": F + 1j}, "kHz, g/N", (1e3, 9.80665)),
]  # fmt: skip
FOLLOWS = {"s, %, MPa": "Pa", "s, mm, N": "N/m", "s, 1/MPa": "1/Pa", "s, mm/N": "m/N",
           "kHz, MPa, MPa": "Pa", "Hz, N/mm, N/mm": "N/m"}  # fmt: skip


@pytest.mark.parametrize(("cls", "arrays", "units", "factors"), CLASSES)
def test_arrays_are_in_si_within(cls, arrays, units, factors):
    made = cls(**arrays, units=units)
    for (name, inputs), factor in zip(arrays.items(), factors, strict=True):
        np.testing.assert_allclose(getattr(made, name), factor * np.asarray(inputs), rtol=1e-15)
    assert made.units == "SI"
    if units in FOLLOWS and hasattr(made, "unit"):
        assert made.unit == FOLLOWS[units]
    inside = {name: getattr(made, name) for name in arrays}
    assert cls(**inside, **_get_unit(made), units="SI") == made
    assert replace(made) == made


def _get_unit(made):
    return {"unit": made.unit} if "unit" in vars(made) else {}


@pytest.mark.parametrize(("cls", "arrays", "units", "factors"), CLASSES)
def test_units_refuse_missing_surplus_and_wrong_words(cls, arrays, units, factors):
    with pytest.raises(
        DataError, match=f'{cls.__name__} has arrays without a unit.*units="SI".*units="'
    ):
        cls(**arrays)
    with pytest.raises(DataError, match=r"names 1 units? for .*\(" + ", ".join(arrays)):
        cls(**arrays, units=units.split(",")[0])
    with pytest.raises(DataError, match=r"'furlong' is (no|not a known) unit"):
        cls(**arrays, units=", ".join(("furlong", *units.split(",")[1:])))


def test_sweeps_and_modulus_classes_accept_their_units():
    sweep = AmplitudeSweep(F, X[1:].max() + F, F, F, units="Hz, mm, N/mm, N/mm")
    assert (sweep.amplitude_unit, sweep.unit, sweep.amplitude[0]) == ("m", "N/m", 9.0e-3)
    strained = AmplitudeSweep(F, F, F, F, units="Hz, %, MPa, MPa")
    assert (strained.amplitude_unit, strained.unit, strained.amplitude[0]) == ("strain", "Pa", 0.01)
    pulled = StressStrainTest("uniaxial", 1 + X, F, units="1, MPa")
    assert pulled.stress[0] == 1e6
    hit = IndentationTest(T, F, "velocity", Indenter("5g"), units="ms, mm/s")
    assert hit.signal[0] == 1e-3
    with pytest.raises(DataError, match="'N' is no unit of velocity"):
        IndentationTest(T, F, "velocity", Indenter("5g"), units="ms, N")


@pytest.mark.parametrize(
    ("units", "message"),
    [("Hz, N/m", "is a unit of dynamic stiffness"), ("Hz, m", "no unit of accelerance"),
     ("Hz, g/g", "no unit of accelerance"), ("mm, g/N", "unit of length")],
)  # fmt: skip
def test_the_unit_of_an_frf_agrees_with_what_it_relates(units, message):
    with pytest.raises(DataError, match=message):
        FRF(F, F + 0j, units=units)


@pytest.mark.parametrize("kind", list(Kind))
def test_frf_of_each_kind_reads_as_a_sentence(kind):
    """An identifier, dynamic_stiffness, stood in sentences."""
    frf = FRF(F, F + 0j, quantity=kind, units="SI")
    assert kind.label in repr(frf)
    assert "_" not in kind.label + repr(frf)


def test_units_refuse_a_mix_of_modulus_and_stiffness():
    with pytest.raises(DataError, match="both as a modulus, or both as a stiffness"):
        DynamicTest(F, F, F, units="Hz, MPa, N/mm")
    with pytest.raises(DataError, match="neither a part nor a material"):
        CreepTest(T, X, F, units="s, mm, MPa")


def test_no_document_holds_the_word():
    test = RelaxationTest(T, X, F, units="s, mm, N")
    assert "units" not in test.to_dict()
    assert from_json(to_json(test)) == test


@pytest.mark.parametrize("cls", [RelaxationTest, CreepTest, CLDTest])
@pytest.mark.parametrize(
    ("name", "just", "excess", "message"),
    [
        ("displacement", 0.499 / 8e-3, 0.501 / 8e-3, "the travel is 501 mm"),
        ("displacement", 1.001e-9 / 8e-3, 0.99e-9 / 8e-3, "the travel is 9.9e-10 m"),
        ("force", 0.999e5, 1.001e5, "the force is 200 kN"),
        ("time", 2.99e7 / 19, 3.01e7 / 19, "the length of the record is 348 days"),
    ],
)
def test_arrays_refuse_implausible_values(cls, name, just, excess, message):
    arrays = {"time": T, "displacement": 1e-3 * X, "force": F}
    cls(**{**arrays, name: just * arrays[name]}, units="SI")
    with pytest.raises(DataError, match=message):
        cls(**{**arrays, name: excess * arrays[name]}, units="SI")


def test_what_did_not_move_is_for_others_to_say():
    still = RelaxationTest(T, 0 * X, 0 * F, units="SI")
    np.testing.assert_array_equal([still.displacement, still.force], 0)


@pytest.mark.parametrize("kind", ["accelerance", "mobility", "receptance"])
def test_units_that_an_frf_advises_make_it(kind: str) -> None:
    """An accelerance was told to be in um/N, and then refused as a receptance."""
    lines = {"frequency": [1.0, 2.0], "value": [1j, 2j], "quantity": kind}
    with pytest.raises(dp.DataError) as unstated:
        dp.FRF(**lines)
    advised = re.findall(r'units="(Hz[^"]*)"', str(unstated.value))
    assert dp.FRF(**lines, units=advised[-1]).quantity == kind
    other = "N*s/m" if kind == "receptance" else "m/N"
    with pytest.raises(dp.DataError, match=r"is (a|no) unit of .*units=\"Hz, "):
        dp.FRF(**lines, units=f"Hz, {other}")
