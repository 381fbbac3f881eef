"""Every number is the same in text, document, page, app, table and lot.

A face is read as its reader reads it: what is printed is taken apart, brought to SI from the unit
that stands beside it, and held to the number itself by the digits that stand there.
"""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from kit import handmade
from kit.lots import draw_rows, lot_of
from kit.shell import ran

from dashpot import workflow
from dashpot.base.units import find_unit
from dashpot.datamodel.fit import list_arm_values, list_model_values
from dashpot.extensions.amplitude import page as level
from dashpot.extensions.amplitude import text as amplitude_text
from dashpot.extensions.amplitude.fit_files import level_files
from dashpot.extensions.app import view_models
from dashpot.extensions.batch import page
from dashpot.extensions.batch import table_row as row
from dashpot.extensions.batch.limits import read_limits
from dashpot.extensions.batch.quantities import parse_column_title
from dashpot.extensions.batch.summary import summary
from dashpot.extensions.materials.cld.fit_files import cld_files
from dashpot.extensions.materials.hyperelastic.fit_files import hyperelastic_files
from dashpot.extensions.materials.indentation import text as indentation_text
from dashpot.extensions.materials.indentation.fit_files import indent_file
from dashpot.extensions.materials.indentation.indenter import Indenter
from dashpot.extensions.materials.indentation.lot_row import build_lot_row as indentation_row
from dashpot.extensions.modes.measured_modes import modes_files
from dashpot.extensions.modes.page import list_mode_facts
from dashpot.extensions.systems.door.analyse_file import door_file
from dashpot.reading.read_options import ReadOptions
from dashpot.registry import LotSpecimen
from dashpot.report import tables
from dashpot.report.first_screen import rows as answer_rows
from dashpot.report.result_page import kind_page
from dashpot.text_output import results
from dashpot.text_output.layout import format_values
from dashpot.workflow.dataframes import frame
from dashpot.workflow.json_archive import to_document
from dashpot.workflow.recommended_solid import recommend_solid

ARMS = ("seal_8mm.csv",)
TESTS = {
    "arms": (ARMS, {}),
    "fractional": (ARMS, {"family": "fractional"}),
    "quick": (ARMS, {"intervals": False, "arms": 2}),
    "material": (("sweep.csv",), {}),
    "modulus": (("curve.csv",), {"options": ReadOptions(modulus="E(t)")}),
    "creep": (("compliance.csv",), {}),
    "spectrum": (("sweeps.csv",), {}),
    "temperatures": (("at_23degC.csv", "at_10degC.csv", "at_0degC.csv"), {}),
}


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    """A folder with the files to learn on, a compliance and a sweep of strain."""
    folder = tmp_path_factory.mktemp("bench")
    assert ran("demo", "--files", "--all", "-o", folder).exit_code == 0
    draw = np.random.default_rng(1).standard_normal
    strain = np.geomspace(0.01, 20, 25)
    softer = 1 / (1 + (strain / 1.2) ** 1.2)
    stored, lost = 1.2 + 0.9 * softer, 0.12 + 0.5 * softer * (1 - softer)
    noise = 1 + 0.003 * draw((2, 25))
    write(
        folder / "strain.csv", "frequency [Hz],strain [%],storage modulus [MPa],loss modulus [MPa]",
        np.full(25, 10.0), strain, stored * noise[0], lost * noise[1],
    )  # fmt: skip
    t = np.geomspace(0.01, 1e3, 60)
    crept = 0.25 + 0.15 * (1 - np.exp(-t / 0.8)) + 0.1 * (1 - np.exp(-t / 60))
    crept *= 1 + 0.002 * draw(60)
    write(folder / "compliance.csv", "time [s],creep compliance [1/MPa]", t, crept)
    return folder


def write(path, head, *columns):
    rows = (",".join(f"{value:.8g}" for value in row) for row in zip(*columns, strict=True))
    path.write_text("\n".join((head, *rows, "")), encoding="utf-8")


@pytest.fixture(scope="module")
def fits(bench):
    return {
        name: workflow.fit_files(tuple(str(bench / file) for file in files), **how)[0]
        for name, (files, how) in TESTS.items()
    }


@pytest.fixture(params=TESTS)
def fit(request, fits):
    return fits[request.param]


# -- what is printed, as a reader takes it -------------------------------------------------------

DIGITS = str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789")


def number(printed):
    """The number in a cell, and half of what its last digit stands for."""
    text = re.sub(r"·10(.+)", r"e\1", printed.partition(" ")[0].partition(",")[0])
    text = text.translate(DIGITS)
    mantissa, _, power = text.partition("e")
    # a whole number is rounded where its zeros begin
    zeros = len(mantissa) - len(mantissa.rstrip("0")) if mantissa.isdecimal() else 0
    last = zeros - len(mantissa.partition(".")[2]) + int(power or 0)
    return float(text), 0.5000001 * 10.0**last


def same(fact, printed, unit, value=None):
    """Whether a cell, in a unit, is this fact to its last digit."""
    shown, half = number(printed)
    word = unit.replace(" ", "*").replace("·", "*")
    stated = find_unit(word) if word not in {"", "–"} else None
    factor = 1.0 if stated is None else stated.factor
    expected = fact.value if value is None else value
    if math.isinf(expected):
        return False
    return abs(shown * factor - expected) <= max(half * factor, 1e-12 * abs(expected))


def table(lines):
    """The cells of the rows of a table of the terminal, by their names."""
    result = {}
    for line in lines:
        name, *cells = re.split(r" {2,}", line.strip())
        result.setdefault(name, cells)
    return result


def require_shown(facts_, rows, *, value=0, unit=-1, name=lambda fact: fact.label):
    for fact in facts_:
        assert name(fact) in rows, f"{fact.name} is missing"
        cells = rows[name(fact)]
        assert same(fact, cells[value], cells[unit] if fact.unit else ""), (fact, cells)


# -- a fit, of each family -----------------------------------------------------------------------


def test_a_fit_tells_every_parameter_and_the_end_of_its_hold(fit):
    names = [fact.name for fact in list_model_values(fit)]
    assert len(set(names)) == len(names)
    assert ("k_end" in names) == (fit.evidence.end_of_hold is not None)
    if fit.family == "fractional":
        assert names[-4:] == ["k_inf", "k_0", "tau", "alpha"]
    elif fit.estimate.parameters:
        assert {name for name in fit.estimate.parameters if name[:2] != "ln"} <= set(names)
        assert sum(name[:2] == "b_" for name in names) == fit.model.arms
    else:
        assert names[-4:] == ["k_inf", "k_0", "tau from", "tau to"]


def format_for_terminal(fit):
    """What `-v` prints of a fit, every parameter first."""
    message = results.render_fit(fit)
    return table([*message.details, *message.lines])


def test_the_text_has_every_fact(fit):
    require_shown(list_model_values(fit), format_for_terminal(fit))


def test_text_row_of_an_arm_equals_its_reported_values(fit):
    rows, expected = (
        table(results.render_fit(fit).lines),
        {fact.name: fact for fact in list_model_values(fit)},
    )
    for j in range(1, fit.model.arms + 1):
        arm = [expected.get(f"{name}_{j}") for name in ("k", "tau", "b")]
        if all(arm):
            values = [fact.cells.ascii.value for fact in arm if fact.cells.ascii.value]
            assert [cell for cell in rows[str(j)] if cell in values] == values


def test_the_page_has_every_fact(fit):
    rows = {name: cells for name, *cells in tables.coefficients(fit, None).rows}
    require_shown(list_model_values(fit), rows, name=lambda fact: fact.symbol)


def test_page_and_terminal_print_the_same_cells(fit):
    terminal = format_for_terminal(fit)
    for (_, value, between, unit), fact in zip(
        tables.coefficients(fit, None).rows, list_model_values(fit), strict=True
    ):
        cells = terminal[fact.label]
        assert fact.cells.ascii.value == cells[0]
        assert value.startswith(fact.cells.value)
        assert between == fact.cells.interval
        assert unit == fact.cells.unit


def test_the_app_has_every_fact_but_the_dashpots_of_arms(fit):
    """b = k tau says of an arm what k and tau say."""
    shown = [fact for fact in list_model_values(fit) if fact.name[:2] != "b_"]
    rows = {term.name: (term.value, term.unit) for term in view_models.make_terms(fit)}
    assert len(rows) == len(shown)
    require_shown(shown, rows, name=lambda fact: fact.symbol)
    neighbour = {
        name: (value, unit) for name, value, _, unit in view_models.make_parameter_rows(fit, None)
    }
    require_shown([item for item in shown if item.name not in {"b", "k_end"}], neighbour,
         name=lambda fact: fact.symbol)  # fmt: skip


def test_the_document_has_every_fact_in_si(fit):
    whole = to_document(fit)
    solid = whole["model"] if fit.family == "maxwell" else whole["solid"]
    error, between = whole["standard_error"], whole["interval_95"]
    if fit.family != "maxwell":
        error, between = solid["standard_error"], solid["interval_95"]
    for fact in fit.facts:
        kind, _, place = fact.name.partition("_")
        if place.isdecimal() and fit.family == "maxwell":
            j = int(place) - 1
            there = solid["arms"][j][kind], error["arms"][j][kind], between[kind][j]
        elif fact.name == "b":
            assert solid["b"] == fact.value
            continue
        else:
            there = solid[fact.name], error[fact.name], between[fact.name]
        low = 0.0 if fact.is_at_most else fact.low  # an end that the data leave open
        ends = [value if math.isfinite(value) else None for value in (low, fact.high)]
        expected = fact.error is not None and math.isfinite(fact.error)
        size = fact.error if expected else None
        assert there == (fact.value, size, ends), fact
    for fact in list_model_values(fit):
        if fact.name == "k_end":
            assert tuple(whole["end_of_hold_limits"]["k_end"]) == (fact.low, fact.high)
    assert whole["unit"] == list_model_values(fit)[0].unit


def test_the_frame_has_every_fact_but_dashpots(fit):
    rows = frame(fit).columns
    cellss = {
        name: cells
        for name, *cells in zip(
            *(rows[key] for key in ("parameter", "value", "standard_error", "low", "high", "unit")),
            strict=True,
        )
    }
    shown = [fact for fact in fit.facts if fact.name[0] != "b"]
    assert len(cellss) == len(shown)
    for quantity in shown:
        error = math.nan if quantity.error is None else quantity.error
        *numbers, unit = cellss[quantity.name]
        np.testing.assert_array_equal(numbers, (quantity.value, error, quantity.low, quantity.high))
        assert unit == quantity.unit


def test_batch_row_has_every_value_of_the_arms(fit):
    arms = fit.model.arms
    row_of = row._build_fit_columns(fit, 40.0, arms) | row._build_uncertainty_columns(fit, arms)
    for value in list_arm_values(fit):
        if value.name[0] == "b":
            continue
        column = row._get_column_name(value)
        name, unit = parse_column_title(column)
        assert unit == value.unit
        assert name.replace("E_", "k_") == value.name
        assert row_of[column] == value.value
        assert row_of[row._get_column_name(value, "_se")] == value.error
    letter = "k" if fit.unit == "N/m" else "E"
    ending = "N_per_m" if fit.unit == "N/m" else "Pa"
    assert row_of[f"{letter}_end_{ending}"] == pytest.approx(float(fit.model.relaxation(40.0)))
    assert row_of[f"{letter}_0_{ending}"] == fit.model.k_0


def test_nuisance_parameters_are_equal_in_text_and_tables(fits, bench):
    for fit in fits.values():
        if not fit.estimate.nuisance:
            continue
        text = results.render_fit(fit)
        (line,) = [item for item in (*text.lines, *text.details) if "  also fitted " in item]
        message = [term.fact for term in fit.estimate.nuisance]
        element = ", ".join(f"{fact.label} {fact.cells.ascii.with_unit}" for fact in message)
        assert re.sub(r" +also fitted +", "", line) == element
        for fact, (name, value, unit) in zip(message, tables.nuisances(fit).rows, strict=True):
            assert (name, value) == (fact.symbol, fact.cells.with_error)
            assert same(fact, value, unit)
    assert any(fit.estimate.nuisance for fit in fits.values())


def test_compliances_and_shifts_are_equal_in_text_and_values(fits):
    creep = fits["creep"]
    (line,) = [line for line in results.render_fit(creep).lines if line.startswith("  creep ")]
    for fact in creep.evidence.creep.list_values("1/Pa"):
        assert fact.cells.ascii.with_unit in line
        assert same(fact, fact.cells.value, fact.cells.unit)
    temperatures = fits["temperatures"].temperatures
    lines = results.render_fit(fits["temperatures"]).lines
    (law,) = [line for line in lines if line.startswith("  law ")]
    assert all(
        f"{constant.label} {constant.cells.ascii.with_unit}" in law
        for constant in temperatures.constants
    )
    rows = table(lines)
    for shift in temperatures.shifts:
        along, across = shift.facts
        cells = rows[f"{shift.temperature - 273.15:.4g} degC"]
        assert same(along, cells[0], "")
        assert same(across, cells[-1], "")


# -- the other kinds -----------------------------------------------------------------------------


def test_a_contact_says_the_same_in_text_document_and_lot(bench):
    indenter = Indenter(mass=0.005, radius=0.005)
    ball = indent_file(bench / "hit.csv", indenter=indenter)
    plain = ball.to_dict()
    require_shown(ball.reported_values, table(indentation_text.indentation(ball).lines))
    piece = LotSpecimen(ReadOptions(), mass=indenter.mass, radius=indenter.radius)
    _, row_of = indentation_row(bench / "hit.csv", piece)
    modulus = ball["modulus"]
    assert row_of["indent_depth_m"] == ball["depth"].value
    assert row_of["restitution"] == ball["restitution"].value
    ends = {"": modulus.value, "_low": modulus.low, "_high": modulus.high}
    for end, value in ends.items():
        assert row_of[f"indent_modulus{end}_Pa"] == value
    for fact in ball.reported_values:
        assert plain[fact.name] == fact.value
        assert plain["intervals"][fact.name] == [fact.low, fact.high]
        assert plain["units"][fact.name] == fact.unit


def test_a_law_of_rubber_says_the_same_in_text_and_document(bench):
    hyperelastic_fit = hyperelastic_files(
        {"uniaxial": [str(bench / "tension.csv")], "biaxial": [str(bench / "biaxial.csv")]}
    )
    require_shown(
        hyperelastic_fit.reported_values, table(format_values(hyperelastic_fit.reported_values))
    )
    retained = {value["name"]: value for value in to_document(hyperelastic_fit)["values"]}
    for fact in hyperelastic_fit.reported_values:
        assert retained[fact.name] == {
            key: getattr(fact, key) for key in ("name", "value", "low", "high", "unit")
        }


SHAKEN = {"levels": (0.02, 0.5), "mass": 0.1148, "seals": 2.0, "at": (0.1,)}


@pytest.mark.parametrize(
    ("files", "requested"),
    [
        (("strain.csv",), {}),
        (("hammer.csv",), {}),
        (("loops.csv",), {}),
        (("shaker_20mN.csv", "shaker_500mN.csv"), SHAKEN),
    ],
)
def test_levels_say_the_same_on_page_and_in_app(bench, files, requested):
    amplitude_result = level_files([str(bench / file) for file in files], **requested)
    numbers = level.list_level_values(amplitude_result)
    assert numbers
    (shown,) = kind_page(amplitude_result).groups
    rows = {quantity.name: (quantity.value, quantity.unit) for quantity in shown.rows}
    app = {
        quantity.name: (quantity.value, quantity.unit)
        for quantity in map(view_models.make_term, numbers)
    }
    require_shown(numbers, rows, name=lambda fact: fact.symbol)
    require_shown(numbers, app, name=lambda fact: fact.symbol)


def test_a_peak_at_a_level_says_the_same_in_text_and_page(bench):
    amplitude_result = level_files([str(bench / "hammer.csv")], at=(0.05,))
    values = {item.name: item for item in level.list_level_values(amplitude_result)}
    rows = table(amplitude_text.render_levels(amplitude_result).lines)
    for (peak, motion), element in zip(
        (item.facts for item in amplitude_result.peaks), amplitude_result.peaks, strict=True
    ):
        cells = rows[f"{element.level:.4g}"]
        assert same(peak, cells[0], "Hz")
        assert same(motion, cells[2], "mm/N")
        assert (peak, motion) == (values[peak.name], values[motion.name])


def test_modes_say_the_same_in_text_and_app(bench):
    made = ran("fit", bench / "hammer.csv", "-o", bench / "frf.csv")
    line = next(line for line in made.output.splitlines() if line.startswith("  mode "))
    result, _ = modes_files([str(bench / "frf.csv")], band=(5.0, 40.0))
    assert result.modes
    text = ran("fit", bench / "frf.csv", "--band", "5:40Hz").output
    facts = list_mode_facts([("1", result.modes[0].mode)])
    app = {item.name: item for item in map(view_models.make_term, facts)}
    frequency, ratio, residue = result.modes[0].mode.facts
    assert "Hz, damping ratio" in line
    for fact, name in ((frequency, "f, 1"), (ratio, "ζ, 1")):
        assert fact.cells.ascii.with_error in text
        assert same(fact, app[name].value, app[name].unit)
        assert same(fact, fact.cells.value, fact.cells.unit)
    assert residue.cells.ascii.with_error in text


def test_the_answers_of_a_study_are_its_numbers():
    study = handmade.study()
    recommendation = recommend_solid(study)
    every = (*recommendation.mass_values, *recommendation.seal_values)
    assert every
    for quantity, printed in zip(every, answer_rows(every), strict=True):
        assert same(quantity.fact, printed.value, printed.unit)
        for end, cell in ((quantity.low, printed.low), (quantity.high, printed.high)):
            if math.isfinite(end):
                assert same(quantity.fact, cell, printed.unit, end)
        if quantity.measured_fact is not None:
            assert same(quantity.measured_fact, printed.measured, printed.unit)


# -- a lot ---------------------------------------------------------------------------------------


def test_the_page_and_the_shell_of_a_lot_print_the_same_numbers(tmp_path):
    lot = lot_of(draw_rows(3, 6, 4, operators=("A", "B")))
    path = tmp_path / "limits.toml"
    path.write_text('[k_end]\nlower = "170 N/m"\nupper = "230 N/m"\n')
    limits = read_limits(path, lot.table.columns)
    result = summary(lot, limits=limits)
    shell = "\n".join(result.lines)
    text = unescape(re.sub(r"<[^>]+>", " ", page.html(lot, lot_summary=result)))
    message = result.main.gauge.summary
    assert message in text
    assert message in shell
    ndc = int(re.search(r"ndc (\d+)", message)[1])
    assert ndc == math.floor(result.main.gauge.categories)
    for able in result.main.capabilities.values():
        cpk, low, high = able.cells
        assert f"Cpk {cpk} ({low} to {high})" in shell
        assert re.search(rf"{cpk}\s+{low}\s+{high}", text)
    for fact, share in result.main.sources:
        value, low, high = fact.cell_texts
        assert re.search(rf"{share}\s+{value}\s+{low}\s+{high}", text), fact
        assert f"{value} ({low} to {high}), {share} %" in shell
        assert same(fact, value, result.main.quantity.unit)


# -- the frame of what is no solid ---------------------------------------------------------------

#: result -> how it is found, and a number of it: where the frame has it, and where the document
FRAMED = {
    "rubber": (
        lambda at: hyperelastic_files({"uniaxial": [at("tension.csv")]}),
        lambda rows: rows["value"][rows["parameter"].index("shear_modulus")],
        lambda message: next(
            value["value"] for value in message["values"] if value["name"] == "shear_modulus"
        ),
    ),
    "door": (
        lambda at: door_file(at("door.toml")),
        lambda rows: rows["frequency"][0],
        lambda message: message["modes"][0]["frequency_hz"],
    ),
    "loops": (
        lambda at: level_files([at("loops.csv")]),
        lambda rows: rows["value"][rows["parameter"].index("lost")],
        lambda message: message["lost"],
    ),
    "levels": (
        lambda at: level_files(
            [at("shaker_20mN.csv"), at("shaker_500mN.csv")], levels=[0.02, 0.5], mass=0.1148
        ),
        lambda rows: rows["k"][rows["element"].index("k_inf")],
        lambda message: message["model"]["k_inf"],
    ),
    "pieces": (
        lambda at: cld_files([at("cld_1.csv"), at("cld_2.csv")]),
        lambda rows: rows["loading"][1],
        lambda message: message["specimens"][1]["nominal"]["loading"],
    ),
}


@pytest.mark.parametrize("name", FRAMED)
def test_the_frame_says_the_same_as_the_document(bench, name):
    find_it, of_frame, of_document = FRAMED[name]
    if name == "door":
        workflow.fit_files((str(bench / "seal_8mm.csv"),))[0].save(bench / "fit.json")
    it = find_it(lambda file: str(bench / file))
    rows, document = frame(it), json.loads(json.dumps(it.to_dict()))
    assert len({len(column) for column in rows.columns.values()}) == 1
    assert set(rows.units) == set(rows.columns)
    assert of_frame(rows.columns) == of_document(document)


@pytest.mark.parametrize(("error", "shown"), [(0.26, True), (0.011, False)])
def test_text_of_a_joint_fit_states_what_cables_leave_open(error: float, shown: bool) -> None:
    folder = Path(__file__).parent / "data" / "documents_1"
    fit = workflow.read_fit(folder / "fit-joint.json")
    described = [
        replace(
            check,
            value=error,
            passed=True,
            message=f"Cables leave the loss factor at 12.7 Hz known to ±{100 * error:.2g} %.",
        )
        for check in fit.checks
        if check.name == "cables_described"
    ]
    others = [check for check in fit.checks if check.name != "cables_described"]
    assert described
    evidence = replace(fit.evidence, checks=(*others, *described))
    text = str(replace(fit, evidence=evidence))
    assert ("Cables leave the loss factor at 12.7 Hz known to ±26 %" in text) is shown
    assert ("cable=0 of the machine" in text) is shown
