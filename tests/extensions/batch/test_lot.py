"""A batch: a row for each file, the numbers of a fit, the same table however it was stopped."""

from __future__ import annotations

import csv
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from io import BytesIO
from pathlib import Path
from statistics import NormalDist

import numpy as np
import polars as pl
import pytest
from kit.processes import ON_LINUX, alive, children
from kit.shell import ran, run_json

import dashpot as dp
from dashpot.base.errors import DataError, ExportError, ReadError
from dashpot.base.version import is_ours
from dashpot.extensions.batch import batch_run
from dashpot.extensions.batch import parquet_parts as parts
from dashpot.extensions.batch.batch_run import batch
from dashpot.extensions.batch.process_pool import MAX_LOST_WORKERS
from dashpot.fitting.relaxation import fit as fit_tests
from dashpot.preprocessing.prepare import prepare
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.reading.write import write_impact, write_relaxation
from dashpot.simulation.impact import simulate_impact
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.demo_seals import PAPER

pytestmark = pytest.mark.once

BY = r"lot(\w+)_seal(\d+)_rep(\d+)"
QUICK = {"arms": 1, "quick": True, "label_pattern": BY}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Eight short tests of four seals, and three files that are none."""
    place = tmp_path_factory.mktemp("tests")
    for i in range(8):
        made = simulate_relaxation((1 + 0.01 * i) * PAPER, hold_time=3.0, seed=i)
        (place / f"lotA_seal{i // 2}_rep{i % 2}.csv").write_text(write_relaxation(made.test))
    (place / "junk.csv").write_text("junk\n")
    (place / "empty.csv").write_text("")
    hits = simulate_impact(PAPER, mass=0.104, hits=1).test
    (place / "hammer.csv").write_text(write_impact(hits))
    return place


@pytest.fixture(scope="module")
def complete_table(folder):
    """The table of a run that nothing stopped."""
    return batch(folder, jobs=2, **QUICK).table


def as_bytes(table):
    written = BytesIO()
    table.write_parquet(written)
    return written.getvalue()


def row_of(table, name):
    return next(output for output in table.to_dicts() if output["file"].endswith(name))


def test_batch_has_a_row_for_every_file(complete_table):
    assert complete_table["file"].to_list() == sorted(complete_table["file"])
    assert complete_table["outcome"].value_counts(sort=True).rows() == [
        ("fitted", 8), ("refused", 2), ("other", 1)
    ]  # fmt: skip
    hammer = row_of(complete_table, "hammer.csv")
    assert "it is a hammer test: say of which test" in hammer["reason"]
    assert (hammer["measured_Hz"], hammer["k_inf_N_per_m"]) == (pytest.approx(12.7, abs=0.1), None)
    assert "is empty (0 bytes)" in row_of(complete_table, "empty.csv")["reason"]
    assert "no numbers under the header" in row_of(complete_table, "junk.csv")["reason"]
    row = row_of(complete_table, "lotA_seal3_rep1.csv")
    assert (row["lot"], row["seal"], row["repeat"]) == ("A", "3", "1")
    assert row_of(complete_table, "junk.csv")["lot"] == ""


def test_the_numbers_are_those_of_a_fit_to_the_last_digit(folder):
    path = folder / "lotA_seal0_rep0.csv"
    (row,) = batch(path, arms=2, mass="104g", seals=2, jobs=1).table.to_dicts()
    test = prepare(read_relaxation(path))
    fit = fit_tests(test, arms=2)
    k_inf = fit.intervals()["k_inf"]
    assert row["k_inf_N_per_m"] == fit.model.k_inf
    assert (row["k_1_N_per_m"], row["k_2_N_per_m"]) == fit.model.k
    assert (row["tau_1_s"], row["tau_2_s"]) == fit.model.tau
    assert row["k_0_N_per_m"] == fit.model.k_0
    assert row["k_end_N_per_m"] == fit.model.relaxation(test.hold_time)
    assert row["k_1_se_N_per_m"] == fit.standard_error["k"][0]
    # "at most": no lower end is reported
    assert (row["k_inf_low_N_per_m"], row["k_inf_high_N_per_m"]) == (None, k_inf[1])
    assert (row["k_end_low_N_per_m"], row["k_end_high_N_per_m"]) == fit.stiffness_limits["k_end"]
    assert row["verdict"] == fit.verdict.use
    failed = [check.name for check in fit.checks if check.failed and check.grade != "note"]
    assert row["failed_checks"].split() == list(dict.fromkeys(failed))
    assert row["sha256"] == test.source.sha256
    mode = dp.systems.predict_frf(2 * fit.model, mass=0.104).modes()[0]
    assert row["frequency_Hz"] == pytest.approx(mode.frequency, rel=1e-4)


def test_batch_row_has_the_requested_stiffness_and_loss(folder):
    path = folder / "lotA_seal0_rep0.csv"
    (row,) = batch(path, arms=2, at=["12.7Hz", 0.1], compression="2.6mm").table.to_dicts()
    test = prepare(read_relaxation(path))
    fit = fit_tests(test, arms=2)
    solid = fit.model_at(2.6e-3)
    for name, frequency in (("12.7Hz", 12.7), ("0.1Hz", 0.1)):
        value = solid.complex_stiffness(omega=2 * np.pi * frequency)
        assert row[f"storage_at_{name}_2.6mm_N_per_m"] == value.real
        assert row[f"loss_at_{name}_2.6mm_N_per_m"] == value.imag
        assert row[f"loss_factor_at_{name}_2.6mm"] == value.imag / value.real
    assert row["k_end_at_2.6mm_N_per_m"] == solid.relaxation(test.hold_time)
    assert (row["band_low_Hz"], row["band_high_Hz"]) == fit.band
    (deep,) = batch(path, at="5Hz", compression=1.0, mass=0.1, **QUICK).table.to_dicts()
    assert "compression" in deep["reason"]
    assert deep["storage_at_5Hz_1000mm_N_per_m"] is None
    assert deep["frequency_Hz"] > 0
    with pytest.raises(DataError, match="at = -1"):
        batch(path, at=-1.0, **QUICK)


def test_batch_refits_only_a_changed_file(folder, complete_table, tmp_path):
    tests = tmp_path / "tests"
    tests.mkdir()
    for name in ("lotA_seal0_rep0.csv", "lotA_seal1_rep0.csv", "junk.csv"):
        shutil.copy(folder / name, tests)
    out = tmp_path / "lot"
    first = batch(tests, output=out, jobs=1, **QUICK)
    assert first.computed == 3
    again = batch(tests, output=out, jobs=2, **QUICK)
    assert again.computed == 0
    assert as_bytes(again.table) == as_bytes(first.table)
    shutil.copy(folder / "lotA_seal0_rep0.csv", tests / "junk.csv")
    changed = batch(tests, output=out, jobs=1, **QUICK)
    assert changed.computed == 1
    assert row_of(changed.table, "junk.csv")["outcome"] == "fitted"
    # the parts hold what the table holds: no row of the old file, none twice
    on_disk = pl.read_parquet(out / "*.parquet").sort("file")
    assert as_bytes(on_disk) == as_bytes(changed.table)
    other = batch(tests, output=out, jobs=1, **{**QUICK, "arms": 2})
    assert other.computed == 3
    assert pl.read_parquet(out / "*.parquet").height == 3
    assert other.table["k_2_N_per_m"].drop_nulls().len() > 0


def test_batch_rebuilds_a_damaged_part_file(folder, complete_table, tmp_path):
    batch(folder, output=tmp_path, jobs=2, **QUICK)
    victim = sorted(tmp_path.glob("part-*.parquet"))[0]
    victim.write_bytes(victim.read_bytes()[:100])
    (tmp_path / ".0.part").write_text("half of a part")
    again = batch(folder, output=tmp_path, jobs=2, **QUICK)
    assert 0 < again.computed < 11
    assert as_bytes(again.table) == as_bytes(complete_table)
    assert not list(tmp_path.glob(".*.part"))


def make_lot(rows):
    """A lot of rows that were never fitted."""
    every = {
        "outcome": "fitted",
        "verdict": "use",
        "seal": "",
        "lot": "",
        "hold_s": 40.0,
        "kind": "relaxation",
    }
    every |= {"k_inf_se_N_per_m": 0.5, "repeat": ""}
    table = pl.DataFrame([{**every, "file": f"{i}.csv", **row} for i, row in enumerate(rows)])
    return dp.Lot(table, 0)


def test_the_scatter_of_a_lot_is_that_of_its_lots_seals_repeats_and_fits():
    rng = np.random.default_rng(5)
    rows = []
    for lot in range(6):
        mean = rng.normal(200, 4)
        for seal in range(25):
            individual = rng.normal(mean, 6)
            rows += [
                {"lot": str(lot), "seal": str(seal), "k_inf_N_per_m": rng.normal(individual, 2)}
                for _ in range(4)
            ]
    rows.append({**rows[0], "k_inf_N_per_m": 1e6, "verdict": "do not use"})
    rows.append({**rows[0], "k_inf_N_per_m": 1e6, "outcome": "refused"})
    result = {component.source: component for component in make_lot(rows).components()}
    assert list(result) == ["lot", "seal", "repeat", "fit"]
    for source, sd in (("lot", 4), ("seal", 6), ("repeat", np.sqrt(2**2 - 0.5**2))):
        low, high = result[source].interval
        assert low <= sd**2 <= high
    assert result["fit"].variance == pytest.approx(0.25)
    # one lot: no level of lots; no repeats: seals, in which their tests are hidden
    item = make_lot(rows[:100])
    assert [c.source for c in item.components()] == ["seal", "repeat", "fit"]
    first = make_lot(rows[:600:4])
    assert [c.source for c in first.components()] == ["lot", "seal", "fit"]
    with pytest.raises(DataError, match="no sources to separate"):
        make_lot(rows[:4]).components()
    for name in ("file", "k_9"):
        with pytest.raises(DataError, match="no column of numbers"):
            item.components(name)


def test_what_stands_out_of_its_lot_and_what_was_held_short_is_named():
    rows = [
        {"lot": lot, "k_end_N_per_m": mean + NormalDist().inv_cdf((i + 0.5) / 20)}
        for lot, mean in (("A", 100.0), ("B", 200.0))
        for i in range(20)
    ]
    rows[3] |= {"k_end_N_per_m": 109.0, "hold_s": 37.9}
    rows[25] |= {"k_end_N_per_m": 185.0}
    rows[26] |= {"hold_s": 38.1}
    lot = make_lot(rows)
    # what was held short is another quantity: neither among the others nor one of them
    assert [(file, away < 0) for file, away in lot.outliers()] == [("25.csv", True)]
    assert lot.short_holds == ("3.csv",)
    assert lot.dissimilar == {"3.csv": "held for 37.9 s, its lot 40 s"}
    few = [{"k_end_N_per_m": value} for value in (1.0, 1.1, 0.9, 1.2, 1.6)]
    assert make_lot(few).outliers() == ()


def test_the_table_goes_to_a_spreadsheet_without_formulas():
    rows = [{"file": name, "k_end_N_per_m": -1.5} for name in ("=1+1", "-2", "@a", "+b", "a=b")]
    byline, *lines = make_lot(rows).csv().splitlines()
    assert is_ours(byline.encode())
    place = lines[0].split(",").index("file")
    assert [line.split(",")[place] for line in lines[1:]] == ["'=1+1", "'-2", "'@a", "'+b", "a=b"]
    assert "-1.5" in lines[1].split(",")


def format_single_chunks(folder, out):
    """The words that run a batch so, in Python."""
    code = (
        "import sys, dashpot as dp, dashpot.extensions.batch.batch_run as batches;batches.CHUNK=1;"
        f"dp.batch(sys.argv[1], to=sys.argv[2], jobs=2, **{QUICK!r})"
    )
    return [sys.executable, "-c", code, str(folder), str(out)]


@pytest.fixture(scope="module")
def lasts(folder, tmp_path_factory):
    """Seconds of a batch that nobody stops."""
    began = time.monotonic()
    words = format_single_chunks(folder, tmp_path_factory.mktemp("lot"))
    subprocess.run(words, check=True, capture_output=True)
    return time.monotonic() - began


@pytest.fixture
def kill(record_property):
    """Count it, for docs/quality.md."""
    record_property("kills", 1)


def run_and_kill(folder, out, chance, lasts, *, parent):
    """Run a batch; kill it, or its workers, at random."""
    seen = []
    how = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with subprocess.Popen(format_single_chunks(folder, out), **how) as running:
        delay = chance.uniform(0.0, lasts)
        while running.poll() is None:
            time.sleep(delay)
            seen = children(running.pid) or seen
            if parent:
                running.kill()
                break
            if seen and chance.random() < 0.7:
                try:
                    os.kill(chance.choice(seen), signal.SIGKILL)
                except ProcessLookupError:
                    continue
            delay = chance.uniform(0.1, 0.4) * lasts
    until = time.monotonic() + 20
    while any(map(alive, seen)) and time.monotonic() < until:
        time.sleep(0.02)
    assert not any(map(alive, seen)), "a worker outlived its parent"


def killed_and_completed(folder, whole, out, seed, lasts):
    chance = random.Random(seed)  # noqa: S311 -- when to kill
    run_and_kill(folder, out, chance, lasts, parent=seed % 2 == 0)
    parts = [pl.read_parquet(path) for path in out.glob("part-*.parquet")]
    there = sum((entry["outcome"] != "died").sum() for entry in parts)
    again = batch(folder, output=out, jobs=2, **QUICK)
    assert again.computed == 11 - there
    assert as_bytes(again.table) == as_bytes(whole)
    return there


@ON_LINUX
@pytest.mark.once
@pytest.mark.parametrize("seed", range(2))
def test_killed_at_random_and_run_again_the_table_is_the_same(
    folder, complete_table, tmp_path, seed, lasts
):
    killed_and_completed(folder, complete_table, tmp_path, seed, lasts)


@ON_LINUX
@pytest.mark.once
@pytest.mark.parametrize("jobs", [1, 2, 7, 64])
@pytest.mark.parametrize("count", [1, 9, 60, 2000])
def test_no_process_waits_for_the_last_chunk_of_another(count, jobs):
    result = batch_run._split_into_chunks(range(count), jobs)
    assert [item for chunk in result for item in chunk] == list(range(count))
    sizes = [len(chunk) for chunk in result]
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[0] <= batch_run.CHUNK
    assert len(sizes) >= min(jobs, count)
    assert max(sizes[-jobs:]) <= batch_run._LAST_CHUNK_FILES


@pytest.mark.once
def test_the_first_chunk_counts_the_others_of_its_round_and_later_ones_no_start():
    """Two workers that start in 1 s, then take 1 s for a chunk of 5 tests."""
    first = (5, 2.0)
    assert batch_run.estimate_rate(first, first, 1, 2) == 5.0
    assert batch_run.estimate_rate(first, (10, 2.0), 2, 2) == 5.0
    assert batch_run.estimate_rate(first, (15, 3.0), 3, 2) == 10.0


@pytest.mark.once
def test_batch_reports_saved_rows_when_the_disk_is_full(folder, tmp_path, monkeypatch):
    def full(*_of):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(batch_run, "write_part", full)
    with pytest.raises(ExportError, match=r"lot: No space left on device: 0 of \d+ rows are made"):
        batch(folder, output=tmp_path / "lot", jobs=1, **QUICK)


def test_interrupted_batch_reports_saved_rows_and_resumes(folder, complete_table, tmp_path):
    """As a terminal does it: all its processes get the signal."""
    code = (
        "import sys, dashpot.extensions.batch.batch_run as batches; from dashpot.cli import main;"
        "batches.CHUNK = 1; main(sys.argv[1:])"
    )
    words = [sys.executable, "-c", code, "batch", str(folder), "-o", str(tmp_path), "--jobs", "2",
             "--label-pattern", BY, "--arms", "1", "--quick"]  # fmt: skip
    how = {"stderr": subprocess.PIPE, "start_new_session": True, "text": True}
    with subprocess.Popen(words, stdout=subprocess.DEVNULL, **how) as running:
        while len(list(tmp_path.glob("part-*"))) < 2 and running.poll() is None:
            time.sleep(0.01)
        os.killpg(running.pid, signal.SIGINT)
        record = running.stderr.read()
    retained = len(list(tmp_path.glob("part-*")))
    assert running.returncode == 130
    assert record.lstrip() == (
        f"dashpot: interrupted: {retained} of 11 rows are made and kept in {tmp_path}, and the "
        "same command goes on from there\n"
    )
    again = batch(folder, output=tmp_path, jobs=1, **QUICK)
    assert again.computed == 11 - retained
    assert as_bytes(again.table) == as_bytes(complete_table)


@ON_LINUX
@pytest.mark.slow
@pytest.mark.usefixtures("kill")
@pytest.mark.parametrize("seed", range(100, 150))
def test_killed_fifty_times_the_table_is_the_same(folder, complete_table, tmp_path, seed, lasts):
    killed_and_completed(folder, complete_table, tmp_path, seed, lasts)


def test_the_results_may_lie_among_the_tests(folder, tmp_path):
    for i in range(3):
        shutil.copy(folder / f"lotA_seal{i}_rep0.csv", tmp_path)
    for computed in (3, 0):
        lot = batch(tmp_path, output=tmp_path, jobs=1, **QUICK)
        assert (lot.outcomes, lot.computed) == ({"fitted": 3}, computed)


def test_batch_reports_a_read_only_folder_before_computing(folder, tmp_path, monkeypatch):
    def read_only(**_how):
        raise OSError(30, "Read-only file system")

    monkeypatch.setattr(parts, "NamedTemporaryFile", read_only)
    with pytest.raises(ExportError, match="cannot be written to: Read-only file system; give"):
        batch(folder, output=tmp_path, **QUICK)


@ON_LINUX
def test_batch_has_a_row_for_a_file_that_kills_workers_and_retries_it(
    folder, complete_table, tmp_path
):
    """The worker is made to leave at one file, as one would that ran out of memory."""
    deadly = tmp_path / "site"
    deadly.mkdir()
    (deadly / "sitecustomize.py").write_text(
        "import os, sys\n"
        "def hook(event, args):\n"
        "    if event == 'open' and str(args[0]).endswith('lotA_seal1_rep0.csv'):\n"
        "        open(os.environ['DEATHS'], 'a').write('x')\n"
        "        os._exit(9)\n"
        "if 'rows_worker' in ' '.join(sys.orig_argv):\n"
        "    sys.addaudithook(hook)\n"
    )
    deaths, out = tmp_path / "deaths", tmp_path / "lot"
    path = os.pathsep.join(filter(None, (str(deadly), os.environ.get("PYTHONPATH"))))
    code = f"import dashpot as dp; dp.batch({str(folder)!r}, to={str(out)!r}, jobs=1, **{QUICK!r})"
    env = {**os.environ, "PYTHONPATH": path, "DEATHS": str(deaths)}
    subprocess.run([sys.executable, "-c", code], env=env, check=True)
    assert deaths.read_text() == "x" * MAX_LOST_WORKERS
    parquet = pl.read_parquet(out / "*.parquet")
    assert row_of(parquet, "lotA_seal1_rep0.csv")["outcome"] == "died"
    assert f"died {MAX_LOST_WORKERS} times" in row_of(parquet, "lotA_seal1_rep0.csv")["reason"]
    assert sum(parquet["outcome"] == "fitted") == 7
    again = batch(folder, output=out, jobs=1, **QUICK)
    assert again.computed == 1
    assert as_bytes(again.table) == as_bytes(complete_table)


def test_the_command_prints_logs_and_judges(folder, tmp_path):
    out = tmp_path / "lot"
    words = ["batch", folder, "-o", out, "--arms", 1, "--quick", "--label-pattern", BY]
    plan = run_json(*words, "--dry-run", "--jobs", 2)
    assert (plan["files"], plan["done"], plan["chunks"], plan["jobs"]) == (11, 0, 3, 2)
    assert plan["seconds"] > 0
    assert not out.exists()
    assert run_json(*words, "--jobs", 2)["outcomes"] == {"fitted": 8, "refused": 2, "other": 1}
    assert len((out / "lot.csv").read_text().splitlines()) == 13
    log = (out / "batch.log").read_text().splitlines()
    assert len(log) == 3
    assert " 11 of 11 tests" in log[-1]
    strict = ran(*words, "--strict", "-v")
    assert strict.exit_code == 1
    assert "0 now, 11 taken from an earlier run" in strict.stdout
    assert "it is a hammer test: say of which test" in " ".join(strict.stdout.split())
    plan = run_json(*words, "--dry-run")
    assert (plan["done"], plan["chunks"], plan["seconds"]) == (11, 0, 0)
    good = [*words[:1], folder / "lotA_seal0_rep0.csv", *words[2:], "--strict", "--jobs", 1]
    assert ran(*good).exit_code == 0


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        ({"quick": True}, "--quick needs the number of arms"),
        ({"mass": 0.0}, "expected a number > 0"),
        ({"seals": float("nan")}, "expected a number > 0"),
        ({"jobs": 0}, "a number of processes >= 1"),
        ({"label_pattern": "("}, "no regular expression"),
        ({"label_pattern": "lot"}, "0 groups"),
        ({"label_pattern": "(a)(b)(c)(d)(e)(f)"}, "6 groups"),
        ({"label_pattern": "(?P<batch>a)"}, "batch"),
        ({"label_pattern": r"(nowhere)"}, "fits none of 11 paths"),
    ],
)  # fmt: skip
def test_a_choice_that_makes_no_sense_is_refused(folder, tmp_path, inputs, message):
    with pytest.raises(DataError, match=message):
        batch(folder, output=tmp_path / "lot", **inputs)
    assert not (tmp_path / "lot").exists()


def test_batch_refuses_a_foreign_folder_and_a_second_run(folder, tmp_path):
    (tmp_path / "sales.parquet").write_bytes(b"PAR1")
    with pytest.raises(ExportError, match=r"sales\.parquet was not written by dashpot batch"):
        batch(folder, output=tmp_path, **QUICK)
    file = tmp_path / "file"
    file.write_text("x")
    with pytest.raises(ExportError, match="is a file; give a folder"):
        batch(folder, output=file, **QUICK)
    with pytest.raises(ExportError, match=r"lot: cannot be written to: .*; give another place"):
        batch(folder, output=file / "lot", **QUICK)
    out = tmp_path / "lot"
    with batch_run.lock_results_folder(out), pytest.raises(DataError, match="in use by another"):
        batch(folder, output=out, **QUICK)


def test_a_path_that_names_nothing_is_refused(tmp_path):
    for path in ("nowhere.csv", "*.none"):
        with pytest.raises(ReadError, match=r"no such file|fits no file"):
            batch(tmp_path / path, **QUICK)
    with pytest.raises(ReadError, match="no file is there"):
        batch(tmp_path, **QUICK)


def test_texts_and_pictures_of_a_folder_are_ignored_by_name(folder, tmp_path):
    shutil.copy(folder / "lotA_seal0_rep0.csv", tmp_path)
    (tmp_path / "readme.txt").write_text("Five seals of batch 7.\nMeasured on 3 Nov 2026 by K.\n")
    (tmp_path / "photo.jpg").write_bytes(b"\xff\xd8\xff\xe0")
    (tmp_path / "cut.txt").write_text("time;displacement;force\n")
    lot = batch(tmp_path, output=tmp_path / "lot", jobs=1, **QUICK)
    assert lot.outcomes == {"ignored": 2, "fitted": 1, "refused": 1}
    assert {Path(file).name for file in lot.ignored_files} == {"readme.txt", "photo.jpg"}
    assert lot.checks[0].message.startswith("1 of 2 files")


@pytest.mark.parametrize("form", ["folder", "pattern", "names"])
def test_batch_ignores_programs_and_documents_by_their_ending(folder, tmp_path, form):
    """`batch *`, as a shell expands it, counted each as a test that failed."""
    shutil.copy(folder / "lotA_seal0_rep0.csv", tmp_path)
    names = ("evaluate.py", "evaluate.m", "evaluate.ipynb", "rig.INI", "report.pdf", "run.bat")
    for name in names:
        (tmp_path / name).write_text("1, 2, 3\n")
    paths = {
        "folder": [tmp_path],
        "pattern": [tmp_path / "*"],
        "names": sorted(tmp_path.iterdir()),
    }[form]
    lot = batch(paths, output=tmp_path / "lot", jobs=1, **QUICK)
    assert lot.outcomes == {"ignored": len(names), "fitted": 1}
    assert {Path(file).name for file in lot.ignored_files} == set(names)


def test_csv_begins_with_the_verdict_and_has_no_empty_column(folder, tmp_path):
    for i in range(2):
        shutil.copy(folder / f"lotA_seal{i}_rep0.csv", tmp_path)
    lot = batch(tmp_path, output=tmp_path / "lot", jobs=1, **QUICK)
    rows = list(csv.DictReader(lot.csv().splitlines()[1:]))
    names = list(rows[0])
    assert names[:5] == ["file", "lot", "seal", "repeat", "kind"]
    assert names[-2:] == ["sha256", "key"]
    assert "k_end_N_per_m" in names
    assert "cld_force_N" not in names
    always = {"file", "kind", "outcome", "verdict", "reason"}
    assert all(any(row[name] for row in rows) for name in set(names) - always)
