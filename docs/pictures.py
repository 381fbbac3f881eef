"""Draw the picture of the README, and every picture of the documentation."""

from __future__ import annotations

import html
import io
import os
import shlex
import shutil
import subprocess
import sys
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import dashpot as dp
from dashpot import workflow
from dashpot.cli import main as run
from dashpot.extensions.systems.door.door_model import ShearChoice
from dashpot.solids.demo_seals import PAPER

if TYPE_CHECKING:
    from typing import Any

    from playwright.sync_api import Browser, Page

DOCS = Path(__file__).parent
HERO = DOCS / "pictures" / "hero.png"
GALLERY = DOCS / "_pictures"
COMMANDS = """
fit seal_8mm.csv -o fit.json
predict fit.json --mass 114.8g --seals 2 --record seal_8mm.csv --plot bound.svg
fit seal_8mm.csv --model fractional --plot fractional.svg
fit at_23degC.csv at_10degC.csv at_0degC.csv --plot moving.svg
simulate creep --load 1N --hold 40s -o creep.csv
fit creep.csv --plot creep.svg
fit rig_stop.csv rig_spring.csv rig_empty.csv --spring-stiffness 1N/mm --plot blank_tests.svg
fit cld_1.csv --length 100mm --compression 6mm --compression-limits 4:8mm --plot cld.svg
fit cld_1.csv cld_2.csv cld_3.csv --length 100mm --compression 6mm --compression-limits 4:8mm \
--plot specimens.svg
fit tension.csv biaxial.csv --test uniaxial --test biaxial --plot law.svg
fit hit.csv --mass 5g --radius 5mm --drop-height 51mm --plot hit.svg
fit ovens.csv --machine oven=1K -o csr.json --plot csr.svg
fit ovens.csv --machine oven=1K --use-at 70degC --plot life.svg
predict csr.json --temperature 70degC --end 50% --end 1000h --plot aged.svg
fit cld_1.csv --length 100mm --compression 6mm --relaxation fit.json -o law.json
predict law.json --drop 0.3m/s --mass 200g --plot drop_prediction.svg
fit slam.csv --mass 200g --drop 0.3m/s --relaxation fit.json --plot drop_test.svg
fit rod.csv --shape disc:20mm,20mm --density 1000 --mass 31.4g --arms 1 --plot rod.svg
fit shaker_20mN.csv shaker_500mN.csv --amplitude 0.02N --amplitude 0.5N --mass 114.8g \
--plot levels.svg
fit loops.csv --plot loops.svg
fit depth_4mm.csv depth_6mm.csv depth_8mm.csv -o depths.json
predict depths.json --mass 114.8g --seals 2 --amplitude 0.01N --amplitude 0.2N --plot opened.svg
predict door.toml --modes --plot door.svg
predict door.toml --close 1.2m/s --plot closing.svg
predict door.toml --leak --plot leak.svg
predict fit.json --mass 200g --seals 2 --band 5:200Hz --base -o mount.csv
stiffness mount.csv --mass 200g --band 20:200Hz --plot transfer_stiffness.svg
map preload_map.csv --mass 104g --seals 2 --phase-error 0.1deg --plot preload_map.svg
predict door.toml --spread 4% --limit mode\\ 1>=27.3Hz --limit closing<=1.2m/s --plot cars.svg
demo --paper -o .
simulate relaxation --hold 4s --gauges --misaligned 2deg -o gauges.csv
"""
"""What makes the pictures of the pages, in a folder with the example files.

That of the paper makes figure_2.svg, figure_4.svg and figure_6.svg.
"""
PRINTED = {
    "shell": "fit seal_8mm.csv",
    "limits": "fit seal_8mm.csv --limit 'k_end >= 0.18N/mm' --limit 'k_end <= 0.22N/mm' "
    "--limit 'loss factor at 0.3Hz >= 15%' --limit 'stiffness at 1s <= 0.21N/mm'",
}
"""Commands whose output is shown as a shell shows it, by the name of the picture."""
WINDOW = {"width": 1366, "height": 768}
"""Of the app, px."""
STATE = {"x": 188, "y": 44, "width": 834, "height": 460}
"""Where tabs, verdict and response stand in it."""
SEALS, REPEATS = (1.0, 1.03, 0.98, 1.01), 3
"""Stiffnesses of the seals of a lot over that of the paper, and the tests of each."""


def main() -> None:
    """Run the main job of the README on its files, and save its picture."""
    HERO.parent.mkdir(exist_ok=True)
    with TemporaryDirectory() as place, chdir(place):
        _run_command("demo --files")
        test, hits = dp.read("seal_8mm.csv"), dp.read("hammer.csv")
        dp.plot.save(dp.report(test, hits, mass=workflow.MASS, seals=2).plot(), HERO, dpi=200)


def gallery() -> None:
    """Draw one picture of every kind, of the example files."""
    GALLERY.mkdir(exist_ok=True)
    with TemporaryDirectory() as place, chdir(place):
        for name, made in workflow.EXAMPLES.items():
            Path(name).write_text(made(), encoding="utf-8")
        for line in COMMANDS.strip().splitlines():
            _run_command(line)
        for path in Path().glob("*.svg"):
            shutil.copy(path, GALLERY)
        for name, picture in (_draw_figures() | {"lot": _lot()}).items():
            dp.plot.save(picture, GALLERY / f"{name}.svg")
        for name, line in PRINTED.items():
            shown = _draw_shell(f"$ dashpot {line}\n{_run_command(line)}")
            (GALLERY / f"{name}.svg").write_text(shown, encoding="utf-8")


def _run_command(line: str) -> str:
    """Run a command; return what it prints."""
    out = io.StringIO()
    with redirect_stdout(out), redirect_stderr(io.StringIO()):
        run(shlex.split(line), standalone_mode=False)
    return out.getvalue()


def _on_its_seal() -> dp.plot.Picture:
    """Draw the example door without hinges and latch, on a seal that holds it sideways too."""
    door = dp.read("door.toml", kind="door")
    seal = replace(door.seal, shear=ShearChoice(across=0.35, along=0.15))
    alone = replace(door, hinges=(), latch=None, modes=None, base="", seal=seal)
    return dp.predict(alone, band=(0.5, 20.0)).plot()


def _draw_figures() -> dict[str, dp.plot.Picture]:
    hits = dp.read("hammer.csv", kind="impact")
    frf = hits.frf(mass=workflow.MASS)
    test = dp.read("seal_8mm.csv", kind="relaxation")
    study = dp.report(test, hits, mass=workflow.MASS, seals=2)
    depths = dp.fit(*(dp.read(f"depth_{d}mm.csv", kind="relaxation") for d in (4, 6, 8)))
    return {
        "hero": study.plot(),
        "segments": study.prepared.plot(),
        "fit": dp.plot.fit(study.fit, study.prepared),
        "stiffness": dp.plot.stiffness(
            study.fit, parameters=study.parameters, unresolved_bounds=study.unmeasured
        ),
        "spectrum": dp.plot.spectrum(study.fit, joint=study.joint),
        "hits": dp.plot.hits(hits, frf),
        "frf": frf.plot(),
        "nyquist": dp.plot.nyquist(frf),
        "dynamic_stiffness": dp.plot.dynamic_stiffness(
            study.direct, joint=study.joint, stamp=dp.plot.stamp(frf.source)
        ),
        "comparison": dp.plot.comparison(
            study.comparison, joint=study.joint_comparison, band=study.frf_band
        ),
        "superposition": dp.solids.superpose(dp.read("sweeps.csv")).plot(),
        "elastic_law": dp.plot.elastic_law(depths),
        "columns": dp.inspect("seal_8mm.csv").plot(),
        "clipped": dp.inspect("clipped.csv").plot(),
        "gauges": dp.inspect("gauges.csv").plot(),
        "on_its_seal": _on_its_seal(),
    }


def _lot() -> dp.plot.Picture:
    """Draw the control chart of four seals, each tested three times."""
    folder = Path("tests")
    folder.mkdir()
    for seal, factor in enumerate(SEALS, start=1):
        for repeat in range(1, REPEATS + 1):
            made = dp.simulation.simulate_relaxation(
                factor * PAPER, hold_time=10.0, seed=10 * seal + repeat
            )
            text = dp.files.write_relaxation(made.test, comments=dp.simulation.stamp(made.truth))
            (folder / f"lotA_seal{seal}_rep{repeat}.csv").write_text(text, encoding="utf-8")
    by = r"lot(\w+)_seal(\d+)_rep(\d+)"
    _run_command(f"batch {folder} -o lot --label-pattern '{by}' --arms 2 --jobs 1")
    return dp.Lot.read("lot").plot()


def _draw_shell(text: str) -> str:
    """Draw printed text as a shell shows it."""
    lines = text.rstrip().splitlines()
    wide, high = 8 * max(map(len, lines)) + 32, 18 * len(lines) + 32
    rows = "".join(
        f'<text x="16" y="{18 * row + 30}" style="white-space:pre" xml:space="preserve">'
        f"{html.escape(line)}</text>"
        for row, line in enumerate(lines)
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {high}" '
        'font-family="DejaVu Sans Mono, Consolas, monospace" font-size="13" fill="#e8e8e8">'
        f'<rect width="100%" height="100%" rx="8" fill="#1e2430"/>{rows}</svg>'
    )


def app() -> bool:
    """Photograph the app with the example in it; False where no browser does."""
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        return False
    from playwright.sync_api import Error, sync_playwright

    words = [sys.executable, "-m", "dashpot", "app", "--no-browser"]
    GALLERY.mkdir(exist_ok=True)
    # what it remembers is not the builder's own
    with (
        TemporaryDirectory() as state,
        subprocess.Popen(  # noqa: S603
            words, stdout=subprocess.PIPE, text=True, env={**os.environ, "DASHPOT_STATE": state}
        ) as server,
    ):
        try:
            with sync_playwright() as on:
                browser = on.chromium.launch(executable_path=program, args=["--no-sandbox"])
                _photograph_app(browser, server.stdout.readline().strip())
        except Error as error:
            sys.stderr.write(f"the app is not shown: {error}\n")
            return False
        finally:  # who leaves the server waits for its end
            server.terminate()
    return True


def _photograph_app(browser: Browser, address: str) -> None:
    page = browser.new_page(viewport=WINDOW)
    page.set_default_timeout(120_000)
    page.goto(address)
    page.locator("body[data-ready=true]").wait_for()
    page.get_by_role("button", name="Try the example").click()
    done = page.get_by_role("status").filter(has_text="done in")

    def take_screenshot(name: str, **how: Any) -> None:
        page.screenshot(path=GALLERY / f"{name}.png", **how)

    def wait_for_study() -> None:
        page.locator("#verdict:not(.open)").wait_for()
        done.wait_for()

    wait_for_study()
    _move_ramp_end(page)
    take_screenshot("app_drag", clip=STATE)
    page.mouse.up()
    page.get_by_role("slider", name="ramp end").press("Home")
    wait_for_study()
    page.get_by_role("tab", name="joint model").click()
    wait_for_study()
    take_screenshot("app")
    page.emulate_media(color_scheme="dark")
    take_screenshot("app_dark")
    page.emulate_media(color_scheme="light")
    page.get_by_role("tab", name="A | B").click()
    page.locator("#ab-table table").wait_for()
    done.wait_for()
    take_screenshot("app_against")
    page.get_by_role("tab", name="joint model").click()
    wait_for_study()
    page.set_viewport_size({"width": 390, "height": 844})
    # drawn anew, as wide as the window less its edges
    page.locator('[data-panel=frf] svg.figure[viewBox^="0 0 366"]').wait_for()
    wait_for_study()
    take_screenshot("app_phone")
    page.set_viewport_size(WINDOW)
    page.locator("#files .file").filter(has_text="hammer.csv").click()
    page.locator("#hit-table .pulse").first.wait_for()
    wait_for_study()
    take_screenshot("app_hits")
    for hit in page.locator("[data-hit]").all():
        hit.uncheck()
    page.get_by_role("button", name="Accept all that pass").wait_for()
    page.locator("#files .file").filter(has_text="seal_8mm.csv").click()
    page.get_by_role("button", name="Accept all that pass").wait_for()
    take_screenshot("app_refused", clip=STATE)
    page.get_by_role("button", name="Accept all that pass").click()
    page.locator("#verdict.good").wait_for()
    page.get_by_role("tab", name="relaxation alone").click()
    page.locator("#mass").fill("120")
    page.locator("#mass").press("Enter")
    page.get_by_text("Mass 120 g. The hammer is compared.").wait_for()
    take_screenshot("app_working", clip=STATE)
    page.get_by_role("button", name="Cancel").click()
    page.get_by_role("button", name="Judge it").wait_for()
    take_screenshot("app_cancelled", clip=STATE)
    browser.close()


def _move_ramp_end(page: Page) -> None:
    """Take the end of the ramp, and move it."""
    box = page.get_by_role("slider", name="ramp end").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + 30
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 4, y, steps=4)
    page.locator("#verdict").filter(has_text="N/mm, was").wait_for()


if __name__ == "__main__":
    main()
