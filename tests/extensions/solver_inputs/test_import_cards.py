"""Solver cards read back to a model, and which of its arms a test could have determined."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from kit.fits import a_fit
from kit.shell import did, ran, run_json

import dashpot as dp
from dashpot.base.errors import ReadError
from dashpot.base.provenance import Source
from dashpot.datamodel.fit import Fit
from dashpot.export import TARGETS, UNIT_SYSTEMS
from dashpot.extensions.solver_inputs.cards.card import ViscoelasticCard, parse_number
from dashpot.extensions.solver_inputs.cards.imported_model import import_card
from dashpot.extensions.solver_inputs.cards.lsdyna_cards import read_lsdyna_cards
from dashpot.extensions.solver_inputs.cards.nastran_cards import parse_bulk_data
from dashpot.extensions.solver_inputs.cards.read_cards import (
    read_cards,
    read_stated_modulus,
    read_stated_units,
    select_card,
)
from dashpot.extensions.solver_inputs.cards.testable_arms import find_testable_arms
from dashpot.planning.planned_ramp_hold import Bench
from dashpot.solids.demo_seals import PAPER
from dashpot.solids.maxwell import GeneralizedMaxwell

MM_T_S = UNIT_SYSTEMS["mm-t-s"]
TEST = Bench(depth=8e-3, ramp_time=1.0, hold_time=40.0, rate=200.0, noise=4e-3, machine=None)
TABLE_1 = GeneralizedMaxwell(196.5, (117.5, 17.8), (0.50213, 16.416))


def read_card(text: str, units: str = "mm-t-s", name: str | None = None) -> ViscoelasticCard:
    return select_card(read_cards(text, "card", UNIT_SYSTEMS[units], None), name, "card")


def import_text(text: str, units: str = "mm-t-s", **how) -> Fit:
    source = Source("card", "0" * 64)
    return import_card(
        read_card(text, units), UNIT_SYSTEMS[units], source, test=TEST, relative_noise=2e-3, **how
    ).fit


def young(E: float, terms: list[tuple[float, float]], f: np.ndarray) -> np.ndarray:
    """E* of an instantaneous modulus and relative terms, as every manual defines it."""
    s = 2j * np.pi * f
    return E * (1 - sum(g / (1 + s * tau) for g, tau in terms))


HERTZ = np.geomspace(0.01, 100.0, 41)
TERMS = [(0.2, 0.5), (0.1, 10.0), (0.05, 0.005)]

ABAQUS = """** a card
*Material, name=RUBBER
*Elastic, moduli=INSTANTANEOUS
3., 0.4995
*VISCO ELASTIC,
 time = prony
0.2, 0.2, 0.5
.1, 1.E-1, 1.D1
5.E-2, 0.05, .005
*TRS, DEFINITION=WLF
296.15, 10., 100.
"""
ANSYS = """/PREP7
mp,ex,1,3.0   ! instantaneous
MP,PRXY,1,0.4995
TB,PRONY,1,1,3,SHEAR
TBTEMP,0
TBDATA,1,0.2,0.5,0.1,10
TBDATA,,.05,5e-3
TB,PRONY,1,1,3,BULK
TBDATA,1,0.2,0.5,0.1,10,0.05,.005
TB,SHIFT,1,1,3,WLF
TBDATA,1,296.15,10.,100.
"""
LSDYNA = f"""*KEYWORD
*MAT_GENERAL_VISCOELASTIC_TITLE
rubber
$#     mid        ro      bulk       pcf        ef      tref         a         b
{3:>10}{1.1e-9:>10.3g}{0:>10}
{0:>10}
{0.65 / 2.999:>10.7f}{0:>10}
{0.2 / 2.999:>10.7f}{2.0:>10.3f}
{0.1 / 2.999:>10.7f}{0.1:>10.3f}
{0.05 / 2.999:>10.7f}{200.0:>10.3f}
*END
"""  # of E = 1: G = E/2(1 + nu)
OPTISTRUCT = """MATVE,7,PRONY,0.2,0.5,0.2,0.5,,,+
+,0.1,10.,.05,5.-3,,,,,+
+,0.1,10.,.05,5.-3
MAT1           7     3.0           .4995
"""
G_0 = 3.0 / (2 * 1.4995)
MSC = (
    "MATVE   7       ISO1\n"
    + "".join(f"        {g * G_0:<8.6f}{tau:<8.4f}\n" for g, tau in TERMS)
    + "MAT1    7       3.0             .4995\n"
)


@pytest.mark.parametrize(
    ("text", "E", "rel"),
    [(ABAQUS, 3e6, 1e-12), (ANSYS, 3e6, 1e-12), (LSDYNA, 1e6, 1e-6), (OPTISTRUCT, 3e6, 1e-12),
     (MSC, 3e6, 1e-6)],
    ids=["abaqus", "ansys", "lsdyna", "optistruct", "msc"],
)  # fmt: skip
def test_a_prony_card_has_its_complex_modulus(text, E, rel):
    fit = import_text(text)
    assert fit.unit == "Pa"
    stiffness = fit.solid.complex_stiffness(omega=2 * np.pi * HERTZ)
    assert stiffness == pytest.approx(young(E, TERMS, HERTZ), rel=rel)


@pytest.mark.parametrize("text", [ABAQUS, ANSYS], ids=["abaqus", "ansys"])
def test_a_shift_card_moves_the_model(text):
    fit = import_text(text)
    assert fit.specimen.temperature == 296.15
    colder = fit.at_temperature(286.15)
    a_t = 10 ** (10.0 * 10.0 / (100.0 - 10.0))
    assert colder.model.tau == pytest.approx([a_t * tau for tau in fit.model.tau])
    assert colder.model.k == fit.model.k


def test_a_relaxed_modulus_is_raised_to_the_instantaneous_one():
    """MODULI=LONG TERM is what Abaqus takes where nothing is said."""
    text = ABAQUS.replace(", moduli=INSTANTANEOUS", "")
    assert import_text(text).model.k_inf == pytest.approx(3e6)
    assert import_text(text).model.k_0 == pytest.approx(3e6 / 0.65)


@pytest.mark.parametrize(
    ("law", "E"),
    [
        ("*HYPERELASTIC, NEO HOOKE, MODULI=INSTANTANEOUS\n0.5, 0.", 3.0),
        ("*HYPERELASTIC, MOONEY-RIVLIN, MODULI=INSTANTANEOUS\n0.4, 0.1, 0.", 3.0),
        ("*HYPERELASTIC, OGDEN, N=2, MODULI=INSTANTANEOUS\n0.7, 2., 0.3, -2., 0., 0.", 3.0),
        ("*HYPERELASTIC, YEOH, MODULI=INSTANTANEOUS\n0.5, -.01, .001, 0., 0., 0.", 3.0),
        ("*HYPERFOAM, N=1, MODULI=INSTANTANEOUS\n0.5, 4., 0.2", 1.2),
    ],
)  # fmt: skip
def test_a_hyperelastic_law_gives_its_modulus_at_no_strain(law, E):
    text = f"*MATERIAL, NAME=A\n{law}\n*VISCOELASTIC, TIME=PRONY\n0.3, 0.3, 1.\n"
    assert import_text(text).model.k_0 == pytest.approx(1e6 * E, rel=1e-3)


@pytest.mark.parametrize("units", list(UNIT_SYSTEMS))
@pytest.mark.parametrize("form", ["table", "viscous-table"])
def test_a_bush_table_of_ours_comes_back(units, form):
    deck = TARGETS["nastran"](
        PAPER, units=units, form=form, frequency_range=(0.5, 30.0), tolerance=1e-3
    )
    fit = import_text(deck, units)
    f = np.geomspace(0.5, 30.0, 31)
    stiffness, exact = (
        solid.complex_stiffness(omega=2 * np.pi * f) for solid in (fit.solid, PAPER)
    )
    error = np.abs(stiffness / exact - 1).max()
    print(f"{form} {units}: {error:.1e}")
    assert error < 1e-3
    assert fit.unit == "N/m"


@pytest.mark.parametrize("units", list(UNIT_SYSTEMS))
def test_a_discrete_network_of_ours_comes_back(units):
    seal = PAPER + GeneralizedMaxwell(0.0, b=0.4)
    fit = import_text(TARGETS["lsdyna"](seal, units=units), units)
    f = np.geomspace(0.001, 100.0, 31)
    stiffness, exact = (solid.complex_stiffness(omega=2 * np.pi * f) for solid in (fit.solid, seal))
    assert stiffness == pytest.approx(exact, rel=2e-5)  # fields of nine columns


@pytest.mark.parametrize(
    ("target", "form", "modulus"), [("abaqus", "prony", 3e6), ("ansys", "prony", 3e6)]
)
def test_relative_moduli_of_ours_come_back(target, form, modulus):
    fit = import_text(TARGETS[target](PAPER, units="SI", form=form), "SI", modulus=modulus)
    scale = modulus / PAPER.k_0
    assert fit.model.k == pytest.approx([scale * k for k in PAPER.k], rel=1e-9)
    assert fit.model.tau == pytest.approx(PAPER.tau, rel=1e-9)


def test_a_bush_of_a_spring_and_a_damper():
    text = "PBUSH   4       K       .2                      3.\n                B       1.-3\n"
    model = import_text(text).model
    assert (model.k_inf, model.b, model.arms) == (pytest.approx(200.0), pytest.approx(1.0), 0)


def test_free_small_and_large_fields_are_one_entry():
    free = "PBUSH,4,K,.25,,,1.5\n,,B,3.-2\n"
    small = "PBUSH   4       K       .25                     1.5\n+               B       3.-2\n"
    entries = [next(parse_bulk_data(text)) for text in (free, small)]
    wanted = ["4", "K", ".25", "", "", "1.5", "", "", "", "B", "3.-2", "", "", "", "", ""]
    assert [fields for _, fields in entries] == [wanted, wanted]
    large = f"{'PBUSH*':<8}{'4':<16}{'K':<16}{'.25':<16}{'':<16}*\n{'*':<8}{'':<16}{'1.5':<16}\n"
    ((name, fields),) = parse_bulk_data(large)
    assert (name, fields[:6]) == ("PBUSH", ["4", "K", ".25", "", "", "1.5"])


def test_numbers_of_fortran_are_read():
    assert [parse_number(word, "") for word in ("1.5+3", "-2.-4", "1.D0", ".5E1", "7")] == [
        1500.0, -2e-4, 1.0, 5.0, 7.0,
    ]  # fmt: skip


# -- refusals --------------------------------------------------------------------------------------

REFUSED = {
    "frequency data": (ABAQUS.replace("time = prony", "frequency=tabular"), "FREQUENCY=tabular"),
    "creep data": (ABAQUS.replace("prony", "creep test data"), "TIME=creep test data"),
    "parameters": (ANSYS.replace("0.2,0.5", "a1,t1"), "'a1' is no number"),
    "pairs": (ANSYS.replace("PRONY,1,1,3,SHEAR", "PRONY,1,1,4,SHEAR"), "says 4 pairs and has 3"),
    "sum": (ABAQUS.replace("0.2, 0.2, 0.5", "0.9, 0.9, 0.5"), "sum to 1.05"),
    "curve": (
        LSDYNA.replace(f"\n{0:>10}\n", f"\n{12:>10}\n", 1), "holds a curve (LCID)",
    ),
    "structural damping": ("PBUSH,4,K,.2\n,,GE,.1\n", "structural damping GE"),
    "logarithmic table": (
        "PBUSH,4,K,.2\nPBUSHT,4,K,9\nTABLED1,9,LOG,LOG,,,,,,+\n+,1.,2.,10.,3.,ENDT\n",
        "axes LOG, LOG",
    ),
    "missing table": ("PBUSH,4,K,.2\nPBUSHT,4,K,9\n", "TABLED1 9 is missing"),
    "other MATVE": ("MATVE,2,BBOYCE,2.0,0.1,-0.7,5.,.01\n", "model BBOYCE, which is not read"),
    "radioss": ("/VISC/PRONY/1\n         1\n", "/VISC/PRONY of Radioss is not read"),
    "nothing": ("*NODE\n1, 0., 0.\n", "no viscoelastic card"),
    "no modulus": (ABAQUS.replace("*Elastic, moduli=INSTANTANEOUS\n3., 0.4995\n", ""), "--modulus"),
    "elastic": ("PBUSH,4,K,.2\n", "is elastic"),
}  # fmt: skip


@pytest.mark.parametrize("case", list(REFUSED))
def test_what_is_not_read_is_refused_by_name(case):
    text, says = REFUSED[case]
    with pytest.raises(ReadError) as caught:
        import_text(text)
    assert says.lower() in str(caught.value).lower()


def test_one_of_several_materials_is_named():
    text = ABAQUS + ABAQUS.replace("RUBBER", "FOAM").replace("3., ", "1., ")
    with pytest.raises(ReadError, match=r"'RUBBER'.*'FOAM'"):
        read_card(text)
    assert read_card(text, name="foam").modulus == 1.0
    with pytest.raises(ReadError, match="no card 'STEEL'"):
        read_card(text, name="STEEL")


def test_a_reference_in_an_unknown_unit_of_temperature_is_not_taken():
    card = read_card(ABAQUS.replace("296.15", "23."))
    assert card.law is None
    assert "ABSOLUTE ZERO" in " ".join(card.notes)
    stated = "*PHYSICAL CONSTANTS, ABSOLUTE ZERO=-273.15\n" + ABAQUS.replace("296.15", "23.")
    assert read_card(stated).law.reference == pytest.approx(296.15)


def test_a_bulk_modulus_that_relaxes_otherwise_is_noted():
    """E of constant Poisson's ratio against 9KG/(3K + G)."""
    text = ABAQUS.replace("0.4995", "0.3").replace("0.2, 0.2, 0.5", "0.5, 0., 0.5")
    (note,) = [note for note in read_card(text).notes if "relax differently" in note]
    G, K = (1 - 0.65) / 2.6, (1 - 0.15) / 1.2
    assert f"{100 * (9 * K * G / (3 * K + G) - 0.35):+.2g} %" in note


# -- what a test could have determined -------------------------------------------------------------


def fisher(model: GeneralizedMaxwell, ramp: float, hold: float) -> np.ndarray:
    """Relative standard deviations of k by numeric derivatives: 4 mN at 200 Hz, 1 s of rest."""
    t = np.concatenate(
        (np.arange(-200, 0) / 200, np.arange(1, round(200 * (ramp + hold)) + 1) / 200)
    )
    vector = np.array([model.k_inf, *model.k, *np.log(model.tau)])

    def force(v: np.ndarray) -> np.ndarray:
        n = model.arms
        up, held = np.clip(t, 0, ramp)[:, None], np.clip(t - ramp, 0, None)[:, None]
        tau = np.exp(v[1 + n :])
        arms = v[1 : 1 + n] * tau * -np.expm1(-up / tau) * np.exp(-held / tau)
        return 8e-3 / ramp * (v[0] * up[:, 0] + arms.sum(axis=1))

    step = 1e-5
    columns = []
    for i in range(len(vector)):
        change = np.zeros(len(vector))
        change[i] = step * (1.0 if i > model.arms else vector[i])
        columns.append((force(vector + change) - force(vector - change)) / (2 * change[i]))
    J = np.column_stack([*columns, np.ones_like(t), t])
    size = np.linalg.norm(J, axis=0)
    covariance = np.linalg.inv((J / size).T @ (J / size)) / np.outer(size, size) * 4e-3**2
    return np.sqrt(np.diag(covariance)[1 : 1 + model.arms]) / model.k


@pytest.mark.parametrize(
    ("tau", "ramp", "percent"),
    [(0.01, 1.0, 269), (0.03, 1.0, 56.3), (0.1, 1.0, 9.9),
     (0.01, 0.05, 13.5), (0.03, 0.05, 3.5), (0.1, 0.05, 2.4),
     (50.0, 1.0, 78), (200.0, 1.0, 781)],
)  # fmt: skip
def test_an_arm_of_a_tenth_has_the_deviation_of_the_bound(tau, ramp, percent):
    arm = GeneralizedMaxwell(0.0, (19.65,), (tau,))
    model = TABLE_1 + arm
    bench = Bench(
        depth=8e-3, ramp_time=ramp, hold_time=40.0, rate=200.0, noise=4e-3, baseline=1.0,
        machine=None,
    )  # fmt: skip
    arms, _ = find_testable_arms(model, bench)
    (result,) = [arm for arm in arms if arm.tau == tau]
    digits = {269: 0.5, 78: 0.5, 781: 0.5}.get(percent, 0.05)
    print(f"{100 * result.k_sd:.4g} %")
    assert 100 * result.k_sd == pytest.approx(percent, abs=digits)
    at = model.tau.index(tau)
    assert result.k_sd == pytest.approx(fisher(model, ramp, 40.0)[at], rel=0.01)
    assert result.is_determined == (percent < 33 and result.tau_sd < 0.5)


def test_a_faster_ramp_widens_the_band():
    model = TABLE_1 + GeneralizedMaxwell(0.0, (19.65,), (0.03,))
    bands = [
        find_testable_arms(model, Bench(ramp_time=ramp, hold_time=40.0, machine=None))[1]
        for ramp in (1.0, 0.05)
    ]
    assert bands[0][1] < bands[1][1]
    assert bands[0][0] == pytest.approx(1 / (2 * np.pi * 40.0), rel=0.2)


# -- the command -----------------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    model = TABLE_1 + GeneralizedMaxwell(0.0, (19.65,), (0.01,))
    Path("seal.k").write_text(TARGETS["lsdyna"](model, units="mm-t-s"))
    Path("rubber.inp").write_text(ABAQUS)
    return tmp_path


TERMS_OF_TEST = ("--ramp", "1s", "--hold", "40s", "--rate", "200Hz", "--noise", "4mN")


def test_import_says_what_a_test_could_tell_and_predict_takes_the_model(folder):
    done = did("import", "seal.k", "--unit-system", "mm-t-s", *TERMS_OF_TEST, "-o", "seal.json")
    assert "not determined" in done.stdout
    assert "269 %" in done.stdout
    fit = json.loads(Path("seal.json").read_text())
    assert fit["schema"].startswith("dashpot/fit@")
    document = run_json("predict", "seal.json", "--mass", "104.0426g", "--seals", 2)
    s = 2j * np.pi * np.array(document["frequency_hz"])[1:]
    model = TABLE_1 + GeneralizedMaxwell(0.0, (19.65,), (0.01,))
    k, tau = np.array(model.k)[:, None], np.array(model.tau)[:, None]
    K = 2 * (model.k_inf + (k * s * tau / (1 + s * tau)).sum(axis=0))
    exact = s**2 / (0.1040426 * s**2 + K)
    value = np.array(document["real"])[1:] + 1j * np.array(document["imag"])[1:]
    assert value == pytest.approx(exact, rel=1e-3)
    assert "no test" in done.stdout


def test_import_as_json_lists_each_arm(folder):
    document = run_json("import", "seal.k", "--unit-system", "mm-t-s", *TERMS_OF_TEST)
    assert document["schema"] == "dashpot/imported@1"
    assert [arm["determined"] for arm in document["arms"]] == [False, True, True]
    assert document["arms"][0]["k_sd"] == pytest.approx(2.69, rel=0.005)


def test_a_card_of_a_material_goes_to_a_part_and_back_to_a_card(folder):
    did("import", "rubber.inp", "--unit-system", "mm-t-s", "-o", "rubber.json")
    did("predict", "rubber.json", "--mass", "100g", "--shape", "disc:20mm,20mm")
    deck = did(
        "export", "rubber.json", "--to", "abaqus", "--form", "prony", "--unit-system", "mm-t-s",
        "--allow", "not_identified",
    ).stdout  # fmt: skip
    assert "*TRS, DEFINITION=WLF" in deck
    Path("again.inp").write_text(deck)
    did(
        "import", "again.inp", "--unit-system", "mm-t-s", "--modulus", "3MPa", "-o", "again.json"
    )  # fmt: skip
    first, again = (json.loads(Path(f"{name}.json").read_text()) for name in ("rubber", "again"))
    assert again["model"]["arms"] == first["model"]["arms"]
    assert again["model"]["k_inf"] == pytest.approx(first["model"]["k_inf"])
    assert again["temperature"]["law"] == first["temperature"]["law"]


def test_an_imported_model_has_a_text_a_page_and_a_figure(folder):
    did("import", "seal.k", "--unit-system", "mm-t-s", "-o", "seal.json")
    fit = dp.read("seal.json")
    text = str(fit)
    assert "no test" in text
    assert "3 Maxwell arms, method card" in text
    assert "residual" not in text
    dp.save(fit, "seal.html")
    assert "no test and no errors stand behind it" in Path("seal.html").read_text()
    fit.plot()
    assert dp.predict(fit, mass="104g", seals=2).modes[0].frequency == pytest.approx(13.3, abs=0.5)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("rubber.inp",), "--unit-system"),
        (("rubber.inp", "--unit-system", "SI", "--relative-noise", "-1"), "relative_noise = -1"),
        (("rubber.inp", "--unit-system", "SI", "--card", "STEEL"), "no card 'STEEL'"),
    ],
)  # fmt: skip
def test_import_names_what_it_needs(folder, words, says):
    done = ran("import", *words)
    assert done.exit_code == 2, done.output
    assert says in done.output


def test_a_network_of_one_material_needs_no_elements():
    (card,) = read_lsdyna_cards("*MAT_SPRING_MAXWELL\n         1       2.0       0.5       4.0\n")
    assert card.spring == GeneralizedMaxwell(0.5, (1.5,), (0.25,))


def test_a_blank_line_of_lsdyna_is_a_card_of_zeros():
    blank = LSDYNA.replace(f"{0:>10}\n", "\n", 1)
    assert blank != LSDYNA
    assert import_text(blank).model == import_text(LSDYNA).model


def test_a_part_of_lsdyna_may_have_a_blank_title():
    deck = dp.export(
        dp.GeneralizedMaxwell(196.5, k=(117.5,), tau=(0.5,)), to="lsdyna", unit_system="mm-t-s"
    )
    lines, title = [], False
    for line in deck.splitlines():
        lines.append("" if title and not line.startswith("$") else line)
        title = (title and line.startswith("$")) or line.startswith("*PART")
    assert lines != deck.splitlines()
    assert import_text("\n".join(lines)).model == import_text(deck).model


ANSYS_IN_PAIRS = """MPTEMP,1,0
MPDATA,EX,1,,3.0, !!!! E0
MPDATA,PRXY,1,,0.4995, !!!! nu0
TB,PRONY,1,1,3,BULK     !!!! pairs
TBTEMP,0
{rows}TB,PRONY,1,1,3,SHEAR
TBTEMP,0
{rows}"""


def test_rows_of_ansys_without_a_number_go_on_where_the_last_ended():
    rows = "".join(f"TBDATA,, {g} , {tau} , \n" for g, tau in TERMS)
    fit = import_text(ANSYS_IN_PAIRS.format(rows=rows))
    stiffness = fit.solid.complex_stiffness(omega=2 * np.pi * HERTZ)
    assert stiffness == pytest.approx(young(3e6, TERMS, HERTZ), rel=1e-12)


def test_matve_that_is_written_is_read():
    model = dp.GeneralizedMaxwell(1.0, k=(0.5, 0.3, 0.2), tau=(0.01, 0.5, 20.0))
    deck = dp.export(model, to="optistruct", form="prony", unit_system="mm-t-s")
    read = import_text(deck + "MAT1,1,2.0,,.4995\n").model
    assert np.array(read.k) / read.k_0 == pytest.approx(np.array(model.k) / 2.0, rel=1e-4)
    assert read.tau == pytest.approx(model.tau, rel=1e-4)


@pytest.mark.parametrize("units", sorted(UNIT_SYSTEMS))
@pytest.mark.parametrize("target", ["abaqus", "calculix", "nastran", "optistruct"])
@pytest.mark.parametrize(
    "model",
    [
        TABLE_1,
        GeneralizedMaxwell(196.5, (117.5,), (0.50213,)),
        GeneralizedMaxwell(196.5, (60.0, 60.0), (0.5, 0.5), b=3.0),
    ],
    ids=["two arms", "one arm", "a dashpot beside equal arms"],
)
def test_deck_of_arms_is_read_back_in_the_units_that_it_states(target, units, model):
    """Springs and dashpots as dashpot writes them, without a word on their units."""
    deck = TARGETS[target](a_fit(model), form="arms", units=units, allow=("all",))
    system = read_stated_units(deck, "deck", None)
    assert system.name == units
    (card,) = read_cards(deck, "deck", system, None)
    result = card.convert_to_model(system, None)
    expected = model.complex_stiffness(frequency=HERTZ)
    np.testing.assert_allclose(result.complex_stiffness(frequency=HERTZ), expected, rtol=1e-8)


def test_units_that_contradict_a_deck_are_refused():
    deck = TARGETS["nastran"](a_fit(TABLE_1), form="arms", units="SI", allow=("all",))
    assert read_stated_units(deck, "deck", "SI").name == "SI"
    with pytest.raises(dp.ExportError, match=r"deck says UNITS: SI, and --unit-system mm-t-s"):
        read_stated_units(deck, "deck", "mm-t-s")
    with pytest.raises(dp.ExportError, match="names no units"):
        read_stated_units(ABAQUS, "deck", None)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("CELAS2,1,2.0,1,1,2,1\nCDAMP2,2,3.0,2,1,3,1\n", "join 3 points"),
        ("SPOINT,7\nCELAS2,1,2.0,1,1,7\nCELAS2,2,2.0,2,1,7\nCDAMP2,3,1.0,1,1,2,1\n", "point 7"),
        ("SPOINT,7,8\nCELAS2,1,2.0,1,1,7\nCELAS2,2,2.0,2,1,8\nCDAMP2,3,1.0,7,,8\n", "neither"),
        (
            "*ELEMENT, TYPE=SPRINGA, ELSET=K\n1, 1, 2\n*SPRING, ELSET=K, NONLINEAR\n0., 0.\n",
            "has a table",
        ),
        (
            "*ELEMENT, TYPE=SPRINGA, ELSET=K\n1, 1, 2\n*ELEMENT, TYPE=DASHPOTA, ELSET=B\n2, 1, 2\n",
            r"its \*SPRING is missing",
        ),
    ],
)
def test_another_network_of_springs_and_dashpots_is_refused(text, message):
    with pytest.raises(ReadError, match=message):
        read_cards(text, "deck", MM_T_S, None)


def test_component_selects_the_springs_of_a_direction():
    rows = [
        f"SPOINT,{7 + c}\nCELAS2,{c}1,{c}.0,1,{c},2,{c}\nCELAS2,{c}2,2.0,1,{c},{7 + c}\n"
        f"CDAMP2,{c}3,1.0,2,{c},{7 + c}\n"
        for c in (1, 3)
    ]
    for component in (1, 3):
        (card,) = read_cards("".join(rows), "deck", MM_T_S, component)
        assert card.spring == GeneralizedMaxwell(float(component), (2.0,), (0.5,))
    with pytest.raises(ReadError, match="join 4 points"):
        read_cards("".join(rows), "deck", MM_T_S, None)


def test_springs_of_a_structure_leave_its_card_as_it_is():
    springs = (
        "*ELEMENT, TYPE=SPRINGA, ELSET=K\n1, 1, 2\n2, 5, 9\n*SPRING, ELSET=K\n\n2.\n"
        "*ELEMENT, TYPE=DASHPOTA, ELSET=B\n3, 1, 7\n*DASHPOT, ELSET=B\n\n1.\n"
    )
    assert read_card(ABAQUS + springs) == read_card(ABAQUS)
    bush = "PBUSH,1,K,200.\n,B,3.\n"
    elements = "CELAS2,1,2.0,1,1,2,1\nCDAMP2,2,3.0,2,1,3,1\n"
    assert read_card(bush + elements) == read_card(bush)


MATERIAL = GeneralizedMaxwell(2e6, (4e5, 1.2e6), (0.02, 0.5))


@pytest.mark.parametrize("units", ["SI", "mm-t-s", "mm-kg-ms", "in-lbf-s"])
@pytest.mark.parametrize("target", ["abaqus", "ansys", "optistruct"])
def test_deck_of_a_material_is_imported_with_the_modulus_of_its_comments(
    target: str, units: str, tmp_path: Path
) -> None:
    fit = a_fit(MATERIAL, unit="Pa")
    deck = TARGETS[target](fit, form="prony", units=units, allow=("all",))
    path = tmp_path / "deck.inp"
    path.write_text(str(deck))
    assert read_stated_modulus(str(deck)) == pytest.approx(MATERIAL.k_0, rel=1e-8)
    did("import", path, "-o", tmp_path / "model.json")
    assert dp.read(tmp_path / "model.json").model.k_0 == pytest.approx(MATERIAL.k_0, rel=1e-8)
    # a part, two decks in one file, and a deck of somebody else state none
    part = TARGETS[target](a_fit(TABLE_1), form="prony", units=units, allow=("all",))
    assert read_stated_modulus(str(part)) is None
    assert read_stated_modulus(f"{deck}\n{deck}") is None
    assert read_stated_modulus(ABAQUS) is None


@pytest.mark.parametrize("target", ["lsdyna", "radioss", "felupe", "comsol"])
def test_material_deck_without_a_shear_modulus_says_which_follow_from_the_fit(target: str) -> None:
    choices: dict[str, Any] = {"form": "prony", "units": "mm-t-s", "allow": ("all",)}
    message = r"modulus of 3\.6 MPa.*1\.2MPa, if in tension"
    with pytest.raises(dp.ExportError, match=message) as result:
        TARGETS[target](a_fit(MATERIAL, unit="Pa"), **choices)
    assert "part" not in str(result.value)
    with pytest.raises(dp.ExportError, match="which the stiffness of a part"):
        TARGETS[target](a_fit(TABLE_1), **choices)
