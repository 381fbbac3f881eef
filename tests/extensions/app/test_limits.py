"""Limits and machine files in the app: same outcome as the command, and nothing else is read."""

import json
import re
import shlex

import pytest
from kit.shell import ran

from dashpot import workflow
from dashpot.base.errors import ReadError
from dashpot.extensions.app import wire_format
from dashpot.extensions.app.handler_registry import VERBS
from dashpot.extensions.app.upload_store import Store

pytestmark = pytest.mark.once

LIMIT_FILE = '[frequency]\nlower = "12Hz"\n[damping]\nlower = "3%"\n'


@pytest.fixture(scope="module")
def store():
    store = Store()
    yield store
    store.remove()


@pytest.fixture
def home(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("DASHPOT_STATE", str(tmp_path / "state"))
    return tmp_path


def put(store, home, *names, text=None):
    """The identities of example files, or of one with that text, which also stand in the folder."""
    for name in names:
        (home / name).write_text(workflow.EXAMPLES[name]() if text is None else text)
    return [store.put(name, (home / name).read_bytes()) for name in names]


def ask(verb, store, **request):
    return wire_format.decode_message(VERBS[verb](request, store.folder))[0]


def outcomes(html):
    return re.findall(r"(met|missed|open)</span>", html)


def test_limits_of_a_page_have_the_outcomes_of_its_command(store, home):
    seal, hammer = put(store, home, *workflow.FIRST)
    (stated,) = put(store, home, "limits.toml", text=LIMIT_FILE)
    job = {"relaxation": seal, "impact": [hammer], "mass": "114.8g", "seals": 2}
    limits = {"typed": ["stiffness at 40s >= 0.18N/mm", " "], "files": [stated]}
    head = ask("study", store, job=job, limits=limits)
    typed = ran(*shlex.split(head["command"])[1:], "--json")
    acceptance = json.loads(typed.stdout)["acceptance"]
    assert outcomes(head["limits"]["html"]) == [limit["outcome"] for limit in acceptance["limits"]]
    assert len(acceptance["limits"]) == 3
    assert not head["limits"]["refusal"]
    assert head["verdict"] == ask("study", store, job=job)["verdict"]
    report = ask("take", store, job=job, limits=limits, what="report")["text"]
    assert head["limits"]["html"].split("<p")[0] in report


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("damping", "is no limit; expected a quantity"),
        ("limits.toml", "is no limit; expected a quantity"),
        ("weight >= 3%", "is no value of this result"),
        ("damping >= 3", "would be 300 %"),
        ("k_end >= 3s", "k_end"),
    ],
)
def test_a_refused_limit_leaves_the_verdict_and_says_why(store, home, text, word):
    (seal,) = put(store, home, "seal_8mm.csv")
    (home / "limits.toml").write_text(LIMIT_FILE)
    job = {"relaxation": seal, "mass": "114.8g", "seals": 2}
    head = ask("study", store, job=job, limits={"typed": [text]})
    assert word in head["limits"]["refusal"]
    assert not head["limits"]["html"]
    assert "--limit" not in head["command"]
    assert "word" in head["verdict"]


def test_a_fault_of_a_limit_file_has_its_name_and_no_folder(store, home):
    (seal,) = put(store, home, "seal_8mm.csv")
    (stated,) = put(store, home, "limits.toml", text='[weight]\nlower = "3kg"\n')
    head = ask("study", store, job={"relaxation": seal}, limits={"files": [stated]})
    assert head["limits"]["refusal"].startswith("limits.toml, [weight]")
    assert str(store.folder) not in head["limits"]["refusal"]


def test_a_limit_of_a_life_is_shown_as_it_was_stated(store, home):
    files = put(store, home, "ovens.csv")
    limits = {"typed": ["life >= 295000 h"]}
    message = {"use_at": "40"}
    head = ask("standalone", store, kind="csr", files=files, form_values=message, limits=limits)
    html = head["limits"]["html"].replace("\N{NO-BREAK SPACE}", " ")
    assert "at least 295000 h" in html
    (low,) = re.findall(r'"n low">([\d.e]+)<', html)
    # the end is below the limit, and is not rounded to above it
    assert outcomes(html) == ["open"]
    assert float(low) < 295000
    taken = ask(
        "take-standalone", store, kind="csr", files=files, form_values=message, limits=limits
    )
    assert json.loads(taken["text"])["acceptance"]["limits"][0]["outcome"] == "open"


def test_a_machine_file_is_the_machine_of_the_job_and_names_its_age(store, home):
    blanks = ("rig_stop.csv", "rig_spring.csv", "rig_empty.csv")
    files = put(store, home, *blanks)
    for file in files:
        row = ask("inspect", store, file=file, options={"kind": "blank"})
        assert (row["page"], row["mark"]) == ("standalone", "good")
    message, options = {"spring_stiffness": "1"}, {"kind": "blank"}
    head = ask("standalone", store, kind="blank", files=files, form_values=message, options=options)
    assert head["colour"] == "good"
    assert ran(*shlex.split(head["command"])[1:], "-o", "rig.toml").exit_code == 0
    saved = ask(
        "take-standalone", store, kind="blank", files=files, form_values=message, options=options
    )
    assert saved["text"] == (home / "rig.toml").read_text()
    (rig,) = put(store, home, saved["name"], text=saved["text"])
    row = ask("inspect", store, file=rig)
    assert row["page"] == "machine"
    assert re.fullmatch(r"machine file, measured \d{4}-\d\d-\d\d \(today\)", row["line"])
    (seal,) = put(store, home, "rig_seal.csv")
    result = ask("study", store, job={"relaxation": seal, "machine": rig})
    assert result["command"] == "dashpot report rig_seal.csv --machine rig.toml"
    job = {"relaxation": seal, "machine": rig}
    report = ask("take", store, job=job, what="report")["text"]
    assert "machine file rig.toml" in report
    ask("project", store, job=job, folder=str(home / "door"))
    with pytest.raises(ReadError, match=r"was fitted with machine file rig\.toml"):
        ask("folder", store, folder=str(home / "door"))


def test_tables_of_a_toml_file_decide_its_kind(store, home):
    (door,) = put(store, home, "door.toml")
    (limits,) = put(store, home, "limits.toml", text=LIMIT_FILE)
    (broken,) = put(store, home, "rig.toml", text="[machine]\ngain = 3\n")
    assert ask("inspect", store, file=door)["kind"] == "door"
    assert ask("inspect", store, file=limits)["kind"] == "limits"
    with pytest.raises(ReadError, match=r"rig\.toml: gain"):
        ask("inspect", store, file=broken)
