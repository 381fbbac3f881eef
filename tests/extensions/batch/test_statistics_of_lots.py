"""A lot: which rows its statistics are of, seals for replicates, and what two lots differ by."""

import numpy as np
import polars as pl
import pytest
from kit.lots import draw_rows, lot_of
from kit.shell import ran, run_json

import dashpot as dp
from dashpot.base.errors import DataError, ReadError
from dashpot.extensions.batch.columns import REQUIRED_COLUMNS
from dashpot.extensions.batch.comparison import compare_two_lots, open_both_lots, open_lot
from dashpot.extensions.batch.quantities import make_natural_sort_key, quantity
from dashpot.extensions.batch.summary import summary

pytestmark = pytest.mark.once


def test_seals_stand_in_the_order_in_which_people_count():
    lot = lot_of(draw_rows(lots=2, seals=11, repeats=1))
    assert [seal.name for seal in lot.seals()][:11] == [f"{i}" for i in range(1, 12)]
    counted = ["9", "10", "b", "seal 9", "seal 10"]
    shuffled = ["seal 10", "b", "10", "9", "seal 9"]
    assert sorted(shuffled, key=make_natural_sort_key) == counted


def test_quantity_is_resolved_by_column_with_or_without_unit():
    columns = ["k_end_N_per_m", "loss_factor_at_12.7Hz_2.6mm", "storage_at_5Hz_N_per_m",
               "storage_at_5Hz_Pa", "frequency_Hz"]  # fmt: skip
    assert quantity("k_end", columns) == quantity("k_end_N_per_m", columns)
    assert quantity("k_end", columns).title == "stiffness at the end of the hold, N/mm"
    assert quantity("k_end", columns).read(196.54) == "0.1965 N/mm"
    assert (
        quantity("loss_factor_at_12.7Hz_2.6mm", columns).title == "loss factor at 12.7 Hz at 2.6 mm"
    )
    assert quantity("storage_at_5Hz", columns).unit == "N/mm"
    assert quantity("storage_at_5Hz_Pa", columns).unit == "MPa"
    with pytest.raises(DataError, match="'k' is no column of numbers of the table; there are"):
        quantity("k", columns)


@pytest.mark.parametrize(
    ("column", "keeps", "breaks", "message"),
    [
        ("hold_s", 38.0, 37.9, "held for 37.9 s, its lot 40 s"),
        ("hold_s", 42.0, 42.1, "held for 42.1 s, its lot 40 s"),
        ("depth_m", 0.0084, 0.00841, "pressed to 8.41 mm, its lot 8 mm"),
        ("temperature_K", 299.15, 299.2, "tested at 299 K, its lot 296 K"),
    ],
)
def test_lot_excludes_a_test_with_other_conditions(column, keeps, breaks, message):
    for value, dissimilar in ((keeps, {}), (breaks, {"L1/1_1.csv": message})):
        rows = draw_rows(lots=1, seals=3)
        rows[0][column] = value
        lot = lot_of(rows)
        assert lot.dissimilar == dissimilar
        assert lot.rows_in_statistics.height == 12 - len(dissimilar)
        (check,) = [check for check in lot.checks if check.name == "tests_alike"]
        assert check.failed is bool(dissimilar)


def test_lot_names_duplicate_records_and_refuses_comparison_with_itself():
    rows = [row | {"sha256": f"{i}"} for i, row in enumerate(draw_rows(lots=1, seals=3, repeats=2))]
    intact = lot_of(rows)
    assert intact.copies == {}
    both = compare_two_lots(("may", intact), ("june", intact), ["k_end"])
    assert [check.value for check in both.checks if check.name == "records_distinct"] == [6, 0, 0]
    assert both.differences[0].different is both.to_dict()["differences"][0]["different"] is None
    assert "not checked, the lots have six records in common" in str(both)
    assert "no difference" not in str(both)
    others = [row | {"sha256": f"{i}*"} for i, row in enumerate(rows)]
    assert (
        compare_two_lots(("may", intact), ("june", lot_of(others)), ["k_end"])
        .differences[0]
        .different
        is False
    )
    others[0]["sha256"] = "0"
    assert (
        compare_two_lots(("may", intact), ("june", lot_of(others)), ["k_end"]).differences[0].shared
        == 1
    )
    rows[3]["sha256"] = "0"
    lot = lot_of(rows)
    assert lot.copies == {"L1/2_2.csv": "L1/1_1.csv"}
    (check,) = [check for check in lot.checks if check.name == "records_distinct"]
    assert check.failed
    assert [flag.message for flag in summary(lot).flags if flag.file == "L1/2_2.csv"] == [
        "the same record as L1/1_1.csv: left out of the statistics"
    ]


def test_lot_uses_the_depth_of_the_first_tests():
    rows = draw_rows(lots=1, seals=4, repeats=1)
    for row in rows[2:]:
        row["depth_m"] = 0.006
    assert lot_of(rows).rows_in_statistics["file"].to_list() == ["L1/3_1.csv", "L1/4_1.csv"]


def test_what_was_not_fitted_or_may_not_be_used_does_not_enter_and_what_needs_care_does():
    rows = draw_rows(lots=1, seals=3, repeats=2)
    rows[0] |= {"outcome": "refused", "k_end_N_per_m": 1e6}
    rows[1] |= {"verdict": "do not use", "k_end_N_per_m": 1e6}
    rows[2] |= {"verdict": "use with care"}
    lot = lot_of(rows)
    assert [len(seal.files) for seal in lot.seals()] == [2, 2]
    assert max(seal.mean for seal in lot.seals()) < 300


def test_the_chart_of_seals_knows_how_seals_differ_and_that_of_repeats_how_repeats_do():
    """Limits from the repeats, ten times closer, would accuse nearly every seal."""
    lot = lot_of(draw_rows(lots=1, seals=60, sds=(0, 0.03, 0.003), seed=3))
    (charts,) = lot.charts().values()
    assert (charts.means.upper[0] - charts.means.centre) / 200 == pytest.approx(0.09, rel=0.25)
    assert charts.repeats.centre / 200 == pytest.approx(0.003 * 0.921, rel=0.1)  # c_4 of four
    assert len([signal for signal in charts.means.signals if "beyond" in signal.rule]) <= 1
    single = lot_of(draw_rows(lots=1, seals=5, repeats=1)).charts()["L1"]
    assert single.repeats is None
    assert lot_of(draw_rows(lots=1, seals=1)).charts() == {}


def test_lots_have_a_chart_whose_groups_are_their_seals():
    names, means, deviations = lot_of(draw_rows(lots=5, sds=(0, 0.03, 0.01))).lot_chart()
    assert names == ("L1", "L2", "L3", "L4", "L5")
    assert means.upper[0] - means.centre == pytest.approx(3 * 200 * 0.0304 / 5, rel=0.2)
    assert deviations.centre == pytest.approx(200 * 0.0304, rel=0.2)
    assert lot_of(draw_rows(lots=1)).lot_chart() is None


def test_components_and_gauge_hold_the_truth_of_four_lots():
    lot = lot_of(draw_rows(seed=2, operators=("Kim", "Lee")))
    result = {component.source: component for component in lot.components("k_end")}
    for source, sd in (("lot", 4), ("seal", 6), ("repeat", 2)):
        low, high = result[source].interval
        assert low <= sd**2 <= high, source
    study = lot.gauge()
    assert (study.parts, study.operators, study.tests) == (100, 2, 400)
    assert study["repeatability"].interval[0] < 2 < study["repeatability"].interval[1]
    # the limits leave the mean by 10 %: three standard deviations of seals with a quarter of the
    # repeats' variance
    able = lot.capability("k_end", 180, 220)
    assert list(able) == ["L1", "L2", "L3", "L4"]
    assert all(item.count == 25 and 0 < item.cpk < item.cp < 1.6 for item in able.values())


def test_the_table_goes_to_pandas_and_the_charts_to_a_picture(tmp_path):
    lot = lot_of(draw_rows(lots=2, seals=3))
    frame = lot.to_pandas()
    assert list(frame.columns) == lot.written_table().columns
    assert list(frame.columns)[:1] == ["file"]
    assert len(frame.columns) < len(lot.table.columns)
    assert all(frame[name].notna().any() for name in set(frame.columns) - set(REQUIRED_COLUMNS))
    assert frame["k_end_N_per_m"].tolist() == lot.table["k_end_N_per_m"].to_list()
    dp.plot.save(lot.plot(), tmp_path / "lot.svg")
    assert "control limits of each lot" in (tmp_path / "lot.svg").read_text()


# -- two lots -------------------------------------------------------------------------------------


def save_lot(place, lot):
    place.mkdir()
    lot.table.with_columns(key=pl.col("file")).write_parquet(place / "part-0.parquet")
    return str(place)


def test_two_lots_that_differ_and_two_that_do_not(tmp_path):
    same, lot = (
        lot_of(draw_rows(lots=1, sds=(0, 0.03, 0.01), mean=mean, seed=seed))
        for mean, seed in ((200, 1), (210, 2))
    )
    difference = compare_two_lots(("A", same), ("B", lot), ["k_end"]).differences[0]
    assert difference.different
    low, high = difference.difference.interval
    assert low < 10 < high
    assert difference.difference.counts == (25, 25)
    alike = compare_two_lots(
        ("A", same), ("C", lot_of(draw_rows(lots=1, sds=(0, 0.03, 0.01), seed=5)))
    )
    assert [difference.quantity.name for difference in alike.differences] == ["k_end", "k_0"]
    assert not any(difference.different for difference in alike.differences)
    # 25 seals of 3 % find 2.4 %: 2.86 standard errors of 3.04 % times the root of 2/25
    assert alike.differences[0].difference.detectable / 200 == pytest.approx(0.0246, rel=0.3)

    folders = [save_lot(tmp_path / name, item) for name, item in (("may", same), ("june", lot))]
    document = run_json("compare", *folders)
    assert document["schema"] == "dashpot/lot-comparison@2"
    assert document["lots"] == ["may", "june"]
    assert [difference["different"] for difference in document["differences"]] == [True, True]
    stdout = ran("compare", *folders, "--quantity", "k_end").stdout
    assert "stiffness at the end of the hold: different" in stdout
    assert "with a power of 80 %; alike within" in stdout
    item = [save_lot(tmp_path / when / "lot", same) for when in ("may", "june")]
    assert [name for name, _ in open_both_lots(item)] == item


def test_lots_tested_otherwise_are_not_called_the_same_test():
    rows, other = draw_rows(lots=1), draw_rows(lots=1, seed=1)
    for row in other:
        row["depth_m"] = 0.006
    lot_comparison = compare_two_lots(("A", lot_of(rows)), ("B", lot_of(other)))
    (check,) = [check for check in lot_comparison.checks if check.name == "lots_tested_alike"]
    assert check.failed
    assert "depth 0.008 and 0.006 m" in check.message
    fitted = [check.message[:5] for check in lot_comparison.checks if check.name == "files_fitted"]
    assert fitted == ["In A,", "In B,"]
    assert not compare_two_lots(("A", lot_of(rows)), ("B", lot_of(rows))).checks[0].failed


def test_compare_two_lots_counts_a_test_without_seal_as_one_seal():
    rows = draw_rows(lots=1, seals=4, repeats=2)
    for row in rows:
        row["seal"] = ""
    lot_comparison = compare_two_lots(("A", lot_of(rows)), ("B", lot_of(rows)))
    assert lot_comparison.differences[0].difference.counts == (8, 8)
    (check,) = [check for check in lot_comparison.checks if check.name == "seals_named"]
    assert check.value == 16


def test_open_lot_asks_which_of_several_lots(tmp_path):
    folder = save_lot(tmp_path / "all", lot_of(draw_rows(lots=3, seals=2)))
    assert open_lot(f"{folder}:L2")[1].table.height == 8
    for named, error, words in (
        (folder, DataError, "holds 3 lots: L1, L2, L3; say which"),
        (f"{folder}:L9", DataError, "there is no lot 'L9'; there are L1, L2, L3"),
        (str(tmp_path), ReadError, "holds no rows of a batch"),
    ):
        with pytest.raises(error, match=words):
            open_lot(named)
    lot = lot_of(draw_rows(lots=1, seals=1))
    with pytest.raises(DataError, match="lots of 1 and 1 seals"):
        compare_two_lots(("A", lot), ("B", lot))
    assert np.isfinite(lot.seals()[0].mean)
