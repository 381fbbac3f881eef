"""Levels in the app: sweeps, loops and FRFs as ``dashpot fit`` fits them, digit for digit."""

import json
import re
import shlex

import numpy as np
import pytest
from kit import levels
from kit.app import Page, chromium, serve_app
from kit.browser import needs_browser
from kit.shell import ran

import dashpot as dp
from dashpot.extensions.app import wire_format
from dashpot.extensions.app.handler_registry import VERBS
from dashpot.extensions.app.upload_store import Store
from dashpot.reading.write import write_frf, write_relaxation

pytestmark = pytest.mark.once

SOLID = dp.GeneralizedMaxwell(450.0, (240.0,), (0.012,))
FORCES = ("0.02N", "0.5N")
BASES = ("0.3m/s^2", "2m/s^2")


def files_in(folder):
    """Loops, a sweep at one frequency, and what a mass without friction does at two levels."""
    K = levels.sweep()
    columns = np.column_stack((K.frequency, 100 * K.amplitude, 1e-6 * K.storage, 1e-6 * K.loss))
    head = "Frequency [Hz],Strain [%],Storage modulus [MPa],Loss modulus [MPa]"
    table = folder / "payne.csv"
    np.savetxt(table, columns[:12], delimiter=",", header=head, comments="")
    write_relaxation(levels.loops(), folder / "loops.csv")
    f, rng = np.linspace(8, 22, 41), np.random.default_rng(5)
    for kind, name in (("receptance", "frf"), ("transmissibility", "base")):
        H = dp.systems.predict_frf(SOLID, mass=levels.MASS, frequency=f, kind=kind)
        for i in range(2):
            noise = 1 + 0.003 * (rng.normal(size=41) + 1j * rng.normal(size=41))
            write_frf(dp.FRF(f, H.value * noise, H.quantity, units="SI"), folder / f"{name}{i}.csv")
    return folder


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    return files_in(tmp_path_factory.mktemp("levels"))


@pytest.fixture(scope="module")
def store(home):
    store = Store()
    yield store
    store.remove()


@pytest.fixture(scope="module")
def ids(store, home):
    return {item.name: store.put(item.name, item.read_bytes()) for item in sorted(home.iterdir())}


@pytest.fixture
def working_folder(home, monkeypatch):
    """The working folder is that of the files."""
    monkeypatch.chdir(home)


def ask(verb, store, **request):
    return wire_format.decode_message(VERBS[verb](request, store.folder))[0]


@pytest.mark.usefixtures("working_folder")
@pytest.mark.parametrize(
    ("names", "more", "shown"),
    [
        (["payne.csv"], {"law": "additive"},
         (2, "E′, 10 Hz", "lost", "half of the softening, strain")),
        (["loops.csv"], {}, (3, "K′, 5 Hz", "half of the softening, amplitude", "mm")),
        (["frf0.csv", "frf1.csv"], {"levels": FORCES, "at": ["0.1N"]},
         (3, "K′, ", "loss factor, ", "peak at 0.1 N", "motion at 0.1 N")),
        (["base0.csv", "base1.csv"], {"levels": BASES}, (3, "K′, ", "loss factor, ")),
    ],
)  # fmt: skip
def test_levels_are_fitted_as_by_the_command(store, ids, names, more, shown):
    kinds = {ask("inspect", store, file=ids[name])["mark"] for name in names}
    assert kinds == {"good"}
    stated = {
        key: list(value) if isinstance(value, tuple) else value for key, value in more.items()
    }
    request = {"files": [ids[name] for name in names], "mass": "104g", "seals": 2, **stated}
    text = ask("level", store, **request)
    figures, *terms = shown
    assert len(text["figures"]) == figures
    words = re.sub(r"\s+", " ", re.sub("<[^>]*>", "", text["solid"]))
    assert all(term in words for term in terms), words
    assert "unknown" not in words
    shell = ran(*shlex.split(text["command"])[1:], "--json")
    taken = ask("take-level", store, **request)
    assert taken["name"] == "levels.json"
    assert taken["text"] == shell.stdout.rstrip("\n")


@pytest.mark.parametrize(
    ("names", "more", "message"),
    [
        (["frf0.csv"], {"levels": ["0.1N"]}, "no mass is given"),
        (["frf0.csv"], {"levels": ["0.1"], "mass": "104g"}, "has no unit"),
        (["frf0.csv"], {"levels": ["0.1N", "1N"], "mass": "104g"}, "1 FRFs, 2 amplitudes"),
        (["frf0.csv"], {"levels": ["0.1N"], "mass": "104g", "at": ["1kg"]}, "unit of force"),
        (["payne.csv"], {"law": "linear"}, "expected one of auto, factor, additive, cubic"),
        (["payne.csv", "loops.csv"], {}, "one amplitude sweep at a time"),
        ("payne.csv", {}, "expected a list"),
    ],
)
def test_what_cannot_be_fitted_says_so(store, ids, names, more, message):
    files = [ids[name] for name in names] if isinstance(names, list) else ids[names]
    with pytest.raises(dp.DashpotError, match=message):
        ask("level", store, files=files, **more)


@needs_browser
def test_levels_in_the_browser(home):
    pytest.importorskip("playwright", reason="Playwright drives the browser")
    with chromium() as browser, serve_app() as address:
        page = Page(browser, address)
        command, table = page.at.locator("#command"), page.at.locator("#solid")

        def type_text(what, text):
            page.at.get_by_label(what).fill(text)
            page.at.get_by_label(what).press("Enter")

        page.at.locator("#pick").set_input_files([str(home / f"frf{i}.csv") for i in range(2)])
        page.at.get_by_role("button", name="several amplitudes").click()
        page.at.get_by_role("heading", name="At which amplitude?").wait_for()
        type_text("Amplitude of this FRF", "0.02")
        page.at.get_by_role("alert").filter(has_text="no mass is given").wait_for()
        page.at.get_by_role("textbox", name="Mass").fill("104")
        page.at.get_by_role("textbox", name="Mass").press("Enter")
        page.file("frf1.csv").click()
        type_text("Amplitude of this FRF", "0,5")
        command.filter(has_text="--amplitude 0.02N --amplitude 0.5N --mass 104g").wait_for()
        page.done()
        type_text("Resonance at amplitude", "0,1 0.2")
        command.filter(has_text="--resonance-amplitude 0.1N --resonance-amplitude 0.2N").wait_for()
        page.done()
        assert "peak at 0.2 N" in table.inner_text()
        assert page.at.locator("#files").get_by_text("an FRF, at 0.5 N").is_visible()
        page.at.locator("#pick").set_input_files(str(home / "payne.csv"))
        page.file("payne.csv").click()
        page.at.get_by_label("Amplitude law").select_option("additive")
        command.filter(has_text="payne.csv --model additive").wait_for()
        page.done()
        assert page.at.locator("#bench-page svg.figure").count() == 2
        with page.at.expect_download() as taken:
            page.at.get_by_role("button", name="levels.json").click()
        assert json.loads(taken.value.path().read_text())["law"] == "additive"
        page.at.keyboard.press("Control+z")
        command.filter(has_not_text="--model").wait_for()
        page.done()
        for width in (1366, 390):
            page.at.set_viewport_size({"width": width, "height": 844})
            page.done()
            assert page.at.evaluate("document.documentElement.scrollWidth") == width
        page.close()
