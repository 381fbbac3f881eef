"""Whether a change of the house leaves its answers as they were.

    PYTHONPATH=src python benchmarks/answers.py run AFTER.json [--only REGEX]
    python benchmarks/answers.py compare BEFORE.json AFTER.json [--only REGEX]

Runs the commands of benchmarks/answers.txt in a scratch folder with the example files and a few
more; PYTHONPATH says by which dashpot. Kept of each: exit code, JSON document, and what it wrote.
Two such files agree where words are the same and a number has moved by less than 0.01 of its own
standard error, as the document before tells it (a field of its name with `se` or beside
`standard_error`, or half of the half width of its 95 % interval); a standard error by less than
1 %; a number without one by less than --relative of itself, or of the largest of its list; one in
a text by that or by its last digit. Exit status 1 where they do not.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import json
import math
import os
import re
import shlex
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

COMMANDS = Path(__file__).with_suffix(".txt")
IGNORED = {"gap"}
"""Of a certificate: rounding. Whether it is optimal stands beside it."""
HASH = re.compile(r"\b(?=\w*[a-f])[0-9a-f]{16}(?:[0-9a-f]{48})?\b")
"""Of files that bear the version or the hour, or of all digits of an answer."""
MOST, MOST_BIC, ROUNDING = 0.01, 0.1, 1e-14
"""Of a standard error, or of one by itself; of a BIC; of what is rounding and no number."""
TABLES = ("standard_error", "intervals", "interval_95")
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")
WRITES = {".csv", ".json", ".bdf", ".inp", ".mac", ".k", ".rad", ".py", ".txt", ".m", ".cal"}


def lines() -> list[str]:
    told = COMMANDS.read_text(encoding="utf-8").splitlines()
    return [line for line in told if line.startswith("dashpot ")]


def wanted(pattern: str) -> list[str]:
    """The lines that match, and those above that write what they read."""
    found: list[str] = []
    read: set[str] = set()
    for line in reversed(lines()):
        words = shlex.split(line)
        made = {b for a, b in zip(words, words[1:], strict=False) if a.startswith(("-o", "--s"))}
        made |= {"gauges.cal"} if "gauges.csv" in made else set()
        made |= {words[words.index("--project") + 1]} if "--project" in words else set()
        if re.search(pattern, line) or made & read:
            found.insert(0, line)
            read |= set(words)
    return found


def inputs() -> None:
    """What the example files lack: sweeps of strain, other modes of stretch, a shaken rod."""
    import numpy as np

    draw = np.random.default_rng(1).standard_normal

    def write(name: str, head: str, *columns: Any) -> None:
        rows = (",".join(f"{v:.8g}" for v in row) for row in zip(*columns, strict=True))
        Path(name).write_text("\n".join([head, *rows, ""]), encoding="utf-8")

    strain = np.geomspace(0.01, 20, 25)
    payne, moved = 1 / (1 + (strain / 1.2) ** 1.2), 1 + 0.003 * draw((2, 25))
    storage, loss = 1.2 + 0.9 * payne, 0.12 + 0.5 * payne * (1 - payne)
    head = "frequency [Hz],strain [%],storage modulus [MPa],loss modulus [MPa]"
    write("strain.csv", head, np.full(25, 10.0), strain, storage * moved[0], loss * moved[1])
    since = np.geomspace(0.01, 1e3, 60)
    crept = (0.5 + 0.3 * (1 - np.exp(-since / 0.8)) + 0.2 * (1 - np.exp(-since / 60))) / 2
    write("compliance.csv", "time [s],creep compliance [1/MPa]", since,
          crept * (1 + 0.002 * draw(60)))  # fmt: skip
    x = np.linspace(1.0, 1.8, 60)
    planar, pressed = 0.4 * (x - x**-3), np.linspace(0, 50, 60)
    write("planar.csv", "strain [%],nominal stress [MPa]", 100 * (x - 1),
          planar + 0.003 * draw(60))  # fmt: skip
    foamy = 0.02 * pressed / (1 + 0.08 * pressed) + 2e-8 * pressed**4
    write("foam.csv", "strain [%],nominal stress [kPa]", pressed,
          1e3 * (foamy + 3e-3 * draw(60)) / 20)  # fmt: skip
    ratio = np.linspace(1.0, 0.97, 30)
    write("volumetric.csv", "volume ratio,pressure [MPa]", ratio,
          2000 * (1 - ratio) + 0.1 * draw(30))  # fmt: skip
    flown = np.arange(0, 9, 0.02)
    past = np.clip(flown - 3, 0, 3.2)
    write("ball.csv", "time [ms],velocity [m/s]", flown,
          np.exp(-0.08 * past) * np.cos(past) + 0.002 * draw(len(flown)))  # fmt: skip
    base = 5 * draw(1 << 14)
    k = 400e3 * (1 + 0.15j) * math.pi * 1e-4 / 20e-3
    omega = 2 * math.pi * np.fft.rfftfreq(len(base), 5e-4)
    mass = np.fft.irfft(np.fft.rfft(base) * k / (k - 33e-3 * omega**2), len(base))
    noisy = 0.01 * draw((2, len(base)))
    write("shaken.csv", "time [s],base [m/s^2],mass [m/s^2]", 5e-4 * np.arange(len(base)),
          base + noisy[0], mass + noisy[1])  # fmt: skip
    Path("limits.toml").write_text('[k_end]\nlower = "150N/m"\nupper = "260N/m"\n', encoding="utf-8")


def run(place: Path, pattern: str) -> None:
    # before NumPy is there: the order of sums, and so the last digits, are those of one thread
    os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    from click.testing import CliRunner

    import dashpot
    from dashpot.cli import main

    kept: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as room, contextlib.chdir(room):

        def plain(text: str) -> str:
            text = text.replace(dashpot.__version__, "VERSION").replace(room, "ROOM")
            return HASH.sub("HASH", text)

        for words in ("example --all -o .", "fit seal_8mm.csv -o fit.json"):
            assert CliRunner().invoke(main, words.split()).exit_code == 0, words
        inputs()
        files = {f.name: plain(f.read_text("utf-8")) for f in sorted(Path().glob("*.[ct]*"))}
        hashes = {name: hashlib.sha256(t.encode()).hexdigest() for name, t in files.items()}
        for line in wanted(pattern):
            before = {f: f.stat().st_mtime_ns for f in Path().iterdir()}
            start = time.process_time()
            told = CliRunner().invoke(main, shlex.split(line)[1:])
            cpu = time.process_time() - start
            print(f"{cpu:6.2f} s  {told.exit_code}  {line}", file=sys.stderr)
            if not line.endswith(" --json"):
                assert told.exit_code == 0, told.output
                continue
            found = _read(plain(told.stdout))
            wrote = {
                f.name: _read(plain(f.read_text("utf-8")))
                for f in sorted(Path().iterdir())
                if f.suffix in WRITES and f.stat().st_mtime_ns != before.get(f)
            }
            wrote = {name: text for name, text in wrote.items() if text != found}
            kept[line] = {"exit": told.exit_code, "cpu": cpu, "document": found, "files": wrote}
    place.write_text(json.dumps({"inputs": hashes, "answers": kept}), encoding="utf-8")


def _read(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text


Path_ = tuple[str | int, ...]
Nest = tuple[Any, ...]
"""What a path leads through, outermost first."""


class Difference(NamedTuple):
    """A number that moved, by `size` in the limit's own measure; or words, by infinitely much."""

    size: float
    limit: float
    path: str
    says: str


def differences(
    a: Any, b: Any, relative: float, path: Path_ = (), nest: Nest = ()
) -> Iterator[Difference]:
    """Where two documents differ; `nest` holds what the path leads through, of the first."""
    where = "/".join(map(str, path))
    if type(a) is type(b) and isinstance(a, (dict, list)):
        here = dict(enumerate(a)) if isinstance(a, list) else a
        there = dict(enumerate(b)) if isinstance(b, list) else b
        for key in (*here, *(set(there) - set(here))):
            if key in here and key in there:
                if key not in IGNORED:
                    yield from differences(
                        here[key], there[key], relative, (*path, key), (*nest, a)
                    )
            else:
                gone = "gone" if key in here else "new"
                yield Difference(math.inf, 0.0, f"{where}/{key}", gone)
    elif number(a) and number(b):
        if not math.isclose(a, b, rel_tol=0.0, abs_tol=ROUNDING):
            size, limit, unit = measure(a, path, nest) or (_largest(a, nest[-1]), relative, "")
            moved = abs(a - b) / size if size else math.inf
            yield Difference(moved, limit, where, f"{a:.8g} -> {b:.8g} ({moved:.2g} {unit})")
    elif isinstance(a, str) and isinstance(b, str) and _words(a) == _words(b):
        for one, other in zip(NUMBER.findall(a), NUMBER.findall(b), strict=True):
            if one != other:
                mantissa, _, power = one.lower().partition("e")
                last = 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2]))
                moved = abs(float(one) - float(other))
                if moved > max(relative * abs(float(one)), 1.01 * last, ROUNDING):
                    yield Difference(math.inf, 0.0, where, f"in its text {one} -> {other}")
    elif a != b:
        yield Difference(math.inf, 0.0, where, f"{_short(a)} -> {_short(b)}")


def _words(text: str) -> list[str]:
    return NUMBER.sub(" # ", text).split()


def number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _short(value: Any) -> str:
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) < 90 else f"{text[:40]} ... {text[-40:]}"


def _largest(value: float, home: Any) -> float:
    return max(map(abs, filter(number, home))) if isinstance(home, list) else abs(value)


def measure(value: float, path: Path_, nest: Nest) -> tuple[float, float, str] | None:
    """The standard error of the number at a path, what it may move by in it, and its name."""
    home, names = nest[-1], [str(name) for name in path if isinstance(name, str)]
    if "covariance" in names:
        return _largest(value, home), 2 * MOST, "of its row"
    if names[-1] == "bic":
        return max(1.0, 1e-3 * abs(value)), MOST_BIC, "of BIC"
    if "standard_error" in names or {"se", "sd"} & set(names[-1].split("_")):
        return abs(value), MOST, "of it"
    if any("interval" in name for name in names) and (error := _error(home, ())):
        return error, MOST, "SE"
    for depth in reversed(range(len(nest))):
        if not isinstance(node := nest[depth], dict):
            continue
        key, tail = str(path[depth]), path[depth + 1 :]
        told = [(node.get(table), path[depth:]) for table in TABLES]
        told += [(node.get(table), tail) for table in TABLES]
        bare = {key, key.removesuffix("_real").removesuffix("_imag")}
        told += [(error, tail) for name, error in node.items() if _of(name) in bare]
        if {"low", "high"} <= set(node) and key in {"value", "low", "high"}:
            told.append(([node["low"], node["high"]], ()))
        for table, inside in told:
            if error := _error(table, inside):
                return error, MOST, "SE"
    return None


def _of(name: str) -> str | None:
    """Of `storage_se` and `storage_interval`, `storage`; of `frequency_se_hz`, `frequency_hz`."""
    words = name.split("_")
    left = [word for word in words if word not in {"se", "sd", "interval"}]
    return "_".join(left) if len(left) < len(words) else None


def _error(table: Any, tail: Path_) -> float | None:
    """A standard error as it stands there, or half of the half width of a 95 % interval."""
    for key in tail:
        if isinstance(table, dict) and key in table:
            table = table[key]
        elif isinstance(table, list) and isinstance(key, int) and key < len(table):
            table = table[key]
        else:
            return None
    if isinstance(table, list) and len(table) == 2 and all(map(number, table)):
        return abs(table[1] - table[0]) / 4 or None
    return table or None if number(table) else None


def compare(before: Path, after: Path, pattern: str, relative: float, worst: int) -> bool:
    a, b = (json.loads(place.read_text("utf-8")) for place in (before, after))
    same = True
    spoilt = [name for name, value in a["inputs"].items() if b["inputs"].get(name) != value]
    if spoilt:
        print(f"the files given to the commands differ themselves: {', '.join(spoilt)}")
        same = False
    spent = [0.0, 0.0]
    for line in [line for line in a["answers"] if re.search(pattern, line)]:
        one, other = a["answers"][line], b["answers"].get(line)
        if other is None:
            print(f"not run    {line}")
            same = False
            continue
        spent = [spent[0] + one.pop("cpu"), spent[1] + other.pop("cpu")]
        found = sorted(differences(one, other, relative), key=lambda d: -d.size / (d.limit or 1))
        beyond = [d for d in found if d.size > d.limit]
        told = {unit: max((d.size for d in found if (d.limit == MOST) == unit), default=0.0)
                for unit in (True, False)}  # fmt: skip
        if beyond:
            print(f"DIFFERS    {line}")
            for d in beyond[:worst]:
                print(f"             {d.path}: {d.says}")
            if len(beyond) > worst:
                print(f"             and {len(beyond) - worst} more")
        elif found:
            print(f"within     {line}  [{told[True]:.1g} SE, else {told[False]:.1g} relative]")
        else:
            print(f"identical  {line}")
        same = same and not beyond
    print(f"CPU {spent[0]:.1f} s before, {spent[1]:.1f} s after")
    return same


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("what", choices=("run", "compare"))
    parser.add_argument("files", type=lambda name: Path(name).resolve(), nargs="+")
    parser.add_argument("--only", default="", help="lines that match this regular expression")
    parser.add_argument("--relative", type=float, default=1e-3)
    parser.add_argument("--worst", type=int, default=6, help="differences shown of each line")
    given = parser.parse_args()
    if given.what == "run":
        run(given.files[0], given.only)
        return 0
    return 0 if compare(*given.files, given.only, given.relative, given.worst) else 1


if __name__ == "__main__":
    sys.exit(main())
