"""Folders opened on the page: which files it reads and which it never reads."""

import json
import os
from dataclasses import fields, replace
from pathlib import Path

import pytest

import dashpot as dp
from dashpot.datamodel.machine import Machine
from dashpot.datamodel.specimen import Specimen
from dashpot.extensions.app import recent, wire_format
from dashpot.extensions.app.handler_registry import VERBS
from dashpot.extensions.app.request_parsing import build_job, describe_job
from dashpot.extensions.app.upload_store import Store, find_file
from dashpot.extensions.batch.batch_run import batch
from dashpot.extensions.projects.history import append
from dashpot.extensions.projects.project import create, record
from dashpot.reading.read_options import ReadOptions
from dashpot.reading.write import write_relaxation
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import BROAD
from dashpot.workflow.job import HammerChoices, Job, TimeLimits

pytestmark = pytest.mark.once


@pytest.fixture(autouse=True)
def state(tmp_path, monkeypatch):
    place = tmp_path / "state"
    monkeypatch.setenv("DASHPOT_STATE", str(place))
    return place


@pytest.fixture
def store(tmp_path):
    (tmp_path / "store").mkdir()
    return Store(tmp_path / "store")


def ask(verb, store, **request):
    return wire_format.decode_message(VERBS[verb](request, store.folder))[0]


@pytest.fixture(scope="module")
def text():
    rig = replace(Rig(), rate=100.0)
    return write_relaxation(simulate_relaxation(BROAD, rig=rig, hold_time=10.0).test)


@pytest.fixture
def project(tmp_path, text):
    """A project with one test; its job, and its folder."""
    (tmp_path / "seal.csv").write_text(text)
    job = Job(
        str(tmp_path / "seal.csv"), arms=2, time_limits=TimeLimits(hold_end=11.0), mass=0.1148,
        seals=2.0,
        specimen=Specimen(length=0.05, name="A", temperature=296.15),
    )  # fmt: skip
    home = create(tmp_path / "door")
    record(home, job, page=lambda _: "")
    return job, home.folder


def test_opened_project_restores_its_job(store, project):
    job, folder = project
    head = ask("folder", store, folder=str(folder))
    (test,) = head["tests"]
    message = head["job"] | {
        "relaxation": test["id"], "reading": head["reading"], "joint": head["joint"],
        "specimen": head["job"]["specimen"] | {"temperature": head["temperatures"][0]},
    }  # fmt: skip
    again = build_job(message, store.folder)
    assert replace(again, relaxation=job.relaxation) == job
    assert Path(again.relaxation).read_bytes() == Path(job.relaxation).read_bytes()
    assert ask("recent", store)["recent"][0]["folder"] == str(folder)


def test_a_page_says_a_job_as_the_job_is(store, text):
    test = store.put("a.csv", text.encode())
    whole = Job(
        str(find_file(store.folder, test)), mass=1 / 3, seal_mass=1e-3, compression=2.6e-3,
        seals=1.5,
        arms=3, method="hold", law="linear", family="auto", band=(5.0, 40.1), filter="median:5",
        title="A title", joint=False, time_limits=TimeLimits(1.0, 2.0, 3.0),
        machine=Machine(sync=5e-4, compliance=3e-5),
        hammer=HammerChoices(reject=("2",), polarity=(1, -1)),
        reading=ReadOptions(units={"force": "gf"}, skip_rows=2),
        reading_impact=ReadOptions(acceleration=("3", "4")),
    )  # fmt: skip
    page = describe_job(whole)
    answer = json.loads(json.dumps(page))
    requested = answer["job"] | {"relaxation": test} | {
        name: answer[name] for name in ("joint", "reading", "reading_impact")
    }  # fmt: skip
    assert build_job(requested, store.folder) == whole
    expected = {"relaxation", "other_tests", "impact", "temperatures", "impact_temperature", "logo"}
    assert {field.name for field in fields(Job)} - expected <= set(requested)


def test_a_project_that_names_a_file_outside_gives_none(store, project, tmp_path):
    _, folder = project
    (tmp_path / "secret.csv").write_text("secret")
    lines = (folder / "history.jsonl").read_text().splitlines()
    forged = json.loads(lines[-1])["job"] | {"relaxation": "../secret.csv"}
    append(folder, {"operation": "report", "job": forged, "inputs": [], "outputs": []})
    with pytest.raises(dp.ReadError, match="leads out of the project"):
        ask("folder", store, folder=str(folder))
    (folder / "raw" / "link.csv").symlink_to(tmp_path / "secret.csv")
    append(
        folder,
        {"operation": "report", "job": forged | {"relaxation": "raw/link.csv"}, "inputs": [],
         "outputs": []},
    )  # fmt: skip
    with pytest.raises(dp.ReadError, match="leads out of the project"):
        ask("folder", store, folder=str(folder))
    assert not list(store.folder.rglob("secret*"))


def test_a_history_that_was_edited_is_not_opened(store, project):
    _, folder = project
    log = folder / "history.jsonl"
    log.write_text(log.read_text().replace('"arms": 2', '"arms": 3'))
    with pytest.raises(dp.DataError, match="dashpot verify"):
        ask("folder", store, folder=str(folder))


@pytest.mark.parametrize(
    ("folder", "message"),
    [(None, "no folder is named"), ("  ", "no folder is named"), ("nowhere", "is no folder"),
     ("state", "neither a project")],
)  # fmt: skip
def test_what_is_no_such_folder_says_so(store, tmp_path, monkeypatch, folder, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "state").mkdir()
    with pytest.raises(dp.DashpotError, match=message):
        ask("folder", store, folder=folder)
    assert not recent.list_recent_folders()


def test_a_lot_shows_its_table_and_opens_the_tests_that_it_knows(store, tmp_path, text):
    pytest.importorskip("polars")
    tests = tmp_path / "tests"
    tests.mkdir()
    (tests / "lot1_seal1.csv").write_text(text)
    (tests / "noise.csv").write_text("no table\nat all\n")
    made = batch(
        tests, output=tmp_path / "lot", arms=2, label_pattern=r"lot(\w+)_seal(\w+)", jobs=1
    )
    head = ask("folder", store, folder=str(tmp_path / "lot"))
    assert head["kind"] == "lot"
    for name in head["columns"]:
        assert [row[head["columns"].index(name)] for row in head["rows"]] == list(made.table[name])
    hashes = dict(zip(made.table["file"], made.table["sha256"], strict=True))
    wanted = hashes[str(tests / "lot1_seal1.csv")]
    row = ask("row", store, folder=str(tmp_path / "lot"), sha256=wanted)
    job = row["job"] | {"relaxation": row["files"][0]["id"]}
    fit = json.loads(ask("take", store, job=job, what="fit")["text"])
    result = made.table.filter(made.table["sha256"] == wanted).row(0, named=True)
    assert fit["model"]["k_inf"] == result["k_inf_N_per_m"]
    # of k_inf a test alone says the most: a fit's document writes 0 below it, a table nothing
    assert fit["interval_95"]["k_inf"] == [0.0, result["k_inf_high_N_per_m"]]
    assert result["k_inf_low_N_per_m"] is None
    with pytest.raises(dp.DataError, match="no test with that hash"):
        ask("row", store, folder=str(tmp_path / "lot"), sha256="../../etc/passwd")
    (tests / "lot1_seal1.csv").write_text("something else")
    with pytest.raises(dp.ReadError, match="not what it was"):
        ask("row", store, folder=str(tmp_path / "lot"), sha256=wanted)


def test_rows_of_one_file_open_the_specimen_that_each_is_of(store, tmp_path):
    pytest.importorskip("polars")
    lines = ["Specimen,Time [s],Displacement [mm],Force [N]"]
    for label, seal in (("A", BROAD), ("B", replace(BROAD, k_inf=2 * BROAD.k_inf))):
        rig = replace(Rig(), rate=100.0)
        test = write_relaxation(simulate_relaxation(seal, rig=rig, hold_time=10.0).test)
        lines += [f"{label},{line}" for line in test.splitlines() if line[:1].isdigit()]
    (tmp_path / "pair.csv").write_text("\n".join(lines) + "\n")
    made = batch([tmp_path / "pair.csv"], output=tmp_path / "lot", arms=2, jobs=1)
    entries = list(made.table.iter_rows(named=True))
    assert [entry["part"] for entry in entries] == ["segment=1", "segment=2"]
    identities = set()
    for entry in entries:
        names = {"sha256": entry["sha256"], "part": entry["part"]}
        head = ask("row", store, folder=str(tmp_path / "lot"), **names)
        (file,) = head["files"]
        identities.add(file["id"])
        job = head["job"] | {"relaxation": file["id"], "reading": file["options"]}
        fit = json.loads(ask("take", store, job=job, what="fit")["text"])
        assert fit["model"]["k_inf"] == entry["k_inf_N_per_m"]
        assert entry["file"].endswith(f"[{entry['part']} {file['specimen']}]")
    # the page asks of a file that is opened by the same identities
    first = store.put("pair.csv", (tmp_path / "pair.csv").read_bytes())
    requested = ask("inspect", store, file=first, options={})["specimens"]
    assert {item["id"] for item in requested} == identities
    with pytest.raises(dp.DataError, match="no test with that hash"):
        ask("row", store, folder=str(tmp_path / "lot"), sha256=entries[0]["sha256"])


def test_a_page_names_no_file_of_the_machine(store, text):
    test = store.put("a.csv", text.encode())
    with pytest.raises(dp.DataError, match="no calibration"):
        ask("inspect", store, file=test, options={"calibration": "/etc/passwd"})
    with pytest.raises(dp.DataError, match="no calibration"):
        build_job({"relaxation": test, "reading": {"calibration": "x.cal"}}, store.folder)
    with pytest.raises(dp.ReadError, match="no longer here"):
        build_job({"relaxation": test, "logo": "/etc/passwd"}, store.folder)


def test_the_list_of_folders_bears_what_happens_to_it(state, tmp_path):
    assert recent.list_recent_folders() == []
    for i in range(recent.MAX_FOLDERS + 2):
        (tmp_path / f"p{i}").mkdir()
        recent.add_recent_folder(tmp_path / f"p{i}")
    recent.add_recent_folder(tmp_path / "p5")
    names = [list_recent_folder["name"] for list_recent_folder in recent.list_recent_folders()]
    assert names[:2] == ["p5", f"p{recent.MAX_FOLDERS + 1}"]
    assert len(names) == recent.MAX_FOLDERS
    (tmp_path / "p5").rmdir()
    assert recent.list_recent_folders()[0]["name"] == f"p{recent.MAX_FOLDERS + 1}"
    for text in ("", "[1]", "{", '[{"folder": 3}]'):
        (state / "recent.json").write_text(text)
        assert recent.list_recent_folders() == []
    os.environ["DASHPOT_STATE"] = str(state / "recent.json")  # a file where a folder should be
    recent.add_recent_folder(tmp_path)
    assert recent.list_recent_folders() == []
