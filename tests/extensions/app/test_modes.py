"""Modes of FRFs in the app: as ``dashpot fit`` shows them, digit for digit."""

import json
import shlex

import numpy as np
import pytest
from kit.app import Page, chromium, serve_app
from kit.browser import needs_browser
from kit.shell import ran

import dashpot as dp
from dashpot.extensions.app import wire_format
from dashpot.extensions.app.handler_registry import VERBS
from dashpot.extensions.app.upload_store import Store
from dashpot.reading.write import write_frf

pytestmark = pytest.mark.once

MASSES = ("104g", "250g")
SOLID = dp.GeneralizedMaxwell(400.0, (60.0, 40.0), (0.08, 0.008))


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """Two points of a structure of two modes, and two masses on one solid."""
    home, f, rng = (
        tmp_path_factory.mktemp("frfs"),
        np.arange(2.0, 60.0, 0.1),
        np.random.default_rng(2),
    )
    s = 2j * np.pi * f

    def keep(name, value):
        sd = 0.01 * np.abs(value)
        value = value + sd * (rng.normal(size=len(f)) + 1j * rng.normal(size=len(f)))
        (home / name).write_text(write_frf(dp.FRF(f, value, sd=sd, units="SI")))

    for i, shape in enumerate(((1.0, 1.0), (0.6, -0.8))):
        modes = zip((12.0, 31.0), (0.02, 0.03), shape, strict=True)
        keep(
            f"point{i}.csv",
            sum(a * s**2 / (s**2 + 2 * z * 2 * np.pi * hz * s + (2 * np.pi * hz) ** 2)
                for hz, z, a in modes),
        )  # fmt: skip
    for mass in MASSES:
        m = float(mass[:-1]) / 1000
        keep(f"{mass}.csv", dp.systems.predict_frf(SOLID, mass=m, frequency=f).value)
    stiff = SOLID.complex_stiffness(omega=2 * np.pi * f)
    ratio = stiff / (stiff - 0.104 * (2 * np.pi * f) ** 2)
    over = dp.FRF(f, ratio, quantity="transmissibility", units="SI")
    (home / "base.csv").write_text(write_frf(over))
    return home


@pytest.fixture(scope="module")
def store(home):
    store = Store()
    yield store
    store.remove()


def ask(verb, store, home, names, **request):
    ids = [store.put(name, (home / name).read_bytes()) for name in names]
    return wire_format.decode_message(VERBS[verb]({"files": ids, **request}, store.folder))[0]


@pytest.mark.parametrize(
    "case",
    [
        (["point0.csv"], {"band": "5:50Hz"}, ["Stabilisation chart", "Modes"]),
        (["point0.csv", "point1.csv"], {},
         ["Stabilisation chart", "Modes", "Shapes: size and phase", "Modal assurance criterion"]),
        (["base.csv"], {}, ["Stabilisation chart", "Modes of 1 kg on the base"]),
        ([f"{mass}.csv" for mass in MASSES], {"masses": list(MASSES)},
         ["Accelerance, 1/kg", "Storage stiffness, N/mm", "Loss stiffness, N/mm"]),
    ],
)  # fmt: skip
def test_modes_are_those_of_the_command(store, home, monkeypatch, case):
    names, more, titles = case
    text = ask("modes", store, home, names, **more)
    assert [title for title, *_ in text["figures"]] == titles
    assert "use" in text["verdict"].lower()
    monkeypatch.chdir(home)
    shell = ran(*shlex.split(text["command"])[1:], "--json")
    taken = json.loads(ask("take-modes", store, home, names, **more)["text"])
    mine, its = (item.get("modes", item.get("tests")) for item in (taken, json.loads(shell.stdout)))
    assert mine == its


def test_modes_ask_for_a_missing_mass(store, home):
    with pytest.raises(dp.DataError, match=r"250g\.csv: say which mass was on the seals"):
        ask("modes", store, home, [f"{mass}.csv" for mass in MASSES], masses=["104g", ""])


@needs_browser
def test_modes_in_the_browser(home):
    pytest.importorskip("playwright", reason="Playwright drives the browser")
    with chromium() as browser, serve_app() as address:
        page = Page(browser, address)
        command, table = page.at.locator("#command"), page.at.locator("#solid")

        def type_text(what, text):
            page.at.get_by_label(what).fill(text)
            page.at.get_by_label(what).press("Enter")

        page.at.locator("#pick").set_input_files(str(home / "point0.csv"))
        command.filter(has_text="dashpot fit point0.csv").wait_for()
        page.done()
        shown = page.at.get_by_role("region", name="Fit of this file")
        assert shown.get_by_text("Stabilisation chart").is_visible()
        type_text("Band of modes", "5 to 50")
        command.filter(has_text="--band 5.0:50Hz").wait_for()
        page.at.locator("#pick").set_input_files(str(home / "point1.csv"))
        page.at.get_by_text("Modal assurance criterion").wait_for()
        page.done()
        assert "f, 2" in table.inner_text()
        with page.at.expect_download() as taken:
            page.at.get_by_role("button", name="modes.json").click()
        assert len(json.loads(taken.value.path().read_text())["points"]) == 2
        for name in ("point0.csv", "point1.csv"):
            page.remove(name)
        # of a base that moves too: no level is asked for
        page.at.locator("#pick").set_input_files(str(home / "base.csv"))
        command.filter(has_text="dashpot fit base.csv").wait_for()
        page.done()
        shown = page.at.get_by_role("region", name="Fit of this file")
        assert shown.get_by_text("Stabilisation chart").is_visible()
        page.remove("base.csv")
        page.at.locator("#pick").set_input_files([str(home / f"{mass}.csv") for mass in MASSES])
        page.at.get_by_role("button", name="several masses").click()
        for mass in MASSES:
            page.file(f"{mass}.csv").click()
            type_text("Mass in this FRF", mass)
        command.filter(has_text="--mass 104g --mass 250g").wait_for()
        page.done()
        assert page.at.locator("#bench-page svg.figure").count() == 3
        for width in (1366, 390):
            page.at.set_viewport_size({"width": width, "height": 844})
            page.done()
            assert page.at.evaluate("document.documentElement.scrollWidth") == width
        page.close()
