"""The report as a reader sees it: first screen, phone, dark, paper, pointer and keyboard."""

from __future__ import annotations

import re
from dataclasses import replace
from html import unescape
from io import BytesIO

import numpy as np
import pytest
from kit import handmade
from kit.app import chromium
from kit.browser import needs_browser, probe
from kit.fits import replace_fields
from pypdf import PdfReader

from dashpot.base.checks import Check
from dashpot.plot import style
from dashpot.report import html

pytest.importorskip("playwright", reason="Playwright drives the browser: pip install playwright")
pytestmark = [needs_browser, pytest.mark.once]

S = handmade.study()


@pytest.fixture(scope="module")
def browser():
    with chromium() as browser:
        yield browser


@pytest.fixture(scope="module")
def page() -> str:
    return html(S)


@pytest.fixture(scope="module")
def bench() -> str:
    return html(handmade.bench_only())


PLACES = """
    const bottom = (what) => document.querySelector(what).getBoundingClientRect().bottom;
    return [".who", ".verdict", "#figure-lead .strips", "#figure-lead .key", ".answer",
            ".take"].map(bottom);
"""


@pytest.mark.parametrize("which", ["page", "bench"])
def test_the_first_screen_holds_verdict_figure_table_and_files(browser, which, request):
    text = request.getfixturevalue(which)
    bottoms = probe(browser, text, PLACES, width=1366, height=768)
    assert max(bottoms) <= 768


@pytest.mark.parametrize("which", ["page", "bench"])
def test_a_phone_shows_all_of_it_in_letters_that_can_be_read(browser, which, request):
    script = """
        const seen = [...document.querySelectorAll("figure text, p, td, dd, dt, li")]
            .filter((one) => one.getClientRects().length && one.textContent.trim());
        const size = (one) => {
            const svg = one.closest("svg[viewBox]");
            const scale = svg ? svg.getBoundingClientRect().width / svg.viewBox.baseVal.width : 1;
            return parseFloat(getComputedStyle(one).fontSize) * scale;
        };
        return {
            wide: document.documentElement.scrollWidth,
            least: Math.min(...seen.map(size)),
            figures: document.querySelectorAll("svg.narrow").length,
        };
    """
    text = request.getfixturevalue(which)
    result = probe(browser, text, script, width=390, height=844)
    assert result["wide"] <= 390
    assert result["least"] >= 12
    assert result["figures"] > 0


@pytest.mark.parametrize("which", ["page", "bench"])
def test_a_phone_shows_the_first_number_on_its_first_screen(browser, which, request):
    script = """
        const bottom = (what) => document.querySelector(what).getBoundingClientRect().bottom;
        return [bottom(".who"), bottom(".answer .value")];
    """
    text = request.getfixturevalue(which)
    head, number = probe(browser, text, script, width=390, height=844)
    assert head < 150
    assert number <= 844


COLOURS = """
    const style = (what, name) => getComputedStyle(document.querySelector(what))[name];
    return [style("body", "backgroundColor"), style("body", "color"),
            style("#figure-lead .panel path[data-name=measured]", "stroke")];
"""


@pytest.mark.parametrize(("theme", "scheme"), [(1, "dark"), (0, "light")])
def test_page_and_figures_follow_the_theme_that_the_reader_prefers(browser, page, theme, scheme):
    result = probe(browser, page, COLOURS, width=1366, height=768, color_scheme=scheme)
    expected = [style.COLOURS[name][theme] for name in ("panel", "ink", "measured")]
    numbers = [[int(n) for n in re.findall(r"\d+", colour)] for colour in result]
    assert numbers == [[int(c[i : i + 2], 16) for i in (1, 3, 5)] for c in expected]


def test_the_policy_lets_the_page_work_and_nothing_complains(browser, tmp_path, page):
    context = browser.new_context()
    window, stated = context.new_page(), []
    window.on("console", lambda message: stated.append(message.text))
    window.on("pageerror", lambda error: stated.append(str(error)))

    def read_off(text):
        """How many places to read a figure off the script has made."""
        (tmp_path / "page.html").write_text(text, encoding="utf-8")
        window.goto(f"file://{tmp_path / 'page.html'}")
        return window.locator(".read").count()

    assert read_off(page) > 0
    assert stated == []
    # another script does nothing
    assert read_off(page.replace("export class Figure", "export  class Figure", 1)) == 0
    assert "Content Security Policy" in " ".join(stated)
    context.close()


READ = """
    const svg = document.querySelector("#figure-lead svg.wide");
    const out = document.querySelector("#figure-lead .read");
    const panel = svg.querySelector(".panel");
    const key = (key, shiftKey = false) =>
        svg.dispatchEvent(new KeyboardEvent("keydown", {key, shiftKey}));
    const view = () => svg.querySelector(".plot").getAttribute("viewBox");
    const at = (x, y) => {
        const box = svg.getBoundingClientRect(), scale = box.width / svg.viewBox.baseVal.width;
        const [bx, by, w, h] = panel.dataset.box.split(" ").map(Number);
        return {clientX: box.left + scale * (bx + x * w), clientY: box.top + scale * (by + y * h),
                bubbles: true, pointerId: 1, pointerType: "pen", button: 0};
    };
    const pointer = (kind, x, y) => svg.dispatchEvent(new PointerEvent(kind, at(x, y)));
    const said = [], views = [view()];
    pointer("pointermove", 0.25, 0.5); said.push(out.textContent);
    pointer("pointerdown", 0.2, 0.5);
    pointer("pointermove", 0.6, 0.52);
    pointer("pointerup", 0.6, 0.52);
    views.push(view());
    const ticks = [...svg.querySelectorAll(".ticks text[text-anchor=middle]")]
        .map((one) => one.textContent);
    svg.dispatchEvent(new MouseEvent("dblclick")); views.push(view());
    key("Home"); said.push(out.textContent);
    key("ArrowRight", true); said.push(out.textContent);
    key("+"); views.push(view());
    key("0"); views.push(view());
    return {said, views, ticks, axis: panel.dataset.x};
"""


def test_the_frf_is_zoomed_and_read_off_by_pointer_and_keyboard(browser, page):
    result = probe(browser, page, READ, width=1366, height=768)
    _, low, high = result["axis"].split()
    low, high = float(low), float(high)
    for message, part in zip(result["said"], (0.25, 0.0, 0.05), strict=True):
        f = low * (high / low) ** part
        match = re.match(r"frequency ([\d.]+) Hz; accelerance, 1/kg: (.*)", message)
        assert float(match[1]) == pytest.approx(f, rel=2e-3)
        values = dict(re.findall(r"(measured|joint model) ([\d.]+)", match[2]))
        measured = np.interp(f, S.measured.frequency, np.abs(S.measured.value))
        assert float(values["measured"]) == pytest.approx(measured, rel=0.02)
        limits = re.search(r"bounds over all spectra ([\d.]+) to ([\d.]+)", match[2])
        assert float(limits[1]) < float(limits[2])
    whole, dragged, back, nearer, again = result["views"]
    _, y0, wide, tall = map(float, whole.split())
    remaining, top, part, height = map(float, dragged.split())
    # a flat drag zooms the frequency alone
    assert (remaining, part) == (
        pytest.approx(0.2 * wide, abs=30),
        pytest.approx(0.4 * wide, abs=30),
    )
    assert (top, height) == (y0, tall)
    assert [float(tick) for tick in result["ticks"]] == sorted(float(t) for t in result["ticks"])
    assert len(result["ticks"]) >= 3
    assert low < float(result["ticks"][0]) < float(result["ticks"][-1]) < high
    assert float(nearer.split()[2]) == pytest.approx(wide / 2, rel=0.01)
    assert whole == back == again


def sheets(browser, page: str) -> list[str]:
    """The words of each sheet on which a page is printed."""
    context = browser.new_context()
    window = context.new_page()
    window.set_content(page, wait_until="load")
    printed = PdfReader(BytesIO(window.pdf(prefer_css_page_size=True)))
    context.close()
    return [re.sub(r"\s+", " ", item.extract_text()) for item in printed.pages]


def test_the_first_sheet_is_a_certificate_however_many_checks_failed(browser):
    """Verdict, numbers, the gravest checks and the signatures; the story begins on the next."""
    message = " ".join(["the storage stiffness of the seal is off"] * 5)
    every = tuple(Check(f"no_{i}", False, f"{i} {message}") for i in range(8))
    who = replace(S.prepared.specimen, name="Door seal 4711-B", lot="L24-117", operator="J. Ruiz")
    study = replace(S, joint=replace_fields(S.joint, checks=every),
                    prepared=replace(S.prepared, specimen=who))  # fmt: skip
    first, second, *_ = sheets(browser, html(study))
    for part in ("Use with care", "Peak frequency", "Valid band", " more ",
                 "Tested by, date", "Released by, date"):  # fmt: skip
        assert part in first
    assert re.match(r"\s*(2 / \d+ )?The test and its fit", second)


@pytest.mark.parametrize("script", [False, True])
def test_paper_has_all_that_is_folded(browser, page, script):
    # the script opens the folds, too
    text = page if script else re.sub(r"<script.*</script>", "", page, flags=re.DOTALL)
    words = " ".join(sheets(browser, text))
    for part in ("Use with care", "Recommended: joint model",
                 "Tested by, date",
                 "Number of arms", "Numbers to export", "residual of two arms, mN",
                 "measured 12.71"):  # fmt: skip
        assert part in words, part
    assert handmade.SHA[:20] in words.replace(" ", "")
    for check in S.every_check:
        assert unescape(check.message).split()[0] in words
