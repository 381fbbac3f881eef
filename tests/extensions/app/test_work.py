"""Request handlers: the same numbers as the command line, digit for digit."""

import io
import json
import re
import shlex
import zipfile
from base64 import b64decode
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from kit import handmade, shell
from kit.fits import replace_fields
from kit.shell import ran

import dashpot as dp
from dashpot import workflow
from dashpot.base.checks import Check, Remedy
from dashpot.base.option_fields import RampLawOption, get_choice_values
from dashpot.datamodel.fit_diagnostics import Explanation
from dashpot.export import SUFFIXES
from dashpot.extensions.app import (
    record_cache,
    request_handlers,
    result_cache,
    view_models,
    wire_format,
)
from dashpot.extensions.app.command_lines import format_job_command
from dashpot.extensions.app.handler_registry import VERBS
from dashpot.extensions.app.request_parsing import build_job
from dashpot.extensions.app.upload_store import Store
from dashpot.fitting.relaxation import fit as fit_tests
from dashpot.preprocessing.prepare import prepare
from dashpot.reading.readers.relaxation import read_relaxation
from dashpot.reading.write import write_relaxation
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import BROAD
from dashpot.solids.elastic import ElasticLaw
from dashpot.workflow import measured_frf
from dashpot.workflow.json_archive import from_json, to_json

pytestmark = pytest.mark.once

AT = {296.15: BROAD, 273.15: BROAD.shift_to_temperature(10**1.498172, 273.15 / 296.15)}


@pytest.fixture(autouse=True)
def _isolate_state_folder(tmp_path, monkeypatch):
    monkeypatch.setenv("DASHPOT_STATE", str(tmp_path / "state"))


@pytest.fixture(scope="module")
def store():
    store = Store()
    yield store
    store.remove()


@pytest.fixture(scope="module")
def files(store):
    return {name: store.put(name, workflow.EXAMPLES[name]().encode()) for name in workflow.FIRST}


@pytest.fixture(scope="module")
def page_job(files):
    """What the page says of both files."""
    return {
        "relaxation": files["seal_8mm.csv"], "impact": [files["hammer.csv"]], "mass": "114.8g",
        "seals": 2, "arms": 2, "time_limits": {"ramp_end": 2.6},
        "specimen": {"temperature": "23degC"},
    }  # fmt: skip


def ask(verb, store, **request):
    head, arrays = wire_format.decode_message(VERBS[verb](request, store.folder))
    return head | {"arrays": arrays}


@pytest.fixture
def working_folder(store, files, tmp_path, monkeypatch):
    """A folder with the files under their own names."""
    for name, identity in files.items():
        (tmp_path / name).write_bytes((store.folder / identity / name).read_bytes())
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run_command(command, *more):
    result = ran(*shlex.split(command)[1:], *more)
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def test_the_fit_is_that_of_the_command_digit_for_digit(store, page_job, working_folder):
    text = json.loads(ask("take", store, job=page_job, what="fit")["text"])
    words = ("--arms", "2", "--time-limits", "ramp-end=2.6s", "--temperature", "23degC")
    assert text == shell.run_json("fit", "seal_8mm.csv", *words)


@pytest.mark.parametrize("joint", [False, True])
def test_the_command_line_gives_the_pages_numbers(store, page_job, working_folder, joint):
    head = ask("study", store, job=page_job | {"joint": joint})
    study = run_command(head["command"], "-o", "r.html", "--json")
    page = result_cache.get_study(build_job(page_job | {"joint": joint}, store.folder))
    mine = json.loads(to_json(page))
    for part in ("fit", "joint", "comparison"):
        assert mine[part] == study[part]


def test_what_is_shown_are_the_digits_of_the_fit(store, page_job):
    head = ask("settle", store, job=page_job)
    fit = from_json(ask("take", store, job=page_job, what="fit")["text"])
    assert f"{1e-3 * fit.model.k[0]:.4f}"[:5] in head["solid"]
    assert fit.verdict.use.capitalize() in head["verdict"]
    assert set(head["panels"]) == {"ramp", "hold", "spectrum", "frf"}
    assert head["simulated"] is True
    assert head["time_limits"]["ramp_end"] == 2.6


def test_another_mass_leaves_the_fit_of_the_tests(store, page_job, monkeypatch):
    fitted, fit_once = [], result_cache.fit_tests
    monkeypatch.setattr(
        result_cache,
        "fit_tests",
        lambda *args, **how: (fitted.append(1), fit_once(*args, **how))[1],
    )
    monkeypatch.setattr(result_cache, "_fitted_tests", {})
    jobs = [build_job(page_job | {"mass": mass}, store.folder) for mass in ("114.5g", "115g")]
    first = result_cache.get_study(jobs[0])
    for place, name in ((record_cache, "read_relaxation"), (result_cache, "read_record"),
                        (measured_frf, "estimate_frf")):  # fmt: skip
        monkeypatch.setattr(place, name, lambda *_, what=name, **__: pytest.fail(what))
    second = result_cache.get_study(jobs[1])
    assert len(fitted) == 1
    assert first.unmeasured is second.unmeasured
    monkeypatch.undo()
    fresh = workflow.run(jobs[1])
    assert to_json(second) == to_json(fresh)
    mass_check = next(c for c in second.measured.checks if c.name == "high_frequency_mass_agrees")
    assert mass_check not in first.measured.checks


def test_another_number_of_arms_fits_the_tests_again(store, page_job, monkeypatch):
    fitted, fit_once = [], result_cache.fit_tests
    monkeypatch.setattr(
        result_cache,
        "fit_tests",
        lambda *args, **how: (fitted.append(1), fit_once(*args, **how))[1],
    )
    monkeypatch.setattr(result_cache, "_fitted_tests", {})
    for arms in (2, 3):
        result_cache.get_study(build_job(page_job | {"mass": "115.5g", "arms": arms}, store.folder))
    assert len(fitted) == 2


def test_record_is_parsed_once_for_all_workers(store):
    text = workflow.EXAMPLES["seal_8mm.csv"]()
    identity = store.put("once.csv", text.encode())
    assert not ask("inspect", store, file=identity)["long"]
    (store.folder / identity / "once.csv").write_text("no table any more")
    result_cache.read_test.cache_clear()  # as another lane would begin
    result_cache.prepare_job_tests.cache_clear()
    job = {"relaxation": identity, "specimen": {"name": "A"}}
    again = json.loads(ask("take", store, job=job, what="fit")["text"])
    fresh = fit_tests(prepare(read_relaxation(store.folder / store.put("once.csv", text.encode())
                                                 / "once.csv")))  # fmt: skip
    assert again["model"] == json.loads(to_json(fresh))["model"]
    assert again["source"] == json.loads(to_json(fresh))["source"]
    assert again["specimen"]["name"] == "A"


def test_inspect_accepts_a_record_with_a_fast_clock(store):
    rig = replace(Rig(), rate=200.0)
    test = simulate_relaxation(BROAD, rig=rig, seed=1).test
    fast = replace(test, time=test.time[0] + (test.time - test.time[0]) / 80)
    identity = store.put("fast.csv", write_relaxation(fast).encode())
    line = ask("inspect", store, file=identity)["line"]
    assert "length of the record" not in line, line


def test_long_record_shows_a_quick_fit_first(store, files, monkeypatch):
    job = {"relaxation": files["seal_8mm.csv"], "arms": 2}
    rows = ask("inspect", store, file=job["relaxation"])
    assert not rows["long"]
    whole = ask("settle", store, job=job, quick=True)
    assert whole["solid"] == ask("settle", store, job=job)["solid"]
    monkeypatch.setattr(result_cache, "MAX_QUICK_SAMPLES", 4000)
    assert ask("inspect", store, file=job["relaxation"])["long"]
    part = ask("settle", store, job=job, quick=True)
    assert part["panels"].keys() == whole["panels"].keys()
    assert part["solid"] != whole["solid"]
    assert ask("settle", store, job=job)["solid"] == whole["solid"]


def test_the_record_is_there_without_a_fit(store, page_job):
    sizes = {"ramp": [260, 200], "hold": [260, 200]}
    drawn = ask("look", store, job=page_job, sizes=sizes)["panels"]
    settled = ask("settle", store, job=page_job, sizes=sizes)["panels"]
    assert all('data-name="fit"' not in html for html in drawn.values())
    # where it will stand upon its fit
    (line,) = re.findall(r'<path[^>]* data-name="measured"[^>]*>', drawn["ramp"])
    assert line in settled["ramp"]
    axes = [re.findall(r'data-[xy]="[^"]*"', item["hold"])[:2] for item in (drawn, settled)]
    assert axes[0] == axes[1]


def test_a_handle_moves_the_curves_within_a_page_of_bytes(store, page_job):
    whole = VERBS["live"]({"job": page_job}, store.folder)
    assert len(whole) < 30_000
    result = ask("live", store, job=page_job)
    assert {"ramp/fit/x", "hold/fit/y", "hold/mean/y"} <= set(result["arrays"])
    assert "eq. (5)" in result["both_fits"]
    later = ask("live", store, job=page_job | {"time_limits": {"hold_end": 20.0}})
    assert later["time_limits"]["hold_end"] == 20.0
    # what it is called and how large it is: the solid's own, after the hold of the cut
    name, size = later["end"]
    after = 20.0 - later["time_limits"]["ramp_end"]
    assert name == f"k after {after:.1f} s"
    cut = build_job(page_job | {"time_limits": {"hold_end": 20.0}}, store.folder)
    specific = result_cache.fit_while_dragging(
        result_cache.select_fit_choices(cut)
    ).solid.relaxation(after)
    assert float(size.removesuffix(" N/mm")) == pytest.approx(specific / 1e3, rel=1e-3)
    assert re.fullmatch(r"rms [\d.]+( mN)?, noise [\d.]+ mN", later["residual_note"])
    assert result["time_limits"]["hold_end"] > 40.0
    # on the axis that is there, which counts from where the ramp ended when it was drawn
    shifted = page_job | {"time_limits": {"ramp_end": 2.6}}
    since = result["time_limits"]["ramp_end"]
    specific, there = (
        ask("live", store, job=shifted, **how)["arrays"] for how in ({}, {"since": since})
    )
    for name in ("hold/fit/x", "hold/mean/x"):
        assert there[name] - specific[name] == pytest.approx(2.6 - since, abs=1e-5)


def test_a_held_handle_is_followed_from_the_cut_before_to_the_fit_of_its_cut(store, page_job):
    """The same optimum, without what a cut does not change: number of arms and law."""
    ask("live", store, job=page_job)
    cut = build_job(page_job | {"time_limits": {"ramp_end": 2.6, "hold_end": 30.0}}, store.folder)
    after = result_cache.fit_while_dragging(result_cache.select_fit_choices(cut))
    anew = result_cache.fit_job(
        result_cache.select_fit_choices(cut), False, result_cache.MAX_PREVIEW_SAMPLES
    )
    assert after.model.tau == pytest.approx(anew.model.tau, rel=1e-6)
    assert after.model.k == pytest.approx(anew.model.k, rel=1e-6)
    law = ElasticLaw((0.0, 4e-3, 8e-3), (0.5, 1.0, 1.5), 100.0)
    item = result_cache.select_fit_choices(cut)
    assert result_cache._can_refit(anew, item)
    assert not result_cache._can_refit(replace(anew, elastic_law=law), item)
    assert not result_cache._can_refit(anew, replace(item, arms=3))
    assert not result_cache._can_refit(anew, replace(item, method="hold"))


def test_a_followed_residual_is_in_the_unit_in_which_it_is_drawn(store, page_job):
    """What a cut makes ten times larger must not become a thousandth of it."""
    size = {
        unit: abs(ask("live", store, job=page_job, unit=unit)["arrays"]["hold/mean/y"]).max()
        for unit in ("N", "mN")
    }
    assert size["mN"] == pytest.approx(1000 * size["N"], rel=1e-5)


def test_of_a_hold_that_is_cut_the_whole_record_stays_in_sight(store, page_job):
    """Its handle goes both ways; what the cut leaves out is hatched."""
    request = {"relaxation": page_job["relaxation"], "arms": 2}
    cut = request | {"time_limits": {"hold_end": 12.0}}
    drawn = [ask("settle", store, job=item)["panels"]["hold"] for item in (request, cut)]
    ends = [float(re.search(r'data-x="log \S+ (\S+)"', item)[1]) for item in drawn]
    assert ends[1] == pytest.approx(ends[0], rel=1e-3)
    hatches = [item.count("<pattern") for item in drawn]
    assert hatches[1] > hatches[0]
    job = build_job(cut, store.folder)
    (short,) = result_cache.prepare_job_tests(result_cache.select_test_choices(job), None)
    assert short.hold_end == 12.0
    assert result_cache.prepare_uncut_test(job, short).time[-1] > 40.0
    uncut = build_job(request, store.folder)
    assert result_cache.prepare_uncut_test(uncut, short) is None


def test_elastic_law_of_a_result_can_be_requested():
    """A handle that is held asks for the law that was settled."""
    bent, straight = (
        SimpleNamespace(elastic_law=ElasticLaw((0.0, 8e-3), ratio, 100.0))
        for ratio in ((0.5, 1.5), (1.0, 1.0))
    )
    result = [
        request_handlers._get_law_option(fit)
        for fit in (bent, straight, SimpleNamespace(elastic_law=None))
    ]
    assert result == ["nonlinear", "linear", ""]
    assert set(result[:2]) <= set(get_choice_values(RampLawOption))


def test_a_response_follows_the_mass(store, page_job):
    light, heavy = (
        ask("predict", store, job=page_job | {"mass": mass}) for mass in ("100g", "200g")
    )
    peaks = [item["arrays"]["frf/predicted/x"][item["arrays"]["frf/predicted/y"].argmax()]
             for item in (light, heavy)]  # fmt: skip
    assert peaks[0] / peaks[1] == pytest.approx(2**0.5, rel=0.02)
    assert len(VERBS["predict"]({"job": page_job}, store.folder)) < 30_000


@pytest.mark.parametrize("joint", [False, True])
def test_a_base_that_moves_is_predicted_as_by_the_command(store, page_job, working_folder, joint):
    job = page_job | {"joint": joint}
    head = ask("study", store, job=job, base=True)
    fit = "joint" if joint else "fit"
    (working_folder / f"{fit}.json").write_text(ask("take", store, job=job, what=fit)["text"])
    shell = run_command(head["command"].splitlines()[1], "--json")
    assert json.loads(ask("take", store, job=job, what="base-json")["text"]) == shell
    assert f"above {shell['isolation_hz']:.2f} Hz" in head["frf"]
    assert f"{shell['peak']['frequency_hz']:.2f} Hz, {shell['peak']['value']:.3g}" in head["frf"]
    lines = ask("take", store, job=job, what="base")["text"]
    assert repr(shell["real"][7]) in lines
    moving = ask("predict", store, job=job, base=True)["arrays"]["frf/predicted/y"]
    assert moving[0] == pytest.approx(1.0, abs=0.15)
    with pytest.raises(dp.DataError, match="no mass"):
        ask("take", store, job={"relaxation": page_job["relaxation"]}, what="base")


@pytest.mark.parametrize(
    ("name", "more"),
    [("sweep.csv", {"arms": 2}), ("sweeps.csv", {}), ("curve.csv", {"temperature": "23degC"})],
)
def test_a_sweep_or_a_modulus_is_fitted_as_by_the_command(store, tmp_path, monkeypatch, name, more):
    text = workflow.EXAMPLES[name]()
    (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    identity = store.put(name, text.encode())
    assert ask("inspect", store, file=identity)["mark"] == "good"
    head = ask("bench", store, file=identity, **more)
    shell = run_command(head["command"], "--json")
    assert json.loads(ask("take-bench", store, file=identity, **more)["text"]) == shell
    scale, unit = (1e-3, "N/mm") if name == "sweep.csv" else (1e-6, "MPa")
    assert unit in head["solid"]
    shown = re.search(r'class="value">([\d.,]+)<', head["solid"])
    assert shown is not None
    # as many digits as its interval warrants
    assert float(shown[1].replace(",", "")) == pytest.approx(
        scale * shell["model"]["k_inf"], rel=0.02
    )
    assert head["figures"]


def test_tests_at_two_temperatures_share_one_model(store, working_folder):
    ids = []
    for name, temperature in (("warm.csv", 296.15), ("cold.csv", 273.15)):
        rig = replace(Rig(), rate=200.0)
        text = write_relaxation(simulate_relaxation(AT[temperature], rig=rig, seed=len(ids)).test)
        (working_folder / name).write_text(text)
        ids.append(store.put(name, text.encode()))
    job = {"relaxation": ids[0], "other_tests": [ids[1]], "temperatures": ["23degC", "0degC"]}
    head = ask("settle", store, job=job)
    words = ("warm.csv", "cold.csv", "--temperature", "23degC", "--temperature", "0degC")
    answer = json.loads(ask("take", store, job=job, what="fit")["text"])
    assert answer == shell.run_json("fit", *words)
    assert len(answer["temperature"]["shifts"]) == 2
    assert head["command"].startswith("dashpot report warm.csv cold.csv")
    with pytest.raises(
        dp.DataError, match="--time-limits cuts one relaxation test, and there are 2 here"
    ):
        ask("settle", store, job=job | {"time_limits": {"hold_end": 20.0}})


def test_a_hammer_without_a_mass_is_no_verdict_yet(store, page_job):
    bare = {key: value for key, value in page_job.items() if key not in {"mass", "seals"}}
    head = ask("study", store, job=bare | {"joint": False})
    assert "test mass" in head["hint"]
    fit = from_json(ask("take", store, job=bare, what="fit")["text"])
    assert fit.verdict.use.capitalize() in head["verdict"]
    assert not ask("study", store, job=page_job | {"joint": False})["hint"]


@pytest.mark.parametrize(
    ("name", "explains", "told"),
    [("mass", True, "115.30"), ("mass and stiffness", True, "115.30"),
     ("gain and stiffness", True, ""), ("mass", False, "")],
)  # fmt: skip
def test_a_mass_is_offered_where_it_explains_both_tests(name, explains, told):
    best = Explanation(name, 0.1153, 2e-4, "kg", 0.04, 900.0, explains, "so")
    study = replace(handmade.study(), joint=replace_fields(handmade.joint(), explanations=(best,)))
    assert view_models.find_explaining_mass(study) == told


@pytest.mark.slow
def test_advice_is_shown_once(store, page_job):
    study = result_cache.get_study(build_job(page_job, store.folder))
    more = view_models.format_next_test(study, ())
    assert study.fit.evidence.end_of_hold.remedy.split(":")[0] in more.replace("\xa0", " ")
    message = Check(
        "told", False, "Not known.", remedy=Remedy(study.fit.evidence.end_of_hold.remedy)
    )
    assert view_models.format_next_test(study, (message,)) == ""


def test_page_offers_the_mass_of_the_frf_next_to_the_verdict(store, page_job):
    """Twice the mass: the page offers that of the FRF; of the right one it offers none."""
    wrong, right = (
        ask("study", store, job=page_job | {"joint": False, "mass": mass})["verdict"]
        for mass in ("229.6g", "114.8g")
    )
    (grams,) = re.findall(r'data-mass="([0-9.]+)g">Set \1 g<', wrong)
    assert float(grams) == pytest.approx(114.8, rel=0.01)
    assert "data-mass" not in right


def test_fractional_model_lists_four_parameters(store, page_job):
    head = ask("settle", store, job=page_job | {"arms": "auto", "family": "fractional"})
    assert head["solid"].count('scope="row"') == 5  # its four, and the end of the hold
    assert "--model fractional" in head["command"]
    assert ask("live", store, job=page_job | {"arms": "auto", "family": "fractional"})["both_fits"]


def test_hit_can_be_rejected_on_the_page(store, page_job):
    rejected = ask("study", store, job=page_job | {"joint": False, "hammer": {"reject": ["2"]}})
    assert "4 of 5 hits" in rejected["hammer"]
    assert "--reject 2" in rejected["command"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"relaxation": ""}, "open one first"),
        ({"relaxation": "../../etc"}, "no longer here"),
        ({"relaxation": "0" * 16}, "no longer here"),
        ({"mass": 0.1148}, "quantity with its unit"),
        ({"mass": "114.8"}, "has no unit"),
        ({"mass": "114.8m"}, "mass"),
        ({"seals": "two"}, "expected a number"),
        ({"arms": -1}, "whole number"),
        ({"arms": True}, "whole number"),
        ({"law": "bent"}, "expected one of"),
        ({"time_limits": {"ramp_begin": 1}}, "has no 'ramp_begin'"),
        ({"time_limits": []}, "expected an object"),
        ({"impact": "hammer"}, "expected a list"),
        ({"temperatures": ["cold", "23degC"]}, "not a quantity"),
        ({"temperatures": ["", "23degC"]}, "1 of 2 tests .* has no temperature"),
        ({"title": 3}, "expected a text"),
        ({"colour": "red"}, "has no 'colour'"),
        ({"reading": {"units": 5}}, "not of the kind"),
    ],
)
def test_job_reports_unknown_fields(store, page_job, change, message):
    with pytest.raises(dp.DashpotError, match=message):
        build_job(page_job | change, store.folder)


@pytest.mark.parametrize("mass", ["0g", "-5g"])
@pytest.mark.parametrize("verb", ["settle", "predict", "study"])
@pytest.mark.parametrize("base", [False, True])
def test_job_reports_an_invalid_mass(store, page_job, mass, verb, base):
    bare = {"relaxation": page_job["relaxation"], "arms": 2, "mass": mass}
    with pytest.raises(dp.DataError, match=r"mass = .* kg; expected a number > 0"):
        ask(verb, store, job=bare, base=base)


def test_a_job_and_its_command_say_the_same(store, page_job):
    more = {
        "compression": "2.6mm", "band": "5:40Hz", "machine": {"sync": "0.5ms"}, "law": "linear",
        "hammer": {"reject": ["3"], "polarity": [1, -1]}, "title": "A seal's title",
    }  # fmt: skip
    words = shlex.split(format_job_command("report", build_job(page_job | more, store.folder)))
    for name in (
        "--compression",
        "2.6mm",
        "5.0:40Hz",
        "sync=0.0005s",
        "linear",
        "-1",
        "A seal's title",
    ):
        assert name in words


def test_a_file_without_units_asks_and_shows_what_each_would_mean(store):
    text = workflow.EXAMPLES["seal_8mm.csv"]().replace("force [N]", "force")
    identity = store.put("bare.csv", text.encode())
    result = ask("inspect", store, file=identity)
    assert result["mark"] == "care"
    assert "With this unit the seal would be" in result["question"]
    answered = ask("inspect", store, file=identity, options={"units": {"force": "N"}})
    assert answered["mark"] == "good"
    profile = ask("profile", store, options={"units": {"force": "N"}})
    assert 'force" = "N"' in profile["text"].replace("'", '"')


def test_tests_over_each_other_begin_at_a_step_after_the_ramp(store):
    """A sample right after the ramp's end would give most of a logarithmic axis to nothing."""
    record = simulate_relaxation(BROAD, seed=3).test
    identity = store.put("early.csv", write_relaxation(record).encode())
    job = {"relaxation": identity, "specimen": {}, "time_limits": {}}
    valid = prepare(record)
    step = float(np.median(np.diff(valid.time)))
    after = valid.time[valid.time > valid.ramp_end]
    job["time_limits"] = {"ramp_end": float(after[0]) - 1e-5 * step}
    text = ask("overlay", store, jobs=[job], sizes={"seals-hold": [800, 300]})
    axis = re.search(r'data-x="log (\S+) ', text["panels"]["seals-hold"])
    assert axis is not None
    assert float(axis[1]) > step / 2


def test_whatever_comes_from_a_file_is_escaped(store):
    text = workflow.EXAMPLES["seal_8mm.csv"]().replace("force [N]", "<script>x</script> [N]")
    result = ask("inspect", store, file=store.put("<i>.csv", text.encode()))
    assert "<script>" not in json.dumps(result, default=str)


@pytest.mark.parametrize("what", ["report", "fit", "picture", "frf"])
def test_what_can_be_taken_away(store, page_job, what):
    text = ask("take", store, job=page_job | {"joint": False}, what=what)
    assert text["name"]
    assert len(text["text"]) > 20


def test_menu_offers_every_solver_input():
    script = Path(request_handlers.__file__).with_name("static") / "app.js"
    (table,) = re.findall(r"const DECKS = {(.*?)\n};", script.read_text("utf-8"), re.DOTALL)
    suggestion = set(re.findall(r"^  (\w+):", table, re.MULTILINE))
    assert suggestion == set(SUFFIXES)


def test_a_deck_is_refused_as_on_the_command_line_and_written_anyway(store, page_job):
    with pytest.raises(dp.ExportError, match="length"):
        ask("take", store, job=page_job, what="deck", target="nastran")
    whole = page_job | {"specimen": {"temperature": "23degC", "length": "100mm"}}
    with pytest.raises(dp.DashpotError, match="no solver"):
        ask("take", store, job=whole, what="deck", target="word")
    assert (
        "OVERRIDE"
        in ask("take", store, job=page_job, what="deck", target="nastran", anyway=True)["text"]
    )
    with pytest.raises(dp.DataError, match="joint model"):
        ask("take", store, job=whole | {"joint": False}, what="joint")


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ({"target": "nastran"}, ("--to", "nastran")),
        ({"target": "modelica"}, ("--to", "modelica")),
        ({"target": "optistruct"}, ("--to", "optistruct")),
        ({"target": "comsol"}, ("--to", "comsol")),
        ({"target": "abaqus", "form": "prony", "seals": 2}, ("--to", "abaqus", "--form", "prony",
                                                             "--seals", "2")),
        ({"target": "radioss", "modulus": "3MPa"}, ("--to", "radioss", "--modulus", "3MPa")),
    ],
)  # fmt: skip
def test_a_deck_is_that_of_the_command(store, page_job, working_folder, more, words):
    specimen = {"temperature": "23degC", "length": "100mm"}
    # of the bench alone: what the page holds against it under a mass is in its header, too
    job = page_job | {"joint": False, "impact": [], "mass": "", "specimen": specimen}
    deck = ask("take", store, job=job, what="deck", **more)["text"]
    (working_folder / "fit.json").write_text(ask("take", store, job=job, what="fit")["text"])
    typed = ("export", "fit.json", "--unit-system", "mm-t-s", *words)
    assert ran(*typed).stdout == deck
    with pytest.raises(dp.ExportError, match="take no --modulus"):
        ask("take", store, job=job, what="deck", target="csv", modulus="3MPa")


def archived(taken: dict[str, str], name: str) -> str:
    """Return a file of an archive that was taken away."""
    with zipfile.ZipFile(io.BytesIO(b64decode(taken["base64"]))) as archive:
        return archive.read(name).decode()


def test_a_model_unit_is_that_of_the_command(store, page_job, working_folder):
    specimen = {"temperature": "23degC", "length": "100mm"}
    job = page_job | {"joint": False, "impact": [], "mass": "", "specimen": specimen}
    taken = ask("take", store, job=job, what="deck", target="fmu")
    assert taken["name"] == "fmu.fmu"
    (working_folder / "fit.json").write_text(ask("take", store, job=job, what="fit")["text"])
    ran("export", "fit.json", "--unit-system", "mm-t-s", "--to", "fmu", "-o", "seal.fmu")
    with zipfile.ZipFile(working_folder / "seal.fmu") as archive:
        assert set(archive.namelist()) >= {"modelDescription.xml", "sources/model.h"}
        for name in archive.namelist():
            if name.endswith((".xml", ".h", ".c")):
                assert archived(taken, name) == archive.read(name).decode(), name


@pytest.mark.parametrize("joint", [True, False])
def test_a_deck_is_of_the_solid_shown_and_no_calmer_than_the_page(store, page_job, joint):
    job = page_job | {"joint": joint}
    text = ask("study", store, job=job)
    table = text["solid"]
    assert joint or table == ask("settle", store, job=job)["solid"]
    (solid,) = re.findall('data-solid="([0-9a-f]+)"', table)
    for target in SUFFIXES:
        wanted = {"what": "deck", "target": target, "joint": joint, "anyway": True, "seals": 2}
        wanted |= {"modulus": "3MPa"} if target in {"radioss", "felupe"} else {}
        taken = ask("take", store, job=job, solid=solid, **wanted)
        deck = taken.get("text") or archived(taken, "sources/model.h")
        assert f"in parallel of fit {solid}" in deck, target
        assert len(re.findall(r"arm \d+: k =", deck)) == table.count('row">arm '), target
        assert ("DO NOT USE:" in deck) == (text["colour"] == "bad"), target
    with pytest.raises(dp.DataError, match="another model"):
        ask("take", store, job=job, solid="0" * 16, **wanted)


def test_the_panels_of_the_test_are_of_the_solid_of_the_tab(store, page_job):
    job = page_job | {"joint": True}
    text, single = ask("study", store, job=job), ask("settle", store, job=job)["panels"]
    both = text["panels"]
    assert both.keys() == {"ramp", "hold", "spectrum"}
    # the measured lines are the same, the fitted ones are not, nor their colour
    assert all(both[name] != single[name] for name in ("hold", "spectrum"))
    for panels, ink in ((both, "joint-ink"), (single, "fit")):
        assert all(f"var(--{ink})" in item for item in (panels["hold"], panels["spectrum"]))
        assert ink == "fit" or "var(--fit)" not in panels["hold"] + panels["spectrum"]
    arms = result_cache.get_study(build_job(job, store.folder)).joint.model.arms
    assert both["spectrum"].count(">τ") >= arms
    assert (
        ask("study", store, job=page_job | {"joint": False})["panels"]["spectrum"]
        == (single["spectrum"])
    )


def test_what_both_tests_leave_of_the_hold_is_its_noise(store, page_job):
    both = ask("study", store, job=page_job | {"joint": True, "arms": "auto"})["panels"]["hold"]
    rms, noise = map(float, re.search(r"rms ([\d.]+), noise ([\d.]+)", both).groups())
    assert 0.9 * noise < rms < 1.1 * noise


def test_the_list_of_files_names_no_option_and_no_python(store):
    rows = "".join(f"{1e-9 * i:.3e},{i},{i}\n" for i in range(200))
    identity = store.put("brief.csv", f"time [s],displacement [mm],force [N]\n{rows}".encode())
    line = ask("inspect", store, file=identity)["line"]
    assert line
    assert "--" not in line
    assert "Python" not in line


def test_two_fits_are_held_against_each_other(store, page_job):
    sides = {name: {"job": page_job | {"joint": name == "b"}} for name in "ab"}
    head = ask("against", store, **sides)
    assert head["colour"] == "open"
    assert set(head["panels"]) == {"ab-frf", "ab-rest"}
    assert 'data-name="A"' in head["panels"]["ab-frf"]
    tabs = [ask("study", store, job=side["job"])["answers"] for side in sides.values()]
    # each number is that of its own tab
    for text, side in zip(tabs, (1, 2), strict=True):
        specific = re.findall(r'row">([^<]+)</th><td class="value">([^<]+)', text)
        mine = {
            row[0]: row[side] for row in re.findall(
                r'row">([^<]+)</th><td class="value">([^<]*)</td><td class="value">([^<]*)',
                head["table"],
            )
        }  # fmt: skip
        assert all(mine[name] == value for name, value in specific if name in mine)
        assert len(mine.keys() & dict(specific).keys()) >= 3
    assert "alone" in head["table"]
    same = ask("against", store, a=sides["a"], b=sides["a"])
    assert "×" not in same["table"]
    assert "outside" not in same["table"]
    with pytest.raises(dp.DataError, match="no joint model"):
        ask("against", store, a=sides["a"], b={"job": page_job | {"joint": True, "impact": []}})


def test_project_is_saved_with_its_report(store, page_job, tmp_path):
    selected = ask("project", store, job=page_job | {"joint": False}, folder=str(tmp_path / "door"))
    assert (tmp_path / "door" / "dashpot.toml").exists()
    assert selected["report"].endswith(".html")
    with pytest.raises(dp.DataError, match="no folder"):
        ask("project", store, job=page_job, folder=" ")
