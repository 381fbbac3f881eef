"""The app while a rig writes its files: journeys in a real browser, with every frame logged."""

import json
import os
import subprocess
import sys

import pytest
from kit.app import Page, chromium, serving
from kit.browser import needs_browser

from dashpot import workflow
from dashpot.reading.write import write_relaxation
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.demo_seals import BROAD

pytest.importorskip("playwright", reason="Playwright drives the browser: pip install playwright")
pytestmark = [needs_browser, pytest.mark.once]

RECORDER = """() => {
  window.frames_seen = [];
  const look = () => {
    const verdict = document.getElementById("verdict");
    const file = document.querySelector("#files .file .stamp");
    const now = {
      colour: ["good", "care", "bad", "open"].find((one) => verdict.classList.contains(one)) || "",
      word: verdict.querySelector(".word")?.textContent || "",
      hash: file?.textContent.slice(0, 8) || "",
      watch: document.querySelector("#files .watch")?.textContent || "",
      busy: document.body.dataset.busy === "true",
      command: document.getElementById("command").textContent,
    };
    const last = window.frames_seen.at(-1);
    if (!last || JSON.stringify(last) !== JSON.stringify(now)) window.frames_seen.push(now);
    requestAnimationFrame(look);
  };
  look();
}"""
"""Log every frame in which something of the verdict or of the file changes."""


@pytest.fixture(scope="module")
def browser():
    with chromium() as browser:
        yield browser


@pytest.fixture(scope="module")
def texts():
    return {name: workflow.EXAMPLES[name]() for name in workflow.FIRST}


@pytest.fixture
def files(tmp_path, texts):
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "noise.csv").write_text("this is no table\nat all\n")
    return tmp_path


@pytest.fixture(scope="module")
def empty():
    with serving() as server:
        yield server[0]


@pytest.fixture
def page(browser, empty):
    page = Page(browser, empty)
    yield page
    page.close()


def pick(page, *paths):
    page.at.locator("#pick").set_input_files([str(path) for path in paths])


def scale_force(text, factor):
    """The same relaxation test, every force so many times as large."""
    lines = []
    for line in text.splitlines():
        cells = line.split(",")
        try:
            numbers = [float(cell) for cell in cells]
        except ValueError:
            lines.append(line)
            continue
        lines.append(",".join(repr(value) for value in (*numbers[:2], factor * numbers[2])))
    return "\n".join(lines) + "\n"


def end_of_hold(page):
    row = page.at.locator("#answers tr").filter(has_text="k after").first
    return float(row.locator("td").first.inner_text())


def test_a_file_that_changes_is_read_again_and_the_old_one_is_never_green(browser, files, texts):
    path = files / "seal_8mm.csv"
    with serving(str(path)) as (address, _):
        page = Page(browser, address, fresh=False)
        page.done()
        page.at.locator("#files .stamp").wait_for()
        before, old = end_of_hold(page), page.at.locator("#files .stamp").inner_text()[:8]
        page.at.evaluate(RECORDER)
        path.write_text(scale_force(texts["seal_8mm.csv"], 1.1))
        page.at.locator("#files .stamp").filter(has_text="read again").wait_for()
        page.done()
        page.at.locator("#verdict.good, #verdict.care, #verdict.bad").wait_for()
        frames = page.at.evaluate("window.frames_seen")
        assert end_of_hold(page) == pytest.approx(1.1 * before, rel=0.01)
        # from the frame that says that the file is another one, nothing is judged until it is read
        first = next(i for i, frame in enumerate(frames) if frame["watch"] or frame["hash"] != old)
        outcome = [frame for frame in frames[first:] if frame["colour"] in {"good", "care", "bad"}]
        assert outcome
        assert all(item["hash"] not in {"", old} and not item["watch"] for item in outcome)
        assert any(frame["colour"] == "open" for frame in frames[first:])
        page.close()


def test_a_file_overwritten_while_it_is_computed_ends_as_the_command_says(browser, files, texts):
    path = files / "seal_8mm.csv"
    with serving(str(path)) as (address, _):
        page = Page(browser, address, fresh=False)
        about = path.stat()
        path.write_text(scale_force(texts["seal_8mm.csv"], 2.0))
        os.utime(path, ns=(about.st_atime_ns, about.st_mtime_ns))
        page.at.locator("#files .stamp").filter(has_text="read again").wait_for()
        page.done()
        line = [
            sys.executable,
            "-m",
            "dashpot",
            *page.at.locator("#command").inner_text().split()[1:],
        ]
        run = [*line, "--json", "-o", "page.html"]
        done = subprocess.run(run, cwd=files, capture_output=True, text=True, check=True)
        (end,) = [
            number
            for number in json.loads(done.stdout)["numbers"]
            if number["name"] == "end of hold"
        ]
        assert end_of_hold(page) == pytest.approx(end["value"] / 1000, rel=1e-3)
        page.close()


def test_a_file_that_was_chosen_and_changed_is_opened_again(page, files, texts):
    path = files / "seal_8mm.csv"
    pick(page, path)
    page.done()
    path.write_text(scale_force(texts["seal_8mm.csv"], 1.2))
    verdict = page.at.get_by_role("region", name="Verdict")
    verdict.get_by_role("button", name="Open it again").wait_for()
    assert page.at.get_by_role("button", name="Report").is_disabled()
    pick(page, path)
    page.at.locator("#files .stamp").filter(has_text="read again").wait_for()
    page.done()
    assert page.at.locator("#files .file").count() == 1
    assert verdict.get_by_role("button", name="Open it again").count() == 0


def test_a_file_that_is_gone_has_no_verdict(browser, files):
    path = files / "seal_8mm.csv"
    with serving(str(path)) as (address, _):
        page = Page(browser, address, fresh=False)
        page.done()
        path.unlink()
        page.at.get_by_role("region", name="Verdict").get_by_text("no longer where").wait_for()
        page.close()


def test_refused_file_has_a_page_and_blocks_no_other_file(page, files):
    pick(page, files / "seal_8mm.csv", files / "noise.csv")
    page.done()
    page.at.locator("#verdict.good").wait_for()
    page.file("noise.csv").click()
    page.at.get_by_role("heading", name="noise.csv was not read").wait_for()
    assert not page.at.locator("#right").is_visible()
    assert not page.at.locator("#command").is_visible()
    assert page.at.get_by_role("button", name="Report").is_disabled()
    page.file("seal_8mm.csv").click()
    page.done()
    page.at.locator("#verdict.good").wait_for()
    assert page.at.get_by_role("button", name="Report").is_enabled()


def test_without_a_mass_the_stiffness_stands_there_with_its_bound(page, files):
    pick(page, files / "seal_8mm.csv")
    page.done()
    panel = page.at.locator('[data-panel="frf"]')
    panel.get_by_text("bound").wait_for()
    assert "loss factor" in panel.locator("figcaption").inner_text()
    page.at.locator("#mass").fill("114.8")
    page.at.keyboard.press("Enter")
    panel.filter(has_text="Accelerance").wait_for()


def test_page_of_a_hammer_test_finds_modes_by_a_click(page, files):
    pick(page, files / "hammer.csv")
    page.done()
    for name in ("hit-frf", "pulses", "force", "answers", "poles"):
        page.at.locator(f'[data-panel="{name}"] svg.figure').wait_for()
    assert "coherence" in page.at.locator('[data-panel="hit-frf"]').inner_text()
    modes = page.at.locator("#answers").inner_text()
    assert "12.70" in modes
    poles = page.at.locator('[data-panel="poles"]')
    poles.scroll_into_view_if_needed()
    stable = poles.locator('[data-name="stable in damping"]').bounding_box()
    page.at.mouse.click(stable["x"] + 3, stable["y"] + stable["height"] / 2)
    page.at.locator("#command").filter(has_text="--band").wait_for()
    page.done()
    assert "12.70" in page.at.locator("#answers").inner_text()
    page.at.locator("#modes-band").fill("")
    page.at.keyboard.press("Enter")
    page.at.locator("#command").filter(has_not_text="--band").wait_for()


def test_every_test_lies_over_the_others_with_its_number(page, files, texts):
    factors = (0.97, 1.0, 1.02, 1.09)
    for i, factor in enumerate(factors):
        (files / f"seal_{i}.csv").write_text(scale_force(texts["seal_8mm.csv"], factor))
    pick(page, *(files / f"seal_{i}.csv" for i in range(len(factors))))
    page.done()
    page.at.get_by_role("tab", name="all 4 tests").click()
    page.at.locator("#seals-table tbody tr").nth(3).wait_for()
    page.done()
    rows = [
        row.locator("td").all_inner_texts()
        for row in page.at.locator("#seals-table tbody tr").all()
    ]
    values = [float(row[2]) for row in rows]
    ratios = [value / values[1] for value in values]
    assert ratios == pytest.approx(factors, rel=2e-3)
    drawn = page.at.locator('[data-panel="seals-hold"] path[data-name]')
    assert drawn.count() == len(factors)
    assert "seal_3.csv" in page.at.get_by_role("region", name="Verdict").inner_text()


def test_a_long_name_keeps_its_start_and_its_end(page, files, texts):
    name = f"left_rear_door{'_very' * 25}_specimen_17.csv"
    (files / name).write_text(texts["seal_8mm.csv"])
    pick(page, files / name)
    page.done()
    assert name in page.at.locator("#command").inner_text()
    shown = page.at.locator("#files .file b").inner_text()
    assert shown.startswith("left_rear_door")
    assert shown.endswith("specimen_17.csv")


def test_zoom_of_200_percent_leaves_60_percent_of_the_height(page, files):
    pick(page, *(files / name for name in workflow.FIRST))
    page.done()
    page.at.set_viewport_size({"width": 683, "height": 384})
    page.still()
    taken = page.at.evaluate("""() => [...document.querySelectorAll("body *")].filter((one) => {
      const { position } = getComputedStyle(one);
      return one.checkVisibility() && (position === "fixed" || position === "sticky");
    }).reduce((sum, one) => sum + one.getBoundingClientRect().height, 0)
      + document.getElementById("grid").querySelector("figure").getBoundingClientRect().top""")
    assert taken <= 0.4 * 384


@pytest.mark.parametrize("name", ["contact", "ramp end"])
def test_time_limit_is_dragged_on_a_thinned_record(page, files, name):
    (files / "seal_1.csv").write_text(write_relaxation(simulate_relaxation(BROAD, seed=1).test))
    pick(page, files / "seal_1.csv")
    page.done()
    handle = page.at.get_by_role("slider", name=name)
    handle.focus()
    page.at.evaluate(RECORDER)
    page.at.keyboard.press("PageUp")
    page.done()
    assert not [
        item for item in page.at.evaluate("window.frames_seen") if "Do not use" in item["word"]
    ]
    assert "--time-limits" in page.at.locator("#command").inner_text()
