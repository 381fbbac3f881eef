"""Every result goes to JSON and comes back the same; unknown documents are refused."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from kit.fits import a_fit

from dashpot.base.checks import Check
from dashpot.base.errors import DataError, ReadError, Status
from dashpot.base.provenance import Source, Step
from dashpot.datamodel.fit import get_temperature_law
from dashpot.datamodel.frf import FRF, Hit
from dashpot.datamodel.parameter_estimate import Nuisance, Profile, Residual
from dashpot.datamodel.relaxation import RampHold, RelaxationTest
from dashpot.datamodel.shift_factors import Shift, TemperatureShifts
from dashpot.datamodel.specimen import Specimen
from dashpot.datamodel.vibration_tests import ImpactTest
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.modes.measured_modes import MeasuredMode, MeasuredModes
from dashpot.planning.plan import plan
from dashpot.planning.planned_ramp_hold import Bench
from dashpot.reading.readers.inspect import InspectedColumn, Segment
from dashpot.reading.table import Question
from dashpot.solids.maxwell import GeneralizedMaxwell
from dashpot.solids.shift_laws import WLF, Arrhenius, FreeShifts
from dashpot.vibration.comparison.compare import compare
from dashpot.vibration.mass_on_seals import predict_frf
from dashpot.workflow.inspections import InspectedFile, Inspections, Preparation
from dashpot.workflow.job import Job
from dashpot.workflow.json_archive import from_json, to_json
from dashpot.workflow.measured_frf import ImpactMode, ImpactResult

SOURCE = Source("seal.csv", "0" * 64, "text", ("time [s]",), ("a note",), simulated=True)
TIME = np.linspace(0, 1, 11)
TEST = RelaxationTest(
    TIME, TIME**2 / 100, TIME / 3, Specimen(length=0.1, notes="é <b>"), SOURCE, units="SI"
)
RAMP = RampHold(
    TIME, TIME**2, TIME / 3, onset=0.1, ramp_end=0.2, hold_end=0.9, depth=8e-3,
    steps=(Step("tare", (("force", "0.05 N"),), "said"),), checks=(Check("c", False, "no", 1.0),),
)  # fmt: skip
MODEL = GeneralizedMaxwell(196.5, (117.5, 17.8), (0.5021, 16.416))
COVARIANCE = np.diag([1e-2, 1e-2, np.inf, 1e-4, 1e-4])
FIT = a_fit(
    MODEL,
    status=Status.NOT_IDENTIFIED,
    residual=Residual(41000, 1e-3, 1.6e-4),
    covariance=COVARIANCE,
    dof=float("inf"),
    band=(0.004, 0.32),
    profiles=(Profile("ln_tau_2", np.array([1.0, 2.0]), np.array([0.0, np.inf])),),
    nuisance=(Nuisance("drift", 2e-4, 1e-5, "N/s"),),
    source=(SOURCE,),
)
SHIFTS = (Shift(273.15, 1.5, 0.01, 0.9, 0.001), Shift(296.15, 0.0, 0.0))
TWO_BY_TWO = np.diag([1e-4, 0.0, 1e-6, 0.0])
LAWS = (
    TemperatureShifts(WLF(6.9, 129.6, 296.15), SHIFTS, TWO_BY_TWO, ("c1", "c2"), np.eye(2)),
    TemperatureShifts(Arrhenius(6e4, 296.15), SHIFTS, TWO_BY_TWO, ("energy",), np.eye(1), "T/T_r"),
    TemperatureShifts(FreeShifts((273.15, 296.15), (1.5, 0.0), 296.15), SHIFTS, TWO_BY_TWO),
)
FREQUENCY = np.linspace(5, 30, 101)
MEASURED = FRF(
    FREQUENCY,
    predict_frf(2 * MODEL, mass=0.1, frequency=FREQUENCY).value * (1 + 0.01j),
    coherence=np.full(101, 0.99),
    sd=np.full(101, 0.1),
    shift=0.5,
    record=8.0,
    averages=3,
    hits=(Hit("1", 0.1, False, ("double hit",), 3.0, 0.01),),
    units="SI",
)
IMPACT = ImpactTest(
    TIME, TIME, np.array([TIME, -TIME]), positions=(0.05, -0.05), source=(SOURCE,), units="SI"
)
PREDICTED = predict_frf(2 * MODEL, mass=0.104, frequency=FREQUENCY)
MODES = (ImpactMode(12.7, 0.03, 0.01, None, "rational"),)
INSPECTED = {"file": "a.csv", "sha256": "0" * 64, "format": "text", "kind": "relaxation"}
SEEN = Preparation(0.1, 1.1, 41.0, 1.0, 39.9, 8e-3, 0.05, 4e-3, 1e-5, RAMP.steps, RAMP.checks)
INSPECTIONS = Inspections(
    (
        InspectedFile(**INSPECTED, reason="it moves", preparation=SEEN),
        InspectedFile(**INSPECTED, reason="it moves", refusal="there is no ramp"),
        InspectedFile(
            **INSPECTED | {"kind": "unclear"},
            reason="nothing fits",
            columns=(InspectedColumn(1, "t", "s", "time", "its name", (0.0, None)),),
            segments=(Segment("Hit 1", 100, 0.0, None),),
            questions=(Question("which is force?", "--force"),),
        ),
    )
)
LEAST = '{"schema": "dashpot/fit@2", "model": {"k_inf": 1.0, "arms": []}}'
NOUNS = [
    MODEL,
    DynamicTest(
        np.array([1.0, 2.0, 5.0]), np.array([3.0, 4.0, 5.0]), np.array([0.1, 0.2, 0.1]), units="SI"
    ),
    TEST,
    RAMP,
    FIT,
    *(replace(FIT, temperatures=law) for law in LAWS),
    IMPACT,
    MEASURED,
    PREDICTED,
    compare(PREDICTED, replace(MEASURED, shift=0.0, record=None)),
    plan(Bench(rate=100.0), at=12.71),
    ImpactResult(MEASURED, MODES, "Hv", "none", "frf.csv"),
    MeasuredModes(
        MEASURED,
        (MeasuredMode(12.7, 0.03, 0.01, None, "rational", 0.0, -0.06, None, 0.1),),
        (5.0, 30.0),
    ),
    INSPECTIONS,
    Job("a.csv", ("b.csv",), mass=0.104, arms="auto", band=(5.0, 40.0)),
]


@pytest.mark.parametrize("result", NOUNS, ids=lambda result: type(result).__name__)
def test_round_trip(result):
    text = to_json(result)
    again = from_json(text)
    assert type(again) is type(result)
    assert again == result
    assert to_json(again) == text


@given(
    st.floats(0, 1e300),
    st.lists(st.tuples(st.floats(1e-300, 1e300), st.floats(1e-300, 1e300)), max_size=5),
)
@settings(max_examples=100)
def test_models_come_back_to_the_last_bit(k_inf, arms):
    model = GeneralizedMaxwell(k_inf, tuple(k for k, _ in arms), tuple(t for _, t in arms))
    assert from_json(to_json(model)) == model


def test_a_fit_speaks_the_contract():
    document = json.loads(to_json(FIT))
    assert document["schema"] == "dashpot/fit@2"
    assert document["status"] == "not_identified"
    assert document["ok"] is False
    assert document["model"]["arms"][0] == {"k": 117.5, "tau": 0.5021, "b": 117.5 * 0.5021}
    assert document["band_hz"] == [0.004, 0.32]
    assert document["standard_error"]["k_inf"] is None
    assert document["interval_95"]["k_inf"][0] == 0
    assert document["standard_error"]["arms"][1]["k"] is None  # infinite: not known
    assert document["residual"]["n"] == 41000
    assert document["source"][0]["sha256"] == "0" * 64


def test_a_fit_of_several_temperatures_speaks_the_contract():
    temperature = json.loads(to_json(replace(FIT, temperatures=LAWS[0])))["temperature"]
    assert temperature["reference"] == 296.15
    assert temperature["law"] == {"kind": "wlf", "c1": 6.9, "c2": 129.6}
    cold = {"temperature": 273.15, "log10_a_t": 1.5, "se": 0.01, "b_t": 0.9, "b_t_se": 0.001}
    assert temperature["shifts"][0] == cold


def test_the_least_temperature_of_the_contract_is_read():
    shifts = '[{"temperature": 273.15, "log10_a_t": 1.5, "se": 0.01, "b_t": 0.9}, {"temperature": '
    law = '{"kind": "wlf", "c1": 6.9, "c2": 129.6}'
    text = f'{{"reference": 296.15, "law": {law}, "shifts": {shifts}296.15, "log10_a_t": 0.0, '
    fit = from_json(LEAST[:-1] + f', "temperature": {text}"se": 0.0, "b_t": 1.0}}]}}}}')
    assert get_temperature_law(fit) == WLF(6.9, 129.6, 296.15)
    assert fit.temperatures.shifts[0].b_t == 0.9


def test_the_least_fit_of_the_contract_is_read():
    """A fit with the contract's keys only, as another program may write it."""
    fit = from_json(
        """{"schema": "dashpot/fit@2", "status": "converged", "ok": true,
        "model": {"k_inf": 196.5, "b": 0.0, "arms": [{"k": 117.5, "tau": 0.5021, "b": 59.0}]},
        "standard_error": {"k_inf": 0.1, "arms": [{"k": 0.2, "tau": 0.003}]},
        "residual": {"n": 41000, "sse": 1.0e-3, "rms": 1.6e-4}, "band_hz": [0.004, 0.32],
        "orders": [{"arms": 1, "bic": 1.0, "sse": 1.0}],
        "checks": [{"name": "hold_long_enough", "passed": true, "value": 2.4, "limit": 3.0,
                    "message": "..."}],
        "source": [{"file": "seal_8mm.csv", "sha256": "..."}]}"""
    )
    assert fit.model == GeneralizedMaxwell(196.5, (117.5,), (0.5021,))
    assert fit.ok
    assert fit.band == (0.004, 0.32)
    assert fit.standard_error["k"] == pytest.approx((0.2,))
    assert fit.standard_error["tau"] == pytest.approx((0.003,))


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ('"k_inf": 196.5', '"k_inf": 196500.0'),
        ('"message": "', '"message": "it is very good: '),
        ('"sha256": "0', '"sha256": "1'),
    ],
)
def test_a_fit_that_was_edited_is_noticed(before, after):
    text = to_json(FIT)
    assert before in text
    edited = text.replace(before, after, 1)
    with pytest.raises(ReadError, match=r'changed by hand; .* take "digest" out'):
        from_json(edited)
    bare = json.loads(edited)
    del bare["digest"]
    from_json(json.dumps(bare))


def test_a_fit_printed_by_another_program_is_that_fit():
    def convert_to_integer(value):
        return int(value) if isinstance(value, float) and value == int(value) else value

    def convert_integers(value):
        if isinstance(value, dict):
            return {key: convert_integers(item) for key, item in reversed(value.items())}
        return (
            list(map(convert_integers, value))
            if isinstance(value, list)
            else convert_to_integer(value)
        )

    assert from_json(json.dumps(convert_integers(json.loads(to_json(FIT))))) == FIT


def test_a_text_for_a_number_is_named():
    text = (
        '{"schema": "dashpot/fit@2", "model": {"k_inf": 1.0, "arms": [{"k": 2.0, "tau": "0,1"}]}}'
    )
    with pytest.raises(ReadError, match=r'arms\[0\]\.tau is the text "0,1"; expected a number'):
        from_json(text)


def test_a_fit_that_tells_no_errors_claims_none():
    fit = from_json(
        '{"schema": "dashpot/fit@2", "model": {"k_inf": 1.0, "arms": [{"k": 2.0, "tau": 3.0}]}}'
    )
    assert fit.standard_error["k_inf"] == float("inf")
    assert fit.intervals()["tau"] == ((0.0, float("inf")),)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "not a JSON document"),
        ("[1, 2]", '"schema" is None'),
        ('{"schema": "dashpot/fit@9"}', "dashpot/fit@9"),
        ('{"schema": "dashpot/fit@2"}', "model"),
        (LEAST[:-1] + ', "status": "fine"}', "status 'fine'"),
        ('{"schema": "dashpot/model@1", "k_inf": -1, "arms": []}', "k_inf >= 0"),
        ('{"schema": "dashpot/model@1", "k_inf": "a", "arms": []}', "float"),
        ('{"schema": "dashpot/model@1", "k_inf": 1, "arms": [{"k": 1}]}', "tau"),
        ('{"schema": "dashpot/model@1", "k_inf": 1, "arms": 5}', "not valid"),
        ('{"schema": []}', '"schema" is []'),
        ('{"schema": {"a": 1}}', '"schema" is {'),
        ('{"schema": "dashpot/model@1", "k_inf": 1}', 'no "arms"'),
        ('{"schema": "dashpot/fit@2", "model": {"k_inf": 1}}', 'no "arms"'),
        ('{"schema": "dashpot/model@1", "k_inf": 1, "arms": {}}', "$.arms is an object"),
        ('{"schema": "dashpot/model@1", "k_inf": 1, "arms": [], "k": []}', '$ has "k"'),
        ('{"schema": "dashpot/model@1", "k_inf": true, "arms": []}', "got `bool`"),
        ('{"schema": "dashpot/model@1", "k_inf": 1, "k_inf": 2, "arms": []}', "stands twice"),
        (
            '{"schema": "dashpot/model@1", "k_inf": 1, "arms": [{"k": 1, "tau": 1, "c": 2}]}',
            '$.arms[0] has "c"',
        ),
        (LEAST[:-1] + ', "colour": "red"}', '$ has "colour"'),
        (LEAST[:-1] + ', "orders": {}}', "$.orders is an object; expected an array"),
        (LEAST[:-1] + ', "specimen": {"lenght": 0.1}}', '$.specimen has "lenght"'),
        (LEAST[:-1] + ', "residual": []}', "not valid"),
        (LEAST[:-1] + ', "elastic_law": {"kind": "linear"}}', "is missing"),
        (LEAST[:-1] + ', "temperature": {"reference": 296.15}}', "is missing"),
        (
            LEAST[:-1] + ', "temperature": {"reference": 296, "law": {"kind": "vft"}, '
            '"shifts": []}}',
            "law 'vft'",
        ),
    ],
)
def test_strangers_are_turned_away(text, message):
    with pytest.raises(ReadError, match=re.escape(message)):
        from_json(text)


def test_to_json_refuses_other_types():
    with pytest.raises(DataError, match="a dict has no archive form"):
        to_json({})


@given(st.binary(max_size=200))
@settings(max_examples=100)
def test_any_bytes_are_read_or_refused(content):
    with pytest.raises(ReadError):
        from_json(content)


@given(st.data())
@settings(max_examples=60, deadline=None)
def test_altered_document_is_read_or_refused(data):
    """A key renamed, dropped or given another type: a result or an error, never a guess."""
    whole = json.loads(to_json(data.draw(st.sampled_from([MODEL, FIT, NOUNS[-1], INSPECTIONS]))))
    place = data.draw(st.sampled_from([item for item in objects(whole) if item]))
    key = data.draw(st.sampled_from(sorted(place)))
    change = data.draw(st.sampled_from(["rename", "drop", [], {}, "text", None, True, 1e400, -1]))
    value = place.pop(key)
    if change == "rename":
        place[f"{key}_"] = value
    elif change != "drop":
        place[key] = change
    try:
        again = from_json(json.dumps(whole))
    except ReadError:
        return
    assert change != "rename"
    assert from_json(to_json(again)) == again


def objects(value):
    """Every object in a document."""
    if isinstance(value, dict):
        yield value
    for item in value.values() if isinstance(value, dict) else value:
        if isinstance(item, dict | list):
            yield from objects(item)
