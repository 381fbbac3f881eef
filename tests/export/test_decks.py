"""Decks: their header, what they refuse, and their format."""

from __future__ import annotations

import csv as comma
import io
import math
import os
import re
from dataclasses import replace
from inspect import signature
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from kit.fits import a_fit, replace_fields
from kit.fractional import SEAL
from kit.levels import a_level_fit

from dashpot.base.checks import Check
from dashpot.base.errors import ExportError, Status
from dashpot.base.provenance import Source
from dashpot.base.version import __version__
from dashpot.datamodel.fit import Fit
from dashpot.datamodel.parameter_estimate import Residual
from dashpot.datamodel.specimen import Specimen
from dashpot.export import FORMS, NEEDS, SUFFIXES, TARGETS, UNIT_SYSTEMS
from dashpot.export import deck as decks
from dashpot.export.deck import CARRIERS
from dashpot.export.unit_systems import format_fixed_width, text
from dashpot.extensions import solver_inputs
from dashpot.extensions.curves.datamodel.dynamic import DynamicTest
from dashpot.extensions.curves.dynamic.fit import fit_dynamic
from dashpot.extensions.systems.door.seal_line import SealLine
from dashpot.registry import SOLVER_INPUTS
from dashpot.solids.maxwell import GeneralizedMaxwell

GOLDEN = Path(__file__).parent / "golden"
SHA = "2c26b46b68ffc68ff99b453c1d30413413422d706483bfa0f98a5e886266e7ae"
SPECIMEN = Specimen(length=0.1, temperature=296.15)
MATERIAL = {"modulus": 1e6, "bulk_modulus": 1e8, "density": 700.0}
# every deck there is: target, form, and what a material card needs besides
DECKS = [
    (target, form, {name: MATERIAL[name] for name in NEEDS[target].get(form, ())})
    for target in TARGETS
    for form in FORMS[target]
]
every_deck = pytest.mark.parametrize(
    ("target", "form", "extra"), DECKS, ids=[f"{target}-{form}" for target, form, _ in DECKS]
)


@pytest.fixture(scope="module")
def fit(paper_seal) -> Fit:
    return a_fit(
        paper_seal,
        residual=Residual(n=41000, sse=1e-3, rms=1.6e-4),
        covariance=np.diag([0.1, 0.2, 0.05, 1e-3, 1e-3]) ** 2,
        dof=1000.0,
        source=(Source(file="seal_8mm.csv", sha256=SHA),),
        specimen=SPECIMEN,
    )


def write(target, solid, **arguments) -> str:
    return TARGETS[target](solid, **{"units": "mm-t-s"} | arguments)


# -- the header ------------------------------------------------------------------------------------


@every_deck
def test_a_deck_says_where_it_comes_from(fit, target, form, extra):
    deck = write(target, fit, form=form, **extra)
    assert "UNITS: mm-t-s: mm, t, s, N, MPa; frequency in Hz" in deck
    assert "temperature: 296.15 K (23 degC)" in deck
    assert "contact length: 100 mm" in deck
    assert f"source: seal_8mm.csv sha256 {SHA}" in deck
    assert "valid band: 0.004 to 0.32 Hz; values outside are EXTRAPOLATED" in deck
    assert "verified" in deck
    assert "SIMULATED" not in deck
    assert "OVERRIDE" not in deck
    assert "dashpot 0." in deck.splitlines()[0]
    assert deck.endswith("\n")
    assert deck.isascii()


@every_deck
def test_deck_of_bare_model_states_missing_information(paper_seal, target, form, extra):
    deck = write(target, paper_seal, form=form, **extra)
    assert "temperature: not stated" in deck
    assert "contact length: not stated" in deck
    assert "valid band: not stated" in deck


@every_deck
def test_simulated_tests_are_stamped(fit, target, form, extra):
    simulated = replace_fields(fit, source=(Source(file="rig.csv", sha256=SHA, simulated=True),))
    assert "SIMULATED" in write(target, simulated, form=form, **extra)


@every_deck
def test_same_input_same_deck(fit, target, form, extra):
    assert write(target, fit, form=form, **extra) == write(target, fit, form=form, **extra)


def test_only_what_a_solver_here_runs_claims_to_be_solver_verified(fit):
    folders = (Path(__file__).parent, Path(__file__).parents[1] / "extensions/solver_inputs")
    here = {
        path.stem.removeprefix("test_") for folder in folders for path in folder.glob("test_*.py")
    }
    for target, form, extra in DECKS:
        deck = write(target, fit, form=form, **extra)
        run = {("nastran", "arms"), ("optistruct", "arms"), ("felupe", "prony")}
        solver = target in {"csv", *here - {"nastran"}} or (target, form) in run
        assert "not solver-verified" in deck or solver, target
    for target in ("calculix", "opensees"):
        assert "not solver-verified" not in write(target, fit)


@pytest.mark.parametrize("sign", ["\n", "\r\n*NODE", "\x00", "é", "\u2028"])
def test_a_file_name_cannot_break_out_of_its_comment(fit, sign):
    odd = replace_fields(fit, source=(Source(file=f"seal{sign}99, 1.csv", sha256=SHA),))
    for target, form, extra in DECKS:
        plain, broken = (write(target, item, form=form, **extra) for item in (fit, odd))
        assert len(plain.splitlines()) == len(broken.splitlines())
        assert broken.isascii()


def test_extrapolated_rows_are_marked(fit):
    wide = replace_fields(fit, band=(2.0, 20.0))
    requested = {"units": "mm-t-s", "frequency_range": (1.0, 100.0)}
    table = TARGETS["nastran"](wide, **requested)
    assert re.search(r"\$ EXTRAPOLATED: \d+ of \d+ rows, from 1 to 100 Hz", table)
    connector = TARGETS["abaqus"](wide, form="connector", **requested).splitlines()
    at = {line: i for i, line in enumerate(connector)}
    assert "** EXTRAPOLATED" in at
    assert "** identified" in at
    rows = list(comma.DictReader(
        line for line in TARGETS["csv"](wide, **requested).splitlines() if line[0] != "#"
    ))  # fmt: skip
    for row in rows:
        inside = 2.0 <= float(row["frequency [Hz]"]) <= 20.0
        assert row["extrapolated"] == str(int(not inside))
    # the ends of the band are rows of their own
    assert {"2.", "20."} <= {row["frequency [Hz]"] for row in rows}


def test_an_arm_outside_the_band_is_marked(fit):
    slow = replace_fields(fit, band=(0.1, 1.0))
    assert "[0.009695 Hz lies outside the valid band]" in write("ansys", slow)


# -- refusals --------------------------------------------------------------------------------------


@every_deck
@pytest.mark.parametrize("missing", ["temperature", "length"])
def test_a_fit_without_its_conditions_is_refused(fit, target, form, extra, missing):
    message = {
        "temperature": "the test temperature is not stated",
        "length": "the contact length is not stated",
    }
    name, sentence = missing, message[missing]
    bare = replace_fields(fit, specimen=replace(SPECIMEN, **{missing: None}))
    with pytest.raises(ExportError, match=sentence) as refused:
        write(target, bare, form=form, **extra)
    assert f"'{name}'" in str(refused.value)
    for allow in ((name,), ("all",)):
        deck = write(target, bare, form=form, allow=allow, **extra)
        assert f"OVERRIDE: {sentence}" in deck
    # what the fit does not know can be stated
    assert "OVERRIDE" not in write(target, bare, form=form, specimen=SPECIMEN, **extra)


DOUBT = Check("arms_supported", False, "an arm cannot be separated from noise.")
"""What makes a verdict other than "use": what is called so is written."""


@every_deck
def test_an_unidentified_fit_is_refused(fit, target, form, extra):
    doubtful = {
        "at the edge of the measured window": {"status": Status.TAU_AT_BOUND},
        "arm 2 has k = 17.8": {"covariance": np.diag([0.1, 0.2, 8.0, 1e-3, 1e-3]) ** 2},
        "arm 1 has tau = 0.5021": {"covariance": np.diag([0.1, 0.2, 0.05, 0.8, 1e-3]) ** 2},
        "arm 1 has k": {"covariance": np.diag([0.1, np.inf, 0.05, 1e-3, 1e-3])},
    }
    for sentence, changes in doubtful.items():
        item = replace_fields(fit, checks=(*fit.checks, DOUBT), **changes)
        with pytest.raises(ExportError, match="do not determine every parameter") as refused:
            write(target, item, form=form, **extra)
        assert sentence in str(refused.value)
        forced = write(target, item, form=form, allow=("not_identified",), **extra)
        assert "OVERRIDE: the data do not determine every parameter" in forced


def test_export_lists_everything_missing_at_once(fit):
    doubtful = {"status": Status.TAU_AT_BOUND, "checks": (*fit.checks, DOUBT)}
    with pytest.raises(ExportError) as refused:
        write("nastran", replace_fields(fit, specimen=Specimen(), **doubtful))
    for words in ("temperature", "contact length", "determine every parameter", "--length 100mm"):
        assert words in str(refused.value)


def test_failed_checks_travel_with_the_deck(fit):
    checks = (Check("hold_long_enough", False, "the hold is short."), Check("fine", True, "good."))
    deck = write("ansys", replace_fields(fit, checks=checks))
    assert "! CHECK FAILED: the hold is short." in deck
    assert "good." not in deck


def test_export_accepts_fewer_arms_than_requested(fit):
    assert write("nastran", replace_fields(fit, status=Status.FEWER_ARMS))


PRONY = [(target, extra) for target, form, extra in DECKS if form == "prony"]


@pytest.mark.parametrize(("target", "extra"), PRONY)
def test_export_refuses_relative_moduli_that_sum_to_one(target, extra):
    fluid = GeneralizedMaxwell(0.0, (2.0, 1.0), (0.1, 10.0))
    with pytest.raises(ExportError, match="the relative moduli sum to 1"):
        write(target, fluid, form="prony", **extra)
    nearly = GeneralizedMaxwell(1e-12, (2.0, 1.0), (0.1, 10.0))
    with pytest.raises(ExportError, match="the relative moduli sum to 1"):
        write(target, nearly, form="prony", **extra)
    assert "OVERRIDE: the relative moduli" in write(
        target, fluid, form="prony", allow=("prony_sum",), **extra
    )


@pytest.mark.parametrize(("target", "extra"), PRONY)
def test_a_prony_series_cannot_hold_a_dashpot(paper_seal, target, extra):
    with pytest.raises(ExportError, match="cannot hold a parallel dashpot"):
        write(target, paper_seal + GeneralizedMaxwell(0.0, b=1.0), form="prony", **extra)


@every_deck
def test_bad_choices(paper_seal, target, form, extra):
    choices = {
        "no unit system is given; add --unit-system, one of SI, mm-t-s, mm-kg-ms, in-lbf-s": {
            "units": None
        },
        "'inch' is no unit system": {"units": "inch"},
        "'everything' is nothing that could be allowed": {"allow": ("everything",)},
        "has no form 'poem'; expected one of": {"form": "poem"},
    }
    for sentence, arguments in choices.items():
        with pytest.raises(ExportError, match=sentence):
            write(target, paper_seal, **{"form": form} | extra | arguments)


@every_deck
def test_nothing_is_nothing_to_write(target, form, extra):
    with pytest.raises(ExportError, match="neither stiffness nor damping"):
        write(target, GeneralizedMaxwell(0.0), form=form, **extra)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda s: TARGETS["radioss"](s, units="SI"), "needs the instantaneous shear modulus"),
        (lambda s: TARGETS["lsdyna"](s, units="SI", form="prony"), "needs the instantaneous shear"),
        (
            lambda s: TARGETS["lsdyna"](s, units="SI", form="prony", modulus=1e6),
            "needs --bulk-modulus, such as 2000MPa, and --density",
        ),
        (lambda s: TARGETS["lsdyna"](s, units="SI", modulus=1e6), "belong to the material card"),
        (
            lambda s: TARGETS["lsdyna"](
                GeneralizedMaxwell(1.0, (1.0,) * 18, tuple(range(1, 19))),
                units="SI", form="prony", **MATERIAL,
            ),
            "holds 18 terms, found 19",
        ),
        (
            lambda s: TARGETS["adams"](GeneralizedMaxwell(0.0, (1.0,), (1.0,)), units="SI"),
            "needs a static stiffness",
        ),
        (lambda s: TARGETS["calculix"](s, units="SI", mass=0.0), "mass = 0.0 kg"),
        (lambda s: TARGETS["calculix"](s, units="SI", frequency_range=(5, 1)), "0 < low < high"),
    ],
)  # fmt: skip
def test_what_single_targets_refuse(paper_seal, call, sentence):
    with pytest.raises(ExportError, match=sentence):
        call(paper_seal)


ARGUMENTS = {
    "frequency_range": ((0.01, 0.3), (0.02, 0.2)), "tolerance": (1e-2, 1e-4), "nominal": (0.1, 0.2),
    "mass": (0.1, 0.2), "modulus": (1e6, 2e6), "bulk_modulus": (1e8, 2e8), "density": (7e2, 9e2),
    "first_tag": (1, 100),
}  # fmt: skip


def written_or_refused(target, fit, form, arguments) -> str:
    try:
        return write(target, fit, form=form, **arguments)
    except ExportError as error:
        return f"refused: {error}"


@every_deck
def test_no_argument_is_taken_that_changes_nothing(fit, target, form, extra):
    parameters = signature(TARGETS[target]).parameters
    for name in ARGUMENTS.keys() & parameters.keys():
        item, other = (
            written_or_refused(target, fit, form, extra | {name: item}) for item in ARGUMENTS[name]
        )
        refused = re.match("refused: .*(leave it out|belong to the material card)", item)
        assert refused or item != other, f"{target}, {form}: {name}"


def test_deck_marks_a_nominal_stiffness_outside_the_band_as_extrapolated(fit):
    for target, form in (("calculix", "springs"), ("nastran", "table")):
        inside, outside = (
            TARGETS[target](
                fit, units="mm-t-s", form=form, nominal=item, frequency_range=(0.01, 0.3)
            )
            for item in ("0.1Hz", "12Hz")
        )
        assert inside.verdict.use == "use"
        assert outside.verdict.use == "use with care"
        assert "at 12 Hz, outside the valid band, and extrapolated" in outside


# -- golden decks ----------------------------------------------------------------------------------


def golden_decks(fit: Fit) -> dict[str, str]:
    decks = {}
    for target, form, extra in DECKS:
        options = dict(extra)
        if "table" in form or form in ("connector", "frequency"):
            options |= {"tolerance": 0.01, "frequency_range": (1.0, 30.0)}
        name = f"{target}-{form}.{SUFFIXES[target]}"
        decks[name] = write(target, fit, form=form, **options)
    decks["calculix-response.inp"] = TARGETS["calculix"](
        fit, units="mm-t-s", mass=0.05202, frequency_range=(1.0, 30.0), points=100
    )
    decks["nastran-line.bdf"] = TARGETS["nastran"](
        fit, units="mm-t-s", tolerance=0.01, frequency_range=(1.0, 30.0),
        line=SealLine([(0, 0, 0), (0.5, 0, 0), (0.5, 0.25, 0)]).stations(0.25),
    )  # fmt: skip
    for name in ("fmu-fmi2.fmu", "fmu-fmi3.fmu"):  # of which each digit counts in this one
        decks[name] = re.sub('(?<=TOKEN ").*(?=")', "{}", decks[name])
    for target in CARRIERS:
        decks[f"{target}-levels.{SUFFIXES[target]}"] = write(target, a_level_fit())
    return decks


NUMBER = re.compile(r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?")


def numbers(text: str) -> list[float]:
    return [float(match) for match in NUMBER.findall(text)]


def words(text: str) -> list[list[str]]:
    """What stands between the numbers of each line."""
    return [NUMBER.sub(" # ", line).split() for line in text.splitlines()]


def test_golden_decks(fit):
    """Set DASHPOT_WRITE_GOLDEN=1 to write them anew, then read the difference before committing."""
    made = golden_decks(fit).items()
    decks = {name: deck.replace(f"dashpot {__version__}:", "dashpot 0.1.0:") for name, deck in made}
    if os.environ.get("DASHPOT_WRITE_GOLDEN"):
        for name, text in decks.items():
            (GOLDEN / name).write_text(text)
    mask = {path.name for path in GOLDEN.iterdir()} - {"bushver.bdf"}
    assert mask == set(decks), "DASHPOT_WRITE_GOLDEN=1 writes them"
    for name, text in decks.items():
        golden = (GOLDEN / name).read_text()
        assert words(text) == words(golden), f"{name} changed"
        # the last digit is the processor's
        assert numbers(text) == pytest.approx(numbers(golden), rel=1e-9, abs=0), f"{name} changed"


# -- the numbers in the other decks ----------------------------------------------------------------

solids = st.builds(
    lambda k_inf, k, tau: GeneralizedMaxwell(
        10.0**k_inf,
        tuple(10.0**value for value in k),
        tuple(10.0**value for value in tau[: len(k)]),
    ),
    st.floats(0, 6),
    st.lists(st.floats(0, 6), min_size=1, max_size=5),
    st.lists(st.floats(-4, 4), min_size=5, max_size=5),
)
OMEGA = np.logspace(-3, 3, 13)


def stiffness(arms, k_inf, b=0.0):
    s = 1j * OMEGA
    return k_inf + b * s + sum(k * s * tau / (1 + s * tau) for k, tau in arms)


@given(solids)
def test_no_number_is_longer_than_calculix_reads(solid):
    """It cuts a number at 20 characters, and with it an exponent."""
    for target, extra in (("calculix", {}), ("calculix", {"mass": np.pi / 60}), ("abaqus", {})):
        for units in UNIT_SYSTEMS:
            deck = TARGETS[target](solid, units=units, **extra)
            cards = [line for line in deck.splitlines() if not line.startswith("*")]
            assert max(len(word.strip()) for card in cards for word in card.split(",")) <= 20


@given(solids)
def test_lsdyna_arms(solid):
    """k(t) = ki + (k0 - ki) exp(-beta t) on each *MAT_SPRING_MAXWELL, fields of ten columns."""
    solid = solid + GeneralizedMaxwell(0.0, b=7.0)
    lines = TARGETS["lsdyna"](solid, units="SI").splitlines()
    cards = {
        keyword: [
            [float(lines[i + 1][a : a + 10]) for a in range(0, len(lines[i + 1]), 10)]
            for i, line in enumerate(lines)
            if line == keyword
        ]
        for keyword in ("*MAT_SPRING_ELASTIC", "*MAT_SPRING_MAXWELL", "*MAT_DAMPER_VISCOUS")
    }
    ((_, k_inf),) = cards["*MAT_SPRING_ELASTIC"]
    ((_, b),) = cards["*MAT_DAMPER_VISCOUS"]
    assert all(card[2] == 0.0 for card in cards["*MAT_SPRING_MAXWELL"])
    arms = [(card[1], 1 / card[3]) for card in cards["*MAT_SPRING_MAXWELL"]]
    assert stiffness(arms, k_inf, b) == pytest.approx(
        solid.complex_stiffness(omega=OMEGA), rel=2e-4
    )
    assert len(arms) == solid.arms


def test_lsdyna_pulls_along_a_vector_that_does_not_turn(paper_seal):
    """As the manual lays it out: IOP 0 and a vector; VID in the fifth field of eight columns."""
    lines = TARGETS["lsdyna"](paper_seal, units="SI").splitlines()
    vector = lines[lines.index("*DEFINE_SD_ORIENTATION") + 2]
    assert [float(vector[i : i + 10]) for i in range(0, 70, 10)] == [1, 0, 1, 0, 0, 0, 0]
    elements = [lines[i + 1] for i, line in enumerate(lines) if line == "*ELEMENT_DISCRETE"]
    assert [int(element[32:40]) for element in elements] == [1] * (1 + paper_seal.arms)


@given(solids)
def test_ansys_arms(solid):
    """Each real constant set is an element; arms are two of them through a node of their own."""
    lines = TARGETS["ansys"](solid, units="SI").splitlines()
    K, C, ends = [], [], []
    for i, line in enumerate(lines):
        if line.startswith("R,"):
            _, k, c = numbers(line[1:])
            K.append(k)
            C.append(c)
            ends.append(tuple(int(n) for n in numbers(lines[i + 2][1:])))
    assert ends[0] == (1, 2)
    arms = []
    for spring, damper in zip(range(1, len(K), 2), range(2, len(K), 2), strict=True):
        assert ends[spring] == (2, ends[damper][0])
        assert ends[damper][1] == 1
        assert C[spring] == K[damper] == 0.0
        arms.append((K[spring], C[damper] / K[spring]))
    assert stiffness(arms, K[0], C[0]) == pytest.approx(
        solid.complex_stiffness(omega=OMEGA), rel=1e-8
    )


@given(solids)
def test_prony_cards_hold_the_same_series(solid):
    if 1 - solid.k_inf / solid.k_0 > 1 - 1e-9:
        solid = solid + GeneralizedMaxwell(solid.k_0)
    rows = TARGETS["abaqus"](solid, units="SI", form="prony").splitlines()
    rows = rows[rows.index("*VISCOELASTIC, TIME=PRONY") + 1 :]
    abaqus = [tuple(numbers(row)) for row in rows]
    assert all(g == k for g, k, _ in abaqus)
    ansys = [
        value
        for line in TARGETS["ansys"](solid, units="SI", form="prony").splitlines()
        if line.startswith("TBDATA")
        for value in numbers(line[7:])[1:]
    ]
    assert np.array(ansys).reshape(-1, 2).tolist() == [[g, tau] for g, _, tau in abaqus]
    radioss = TARGETS["radioss"](solid, units="SI", modulus=1.0).splitlines()
    start = radioss.index("#                G_i              beta_i") + 1
    pairs = [(float(row[:20]), 1 / float(row[20:40])) for row in radioss[start:]]
    for result in ([(g, tau) for g, _, tau in abaqus], pairs):
        rebuilt = stiffness(result, 1 - sum(g for g, _ in result))
        assert rebuilt == pytest.approx(
            solid.complex_stiffness(omega=OMEGA) / solid.k_0, rel=1e-6, abs=1e-9
        )


def test_table_1_as_a_prony_series(paper_seal):
    """g = 0.354129, 0.053647; beta = 1.991525, 0.0609172 1/s."""
    deck = TARGETS["abaqus"](paper_seal, units="mm-t-s", form="prony")
    assert "\n0.354128993" in deck
    assert "\n0.053646775" in deck
    maxwell = TARGETS["lsdyna"](paper_seal, units="mm-t-s")
    assert "1.9915254" in maxwell
    assert ".06091718" in maxwell


@given(solids)
def test_transfer_function(solid):
    deck = TARGETS["adams"](solid, units="SI")
    parts = re.split(r"^\[(\w+)\].*$", deck, flags=re.MULTILINE)
    block = {name: numbers(body) for name, body in zip(parts[1::2], parts[2::2], strict=True)}
    s = 1j * OMEGA
    times = np.prod([1 + t * s for t in block["NUMERATOR_TIMES"]], axis=0) / np.prod(
        [1 + t * s for t in block["DENOMINATOR_TIMES"]], axis=0
    )
    coefficients = np.polyval(block["NUMERATOR_COEFFICIENTS"][::-1], s) / np.polyval(
        block["DENOMINATOR_COEFFICIENTS"][::-1], s
    )
    expected = solid.complex_stiffness(omega=OMEGA) / solid.k_inf
    assert times == pytest.approx(expected, rel=1e-7)
    assert coefficients == pytest.approx(expected, rel=1e-6)


@given(solids)
def test_state_space(solid):
    """C (j omega I - A)^-1 B + D + j omega E is the complex stiffness."""
    solid = solid + GeneralizedMaxwell(0.0, b=2.0)
    rows = {
        line[0]: np.array(numbers(line[1:]))
        for line in TARGETS["statespace"](solid, units="SI").splitlines()
        if line[1:3] == " ="
    }
    s = 1j * OMEGA[:, None]
    K = (-rows["C"] * rows["B"] / (s + rows["A"])).sum(axis=1) + rows["D"] + 1j * OMEGA * rows["E"]
    assert pytest.approx(solid.complex_stiffness(omega=OMEGA), rel=1e-7, abs=1e-9 * solid.k_0) == K


@pytest.mark.parametrize("units", list(UNIT_SYSTEMS))
def test_comma_separated_values(paper_seal, units):
    system = UNIT_SYSTEMS[units]
    lines = TARGETS["csv"](paper_seal, units=units).splitlines()
    assert not any(line[0] in "=+-@" for line in lines)
    text = "\n".join(line for line in lines if not line.startswith("#"))
    for row in list(comma.reader(io.StringIO(text)))[1:]:
        f, storage, loss, eta, b = (float(value) for value in row[:5])
        K = complex(paper_seal.complex_stiffness(omega=2 * np.pi * f / system.time))
        assert storage == pytest.approx(system.stiffness(K.real), rel=1e-8)
        assert loss == pytest.approx(system.stiffness(K.imag), rel=1e-8)
        assert eta == pytest.approx(K.imag / K.real, rel=1e-8)
        assert 2 * np.pi * f * b == pytest.approx(loss, rel=1e-8)


def test_units_are_consistent():
    """Newton's law holds in every system: force = mass x length / time^2, for 1 kg, 1 m, 1 s."""
    for system in UNIT_SYSTEMS.values():
        length, mass, time = 1 / system.length, 1 / system.mass, 1 / system.time
        assert mass * length / time**2 == pytest.approx(1 / system.force)
        # a resonance keeps its frequency: sqrt(k/m) in units of 1/time
        omega = np.sqrt(system.stiffness(331.8) / (0.104 * mass))
        assert omega / system.time == pytest.approx(np.sqrt(331.8 / 0.104))
        zeta = system.damping(3.0) / (2 * np.sqrt(system.stiffness(331.8) * 0.104 * mass))
        assert zeta == pytest.approx(3.0 / (2 * np.sqrt(331.8 * 0.104)))


def test_connector_rows_read_back(paper_seal):
    lines = TARGETS["abaqus"](paper_seal, units="mm-t-s", form="connector").splitlines()
    start = lines.index("*CONNECTOR ELASTICITY, COMPONENT=1")
    middle = lines.index("*CONNECTOR DAMPING, COMPONENT=1, TYPE=STRUCTURAL")
    K = np.array([numbers(line) for line in lines[start + 1 : middle]])
    eta = np.array([numbers(line) for line in lines[middle + 1 :]])
    assert K[:, 1].tolist() == eta[:, 1].tolist()
    exact = paper_seal.complex_stiffness(omega=2 * np.pi * K[:, 1]) / 1e3
    assert K[:, 0] * (1 + 1j * eta[:, 0]) == pytest.approx(exact, rel=1e-8)


def test_every_deck_is_listed_in_the_export_page():
    page = (Path(__file__).parents[2] / "docs" / "export.md").read_text(encoding="utf-8")
    for target, form, _ in DECKS:
        assert re.search(rf"^\| `{target}` .*`{form}`", page, flags=re.MULTILINE), (target, form)
    tests = set(re.findall(r"`(tests/\S+?\.py)`", page))
    assert tests
    for test in tests:
        assert (Path(__file__).parents[2] / test).is_file(), test


def test_every_file_of_a_deck_is_offered():
    folders = (Path(decks.__file__).with_name("decks"), Path(solver_inputs.__file__).parent)
    files = {path.stem for folder in folders for path in folder.glob("*.py")}
    assert (
        files - {"__init__", "registration", "unsupported_solvers"}
        == set(SOLVER_INPUTS)
        == set(TARGETS)
    )


def test_forms_and_targets_are_the_same_list():
    assert set(FORMS) == set(TARGETS)


def test_a_material_goes_into_material_cards_only():
    omega = 2 * np.pi * np.geomspace(0.01, 10, 40)
    rubber = GeneralizedMaxwell(1e6, (5e5,), (0.1,))
    K = rubber.complex_stiffness(omega=omega)
    fit = fit_dynamic(DynamicTest(omega / (2 * np.pi), K.real, K.imag, units="SI"), arms=1)
    assert fit.unit == "Pa"
    with pytest.raises(ExportError, match=r"are in N/m; nastran has no material card"):
        TARGETS["nastran"](fit, units="SI", allow=("all",))
    with pytest.raises(ExportError, match=r"springs and dashpots are in N/m.*--form prony"):
        TARGETS["ansys"](fit, units="SI", allow=("all",), form="arms")
    assert "TB,PRONY" in TARGETS["ansys"](fit, units="SI", allow=("all",), form="prony")


@every_deck
def test_a_solid_that_is_no_sum_of_arms_is_written_by_the_arms_that_stand_for_it(
    target, form, extra
):
    for solid in (SEAL, a_fit(SEAL, specimen=SPECIMEN)):
        full = {("lsdyna", "prony"): "holds 18 terms, found 46",
                ("optistruct", "prony"): "holds 5 terms, and the model has 45 arms"}  # fmt: skip
        if (target, form) in full:
            with pytest.raises(ExportError, match=full[target, form]):
                write(target, solid, form=form, **extra)
            continue
        deck = write(target, solid, form=form, **extra)
        assert "arm 45: k =" in deck
        assert "the arms approximate a FractionalZener" in deck


def test_a_table_is_of_the_solid_itself_not_of_its_arms():
    rows = [row for row in TARGETS["csv"](SEAL, units="SI").splitlines() if row[0].isdigit()]
    f, storage, loss = np.array([numbers(row)[:3] for row in rows]).T
    exact = SEAL.complex_stiffness(omega=2 * np.pi * f)
    assert storage + 1j * loss == pytest.approx(exact, rel=1e-9)
    assert np.abs(SEAL.maxwell.complex_stiffness(omega=2 * np.pi * f) / exact - 1).max() > 1e-6


@every_deck
@pytest.mark.parametrize("size", [1e31, 9e-31])
def test_numbers_that_no_seal_has_are_refused(target, form, extra, size):
    for solid in (
        GeneralizedMaxwell(size, (1.0,), (1.0,)),
        GeneralizedMaxwell(1.0, (size,), (1.0,)),
        GeneralizedMaxwell(1.0, (1.0,), (size,)),
    ):
        with pytest.raises(ExportError, match="a deck holds 0 or numbers from 1e-30"):
            TARGETS[target](solid, units="SI", form=form, **extra)


@pytest.mark.parametrize("value", [math.inf, -math.inf, math.nan])
def test_no_deck_prints_what_is_no_number(value):
    for printed in (text, lambda number: format_fixed_width(number, 16)):
        with pytest.raises(ExportError, match="expected a finite one"):
            printed(value)
