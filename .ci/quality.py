"""The table of docs/quality.md, of what a night left behind: ``python .ci/quality.py DIR [WORDS]``.

``just nightly`` leaves there: ``*.xml``, the results of each run of the tests, with what these say
of themselves (`mutants`, `kills`); ``verdicts.jsonl`` of benchmarks/verdicts.py; ``coverage.txt``
of benchmarks/coverage_kinds.py; ``speed.txt`` of benchmarks/anybody.py; ``readme.txt`` of
.ci/readme. What is missing has no row.
"""

from __future__ import annotations

import datetime as dt
import re
import sys
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree as ET

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "benchmarks"))
PAGE = ROOT / "docs" / "quality.md"
MARKS = ("<!-- just nightly writes this -->\n", "<!-- end -->\n")
DOORS = {
    "read": "median <= 12 ms", "prepare": "", "hold, auto": "p95 <= 25 ms",
    "full, auto": "p95 <= 45 ms", "limits of the response": "most <= 1000 ms",
}  # fmt: skip
"""What a door costs at most, on two quiet cores."""


class Row(NamedTuple):
    """A figure, out of how many, and what is aimed at."""

    what: str
    figure: str
    of: str = ""
    goal: str = ""


def tests(files: Iterable[Path]) -> Iterator[Row]:
    """Each run of the tests, and what its tests counted."""
    counted: dict[str, int] = defaultdict(int)
    for file in sorted(files):
        whole = ET.parse(file).getroot().find("testsuite")  # noqa: S314  our own
        n = {key: int(whole.get(key, 0)) for key in ("tests", "failures", "errors", "skipped")}
        bad = n["failures"] + n["errors"]
        passed = n["tests"] - bad - n["skipped"]
        text = f"{passed:,} passed, {n['skipped']} skipped, {bad} failed"
        yield Row(f"tests: {file.stem}", text, f"{n['tests']:,}", "0 failed")
        for case in whole.iter("testcase"):
            died = case.find("failure") is not None
            for item in case.iter("property"):
                counted[item.get("name", "")] += int(item.get("value", 0))
                counted[f"{item.get('name')} lost"] += died
    for name, says in (
        ("mutants", "mutants of files and documents"),
        ("kills", "kills of a batch"),
    ):
        if name in counted:
            lost = counted[f"{name} lost"]
            yield Row(says, f"{lost} found a fault", f"{counted[name]:,}", "0")


def verdicts(file: Path) -> Iterator[Row]:
    """How often "use" is right, and limits hold, of the truths that share no line with dashpot."""
    from verdicts import MISSED, USED, lines_of
    from verdicts import Row as Counts

    kinds: dict[str, list[dict]] = {}
    for line in (
        line for line in lines_of(file) if "settled" not in line
    ):  # curves: docs/bounds.md
        kind = "relaxation" if line["rig"] else line["group"].partition(",")[0]
        kinds.setdefault(kind, []).append(line)
    for kind, lines in kinds.items():
        result = Counts.of(kind, lines)
        text = (
            f'{result.missed} of {result.used} with "use" are wrong, '
            f'{result.used_held} of {result.held} sound ones have "use"'
        )
        goal = f"<= {100 * MISSED:g} %, >= {100 * USED:g} %"
        yield Row(f"verdicts: {kind}", text, f"{len(lines)}", goal)


COVERED = {
    "figures": "load deflection",
    "relaxed": "equilibrium curve",
    "relaxed-from-air": "equilibrium curve, behind an air gap",
    "speeds": "several speeds",
    "speeds-from-air": "several speeds, behind an air gap",
}
"""Names of cases in the table."""


def coverage(file: Path) -> Iterator[Row]:
    """How often a 95 % interval holds the truth, by kind and parameter."""
    for block in re.split(r"(?m)^(?=\S+: held of)", file.read_text("utf-8")):
        head = re.match(r"(\S+): held of (\d+)", block)
        if head:
            matches = re.findall(r"^  (\S.*?) +(\d+)$", block, re.M)
            text = ", ".join(f"{name} {count}" for name, count in matches)
            yield Row(f"coverage: {COVERED.get(head[1], head[1])}", text, head[2], "95 %")


def speed(file: Path) -> Iterator[Row]:
    """CPU time of each door on anybody's records."""
    text = file.read_text("utf-8")
    for door, goal in DOORS.items():
        match = re.search(rf"^{re.escape(door)} +(\d+) +\S+ +(\S+) +(\S+) +(\S+)", text, re.M)
        if match:
            n, middle, late, most = match.groups()
            message = f"p95 {late} ms (median {middle}, most {most})"
            yield Row(f"speed: {door}", message, n, goal)


def readme(file: Path) -> Iterator[Row]:
    """CPU time of the main job, as README's first line runs it in an empty environment."""
    match = re.search(r"the main job: .* (\d+) ms of CPU time", file.read_text("utf-8"))
    if match:
        text = f"{match[1]} ms of CPU time"
        yield Row("README: the main job after its installation", text, "1", "<= 3000 ms")


TOLD: dict[str, Callable[[Path], Iterator[Row]]] = {
    "readme.txt": readme, "verdicts.jsonl": verdicts, "coverage.txt": coverage, "speed.txt": speed,
}  # fmt: skip


def rows(night: Path) -> Iterator[Row]:
    """Every row that the files of a night give."""
    yield from tests(night.glob("*.xml"))
    for name, tell in TOLD.items():
        if (night / name).exists():
            yield from tell(night / name)


def table(result: Iterable[Row]) -> str:
    """The rows as Markdown."""
    lines = [Row("what", "figure", "of", "goal"), Row("---", "---", "--:", "---"), *result]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def main() -> None:
    """Write the table between the marks of the page, and print it."""
    day = f"{dt.datetime.now(dt.UTC):%Y-%m-%d}"
    night, *words = sys.argv[1:]
    head = " ".join([f"Night of {day}.", *words])
    text = f"{head}\n\n{table(rows(Path(night)))}"
    before, _, rest = PAGE.read_text("utf-8").partition(MARKS[0])
    after = rest.partition(MARKS[1])[2]
    PAGE.write_text(f"{before}{MARKS[0]}\n{text}\n{MARKS[1]}{after}", "utf-8")
    sys.stdout.write(text)


if __name__ == "__main__":
    main()
