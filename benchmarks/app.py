"""The app in a browser: how long a user waits, from the pointer to the drawn curve.

Run: python benchmarks/app.py [--moves 60] [--loads 20] [--usual] [--busy]

A record of 42 500 rows and five hits from the virtual rig and hammer, then one of 3 million rows,
unless `--usual` leaves it out. `--busy` keeps one core at work meanwhile.
Times are wall clock in the page (`performance.now`), for a browser and a server share the machine;
"drawn" is the second frame after the answer. Beside them stands what others on the machine change
less: processor time of server and workers a step, and the tasks that held the page for more than
50 ms. Memory is the resident size of server and workers, what they share counted once.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from playwright.sync_api import Page, sync_playwright

from dashpot.reading.write import write_impact, write_relaxation
from dashpot.simulation.impact import simulate_impact
from dashpot.simulation.relaxation import simulate_relaxation
from dashpot.simulation.rig_errors import Rig
from dashpot.solids.demo_seals import BROAD

LISTEN = """() => {
  window.times = []; window.bytes = []; window.long = [];
  const seen = performance.mark.bind(performance);
  performance.mark = (name) => {
    const since = window.moved;
    // a message posted in a frame is heard when that frame has been painted
    if (since) requestAnimationFrame(() => {
      const { port1, port2 } = new MessageChannel();
      port1.onmessage = () => window.times.push(performance.now() - since);
      port2.postMessage(0);
    });
    return seen(name);
  };
  // from the user's own event on: what drives this browser from outside is not the page's time
  for (const name of ['pointermove', 'keydown'])
    addEventListener(name, (event) => { window.moved = event.timeStamp; }, true);
  new PerformanceObserver((list) => {
    for (const one of list.getEntries()) window.long.push(one.duration);
  }).observe({ type: 'longtask' });
  new PerformanceObserver((list) => {
    for (const one of list.getEntries()) if (one.name.includes('/api/'))
      window.bytes.push([one.name.split('/').pop(), one.transferSize]);
  }).observe({ type: 'resource', buffered: true });
}"""


def main() -> None:
    """Drive the page and print what it took."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--moves", type=int, default=60, help="of the pointer, and of the mass")
    parser.add_argument("--usual", action="store_true", help="only the record of usual size")
    parser.add_argument("--loads", type=int, default=20, help="of one file, for the memory")
    parser.add_argument("--busy", action="store_true", help="with one core at work")
    options = parser.parse_args()
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        sys.exit("no chromium on this machine (apt-get install chromium)")
    with TemporaryDirectory() as place:
        seal, hammer, long = (Path(place) / name for name in ("seal.csv", "hammer.csv", "long.csv"))
        seal.write_text(write_relaxation(simulate_relaxation(BROAD, seed=1).test))
        hammer.write_text(write_impact(simulate_impact(BROAD, mass=0.1148, seed=1).test))
        if not options.usual:
            rig = Rig(rate=10_000.0)
            made = simulate_relaxation(BROAD, hold_time=297.0, rig=rig, seed=1).test
            long.write_text(write_relaxation(made))
        with keep_core_busy(options.busy), sync_playwright() as play:
            browser = play.chromium.launch(executable_path=program, args=["--no-sandbox"])
            window = {"width": 1366, "height": 768}
            drive(browser.new_page(viewport=window), seal, hammer, options.moves, options.busy)
            loads(browser.new_page(viewport=window), seal, options.loads)
            if not options.usual:
                large(browser.new_page(viewport=window), long)


@contextmanager
def keep_core_busy(busy: bool) -> Iterator[None]:
    """Keep a core at work until the end of the block, if asked to."""
    if not busy:
        yield
        return
    with subprocess.Popen([sys.executable, "-c", "while True: pass"]) as other:
        try:
            yield
        finally:
            other.kill()


def start(*files: Path) -> tuple[subprocess.Popen[str], str, float]:
    """A server, its address, and the time from the prompt to that line, s."""
    since = time.perf_counter()
    words = [sys.executable, "-m", "dashpot", "app", "--no-browser", *map(str, files)]
    server = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    assert server.stdout is not None
    address = server.stdout.readline().strip()
    return server, address, time.perf_counter() - since


def drive(page: Page, seal: Path, hammer: Path, moves: int, busy: bool) -> None:
    """Everything that a user waits for, on a record of usual size."""
    server, address, ready = start()
    say("prompt to address", 1e3 * ready, "ms")
    page.goto(address)
    page.locator("body[data-ready=true]").wait_for()
    paint = "performance.getEntriesByName('first-contentful-paint')[0].startTime"
    say("first contentful paint", page.evaluate(paint), "ms", 600)
    size = "performance.getEntriesByType('resource').reduce((a, b) => a + b.transferSize, 0)"
    whole = page.evaluate(f"{size} + performance.getEntriesByType('navigation')[0].transferSize")
    say("page", whole / 1e3, "kB", 100)
    time.sleep(2)
    since = time.perf_counter()
    page.locator("#pick").set_input_files(str(seal))
    page.locator('[data-panel="hold"] svg.figure').wait_for()
    say("file dropped to first plot", 1e3 * (time.perf_counter() - since), "ms", 500)
    wait_until_idle(page)
    page.keyboard.press("2")
    wait_for_command(page, "--arms 2")
    page.locator("#mass").fill("114.8")
    page.locator("#mass").press("Enter")
    wait_for_command(page, "114.8g")
    page.evaluate(LISTEN)
    for name, by in (("ramp end", 1), ("contact", -1), ("hold end", -1)):
        with effort(page, server.pid, f"drag {name}", moves):
            drag(page, name, by, moves, 150 if busy else 100)
        page.get_by_role("slider", name=name).press("Home")
        wait_for_command(page, "--mass")
    with effort(page, server.pid, "mass", moves):
        slide(page, moves)
    wait_until_idle(page)
    with effort(page, server.pid, "settle and study", 6):
        settle(page)
    page.locator("#pick").set_input_files(str(hammer))
    # past the reading, at work on the verdict
    page.get_by_role("status").filter(has_text=re.compile(r", \d+\.\d s$")).wait_for()
    since = time.perf_counter()
    page.get_by_role("button", name="Cancel").click()
    page.get_by_role("status").filter(has_text="cancelled").wait_for()
    say("cancel", 1e3 * (time.perf_counter() - since), "ms", 1000)
    say("server and workers", memory(server.pid), "MB", 400)
    leave(server)


def drag(page: Page, name: str, by: int, moves: int, limit: float) -> None:
    """Drag a handle, half a pixel after the other."""
    page.evaluate("window.times = []; window.bytes = []")
    box = page.get_by_role("slider", name=name).bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] - 20
    page.mouse.move(x, y)
    page.mouse.down()
    for i in range(moves):
        page.mouse.move(x + by * (1 + i / 2), y)
        page.wait_for_timeout(150)
    page.mouse.up()
    say(f"redraws of {moves} moves", len(page.evaluate("window.times")), "", round(moves / 1.2))
    quantiles(page, f"drag {name} to redraw", limit)
    sizes(page, "live")


def loads(page: Page, seal: Path, count: int) -> None:
    """Open a file and remove it, again and again: what stays in memory of it."""
    server, address, _ = start()
    page.goto(address)
    page.locator("body[data-ready=true]").wait_for()
    held, at = [], sorted({0, count // 2, count})
    browser = page.context.new_cdp_session(page)
    for i in range(count + 1):
        # each is another file: nothing of it is known yet
        text = f"# load {i}\n{seal.read_text()}".encode()
        page.locator("#pick").set_input_files(
            {"name": f"seal_{i}.csv", "mimeType": "text/csv", "buffer": text}
        )
        wait_until_idle(page)
        page.get_by_role("button", name=f"remove seal_{i}.csv", exact=True).click()
        page.locator("#files .file").first.wait_for(state="detached")
        if i in at:
            browser.send("HeapProfiler.collectGarbage")
            heap = page.evaluate("performance.memory.usedJSHeapSize") / 1e6
            held.append((memory(server.pid), heap))
    for i, (of_server, heap) in zip(at, held, strict=True):
        say(f"load {i + 1}: server and workers", of_server, "MB", 400)
        say(f"load {i + 1}: heap of the page", heap, "MB")
    leave(server)


def slide(page: Page, moves: int) -> None:
    """Move the mass."""
    page.locator("#mass").focus()
    page.evaluate("window.times = []; window.bytes = []")
    for _ in range(moves):
        page.keyboard.press("ArrowUp")
        page.wait_for_timeout(60)
    quantiles(page, "mass to redraw", 50)
    sizes(page, "predict")


def settle(page: Page) -> None:
    """Release: the fit with its intervals and checks, and every panel."""
    times = []
    page.locator("#mass").blur()
    for arms in "020202":
        page.evaluate("document.getElementById('status').textContent = ''")
        page.keyboard.press(arms)
        page.get_by_role("status").filter(has_text="settled in").or_(
            page.get_by_role("status").filter(has_text="bounding")
        ).or_(page.get_by_role("status").filter(has_text="done in")).first.wait_for()
        times.append(page.evaluate("performance.getEntriesByType('resource').filter((one) => "
                                   "one.name.endsWith('/settle')).pop().duration"))  # fmt: skip
        wait_until_idle(page)
    say("settle, median", statistics.median(times), "ms", 200)


def large(page: Page, path: Path) -> None:
    """Three million rows."""
    server, address, _ = start()
    page.set_default_timeout(120_000)
    page.goto(address)
    page.locator("body[data-ready=true]").wait_for()
    time.sleep(2)
    since = time.perf_counter()
    page.locator("#pick").set_input_files(str(path))
    page.locator('[data-panel="hold"] svg.figure').wait_for()
    say("3 M rows: dropped to first plot", 1e3 * (time.perf_counter() - since), "ms", 4000)
    wait_until_idle(page)
    since = time.perf_counter()
    page.keyboard.press("2")
    page.locator("#command").filter(has_text="--arms 2").wait_for()
    say("3 M rows: refit", 1e3 * (time.perf_counter() - since), "ms", 2000)
    wait_until_idle(page)
    say("3 M rows: server and workers", memory(server.pid), "MB", 600)
    leave(server)


def leave(server: subprocess.Popen[str]) -> None:
    """End the server, and wait until it is gone."""
    since = time.perf_counter()
    server.terminate()
    server.wait()
    say("exit", 1e3 * (time.perf_counter() - since), "ms", 2000)


@contextmanager
def effort(page: Page, process: int, what: str, steps: int) -> Iterator[None]:
    """Say what a step cost the processors, and how often the page was held up."""
    page.evaluate("window.long = []")
    before = cpu(process)
    yield
    say(f"{what}: CPU of server and workers a step", 1e3 * (cpu(process) - before) / steps, "ms")
    long = page.evaluate("window.long")
    say(f"{what}: tasks over 50 ms in the page", len(long), "")
    if long:
        say(f"{what}: the longest", max(long), "ms")


def cpu(process: int) -> float:
    """Processor time of a process and its children, s."""
    ticks = 0
    for item in family(process):
        fields = Path(f"/proc/{item}/stat").read_text().rpartition(")")[2].split()
        ticks += int(fields[11]) + int(fields[12])
    return ticks / os.sysconf("SC_CLK_TCK")


def family(process: int) -> list[str]:
    """A process and its children."""
    return [str(process), *Path(f"/proc/{process}/task/{process}/children").read_text().split()]


def wait_until_idle(page: Page) -> None:
    """Wait until nothing is computed."""
    page.evaluate("new Promise((go) => requestAnimationFrame(() => requestAnimationFrame(go)))")
    page.locator("body:not([data-busy=true])").wait_for()
    page.get_by_role("status").filter(has_text="done in").wait_for()


def wait_for_command(page: Page, words: str) -> None:
    """Wait until the page shows a command with these words, and all of it."""
    page.locator("#command").filter(has_text=words).wait_for()
    wait_until_idle(page)


def quantiles(page: Page, what: str, limit: float) -> None:
    """Median and 95 % of what was waited for."""
    times = sorted(page.evaluate("window.times"))
    say(f"{what}, median of {len(times)}", statistics.median(times), "ms")
    say(f"{what}, 95 %", times[int(0.95 * len(times))], "ms", limit)


def sizes(page: Page, verb: str) -> None:
    """Bytes of an update."""
    result = [size for name, size in page.evaluate("window.bytes") if name == verb]
    say(f"bytes of an update ({verb})", max(result) / 1e3, "kB", 30)


def memory(process: int) -> float:
    """Resident size of a process and its children, MB; what they share is counted once."""
    total = 0
    for item in family(process):
        status = Path(f"/proc/{item}/smaps_rollup").read_text()
        total += int(status.partition("\nPss:")[2].split()[0])
    return total / 1e3


def say(what: str, value: float, unit: str, limit: float | None = None) -> None:
    """Print one figure beside what is aimed at."""
    aim = "" if limit is None else f"   (aim: {limit:g} {unit})"
    print(f"{what:40} {value:9.1f} {unit}{aim}", flush=True)


if __name__ == "__main__":
    main()
