"""Summary of a lot: limits and guard band, outliers, workbook; hostile lots."""

import json
import math
from io import BytesIO

import numpy as np
import openpyxl
import pytest
from kit.lots import draw_rows, lot_of
from kit.shell import ran

from dashpot.base.errors import ReadError
from dashpot.base.version import is_ours
from dashpot.extensions.batch import workbook as workbooks
from dashpot.extensions.batch.acceptance import check_lot_acceptance
from dashpot.extensions.batch.limits import Limits, read_limits
from dashpot.extensions.batch.page import html
from dashpot.extensions.batch.summary import summary
from dashpot.extensions.batch.workbook import workbook
from dashpot.reading.write import write_relaxation
from dashpot.report.first_screen import MARK_ORDER
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.demo_seals import PAPER

pytestmark = pytest.mark.once
COLUMNS = ("k_end_N_per_m", "loss_factor_at_12.7Hz", "k_0_N_per_m")


def limits(tmp_path, text, columns=COLUMNS):
    path = tmp_path / "limits.toml"
    path.write_text(text)
    return read_limits(path, columns)


def test_limits_have_units_and_the_names_of_the_table(tmp_path):
    first, second = limits(
        tmp_path,
        '[k_end]\nlower = "0.18N/mm"\nupper = "220 N/m"\ncpk = 1.33\n'
        '["loss_factor_at_12.7Hz"]\nupper = 0.08\n',
    )
    assert (first.lower, first.upper, first.cpk) == pytest.approx((180, 220, 1.33))
    assert (second.lower, second.upper) == (None, 0.08)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[k_end]\nlower = 0.18", r"\[k_end\]: '0.18' has no unit"),
        ('[k_end]\nlower = "18mm"', r"\[k_end\]"),
        ("[k]\nlower = 1", "'k' is no column"),
        ("[k_end]\ncpk = 1.3", "it has no limit"),
        ('[k_end]\nlower = "2N/m"\nupper = "1N/m"', "lower is not below upper"),
        ('[k_end]\nlow = "2N/m"', "'low' is unknown; known are lower, upper, cpk"),
        ('[k_end]\nlower = "2N/m"\ncpk = -1', "cpk = -1"),
        ("k_end = 3", "expected a table"),
        ("", "is empty"),
        ("# none", "no limit is in it"),
        ("[k_end", "not TOML"),
        ('[k_end]\nlower = "1N/m"\n[k_end_N_per_m]\nlower = "2N/m"', "k_end_N_per_m stand there"),
        ('["loss_factor_at_12.7Hz"]\nupper = nan', "expected a finite number"),
    ],
)
def test_limits_that_make_no_sense_are_refused(tmp_path, text, words):
    with pytest.raises(ReadError, match=words):
        limits(tmp_path, text)


def make_repeated_lot(*means, spread=1.0):
    """One lot of seals with four repeats each, at their mean -1, -1, 1, 1 times the spread."""
    return [
        {"lot": "A", "seal": f"{i}", "k_end_N_per_m": mean + spread * side,
         "file": f"{i}_{j}.csv"}
        for i, mean in enumerate(means)
        for j, side in enumerate((-1, -1, 1, 1))
    ]  # fmt: skip


def test_a_seal_passes_where_its_uncertainty_leaves_no_doubt(tmp_path):
    """Repeats of one lot: s = sqrt(4/3), 12 degrees of freedom, t_0.95 = 1.7823 (any table)."""
    guard = 1.7823 * math.sqrt(4 / 3) / 2
    means = (110.0, 100 + 1.001 * guard, 100 + 0.999 * guard, 99.99)
    rows = make_repeated_lot(*means)
    rows.append({"lot": "A", "seal": "lost", "file": "z.csv", "outcome": "refused"})
    (requested,) = limits(tmp_path, '[k_end]\nlower = "100N/m"')
    seal_decisions = check_lot_acceptance(lot_of(rows), requested)
    assert [seal_decision.decision for seal_decision in seal_decisions] == [
        "pass",
        "pass",
        "not proven",
        "fail",
        "no result",
    ]
    assert seal_decisions[0].guard == pytest.approx(guard, rel=1e-4)
    # without repeats the uncertainty is not known
    single = check_lot_acceptance(lot_of(rows[:16:4]), requested)
    assert [(item.decision, item.guard) for item in single][:2] == [("pass", None), ("pass", None)]


def test_a_guard_band_keeps_its_promise(tmp_path):
    """Of seals truly outside the limit, fewer than one in twenty pass."""
    rng = np.random.default_rng(1)
    (requested,) = limits(tmp_path, '[k_end]\nlower = "100N/m"')
    passed = 0
    for _ in range(40):
        rows = [
            {"lot": "A", "seal": f"{i}", "k_end_N_per_m": 99.999 + rng.normal(0, 2)}
            for i in range(25)
            for _ in range(3)
        ]
        passed += [
            seal_decision.decision
            for seal_decision in check_lot_acceptance(lot_of(rows), requested)
        ].count("pass")
    assert passed / 1000 < 0.05 + 4 * math.sqrt(0.05 * 0.95 / 1000)


def test_a_limit_of_a_modulus_is_not_held_against_a_stiffness(tmp_path):
    part, material = "storage_at_5Hz_N_per_m", "storage_at_5Hz_Pa"
    rows = [row | {part: 200.0, material: None} for row in draw_rows(1, 2, 1)]
    rows += [{"lot": "L1", "seal": f"m{i}", part: None, material: 5e6 + i} for i in range(2)]
    requested = limits(tmp_path, '[storage_at_5Hz_Pa]\nupper = "6MPa"', (part, material))
    (result,) = summary(lot_of(rows), limits=requested).others
    passed = {
        (decision.seal, decision.value)
        for decision in result.seal_decisions
        if decision.decision == "pass"
    }
    assert passed == {("m0", 5e6), ("m1", 5e6 + 1)}
    assert {item.seal for item in result.seal_decisions if item.decision == "no result"} == {
        "1",
        "2",
    }


def test_what_operators_add_widens_the_guard_band(tmp_path):
    rows = draw_rows(lots=1, seals=10, sds=(0, 0.03, 0.005), operators=("a", "b"), seed=1)
    (requested,) = limits(tmp_path, '[k_end]\nlower = "100N/m"')
    guard = check_lot_acceptance(lot_of(rows), requested)[0].guard
    for row in rows:
        row["k_end_N_per_m"] += 8 * (row["operator"] == "b")
    assert check_lot_acceptance(lot_of(rows), requested)[0].guard > 3 * guard


def test_what_stands_out_is_named_and_what_does_not_is_not():
    rng = np.random.default_rng(8)
    means = 200 + 4 * np.linspace(-1.5, 1.5, 20)[rng.permutation(20)]
    rows = [
        {"lot": "A", "seal": f"{i}", "file": f"{i}_{j}.csv",
         "k_end_N_per_m": means[i] + rng.normal(0, 1)}
        for i in range(20) for j in range(4)
    ]  # fmt: skip
    intact = summary(lot_of(rows))
    assert intact.flags == ()
    for row in rows[12:16]:
        row["k_end_N_per_m"] += 40  # seal 3
    rows[21]["k_end_N_per_m"] += 12  # one test of seal 5
    flags = summary(lot_of(rows)).flags
    assert {(flag.seal, flag.file) for flag in flags} == {("3", ""), ("5", ""), ("5", "5_1.csv")}
    values = {flag.seal + flag.file: flag.message for flag in flags}
    assert "above the median seal of its lot" in values["3"]
    assert "its repeats scatter by" in values["5"]
    assert "above the other tests of its seal" in values["55_1.csv"]


HOSTILE = {
    "one test": draw_rows(1, 1, 1),
    "one seal": draw_rows(1, 1, 4),
    "one repeat": draw_rows(1, 6, 1),
    "two lots of one seal": draw_rows(2, 1, 1),
    "all identical": draw_rows(2, 3, 2, sds=(0, 0, 0)),
    "repeats identical": draw_rows(2, 5, 3, sds=(0.02, 0.03, 0)),
    "an outlier": [*draw_rows(1, 8, 2), {"lot": "L1", "seal": "x", "k_end_N_per_m": 2e4,
                                         "k_inf_N_per_m": 2e4, "k_1_N_per_m": 1.0}],
    "mixed depths": [row | {"depth_m": 0.006 + 0.001 * (i % 3)}
                     for i, row in enumerate(draw_rows(1, 6, 2))],
    "nothing fitted": [row | {"outcome": "refused", "verdict": ""} for row in draw_rows(1, 2, 2)],
    "nothing to use": [row | {"verdict": "do not use"} for row in draw_rows(1, 2, 2)],
    "names that are code": [row | {"lot": "=1+1", "seal": "<i>" + row["seal"],
                                   "operator": "https://a.b"}
                            for row in draw_rows(1, 3, 2)],
    "skewed": [row | {"k_end_N_per_m": 100 + np.exp(i % 7)}
               for i, row in enumerate(draw_rows(1, 14, 1))],
}  # fmt: skip


@pytest.mark.parametrize("rows", HOSTILE.values(), ids=HOSTILE)
def test_any_lot_has_a_page_a_document_and_a_workbook(rows, tmp_path):
    lot = lot_of(rows)
    requested = limits(tmp_path, '[k_end]\nlower = "180N/m"\nupper = "220N/m"\ncpk = 1.33\n')
    result = summary(lot, limits=requested)
    json.dumps(result.to_dict(), allow_nan=False)
    page = html(lot, lot_summary=result)
    assert "<i>" not in page
    assert page.count("<svg") == page.count("</svg>")
    book = openpyxl.load_workbook(BytesIO(workbook(result)))
    assert book["tests"].max_row == lot.table.height + 1
    cells = [cell for sheet in book for row in sheet.iter_rows() for cell in row]
    assert not any(cell.data_type == "f" or cell.hyperlink for cell in cells)
    for quantity in result.quantities:
        for seal in quantity.seal_decisions:
            assert seal.decision in {"pass", "fail", "not proven", "no result"}


def test_workbook_is_recognised_and_reproducible():
    result = summary(lot_of(draw_rows(2, 3, 2)))
    made = workbook(result)
    assert is_ours(made[:4096])
    assert workbook(result) == made
    book = openpyxl.load_workbook(BytesIO(made))
    seals = {row[2]: row[4] for row in book["seals"].iter_rows(min_row=2, values_only=True)}
    assert seals["3"] == pytest.approx(result.main.seals[-1].mean)


def test_workbook_refers_tests_over_the_sheet_limit_to_the_table(monkeypatch):
    result = summary(lot_of(draw_rows(1, 3, 2)))
    for rows, width in ((6, result.lot.written_table().width), (5, 1)):
        monkeypatch.setattr(workbooks, "_SHEET_ROWS", rows)
        book = openpyxl.load_workbook(BytesIO(workbook(result)))
        assert book["tests"].max_column == width
        assert book["seals"].max_row == 4
    assert book["tests"]["A2"].value == "6 are more than a sheet has rows: they are in lot.csv"


def test_lot_page_leads_with_a_missed_capability(tmp_path):
    lot = lot_of(draw_rows(2, 25, 2, seed=4))
    requested = limits(tmp_path, '[k_end]\nlower = "150N/m"\nupper = "250N/m"\ncpk = 3\n')
    result = summary(lot, limits=requested)
    page = html(lot, lot_summary=result)
    assert "3.00 is asked" in page
    (check,) = [check for check in result.checks if check.name == "capability_requirement_met"]
    worst = min(item.cpk for item in result.main.capability.values())
    assert check.failed
    assert check.value == worst


@pytest.mark.parametrize(
    ("rows", "unknown"),
    [
        (draw_rows(1, 1, 4), True),
        (draw_rows(1, 4, 1, sds=(0, 0, 0)), True),
        ([*draw_rows(1, 5, 2), {"lot": "B", "seal": "1", "outcome": "refused"}], True),
        (draw_rows(2, 5, 2), False),
    ],
    ids=["one seal", "all equal", "a lot without a seal that is used", "known"],
)
def test_required_capability_that_is_undetermined_fails(tmp_path, rows, unknown):
    requested = limits(tmp_path, '[k_end]\nlower = "1N/m"\nupper = "999N/m"\ncpk = 1.33\n')
    checks = summary(lot_of(rows), limits=requested).checks
    (check,) = [check for check in checks if check.name == "capability_requirement_met"]
    assert check.failed is unknown
    assert ("is not known of one lot" in check.message) is unknown


def test_a_test_that_lacks_the_quantity_of_a_limit_has_no_result(tmp_path):
    rows = [row | {"seal": "", "frequency_Hz": None} for row in draw_rows(1, 3, 1)]
    rows[0]["frequency_Hz"] = 12.0
    rows.append({"lot": "L1", "file": "notes.txt", "outcome": "refused"})
    (requested,) = limits(tmp_path, '[frequency]\nlower = "10Hz"\n', ("frequency_Hz",))
    seal_decisions = check_lot_acceptance(lot_of(rows), requested)
    assert [(seal_decision.seal, seal_decision.decision) for seal_decision in seal_decisions] == [
        ("L1/1_1.csv", "pass"), ("L1/2_1.csv", "no result"), ("L1/3_1.csv", "no result"),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("sds", "mark", "use"),
    [((0.0, 0.03, 0.005), "good", "use"), ((0.0, 0.02, 0.02), "bad", "do not use")],
)
def test_summary_does_not_release_a_lot_with_an_inadequate_gauge(sds, mark, use):
    result = summary(lot_of(draw_rows(lots=2, seals=25, repeats=4, sds=sds)))
    lights = {item.name: item.mark for item in result.indicators}
    assert lights["measuring"] == mark
    assert (result.verdict.use == "do not use") == (use == "do not use")


def test_lots_that_shift_are_no_chance_and_a_lot_like_the_others_is():
    still = summary(lot_of(draw_rows(lots=12, seals=25, repeats=1, sds=(0.0, 0.03, 0.0))))
    variant = summary(lot_of(draw_rows(lots=12, seals=25, repeats=1, sds=(0.02, 0.03, 0.0))))
    marks = [
        {item.name: item.mark for item in element.indicators}["control"]
        for element in (still, variant)
    ]
    assert marks[0] in {"good", "note"}
    assert marks[1] == "care"
    # a run of points is one cause
    lots = variant.main.lots
    assert lots is not None
    assert lots.mean.signalling_points == (1, 3, 4)
    assert lots.mean.causes == ((1, 1), (3, 4))


def test_the_verdict_is_as_bad_as_the_worst_light():
    worst = {"use": {"good", "note"}, "use with care": {"care"}, "do not use": {"bad"}}
    for sds in ((0.0, 0.03, 0.005), (0.0, 0.03, 0.012), (0.02, 0.03, 0.005), (0.0, 0.02, 0.02)):
        result = summary(lot_of(draw_rows(lots=6, seals=12, repeats=3, sds=sds)))
        mark = max((item.mark for item in result.indicators), key=MARK_ORDER.index)
        assert mark in worst[result.verdict.use]
        assert [item.name for item in result.indicators] == [
            "files",
            "measuring",
            "control",
            "limits",
        ]


def test_a_copy_is_counted_and_says_nothing():
    rows = draw_rows(lots=1, seals=12, repeats=3)
    for i, row in enumerate(rows):
        row["sha256"] = f"{i:064}"
    single = summary(lot_of(rows))
    twice = summary(lot_of([*rows, {**rows[0], "file": "again.csv", "seal": "13"}]))
    assert [len(item.main.seals) for item in (single, twice)] == [12, 12]
    assert twice.lot.copies == {"again.csv": rows[0]["file"]} or len(twice.lot.copies) == 1
    assert "1 copy" in twice.indicators[0].message
    assert "copy" not in single.indicators[0].message
    assert twice.main.gauge.categories == single.main.gauge.categories


@pytest.mark.parametrize(
    ("of", "by", "grade"),
    [
        ("cpk", -0.01, None),
        ("cpk", 0.01, "limit"),
        ("high", -0.01, "limit"),
        ("high", 0.01, "stop"),
    ],
)
def test_a_capability_that_the_interval_rules_out_is_a_stop(of, by, grade):
    lot = lot_of(draw_rows(lots=1, seals=30, repeats=1, sds=(0.0, 0.02, 0.0)))
    (able,) = lot.capability("k_end", 176.0, 224.0).values()
    requested = {"cpk": able.cpk, "high": able.cpk_interval[1]}[of] + by
    limits = [Limits(lot.quantity("k_end"), 176.0, 224.0, requested)]
    (result,) = (check for check in summary(lot, limits=limits).checks
                if check.name == "capability_requirement_met")  # fmt: skip
    assert (result.grade if result.failed else None) == grade


def test_summary_reports_frequencies_outside_the_band():
    rows = [row | {"loss_factor_at_12.7Hz": 0.03, "loss_factor_at_0.1Hz": 0.03}
            for row in draw_rows(1, 3, 1)]  # fmt: skip
    (check,) = [
        check for check in summary(lot_of(rows)).checks if check.name == "frequencies_in_band"
    ]
    assert check.value == 3
    assert "12.7 Hz lies outside" in check.message


def test_the_command_judges_by_limits_and_strict_ends_in_1(tmp_path):
    tests = tmp_path / "tests"
    tests.mkdir()
    for i in range(4):
        made = simulate_relaxation(PAPER, hold_time=3.0, seed=i)
        (tests / f"seal{i // 2}_{i % 2}.csv").write_text(write_relaxation(made.test))
    common = ["batch", tests, "-o", tmp_path / "lot", "--arms", 1, "--quick",
              "--label-pattern", r"seal(?P<seal>\d)_(?P<repeat>\d)", "--jobs", 1]  # fmt: skip
    for text, code, decision in (
        ('[k_end]\nlower = "150N/m"\nupper = "300N/m"', 0, "pass"),
        ('[k_end]\nupper = "150N/m"', 1, "fail"),
    ):
        path = tmp_path / "limits.toml"
        path.write_text(text)
        done = ran(*common, "--limits", path, "--strict", "--json")
        assert done.exit_code == code, done.output
        (entry,) = json.loads(done.stdout)["statistics"]
        assert {judge["decision"] for judge in entry["decisions"]} == {decision}
    page = (tmp_path / "lot" / "lot.html").read_text()
    assert "0 of two seals" not in page
    assert "outside" in page
    path.write_text('[k_near]\nlower = "1N/m"')
    assert ran(*common, "--limits", path).exit_code == 2
    assert ran("batch", tests).exit_code == 2
