"""Draw the picture of the README, and the gallery of the documentation."""

import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import dashpot as dp
from dashpot import workflow
from dashpot.simulation.impact import simulate_impact
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.solids.table_1 import BROAD, BROAD_MASS

DOCS = Path(__file__).parent
HERO = DOCS / "pictures" / "hero.png"
GALLERY = DOCS / "_pictures"


def main() -> None:
    """Run the whole story and save its picture."""
    bench = simulate_relaxation(BROAD, seed=0)
    hammer = simulate_impact(BROAD, mass=BROAD_MASS, seed=0)
    study = dp.report(bench.test, hammer.test, mass=BROAD_MASS, seals=2, arms=2, band=(4.0, 40.0))
    HERO.parent.mkdir(exist_ok=True)
    dp.plot.save(dp.plot.hero(study), HERO, dpi=200)


def gallery() -> None:
    """Draw one picture of every kind, of the example files."""
    with TemporaryDirectory() as place:
        files = {name: Path(place) / name for name in workflow.EXAMPLES}
        for name, path in files.items():
            path.write_text(workflow.EXAMPLES[name](), encoding="utf-8")
        made = _drawn(files)
    GALLERY.mkdir(exist_ok=True)
    for name, picture in made.items():
        dp.plot.save(picture, GALLERY / f"{name}.svg")


def _drawn(files: dict[str, Path]) -> dict[str, dp.plot.Picture]:
    hits = dp.read(files["hammer.csv"], kind="impact")
    frf = hits.frf(mass=workflow.MASS)
    test = dp.read(files["seal_8mm.csv"], kind="relaxation")
    study = dp.report(test, hits, mass=workflow.MASS, seals=2)
    depths = dp.fit(*(dp.read(files[f"depth_{d}mm.csv"], kind="relaxation") for d in (4, 6, 8)))
    return {
        "hero": study.plot(),
        "segments": study.prepared.plot(),
        "fit": dp.plot.fit(study.fit, study.prepared),
        "stiffness": dp.plot.stiffness(study.fit, parameters=study.parameters, unseen=study.unseen),
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
        "superposition": dp.solids.superpose(dp.read(files["sweeps.csv"])).plot(),
        "elastic_law": dp.plot.elastic_law(depths),
        "columns": dp.inspect(files["seal_8mm.csv"]).plot(),
    }


def app() -> bool:
    """Photograph the app with the example in it; False where no browser is installed."""
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        return False
    from playwright.sync_api import sync_playwright

    words = [sys.executable, "-m", "dashpot", "app", "--no-browser"]
    GALLERY.mkdir(exist_ok=True)
    server = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)  # noqa: S603
    with server, sync_playwright() as on:
        browser = on.chromium.launch(executable_path=program, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1366, "height": 768})
        page.goto(server.stdout.readline().strip())
        page.get_by_role("button", name="Try the example").click()
        done = page.get_by_role("status").filter(has_text="done in")
        done.wait_for()
        page.screenshot(path=GALLERY / "app.png")
        page.get_by_role("button", name="hammer.csv").first.click()
        done.wait_for()
        page.screenshot(path=GALLERY / "app_hits.png")
        browser.close()
        server.terminate()
    return True


if __name__ == "__main__":
    main()
