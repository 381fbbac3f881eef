"""Kinds fitted without a second test in the app: same result as the command, same questions."""

import json
import shlex

import pytest
from kit.shell import ran

import dashpot as dp
from dashpot import workflow
from dashpot.extensions.app import view_models, wire_format
from dashpot.extensions.app.handler_registry import VERBS
from dashpot.extensions.app.page_form import get_form
from dashpot.extensions.app.upload_store import Store
from dashpot.registry import KINDS

pytestmark = pytest.mark.once

PIECES = ("cld_1.csv", "cld_2.csv", "cld_3.csv")
FORMS = {
    "cld": (PIECES, {"compression": "6", "compression_limits": "4 to 8", "length": "100 mm"}),
    "stress-strain": (("tension.csv", "biaxial.csv"), {"test 1": "biaxial"}),
    "csr": (("ovens.csv",), {"use_at": "85", "oven": "1"}),
    "drop": (("slam.csv",), {"mass": "100"}),
    "rod": (("rod.csv",), {"mass": "31.4", "density": "1000", "disc": "20, 20"}),
    "indentation": (("hit.csv",), {"mass": "5", "radius": "5", "drop_height": "51"}),
}
DEAR = {"indentation", "rod"}


@pytest.fixture(scope="module")
def store():
    store = Store()
    yield store
    store.remove()


def put(store, names):
    return [store.put(name, workflow.EXAMPLES[name]().encode()) for name in names]


def ask(verb, store, **request):
    return wire_format.decode_message(VERBS[verb](request, store.folder))[0]


@pytest.mark.parametrize(
    "kind", [pytest.param(item, marks=[pytest.mark.slow] * (item in DEAR)) for item in FORMS]
)
def test_app_and_command_give_the_same_result_for_a_kind(store, tmp_path, monkeypatch, kind):
    names, message = FORMS[kind]
    files = put(store, names)
    monkeypatch.chdir(tmp_path)
    for name in names:
        (tmp_path / name).write_text(workflow.EXAMPLES[name]())
    row = ask("inspect", store, file=files[0])
    assert row["mark"] == "good"
    assert kind == "rod" or (
        row["page"] == "standalone"
        and row["form_fields"] == view_models.make_form_fields(get_form(kind))
    )
    head = ask("standalone", store, kind=kind, files=files, form_values=message)
    assert {"good", "care", "bad"} >= {head["colour"]}
    assert all(head[name] for name in ("figures", "answers", "checks", "facts"))
    assert 'class="lights"' in head["verdict"]
    typed = ran(*shlex.split(head["command"])[1:], "--json")
    assert typed.exit_code == 0, typed.output
    taken = json.loads(
        ask("take-standalone", store, kind=kind, files=files, form_values=message)["text"]
    )
    assert taken == json.loads(typed.stdout)


def test_every_kind_of_the_register_has_a_place_on_the_page():
    nowhere = {name for name, kind in KINDS.items() if not kind.app_section}
    # a sweep over temperature and one frequency are fitted by no command; a plug-in is typed
    assert nowhere == {
        "temperature-sweep",
        "single-frequency",
        "rod",
        "plug-in",
        "preload-map",
    }


def test_app_asks_for_missing_input_in_words_of_the_page(store):
    for kind, names, words in (
        ("indentation", ["hit.csv"], "moving mass is not given"),
        ("rod", ["rod.csv"], "the shape is not given"),
        ("cld", [], "open one first"),
        ("relaxation", ["seal_8mm.csv"], "no kind of test that is fitted by itself"),
    ):
        with pytest.raises(dp.DataError, match=words) as error:
            ask("standalone", store, kind=kind, files=put(store, names), form_values={})
        assert "--" not in str(error.value)


@pytest.mark.parametrize("place", ["/etc/passwd", "../secret.csv", "C:\\\\secret.csv"])
def test_app_refuses_a_door_that_names_a_file_outside_its_folder(store, place):
    text = workflow.EXAMPLES["door.toml"]().replace("door_line.csv", place)
    identity = store.put("door.toml", text.encode())
    with pytest.raises(dp.ReadError, match="names a file elsewhere"):
        ask("standalone", store, kind="door", files=[identity], form_values={})


def test_a_door_stands_on_the_files_that_are_open(store):
    files = put(store, ["door.toml", "door_line.csv", "door_modes.csv"])
    assert ask("inspect", store, file=files[0])["page"] == "standalone"
    assert ask("inspect", store, file=files[1])["page"] == "part"
    (test,) = put(store, ["seal_8mm.csv"])
    head = ask("standalone", store, kind="door", files=files, form_values={}, test=test)
    assert "27.3" in head["verdict"] + head["answers"]
    assert head["command"] == "dashpot predict door.toml"
    # as its own page: the line, the response, the modes with their shares as bars, the shapes
    titles = [title for title, *_ in head["figures"]]
    assert titles[2:] == ["Modes: who holds, who loses", "Shapes, from outside"]
    shown = {title: html for title, html, _ in head["figures"]}
    assert shown["Modes: who holds, who loses"].count('class="shares"') == 2 * 9
    assert shown["Shapes, from outside"].count("<div><svg") == 6
    # no light is calmer than the verdict
    assert head["colour"] == "care"
    assert head["verdict"].count("#i-care") == 2
    with pytest.raises(dp.DashpotError):  # without the fit that it names
        ask("standalone", store, kind="door", files=files, form_values={})
